// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaNodePartition.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <set>
#include <vector>

namespace
{
using Point = std::array<double, 3>;

std::vector<Point> MakeNodes(int count)
{
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<Point> nodes(count);
  for (Point& p : nodes)
  {
    p = { uniform(random), 3 * uniform(random), 0.2 * uniform(random) };
  }
  return nodes;
}
}

TEST(NodePartition, PutsEachNodeInOneGroup)
{
  const std::vector<Point> nodes = MakeNodes(1000);
  const lacuna::NodePartition<3> partition(nodes, 30);
  std::vector<int> seen(nodes.size(), 0);
  for (std::size_t g = 0; g < partition.GetNumberOfGroups(); ++g)
  {
    const std::vector<std::uint32_t> group = partition.GetGroup(g);
    EXPECT_LE(group.size(), 30U);
    EXPECT_GE(group.size(), 15U);
    for (const std::uint32_t i : group)
    {
      ++seen[i];
    }
  }
  EXPECT_EQ(seen, std::vector<int>(nodes.size(), 1));
}

TEST(NodePartition, FindsTheNearestNodesAroundAGroup)
{
  const std::vector<Point> nodes = MakeNodes(700);
  const lacuna::NodePartition<3> partition(nodes, 25);
  for (std::size_t g = 0; g < partition.GetNumberOfGroups(); ++g)
  {
    const std::vector<std::uint32_t> group = partition.GetGroup(g);
    const std::vector<std::uint32_t> all = partition.GetSurroundings(g, 90);
    ASSERT_EQ(all.size(), 90U);
    EXPECT_TRUE(std::equal(group.begin(), group.end(), all.begin()));
    EXPECT_EQ(std::set<std::uint32_t>(all.begin(), all.end()).size(), all.size());
    Point low = nodes[group[0]];
    Point high = low;
    for (const std::uint32_t i : group)
    {
      for (int c = 0; c < 3; ++c)
      {
        low[c] = std::min(low[c], nodes[i][c]);
        high[c] = std::max(high[c], nodes[i][c]);
      }
    }
    const auto distance2 = [&](std::uint32_t i)
    {
      double sum = 0;
      for (int c = 0; c < 3; ++c)
      {
        const double gap = std::max({ 0.0, low[c] - nodes[i][c], nodes[i][c] - high[c] });
        sum += gap * gap;
      }
      return sum;
    };
    double farthest = 0;
    for (const std::uint32_t i : all)
    {
      farthest = std::max(farthest, distance2(i));
    }
    for (std::uint32_t i = 0; i < nodes.size(); ++i)
    {
      if (std::find(all.begin(), all.end(), i) == all.end())
      {
        EXPECT_GE(distance2(i), farthest);
      }
    }
  }
  EXPECT_EQ(partition.GetSurroundings(0, 5000).size(), nodes.size());
}

TEST(NodePartition, ChoosesOneNodeOfEachGroup)
{
  const std::vector<Point> nodes = MakeNodes(500);
  const lacuna::NodePartition<3> partition(nodes, 8);
  const std::vector<std::uint32_t> chosen = partition.GetRepresentatives();
  EXPECT_EQ(chosen.size(), partition.GetNumberOfGroups());
  EXPECT_TRUE(std::is_sorted(chosen.begin(), chosen.end()));
  EXPECT_EQ(std::set<std::uint32_t>(chosen.begin(), chosen.end()).size(), chosen.size());
}
