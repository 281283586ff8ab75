// SPDX-License-Identifier: BSD-3-Clause
/// A volume whose sweep grows: bit by bit that of all slices at once, made of the new slices alone,
/// and never of old ones that are not the same any more.
#include "lacunaSweptVolume.h"
#include "lacunaSyntheticSweep.h"

#include <gtest/gtest.h>

#include <cstring>
#include <set>

using namespace lacuna;

namespace
{
constexpr int Width = 31;
constexpr int Height = 25;

SyntheticSweep<std::uint8_t> MakeSweep(int count, unsigned int seed)
{
  SyntheticSweep<std::uint8_t> sweep(Width, Height, ScalarType::UInt8);
  std::mt19937 random(seed);
  for (const Matrix4& pose : MakeRandomPoses(count, seed, 0.2))
  {
    sweep.Add(pose, [&](int, int) { return random() % 256; });
  }
  return sweep;
}

std::vector<SliceImage> GetFirst(const std::vector<SliceImage>& slices, std::size_t count)
{
  return { slices.begin(), slices.begin() + static_cast<std::ptrdiff_t>(count) };
}

// The volume of sweeps at once.
WrittenVolume<float> MakeAtOnce(const std::vector<std::vector<SliceImage>>& sweeps,
  const VolumeGrid& grid, const SweptVolume::Options& options)
{
  ThreadExecution execution(1);
  SweptVolume volume(grid, GetExtent(grid), options);
  for (const std::vector<SliceImage>& sweep : sweeps)
  {
    volume.BeginSweep();
    volume.AddSlices(sweep, execution);
  }
  return Write<float>(volume, GetExtent(grid));
}

struct Updated
{
  WrittenVolume<float> Volume;
  std::int64_t Added;
};

Updated Update(GrowingVolume& growing, const std::vector<std::vector<SliceImage>>& sweeps,
  const VolumeGrid& grid, const SweptVolume::Options& options, bool isGrowing = false,
  int threads = 1)
{
  GrowingVolume::Sweeps pointers;
  for (const std::vector<SliceImage>& sweep : sweeps)
  {
    pointers.push_back(&sweep);
  }
  ThreadExecution execution(threads);
  const SweptVolume& volume =
    growing.Update(pointers, grid, GetExtent(grid), options, isGrowing, execution);
  Updated updated{ Write<float>(volume, GetExtent(grid)), growing.GetNumberOfSlicesAdded() };
  growing.Finish();
  return updated;
}

std::vector<SweptVolume::Options> GetAllOptions()
{
  std::vector<SweptVolume::Options> all(6);
  all[1].Sampling = PixelSampling::Nearest;
  all[2].Compound = Compounding::Maximum;
  all[3].Interpolation = SweptVolume::Method::NearestVoxel;
  all[4].DoublePrecision = true;
  all[5].FootprintAcrossSlices = true;
  return all;
}

// Another copy of a slice's pixels.
struct Copy
{
  explicit Copy(const SliceImage& slice)
    : Pixels(static_cast<const std::uint8_t*>(slice.Pixels),
        static_cast<const std::uint8_t*>(slice.Pixels) + slice.RowStride * slice.Height)
  {
  }
  std::vector<std::uint8_t> Pixels;
};
}

TEST(GrowingVolume, OneByOneIsAtOnce)
{
  const SyntheticSweep<std::uint8_t> sweep = MakeSweep(12, 3);
  const VolumeGrid grid = MakeGrid(sweep.Slices, { 0.3, 0.4, 0.35 });
  for (const SweptVolume::Options& options : GetAllOptions())
  {
    for (const int threads : { 1, 2, 5 })
    {
      GrowingVolume growing;
      for (std::size_t n = 2; n <= sweep.Slices.size(); ++n)
      {
        const std::vector<std::vector<SliceImage>> slices{ GetFirst(sweep.Slices, n) };
        const Updated updated = Update(growing, slices, grid, options, true, threads);
        EXPECT_EQ(updated.Added, n == 2 ? 2 : 1);
        EXPECT_TRUE(updated.Volume == MakeAtOnce(slices, grid, options)) << n << " slices";
      }
    }
  }
}

