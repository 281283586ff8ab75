// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Fields of interlaced video.
#ifndef lacunaVideoFields_h
#define lacunaVideoFields_h

#include <array>
#include <cstdint>

namespace lacuna
{
/// What is used of a frame. The two fields of interlaced video are 20 ms (or 1/60 s) apart, and a
/// slice has one pose: of a moving picture only one field belongs to it.
enum class VideoField
{
  Both,  ///< the frame as it is
  Top,   ///< lines 0 2 4 ...; the others are the mean of their neighbours
  Bottom ///< lines 1 3 5 ...
};
inline constexpr std::array<const char*, 3> VideoFieldNames{ "Both", "Top", "Bottom" };

/// Replaces the lines of the other field in an image of columns x rows, the top line first.
void KeepField(VideoField field, std::int64_t columns, std::int64_t rows, std::uint8_t* grey);
}
#endif
