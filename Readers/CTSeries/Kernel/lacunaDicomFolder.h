// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The DICOM images beside a file or in a folder.
#ifndef lacunaDicomFolder_h
#define lacunaDicomFolder_h

#include "lacunaCTFrame.h"
#include "lacunaExecution.h"

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace lacuna
{
/// Reads headers only, in parallel; those of files that have not changed since are remembered.
class DicomFolder
{
public:
  /// path: a file, whose folder is searched; a folder, which is searched with all folders in it; a
  /// DICOMDIR, which stands for its folder. Throws std::runtime_error naming the path when there is
  /// none, when it holds more than 200000 files or cannot be read to its end.
  void Scan(const std::string& path, Execution& execution);

  /// The images, by file name.
  const std::vector<CTFrame>& GetFrames() const { return this->Frames; }
  /// Series of the file given to Scan; empty when it is a folder. Throws std::runtime_error when
  /// the file is no DICOM file or damaged.
  std::string GetOpenedSeries() const;
  /// Files that were left out.
  const std::vector<std::string>& GetNotes() const { return this->Notes; }
  /// Files that cannot be read though they are DICOM files.
  const std::vector<std::string>& GetWarnings() const { return this->Warnings; }

private:
  struct Entry
  {
    std::int64_t Size = -1;
    std::int64_t Time = 0;
    bool IsDicom = false;
    std::string NoDicom; ///< why it is none
    std::vector<CTFrame> Frames;
    std::string Error; ///< "new": not yet read
  };

  /// The regular files, with what is known of them; deep: also in folders within.
  std::map<std::string, Entry> List(const std::string& folder, bool deep) const;
  static void ReadNew(std::map<std::string, Entry>& files, Execution& execution);
  /// Frames, notes and warnings of all files.
  void Gather();

  std::map<std::string, Entry> Files;
  std::string Opened;
  std::vector<CTFrame> Frames;
  std::vector<std::string> Notes;
  std::vector<std::string> Warnings;
};

/// Whether path is a DICOM file of modality CT, a DICOMDIR, or a folder with such a file among its
/// first ones. Cheap.
bool IsCTFileOrFolder(const std::string& path);
}
#endif
