// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The plane of a reflection, and how alike two sets of values are.
#ifndef lacunaMirrorPlane_h
#define lacunaMirrorPlane_h

#include "lacunaExecution.h"
#include "lacunaVector.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace lacuna
{
/// The points x with Normal . x = Offset. Normal and -Normal (with -Offset) are the same plane.
struct MirrorPlane
{
  Vec3 Normal{ 1, 0, 0 }; ///< unit
  double Offset = 0;      ///< mm

  double Distance(const Vec3& x) const { return Dot(this->Normal, x) - this->Offset; }
  Vec3 Reflect(const Vec3& x) const { return x - (2 * this->Distance(x)) * this->Normal; }
  Vec3 ReflectDirection(const Vec3& v) const
  {
    return v - (2 * Dot(this->Normal, v)) * this->Normal;
  }
};

/// Adds what body(begin, end) returns over blocks of a range, in their order: the sum does not depend
/// on who worked on which block. Sum has a default value and +=.
template <class Sum, class Body>
Sum SumOverBlocks(Execution& execution, std::int64_t count, std::int64_t block, const Body& body)
{
  std::vector<Sum> parts(static_cast<std::size_t>((count + block - 1) / block));
  execution.For(static_cast<std::int64_t>(parts.size()), 1,
    [&](std::int64_t first, std::int64_t last)
    {
      for (std::int64_t b = first; b < last; ++b)
      {
        parts[b] = body(b * block, std::min(count, (b + 1) * block));
      }
    });
  Sum sum{};
  for (const Sum& part : parts)
  {
    sum += part;
  }
  return sum;
}

/// Lin's concordance correlation coefficient of pairs (a, b): 1 - mean (a - b)^2 / (var a + var b +
/// (mean a - mean b)^2). 1: all pairs are equal, 0: they have nothing to do with one another, -1:
/// a = -b.
/// Lin, A concordance correlation coefficient to evaluate reproducibility, Biometrics 45, 1989.
class Concordance
{
public:
  /// origin: a number amid the values, so that no digits are lost.
  explicit Concordance(double origin = 0)
    : Origin(origin)
  {
  }
  void Add(double a, double b)
  {
    const double x = a - this->Origin;
    const double y = b - this->Origin;
    this->Count += 1;
    this->A += x;
    this->B += y;
    this->Squares += x * x + y * y;
    this->Differences += (x - y) * (x - y);
  }
  Concordance& operator+=(const Concordance& other)
  {
    this->Origin = other.Origin; // the same in all parts of a sum
    this->Count += other.Count;
    this->A += other.A;
    this->B += other.B;
    this->Squares += other.Squares;
    this->Differences += other.Differences;
    return *this;
  }
  double GetCount() const { return this->Count; }
  /// NaN when there is no pair, or all values are equal.
  double GetScore() const
  {
    // var a + var b + (<a> - <b>)^2 = <a^2> + <b^2> - 2 <a> <b>
    const double spread = this->Squares - 2 * this->A * this->B / this->Count;
    return spread > 1e-12 * this->Squares && this->Count > 0
      ? 1 - this->Differences / spread
      : std::numeric_limits<double>::quiet_NaN();
  }
  /// NaN when there is no pair.
  double GetRMS() const { return std::sqrt(this->Differences / this->Count); }

private:
  double Origin;
  double Count = 0;
  double A = 0;
  double B = 0;
  double Squares = 0;
  double Differences = 0;
};
}
#endif
