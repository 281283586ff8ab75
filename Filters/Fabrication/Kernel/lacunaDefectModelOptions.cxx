// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaDefectModelOptions.h"

#include "lacunaParameterText.h"

#include <cmath>
#include <stdexcept>
#include <string>

namespace lacuna
{
//------------------------------------------------------------------------------
void CheckDefectModelOptions(const DefectModelOptions& o)
{
  const auto check = [](const char* name, double value, bool right, const std::string& range)
  {
    if (!std::isfinite(value) || !right)
    {
      throw std::invalid_argument(
        std::string(name) + " is " + FormatNumber(value) + "; it must be a number of mm " + range);
    }
  };
  const std::string block = "above 0 and at most " + FormatNumber(LargestBlock);
  check("Margin", o.Margin, o.Margin >= 0, "from 0");
  check("DefectDepth", o.DefectDepth, o.DefectDepth > 0 && o.DefectDepth <= LargestBlock, block);
  check("BaseThickness", o.BaseThickness, o.BaseThickness > 0 && o.BaseThickness <= LargestBlock,
    block);
  check("MaximumHeight", o.MaximumHeight, o.MaximumHeight >= 0, "from 0");
}
}
