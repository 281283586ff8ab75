// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaFramePairing.h"

#include <gtest/gtest.h>

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
