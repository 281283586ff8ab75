// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSkullTemplate.h"

#include "lacunaShapeLikelihood.h"
#include "lacunaSkullEllipsoid.h"
#include "lacunaSymmetricFactorization.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <stdexcept>
#include <utility>

namespace lacuna
{
namespace
{
constexpr double Pi = 3.14159265358979323846;
// The search over all turns: how far they are apart (radians), rays of the skull, turns that are refined.
constexpr double TurnSpacing = 0.26;
constexpr std::size_t SearchRays = 300;
constexpr std::size_t Candidates = 10;
constexpr int CandidateSteps = 8;
constexpr double MapSpacing = 4 * Pi / 180; // of the template's map
// The last steps.
constexpr std::size_t FitRays = 2000;
constexpr int FitSteps = 30;
constexpr double Settled = 1e-4;    // mm, of the largest motion
constexpr double MostError = 8;     // mm: a larger one counts as much in the search
constexpr double Baseline = 0.05;   // radians, of the template's slope
constexpr double LeastCosine = 0.5; // of the angle between ray and the template's normal
// Tukey's biweight: of the median error, and the least, mm.
constexpr double BiweightLimit = 4.685 * 1.4826;
constexpr double LeastLimit = 0.05;
constexpr int MiddlePasses = 4;
constexpr std::size_t Unknowns = 7;
// Examples: widths of the Gaussian (mm at TypicalRadius) that makes them smooth and of those that bridge gaps, of which
// rays each takes one, which part of a full weight leaves half to the next one, and the width between rays.
constexpr double TypicalRadius = 90;
struct Bridge
{
  double Width;
  std::size_t Step;
};
constexpr Bridge Bridges[] = { { 5, 1 }, { 20, 9 }, { 72, 81 } };
constexpr double HalfWeight = 0.05;
constexpr double BetweenRays = 2.5;
constexpr double LeastVariation = 0.02; // mm, RMS: of a sphere's
constexpr double Widths = 3;            // where a Gaussian ends

double MedianOf(std::vector<double> values)
{
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

SoundBone Thinned(const SoundBone& bone, std::size_t count)
{
  const std::size_t step = std::max<std::size_t>(1, bone.Outer.size() / count);
  SoundBone thin;
  thin.Center = bone.Center;
  for (std::size_t i = 0; i < bone.Outer.size(); i += step)
  {
    thin.Directions.push_back(bone.Directions[i]);
    thin.Outer.push_back(bone.Outer[i]);
  }
  return thin;
}

// Radii of a template around a point, for quick looks.
class TemplateMap
{
public:
  TemplateMap(const SkullShell& shell, const Vec3& center, Execution& execution)
    : Rows(static_cast<int>(std::lround(Pi / MapSpacing)))
  {
    std::vector<Vec3> directions;
    for (int row = 0; row < this->Rows; ++row)
    {
      const double polar = Pi * (row + 0.5) / this->Rows;
      for (int column = 0; column < 2 * this->Rows; ++column)
      {
        const double turn = Pi * (column + 0.5) / this->Rows - Pi;
        directions.push_back(
          { std::sin(polar) * std::cos(turn), std::sin(polar) * std::sin(turn), std::cos(polar) });
      }
    }
    this->Radii = shell.Trace(center, directions, execution).Outer;
  }
  double operator()(const Vec3& d) const
  {
    const int row = static_cast<int>(std::acos(std::clamp(d[2], -1.0, 1.0)) / Pi * this->Rows);
    const int column = static_cast<int>((std::atan2(d[1], d[0]) + Pi) / Pi * this->Rows);
    return this->Radii[std::min(row, this->Rows - 1) * 2 * this->Rows +
      std::min(column, 2 * this->Rows - 1)];
  }

private:
  int Rows;
  std::vector<double> Radii;
};

// Values at directions, and their mean with Gaussian weights.
class Averages
{
public:
  // Of each step-th direction, where the value is one.
  Averages(const std::vector<Vec3>& directions, const std::vector<double>& values, double width,
    std::size_t step)
    : Width(width / TypicalRadius)
  {
    for (std::size_t i = 0; i < directions.size(); i += step)
    {
      if (std::isfinite(values[i]))
      {
        this->Known.emplace_back(directions[i], values[i]);
      }
    }
    std::stable_sort(this->Known.begin(), this->Known.end(),
      [](const auto& a, const auto& b) { return a.first[2] < b.first[2]; });
    // of directions all around
    const double share = static_cast<double>((directions.size() + step - 1) / step) / (4 * Pi);
    this->FullWeight = share * 2 * Pi * this->Width * this->Width;
  }

  // The mean, and the sum of the weights, 1 for all around.
  std::pair<double, double> Get(const Vec3& direction) const
  {
    const double reach = Widths * this->Width;
    const double cosine = reach < Pi ? std::cos(reach) : -2;
    double sum = 0;
    double weights = 0;
    auto place = std::lower_bound(this->Known.begin(), this->Known.end(), direction[2] - reach,
      [](const auto& known, double z) { return known.first[2] < z; });
    for (; place != this->Known.end() && place->first[2] <= direction[2] + reach; ++place)
    {
      const double c = Dot(place->first, direction);
      if (c > cosine)
      {
        const double weight = std::exp((c - 1) / (this->Width * this->Width));
        sum += weight * place->second;
        weights += weight;
      }
    }
    return { weights > 0 ? sum / weights : 0, weights / this->FullWeight };
  }

private:
  double Width;
  double FullWeight = 1;
  std::vector<std::pair<Vec3, double>> Known; // in the order of z
};

// Empty for values that are nearly the same everywhere.
ShapeExample MakeExample(
  const std::vector<Vec3>& directions, const std::vector<double>& values, const MirrorPlane& plane)
{
  std::vector<Vec3> bothSides;
  std::vector<double> twice;
  for (std::size_t i = 0; i < directions.size(); ++i)
  {
    bothSides.push_back(directions[i]);
    bothSides.push_back(plane.ReflectDirection(directions[i]));
    twice.insert(twice.end(), 2, values[i]);
  }
  std::vector<Averages> levels;
  for (const Bridge& bridge : Bridges)
  {
    levels.emplace_back(bothSides, twice, bridge.Width, bridge.Step);
  }
  std::vector<double> smooth;
  for (const Vec3& d : directions)
  {
    double value = 0;
    double rest = 1; // of the weight
    for (const Averages& level : levels)
    {
      const auto [mean, weight] = level.Get(d);
      const double share = rest * weight / (weight + HalfWeight);
      value += share * mean;
      rest -= share;
    }
    smooth.push_back(value);
  }
  double square = 0;
  for (const double value : smooth)
  {
    square += value * value / static_cast<double>(smooth.size());
  }
  if (!(std::sqrt(square) > LeastVariation))
  {
    return {};
  }
  return [averages = std::make_shared<const Averages>(directions, smooth, BetweenRays, 1)](
           const Vec3& d) { return averages->Get(d).first; };
}

// The middle of the sphere through the vault.
Vec3 FindTemplateCenter(const SkullShell& shell, double& radius, Execution& execution)
{
  Vec3 center = shell.GetMiddle(execution);
  const double spacing = 8.0 / 90;
  const std::vector<Vec3> directions = SpreadDirections(spacing, {});
  for (int pass = 0; pass < MiddlePasses; ++pass)
  {
    const SkullRays rays =
      ClassifySkull(center, directions, spacing, shell.Trace(center, directions, execution));
    std::vector<Vec3> points;
    std::vector<double> radii;
    for (std::size_t i = 0; i < rays.Kinds.size(); ++i)
    {
      if (rays.Kinds[i] == SkullRayKind::Sound)
      {
        points.push_back(center + rays.Outer[i] * rays.Directions[i]);
        radii.push_back(rays.Outer[i]);
      }
    }
    center = FindSphereMiddle(center, points);
    radius = MedianOf(radii);
  }
  return center;
}

// Turns that are evenly spread: each takes the z axis to one of the directions, and then about it.
std::vector<Matrix4> SpreadTurns()
{
  std::vector<Matrix4> turns;
  const int rolls = static_cast<int>(std::lround(2 * Pi / TurnSpacing));
  for (const Vec3& z : SpreadDirections(TurnSpacing, {}))
  {
    const Vec3 x = Normalized(Cross(std::abs(z[0]) < 0.8 ? Vec3{ 1, 0, 0 } : Vec3{ 0, 1, 0 }, z));
    const Vec3 y = Cross(z, x);
    for (int roll = 0; roll < rolls; ++roll)
    {
      const double angle = 2 * Pi * roll / rolls;
      const Vec3 u = std::cos(angle) * x + std::sin(angle) * y;
      turns.push_back(Matrix4::FromColumns(u, Cross(z, u), z, { 0, 0, 0 }));
    }
  }
  return turns;
}

double AngleBetween(const Matrix4& a, const Matrix4& b)
{
  double trace = 0;
  for (int c = 0; c < 3; ++c)
  {
    trace += Dot(a.Column(c), b.Column(c));
  }
  return std::acos(std::clamp(0.5 * (trace - 1), -1.0, 1.0));
}

// A template's place while it is sought: x of the skull = Scale Turn (x of the template - Center) + Place.
struct Pose
{
  Matrix4 Turn;
  double Scale = 1;
  Vec3 Place{ 0, 0, 0 };
};

class TemplateSearch
{
public:
  TemplateSearch(
    const SkullShell& shell, const Vec3& center, const SoundBone& bone, Execution& execution)
    : Shell(shell)
    , Center(center)
    , Bone(bone)
    , Run(execution)
  {
  }

  // Of each ray, template minus bone, mm; NaN without template. normals, if given, of the template.
  std::vector<double> GetErrors(const Pose& pose, std::vector<Vec3>* normals = nullptr) const
  {
    const Matrix4 back = pose.Turn.Inverse();
    const Vec3 from = this->Center + (1 / pose.Scale) * back.Vector(this->Bone.Center - pose.Place);
    std::vector<Vec3> directions;
    for (const Vec3& d : this->Bone.Directions)
    {
      directions.push_back(back.Vector(d));
      if (normals)
      {
        const Vec3 u = Normalized(
          Cross(directions.back(), std::abs(d[0]) < 0.8 ? Vec3{ 1, 0, 0 } : Vec3{ 0, 1, 0 }));
        const Vec3 v = Cross(directions.back(), u);
        const Vec3 here = directions.back();
        directions.push_back(Normalized(here + Baseline * u));
        directions.push_back(Normalized(here + Baseline * v));
      }
    }
    const std::vector<double> radii = this->Shell.Trace(from, directions, this->Run).Outer;
    std::vector<double> errors;
    const std::size_t step = normals ? 3 : 1;
    for (std::size_t i = 0; i < this->Bone.Outer.size(); ++i)
    {
      const std::size_t k = step * i;
      errors.push_back(pose.Scale * radii[k] - this->Bone.Outer[i]);
      if (normals)
      {
        const Vec3 here = radii[k] * directions[k];
        const Vec3 normal = Normalized(
          Cross(radii[k + 1] * directions[k + 1] - here, radii[k + 2] * directions[k + 2] - here));
        normals->push_back(pose.Turn.Vector(Dot(normal, directions[k]) < 0 ? -1 * normal : normal));
      }
    }
    return errors;
  }

  // A step of Gauss and Newton; how far it goes at most, mm.
  double Improve(Pose& pose, double leastLimit) const
  {
    std::vector<Vec3> normals;
    const std::vector<double> errors = this->GetErrors(pose, &normals);
    const double limit = std::max(leastLimit, GetLimit(errors));
    SquareMatrix matrix(Unknowns);
    std::fill_n(matrix.Column(0), Unknowns * Unknowns, 0.0);
    const AlignedNumbers step = MakeAligned(Unknowns);
    std::fill_n(step.get(), Unknowns, 0.0);
    for (std::size_t i = 0; i < errors.size(); ++i)
    {
      const Vec3& d = this->Bone.Directions[i];
      const double cosine = Dot(normals[i], d);
      if (!(std::abs(errors[i]) < limit) || !(cosine > LeastCosine))
      {
        continue;
      }
      const double inside = 1 - errors[i] * errors[i] / (limit * limit);
      const double weight = inside * inside;
      const Vec3 arm =
        (this->Bone.Outer[i] + errors[i]) * d; // turns and scale about the skull's centre
      const Vec3 turn = Cross(arm, normals[i]);
      const double along = Dot(arm, normals[i]) / Arm;
      const double slopes[Unknowns] = { turn[0] / Arm / cosine, turn[1] / Arm / cosine,
        turn[2] / Arm / cosine, normals[i][0] / cosine, normals[i][1] / cosine,
        normals[i][2] / cosine, along / cosine };
      for (std::size_t a = 0; a < Unknowns; ++a)
      {
        step[a] -= weight * slopes[a] * errors[i];
        for (std::size_t b = a; b < Unknowns; ++b)
        {
          matrix.Column(a)[b] += weight * slopes[a] * slopes[b];
        }
      }
    }
    double largest = 0;
    for (std::size_t a = 0; a < Unknowns; ++a)
    {
      largest = std::max(largest, matrix.Column(a)[a]);
    }
    for (std::size_t a = 0; a < Unknowns; ++a)
    {
      matrix.Column(a)[a] += 1e-6 * largest; // a sphere may turn
    }
    if (!(largest > 0) || !FactorCholesky(matrix))
    {
      return 0;
    }
    SolveCholeskyLower(matrix, step.get(), 1);
    SolveCholeskyUpper(matrix, step.get());
    double most = 0;
    for (std::size_t a = 0; a < Unknowns; ++a)
    {
      most = std::max(most, std::abs(step[a]));
    }
    const double factor = most > MostStep ? MostStep / most : 1;
    const Vec3 axis{ step[0], step[1], step[2] };
    const Matrix4 turn =
      Matrix4::Rotation(Norm(axis) > 0 ? axis : Vec3{ 1, 0, 0 }, factor * Norm(axis) / Arm);
    const double scale = std::exp(factor * step[6] / Arm);
    pose.Place = this->Bone.Center + scale * turn.Vector(pose.Place - this->Bone.Center) +
      factor * Vec3{ step[3], step[4], step[5] };
    pose.Turn = turn * pose.Turn;
    pose.Scale *= scale;
    return factor * most;
  }

  double GetLoss(const Pose& pose) const { return Loss(this->GetErrors(pose)); }

  static double Loss(const std::vector<double>& errors)
  {
    double sum = 0;
    for (const double e : errors)
    {
      sum += std::abs(e) < MostError ? e * e : MostError * MostError;
    }
    return sum / static_cast<double>(errors.size());
  }

  // Of the biweight.
  static double GetLimit(const std::vector<double>& errors)
  {
    std::vector<double> sizes;
    for (const double e : errors)
    {
      if (!std::isnan(e))
      {
        sizes.push_back(std::abs(e));
      }
    }
    return sizes.empty() ? 0 : BiweightLimit * MedianOf(sizes);
  }

private:
  static constexpr double Arm = 90;      // mm: what turns and scale move
  static constexpr double MostStep = 10; // mm
  const SkullShell& Shell;
  Vec3 Center;
  const SoundBone& Bone;
  Execution& Run;
};
}

//------------------------------------------------------------------------------
VolumeShell::VolumeShell(const VoxelVolume& volume, double level)
  : Volume(volume)
  , Level(level)
{
  CheckVolumeSize(volume.Size);
  if (!std::isfinite(level))
  {
    throw std::invalid_argument("the template's level is not finite");
  }
}

RayRadii VolumeShell::Trace(
  const Vec3& center, const std::vector<Vec3>& directions, Execution& execution) const
{
  return TraceRays(this->Volume, this->Level, center, directions, execution);
}

Vec3 VolumeShell::GetMiddle(Execution& execution) const
{
  return FindMeanOfBone(this->Volume, this->Level, execution);
}

//------------------------------------------------------------------------------
namespace
{
// Around the middle of the skull's sphere, as around that of the template's, which has a radius.
Pose FindStart(const SoundBone& bone, double radius)
{
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < bone.Outer.size(); ++i)
  {
    points.push_back(bone.Center + bone.Outer[i] * bone.Directions[i]);
  }
  Pose start;
  start.Place = FindSphereMiddle(bone.Center, points);
  std::vector<double> radii;
  for (const Vec3& p : points)
  {
    radii.push_back(Norm(p - start.Place));
  }
  start.Scale = MedianOf(radii) / radius;
  return start;
}

// How badly the template fits in each turn.
std::vector<double> FindLosses(const TemplateMap& map, const SoundBone& bone, const Pose& start,
  const std::vector<Matrix4>& turns, Execution& execution)
{
  std::vector<double> losses(turns.size());
  execution.For(static_cast<std::int64_t>(turns.size()), 16,
    [&](std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t t = begin; t < end; ++t)
      {
        const Matrix4 back = turns[t].Inverse();
        std::vector<double> errors;
        for (std::size_t i = 0; i < bone.Outer.size(); ++i)
        {
          const Vec3 arm = bone.Center + bone.Outer[i] * bone.Directions[i] - start.Place;
          const double length = Norm(arm);
          errors.push_back(start.Scale * map(back.Vector((1 / length) * arm)) - length);
        }
        losses[t] = TemplateSearch::Loss(errors);
      }
    });
  return losses;
}

// The turns with the least losses that are not nearly the same.
std::vector<Matrix4> ChooseTurns(
  const std::vector<Matrix4>& turns, const std::vector<double>& losses)
{
  std::vector<std::size_t> order(turns.size());
  for (std::size_t i = 0; i < order.size(); ++i)
  {
    order[i] = i;
  }
  std::stable_sort(order.begin(), order.end(),
    [&](std::size_t a, std::size_t b) { return losses[a] < losses[b]; });
  std::vector<Matrix4> candidates;
  for (std::size_t k = 0; k < order.size() && candidates.size() < Candidates; ++k)
  {
    const Matrix4& turn = turns[order[k]];
    if (std::none_of(candidates.begin(), candidates.end(),
          [&](const Matrix4& other) { return AngleBetween(turn, other) < 1.5 * TurnSpacing; }))
    {
      candidates.push_back(turn);
    }
  }
  return candidates;
}

// Improves the start in each turn a little, and returns the best.
Pose FindBest(const TemplateSearch& search, const Pose& start, const std::vector<Matrix4>& turns)
{
  Pose best;
  double least = std::numeric_limits<double>::infinity();
  for (const Matrix4& turn : turns)
  {
    Pose pose = start;
    pose.Turn = turn;
    for (int step = 0; step < CandidateSteps; ++step)
    {
      search.Improve(pose, MostError);
    }
    const double loss = search.GetLoss(pose);
    if (loss < least)
    {
      least = loss;
      best = pose;
    }
  }
  return best;
}

// center: of the template. errors: in the pose.
TemplateFit Describe(const Pose& pose, const Vec3& center, const std::vector<double>& errors)
{
  const double limit = std::max(LeastLimit, TemplateSearch::GetLimit(errors));
  double count = 0;
  double square = 0;
  double covered = 0;
  for (const double e : errors)
  {
    covered += std::isnan(e) ? 0 : 1;
    if (std::abs(e) < limit)
    {
      count += 1;
      square += e * e;
    }
  }
  TemplateFit fit;
  fit.TemplateToSkull = Matrix4::Translation(pose.Place) * pose.Turn *
    Matrix4::Scaling({ pose.Scale, pose.Scale, pose.Scale }) * Matrix4::Translation(-1 * center);
  fit.Scale = pose.Scale;
  fit.RMS = std::sqrt(square / std::max(count, 1.0));
  fit.Covered = covered / static_cast<double>(errors.size());
  return fit;
}
}

