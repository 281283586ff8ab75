// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaGCodeTemplate.h"

#include "lacunaGCode.h"
#include "lacunaParameterText.h"

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <locale>
#include <sstream>
#include <stdexcept>
#include <string_view>

namespace lacuna
{
namespace
{
constexpr std::string_view AxisNames = "XYZ";
constexpr std::string_view Lengths = "XYZABC"; // words that need a decimal point
constexpr std::string_view Letters = "GMTSHFPXYZABC";
constexpr std::size_t LongestLine = 74; // 80 with a line number
constexpr double Dwell = 4;
constexpr double ToReference[] = { 28, 30 };
constexpr double MachineCoordinates = 53;
constexpr double Absolute = 90;
constexpr double Incremental = 91;
constexpr double ToolLength = 43;
constexpr double NoToolLength = 49;
// What leaves the path alone: rapid, straight, dwell, exact stop, no polar coordinates, XY plane, mm,
// ways to the reference points, no compensation, tool length, none, no scale, no mirror, machine
// coordinates, exact stop mode, cutting mode, no turn, no cycle, absolute, mm/min, levels of cycles.
constexpr double Harmless[] = { 0, 1, Dwell, 9, 15, 17, 21, 28, 30, 40, 43, 49, 50, 50.1,
  MachineCoordinates, 54, 55, 56, 57, 58, 59, 61, 64, 69, 80, 90, 94, 98, 99 };
constexpr const char* HarmlessNames =
  "G00, G01, G04, G09, G15, G17, G21, G28, G30, G40, G43, G49, G50, G53, {OFFSET}, G61, G64, G69, "
  "G80, G90, G94, G98 and G99";
constexpr double Subprograms[] = { 96, 97, 98, 99, 198 };
constexpr double Ends[] = { 2, 30 };
constexpr double ToolChange = 6;
constexpr double Clockwise[] = { 3, 13 };                   // 13: with coolant
constexpr double NotClockwise[] = { 4, 5, 14, ToolChange }; // backwards, stop, the change stops it
constexpr double Mirrors[] = { 21, 22 }; // of many machines with this control: x, y

struct Word
{
  char Letter;
  std::string Text; // as written, with the letter
  double Number;
};

template <std::size_t N>
bool Has(const double (&list)[N], double value)
{
  return std::find(list, list + N, value) != list + N;
}

//------------------------------------------------------------------------------
class Reader
{
public:
  Reader(const GCodeTemplate& source, const GCodeOptions& options)
    : Source(source)
    , Options(options)
  {
  }

  std::string FillIn(const std::vector<std::pair<std::string, std::string>>& values) const
  {
    const std::string& text = this->Source.Text;
    std::string filled;
    for (std::size_t k = 0; k < text.size();)
    {
      if (text[k] != '{')
      {
        filled += static_cast<char>(std::toupper(static_cast<unsigned char>(text[k++])));
        continue;
      }
      const std::size_t end = text.find('}', k);
      const std::string name =
        text.substr(k + 1, end == std::string::npos ? std::string::npos : end - k - 1);
      const auto value = std::find_if(
        values.begin(), values.end(), [&name](const auto& known) { return known.first == name; });
      if (value == values.end() || end == std::string::npos)
      {
        this->Throw("has the placeholder '{" + name +
          "}'; {PROGRAM}, {TOOL}, {OFFSET}, {SPEED}, {X}, {Y} and {Z} are known");
      }
      filled += value->second;
      k = end + 1;
    }
    return filled;
  }

