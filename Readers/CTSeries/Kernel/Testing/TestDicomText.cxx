// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaDicomText.h"

#include <gtest/gtest.h>

using namespace lacuna;

TEST(DicomText, Trims)
{
  EXPECT_EQ(TrimDicomText(std::string_view(" 1.2 \0", 6)), "1.2");
  EXPECT_EQ(TrimDicomText("   "), "");
}

TEST(DicomText, Splits)
{
  EXPECT_EQ(SplitDicomValues("A \\ B\\\\C"), (std::vector<std::string>{ "A", "B", "", "C" }));
  EXPECT_TRUE(SplitDicomValues("  ").empty());
  EXPECT_EQ(SplitDicomValues("A\\").size(), 2U);
}

TEST(DicomText, ParsesNumbers)
{
  const auto numbers = ParseDicomNumbers(" -1.5\\+2e-3 \\7 ", 3);
  ASSERT_TRUE(numbers);
  EXPECT_EQ(*numbers, (std::vector<double>{ -1.5, 0.002, 7 }));
  for (const char* bad : { "", "1\\2", "1\\2\\3\\4", "1\\2\\", "1\\2\\x", "1\\2\\3,5", "1\\2\\nan",
         "1\\2\\inf", "1\\2\\1e999", "1\\2\\0x1", "1\\2\\3 4" })
  {
    EXPECT_FALSE(ParseDicomNumbers(bad, 3)) << bad;
  }
}

TEST(DicomText, BecomesUtf8)
{
  EXPECT_EQ(DicomTextToUtf8("Sch\xE4"
                            "del ",
              "ISO_IR 100"),
    "Sch\xC3\xA4"
    "del");
  EXPECT_EQ(DicomTextToUtf8("Sch\xC3\xA4"
                            "del",
              "ISO_IR 192"),
    "Sch\xC3\xA4"
    "del");
  EXPECT_EQ(DicomTextToUtf8("Sch\xE4"
                            "del",
              "ISO_IR 192"),
    "Sch?del");
  EXPECT_EQ(DicomTextToUtf8("Sch\xE4"
                            "del",
              ""),
    "Sch?del");
  EXPECT_EQ(DicomTextToUtf8("a\nb\x85", "ISO_IR 100"), "a b?");
  // overlong, surrogate, beyond Unicode, cut off
  EXPECT_EQ(DicomTextToUtf8("\xC0\x80", "ISO_IR 192"), "??");
  EXPECT_EQ(DicomTextToUtf8("\xED\xA0\x80", "ISO_IR 192"), "???");
  EXPECT_EQ(DicomTextToUtf8("\xF4\x90\x80\x80", "ISO_IR 192"), "????");
  EXPECT_EQ(DicomTextToUtf8("x\xE2\x82", "ISO_IR 192"), "x??");
}
