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

// What any control makes of a program whose templates may have words of its builder.
class LenientReader
{
public:
  std::vector<GCodeMove> Moves;

  explicit LenientReader(const std::string& text)
  {
    std::istringstream lines(text);
    std::string line;
    while (std::getline(lines, line))
    {
      if (line.front() != '%' && line.front() != 'O')
      {
        this->Read(line);
      }
    }
  }

private:
  // Without blanks and comments.
  static std::string Strip(const std::string& line)
  {
    std::string words;
    bool comment = false;
    for (const char c : line)
    {
      comment = comment || c == '(';
      words += comment || c == ' ' ? "" : std::string(1, c);
      comment = comment && c != ')';
    }
    return words;
  }

  void Read(const std::string& line)
  {
    const std::string words = Strip(line);
    Vec3 to = this->Place;
    bool moves = false, elsewhere = false;
    for (std::size_t k = 0; k < words.size();)
    {
      const char letter = words[k];
      const std::size_t end =
        std::min(words.find_first_not_of("+-.0123456789", k + 1), words.size());
      const double number = std::stod(words.substr(k + 1, end - k - 1)); // no hexadecimal 0X0.P2
      k = end;
      const bool isAxis = letter >= 'X' && letter <= 'Z';
      moves = moves || isAxis;
      if (isAxis)
      {
        to[static_cast<std::size_t>(letter - 'X')] = number;
      }
      else if (letter == 'F')
      {
        this->Feed = number;
      }
      else if (letter == 'G' && (number == 0 || number == 1))
      {
        this->Rapid = number == 0;
      }
      else if (letter == 'G' && (number == 4 || number == 28 || number == 30 || number == 53))
      {
        elsewhere = true; // a time, or places of the machine
      }
    }
    if (moves && !elsewhere)
    {
      this->Place = to;
      this->Moves.push_back({ this->Rapid, to, this->Rapid ? 0 : this->Feed });
    }
  }

  Vec3 Place{};
  double Feed = 0;
  bool Rapid = true;
};

void FindPath(const std::string& text)
{
  std::size_t found = 0;
  for (const GCodeMove& move : LenientReader(text).Moves)
  {
    const GCodeMove& next = Path[std::min(found, Path.size() - 1)];
    found += move.Rapid == next.Rapid && move.To == next.To && move.Feed == next.Feed;
  }
  Require(found >= Path.size(), "the path is in the program, as it is");
}

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
  FindPath(program.Text);
  if (!own)
  {
    ReadBack(program.Text);
  }
  return 0;
}
