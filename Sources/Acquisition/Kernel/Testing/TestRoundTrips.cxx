// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaFastrakTracker.h"

#include <gtest/gtest.h>

using namespace lacuna;

TEST(RoundTrips, LateIsWhatTakesMuchLongerThanTheQuickest)
{
  RoundTrips trips(0.02);
  EXPECT_FALSE(trips.IsLate(0.015)); // nothing to compare it with
  EXPECT_FALSE(trips.IsLate(0.012));
  EXPECT_FALSE(trips.IsLate(0.0319)); // an adapter that collects bytes
  EXPECT_TRUE(trips.IsLate(0.0325));
  EXPECT_TRUE(trips.IsLate(1));
}

TEST(RoundTrips, AnotherLineIsKnownAfterAHundredAnswers)
{
  RoundTrips trips(0.02);
  for (int i = 0; i < 50; ++i)
  {
    EXPECT_FALSE(trips.IsLate(0.01));
  }
  int late = 0;
  for (int i = 0; i < 1000; ++i)
  {
    late += trips.IsLate(0.05) ? 1 : 0;
  }
  EXPECT_GE(late, 50);
  EXPECT_LE(late, 100);
  EXPECT_TRUE(trips.IsLate(0.0701));
  EXPECT_FALSE(trips.IsLate(0.03)); // quicker again
  EXPECT_TRUE(trips.IsLate(0.0501));
}
