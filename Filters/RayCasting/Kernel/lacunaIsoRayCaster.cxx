// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaIsoRayCaster.h"

#include "lacunaFieldWalker.h"
#include "lacunaSplineFilter.h"
#include "lacunaTileCaster.h"
#include "lacunaVoxelBlocks.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <mutex>
#include <type_traits>
#include <utility>
#include <vector>

namespace lacuna
{
/// What depends on the type of voxels and on the interpolation, behind one call per ray or tile.
class IsoRayCaster::Field
{
public:
  virtual ~Field() = default;

  virtual bool FindEntry(
    const Ray& ray, const RaySpan& span, double isoValue, RayEntry& entry) const = 0;

  /// Casts the rays of the pixels of extent in tiles, which are given to take from any thread.
  using TileTaker = std::function<void(const std::array<int, 4>& tile, const TileEntries& entries)>;
  virtual void CastTiles(const RayGrid& rays, const BlockProjection& projection,
    const std::array<int, 4>& extent, double isoValue, const TileTaker& take,
    Execution& execution) const = 0;

  Matrix4 IndexToWorld;
  Matrix4 WorldToIndex;
  double Minimum = 0;
  double Maximum = 0;
  std::int64_t NumberOfNonFinite = 0;
};

namespace
{
/// What a thread works with, used again by those that come later: fresh memory costs page faults.
template <int Support>
class Workers
{
public:
  struct Worker
  {
    TileCaster<Support> Caster;
    TileEntries Entries;
  };

  template <class... Arguments>
  std::unique_ptr<Worker> Take(const Arguments&... arguments)
  {
    {
      const std::lock_guard<std::mutex> lock(this->Mutex);
      if (!this->Idle.empty())
      {
        std::unique_ptr<Worker> worker = std::move(this->Idle.back());
        this->Idle.pop_back();
        return worker;
      }
    }
    return std::unique_ptr<Worker>(new Worker{ { arguments... }, {} });
  }

  void Return(std::unique_ptr<Worker> worker)
  {
    const std::lock_guard<std::mutex> lock(this->Mutex);
    this->Idle.push_back(std::move(worker));
  }

private:
  std::mutex Mutex;
  std::vector<std::unique_ptr<Worker>> Idle;
};

template <class T, int Support>
class TypedField : public IsoRayCaster::Field
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

  bool FindEntry(
    const Ray& ray, const RaySpan& span, double isoValue, RayEntry& entry) const override
  {
    const VoxelBlocks<T, Support> field(this->Solid, isoValue);
    SurfaceBlocks<Support> blocks(field);
    return FieldWalker<Support>(blocks, ray).FindEntry(span, entry);
  }

