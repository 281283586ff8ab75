// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSequenceWriter.h"

#include <gtest/gtest.h>

using namespace lacuna;

namespace
{
struct List
{
  SequenceKind Kind{ "sweep.mha", false };
  SequenceContent Content;
  std::vector<std::string> Warnings;
  SequenceFieldList Fields{ Kind, Content, Warnings };

  List() { this->Content.Frames.resize(3); }
};
}

TEST(SequenceFieldList, FieldsAreFoundAndRemoved)
{
  List list;
  list.Fields.AddToHeader("Operator", "one");
  list.Fields.AddToFrames("Depth", { "10", "", "30" });
  list.Fields.AddToFrames("Gain", { "1", "2", "3" });
  EXPECT_EQ(list.Content.Description.CustomFields, (SequenceFields{ { "Operator", "one" } }));
  ASSERT_NE(list.Fields.Find(0, "Depth"), nullptr);
  EXPECT_EQ(*list.Fields.Find(2, "Depth"), "30");
  EXPECT_EQ(list.Fields.Find(1, "Depth"), nullptr); // empty texts are not written
  list.Fields.RemoveFromFrames("Depth");
  EXPECT_EQ(list.Fields.Find(2, "Depth"), nullptr);
  EXPECT_EQ(list.Content.Frames[2], (SequenceFields{ { "Gain", "3" } }));
  EXPECT_TRUE(list.Warnings.empty());
}

TEST(SequenceFieldList, WhatAFileCannotHoldIsLeftOutAndTold)
{
  List list;
  list.Fields.AddToHeader("DimSize", "3"); // the format's own
  list.Fields.AddToFrames("Note", { "fine", "two\nlines", "fine" });
  EXPECT_TRUE(list.Content.Description.CustomFields.empty());
  EXPECT_EQ(list.Fields.Find(0, "Note"), nullptr);
  ASSERT_EQ(list.Warnings.size(), 2u);
  EXPECT_EQ(list.Warnings[0].find("field 'DimSize' is not written: "), 0u) << list.Warnings[0];
  EXPECT_EQ(list.Warnings[1].find("field 'Note' is not written: "), 0u) << list.Warnings[1];
}

TEST(SequenceFieldList, LinesThatOthersCutAreTold)
{
  List list;
  list.Fields.AddToFrames("Short", { std::string(900, 'x'), "", "" });
  list.Fields.CheckLines();
  EXPECT_TRUE(list.Warnings.empty());
  list.Fields.AddToFrames("Long", { "", std::string(1000, 'x'), "" });
  list.Fields.CheckLines();
  ASSERT_EQ(list.Warnings.size(), 1u);
  EXPECT_NE(list.Warnings[0].find("PLUS would cut them: Long"), std::string::npos)
    << list.Warnings[0];
}
