// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSkullShape.h"

#include "lacunaMemory.h"
#include "lacunaShapeLikelihood.h"
#include "lacunaSingleBlasThread.h"
#include "lacunaSkullEllipsoid.h"

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
constexpr double PlaneSteps[][2] = { { 4, 2 }, { 1, 0.5 } };
constexpr double PlaneArm = 100;
constexpr std::size_t LeastHoles = 8; // virtual ones, of the third that is nearest
// Regions of a skull that are rougher than others: size of virtual holes (radius) and of the regions, mm; the
// weight of what is expected without any.
constexpr double RegionHole = 35;
constexpr double RegionSize = 25;
constexpr double RegionPrior = 0.3;
// How far errors may be stretched by virtual holes.
constexpr double LeastCalibration = 0.4;
constexpr double MostCalibration = 3;
constexpr std::int64_t TargetBlock = 64;
constexpr std::int64_t MeanBlock = 256;
constexpr double Normal95 = 1.959963984540054;

using AlignedNumbers = std::unique_ptr<double[], FreeAligned>;

AlignedNumbers MakeNumbers(std::size_t count)
{
  return AlignedNumbers(new (std::align_val_t{ 64 }) double[count]);
}

// Mean terms: 1, and of the outer table also the direction.
std::size_t CountTerms(bool withDirection)
{
  return withDirection ? 4 : 1;
}

void AppendTerms(const Vec3& direction, bool withDirection, std::vector<double>& terms)
{
  terms.push_back(1);
  if (withDirection)
  {
    terms.insert(terms.end(), direction.data(), direction.data() + 3);
  }
}

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

//------------------------------------------------------------------------------
// Sound bone that is left out and predicted.
struct SkullShape::VirtualHole
{
  Vec3 Middle;
  std::vector<int> Places;

  static std::vector<std::vector<int>> PlacesOf(const std::vector<VirtualHole>& holes)
  {
    std::vector<std::vector<int>> places;
    for (const VirtualHole& hole : holes)
    {
      places.push_back(hole.Places);
    }
    return places;
  }
};

// Of a radius, half of it apart, all over the places.
std::vector<SkullShape::VirtualHole> SkullShape::SpreadHoles(
  const std::vector<Vec3>& places, double radius)
{
  std::vector<VirtualHole> holes;
  std::vector<Vec3> middles;
  for (const Vec3& middle : places)
  {
    if (std::any_of(middles.begin(), middles.end(),
          [&](const Vec3& m) { return SquaredDistance(m, middle) < 0.25 * radius * radius; }))
    {
      continue;
    }
    middles.push_back(middle);
    VirtualHole hole{ middle, {} };
    for (std::size_t i = 0; i < places.size(); ++i)
    {
      if (SquaredDistance(places[i], middle) < radius * radius)
      {
        hole.Places.push_back(static_cast<int>(i));
      }
    }
    if (hole.Places.size() >= 3 && 2 * hole.Places.size() < places.size())
    {
      holes.push_back(std::move(hole));
    }
  }
  return holes;
}

//------------------------------------------------------------------------------
// One function of the direction.
struct SkullShape::Field
{
  struct Region
  {
    Vec3 Middle;
    Vec3 Mirrored;
    double Square; ///< mean squared ratio of errors
  };

  // directions and values of the nodes
  Field(const std::vector<Vec3>& directions, std::vector<double> values, bool withDirection,
    const Base& base)
    : WithDirection(withDirection)
    , Values(std::move(values))
  {
    for (const Vec3& d : directions)
    {
      this->Places.push_back(base.GetPlace(d));
      AppendTerms(d, withDirection, this->Terms);
    }
    this->Roughness.assign(directions.size(), 1);
  }

  ShapeLikelihood MakeLikelihood(const std::vector<int>& subset) const
  {
    const std::size_t q = CountTerms(this->WithDirection);
    std::vector<Vec3> places;
    std::vector<double> values;
    std::vector<double> terms;
    std::vector<double> roughness;
    for (const int node : subset)
    {
      roughness.push_back(this->Roughness[node]);
      places.push_back(this->Places[node]);
      values.push_back(this->Values[node]);
      terms.insert(
        terms.end(), this->Terms.begin() + node * q, this->Terms.begin() + (node + 1) * q);
    }
    return ShapeLikelihood(
      std::move(places), std::move(values), std::move(terms), std::move(roughness));
  }

