// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSpeckleFilter.h"

#include "lacunaBlocks.h"
#include "lacunaMemory.h"
#include "lacunaOrderedKey.h"
#include "lacunaParameterText.h"
#include "lacunaRankBlocks.h"
#include "lacunaRankTile.h"
#include "lacunaScalarType.h"
#include "lacunaSeparable.h"

#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

namespace lacuna
{
namespace
{
constexpr double CentralWeight = 99;
constexpr ValueRange StrengthRange = ValueRange::AtLeast(0);

/// The samples of a window: how far from its corner in a block of given size, how far from its
/// centre.
struct Neighbours
{
  std::vector<std::ptrdiff_t> Offset;
  std::vector<double> Distance;
  std::vector<int> IndexAt; ///< by place in the window's box, x fastest; -1 outside of the window
  std::ptrdiff_t Centre;

  Neighbours(const Window& window, const int size[3])
    : IndexAt(std::size_t(window.GetSize(0)) * window.GetSize(1) * window.GetSize(2), -1)
  {
    const auto offset = [size](int x, int y, int z)
    { return (std::ptrdiff_t(z) * size[1] + y) * size[0] + x; };
    this->Centre = offset(window.Lower(0), window.Lower(1), window.Lower(2));
    for (const Window::Run& run : window.GetRuns())
    {
      for (int x = run.Begin; x < run.End; ++x)
      {
        this->IndexAt[(std::size_t(run.Z) * window.GetSize(1) + run.Y) * window.GetSize(0) + x] =
          static_cast<int>(this->Offset.size());
        this->Offset.push_back(offset(x, run.Y, run.Z));
        const double dx = x - window.Lower(0);
        const double dy = run.Y - window.Lower(1);
        const double dz = run.Z - window.Lower(2);
        this->Distance.push_back(std::sqrt(dx * dx + dy * dy + dz * dz));
      }
    }
  }
};

template <class T>
class BlockFilter
{
public:
  using Key = KeyOf<T>;

  BlockFilter(const ImageView<const T>& input, const ImageView<T>& output, const Window& window,
    double strength)
    : Input(input)
    , Output(output)
    , Shape(window)
    , Strength(strength)
  {
  }

  void Filter(const Extent& block)
  {
    const Extent grown = this->Shape.Grow(block);
    const int size[3] = { SizeOf(grown, 0), SizeOf(grown, 1), SizeOf(grown, 2) };
    this->Keys.resize(NumberOfSamples(grown));
    CopyReplicated(this->Input, grown, this->Keys.data(), OrderedKey<T>::From);
    this->Values.resize(this->Keys.size());
    std::transform(this->Keys.begin(), this->Keys.end(), this->Values.begin(),
      [](Key key) { return static_cast<double>(OrderedKey<T>::To(key)); });
    this->Tile.Assign(this->Keys.data(), size, std::is_floating_point_v<T>);
    const Neighbours neighbours(this->Shape, size);
    for (int z = block[4]; z <= block[5]; ++z)
    {
      for (int y = block[2]; y <= block[3]; ++y)
      {
        for (int x = block[0]; x <= block[1]; ++x)
        {
          const int corner[3] = { x - block[0], y - block[2], z - block[4] };
          *this->Output.At(x, y, z) = OrderedKey<T>::To(this->Find(neighbours, corner));
        }
      }
    }
  }

private:
  Key Find(const Neighbours& neighbours, const int corner[3])
  {
    const std::size_t first =
      (std::size_t(corner[2]) * this->Tile.Size[1] + corner[1]) * this->Tile.Size[0] + corner[0];
    const Key centre = this->Keys[first + neighbours.Centre];
    const std::size_t n = neighbours.Offset.size();
    const double c = this->Values[first + neighbours.Centre];
    if (c != c)
    {
      return centre;
    }
    // Differences from the centre, so that no digits cancel when values are large and alike.
    double count = 0;
    double sum = 0;
    double squares = 0;
    for (std::size_t i = 0; i < n; ++i)
    {
      const double d = this->Values[first + neighbours.Offset[i]] - c;
      if (!std::is_floating_point_v<T> || d == d)
      {
        count += 1;
        sum += d;
        squares += d * d;
      }
    }
    const double mean = c + sum / count;
    const double variance = std::max(0.0, (squares - sum * sum / count) / count);
    const double slope =
      variance > 0 && this->Strength > 0 ? this->Strength * variance / std::abs(mean) : 0;
    if (!std::isfinite(slope))
    {
      return centre;
    }

    this->Weights.resize(n);
    for (std::size_t i = 0; i < n; ++i)
    {
      const double w = CentralWeight - slope * neighbours.Distance[i] + 0.5;
      this->Weights[i] = w > 0 ? static_cast<int>(w) : 0;
    }
    this->Levels.assign(this->Tile.Levels, 0);
    std::int64_t total = 0;
    for (std::size_t i = 0; i < n; ++i)
    {
      const std::size_t at = first + neighbours.Offset[i];
      if (!std::is_floating_point_v<T> || this->Values[at] == this->Values[at])
      {
        this->Levels[this->Tile.Level[at]] += this->Weights[i];
        total += this->Weights[i];
      }
    }
    std::int64_t half = total / 2;
    int level = 0;
    while (half >= this->Levels[level])
    {
      half -= this->Levels[level++];
    }
    return this->Tile.GetKey(this->Tile.Exact ? static_cast<std::uint32_t>(level)
                                              : this->FindInLevel(neighbours, corner, level, half));
  }

