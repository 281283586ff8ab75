// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaRadialSum.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace
{
constexpr std::size_t Block = lacuna::RadialBlock;
constexpr lacuna::RadialKernel Kernels[] = { lacuna::RadialKernel::ThinPlate,
  lacuna::RadialKernel::Linear, lacuna::RadialKernel::Triharmonic, lacuna::RadialKernel::Cubic,
  lacuna::RadialKernel::Gaussian, lacuna::RadialKernel::Multiquadric,
  lacuna::RadialKernel::Wendland };

std::vector<lacuna::InstructionSet> AvailableSets()
{
  std::vector<lacuna::InstructionSet> sets;
  for (int s = 0; s <= static_cast<int>(lacuna::BestInstructionSet()); ++s)
  {
    sets.push_back(static_cast<lacuna::InstructionSet>(s));
  }
  return sets;
}

double Phi(lacuna::RadialKernel kernel, double r)
{
  switch (kernel)
  {
    case lacuna::RadialKernel::ThinPlate:
      return r > 0 ? r * r * std::log(r) : 0;
    case lacuna::RadialKernel::Linear:
      return -r;
    case lacuna::RadialKernel::Triharmonic:
      return r > 0 ? -r * r * r * r * std::log(r) : 0;
    case lacuna::RadialKernel::Cubic:
      return r * r * r;
    case lacuna::RadialKernel::Gaussian:
      return std::exp(-r * r);
    case lacuna::RadialKernel::Wendland:
      return r < 1 ? std::pow(1 - r, 4) * (4 * r + 1) : 0;
    default:
      return -std::sqrt(1 + r * r);
  }
}

double PhiPrime(lacuna::RadialKernel kernel, double r)
{
  switch (kernel)
  {
    case lacuna::RadialKernel::ThinPlate:
      return r > 0 ? 2 * r * std::log(r) + r : 0;
    case lacuna::RadialKernel::Linear:
      return r > 0 ? -1 : 0;
    case lacuna::RadialKernel::Triharmonic:
      return r > 0 ? -4 * r * r * r * std::log(r) - r * r * r : 0;
    case lacuna::RadialKernel::Cubic:
      return 3 * r * r;
    case lacuna::RadialKernel::Gaussian:
      return -2 * r * std::exp(-r * r);
    case lacuna::RadialKernel::Wendland:
      return r < 1 ? -20 * r * std::pow(1 - r, 3) : 0;
    default:
      return -r / std::sqrt(1 + r * r);
  }
}

template <int Dimension>
struct Cloud
{
  std::array<std::vector<double>, Dimension> Axis;

  Cloud(std::size_t count, unsigned seed)
  {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (auto& axis : this->Axis)
    {
      for (std::size_t i = 0; i < count; ++i)
      {
        axis.push_back(uniform(random));
      }
    }
  }
  lacuna::Coordinates<Dimension> Get() const
  {
    lacuna::Coordinates<Dimension> coordinates;
    for (int c = 0; c < Dimension; ++c)
    {
      coordinates.Axis[c] = this->Axis[c].data();
    }
    return coordinates;
  }
};

template <int Dimension>
void CompareWithPlainSum()
{
  constexpr std::size_t n = 101;
  const Cloud<Dimension> nodes(n, 1);
  Cloud<Dimension> points(Block, 2);
  for (int c = 0; c < Dimension; ++c)
  {
    points.Axis[c][3] = nodes.Axis[c][7]; // on a node
  }
  std::vector<double> weights(n);
  for (std::size_t i = 0; i < n; ++i)
  {
    weights[i] = std::sin(1.0 + 3.0 * i);
  }
  for (const lacuna::RadialKernel kernel : Kernels)
  {
    std::vector<double> first;
    for (const lacuna::InstructionSet set : AvailableSets())
    {
      const auto loops = lacuna::GetRadialLoops<Dimension>(kernel, set);
      std::vector<double> all(Block * (2 + Dimension));
      double* withGradient = all.data() + Block;
      double* gradients = withGradient + Block;
      loops.Sum(nodes.Get(), weights.data(), n, points.Get(), all.data());
      loops.SumAndGradient(nodes.Get(), weights.data(), n, points.Get(), withGradient, gradients);
      for (std::size_t p = 0; p < Block; ++p)
      {
        double sum = 0;
        std::array<double, Dimension> gradient{};
        for (std::size_t i = 0; i < n; ++i)
        {
          double r2 = 0;
          std::array<double, Dimension> d;
          for (int c = 0; c < Dimension; ++c)
          {
            d[c] = points.Axis[c][p] - nodes.Axis[c][i];
            r2 += d[c] * d[c];
          }
          const double r = std::sqrt(r2);
          sum += weights[i] * Phi(kernel, r);
          for (int c = 0; c < Dimension; ++c)
          {
            gradient[c] += r > 0 ? weights[i] * PhiPrime(kernel, r) * d[c] / r : 0;
          }
        }
        EXPECT_NEAR(all[p], sum, 1e-13 * n);
        EXPECT_EQ(withGradient[p], all[p]);
        for (int c = 0; c < Dimension; ++c)
        {
          EXPECT_NEAR(gradients[c * Block + p], gradient[c], 1e-12 * n);
        }
      }
      // The same bits whatever the instruction set.
      first = first.empty() ? all : first;
      EXPECT_EQ(all, first) << "kernel " << static_cast<int>(kernel) << " set "
                            << static_cast<int>(set);
    }
  }
}
}

