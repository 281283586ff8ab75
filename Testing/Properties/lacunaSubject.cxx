// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSubject.h"

namespace lacunaProperties
{
//------------------------------------------------------------------------------
double UsualReal(Dice& dice, double lowest, double highest)
{
  if (dice.Chance(0.1))
  {
    return dice.Chance(0.5) ? lowest : highest;
  }
  return lowest > 0 && highest > 50 * lowest ? dice.Scale(lowest, highest)
                                             : dice.Real(lowest, highest);
}

//------------------------------------------------------------------------------
double HostileReal(Dice& dice)
{
  constexpr double infinity = std::numeric_limits<double>::infinity();
  return dice.Pick({ std::numeric_limits<double>::quiet_NaN(), infinity, -infinity, 0.0, -1.0,
    1e300, -1e300, 1e-300, std::numeric_limits<double>::max() });
}

//------------------------------------------------------------------------------
int HostileWhole(Dice& dice)
{
  return dice.Pick({ INT_MIN, INT_MAX, -1, 0, -1000 });
}

//------------------------------------------------------------------------------
const std::vector<Subject>& GetSubjects()
{
  static const std::vector<Subject> subjects = []
  {
    std::vector<Subject> all;
    AddSourceSubjects(all);
    AddReaderSubjects(all);
    AddImageSubjects(all);
    AddSliceSubjects(all);
    AddSurfaceSubjects(all);
    return all;
  }();
  return subjects;
}
}
