// SPDX-License-Identifier: BSD-3-Clause
// The order of interpolation that FastRadialSum needs for a tolerance, by the bound of its error.
#include "lacunaFastRadialSum.h"

#include "lacunaExecution.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>

namespace lacuna
{
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
