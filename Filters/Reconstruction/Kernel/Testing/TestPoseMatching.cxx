// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaPoseMatching.h"

#include <gtest/gtest.h>

#include <climits>
#include <cmath>
#include <limits>
#include <stdexcept>

using namespace lacuna;

namespace
{
constexpr double NaN = std::numeric_limits<double>::quiet_NaN();

std::vector<std::ptrdiff_t> GetFirst(const std::vector<PoseMatch>& matches)
{
  std::vector<std::ptrdiff_t> rows;
  for (const PoseMatch& match : matches)
  {
    rows.push_back(match.First);
  }
  return rows;
}

using Rows = std::vector<std::ptrdiff_t>;

template <class Function>
void ExpectError(const Function& function, const std::string& part)
{
  try
  {
    function();
    ADD_FAILURE() << "no error with '" << part << "'";
  }
  catch (const std::runtime_error& e)
  {
    EXPECT_NE(std::string(e.what()).find(part), std::string::npos) << e.what();
  }
}
}

TEST(PoseMatching, ByOrder)
{
  EXPECT_EQ(GetFirst(MatchByOrder(3, 3)), (Rows{ 0, 1, 2 }));
  ExpectError([] { MatchByOrder(3, 4); }, "3 slices but 4 rows");
}

TEST(PoseMatching, ByFrameNumber)
{
  EXPECT_EQ(GetFirst(MatchByFrameNumber(4, { 13, 10, 12, 7, 99 }, 10)), (Rows{ 1, -1, 2, 0 }));
  ExpectError([] { MatchByFrameNumber(4, { 1, 2, 2 }, 0); }, "rows 1 and 2 both");
  ExpectError([] { MatchByFrameNumber(4, { 1, 2.5 }, 0); }, "row 1 is 2.5");
  ExpectError([] { MatchByFrameNumber(4, { 1, NaN }, 0); }, "whole number");
  ExpectError([] { MatchByFrameNumber(4, { 100, 101 }, 0); }, "0 to 3, the rows 100 to 101");
  EXPECT_EQ(GetFirst(MatchByFrameNumber(2, { 1e300, -1e300, 1 }, 0)), (Rows{ -1, 2 }));
  EXPECT_EQ(GetFirst(MatchByFrameNumber(2, { INT_MAX }, INT_MAX - 1.0)), (Rows{ -1, 0 }));
  ExpectError([] { MatchByFrameNumber(2, { INT_MAX }, INT_MAX); }, "at most 2147483647");
}

TEST(PoseMatching, ByTime)
{
  const std::vector<double> times{ 0.3, 0.0, 0.1, 0.1, 0.5, NaN };
  const std::vector<char> usable{ 1, 1, 1, 1, 1, 0 };
  const auto matches = MatchByTime({ -0.1, 0, 0.05, 0.1, 0.25, 0.31, 0.5, 0.6 }, times, usable, 0);
  EXPECT_EQ(GetFirst(matches), (Rows{ -1, 1, 1, 2, 2, 0, 4, -1 }));
  EXPECT_EQ(matches[1].Weight, 0);
  EXPECT_EQ(matches[2].Second, 2);
  EXPECT_NEAR(matches[2].Weight, 0.5, 1e-12);
  EXPECT_NEAR(matches[4].Weight, 0.75, 1e-12);
  EXPECT_EQ(matches[4].GetNearest(), 0);
  EXPECT_EQ(matches[5].GetNearest(), 0);
  // rows that are not used leave a gap
  std::vector<char> fewer = usable;
  fewer[0] = 0;
  EXPECT_EQ(GetFirst(MatchByTime({ 0.05, 0.3 }, times, fewer, 0.15)), (Rows{ 1, -1 }));
  EXPECT_EQ(GetFirst(MatchByTime({ 0.05, 0.5 }, times, fewer, 0.15)), (Rows{ 1, 4 }));

  ExpectError(
    [&] {
      MatchByTime({ 10, 11 }, times, usable, 0.1);
    },
    "from 10 s to 11 s, the poses from 0 s to 0.5 s");
  ExpectError(
    [&] { MatchByTime({ 0 }, times, std::vector<char>(6, 0), 0.1); }, "no row has a pose");
  ExpectError([&] { MatchByTime({ 0 }, times, std::vector<char>(6, 1), 0.1); }, "row 5");
  ExpectError([&] { MatchByTime({ 0, NaN }, times, usable, 0.1); }, "slice 1 has no time");
}

TEST(PoseMatching, PosesAreInterpolated)
{
  PoseTable table;
  table.ToReference = { Matrix4::Translation({ 0, 0, 0 }), Matrix4::Translation({ 2, 4, 6 }),
    Matrix4::Translation({ 9, 9, 9 }) };
  table.Usable = { 1, 1, 0 };
  std::vector<PoseMatch> matches(4);
  matches[0].First = matches[0].Second = 1;
  matches[1] = { 0, 1, 0.25 };
  matches[2].First = matches[2].Second = 2;
  const std::vector<Matrix4> poses = GatherPoses(table, matches);
  EXPECT_EQ(poses[0].Column(3), (Vec3{ 2, 4, 6 }));
  EXPECT_NEAR(poses[1](1, 3), 1, 1e-12);
  EXPECT_FALSE(poses[2].IsFinite());
  EXPECT_FALSE(poses[3].IsFinite());
}

TEST(PoseMatching, TellsEmptyKeys)
{
  const auto describe = [](const std::vector<double>& keys)
  { return DescribeEmptyKeys("t", keys); };
  // those that are in their place, or whose place is not known
  for (const std::vector<double>& keys :
    { std::vector<double>{}, { 0 }, { 0, 1, 2 }, { 0, 0, 1 }, { -2, -1, 0, 1 }, { -2, -1, 0 },
      { -1, NaN, 0, 0, NaN, 1 }, { 3, 1, 0, 2 }, { 3, 2, 1, 0 }, { 1, 2, 3 }, { 0, 0, 0 } })
  {
    EXPECT_EQ(describe(keys), "") << keys.size();
  }
  EXPECT_EQ(describe({ 5, 0, 7 }),
    "t is 0 in row 1 and grows from row to row otherwise: if the cell is empty, write nan there, "
    "since ParaView reads empty cells as 0");
  EXPECT_EQ(describe({ 0, 0.1, 0, 0.3, 0 }).substr(0, 20), "t is 0 in rows 2, 4 ");
  EXPECT_EQ(describe({ 5, NaN, 0, 7, 8 }).substr(0, 15), "t is 0 in row 2");
  EXPECT_EQ(describe({ -5, 0, -3, 0, 3 }).substr(0, 16), "t is 0 in row 1 ");
  EXPECT_EQ(describe({ 0, -3, 3 }).substr(0, 16), "t is 0 in row 0 ");
}
