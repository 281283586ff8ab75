// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A strict reader of G-code for tests, written from the control's manual and not from the writer:
/// throws std::runtime_error at whatever a Fanuc 0-M would not take or would misread.
#ifndef lacunaGCodeParser_h
#define lacunaGCodeParser_h

#include <array>
#include <cmath>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

/// What the machine does with a program.
class GCodeParser
{
public:
  struct Step
  {
    bool Rapid;
    std::array<double, 3> To;
    double Feed;
    bool Arc = false; ///< one of the short steps that an arc is divided into
  };
  std::vector<Step> Steps; ///< where it goes once x, y and z are known
  std::vector<std::string> Comments;
  std::vector<int> Numbers; ///< of lines
  int Program = 0;
  int Tool = 0;
  int Blocks = 0;
  int Arcs = 0;
  int Plane = 0; ///< at the end
  double Speed = 0;
  bool Ended = false;

  explicit GCodeParser(const std::string& text)
  {
    std::istringstream lines(text);
    std::string line;
    int tapes = 0;
    while (std::getline(lines, line))
    {
      if (line == "%")
      {
        ++tapes;
        continue;
      }
      Require(tapes == 1, "between two % only", line);
      Require(!this->Ended, "nothing after M30", line);
      this->Read(line);
    }
    Require(tapes == 2 && text.back() == '\n', "starts and ends with %", text.substr(0, 20));
    Require(this->Ended, "M30", text.substr(0, 20));
  }

private:
  static void Require(bool condition, const std::string& what, const std::string& line)
  {
    if (!condition)
    {
      throw std::runtime_error("G-code: " + what + ": '" + line + "'");
    }
  }

  // Letter to number; several G words are kept in order.
  void Read(const std::string& line)
  {
    Require(line.size() <= 80 && !line.empty(), "length", line);
    for (const char c : line)
    {
      Require(c >= ' ' && c <= 'Z' + 3 && !(c >= 'a' && c <= 'z'), "character", line);
    }
    if (line.front() == '(')
    {
      Require(line.find(')') == line.size() - 1 && line.find('(', 1) == std::string::npos,
        "comment", line);
      this->Comments.push_back(line.substr(1, line.size() - 2));
      return;
    }
    std::map<char, std::string> words;
    std::vector<int> g;
    for (std::size_t k = 0; k < line.size();)
    {
      if (line[k] == ' ')
      {
        ++k;
        continue;
      }
      const char letter = line[k++];
      Require(letter >= 'A' && letter <= 'Z', "a word starts with a letter", line);
      std::string number;
      while (k < line.size() && std::string("+-.0123456789").find(line[k]) != std::string::npos)
      {
        number += line[k++];
      }
      Require(!number.empty(), "a word has a number", line);
      if (letter == 'G')
      {
        g.push_back(std::stoi(number));
        continue;
      }
      Require(words.count(letter) == 0, "a letter once in a block", line);
      words[letter] = number;
    }
    if (words.count('O'))
    {
      Require(words['O'].size() == 4 && this->Program == 0, "O number", line);
      this->Program = std::stoi(words['O']);
      return;
    }
    Require(this->Program > 0, "O number first", line);
    ++this->Blocks;
    this->Run(words, g, line);
  }

