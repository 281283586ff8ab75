// SPDX-License-Identifier: BSD-3-Clause
/// The memory that casting takes beyond the volume and the map: counted at every allocation, and
/// asked of the system. A program of its own, since it replaces the global operator new.
#include "lacunaIsoRayCaster.h"
#include "lacunaProcessMemory.h"
#include "lacunaSanitized.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <new>
#include <vector>

#include <malloc.h>

namespace
{
std::atomic<std::int64_t> InUse{ 0 };
std::atomic<std::int64_t> Peak{ 0 };

void* Count(void* p)
{
  if (!p)
  {
    throw std::bad_alloc();
  }
  const std::int64_t now = InUse += static_cast<std::int64_t>(malloc_usable_size(p));
  std::int64_t peak = Peak;
  while (now > peak && !Peak.compare_exchange_weak(peak, now))
  {
  }
  return p;
}

void Release(void* p)
{
  InUse -= static_cast<std::int64_t>(malloc_usable_size(p));
  std::free(p);
}
}

void* operator new(std::size_t size)
{
  return Count(std::malloc(size));
}
void* operator new[](std::size_t size)
{
  return Count(std::malloc(size));
}
void* operator new(std::size_t size, std::align_val_t alignment)
{
  const auto a = static_cast<std::size_t>(alignment);
  return Count(std::aligned_alloc(a, (size + a - 1) / a * a));
}
void operator delete(void* p) noexcept
{
  Release(p);
}
void operator delete[](void* p) noexcept
{
  Release(p);
}
void operator delete(void* p, std::size_t) noexcept
{
  Release(p);
}
void operator delete[](void* p, std::size_t) noexcept
{
  Release(p);
}
void operator delete(void* p, std::align_val_t) noexcept
{
  Release(p);
}
void operator delete(void* p, std::size_t, std::align_val_t) noexcept
{
  Release(p);
}

namespace
{
using namespace lacuna;

constexpr int N = 384;

/// A shell of bone in noise; slices of noise make every block mixed, which asks for most.
template <class T>
std::vector<T> Voxels()
{
  std::vector<T> voxels(static_cast<std::size_t>(N) * N * N);
  std::uint32_t random = 1;
  std::size_t i = 0;
  for (int z = 0; z < N; ++z)
  {
    for (int y = 0; y < N; ++y)
    {
      for (int x = 0; x < N; ++x, ++i)
      {
        random = 1664525U * random + 1013904223U;
        const double r = std::hypot(x - 190.0, y - 192.0, z - 195.0);
        voxels[i] =
          static_cast<T>(500 + 100 * (6 - std::abs(r - 150)) / 6 + (random >> 24) - 128.0);
      }
    }
  }
  return voxels;
}

template <class T>
void CheckMemory(ScalarType type, FieldInterpolation interpolation, double coefficients)
{
  const std::vector<T> voxels = Voxels<T>();
  VoxelVolume volume;
  volume.Voxels = voxels.data();
  volume.Type = type;
  volume.Size = { N, N, N };
  ViewSettings view;
  view.Direction = { 0.3, -0.5, -0.8 };
  view.Size = { 512, 512 };
  view.PixelSpacing = 0.8;
  const ImagePlane plane = MakeImagePlane(volume.IndexToWorld, volume.Size, view);
  const std::size_t pixels = 512 * 512;

  // Memory in use that the system has not seen yet must not hide what comes.
  ResetPeakMemory();
  const double residentBefore = GetProcessMemory("VmRSS");
  const std::int64_t before = InUse;
  Peak = before;
  int hits = 0;
  {
    std::vector<double> depth(pixels);
    std::vector<char> valid(pixels);
    std::vector<float> normals(3 * pixels);
    ThreadExecution execution(2);
    const IsoRayCaster caster(volume, interpolation, SolidSide::Above, execution);
    caster.Cast(
      plane, 500, { { 0, 511, 0, 511 }, depth.data(), valid.data(), normals.data() }, execution);
    for (const char v : valid)
    {
      hits += v;
    }
  }
  EXPECT_GT(hits, 50000);
  const double map = pixels * (sizeof(double) + 1 + 3 * sizeof(float));
  const double bytes = 1.0 * sizeof(T) * N * N * N;
  const double allowed = 0.1 * bytes + map + coefficients * N * N * N;
  const double counted = static_cast<double>(Peak - before);
  EXPECT_LE(counted, allowed);
  EXPECT_GT(counted, map) << "nothing was counted";
  const double resident = GetProcessMemory("VmHWM");
  if (!Sanitized && resident > 0)
  {
    // and the stacks of threads and pages of the program that are touched for the first time
    constexpr double pages = 1 << 20;
    EXPECT_LE(resident - residentBefore, allowed + pages);
  }
  std::printf("beyond the volume and the map: %.2f %% counted, %.2f %% by the system\n",
    100 * (counted - map) / bytes, 100 * (resident - residentBefore - map) / bytes);
}
}

TEST(RayCasterMemory, ATenthOfTheVolumeAndTheMap)
{
  CheckMemory<std::int16_t>(ScalarType::Int16, FieldInterpolation::BSpline, 0);
  CheckMemory<std::int16_t>(ScalarType::Int16, FieldInterpolation::Trilinear, 0);
  CheckMemory<float>(ScalarType::Float32, FieldInterpolation::BSpline, 0);
}

TEST(RayCasterMemory, AndTheCoefficientsOfAnInterpolatingSpline)
{
  CheckMemory<std::int16_t>(
    ScalarType::Int16, FieldInterpolation::InterpolatingBSpline, sizeof(float));
}
