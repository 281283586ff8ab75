// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaMapCaster.h"

#include "lacunaGreyLevelGradient.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace lacuna
{
namespace
{
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
}
