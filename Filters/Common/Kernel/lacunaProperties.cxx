// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaProperties.h"

#include <cmath>
#include <stdexcept>
#include <utility>

namespace lacuna
{
namespace
{
std::string WithUnit(double value, const ValueRange& range)
{
  return FormatNumber(value) + (*range.Unit ? std::string(" ") + range.Unit : "");
}

std::string GetError(const char* name, int value, const Choices& choices)
{
  return *choices.GetName(value)
    ? ""
    : std::string(name) + " is " + std::to_string(value) + "; it must be " + choices.Describe();
}

std::string GetError(const char* name, double value, const ValueRange& range)
{
  return range.Contains(value)
    ? ""
    : std::string(name) + " is " + WithUnit(value, range) + "; it must be " + range.Describe();
}

void Require(const std::string& error)
{
  if (!error.empty())
  {
    throw std::invalid_argument(error);
  }
}
}

//------------------------------------------------------------------------------
std::string Choices::Describe() const
{
  std::string text;
  for (int i = this->First; i < this->Size_; ++i)
  {
    text += text.empty() ? "" : i + 1 < this->Size_ ? ", " : " or ";
    text += std::to_string(i) + " (" + this->Names[i] + ")";
  }
  return text;
}

void Choices::Check(const char* name, int value) const
{
  Require(GetError(name, value, *this));
}

//------------------------------------------------------------------------------
bool ValueRange::Contains(double value) const
{
  const bool isAbove = this->HasLow ? value >= this->Low : value > this->Low;
  return std::isfinite(value) && ((isAbove && value <= this->High) || (this->Zero && value == 0));
}

std::string ValueRange::Describe() const
{
  const bool hasLow = this->Low > std::numeric_limits<double>::lowest();
  const bool hasHigh = this->High < std::numeric_limits<double>::max();
  const std::string zero = this->Zero ? std::string("0 (") + this->Zero + ") or " : "";
  if (!hasLow)
  {
    return zero + (hasHigh ? "at most " + WithUnit(this->High, *this) : "a finite number");
  }
  if (!this->HasLow)
  {
    return zero + "above " +
      (hasHigh ? FormatNumber(this->Low) + " and at most " + WithUnit(this->High, *this)
               : WithUnit(this->Low, *this));
  }
  return zero +
    (hasHigh ? "from " + FormatNumber(this->Low) + " to " + WithUnit(this->High, *this)
             : WithUnit(this->Low, *this) + " or more");
}

void ValueRange::Check(const char* name, double value) const
{
  Require(GetError(name, value, *this));
}

//------------------------------------------------------------------------------
Properties& Properties::Add(const char* name, int value, const Choices& choices)
{
  const std::string known = choices.GetName(value);
  this->List.push_back({ name, known.empty() ? std::to_string(value) : QuoteWord(known),
    choices.Describe(), GetError(name, value, choices) });
  return *this;
}

void Properties::AddNumbers(
  const char* name, std::string text, const std::vector<double>& values, const ValueRange& range)
{
  std::string error;
  for (const double value : values)
  {
    error = error.empty() ? GetError(name, value, range) : error;
  }
  this->List.push_back({ name, std::move(text), range.Describe(), error });
}

std::string Properties::GetText() const
{
  std::string text;
  for (const Property& property : this->List)
  {
    text += (text.empty() ? "" : " ") + property.Name + '=' + property.Value;
  }
  return text;
}

void Properties::Check() const
{
  for (const Property& property : this->List)
  {
    Require(property.Error);
  }
}

//------------------------------------------------------------------------------
void Described::Describe(Properties&) const {}

void Described::CheckProperties() const
{
  Properties properties;
  this->Describe(properties);
  properties.Check();
}
}
