// SPDX-License-Identifier: BSD-3-Clause
// What another library says of plates: closed, outward, without self-intersection.
#include "lacunaCGALSolid.h"
#include "lacunaPlateScene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>
#include <map>
#include <random>
#include <stdexcept>
#include <string>

using namespace lacuna;

TEST(ImplantPlateCGAL, PlatesOfEveryKind)
{
  PlateScene ball(PlateScene::Ball, PlateScene::Disc);
  PlateScene skull(PlateScene::Skull, PlateScene::Kidney);
  for (PlateScene* scene : { &ball, &skull })
  {
    for (const PlateSide side : { PlateSide::Inward, PlateSide::Outward })
    {
      for (const PlateEdge edge : { PlateEdge::Square, PlateEdge::Bevel, PlateEdge::Round })
      {
        ImplantPlateOptions options;
        options.Side = side;
        options.Edge = edge;
        options.EdgeSize = 1.2;
        options.BothFaces = side == PlateSide::Outward;
        options.EdgeClearance = side == PlateSide::Outward ? -3 : 0.5;
        options.TriangleSize = 0.8;
        options.HolePoints = { { 42, 40, 0 }, { 48, 33, 2 } };
        options.Hole.CountersinkDiameter = 4;
        options.DrainageSpacing = 7;
        CheckSolid(scene->Make(options));
      }
    }
  }
}

// The two sides of a slot in the defect meet when the plate grows over the bone between them: no
// width leaves a slit in which the edge cuts itself.
TEST(ImplantPlateCGAL, SlotsThatAnOverlapCloses)
{
  for (int k = 0; k < 10; ++k)
  {
    const double width = 3 + 0.2 * k;
    PlateScene scene(PlateScene::Skull,
      [width](double x, double y)
      { return std::hypot(x, y) < 20 && !(x > 4 && std::abs(y - 0.1 * x) < 0.5 * width); });
    ImplantPlateOptions options;
    options.EdgeClearance = -2;
    options.EdgeSize = 1;
    options.TriangleSize = 0.6;
    CheckSolid(scene.Make(options));
  }
}

// Outlines and surfaces of all kinds give a solid or an error that says why not, never a solid that
// cuts itself.
TEST(ImplantPlateCGAL, RandomOutlines)
{
  std::mt19937_64 random(1996);
  const auto between = [&](double low, double high)
  { return low + (high - low) * static_cast<double>(random() >> 11) / 9007199254740992.0; };
  int made = 0;
  std::map<std::string, int> refused;
  for (int round = 0; round < 50; ++round)
  {
    SCOPED_TRACE("round " + std::to_string(round));
    // lobes around a middle, with a slot, ragged at the edge
    const double size = between(2, 26);
    const double lobes[3] = { between(0, 0.4), between(0, 0.3), between(0, 0.25) };
    const double phases[3] = { between(0, 6), between(0, 6), between(0, 6) };
    const double slot = between(-2, 3);
    const double across = between(-0.5, 0.5);
    const double ragged = std::max(0.0, between(-1, 3));
    const Vec2 middle{ between(-6, 6), between(-6, 6) };
    const double curl[5] = { between(-0.02, 0.024), between(-0.02, 0.024), between(-0.012, 0.012),
      between(-5, 5), between(4, 12) };
    const auto depth = [&](double x, double y)
    {
      return curl[0] * x * x + curl[1] * y * y + curl[2] * x * y +
        curl[3] * std::exp(-((x - 5) * (x - 5) + y * y) / (2 * curl[4] * curl[4]));
    };
    const auto inside = [&](double x, double y)
    {
      const double u = x - middle[0];
      const double v = y - middle[1];
      const double angle = std::atan2(v, u);
      double radius = size;
      for (int k = 0; k < 3; ++k)
      {
        radius *= 1 + lobes[k] * std::cos((k + 2) * angle + phases[k]);
      }
      radius += ragged * between(-1, 1);
      const bool cut = std::abs(v + across * u) < slot && u > 0.2 * size;
      return std::hypot(u, v) < std::min(radius, 30.0) && !cut;
    };
    PlateScene scene(depth, inside);
    ImplantPlateOptions options;
    options.Thickness = between(0.5, 5);
    options.Side = random() % 2 ? PlateSide::Inward : PlateSide::Outward;
    options.Edge = static_cast<PlateEdge>(random() % 3);
    options.EdgeSize = between(0, 0.5) * options.Thickness;
    options.BothFaces = random() % 2;
    options.EdgeClearance = between(-3, 2);
    options.CornerRadius = between(0, 2);
    options.TriangleSize = between(0.3, 1.2);
    options.DrainageSpacing = random() % 2 ? between(5, 9) : 0;
    if (random() % 2)
    {
      options.HolePoints = { { 40 + middle[0], 40 + middle[1], depth(middle[0], middle[1]) } };
      options.Hole.CountersinkDiameter = random() % 2 ? 3 : 0;
    }
    try
    {
      const ImplantPlate plate = scene.Make(options);
      CheckSolid(plate);
      ++made;
    }
    catch (const std::runtime_error& error)
    {
      ++refused[error.what()];
    }
  }
  for (const auto& reason : refused)
  {
    std::cout << reason.second << " refused: " << reason.first << "\n";
  }
  EXPECT_GE(made, 30) << "too many refused";
}
