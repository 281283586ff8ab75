// SPDX-License-Identifier: BSD-3-Clause
// The tracker as an acquisition sees it.
#include "lacunaDeviceChoice.h"
#include "lacunaEmulatedChannel.h"
#include "lacunaTestDevice.h"
#include "lacunaTestPairing.h"

#include <gtest/gtest.h>

using namespace lacuna;
using namespace lacunaTest;

TEST(FastrakDevice, PassesOnWhatTheTrackerMeasuresAndCounts)
{
  FastrakEmulatorOptions options;
  options.Baud = 115200;
  FastrakEmulator emulator(Sweep, options);
  auto channel = std::make_unique<EmulatedChannel>(emulator, options.Baud);
  const EmulatedChannel& clock = *channel;
  FastrakSettings settings;
  settings.Layout = ChooseFastrakLayout(options.Baud, true);
  FastrakDevice device(std::move(channel), clock, settings, {});
  device.SetUp();
  std::vector<TrackedPose> poses;
  for (int i = 0; i < 20; ++i)
  {
    EXPECT_TRUE(device.Poll(poses));
  }
  ASSERT_EQ(poses.size(), 20u);
  EXPECT_LT(Distance(poses.back().ReceiverToTransmitter, Sweep(poses.back().Time, 1)), 2e-4);
  EXPECT_EQ(poses.back().Button, false);
  EXPECT_GE(device.GetCounts().Poses, 20u);
  EXPECT_EQ(device.GetCounts().Damaged, 0u);
  options.Faults.Silent = true;
  emulator.SetFaults(options.Faults);
  EXPECT_FALSE(device.Poll(poses));
  EXPECT_EQ(device.GetCounts().Missing, 1u);
  options.Faults = {};
  options.Faults.Error = 'k';
  emulator.SetFaults(options.Faults);
  while (!device.Poll(poses))
  {
  }
  EXPECT_FALSE(poses.back().Usable);
  EXPECT_NE(device.GetWarning().find("weak"), std::string::npos);
}

TEST(FastrakDevice, AsksForWhatTheLineCarries)
{
  EXPECT_EQ(ChooseFastrakLayout(19200, false).GetLength(true), 27u); // 46 a second and more
  EXPECT_EQ(ChooseFastrakLayout(115200, false).GetLength(true), 51u);
  EXPECT_EQ(ChooseFastrakLayout(115200, true).GetItems().back(), FastrakItem::Button);
  EXPECT_EQ(ChooseFastrakLayout(19200, false, false).GetLength(false), 45u);
  EXPECT_EQ(ChooseFastrakLayout(57600, true, false).GetLength(false), 83u); // more digits
  EXPECT_EQ(ChooseFastrakLayout(115200, false, false).GetLength(false), 159u);
}

TEST(DeviceChoice, SaysWhatToSetWhenNothingIs)
{
  const SteadyClock clock;
  const auto error = [](const auto& factory)
  {
    try
    {
      factory({});
    }
    catch (const std::invalid_argument& e)
    {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_HAS(error(ChoosePoseDevice({}, clock)), "TrackerConnection is not set");
  TrackerChoice other;
  other.Connection = "usb://1";
  EXPECT_HAS(error(ChoosePoseDevice(other, clock)), "'usb://1'");
  EXPECT_HAS(error(ChooseFrameDevice({}, clock)), "VideoURL is not set");
  other.Connection = "igtl://:1";
  EXPECT_HAS(error(ChoosePoseDevice(other, clock)), "'igtl://:1' names no host");
  VideoSettings video;
  video.URL = "IGTL://host:0";
  EXPECT_HAS(error(ChooseFrameDevice(video, clock)), "from 1 to 65535");
}
