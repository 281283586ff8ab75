// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The text of the headers of tracked sequences, as PLUS, 3D Slicer and ReadSequenceHeader read
/// them.
///
/// The number of frames is padded to 40 columns, so that it can be written over in place when
/// frames are added. Fields of a frame are sorted by name, ImageStatus comes last.
#ifndef lacunaSequenceFormat_h
#define lacunaSequenceFormat_h

#include "lacunaScalarType.h"

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace lacuna
{
/// Fields of the header by which slices that are a part of the scanner's picture say where it begins
/// there, in whole columns and rows; see GetPictureOrigin.
constexpr const char* FirstColumnField = "FirstColumn";
constexpr const char* FirstRowField = "FirstRow";

/// PLUS crops pictures and leaves a transform between these frames with each: the pixels are in the
/// second one.
constexpr const char* WholeImageFrame = "Image";
constexpr const char* CroppedImageFrame = "CroppedImage";

/// Names and texts.
using SequenceFields = std::vector<std::pair<std::string, std::string>>;

/// What is written, but for the frames.
struct SequenceDescription
{
  std::int64_t Columns = 0;
  std::int64_t Rows = 0;
  ScalarType Type = ScalarType::UInt8;
  std::string ImageType = "BRIGHTNESS"; ///< or RF_REAL ...
  bool ScanLines = false;               ///< rows are scan lines, see lacunaSliceOrientation.h
  SequenceFields CustomFields;
};

/// How it is written, by the extension of the file's name.
class SequenceKind
{
public:
  /// .mha, .mhd, .nrrd or .nhdr in any case. compressed: one zlib (MetaImage) or gzip stream.
  /// Throws std::invalid_argument for another extension, or a name that a header cannot hold.
  SequenceKind(const std::string& fileName, bool compressed);

  bool IsNrrd() const { return this->Nrrd; }
  bool IsCompressed() const { return this->Compressed; }
  /// Whether the pixels are in a file of their own.
  bool IsDetached() const { return !this->DataFileName.empty(); }
  /// That file, with the folder of the header: sweep.raw, .zraw (MetaImage) or .raw.gz (NRRD).
  const std::string& GetDataFileName() const { return this->DataFileName; }

  /// What is wrong with a field of the header or, when ofFrame is set, of a frame: its name or its
  /// text cannot be stored, or its name has a meaning of its own. Empty when nothing is.
  std::string GetProblem(const std::string& name, const std::string& text, bool ofFrame) const;

  /// The header up to the first frame, for no frames. Throws std::invalid_argument when a custom
  /// field has a problem or the description makes no sense.
  std::string GetBeginning(const SequenceDescription& description) const;
  /// The part of it, of the same length and at the same place, that changes with frames.
  std::string GetCounts(
    const SequenceDescription& description, std::int64_t frames, std::int64_t compressedSize) const;
  /// The lines of a frame. A field without text is left out. Throws std::invalid_argument when a
  /// field has a problem.
  std::string GetFrame(std::int64_t frame, const SequenceFields& fields) const;
  /// What follows the last frame.
  std::string GetEnd() const;

private:
  std::string GetLine(const std::string& name, const std::string& text, bool custom) const;
  std::string GetMetaImageBeginning(const SequenceDescription& description) const;
  std::string GetNrrdBeginning(const SequenceDescription& description) const;

  bool Nrrd = false;
  bool Compressed;
  std::string DataFileName;
};

/// "sweep.mhd", or "sweep-2.mhd", "sweep-3.mhd" ... when there is one already: the first name for
/// which neither the header nor the pixels exist.
std::string FindFreeSweepName(const std::string& fileName, int compressionLevel);
}
#endif
