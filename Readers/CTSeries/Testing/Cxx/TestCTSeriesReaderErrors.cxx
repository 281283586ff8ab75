// SPDX-License-Identifier: BSD-3-Clause
// Whatever would make a wrong volume ends in an error that says where, and an empty output.
#include "CTSeriesReaderTesting.h"
#include "CTTestCases.h"
#include "vtkCallbackCommand.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkLogger.h"
#include "vtkObjectFactory.h"
#include "vtkOutputWindow.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"

#include <chrono>
#include <cmath>
#include <fstream>
#include <iterator>

namespace
{
using Edit = CTTestSeries::Edit;

CTTestSeries Edited(const std::vector<Edit>& edits)
{
  CTTestSeries series;
  series.Slices = 6;
  series.Edits = edits;
  return series;
}

std::string BaseName(const std::string& path)
{
  return std::filesystem::path(path).filename().string();
}

// One slice of a series is changed; the error names its file and says part.
void ExpectEditError(const Edit& edit, const std::string& part)
{
  ReaderOf test(Edited({ edit }));
  test.ExpectError(part);
  LACUNA_CHECK_CONTAINS(
    test.Errors, edit.Only.empty() ? "IM00" : BaseName(test.Files[edit.Only[0]]));
}

void TestTags()
{
  ExpectEditError({ 0x0020, 0x0032, "DS", "", { 3 } }, "Image Position (Patient) (0020,0032)");
  ExpectEditError({ 0x0020, 0x0032, "DS", "1\\2", { 3 } }, "Image Position (Patient) (0020,0032)");
  ExpectEditError({ 0x0020, 0x0032, "DS", "1\\2\\x", { 3 } }, "(0020,0032)");
  ExpectEditError({ 0x0020, 0x0037, "DS", "", { 3 } }, "Image Orientation (Patient) (0020,0037)");
  ExpectEditError({ 0x0020, 0x0037, "DS", "1\\0\\0\\0\\0.8\\0.6", { 3 } },
    "another Image Orientation (Patient) (0020,0037)");
  ExpectEditError({ 0x0020, 0x0037, "DS", "1\\0\\0\\0.1\\1\\0", {} },
    "is 1\\0\\0\\0.1\\1\\0; it must be two unit vectors at a right angle");
  ExpectEditError({ 0x0020, 0x0037, "DS", "2\\0\\0\\0\\1\\0", {} }, "two unit vectors");
  ExpectEditError({ 0x0028, 0x0030, "DS", "", { 2 } }, "Pixel Spacing (0028,0030)");
  ExpectEditError({ 0x0028, 0x0030, "DS", "0\\1", { 2 } }, "Pixel Spacing (0028,0030)");
  ExpectEditError(
    { 0x0028, 0x0030, "DS", "1.3\\0.8", { 2 } }, "Pixel Spacing (0028,0030) 1.3 x 0.8");
  ExpectEditError({ 0x0028, 0x1053, "DS", "", { 4 } }, "Rescale Slope (0028,1053)");
  ExpectEditError({ 0x0028, 0x1052, "DS", "", { 4 } }, "Rescale Intercept (0028,1052)");
  ExpectEditError({ 0x0028, 0x1053, "DS", "0", { 4 } }, "Rescale Slope (0028,1053)");
  ExpectEditError({ 0x0028, 0x1053, "DS", "1e300", { 4 } }, "beyond what a voxel can hold");
  ExpectEditError({ 0x0028, 0x1052, "DS", "-1e39", { 4 } }, "beyond what a voxel can hold");
  ExpectEditError({ 0x0028, 0x1053, "DS", "inf", { 4 } }, "Rescale Slope (0028,1053)");
  ExpectEditError({ 0x0028, 0x1054, "LO", "OD", { 4 } }, "Rescale Type (0028,1054) is OD");
  ExpectEditError({ 0x0020, 0x0020, "CS", "R\\P", { 2 } }, "Patient Orientation (0020,0020)");
  ExpectEditError({ 0x0028, 0x0010, "US", "20", { 1 } }, "but 1 x 44 x 20 pixels");
  ExpectEditError({ 0x0028, 0x0010, "US", "80", { 1 } }, "take 7040");
  ExpectEditError({ 0x0028, 0x0100, "US", "12", { 1 } }, "Bits Allocated (0028,0100)");
  ExpectEditError({ 0x0028, 0x0101, "US", "17", { 1 } }, "Bits Stored (0028,0101)");
  ExpectEditError({ 0x0028, 0x0102, "US", "3", { 1 } }, "High Bit");
  ExpectEditError({ 0x0010, 0x0020, "LO", "OTHER", { 5 } }, "another patient (0010,0020)");
  ExpectEditError({ 0x0020, 0x0052, "UI", "1.2.3", { 5 } }, "Frame of Reference UID (0020,0052)");
  ExpectEditError({ 0x7FE0, 0x0010, "OW", "", { 2 } }, "has no Pixel Data (7FE0,0010)");
  ExpectEditError({ 0x0020, 0x0032, "DS", "1e300\\0\\-10", { 3 } }, "displaced sideways");
  ExpectEditError(
    { 0x0020, 0x0032, "DS", "0\\0\\1e12", { 5 } }, "from slice to slice that would be");
}

// What the files say of themselves besides, and contradicts or leaves open.
void TestDoubts()
{
  ReaderOf unspecified(Edited({ { 0x0028, 0x1054, "LO", "US", { 1 } } }));
  unspecified.ExpectGood();
  LACUNA_CHECK_CONTAINS(unspecified.Warnings,
    BaseName(unspecified.Files[1]) + ": Rescale Type (0028,1054) is US, unspecified");
  ReaderOf unsaid(Edited({ { 0x0028, 0x1054, "LO", "", {} } }));
  unsaid.ExpectGood();
  LACUNA_CHECK(unsaid.Warnings.empty());

  // half of it another patient's?
  const CTTestSeries::Edit edits[] = { { 0x0010, 0x0030, "DA", "19550505", { 3, 4, 5 } },
    { 0x0010, 0x0040, "CS", "M", { 3, 4, 5 } }, { 0x0018, 0x5100, "CS", "FFS", { 3, 4, 5 } } };
  const char* const tags[] = { "Patient's Birth Date (0010,0030)", "Patient's Sex (0010,0040)",
    "Patient Position (0018,5100)" };
  for (int i = 0; i < 3; ++i)
  {
    ReaderOf halves(Edited({ edits[i] }));
    halves.ExpectGood();
    LACUNA_CHECK_CONTAINS(
      halves.Warnings, std::string(" and 2 more have another ") + tags[i] + " than ");
    LACUNA_CHECK_THAT(halves.Warnings.find("1955") == std::string::npos, halves.Warnings);
    // some that do not say are no contradiction
    CTTestSeries::Edit silent = edits[i];
    silent.Value = "";
    silent.Only = { 0, 4 };
    ReaderOf some(Edited({ silent }));
    some.ExpectGood();
    LACUNA_CHECK_THAT(some.Warnings.empty(), some.Warnings);
  }
  ReaderOf whole(Edited({ { 0x0018, 0x5100, "CS", "FFS", {} } }));
  whole.ExpectGood();
  LACUNA_CHECK_THAT(whole.Warnings.empty(), whole.Warnings);

  ReaderOf agrees(Edited({ { 0x0020, 0x0020, "CS", "L\\P", {} } }));
  agrees.ExpectGood();
  ReaderOf animal(
    Edited({ { 0x0020, 0x0020, "CS", "R\\PA", {} }, { 0x0010, 0x2210, "CS", "QUADRUPED", {} } }));
  animal.ExpectGood();
  CTTestSeries frames = Edited({ { 0x0020, 0x0020, "CS", "R\\P", {} } });
  frames.MultiFrame = true;
  ReaderOf multi(frames);
  multi.ExpectError("IM0001 frame 1: Patient Orientation (0020,0020)");
}

void TestProperties()
{
  ReaderOf test(Edited({}));
  for (const double padding : { HUGE_VAL, -1e300, std::nan("") })
  {
    test.Reader->SetPaddingValue(padding);
    test.ExpectError("PaddingValue is ");
  }
  test.Reader->SetPaddingValue(3e38);
  test.ExpectGood();
  test.Reader->SetPaddingValue(-1024);
  for (const double tolerance : { HUGE_VAL, -1.0, 0.0, 20.0, std::nan("") })
  {
    test.Reader->SetPositionTolerance(tolerance);
    test.ExpectError("PositionTolerance is ");
  }
  test.Reader->SetPositionTolerance(0.05);
  test.Reader->SetMissingSlices(2);
  test.ExpectError("MissingSlices is 2; it must be 0 (Error) or 1 (Interpolate)");
  test.Reader->SetMissingSlices(vtkLacunaCTSeriesReader::Error);
  test.Reader->SetAcquisition(-2);
  test.ExpectError("Acquisition is -2; it must be -1 or more");
  test.Reader->SetAcquisition(-1);
  test.Reader->SetPositionTolerance(3); // more than the distance of slices
  test.ExpectGood();
  LACUNA_CHECK(test.Reader->GetOutput()->GetDimensions()[2] == 6);
  LACUNA_CHECK(test.Warnings.empty());
}

// A file that was left out is named where it leaves a gap.
void TestGapOfLeftOut()
{
  const std::string gap = "1 slice is missing at -10 mm";
  ReaderOf cut(Edited({}));
  std::filesystem::resize_file(cut.Files[3], 300);
  cut.ExpectError(gap);
  LACUNA_CHECK_CONTAINS(cut.Errors, "\nOf the files there:\n  " + cut.Files[3] + ": ");
  LACUNA_CHECK_CONTAINS(cut.Errors, "; the file is left out");
  LACUNA_CHECK_CONTAINS(cut.GetNotes(), cut.Files[3] + ": ");

  ReaderOf empty(Edited({ { 0x0028, 0x0002, "US", "3", { 2 } } }));
  std::filesystem::resize_file(empty.Files[3], 0);
  empty.ExpectError("2 slices are missing at -12 mm, -10 mm");
  LACUNA_CHECK_CONTAINS(
    empty.Errors, BaseName(empty.Files[2]) + ": left out, it is a colour image (0028,0002)");
  LACUNA_CHECK_CONTAINS(empty.GetNotes(), "1 files are no DICOM files");
  LACUNA_CHECK_CONTAINS(empty.GetNotes(), "left out, it is a colour image");

  // the file that was opened is named once; of many, the first ones are
  cut.Reader->SetFileName(cut.Files[3].c_str());
  cut.ExpectError(cut.Files[3] + ": ");
  LACUNA_CHECK(cut.Errors.find("Of the files there") == std::string::npos);
  ReaderOf many{ CTTestSeries() };
  for (const int k : { 1, 2, 3, 5, 6, 8, 9, 10, 11, 13 })
  {
    std::filesystem::resize_file(many.Files[k], 300);
  }
  many.ExpectError("the slices are not equally spaced");
  LACUNA_CHECK_CONTAINS(many.Errors, "and 2 notes more");
}

// ParaView sets one property after the other and asks for information in between: only what the data
// are asked with counts.
void TestInformation()
{
  CTTestSeries series;
  series.Places = { 0, 1, 2, 4, 5, 6 };
  ReaderOf test(series);
  test.Reader->UpdateInformation();
  LACUNA_CHECK_THAT(test.Errors.empty(), test.Errors);
  LACUNA_CHECK(test.Reader->GetErrorCode() == vtkErrorCode::FileFormatError);
  LACUNA_CHECK_CONTAINS(test.GetSeriesList(), "6 images of 44 x 36");
  test.Reader->SetMissingSlices(vtkLacunaCTSeriesReader::Interpolate);
  test.ExpectGood();
  test.Reader->SetMissingSlices(vtkLacunaCTSeriesReader::Error);
  test.Reader->UpdateInformation();
  test.ExpectError("1 slice is missing");
  test.ExpectError("1 slice is missing"); // again, not an empty volume in silence
  test.Reader->SetMissingSlices(vtkLacunaCTSeriesReader::Interpolate);
  test.ExpectGood();
}

// Counts what is shown, and what those hear who listen.
class CountingWindow : public vtkOutputWindow
{
public:
  static CountingWindow* New();
  vtkTypeMacro(CountingWindow, vtkOutputWindow);
  int Shown = 0;
  int Heard = 0;

