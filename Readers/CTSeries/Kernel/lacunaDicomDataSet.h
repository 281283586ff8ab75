// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The data elements of a DICOM file before its pixels (PS3.5 and PS3.10). Written here since a
/// damaged file stops the whole program inside of Debian's GDCM, whose assertions are on.
#ifndef lacunaDicomDataSet_h
#define lacunaDicomDataSet_h

#include "lacunaCTFrame.h"
#include "lacunaFileBytes.h"

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace lacuna
{
struct InflatedBytes;

/// Group and element as one number: 0x00280010.
using DicomTag = std::uint32_t;

/// What is kept of a file. The default is what images need.
struct DicomSelection
{
  /// Sequences whose items are kept. Files that do not say what is a sequence have one where these are.
  std::vector<DicomTag> Sequences = { 0x00189329, 0x00209111, 0x00209113, 0x00209116, 0x00289110,
    0x00289145, 0x52009229, 0x52009230 };
  /// Bytes; longer values are left out. What frames share is read for each of them.
  std::int64_t LongestValue = 1024;
};

/// Elements by tag, without private ones and what a DicomSelection leaves out.
class DicomDataSet
{
public:
  /// The bytes of a value; empty when it is absent.
  std::string GetBytes(DicomTag tag) const;
  /// The value without padding.
  std::string GetText(DicomTag tag) const;
  /// count decimal numbers of a text value; nothing when it is absent or malformed.
  std::optional<std::vector<double>> GetNumbers(DicomTag tag, std::size_t count) const;
  std::optional<double> GetNumber(DicomTag tag) const;
  /// A whole number of a text value.
  std::optional<int> GetInteger(DicomTag tag) const;
  /// A binary number of 2 or 4 bytes.
  std::optional<std::int64_t> GetBinary(DicomTag tag, bool isSigned) const;
  /// The items of a sequence; none when it is absent.
  const std::vector<DicomDataSet>& GetItems(DicomTag tag) const;
  bool IsEmpty() const { return this->Values.empty() && this->Sequences.empty(); }

private:
  friend class DicomParser;
  std::map<DicomTag, std::string> Values;
  std::map<DicomTag, std::vector<DicomDataSet>> Sequences;
  bool BigEndian = false;
};

/// A file up to its pixels.
struct DicomFile
{
  std::string TransferSyntax;
  DicomDataSet Data;
  bool BigEndian = false;
  std::int64_t PixelOffset = 0; ///< first byte of the pixel element's value; 0 when there is none
  std::int64_t PixelLength = 0; ///< -1 when the pixels are in fragments
  /// The fragments after the offset table, as far as they are whole.
  std::vector<DicomFragment> Fragments;
  std::vector<std::int64_t> FrameOffsets; ///< basic offset table, from the first fragment's item
  bool FragmentsComplete = false;
  FileState State;
  std::int64_t FileSize = 0; ///< with the data set inflated
  bool IsBare = false;       ///< neither preamble nor transfer syntax; that is as its bytes show
  /// The data set of a file that is deflated; offsets count as if it were in the file.
  std::shared_ptr<const InflatedBytes> Inflated;
};

/// The file is something else.
class NotDicomError : public std::runtime_error
{
public:
  using std::runtime_error::runtime_error;
};

/// Whether a file begins as DICOM files do (FindDicomBegin). False when it cannot be read.
bool IsDicomFile(const std::string& path);

/// Throws NotDicomError naming the file, or std::runtime_error naming it and the element when it is
/// cut off before its pixels or malformed.
DicomFile ReadDicomFile(const std::string& path, const DicomSelection& selection = {});
}
#endif