  /// The first place of level at which the weights in the window exceed half.
  std::uint32_t FindInLevel(
    const Neighbours& neighbours, const int corner[3], int level, std::int64_t half) const
  {
    for (std::uint32_t place = this->Tile.First[level];; ++place)
    {
      std::size_t index = 0;
      bool inside = true;
      for (int a = 2; a >= 0; --a)
      {
        const int i = this->Tile.Position[a][place] - corner[a];
        inside = inside && i >= 0 && i < this->Shape.GetSize(a);
        index = index * this->Shape.GetSize(a) + i;
      }
      const int neighbour = inside ? neighbours.IndexAt[index] : -1;
      if (neighbour >= 0)
      {
        half -= this->Weights[neighbour];
        if (half < 0)
        {
          return place;
        }
      }
    }
  }

  const ImageView<const T>& Input;
  const ImageView<T>& Output;
  const Window& Shape;
  double Strength;
  std::vector<Key> Keys;
  std::vector<double> Values;
  std::vector<int> Weights;
  std::vector<std::int64_t> Levels;
  SortedTile<Key> Tile;
};
}

template <class T>
void FilterAdaptiveMedian(const ImageView<const T>& input, const ImageView<T>& output,
  const Window& window, double strength, Execution& execution)
{
  StrengthRange.Check("AdaptiveStrength", strength);
  RequireRankable(window);
  FilterBlocks(output.Box, ChooseExhaustiveBlock(window, sizeof(T)), execution,
    [&] { return std::make_unique<BlockFilter<T>>(input, output, window, strength); });
}

//------------------------------------------------------------------------------
namespace
{
/// to[i] = extreme of to[i] and from[i], i < Count. from may overlap to from behind (from >= to).
template <class Key, Extreme Which>
struct Combine
{
  Key* To;
  const Key* From;
  std::int64_t Count;

  template <int Bytes>
  static LACUNA_INLINE void Run(const Combine& c)
  {
    using V = typename Vector<Key, Bytes>::Type;
    constexpr int Lanes = Vector<Key, Bytes>::Lanes;
    std::int64_t i = 0;
    for (; i + Lanes <= c.Count; i += Lanes)
    {
      V a, b;
      LoadVector(a, c.To + i);
      LoadVector(b, c.From + i);
      const V extreme = Which == Extreme::Least ? (a < b ? a : b) : (a > b ? a : b);
      StoreVector(c.To + i, extreme);
    }
    for (; i < c.Count; ++i)
    {
      c.To[i] =
        Which == Extreme::Least ? std::min(c.To[i], c.From[i]) : std::max(c.To[i], c.From[i]);
    }
  }
};

template <class Key, Extreme Which>
class ExtremeFilter
{
public:
  ExtremeFilter(const Window& window, VectorUnit set)
    : Shape(window)
    , Set(set)
  {
  }

  /// steps: what loads keys and stores extremes.
  void Filter(const Extent& inputBox, const Extent& box, SeparableSteps<Key>& steps,
    Execution& execution) const
  {
    if (this->Shape.IsBox())
    {
      steps.Along =
        [this](int axis, Key* data, std::int64_t count, std::int64_t shift, std::vector<Key>&)
      { this->SlideRun(data, count, shift, this->Shape.GetSize(axis)); };
      FilterSeparably(inputBox, box, Reach(this->Shape), steps, execution);
    }
    else
    {
      this->FilterEllipsoid(box, steps, execution);
    }
  }

private:
  /// data[i] = extreme of data[i + j * shift], 0 <= j < length, for i < count.
  void SlideRun(Key* data, std::int64_t count, std::int64_t shift, int length) const
  {
    int done = 1;
    for (; 2 * done <= length; done *= 2)
    {
      this->Apply(data, data + done * shift, count + (length - 2 * done) * shift);
    }
    if (done < length)
    {
      this->Apply(data, data + (length - done) * shift, count);
    }
  }