  void Run(std::map<char, std::string>& words, const std::vector<int>& g, const std::string& line)
  {
    bool length = false;
    for (const int code : g)
    {
      switch (code)
      {
        case 0:
        case 1:
        case 2:
        case 3:
          this->Mode = code;
          break;
        case 17:
        case 18:
        case 19:
          this->Plane = code;
          break;
        case 21:
          this->Metric = true;
          break;
        case 90:
          this->Absolute = true;
          break;
        case 94:
          this->PerMinute = true;
          break;
        case 43:
          length = true;
          break;
        case 40:
        case 49:
        case 80:
          break;
        default:
          Require(code >= 54 && code <= 59, "known G word", line);
      }
    }
    if (words.count('N'))
    {
      this->Numbers.push_back(std::stoi(words['N']));
      Require(this->Numbers.back() >= 1 && this->Numbers.back() <= 9999, "N number", line);
    }
    this->Tool = words.count('T') ? std::stoi(words['T']) : this->Tool;
    this->Speed = words.count('S') ? std::stod(words['S']) : this->Speed;
    Require(!length || words.count('H'), "H with G43", line);
    if (words.count('M'))
    {
      const int code = std::stoi(words['M']);
      Require(code == 3 || code == 5 || code == 6 || code == 30, "known M word", line);
      this->Spindle = code == 3 || (this->Spindle && code != 5);
      this->Ended = code == 30;
      Require(code != 3 || this->Speed > 0, "S before M03", line);
    }
    if (words.count('F'))
    {
      this->Feed = GetReal(words['F'], line);
      Require(this->Feed > 0, "feed", line);
    }
    const std::array<double, 3> start = this->At;
    bool moved = false;
    for (int c = 0; c < 3; ++c)
    {
      const auto word = words.find("XYZ"[c]);
      if (word != words.end())
      {
        this->At[c] = GetReal(word->second, line);
        moved = true;
      }
    }
    if (moved)
    {
      Require(this->Metric && this->Absolute && this->Mode >= 0, "G21, G90 and G00 to G03", line);
      Require(this->Mode == 0 || (this->Spindle && this->Feed > 0 && this->PerMinute),
        "cuts turn and feed", line);
      if (this->Mode > 1)
      {
        this->RunArc(start, words, line);
      }
      else if (std::isfinite(this->At[0] + this->At[1] + this->At[2]))
      {
        this->Steps.push_back({ this->Mode == 0, this->At, this->Feed });
      }
    }
  }

  // From the start about the centre, which is given from the start, to where it is now. Turns are
  // about the axis that the plane is upright on, by the right hand: G03 forwards, G02 backwards.
  void RunArc(const std::array<double, 3>& start, const std::map<char, std::string>& words,
    const std::string& line)
  {
    Require(this->Plane >= 17, "G17, G18 or G19 before an arc", line);
    const int planes[3][3] = { { 0, 1, 2 }, { 2, 0, 1 }, { 1, 2, 0 } }; // first, second, normal
    const int* axes = planes[this->Plane - 17];
    Require(this->At[axes[2]] == start[axes[2]], "an arc in its plane", line);
    double centre[2];
    for (int k = 0; k < 2; ++k)
    {
      const auto word = words.find("IJK"[axes[k]]);
      Require(word != words.end(), "both coordinates of the centre", line);
      centre[k] = start[axes[k]] + GetReal(word->second, line);
    }
    Require(words.count("IJK"[axes[2]]) == 0, "no centre off the plane", line);
    const auto radius = [&](const std::array<double, 3>& p)
    { return std::hypot(p[axes[0]] - centre[0], p[axes[1]] - centre[1]); };
    const auto angle = [&](const std::array<double, 3>& p)
    { return std::atan2(p[axes[1]] - centre[1], p[axes[0]] - centre[0]); };
    Require(std::abs(radius(this->At) - radius(start)) < 0.0005, "equal radii", line);
    const double pi = std::acos(-1.0);
    double turn = std::remainder(angle(this->At) - angle(start), 2 * pi);
    turn += this->Mode == 3 && turn <= 0 ? 2 * pi : this->Mode == 2 && turn >= 0 ? -2 * pi : 0;
    const int steps = 2 + static_cast<int>(std::abs(turn) / std::sqrt(8e-5 / radius(start)));
    for (int k = 1; k <= steps; ++k)
    {
      std::array<double, 3> p = this->At;
      if (k < steps)
      {
        const double t = static_cast<double>(k) / steps;
        const double r = (1 - t) * radius(start) + t * radius(this->At);
        p[axes[0]] = centre[0] + r * std::cos(angle(start) + t * turn);
        p[axes[1]] = centre[1] + r * std::sin(angle(start) + t * turn);
      }
      this->Steps.push_back({ false, p, this->Feed, true });
    }
    ++this->Arcs;
  }

  static double GetReal(const std::string& text, const std::string& line)
  {
    const std::size_t point = text.find('.');
    Require(point != std::string::npos, "a decimal point", line);
    Require(text.size() - point - 1 <= 3, "three decimals", line);
    Require(text.find_first_of("0123456789") != std::string::npos, "digits", line);
    return std::stod(text);
  }

  int Mode = -1;
  bool Metric = false;
  bool Absolute = false;
  bool PerMinute = false;
  bool Spindle = false;
  double Feed = 0;
  std::array<double, 3> At{ NAN, NAN, NAN };
};
#endif
