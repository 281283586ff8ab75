// SPDX-License-Identifier: BSD-3-Clause
// Output, properties and requests of the reader.
#include "TrackedSliceReaderTesting.h"
#include "lacunaFieldData.h"
#include "lacunaProvenance.h"
#include "lacunaTrackedSlices.h"
#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkPointData.h"
#include "vtkStringArray.h"
#include "vtkTypeTraits.h"

#include <cmath>
#include <cstdlib>
#include <sstream>

namespace
{
void TestDefaults()
{
  vtkNew<vtkLacunaTrackedSliceReader> reader;
  LACUNA_CHECK(reader->GetNumberOfInputPorts() == 0);
  LACUNA_CHECK(reader->GetNumberOfOutputPorts() == 1);
  LACUNA_CHECK(!reader->GetFileName());
  LACUNA_CHECK(!reader->GetCalibrationFileName());
  LACUNA_CHECK(std::string(reader->GetImageFrame()) == "Image");
  LACUNA_CHECK(std::string(reader->GetReferenceFrame()) == "Reference");
  LACUNA_CHECK(reader->GetFrameRange()[0] == 0 && reader->GetFrameRange()[1] == -1);
  LACUNA_CHECK(reader->GetFrameStride() == 1);
  LACUNA_CHECK(reader->GetDropInvalidSlices());
  LACUNA_CHECK(!reader->GetKeepPatientIdentity());
  LACUNA_CHECK(reader->GetMemoryLimit() == 0);
  std::ostringstream text;
  reader->Print(text);
  for (const char* name :
    { "FileName", "CalibrationFileName", "ImageFrame", "ReferenceFrame", "FrameRange",
      "FrameStride", "DropInvalidSlices", "KeepPatientIdentity", "ReplayInTime", "MemoryLimit" })
  {
    LACUNA_CHECK_CONTAINS(text.str(), std::string(name) + ": ");
  }
}

// Every point of the output says where it comes from.
void CheckPixels(vtkImageData* output)
{
  int extent[6];
  output->GetExtent(extent);
  for (int k = extent[4]; k <= extent[5]; ++k)
  {
    const int frame =
      static_cast<int>(std::lround(output->GetOrigin()[2] + k * output->GetSpacing()[2]));
    for (int row = extent[2]; row <= extent[3]; ++row)
    {
      for (int column = extent[0]; column <= extent[1]; ++column)
      {
        LACUNA_CHECK(
          output->GetScalarComponentAsDouble(column, row, k, 0) == GetGrey(column, row, frame));
      }
    }
  }
}

void TestOutput()
{
  SequenceFile file = MakeSequence(6);
  file.Set("Device", "none");
  file.Set("StudyPatientName", "Doe");
  file.Set("OperatorsName", "Roe");
  file.Set("0010|0020", "1234");
  for (int i = 0; i < 6; ++i)
  {
    file.SetFrame(i, "FrameNumber", std::to_string(500 + 2 * i));
  }
  file.SetFrame(2, "Note", "here");
  file.SetFrame(2, "patientID", "1234");
  file.SetFrame(2, "SliceStatus", "0");
  file.SetFrame(4, "ProbeToTrackerTransformStatus", "MISSING");
  ReaderOf test(file.GetContent());
  test.Reader->Update();
  LACUNA_CHECK(test.Errors.empty() && test.Warnings.empty());
  LACUNA_CHECK(test.Reader->GetErrorCode() == 0);
  vtkImageData* output = test.Reader->GetOutput();
  const int* size = output->GetDimensions();
  LACUNA_CHECK(size[0] == 5 && size[1] == 4 && size[2] == 6);
  for (int axis = 0; axis < 3; ++axis)
  {
    LACUNA_CHECK(output->GetOrigin()[axis] == 0 && output->GetSpacing()[axis] == 1);
  }
  vtkDataArray* scalars = output->GetPointData()->GetScalars();
  LACUNA_CHECK(scalars && std::string(scalars->GetName()) == "Intensity");
  LACUNA_CHECK(scalars && scalars->GetDataType() == VTK_UNSIGNED_CHAR);
  CheckPixels(output);

  const lacuna::TrackedSlices slices(output); // throws when the contract is not met
  LACUNA_CHECK(slices.GetNumberOfSlices() == 6);
  const lacuna::Vec3 p = slices.GetImageToReference(2).Point({ 10, 20, 0 });
  LACUNA_CHECK(
    std::abs(p[0] + 76) < 1e-12 && std::abs(p[1] + 3) < 1e-12 && std::abs(p[2] - 35) < 1e-12);
  LACUNA_CHECK(slices.GetStatus(2) == lacuna::TrackedSlices::Valid);
  LACUNA_CHECK(slices.GetStatus(4) == lacuna::TrackedSlices::PoseInvalid);
  LACUNA_CHECK(std::isnan(slices.GetImageToReference(4)(0, 0)));
  LACUNA_CHECK(slices.GetTimestamp(5) == 15.25);
  vtkFieldData* fields = output->GetFieldData();
  LACUNA_CHECK(fields->GetArray("FrameNumber")->GetTuple1(3) == 506);
  LACUNA_CHECK(lacuna::FieldData::Get(output, "ProbeToTracker", 16, 6)->GetComponent(4, 3) == 4);
  LACUNA_CHECK(
    lacuna::FieldData::Get(output, "ReferenceToTracker", 16, 6)->GetComponent(0, 7) == 100);
  LACUNA_CHECK(lacuna::FieldData::Get(output, "ImageToProbe", 16, 1)->GetComponent(0, 11) == 5);
  auto* notes = vtkStringArray::SafeDownCast(fields->GetAbstractArray("Note"));
  LACUNA_CHECK(notes && notes->GetNumberOfValues() == 6 && notes->GetValue(2) == "here");
  LACUNA_CHECK(fields->GetAbstractArray("ProbeToTrackerTransformStatus"));
  auto* custom = vtkStringArray::SafeDownCast(fields->GetAbstractArray("Device"));
  LACUNA_CHECK(custom && custom->GetNumberOfValues() == 1 && custom->GetValue(0) == "none");
  const char* const identity[] = { "StudyPatientName", "OperatorsName", "0010|0020", "patientID" };
  for (const char* name : identity)
  {
    LACUNA_CHECK(!fields->GetAbstractArray(name));
  }

  const std::vector<std::string> steps = lacuna::Provenance::Get(output);
  LACUNA_CHECK(steps.size() == 1);
  LACUNA_CHECK_CONTAINS(steps.at(0), "FileName=sweep.igs.mha");
  LACUNA_CHECK_CONTAINS(steps.at(0), "FileSize=" + std::to_string(file.GetContent().size()));
  LACUNA_CHECK_CONTAINS(steps.at(0), "Chain=\"Image > Probe > Tracker > Reference\"");
  const std::string folder =
    std::filesystem::path(test.File.GetPath()).parent_path().filename().string();
  LACUNA_CHECK(steps.at(0).find(folder) == std::string::npos);

  test.Reader->KeepPatientIdentityOn();
  test.Reader->Update();
  for (const char* name : identity)
  {
    LACUNA_CHECK(test.Reader->GetOutput()->GetFieldData()->GetAbstractArray(name));
  }
}

// Only what is a matrix or a status is taken for one.
void TestTextsUnderNamesOfTransforms()
{
  SequenceFile file = MakeSequence(2);
  file.Set("PatientToTownTransform", "Doe");
  file.SetFrame(0, "PatientToTrackerTransform", "1 0 0 7 0 1 0 8 0 0 1 9 0 0 0 1");
  file.SetFrame(0, "PatientToTrackerTransformStatus", "OK");
  file.SetFrame(1, "PatientToRoomTransformStatus", "Doe");
  ReaderOf test(file.GetContent());
  for (const bool keep : { false, true })
  {
    test.Reader->SetKeepPatientIdentity(keep);
    test.Reader->Update();
    vtkFieldData* fields = test.Reader->GetOutput()->GetFieldData();
    LACUNA_CHECK(fields->GetAbstractArray("PatientToTracker"));
    LACUNA_CHECK(fields->GetAbstractArray("PatientToTrackerTransformStatus"));
    for (const char* name : { "PatientToTownTransform", "PatientToRoomTransformStatus" })
    {
      LACUNA_CHECK((fields->GetAbstractArray(name) != nullptr) == keep);
    }
  }
  LACUNA_CHECK_CONTAINS(test.Warnings, "PatientToTown of the header does not have 16");
  LACUNA_CHECK(test.Warnings.find("Doe") == std::string::npos);
}

// Lines of grey levels, as a scanner has them before it makes a picture of them.
void TestScanLines()
{
  SequenceFile file = MakeSequence(3);
  file.Set("UltrasoundImageOrientation", "FM");
  ReaderOf test(file.GetContent(), false);
  test.Reader->Update();
  LACUNA_CHECK(test.Errors.empty());
  vtkImageData* output = test.Reader->GetOutput();
  CheckPixels(output);
  const auto text = [&](const char* name)
  {
    return std::string(
      vtkStringArray::SafeDownCast(output->GetFieldData()->GetAbstractArray(name))->GetValue(0));
  };
  LACUNA_CHECK(text("UltrasoundImageOrientation") == "FM");
  LACUNA_CHECK(text("UltrasoundImageType") == "BRIGHTNESS");
}

// What contradicts the calibration is flagged, and said on the way out.
void TestContradictions()
{
  SequenceFile file = MakeSequence(5);
  for (int i = 0; i < 5; ++i)
  {
    file.SetFrame(i, "ElementSpacing", i < 3 ? "0.1 0.2 1" : "0.15 0.3 1");
  }
  ReaderOf test(file.GetContent());
  test.Reader->Update();
  LACUNA_CHECK_CONTAINS(test.Warnings, "in frames 3, 4");
  const lacuna::TrackedSlices slices(test.Reader->GetOutput());
  LACUNA_CHECK(slices.GetStatus(2) == 0 && slices.GetStatus(3) == 1 && slices.GetStatus(4) == 1);
  LACUNA_CHECK(!slices.GetImageToReference(3).IsFinite());
}

void TestTypes()
{
  const std::pair<const char*, int> types[] = { { "MET_CHAR", VTK_SIGNED_CHAR },
    { "MET_UCHAR", VTK_UNSIGNED_CHAR }, { "MET_SHORT", VTK_SHORT },
    { "MET_USHORT", VTK_UNSIGNED_SHORT }, { "MET_INT", VTK_INT }, { "MET_UINT", VTK_UNSIGNED_INT },
    { "MET_LONG_LONG", vtkTypeTraits<std::int64_t>::VTKTypeID() },
    { "MET_ULONG_LONG", vtkTypeTraits<std::uint64_t>::VTKTypeID() }, { "MET_FLOAT", VTK_FLOAT },
    { "MET_DOUBLE", VTK_DOUBLE } };
  for (const auto& [name, type] : types)
  {
    SequenceFile file = MakeSequence();
    file.Set("ElementType", name);
    file.Pixels.assign(60 * 8, '\0');
    ReaderOf test(file.GetContent());
    test.Reader->Update();
    LACUNA_CHECK(test.Errors.empty());
    LACUNA_CHECK(test.Reader->GetOutput()->GetScalarType() == type);
  }
}

void TestRequests()
{
  ReaderOf test(MakeSequence(20).GetContent());
  vtkLacunaTrackedSliceReader* reader = test.Reader;
  const int extent[6] = { 1, 3, 2, 3, 5, 8 };
  reader->UpdateExtent(extent);
  vtkImageData* output = reader->GetOutput();
  int got[6];
  output->GetExtent(got);
  LACUNA_CHECK(std::equal(extent, extent + 6, got));
  CheckPixels(output);
  LACUNA_CHECK(output->GetFieldData()->GetArray("ImageToReference")->GetNumberOfTuples() == 20);

  reader->SetFrameRange(3, 15);
  reader->SetFrameStride(4);
  reader->UpdateWholeExtent();
  output->GetExtent(got);
  LACUNA_CHECK(got[4] == 0 && got[5] == 3); // 3, 7, 11, 15
  LACUNA_CHECK(output->GetOrigin()[2] == 3 && output->GetSpacing()[2] == 4);
  CheckPixels(output);
  const lacuna::TrackedSlices slices(output);
  LACUNA_CHECK(slices.GetNumberOfSlices() == 20);
  LACUNA_CHECK(slices.GetSliceNumber(2) == 11);
  const int second[6] = { 0, 4, 0, 3, 1, 1 };
  reader->UpdateExtent(second);
  CheckPixels(output);

  LACUNA_CHECK(output->GetFieldData()->GetArray("SliceStatus")->GetTuple1(19) == 0);

  reader->SetFrameRange(19, -1);
  reader->SetFrameStride(1);
  reader->UpdateWholeExtent();
  LACUNA_CHECK(output->GetDimensions()[2] == 1 && output->GetOrigin()[2] == 19);
  CheckPixels(output);

  reader->SetReferenceFrame("Tracker");
  reader->UpdateWholeExtent();
  const lacuna::TrackedSlices inTracker(output);
  LACUNA_CHECK(inTracker.GetImageToReference(7).Point({ 0, 0, 0 })[0] == 7);
  LACUNA_CHECK(test.Errors.empty() && test.Warnings.empty());
}

void TestDropInvalidSlices()
{
  SequenceFile file = MakeSequence(4);
  file.SetFrame(1, "ReferenceToTrackerTransformStatus", "OUT_OF_VIEW");
  file.SetFrame(2, "ImageStatus", "INVALID");
  file.SetFrame(3, "ProbeToTrackerTransform", "nan");
  ReaderOf test(file.GetContent());
  test.Reader->Update();
  const lacuna::TrackedSlices flagged(test.Reader->GetOutput());
  LACUNA_CHECK(flagged.GetStatus(0) == 0 && flagged.GetStatus(1) == 1);
  LACUNA_CHECK(flagged.GetStatus(2) == 2 && flagged.GetStatus(3) == 1);
  LACUNA_CHECK(test.Reader->GetOutput()->GetDimensions()[2] == 4); // z stays the slice number
  LACUNA_CHECK_CONTAINS(test.Warnings, "has 1 numbers, not 16 in frame 3");
  test.Reader->DropInvalidSlicesOff();
  test.Reader->Update();
  const lacuna::TrackedSlices trusted(test.Reader->GetOutput());
  LACUNA_CHECK(trusted.GetStatus(1) == 0 && trusted.GetStatus(2) == 0 && trusted.GetStatus(3) == 1);
  LACUNA_CHECK(trusted.GetImageToReference(1).IsFinite());
}

void TestUncalibrated()
{
  ReaderOf test(MakeSequence().GetContent(), false);
  test.Reader->Update();
  LACUNA_CHECK(test.Errors.empty());
  LACUNA_CHECK_CONTAINS(test.Warnings, "CalibrationFileName");
  vtkImageData* output = test.Reader->GetOutput();
  CheckPixels(output);
  LACUNA_CHECK(!output->GetFieldData()->GetArray("ImageToReference"));
  LACUNA_CHECK(output->GetFieldData()->GetArray("SliceStatus")->GetNumberOfTuples() == 3);
}

void TestAbort()
{
  ReaderOf test(MakeSequence(400).GetContent());
  vtkNew<vtkCallbackCommand> stop;
  stop->SetCallback(
    [](vtkObject* caller, unsigned long, void*, void*)
    {
      auto* algorithm = static_cast<vtkAlgorithm*>(caller);
      algorithm->SetAbortExecute(algorithm->GetProgress() > 0.5 ? 1 : 0);
    });
  test.Reader->AddObserver(vtkCommand::ProgressEvent, stop);
  test.Reader->Update();
  LACUNA_CHECK(test.Errors.empty());
  LACUNA_CHECK(test.Reader->GetOutput()->GetNumberOfPoints() == 0);
}

// What passes arrays on compares their names: of many fields, some become arrays.
void TestManyFields()
{
  SequenceFile file = MakeSequence(2);
  std::string fields;
  for (int i = 0; i < 20000; ++i)
  {
    fields += "C" + std::to_string(i) + " = v\n";
  }
  std::string content = file.GetContent();
  content.insert(content.find('\n') + 1, fields);
  ReaderOf test(content);
  test.Reader->Update();
  LACUNA_CHECK_THAT(test.Errors.empty(), test.Errors);
  LACUNA_CHECK(test.Reader->GetOutput()->GetFieldData()->GetNumberOfArrays() < 1100);
  LACUNA_CHECK(test.Reader->GetOutput()->GetFieldData()->GetAbstractArray("C900"));
  LACUNA_CHECK_CONTAINS(
    test.Warnings, " fields of its own; the first 1000 are kept. Left out are C");
}
}

int TestTrackedSliceReader(int, char*[])
{
  TestDefaults();
  TestOutput();
  TestTextsUnderNamesOfTransforms();
  TestTypes();
  TestRequests();
  TestDropInvalidSlices();
  TestUncalibrated();
  TestScanLines();
  TestContradictions();
  TestAbort();
  TestManyFields();
  return lacunaCheck::Result();
}
