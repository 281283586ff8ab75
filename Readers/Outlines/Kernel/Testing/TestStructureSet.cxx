// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaStructureSet.h"

#include "DicomTestFile.h"
#include "OutlineTesting.h"
#include "lacunaOutlineFile.h"

using namespace lacuna;

namespace
{
const std::string StructureSetClass = "1.2.840.10008.5.1.4.1.1.481.3";
const std::string Flag = "1\\2\\3.25\\11\\2\\3.25\\11\\7\\3.25\\4\\7\\3.25\\4\\30\\3.25";

struct Contour
{
  std::string Type = "CLOSED_PLANAR";
  std::string Count = "5";
  std::string Data = Flag;
};

struct Structure
{
  std::string Number;
  std::string Name;
  std::string Color;
  std::vector<Contour> Contours = {};
  std::string Referenced = {}; // number that contours refer to, if another
  std::string Frame = "1.2.3";
};

// A structure set in one of the syntaxes; sequences with or without lengths.
struct Writer
{
  bool IsImplicit = false;
  bool IsOpen = false;
  std::string SopClass = StructureSetClass;
  std::string Modality = "RTSTRUCT";
  std::vector<Structure> Structures = {
    { "3", "Liver", "255\\0\\16", { {}, { "CLOSED_PLANAR", "3", "0\\0\\5\\1\\0\\5\\0\\1\\5" } } },
    { "1", "Marker", "", { { "POINT", "1", "1\\2\\3" } } },
    { "2", "Niere", "0\\300\\0", { { "CLOSED_PLANAR", "3", "0\\0\\-5\\1\\0\\-5\\0\\1\\-5" } } },
    { "4", "Body", "", {} }
  };

