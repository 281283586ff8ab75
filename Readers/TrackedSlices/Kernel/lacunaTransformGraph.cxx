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
  this->Frames[from].push_back({ transform, false, to });
  this->Frames[to].push_back({ transform, true, from });
}

std::map<std::string, TransformGraph::Arrival> TransformGraph::Search(
  const std::string& start) const
{
  // breadth first: the first way found to a frame is a shortest one
  std::map<std::string, Arrival> arrivals;
  if (!this->HasFrame(start))
  {
    return arrivals;
  }
  arrivals[start] = {};
  std::deque<std::string> open{ start };
  while (!open.empty())
  {
    const std::string frame = open.front();
    open.pop_front();
    for (const Link& link : this->Frames.at(frame))
    {
      if (arrivals.emplace(link.To, Arrival{ frame, link }).second)
      {
        open.push_back(link.To);
      }
    }
  }
  return arrivals;
}

bool TransformGraph::FindChain(
  const std::string& from, const std::string& to, std::vector<Link>& chain) const
{
  chain.clear();
  const std::map<std::string, Arrival> arrivals = this->Search(from);
  if (arrivals.count(to) == 0)
  {
    return false;
  }
  for (std::string frame = to; frame != from; frame = arrivals.at(frame).From)
  {
    chain.push_back(arrivals.at(frame).Step);
  }
  std::reverse(chain.begin(), chain.end());
  return true;
}

std::vector<std::string> TransformGraph::GetReachable(const std::string& frame) const
{
  std::vector<std::string> frames;
  for (const auto& arrival : this->Search(frame))
  {
    frames.push_back(arrival.first);
  }
  return frames;
}
}
