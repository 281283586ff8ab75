// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaPrintableText.h"

#include <gtest/gtest.h>

#include <string>

using lacuna::ToPrintable;
using lacuna::Utf8Length;

TEST(PrintableText, IsKeptWhereItIsUtf8)
{
  const std::string text = "Schnitt 3 \xc3\xbc \xe2\x82\xac \xf0\x9f\xa6\xb4\n\tsecond line";
  EXPECT_EQ(ToPrintable(text), text);
  EXPECT_EQ(ToPrintable(""), "");
}

TEST(PrintableText, ShowsOtherBytesByTheirNumbers)
{
  EXPECT_EQ(ToPrintable("MET_\xdc"
                        "CHAR"),
    "MET_\\xdcCHAR");
  EXPECT_EQ(ToPrintable("cut \xe2\x82"), "cut \\xe2\\x82");           // in a character
  EXPECT_EQ(ToPrintable("\xc0\xaf"), "\\xc0\\xaf");                   // an overlong slash
  EXPECT_EQ(ToPrintable("\xed\xa0\x80"), "\\xed\\xa0\\x80");          // a surrogate
  EXPECT_EQ(ToPrintable("\xf4\x90\x80\x80"), "\\xf4\\x90\\x80\\x80"); // beyond Unicode
  EXPECT_EQ(ToPrintable(std::string("a\0b", 3)), "a\\x00b");
  EXPECT_EQ(ToPrintable("\x1b[2J\r\x7f"), "\\x1b[2J\\x0d\\x7f"); // what terminals obey
}

TEST(PrintableText, IsUtf8WhateverComes)
{
  for (int first = 0; first < 256; ++first)
  {
    for (int second = 0; second < 256; ++second)
    {
      const std::string shown =
        ToPrintable(std::string{ static_cast<char>(first), static_cast<char>(second), 'z' });
      for (std::size_t at = 0; at < shown.size();)
      {
        const std::size_t length = Utf8Length(std::string_view(shown).substr(at));
        ASSERT_GT(length, 0u) << first << " " << second;
        at += length;
      }
      EXPECT_EQ(shown.back(), 'z');
    }
  }
}
