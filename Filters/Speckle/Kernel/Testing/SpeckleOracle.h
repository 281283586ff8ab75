// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The filters as their definitions read, one window at a time, to test the fast ones against.
#ifndef SpeckleOracle_h
#define SpeckleOracle_h

#include "lacunaImageView.h"
#include "lacunaVectorUnit.h"
#include "lacunaWindow.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <ostream>
#include <random>
#include <vector>

namespace oracle
{
using AllTypes = testing::Types<std::int8_t, std::uint8_t, std::int16_t, std::uint16_t,
  std::int32_t, std::uint32_t, std::int64_t, std::uint64_t, float, double>;

/// Those of this machine.
inline std::vector<lacuna::VectorUnit> VectorUnits()
{
  using lacuna::VectorUnit;
  std::vector<VectorUnit> units{ VectorUnit::Baseline };
  for (const VectorUnit unit : { VectorUnit::Avx2, VectorUnit::Avx512 })
  {
    if (unit <= lacuna::BestVectorUnit())
    {
      units.push_back(unit);
    }
  }
  return units;
}

/// Bitwise equality, any NaN equal to any other, -0 equal to 0.
template <class T>
bool Same(T a, T b)
{
  return a == b || (a != a && b != b);
}

template <class T>
struct Image
{
  lacuna::Extent Box;
  std::vector<T> Samples;

  explicit Image(const lacuna::Extent& box)
    : Box(box)
    , Samples(lacuna::NumberOfSamples(box))
  {
  }
  Image(int nx, int ny, int nz)
    : Image(lacuna::Extent{ 0, nx - 1, 0, ny - 1, 0, nz - 1 })
  {
  }

