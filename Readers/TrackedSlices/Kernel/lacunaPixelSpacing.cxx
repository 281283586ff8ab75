// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaPixelSpacing.h"

#include "lacunaSequenceText.h"
#include "lacunaVector.h"

#include <array>
#include <charconv>
#include <cmath>
#include <limits>

namespace lacuna
{
Vec2 ReadPixelSpacing(std::string_view text)
{
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Vec2 spacing{ nan, nan };
  const auto words = SplitWords(text);
  for (std::size_t i = 0; i < 2 && i < words.size(); ++i)
  {
    if (!ParseNumber(words[i], spacing[i]))
    {
      spacing[i] = nan;
    }
  }
  return spacing;
}

bool SaysPixelSpacing(const Vec2& spacing)
{
  return spacing[0] != 1 || spacing[1] != 1;
}

bool IsPixelSpacing(const Vec2& spacing)
{
  const auto isLength = [](double length) { return std::isfinite(length) && length > 0; };
  return isLength(spacing[0]) && isLength(spacing[1]);
}

Vec2 GetPixelSpacing(const Matrix4& pixelToMm)
{
  return { Norm(pixelToMm.Column(0)), Norm(pixelToMm.Column(1)) };
}

bool IsSameSpacing(const Vec2& said, const Vec2& known)
{
  constexpr double tolerance = 0.02;
  const auto same = [](double a, double b) { return std::abs(a - b) <= tolerance * b; };
  return same(said[0], known[0]) && same(said[1], known[1]);
}

std::string FormatPixelSpacing(const Vec2& spacing)
{
  std::string text;
  for (const double value : spacing)
  {
    std::array<char, 32> digits{};
    const auto result = std::to_chars(
      digits.data(), digits.data() + digits.size(), value, std::chars_format::general, 4);
    text += (text.empty() ? "" : " x ") + std::string(digits.data(), result.ptr);
  }
  return text + " mm";
}
}
