// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The inner loops of occluded angles: operations on rows of rays and of voxels.
#ifndef lacunaOcclusionRows_h
#define lacunaOcclusionRows_h

#include <cstdint>
#include <vector>

namespace lacuna
{
/// Paths are attenuations in doublings: a path x lets 2^-x through. 1 / ln 2 of these are one in
/// the usual attenuation.
constexpr double PathPerAttenuation = 1.4426950408889634;

/// Hidden fractions are added up as whole numbers of so many units in one, so that their sum is exact
/// and does not depend on its order. A fraction, up to 2 for both directions of a line, is as exact
/// as in a float.
constexpr float HiddenUnits = 4194304; // 2^22

/// The fractions of so many lines fit into a sum of 32 bits.
constexpr int LinesPerSum = 511;

/// The voxels that a row of parallel rays passes in one layer: ray i passes Voxels[v][i], up to
/// three of them, and adds Weights[v] of their attenuation to its path.
struct LayerCrossing
{
  const float* Voxels[3];
  float Weights[3];
};

/// Rows of parallel rays that pass one layer.
struct LayerRays
{
  LayerCrossing Layer; ///< of the first row
  std::int64_t Count;  ///< of rays in a row
  std::int64_t Rows;
  std::int64_t Stride;      ///< from row to row of rays
  std::int64_t FieldStride; ///< from row to row of voxels
  std::int64_t FieldAhead;  ///< to a voxel of the layer that is passed next: fetched meanwhile
};

/// Operations on rows. What is interpolated between rays is their path; in Binary mode whether they
/// are hidden, 1 where path > 0 and else 0. All implementations give the same bits.
struct OcclusionRows
{
  /// path += what the layer adds.
  void (*AddPath)(float* path, const LayerRays& rays);

  /// Not in Binary mode: what rays in a layer, both sides at once. Row after row: See of the path
  /// itself, then path += what the layer adds, then See of what remains of Total, then Hide.
  struct Passage
  {
    LayerRays Rays;
    float* Path; ///< of each ray beyond the layer
    const float* Total;
    float* After; ///< what the row of rays before saw on each side, in the end the last row
    float* Before;
    float FractionY;  ///< of the way from a row of rays to the one before
    float FractionX;  ///< of the way from ray i to ray i - 1
    const float* Own; ///< voxel i lies between the rays i - 1 and i, the first one is not served
    float Half;
    std::uint32_t* Hidden;
    std::int64_t HiddenStride; ///< from row to row of voxels
    std::int64_t HiddenAhead;  ///< as Rays.FieldAhead
    bool FirstServes;          ///< else the first row of rays has no voxels
  };
  void (*Pass)(const Passage& passage);

  /// For n rays: row = the path from first to last (at least 0), or whether it hides; between = fy of the way
  /// from there to what was in row before: the row of rays before.
  void (*See)(
    const float* first, const float* last, float* row, float* between, float fy, std::int64_t n);

  /// What voxels see on one side: voxel i lies fx of the way from ray i to ray i - 1 of Between
  /// (read from -1 on). In Binary mode the voxel's own ray hits Next first.
  struct Side
  {
    const float* Between;
    LayerCrossing Next;
  };

  /// hidden += HiddenUnits times the sum over both sides of 1 - 2^-(half * own + path); in Binary mode of 1 where own or
  /// Next attenuate, else of gain times what is between the rays, at most 1.
  void (*Hide)(std::uint32_t* hidden, const float* own, float half, const Side& before,
    const Side& after, float fx, float gain, std::int64_t n);
  /// The same for one side.
  void (*HideSide)(std::uint32_t* hidden, const float* own, float half, const Side& side, float fx,
    float gain, std::int64_t n);
};

/// The operations for this processor's widest vectors.
const OcclusionRows& GetOcclusionRows(bool binary);

/// All implementations this processor can run, the plainest first, for tests and benchmarks.
std::vector<OcclusionRows> GetAllOcclusionRows(bool binary);
}
#endif
