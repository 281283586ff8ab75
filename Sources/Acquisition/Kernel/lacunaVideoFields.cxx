// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaVideoFields.h"

namespace lacuna
{
void KeepField(VideoField field, std::int64_t columns, std::int64_t rows, std::uint8_t* grey)
{
  if (field == VideoField::Both || rows < 2)
  {
    return;
  }
  for (std::int64_t row = field == VideoField::Top ? 1 : 0; row < rows; row += 2)
  {
    const std::uint8_t* above = grey + (row > 0 ? row - 1 : row + 1) * columns;
    const std::uint8_t* below = grey + (row + 1 < rows ? row + 1 : row - 1) * columns;
    std::uint8_t* line = grey + row * columns;
    for (std::int64_t column = 0; column < columns; ++column)
    {
      line[column] = static_cast<std::uint8_t>((above[column] + below[column] + 1) / 2);
    }
  }
}
}
