// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What the tests of outlines share.
#ifndef OutlineTesting_h
#define OutlineTesting_h

#include "lacunaOutlineSet.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

template <class Body>
std::string ErrorOf(Body&& body)
{
  try
  {
    body();
  }
  catch (const std::runtime_error& e)
  {
    return e.what();
  }
  return "no error";
}

inline void ExpectContains(const std::string& text, const std::string& part)
{
  EXPECT_NE(text.find(part), std::string::npos) << "'" << part << "' is not in '" << text << "'";
}

/// A shape that no reflection or rotation maps onto itself.
inline std::vector<lacuna::Vec3> MakeFlag()
{
  return { { 1, 2, 3.25 }, { 11, 2, 3.25 }, { 11, 7, 3.25 }, { 4, 7, 3.25 }, { 4, 30, 3.25 } };
}
#endif
