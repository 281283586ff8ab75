// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaFastRadialSum.h"

#include "lacunaBoxInterpolant.h"
#include "lacunaExecution.h"
#include "lacunaMemory.h"
#include "lacunaSingleBlasThread.h"

#include <algorithm>
#include <cblas.h>
#include <cmath>
#include <limits>
#include <memory>
#include <sstream>
#include <stdexcept>

namespace lacuna
{
namespace
{
// Where direct sums and interpolants take about the same time.
constexpr int SourceCapacity2D = 48;
constexpr int SourceCapacity3D = 160;
constexpr int GridSourceCapacity = 24;
constexpr int GridCapacity2D = 144;
constexpr int GridCapacity3D = 512;
// Direct sums instead where no interpolant is accurate enough, up to so many evaluations.
constexpr double MaximumDirect = 2e11;
}

//------------------------------------------------------------------------------
template <int Dimension>
FastRadialSum<Dimension>::FastRadialSum(
  RadialKernel kernel, const std::vector<Point>& sources, const std::vector<Point>& points)
  : Kernel(kernel)
  , Loops(GetRadialLoops<Dimension>(kernel, BestInstructionSet()))
  , SameTree(&sources == &points)
{
  if (sources.empty() || points.empty())
  {
    throw std::invalid_argument("a sum needs sources and points");
  }
  constexpr int capacity = Dimension == 2 ? SourceCapacity2D : SourceCapacity3D;
  RootCube<Dimension> root = RootCube<Dimension>::Around(sources);
  root.Add(RootCube<Dimension>::Around(points));
  this->Sources = std::make_unique<PointTree<Dimension>>(root, sources, capacity);
  if (!this->SameTree)
  {
    this->Points = std::make_unique<PointTree<Dimension>>(root, points, capacity);
  }
  this->Prepare();
}

template <int Dimension>
FastRadialSum<Dimension>::FastRadialSum(
  RadialKernel kernel, const std::vector<Point>& sources, const RegularGrid<Dimension>& grid)
  : Kernel(kernel)
  , Loops(GetRadialLoops<Dimension>(kernel, BestInstructionSet()))
{
  if (sources.empty() || grid.GetNumberOfPoints() < 1)
  {
    throw std::invalid_argument("a sum needs sources and points");
  }
  RootCube<Dimension> root = RootCube<Dimension>::Around(sources);
  Point last = grid.Origin;
  for (int c = 0; c < Dimension; ++c)
  {
    last[c] += static_cast<double>(grid.Size[c] - 1) * grid.Spacing[c];
  }
  root.Add(RootCube<Dimension>::Around({ grid.Origin, last }));
  this->Sources = std::make_unique<PointTree<Dimension>>(root, sources, GridSourceCapacity);
  this->Grid = std::make_unique<GridTree<Dimension>>(
    root, grid, Dimension == 2 ? GridCapacity2D : GridCapacity3D);
  this->Part = WholeGrid(grid);
  this->Prepare();
}

template <int Dimension>
FastRadialSum<Dimension>::~FastRadialSum() = default;

template <int Dimension>
void FastRadialSum<Dimension>::Prepare()
{
  this->Lists = std::make_unique<InteractionLists<Dimension>>(
    this->GetTargets(), *this->Sources, Dimension == 2 ? 64 : 216);
  this->Magnitudes.resize(this->Sources->Cells.size());
  this->Levels.assign(
    std::max(this->Sources->GetNumberOfLevels(), this->GetTargets().GetNumberOfLevels()), 0);
  const InteractionLists<Dimension>& lists = *this->Lists;
  const std::vector<Cell>& targets = this->GetTargets().Cells;
  for (const typename InteractionLists<Dimension>::Block& block : lists.Blocks)
  {
    this->Levels[targets[block.FirstTarget].Level] = 1;
  }
  for (const std::int32_t s : lists.MultipolesToPoints.Items)
  {
    this->Levels[this->Sources->Cells[s].Level] = 1;
  }
  for (std::size_t t = 0; t < targets.size(); ++t)
  {
    if (lists.PointsToLocal.Begin[t] < lists.PointsToLocal.Begin[t + 1])
    {
      this->Levels[targets[t].Level] = 1;
    }
  }
  this->FarFields.resize(MaximumOrder + 1);
}

template <int Dimension>
const CellTree<Dimension>& FastRadialSum<Dimension>::GetTargets() const
{
  if (this->Grid)
  {
    return *this->Grid;
  }
  return this->SameTree ? *this->Sources : *this->Points;
}

template <int Dimension>
std::int64_t FastRadialSum<Dimension>::GetNumberOfPoints() const
{
  return this->GetTargets().Cells[0].Count;
}

//------------------------------------------------------------------------------
template <int Dimension>
double FastRadialSum<Dimension>::Apply(
  Execution& execution, const std::vector<double>& weights, double tolerance, double* values)
{
  return this->ApplyWithin(MaximumOrder, execution, weights, tolerance, values);
}

template <int Dimension>
double FastRadialSum<Dimension>::ApplyOnce(
  Execution& execution, const std::vector<double>& weights, double tolerance, double* values)
{
  return this->ApplyWithin(this->GetLargestOrder(), execution, weights, tolerance, values);
}

template <int Dimension>
double FastRadialSum<Dimension>::SetUpOnce(
  Execution& execution, const std::vector<double>& weights, double tolerance)
{
  return this->SetUpWithin(this->GetLargestOrder(), execution, weights, tolerance);
}

template <int Dimension>
int FastRadialSum<Dimension>::GetLargestOrder() const
{
  int order = MaximumOrder;
  while (order > 1 && this->GetSetUpEvaluations(order) > this->GetDirectEvaluations())
  {
    --order;
  }
  return order;
}

template <int Dimension>
double FastRadialSum<Dimension>::SetUpWithin(
  int order, Execution& execution, const std::vector<double>& weights, double tolerance)
{
  const Execution::NestedStages stages(execution);
  const SingleBlasThread single(execution.GetNumberOfThreads());
  this->SortWeights(weights);
  execution.SetStage(0, 0.15);
  double bound = std::numeric_limits<double>::infinity();
  if (order > 1)
  {
    bound = this->ChooseOrder(execution, tolerance, order);
  }
  this->Direct = !(bound <= tolerance);
  if (!this->Direct)
  {
    this->SetUpInterpolants(execution);
    return bound;
  }
  if (!(this->GetDirectEvaluations() <= MaximumDirect))
  {
    std::ostringstream message;
    message << "a fast sum cannot be sure of an error below " << tolerance << ", only of one below "
            << bound << "; raise " << this->Words.Accuracy;
    throw std::runtime_error(message.str());
  }
  return 0;
}

template <int Dimension>
double FastRadialSum<Dimension>::ApplyWithin(int order, Execution& execution,
  const std::vector<double>& weights, double tolerance, double* values)
{
  const Execution::NestedStages stages(execution);
  execution.SetStage(0, 0.65);
  const double bound = this->SetUpWithin(order, execution, weights, tolerance);
  execution.SetStage(this->Direct ? 0.1 : 0.65, 1);
  this->EvaluatePart(execution, this->Part, values);
  return bound;
}

template <int Dimension>
double FastRadialSum<Dimension>::ApplyUpTo(int order, Execution& execution,
  const std::vector<double>& weights, double tolerance, double* values)
{
  const Execution::NestedStages stages(execution);
  const SingleBlasThread single(execution.GetNumberOfThreads());
  this->SortWeights(weights);
  execution.SetStage(0, 0.1);
  const double bound = this->ChooseOrder(execution, tolerance, order);
  this->Direct = false;
  execution.SetStage(0.1, 0.65);
  this->SetUpInterpolants(execution);
  execution.SetStage(0.65, 1);
  this->EvaluatePart(execution, this->Part, values);
  return bound;
}

template <int Dimension>
void FastRadialSum<Dimension>::SortWeights(const std::vector<double>& weights)
{
  this->Weights.resize(weights.size());
  for (std::size_t k = 0; k < weights.size(); ++k)
  {
    this->Weights[k] = weights[this->Sources->Order[k]];
  }
  this->SumMagnitudes();
}

template <int Dimension>
void FastRadialSum<Dimension>::SetUpInterpolants(Execution& execution)
{
  const Execution::NestedStages stages(execution);
  execution.SetStage(0.15, 0.45);
  this->Upward(execution);
  execution.SetStage(0.45, 1);
  this->OfPart = {};
  if (this->Fits(this->Part))
  {
    this->OfPart = this->MakeInterpolants(execution, this->Part);
  }
}

//------------------------------------------------------------------------------
template <int Dimension>
std::int64_t FastRadialSum<Dimension>::CountWanted(const GridPart<Dimension>& part) const
{
  const std::vector<Cell>& cells = this->GetTargets().Cells;
  return std::count_if(
    cells.begin(), cells.end(), [&](const Cell& cell) { return this->IsWanted(cell, part); });
}

template <int Dimension>
bool FastRadialSum<Dimension>::Fits(const GridPart<Dimension>& part) const
{
  const double bytes = 8.0 * this->Far->GetSize() * static_cast<double>(this->CountWanted(part));
  return !this->Grid || bytes <= this->MemoryForInterpolants;
}

template <int Dimension>
typename FastRadialSum<Dimension>::Interpolants FastRadialSum<Dimension>::MakeInterpolants(
  Execution& execution, const GridPart<Dimension>& part) const
{
  const Execution::NestedStages stages(execution);
  const std::vector<Cell>& cells = this->GetTargets().Cells;
  Interpolants made;
  made.Slots.reserve(cells.size());
  std::int32_t wanted = 0;
  for (const Cell& cell : cells)
  {
    made.Slots.push_back(this->IsWanted(cell, part) ? wanted++ : -1);
  }
  const std::size_t numbers = static_cast<std::size_t>(wanted) * this->Far->GetSize();
  RequireMemory("the interpolants of a fast sum (raise " + this->Words.Accuracy + ")",
    static_cast<double>(numbers * sizeof(double)));
  made.Locals.assign(numbers, 0.0);
  execution.SetStage(0, 0.8);
  this->Across(execution, made);
  execution.SetStage(0.8, 1);
  this->Downward(execution, made);
  return made;
}

//------------------------------------------------------------------------------
template <int Dimension>
void FastRadialSum<Dimension>::PointsToMultipole(const Cell& cell, double* multipole) const
{
  const int size = this->Far->GetSize();
  const int rest = size / this->Order;
  const double half = this->Sources->GetCellSize(cell.Level) / 2;
  const Point center = this->Sources->GetCenter(cell);
  PointBasis<Dimension> basis;
  std::vector<double> moments(size, 0.0);
  for (std::int64_t first = 0; first < cell.Count; first += PointBatch)
  {
    const auto count = static_cast<int>(std::min(PointBatch, cell.Count - first));
    const std::int64_t at = cell.First + first;
    basis.Set(this->Order, this->Sources->GetCoordinates(at), count, center, half);
    for (int j = 0; j < this->Order; ++j)
    {
      for (int i = 0; i < count; ++i)
      {
        basis.First[i + count * j] *= this->Weights[at + i];
      }
    }
    cblas_dgemm(CblasColMajor, CblasTrans, CblasNoTrans, this->Order, rest, count, 1.0,
      basis.First.data(), count, basis.Product.data(), count, 1.0, moments.data(), this->Order);
  }
  std::vector<double> scratch;
  TransformTensor<Dimension>(Repeat<Dimension>(this->Far->GetBasis().GetCoefficients()),
    RepeatSize<Dimension>(this->Order), this->Order, moments.data(), multipole, scratch);
}

template <int Dimension>
void FastRadialSum<Dimension>::Upward(Execution& execution)
{
  const PointTree<Dimension>& tree = *this->Sources;
  const auto size = static_cast<std::size_t>(this->Far->GetSize());
  this->Multipoles.assign(tree.Cells.size() * size, 0.0);
  const ChebyshevBasis& basis = this->Far->GetBasis();
  execution.For(static_cast<std::int64_t>(tree.Cells.size()), 16,
    [&](std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t s = begin; s < end; ++s)
      {
        if (tree.Cells[s].Children == 0)
        {
          this->PointsToMultipole(tree.Cells[s], this->Multipoles.data() + s * size);
        }
      }
    });
  const auto addChildren = [&](std::int64_t begin, std::int64_t end)
  {
    std::vector<double> scratch;
    std::vector<double> moved(size);
    for (std::int64_t s = begin; s < end; ++s)
    {
      const Cell& cell = tree.Cells[s];
      for (int child = cell.FirstChild; child < cell.FirstChild + cell.Children; ++child)
      {
        std::array<const double*, Dimension> halves;
        for (int c = 0; c < Dimension; ++c)
        {
          halves[c] = basis.GetHalf(static_cast<int>(tree.Cells[child].Index[c] & 1U));
        }
        TransformTensor<Dimension>(halves, RepeatSize<Dimension>(this->Order), this->Order,
          this->Multipoles.data() + child * size, moved.data(), scratch);
        double* multipole = this->Multipoles.data() + s * size;
        for (std::size_t k = 0; k < size; ++k)
        {
          multipole[k] += moved[k];
        }
      }
    }
  };
  // Boxes at levels 0 and 1 touch all others.
  for (int level = tree.GetNumberOfLevels() - 2; level > 1; --level)
  {
    this->ForCells(execution, tree.LevelBegin[level], tree.LevelBegin[level + 1], addChildren);
  }
}

