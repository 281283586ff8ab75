// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaImagePlane.h"

#include "lacunaMemory.h"
#include "lacunaProperties.h"

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

/// Position of the first pixel along an axis and the number of pixels. focus: what is shown in the
/// middle, or null.
void Place(
  const Span& span, const double* focus, double spacing, int wanted, double& first, double& count)
{
  // A last pixel that misses the edge by rounding only is not doubled.
  const auto steps = [&](double length) { return std::ceil(length / spacing - 1e-6); };
  const double middle = focus ? *focus : 0.5 * (span.First + span.Last);
  if (wanted > 0)
  {
    count = wanted;
    first = middle - 0.5 * (count - 1) * spacing;
  }
  else if (focus)
  {
    const double half = steps(std::max(span.Last - middle, middle - span.First));
    count = 2 * half + 1;
    first = middle - half * spacing;
  }
  else
  {
    count = steps(span.Last - span.First) + 1;
    first = span.First;
  }
}

void CheckView(const ViewSettings& view)
{
  if (!HasDirection(view.Direction))
  {
    throw std::invalid_argument("the view direction " + Text(view.Direction) +
      " has no direction: give a vector that is not zero, nor too long");
  }
  if (!HasDirection(view.Up))
  {
    throw std::invalid_argument("the view-up vector " + Text(view.Up) +
      " has no direction: give a vector that is not zero, nor too long");
  }
  if (view.HasFocalPoint && !IsFinite(view.FocalPoint))
  {
    throw std::invalid_argument("the focal point " + Text(view.FocalPoint) + " is not a point");
  }
  if (view.HasPlaneOrigin && !IsFinite(view.PlaneOrigin))
  {
    throw std::invalid_argument("the plane origin " + Text(view.PlaneOrigin) + " is not a point");
  }
  ValueRange::AtLeast(0, "mm").Check("PixelSpacing", view.PixelSpacing);
  for (const int size : view.Size)
  {
    ValueRange::AtLeast(0, "pixels").Check("ImageSize", size);
  }
}
}

ImagePlane MakeImagePlane(
  const std::vector<Vec3>& points, double finestSpacing, const ViewSettings& view)
{
  CheckView(view);
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
  const auto place = [&](const Vec3& axis, std::size_t dimension, double& first, double& count)
  {
    const double focus = Dot(view.FocalPoint, axis);
    Place(Span(points, axis), view.HasFocalPoint ? &focus : nullptr, plane.PixelSpacing,
      view.Size[dimension], first, count);
  };
  place(plane.Right, 0, x, columns);
  place(plane.Down, 1, y, rows);
  if (!(columns * rows <= static_cast<double>(MaximumNumberOfPixels)))
  {
    std::ostringstream message;
    message << "an image of " << columns << " x " << rows << " pixels (" << plane.PixelSpacing
            << " mm apart) is too large: its depths alone would take "
            << DescribeBytes(sizeof(double) * columns * rows) << ". At most "
            << MaximumNumberOfPixels
            << " pixels are possible: give a larger PixelSpacing or a smaller ImageSize";
    throw std::invalid_argument(message.str());
  }
  plane.Size = { static_cast<int>(columns), static_cast<int>(rows) };
  const double z =
    view.HasPlaneOrigin ? Dot(view.PlaneOrigin, plane.View) : Span(points, plane.View).First;
  plane.Origin = x * plane.Right + y * plane.Down + z * plane.View;
  const double width = std::max(columns, rows) * plane.PixelSpacing;
  if (!IsFinite(plane.Origin) || !IsFinite(plane.Origin + width * plane.Right + width * plane.Down))
  {
    std::ostringstream message;
    message << "an image of " << columns << " x " << rows << " pixels, " << plane.PixelSpacing
            << " mm apart, does not end at any finite place: give a smaller PixelSpacing";
    throw std::invalid_argument(message.str());
  }
  return plane;
}
}
