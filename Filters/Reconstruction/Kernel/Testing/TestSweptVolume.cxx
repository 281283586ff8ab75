// SPDX-License-Identifier: BSD-3-Clause
/// What the swept volume is: exact results, and the definition taken at its word, voxel by voxel.
#include "lacunaSyntheticSweep.h"

#include "lacunaSlicePair.h"

#include <gtest/gtest.h>

#include <algorithm>

using namespace lacuna;

namespace
{
SweptVolume::Options MakeOptions(PixelSampling sampling, bool doublePrecision = false)
{
  SweptVolume::Options options;
  options.Sampling = sampling;
  options.DoublePrecision = doublePrecision;
  return options;
}

// The definition of lacunaSlicePair.h and of SweptVolume::Method::BetweenSlices, naively.
struct NaiveSample
{
  bool IsInside = false;
  bool IsDoubtful = false; // so close to a border that rounding decides
  double Value = 0;
};

// (column, row, mm) of the foot of p on a slice.
Vec3 GetFoot(const SliceImage& slice, const Vec3& p)
{
  const Vec3 x = slice.PixelToReference.Column(0);
  const Vec3 y = slice.PixelToReference.Column(1);
  return Matrix4::FromColumns(x, y, Normalized(Cross(x, y)), slice.PixelToReference.Column(3))
    .Inverse()
    .Point(p);
}

// How far outside of the outermost pixel centres a foot may lie: with footprints, half of one and
// half a pixel.
Vec2 GetMargins(const SliceImage& slice, const VolumeGrid& grid, PixelSampling sampling)
{
  Vec2 margins{ 0.5, 0.5 };
  if (sampling == PixelSampling::Footprint)
  {
    const Vec3 foot = GetFoot(slice, { 0, 0, 0 });
    for (int i = 0; i < 2; ++i)
    {
      double square = 0;
      for (int a = 0; a < 3; ++a)
      {
        Vec3 voxel{ 0, 0, 0 };
        voxel[a] = grid.Spacing[a];
        const double pixels = GetFoot(slice, voxel)[i] - foot[i];
        square += pixels * pixels;
      }
      margins[i] += 0.5 * std::sqrt(square);
    }
  }
  return margins;
}

NaiveSample SampleNaively(const SliceImage& first, const SliceImage& second, const VolumeGrid& grid,
  const Vec3& p, const SweptVolume::Options& options)
{
  const bool nearest = options.Sampling == PixelSampling::Nearest;
  const double maximumGap = options.MaximumSliceGap;
  double distance[2];
  double grey[2];
  NaiveSample result;
  result.IsInside = true;
  const auto require = [&](double margin)
  {
    result.IsInside &= margin >= 0;
    result.IsDoubtful |= std::abs(margin) < 1e-5;
  };
  for (int s = 0; s < 2; ++s)
  {
    const SliceImage& slice = s == 0 ? first : second;
    Vec3 q = GetFoot(slice, p);
    const Vec2 margins = GetMargins(slice, grid, options.Sampling);
    distance[s] = q[2];
    require(q[0] + margins[0]);
    require(q[1] + margins[1]);
    require(slice.Width - 1 + margins[0] - q[0]);
    require(slice.Height - 1 + margins[1] - q[1]);
    q[0] = std::clamp(q[0], 0.0, slice.Width - 1.0);
    q[1] = std::clamp(q[1], 0.0, slice.Height - 1.0);
    const auto pixel = [&](int column, int row)
    {
      column = std::clamp(column, 0, slice.Width - 1);
      row = std::clamp(row, 0, slice.Height - 1);
      return static_cast<double>(
        static_cast<const float*>(slice.Pixels)[row * slice.RowStride + column]);
    };
    const int c = static_cast<int>(std::floor(nearest ? q[0] + 0.5 : q[0]));
    const int r = static_cast<int>(std::floor(nearest ? q[1] + 0.5 : q[1]));
    const double u = nearest ? 0 : q[0] - c;
    const double v = nearest ? 0 : q[1] - r;
    grey[s] = (1 - v) * ((1 - u) * pixel(c, r) + u * pixel(c + 1, r)) +
      v * ((1 - u) * pixel(c, r + 1) + u * pixel(c + 1, r + 1));
  }
  require(-distance[0] * distance[1]);
  const double gap = std::abs(distance[0]) + std::abs(distance[1]);
  if (maximumGap > 0)
  {
    require(maximumGap - gap);
  }
  result.Value = (std::abs(distance[0]) * grey[1] + std::abs(distance[1]) * grey[0]) / gap;
  return result;
}

// Compares a reconstruction with the definition (with footprints, only which voxels are filled, not
// their grey levels); returns the number of voxels with samples.
int CompareWithDefinition(const std::vector<SliceImage>& slices, const VolumeGrid& grid,
  const SweptVolume::Options& options)
{
  const auto volume = Reconstruct<float>(slices, grid, GetExtent(grid), options, 2);
  int filled = 0;
  int doubtful = 0;
  std::size_t n = 0;
  for (int k = 0; k < grid.Dimensions[2]; ++k)
  {
    for (int j = 0; j < grid.Dimensions[1]; ++j)
    {
      for (int i = 0; i < grid.Dimensions[0]; ++i, ++n)
      {
        double sum = 0;
        double largest = -std::numeric_limits<double>::infinity();
        unsigned int count = 0;
        bool isDoubtful = false;
        for (std::size_t s = 0; s + 1 < slices.size(); ++s)
        {
          const NaiveSample sample =
            SampleNaively(slices[s], slices[s + 1], grid, GetPoint(grid, i, j, k), options);
          isDoubtful |= sample.IsDoubtful;
          if (sample.IsInside)
          {
            sum += sample.Value;
            largest = std::max(largest, sample.Value);
            ++count;
          }
        }
        if (isDoubtful)
        {
          ++doubtful;
          continue;
        }
        EXPECT_EQ(volume.Contributions[n], count) << i << " " << j << " " << k;
        EXPECT_EQ(volume.Mask[n], count > 0 ? 1 : 0);
        if (count > 0)
        {
          ++filled;
          if (options.Sampling != PixelSampling::Footprint)
          {
            EXPECT_NEAR(volume.Intensity[n],
              options.Compound == Compounding::Mean ? sum / count : largest, 2e-3);
          }
        }
        else
        {
          EXPECT_EQ(volume.Intensity[n], 0);
        }
      }
    }
  }
  // no more than the tolerance explains
  EXPECT_LT(doubtful, static_cast<int>(n) / 100);
  return filled;
}

SyntheticSweep<float> MakeNoiseSweep(const std::vector<Matrix4>& poses, unsigned int seed)
{
  SyntheticSweep<float> sweep(31, 25, ScalarType::Float32);
  std::mt19937 random(seed);
  for (const Matrix4& pose : poses)
  {
    sweep.Add(pose, [&](int, int) { return static_cast<float>(random() % 1000) / 4; });
  }
  return sweep;
}

// True when the feet of p on all slices lie between the centres of their outermost pixels.
bool IsBetweenCentres(const std::vector<SliceImage>& slices, const Vec3& p)
{
  return std::all_of(slices.begin(), slices.end(),
    [&](const SliceImage& slice)
    {
      const Vec3 foot = GetFoot(slice, p);
      return foot[0] >= 0 && foot[0] <= slice.Width - 1 && foot[1] >= 0 &&
        foot[1] <= slice.Height - 1;
    });
}

constexpr std::array<double, 3> Gradient{ 1.7, -2.3, 0.9 };
double Linear(const Vec3& p)
{
  return 100 + Gradient[0] * p[0] + Gradient[1] * p[1] + Gradient[2] * p[2];
}
}

