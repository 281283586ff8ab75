// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaFramePairing.h"

#include <gtest/gtest.h>

#include <cmath>

using namespace lacuna;

namespace
{
PairedFrame MakeFrame(std::int64_t number, double instant)
{
  PairedFrame frame;
  frame.Number = number;
  frame.Instant = instant;
  frame.Wanted = true;
  return frame;
}

TrackedPose MakePose(double time, double x)
{
  TrackedPose pose;
  pose.Time = time;
  pose.ReceiverToTransmitter = Matrix4::Translation({ x, 0, 0 });
  return pose;
}
}

TEST(FramePairing, AFrameGetsThePoseOfItsInstantAndWaitsForIt)
{
  FramePairing pairing;
  pairing.AddPose(MakePose(1.00, 10));
  pairing.AddFrame(MakeFrame(0, 1.01), 1.02);
  pairing.AddFrame(MakeFrame(1, 1.03), 1.03);
  EXPECT_TRUE(pairing.Take(1.03).empty()); // nothing is extrapolated
  EXPECT_EQ(pairing.GetLatestInstant(), 1.03);
  pairing.AddPose(MakePose(1.02, 12));
  std::vector<PairedFrame> ready = pairing.Take(1.04);
  ASSERT_EQ(ready.size(), 1u);
  EXPECT_EQ(ready[0].Number, 0);
  ASSERT_TRUE(ready[0].Pose);
  EXPECT_NEAR(ready[0].Pose->ReceiverToTransmitter(0, 3), 11, 1e-9);
  EXPECT_NEAR(ready[0].Pose->Gap, 0.02, 1e-12);
  EXPECT_NEAR(ready[0].Pose->Nearest, 0.01, 1e-12);
  pairing.AddPose(MakePose(1.04, 14));
  ready = pairing.Take(1.05);
  ASSERT_EQ(ready.size(), 1u);
  EXPECT_NEAR(ready[0].Pose->ReceiverToTransmitter(0, 3), 13, 1e-9);
  EXPECT_FALSE(pairing.GetLatestInstant());
}

TEST(FramePairing, OneWhosePoseDoesNotComeIsLetGoAndKeepsItsPlace)
{
  FramePairing pairing(0.5);
  pairing.AddFrame(MakeFrame(0, 1), 1); // before the first measurement
  pairing.AddFrame(MakeFrame(1, 3), 3);
  EXPECT_TRUE(pairing.Take(1.49).empty());
  ASSERT_EQ(pairing.Take(1.5).size(), 1u);
  pairing.AddPose(MakePose(2.9, 0));
  pairing.AddPose(MakePose(3.2, 0)); // bridges more than a quarter of a second
  std::vector<PairedFrame> ready = pairing.Take(3.2);
  ASSERT_EQ(ready.size(), 1u);
  EXPECT_FALSE(ready[0].Pose);
  pairing.AddFrame(MakeFrame(2, 3.3), 3.3);
  TrackedPose unusable = MakePose(3.31, 0);
  unusable.Usable = false;
  pairing.AddPose(unusable);
  EXPECT_TRUE(pairing.Take(3.32).empty());
  pairing.Abandon();
  ready = pairing.Take(3.32);
  ASSERT_EQ(ready.size(), 1u);
  EXPECT_FALSE(ready[0].Pose);
}

TEST(FramePairing, NothingLiesBetweenTwoTrackers)
{
  FramePairing pairing;
  pairing.AddPose(MakePose(1.00, 10));
  pairing.AddPose(MakePose(1.02, 12));
  pairing.Break();
  pairing.AddPose(MakePose(1.04, 500));
  pairing.AddPose(MakePose(1.06, 502));
  const double instants[] = { 1.01, 1.03, 1.05 };
  for (int i = 0; i < 3; ++i)
  {
    pairing.AddFrame(MakeFrame(i, instants[i]), 1.06);
  }
  const std::vector<PairedFrame> ready = pairing.Take(1.06);
  ASSERT_EQ(ready.size(), 3u);
  EXPECT_NEAR(ready[0].Pose->ReceiverToTransmitter(0, 3), 11, 1e-9);
  EXPECT_FALSE(ready[1].Pose);
  EXPECT_NEAR(ready[2].Pose->ReceiverToTransmitter(0, 3), 501, 1e-9);
}

