// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Divides nodes into groups of neighbours, each with what lies around it.
#ifndef lacunaNodePartition_h
#define lacunaNodePartition_h

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace lacuna
{
/// A k-d tree: halves nodes at the median of the longest axis until groups are small enough.
template <int Dimension>
class NodePartition
{
public:
  using Point = std::array<double, Dimension>;

  /// Groups of at most capacity >= 1 nodes. Keeps a reference to nodes.
  NodePartition(const std::vector<Point>& nodes, int capacity);

  std::size_t GetNumberOfGroups() const { return this->Leaves.size(); }
  /// The nodes of a group, ascending.
  std::vector<std::uint32_t> GetGroup(std::size_t group) const;
  /// Its nodes, then those nearest to its bounding box, count in all (or all nodes there are).
  std::vector<std::uint32_t> GetSurroundings(std::size_t group, std::size_t count) const;
  /// One node of each group, that nearest to the middle of its nodes; ascending.
  std::vector<std::uint32_t> GetRepresentatives() const;

private:
  struct Box
  {
    Point Low;
    Point High;
    std::uint32_t Begin;
    std::uint32_t End;
    std::int32_t FirstChild; // the other one follows; -1: none
  };
  void Divide(std::size_t box, int capacity);
  static double GetDistance2(const Box& a, const Point& low, const Point& high);

  const std::vector<Point>& Nodes;
  std::vector<std::uint32_t> Order;
  std::vector<Box> Boxes;
  std::vector<std::uint32_t> Leaves;
};
}
#endif
