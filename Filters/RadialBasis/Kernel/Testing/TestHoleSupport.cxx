// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaHoleSupport.h"

#include "lacunaExecution.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace
{
// From a picture, one string per row: '#' is 1.
lacuna::MapMask Mask(const std::vector<std::string>& rows, char one = '#')
{
  lacuna::MapMask mask;
  for (const std::string& row : rows)
  {
    for (const char c : row)
    {
      mask.push_back(c == one);
    }
  }
  return mask;
}

lacuna::MapGrid Grid(const std::vector<std::string>& rows)
{
  lacuna::MapGrid grid;
  grid.Width = static_cast<int>(rows[0].size());
  grid.Height = static_cast<int>(rows.size());
  return grid;
}
}

TEST(HoleSupport, FindsInteriorHoles)
{
  // 'h' must be found; '.' reaches the border; holes are connected over edges, not corners
  const std::vector<std::string> map = {
    "..######",
    ".##hh##.",
    ".#hh###.",
    ".######h",
    ".#h##h#.",
    "#.###.##",
  };
  // The 'h' at the right border in row 3 reaches it, the one in row 4 reaches the lower border.
  lacuna::MapMask expected = Mask(map, 'h');
  expected[3 * 8 + 7] = 0;
  expected[4 * 8 + 5] = 0;
  EXPECT_EQ(lacuna::FindInteriorHoles(Grid(map), Mask(map)), expected);
}

TEST(HoleSupport, FindsWhatAPolygonEnclosesByItsEdges)
{
  // corners at pixel centres: left and upper sides count, right and lower ones do not
  const std::vector<std::string> map = { ".......", ".###...", ".###...", "......." };
  lacuna::MapGrid grid = Grid(map);
  grid.Spacing = { 2, 0.5 };
  grid.FirstColumn = 3;
  grid.FirstRow = -2;
  std::vector<lacuna::Vec2> box = { { 8, -0.5 }, { 14, -0.5 }, { 14, 0.5 }, { 8, 0.5 } };
  EXPECT_EQ(lacuna::FindEnclosed(grid, box), Mask(map));
  std::reverse(box.begin(), box.end());
  EXPECT_EQ(lacuna::FindEnclosed(grid, box), Mask(map));
  EXPECT_EQ(lacuna::FindEnclosed(grid, {}), lacuna::MapMask(grid.GetSize(), 0));
}

TEST(HoleSupport, FindsWhatAPolygonEnclosesByItsAngle)
{
  // The angle by which the direction to the corners turns is the definition. Polygons that cross
  // themselves, beside the map, wound twice.
  lacuna::MapGrid grid;
  grid.Width = 37;
  grid.Height = 29;
  grid.Spacing = { 0.7, 1.1 };
  grid.FirstColumn = -11;
  grid.FirstRow = 5;
  const auto corner = [](int n, int k, double turns)
  {
    const double angle = 6.283185307179586 * turns * k / n + 0.1;
    const double radius = 9 + 4 * std::sin(3.7 * k);
    return lacuna::Vec2{ 4 + radius * std::cos(angle), 21 + 1.3 * radius * std::sin(angle) };
  };
  for (const double turns : { 1.0, -1.0, 2.0, 5.0 })
  {
    std::vector<lacuna::Vec2> polygon;
    for (int k = 0; k < 13; ++k)
    {
      polygon.push_back(corner(13, k, turns));
    }
    const lacuna::MapMask mask = lacuna::FindEnclosed(grid, polygon);
    int inside = 0;
    for (std::size_t pixel = 0; pixel < mask.size(); ++pixel)
    {
      const double x = 0.7 * static_cast<double>(grid.GetColumn(pixel));
      const double y = 1.1 * static_cast<double>(grid.GetRow(pixel));
      double turned = 0;
      for (std::size_t k = 0; k < polygon.size(); ++k)
      {
        const lacuna::Vec2& a = polygon[k];
        const lacuna::Vec2& b = polygon[(k + 1) % polygon.size()];
        turned += std::remainder(
          std::atan2(b[1] - y, b[0] - x) - std::atan2(a[1] - y, a[0] - x), 6.283185307179586);
      }
      EXPECT_EQ(mask[pixel], std::abs(turned) > 1) << turns << ": " << x << " " << y;
      inside += mask[pixel];
    }
    EXPECT_GT(inside, 100);
  }
}

TEST(HoleSupport, SelectsByDistanceInMillimetres)
{
  const std::vector<std::string> map = { ".......", ".......", "...#...", ".......", "......." };
  lacuna::MapGrid grid = Grid(map);
  grid.Spacing = { 2, 0.5 };
  const lacuna::MapMask all(grid.GetSize(), 1);
  lacuna::ThreadExecution execution(2);
  const std::vector<std::string> expected = { "...#...", "...#...", "..###..", "...#...",
    "...#..." };
  EXPECT_EQ(
    lacuna::SelectWithin(execution, grid, Mask(map), 2, all), Mask(expected)); // 2 is included
  lacuna::MapMask candidates = all;
  candidates[2 * 7 + 2] = 0;
  lacuna::MapMask fewer = Mask(expected);
  fewer[2 * 7 + 2] = 0;
  EXPECT_EQ(lacuna::SelectWithin(execution, grid, Mask(map), 2, candidates), fewer);
}

