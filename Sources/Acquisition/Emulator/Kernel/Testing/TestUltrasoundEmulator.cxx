// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaFanDetection.h"
#include "lacunaTemporalCalibration.h"
#include "lacunaUltrasoundEmulator.h"
#include "lacunaVideoService.h"
#include "lacunaWallDetection.h"
#include "lacunaWaterBath.h"

#include <gtest/gtest.h>

#include <cmath>

using namespace lacuna;

namespace
{
using Frame = std::vector<std::uint8_t>;

UltrasoundEmulator Make(double speckle, Anatomy anatomy = Anatomy::Ellipsoids)
{
  UltrasoundSettings settings;
  settings.SpeckleLevel = speckle;
  return { MakePhantomScene(anatomy, 1), settings };
}

// As the probe looks at the scene from above, moved and turned.
Matrix4 Look(const UltrasoundEmulator& emulator, double z = 0, double turn = 0)
{
  return Matrix4::Rotation({ 0.2, 1, 0.1 }, turn) * Matrix4::Translation({ 0, -30, z }) *
    emulator.GetScreen().GetImageToFace();
}

Frame Render(const UltrasoundEmulator& emulator, const Matrix4& pose, std::int64_t number = 7)
{
  Frame frame(768 * 576, 99);
  emulator.Render(pose, 0.04 * static_cast<double>(number), number, frame.data());
  return frame;
}
}

TEST(UltrasoundEmulator, ShowsTheSceneAtThePose)
{
  const UltrasoundEmulator emulator = Make(0);
  const Matrix4 pose = Look(emulator, 3, 0.4);
  const Frame frame = Render(emulator, pose);
  int bright = 0;
  for (const ScannerScreen::Run& run : emulator.GetScreen().GetRuns())
  {
    for (int column = run.First; column <= run.Last; ++column)
    {
      const double level = emulator.GetScene().Value(
        pose.Point({ static_cast<double>(column), static_cast<double>(run.Row), 0 }));
      const int pixel = frame[static_cast<std::size_t>(768 * run.Row + column)];
      ASSERT_LE(std::abs(pixel - level), 0.5 + 1e-9) << column << " " << run.Row;
      bright += pixel > 120 ? 1 : 0;
    }
  }
  EXPECT_GT(bright, 10000);
}

TEST(UltrasoundEmulator, IsTheSameForTheSamePoseAndNumber)
{
  const UltrasoundEmulator emulator = Make(0.3);
  const Matrix4 pose = Look(emulator, 3, 0.4);
  const Frame frame = Render(emulator, pose);
  EXPECT_EQ(Render(Make(0.3), pose), frame);
  const Frame later = Render(emulator, pose, 8);
  EXPECT_NE(later, frame);
  for (const ScannerScreen::Run& run : emulator.GetScreen().GetRuns())
  {
    const auto begin = 768 * run.Row + run.First;
    ASSERT_TRUE(std::equal(frame.begin() + begin, frame.begin() + begin + run.Last - run.First + 1,
      later.begin() + begin)); // the tissue stands still
  }
}

TEST(UltrasoundEmulator, SpeckleKeepsTheMeanLevel)
{
  const UltrasoundEmulator plain = Make(0);
  const UltrasoundEmulator speckled = Make(0.3);
  const Matrix4 pose = Look(plain, 40); // tissue of 60 alone
  const Frame without = Render(plain, pose);
  const Frame with = Render(speckled, pose);
  double sum = 0;
  double squares = 0;
  double count = 0;
  for (const ScannerScreen::Run& run : plain.GetScreen().GetRuns())
  {
    for (int column = run.First; column <= run.Last; ++column)
    {
      const auto pixel = static_cast<std::size_t>(768 * run.Row + column);
      ASSERT_EQ(without[pixel], 60);
      sum += with[pixel];
      squares += with[pixel] * with[pixel];
      ++count;
    }
  }
  EXPECT_NEAR(sum / count, 60, 1.5);
  EXPECT_NEAR(std::sqrt(squares / count - sum / count * sum / count), 18, 1.5);
}

