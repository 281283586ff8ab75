// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSurfaceSpline.h"

#include "lacunaExecution.h"
#include "lacunaOutlines.h"
#include "lacunaScramble.h"
#include "lacunaSingleBlasThread.h"
#include "lacunaSurfaceBasis.h"

#include <cblas.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

// Fortran interface; the last argument is the length of the character argument.
extern "C" void dpotrf_(
  const char* uplo, const int* n, double* a, const int* lda, int* info, std::size_t);

namespace lacuna
{
namespace
{
using Matrix = SurfaceBasis::Matrix;

constexpr int Terms = SurfaceBasis::Terms;
// Of the points held out: a tenth, or where that are few a quarter.
constexpr std::size_t FewHeldOut = 50;
constexpr std::size_t MostHeldOut = 1500;
// What is taken for no error, of the extent of the points: the rounding of 32-bit coordinates.
constexpr double SmallestPointError = 1e-7;
constexpr double SmallestNormalError = 1e-4;
constexpr double LargestNormalError = 0.5; // so that normals always keep the function from being 0
constexpr double LargestMiss = 0.1;        // of the extent
constexpr int Rounds = 3;
constexpr double RunLength = 0.2; // of the extent
const char* const Outweighed =
  "the equations of the surface cannot be solved; give a larger expected "
  "error of the points";
constexpr std::size_t BlockPoints = 256;

double GetRootMeanSquare(const std::vector<double>& values)
{
  double sum = 0;
  for (const double v : values)
  {
    sum += v * v;
  }
  return values.empty() ? 0 : std::sqrt(sum / static_cast<double>(values.size()));
}

std::string DescribePoint(const Vec3& p)
{
  return "(" + std::to_string(p[0]) + ", " + std::to_string(p[1]) + ", " + std::to_string(p[2]) +
    ")";
}

void Check(const OrientedPoints& data, const SurfaceSplineOptions& options)
{
  const auto fits = [&](const auto& list)
  { return list.empty() || list.size() == data.Points.size(); };
  if (data.Normals.size() != data.Points.size() || !fits(data.Errors) || !fits(data.Free) ||
    !fits(data.Values) || !fits(data.Beside) || !fits(data.Slopes))
  {
    throw std::invalid_argument(
      "there must be as many normals, errors, directions and values as points");
  }
  if (data.Points.size() < SurfaceSpline::FewestPoints)
  {
    throw std::invalid_argument("there are " + std::to_string(data.Points.size()) +
      " points; a surface needs " + std::to_string(SurfaceSpline::FewestPoints) + " or more");
  }
  for (std::size_t i = 0; i < data.Points.size(); ++i)
  {
    if (!IsFinite(data.Points[i]) || !(std::abs(Norm(data.Normals[i]) - 1) < 1e-3))
    {
      throw std::invalid_argument("point " + std::to_string(i) + " at " +
        DescribePoint(data.Points[i]) +
        " or its normal is not finite, or this has another length "
        "than 1");
    }
    if (!data.Errors.empty() && (!(data.Errors[i] > 0) || !std::isfinite(data.Errors[i])))
    {
      throw std::invalid_argument("the error of point " + std::to_string(i) + " at " +
        DescribePoint(data.Points[i]) + " must be a finite number above 0");
    }
  }
  if (options.Kernel != RadialKernel::Cubic && options.Kernel != RadialKernel::Linear)
  {
    throw std::invalid_argument("the kernel must be r^3 or r");
  }
  for (const double x : { options.PointError, options.LeastNormalError, options.Stiffness })
  {
    if (!(x >= 0) || !std::isfinite(x))
    {
      throw std::invalid_argument("errors and stiffness must be finite numbers >= 0");
    }
  }
}
}

//------------------------------------------------------------------------------
// The least-squares problem, in units of the points' extent.
class SurfaceSpline::Fit
{
public:
  Fit(Execution& execution, const OrientedPoints& data, const SurfaceSplineOptions& options,
    const Vec3& origin, double scale)
    : Runner(execution)
    , Options(options)
    , Scale(scale)
    , Normals(data.Normals)
    , Slopes(data.Slopes.empty() ? data.Normals : data.Slopes)
    , Free(data.Free)
    , Beside(data.Beside)
  {
    this->Values.assign(data.Points.size(), 0.0);
    for (std::size_t i = 0; i < data.Values.size(); ++i)
    {
      this->Values[i] = data.Values[i] / scale;
    }
    this->Points.reserve(data.Points.size());
    for (const Vec3& point : data.Points)
    {
      this->Points.push_back((1 / scale) * (point - origin));
    }
    this->Weights.assign(data.Points.size(), 1.0);
    for (std::size_t i = 0; i < data.Errors.size(); ++i)
    {
      this->Weights[i] = 1 / data.Errors[i];
    }
    this->Share();
  }

