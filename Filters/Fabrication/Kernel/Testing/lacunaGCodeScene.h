// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A short path, and what is said of programs that cannot be, for tests of G-code.
#ifndef lacunaGCodeScene_h
#define lacunaGCodeScene_h

#include "lacunaGCode.h"

#include <gtest/gtest.h>

#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

namespace lacunaGCode
{
constexpr lacuna::Vec3 Start{ 1.5, -2.25, 10 };

inline std::vector<lacuna::GCodeMove> Path()
{
  return { { true, { 3, 4, 10 }, 0 }, { false, { 3, 4, -1.0004 }, 200 },
    { false, { 3.0004, 4.0006, -1.0004 }, 800 }, { false, { -0.0004, -12.5, 0 }, 800 },
    { true, { -0.0004, -12.5, 10 }, 0 } };
}

inline std::string Message(const std::vector<lacuna::GCodeMove>& moves,
  const lacuna::GCodeOptions& options, const lacuna::Vec3& start = Start)
{
  try
  {
    lacuna::MakeGCode(start, moves, options);
  }
  catch (const std::invalid_argument& error)
  {
    return error.what();
  }
  return "no error";
}

inline void ExpectError(
  const std::function<void(std::vector<lacuna::GCodeMove>&, lacuna::GCodeOptions&)>& change,
  const std::string& words)
{
  std::vector<lacuna::GCodeMove> moves = Path();
  lacuna::GCodeOptions options;
  change(moves, options);
  EXPECT_NE(Message(moves, options).find(words), std::string::npos) << Message(moves, options);
}
}
#endif
