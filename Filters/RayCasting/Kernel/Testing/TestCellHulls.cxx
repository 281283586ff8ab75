// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSurfaceBlocks.h"
#include "lacunaTestField.h"
#include "lacunaVoxelBlocks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace
{
using namespace lacuna;

/// Bezier points of a cell from its control points, in double and one axis at a time.
template <int Support>
std::vector<double> BezierPoints(const BlockPoints<Support>& block, int i, int j, int k)
{
  const double cubic[4][4] = { { 1 / 6., 4 / 6., 1 / 6., 0 }, { 0, 2 / 3., 1 / 3., 0 },
    { 0, 1 / 3., 2 / 3., 0 }, { 0, 1 / 6., 4 / 6., 1 / 6. } };
  const auto weight = [&](int to, int from)
  { return Support == 4 ? cubic[to][from] : (to == from ? 1.0 : 0.0); };
  std::vector<double> result;
  for (int n = 0; n < Support * Support * Support; ++n)
  {
    const int x = n % Support;
    const int y = n / Support % Support;
    const int z = n / Support / Support;
    double sum = 0;
    for (int c = 0; c < Support; ++c)
    {
      for (int b = 0; b < Support; ++b)
      {
        for (int a = 0; a < Support; ++a)
        {
          sum += weight(x, a) * weight(y, b) * weight(z, c) * block.Values[k + c][j + b][i + a];
        }
      }
    }
    result.push_back(sum);
  }
  return result;
}

template <int Support>
void Fill(BlockPoints<Support>& block, std::mt19937& random, double scale, double offset)
{
  std::normal_distribution<double> normal;
  const double slope[3] = { normal(random), normal(random), normal(random) };
  float* v = &block.Values[0][0][0];
  for (int n = 0; n < BlockPoints<Support>::Width * BlockPoints<Support>::Width * 8; ++n)
  {
    const double linear =
      slope[0] * (n % 8) + slope[1] * (n / 8 % 7) + slope[2] * (n / 8 / 7) + offset;
    v[n] = static_cast<float>(scale * (linear + 0.5 * normal(random)));
  }
  block.SetTolerance(0);
}

template <int Support>
void CheckHulls()
{
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  int claimed = 0;
  for (int trial = 0; trial < 200; ++trial)
  {
    const double scale = std::pow(10.0, static_cast<int>(trial % 41) - 20);
    BlockPoints<Support> block;
    Fill(block, random, scale, 4 * uniform(random) - 8);
    const CellHulls hulls = block.Classify();
    for (int n = 0; n < 64; ++n)
    {
      const int cell[3] = { n & 3, n >> 2 & 3, n >> 4 };
      const auto points = BezierPoints(block, cell[0], cell[1], cell[2]);
      const double low = *std::min_element(points.begin(), points.end());
      const double high = *std::max_element(points.begin(), points.end());
      const double clear = 1e-4 * scale;
      const int bit = CellHulls::BitOf(cell[0], cell[1], cell[2]);
      const bool outside = hulls.Outside >> bit & 1;
      const bool inside = hulls.Inside >> bit & 1;
      claimed += outside || inside;
      ASSERT_FALSE(outside && high >= 0) << trial << " " << n;
      ASSERT_FALSE(inside && low <= 0) << trial << " " << n;
      ASSERT_TRUE(outside || high >= -clear) << trial << " " << n;
      ASSERT_TRUE(inside || low <= clear) << trial << " " << n;

      const CellPlanes planes = block.FindPlanes(cell[0], cell[1], cell[2]);
      double least = std::numeric_limits<double>::infinity();
      double greatest = -least;
      for (std::size_t p = 0; p < points.size(); ++p)
      {
        const int q = static_cast<int>(p);
        const double step = 1.0 / (Support - 1);
        const Vec3 at{ step * (q % Support), step * (q / Support % Support),
          step * (q / Support / Support) };
        const double rest = points[p] - Dot(planes.Slope, at);
        least = std::min(least, rest);
        greatest = std::max(greatest, rest);
      }
      ASSERT_LE(planes.Low, least);
      ASSERT_GE(planes.High, greatest);
      ASSERT_LT(greatest - least, 1.5 * (high - low) + clear);
      ASSERT_LT(planes.High - planes.Low, greatest - least + 20 * clear);
    }
  }
  EXPECT_GT(claimed, 1000);
}

template <int Support>
void CheckExtremes()
{
  std::mt19937 random(8);
  for (const double scale : { 1e-42, 1e-33, 1e37, 1e300 })
  {
    BlockPoints<Support> block;
    Fill(block, random, scale, -100);
    const CellHulls hulls = block.Classify();
    EXPECT_EQ(hulls.Outside | hulls.Inside, 0u) << scale;
    const CellPlanes planes = block.FindPlanes(1, 2, 3);
    EXPECT_LT(planes.Low, -1e300) << scale;
    EXPECT_GT(planes.High, 1e300) << scale;
  }
}

/// Cells that are said to hold no surface, against samples of the field itself.
template <int Support>
void CheckVolume(const TestField& field, double isoValue, bool above)
{
  ThreadExecution execution(2);
  const FieldBounds<double> bounds(field.Voxels.data(), field.Size, TensorCell<Support>::Before,
    TensorCell<Support>::After, execution);
  const bool hasEmpty = bounds.GetNumberOfNonFinite() > 0;
  const double empty = above ? bounds.GetMinimum() : bounds.GetMaximum();
  const SolidVoxels<double> solid{ field.Voxels.data(), field.Size, &bounds, above, hasEmpty,
    empty };
  TestField finite = field;
  for (double& v : finite.Voxels)
  {
    v = std::isfinite(v) ? v : empty;
  }
  const VoxelBlocks<double, Support> blocks(solid, isoValue);
  SurfaceBlocks<Support> remembered(blocks);
  std::mt19937 random(11);
  std::uniform_real_distribution<double> uniform(0, 1);
  int claimed = 0;
  for (int k = 0; k + 1 < field.Size[2]; ++k)
  {
    for (int j = 0; j + 1 < field.Size[1]; ++j)
    {
      for (int i = 0; i + 1 < field.Size[0]; ++i)
      {
        const CellHulls& hulls = remembered.Get({ i / 4, j / 4, k / 4 });
        const int bit = CellHulls::BitOf(i, j, k);
        const CellHulls classes = blocks.GetBlockClasses({ i / 16, j / 16, k / 16 });
        const int big = CellHulls::BitOf(i / 4, j / 4, k / 4);
        const auto coarse = blocks.GetCoarseClass({ i / 16, j / 16, k / 16 });
        for (int n = 0; n < 5; ++n)
        {
          const Vec3 at{ i + uniform(random), j + uniform(random), k + uniform(random) };
          const double value = (above ? 1 : -1) *
            ((Support == 4 ? finite.BSpline(at) : finite.Trilinear(at)) - isoValue);
          ASSERT_FALSE((hulls.Outside >> bit & 1) && value >= 0) << i << " " << j << " " << k;
          ASSERT_FALSE((hulls.Inside >> bit & 1) && value <= 0) << i << " " << j << " " << k;
          ASSERT_FALSE(((classes.Outside >> big & 1) || coarse.Outside) && value >= 0);
          ASSERT_FALSE(((classes.Inside >> big & 1) || coarse.Inside) && value < 0);
        }
        claimed += (hulls.Outside | hulls.Inside) >> bit & 1;
      }
    }
  }
  EXPECT_GT(claimed, 20);
}
}