template <int Dimension>
void FastRadialSum<Dimension>::ForCells(Execution& execution, int first, int last,
  const std::function<void(std::int64_t, std::int64_t)>& body)
{
  // Threads are not worth starting for a few boxes.
  if (last - first < 64)
  {
    body(first, last);
    return;
  }
  execution.For(last - first, 16,
    [&](std::int64_t begin, std::int64_t end) { body(first + begin, first + end); });
}

//------------------------------------------------------------------------------
template <int Dimension>
void FastRadialSum<Dimension>::ApplyPairs(
  const typename InteractionLists<Dimension>::Block& block, Interpolants& to) const
{
  constexpr std::size_t columns = 256;
  const auto size = static_cast<std::size_t>(this->Far->GetSize());
  const int level = this->GetTargets().Cells[block.FirstTarget].Level;
  const double scale = this->Far->GetScale(level);
  const std::vector<FarPair>& pairs = this->Lists->Pairs;
  std::vector<double> in(size * columns);
  std::vector<double> out(size * columns);
  std::vector<double> scratch;
  for (std::size_t first = block.FirstPair; first < block.LastPair;)
  {
    const int op = pairs[first].Operator;
    std::size_t last = first;
    for (; last < std::min(first + columns, block.LastPair) && pairs[last].Operator == op; ++last)
    {
      const std::int32_t* turned = this->Permutations[pairs[last].Symmetry].data();
      const double* multipole = this->Multipoles.data() + pairs[last].Source * size;
      double* column = in.data() + (last - first) * size;
      for (std::size_t k = 0; k < size; ++k)
      {
        column[turned[k]] = multipole[k];
      }
    }
    this->Far->Get(level, op).Apply(in.data(), static_cast<int>(last - first), out.data(), scratch);
    for (std::size_t p = first; p < last; ++p)
    {
      const std::int32_t slot = to.Slots[pairs[p].Target];
      if (slot < 0)
      {
        continue;
      }
      const std::int32_t* turned = this->Permutations[pairs[p].Symmetry].data();
      const double* column = out.data() + (p - first) * size;
      double* local = to.Locals.data() + slot * size;
      for (std::size_t k = 0; k < size; ++k)
      {
        local[k] += scale * column[turned[k]];
      }
    }
    first = last;
  }
}

