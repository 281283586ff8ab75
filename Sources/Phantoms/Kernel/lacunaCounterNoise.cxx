// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaCounterNoise.h"

#include <cmath>

namespace lacuna
{
namespace
{
constexpr std::uint64_t Golden = 0x9e3779b97f4a7c15ull;

std::uint64_t Mix(std::uint64_t z)
{
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
  return z ^ (z >> 31);
}

double Ratio(const double (&n)[8], const double (&d)[8], double x)
{
  double top = n[7];
  double bottom = d[7];
  for (int i = 6; i >= 0; --i)
  {
    top = top * x + n[i];
    bottom = bottom * x + d[i];
  }
  return top / bottom;
}

// Coefficients of AS 241 for |p - 1/2| <= 0.425, for the tails, and for the far tails.
constexpr double A[8] = { 3.3871328727963666080e0, 1.3314166789178437745e2, 1.9715909503065514427e3,
  1.3731693765509461125e4, 4.5921953931549871457e4, 6.7265770927008700853e4,
  3.3430575583588128105e4, 2.5090809287301226727e3 };
constexpr double B[8] = { 1, 4.2313330701600911252e1, 6.8718700749205790830e2,
  5.3941960214247511077e3, 2.1213794301586595867e4, 3.9307895800092710610e4,
  2.8729085735721942674e4, 5.2264952788528545610e3 };
constexpr double C[8] = { 1.42343711074968357734e0, 4.63033784615654529590e0,
  5.76949722146069140550e0, 3.64784832476320460504e0, 1.27045825245236838258e0,
  2.41780725177450611770e-1, 2.27238449892691845833e-2, 7.74545014278341407640e-4 };
constexpr double D[8] = { 1, 2.05319162663775882187e0, 1.67638483018380384940e0,
  6.89767334985100004550e-1, 1.48103976427480074590e-1, 1.51986665636164571966e-2,
  5.47593808499534494600e-4, 1.05075007164441684324e-9 };
constexpr double E[8] = { 6.65790464350110377720e0, 5.46378491116411436990e0,
  1.78482653991729133580e0, 2.96560571828504891230e-1, 2.65321895265761230930e-2,
  1.24266094738807843860e-3, 2.71155556874348757815e-5, 2.01033439929228813265e-7 };
constexpr double F[8] = { 1, 5.99832206555887937690e-1, 1.36929880922735805310e-1,
  1.48753612908506148525e-2, 7.86869131145613259100e-4, 1.84631831751005468180e-5,
  1.42151175831644588870e-7, 2.04426310338993978564e-15 };
}

double NormalQuantile(double p)
{
  const double q = p - 0.5;
  if (std::abs(q) <= 0.425)
  {
    return q * Ratio(A, B, 0.180625 - q * q);
  }
  const double r = std::sqrt(-std::log(q < 0 ? p : 1 - p));
  const double x = r <= 5 ? Ratio(C, D, r - 1.6) : Ratio(E, F, r - 5);
  return q < 0 ? -x : x;
}

CounterNoise::CounterNoise(std::uint64_t seed, std::uint64_t stream)
  : Key(Mix(Mix(seed + Golden) + stream * Golden))
{
}

double CounterNoise::Uniform(std::uint64_t counter) const
{
  const std::uint64_t bits = Mix(this->Key ^ Mix((counter + 1) * Golden)) >> 11;
  return (static_cast<double>(bits) + 0.5) * 0x1p-53;
}

double CounterNoise::Normal(std::uint64_t counter) const
{
  return NormalQuantile(this->Uniform(counter));
}
}
