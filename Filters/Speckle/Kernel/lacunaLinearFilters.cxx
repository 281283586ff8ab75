// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaLinearFilters.h"

#include "lacunaMemory.h"
#include "lacunaOrderedKey.h"
#include "lacunaParameterText.h"
#include "lacunaScalarType.h"

#include <atomic>
#include <cmath>
#include <stdexcept>
#include <string>

namespace lacuna
{
namespace
{
__extension__ using Wide = unsigned __int128;

/// To[i] += From[i], i < Count. From may overlap To from behind (From >= To).
template <class S>
struct AddShifted
{
  S* To;
  const S* From;
  std::int64_t Count;

  template <int Bytes>
  static LACUNA_INLINE void Run(const AddShifted& a)
  {
    std::int64_t i = 0;
    if constexpr (sizeof(S) <= 8)
    {
      using V = typename Vector<S, Bytes>::Type;
      constexpr int Lanes = Vector<S, Bytes>::Lanes;
      for (; i + Lanes <= a.Count; i += Lanes)
      {
        V to, from;
        LoadVector(to, a.To + i);
        LoadVector(from, a.From + i);
        to += from;
        StoreVector(a.To + i, to);
      }
    }
    for (; i < a.Count; ++i)
    {
      a.To[i] += a.From[i];
    }
  }
};

/// Sums of windows from sums of 1, 2, 4, ... samples: nothing is ever subtracted, so a large or
/// infinite sample leaves no trace beyond its windows.
template <class S>
struct BoxSum
{
  std::array<int, 3> Size;
  VectorUnit Set;

  void operator()(
    int axis, S* data, std::int64_t count, std::int64_t shift, std::vector<S>& spare) const
  {
    const int length = this->Size[axis];
    spare.assign(count, S(0));
    int covered = 0;
    for (int power = 1; power <= length; power *= 2)
    {
      if (length & power)
      {
        this->Add(spare.data(), data + covered * shift, count);
        covered += power;
      }
      if (2 * power <= length)
      {
        this->Add(data, data + power * shift, count + (length - 2 * power) * shift);
      }
    }
    std::copy(spare.begin(), spare.end(), data);
  }

private:
  void Add(S* to, const S* from, std::int64_t count) const
  {
    AddShifted<S> add{ to, from, count };
    RunWith<AddShifted<S>>(this->Set, add);
  }
};

/// Symmetric convolution.
template <class S>
struct ConvolveShifted
{
  const S* From;
  S* To;
  std::int64_t Count;
  std::int64_t Shift;
  const S* Weights; ///< the first half and the middle one
  int Radius;

  template <int Bytes>
  static LACUNA_INLINE void Run(const ConvolveShifted& c)
  {
    using V = typename Vector<S, Bytes>::Type;
    constexpr int Lanes = Vector<S, Bytes>::Lanes;
    constexpr int Unrolled = 4; // sums on their way at once
    const std::int64_t span = 2 * c.Shift * c.Radius;
    std::int64_t i = 0;
    constexpr std::int64_t Step = std::int64_t(Unrolled) * Lanes;
    for (; i + Step <= c.Count; i += Step)
    {
      V sum[Unrolled];
      for (int u = 0; u < Unrolled; ++u)
      {
        LoadVector(sum[u], c.From + i + std::int64_t(u) * Lanes + c.Radius * c.Shift);
        sum[u] *= c.Weights[c.Radius];
      }
      const S* low = c.From + i;
      const S* high = low + span;
      for (int j = 0; j < c.Radius; ++j, low += c.Shift, high -= c.Shift)
      {
        for (int u = 0; u < Unrolled; ++u)
        {
          V a, b;
          LoadVector(a, low + std::int64_t(u) * Lanes);
          LoadVector(b, high + std::int64_t(u) * Lanes);
          sum[u] += c.Weights[j] * (a + b);
        }
      }
      for (int u = 0; u < Unrolled; ++u)
      {
        StoreVector(c.To + i + std::int64_t(u) * Lanes, sum[u]);
      }
    }
    for (; i < c.Count; ++i)
    {
      S sum = c.From[i + c.Radius * c.Shift] * c.Weights[c.Radius];
      for (int j = 0; j < c.Radius; ++j)
      {
        sum += c.Weights[j] * (c.From[i + j * c.Shift] + c.From[i + span - j * c.Shift]);
      }
      c.To[i] = sum;
    }
  }
};

template <class S>
struct Convolution
{
  std::array<std::vector<S>, 3> Weights; ///< the first half and the middle one
  VectorUnit Set;

