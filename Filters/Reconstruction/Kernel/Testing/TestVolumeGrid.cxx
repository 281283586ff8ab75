// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaVolumeGrid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

using namespace lacuna;

namespace
{
// Slices of 101 x 51 pixels of 0.2 mm perpendicular to z: 20 x 10 mm.
std::vector<SliceImage> MakeSlices(const std::vector<double>& z)
{
  std::vector<SliceImage> slices;
  for (const double t : z)
  {
    SliceImage slice;
    slice.Width = 101;
    slice.Height = 51;
    slice.PixelToReference = Matrix4::Translation({ -4, 7, t }) * Matrix4::Scaling({ 0.2, 0.2, 1 });
    slice.Label = "slice " + std::to_string(slices.size());
    slices.push_back(slice);
  }
  return slices;
}

std::string GetError(const std::vector<SliceImage>& slices, const VolumeGridRequest& request)
{
  try
  {
    MakeVolumeGrid(slices, request);
  }
  catch (const std::invalid_argument& e)
  {
    return e.what();
  }
  return "no error";
}

bool Contains(const std::string& text, const std::string& part)
{
  return text.find(part) != std::string::npos;
}
}

TEST(VolumeGrid, HoldsTheCornersOfAllSlices)
{
  VolumeGridRequest request;
  request.Spacing = { 0.5, 0.4, 0.3 };
  const VolumeGrid grid = MakeVolumeGrid(MakeSlices({ 3, 1, 7.1 }), request);
  EXPECT_EQ(grid.Origin, (Vec3{ -4, 7, 1 }));
  EXPECT_EQ(grid.Spacing, (Vec3{ 0.5, 0.4, 0.3 }));
  // round(20 / 0.5) + 1, round(10 / 0.4) + 1, round(6.1 / 0.3) + 1
  EXPECT_EQ(grid.Dimensions, (std::array<int, 3>{ 41, 26, 21 }));
}

TEST(VolumeGrid, BoundsTakeTheBoxPerAxis)
{
  VolumeGridRequest request;
  request.Spacing = { 0.5, 0.5, 0.5 };
  request.Bounds = { 1, -1, 8, 9, 1, -1 };
  const VolumeGrid grid = MakeVolumeGrid(MakeSlices({ 1, 7 }), request);
  EXPECT_EQ(grid.Origin, (Vec3{ -4, 8, 1 }));
  EXPECT_EQ(grid.Dimensions, (std::array<int, 3>{ 41, 3, 13 }));
}

TEST(VolumeGrid, SpacingFromTheDataIsThePixelSpacingWhenTheVolumeStaysSmall)
{
  const VolumeGrid grid = MakeVolumeGrid(MakeSlices({ 1, 7 }), {});
  EXPECT_EQ(grid.Spacing, (Vec3{ 0.2, 0.2, 0.2 }));
  EXPECT_EQ(grid.Dimensions, (std::array<int, 3>{ 101, 51, 31 }));
}

TEST(VolumeGrid, SpacingFromTheDataLimitsTheNumberOfVoxels)
{
  const VolumeGrid grid = MakeVolumeGrid(MakeSlices({ 0, 500 }), {});
  // 8 421 600 voxels of 0.23 mm are just more than 2^23, the next spacing of two digits is 0.24 mm
  EXPECT_NEAR(grid.Spacing[0], 0.24, 1e-12);
  EXPECT_EQ(grid.Spacing[0], grid.Spacing[1]);
  EXPECT_EQ(grid.Spacing[0], grid.Spacing[2]);
  VolumeGridRequest oneAxis;
  oneAxis.Spacing = { 0, 2, 0 };
  EXPECT_EQ(MakeVolumeGrid(MakeSlices({ 0, 500 }), oneAxis).Spacing[1], 2);
}

TEST(VolumeGrid, AFlatBoxHasOneLayer)
{
  const VolumeGrid grid = MakeVolumeGrid(MakeSlices({ 3, 3 }), {});
  EXPECT_EQ(grid.Dimensions, (std::array<int, 3>{ 101, 51, 1 }));
}

TEST(VolumeGrid, RefusesBadRequests)
{
  const std::vector<SliceImage> slices = MakeSlices({ 1, 7 });
  VolumeGridRequest request;
  request.Spacing = { 0.5, -0.5, 0.5 };
  EXPECT_TRUE(Contains(GetError(slices, request), "OutputSpacing is -0.5 mm"));
  request.Spacing = { 0.5, 0.5, std::nan("") };
  EXPECT_TRUE(Contains(GetError(slices, request), "OutputSpacing is nan mm"));
  request.Spacing = { 0.5, 0.5, 0.5 };
  request.Bounds = { 5, -5, 1, -1, 1, -1 };
  EXPECT_TRUE(Contains(GetError(slices, request), "give the minimum first"));
  request.Bounds = { 1, -1, 1, -1, 8, 9 };
  EXPECT_TRUE(Contains(MakeVolumeGrid(slices, request).Miss, "the slices lie between 1 and 7 mm"));
  request.Bounds = { 1, -1, 1, -1, 6, 9 };
  EXPECT_EQ(MakeVolumeGrid(slices, request).Miss, "");
  request.Bounds = { 1, -1, 1, -1, 0, std::numeric_limits<double>::infinity() };
  EXPECT_TRUE(Contains(GetError(slices, request), "OutputBounds along z"));
  EXPECT_TRUE(Contains(GetError({}, {}), "no slices"));
}

TEST(VolumeGrid, RefusesMoreMemoryThanAllowedAndSaysWhatWouldFit)
{
  VolumeGridRequest request;
  request.Spacing = { 0.01, 0.01, 0.01 };
  request.BytesPerVoxel = 14;
  request.MemoryLimit = 1e9;
  const std::vector<SliceImage> slices = MakeSlices({ 1, 7 });
  const std::string error = GetError(slices, request);
  EXPECT_TRUE(Contains(error, "2001 x 1001 x 601 voxels")) << error;
  EXPECT_TRUE(Contains(error, "16853250414 bytes")) << error;
  EXPECT_TRUE(Contains(error, "MemoryLimit")) << error;
  EXPECT_FALSE(Contains(error, "slice")) << error;
  const std::string marker = "An OutputSpacing of ";
  const double advised = std::stod(error.substr(error.find(marker) + marker.size()));
  request.Spacing = { advised, advised, advised };
  EXPECT_EQ(GetError(slices, request), "no error");
  request.Spacing = { 0.93 * advised, 0.93 * advised, 0.93 * advised };
  EXPECT_NE(GetError(slices, request), "no error");
}

TEST(VolumeGrid, NamesASliceThatLiesFarOff)
{
  VolumeGridRequest request;
  request.Spacing = { 0.2, 0.2, 0.2 };
  request.BytesPerVoxel = 14;
  request.MemoryLimit = 1e9;
  const std::string error = GetError(MakeSlices({ 1, 2, 3, 1e7, 4, 5, 6 }), request);
  EXPECT_TRUE(Contains(error, "slice 3 lies 1e+07 mm from the middle")) << error;
  EXPECT_TRUE(Contains(error, "SliceStatus")) << error;
}

TEST(VolumeGrid, SurvivesAbsurdSizes)
{
  VolumeGridRequest request;
  request.Spacing = { 1e-300, 1e-300, 1e-300 };
  EXPECT_TRUE(Contains(GetError(MakeSlices({ 1, 7 }), request), "bytes"));
  // too many voxels along one axis for an extent, though little memory
  request.Spacing = { 1e9, 1e9, 1e-9 };
  EXPECT_TRUE(Contains(GetError(MakeSlices({ 1, 7 }), request), "voxels"));
}
