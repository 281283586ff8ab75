// SPDX-License-Identifier: BSD-3-Clause
// The method: against a brute-force oracle, and what must not change the result.
#include "OcclusionCases.h"
#include "lacunaOccludedAngle.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <stdexcept>
#include <string>

namespace lacuna
{
namespace
{
using Dimensions = std::array<std::int64_t, 3>;

// Path integral from a voxel's centre along a unit direction in fine steps; attenuation is that of
// the nearest voxel, or (linear) interpolated between voxel centres.
double GetPath(const AttenuationField& field, const Dimensions& voxel, const Vec3& direction,
  double radius, bool linear)
{
  const double step = linear ? 0.04 : 0.015;
  const auto& n = field.GetDimensions();
  const auto get = [&](std::int64_t i, std::int64_t j, std::int64_t k) -> double
  {
    const bool inside = i >= 0 && j >= 0 && k >= 0 && i < n[0] && j < n[1] && k < n[2];
    return inside ? field.Row(j, k)[i] : 0;
  };
  double path = 0;
  for (double t = 0.5 * step; radius == 0 || t < radius; t += step)
  {
    Vec3 x{};
    Dimensions nearest{};
    for (int axis : { 0, 1, 2 })
    {
      x[axis] = static_cast<double>(voxel[axis]) + t * direction[axis] / field.GetSpacing()[axis];
      nearest[axis] = std::llround(x[axis]);
      if (x[axis] < -1 || x[axis] > static_cast<double>(n[axis]))
      {
        return path;
      }
    }
    const double value = get(nearest[0], nearest[1], nearest[2]);
    if (AttenuationField::IsOutsideSpace(static_cast<float>(value)))
    {
      return path;
    }
    if (!linear)
    {
      path += step * value;
      continue;
    }
    Dimensions low{};
    for (int axis : { 0, 1, 2 })
    {
      low[axis] = static_cast<std::int64_t>(std::floor(x[axis]));
    }
    for (int corner = 0; corner < 8; ++corner)
    {
      double weight = step;
      Dimensions at = low;
      for (int axis : { 0, 1, 2 })
      {
        const bool upper = (corner >> axis & 1) != 0;
        const double fraction = x[axis] - static_cast<double>(low[axis]);
        weight *= upper ? fraction : 1 - fraction;
        at[axis] += upper ? 1 : 0;
      }
      path += weight * get(at[0], at[1], at[2]);
    }
  }
  return path;
}

std::vector<double> GetOracle(const AttenuationField& field, const OccludedAngleOptions& options)
{
  const auto& n = field.GetDimensions();
  const int count = options.Directions / 2;
  const auto lines = field.IsFlat() ? EqualAngleLines(count) : EqualAreaLines(count);
  std::vector<double> angle;
  for (std::int64_t k = 0; k < n[2]; ++k)
  {
    for (std::int64_t j = 0; j < n[1]; ++j)
    {
      for (std::int64_t i = 0; i < n[0]; ++i)
      {
        double sum = 0;
        for (const Vec3& line : lines)
        {
          for (double sign : { 1.0, -1.0 })
          {
            const double path =
              GetPath(field, { i, j, k }, sign * line, options.Radius, !options.Binary);
            sum += options.Binary ? (path > 0 ? 1 : 0) : 1 - std::exp(-path);
          }
        }
        angle.push_back(AttenuationField::IsOutsideSpace(field.Row(j, k)[i])
            ? 0
            : sum * GetFullAngle(field) / options.Directions);
      }
    }
  }
  return angle;
}

struct Case
{
  Dimensions Size;
  Vec3 Spacing;
  double Density; // of attenuating voxels
  double Largest; // attenuation
  OccludedAngleOptions Options;
  double MostBias; // of the full angle
  double MostRms;
  bool Space = false;
};

void CheckCase(const Case& c)
{
  AttenuationField field(c.Size, c.Spacing);
  Numbers numbers(7);
  FillField(field,
    [&](std::int64_t i, std::int64_t j, std::int64_t k) -> double
    {
      const double value = numbers() < c.Density ? c.Largest * numbers() : 0;
      const double x = static_cast<double>(i) - 5;
      const double y = static_cast<double>(j) - 4;
      const double z = c.Size[2] == 1 ? 0 : static_cast<double>(k) - 4;
      const bool outside = c.Space && (x * x + y * y + z * z < 5 || i == 0 || j > 8);
      return outside ? AttenuationField::OutsideSpace() : value;
    });
  const std::vector<float> angle = GetAngle(field, c.Options);
  const std::vector<double> oracle = GetOracle(field, c.Options);
  double sum = 0;
  double squares = 0;
  for (std::size_t i = 0; i < oracle.size(); ++i)
  {
    const double error = (angle[i] - oracle[i]) / GetFullAngle(field);
    sum += error;
    squares += error * error;
  }
  const double count = static_cast<double>(oracle.size());
  EXPECT_LT(std::abs(sum / count), c.MostBias);
  EXPECT_LT(std::sqrt(squares / count), c.MostRms);
}
}

// Attenuation interpolated between voxel centres. What a voxel sees of its neighbours depends on
// where rays pass, so single strong voxels all around are the worst case.
TEST(OccludedAngle, AgreesWithTheOracle)
{
  const OccludedAngleOptions whole{ false, 60, 0 };
  // dense weak data and sparse strong data, square and oblong voxels
  CheckCase({ { 13, 11, 1 }, { 1, 1, 1 }, 1, 0.5, whole, 0.003, 0.009 });
  CheckCase({ { 13, 11, 1 }, { 1, 1, 1 }, 0.1, 3, whole, 0.012, 0.03 });
  CheckCase({ { 13, 11, 1 }, { 1, 0.6, 1 }, 0.1, 3, whole, 0.012, 0.03 });
  CheckCase({ { 11, 10, 9 }, { 1, 1, 1 }, 1, 0.3, whole, 0.004, 0.012 });
  CheckCase({ { 11, 10, 9 }, { 1, 1, 1 }, 0.1, 3, whole, 0.012, 0.04 });
  CheckCase({ { 11, 10, 9 }, { 0.5, 1.2, 0.8 }, 0.1, 3, whole, 0.012, 0.04 });
  // fewer voxels along the last axis than rays shift
  CheckCase({ { 3, 12, 4 }, { 2, 1, 0.5 }, 0.2, 2, whole, 0.012, 0.04 });
}

// Voxels as cubes.
TEST(OccludedAngle, BinaryAgreesWithTheOracle)
{
  const OccludedAngleOptions binary{ true, 60, 0 };
  CheckCase({ { 13, 11, 1 }, { 1, 1, 1 }, 0.08, 3, binary, 0.005, 0.03 });
  CheckCase({ { 11, 10, 9 }, { 1, 1, 1 }, 0.05, 3, binary, 0.005, 0.03 });
  CheckCase({ { 11, 10, 9 }, { 0.5, 1.2, 0.8 }, 0.05, 3, binary, 0.005, 0.03 });
}

TEST(OccludedAngle, RadiusAgreesWithTheOracle)
{
  for (double radius : { 1.0, 2.5, 4.0 })
  {
    const OccludedAngleOptions local{ false, 60, radius };
    CheckCase({ { 13, 11, 1 }, { 1, 1, 1 }, 0.1, 3, local, 0.012, 0.05 });
    CheckCase({ { 11, 10, 9 }, { 1, 1, 1 }, 0.1, 3, local, 0.012, 0.05 });
    CheckCase({ { 11, 10, 9 }, { 0.5, 1.2, 0.8 }, 0.1, 3, local, 0.012, 0.05 });
    const OccludedAngleOptions binary{ true, 60, radius };
    CheckCase({ { 13, 11, 1 }, { 1, 1, 1 }, 0.1, 3, binary, 0.02, 0.05 });
    CheckCase({ { 11, 10, 9 }, { 0.5, 1.2, 0.8 }, 0.1, 3, binary, 0.02, 0.05 });
  }
}

TEST(OccludedAngle, SpaceAgreesWithTheOracle)
{
  for (double radius : { 0.0, 3.0 })
  {
    for (bool binary : { false, true })
    {
      const OccludedAngleOptions options{ binary, 60, radius };
      CheckCase({ { 13, 11, 1 }, { 1, 1, 1 }, 0.2, 2, options, 0.03, 0.06, true });
      CheckCase({ { 11, 10, 9 }, { 1, 1, 1 }, 0.2, 2, options, 0.03, 0.06, true });
    }
  }
}

// In the mean over places, voxels look larger by the dilation in each direction across a ray.
TEST(OccludedAngle, DilationEnlargesVoxels)
{
  const int n = 61;
  const auto getMean = [](double dilation)
  {
    AttenuationField field({ n, n, 1 }, { 1, 1, 1 });
    field.Row(30, 0)[30] = 1;
    OccludedAngleOptions options{ true, 720, 0 };
    options.Dilation = dilation;
    const auto angle = GetAngle(field, options);
    double sum = 0; // of the width in voxels that the angle stands for
    int count = 0;
    for (int j = 0; j < n; ++j)
    {
      for (int i = 0; i < n; ++i)
      {
        const double distance = std::hypot(i - 30, j - 30);
        if (distance > 20 && distance < 30)
        {
          sum += distance * angle[j * n + i];
          ++count;
        }
      }
    }
    return sum / count;
  };
  EXPECT_NEAR(getMean(0), 4 / Pi, 0.02); // of a square, seen from all sides
  EXPECT_NEAR(getMean(0.4), 4 / Pi + 0.4 * 4 / Pi * std::sqrt(0.5), 0.02); // across the grid axis
}

// Also at the middle of the grid, where the rays of all lines would pass without their offsets.
TEST(OccludedAngle, VoxelsAreCubesInTheMean)
{
  const int n = 41;
  AttenuationField field({ n, n, n }, { 1, 1, 1 });
  field.Row(20, 20)[20] = 1;
  const auto angle = GetAngle(field, { true, 4000, 0 });
  double sum = 0;
  int count = 0;
  for (int v = 0; v < n * n * n; ++v)
  {
    const double x = v % n - 20;
    const double y = v / n % n - 20;
    const double z = v / n / n - 20;
    const double distance = std::sqrt(x * x + y * y + z * z);
    if (distance > 13 && distance < 20)
    {
      sum += distance * distance * angle[v];
      ++count;
    }
  }
  EXPECT_NEAR(sum / count, 1.5, 0.03); // a quarter of the surface
}

TEST(OccludedAngle, LargeRadiusIsTheWholeSpace)
{
  AttenuationField field({ 21, 17, 13 }, { 1, 0.8, 1.5 });
  Numbers numbers(3);
  FillField(field, [&](auto...) { return numbers() < 0.2 ? numbers() : 0; });
  const auto whole = GetAngle(field, { false, 100, 0 });
  const auto local = GetAngle(field, { false, 100, 1000 });
  for (std::size_t i = 0; i < whole.size(); ++i)
  {
    ASSERT_NEAR(whole[i], local[i], 2e-5) << i;
  }
}

// Small grids divide the lines among threads, large ones the rays; flat ones divide rays by length.
TEST(OccludedAngle, DoesNotDependOnThreads)
{
  for (const Dimensions& size :
    { Dimensions{ 20, 23, 17 }, Dimensions{ 70, 66, 68 }, Dimensions{ 700, 500, 1 } })
  {
    AttenuationField field(size, { 1, 1.3, 0.7 });
    Numbers numbers(11);
    FillField(field, [&](auto...) { return 0.1 * std::max(0.0, numbers() - 0.3); });
    for (double radius : { 0.0, 9.0 })
    {
      for (bool binary : { false, true })
      {
        const OccludedAngleOptions options{ binary, 14, radius };
        const auto one = GetAngle(field, options, 1);
        EXPECT_EQ(GetAngle(field, options, 2), one);
        EXPECT_EQ(GetAngle(field, options, 5), one);
      }
    }
  }
}

// In small grids, where lines are divided among threads, and in large ones, where tiles are.
TEST(OccludedAngle, DoesNotDependOnRanks)
{
  for (const Dimensions& n :
    { Dimensions{ 20, 13, 9 }, Dimensions{ 90, 70, 50 }, Dimensions{ 40, 30, 1 } })
  {
    for (bool binary : { false, true })
    {
      OccludedAngleOptions options;
      options.Binary = binary;
      options.Directions = n[0] > 50 ? 10 : n[2] > 1 ? 46 : 2500; // in the end more than one sum
      options.Radius = binary ? 5 : 0;
      const auto fill = [&](AttenuationField& field)
      {
        Numbers numbers(3);
        FillField(field,
          [&](std::int64_t, std::int64_t, std::int64_t) { return numbers() < 0.1 ? 0.3 : 0; });
      };
      AttenuationField field(n, { 1, 1.1, 0.9 });
      fill(field);
      const std::vector<float> alone = GetAngle(field, options);
      for (int number : { 2, 3, 30 }) // in the end more than there are lines
      {
        std::vector<std::vector<float>> angles(number, std::vector<float>(alone.size()));
        ThreadRanks::Run(number,
          [&](const Ranks& ranks)
          {
            AttenuationField own(n, { 1, 1.1, 0.9 });
            fill(own);
            ThreadExecution execution(1);
            ComputeOccludedAngle(own, options, angles[ranks.GetRank()].data(), execution, ranks);
          });
        for (const std::vector<float>& angle : angles)
        {
          ASSERT_EQ(angle, alone) << number << " ranks";
        }
      }
    }
  }
}

// Nobody waits for a rank that has stopped.
TEST(OccludedAngle, StopsOnAllRanks)
{
  std::atomic<int> stopped(0);
  std::atomic<int> told(0);
  ThreadRanks::Run(3,
    [&](const Ranks& ranks)
    {
      AttenuationField field({ 30, 30, 30 }, { 1, 1, 1 });
      field.Row(3, 4)[5] = 1;
      std::vector<float> angle(field.GetNumberOfVoxels());
      ThreadExecution execution(1, [&](double) { return ranks.GetRank() != 1; });
      try
      {
        ComputeOccludedAngle(field, {}, angle.data(), execution, ranks);
      }
      catch (const Aborted&)
      {
        ++stopped;
      }
      catch (const std::runtime_error& error)
      {
        told += std::string(error.what()).find("another rank") != std::string::npos;
      }
    });
  EXPECT_EQ(stopped, 1);
  EXPECT_EQ(told, 2);
}

// A million small parts add up to what fewer do: nothing is lost beside a large sum.
TEST(OccludedAngle, ManyDirectionsLoseNothing)
{
  AttenuationField field({ 8, 8, 1 }, { 1, 1, 1 });
  FillField(field, [](std::int64_t i, std::int64_t, std::int64_t) { return i < 4 ? 1e-3 : 100; });
  OccludedAngleOptions options;
  options.Radius = 2;
  options.Directions = 1 << 16;
  const std::vector<float> few = GetAngle(field, options);
  options.Directions = 1 << 20;
  const std::vector<float> many = GetAngle(field, options);
  for (std::size_t i = 0; i < few.size(); ++i)
  {
    ASSERT_NEAR(many[i], few[i], 2e-3 * few[i]) << i;
  }
  EXPECT_LT(few[24], 0.02);
  EXPECT_EQ(few[7 + 24], static_cast<float>(2 * Pi));
  EXPECT_EQ(many[7 + 24], static_cast<float>(2 * Pi));
}

TEST(OccludedAngle, LeavesTheFieldAsItWas)
{
  AttenuationField field({ 9, 7, 5 }, { 1, 2, 3 });
  FillField(field,
    [](std::int64_t i, std::int64_t j, std::int64_t k)
    { return 0.001 * static_cast<double>(i + 10 * j + 100 * k); });
  GetAngle(field, { false, 20, 0 });
  EXPECT_EQ(field.GetDimensions(), (Dimensions{ 9, 7, 5 }));
  EXPECT_EQ(field.GetSpacing(), (Vec3{ 1, 2, 3 }));
  EXPECT_FLOAT_EQ(field.Row(4, 3)[7], 0.347F);
}

// A shape without symmetry: a mirrored axis or swapped axes would show.
TEST(OccludedAngle, DoesNotMirror)
{
  AttenuationField field({ 15, 17, 19 }, { 1, 1, 1 });
  field.Row(4, 6)[3] = 5;
  const auto angle = GetAngle(field, { false, 200, 0 });
  const auto at = [&](int i, int j, int k) { return angle[(k * 17 + j) * 15 + i]; };
  const float highest = *std::max_element(angle.begin(), angle.end());
  EXPECT_EQ(at(3, 4, 6), highest);
  EXPECT_GT(at(4, 4, 6), 2 * at(11, 4, 6));
  EXPECT_GT(at(3, 5, 6), 2 * at(3, 12, 6));
  EXPECT_GT(at(3, 4, 7), 2 * at(3, 4, 12));
}

TEST(OccludedAngle, EmptyAndFullAreExact)
{
  AttenuationField field({ 12, 9, 7 }, { 1, 1, 1 });
  for (float angle : GetAngle(field, { false, 50, 0 }))
  {
    ASSERT_EQ(angle, 0.0F);
  }
  FillField(field, [](auto...) { return 12.0; });
  for (float angle : GetAngle(field, { true, 50, 0 }))
  {
    ASSERT_FLOAT_EQ(angle, static_cast<float>(4 * Pi));
  }
}

TEST(OccludedAngle, RefusesBadOptions)
{
  AttenuationField field({ 12, 9, 7 }, { 1, 2, 0.5 });
  EXPECT_THROW(GetAngle(field, { false, 0, 0 }), std::invalid_argument);
  EXPECT_THROW(GetAngle(field, { false, 7, 0 }), std::invalid_argument);
  EXPECT_THROW(GetAngle(field, { false, 8, 0.4 }), std::invalid_argument);
  EXPECT_THROW(GetAngle(field, { false, 8, -1 }), std::invalid_argument);
  EXPECT_THROW(GetAngle(field, { false, 8, std::nan("") }), std::invalid_argument);
  EXPECT_NO_THROW(GetAngle(field, { false, 8, 0.5 }));
  OccludedAngleOptions dilated{ true, 8, 0 };
  for (double dilation : { -0.1, 1.0, std::nan("") })
  {
    dilated.Dilation = dilation;
    EXPECT_THROW(GetAngle(field, dilated), std::invalid_argument);
  }
  EXPECT_THROW(AttenuationField({ 12, 1, 1 }, { 1, 1, 1 }), std::invalid_argument);
  EXPECT_THROW(AttenuationField({ 12, 5, 1 }, { 1, 0, 1 }), std::invalid_argument);
}

TEST(OccludedAngle, StopsWhenAsked)
{
  AttenuationField field({ 100, 100, 100 }, { 1, 1, 1 });
  std::vector<float> angle(field.GetNumberOfVoxels());
  ThreadExecution execution(1, [](double fraction) { return fraction < 0.05; });
  EXPECT_THROW(ComputeOccludedAngle(field, { false, 2000, 0 }, angle.data(), execution), Aborted);
}

TEST(OccludedAngle, LinesAreUniform)
{
  const auto lines = EqualAreaLines(2000);
  Vec3 squares{ 0, 0, 0 };
  for (const Vec3& line : lines)
  {
    ASSERT_NEAR(Norm(line), 1, 1e-12);
    for (int axis : { 0, 1, 2 })
    {
      squares[axis] += line[axis] * line[axis] / 2000;
    }
  }
  for (int axis : { 0, 1, 2 })
  {
    EXPECT_NEAR(squares[axis], 1.0 / 3, 1e-3);
  }
  // Caps of the sphere have their share of lines; the error falls faster than that of random ones.
  const auto getError = [](int count)
  {
    const auto some = EqualAreaLines(count);
    Numbers numbers(5);
    double squares = 0;
    for (int trial = 0; trial < 200; ++trial)
    {
      const double z = 2 * numbers() - 1;
      const double turn = 2 * Pi * numbers();
      const double r = std::sqrt(1 - z * z);
      const Vec3 centre{ r * std::cos(turn), r * std::sin(turn), z };
      const double height = 0.02 + 0.5 * numbers();
      const auto inside = std::count_if(some.begin(), some.end(),
        [&](const Vec3& line) { return std::abs(Dot(line, centre)) > 1 - height; });
      const double error = static_cast<double>(inside) / count - height;
      squares += error * error / 200;
    }
    return std::sqrt(squares);
  };
  const double coarse = getError(200);
  const double fine = getError(3200);
  EXPECT_LT(coarse, 0.01);     // random lines: 0.03
  EXPECT_GT(coarse / fine, 6); // 16 times as many; random lines: 4
}
}
