// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaRanks.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace
{
/// One of two ranks, the other being well or not.
class Half : public lacuna::Ranks
{
public:
  explicit Half(bool otherIsFine)
    : OtherIsFine(otherIsFine)
  {
  }
  int GetNumber() const override { return 2; }
  mutable int Asked = 0;

protected:
  bool AllFine(bool fine) const override
  {
    ++this->Asked;
    return fine && this->OtherIsFine;
  }

private:
  bool OtherIsFine;
};
}

TEST(Ranks, OneIsAlone)
{
  const lacuna::Ranks ranks;
  EXPECT_EQ(ranks.GetRank(), 0);
  EXPECT_EQ(ranks.GetNumber(), 1);
  std::uint32_t values[2] = { 3, 4 };
  ranks.Sum(values, 2);
  EXPECT_EQ(values[0], 3U);
  EXPECT_EQ(values[1], 4U);
  int calls = 0;
  ranks.Together([&] { ++calls; });
  EXPECT_EQ(calls, 1);
  EXPECT_THROW(ranks.Together([] { throw std::out_of_range("own"); }), std::out_of_range);
}

TEST(Ranks, AnotherRanksErrorIsEverybodys)
{
  const Half well(true);
  well.Together([] {});
  EXPECT_THROW(well.Together([] { throw std::out_of_range("own"); }), std::out_of_range);
  EXPECT_EQ(well.Asked, 2) << "the other waits for this one";
  const Half ill(false);
  EXPECT_THROW(ill.Together([] {}), std::runtime_error);
  EXPECT_THROW(ill.Together([] { throw std::out_of_range("own"); }), std::out_of_range);
}