  void operator()(
    int axis, S* data, std::int64_t count, std::int64_t shift, std::vector<S>& spare) const
  {
    const std::vector<S>& weights = this->Weights[axis];
    spare.resize(count);
    ConvolveShifted<S> c{ data, spare.data(), count, shift, weights.data(),
      static_cast<int>(weights.size()) - 1 };
    RunWith<ConvolveShifted<S>>(this->Set, c);
    std::copy(spare.begin(), spare.end(), data);
  }
};

template <class T>
bool AnyNaN(const ImageView<const T>& input, Execution& execution)
{
  if constexpr (std::is_floating_point_v<T>)
  {
    std::atomic<bool> found(false);
    execution.For(SizeOf(input.Box, 2), 1,
      [&](std::int64_t begin, std::int64_t end)
      {
        for (std::int64_t k = begin; k < end; ++k)
        {
          bool nan = false;
          for (int y = input.Box[2]; y <= input.Box[3]; ++y)
          {
            const T* row = input.At(input.Box[0], y, input.Box[4] + static_cast<int>(k));
            for (std::int64_t i = 0; i < SizeOf(input.Box, 0); ++i)
            {
              nan |= row[i * input.Stride[0]] != row[i * input.Stride[0]];
            }
          }
          if (nan)
          {
            found = true;
          }
        }
      });
    return found;
  }
  return false;
}

template <class T, class Quotient>
T RoundTo(Quotient value)
{
  if constexpr (std::is_floating_point_v<T>)
  {
    return static_cast<T>(value);
  }
  else
  {
    // A weighted mean of T lies in T's range, but its rounding may be just out of it.
    const Quotient shifted = value + Quotient(0.5);
    if constexpr (sizeof(T) <= 2)
    {
      const int whole = static_cast<int>(shifted); // towards 0; std::floor is a call without SSE4
      return static_cast<T>(std::min<int>(
        whole - (static_cast<Quotient>(whole) > shifted), std::numeric_limits<T>::max()));
    }
    else
    {
      const Quotient rounded = std::floor(shifted);
      return rounded >= static_cast<Quotient>(std::numeric_limits<T>::max())
        ? std::numeric_limits<T>::max()
        : static_cast<T>(rounded);
    }
  }
}

/// Mean of integers by sums S of their keys, which must hold (n + 1) times the greatest key.
template <class S, class T>
void FilterIntegerMean(const ImageView<const T>& input, const ImageView<T>& output,
  const Window& window, VectorUnit set, Execution& execution)
{
  using Key = KeyOf<T>;
  const S n = static_cast<S>(window.GetNumberOfSamples());
  SeparableSteps<S> steps;
  steps.Load = [&](const Extent& box, S* to)
  {
    CopyReplicated(
      input, box, to, [](T value) { return static_cast<S>(OrderedKey<T>::From(value)); });
  };
  steps.Along = BoxSum<S>{ window.GetSize(), set };
  steps.Store = [&](const S* row, int x0, int x1, int y, int z)
  {
    T* to = output.At(x0, y, z);
    for (int i = 0; i <= x1 - x0; ++i)
    {
      // Rounds halves up. A correctly rounded quotient of whole numbers below 2^53 is not below
      // a whole number when the true quotient is not, so division in double is exact here.
      Key key;
      if constexpr (sizeof(S) == 4)
      {
        key = static_cast<Key>(static_cast<std::int32_t>(
          static_cast<double>(static_cast<std::int32_t>(row[i] + n / 2)) / static_cast<double>(n)));
      }
      else
      {
        key = static_cast<Key>((row[i] + n / 2) / n);
      }
      to[i * output.Stride[0]] = OrderedKey<T>::To(key);
    }
  };
  FilterSeparably(input.Box, output.Box, Reach(window), steps, execution);
}

/// Weighted means with NaN left out: sums of samples and of weights, NaN counting as 0, by along.
template <class S, class T, class Along>
void FilterNumbers(const ImageView<const T>& input, const ImageView<T>& output, const Reach& reach,
  const Along& along, S total, Execution& execution)
{
  const Execution::NestedStages stages(execution);
  execution.SetStage(0, 0.1);
  const bool nan = AnyNaN(input, execution);
  const std::int64_t weightCount = nan ? NumberOfSamples(output.Box) : 0;
  RequireMemory("the weights of samples that are numbers",
    static_cast<double>(sizeof(S)) * static_cast<double>(weightCount));
  std::vector<S> weightMemory(weightCount);
  const ImageView<S> weightView(weightMemory.data(), output.Box);
  SeparableSteps<S> steps;
  steps.Along = along;
  if constexpr (std::is_floating_point_v<T>)
  {
    if (nan)
    {
      execution.SetStage(0.1, 0.5);
      steps.Load = [&](const Extent& box, S* to)
      { CopyReplicated(input, box, to, [](T value) { return S(value == value ? 1 : 0); }); };
      steps.Store = [&](const S* row, int x0, int x1, int y, int z)
      { std::copy(row, row + (x1 - x0 + 1), weightView.At(x0, y, z)); };
      FilterSeparably(input.Box, output.Box, reach, steps, execution);
    }
  }
  execution.SetStage(nan ? 0.5 : 0.1, 1);
  steps.Load = [&](const Extent& box, S* to)
  {
    CopyReplicated(
      input, box, to, [](T value) { return value == value ? static_cast<S>(value) : S(0); });
  };
  steps.Store = [&](const S* row, int x0, int x1, int y, int z)
  {
    T* to = output.At(x0, y, z);
    const std::int64_t step = output.Stride[0];
    if (!nan)
    {
      for (int i = 0; i <= x1 - x0; ++i)
      {
        to[i * step] = RoundTo<T>(total == S(1) ? row[i] : row[i] / total);
      }
      return;
    }
    if constexpr (std::is_floating_point_v<T>)
    {
      const T* centre = input.At(x0, y, z);
      const S* weights = weightView.At(x0, y, z);
      for (int i = 0; i <= x1 - x0; ++i)
      {
        // Weights in reach of no NaN add up to the total but for rounding, which must not make a
        // difference between an image with NaN elsewhere and one without.
        const bool whole =
          std::abs(weights[i] - total) <= 64 * std::numeric_limits<S>::epsilon() * total;
        const S weight = whole ? total : weights[i];
        const T original = centre[i * input.Stride[0]];
        to[i * step] =
          original == original ? RoundTo<T>(weight == S(1) ? row[i] : row[i] / weight) : original;
      }
    }
  };
  FilterSeparably(input.Box, output.Box, reach, steps, execution);
}

template <class S>
std::vector<S> FirstHalf(const std::vector<double>& weights)
{
  return { weights.begin(), weights.begin() + (weights.size() + 1) / 2 };
}

Reach ReachOf(const Deviations& deviations, double factor, int least)
{
  std::array<int, 3> radii{};
  for (int a = 0; a < 3; ++a)
  {
    const double radius = factor * deviations[a] + 0.5;
    if (!(deviations[a] >= 0) || !(radius < MaximumGaussianRadius + 1))
    {
      throw std::invalid_argument("the standard deviation is " + FormatNumber(deviations[a]) +
        " samples along axis " + std::to_string(a) + "; it must be 0 to " +
        std::to_string(static_cast<int>(MaximumGaussianRadius / factor)));
    }
    radii[a] = deviations[a] > 0 ? std::max(least, static_cast<int>(radius)) : 0;
  }
  return Reach(radii);
}
}

template <class T>
void FilterMean(const ImageView<const T>& input, const ImageView<T>& output, const Window& window,
  VectorUnit set, Execution& execution)
{
  if constexpr (std::is_floating_point_v<T>)
  {
    FilterNumbers(input, output, Reach(window), BoxSum<double>{ window.GetSize(), set },
      static_cast<double>(window.GetNumberOfSamples()), execution);
  }
  else if constexpr (sizeof(T) == 8)
  {
    FilterIntegerMean<Wide>(input, output, window, set, execution);
  }
  else if (static_cast<double>(std::numeric_limits<KeyOf<T>>::max()) *
      static_cast<double>(window.GetNumberOfSamples() + 1) <
    2147483648.0)
  {
    FilterIntegerMean<std::uint32_t>(input, output, window, set, execution);
  }
  else
  {
    FilterIntegerMean<std::uint64_t>(input, output, window, set, execution);
  }
}

Reach GaussianReach(const Deviations& deviations)
{
  return ReachOf(deviations, 4, 0);
}

Reach LaplacianReach(const Deviations& deviations)
{
  return ReachOf(deviations, 6, 2);
}

std::vector<double> GaussianWeights(double deviation, int radius)
{
  // Narrower ones are the same impulse, but their squares and exponentials vanish.
  const double s = std::max(deviation, 0.05);
  std::vector<double> weights(std::size_t(2) * radius + 1);
  double sum = 0;
  for (int i = -radius; i <= radius; ++i)
  {
    weights[i + radius] = radius > 0 ? std::exp(-0.5 * i * i / (s * s)) : 1;
    sum += weights[i + radius];
  }
  for (double& w : weights)
  {
    w /= sum;
  }
  return weights;
}

std::vector<double> SecondDerivativeWeights(double deviation, int radius)
{
  // With the sum taken away, (i^2 / s^4 - 1 / s^2) g leaves (i^2 - the variance of g) g / s^4.
  std::vector<double> weights = GaussianWeights(deviation, radius);
  double variance = 0;
  for (int i = -radius; i <= radius; ++i)
  {
    variance += weights[i + radius] * i * i;
  }
  double moment = 0;
  for (int i = -radius; i <= radius; ++i)
  {
    weights[i + radius] *= i * i - variance;
    moment += weights[i + radius] * i * i;
  }
  for (double& w : weights)
  {
    w *= 2 / moment;
  }
  return weights;
}

template <class T>
void FilterGaussian(const ImageView<const T>& input, const ImageView<T>& output,
  const Deviations& deviations, VectorUnit set, Execution& execution)
{
  using S = LinearType<T>;
  const Reach reach = GaussianReach(deviations);
  Convolution<S> convolution;
  convolution.Set = set;
  for (int a = 0; a < 3; ++a)
  {
    convolution.Weights[a] = FirstHalf<S>(GaussianWeights(deviations[a], reach.Lower[a]));
  }
  FilterNumbers(input, output, reach, convolution, S(1), execution);
}

template <class T>
void FilterLaplacianOfGaussian(const ImageView<const T>& input,
  const ImageView<LaplacianType<T>>& output, const Deviations& deviations,
  const std::array<double, 3>& spacing, VectorUnit set, Execution& execution)
{
  using S = LinearType<T>;
  using Out = LaplacianType<T>;
  const Reach reach = LaplacianReach(deviations);
  const Execution::NestedStages stages(execution);
  bool first = true;
  for (int axis = 0; axis < 3; ++axis)
  {
    execution.SetStage(axis / 3.0, (axis + 1) / 3.0);
    if (!reach.Along(axis))
    {
      continue;
    }
    Convolution<S> convolution;
    convolution.Set = set;
    for (int a = 0; a < 3; ++a)
    {
      std::vector<double> weights = a == axis
        ? SecondDerivativeWeights(deviations[a], reach.Lower[a])
        : GaussianWeights(deviations[a], reach.Lower[a]);
      for (double& w : weights)
      {
        w /= a == axis ? spacing[a] * spacing[a] : 1;
      }
      convolution.Weights[a] = FirstHalf<S>(weights);
    }
    SeparableSteps<S> steps;
    steps.Load = [&](const Extent& box, S* to)
    { CopyReplicated(input, box, to, [](T value) { return static_cast<S>(value); }); };
    steps.Along = convolution;
    steps.Store = [&](const S* row, int x0, int x1, int y, int z)
    {
      for (int x = x0; x <= x1; ++x)
      {
        Out& out = *output.At(x, y, z);
        out = static_cast<Out>(first ? row[x - x0] : out + row[x - x0]);
      }
    };
    FilterSeparably(input.Box, output.Box, reach, steps, execution);
    first = false;
  }
  if (first)
  {
    throw std::invalid_argument("the Laplacian of Gaussian needs a standard deviation above 0");
  }
}

// NOLINTBEGIN(bugprone-macro-parentheses): T is a type
#define LACUNA_INSTANTIATE(T)                                                                      \
  template void FilterMean(                                                                        \
    const ImageView<const T>&, const ImageView<T>&, const Window&, VectorUnit, Execution&);        \
  template void FilterGaussian(                                                                    \
    const ImageView<const T>&, const ImageView<T>&, const Deviations&, VectorUnit, Execution&);    \
  template void FilterLaplacianOfGaussian(const ImageView<const T>&,                               \
    const ImageView<LaplacianType<T>>&, const Deviations&, const std::array<double, 3>&,           \
    VectorUnit, Execution&);
// NOLINTEND(bugprone-macro-parentheses)
LACUNA_FOR_EACH_SCALAR(LACUNA_INSTANTIATE)
}
