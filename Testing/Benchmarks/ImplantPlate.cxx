// SPDX-License-Identifier: BSD-3-Clause
// Plates of 60 mm (a disc) on a bent and bumpy surface, triangles of 0.5 mm: from the fitted depths to
// the closed solid with its measures. The goal is 2 s. Arguments: threads, and what is made: 0 a plate
// in the defect, 1 the same with drainage every 8 mm, 2 an overlapping one with four countersunk screw
// holes and drainage. Counters: triangles, MinimumThickness in mm.
#include "lacunaBenchmark.h"
#include "lacunaPlateScene.h"

#include <array>

namespace
{
lacuna::ImplantPlateOptions Options(std::int64_t kind)
{
  lacuna::ImplantPlateOptions options;
  if (kind > 0)
  {
    options.DrainageSpacing = 8;
  }
  if (kind == 2)
  {
    options.Thickness = 1;
    options.Side = lacuna::PlateSide::Outward;
    options.EdgeClearance = -5;
    options.Hole.CountersinkDiameter = 3;
    for (const auto& [x, y] :
      { std::array{ 32.0, 0.0 }, { 0.0, 32.0 }, { -32.0, 0.0 }, { 0.0, -32.0 } })
    {
      options.HolePoints.push_back(
        { PlateScene::Middle + x, PlateScene::Middle + y, PlateScene::Skull(x, y) });
    }
  }
  return options;
}

void Plate(benchmark::State& state)
{
  PlateScene scene(PlateScene::Skull, PlateScene::Disc, static_cast<int>(state.range(0)));
  const lacuna::ImplantPlateOptions options = Options(state.range(1));
  lacuna::ImplantPlate plate;
  for (auto _ : state)
  {
    plate = scene.Make(options);
  }
  state.counters["triangles"] = static_cast<double>(plate.Triangles.size());
  state.counters["thickness"] = plate.MinimumThickness;
}
}

BENCHMARK(Plate)->ArgsProduct({ { 1, 2, 4 }, { 0, 1, 2 } })->Apply(lacunaBenchmark::Measure);
BENCHMARK_MAIN();
