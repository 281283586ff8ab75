// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Shapes grown out of incomplete data by thresholding their occluded angle again and again
/// (Carr 1996, section 5.6).
#ifndef lacunaShapeGrowth_h
#define lacunaShapeGrowth_h

#include "lacunaOccludedAngle.h"

#include <cstdint>
#include <functional>
#include <vector>

namespace lacuna
{
/// One iteration: where the occluded angle reaches Threshold, there is object for the next.
struct GrowthStep
{
  double Threshold; ///< radians or steradians, above 0
  double Radius;    ///< mm; 0: the whole reconstruction space
};

struct GrowthOptions
{
  bool Binary = false;
  int Directions = 1000;
  /// The fraction of a ray that an object voxel of the second and later iterations takes over the
  /// shortest voxel edge.
  double ObjectOpacity = 0.95;
  double Dilation = 0; ///< see OccludedAngleOptions
  /// Whether voxels of the data that are at least half opaque (opacity 0.5 over the shortest voxel
  /// edge) are object in every iteration, whatever their angle.
  bool KeepData = false;
  /// Edge length in voxels of the median filter on the angle, odd; 1: none.
  int MedianKernel = 1;
  std::vector<GrowthStep> Steps;

  /// From ObjectOpacity to MedianKernel, with the ranges.
  void Describe(Properties& properties) const;
};

/// What an iteration came to.
struct GrowthStatistics
{
  std::int64_t ObjectVoxels = 0;
  double MeanAngle = 0;          ///< over the reconstruction space
  double SuggestedThreshold = 0; ///< see SuggestThreshold; 0: none
};

/// Called after each iteration, with its number from 0.
using GrowthObserver = std::function<void(int iteration, const GrowthStatistics&)>;

/// Runs the iterations. field holds the data first, and the last iteration's object in the end.
/// angle and object (1 or 0) have a value per voxel, x fastest; they hold the last iteration's.
/// Throws std::invalid_argument when the options are wrong, see GrowthOptions and
/// ComputeOccludedAngle (also about ranks), or when no voxel of the field attenuates.
void GrowShape(AttenuationField& field, const GrowthOptions& options, float* angle,
  unsigned char* object, const GrowthObserver& observer, Execution& execution,
  const Ranks& ranks = Ranks());

/// The attenuation coefficient (per mm) that takes the fraction opacity of a ray over the shortest
/// edge of a voxel; at most GetLargestAttenuation.
double GetAttenuation(const AttenuationField& field, double opacity);

/// Attenuations are cut off here: a voxel that lets 6e-6 through is opaque.
double GetLargestAttenuation(const AttenuationField& field);

/// A threshold between inside and outside: the middle of the lowest stretch of the angle's
/// histogram between its two peaks, smoothed until there are two (Prewitt & Mendelsohn 1966).
/// counts: numbers of voxels with angles in equal bins from 0 to full. 0 when there are not two.
double SuggestThreshold(const std::vector<std::int64_t>& counts, double full);
}
#endif
