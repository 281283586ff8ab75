// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaOcclusionTile.h"

#include "lacunaAttenuationField.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace lacuna
{
//------------------------------------------------------------------------------
LinePath::LinePath(double slopeX, double slopeY, double step, std::int64_t layers)
  : SlopeX(slopeX)
  , SlopeY(slopeY)
  , Step(step)
  , Layers(layers)
{
}

LinePath::Layer LinePath::GetLayer(std::int64_t k) const
{
  const double fromMiddle = static_cast<double>(k) - 0.5 * static_cast<double>(this->Layers - 1);
  const double x = this->SlopeX * fromMiddle;
  const double y = this->SlopeY * fromMiddle;
  const double fx = x - std::floor(x);
  const double fy = y - std::floor(y);
  return { static_cast<std::int64_t>(std::floor(x)), static_cast<std::int64_t>(std::floor(y)),
    static_cast<float>(fx), static_cast<float>(fy), this->GetLengths(fx, fy) };
}

LinePath::Layer LinePath::GetNeighborLayer(int side) const
{
  const double x = side * this->SlopeX;
  const double y = side * this->SlopeY;
  const int shiftX = x < 0 ? -1 : 0;
  const int shiftY = y < 0 ? -1 : 0;
  const double fx = x - shiftX;
  const double fy = y - shiftY;
  return { shiftX, shiftY, static_cast<float>(fx), static_cast<float>(fy),
    this->GetLengths(fx, fy) };
}

/// Over the layer, -1/2 <= t <= 1/2, the ray is at (fx + SlopeX t, fy + SlopeY t). It changes
/// voxel where that is 1/2, at most once in x and once in y.
PathLengths LinePath::GetLengths(double fractionX, double fractionY) const
{
  const auto change = [](double fraction, double slope)
  {
    const double t = slope != 0 ? (0.5 - fraction) / slope : 1;
    return std::abs(t) < 0.5 ? t : 0.5;
  };
  const double changeX = change(fractionX, this->SlopeX);
  const double changeY = change(fractionY, this->SlopeY);
  const double cuts[4] = { -0.5, std::min(changeX, changeY), std::max(changeX, changeY), 0.5 };
  PathLengths lengths{};
  for (int i = 0; i < 3; ++i)
  {
    const double middle = 0.5 * (cuts[i] + cuts[i + 1]);
    const int voxel = (fractionX + this->SlopeX * middle > 0.5 ? 1 : 0) +
      (fractionY + this->SlopeY * middle > 0.5 ? 2 : 0);
    lengths[voxel] += static_cast<float>(this->Step * (cuts[i + 1] - cuts[i]));
  }
  return lengths;
}

void LinePath::GetRays(
  std::int64_t length, double slope, std::int64_t& first, std::int64_t& last) const
{
  // Voxel i lies between the rays i - shift - 1 and i - shift.
  const double reach = 0.5 * std::abs(slope) * static_cast<double>(this->Layers - 1);
  first = -static_cast<std::int64_t>(std::floor(reach));
  last = length - static_cast<std::int64_t>(std::floor(-reach));
}

//------------------------------------------------------------------------------
TileMarch::TileMarch(bool binary, double radius, bool space)
  : Windowed(radius > 0 || space)
  , Radius(radius)
  , Space(space)
  , Rows(GetOcclusionRows(binary))
{
}

void TileMarch::March(const MarchFrame& frame, const LinePath& line, const RayTile& tile)
{
  this->Frame = &frame;
  this->Line = &line;
  this->Tile = tile;
  this->FirstRow = frame.Rows == 1 ? 0 : tile.FirstY - 1;
  this->Width = tile.LastX - tile.FirstX + 1;
  this->Plane = this->Width * (tile.LastY - this->FirstRow);
  this->Zero.assign(this->Width, 0);
  for (auto& side : this->Roots)
  {
    side[0].resize(this->Width);
    side[1].resize(this->Width);
  }
  // A voxel's own ray is followed exactly through half the voxel and the next layer, as far as
  // the radius reaches.
  const double step = line.GetStep();
  const double own = this->Radius > 0 ? std::min(0.5 * step, this->Radius) : 0.5 * step;
  const double next = this->Radius > 0 ? std::min(step, this->Radius - own) : step;
  this->OwnHalf = static_cast<float>(own);
  for (int side : { 0, 1 })
  {
    this->Neighbors[side] = line.GetNeighborLayer(side == 0 ? -1 : 1);
    for (float& length : this->Neighbors[side].Lengths)
    {
      length *= static_cast<float>(next / step);
    }
  }
  if (this->Windowed)
  {
    this->StorePaths();
    this->MarchWindowed(0);
    this->MarchWindowed(1);
  }
  else
  {
    this->MarchWhole();
  }
}

/// From a plane of rays to the first ray of span.
std::int64_t TileMarch::GetOffset(const Span& span) const
{
  return (span.Q - this->FirstRow) * this->Width + (span.FirstX - this->Tile.FirstX + 1);
}

const float* TileMarch::GetStored(std::int64_t plane) const
{
  const std::int64_t last = this->Frame->Layers;
  return this->Store.data() + std::min(std::max<std::int64_t>(plane, 0), last) * this->Plane;
}

template <class Body>
void TileMarch::ForRows(std::int64_t k, Body&& body)
{
  const MarchFrame& frame = *this->Frame;
  Span span{ this->Line->GetLayer(k), k, 0, 0, 0 };
  const LinePath::Layer& layer = span.Layer;
  span.FirstX = std::max(this->Tile.FirstX - 1, -1 - layer.ShiftX);
  span.Count = std::min(this->Tile.LastX, frame.Length - layer.ShiftX) - span.FirstX;
  if (span.Count <= 0)
  {
    return;
  }
  const std::int64_t first = frame.Rows == 1 ? 0 : std::max(this->FirstRow, -1 - layer.ShiftY);
  const std::int64_t last = std::min(this->Tile.LastY, frame.Rows - layer.ShiftY);
  for (span.Q = first; span.Q < last; ++span.Q)
  {
    body(span);
  }
}

/// Adds a layer to the path of each ray.
void TileMarch::Advance(float* plane, std::int64_t k)
{
  const std::int64_t next = this->Frame->Rows == 1 ? 0 : 1;
  this->ForRows(k,
    [&](const Span& span)
    {
      const std::int64_t i = span.FirstX + span.Layer.ShiftX;
      const std::int64_t j = span.Q + span.Layer.ShiftY;
      this->Rows.AddPath(plane + this->GetOffset(span), this->Frame->FieldAt(i, j, k),
        this->Frame->FieldAt(i, j + next, k), span.Layer.Lengths, span.Count);
    });
}

/// Serves the voxels between the rows of rays span.Q - 1 and span.Q, with what lies at lower
/// layers (BeforeSide), at higher ones or both.
void TileMarch::Hide(const Span& span, int sides)
{
  const MarchFrame& frame = *this->Frame;
  const bool flat = frame.Rows == 1;
  const LinePath::Layer& layer = span.Layer;
  const std::int64_t first = std::max(this->Tile.FirstX, -layer.ShiftX);
  const std::int64_t count = std::min(this->Tile.LastX, frame.Length - layer.ShiftX) - first;
  const std::int64_t j = span.Q + layer.ShiftY;
  if (count <= 0 || j < 0 || span.Q < this->Tile.FirstY)
  {
    return;
  }
  const std::int64_t i = first + layer.ShiftX;
  const std::int64_t offset = first - this->Tile.FirstX + 1;
  const auto getSide = [&](int side) -> OcclusionRows::Side
  {
    const LinePath::Layer& next = this->Neighbors[side];
    const std::int64_t k = side == BeforeSide ? span.K - 1 : span.K + 1;
    const std::int64_t row = flat ? j : j + next.ShiftY;
    const float* near = this->Roots[side][1].data() + offset;
    const float* far = flat ? near : this->Roots[side][0].data() + offset;
    return { frame.FieldAt(i + next.ShiftX, row, k),
      frame.FieldAt(i + next.ShiftX, flat ? row : row + 1, k), next.Lengths, near, far };
  };
  float* hidden = frame.Hidden + span.K * frame.HiddenLayerStride + j * frame.HiddenRowStride + i;
  const float* own = frame.FieldAt(i, j, span.K);
  if (sides == BothSides)
  {
    this->Rows.Hide(hidden, own, this->OwnHalf, getSide(BeforeSide), getSide(AfterSide),
      layer.FractionX, layer.FractionY, count);
  }
  else
  {
    this->Rows.HideSide(
      hidden, own, this->OwnHalf, getSide(sides), layer.FractionX, layer.FractionY, count);
  }
}

/// One pass for the whole path of each ray; then, with the path before and after each layer, what
/// both directions see.
void TileMarch::MarchWhole()
{
  const std::int64_t layers = this->Frame->Layers;
  this->Total.assign(this->Plane, 0);
  this->Before.assign(this->Plane, 0);
  this->After.assign(this->Plane, 0);
  for (std::int64_t k = 0; k < layers; ++k)
  {
    this->Advance(this->Total.data(), k);
  }
  this->Advance(this->After.data(), 0);
  for (std::int64_t k = 0; k < layers; ++k)
  {
    if (k >= 2)
    {
      this->Advance(this->Before.data(), k - 2);
    }
    if (k + 1 < layers)
    {
      this->Advance(this->After.data(), k + 1);
    }
    this->ForRows(k,
      [&](const Span& span)
      {
        const std::int64_t offset = this->GetOffset(span);
        const std::int64_t column = span.FirstX - this->Tile.FirstX + 1;
        for (auto& side : this->Roots)
        {
          std::swap(side[0], side[1]);
        }
        this->Rows.See(this->Before.data() + offset, this->Zero.data(),
          this->Roots[0][1].data() + column, span.Count);
        this->Rows.See(this->Total.data() + offset, this->After.data() + offset,
          this->Roots[1][1].data() + column, span.Count);
        this->Hide(span, BothSides);
      });
  }
}

/// Rays that end need the path up to each plane between layers: a ray's part of it is a difference
/// of two.
void TileMarch::StorePaths()
{
  this->Store.resize(this->Plane * (this->Frame->Layers + 1));
  std::fill_n(this->Store.begin(), this->Plane, 0.0F);
  for (std::int64_t k = 0; k < this->Frame->Layers; ++k)
  {
    float* next = this->Store.data() + (k + 1) * this->Plane;
    std::copy_n(next - this->Plane, this->Plane, next);
    this->Advance(next, k);
  }
}

/// The path up to a place between two planes; planes are counted from the grid's first face.
void TileMarch::PathAt(double plane, const Span& span, float* path) const
{
  const double inside = std::min(std::max(plane, 0.0), static_cast<double>(this->Frame->Layers));
  const std::int64_t first = std::min(static_cast<std::int64_t>(inside), this->Frame->Layers - 1);
  const float fraction = static_cast<float>(inside - static_cast<double>(first));
  const float* a = this->GetStored(first) + this->GetOffset(span);
  const float* b = this->GetStored(first + 1) + this->GetOffset(span);
  for (std::int64_t i = 0; i < span.Count; ++i)
  {
    path[i] = a[i] + fraction * (b[i] - a[i]);
  }
}

/// A ray whose nearest voxel is outside the reconstruction space starts anew, with path.
void TileMarch::UpdateSpace(const Span& span, const float* path)
{
  const LinePath::Layer& layer = span.Layer;
  const bool flat = this->Frame->Rows == 1;
  const std::int64_t i = span.FirstX + layer.ShiftX + (layer.FractionX > 0.5F ? 1 : 0);
  const std::int64_t j = span.Q + layer.ShiftY + (!flat && layer.FractionY > 0.5F ? 1 : 0);
  const float* nearest = this->Frame->FieldAt(i, j, span.K);
  float* bound = this->Bound.data() + this->GetOffset(span);
  for (std::int64_t r = 0; r < span.Count; ++r)
  {
    bound[r] = AttenuationField::IsOutsideSpace(nearest[r]) ? path[r] : bound[r];
  }
}

/// side 0: what lies at lower layers, in ascending order; 1: at higher ones, in descending order.
void TileMarch::MarchWindowed(int side)
{
  const std::int64_t layers = this->Frame->Layers;
  const double all = static_cast<double>(layers) + 1;
  const double reach = this->Radius > 0 ? this->Radius / this->Line->GetStep() : all;
  const float* start = this->GetStored(side == 0 ? 0 : layers);
  this->Bound.assign(start, start + this->Plane);
  this->Before.resize(this->Width);
  float* end = this->Before.data();
  const auto serve = [&](const Span& span)
  {
    std::swap(this->Roots[side][0], this->Roots[side][1]);
    const std::int64_t offset = this->GetOffset(span);
    const double middle = static_cast<double>(span.K) + 0.5;
    this->PathAt(side == 0 ? middle - reach : middle + reach, span, end);
    if (this->Space)
    {
      const float* bound = this->Bound.data() + offset;
      for (std::int64_t i = 0; i < span.Count; ++i)
      {
        end[i] = side == 0 ? std::max(end[i], bound[i]) : std::min(end[i], bound[i]);
      }
      this->UpdateSpace(span, this->GetStored(side == 0 ? span.K + 1 : span.K) + offset);
    }
    // from beyond the neighbour layer
    const float* begin = this->GetStored(side == 0 ? span.K - 1 : span.K + 2) + offset;
    float* roots = this->Roots[side][1].data() + (span.FirstX - this->Tile.FirstX + 1);
    this->Rows.See(side == 0 ? begin : end, side == 0 ? end : begin, roots, span.Count);
    this->Hide(span, side);
  };
  for (std::int64_t n = 0; n < layers; ++n)
  {
    this->ForRows(side == 0 ? n : layers - 1 - n, serve);
  }
}
}
