// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// One measurement of a tracker.
#ifndef lacunaTrackedPose_h
#define lacunaTrackedPose_h

#include "lacunaMatrix4.h"

#include <optional>

namespace lacuna
{
/// By which estimate of a sender's clock a time is known. When the estimate changes by much, times before
/// and after do not fit together.
struct ClockEpoch
{
  const void* Sender = nullptr; ///< nothing: the time is of our own clock
  int Number = 0;

  bool Fits(const ClockEpoch& other) const
  {
    return this->Sender != other.Sender || this->Number == other.Number;
  }
};

/// Times are s of the acquisition's clock.
struct TrackedPose
{
  double Request = 0; ///< when it was asked for
  double Arrival = 0; ///< when the last byte of the record was there
  double Time = 0;    ///< the instant that it holds for: the request and the tracker's latency
  int Station = 1;
  Matrix4 ReceiverToTransmitter; ///< mm
  char Error = ' ';              ///< the unit's error code
  bool Usable = true;            ///< false: its code says not to rely on it, or it came too late
  bool Flipped = false;          ///< signs were set right for the other hemisphere
  std::optional<bool> Button;
  ClockEpoch Epoch;
};
}
#endif
