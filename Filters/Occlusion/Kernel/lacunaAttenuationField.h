// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What rays are weakened by: an attenuation coefficient per voxel.
#ifndef lacunaAttenuationField_h
#define lacunaAttenuationField_h

#include "lacunaExecution.h"
#include "lacunaVector.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

namespace lacuna
{
/// Linear attenuation coefficients (per mm), constant over each voxel of a regular grid, 4 bytes
/// per voxel. Around the grid lies a border of one empty voxel, so that loops over rays need no
/// special cases there. Voxels outside the reconstruction space hold OutsideSpace().
class AttenuationField
{
public:
  /// All voxels empty. dimensions >= 1; at most the third may be 1 (a 2-D image, in the xy plane),
  /// spacing > 0 in mm. Throws std::invalid_argument otherwise, std::bad_alloc when out of memory.
  AttenuationField(const std::array<std::int64_t, 3>& dimensions, const Vec3& spacing);

  /// A zero that can be told from zero by its sign: attenuates nothing, ends a ray.
  static float OutsideSpace() { return -0.0F; }
  static bool IsOutsideSpace(float value) { return std::signbit(value); }

  const std::array<std::int64_t, 3>& GetDimensions() const { return this->Dimensions; }
  const Vec3& GetSpacing() const { return this->Spacing; }
  bool IsFlat() const { return this->Flat; }
  double GetShortestEdge() const;
  std::int64_t GetNumberOfVoxels() const;

  /// Voxel (0, j, k); the row continues at the following addresses.
  float* Row(std::int64_t j, std::int64_t k);
  const float* Row(std::int64_t j, std::int64_t k) const;
  /// From a voxel to its neighbour in y and z, in floats.
  std::int64_t GetStride(int axis) const { return this->Strides[axis]; }

  /// Swaps the x and the y axis: dimensions, spacing and values, in place.
  void SwapXY(Execution& execution);

private:
  std::array<std::int64_t, 3> Dimensions;
  std::array<std::int64_t, 3> Strides;
  Vec3 Spacing;
  bool Flat;
  std::vector<float> Values;
};

/// Swaps the x and y axes of planes layers of nx * ny values in place; one plane of extra memory
/// per thread.
/// Value is float, std::uint32_t or std::uint64_t.
template <class Value>
void SwapXY(Value* values, std::int64_t nx, std::int64_t ny, std::int64_t planes, Execution&);
}
#endif
