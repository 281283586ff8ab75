// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaFan.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

namespace lacuna
{
namespace
{
// Of a pixel: points on the border, as in fans that pass exactly through pixels, do not drop out by
// chance.
constexpr double RelativeTolerance = 1e-6;

void CheckPair(const char* name, const Vec2& pair, const char* unit)
{
  if (!std::isfinite(pair[0]) || !std::isfinite(pair[1]) || !(pair[0] < pair[1]))
  {
    std::ostringstream message;
    message << "the fan's " << name << " are " << pair[0] << " and " << pair[1] << " " << unit
            << "; the first must be the smaller one";
    throw std::invalid_argument(message.str());
  }
}

Vec2 GetDirection(double degrees)
{
  const double radians = degrees * std::acos(-1.0) / 180;
  return { std::cos(radians), std::sin(radians) };
}
}

FanMask::FanMask(const Fan& fan, int width, int height, const Vec2& pixelSpacing)
  : Shape(fan)
  , Width(width)
  , PixelSpacing(pixelSpacing)
  , Tolerance(RelativeTolerance * std::min(pixelSpacing[0], pixelSpacing[1]))
  , IsWide(fan.Angles[1] - fan.Angles[0] > 180)
  , First(GetDirection(fan.Angles[0]))
  , Last(GetDirection(fan.Angles[1]))
{
  CheckPair("angles", fan.Angles, "degrees");
  CheckPair("radii", fan.Radii, "mm");
  std::ostringstream message;
  if (fan.Angles[1] - fan.Angles[0] > 360)
  {
    message << "the fan's angles are " << fan.Angles[0] << " and " << fan.Angles[1]
            << " degrees; more than 360 degrees apart";
  }
  else if (fan.Radii[0] < 0)
  {
    message << "the fan's first radius is " << fan.Radii[0] << " mm; it must not be negative";
  }
  else if (!std::isfinite(fan.Origin[0]) || !std::isfinite(fan.Origin[1]))
  {
    message << "the fan's origin is not finite";
  }
  else if (!(pixelSpacing[0] > 0) || !(pixelSpacing[1] > 0) || width < 1 || height < 1)
  {
    message << "a fan needs an image of at least one pixel of positive size";
  }
  if (!message.str().empty())
  {
    throw std::invalid_argument(message.str());
  }
  const double inner = std::max(0.0, fan.Radii[0] - this->Tolerance);
  const double outer = fan.Radii[1] + this->Tolerance;
  this->Squares = { inner * inner, outer * outer };

  this->Rows.push_back(0);
  for (int row = 0; row < height; ++row)
  {
    bool isInside = false;
    for (int column = 0; column < width; ++column)
    {
      const bool was = isInside;
      isInside = this->Contains(column, row);
      if (isInside && !was)
      {
        this->Columns.push_back({ column, column });
      }
      else if (isInside)
      {
        this->Columns.back().Last = column;
      }
    }
    this->Rows.push_back(this->Columns.size());
  }
  if (this->Columns.empty())
  {
    message << "no pixel of the " << width << " x " << height
            << " image lies in the fan: origin at column " << fan.Origin[0] << ", row "
            << fan.Origin[1] << ", angles " << fan.Angles[0] << " to " << fan.Angles[1]
            << " degrees, radii " << fan.Radii[0] << " to " << fan.Radii[1] << " mm, pixels of "
            << pixelSpacing[0] << " x " << pixelSpacing[1] << " mm";
    throw std::invalid_argument(message.str());
  }
}
}
