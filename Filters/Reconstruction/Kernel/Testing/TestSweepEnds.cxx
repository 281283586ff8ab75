// SPDX-License-Identifier: BSD-3-Clause
/// Sweeps end where the probe was lifted, and nowhere else: a table of sweeps that hands and motors
/// make, with the ends that are true.
#include "lacunaSweepEnds.h"
#include "lacunaSyntheticSweep.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

using namespace lacuna;

namespace
{
constexpr double Pi = 3.14159265358979323846;
constexpr double FrameTime = 0.1; // s
constexpr double Unknown = std::numeric_limits<double>::quiet_NaN();

// Slices of 30 x 20 mm, pixel (0, 0) at the origin of the pose.
struct Slices
{
  std::vector<Matrix4> Poses;
  std::vector<std::int64_t> Numbers;
  std::vector<double> Times;
  std::vector<std::size_t> Ends; ///< indices of first slices, as they are true

  void Add(const Matrix4& pose)
  {
    this->Numbers.push_back(this->Numbers.empty() ? 0 : this->Numbers.back() + 1);
    this->Times.push_back(this->Times.empty() ? 0 : this->Times.back() + FrameTime);
    this->Poses.push_back(pose);
  }

  // Another sweep, seconds after this one.
  void Append(const Slices& next, double seconds)
  {
    this->Ends.push_back(this->Poses.size());
    const double start = this->Times.back() + seconds;
    const std::int64_t number = this->Numbers.back() + 1;
    for (std::size_t i = 0; i < next.Poses.size(); ++i)
    {
      this->Poses.push_back(next.Poses[i]);
      this->Numbers.push_back(number + next.Numbers[i]);
      this->Times.push_back(start + next.Times[i]);
    }
  }

  // Only those that are kept. Whether the numbers and the times say that there were others.
  Slices Keep(const std::vector<bool>& isKept, bool hasNumbers, bool hasTimes) const
  {
    Slices kept;
    for (std::size_t i = 0, end = 0; i < this->Poses.size(); ++i)
    {
      if (isKept[i])
      {
        if (end < this->Ends.size() && this->Ends[end] <= i)
        {
          kept.Ends.push_back(kept.Poses.size());
          ++end;
        }
        kept.Numbers.push_back(
          hasNumbers ? this->Numbers[i] : static_cast<std::int64_t>(kept.Poses.size()));
        kept.Times.push_back(
          hasTimes ? this->Times[i] : static_cast<double>(kept.Poses.size()) * FrameTime);
        kept.Poses.push_back(this->Poses[i]);
      }
    }
    return kept;
  }

  Slices GetFirst(std::size_t count) const
  {
    Slices first = *this;
    first.Poses.resize(count);
    first.Numbers.resize(count);
    first.Times.resize(count);
    return first;
  }

