// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// How the pixels of a slice lie in the file, and bringing them into the one orientation to which
/// transforms refer.
///
/// The letters say where the axes of the stored image point: M marked or U unmarked side of the
/// probe, F far from or N near to it (A ascending, D descending for the third axis, which a slice
/// does not have). Pictures are brought to MF: x towards the marked side, y away from the probe.
/// Scan lines (radio-frequency data, and grey levels before scan conversion) are stored line by line
/// and brought to FM. Flipping moves the content, not the corners: the transforms of the file refer
/// to the flipped pixels.
#ifndef lacunaSliceOrientation_h
#define lacunaSliceOrientation_h

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace lacuna
{
struct SliceFlips
{
  bool X = false; ///< columns are reversed
  bool Y = false; ///< rows are reversed
  /// Rows are scan lines, from the probe outwards: FM instead of MF.
  bool Lines = false;
};

/// The image type without blanks around it and without the prefix US_IMG_.
std::string GetImageTypeName(std::string_view imageType);

/// Whether a file says how its slices lie. PLUS writes XX, 3D Slicer ?? when it is not known.
bool IsKnownOrientation(std::string_view orientation);

/// The flips that bring slices stored in orientation ("MF", "UNA", "US_IMG_ORIENT_MFA" ...) to the
/// standard one. imageType is the value of UltrasoundImageType; empty and XX mean BRIGHTNESS. Throws
/// std::invalid_argument that says what would be right when the two do not go together, when the
/// axis across the slice comes first (AMF), or when interleaved complex data would have to be
/// flipped.
SliceFlips GetSliceFlips(std::string_view orientation, std::string_view imageType);

/// Applies flips in place to columns x rows pixels of pixelSize bytes.
void FlipSlice(void* pixels, std::int64_t columns, std::int64_t rows, std::size_t pixelSize,
  const SliceFlips& flips);
}
#endif
