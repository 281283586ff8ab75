// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaFaceRelief.h"

#include "lacunaExecution.h"
#include "lacunaParameterText.h"
#include "lacunaPressLayout.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <string>

#include <Eigen/Sparse>

namespace lacuna
{
namespace
{
constexpr double Stiffness = 3e-5; // of differences of control points, beside a point of each

// Control points of cubics with clamped ends of those that go on beyond them.
void ClampEnds(std::vector<Vec3>& points)
{
  const std::vector<Vec3> p = points;
  const std::size_t last = p.size() - 1;
  points[0] = (1.0 / 6) * (p[0] + 4.0 * p[1] + p[2]);
  points[1] = (1.0 / 3) * (2.0 * p[1] + p[2]);
  points[last - 1] = (1.0 / 3) * (2.0 * p[last - 1] + p[last - 2]);
  points[last] = (1.0 / 6) * (p[last] + 4.0 * p[last - 1] + p[last - 2]);
}
}

//------------------------------------------------------------------------------
UniformSplines::UniformSplines(double first, double last, int spans, bool closed)
  : First(first)
  , Step((last - first) / spans)
  , Spans(spans)
  , Closed(closed)
{
}

//------------------------------------------------------------------------------
CubicSplineSpace::Values UniformSplines::Evaluate(double x) const
{
  const double at = (x - this->First) / this->Step;
  const double span = this->Closed
    ? std::floor(at)
    : std::clamp(std::floor(at), 0.0, static_cast<double>(this->Spans - 1));
  const double t = at - span;
  const double s = 1 - t;
  const auto number =
    static_cast<std::int64_t>(span) % (this->Closed ? this->Spans : this->Spans + 1);
  return { number < 0 ? number + this->Spans : number,
    { s * s * s / 6, (3 * t * t * t - 6 * t * t + 4) / 6, (3 * s * s * s - 6 * s * s + 4) / 6,
      t * t * t / 6 } };
}

//------------------------------------------------------------------------------
CubicSplineSpace UniformSplines::GetClamped(int firstSpan, int lastSpan) const
{
  std::vector<double> interior;
  for (int k = firstSpan + 1; k < lastSpan; ++k)
  {
    interior.push_back(this->First + k * this->Step);
  }
  return { this->First + firstSpan * this->Step, interior, this->First + lastSpan * this->Step };
}

//------------------------------------------------------------------------------
SplineEquations::SplineEquations(const UniformSplines& u, const UniformSplines& v)
  : U(u)
  , V(v)
  , Bands(static_cast<std::size_t>(u.GetSize()) * static_cast<std::size_t>(v.GetSize()))
  , Right(this->Bands.size(), Vec3{ 0, 0, 0 })
{
}

//------------------------------------------------------------------------------
void SplineEquations::Add(const SplinePoint& point, double weight)
{
  const CubicSplineSpace::Values bu = this->U.Evaluate(point.Parameters[0]);
  const CubicSplineSpace::Values bv = this->V.Evaluate(point.Parameters[1]);
  Term terms[16];
  for (int k = 0; k < 16; ++k)
  {
    terms[k] = { static_cast<int>(bu.First) + k % 4, static_cast<int>(bv.First) + k / 4,
      bu.Weights[k % 4] * bv.Weights[k / 4] };
  }
  this->AddSquare(terms, 16, weight);
  for (const Term& term : terms)
  {
    Vec3& right = this->Right[this->IndexOf(term)];
    right = right + weight * term.Factor * point.Place;
  }
}

//------------------------------------------------------------------------------
void SplineEquations::AddStiffness(double weight, bool closed, int order)
{
  static constexpr double differences[4][4] = { { 1 }, { 1, -1 }, { 1, -2, 1 }, { 1, -3, 3, -1 } };
  static constexpr double often[4][4] = { {}, {}, { 1, 2, 1 }, { 1, 3, 3, 1 } };
  for (int across = 0; across <= order; ++across)
  {
    const int along = order - across;
    const int columns = this->U.GetSize() - (closed ? 0 : along);
    for (int j = 0; j + across < this->V.GetSize(); ++j)
    {
      for (int i = 0; i < columns; ++i)
      {
        Term terms[16];
        int count = 0;
        for (int n = 0; n <= across; ++n)
        {
          for (int m = 0; m <= along; ++m)
          {
            terms[count++] = { i + m, j + n, differences[along][m] * differences[across][n] };
          }
        }
        this->AddSquare(terms, count, weight * often[order][across]);
      }
    }
  }
}

//------------------------------------------------------------------------------
std::vector<Vec3> SplineEquations::Solve() const
{
  const auto size = static_cast<Eigen::Index>(this->Bands.size());
  std::vector<Eigen::Triplet<double>> entries;
  for (int k = 0; k < static_cast<int>(this->Bands.size()); ++k)
  {
    const int i = k % this->U.GetSize();
    const int j = k / this->U.GetSize();
    for (int b = 0; b < static_cast<int>(Width * Width); ++b)
    {
      const double value = this->Bands[k][b];
      if (value != 0)
      {
        const int width = Width;
        entries.emplace_back(
          k, this->IndexOf({ i + b % width - Reach, j + b / width - Reach, 0 }), value);
      }
    }
  }
  Eigen::SparseMatrix<double> matrix(size, size);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(matrix);
  Eigen::MatrixXd right(size, 3);
  for (Eigen::Index row = 0; row < size; ++row)
  {
    const Vec3& r = this->Right[static_cast<std::size_t>(row)];
    right.row(row) << r[0], r[1], r[2];
  }
  const Eigen::MatrixXd found = solver.solve(right);
  std::vector<Vec3> control;
  for (Eigen::Index row = 0; row < size; ++row)
  {
    control.push_back({ found(row, 0), found(row, 1), found(row, 2) });
  }
  return control;
}

//------------------------------------------------------------------------------
int SplineEquations::IndexOf(const Term& term) const
{
  return this->U.Wrap(term.I) + this->U.GetSize() * term.J;
}

//------------------------------------------------------------------------------
void SplineEquations::AddSquare(const Term* terms, int count, double weight)
{
  for (int a = 0; a < count; ++a)
  {
    std::array<double, Width* Width>& band = this->Bands[this->IndexOf(terms[a])];
    for (int b = 0; b < count; ++b)
    {
      band[static_cast<std::size_t>(terms[b].I - terms[a].I + Reach) +
        Width * static_cast<std::size_t>(terms[b].J - terms[a].J + Reach)] +=
        weight * terms[a].Factor * terms[b].Factor;
    }
  }
}

//------------------------------------------------------------------------------
BSplineSurface MakeClamped(const UniformSplines& u, const UniformSplines& v,
  const std::vector<Vec3>& control, int firstSpan, int lastSpan)
{
  const int columns = lastSpan - firstSpan + 3;
  const int rows = v.GetSize();
  BSplineSurface surface{ u.GetClamped(firstSpan, lastSpan), v.GetClamped(0, v.GetSpans()),
    std::vector<Vec3>(static_cast<std::size_t>(columns) * rows) };
  for (int i = 0; i < columns; ++i)
  {
    std::vector<Vec3> column;
    for (int j = 0; j < rows; ++j)
    {
      column.push_back(control[u.Wrap(firstSpan + i) + static_cast<std::size_t>(j) * u.GetSize()]);
    }
    ClampEnds(column);
    for (int j = 0; j < rows; ++j)
    {
      surface.ControlPoints[i + static_cast<std::size_t>(j) * columns] = column[j];
    }
  }
  for (int j = 0; j < rows; ++j)
  {
    const auto begin = surface.ControlPoints.begin() + static_cast<std::ptrdiff_t>(j) * columns;
    std::vector<Vec3> row(begin, begin + columns);
    ClampEnds(row);
    std::copy(row.begin(), row.end(), begin);
  }
  return surface;
}

//------------------------------------------------------------------------------
BSplineSurface FitScattered(
  const std::vector<SplinePoint>& points, const Vec2& low, const Vec2& high, double spacing)
{
  const auto count = [&](int a)
  { return std::max(1, static_cast<int>(std::ceil((high[a] - low[a]) / spacing))); };
  const UniformSplines u(low[0], high[0], count(0), false);
  const UniformSplines v(low[1], high[1], count(1), false);
  SplineEquations equations(u, v);
  const double share =
    static_cast<double>(u.GetSize()) * v.GetSize() / static_cast<double>(points.size());
  for (const SplinePoint& point : points)
  {
    equations.Add(point, share);
  }
  equations.AddStiffness(Stiffness, false, 3);
  return MakeClamped(u, v, equations.Solve(), 0, u.GetSpans());
}

//------------------------------------------------------------------------------
namespace
{
constexpr double Degrees = 180 / 3.14159265358979323846;
constexpr int ViewSteps = 2000;        // towards the steepest place, each shorter
constexpr double LargestAngle = 85;    // degrees: steeper places are not seen well enough
constexpr double GoodDistance = 0.005; // mm, of the face's points from the surface
constexpr double Refinement = 0.62;    // of the spacing of control points
constexpr double Finest = 0.6;         // of edges of the mesh and of the spacing of samples
constexpr int CoarsestSpans = 8;
constexpr double MostControlPoints = 150000;
constexpr double LargestSize = 1000; // mm

// Of all points; zero where there is no triangle.
std::vector<Vec3> FindNormals(
  const std::vector<Vec3>& points, const std::vector<Triangle>& triangles)
{
  std::vector<Vec3> normals(points.size(), Vec3{ 0, 0, 0 });
  for (const auto& [a, b, c] : triangles)
  {
    const Vec3 area = Cross(points[b] - points[a], points[c] - points[a]);
    for (const auto corner : { a, b, c })
    {
      normals[corner] = normals[corner] + area;
    }
  }
  for (Vec3& normal : normals)
  {
    normal = Normalized(normal);
  }
  return normals;
}

std::size_t FindSteepest(const std::vector<Vec3>& normals, const Vec3& view)
{
  std::size_t steepest = 0;
  double least = 2;
  for (std::size_t k = 0; k < normals.size(); ++k)
  {
    const double facing = HasDirection(normals[k]) ? -Dot(normals[k], view) : 2;
    if (facing < least)
    {
      least = facing;
      steepest = k;
    }
  }
  return steepest;
}

double Edge(const Vec3& a, const Vec3& b, double x, double y)
{
  return (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]);
}

void MarkFace(const std::vector<Vec3>& flat, const std::vector<Triangle>& triangles, double spacing,
  FaceRelief& relief)
{
  relief.Mask.assign(relief.Depths.size(), 0);
  for (const auto& [ia, ib, ic] : triangles)
  {
    const Vec3* corners[] = { &flat[ia], &flat[ib], &flat[ic] };
    double low[2];
    double high[2];
    for (int a = 0; a < 2; ++a)
    {
      const auto [least, most] =
        std::minmax({ (*corners[0])[a], (*corners[1])[a], (*corners[2])[a] });
      low[a] = std::ceil(least / spacing);
      high[a] = std::floor(most / spacing);
    }
    for (auto j = static_cast<std::int64_t>(low[1]); j <= static_cast<std::int64_t>(high[1]); ++j)
    {
      for (auto i = static_cast<std::int64_t>(low[0]); i <= static_cast<std::int64_t>(high[0]); ++i)
      {
        const double x = spacing * static_cast<double>(i);
        const double y = spacing * static_cast<double>(j);
        const double sides[] = { Edge(*corners[0], *corners[1], x, y),
          Edge(*corners[1], *corners[2], x, y), Edge(*corners[2], *corners[0], x, y) };
        const auto [least, most] = std::minmax({ sides[0], sides[1], sides[2] });
        if (least >= 0 || most <= 0)
        {
          relief.Mask[i + j * relief.Size.Columns] = 1;
        }
      }
    }
  }
  // holes are what the border of the field does not reach
  constexpr unsigned char outside = 2;
  std::vector<std::int64_t> stack{ 0 };
  relief.Mask[0] = outside;
  const std::int64_t columns = relief.Size.Columns;
  while (!stack.empty())
  {
    const std::int64_t k = stack.back();
    stack.pop_back();
    const std::int64_t steps[4][2] = { { k - 1, k % columns > 0 },
      { k + 1, k % columns + 1 < columns }, { k - columns, k >= columns },
      { k + columns, k / columns + 1 < relief.Size.Rows } };
    for (const auto& [next, isThere] : steps)
    {
      if (isThere != 0 && relief.Mask[next] == 0)
      {
        relief.Mask[next] = outside;
        stack.push_back(next);
      }
    }
  }
  for (unsigned char& mask : relief.Mask)
  {
    mask = mask == outside ? 0 : 1;
  }
}
}