  std::vector<SweepEnd> Find() const
  {
    std::vector<SlicePlace> places;
    for (std::size_t i = 0; i < this->Poses.size(); ++i)
    {
      SliceImage slice;
      slice.Width = 61;
      slice.Height = 41;
      slice.PixelToReference = this->Poses[i] * Matrix4::Scaling({ 0.5, 0.5, 1 });
      places.push_back({ this->Numbers[i], GetCorners(slice) });
    }
    return FindSweepEnds(places, this->Times);
  }
};

using Indices = std::vector<std::size_t>;

Indices Find(const Slices& slices)
{
  Indices indices;
  for (const SweepEnd& end : slices.Find())
  {
    indices.push_back(end.Next);
  }
  return indices;
}

// Along z from start, by steps that speed(i) gives.
template <class Speed>
Slices MakePath(const Vec3& start, int count, const Speed& speed)
{
  Slices strip;
  Vec3 place = start;
  for (int i = 0; i < count; ++i)
  {
    strip.Add(Matrix4::Translation(place));
    place[2] += speed(i);
  }
  return strip;
}

Slices MakeStrip(const Vec3& start, int count, double step = 1)
{
  return MakePath(start, count, [&](int) { return step; });
}

// A hand is never quite steady: mm and radians.
Slices Shake(Slices slices, double mm, double radians, unsigned int seed)
{
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  for (Matrix4& pose : slices.Poses)
  {
    const Vec3 shift{ mm * normal(random), mm * normal(random), mm * normal(random) };
    const Vec3 axis{ normal(random), normal(random), normal(random) };
    pose = pose * Matrix4::Translation(shift) * Matrix4::Rotation(axis, radians * normal(random));
  }
  return slices;
}

// The motions of Phantom Sweep, and what hands do besides.
std::vector<std::pair<std::string, Slices>> MakeSingleSweeps()
{
  std::vector<std::pair<std::string, Slices>> sweeps;
  const auto add = [&](const char* name, int count, const auto& pose)
  {
    Slices slices;
    for (int i = 0; i < count; ++i)
    {
      slices.Add(pose(i, i / double(count - 1)));
    }
    sweeps.emplace_back(name, slices);
  };
  const Matrix4 middle = Matrix4::Translation({ -15, 0, 0 });
  add("sweep", 60, [&](int, double t) { return Matrix4::Translation({ -15, 0, 60 * t }); });
  add("fine sweep", 800, [&](int, double t) { return Matrix4::Translation({ -15, 0, 60 * t }); });
  add("coarse sweep", 9, [&](int, double t) { return Matrix4::Translation({ -15, 0, 60 * t }); });
  add("three slices", 3, [&](int, double t) { return Matrix4::Translation({ -15, 0, 60 * t }); });
  add("thick steps", 30, [&](int i, double) { return Matrix4::Translation({ -15, 0, 8.0 * i }); });
  add("fan", 60,
    [&](int, double t) {
      return Matrix4::Rotation({ 1, 0, 0 }, (t - 0.5) * Pi / 2) * middle;
    });
  add("twist", 60, [&](int, double t) { return Matrix4::Rotation({ 0, 1, 0 }, t * Pi) * middle; });
  add("arbitrary", 120,
    [&](int, double t)
    {
      return Matrix4::Translation({ 6 * std::sin(5 * t), 4 * std::sin(9 * t), 60 * t }) *
        Matrix4::Rotation({ 1, 0.5, 0.2 }, 0.3 * std::sin(7 * t)) * middle;
    });
  add("to and fro", 160,
    [&](int, double t) {
      return Matrix4::Translation({ -15, 0, 30 * std::sin(12 * t) });
    });
  // between a fifth of a step and five: by and by, and all of a sudden
  add("speed in waves", 200,
    [&](int, double t) {
      return Matrix4::Translation({ -15, 0, 60 * (t + std::sin(20 * t) * 0.8 / 20) });
    });
  Vec3 place{ -15, 0, 0 };
  add("sudden speeds", 200,
    [&](int i, double)
    {
      place[2] += i % 50 < 25 ? 0.2 : 1.0;
      return Matrix4::Translation(place);
    });
  place = { -15, 0, 0 };
  add("one fast second", 120,
    [&](int i, double)
    {
      place[2] += i >= 60 && i < 70 ? 2.5 : 0.5;
      return Matrix4::Translation(place);
    });
  place = { -15, 0, 0 };
  add("single steps of five", 120,
    [&](int i, double)
    {
      place[2] += i % 40 == 20 ? 2.5 : 0.5;
      return Matrix4::Translation(place);
    });
  place = { -15, 0, 0 };
  add("slow tails", 300,
    [&](int i, double)
    {
      place[2] += 0.02 + 1.5 * std::exp(-std::pow((i - 150) / 30.0, 2));
      return Matrix4::Translation(place);
    });
  place = { -15, 0, 0 };
  add("rest, then off", 200,
    [&](int i, double)
    {
      place[2] += i < 100 ? 0.001 * (i % 3 - 1) : 1.0;
      return Matrix4::Translation(place);
    });
  add("step and shoot", 400,
    [&](int i, double) {
      return Matrix4::Translation({ -15, 0.01 * (i * 7 % 5), 3.0 * (i / 20) });
    });
  return sweeps;
}
}

TEST(SweepEnds, SweepsOfOnePieceHaveNone)
{
  for (const auto& [name, slices] : MakeSingleSweeps())
  {
    EXPECT_EQ(Find(slices), Indices()) << name;
    for (unsigned int seed = 0; seed < 20; ++seed)
    {
      const double part = name == "step and shoot" ? 0.3 : 1; // by a motor
      EXPECT_EQ(Find(Shake(slices, 0.1 * part, 0.003 * part, seed)), Indices())
        << name << ", shaken " << seed;
    }
  }
}

