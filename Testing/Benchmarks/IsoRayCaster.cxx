// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Times the iso ray caster: the CT head at 500 HU with 512 x 512 rays and normals, and how the
/// time grows with voxels and rays. Reference is the algorithm of Carr 1996, 3.2: rays go from cell
/// to cell, cells without a control point at the threshold are skipped, in the others eight samples
/// of 64 taps are taken and a transition is interpolated linearly.
#include "lacunaIsoRayCaster.h"

#include <benchmark/benchmark.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <limits>
#include <map>
#include <string>
#include <vector>

namespace
{
using namespace lacuna;

struct ShortVolume
{
  std::vector<std::int16_t> Voxels;
  VoxelVolume Volume;
};

/// The number or numbers of a MetaImage header's line.
std::vector<double> HeaderNumbers(const std::string& text, const std::string& key)
{
  std::vector<double> numbers;
  std::size_t at = text.find("\n" + key + " =");
  if (at == std::string::npos)
  {
    return numbers;
  }
  const char* p = text.c_str() + text.find('=', at) + 1;
  for (int i = 0; i < 3; ++i)
  {
    char* end = nullptr;
    numbers.push_back(std::strtod(p, &end));
    p = end;
  }
  return numbers;
}

/// The CT head: a local, compressed MetaImage of short. Empty when it is absent.
const ShortVolume& Head()
{
  static const ShortVolume head = []
  {
    ShortVolume result;
    std::ifstream file(LACUNA_TEST_DATA "/ct_head/head.mha", std::ios::binary);
    const std::string text(
      (std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    const std::string local = "ElementDataFile = LOCAL\n";
    const std::size_t start = text.find(local);
    const auto size = HeaderNumbers(text, "DimSize");
    const auto spacing = HeaderNumbers(text, "ElementSpacing");
    if (start == std::string::npos || size.size() != 3 || spacing.size() != 3)
    {
      return result;
    }
    for (int a = 0; a < 3; ++a)
    {
      result.Volume.Size[a] = static_cast<int>(size[a]);
    }
    result.Volume.IndexToWorld = Matrix4::Scaling({ spacing[0], spacing[1], spacing[2] });
    result.Voxels.resize(result.Volume.NumberOfVoxels());
    uLongf bytes = static_cast<uLongf>(result.Voxels.size() * sizeof(std::int16_t));
    const auto* packed = reinterpret_cast<const Bytef*>(text.data() + start + local.size());
    if (uncompress(reinterpret_cast<Bytef*>(result.Voxels.data()), &bytes, packed,
          static_cast<uLong>(text.size() - start - local.size())) != Z_OK)
    {
      result.Voxels.clear();
    }
    result.Volume.Voxels = result.Voxels.data();
    result.Volume.Type = ScalarType::Int16;
    return result;
  }();
  return head;
}

/// A shell of bone in a cube of 200 mm.
const ShortVolume& Shell(int n)
{
  static std::map<int, ShortVolume> shells;
  ShortVolume& shell = shells[n];
  if (shell.Voxels.empty())
  {
    const double spacing = 200.0 / (n - 1);
    shell.Voxels.reserve(static_cast<std::size_t>(n) * n * n);
    for (int k = 0; k < n; ++k)
    {
      for (int j = 0; j < n; ++j)
      {
        for (int i = 0; i < n; ++i)
        {
          const double r = Norm({ i * spacing - 100, j * spacing - 100, k * spacing - 100 });
          const double inside = 4 - std::abs(r - 80); // mm
          shell.Voxels.push_back(
            static_cast<std::int16_t>(std::min(std::max(500 + 500 * inside, -1000.0), 1500.0)));
        }
      }
    }
    shell.Volume.Voxels = shell.Voxels.data();
    shell.Volume.Type = ScalarType::Int16;
    shell.Volume.Size = { n, n, n };
    shell.Volume.IndexToWorld = Matrix4::Scaling({ spacing, spacing, spacing });
  }
  return shell;
}

struct Map
{
  ImagePlane Plane;
  std::vector<double> Depth;
  std::vector<char> Valid;
  std::vector<float> Normals;

  Map(const VoxelVolume& volume, const Vec3& direction, int rays)
  {
    ViewSettings view;
    view.Direction = direction;
    view.Up = { 0.1, 1, 0.2 };
    view.Size = { rays, rays };
    view.PixelSpacing = 250.0 / rays;
    if (direction[0] == 0)
    {
      view.Up = { 0, 1, 0 };
    }
    this->Plane = MakeImagePlane(volume.IndexToWorld, volume.Size, view);
    const std::size_t n = static_cast<std::size_t>(rays) * rays;
    this->Depth.resize(n);
    this->Valid.resize(n);
    this->Normals.resize(3 * n);
  }

  DepthPixels Pixels()
  {
    return { { 0, this->Plane.Size[0] - 1, 0, this->Plane.Size[1] - 1 }, this->Depth.data(),
      this->Valid.data(), this->Normals.data() };
  }
};

const Vec3 Views[] = { { 0, 0, -1 }, { 0.3, -0.5, -0.8 } };

/// From volume to depth map with nothing prepared.
void Cast(benchmark::State& state, const VoxelVolume& volume, FieldInterpolation interpolation,
  const Vec3& direction, int rays, int threads)
{
  Map map(volume, direction, rays);
  ThreadExecution execution(threads);
  for (auto _ : state)
  {
    const IsoRayCaster caster(volume, interpolation, SolidSide::Above, execution);
    caster.Cast(map.Plane, 500, map.Pixels(), execution);
    benchmark::DoNotOptimize(map.Depth.data());
  }
  state.counters["hits"] = static_cast<double>(std::count(map.Valid.begin(), map.Valid.end(), 1));
}

void CTHead(benchmark::State& state)
{
  if (Head().Voxels.empty())
  {
    state.SkipWithError("no ct_head/head.mha in LACUNA_TEST_DATA");
    return;
  }
  Cast(state, Head().Volume, static_cast<FieldInterpolation>(state.range(0)), Views[state.range(1)],
    512, static_cast<int>(state.range(2)));
}

void ShellOf(benchmark::State& state)
{
  Cast(state, Shell(static_cast<int>(state.range(0))).Volume, FieldInterpolation::BSpline, Views[1],
    static_cast<int>(state.range(1)), static_cast<int>(state.range(2)));
}

/// The thesis's algorithm.
class ReferenceCaster
{
public:
  explicit ReferenceCaster(const VoxelVolume& volume)
    : Voxels(static_cast<const std::int16_t*>(volume.Voxels))
    , Size(volume.Size)
    , WorldToIndex(volume.IndexToWorld.Inverse())
  {
  }

  double Distance(const Vec3& origin, const Vec3& direction, double isoValue, Vec3& normal) const
  {
    const Vec3 a = this->WorldToIndex.Point(origin);
    const Vec3 b = this->WorldToIndex.Vector(direction);
    double t = -1e30;
    double last = 1e30;
    for (int i = 0; i < 3; ++i)
    {
      // the thesis keeps off the border, where support is missing
      const double u = (1 - a[i]) / b[i];
      const double v = (this->Size[i] - 2 - a[i]) / b[i];
      if (b[i] == 0 && (a[i] < 1 || a[i] > this->Size[i] - 2))
      {
        return std::numeric_limits<double>::quiet_NaN();
      }
      if (b[i] != 0)
      {
        t = std::max(t, std::min(u, v));
        last = std::min(last, std::max(u, v));
      }
    }
    double before = -1e30; // outside
    double beforeT = t;
    while (t < last)
    {
      const Vec3 at = a + (t + 1e-9) * b;
      int cell[3];
      double end = last;
      for (int i = 0; i < 3; ++i)
      {
        cell[i] = std::min(std::max(static_cast<int>(std::floor(at[i])), 1), this->Size[i] - 3);
        if (b[i] != 0)
        {
          const double leave = (cell[i] + (b[i] > 0) - a[i]) / b[i];
          end = leave > t + 1e-9 ? std::min(end, leave) : end;
        }
      }
      if (this->Reaches(cell, isoValue))
      {
        for (int sample = 0; sample < 8; ++sample)
        {
          const double s = t + (end - t) * (sample + 1) / 8;
          const double value = this->Value(cell, a + s * b, nullptr);
          if (value >= isoValue && before < isoValue)
          {
            const double hit =
              before < -1e29 ? s : beforeT + (s - beforeT) * (isoValue - before) / (value - before);
            this->Value(cell, a + hit * b, &normal);
            return hit;
          }
          before = value;
          beforeT = s;
        }
      }
      t = end;
    }
    return std::numeric_limits<double>::quiet_NaN();
  }

private:
  const std::int16_t* Corner(const int cell[3]) const
  {
    return this->Voxels + (cell[0] - 1) +
      static_cast<std::int64_t>(this->Size[0]) *
      ((cell[1] - 1) + static_cast<std::int64_t>(this->Size[1]) * (cell[2] - 1));
  }

  bool Reaches(const int cell[3], double isoValue) const
  {
    const std::int16_t* corner = this->Corner(cell);
    for (int k = 0; k < 4; ++k)
    {
      for (int j = 0; j < 4; ++j)
      {
        const std::int16_t* p =
          corner + static_cast<std::int64_t>(this->Size[0]) * (j + this->Size[1] * k);
        if (p[0] >= isoValue || p[1] >= isoValue || p[2] >= isoValue || p[3] >= isoValue)
        {
          return true;
        }
      }
    }
    return false;
  }

  static void Weights(double x, double w[4], double d[4])
  {
    const double y = 1 - x;
    w[0] = y * y * y / 6;
    w[1] = (3 * x * x * x - 6 * x * x + 4) / 6;
    w[3] = x * x * x / 6;
    w[2] = 1 - w[0] - w[1] - w[3];
    d[0] = -0.5 * y * y;
    d[1] = x * (1.5 * x - 2);
    d[2] = 0.5 + x * (1 - 1.5 * x);
    d[3] = 0.5 * x * x;
  }

  double Value(const int cell[3], const Vec3& at, Vec3* normal) const
  {
    double w[3][4];
    double d[3][4];
    for (int i = 0; i < 3; ++i)
    {
      Weights(at[i] - cell[i], w[i], d[i]);
    }
    const std::int16_t* corner = this->Corner(cell);
    double value = 0;
    Vec3 gradient{ 0, 0, 0 };
    for (int k = 0; k < 4; ++k)
    {
      for (int j = 0; j < 4; ++j)
      {
        const std::int16_t* p =
          corner + static_cast<std::int64_t>(this->Size[0]) * (j + this->Size[1] * k);
        const double row = p[0] * w[0][0] + p[1] * w[0][1] + p[2] * w[0][2] + p[3] * w[0][3];
        value += row * w[1][j] * w[2][k];
        if (normal)
        {
          const double slope = p[0] * d[0][0] + p[1] * d[0][1] + p[2] * d[0][2] + p[3] * d[0][3];
          gradient = gradient +
            Vec3{ slope * w[1][j] * w[2][k], row * d[1][j] * w[2][k], row * w[1][j] * d[2][k] };
        }
      }
    }
    if (normal)
    {
      *normal = Normalized(gradient);
    }
    return value;
  }

  const std::int16_t* Voxels;
  std::array<int, 3> Size;
  Matrix4 WorldToIndex;
};

void CTHeadReference(benchmark::State& state)
{
  if (Head().Voxels.empty())
  {
    state.SkipWithError("no ct_head/head.mha in LACUNA_TEST_DATA");
    return;
  }
  Map map(Head().Volume, Views[state.range(0)], 512);
  ThreadExecution execution(static_cast<int>(state.range(1)));
  const ReferenceCaster caster(Head().Volume);
  for (auto _ : state)
  {
    execution.For(512, 4,
      [&](std::int64_t begin, std::int64_t end)
      {
        for (std::int64_t row = begin; row < end; ++row)
        {
          for (int column = 0; column < 512; ++column)
          {
            Vec3 normal{ 0, 0, 0 };
            const double depth = caster.Distance(
              map.Plane.PixelPosition(column, static_cast<int>(row)), map.Plane.View, 500, normal);
            map.Depth[column + 512 * row] = depth;
            map.Valid[column + 512 * row] = !std::isnan(depth);
          }
        }
      });
  }
  state.counters["hits"] = static_cast<double>(std::count(map.Valid.begin(), map.Valid.end(), 1));
}
}

BENCHMARK(CTHead)
  ->ArgNames({ "interpolation", "view", "threads" })
  ->ArgsProduct({ { 0, 1, 2 }, { 0, 1 }, { 1, 2 } })
  ->MeasureProcessCPUTime()
  ->UseRealTime()
  ->Unit(benchmark::kMillisecond);
BENCHMARK(CTHeadReference)
  ->ArgNames({ "view", "threads" })
  ->ArgsProduct({ { 0, 1 }, { 1, 2 } })
  ->MeasureProcessCPUTime()
  ->UseRealTime()
  ->Unit(benchmark::kMillisecond);
BENCHMARK(ShellOf)
  ->Name("Shell")
  ->ArgsProduct({ { 64, 256, 512 }, { 256, 512, 1024, 2048 }, { 2 } })
  ->MeasureProcessCPUTime()
  ->UseRealTime()
  ->Unit(benchmark::kMillisecond);
BENCHMARK_MAIN();
