// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaOutlineTable.h"

#include "DicomTestFile.h"
#include "OutlineTesting.h"
#include "lacunaOutlineFile.h"

using namespace lacuna;

namespace
{
const std::string Sound = "structure,outline,slice,column,row,x,y,z\n"
                          "Liver,1,12,10,20,1,2,3.25\n"
                          "Liver,1,12,110,20,11,2,3.25\n"
                          "Liver,1,12,110,70,11,7,3.25\n"
                          "Liver,1,12,40,70,4,7,3.25\n"
                          "Liver,1,12,40,300,4,30,3.25\n"
                          "\"Cyst, \"\"left\"\"\",1,13,0,0,-1.5e1,0,5\n"
                          "\"Cyst, \"\"left\"\"\",1,13,0,0,-10,0,5\n"
                          "\"Cyst, \"\"left\"\"\",1,13,0,0,-10,4,5\n"
                          "Liver,2,-1,0,0,0,0,9\n"
                          "Liver,2,,0,0,1,0,9\n"
                          "Liver,2,,0,0,0,1,9\n";

OutlineSet Read(const std::string& text)
{
  const Temporary folder;
  return ReadOutlineTable(folder.Write(text, "outlines.csv"));
}

std::string Error(const std::string& text)
{
  return ErrorOf([&] { Read(text); });
}

TEST(OutlineTable, ReadsPointsInTheirOrder)
{
  const OutlineSet set = Read(Sound);
  ASSERT_EQ(set.GetOutlines().size(), 3U);
  const StructureOutline& liver = set.GetOutlines()[0];
  EXPECT_EQ(liver.Points, MakeFlag());
  EXPECT_EQ(liver.Slice, 12);
  EXPECT_EQ(liver.Number, 1);
  const StructureOutline& cyst = set.GetOutlines()[1];
  EXPECT_EQ(set.GetStructures()[cyst.Structure].Name, "Cyst, \"left\"");
  EXPECT_EQ(cyst.Points[0], (Vec3{ -15, 0, 5 }));
  EXPECT_EQ(set.GetOutlines()[2].Structure, liver.Structure);
  EXPECT_EQ(set.GetOutlines()[2].Slice, -1);
  EXPECT_EQ(set.GetStructures().size(), 2U);
  EXPECT_TRUE(set.Warnings.empty());
  EXPECT_FALSE(set.IsPatient);
}

TEST(OutlineTable, TakesColumnsInAnyOrderAndOtherLineEnds)
{
  const OutlineSet set = Read("\xEF\xBB\xBF\r\nnote, z ,Outline,y,x,\"structure\"\r\n"
                              "a,3.25,7,2,1,Liver\r\n\"b\nc\",3.25,7,2,11,Liver\r\n\r\n"
                              ",3.25,7,7,11,Liver\r\n,3.25,7,7,4,Liver\r\n,3.25,7,30,4,Liver\r\n");
  ASSERT_EQ(set.GetOutlines().size(), 1U);
  EXPECT_EQ(set.GetOutlines()[0].Points, MakeFlag());
  EXPECT_EQ(set.GetOutlines()[0].Number, 7);
  EXPECT_EQ(set.GetOutlines()[0].Slice, -1);
}

TEST(OutlineTable, SaysWhatIsWrongAndWhere)
{
  const std::string header = "structure,outline,slice,x,y,z\n";
  ExpectContains(Error("a,b\n1,2\n"), "a header with the columns structure, outline, x, y, z (mm)");
  ExpectContains(Error("\n\n"), "blank lines only");
  ExpectContains(Error("structure,outline,x,y\n"), "line 1: the header lacks z; needed are");
  ExpectContains(Error("structure,outline,x,y,z,x\n"), "line 1: the header has the column x twice");
  ExpectContains(Error(header), "has a header and no row");
  ExpectContains(Error(header + "a,1,3,0,0\n"), "line 2: has 5 values, but the header has 6");
  ExpectContains(
    Error(header + "a,1,3,0,0,zero\n"), "line 2: z is 'zero', not a finite number (mm)");
  for (const char* number : { "nan", "inf", "1e999", "0x1", "", "1,5" })
  {
    ExpectContains(Error(header + "a,1,3,0,0," + number + "\n"), "line 2: ");
  }
  ExpectContains(Error(header + "a,1.5,3,0,0,0\n"), "outline is '1.5', not a whole number");
  ExpectContains(Error(header + "a,1e12,3,0,0,0\n"), "outline is '1e12', not a whole number");
  ExpectContains(Error(header + "a,1,x,0,0,0\n"), "slice is 'x', not a finite number");
  ExpectContains(Error(header + ",1,3,0,0,0\n"), "line 2: structure is empty");
  ExpectContains(Error(header + "\"a,1,3,0,0,0\n"), "line 2: a quote (\") is not closed");
  ExpectContains(Error(header + "a,1,3,0,0,0\na,1,3,1,0,0\n"),
    "line 2: outline 1 of 'a' has 2 different points, but an outline needs 3");
}

TEST(OutlineTable, JoinsNoTwoOutlinesOfOneNumber)
{
  const std::string header = "structure,outline,slice,x,y,z\n";
  const std::string first = "a,1,3,0,0,0\na,1,3,1,0,0\na,1,3,1,1,0\n";
  ExpectContains(Error(header + first + "a,1,4,0,0,1\n"),
    "line 5: outline 1 of 'a' goes on in slice 4, but it began in slice 3");
  ExpectContains(Error(header + first + "b,1,3,0,0,0\nb,1,3,1,0,0\nb,1,3,1,1,0\na,1,3,0,0,0\n"),
    "line 8: outline 1 of 'a' began in line 2 already");
}

TEST(OutlineTable, SurvivesACutAnywhere)
{
  const OutlineSet whole = Read(Sound);
  const Temporary folder;
  for (std::size_t size = 1; size < Sound.size(); ++size)
  {
    try
    {
      const OutlineSet set = ReadOutlineTable(folder.Write(Sound.substr(0, size)));
      // a number may be cut off, too
      EXPECT_EQ(set.Warnings.empty(), Sound[size - 1] == '\n') << size;
      EXPECT_LE(set.GetOutlines().size(), whole.GetOutlines().size());
    }
    catch (const std::runtime_error& e)
    {
      EXPECT_GT(std::string(e.what()).size(), 40U);
    }
  }
  const OutlineSet set = Read(Sound.substr(0, Sound.size() - 1));
  ExpectContains(set.Warnings.at(0), "the last line, 12, does not end with a line break");
}

TEST(OutlineTable, IsKnownByItsHeader)
{
  const Temporary folder;
  EXPECT_TRUE(IsOutlineFile(folder.Write(Sound)));
  EXPECT_TRUE(IsOutlineFile(folder.Write("z,y,x,outline,structure")));
  EXPECT_FALSE(IsOutlineFile(folder.Write("x,y,z\n1,2,3\n")));
  EXPECT_FALSE(IsOutlineFile(folder.Write("")));
  EXPECT_FALSE(IsOutlineFile(folder.Write("\n")));
  EXPECT_FALSE(IsOutlineFile(folder.Path.string()));
  EXPECT_TRUE(IsOutlineFile(folder.Write(" {\"@schema\": \"\", \"markups\": [")));
  EXPECT_FALSE(IsOutlineFile(folder.Write("{\"version\": 1}")));
  ExpectContains(ErrorOf([&] { GetOutlineFileKind(folder.Write("")); }), "is empty");
}
}