template <int Dimension>
void FastRadialSum<Dimension>::PointsToLocal(int target, Interpolants& to) const
{
  const CellLists<std::int32_t>& lists = this->Lists->PointsToLocal;
  const CellTree<Dimension>& tree = this->GetTargets();
  const Cell& cell = tree.Cells[target];
  if (lists.Begin[target] == lists.Begin[target + 1] || to.Slots[target] < 0)
  {
    return;
  }
  const int size = this->Far->GetSize();
  NodeLattice<Dimension> nodes;
  nodes.Set(
    this->Far->GetBasis().GetRoots(), tree.GetCellSize(cell.Level) / 2, tree.GetCenter(cell), size);
  double* local = to.Locals.data() + static_cast<std::size_t>(to.Slots[target]) * size;
  alignas(64) double sums[RadialBlock];
  for (std::size_t i = lists.Begin[target]; i < lists.Begin[target + 1]; ++i)
  {
    const Cell& source = this->Sources->Cells[lists.Items[i]];
    for (int first = 0; first < size; first += static_cast<int>(RadialBlock))
    {
      this->Loops.Sum(this->Sources->GetCoordinates(source.First),
        this->Weights.data() + source.First, source.Count, nodes.Get(first), sums);
      for (int k = 0; k < std::min(static_cast<int>(RadialBlock), size - first); ++k)
      {
        local[first + k] += sums[k];
      }
    }
  }
}

