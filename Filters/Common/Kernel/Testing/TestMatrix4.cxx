// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaMatrix4.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

using lacuna::Matrix4;
using lacuna::Vec3;

TEST(Matrix4, ProductAppliesTheRightFactorFirst)
{
  const Matrix4 m = Matrix4::Translation({ 1, 2, 3 }) * Matrix4::Scaling({ 2, 3, 4 });
  const Vec3 p = m.Point({ 1, 1, 1 });
  EXPECT_EQ(p, (Vec3{ 3, 5, 7 }));
  EXPECT_EQ(m.Vector({ 1, 1, 1 }), (Vec3{ 2, 3, 4 }));
}

TEST(Matrix4, RotationIsRightHanded)
{
  const Vec3 p = Matrix4::Rotation({ 0, 0, 2 }, std::acos(-1.0) / 2).Point({ 1, 0, 0 });
  EXPECT_NEAR(p[0], 0, 1e-15);
  EXPECT_NEAR(p[1], 1, 1e-15);
}

TEST(Matrix4, DeterminantTellsAMirror)
{
  EXPECT_DOUBLE_EQ(Matrix4::Scaling({ 2, 3, 4 }).Determinant3(), 24);
  EXPECT_LT(Matrix4::Scaling({ -1, 1, 1 }).Determinant3(), 0);
}

TEST(Matrix4, InverseUndoesRandomTransforms)
{
  std::mt19937 random(7);
  std::uniform_real_distribution<double> u(-1, 1);
  for (int i = 0; i < 100; ++i)
  {
    // tiny and huge lengths alike
    const double scale = std::pow(10, 6 * u(random));
    const Matrix4 m = Matrix4::Translation({ 100 * u(random), 50 * u(random), u(random) }) *
      Matrix4::Rotation({ u(random), u(random), u(random) + 2 }, 3 * u(random)) *
      Matrix4::Scaling({ scale, 2 * scale, 0.5 * scale });
    const Matrix4 identity = m.Inverse() * m;
    for (int r = 0; r < 4; ++r)
    {
      for (int c = 0; c < 4; ++c)
      {
        EXPECT_NEAR(identity(r, c), r == c ? 1 : 0, 1e-9);
      }
    }
  }
}

TEST(Matrix4, InverseRefusesWhatHasNone)
{
  EXPECT_THROW(Matrix4::Scaling({ 1, 0, 1 }).Inverse(), std::invalid_argument);
  Matrix4 notFinite;
  notFinite(1, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(notFinite.Inverse(), std::invalid_argument);
  Matrix4 projective;
  projective(3, 0) = 1;
  EXPECT_THROW(projective.Inverse(), std::invalid_argument);
}
