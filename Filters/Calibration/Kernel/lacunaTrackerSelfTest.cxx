// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaTrackerSelfTest.h"

#include "lacunaGeometryGate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <stdexcept>

#include <Eigen/LU>
#include <Eigen/SVD>

namespace lacuna
{
namespace
{
constexpr double Degree = 3.14159265358979323846 / 180;
constexpr std::size_t None = static_cast<std::size_t>(-1);

double GetDistance(const Matrix4& a, const Matrix4& b)
{
  return Norm(a.Column(3) - b.Column(3));
}

using Cell = std::array<std::int64_t, 3>;

Cell GetCell(const Matrix4& pose, double size)
{
  Cell cell;
  for (int axis = 0; axis < 3; ++axis)
  {
    cell[static_cast<std::size_t>(axis)] =
      static_cast<std::int64_t>(std::floor(pose(axis, 3) / size));
  }
  return cell;
}
}

double GetTurn(const Matrix4& a, const Matrix4& b)
{
  // From sine and cosine, so that small angles are exact.
  double twiceCosine = -1;
  Vec3 twiceSine{ 0, 0, 0 };
  for (int axis = 0; axis < 3; ++axis)
  {
    twiceCosine += Dot(a.Column(axis), b.Column(axis));
    twiceSine = twiceSine + Cross(a.Column(axis), b.Column(axis));
  }
  return std::atan2(Norm(twiceSine), twiceCosine) / Degree;
}

ReceiverPlaces::ReceiverPlaces(const std::vector<Matrix4>& poses, double distance, double angle)
{
  std::map<Cell, std::vector<std::size_t>> placesOfCells;
  std::vector<std::size_t> lastPose, lastVisit; // of each place
  const auto findNearest = [&](const Matrix4& pose)
  {
    const Cell cell = GetCell(pose, distance);
    std::size_t nearest = None;
    double smallest = distance;
    for (int n = 0; n < 27; ++n)
    {
      const auto found =
        placesOfCells.find({ cell[0] + n % 3 - 1, cell[1] + n / 3 % 3 - 1, cell[2] + n / 9 - 1 });
      if (found == placesOfCells.end())
      {
        continue;
      }
      for (const std::size_t place : found->second)
      {
        const Matrix4& middle = poses[this->Middles[place]];
        const double away = GetDistance(pose, middle);
        if (away <= smallest && GetTurn(pose, middle) <= angle &&
          (away < smallest || place < nearest))
        {
          nearest = place;
          smallest = away;
        }
      }
    }
    return nearest;
  };
  for (std::size_t i = 0; i < poses.size(); ++i)
  {
    std::size_t place = findNearest(poses[i]);
    bool another = place == None;
    if (another)
    {
      place = this->Middles.size();
      this->Middles.push_back(i);
      lastPose.push_back(i);
      lastVisit.push_back(0);
      placesOfCells[GetCell(poses[i], distance)].push_back(place);
    }
    const Matrix4& middle = poses[this->Middles[place]];
    for (std::size_t k = lastPose[place] + 1; k < i && !another; ++k)
    {
      another =
        GetDistance(poses[k], middle) > 2 * distance || GetTurn(poses[k], middle) > 2 * angle;
    }
    if (another)
    {
      lastVisit[place] = this->Visited.size();
      this->Visited.push_back(place);
    }
    lastPose[place] = i;
    this->Place.push_back(place);
    this->Visit.push_back(lastVisit[place]);
  }
}

//------------------------------------------------------------------------------
void TrackerSelfTestOptions::Describe(Properties& properties) const
{
  properties
    .Add("SpeedLimit", this->SpeedLimit, ValueRange::Above(0, "mm/s").OrZero("none left out"))
    .Add("RevisitDistance", this->RevisitDistance, ValueRange::AtLeast(0.1, "mm"))
    .Add("RevisitAngle", this->RevisitAngle, ValueRange::Above(0, "degrees").UpTo(180))
    .Add("TranslationAccuracy", this->Accuracy.Translation, ValueRange::Above(0, "mm"))
    .Add("AngularAccuracy", this->Accuracy.Angle, ValueRange::Above(0, "degrees"))
    .Add("RangeLimit", this->RangeLimit, ValueRange::Above(0, "mm"));
}

//------------------------------------------------------------------------------
namespace
{
constexpr std::size_t FewestPairs = 10;
constexpr double LargestCoordinate = 1e6; // mm
constexpr double Step = 100;              // mm, of the tables
constexpr std::size_t MostPlaces = 2000;  // whose pairs are compared
constexpr int MedianRounds = 200;
constexpr double FlipGain = 0.2; // what is left of an error when a sign is mended

void Check(const std::vector<ReceiverPair>& pairs, const TrackerSelfTestOptions& options)
{
  Properties properties;
  options.Describe(properties);
  properties.Check();
  for (const ReceiverPair& pair : pairs)
  {
    for (const Matrix4* pose : { &pair.First, &pair.Second })
    {
      if (const GeometryFinding finding = CheckPose(*pose);
          GetAction(GeometryOrigin::Picks, finding.Fault) == GeometryAction::Refuse)
      {
        throw std::invalid_argument("record " + std::to_string(pair.Record) + ": the pose of the " +
          (pose == &pair.First ? "first" : "second") + " receiver " + finding.Text + "; " +
          finding.Advice);
      }
    }
  }
}

Eigen::Matrix3d GetRotation(const Matrix4& pose)
{
  Eigen::Matrix3d rotation;
  for (int i = 0; i < 9; ++i)
  {
    rotation(i / 3, i % 3) = pose(i / 3, i % 3);
  }
  return rotation;
}

Matrix4 ToMatrix4(const Eigen::Matrix3d& rotation, const Vec3& origin)
{
  const auto column = [&](int c) { return Vec3{ rotation(0, c), rotation(1, c), rotation(2, c) }; };
  return Matrix4::FromColumns(column(0), column(1), column(2), origin);
}

// The rotation nearest to a sum of rotations.
Eigen::Matrix3d ToRotation(const Eigen::Matrix3d& sum)
{
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d signs(1, 1, (svd.matrixU() * svd.matrixV().transpose()).determinant());
  return svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
}

// The one of a hundred transforms with the least sum of distances from a thousand: near enough to
// the median for the steps that follow, whatever the others are.
template <class Distance>
std::size_t FindMedoid(std::size_t count, const Distance& distance)
{
  const std::size_t candidateStep = count / 100 + 1, otherStep = count / 1000 + 1;
  std::size_t best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < count; i += candidateStep)
  {
    double sum = 0;
    for (std::size_t k = 0; k < count; k += otherStep)
    {
      sum += distance(i, k);
    }
    if (sum < least)
    {
      least = sum;
      best = i;
    }
  }
  return best;
}

// Least weighted sum of distances, of rotations and of translations (Weiszfeld's iteration).
Matrix4 FindMedian(const std::vector<Matrix4>& transforms, const std::vector<double>& weights)
{
  constexpr double smallestTurn = 1e-7, smallestShift = 1e-7; // degrees, mm
  const std::size_t count = transforms.size();
  Matrix4 turn = transforms[FindMedoid(
    count, [&](std::size_t i, std::size_t k) { return GetTurn(transforms[i], transforms[k]); })];
  Vec3 shift = transforms[FindMedoid(count,
                            [&](std::size_t i, std::size_t k)
                            { return Norm(transforms[i].Column(3) - transforms[k].Column(3)); })]
                 .Column(3);
  for (int round = 0; round < MedianRounds; ++round)
  {
    Eigen::Matrix3d turns = Eigen::Matrix3d::Zero();
    Vec3 shifts{ 0, 0, 0 };
    double sum = 0;
    for (std::size_t i = 0; i < count; ++i)
    {
      turns += weights[i] / std::max(smallestTurn, GetTurn(turn, transforms[i])) *
        GetRotation(transforms[i]);
      const Vec3 place = transforms[i].Column(3);
      const double weight = weights[i] / std::max(smallestShift, Norm(place - shift));
      shifts = shifts + weight * place;
      sum += weight;
    }
    const Matrix4 newTurn = ToMatrix4(ToRotation(turns), { 0, 0, 0 });
    const Vec3 newShift = (1 / sum) * shifts;
    const double change = GetTurn(turn, newTurn) + Norm(newShift - shift);
    turn = newTurn;
    shift = newShift;
    if (change < 1e-9)
    {
      break;
    }
  }
  return Matrix4::Translation(shift) * turn;
}

// Pairs in which no receiver moves faster than a limit, or whose speed is not known.
std::vector<ReceiverPair> SelectSlow(const std::vector<ReceiverPair>& pairs, double limit)
{
  if (limit == 0)
  {
    return pairs;
  }
  std::vector<Matrix4> poses[2];
  std::vector<double> times;
  for (const ReceiverPair& pair : pairs)
  {
    poses[0].push_back(pair.First);
    poses[1].push_back(pair.Second);
    times.push_back(pair.Time);
  }
  const std::vector<char> usable(pairs.size(), 1);
  const std::array<Vec3, 4> origin{};
  const std::vector<double> first = GetSliceSpeeds(poses[0], usable, times, origin);
  const std::vector<double> second = GetSliceSpeeds(poses[1], usable, times, origin);
  std::vector<ReceiverPair> slow;
  for (std::size_t i = 0; i < pairs.size(); ++i)
  {
    if (!(first[i] > limit || second[i] > limit))
    {
      slow.push_back(pairs[i]);
    }
  }
  return slow;
}

// Whether a position with the other sign, of one receiver or both, mends a pair.
bool IsOtherHemisphere(const ReceiverPair& pair, const Matrix4& secondToFirst)
{
  const Vec3 first = pair.First.Column(3), second = pair.Second.Column(3);
  const Vec3 arm = pair.First.Vector(secondToFirst.Column(3));
  const double error = Norm(second - first - arm);
  const double mended = std::min(
    { Norm(second + first - arm), Norm(-1.0 * second - first - arm), Norm(first - second - arm) });
  return error > 0.5 * Norm(arm) && mended < FlipGain * error;
}

void Add(TrackerSelfTest::Errors& sum, const TrackerSelfTest::Sample& sample, double weight)
{
  sum.Separation += weight * sample.SeparationError * sample.SeparationError;
  sum.Position += weight * Dot(sample.Deviation, sample.Deviation);
  sum.Angle += weight * sample.AngleError * sample.AngleError;
}

TrackerSelfTest::Errors Root(const TrackerSelfTest::Errors& sum, double weights)
{
  return { std::sqrt(sum.Separation / weights), std::sqrt(sum.Position / weights),
    std::sqrt(sum.Angle / weights) };
}

TrackerSelfTest::Errors GetExpected(const TrackerAccuracy& accuracy, double separation)
{
  // Along the line between them receivers err by a third of the square each. Turns of the first
  // receiver move the second one when their axis lies across, which two thirds of the square do.
  const double swing = 2 * separation * std::sin(accuracy.Angle * Degree / 2);
  return { std::sqrt(2.0 / 3) * accuracy.Translation,
    std::sqrt(2 * accuracy.Translation * accuracy.Translation + 2.0 / 3 * swing * swing),
    std::sqrt(2.0) * accuracy.Angle };
}

// The median of the transforms from the second receiver to the first; each place counts once.
struct MedianFit
{
  MedianFit(const std::vector<ReceiverPair>& pairs, const TrackerSelfTestOptions& options)
    : Places(GetFirst(pairs), options.RevisitDistance, options.RevisitAngle)
  {
    for (const ReceiverPair& pair : pairs)
    {
      this->Transforms.push_back(pair.First.Inverse() * pair.Second);
    }
    std::vector<std::size_t> counts(this->Places.Middles.size(), 0);
    for (const std::size_t place : this->Places.Place)
    {
      ++counts[place];
    }
    for (const std::size_t place : this->Places.Place)
    {
      this->Weights.push_back(1 / static_cast<double>(counts[place]));
    }
    this->SecondToFirst = FindMedian(this->Transforms, this->Weights);
  }

