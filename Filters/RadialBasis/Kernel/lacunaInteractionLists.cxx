// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaInteractionLists.h"

#include <algorithm>
#include <array>
#include <tuple>

namespace lacuna
{
namespace
{
// Points are evaluated in blocks, full or not.
double GetPadded(std::int64_t count)
{
  constexpr auto block = static_cast<std::int64_t>(RadialBlock);
  const std::int64_t blocks = (count + block - 1) / block;
  return static_cast<double>(blocks * block);
}

// Goes down the target tree with, for each box, the boxes of sources that touch it: those are of its
// size, or larger without children.
template <int Dimension>
class ListBuilder
{
public:
  using Cell = TreeCell<Dimension>;

  ListBuilder(const CellTree<Dimension>& targets, const CellTree<Dimension>& sources, int size,
    InteractionLists<Dimension>& lists)
    : Targets(targets)
    , Sources(sources)
    , Lists(lists)
    , Size(size)
    // Measured in kernel evaluations: matrix products do many more operations in the same time.
    , PairCost(Dimension == 2 ? 0.05 * size * size : 0.03 * size * size)
  {
  }

  void Run()
  {
    const std::size_t count = this->Targets.Cells.size();
    std::vector<std::vector<std::int32_t>> touching(1, { 0 });
    this->Begin(this->Lists.PointsToLocal, count);
    this->Begin(this->Lists.MultipolesToPoints, count);
    this->Begin(this->Lists.PointsToPoints, count);
    for (int level = 0; level < this->Targets.GetNumberOfLevels(); ++level)
    {
      const int first = this->Targets.LevelBegin[level];
      const int last = this->Targets.LevelBegin[level + 1];
      const int below = last;
      std::vector<std::vector<std::int32_t>> next(level + 1 < this->Targets.GetNumberOfLevels()
          ? this->Targets.LevelBegin[level + 2] - below
          : 0);
      for (int t = first; t < last; ++t)
      {
        const Cell& target = this->Targets.Cells[t];
        this->Near = std::move(touching[t - first]);
        if (target.Parent >= 0)
        {
          this->Separate(t);
        }
        if (target.Children == 0)
        {
          for (const std::int32_t s : this->Near)
          {
            this->Descend(target, s);
          }
        }
        for (int child = 0; child < target.Children; ++child)
        {
          next[target.FirstChild + child - below] = this->Near;
        }
        this->End(this->Lists.PointsToLocal, t);
        this->End(this->Lists.MultipolesToPoints, t);
        this->End(this->Lists.PointsToPoints, t);
      }
      this->MakeBlocks(first, last);
      touching = std::move(next);
    }
  }

private:
  template <class Item>
  static void Begin(CellLists<Item>& lists, std::size_t count)
  {
    lists.Begin.assign(count + 1, 0);
  }
  template <class Item>
  static void End(CellLists<Item>& lists, int t)
  {
    lists.Begin[t + 1] = lists.Items.size();
  }

  // Near holds what touches the parent of t: leaves in it what touches t, and lists the rest.
  void Separate(int t)
  {
    const Cell& target = this->Targets.Cells[t];
    this->Kept.clear();
    const auto sort = [&](std::int32_t s)
    {
      if (AreAdjacent(target, this->Sources.Cells[s]))
      {
        this->Kept.push_back(s);
      }
      else
      {
        this->ListFar(t, s);
      }
    };
    for (const std::int32_t s : this->Near)
    {
      const Cell& source = this->Sources.Cells[s];
      if (source.Children == 0)
      {
        sort(s);
      }
      for (int child = 0; child < source.Children; ++child)
      {
        sort(source.FirstChild + child);
      }
    }
    this->Near.swap(this->Kept);
  }

  // A source that is of the target's size, or larger without children.
  void ListFar(int t, std::int32_t s)
  {
    const Cell& target = this->Targets.Cells[t];
    const Cell& source = this->Sources.Cells[s];
    const auto sources = static_cast<double>(source.Count);
    const double toLocal = sources * this->Size;
    if (target.Children == 0)
    {
      const double points = GetPadded(target.Count);
      const double toPoints = sources * points;
      const double multipoleToPoints = this->Size * points;
      const bool equal = source.Level == target.Level;
      const double others = equal ? std::min(toLocal, this->PairCost) : toLocal;
      if (toPoints <= others && (!equal || toPoints <= multipoleToPoints))
      {
        this->Lists.PointsToPoints.Items.push_back(s);
        return;
      }
      if (equal && multipoleToPoints <= others)
      {
        this->Lists.MultipolesToPoints.Items.push_back(s);
        return;
      }
    }
    if (source.Level < target.Level || toLocal <= this->PairCost)
    {
      this->Lists.PointsToLocal.Items.push_back(s);
      return;
    }
    std::array<int, Dimension> offset;
    for (int c = 0; c < Dimension; ++c)
    {
      offset[c] = static_cast<int>(source.Index[c]) - static_cast<int>(target.Index[c]);
    }
    const typename FarOffsets<Dimension>::Entry entry = this->Offsets.Find(offset);
    this->LevelPairs.push_back({ t, s, entry.Operator, entry.Symmetry });
  }

  // A source that touches a target without children.
  void Descend(const Cell& target, std::int32_t s)
  {
    const Cell& source = this->Sources.Cells[s];
    if (AreAdjacent(target, source))
    {
      if (source.Children == 0)
      {
        this->Lists.PointsToPoints.Items.push_back(s);
      }
      for (int child = 0; child < source.Children; ++child)
      {
        this->Descend(target, source.FirstChild + child);
      }
      return;
    }
    (source.Count <= this->Size ? this->Lists.PointsToPoints : this->Lists.MultipolesToPoints)
      .Items.push_back(s);
  }

  void MakeBlocks(int first, int last)
  {
    constexpr int cells = Dimension == 2 ? 32 : 16;
    auto pair = this->LevelPairs.begin();
    for (int t = first; t < last; t += cells)
    {
      const int end = std::min(t + cells, last);
      const auto endPair = std::find_if(
        pair, this->LevelPairs.end(), [&](const FarPair& p) { return p.Target >= end; });
      std::stable_sort(pair, endPair,
        [](const FarPair& a, const FarPair& b)
        { return std::tie(a.Operator, a.Target) < std::tie(b.Operator, b.Target); });
      const std::size_t firstPair = this->Lists.Pairs.size();
      this->Lists.Pairs.insert(this->Lists.Pairs.end(), pair, endPair);
      if (this->Lists.Pairs.size() > firstPair)
      {
        this->Lists.Blocks.push_back({ t, end, firstPair, this->Lists.Pairs.size() });
      }
      pair = endPair;
    }
    this->LevelPairs.clear();
  }

  const CellTree<Dimension>& Targets;
  const CellTree<Dimension>& Sources;
  InteractionLists<Dimension>& Lists;
  const FarOffsets<Dimension> Offsets;
  int Size;
  double PairCost;
  std::vector<std::int32_t> Near;
  std::vector<std::int32_t> Kept;
  std::vector<FarPair> LevelPairs;
};
}

template <int Dimension>
InteractionLists<Dimension>::InteractionLists(
  const CellTree<Dimension>& targets, const CellTree<Dimension>& sources, int size)
{
  ListBuilder<Dimension>(targets, sources, size, *this).Run();
}

template struct InteractionLists<2>;
template struct InteractionLists<3>;
}
