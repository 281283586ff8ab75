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
  const auto check = [](const char* name, double value, bool zero)
  {
    if (!std::isfinite(value) || value < 0 || (value == 0 && !zero))
    {
      throw std::invalid_argument(std::string(name) + " is " + FormatNumber(value) +
        "; it must be a number of mm " + (zero ? "from 0" : "above 0"));
    }
  };
  check("Margin", o.Margin, true);
  check("DefectDepth", o.DefectDepth, false);
  check("BaseThickness", o.BaseThickness, false);
  check("MaximumHeight", o.MaximumHeight, true);
}
}
