// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaTransformGraph.h"

#include <gtest/gtest.h>

using namespace lacuna;

namespace
{
std::string Show(const TransformGraph& graph, const std::string& from, const std::string& to)
{
  std::vector<TransformGraph::Link> chain;
  if (!graph.FindChain(from, to, chain))
  {
    return "none";
  }
  std::string text;
  for (const auto& link : chain)
  {
    text += (link.Inverse ? "-" : "+") + std::to_string(link.Transform) + link.To;
  }
  return text;
}
using Readings = std::vector<std::pair<std::string, std::string>>;
}

TEST(TransformGraph, Names)
{
  EXPECT_EQ(ReadTransformName("ProbeToTracker"), (Readings{ { "Probe", "Tracker" } }));
  EXPECT_EQ(ReadTransformName("ToolToTracker"), (Readings{ { "Tool", "Tracker" } }));
  EXPECT_EQ(ReadTransformName("TorsoToTool"), (Readings{ { "Torso", "Tool" } }));
  EXPECT_EQ(ReadTransformName("StylusTipToStylus"), (Readings{ { "StylusTip", "Stylus" } }));
  EXPECT_EQ(ReadTransformName("A bTo\xc3\x9c-1.x"), (Readings{ { "A b", "\xc3\x9c-1.x" } }));
  EXPECT_EQ(ReadTransformName("AToBToC"), (Readings{ { "A", "BToC" }, { "AToB", "C" } }));
  for (const char* none : { "", "To", "ToB", "ATo", "Store", "ATob" })
  {
    EXPECT_TRUE(ReadTransformName(none).empty()) << none;
  }
}

TEST(TransformGraph, ChainsRunBothWays)
{
  TransformGraph graph;
  graph.Add("Image", "Probe", 0);
  graph.Add("Probe", "Tracker", 1);
  graph.Add("Reference", "Tracker", 2);
  graph.Add("Phantom", "Reference", 3);
  EXPECT_EQ(Show(graph, "Image", "Reference"), "+0Probe+1Tracker-2Reference");
  EXPECT_EQ(Show(graph, "Phantom", "Image"), "+3Reference+2Tracker-1Probe-0Image");
  EXPECT_EQ(Show(graph, "Image", "Image"), "");
  EXPECT_EQ(Show(graph, "Image", "Nowhere"), "none");
  EXPECT_EQ(Show(graph, "Nowhere", "Image"), "none");
}

TEST(TransformGraph, TheShortestAndThenTheFirstWins)
{
  TransformGraph graph;
  graph.Add("A", "B", 0);
  graph.Add("B", "D", 1);
  graph.Add("A", "C", 2);
  graph.Add("C", "D", 3);
  EXPECT_EQ(Show(graph, "A", "D"), "+0B+1D");
  graph.Add("D", "A", 4);
  EXPECT_EQ(Show(graph, "A", "D"), "-4D");
  graph.Add("A", "D", 5);
  EXPECT_EQ(Show(graph, "A", "D"), "-4D"); // the one added first
}

TEST(TransformGraph, Groups)
{
  TransformGraph graph;
  graph.Add("Image", "Probe", 0);
  graph.Add("Reference", "Tracker", 1);
  EXPECT_EQ(graph.GetReachable("Probe"), (std::vector<std::string>{ "Image", "Probe" }));
  EXPECT_EQ(graph.GetReachable("Tracker"), (std::vector<std::string>{ "Reference", "Tracker" }));
  EXPECT_TRUE(graph.GetReachable("X").empty());
  EXPECT_FALSE(graph.HasFrame("X"));
}

TEST(TransformGraph, ALongChainAndACycle)
{
  TransformGraph graph;
  for (int i = 0; i < 2000; ++i)
  {
    graph.Add(std::to_string(i), std::to_string((i + 1) % 2000), i);
  }
  std::vector<TransformGraph::Link> chain;
  ASSERT_TRUE(graph.FindChain("0", "1000", chain));
  EXPECT_EQ(chain.size(), 1000u);
}
