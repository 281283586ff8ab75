// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A smooth function of space whose zero set passes near oriented points.
#ifndef lacunaSurfaceSpline_h
#define lacunaSurfaceSpline_h

#include "lacunaRadialSum.h"
#include "lacunaSurfaceFollower.h"
#include "lacunaVector.h"

#include <array>
#include <cstddef>
#include <stdexcept>
#include <vector>

namespace lacuna
{
class Execution;

/// Points of a surface with the directions that leave the solid there.
struct OrientedPoints
{
  std::vector<Vec3> Points;  ///< mm
  std::vector<Vec3> Normals; ///< unit, outwards, as many
  /// Expected error of each point, relative to the others. Empty: all 1.
  std::vector<double> Errors;
  /// Unit directions along which the surface's slope at a point is not known: across the plane of an
  /// outline. Zero vectors for other points. Empty: all slopes are known.
  std::vector<Vec3> Free;
  /// What a function shall be at the points, mm, and its gradients. Empty: 0 and the normals.
  std::vector<double> Values;
  std::vector<Vec3> Slopes;
  /// 1 for points beside the surface, of which only the value counts; they are never held out. Their
  /// normals place radial functions only. Empty: none.
  std::vector<char> Beside;
};

struct SurfaceSplineOptions
{
  /// Cubic (r^3, the triharmonic of space) or Linear (r, the biharmonic).
  RadialKernel Kernel = RadialKernel::Cubic;
  /// Expected error of the points along the normal, mm (times Errors); 0: estimated from held-out
  /// points.
  double PointError = 0;
  /// The same for normals, as a tangent; never taken smaller than this.
  double LeastNormalError = 0;
  double Stiffness = 0;    ///< t below; 0: what predicts held-out points best
  std::size_t Nodes = 300; ///< at most, above 0
};

struct SurfaceSplineReport
{
  std::size_t Nodes = 0;  ///< points of the data that carry radial functions, two each
  double PointError = 0;  ///< mm, of points along the normal: given, or of held-out points (RMS)
  double NormalError = 0; ///< tangent of the angle, in each of two directions (RMS)
  double Stiffness = 0;
  double HeldOutError = 0; ///< RMS distance of points that a fit did not know, mm
  /// Mean of the squares by which these are missed less than by the function 0, in its standard
  /// errors: above 2 or 3 the spline is surely of use.
  double Gain = 0;
};

/// s(x) = p(x) + sum_j a_j phi(|x - c_j|), about the signed distance in mm, negative inside. p is
/// linear; the centres c_j lie in pairs before and behind some of the points (nodes), half the
/// distance of nodes away. Two layers of them can follow place and slope of a surface alike. s
/// minimises
///
///   sum_i ((s(x_i) - v_i) / (e e_i))^2 + sum_i |grad s(x_i) - n_i|^2 / g^2 + E(s) / t^2
///
/// over the coefficients, with all points, E the energy of the kernel. So gradients are data with an
/// error of their own (Carr et al. 2001 take points beside the surface instead). A tenth of
/// the points is held out at first (of outlines a quarter, in pieces of a fifth of the extent: errors
/// of a hand that draws are alike along the line). t is the value that predicts them best, e and g are the root mean
/// squares by which they are missed, in some rounds. Then all points count. Nodes are spread evenly
/// over the points.
///
/// Time grows in proportion to the number of points (up to MaximumPoints) and to the square of the
/// nodes.
class SurfaceSpline : public ImplicitFunction
{
public:
  /// So many points count with their places and normals at most, chosen evenly by their order.
  static constexpr std::size_t MaximumPoints = 100000;
  static constexpr std::size_t MaximumNormals = 15000;
  static constexpr std::size_t FewestPoints = 10;

  /// What is wrong lies in the places of the points.
  class Unsolvable : public std::runtime_error
  {
  public:
    using std::runtime_error::runtime_error;
  };

  /// Throws std::invalid_argument for fewer than FewestPoints points, numbers that are not finite,
  /// lists of different lengths and options out of range; Unsolvable when points lie in one place or
  /// on a line, or when rounding errors outweigh the equations.
  SurfaceSpline(
    Execution& execution, const OrientedPoints& data, const SurfaceSplineOptions& options);

  void Evaluate(Execution& execution, const std::vector<Vec3>& points, std::vector<double>& values,
    std::vector<Vec3>* gradients) const override;
  /// The same of up to RadialBlock points, on the calling thread.
  void EvaluateBlock(const Vec3* points, std::size_t count, double* values, Vec3* gradients) const;

  const SurfaceSplineReport& GetReport() const { return this->Report; }

private:
  class Fit;

  RadialLoops<3> Loops;
  Vec3 Origin{};
  double Scale = 1; // mm of a unit
  std::array<std::vector<double>, 3> Centers;
  std::vector<double> Coefficients;
  std::array<double, 4> Polynomial{};
  SurfaceSplineReport Report;
};
}
#endif
