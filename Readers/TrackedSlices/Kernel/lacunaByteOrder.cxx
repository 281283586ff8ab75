// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaByteOrder.h"

#include <algorithm>
#include <cstdint>
#include <cstring>

namespace lacuna
{
void SwapElementBytes(void* elements, std::size_t count, std::size_t elementSize)
{
  if (elementSize < 2)
  {
    return;
  }
  auto* bytes = static_cast<unsigned char*>(elements);
  for (std::size_t i = 0; i < count; ++i, bytes += elementSize)
  {
    std::reverse(bytes, bytes + elementSize);
  }
}

bool IsBigEndianMachine()
{
  const std::uint16_t one = 1;
  unsigned char first = 0;
  std::memcpy(&first, &one, 1);
  return first == 0;
}
}
