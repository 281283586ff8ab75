// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Puts the slices of a sweep on disk while it is taken.
#ifndef lacunaSweepRecorder_h
#define lacunaSweepRecorder_h

#include "lacunaSequenceFormat.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace lacuna
{
/// A SequenceRecorder on a thread of its own: who takes slices never waits for a disk. Slices are
/// written as they come, and every 0.3 s the disk is made to have them, so that the end of the
/// program loses none that are written and a failure of the power none that are synced.
///
/// On a full or failing disk slices wait in memory, in order, and writing is tried again every
/// second: with room made, the recording goes on by itself.
///
/// Twice a second the files are compared with what was written. When one was removed, renamed,
/// replaced or cut off, the recorder writes another sweep. This has all slices that the open files or
/// the memory still have. It is in the same folder, else in the one above it, the user's home or the
/// folder for temporary files. State::Notice names it, and counts what is lost.
class SweepRecorder
{
public:
  using Pixels = std::shared_ptr<const std::vector<std::uint8_t>>;
  struct State
  {
    std::string FileName; ///< where slices are recorded now
    std::int64_t Added = 0;
    std::int64_t Written = 0;      ///< in the file
    std::int64_t Synced = 0;       ///< on the disk
    std::int64_t Verified = 0;     ///< of these: read back, and as they were added
    std::int64_t Lost = 0;         ///< were on the disk, and are in no file any more
    std::int64_t WaitingBytes = 0; ///< of pixels in memory that are not written
    double LongestDelay = 0;       ///< s from Add to the disk, of those synced
    std::int64_t FreeBytes = -1;   ///< of the disk when it was last used; below 0: not known
    std::string Trouble; ///< why nothing is written now, and what to do; empty: all is well
    std::string Notice;  ///< what happened to the file, and where the slices are
  };

  /// Begins a file, of 8-bit pixels; see SequenceRecorder for kinds, compression and errors.
  SweepRecorder(
    const std::string& fileName, const SequenceDescription& description, int compressionLevel = 0);
  /// Writes what waits, unless that fails, and closes, without a word.
  ~SweepRecorder();
  SweepRecorder(const SweepRecorder&) = delete;
  SweepRecorder& operator=(const SweepRecorder&) = delete;

  /// Takes a slice, whose pixels must not change any more. Throws std::invalid_argument when its
  /// size is not that of the description, a field cannot be written, or after Finish.
  void Add(Pixels pixels, SequenceFields fields);
  State GetState() const;
  /// Has slices read back as soon as all are on the disk, unless another one comes before.
  void Verify();
  /// Waits until all slices are on the disk and verified, and ends the file. Throws FileError when
  /// that fails: the slices still wait, and it may be called again. Throws also when slices are
  /// lost, after all else is done.
  void Finish();

private:
  struct Work;
  std::unique_ptr<Work> Job;
};
}
#endif
