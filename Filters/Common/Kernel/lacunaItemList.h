// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Numbered things in messages.
#ifndef lacunaItemList_h
#define lacunaItemList_h

#include <cstddef>
#include <string>
#include <vector>

namespace lacuna
{
/// "row 3", "rows 3 to 7, 12 and 20 more": for messages; items ascend.
std::string DescribeItems(const std::string& what, const std::vector<std::size_t>& items);
}
#endif
