// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaLuminance.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <vector>

using namespace lacuna;

TEST(Luminance, IsRoundedAndStaysInRange)
{
  // 0.299 * 10 + 0.587 * 200 + 0.114 * 50 = 126.09; 0.299 * 255 = 76.245
  std::vector<std::uint8_t> pixels{ 10, 200, 50, 255, 0, 0, 255, 255, 255 };
  MakeLuminance(pixels.data(), 3, 3, pixels.data()); // in place
  EXPECT_EQ(pixels[0], 126);
  EXPECT_EQ(pixels[1], 76);
  EXPECT_EQ(pixels[2], 255);
  constexpr auto most = std::numeric_limits<std::uint64_t>::max();
  const std::vector<std::uint64_t> white{ most, most, most, 7 };
  std::uint64_t grey = 0;
  MakeLuminance(white.data(), 1, 4, &grey);
  EXPECT_GE(grey, most - 4096); // doubles lie 2048 apart there; it does not wrap around
  const std::vector<double> colour{ -0.5, 0.25, 4 };
  double level = 0;
  MakeLuminance(colour.data(), 1, 3, &level);
  EXPECT_DOUBLE_EQ(level, -0.1495 + 0.14675 + 0.456);
}

TEST(Luminance, TiesAreRoundedUp)
{
  // 0.587 * 36 + 0.114 * 12 = 22.5, which the sum of doubles falls short of
  const std::vector<std::uint8_t> tie{ 0, 36, 12 };
  std::uint8_t grey = 0;
  MakeLuminance(tie.data(), 1, 3, &grey);
  EXPECT_EQ(grey, 23);
  const std::vector<std::int16_t> pixels{ 0, -36, -12, -10, -200, -50, -32768, -32768, -32768 };
  std::vector<std::int16_t> greys(3);
  MakeLuminance(pixels.data(), 3, 3, greys.data());
  EXPECT_EQ(greys, (std::vector<std::int16_t>{ -22, -126, -32768 }));
  const std::vector<std::uint32_t> white(3, std::numeric_limits<std::uint32_t>::max());
  std::uint32_t level = 0;
  MakeLuminance(white.data(), 1, 3, &level);
  EXPECT_EQ(level, white[0]);
}
