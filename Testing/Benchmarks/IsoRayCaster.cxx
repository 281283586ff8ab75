// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Times the iso ray caster from volume to depth map: the CT head at 500 HU with 512 x 512 rays and
/// normals, by us, by the thesis's algorithm and by VTK's FlyingEdges3D with a z-buffer; and how the
/// time grows with voxels and rays.
#include "lacunaBenchmark.h"
#include "lacunaCTHead.h"
#include "lacunaIsoRayCaster.h"
#include "lacunaReferenceCaster.h"
#ifdef LACUNA_WITH_FLYING_EDGES
#include "lacunaSurfacePass.h"
#endif

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <vector>

namespace
{
using namespace lacuna;
using lacunaBenchmark::Measure;

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
            const std::int64_t i = column + 512 * row;
            map.Depth[i] = depth;
            map.Valid[i] = !std::isnan(depth);
            for (int a = 0; a < 3; ++a)
            {
              map.Normals[3 * i + a] = static_cast<float>(-normal[a]);
            }
          }
        }
      });
    benchmark::DoNotOptimize(map.Normals.data());
  }
  state.counters["hits"] = static_cast<double>(std::count(map.Valid.begin(), map.Valid.end(), 1));
}

#ifdef LACUNA_WITH_FLYING_EDGES
void CastByTriangles(benchmark::State& state, const VoxelVolume& volume, const Vec3& direction,
  int rays, bool normals, int threads)
{
  Map map(volume, direction, rays);
  SurfacePass pass(volume, normals, threads);
  for (auto _ : state)
  {
    pass.Cast(map.Plane, 500, map.Depth.data(), map.Normals.data());
  }
  state.counters["hits"] = static_cast<double>(std::count_if(
    map.Depth.begin(), map.Depth.end(), [](double depth) { return !std::isnan(depth); }));
  state.counters["triangles"] = static_cast<double>(pass.NumberOfTriangles);
}

void CTHeadFlyingEdges(benchmark::State& state)
{
  if (Head().Voxels.empty())
  {
    state.SkipWithError("no ct_head/head.mha in LACUNA_TEST_DATA");
    return;
  }
  CastByTriangles(state, Head().Volume, Views[state.range(1)], 512, state.range(0) != 0,
    static_cast<int>(state.range(2)));
}

void ShellFlyingEdges(benchmark::State& state)
{
  CastByTriangles(state, Shell(static_cast<int>(state.range(0))).Volume, Views[1],
    static_cast<int>(state.range(1)), true, static_cast<int>(state.range(2)));
}
#endif
}

BENCHMARK(CTHead)
  ->ArgNames({ "interpolation", "view", "threads" })
  ->ArgsProduct({ { 0, 1, 2 }, { 0, 1 }, { 1, 2 } })
  ->Apply(Measure);
BENCHMARK(CTHeadReference)
  ->ArgNames({ "view", "threads" })
  ->ArgsProduct({ { 0, 1 }, { 1, 2 } })
  ->Apply(Measure);
#ifdef LACUNA_WITH_FLYING_EDGES
BENCHMARK(CTHeadFlyingEdges)
  ->ArgNames({ "normals", "view", "threads" })
  ->ArgsProduct({ { 0, 1 }, { 0, 1 }, { 1, 2 } })
  ->Apply(Measure);
BENCHMARK(ShellFlyingEdges)
  ->ArgsProduct({ { 256, 512 }, { 256, 512, 1024, 2048 }, { 2 } })
  ->ArgsProduct({ { 46, 100, 215, 464 }, { 512 }, { 2 } })
  ->ArgsProduct({ { 256 }, { 512 }, { 1, 4 } })
  ->Apply(Measure);
#endif
BENCHMARK(ShellOf)
  ->Name("Shell")
  ->ArgsProduct({ { 64, 256, 512 }, { 256, 512, 1024, 2048 }, { 2 } })
  ->ArgsProduct({ { 46, 100, 215, 464 }, { 512 }, { 2 } })
  ->ArgsProduct({ { 256 }, { 512 }, { 1, 4 } })
  ->Apply(Measure);
BENCHMARK_MAIN();
