// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The number types of pixels in files, and how a file's bytes become this machine's.
#ifndef lacunaElementType_h
#define lacunaElementType_h

#include <cstddef>
#include <cstdint>
#include <stdexcept>

namespace lacuna
{
enum class ElementType
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

/// Calls f with a value of the C++ type that type stands for, and returns what f returns.
template <class Function>
auto DispatchElementType(ElementType type, const Function& f)
{
  switch (type)
  {
    // NOLINTNEXTLINE(bugprone-branch-clone): the branches differ in the type that f sees
    case ElementType::Int8:
      return f(std::int8_t());
    case ElementType::UInt8:
      return f(std::uint8_t());
    case ElementType::Int16:
      return f(std::int16_t());
    case ElementType::UInt16:
      return f(std::uint16_t());
    case ElementType::Int32:
      return f(std::int32_t());
    case ElementType::UInt32:
      return f(std::uint32_t());
    case ElementType::Int64:
      return f(std::int64_t());
    case ElementType::UInt64:
      return f(std::uint64_t());
    case ElementType::Float32:
      return f(float());
    case ElementType::Float64:
      return f(double());
  }
  throw std::logic_error("unknown element type");
}

/// Bytes of one number.
std::size_t GetElementSize(ElementType type);

/// Reverses the bytes of each of count numbers of 1, 2, 4 or 8 bytes.
void SwapElementBytes(void* elements, std::size_t count, std::size_t elementSize);

/// Whether this machine stores the most significant byte first.
bool IsBigEndianMachine();
}
#endif
