// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaDefectModel.h"

#include "lacunaDefectModelScene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <stdexcept>
#include <string>

using namespace lacuna;

namespace
{
double Plane(double, double)
{
  return 7;
}

bool HasWarning(const DefectModel& model, const char* words)
{
  return std::any_of(model.Warnings.begin(), model.Warnings.end(),
    [words](const std::string& w) { return w.find(words) != std::string::npos; });
}

std::string GetError(DefectModelScene& scene, const DefectModelOptions& options)
{
  try
  {
    scene.Make(options);
  }
  catch (const std::exception& error)
  {
    return error.what();
  }
  return "";
}
}

// A block with a round pit: what every measure must be.
TEST(DefectModel, PitInAPlane)
{
  PlateScene plate(Plane, [](double x, double y) { return std::hypot(x, y) < 15; });
  for (const DefectFloor floor : { DefectFloor::Flat, DefectFloor::Parallel })
  {
    DefectModelOptions options;
    options.Margin = 10;
    options.Floor = floor;
    options.DefectDepth = 4;
    options.BaseThickness = 3;
    const DefectModel model = DefectModelScene(plate).Make(options);
    EXPECT_EQ(model.Defects, 1);
    EXPECT_DOUBLE_EQ(model.Highest, 7);
    EXPECT_NEAR(model.Base, 11, 1e-9);
    EXPECT_NEAR(model.Bottom, 14, 1e-9);
    const double width = 0.5 * static_cast<double>(model.TopSize.Columns - 1);
    const double height = 0.5 * static_cast<double>(model.TopSize.Rows - 1);
    EXPECT_NEAR(width, 50, 1.01); // up to a pixel more on each side
    const double pit =
      0.25 * static_cast<double>(std::count(plate.Mask.begin(), plate.Mask.end(), 1));
    EXPECT_NEAR(model.Volume, width * height * 7 - pit * 4, 0.004 * pit * 4);
    EXPECT_TRUE(model.Warnings.empty());
    for (std::size_t k = 0; k < model.Top.size(); ++k)
    {
      const bool inside = model.TopFaces[k] == ModelFace::Floor;
      EXPECT_NEAR(model.Top[k], inside ? 11 : 7, 1e-9);
    }
  }
}

// The bone is where it was measured, at every pixel; a parallel floor is at its distance in space.
TEST(DefectModel, BoneAsMeasuredAndFloorParallel)
{
  PlateScene plate(PlateScene::Skull, PlateScene::Kidney);
  DefectModelScene scene(plate);
  for (std::size_t k = 0; k < scene.Scene.MapDepths.size(); ++k)
  {
    scene.Scene.MapDepths[k] += 0.3 * std::sin(0.7 * static_cast<double>(k)); // unlike the fit
  }
  DefectModelOptions options;
  options.Margin = 8;
  options.Floor = DefectFloor::Parallel;
  options.DefectDepth = 5;
  const DefectModel model = scene.Make(options);
  const ReliefSurface surface(plate.Execution, plate.Size, plate.Depths, plate.Spacing);
  int pixels = 0;
  for (std::int64_t j = 0; j < model.TopSize.Rows; ++j)
  {
    for (std::int64_t i = 0; i < model.TopSize.Columns; ++i)
    {
      const std::int64_t k = i + model.TopSize.Columns * j;
      const std::int64_t m = model.Column + i + 161 * (model.Row + j);
      if (model.TopFaces[k] == ModelFace::Bone && !plate.Mask[m])
      {
        EXPECT_EQ(model.Top[k], scene.Scene.MapDepths[m]);
        ++pixels;
      }
      else if (model.TopFaces[k] == ModelFace::Floor && k % 11 == 0)
      {
        // the nearest point of the fit
        const Vec3 p{ 0.5 * static_cast<double>(model.Column + i),
          0.5 * static_cast<double>(model.Row + j), model.Top[k] };
        Vec2 low{ p[0], p[1] };
        double best = 1e9;
        for (double step = 1; step > 1e-4; step /= 3)
        {
          const Vec2 centre = low;
          for (int a = -6; a <= 6; ++a)
          {
            for (int b = -6; b <= 6; ++b)
            {
              const Vec2 q{ centre[0] + a * step, centre[1] + b * step };
              const double d = surface.Contains(q) ? Norm(surface.GetPoint(q) - p) : 1e9;
              if (d < best)
              {
                best = d;
                low = q;
              }
            }
          }
        }
        EXPECT_NEAR(best, 5, 1e-5);
      }
    }
  }
  EXPECT_GT(pixels, 5000);
}

