// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// One line of sight direction marched through one tile of parallel rays.
#ifndef lacunaOcclusionTile_h
#define lacunaOcclusionTile_h

#include "lacunaOcclusionRows.h"

#include <cstdint>
#include <vector>

namespace lacuna
{
/// A grid seen along the axis a line runs along most steeply: layers across that axis, rows within
/// a layer, Length voxels within a row. Field has a border of one voxel around it (not across
/// rows when Rows is 1).
struct MarchFrame
{
  std::int64_t Length;
  std::int64_t Rows;
  std::int64_t Layers;
  const float* Field; ///< attenuation at voxel (0, 0, 0)
  std::int64_t FieldRowStride;
  std::int64_t FieldLayerStride;
  /// Sum over directions of the fraction that is hidden, in HiddenUnits; not bordered.
  std::uint32_t* Hidden;
  std::int64_t HiddenRowStride;
  std::int64_t HiddenLayerStride;

  const float* FieldAt(std::int64_t i, std::int64_t j, std::int64_t k) const
  {
    return this->Field + k * this->FieldLayerStride + j * this->FieldRowStride + i;
  }
};

/// Where the parallel rays of a line are. Ray (r, q) crosses the centre plane of layer k at
/// (r + ShiftX + FractionX, q + ShiftY + FractionY) in voxels: rays lie one voxel apart, and all of
/// them have the same fractions in a layer.
class LinePath
{
public:
  /// A part of a ray's way through a layer.
  struct Part
  {
    int X; ///< of its voxel, relative to the first of the four that lie around the ray: 0 or 1
    int Y;
    float Length; ///< exact, mm times PathPerAttenuation; 0 where the ray meets fewer voxels
  };

  struct Layer
  {
    std::int64_t ShiftX;
    std::int64_t ShiftY;
    float FractionX;
    float FractionY;
    Part Parts[3];
  };

  /// Slopes in voxels per layer, at most 1 in size; offsets, 0 <= o < 1, of the rays from voxel
  /// centres in the middle layer; step is the path length per layer in mm.
  LinePath(
    double slopeX, double slopeY, double offsetX, double offsetY, double step, std::int64_t layers);

  const Layer& GetLayer(std::int64_t k) const { return this->Layers[k]; }
  /// The ray through a voxel's centre one layer later (side 1) or earlier (side -1), relative to
  /// that voxel: shifts in -1, 0.
  Layer GetNeighborLayer(int side) const;
  double GetStep() const { return this->Step; }
  /// The rays that some voxel of the frame needs along its rows (axis 0) or across (1):
  /// first <= r < last.
  void GetRays(int axis, std::int64_t length, std::int64_t& first, std::int64_t& last) const;

private:
  Layer GetLayerAt(double x, double y) const;

  double SlopeX;
  double SlopeY;
  double OffsetX;
  double OffsetY;
  double Step;
  std::vector<Layer> Layers;
};

/// The voxels that lie between rays r - 1 and r, FirstX <= r < LastX, and q - 1 and q.
struct RayTile
{
  std::int64_t FirstX;
  std::int64_t LastX;
  std::int64_t FirstY;
  std::int64_t LastY;
};

/// How rays see.
struct MarchOptions
{
  bool Binary;
  double Radius;  ///< mm: rays end there; 0: they do not
  bool Space;     ///< some voxels are outside the reconstruction space
  float Dilation; ///< 0 <= d < 1, see OccludedAngleOptions
};

/// Marches tiles. Holds scratch memory: one object per thread.
class TileMarch
{
public:
  explicit TileMarch(const MarchOptions& options);

  /// Adds to frame.Hidden, for each voxel of the tile, the hidden fraction along the line in both
  /// of its directions.
  void March(const MarchFrame& frame, const LinePath& line, const RayTile& tile);

private:
  /// The part of a row of rays that passes the grid in a layer.
  struct Span
  {
    const LinePath::Layer& Layer;
    std::int64_t K; ///< of the layer
    std::int64_t Q; ///< of the row of rays
    std::int64_t FirstX;
    std::int64_t Count;
  };

  enum Sides
  {
    BeforeSide = 0,
    AfterSide = 1,
    BothSides = 2
  };
  void MarchWhole();
  void MarchBinary();
  void MarchWindowed(Sides side);
  void StorePaths();
  void PassLayer(std::int64_t k);
  LayerCrossing GetCrossing(
    const LinePath::Layer& layer, std::int64_t i, std::int64_t j, std::int64_t k) const;
  void Foresee(const Span& span, std::int64_t k) const;
  void Advance(float* plane, std::int64_t k);
  void PathAt(double plane, const Span& span, float* path) const;
  void UpdateSpace(const Span& span, const float* path);
  void See(Sides side, const float* first, const float* last, const Span& span);
  void Hide(const Span& span, Sides sides);
  Span GetSpan(std::int64_t k) const;
  std::int64_t GetEndOfRows(const Span& first) const;
  LayerRays GetRays(const Span& first, std::int64_t ahead) const;
  template <class Body>
  void ForRows(std::int64_t k, Body&& body);

  std::int64_t GetOffset(const Span& span) const;
  const float* GetStored(std::int64_t plane) const;

  MarchOptions Options;
  const OcclusionRows& Rows;

  const MarchFrame* Frame = nullptr;
  const LinePath* Line = nullptr;
  RayTile Tile{};
  std::int64_t FirstRow = 0; ///< of the rays of the tile, with the neighbours that voxels need
  std::int64_t Width = 0;
  std::int64_t Plane = 0;       ///< rays of the tile
  float OwnHalf = 0;            ///< way through half of a voxel, as Part::Length
  LinePath::Layer Neighbors[2]; ///< before and after
  std::vector<float> Zero;      ///< a row
  std::vector<float> Total;     ///< path of each ray through everything
  std::vector<float> Path;      ///< beyond the layers served, in Binary mode up to the next one
  std::vector<float> Before;    ///< in Binary mode, up to the layer before
  std::vector<float> Store;     ///< up to each plane between layers
  std::vector<float> Bound;     ///< where a ray entered the space last
  std::vector<float> End;       ///< where a row of rays ends
  /// What a row of rays sees on each side, and between that row and the one before
  std::vector<float> Seen[2];
  std::vector<float> Between[2];
};
}
#endif
