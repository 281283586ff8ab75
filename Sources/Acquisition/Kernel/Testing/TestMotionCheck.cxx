// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaFastrakRecord.h"
#include "lacunaFastrakTracker.h"
#include "lacunaPoseTrack.h"
#include "lacunaTestFastrak.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <string>

using namespace lacuna;
using namespace lacunaTest;

namespace
{
// Accelerates and turns.
TrackedPose PoseAt(double time, const Vec3& shift = { 0, 0, 0 })
{
  TrackedPose pose;
  pose.Time = time;
  const Vec3 position{ 300 - 200 * time + 500 * time * time, 40 * time, -120 };
  pose.ReceiverToTransmitter =
    Matrix4::Translation(position + shift) * FastrakRotation(Vec3{ 60 * time, 20, -30 * time });
  return pose;
}
}

TEST(MotionCheck, TakesAHandsMotionFromTheThirdPoseOn)
{
  MotionCheck check;
  std::vector<TrackedPose> accepted;
  for (int i = 0; i < 50; ++i)
  {
    check.Judge(PoseAt(0.02 * i), accepted);
    EXPECT_EQ(accepted.size(), i < 2 ? 0u : i + 1u);
  }
  for (int i = 0; i < 50; ++i)
  {
    EXPECT_EQ(accepted[i].Time, 0.02 * i);
  }
  EXPECT_EQ(check.GetNumberOfDropped(), 0u);
}

TEST(MotionCheck, DropsWhatIsOffInAnyCoordinateOrAngle)
{
  for (int kind = 0; kind < 4; ++kind)
  {
    MotionCheck check;
    std::vector<TrackedPose> accepted;
    for (int i = 0; i < 20; ++i)
    {
      TrackedPose pose = PoseAt(0.02 * i);
      if (i == 7 || i == 8 || i == 12)
      {
        Vec3 shift{ 0, 0, 0 };
        if (kind < 3)
        {
          shift[kind] = i == 8 ? -15 : 15;
        }
        pose = PoseAt(0.02 * i, shift);
        if (kind == 3)
        {
          pose.ReceiverToTransmitter =
            pose.ReceiverToTransmitter * Matrix4::Rotation({ 1, 0.3, 0 }, i == 8 ? -0.15 : 0.15);
        }
      }
      check.Judge(pose, accepted);
    }
    ASSERT_EQ(accepted.size(), 17u) << kind;
    EXPECT_EQ(check.GetNumberOfDropped(), 3u);
    for (const TrackedPose& pose : accepted)
    {
      EXPECT_LT(
        Distance(pose.ReceiverToTransmitter, PoseAt(pose.Time).ReceiverToTransmitter), 1e-12);
    }
  }
}

TEST(MotionCheck, AJumpIsANewMotion)
{
  MotionCheck check;
  std::vector<TrackedPose> accepted;
  for (int i = 0; i < 20; ++i)
  {
    check.Judge(PoseAt(0.02 * i, { 0, i < 10 ? 0.0 : 80.0, 0 }), accepted);
  }
  EXPECT_EQ(accepted.size(), 20u);
  EXPECT_EQ(check.GetNumberOfDropped(), 0u);
}

TEST(MotionCheck, PassageIntoTheOtherHemisphereIsSetRight)
{
  MotionCheck check;
  std::vector<TrackedPose> accepted;
  for (int i = 0; i < 100; ++i)
  {
    TrackedPose pose;
    pose.Time = 0.02 * i;
    const Vec3 truth{ 100 - 4.0 * i, 150, -80 };
    pose.ReceiverToTransmitter =
      Matrix4::Translation((truth[0] < 0 ? -1 : 1) * truth) * FastrakRotation(Vec3{ 10, 20, 30 });
    check.Judge(pose, accepted);
  }
  ASSERT_EQ(accepted.size(), 100u);
  EXPECT_EQ(check.GetNumberOfFlipped(), 74u);
  for (int i = 0; i < 100; ++i)
  {
    EXPECT_LT(
      Norm(accepted[i].ReceiverToTransmitter.Column(3) - Vec3{ 100 - 4.0 * i, 150, -80 }), 1e-9);
    EXPECT_EQ(accepted[i].Flipped, i > 25);
    EXPECT_NEAR(accepted[i].ReceiverToTransmitter.Determinant3(), 1, 1e-12);
  }
}

namespace
{
// A receiver's positions (mm, 50 a second), as a FASTRAK reports them whose hemisphere is that of
// zenith, but for those of which it is silent: each is found where it was. Returns how many were in
// the other hemisphere.
std::uint64_t Follow(int count, const std::function<Vec3(int)>& truth,
  const std::function<bool(int)>& isSilent, double zenith = 1)
{
  MotionCheck check;
  std::vector<TrackedPose> accepted;
  std::size_t reported = 0;
  for (int i = 0; i < count; ++i)
  {
    if (isSilent(i))
    {
      continue;
    }
    ++reported;
    TrackedPose pose;
    pose.Time = 0.02 * i;
    const Vec3 position = truth(i);
    pose.ReceiverToTransmitter =
      Matrix4::Translation((position[0] * zenith < 0 ? -1 : 1) * position) *
      FastrakRotation(Vec3{ 10, 20, 30 });
    check.Judge(pose, accepted);
  }
  EXPECT_EQ(accepted.size(), reported);
  std::uint64_t flipped = 0;
  for (const TrackedPose& pose : accepted)
  {
    const Vec3 position = truth(static_cast<int>(std::lround(pose.Time / 0.02)));
    EXPECT_LT(Norm(pose.ReceiverToTransmitter.Column(3) - position), 1e-9) << pose.Time;
    EXPECT_EQ(pose.Flipped, position[0] * zenith < 0) << pose.Time;
    flipped += pose.Flipped ? 1 : 0;
  }
  EXPECT_EQ(check.GetNumberOfFlipped(), flipped);
  return flipped;
}
}

