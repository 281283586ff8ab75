// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaOcclusionSurface.h"

#include "lacunaMemory.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>

namespace lacuna
{
namespace
{
// All lengths in voxel edges.
constexpr double LargestDepth = 2;   // of data below the object's surface
constexpr double LargestHeight = 1;  // and above it
constexpr double GradientWidth = 1;  // standard deviation of the Gaussian that smooths the angle
constexpr double LatticeSpacing = 5; // of the far points, and their least distance
constexpr std::size_t NeighborCount = 24;
constexpr double NeighborRadius = 10;

class Preparation
{
public:
  Preparation(const OcclusionImages& images, Execution& execution)
    : Images(images)
    , Run(execution)
    , N(images.Dimensions)
    , Stride{ 1, N[0], N[0] * N[1] }
    , Count(N[0] * N[1] * N[2])
  {
    for (int c = 0; c < 3; ++c)
    {
      this->Step[c] = images.Spacing[c] / images.GetEdge();
    }
  }

  OrientedData Get()
  {
    RequireMemory("the surface of " + std::to_string(this->Count) + " voxels",
      16.0 * static_cast<double>(this->Count));
    this->Run.SetStage(0, 0.2);
    this->FindLargestRegion();
    this->Run.Report(0.5);
    this->FindDistances();
    this->Run.Report(1);
    this->FindPoints();
    this->FindLattice();
    this->Run.SetStage(0.2, 1);
    this->FindNeighbors();
    return std::move(this->Result);
  }

private:
  std::array<std::int64_t, 3> GetIndex(std::int64_t voxel) const
  {
    return { voxel % this->N[0], voxel / this->N[0] % this->N[1], voxel / this->Stride[2] };
  }
  std::int64_t GetVoxel(const std::array<std::int64_t, 3>& index) const
  {
    return index[0] + this->Stride[1] * index[1] + this->Stride[2] * index[2];
  }
  OrientedData::Point GetPoint(const std::array<std::int64_t, 3>& index) const
  {
    return { this->Step[0] * static_cast<double>(index[0]),
      this->Step[1] * static_cast<double>(index[1]),
      this->Step[2] * static_cast<double>(index[2]) };
  }
  // How many voxels a length is along an axis, at least 1.
  std::int64_t GetReach(double length, int axis) const
  {
    return std::max<std::int64_t>(1, std::llround(std::ceil(length / this->Step[axis])));
  }

  void FindLargestRegion()
  {
    std::vector<std::int32_t> label(this->Count, 0);
    std::int32_t labels = 0;
    std::int32_t largest = 0;
    std::size_t size = 0;
    std::vector<std::int64_t> region;
    for (std::int64_t seed = 0; seed < this->Count; ++seed)
    {
      if (!this->Images.Object[seed] || label[seed])
      {
        continue;
      }
      label[seed] = ++labels;
      region.assign(1, seed);
      for (std::size_t i = 0; i < region.size(); ++i)
      {
        const auto index = this->GetIndex(region[i]);
        for (int axis = 0; axis < 3; ++axis)
        {
          for (const int side : { -1, 1 })
          {
            const std::int64_t next = region[i] + side * this->Stride[axis];
            const std::int64_t at = index[axis] + side;
            if (at >= 0 && at < this->N[axis] && this->Images.Object[next] && !label[next])
            {
              label[next] = labels;
              region.push_back(next);
            }
          }
        }
      }
      if (region.size() > size)
      {
        size = region.size();
        largest = labels;
      }
    }
    if (size == 0)
    {
      throw std::invalid_argument(
        "no voxel of the angle image is object; lower the last threshold of Occluded Angle");
    }
    this->Inside.resize(this->Count);
    for (std::int64_t i = 0; i < this->Count; ++i)
    {
      this->Inside[i] = label[i] == largest;
    }
  }

  // Along steps between neighbouring voxels, by two sweeps (Borgefors 1986): up to 8 % too far.
  std::vector<float> GetChamfer(unsigned char feature) const
  {
    std::vector<float> distance(this->Count);
    for (std::int64_t i = 0; i < this->Count; ++i)
    {
      distance[i] = this->Inside[i] == feature ? 0.0F : 1e6F;
    }
    for (const int side : { -1, 1 })
    {
      for (std::int64_t q = 0; q < this->Count; ++q)
      {
        const std::int64_t voxel = side < 0 ? q : this->Count - 1 - q;
        if (distance[voxel] == 0)
        {
          continue;
        }
        const auto index = this->GetIndex(voxel);
        // the 13 neighbours that the sweep has been at
        for (int n = 0; n < 13; ++n)
        {
          const std::array<int, 3> d{ side * (1 - n % 3), side * (1 - n / 3 % 3),
            side * (1 - n / 9) };
          std::array<std::int64_t, 3> other = index;
          double square = 0;
          bool within = true;
          for (int c = 0; c < 3; ++c)
          {
            other[c] += d[c];
            within = within && other[c] >= 0 && other[c] < this->N[c];
            square += d[c] * d[c] * this->Step[c] * this->Step[c];
          }
          if (within)
          {
            distance[voxel] = std::min(distance[voxel],
              distance[this->GetVoxel(other)] + static_cast<float>(std::sqrt(square)));
          }
        }
      }
    }
    return distance;
  }

