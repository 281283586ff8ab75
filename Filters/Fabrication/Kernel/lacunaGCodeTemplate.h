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

/// The template's lines in upper case without empty ones, placeholders filled in: values are names and
/// what they stand for. Throws std::invalid_argument that quotes the word for
/// - an unknown placeholder, characters that controls do not know, comments without end, macros;
/// - a G word that is not of a few that leave the meaning of the path's coordinates and feeds alone
///   (so no inches, increments, other planes, offsets of the tool, scales, mirrors, turns, shifts of
///   the zero, arcs or cycles), a work offset other than options.WorkOffset, a subprogram, the end of
///   the program in the header;
/// - a coordinate without a decimal point, which the control would read as micrometres;
/// - X, Y or Z outside of options.Envelope, Z below LeastZ. Not those with G53, which are the machine's.
std::vector<std::string> FillInTemplate(const GCodeTemplate& source,
  const std::vector<std::pair<std::string, std::string>>& values, const GCodeOptions& options);
}
#endif
