// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSplineEquations.h"

#include <Eigen/Sparse>

#include <algorithm>
#include <cmath>

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
}
