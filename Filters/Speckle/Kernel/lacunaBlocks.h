// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Work on the blocks of a box, in parallel.
#ifndef lacunaBlocks_h
#define lacunaBlocks_h

#include "lacunaExecution.h"
#include "lacunaWindow.h"

#include <array>
#include <cstdint>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace lacuna
{
/// Calls work(memory, block) for blocks of about the given size that cover box, several at once.
/// memory is what make() returned a std::unique_ptr to; no two calls have the same one at a time,
/// and a call gets it as another one left it, so that few are ever made.
template <class Make, class Work>
void ForEachBlock(const Extent& box, const std::array<int, 3>& size, Execution& execution,
  const Make& make, const Work& work)
{
  const std::vector<Extent> blocks = Divide(box, size);
  std::vector<decltype(make())> idle;
  std::mutex mutex;
  execution.For(static_cast<std::int64_t>(blocks.size()), 1,
    [&](std::int64_t begin, std::int64_t end)
    {
      decltype(make()) memory;
      {
        const std::lock_guard<std::mutex> lock(mutex);
        if (!idle.empty())
        {
          memory = std::move(idle.back());
          idle.pop_back();
        }
      }
      if (!memory)
      {
        memory = make();
      }
      for (std::int64_t i = begin; i < end; ++i)
      {
        work(*memory, blocks[i]);
      }
      const std::lock_guard<std::mutex> lock(mutex);
      idle.push_back(std::move(memory));
    });
}
}
#endif