TEST(SweepEnds, MissingSlicesEndNoSweep)
{
  for (const auto& [name, slices] : MakeSingleSweeps())
  {
    for (unsigned int seed = 0; seed < 10; ++seed)
    {
      std::mt19937 random(seed);
      for (const double part : { 0.1, 0.3, 0.5 })
      {
        std::vector<bool> isKept(slices.Poses.size());
        for (std::size_t i = 0; i < isKept.size(); ++i)
        {
          isKept[i] = std::uniform_real_distribution<double>(0, 1)(random) >= part;
        }
        const Slices shaken = Shake(slices, 0.05, 0.002, seed);
        for (const bool hasNumbers : { false, true })
        {
          for (const bool hasTimes : { false, true })
          {
            // a hand that turns, or jerks, looks the same as a lift when nothing tells of the missing
            if (!hasNumbers && !hasTimes &&
              (part == 0.5 || name == "to and fro" || name == "one fast second" ||
                name == "single steps of five"))
            {
              continue;
            }
            EXPECT_EQ(Find(shaken.Keep(isKept, hasNumbers, hasTimes)), Indices())
              << name << ", " << part << ", " << seed << hasNumbers << hasTimes;
          }
        }
      }
      // every third slice, from anywhere
      std::vector<bool> strided(slices.Poses.size());
      for (std::size_t i = 0; i < strided.size(); ++i)
      {
        strided[i] = i % 3 == seed % 3;
      }
      EXPECT_EQ(Find(slices.Keep(strided, seed % 2 == 0, true)), Indices()) << name;
    }
  }
}

// What a person may do between two strips; and the slices of the strips.
namespace
{
struct Strips
{
  std::string Name;
  Slices Sweeps;
};

std::vector<Strips> MakeStrips(const std::vector<double>& pauses = { FrameTime, 0.5, 5.0, -3.0 })
{
  std::vector<Strips> all;
  const auto add = [&](const char* name, const std::vector<Slices>& strips, double pause)
  {
    Slices sweeps = strips[0];
    for (std::size_t s = 1; s < strips.size(); ++s)
    {
      sweeps.Append(strips[s], pause);
    }
    all.push_back({ name, sweeps });
  };
  for (const double pause : pauses)
  {
    const Slices first = MakeStrip({ 0, 0, 0 }, 21);
    add("side by side", { first, MakeStrip({ 30, 0, 0 }, 21) }, pause);
    add("overlapping", { first, MakeStrip({ 20, 0, 0 }, 21) }, pause);
    add("nearly the same", { first, MakeStrip({ 2, 0, 0 }, 21) }, pause);
    add("the same place again", { first, MakeStrip({ 0, 0, 0 }, 21) }, pause);
    add("reversed", { first, MakeStrip({ 20, 0, 20 }, 21, -1) }, pause);
    add("end to end", { first, MakeStrip({ 0, 0, 40 }, 21) }, pause);
    add("three side by side", { first, MakeStrip({ 20, 0, 0 }, 21), MakeStrip({ 40, 0, 0 }, 21) },
      pause);
    add("three, there and back",
      { first, MakeStrip({ 20, 0, 20 }, 21, -1), MakeStrip({ 40, 0, 0 }, 21) }, pause);
    add("three of unequal steps",
      { MakeStrip({ 0, 0, 0 }, 60, 0.3), MakeStrip({ 20, 0, 0 }, 12, 2), first }, pause);
    add("six short ones",
      { MakeStrip({ 0, 0, 0 }, 6), MakeStrip({ 20, 0, 0 }, 6), MakeStrip({ 40, 0, 0 }, 6),
        MakeStrip({ 60, 0, 0 }, 6), MakeStrip({ 80, 0, 0 }, 6), MakeStrip({ 100, 0, 0 }, 6) },
      pause);
  }
  return all;
}
}

TEST(SweepEnds, StripsEndWhereTheProbeIsLifted)
{
  for (const Strips& strips : MakeStrips())
  {
    EXPECT_EQ(Find(strips.Sweeps), strips.Sweeps.Ends) << strips.Name;
    for (unsigned int seed = 0; seed < 20; ++seed)
    {
      EXPECT_EQ(Find(Shake(strips.Sweeps, 0.1, 0.003, seed)), strips.Sweeps.Ends)
        << strips.Name << ", shaken " << seed;
    }
  }
}