template <int Dimension>
void FastRadialSum<Dimension>::Across(Execution& execution, Interpolants& to) const
{
  execution.For(static_cast<std::int64_t>(this->Lists->Blocks.size()), 1,
    [&](std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t b = begin; b < end; ++b)
      {
        const typename InteractionLists<Dimension>::Block& block = this->Lists->Blocks[b];
        const auto first = to.Slots.begin();
        if (std::any_of(first + block.FirstTarget, first + block.LastTarget,
              [](std::int32_t slot) { return slot >= 0; }))
        {
          this->ApplyPairs(block, to);
        }
      }
    });
  if (!this->Lists->PointsToLocal.Items.empty())
  {
    execution.For(static_cast<std::int64_t>(to.Slots.size()), 16,
      [&](std::int64_t begin, std::int64_t end)
      {
        for (std::int64_t t = begin; t < end; ++t)
        {
          this->PointsToLocal(static_cast<int>(t), to);
        }
      });
  }
}

template <int Dimension>
void FastRadialSum<Dimension>::Downward(Execution& execution, Interpolants& to) const
{
  const CellTree<Dimension>& tree = this->GetTargets();
  const auto size = static_cast<std::size_t>(this->Far->GetSize());
  const ChebyshevBasis& basis = this->Far->GetBasis();
  const auto addParent = [&](std::int64_t begin, std::int64_t end)
  {
    std::vector<double> scratch;
    std::vector<double> moved(size);
    for (std::int64_t t = begin; t < end; ++t)
    {
      if (to.Slots[t] < 0)
      {
        continue;
      }
      const Cell& cell = tree.Cells[t];
      std::array<const double*, Dimension> halves;
      for (int c = 0; c < Dimension; ++c)
      {
        halves[c] = basis.GetHalfTransposed(static_cast<int>(cell.Index[c] & 1U));
      }
      TransformTensor<Dimension>(halves, RepeatSize<Dimension>(this->Order), this->Order,
        to.Locals.data() + to.Slots[cell.Parent] * size, moved.data(), scratch);
      double* local = to.Locals.data() + to.Slots[t] * size;
      for (std::size_t k = 0; k < size; ++k)
      {
        local[k] += moved[k];
      }
    }
  };
  for (int level = 3; level < tree.GetNumberOfLevels(); ++level)
  {
    this->ForCells(execution, tree.LevelBegin[level], tree.LevelBegin[level + 1], addParent);
  }
}

