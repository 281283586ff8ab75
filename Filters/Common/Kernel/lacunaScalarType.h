// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The number types of pixels and voxels, and calls of templates by them.
#ifndef lacunaScalarType_h
#define lacunaScalarType_h

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <type_traits>

namespace lacuna
{
enum class ScalarType
{
  Int8,
  UInt8,
  Int16,
  UInt16,
  Int32,
  UInt32,
  Int64,
  UInt64,
  Float32,
  Float64
};

/// Expands Macro for each number type: for explicit instantiations of a kernel's templates.
#define LACUNA_FOR_EACH_SCALAR(Macro)                                                              \
  Macro(std::int8_t) Macro(std::uint8_t) Macro(std::int16_t) Macro(std::uint16_t)                  \
    Macro(std::int32_t) Macro(std::uint32_t) Macro(std::int64_t) Macro(std::uint64_t) Macro(float) \
      Macro(double)

/// The type of numbers that are stored as T is: integers by size and sign, whatever their name.
template <class T>
constexpr ScalarType GetScalarType()
{
  static_assert(std::is_arithmetic_v<T> && !std::is_same_v<T, bool> && sizeof(T) <= 8,
    "a number of 1, 2, 4 or 8 bytes");
  if constexpr (std::is_floating_point_v<T>)
  {
    return sizeof(T) == 4 ? ScalarType::Float32 : ScalarType::Float64;
  }
  else
  {
    switch (sizeof(T))
    {
      case 1:
        return std::is_signed_v<T> ? ScalarType::Int8 : ScalarType::UInt8;
      case 2:
        return std::is_signed_v<T> ? ScalarType::Int16 : ScalarType::UInt16;
      case 4:
        return std::is_signed_v<T> ? ScalarType::Int32 : ScalarType::UInt32;
      default:
        return std::is_signed_v<T> ? ScalarType::Int64 : ScalarType::UInt64;
    }
  }
}

/// Calls f with a zero of the C++ type that type stands for, and returns what f returns. Throws
/// std::invalid_argument when type is none of the enumeration's.
template <class Function>
auto DispatchScalarType(ScalarType type, Function&& f)
{
  switch (type)
  {
    // NOLINTNEXTLINE(bugprone-branch-clone): the branches differ in the type that f sees
    case ScalarType::Int8:
      return f(std::int8_t());
    case ScalarType::UInt8:
      return f(std::uint8_t());
    case ScalarType::Int16:
      return f(std::int16_t());
    case ScalarType::UInt16:
      return f(std::uint16_t());
    case ScalarType::Int32:
      return f(std::int32_t());
    case ScalarType::UInt32:
      return f(std::uint32_t());
    case ScalarType::Int64:
      return f(std::int64_t());
    case ScalarType::UInt64:
      return f(std::uint64_t());
    case ScalarType::Float32:
      return f(float());
    case ScalarType::Float64:
      return f(double());
  }
  throw std::invalid_argument("unknown scalar type");
}

/// Calls f with scalars as a pointer to their type, and returns what f returns.
template <class Function>
auto DispatchScalars(ScalarType type, const void* scalars, Function&& f)
{
  return DispatchScalarType(
    type, [&](auto zero) { return f(static_cast<const decltype(zero)*>(scalars)); });
}

/// Bytes of one number.
inline std::size_t GetScalarSize(ScalarType type)
{
  return DispatchScalarType(type, [](auto zero) { return sizeof(zero); });
}
}
#endif
