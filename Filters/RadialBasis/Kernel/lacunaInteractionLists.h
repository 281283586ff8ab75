// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Which boxes of sources act on which boxes of targets, and how.
#ifndef lacunaInteractionLists_h
#define lacunaInteractionLists_h

#include "lacunaFarField.h"
#include "lacunaRadialTree.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace lacuna
{
/// One list for each target box: items Begin[t] <= i < Begin[t + 1].
template <class Item>
struct CellLists
{
  std::vector<std::size_t> Begin;
  std::vector<Item> Items;
};

/// A box of sources acts on a box of targets of the same size through the interpolants of both.
struct FarPair
{
  std::int32_t Target;
  std::int32_t Source;
  std::uint8_t Operator;
  std::uint8_t Symmetry;
};

/// Together the lists of a target box and of those that contain it make each source act once on
/// each point. Boxes that act through an interpolant do not touch.
template <int Dimension>
struct InteractionLists
{
  /// Pairs by blocks of target boxes of one level, within a block by operator. A block is what one
  /// thread works on.
  struct Block
  {
    int FirstTarget;
    int LastTarget; ///< one past
    std::size_t FirstPair;
    std::size_t LastPair;
  };
  std::vector<Block> Blocks;
  std::vector<FarPair> Pairs;
  /// Sources so few that they act on the nodes of the target's interpolant one by one.
  CellLists<std::int32_t> PointsToLocal;
  /// For targets without children: sources whose interpolants act on the points one by one, and
  /// sources whose points do.
  CellLists<std::int32_t> MultipolesToPoints;
  CellLists<std::int32_t> PointsToPoints;

  /// size is about how many nodes an interpolant will have: it decides what is cheaper.
  InteractionLists(
    const CellTree<Dimension>& targets, const CellTree<Dimension>& sources, int size);
};
}
#endif