TEST(RadialSum, AgreesWithAPlainSumIn2D)
{
  CompareWithPlainSum<2>();
}

TEST(RadialSum, AgreesWithAPlainSumIn3D)
{
  CompareWithPlainSum<3>();
}

TEST(RadialSum, ThinPlateIsAccurateToAFewUlps)
{
  // Distances over the whole range that scaled nodes and far points can have.
  std::vector<double> x;
  for (double r = 1e-150; r < 1e150; r *= 1.003)
  {
    x.push_back(r);
  }
  for (int k = -2000; k <= 2000; ++k)
  {
    x.push_back(1 + k * 1e-6); // where the logarithm goes through 0
  }
  const std::vector<double> zero(x.size(), 0.0);
  const double center[2] = { 0, 0 };
  std::vector<double> phi(x.size());
  for (const lacuna::InstructionSet set : AvailableSets())
  {
    lacuna::GetRadialLoops<2>(lacuna::RadialKernel::ThinPlate, set)
      .Column({ { x.data(), zero.data() } }, x.size(), center, phi.data());
    for (std::size_t i = 0; i < x.size(); ++i)
    {
      // what the square rounds to, exactly evaluated
      const long double r2 = x[i] * x[i];
      const long double exact = 0.5L * r2 * std::log(r2);
      EXPECT_NEAR(phi[i], static_cast<double>(exact),
        4 * std::numeric_limits<double>::epsilon() * std::abs(static_cast<double>(exact)))
        << x[i];
    }
  }
}

TEST(RadialSum, GaussianIsAccurateToAFewUlps)
{
  std::vector<double> x;
  for (double r = 1e-9; r < 60; r *= 1.003)
  {
    x.push_back(r);
  }
  const std::vector<double> zero(x.size(), 0.0);
  const double center[2] = { 0, 0 };
  std::vector<double> phi(x.size());
  for (const lacuna::InstructionSet set : AvailableSets())
  {
    lacuna::GetRadialLoops<2>(lacuna::RadialKernel::Gaussian, set)
      .Column({ { x.data(), zero.data() } }, x.size(), center, phi.data());
    for (std::size_t i = 0; i < x.size(); ++i)
    {
      const long double r2 = x[i] * x[i];
      const auto exact = static_cast<double>(std::exp(-r2));
      EXPECT_NEAR(phi[i], exact, 4 * std::numeric_limits<double>::epsilon() * exact + 1e-300)
        << x[i];
    }
  }
}

TEST(RadialSum, IsFiniteAtANode)
{
  const double x[3] = { 0.25, 0.25, 0.75 };
  const double center[2] = { 0.25, 0.25 };
  for (const lacuna::RadialKernel kernel : Kernels)
  {
    for (const lacuna::InstructionSet set : AvailableSets())
    {
      const auto loops = lacuna::GetRadialLoops<2>(kernel, set);
      double phi[3] = { 1, 1, 1 };
      loops.Column({ { x, x } }, 3, center, phi); // fewer than a pack
      EXPECT_EQ(phi[0], Phi(kernel, 0));
      EXPECT_EQ(phi[1], Phi(kernel, 0));
      EXPECT_NE(phi[2], Phi(kernel, 0));

      const double weight = 1;
      const std::vector<double> here(Block, 0.25);
      double value[Block];
      double gradient[2 * Block];
      loops.SumAndGradient(
        { { x, x } }, &weight, 1, { { here.data(), here.data() } }, value, gradient);
      EXPECT_EQ(value[Block - 1], Phi(kernel, 0));
      EXPECT_EQ(gradient[0], 0);
      EXPECT_EQ(gradient[2 * Block - 1], 0);
    }
  }
}
