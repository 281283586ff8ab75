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
  Layer layer{};
  layer.ShiftX = static_cast<std::int64_t>(std::floor(x));
  layer.ShiftY = static_cast<std::int64_t>(std::floor(y));
  const double fx = x - std::floor(x);
  const double fy = y - std::floor(y);
  layer.FractionX = static_cast<float>(fx);
  layer.FractionY = static_cast<float>(fy);

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
    const int voxel = (fx + this->SlopeX * middle > 0.5 ? 1 : 0) +
      (fy + this->SlopeY * middle > 0.5 ? 2 : 0);
    layer.Lengths[voxel] += static_cast<float>(this->Step * (cuts[i + 1] - cuts[i]));
  }
  return layer;
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
/// The rays of the tile that pass the grid in a layer.
struct TileMarch::Span
{
  LinePath::Layer Layer;
  std::int64_t Index; ///< of the layer
  std::int64_t FirstX;
  std::int64_t Count;
};

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
  this->Height = tile.LastY - this->FirstRow;
  this->Width = tile.LastX - tile.FirstX + 1;
  const double half = 0.5 * line.GetStep();
  this->OwnHalf = static_cast<float>(this->Radius > 0 ? std::min(half, this->Radius) : half);
  for (std::vector<float>& through : this->Through)
  {
    through.resize(this->Width);
  }
  this->Windowed ? this->MarchWindowed() : this->MarchWhole();
}

float* TileMarch::State(std::vector<float>& plane, std::int64_t q, std::int64_t x)
{
  return plane.data() + (q - this->FirstRow) * this->Width + (x - this->Tile.FirstX + 1);
}

const float* TileMarch::Stored(std::int64_t plane, std::int64_t q, std::int64_t x) const
{
  return this->Store.data() + (plane * this->Height + q - this->FirstRow) * this->Width +
    (x - this->Tile.FirstX + 1);
}

/// see(span, q, through) computes what the rays of row q let through; then the voxels between rows
/// q - 1 and q are served.
template <class See>
void TileMarch::ForRows(std::int64_t k, float whole, See&& see)
{
  const MarchFrame& frame = *this->Frame;
  const bool flat = frame.Rows == 1;
  Span span{ this->Line->GetLayer(k), k, 0, 0 };
  const LinePath::Layer& layer = span.Layer;
  span.FirstX = std::max(this->Tile.FirstX - 1, -1 - layer.ShiftX);
  span.Count = std::min(this->Tile.LastX, frame.Length - layer.ShiftX) - span.FirstX;
  const std::int64_t firstVoxel = std::max(this->Tile.FirstX, -layer.ShiftX);
  const std::int64_t voxels =
    std::min(this->Tile.LastX, frame.Length - layer.ShiftX) - firstVoxel;
  if (span.Count <= 0)
  {
    return;
  }
  const std::int64_t firstRow = flat ? 0 : std::max(this->FirstRow, -1 - layer.ShiftY);
  const std::int64_t lastRow = std::min(this->Tile.LastY, frame.Rows - layer.ShiftY);
  for (std::int64_t q = firstRow; q < lastRow; ++q)
  {
    std::swap(this->Through[0], this->Through[1]);
    float* through = this->Through[1].data() + (span.FirstX - this->Tile.FirstX + 1);
    see(span, q, through);
    const std::int64_t j = q + layer.ShiftY;
    if (whole > 0 && voxels > 0 && j >= 0 && q >= this->Tile.FirstY)
    {
      const std::int64_t i = firstVoxel + layer.ShiftX;
      const std::int64_t offset = firstVoxel - this->Tile.FirstX + 1;
      const float* above = this->Through[1].data() + offset;
      const float* below = flat ? above : this->Through[0].data() + offset;
      this->Rows.Hide(
        frame.Hidden + k * frame.HiddenLayerStride + j * frame.HiddenRowStride + i,
        frame.FieldAt(i, j, k), this->OwnHalf, below, above, layer.FractionX, layer.FractionY,
        whole, voxels);
    }
  }
}

/// Two passes: the whole path of each ray, then, with the path so far, what both directions see.
void TileMarch::MarchWhole()
{
  const MarchFrame& frame = *this->Frame;
  const std::int64_t next = frame.Rows == 1 ? 0 : 1;
  this->Total.assign(this->Width * this->Height, 0);
  this->Path.assign(this->Width * this->Height, 0);
  for (std::int64_t k = 0; k < frame.Layers; ++k)
  {
    this->ForRows(k, 0,
      [&](const Span& span, std::int64_t q, float*)
      {
        const std::int64_t i = span.FirstX + span.Layer.ShiftX;
        const std::int64_t j = q + span.Layer.ShiftY;
        float* path = this->State(this->Total, q, span.FirstX);
        this->Rows.AddPath(path, path, frame.FieldAt(i, j, k), frame.FieldAt(i, j + next, k),
          span.Layer.Lengths, span.Count);
      });
  }
  for (std::int64_t k = 0; k < frame.Layers; ++k)
  {
    this->ForRows(k, 2,
      [&](const Span& span, std::int64_t q, float* through)
      {
        const std::int64_t i = span.FirstX + span.Layer.ShiftX;
        const std::int64_t j = q + span.Layer.ShiftY;
        this->Rows.SeeBothWays(this->State(this->Path, q, span.FirstX),
          this->State(this->Total, q, span.FirstX), frame.FieldAt(i, j, k),
          frame.FieldAt(i, j + next, k), span.Layer.Lengths, through, span.Count);
      });
  }
}