template class FastRadialSum<2>;
template class FastRadialSum<3>;

//------------------------------------------------------------------------------
// The order of interpolation that FastRadialSum needs for a tolerance, by the bound of its error.

//------------------------------------------------------------------------------
template <int Dimension>
void FastRadialSum<Dimension>::SumMagnitudes()
{
  const std::vector<Cell>& cells = this->Sources->Cells;
  for (std::size_t s = cells.size(); s-- > 0;)
  {
    double sum = 0;
    for (int child = 0; child < cells[s].Children; ++child)
    {
      sum += this->Magnitudes[cells[s].FirstChild + child];
    }
    for (std::int64_t i = 0; cells[s].Children == 0 && i < cells[s].Count; ++i)
    {
      sum += std::abs(this->Weights[cells[s].First + i]);
    }
    this->Magnitudes[s] = sum;
  }
}

template <int Dimension>
double FastRadialSum<Dimension>::GetSetUpEvaluations(int order) const
{
  // Errors are found from a few hundred samples of each operator's matrix.
  constexpr double perElement = 32;
  const auto operators = static_cast<double>(FarOffsets<Dimension>().GetCanonical().size());
  const auto levels =
    static_cast<double>(std::count(this->Levels.begin(), this->Levels.end(), char(1)));
  return perElement * operators * levels * std::pow(order, 2 * Dimension);
}