  // The words of a line outside of its comments.
  std::vector<Word> Split(const std::string& line) const
  {
    std::vector<Word> words;
    bool comment = false;
    for (std::size_t k = 0; k < line.size();)
    {
      const char c = line[k];
      if (c < ' ' || c > '~' || c == '%' || (c == '(' && comment) || (c == ')' && !comment))
      {
        this->Throw("has a character that has no place there: '" +
          (c >= ' ' && c <= '~' ? std::string(1, c) : std::string("not ASCII")) + "'");
      }
      comment = c == '(' || (comment && c != ')');
      if (comment || c == ')' || c == ' ')
      {
        ++k;
        continue;
      }
      std::size_t end = line.find_first_not_of("+-.0123456789 ", k + 1);
      end = end == std::string::npos ? line.size() : end;
      words.push_back(this->ReadWord(line.substr(k, end - k)));
      k = end;
    }
    if (comment)
    {
      this->Throw("has a comment without its end: '" + line + "'");
    }
    return words;
  }

  void JudgeLength(const std::string& line) const
  {
    if (line.size() > LongestLine)
    {
      this->Throw("has a line of " + std::to_string(line.size()) + " characters, more than the " +
        std::to_string(LongestLine) + " that controls take: '" + line.substr(0, 40) + "...'");
    }
  }

  void Judge(const std::vector<Word>& words)
  {
    this->JudgeRepeats(words);
    const auto isG = [&words](double number)
    {
      return std::any_of(words.begin(), words.end(),
        [number](const Word& word) { return word.Letter == 'G' && word.Number == number; });
    };
    const bool dwells = isG(Dwell);
    const bool ofMachine = isG(MachineCoordinates);
    const bool toReference = isG(ToReference[0]) || isG(ToReference[1]);
    this->JudgeIncrements(
      words, isG(Absolute), isG(Incremental), toReference && !ofMachine, dwells);
    this->JudgeToolLength(words, isG(ToolLength), isG(NoToolLength));
    this->JudgeTool(words, isG(ToolLength));
    for (const Word& word : words)
    {
      switch (word.Letter)
      {
        case 'G':
          this->JudgeG(word);
          break;
        case 'M':
          if (Has(Subprograms, word.Number) || (Has(Ends, word.Number) && !this->Source.IsLast))
          {
            this->Throw("has " + word.Text + ", after which the path would " +
              (Has(Ends, word.Number) ? "not be run"
                                      : "depend on what the control does elsewhere"));
          }
          this->Turns =
            Has(Clockwise, word.Number) || (this->Turns && !Has(NotClockwise, word.Number));
          if (Has(Mirrors, word.Number))
          {
            this->Throw("has " + word.Text + ", which mirrors the path on many machines");
          }
          break;
        case 'S':
          this->Stands = !(word.Number > 0);
          break;
        case 'P':
          this->JudgeP(words, word, dwells || toReference);
          break;
        case 'A':
        case 'B':
        case 'C':
          if (!ofMachine && !toReference)
          {
            this->Throw("has " + word.Text +
              ", which turns the part against the path; there may be "
              "A, B and C in blocks with G28, G30 or G53 only");
          }
          break;
        default:
          if (!ofMachine && !this->Increments && !(dwells && word.Letter == 'X') && // X: seconds
            AxisNames.find(word.Letter) != std::string_view::npos)
          {
            this->JudgePlace(word);
          }
      }
    }
  }

  // Whether the tool's length is in force behind the lines so far.
  bool HasToolLength() const { return this->Length; }
  bool HasSpindleTurning() const { return this->Turns && !this->Stands; }

private:
  [[noreturn]] void Throw(const std::string& what) const
  {
    throw std::invalid_argument(this->Source.Name + (" " + what));
  }

  Word ReadWord(std::string text) const
  {
    text.erase(std::remove(text.begin(), text.end(), ' '), text.end());
    const char letter = text.front();
    const std::string number = text.substr(1);
    double value = 0;
    std::istringstream stream(number);
    stream.imbue(std::locale::classic());
    if (Letters.find(letter) == std::string_view::npos || !(stream >> value) || !stream.eof())
    {
      this->Throw("has '" + text +
        "'; outside of comments there may be words of one of the letters " + std::string(Letters) +
        " and a number");
    }
    if (Lengths.find(letter) != std::string_view::npos && number.find('.') == std::string::npos)
    {
      this->Throw("has '" + text +
        "' without a decimal point, which the control would read as micrometres; write '" + text +
        ".'");
    }
    return { letter, text, value };
  }