  std::vector<Vec3> GetPlaces(const std::vector<int>& subset) const
  {
    std::vector<Vec3> places;
    for (const int node : subset)
    {
      places.push_back(this->Places[node]);
    }
    return places;
  }

  // Variances of values that vary by some mm: a start.
  void Start()
  {
    double mean = 0;
    double square = 0;
    for (const double v : this->Values)
    {
      mean += v / static_cast<double>(this->Values.size());
      square += v * v / static_cast<double>(this->Values.size());
    }
    const double variance = std::max(square - mean * mean, 0.01);
    this->Variances.Common = { 0.02 * variance, 0.06 * variance, 1.0 * variance, 50 * variance };
    this->Variances.Own = this->Variances.Common;
    this->Variances.Noise = 0.005 * variance;
  }

  void SetRegions(std::vector<Region> regions)
  {
    this->Regions = std::move(regions);
    for (std::size_t i = 0; i < this->Places.size(); ++i)
    {
      this->Roughness[i] = this->GetRoughness(this->Places[i]);
    }
  }

  // Sets how rough the skull is in each region: the errors of virtual holes there, beside the predicted ones.
  void FindRegions(const ShapeLikelihood& likelihood, const std::vector<VirtualHole>& holes,
    const MirrorPlane& plane)
  {
    const std::vector<std::vector<double>> ratios =
      likelihood.LeaveOut(this->Variances, VirtualHole::PlacesOf(holes));
    std::vector<Region> regions;
    for (std::size_t h = 0; h < holes.size(); ++h)
    {
      double square = 0;
      for (const double ratio : ratios[h])
      {
        square += ratio * ratio / static_cast<double>(ratios[h].size());
      }
      if (!ratios[h].empty())
      {
        regions.push_back({ holes[h].Middle, plane.Reflect(holes[h].Middle), square });
      }
    }
    this->SetRegions(std::move(regions));
  }

  // What multiplies the standard deviations of RoughLengths at a place, about 1.
  double GetRoughness(const Vec3& place) const
  {
    double sum = RegionPrior;
    double weights = RegionPrior;
    for (const Region& region : this->Regions)
    {
      const double square =
        std::min(SquaredDistance(place, region.Middle), SquaredDistance(place, region.Mirrored));
      const double falloff = 1 + square / (RegionSize * RegionSize);
      const double weight = 1 / (falloff * falloff);
      sum += weight * region.Square;
      weights += weight;
    }
    return std::sqrt(sum / weights);
  }

  // The errors that the nearest virtual holes of the defect's size have, beside the predicted ones.
  void Calibrate(const ShapeLikelihood& likelihood, const std::vector<VirtualHole>& holes)
  {
    std::vector<double> all;
    for (const std::vector<double>& ratios :
      likelihood.LeaveOut(this->Variances, VirtualHole::PlacesOf(holes)))
    {
      all.insert(all.end(), ratios.begin(), ratios.end());
    }
    if (all.empty())
    {
      return;
    }
    const auto place = all.begin() + static_cast<std::ptrdiff_t>(0.95 * (all.size() - 1));
    std::nth_element(all.begin(), place, all.end());
    this->Calibration = std::clamp(*place / Normal95, LeastCalibration, MostCalibration);
  }

