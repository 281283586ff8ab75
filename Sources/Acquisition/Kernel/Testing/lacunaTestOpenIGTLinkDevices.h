// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Devices of OpenIGTLink servers for tests.
#ifndef lacunaTestOpenIGTLinkDevices_h
#define lacunaTestOpenIGTLinkDevices_h

#include "lacunaOpenIGTLinkDevices.h"
#include "lacunaTestDevice.h"
#include "lacunaTestOpenIGTLink.h"

#include <gtest/gtest.h>

#include <atomic>
#include <memory>
#include <string>
#include <vector>

namespace lacunaTest
{
inline const lacuna::SteadyClock TheClock;
inline const auto Always = [] { return false; };
constexpr double Single = 2e-5;       // mm
constexpr double SenderAhead = 1.7e9; // s of the server's clock before ours

/// The real time and what is added to it.
class SkippingClock : public lacuna::Clock
{
public:
  double Now() const override { return TheClock.Now() + this->Skipped; }
  std::atomic<double> Skipped{ 0 };
};

struct Factories
{
  explicit Factories(const std::string& address)
    : Poses(lacuna::MakeOpenIGTLinkPoseFactory(address, 3, TheClock))
    , Frames(lacuna::MakeOpenIGTLinkFrameFactory(address, TheClock))
  {
  }
  lacuna::PoseDeviceFactory Poses;
  lacuna::FrameDeviceFactory Frames;
};

inline std::unique_ptr<lacuna::PoseDevice> OpenPoses(const std::string& address)
{
  auto device = lacuna::MakeOpenIGTLinkPoseFactory(address, 1, TheClock)(Always);
  device->SetUp();
  return device;
}

inline std::unique_ptr<lacuna::FrameDevice> OpenFrames(const std::string& address)
{
  return lacuna::MakeOpenIGTLinkFrameFactory(address, TheClock)(Always);
}

template <class Error, class Call>
std::string WhatOf(Call&& call)
{
  try
  {
    call();
  }
  catch (const Error& e)
  {
    return e.what();
  }
  return {};
}

inline std::string Grey(int columns, int rows, const std::string& device, double stamp = 0)
{
  std::vector<char> pixels;
  for (int i = 0; i < columns * rows; ++i)
  {
    pixels.push_back(static_cast<char>(3 * (i % columns) + 40 * (i / columns)));
  }
  return ImageBytes(columns, rows, pixels, device, stamp);
}
}
#endif