// Where half of the slices are missing at random a lift by hand, of 28 mm, is still longer than
// what is missing; it takes longer, or does not go on in the direction of the sweep.
TEST(SweepEnds, StripsWithMissingSlices)
{
  for (const Strips& strips : MakeStrips())
  {
    if (strips.Name == "six short ones") // too few slices are left of some
    {
      continue;
    }
    for (unsigned int seed = 0; seed < 20; ++seed)
    {
      std::mt19937 random(seed);
      std::vector<bool> isKept(strips.Sweeps.Poses.size());
      for (std::size_t i = 0; i < isKept.size(); ++i)
      {
        isKept[i] = random() % 10 < 7;
      }
      for (const bool hasNumbers : { false, true })
      {
        const Slices kept = strips.Sweeps.Keep(isKept, hasNumbers, true);
        EXPECT_EQ(Find(kept), kept.Ends) << strips.Name << ", " << seed;
      }
    }
  }
}

// Gated: of each heart beat of 20 slices the first few are taken, and the numbers tell. The step to
// the next beat is an ordinary one where there are many of them.
TEST(SweepEnds, EachBeatLeavesSlicesOut)
{
  const Slices sweep = MakeStrip({ 0, 0, 0 }, 400, 0.2);
  for (const std::size_t taken : { 1, 2, 3 })
  {
    std::vector<bool> isKept(sweep.Poses.size());
    for (std::size_t i = 0; i < isKept.size(); ++i)
    {
      isKept[i] = i % 20 < taken;
    }
    EXPECT_EQ(Find(sweep.Keep(isKept, true, true)), Indices()) << taken;
  }
}

// The tracker loses the probe for a moment: the sweep goes on. For long, and the probe goes far: it
// ends. The probe waits: it goes on.
TEST(SweepEnds, SlicesThatAreLost)
{
  const Slices sweep = MakeStrip({ 0, 0, 0 }, 120);
  for (const std::size_t lost : { 1, 3, 9, 10, 20, 40 })
  {
    std::vector<bool> isKept(sweep.Poses.size(), true);
    std::fill_n(isKept.begin() + 50, lost, false);
    for (const bool hasNumbers : { false, true })
    {
      EXPECT_EQ(Find(sweep.Keep(isKept, hasNumbers, true)), lost < 10 ? Indices() : Indices{ 50 })
        << lost;
    }
  }
  for (const double pause : { 1.0, 5.0, 600.0 })
  {
    for (const double way : { 0.0, 0.5, 1.0, 2.0 })
    {
      Slices waited = MakeStrip({ 0, 0, 0 }, 60);
      waited.Append(MakeStrip({ 0, 0, 59 + way }, 60), pause);
      EXPECT_EQ(Find(waited), Indices()) << pause << ", " << way;
    }
  }
}

TEST(SweepEnds, WhatIsReported)
{
  Slices strips = MakeStrip({ 0, 0, 0 }, 21);
  strips.Append(MakeStrip({ 20, 0, 0 }, 21), 5);
  const std::vector<SweepEnd> ends = strips.Find();
  ASSERT_EQ(ends.size(), 1u);
  EXPECT_EQ(ends[0].Next, 21u);
  EXPECT_NEAR(ends[0].Distance, std::hypot(20, 20), 1e-9);
  EXPECT_NEAR(ends[0].Limit, 3, 1e-9);
  EXPECT_NEAR(ends[0].Time, 5, 1e-9);

  strips.Times.assign(strips.Times.size(), Unknown);
  ASSERT_EQ(strips.Find().size(), 1u);
  EXPECT_TRUE(std::isnan(strips.Find()[0].Time));
}

TEST(SweepEnds, NothingToTellFrom)
{
  EXPECT_EQ(Find({}), Indices());
  EXPECT_EQ(Find(MakeStrip({ 0, 0, 0 }, 1)), Indices());
  EXPECT_EQ(Find(MakeStrip({ 0, 0, 0 }, 2, 30)), Indices());
  EXPECT_EQ(Find(MakeStrip({ 0, 0, 0 }, 50, 0)), Indices()) << "at rest";
  EXPECT_THROW(FindSweepEnds({}, { 1.0 }), std::invalid_argument);
}

