// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSeparable.h"

#include "lacunaBlocks.h"
#include "lacunaMemory.h"

#include <algorithm>
#include <memory>

namespace lacuna
{
namespace
{
/// Memory of one thread.
template <class S>
struct Buffers
{
  std::vector<S> Data;
  std::vector<S> Spare;
};

/// Filters along x and y the slices of box; calls store(row of results, y, z) for box's rows.
template <class S, class Store>
void FilterSlices(const Extent& box, const Reach& reach, const SeparableSteps<S>& steps,
  Buffers<S>& buffers, const Store& store)
{
  const Extent grown = reach.Grow(box, true, false);
  const std::int64_t pitch = SizeOf(grown, 0);
  const std::int64_t slice = pitch * SizeOf(grown, 1);
  buffers.Data.resize(NumberOfSamples(grown));
  steps.Load(grown, buffers.Data.data());
  for (int z = box[4]; z <= box[5]; ++z)
  {
    S* data = buffers.Data.data() + (z - box[4]) * slice;
    if (reach.Along(0))
    {
      steps.Along(0, data, slice - (reach.Lower[0] + reach.Upper[0]), 1, buffers.Spare);
    }
    if (reach.Along(1))
    {
      // The row ends hold garbage since the step along x; it stays in its columns.
      const std::int64_t count = (SizeOf(box, 1) - 1) * pitch + SizeOf(box, 0);
      steps.Along(1, data, count, pitch, buffers.Spare);
    }
    for (int y = box[2]; y <= box[3]; ++y, data += pitch)
    {
      store(data, y, z);
    }
  }
}
}

template <class S>
void FilterSeparably(const Extent& inputBox, const Extent& box, const Reach& reach,
  const SeparableSteps<S>& steps, Execution& execution)
{
  const auto forEach = [&execution](
                         const Extent& all, const std::array<int, 3>& size, const auto& work)
  {
    ForEachBlock(
      all, size, execution, [] { return std::make_unique<Buffers<S>>(); }, work);
  };
  // Strips of rows that fit the second-level cache with what they reach.
  const std::array<int, 3> strip = { 4096 / static_cast<int>(sizeof(S)),
    std::max(64, 2 * (reach.Lower[1] + reach.Upper[1])), 1 };
  if (!reach.Along(2))
  {
    forEach(box, strip,
      [&](Buffers<S>& buffers, const Extent& block)
      {
        FilterSlices(block, reach, steps, buffers,
          [&](const S* row, int y, int z) { steps.Store(row, block[0], block[1], y, z); });
      });
    return;
  }

  const Extent slices = Intersect(
    reach.Grow(box, false, true), { box[0], box[1], box[2], box[3], inputBox[4], inputBox[5] });
  RequireMemory("the image between two steps of the filter",
    static_cast<double>(sizeof(S)) * static_cast<double>(NumberOfSamples(slices)));
  std::vector<S> between(NumberOfSamples(slices));
  const ImageView<S> view(between.data(), slices);
  const Execution::NestedStages stages(execution);
  execution.SetStage(0, 0.5);
  forEach(slices, strip,
    [&](Buffers<S>& buffers, const Extent& block)
    {
      FilterSlices(block, reach, steps, buffers,
        [&](const S* row, int y, int z)
        { std::copy(row, row + SizeOf(block, 0), view.At(block[0], y, z)); });
    });

  const int along = std::max(1, 2048 / static_cast<int>(sizeof(S)));
  const ImageView<const S> readable(between.data(), slices);
  execution.SetStage(0.5, 1);
  forEach(box, { along, std::max(1, along / SizeOf(box, 0)), SizeOf(box, 2) },
    [&](Buffers<S>& buffers, const Extent& block)
    {
      const Extent grown = reach.Grow(block, false, true);
      const std::int64_t slice = std::int64_t(SizeOf(block, 0)) * SizeOf(block, 1);
      buffers.Data.resize(NumberOfSamples(grown));
      CopyReplicated(readable, grown, buffers.Data.data(), [](const S& s) { return s; });
      steps.Along(2, buffers.Data.data(), NumberOfSamples(block), slice, buffers.Spare);
      const S* row = buffers.Data.data();
      for (int z = block[4]; z <= block[5]; ++z)
      {
        for (int y = block[2]; y <= block[3]; ++y, row += SizeOf(block, 0))
        {
          steps.Store(row, block[0], block[1], y, z);
        }
      }
    });
}

// NOLINTBEGIN(bugprone-macro-parentheses): S is a type
#define LACUNA_INSTANTIATE(S)                                                                      \
  template void FilterSeparably(                                                                   \
    const Extent&, const Extent&, const Reach&, const SeparableSteps<S>&, Execution&);
// NOLINTEND(bugprone-macro-parentheses)
LACUNA_INSTANTIATE(std::uint8_t)
LACUNA_INSTANTIATE(std::uint16_t)
LACUNA_INSTANTIATE(std::uint32_t)
LACUNA_INSTANTIATE(std::uint64_t)
LACUNA_INSTANTIATE(float)
LACUNA_INSTANTIATE(double)
__extension__ using Wide = unsigned __int128;
LACUNA_INSTANTIATE(Wide)
}
