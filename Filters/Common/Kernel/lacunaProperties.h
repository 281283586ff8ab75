// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What a property may be, declared once: beside an enum the names of its values, beside options their
/// ranges. A filter lists its properties with these; errors, provenance and PrintSelf are made of the list.
#ifndef lacunaProperties_h
#define lacunaProperties_h

#include "lacunaParameterText.h"

#include <array>
#include <cstddef>
#include <limits>
#include <ostream>
#include <string>
#include <type_traits>
#include <vector>

namespace lacuna
{
/// The names of an enum's values, from 0 on. Declared beside it, of a constexpr array of texts.
class Choices
{
public:
  /// first: values below it may not be chosen.
  template <std::size_t Size>
  constexpr Choices(const std::array<const char*, Size>& names, int first = 0)
    : Names(names.data())
    , First(first)
    , Size_(static_cast<int>(Size))
  {
  }
  int GetSize() const { return this->Size_; }
  /// Empty for a value that is none of them.
  const char* GetName(int value) const
  {
    return value >= this->First && value < this->Size_ ? this->Names[value] : "";
  }
  /// "0 (Female) or 1 (Male)".
  std::string Describe() const;
  /// Throws std::invalid_argument: "Mould is 2; it must be 0 (Female) or 1 (Male)".
  void Check(const char* name, int value) const;

private:
  const char* const* Names;
  int First;
  int Size_;
};

/// The numbers that a property may have. Infinity and NaN are in none.
struct ValueRange
{
  double Low = std::numeric_limits<double>::lowest();
  double High = std::numeric_limits<double>::max();
  const char* Unit = "";      ///< "mm", "degrees"
  bool HasLow = true;         ///< whether Low itself is one of them
  const char* Zero = nullptr; ///< what 0 means, where it is one besides: "automatic"

  static constexpr ValueRange Any(const char* unit = "");
  static constexpr ValueRange AtLeast(double low, const char* unit = "");
  static constexpr ValueRange Above(double low, const char* unit = "");
  static constexpr ValueRange Between(double low, double high, const char* unit = "");

  constexpr ValueRange UpTo(double high) const;           ///< not above high, too
  constexpr ValueRange OrZero(const char* meaning) const; ///< 0, too

  bool Contains(double value) const;
  /// "0 (automatic) or from 0.2 to 5 mm", "above 0 and at most 5 mm", "0 mm or more", "a finite number".
  std::string Describe() const;
  /// Throws std::invalid_argument: "Thickness is 0.1 mm; it must be 0 (that of bone) or from 0.5 to 20 mm".
  void Check(const char* name, double value) const;
};

constexpr ValueRange ValueRange::Any(const char* unit)
{
  ValueRange range;
  range.Unit = unit;
  return range;
}

constexpr ValueRange ValueRange::AtLeast(double low, const char* unit)
{
  ValueRange range = Any(unit);
  range.Low = low;
  return range;
}

constexpr ValueRange ValueRange::Above(double low, const char* unit)
{
  ValueRange range = AtLeast(low, unit);
  range.HasLow = false;
  return range;
}

constexpr ValueRange ValueRange::Between(double low, double high, const char* unit)
{
  return AtLeast(low, unit).UpTo(high);
}

constexpr ValueRange ValueRange::UpTo(double high) const
{
  ValueRange range = *this;
  range.High = high;
  return range;
}

constexpr ValueRange ValueRange::OrZero(const char* meaning) const
{
  ValueRange range = *this;
  range.Zero = meaning;
  return range;
}

/// A list of properties with their values.
class Properties
{
public:
  struct Property
  {
    std::string Name;
    std::string Value;   ///< as FormatValue writes it, of a choice its name
    std::string Allowed; ///< as Choices and ValueRange describe it; empty: anything
    std::string Error;   ///< why the value is none; empty: it is one
  };

  /// A property that may be anything.
  template <class T>
  Properties& Add(const char* name, const T& value)
  {
    this->List.push_back({ name, FormatValue(value), "", "" });
    return *this;
  }
  /// A number, or a list of numbers, each of which must be in the range.
  template <class T>
  Properties& Add(const char* name, const T& value, const ValueRange& range)
  {
    if constexpr (std::is_arithmetic_v<T>)
    {
      this->AddNumbers(name, FormatValue(value), { static_cast<double>(value) }, range);
    }
    else
    {
      this->AddNumbers(
        name, FormatValue(value), std::vector<double>(std::begin(value), std::end(value)), range);
    }
    return *this;
  }
  Properties& Add(const char* name, int value, const Choices& choices);

  const std::vector<Property>& Get() const { return this->List; }

  /// "Name=value Name=value".
  std::string GetText() const;

  /// Throws std::invalid_argument with the first error.
  void Check() const;

private:
  void AddNumbers(
    const char* name, std::string text, const std::vector<double>& values, const ValueRange& range);

  std::vector<Property> List;
};

/// A base of what has properties.
class Described
{
protected:
  virtual ~Described() = default;

  /// Lists the properties, each with what it may be.
  virtual void Describe(Properties& properties) const;

  /// Throws std::invalid_argument when a property has a value that it may not have.
  virtual void CheckProperties() const;

  /// A line each: "Name: value (what it may be)".
  template <class Indent>
  void PrintProperties(std::ostream& os, const Indent& indent) const
  {
    Properties properties;
    this->Describe(properties);
    for (const Properties::Property& property : properties.Get())
    {
      os << indent << property.Name << ": " << property.Value;
      os << (property.Allowed.empty() ? "" : " (" + property.Allowed + ")") << "\n";
    }
  }
};
}
#endif