TEST(SweptVolume, LinearGreyLevelsBetweenParallelSlicesAreExact)
{
  const Matrix4 probe = Matrix4::Translation({ 3, 5, -2 }) * Matrix4::Rotation({ 1, 2, 3 }, 0.8);
  SyntheticSweep<double> sweep(41, 33, ScalarType::Float64);
  for (const double z : { 0.0, 1.3, 1.9, 4.0 })
  {
    sweep.AddField(
      probe * Matrix4::Translation({ 0.3 * z, 0, z }) * Matrix4::Scaling({ 0.1, 0.12, 1 }), Linear);
  }
  const VolumeGrid grid = MakeGrid(sweep.Slices, { 0.37, 0.41, 0.43 });
  for (const PixelSampling sampling : { PixelSampling::Bilinear, PixelSampling::Footprint })
  {
    const auto volume =
      Reconstruct<double>(sweep.Slices, grid, GetExtent(grid), MakeOptions(sampling, true));
    std::size_t n = 0;
    int filled = 0;
    for (int k = 0; k < grid.Dimensions[2]; ++k)
    {
      for (int j = 0; j < grid.Dimensions[1]; ++j)
      {
        for (int i = 0; i < grid.Dimensions[0]; ++i, ++n)
        {
          const Vec3 p = GetPoint(grid, i, j, k);
          if (volume.Mask[n])
          {
            ++filled;
            // half a pixel outside of the outermost centres, bilinear grey levels stay as they are
            const double tolerance =
              sampling == PixelSampling::Footprint || IsBetweenCentres(sweep.Slices, p) ? 1e-9
                                                                                        : 0.25;
            ASSERT_NEAR(volume.Intensity[n], Linear(p), tolerance);
          }
        }
      }
    }
    EXPECT_GT(filled, 500);
  }
}

