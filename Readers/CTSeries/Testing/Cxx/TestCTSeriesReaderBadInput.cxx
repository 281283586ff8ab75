// SPDX-License-Identifier: BSD-3-Clause
// Input that is no single well-formed volume: the message names the file and the tag.
#include "CTSeriesReaderTesting.h"

#include <filesystem>
#include <fstream>
#include <iterator>

namespace
{
CTTestSeries Edited(const std::vector<CTTestSeries::Edit>& edits, int slices = 6)
{
  CTTestSeries series;
  series.Slices = slices;
  series.Edits = edits;
  return series;
}

std::string BaseName(const std::string& path)
{
  return std::filesystem::path(path).filename().string();
}

void ExpectErrorOf(const CTTestSeries& series, int slice, const std::vector<std::string>& parts)
{
  ReaderOf test(series);
  test.ExpectError(BaseName(test.Files[slice]));
  for (const std::string& part : parts)
  {
    LACUNA_CHECK_CONTAINS(test.Errors, part);
  }
}

// Replaces the value of a US element in a file of the explicit syntax, also of a compressed one.
void Patch(const std::string& file, const std::string& tag, const std::string& value)
{
  std::ifstream stream(file, std::ios::binary);
  std::string bytes(std::istreambuf_iterator<char>(stream), {});
  stream.close();
  const std::size_t place = bytes.find(tag + std::string("US\x02\0", 4));
  LACUNA_CHECK(place != std::string::npos);
  bytes.replace(place + 8, 2, value);
  std::ofstream(file, std::ios::binary) << bytes;
}

const std::string RowsTag("\x28\0\x10\0", 4);
const std::string HighBitTag("\x28\0\x02\x01", 4);
const std::string ColumnsTag("\x28\0\x11\0", 4);

void TestMixedSeries()
{
  ReaderOf test(Edited({}));
  CTTestSeries second = Edited({}, 3);
  second.SeriesUid = "1.2.3.77";
  second.Write(test.Folder + "/second");
  test.ExpectError("there are 2 CT series; set SeriesUID to one of these (0020,000E):");
  LACUNA_CHECK_CONTAINS(test.Errors, "3 images of 44 x 36, first file IM0001.dcm");
  // opened by a file, and told that there is more
  test.Reader->SetFileName(test.Files[0].c_str());
  test.ExpectGood();
  CTTestSeries beside = second;
  beside.Slices = 1;
  const std::string other = beside.Write(test.Folder + "/beside")[0];
  std::filesystem::rename(other, test.Folder + "/other.dcm");
  test.Reader->Modified();
  test.ExpectGood();
  LACUNA_CHECK(test.Reader->GetOutput()->GetDimensions()[2] == 6);
  LACUNA_CHECK_CONTAINS(test.GetNotes(), "there are 2 CT series (0020,000E)");
}

void TestTwoPatients()
{
  ReaderOf test(Edited({}));
  CTTestSeries second = Edited({ { 0x0010, 0x0020, "LO", "OTHER-ID", {} } });
  second.SeriesUid = "1.2.3.77";
  second.Write(test.Folder + "/second");
  test.ExpectError("there are 2 CT series of 2 patients (0010,0020); set SeriesUID");
  for (const char* secret : { "Secret", "SECRET", "OTHER" })
  {
    LACUNA_CHECK_THAT(test.Errors.find(secret) == std::string::npos, secret);
  }
  // in one series
  ExpectErrorOf(
    Edited({ { 0x0010, 0x0020, "LO", "OTHER", { 4 } } }), 4, { "another patient (0010,0020)" });
  ExpectErrorOf(Edited({ { 0x0010, 0x0010, "PN", "Other", { 4 } } }), 4,
    { "another patient (0010,0010)", "the name differs" });
  // of the same identification
  ReaderOf names(Edited({}));
  second = Edited({ { 0x0010, 0x0010, "PN", "OTHER^Name", {} } });
  second.SeriesUid = "1.2.3.77";
  second.Write(names.Folder + "/second");
  names.ExpectError("there are 2 CT series of 2 patients (0010,0010); set SeriesUID");
}

void TestNoCT()
{
  ReaderOf test(Edited({}));
  for (const std::string& file : test.Files)
  {
    std::filesystem::remove(file);
  }
  std::ofstream(test.Folder + "/liesmich.txt") << "no image";
  test.ExpectError("there is no CT image");

  ReaderOf colour(Edited({ { 0x0028, 0x0002, "US", "3", {} } }));
  colour.ExpectError("there is no CT image");
  LACUNA_CHECK_CONTAINS(
    colour.Errors, "IM0001.dcm: left out, it is a colour image (0028,0002); so are 5 others");
}

// What is no DICOM file, or says that it is CT and is not, is named.
void TestDamagedFiles()
{
  ReaderOf test(
    Edited({ { 0x0008, 0x0060, "CS", "C?", { 0 } }, { 0x0020, 0x000E, "UI", "", { 1 } } }));
  const std::string last = test.Files[5];
  std::ofstream(last, std::ios::binary | std::ios::trunc) << std::string(900, '\0');
  std::ofstream(test.Folder + "/liesmich.txt") << "no image";
  test.ExpectGood();
  LACUNA_CHECK(test.Reader->GetOutput()->GetDimensions()[2] == 3);
  LACUNA_CHECK_CONTAINS(test.Warnings, BaseName(last) + ": is not a DICOM file");
  LACUNA_CHECK_CONTAINS(test.Warnings,
    BaseName(test.Files[0]) + ": is CT by its SOP Class (0008,0016), but its Modality (0008,0060)");
  LACUNA_CHECK_CONTAINS(
    test.Warnings, BaseName(test.Files[1]) + ": has no Series Instance UID (0020,000E)");
  LACUNA_CHECK_CONTAINS(
    test.GetNotes(), "2 files are no DICOM files: " + BaseName(last) + ", liesmich.txt");
}

void TestSizes()
{
  ReaderOf mixed(Edited({}));
  CTTestSeries small = Edited({}, 1);
  small.Rows = 20;
  small.First = { -20, -24, -4 };
  const std::string file = small.Write(mixed.Folder + "/small")[0];
  std::filesystem::rename(file, mixed.Folder + "/small.dcm");
  mixed.ExpectError("small.dcm: has 44 x 20 pixels (Columns (0028,0011) x Rows (0028,0010)), but");

  // With too few columns each row would begin further to the right than the one before.
  CTTestSeries frames = Edited({ { 0x0028, 0x0011, "US", "43", {} } });
  frames.MultiFrame = true;
  ExpectErrorOf(frames, 0,
    { "has 19008 bytes of Pixel Data (7FE0,0010)", "6 x 43 x 36 pixels", "(0028,0011)" });
  frames.Edits = { { 0x0028, 0x0010, "US", "35", {} } };
  ExpectErrorOf(frames, 0, { "6 x 44 x 35 pixels", "(0028,0010)" });
  for (const char* number : { "5", "7", "six" })
  {
    frames.Edits = { { 0x0028, 0x0008, "IS", number, {} } };
    ReaderOf test(frames);
    test.Reader->SetFileName(test.Files[0].c_str());
    test.ExpectError(std::string("IM0001: Number of Frames (0028,0008) is ") + number);
  }
  ExpectErrorOf(Edited({ { 0x0028, 0x0010, "US", "", { 2 } } }), 2, { "Rows (0028,0010)" });
  ExpectErrorOf(Edited({ { 0x0028, 0x0100, "US", "", { 2 } } }), 2, { "(0028,0100)" });
  ExpectErrorOf(Edited({ { 0x0028, 0x0101, "US", "", { 2 } } }), 2, { "(0028,0101)" });
  ExpectErrorOf(Edited({ { 0x0028, 0x0103, "US", "", { 2 } } }), 2, { "(0028,0103)" });
  ExpectErrorOf(Edited({ { 0x0028, 0x0103, "US", "2", { 2 } } }), 2, { "(0028,0103)" });
}

// Numbers play no part: the same volume, and a note.
void TestInvertedOrder()
{
  CTTestSeries series = Edited({});
  for (int k = 0; k < 6; ++k)
  {
    series.Edits.push_back({ 0x0020, 0x0013, "IS", std::to_string(6 - k), { k } });
  }
  ReaderOf test(series);
  test.ExpectGood();
  LACUNA_CHECK(test.Warnings.empty());
  vtkImageData* image = test.Reader->GetOutput();
  LACUNA_CHECK(image->GetOrigin()[2] == -16 && image->GetSpacing()[2] == 2);
  LACUNA_CHECK_NEAR(
    image->GetScalarComponentAsDouble(2, 1, 4, 0), CTTruth({ -18.2, -22.7, -8 }), 1);
  LACUNA_CHECK_CONTAINS(test.GetNotes(),
    "Instance Number (0020,0013) falls along the slice normal, from " + BaseName(test.Files[0]) +
      " at -16 mm to " + BaseName(test.Files[5]) + " at -6 mm");
}

void TestAnisotropic()
{
  ReaderOf test(Edited({}));
  test.ExpectGood(); // 0.9 mm from column to column, 1.3 from row to row
  LACUNA_CHECK(test.Reader->GetOutput()->GetSpacing()[0] == 0.9);
  LACUNA_CHECK(test.Reader->GetOutput()->GetSpacing()[1] == 1.3);
  ExpectErrorOf(Edited({ { 0x0028, 0x0030, "DS", "0.9\\1.3", { 3 } } }), 3,
    { "has Pixel Spacing (0028,0030) 0.9 x 1.3 mm, but " });
  for (const char* wrong : { "1.3", "1.3\\", "-1.3\\0.9", "1.3\\0.9\\2", "1.3\\+-0.9", "1,3\\0,9" })
  {
    ExpectErrorOf(Edited({ { 0x0028, 0x0030, "DS", wrong, { 3 } } }), 3,
      { "has no valid Pixel Spacing (0028,0030)" });
  }
}

// Sizes that only the header claims are not allocated.
void TestClaimedSizes()
{
  for (const char* syntax : { "1.2.840.10008.1.2.5", "1.2.840.10008.1.2.4.70" })
  {
    CTTestSeries series = Edited({}, 2);
    series.TransferSyntax = syntax;
    ReaderOf test(series);
    for (const std::string& file : test.Files)
    {
      Patch(file, RowsTag, "\xFF\xFF");
      Patch(file, ColumnsTag, "\xFF\xFF");
    }
    const int one[6] = { 0, 0, 0, 0, 0, 0 };
    test.Reader->UpdateExtent(one);
    LACUNA_CHECK_CONTAINS(test.Errors, BaseName(test.Files[0]) + ": its compressed pixels are ");
    LACUNA_CHECK(test.Reader->GetOutput()->GetNumberOfPoints() == 0);
  }
  // a layout of ACR-NEMA, for which GDCM ends its process by an assertion; the reader goes on
  CTTestSeries layout = Edited({});
  layout.TransferSyntax = "1.2.840.10008.1.2.4.70";
  layout.BitsStored = 12;
  layout.Signed = false;
  layout.Intercept = -1024;
  ReaderOf test(layout);
  test.ExpectGood();
  Patch(test.Files[3], HighBitTag, std::string("\x0F\0", 2));
  test.Reader->Modified();
  test.ExpectError(BaseName(test.Files[3]) + ": its compressed pixels cannot be decoded: ");
  LACUNA_CHECK_CONTAINS(test.Errors, "; get this slice from the archive again");
  Patch(test.Files[3], HighBitTag, std::string("\x0B\0", 2));
  test.Reader->Modified();
  test.ExpectGood();
  // a shear that no grid could hold
  CTTestSeries sheared = Edited({}, 3);
  sheared.Step = { 1e5, 0, 2 };
  ExpectErrorOf(sheared, 0, { "sheared by", "Image Position (Patient) (0020,0032)" });
}
}

int TestCTSeriesReaderBadInput(int, char*[])
{
  TestMixedSeries();
  TestTwoPatients();
  TestNoCT();
  TestDamagedFiles();
  TestSizes();
  TestInvertedOrder();
  TestAnisotropic();
  TestClaimedSizes();
  return lacunaCheck::Result();
}