TEST(HoleSupport, RemovesWhatLiesBeyondAStep)
{
  // 'a' at depth 10, 'b' at 40 beside it, 'c' at 30 touches neither and is no step from 'a', 5 mm
  // away
  const std::vector<std::string> map = {
    "aaaab...c",
    "aaaabb.cc",
    "aaaab...c",
  };
  lacuna::MapMask support = Mask(map, '.');
  std::vector<double> depth;
  for (std::size_t i = 0; i < support.size(); ++i)
  {
    const char c = map[i / 9][i % 9];
    support[i] = c != '.';
    depth.push_back(c == 'a' ? 10 : c == 'b' ? 40 : 30);
  }
  lacuna::MapMask expected = support;
  for (std::size_t i = 0; i < support.size(); ++i)
  {
    expected[i] = support[i] && depth[i] != 40;
  }
  const lacuna::StepReport report = lacuna::RemoveBeyondSteps(Grid(map), depth, { 5, 5 }, support);
  EXPECT_EQ(support, expected);
  EXPECT_EQ(report.RemovedPixels, 4u);
  EXPECT_EQ(report.LargestStep, 30);
}

TEST(HoleSupport, RemovesWhatLiesBeyondAStepWithAGap)
{
  // 'f' 90 mm deeper behind a ring without depth; 'g' behind 'f', nearest to it, on the level of
  // 'f'; 's' across a saw cut, a little deeper than 'a'
  const std::vector<std::string> map = {
    "aaaaaaaaaaaaaa.sss",
    "aaa.....aaaaaa.sss",
    "aaa.fff....aaa.sss",
    "aaa.fff.gg.aaa.sss",
    "aaa.fff....aaa.sss",
    "aaa.....aaaaaa.sss",
    "aaaaaaaaaaaaaa.sss",
  };
  lacuna::MapMask support;
  lacuna::MapMask expected;
  std::vector<double> depth;
  for (const std::string& row : map)
  {
    for (std::size_t i = 0; i < row.size(); ++i)
    {
      support.push_back(row[i] != '.');
      expected.push_back(row[i] == 'a' || row[i] == 's');
      depth.push_back(static_cast<double>(i) +
        (row[i] == 'a'      ? 10.0
            : row[i] == 's' ? 15.0
                            : 100.0));
    }
  }
  lacuna::MapGrid grid = Grid(map);
  lacuna::MapMask once = support;
  const lacuna::StepReport report = lacuna::RemoveBeyondSteps(grid, depth, { 5, 5 }, once);
  EXPECT_EQ(once, expected);
  EXPECT_EQ(report.RemovedPixels, 11U);
  EXPECT_EQ(report.FirstPixel, 2U * 18 + 4);
  EXPECT_NEAR(report.LargestStep, 92, 2.1);
  // Nothing is a step where the same depths lie far apart.
  grid.Spacing = { 60, 60 };
  once = support;
  EXPECT_EQ(lacuna::RemoveBeyondSteps(grid, depth, { 5, 5 }, once).RemovedPixels, 0U);
}

TEST(HoleSupport, FindsHolesThatShowTheFarSide)
{
  // 'a' the surface, 'f' the far side 60 mm below, seen through a hole and past the edge; '.'
  // nothing
  const std::vector<std::string> map = {
    "fff...........",
    "ffaaaaaaaaaa..",
    ".aaaaaaaaaaaa.",
    ".aaaafffaaaaa.",
    ".aaaaff.aaaaaf",
    ".aaaaaaaaa.aaf",
    "..aaaaaaaaaaff",
  };
  std::vector<double> depth;
  for (const std::string& row : map)
  {
    for (std::size_t i = 0; i < row.size(); ++i)
    {
      depth.push_back((row[i] == 'f' ? 70.0 : 10.0) + static_cast<double>(i));
    }
  }
  lacuna::MapMask valid = Mask(map, '.');
  for (auto& v : valid)
  {
    v = !v;
  }
  lacuna::ThreadExecution execution(2);
  const std::vector<std::string> holes = {
    "..............",
    "..............",
    "..............",
    ".....###......",
    ".....###......",
    "..........#...",
    "..............",
  };
  EXPECT_EQ(lacuna::FindHoles(execution, Grid(map), depth, 5, 0, valid), Mask(holes));
  const std::vector<std::string> grown = {
    "..............",
    "..............",
    ".....###......",
    "....#####.....",
    "....#####.#...",
    ".....###.###..",
    "..........#...",
  };
  EXPECT_EQ(lacuna::FindHoles(execution, Grid(map), depth, 5, 1, valid), Mask(grown));
}

