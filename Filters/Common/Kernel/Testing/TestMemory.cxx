// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaMemory.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>
#include <stdexcept>
#include <string>

#include <sys/resource.h>

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
    EXPECT_NE(text.find("8e+27 bytes (7.45e+18 GiB)"), std::string::npos) << text;
  }
}

TEST(Memory, IsDescribedInFull)
{
  EXPECT_EQ(lacuna::DescribeBytes(20e9), "20000000000 bytes (18.6 GiB)");
  EXPECT_EQ(lacuna::DescribeBytes(0), "0 bytes (0 GiB)");
}

TEST(Memory, IsAtMostWhatTheAddressSpaceAllows)
{
  const double before = lacuna::GetAvailableMemory();
  EXPECT_GE(lacuna::GetPhysicalMemory(), before);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  rlimit old{};
  ASSERT_EQ(getrlimit(RLIMIT_AS, &old), 0);
  rlimit limit = old;
  limit.rlim_cur = 1 << 30;
  ASSERT_EQ(setrlimit(RLIMIT_AS, &limit), 0);
  const double limited = lacuna::GetAvailableMemory();
  std::string text;
  try
  {
    lacuna::RequireMemory("a gigabyte", 1 << 30);
  }
  catch (const std::runtime_error& e)
  {
    text = e.what();
  }
  setrlimit(RLIMIT_AS, &old);
  EXPECT_NE(text.find("ulimit -v"), std::string::npos) << text;
  EXPECT_LT(limited, 1 << 30);
  EXPECT_GT(limited, 1 << 29); // the test itself is small
#endif
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