TEST(SweptVolume, LinearGreyLevelsBetweenTurnedSlicesDeviateAsDerived)
{
  // With f linear, the foot of p on a slice has f(p) - d g.n. Two of them, weighted by |d| of the
  // other, give f(p) - d1 d2 / (d2 - d1) g.(n1 - n2): exact on the slices, and at most a quarter
  // of the gap times |g.(n1 - n2)| off between them.
  SyntheticSweep<double> sweep(81, 61, ScalarType::Float64);
  const Matrix4 pixels = Matrix4::Scaling({ 0.1, 0.1, 1 }) * Matrix4::Translation({ -40, -30, 0 });
  const std::array<Matrix4, 2> poses{ Matrix4::Rotation({ 1, 0.3, 0 }, 0.2) * pixels,
    Matrix4::Translation({ 0.2, 0.1, 1.5 }) * Matrix4::Rotation({ -0.2, 1, 0.1 }, 0.35) * pixels };
  for (const Matrix4& pose : poses)
  {
    sweep.AddField(pose, Linear);
  }
  const VolumeGrid grid = MakeGrid(sweep.Slices, { 0.3, 0.3, 0.3 });
  for (const PixelSampling sampling : { PixelSampling::Bilinear, PixelSampling::Footprint })
  {
    const auto volume =
      Reconstruct<double>(sweep.Slices, grid, GetExtent(grid), MakeOptions(sampling, true));
    std::size_t n = 0;
    int filled = 0;
    double worst = 0;
    for (int k = 0; k < grid.Dimensions[2]; ++k)
    {
      for (int j = 0; j < grid.Dimensions[1]; ++j)
      {
        for (int i = 0; i < grid.Dimensions[0]; ++i, ++n)
        {
          if (!volume.Mask[n])
          {
            continue;
          }
          ++filled;
          const Vec3 p = GetPoint(grid, i, j, k);
          if (sampling == PixelSampling::Bilinear && !IsBetweenCentres(sweep.Slices, p))
          {
            continue;
          }
          std::array<Vec3, 2> normals;
          std::array<double, 2> d;
          for (int s = 0; s < 2; ++s)
          {
            normals[s] = Normalized(Cross(poses[s].Column(0), poses[s].Column(1)));
            d[s] = Dot(normals[s], p - poses[s].Column(3));
          }
          const double slope =
            Dot({ Gradient[0], Gradient[1], Gradient[2] }, normals[0] - normals[1]);
          const double deviation = -d[0] * d[1] / (d[1] - d[0]) * slope;
          ASSERT_NEAR(volume.Intensity[n], Linear(p) + deviation, 1e-9);
          EXPECT_LE(std::abs(deviation), 0.25 * std::abs(d[1] - d[0]) * std::abs(slope) + 1e-12);
          worst = std::max(worst, std::abs(deviation));
        }
      }
    }
    EXPECT_GT(filled, 500);
    EXPECT_GT(worst, 0.1);
  }
}

