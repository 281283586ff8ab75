// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What is known of one CT image before its pixels are read.
#ifndef lacunaCTFrame_h
#define lacunaCTFrame_h

#include "lacunaFileBytes.h"
#include "lacunaVector.h"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace lacuna
{
/// How a pixel is stored (DICOM group 0028).
struct CTPixelFormat
{
  int BitsAllocated = 0; ///< 8, 16 or 32
  int BitsStored = 0;    ///< how many of them count
  int HighBit = 0;       ///< the highest of those
  bool Signed = false;   ///< two's complement
};

/// Who the patient is. Stays in memory unless the user asks for it.
struct CTPatient
{
  std::string Name;
  std::string Id;
  std::string BirthDate;
  std::string Sex;
};

/// Bytes of a file.
struct DicomFragment
{
  std::int64_t Offset = 0;
  std::int64_t Length = 0;
};

/// What all images of a file have in common. Texts are UTF-8.
struct CTFileHeader
{
  std::string File; ///< its path
  FileState State;  ///< when this was read
  std::string SopClassUid;
  std::string SopInstanceUid;
  std::string Modality;
  std::string StudyUid;
  std::string StudyDate;
  std::string SeriesUid;
  std::string SeriesNumber;
  std::string SeriesDescription;
  std::string FrameOfReferenceUid;
  std::string PatientPosition; ///< HFS, FFS, HFP, ...
  /// (0020,0020): where rows and columns lead, in letters of LRAPHF, the main one first; empty where
  /// it is not said, or of an animal.
  std::vector<std::string> PatientOrientation;
  std::string ConvolutionKernel;
  std::string TransferSyntax; ///< its UID
  CTPatient Patient;
  std::int64_t Columns = 0;
  std::int64_t Rows = 0;
  int SamplesPerPixel = 1;
  int Frames = 1;
  CTPixelFormat Format;
  std::optional<std::int64_t> Padding;      ///< (0028,0120): stored value outside of the image
  std::optional<std::int64_t> PaddingLimit; ///< (0028,0121): the other end of its range
  std::optional<double> GantryTilt;         ///< (0018,1120), degrees
  bool Compressed = false;                  ///< the fragments are a stream to decode
  bool BigEndian = false;
  bool IsBare = false;           ///< a data set without preamble and transfer syntax
  std::int64_t DeflatedFrom = 0; ///< where the file is a deflate stream; 0: nowhere
  std::shared_ptr<const InflatedBytes> Inflated;  ///< that of a deflated file with several frames
  std::vector<std::vector<DicomFragment>> Pixels; ///< the pieces of each frame in the file
  std::string PixelError; ///< what is wrong with the pixels ("is cut off ..."); empty if nothing
};

/// One image: a file, or a frame of a multi-frame file.
struct CTFrame
{
  std::shared_ptr<const CTFileHeader> Header;
  int Number = 0;                               ///< of the frame in its file, from 0
  std::vector<std::string> ImageType;           ///< (0008,0008) or (0008,9007)
  std::optional<Vec3> Position;                 ///< of the first pixel's centre, LPS, mm
  std::optional<std::array<double, 6>> Axes;    ///< directions of rows and columns, LPS
  std::optional<std::array<double, 2>> Spacing; ///< mm from row to row, from column to column
  std::optional<double> Thickness;              ///< of the slice, mm
  std::optional<double> RescaleSlope;           ///< Hounsfield units per stored unit
  std::optional<double> RescaleIntercept;       ///< Hounsfield units of the stored value 0
  std::string RescaleType;                      ///< HU, or empty
  std::optional<int> Acquisition;               ///< (0020,0012) or (0020,9156)
  std::optional<int> Instance;                  ///< (0020,0013) or the number of the frame

  /// The file's name without its folder, with the number of the frame where there are several.
  std::string GetName() const;
  /// The same with the folder in front when the other file, in another folder, has the same name.
  std::string GetNameBeside(const CTFrame& other) const;
  /// Bytes of its pixels once decoded.
  std::int64_t GetSize() const
  {
    return this->Header->Columns * this->Header->Rows * (this->Header->Format.BitsAllocated / 8);
  }
};
}
#endif