//------------------------------------------------------------------------------
TemplateFit FitTemplate(const SkullShell& shell, const SoundBone& bone, Execution& execution)
{
  double radius = 0;
  const Vec3 center = FindTemplateCenter(shell, radius, execution);
  const TemplateMap map(shell, center, execution);
  const SoundBone few = Thinned(bone, SearchRays);
  const Pose start = FindStart(bone, radius);
  const std::vector<Matrix4> turns = SpreadTurns();
  const std::vector<Matrix4> candidates =
    ChooseTurns(turns, FindLosses(map, few, start, turns, execution));
  Pose best = FindBest(TemplateSearch(shell, center, few, execution), start, candidates);
  const SoundBone many = Thinned(bone, FitRays);
  const TemplateSearch fit(shell, center, many, execution);
  for (int step = 0; step < FitSteps && fit.Improve(best, LeastLimit) > Settled; ++step)
  {
  }
  return Describe(best, center, fit.GetErrors(best));
}

//------------------------------------------------------------------------------
SkullRays PlaceTemplate(
  const SkullShell& shell, const TemplateFit& fit, const SkullRays& skull, Execution& execution)
{
  const Matrix4 back = fit.TemplateToSkull.Inverse();
  std::vector<Vec3> directions;
  for (const Vec3& d : skull.Directions)
  {
    directions.push_back(Normalized(back.Vector(d)));
  }
  RayRadii radii = shell.Trace(back.Point(skull.Center), directions, execution);
  for (std::vector<double>* table : { &radii.Outer, &radii.Inner })
  {
    for (double& radius : *table)
    {
      radius *= fit.Scale;
    }
  }
  return ClassifySkull(skull.Center, skull.Directions, skull.Spacing, std::move(radii));
}

