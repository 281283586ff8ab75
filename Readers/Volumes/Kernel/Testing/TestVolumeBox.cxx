// SPDX-License-Identifier: BSD-3-Clause
#include "VolumeTesting.h"

#include <limits>

using namespace lacuna;
using namespace volume_testing;

TEST(VolumeBox, KeepsWhatIsStraight)
{
  const Matrix4 turn = Matrix4::Rotation({ { 1, 2, 3 } }, 0.7);
  Matrix4 matrix = Matrix4::FromColumns(
    0.9 * turn.Column(0), 0.9 * turn.Column(1), 1.1 * turn.Column(2), { { 1, 2, 3 } });
  const VolumeBox grid = FindVolumeBox(matrix, { 512, 512, 300 });
  EXPECT_FALSE(grid.ReversedSlices);
  for (int i = 0; i < 3; ++i)
  {
    EXPECT_LT(Norm(grid.Axes[static_cast<std::size_t>(i)] - turn.Column(i)), 1e-14);
  }
  EXPECT_NEAR(grid.Spacing[2], 1.1, 1e-15);
  EXPECT_EQ(grid.Origin[2], 3);
  // exactly, along the axes
  const VolumeBox straight =
    FindVolumeBox(Matrix4::Scaling({ { -0.9, -0.7, 0.3 } }), { 512, 512, 300 });
  EXPECT_EQ(straight.Spacing[0], 0.9);
  EXPECT_EQ(straight.Spacing[1], 0.7);
  EXPECT_EQ(straight.Axes[0][0], -1);
  EXPECT_EQ(straight.Axes[0][1], 0);
}

TEST(VolumeBox, TurnsLeftHandedAxes)
{
  const Matrix4 matrix =
    Matrix4::FromColumns({ { 0.9, 0, 0 } }, { { 0, 0.7, 0 } }, { { 0, 0, -2 } }, { { 1, 2, 50 } });
  const VolumeBox grid = FindVolumeBox(matrix, { 10, 10, 21 });
  EXPECT_TRUE(grid.ReversedSlices);
  EXPECT_EQ(grid.Origin[2], 10);
  EXPECT_EQ(grid.Axes[2][2], 1);
}

TEST(VolumeBox, RoundedDirectionsPassAndShearedOnesDoNot)
{
  const auto sheared = [](double by)
  {
    return Matrix4::FromColumns(
      { { 1, 0, 0 } }, { { 0, 1, 0 } }, { { 0, by, 1 } }, { { 0, 0, 0 } });
  };
  const VolumeBox grid = FindVolumeBox(sheared(1e-4), { 100, 100, 100 });
  EXPECT_NEAR(Dot(grid.Axes[1], grid.Axes[2]), 0, 1e-15);
  // each axis takes half of the shear
  EXPECT_NEAR(grid.Axes[1][2], -0.5e-4, 1e-8);
  ExpectParts(GetError(
                [&] {
                  FindVolumeBox(sheared(2e-3), { 100, 100, 100 });
                }),
    { "not at right angles", "by 0.14", "mm" });
  ExpectParts(GetError([&] { FindVolumeBox(sheared(3), { 100, 100, 100 }); }), { "far from it" });
}

TEST(VolumeBox, RefusesNonsense)
{
  Matrix4 matrix;
  matrix(1, 1) = std::numeric_limits<double>::quiet_NaN();
  ExpectParts(GetError([&] { FindVolumeBox(matrix, { 4, 4, 4 }); }), { "not finite" });
  matrix(1, 1) = 0;
  ExpectParts(GetError([&] { FindVolumeBox(matrix, { 4, 4, 4 }); }), { "axis 1", "no length" });
  matrix(1, 0) = matrix(1, 1) = 1;
  matrix(0, 1) = matrix(0, 0) = 1; // two axes the same
  ExpectParts(GetError([&] { FindVolumeBox(matrix, { 4, 4, 4 }); }), { "right angles" });
  matrix = Matrix4();
  matrix(0, 0) = 1e300;
  matrix(1, 0) = 1e300;
  GetError([&] { FindVolumeBox(matrix, { 4, 4, 4 }); });
}

TEST(VolumeBox, Types)
{
  EXPECT_EQ(GetVolumeType(ScalarType::UInt8, 1, 0), ScalarType::UInt8);
  EXPECT_EQ(GetVolumeType(ScalarType::UInt8, 1, -1024), ScalarType::Int16);
  EXPECT_EQ(GetVolumeType(ScalarType::Int16, 1, -1024), ScalarType::Int32);
  EXPECT_EQ(GetVolumeType(ScalarType::UInt16, -1, 0), ScalarType::Int32);
  EXPECT_EQ(GetVolumeType(ScalarType::Int16, 0.5, 0), ScalarType::Float32);
  EXPECT_EQ(GetVolumeType(ScalarType::Int32, 2, 0), ScalarType::Float64);
  EXPECT_EQ(GetVolumeType(ScalarType::Float32, 2, 0), ScalarType::Float32);
  EXPECT_EQ(GetVolumeType(ScalarType::Float64, 2, 0), ScalarType::Float64);
}

TEST(VolumeBox, PartsAndValues)
{
  NrrdFile file;
  file.Set("type", "short");
  file.Set("dimension", "3");
  file.Set("space", "LPS");
  file.Set("sizes", "4 3 2");
  file.Set("space directions", "(1,0,0) (0,1,0) (0,0,-1)");
  file.Set("space origin", "(0,0,0)");
  file.Set("endian", "little");
  file.Set("encoding", "raw");
  file.Pixels = MakeVoxels();
  const TemporaryFile stored("ct.nrrd", file.GetContent());
  VolumeFile volume = ReadVolumeFile(stored.GetPath());
  volume.Slope = 2;
  volume.Intercept = -1024;
  const VolumeBox grid = FindVolumeBox(volume.IndexToPatient, { Columns, Rows, Slices });
  const auto pixels = PixelSource::Open(volume.Slices);
  ThreadExecution execution(1);
  std::vector<std::int32_t> part(4);
  // columns 1 and 2, rows 1 and 2, slice 1 of the grid, which is the file's first
  ReadVolume(volume, grid, *pixels, { 1, 2, 1, 2, 1, 1 }, part.data(), execution);
  EXPECT_EQ(part,
    (std::vector<std::int32_t>{ 2 * GetValue(1, 1, 0) - 1024, 2 * GetValue(2, 1, 0) - 1024,
      2 * GetValue(1, 2, 0) - 1024, 2 * GetValue(2, 2, 0) - 1024 }));
}