/// Rays that end: the path up to each plane between layers is kept, and a ray's part of it is a
/// difference of two.
void TileMarch::MarchWindowed()
{
  const double layers = static_cast<double>(this->Frame->Layers);
  const double reach = this->Radius > 0 ? this->Radius / this->Line->GetStep() : layers + 1;
  this->StorePaths();
  this->Forward(reach);
  this->Backward(reach);
}

void TileMarch::StorePaths()
{
  const MarchFrame& frame = *this->Frame;
  const std::int64_t next = frame.Rows == 1 ? 0 : 1;
  const std::int64_t plane = this->Width * this->Height;
  this->Store.resize(plane * (frame.Layers + 1));
  std::fill_n(this->Store.begin(), plane, 0.0F);
  for (std::int64_t k = 0; k < frame.Layers; ++k)
  {
    std::copy_n(this->Store.begin() + k * plane, plane, this->Store.begin() + (k + 1) * plane);
    this->ForRows(k, 0,
      [&](const Span& span, std::int64_t q, float*)
      {
        const std::int64_t i = span.FirstX + span.Layer.ShiftX;
        const std::int64_t j = q + span.Layer.ShiftY;
        float* path = const_cast<float*>(this->Stored(k + 1, q, span.FirstX));
        this->Rows.AddPath(path, path, frame.FieldAt(i, j, k), frame.FieldAt(i, j + next, k),
          span.Layer.Lengths, span.Count);
      });
  }
}

/// The path up to a place between two planes; planes are counted from the grid's first face.
void TileMarch::PathAt(double plane, const Span& span, std::int64_t q, float* path) const
{
  const double inside =
    std::min(std::max(plane, 0.0), static_cast<double>(this->Frame->Layers));
  const std::int64_t first =
    std::min(static_cast<std::int64_t>(inside), this->Frame->Layers - 1);
  const float fraction = static_cast<float>(inside - static_cast<double>(first));
  const float* a = this->Stored(first, q, span.FirstX);
  const float* b = this->Stored(first + 1, q, span.FirstX);
  for (std::int64_t i = 0; i < span.Count; ++i)
  {
    path[i] = a[i] + fraction * (b[i] - a[i]);
  }
}

/// A ray whose nearest voxel is outside the reconstruction space starts anew from here: path.
void TileMarch::UpdateSpace(const Span& span, std::int64_t q, const float* path)
{
  const LinePath::Layer& layer = span.Layer;
  const bool flat = this->Frame->Rows == 1;
  const std::int64_t j = q + layer.ShiftY + (!flat && layer.FractionY > 0.5F ? 1 : 0);
  const float* nearest = this->Frame->FieldAt(
    span.FirstX + layer.ShiftX + (layer.FractionX > 0.5F ? 1 : 0), j, span.Index);
  float* bound = this->State(this->Bound, q, span.FirstX);
  for (std::int64_t i = 0; i < span.Count; ++i)
  {
    bound[i] = AttenuationField::IsOutsideSpace(nearest[i]) ? path[i] : bound[i];
  }
}

void TileMarch::Forward(double reach)
{
  const std::int64_t plane = this->Width * this->Height;
  this->Path.resize(this->Width);
  this->Bound.assign(plane, 0);
  for (std::int64_t k = 0; k < this->Frame->Layers; ++k)
  {
    this->ForRows(k, 1,
      [&](const Span& span, std::int64_t q, float* through)
      {
        float* from = this->Path.data();
        this->PathAt(static_cast<double>(k) + 0.5 - reach, span, q, from);
        if (this->Space)
        {
          const float* bound = this->State(this->Bound, q, span.FirstX);
          for (std::int64_t i = 0; i < span.Count; ++i)
          {
            from[i] = std::max(from[i], bound[i]);
          }
          this->UpdateSpace(span, q, this->Stored(k + 1, q, span.FirstX));
        }
        this->Rows.See(this->Stored(k, q, span.FirstX), from, through, span.Count);
      });
  }
}

void TileMarch::Backward(double reach)
{
  const std::int64_t plane = this->Width * this->Height;
  this->Bound.assign(this->Store.end() - plane, this->Store.end());
  for (std::int64_t k = this->Frame->Layers - 1; k >= 0; --k)
  {
    this->ForRows(k, 1,
      [&](const Span& span, std::int64_t q, float* through)
      {
        float* to = this->Path.data();
        this->PathAt(static_cast<double>(k) + 0.5 + reach, span, q, to);
        if (this->Space)
        {
          const float* bound = this->State(this->Bound, q, span.FirstX);
          for (std::int64_t i = 0; i < span.Count; ++i)
          {
            to[i] = std::min(to[i], bound[i]);
          }
          this->UpdateSpace(span, q, this->Stored(k, q, span.FirstX));
        }
        this->Rows.See(to, this->Stored(k + 1, q, span.FirstX), through, span.Count);
      });
  }
}
}
