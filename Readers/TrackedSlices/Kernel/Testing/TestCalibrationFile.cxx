// SPDX-License-Identifier: BSD-3-Clause
#include "SequenceFile.h"
#include "lacunaCalibrationFile.h"

#include <gtest/gtest.h>

using namespace lacuna;

namespace
{
const std::string Unit = "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1";

std::string Element(const std::string& from, const std::string& to, const std::string& matrix)
{
  return "<Transform From=\"" + from + "\" To=\"" + to + "\" Matrix=\"" + matrix +
    "\" Error=\"1\"/>";
}

std::string Document(const std::string& elements)
{
  return "<?xml "
         "version=\"1.0\"?>\n<PlusConfiguration>\n<DataCollection/>\n<CoordinateDefinitions>\n" +
    elements + "\n</CoordinateDefinitions>\n</PlusConfiguration>\n";
}

std::vector<NamedTransform> Read(const std::string& content)
{
  const TemporaryFile file("calibration.xml", content);
  return ReadCalibrationFile(file.GetPath());
}

void ExpectError(const std::string& content, const std::vector<std::string>& parts)
{
  const std::string error = GetError([&] { Read(content); });
  EXPECT_NE(error.find("calibration.xml"), std::string::npos) << error;
  for (const std::string& part : parts)
  {
    EXPECT_NE(error.find(part), std::string::npos) << error << "\nlacks: " << part;
  }
}
}

TEST(CalibrationFile, ReadsTransformsInOrder)
{
  const auto transforms =
    Read(Document(Element("Image", "Probe", "1 2 3 4\n 5 6 7 9\n9 1 2 3  0 0 0 1 ") +
      "<!-- not this -->" + Element(" Phantom ", "Reference 2", Unit)));
  ASSERT_EQ(transforms.size(), 2u);
  EXPECT_EQ(transforms[0].From, "Image");
  EXPECT_EQ(transforms[0].To, "Probe");
  EXPECT_EQ(transforms[0].Matrix(1, 2), 7);
  EXPECT_EQ(transforms[1].From, "Phantom");
  EXPECT_EQ(transforms[1].To, "Reference 2");
}

TEST(CalibrationFile, RefusesWhatIsTooMuch)
{
  std::string chain;
  for (int i = 0; i < 1000; ++i)
  {
    chain += Element("Frame" + std::to_string(i), "Frame" + std::to_string(i + 1), Unit);
  }
  EXPECT_EQ(Read(Document(chain)).size(), 1000u);
  ExpectError(Document(chain + Element("A", "B", Unit)), { "more than 1000 transforms" });
  ExpectError(Document(std::string(1 << 24, ' ')), { "larger than 16777216 bytes" });
}

TEST(CalibrationFile, AcceptsWhatAgrees)
{
  const std::string shift = "1 0 0 5 0 1 0 0 0 0 1 0 0 0 0 1";
  const std::string back = "1 0 0 -5 0 1 0 0 0 0 1 0 0 0 0 1";
  const std::string twice = "1 0 0 10.0001 0 1 0 0 0 0 1 0 0 0 0 1";
  EXPECT_EQ(Read(Document(Element("A", "B", shift) + Element("A", "B", shift))).size(), 1u);
  EXPECT_EQ(Read(Document(Element("A", "B", shift) + Element("B", "A", back))).size(), 1u);
  EXPECT_EQ(
    Read(Document(Element("A", "B", shift) + Element("B", "C", shift) + Element("A", "C", twice)))
      .size(),
    2u);
}

TEST(CalibrationFile, RefusesContradictions)
{
  const std::string shift = "1 0 0 5 0 1 0 0 0 0 1 0 0 0 0 1";
  ExpectError(Document(Element("A", "B", Unit) + Element("A", "B", shift)),
    { "From=\"A\" To=\"B\"", "contradicts" });
  ExpectError(Document(Element("A", "B", shift) + Element("B", "A", shift)),
    { "From=\"B\" To=\"A\"", "contradicts" });
  ExpectError(
    Document(Element("A", "B", shift) + Element("B", "C", shift) + Element("A", "C", shift)),
    { "From=\"A\" To=\"C\"", "contradicts" });
}

TEST(CalibrationFile, SaysWhatIsWrong)
{
  ExpectError("", { "is empty" });
  ExpectError("<a>\n<b>\n</a>", { "not well-formed XML", "line 3" });
  ExpectError("just text", { "not well-formed XML" });
  ExpectError("<PlusConfiguration/>", { "no CoordinateDefinitions" });
  ExpectError(Document(""), { "no Transform" });
  ExpectError(Document("<Transform From=\"A\" Matrix=\"" + Unit + "\"/>"), { "From and To" });
  ExpectError(Document(Element("A", "A", Unit)), { "to itself" });
  ExpectError(Document("<Transform From=\"A\" To=\"B\"/>"), { "0 numbers, not 16" });
  ExpectError(Document(Element("A", "B", Unit + " 1")), { "17 numbers, not 16" });
  ExpectError(Document(Element("A", "B", "x" + Unit.substr(1))), { "'x'", "not a number" });
  ExpectError(Document(Element("A", "B", "nan" + Unit.substr(1))), { "'nan'", "not finite" });
  ExpectError(Document(Element("A", "B", "0" + Unit.substr(1))), { "singular" });
  ExpectError(Document(Element("A", "B", Unit.substr(0, Unit.size() - 1) + "2")), { "not affine" });
  EXPECT_NE(GetError([] { ReadCalibrationFile("/nonexistent/c.xml"); }).find("/nonexistent/c.xml"),
    std::string::npos);
  EXPECT_NE(GetError([] { ReadCalibrationFile("/"); }), "");
}

TEST(CalibrationFile, DeepNestingIsNoProblem)
{
  std::string open;
  std::string close;
  for (int i = 0; i < 100000; ++i)
  {
    open += "<a>";
    close += "</a>";
  }
  ExpectError(open + close, { "no CoordinateDefinitions" });
}

TEST(CalibrationFile, WritesWhatItReads)
{
  std::array<double, 16> numbers{ 0.1, 1.0 / 3, -0.7, 5e-17, 0, 0.2, 1e-30, -6, 0.25, 0, 0.1, 5, 0,
    0, 0, 1 };
  const std::vector<NamedTransform> written{ { "Im&age <1>", "Pro\"be'", Matrix4(numbers) },
    { "Tracker", "Reference", Matrix4() } };
  const TemporaryFile file("written.xml", FormatCalibration(written, "of 3 -- 4 wires -->"));
  const std::vector<NamedTransform> read = ReadCalibrationFile(file.GetPath());
  ASSERT_EQ(read.size(), 2u);
  for (std::size_t i = 0; i < read.size(); ++i)
  {
    EXPECT_EQ(read[i].From, written[i].From);
    EXPECT_EQ(read[i].To, written[i].To);
    for (int k = 0; k < 16; ++k)
    {
      EXPECT_EQ(read[i].Matrix.Data()[k], written[i].Matrix.Data()[k]);
    }
  }
}
