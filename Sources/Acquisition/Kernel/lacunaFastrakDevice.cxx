// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaFastrakDevice.h"

#include "lacunaSerialPort.h"

#include <utility>

namespace lacuna
{
FastrakDevice::FastrakDevice(std::unique_ptr<ByteChannel> channel, const Clock& clock,
  const FastrakSettings& settings, std::function<bool()> stopped)
  : Channel(std::move(channel))
  , Tracker(*this->Channel, clock, settings, std::move(stopped))
{
}

PoseCounts FastrakDevice::GetCounts() const
{
  const FastrakTracker::Counts counts = this->Tracker.GetCounts();
  return { counts.Records, counts.Silent, counts.Damaged, counts.Implausible, counts.Flipped };
}

FastrakLayout ChooseFastrakLayout(int baud, bool withButton)
{
  constexpr int fast = 38400; // 51 bytes take 13 ms
  std::vector<FastrakItem> items{ FastrakItem::Position, FastrakItem::Angles };
  if (baud >= fast)
  {
    items.insert(items.end(), { FastrakItem::Position, FastrakItem::Angles });
  }
  if (withButton)
  {
    items.push_back(FastrakItem::Button);
  }
  return FastrakLayout(std::move(items));
}

PoseDeviceFactory MakeFastrakFactory(
  const std::string& port, int baud, const Clock& clock, const FastrakSettings& settings)
{
  return [port, baud, &clock, settings](const std::function<bool()>& stopped)
  {
    return std::make_unique<FastrakDevice>(
      std::make_unique<SerialPort>(port, baud), clock, settings, stopped);
  };
}
}
