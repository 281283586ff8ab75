// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaHounsfield.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <sstream>
#include <stdexcept>

namespace lacuna
{
namespace
{
constexpr double Int16Lowest = std::numeric_limits<std::int16_t>::lowest();
constexpr double Int16Highest = std::numeric_limits<std::int16_t>::max();

bool IsWhole(double x)
{
  return x == std::nearbyint(x);
}

// The bits up to HighBit as a number: shifting left first drops those above, shifting right then
// repeats the sign.
template <class Stored>
std::int64_t Extract(Stored bits, int left, int right)
{
  const auto shifted = static_cast<std::uint64_t>(bits) << left;
  return static_cast<Stored>(shifted) >> right;
}

void CheckFormat(const CTFrame& frame, const CTPixelFormat& format)
{
  const int allocated = format.BitsAllocated;
  if ((allocated == 8 || allocated == 16 || allocated == 32) && format.BitsStored >= 1 &&
    format.BitsStored <= allocated && format.HighBit < allocated &&
    format.HighBit >= format.BitsStored - 1)
  {
    return;
  }
  std::ostringstream message;
  message << frame.GetName()
          << ": Bits Allocated (0028,0100), Bits Stored (0028,0101) and High Bit "
          << "(0028,0102) are " << allocated << ", " << format.BitsStored << ", " << format.HighBit
          << "; 8, 16 or 32 bits allocated are read, with the stored ones inside";
  throw std::runtime_error(message.str());
}
}

//------------------------------------------------------------------------------
HounsfieldScale::HounsfieldScale(const CTFrame& frame, double air)
  : HounsfieldScale(frame, frame.Header->Format, air)
{
}

//------------------------------------------------------------------------------
HounsfieldScale::HounsfieldScale(const CTFrame& frame, const CTPixelFormat& format, double air)
  : Format(format)
  , Slope(frame.RescaleSlope.value_or(0))
  , Intercept(frame.RescaleIntercept.value_or(0))
  , Air(air)
{
  CheckFormat(frame, format);
  if (!frame.RescaleSlope || !frame.RescaleIntercept || this->Slope == 0)
  {
    throw std::runtime_error(frame.GetName() +
      ": has no valid Rescale Slope (0028,1053) and Rescale Intercept (0028,1052), without which "
      "its values are not Hounsfield units");
  }
  if (frame.Header->Padding)
  {
    this->HasPadding = true;
    const std::int64_t limit = frame.Header->PaddingLimit.value_or(*frame.Header->Padding);
    this->PaddingFirst = std::min(*frame.Header->Padding, limit);
    this->PaddingLast = std::max(*frame.Header->Padding, limit);
  }
}

//------------------------------------------------------------------------------
std::pair<double, double> HounsfieldScale::GetRange() const
{
  const double span = std::ldexp(1.0, this->Format.BitsStored);
  const double lowest = this->Format.Signed ? -span / 2 : 0;
  const double a = this->Slope * lowest + this->Intercept;
  const double b = this->Slope * (lowest + span - 1) + this->Intercept;
  return { std::min(a, b), std::max(a, b) };
}

//------------------------------------------------------------------------------
bool HounsfieldScale::IsIntegral() const
{
  return IsWhole(this->Slope) && IsWhole(this->Intercept);
}

//------------------------------------------------------------------------------
template <class Stored, class T>
void HounsfieldScale::ConvertStored(
  const unsigned char* pixels, std::int64_t count, T* values) const
{
  const int left = this->Format.BitsAllocated - 1 - this->Format.HighBit;
  const int right = this->Format.BitsAllocated - this->Format.BitsStored;
  for (std::int64_t i = 0; i < count; ++i)
  {
    Stored bits;
    std::memcpy(&bits, pixels + i * static_cast<std::int64_t>(sizeof(Stored)), sizeof(Stored));
    const std::int64_t stored = Extract(bits, left, right);
    const bool padded =
      this->HasPadding && stored >= this->PaddingFirst && stored <= this->PaddingLast;
    values[i] = static_cast<T>(
      padded ? this->Air : this->Slope * static_cast<double>(stored) + this->Intercept);
  }
}

//------------------------------------------------------------------------------
template <class T>
void HounsfieldScale::Convert(const unsigned char* pixels, std::int64_t count, T* values) const
{
  switch (this->Format.BitsAllocated + (this->Format.Signed ? 1 : 0))
  {
    case 8:
      return this->ConvertStored<std::uint8_t>(pixels, count, values);
    case 9:
      return this->ConvertStored<std::int8_t>(pixels, count, values);
    case 16:
      return this->ConvertStored<std::uint16_t>(pixels, count, values);
    case 17:
      return this->ConvertStored<std::int16_t>(pixels, count, values);
    case 32:
      return this->ConvertStored<std::uint32_t>(pixels, count, values);
    default:
      return this->ConvertStored<std::int32_t>(pixels, count, values);
  }
}

template void HounsfieldScale::Convert(const unsigned char*, std::int64_t, std::int16_t*) const;
template void HounsfieldScale::Convert(const unsigned char*, std::int64_t, std::int32_t*) const;
template void HounsfieldScale::Convert(const unsigned char*, std::int64_t, float*) const;

//------------------------------------------------------------------------------
ScalarType GetHounsfieldType(const std::vector<CTFrame>& frames, double air)
{
  double lowest = air;
  double highest = air;
  bool whole = IsWhole(air);
  for (const CTFrame& frame : frames)
  {
    const HounsfieldScale scale(frame, air);
    const auto [first, last] = scale.GetRange();
    lowest = std::min(lowest, first);
    highest = std::max(highest, last);
    whole = whole && scale.IsIntegral();
  }
  if (whole && lowest >= Int16Lowest && highest <= Int16Highest)
  {
    return ScalarType::Int16;
  }
  const bool fits = lowest >= std::numeric_limits<std::int32_t>::lowest() &&
    highest <= std::numeric_limits<std::int32_t>::max();
  return whole && fits ? ScalarType::Int32 : ScalarType::Float32;
}
}
