// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSpeckleFilter.h"

#include "lacunaAdaptiveMedian.h"
#include "lacunaMemory.h"
#include "lacunaParameterText.h"
#include "lacunaScalarType.h"

#include <cmath>
#include <stdexcept>
#include <string>

namespace lacuna
{
namespace
{
/// One erosion (Least) or dilation of a chain.
struct MorphologyStep
{
  Extreme Which;
  bool Reflected;
};

/// The chain of an operation; empty when it is not a morphological one. In openings and closings
/// the dilation uses the reflected window, so that windows of even size shift nothing.
std::vector<MorphologyStep> StepsOf(SpeckleOperation operation)
{
  constexpr MorphologyStep Erode{ Extreme::Least, false };
  constexpr MorphologyStep Dilate{ Extreme::Greatest, true };
  switch (operation)
  {
    case SpeckleOperation::Minimum:
      return { Erode };
    case SpeckleOperation::Maximum:
      return { { Extreme::Greatest, false } };
    case SpeckleOperation::Opening:
      return { Erode, Dilate };
    case SpeckleOperation::Closing:
      return { Dilate, Erode };
    case SpeckleOperation::OpenClose:
      return { Erode, Dilate, Dilate, Erode };
    case SpeckleOperation::CloseOpen:
      return { Dilate, Erode, Erode, Dilate };
    default:
      return {};
  }
}

Window WindowOf(const SpeckleParameters& parameters)
{
  const bool box = parameters.Operation == SpeckleOperation::Mean;
  return Window(parameters.KernelSize, box ? WindowShape::Box : parameters.Shape);
}

Deviations DeviationsOf(const SpeckleParameters& parameters)
{
  if (!(parameters.StandardDeviation > 0) || !std::isfinite(parameters.StandardDeviation))
  {
    throw std::invalid_argument("the standard deviation is " +
      FormatNumber(parameters.StandardDeviation) + " mm; it must be above 0");
  }
  Deviations deviations{};
  for (int a = 0; a < 3; ++a)
  {
    if (!(parameters.Spacing[a] > 0) || !std::isfinite(parameters.Spacing[a]))
    {
      throw std::invalid_argument("the spacing of the image along axis " + std::to_string(a) +
        " is " + FormatNumber(parameters.Spacing[a]) + " mm; it must be above 0");
    }
    deviations[a] =
      parameters.KernelSize[a] > 1 ? parameters.StandardDeviation / parameters.Spacing[a] : 0;
  }
  return deviations;
}

template <class T>
void FilterMorphology(const ImageView<const T>& input, const ImageView<T>& output,
  const Window& window, const std::vector<MorphologyStep>& steps, VectorUnit set,
  Execution& execution)
{
  const auto windowOf = [&](const MorphologyStep& step)
  { return step.Reflected ? window.Reflect() : window; };
  // What each step must make for the ones after it.
  std::vector<Extent> boxes(steps.size(), output.Box);
  for (std::size_t i = steps.size() - 1; i-- > 0;)
  {
    boxes[i] = Intersect(windowOf(steps[i + 1]).Grow(boxes[i + 1]), input.Box);
  }
  std::vector<T> last;
  std::vector<T> next;
  const Execution::NestedStages stages(execution);
  ImageView<const T> from = input;
  for (std::size_t i = 0; i < steps.size(); ++i)
  {
    const auto count = static_cast<double>(steps.size());
    execution.SetStage(static_cast<double>(i) / count, static_cast<double>(i + 1) / count);
    const bool final = i + 1 == steps.size();
    const std::int64_t samples = final ? 0 : NumberOfSamples(boxes[i]);
    RequireMemory("the image between two steps of the filter",
      static_cast<double>(sizeof(T)) * static_cast<double>(samples));
    next.resize(samples);
    const ImageView<T> to = final ? output : ImageView<T>(next.data(), boxes[i]);
    FilterExtreme(from, to, windowOf(steps[i]), steps[i].Which, set, execution);
    last.swap(next);
    from = ImageView<const T>(last.data(), boxes[i]);
  }
}
}

Extent GetSpeckleInput(const SpeckleParameters& parameters, const Extent& box)
{
  switch (parameters.Operation)
  {
    case SpeckleOperation::Gaussian:
      return GaussianReach(DeviationsOf(parameters)).Grow(box, true, true);
    case SpeckleOperation::LaplacianOfGaussian:
      return LaplacianReach(DeviationsOf(parameters)).Grow(box, true, true);
    default:
      break;
  }
  if (parameters.Operation == SpeckleOperation::Rank &&
    !(parameters.Percentile >= 0 && parameters.Percentile <= 100))
  {
    throw std::invalid_argument("the rank is " + FormatNumber(parameters.Percentile) +
      "; it must be a percentile from 0 (the least) to 100 (the greatest)");
  }
  const Window window = WindowOf(parameters);
  const std::vector<MorphologyStep> steps = StepsOf(parameters.Operation);
  if (steps.empty())
  {
    return window.Grow(box);
  }
  Extent grown = box;
  for (const MorphologyStep& step : steps)
  {
    grown = (step.Reflected ? window.Reflect() : window).Grow(grown);
  }
  return grown;
}

template <class T>
void FilterSpeckle(const ImageView<const T>& input, const ImageView<T>& output,
  const SpeckleParameters& parameters, Execution& execution)
{
  GetSpeckleInput(parameters, output.Box); // checks the parameters
  if (parameters.Operation == SpeckleOperation::Gaussian)
  {
    return FilterGaussian(input, output, DeviationsOf(parameters), parameters.Set, execution);
  }
  const Window window = WindowOf(parameters);
  const std::vector<MorphologyStep> steps = StepsOf(parameters.Operation);
  if (!steps.empty())
  {
    return FilterMorphology(input, output, window, steps, parameters.Set, execution);
  }
  RankParameters rank;
  rank.Set = parameters.Set;
  switch (parameters.Operation)
  {
    case SpeckleOperation::Median:
      return FilterRank(input, output, window, rank, execution);
    case SpeckleOperation::Mode:
      rank.Mode = true;
      return FilterRank(input, output, window, rank, execution);
    case SpeckleOperation::Rank:
      rank.Percentile = parameters.Percentile;
      return FilterRank(input, output, window, rank, execution);
    case SpeckleOperation::AdaptiveMedian:
      return FilterAdaptiveMedian(input, output, window, parameters.AdaptiveStrength, execution);
    case SpeckleOperation::Mean:
      return FilterMean(input, output, window, parameters.Set, execution);
    default:
      throw std::invalid_argument("not an operation that keeps the type of the samples");
  }
}

template <class T>
void FilterSpeckleLaplacian(const ImageView<const T>& input,
  const ImageView<LaplacianType<T>>& output, const SpeckleParameters& parameters,
  Execution& execution)
{
  FilterLaplacianOfGaussian(
    input, output, DeviationsOf(parameters), parameters.Spacing, parameters.Set, execution);
}

// NOLINTBEGIN(bugprone-macro-parentheses): T is a type
#define LACUNA_INSTANTIATE(T)                                                                      \
  template void FilterSpeckle(                                                                     \
    const ImageView<const T>&, const ImageView<T>&, const SpeckleParameters&, Execution&);         \
  template void FilterSpeckleLaplacian(const ImageView<const T>&,                                  \
    const ImageView<LaplacianType<T>>&, const SpeckleParameters&, Execution&);
// NOLINTEND(bugprone-macro-parentheses)
LACUNA_FOR_EACH_SCALAR(LACUNA_INSTANTIATE)
}