  lacuna::ImageView<const T> View() const
  {
    return lacuna::ImageView<const T>(this->Samples.data(), this->Box);
  }
  lacuna::ImageView<T> View() { return lacuna::ImageView<T>(this->Samples.data(), this->Box); }
  const T& At(int x, int y, int z) const { return *this->View().At(x, y, z); }
  /// The nearest sample.
  const T& Nearest(int x, int y, int z) const
  {
    return this->At(std::clamp(x, this->Box[0], this->Box[1]),
      std::clamp(y, this->Box[2], this->Box[3]), std::clamp(z, this->Box[4], this->Box[5]));
  }
};

/// Random samples of all magnitudes, with many equal ones when few is set.
template <class T>
Image<T> Random(int nx, int ny, int nz, unsigned seed, bool few = false)
{
  Image<T> image(nx, ny, nz);
  std::mt19937_64 generator(seed);
  for (T& sample : image.Samples)
  {
    const std::uint64_t bits = generator();
    if (few)
    {
      sample = static_cast<T>(bits % 7);
    }
    else if constexpr (std::is_floating_point_v<T>)
    {
      const int exponent = static_cast<int>(bits % 9) - 4;
      sample = static_cast<T>(
        std::ldexp(static_cast<double>(static_cast<std::int64_t>(generator())), exponent - 60));
    }
    else
    {
      sample = static_cast<T>(bits >> 7);
    }
  }
  return image;
}

template <class T>
void SprinkleNaN(Image<T>& image, unsigned one_in)
{
  std::mt19937 generator(5);
  for (T& sample : image.Samples)
  {
    if (generator() % one_in == 0)
    {
      sample = std::numeric_limits<T>::quiet_NaN();
    }
  }
}

/// A sample of a window and where it lies.
template <class T>
struct Neighbour
{
  T Value;
  int X, Y, Z; ///< from the centre
};

/// Offsets of a window, as its definition reads.
inline std::vector<std::array<int, 3>> Offsets(const lacuna::Window& window)
{
  std::vector<std::array<int, 3>> offsets;
  for (int c = 0; c < window.GetSize(2); ++c)
  {
    for (int b = 0; b < window.GetSize(1); ++b)
    {
      for (int a = 0; a < window.GetSize(0); ++a)
      {
        const double u = (a - (window.GetSize(0) - 1) / 2.0) / (window.GetSize(0) / 2.0);
        const double v = (b - (window.GetSize(1) - 1) / 2.0) / (window.GetSize(1) / 2.0);
        const double w = (c - (window.GetSize(2) - 1) / 2.0) / (window.GetSize(2) / 2.0);
        if (window.IsBox() || u * u + v * v + w * w <= 1 + 1e-12)
        {
          offsets.push_back({ a - window.Lower(0), b - window.Lower(1), c - window.Lower(2) });
        }
      }
    }
  }
  return offsets;
}

/// result = rule(numbers of the window, centre) at each sample that is a number.
template <class T, class Rule>
Image<T> Filter(const Image<T>& image, const lacuna::Window& window, const Rule& rule)
{
  const auto offsets = Offsets(window);
  std::vector<Neighbour<T>> samples;
  Image<T> result(image.Box);
  for (int z = image.Box[4]; z <= image.Box[5]; ++z)
  {
    for (int y = image.Box[2]; y <= image.Box[3]; ++y)
    {
      for (int x = image.Box[0]; x <= image.Box[1]; ++x)
      {
        samples.clear();
        for (const auto& [dx, dy, dz] : offsets)
        {
          const T value = image.Nearest(x + dx, y + dy, z + dz);
          if (value == value)
          {
            samples.push_back({ value, dx, dy, dz });
          }
        }
        const T centre = image.At(x, y, z);
        *result.View().At(x, y, z) = centre == centre ? rule(samples, centre) : centre;
      }
    }
  }
  return result;
}

template <class T>
std::vector<T> SortedValues(const std::vector<Neighbour<T>>& window)
{
  std::vector<T> values;
  for (const auto& n : window)
  {
    values.push_back(n.Value);
  }
  std::sort(values.begin(), values.end());
  return values;
}

template <class T>
Image<T> Rank(const Image<T>& image, const lacuna::Window& window, double percentile)
{
  return Filter(image, window,
    [=](const auto& samples, T)
    {
      std::vector<T> v;
      for (const auto& n : samples)
      {
        v.push_back(n.Value);
      }
      const auto rank = static_cast<std::size_t>(double(v.size()) * percentile / 100);
      const std::size_t k = std::min(v.size() - 1, rank);
      std::nth_element(v.begin(), v.begin() + k, v.end());
      return v[k];
    });
}

template <class T>
Image<T> Mode(const Image<T>& image, const lacuna::Window& window)
{
  return Filter(image, window,
    [](const auto& samples, T)
    {
      std::vector<T> v = SortedValues(samples);
      const long double a = v.front();
      const long double b = v.back();
      const long double m = v[v.size() / 2];
      if (m - a != b - m)
      {
        const bool upper = m - a < b - m;
        std::vector<T> kept;
        for (const T s : v)
        {
          if (upper ? s <= 2 * m - a : s >= 2 * m - b)
          {
            kept.push_back(s);
          }
        }
        v.swap(kept);
      }
      return v[v.size() / 2];
    });
}

template <class T>
Image<T> Adaptive(const Image<T>& image, const lacuna::Window& window, double strength)
{
  return Filter(image, window,
    [=](const auto& samples, T centre)
    {
      double n = 0, sum = 0, squares = 0;
      for (const auto& s : samples)
      {
        const double d = static_cast<double>(s.Value) - static_cast<double>(centre);
        n += 1;
        sum += d;
        squares += d * d;
      }
      const double mean = static_cast<double>(centre) + sum / n;
      const double variance = std::max(0.0, (squares - sum * sum / n) / n);
      if (variance > 0 && strength > 0 && mean == 0)
      {
        return centre;
      }
      const double slope = variance > 0 && strength > 0 ? strength * variance / std::abs(mean) : 0;
      std::vector<std::pair<T, std::int64_t>> weighted;
      std::int64_t total = 0;
      for (const auto& s : samples)
      {
        const double d = std::sqrt(double(s.X * s.X + s.Y * s.Y + s.Z * s.Z));
        const auto w = static_cast<std::int64_t>(std::max(0.0, std::floor(99 - slope * d + 0.5)));
        weighted.push_back({ s.Value, w });
        total += w;
      }
      std::sort(weighted.begin(), weighted.end());
      std::int64_t running = 0;
      for (const auto& w : weighted)
      {
        running += w.second;
        if (running > total / 2)
        {
          return w.first;
        }
      }
      return centre;
    });
}

/// The number of samples that differ.
template <class T>
std::size_t Differences(const Image<T>& a, const Image<T>& b)
{
  std::size_t n = a.Samples.size() == b.Samples.size() ? 0 : 1;
  for (std::size_t i = 0; i < std::min(a.Samples.size(), b.Samples.size()); ++i)
  {
    n += !Same(a.Samples[i], b.Samples[i]);
  }
  return n;
}
}
#endif
