// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaIGESDocument.h"

#include "lacunaBSplineSurface.h"
#include "lacunaIGESParser.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <locale>
#include <random>

using namespace lacuna;

namespace
{
BSplineSurface RandomSurface(int columns, int rows, unsigned seed)
{
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-150, 150);
  BSplineSurface surface;
  std::vector<double> interior[2];
  for (int k = 0; k < columns - 4; ++k)
  {
    interior[0].push_back(k + 1 + uniform(random) / 1000);
  }
  for (int k = 0; k < rows - 4; ++k)
  {
    interior[1].push_back(k + 1);
  }
  surface.U = CubicSplineSpace(0, interior[0], columns - 3);
  surface.V = CubicSplineSpace(-1, interior[1], rows - 3);
  for (int k = 0; k < columns * rows; ++k)
  {
    surface.ControlPoints.push_back({ uniform(random), uniform(random), uniform(random) });
  }
  return surface;
}

std::string Record(const IGESRecord& record)
{
  std::string all;
  for (const std::string& line : record.GetLines())
  {
    all += line + "|";
  }
  return all;
}

IGESHeader Header()
{
  IGESHeader header;
  header.Start = { "Tested" };
  header.Date = "20260102.030405";
  return header;
}
}

TEST(IGESRecord, RealsAlwaysHaveAPointAndReadBackTheSame)
{
  const std::pair<double, const char*> cases[] = { { 0, "0.,|" }, { -0.0, "0.,|" }, { 1, "1.,|" },
    { -2.5, "-2.5,|" }, { 0.1, "0.1,|" }, { 100000, "100000.,|" }, { 1e-5, "1.E-05,|" },
    { 1.25e-7, "1.25E-07,|" }, { 1e300, "1.E+300,|" }, { -1e-300, "-1.E-300,|" },
    { 1.0 / 3, "0.3333333333333333,|" } };
  for (const auto& [value, expected] : cases)
  {
    IGESRecord record;
    record.AddReal(value);
    EXPECT_EQ(Record(record), expected);
  }
  std::mt19937 random(3);
  std::uniform_real_distribution<double> exponent(-12, 12);
  for (int i = 0; i < 1000; ++i)
  {
    const double value = std::pow(10, exponent(random)) * (i % 2 ? 1 : -1);
    IGESRecord record;
    record.AddReal(value);
    std::string token = record.GetLines().at(0);
    token.pop_back();
    EXPECT_EQ(IGESParser::Real(token), value);
    EXPECT_LE(token.size(), 24u);
  }
}

TEST(IGESRecord, RefusesWhatIsNotANumber)
{
  IGESRecord record;
  EXPECT_THROW(record.AddReal(std::numeric_limits<double>::quiet_NaN()), std::invalid_argument);
  EXPECT_THROW(record.AddReal(std::numeric_limits<double>::infinity()), std::invalid_argument);
}

TEST(IGESRecord, SplitsStringsButNeverNumbers)
{
  IGESRecord record(20);
  record.AddInteger(123456789);
  record.AddReal(0.12345678901); // does not fit on the rest of the line
  record.AddString("short");
  record.AddString("a string longer than a line"); // on a line of its own
  record.AddString("x");
  record.Close();
  EXPECT_EQ(
    Record(record), "123456789,|0.12345678901,|5Hshort,|27Ha string longer t|han a line,1Hx;|");
}

TEST(IGESRecord, StringsAreAscii)
{
  IGESRecord record;
  record.AddString("J\xc3\xbcrgen\n");
  EXPECT_EQ(Record(record), "8HJ__rgen_,|");
}

