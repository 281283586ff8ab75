// SPDX-License-Identifier: BSD-3-Clause
/// Planes for looking at points; TestImagePlane of the ray-casting kernel looks at volumes.
#include "lacunaImagePlane.h"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

using namespace lacuna;

namespace
{
// Seen from the top (right = x, down = -y): 10 mm wide, 6 mm high, 3 mm deep.
const std::vector<Vec3> Points{ { 0, 0, 0 }, { 10, 2, 3 }, { 4, 6, 1 } };

void ExpectNear(const Vec3& a, const Vec3& b)
{
  EXPECT_NEAR(Norm(a - b), 0, 1e-12) << a[0] << " " << a[1] << " " << a[2];
}
}

TEST(ImagePlanePoints, FitsThePoints)
{
  const ImagePlane plane = MakeImagePlane(Points, 0.5, ViewSettings());
  EXPECT_EQ(plane.PixelSpacing, 0.5);
  EXPECT_EQ(plane.Size, (std::array<int, 2>{ 21, 13 }));
  ExpectNear(plane.Origin, { 0, 6, 3 });
}

TEST(ImagePlanePoints, OnePointIsOnePixel)
{
  const ImagePlane plane = MakeImagePlane({ { 1, 2, 3 } }, 0.5, ViewSettings());
  EXPECT_EQ(plane.Size, (std::array<int, 2>{ 1, 1 }));
  ExpectNear(plane.Origin, { 1, 2, 3 });
}

TEST(ImagePlanePoints, FocalPointIsInTheMiddle)
{
  ViewSettings view;
  view.HasFocalPoint = true;
  view.FocalPoint = { 3.1, 2.3, 77 };
  // fitted: the farthest edge decides on either side
  ImagePlane plane = MakeImagePlane(Points, 0.5, view);
  EXPECT_EQ(plane.Size, (std::array<int, 2>{ 2 * 14 + 1, 2 * 8 + 1 }));
  ExpectNear(plane.PixelPosition(14, 8), { 3.1, 2.3, 3 });
  EXPECT_LE(plane.PixelPosition(0, 0)[0], 0);
  EXPECT_GE(plane.PixelPosition(28, 0)[0], 10);
  EXPECT_GE(plane.PixelPosition(0, 0)[1], 6);
  EXPECT_LE(plane.PixelPosition(0, 16)[1], 0);
  // of a given size, also an even one
  view.Size = { 4, 3 };
  plane = MakeImagePlane(Points, 0.5, view);
  EXPECT_EQ(plane.Size, view.Size);
  ExpectNear(0.5 * (plane.PixelPosition(0, 0) + plane.PixelPosition(3, 2)), { 3.1, 2.3, 3 });
  // beside the data
  view.Size = { 0, 0 };
  view.FocalPoint = { -5, 3, 0 };
  plane = MakeImagePlane(Points, 1, view);
  EXPECT_EQ(plane.Size, (std::array<int, 2>{ 31, 7 }));
  ExpectNear(plane.Origin, { -20, 6, 3 });
}

TEST(ImagePlanePoints, DoesNotDependOnThePointsWhenAllIsGiven)
{
  ViewSettings view;
  view.Direction = { 0.3, -0.8, 0.2 };
  view.HasFocalPoint = view.HasPlaneOrigin = true;
  view.FocalPoint = { 1, 2, 3 };
  view.PlaneOrigin = { -7, 0, 2 };
  view.PixelSpacing = 0.25;
  view.Size = { 40, 30 };
  const ImagePlane plane = MakeImagePlane(Points, 0.5, view);
  const ImagePlane other = MakeImagePlane({ { 9, 8, 7 }, { 900, -1, 1 } }, 0.1, view);
  EXPECT_EQ(plane.Origin, other.Origin);
  EXPECT_EQ(plane.Size, other.Size);
  EXPECT_EQ(plane.PixelSpacing, other.PixelSpacing);
}

TEST(ImagePlanePoints, RefusesAFocalPointThatIsNone)
{
  ViewSettings view;
  view.HasFocalPoint = true;
  view.FocalPoint = { 0, std::numeric_limits<double>::quiet_NaN(), 0 };
  try
  {
    MakeImagePlane(Points, 0.5, view);
    FAIL();
  }
  catch (const std::invalid_argument& e)
  {
    EXPECT_NE(std::string(e.what()).find("focal point"), std::string::npos);
  }
  // as far off as numbers go: too many pixels, no overflow
  view.FocalPoint = { 1e300, 0, 0 };
  EXPECT_THROW(MakeImagePlane(Points, 0.5, view), std::invalid_argument);
}
