// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaPoseScript.h"
#include "lacunaTestFastrak.h"

#include <gtest/gtest.h>

#include <sstream>

using namespace lacuna;
using namespace lacunaTest;

namespace
{
PoseScript Read(const std::string& text)
{
  std::istringstream stream(text);
  return { stream, "poses.txt" };
}

std::string Complaint(const std::string& text)
{
  try
  {
    Read(text);
  }
  catch (const std::runtime_error& e)
  {
    return e.what();
  }
  return "none";
}
}

TEST(PoseScript, GoesStraightAndTurnsEvenly)
{
  const PoseScript script = Read("# time station x y z azimuth elevation roll\n"
                                 "1 2  10 20 30  0 0 0\r\n"
                                 "\n"
                                 "3,2, 20,20,50, 80,0,0 # turned\n"
                                 "0 1 5 0 0 0 0 0\n"
                                 "9 1 -5 1e1 0 0 0 -30");
  EXPECT_EQ(script.GetDuration(), 9);
  const auto at = [](double x, double y, double z, double azimuth, double roll) {
    return Matrix4::Translation({ x, y, z }) * FastrakRotation(Vec3{ azimuth, 0, roll });
  };
  EXPECT_LT(Distance(script(2.5, 2), at(17.5, 20, 45, 60, 0)), 1e-12);
  EXPECT_LT(Distance(script(-7, 2), at(10, 20, 30, 0, 0)), 1e-12);
  EXPECT_LT(Distance(script(100, 2), at(20, 20, 50, 80, 0)), 1e-12);
  EXPECT_LT(Distance(script(3, 1), at(5 - 10 / 3.0, 10 / 3.0, 0, 0, -10)), 1e-12);
  // beside the first of the text, station 2
  EXPECT_LT(Distance(script(2.5, 4), at(17.5, 220, 45, 60, 0)), 1e-12);
}

TEST(PoseScript, SaysWhichLineIsWrong)
{
  EXPECT_NE(Complaint("0 1 1 2 3 4 5 6\n1 1 2 3 4 5 6\n").find("poses.txt, line 2: a line has 8"),
    std::string::npos);
  EXPECT_NE(Complaint("0 1 1 2 3 4 5 x\n").find("line 1: a line has 8"), std::string::npos);
  EXPECT_NE(Complaint("0 1 1 2 3 4 5 inf\n").find("line 1: a line has 8"), std::string::npos);
  EXPECT_NE(Complaint("0 5 1 2 3 4 5 6\n").find("station is 1 to 4"), std::string::npos);
  EXPECT_NE(Complaint("0 1.5 1 2 3 4 5 6\n").find("station is 1 to 4"), std::string::npos);
  EXPECT_NE(
    Complaint("1 1 1 2 3 4 5 6\n1 1 1 2 3 4 5 6\n").find("line 2: the times"), std::string::npos);
  EXPECT_NE(Complaint("# nothing\n\n").find("no poses"), std::string::npos);
}