  void Solve(const MirrorPlane& plane, double reach)
  {
    const std::size_t n = this->Places.size();
    const std::size_t q = CountTerms(this->WithDirection);
    this->Covariance = std::make_unique<ShapeCovariance>(this->Variances, reach);
    this->Factors = std::make_unique<SquareMatrix>(n);
    for (std::size_t j = 0; j < n; ++j)
    {
      const Vec3 mirrored = plane.Reflect(this->Places[j]);
      double* column = this->Factors->Column(j);
      for (std::size_t i = j; i < n; ++i)
      {
        column[i] = (*this->Covariance)(
          this->Places[i], this->Places[j], mirrored, this->Roughness[i] * this->Roughness[j]);
      }
      column[j] += this->Roughness[j] * this->Roughness[j] * this->Variances.Noise;
    }
    if (!FactorCholesky(*this->Factors))
    {
      throw std::runtime_error("the equations of the skull's shape cannot be solved: points of the "
                               "sound bone coincide");
    }
    // [L^-1 H, L^-1 y]
    this->Means = MakeNumbers(n * (q + 1));
    for (std::size_t i = 0; i < n; ++i)
    {
      for (std::size_t k = 0; k < q; ++k)
      {
        this->Means[k * n + i] = this->Terms[i * q + k];
      }
      this->Means[q * n + i] = this->Values[i];
    }
    SolveCholeskyLower(*this->Factors, this->Means.get(), static_cast<int>(q + 1));
    SquareMatrix gram(q);
    std::vector<double> factors(q);
    const auto dot = [&](std::size_t k, std::size_t m)
    {
      return std::inner_product(
        &this->Means[k * n], &this->Means[k * n] + n, &this->Means[m * n], 0.0);
    };
    for (std::size_t k = 0; k < q; ++k)
    {
      factors[k] = dot(k, q);
      for (std::size_t m = k; m < q; ++m)
      {
        gram.Column(k)[m] = dot(k, m);
      }
    }
    if (!FactorCholesky(gram))
    {
      throw std::runtime_error("the sound bone does not determine the mean shape of the skull");
    }
    InvertCholesky(gram);
    this->MeanCovariance.assign(q * q, 0.0);
    this->MeanFactors.assign(q, 0.0);
    for (std::size_t k = 0; k < q; ++k)
    {
      for (std::size_t m = 0; m < q; ++m)
      {
        this->MeanCovariance[k * q + m] = gram.Column(std::min(k, m))[std::max(k, m)];
        this->MeanFactors[k] += this->MeanCovariance[k * q + m] * factors[m];
      }
    }
    // weights K^-1 (y - H b)
    this->Weights = MakeNumbers(n);
    for (std::size_t i = 0; i < n; ++i)
    {
      this->Weights[i] = this->Means[q * n + i];
      for (std::size_t k = 0; k < q; ++k)
      {
        this->Weights[i] -= this->MeanFactors[k] * this->Means[k * n + i];
      }
    }
    SolveCholeskyUpper(*this->Factors, this->Weights.get());
  }

  // Covariances of a place with all nodes.
  void GetCovariances(const Vec3& place, const MirrorPlane& plane, double* covariances) const
  {
    const Vec3 mirrored = plane.Reflect(place);
    const double roughness = this->GetRoughness(place);
    for (std::size_t i = 0; i < this->Places.size(); ++i)
    {
      covariances[i] =
        (*this->Covariance)(this->Places[i], place, mirrored, roughness * this->Roughness[i]);
    }
  }

  double GetMean(const Vec3& direction, const double* covariances) const
  {
    std::vector<double> terms;
    AppendTerms(direction, this->WithDirection, terms);
    const double mean =
      std::inner_product(terms.begin(), terms.end(), this->MeanFactors.begin(), 0.0);
    return std::inner_product(
      covariances, covariances + this->Places.size(), this->Weights.get(), mean);
  }

  // solved: L^-1 covariances
  double GetError(
    const Vec3& direction, const Vec3& place, const MirrorPlane& plane, const double* solved) const
  {
    const std::size_t n = this->Places.size();
    const std::size_t q = CountTerms(this->WithDirection);
    std::vector<double> rest;
    AppendTerms(direction, this->WithDirection, rest);
    for (std::size_t k = 0; k < q; ++k)
    {
      rest[k] -= std::inner_product(solved, solved + n, &this->Means[k * n], 0.0);
    }
    const double square = this->GetRoughness(place) * this->GetRoughness(place);
    double variance = (*this->Covariance)(place, place, plane.Reflect(place), square) +
      square * this->Variances.Noise - std::inner_product(solved, solved + n, solved, 0.0);
    for (std::size_t k = 0; k < q; ++k)
    {
      for (std::size_t m = 0; m < q; ++m)
      {
        variance += rest[k] * this->MeanCovariance[k * q + m] * rest[m];
      }
    }
    return this->Calibration * std::sqrt(std::max(variance, 0.0));
  }