  static std::vector<Matrix4> GetFirst(const std::vector<ReceiverPair>& pairs)
  {
    std::vector<Matrix4> poses;
    for (const ReceiverPair& pair : pairs)
    {
      poses.push_back(pair.First);
    }
    return poses;
  }

  ReceiverPlaces Places;
  std::vector<Matrix4> Transforms; // of the pairs
  std::vector<double> Weights;     // of the pairs
  Matrix4 SecondToFirst;
};

// Sums and extremes over the samples.
class Summary
{
public:
  void Include(const TrackerSelfTest::Sample& sample, double separation, double weight)
  {
    this->Nearest = std::min(this->Nearest, separation);
    this->Farthest = std::max(this->Farthest, separation);
    for (int axis = 0; axis < 3; ++axis)
    {
      this->Low[axis] = std::min(this->Low[axis], sample.Middle[axis]);
      this->High[axis] = std::max(this->High[axis], sample.Middle[axis]);
    }
    Add(this->Squares, sample, weight);
    const auto step = static_cast<std::int64_t>(std::floor(sample.Distance / Step));
    auto& [row, weights] = this->ByDistance[step];
    row.From = Step * static_cast<double>(step);
    row.To = row.From + Step;
    ++row.Samples;
    Add(row.Rms, sample, weight);
    weights += weight;
  }

