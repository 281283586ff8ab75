// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaIsoRayCaster.h"

#include "lacunaFieldWalker.h"
#include "lacunaSplineFilter.h"

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
  /// The line a + t b is in index coordinates.
  virtual bool FindEntry(
    const Vec3& a, const Vec3& b, double isoValue, double& t, Vec3& gradient) const = 0;

  Matrix4 WorldToIndex;
  double Minimum = 0;
  double Maximum = 0;
  std::int64_t NumberOfNonFinite = 0;
};

namespace
{
constexpr int TileWidth = 16;

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

  bool FindEntry(
    const Vec3& a, const Vec3& b, double isoValue, double& t, Vec3& gradient) const override
  {
    return FieldWalker<T, Support>(this->Walked, a, b, isoValue).FindEntry(t, gradient);
  }

private:
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
  const Matrix4& m = field.WorldToIndex;
  Vec3 g;
  if (!field.FindEntry(m.Point(origin), m.Vector(direction), isoValue, hit.Distance, g))
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
  // Square tiles: neighbouring rays meet the same voxels while these are in the cache.
  const std::int64_t across = (columns + TileWidth - 1) / TileWidth;
  const std::int64_t down = (rows + TileWidth - 1) / TileWidth;
  execution.For(across * down, 1,
    [&](std::int64_t begin, std::int64_t end)
    {
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
            const bool valid = this->CastRay(origin, plane.View, isoValue, hit);
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