  void DisplayErrorText(const char* text) override
  {
    ++this->Shown;
    this->InvokeEvent(vtkCommand::ErrorEvent, const_cast<char*>(text));
  }

protected:
  CountingWindow() { this->AddObserver(vtkCommand::ErrorEvent, this, &CountingWindow::Hear); }

private:
  void Hear(vtkObject*, unsigned long, void* text)
  {
    this->Heard +=
      std::string(static_cast<const char*>(text)).find("1 slice is missing") != std::string::npos;
  }
};
vtkStandardNewMacro(CountingWindow);

// ParaView asks again and again: the error is shown once, and each time to those who listen.
void TestShownOnce()
{
  CTTestSeries series;
  series.Places = { 0, 1, 2, 4, 5, 6 };
  const ReaderOf test(series);
  const vtkSmartPointer<vtkOutputWindow> before = vtkOutputWindow::GetInstance();
  vtkNew<CountingWindow> window;
  vtkOutputWindow::SetInstance(window);
  vtkLogger::SetStderrVerbosity(
    vtkLogger::VERBOSITY_OFF); // CTest takes errors in the log for failures
  vtkNew<vtkLacunaCTSeriesReader> reader;
  reader->SetFileName(test.Folder.c_str());
  const auto start = std::chrono::steady_clock::now();
  const auto update = [&](int shown, int heard)
  {
    window->Shown = window->Heard = 0;
    reader->Update();
    LACUNA_CHECK(window->Heard == heard);
    // on a machine that takes seconds for this it may be shown again
    const bool fast = std::chrono::steady_clock::now() - start < std::chrono::seconds(4);
    LACUNA_CHECK(!fast || window->Shown == shown);
    LACUNA_CHECK(reader->GetOutput()->GetNumberOfPoints() == 0);
  };
  update(1, 1);
  update(0, 1);
  update(0, 1);
  reader->Modified(); // another try
  update(1, 1);
  update(0, 1);
  LACUNA_CHECK(!reader->GetExecutive()->HasObserver(vtkCommand::ErrorEvent));
  vtkOutputWindow::SetInstance(before);
  vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_INFO);
}

