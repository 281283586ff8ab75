// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSequenceText.h"

#include <gtest/gtest.h>

#include <clocale>
#include <cmath>
#include <limits>

using namespace lacuna;

TEST(SequenceText, TransformsOfAPatientsFrameIdentifyNobody)
{
  using Field = std::pair<const char*, std::vector<std::string>>;
  const std::string matrix = "1 0 0 5 0 1 0 6 0 0 1 7 0 0 0 1";
  const Field kept[] = { { "PatientToTrackerTransform", { matrix, "", matrix } },
    { "ReferenceToPatientTransform", {} }, { "PatientToTrackerTransformStatus", { "OK" } },
    { "PatientToTrackerTransformStatus", { "OUT_OF_VIEW", "" } }, { "Note", { "Doe^Jane" } } };
  for (const auto& [name, texts] : kept)
  {
    EXPECT_FALSE(IdentifiesPatient(name, texts)) << name;
  }
  const Field dropped[] = { { "PatientNameTransform", { "Doe^Jane" } },
    { "PatientToTownTransform", { "Doe^Jane" } },
    { "PatientToTrackerTransform", { matrix, "Doe^Jane" } },
    { "PatientToTrackerTransform", { "1 0 0 5 0 1 0 6 0 0 1 7 0 0 0 x" } },
    { "PatientToTrackerTransformStatus", { "Doe^Jane" } },
    { "PatientToTrackerTransformStatus", { "DOE" } }, { "PatientTransform", { matrix } },
    { "PatientToTracker", { matrix } }, { "StudyPatientName", { matrix } } };
  for (const auto& [name, texts] : dropped)
  {
    EXPECT_TRUE(IdentifiesPatient(name, texts)) << name;
  }
}

TEST(SequenceText, SplitsOnRunsOfBlanks)
{
  EXPECT_EQ(Trim(" \t a b \r\n"), "a b");
  EXPECT_EQ(Trim("  \r "), "");
  const auto words = SplitWords("  147 106        105   ");
  ASSERT_EQ(words.size(), 3u);
  EXPECT_EQ(words[0], "147");
  EXPECT_EQ(words[2], "105");
  EXPECT_TRUE(SplitWords(" \t ").empty());
}

TEST(SequenceText, MatchesWithoutCase)
{
  EXPECT_EQ(ToLower("LoCal"), "local");
  EXPECT_TRUE(EqualsIgnoringCase("LOCAL", "local"));
  EXPECT_FALSE(EqualsIgnoringCase("LOCAL", "loca"));
  EXPECT_TRUE(EndsWithIgnoringCase("ProbeToTrackertransform", "Transform"));
  EXPECT_FALSE(EndsWithIgnoringCase("form", "Transform"));
}

TEST(SequenceText, Integers)
{
  std::int64_t value = 0;
  EXPECT_TRUE(ParseInteger("-42", value));
  EXPECT_EQ(value, -42);
  EXPECT_TRUE(ParseInteger("+7", value));
  EXPECT_EQ(value, 7);
  EXPECT_TRUE(ParseInteger("9223372036854775807", value));
  for (const char* bad : { "", "+", "-", "+-1", "1.5", "1x", "0x10", "9223372036854775808" })
  {
    EXPECT_FALSE(ParseInteger(bad, value)) << bad;
  }
}

TEST(SequenceText, Numbers)
{
  double value = 0;
  EXPECT_TRUE(ParseNumber("-1.25e-005", value)); // three digits: old Microsoft libraries
  EXPECT_DOUBLE_EQ(value, -1.25e-5);
  EXPECT_TRUE(ParseNumber("+3.", value));
  EXPECT_EQ(value, 3.0);
  EXPECT_TRUE(ParseNumber("1e-400", value));
  EXPECT_EQ(value, 0.0);
  EXPECT_TRUE(ParseNumber("1e400", value));
  EXPECT_TRUE(std::isinf(value));
  for (const char* none : { "nan", "-inf", "-1.#IND", "1.#QNAN", "1.#INF" })
  {
    EXPECT_TRUE(ParseNumber(none, value)) << none;
    EXPECT_FALSE(std::isfinite(value)) << none;
  }
  for (const char* bad : { "", "+", "1,5", "1.5mm", "e5", "--1" })
  {
    EXPECT_FALSE(ParseNumber(bad, value)) << bad;
  }
}

TEST(SequenceText, NumbersDoNotDependOnTheLocale)
{
  const char* before = std::setlocale(LC_NUMERIC, nullptr);
  const std::string old = before ? before : "C";
  std::setlocale(LC_NUMERIC, "de_DE.UTF-8"); // where it is not installed nothing changes
  double value = 0;
  EXPECT_TRUE(ParseNumber("0.5", value));
  EXPECT_EQ(value, 0.5);
  std::setlocale(LC_NUMERIC, old.c_str());
}

TEST(SequenceText, Matrices)
{
  Matrix4 matrix;
  EXPECT_EQ(ParseMatrix("1 2 3 4\n5 6 7 8\n9 10 11 12\n0 0 0 1 ", matrix), "");
  EXPECT_EQ(matrix(0, 3), 4);
  EXPECT_EQ(matrix(2, 0), 9);
  EXPECT_EQ(ParseMatrix("1 2 3", matrix), "has 3 numbers, not 16");
  EXPECT_EQ(
    ParseMatrix("1 0 0 0 0 1 0 0 0 0 one 0 0 0 0 1", matrix), "has 'one', which is not a number");
  EXPECT_EQ(
    ParseMatrix("1 0 0 0 0 1 0 0 0 0 nan 0 0 0 0 1", matrix), "has 'nan', which is not finite");
}

TEST(SequenceText, ListsAreCutShort)
{
  EXPECT_EQ(JoinSome({}), "");
  EXPECT_EQ(JoinSome({ "a", "b" }), "a, b");
  EXPECT_EQ(JoinSome({ "a", "b", "c", "d" }, 2), "a, b and 2 more");
}
