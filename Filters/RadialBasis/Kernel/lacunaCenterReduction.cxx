// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaCenterReduction.h"

#include "lacunaExecution.h"
#include "lacunaNodePartition.h"
#include "lacunaPolynomialAnchors.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace lacuna
{
namespace
{
// How many centres one starts with, and how many are added to those there are.
constexpr std::size_t Start = 50;
constexpr double Growth = 0.5;
// So few nodes that are too far off, compared with the centres, are added at once.
constexpr double Rest = 0.05;
// Parts of the tolerance that fits and sums may be wrong by.
constexpr double FitPart = 0.2;
constexpr double SumPart = 0.05;

template <int Dimension>
class Reduction
{
public:
  using Point = std::array<double, Dimension>;

  Reduction(const std::vector<Point>& nodes, const std::vector<std::vector<double>>& values,
    RadialBasisOptions options, double tolerance)
    : Options(std::move(options))
    , Tolerance(tolerance)
  {
    if (!(tolerance > 0) || !std::isfinite(tolerance))
    {
      throw std::invalid_argument("the tolerance of centres must be a finite number above 0");
    }
    if (!this->Options.Errors.empty())
    {
      throw std::invalid_argument("errors of values cannot be given when centres are reduced");
    }
    this->Distinct = FindDistinctNodes<Dimension>(nodes, values, Dimension + 1);
    for (const std::size_t i : this->Distinct)
    {
      this->Nodes.push_back(nodes[i]);
    }
    double range = 0;
    for (const std::vector<double>& list : values)
    {
      this->Values.emplace_back();
      for (const std::size_t i : this->Distinct)
      {
        this->Values.back().push_back(list[i]);
      }
      const auto ends = std::minmax_element(this->Values.back().begin(), this->Values.back().end());
      range = std::max(range, *ends.second - *ends.first);
    }
    if (this->Options.Accuracy > 0 && range > 0)
    {
      this->Options.Accuracy = std::min(this->Options.Accuracy, FitPart * tolerance / range);
    }
    this->Choose();
  }

  ReducedCenters<Dimension> Run(Execution& execution)
  {
    const Execution::NestedStages stages(execution);
    double progress = 0;
    while (true)
    {
      // The number of rounds is not known; each takes longer than the one before.
      const double next = 1 - 0.8 * (1 - progress);
      execution.SetStage(progress, 0.5 * (progress + next));
      const std::shared_ptr<const RadialBasis<Dimension>> function = this->Fit(execution);
      execution.SetStage(0.5 * (progress + next), next);
      progress = next;
      const double worst = this->FindErrors(execution, *function);
      if (worst <= this->Tolerance)
      {
        ReducedCenters<Dimension> result;
        for (std::size_t i = 0; i < this->Nodes.size(); ++i)
        {
          if (this->Chosen[i])
          {
            result.Indices.push_back(this->Distinct[i]);
          }
        }
        result.NodeCount = this->Nodes.size();
        result.Residual = worst;
        result.Function = function;
        return result;
      }
      if (!this->Add(worst))
      {
        std::ostringstream message;
        message << "with " << function->GetReport().NodeCount
                << " centres values are still missed by up to " << worst
                << ", more than the tolerance " << this->Tolerance << "; raise it"
                << (this->Options.Smoothing > 0 ? ", or lower the smoothing" : "");
        throw std::runtime_error(message.str());
      }
    }
  }

private:
  NodePartition<Dimension> Divide(std::size_t groups) const
  {
    const std::size_t size = std::max<std::size_t>(1, this->Nodes.size() / groups);
    return NodePartition<Dimension>(this->Nodes, static_cast<int>(size));
  }

  // Nodes spread evenly, and a few that determine the polynomial if any do.
  void Choose()
  {
    this->Chosen.assign(this->Nodes.size(), 0);
    for (const std::uint32_t i : this->Divide(Start).GetRepresentatives())
    {
      this->Chosen[i] = 1;
    }
    const RadialFrame<Dimension> frame =
      FindRadialFrame<Dimension>(this->Nodes, this->Options.Kernel, this->Options.Shape);
    RadialPolynomial<Dimension> polynomial;
    polynomial.Degree = GetRadialDegree(this->Options.Kernel);
    polynomial.Length = frame.Length;
    std::vector<Point> scaled;
    scaled.reserve(this->Nodes.size());
    for (const Point& node : this->Nodes)
    {
      scaled.push_back(frame.ToScaled(node));
    }
    CheckSpread<Dimension>(scaled, polynomial);
    const PolynomialAnchors<Dimension> anchors(scaled, polynomial);
    for (const std::size_t i : anchors.GetNodes())
    {
      this->Chosen[i] = 1;
    }
  }

  std::shared_ptr<const RadialBasis<Dimension>> Fit(Execution& execution) const
  {
    std::vector<Point> centers;
    std::vector<std::vector<double>> at(this->Values.size());
    for (std::size_t i = 0; i < this->Nodes.size(); ++i)
    {
      if (this->Chosen[i])
      {
        centers.push_back(this->Nodes[i]);
        for (std::size_t k = 0; k < at.size(); ++k)
        {
          at[k].push_back(this->Values[k][i]);
        }
      }
    }
    return std::make_shared<const RadialBasis<Dimension>>(execution, centers, at, this->Options);
  }

  // Of each node the largest of all components. Returns the largest of all.
  double FindErrors(Execution& execution, const RadialBasis<Dimension>& function)
  {
    this->Errors.assign(this->Nodes.size(), 0);
    std::vector<double> fit;
    const Execution::NestedStages stages(execution);
    const auto count = static_cast<double>(this->Values.size());
    for (std::size_t k = 0; k < this->Values.size(); ++k)
    {
      execution.SetStage(static_cast<double>(k) / count, static_cast<double>(k + 1) / count);
      const double bound = function.EvaluateWithin(
        execution, SumPart * this->Tolerance, this->Nodes, fit, static_cast<int>(k));
      for (std::size_t i = 0; i < this->Nodes.size(); ++i)
      {
        this->Errors[i] = std::max(this->Errors[i], std::abs(fit[i] - this->Values[k][i]) + bound);
      }
    }
    return *std::max_element(this->Errors.begin(), this->Errors.end());
  }

  // The worst node of each of many groups, if it is too far off; in the end all that are
  bool Add(double worst)
  {
    const auto chosen =
      static_cast<double>(std::count(this->Chosen.begin(), this->Chosen.end(), 1));
    const auto off = static_cast<double>(std::count_if(this->Errors.begin(), this->Errors.end(),
      [this](double error) { return error > this->Tolerance; }));
    const bool atOnce = off <= Rest * chosen;
    const double limit = atOnce ? this->Tolerance : std::max(this->Tolerance, 0.1 * worst);
    bool added = false;
    const auto add = [&](std::size_t i)
    {
      if (this->Errors[i] > limit && !this->Chosen[i])
      {
        this->Chosen[i] = 1;
        added = true;
      }
    };
    if (atOnce)
    {
      for (std::size_t i = 0; i < this->Nodes.size(); ++i)
      {
        add(i);
      }
      return added;
    }
    const NodePartition<Dimension> partition =
      this->Divide(static_cast<std::size_t>(Growth * chosen) + 1);
    for (std::size_t g = 0; g < partition.GetNumberOfGroups(); ++g)
    {
      const std::vector<std::uint32_t> group = partition.GetGroup(g);
      add(*std::max_element(group.begin(), group.end(),
        [&](std::uint32_t a, std::uint32_t b) { return this->Errors[a] < this->Errors[b]; }));
    }
    return added;
  }

  RadialBasisOptions Options;
  double Tolerance;
  std::vector<std::size_t> Distinct; // indices as they were given
  std::vector<Point> Nodes;
  std::vector<std::vector<double>> Values;
  std::vector<char> Chosen;
  std::vector<double> Errors;
};
}

//------------------------------------------------------------------------------
template <int Dimension>
ReducedCenters<Dimension> ReduceCenters(Execution& execution,
  const std::vector<std::array<double, Dimension>>& nodes,
  const std::vector<std::vector<double>>& values, const RadialBasisOptions& options,
  double tolerance)
{
  return Reduction<Dimension>(nodes, values, options, tolerance).Run(execution);
}

template ReducedCenters<2> ReduceCenters<2>(Execution&, const std::vector<std::array<double, 2>>&,
  const std::vector<std::vector<double>>&, const RadialBasisOptions&, double);
template ReducedCenters<3> ReduceCenters<3>(Execution&, const std::vector<std::array<double, 3>>&,
  const std::vector<std::vector<double>>&, const RadialBasisOptions&, double);
}
