// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaPoseColumns.h"

#include <gtest/gtest.h>

#include <stdexcept>

using namespace lacuna;

namespace
{
using Names = std::vector<std::string>;
using Columns = std::vector<int>;

Columns Find(const Names& names, PoseFormat format, const Names& wanted = {},
  LengthUnit unit = LengthUnit::Millimetre)
{
  return FindPoseColumns(names, format, unit, wanted);
}

std::string GetError(const Names& names, PoseFormat format, const Names& wanted = {},
  LengthUnit unit = LengthUnit::Millimetre)
{
  try
  {
    Find(names, format, wanted, unit);
  }
  catch (const std::runtime_error& e)
  {
    return e.what();
  }
  return "no error";
}

void ExpectContains(const std::string& text, const std::string& part)
{
  EXPECT_NE(text.find(part), std::string::npos) << "'" << part << "' in: " << text;
}

Names Indexed(const std::string& word, int rows, int columns, int first)
{
  Names names;
  for (int r = 0; r < rows; ++r)
  {
    for (int c = 0; c < columns; ++c)
    {
      names.push_back(word + std::to_string(r + first) + std::to_string(c + first));
    }
  }
  return names;
}

Columns Sequence(int first, int count)
{
  Columns columns;
  for (int i = 0; i < count; ++i)
  {
    columns.push_back(first + i);
  }
  return columns;
}
}

TEST(PoseColumns, MatricesHaveManyNames)
{
  Names names = Indexed("m", 4, 4, 0);
  names.insert(names.begin(), "time");
  EXPECT_EQ(Find(names, PoseFormat::Matrix), Sequence(1, 16));
  EXPECT_EQ(Find(Indexed("M_", 4, 4, 1), PoseFormat::Matrix), Sequence(0, 16));
  EXPECT_EQ(Find(Indexed("T", 3, 4, 1), PoseFormat::Matrix), Sequence(0, 12));
  EXPECT_EQ(Find(Indexed("Pose ", 3, 4, 0), PoseFormat::Matrix), Sequence(0, 12));
  for (const int first : { 0, 1 })
  {
    Names flat;
    for (int i = 0; i < 16; ++i)
    {
      flat.push_back("ProbeToReference:" + std::to_string(i + first));
    }
    EXPECT_EQ(Find(flat, PoseFormat::Matrix), Sequence(0, 16));
  }
  // the rotation beside a position, in the matrix's order
  Names rotation = Indexed("r", 3, 3, 1);
  rotation.insert(rotation.begin(), { "tx", "ty", "tz" });
  EXPECT_EQ(Find(rotation, PoseFormat::Matrix), (Columns{ 3, 4, 5, 0, 6, 7, 8, 1, 9, 10, 11, 2 }));
}

TEST(PoseColumns, QuaternionsAndAnglesHaveManyNames)
{
  EXPECT_EQ(
    Find({ "tx", "ty", "tz", "qx", "qy", "qz", "qw" }, PoseFormat::Quaternion), Sequence(0, 7));
  // the scalar part may stand first, in the file and in the names
  EXPECT_EQ(Find({ "n", "Q0", "Q1", "Q2", "Q3", "X", "Y", "Z" }, PoseFormat::Quaternion),
    (Columns{ 5, 6, 7, 2, 3, 4, 1 }));
  EXPECT_EQ(
    Find({ "Pos.X", "Pos.Y", "Pos.Z", "Rot.W", "Rot.X", "Rot.Y", "Rot.Z" }, PoseFormat::Quaternion),
    (Columns{ 0, 1, 2, 4, 5, 6, 3 }));
  EXPECT_EQ(Find({ "x [mm]", "y [mm]", "z [mm]", "azimuth (deg)", "elevation_deg", "Roll" },
              PoseFormat::Euler),
    Sequence(0, 6));
  EXPECT_EQ(
    Find({ "roll", "el", "az", "x", "y", "z" }, PoseFormat::Euler), (Columns{ 3, 4, 5, 2, 1, 0 }));
  EXPECT_EQ(Find({ "psi", "theta", "phi", "x_in", "y_in", "z_in" }, PoseFormat::Euler, {},
              LengthUnit::Inch),
    (Columns{ 3, 4, 5, 0, 1, 2 }));
}

