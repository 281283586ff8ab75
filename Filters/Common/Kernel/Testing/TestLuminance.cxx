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
