// SPDX-License-Identifier: BSD-3-Clause
// Bad input ends in an error that says what is wrong, an empty output and an error code.
#include "TrackedSliceReaderTesting.h"
#include "vtkDataArray.h"
#include "vtkErrorCode.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkPointData.h"

namespace
{
void ExpectError(ReaderOf& test, unsigned long code, const std::string& part)
{
  test.Forget();
  test.Reader->Update();
  LACUNA_CHECK_CONTAINS(test.Errors, part);
  LACUNA_CHECK(test.Reader->GetErrorCode() == code);
  LACUNA_CHECK(test.Reader->GetOutput()->GetNumberOfPoints() == 0);
}

void ExpectFormatError(const std::string& content, const std::string& part)
{
  ReaderOf test(content);
  ExpectError(test, vtkErrorCode::FileFormatError, part);
  LACUNA_CHECK_CONTAINS(test.Errors, test.File.GetPath());
}

void TestFiles()
{
  ExpectFormatError("", "is empty");
  ExpectFormatError("no header", "not a MetaImage");
  const std::string good = MakeSequence().GetContent();
  ExpectFormatError(good.substr(0, 300), "cut off");
  SequenceFile size = MakeSequence();
  size.Set("DimSize", "5 0 3");
  ExpectFormatError(size.GetContent(), "DimSize is 5 0 3");
  size.Set("DimSize", "50000 50000 3");
  ExpectFormatError(size.GetContent(), "60 bytes of pixels");
  SequenceFile plain = MakeSequence(0);
  plain.Set("DimSize", "5 4 3");
  ExpectFormatError(plain.GetContent(), "ordinary image");

  ReaderOf missing(good);
  missing.Reader->SetFileName("/nonexistent/sweep.mha");
  ExpectError(missing, vtkErrorCode::FileNotFoundError, "/nonexistent/sweep.mha: there is no such");
  missing.Reader->SetFileName(nullptr);
  ExpectError(missing, vtkErrorCode::NoFileNameError, "FileName is not set");
  missing.Reader->SetFileName(missing.File.GetPath().c_str());
  missing.Reader->SetFrameStride(0);
  ExpectError(missing, vtkErrorCode::FileFormatError, "FrameStride is 0; it must be 1 or more");
  missing.Reader->SetFrameStride(1);
  missing.Reader->SetMemoryLimit(-1);
  ExpectError(
    missing, vtkErrorCode::FileFormatError, "MemoryLimit is -1 MiB; it must be 0 MiB or more");
  missing.Reader->SetMemoryLimit(0);
  missing.Forget();
  missing.Reader->Update(); // recovers
  LACUNA_CHECK(missing.Errors.empty());
  LACUNA_CHECK(missing.Reader->GetOutput()->GetNumberOfPoints() == 60);
}

void TestChains()
{
  ReaderOf test(MakeSequence().GetContent());
  test.Reader->SetReferenceFrame("Table");
  ExpectError(test, vtkErrorCode::FileFormatError,
    "'Table'. From 'Image' these frames can be reached: Image, Probe, Reference, Tracker");
  test.Reader->SetReferenceFrame(nullptr);
  ExpectError(test, vtkErrorCode::FileFormatError, "reference frame ''");
  test.Reader->SetReferenceFrame("Reference");
  test.Reader->SetImageFrame("Photo");
  ExpectError(test, vtkErrorCode::FileFormatError, "image frame 'Photo'");
  test.Reader->SetImageFrame("Image");
  test.File.WriteBeside("calibration.xml", "<a>");
  test.Reader->Modified();
  ExpectError(test, vtkErrorCode::FileFormatError, "calibration.xml: is not well-formed XML");
  test.Reader->SetCalibrationFileName("/nonexistent.xml");
  ExpectError(test, vtkErrorCode::FileFormatError,
    "the calibration file '/nonexistent.xml': there is no such file");
  const std::string name = test.GetCalibrationName();
  test.File.WriteBeside("calibration.xml", MakeCalibration());
  test.Reader->SetCalibrationFileName(name.c_str());
  test.Forget();
  test.Reader->Update();
  LACUNA_CHECK(test.Errors.empty() && test.Warnings.empty());
}

void TestFrameRange()
{
  ReaderOf test(MakeSequence(10).GetContent());
  const int ranges[][2] = { { -1, 5 }, { 3, 2 }, { 0, 10 }, { 10, -1 }, { 0, -2 } };
  for (const auto& range : ranges)
  {
    test.Reader->SetFrameRange(range[0], range[1]);
    ExpectError(test, vtkErrorCode::FileFormatError, "the pixels of slices 0 to 9");
  }
}

void TestMemoryLimit()
{
  SequenceFile file = MakeSequence(3, 1024, 1536);
  ReaderOf test(file.GetContent());
  test.Reader->SetMemoryLimit(1);
  ExpectError(test, vtkErrorCode::FileFormatError,
    "one slice of 1024 x 1536 pixels takes 1572864 bytes (0.00146 GiB), but MemoryLimit allows "
    "1048576 bytes");
  test.Reader->SetMemoryLimit(2); // more slices are previewed: TestTrackedSlicePreview
  test.Forget();
  test.Reader->Update();
  LACUNA_CHECK(test.Errors.empty());
  LACUNA_CHECK(test.Reader->GetOutput()->GetDimensions()[2] == 1);
}

void TestCutOff()
{
  const std::string content = MakeSequence(5).GetContent();
  ReaderOf test(content.substr(0, content.size() - 21)); // one slice and one byte
  test.Reader->Update();
  LACUNA_CHECK(test.Errors.empty());
  LACUNA_CHECK_CONTAINS(test.Warnings, "cut off: 3 of the 5 frames are there");
  vtkImageData* output = test.Reader->GetOutput();
  LACUNA_CHECK(output->GetDimensions()[2] == 3);
  vtkDataArray* status = output->GetFieldData()->GetArray("SliceStatus");
  LACUNA_CHECK(status->GetNumberOfTuples() == 5); // the sweep had five
  LACUNA_CHECK(status->GetTuple1(2) == 0 && status->GetTuple1(3) == 2 && status->GetTuple1(4) == 2);
  test.Reader->SetFrameRange(1, 4);
  test.Reader->Update();
  LACUNA_CHECK(output->GetDimensions()[2] == 2);
  test.Reader->SetFrameRange(3, 4);
  ExpectError(test, vtkErrorCode::FileFormatError, "the pixels of slices 0 to 2");
}

void TestCorrupt()
{
  SequenceFile file = MakeSequence();
  file.Set("CompressedData", "True");
  file.Set("CompressedDataSize", "60");
  ExpectFormatError(file.GetContent(), "corrupt in frame 0");
}

void TestCanReadFile()
{
  vtkNew<vtkLacunaTrackedSliceReader> reader;
  LACUNA_CHECK(!reader->CanReadFile(nullptr));
  LACUNA_CHECK(!reader->CanReadFile(""));
  LACUNA_CHECK(!reader->CanReadFile("/nonexistent.mha"));
  const TemporaryFile tracked("sweep.mha", MakeSequence().GetContent());
  LACUNA_CHECK(reader->CanReadFile(tracked.GetPath().c_str()));
  SequenceFile ordinary = MakeSequence(0);
  ordinary.Set("DimSize", "5 4 3");
  const TemporaryFile ct("ct.mha", ordinary.GetContent() + std::string(60, 'x'));
  LACUNA_CHECK(!reader->CanReadFile(ct.GetPath().c_str()));
}
}

int TestTrackedSliceReaderErrors(int, char*[])
{
  TestFiles();
  TestChains();
  TestFrameRange();
  TestMemoryLimit();
  TestCutOff();
  TestCorrupt();
  TestCanReadFile();
  return lacunaCheck::Result();
}