  bool WithDirection;
  std::vector<Region> Regions;
  std::vector<double> Roughness; ///< of the nodes
  std::vector<Vec3> Places;
  std::vector<double> Values;
  std::vector<double> Terms;
  ShapeVariances Variances;
  double Calibration = 1;
  std::unique_ptr<ShapeCovariance> Covariance;
  std::unique_ptr<SquareMatrix> Factors;
  AlignedNumbers Means;
  AlignedNumbers Weights;
  std::vector<double> MeanFactors;
  std::vector<double> MeanCovariance;
};

namespace
{
// Turns the plane about the middle of the places, and shifts it, to the greatest likelihood: along one
// unknown after the other, to the vertex of the parabola through three values.
MirrorPlane RefinePlane(ShapeLikelihood& likelihood, const ShapeVariances& variances,
  const MirrorPlane& start, const Vec3& middle, const Vec3& ahead, const double (&steps)[2],
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
  const auto costOf = [&](const Vec3& way)
  {
    likelihood.SetPlane(planeOf(way), execution);
    return likelihood.Evaluate(variances);
  };
  Vec3 best{ 0, 0, 0 };
  double cost = costOf(best);
  int done = 0;
  for (const double step : steps)
  {
    for (int i = 0; i < 3; ++i)
    {
      Vec3 trial = best;
      trial[i] = best[i] - step;
      const double before = costOf(trial);
      trial[i] = best[i] + step;
      const double after = costOf(trial);
      const double curvature = before + after - 2 * cost;
      trial[i] = best[i] +
        (curvature > 0       ? std::clamp(0.5 * (before - after) / curvature, -2.0, 2.0)
            : before < after ? -1.0
                             : 1.0) *
          step;
      const double there = costOf(trial);
      if (there < cost)
      {
        best = trial;
        cost = there;
      }
      execution.Report(++done / 6.0);
    }
  }
  const MirrorPlane plane = planeOf(best);
  likelihood.SetPlane(plane, execution);
  return plane;
}

}

//------------------------------------------------------------------------------
SkullShape::SkullShape(const SoundBone& bone, const std::vector<Vec3>& defect,
  const MirrorPlane& plane, Execution& execution, std::size_t likelihoodNodes)
  : Plane(plane)
{
  likelihoodNodes = std::max(likelihoodNodes, LeastNodes);
  Check(bone, defect, plane);
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
  const std::unique_ptr<Field> before = std::move(this->Outer);
  this->Ellipsoid = std::make_unique<Base>(bone, this->Plane);
  this->Outer = this->MakeOuter(bone);
  this->Outer->Variances = before->Variances;
  this->Outer->SetRegions(before->Regions);
  this->Thickness = this->MakeThickness(bone);
  this->Thickness->Start();
  const std::vector<Vec3> places = this->Outer->GetPlaces(subset);
  const std::vector<VirtualHole> regions = SpreadHoles(places, RegionHole);
  const std::vector<VirtualHole> holes = this->FindHolesLike(defect, places);
  Field* const fields[] = { this->Outer.get(), this->Thickness.get() };
  execution.For(2, 1,
    [&](std::int64_t begin, std::int64_t end)
    {
      ThreadExecution serial(1);
      for (std::int64_t i = begin; i < end; ++i)
      {
        Field& field = *fields[i];
        if (i == 1)
        {
          ShapeLikelihood likelihood = field.MakeLikelihood(subset);
          likelihood.SetPlane(this->Plane, serial);
          field.Variances = likelihood.Estimate(field.Variances, FirstIterations + MoreIterations);
          field.FindRegions(likelihood, regions, this->Plane);
        }
        {
          ShapeLikelihood likelihood = field.MakeLikelihood(subset);
          likelihood.SetPlane(this->Plane, serial);
          field.Variances = likelihood.Estimate(field.Variances, LastIterations);
          field.Calibrate(likelihood, holes);
        }
        field.Solve(this->Plane, this->Ellipsoid->GetReach(this->Plane));
      }
    });
}

SkullShape::~SkullShape() = default;

const ShapeVariances& SkullShape::GetOuterVariances() const
{
  return this->Outer->Variances;
}

