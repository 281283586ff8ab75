// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// How images are divided for ranking.
#ifndef lacunaRankBlocks_h
#define lacunaRankBlocks_h

#include "lacunaBlocks.h"

#include <array>
#include <cstddef>

namespace lacuna
{
/// Windows for ranks hold at most this many samples.
constexpr std::int64_t MaximumRankSamples = std::int64_t(1) << 20;
/// Throws std::invalid_argument for a window of more than MaximumRankSamples.
void RequireRankable(const Window& window);

/// Blocks small enough for the tables of a block to stay in the cache, large enough for the margin
/// that a block shares with its neighbours to be small; with its margin a block has at most 256
/// samples along each axis.
std::array<int, 3> ChooseRankBlock(const Window& window, std::size_t sampleSize);

/// Those for filters that look at each sample of each window: small enough to be stopped promptly.
std::array<int, 3> ChooseExhaustiveBlock(const Window& window, std::size_t sampleSize);

/// Calls Filter(block) of what make() returns a std::unique_ptr to, for blocks of about the given
/// size that cover box.
template <class Make>
void FilterBlocks(
  const Extent& box, const std::array<int, 3>& size, Execution& execution, const Make& make)
{
  ForEachBlock(
    box, size, execution, make, [](auto& filter, const Extent& block) { filter.Filter(block); });
}
}
#endif