  void Set(TrackerSelfTest& result)
  {
    result.Rms = Root(this->Squares, static_cast<double>(result.Places));
    result.SeparationRange = this->Farthest - this->Nearest;
    result.Extent = Norm(this->High - this->Low);
    for (auto& [step, found] : this->ByDistance)
    {
      found.first.Rms = Root(found.first.Rms, found.second);
      result.ByDistance.push_back(found.first);
    }
  }

private:
  static constexpr double Infinity = std::numeric_limits<double>::infinity();
  TrackerSelfTest::Errors Squares;
  std::map<std::int64_t, std::pair<TrackerSelfTest::DistanceRow, double>> ByDistance;
  double Nearest = Infinity, Farthest = 0;
  Vec3 Low{ Infinity, Infinity, Infinity }, High{ -Infinity, -Infinity, -Infinity };
};
}

TrackerSelfTest TrackerSelfTest::Solve(
  const std::vector<ReceiverPair>& pairs, const TrackerSelfTestOptions& options)
{
  Check(pairs, options);
  TrackerSelfTest result;
  result.Options = options;
  std::vector<ReceiverPair> used = SelectSlow(pairs, options.SpeedLimit);
  result.TooFast = pairs.size() - used.size();
  const auto fitMedian = [&]
  {
    if (used.size() < FewestPairs)
    {
      throw std::invalid_argument("only " + std::to_string(used.size()) + " of " +
        std::to_string(pairs.size()) + " pairs of poses can be used (" +
        std::to_string(result.TooFast) + " too fast, " + std::to_string(result.OtherHemisphere) +
        " in the other hemisphere); at least " + std::to_string(FewestPairs) +
        " are needed, better some hundreds all over the working volume");
    }
    return MedianFit(used, options);
  };
  MedianFit fit = fitMedian();
  const std::size_t before = used.size();
  used.erase(
    std::remove_if(used.begin(), used.end(),
      [&](const ReceiverPair& pair) { return IsOtherHemisphere(pair, fit.SecondToFirst); }),
    used.end());
  if (used.size() < before)
  {
    result.OtherHemisphere = before - used.size();
    fit = fitMedian();
  }
  result.SecondToFirst = fit.SecondToFirst;
  result.Separation = Norm(result.SecondToFirst.Column(3));
  result.Expected = GetExpected(options.Accuracy, result.Separation);
  result.Places = fit.Places.Middles.size();
  Summary summary;
  for (std::size_t i = 0; i < used.size(); ++i)
  {
    const Vec3 first = used[i].First.Column(3), second = used[i].Second.Column(3);
    Sample sample;
    sample.Record = used[i].Record;
    sample.Middle = 0.5 * (first + second);
    sample.Deviation = second - used[i].First.Point(result.SecondToFirst.Column(3));
    const double separation = Norm(second - first);
    sample.SeparationError = separation - result.Separation;
    sample.AngleError = GetTurn(fit.Transforms[i], result.SecondToFirst);
    sample.Distance = std::max(Norm(first), Norm(second));
    sample.Place = fit.Places.Place[i];
    summary.Include(sample, separation, fit.Weights[i]);
    result.AddSample(sample);
  }
  summary.Set(result);
  result.CompareVisits(fit.Places.Visit, fit.Places.Visited);
  return result;
}