//------------------------------------------------------------------------------
Vec3 FindSquareView(const std::vector<Vec3>& normals)
{
  Vec3 sum{ 0, 0, 0 };
  for (const Vec3& normal : normals)
  {
    sum = sum + normal;
  }
  Vec3 view = Normalized(-1.0 * sum);
  if (!HasDirection(view))
  {
    return { 0, 0, -1 };
  }
  // the centre of the smallest ball around the normals (Badoiu and Clarkson 2003)
  Vec3 centre = -1.0 * view;
  Vec3 best = view;
  double bestFacing = -2;
  for (int step = 1; step <= ViewSteps; ++step)
  {
    const std::size_t steepest = FindSteepest(normals, view);
    const double facing = -Dot(normals[steepest], view);
    if (facing > bestFacing)
    {
      bestFacing = facing;
      best = view;
    }
    centre = centre + (1.0 / (step + 1)) * (normals[steepest] - centre);
    if (!HasDirection(centre))
    {
      break;
    }
    view = Normalized(-1.0 * centre);
  }
  return best;
}

//------------------------------------------------------------------------------
namespace
{
struct Face
{
  const std::vector<Vec3>& Points;
  const std::vector<Triangle>& Triangles;
  std::vector<Vec3> Normals; // of points; zero where there is no triangle
  Vec3 View;
  std::vector<Vec3> Flat; // points as they are seen, in mm from the relief's first pixel