// A tracker that is silent for a while, and a jerk, after which a new motion begins.
TEST(MotionCheck, TheHemisphereIsKnownAfterAGap)
{
  const auto truth = [](int i)
  {
    const double x = i < 140 ? 100 - 4.0 * i : -460 + 4.0 * (i - 140); // back over x = 0 at 255
    return Vec3{ x, 150, i < 190 ? -80.0 : -20.0 };                    // a jerk
  };
  const auto isSilent = [](int i)
  { return (i > 50 && i < 120) || (i > 240 && i < 270); }; // returns in the second
  EXPECT_GT(Follow(300, truth, isSilent), 100u);
}

// The plane is crossed, both ways, while the tracker is silent or in a jerk.
TEST(MotionCheck, APassageIntoTheOtherHemisphereThatNobodySawIsSetRight)
{
  for (const double way : { -1.0, 1.0 })
  {
    for (const int silent : { 0, 30, 80 })
    {
      const testing::ScopedTrace trace(
        __FILE__, __LINE__, std::to_string(way) + " " + std::to_string(silent));
      const auto truth = [&](int i) {
        return Vec3{ way * (i - 50.5), 150, i > 50 ? -60.0 : -80.0 };
      };
      const auto isSilent = [&](int i) { return i >= 50 - silent / 2 && i <= 50 + silent / 2; };
      // the hemisphere is that in which it begins
      EXPECT_GT(Follow(200, truth, isSilent, -way), 100u);
    }
  }
}

// After some tenths of a second without poses, near the transmitter, those of both sides fit.
TEST(MotionCheck, TheHemisphereIsKnownAfterAShortGapNearTheTransmitter)
{
  struct Case
  {
    double Begin; // mm along the hemisphere's zenith
    double Speed; // mm/s along it
  };
  // goes over before the gap, in it, back in it, not at all
  for (const Case& path : { Case{ 34, -20 }, Case{ 42, -20 }, Case{ 30, 0 } })
  {
    for (const bool back : { false, true })
    {
      for (const int silent : { 0, 5, 10, 15, 20, 23 })
      {
        const testing::ScopedTrace trace(__FILE__, __LINE__,
          std::to_string(path.Begin) + (back ? " back " : " ") + std::to_string(silent));
        const auto truth = [&](int i)
        {
          const double turn = back && i > 100 ? 200 - i : i;
          return Vec3{ path.Begin + path.Speed * 0.02 * turn, 60, 8 };
        };
        Follow(200, truth, [&](int i) { return i > 100 && i <= 100 + silent; });
      }
    }
  }
}

// It was laid aside on the other side of the transmitter, or moved there.
TEST(MotionCheck, AReceiverThatMovedFarInItsHemisphereIsThere)
{
  MotionCheck check;
  std::vector<TrackedPose> accepted;
  for (int i = 0; i < 300; ++i)
  {
    if ((i < 50 || i > 100) && (i < 150 || i > 280))
    {
      TrackedPose pose;
      pose.Time = 0.02 * i;
      pose.ReceiverToTransmitter = Matrix4::Translation(i < 50 ? Vec3{ 200, 150, -80 }
                                       : i < 150               ? Vec3{ 200, -150, 80 }
                                                               : Vec3{ 5, 250, -80 }) *
        FastrakRotation(Vec3{ 10, 20, 30 });
      check.Judge(pose, accepted);
    }
  }
  EXPECT_EQ(accepted.size(), 300u - 51 - 131);
  EXPECT_EQ(check.GetNumberOfFlipped(), 0u);
}

TEST(PoseTrack, InterpolatesButDoesNotGuess)
{
  PoseTrack track(1, 0.25);
  EXPECT_FALSE(track.At(0));
  EXPECT_TRUE(track.IsAhead(0));
  for (const double time : { 0.0, 0.02, 0.04, 0.5, 0.52 })
  {
    TrackedPose pose;
    pose.Time = time;
    pose.ReceiverToTransmitter =
      Matrix4::Translation({ 100 * time, 7, 0 }) * Matrix4::Rotation({ 0, 0, 1 }, 2 * time);
    track.Add(pose);
  }
  const auto middle = track.At(0.025);
  ASSERT_TRUE(middle);
  EXPECT_NEAR(middle->Gap, 0.02, 1e-12);
  EXPECT_NEAR(middle->Nearest, 0.005, 1e-12);
  EXPECT_LT(Distance(middle->ReceiverToTransmitter,
              Matrix4::Translation({ 2.5, 7, 0 }) * Matrix4::Rotation({ 0, 0, 1 }, 0.05)),
    1e-12);
  EXPECT_EQ(track.At(0.5)->Gap, 0);
  EXPECT_FALSE(track.At(0.3)); // gap of 0.46 s
  EXPECT_FALSE(track.At(-0.1));
  EXPECT_FALSE(track.At(0.53));
  EXPECT_TRUE(track.IsAhead(0.53));
  TrackedPose doubtful;
  doubtful.Time = 0.54;
  doubtful.Usable = false;
  track.Add(doubtful);
  EXPECT_FALSE(track.At(0.53));
  TrackedPose late;
  late.Time = 1.53;
  track.Add(late);
  EXPECT_FALSE(track.At(0.51)); // forgotten
}
