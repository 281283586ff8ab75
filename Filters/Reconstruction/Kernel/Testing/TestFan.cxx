// SPDX-License-Identifier: BSD-3-Clause
/// Fans: which pixels they hold, and that nothing else gets into the volume.
#include "lacunaSyntheticSweep.h"

#include "lacunaFan.h"
#include "lacunaSampledSlice.h"

#include <gtest/gtest.h>

#include <algorithm>

using namespace lacuna;

namespace
{
const double Degree = std::acos(-1.0) / 180;

// The definition, by angle and distance; doubtful where rounding decides.
struct NaiveFan
{
  NaiveFan(const Fan& fan, const Vec2& spacing, double column, double row)
  {
    const double x = spacing[0] * (column - fan.Origin[0]);
    const double y = spacing[1] * (row - fan.Origin[1]);
    const double radius = std::hypot(x, y);
    double angle = std::atan2(x, y) / Degree;
    while (angle < fan.Angles[0])
    {
      angle += 360;
    }
    this->IsInside = angle <= fan.Angles[1] && radius >= fan.Radii[0] && radius <= fan.Radii[1];
    const double opening = fan.Angles[1] - fan.Angles[0];
    const double off = std::min(
      { angle - fan.Angles[0], std::abs(angle - fan.Angles[1]), 360 + fan.Angles[0] - angle });
    this->IsDoubtful = (opening < 360 && radius * off * Degree < 1e-5) ||
      std::abs(radius - fan.Radii[0]) < 1e-5 || std::abs(radius - fan.Radii[1]) < 1e-5;
  }
  bool IsInside, IsDoubtful;
};

const std::array<Fan, 6> Fans{ Fan{ { 30.2, -14.7 }, { -30, 41 }, { 6, 15 } },
  Fan{ { 31, 20 }, { 10, 80 }, { 0, 9 } }, Fan{ { 31, 20 }, { -170, 100 }, { 2, 9 } },
  Fan{ { 31, 20 }, { -180, 180 }, { 3, 8 } }, Fan{ { 20.5, 11.5 }, { 100, 280 }, { 1, 5 } },
  Fan{ { 25, 55 }, { 150, 215 }, { 3, 12 } } };

std::string GetError(const Fan& fan)
{
  try
  {
    const FanMask mask(fan, 64, 48, { 0.1, 0.1 });
  }
  catch (const std::invalid_argument& e)
  {
    return e.what();
  }
  return "no error";
}
}

TEST(Fan, HoldsWhatItsAnglesAndRadiiSay)
{
  const Vec2 spacing{ 0.31, 0.23 };
  for (const Fan& fan : Fans)
  {
    const FanMask mask(fan, 61, 49, spacing);
    EXPECT_EQ(mask.GetWidth(), 61);
    EXPECT_EQ(mask.GetHeight(), 49);
    int inside = 0;
    for (int row = 0; row < 49; ++row)
    {
      std::vector<bool> runs(61, false);
      for (const IndexInterval& run : mask.GetRuns(row))
      {
        for (std::int64_t column = run.First; column <= run.Last; ++column)
        {
          EXPECT_FALSE(runs.at(column));
          runs.at(column) = true;
        }
      }
      for (int column = 0; column < 61; ++column)
      {
        const NaiveFan naive(fan, spacing, column, row);
        EXPECT_EQ(runs[column], mask.Contains(column, row));
        if (!naive.IsDoubtful)
        {
          EXPECT_EQ(runs[column], naive.IsInside) << column << " " << row;
          inside += naive.IsInside ? 1 : 0;
        }
        const NaiveFan between(fan, spacing, column + 0.37, row - 0.71);
        if (!between.IsDoubtful)
        {
          EXPECT_EQ(mask.Contains(column + 0.37, row - 0.71), between.IsInside);
        }
      }
    }
    EXPECT_GT(inside, 200);
    EXPECT_LT(inside, 61 * 49 * 9 / 10);
  }
}