void TestLeftOut()
{
  CTTestSeries other = Edited({ { 0x0008, 0x0060, "CS", "MR", {} },
    { 0x0008, 0x0016, "UI", "1.2.840.10008.5.1.4.1.1.4", {} } });
  ReaderOf test(other);
  test.ExpectError("there is no CT image");
  LACUNA_CHECK_CONTAINS(test.Errors, "is of modality MR, not CT (0008,0060); so are 5 others");

  ReaderOf mixed(Edited({ { 0x0008, 0x0008, "CS", "ORIGINAL\\PRIMARY\\LOCALIZER", { 5 } },
    { 0x0008, 0x0016, "UI", "1.2.840.10008.5.1.4.1.1.7", { 4 } },
    { 0x0028, 0x0002, "US", "3", { 0 } } }));
  std::ofstream(mixed.Folder + "/liesmich.txt") << "no image";
  mixed.ExpectGood();
  LACUNA_CHECK(mixed.Warnings.empty());
  LACUNA_CHECK(mixed.Reader->GetOutput()->GetDimensions()[2] == 3);
  const std::string notes = mixed.GetNotes();
  LACUNA_CHECK_CONTAINS(notes, BaseName(mixed.Files[5]) + ": left out, it is a localizer");
  LACUNA_CHECK_CONTAINS(notes, BaseName(mixed.Files[4]) + ": left out, it is a secondary capture");
  LACUNA_CHECK_CONTAINS(notes, BaseName(mixed.Files[0]) + ": left out, it is a colour image");
  LACUNA_CHECK_CONTAINS(notes, "1 files are no DICOM files");
}

