// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaMemory.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>
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

TEST(Memory, OfAnySizeMayAskForLargePages)
{
  lacuna::PreferLargePages(nullptr, 0);
  for (const std::size_t size : { 1, 5000, 3000000, 20000000 })
  {
    const std::unique_ptr<char, void (*)(void*)> memory(
      static_cast<char*>(std::calloc(size, 1)), std::free);
    lacuna::PreferLargePages(memory.get(), size);
    EXPECT_EQ(memory.get()[0], 0);
    EXPECT_EQ(memory.get()[size - 1], 0);
    memory.get()[size - 1] = 1;
  }
}
