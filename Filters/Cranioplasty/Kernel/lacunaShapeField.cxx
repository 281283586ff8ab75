// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaShapeField.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <new>
#include <numeric>
#include <stdexcept>
#include <utility>

namespace lacuna
{
namespace
{
// Size of the regions, mm; the weight of a roughness of 1, which is expected where no hole was.
constexpr double RegionSize = 25;
constexpr double RegionPrior = 0.3;
// How far errors may be stretched by virtual holes.
constexpr double LeastCalibration = 0.4;
constexpr double MostCalibration = 3;
// Of an example's factor: standard errors above 0, and the most that is believed.
constexpr double LeastCertainty = 3;
constexpr double MostFactor = 2;
constexpr double Normal95 = 1.959963984540054;

double SquaredDistance(const Vec3& a, const Vec3& b)
{
  const Vec3 d = a - b;
  return Dot(d, d);
}

std::vector<std::vector<int>> PlacesOf(const std::vector<VirtualHole>& holes)
{
  std::vector<std::vector<int>> places;
  for (const VirtualHole& hole : holes)
  {
    places.push_back(hole.Places);
  }
  return places;
}
}

AlignedNumbers MakeAligned(std::size_t count)
{
  return AlignedNumbers(new (std::align_val_t{ 64 }) double[count]);
}

std::vector<VirtualHole> SpreadHoles(const std::vector<Vec3>& places, double radius)
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
ShapeField::ShapeField(const std::vector<Vec3>& directions, std::vector<Vec3> places,
  std::vector<double> values, bool withDirection, ShapeExample example)
  : WithDirection(withDirection)
  , Example(std::move(example))
  , Places(std::move(places))
  , Values(std::move(values))
  , Roughness(Places.size(), 1)
{
  for (const Vec3& d : directions)
  {
    this->AppendTerms(d, this->Terms);
  }
  // the likelihood finds variances from any start
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

// 1, by choice the direction, and the example.
void ShapeField::AppendTerms(const Vec3& direction, std::vector<double>& terms) const
{
  terms.push_back(1);
  if (this->WithDirection)
  {
    terms.insert(terms.end(), direction.data(), direction.data() + 3);
  }
  if (this->Example)
  {
    terms.push_back(this->Example(direction));
  }
}

ShapeLikelihood ShapeField::MakeLikelihood(const std::vector<int>& subset) const
{
  const std::size_t q = this->GetNumberOfTerms();
  std::vector<Vec3> places;
  std::vector<double> values;
  std::vector<double> terms;
  std::vector<double> roughness;
  for (const int node : subset)
  {
    roughness.push_back(this->Roughness[node]);
    places.push_back(this->Places[node]);
    values.push_back(this->Values[node]);
    terms.insert(terms.end(), this->Terms.begin() + node * q, this->Terms.begin() + (node + 1) * q);
  }
  return ShapeLikelihood(
    std::move(places), std::move(values), std::move(terms), std::move(roughness));
}

std::vector<Vec3> ShapeField::GetPlaces(const std::vector<int>& subset) const
{
  std::vector<Vec3> places;
  for (const int node : subset)
  {
    places.push_back(this->Places[node]);
  }
  return places;
}

void ShapeField::Continue(const ShapeField& other)
{
  this->Variances = other.Variances;
  this->SetRegions(other.Regions);
}

void ShapeField::SetRegions(std::vector<Region> regions)
{
  this->Regions = std::move(regions);
  for (std::size_t i = 0; i < this->Places.size(); ++i)
  {
    this->Roughness[i] = this->GetRoughness(this->Places[i]);
  }
}

bool ShapeField::IsLikeExample(const ShapeLikelihood& likelihood) const
{
  const auto [factor, error] = likelihood.GetLastFactor(this->Variances);

  return factor > LeastCertainty * error && factor < MostFactor;
}

void ShapeField::FindRegions(const ShapeLikelihood& likelihood,
  const std::vector<VirtualHole>& holes, const MirrorPlane& plane)
{
  const std::vector<std::vector<double>> ratios =
    likelihood.LeaveOut(this->Variances, PlacesOf(holes));
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
      const double present = this->GetRoughness(holes[h].Middle); // predicted errors have it
      regions.push_back(
        { holes[h].Middle, plane.Reflect(holes[h].Middle), present * present * square });
    }
  }
  this->SetRegions(std::move(regions));
}

double ShapeField::GetRoughness(const Vec3& place) const
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

void ShapeField::Calibrate(const ShapeLikelihood& likelihood, const std::vector<VirtualHole>& holes)
{
  std::vector<double> all;
  for (const std::vector<double>& ratios : likelihood.LeaveOut(this->Variances, PlacesOf(holes)))
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

//------------------------------------------------------------------------------
void ShapeField::Solve(const MirrorPlane& plane, double reach)
{
  this->Plane = plane;
  const std::size_t n = this->Places.size();
  const std::size_t q = this->GetNumberOfTerms();
  this->Covariance = std::make_unique<ShapeCovariance>(this->Variances, reach);
  this->Factors = std::make_unique<SquareMatrix>(n);
  this->Nodes.clear();
  for (std::size_t i = 0; i < n; ++i)
  {
    this->Nodes.emplace_back(this->Places[i], plane, this->Roughness[i]);
  }
  for (std::size_t j = 0; j < n; ++j)
  {
    double* column = this->Factors->Column(j);
    for (std::size_t i = j; i < n; ++i)
    {
      column[i] = (*this->Covariance)(this->Nodes[i], this->Nodes[j]);
    }
    column[j] += this->Roughness[j] * this->Roughness[j] * this->Variances.Noise;
  }
  if (!FactorCholesky(*this->Factors))
  {
    throw std::runtime_error("the equations of the skull's shape cannot be solved: points of the "
                             "sound bone coincide");
  }
  // [L^-1 H, L^-1 y]
  this->Means = MakeAligned(n * (q + 1));
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
  this->Weights = MakeAligned(n);
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

void ShapeField::GetCovariances(const Vec3& place, double* covariances) const
{
  const ShapePlace there(place, this->Plane, this->GetRoughness(place));
  for (std::size_t i = 0; i < this->Nodes.size(); ++i)
  {
    covariances[i] = (*this->Covariance)(this->Nodes[i], there);
  }
}

double ShapeField::GetMean(const Vec3& direction, const double* covariances) const
{
  std::vector<double> terms;
  this->AppendTerms(direction, terms);
  const double mean =
    std::inner_product(terms.begin(), terms.end(), this->MeanFactors.begin(), 0.0);
  return std::inner_product(
    covariances, covariances + this->Places.size(), this->Weights.get(), mean);
}

double ShapeField::GetError(const Vec3& direction, const Vec3& place, const double* solved) const
{
  const std::size_t n = this->Places.size();
  const std::size_t q = this->GetNumberOfTerms();
  std::vector<double> rest;
  this->AppendTerms(direction, rest);
  for (std::size_t k = 0; k < q; ++k)
  {
    rest[k] -= std::inner_product(solved, solved + n, &this->Means[k * n], 0.0);
  }
  const ShapePlace there(place, this->Plane, this->GetRoughness(place));
  double variance = (*this->Covariance)(there, there) +
    there.Roughness * there.Roughness * this->Variances.Noise -
    std::inner_product(solved, solved + n, solved, 0.0);
  for (std::size_t k = 0; k < q; ++k)
  {
    for (std::size_t m = 0; m < q; ++m)
    {
      variance += rest[k] * this->MeanCovariance[k * q + m] * rest[m];
    }
  }
  return this->Calibration * std::sqrt(std::max(variance, 0.0));
}
}