  // Opaque voxels mark the surface at their centres: it runs through the object's outermost ones.
  void FindDistances()
  {
    this->Distance = this->GetChamfer(1);
    const std::vector<float> depth = this->GetChamfer(0);
    for (std::int64_t i = 0; i < this->Count; ++i)
    {
      if (this->Inside[i])
      {
        this->Distance[i] = 1 - depth[i];
      }
    }
  }

  // The gradient of the angle, smoothed by a Gaussian.
  Vec3 GetGradient(const std::array<std::int64_t, 3>& index) const
  {
    Vec3 gradient{ 0, 0, 0 };
    std::array<std::int64_t, 3> reach;
    for (int c = 0; c < 3; ++c)
    {
      reach[c] = this->GetReach(3 * GradientWidth, c);
    }
    for (std::int64_t k = -reach[2]; k <= reach[2]; ++k)
    {
      for (std::int64_t j = -reach[1]; j <= reach[1]; ++j)
      {
        for (std::int64_t i = -reach[0]; i <= reach[0]; ++i)
        {
          const auto offset = this->GetPoint({ i, j, k });
          const Vec3 d{ offset[0], offset[1], offset[2] };
          std::array<std::int64_t, 3> at{ index[0] + i, index[1] + j, index[2] + k };
          for (int c = 0; c < 3; ++c)
          {
            at[c] = std::clamp<std::int64_t>(at[c], 0, this->N[c] - 1);
          }
          const double weight = std::exp(-0.5 * Dot(d, d) / (GradientWidth * GradientWidth));
          gradient = gradient + weight * this->Images.Angle[this->GetVoxel(at)] * d;
        }
      }
    }
    return gradient;
  }

  // Outliers that are the wall of one thing.
  void FindGroups(const std::vector<std::int64_t>& outliers, std::int64_t data)
  {
    constexpr std::int64_t Reach = 2;
    constexpr std::int64_t Fewest = 20;
    const std::int64_t least = std::max(Fewest, data / 100);
    std::set<std::int64_t> open(outliers.begin(), outliers.end());
    std::int64_t largest = 0;
    while (!open.empty())
    {
      std::vector<std::int64_t> group{ *open.begin() };
      open.erase(open.begin());
      for (std::size_t k = 0; k < group.size(); ++k)
      {
        const auto index = this->GetIndex(group[k]);
        for (std::int64_t n = 0; n < 125; ++n)
        {
          const std::array<std::int64_t, 3> other{ index[0] + n % 5 - Reach,
            index[1] + n / 5 % 5 - Reach, index[2] + n / 25 - Reach };
          bool within = true;
          for (int c = 0; c < 3; ++c)
          {
            within = within && other[c] >= 0 && other[c] < this->N[c];
          }
          if (within && open.erase(this->GetVoxel(other)) > 0)
          {
            group.push_back(this->GetVoxel(other));
          }
        }
      }
      const auto size = static_cast<std::int64_t>(group.size());
      this->Result.Together += size >= least ? size : 0;
      if (size >= least && size > largest)
      {
        largest = size;
        this->Result.TogetherAt = this->GetIndex(group[group.size() / 2]);
      }
    }
  }

  void FindPoints()
  {
    std::int64_t data = 0;
    std::vector<std::int64_t> outliers;
    for (std::int64_t i = 0; i < this->Count; ++i)
    {
      if (!this->Images.Data[i])
      {
        continue;
      }
      ++data;
      if (this->Distance[i] < -LargestDepth || this->Distance[i] > LargestHeight)
      {
        outliers.push_back(i);
        continue;
      }
      const auto index = this->GetIndex(i);
      const Vec3 gradient = this->GetGradient(index);
      const Vec3 normal = Normalized(-1 * gradient);
      if (IsFinite(normal) && Norm(normal) > 0)
      {
        this->Result.Points.push_back(this->GetPoint(index));
        this->Result.Normals.push_back(normal.Elements);
        this->Voxels.push_back(i);
      }
    }
    this->Result.Outliers = data - static_cast<std::int64_t>(this->Voxels.size());
    this->FindGroups(outliers, data);
    if (this->Voxels.size() < MinimumSurfacePoints)
    {
      throw std::invalid_argument("only " + std::to_string(this->Voxels.size()) + " of " +
        std::to_string(data) +
        " data voxels lie on the surface of the object (its largest region); at least " +
        std::to_string(MinimumSurfacePoints) +
        " are needed: is this the image that the angle was computed from, and does its last "
        "threshold give the shape?");
    }
  }

