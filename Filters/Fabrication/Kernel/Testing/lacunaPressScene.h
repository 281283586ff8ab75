// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Moulds of depth fields, for tests.
#ifndef lacunaPressScene_h
#define lacunaPressScene_h

#include "lacunaPlateScene.h"
#include "lacunaPressSurface.h"

#include <gtest/gtest.h>

#include <cmath>
#include <exception>
#include <functional>
#include <string>

/// A PlateScene, pressed.
struct PressScene : PlateScene
{
  lacuna::ReliefSurface Surface;
  lacuna::PressLayout Layout;

  PressScene(const std::function<double(double, double)>& depth,
    const std::function<bool(double, double)>& inside, int threads = 0)
    : PlateScene(depth, inside, threads)
    , Surface(this->Execution, this->Size, this->Depths, this->Spacing)
  {
  }

  /// With the least squares plane.
  lacuna::PressSurface Press(const lacuna::PressOptions& options)
  {
    return this->Press(options, lacuna::FitPlaneNormal(this->Size, this->Depths, this->Spacing));
  }

  lacuna::PressSurface Press(const lacuna::PressOptions& options, const lacuna::Vec3& normal)
  {
    this->Layout = lacuna::PlanPress(
      this->Execution, this->Surface, this->Size, this->Spacing, this->Mask, normal, options);
    return lacuna::MakePressSurface(
      this->Execution, this->Surface, this->Size, this->Spacing, this->Mask, this->Layout, options);
  }

  /// The middle of the field in the relief's coordinates, plus (x, y, z).
  static lacuna::Vec3 At(double x, double y, double z) { return { Middle + x, Middle + y, z }; }
};

namespace lacunaPress
{
constexpr double Pi = 3.14159265358979323846;
constexpr double Degrees = 180 / Pi;

inline bool Disc20(double x, double y)
{
  return std::hypot(x, y) <= 20;
}

/// What it throws, empty if it does not.
inline std::string ErrorOf(const std::function<void()>& body)
{
  try
  {
    body();
  }
  catch (const std::exception& e)
  {
    return e.what();
  }
  return {};
}

inline void ExpectRotation(const lacuna::Matrix4& m)
{
  for (int a = 0; a < 3; ++a)
  {
    for (int b = 0; b < 3; ++b)
    {
      EXPECT_NEAR(Dot(m.Column(a), m.Column(b)), a == b ? 1 : 0, 1e-14);
    }
  }
  EXPECT_NEAR(m.Determinant3(), 1, 1e-14);
}
}
#endif
