// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaGrowingVolume.h"

#include <algorithm>
#include <atomic>
#include <tuple>
#include <utility>

namespace lacuna
{
namespace
{
bool AreEqual(const VolumeGrid& a, const VolumeGrid& b)
{
  return a.Origin == b.Origin && a.Spacing == b.Spacing && a.Dimensions == b.Dimensions;
}

// Names every member: one that is added to the options does not compile before it is compared.
auto Tie(const SweptVolume::Options& options)
{
  const auto& [interpolation, sampling, compound, footprintScale, footprintAcrossSlices, gap,
    doublePrecision] = options;
  return std::make_tuple(
    interpolation, sampling, compound, footprintScale, footprintAcrossSlices, gap, doublePrecision);
}

std::vector<const SliceImage*> Flatten(const GrowingVolume::Sweeps& sweeps)
{
  std::vector<const SliceImage*> slices;
  for (const std::vector<SliceImage>* sweep : sweeps)
  {
    for (const SliceImage& slice : *sweep)
    {
      slices.push_back(&slice);
    }
  }
  return slices;
}
}

std::vector<GrowingVolume::Record> GrowingVolume::MakeRecords(const Sweeps& sweeps)
{
  std::vector<Record> records;
  for (std::size_t s = 0; s < sweeps.size(); ++s)
  {
    for (const SliceImage& slice : *sweeps[s])
    {
      records.push_back({ s, SliceFingerprint(slice, false) });
    }
  }
  return records;
}

bool GrowingVolume::HasPixelsOf(
  const std::vector<const SliceImage*>& slices, Execution& execution) const
{
  std::atomic<bool> same{ true };
  execution.For(static_cast<std::int64_t>(this->Records.size()), 1,
    [&](std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t n = begin; n < end && same; ++n)
      {
        const auto i = static_cast<std::size_t>(n);
        if (!(HashPixels(*slices[i]) == this->Records[i].Slice.Pixels))
        {
          same = false;
        }
      }
    });
  return same;
}

const SweptVolume& GrowingVolume::Update(const Sweeps& sweeps, const VolumeGrid& grid,
  const std::array<int, 6>& extent, const SweptVolume::Options& options, bool isGrowing,
  Execution& execution, double first, double last)
{
  std::vector<Record> records = MakeRecords(sweeps);
  const std::vector<const SliceImage*> slices = Flatten(sweeps);
  const double middle = first + 0.05 * (last - first);
  const std::size_t before = this->Records.size();
  const bool isContinued = before > 0 && before <= records.size() &&
    std::equal(this->Records.begin(), this->Records.end(), records.begin(),
      [](const Record& a, const Record& b)
      { return a.Sweep == b.Sweep && a.Slice.HasGeometryOf(b.Slice); });
  // grown for the first time, grown again, or made of the same slices in another way
  const bool isKept = isGrowing || (isContinued && (before < records.size() || this->IsKept));
  const bool isReused = this->Volume && this->IsKept && isContinued && AreEqual(grid, this->Grid) &&
    extent == this->Extent && Tie(options) == Tie(this->Options);
  try
  {
    execution.SetStage(first, middle);
    std::size_t done = 0;
    if (isReused && this->HasPixelsOf(slices, execution))
    {
      done = before;
      std::copy(this->Records.begin(), this->Records.end(), records.begin());
    }
    else
    {
      this->Volume.reset(); // not two at a time
      this->Volume = std::make_unique<SweptVolume>(grid, extent, options);
    }
    this->Added = static_cast<std::int64_t>(records.size() - done);

    std::size_t begin = 0; // of the sweep
    const auto total = static_cast<double>(std::max<std::size_t>(1, records.size() - done));
    for (std::size_t s = 0; s < sweeps.size(); ++s)
    {
      const std::size_t end = begin + sweeps[s]->size();
      const std::size_t next = std::max(begin, done);
      if (next < end)
      {
        if (next == begin)
        {
          this->Volume->BeginSweep();
        }
        const std::vector<SliceImage> added(
          sweeps[s]->begin() + static_cast<std::ptrdiff_t>(next - begin), sweeps[s]->end());
        this->Volume->AddSlices(added, execution,
          middle + (last - middle) * static_cast<double>(next - done) / total,
          middle + (last - middle) * static_cast<double>(end - done) / total);
      }
      begin = end;
    }
    if (isKept && done < records.size())
    {
      execution.SetStage(last, last);
      execution.For(static_cast<std::int64_t>(records.size() - done), 1,
        [&](std::int64_t from, std::int64_t to)
        {
          for (std::int64_t n = from; n < to; ++n)
          {
            const std::size_t i = done + static_cast<std::size_t>(n);
            records[i].Slice.Pixels = HashPixels(*slices[i]);
          }
        });
    }
  }
  catch (...)
  {
    this->Volume.reset();
    this->Records.clear();
    this->IsKept = false;
    throw;
  }
  this->Records = std::move(records);
  this->IsKept = isKept;
  this->Grid = grid;
  this->Extent = extent;
  this->Options = options;
  return *this->Volume;
}

double GrowingVolume::GetBytes() const
{
  double bytes =
    this->Volume ? static_cast<double>(SweptVolume::GetBytesPerVoxel(this->Options)) : 0;
  for (std::size_t a = 0; a < 3; ++a)
  {
    bytes *= std::max(0.0, 1.0 + this->Extent[2 * a + 1] - this->Extent[2 * a]);
  }
  return bytes;
}

//------------------------------------------------------------------------------
void GrowingVolume::Finish()
{
  if (!this->IsKept)
  {
    this->Volume.reset();
  }
}
}
