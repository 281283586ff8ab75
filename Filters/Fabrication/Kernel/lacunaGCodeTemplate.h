// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The lines that users write before and after the motions of a program.
#ifndef lacunaGCodeTemplate_h
#define lacunaGCodeTemplate_h

#include <string>
#include <utility>
#include <vector>

namespace lacuna
{
struct GCodeOptions;

/// A template and what it must keep to.
struct GCodeTemplate
{
  const char* Name; ///< of the property, for messages
  const std::string& Text;
  bool IsLast;   ///< after the motions: the program may end there
  double LeastZ; ///< mm, where the path starts or ends: the tool must not go below that
};

struct FilledTemplate
{
  std::vector<std::string> Lines;
  bool HasToolLength = false; ///< G43 with a number: coordinates behind it are those of the tip
  /// Clockwise: M03, or M13, and behind it no M04, M05, M06 or M14; the last S, if there is one, is above 0.
  bool SpindleTurns = false;
};

/// The template's lines in upper case without empty ones, tabs as blanks, placeholders filled in: values are names and
/// what they stand for. Throws std::invalid_argument that quotes the word for
/// - an unknown placeholder, characters that controls do not know, comments without end, macros, lines
///   of more than 74 characters (80 with a line number), a letter but G and M twice in a line;
/// - a G word that is not of a few that leave the meaning of the path's coordinates and feeds alone
///   (so no inches, increments, other planes, offsets of the tool, scales, mirrors, turns, shifts of
///   the zero, arcs or cycles; G91 only in the footer, to the reference point from where the tool is), a work offset other than options.WorkOffset, a subprogram, the end of
///   the program in the header, M21 and M22, which mirror on many machines (other M words are the
///   machine builder's and not judged);
/// - P with a work offset (G54 P2 is another one) or where it means nothing; A, B or C outside of
///   blocks with G28, G30 or G53; H without G43, 0 or other than options.ToolNumber, in the header
///   T of another tool, M06 without T, G49, T or M06 with or behind G43, in the footer Z behind G49 or
///   M06;
/// - a coordinate without a decimal point, which the control would read as micrometres;
/// - X, Y or Z outside of options.Envelope, Z below LeastZ. Not those with G53, which are the machine's.
FilledTemplate FillInTemplate(const GCodeTemplate& source,
  const std::vector<std::pair<std::string, std::string>>& values, const GCodeOptions& options);
}
#endif
