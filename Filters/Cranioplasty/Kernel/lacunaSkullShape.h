// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Outer and inner surface of the missing part of a skull, from all sound bone, with a standard error.
#ifndef lacunaSkullShape_h
#define lacunaSkullShape_h

#include "lacunaExecution.h"
#include "lacunaMirrorPlane.h"
#include "lacunaShapeCovariance.h"
#include "lacunaVector.h"

#include <cstddef>
#include <memory>
#include <vector>

namespace lacuna
{
class ShapeField;
struct SkullExamples;
struct SkullRays;
struct VirtualHole;

/// What is known of a skull, along rays from a centre within it. One element a ray in each array.
struct SoundBone
{
  Vec3 Center{ 0, 0, 0 };        ///< world mm, within 10 mm of the plane of symmetry
  std::vector<Vec3> Directions;  ///< unit
  std::vector<double> Outer;     ///< mm from the centre to the outer table
  std::vector<double> Thickness; ///< mm from there to the inner table
};

/// The skull along one ray, mm.
struct SkullEstimate
{
  double Outer = 0;      ///< from the centre to the outer table
  double OuterError = 0; ///< standard error
  double Thickness = 0;
  double ThicknessError = 0; ///< standard error
};

/// A Gaussian process (universal kriging) of two functions of the direction: the radius of the outer table
/// over an ellipsoid, and the thickness. Each is a mean, a part that both sides of the plane of symmetry
/// share, and a part of its own (ShapeCovariance); distances are those on the ellipsoid. So the other side
/// counts as far as this skull is symmetric, and fades out at the midline. The variances, and the
/// last turn and shift of the plane, are those of the greatest restricted likelihood. The standard errors are
/// calibrated by virtual holes: sound bone of the defect's size that is left out and predicted.
///
/// Results depend neither on the frame of the coordinates (but for rounding) nor on the number of threads. They
/// depend on the order of the rays, by which nodes are chosen.
/// Cressie, Statistics for Spatial Data, 1993, section 3.4 (universal kriging).
class SkullShape
{
public:
  /// defect: unit directions that cover what is missing, some mm apart. Nodes are dense near them and near
  /// their mirror images. plane: of best symmetry, within some 5 degrees and 5 mm. other: a template
  /// (PlaceTemplate), which counts as far as the sound bone is like it. likelihoodNodes: this many of the
  /// nodes, at least 200, decide on variances and plane. Their time grows with the third power (5 s of one
  /// core for 800).
  ///
  /// Throws std::invalid_argument when arrays differ in length, when elements are not finite or not positive,
  /// or when there is too little bone (fewer than 200 nodes remain).
  SkullShape(const SoundBone& bone, const std::vector<Vec3>& defect, const MirrorPlane& plane,
    Execution& execution, const SkullRays* other = nullptr, std::size_t likelihoodNodes = 800);
  ~SkullShape();
  SkullShape(const SkullShape&) = delete;
  SkullShape& operator=(const SkullShape&) = delete;

  /// Along unit directions. Takes some n^2 products for each, with n nodes: with 3000 nodes about a
  /// millisecond; errors vary slowly, so that a coarse set of directions serves for these. A thickness
  /// is never less than the least of the sound bone. Throws std::invalid_argument for a direction
  /// that is no unit vector.
  std::vector<SkullEstimate> Predict(
    const std::vector<Vec3>& directions, Execution& execution) const;
  /// The same without standard errors (0), some hundred times quicker.
  std::vector<SkullEstimate> PredictSurfaces(
    const std::vector<Vec3>& directions, Execution& execution) const;

  /// The refined plane of symmetry.
  const MirrorPlane& GetPlane() const { return this->Plane; }
  std::size_t GetNumberOfNodes() const { return this->Nodes.size(); }

  /// How far the shape of the template counts: 0 not at all, about 1 wholly.
  double GetOuterFactor() const;
  double GetThicknessFactor() const;

private:
  struct Base;
  std::vector<SkullEstimate> Predict(
    const std::vector<Vec3>& directions, bool errors, Execution& execution) const;
  void ChooseNodes(const SoundBone& bone, const std::vector<Vec3>& defect);
  void FindPlane(const SoundBone& bone, const std::vector<int>& subset, Execution& execution);
  void FindThickness(const SoundBone& bone, const std::vector<int>& subset,
    const std::vector<VirtualHole>& regions, Execution& execution);
  std::unique_ptr<ShapeField> MakeField(const SoundBone& bone, bool outer) const;
  std::vector<VirtualHole> FindHolesLike(
    const std::vector<Vec3>& defect, const std::vector<Vec3>& places) const;

  MirrorPlane Plane;
  std::unique_ptr<SkullExamples> Examples; ///< those that count
  std::unique_ptr<Base> Ellipsoid;
  std::vector<int> Nodes; ///< rays of the bone
  double LeastThickness = 0;
  std::unique_ptr<ShapeField> Outer;
  std::unique_ptr<ShapeField> Thickness;
};
}
#endif