TEST(CellHulls, AgainstBezierPointsInDouble)
{
  CheckHulls<4>();
  CheckHulls<2>();
}

TEST(CellHulls, NothingIsClaimedBeyondFloats)
{
  CheckExtremes<4>();
  CheckExtremes<2>();
}

TEST(CellHulls, PlanesOfALinearFieldAreTheField)
{
  BlockPoints<4> block;
  for (int n = 0; n < 7 * 7 * 8; ++n)
  {
    (&block.Values[0][0][0])[n] =
      static_cast<float>(2 * (n % 8) - 3 * (n / 8 % 7) + 5 * (n / 56) - 11);
  }
  block.SetTolerance(0);
  const CellPlanes planes = block.FindPlanes(3, 0, 2);
  EXPECT_NEAR(planes.Slope[0], 2, 1e-5);
  EXPECT_NEAR(planes.Slope[1], -3, 1e-5);
  EXPECT_NEAR(planes.Slope[2], 5, 1e-5);
  // control point (4, 1, 3) is the cell's first voxel
  EXPECT_NEAR(planes.Low, 2 * 4 - 3 * 1 + 5 * 3 - 11, 1e-3);
  EXPECT_NEAR(planes.High, planes.Low, 1e-3);
}

TEST(SurfaceBlocks, BordersAndHoles)
{
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for (const std::array<int, 3>& size :
    { std::array<int, 3>{ 13, 9, 22 }, std::array<int, 3>{ 2, 18, 5 } })
  {
    TestField field(size, Matrix4(),
      [&](const Vec3& p)
      { return 3 * std::sin(0.4 * p[0] + 0.3 * p[1] * p[2] / 9) + 0.2 * normal(random); });
    for (const bool above : { true, false })
    {
      CheckVolume<4>(field, 0.9, above);
      CheckVolume<2>(field, 0.9, above);
    }
    field.Voxels[5] = std::numeric_limits<double>::quiet_NaN();
    field.Voxels[field.Voxels.size() / 2] = std::numeric_limits<double>::infinity();
    field.Voxels[field.Voxels.size() - 1] = -std::numeric_limits<double>::infinity();
    for (const bool above : { true, false })
    {
      CheckVolume<4>(field, 0.9, above);
      CheckVolume<2>(field, 0.9, above);
    }
  }
}
