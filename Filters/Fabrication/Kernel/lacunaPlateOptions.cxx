// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaPlateOptions.h"

#include "lacunaParameterText.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace lacuna
{
namespace
{
constexpr double Pi = 3.14159265358979323846;
constexpr int RoundSteps = 8;
}

//------------------------------------------------------------------------------
void CheckPlateOptions(const ImplantPlateOptions& o)
{
  const auto fail = [](const char* name, double value, const std::string& right)
  { throw std::invalid_argument(name + (" is " + FormatNumber(value)) + "; it must be " + right); };
  const auto positive = [&](const char* name, double value)
  {
    if (!(value > 0 && std::isfinite(value)))
    {
      fail(name, value, "a number of mm above 0");
    }
  };
  positive("Thickness", o.Thickness);
  positive("TriangleSize", o.TriangleSize);
  if (!std::isfinite(o.EdgeClearance))
  {
    fail("EdgeClearance", o.EdgeClearance, "a number of mm");
  }
  if (!(o.CornerRadius >= 0 && std::isfinite(o.CornerRadius)))
  {
    fail("CornerRadius", o.CornerRadius, "0 mm or more");
  }
  if (o.Edge != PlateEdge::Square)
  {
    const double most = o.BothFaces ? 0.5 * o.Thickness : o.Thickness;
    if (!(o.EdgeSize >= 0 && o.EdgeSize <= most))
    {
      fail("Bevel", o.EdgeSize,
        "from 0 to " + FormatNumber(most) +
          (o.BothFaces ? " mm, half of Thickness" : " mm, the Thickness"));
    }
  }
  if (!o.HolePoints.empty())
  {
    positive("HoleDiameter", o.Hole.Diameter);
    const double head = o.Hole.CountersinkDiameter;
    if (head != 0 && !(head > o.Hole.Diameter && std::isfinite(head)))
    {
      fail("CountersinkDiameter", head,
        "0 (none) or larger than HoleDiameter, " + FormatNumber(o.Hole.Diameter) + " mm");
    }
    if (head != 0 && !(o.Hole.CountersinkAngle >= 30 && o.Hole.CountersinkAngle <= 150))
    {
      fail("CountersinkAngle", o.Hole.CountersinkAngle, "from 30 to 150 degrees");
    }
  }
  if (o.DrainageSpacing != 0)
  {
    positive("DrainageSpacing", o.DrainageSpacing);
    positive("DrainageDiameter", o.DrainageDiameter);
    if (o.DrainageSpacing < o.DrainageDiameter + 2 * MinimumWeb)
    {
      fail("DrainageSpacing", o.DrainageSpacing,
        "0 (no drainage) or at least DrainageDiameter + 1 mm, so that the holes stay apart");
    }
  }
}

//------------------------------------------------------------------------------
std::vector<Vec2> GetEdgeProfile(const ImplantPlateOptions& options, const PlateLevels& levels)
{
  std::vector<Vec2> profile;
  const auto add = [&](double inset, double level)
  {
    if (profile.empty() || std::abs(profile.back()[0] - inset) > 1e-9 ||
      std::abs(profile.back()[1] - level) > 1e-9)
    {
      profile.push_back({ inset, level });
    }
  };
  const double size = options.Edge == PlateEdge::Square ? 0 : options.EdgeSize;
  const int steps = size == 0 ? 0 : (options.Edge == PlateEdge::Round ? RoundSteps : 1);
  // inset and depth below the face after step i of the turn from face to wall
  const auto turn = [&](int i)
  {
    const double angle = 0.5 * Pi * i / std::max(steps, 1);
    return Vec2{ size * (1 - std::sin(angle)), size * (1 - std::cos(angle)) };
  };
  for (int i = 0; i <= steps; ++i)
  {
    add(turn(i)[0], levels.Outer - turn(i)[1]);
  }
  for (int i = steps; i >= 0 && options.BothFaces; --i)
  {
    add(turn(i)[0], levels.Inner + turn(i)[1]);
  }
  add(options.BothFaces ? size : 0, levels.Inner);
  return profile;
}
}