TEST(HoleSupport, KeepsASteepSlope)
{
  // 4 mm per mm of map, and the same in a map of coarse pixels
  for (const double spacing : { 1.0, 3.0 })
  {
    lacuna::MapGrid grid;
    grid.Width = 20;
    grid.Height = 3;
    grid.Spacing = { spacing, spacing };
    std::vector<double> depth;
    for (std::size_t i = 0; i < grid.GetSize(); ++i)
    {
      depth.push_back(4 * spacing * static_cast<double>(i % 20));
    }
    lacuna::MapMask support(grid.GetSize(), 1);
    EXPECT_EQ(lacuna::RemoveBeyondSteps(grid, depth, { 5, 5 }, support).RemovedPixels, 0u);
    EXPECT_EQ(support, lacuna::MapMask(grid.GetSize(), 1));
    EXPECT_GT(lacuna::RemoveBeyondSteps(grid, depth, { 3.9, 3.9 }, support).RemovedPixels, 0u);
  }
}

TEST(HoleSupport, ThinsToALattice)
{
  lacuna::MapGrid grid;
  grid.Width = 9;
  grid.Height = 7;
  grid.Spacing = { 0.5, 0.5 };
  lacuna::MapMask all(grid.GetSize(), 1);
  std::vector<std::size_t> expected;
  for (std::size_t j = 0; j < 7; j += 2)
  {
    for (std::size_t i = 0; i < 9; i += 2)
    {
      expected.push_back(j * 9 + i);
    }
  }
  EXPECT_EQ(lacuna::ThinNodes(grid, all, 1), expected);
  // Without the pixel at (1, 1) mm the first of the next nearest is taken, above it, then the one
  // to its left.
  all[2 * 9 + 2] = 0;
  std::vector<std::size_t> changed = expected;
  *std::find(changed.begin(), changed.end(), 2 * 9 + 2) = 1 * 9 + 2;
  std::sort(changed.begin(), changed.end());
  EXPECT_EQ(lacuna::ThinNodes(grid, all, 1), changed);
  all[1 * 9 + 2] = 0;
  *std::find(changed.begin(), changed.end(), 1 * 9 + 2) = 2 * 9 + 1;
  std::sort(changed.begin(), changed.end());
  EXPECT_EQ(lacuna::ThinNodes(grid, all, 1), changed);
}

TEST(HoleSupport, KeepsOnePixelPerLatticePoint)
{
  // A spacing that is no multiple: about one node per square, none farther from its lattice point
  // than from the edge of its square.
  lacuna::MapGrid grid;
  grid.Width = 101;
  grid.Height = 83;
  grid.Spacing = { 0.7, 0.9 };
  const auto nodes = lacuna::ThinNodes(grid, lacuna::MapMask(grid.GetSize(), 1), 2);
  EXPECT_EQ(nodes.size(), 36u * 38u);
  for (const std::size_t node : nodes)
  {
    const double x = 0.7 * static_cast<double>(node % 101);
    const std::size_t row = node / 101;
    const double y = 0.9 * static_cast<double>(row);
    EXPECT_LE(std::abs(x - 2 * std::round(x / 2)), 0.5 * 0.7 + 1e-9);
    EXPECT_LE(std::abs(y - 2 * std::round(y / 2)), 0.5 * 0.9 + 1e-9);
  }
}

TEST(HoleSupport, ThinningFollowsTheMapNotItsCrop)
{
  lacuna::MapGrid whole;
  whole.Width = 30;
  whole.Height = 20;
  whole.Spacing = { 0.7, 0.7 };
  lacuna::MapMask mask(whole.GetSize(), 0);
  lacuna::MapGrid crop = whole;
  crop.Width = 17;
  crop.Height = 11;
  crop.FirstColumn = 5;
  crop.FirstRow = 4;
  for (int j = 0; j < crop.Height; ++j)
  {
    for (int i = 0; i < crop.Width; ++i)
    {
      mask[(j + crop.FirstRow) * 30 + i + crop.FirstColumn] = 1;
    }
  }
  const auto inWhole = lacuna::ThinNodes(whole, mask, 2);
  const auto inCrop = lacuna::ThinNodes(crop, lacuna::MapMask(crop.GetSize(), 1), 2);
  ASSERT_EQ(inWhole.size(), inCrop.size());
  for (std::size_t k = 0; k < inCrop.size(); ++k)
  {
    EXPECT_EQ(inWhole[k],
      (inCrop[k] / crop.Width + crop.FirstRow) * 30 + inCrop[k] % crop.Width + crop.FirstColumn);
  }
}

TEST(HoleSupport, KeepsAllPixelsWhenTheSpacingIsSmall)
{
  lacuna::MapGrid grid;
  grid.Width = 50;
  grid.Height = 40;
  grid.Spacing = { 0.3, 0.3 };
  const lacuna::MapMask all(grid.GetSize(), 1);
  EXPECT_EQ(lacuna::ThinNodes(grid, all, 0.3).size(), grid.GetSize());
  EXPECT_EQ(lacuna::ThinNodes(grid, all, 0.01).size(), grid.GetSize());
  EXPECT_EQ(lacuna::ThinNodes(grid, all, 1e6).size(), 1u);
}