  void FindLattice()
  {
    std::array<std::int64_t, 3> step;
    for (int c = 0; c < 3; ++c)
    {
      step[c] = std::max<std::int64_t>(1, std::llround(LatticeSpacing / this->Step[c]));
    }
    for (std::int64_t k = 0; k < this->N[2]; k += step[2])
    {
      for (std::int64_t j = 0; j < this->N[1]; j += step[1])
      {
        for (std::int64_t i = 0; i < this->N[0]; i += step[0])
        {
          const double distance = this->Distance[this->GetVoxel({ i, j, k })];
          if (std::abs(distance) > LatticeSpacing)
          {
            this->Result.FarPoints.push_back(this->GetPoint({ i, j, k }));
            this->Result.FarDistances.push_back(distance);
          }
        }
      }
    }
  }

  // The nearest points by looking at the voxels around, farther and farther out.
  void FindNeighbors()
  {
    std::vector<std::int32_t> point(this->Count, -1);
    for (std::size_t i = 0; i < this->Voxels.size(); ++i)
    {
      point[this->Voxels[i]] = static_cast<std::int32_t>(i);
    }
    this->Result.Neighbors.resize(this->Voxels.size());
    this->Run.For(static_cast<std::int64_t>(this->Voxels.size()), 64,
      [&](std::int64_t begin, std::int64_t end)
      {
        for (std::int64_t p = begin; p < end; ++p)
        {
          this->FindNeighbors(p, point);
        }
      });
  }

  void FindNeighbors(std::int64_t p, const std::vector<std::int32_t>& point)
  {
    const auto index = this->GetIndex(this->Voxels[p]);
    std::vector<std::pair<double, std::int32_t>> near;
    for (double radius = NeighborRadius / 4; radius <= NeighborRadius; radius *= 2)
    {
      near.clear();
      std::array<std::int64_t, 3> low;
      std::array<std::int64_t, 3> high;
      for (int c = 0; c < 3; ++c)
      {
        low[c] = std::max<std::int64_t>(0, index[c] - this->GetReach(radius, c));
        high[c] = std::min(this->N[c] - 1, index[c] + this->GetReach(radius, c));
      }
      for (std::int64_t k = low[2]; k <= high[2]; ++k)
      {
        for (std::int64_t j = low[1]; j <= high[1]; ++j)
        {
          for (std::int64_t i = low[0]; i <= high[0]; ++i)
          {
            const std::int32_t other = point[this->GetVoxel({ i, j, k })];
            const auto d = this->GetPoint({ i - index[0], j - index[1], k - index[2] });
            const double square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
            if (other >= 0 && square <= radius * radius)
            {
              near.emplace_back(square, other);
            }
          }
        }
      }
      if (near.size() >= NeighborCount)
      {
        break;
      }
    }
    const std::size_t kept = std::min(NeighborCount, near.size());
    std::partial_sort(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(kept), near.end());
    for (std::size_t i = 0; i < kept; ++i)
    {
      this->Result.Neighbors[p].push_back(near[i].second);
    }
  }

  const OcclusionImages& Images;
  Execution& Run;
  std::array<std::int64_t, 3> N;
  std::array<std::int64_t, 3> Stride;
  std::int64_t Count;
  std::array<double, 3> Step{}; // voxel spacing in voxel edges
  std::vector<unsigned char> Inside;
  std::vector<float> Distance; // to the object's surface, negative inside
  std::vector<std::int64_t> Voxels;
  OrientedData Result;
};
}

//------------------------------------------------------------------------------
void OcclusionSurfaceOptions::Describe(Properties& properties) const
{
  properties.Add("Smoothing", this->Smoothing, ValueRange::Above(0))
    .Add("Tolerance", this->Tolerance, ValueRange::Between(0.001, 0.5, "voxel edges"));
}

double OcclusionImages::GetEdge() const
{
  return std::cbrt(this->Spacing[0] * this->Spacing[1] * this->Spacing[2]);
}

OrientedData OrientData(const OcclusionImages& images, Execution& execution)
{
  const Execution::NestedStages stages(execution);
  return Preparation(images, execution).Get();
}

//------------------------------------------------------------------------------
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
  Properties properties;
  options.Describe(properties);
  properties.Check();
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