  std::string Element(DicomTag tag, const char* vr, std::string value) const
  {
    value += value.size() % 2 ? " " : "";
    return this->IsImplicit ? Implicit(tag, value) : Short(tag, vr, value);
  }
  std::string Sequence(DicomTag tag, const std::vector<std::string>& items) const
  {
    std::string all;
    for (const std::string& item : items)
    {
      all += Implicit(0xFFFEE000, item, this->IsOpen) + (this->IsOpen ? ItemEnd : "");
    }
    all += this->IsOpen ? SequenceEnd : "";
    return this->IsImplicit ? Implicit(tag, all, this->IsOpen) : Long(tag, "SQ", all, this->IsOpen);
  }
  std::string Write() const
  {
    std::vector<std::string> names;
    std::vector<std::string> contours;
    for (const Structure& structure : this->Structures)
    {
      names.push_back(this->Element(0x30060022, "IS", structure.Number) +
        this->Element(0x30060024, "UI", structure.Frame) +
        this->Element(0x30060026, "LO", structure.Name));
      std::vector<std::string> items;
      for (const Contour& contour : structure.Contours)
      {
        items.push_back(this->Sequence(0x30060016, { this->Element(0x00081155, "UI", "1.2") }) +
          this->Element(0x30060042, "CS", contour.Type) +
          this->Element(0x30060046, "IS", contour.Count) +
          this->Element(0x30060050, "DS", contour.Data));
      }
      const std::string& number =
        structure.Referenced.empty() ? structure.Number : structure.Referenced;
      contours.push_back(
        (structure.Color.empty() ? "" : this->Element(0x3006002A, "IS", structure.Color)) +
        this->Sequence(0x30060040, items) + this->Element(0x30060084, "IS", number));
    }
    return Head(this->IsImplicit ? "1.2.840.10008.1.2" : "1.2.840.10008.1.2.1") +
      this->Element(0x00080005, "CS", "ISO_IR 192") +
      this->Element(0x00080016, "UI", this->SopClass) +
      this->Element(0x00080060, "CS", this->Modality) +
      this->Element(0x00100010, "PN", "Doe^Jane") + this->Sequence(0x30060020, names) +
      this->Sequence(0x30060039, contours) + this->Element(0x300E0002, "CS", "UNAPPROVED");
  }
};

OutlineSet Read(const std::string& bytes)
{
  const Temporary folder;
  return ReadStructureSet(folder.Write(bytes, "RS.dcm"));
}

std::string Error(const Writer& writer)
{
  return ErrorOf([&] { Read(writer.Write()); });
}

TEST(StructureSet, ReadsClosedContoursWhereTheyAre)
{
  for (const int kind : { 0, 1, 2, 3 })
  {
    Writer writer;
    writer.IsImplicit = kind % 2 == 1;
    writer.IsOpen = kind >= 2;
    const OutlineSet set = Read(writer.Write());
    ASSERT_EQ(set.GetOutlines().size(), 3U);
    EXPECT_EQ(set.GetOutlines()[0].Points, MakeFlag());
    EXPECT_EQ(set.GetOutlines()[1].Number, 2);
    EXPECT_EQ(set.GetOutlines()[1].Structure, 0U);
    EXPECT_EQ(set.GetOutlines()[2].Structure, 1U);
    EXPECT_EQ(set.GetOutlines()[2].Points[1], (Vec3{ 1, 0, -5 }));
    EXPECT_EQ(set.GetOutlines()[2].Slice, -1);
    ASSERT_EQ(set.GetStructures().size(), 2U);
    EXPECT_EQ(set.GetStructures()[0].Name, "Liver");
    EXPECT_EQ(set.GetStructures()[0].Color, (StructureColor{ 255, 0, 16 }));
    EXPECT_EQ(set.GetStructures()[1].Name, "Niere"); // and a colour that is none
    EXPECT_TRUE(set.IsPatient);
    ASSERT_EQ(set.Warnings.size(), 2U);
    EXPECT_EQ(set.Warnings[0],
      "contours (3006,0042) are left out because they enclose nothing: 1 of type POINT");
    EXPECT_EQ(set.Warnings[1], "structures without closed contours are left out: Marker, Body");
  }
}

TEST(StructureSet, ReadsLongContours)
{
  Writer writer;
  writer.IsImplicit = true; // others have no length for it
  std::string data;
  for (int i = 0; i < 20000; ++i)
  {
    data += (i == 0 ? "" : "\\") + std::to_string(i) + "\\0.5\\" + std::to_string(-i);
  }
  writer.Structures[0].Contours = { { "CLOSED_PLANAR", "20000", data } };
  const OutlineSet set = Read(writer.Write());
  ASSERT_EQ(set.GetOutlines()[0].Points.size(), 20000U);
  EXPECT_EQ(set.GetOutlines()[0].Points[19999], (Vec3{ 19999, 0.5, -19999 }));
}

TEST(StructureSet, ReadsNamesInTheirCharacters)
{
  Writer writer;
  writer.Structures[0].Name = "L\xC3\xA9sion";
  writer.Structures[2].Name = "";
  const OutlineSet set = Read(writer.Write());
  EXPECT_EQ(set.GetStructures()[0].Name, "L\xC3\xA9sion");
  EXPECT_EQ(set.GetStructures()[1].Name, "Structure 2");
}

TEST(StructureSet, SaysWhatIsWrongAndWhere)
{
  const auto spoil = [](const Contour& contour)
  {
    Writer writer;
    writer.Structures[0].Contours[1] = contour;
    return Error(writer);
  };
  ExpectContains(spoil({ "CLOSED_PLANAR", "4", "0\\0\\5\\1\\0\\5\\0\\1\\5" }),
    "contour 2 of 'Liver': Number of Contour Points (3006,0046) is '4', but Contour Data "
    "(3006,0050) has 9 coordinates");
  ExpectContains(spoil({ "CLOSED_PLANAR", "3", "0\\0\\5\\1\\0\\5\\0\\1" }), "has 8 coordinates");
  ExpectContains(spoil({ "CLOSED_PLANAR", "-1", "" }), "is '-1'");
  ExpectContains(spoil({ "CLOSED_PLANAR", "2147483647", "1\\2\\3" }), "has 3 coordinates");
  ExpectContains(spoil({ "CLOSED_PLANAR", "", "0\\0\\5\\1\\0\\5\\0\\1\\5" }), "is ''");
  for (const std::string bad : { "nan", "1e999", "1,5", "" })
  {
    ExpectContains(spoil({ "CLOSED_PLANAR", "3", "0\\0\\5\\1\\" + bad + "\\5\\0\\1\\5" }),
      "contour 2 of 'Liver': point 2 has the coordinate '" + bad + "'");
  }
  ExpectContains(spoil({ "CLOSED_PLANAR", "3", "0\\0\\5\\1\\0\\5\\0\\0\\5" }),
    "contour 2 of 'Liver' has 2 different points, but an outline needs 3");
  Writer writer;
  writer.Structures[0].Contours[1] = { "CLOSED_PLANAR", "2", "0\\0\\5\\1\\0\\5" };
  const OutlineSet few = Read(writer.Write());
  EXPECT_EQ(few.GetOutlines().size(), 2U);
  ExpectContains(few.Warnings[0], "1 of type CLOSED_PLANAR with fewer than 3 points");
  writer.Structures[0].Referenced = "9";
  ExpectContains(Error(writer), "contours belong to the ROI Number (3006,0084) '9'");
  writer = {};
  writer.Structures[0].Number = "2";
  ExpectContains(Error(writer), "two structures have the ROI Number (3006,0022) 2");
  writer = {};
  writer.Structures[0].Number = "x";
  ExpectContains(Error(writer), "no valid ROI Number");
  writer = {};
  writer.Structures.resize(2);
  writer.Structures.erase(writer.Structures.begin());
  ExpectContains(
    Error(writer), "has no contour of type CLOSED_PLANAR (3006,0042); it has 1 of type POINT");
  writer.Structures.clear();
  ExpectContains(Error(writer), "has no contour of type CLOSED_PLANAR");
  for (const std::string& message : { Error(writer), spoil({ "CLOSED_PLANAR", "9", "" }) })
  {
    EXPECT_EQ(message.find("Doe"), std::string::npos); // the patient
  }
}

TEST(StructureSet, NamesWhatAnotherFileIs)
{
  Writer writer;
  writer.SopClass = "1.2.840.10008.5.1.4.1.1.2";
  writer.Modality = "CT";
  ExpectContains(Error(writer),
    "is a DICOM file, but no RT structure set: modality CT (0008,0060), SOP class "
    "1.2.840.10008.5.1.4.1.1.2 (0008,0016); open it with CT Series Reader");
  writer.Modality = "RTDOSE";
  ExpectContains(Error(writer), "choose the file of modality RTSTRUCT");
}

TEST(StructureSet, WarnsOfSeveralFramesOfReference)
{
  Writer writer;
  writer.Structures[2].Frame = "1.2.4";
  const OutlineSet set = Read(writer.Write());
  ASSERT_EQ(set.Warnings.size(), 3U);
  ExpectContains(set.Warnings[2], "2 frames of reference");
}

TEST(StructureSet, IsKnownByItsClass)
{
  const Temporary folder;
  Writer writer;
  EXPECT_TRUE(IsOutlineFile(folder.Write(writer.Write())));
  EXPECT_EQ(GetOutlineFileKind(folder.Write(writer.Write())), OutlineFileKind::Dicom);
  writer.SopClass = "1.2.840.10008.5.1.4.1.1.2";
  EXPECT_FALSE(IsOutlineFile(folder.Write(writer.Write())));
}

TEST(StructureSet, SurvivesCutsAndDamage)
{
  const Temporary folder;
  for (const bool isOpen : { false, true })
  {
    Writer writer;
    writer.IsOpen = isOpen;
    const std::string whole = writer.Write();
    const auto read = [&](const std::string& bytes)
    { return ErrorOf([&] { ReadStructureSet(folder.Write(bytes)); }); };
    for (std::size_t at = 0; at < whole.size(); at += 9)
    {
      EXPECT_GT(read(whole.substr(0, at)).size(), 30U) << at;
      std::string damaged = whole;
      damaged[at] = static_cast<char>(damaged[at] ^ 0x5A);
      const std::string error = read(damaged);
      EXPECT_TRUE(error == "no error" || error.size() > 30) << error;
    }
    const std::string last = writer.Element(0x300E0002, "CS", "UNAPPROVED");
    EXPECT_EQ(read(whole.substr(0, whole.size() - last.size())), "no error"); // all contours
    EXPECT_NE(read(whole.substr(0, whole.size() - last.size() - 1)), "no error");
  }
}
}
