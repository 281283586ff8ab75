// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaMirroredVolume.h"

#include "lacunaMirrorTest.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <random>
#include <vector>

using lacuna::MirrorInterpolation;
using lacuna::MirrorPlane;
using lacuna::Vec3;
using namespace lacunaMirrorTest;

namespace
{
constexpr std::array<int, 3> Size{ { 13, 9, 7 } };

template <class T>
struct Volume
{
  std::vector<T> Voxels = std::vector<T>(static_cast<std::size_t>(Size[0]) * Size[1] * Size[2]);
  lacuna::MaskedVolume Masked;

  explicit Volume(const lacuna::Matrix4& indexToWorld)
  {
    this->Masked.Volume.Voxels = this->Voxels.data();
    this->Masked.Volume.Type = lacuna::GetScalarType<T>();
    this->Masked.Volume.Size = Size;
    this->Masked.Volume.IndexToWorld = indexToWorld;
  }
  static std::size_t Index(int i, int j, int k)
  {
    return static_cast<std::size_t>(i + Size[0] * (j + Size[1] * k));
  }
  Vec3 World(int i, int j, int k) const
  {
    return this->Masked.Volume.IndexToWorld.Point(
      { static_cast<double>(i), static_cast<double>(j), static_cast<double>(k) });
  }
  /// f: of i, j, k and the world position.
  template <class F>
  void Fill(const F& f)
  {
    for (int k = 0; k < Size[2]; ++k)
    {
      for (int j = 0; j < Size[1]; ++j)
      {
        for (int i = 0; i < Size[0]; ++i)
        {
          this->Voxels[Index(i, j, k)] = static_cast<T>(f(i, j, k, this->World(i, j, k)));
        }
      }
    }
  }
  const T* Mirrored(const lacuna::MirroredVolume& result) const
  {
    return reinterpret_cast<const T*>(result.Voxels.data());
  }
};

lacuna::Matrix4 Oblique()
{
  std::mt19937 random(4);
  return lacuna::Matrix4::Translation({ 30, -20, 7 }) * Small(random, 2) *
    lacuna::Matrix4::Scaling({ 0.7, 0.9, 1.3 });
}

/// The plane between the indices 5 and 6 along x (or on 6), in the world.
MirrorPlane PlaneAcross(const lacuna::Matrix4& indexToWorld, double index)
{
  MirrorPlane plane;
  plane.Normal = Normalized(indexToWorld.Column(0));
  plane.Offset = Dot(plane.Normal, indexToWorld.Point({ index, 0, 0 }));
  return plane;
}
}

// A plane on or between voxels moves voxels onto voxels: exact, whatever the interpolation and type.
TEST(MirroredVolume, VoxelsOntoVoxels)
{
  const lacuna::Matrix4 pose = Oblique();
  const auto test = [&](auto zero)
  {
    using T = decltype(zero);
    Volume<T> volume(pose);
    std::mt19937 random(1);
    volume.Fill([&](int, int, int, const Vec3&) { return random() % 100; });
    for (const auto interpolation :
      { MirrorInterpolation::BSpline, MirrorInterpolation::Linear, MirrorInterpolation::Nearest })
    {
      for (const double at : { 5.5, 5.0 })
      {
        lacuna::ThreadExecution execution(2);
        const auto result =
          MirrorVolume(volume.Masked, PlaneAcross(pose, at), interpolation, execution);
        const T* mirrored = volume.Mirrored(result);
        for (int k = 0; k < Size[2]; ++k)
        {
          for (int j = 0; j < Size[1]; ++j)
          {
            for (int i = 0; i < Size[0]; ++i)
            {
              const auto from = static_cast<int>(2 * at) - i;
              const std::size_t v = volume.Index(i, j, k);
              ASSERT_EQ(result.Valid[v], from >= 0 && from < Size[0]);
              if (result.Valid[v])
              {
                const auto expected = static_cast<double>(volume.Voxels[volume.Index(from, j, k)]);
                ASSERT_NEAR(static_cast<double>(mirrored[v]), expected, 2e-5);
                ASSERT_NEAR(
                  result.Asymmetry[v], static_cast<double>(volume.Voxels[v]) - expected, 4e-5);
              }
              else
              {
                ASSERT_EQ(
                  mirrored[v], *std::min_element(volume.Voxels.begin(), volume.Voxels.end()));
                ASSERT_TRUE(std::isnan(result.Asymmetry[v]));
              }
            }
          }
        }
        EXPECT_NEAR(result.Overlap, (at == 5.5 ? 12 : 11) / 13.0, 1e-12);
      }
    }
  };
  test(std::int8_t());
  test(std::uint16_t());
  test(std::int32_t());
  test(std::uint64_t());
  test(float());
  test(double());
}