  void CastTiles(const RayGrid& rays, const BlockProjection& projection,
    const std::array<int, 4>& extent, double isoValue, const TileTaker& take,
    Execution& execution) const override
  {
    const VoxelBlocks<T, Support> field(this->Solid, isoValue);
    constexpr int width = TileEntries::Width;
    const std::int64_t across = (static_cast<std::int64_t>(extent[1]) - extent[0]) / width + 1;
    Workers<Support> workers;
    const std::int64_t down = (static_cast<std::int64_t>(extent[3]) - extent[2]) / width + 1;
    execution.For(across * down, 1,
      [&](std::int64_t begin, std::int64_t end)
      {
        auto worker = workers.Take(field, rays, projection);
        for (std::int64_t n = begin; n < end; ++n)
        {
          const int x = extent[0] + static_cast<int>(n % across) * width;
          const int y = extent[2] + static_cast<int>(n / across) * width;
          const std::array<int, 4> tile{ x, std::min(x + width - 1, extent[1]), y,
            std::min(y + width - 1, extent[3]) };
          worker->Caster.Cast(tile, nullptr, worker->Entries);
          take(tile, worker->Entries);
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

/// The normal of a surface: unit, world, against the gradient.
Vec3 NormalOf(const IsoRayCaster::Field& field, const Vec3& gradient, const Vec3& direction)
{
  // A gradient is a covector: it goes back with the transposed matrix.
  const Matrix4& m = field.WorldToIndex;
  const Vec3& g = gradient;
  const Vec3 world{ m(0, 0) * g[0] + m(1, 0) * g[1] + m(2, 0) * g[2],
    m(0, 1) * g[0] + m(1, 1) * g[1] + m(2, 1) * g[2],
    m(0, 2) * g[0] + m(1, 2) * g[1] + m(2, 2) * g[2] };
  const double length = Norm(world);
  // On a plateau at the iso-value the surface has no direction: show it to the viewer.
  return length > 0 ? (-1 / length) * world : -1 * direction;
}

std::unique_ptr<IsoRayCaster::Field> MakeField(
  const VoxelVolume& volume, FieldInterpolation interpolation, SolidSide side, Execution& execution)
{
  if (interpolation == FieldInterpolation::InterpolatingBSpline)
  {
    return std::make_unique<InterpolatingField>(
      FilterToCoefficients(volume, side == SolidSide::Above, execution), volume.Size, side,
      execution);
  }
  return DispatchScalars(volume.Type, volume.Voxels,
    [&](const auto* voxels) -> std::unique_ptr<IsoRayCaster::Field>
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

IsoRayCaster::IsoRayCaster(
  const VoxelVolume& volume, FieldInterpolation interpolation, SolidSide side, Execution& execution)
{
  CheckVolumeSize(volume.Size);
  const Matrix4 worldToIndex = volume.IndexToWorld.Inverse();
  std::unique_ptr<Field> field = MakeField(volume, interpolation, side, execution);
  field->IndexToWorld = volume.IndexToWorld;
  field->WorldToIndex = worldToIndex;
  this->Implementation = std::move(field);
}

IsoRayCaster::~IsoRayCaster() = default;

double IsoRayCaster::GetMinimum() const
{
  return this->Implementation->Minimum;
}

double IsoRayCaster::GetMaximum() const
{
  return this->Implementation->Maximum;
}

std::int64_t IsoRayCaster::GetNumberOfNonFiniteVoxels() const
{
  return this->Implementation->NumberOfNonFinite;
}

bool IsoRayCaster::CastRay(
  const Vec3& origin, const Vec3& direction, double isoValue, RayHit& hit) const
{
  const Field& field = *this->Implementation;
  if (!(field.Minimum <= field.Maximum))
  {
    return false; // no voxel is finite
  }
  const Ray ray{ field.WorldToIndex.Point(origin), field.WorldToIndex.Vector(direction) };
  RayEntry entry;
  if (!field.FindEntry(ray, RaySpan{}, isoValue, entry))
  {
    return false;
  }
  hit = { entry.T, NormalOf(field, entry.Gradient, direction) };
  return true;
}

void IsoRayCaster::Cast(
  const ImagePlane& plane, double isoValue, const DepthPixels& pixels, Execution& execution) const
{
  const auto& e = pixels.Extent;
  if (e[1] < e[0] || e[3] < e[2])
  {
    return;
  }
  const Field& field = *this->Implementation;
  const Matrix4& m = field.WorldToIndex;
  const Vec3 zero{ 0, 0, 0 };
  const RayGrid rays{ { m.Point(plane.Origin), m.Vector(plane.View) },
    { m.Vector(plane.PixelSpacing * plane.Right), zero },
    { m.Vector(plane.PixelSpacing * plane.Down), zero }, true };
  const Vec3 alongRow = (1 / plane.PixelSpacing) * plane.Right;
  const Vec3 alongColumn = (1 / plane.PixelSpacing) * plane.Down;
  Matrix4 worldToPixel;
  for (int a = 0; a < 3; ++a)
  {
    worldToPixel(0, a) = alongRow[a];
    worldToPixel(1, a) = alongColumn[a];
    worldToPixel(2, a) = plane.View[a];
  }
  worldToPixel(0, 3) = -Dot(alongRow, plane.Origin);
  worldToPixel(1, 3) = -Dot(alongColumn, plane.Origin);
  worldToPixel(2, 3) = -Dot(plane.View, plane.Origin);
  const BlockProjection projection(worldToPixel * field.IndexToWorld, rays);
  const std::int64_t columns = static_cast<std::int64_t>(e[1]) - e[0] + 1;
  const auto take = [&](const std::array<int, 4>& tile, const TileEntries& entries)
  {
    for (int row = tile[2]; row <= tile[3]; ++row)
    {
      const std::uint64_t found = entries.Found[row - tile[2]];
      const RayEntry* line = entries.Entries.data() + TileEntries::Width * (row - tile[2]);
      for (int column = tile[0]; column <= tile[1]; ++column)
      {
        const std::int64_t i = (static_cast<std::int64_t>(row) - e[2]) * columns + column - e[0];
        const int x = column - tile[0];
        const bool valid = found >> x & 1;
        pixels.Depth[i] = valid ? line[x].T : std::numeric_limits<double>::quiet_NaN();
        if (pixels.Valid)
        {
          pixels.Valid[i] = valid;
        }
        if (pixels.Normals)
        {
          const Vec3 normal = valid ? NormalOf(field, line[x].Gradient, plane.View) : zero;
          for (int a = 0; a < 3; ++a)
          {
            pixels.Normals[3 * i + a] = static_cast<float>(normal[a]);
          }
        }
      }
    }
  };
  field.CastTiles(rays, projection, e, isoValue, take, execution);
}
}
