// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The state of a live source.
#ifndef lacunaLiveSweep_h
#define lacunaLiveSweep_h

#include "lacunaGrowingStack.h"
#include "lacunaMemory.h"
#include "lacunaSweepAcquisition.h"

#include <algorithm>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace lacuna
{
/// What vtkLacunaPolhemusVideoSource has while it is live.
struct LiveSweep
{
  static constexpr const char* WaitingText =
    "The devices, and a calibration chosen with them, are changed at the next update after Stop";

  // Threads that a call of the system holds may need it to the end of the program.
  static const Clock& GetClock()
  {
    static const auto* clock = new SteadyClock;
    return *clock;
  }

  // At least enough for some slices.
  static std::int64_t FindFreeBytes()
  {
    constexpr std::int64_t some = 128 * 1024 * 1024;
    return std::max(static_cast<std::int64_t>(GetAvailableMemory()), some);
  }

  AcquisitionState GetState() const
  {
    return this->Acquisition ? this->Acquisition->GetState() : AcquisitionState();
  }

  // Of what took the slices that are there.
  AcquisitionState GetSweepState() const
  {
    return this->StackIsOfOthers ? this->Past : this->GetState();
  }

  // Slices that are only in memory though they were to be recorded, and will not be: what took them
  // has ended.
  std::int64_t GetUnwritten() const
  {
    return this->StackIsOfOthers ? this->Past.File.Added - this->Past.File.Synced : 0;
  }

  // As they were opened.
  std::string DescribeDevices() const
  {
    return this->Tracker + " " + this->Video + " " + this->Crop;
  }

  std::unique_ptr<SweepAcquisition> Acquisition; // null while not connected
  std::string Tracker;                           // as they were opened
  std::string Video;
  std::string Crop;
  std::string Tried;   // what was configured last, rightly or not
  std::string Trouble; // why it could not be
  std::int64_t LimitBytes = 0;
  std::int64_t FreeBytes = 0;          // of memory, when the devices were opened
  std::deque<AcquiredSlice> Taken;     // slices that wait for memory
  std::string MemoryTrouble;           // of these
  std::unique_ptr<GrowingStack> Stack; // null before the first slice
  AcquisitionRules Rules;              // that are in force
  SweepFrame Calibration;              // that is in force; without a window
  std::string TakenBy;                 // devices and rules, for its provenance
  bool StackIsOfOthers = false;        // of devices that are not these
  AcquisitionState Past;               // at the end of those, then
  bool MayDiscard = false;             // Clear was refused, for just these slices
  std::unique_ptr<GrowingStack> Newest;
  std::int64_t NewestNumber = -1;
  std::map<std::string, double> Subjects; // of messages, and when they were there last
  std::vector<std::string> News;          // messages to warn of
  bool ToldUncalibrated = false;
  bool ToldCapturing = false; // by the output
  std::string Messages;       // what the getter has returned
  std::string FileName;
  std::string DiskMessage;
};
}
#endif
