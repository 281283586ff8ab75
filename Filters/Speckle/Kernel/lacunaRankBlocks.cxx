// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaRankBlocks.h"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace lacuna
{
void RequireRankable(const Window& window)
{
  if (window.GetNumberOfSamples() > MaximumRankSamples)
  {
    throw std::invalid_argument("the kernel holds " + std::to_string(window.GetNumberOfSamples()) +
      " samples; for medians and other ranks at most " + std::to_string(MaximumRankSamples) +
      " are possible");
  }
}

std::array<int, 3> ChooseRankBlock(const Window& window, std::size_t sampleSize)
{
  const bool flat = window.GetSize(2) == 1;
  // Samples of a byte need no sorting, which is what favours small blocks.
  const int large = sampleSize == 1 ? 2 : 1;
  const std::array<int, 3> least =
    flat ? std::array<int, 3>{ 64, 64 * large, 1 } : std::array<int, 3>{ 32, 32, 32 * large };
  std::array<int, 3> block;
  for (int a = 0; a < 3; ++a)
  {
    const int size = window.GetSize(a);
    block[a] = std::max(1, std::min(size == 1 ? least[a] : std::max(least[a], size), 256 - size));
  }
  return block;
}

std::array<int, 3> ChooseExhaustiveBlock(const Window& window, std::size_t sampleSize)
{
  constexpr std::int64_t MostVisits = std::int64_t(1) << 25; // a tenth of a second
  std::array<int, 3> block = ChooseRankBlock(window, sampleSize);
  const auto visits = [&] { return window.GetNumberOfSamples() * block[0] * block[1] * block[2]; };
  for (auto largest = std::max_element(block.begin(), block.end());
       visits() > MostVisits && *largest > 1;
       largest = std::max_element(block.begin(), block.end()))
  {
    *largest = (*largest + 1) / 2;
  }
  return block;
}
}