TEST(DefectModel, LostRaysIslandsAndDeepBone)
{
  PlateScene plate(PlateScene::Ball,
    [](double x, double y) {
      return (std::hypot(x, y) < 12 && std::hypot(x - 2, y) > 4) || std::hypot(x - 20, y - 15) < 5;
    });
  DefectModelScene scene(plate);
  const auto pixel = [](double x, double y) {
    return static_cast<std::int64_t>(2 * (x + 40)) + 161 * static_cast<std::int64_t>(2 * (y + 40));
  };
  scene.Scene.MapDepths[pixel(-14, -3)] = std::nan("");
  scene.Scene.MapDepths[pixel(-15, 6)] = std::numeric_limits<double>::infinity();
  DefectModelOptions options;
  const DefectModel model = scene.Make(options);
  EXPECT_EQ(model.Defects, 2);
  EXPECT_TRUE(HasWarning(model, "no bone was measured at"));
  const auto top = [&](double x, double y)
  {
    return model.Top[static_cast<std::int64_t>(2 * (x + 40)) - model.Column +
      model.TopSize.Columns * (static_cast<std::int64_t>(2 * (y + 40)) - model.Row)];
  };
  EXPECT_NEAR(top(-14, -3), model.Base - 0.1, 1e-9);
  EXPECT_NEAR(top(-15, 6), model.Base - 0.1, 1e-9);
  EXPECT_EQ(top(2, 0), PlateScene::Ball(2, 0)); // the island stands
  EXPECT_EQ(top(10, 0), model.Base);
  EXPECT_EQ(top(20, 15), model.Base);

  options.DefectDepth = 2;
  options.MaximumHeight = 11;
  const DefectModel low = scene.Make(options);
  EXPECT_NEAR(low.Base, low.Highest + 11, 1e-9);
  EXPECT_TRUE(HasWarning(low, "cut off"));
  options.MaximumHeight = 5;
  EXPECT_NE(GetError(scene, options).find("MaximumHeight is 5"), std::string::npos);
}

TEST(DefectModel, SameForAnyNumberOfThreads)
{
  DefectModel first;
  for (const int threads : { 1, 2, 5 })
  {
    PlateScene plate(PlateScene::Skull, PlateScene::Kidney, threads);
    DefectModelOptions options;
    options.Floor = DefectFloor::Parallel;
    const DefectModel model = DefectModelScene(plate).Make(options);
    if (threads == 1)
    {
      first = model;
      continue;
    }
    ASSERT_EQ(model.Points.size(), first.Points.size());
    EXPECT_EQ(
      std::memcmp(model.Points.data(), first.Points.data(), first.Points.size() * sizeof(Vec3)), 0);
    EXPECT_EQ(model.Triangles, first.Triangles);
    EXPECT_EQ(model.Top, first.Top);
  }
}

TEST(DefectModel, NamesWhatCannotBeMade)
{
  PlateScene plate(PlateScene::Ball, PlateScene::Disc);
  DefectModelScene scene(plate);
  const auto says = [&](const char* words, const std::function<void(DefectModelOptions&)>& change)
  {
    DefectModelOptions options;
    change(options);
    const std::string error = GetError(scene, options);
    EXPECT_NE(error.find(words), std::string::npos) << "'" << error << "' lacks: " << words;
  };
  using O = DefectModelOptions;
  says("Margin is -1", [](O& o) { o.Margin = -1; });
  says("DefectDepth is 0", [](O& o) { o.DefectDepth = 0; });
  says("BaseThickness is", [](O& o) { o.BaseThickness = std::nan(""); });
  says("DefectDepth is 1e+05 mm; it must be above 0 and at most 1000 mm",
    [](O& o) { o.DefectDepth = 1e5; });
  says("DefectDepth is 1e+300", [](O& o) { o.DefectDepth = 1e300; });
  says("BaseThickness is 1001", [](O& o) { o.BaseThickness = 1001; });
  says("BaseThickness is 1e+300", [](O& o) { o.BaseThickness = 1e300; });
  says("MaximumHeight is -2", [](O& o) { o.MaximumHeight = -2; });
  says("would cut itself at",
    [](O& o)
    {
      o.Floor = DefectFloor::Parallel;
      o.DefectDepth = 61;
    });
  DefectModelOptions wide;
  wide.Margin = 1e300;
  EXPECT_TRUE(HasWarning(scene.Make(wide), "the depth map ends"));

  PlateScene edge(PlateScene::Ball, [](double x, double) { return x < 0; });
  DefectModelScene atBorder(edge);
  EXPECT_NE(GetError(atBorder, {}).find("reaches the border"), std::string::npos);
  PlateScene speck(PlateScene::Ball, [](double x, double y) { return std::hypot(x, y) < 0.3; });
  DefectModelScene tiny(speck);
  EXPECT_NE(GetError(tiny, {}).find("too small"), std::string::npos);
  std::fill(scene.Scene.MapDepths.begin(), scene.Scene.MapDepths.end(), std::nan(""));
  EXPECT_NE(GetError(scene, {}).find("no bone was measured"), std::string::npos);
}
