// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The line, or the number, that most of many values agree with: of a border that is interrupted here
/// and there, and beside which other things lie.
#ifndef lacunaConsensus_h
#define lacunaConsensus_h

#include <vector>

namespace lacuna
{
/// A point of a border: where it is along the border, and the coordinate across it.
struct BorderPoint
{
  double Along, Across;
};

/// Across = Offset + Slope * Along
struct BorderLine
{
  double Offset = 0;
  double Slope = 0;
  double Support = 0; ///< part of the points that agree, less twice the part that lies outside
  double At(double along) const { return this->Offset + this->Slope * along; }
};

/// outwards: 1 where the things within the border have smaller Across, -1 where they have larger
/// ones. Points within tolerance (at right angles to a line) agree; those further outwards count twice against a line, those
/// further inwards not at all. points in the order of Along. Support is 0 for fewer than 8 points.
BorderLine FindBorderLine(
  const std::vector<BorderPoint>& points, double outwards, double tolerance);

struct BorderLevel
{
  double Value = 0;
  double Support = 0;
};

/// The same for a border of constant Across. Support is 0 when there are no values.
BorderLevel FindBorderLevel(const std::vector<double>& values, double outwards, double tolerance);
}
#endif
