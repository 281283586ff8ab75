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
  return { counts.Records, counts.Silent + counts.Late, counts.Damaged, counts.Implausible,
    counts.Flipped };
}

FastrakLayout ChooseFastrakLayout(int baud, bool withButton, bool binary)
{
  constexpr double longest = 0.0145; // s on the line, beside 10 ms of the unit
  std::vector<std::vector<int>> lists{ { 2, 4, 2, 4 }, { 2, 4 } };
  if (!binary)
  {
    lists = { { 52, 54, 52, 54 }, { 52, 54 }, { 2, 4 } };
  }
  for (std::vector<int>& list : lists)
  {
    if (withButton)
    {
      list.push_back(static_cast<int>(FastrakItem::Button));
    }
    FastrakLayout layout = FastrakLayout::FromNumbers(list);
    const auto bytes = static_cast<double>(layout.GetLength(binary));
    if (10 * bytes / baud < longest || &list == &lists.back())
    {
      return layout;
    }
  }
  return {};
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
