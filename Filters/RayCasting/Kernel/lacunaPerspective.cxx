// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaPerspective.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>

namespace lacuna
{
namespace
{
constexpr double Pi = 3.14159265358979323846;
/// Nearer to the eye than this, as a part of the distance of the data's end, no plane is placed.
constexpr double TooNear = 0.05;
}

ImagePlane MakePerspectivePlane(const std::vector<Vec3>& points, double finestSpacing,
  const ViewSettings& view, const Vec3& eye, double angle)
{
  if (!IsFinite(eye))
  {
    throw std::invalid_argument(
      "a perspective view needs EyePosition: the point from which the viewer looks");
  }
  if (!(angle > 0 && angle < 180))
  {
    std::ostringstream message;
    message << "a view angle of " << angle << " degrees is not possible: give more than 0 and "
            << "less than 180";
    throw std::invalid_argument(message.str());
  }
  // also checks what was given, and finds the axes
  ViewSettings placed = view;
  placed.Size = { 1, 1 };
  const Vec3 direction = MakeImagePlane(points, finestSpacing, placed).View;
  double nearest = std::numeric_limits<double>::infinity();
  double farthest = -nearest;
  for (const Vec3& point : points)
  {
    const double z = Dot(point - eye, direction);
    nearest = std::min(nearest, z);
    farthest = std::max(farthest, z);
  }
  double distance = nearest > TooNear * farthest ? nearest : 0.5 * farthest;
  if (view.HasPlaneOrigin || view.HasFocalPoint)
  {
    distance = Dot((view.HasPlaneOrigin ? view.PlaneOrigin : view.FocalPoint) - eye, direction);
  }
  if (!(distance > 0))
  {
    throw std::invalid_argument(view.HasPlaneOrigin || view.HasFocalPoint
        ? "the image plane lies behind the eye: give a PlaneOrigin or FocalPoint before it, or "
          "turn "
          "ViewDirection round"
        : "the data lie behind the eye: move EyePosition or turn ViewDirection round");
  }
  const double height = 2 * distance * std::tan(angle * Pi / 360);
  placed = view;
  if (!(placed.PixelSpacing > 0))
  {
    placed.PixelSpacing = placed.Size[1] > 0 ? height / placed.Size[1] : finestSpacing;
  }
  if (placed.Size[1] == 0)
  {
    const double rows = std::round(height / placed.PixelSpacing);
    placed.Size[1] =
      static_cast<int>(std::min(std::max(rows, 1.0), 1.0 * std::numeric_limits<int>::max()));
  }
  if (placed.Size[0] == 0)
  {
    placed.Size[0] = placed.Size[1];
  }
  placed.HasFocalPoint = placed.HasPlaneOrigin = true;
  placed.FocalPoint = placed.PlaneOrigin = eye + distance * direction;
  return MakeImagePlane(points, finestSpacing, placed);
}

double ViewAngleOf(const ImagePlane& plane, const Vec3& eye)
{
  const double distance = Dot(plane.Origin - eye, plane.View);
  return std::atan(0.5 * plane.Size[1] * plane.PixelSpacing / distance) * 360 / Pi;
}
}
