// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaOcclusionTile.h"

#include "lacunaAttenuationField.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace lacuna
{
namespace
{
template <class Value>
void Prefetch(const Value* first, std::int64_t n)
{
#if defined(__GNUC__)
  constexpr std::int64_t Line = 16; // floats
  for (std::int64_t i = 0; i < n; i += Line)
  {
    __builtin_prefetch(first + i);
  }
#endif
}
}

//------------------------------------------------------------------------------
LinePath::LinePath(
  double slopeX, double slopeY, double offsetX, double offsetY, double step, std::int64_t layers)
  : SlopeX(slopeX)
  , SlopeY(slopeY)
  , OffsetX(offsetX)
  , OffsetY(offsetY)
  , Step(step)
{
  this->Layers.reserve(layers);
  for (std::int64_t k = 0; k < layers; ++k)
  {
    const double fromMiddle = static_cast<double>(k) - 0.5 * static_cast<double>(layers - 1);
    this->Layers.push_back(
      this->GetLayerAt(offsetX + slopeX * fromMiddle, offsetY + slopeY * fromMiddle));
  }
}

LinePath::Layer LinePath::GetNeighborLayer(int side) const
{
  return this->GetLayerAt(side * this->SlopeX, side * this->SlopeY);
}

LinePath::Layer LinePath::GetLayerAt(double x, double y) const
{
  const double fx = x - std::floor(x);
  const double fy = y - std::floor(y);
  Layer layer{ static_cast<std::int64_t>(std::floor(x)), static_cast<std::int64_t>(std::floor(y)),
    static_cast<float>(fx), static_cast<float>(fy), {} };
  // Over the layer, -1/2 <= t <= 1/2, the ray is at (fx + SlopeX t, fy + SlopeY t). It changes
  // voxel where that is 1/2, at most once in x and once in y.
  const auto change = [](double fraction, double slope)
  {
    const double t = slope != 0 ? (0.5 - fraction) / slope : 1;
    return std::abs(t) < 0.5 ? t : 0.5;
  };
  const double changeX = change(fx, this->SlopeX);
  const double changeY = change(fy, this->SlopeY);
  const double cuts[4] = { -0.5, std::min(changeX, changeY), std::max(changeX, changeY), 0.5 };
  for (int i = 0; i < 3; ++i)
  {
    const double middle = 0.5 * (cuts[i] + cuts[i + 1]);
    layer.Parts[i] = { fx + this->SlopeX * middle > 0.5 ? 1 : 0,
      fy + this->SlopeY * middle > 0.5 ? 1 : 0,
      static_cast<float>(this->Step * PathPerAttenuation * (cuts[i + 1] - cuts[i])) };
  }
  return layer;
}

void LinePath::GetRays(int axis, std::int64_t length, std::int64_t& first, std::int64_t& last) const
{
  // Voxel i lies between the rays i - shift - 1 and i - shift.
  const double slope = axis == 0 ? this->SlopeX : this->SlopeY;
  const double offset = axis == 0 ? this->OffsetX : this->OffsetY;
  const double reach = 0.5 * std::abs(slope) * static_cast<double>(this->Layers.size() - 1);
  first = -static_cast<std::int64_t>(std::floor(offset + reach));
  last = length - static_cast<std::int64_t>(std::floor(offset - reach));
}

//------------------------------------------------------------------------------
TileMarch::TileMarch(const MarchOptions& options)
  : Options(options)
  , Rows(GetOcclusionRows(options.Binary))
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
  this->Zero.resize(this->Width);
  for (int side : { 0, 1 })
  {
    this->Seen[side].resize(this->Width);
    this->Between[side].resize(this->Width);
    this->Neighbors[side] = line.GetNeighborLayer(side == BeforeSide ? -1 : 1);
  }
  const double step = line.GetStep();
  const double radius = this->Options.Radius > 0 ? this->Options.Radius : 2 * step;
  this->OwnHalf = static_cast<float>(PathPerAttenuation * std::min(0.5 * step, radius));
  for (int side : { BeforeSide, AfterSide })
  {
    // the next layer as far as the radius reaches
    auto reach = static_cast<float>(PathPerAttenuation * std::max(0.0, radius - 0.5 * step));
    LinePath::Part* parts = this->Neighbors[side].Parts;
    for (int p : { 0, 1, 2 })
    {
      LinePath::Part& part = parts[side == AfterSide ? p : 2 - p];
      part.Length = std::min(part.Length, reach);
      reach -= part.Length;
    }
  }
  if (this->Options.Radius > 0 || this->Options.Space)
  {
    this->StorePaths();
    this->MarchWindowed(BeforeSide);
    this->MarchWindowed(AfterSide);
  }
  else if (this->Options.Binary)
  {
    this->MarchBinary();
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
  return this->Store.data() + plane * this->Plane;
}

/// The first row of rays that pass layer k, none of them if there is none.
TileMarch::Span TileMarch::GetSpan(std::int64_t k) const
{
  const LinePath::Layer& layer = this->Line->GetLayer(k);
  const MarchFrame& frame = *this->Frame;
  const std::int64_t firstX = std::max(this->Tile.FirstX - 1, -1 - layer.ShiftX);
  const std::int64_t lastX = std::min(this->Tile.LastX, frame.Length - layer.ShiftX);
  const std::int64_t firstY = frame.Rows == 1 ? 0 : std::max(this->FirstRow, -1 - layer.ShiftY);
  return { layer, k, firstY, firstX, std::max<std::int64_t>(0, lastX - firstX) };
}

/// Where the rows of rays end that pass the layer of first.
std::int64_t TileMarch::GetEndOfRows(const Span& first) const
{
  const std::int64_t last = std::min(this->Tile.LastY, this->Frame->Rows - first.Layer.ShiftY);
  return first.Count > 0 ? last : first.Q;
}

template <class Body>
void TileMarch::ForRows(std::int64_t k, Body&& body)
{
  Span span = this->GetSpan(k);
  for (const std::int64_t last = this->GetEndOfRows(span); span.Q < last; ++span.Q)
  {
    body(span);
  }
}

/// All rows of rays from first on; ahead is the layer to be passed next, as seen from first's.
LayerRays TileMarch::GetRays(const Span& first, std::int64_t ahead) const
{
  const MarchFrame& frame = *this->Frame;
  return { this->GetCrossing(first.Layer, first.FirstX, first.Q, first.K), first.Count,
    this->GetEndOfRows(first) - first.Q, this->Width, frame.FieldRowStride,
    ahead * frame.FieldLayerStride + (frame.Rows == 1 ? 0 : frame.FieldRowStride) };
}

/// What rays meet in a layer, the first one being layer's from voxel (i, j) of layer k.
LayerCrossing TileMarch::GetCrossing(
  const LinePath::Layer& layer, std::int64_t i, std::int64_t j, std::int64_t k) const
{
  const float* first = this->Frame->FieldAt(i + layer.ShiftX, j + layer.ShiftY, k);
  const LinePath::Part* parts = layer.Parts;
  const std::int64_t stride = this->Frame->FieldRowStride;
  return { { first + parts[0].X + parts[0].Y * stride, first + parts[1].X + parts[1].Y * stride,
             first + parts[2].X + parts[2].Y * stride },
    { parts[0].Length, parts[1].Length, parts[2].Length } };
}

/// Rows lie too far apart for the processor to foresee them: asks for what the rays of span meet in
/// layer k, about the time of a layer ahead.
void TileMarch::Foresee(const Span& span, std::int64_t k) const
{
  const MarchFrame& frame = *this->Frame;
  if (k < 0 || k >= frame.Layers)
  {
    return;
  }
  const std::int64_t i = std::max<std::int64_t>(0, span.FirstX + span.Layer.ShiftX);
  const std::int64_t j = span.Q + span.Layer.ShiftY;
  Prefetch(frame.FieldAt(i, std::min(frame.Rows - 1, j + 1), k), span.Count);
  const std::int64_t row = std::max<std::int64_t>(0, j);
  Prefetch(
    frame.Hidden + k * frame.HiddenLayerStride + row * frame.HiddenRowStride + i, span.Count);
}

/// Adds a layer to the path of each ray.
void TileMarch::Advance(float* plane, std::int64_t k)
{
  const Span first = this->GetSpan(k);
  this->Rows.AddPath(plane + this->GetOffset(first), this->GetRays(first, 1));
}

/// What the rays of span see on one side; first and last are its first ray's.
void TileMarch::See(Sides side, const float* first, const float* last, const Span& span)
{
  const std::int64_t column = span.FirstX - this->Tile.FirstX + 1;
  this->Rows.See(first, last, this->Seen[side].data() + column, this->Between[side].data() + column,
    span.Layer.FractionY, span.Count);
}

/// Serves the voxels between the rows of rays span.Q - 1 and span.Q.
void TileMarch::Hide(const Span& span, Sides sides)
{
  const MarchFrame& frame = *this->Frame;
  const LinePath::Layer& layer = span.Layer;
  const std::int64_t first = std::max(this->Tile.FirstX, -layer.ShiftX);
  const std::int64_t count = std::min(this->Tile.LastX, frame.Length - layer.ShiftX) - first;
  const std::int64_t j = span.Q + layer.ShiftY;
  if (count <= 0 || j < 0 || span.Q < this->Tile.FirstY)
  {
    return;
  }
  const std::int64_t i = first + layer.ShiftX;
  const auto getSide = [&](Sides side) -> OcclusionRows::Side
  {
    const float* between = this->Between[side].data() + (first - this->Tile.FirstX + 1);
    if (!this->Options.Binary)
    {
      return { between, {} };
    }
    return { between,
      this->GetCrossing(
        this->Neighbors[side], i, j, side == BeforeSide ? span.K - 1 : span.K + 1) };
  };
  std::uint32_t* hidden =
    frame.Hidden + span.K * frame.HiddenLayerStride + j * frame.HiddenRowStride + i;
  const float* own = frame.FieldAt(i, j, span.K);
  const float gain = 1 / (1 - this->Options.Dilation);
  if (sides == BothSides)
  {
    this->Rows.Hide(hidden, own, this->OwnHalf, getSide(BeforeSide), getSide(AfterSide),
      layer.FractionX, gain, count);
  }
  else
  {
    this->Rows.HideSide(hidden, own, this->OwnHalf, getSide(sides), layer.FractionX, gain, count);
  }
}

/// One pass for the whole path of each ray; then back again, while the last layers are still in the
/// cache, with what both directions see.
void TileMarch::MarchWhole()
{
  const std::int64_t layers = this->Frame->Layers;
  this->Total.assign(this->Plane, 0);
  for (std::int64_t k = 0; k < layers; ++k)
  {
    this->Advance(this->Total.data(), k);
  }
  this->Path.assign(this->Plane, 0);
  for (std::int64_t k = layers - 1; k >= 0; --k)
  {
    this->PassLayer(k);
  }
}

/// What both directions see, on the way back.
void TileMarch::PassLayer(std::int64_t k)
{
  const MarchFrame& frame = *this->Frame;
  const Span first = this->GetSpan(k);
  const LinePath::Layer& layer = first.Layer;
  const std::int64_t offset = this->GetOffset(first);
  const std::int64_t column = first.FirstX - this->Tile.FirstX + 1;
  // of the voxel between the first ray and the one before, both outside
  const std::int64_t i = first.FirstX + layer.ShiftX;
  const std::int64_t j = first.Q + layer.ShiftY;
  std::uint32_t* hidden =
    frame.Hidden + (k * frame.HiddenLayerStride + j * frame.HiddenRowStride + i);
  this->Rows.Pass(
    { this->GetRays(first, -1), this->Path.data() + offset, this->Total.data() + offset,
      this->Seen[AfterSide].data() + column, this->Seen[BeforeSide].data() + column,
      layer.FractionY, layer.FractionX, frame.FieldAt(i, j, k), this->OwnHalf, hidden,
      frame.HiddenRowStride, -frame.HiddenLayerStride, frame.Rows == 1 });
}

/// The same in Binary mode: the layer before and the one after are left to the voxels' own rays.
/// In one order, so that a path that ends is exactly the total.
void TileMarch::MarchBinary()
{
  const std::int64_t layers = this->Frame->Layers;
  this->Total.assign(this->Plane, 0);
  for (std::int64_t k = 0; k < layers; ++k)
  {
    this->Advance(this->Total.data(), k);
  }
  this->Before.assign(this->Plane, 0);
  this->Path.assign(this->Plane, 0);
  this->Advance(this->Path.data(), 0);
  for (std::int64_t k = 0; k < layers; ++k)
  {
    if (k >= 2)
    {
      this->Advance(this->Before.data(), k - 2);
    }
    if (k + 1 < layers)
    {
      this->Advance(this->Path.data(), k + 1);
    }
    this->ForRows(k,
      [&](const Span& span)
      {
        const std::int64_t offset = this->GetOffset(span);
        this->Foresee(span, k + 1);
        this->See(BeforeSide, this->Zero.data(), this->Before.data() + offset, span);
        this->See(AfterSide, this->Path.data() + offset, this->Total.data() + offset, span);
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

/// What lies at lower layers in ascending order, at higher ones in descending order.
void TileMarch::MarchWindowed(Sides side)
{
  const std::int64_t layers = this->Frame->Layers;
  const double all = static_cast<double>(layers) + 1;
  const double reach =
    this->Options.Radius > 0 ? this->Options.Radius / this->Line->GetStep() : all;
  const float* start = this->GetStored(side == BeforeSide ? 0 : layers);
  this->Bound.assign(start, start + this->Plane);
  this->End.resize(this->Width);
  float* end = this->End.data();
  const auto serve = [&](const Span& span)
  {
    const std::int64_t offset = this->GetOffset(span);
    const double middle = static_cast<double>(span.K) + 0.5;
    this->PathAt(side == BeforeSide ? middle - reach : middle + reach, span, end);
    if (this->Options.Space)
    {
      const float* bound = this->Bound.data() + offset;
      for (std::int64_t i = 0; i < span.Count; ++i)
      {
        end[i] = side == BeforeSide ? std::max(end[i], bound[i]) : std::min(end[i], bound[i]);
      }
      this->UpdateSpace(span, this->GetStored(side == BeforeSide ? span.K + 1 : span.K) + offset);
    }
    this->Foresee(span, side == BeforeSide ? span.K + 1 : span.K - 1);
    const std::int64_t exact = this->Options.Binary ? 1 : 0;
    const std::int64_t plane = side == BeforeSide ? std::max<std::int64_t>(0, span.K - exact)
                                                  : std::min(layers, span.K + 1 + exact);
    const float* begin = this->GetStored(plane) + offset;
    this->See(side, side == BeforeSide ? end : begin, side == BeforeSide ? begin : end, span);
    this->Hide(span, side);
  };
  for (std::int64_t n = 0; n < layers; ++n)
  {
    this->ForRows(side == BeforeSide ? n : layers - 1 - n, serve);
  }
}
}
