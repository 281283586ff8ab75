// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The surface of bone in B-scans.
#ifndef lacunaBoneEcho_h
#define lacunaBoneEcho_h

#include "lacunaBeamGrid.h"
#include "lacunaExecution.h"
#include "lacunaProperties.h"
#include "lacunaSliceImage.h"

#include <cstddef>
#include <vector>

namespace lacuna
{
struct BoneEchoOptions
{
  double ShadowLength = 10;        ///< mm behind the echo that are looked at
  double MinimumConfidence = 0.25; ///< of an echo that is bone
  double MaximumGap = 3;           ///< mm between beams with bone, which is closed; 0: none
  double MinimumArea = 50;         ///< mm^2 of a piece of bone; 0: all
  double Thickness = 4;            ///< mm that bone is shown thick

  void Describe(Properties& properties) const;
};

/// Finds bone in the slices of sweeps: an echo with a shadow behind it.
///
/// Grey levels are counted from the darkest ones (2nd percentile) to the brightest ones (99th). For each sample of a
/// beam, E is the level there, smoothed, and S the mean of the shadow: ShadowLength from 2.5 mm behind it. The
/// confidence in bone is E^0.7 (E - S) / (E + S) times the confidence in the shadow. That is high where S is far
/// darker than E, and where it is far darker than tissue at this depth: the 80th percentile of S, of all beams of the
/// sweep. So neither attenuation nor gain counts much, and a bright layer with tissue behind it is no bone.
/// In each slice the line with the largest confidence is followed (lacunaBonePath.h). Lines of neighbouring slices that
/// are close make pieces; small ones are left out. Gaps between beams are closed by straight lines.
///
/// Bone shows where something else is bright with dark behind it, too: gas, metal, the wall of a bath.
///
/// Sources: Foroughi et al., Ultrasound bone segmentation using dynamic programming, IEEE Ultrasonics Symposium 2007;
/// Pandey et al., Ultrasound bone segmentation: a scoping review of techniques and validation practices, Ultrasound in
/// Medicine and Biology 46, 2020.
class BoneEcho
{
public:
  /// slices: with pixels, windows of one size, in the order of sweeps. Throws std::invalid_argument when a slice or an
  /// option is not sound.
  BoneEcho(
    const std::vector<SliceImage>& slices, const BoneEchoOptions& options, Execution& execution);

  const BeamGrid& GetBeams() const { return this->Grid; }

  /// The sample of each beam in which bone begins; negative: none.
  const std::vector<float>& GetSurface(std::size_t slice) const { return this->Surfaces[slice]; }

  /// mm^2 of what was found, between slices; 0 of sweeps of one slice.
  double GetArea() const { return this->Area; }
  /// Beams with bone, of all slices.
  std::size_t GetNumberOfBeams() const;

  /// A slice's window: 0.5 at the surface, 1 at half of Thickness behind it, 0.5 at Thickness, 0 half a Thickness beyond
  /// either. Distances are the shortest ones to the surface in the slice.
  void Write(std::size_t slice, float* pixels, std::int64_t rowStride) const;

private:
  struct Criteria;
  class Outline;
  std::vector<float> FindLine(const SliceImage& slice, const Criteria& criteria) const;
  std::vector<float> FindShadows(const std::vector<float>& levels) const;
  Criteria Learn(const std::vector<SliceImage>& slices, Execution& execution) const;
  void DropSmallPieces(const std::vector<SliceImage>& slices);
  void CloseGaps(std::vector<float>& surface) const;

  BeamGrid Grid;
  BoneEchoOptions Options;
  std::vector<std::vector<float>> Surfaces;
  double Area = 0;
};
}
#endif
