// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaItemList.h"

#include <sstream>

namespace lacuna
{
std::string DescribeItems(const std::string& what, const std::vector<std::size_t>& items)
{
  constexpr int most = 8; // ranges
  std::ostringstream text;
  text << what << (items.size() > 1 ? "s " : " ");
  int ranges = 0;
  for (std::size_t i = 0; i < items.size();)
  {
    std::size_t last = i;
    while (last + 1 < items.size() && items[last + 1] == items[last] + 1)
    {
      ++last;
    }
    if (ranges == most)
    {
      text << " and " << items.size() - i << " more";
      break;
    }
    text << (ranges ? ", " : "") << items[i];
    if (last > i)
    {
      text << (last == i + 1 ? ", " : " to ") << items[last];
    }
    ++ranges;
    i = last + 1;
  }
  return text.str();
}
}
