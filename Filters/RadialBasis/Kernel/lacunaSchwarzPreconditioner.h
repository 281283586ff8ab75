// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// An approximate inverse of large interpolation matrices by domain decomposition.
#ifndef lacunaSchwarzPreconditioner_h
#define lacunaSchwarzPreconditioner_h

#include "lacunaFastRadialSum.h"
#include "lacunaRadialSystem.h"
#include "lacunaSymmetricFactorization.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace lacuna
{
class Execution;

/// An orthonormal basis of the polynomials at nodes.
class PolynomialProjection
{
public:
  template <int Dimension>
  PolynomialProjection(const RadialPolynomial<Dimension>& polynomial,
    const std::vector<typename RadialPolynomial<Dimension>::Point>& nodes);

  /// Takes away the part of a vector that is a polynomial at the nodes.
  void Remove(std::vector<double>& vector) const;
  /// Coefficients of the monomials of that part.
  std::vector<double> GetCoefficients(const std::vector<double>& vector) const;

private:
  std::vector<std::vector<double>> Basis;
  std::vector<std::vector<double>> Triangle; // monomial j = sum_k Triangle[j][k] Basis[k]
};

/// Multilevel restricted additive Schwarz (Beatson, Light & Billings 2000; Cai & Sarkis 1999): nodes
/// are divided into groups; for each the equations of the group and what surrounds it are solved, and
/// the group's weights kept. What is left of the right-hand side is passed on to a coarser set of
/// nodes, of which the coarsest is solved exactly. All weights satisfy the side conditions.
template <int Dimension>
class SchwarzPreconditioner
{
public:
  using Point = std::array<double, Dimension>;

  /// Throws std::runtime_error when the equations of the coarsest nodes are singular.
  SchwarzPreconditioner(Execution& execution, const RadialSystem<Dimension>& system);

  /// Weights that reproduce residual, which is orthogonal to the polynomials, approximately.
  std::vector<double> Apply(Execution& execution, const std::vector<double>& residual);

  /// What the preconditioner of a system of n nodes will need.
  static double EstimateBytes(std::size_t n);

private:
  struct Domain
  {
    std::vector<std::uint32_t> Nodes; // of the level, the group's own first
    std::uint32_t Own;
    /// The group's rows of the inverse, in single precision: it is but a preconditioner.
    std::vector<float> Inverse;
  };
  struct Level
  {
    std::vector<std::uint32_t> Indices; // in the level above; empty for the finest
    std::vector<Point> Nodes;
    std::vector<double> Diagonal;
    std::unique_ptr<PolynomialProjection> Projection;
    std::vector<Domain> Domains;
    std::unique_ptr<FastRadialSum<Dimension>> ToNext; // sums at the nodes of the level below
  };

  void Invert(const Level& level, Domain& domain) const;
  std::vector<double> SolveDomains(
    Execution& execution, const Level& level, const std::vector<double>& residual) const;

  const RadialSystem<Dimension>& System;
  std::vector<Level> Levels;
  std::unique_ptr<SymmetricFactorization> Coarsest;
};
}
#endif
