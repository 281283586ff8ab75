// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The header of a tracked sequence: slices of one size, stored back to back, with named text
/// fields for each frame, as written by PLUS, 3D Slicer and their kin.
#ifndef lacunaSequenceHeader_h
#define lacunaSequenceHeader_h

#include "lacunaScalarType.h"
#include "lacunaSliceOrientation.h"

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace lacuna
{
enum class PixelEncoding
{
  Raw,
  Zlib, ///< one zlib or gzip stream over all frames
  Hex,  ///< two digits for each byte
  Text  ///< numbers between blanks
};

/// What the header says, checked in itself but not yet against the pixel data. Whichever format it
/// comes from, the pixels are frames back to back, x fastest.
struct SequenceHeader
{
  std::string FileName;

  std::int64_t Columns = 0;
  std::int64_t Rows = 0;
  std::int64_t Frames = 0;
  std::int64_t Channels = 1;
  /// A file of poses without pictures (DimSize 0 0 0, or 1 x 1 dummy pixels and no ImageStatus):
  /// frames count as one pixel, which is blank.
  bool PosesOnly = false;
  ScalarType Type = ScalarType::UInt8;
  /// MET_LONG and MET_ULONG: four bytes by MetaImage's definition, eight when written by programs
  /// that took the machine's long. Type holds the four-byte type until the data size decides.
  bool TypeIsLong = false;
  bool BigEndian = false;
  PixelEncoding Encoding = PixelEncoding::Raw;
  bool IsVolume = false; ///< the frames are the slices of one volume; see ReadVolumeHeader
  SliceFlips Flips;
  std::string ImageType = "BRIGHTNESS"; ///< of the file, without the prefix US_IMG_
  /// mm of a column and a row as the header gives them, for all frames; empty when it does not.
  std::string PixelSpacing;

  std::string DataFileName;            ///< the file itself when the pixels follow the header
  std::int64_t DataOffset = 0;         ///< first byte of the pixels as they are encoded
  std::int64_t SkippedLines = 0;       ///< lines to be skipped there
  std::int64_t SkippedBytes = 0;       ///< decoded bytes before the pixels; -1: they end the file
  std::int64_t CompressedDataSize = 0; ///< bytes; 0 when the header does not say

  /// Fields that the format does not define, in the file's order.
  std::vector<std::pair<std::string, std::string>> CustomFields;
  /// For each field that frames have, its text in every frame; empty where a frame lacks it. The
  /// state of a frame's image is ImageStatus, also in NRRD files, where it is called Status.
  std::map<std::string, std::vector<std::string>> FrameFields;
  /// What was odd but could be read, one sentence each.
  std::vector<std::string> Warnings;

  /// Bytes of one frame as it is stored uncompressed.
  std::int64_t GetFrameSize() const
  {
    return this->Columns * this->Rows * this->Channels *
      static_cast<std::int64_t>(GetScalarSize(this->Type));
  }
};

/// Reads the header of a MetaImage (.mha, .mhd) or NRRD (.nrrd, .nhdr) sequence; the content tells
/// which, not the name. Throws std::runtime_error that names the file, the line or field, what is
/// wrong with it and what would be right. Frame fields are kept as text; a bad one spoils its
/// frame, not the file. The header of a recording that is cut off (see lacunaSequenceRecorder.h)
/// is read up to its last whole frame.
SequenceHeader ReadSequenceHeader(const std::string& fileName);

/// The header of an image that is one volume.
struct VolumeHeader
{
  /// How the voxels are stored: Frames counts the slices along the third axis. It has no frame
  /// fields and no flips.
  SequenceHeader Slices;
  bool IsNrrd = false;
  /// The fields of the format, which say where the volume lies: MetaImage's by their names, NRRD's
  /// in lower case. NRRD's key/value pairs are not among them.
  std::map<std::string, std::string> Fields;
  std::size_t Axes = 3;      ///< that the file lists
  std::size_t FirstAxis = 0; ///< the columns: 1 where the first one is the voxels' components
};

/// Reads the header of a MetaImage or NRRD file with one volume. Throws std::runtime_error as
/// ReadSequenceHeader does, also for several volumes in one file.
VolumeHeader ReadVolumeHeader(const std::string& fileName);

enum class ImageFileKind
{
  Other,
  Sequence, ///< slices with fields for each
  Volume    ///< three axes or more; also several volumes
};

/// What a MetaImage or NRRD file has, as far as its lines say. A reconstructed volume is one, though
/// it has frame fields too. Reads no further than it must, and does not throw.
ImageFileKind GetImageFileKind(const std::string& fileName);

/// Whether that is a sequence.
bool IsTrackedSequence(const std::string& fileName);
}
#endif