// The region that Swept Volume and the acquisition look for in any scanner's video.
TEST(UltrasoundEmulator, ItsSectorIsFoundInTheVideo)
{
  const UltrasoundEmulator emulator = Make(0.3);
  std::vector<Frame> frames;
  std::vector<SliceImage> slices;
  for (int i = 0; i < 12; ++i)
  {
    frames.push_back(Render(emulator, Look(emulator, 3 * i - 18, 0.02 * i), i));
  }
  for (const Frame& frame : frames)
  {
    SliceImage slice;
    slice.Pixels = frame.data();
    slice.Type = ScalarType::UInt8;
    slice.RowStride = 768;
    slice.Width = 768;
    slice.Height = 576;
    slices.push_back(slice);
  }
  const double spacing = emulator.GetScreen().GetPixelSpacing();
  const DetectedFan found = DetectFan(slices, { spacing, spacing });
  ASSERT_TRUE(found.IsSector);
  const Vec3 origin = emulator.GetScreen().GetImageToFace().Inverse().Point({ 0, -40, 0 });
  EXPECT_NEAR(found.Sector.Origin[0], origin[0], 1.5);
  EXPECT_NEAR(found.Sector.Origin[1], origin[1], 3);
  EXPECT_NEAR(found.Sector.Angles[0], -26, 0.3);
  EXPECT_NEAR(found.Sector.Angles[1], 26, 0.3);
  EXPECT_NEAR(found.Sector.Radii[0], 40, 0.5);
  EXPECT_NEAR(found.Sector.Radii[1], 100, 0.5);
}

TEST(WaterBath, HasItsFloorAtItsDepth)
{
  const WaterBath bath;
  EXPECT_NEAR(bath.Value({ 5, WaterBath::FloorDepth, -3 }), bath.IsoValue(), 1e-9);
  EXPECT_EQ(bath.Value({ 5, WaterBath::FloorDepth - 1, 9 }), 6);
  EXPECT_GT(bath.Value({ 5, WaterBath::FloorDepth + 0.5, 9 }), 200);
  EXPECT_LT(bath.Value({ 5, WaterBath::FloorDepth + 9, 9 }), 20);
}

// Its latency is what Temporal Calibration finds.
TEST(WaterBath, TellsTheLatencyOfTheVideo)
{
  const auto bob = [](double time, int)
  {
    return Matrix4::Translation({ 200 + std::sin(3 * time), 2 * std::sin(time),
      8 * std::sin(5.1 * time) + 4 * std::sin(8.3 * time) });
  };
  UltrasoundSettings settings;
  settings.Layout.Shape = ScannerLayout::Probe::Linear;
  settings.Layout.Furniture = false;
  const UltrasoundEmulator emulator(std::make_unique<WaterBath>(), settings);
  const EmulatedProbe probe(bob, 1, emulator.GetScreen().GetImageToFace(), 60, 0);
  for (const double latency : { 0.04, 0.13 })
  {
    std::vector<TemporalCalibration::Sample> samples;
    for (int i = 0; i < 300; ++i)
    {
      const double time = 10 + 0.04 * i;
      const Frame frame = Render(emulator, probe.ImageToScene(time - latency), i);
      const auto wall = FindWall({ ScalarType::UInt8, frame.data(), 768, 768, 576 });
      ASSERT_TRUE(wall.has_value()) << i;
      samples.push_back(
        { time, 0.5 * (wall->Points[0][1] + wall->Points[1][1]), bob(time, 1), true });
    }
    EXPECT_NEAR(TemporalCalibration::Solve(samples).Lag, latency, 0.002);
  }
}

TEST(UltrasoundEmulator, RefusesAnImpossibleSpeckle)
{
  for (const double level : { -0.1, 1.1, std::nan("") })
  {
    EXPECT_THROW(Make(level), std::invalid_argument);
  }
}
