// SPDX-License-Identifier: BSD-3-Clause
// The last step of FastRadialSum: values at the points of each box.
#include "lacunaFastRadialSum.h"

#include "lacunaBoxInterpolant.h"
#include "lacunaExecution.h"
#include "lacunaSingleBlasThread.h"

#include <cblas.h>

#include <algorithm>

namespace lacuna
{
namespace
{
// Copies the points of range between two boxes of a grid that contain it, each box with the first
// index fastest.
template <int Dimension, class FromBox, class ToBox>
void CopyRows(const std::array<std::array<std::int32_t, 2>, Dimension>& range, const double* from,
  const FromBox& fromBox, double* to, const ToBox& toBox)
{
  std::int64_t rows = 1;
  for (int c = 1; c < Dimension; ++c)
  {
    rows *= range[c][1] - range[c][0];
  }
  const auto getPlace = [&](const auto& box, std::int64_t row)
  {
    std::int64_t place = range[0][0] - box[0][0];
    std::int64_t stride = box[0][1] - box[0][0];
    for (int c = 1; c < Dimension; ++c)
    {
      const std::int64_t size = range[c][1] - range[c][0];
      place += (range[c][0] + row % size - box[c][0]) * stride;
      stride *= box[c][1] - box[c][0];
      row /= size;
    }
    return place;
  };
  for (std::int64_t row = 0; row < rows; ++row)
  {
    std::copy_n(
      from + getPlace(fromBox, row), range[0][1] - range[0][0], to + getPlace(toBox, row));
  }
}

// Cuts a part across its longest edge and appends the second half. False for a point.
template <int Dimension>
bool Halve(GridPart<Dimension>& part, std::vector<GridPart<Dimension>>& parts)
{
  const auto getLength = [](const auto& range) { return range[1] - range[0]; };
  const auto longest = std::max_element(part.begin(), part.end(),
    [&](const auto& a, const auto& b) { return getLength(a) < getLength(b); });
  if (getLength(*longest) < 2)
  {
    return false;
  }
  const auto axis = longest - part.begin();
  GridPart<Dimension> other = part;
  other[axis][0] = (part[axis][0] + part[axis][1]) / 2;
  part[axis][1] = other[axis][0];
  parts.push_back(other); // part may be one of them
  return true;
}
}

//------------------------------------------------------------------------------
template <int Dimension>
bool FastRadialSum<Dimension>::IsWithin(const Cell& cell, const GridPart<Dimension>& part)
{
  for (int c = 0; c < Dimension; ++c)
  {
    if (cell.Range[c][1] <= part[c][0] || cell.Range[c][0] >= part[c][1])
    {
      return false;
    }
  }
  return true;
}

template <int Dimension>
TreeCell<Dimension> FastRadialSum<Dimension>::Clip(
  const Cell& cell, const GridPart<Dimension>& part) const
{
  Cell clipped = cell;
  if (this->Grid)
  {
    clipped.Count = 1;
    for (int c = 0; c < Dimension; ++c)
    {
      clipped.Range[c][0] = static_cast<int>(std::max<std::int64_t>(cell.Range[c][0], part[c][0]));
      clipped.Range[c][1] = static_cast<int>(std::min<std::int64_t>(cell.Range[c][1], part[c][1]));
      clipped.Count *= clipped.Range[c][1] - clipped.Range[c][0];
    }
  }
  return clipped;
}

template <int Dimension>
std::vector<int> FastRadialSum<Dimension>::GetLeaves(const GridPart<Dimension>& part) const
{
  const std::vector<Cell>& cells = this->GetTargets().Cells;
  std::vector<int> leaves;
  std::vector<int> open{ 0 };
  for (std::size_t i = 0; i < open.size(); ++i)
  {
    const Cell& cell = cells[open[i]];
    if (this->Grid && !IsWithin(cell, part))
    {
      continue;
    }
    if (cell.Children == 0)
    {
      leaves.push_back(open[i]);
    }
    for (int child = 0; child < cell.Children; ++child)
    {
      open.push_back(cell.FirstChild + child);
    }
  }
  return leaves;
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
void FastRadialSum<Dimension>::EvaluateDirect(int target, const Cell& cell, double* values) const
{
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
void FastRadialSum<Dimension>::SumDirectly(const Cell& cell, double* values) const
{
  const auto count = static_cast<std::size_t>(cell.Count);
  const std::size_t padded = (count + RadialBlock - 1) / RadialBlock * RadialBlock;
  std::array<std::vector<double>, Dimension> axis;
  this->GetTargetPoints(cell, padded, axis);
  alignas(64) double sums[RadialBlock];
  for (std::size_t first = 0; first < count; first += RadialBlock)
  {
    Coordinates<Dimension> at;
    for (int c = 0; c < Dimension; ++c)
    {
      at.Axis[c] = axis[c].data() + first;
    }
    this->Loops.Sum(
      this->Sources->GetCoordinates(0), this->Weights.data(), this->Weights.size(), at, sums);
    std::copy_n(sums, std::min(RadialBlock, count - first), values + first);
  }
}

template <int Dimension>
void FastRadialSum<Dimension>::EvaluatePart(
  Execution& execution, const GridPart<Dimension>& part, double* values) const
{
  const SingleBlasThread single(execution.GetNumberOfThreads());
  if (this->Direct || !this->OfPart.Slots.empty())
  {
    this->EvaluateSome(execution, part, this->OfPart, part, values);
    return;
  }
  const Execution::NestedStages stages(execution);
  std::vector<GridPart<Dimension>> some{ part };
  for (std::size_t i = 0; i < some.size(); ++i)
  {
    while (!this->Fits(some[i]) && Halve<Dimension>(some[i], some))
    {
    }
  }
  for (std::size_t i = 0; i < some.size(); ++i)
  {
    const double begin = static_cast<double>(i) / static_cast<double>(some.size());
    const double share = 1 / static_cast<double>(some.size());
    execution.SetStage(begin, begin + 0.6 * share);
    const Interpolants own = this->MakeInterpolants(execution, some[i]);
    execution.SetStage(begin + 0.6 * share, begin + share);
    this->EvaluateSome(execution, some[i], own, part, values);
  }
}

template <int Dimension>
void FastRadialSum<Dimension>::EvaluateSome(Execution& execution, const GridPart<Dimension>& some,
  const Interpolants& interpolants, const GridPart<Dimension>& part, double* values) const
{
  const CellTree<Dimension>& tree = this->GetTargets();
  const auto size = static_cast<std::size_t>(this->Direct ? 0 : this->Far->GetSize());
  const std::vector<int> leaves = this->GetLeaves(some);
  execution.For(static_cast<std::int64_t>(leaves.size()), this->Direct ? 1 : 8,
    [&](std::int64_t begin, std::int64_t end)
    {
      std::vector<double> all;
      std::vector<double> results;
      for (std::int64_t leaf = begin; leaf < end; ++leaf)
      {
        const int t = leaves[leaf];
        const Cell& cell = tree.Cells[t];
        const Cell clipped = this->Clip(cell, some);
        results.assign(clipped.Count, 0.0);
        if (this->Direct)
        {
          this->SumDirectly(clipped, results.data());
        }
        else
        {
          if (cell.Level > 1)
          {
            // Of all points whatever is wanted: rounding of matrix products depends on their size.
            all.resize(cell.Count);
            this->EvaluateLocal(
              cell, interpolants.Locals.data() + interpolants.Slots[t] * size, all.data());
            if (this->Grid)
            {
              CopyRows<Dimension>(
                clipped.Range, all.data(), cell.Range, results.data(), clipped.Range);
            }
            else
            {
              results.swap(all);
            }
          }
          this->EvaluateDirect(t, clipped, results.data());
        }
        if (this->Grid)
        {
          CopyRows<Dimension>(clipped.Range, results.data(), clipped.Range, values, part);
        }
        else
        {
          const PointTree<Dimension>& points = this->SameTree ? *this->Sources : *this->Points;
          for (std::int64_t i = 0; i < cell.Count; ++i)
          {
            values[points.Order[cell.First + i]] = results[i];
          }
        }
      }
    });
}

template bool FastRadialSum<2>::IsWithin(const Cell&, const GridPart<2>&);
template bool FastRadialSum<3>::IsWithin(const Cell&, const GridPart<3>&);
template void FastRadialSum<2>::EvaluatePart(Execution&, const GridPart<2>&, double*) const;
template void FastRadialSum<3>::EvaluatePart(Execution&, const GridPart<3>&, double*) const;
}