// A sideways scout of the series that does not say that it is one, with pixels of its own size.
void TestScout()
{
  ReaderOf test(Edited({ { 0x0020, 0x0037, "DS", "0\\1\\0\\0\\0\\-1", { 0 } },
    { 0x0028, 0x0030, "DS", "0.5\\0.5", { 0 } } }));
  test.ExpectGood();
  LACUNA_CHECK_THAT(test.Warnings.empty(), test.Warnings);
  vtkImageData* image = test.Reader->GetOutput();
  LACUNA_CHECK(image->GetDimensions()[2] == 5);
  LACUNA_CHECK_NEAR(image->GetOrigin()[2], -14, 1e-12);
  LACUNA_CHECK_NEAR(
    image->GetScalarComponentAsDouble(2, 1, 3, 0), CTTruth({ -18.2, -22.7, -8 }), 1);
  LACUNA_CHECK_CONTAINS(test.GetNotes(), BaseName(test.Files[0]) + ": left out, it is a scout by");
}

void TestSeries()
{
  ReaderOf test{ CTTestSeries() };
  CTTestSeries second;
  second.SeriesUid = "1.2.3.77";
  second.Description = "Other";
  second.Slices = 4;
  const std::string file = second.Write(test.Folder + "/inner folder")[2];
  second.MultiFrame = true;
  test.ExpectError("there are 2 CT series; set SeriesUID to one of these (0020,000E):");
  const std::string line = "1.2.3.77  series 4, \"Other\", 4 images of 44 x 36";
  LACUNA_CHECK_CONTAINS(test.Errors, line);
  LACUNA_CHECK_CONTAINS(test.GetSeriesList(), line);
  test.Reader->SetSeriesUID("1.2.3.78");
  test.ExpectError("there is no CT series 1.2.3.78; there are:");
  test.Reader->SetSeriesUID(line.c_str());
  test.ExpectGood();
  LACUNA_CHECK(test.Reader->GetOutput()->GetDimensions()[2] == 4);
  test.Reader->SetSeriesUID("1.2.826.0.1.3680043.2.1125.1");
  test.ExpectGood();
  LACUNA_CHECK(test.Reader->GetOutput()->GetDimensions()[2] == 17);
  // a file stands for its own series
  test.Reader->SetSeriesUID(nullptr);
  test.Reader->SetFileName(file.c_str());
  test.ExpectGood();
  LACUNA_CHECK(test.Reader->GetOutput()->GetDimensions()[2] == 4);
}

