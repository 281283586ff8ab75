// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaFarField.h"

#include "lacunaExecution.h"

#include <cblas.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <utility>

namespace lacuna
{
namespace
{
// The interpolant is largest wrong at corners; these are tried along each axis.
constexpr std::array<double, 4> Samples{ -1, -0.37, 0.43, 1 };
// for what lies between the samples
constexpr double SampleSafety = 1.5;
// Of the error of interpolation: what the low-rank form is made for, and what it may add.
constexpr double CompressionShare = 0.05;
constexpr double CompressionAllowance = 1.2;

template <int Dimension>
std::array<int, Dimension> GetAxes(int permutation)
{
  std::array<int, Dimension> axes;
  for (int c = 0; c < Dimension; ++c)
  {
    axes[c] = c;
  }
  for (int i = 0; i < permutation; ++i)
  {
    std::next_permutation(axes.begin(), axes.end());
  }
  return axes;
}

// Products of one-dimensional positions.
template <int Dimension>
struct Lattice
{
  std::array<std::vector<double>, Dimension> Axis;

  Lattice(
    const std::vector<double>& positions, double scale, const std::array<double, Dimension>& shift)
  {
    const std::size_t n = positions.size();
    std::size_t size = 1;
    for (int c = 0; c < Dimension; ++c)
    {
      size *= n;
    }
    std::size_t stride = 1;
    for (int c = 0; c < Dimension; ++c)
    {
      this->Axis[c].resize(size);
      for (std::size_t i = 0; i < size; ++i)
      {
        this->Axis[c][i] = shift[c] + scale * positions[(i / stride) % n];
      }
      stride *= n;
    }
  }
  int GetSize() const { return static_cast<int>(this->Axis[0].size()); }
  Coordinates<Dimension> Get() const
  {
    Coordinates<Dimension> coordinates;
    for (int c = 0; c < Dimension; ++c)
    {
      coordinates.Axis[c] = this->Axis[c].data();
    }
    return coordinates;
  }
  // phi(target - source) as a column for each source
  std::vector<double> GetMatrix(RadialKernel kernel, const Lattice& sources) const
  {
    const RadialLoops<Dimension> loops = GetRadialLoops<Dimension>(kernel, BestInstructionSet());
    std::vector<double> matrix(this->Axis[0].size() * sources.Axis[0].size());
    for (std::size_t j = 0; j < sources.Axis[0].size(); ++j)
    {
      double center[Dimension];
      for (int c = 0; c < Dimension; ++c)
      {
        center[c] = sources.Axis[c][j];
      }
      loops.Column(
        this->Get(), this->Axis[0].size(), center, matrix.data() + j * this->Axis[0].size());
    }
    return matrix;
  }
};

// Cross approximation with partial pivoting (adaptive cross approximation, Bebendorf 2000) up to an
// element-wise tolerance. False when the rank would not pay.
bool Compress(const std::vector<double>& matrix, double tolerance, FarOperator& op)
{
  const auto n = static_cast<std::size_t>(op.Size);
  std::vector<double> a;
  std::vector<double> b;
  std::vector<char> rowUsed(n, 0);
  std::vector<double> u(n);
  std::vector<double> v(n);
  const auto largest = [](const std::vector<double>& values)
  {
    return static_cast<std::size_t>(
      std::max_element(values.begin(), values.end(),
        [](double x, double y) { return std::abs(x) < std::abs(y); }) -
      values.begin());
  };
  std::size_t row = 0;
  int small = 0; // crosses in a row that were below the tolerance
  for (std::size_t rank = 0; rank < n / 2; ++rank)
  {
    rowUsed[row] = 1;
    for (std::size_t j = 0; j < n; ++j)
    {
      v[j] = matrix[row + n * j];
    }
    for (std::size_t k = 0; k < rank; ++k)
    {
      const double factor = a[row + n * k];
      for (std::size_t j = 0; j < n; ++j)
      {
        v[j] -= factor * b[j + n * k];
      }
    }
    const std::size_t column = largest(v);
    const double pivot = v[column];
    if (pivot == 0)
    {
      u.assign(n, 0.0);
    }
    else
    {
      std::copy_n(matrix.begin() + static_cast<std::ptrdiff_t>(n * column), n, u.begin());
      for (std::size_t k = 0; k < rank; ++k)
      {
        const double factor = b[column + n * k];
        for (std::size_t i = 0; i < n; ++i)
        {
          u[i] -= factor * a[i + n * k];
        }
      }
      for (double& value : v)
      {
        value /= pivot;
      }
    }
    a.insert(a.end(), u.begin(), u.end());
    b.insert(b.end(), v.begin(), v.end());
    small = std::abs(u[largest(u)]) <= tolerance ? small + 1 : 0;
    if (small == 3)
    {
      op.Rank = static_cast<int>(rank) + 1;
      op.A = std::move(a);
      op.B = std::move(b);
      return true;
    }
    for (std::size_t i = 0; i < n; ++i)
    {
      u[i] = rowUsed[i] ? 0 : u[i];
    }
    row = largest(u);
    if (rowUsed[row])
    {
      row =
        static_cast<std::size_t>(std::find(rowUsed.begin(), rowUsed.end(), 0) - rowUsed.begin());
    }
  }
  return false;
}

// S_k at the samples of a box, a row for each sample.
template <int Dimension>
std::vector<double> GetSampleBasis(const ChebyshevBasis& basis)
{
  const int order = basis.GetOrder();
  const auto count = static_cast<int>(Samples.size());
  std::vector<double> t(static_cast<std::size_t>(order) * count);
  ChebyshevBasis::Evaluate(order, Samples.data(), count, t.data());
  std::vector<double> values(t.size(), 0.0); // i + count k
  cblas_dgemm(CblasColMajor, CblasNoTrans, CblasTrans, count, order, order, 1.0, t.data(), count,
    basis.GetCoefficients(), order, 0.0, values.data(), count);
  int rows = 1;
  int columns = 1;
  for (int c = 0; c < Dimension; ++c)
  {
    rows *= count;
    columns *= order;
  }
  std::vector<double> matrix(static_cast<std::size_t>(rows) * columns);
  for (int k = 0; k < columns; ++k)
  {
    for (int i = 0; i < rows; ++i)
    {
      double product = 1;
      for (int c = 0, is = i, ks = k; c < Dimension; ++c, is /= count, ks /= order)
      {
        product *= values[is % count + count * (ks % order)];
      }
      matrix[i + static_cast<std::size_t>(rows) * k] = product;
    }
  }
  return matrix;
}
}

//------------------------------------------------------------------------------
template <int Dimension>
FarOffsets<Dimension>::FarOffsets()
{
  for (int x = 2; x <= 3; ++x)
  {
    for (int y = 0; y <= x; ++y)
    {
      for (int z = 0; z <= (Dimension == 2 ? 0 : y); ++z)
      {
        std::array<int, Dimension> offset{};
        offset[0] = x;
        offset[1] = y;
        offset[Dimension - 1] = Dimension == 2 ? y : z;
        this->Canonical.push_back(offset);
      }
    }
  }
}

template <int Dimension>
typename FarOffsets<Dimension>::Entry FarOffsets<Dimension>::Find(
  const std::array<int, Dimension>& offset) const
{
  constexpr int permutations = Symmetries >> Dimension;
  for (int permutation = 0; permutation < permutations; ++permutation)
  {
    const std::array<int, Dimension> axes = GetAxes<Dimension>(permutation);
    std::array<int, Dimension> turned;
    int signs = 0;
    for (int c = 0; c < Dimension; ++c)
    {
      turned[c] = std::abs(offset[axes[c]]);
      signs |= (offset[axes[c]] < 0 ? 1 : 0) << c;
    }
    const auto found = std::find(this->Canonical.begin(), this->Canonical.end(), turned);
    if (found != this->Canonical.end())
    {
      return { static_cast<std::uint8_t>(found - this->Canonical.begin()),
        static_cast<std::uint8_t>(permutation << Dimension | signs) };
    }
  }
  return { 0, 0 };
}

template <int Dimension>
std::vector<std::int32_t> FarOffsets<Dimension>::GetPermutation(int symmetry, int order)
{
  const std::array<int, Dimension> axes = GetAxes<Dimension>(symmetry >> Dimension);
  int size = 1;
  std::array<int, Dimension> stride;
  for (int c = 0; c < Dimension; ++c)
  {
    stride[c] = size;
    size *= order;
  }
  std::vector<std::int32_t> permutation(size);
  for (int k = 0; k < size; ++k)
  {
    int to = 0;
    for (int c = 0; c < Dimension; ++c)
    {
      const int i = k / stride[axes[c]] % order;
      to += stride[c] * ((symmetry >> c) & 1 ? order - 1 - i : i);
    }
    permutation[k] = to;
  }
  return permutation;
}

//------------------------------------------------------------------------------
void FarOperator::Apply(
  const double* in, int count, double* out, std::vector<double>& scratch) const
{
  if (this->Rank == 0)
  {
    cblas_dgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, this->Size, count, this->Size, 1.0,
      this->A.data(), this->Size, in, this->Size, 0.0, out, this->Size);
    return;
  }
  const std::size_t needed = static_cast<std::size_t>(this->Rank) * count;
  if (scratch.size() < needed)
  {
    scratch.resize(needed);
  }
  cblas_dgemm(CblasColMajor, CblasTrans, CblasNoTrans, this->Rank, count, this->Size, 1.0,
    this->B.data(), this->Size, in, this->Size, 0.0, scratch.data(), this->Rank);
  cblas_dgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, this->Size, count, this->Rank, 1.0,
    this->A.data(), this->Size, scratch.data(), this->Rank, 0.0, out, this->Size);
}

