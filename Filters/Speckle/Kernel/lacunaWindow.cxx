// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaWindow.h"

#include <algorithm>
#include <climits>
#include <cstdint>
#include <stdexcept>
#include <string>

namespace lacuna
{
Window::Window(const std::array<int, 3>& size, WindowShape shape)
  : Size(size)
  , Box(shape == WindowShape::Box)
{
  for (const int n : size)
  {
    if (n < 1 || n > MaximumSize)
    {
      throw std::invalid_argument("the kernel size is " + std::to_string(size[0]) + " x " +
        std::to_string(size[1]) + " x " + std::to_string(size[2]) + "; each must be 1 to " +
        std::to_string(MaximumSize));
    }
  }
  // In whole numbers: with u = 2 i - (Size - 1), inside when sum((u / Size)^2) <= 1.
  const auto inside = [&](int x, int y, int z)
  {
    const std::int64_t a = std::int64_t(size[0]) * size[0];
    const std::int64_t b = std::int64_t(size[1]) * size[1];
    const std::int64_t c = std::int64_t(size[2]) * size[2];
    const std::int64_t u = 2 * x - (size[0] - 1);
    const std::int64_t v = 2 * y - (size[1] - 1);
    const std::int64_t w = 2 * z - (size[2] - 1);
    return u * u * b * c + v * v * a * c + w * w * a * b <= a * b * c;
  };
  for (int z = 0; z < size[2]; ++z)
  {
    for (int y = 0; y < size[1]; ++y)
    {
      int begin = 0;
      while (!this->Box && begin < size[0] && !inside(begin, y, z))
      {
        ++begin;
      }
      const int end = size[0] - begin; // symmetric
      if (begin < end)
      {
        this->Runs.push_back({ y, z, begin, end });
        this->Samples += end - begin;
      }
    }
  }
}

Window Window::Reflect() const
{
  Window other(*this);
  other.Reflected = !this->Reflected;
  return other;
}

void Grow(Extent& box, int axis, int below, int above)
{
  First(box, axis) -=
    static_cast<int>(std::min<std::int64_t>(below, First(box, axis) - std::int64_t(INT_MIN)));
  Last(box, axis) +=
    static_cast<int>(std::min<std::int64_t>(above, INT_MAX - std::int64_t(Last(box, axis))));
}

Extent Window::Grow(const Extent& box) const
{
  Extent grown = box;
  for (int a = 0; a < 3; ++a)
  {
    lacuna::Grow(grown, a, this->Lower(a), this->Upper(a));
  }
  return grown;
}

Extent Intersect(const Extent& box, const Extent& bounds)
{
  Extent common;
  for (int a = 0; a < 3; ++a)
  {
    First(common, a) = std::max(First(box, a), First(bounds, a));
    Last(common, a) = std::min(Last(box, a), Last(bounds, a));
  }
  return common;
}

std::vector<Extent> Divide(const Extent& box, const std::array<int, 3>& size)
{
  std::vector<Extent> parts;
  if (IsEmpty(box))
  {
    return parts;
  }
  std::array<int, 3> count;
  for (int a = 0; a < 3; ++a)
  {
    count[a] = std::max(1, (SizeOf(box, a) + size[a] - 1) / size[a]);
  }
  const auto edge = [&](int axis, int i) {
    return First(box, axis) + static_cast<int>(std::int64_t(SizeOf(box, axis)) * i / count[axis]);
  };
  for (int z = 0; z < count[2]; ++z)
  {
    for (int y = 0; y < count[1]; ++y)
    {
      for (int x = 0; x < count[0]; ++x)
      {
        parts.push_back({ edge(0, x), edge(0, x + 1) - 1, edge(1, y), edge(1, y + 1) - 1,
          edge(2, z), edge(2, z + 1) - 1 });
      }
    }
  }
  return parts;
}
}