// Between voxels: both interpolations reproduce what is linear, the B-spline also what is smooth.
TEST(MirroredVolume, BetweenVoxels)
{
  const lacuna::Matrix4 pose = Oblique();
  Volume<double> volume(pose);
  MirrorPlane plane = PlaneAcross(pose, 5.73);
  plane.Normal = Normalized(plane.Normal + 0.05 * Normalized(pose.Column(1)));
  const auto linear = [](int, int, int, const Vec3& x) { return 3 * x[0] - 2 * x[1] + 5 * x[2]; };
  volume.Fill(linear);
  lacuna::ThreadExecution execution(2);
  for (const auto interpolation : { MirrorInterpolation::BSpline, MirrorInterpolation::Linear })
  {
    const auto result = MirrorVolume(volume.Masked, plane, interpolation, execution);
    int valid = 0;
    for (int k = 0; k < Size[2]; ++k)
    {
      for (int j = 0; j < Size[1]; ++j)
      {
        for (int i = 0; i < Size[0]; ++i)
        {
          const std::size_t v = volume.Index(i, j, k);
          const double expected = linear(0, 0, 0, plane.Reflect(volume.World(i, j, k)));
          if (result.Valid[v])
          {
            ++valid;
            ASSERT_NEAR(volume.Mirrored(result)[v], expected, 1e-4);
          }
        }
      }
    }
    EXPECT_GT(valid, 400);
  }
}

TEST(MirroredVolume, ScoreIsThatOfItsDefinition)
{
  const lacuna::Matrix4 pose;
  Volume<float> volume(pose);
  // symmetric part s and antisymmetric part a of unit steps: (1 - e) / (1 + e), e = energy of a / s
  volume.Fill([](int i, int j, int k, const Vec3&)
    { return ((j + k) % 2 ? 2.0 : -2.0) + (i < 6 ? -1.0 : 1.0) * (i != 6); });
  lacuna::ThreadExecution execution(2);
  const auto result =
    MirrorVolume(volume.Masked, PlaneAcross(pose, 6), MirrorInterpolation::Nearest, execution);
  double mean = 0;
  for (const float v : volume.Voxels)
  {
    mean += v / static_cast<double>(volume.Voxels.size());
  }
  double spread = 0;
  double difference = 0;
  for (std::size_t v = 0; v < volume.Voxels.size(); ++v)
  {
    const double m = volume.Mirrored(result)[v];
    spread += 2 * (volume.Voxels[v] - mean) * (volume.Voxels[v] - mean);
    difference += (volume.Voxels[v] - m) * (volume.Voxels[v] - m);
  }
  EXPECT_NEAR(result.Score, 1 - difference / spread, 1e-12);
  EXPECT_NEAR(result.RMS, std::sqrt(difference / static_cast<double>(volume.Voxels.size())), 1e-12);
  EXPECT_EQ(result.Overlap, 1);
}

