// SPDX-License-Identifier: BSD-3-Clause
// The last step of FastRadialSum: values at the points of each box.
#include "lacunaFastRadialSum.h"

#include "lacunaBoxInterpolant.h"
#include "lacunaExecution.h"

#include <cblas.h>

#include <algorithm>

namespace lacuna
{
//------------------------------------------------------------------------------
template <int Dimension>
bool FastRadialSum<Dimension>::IsWanted(const Cell& cell) const
{
  for (int c = 0; this->Grid && c < Dimension; ++c)
  {
    if (cell.Range[c][1] <= this->Part[c][0] || cell.Range[c][0] >= this->Part[c][1])
    {
      return false;
    }
  }
  return true;
}

//------------------------------------------------------------------------------
template <int Dimension>
void FastRadialSum<Dimension>::EvaluateLocal(
  const Cell& cell, const double* local, double* values) const
{
  const CellTree<Dimension>& tree = this->GetTargets();
  const int size = this->Far->GetSize();
  const double half = tree.GetCellSize(cell.Level) / 2;
  const Point center = tree.GetCenter(cell);
  std::vector<double> coefficients(size);
  std::vector<double> scratch;
  TransformTensor<Dimension>(Repeat<Dimension>(this->Far->GetBasis().GetCoefficientsTransposed()),
    RepeatSize<Dimension>(this->Order), this->Order, local, coefficients.data(), scratch);
  if (this->Grid)
  {
    std::array<std::vector<double>, Dimension> along;
    std::array<const double*, Dimension> matrices;
    std::array<int, Dimension> counts;
    for (int c = 0; c < Dimension; ++c)
    {
      counts[c] = cell.Range[c][1] - cell.Range[c][0];
      std::vector<double> x(counts[c]);
      for (int i = 0; i < counts[c]; ++i)
      {
        x[i] = (this->Grid->Grid.Origin[c] + (cell.Range[c][0] + i) * this->Grid->Grid.Spacing[c] -
                 center[c]) /
          half;
      }
      along[c].resize(x.size() * this->Order);
      ChebyshevBasis::Evaluate(this->Order, x.data(), x.size(), along[c].data());
      matrices[c] = along[c].data();
    }
    TransformTensor<Dimension>(matrices, counts, this->Order, coefficients.data(), values, scratch);
    return;
  }
  const PointTree<Dimension>& points = this->SameTree ? *this->Sources : *this->Points;
  const int rest = size / this->Order;
  PointBasis<Dimension> basis;
  std::vector<double> partial;
  for (std::int64_t first = 0; first < cell.Count; first += PointBatch)
  {
    const auto count = static_cast<int>(std::min(PointBatch, cell.Count - first));
    basis.Set(this->Order, points.GetCoordinates(cell.First + first), count, center, half);
    partial.resize(static_cast<std::size_t>(count) * rest);
    cblas_dgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, count, rest, this->Order, 1.0,
      basis.First.data(), count, coefficients.data(), this->Order, 0.0, partial.data(), count);
    std::fill_n(values + first, count, 0.0);
    for (int k = 0; k < rest; ++k)
    {
      for (int i = 0; i < count; ++i)
      {
        values[first + i] += partial[i + count * k] * basis.Product[i + count * k];
      }
    }
  }
}

template <int Dimension>
void FastRadialSum<Dimension>::EvaluateDirect(int target, double* values) const
{
  const Cell& cell = this->GetTargets().Cells[target];
  const auto count = static_cast<std::size_t>(cell.Count);
  const std::size_t padded = (count + RadialBlock - 1) / RadialBlock * RadialBlock;
  std::array<std::vector<double>, Dimension> axis;
  this->GetTargetPoints(cell, padded, axis);
  const auto add = [&](const Coordinates<Dimension>& nodes, const double* weights, std::size_t n)
  {
    alignas(64) double sums[RadialBlock];
    for (std::size_t first = 0; first < count; first += RadialBlock)
    {
      Coordinates<Dimension> at;
      for (int c = 0; c < Dimension; ++c)
      {
        at.Axis[c] = axis[c].data() + first;
      }
      this->Loops.Sum(nodes, weights, n, at, sums);
      for (std::size_t p = 0; p < std::min(RadialBlock, count - first); ++p)
      {
        values[first + p] += sums[p];
      }
    }
  };

  // Sources of boxes that follow one another are summed at once.
  std::vector<std::array<std::int64_t, 2>> ranges;
  const CellLists<std::int32_t>& near = this->Lists->PointsToPoints;
  for (std::size_t i = near.Begin[target]; i < near.Begin[target + 1]; ++i)
  {
    const Cell& source = this->Sources->Cells[near.Items[i]];
    ranges.push_back({ source.First, source.First + source.Count });
  }
  std::sort(ranges.begin(), ranges.end());
  for (std::size_t i = 0; i < ranges.size();)
  {
    std::int64_t last = ranges[i][1];
    std::size_t next = i + 1;
    for (; next < ranges.size() && ranges[next][0] == last; ++next)
    {
      last = ranges[next][1];
    }
    add(this->Sources->GetCoordinates(ranges[i][0]), this->Weights.data() + ranges[i][0],
      last - ranges[i][0]);
    i = next;
  }

  const CellLists<std::int32_t>& multipoles = this->Lists->MultipolesToPoints;
  NodeLattice<Dimension> nodes;
  const auto size = static_cast<std::size_t>(this->Far->GetSize());
  for (std::size_t i = multipoles.Begin[target]; i < multipoles.Begin[target + 1]; ++i)
  {
    const std::int32_t s = multipoles.Items[i];
    const Cell& source = this->Sources->Cells[s];
    nodes.Set(this->Far->GetBasis().GetRoots(), this->Sources->GetCellSize(source.Level) / 2,
      this->Sources->GetCenter(source), static_cast<int>(size));
    add(nodes.Get(), this->Multipoles.data() + s * size, size);
  }
}

