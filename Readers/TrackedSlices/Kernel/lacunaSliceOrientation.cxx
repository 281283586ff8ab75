// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSliceOrientation.h"

#include "lacunaSequenceText.h"

#include <algorithm>
#include <stdexcept>

namespace lacuna
{
namespace
{
constexpr std::string_view Brightness = "BRIGHTNESS";

std::string WithoutPrefix(std::string_view text, std::string_view prefix)
{
  text = Trim(text);
  return std::string(text.substr(0, prefix.size()) == prefix ? text.substr(prefix.size()) : text);
}

void ReverseRow(unsigned char* row, std::int64_t columns, std::size_t pixelSize)
{
  if (pixelSize == 1)
  {
    std::reverse(row, row + columns);
    return;
  }
  unsigned char* left = row;
  unsigned char* right = row + static_cast<std::size_t>(columns - 1) * pixelSize;
  for (; left < right; left += pixelSize, right -= pixelSize)
  {
    std::swap_ranges(left, left + pixelSize, right);
  }
}
}

std::string GetImageTypeName(std::string_view imageType)
{
  const std::string type = WithoutPrefix(imageType, "US_IMG_");
  // 3D Slicer has put "BRIGHTNESS" in front of the type
  return type.size() > Brightness.size() ? WithoutPrefix(type, Brightness) : type;
}

bool IsKnownOrientation(std::string_view orientation)
{
  const std::string letters = WithoutPrefix(orientation, "US_IMG_ORIENT_");
  return !letters.empty() && letters != "XX" && letters != "??";
}

SliceFlips GetSliceFlips(std::string_view orientation, std::string_view imageType)
{
  std::string letters = WithoutPrefix(orientation, "US_IMG_ORIENT_");
  std::transform(letters.begin(), letters.end(), letters.begin(),
    [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; });
  const std::string type = GetImageTypeName(imageType);
  const bool complex = type == "RF_IQ_LINE" || type == "RF_I_LINE_Q_LINE";
  const bool signal = complex || type == "RF_REAL";
  if (!signal && !type.empty() && type != "XX" && type != Brightness && type != "RGB_COLOR")
  {
    throw std::invalid_argument("UltrasoundImageType '" + type +
      "' is unknown; known are BRIGHTNESS, RGB_COLOR, RF_REAL, RF_IQ_LINE and RF_I_LINE_Q_LINE");
  }
  const auto oneOf = [&](std::size_t i, std::string_view allowed)
  { return allowed.find(letters[i]) != std::string_view::npos; };
  SliceFlips flips;
  const bool complete = letters.size() == 2 || (letters.size() == 3 && oneOf(2, "AD"));
  flips.Lines = complete && oneOf(0, "FN") && oneOf(1, "MU");
  const bool picture = complete && oneOf(0, "MU") && oneOf(1, "FN");
  if (!flips.Lines && (signal || !picture))
  {
    throw std::invalid_argument("UltrasoundImageOrientation '" + letters +
      "' does not describe a " +
      (signal ? "slice of radio-frequency lines; known are FM, FU, NM and NU"
              : "slice of pixels or of scan lines; known are MF, MN, UF and UN, also with A or D "
                "added, and for lines FM, FU, NM and NU"));
  }
  flips.X = letters[0] == (flips.Lines ? 'N' : 'U');
  flips.Y = letters[1] == (flips.Lines ? 'U' : 'N');
  // with I and Q in rows of their own a row can be reversed, but rows cannot change places
  const bool separate = type == "RF_I_LINE_Q_LINE";
  if (complex && (flips.Y || (flips.X && !separate)))
  {
    throw std::invalid_argument("UltrasoundImageOrientation '" + letters + "' of " + type +
      " data would need complex samples to be re-ordered; only FM " +
      (separate ? "and NM are" : "is") + " read");
  }
  return flips;
}

void FlipSlice(void* pixels, std::int64_t columns, std::int64_t rows, std::size_t pixelSize,
  const SliceFlips& flips)
{
  auto* bytes = static_cast<unsigned char*>(pixels);
  const std::size_t rowSize = static_cast<std::size_t>(columns) * pixelSize;
  if (flips.X)
  {
    for (std::int64_t row = 0; row < rows; ++row)
    {
      ReverseRow(bytes + static_cast<std::size_t>(row) * rowSize, columns, pixelSize);
    }
  }
  for (std::int64_t top = 0, bottom = rows - 1; flips.Y && top < bottom; ++top, --bottom)
  {
    unsigned char* first = bytes + static_cast<std::size_t>(top) * rowSize;
    std::swap_ranges(first, first + rowSize, bytes + static_cast<std::size_t>(bottom) * rowSize);
  }
}
}
