// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Sets of pixels of an image, and their parts.
#ifndef lacunaPixelSet_h
#define lacunaPixelSet_h

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace lacuna
{
/// A box of pixels: first column and row, and those behind the last.
struct PixelRectangle
{
  int Left = std::numeric_limits<int>::max();
  int Top = std::numeric_limits<int>::max();
  int Right = 0; ///< 0: it is empty
  int Bottom = 0;

  void Put(int column, int row)
  {
    this->Left = std::min(this->Left, column);
    this->Top = std::min(this->Top, row);
    this->Right = std::max(this->Right, column + 1);
    this->Bottom = std::max(this->Bottom, row + 1);
  }
  bool Has(int column, int row) const
  {
    return column >= this->Left && column < this->Right && row >= this->Top && row < this->Bottom;
  }
  int GetWidth() const { return this->Right - this->Left; }
  int GetHeight() const { return this->Bottom - this->Top; }
  double GetArea() const { return double(this->GetWidth()) * this->GetHeight(); }
};

/// A connected part of a set.
struct PixelPart
{
  PixelRectangle Bounds;
  std::vector<std::pair<int, int>> Pixels; ///< column, row

  /// Of the pixels for which isSo(column, row) is true.
  template <class Function>
  double GetFraction(const Function& isSo) const
  {
    const auto count = std::count_if(this->Pixels.begin(), this->Pixels.end(),
      [&](const std::pair<int, int>& pixel) { return isSo(pixel.first, pixel.second); });
    return static_cast<double>(count) / static_cast<double>(this->Pixels.size());
  }
};

/// Any pixels of an image.
class PixelSet
{
public:
  /// Empty.
  PixelSet(int width, int height)
    : Width(width)
    , Height(height)
    , Members(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 0)
  {
  }

  /// The pixels for which isIn(column, row) is true.
  template <class Function>
  static PixelSet Select(int width, int height, const Function& isIn)
  {
    PixelSet set(width, height);
    for (int row = 0; row < height; ++row)
    {
      for (int column = 0; column < width; ++column)
      {
        if (isIn(column, row))
        {
          set.Put(column, row);
        }
      }
    }
    return set;
  }

  int GetWidth() const { return this->Width; }
  int GetHeight() const { return this->Height; }
  bool Has(int column, int row) const { return this->Members[this->Index(column, row)] != 0; }
  void Put(int column, int row) { this->Members[this->Index(column, row)] = 1; }
  void Put(const PixelPart& part);
  std::int64_t GetSize() const;
  PixelRectangle GetBounds() const;

  /// Calls f(column, row) for each, row by row.
  template <class Function>
  void ForEach(const Function& f) const
  {
    for (int row = 0; row < this->Height; ++row)
    {
      for (int column = 0; column < this->Width; ++column)
      {
        if (this->Has(column, row))
        {
          f(column, row);
        }
      }
    }
  }

  /// Upside down.
  PixelSet Flipped() const;

  /// The pixels of the image that have at least this many of the set in the rectangle around them.
  /// Negative or 0: all but so many, of those in the image.
  PixelSet Gathered(int radiusX, int radiusY, int needed) const;
  PixelSet Grown(int radiusX, int radiusY) const { return this->Gathered(radiusX, radiusY, 1); }

  /// Connected by edges or corners.
  std::vector<PixelPart> GetParts() const;

  /// The outermost pixels of each row, and of each column.
  std::array<std::vector<PixelRectangle>, 2> GetLines() const;

private:
  std::size_t Index(int column, int row) const
  {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(this->Width) +
      static_cast<std::size_t>(column);
  }
  int Width, Height;
  std::vector<char> Members;
};
}
#endif
