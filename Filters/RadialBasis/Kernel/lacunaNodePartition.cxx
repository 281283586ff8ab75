// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaNodePartition.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace lacuna
{
template <int Dimension>
NodePartition<Dimension>::NodePartition(const std::vector<Point>& nodes, int capacity)
  : Nodes(nodes)
  , Order(nodes.size())
{
  std::iota(this->Order.begin(), this->Order.end(), 0U);
  this->Boxes.push_back({ {}, {}, 0, static_cast<std::uint32_t>(nodes.size()), -1 });
  for (std::size_t box = 0; box < this->Boxes.size(); ++box)
  {
    this->Divide(box, capacity);
  }
}

template <int Dimension>
void NodePartition<Dimension>::Divide(std::size_t box, int capacity)
{
  Box& b = this->Boxes[box];
  b.Low = this->Nodes[this->Order[b.Begin]];
  b.High = b.Low;
  for (std::uint32_t i = b.Begin; i < b.End; ++i)
  {
    const Point& p = this->Nodes[this->Order[i]];
    for (int c = 0; c < Dimension; ++c)
    {
      b.Low[c] = std::min(b.Low[c], p[c]);
      b.High[c] = std::max(b.High[c], p[c]);
    }
  }
  if (b.End - b.Begin <= static_cast<std::uint32_t>(capacity))
  {
    std::sort(this->Order.begin() + b.Begin, this->Order.begin() + b.End);
    this->Leaves.push_back(static_cast<std::uint32_t>(box));
    return;
  }
  int axis = 0;
  for (int c = 1; c < Dimension; ++c)
  {
    axis = b.High[c] - b.Low[c] > b.High[axis] - b.Low[axis] ? c : axis;
  }
  const std::uint32_t middle = b.Begin + (b.End - b.Begin) / 2;
  std::nth_element(this->Order.begin() + b.Begin, this->Order.begin() + middle,
    this->Order.begin() + b.End,
    [&](std::uint32_t i, std::uint32_t j)
    {
      const double x = this->Nodes[i][axis];
      const double y = this->Nodes[j][axis];
      return x != y ? x < y : i < j;
    });
  b.FirstChild = static_cast<std::int32_t>(this->Boxes.size());
  const Box parent = b; // the reference does not survive
  this->Boxes.push_back({ {}, {}, parent.Begin, middle, -1 });
  this->Boxes.push_back({ {}, {}, middle, parent.End, -1 });
}

template <int Dimension>
std::vector<std::uint32_t> NodePartition<Dimension>::GetGroup(std::size_t group) const
{
  const Box& b = this->Boxes[this->Leaves[group]];
  return { this->Order.begin() + b.Begin, this->Order.begin() + b.End };
}

template <int Dimension>
double NodePartition<Dimension>::GetDistance2(const Box& a, const Point& low, const Point& high)
{
  double sum = 0;
  for (int c = 0; c < Dimension; ++c)
  {
    const double gap = std::max({ 0.0, a.Low[c] - high[c], low[c] - a.High[c] });
    sum += gap * gap;
  }
  return sum;
}

template <int Dimension>
std::vector<std::uint32_t> NodePartition<Dimension>::GetSurroundings(
  std::size_t group, std::size_t count) const
{
  const Box& own = this->Boxes[this->Leaves[group]];
  std::vector<std::uint32_t> nodes = this->GetGroup(group);
  if (nodes.size() >= count)
  {
    return nodes;
  }
  const std::size_t wanted = std::min(count, this->Nodes.size()) - nodes.size();
  using Candidate = std::pair<double, std::uint32_t>;
  std::vector<Candidate> found;
  // Boxes by distance, nearest first, until no nearer node can come.
  std::vector<Candidate> heap{ { 0.0, 0 } };
  const auto later = [](const Candidate& a, const Candidate& b) { return a > b; };
  const auto worst = [&]
  {
    std::nth_element(
      found.begin(), found.begin() + static_cast<std::ptrdiff_t>(wanted - 1), found.end());
    return found[wanted - 1].first;
  };
  std::size_t checked = 0;
  while (!heap.empty())
  {
    std::pop_heap(heap.begin(), heap.end(), later);
    const Candidate nearest = heap.back();
    heap.pop_back();
    if (found.size() >= wanted && found.size() > checked)
    {
      checked = found.size();
      if (worst() < nearest.first)
      {
        break;
      }
    }
    const Box& box = this->Boxes[nearest.second];
    if (box.FirstChild >= 0)
    {
      for (int child = box.FirstChild; child < box.FirstChild + 2; ++child)
      {
        heap.emplace_back(
          GetDistance2(this->Boxes[child], own.Low, own.High), static_cast<std::uint32_t>(child));
        std::push_heap(heap.begin(), heap.end(), later);
      }
      continue;
    }
    for (std::uint32_t i = box.Begin; i < box.End && box.Begin != own.Begin; ++i)
    {
      const Point& p = this->Nodes[this->Order[i]];
      found.emplace_back(GetDistance2(own, p, p), this->Order[i]);
    }
  }
  std::sort(found.begin(), found.end());
  for (std::size_t i = 0; i < std::min(wanted, found.size()); ++i)
  {
    nodes.push_back(found[i].second);
  }
  return nodes;
}

template <int Dimension>
std::vector<std::uint32_t> NodePartition<Dimension>::GetRepresentatives() const
{
  std::vector<std::uint32_t> chosen;
  for (const std::uint32_t leaf : this->Leaves)
  {
    const Box& b = this->Boxes[leaf];
    Point middle{};
    for (std::uint32_t i = b.Begin; i < b.End; ++i)
    {
      for (int c = 0; c < Dimension; ++c)
      {
        middle[c] += this->Nodes[this->Order[i]][c] / (b.End - b.Begin);
      }
    }
    const auto distance2 = [&](std::uint32_t i)
    {
      double sum = 0;
      for (int c = 0; c < Dimension; ++c)
      {
        sum += (this->Nodes[i][c] - middle[c]) * (this->Nodes[i][c] - middle[c]);
      }
      return sum;
    };
    chosen.push_back(*std::min_element(this->Order.begin() + b.Begin, this->Order.begin() + b.End,
      [&](std::uint32_t i, std::uint32_t j) { return distance2(i) < distance2(j); }));
  }
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

template class NodePartition<2>;
template class NodePartition<3>;
}
