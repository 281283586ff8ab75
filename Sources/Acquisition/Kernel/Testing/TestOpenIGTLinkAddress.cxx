// SPDX-License-Identifier: BSD-3-Clause
// Addresses and clocks of OpenIGTLink servers.
#include "lacunaOpenIGTLinkAddress.h"
#include "lacunaOpenIGTLinkClock.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>

using namespace lacuna;

namespace
{
std::string Fault(const std::string& text)
{
  try
  {
    ParseOpenIGTLinkAddress(text);
  }
  catch (const std::invalid_argument& e)
  {
    return e.what();
  }
  return {};
}
}

TEST(OpenIGTLinkAddress, Parts)
{
  EXPECT_TRUE(IsOpenIGTLinkAddress("igtl://host"));
  EXPECT_TRUE(IsOpenIGTLinkAddress("IGTL://host"));
  EXPECT_FALSE(IsOpenIGTLinkAddress("/dev/ttyUSB0"));
  EXPECT_FALSE(IsOpenIGTLinkAddress("igtl:/"));
  EXPECT_FALSE(IsOpenIGTLinkAddress(""));
  const OpenIGTLinkAddress all = ParseOpenIGTLinkAddress(
    "igtl://scanner.local:23338/?transform=ProbeToTracker&image=Image_Reference&start=tdata");
  EXPECT_EQ(all.Host, "scanner.local");
  EXPECT_EQ(all.Port, 23338);
  EXPECT_EQ(all.Transform, "ProbeToTracker");
  EXPECT_EQ(all.Image, "Image_Reference");
  EXPECT_EQ(all.StartTrackingData, "TDATA");
  EXPECT_EQ(all.GetServer(), "igtl://scanner.local:23338");
  const OpenIGTLinkAddress least = ParseOpenIGTLinkAddress("igtl://10.0.0.7");
  EXPECT_EQ(least.Port, 18944);
  EXPECT_EQ(least.Transform + least.Image, "");
  EXPECT_EQ(least.StartTrackingData, "");
  EXPECT_EQ(ParseOpenIGTLinkAddress("igtl://host?start=qtdata").StartTrackingData, "QTDATA");
  const OpenIGTLinkAddress six = ParseOpenIGTLinkAddress("igtl://[fe80::1]:1?image=My%20B%26W");
  EXPECT_EQ(six.Host, "fe80::1");
  EXPECT_EQ(six.Image, "My B&W");
  EXPECT_EQ(six.GetServer(), "igtl://[fe80::1]:1");
}

TEST(OpenIGTLinkAddress, WrongOnesAreExplained)
{
  for (const auto& [text, why] :
    { std::pair<std::string, std::string>{ "http://host", "begin" }, { "igtl://", "names no host" },
      { "igtl://:18944", "names no host" }, { "igtl://host:0", "from 1 to 65535" },
      { "igtl://host:65536", "from 1 to 65535" }, { "igtl://host:", "from 1 to 65535" },
      { "igtl://host:12x", "'12x'" }, { "igtl://[::1", "has no ]" },
      { "igtl://[::1]x:1", "right name" }, { "igtl://user@host", "right name" },
      { "igtl://host?image", "no right value" }, { "igtl://host?image=", "no right value" },
      { "igtl://host?image=%2", "no right value" }, { "igtl://host?image=%00", "no right value" },
      { "igtl://host?probe=A", "none of" }, { "igtl://host?start=IMAGE", "none of" } })
  {
    EXPECT_NE(Fault(text).find(why), std::string::npos) << text << ": " << Fault(text);
    EXPECT_NE(Fault(text).find("igtl://localhost:18944"), std::string::npos) << Fault(text);
  }
}

