// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaOutlineTable.h"

#include "lacunaDicomText.h"
#include "lacunaOutlineFile.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

namespace lacuna
{
namespace
{
enum Column : std::size_t
{
  Structure,
  Number,
  X,
  Y,
  Z,
  Slice,
  ColumnCount
};
constexpr std::array<std::string_view, ColumnCount> Names = { "structure", "outline", "x", "y", "z",
  "slice" };
constexpr std::size_t NeededCount = Slice; // the columns before it
constexpr std::size_t LongestShown = 40;   // bytes of a value in a message

std::string Show(std::string_view value)
{
  const std::string shown(value.substr(0, LongestShown));
  return "'" + DicomTextToUtf8(shown, "ISO_IR 192") + (value.size() > LongestShown ? "...'" : "'");
}

// Walks through records; a quoted value may have commas, line breaks and doubled quotes.
class RecordReader
{
public:
  explicit RecordReader(std::string_view text)
    : Text(text)
  {
  }

  /// False at the end of the text. Values are trimmed.
  bool Read()
  {
    this->Values.clear();
    this->FirstLine = this->Line;
    this->IsCutOff = false;
    if (this->Place >= this->Text.size())
    {
      return false;
    }
    for (bool more = true; more;)
    {
      this->Values.push_back(this->ReadValue());
      more = this->Place < this->Text.size() && this->Text[this->Place] == ',';
      this->Place += more ? 1 : 0;
    }
    const bool isReturn = this->Text.substr(this->Place, 2) == "\r\n";
    this->Place += isReturn ? 2 : 1;
    ++this->Line;
    return true;
  }

  bool IsBlank() const { return this->Values.size() == 1 && this->Values[0].empty(); }

  std::vector<std::string> Values;
  std::size_t FirstLine = 1; ///< of the record, from 1
  bool IsCutOff = false;     ///< a quote is not closed

private:
  // Whether the value or the record ends here.
  bool IsEnd() const
  {
    const char c = this->Text[this->Place];
    return c == ',' || c == '\n' || (c == '\r' && this->Text.substr(this->Place + 1, 1) == "\n");
  }

  std::string ReadValue()
  {
    const std::size_t first = this->Text.find_first_not_of(" \t", this->Place);
    if (first == std::string_view::npos || this->Text[first] != '"')
    {
      const std::size_t begin = this->Place;
      while (this->Place < this->Text.size() && !this->IsEnd())
      {
        ++this->Place;
      }
      return TrimDicomText(this->Text.substr(begin, this->Place - begin));
    }
    std::string value;
    this->IsCutOff = true;
    for (this->Place = first + 1; this->Place < this->Text.size(); ++this->Place)
    {
      const char c = this->Text[this->Place];
      if (c == '"' && this->Text.substr(this->Place + 1, 1) == "\"")
      {
        ++this->Place; // a doubled quote stands for one
      }
      else if (c == '"')
      {
        this->IsCutOff = false;
        ++this->Place;
        break;
      }
      this->Line += c == '\n' ? 1 : 0;
      value += c;
    }
    while (this->Place < this->Text.size() && !this->IsEnd())
    {
      value += this->Text[this->Place++]; // behind the quotes, which is wrong
    }
    return TrimDicomText(value);
  }