template <int Dimension>
FarField<Dimension>& FastRadialSum<Dimension>::GetFarField(Execution& execution, int order)
{
  std::unique_ptr<FarField<Dimension>>& far = this->FarFields[order];
  if (!far)
  {
    far = std::make_unique<FarField<Dimension>>(
      execution, this->Kernel, order, this->Sources->Root.Size, this->Levels);
  }
  return *far;
}

template <int Dimension>
double FastRadialSum<Dimension>::GetBound(const FarField<Dimension>& far) const
{
  const std::vector<Cell>& targets = this->GetTargets().Cells;
  std::vector<double> bound(targets.size(), 0.0);
  const InteractionLists<Dimension>& lists = *this->Lists;
  for (const FarPair& pair : lists.Pairs)
  {
    bound[pair.Target] +=
      this->Magnitudes[pair.Source] * far.GetError(targets[pair.Target].Level, pair.Operator);
  }
  double largest = 0;
  for (std::size_t t = 0; t < targets.size(); ++t)
  {
    for (std::size_t i = lists.PointsToLocal.Begin[t]; i < lists.PointsToLocal.Begin[t + 1]; ++i)
    {
      bound[t] +=
        this->Magnitudes[lists.PointsToLocal.Items[i]] * far.GetLargestError(targets[t].Level);
    }
    for (std::size_t i = lists.MultipolesToPoints.Begin[t];
         i < lists.MultipolesToPoints.Begin[t + 1]; ++i)
    {
      const std::int32_t s = lists.MultipolesToPoints.Items[i];
      bound[t] += this->Magnitudes[s] * far.GetLargestError(this->Sources->Cells[s].Level);
    }
    bound[t] += targets[t].Parent >= 0 ? bound[targets[t].Parent] : 0;
    largest = std::max(largest, bound[t]);
  }
  return largest;
}

template <int Dimension>
double FastRadialSum<Dimension>::ChooseOrder(Execution& execution, double tolerance, int maximum)
{
  if (!(tolerance > 0))
  {
    throw std::invalid_argument("the tolerance of a sum must be above 0");
  }
  const auto bound = [&](int order) { return this->GetBound(this->GetFarField(execution, order)); };
  // From the order of the sum before, upwards by steps that the rate of convergence suggests.
  int order = std::min(std::max(this->Order, 4), maximum);
  double error = bound(order);
  while (error > tolerance && order < maximum)
  {
    const double steps = std::floor(0.7 * std::log(error / tolerance));
    order =
      static_cast<int>(std::min<double>(maximum, order + std::min(std::max(steps, 1.0), 6.0)));
    error = bound(order);
  }
  while (error <= tolerance && order > 2)
  {
    const double lower = bound(order - 1);
    if (lower > tolerance)
    {
      break;
    }
    --order;
    error = lower;
  }
  if (order != this->Order || this->Permutations.empty())
  {
    this->Permutations.clear();
    for (int symmetry = 0; symmetry < FarOffsets<Dimension>::Symmetries; ++symmetry)
    {
      this->Permutations.push_back(FarOffsets<Dimension>::GetPermutation(symmetry, order));
    }
  }
  this->Order = order;
  this->FarFields[order]->MakeOperators(execution);
  this->Far = this->FarFields[order].get();
  return error;
}

template void FastRadialSum<2>::SumMagnitudes();
template void FastRadialSum<3>::SumMagnitudes();
template double FastRadialSum<2>::GetSetUpEvaluations(int) const;
template double FastRadialSum<3>::GetSetUpEvaluations(int) const;
template double FastRadialSum<2>::ChooseOrder(Execution&, double, int);
template double FastRadialSum<3>::ChooseOrder(Execution&, double, int);
}