TEST(OpenIGTLinkClock, FindsTheOffsetBehindTheJitter)
{
  std::mt19937 random(3);
  std::exponential_distribution<double> delay(1 / 0.01); // 10 ms in the mean
  constexpr double offset = -1.7e9;                      // ours is since the computer's start
  OpenIGTLinkClock clock;
  double worst = 0;
  for (int i = 0; i < 3000; ++i) // a minute, and 50 parts in a million of drift
  {
    const double time = 1000 + 0.02 * i;
    const double stamp = std::ldexp(std::floor(std::ldexp(time * (1 - 5e-5) - offset, 32)), -32);
    const double arrival = time + 0.002 + delay(random);
    const double local = clock.ToLocal("Probe", stamp, arrival);
    EXPECT_LE(local, arrival);
    if (i > 200)
    {
      worst = std::max(worst, std::abs(local - time - 0.002));
    }
  }
  EXPECT_LT(worst, 0.0015); // the drift of a window is 1 ms
  EXPECT_GT(clock.GetJitter("Probe"), 0.04);
  EXPECT_LT(clock.GetJitter("Probe"), 0.15);
  EXPECT_NEAR(*clock.GetOffset("Probe"), offset, 0.1);
  EXPECT_FALSE(clock.GetOffset("Image"));
  EXPECT_EQ(clock.GetNumberOfSteps("Probe"), 0);
}

TEST(OpenIGTLinkClock, DevicesOfOneClockShareItsOffset)
{
  OpenIGTLinkClock clock;
  // the image needs 30 ms longer: what has the same stamp is at the same time all the same
  double pose = clock.ToLocal("Probe", 500, 10.001);
  double image = clock.ToLocal("Image", 500, 10.031);
  EXPECT_DOUBLE_EQ(pose, image);
  EXPECT_NEAR(pose, 10.001, 1e-9);
  // one with a clock of its own is by itself
  EXPECT_NEAR(clock.ToLocal("Other", 9000, 10.05), 10.05, 1e-9);
  pose = clock.ToLocal("Probe", 500.02, 10.022);
  image = clock.ToLocal("Image", 500.02, 10.055);
  EXPECT_NEAR(pose, 10.021, 1e-9);
  EXPECT_DOUBLE_EQ(pose, image);
  // what has not been heard of for long tells nothing
  EXPECT_NEAR(clock.ToLocal("Image", 600, 110.04), 110.04, 1e-9);
}

TEST(OpenIGTLinkClock, NamesWithoutEndTakeNoMemory)
{
  OpenIGTLinkClock clock;
  EXPECT_NEAR(clock.ToLocal("Probe", 500, 10.001), 10.001, 1e-9);
  for (int i = 0; i < 1000; ++i)
  {
    const std::string name = "Device " + std::to_string(i);
    EXPECT_NEAR(clock.ToLocal(name, 9000, 10.002), 10.002, 1e-9);
    EXPECT_EQ(clock.GetOffset(name).has_value(), i + 1 < int(OpenIGTLinkClock::MostDevices));
  }
  EXPECT_NEAR(clock.ToLocal("Device 999", 9000, 10.003), 10.003, 1e-9);
  // those that were there first go on
  EXPECT_NEAR(clock.ToLocal("Probe", 500.02, 10.022), 10.021, 1e-9);
}

TEST(OpenIGTLinkClock, AClockThatIsSetStartsAnew)
{
  OpenIGTLinkClock clock;
  for (int i = 0; i < 100; ++i)
  {
    clock.ToLocal("Probe", 700 + 0.02 * i, 10.005 + 0.02 * i);
  }
  EXPECT_NEAR(clock.ToLocal("Probe", 400, 12.005), 12.005, 1e-9); // back
  EXPECT_EQ(clock.GetNumberOfSteps("Probe"), 1);
  EXPECT_NEAR(clock.ToLocal("Probe", 400.02, 12.03), 12.025, 1e-9);
  EXPECT_NEAR(clock.ToLocal("Probe", 5000, 12.05), 12.05, 1e-9); // ahead, once
  EXPECT_NEAR(clock.ToLocal("Probe", 400.06, 12.07), 12.07, 1e-9);
  EXPECT_EQ(clock.GetNumberOfSteps("Probe"), 3);
  // a network that stands for two seconds is no such thing
  EXPECT_NEAR(clock.ToLocal("Probe", 400.08, 14.07), 12.09, 1e-9);
  EXPECT_NEAR(clock.ToLocal("Probe", 402.08, 14.09), 14.09, 1e-9);
  EXPECT_EQ(clock.GetNumberOfSteps("Probe"), 3);
}
