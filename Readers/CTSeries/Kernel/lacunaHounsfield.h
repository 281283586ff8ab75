// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Stored pixel values become Hounsfield units (DICOM PS3.3, C.7.6.3 and C.11.1).
#ifndef lacunaHounsfield_h
#define lacunaHounsfield_h

#include "lacunaCTFrame.h"
#include "lacunaScalarType.h"

#include <cstdint>
#include <utility>

namespace lacuna
{
/// Turns the pixels of one frame into Hounsfield units: slope * stored + intercept. The photometric
/// interpretation plays no part: MONOCHROME1 says how to show values, not what they are.
class HounsfieldScale
{
public:
  /// format, rescale and padding of frame; padded pixels become air. Throws std::runtime_error
  /// naming file and tag when the format is none (bits that do not fit) or the rescale is missing.
  HounsfieldScale(const CTFrame& frame, double air);
  /// The same with the format that the pixels have once decoded.
  HounsfieldScale(const CTFrame& frame, const CTPixelFormat& format, double air);

  /// Lowest and highest value that the bits can mean.
  std::pair<double, double> GetRange() const;
  /// Whether all values are whole numbers.
  bool IsIntegral() const;
  std::int64_t GetBytesPerPixel() const { return this->Format.BitsAllocated / 8; }

  /// Writes count values; pixels hold count numbers of BitsAllocated bits in the machine's byte
  /// order. They may be where the values go, when both take as many bytes. T is a type of GetHounsfieldType or float. Throws std::runtime_error naming the file when
  /// a value does not fit: then its decoded pixels have more bits than its header said.
  template <class T>
  void Convert(const unsigned char* pixels, std::int64_t count, T* values) const;

private:
  template <class Stored, class T>
  void ConvertStored(const unsigned char* pixels, std::int64_t count, T* values) const;
  template <class Stored, class T>
  void ConvertWhole(const unsigned char* pixels, std::int64_t count, T* values) const;

  std::string Name; // of the frame
  CTPixelFormat Format;
  double Slope;
  double Intercept;
  double Air;
  bool HasPadding = false;
  std::int64_t PaddingFirst = 0;
  std::int64_t PaddingLast = 0;
};

/// Throws std::runtime_error naming the file when a Rescale Type (0028,1054) says that values are no
/// Hounsfield units (optical density, atomic numbers, percent). Returns a warning when it leaves that
/// open (US, HU_MOD), else an empty text: for HU, and where there is none.
std::string CheckRescaleType(const std::vector<CTFrame>& frames);

/// The smallest of Int16, Int32, Float32 that holds all values of the frames exactly (as far as
/// their headers tell), so that the type of a volume is known before its pixels. Throws
/// std::runtime_error when a value or air is beyond what a float holds.
ScalarType GetHounsfieldType(const std::vector<CTFrame>& frames, double air);
}
#endif
