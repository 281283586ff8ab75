// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSliceStack.h"

#include "lacunaLuminance.h"
#include "lacunaSliceOrientation.h"

#include <cstring>
#include <stdexcept>
#include <vector>

namespace lacuna
{
namespace
{
bool IsInside(std::int64_t first, std::int64_t count, std::int64_t stride, std::int64_t size)
{
  return first >= 0 && stride > 0 && count > 0 && first < size &&
    (count - 1) <= (size - 1 - first) / stride;
}
}

void ReadSliceStack(const SequenceHeader& header, PixelSource& source, const SliceRegion& region,
  void* pixels, Execution& execution)
{
  if (!IsInside(region.FirstColumn, region.Columns, 1, header.Columns) ||
    !IsInside(region.FirstRow, region.Rows, 1, header.Rows) ||
    !IsInside(region.FirstFrame, region.Frames, region.FrameStride, header.Frames))
  {
    throw std::out_of_range("the requested columns, rows and slices are not all in the sequence");
  }
  const std::size_t elementSize = GetScalarSize(source.GetScalarType());
  const std::size_t rowSize = static_cast<std::size_t>(region.Columns) * elementSize;
  const std::size_t sliceSize = static_cast<std::size_t>(region.Rows) * rowSize;
  const std::size_t storedRowSize = static_cast<std::size_t>(header.Columns) * elementSize;
  const bool direct = header.Channels == 1 && region.Columns == header.Columns &&
    region.Rows == header.Rows; // no need of a detour
  std::vector<unsigned char> frame(direct ? 0 : static_cast<std::size_t>(source.GetFrameSize()));
  const std::int64_t reportEvery = region.Frames / 100 + 1;
  auto* output = static_cast<unsigned char*>(pixels);
  for (std::int64_t i = 0; i < region.Frames; ++i, output += sliceSize)
  {
    if (i % reportEvery == 0)
    {
      execution.Report(static_cast<double>(i) / static_cast<double>(region.Frames));
    }
    const std::int64_t number = region.FirstFrame + i * region.FrameStride;
    if (number >= source.GetNumberOfWholeFrames())
    {
      std::memset(output, 0, sliceSize);
      continue;
    }
    unsigned char* stored = direct ? output : frame.data();
    source.ReadFrame(number, stored);
    if (header.Channels > 1)
    {
      DispatchScalarType(source.GetScalarType(),
        [&](auto value)
        {
          auto* colours = reinterpret_cast<decltype(value)*>(stored);
          MakeLuminance(colours, header.Columns * header.Rows, header.Channels, colours);
        });
    }
    FlipSlice(stored, header.Columns, header.Rows, elementSize, header.Flips);
    for (std::int64_t row = 0; !direct && row < region.Rows; ++row)
    {
      std::memcpy(output + static_cast<std::size_t>(row) * rowSize,
        stored + static_cast<std::size_t>(region.FirstRow + row) * storedRowSize +
          static_cast<std::size_t>(region.FirstColumn) * elementSize,
        rowSize);
    }
  }
  execution.Report(1);
}
}
