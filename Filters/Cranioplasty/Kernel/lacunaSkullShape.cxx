// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSkullShape.h"

#include "lacunaMemory.h"
#include "lacunaShapeField.h"
#include "lacunaShapeLikelihood.h"
#include "lacunaSingleBlasThread.h"
#include "lacunaSkullEllipsoid.h"
#include "lacunaSkullTemplate.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <new>
#include <numeric>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>

namespace lacuna
{
namespace
{
// Distances of nodes, mm: near the defect or its mirror image, what is added for each mm farther away, the
// greatest.
constexpr double NearSpacing = 3;
constexpr double MirroredSpacing = 4;
constexpr double NearBand = 10;
constexpr double SpacingSlope = 0.1;
constexpr double FarSpacing = 8;
// Bone farther away tells of other shapes (face, skull base), and would make the vault seem rough.
constexpr double Reach = 60;
constexpr std::size_t LeastNodes = 200;
constexpr std::size_t MostNodes = 5000;
constexpr int FirstIterations = 20;
constexpr int MoreIterations = 10;
constexpr int LastIterations = 15;
// Steps of the plane's search at 100 mm from the middle of the skull, mm.
const std::vector<double> PlaneSteps[] = { { 4, 2, 1 }, { 1, 0.5 } };
constexpr double PlaneArm = 100;
constexpr std::size_t LeastHoles = 8; // virtual ones, of the third that is nearest
// Radius of virtual holes that show how rough a region is, mm.
constexpr double RegionHole = 35;
constexpr std::int64_t TargetBlock = 64;
constexpr std::int64_t MeanBlock = 256;

// Numbers 0 to count - 1 in an order that is the same everywhere (std::shuffle is not).
std::vector<int> Shuffled(std::size_t count)
{
  std::vector<int> order(count);
  std::iota(order.begin(), order.end(), 0);
  std::mt19937 random(1);
  for (std::size_t i = count; i > 1; --i)
  {
    std::swap(order[i - 1], order[random() % i]);
  }
  return order;
}

double SquaredDistance(const Vec3& a, const Vec3& b)
{
  const Vec3 d = a - b;
  return Dot(d, d);
}

void Check(const SoundBone& bone, const std::vector<Vec3>& defect, const MirrorPlane& plane)
{
  const std::size_t n = bone.Directions.size();
  if (bone.Outer.size() != n || bone.Thickness.size() != n)
  {
    throw std::invalid_argument("sound bone has " + std::to_string(n) + " directions, " +
      std::to_string(bone.Outer.size()) + " radii and " + std::to_string(bone.Thickness.size()) +
      " thicknesses: give one of each for a ray");
  }
  const auto isUnit = [](const Vec3& d) { return std::abs(Norm(d) - 1) < 1e-6; };
  for (std::size_t i = 0; i < n; ++i)
  {
    if (!isUnit(bone.Directions[i]) || !(bone.Outer[i] > 0) || !std::isfinite(bone.Outer[i]) ||
      !(bone.Thickness[i] > 0) || !(bone.Thickness[i] < bone.Outer[i]))
    {
      throw std::invalid_argument("ray " + std::to_string(i) +
        " of the sound bone has no unit direction, or no thickness between 0 and its radius: leave "
        "out rays without bone");
    }
  }
  if (!IsFinite(bone.Center) || !(std::abs(Norm(plane.Normal) - 1) < 1e-6) ||
    !std::isfinite(plane.Offset))
  {
    throw std::invalid_argument("the centre or the plane of symmetry is not finite");
  }
  if (defect.empty() || !std::all_of(defect.begin(), defect.end(), isUnit))
  {
    throw std::invalid_argument("the defect has no directions, or one that is no unit vector");
  }
}
}

//------------------------------------------------------------------------------
// Where directions are in space: on the ellipsoid that fits the skull and its mirror image.
struct SkullShape::Base
{
  Base(const SoundBone& bone, const MirrorPlane& plane)
    : Center(bone.Center)
    , Ellipsoid(bone.Center, BothSides(bone, plane))
  {
    std::vector<double> radii = bone.Outer;
    const auto middle = radii.begin() + static_cast<std::ptrdiff_t>(radii.size() / 2);
    std::nth_element(radii.begin(), middle, radii.end());
    this->Typical = *middle;
  }

  static std::vector<Vec3> BothSides(const SoundBone& bone, const MirrorPlane& plane)
  {
    std::vector<Vec3> points;
    for (std::size_t i = 0; i < bone.Outer.size(); ++i)
    {
      points.push_back(bone.Center + bone.Outer[i] * bone.Directions[i]);
      points.push_back(plane.Reflect(points.back()));
    }
    return points;
  }

