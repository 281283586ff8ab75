// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaPhantomSweep.h"
#include "lacunaProbeMotion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

using lacuna::Anatomy;
using lacuna::Extent;
using lacuna::Matrix4;

namespace
{
constexpr int Columns = 61;
constexpr int Rows = 47;
constexpr int Slices = 9;
constexpr Extent Whole{ 0, Columns - 1, 0, Rows - 1, 0, Slices - 1 };

lacuna::SliceImaging Imaging(double speckle)
{
  lacuna::ProbeMotion::Parameters p;
  p.Motion = lacuna::ProbeMotion::Kind::Arbitrary;
  p.NumberOfSlices = Slices;
  const lacuna::ProbeMotion motion(p);
  lacuna::SliceImaging imaging;
  imaging.Columns = Columns;
  imaging.Rows = Rows;
  imaging.SpeckleLevel = speckle;
  imaging.Seed = 42;
  imaging.ImageToReference = [motion](std::int64_t i)
  { return motion.TrueProbeToReference(i) * lacuna::MakeImageToProbe(Columns, 1); };
  return imaging;
}

std::size_t Size(const Extent& e)
{
  return static_cast<std::size_t>(e[1] - e[0] + 1) * (e[3] - e[2] + 1) * (e[5] - e[4] + 1);
}

template <class T>
std::vector<T> Sample(Anatomy anatomy, double speckle, const Extent& extent, int threads)
{
  lacuna::ThreadExecution execution(threads);
  std::vector<T> pixels(Size(extent));
  lacuna::SampleSlices(
    execution, *lacuna::MakePhantomScene(anatomy, 1.5), Imaging(speckle), extent, pixels.data());
  return pixels;
}
}

TEST(PhantomSweep, PixelsAreTheTruthAtTheirPlace)
{
  for (const Anatomy anatomy :
    { Anatomy::Ellipsoids, Anatomy::Kumara, Anatomy::Vessels, Anatomy::Linear })
  {
    const auto scene = lacuna::MakePhantomScene(anatomy, 1.5);
    const auto bytes = Sample<unsigned char>(anatomy, 0, Whole, 2);
    const auto floats = Sample<float>(anatomy, 0, Whole, 2);
    const lacuna::SliceImaging imaging = Imaging(0);
    std::size_t at = 0;
    for (int k = 0; k < Slices; ++k)
    {
      const Matrix4 pose = imaging.ImageToReference(k);
      for (int j = 0; j < Rows; ++j)
      {
        for (int i = 0; i < Columns; ++i, ++at)
        {
          const double truth =
            scene->Value(pose.Point({ static_cast<double>(i), static_cast<double>(j), 0 }));
          ASSERT_NEAR(floats[at], truth, 2e-5);
          ASSERT_NEAR(bytes[at], truth, 0.5 + 1e-9);
        }
      }
    }
  }
}

TEST(PhantomSweep, IsTheSameForAnyThreadsAndPieces)
{
  for (const double speckle : { 0.0, 0.3 })
  {
    const auto one = Sample<unsigned char>(Anatomy::Vessels, speckle, Whole, 1);
    EXPECT_EQ(one, Sample<unsigned char>(Anatomy::Vessels, speckle, Whole, 2));
    EXPECT_EQ(one, Sample<unsigned char>(Anatomy::Vessels, speckle, Whole, 5));
    const Extent part{ 7, 40, 3, 30, 2, 6 };
    const auto piece = Sample<unsigned char>(Anatomy::Vessels, speckle, part, 3);
    std::size_t at = 0;
    for (int k = part[4]; k <= part[5]; ++k)
    {
      for (int j = part[2]; j <= part[3]; ++j)
      {
        for (int i = part[0]; i <= part[1]; ++i, ++at)
        {
          ASSERT_EQ(piece[at], one[(static_cast<std::size_t>(k) * Rows + j) * Columns + i]);
        }
      }
    }
  }
}

TEST(PhantomSweep, SpeckleIsMultiplicativeWithTheStatedDeviation)
{
  const auto clean = Sample<float>(Anatomy::Vessels, 0, Whole, 2);
  const auto noisy = Sample<float>(Anatomy::Vessels, 0.15, Whole, 2);
  double sum[2] = {};
  double squares[2] = {};
  double count[2] = {};
  for (std::size_t i = 0; i < clean.size(); ++i)
  {
    const int dark = clean[i] < 80;
    const double relative = noisy[i] / clean[i] - 1;
    sum[dark] += relative;
    squares[dark] += relative * relative;
    ++count[dark];
  }
  for (const int dark : { 0, 1 })
  {
    EXPECT_GT(count[dark], 300);
    EXPECT_NEAR(sum[dark] / count[dark], 0, 5 * 0.15 / std::sqrt(count[dark]));
    EXPECT_NEAR(std::sqrt(squares[dark] / count[dark]) / 0.15, 1, 5 / std::sqrt(2 * count[dark]));
  }
}

TEST(PhantomSweep, RoundsOnceAndStaysWithinBytes)
{
  class Ramp : public lacuna::PhantomScene
  {
    void SampleRow(
      const lacuna::Vec3&, const lacuna::Vec3&, int first, int count, double* values) const override
    {
      const double levels[8] = { -3, 0.49, 0.5, 254.49, 254.5, 300, std::nan(""), HUGE_VAL };
      for (int i = 0; i < count; ++i)
      {
        values[i] = levels[first + i];
      }
    }
  };
  lacuna::ThreadExecution execution(1);
  lacuna::SliceImaging imaging = Imaging(0);
  std::vector<unsigned char> pixels(8);
  lacuna::SampleSlices(execution, Ramp(), imaging, { 0, 7, 0, 0, 0, 0 }, pixels.data());
  EXPECT_EQ(pixels, (std::vector<unsigned char>{ 0, 0, 1, 254, 255, 255, 0, 255 }));
}

TEST(PhantomSweep, GridsEqualTheScene)
{
  const auto scene = lacuna::MakePhantomScene(Anatomy::Ellipsoids, 1.5);
  const std::array<int, 3> n{ 13, 11, 7 };
  const Matrix4 m = Matrix4::Translation({ -20, -15, -10 }) * Matrix4::Rotation({ 1, 1, 0 }, 0.3) *
    Matrix4::Scaling({ 3, 2.5, 4 });
  std::vector<float> one(13 * 11 * 7);
  std::vector<float> five(one.size());
  lacuna::ThreadExecution execution1(1);
  lacuna::ThreadExecution execution5(5);
  lacuna::SampleGrid(execution1, *scene, n, m, one.data());
  lacuna::SampleGrid(execution5, *scene, n, m, five.data());
  EXPECT_EQ(one, five);
  for (int k = 0; k < n[2]; ++k)
  {
    for (int j = 0; j < n[1]; ++j)
    {
      for (int i = 0; i < n[0]; ++i)
      {
        const double truth = scene->Value(
          m.Point({ static_cast<double>(i), static_cast<double>(j), static_cast<double>(k) }));
        ASSERT_NEAR(one[(k * n[1] + j) * n[0] + i], truth, 2e-5);
      }
    }
  }
}

TEST(PhantomSweep, RefusesBadSpeckle)
{
  for (const double level : { -0.1, 11.0, std::nan("") })
  {
    EXPECT_THROW(Sample<float>(Anatomy::Linear, level, Whole, 1), std::invalid_argument);
  }
}