  // Of a letter that is twice in a block, controls heed the last, the first, or stop.
  void JudgeRepeats(const std::vector<Word>& words) const
  {
    for (auto word = words.begin(); word != words.end(); ++word)
    {
      const bool many = word->Letter == 'G' || word->Letter == 'M';
      const auto before = std::find_if(
        words.begin(), word, [&](const Word& other) { return other.Letter == word->Letter; });
      if (!many && before != word)
      {
        this->Throw(
          "has " + before->Text + " and " + word->Text + " in one line: write one of them");
      }
    }
  }

  void JudgeG(const Word& word) const
  {
    if (!Has(Harmless, word.Number) && !(word.Number == Incremental && this->Increments))
    {
      this->Throw("has " + word.Text +
        ", which may give the path's coordinates or feeds another meaning; of G words there may "
        "be " +
        HarmlessNames);
    }
    const double offset = this->Options.WorkOffset;
    if (word.Number >= 54 && word.Number <= 59 && word.Number != offset)
    {
      this->Throw("has " + word.Text + ", and WorkOffset is " + FormatNumber(offset) +
        "; write {OFFSET} and set WorkOffset");
    }
  }

  // P is the time of a dwell, the number of a reference point, or the builder's with an M word; with
  // G54 it chooses one of 48 other zeros.
  void JudgeP(const std::vector<Word>& words, const Word& p, bool isOwn) const
  {
    const bool offset = std::any_of(words.begin(), words.end(),
      [](const Word& word)
      { return word.Letter == 'G' && word.Number >= 54 && word.Number <= 59; });
    const bool ofBuilder =
      std::any_of(words.begin(), words.end(), [](const Word& word) { return word.Letter == 'M'; });
    if (offset || !(isOwn || ofBuilder))
    {
      this->Throw("has " + p.Text +
        (offset ? " with a work offset, which takes another zero than WorkOffset (G54 P1 to P48)"
                : ", which means nothing there; P may stand with G04, G28, G30 or an M word"));
    }
  }

  // G91 leads nowhere but to the reference point, from where the tool is (G91 G28 Z0.).
  void JudgeIncrements(
    const std::vector<Word>& words, bool absolute, bool incremental, bool toReference, bool dwells)
  {
    const Word* axis = nullptr; // one that says more than 0, if there is one
    for (const Word& word : words)
    {
      if (Lengths.find(word.Letter) != std::string_view::npos && !(dwells && word.Letter == 'X') &&
        (!axis || axis->Number == 0))
      {
        axis = &word;
      }
    }
    const bool home = axis && axis->Number == 0 && toReference;
    if (incremental)
    {
      this->Increments = home && !absolute && this->Source.IsLast; // else JudgeG refuses it
      return;
    }
    this->Increments = this->Increments && !absolute;
    if (this->Increments && axis && !home)
    {
      this->Throw("has " + axis->Text + " behind G91; write G90 before it");
    }
  }

  // G43 with its number, which G49 or the number 0 takes away.
  void JudgeToolLength(const std::vector<Word>& words, bool on, bool off)
  {
    for (const Word& word : words)
    {
      if (word.Letter == 'H' && (!on || !(word.Number > 0)))
      {
        this->Throw("has " + word.Text +
          (on ? " with G43, which is no tool's length"
              : " without G43, whose number it would change"));
      }
      if (word.Letter == 'H' && word.Number != this->Options.ToolNumber)
      {
        this->Throw("has " + word.Text + ", and ToolNumber is " +
          std::to_string(this->Options.ToolNumber) +
          ": Z would be by another tool's length. Write H{TOOL} and set ToolNumber");
      }
      this->Length = this->Length || (on && word.Letter == 'H');
    }
    this->Cancelled = (this->Cancelled || off) && !on;
    if (off && (on || this->Length) && !this->Source.IsLast)
    {
      this->Throw(
        "has G49 with or after G43, which takes the tool's length away again: the spindle "
        "nose would go where the tip should. Leave it out");
    }
  }

