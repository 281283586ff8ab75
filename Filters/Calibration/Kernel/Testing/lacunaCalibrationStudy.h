// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Simulated calibrations whose truth is known, and what many of them come to.
#ifndef lacunaCalibrationStudy_h
#define lacunaCalibrationStudy_h

#include "lacunaProbeCalibration.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <random>
#include <vector>

namespace lacunaCalibrationStudy
{
using namespace lacuna;
using Target = CalibrationTarget;
constexpr double Degree = 3.14159265358979323846 / 180;
constexpr Target Wires[3] = { Target::WireX, Target::WireY, Target::WireZ };

/// An image of 90 x 72 mm on a probe, before a phantom, all of them anywhere.
class Scene
{
public:
  static constexpr double Width = 600, Height = 480;
  Vec2 Spacing{ 0.15, 0.15 };
  Matrix4 ImageToProbe;
  Matrix4 PhantomToTracker;
  std::vector<CalibrationPick> Picks;

  explicit Scene(unsigned seed, Vec2 spacing = { 0.15, 0.15 })
    : Spacing(spacing)
    , Random(seed)
  {
    this->ScanToProbe = Matrix4::Translation(this->Vector(100)) * this->Turn(180);
    this->ImageToProbe = this->ScanToProbe * Matrix4::Scaling({ spacing[0], spacing[1], 1 });
    this->PhantomToTracker = Matrix4::Translation(this->Vector(300)) * this->Turn(180);
  }

  double Uniform(double a, double b)
  {
    return std::uniform_real_distribution<double>(a, b)(this->Random);
  }
  double Normal(double spread) { return std::normal_distribution<double>(0, spread)(this->Random); }
  Vec3 Vector(double size)
  {
    return { this->Uniform(-size, size), this->Uniform(-size, size), this->Uniform(-size, size) };
  }
  Matrix4 Turn(double degrees)
  {
    Vec3 axis = this->Vector(1);
    while (Norm(axis) < 0.1 || Norm(axis) > 1)
    {
      axis = this->Vector(1);
    }
    return Matrix4::Rotation(axis, this->Uniform(-degrees, degrees) * Degree);
  }
  // A turn for which accept holds.
  Matrix4 TurnThat(const std::function<bool(const Matrix4&)>& accept)
  {
    Matrix4 turn = this->Turn(180);
    while (!accept(turn))
    {
      turn = this->Turn(180);
    }
    return turn;
  }

  // A slice, turned so in the phantom, in which a point of it is seen at a pixel, picked beside it.
  void Pick(Target target, const Vec3& point, const Matrix4& turn, const Vec2& error)
  {
    const Vec2 pixel{ this->Uniform(0, Width), this->Uniform(0, Height) };
    const Vec3 arm = turn.Vector({ this->Spacing[0] * pixel[0], this->Spacing[1] * pixel[1], 0 });
    const Matrix4 scanToPhantom = Matrix4::Translation(point - arm) * turn;
    this->Picks.push_back({ this->PhantomToTracker * scanToPhantom * this->ScanToProbe.Inverse(),
      { pixel[0] + error[0] / this->Spacing[0], pixel[1] + error[1] / this->Spacing[1] }, target,
      this->Slices++ });
  }

  // The slice within so many degrees of a right angle to the wire.
  void PickWire(int wire, const Vec2& error, double tilt = 50)
  {
    Vec3 point{ 0, 0, 0 };
    point[wire] = this->Uniform(-60, 60);
    const Matrix4 turn = this->TurnThat(
      [&](const Matrix4& m) { return std::abs(m(wire, 2)) > std::cos(tilt * Degree); });
    this->Pick(Wires[wire], point, turn, error);
  }

  // Two points of the line that a wall is in a slice, looking down on it within so many degrees;
  // picked off the wall by errors of that standard deviation, and by one that both have in common.
  // frames: so many slices of the probe at rest, which have another error in common.
  void PickWall(
    double spread, double tilt = 60, double common = 0, int frames = 1, double resting = 0)
  {
    const Matrix4 turn =
      this->TurnThat([&](const Matrix4& m) { return m(2, 1) < -std::cos(tilt * Degree); });
    const Matrix4 scanToPhantom = Matrix4::Translation({ this->Uniform(-50, 50),
                                    this->Uniform(-50, 50), this->Uniform(20, 60) }) *
      turn;
    const Matrix4 pose = this->PhantomToTracker * scanToPhantom * this->ScanToProbe.Inverse();
    const double ofAll = resting > 0 ? this->Normal(resting) : 0;
    for (int frame = 0; frame < frames; ++frame, ++this->Slices)
    {
      const double ofSlice = ofAll + (common > 0 ? this->Normal(common) : 0);
      for (const double column : { 0.1 * Width, 0.9 * Width })
      {
        const double height = scanToPhantom.Point({ column * this->Spacing[0], 0, 0 })[2] - ofSlice;
        const double row = (this->Normal(spread) - height) / (this->Spacing[1] * turn(2, 1));
        this->Picks.push_back({ pose, { column, row }, Target::Wall, this->Slices });
      }
    }
  }

  ProbeCalibrationOptions Options() const { return { this->Spacing, false, 4 }; }