TEST(SweptVolume, AgreesWithTheDefinitionVoxelByVoxel)
{
  for (unsigned int seed = 0; seed < 6; ++seed)
  {
    // turns up to 0.5 rad over steps of 0.6 mm: most neighbours intersect within the image
    const SyntheticSweep<float> sweep = MakeNoiseSweep(MakeRandomPoses(7, seed, 0.1 * seed), seed);
    const VolumeGrid grid = MakeGrid(sweep.Slices, { 0.5, 0.45, 0.55 });
    SweptVolume::Options options =
      MakeOptions(seed % 2 == 0 ? PixelSampling::Bilinear : PixelSampling::Nearest);
    EXPECT_GT(CompareWithDefinition(sweep.Slices, grid, options), 300);
    EXPECT_GT(
      CompareWithDefinition(sweep.Slices, grid, MakeOptions(PixelSampling::Footprint)), 300);
    options.Compound = Compounding::Maximum;
    options.MaximumSliceGap = 0.7;
    EXPECT_GT(CompareWithDefinition(sweep.Slices, grid, options), 100);
  }
}

TEST(SweptVolume, AgreesWithTheDefinitionForEachMainDirection)
{
  for (const Vec3& axis : { Vec3{ 1, 0, 0 }, Vec3{ 0, 1, 0 }, Vec3{ 0, 0, 1 } })
  {
    // slices perpendicular to z, x, y in turn, not quite parallel
    SyntheticSweep<float> sweep(31, 25, ScalarType::Float32);
    std::mt19937 random(4);
    for (int n = 0; n < 5; ++n)
    {
      sweep.Add(Matrix4::Rotation(axis, std::acos(0.0)) * Matrix4::Translation({ 0, 0, 0.9 * n }) *
          Matrix4::Rotation({ 1, 1, 0 }, 0.02 * (n + 1)) * Matrix4::Scaling({ 0.2, 0.2, 1 }),
        [&](int, int) { return random() % 256; });
    }
    const VolumeGrid grid = MakeGrid(sweep.Slices, { 0.33, 0.33, 0.33 });
    EXPECT_GT(CompareWithDefinition(sweep.Slices, grid, MakeOptions(PixelSampling::Bilinear)), 500);
  }
}

TEST(SweptVolume, IntersectingSlicesFillADoubleWedge)
{
  // The second slice is the first one turned by 30 degrees about its middle column.
  SyntheticSweep<float> sweep(41, 21, ScalarType::Float32);
  const Matrix4 pixels = Matrix4::Scaling({ 0.5, 0.5, 1 }) * Matrix4::Translation({ -20, 0, 0 });
  const double angle = std::acos(-1.0) / 6;
  sweep.Add(pixels, [](int, int) { return 10; });
  sweep.Add(Matrix4::Rotation({ 0, 1, 0 }, -angle) * pixels, [](int, int) { return 30; });
  VolumeGridRequest request;
  request.Spacing = { 0.5, 0.5, 0.5 };
  request.Bounds = { -8, 8, 0, 10, -5, 5 };
  const VolumeGrid grid = MakeVolumeGrid(sweep.Slices, request);
  const auto volume =
    Reconstruct<float>(sweep.Slices, grid, GetExtent(grid), MakeOptions(PixelSampling::Bilinear));
  const auto at = [&](double x, double y, double z)
  {
    const auto index = [](double t) { return static_cast<std::size_t>(std::lround(2 * t)); };
    return (index(z + 5) * grid.Dimensions[1] + index(y)) * grid.Dimensions[0] + index(x + 8);
  };
  // half-way: 10 at z = 0, 30 on the second slice, which rises with x
  const double z = std::round(2 * 6 * std::tan(angle / 2)) / 2;
  EXPECT_NEAR(volume.Intensity[at(6, 5, z)], 20, 2);
  EXPECT_NEAR(volume.Intensity[at(-6, 5, -z)], 20, 2);
  EXPECT_EQ(volume.Contributions[at(6, 5, -z)], 0U);
  EXPECT_EQ(volume.Contributions[at(-6, 5, z)], 0U);
  // on the first slice its grey level; on the axis both slices are equally near, counted once
  EXPECT_FLOAT_EQ(volume.Intensity[at(6, 5, 0)], 10);
  EXPECT_FLOAT_EQ(volume.Intensity[at(0, 5, 0)], 20);
  EXPECT_EQ(volume.Contributions[at(0, 5, 0)], 1U);
  EXPECT_EQ(volume.Contributions[at(0, 5, 0.5)], 0U);
}