void TestFiles()
{
  ReaderOf test(Edited({}));
  test.Reader->SetFileName(nullptr);
  test.ExpectError("FileName is not set", vtkErrorCode::NoFileNameError);
  test.Reader->SetFileName("/nonexistent/scan");
  test.ExpectError("there is no such file or folder", vtkErrorCode::FileNotFoundError);
  const std::string text = test.Folder + "/text.dcm";
  std::ofstream(text) << "no image";
  test.Reader->SetFileName(text.c_str());
  test.ExpectError("text.dcm: is not a DICOM file");
  LACUNA_CHECK(test.Reader->CanReadFile(text.c_str()) == 0);
  const std::string nifti = std::string(344, 'x') + "n+1";
  for (const auto& [bytes, words] : { std::pair<std::string, const char*>{ "\xFF\xD8\xFF\xE0 JFIF",
                                        "text.dcm: is not a DICOM file but a picture (JPEG or "
                                        "PNG). Choose a file that the scanner wrote" },
         { "\x89PNG\r\n", "is not a DICOM file but a picture" },
         { "ObjectType = Image\nNDims = 3\n", "open it by Volume Reader" },
         { "NRRD0004\n", "open it by Volume Reader" }, { nifti, "open it by Volume Reader" } })
  {
    std::ofstream(text) << bytes;
    test.Reader->SetFileName(text.c_str());
    test.Reader->Modified();
    test.ExpectError(words);
  }
  LACUNA_CHECK(test.Reader->CanReadFile(test.Files[0].c_str()) == 1);
  LACUNA_CHECK(test.Reader->CanReadFile(test.Folder.c_str()) == 1);
  LACUNA_CHECK(test.Reader->CanReadFile("/nonexistent/scan") == 0);
  LACUNA_CHECK(test.Reader->CanReadFile(nullptr) == 0);
  test.Reader->SetFileName(test.Files[0].c_str());
  test.ExpectGood();

  // a change on the disk is seen
  std::filesystem::remove(test.Files[0]);
  test.Reader->SetFileName(test.Folder.c_str());
  test.ExpectGood();
  LACUNA_CHECK(test.Reader->GetOutput()->GetDimensions()[2] == 5);
  std::filesystem::remove(test.Files[2]);
  test.Reader->Modified();
  test.ExpectError("1 slice is missing at -12 mm");
}

// A file that ends anywhere is named, and nothing crashes.
void TestTruncated()
{
  for (const char* syntax : { "1.2.840.10008.1.2.1", "1.2.840.10008.1.2", "1.2.840.10008.1.2.1.99",
         "1.2.840.10008.1.2.4.70", "1.2.840.10008.1.2.5" })
  {
    CTTestSeries series = Edited({});
    series.Slices = 3;
    series.TransferSyntax = syntax;
    ReaderOf test(series);
    const auto size = std::filesystem::file_size(test.Files[1]);
    std::filesystem::copy(test.Files[1], test.Folder + "/whole.keep");
    // GDCM writes a check sum after the stream of a deflated file, which no one needs
    const bool deflated = series.TransferSyntax == "1.2.840.10008.1.2.1.99";
    for (std::uintmax_t cut = size - (deflated ? 16 : 1); cut > 140; cut -= cut > 1500 ? 97 : 7)
    {
      std::filesystem::resize_file(test.Files[1], cut);
      std::filesystem::remove(test.Folder + "/whole.keep");
      test.Errors.clear();
      test.Warnings.clear();
      test.Reader->Modified();
      test.Reader->Update();
      const std::string said = test.Errors + test.Warnings + test.GetNotes();
      LACUNA_CHECK_CONTAINS(said, BaseName(test.Files[1]));
    }
  }
}

