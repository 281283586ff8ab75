// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaTransformGraph.h"

#include <algorithm>
#include <deque>

namespace lacuna
{
std::vector<std::pair<std::string, std::string>> ReadTransformName(std::string_view name)
{
  std::vector<std::pair<std::string, std::string>> readings;
  for (std::size_t at = name.find("To", 1); at != std::string_view::npos;
       at = name.find("To", at + 1))
  {
    const std::string_view to = name.substr(at + 2);
    if (!to.empty() && !(to[0] >= 'a' && to[0] <= 'z'))
    {
      readings.emplace_back(name.substr(0, at), to);
    }
  }
  return readings;
}

void TransformGraph::Add(const std::string& from, const std::string& to, int transform)
{
  this->Frames[from].push_back({ to, { transform, false } });
  this->Frames[to].push_back({ from, { transform, true } });
}

std::map<std::string, TransformGraph::Edge> TransformGraph::Search(const std::string& start) const
{
  // breadth first: the first way found to a frame is a shortest one
  std::map<std::string, Edge> before;
  if (!this->HasFrame(start))
  {
    return before;
  }
  before[start] = { start, { -1, false } };
  std::deque<std::string> open{ start };
  while (!open.empty())
  {
    const std::string frame = open.front();
    open.pop_front();
    for (const Edge& edge : this->Frames.at(frame))
    {
      if (before.emplace(edge.Neighbour, Edge{ frame, edge.Step }).second)
      {
        open.push_back(edge.Neighbour);
      }
    }
  }
  return before;
}

bool TransformGraph::FindChain(
  const std::string& from, const std::string& to, std::vector<Link>& chain) const
{
  chain.clear();
  const std::map<std::string, Edge> before = this->Search(from);
  if (before.count(to) == 0)
  {
    return false;
  }
  for (std::string frame = to; frame != from;)
  {
    const Edge& edge = before.at(frame);
    chain.push_back(edge.Step);
    frame = edge.Neighbour;
  }
  std::reverse(chain.begin(), chain.end());
  return true;
}

std::vector<std::string> TransformGraph::GetReachable(const std::string& frame) const
{
  std::vector<std::string> frames;
  for (const auto& found : this->Search(frame))
  {
    frames.push_back(found.first);
  }
  return frames;
}
}
