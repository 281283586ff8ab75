// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What a picture says of the size of its pixels, beside what the calibration says.
#ifndef lacunaPixelSpacing_h
#define lacunaPixelSpacing_h

#include "lacunaMatrix4.h"

#include <string>
#include <string_view>

namespace lacuna
{
/// The field of a frame that has it, as PLUS and Lacuna write it.
constexpr const char* PixelSpacingField = "ElementSpacing";

/// mm of a column and a row: the first two numbers of text ("0.2 0.2 1"); NaN where it has none.
Vec2 ReadPixelSpacing(std::string_view text);

/// Whether spacing says anything. Programs write 1 1 for pictures whose scale they do not know: so
/// do nearly all sequences of PLUS's test data, whatever their calibration.
bool SaysPixelSpacing(const Vec2& spacing);

/// Whether both are finite and above 0.
bool IsPixelSpacing(const Vec2& spacing);

/// mm of a column and a row of an image that pixelToMm places.
Vec2 GetPixelSpacing(const Matrix4& pixelToMm);

/// Whether they agree within 2 %: Probe Calibration finds scales to some 0.5 %, and a scanner's next
/// depth differs by far more.
bool IsSameSpacing(const Vec2& said, const Vec2& known);

/// "0.2 x 0.25 mm"
std::string FormatPixelSpacing(const Vec2& spacing);
}
#endif
