// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Which variances, and which plane of symmetry, make what is seen of a skull most likely.
#ifndef lacunaShapeLikelihood_h
#define lacunaShapeLikelihood_h

#include "lacunaExecution.h"
#include "lacunaShapeCovariance.h"
#include "lacunaSymmetricFactorization.h"

#include <cstddef>
#include <utility>
#include <vector>

namespace lacuna
{
/// Lower triangle of a Cholesky factorization in place (dpotrf). False when the matrix is not positive
/// definite.
bool FactorCholesky(SquareMatrix& matrix);
/// Lower triangle of the inverse, in place, of the matrix that FactorCholesky factored (dpotri).
void InvertCholesky(SquareMatrix& factors);
/// Solves L X = X in place for columns of the matrix's size, one after the other (dtrtrs). columns is
/// aligned as matrices are.
void SolveCholeskyLower(const SquareMatrix& factors, double* columns, int count);
/// The same for L^T x = x and one column.
void SolveCholeskyUpper(const SquareMatrix& factors, double* column);

/// Values at places of a skull: a sum of mean terms with unknown factors, of a ShapeCovariance, and of noise.
/// Restricted likelihood: Patterson and Thompson, Biometrika 58, 1971.
class ShapeLikelihood
{
public:
  /// places: world mm. terms: place after place, as many for each. roughness: of each place, what multiplies
  /// its noise and the standard deviations of RoughLengths. Memory: 8 n^2 doubles.
  ShapeLikelihood(std::vector<Vec3> places, std::vector<double> values, std::vector<double> terms,
    std::vector<double> roughness);

  /// Sets the plane of symmetry. To be called first.
  void SetPlane(const MirrorPlane& plane, Execution& execution);

  /// Minus the logarithm of the restricted likelihood, but for a constant; infinite where the covariance is
  /// not positive definite.
  double Evaluate(const ShapeVariances& variances) const;

  /// Raises the likelihood by multiplying variances, which stay positive. The factors are the squares of those
  /// with which each iteration is known to raise it: where these converge the squares do, in half the time.
  /// Zhou et al., MM algorithms for variance components models, J. Comput. Graph. Stat. 28, 2019.
  /// Throws std::runtime_error when the places do not determine the factors of the mean terms.
  ShapeVariances Estimate(const ShapeVariances& start, int iterations) const;

  /// |error| / standard error at each place of a hole when none of its places is used, for each of some
  /// holes, which are lists of places. An empty list for a hole without which the others do not determine
  /// the mean.
  std::vector<std::vector<double>> LeaveOut(
    const ShapeVariances& variances, const std::vector<std::vector<int>>& holes) const;

  /// The factor of the last mean term by generalised least squares, and its standard error. {0, infinity} when the
  /// places do not determine it.
  std::pair<double, double> GetLastFactor(const ShapeVariances& variances) const;

private:
  std::size_t GetNumberOfTerms() const { return this->Terms.size() / this->Values.size(); }
  double GetFactor(std::size_t length, std::size_t i, std::size_t j) const
  {
    return length < RoughLengths ? this->Roughness[i] * this->Roughness[j] : 1;
  }
  // K, its factor in place, and the factor of [H y]^T K^-1 [H y]
  bool Factor(const ShapeVariances& variances, SquareMatrix& matrix, SquareMatrix& small) const;
  // P = K^-1 - K^-1 H (H^T K^-1 H)^-1 H^T K^-1 (lower triangle) and P y
  void Project(
    const ShapeVariances& variances, SquareMatrix& matrix, std::vector<double>& py) const;

  std::vector<Vec3> Places;
  std::vector<double> Values;
  std::vector<double> Terms;
  std::vector<double> Roughness;
  std::vector<SquareMatrix> Direct; ///< correlations at each length
  std::vector<SquareMatrix> Across; ///< of the common parts
};
}
#endif