  void Apply(Key* to, const Key* from, std::int64_t count) const
  {
    Combine<Key, Which> combine{ to, from, count };
    RunWith<Combine<Key, Which>>(this->Set, combine);
  }

  void FilterEllipsoid(
    const Extent& box, const SeparableSteps<Key>& steps, Execution& execution) const
  {
    ForEachBlock(
      box, { 512, 64, 1 }, execution, [] { return std::make_unique<Buffers>(); },
      [&](Buffers& buffers, const Extent& block)
      {
        this->FilterBlock(block, steps, buffers);
        const std::int64_t pitch = SizeOf(this->Shape.Grow(block), 0);
        for (int y = block[2]; y <= block[3]; ++y)
        {
          steps.Store(
            buffers.Result.data() + (y - block[2]) * pitch, block[0], block[1], y, block[4]);
        }
      });
  }

  struct Buffers
  {
    std::vector<Key> Slice;
    std::vector<Key> Runs;
    std::vector<Key> Result;
  };

  /// Result: the rows of block, which has one slice, at the pitch of the grown block.
  void FilterBlock(const Extent& block, const SeparableSteps<Key>& steps, Buffers& buffers) const
  {
    auto& [slice, runs, result] = buffers;
    Extent grown = this->Shape.Grow(block);
    const int z0 = grown[4];
    const std::int64_t pitch = SizeOf(grown, 0);
    const std::int64_t size = pitch * SizeOf(grown, 1);
    const std::int64_t count = (SizeOf(block, 1) - 1) * pitch + SizeOf(block, 0);
    slice.resize(size);
    result.assign(size, Which == Extreme::Least ? std::numeric_limits<Key>::max() : Key(0));
    const std::vector<Window::Run>& rows = this->Shape.GetRuns();
    for (std::size_t first = 0; first < rows.size();)
    {
      std::size_t last = first;
      while (last < rows.size() && rows[last].Z == rows[first].Z)
      {
        ++last;
      }
      grown[4] = grown[5] = z0 + rows[first].Z;
      steps.Load(grown, slice.data());
      // The rows of a slice of an ellipsoid grow towards its middle and are nested: each row's
      // extremes come from the next shorter one's, and the rows at equal distance from the middle
      // share them.
      int begin = 0;
      int end = 0;
      for (std::size_t a = first, b = last; a < b--; ++a)
      {
        const Window::Run& run = rows[a];
        if (begin == end)
        {
          runs.assign(slice.begin(), slice.end());
          std::rotate(runs.begin(), runs.begin() + run.Begin, runs.end());
          this->SlideRun(runs.data(), size - run.End + 1, 1, run.End - run.Begin);
        }
        else
        {
          for (int x = run.Begin; x < begin; ++x)
          {
            this->Apply(runs.data(), slice.data() + x, size - x);
          }
          for (int x = end; x < run.End; ++x)
          {
            this->Apply(runs.data(), slice.data() + x, size - x);
          }
        }
        begin = run.Begin;
        end = run.End;
        this->Apply(result.data(), runs.data() + rows[a].Y * pitch, count);
        if (b > a)
        {
          this->Apply(result.data(), runs.data() + rows[b].Y * pitch, count);
        }
      }
      first = last;
    }
  }

