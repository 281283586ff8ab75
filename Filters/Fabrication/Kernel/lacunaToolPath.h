// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Three-axis roughing and finishing paths over a surface.
#ifndef lacunaToolPath_h
#define lacunaToolPath_h

#include "lacunaDropCutter.h"
#include "lacunaProperties.h"

#include <cstdint>
#include <string>
#include <vector>

namespace lacuna
{
class Execution;

/// Lengths in mm.
struct ToolPathOptions
{
  MillTool Tool;
  double StepOver = 1;      ///< largest distance of finishing lines, as the mill sees it
  double ScallopHeight = 0; ///< > 0: the lines' distances follow from it instead; ball ends only
  double Overrun = 0;       ///< of the lines beyond the rectangle around the surface, on each side
  double Direction = 0;     ///< of the lines, degrees from x towards y
  bool OneWay = false;      ///< all lines in the same sense; otherwise to and fro
  double PathStep = 0;      ///< largest distance of positions on a line; 0: the surface's spacing
  double Tolerance = 0.005; ///< largest height that a straight motion leaves above the tool's own
  bool Finishing = true;
  double RoughingStep = 0;     ///< depth of the levels of roughing; 0: none; or AutomaticRoughing
  double RoughingStepOver = 0; ///< 0: the tool's radius
  /// Half of the tool's radius where finishing alone would take off more than the radius, else none.
  static constexpr double AutomaticRoughing = -1;
  double StockAllowance = 0.5; ///< left by roughing
  double StockTop = 0;         ///< z; the surface's highest point if that is higher
  double SafeHeight = 5;       ///< of rapid motions above the stock
  double LeadRadius = 2;       ///< of the quarter circles into and out of finishing cuts; 0: none

  void Describe(Properties& properties) const; ///< with the ranges, but for OneWay
};

/// What the machine does on the way to a point.
enum class Motion : unsigned char
{
  Rapid = 0,
  Plunge = 1,
  Cut = 2,
  Lead = 3
};

/// A path of the tool's tip, from SafeZ to SafeZ. All coordinates are whole micrometres, z rounded
/// up.
struct ToolPath
{
  /// Consecutive points with the same kind of motion; the first is the last one of the run before.
  struct Run
  {
    Motion Kind;
    std::int32_t Pass; ///< 0, 1, .. the levels of roughing, then the finishing
    std::int64_t First;
    std::int64_t Count;
  };
  std::vector<Vec3> Points;
  std::vector<Run> Runs;
  std::int32_t Levels = 0;    ///< of roughing
  double LargestStepOver = 0; ///< between finishing lines; 0: less than two
  double SmallestStepOver = 0;
  double StockTop = 0; ///< as used
  double SafeZ = 0;    ///< where rapid motions are
  std::vector<std::string> Warnings;
};

/// Largest step-over, on a plane, at which a ball end leaves scallops of no more than height.
double GetStepOver(double radius, double height);

/// Makes the path. No position and no straight motion between two of them cuts deeper into the
/// surface than MotionTolerance: positions are added where one would, or the motion lifted.
/// Lines lie within the rectangle around the surface, made larger by Overrun, and reach its borders;
/// outside of the surface's rectangle they go on as they reach its border (DropCutter::DropBeyond).
/// Rapid motions go straight up, level at SafeZ; the lead-ins start up to LeadRadius outside of that.
/// Throws std::invalid_argument for options out of range, std::runtime_error when the path would
/// not fit into memory.
ToolPath MakeToolPath(
  Execution& execution, const MillSurface& surface, const ToolPathOptions& options);

constexpr double MotionTolerance = 0.0005; ///< mm
}
#endif
