// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaTissueSpeckle.h"

#include "lacunaCounterNoise.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lacuna
{
namespace
{
constexpr int Bits = 7;
constexpr std::size_t Size = 1 << Bits; // grid points along an axis
constexpr std::size_t Mask = Size - 1;
constexpr double Cell = 0.3; // mm
constexpr int WeightBits = 16;
constexpr float WeightUnit = 1.0F / (1 << WeightBits);
constexpr double Steps = 22; // of Grain in a standard deviation of a Rayleigh distribution
constexpr int Samples = 1 << 16;

// Binomial weights along the axis whose neighbours are stride apart, round the grid.
void Smooth(std::vector<float>& field, int axis)
{
  const std::size_t stride = std::size_t{ 1 } << (axis * Bits);
  std::array<float, Size> line{};
  for (std::size_t first = 0; first < field.size(); ++first)
  {
    if ((first / stride & Mask) != 0)
    {
      continue;
    }
    for (std::size_t i = 0; i < Size; ++i)
    {
      line[i] = field[first + i * stride];
    }
    for (std::size_t i = 0; i < Size; ++i)
    {
      field[first + i * stride] = 6 * line[i] + 4 * (line[(i + 1) & Mask] + line[(i - 1) & Mask]) +
        line[(i + 2) & Mask] + line[(i - 2) & Mask];
    }
  }
}

std::vector<float> MakeField(std::uint64_t seed, std::uint64_t stream)
{
  const CounterNoise noise(seed, stream);
  std::vector<float> field(Size * Size * Size);
  for (std::size_t i = 0; i < field.size(); ++i)
  {
    field[i] = static_cast<float>(noise.Normal(i));
  }
  for (int axis = 0; axis < 3; ++axis)
  {
    Smooth(field, axis);
  }
  return field;
}

// A length as a fraction of the grid's period, in 2^-32.
std::uint32_t Phase(double millimetres)
{
  const double periods = millimetres / (Cell * Size);
  return static_cast<std::uint32_t>(
    static_cast<std::int64_t>(std::ldexp(periods - std::floor(periods), 32)));
}
}

TissueSpeckle::TissueSpeckle(std::uint64_t seed)
  : Grain(Size * Size * Size)
{
  const std::vector<float> real = MakeField(seed, 0);
  const std::vector<float> imaginary = MakeField(seed, 1);
  double sum = 0;
  for (std::size_t i = 0; i < real.size(); ++i)
  {
    sum += std::hypot(real[i], imaginary[i]);
  }
  const double mean = sum / static_cast<double>(real.size());
  const double toGrain = Steps / (0.5227 * mean); // standard deviation by mean of Rayleigh's
  for (std::size_t i = 0; i < real.size(); ++i)
  {
    const double grain = toGrain * (std::hypot(real[i], imaginary[i]) - mean);
    this->Grain[i] = static_cast<std::int8_t>(std::lround(std::clamp(grain, -127.0, 127.0)));
  }
  // between the points it is smoother
  const CounterNoise places(seed, 2);
  double first = 0;
  double second = 0;
  for (int i = 0; i < Samples; ++i)
  {
    std::array<std::uint32_t, 3> place{};
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      place[axis] = static_cast<std::uint32_t>(
        std::ldexp(places.Uniform(3 * static_cast<std::uint64_t>(i) + axis), 32));
    }
    const double grain = this->Find(place[0], place[1], place[2]);
    first += grain / Samples;
    second += grain * grain / Samples;
  }
  this->Mean = first;
  this->Unit = 1 / std::sqrt(second - first * first);
}

float TissueSpeckle::Find(std::uint32_t x, std::uint32_t y, std::uint32_t z) const
{
  const auto index = [](std::uint32_t phase)
  { return static_cast<std::size_t>(phase >> (32 - Bits)); };
  const auto weight = [](std::uint32_t phase)
  {
    return WeightUnit *
      static_cast<float>(
        static_cast<std::int32_t>(phase >> (32 - Bits - WeightBits) & ((1U << WeightBits) - 1)));
  };
  const std::size_t i = index(x);
  const std::size_t nextI = (i + 1) & Mask;
  const std::size_t j[2] = { index(y) << Bits, ((index(y) + 1) & Mask) << Bits };
  const std::size_t k[2] = { index(z) << 2 * Bits, ((index(z) + 1) & Mask) << 2 * Bits };
  const float weightX = weight(x);
  const auto along = [&](std::size_t row)
  {
    const float grain = this->Grain[row | i];
    return grain + weightX * (static_cast<float>(this->Grain[row | nextI]) - grain);
  };
  const float weightY = weight(y);
  const auto across = [&](std::size_t layer)
  {
    const float grain = along(layer | j[0]);
    return grain + weightY * (along(layer | j[1]) - grain);
  };
  const float grain = across(k[0]);
  return grain + weight(z) * (across(k[1]) - grain);
}

double TissueSpeckle::At(const Vec3& point) const
{
  return this->Unit * (this->Find(Phase(point[0]), Phase(point[1]), Phase(point[2])) - this->Mean);
}

void TissueSpeckle::Apply(
  const Vec3& start, const Vec3& step, int count, double strength, double* levels) const
{
  std::uint32_t x = Phase(start[0]);
  std::uint32_t y = Phase(start[1]);
  std::uint32_t z = Phase(start[2]);
  const std::uint32_t stepX = Phase(step[0]);
  const std::uint32_t stepY = Phase(step[1]);
  const std::uint32_t stepZ = Phase(step[2]);
  const double scale = strength * this->Unit;
  const double offset = 1 - scale * this->Mean;
  for (int i = 0; i < count; ++i)
  {
    levels[i] *= std::max(0.0, offset + scale * this->Find(x, y, z));
    x += stepX;
    y += stepY;
    z += stepZ;
  }
}
}
