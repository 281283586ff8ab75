// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaIsoRayCaster.h"

#include "lacunaIsoField.h"
#include "lacunaVoxelVolume.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <vector>

namespace lacuna
{
namespace
{
constexpr double Pi = 3.14159265358979323846;
/// Nearer to the eye than this, as a part of the distance of the data's end, no plane is placed.
constexpr double TooNear = 0.05;
}

ImagePlane MakePerspectivePlane(const std::vector<Vec3>& points, double finestSpacing,
  const ViewSettings& view, const Vec3& eye, double angle)
{
  if (!IsFinite(eye))
  {
    throw std::invalid_argument(
      "a perspective view needs EyePosition: the point from which the viewer looks");
  }
  if (!(angle > 0 && angle < 180))
  {
    std::ostringstream message;
    message << "a view angle of " << angle << " degrees is not possible: give more than 0 and "
            << "less than 180";
    throw std::invalid_argument(message.str());
  }
  // also checks what was given, and finds the axes
  ViewSettings placed = view;
  placed.Size = { 1, 1 };
  const Vec3 direction = MakeImagePlane(points, finestSpacing, placed).View;
  double nearest = std::numeric_limits<double>::infinity();
  double farthest = -nearest;
  for (const Vec3& point : points)
  {
    const double z = Dot(point - eye, direction);
    nearest = std::min(nearest, z);
    farthest = std::max(farthest, z);
  }
  double distance = nearest > TooNear * farthest ? nearest : 0.5 * farthest;
  if (view.HasPlaneOrigin || view.HasFocalPoint)
  {
    distance = Dot((view.HasPlaneOrigin ? view.PlaneOrigin : view.FocalPoint) - eye, direction);
  }
  if (!(distance > 0))
  {
    throw std::invalid_argument(view.HasPlaneOrigin || view.HasFocalPoint
        ? "the image plane lies behind the eye: give a PlaneOrigin or FocalPoint before it, or "
          "turn "
          "ViewDirection round"
        : "the data lie behind the eye: move EyePosition or turn ViewDirection round");
  }
  const double height = 2 * distance * std::tan(angle * Pi / 360);
  placed = view;
  if (!(placed.PixelSpacing > 0))
  {
    placed.PixelSpacing = placed.Size[1] > 0 ? height / placed.Size[1] : finestSpacing;
  }
  if (placed.Size[1] == 0)
  {
    const double rows = std::round(height / placed.PixelSpacing);
    placed.Size[1] =
      static_cast<int>(std::min(std::max(rows, 1.0), 1.0 * std::numeric_limits<int>::max()));
  }
  if (placed.Size[0] == 0)
  {
    placed.Size[0] = placed.Size[1];
  }
  placed.HasFocalPoint = placed.HasPlaneOrigin = true;
  placed.FocalPoint = placed.PlaneOrigin = eye + distance * direction;
  return MakeImagePlane(points, finestSpacing, placed);
}

double ViewAngleOf(const ImagePlane& plane, const Vec3& eye)
{
  const double distance = Dot(plane.Origin - eye, plane.View);
  return std::atan(0.5 * plane.Size[1] * plane.PixelSpacing / distance) * 360 / Pi;
}

//------------------------------------------------------------------------------
// Casts the rays of one depth map as requested.

// Splits every ray at what is cut away. The tile caster finds the entry in a ray's first part; the
// few rays that go on behind a cut are followed alone.
class MapCaster
{
public:
  // Everything must outlive this object.
  MapCaster(const IsoRayCaster& caster, const ImagePlane& plane, const DepthPixels& pixels,
    const RayRequest& request);

  void Cast(double isoValue, Execution& execution) const;

private:
  enum class Cap
  {
    None,
    CutAway,
    Boundary
  };
  // A part of a ray that is not cut away, and what shows if it starts in the solid.
  struct Part
  {
    RaySpan Span;
    Cap Start;
  };
  // What is known of a pixel's ray. World distances are (t - Zero) * Length.
  struct PixelRay
  {
    Ray Index;
    Vec3 Origin; // world
    Vec3 Direction;
    double Zero;
    double Length;
  };
  struct Hit
  {
    double T;
    Vec3 Normal;
    RaySpan Part;
  };

  struct PixelResult
  {
    bool Valid = false;
    double Depth = std::numeric_limits<double>::quiet_NaN();
    Vec3 Normal{ 0, 0, 0 };
    double Thickness = std::numeric_limits<double>::quiet_NaN();
  };