//------------------------------------------------------------------------------
template <int Dimension>
class FarField<Dimension>::Maker
{
public:
  Maker(RadialKernel kernel, const ChebyshevBasis& basis, int size, double boxSize,
    const std::array<int, Dimension>& offset)
    : Samples1D(Samples.begin(), Samples.end())
  {
    std::array<double, Dimension> shift;
    for (int c = 0; c < Dimension; ++c)
    {
      shift[c] = offset[c] * boxSize;
    }
    const double half = boxSize / 2;
    this->Dense.Size = size;
    this->Dense.A = Lattice<Dimension>(basis.GetRoots(), half, {})
                      .GetMatrix(kernel, Lattice<Dimension>(basis.GetRoots(), half, shift));
    const Lattice<Dimension> targets(this->Samples1D, half, {});
    this->Exact = targets.GetMatrix(kernel, Lattice<Dimension>(this->Samples1D, half, shift));
    this->Rows = targets.GetSize();
    this->X = GetSampleBasis<Dimension>(basis);
    this->Transposed.resize(this->X.size());
    for (int i = 0; i < this->Rows; ++i)
    {
      for (int k = 0; k < size; ++k)
      {
        this->Transposed[k + static_cast<std::size_t>(size) * i] =
          this->X[i + static_cast<std::size_t>(this->Rows) * k];
      }
    }
  }