  // mm between where a pixel is and where it is said to be
  Vec3 Error(const ProbeCalibration& found, const Vec2& pixel) const
  {
    return found.ImageToProbe.Point({ pixel[0], pixel[1], 0 }) -
      this->ImageToProbe.Point({ pixel[0], pixel[1], 0 });
  }
  std::vector<double> CornerErrors(const ProbeCalibration& found) const
  {
    std::vector<double> errors;
    for (const Vec2& pixel : Corners())
    {
      errors.push_back(Norm(this->Error(found, pixel)));
    }
    return errors;
  }
  static std::vector<Vec2> Corners()
  {
    return { { 0, 0 }, { Width, 0 }, { 0, Height }, { Width, Height } };
  }

private:
  std::mt19937 Random;
  std::int64_t Slices = 0;
  Matrix4 ScanToProbe;
};

inline double Largest(const std::vector<double>& values)
{
  return *std::max_element(values.begin(), values.end());
}

inline double Median(std::vector<double> values)
{
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// e^T C^-1 e
inline double MahalanobisSquare(const std::array<Vec3, 3>& c, const Vec3& e)
{
  const double determinant = Dot(c[0], Cross(c[1], c[2]));
  const Vec3 rows[3] = { (1 / determinant) * Cross(c[1], c[2]),
    (1 / determinant) * Cross(c[2], c[0]), (1 / determinant) * Cross(c[0], c[1]) };
  double sum = 0;
  for (int i = 0; i < 3; ++i)
  {
    sum += e[i] * Dot(rows[i], e); // the inverse is symmetric
  }
  return sum;
}

/// What many calibrations came to.
struct Study
{
  int Count = 0, Converged = 0, Covered = 0, InChiSquare = 0;
  double TrueSquares = 0, ExpectedSquares = 0; // mm^2, summed over corners
  std::vector<double> Errors, Rms;

  // F: 95 % of the F distribution with 3 and the views less unknowns degrees of freedom
  void Add(const Scene& scene, const ProbeCalibration& found, double f)
  {
    ++this->Count;
    const std::vector<double> errors = scene.CornerErrors(found);
    this->Converged += Largest(errors) < 5;
    this->Errors.insert(this->Errors.end(), errors.begin(), errors.end());
    this->Rms.push_back(found.Rms);
    for (const Vec2& pixel : Scene::Corners())
    {
      const Vec3 error = scene.Error(found, pixel);
      this->Covered += MahalanobisSquare(found.GetCovariance(pixel), error) < 3 * f;
      this->TrueSquares += Dot(error, error);
      this->ExpectedSquares += std::pow(found.GetExpectedError(pixel), 2);
    }
  }
  double GetSquareRatio() const { return this->TrueSquares / this->ExpectedSquares; }
  double GetCoverage() const { return this->Covered / (4.0 * this->Count); }
};

// Three wires, 10 picks of each that are off by up to 1 mm in each direction, a part of them by up to
// 25 mm. Slices within so many degrees of a right angle to the wire.
inline Study StudyWires(unsigned geometries, double outliers, double tilt = 50)
{
  Study study;
  for (unsigned seed = 0; seed < geometries; ++seed)
  {
    Scene scene(seed);
    for (int i = 0; i < 30; ++i)
    {
      const double error = scene.Uniform(0, 1) < outliers ? 25 : 1;
      const Vec2 offset{ scene.Uniform(-error, error), scene.Uniform(-error, error) };
      scene.PickWire(i % 3, offset, tilt);
    }
    const ProbeCalibration found = ProbeCalibration::Solve(scene.Picks, scene.Options());
    study.Add(scene, found, 3.16); // 30 less 12
    // 2.5 % and 97.5 % of the chi-square distribution with 48 degrees of freedom
    const double chiSquare = found.Rms * found.Rms * double(found.Equations) / (1.0 / 3);
    study.InChiSquare += found.Equations == 60 && chiSquare > 30.75 && chiSquare < 69.02;
  }
  return study;
}

// A wall in 40 slices, 0.5 mm at each end of the line; or less there and the rest of it at both ends.
inline Study StudyWall(unsigned geometries, double spread = 0.5, double common = 0)
{
  Study study;
  for (unsigned seed = 0; seed < geometries; ++seed)
  {
    Scene scene(1000 + seed);
    for (int i = 0; i < 40; ++i)
    {
      scene.PickWall(spread, 60, common);
    }
    study.Add(scene, ProbeCalibration::Solve(scene.Picks, scene.Options()), 2.91); // 40 less 9
  }
  return study;
}

// A wall in 4 frames of each of 40 places where the probe was held still: 0.1 mm at each end, 0.1 mm
// of each frame, 0.3 mm of each place.
inline Study StudyWallAtRest(unsigned geometries)
{
  Study study;
  for (unsigned seed = 0; seed < geometries; ++seed)
  {
    Scene scene(2000 + seed);
    for (int i = 0; i < 40; ++i)
    {
      scene.PickWall(0.1, 60, 0.1, 4, 0.3);
    }
    study.Add(scene, ProbeCalibration::Solve(scene.Picks, scene.Options()), 2.91); // 40 less 9
  }
  return study;
}
}
#endif