  void Run(SurfaceSplineReport& report)
  {
    const SingleBlasThread single(this->Runner.GetNumberOfThreads());
    this->AddSpreadNodes(std::min(this->Options.Nodes, this->Known.size()));
    this->SetUp();
    double stiffness = this->Options.Stiffness > 0 ? this->Options.Stiffness : 1;
    report.HeldOutError = this->Scale * this->Tune(stiffness, report);
    report.Gain = this->GetGain(report, stiffness);
    this->Accumulate(this->HeldOut, this->HeldOut.size()); // now all points count
    this->HeldRows = Matrix();
    const std::vector<double> solution = this->Solve(report, stiffness);
    if (solution.empty())
    {
      throw Unsolvable(Outweighed);
    }
    this->Centers = this->Basis->GetCenters();
    std::copy_n(solution.begin(), Terms, this->Polynomial.begin());
    this->Coefficients = this->Basis->GetCoefficients(solution);
    report.Stiffness = stiffness;
    report.Nodes = this->Nodes.size();
  }

  std::vector<Vec3> Centers;
  std::vector<double> Coefficients;
  std::array<double, 4> Polynomial{};

private:
  // Which points count, and which of them are held out at first.
  void Share()
  {
    std::vector<std::size_t> order(this->Points.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    const auto beside = std::stable_partition(
      order.begin(), order.end(), [this](std::size_t i) { return !this->IsBeside(i); });
    const std::vector<std::size_t> others(beside, order.end());
    order.erase(beside, order.end());
    const std::size_t n = order.size();
    // Along outlines errors may be alike from point to point: runs are held out.
    const std::vector<std::size_t> runs = FindRuns(this->Points, this->Free, RunLength);
    std::sort(order.begin(), order.end(),
      [&](std::size_t a, std::size_t b)
      { return runs[a] != runs[b] ? Scramble(runs[a]) < Scramble(runs[b]) : a < b; });
    const std::size_t held = this->Free.empty()
      ? std::min(MostHeldOut, std::max(n / 10, std::min(n / 4, FewHeldOut)))
      : n / 4;
    this->HeldOut.assign(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(held));
    const std::size_t last = std::min(n, held + MaximumPoints);
    this->Known.assign(order.begin() + static_cast<std::ptrdiff_t>(held),
      order.begin() + static_cast<std::ptrdiff_t>(last));
    this->Known.insert(this->Known.end(), others.begin(), others.end());
    this->WithNormals = std::min(this->Known.size(), MaximumNormals);
    this->Distances.assign(this->Known.size(), std::numeric_limits<double>::infinity());
  }

  bool IsBeside(std::size_t point) const { return !this->Beside.empty() && this->Beside[point]; }

  // What is known of a slope at a point.
  Vec3 GetKnown(std::size_t point, const Vec3& slope) const
  {
    if (this->IsBeside(point))
    {
      return {};
    }
    return this->Free.empty() ? slope : slope - Dot(slope, this->Free[point]) * this->Free[point];
  }

  void AddNode(std::size_t known)
  {
    const Vec3& node = this->Points[this->Known[known]];
    this->Nodes.push_back(this->Known[known]);
    for (std::size_t i = 0; i < this->Known.size(); ++i)
    {
      this->Distances[i] = std::min(this->Distances[i], Norm(this->Points[this->Known[i]] - node));
    }
  }

  // Each as far from those there are as possible, up to a number of nodes.
  void AddSpreadNodes(std::size_t count)
  {
    // What lies beside the surface has to be represented there.
    for (std::size_t i = this->Known.size(); i > 0 && this->IsBeside(this->Known[i - 1]); --i)
    {
      if (2 * this->Nodes.size() < count)
      {
        this->AddNode(i - 1);
      }
    }
    if (this->Nodes.empty() && count > 0)
    {
      this->AddNode(0);
    }
    while (this->Nodes.size() < count)
    {
      const auto farthest = std::max_element(this->Distances.begin(), this->Distances.end());
      if (*farthest <= 0)
      {
        return; // all other points repeat nodes
      }
      this->AddNode(static_cast<std::size_t>(farthest - this->Distances.begin()));
    }
  }

  // Two centres for each node on the surface, one beside it, and the equations of points.
  void SetUp()
  {
    std::vector<Vec3> centers;
    for (const std::size_t node : this->Nodes)
    {
      double nearest = std::numeric_limits<double>::infinity();
      for (const std::size_t other : this->Nodes)
      {
        const double distance = Norm(this->Points[other] - this->Points[node]);
        nearest = distance > 0 ? std::min(nearest, distance) : nearest;
      }
      if (this->IsBeside(node))
      {
        centers.push_back(this->Points[node]);
        continue;
      }
      for (const double side : { -0.5, 0.5 })
      {
        centers.push_back(this->Points[node] + side * nearest * this->Normals[node]);
      }
    }
    this->Basis =
      std::make_unique<SurfaceBasis>(this->Runner, std::move(centers), this->Options.Kernel);
    const std::size_t size = this->Basis->GetSize();
    this->ValueProducts = Matrix(size, size);
    this->SlopeProducts = Matrix(size, size);
    this->SlopeRight.assign(size, 0.0);
    this->ValueRight.assign(size, 0.0);
    this->Accumulate(this->Known, this->WithNormals);
    this->HeldRows = this->MakeRows(this->HeldOut, 0, this->HeldOut.size(), true);
  }

  // Equations of points, as of SurfaceBasis, of what is known of slopes.
  Matrix MakeRows(
    const std::vector<std::size_t>& which, std::size_t begin, std::size_t end, bool normals) const
  {
    const std::size_t count = end - begin;
    std::vector<Vec3> points;
    for (std::size_t i = begin; i < end; ++i)
    {
      points.push_back(this->Points[which[i]]);
    }
    Matrix rows = this->Basis->MakeRows(points, normals);
    const bool all = this->Free.empty() && this->Beside.empty();
    for (std::size_t i = 0; normals && !all && i < count; ++i)
    {
      for (std::size_t j = 0; j < this->Basis->GetSize(); ++j)
      {
        double* slope = rows.Column(j) + count + i;
        const Vec3 known =
          this->GetKnown(which[begin + i], { slope[0], slope[count], slope[2 * count] });
        for (int c = 0; c < 3; ++c)
        {
          slope[c * count] = known[c];
        }
      }
    }
    return rows;
  }

  // Adds the products of equations to the normal equations. Values count with their weights.
  void Accumulate(const std::vector<std::size_t>& which, std::size_t withNormals)
  {
    // So many blocks are made side by side; then columns of the products are.
    constexpr std::size_t blocks = 16;
    const std::size_t size = this->Basis->GetSize();
    for (std::size_t at = 0; at < which.size(); at += blocks * BlockPoints)
    {
      std::vector<Matrix> rows(blocks);
      std::vector<std::size_t> begins(blocks + 1);
      for (std::size_t b = 0; b <= blocks; ++b)
      {
        begins[b] = std::min(which.size(), at + b * BlockPoints);
      }
      const auto hasNormals = [&](std::size_t b) { return begins[b] < withNormals; };
      this->Runner.For(blocks, 1,
        [&](std::int64_t begin, std::int64_t end)
        {
          for (std::int64_t b = begin; b < end; ++b)
          {
            rows[b] = this->MakeRows(which, begins[b], begins[b + 1], hasNormals(b));
            for (std::size_t j = 0; j < size; ++j)
            {
              for (std::size_t i = begins[b]; i < begins[b + 1]; ++i)
              {
                rows[b].Column(j)[i - begins[b]] *= this->Weights[which[i]];
              }
            }
          }
        });
      constexpr std::size_t panel = 96;
      this->Runner.For(static_cast<std::int64_t>((size + panel - 1) / panel), 1,
        [&](std::int64_t begin, std::int64_t end)
        {
          for (std::int64_t p = begin; p < end; ++p)
          {
            const std::size_t first = static_cast<std::size_t>(p) * panel;
            const std::size_t width = std::min(panel, size - first);
            for (std::size_t b = 0; b < blocks; ++b)
            {
              this->AddProducts(rows[b], begins[b + 1] - begins[b], first, width);
            }
          }
        });
      for (std::size_t b = 0; b < blocks; ++b)
      {
        this->AddRight(rows[b], which, begins[b], begins[b + 1]);
      }
    }
  }

  // Columns of the lower triangles of the products.
  void AddProducts(const Matrix& rows, std::size_t count, std::size_t first, std::size_t width)
  {
    const int height = static_cast<int>(rows.GetRows());
    const int size = static_cast<int>(this->Basis->GetSize());
    const int values = static_cast<int>(count);
    if (values == 0)
    {
      return;
    }
    const int at = static_cast<int>(first);
    const int columns = static_cast<int>(width);
    cblas_dgemm(CblasColMajor, CblasTrans, CblasNoTrans, size - at, columns, values, 1.0,
      rows.Column(first), height, rows.Column(first), height, 1.0,
      this->ValueProducts.Column(first) + first, size);
    if (height > values)
    {
      cblas_dgemm(CblasColMajor, CblasTrans, CblasNoTrans, size - at, columns, height - values, 1.0,
        rows.Column(first) + count, height, rows.Column(first) + count, height, 1.0,
        this->SlopeProducts.Column(first) + first, size);
    }
  }

  void AddRight(
    const Matrix& rows, const std::vector<std::size_t>& which, std::size_t begin, std::size_t end)
  {
    const std::size_t count = end - begin;
    if (count == 0)
    {
      return;
    }
    std::vector<double> values(count);
    std::vector<double> slopes(3 * count);
    for (std::size_t i = 0; i < count; ++i)
    {
      const std::size_t point = which[begin + i];
      values[i] = this->Values[point] * this->Weights[point];
      const Vec3 known = this->GetKnown(point, this->Slopes[point]);
      for (int c = 0; c < 3; ++c)
      {
        slopes[c * count + i] = known[c];
      }
    }
    const int height = static_cast<int>(rows.GetRows());
    const int size = static_cast<int>(this->Basis->GetSize());
    cblas_dgemv(CblasColMajor, CblasTrans, static_cast<int>(count), size, 1.0, rows.Column(0),
      height, values.data(), 1, 1.0, this->ValueRight.data(), 1);
    if (rows.GetRows() > count)
    {
      cblas_dgemv(CblasColMajor, CblasTrans, static_cast<int>(3 * count), size, 1.0,
        rows.Column(0) + count, height, slopes.data(), 1, 1.0, this->SlopeRight.data(), 1);
    }
  }

  // Coefficients of the orthonormal functions; errors in the report, mm.
  std::vector<double> Solve(const SurfaceSplineReport& report, double stiffness) const
  {
    const std::size_t size = this->Basis->GetSize();
    const double point = report.PointError / this->Scale;
    const double value = 1 / (point * point);
    const double slope = 1 / (report.NormalError * report.NormalError);
    Matrix matrix(size, size);
    for (std::size_t j = 0; j < size; ++j)
    {
      for (std::size_t i = j; i < size; ++i)
      {
        matrix.Column(j)[i] =
          value * this->ValueProducts.Column(j)[i] + slope * this->SlopeProducts.Column(j)[i];
      }
      matrix.Column(j)[j] += j < Terms ? 1e-12 * matrix.Column(j)[j] : 1 / (stiffness * stiffness);
    }
    std::vector<double> solution(size);
    for (std::size_t i = 0; i < size; ++i)
    {
      solution[i] = value * this->ValueRight[i] + slope * this->SlopeRight[i];
    }
    const int n = static_cast<int>(size);
    int info = 0;
    dpotrf_("L", &n, matrix.Column(0), &n, &info, 1);
    if (info != 0)
    {
      return {}; // rounding errors outweigh the energy: as bad as a fit can be
    }
    cblas_dtrsv(CblasColMajor, CblasLower, CblasNoTrans, CblasNonUnit, n, matrix.Column(0), n,
      solution.data(), 1);
    cblas_dtrsv(CblasColMajor, CblasLower, CblasTrans, CblasNonUnit, n, matrix.Column(0), n,
      solution.data(), 1);
    return solution;
  }

  struct Misses
  {
    double Points = 0; // RMS of weighted distances
    double Normals = 0;
    std::vector<double> Distances; // the former, of each point held out
  };

  Misses Predict(const std::vector<double>& solution) const
  {
    const std::size_t count = this->HeldOut.size();
    std::vector<double> result(4 * count);
    cblas_dgemv(CblasColMajor, CblasNoTrans, static_cast<int>(4 * count),
      static_cast<int>(this->Basis->GetSize()), 1.0, this->HeldRows.Column(0),
      static_cast<int>(4 * count), solution.data(), 1, 0.0, result.data(), 1);
    std::vector<double> values;
    std::vector<double> slopes;
    for (std::size_t i = 0; i < count; ++i)
    {
      double square = 0;
      double difference = 0;
      const std::size_t point = this->HeldOut[i];
      const Vec3 missed = Vec3{ result[count + i], result[2 * count + i], result[3 * count + i] } -
        this->GetKnown(point, this->Slopes[point]);
      // of the surface, whose normals are the data
      const Vec3 whole = missed + this->GetKnown(point, this->Normals[point]);
      for (int c = 0; c < 3; ++c)
      {
        square += whole[c] * whole[c];
        difference += missed[c] * missed[c] / 2; // two directions along the surface
      }
      // A distance, so that a function that is small everywhere gains nothing; at most so large, so
      // that where the function has no slope counts, and not for all.
      const double slope = std::clamp(std::sqrt(square), 1e-3, 1.0);
      const double distance =
        std::clamp((result[i] - this->Values[point]) / slope, -LargestMiss, LargestMiss);
      values.push_back(this->Weights[point] * distance);
      slopes.push_back(std::sqrt(difference));
    }
    return { GetRootMeanSquare(values), GetRootMeanSquare(slopes), std::move(values) };
  }

  // See SurfaceSplineReport.
  double GetGain(const SurfaceSplineReport& report, double stiffness) const
  {
    const std::vector<double> without =
      this->Predict(std::vector<double>(this->Basis->GetSize(), 0.0)).Distances;
    const std::vector<double> solution = this->Solve(report, stiffness);
    if (solution.empty())
    {
      return 0;
    }
    const std::vector<double> with = this->Predict(solution).Distances;
    const auto n = static_cast<double>(with.size());
    double sum = 0;
    double squares = 0;
    for (std::size_t i = 0; i < with.size(); ++i)
    {
      const double d = without[i] * without[i] - with[i] * with[i];
      sum += d;
      squares += d * d;
    }
    const double variance = squares / n - (sum / n) * (sum / n);
    return variance > 0 ? sum / n / std::sqrt(variance / n) : 0;
  }

  // Errors and stiffness that predict points held out best; returns by how much these are missed.
  double Tune(double& stiffness, SurfaceSplineReport& report)
  {
    report.PointError =
      this->Options.PointError > 0 ? this->Options.PointError : 0.003 * this->Scale;
    report.NormalError = std::max(0.15, this->Options.LeastNormalError);
    Misses best;
    for (int round = 0; round < Rounds; ++round)
    {
      const auto score = [&](const Misses& misses)
      {
        const double p = misses.Points * this->Scale / report.PointError;
        const double n = misses.Normals / report.NormalError;
        return p * p + 2 * n * n;
      };
      const auto attempt = [&](double t, Misses& misses)
      {
        const std::vector<double> solution = this->Solve(report, t);
        if (solution.empty())
        {
          return std::numeric_limits<double>::infinity();
        }
        misses = this->Predict(solution);
        return score(misses);
      };
      // from the stiffness there is, downhill in steps of half a decade
      constexpr double factor = 3.1623;
      double least = attempt(stiffness, best);
      for (const double step : { factor, 1 / factor })
      {
        if (this->Options.Stiffness > 0)
        {
          break;
        }
        constexpr double largest = 1e4;
        bool moved = false;
        for (double t = stiffness * step; t < largest && t > 1 / largest; t *= step)
        {
          Misses misses;
          const double s = attempt(t, misses);
          if (!(s < least))
          {
            break;
          }
          least = s;
          best = misses;
          stiffness = t;
          moved = true;
        }
        if (moved)
        {
          break;
        }
      }
      if (!std::isfinite(least))
      {
        throw Unsolvable(Outweighed);
      }
      if (!(this->Options.PointError > 0))
      {
        report.PointError = std::max(best.Points * this->Scale, SmallestPointError * this->Scale);
      }
      report.NormalError =
        std::clamp(best.Normals, std::max(SmallestNormalError, this->Options.LeastNormalError),
          std::max(LargestNormalError, this->Options.LeastNormalError));
    }
    return best.Points;
  }

  Execution& Runner;
  const SurfaceSplineOptions& Options;
  double Scale;
  std::vector<Vec3> Points;
  const std::vector<Vec3>& Normals;
  const std::vector<Vec3>& Slopes; // what gradients shall be
  const std::vector<Vec3>& Free;
  const std::vector<char>& Beside;
  std::vector<double> Values; // what the function shall be
  std::vector<double> Weights;
  std::vector<std::size_t> HeldOut;
  std::vector<std::size_t> Known;
  std::size_t WithNormals = 0;   // so many of Known
  std::vector<double> Distances; // of Known from the nearest node
  std::vector<std::size_t> Nodes;

  std::unique_ptr<SurfaceBasis> Basis; // of the nodes
  Matrix ValueProducts;                // lower triangles
  Matrix SlopeProducts;
  std::vector<double> ValueRight;
  std::vector<double> SlopeRight;
  Matrix HeldRows;
};

//------------------------------------------------------------------------------
SurfaceSpline::SurfaceSpline(
  Execution& execution, const OrientedPoints& data, const SurfaceSplineOptions& options)
  : Loops(GetRadialLoops<3>(options.Kernel, BestInstructionSet()))
{
  Check(data, options);
  Vec3 low = data.Points[0];
  Vec3 high = data.Points[0];
  for (const Vec3& point : data.Points)
  {
    for (int c = 0; c < 3; ++c)
    {
      low[c] = std::min(low[c], point[c]);
      high[c] = std::max(high[c], point[c]);
    }
  }
  this->Origin = 0.5 * (low + high);
  this->Scale = std::max({ high[0] - low[0], high[1] - low[1], high[2] - low[2] });
  if (!(this->Scale > 0) || !std::isfinite(this->Scale))
  {
    throw Unsolvable("all points lie in one place, or too far apart");
  }
  const Execution::NestedStages stages(execution);
  Fit fit(execution, data, options, this->Origin, this->Scale);
  fit.Run(this->Report);
  for (const Vec3& center : fit.Centers)
  {
    for (int c = 0; c < 3; ++c)
    {
      this->Centers[c].push_back(center[c]);
    }
  }
  this->Coefficients = std::move(fit.Coefficients);
  this->Polynomial = fit.Polynomial;
}

//------------------------------------------------------------------------------
void SurfaceSpline::EvaluateBlock(
  const Vec3* points, std::size_t count, double* values, Vec3* gradients) const
{
  const Coordinates<3> centers{ { this->Centers[0].data(), this->Centers[1].data(),
    this->Centers[2].data() } };
  double at[3][RadialBlock];
  double sums[RadialBlock];
  double slopes[3 * RadialBlock];
  for (std::size_t i = 0; i < RadialBlock; ++i)
  {
    const Vec3 u = (1 / this->Scale) * (points[std::min(i, count - 1)] - this->Origin);
    for (int c = 0; c < 3; ++c)
    {
      at[c][i] = u[c];
    }
  }
  const Coordinates<3> where{ { at[0], at[1], at[2] } };
  const std::size_t size = this->Coefficients.size();
  if (gradients)
  {
    this->Loops.SumAndGradient(centers, this->Coefficients.data(), size, where, sums, slopes);
  }
  else
  {
    this->Loops.Sum(centers, this->Coefficients.data(), size, where, sums);
  }
  for (std::size_t i = 0; i < count; ++i)
  {
    double s = sums[i] + this->Polynomial[0];
    for (int c = 0; c < 3; ++c)
    {
      s += this->Polynomial[c + 1] * at[c][i];
      if (gradients)
      {
        gradients[i][c] = slopes[c * RadialBlock + i] + this->Polynomial[c + 1];
      }
    }
    values[i] = this->Scale * s;
  }
}

//------------------------------------------------------------------------------
void SurfaceSpline::Evaluate(Execution& execution, const std::vector<Vec3>& points,
  std::vector<double>& values, std::vector<Vec3>* gradients) const
{
  const auto blocks = static_cast<std::int64_t>((points.size() + RadialBlock - 1) / RadialBlock);
  execution.For(blocks, 4,
    [&](std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t b = begin; b < end; ++b)
      {
        const std::size_t from = static_cast<std::size_t>(b) * RadialBlock;
        this->EvaluateBlock(points.data() + from, std::min(RadialBlock, points.size() - from),
          values.data() + from, gradients ? gradients->data() + from : nullptr);
      }
    });
}
}
