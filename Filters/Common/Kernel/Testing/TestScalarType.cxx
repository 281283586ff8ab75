// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaScalarType.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <type_traits>

using lacuna::ScalarType;

namespace
{
template <class T>
void ExpectType(ScalarType type)
{
  EXPECT_EQ(lacuna::GetScalarType<T>(), type);
  EXPECT_EQ(lacuna::GetScalarSize(type), sizeof(T));
  EXPECT_TRUE(lacuna::DispatchScalarType(
    type, [](auto zero) { return std::is_same_v<decltype(zero), T> && zero == 0; }));
  const T numbers[16] = { 3,
    7 }; // room for two of the widest type, which the compiler looks at too
  EXPECT_EQ(
    lacuna::DispatchScalars(type, numbers, [](const auto* n) { return static_cast<double>(n[1]); }),
    7);
}
}

TEST(ScalarType, StandsForOneTypeOfNumber)
{
  ExpectType<std::int8_t>(ScalarType::Int8);
  ExpectType<std::uint8_t>(ScalarType::UInt8);
  ExpectType<std::int16_t>(ScalarType::Int16);
  ExpectType<std::uint16_t>(ScalarType::UInt16);
  ExpectType<std::int32_t>(ScalarType::Int32);
  ExpectType<std::uint32_t>(ScalarType::UInt32);
  ExpectType<std::int64_t>(ScalarType::Int64);
  ExpectType<std::uint64_t>(ScalarType::UInt64);
  ExpectType<float>(ScalarType::Float32);
  ExpectType<double>(ScalarType::Float64);
}

TEST(ScalarType, NamesOfTheSameNumbersAgree)
{
  EXPECT_EQ(
    lacuna::GetScalarType<char>(), std::is_signed_v<char> ? ScalarType::Int8 : ScalarType::UInt8);
  EXPECT_EQ(
    lacuna::GetScalarType<long>(), sizeof(long) == 8 ? ScalarType::Int64 : ScalarType::Int32);
  EXPECT_EQ(lacuna::GetScalarType<long long>(), ScalarType::Int64);
  EXPECT_EQ(lacuna::GetScalarType<unsigned long long>(), ScalarType::UInt64);
}

TEST(ScalarType, RefusesWhatIsNone)
{
  const auto none = static_cast<ScalarType>(10);
  EXPECT_THROW(lacuna::GetScalarSize(none), std::invalid_argument);
  EXPECT_THROW(lacuna::DispatchScalars(none, nullptr, [](const auto*) {}), std::invalid_argument);
}

TEST(ScalarType, TheListNamesEachTypeOnce)
{
  int type = 0;
#define LACUNA_EXPECT_NEXT(T)                                                                      \
  EXPECT_EQ(static_cast<int>(lacuna::GetScalarType<T>()), type);                                   \
  ++type;
  LACUNA_FOR_EACH_SCALAR(LACUNA_EXPECT_NEXT)
#undef LACUNA_EXPECT_NEXT
  EXPECT_EQ(type, 10);
}
