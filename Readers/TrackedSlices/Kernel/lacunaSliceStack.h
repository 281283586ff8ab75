// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Reads the slices of a sequence into one block of grey levels.
#ifndef lacunaSliceStack_h
#define lacunaSliceStack_h

#include "lacunaExecution.h"
#include "lacunaPixelSource.h"
#include "lacunaSequenceHeader.h"

#include <cstdint>

namespace lacuna
{
/// Which pixels: columns and rows are those of the standard orientation (see
/// lacunaSliceOrientation.h), slices are FirstFrame, FirstFrame + FrameStride, ...
struct SliceRegion
{
  std::int64_t FirstColumn = 0;
  std::int64_t Columns = 0;
  std::int64_t FirstRow = 0;
  std::int64_t Rows = 0;
  std::int64_t FirstFrame = 0;
  std::int64_t FrameStride = 1;
  std::int64_t Frames = 0;
};

/// Fills pixels, Columns x Rows x Frames numbers of source's element type, x fastest, with the grey
/// levels of region: in the standard orientation, colours (3 or 4 channels; the fourth is ignored)
/// turned into luminance 0.299 R + 0.587 G + 0.114 B (Rec. 601), rounded for integer types. Frames
/// that are cut off become zero. Throws std::out_of_range when region is not inside the sequence,
/// std::runtime_error when the data are corrupt, Aborted when execution is stopped.
void ReadSliceStack(const SequenceHeader& header, PixelSource& source, const SliceRegion& region,
  void* pixels, Execution& execution);
}
#endif
