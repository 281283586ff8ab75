// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaVoxelRegion.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

using lacuna::AffineFunction;
using lacuna::IndexInterval;
using lacuna::VoxelRegion;

namespace
{
constexpr int Size = 12;

bool IsInside(const std::vector<AffineFunction>& functions, int i, int j, int k)
{
  for (const AffineFunction& f : functions)
  {
    if (f(i, j, k) < 0)
    {
      return false;
    }
  }
  return true;
}

void Compare(
  const std::vector<AffineFunction>& functions, IndexInterval columns, IndexInterval rows)
{
  VoxelRegion region;
  for (const AffineFunction& f : functions)
  {
    region.Add(f);
  }
  for (int k = 0; k < Size; ++k)
  {
    const VoxelRegion::Layer layer = region.GetLayer(k, rows);
    for (int j = static_cast<int>(rows.First); j <= rows.Last; ++j)
    {
      IndexInterval found;
      if (j >= layer.GetRows().First && j <= layer.GetRows().Last)
      {
        found = layer.GetRow(j, columns);
      }
      for (int i = static_cast<int>(columns.First); i <= columns.Last; ++i)
      {
        EXPECT_EQ(i >= found.First && i <= found.Last, IsInside(functions, i, j, k))
          << i << " " << j << " " << k;
      }
    }
  }
}
}

TEST(VoxelRegion, HoldsTheVoxelsWhereAllFunctionsArePositive)
{
  std::mt19937 random(3);
  std::uniform_real_distribution<double> u(-1, 1);
  for (int n = 0; n < 400; ++n)
  {
    std::vector<AffineFunction> functions;
    for (int f = 0; f < 1 + n % 11; ++f)
    {
      AffineFunction g{ u(random), u(random), u(random), 0 };
      g.C = 4 * u(random) + 2 - g(Size / 2., Size / 2., Size / 2.);
      functions.push_back(g);
    }
    Compare(functions, { 0, Size - 1 }, { 0, Size - 1 });
    Compare(functions, { 3, 7 }, { 5, 9 });
  }
}

TEST(VoxelRegion, FunctionsMayBeConstantAlongAnyAxis)
{
  Compare({ { 0, 0, 0, 1 } }, { 0, Size - 1 }, { 0, Size - 1 });
  Compare({ { 0, 0, 0, -1 } }, { 0, Size - 1 }, { 0, Size - 1 });
  Compare({ { 0, 1, 0, -3.5 }, { 0, -1, 0, 7.5 } }, { 0, Size - 1 }, { 0, Size - 1 });
  Compare({ { 0, 0, 1, -3.5 }, { 0, 0, -1, 7.5 } }, { 0, Size - 1 }, { 0, Size - 1 });
  Compare({ { 1, 0, 0, -3.5 }, { -1, 0, 0, 7.5 } }, { 0, Size - 1 }, { 0, Size - 1 });
  Compare({ { 0, 1, -1, 0.5 }, { 0, -1, 1, 0.5 } }, { 0, Size - 1 }, { 0, Size - 1 });
  // a bound exactly on voxels belongs to the region
  Compare({ { 1, 0, 0, -3 }, { -1, 0, 0, 7 }, { 0, 1, 0, -2 }, { 0, -1, 0, 5 } }, { 0, Size - 1 },
    { 0, Size - 1 });
}

TEST(VoxelRegion, MayBeEmpty)
{
  Compare({ { 1, 0, 0, -7 }, { -1, 0, 0, 3 } }, { 0, Size - 1 }, { 0, Size - 1 });
  Compare({ { 1, 1, 0, -7 }, { -1, -1, 0, 3 } }, { 0, Size - 1 }, { 0, Size - 1 });
}

TEST(VoxelRegion, RefusesMoreFunctionsThanItHolds)
{
  VoxelRegion region;
  for (int n = 0; n < VoxelRegion::MaximumNumberOfFunctions; ++n)
  {
    region.Add({ 1, 0, 0, 0 });
  }
  EXPECT_THROW(region.Add({ 1, 0, 0, 0 }), std::logic_error);
}
