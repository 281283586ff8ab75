// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaIsoField.h"

#include "lacunaFieldWalker.h"
#include "lacunaSplineFilter.h"
#include "lacunaVoxelBlocks.h"

#include <algorithm>
#include <mutex>
#include <type_traits>
#include <utility>
#include <vector>

namespace lacuna
{
namespace
{
template <class T, int Support>
class TypedFollower final : public RayFollower
{
public:
  TypedFollower(const SolidVoxels<T>& solid, double isoValue)
    : Field(solid, isoValue)
    , Blocks(this->Field)
  {
  }

  bool FindEntry(const Ray& ray, const RaySpan& span, RayEntry& entry) override
  {
    return FieldWalker<Support>(this->Blocks, ray).FindEntry(span, entry);
  }

  bool FindExit(const Ray& ray, double t0, const RaySpan& span, double& t) override
  {
    return FieldWalker<Support>(this->Blocks, ray).FindExit(t0, span, t);
  }

  double Value(const Vec3& index) override
  {
    std::array<int, 3> cell;
    Vec3 local;
    for (int a = 0; a < 3; ++a)
    {
      const int last = this->Field.GetSize()[a] - 2;
      cell[a] = std::min(std::max(static_cast<int>(index[a]), 0), last);
      local[a] = std::min(std::max(index[a] - cell[a], 0.0), 1.0);
    }
    TensorCell<Support> points;
    this->Field.GetCell(cell, points);
    return points.Value(local);
  }

private:
  VoxelBlocks<T, Support> Field;
  SurfaceBlocks<Support> Blocks;
};

/// What a thread works with.
template <class T, int Support>
struct Worker
{
  Worker(const SolidVoxels<T>& solid, double isoValue, const FieldBlocks<Support>& field,
    const RayGrid& rays, const BlockProjection& projection)
    : Follower(solid, isoValue)
    , Caster(field, rays, projection)
  {
  }
  TypedFollower<T, Support> Follower;
  TileCaster<Support> Caster;
  TileEntries Entries;
  std::vector<RaySpan> Spans;
};

/// Workers are used again by threads that come later: fresh memory costs page faults.
template <class T, int Support>
class Workers
{
public:
  using Pointer = std::unique_ptr<Worker<T, Support>>;

  template <class Make>
  Pointer Take(const Make& make)
  {
    {
      const std::lock_guard<std::mutex> lock(this->Mutex);
      if (!this->Idle.empty())
      {
        Pointer worker = std::move(this->Idle.back());
        this->Idle.pop_back();
        return worker;
      }
    }
    return make();
  }

  void Return(Pointer worker)
  {
    const std::lock_guard<std::mutex> lock(this->Mutex);
    this->Idle.push_back(std::move(worker));
  }

private:
  std::mutex Mutex;
  std::vector<Pointer> Idle;
};

template <class T, int Support>
class TypedField : public IsoField
{
public:
  TypedField(const T* voxels, const std::array<int, 3>& size, SolidSide side, Execution& execution)
    : Bounds(voxels, size, TensorCell<Support>::Before, TensorCell<Support>::After, execution)
  {
    this->Minimum = this->Bounds.GetMinimum();
    this->Maximum = this->Bounds.GetMaximum();
    this->NumberOfNonFinite = this->Bounds.GetNumberOfNonFinite();
    const bool above = side == SolidSide::Above;
    this->Solid = { voxels, size, &this->Bounds, above, this->NumberOfNonFinite > 0,
      above ? this->Minimum : this->Maximum };
  }

  std::unique_ptr<RayFollower> Follow(double isoValue) const override
  {
    return std::make_unique<TypedFollower<T, Support>>(this->Solid, isoValue);
  }

  void CastTiles(const RayGrid& rays, const BlockProjection& projection,
    const std::array<int, 4>& extent, double isoValue, const TileWork& work,
    Execution& execution) const override
  {
    const VoxelBlocks<T, Support> field(this->Solid, isoValue);
    constexpr int width = TileEntries::Width;
    const std::int64_t across = (static_cast<std::int64_t>(extent[1]) - extent[0]) / width + 1;
    const std::int64_t down = (static_cast<std::int64_t>(extent[3]) - extent[2]) / width + 1;
    Workers<T, Support> workers;
    execution.For(across * down, 1,
      [&](std::int64_t begin, std::int64_t end)
      {
        auto worker = workers.Take(
          [&] {
            return std::make_unique<Worker<T, Support>>(
              this->Solid, isoValue, field, rays, projection);
          });
        for (std::int64_t n = begin; n < end; ++n)
        {
          const int x = extent[0] + static_cast<int>(n % across) * width;
          const int y = extent[2] + static_cast<int>(n / across) * width;
          const std::array<int, 4> tile{ x, std::min(x + width - 1, extent[1]), y,
            std::min(y + width - 1, extent[3]) };
          const RaySpan* spans = nullptr;
          if (work.Prepare)
          {
            worker->Spans.resize(width * width);
            work.Prepare(tile, worker->Follower, worker->Spans.data());
            spans = worker->Spans.data();
          }
          worker->Caster.Cast(tile, spans, worker->Entries);
          work.Take(tile, worker->Follower, worker->Entries);
        }
        workers.Return(std::move(worker));
      });
  }

private:
  FieldBounds<T> Bounds;
  SolidVoxels<T> Solid;
};

/// Owns the control points of the spline that goes through the voxels.
class InterpolatingField : public TypedField<float, 4>
{
public:
  InterpolatingField(SplineCoefficients&& coefficients, const std::array<int, 3>& size,
    SolidSide side, Execution& execution)
    : TypedField<float, 4>(coefficients.Values.data(), size, side, execution)
    , Coefficients(std::move(coefficients))
  {
    this->Minimum = this->Coefficients.Minimum;
    this->Maximum = this->Coefficients.Maximum;
    this->NumberOfNonFinite = this->Coefficients.NumberOfNonFinite;
  }

private:
  SplineCoefficients Coefficients;
};

}

std::unique_ptr<const IsoField> MakeIsoField(
  const VoxelVolume& volume, FieldInterpolation interpolation, SolidSide side, Execution& execution)
{
  if (interpolation == FieldInterpolation::InterpolatingBSpline)
  {
    return std::make_unique<InterpolatingField>(
      FilterToCoefficients(volume, side == SolidSide::Above, execution), volume.Size, side,
      execution);
  }
  return DispatchScalars(volume.Type, volume.Voxels,
    [&](const auto* voxels) -> std::unique_ptr<const IsoField>
    {
      using T = std::remove_cv_t<std::remove_pointer_t<decltype(voxels)>>;
      if (interpolation == FieldInterpolation::Trilinear)
      {
        return std::make_unique<TypedField<T, 2>>(voxels, volume.Size, side, execution);
      }
      return std::make_unique<TypedField<T, 4>>(voxels, volume.Size, side, execution);
    });
}
}