void TestGaps()
{
  CTTestSeries series;
  series.Places = { 0, 1, 2, 4, 5, 6, 7, 10, 11, 12 }; // -16 mm and 2 mm for each
  ReaderOf test(series);
  test.ExpectError("3 slices are missing at -10 mm, 0 mm, 2 mm along the slice normal");
  LACUNA_CHECK_CONTAINS(test.Errors, "set MissingSlices to Interpolate");
  test.Reader->SetMissingSlices(vtkLacunaCTSeriesReader::Interpolate);
  test.ExpectGood();
  vtkImageData* image = test.Reader->GetOutput();
  LACUNA_CHECK(image->GetDimensions()[2] == 13);
  vtkDataArray* planes = image->GetFieldData()->GetArray("InterpolatedSlices");
  LACUNA_CHECK(planes && planes->GetNumberOfTuples() == 3);
  for (int i = 0; planes && i < 3; ++i)
  {
    LACUNA_CHECK(planes->GetTuple1(i) == (i == 0 ? 3 : 7 + i));
  }
  // the truth is linear outside of the letter
  double worst = 0;
  for (vtkIdType id = 0; id < image->GetNumberOfPoints(); ++id)
  {
    lacuna::Vec3 point{};
    image->GetPoint(id, point.data());
    if (IsInLetter(point, 6.1) == IsInLetter(point, -6.1))
    {
      worst = std::max(
        worst, std::abs(image->GetPointData()->GetScalars()->GetTuple1(id) - CTTruth(point)));
    }
  }
  LACUNA_CHECK_NEAR(worst, 0, 1.0);
  LACUNA_CHECK_CONTAINS(
    test.GetNotes(), "3 of 13 planes, every 2 mm, are interpolated; 10 of 10 measured slices");
}

void TestUnequal()
{
  CTTestSeries series;
  series.Places = { 0, 1, 2, 3, 4.3, 5, 6, 7, 8 };
  ReaderOf test(series);
  test.ExpectError("the slices are not equally spaced: mostly 2 mm, but 2.6 mm between ");
  LACUNA_CHECK_CONTAINS(test.Errors,
    BaseName(test.Files[3]) + " at -10 mm and " + BaseName(test.Files[4]) +
      " at -7.4 mm, 1.4 mm between ");
  test.Reader->SetMissingSlices(vtkLacunaCTSeriesReader::Interpolate);
  test.ExpectGood();
  vtkDataArray* planes = test.Reader->GetOutput()->GetFieldData()->GetArray("InterpolatedSlices");
  LACUNA_CHECK(planes && planes->GetNumberOfTuples() == 1 && planes->GetTuple1(0) == 4);
  LACUNA_CHECK_NEAR(test.Reader->GetOutput()->GetScalarComponentAsDouble(2, 1, 4, 0),
    CTTruth({ -18.2, -22.7, -8 }), 1);

  LACUNA_CHECK_CONTAINS(
    test.GetNotes(), "1 of 9 planes, every 2 mm, are interpolated; 8 of 9 measured slices");
  LACUNA_CHECK_CONTAINS(test.Warnings,
    "1 of 9 measured slices are in the volume only as parts of interpolated planes: " +
      BaseName(test.Files[4]) + " at -7.4 mm");

  // positions rounded to a tenth of a millimetre are equal spacing
  CTTestSeries rounded;
  rounded.Step = { 0, 0, 0.1 };
  rounded.Places = { 0, 6, 13, 19, 25, 31, 38, 44, 50 };
  ReaderOf fine(rounded);
  fine.ExpectGood();
  LACUNA_CHECK_NEAR(fine.Reader->GetOutput()->GetSpacing()[2], 0.625, 0.003);
  LACUNA_CHECK_CONTAINS(fine.GetNotes(), "mm from equal spacing");
  fine.Reader->SetPositionTolerance(0.001);
  fine.ExpectError("not equally spaced");
}