  // Of the interpolant at the samples, X K X^T, against phi.
  double Measure(const FarOperator& op) const
  {
    std::vector<double> locals(this->Transposed.size());
    std::vector<double> interpolated(this->Exact.size());
    std::vector<double> scratch;
    op.Apply(this->Transposed.data(), this->Rows, locals.data(), scratch);
    cblas_dgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, this->Rows, this->Rows, op.Size, 1.0,
      this->X.data(), this->Rows, locals.data(), op.Size, 0.0, interpolated.data(), this->Rows);
    double error = 0;
    for (std::size_t i = 0; i < this->Exact.size(); ++i)
    {
      error = std::max(error, std::abs(interpolated[i] - this->Exact[i]));
    }
    return error;
  }
  double MeasureDense() const { return this->Measure(this->Dense); }

  FarOperator Make(double error)
  {
    FarOperator op;
    op.Size = this->Dense.Size;
    if (Compress(this->Dense.A, CompressionShare * error, op) &&
      this->Measure(op) <= CompressionAllowance * error)
    {
      return op;
    }
    return std::move(this->Dense);
  }

private:
  std::vector<double> Samples1D;
  FarOperator Dense;
  std::vector<double> Exact;
  int Rows;
  std::vector<double> X;
  std::vector<double> Transposed;
};

template <int Dimension>
FarField<Dimension>::FarField(Execution& execution, RadialKernel kernel, int order, double rootSize,
  const std::vector<char>& levels)
  : Kernel(kernel)
  , Basis(order)
  , Size(1)
  , RootSize(rootSize)
  , Homogeneous(kernel == RadialKernel::Linear || kernel == RadialKernel::Cubic)
{
  for (int c = 0; c < Dimension; ++c)
  {
    this->Size *= order;
  }
  for (std::size_t level = 0; level < levels.size(); ++level)
  {
    this->Scales.push_back(this->Homogeneous
        ? std::pow(std::ldexp(rootSize, -static_cast<int>(level)), GetRadialPower(kernel))
        : 1.0);
  }
  this->Used = this->Homogeneous ? std::vector<char>(1, 1) : levels;
  this->Errors.resize(this->Used.size());
  this->ForOperators(execution,
    [&](Maker& maker, int level, std::size_t op)
    { this->Errors[level][op] = SampleSafety * CompressionAllowance * maker.MeasureDense(); });
}

template <int Dimension>
template <class Body>
void FarField<Dimension>::ForOperators(Execution& execution, const Body& body)
{
  const FarOffsets<Dimension> offsets;
  const auto count = static_cast<std::int64_t>(offsets.GetCanonical().size());
  for (std::vector<double>& errors : this->Errors)
  {
    errors.resize(count, 0.0);
  }
  execution.For(static_cast<std::int64_t>(this->Used.size()) * count, 1,
    [&](std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t i = begin; i < end; ++i)
      {
        const int level = static_cast<int>(i / count);
        if (this->Used[level])
        {
          const double boxSize = this->Homogeneous ? 1.0 : std::ldexp(this->RootSize, -level);
          Maker maker(
            this->Kernel, this->Basis, this->Size, boxSize, offsets.GetCanonical()[i % count]);
          body(maker, level, static_cast<std::size_t>(i % count));
        }
      }
    });
}

template <int Dimension>
void FarField<Dimension>::MakeOperators(Execution& execution)
{
  if (!this->Operators.empty())
  {
    return;
  }
  std::vector<std::vector<FarOperator>> made(this->Used.size());
  for (std::size_t level = 0; level < made.size(); ++level)
  {
    made[level].resize(this->Errors[level].size());
  }
  this->ForOperators(execution,
    [&](Maker& maker, int level, std::size_t op) {
      made[level][op] = maker.Make(this->Errors[level][op] / (SampleSafety * CompressionAllowance));
    });
  this->Operators = std::move(made);
}

template <int Dimension>
double FarField<Dimension>::GetLargestError(int level) const
{
  const std::vector<double>& errors = this->Errors[this->Homogeneous ? 0 : level];
  return this->Scales[level] * *std::max_element(errors.begin(), errors.end());
}

template class FarOffsets<2>;
template class FarOffsets<3>;
template class FarField<2>;
template class FarField<3>;
}
