// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaMorphology.h"

#include "lacunaBlocks.h"

#include "lacunaOrderedKey.h"
#include "lacunaScalarType.h"
#include "lacunaSeparable.h"

namespace lacuna
{
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

// NOLINTBEGIN(bugprone-macro-parentheses): T is a type
#define LACUNA_INSTANTIATE(T)                                                                      \
  template void FilterExtreme(const ImageView<const T>&, const ImageView<T>&, const Window&,       \
    Extreme, VectorUnit, Execution&);
// NOLINTEND(bugprone-macro-parentheses)
LACUNA_FOR_EACH_SCALAR(LACUNA_INSTANTIATE)
}