TEST(PoseColumns, NamesCanBeGiven)
{
  const Names names{ "a", "b", "c", "d", "e", "f", "g" };
  EXPECT_EQ(Find(names, PoseFormat::Euler, { "g", "f", "e", "d", "c", "b" }),
    (Columns{ 6, 5, 4, 3, 2, 1 }));
  ExpectContains(GetError(names, PoseFormat::Euler, { "a", "b" }), "PoseColumns has 2 names");
  ExpectContains(GetError(names, PoseFormat::Euler, { "a", "b", "c", "d", "e", "x" }),
    "PoseColumns names column 'x'");
  ExpectContains(GetError(names, PoseFormat::Euler, { "a", "b", "c", "d", "e", "a" }), "'a' twice");
  // two sensors in one table: the beginning says which
  Names two;
  for (const std::string sensor : { "Probe_", "Needle_" })
  {
    for (const char* part : { "tx", "ty", "tz", "qx", "qy", "qz", "qw" })
    {
      two.push_back(sensor + part);
    }
  }
  EXPECT_EQ(Find(two, PoseFormat::Quaternion, { "Needle" }), Sequence(7, 7));
  ExpectContains(GetError(two, PoseFormat::Quaternion), "no columns for PoseFormat Quaternion");
  ExpectContains(GetError(two, PoseFormat::Quaternion, { "Stylus" }), "beginning with 'Stylus'");
}

TEST(PoseColumns, ErrorsSayWhatThereIs)
{
  const std::string error =
    GetError({ "x", "y", "z", "azimuth", "elevation", "roll" }, PoseFormat::Matrix);
  ExpectContains(error, "no columns for PoseFormat Matrix");
  ExpectContains(error, "'elevation'");
  ExpectContains(error, "which fit PoseFormat Euler");
  ExpectContains(GetError({}, PoseFormat::Euler), "no columns");
  ExpectContains(GetError({ "x", "y", "z", "tx", "ty", "tz", "azimuth", "elevation", "roll" },
                   PoseFormat::Euler),
    "several columns");
  Names two = Indexed("a", 4, 4, 0);
  const Names other = Indexed("b", 4, 4, 0);
  two.insert(two.end(), other.begin(), other.end());
  ExpectContains(GetError(two, PoseFormat::Matrix), "several columns");
  EXPECT_EQ(Find(two, PoseFormat::Matrix, { "b" }), Sequence(16, 16));
  // two columns of one name: which is meant is not known
  ExpectContains(
    GetError({ "x", "X", "y", "z", "az", "el", "roll" }, PoseFormat::Euler), "no columns");
}

TEST(PoseColumns, UnitsInNamesAreHeeded)
{
  const Names metres{ "x [m]", "y [m]", "z [m]", "az", "el", "roll" };
  ExpectContains(GetError(metres, PoseFormat::Euler), "contradicts LengthUnit");
  EXPECT_EQ(Find(metres, PoseFormat::Euler, {}, LengthUnit::Metre), Sequence(0, 6));
  ExpectContains(
    GetError({ "x", "y", "z", "az_rad", "el_rad", "roll_rad" }, PoseFormat::Euler), "not degrees");
  EXPECT_NO_THROW(CheckSeconds("Timestamp [s]"));
  EXPECT_NO_THROW(CheckSeconds("items"));
  EXPECT_THROW(CheckSeconds("time_ms"), std::runtime_error);
}

TEST(PoseColumns, OtherColumns)
{
  const Names names{ "Frame", "Time [s]", "gate" };
  EXPECT_EQ(FindColumn(names, "", { "framenumber", "frame" }, "FrameColumn"), 0);
  EXPECT_EQ(FindColumn(names, "", { "timestamp", "time" }, "TimestampColumn"), 1);
  EXPECT_EQ(FindColumn(names, "", { "status" }, "StatusColumn"), -1);
  EXPECT_EQ(FindColumn(names, "gate", {}, "GateColumn"), 2);
  EXPECT_THROW(FindColumn(names, "Gate", { "gate" }, "GateColumn"), std::runtime_error);
}
