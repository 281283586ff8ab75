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

// Scouts are known by how they lie; whatever else does not lie as the others stays, to be refused.
TEST(CTSeries, Scouts)
{
  const Axes sagittal = { 0, 1, 0, 0, 0, -1 };
  const Axes coronal = { 1, 0, 0, 0, 0, -1 };
  const auto makeStack = [](const std::vector<Axes>& others)
  {
    std::vector<CTFrame> frames = MakeFrames(std::vector<Vec3>(others.size() + 6));
    for (std::size_t i = 0; i < frames.size(); ++i)
    {
      frames[i].Axes = i < others.size() ? others[i] : Axial;
    }
    return frames;
  };
  const auto count = [&](const std::vector<Axes>& others)
  {
    std::vector<CTFrame> frames = makeStack(others);
    const std::size_t notes = TakeOutScouts(frames).size();
    EXPECT_EQ(frames.size() + notes, others.size() + 6);
    return notes;
  };
  std::vector<CTFrame> frames = makeStack({ sagittal });
  EXPECT_EQ(TakeOutScouts(frames),
    std::vector<std::string>{ "IM0: left out, it is a scout by its Image Orientation (Patient) "
                              "(0020,0037): it lies across 6 parallel images" });
  ASSERT_EQ(frames.size(), 6U);
  EXPECT_EQ(frames[0].GetName(), "IM1");
  CheckSameVolume(frames);

  EXPECT_EQ(count({}), 0U);
  EXPECT_EQ(count({ sagittal, coronal }), 2U);
  EXPECT_EQ(count({ sagittal, { 0, -1, 0, 0, 0, 1 } }), 2U); // from both sides
  EXPECT_EQ(count({ sagittal, sagittal, sagittal }), 0U);    // a stack of its own
  EXPECT_EQ(count({ sagittal, sagittal, coronal, coronal }), 0U);
  EXPECT_EQ(count({ { 1, 0, 0, 0, 0.8, 0.6 } }), 0U); // oblique
  EXPECT_EQ(count({ { 0, 1, 0, -1, 0, 0 } }), 0U);    // turned in its plane
  EXPECT_EQ(count({ { 0, 0, 0, 0, 0, 0 } }), 0U);
  frames = makeStack({ sagittal });
  frames.resize(3); // too few to tell
  EXPECT_TRUE(TakeOutScouts(frames).empty());
  frames = makeStack({ sagittal });
  frames[3].Axes.reset();
  EXPECT_EQ(TakeOutScouts(frames).size(), 1U);
}
