// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// B-scans of bone that is known, for tests.
#ifndef lacunaTestBone_h
#define lacunaTestBone_h

#include "lacunaSliceImage.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <random>
#include <vector>

namespace lacunaTestBone
{
constexpr double None = std::numeric_limits<double>::infinity();

/// A sweep over tissue that gets darker with depth, gel above, bone, and a layer that is as bright and has no shadow.
struct Scan
{
  int Width = 160, Height = 300, Slices = 6;
  double PixelWidth = 0.25, PixelHeight = 0.125; ///< mm
  double SliceStep = 1;                          ///< mm
  double Gain = 1, Offset = 0;
  /// mm of depth at mm across the beams, in a slice; None where there is none. Not symmetric.
  std::function<double(double, int)> Bone = [](double x, int) { return GetArc(x); };
  std::function<double(double)> Layer = [](double x)
  { return x > 28 ? 14 + 0.1 * (x - 28) : None; };
  /// Where beams meet, pixels; with Radii (mm) the scan is a sector, and x is measured along its middle arc.
  std::shared_ptr<const lacuna::FanMask> Fan;
  std::vector<std::vector<unsigned char>> Pixels;

  static double GetArc(double x)
  {
    return x > 9 && x < 25 ? 12 + 0.06 * (x - 14) * (x - 14) : None;
  }

  // x and depth of a pixel, mm
  lacuna::Vec2 GetPlace(int column, int row) const
  {
    if (!this->Fan)
    {
      return { this->PixelWidth * column, this->PixelHeight * row };
    }
    const lacuna::Fan& fan = this->Fan->GetFan();
    const double across = this->PixelWidth * (column - fan.Origin[0]);
    const double down = this->PixelHeight * (row - fan.Origin[1]);
    const double first = fan.Angles[0] * 0.017453292519943295;
    const double middle = 0.5 * (fan.Radii[0] + fan.Radii[1]);
    return { middle * (std::atan2(across, down) - first), std::hypot(across, down) - fan.Radii[0] };
  }

  std::vector<lacuna::SliceImage> Draw()
  {
    std::mt19937 random(7);
    std::vector<lacuna::SliceImage> slices;
    this->Pixels.assign(this->Slices, {});
    for (int k = 0; k < this->Slices; ++k)
    {
      for (int row = 0; row < this->Height; ++row)
      {
        for (int column = 0; column < this->Width; ++column)
        {
          this->Pixels[k].push_back(this->GetLevel(column, row, k, random));
        }
      }
      lacuna::SliceImage slice;
      slice.Pixels = this->Pixels[k].data();
      slice.RowStride = slice.Width = this->Width;
      slice.Height = this->Height;
      slice.PixelToReference = lacuna::Matrix4::Rotation({ 1, 2, 0.5 }, 0.7) *
        lacuna::Matrix4::Translation({ 5, -3, this->SliceStep * k }) *
        lacuna::Matrix4::Scaling({ this->PixelWidth, this->PixelHeight, 1 });
      slice.Fan = this->Fan;
      slice.Label = "slice " + std::to_string(k);
      slices.push_back(slice);
    }
    return slices;
  }

private:
  unsigned char GetLevel(int column, int row, int slice, std::mt19937& random) const
  {
    std::uniform_real_distribution<double> speckle(0.4, 1.6);
    const double noise = speckle(random);
    const lacuna::Vec2 place = this->GetPlace(column, row);
    if (this->Fan && !this->Fan->Contains(column, row))
    {
      return 0;
    }
    const double bone = this->Bone(place[0], slice);
    const double layer = this->Layer(place[0]);
    double level = place[1] < 4 ? 210 : 130 * std::exp(-0.05 * place[1]);
    level += 90 * std::exp(-std::pow((place[1] - layer) / 0.5, 2));
    level *= noise;
    if (place[1] > bone)
    {
      level = 6 * noise * std::exp(-0.1 * (place[1] - bone));
    }
    level += 170 * std::exp(-std::pow((place[1] - bone) / 0.4, 2));
    return static_cast<unsigned char>(std::clamp(this->Gain * level + this->Offset, 0.0, 255.0));
  }
};
}
#endif