TEST(SweptVolume, GridsThatFitTheSlicesHaveNoHoles)
{
  SyntheticSweep<std::uint8_t> sweep(21, 11, ScalarType::UInt8);
  for (int n = 0; n < 4; ++n)
  {
    sweep.Add(Matrix4::Translation({ 0.1, 0.2, 0.1 + 0.3 * n }) * Matrix4::Scaling({ 0.3, 0.3, 1 }),
      [n](int, int) { return 10 * n; });
  }
  const VolumeGrid grid = MakeGrid(sweep.Slices, { 0.3, 0.3, 0.15 });
  ASSERT_EQ(grid.Dimensions, (std::array<int, 3>{ 21, 11, 7 }));
  const auto volume = Reconstruct<std::uint8_t>(
    sweep.Slices, grid, GetExtent(grid), MakeOptions(PixelSampling::Bilinear));
  for (std::size_t n = 0; n < volume.Mask.size(); ++n)
  {
    const std::size_t k = n / 21 / 11;
    EXPECT_EQ(volume.Intensity[n], 5 * k);
    // on an inner slice both pairs meet
    EXPECT_EQ(volume.Contributions[n], k == 2 || k == 4 ? 2U : 1U);
    EXPECT_EQ(volume.Mask[n], 1);
  }
}

TEST(SweptVolume, KeepsLeftAndRight)
{
  // An F, upright when columns go right and rows go down, on two slices.
  const std::array<const char*, 7> letter{ "       ", " ####  ", " #     ", " ###   ", " #     ",
    " #     ", "       " };
  SyntheticSweep<std::uint8_t> sweep(7, 7, ScalarType::UInt8);
  // columns along -y, rows along +x: x and y change places, and y its sense; travel along -z, the
  // direction of columns x rows is +z
  const Matrix4 pose = Matrix4::FromColumns({ 0, -2, 0 }, { 2, 0, 0 }, { 0, 0, 1 }, { 100, 50, 0 });
  for (const double z : { 8.0, 6.0 })
  {
    sweep.Add(Matrix4::Translation({ 0, 0, z }) * pose,
      [&](int x, int y) { return letter[y][x] == '#' ? 200 : (z > 7 ? 0 : 20); });
  }
  const VolumeGrid grid = MakeGrid(sweep.Slices, { 2, 2, 2 });
  ASSERT_EQ(grid.Origin, (Vec3{ 100, 38, 6 }));
  ASSERT_EQ(grid.Dimensions, (std::array<int, 3>{ 7, 7, 2 }));
  for (const PixelSampling sampling :
    { PixelSampling::Nearest, PixelSampling::Bilinear, PixelSampling::Footprint })
  {
    const auto volume =
      Reconstruct<std::uint8_t>(sweep.Slices, grid, GetExtent(grid), MakeOptions(sampling));
    for (int k = 0; k < 2; ++k)
    {
      for (int column = 0; column < 7; ++column)
      {
        for (int row = 0; row < 7; ++row)
        {
          const int i = row;        // x = 100 + 2 row
          const int j = 6 - column; // y = 50 - 2 column
          EXPECT_EQ(volume.Intensity[(k * 7 + j) * 7 + i],
            letter[row][column] == '#' ? 200 : (k == 1 ? 0 : 20));
        }
      }
    }
  }
}

