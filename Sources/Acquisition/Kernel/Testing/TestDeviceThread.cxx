// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaClock.h"
#include "lacunaDeviceThread.h"
#include "lacunaExecution.h"
#include "lacunaTestNoThreads.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <thread>

using namespace lacuna;

namespace
{
void Sleep(double seconds)
{
  std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
}

// Waits until a device's health is so, for at most a minute.
template <class Condition>
bool Becomes(const DeviceThread& device, const Condition& condition)
{
  const SteadyClock clock;
  const double end = clock.Now() + 60;
  while (!condition(device.GetHealth()) && clock.Now() < end)
  {
    Sleep(0.002);
  }
  return condition(device.GetHealth());
}
}

TEST(DeviceThread, ADeviceThatFailedIsTriedAgain)
{
  std::atomic<int> sessions{ 0 };
  std::atomic<bool> plugged{ false };
  DeviceThread device(
    [&](DeviceThread::Control& control)
    {
      ++sessions;
      if (!plugged)
      {
        throw std::runtime_error("plug it in");
      }
      control.SetWorking();
      while (!control.IsStopped() && plugged)
      {
        Sleep(0.001);
      }
      if (!plugged)
      {
        throw std::runtime_error("gone");
      }
    },
    0.001);
  EXPECT_TRUE(Becomes(device, [](const auto& health) { return health.Failures > 3; }));
  EXPECT_EQ(device.GetHealth().Trouble, "plug it in");
  EXPECT_FALSE(device.GetHealth().Working);
  plugged = true;
  EXPECT_TRUE(Becomes(device, [](const auto& health) { return health.Working; }));
  EXPECT_EQ(device.GetHealth().Trouble, "");
  plugged = false;
  EXPECT_TRUE(
    Becomes(device, [](const auto& health) { return !health.Working && health.Failures > 0; }));
  plugged = true;
  EXPECT_TRUE(Becomes(device, [](const auto& health) { return health.Working; }));
  EXPECT_GE(sessions, 5);
}

TEST(DeviceThread, SomeFailuresAreFinal)
{
  for (const bool ended : { false, true })
  {
    std::atomic<int> sessions{ 0 };
    DeviceThread device(
      [&](DeviceThread::Control&)
      {
        ++sessions;
        if (ended)
        {
          throw DeviceEnded("final");
        }
        throw std::invalid_argument("final");
      },
      0);
    EXPECT_TRUE(Becomes(device, [](const auto& health) { return health.Failures > 0; }));
    Sleep(0.05);
    EXPECT_EQ(sessions, 1);
    EXPECT_EQ(device.GetHealth().Trouble, "final");
  }
}

TEST(DeviceThread, ItsEndDoesNotWaitForADeviceThatHangs)
{
  const auto hang = std::make_shared<std::atomic<bool>>(true);
  const auto left = std::make_shared<std::atomic<int>>(0);
  const SteadyClock clock;
  double begin = 0;
  {
    const auto session = [=](DeviceThread::Control& control)
    {
      control.SetWorking();
      while (*hang)
      {
        Sleep(0.001);
      }
      ++*left;
    };
    DeviceThread first(session, 1);
    DeviceThread second(session, 1);
    EXPECT_TRUE(Becomes(first, [](const auto& health) { return health.Working; }));
    EXPECT_TRUE(Becomes(second, [](const auto& health) { return health.Working; }));
    begin = clock.Now();
    first.Stop();
    second.Stop();
  }
  const double took = clock.Now() - begin;
  EXPECT_GT(took, 0.79);
  EXPECT_LT(took, 5); // 0.8 but for a busy computer
  *hang = false;      // what it used is still there
  while (*left < 2)
  {
    Sleep(0.001);
  }
}

TEST(DeviceThread, AWaitForTheNextTrialEndsAtOnce)
{
  const SteadyClock clock;
  double begin = 0;
  {
    DeviceThread device([](DeviceThread::Control&) { throw std::runtime_error("no"); }, 1000);
    EXPECT_TRUE(Becomes(device, [](const auto& health) { return health.Failures > 0; }));
    begin = clock.Now();
  }
  EXPECT_LT(clock.Now() - begin, 5);
}

TEST(DeviceThread, WithoutAThreadItDoesNotWorkAndSaysSo)
{
  const lacunaTest::NoThreads none;
  const DeviceThread device([](DeviceThread::Control&) {}, 0.001);
  EXPECT_FALSE(device.GetHealth().Working);
  EXPECT_EQ(device.GetHealth().Failures, 1);
  EXPECT_NE(device.GetHealth().Trouble.find("No thread can be started"), std::string::npos);
}