TEST(GrowingVolume, SeveralSweeps)
{
  const SyntheticSweep<std::uint8_t> first = MakeSweep(7, 4);
  const SyntheticSweep<std::uint8_t> second = MakeSweep(6, 4);
  const VolumeGrid grid = MakeGrid(first.Slices, { 0.4, 0.4, 0.4 });
  const SweptVolume::Options options;
  GrowingVolume growing;
  std::vector<std::vector<SliceImage>> sweeps{ first.Slices };
  Update(growing, sweeps, grid, options, true);
  sweeps.push_back(GetFirst(second.Slices, 3));
  Updated updated = Update(growing, sweeps, grid, options, true);
  EXPECT_EQ(updated.Added, 3); // a new sweep
  EXPECT_TRUE(updated.Volume == MakeAtOnce(sweeps, grid, options));
  sweeps[1] = second.Slices;
  updated = Update(growing, sweeps, grid, options, true);
  EXPECT_EQ(updated.Added, 3); // the last one grows
  EXPECT_TRUE(updated.Volume == MakeAtOnce(sweeps, grid, options));
  // the first one grows: its slices come before those of the second
  sweeps[0].push_back(second.Slices[0]);
  updated = Update(growing, sweeps, grid, options, true);
  EXPECT_EQ(updated.Added, 14);
  EXPECT_TRUE(updated.Volume == MakeAtOnce(sweeps, grid, options));
  // the same slices as one sweep
  const std::vector<std::vector<SliceImage>> one{ [&]
    {
      std::vector<SliceImage> all = sweeps[0];
      all.insert(all.end(), sweeps[1].begin(), sweeps[1].end());
      return all;
    }() };
  updated = Update(growing, one, grid, options, true);
  EXPECT_EQ(updated.Added, 14);
  EXPECT_TRUE(updated.Volume == MakeAtOnce(one, grid, options));
}

TEST(GrowingVolume, KeepsNothingUntilItGrows)
{
  const SyntheticSweep<std::uint8_t> sweep = MakeSweep(8, 5);
  const VolumeGrid grid = MakeGrid(sweep.Slices, { 0.4, 0.4, 0.4 });
  const SweptVolume::Options options;
  GrowingVolume growing;
  EXPECT_EQ(Update(growing, { GetFirst(sweep.Slices, 4) }, grid, options).Added, 4);
  EXPECT_EQ(Update(growing, { GetFirst(sweep.Slices, 4) }, grid, options).Added, 4);
  EXPECT_EQ(Update(growing, { GetFirst(sweep.Slices, 5) }, grid, options).Added, 5); // it does
  EXPECT_EQ(Update(growing, { GetFirst(sweep.Slices, 6) }, grid, options).Added, 1);
  EXPECT_EQ(Update(growing, { GetFirst(sweep.Slices, 6) }, grid, options).Added, 0);
  EXPECT_EQ(Update(growing, { sweep.Slices }, grid, options).Added, 2);
  // a shorter one is a new one
  EXPECT_EQ(Update(growing, { GetFirst(sweep.Slices, 3) }, grid, options).Added, 3);
  EXPECT_EQ(Update(growing, { GetFirst(sweep.Slices, 3) }, grid, options).Added, 3);
}

TEST(GrowingVolume, WhatDiffersIsMadeAnew)
{
  const SyntheticSweep<std::uint8_t> sweep = MakeSweep(8, 6);
  const VolumeGrid grid = MakeGrid(sweep.Slices, { 0.4, 0.4, 0.4 });
  const SweptVolume::Options options;
  const std::vector<std::vector<SliceImage>> some{ GetFirst(sweep.Slices, 6) };
  const auto expectAnew = [&](const std::vector<std::vector<SliceImage>>& sweeps,
                            const VolumeGrid& newGrid, const SweptVolume::Options& newOptions,
                            const char* what)
  {
    GrowingVolume growing;
    Update(growing, some, grid, options, true);
    const Updated updated = Update(growing, sweeps, newGrid, newOptions, true);
    EXPECT_EQ(updated.Added, static_cast<std::int64_t>(sweeps[0].size())) << what;
    EXPECT_TRUE(updated.Volume == MakeAtOnce(sweeps, newGrid, newOptions)) << what;
  };

  // any pixel of any slice, by the smallest change
  std::vector<std::vector<SliceImage>> changed{ sweep.Slices };
  for (const std::size_t slice : { 0, 3, 5 })
  {
    for (const int pixel : { 0, 17, Width - 1, Width * Height / 2, Width * Height - 1 })
    {
      Copy copy(sweep.Slices[slice]);
      copy.Pixels[static_cast<std::size_t>(pixel)] ^= 1;
      changed = { sweep.Slices };
      changed[0][slice].Pixels = copy.Pixels.data();
      expectAnew(changed, grid, options, "pixel");
    }
  }
  for (const std::size_t element : { 0, 5, 3, 7 })
  {
    changed = { sweep.Slices };
    double& value =
      changed[0][2].PixelToReference(static_cast<int>(element / 4), static_cast<int>(element % 4));
    value = std::nextafter(value, 1e9);
    expectAnew(changed, grid, options, "pose");
  }
  changed = { sweep.Slices };
  std::swap(changed[0][1], changed[0][2]);
  expectAnew(changed, grid, options, "order");
  changed = { sweep.Slices };
  changed[0].erase(changed[0].begin());
  expectAnew(changed, grid, options, "first slice missing");
  changed = { sweep.Slices };
  changed[0][4].Width -= 1;
  expectAnew(changed, grid, options, "window");
  changed = { sweep.Slices };
  changed[0][4].Type = ScalarType::Int8;
  for (SliceImage& slice : changed[0])
  {
    slice.Type = ScalarType::Int8;
  }
  expectAnew(changed, grid, options, "type");
  changed = { sweep.Slices };
  const Fan fan{ { 15, -10 }, { -30, 30 }, { 1, 8 } };
  for (SliceImage& slice : changed[0])
  {
    slice.Fan = std::make_shared<const FanMask>(fan, Width, Height, Vec2{ 0.31, 0.23 });
  }
  expectAnew(changed, grid, options, "fan");

  VolumeGrid moved = grid;
  moved.Origin[1] += 1e-12;
  expectAnew({ sweep.Slices }, moved, options, "origin");
  VolumeGrid larger = grid;
  larger.Dimensions[2] += 1;
  expectAnew({ sweep.Slices }, larger, options, "dimensions");
  for (std::size_t n = 1; n < GetAllOptions().size(); ++n)
  {
    expectAnew({ sweep.Slices }, grid, GetAllOptions()[n], "options");
  }
  SweptVolume::Options gap;
  gap.MaximumSliceGap = 0.5;
  expectAnew({ sweep.Slices }, grid, gap, "gap");
}

