// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// One function of the direction on a skull, with its standard error: the radius or the thickness.
#ifndef lacunaShapeField_h
#define lacunaShapeField_h

#include "lacunaMirrorPlane.h"
#include "lacunaShapeCovariance.h"
#include "lacunaShapeLikelihood.h"
#include "lacunaSymmetricFactorization.h"
#include "lacunaVector.h"

#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

namespace lacuna
{
/// A function of the direction that a shape may follow in part: a mean term with a factor of its own.
using ShapeExample = std::function<double(const Vec3& direction)>;

using AlignedNumbers = std::unique_ptr<double[], FreeAligned>;
/// Not initialised, aligned as matrices are.
AlignedNumbers MakeAligned(std::size_t count);

/// Sound bone that is left out and predicted.
struct VirtualHole
{
  Vec3 Middle{ 0, 0, 0 };
  std::vector<int> Places;
};

/// Of a radius (mm), half of it apart, all over the places. Those of fewer than 3 places, or of half of all, are
/// left out.
std::vector<VirtualHole> SpreadHoles(const std::vector<Vec3>& places, double radius);

/// Universal kriging of values at nodes: mean terms (1, and by choice the direction), ShapeCovariance, noise.
/// First Estimate, FindRegions, Calibrate in this order, each with a likelihood of the present state; then
/// Solve; then the rest.
class ShapeField
{
public:
  /// directions (unit), places (world mm) and values (mm) of the nodes. example, if any: a further mean term.
  ShapeField(const std::vector<Vec3>& directions, std::vector<Vec3> places,
    std::vector<double> values, bool withDirection, ShapeExample example = {});

  /// Of some nodes.
  ShapeLikelihood MakeLikelihood(const std::vector<int>& subset) const;
  std::vector<Vec3> GetPlaces(const std::vector<int>& subset) const;
  const std::vector<Vec3>& GetPlaces() const { return this->Places; }

  /// Takes variances and regions of another one.
  void Continue(const ShapeField& other);
  void Estimate(const ShapeLikelihood& likelihood, int iterations)
  {
    this->Variances = likelihood.Estimate(this->Variances, iterations);
  }
  /// Whether the values follow the example: its factor is positive beyond doubt, and not that of mere noise.
  bool IsLikeExample(const ShapeLikelihood& likelihood) const;
  /// Finds how rough the skull is in each region: how far errors of virtual holes there exceed the predicted
  /// ones. holes: lists of places of the likelihood.
  void FindRegions(const ShapeLikelihood& likelihood, const std::vector<VirtualHole>& holes,
    const MirrorPlane& plane);
  /// Stretches standard errors so that 95 % of the errors of these holes are within 1.96 of them.
  void Calibrate(const ShapeLikelihood& likelihood, const std::vector<VirtualHole>& holes);

  /// reach: no two places that are looked at, nor their mirror images, are farther apart, mm. Throws
  /// std::runtime_error when nodes coincide.
  void Solve(const MirrorPlane& plane, double reach);

  /// Covariances of a place with all nodes, and what follows of them.
  void GetCovariances(const Vec3& place, double* covariances) const;
  double GetMean(const Vec3& direction, const double* covariances) const;
  /// solved: L^-1 covariances, with the factors L. The standard error of a value with its noise.
  double GetError(const Vec3& direction, const Vec3& place, const double* solved) const;
  const SquareMatrix& GetFactors() const { return *this->Factors; }

  const ShapeVariances& GetVariances() const { return this->Variances; }
  /// Of the example; 0 without one.
  double GetExampleFactor() const { return this->Example ? this->MeanFactors.back() : 0; }

private:
  struct Region
  {
    Vec3 Middle;
    Vec3 Mirrored;
    double Square; ///< mean squared ratio of errors
  };
  void SetRegions(std::vector<Region> regions);
  /// What multiplies the standard deviations of RoughLengths at a place, about 1.
  double GetRoughness(const Vec3& place) const;

  std::size_t GetNumberOfTerms() const
  {
    return (this->WithDirection ? 4 : 1) + (this->Example ? 1 : 0);
  }
  void AppendTerms(const Vec3& direction, std::vector<double>& terms) const;

  bool WithDirection;
  ShapeExample Example;
  std::vector<Vec3> Places;
  std::vector<double> Values;
  std::vector<double> Roughness;
  std::vector<double> Terms;
  ShapeVariances Variances;
  std::vector<Region> Regions;
  double Calibration = 1;

  MirrorPlane Plane;
  std::vector<ShapePlace> Nodes;
  std::unique_ptr<ShapeCovariance> Covariance;
  std::unique_ptr<SquareMatrix> Factors;
  AlignedNumbers Means;   ///< L^-1 of the mean terms, one after the other, and of the values
  AlignedNumbers Weights; ///< K^-1 (y - H b)
  std::vector<double> MeanFactors;
  std::vector<double> MeanCovariance;
};
}
#endif