TEST(IGESDocument, StrictParserReadsASurfaceBack)
{
  const BSplineSurface surface = RandomSurface(9, 6, 1);
  IGESDocument document;
  IGESDocument::Attributes attributes;
  attributes.Label = "SURFACE";
  const std::int64_t colour = document.AddColour(0.9, 0.85, 0.7, "Bone");
  const std::int64_t name = document.AddName("The fitted surface");
  attributes.Colour = -static_cast<int>(colour);
  const std::int64_t pointer = document.AddSurface(surface, attributes, { name });
  EXPECT_EQ(colour, 1);
  EXPECT_EQ(name, 3);
  EXPECT_EQ(pointer, 5);
  IGESHeader header = Header();
  header.Start.push_back(std::string(200, 'x') + " " + std::string(50, 'y'));
  header.FileName = "J\xc3\xbcrgen.igs";
  header.Product = "A skull";
  header.System = "A system";
  header.Preprocessor = "A preprocessor";
  header.MinimumResolution = 0.001;
  const IGESParser file(document.GetText(header));

  EXPECT_EQ(file.Start.size(), 5u);
  EXPECT_EQ(IGESParser::String(file.Global[0]), ",");
  EXPECT_EQ(IGESParser::String(file.Global[1]), ";");
  // numbers of the specification, from 1: 3 and 12 the product, as sender and receiver call it, 5 and
  // 6 what wrote it, 21 and 22 author and organisation, who are nobody
  EXPECT_EQ(IGESParser::String(file.Global[2]), "A skull");
  EXPECT_EQ(IGESParser::String(file.Global[3]), "J__rgen.igs");
  EXPECT_EQ(IGESParser::String(file.Global[4]), "A system");
  EXPECT_EQ(IGESParser::String(file.Global[5]), "A preprocessor");
  EXPECT_EQ(IGESParser::String(file.Global[11]), "A skull");
  EXPECT_EQ(IGESParser::Real(file.Global[12]), 1);
  EXPECT_EQ(IGESParser::Integer(file.Global[13]), 2);
  EXPECT_EQ(IGESParser::String(file.Global[14]), "MM");
  EXPECT_EQ(IGESParser::String(file.Global[17]), "20260102.030405");
  EXPECT_EQ(IGESParser::Real(file.Global[18]), 0.001);
  double largest = 0;
  for (const Vec3& p : surface.ControlPoints)
  {
    largest = std::max({ largest, std::abs(p[0]), std::abs(p[1]), std::abs(p[2]) });
  }
  EXPECT_GE(IGESParser::Real(file.Global[19]), largest);
  EXPECT_EQ(IGESParser::String(file.Global[20]), "Lacuna");
  EXPECT_EQ(IGESParser::String(file.Global[21]), "Lacuna");
  EXPECT_EQ(IGESParser::Integer(file.Global[22]), 11);

  ASSERT_EQ(file.Entities.size(), 3u);
  const IGESParser::Entity& entity = file.Entities.at(pointer);
  EXPECT_EQ(entity.Colour, -1);
  EXPECT_EQ(entity.Label, " SURFACE");
  const IGESSurface read(entity);
  EXPECT_EQ(read.Upper[0], 8);
  EXPECT_EQ(read.Upper[1], 5);
  EXPECT_EQ(read.Knots[0], surface.U.GetKnots());
  EXPECT_EQ(read.Knots[1], surface.V.GetKnots());
  ASSERT_EQ(read.Points.size(), 3 * surface.ControlPoints.size());
  for (std::size_t i = 0; i < read.Points.size(); ++i)
  {
    EXPECT_EQ(read.Points[i], surface.ControlPoints[i / 3][static_cast<int>(i % 3)]);
  }
  EXPECT_EQ(read.Properties, std::vector<long>{ 3 });
  EXPECT_EQ(read.Closed[0], 0);
  EXPECT_EQ(file.Entities.at(name).Form, 15);
  EXPECT_EQ(IGESParser::Integer(file.Entities.at(name).Parameters[0]), 1);
  EXPECT_EQ(IGESParser::String(file.Entities.at(name).Parameters[1]), "The fitted surface");
  EXPECT_EQ(IGESParser::Real(file.Entities.at(colour).Parameters[0]), 90);
  EXPECT_EQ(file.Entities.at(colour).Status, "00000200");
}

TEST(IGESDocument, SaysWhichSurfacesAreClosed)
{
  BSplineSurface surface = RandomSurface(5, 4, 2);
  for (std::size_t j = 0; j < 4; ++j)
  {
    surface.ControlPoints[5 * j + 4] = surface.ControlPoints[5 * j];
  }
  IGESDocument document;
  document.AddSurface(surface, {});
  const IGESSurface read(IGESParser(document.GetText(Header())).Entities.at(1));
  EXPECT_EQ(read.Closed[0], 1);
  EXPECT_EQ(read.Closed[1], 0);
}

TEST(IGESDocument, RefusesSurfacesThatAreNotFinite)
{
  BSplineSurface surface = RandomSurface(4, 4, 2);
  surface.ControlPoints[7][1] = std::numeric_limits<double>::quiet_NaN();
  IGESDocument document;
  EXPECT_THROW(document.AddSurface(surface, {}), std::invalid_argument);
}

TEST(IGESDocument, DoesNotDependOnTheLocale)
{
  struct German : std::numpunct<char>
  {
    char do_decimal_point() const override { return ','; }
    char do_thousands_sep() const override { return '.'; }
    std::string do_grouping() const override { return "\3"; }
  };
  const BSplineSurface surface = RandomSurface(60, 40, 5);
  const auto text = [&]
  {
    IGESDocument document;
    document.AddSurface(surface, {});
    return document.GetText(Header());
  };
  const std::string expected = text();
  const std::locale before = std::locale::global(std::locale(std::locale(), new German));
  const std::string german = text();
  std::locale::global(before);
  EXPECT_EQ(german, expected);
}

// The parser itself must notice what it is there for.
TEST(IGESParser, NoticesDamage)
{
  IGESDocument document;
  document.AddSurface(RandomSurface(6, 5, 4), {});
  const std::string good = document.GetText(Header());
  EXPECT_NO_THROW(IGESParser{ good });
  const auto changed = [&](std::size_t at, const std::string& with)
  {
    std::string bad = good;
    return bad.replace(at, with.size(), with);
  };
  const std::size_t directory = good.find("D0000001") - 72;
  const std::size_t parameters = good.find("P0000001") - 72;
  const std::size_t last = good.size() - 81;
  EXPECT_THROW(IGESParser{ good.substr(0, last) }, std::runtime_error);
  EXPECT_THROW(IGESParser{ changed(directory + 15, "2") }, std::runtime_error);      // pointer
  EXPECT_THROW(IGESParser{ changed(directory + 23, "1") }, std::runtime_error);      // structure
  EXPECT_THROW(IGESParser{ changed(directory + 81 + 31, "1") }, std::runtime_error); // lines
  EXPECT_THROW(IGESParser{ changed(parameters + 71, "3") }, std::runtime_error);     // back pointer
  EXPECT_THROW(IGESParser{ changed(parameters, "129") }, std::runtime_error);
  EXPECT_THROW(IGESParser{ changed(parameters + 3, " ") }, std::runtime_error); // delimiter
  EXPECT_THROW(IGESParser{ changed(last + 31, "9") }, std::runtime_error);      // count
  EXPECT_THROW(IGESParser{ changed(good.find("P0000002") + 7, "3") }, std::runtime_error);
}