const ShapeVariances& SkullShape::GetThicknessVariances() const
{
  return this->Thickness->Variances;
}

double SkullShape::GetOuterCalibration() const
{
  return this->Outer->Calibration;
}

double SkullShape::GetThicknessCalibration() const
{
  return this->Thickness->Calibration;
}

//------------------------------------------------------------------------------
std::unique_ptr<SkullShape::Field> SkullShape::MakeOuter(const SoundBone& bone) const
{
  std::vector<Vec3> directions;
  std::vector<double> heights;
  for (const int node : this->Nodes)
  {
    directions.push_back(bone.Directions[node]);
    heights.push_back(bone.Outer[node] - this->Ellipsoid->GetRadius(directions.back()));
  }
  return std::make_unique<Field>(directions, std::move(heights), true, *this->Ellipsoid);
}

std::unique_ptr<SkullShape::Field> SkullShape::MakeThickness(const SoundBone& bone) const
{
  std::vector<Vec3> directions;
  std::vector<double> values;
  for (const int node : this->Nodes)
  {
    directions.push_back(bone.Directions[node]);
    values.push_back(bone.Thickness[node]);
  }
  return std::make_unique<Field>(directions, std::move(values), false, *this->Ellipsoid);
}

//------------------------------------------------------------------------------
// By the outer table over an ellipsoid that is symmetric about the plane; leaves its variances and regions.
void SkullShape::FindPlane(
  const SoundBone& bone, const std::vector<int>& subset, Execution& execution)
{
  const Execution::NestedStages nested(execution);
  for (int round = 0; round < 2; ++round)
  {
    execution.SetStage(0.5 * round, 0.5 * (round + 1));
    this->Ellipsoid = std::make_unique<Base>(bone, this->Plane);
    std::unique_ptr<Field> field = this->MakeOuter(bone);
    if (round == 0)
    {
      field->Start();
    }
    else
    {
      field->Variances = this->Outer->Variances;
      field->SetRegions(this->Outer->Regions);
    }
    Vec3 middle{ 0, 0, 0 };
    for (const Vec3& place : field->Places)
    {
      middle = middle + (1.0 / static_cast<double>(this->Nodes.size())) * place;
    }
    ShapeLikelihood likelihood = field->MakeLikelihood(subset);
    likelihood.SetPlane(this->Plane, execution);
    field->Variances =
      likelihood.Estimate(field->Variances, round == 0 ? FirstIterations : MoreIterations);
    this->Plane = RefinePlane(likelihood, field->Variances, this->Plane, middle,
      field->Places.front() - bone.Center, PlaneSteps[round], execution);
    field->FindRegions(likelihood, SpreadHoles(field->GetPlaces(subset), RegionHole), this->Plane);
    this->Outer = std::move(field);
  }
}

//------------------------------------------------------------------------------
// Virtual holes as large as the defect, those that are nearest to it or to its mirror image.
std::vector<SkullShape::VirtualHole> SkullShape::FindHolesLike(
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
  std::vector<VirtualHole> holes =
    SpreadHoles(places, this->Ellipsoid->Typical * std::sqrt(2 * square));
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
      const AlignedNumbers covariances = MakeNumbers(n * (errors ? block : 1));
      for (std::int64_t b = begin; b < end; ++b)
      {
        const std::int64_t first = b * block;
        const std::int64_t last = std::min(count, first + block);
        for (const Field* field : { this->Outer.get(), this->Thickness.get() })
        {
          const bool outer = field == this->Outer.get();
          for (std::int64_t t = first; t < last; ++t)
          {
            double* column = covariances.get() + (errors ? (t - first) * n : 0);
            const Vec3 place = this->Ellipsoid->GetPlace(directions[t]);
            field->GetCovariances(place, this->Plane, column);
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
          SolveCholeskyLower(*field->Factors, covariances.get(), static_cast<int>(last - first));
          for (std::int64_t t = first; t < last; ++t)
          {
            (outer ? estimates[t].OuterError : estimates[t].ThicknessError) =
              field->GetError(directions[t], this->Ellipsoid->GetPlace(directions[t]), this->Plane,
                covariances.get() + (t - first) * n);
          }
        }
      }
    });
  return estimates;
}
}