  std::string_view Text;
  std::size_t Place = 0;
  std::size_t Line = 1;
};

std::string ToLower(std::string text)
{
  std::transform(text.begin(), text.end(), text.begin(),
    [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return text;
}

// Where each column is in the header; nothing for those that it does not have.
std::array<std::optional<std::size_t>, ColumnCount> FindColumns(
  const std::vector<std::string>& header, const std::string& where)
{
  std::array<std::optional<std::size_t>, ColumnCount> places;
  for (std::size_t i = 0; i < header.size(); ++i)
  {
    const std::string name = ToLower(header[i]);
    for (std::size_t column = 0; column < ColumnCount; ++column)
    {
      if (name == Names[column] && places[column])
      {
        throw std::runtime_error(
          where + "the header has the column " + name + " twice; rename one of them");
      }
      if (name == Names[column])
      {
        places[column] = i;
      }
    }
  }
  return places;
}

std::optional<double> ParseNumber(const std::string& value)
{
  double number = 0;
  const char* end = value.data() + value.size();
  const auto [rest, error] = std::from_chars(value.data(), end, number);
  return error == std::errc() && rest == end && std::isfinite(number) ? std::optional(number)
                                                                      : std::nullopt;
}

class TableParser
{
public:
  TableParser(std::string path, std::string_view text)
    : Path(std::move(path))
    , Text(text)
    , Rows(text)
  {
  }

  OutlineSet Parse()
  {
    this->ReadHeader();
    while (this->Rows.Read())
    {
      if (!this->Rows.IsBlank())
      {
        this->ReadRow();
      }
    }
    this->FinishOutline();
    if (this->Outlines.GetOutlines().empty())
    {
      this->Fail("has a header and no row; save the outlines again");
    }
    if (this->Text.back() != '\n')
    {
      this->Outlines.Warnings.push_back("the last line, " +
        std::to_string(this->Rows.FirstLine - 1) +
        ", does not end with a line break; it may be cut off: compare its numbers with the "
        "original");
    }
    return std::move(this->Outlines);
  }

private:
  [[noreturn]] void Fail(const std::string& what) const
  {
    throw std::runtime_error(this->Path + ": " + what);
  }
  std::string GetLine() const { return "line " + std::to_string(this->Rows.FirstLine) + ": "; }

  void ReadHeader()
  {
    do
    {
      if (!this->Rows.Read())
      {
        this->Fail("has blank lines only; save the outlines again");
      }
    } while (this->Rows.IsBlank());
    const std::vector<std::string>& header = this->Rows.Values;
    this->Width = header.size();
    this->Places = FindColumns(header, this->Path + ": " + this->GetLine());
    std::string missing;
    std::size_t found = 0;
    for (std::size_t column = 0; column < NeededCount; ++column)
    {
      found += this->Places[column] ? 1 : 0;
      missing +=
        this->Places[column] ? "" : (missing.empty() ? "" : ", ") + std::string(Names[column]);
    }
    if (found == 0)
    {
      this->Fail(
        "has no outlines that are read: neither markups of 3D Slicer (.mrk.json), nor a DICOM "
        "RT structure set, nor a table with commas and a header with the columns structure, "
        "outline, x, y, z (mm)");
    }
    if (!missing.empty())
    {
      this->Fail(this->GetLine() + "the header lacks " + missing +
        "; needed are structure, outline, x, y, z (mm)");
    }
  }

  double GetNumber(Column column) const
  {
    const std::string& value = this->Rows.Values[*this->Places[column]];
    const std::optional<double> number = ParseNumber(value);
    if (!number)
    {
      this->Fail(this->GetLine() + std::string(Names[column]) + " is " + Show(value) +
        ", not a finite number" + (column == Number || column == Slice ? "" : " (mm)"));
    }
    return *number;
  }
  int GetWhole(Column column) const
  {
    const double number = this->GetNumber(column);
    if (number != std::nearbyint(number) || std::abs(number) > std::numeric_limits<int>::max())
    {
      this->Fail(this->GetLine() + std::string(Names[column]) + " is " +
        Show(this->Rows.Values[*this->Places[column]]) + ", not a whole number");
    }
    return static_cast<int>(number);
  }

  void ReadRow()
  {
    const std::vector<std::string>& values = this->Rows.Values;
    if (this->Rows.IsCutOff)
    {
      this->Fail(this->GetLine() + "a quote (\") is not closed; the file may be cut off");
    }
    if (values.size() != this->Width)
    {
      this->Fail(this->GetLine() + "has " + std::to_string(values.size()) +
        " values, but the header has " + std::to_string(this->Width) +
        " columns; the file may be cut off or have decimal commas");
    }
    const std::string& name = values[*this->Places[Structure]];
    if (name.empty())
    {
      this->Fail(this->GetLine() + "structure is empty; give it a name");
    }
    const int number = this->GetWhole(Number);
    const bool hasSlice = this->Places[Slice] && !values[*this->Places[Slice]].empty();
    const int slice = hasSlice ? std::max(-1, this->GetWhole(Slice)) : -1;
    const std::size_t structure = this->Outlines.AddStructure(name);
    const bool isNext = this->Current.Points.empty() || structure != this->Current.Structure ||
      number != this->Current.Number;
    if (isNext)
    {
      this->BeginOutline(structure, number, slice);
    }
    else if (slice != this->Current.Slice)
    {
      this->Fail(this->GetLine() + "outline " + std::to_string(number) + " of " + Show(name) +
        " goes on in slice " + std::to_string(slice) + ", but it began in slice " +
        std::to_string(this->Current.Slice) + "; give each outline a number of its own");
    }
    this->Current.Points.push_back({ this->GetNumber(X), this->GetNumber(Y), this->GetNumber(Z) });
  }

  void BeginOutline(std::size_t structure, int number, int slice)
  {
    this->FinishOutline();
    const auto [before, isNew] =
      this->FirstLines.emplace(std::make_pair(structure, number), this->Rows.FirstLine);
    if (!isNew)
    {
      this->Fail(this->GetLine() + "outline " + std::to_string(number) + " of " +
        Show(this->Outlines.GetStructures()[structure].Name) + " began in line " +
        std::to_string(before->second) +
        " already; its rows must follow one another, and each outline needs a number of its own");
    }
    this->Current = {};
    this->Current.Structure = structure;
    this->Current.Number = number;
    this->Current.Slice = slice;
    this->CurrentLine = this->Rows.FirstLine;
  }

  void FinishOutline()
  {
    if (!this->Current.Points.empty())
    {
      const std::string where = this->Path + ": line " + std::to_string(this->CurrentLine) +
        ": outline " + std::to_string(this->Current.Number) + " of " +
        Show(this->Outlines.GetStructures()[this->Current.Structure].Name);
      this->Outlines.AddOutline(std::move(this->Current), where);
      this->Current = {};
    }
  }

  std::string Path;
  std::string_view Text;
  RecordReader Rows;
  std::size_t Width = 0;
  std::array<std::optional<std::size_t>, ColumnCount> Places;
  OutlineSet Outlines;
  StructureOutline Current;
  std::size_t CurrentLine = 0;
  std::map<std::pair<std::size_t, int>, std::size_t> FirstLines; // of outlines
};
}

//------------------------------------------------------------------------------
bool IsOutlineTable(std::string_view text)
{
  RecordReader rows(text);
  if (!rows.Read())
  {
    return false;
  }
  const auto places = FindColumns(rows.Values, {});
  return std::all_of(places.begin(), places.begin() + NeededCount,
    [](const std::optional<std::size_t>& place) { return place.has_value(); });
}

//------------------------------------------------------------------------------
OutlineSet ReadOutlineTable(const std::string& path)
{
  const std::string text = ReadOutlineText(path);
  return TableParser(path, text).Parse();
}
}
