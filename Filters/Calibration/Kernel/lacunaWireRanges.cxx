// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaWireRanges.h"

#include <cstddef>
#include <stdexcept>

namespace lacuna
{
namespace
{
constexpr std::size_t MostDigits = 12;

class Reader
{
public:
  explicit Reader(const std::string& text)
    : Text(text)
  {
  }

  void Skip(const char* characters)
  {
    const std::size_t next = this->Text.find_first_not_of(characters, this->Place);
    this->Place = next == std::string::npos ? this->Text.size() : next;
  }
  bool IsAtEnd() const { return this->Place == this->Text.size(); }
  bool Take(char character)
  {
    const bool isThere = !this->IsAtEnd() && this->Text[this->Place] == character;
    this->Place += isThere ? 1 : 0;
    return isThere;
  }
  CalibrationTarget TakeWire()
  {
    static const std::string names = "XYZxyz";
    const std::size_t wire =
      this->IsAtEnd() ? std::string::npos : names.find(this->Text[this->Place]);
    if (wire == std::string::npos)
    {
      this->Fail("the name of a wire, X, Y or Z");
    }
    ++this->Place;
    return static_cast<CalibrationTarget>(wire % 3);
  }
  std::int64_t TakeNumber()
  {
    const std::size_t end = this->Text.find_first_not_of("0123456789", this->Place);
    const std::size_t digits = (end == std::string::npos ? this->Text.size() : end) - this->Place;
    if (digits == 0 || digits > MostDigits)
    {
      this->Fail("the number of a slice");
    }
    const std::int64_t number = std::stoll(this->Text.substr(this->Place, digits));
    this->Place += digits;
    return number;
  }

private:
  [[noreturn]] void Fail(const char* expected) const
  {
    throw std::invalid_argument("WireRanges has '" + this->Text.substr(this->Place, 12) +
      "' where " + expected + " is expected; it is like X 0-49, Y 50-99, Z 100-149");
  }

  const std::string& Text;
  std::size_t Place = 0;
};

std::string Describe(const WireRange& range)
{
  return std::string(1, "XYZ"[static_cast<int>(range.Wire)]) + " " + std::to_string(range.First) +
    "-" + std::to_string(range.Last);
}
}

std::vector<WireRange> ReadWireRanges(const std::string& text, std::int64_t count)
{
  constexpr const char* blanks = " \t\n\r";
  constexpr const char* separators = " \t\n\r,;";
  Reader reader(text);
  std::vector<WireRange> ranges;
  for (reader.Skip(separators); !reader.IsAtEnd(); reader.Skip(separators))
  {
    WireRange range{ reader.TakeWire(), 0, 0 };
    reader.Skip(blanks);
    range.First = range.Last = reader.TakeNumber();
    reader.Skip(blanks);
    if (reader.Take('-'))
    {
      reader.Skip(blanks);
      range.Last = reader.TakeNumber();
    }
    if (range.Last < range.First || range.Last >= count)
    {
      throw std::invalid_argument("WireRanges has " + Describe(range) +
        "; first and last slice must ascend, and the sweep has slices 0 to " +
        std::to_string(count - 1));
    }
    for (const WireRange& other : ranges)
    {
      if (range.First <= other.Last && other.First <= range.Last)
      {
        throw std::invalid_argument("WireRanges has " + Describe(other) + " and " +
          Describe(range) + ": only one wire can be followed in a slice");
      }
    }
    ranges.push_back(range);
  }
  return ranges;
}

const CalibrationTarget* FindWire(const std::vector<WireRange>& ranges, std::int64_t slice)
{
  for (const WireRange& range : ranges)
  {
    if (slice >= range.First && slice <= range.Last)
    {
      return &range.Wire;
    }
  }
  return nullptr;
}
}
