// SPDX-License-Identifier: BSD-3-Clause
// What another library says of models of defects, and of plates in them.
#include "lacunaCGALSolid.h"
#include "lacunaDefectModelScene.h"

#include <gtest/gtest.h>

#include <iostream>
#include <random>
#include <stdexcept>
#include <string>

using namespace lacuna;

TEST(DefectModelCGAL, AnyModelIsASolid)
{
  std::mt19937_64 random(610);
  const auto between = [&](double low, double high)
  { return low + (high - low) * static_cast<double>(random() >> 11) / 9007199254740992.0; };
  int made = 0;
  for (int round = 0; round < 25; ++round)
  {
    SCOPED_TRACE("round " + std::to_string(round));
    const double radius = between(1.5, 22);
    const double lobe = between(0, 0.5);
    const double ragged = std::max(0.0, between(-1, 2));
    const double island = between(-3, 4);
    const Vec2 other{ between(-30, 30), between(-30, 30) };
    const double bend[3] = { between(-0.01, 0.03), between(-0.01, 0.03), between(-0.01, 0.01) };
    PlateScene scene([&](double x, double y)
      { return bend[0] * x * x + bend[1] * y * y + bend[2] * x * y; },
      [&](double x, double y)
      {
        const double angle = std::atan2(y, x);
        const double r = radius * (1 + lobe * std::cos(3 * angle)) + ragged * between(-1, 1);
        return (std::hypot(x, y) < std::min(r, 34.0) && std::hypot(x - 2, y) > island) ||
          std::hypot(x - other[0], y - other[1]) < 4;
      });
    DefectModelScene model(scene);
    // noise of the measurement, rays that miss, bone that has sunk
    for (std::size_t k = 0; k < model.Scene.MapDepths.size(); ++k)
    {
      model.Scene.MapDepths[k] += between(-0.2, 0.2);
      const bool lost = random() % 50 == 0 || k % 161 > 130 + 20 * lobe;
      model.Scene.MapDepths[k] = lost ? std::nan("") : model.Scene.MapDepths[k];
    }
    DefectModelOptions options;
    options.Margin = between(0, 25);
    options.Floor = random() % 2 ? DefectFloor::Flat : DefectFloor::Parallel;
    options.DefectDepth = between(0.5, 12);
    options.BaseThickness = between(0.5, 8);
    options.MaximumHeight = random() % 2 ? between(15, 60) : 0;
    try
    {
      CheckSolid(model.Make(options));
      ++made;
    }
    catch (const std::runtime_error& error)
    {
      std::cout << "refused: " << error.what() << "\n";
    }
  }
  EXPECT_GE(made, 18);
}

// The plate of the same map goes into the model: it touches neither bone nor floor nor wall.
TEST(DefectModelCGAL, ThePlateFits)
{
  PlateScene ball(PlateScene::Ball, PlateScene::Disc);
  PlateScene skull(PlateScene::Skull, PlateScene::Kidney);
  for (PlateScene* scene : { &ball, &skull })
  {
    for (const DefectFloor floor : { DefectFloor::Flat, DefectFloor::Parallel })
    {
      ImplantPlateOptions plateOptions;
      plateOptions.EdgeClearance = 0.6;
      const ImplantPlate plate = scene->Make(plateOptions);
      DefectModelOptions options;
      options.Margin = 6;
      options.Floor = floor;
      options.DefectDepth = 3.05;
      const DefectModel model = DefectModelScene(*scene).Make(options);
      EXPECT_FALSE(Intersect(plate, model));
    }
  }
}