  bool HasPoint(std::size_t k) const { return HasDirection(this->Normals[k]); }
};

// The direction of pressing. Throws std::runtime_error when it does not see all of the face.
Vec3 FindView(const Face& face, FaceRelief& relief)
{
  std::vector<Vec3> used;
  std::copy_if(face.Normals.begin(), face.Normals.end(), std::back_inserter(used),
    [](const Vec3& normal) { return HasDirection(normal); });
  if (used.empty())
  {
    throw std::runtime_error("the face has no area");
  }
  const Vec3 view = FindSquareView(used);
  const std::size_t steepest = FindSteepest(face.Normals, view);
  relief.SteepestPoint = face.Points[steepest];
  relief.SteepestAngle =
    Degrees * std::acos(std::clamp(-Dot(face.Normals[steepest], view), -1.0, 1.0));
  if (!(relief.SteepestAngle <= LargestAngle))
  {
    throw std::runtime_error(
      "no direction of pressing sees all of the face: even in the best one the wall at " +
      FormatPlace({}, relief.SteepestPoint) + " mm is " +
      FormatNumber(std::round(relief.SteepestAngle)) + " degrees steep, and more than " +
      FormatNumber(LargestAngle) +
      " cannot be pressed. One mould cannot make it: make the implant in parts");
  }
  return view;
}

// Sees the face along its view, with a margin around it.
void PlaceFace(Face& face, double spacing, double margin, FaceRelief& relief)
{
  // axes: x right, y down, z the view
  const Vec3& view = face.View;
  int least = 0;
  for (int a = 1; a < 3; ++a)
  {
    least = std::abs(view[a]) < std::abs(view[least]) ? a : least;
  }
  Vec3 helper{ 0, 0, 0 };
  helper[least] = 1;
  const Vec3 right = Normalized(Cross(helper, view));
  const Vec3 down = Cross(view, right);
  constexpr double infinite = std::numeric_limits<double>::infinity();
  Vec3 low{ infinite, infinite, infinite };
  Vec3 high{ -infinite, -infinite, -infinite };
  face.Flat.assign(face.Points.size(), Vec3{ 0, 0, 0 });
  for (std::size_t k = 0; k < face.Points.size(); ++k)
  {
    if (face.HasPoint(k))
    {
      const Vec3& p = face.Points[k];
      face.Flat[k] = { Dot(p, right), Dot(p, down), Dot(p, view) };
      for (int a = 0; a < 3; ++a)
      {
        low[a] = std::min(low[a], face.Flat[k][a]);
        high[a] = std::max(high[a], face.Flat[k][a]);
      }
    }
  }
  low = low - Vec3{ margin, margin, 0 };
  high = high + Vec3{ margin, margin, 0 };
  const double width = std::max(high[0] - low[0], high[1] - low[1]);
  if (!(width <= LargestSize))
  {
    throw std::runtime_error("the face and what a mould needs around it (PlateMargin) are " +
      FormatNumber(std::round(width)) + " mm wide; the largest mould is made of " +
      FormatNumber(LargestSize) + " mm. Is the surface in mm?");
  }
  const Vec3 origin = low[0] * right + low[1] * down + low[2] * view;
  relief.ToWorld = Matrix4::FromColumns(right, down, view, origin);
  relief.Size = { static_cast<std::int64_t>(std::ceil((high[0] - low[0]) / spacing)) + 1,
    static_cast<std::int64_t>(std::ceil((high[1] - low[1]) / spacing)) + 1 };
  for (Vec3& p : face.Flat)
  {
    p = p - low;
  }
}

double GetMeanEdge(const Face& face)
{
  const std::vector<Vec3>& points = face.Points;
  double edges = 0;
  for (const auto& [a, b, c] : face.Triangles)
  {
    edges +=
      (Norm(points[b] - points[a]) + Norm(points[c] - points[b]) + Norm(points[a] - points[c])) /
      (3 * static_cast<double>(face.Triangles.size()));
  }
  return edges;
}

// The largest distance of the face's points from a surface, square to the face.
double GetDeviation(const Face& face, const BSplineSurface& surface)
{
  double deviation = 0;
  for (std::size_t k = 0; k < face.Points.size(); ++k)
  {
    if (face.HasPoint(k))
    {
      const Vec3& p = face.Flat[k];
      const double off = surface.Evaluate(p[0], p[1])[2] - p[2];
      deviation = std::max(deviation, std::abs(off * Dot(face.Normals[k], face.View)));
    }
  }
  return deviation;
}

// Refines the surface until it is near the face, or as fine as the face's triangles.
BSplineSurface FitFace(Execution& execution, const Face& face, double spacing, FaceRelief& relief)
{
  std::vector<SplinePoint> samples;
  for (std::size_t k = 0; k < face.Points.size(); ++k)
  {
    if (face.HasPoint(k))
    {
      samples.push_back({ { face.Flat[k][0], face.Flat[k][1] }, face.Flat[k] });
    }
  }
  const double edges = GetMeanEdge(face);
  const Vec2 far{ spacing * static_cast<double>(relief.Size.Columns - 1),
    spacing * static_cast<double>(relief.Size.Rows - 1) };
  BSplineSurface best;
  relief.Deviation = std::numeric_limits<double>::infinity();
  double step = std::max(far[0], far[1]) / CoarsestSpans;
  do
  {
    execution.Report(0);
    const BSplineSurface surface = FitScattered(samples, { 0, 0 }, far, step);
    const double deviation = GetDeviation(face, surface);
    if (deviation < relief.Deviation)
    {
      relief.Deviation = deviation;
      best = surface;
    }
    step *= Refinement;
  } while (relief.Deviation > GoodDistance && step > Finest * std::max(edges, spacing) &&
    far[0] * far[1] < MostControlPoints * step * step);
  return best;
}
}

//------------------------------------------------------------------------------
FaceRelief MakeFaceRelief(Execution& execution, const std::vector<Vec3>& points,
  const std::vector<Triangle>& triangles, double spacing, double margin)
{
  FaceRelief relief;
  Face face{ points, triangles, FindNormals(points, triangles), {}, {} };
  face.View = FindView(face, relief);
  PlaceFace(face, spacing, margin, relief);
  const BSplineSurface surface = FitFace(execution, face, spacing, relief);
  for (std::int64_t j = 0; j < relief.Size.Rows; ++j)
  {
    for (std::int64_t i = 0; i < relief.Size.Columns; ++i)
    {
      relief.Depths.push_back(
        surface.Evaluate(spacing * static_cast<double>(i), spacing * static_cast<double>(j))[2]);
    }
  }
  MarkFace(face.Flat, triangles, spacing, relief);
  return relief;
}
}
