// SPDX-License-Identifier: BSD-3-Clause
#include "CTTestFrames.h"
#include "lacunaCTSeries.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <stdexcept>

using namespace lacuna;

namespace
{
using Axes = std::array<double, 6>;

// The error for an image that lies along axes and says so of itself in letters; empty if it is taken.
std::string ErrorOf(const Axes& axes, const std::vector<std::string>& letters)
{
  std::vector<CTFrame> frames = MakeFrames({ { 0, 0, 0 }, { 0, 0, 2 } });
  for (CTFrame& frame : frames)
  {
    auto header = std::make_shared<CTFileHeader>(*frame.Header);
    header->PatientOrientation = letters;
    frame.Header = header;
    frame.Axes = axes;
  }
  try
  {
    CheckSameVolume(frames);
  }
  catch (const std::runtime_error& e)
  {
    return e.what();
  }
  return {};
}

const Axes Axial = { 1, 0, 0, 0, 1, 0 };
}

TEST(CTSeries, PatientOrientationAgrees)
{
  EXPECT_EQ(ErrorOf(Axial, {}), "");
  EXPECT_EQ(ErrorOf(Axial, { "L", "P" }), "");
  EXPECT_EQ(ErrorOf({ -1, 0, 0, 0, 1, 0 }, { "R", "P" }), ""); // feet first
  EXPECT_EQ(ErrorOf({ 0, 1, 0, 0, 0, -1 }, { "P", "F" }), ""); // sagittal
  EXPECT_EQ(ErrorOf({ 1, 0, 0, 0, 0, -1 }, { "L", "F" }), ""); // coronal
  EXPECT_EQ(ErrorOf({ 0, -1, 0, -1, 0, 0 }, { "A", "R" }), "");
  EXPECT_EQ(ErrorOf({ 0, 0, 1, 0, -1, 0 }, { "H", "A" }), "");
  const double s = std::sqrt(0.5);
  for (const char* order : { "LP", "PL" }) // both are as large
  {
    EXPECT_EQ(ErrorOf({ s, s, 0, -s, s, 0 }, { order, "PR" }), "");
  }
  const double t = std::sqrt(1 / 3.0);
  const double u = std::sqrt(1 / 6.0);
  EXPECT_EQ(ErrorOf({ t, t, t, u, u, -2 * u }, { "LPH", "FLP" }), "");
  EXPECT_EQ(ErrorOf({ 0.9999, -0.014, 0, 0.014, 0.9999, 0 }, { "LP", "P" }), ""); // rounded
}

TEST(CTSeries, PatientOrientationContradicts)
{
  EXPECT_EQ(ErrorOf(Axial, { "R", "P" }),
    "IM0: Patient Orientation (0020,0020) says that rows and columns lead to R and P, but Image "
    "Orientation (Patient) (0020,0037) to L and P: one of them is wrong, and left and right may be "
    "exchanged. Export original images; or compare with the hospital's viewer, and if (0020,0037) "
    "is right remove (0020,0020)");
  for (const std::vector<std::string>& wrong : std::vector<std::vector<std::string>>{
         { "L", "A" }, { "P", "L" }, { "L", "F" }, { "H", "P" }, { "LA", "PR" } })
  {
    const double c = std::cos(0.3);
    const double s = std::sin(0.3);
    EXPECT_NE(ErrorOf({ c, s, 0, -s, c, 0 }, wrong), "") << wrong[0] << "\\" << wrong[1];
  }
}

// What cannot be understood is not compared, and numbers that are no directions are told elsewhere.
TEST(CTSeries, PatientOrientationUnknown)
{
  for (const std::vector<std::string>& other : std::vector<std::vector<std::string>>{
         { "R" }, { "R", "P", "H" }, { "RT", "D" }, { "", "" }, { "r", "p" } })
  {
    EXPECT_EQ(ErrorOf(Axial, other), "");
  }
  EXPECT_EQ(ErrorOf({ 0, 0, 0, 0, 0, 0 }, { "R", "P" }), "");
}

// Files of the same name in two folders are told apart.
TEST(CTSeries, NamesOfTwoFolders)
{
  std::vector<CTFrame> frames = MakeFrames({ { 0, 0, 0 }, { 0, 0, 2 } });
  auto header = std::make_shared<CTFileHeader>(*frames[1].Header);
  header->File = "/other/IM0";
  frames[1].Header = header;
  frames[1].Axes = Axes{ 0, 1, 0, 0, 0, -1 };
  try
  {
    CheckSameVolume(frames);
    FAIL() << "directions that differ were taken";
  }
  catch (const std::runtime_error& e)
  {
    EXPECT_STREQ(e.what(),
      "/other/IM0: has another Image Orientation (Patient) (0020,0037) than /scan/IM0; the images "
      "of a volume are parallel");
  }
}