TEST(MirroredVolume, InvalidVoxelsStayInvalid)
{
  const lacuna::Matrix4 pose;
  Volume<float> volume(pose);
  volume.Fill([](int i, int j, int k, const Vec3&) { return i + 2 * j + 3 * k; });
  volume.Voxels[volume.Index(3, 4, 2)] = std::numeric_limits<float>::quiet_NaN();
  volume.Masked.Valid.assign(volume.Voxels.size(), 1);
  volume.Masked.Valid[volume.Index(9, 1, 1)] = 0;
  lacuna::ThreadExecution execution(2);
  const auto exact =
    MirrorVolume(volume.Masked, PlaneAcross(pose, 6), MirrorInterpolation::Linear, execution);
  for (int k = 0; k < Size[2]; ++k)
  {
    for (int j = 0; j < Size[1]; ++j)
    {
      for (int i = 0; i < Size[0]; ++i)
      {
        const bool bad = (i == 9 && j == 4 && k == 2) || (i == 3 && j == 1 && k == 1);
        ASSERT_EQ(exact.Valid[volume.Index(i, j, k)], !bad) << i << " " << j << " " << k;
      }
    }
  }
  // half way between voxels both neighbours count
  const auto half =
    MirrorVolume(volume.Masked, PlaneAcross(pose, 6.25), MirrorInterpolation::Linear, execution);
  EXPECT_FALSE(half.Valid[volume.Index(9, 4, 2)]);
  EXPECT_FALSE(half.Valid[volume.Index(10, 4, 2)]);
  EXPECT_TRUE(half.Valid[volume.Index(8, 4, 2)]);
  EXPECT_TRUE(half.Valid[volume.Index(11, 4, 2)]);
}

TEST(MirroredVolume, SameForAnyNumberOfThreads)
{
  const lacuna::Matrix4 pose = Oblique();
  Volume<std::int16_t> volume(pose);
  std::mt19937 random(1);
  volume.Fill([&](int, int, int, const Vec3&) { return random() % 4000; });
  MirrorPlane plane;
  plane.Normal = Normalized(pose.Column(0) + 0.2 * pose.Column(2));
  plane.Offset = Dot(plane.Normal, pose.Point({ 6.2, 4.1, 3.3 }));
  std::vector<lacuna::MirroredVolume> results;
  for (const int threads : { 1, 2, 5 })
  {
    lacuna::ThreadExecution execution(threads);
    results.push_back(MirrorVolume(volume.Masked, plane, MirrorInterpolation::BSpline, execution));
  }
  for (const auto& r : results)
  {
    EXPECT_EQ(r.Voxels, results[0].Voxels);
    EXPECT_EQ(r.Valid, results[0].Valid);
    EXPECT_EQ(r.Score, results[0].Score);
    EXPECT_EQ(r.RMS, results[0].RMS);
    EXPECT_EQ(std::memcmp(r.Asymmetry.data(), results[0].Asymmetry.data(),
                r.Asymmetry.size() * sizeof(float)),
      0);
  }
}

namespace
{
// One of several ranks that run one after the other, twice: first each leaves what it has to add, then
// it gets the sums.
struct RankInTurn : lacuna::Ranks
{
  int Rank = 0;
  int Number = 1;
  bool First = true;
  std::vector<std::uint64_t>* Sums = nullptr;

  int GetRank() const override { return this->Rank; }
  int GetNumber() const override { return this->Number; }
  using lacuna::Ranks::Sum;
  void Sum(std::uint64_t* values, std::int64_t count) const override
  {
    this->Sums->resize(count);
    for (std::int64_t i = 0; this->First && i < count; ++i)
    {
      (*this->Sums)[i] += values[i];
    }
    std::copy(this->Sums->begin(), this->Sums->end(), values);
  }
};
}

