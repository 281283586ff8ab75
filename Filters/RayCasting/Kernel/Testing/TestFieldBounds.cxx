// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaFieldBounds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace
{
using namespace lacuna;

/// Every block against a search over all voxels in reach.
template <class T>
void CheckLevel(const typename FieldBounds<T>::Level& level, const std::vector<T>& voxels,
  const std::array<int, 3>& size, int before, int after)
{
  const int width = 1 << level.Shift;
  for (int a = 0; a < 3; ++a)
  {
    ASSERT_EQ(level.Blocks[a], (size[a] - 1 + width - 1) / width);
  }
  for (int k = 0; k < level.Blocks[2]; ++k)
  {
    for (int j = 0; j < level.Blocks[1]; ++j)
    {
      for (int i = 0; i < level.Blocks[0]; ++i)
      {
        T low = std::numeric_limits<T>::max();
        T high = std::numeric_limits<T>::lowest();
        for (int z = k * width - before; z < (k + 1) * width + after; ++z)
        {
          for (int y = j * width - before; y < (j + 1) * width + after; ++y)
          {
            for (int x = i * width - before; x < (i + 1) * width + after; ++x)
            {
              if (x >= 0 && y >= 0 && z >= 0 && x < size[0] && y < size[1] && z < size[2])
              {
                const T v = voxels[x + size[0] * (y + size[1] * z)];
                low = std::min(low, v);
                high = std::max(high, v);
              }
            }
          }
        }
        ASSERT_EQ(level.Bounds[level.IndexOf(i, j, k)], low);
        ASSERT_EQ(level.Bounds[level.IndexOf(i, j, k) + 1], high);
      }
    }
  }
}

template <class T>
void CheckType()
{
  std::mt19937 random(4);
  std::uniform_real_distribution<double> uniform(0, 1);
  ThreadExecution execution(2);
  const std::array<int, 3> sizes[] = { { 2, 2, 2 }, { 5, 6, 4 }, { 17, 18, 33 }, { 40, 3, 21 } };
  for (const auto& size : sizes)
  {
    std::vector<T> voxels(static_cast<std::size_t>(size[0]) * size[1] * size[2]);
    for (T& v : voxels)
    {
      v = static_cast<T>(100 * uniform(random) * uniform(random));
    }
    const auto range = std::minmax_element(voxels.begin(), voxels.end());
    for (const int before : { 0, 1 })
    {
      const FieldBounds<T> bounds(voxels.data(), size, before, before + 1, execution);
      CheckLevel<T>(bounds.GetFine(), voxels, size, before, before + 1);
      EXPECT_EQ(bounds.GetMinimum(), static_cast<double>(*range.first));
      EXPECT_EQ(bounds.GetMaximum(), static_cast<double>(*range.second));
      EXPECT_EQ(bounds.GetNumberOfNonFinite(), 0);
      CheckLevel<T>(bounds.GetCoarse(), voxels, size, before, before + 1);
    }
  }
}
}

TEST(FieldBounds, AllTypes)
{
  CheckType<std::int8_t>();
  CheckType<std::uint8_t>();
  CheckType<std::int16_t>();
  CheckType<std::uint16_t>();
  CheckType<std::int32_t>();
  CheckType<std::uint32_t>();
  CheckType<std::int64_t>();
  CheckType<std::uint64_t>();
  CheckType<float>();
  CheckType<double>();
}

TEST(FieldBounds, ABlockWithAHoleIsNeverBounded)
{
  ThreadExecution execution(2);
  const std::array<int, 3> size{ 30, 9, 9 };
  std::vector<float> voxels(30 * 9 * 9, 5.0f);
  voxels[0] = std::numeric_limits<float>::quiet_NaN();
  voxels[1] = std::numeric_limits<float>::infinity();
  voxels[2] = -3;
  const FieldBounds<float> bounds(voxels.data(), size, 1, 2, execution);
  EXPECT_EQ(bounds.GetNumberOfNonFinite(), 2);
  EXPECT_EQ(bounds.GetMinimum(), -3);
  EXPECT_EQ(bounds.GetMaximum(), 5);
  const auto& fine = bounds.GetFine();
  EXPECT_EQ(fine.Bounds[0], -std::numeric_limits<float>::infinity());
  EXPECT_EQ(fine.Bounds[1], std::numeric_limits<float>::infinity());
  EXPECT_EQ(fine.Bounds[fine.IndexOf(3, 0, 0)], 5);
  EXPECT_EQ(fine.Bounds[fine.IndexOf(3, 0, 0) + 1], 5);
}

TEST(FieldBounds, NothingFinite)
{
  ThreadExecution execution(2);
  const std::vector<double> voxels(27, std::nan(""));
  const FieldBounds<double> bounds(voxels.data(), { 3, 3, 3 }, 1, 2, execution);
  EXPECT_EQ(bounds.GetNumberOfNonFinite(), 27);
  EXPECT_GT(bounds.GetMinimum(), bounds.GetMaximum());
}