//------------------------------------------------------------------------------
SkullExamples::SkullExamples(const SkullRays& rays, const MirrorPlane& plane)
{
  std::vector<Vec3> points;
  std::vector<double> thickness(rays.Kinds.size(), std::numeric_limits<double>::quiet_NaN());
  double sum = 0;
  double count = 0;
  for (std::size_t i = 0; i < rays.Kinds.size(); ++i)
  {
    if (rays.Kinds[i] == SkullRayKind::Sound)
    {
      points.push_back(rays.Center + rays.Outer[i] * rays.Directions[i]);
      points.push_back(rays.Center + rays.Outer[i] * plane.ReflectDirection(rays.Directions[i]));
      thickness[i] = rays.Outer[i] - rays.Inner[i];
      if (!std::isnan(thickness[i]))
      {
        sum += thickness[i];
        count += 1;
      }
    }
  }
  const SkullEllipsoid ellipsoid(rays.Center, points);
  std::vector<double> outer(rays.Kinds.size(), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = 0; i < rays.Kinds.size(); ++i)
  {
    thickness[i] -= sum / std::max(count, 1.0);
    if (rays.Kinds[i] == SkullRayKind::Sound)
    {
      outer[i] = rays.Outer[i] - ellipsoid.GetRadius(rays.Directions[i]);
    }
  }
  this->Outer = MakeExample(rays.Directions, outer, plane);
  this->Thickness = MakeExample(rays.Directions, thickness, plane);
}
}