TEST(SweptVolume, MaximumKeepsTheLargestContribution)
{
  SyntheticSweep<float> sweep(5, 5, ScalarType::Float32);
  for (const double grey : { -8.0, -4.0, -2.0 })
  {
    sweep.Add(
      Matrix4::Translation({ 0, 0, grey == -4 ? 1.0 : 0.0 }), [&](int, int) { return grey; });
  }
  // there and back: at z = 0.5 the samples are -6 and -3
  VolumeGridRequest request;
  request.Spacing = { 1, 1, 0.5 };
  const VolumeGrid grid = MakeVolumeGrid(sweep.Slices, request);
  SweptVolume::Options options = MakeOptions(PixelSampling::Bilinear);
  const std::size_t middle = 25 + 12;
  EXPECT_FLOAT_EQ(
    Reconstruct<float>(sweep.Slices, grid, GetExtent(grid), options).Intensity[middle], -4.5F);
  options.Compound = Compounding::Maximum;
  const auto volume = Reconstruct<float>(sweep.Slices, grid, GetExtent(grid), options);
  EXPECT_FLOAT_EQ(volume.Intensity[middle], -3);
  EXPECT_EQ(volume.Contributions[middle], 2U);
}

TEST(SweptVolume, MaximumGapLimitsTheDistanceOfTheSlicesAtTheVoxel)
{
  // a fan about the column 0: 0 mm apart at x = 0, 2 mm apart at x = 10
  SyntheticSweep<float> sweep(51, 5, ScalarType::Float32);
  const Matrix4 pixels = Matrix4::Scaling({ 0.2, 1, 1 });
  sweep.Add(Matrix4::Rotation({ 0, 1, 0 }, 0.1) * pixels, [](int, int) { return 1; });
  sweep.Add(Matrix4::Rotation({ 0, 1, 0 }, -0.1) * pixels, [](int, int) { return 1; });
  VolumeGridRequest request;
  request.Spacing = { 0.1, 1, 1 };
  request.Bounds = { 0, 9, 1, 2, 0, 0 }; // along the bisector
  const VolumeGrid grid = MakeVolumeGrid(sweep.Slices, request);
  SweptVolume::Options options = MakeOptions(PixelSampling::Bilinear);
  options.MaximumSliceGap = 1.2;
  const auto volume = Reconstruct<float>(sweep.Slices, grid, GetExtent(grid), options);
  for (int i = 0; i < grid.Dimensions[0]; ++i)
  {
    const double gap = 2 * 0.1 * i * std::sin(0.1);
    EXPECT_EQ(volume.Mask[i], gap <= 1.2 ? 1 : 0) << i;
  }
}

TEST(SweptVolume, ThoseInOnePlaneAndThoseTurnedTooFarAreNoNeighbours)
{
  SyntheticSweep<float> sweep(11, 11, ScalarType::Float32);
  const auto grey = [](int, int) { return 7; };
  const double degree = std::acos(-1.0) / 180;
  sweep.Add({}, grey);
  sweep.Add({}, grey);                                           // the same pose
  sweep.Add(Matrix4::Translation({ 3, 2, 0 }), grey);            // moved in its plane
  sweep.Add(Matrix4::Rotation({ 0, 1, 0 }, 89 * degree), grey);  // still a neighbour
  sweep.Add(Matrix4::Rotation({ 0, 1, 0 }, 179 * degree), grey); // by 90 degrees
  sweep.Add(Matrix4::Rotation({ 0, 1, 0 }, 0), grey);            // by 179 degrees
  const VolumeGrid grid = MakeGrid(sweep.Slices, { 1, 1, 1 });
  ThreadExecution execution(1);
  SweptVolume volume(grid, GetExtent(grid), MakeOptions(PixelSampling::Bilinear));
  volume.AddSlices(sweep.Slices, execution);
  EXPECT_EQ(volume.GetPairCounts().All, 5);
  EXPECT_EQ(volume.GetPairCounts().Coincident, 2);
  EXPECT_EQ(volume.GetPairCounts().Turned, 2);
}