// Thin slices at the base, thick ones above; one wide gap: every measured slice is in the volume.
void TestUnequalKeepsAll()
{
  for (const std::vector<double>& places : { std::vector<double>{ 0, 1, 2, 3, 4, 6.5, 9, 11.5 },
         std::vector<double>{ 0, 3, 6, 9, 12, 17, 20, 23 } })
  {
    CTTestSeries series;
    series.Places = places;
    series.Stored = [](int i, int j, int k) { return k == 7 ? 3000 + i : 100 * k + j; };
    ReaderOf test(series);
    test.ExpectError("the slices are not equally spaced");
    test.Reader->SetMissingSlices(vtkLacunaCTSeriesReader::Interpolate);
    test.ExpectGood();
    LACUNA_CHECK_THAT(test.Warnings.empty(), test.Warnings);
    LACUNA_CHECK_CONTAINS(test.GetNotes(), "8 of 8 measured slices are planes of their own");
    vtkImageData* image = test.Reader->GetOutput();
    const double spacing = image->GetSpacing()[2];
    LACUNA_CHECK_NEAR(spacing, places[1] == 1 ? 1 : 2, 1e-9);
    for (int k = 0; k < 8; ++k)
    {
      const int plane = static_cast<int>(std::lround(2 * places[k] / spacing));
      LACUNA_CHECK(plane <= image->GetExtent()[5]);
      LACUNA_CHECK(
        image->GetScalarComponentAsDouble(5, 7, plane, 0) == (k == 7 ? 3005 : 100 * k + 7));
    }
    LACUNA_CHECK(image->GetExtent()[5] == std::lround(2 * places[7] / spacing));
  }
}

void TestDuplicates()
{
  CTTestSeries series = Edited({});
  ReaderOf copied(series);
  std::filesystem::copy(copied.Files[2], copied.Folder + "/copy of IM.dcm");
  copied.ExpectGood();
  LACUNA_CHECK_CONTAINS(copied.Warnings, "1 slices are there twice with the same image");
  LACUNA_CHECK(copied.Reader->GetOutput()->GetDimensions()[2] == 6);

  // a second acquisition over the first
  ReaderOf test(Edited({ { 0x0020, 0x0012, "IS", "1", {} } }));
  CTTestSeries second = Edited({ { 0x0020, 0x0012, "IS", "2", {} } });
  second.Stored = [](int, int, int) { return 77; };
  second.Write(test.Folder + "/second");
  test.ExpectError("6 slices are there twice with different images: ");
  LACUNA_CHECK_CONTAINS(test.Errors, "set Acquisition to the number");
  LACUNA_CHECK_CONTAINS(test.GetSeriesList(), "12 images of 44 x 36, 2 acquisitions");
  test.Reader->SetAcquisition(2);
  test.ExpectGood();
  LACUNA_CHECK(test.Reader->GetOutput()->GetScalarComponentAsDouble(5, 5, 3, 0) == 77);
  test.Reader->SetAcquisition(3);
  test.ExpectError("no image of acquisition 3 (0020,0012); there are: 1 2");

  CTTestSeries sideways = Edited({ { 0x0020, 0x0032, "DS", "-19\\-24\\-10", { 3 } } });
  ReaderOf shifted(sideways);
  shifted.ExpectError("displaced sideways");
  LACUNA_CHECK_CONTAINS(shifted.Errors, BaseName(shifted.Files[3]) + " at -10 mm");
}

// A multi-frame file whose frames have one position in common.
void TestOnePosition()
{
  CTTestSeries series = Edited({});
  series.MultiFrame = true;
  series.Step = { 0, 0, 0 };
  ReaderOf test(series);
  test.ExpectError(
    "IM0001: has 6 frames (0028,0008), but one Image Position (Patient) (0020,0032)");
}

// The same slices, reconstructed with two kernels into one series.
void TestKernels()
{
  ReaderOf test(Edited({}));
  CTTestSeries sharp = Edited({ { 0x0018, 0x1210, "SH", "B70 s", {} } });
  sharp.Stored = [](int, int, int) { return 77; };
  const std::vector<std::string> files = sharp.Write(test.Folder + "/sharp");
  test.ExpectError("there are 2 CT series; set SeriesUID to one of these");
  const std::string name = "1.2.826.0.1.3680043.2.1125.1 kernel B70 s";
  LACUNA_CHECK_CONTAINS(
    test.GetSeriesList(), name + "  series 4, \"Letter F\", 6 images of 44 x 36");
  const auto getVoxel = [&]
  {
    test.ExpectGood();
    LACUNA_CHECK(test.Reader->GetOutput()->GetDimensions()[2] == 6);
    return test.Reader->GetOutput()->GetScalarComponentAsDouble(2, 1, 4, 0);
  };
  test.Reader->SetSeriesUID(name.c_str());
  LACUNA_CHECK(getVoxel() == 77);
  test.Reader->SetSeriesUID("1.2.826.0.1.3680043.2.1125.1 kernel H30s");
  LACUNA_CHECK_NEAR(getVoxel(), CTTruth({ -18.2, -22.7, -8 }), 1);
  test.Reader->SetSeriesUID("1.2.826.0.1.3680043.2.1125.1");
  test.ExpectError("has 2 convolution kernels (0018,1210)");
  // a file stands for its own kernel
  test.Reader->SetSeriesUID(nullptr);
  for (int k = 0; k < 6; ++k)
  {
    std::filesystem::rename(files[k], test.Folder + "/sharp" + std::to_string(k));
  }
  test.Reader->SetFileName((test.Folder + "/sharp2").c_str());
  LACUNA_CHECK(getVoxel() == 77);
  test.Reader->SetFileName(test.Files[2].c_str());
  LACUNA_CHECK_NEAR(getVoxel(), CTTruth({ -18.2, -22.7, -8 }), 1);
}

