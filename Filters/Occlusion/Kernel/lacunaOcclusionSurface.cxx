// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaOcclusionSurface.h"

#include "lacunaMemory.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>

namespace lacuna
{
namespace
{
// All lengths in voxel edges. Chosen on shapes of known truth, see the user guide.
constexpr int Rounds = 4;
constexpr double Offset = 0.25;      // of the points before and behind the data
constexpr double LargestError = 0.3; // of data
constexpr double SmallestError = 0.01;
constexpr double FarError = 0.5; // of far distances, relative
constexpr double SmoothingUnit = 3500;
// An error is told from the size that this part of the distances around does not exceed, so that
// the rest, such as those at an edge of a flat face, do not count.
constexpr double Quantile = 0.3;
constexpr double ErrorPerQuantile = 1.9; // even distribution: 0.29 / 0.15
constexpr int NewtonSteps = 3;

double Length(const OcclusionSurface::Point& v)
{
  return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

// Nodes, values and errors without nodes that are there already.
struct Constraints
{
  std::vector<OcclusionSurface::Point> Nodes;
  std::vector<double> Values;
  std::vector<double> Errors;

  void Add(const OcclusionSurface::Point& node, double value, double error)
  {
    this->Nodes.push_back(node);
    this->Values.push_back(value);
    this->Errors.push_back(error);
  }

  void DropRepeated()
  {
    std::vector<std::size_t> order(this->Nodes.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::stable_sort(order.begin(), order.end(),
      [&](std::size_t a, std::size_t b) { return this->Nodes[a] < this->Nodes[b]; });
    std::vector<char> repeated(order.size(), 0);
    for (std::size_t i = 1; i < order.size(); ++i)
    {
      repeated[order[i]] = this->Nodes[order[i]] == this->Nodes[order[i - 1]];
    }
    std::size_t kept = 0;
    for (std::size_t i = 0; i < order.size(); ++i)
    {
      if (!repeated[i])
      {
        this->Nodes[kept] = this->Nodes[i];
        this->Values[kept] = this->Values[i];
        this->Errors[kept++] = this->Errors[i];
      }
    }
    this->Nodes.resize(kept);
    this->Values.resize(kept);
    this->Errors.resize(kept);
  }
};

std::vector<double> GetErrors(const OrientedData& data, const std::vector<double>& distances)
{
  std::vector<double> errors(distances.size());
  std::vector<double> around;
  for (std::size_t i = 0; i < errors.size(); ++i)
  {
    around.clear();
    for (const std::int32_t n : data.Neighbors[i])
    {
      around.push_back(std::abs(distances[n]));
    }
    const auto at = around.begin() +
      static_cast<std::ptrdiff_t>(Quantile * static_cast<double>(around.size() - 1));
    std::nth_element(around.begin(), at, around.end());
    errors[i] = std::clamp(ErrorPerQuantile * *at, SmallestError, LargestError);
  }
  return errors;
}
}

//------------------------------------------------------------------------------
OcclusionSurface::OcclusionSurface(
  Execution& execution, const OcclusionImages& images, const OcclusionSurfaceOptions& options)
  : Images(images)
  , Options(options)
{
  if (!(options.Smoothing > 0) || !std::isfinite(options.Smoothing))
  {
    throw std::invalid_argument("Smoothing must be a finite number above 0");
  }
  if (!(options.Tolerance >= 0.001 && options.Tolerance <= 0.5))
  {
    throw std::invalid_argument("Tolerance must be between 0.001 and 0.5 voxel edges");
  }
  const Execution::NestedStages stages(execution);
  execution.SetStage(0, 0.1);
  OrientedData data = OrientData(images, execution);
  std::vector<double> distances(data.Points.size(), 0.0);
  std::vector<double> errors(data.Points.size(), LargestError);
  for (int round = 0; round < Rounds; ++round)
  {
    execution.SetStage(0.1 + 0.9 * round / Rounds, 0.1 + 0.9 * (round + 0.95) / Rounds);
    this->Fit(execution, data, errors);
    execution.SetStage(0.1 + 0.9 * (round + 0.95) / Rounds, 0.1 + 0.9 * (round + 1) / Rounds);
    distances = this->Compare(execution, data);
    errors = GetErrors(data, distances);
  }
  double square = 0;
  for (const double d : distances)
  {
    square += d * d / static_cast<double>(distances.size());
  }
  this->Report.DataVoxels = static_cast<std::int64_t>(data.Points.size());
  this->Report.Outliers = data.Outliers;
  this->Report.Together = data.Together;
  this->Report.TogetherAt = data.TogetherAt;
  this->Report.Nodes = static_cast<std::int64_t>(this->Function->GetReport().NodeCount);
  this->Report.Residual = std::sqrt(square) * images.GetEdge();
}

//------------------------------------------------------------------------------
void OcclusionSurface::Fit(
  Execution& execution, const OrientedData& data, const std::vector<double>& errors)
{
  Constraints all;
  for (std::size_t i = 0; i < data.Points.size(); ++i)
  {
    all.Add(data.Points[i], 0, errors[i]);
  }
  std::vector<double> values;
  if (this->Function)
  {
    std::vector<Point> gradients;
    this->Function->Evaluate(execution, data.Points, values, gradients);
    for (std::size_t i = 0; i < values.size(); ++i)
    {
      const double slope = Length(gradients[i]);
      values[i] = slope > 0 ? std::clamp(values[i] / slope, -1.0, 1.0) : 0;
    }
  }
  for (std::size_t i = 0; i < data.Points.size(); ++i)
  {
    for (const double side : { -1.0, 1.0 })
    {
      // from the datum's foot on the surface there is, so that they say a slope, not a place
      Point node = data.Points[i];
      for (int c = 0; c < 3; ++c)
      {
        node[c] += (side * Offset - (this->Function ? values[i] : 0)) * data.Normals[i][c];
      }
      all.Add(node, side * Offset, errors[i]);
    }
  }
  double range = 2 * Offset;
  for (std::size_t i = 0; i < data.FarPoints.size(); ++i)
  {
    all.Add(data.FarPoints[i], data.FarDistances[i], FarError * std::abs(data.FarDistances[i]));
  }
  all.DropRepeated();
  const auto extremes = std::minmax_element(all.Values.begin(), all.Values.end());
  range = std::max(range, *extremes.second - *extremes.first);
  RadialBasisOptions options;
  options.Kernel = RadialKernel::Cubic;
  options.Smoothing = SmoothingUnit * this->Options.Smoothing;
  options.Accuracy = std::min(0.5, this->Options.Tolerance / range);
  options.Errors = std::move(all.Errors);
  options.Words.Accuracy = "Tolerance";
  this->Function = std::make_unique<RadialBasis<3>>(execution, all.Nodes, all.Values, options);
}

std::vector<double> OcclusionSurface::Compare(Execution& execution, OrientedData& data) const
{
  std::vector<double> values;
  std::vector<Point> gradients;
  this->Function->Evaluate(execution, data.Points, values, gradients);
  for (std::size_t i = 0; i < values.size(); ++i)
  {
    const double slope = Length(gradients[i]);
    if (slope > 0)
    {
      values[i] /= slope;
      for (int c = 0; c < 3; ++c)
      {
        data.Normals[i][c] = gradients[i][c] / slope;
      }
    }
  }
  return values;
}

//------------------------------------------------------------------------------
std::vector<float> OcclusionSurface::EvaluateGrid(Execution& execution) const
{
  const double edge = this->Images.GetEdge();
  RegularGrid<3> grid;
  for (int c = 0; c < 3; ++c)
  {
    grid.Spacing[c] = this->Images.Spacing[c] / edge;
    grid.Origin[c] = -static_cast<double>(GridMargin) * grid.Spacing[c];
    grid.Size[c] = this->Images.Dimensions[c] + 2 * GridMargin;
  }
  RequireMemory("the function on " + std::to_string(grid.GetNumberOfPoints()) + " voxels",
    12.0 * static_cast<double>(grid.GetNumberOfPoints()));
  std::vector<double> values(grid.GetNumberOfPoints());
  this->Function->EvaluateGrid(execution, grid, values.data());
  std::vector<float> result(values.size());
  std::transform(values.begin(), values.end(), result.begin(),
    [edge](double v) { return static_cast<float>(edge * v); });
  return result;
}

void OcclusionSurface::Project(
  Execution& execution, std::vector<Point>& points, std::vector<Point>& normals) const
{
  const Execution::NestedStages stages(execution);
  const double edge = this->Images.GetEdge();
  std::vector<double> values;
  for (Point& p : points)
  {
    for (double& x : p)
    {
      x /= edge;
    }
  }
  for (int step = 0; step <= NewtonSteps; ++step)
  {
    execution.SetStage(static_cast<double>(step) / (NewtonSteps + 1),
      static_cast<double>(step + 1) / (NewtonSteps + 1));
    this->Function->Evaluate(execution, points, values, normals);
    for (std::size_t i = 0; i < points.size(); ++i)
    {
      const double slope = Length(normals[i]);
      const double move =
        slope > 0 ? std::clamp(values[i] / slope, -1.0 / NewtonSteps, 1.0 / NewtonSteps) : 0;
      for (int c = 0; c < 3; ++c)
      {
        normals[i][c] /= slope > 0 ? slope : 1;
        points[i][c] -= step < NewtonSteps ? move * normals[i][c] : 0;
      }
    }
  }
  for (Point& p : points)
  {
    for (double& x : p)
    {
      x *= edge;
    }
  }
}
}