// Ranks make their parts of the image, and find together what one rank finds, bit for bit.
TEST(MirroredVolume, PartsOnSeveralRanksAreTheWhole)
{
  const lacuna::Matrix4 pose = Oblique();
  Volume<std::int16_t> volume(pose);
  std::mt19937 random(3);
  volume.Fill([&](int, int, int, const Vec3&) { return random() % 4000; });
  volume.Masked.Valid.assign(volume.Voxels.size(), 1);
  volume.Masked.Valid[200] = 0;
  MirrorPlane plane;
  plane.Normal = Normalized(pose.Column(0) + 0.2 * pose.Column(2));
  plane.Offset = Dot(plane.Normal, pose.Point({ 6.2, 4.1, 3.3 }));
  lacuna::ThreadExecution execution(2);
  for (const auto interpolation :
    { MirrorInterpolation::BSpline, MirrorInterpolation::Linear, MirrorInterpolation::Nearest })
  {
    const auto whole = MirrorVolume(volume.Masked, plane, interpolation, execution);
    const auto voxels = volume.Mirrored(whole);
    for (int number = 1; number < 6; ++number)
    {
      std::vector<std::uint64_t> sums;
      for (int turn = 0; turn < 2 * number; ++turn)
      {
        RankInTurn ranks;
        ranks.Rank = turn % number;
        ranks.Number = number;
        ranks.First = turn < number;
        ranks.Sums = &sums;
        // along the first axis, across what they judge; of one none, and some rows are nobody's
        const lacuna::VolumePart part{ 2 * ranks.Rank,
          2 * ranks.Rank + 2 - (ranks.Rank == 3 ? 5 : 0), 1, Size[1] - 1, 2, 4 };
        const auto own =
          MirrorVolume(volume.Masked, plane, interpolation, part, true, ranks, execution);
        if (ranks.First && number > 1)
        {
          continue;
        }
        EXPECT_EQ(own.Score, whole.Score);
        EXPECT_EQ(own.RMS, whole.RMS);
        EXPECT_EQ(own.Overlap, whole.Overlap);
        const auto later = MirrorVolume(
          volume.Masked, plane, interpolation, part, false, lacuna::Ranks(), execution);
        EXPECT_EQ(later.Voxels, own.Voxels);
        const auto made = volume.Mirrored(own);
        std::size_t at = 0;
        for (int k = part[4]; k <= part[5]; ++k)
        {
          for (int j = part[2]; j <= part[3]; ++j)
          {
            for (int i = part[0]; i <= part[1]; ++i, ++at)
            {
              const std::size_t from = volume.Index(i, j, k);
              EXPECT_EQ(made[at], voxels[from]);
              EXPECT_EQ(own.Valid[at], whole.Valid[from]);
              EXPECT_EQ(std::memcmp(&own.Asymmetry[at], &whole.Asymmetry[from], sizeof(float)), 0);
            }
          }
        }
        EXPECT_EQ(own.Valid.size(), at);
      }
    }
  }
}

TEST(MirroredVolume, NothingMeetsOutsideOfTheVolume)
{
  const lacuna::Matrix4 pose;
  Volume<std::int16_t> volume(pose);
  volume.Fill([&](int i, int, int, const Vec3&) { return 10 + i; });
  lacuna::ThreadExecution execution(1);
  const auto result =
    MirrorVolume(volume.Masked, PlaneAcross(pose, 100), MirrorInterpolation::BSpline, execution);
  EXPECT_EQ(result.Overlap, 0);
  EXPECT_TRUE(std::isnan(result.Score));
  EXPECT_EQ(volume.Mirrored(result)[0], 10);
  volume.Masked.Volume.Size = { 2000000, 100000, 100000 };
  EXPECT_THROW(
    MirrorVolume(volume.Masked, PlaneAcross(pose, 6), MirrorInterpolation::BSpline, execution),
    std::runtime_error);
}

TEST(MirroredVolume, BehindTheLastVoxelThereIsNothing)
{
  // a part of an array that goes on; the plane is oblique by rounding, and shifts along the flat axis
  std::vector<double> voxels(static_cast<std::size_t>(2 * 13 * 9), std::nan(""));
  lacuna::MaskedVolume flat;
  flat.Volume.Voxels = voxels.data();
  flat.Volume.Type = lacuna::GetScalarType<double>();
  flat.Volume.Size = { 13, 9, 1 };
  for (std::size_t i = 0; i < 13 * 9; ++i)
  {
    voxels[i] = static_cast<double>(i % 13);
  }
  lacuna::ThreadExecution execution(1);
  for (const double tilt : { -1e-8, 1e-8 })
  {
    MirrorPlane plane;
    plane.Normal = Normalized(Vec3{ 1, 0, tilt });
    plane.Offset = 6;
    const auto result = MirrorVolume(flat, plane, MirrorInterpolation::Linear, execution);
    const auto* mirrored = reinterpret_cast<const double*>(result.Voxels.data());
    for (std::size_t i = 0; i < 13 * 9; ++i)
    {
      EXPECT_NEAR(mirrored[i], static_cast<double>(12 - i % 13), 1e-6) << i;
    }
  }
}