  PixelRay GetRay(int column, int row) const;
  std::vector<Part> FindParts(const PixelRay& ray, std::int64_t pixel) const;
  bool IsCapped(const PixelRay& ray, const Part& part, RayFollower& follower) const;
  Vec3 CapNormal(const PixelRay& ray, const Part& part) const;
  Vec3 EntryNormal(const PixelRay& ray, const RayEntry& entry) const;
  bool HasParts() const;
  bool IsAnyFinite() const;
  bool FindHit(const PixelRay& ray, std::int64_t pixel, bool firstFound, const RayEntry& first,
    RayFollower& follower, Hit& hit) const;
  double FindThickness(const PixelRay& ray, const Hit& hit, RayFollower& follower) const;
  void Prepare(const std::array<int, 4>& tile, RayFollower& follower, RaySpan* spans) const;
  void Take(
    const std::array<int, 4>& tile, RayFollower& follower, const TileEntries& entries) const;
  PixelResult FindResult(int column, int row, std::int64_t pixel, bool found, const RayEntry& entry,
    RayFollower& follower) const;
  std::int64_t IndexOf(int column, int row) const;

  const IsoRayCaster& Caster;
  const ImagePlane& Plane;
  const DepthPixels& Pixels;
  const RayRequest& Request;
  RayGrid Rays;
  Matrix4 IndexToPixel;
};

namespace
{
// The grey-level gradient: differences of voxels, interpolated between them. Carr 1996, eq. 3.5.

template <class T>
Vec3 Interpolate(const T* voxels, const std::array<int, 3>& size, const Vec3& index, double empty)
{
  int cell[3];
  double x[3];
  for (int a = 0; a < 3; ++a)
  {
    cell[a] = std::min(std::max(static_cast<int>(index[a]), 0), size[a] - 2);
    x[a] = std::min(std::max(index[a] - cell[a], 0.0), 1.0);
  }
  const auto voxel = [&](const int at[3])
  {
    const double v = static_cast<double>(voxels[at[0] +
      static_cast<std::int64_t>(size[0]) * (at[1] + static_cast<std::int64_t>(size[1]) * at[2])]);
    return std::isfinite(v) ? v : empty;
  };
  Vec3 gradient{ 0, 0, 0 };
  for (int n = 0; n < 8; ++n)
  {
    const int corner[3] = { n & 1, n >> 1 & 1, n >> 2 };
    double weight = 1;
    for (int a = 0; a < 3; ++a)
    {
      weight *= corner[a] ? x[a] : 1 - x[a];
    }
    for (int a = 0; a < 3; ++a)
    {
      int low[3] = { cell[0] + corner[0], cell[1] + corner[1], cell[2] + corner[2] };
      int high[3] = { low[0], low[1], low[2] };
      low[a] = std::max(low[a] - 1, 0);
      high[a] = std::min(high[a] + 1, size[a] - 1);
      gradient[a] += weight * (voxel(high) - voxel(low)) / (high[a] - low[a]);
    }
  }
  return gradient;
}

// Central differences at the eight voxels round an index point, one-sided at the border,
// interpolated trilinearly; per voxel step. Voxels that are not finite count as empty.
Vec3 GreyLevelGradient(const VoxelVolume& volume, const Vec3& index, double empty)
{
  return DispatchScalars(volume.Type, volume.Voxels,
    [&](const auto* voxels) { return Interpolate(voxels, volume.Size, index, empty); });
}

//------------------------------------------------------------------------------
constexpr double NotANumber = std::numeric_limits<double>::quiet_NaN();
/// How far behind a surface a ray goes on, voxels.
constexpr double BehindSurface = 1e-6;

Matrix4 FromRows(const Vec3 (&rows)[3], const Vec3& origin)
{
  Matrix4 m;
  for (int r = 0; r < 3; ++r)
  {
    for (int a = 0; a < 3; ++a)
    {
      m(r, a) = rows[r][a];
    }
    m(r, 3) = -Dot(rows[r], origin);
  }
  return m;
}
}

MapCaster::MapCaster(const IsoRayCaster& caster, const ImagePlane& plane, const DepthPixels& pixels,
  const RayRequest& request)
  : Caster(caster)
  , Plane(plane)
  , Pixels(pixels)
  , Request(request)
{
  const Matrix4& m = caster.WorldToIndex;
  const Vec3 zero{ 0, 0, 0 };
  const Vec3 perColumn = m.Vector(plane.PixelSpacing * plane.Right);
  const Vec3 perRow = m.Vector(plane.PixelSpacing * plane.Down);
  const Vec3 right = (1 / plane.PixelSpacing) * plane.Right;
  const Vec3 down = (1 / plane.PixelSpacing) * plane.Down;
  if (!request.Eye)
  {
    this->Rays = { { m.Point(plane.Origin), m.Vector(plane.View) }, { perColumn, zero },
      { perRow, zero }, true };
    this->IndexToPixel =
      FromRows({ right, down, plane.View }, plane.Origin) * caster.Volume.IndexToWorld;
    return;
  }
  const Vec3& eye = *request.Eye;
  const Vec3 corner = plane.Origin - eye;
  const double distance = Dot(corner, plane.View);
  if (!(distance > 0))
  {
    throw std::invalid_argument("the eye is not before the image plane");
  }
  this->Rays = { { m.Point(eye), m.Vector(corner) }, { zero, perColumn }, { zero, perRow }, false };
  // A point p is seen at eye + (p - eye) distance / z, z = (p - eye) . View.
  this->IndexToPixel = FromRows({ distance * right - Dot(corner, right) * plane.View,
                                  distance * down - Dot(corner, down) * plane.View, plane.View },
                         eye) *
    caster.Volume.IndexToWorld;
}

void MapCaster::Cast(double isoValue, Execution& execution) const
{
  const BlockProjection projection(this->IndexToPixel, this->Rays);
  IsoField::TileWork work;
  if (this->Request.Eye || this->Request.StartDepth || this->HasParts() || !this->IsAnyFinite())
  {
    work.Prepare = [this](const auto& tile, RayFollower& follower, RaySpan* spans)
    { this->Prepare(tile, follower, spans); };
  }
  work.Take = [this](const auto& tile, RayFollower& follower, const TileEntries& entries)
  { this->Take(tile, follower, entries); };
  this->Caster.Field->CastTiles(
    this->Rays, projection, this->Pixels.Extent, isoValue, work, execution);
}

std::int64_t MapCaster::IndexOf(int column, int row) const
{
  const auto& e = this->Pixels.Extent;
  return (static_cast<std::int64_t>(row) - e[2]) * (static_cast<std::int64_t>(e[1]) - e[0] + 1) +
    column - e[0];
}

MapCaster::PixelRay MapCaster::GetRay(int column, int row) const
{
  const Vec3 position = this->Plane.PixelPosition(column, row);
  const Ray index = this->Rays.Get(column, row);
  if (!this->Request.Eye)
  {
    return { index, position, this->Plane.View, 0, 1 };
  }
  const Vec3 direction = position - *this->Request.Eye;
  return { index, *this->Request.Eye, direction, 1, Norm(direction) };
}

bool MapCaster::HasParts() const
{
  return this->Request.CutAway || this->Request.CapBoundary;
}

bool MapCaster::IsAnyFinite() const
{
  return this->Caster.GetMinimum() <= this->Caster.GetMaximum();
}

std::vector<MapCaster::Part> MapCaster::FindParts(const PixelRay& ray, std::int64_t pixel) const
{
  RaySpan whole;
  if (!this->IsAnyFinite() || !ClipToVolume(ray.Index, this->Caster.Volume.Size, whole))
  {
    return {};
  }
  Part part{ whole, this->Request.CapBoundary ? Cap::Boundary : Cap::None };
  const auto begin = [&](double t)
  {
    if (!(t <= part.Span.First))
    {
      part = { { t, part.Span.Last }, Cap::None };
    }
  };
  if (this->Request.Eye)
  {
    begin(0);
  }
  if (this->Request.StartDepth)
  {
    const double start = this->Request.StartDepth[pixel];
    if (std::isnan(start))
    {
      return {};
    }
    begin(ray.Zero + start / ray.Length + BehindSurface / Norm(ray.Index.B));
  }
  std::vector<Part> parts;
  if (this->Request.CutAway)
  {
    for (const RaySpan& cut : this->Request.CutAway->Find(ray.Origin, ray.Direction, part.Span))
    {
      if (cut.First > part.Span.First)
      {
        parts.push_back({ { part.Span.First, cut.First }, part.Start });
      }
      part = { { cut.Last, whole.Last }, this->Request.CapCutAway ? Cap::CutAway : Cap::None };
    }
  }
  if (part.Span.First < part.Span.Last)
  {
    parts.push_back(part);
  }
  return parts;
}

bool MapCaster::IsCapped(const PixelRay& ray, const Part& part, RayFollower& follower) const
{
  return part.Start != Cap::None &&
    follower.Value(ray.Index.A + part.Span.First * ray.Index.B) >= 0;
}

Vec3 MapCaster::CapNormal(const PixelRay& ray, const Part& part) const
{
  const double t = part.Span.First;
  if (part.Start == Cap::CutAway)
  {
    return this->Request.CutAway->Normal(ray.Origin + t * ray.Direction);
  }
  // the face that the ray passes last
  Vec3 inwards{ 0, 0, 0 };
  double last = -std::numeric_limits<double>::infinity();
  for (int a = 0; a < 3; ++a)
  {
    const double b = ray.Index.B[a];
    const double face = b > 0 ? 0 : this->Caster.Volume.Size[a] - 1;
    const double entry = (face - ray.Index.A[a]) / b;
    if (b != 0 && entry > last)
    {
      last = entry;
      inwards = { 0, 0, 0 };
      inwards[a] = b > 0 ? 1 : -1;
    }
  }
  return this->Caster.NormalOf(inwards, ray.Direction);
}

Vec3 MapCaster::EntryNormal(const PixelRay& ray, const RayEntry& entry) const
{
  if (this->Request.Normals == SurfaceNormal::Analytic)
  {
    return this->Caster.NormalOf(entry.Gradient, ray.Direction);
  }
  const bool above = this->Caster.Side == SolidSide::Above;
  const double empty = above ? this->Caster.GetMinimum() : this->Caster.GetMaximum();
  const Vec3 gradient =
    GreyLevelGradient(this->Caster.Volume, ray.Index.A + entry.T * ray.Index.B, empty);
  return this->Caster.NormalOf((above ? 1.0 : -1.0) * gradient, ray.Direction);
}

void MapCaster::Prepare(const std::array<int, 4>& tile, RayFollower& follower, RaySpan* spans) const
{
  constexpr double infinity = std::numeric_limits<double>::infinity();
  for (int row = tile[2]; row <= tile[3]; ++row)
  {
    for (int column = tile[0]; column <= tile[1]; ++column)
    {
      const PixelRay ray = this->GetRay(column, row);
      const std::vector<Part> parts = this->FindParts(ray, this->IndexOf(column, row));
      spans[TileEntries::Width * (row - tile[2]) + column - tile[0]] =
        parts.empty() || this->IsCapped(ray, parts.front(), follower)
        ? RaySpan{ infinity, -infinity }
        : parts.front().Span;
    }
  }
}

bool MapCaster::FindHit(const PixelRay& ray, std::int64_t pixel, bool firstFound,
  const RayEntry& first, RayFollower& follower, Hit& hit) const
{
  if (!this->HasParts())
  {
    if (firstFound)
    {
      hit = { first.T, this->EntryNormal(ray, first), RaySpan{} };
    }
    return firstFound;
  }
  const std::vector<Part> parts = this->FindParts(ray, pixel);
  for (const Part& part : parts)
  {
    RayEntry entry = first;
    if (this->IsCapped(ray, part, follower))
    {
      hit = { part.Span.First, this->CapNormal(ray, part), part.Span };
      return true;
    }
    if (&part == &parts.front() ? firstFound : follower.FindEntry(ray.Index, part.Span, entry))
    {
      hit = { entry.T, this->EntryNormal(ray, entry), part.Span };
      return true;
    }
  }
  return false;
}

double MapCaster::FindThickness(const PixelRay& ray, const Hit& hit, RayFollower& follower) const
{
  double exit;
  if (!follower.FindExit(ray.Index, hit.T + BehindSurface / Norm(ray.Index.B), hit.Part, exit))
  {
    RaySpan whole;
    const bool cut =
      ClipToVolume(ray.Index, this->Caster.Volume.Size, whole) && hit.Part.Last < whole.Last;
    if (!cut)
    {
      return NotANumber;
    }
    exit = hit.Part.Last;
  }
  return (exit - hit.T) * ray.Length;
}

void MapCaster::Take(
  const std::array<int, 4>& tile, RayFollower& follower, const TileEntries& entries) const
{
  const bool hasParts = this->HasParts();
  for (int row = tile[2]; row <= tile[3]; ++row)
  {
    const int line = row - tile[2];
    std::int64_t i = this->IndexOf(tile[0], row);
    for (int x = 0; x <= tile[1] - tile[0]; ++x, ++i)
    {
      const RayEntry& entry = entries.Entries[TileEntries::Width * line + x];
      const bool found = entries.Found[line] >> x & 1;
      PixelResult result;
      if (found || hasParts)
      {
        result = this->FindResult(tile[0] + x, row, i, found, entry, follower);
      }
      this->Pixels.Depth[i] = result.Depth;
      if (this->Pixels.Valid)
      {
        this->Pixels.Valid[i] = result.Valid;
      }
      if (this->Request.Thickness)
      {
        this->Request.Thickness[i] = result.Thickness;
      }
      for (int a = 0; this->Pixels.Normals && a < 3; ++a)
      {
        this->Pixels.Normals[3 * i + a] = static_cast<float>(result.Normal[a]);
      }
    }
  }
}

MapCaster::PixelResult MapCaster::FindResult(int column, int row, std::int64_t pixel, bool found,
  const RayEntry& entry, RayFollower& follower) const
{
  const PixelRay ray = this->GetRay(column, row);
  Hit hit;
  if (!this->FindHit(ray, pixel, found, entry, follower, hit))
  {
    return {};
  }
  return { true, (hit.T - ray.Zero) * ray.Length, hit.Normal,
    this->Request.Thickness ? this->FindThickness(ray, hit, follower) : NotANumber };
}

//------------------------------------------------------------------------------
IsoRayCaster::IsoRayCaster(
  const VoxelVolume& volume, FieldInterpolation interpolation, SolidSide side, Execution& execution)
  : Volume(volume)
  , Side(side)
{
  CheckVolumeSize(volume.Size);
  this->WorldToIndex = volume.IndexToWorld.Inverse();
  this->Field = MakeIsoField(this->Volume, interpolation, side, execution);
}

IsoRayCaster::~IsoRayCaster() = default;

double IsoRayCaster::GetMinimum() const
{
  return this->Field->Minimum;
}

double IsoRayCaster::GetMaximum() const
{
  return this->Field->Maximum;
}

std::int64_t IsoRayCaster::GetNumberOfNonFiniteVoxels() const
{
  return this->Field->NumberOfNonFinite;
}

Vec3 IsoRayCaster::NormalOf(const Vec3& gradient, const Vec3& direction) const
{
  // A gradient is a covector: it goes back with the transposed matrix.
  const Matrix4& m = this->WorldToIndex;
  const Vec3& g = gradient;
  const Vec3 world{ m(0, 0) * g[0] + m(1, 0) * g[1] + m(2, 0) * g[2],
    m(0, 1) * g[0] + m(1, 1) * g[1] + m(2, 1) * g[2],
    m(0, 2) * g[0] + m(1, 2) * g[1] + m(2, 2) * g[2] };
  const double length = Norm(world);
  // On a plateau at the iso-value the surface has no direction: show it to the viewer.
  return length > 0 ? (-1 / length) * world : -1 * Normalized(direction);
}

bool IsoRayCaster::CastRay(
  const Vec3& origin, const Vec3& direction, double isoValue, RayHit& hit) const
{
  if (!(this->Field->Minimum <= this->Field->Maximum))
  {
    return false; // no voxel is finite
  }
  const Ray ray{ this->WorldToIndex.Point(origin), this->WorldToIndex.Vector(direction) };
  RayEntry entry;
  if (!this->Field->Follow(isoValue)->FindEntry(ray, RaySpan{}, entry))
  {
    return false;
  }
  hit = { entry.T, this->NormalOf(entry.Gradient, direction) };
  return true;
}

void IsoRayCaster::Cast(const ImagePlane& plane, double isoValue, const DepthPixels& pixels,
  const RayRequest& request, Execution& execution) const
{
  const auto& e = pixels.Extent;
  if (e[1] >= e[0] && e[3] >= e[2])
  {
    MapCaster(*this, plane, pixels, request).Cast(isoValue, execution);
  }
}

void IsoRayCaster::Cast(
  const ImagePlane& plane, double isoValue, const DepthPixels& pixels, Execution& execution) const
{
  this->Cast(plane, isoValue, pixels, RayRequest{}, execution);
}
}
