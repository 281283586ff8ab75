// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A face of a solid as a field of depths, seen from where it is least steep.
#ifndef lacunaFaceRelief_h
#define lacunaFaceRelief_h

#include "lacunaBSplineSurface.h"
#include "lacunaMatrix4.h"
#include "lacunaPlanarTriangulation.h"
#include "lacunaSurfaceFit.h"

#include <array>
#include <cstddef>
#include <vector>

namespace lacuna
{
class Execution;

/// A place that a surface should pass at given parameters.
struct SplinePoint
{
  Vec2 Parameters{};
  Vec3 Place{};
};

/// Cubic B-splines with equal spans, closed or with ends. The ends are not clamped, so that what is stiff is the same
/// everywhere.
class UniformSplines
{
public:
  /// Closed: last is first again.
  UniformSplines(double first, double last, int spans, bool closed);

  int GetSpans() const { return this->Spans; }
  int GetSize() const { return this->Closed ? this->Spans : this->Spans + 3; }
  /// The number of a control point that may be beyond the ends of a closed basis.
  int Wrap(int i) const { return this->Closed ? (i + this->Spans) % this->Spans : i; }
  /// x is within the interval, unless closed.
  CubicSplineSpace::Values Evaluate(double x) const;
  /// The same functions over some spans, with clamped ends.
  CubicSplineSpace GetClamped(int firstSpan, int lastSpan) const;

private:
  double First;
  double Step;
  int Spans;
  bool Closed;
};

/// The normal equations of a tensor product, as bands. Keeps references to both bases.
class SplineEquations
{
public:
  SplineEquations(const UniformSplines& u, const UniformSplines& v);

  void Add(const SplinePoint& point, double weight);
  /// Squares of all differences of an order (2 or 3) of the control points. closed: along u.
  void AddStiffness(double weight, bool closed, int order);
  /// Control points, u fastest.
  std::vector<Vec3> Solve() const;

private:
  struct Term
  {
    int I;
    int J;
    double Factor;
  };
  static constexpr int Reach = 3; // control points that a point depends on together
  static constexpr std::size_t Width = 2 * Reach + 1;

  int IndexOf(const Term& term) const;
  void AddSquare(const Term* terms, int count, double weight);

  const UniformSplines& U;
  const UniformSplines& V;
  std::vector<std::array<double, Width * Width>> Bands;
  std::vector<Vec3> Right;
};

/// The same surface, of control points of equations, over some spans along u. Beyond the ends of a closed u they go on
/// from the beginning.
BSplineSurface MakeClamped(const UniformSplines& u, const UniformSplines& v,
  const std::vector<Vec3>& control, int firstSpan, int lastSpan);

/// The surface over a rectangle of parameters that is near the points, and beyond them goes on with their
/// curvature. spacing: of control points, in parameters.
BSplineSurface FitScattered(
  const std::vector<SplinePoint>& points, const Vec2& low, const Vec2& high, double spacing);

struct FaceRelief
{
  GridSize Size;
  std::vector<double> Depths;      ///< mm, column fastest, away from the viewer
  std::vector<unsigned char> Mask; ///< 1 on the face, and where there are holes through it
  /// mm along x, y and depth from the first sample to world mm; determinant +1, z is the view.
  Matrix4 ToWorld;
  double SteepestAngle =
    0;                  ///< degrees between the view and the normal, at most, of the face's points
  Vec3 SteepestPoint{}; ///< where that is, world mm
  double Deviation = 0; ///< mm, largest distance of the face's points from the surface
};

/// The view for which the steepest place of the face is least steep. normals: unit, at points that count alike.
Vec3 FindSquareView(const std::vector<Vec3>& normals);

/// triangles: of the face, counterclockwise from outside. The smooth surface goes on beyond it by margin (mm) with its
/// curvature. spacing: mm
/// between samples. Throws std::runtime_error, with the place, when no view sees all of the face.
FaceRelief MakeFaceRelief(Execution& execution, const std::vector<Vec3>& points,
  const std::vector<Triangle>& triangles, double spacing, double margin);
}
#endif
