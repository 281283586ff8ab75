// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaIsoRayCaster.h"

#include "lacunaFieldWalker.h"
#include "lacunaSplineFilter.h"
#include "lacunaTileSpans.h"

#include <algorithm>
#include <limits>
#include <type_traits>
#include <utility>
#include <vector>

namespace lacuna
{
/// What depends on the type of voxels and on the interpolation, behind one call per ray.
class IsoRayCaster::Field
{
public:
  virtual ~Field() = default;

  /// What a thread keeps from ray to ray, for one iso-value.
  class Memory
  {
  public:
    virtual ~Memory() = default;
  };
  virtual std::unique_ptr<Memory> Remember(double isoValue) const = 0;

  /// The line a + t b is in index coordinates.
  virtual bool FindEntry(const Vec3& a, const Vec3& b, const RaySpan& span, Memory& memory,
    double& t, Vec3& gradient) const = 0;

  virtual TileSpans FindSpans(const Matrix4& indexToPixel, const std::array<int, 4>& extent,
    double isoValue, Execution& execution) const = 0;

  Matrix4 IndexToWorld;
  Matrix4 WorldToIndex;
  double Minimum = 0;
  double Maximum = 0;
  std::int64_t NumberOfNonFinite = 0;
};

namespace
{
constexpr int TileWidth = 32;
constexpr std::int64_t TilesAtATime = 2;

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
    this->Walked = { voxels, size, &this->Bounds, above, this->NumberOfNonFinite > 0,
      above ? this->Minimum : this->Maximum };
  }

  std::unique_ptr<Memory> Remember(double isoValue) const override
  {
    return std::make_unique<TypedMemory>(this->Walked, isoValue);
  }

  bool FindEntry(const Vec3& a, const Vec3& b, const RaySpan& span, Memory& memory, double& t,
    Vec3& gradient) const override
  {
    auto& own = static_cast<TypedMemory&>(memory);
    return FieldWalker<T, Support>(this->Walked, own.IsoValue, own.Blocks, a, b)
      .FindEntry(span, t, gradient);
  }

  TileSpans FindSpans(const Matrix4& indexToPixel, const std::array<int, 4>& extent,
    double isoValue, Execution& execution) const override
  {
    const bool above = this->Walked.SolidAbove;
    return { this->Bounds, indexToPixel, extent,
      [&](double low, double high) { return above ? high < isoValue : low > isoValue; },
      execution };
  }

private:
  struct TypedMemory : Memory
  {
    TypedMemory(const WalkedField<T>& field, double isoValue)
      : IsoValue(isoValue)
      , Blocks(field, isoValue)
    {
    }
    double IsoValue;
    SurfaceBlocks<T, Support> Blocks;
  };

  FieldBounds<T> Bounds;
  WalkedField<T> Walked;
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

bool CastRay(const IsoRayCaster::Field& field, IsoRayCaster::Field::Memory& memory,
  const RaySpan& span, const Vec3& origin, const Vec3& direction, RayHit& hit)
{
  if (!(field.Minimum <= field.Maximum))
  {
    return false; // no voxel is finite
  }
  const Matrix4& m = field.WorldToIndex;
  Vec3 g;
  if (!field.FindEntry(m.Point(origin), m.Vector(direction), span, memory, hit.Distance, g))
  {
    return false;
  }
  // A gradient is a covector: it goes back with the transposed matrix.
  const Vec3 world{ m(0, 0) * g[0] + m(1, 0) * g[1] + m(2, 0) * g[2],
    m(0, 1) * g[0] + m(1, 1) * g[1] + m(2, 1) * g[2],
    m(0, 2) * g[0] + m(1, 2) * g[1] + m(2, 2) * g[2] };
  const double length = Norm(world);
  // On a plateau at the iso-value the surface has no direction: show it to the viewer.
  hit.Normal = length > 0 ? (-1 / length) * world : -1 * direction;
  return true;
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
  const std::unique_ptr<Field::Memory> memory = this->Implementation->Remember(isoValue);
  return ::lacuna::CastRay(*this->Implementation, *memory, RaySpan::All(), origin, direction, hit);
}

void IsoRayCaster::Cast(
  const ImagePlane& plane, double isoValue, const DepthPixels& pixels, Execution& execution) const
{
  const auto& e = pixels.Extent;
  const std::int64_t columns = static_cast<std::int64_t>(e[1]) - e[0] + 1;
  const std::int64_t rows = static_cast<std::int64_t>(e[3]) - e[2] + 1;
  if (columns <= 0 || rows <= 0)
  {
    return;
  }
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
  const TileSpans spans = this->Implementation->FindSpans(
    worldToPixel * this->Implementation->IndexToWorld, e, isoValue, execution);
  // Square tiles: neighbouring rays meet the same voxels while these are in the cache.
  const std::int64_t across = (columns + TileWidth - 1) / TileWidth;
  const std::int64_t down = (rows + TileWidth - 1) / TileWidth;
  execution.For(across * down, TilesAtATime,
    [&](std::int64_t begin, std::int64_t end)
    {
      const std::unique_ptr<Field::Memory> memory = this->Implementation->Remember(isoValue);
      for (std::int64_t tile = begin; tile < end; ++tile)
      {
        const std::int64_t x0 = tile % across * TileWidth;
        const std::int64_t y0 = tile / across * TileWidth;
        for (std::int64_t y = y0; y < std::min(rows, y0 + TileWidth); ++y)
        {
          for (std::int64_t x = x0; x < std::min(columns, x0 + TileWidth); ++x)
          {
            const std::int64_t i = y * columns + x;
            const Vec3 origin =
              plane.PixelPosition(static_cast<int>(e[0] + x), static_cast<int>(e[2] + y));
            RayHit hit{ std::numeric_limits<double>::quiet_NaN(), { 0, 0, 0 } };
            const RaySpan span = spans.Get(static_cast<int>(e[0] + x), static_cast<int>(e[2] + y));
            const bool valid = !span.IsEmpty() &&
              ::lacuna::CastRay(*this->Implementation, *memory, span, origin, plane.View, hit);
            pixels.Depth[i] = hit.Distance;
            if (pixels.Valid)
            {
              pixels.Valid[i] = valid;
            }
            for (int a = 0; pixels.Normals && a < 3; ++a)
            {
              pixels.Normals[3 * i + a] = static_cast<float>(hit.Normal[a]);
            }
          }
        }
      }
    });
}
}
