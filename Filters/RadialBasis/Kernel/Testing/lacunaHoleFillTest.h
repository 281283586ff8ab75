// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Maps with a hole, and what fills it.
#ifndef lacunaHoleFillTest_h
#define lacunaHoleFillTest_h

#include "lacunaExecution.h"
#include "lacunaHoleFill.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <exception>
#include <string>

namespace lacunaHoleFillTest
{
using lacuna::HoleFillInput;
using lacuna::HoleFillOptions;
using lacuna::HoleFillResult;

constexpr std::size_t Width = 71;
constexpr std::size_t Height = 61;

// mm
inline double GetX(std::size_t pixel)
{
  return 1.5 * static_cast<double>(pixel % Width);
}

inline double GetY(std::size_t pixel)
{
  const std::size_t row = pixel / Width;
  return static_cast<double>(row);
}

// A map of 71 x 61 pixels of 1.5 x 1 mm from a surface, with an off-centre disc as defect.
template <class Surface>
HoleFillInput MakeMap(const Surface& surface, double radius = 15)
{
  HoleFillInput input;
  input.Grid.Width = Width;
  input.Grid.Height = Height;
  input.Grid.Spacing = { 1.5, 1 };
  for (std::size_t i = 0; i < input.Grid.GetSize(); ++i)
  {
    const double x = GetX(i);
    const double y = GetY(i);
    input.Depth.push_back(surface(x, y));
    input.Valid.push_back(1);
    input.Defect.push_back(std::hypot(x - 45, y - 27) <= radius);
  }
  return input;
}

inline double Plane(double x, double y)
{
  return 30 + 0.25 * x - 0.5 * y;
}

inline double Sphere(double x, double y)
{
  return 100 - std::sqrt(90 * 90 - (x - 50) * (x - 50) - (y - 30) * (y - 30));
}

inline HoleFillResult Fill(
  const HoleFillInput& input, const HoleFillOptions& options = {}, int threads = 2)
{
  lacuna::ThreadExecution execution(threads);
  return lacuna::HoleFiller().Fill(execution, input, options);
}

inline std::string ErrorOf(const HoleFillInput& input, const HoleFillOptions& options = {})
{
  try
  {
    Fill(input, options);
  }
  catch (const std::exception& e)
  {
    return e.what();
  }
  return "";
}

inline void ExpectContains(const std::string& text, const std::string& part)
{
  EXPECT_NE(text.find(part), std::string::npos) << "'" << text << "' lacks '" << part << "'";
}
}
#endif
