// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaTestField.h"
#include "lacunaVoxelVolume.h"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>
#include <string>

namespace
{
using namespace lacuna;

std::string ErrorOf(const ViewSettings& view, const std::array<int, 3>& size = { 10, 20, 30 })
{
  try
  {
    MakeImagePlane(Matrix4(), size, view);
  }
  catch (const std::invalid_argument& e)
  {
    return e.what();
  }
  return "";
}

void ExpectNear(const Vec3& a, const Vec3& b, double tolerance = 1e-12)
{
  EXPECT_NEAR(Norm(a - b), 0, tolerance) << a[0] << " " << a[1] << " " << a[2];
}
}

TEST(ImagePlane, FromTheTop)
{
  const Matrix4 m = Matrix4::Translation({ 100, 200, 300 }) * Matrix4::Scaling({ 0.5, 0.5, 2 });
  const ImagePlane plane = MakeImagePlane(m, { 11, 21, 31 }, ViewSettings());
  ExpectNear(plane.Right, { 1, 0, 0 });
  ExpectNear(plane.Down, { 0, -1, 0 });
  ExpectNear(plane.View, { 0, 0, -1 });
  EXPECT_EQ(plane.PixelSpacing, 0.5);
  EXPECT_EQ(plane.Size[0], 11);
  EXPECT_EQ(plane.Size[1], 21);
  // top left of the picture: least x, greatest y, the face of the volume nearest the viewer
  ExpectNear(plane.Origin, { 100, 210, 360 });
  ExpectNear(plane.PixelPosition(10, 20), { 105, 200, 360 });
}

TEST(ImagePlane, AxesOfAnyViewAreTheViewers)
{
  std::mt19937 random(5);
  for (int trial = 0; trial < 200; ++trial)
  {
    ViewSettings view;
    view.Direction = 7 * RandomUnit(random);
    view.Up = 0.3 * RandomUnit(random);
    const Matrix4 m = RandomFrame(random, { 1, 2, 0.7 }, trial % 2 != 0);
    const std::array<int, 3> size{ 12, 7, 9 };
    const ImagePlane plane = MakeImagePlane(m, size, view);
    EXPECT_NEAR(Norm(plane.Right), 1, 1e-12);
    EXPECT_NEAR(Norm(plane.Down), 1, 1e-12);
    ExpectNear(Cross(plane.Right, plane.Down), plane.View);
    EXPECT_GT(Dot(Cross(view.Direction, view.Up), plane.Right), 0);
    EXPECT_LT(Dot(view.Up, plane.Down), 0);
    EXPECT_NEAR(Dot(view.Up, plane.Right), 0, 1e-12);
    EXPECT_NEAR(plane.PixelSpacing, 0.7, 1e-12) << "smallest edge";
    // every corner is within the picture and behind the plane, one of them in it
    double nearest = 1e9;
    for (int corner = 0; corner < 8; ++corner)
    {
      const Vec3 p = m.Point({ corner & 1 ? 11.0 : 0, corner & 2 ? 6.0 : 0, corner & 4 ? 8.0 : 0 });
      const Vec3 local = p - plane.Origin;
      const double column = Dot(local, plane.Right) / plane.PixelSpacing;
      const double row = Dot(local, plane.Down) / plane.PixelSpacing;
      nearest = std::min(nearest, Dot(local, plane.View));
      EXPECT_GT(column, -1e-9);
      EXPECT_LT(column, plane.Size[0] - 1 + 1e-5);
      EXPECT_GT(row, -1e-9);
      EXPECT_LT(row, plane.Size[1] - 1 + 1e-5);
    }
    EXPECT_NEAR(nearest, 0, 1e-9);
  }
}

TEST(ImagePlane, GivenSizeIsCentred)
{
  ViewSettings view;
  view.Size = { 5, 4 };
  view.PixelSpacing = 3;
  const ImagePlane plane = MakeImagePlane(Matrix4(), { 11, 21, 31 }, view);
  ExpectNear(0.5 * (plane.PixelPosition(0, 0) + plane.PixelPosition(4, 3)), { 5, 10, 30 });
}

TEST(ImagePlane, PlaneOriginMovesThePlaneOnly)
{
  ViewSettings view;
  const ImagePlane before = MakeImagePlane(Matrix4(), { 11, 21, 31 }, view);
  view.HasPlaneOrigin = true;
  view.PlaneOrigin = { 77, -88, 99 };
  const ImagePlane plane = MakeImagePlane(Matrix4(), { 11, 21, 31 }, view);
  EXPECT_EQ(plane.Size, before.Size);
  ExpectNear(plane.Origin, { 0, 20, 99 });
}

TEST(ImagePlane, RefusesWhatCannotBeSeen)
{
  const double nan = std::numeric_limits<double>::quiet_NaN();
  ViewSettings view;
  EXPECT_EQ(ErrorOf(view), "");
  view.Direction = { 0, 0, 0 };
  EXPECT_NE(ErrorOf(view).find("view direction (0, 0, 0)"), std::string::npos);
  view.Direction = { nan, 0, 0 };
  EXPECT_NE(ErrorOf(view).find("view direction"), std::string::npos);
  view = ViewSettings();
  view.Up = { 0, 0, 5 };
  EXPECT_NE(ErrorOf(view).find("parallel"), std::string::npos);
  view.Up = { 0, 0, 0 };
  EXPECT_NE(ErrorOf(view).find("view-up"), std::string::npos);
  view = ViewSettings();
  for (const double spacing : { -1.0, nan, std::numeric_limits<double>::infinity() })
  {
    view.PixelSpacing = spacing;
    EXPECT_NE(ErrorOf(view).find("PixelSpacing is "), std::string::npos) << spacing;
  }
  view.PixelSpacing = 1e308;
  view.Size = { 22, 3 };
  EXPECT_NE(ErrorOf(view).find("finite place"), std::string::npos) << ErrorOf(view);
  view.Size = ViewSettings().Size;
  for (const double spacing : { 1e-9, 1e-300, 5e-324 })
  {
    view.PixelSpacing = spacing;
    EXPECT_NE(ErrorOf(view).find("too large"), std::string::npos) << spacing;
  }
  view = ViewSettings();
  view.Size = { 2147483647, 2147483647 };
  EXPECT_NE(ErrorOf(view).find("too large"), std::string::npos);
  view.Size = { -3, 5 };
  EXPECT_NE(ErrorOf(view).find("ImageSize is -3 pixels"), std::string::npos);
  view = ViewSettings();
  view.HasPlaneOrigin = true;
  view.PlaneOrigin = { 0, nan, 0 };
  EXPECT_NE(ErrorOf(view).find("plane origin"), std::string::npos);
  EXPECT_NE(ErrorOf(ViewSettings(), { 10, 10, 1 }).find("at least two voxels"), std::string::npos);
}
