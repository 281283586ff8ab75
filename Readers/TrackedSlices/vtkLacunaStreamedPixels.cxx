// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaStreamedPixels.h"

#include "vtkLacunaSliceStream.h"

#include <algorithm>

//------------------------------------------------------------------------------
vtkLacunaStreamedPixels::vtkLacunaStreamedPixels(
  vtkLacunaSliceStream* stream, lacuna::Execution& execution)
  : Stream(stream)
  , Execution(&execution)
  , Loaded(std::make_shared<Part>())
{
}

//------------------------------------------------------------------------------
const void* vtkLacunaStreamedPixels::operator()(std::int64_t slice) const
{
  Part& part = *this->Loaded;
  const auto sliceSize = static_cast<std::size_t>(this->Stream->GetSliceSize());
  if (slice < part.First || slice >= part.First + part.Count)
  {
    const int* extent = this->Stream->GetExtent();
    const std::int64_t all = extent[5] - extent[4] + 1;
    part.First = slice;
    part.Count = std::min<std::int64_t>(this->Stream->GetSlicesAtATime(), all - slice);
    part.Pixels.resize(static_cast<std::size_t>(part.Count) * sliceSize);
    // reading does not move the progress of writing
    const double progress = static_cast<double>(slice) / static_cast<double>(all);
    this->Execution->SetStage(progress, progress);
    const int first = extent[4] + static_cast<int>(slice);
    this->Stream->Read(
      first, first + static_cast<int>(part.Count) - 1, part.Pixels.data(), *this->Execution);
    this->Execution->SetStage(0, 1);
  }
  return part.Pixels.data() + static_cast<std::size_t>(slice - part.First) * sliceSize;
}
