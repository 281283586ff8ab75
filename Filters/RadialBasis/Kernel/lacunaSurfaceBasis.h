// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Radial functions of a spline in space as orthonormal functions.
#ifndef lacunaSurfaceBasis_h
#define lacunaSurfaceBasis_h

#include "lacunaRadialSum.h"
#include "lacunaSymmetricFactorization.h"
#include "lacunaVector.h"

#include <cstddef>
#include <memory>
#include <vector>

namespace lacuna
{
class Execution;

/// The linear polynomials, and the radial functions of centres that are orthogonal to these (the side
/// conditions of the spline), made orthonormal in the kernel's energy: a function of coefficients y has
/// the energy |y|^2, of those behind the first Terms. So a penalty on the energy is a diagonal.
///
/// Apart from SurfaceSpline, which chooses centres and what counts, since it is the algebra alone.
class SurfaceBasis
{
public:
  static constexpr int Terms = 4; ///< of the polynomial: 1, x, y, z

  /// Column after column, aligned to 64 bytes.
  class Matrix
  {
  public:
    Matrix() = default;
    Matrix(std::size_t rows, std::size_t columns);

    std::size_t GetRows() const { return this->Rows; }
    std::size_t GetColumns() const { return this->Columns; }
    double* Column(std::size_t column) { return this->Elements.get() + column * this->Rows; }
    const double* Column(std::size_t column) const
    {
      return this->Elements.get() + column * this->Rows;
    }

  private:
    std::size_t Rows = 0;
    std::size_t Columns = 0;
    std::unique_ptr<double[], FreeAligned> Elements;
  };

  /// kernel: Cubic (r^3) or Linear (-r). Throws SurfaceSpline::Unsolvable when the centres lie on a line
  /// or too close together.
  SurfaceBasis(Execution& execution, std::vector<Vec3> centers, RadialKernel kernel);

  std::size_t GetSize() const { return this->Centers.size(); } ///< functions in all
  const std::vector<Vec3>& GetCenters() const { return this->Centers; }

  /// Values of all functions at points: a row for each. With gradients as many rows follow for each
  /// derivative. The first columns are those of the polynomial.
  Matrix MakeRows(const std::vector<Vec3>& points, bool gradients) const;

  /// Of phi(|x - c_j|), from those of the functions behind the polynomial.
  std::vector<double> GetCoefficients(const std::vector<double>& solution) const;

private:
  void FillColumn(
    const std::vector<Vec3>& points, const Vec3& center, double* values, double* gradients) const;
  void Reflect(char side, char transposed, Matrix& matrix) const;

  std::vector<Vec3> Centers;
  RadialKernel Kernel;
  Matrix Reflectors; // of the polynomial at the centres: what is orthogonal to it
  std::vector<double> ReflectorScales;
  Matrix Root; // Cholesky factor of the energy
};
}
#endif
