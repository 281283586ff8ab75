// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The recording of a sweep that is being taken, whatever the disk does.
#ifndef lacunaSweepFile_h
#define lacunaSweepFile_h

#include "lacunaAcquiredSlice.h"
#include "lacunaClock.h"
#include "lacunaSequenceFormat.h"
#include "lacunaSweepRecorder.h"

#include <cstdint>
#include <deque>
#include <future>
#include <memory>
#include <optional>
#include <string>

namespace lacuna
{
/// The fields with which a slice is stored. Poses have their names and the states that readers ask
/// for. ImageToProbe is for the pixels of the file, ElementSpacing is that of the video. The others
/// are Timestamp, FrameNumber, SliceStatus, Residual, Speed and, where the pose was held, PoseHeld
/// (s since it was measured). There is no field for a spacing that contradicts the calibration: a
/// reader compares them, with the calibration that it is given.
SequenceFields MakeSliceFields(const AcquiredSlice& slice, const SweepFrame& frame);

/// Opens its file by a free name with the first slice, since only then the size is known, on a thread
/// of its own: devices must not wait for a disk. While that lasts slices wait in memory; when it
/// fails it is tried again every second.
class SweepFile
{
public:
  struct State
  {
    std::string FileName;          ///< empty until it is open
    std::int64_t Added = 0;        ///< slices to be recorded
    std::int64_t Synced = 0;       ///< those on the disk
    std::int64_t Verified = 0;     ///< see SweepRecorder::State
    std::int64_t Lost = 0;         ///< the same
    std::int64_t WaitingBytes = 0; ///< of pixels that are not written
    std::int64_t FreeBytes = -1;   ///< see SweepRecorder::State
    std::string Trouble; ///< why nothing is written now, and what to do; empty: all is well
    std::string Notice;  ///< see SweepRecorder::State
  };

  /// Throws std::invalid_argument for a name by which no sweep can be recorded.
  SweepFile(const std::string& fileName, int compressionLevel);
  /// Writes what waits, unless that fails.
  ~SweepFile();
  SweepFile(const SweepFile&) = delete;
  SweepFile& operator=(const SweepFile&) = delete;

  /// Another name for a file that cannot be opened; of an open one nothing changes. Throws as the
  /// constructor does.
  void Rename(const std::string& fileName, int compressionLevel);
  /// Takes a slice of the frame's window. Throws std::bad_alloc, and has not taken it.
  void Add(const AcquiredSlice& slice, const SweepFrame& frame);
  /// Tries again to open the file and to hand over what waits, when it is time. Whatever fails is
  /// told by the state.
  void Retry();
  State GetState() const;
  /// See SweepRecorder.
  void Verify();
  /// Tries to write all that waits and ends the file. Throws FileError; the slices still wait.
  void Finish();

private:
  struct Opened
  {
    std::string FileName;
    std::unique_ptr<SweepRecorder> Recorder;
  };
  void BeginToOpen();
  bool IsOpen(bool patiently);
  void HandOver(bool patiently);

  struct Entry
  {
    SweepRecorder::Pixels Pixels;
    SequenceFields Fields;
  };

  std::string FileName;
  int CompressionLevel;
  SteadyClock Clock;
  SequenceDescription Description;
  std::deque<Entry> Waiting; ///< slices that the recorder does not have
  double RetryTime = 0;
  State Now; ///< Trouble: of what waits here
  std::future<Opened> Opening;
  std::unique_ptr<SweepRecorder> Recorder;
};
}
#endif