template <int Dimension>
void FastRadialSum<Dimension>::GetTargetPoints(
  const Cell& cell, std::size_t padded, std::array<std::vector<double>, Dimension>& axis) const
{
  const auto count = static_cast<std::size_t>(cell.Count);
  for (int c = 0; c < Dimension; ++c)
  {
    axis[c].resize(padded);
  }
  if (!this->Grid)
  {
    const PointTree<Dimension>& points = this->SameTree ? *this->Sources : *this->Points;
    for (int c = 0; c < Dimension; ++c)
    {
      std::copy_n(points.Axis[c].data() + cell.First, count, axis[c].data());
    }
  }
  else
  {
    std::size_t stride = 1;
    for (int c = 0; c < Dimension; ++c)
    {
      const auto n = static_cast<std::size_t>(cell.Range[c][1] - cell.Range[c][0]);
      for (std::size_t i = 0; i < count; ++i)
      {
        axis[c][i] = this->Grid->Grid.Origin[c] +
          static_cast<double>(cell.Range[c][0] + i / stride % n) * this->Grid->Grid.Spacing[c];
      }
      stride *= n;
    }
  }
  for (int c = 0; c < Dimension; ++c)
  {
    std::fill(
      axis[c].begin() + static_cast<std::ptrdiff_t>(count), axis[c].end(), axis[c][count - 1]);
  }
}

template <int Dimension>
void FastRadialSum<Dimension>::Store(const Cell& cell, const double* from, double* values) const
{
  if (!this->Grid)
  {
    const PointTree<Dimension>& points = this->SameTree ? *this->Sources : *this->Points;
    for (std::int64_t i = 0; i < cell.Count; ++i)
    {
      values[points.Order[cell.First + i]] = from[i];
    }
    return;
  }
  const auto& size = this->Grid->Grid.Size;
  const std::int64_t columns = cell.Range[0][1] - cell.Range[0][0];
  for (std::int64_t row = 0; row < cell.Count / columns; ++row)
  {
    std::int64_t at = cell.Range[0][0];
    std::int64_t rest = row;
    std::int64_t stride = size[0];
    for (int c = 1; c < Dimension; ++c)
    {
      const std::int64_t n = cell.Range[c][1] - cell.Range[c][0];
      at += (cell.Range[c][0] + rest % n) * stride;
      rest /= n;
      stride *= size[c];
    }
    std::copy_n(from + row * columns, columns, values + at);
  }
}

template <int Dimension>
void FastRadialSum<Dimension>::Evaluate(Execution& execution, double* values) const
{
  const CellTree<Dimension>& tree = this->GetTargets();
  const auto size = static_cast<std::size_t>(this->Far->GetSize());
  execution.For(static_cast<std::int64_t>(tree.Cells.size()), 8,
    [&](std::int64_t begin, std::int64_t end)
    {
      std::vector<double> results;
      for (std::int64_t t = begin; t < end; ++t)
      {
        const Cell& cell = tree.Cells[t];
        if (cell.Children > 0 || !this->IsWanted(cell))
        {
          continue;
        }
        results.assign(cell.Count, 0.0);
        if (cell.Level > 1)
        {
          this->EvaluateLocal(cell, this->Locals.data() + t * size, results.data());
        }
        this->EvaluateDirect(static_cast<int>(t), results.data());
        this->Store(cell, results.data(), values);
      }
    });
}

template <int Dimension>
void FastRadialSum<Dimension>::SumDirectly(Execution& execution, double* values) const
{
  const CellTree<Dimension>& tree = this->GetTargets();
  execution.For(static_cast<std::int64_t>(tree.Cells.size()), 1,
    [&](std::int64_t begin, std::int64_t end)
    {
      std::array<std::vector<double>, Dimension> axis;
      std::vector<double> results;
      for (std::int64_t t = begin; t < end; ++t)
      {
        const Cell& cell = tree.Cells[t];
        if (cell.Children > 0 || !this->IsWanted(cell))
        {
          continue;
        }
        const std::size_t padded =
          (static_cast<std::size_t>(cell.Count) + RadialBlock - 1) / RadialBlock * RadialBlock;
        this->GetTargetPoints(cell, padded, axis);
        results.resize(padded);
        for (std::size_t first = 0; first < padded; first += RadialBlock)
        {
          Coordinates<Dimension> at;
          for (int c = 0; c < Dimension; ++c)
          {
            at.Axis[c] = axis[c].data() + first;
          }
          this->Loops.Sum(this->Sources->GetCoordinates(0), this->Weights.data(),
            this->Weights.size(), at, results.data() + first);
        }
        this->Store(cell, results.data(), values);
      }
    });
}

template bool FastRadialSum<2>::IsWanted(const Cell&) const;
template bool FastRadialSum<3>::IsWanted(const Cell&) const;
template void FastRadialSum<2>::Evaluate(Execution&, double*) const;
template void FastRadialSum<3>::Evaluate(Execution&, double*) const;
template void FastRadialSum<2>::SumDirectly(Execution&, double*) const;
template void FastRadialSum<3>::SumDirectly(Execution&, double*) const;
}
