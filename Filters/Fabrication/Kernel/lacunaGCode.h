// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Programs for milling machines with a Fanuc 0-M control.
#ifndef lacunaGCode_h
#define lacunaGCode_h

#include "lacunaProperties.h"
#include "lacunaVector.h"

#include <cstdint>
#include <string>
#include <vector>

namespace lacuna
{
class Execution;

/// A straight motion.
struct GCodeMove
{
  bool Rapid;
  Vec3 To;     ///< mm
  double Feed; ///< mm/min, of motions that are not rapid
};

struct GCodeOptions
{
  int ProgramNumber = 1;
  int ToolNumber = 1;         ///< also of its length offset
  int WorkOffset = 54;        ///< of G54 to G59
  double SpindleSpeed = 6000; ///< turns per minute, rounded
  bool LineNumbers = false;   ///< N10, N20 to N9990, then N10 again
  /// Lines before and after the motions, see DefaultHeader. {PROGRAM}, {TOOL} (two digits),
  /// {OFFSET} (G54), {SPEED} and {X}, {Y}, {Z} (where the path starts) are filled in. See
  /// FillInTemplate for what they may contain.
  std::string Header;
  std::string Footer;
  bool HasEnvelope = false;
  double Envelope[6] = { 0, 0, 0, 0, 0, 0 }; ///< least and largest x, y, z that may be reached
  /// mm; > 0: cuts in upright planes along x or y are joined to arcs and longer straight motions,
  /// which lie on them or at most this much above (see ArcFit).
  double ArcTolerance = 0;
  std::vector<std::string> Comments; ///< at the top, in any characters

  GCodeOptions();
  /// The numbers, with their ranges. SpindleSpeed may be 0, which MakeGCode does not take.
  void Describe(Properties& properties) const;
  static const char* DefaultHeader();
  static const char* DefaultFooter();
};

struct GCodeProgram
{
  std::string Text;
  std::int64_t Blocks = 0;           ///< lines but %, program number and comments
  std::vector<std::string> Warnings; ///< a header without the tool's length
};

/// A program that starts at start and runs the motions. Metric, absolute, G00 and G01, and with
/// ArcTolerance G02 and G03 with I, J, K in the planes G18 and G19, back to G17 at the end. Every
/// coordinate has a decimal point and at most three decimals: x and y are rounded to the nearest
/// micrometre, z up, so that rounding takes the tool no deeper into a surface than 0.71 um. Words
/// that do not change are left out; so are motions to where the tool is. The first block, before the
/// header, is G21 G17 G40 G49 G80 G90 G94 and the work offset (G54); the first ones after the header go to start, first in x and y,
/// then in z.
///
/// Throws std::invalid_argument, naming the motion, when a number is not finite, beyond 99 999.999
/// mm or outside of the envelope, a feed is not above 0, a rapid motion is neither upright nor
/// level (controls run the axes at speeds of their own there, not along the line), the path does not
/// start with a rapid motion or straight down and end with a rapid one; for options out of range; for
/// templates that FillInTemplate refuses. With an execution it reports progress, and throws Aborted
/// when that is stopped.
GCodeProgram MakeGCode(const Vec3& start, const std::vector<GCodeMove>& moves,
  const GCodeOptions& options, Execution* execution = nullptr);
}
#endif
