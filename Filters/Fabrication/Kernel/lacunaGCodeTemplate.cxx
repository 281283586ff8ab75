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
constexpr double Dwell = 4;
constexpr double MachineCoordinates = 53;
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

  void Judge(const std::vector<Word>& words) const
  {
    const auto isG = [&words](double number)
    {
      return std::any_of(words.begin(), words.end(),
        [number](const Word& word) { return word.Letter == 'G' && word.Number == number; });
    };
    const bool dwells = isG(Dwell);
    const bool ofMachine = isG(MachineCoordinates);
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
          break;
        default:
          if (!ofMachine && !(dwells && word.Letter == 'X') && // X: seconds
            AxisNames.find(word.Letter) != std::string_view::npos)
          {
            this->JudgePlace(word);
          }
      }
    }
  }

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

  void JudgeG(const Word& word) const
  {
    if (!Has(Harmless, word.Number))
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

  void JudgePlace(const Word& word) const
  {
    const std::size_t axis = AxisNames.find(word.Letter);
    const double* range = this->Options.Envelope + 2 * axis;
    if (this->Options.HasEnvelope && !(word.Number >= range[0] && word.Number <= range[1]))
    {
      this->Throw("has " + word.Text + ", which leaves the envelope (" + word.Letter + " " +
        FormatNumber(range[0]) + " to " + FormatNumber(range[1]) + " mm)");
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
};
}

//------------------------------------------------------------------------------
std::vector<std::string> FillInTemplate(const GCodeTemplate& source,
  const std::vector<std::pair<std::string, std::string>>& values, const GCodeOptions& options)
{
  const Reader reader(source, options);
  std::istringstream text(reader.FillIn(values));
  std::vector<std::string> lines;
  std::string line;
  while (std::getline(text, line))
  {
    line.erase(std::remove(line.begin(), line.end(), '\r'), line.end());
    if (!line.empty())
    {
      reader.Judge(reader.Split(line));
      lines.push_back(line);
    }
  }
  return lines;
}
}