// Slices arrive one by one: the answer about each step is the same from the beginning.
TEST(SweepEnds, TheAnswerStays)
{
  std::vector<Strips> all = MakeStrips();
  for (const auto& [name, slices] : MakeSingleSweeps())
  {
    if (slices.Poses.size() <= 300) // the others take long
    {
      all.push_back({ name, slices });
    }
  }
  for (const Strips& strips : all)
  {
    for (const double shake : { 0.0, 1.0 })
    {
      const Slices sweeps = Shake(strips.Sweeps, 0.05 * shake, 0.002 * shake, 1);
      Indices before;
      for (std::size_t count = 1; count <= sweeps.Poses.size(); ++count)
      {
        const Indices now = Find(sweeps.GetFirst(count));
        if (!now.empty() && now.back() + 1 == count) // of the step that has just come
        {
          before.push_back(now.back());
        }
        EXPECT_EQ(now, before) << strips.Name << ", slice " << count;
        before = now;
      }
    }
  }
}

namespace
{
double GetGrey(const Vec3& p)
{
  return 128 + 60 * std::sin(0.6 * p[2]) + 20 * std::sin(0.3 * p[0]) + 10 * std::sin(0.4 * p[1]);
}

// A voxel is far from all strips, or in one of them, or at a border.
enum class Place
{
  Air,
  Border,
  Strip
};

Place GetPlace(const Vec3& p, const std::vector<std::array<Vec3, 2>>& boxes, double border)
{
  Place place = Place::Air;
  for (const std::array<Vec3, 2>& box : boxes)
  {
    double outside = -1e9;
    for (std::size_t a = 0; a < 3; ++a)
    {
      outside = std::max({ outside, box[0][a] - p[a], p[a] - box[1][a] });
    }
    place = outside <= 1e-6 ? Place::Strip
      : outside < border    ? std::max(place, Place::Border)
                            : place;
  }
  return place;
}
}

// The truth is a formula: each voxel in a strip is filled and right, and none in the air.
TEST(SweepEnds, VolumesOfStrips)
{
  for (const Strips& strips : MakeStrips({ FrameTime }))
  {
    const Slices& slices = strips.Sweeps;
    SyntheticSweep<float> sweep(61, 41, ScalarType::Float32);
    std::vector<std::array<Vec3, 2>> boxes;
    const Indices ends = Find(slices);
    for (std::size_t i = 0; i < slices.Poses.size(); ++i)
    {
      sweep.AddField(slices.Poses[i] * Matrix4::Scaling({ 0.5, 0.5, 1 }), GetGrey);
      sweep.Slices.back().BeginsSweep = std::find(ends.begin(), ends.end(), i) != ends.end();
      const Vec3 low = slices.Poses[i].Column(3);
      const Vec3 high = low + Vec3{ 30, 20, 0 };
      if (i == 0 || std::find(slices.Ends.begin(), slices.Ends.end(), i) != slices.Ends.end())
      {
        boxes.push_back({ low, high });
      }
      boxes.back()[0][2] = std::min(boxes.back()[0][2], low[2]);
      boxes.back()[1][2] = std::max(boxes.back()[1][2], high[2]);
    }
    const VolumeGrid grid = MakeGrid(sweep.Slices, { 0.9, 0.7, 0.3 });
    const WrittenVolume<float> volume =
      Reconstruct<float>(sweep.Slices, grid, GetExtent(grid), SweptVolume::Options());
    int holes = 0;
    int air = 0;
    double squares = 0;
    double filled = 0;
    std::size_t n = 0;
    for (int k = 0; k < grid.Dimensions[2]; ++k)
    {
      for (int j = 0; j < grid.Dimensions[1]; ++j)
      {
        for (int i = 0; i < grid.Dimensions[0]; ++i, ++n)
        {
          const Vec3 point = GetPoint(grid, i, j, k);
          const Place place = GetPlace(point, boxes, 1);
          holes += place == Place::Strip && !volume.Mask[n] ? 1 : 0;
          air += place == Place::Air && volume.Mask[n] ? 1 : 0;
          if (place == Place::Strip && volume.Mask[n])
          {
            squares += std::pow(volume.Intensity[n] - GetGrey(point), 2);
            ++filled;
          }
        }
      }
    }
    EXPECT_EQ(holes, 0) << strips.Name;
    EXPECT_EQ(air, 0) << strips.Name;
    // what straight lines between slices 1 mm apart make of the sine along z; 2 mm for one strip
    EXPECT_LT(std::sqrt(squares / filled), strips.Name == "three of unequal steps" ? 3.5 : 1.7)
      << strips.Name;
  }
}