  const Window& Shape;
  VectorUnit Set;
};
}

template <class T>
void FilterExtreme(const ImageView<const T>& input, const ImageView<T>& output,
  const Window& window, Extreme extreme, VectorUnit set, Execution& execution)
{
  using Key = KeyOf<T>;
  SeparableSteps<Key> steps;
  steps.Load = [&](const Extent& box, Key* to)
  {
    // NaN must not win, nor be brought back by the other NaN that a neighbour may be.
    const bool zeroNaN = std::is_floating_point_v<T> && extreme == Extreme::Greatest;
    CopyReplicated(input, box, to,
      [zeroNaN](T value)
      {
        const Key key = OrderedKey<T>::From(value);
        return zeroNaN && key == OrderedKey<T>::NaN ? Key(0) : key;
      });
  };
  steps.Store = [&](const Key* row, int x0, int x1, int y, int z)
  {
    for (int x = x0; x <= x1; ++x)
    {
      const T centre = std::is_floating_point_v<T> ? *input.At(x, y, z) : T(0);
      *output.At(x, y, z) = centre == centre ? OrderedKey<T>::To(row[x - x0]) : centre;
    }
  };
  if (extreme == Extreme::Least)
  {
    ExtremeFilter<Key, Extreme::Least>(window, set).Filter(input.Box, output.Box, steps, execution);
  }
  else
  {
    ExtremeFilter<Key, Extreme::Greatest>(window, set)
      .Filter(input.Box, output.Box, steps, execution);
  }
}

//------------------------------------------------------------------------------
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
    case SpeckleOperation::TopHat:
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

void CheckParameters(const SpeckleParameters& parameters)
{
  Properties properties;
  parameters.Describe(properties);
  properties.Check();
}

Deviations DeviationsOf(const SpeckleParameters& parameters)
{
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

namespace
{
// high - low, where high >= low; the largest number where an integer type ends before.
template <class T>
T Above(T high, T low)
{
  if constexpr (std::is_floating_point_v<T>)
  {
    return high == low ? T(0) : high - low; // infinities are no higher than themselves
  }
  else
  {
    using Count = std::make_unsigned_t<T>;
    const auto difference = static_cast<Count>(static_cast<Count>(high) - static_cast<Count>(low));
    constexpr T most = std::numeric_limits<T>::max();
    return difference > static_cast<Count>(most) ? most : static_cast<T>(difference);
  }
}

// opening: output before, input minus that after.
template <class T>
void SubtractOpening(
  const ImageView<const T>& input, const ImageView<T>& opening, Execution& execution)
{
  const Extent& box = opening.Box;
  execution.For(SizeOf(box, 2), 1,
    [&](std::int64_t begin, std::int64_t end)
    {
      for (int z = box[4] + static_cast<int>(begin); z < box[4] + static_cast<int>(end); ++z)
      {
        for (int y = box[2]; y <= box[3]; ++y)
        {
          for (int x = box[0]; x <= box[1]; ++x)
          {
            T& sample = *opening.At(x, y, z);
            sample = Above(*input.At(x, y, z), sample);
          }
        }
      }
    });
}
}

void SpeckleParameters::Describe(Properties& properties) const
{
  properties.Add("Operation", static_cast<int>(this->Operation), SpeckleOperationNames)
    .Add("KernelSize", this->KernelSize, ValueRange::Between(1, Window::MaximumSize, "voxels"))
    .Add("KernelShape", static_cast<int>(this->Shape), WindowShapeNames)
    .Add("Rank", this->Percentile, ValueRange::Between(0, 100))
    .Add("AdaptiveStrength", this->AdaptiveStrength, StrengthRange)
    .Add("StandardDeviation", this->StandardDeviation, ValueRange::Above(0, "mm"));
}

Extent GetSpeckleInput(const SpeckleParameters& parameters, const Extent& box)
{
  CheckParameters(parameters);
  switch (parameters.Operation)
  {
    case SpeckleOperation::Gaussian:
      return GaussianReach(DeviationsOf(parameters)).Grow(box, true, true);
    case SpeckleOperation::LaplacianOfGaussian:
      return LaplacianReach(DeviationsOf(parameters)).Grow(box, true, true);
    default:
      break;
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
    FilterMorphology(input, output, window, steps, parameters.Set, execution);
    if (parameters.Operation == SpeckleOperation::TopHat)
    {
      SubtractOpening(input, output, execution);
    }
    return;
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
  CheckParameters(parameters);
  FilterLaplacianOfGaussian(
    input, output, DeviationsOf(parameters), parameters.Spacing, parameters.Set, execution);
}

// NOLINTBEGIN(bugprone-macro-parentheses): T is a type
#define LACUNA_INSTANTIATE(T)                                                                      \
  template void FilterAdaptiveMedian(                                                              \
    const ImageView<const T>&, const ImageView<T>&, const Window&, double, Execution&);            \
  template void FilterExtreme(const ImageView<const T>&, const ImageView<T>&, const Window&,       \
    Extreme, VectorUnit, Execution&);                                                              \
  template void FilterSpeckle(                                                                     \
    const ImageView<const T>&, const ImageView<T>&, const SpeckleParameters&, Execution&);         \
  template void FilterSpeckleLaplacian(const ImageView<const T>&,                                  \
    const ImageView<LaplacianType<T>>&, const SpeckleParameters&, Execution&);
// NOLINTEND(bugprone-macro-parentheses)
LACUNA_FOR_EACH_SCALAR(LACUNA_INSTANTIATE)
}
