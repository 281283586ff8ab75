// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The image plane of a perspective view.
#ifndef lacunaPerspective_h
#define lacunaPerspective_h

#include "lacunaImagePlane.h"

namespace lacuna
{
/// The plane perpendicular to view.Direction through view.PlaneOrigin, else through view.FocalPoint,
/// else through the corner of the data (within the convex hull of points) nearest the eye; when the
/// eye is among or close to the data, halfway to their end. The line from the eye along
/// view.Direction meets its middle. angle: which the rows span, degrees. view.PixelSpacing 0: from
/// the angle and the number of rows; both 0: finestSpacing. view.Size 0: as many rows as the angle
/// takes, and as many columns as rows. Given both the spacing and the number of rows, the angle
/// follows from them. Throws std::invalid_argument for what cannot be seen.
ImagePlane MakePerspectivePlane(const std::vector<Vec3>& points, double finestSpacing,
  const ViewSettings& view, const Vec3& eye, double angle);

/// The angle that the rows of a plane span at the eye, degrees.
double ViewAngleOf(const ImagePlane& plane, const Vec3& eye);
}
#endif
