// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The voxels of a part of a grid while samples are collected in them.
#ifndef lacunaVoxelBlock_h
#define lacunaVoxelBlock_h

#include "lacunaMemory.h"

#include <array>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <new>

namespace lacuna
{
/// What several samples of one voxel become.
enum class Compounding
{
  Mean,
  Maximum
};
inline constexpr std::array<const char*, 2> CompoundingNames{ "Mean", "Maximum" };

/// One voxel. Value and count lie side by side: a sample touches one cache line.
template <class Real>
struct Voxel
{
  Real Value; ///< the sum of the samples, or their maximum
  std::uint32_t Count;

  template <Compounding compounding>
  void Put(Real sample)
  {
    if (compounding == Compounding::Mean)
    {
      this->Value += sample;
    }
    else
    {
      // a sample that is not finite makes the sum, and so the voxel, not finite in any order
      this->Value = this->Count == 0 || sample > this->Value ? sample : this->Value + 0 * sample;
    }
    ++this->Count;
  }
};

/// One voxel whose samples have weights: it becomes their weighted mean. Only those samples count
/// that could make the voxel on their own; without any it stays empty.
template <class Real>
struct WeightedVoxel
{
  Real Value; ///< the sum of the samples times their weights
  float Weight;
  std::uint32_t Count;

  void Put(Real sample, float weight, bool counts)
  {
    this->Value += weight * sample;
    this->Weight += weight;
    this->Count += counts ? 1 : 0;
  }
};

/// The voxels Extent[0]..Extent[1], ... of a grid, x fastest, all empty at first.
template <class VoxelType>
class VoxelBlock
{
public:
  VoxelBlock() = default;
  explicit VoxelBlock(const std::array<int, 6>& extent)
    : Extent(extent)
  {
    // zeroed when first touched, by the thread that fills it
    this->Data.reset(static_cast<VoxelType*>(
      std::calloc(static_cast<std::size_t>(this->GetNumberOfVoxels()), sizeof(VoxelType))));
    if (!this->Data)
    {
      throw std::bad_alloc();
    }
    PreferLargePages(this->Data.get(), this->GetNumberOfVoxels() * sizeof(VoxelType));
  }

  const std::array<int, 6>& GetExtent() const { return this->Extent; }
  std::int64_t GetSize(int axis) const
  {
    return this->Extent[2 * axis + 1] - this->Extent[2 * axis] + 1;
  }
  std::int64_t GetNumberOfVoxels() const
  {
    return this->GetSize(0) * this->GetSize(1) * this->GetSize(2);
  }
  VoxelType* GetData() { return this->Data.get(); }
  const VoxelType* GetData() const { return this->Data.get(); }

private:
  struct Free
  {
    void operator()(void* p) const { std::free(p); }
  };
  std::array<int, 6> Extent{ 0, -1, 0, -1, 0, -1 };
  std::unique_ptr<VoxelType[], Free> Data;
};
}
#endif
