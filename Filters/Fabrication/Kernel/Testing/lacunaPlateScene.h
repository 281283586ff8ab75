// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Depth fields and defects for tests of plates.
#ifndef lacunaPlateScene_h
#define lacunaPlateScene_h

#include "lacunaExecution.h"
#include "lacunaImplantPlate.h"

#include <cmath>
#include <functional>

/// A square depth field of 80 mm with the defect inside(x, y); x = y = 0 is its middle.
struct PlateScene
{
  static constexpr int Count = 161;
  static constexpr double Pixel = 0.5;
  static constexpr double Middle = 40;

  lacuna::ThreadExecution Execution;
  lacuna::GridSize Size{ Count, Count };
  lacuna::Vec2 Spacing{ Pixel, Pixel };
  std::vector<double> Depths;
  std::vector<unsigned char> Mask;

  PlateScene(const std::function<double(double, double)>& depth,
    const std::function<bool(double, double)>& inside, int threads = 0)
    : Execution(threads)
  {
    for (int j = 0; j < Count; ++j)
    {
      for (int i = 0; i < Count; ++i)
      {
        this->Depths.push_back(depth(i * Pixel - Middle, j * Pixel - Middle));
        this->Mask.push_back(inside(i * Pixel - Middle, j * Pixel - Middle));
      }
    }
  }

  lacuna::ImplantPlate Make(const lacuna::ImplantPlateOptions& options)
  {
    const lacuna::ReliefSurface surface(this->Execution, this->Size, this->Depths, this->Spacing);
    return lacuna::MakeImplantPlate(
      this->Execution, surface, this->Size, this->Spacing, this->Mask, options);
  }

  static double Ball(double x, double y) { return 60 - std::sqrt(3600 - x * x - y * y); }
  static bool Disc(double x, double y) { return std::hypot(x, y) <= 30; }
  /// Neither symmetric nor convex, with bends and bumps on both sides.
  static double Skull(double x, double y)
  {
    return 0.006 * x * x + 0.004 * y * y + 0.003 * x * y +
      2 * std::exp(-((x - 12) * (x - 12) + (y + 7) * (y + 7)) / 200);
  }
  static bool Kidney(double x, double y)
  {
    return std::hypot(x / 1.3, y - 3) < 20 && std::hypot(x - 8, y - 28) > 15 &&
      !(x < -18 && y < -2);
  }
};
#endif
