// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A strict reader of IGES files for tests, written from the specification and not from the writer:
/// throws std::runtime_error at whatever deviates from the fixed form.
#ifndef lacunaIGESParser_h
#define lacunaIGESParser_h

#include <cstdlib>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

struct IGESParser
{
  struct Entity
  {
    long Type = 0;
    long Form = 0;
    long Level = 0;
    long Colour = 0;
    std::string Status;
    std::string Label;
    std::vector<std::string> Parameters; // after the type
  };

  std::vector<std::string> Start;
  std::vector<std::string> Global;
  std::map<long, Entity> Entities; // by directory entry number

  explicit IGESParser(const std::string& text)
  {
    this->SplitSections(text);
    this->Global = Split(Joined(this->Sections['G'], 72), true);
    Require(this->Global.size() == 26, "26 global parameters");
    this->ReadDirectory();
    for (const std::string& line : this->Sections['S'])
    {
      this->Start.push_back(line.substr(0, 72));
    }
  }

  static long Integer(const std::string& token)
  {
    Require(!token.empty() && token.find_first_not_of("-+0123456789") == std::string::npos,
      "integer '" + token + "'");
    return std::stol(token);
  }

  static double Real(const std::string& token)
  {
    Require(token.find('.') != std::string::npos, "decimal point in '" + token + "'");
    Require(token.find_first_not_of("-+.0123456789ED") == std::string::npos, "real " + token);
    return std::stod(token); // tests run in locale C
  }

  static std::string String(const std::string& token)
  {
    const std::size_t h = token.find('H');
    Require(h != std::string::npos && std::stoul(token.substr(0, h)) == token.size() - h - 1,
      "Hollerith string '" + token + "'");
    return token.substr(h + 1);
  }

  static void Require(bool condition, const std::string& what)
  {
    if (!condition)
    {
      throw std::runtime_error("not as it shall be: " + what);
    }
  }

private:
  std::map<char, std::vector<std::string>> Sections;

  void SplitSections(const std::string& text)
  {
    Require(!text.empty() && text.back() == '\n', "last line ends");
    const std::string order = "SGDPT";
    std::size_t section = 0;
    for (std::size_t begin = 0; begin < text.size();)
    {
      const std::size_t end = text.find('\n', begin);
      const std::string line = text.substr(begin, end - begin);
      begin = end + 1;
      Require(line.size() == 80, "80 columns: " + line);
      for (const char c : line)
      {
        Require(c >= ' ' && c <= '~', "printable ASCII: " + line);
      }
      while (section < order.size() && line[72] != order[section])
      {
        Require(!this->Sections[order[section]].empty(), "sections in order");
        ++section;
      }
      Require(section < order.size(), "known section: " + line);
      this->Sections[order[section]].push_back(line);
      Require(Number(line.substr(73)) == static_cast<long>(this->Sections[order[section]].size()),
        "sequence number: " + line);
    }
    Require(this->Sections['T'].size() == 1, "one terminate line");
    const std::string& last = this->Sections['T'][0];
    for (std::size_t i = 0; i < 4; ++i)
    {
      Require(last[8 * i] == order[i] &&
          Number(last.substr(8 * i + 1, 7)) == static_cast<long>(this->Sections[order[i]].size()),
        "counts of the terminate line: " + last);
    }
    Require(last.substr(32, 40) == std::string(40, ' '), "rest of the terminate line");
  }

  // A right-justified number; blank is 0.
  static long Number(const std::string& field)
  {
    const std::size_t begin = field.find_first_not_of(' ');
    return begin == std::string::npos ? 0 : Integer(field.substr(begin));
  }

  static std::string Joined(const std::vector<std::string>& lines, std::size_t columns)
  {
    std::string all;
    for (const std::string& line : lines)
    {
      all += line.substr(0, columns);
    }
    return all;
  }

  // Parameters up to the record delimiter; blanks may pad lines between parameters only.
  static std::vector<std::string> Split(const std::string& record, bool global)
  {
    std::vector<std::string> tokens;
    std::size_t at = 0;
    for (;;)
    {
      at = record.find_first_not_of(' ', at);
      Require(at != std::string::npos, "record delimiter");
      std::size_t end = record.find_first_of(",;H ", at);
      Require(end != std::string::npos, "end of a parameter");
      if (record[end] == 'H')
      {
        end += 1 + std::stoul(record.substr(at, end - at));
      }
      Require(end < record.size() && (record[end] == ',' || record[end] == ';'),
        "delimiter after " + record.substr(at, end - at));
      Require(end > at, "no parameter left out");
      tokens.push_back(record.substr(at, end - at));
      at = end + 1;
      if (record[end] == ';')
      {
        break;
      }
    }
    Require(record.find_first_not_of(' ', at) == std::string::npos, "nothing after the record");
    Require(!global || (tokens[0] == "1H," && tokens[1] == "1H;"), "delimiters");
    return tokens;
  }