TEST(Fan, TurnsFromDepthTowardsGrowingColumns)
{
  const FanMask mask({ { 10, 0 }, { 0, 40 }, { 0, 100 } }, 21, 21, { 1, 1 });
  EXPECT_TRUE(mask.Contains(14, 10));
  EXPECT_FALSE(mask.Contains(6, 10));
  // the borders belong to it, and so does the origin
  EXPECT_TRUE(mask.Contains(10, 10));
  EXPECT_TRUE(mask.Contains(10, 0));
  EXPECT_TRUE(mask.Contains(10, 100));
  EXPECT_FALSE(mask.Contains(10, 101));
}

TEST(Fan, RefusesWhatIsNoFan)
{
  EXPECT_EQ(GetError({ { 30, 0 }, { 20, -20 }, { 0, 4 } }),
    "the fan's angles are 20 and -20 degrees; the first must be the smaller one");
  EXPECT_EQ(GetError({ { 30, 0 }, { -20, 20 }, { 4, 4 } }),
    "the fan's radii are 4 and 4 mm; the first must be the smaller one");
  EXPECT_NE(GetError({ { 30, 0 }, { std::nan(""), 20 }, { 0, 4 } }).find("nan"), std::string::npos);
  EXPECT_NE(GetError({ { 30, 0 }, { -20, 341 }, { 0, 4 } }).find("360"), std::string::npos);
  EXPECT_NE(GetError({ { 30, 0 }, { -20, 20 }, { -1, 4 } }).find("negative"), std::string::npos);
  EXPECT_NE(
    GetError({ { std::nan(""), 0 }, { -20, 20 }, { 0, 4 } }).find("finite"), std::string::npos);
  EXPECT_EQ(GetError({ { 30, 0 }, { -20, 20 }, { 50, 60 } }).find("no pixel of the 64 x 48"), 0U);
  EXPECT_EQ(GetError({ { 30, 0 }, { -180, 180 }, { 0, 4 } }), "no error");
}