void TrackerSelfTest::AddSample(const Sample& sample)
{
  this->Largest.Separation = std::max(this->Largest.Separation, std::abs(sample.SeparationError));
  this->Largest.Angle = std::max(this->Largest.Angle, sample.AngleError);
  if (Norm(sample.Deviation) > this->Largest.Position)
  {
    this->Largest.Position = Norm(sample.Deviation);
    this->Worst = this->Samples.size();
  }
  this->Samples.push_back(sample);
}

// What is noise, what comes back, and what changes from place to place.
void TrackerSelfTest::CompareVisits(
  const std::vector<std::size_t>& visits, const std::vector<std::size_t>& placesOfVisits)
{
  struct Mean
  {
    Vec3 Value{ 0, 0, 0 };
    double Count = 0;
    void Add(const Vec3& value)
    {
      ++this->Count;
      this->Value = this->Value + (1 / this->Count) * (value - this->Value);
    }
  };
  std::vector<Mean> means(placesOfVisits.size()), places(this->Places);
  for (std::size_t i = 0; i < this->Samples.size(); ++i)
  {
    means[visits[i]].Add(this->Samples[i].Deviation);
  }
  for (std::size_t visit = 0; visit < means.size(); ++visit)
  {
    places[placesOfVisits[visit]].Add(means[visit].Value);
  }
  const auto square = [](const Vec3& a, const Vec3& b) { return Dot(a - b, a - b); };
  double within = 0, between = 0, warp = 0;
  for (std::size_t i = 0; i < this->Samples.size(); ++i)
  {
    within += square(this->Samples[i].Deviation, means[visits[i]].Value);
  }
  for (std::size_t visit = 0; visit < means.size(); ++visit)
  {
    between += square(means[visit].Value, places[placesOfVisits[visit]].Value);
  }
  for (const Mean& place : places)
  {
    warp += Dot(place.Value, place.Value);
    this->Revisited += place.Count > 1;
  }
  const auto freedom = [](std::size_t values, std::size_t groups)
  { return static_cast<double>(values - groups); };
  const double samples = freedom(this->Samples.size(), means.size());
  const double returns = freedom(means.size(), places.size());
  this->Noise = samples > 0 ? std::sqrt(within / samples) : 0;
  this->Repeatability =
    returns > 0 ? std::sqrt(between / returns) : std::numeric_limits<double>::quiet_NaN();
  this->Warp = std::sqrt(warp / static_cast<double>(places.size()));

  std::vector<Vec3> middles(this->Places);
  for (const Sample& sample : this->Samples)
  {
    middles[sample.Place] = sample.Middle;
  }
  std::map<std::int64_t, ApartRow> byApart;
  const std::size_t stride = this->Places / MostPlaces + 1;
  for (std::size_t a = 0; a < this->Places; a += stride)
  {
    for (std::size_t b = 0; b < a; b += stride)
    {
      const auto step = static_cast<std::int64_t>(Norm(middles[a] - middles[b]) / Step);
      ApartRow& row =
        byApart.try_emplace(step, ApartRow{ Step * double(step), Step * double(step + 1), 0, 0 })
          .first->second;
      ++row.Pairs;
      row.Position += square(places[a].Value, places[b].Value);
    }
  }
  for (auto& [step, row] : byApart)
  {
    row.Position = std::sqrt(row.Position / static_cast<double>(row.Pairs));
    this->ByApart.push_back(row);
  }
}
}