  void ReadDirectory()
  {
    const std::vector<std::string>& directory = this->Sections['D'];
    const std::vector<std::string>& data = this->Sections['P'];
    Require(directory.size() % 2 == 0, "two lines per entity");
    long expected = 1;
    for (std::size_t i = 0; i < directory.size(); i += 2)
    {
      const auto field = [&](std::size_t f)
      { return directory[i + f / 10].substr(8 * (f % 10), 8); };
      Entity entity;
      entity.Type = Number(field(0));
      Require(Number(field(10)) == entity.Type, "the same type twice");
      Require(Number(field(1)) == expected, "parameter pointer");
      for (const std::size_t f : { 2, 3, 5, 6, 7, 11, 18 })
      {
        Require(Number(field(f)) == 0, "zero field");
      }
      Require(field(15) + field(16) == std::string(16, ' '), "reserved fields");
      entity.Status = field(8);
      Require(entity.Status.find_first_not_of("0123456789") == std::string::npos, "status");
      entity.Level = Number(field(4));
      entity.Colour = Number(field(12));
      entity.Form = Number(field(14));
      entity.Label = field(17);
      const long lines = Number(field(13));
      Require(lines > 0 && expected + lines - 1 <= static_cast<long>(data.size()), "line count");
      std::string record;
      const auto number = static_cast<long>(i + 1);
      for (long k = expected - 1; k < expected - 1 + lines; ++k)
      {
        Require(data[k][64] == ' ' && Number(data[k].substr(65, 7)) == number,
          "back pointer: " + data[k]);
        // A number torn apart would show as a parameter that ends without a delimiter.
        const std::string part = data[k].substr(0, 64);
        const std::size_t last = part.find_last_not_of(' ');
        Require(last != std::string::npos, "no empty line");
        record += part;
      }
      entity.Parameters = Split(record, false);
      Require(Integer(entity.Parameters.at(0)) == entity.Type, "type in the parameters");
      entity.Parameters.erase(entity.Parameters.begin());
      Require(this->Entities.emplace(number, entity).second, "one entry");
      expected += lines;
    }
    Require(expected == static_cast<long>(data.size()) + 1, "every parameter line is used");
  }
};

/// The contents of a 128, checked for consistency.
struct IGESSurface
{
  long Upper[2];
  std::vector<double> Knots[2];
  std::vector<double> Points; // x, y, z, u fastest
  double Limits[4];
  std::vector<long> Properties;
  long Closed[2];

  explicit IGESSurface(const IGESParser::Entity& entity)
  {
    IGESParser::Require(entity.Type == 128 && entity.Form == 0, "a 128");
    std::size_t next = 0;
    const auto integer = [&] { return IGESParser::Integer(entity.Parameters.at(next++)); };
    const auto real = [&] { return IGESParser::Real(entity.Parameters.at(next++)); };
    this->Upper[0] = integer();
    this->Upper[1] = integer();
    const bool bicubic = integer() == 3 && integer() == 3;
    IGESParser::Require(bicubic, "degree 3 x 3");
    this->Closed[0] = integer();
    this->Closed[1] = integer();
    IGESParser::Require(integer() == 1, "polynomial");
    IGESParser::Require(integer() == 0, "not periodic in u");
    IGESParser::Require(integer() == 0, "not periodic in v");
    for (const int d : { 0, 1 })
    {
      for (long k = 0; k < this->Upper[d] + 5; ++k)
      {
        this->Knots[d].push_back(real());
        IGESParser::Require(k == 0 || this->Knots[d][k] >= this->Knots[d][k - 1], "knots grow");
      }
      for (long k = 1; k < 4; ++k)
      {
        IGESParser::Require(this->Knots[d][k] == this->Knots[d].front() &&
            this->Knots[d][this->Upper[d] + 4 - k] == this->Knots[d].back(),
          "clamped knots");
      }
    }
    const long size = (this->Upper[0] + 1) * (this->Upper[1] + 1);
    for (long k = 0; k < size; ++k)
    {
      IGESParser::Require(real() == 1, "weights are 1");
    }
    for (long k = 0; k < 3 * size; ++k)
    {
      this->Points.push_back(real());
    }
    for (double& limit : this->Limits)
    {
      limit = real();
    }
    for (const std::size_t d : { 0, 1 })
    {
      IGESParser::Require(this->Limits[2 * d] == this->Knots[d].front() &&
          this->Limits[2 * d + 1] == this->Knots[d].back(),
        "limits are the ends of the knots");
    }
    if (next < entity.Parameters.size())
    {
      IGESParser::Require(integer() == 0, "no associativities");
      for (long count = integer(); count > 0; --count)
      {
        this->Properties.push_back(integer());
      }
    }
    IGESParser::Require(next == entity.Parameters.size(), "nothing left over");
  }
};
#endif
