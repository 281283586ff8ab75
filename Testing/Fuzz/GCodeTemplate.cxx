// SPDX-License-Identifier: BSD-3-Clause
// A user's header, footer and comments around a path: whatever they are, the program is refused or
// moves the tool as the path says.
#include "lacunaFuzzTarget.h"
#include "lacunaGCode.h"
#include "lacunaGCodeParser.h"

#include <sstream>

using namespace lacuna;
using namespace lacuna_fuzz;

namespace
{
const Vec3 Start{ 0, 0, 20 };
const std::vector<GCodeMove> Path{ { true, { 1, 2, 20 }, 0 }, { false, { 1, 2, 5 }, 100 },
  { false, { 4, 2.5, 4 }, 300 }, { true, { 4, 2.5, 20 }, 0 } };

// The strict reader knows what the default templates need, and comments have no meaning.
void ReadBack(const std::string& text)
{
  const GCodeParser program(text);
  std::size_t found = 0;
  for (const GCodeParser::Step& step : program.Steps)
  {
    const GCodeMove& next = Path[std::min(found, Path.size() - 1)];
    found += step.Rapid == next.Rapid && step.To[0] == next.To[0] && step.To[1] == next.To[1] &&
      step.To[2] == next.To[2];
  }
  Require(found >= Path.size(), "the path is in the program");
}
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
  Bytes bytes(data, size);
  const std::uint8_t choice = bytes.Take();
  GCodeOptions options;
  options.LineNumbers = choice & 1;
  if (choice & 2)
  {
    options.Comments.push_back(bytes.TakeText());
  }
  if (choice & 4)
  {
    options.HasEnvelope = true;
    const double envelope[6] = { -10, 10, -10, 10, 0, 50 };
    std::copy(std::begin(envelope), std::end(envelope), std::begin(options.Envelope));
  }
  const bool own = (choice & 24) != 0;
  if (choice & 8)
  {
    options.Header = bytes.TakeText();
  }
  if (choice & 16)
  {
    options.Footer = bytes.TakeText();
  }
  GCodeProgram program;
  try
  {
    program = MakeGCode(Start, Path, options);
  }
  catch (const std::invalid_argument& error)
  {
    RequireSentence(error);
    return 0;
  }
  std::istringstream lines(program.Text);
  std::string line;
  while (std::getline(lines, line))
  {
    Require(line.size() <= 80 && !line.empty(), "lines that a control takes");
    for (const char c : line)
    {
      Require(c >= ' ' && c <= '~' && !(c >= 'a' && c <= 'z'), "characters that a control knows");
    }
  }
  if (!own)
  {
    ReadBack(program.Text);
  }
  return 0;
}