TEST(Fan, NothingElseGetsIntoTheVolume)
{
  // not a number outside of the fan, 80 in it
  for (const Fan& fan : Fans)
  {
    const Vec2 spacing{ 0.31, 0.23 };
    const auto mask = std::make_shared<const FanMask>(fan, 61, 49, spacing);
    SyntheticSweep<float> sweep(61, 49, ScalarType::Float32);
    for (int n = 0; n < 4; ++n)
    {
      sweep.Add(Matrix4::Rotation({ 1, 2, 3 }, 0.7) *
          Matrix4::Translation({ 0.3 * n, 0, 0.8 * n }) * Matrix4::Rotation({ 0, 1, 0 }, 0.05 * n) *
          Matrix4::Scaling({ spacing[0], spacing[1], 1 }),
        [&](int x, int y) { return mask->Contains(x, y) ? 80 : std::nan(""); });
      sweep.Slices.back().Fan = mask;
    }
    const VolumeGrid grid = MakeGrid(sweep.Slices, { 0.6, 0.5, 0.55 });
    for (const PixelSampling sampling :
      { PixelSampling::Footprint, PixelSampling::Bilinear, PixelSampling::Nearest })
    {
      SweptVolume::Options options;
      options.Sampling = sampling;
      const auto volume = Reconstruct<float>(sweep.Slices, grid, GetExtent(grid), options, 2);
      // without fans: between the slices; with them, only where all feet lie in the fan
      const std::vector<float> white(61 * 49, 80);
      std::vector<SliceImage> plain = sweep.Slices;
      for (SliceImage& slice : plain)
      {
        slice.Fan.reset();
        slice.Pixels = white.data();
      }
      const auto all = Reconstruct<float>(plain, grid, GetExtent(grid), options, 2);
      std::size_t n = 0;
      int filled = 0;
      int tips = 0;
      for (int k = 0; k < grid.Dimensions[2]; ++k)
      {
        for (int j = 0; j < grid.Dimensions[1]; ++j)
        {
          for (int i = 0; i < grid.Dimensions[0]; ++i, ++n)
          {
            if (volume.Mask[n])
            {
              ++filled;
              EXPECT_FLOAT_EQ(volume.Intensity[n], 80);
            }
            if (all.Contributions[n] != 1)
            {
              EXPECT_LE(volume.Contributions[n], all.Contributions[n]);
              continue;
            }
            // the pair is the one whose planes lie on both sides
            const Vec3 p = GetPoint(grid, i, j, k);
            const auto locate = [&](int s)
            {
              const Matrix4& m = sweep.Slices[s].PixelToReference;
              return Matrix4::FromColumns(
                m.Column(0), m.Column(1), Normalized(Cross(m.Column(0), m.Column(1))), m.Column(3))
                .Inverse()
                .Point(p);
            };
            for (int s = 0; s < 3; ++s)
            {
              const Vec3 a = locate(s);
              const Vec3 b = locate(s + 1);
              const NaiveFan first(fan, spacing, a[0], a[1]);
              const NaiveFan second(fan, spacing, b[0], b[1]);
              if (a[2] < 0 || b[2] > 0 || first.IsDoubtful || second.IsDoubtful)
              {
                continue;
              }
              const bool inside = first.IsInside && second.IsInside;
              // a tip may lie between the pixels; then, the voxel is empty
              tips += inside && !volume.Mask[n] ? 1 : 0;
              if (!inside)
              {
                EXPECT_EQ(volume.Mask[n], 0);
              }
            }
          }
        }
      }
      EXPECT_GT(filled, 100);
      // the nearest pixel of a foot at the border is one outside every second time
      EXPECT_LE(tips, sampling == PixelSampling::Nearest ? filled / 4 : filled / 200);
    }
    SweptVolume::Options options;
    options.Interpolation = SweptVolume::Method::NearestVoxel;
    const auto volume = Reconstruct<float>(sweep.Slices, grid, GetExtent(grid), options, 2);
    std::int64_t put = 0;
    for (std::size_t n = 0; n < volume.Mask.size(); ++n)
    {
      put += volume.Contributions[n];
      EXPECT_FLOAT_EQ(volume.Intensity[n], volume.Mask[n] ? 80.0F : 0.0F);
    }
    std::int64_t pixels = 0;
    for (int row = 0; row < 49; ++row)
    {
      for (const IndexInterval& run : mask->GetRuns(row))
      {
        pixels += 4 * (run.Last - run.First + 1);
      }
    }
    EXPECT_EQ(put, pixels);
  }
}

TEST(Fan, MeansAreThoseOfThePixelsInIt)
{
  // one voxel footprint of some pixels, of random grey levels, next to the fan's border
  const FanMask mask({ { 18.3, -9 }, { -25, 33 }, { 15, 33 } }, 37, 29, { 1, 1 });
  std::mt19937 random(5);
  std::vector<std::int16_t> pixels(std::size_t(41) * 29);
  for (std::int16_t& p : pixels)
  {
    p = static_cast<std::int16_t>(random() % 4000 - 2000);
  }
  for (const double width : { 0.0, 1.6, 4.0, 9.9 })
  {
    const FootprintAxis columns(37, width);
    const FootprintAxis rows(29, 0.7 * width);
    const std::size_t size =
      std::size_t(1) * columns.GetNumberOfSamples() * rows.GetNumberOfSamples();
    std::vector<double> sums(size);
    std::vector<double> weights(size);
    AverageFootprintsInFan(pixels.data(), 41, columns, rows, mask, sums.data(), weights.data(),
      columns.GetNumberOfSamples());
    double most = 0;
    double least = 1;
    for (int r = 0; r < rows.GetNumberOfSamples(); ++r)
    {
      for (int c = 0; c < columns.GetNumberOfSamples(); ++c)
      {
        double sum = 0;
        double weight = 0;
        for (int t = 0; t < rows.GetNumberOfTaps(); ++t)
        {
          for (int s = 0; s < columns.GetNumberOfTaps(); ++s)
          {
            const int column = columns.GetStart(c) + s;
            const int row = rows.GetStart(r) + t;
            if (mask.Contains(column, row))
            {
              sum += rows.GetWeights(r)[t] * columns.GetWeights(c)[s] * pixels[row * 41 + column];
              weight += rows.GetWeights(r)[t] * columns.GetWeights(c)[s];
            }
          }
        }
        const int n = r * columns.GetNumberOfSamples() + c;
        EXPECT_NEAR(sums[n], sum, 1e-9);
        EXPECT_NEAR(weights[n], weight, 1e-12);
        most = std::max(most, weights[n]);
        least = std::min(least, weights[n]);
      }
    }
    EXPECT_NEAR(most, 1, 1e-12);
    EXPECT_EQ(least, 0);
  }
}

