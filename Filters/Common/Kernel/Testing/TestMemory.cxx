// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaMemory.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

TEST(Memory, RefusesWhatTheMachineDoesNotHave)
{
  EXPECT_GT(lacuna::GetAvailableMemory(), 1e8);
  EXPECT_NO_THROW(lacuna::RequireMemory("a small thing", 1e6));
  try
  {
    lacuna::RequireMemory("a volume of 2e9 x 2e9 x 2e9 voxels", 8e27);
    FAIL();
  }
  catch (const std::runtime_error& e)
  {
    const std::string text = e.what();
    EXPECT_NE(text.find("2e9 x 2e9 x 2e9"), std::string::npos);
    EXPECT_NE(text.find("GiB"), std::string::npos);
  }
}