  // Before the path the tool that its length is of, once; behind it any, and no Z by the wrong length.
  void JudgeTool(const std::vector<Word>& words, bool lengthHere)
  {
    const std::string number = std::to_string(this->Options.ToolNumber);
    const Word* change = nullptr;
    for (const Word& word : words)
    {
      const bool changes = word.Letter == 'M' && word.Number == ToolChange;
      change = changes ? &word : change;
      if (this->Source.IsLast || (word.Letter != 'T' && !changes))
      {
        continue;
      }
      if (word.Letter == 'T' && word.Number != this->Options.ToolNumber)
      {
        this->Throw("has " + word.Text + ", and ToolNumber is " + number +
          ": Z would be by another tool's length. Write T{TOOL} and set ToolNumber; the next tool "
          "may be chosen in Footer");
      }
      if (this->Length || lengthHere)
      {
        this->Throw("has " + word.Text +
          " with or after G43: the tool is changed, and its length is not. Write it before");
      }
      this->Chosen = this->Chosen || word.Letter == 'T';
    }
    if (change && !this->Source.IsLast && !this->Chosen)
    {
      this->Throw("has " + change->Text +
        " without T before it, so there is no telling which tool comes. Write T{TOOL} M06");
    }
    this->Changed = this->Changed || change;
  }

  void JudgePlace(const Word& word) const
  {
    const std::size_t axis = AxisNames.find(word.Letter);
    const double* range = this->Options.Envelope + 2 * axis;
    if (this->Options.HasEnvelope && !(word.Number >= range[0] && word.Number <= range[1]))
    {
      this->Throw("has " + word.Text + ", which leaves the envelope (" + word.Letter + " " +
        FormatNumber(range[0]) + " to " + FormatNumber(range[1]) + " mm)");
    }
    if (word.Letter == 'Z' && this->Source.IsLast && (this->Cancelled || this->Changed))
    {
      this->Throw("has " + word.Text +
        (this->Cancelled
            ? " with or after G49: that is where the spindle nose goes, and the tip into the part. "
              "Write it before G49"
            : " with or after M06: that is by the length of the tool before. Write it before M06") +
        ", or with G53 in machine coordinates");
    }
    if (word.Letter == 'Z' && !(word.Number >= this->Source.LeastZ))
    {
      this->Throw("has " + word.Text + ", below where the path " +
        (this->Source.IsLast ? "ends" : "starts") + " (Z " + FormatNumber(this->Source.LeastZ) +
        "): the tool might go into the part. Write a higher one, or with G53 one of the machine's");
    }
  }

  const GCodeTemplate& Source;
  const GCodeOptions& Options;
  bool Increments = false; // G91 in the footer
  bool Length = false;     // G43 H
  bool Cancelled = false;  // G49 in the footer
  bool Chosen = false;     // T in the header
  bool Changed = false;    // M06
  bool Turns = false;      // M03
  bool Stands = false;     // S0
};
}

//------------------------------------------------------------------------------
FilledTemplate FillInTemplate(const GCodeTemplate& source,
  const std::vector<std::pair<std::string, std::string>>& values, const GCodeOptions& options)
{
  Reader reader(source, options);
  std::istringstream text(reader.FillIn(values));
  FilledTemplate filled;
  std::string line;
  while (std::getline(text, line))
  {
    line.erase(std::remove(line.begin(), line.end(), '\r'), line.end());
    std::replace(line.begin(), line.end(), '\t', ' ');
    line.erase(0, line.find_first_not_of(' '));
    if (!line.empty())
    {
      reader.JudgeLength(line);
      reader.Judge(reader.Split(line));
      filled.Lines.push_back(line);
    }
  }
  filled.HasToolLength = reader.HasToolLength();
  filled.SpindleTurns = reader.HasSpindleTurning();
  return filled;
}
}