TEST(Fan, OneThatHoldsTheWholeImageChangesNothing)
{
  SyntheticSweep<std::uint8_t> sweep(61, 49, ScalarType::UInt8);
  std::mt19937 random(3);
  for (const Matrix4& pose : MakeRandomPoses(9, 3, 0.1))
  {
    sweep.Add(pose, [&](int, int) { return random() % 256; });
  }
  const auto mask = std::make_shared<const FanMask>(
    Fan{ { 30, 20 }, { -180, 180 }, { 0, 100 } }, 61, 49, Vec2{ 0.31, 0.23 });
  std::vector<SliceImage> inFans = sweep.Slices;
  for (SliceImage& slice : inFans)
  {
    slice.Fan = mask;
  }
  const VolumeGrid grid = MakeGrid(sweep.Slices, { 0.5, 0.5, 0.6 });
  for (const PixelSampling sampling :
    { PixelSampling::Footprint, PixelSampling::Bilinear, PixelSampling::Nearest })
  {
    SweptVolume::Options options;
    options.Sampling = sampling;
    const auto plain = Reconstruct<float>(sweep.Slices, grid, GetExtent(grid), options);
    const auto volume = Reconstruct<float>(inFans, grid, GetExtent(grid), options);
    EXPECT_EQ(volume.Contributions, plain.Contributions);
    for (std::size_t n = 0; n < plain.Mask.size(); ++n)
    {
      EXPECT_NEAR(volume.Intensity[n], plain.Intensity[n], 1e-3);
    }
  }
}

TEST(Fan, MustSuitTheSlice)
{
  SyntheticSweep<std::uint8_t> sweep(21, 11, ScalarType::UInt8);
  for (int n = 0; n < 3; ++n)
  {
    sweep.Add(Matrix4::Translation({ 0, 0, 1.0 * n }), [](int, int) { return 1; });
    sweep.Slices.back().Fan = std::make_shared<const FanMask>(
      Fan{ { 10, 5 }, { -180, 180 }, { 0, 5 } }, 21, 11, Vec2{ 1, 1 });
  }
  const VolumeGrid grid = MakeGrid(sweep.Slices, { 1, 1, 1 });
  const auto getError = [&](const std::vector<SliceImage>& first,
                          const std::vector<SliceImage>& second) -> std::string
  {
    try
    {
      ThreadExecution execution(1);
      SweptVolume volume(grid, GetExtent(grid), {});
      volume.AddSlices(first, execution);
      volume.AddSlices(second, execution);
    }
    catch (const std::invalid_argument& e)
    {
      return e.what();
    }
    return "no error";
  };
  const SliceImage& slice = sweep.Slices[0];
  SliceImage cropped = sweep.Slices[1];
  cropped.Width = 20;
  EXPECT_EQ(
    getError({ slice }, { cropped }), "slice 1 has 20 x 11 pixels, its fan was made for 21 x 11");
  SliceImage without = sweep.Slices[2];
  without.Fan.reset();
  EXPECT_EQ(getError({ slice, without }, {}),
    "slice 2: either all slices of a sweep have a fan, or none has");
  EXPECT_EQ(getError({ without }, { slice }),
    "slice 0: either all slices of a sweep have a fan, or none has");
  EXPECT_EQ(getError({ slice }, { sweep.Slices[1] }), "no error");
}
