// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaCubicSpline.h"

#include "lacunaExecution.h"
#include "lacunaWide.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace lacuna
{
namespace
{
// Columns worked on at once: a few hundred rows of it stay in the cache. Divisible by 1, 2 and 3
// components.
constexpr std::int64_t BlockWidth = 48;

// Below this many multiplications threads cost more than they save.
constexpr std::int64_t ParallelWork = 2000000;

void ForBlocks(Execution& execution, std::int64_t width, std::int64_t rows,
  const std::function<void(std::int64_t first, std::int64_t count)>& body)
{
  const std::int64_t blocks = (width + BlockWidth - 1) / BlockWidth;
  const auto range = [&](std::int64_t begin, std::int64_t end)
  {
    for (std::int64_t b = begin; b < end; ++b)
    {
      body(b * BlockWidth, std::min(BlockWidth, width - b * BlockWidth));
    }
  };
  if (width * rows * 16 < ParallelWork)
  {
    range(0, blocks);
    return;
  }
  execution.For(blocks, 1, range);
}

inline void Combine(const CubicSplineSpace::Values& b, const double* coefficients,
  std::int64_t stride, std::int64_t count, double* sum)
{
  const double* c = coefficients + b.First * stride;
  const auto [w0, w1, w2, w3] = b.Weights;
  for (std::int64_t k = 0; k < count; ++k)
  {
    sum[k] = w0 * c[k] + w1 * c[stride + k] + w2 * c[2 * stride + k] + w3 * c[3 * stride + k];
  }
}
}

//------------------------------------------------------------------------------
CubicSplineSpace::CubicSplineSpace()
  : CubicSplineSpace(0, {}, 1)
{
}

//------------------------------------------------------------------------------
CubicSplineSpace::CubicSplineSpace(double first, const std::vector<double>& interior, double last)
{
  this->Knots.assign(4, first);
  this->Knots.insert(this->Knots.end(), interior.begin(), interior.end());
  this->Knots.insert(this->Knots.end(), 4, last);
  for (std::size_t i = 3; i + 4 < this->Knots.size(); ++i)
  {
    if (!(this->Knots[i] < this->Knots[i + 1]) || !std::isfinite(this->Knots[i]) ||
      !std::isfinite(this->Knots[i + 1]))
    {
      throw std::invalid_argument("spline knots must be finite and increase");
    }
  }
}

//------------------------------------------------------------------------------
CubicSplineSpace CubicSplineSpace::NotAKnot(const std::vector<double>& sites)
{
  if (sites.size() < 4)
  {
    throw std::invalid_argument("a cubic spline needs at least four sites");
  }
  return CubicSplineSpace(
    sites.front(), std::vector<double>(sites.begin() + 2, sites.end() - 2), sites.back());
}

//------------------------------------------------------------------------------
double CubicSplineSpace::GetIdentityCoefficient(std::int64_t i) const
{
  return (this->Knots[i + 1] + this->Knots[i + 2] + this->Knots[i + 3]) / 3;
}

//------------------------------------------------------------------------------
CubicSplineSpace::Values CubicSplineSpace::Evaluate(double x, int derivative) const
{
  const std::vector<double>& t = this->Knots;
  x = std::clamp(x, t.front(), t.back());
  const auto last = t.end() - 4;
  const std::int64_t span = std::upper_bound(t.begin() + 4, last, x) - t.begin() - 1;
  // Cox and de Boor's recursion up to the degree of the derivative, then differences of it.
  std::array<double, 4> b{ 1, 0, 0, 0 };
  const int degree = 3 - derivative;
  for (int q = 1; q <= 3; ++q)
  {
    double carry = 0;
    for (int j = 0; j < q; ++j)
    {
      const double left = t[span + j + 1 - q];
      const double right = t[span + j + 1];
      const double share = b[j] / (right - left);
      if (q <= degree)
      {
        b[j] = carry + (right - x) * share;
        carry = (x - left) * share;
      }
      else
      {
        b[j] = carry - q * share;
        carry = q * share;
      }
    }
    b[q] = carry;
  }
  return { span - 3, b };
}

//------------------------------------------------------------------------------
CubicSplineFit::CubicSplineFit(const CubicSplineSpace& space, const std::vector<double>& sites)
  : Space(space)
{
  const std::vector<double>& t = space.GetKnots();
  const std::int64_t size = space.GetSize();
  std::size_t site = 0;
  for (std::int64_t i = 0; i < size; ++i, ++site)
  {
    while (i > 0 && site < sites.size() && sites[site] <= t[i])
    {
      ++site;
    }
    if (site >= sites.size() || (sites[site] >= t[i + 4] && i + 1 < size))
    {
      throw std::invalid_argument("the sites do not determine a spline with these knots");
    }
  }
  this->Basis.reserve(sites.size());
  for (const double x : sites)
  {
    this->Basis.push_back(space.Evaluate(x));
  }
  this->Factorise();
}

//------------------------------------------------------------------------------
void CubicSplineFit::Factorise()
{
  const std::int64_t size = this->Space.GetSize();
  this->Factor.assign(size, Row{});
  for (const CubicSplineSpace::Values& b : this->Basis)
  {
    for (int r = 0; r < 4; ++r)
    {
      for (int c = 0; c <= r; ++c)
      {
        this->Factor[b.First + r][3 - r + c] += b.Weights[r] * b.Weights[c];
      }
    }
  }
  // Cholesky within the band; element k of row i is column i - 3 + k.
  for (std::int64_t i = 0; i < size; ++i)
  {
    Row& row = this->Factor[i];
    for (int k = 0; k <= 3; ++k)
    {
      const std::int64_t j = i - 3 + k;
      if (j < 0)
      {
        continue;
      }
      double sum = row[k];
      for (int m = 0; m < k; ++m)
      {
        const std::int64_t column = i - 3 + m;
        if (column >= 0 && column >= j - 3)
        {
          sum -= row[m] * this->Factor[j][column - j + 3];
        }
      }
      row[k] = k < 3 ? sum * this->Factor[j][3] : 1 / std::sqrt(sum);
    }
    if (!std::isfinite(row[3]))
    {
      throw std::invalid_argument("the sites are too close to each other for these knots");
    }
  }
}

//------------------------------------------------------------------------------
LACUNA_WIDE void CubicSplineFit::Substitute(std::int64_t count, double* rhs) const
{
  const std::int64_t size = this->Space.GetSize();
  for (std::int64_t i = 0; i < size; ++i)
  {
    double* c = rhs + i * count;
    const Row& row = this->Factor[i];
    for (std::int64_t j = std::max<std::int64_t>(0, i - 3); j < i; ++j)
    {
      const double l = row[j - i + 3];
      const double* other = rhs + j * count;
      for (std::int64_t k = 0; k < count; ++k)
      {
        c[k] -= l * other[k];
      }
    }
    for (std::int64_t k = 0; k < count; ++k)
    {
      c[k] *= row[3];
    }
  }
  for (std::int64_t i = size - 1; i >= 0; --i)
  {
    double* c = rhs + i * count;
    for (std::int64_t j = i + 1; j < std::min(size, i + 4); ++j)
    {
      const double l = this->Factor[j][i - j + 3];
      const double* other = rhs + j * count;
      for (std::int64_t k = 0; k < count; ++k)
      {
        c[k] -= l * other[k];
      }
    }
    for (std::int64_t k = 0; k < count; ++k)
    {
      c[k] *= this->Factor[i][3];
    }
  }
}

//------------------------------------------------------------------------------
LACUNA_WIDE void CubicSplineFit::SolveBlock(const double* samples, std::int64_t width,
  std::int64_t first, std::int64_t count, int refinements, double* work, double* coefficients) const
{
  const std::int64_t size = this->Space.GetSize();
  const std::int64_t sites = this->GetNumberOfSites();
  double* residual = work + size * count;
  std::fill(coefficients, coefficients + size * count, 0.0);
  for (int pass = 0; pass <= refinements; ++pass)
  {
    double* rhs = pass == 0 ? coefficients : work;
    if (pass > 0)
    {
      std::fill(rhs, rhs + size * count, 0.0);
    }
    for (std::int64_t i = 0; i < sites; ++i)
    {
      const CubicSplineSpace::Values& b = this->Basis[i];
      const double* d = samples + i * width + first;
      if (pass > 0)
      {
        Combine(b, coefficients, count, count, residual);
        for (std::int64_t k = 0; k < count; ++k)
        {
          residual[k] = d[k] - residual[k];
        }
        d = residual;
      }
      for (int r = 0; r < 4; ++r)
      {
        double* c = rhs + (b.First + r) * count;
        const double w = b.Weights[r];
        for (std::int64_t k = 0; k < count; ++k)
        {
          c[k] += w * d[k];
        }
      }
    }
    this->Substitute(count, rhs);
    if (pass > 0)
    {
      for (std::int64_t k = 0; k < size * count; ++k)
      {
        coefficients[k] += rhs[k];
      }
    }
  }
}

//------------------------------------------------------------------------------
void CubicSplineFit::Solve(Execution& execution, const std::vector<double>& samples,
  std::int64_t width, std::vector<double>& coefficients) const
{
  const std::int64_t size = this->Space.GetSize();
  coefficients.resize(size * width);
  ForBlocks(execution, width, this->GetNumberOfSites(),
    [&](std::int64_t first, std::int64_t count)
    {
      std::vector<double> work((size + 1) * count);
      std::vector<double> block(size * count);
      this->SolveBlock(samples.data(), width, first, count, 2, work.data(), block.data());
      for (std::int64_t i = 0; i < size; ++i)
      {
        std::copy_n(block.data() + i * count, count, coefficients.data() + i * width + first);
      }
    });
}

//------------------------------------------------------------------------------
void CubicSplineFit::Evaluate(Execution& execution, const std::vector<double>& coefficients,
  std::int64_t width, std::vector<double>& samples) const
{
  const std::int64_t sites = this->GetNumberOfSites();
  samples.resize(sites * width);
  ForBlocks(execution, width, sites,
    [&](std::int64_t first, std::int64_t count)
    {
      for (std::int64_t i = 0; i < sites; ++i)
      {
        Combine(this->Basis[i], coefficients.data() + first, width, count,
          samples.data() + i * width + first);
      }
    });
}

//------------------------------------------------------------------------------
LACUNA_WIDE void CubicSplineFit::DeviationBlock(const double* coefficients, const double* samples,
  std::int64_t width, std::int64_t count, int components, double* squares) const
{
  double difference[BlockWidth];
  for (std::size_t i = 0; i < this->Basis.size(); ++i)
  {
    Combine(this->Basis[i], coefficients, count, count, difference);
    const double* d = samples + static_cast<std::int64_t>(i) * width;
    for (std::int64_t k = 0; k < count; ++k)
    {
      difference[k] -= d[k];
      difference[k] *= difference[k];
    }
    double largest = 0;
    for (std::int64_t k = 0; k < count; k += components)
    {
      double sum = difference[k];
      for (int c = 1; c < components; ++c)
      {
        sum += difference[k + c];
      }
      largest = std::max(largest, sum);
    }
    squares[i] = largest;
  }
}

//------------------------------------------------------------------------------
std::vector<double> CubicSplineFit::Deviation(Execution& execution,
  const std::vector<double>& samples, std::int64_t width, int components) const
{
  const std::int64_t size = this->Space.GetSize();
  const std::int64_t sites = this->GetNumberOfSites();
  // One row of squared distances per block, so that threads share nothing.
  const std::int64_t blocks = (width + BlockWidth - 1) / BlockWidth;
  std::vector<double> squares(blocks * sites, 0.0);
  ForBlocks(execution, width, sites,
    [&](std::int64_t first, std::int64_t count)
    {
      std::vector<double> work((size + 1) * count);
      std::vector<double> block(size * count);
      this->SolveBlock(samples.data(), width, first, count, 0, work.data(), block.data());
      this->DeviationBlock(block.data(), samples.data() + first, width, count, components,
        squares.data() + (first / BlockWidth) * sites);
    });
  std::vector<double> deviation(sites, 0.0);
  for (std::int64_t b = 0; b < blocks; ++b)
  {
    for (std::int64_t i = 0; i < sites; ++i)
    {
      deviation[i] = std::max(deviation[i], squares[b * sites + i]);
    }
  }
  for (double& d : deviation)
  {
    d = std::sqrt(d);
  }
  return deviation;
}
}
