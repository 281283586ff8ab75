// SPDX-License-Identifier: BSD-3-Clause
#include "CTTestFrames.h"
#include "lacunaCTVolume.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <mutex>
#include <set>
#include <stdexcept>

using namespace lacuna;

namespace
{
// Stored values of a frame; quadratic, so that cubic convolution is exact inside.
std::int16_t Value(double column, double row, double z)
{
  return static_cast<std::int16_t>(std::lround(40 * column + 200 * row - 30 * z));
}

void MakePixels(const CTFrame& frame, CTPixels& made)
{
  std::vector<std::int16_t> pixels;
  for (int j = 0; j < frame.Header->Rows; ++j)
  {
    for (int i = 0; i < frame.Header->Columns; ++i)
    {
      pixels.push_back(Value(i, j, (*frame.Position)[2]));
    }
  }
  made.Format = frame.Header->Format;
  made.Bytes.resize(pixels.size() * sizeof(pixels[0]));
  std::memcpy(made.Bytes.data(), pixels.data(), made.Bytes.size());
  made.Data = made.Bytes.data();
}

std::vector<std::int16_t> ReadAll(const CTGeometry& geometry, int threads = 1)
{
  ThreadExecution execution(threads);
  const std::array<int, 6> extent = { 0, static_cast<int>(geometry.Columns) - 1, 0,
    static_cast<int>(geometry.Rows) - 1, 0, static_cast<int>(geometry.Planes.size()) - 1 };
  std::vector<std::int16_t> voxels(
    static_cast<std::size_t>(geometry.Columns * geometry.Rows) * geometry.Planes.size());
  ReadCTVolume(geometry, extent, ScalarType::Int16, -1024, MakePixels, voxels.data(), execution);
  return voxels;
}

const std::vector<Vec3> Sheared = { { 0, 0, 0 }, { 0.2, 0.75, 3 }, { 0.4, 1.5, 6 },
  { 0.6, 2.25, 9 }, { 0.8, 3, 12 } };
}

TEST(CTVolume, CopiesWhatIsInPlace)
{
  const CTGeometry geometry =
    FindCTGeometry(MakeFrames({ { 0, 0, 4 }, { 0, 0, 0 }, { 0, 0, 2 } }), {});
  const std::vector<std::int16_t> voxels = ReadAll(geometry);
  for (int id = 0; id < 7 * 5 * 3; ++id)
  {
    EXPECT_EQ(voxels[id], Value(id % 7, id / 7 % 5, 2.0 * (id / 35)));
  }
}

// Linear values come out exactly at every place of a tilted image, and nothing but air beside it.
TEST(CTVolume, ShearIsExact)
{
  const CTGeometry geometry = FindCTGeometry(MakeFrames(Sheared), {});
  ASSERT_EQ(geometry.Columns, 8);
  ASSERT_EQ(geometry.Rows, 11);
  const std::vector<std::int16_t> voxels = ReadAll(geometry);
  int inside = 0;
  for (int id = 0; id < 8 * 11 * 5; ++id)
  {
    const int k = id / 88;
    const double column = id % 8 - 0.25 * k;
    const double row = id / 8 % 11 - 1.5 * k;
    const bool in = column > -1e-9 && column < 6 + 1e-9 && row > -1e-9 && row < 4 + 1e-9;
    inside += in ? 1 : 0;
    EXPECT_EQ(voxels[id], in ? Value(column, row, 3 * k) : -1024) << id;
  }
  EXPECT_GT(inside, 5 * 6 * 4);
}

TEST(CTVolume, InterpolatesBetweenSlices)
{
  CTGeometryOptions options;
  options.InterpolateMissing = true;
  const CTGeometry geometry =
    FindCTGeometry(MakeFrames({ { 0, 0, 0 }, { 0, 0, 2 }, { 0, 0, 4 }, { 0, 0, 10 } }), options);
  EXPECT_EQ(geometry.Interpolated, (std::vector<int>{ 3, 4 }));
  const std::vector<std::int16_t> voxels = ReadAll(geometry);
  for (int id = 0; id < 7 * 5 * 6; ++id)
  {
    EXPECT_EQ(voxels[id], Value(id % 7, id / 7 % 5, 2.0 * (id / 35)));
  }
}

TEST(CTVolume, SameForAnyThreads)
{
  const CTGeometry geometry = FindCTGeometry(MakeFrames(Sheared), {});
  const std::vector<std::int16_t> one = ReadAll(geometry, 1);
  EXPECT_EQ(one, ReadAll(geometry, 2));
  EXPECT_EQ(one, ReadAll(geometry, 5));
}

TEST(CTVolume, ReadsOnlyWhatIsAskedFor)
{
  CTGeometryOptions options;
  options.InterpolateMissing = true;
  const CTGeometry geometry = FindCTGeometry(
    MakeFrames({ { 0, 0, 0 }, { 0, 0, 2 }, { 0, 0, 4 }, { 0, 0, 8 }, { 0, 0, 10 } }), options);
  std::set<std::string> read;
  std::mutex mutex;
  std::int16_t voxel = 0;
  ThreadExecution execution;
  ReadCTVolume(
    geometry, { 2, 2, 1, 1, 3, 3 }, ScalarType::Int16, 0,
    [&](const CTFrame& frame, CTPixels& pixels)
    {
      const std::lock_guard<std::mutex> lock(mutex);
      read.insert(frame.GetName());
      MakePixels(frame, pixels);
    },
    &voxel, execution);
  EXPECT_EQ(read, (std::set<std::string>{ "IM2", "IM3" }));
  EXPECT_EQ(voxel, Value(2, 1, 6));
}

TEST(CTVolume, PassesErrorsAndStops)
{
  const CTGeometry geometry = FindCTGeometry(MakeFrames(Sheared), {});
  std::vector<std::int16_t> voxels(8 * 11 * 5);
  ThreadExecution execution(2);
  EXPECT_THROW(ReadCTVolume(
                 geometry, { 0, 7, 0, 10, 0, 4 }, ScalarType::Int16, 0,
                 [](const CTFrame&, CTPixels&) { throw std::runtime_error("gone"); }, voxels.data(),
                 execution),
    std::runtime_error);
  ThreadExecution stopped(2, [](double) { return false; });
  EXPECT_THROW(ReadCTVolume(geometry, { 0, 7, 0, 10, 0, 4 }, ScalarType::Int16, 0, MakePixels,
                 voxels.data(), stopped),
    Aborted);
}
