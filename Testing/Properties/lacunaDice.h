// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Random choices that a seed repeats, on every platform alike.
#ifndef lacunaDice_h
#define lacunaDice_h

#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <random>
#include <vector>

namespace lacunaProperties
{
/// The distributions of the standard library differ from one to the next: these do not.
class Dice
{
public:
  /// stretch: what Length multiplies.
  explicit Dice(std::uint64_t seed, int stretch = 1)
    : Engine(seed)
    , Stretch(stretch)
  {
  }

  std::uint64_t Seed() { return this->Engine(); }
  /// Between lowest and highest, both included.
  int Whole(int lowest, int highest)
  {
    const auto count = static_cast<std::uint64_t>(static_cast<std::int64_t>(highest) - lowest) + 1;
    return static_cast<int>(lowest + static_cast<std::int64_t>(this->Engine() % count));
  }
  /// The same, stretched: how many pixels, slices or points there are along an axis.
  int Length(int lowest, int highest) { return this->Stretch * this->Whole(lowest, highest); }
  double Real(double lowest, double highest)
  {
    const double part = std::ldexp(static_cast<double>(this->Engine() >> 11), -53);
    return lowest + part * (highest - lowest);
  }
  /// Evenly in the logarithm; both above 0.
  double Scale(double lowest, double highest)
  {
    return std::exp(this->Real(std::log(lowest), std::log(highest)));
  }
  bool Chance(double probability) { return this->Real(0, 1) < probability; }
  template <class T>
  T Pick(std::initializer_list<T> list)
  {
    return list.begin()[this->Whole(0, static_cast<int>(list.size()) - 1)];
  }
  template <class T>
  const T& Pick(const std::vector<T>& list)
  {
    return list[static_cast<std::size_t>(this->Whole(0, static_cast<int>(list.size()) - 1))];
  }

private:
  std::mt19937_64 Engine;
  int Stretch;
};
}
#endif