// While a slow disk ends a recording nobody takes frames.
TEST(FramePairing, FramesThatAreTakenLateKeepTheirPosesAndTheUnwantedAreDropped)
{
  FramePairing pairing;
  for (int i = 0; i < 1500; ++i) // a minute
  {
    const double time = 1 + 0.04 * i;
    pairing.AddPose(MakePose(time - 0.01, time - 0.01));
    PairedFrame frame = MakeFrame(i, time);
    frame.Wanted = i < 200;
    pairing.AddFrame(std::move(frame), time);
    pairing.AddPose(MakePose(time + 0.01, time + 0.01));
  }
  const std::vector<PairedFrame> ready = pairing.Take(61);
  ASSERT_GE(ready.size(), 200u);
  EXPECT_LE(ready.size(), 200u + 25 * 2); // of the others only the newest
  EXPECT_EQ(ready.back().Number, 1499);
  for (std::size_t i = 0; i < ready.size(); ++i)
  {
    EXPECT_TRUE(i >= 200 || ready[i].Number == static_cast<std::int64_t>(i));
    ASSERT_TRUE(ready[i].Pose) << i;
    EXPECT_NEAR(ready[i].Pose->ReceiverToTransmitter(0, 3), ready[i].Instant, 1e-9);
  }
}

// By which the speed at the first frame of a capture is known.
TEST(FramePairing, TheOneBeforeAWantedFrameIsNotDropped)
{
  FramePairing pairing;
  for (int i = 0; i < 500; ++i)
  {
    const double time = 1 + 0.04 * i;
    PairedFrame frame = MakeFrame(i, time);
    frame.Wanted = i == 100 || i == 101 || i == 200;
    pairing.AddFrame(std::move(frame), time);
    pairing.AddPose(MakePose(time + 0.01, time + 0.01));
  }
  const std::vector<PairedFrame> ready = pairing.Take(21);
  ASSERT_GT(ready.size(), 5u);
  const std::int64_t expected[] = { 99, 100, 101, 199, 200 };
  for (int i = 0; i < 5; ++i)
  {
    EXPECT_EQ(ready[i].Number, expected[i]);
    EXPECT_TRUE(ready[i].Frame == nullptr && ready[i].Pose);
  }
  EXPECT_GT(ready[5].Number, 450);
}

TEST(FramePairing, PatienceBeginsAtTheInstant)
{
  FramePairing pairing(0.5);
  pairing.AddFrame(MakeFrame(0, 1.4), 1); // TimeOffset 0.4 s
  EXPECT_TRUE(pairing.Take(1.89).empty());
  EXPECT_EQ(pairing.Take(1.9).size(), 1u);
}

TEST(FramePairing, AFrameWhoseTimeIsNotKnownWaitsForItAndGetsThePoseOfThat)
{
  FramePairing pairing(0.5);
  for (int i = 0; i < 100; ++i)
  {
    pairing.AddPose(MakePose(1 + 0.02 * i, 10 * i));
  }
  for (int i = 0; i < 4; ++i)
  {
    PairedFrame frame = MakeFrame(i, 1.5 + 0.04 * i); // 0.1 s late
    frame.Timed = i == 3;
    frame.Wanted = i != 0;
    pairing.AddFrame(std::move(frame), 1.5 + 0.04 * i);
  }
  EXPECT_EQ(pairing.Take(1.7).size(), 1u); // who only looks does not wait
  EXPECT_FALSE(pairing.FindUntimed());     // the newest does not
  pairing.SetTime(0, -0.1);                // it has left
  pairing.SetTime(1, -0.1);
  pairing.SetTime(2, std::nullopt);
  const std::vector<PairedFrame> ready = pairing.Take(1.7);
  ASSERT_EQ(ready.size(), 3u);
  EXPECT_NEAR(ready[0].Instant, 1.44, 1e-12);
  ASSERT_TRUE(ready[0].Pose);
  EXPECT_NEAR(ready[0].Pose->ReceiverToTransmitter(0, 3), 220, 1e-9);
  EXPECT_FALSE(ready[1].Pose); // its time is never known
  EXPECT_NEAR(ready[2].Pose->ReceiverToTransmitter(0, 3), 310, 1e-9);
}

