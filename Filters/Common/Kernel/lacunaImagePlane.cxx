// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaImagePlane.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string>

namespace lacuna
{
namespace
{
std::string Text(const Vec3& v)
{
  std::ostringstream text;
  text << "(" << v[0] << ", " << v[1] << ", " << v[2] << ")";
  return text.str();
}

/// Least and greatest coordinate of points along a direction.
struct Span
{
  double First = std::numeric_limits<double>::infinity();
  double Last = -std::numeric_limits<double>::infinity();

  Span(const std::vector<Vec3>& points, const Vec3& direction)
  {
    for (const Vec3& point : points)
    {
      const double x = Dot(point, direction);
      this->First = std::min(this->First, x);
      this->Last = std::max(this->Last, x);
    }
  }
};

/// Position of the first pixel along an axis and the number of pixels.
void Place(const Span& span, double spacing, int wanted, double& first, double& count)
{
  if (wanted > 0)
  {
    count = wanted;
    first = 0.5 * (span.First + span.Last) - 0.5 * (count - 1) * spacing;
    return;
  }
  first = span.First;
  // A last pixel that misses the edge by rounding only is not doubled.
  count = std::ceil((span.Last - span.First) / spacing - 1e-6) + 1;
}
}

ImagePlane MakeImagePlane(
  const std::vector<Vec3>& points, double finestSpacing, const ViewSettings& view)
{
  if (!IsFinite(view.Direction) || !(Norm(view.Direction) > 0))
  {
    throw std::invalid_argument(
      "the view direction " + Text(view.Direction) + " has no direction: give a non-zero vector");
  }
  if (!IsFinite(view.Up) || !(Norm(view.Up) > 0))
  {
    throw std::invalid_argument(
      "the view-up vector " + Text(view.Up) + " has no direction: give a non-zero vector");
  }
  if (view.HasPlaneOrigin && !IsFinite(view.PlaneOrigin))
  {
    throw std::invalid_argument("the plane origin " + Text(view.PlaneOrigin) + " is not a point");
  }
  if (!std::isfinite(view.PixelSpacing) || view.PixelSpacing < 0)
  {
    std::ostringstream message;
    message << "a pixel spacing of " << view.PixelSpacing
            << " mm is not possible: give a positive number, or 0 to take it from the data";
    throw std::invalid_argument(message.str());
  }
  if (view.Size[0] < 0 || view.Size[1] < 0)
  {
    std::ostringstream message;
    message << "an image of " << view.Size[0] << " x " << view.Size[1]
            << " pixels is not possible: give positive numbers, or 0 to fit the data";
    throw std::invalid_argument(message.str());
  }

  ImagePlane plane;
  plane.View = Normalized(view.Direction);
  const Vec3 up = Normalized(view.Up);
  const Vec3 down = Dot(up, plane.View) * plane.View - up;
  if (Norm(down) < 1e-6)
  {
    throw std::invalid_argument("the view-up vector " + Text(view.Up) +
      " is parallel to the view direction " + Text(view.Direction) +
      ": give one that points elsewhere");
  }
  plane.Down = Normalized(down);
  plane.Right = Cross(plane.Down, plane.View);

  plane.PixelSpacing = view.PixelSpacing > 0 ? view.PixelSpacing : finestSpacing;
  double x;
  double y;
  double columns;
  double rows;
  Place(Span(points, plane.Right), plane.PixelSpacing, view.Size[0], x, columns);
  Place(Span(points, plane.Down), plane.PixelSpacing, view.Size[1], y, rows);
  if (!(columns * rows <= static_cast<double>(MaximumNumberOfPixels)))
  {
    std::ostringstream message;
    message << "an image of " << columns << " x " << rows << " pixels (" << plane.PixelSpacing
            << " mm apart) is too large, at most " << MaximumNumberOfPixels
            << " pixels are possible: give a larger PixelSpacing or a smaller ImageSize";
    throw std::invalid_argument(message.str());
  }
  plane.Size = { static_cast<int>(columns), static_cast<int>(rows) };
  const double z =
    view.HasPlaneOrigin ? Dot(view.PlaneOrigin, plane.View) : Span(points, plane.View).First;
  plane.Origin = x * plane.Right + y * plane.Down + z * plane.View;
  return plane;
}
}