  // Kept near the typical radius: where there is no bone the ellipsoid may be open.
  double GetRadius(const Vec3& direction) const
  {
    const double radius = this->Ellipsoid.GetRadius(direction);
    return std::isnan(radius) ? 1.5 * this->Typical
                              : std::clamp(radius, 0.5 * this->Typical, 1.5 * this->Typical);
  }
  Vec3 GetPlace(const Vec3& direction) const
  {
    return this->Center + this->GetRadius(direction) * direction;
  }
  // No two places, nor their mirror images, are farther apart.
  double GetReach(const MirrorPlane& plane) const
  {
    return 3 * this->Typical + 2 * std::abs(plane.Distance(this->Center));
  }

  Vec3 Center;
  SkullEllipsoid Ellipsoid;
  double Typical = 0;
};

namespace
{
// To the minimum of a parabola of this slope and curvature (lower triangle); no longer than two along any
// unknown. Levenberg, Quarterly of Applied Mathematics 2, 1944.
Vec3 FindStep(const Vec3& slope, const double (&curvature)[3][3])
{
  double largest = 0;
  for (int i = 0; i < 3; ++i)
  {
    largest = std::max({ largest, std::abs(curvature[i][i]), std::abs(slope[i]) });
  }
  if (!(largest > 1e-100 &&
        std::isfinite(largest))) // else a value where the covariance is not positive definite
  {
    return { 0, 0, 0 };
  }
  const AlignedNumbers step = MakeAligned(3);
  for (double damping = 0;
       damping<1e3 * largest; damping = damping> 0 ? 2 * damping : 1e-3 * largest)
  {
    SquareMatrix matrix(3);
    for (int j = 0; j < 3; ++j)
    {
      step[j] = -slope[j];
      for (int i = j; i < 3; ++i)
      {
        matrix.Column(j)[i] = curvature[i][j] + (i == j ? damping : 0);
      }
    }
    if (!FactorCholesky(matrix))
    {
      continue;
    }
    SolveCholeskyLower(matrix, step.get(), 1);
    SolveCholeskyUpper(matrix, step.get());
    if (std::max({ std::abs(step[0]), std::abs(step[1]), std::abs(step[2]) }) <= 2)
    {
      return { step[0], step[1], step[2] };
    }
  }
  return { 0, 0, 0 };
}

// Turns the plane about the middle of the places, and shifts it, to the greatest likelihood: to the vertex of
// the parabola through ten values.
MirrorPlane RefinePlane(ShapeLikelihood& likelihood, const ShapeVariances& variances,
  const MirrorPlane& start, const Vec3& middle, const Vec3& ahead, const std::vector<double>& steps,
  Execution& execution)
{
  // turns that depend on the skull alone and not on the axes of the coordinates
  const Vec3 first = Normalized(Cross(start.Normal, ahead));
  const Vec3 second = Cross(start.Normal, first);
  const double distance = start.Distance(middle);
  const auto planeOf = [&](const Vec3& way)
  {
    MirrorPlane plane;
    plane.Normal =
      Normalized(start.Normal + (way[0] / PlaneArm) * first + (way[1] / PlaneArm) * second);
    plane.Offset = Dot(plane.Normal, middle) - distance + way[2];
    return plane;
  };
  Vec3 best{ 0, 0, 0 };
  double cost = std::numeric_limits<double>::infinity();
  const auto costOf = [&](const Vec3& way) // keeps the best
  {
    likelihood.SetPlane(planeOf(way), execution);
    const double there = likelihood.Evaluate(variances);
    if (there < cost)
    {
      best = way;
      cost = there;
    }
    return there;
  };
  const Execution::NestedStages nested(execution);
  const auto setDone = [&](double done) // evaluations report nothing of their own
  {
    execution.SetStage(
      done / static_cast<double>(steps.size()), done / static_cast<double>(steps.size()));
  };
  setDone(0);
  costOf(best);
  double done = 0;
  for (const double step : steps)
  {
    const Vec3 from = best;
    const double here = cost;
    const Vec3 ways[] = { { step, 0, 0 }, { 0, step, 0 }, { 0, 0, step } };
    Vec3 slope;
    double curvature[3][3];
    double after[3];
    for (int i = 0; i < 3; ++i)
    {
      after[i] = costOf(from + ways[i]);
      const double before = costOf(from - ways[i]);
      slope[i] = 0.5 * (after[i] - before);
      curvature[i][i] = after[i] + before - 2 * here;
      for (int j = 0; j < i; ++j)
      {
        curvature[i][j] = costOf(from + ways[i] + ways[j]) - after[i] - after[j] + here;
      }
    }
    costOf(from + step * FindStep(slope, curvature));
    setDone(++done);
    execution.Report(1);
  }
  const MirrorPlane plane = planeOf(best);
  likelihood.SetPlane(plane, execution);
  return plane;
}

}

//------------------------------------------------------------------------------
SkullShape::SkullShape(const SoundBone& bone, const std::vector<Vec3>& defect,
  const MirrorPlane& plane, Execution& execution, const SkullRays* other,
  std::size_t likelihoodNodes)
  : Plane(plane)
  , Examples(std::make_unique<SkullExamples>())
{
  likelihoodNodes = std::max(likelihoodNodes, LeastNodes);
  Check(bone, defect, plane);
  if (other)
  {
    *this->Examples = SkullExamples(*other, plane);
  }
  if (bone.Outer.size() < LeastNodes)
  {
    throw std::invalid_argument("only " + std::to_string(bone.Outer.size()) +
      " rays meet sound bone: at least " + std::to_string(LeastNodes) + " are needed");
  }
  const Execution::NestedStages nested(execution);
  const SingleBlasThread single(std::min(execution.GetNumberOfThreads(), 2));
  this->Ellipsoid = std::make_unique<Base>(bone, plane);
  this->ChooseNodes(bone, defect);
  if (this->Nodes.size() < LeastNodes)
  {
    throw std::invalid_argument(
      "the sound bone is too small: " + std::to_string(this->Nodes.size()) +
      " places some mm apart, at least " + std::to_string(LeastNodes) + " are needed");
  }
  RequireMemory("the shape of the skull from " + std::to_string(this->Nodes.size()) + " points",
    2.0 * SquareMatrix::GetBytes(this->Nodes.size()) +
      18.0 * SquareMatrix::GetBytes(likelihoodNodes));

  this->LeastThickness = std::numeric_limits<double>::infinity();
  for (const int node : this->Nodes)
  {
    this->LeastThickness = std::min(this->LeastThickness, bone.Thickness[node]);
  }
  std::vector<int> subset = Shuffled(this->Nodes.size());
  subset.resize(std::min(subset.size(), likelihoodNodes));
  execution.SetStage(0, 0.4);
  this->FindPlane(bone, subset, execution);
  execution.SetStage(0.4, 1);
  const std::unique_ptr<ShapeField> before = std::move(this->Outer);
  this->Ellipsoid = std::make_unique<Base>(bone, this->Plane);
  this->Outer = this->MakeField(bone, true);
  this->Outer->Continue(*before);
  const std::vector<Vec3> places = this->Outer->GetPlaces(subset);
  const std::vector<VirtualHole> regions = SpreadHoles(places, RegionHole);
  const std::vector<VirtualHole> holes = this->FindHolesLike(defect, places);
  execution.For(2, 1,
    [&](std::int64_t begin, std::int64_t end)
    {
      ThreadExecution serial(1);
      for (std::int64_t i = begin; i < end; ++i)
      {
        if (i == 1)
        {
          this->FindThickness(bone, subset, regions, serial);
        }
        ShapeField& field = i == 0 ? *this->Outer : *this->Thickness;
        {
          ShapeLikelihood likelihood = field.MakeLikelihood(subset);
          likelihood.SetPlane(this->Plane, serial);
          field.Estimate(likelihood, LastIterations);
          field.Calibrate(likelihood, holes);
        }
        field.Solve(this->Plane, this->Ellipsoid->GetReach(this->Plane));
      }
    });
}

SkullShape::~SkullShape() = default;

double SkullShape::GetOuterFactor() const
{
  return this->Outer->GetExampleFactor();
}

double SkullShape::GetThicknessFactor() const
{
  return this->Thickness->GetExampleFactor();
}

//------------------------------------------------------------------------------
std::unique_ptr<ShapeField> SkullShape::MakeField(const SoundBone& bone, bool outer) const
{
  std::vector<Vec3> directions;
  std::vector<Vec3> places;
  std::vector<double> values;
  for (const int node : this->Nodes)
  {
    const Vec3& d = bone.Directions[node];
    directions.push_back(d);
    places.push_back(this->Ellipsoid->GetPlace(d));
    values.push_back(
      outer ? bone.Outer[node] - this->Ellipsoid->GetRadius(d) : bone.Thickness[node]);
  }
  return std::make_unique<ShapeField>(directions, std::move(places), std::move(values), outer,
    outer ? this->Examples->Outer : this->Examples->Thickness);
}

//------------------------------------------------------------------------------
// By the outer table over an ellipsoid that is symmetric about the plane; leaves its variances and regions.
void SkullShape::FindPlane(
  const SoundBone& bone, const std::vector<int>& subset, Execution& execution)
{
  const Execution::NestedStages nested(execution);
  for (int round = 0; round < 2; ++round)
  {
    execution.SetStage(0.5 * round, 0.5 * round + 0.1);
    this->Ellipsoid = std::make_unique<Base>(bone, this->Plane);
    std::unique_ptr<ShapeField> field = this->MakeField(bone, true);
    if (round > 0)
    {
      field->Continue(*this->Outer);
    }
    Vec3 middle{ 0, 0, 0 };
    for (const Vec3& place : field->GetPlaces())
    {
      middle = middle + (1.0 / static_cast<double>(this->Nodes.size())) * place;
    }
    ShapeLikelihood likelihood = field->MakeLikelihood(subset);
    likelihood.SetPlane(this->Plane, execution);
    field->Estimate(likelihood, round == 0 ? FirstIterations : MoreIterations);
    if (round == 1 && this->Examples->Outer && !field->IsLikeExample(likelihood))
    {
      this->Examples->Outer = {};
      field = this->MakeField(bone, true);
      likelihood = field->MakeLikelihood(subset);
      likelihood.SetPlane(this->Plane, execution);
      field->Estimate(likelihood, FirstIterations + MoreIterations);
    }
    execution.SetStage(0.5 * round + 0.1, 0.5 * (round + 1));
    this->Plane = RefinePlane(likelihood, field->GetVariances(), this->Plane, middle,
      field->GetPlaces().front() - bone.Center, PlaneSteps[round], execution);
    field->FindRegions(likelihood, SpreadHoles(field->GetPlaces(subset), RegionHole), this->Plane);
    this->Outer = std::move(field);
  }
}

//------------------------------------------------------------------------------
// With its first variances and regions.
void SkullShape::FindThickness(const SoundBone& bone, const std::vector<int>& subset,
  const std::vector<VirtualHole>& regions, Execution& execution)
{
  for (;;)
  {
    this->Thickness = this->MakeField(bone, false);
    ShapeLikelihood likelihood = this->Thickness->MakeLikelihood(subset);
    likelihood.SetPlane(this->Plane, execution);
    this->Thickness->Estimate(likelihood, FirstIterations + MoreIterations);
    if (this->Examples->Thickness && !this->Thickness->IsLikeExample(likelihood))
    {
      this->Examples->Thickness = {};
      continue;
    }
    this->Thickness->FindRegions(likelihood, regions, this->Plane);
    return;
  }
}

//------------------------------------------------------------------------------
// Virtual holes as large as the defect, those that are nearest to it or to its mirror image.
std::vector<VirtualHole> SkullShape::FindHolesLike(
  const std::vector<Vec3>& defect, const std::vector<Vec3>& places) const
{
  Vec3 axis{ 0, 0, 0 };
  for (const Vec3& d : defect)
  {
    axis = axis + d;
  }
  axis = Normalized(axis);
  double square = 0; // of a uniform disc: half its radius squared
  for (const Vec3& d : defect)
  {
    square += SquaredDistance(d, axis) / static_cast<double>(defect.size());
  }
  // what is left out has to leave more than half of the bone: a larger defect is like smaller holes
  double radius = this->Ellipsoid->Typical * std::sqrt(2 * square);
  std::vector<VirtualHole> holes = SpreadHoles(places, radius);
  while (holes.size() < LeastHoles && radius > RegionHole)
  {
    radius *= 0.85;
    holes = SpreadHoles(places, radius);
  }
  const Vec3 middle = this->Ellipsoid->GetPlace(axis);
  const Vec3 mirrored = this->Plane.Reflect(middle);
  const auto distanceOf = [&](const VirtualHole& hole) {
    return std::min(SquaredDistance(hole.Middle, middle), SquaredDistance(hole.Middle, mirrored));
  };
  std::stable_sort(holes.begin(), holes.end(),
    [&](const VirtualHole& a, const VirtualHole& b) { return distanceOf(a) < distanceOf(b); });
  holes.resize(std::min(holes.size(), std::max(LeastHoles, holes.size() / 3)));
  return holes;
}

//------------------------------------------------------------------------------
void SkullShape::ChooseNodes(const SoundBone& bone, const std::vector<Vec3>& defect)
{
  std::vector<Vec3> missing;
  std::vector<Vec3> mirrored;
  for (const Vec3& d : defect)
  {
    missing.push_back(this->Ellipsoid->GetPlace(d));
    mirrored.push_back(this->Plane.Reflect(missing.back()));
  }
  const auto distanceTo = [](const std::vector<Vec3>& points, const Vec3& x)
  {
    double least = std::numeric_limits<double>::infinity();
    for (const Vec3& p : points)
    {
      least = std::min(least, SquaredDistance(p, x));
    }
    return std::sqrt(least);
  };
  std::vector<Vec3> places;
  std::vector<double> spacing;
  std::vector<bool> reached;
  for (const Vec3& d : bone.Directions)
  {
    places.push_back(this->Ellipsoid->GetPlace(d));
    const double away = std::max(0.0, distanceTo(missing, places.back()) - NearBand);
    const double awayMirrored = std::max(0.0, distanceTo(mirrored, places.back()) - NearBand);
    reached.push_back(std::min(away, awayMirrored) < Reach);
    spacing.push_back(std::min({ NearSpacing + SpacingSlope * away,
      MirroredSpacing + SpacingSlope * awayMirrored, FarSpacing }));
  }
  const std::vector<int> order = Shuffled(places.size());
  for (double factor = 1;; factor *= 1.2)
  {
    this->Nodes.clear();
    for (const int i : order)
    {
      const double square = factor * factor * spacing[i] * spacing[i];
      if (reached[i] &&
        std::none_of(this->Nodes.begin(), this->Nodes.end(),
          [&](int node) { return SquaredDistance(places[node], places[i]) < square; }))
      {
        this->Nodes.push_back(i);
      }
    }
    if (this->Nodes.size() <= MostNodes)
    {
      return;
    }
  }
}

//------------------------------------------------------------------------------
std::vector<SkullEstimate> SkullShape::Predict(
  const std::vector<Vec3>& directions, Execution& execution) const
{
  return this->Predict(directions, true, execution);
}

std::vector<SkullEstimate> SkullShape::PredictSurfaces(
  const std::vector<Vec3>& directions, Execution& execution) const
{
  return this->Predict(directions, false, execution);
}

std::vector<SkullEstimate> SkullShape::Predict(
  const std::vector<Vec3>& directions, bool errors, Execution& execution) const
{
  for (const Vec3& d : directions)
  {
    if (!(std::abs(Norm(d) - 1) < 1e-6))
    {
      throw std::invalid_argument("a direction of the skull's shape is no unit vector");
    }
  }
  const SingleBlasThread single(execution.GetNumberOfThreads());
  std::vector<SkullEstimate> estimates(directions.size());
  const std::size_t n = this->Nodes.size();
  const auto count = static_cast<std::int64_t>(directions.size());
  const std::int64_t block = errors ? TargetBlock : MeanBlock;
  // blocks that are the same however the range is divided: BLAS sums by their size
  execution.For((count + block - 1) / block, 1,
    [&](std::int64_t begin, std::int64_t end)
    {
      const AlignedNumbers covariances = MakeAligned(n * (errors ? block : 1));
      for (std::int64_t b = begin; b < end; ++b)
      {
        const std::int64_t first = b * block;
        const std::int64_t last = std::min(count, first + block);
        for (const ShapeField* field : { this->Outer.get(), this->Thickness.get() })
        {
          const bool outer = field == this->Outer.get();
          for (std::int64_t t = first; t < last; ++t)
          {
            double* column = covariances.get() + (errors ? (t - first) * n : 0);
            const Vec3 place = this->Ellipsoid->GetPlace(directions[t]);
            field->GetCovariances(place, column);
            const double mean = field->GetMean(directions[t], column);
            if (outer)
            {
              estimates[t].Outer = this->Ellipsoid->GetRadius(directions[t]) + mean;
            }
            else
            {
              estimates[t].Thickness = std::max(mean, this->LeastThickness);
            }
          }
          if (!errors)
          {
            continue;
          }
          SolveCholeskyLower(
            field->GetFactors(), covariances.get(), static_cast<int>(last - first));
          for (std::int64_t t = first; t < last; ++t)
          {
            (outer ? estimates[t].OuterError : estimates[t].ThicknessError) =
              field->GetError(directions[t], this->Ellipsoid->GetPlace(directions[t]),
                covariances.get() + (t - first) * n);
          }
        }
      }
    });
  return estimates;
}
}
