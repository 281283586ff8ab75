// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaPoseColumns.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <set>
#include <sstream>
#include <stdexcept>
#include <unordered_map>

namespace lacuna
{
namespace
{
using Names = std::vector<std::string>;

constexpr std::array<const char*, 3> FormatNames{ "Matrix", "Quaternion", "Euler" };
const std::set<std::string> Units{ "mm", "millimetres", "millimeters", "cm", "m", "metres",
  "meters", "in", "inch", "inches", "deg", "degree", "degrees", "rad", "radians", "s", "sec",
  "seconds", "ms" };

std::string ToLower(std::string text)
{
  std::transform(text.begin(), text.end(), text.begin(),
    [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

std::string KeepAlphanumeric(const std::string& text)
{
  std::string kept;
  std::copy_if(text.begin(), text.end(), std::back_inserter(kept),
    [](unsigned char c) { return std::isalnum(c) != 0; });
  return kept;
}

// A column's name without what writers of tables do differently.
struct PlainName
{
  explicit PlainName(const std::string& name)
  {
    std::string text = ToLower(name);
    const std::size_t bracket = text.find_first_of("[(");
    if (bracket != std::string::npos && bracket > 0)
    {
      const std::string inner = KeepAlphanumeric(text.substr(bracket));
      if (Units.count(inner) > 0)
      {
        this->Unit = inner;
        text.erase(bracket);
      }
    }
    else
    {
      const std::size_t separator = text.find_last_of("_ .");
      if (separator != std::string::npos && separator > 0 &&
        Units.count(text.substr(separator + 1)) > 0)
      {
        this->Unit = text.substr(separator + 1);
        text.erase(separator);
      }
    }
    this->Text = KeepAlphanumeric(text);
  }

  std::string Text;
  std::string Unit;
};

// Columns by their plain names; -1 for a name that several columns have: which of them is meant is
// not known.
class ColumnIndex
{
public:
  explicit ColumnIndex(const Names& names)
  {
    for (const std::string& name : names)
    {
      const auto column = static_cast<int>(this->Plain.size());
      this->Plain.emplace_back(name);
      const auto added = this->ByText.emplace(this->Plain.back().Text, column);
      if (!added.second)
      {
        added.first->second = -1;
      }
    }
  }

  // The columns of prefix + each name; empty unless all are there.
  std::vector<int> FindSet(const std::string& prefix, const Names& set) const
  {
    std::vector<int> found;
    for (const std::string& name : set)
    {
      const auto match = this->ByText.find(prefix + name);
      if (match == this->ByText.end() || match->second < 0)
      {
        return {};
      }
      found.push_back(match->second);
    }
    return found;
  }

  const std::vector<PlainName>& GetNames() const { return this->Plain; }

private:
  std::vector<PlainName> Plain;
  std::unordered_map<std::string, int> ByText;
};

std::string Quote(const Names& names)
{
  constexpr std::size_t most = 40;
  std::ostringstream text;
  for (std::size_t i = 0; i < std::min(most, names.size()); ++i)
  {
    text << (i ? ", " : "") << "'" << names[i] << "'";
  }
  if (names.size() > most)
  {
    text << " and " << names.size() - most << " more";
  }
  return names.empty() ? "no columns" : text.str();
}

using Choices = std::set<std::vector<int>>;

// All sets of names that are complete.
Choices FindSets(
  const ColumnIndex& columns, const std::string& prefix, const std::vector<Names>& sets)
{
  Choices choices;
  for (const Names& set : sets)
  {
    const std::vector<int> found = columns.FindSet(prefix, set);
    if (!found.empty())
    {
      choices.insert(found);
    }
  }
  return choices;
}

Choices FindPositions(const ColumnIndex& columns, const std::string& prefix)
{
  std::vector<Names> sets;
  for (const char* word : { "t", "", "p", "pos", "position", "trans", "translation" })
  {
    sets.push_back({ std::string(word) + "x", std::string(word) + "y", std::string(word) + "z" });
  }
  return FindSets(columns, prefix, sets);
}

Names IndexNames(const std::string& word, int rows, int columns, int first)
{
  Names names;
  for (int r = 0; r < rows; ++r)
  {
    for (int c = 0; c < columns; ++c)
    {
      names.push_back(word + std::to_string(r + first) + std::to_string(c + first));
    }
  }
  return names;
}

// Every pair of one of a and one of b.
Choices Join(const Choices& a, const Choices& b)
{
  Choices joined;
  for (const std::vector<int>& left : a)
  {
    for (const std::vector<int>& right : b)
    {
      std::vector<int> both = left;
      both.insert(both.end(), right.begin(), right.end());
      joined.insert(both);
    }
  }
  return joined;
}

Choices FindMatrices(const ColumnIndex& columns, const std::string& prefix)
{
  std::set<std::string> words;
  for (const PlainName& column : columns.GetNames())
  {
    if (column.Text.compare(0, prefix.size(), prefix) == 0)
    {
      const std::string rest = column.Text.substr(prefix.size());
      for (std::size_t digits = 1; digits <= 2 && digits <= rest.size(); ++digits)
      {
        words.insert(rest.substr(0, rest.size() - digits));
      }
    }
  }
  Choices choices;
  for (const std::string& word : words)
  {
    Choices own;
    for (const int first : { 0, 1 })
    {
      own = FindSets(columns, prefix, { IndexNames(word, 4, 4, first) });
      if (own.empty())
      {
        own = FindSets(columns, prefix, { IndexNames(word, 3, 4, first) });
      }
      if (own.empty())
      {
        Names names;
        for (int i = 0; i < 16; ++i)
        {
          names.push_back(word + std::to_string(i + first));
        }
        own = FindSets(columns, prefix, { names });
      }
      if (own.empty())
      {
        // a rotation of 3 x 3 beside a position: put in the order of the matrix
        const Choices rotations = FindSets(columns, prefix, { IndexNames(word, 3, 3, first) });
        for (const std::vector<int>& r : rotations)
        {
          for (const std::vector<int>& t : FindPositions(columns, prefix))
          {
            own.insert({ r[0], r[1], r[2], t[0], r[3], r[4], r[5], t[1], r[6], r[7], r[8], t[2] });
          }
        }
      }
      choices.insert(own.begin(), own.end());
      if (!own.empty())
      {
        break; // m11 ... m33 are a part of m00 ... m33
      }
    }
  }
  return choices;
}

Choices FindFormat(const ColumnIndex& columns, const std::string& prefix, PoseFormat format)
{
  if (format == PoseFormat::Matrix)
  {
    return FindMatrices(columns, prefix);
  }
  if (format == PoseFormat::Euler)
  {
    return Join(FindPositions(columns, prefix),
      FindSets(columns, prefix,
        { { "azimuth", "elevation", "roll" }, { "az", "el", "roll" }, { "az", "el", "ro" },
          { "azim", "elev", "roll" }, { "yaw", "pitch", "roll" }, { "psi", "theta", "phi" } }));
  }
  std::vector<Names> sets{ { "q1", "q2", "q3", "q0" } };
  for (const char* word :
    { "q", "quat", "quaternion", "rot", "rotation", "o", "orient", "orientation" })
  {
    sets.emplace_back();
    for (const char* part : { "x", "y", "z", "w" })
    {
      sets.back().push_back(word + std::string(part));
    }
  }
  return Join(FindPositions(columns, prefix), FindSets(columns, prefix, sets));
}

std::string DescribeUsual(PoseFormat format)
{
  switch (format)
  {
    case PoseFormat::Matrix:
      return "m00 m01 ... m33 (row by row; the last row may be missing)";
    case PoseFormat::Quaternion:
      return "tx ty tz qx qy qz qw";
    default:
      return "x y z azimuth elevation roll";
  }
}

// Columns of all names in order.
std::vector<int> FindNamed(const Names& names, PoseFormat format, const Names& wanted)
{
  const std::size_t count = wanted.size();
  const bool fits = format == PoseFormat::Matrix ? count == 16 || count == 12
                                                 : count == (format == PoseFormat::Euler ? 6 : 7);
  if (!fits)
  {
    throw std::runtime_error("PoseColumns has " + std::to_string(count) +
      " names; it takes those of " + DescribeUsual(format) +
      " in this order, or one text with which all of them begin, or nothing");
  }
  std::vector<int> found;
  for (const std::string& name : wanted)
  {
    found.push_back(FindColumn(names, name, {}, "PoseColumns"));
    if (std::count(found.begin(), found.end(), found.back()) > 1)
    {
      throw std::runtime_error("PoseColumns names column '" + name + "' twice");
    }
  }
  return found;
}

bool IsUnit(LengthUnit unit, const std::string& name)
{
  switch (unit)
  {
    case LengthUnit::Metre:
      return name == "m" || name == "metres" || name == "meters";
    case LengthUnit::Centimetre:
      return name == "cm";
    case LengthUnit::Inch:
      return name == "in" || name == "inch" || name == "inches";
    default:
      return name == "mm" || name == "millimetres" || name == "millimeters";
  }
}

void CheckUnits(const Names& names, const std::vector<PlainName>& plain,
  const std::vector<int>& found, PoseFormat format, LengthUnit unit)
{
  for (std::size_t i = 0; i < found.size(); ++i)
  {
    const std::string& said = plain[found[i]].Unit;
    const bool length = format == PoseFormat::Matrix ? i % 4 == 3 : i < 3;
    if (said.empty())
    {
      continue;
    }
    if (length && !IsUnit(unit, said))
    {
      throw std::runtime_error(
        "the name of column '" + names[found[i]] + "' contradicts LengthUnit; choose its unit");
    }
    if (!length && format == PoseFormat::Euler && said.compare(0, 3, "deg") != 0)
    {
      throw std::runtime_error("the name of column '" + names[found[i]] +
        "' says that its angles are not degrees; convert them, for example with ParaView's "
        "Calculator");
    }
  }
}
}

double GetMillimetres(LengthUnit unit)
{
  switch (unit)
  {
    case LengthUnit::Metre:
      return 1000;
    case LengthUnit::Centimetre:
      return 10;
    case LengthUnit::Inch:
      return 25.4;
    default:
      return 1;
  }
}

std::vector<int> FindPoseColumns(const Names& names, PoseFormat format, LengthUnit unit,
  const Names& wanted, const std::string& advice)
{
  const ColumnIndex index(names);
  std::vector<int> found;
  if (wanted.size() > 1)
  {
    found = FindNamed(names, format, wanted);
  }
  else
  {
    const std::string prefix =
      wanted.empty() ? std::string() : KeepAlphanumeric(ToLower(wanted.front()));
    const Choices choices = FindFormat(index, prefix, format);
    if (choices.size() != 1)
    {
      std::ostringstream message;
      message << (choices.empty() ? "the table has no columns" : "the table has several columns")
              << " for PoseFormat " << FormatNames[static_cast<std::size_t>(format)]
              << (prefix.empty() ? "" : ", beginning with '" + wanted.front() + "',")
              << " by their usual names, " << DescribeUsual(format) << "; " << advice
              << ". The table has " << Quote(names);
      for (const PoseFormat other :
        { PoseFormat::Matrix, PoseFormat::Quaternion, PoseFormat::Euler })
      {
        if (choices.empty() && other != format && FindFormat(index, prefix, other).size() == 1)
        {
          message << ", which fit PoseFormat " << FormatNames[static_cast<std::size_t>(other)];
        }
      }
      throw std::runtime_error(message.str());
    }
    found = *choices.begin();
  }
  CheckUnits(names, index.GetNames(), found, format, unit);
  return found;
}

int FindColumn(
  const Names& names, const std::string& wanted, const Names& usual, const std::string& property)
{
  if (!wanted.empty())
  {
    const auto match = std::find(names.begin(), names.end(), wanted);
    if (match == names.end())
    {
      throw std::runtime_error(
        property + " names column '" + wanted + "', but the table has " + Quote(names));
    }
    return static_cast<int>(match - names.begin());
  }
  const ColumnIndex index(names);
  for (const std::string& name : usual)
  {
    const std::vector<int> found = index.FindSet("", { name });
    if (!found.empty())
    {
      return found.front();
    }
  }
  return -1;
}

void CheckSeconds(const std::string& name)
{
  const std::string unit = PlainName(name).Unit;
  if (!unit.empty() && unit != "s" && unit.compare(0, 3, "sec") != 0)
  {
    throw std::runtime_error("the name of column '" + name +
      "' says that its times are not seconds; convert them, for example with ParaView's "
      "Calculator");
  }
}
}