void TestStatedTilt()
{
  ReaderOf test(Edited({ { 0x0018, 0x1120, "DS", "15", {} } }));
  test.ExpectGood();
  LACUNA_CHECK_CONTAINS(test.Warnings, "Gantry/Detector Tilt (0018,1120) is 15 degrees");
}

void TestCompressedGarbage()
{
  ReaderOf unknown(Edited({}));
  for (const std::string& file : unknown.Files)
  {
    // the transfer syntax is in the first few hundred bytes
    std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
    std::string head(400, ' ');
    stream.read(head.data(), 400);
    const std::size_t place = head.find("1.2.840.10008.1.2.1");
    LACUNA_CHECK(place != std::string::npos);
    stream.seekp(static_cast<std::streamoff>(place + 18));
    stream.put('9');
  }
  unknown.ExpectError("do not fit its transfer syntax 1.2.840.10008.1.2.9");
}

// Files that lost preamble and meta information on their way, as from old archives.
void TestBare()
{
  CTTestSeries series = Edited({});
  series.TransferSyntax = "1.2.840.10008.1.2";
  ReaderOf test(series);
  for (const std::string& file : test.Files)
  {
    std::ifstream stream(file, std::ios::binary);
    const std::string bytes(std::istreambuf_iterator<char>(stream), {});
    const std::size_t begin = bytes.find(std::string("\x08\0\x05\0", 4)); // the first element
    LACUNA_CHECK(begin != std::string::npos);
    std::ofstream(file, std::ios::binary) << bytes.substr(begin);
  }
  LACUNA_CHECK(test.Reader->CanReadFile(test.Files[0].c_str()) == 1);
  test.ExpectGood();
  LACUNA_CHECK(test.Reader->GetOutput()->GetDimensions()[2] == 6);
  LACUNA_CHECK_NEAR(test.Reader->GetOutput()->GetScalarComponentAsDouble(2, 1, 4, 0),
    CTTruth({ -18.2, -22.7, -8 }), 1);
  LACUNA_CHECK_CONTAINS(test.GetNotes(), "6 files have no DICOM preamble");
}

void TestAbort()
{
  ReaderOf test{ CTTestSeries() };
  vtkNew<vtkCallbackCommand> stop;
  stop->SetCallback([](vtkObject* caller, unsigned long, void*, void*)
    { static_cast<vtkAlgorithm*>(caller)->SetAbortExecute(1); });
  test.Reader->UpdateInformation();
  const unsigned long tag = test.Reader->AddObserver(vtkCommand::ProgressEvent, stop);
  test.Reader->Update();
  LACUNA_CHECK(test.Errors.empty());
  LACUNA_CHECK(test.Reader->GetOutput()->GetNumberOfPoints() == 0);
  test.Reader->RemoveObserver(tag);
  test.Reader->SetAbortExecute(0);
  test.Reader->Modified();
  test.ExpectGood();
}
}

int TestCTSeriesReaderErrors(int, char*[])
{
  TestTags();
  TestDoubts();
  TestShownOnce();
  TestProperties();
  TestGapOfLeftOut();
  TestInformation();
  TestLeftOut();
  TestScout();
  TestSeries();
  TestFiles();
  TestTruncated();
  TestGaps();
  TestUnequal();
  TestUnequalKeepsAll();
  TestDuplicates();
  TestKernels();
  TestOnePosition();
  TestStatedTilt();
  TestCompressedGarbage();
  TestBare();
  TestAbort();
  return lacunaCheck::Result();
}