TEST(GrowingVolume, CopiesOfTheSamePixelsAreTheSame)
{
  const SyntheticSweep<std::uint8_t> sweep = MakeSweep(8, 7);
  const VolumeGrid grid = MakeGrid(sweep.Slices, { 0.4, 0.4, 0.4 });
  const SweptVolume::Options options;
  GrowingVolume growing;
  Update(growing, { GetFirst(sweep.Slices, 5) }, grid, options, true);
  std::vector<Copy> copies;
  std::vector<SliceImage> copied = sweep.Slices;
  for (SliceImage& slice : copied)
  {
    copies.emplace_back(slice);
    slice.Pixels = copies.back().Pixels.data();
    slice.Label = "another name";
  }
  const Updated updated = Update(growing, { copied }, grid, options, true);
  EXPECT_EQ(updated.Added, 3);
  EXPECT_TRUE(updated.Volume == MakeAtOnce({ sweep.Slices }, grid, options));
  // a source that writes into the same memory
  Copy& second = copies[1];
  second.Pixels[40] ^= 8;
  const Updated overwritten = Update(growing, { copied }, grid, options, true);
  EXPECT_EQ(overwritten.Added, 8);
  EXPECT_TRUE(overwritten.Volume == MakeAtOnce({ copied }, grid, options));
}

TEST(GrowingVolume, NothingIsKeptWhenStopped)
{
  const SyntheticSweep<std::uint8_t> sweep = MakeSweep(40, 8);
  const VolumeGrid grid = MakeGrid(sweep.Slices, { 0.2, 0.2, 0.2 });
  const SweptVolume::Options options;
  const std::vector<SliceImage> some = GetFirst(sweep.Slices, 3);
  GrowingVolume growing;
  Update(growing, { some }, grid, options, true);
  int calls = 0;
  ThreadExecution stopping(1, [&](double) { return ++calls < 4; });
  EXPECT_THROW(
    growing.Update({ &sweep.Slices }, grid, GetExtent(grid), options, true, stopping), Aborted);
  const Updated updated = Update(growing, { sweep.Slices }, grid, options, true);
  EXPECT_EQ(updated.Added, 40);
  EXPECT_TRUE(updated.Volume == MakeAtOnce({ sweep.Slices }, grid, options));
}

TEST(PixelHash, EveryBitAndEveryPlaceCounts)
{
  std::set<std::pair<std::uint64_t, std::uint64_t>> seen;
  const auto add = [&](const SliceImage& slice)
  {
    const PixelHash hash = HashPixels(slice);
    EXPECT_TRUE(seen.emplace(hash.First, hash.Second).second);
  };
  for (const int width : { 2, 7, 32, 33, 61 })
  {
    std::vector<std::uint8_t> pixels(static_cast<std::size_t>(width) * 5, 7);
    SliceImage slice;
    slice.Pixels = pixels.data();
    slice.RowStride = width;
    slice.Width = width;
    slice.Height = 5;
    add(slice);
    for (std::uint8_t& pixel : pixels)
    {
      for (int bit = 0; bit < 8; ++bit)
      {
        pixel = static_cast<std::uint8_t>(pixel ^ (1 << bit));
        add(slice);
        pixel = static_cast<std::uint8_t>(pixel ^ (1 << bit));
      }
    }
    // what lies beside the window does not count
    slice.Width = width - 1;
    const PixelHash cut = HashPixels(slice);
    pixels[static_cast<std::size_t>(width) - 1] = 99;
    EXPECT_TRUE(HashPixels(slice) == cut);
  }
}
