// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaUltrasoundEmulator.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

using namespace lacuna;

namespace
{
std::string Complaint(const ScannerLayout& layout)
{
  try
  {
    const ScannerScreen screen(layout);
  }
  catch (const std::invalid_argument& e)
  {
    return e.what();
  }
  return "none";
}

ScannerLayout Linear(bool furniture = true)
{
  ScannerLayout layout;
  layout.Shape = ScannerLayout::Probe::Linear;
  layout.Furniture = furniture;
  return layout;
}
}

TEST(ScannerScreen, ShowsTheSectorThatTheProbeSees)
{
  for (const bool furniture : { false, true })
  {
    ScannerLayout layout;
    layout.Furniture = furniture;
    const ScannerScreen screen(layout);
    const Matrix4 toFace = screen.GetImageToFace();
    std::vector<bool> seen(768 * 576);
    for (const ScannerScreen::Run& run : screen.GetRuns())
    {
      ASSERT_LE(run.First, run.Last);
      std::fill(seen.begin() + 768 * run.Row + run.First,
        seen.begin() + 768 * run.Row + run.Last + 1, true);
    }
    for (int pixel = 0; pixel < 768 * 576; ++pixel)
    {
      const Vec3 point =
        toFace.Point({ static_cast<double>(pixel % 768), static_cast<double>(pixel / 768), 0 });
      const double radius = std::hypot(point[0], point[1] + layout.Radius);
      const double angle =
        std::abs(std::atan2(point[0], point[1] + layout.Radius)) * 180 / std::acos(-1.0);
      const double off = std::max({ layout.Radius - radius, radius - layout.Radius - layout.Depth,
        radius * (angle - layout.HalfAngle) * std::acos(-1.0) / 180 });
      if (std::abs(off) > 0.01)
      {
        ASSERT_EQ(seen[static_cast<std::size_t>(pixel)], off < 0)
          << pixel % 768 << " " << pixel / 768;
      }
      ASSERT_TRUE(!seen[static_cast<std::size_t>(pixel)] ||
        screen.GetGround()[static_cast<std::size_t>(pixel)] == 0);
    }
    const auto& box = screen.GetRegion().Rectangle;
    int columns[2] = { 768, 0 };
    int rows[2] = { 576, 0 };
    for (int pixel = 0; pixel < 768 * 576; ++pixel)
    {
      if (seen[static_cast<std::size_t>(pixel)])
      {
        columns[0] = std::min(columns[0], pixel % 768);
        columns[1] = std::max(columns[1], pixel % 768);
        rows[0] = std::min(rows[0], pixel / 768);
        rows[1] = std::max(rows[1], pixel / 768);
      }
    }
    EXPECT_EQ(box,
      (std::array<int, 4>{
        columns[0], rows[0], columns[1] - columns[0] + 1, rows[1] - rows[0] + 1 }));
    EXPECT_TRUE(screen.GetRegion().IsSector);
    // as large as can be
    EXPECT_LT(screen.GetPixelSpacing(), furniture ? 0.14 : 0.122);
    const double perCentimetre = 10 / screen.GetPixelSpacing();
    EXPECT_NEAR(perCentimetre, std::round(perCentimetre), 1e-9);
  }
}

TEST(ScannerScreen, ShowsTheRectangleOfALinearProbe)
{
  const ScannerScreen screen(Linear());
  const Matrix4 toFace = screen.GetImageToFace();
  const auto& first = screen.GetRuns().front();
  const auto& last = screen.GetRuns().back();
  EXPECT_NEAR(toFace.Point({ 0, static_cast<double>(first.Row), 0 })[1], 0, 1e-9);
  EXPECT_NEAR(toFace.Point({ 0, static_cast<double>(last.Row), 0 })[1], 60, 0.15);
  EXPECT_NEAR(toFace.Point({ static_cast<double>(first.First), 0, 0 })[0], -30, 0.15);
  EXPECT_NEAR(toFace.Point({ static_cast<double>(first.Last), 0, 0 })[0], 30, 0.15);
  EXPECT_FALSE(screen.GetRegion().IsSector);
  EXPECT_EQ(screen.GetRegion().Rectangle,
    (std::array<int, 4>{
      first.First, first.Row, first.Last - first.First + 1, last.Row - first.Row + 1 }));
  EXPECT_EQ(screen.GetRuns().size(), static_cast<std::size_t>(last.Row - first.Row + 1));
}

TEST(ScannerScreen, HasARulerWithTicksAtTheirDepths)
{
  for (const ScannerLayout& layout : { ScannerLayout(), Linear() })
  {
    const ScannerScreen screen(layout);
    const Matrix4 toFace = screen.GetImageToFace();
    // a column in which only the ruler is: the one with most beginnings of bright runs
    std::vector<int> rows;
    for (int column = 700; column < 768; ++column)
    {
      std::vector<int> found;
      for (int row = 1; row < 576; ++row)
      {
        if (screen.GetGround()[static_cast<std::size_t>(768 * row + column)] == 220 &&
          screen.GetGround()[static_cast<std::size_t>(768 * (row - 1) + column)] == 0)
        {
          found.push_back(row);
        }
      }
      rows = found.size() > rows.size() ? found : rows;
    }
    ASSERT_EQ(rows.size(), 13u); // 0 5 ... 60 mm
    for (std::size_t tick = 0; tick < rows.size(); ++tick)
    {
      EXPECT_NEAR(toFace.Point({ 0, static_cast<double>(rows[tick]), 0 })[1],
        5.0 * static_cast<double>(tick), 0.51 * screen.GetPixelSpacing());
    }
  }
}

TEST(ScannerScreen, WritesTheFramesNumber)
{
  const ScannerScreen screen({});
  std::set<std::vector<std::uint8_t>> frames;
  for (std::int64_t number = 0; number < 100; ++number)
  {
    std::vector<std::uint8_t> frame = screen.GetGround();
    screen.DrawFrameNumber(0, number, frame.data());
    frames.insert(frame);
    for (const ScannerScreen::Run& run : screen.GetRuns())
    {
      for (int column = run.First; column <= run.Last; ++column)
      {
        ASSERT_EQ(frame[static_cast<std::size_t>(768 * run.Row + column)], 0);
      }
    }
  }
  EXPECT_EQ(frames.size(), 100u);
  ScannerLayout bare;
  bare.Furniture = false;
  std::vector<std::uint8_t> frame(768 * 576, 0);
  ScannerScreen(bare).DrawFrameNumber(3, 4, frame.data());
  EXPECT_EQ(frame, ScannerScreen(bare).GetGround());
  EXPECT_EQ(frame, std::vector<std::uint8_t>(768 * 576, 0));
}

TEST(ScannerScreen, FitsIntoSmallFramesAndSaysWhatCannotBe)
{
  ScannerLayout layout;
  layout.Columns = 320;
  layout.Rows = 240;
  EXPECT_GT(ScannerScreen(layout).GetRuns().size(), 100u);
  layout.Rows = 200;
  EXPECT_NE(Complaint(layout).find("240"), std::string::npos);
  layout = {};
  layout.Depth = 1;
  EXPECT_NE(Complaint(layout).find("depth is 1 mm"), std::string::npos);
  layout = {};
  layout.HalfAngle = 90;
  EXPECT_NE(Complaint(layout).find("angle"), std::string::npos);
  layout = Linear();
  layout.Width = std::nan("");
  EXPECT_NE(Complaint(layout).find("width"), std::string::npos);
  layout = Linear(false);
  layout.Columns = 16;
  layout.Rows = 16;
  layout.Depth = 400;
  EXPECT_NE(Complaint(layout).find("too small"), std::string::npos);
}
