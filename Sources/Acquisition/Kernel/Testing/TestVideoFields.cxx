// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaVideoFields.h"

#include <gtest/gtest.h>

#include <vector>

using namespace lacuna;

namespace
{
using Image = std::vector<std::uint8_t>;

Image Keep(VideoField field, std::int64_t columns, std::int64_t rows, Image grey)
{
  KeepField(field, columns, rows, grey.data());
  return grey;
}
}

TEST(VideoFields, OtherLinesAreTheMeanOfTheirNeighbours)
{
  const Image image{ 10, 20, 99, 99, 13, 21, 99, 99 };
  EXPECT_EQ(Keep(VideoField::Both, 2, 4, image), image);
  EXPECT_EQ(Keep(VideoField::Top, 2, 4, image), (Image{ 10, 20, 12, 21, 13, 21, 13, 21 }));
  const Image odd{ 99, 99, 4, 8, 99, 99, 7, 255, 99, 99 };
  EXPECT_EQ(Keep(VideoField::Bottom, 2, 5, odd), (Image{ 4, 8, 4, 8, 6, 132, 7, 255, 7, 255 }));
}

TEST(VideoFields, SmallImagesStay)
{
  EXPECT_EQ(Keep(VideoField::Bottom, 3, 1, { 1, 2, 3 }), (Image{ 1, 2, 3 }));
  EXPECT_EQ(Keep(VideoField::Bottom, 1, 2, { 1, 2 }), (Image{ 2, 2 }));
  EXPECT_EQ(Keep(VideoField::Top, 1, 2, { 1, 2 }), (Image{ 1, 1 }));
}
