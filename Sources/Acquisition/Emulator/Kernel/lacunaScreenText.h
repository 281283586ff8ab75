// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Letters on an emulated screen.
#ifndef lacunaScreenText_h
#define lacunaScreenText_h

#include <cstdint>
#include <string_view>

namespace lacuna
{
/// An 8-bit image, the top line first; does not own it.
struct GreyScreen
{
  int Columns = 0;
  int Rows = 0;
  std::uint8_t* Pixels = nullptr;

  /// Nothing outside of the image.
  void Set(int column, int row, std::uint8_t level) const
  {
    if (column >= 0 && column < this->Columns && row >= 0 && row < this->Rows)
    {
      this->Pixels[static_cast<std::int64_t>(row) * this->Columns + column] = level;
    }
  }
  /// A bar of columns x rows pixels.
  void Fill(int column, int row, int columns, int rows, std::uint8_t level) const;
};

/// Of a letter with the gap after it, pixels.
constexpr int TextAdvance = 12;
constexpr int TextHeight = 14;

/// Writes capitals, digits and . : - / from (column, row), the top left corner; other characters
/// are blanks. The ground stays.
void DrawText(
  const GreyScreen& screen, int column, int row, std::string_view text, std::uint8_t level);
}
#endif
