// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Which pixels around a defect carry the fit, and what is wrong with them.
#ifndef lacunaSupportSelection_h
#define lacunaSupportSelection_h

#include "lacunaHoleSupport.h"

#include <string>
#include <vector>

namespace lacuna
{
class Execution;

/// Two edge neighbours of the support whose depths differ by more than this times their distance
/// are taken to lie on different surfaces: 79 degrees, where Gordon's weights (Carr 1996,
/// section 3.3.2.1) also stop trusting a difference. Over pixels that are not support 65 degrees do:
/// no pixel between them shows that the surface goes on.
constexpr double MaximumSupportSlope = 5;

/// What became of a pixel near the defect.
enum class SupportUse : unsigned char
{
  None = 0,       ///< not near the defect, not painted, or without a depth
  Used = 1,       ///< carries the fit
  BeyondStep = 2, ///< left out, since a depth step parts it from the larger part
  Steep = 3,      ///< carries the fit, but is steeper than 65 degrees against the map
  NoPrior = 4,    ///< carries the fit, and takes the place of the prior surface, which is not there
  NearStep = 5    ///< left out, since a depth step or a pixel without a depth is near
};

/// A parallel depth map and what is marked on it. All arrays have Grid.GetSize() elements.
struct MarkedMap
{
  MapGrid Grid;
  std::vector<double> Depth; ///< mm
  MapMask Valid;             ///< where Depth counts; it must be finite there
  MapMask Defect;            ///< what to replace and fill, valid or not
  /// Pixels that may carry the fit; empty means those within SupportMargin of the defect.
  MapMask Painted;
};

struct SupportMargins
{
  double Defect = 12; ///< how far from the defect the surface is used, mm, > 0
  /// Not used is what lies within this distance of a pixel without a depth or of one that differs
  /// from an edge neighbour by more than 65 degrees of slope, mm, >= 0; and 65 degrees divide the
  /// surface then instead of MaximumSupportSlope. 0: this is not looked at.
  double Step = 0;
};

struct SupportSelection
{
  std::vector<SupportUse> Use;       ///< of each pixel
  MapMask Support;                   ///< where Use is Used, Steep or NoPrior
  std::vector<std::string> Warnings; ///< sentences for the user
};

/// The painted pixels, or those within margins.Defect of the defect, that are valid, outside of the
/// defect, not beyond a depth step (RemoveBeyondSteps), and of what is left farther than margins.Step from steps and holes. Steps and holes count in the
/// defect, too: its rim is rounded by the partial volume effect wherever it was marked. Those where
/// the prior is NaN (empty: no prior) are marked, with a warning. Warns of what was left out unless margins.Step asked for it, of steep pixels, of a defect at the border of
/// the map and of one that has no support along a quarter of its edge or more. Throws
/// std::invalid_argument when nothing is left.
SupportSelection SelectSupport(Execution& execution, const MarkedMap& map,
  const SupportMargins& margins, const std::vector<double>& prior);
}
#endif