TEST(FramePairing, AFrameWhoseTimeIsNotToldInThreeSecondsHasNoPose)
{
  FramePairing pairing(0.5);
  pairing.AddPose(MakePose(1, 0));
  pairing.AddPose(MakePose(1.1, 10));
  PairedFrame frame = MakeFrame(0, 1.05);
  frame.Timed = false;
  pairing.AddFrame(std::move(frame), 1.05);
  EXPECT_TRUE(pairing.FindUntimed());
  EXPECT_TRUE(pairing.Take(4.04).empty());
  const std::vector<PairedFrame> ready = pairing.Take(4.06);
  ASSERT_EQ(ready.size(), 1u);
  EXPECT_FALSE(ready[0].Pose);
}

TEST(PoseTrack, ByChoiceTheLastPoseHoldsForSoLong)
{
  PoseTrack track;
  track.Add(MakePose(1, 10));
  track.Add(MakePose(1.1, 11));
  EXPECT_FALSE(track.At(1.2)); // off
  track.SetHold(2);
  EXPECT_NEAR(track.At(1.05)->ReceiverToTransmitter(0, 3), 10.5, 1e-9); // as ever
  EXPECT_FALSE(track.At(1.05)->Held);
  EXPECT_FALSE(track.At(0.9)); // before the first
  const auto held = track.At(3.05);
  ASSERT_TRUE(held);
  EXPECT_TRUE(held->Held);
  EXPECT_EQ(held->ReceiverToTransmitter(0, 3), 11);
  EXPECT_NEAR(held->Nearest, 1.95, 1e-12);
  EXPECT_TRUE(std::isnan(held->Gap));
  EXPECT_FALSE(track.At(3.11));
  track.Add(MakePose(30, 12)); // what is older than the track keeps holds all the same
  EXPECT_EQ(track.At(3)->ReceiverToTransmitter(0, 3), 11);
  EXPECT_FALSE(track.At(29.9));
  EXPECT_EQ(track.At(31)->ReceiverToTransmitter(0, 3), 12);
}

TEST(PoseTrack, NoPoseHoldsOverWhatTheTrackerMarksAsInvalidNorOverItsEnd)
{
  PoseTrack track;
  track.SetHold(10);
  track.Add(MakePose(1, 10));
  TrackedPose lost = MakePose(2, 999);
  lost.Usable = false;
  track.Add(lost);
  EXPECT_TRUE(track.At(1.9));
  EXPECT_FALSE(track.At(2.1));
  track.Add(MakePose(3, 20));
  EXPECT_FALSE(track.At(2.9)); // not before it was seen again
  EXPECT_EQ(track.At(3.5)->ReceiverToTransmitter(0, 3), 20);
  track.EndHold();
  EXPECT_FALSE(track.At(3.5));
  track.Add(MakePose(4, 30));
  EXPECT_TRUE(track.At(5));
  track.Break(); // another tracker
  EXPECT_FALSE(track.At(5));
  track.Add(MakePose(6, 40));
  EXPECT_FALSE(track.At(5));
  EXPECT_EQ(track.At(7)->ReceiverToTransmitter(0, 3), 40);
}

TEST(PoseTrack, TimesOfTwoEstimatesOfOneClockDoNotMeet)
{
  const int sender = 0;
  const auto pose = [&](double time, double x, int epoch)
  {
    TrackedPose made = MakePose(time, x);
    made.Epoch = { &sender, epoch };
    return made;
  };
  PoseTrack track;
  track.Add(pose(1.10, 10, 0)); // 0.1 s too late
  track.Add(pose(1.12, 12, 0));
  EXPECT_TRUE(track.At(1.11, { &sender, 0 }));
  EXPECT_FALSE(track.At(1.11, { &sender, 1 }));
  EXPECT_TRUE(track.At(1.11));  // a frame grabber's
  track.Add(pose(1.04, 14, 1)); // is later, though its time is not
  track.Add(pose(1.06, 16, 1));
  EXPECT_FALSE(track.At(1.05, { &sender, 0 }));
  EXPECT_NEAR(track.At(1.05, { &sender, 1 })->ReceiverToTransmitter(0, 3), 15, 1e-9);
}
