// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Filters that work along x, then y, then z.
///
/// The work along an axis is done on a flat array in which neighbours along that axis are `shift`
/// elements apart: whole rows and slices are one long vector loop, whatever the axis.
#ifndef lacunaSeparable_h
#define lacunaSeparable_h

#include "lacunaBlocks.h"
#include "lacunaExecution.h"
#include "lacunaImageView.h"
#include "lacunaMemory.h"
#include "lacunaWindow.h"

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

namespace lacuna
{
/// How far a separable filter looks along each axis.
struct Reach
{
  std::array<int, 3> Lower;
  std::array<int, 3> Upper;

  explicit Reach(const Window& window)
    : Lower{ window.Lower(0), window.Lower(1), window.Lower(2) }
    , Upper{ window.Upper(0), window.Upper(1), window.Upper(2) }
  {
  }
  explicit Reach(const std::array<int, 3>& radii)
    : Lower(radii)
    , Upper(radii)
  {
  }

  bool Along(int axis) const { return this->Lower[axis] + this->Upper[axis] > 0; }
  /// The box that results in box depend on, along some axes; it ends where the integers do.
  Extent Grow(const Extent& box, bool xy, bool z) const
  {
    Extent grown = box;
    for (int a = 0; a < 3; ++a)
    {
      if (a < 2 ? xy : z)
      {
        lacuna::Grow(grown, a, this->Lower[a], this->Upper[a]);
      }
    }
    return grown;
  }
};

namespace detail
{
/// Memory of one thread.
template <class S>
struct SeparableBuffers
{
  std::vector<S> Data;
  std::vector<S> Spare;
};

/// Filters along x and y the slices of box; calls store(row of results, y, z) for box's rows.
template <class S, class T, class Op, class Load, class Store>
void FilterSlices(const ImageView<const T>& input, const Extent& box, const Reach& reach,
  const Op& op, const Load& load, SeparableBuffers<S>& buffers, const Store& store)
{
  const Extent grown = reach.Grow(box, true, false);
  const std::int64_t pitch = SizeOf(grown, 0);
  const std::int64_t slice = pitch * SizeOf(grown, 1);
  buffers.Data.resize(NumberOfSamples(grown));
  CopyReplicated(input, grown, buffers.Data.data(), load);
  for (int z = box[4]; z <= box[5]; ++z)
  {
    S* data = buffers.Data.data() + (z - box[4]) * slice;
    if (reach.Along(0))
    {
      op(0, data, slice - (reach.Lower[0] + reach.Upper[0]), 1, buffers.Spare);
    }
    if (reach.Along(1))
    {
      // The row ends hold garbage since the step along x; it stays in its columns.
      const std::int64_t count = (SizeOf(box, 1) - 1) * pitch + SizeOf(box, 0);
      op(1, data, count, pitch, buffers.Spare);
    }
    for (int y = box[2]; y <= box[3]; ++y, data += pitch)
    {
      store(data, y, z);
    }
  }
}
}

/// Filters box of input, whose samples become S by load, and passes the results to
/// store(const S* row, x0, x1, y, z), possibly from several threads at once.
///
/// op(axis, S* data, count, shift, spare) replaces data[i], i < count, by what it computes from
/// data[i], data[i + shift], ... data[i + n * shift], n being the reach; spare is memory to use.
template <class S, class T, class Op, class Load, class Store>
void FilterSeparably(const ImageView<const T>& input, const Extent& box, const Reach& reach,
  const Op& op, const Load& load, const Store& store, Execution& execution)
{
  using Buffers = detail::SeparableBuffers<S>;
  const auto forEach = [&execution](
                         const Extent& all, const std::array<int, 3>& size, const auto& work)
  {
    ForEachBlock(
      all, size, execution, [] { return std::make_unique<Buffers>(); }, work);
  };
  // Strips of rows that fit the second-level cache with what they reach.
  const std::array<int, 3> strip = { 4096 / static_cast<int>(sizeof(S)),
    std::max(64, 2 * (reach.Lower[1] + reach.Upper[1])), 1 };
  if (!reach.Along(2))
  {
    forEach(box, strip,
      [&](Buffers& buffers, const Extent& block)
      {
        detail::FilterSlices(input, block, reach, op, load, buffers,
          [&](const S* row, int y, int z) { store(row, block[0], block[1], y, z); });
      });
    return;
  }

  const Extent slices = Intersect(
    reach.Grow(box, false, true), { box[0], box[1], box[2], box[3], input.Box[4], input.Box[5] });
  RequireMemory("the image between two steps of the filter",
    static_cast<double>(sizeof(S)) * static_cast<double>(NumberOfSamples(slices)));
  std::vector<S> between(NumberOfSamples(slices));
  const ImageView<S> view(between.data(), slices);
  const Execution::NestedStages stages(execution);
  execution.SetStage(0, 0.5);
  forEach(slices, strip,
    [&](Buffers& buffers, const Extent& block)
    {
      detail::FilterSlices(input, block, reach, op, load, buffers,
        [&](const S* row, int y, int z)
        { std::copy(row, row + SizeOf(block, 0), view.At(block[0], y, z)); });
    });

  const int along = std::max(1, 2048 / static_cast<int>(sizeof(S)));
  const ImageView<const S> readable(between.data(), slices);
  execution.SetStage(0.5, 1);
  forEach(box, { along, std::max(1, along / SizeOf(box, 0)), SizeOf(box, 2) },
    [&](Buffers& buffers, const Extent& block)
    {
      const Extent grown = reach.Grow(block, false, true);
      const std::int64_t slice = std::int64_t(SizeOf(block, 0)) * SizeOf(block, 1);
      buffers.Data.resize(NumberOfSamples(grown));
      CopyReplicated(readable, grown, buffers.Data.data(), [](const S& s) { return s; });
      op(2, buffers.Data.data(), NumberOfSamples(block), slice, buffers.Spare);
      const S* row = buffers.Data.data();
      for (int z = block[4]; z <= block[5]; ++z)
      {
        for (int y = block[2]; y <= block[3]; ++y, row += SizeOf(block, 0))
        {
          store(row, block[0], block[1], y, z);
        }
      }
    });
}
}
#endif
