// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaBeamGrid.h"

#include "lacunaGreyImage.h"

#include <algorithm>
#include <cmath>

namespace lacuna
{
namespace
{
constexpr double Degree = 0.017453292519943295;
constexpr double Rounding = 1e-9; // of positions, pixels
constexpr double Reach = 3;       // of a Gaussian, standard deviations

// Half of a Gaussian's weights from its middle on; the sum of all is 1.
std::vector<float> GetWeights(double sigma)
{
  std::vector<float> weights{ 1 };
  double sum = 1;
  for (int i = 1; i <= Reach * sigma; ++i)
  {
    const double weight = std::exp(-0.5 * i * i / (sigma * sigma));
    weights.push_back(static_cast<float>(weight));
    sum += 2 * weight;
  }
  for (float& weight : weights)
  {
    weight = static_cast<float>(weight / sum);
  }
  return weights;
}
}

BeamGrid::BeamGrid(const SliceImage& slice)
  : Spacing{ Norm(slice.PixelToReference.Column(0)), Norm(slice.PixelToReference.Column(1)) }
  , Width(slice.Width)
  , Height(slice.Height)
{
  if (slice.Fan)
  {
    this->Sector = slice.Fan->GetFan();
    this->SampleStep = std::min(this->Spacing[0], this->Spacing[1]);
    const double length = this->Sector.Radii[1] - this->Sector.Radii[0];
    // no more of either than the window has pixels: a given fan may be far larger
    const double most = 2.0 * (this->Width + this->Height);
    this->SampleStep = std::max(this->SampleStep, length / most);
    this->Samples = static_cast<int>(length / this->SampleStep) + 1;
    const double middle = 0.5 * (this->Sector.Radii[0] + this->Sector.Radii[1]);
    const double opening = Degree * (this->Sector.Angles[1] - this->Sector.Angles[0]);
    this->Beams =
      1 + static_cast<int>(std::clamp(std::ceil(opening * middle / this->SampleStep), 1.0, most));
    this->AngleStep = opening / (this->Beams - 1);
  }
  else
  {
    this->SampleStep = this->Spacing[1];
    this->Beams = this->Width;
    this->Samples = this->Height;
  }
  for (int beam = 0; beam < this->Beams; ++beam)
  {
    int begin = this->Samples, end = 0;
    for (int sample = 0; sample < this->Samples; ++sample)
    {
      const Vec2 pixel = this->GetPixel(beam, sample);
      if (pixel[0] >= -Rounding && pixel[0] <= this->Width - 1 + Rounding &&
        pixel[1] >= -Rounding && pixel[1] <= this->Height - 1 + Rounding)
      {
        begin = std::min(begin, sample);
        end = sample + 1;
      }
    }
    this->Begins.push_back(std::min(begin, end));
    this->Ends.push_back(end);
    this->IsWhole = this->IsWhole && begin == 0 && end == this->Samples;
  }
}

double BeamGrid::GetBeamStep(double sample) const
{
  return this->AngleStep > 0 ? this->AngleStep * (this->Sector.Radii[0] + this->SampleStep * sample)
                             : this->Spacing[0];
}

Vec2 BeamGrid::GetPixel(int beam, double sample) const
{
  if (this->AngleStep == 0)
  {
    return { static_cast<double>(beam), sample };
  }
  const double angle = Degree * this->Sector.Angles[0] + this->AngleStep * beam;
  const double radius = this->Sector.Radii[0] + this->SampleStep * sample;
  return { this->Sector.Origin[0] + radius * std::sin(angle) / this->Spacing[0],
    this->Sector.Origin[1] + radius * std::cos(angle) / this->Spacing[1] };
}

Vec2 BeamGrid::Find(double column, double row) const
{
  if (this->AngleStep == 0)
  {
    return { column, row };
  }
  const double x = this->Spacing[0] * (column - this->Sector.Origin[0]);
  const double y = this->Spacing[1] * (row - this->Sector.Origin[1]);
  const double first = Degree * this->Sector.Angles[0];
  const double last = first + this->AngleStep * (this->Beams - 1);
  // the turn of the angle that is nearest to the middle beam
  const double middle = 0.5 * (first + last);
  const double angle = middle + std::remainder(std::atan2(x, y) - middle, 360 * Degree);
  return { (angle - first) / this->AngleStep,
    (std::hypot(x, y) - this->Sector.Radii[0]) / this->SampleStep };
}

std::vector<float> BeamGrid::Sample(const SliceImage& slice) const
{
  const std::vector<float> levels =
    GetLevels({ slice.Type, slice.Pixels, slice.RowStride, slice.Width, slice.Height });
  const auto level = [&](int column, int row)
  {
    return levels[static_cast<std::size_t>(row) * static_cast<std::size_t>(this->Width) +
      static_cast<std::size_t>(column)];
  };
  std::vector<float> values(this->GetSize(), 0);
  auto value = values.begin();
  for (int beam = 0; beam < this->Beams; ++beam)
  {
    for (int sample = 0; sample < this->Samples; ++sample, ++value)
    {
      if (sample < this->Begins[beam] || sample >= this->Ends[beam])
      {
        continue;
      }
      if (this->AngleStep == 0)
      {
        *value = level(beam, sample);
        continue;
      }
      const Vec2 pixel = this->GetPixel(beam, sample);
      const double x = std::clamp(pixel[0], 0.0, this->Width - 1.0);
      const double y = std::clamp(pixel[1], 0.0, this->Height - 1.0);
      const int column = std::min(static_cast<int>(x), this->Width - 2);
      const int row = std::min(static_cast<int>(y), this->Height - 2);
      const auto right = static_cast<float>(x - column);
      const auto down = static_cast<float>(y - row);
      *value = (1 - down) * ((1 - right) * level(column, row) + right * level(column + 1, row)) +
        down * ((1 - right) * level(column, row + 1) + right * level(column + 1, row + 1));
    }
  }
  return values;
}

void BeamGrid::Smooth(std::vector<float>& values, double along, double across) const
{
  std::vector<float> weights(values.size(), 0);
  for (int beam = 0; beam < this->Beams; ++beam)
  {
    const auto first = weights.begin() + static_cast<std::ptrdiff_t>(beam) * this->Samples;
    std::fill(first + this->Begins[beam], first + this->Ends[beam], 1.0f);
  }
  this->Convolve(values, along, across);
  this->Convolve(weights, along, across);
  for (std::size_t i = 0; i < values.size(); ++i)
  {
    values[i] = weights[i] > 0 ? values[i] / weights[i] : 0;
  }
}

// What is outside of the grid is 0.
void BeamGrid::Convolve(std::vector<float>& values, double along, double across) const
{
  const std::vector<float> alongWeights = GetWeights(along / this->SampleStep);
  const std::vector<float> acrossWeights = GetWeights(across / this->GetBeamStep());
  std::vector<float> sums(values.size());
  const auto add = [](const std::vector<float>& from, std::ptrdiff_t begin, std::ptrdiff_t end,
                     std::ptrdiff_t offset, float weight, std::vector<float>& to)
  {
    for (std::ptrdiff_t i = begin; i < end; ++i)
    {
      to[i] += weight * from[i + offset];
    }
  };
  // whole beams at a time: what is added to a sample comes in the same order always
  const std::ptrdiff_t samples = this->Samples;
  for (std::ptrdiff_t beam = 0; beam < this->Beams; ++beam)
  {
    const std::ptrdiff_t first = beam * samples;
    for (std::ptrdiff_t k = 0; k < static_cast<std::ptrdiff_t>(alongWeights.size()); ++k)
    {
      const std::ptrdiff_t reach = std::min(k, samples);
      add(values, first, first + samples - reach, k, alongWeights[k], sums);
      if (k > 0)
      {
        add(values, first + reach, first + samples, -k, alongWeights[k], sums);
      }
    }
  }
  std::fill(values.begin(), values.end(), 0.0f);
  for (std::ptrdiff_t beam = 0; beam < this->Beams; ++beam)
  {
    for (std::ptrdiff_t k = 0; k < static_cast<std::ptrdiff_t>(acrossWeights.size()); ++k)
    {
      for (const std::ptrdiff_t other : { beam + k, beam - k })
      {
        if (other >= 0 && other < this->Beams && (k > 0 || other == beam))
        {
          add(sums, beam * samples, (beam + 1) * samples, (other - beam) * samples,
            acrossWeights[k], values);
        }
        if (k == 0)
        {
          break;
        }
      }
    }
  }
}
}
