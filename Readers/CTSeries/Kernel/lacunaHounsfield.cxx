// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaHounsfield.h"

#include "lacunaParameterText.h"
#include "lacunaWide.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <type_traits>

namespace lacuna
{
namespace
{
constexpr double Int16Lowest = std::numeric_limits<std::int16_t>::lowest();
constexpr double Int16Highest = std::numeric_limits<std::int16_t>::max();

bool FitsFloat(double x)
{
  return std::abs(x) <= static_cast<double>(std::numeric_limits<float>::max());
}

bool IsWhole(double x)
{
  return x == std::nearbyint(x);
}

// The bits up to HighBit as a number: shifting left first drops those above, shifting right then
// repeats the sign.
template <class Stored>
Stored Extract(Stored bits, int left, int right)
{
  const auto all = static_cast<std::make_unsigned_t<Stored>>(bits);
  const auto shifted = static_cast<std::make_unsigned_t<Stored>>(all << left);
  return static_cast<Stored>(static_cast<Stored>(shifted) >> right);
}

// How whole numbers become whole numbers, as bits of the machine.
template <class Stored>
struct WholeScale
{
  std::make_unsigned_t<Stored> Mask; // of the bits that count, the lowest ones
  std::make_unsigned_t<Stored> Sign; // of those
  std::uint32_t Slope;
  std::uint32_t Intercept;
  std::uint32_t Air;
  Stored PaddingFirst;
  Stored PaddingLast;
};

// The pixels of block, or those that lie where their values go when these are as wide.
template <bool HasSlope, bool HasPadding, class Stored, class T>
LACUNA_WIDE void ConvertBlock(
  const Stored* block, std::int64_t size, WholeScale<Stored> scale, T* values)
{
  if constexpr (sizeof(Stored) == sizeof(T))
  {
    block = reinterpret_cast<const Stored*>(values); // seen here, it hinders no vectors
  }
  using Bits = std::make_unsigned_t<T>;
  using Unsigned = std::make_unsigned_t<Stored>;
  const auto intercept = static_cast<Bits>(scale.Intercept);
  const auto air = static_cast<Bits>(scale.Air);
  for (std::int64_t i = 0; i < size; ++i)
  {
    // no shifts, which the baseline processor has not for several numbers of 16 bits at a time
    const auto bits = static_cast<Unsigned>((block[i] & scale.Mask) ^ scale.Sign);
    const auto stored = static_cast<Stored>(static_cast<Unsigned>(bits - scale.Sign));
    const std::uint32_t scaled = HasSlope ? scale.Slope * static_cast<std::uint32_t>(stored)
                                          : static_cast<std::uint32_t>(stored);
    const auto value = static_cast<Bits>(static_cast<Bits>(scaled) + intercept);
    const bool padded = HasPadding && stored >= scale.PaddingFirst && stored <= scale.PaddingLast;
    values[i] = static_cast<T>(padded ? air : value);
  }
}

template <class T>
bool Fits(const std::pair<double, double>& range)
{
  return std::is_floating_point_v<T> ||
    (range.first >= static_cast<double>(std::numeric_limits<T>::lowest()) &&
      range.second <= static_cast<double>(std::numeric_limits<T>::max()));
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
  : Name(frame.GetName())
  , Format(format)
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
  const bool fits = Fits<T>(this->GetRange());
  if (std::is_integral_v<T> && fits && this->IsIntegral() && IsWhole(this->Air) &&
    this->Format.HighBit == this->Format.BitsStored - 1)
  {
    this->ConvertWhole<Stored>(pixels, count, values);
    return;
  }
  const int left = this->Format.BitsAllocated - 1 - this->Format.HighBit;
  const int right = this->Format.BitsAllocated - this->Format.BitsStored;
  for (std::int64_t i = 0; i < count; ++i)
  {
    Stored bits;
    std::memcpy(&bits, pixels + i * static_cast<std::int64_t>(sizeof(Stored)), sizeof(Stored));
    const std::int64_t stored = Extract(bits, left, right);
    const bool padded =
      this->HasPadding && stored >= this->PaddingFirst && stored <= this->PaddingLast;
    const double value =
      padded ? this->Air : this->Slope * static_cast<double>(stored) + this->Intercept;
    if (!fits && !Fits<T>({ value, value }))
    {
      throw std::runtime_error(this->Name + ": a pixel is decoded as " + std::to_string(stored) +
        ", beyond what its Bits Stored (0028,0101) allow");
    }
    values[i] = static_cast<T>(value);
  }
}

//------------------------------------------------------------------------------
// Whole numbers that fit: the machine's arithmetic on as many bits as T has is exact, since only the
// result counts, and does several at a time.
template <class Stored, class T>
void HounsfieldScale::ConvertWhole(const unsigned char* pixels, std::int64_t count, T* values) const
{
  if constexpr (std::is_integral_v<T>)
  {
    const auto wrap = [](double x)
    { return static_cast<std::uint32_t>(static_cast<std::int64_t>(x)); };
    constexpr std::int64_t lowest = std::numeric_limits<Stored>::lowest();
    constexpr std::int64_t highest = std::numeric_limits<Stored>::max();
    using Unsigned = std::make_unsigned_t<Stored>;
    const auto mask = static_cast<Unsigned>(~std::uint64_t{ 0 } >> (64 - this->Format.BitsStored));
    const auto sign = static_cast<Unsigned>(std::is_signed_v<Stored> ? mask ^ mask >> 1 : 0);
    const WholeScale<Stored> scale = { mask, sign, wrap(this->Slope), wrap(this->Intercept),
      wrap(this->Air), static_cast<Stored>(std::max(lowest, this->PaddingFirst)),
      static_cast<Stored>(std::min(highest, this->PaddingLast)) };
    const bool padding =
      this->HasPadding && this->PaddingFirst <= highest && this->PaddingLast >= lowest;
    const auto convert = this->Slope == 1
      ? (padding ? ConvertBlock<false, true, Stored, T> : ConvertBlock<false, false, Stored, T>)
      : (padding ? ConvertBlock<true, true, Stored, T> : ConvertBlock<true, false, Stored, T>);
    // in blocks that stay in the cache; pixels may lie where the values go
    constexpr std::int64_t BlockSize = 4096;
    constexpr auto Width = static_cast<std::int64_t>(sizeof(Stored));
    constexpr bool InPlace = sizeof(Stored) == sizeof(T);
    std::array<Stored, InPlace ? 1 : BlockSize> block;
    for (std::int64_t begin = 0; begin < count; begin += BlockSize)
    {
      const std::int64_t size = std::min(BlockSize, count - begin);
      const unsigned char* source = pixels + begin * Width;
      void* target = InPlace ? static_cast<void*>(values + begin) : block.data();
      if (source != target)
      {
        std::memcpy(target, source, static_cast<std::size_t>(size * Width));
      }
      convert(block.data(), size, scale, values + begin);
    }
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
std::string CheckRescaleType(const std::vector<CTFrame>& frames)
{
  const CTFrame* doubtful = nullptr;
  for (const CTFrame& frame : frames)
  {
    std::string type = frame.RescaleType;
    std::transform(type.begin(), type.end(), type.begin(),
      [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; });
    if (type.empty() || type == "HU" || type.rfind("HOUNSFIELD", 0) == 0) // ... units
    {
      continue;
    }
    if (type != "US" && type != "HU_MOD")
    {
      throw std::runtime_error(frame.GetName() + ": Rescale Type (0028,1054) is " +
        frame.RescaleType +
        ", so its values are not Hounsfield units (HU); take a series of the scan's own images");
    }
    doubtful = doubtful ? doubtful : &frame;
  }
  if (!doubtful)
  {
    return {};
  }
  return doubtful->GetName() + ": Rescale Type (0028,1054) is " + doubtful->RescaleType +
    ", unspecified or modified units; its values are taken as Hounsfield units (HU), compare some "
    "with those that the hospital's "
    "viewer shows";
}

//------------------------------------------------------------------------------
ScalarType GetHounsfieldType(const std::vector<CTFrame>& frames, double air)
{
  if (!FitsFloat(air))
  {
    throw std::runtime_error("PaddingValue is " + FormatNumber(air) +
      "; it must be a number of Hounsfield units within +-3.4e38");
  }
  double lowest = air;
  double highest = air;
  bool whole = IsWhole(air);
  for (const CTFrame& frame : frames)
  {
    const HounsfieldScale scale(frame, air);
    const auto [first, last] = scale.GetRange();
    if (!FitsFloat(first) || !FitsFloat(last))
    {
      throw std::runtime_error(frame.GetName() + ": with Rescale Slope (0028,1053) " +
        FormatNumber(*frame.RescaleSlope) + " and Rescale Intercept (0028,1052) " +
        FormatNumber(*frame.RescaleIntercept) + " its values are from " + FormatNumber(first) +
        " to " + FormatNumber(last) + ", beyond what a voxel can hold; export original images");
    }
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
