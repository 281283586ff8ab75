// SPDX-License-Identifier: BSD-3-Clause
// What was read comes back.
#include "NrrdFile.h"
#include "TrackedSliceReaderTesting.h"
#include "lacunaFieldData.h"
#include "lacunaProvenance.h"
#include "lacunaTrackedSlices.h"
#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkErrorCode.h"
#include "vtkExtractVOI.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkIntArray.h"
#include "vtkLacunaTrackedSliceWriter.h"
#include "vtkPointData.h"
#include "vtkStringArray.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

namespace
{
const char* const Names[] = { "copy.igs.mha", "copy.mhd", "copy.nrrd", "copy.nhdr" };

/// A sweep with everything that a file can have.
SequenceFile MakeRich()
{
  SequenceFile file = MakeSequence(6);
  file.LineEnd = "  \r\n";
  file.Set("Remarks", "none");
  file.Set("Remark", std::string(3000, 'r') + " = longer than PLUS can read");
  for (int i = 0; i < 6; ++i)
  {
    file.SetFrame(i, "FrameNumber", std::to_string(500 + 2 * i));
    file.SetFrame(i, "UnfilteredTimestamp", std::to_string(10 + i) + ".123456789");
    file.SetFrame(i, "StylusToTrackerTransform",
      "0.123456789012345 -1.5e-005 0 1 0 1 0 0 0 0 1 " + std::to_string(i) + " 0 0 0 1");
    file.SetFrame(i, "StylusToTrackerTransformStatus", i == 4 ? "SWITCH2_IS_ON" : "OK");
  }
  file.SetFrame(1, "ReferenceToTrackerTransformStatus", "OUT_OF_VIEW");
  file.SetFrame(2, "ImageStatus", "INVALID");
  file.SetFrame(3, "ProbeToTrackerTransformStatus", "SOMETHING_NEW");
  file.RemoveFrame(4, "ProbeToTrackerTransform");
  file.RemoveFrame(4, "ProbeToTrackerTransformStatus");
  file.RemoveFrame(5, "Timestamp");
  file.SetFrame(5, "Note", "only here, = with a sign and a \\backslash\\n");
  return file;
}

/// As PLUS leaves a crop that begins at column 12 and row 6.
SequenceFile MakeCropped(int frames)
{
  SequenceFile file = MakeSequence(frames);
  for (int i = 0; i < frames; ++i)
  {
    file.SetFrame(i, "ImageToCroppedImageTransform", "1 0 0 -12 0 1 0 -6 0 0 1 0 0 0 0 1");
    file.SetFrame(i, "ImageToCroppedImageTransformStatus", "OK");
    file.SetFrame(i, "ElementSpacing", "0.1 0.2 0.1");
  }
  return file;
}

struct WriterOf
{
  vtkNew<vtkLacunaTrackedSliceWriter> Writer;
  vtkNew<lacunaCheck::Messages> Messages;
  std::string& Errors = Messages->Errors;
  std::string& Warnings = Messages->Warnings;

  WriterOf(vtkAlgorithmOutput* input, const std::string& path)
  {
    this->Writer->SetInputConnection(input);
    this->Writer->SetFileName(path.c_str());
    this->Messages->Watch(this->Writer);
  }
  explicit WriterOf(vtkImageData* input, const std::string& path)
  {
    this->Writer->SetInputData(input);
    this->Writer->SetFileName(path.c_str());
    this->Messages->Watch(this->Writer);
  }
};

std::string Beside(const ReaderOf& test, const std::string& name)
{
  return (std::filesystem::path(test.File.GetPath()).parent_path() / name).string();
}

/// The values of an array as text, so that all kinds can be compared.
std::string Describe(vtkAbstractArray* array)
{
  std::ostringstream text;
  text.precision(17);
  text << array->GetNumberOfTuples() << " x " << array->GetNumberOfComponents() << ":";
  for (vtkIdType i = 0; i < array->GetNumberOfValues(); ++i)
  {
    const vtkVariant value = array->GetVariantValue(i);
    text << "|";
    if (value.IsString())
    {
      text << value.ToString();
    }
    else
    {
      text << value.ToDouble();
    }
  }
  return text.str();
}

void CheckSame(
  vtkImageData* a, vtkImageData* b, const std::set<std::string>& added, const std::string& what)
{
  LACUNA_CHECK(std::equal(a->GetExtent(), a->GetExtent() + 6, b->GetExtent()));
  LACUNA_CHECK(
    Describe(a->GetPointData()->GetScalars()) == Describe(b->GetPointData()->GetScalars()));
  LACUNA_CHECK(a->GetScalarType() == b->GetScalarType());
  for (int i = 0; i < a->GetFieldData()->GetNumberOfArrays(); ++i)
  {
    const char* name = a->GetFieldData()->GetArrayName(i);
    vtkAbstractArray* other = b->GetFieldData()->GetAbstractArray(name);
    if (!other)
    {
      lacunaCheck::Fail(__FILE__, __LINE__, what + ": lost " + name);
    }
    else if (std::string(name) != "Provenance" &&
      Describe(a->GetFieldData()->GetAbstractArray(i)) != Describe(other))
    {
      lacunaCheck::Fail(__FILE__, __LINE__,
        what + ": " + name + " was " + Describe(a->GetFieldData()->GetAbstractArray(i)) + " is " +
          Describe(other));
    }
  }
  for (int i = 0; i < b->GetFieldData()->GetNumberOfArrays(); ++i)
  {
    const char* name = b->GetFieldData()->GetArrayName(i);
    if (!a->GetFieldData()->GetAbstractArray(name) && added.count(name) == 0)
    {
      lacunaCheck::Fail(__FILE__, __LINE__, what + ": added " + name);
    }
  }
}

void TestDefaults()
{
  vtkNew<vtkLacunaTrackedSliceWriter> writer;
  LACUNA_CHECK(!writer->GetFileName());
  LACUNA_CHECK(writer->GetCompressionLevel() == 1);
  LACUNA_CHECK(writer->GetFileSize() == 0);
  LACUNA_CHECK(!writer->GetKeepPatientIdentity());
  std::ostringstream text;
  writer->Print(text);
  for (const char* name : { "FileName", "CompressionLevel", "KeepPatientIdentity", "FileSize" })
  {
    LACUNA_CHECK_CONTAINS(text.str(), std::string(name) + ": ");
  }
}

void TestRoundTrip(const std::string& content, const std::set<std::string>& added, bool drop)
{
  ReaderOf test(content);
  test.Reader->SetDropInvalidSlices(drop);
  test.Reader->Update();
  LACUNA_CHECK(test.Errors.empty());
  for (const char* name : Names)
  {
    for (const int level : { 0, 6 })
    {
      const std::string path = Beside(test, name);
      WriterOf writer(test.Reader->GetOutputPort(), path);
      writer.Writer->SetCompressionLevel(level);
      LACUNA_CHECK(writer.Writer->Write() == 1);
      LACUNA_CHECK(writer.Errors.empty());
      // without a calibration file, since the file tells Image to Probe itself
      ReaderOf copy(ReadAll(path), false);
      copy.Reader->SetFileName(path.c_str());
      copy.Reader->SetDropInvalidSlices(drop);
      copy.Reader->Update();
      LACUNA_CHECK(copy.Errors.empty());
      CheckSame(test.Reader->GetOutput(), copy.Reader->GetOutput(), added, name);
      // and with it, without a word about a contradiction
      copy.Reader->SetCalibrationFileName(test.GetCalibrationName().c_str());
      copy.Forget();
      copy.Reader->Update();
      LACUNA_CHECK(copy.Warnings.find("replaced") == std::string::npos);
      CheckSame(test.Reader->GetOutput(), copy.Reader->GetOutput(), added, name);
      // a copy of the copy adds nothing
      const std::string second = Beside(test, "second.mha");
      WriterOf again(copy.Reader->GetOutputPort(), second);
      LACUNA_CHECK(again.Writer->Write() == 1);
      ReaderOf twice(ReadAll(second), false);
      twice.Reader->SetDropInvalidSlices(drop);
      twice.Reader->Update();
      CheckSame(copy.Reader->GetOutput(), twice.Reader->GetOutput(), {}, "second copy");
      const auto steps = lacuna::Provenance::Get(twice.Reader->GetOutput());
      LACUNA_CHECK(
        steps.size() == 3 && steps[0] == lacuna::Provenance::Get(test.Reader->GetOutput())[0]);
    }
  }
}

void TestEverythingComesBack()
{
  const std::set<std::string> added = { "ImageToProbeTransform", "ImageToProbeTransformStatus" };
  TestRoundTrip(MakeSequence(3).GetContent(), added, true);
  for (const bool drop : { true, false })
  {
    TestRoundTrip(MakeRich().GetContent(), added, drop);
  }
  SequenceFile single = MakeSequence(1);
  TestRoundTrip(single.GetContent(), added, true);
  SequenceFile lines = MakeSequence(2);
  lines.Set("UltrasoundImageOrientation", "NU");
  lines.Set("UltrasoundImageType", "RF_REAL");
  lines.Set("ElementType", "MET_SHORT");
  lines.Pixels += lines.Pixels;
  TestRoundTrip(lines.GetContent(), added, true);
  SequenceFile mirrored = MakeSequence(2);
  mirrored.Set("UltrasoundImageOrientation", "UN");
  TestRoundTrip(mirrored.GetContent(), added, true);
  TestRoundTrip(MakeNrrd(4).GetContent(), added, true);
  SequenceFile poses = MakeSequence(3);
  poses.Set("DimSize", "0 0 0");
  for (int i = 0; i < 3; ++i)
  {
    poses.RemoveFrame(i, "ImageStatus");
  }
  TestRoundTrip(poses.GetContent(), added, true);
  SequenceFile scan = MakeSequence(2); // lines of grey levels
  scan.Set("UltrasoundImageOrientation", "NM");
  TestRoundTrip(scan.GetContent(), added, true);
  TestRoundTrip(MakeCropped(3).GetContent(), added, true);
  SequenceFile header = MakeSequence(3);
  header.Set("StylusToTrackerTransform", "1 0 0 7 0 1 0 8 0 0 1 9 0 0 0 1");
  header.Set("ElementSpacing", "0.1 0.2 1");
  std::set<std::string> more = added;
  more.insert("StylusToTrackerTransformStatus");
  TestRoundTrip(header.GetContent(), more, true);
}

void TestWarnings()
{
  ReaderOf test(MakeRich().GetContent());
  test.Reader->Update();
  vtkImageData* stack = test.Reader->GetOutput();
  vtkNew<vtkDoubleArray> gate; // numbers of the user's
  gate->SetName("Gate");
  gate->SetNumberOfComponents(2);
  for (int i = 0; i < 6; ++i)
  {
    gate->InsertNextTuple2(0.1 * i, i);
  }
  stack->GetFieldData()->AddArray(gate);
  vtkNew<vtkIntArray> odd;
  odd->SetName("Odd");
  odd->SetNumberOfValues(4);
  stack->GetFieldData()->AddArray(odd);
  vtkNew<vtkStringArray> patient;
  patient->SetName("StudyPatientName");
  patient->InsertNextValue("Doe");
  stack->GetFieldData()->AddArray(patient);
  vtkNew<vtkStringArray> town; // is no transform
  town->SetName("PatientToTownTransform");
  town->InsertNextValue("Doe");
  stack->GetFieldData()->AddArray(town);
  vtkNew<vtkStringArray> lines;
  lines->SetName("Lines");
  lines->InsertNextValue("one\ntwo");
  stack->GetFieldData()->AddArray(lines);
  WriterOf writer(stack, Beside(test, "copy.mha"));
  LACUNA_CHECK(writer.Writer->Write() == 1);
  LACUNA_CHECK_CONTAINS(writer.Warnings, "'Odd' is not written: it has 4 tuples");
  LACUNA_CHECK_CONTAINS(
    writer.Warnings, "'StudyPatientName' is not written: it may identify the patient");
  LACUNA_CHECK_CONTAINS(writer.Warnings, "'PatientToTownTransform' is not written: it may");
  LACUNA_CHECK_CONTAINS(writer.Warnings, "'Lines' is not written: its text has a line break");
  LACUNA_CHECK_CONTAINS(
    writer.Warnings, "longer than 1000 characters; PLUS would cut them: Remark");
  const std::string text = ReadAll(Beside(test, "copy.mha"));
  LACUNA_CHECK_CONTAINS(text, "\nSeq_Frame0003_Gate = 0.30000000000000004 3\n");
  LACUNA_CHECK(text.find("Doe") == std::string::npos);
  LACUNA_CHECK(text.find("Seq_Frame0005_Timestamp") == std::string::npos);
  LACUNA_CHECK(writer.Writer->GetFileSize() == static_cast<vtkTypeInt64>(text.size()));
  WriterOf nrrd(stack, Beside(test, "copy.nrrd"));
  LACUNA_CHECK(nrrd.Writer->Write() == 1);
  LACUNA_CHECK_CONTAINS(ReadAll(Beside(test, "copy.nrrd")), "\nLines:=one\\ntwo\n");
  LACUNA_CHECK(ReadAll(Beside(test, "copy.nrrd")).find("Doe") == std::string::npos);
  nrrd.Writer->KeepPatientIdentityOn();
  LACUNA_CHECK(nrrd.Writer->Write() == 1);
  LACUNA_CHECK_CONTAINS(ReadAll(Beside(test, "copy.nrrd")), "\nStudyPatientName:=Doe\n");
}

// A frame with "Patient" in its name is no patient's name: its transforms are written.
void TestPatientsFrame()
{
  SequenceFile file = MakeSequence(2);
  for (int i = 0; i < 2; ++i)
  {
    file.SetFrame(i, "PatientToReferenceTransform", "1 0 0 7 0 1 0 8 0 0 1 9 0 0 0 1");
    file.SetFrame(i, "PatientToReferenceTransformStatus", "OK");
  }
  ReaderOf test(file.GetContent());
  test.Reader->SetReferenceFrame("Patient");
  test.Reader->Update();
  const std::string path = Beside(test, "copy.mha");
  WriterOf writer(test.Reader->GetOutputPort(), path);
  LACUNA_CHECK(writer.Writer->Write() == 1);
  LACUNA_CHECK(writer.Warnings.empty());
  ReaderOf copy(ReadAll(path), false);
  copy.Reader->SetReferenceFrame("Patient");
  copy.Reader->Update();
  const auto first = [](ReaderOf& reader)
  {
    return lacuna::TrackedSlices(reader.Reader->GetOutput())
      .GetImageToReference(1)
      .Point({ 1, 2, 0 });
  };
  LACUNA_CHECK(Norm(first(test) - first(copy)) < 1e-12);
}

// Parts of what PLUS has cropped, resampled or not, lie where they lie, and another calibration of
// the whole picture takes the place of the first.
void TestPartsOfCropped()
{
  ReaderOf test(MakeCropped(4).GetContent());
  test.Reader->Update();
  LACUNA_CHECK(test.Warnings.empty());
  const lacuna::TrackedSlices whole(test.Reader->GetOutput());
  vtkNew<vtkExtractVOI> part;
  part->SetInputConnection(test.Reader->GetOutputPort());
  part->SetVOI(1, 3, 1, 3, 0, 3);
  for (const int step : { 1, 2 })
  {
    part->SetSampleRate(step, 1, 1);
    const std::string path = Beside(test, "part.mha");
    WriterOf writer(part->GetOutputPort(), path);
    LACUNA_CHECK(writer.Writer->Write() == 1);
    LACUNA_CHECK(writer.Warnings.empty());
    LACUNA_CHECK_CONTAINS(
      ReadAll(path), step == 1 ? "_ElementSpacing = 0.1 0.2 0.1\n" : "_ElementSpacing = 0.2 0.2\n");
    ReaderOf copy(ReadAll(path), false);
    copy.Reader->Update();
    LACUNA_CHECK(copy.Errors.empty() && copy.Warnings.empty());
    const lacuna::TrackedSlices slices(copy.Reader->GetOutput());
    const lacuna::Vec3 there = whole.GetImageToReference(3).Point({ 3, 2, 0 });
    LACUNA_CHECK(slices.GetStatus(3) == 0);
    LACUNA_CHECK(Norm(slices.GetImageToReference(3).Point({ 2. / step, 1, 0 }) - there) < 1e-12);
    // one with pixels of the same size, 4 mm further along z of the probe
    copy.File.WriteBeside("other.xml", MakeCalibration("0.1 0 0 0 0 0.2 0 0 0 0 0.1 9 0 0 0 1"));
    copy.Reader->SetCalibrationFileName(Beside(copy, "other.xml").c_str());
    copy.Reader->Update();
    const lacuna::TrackedSlices moved(copy.Reader->GetOutput());
    const lacuna::Vec3 off = moved.GetImageToReference(3).Point({ 2. / step, 1, 0 }) - there;
    LACUNA_CHECK(Norm(off - lacuna::Vec3{ 0, 0, 4 }) < 1e-12);
  }
}

// Poses that are not those of the transforms, and flags.
void TestCorrectedPoses()
{
  ReaderOf test(MakeSequence(4).GetContent());
  test.Reader->Update();
  vtkNew<vtkImageData> stack;
  stack->DeepCopy(test.Reader->GetOutput());
  const std::string path = Beside(test, "copy.mha");
  vtkDataArray* poses = stack->GetFieldData()->GetArray("ImageToReference");
  vtkDataArray* status = stack->GetFieldData()->GetArray("SliceStatus");
  poses->SetComponent(2, 3, 1234.5);
  poses->SetComponent(3, 0, std::nan(""));
  status->SetTuple1(3, 1);
  status->SetTuple1(1, 4 + 8 + 2);
  status->SetTuple1(0, 64); // a flag of the future
  WriterOf writer(stack, path);
  LACUNA_CHECK(writer.Writer->Write() == 1);
  ReaderOf copy(ReadAll(path)); // with the calibration file
  copy.Reader->Update();
  LACUNA_CHECK_CONTAINS(copy.Warnings, "calibration file is not used");
  const lacuna::TrackedSlices slices(copy.Reader->GetOutput());
  LACUNA_CHECK(slices.GetImageToReference(2)(0, 3) == 1234.5);
  LACUNA_CHECK(slices.GetStatus(0) == 64 && slices.GetStatus(1) == 14 && slices.GetStatus(3) == 1);
  LACUNA_CHECK(
    lacuna::FieldData::Get(copy.Reader->GetOutput(), "ProbeToTracker", 16, 4)->GetComponent(2, 3) ==
    2); // as measured

  // a stack that has poses only, in a frame of another name
  for (const char* name : { "ProbeToTracker", "ReferenceToTracker", "ImageToProbe" })
  {
    stack->GetFieldData()->RemoveArray(name);
  }
  vtkStringArray::SafeDownCast(stack->GetFieldData()->GetAbstractArray("ImageToReferenceFrames"))
    ->SetValue(1, "Table");
  WriterOf bare(stack, path);
  LACUNA_CHECK(bare.Writer->Write() == 1);
  ReaderOf other(ReadAll(path), false);
  other.Reader->SetReferenceFrame("Table");
  other.Reader->Update();
  const lacuna::TrackedSlices onTable(other.Reader->GetOutput());
  LACUNA_CHECK(onTable.GetImageToReference(2)(0, 3) == 1234.5);
}

// A part of the scanner's picture says where it begins: columns and rows stay those of the picture,
// and so does what a calibration file says.
void TestWindows()
{
  ReaderOf test(MakeSequence(4).GetContent());
  test.Reader->Update();
  const lacuna::TrackedSlices whole(test.Reader->GetOutput());
  vtkNew<vtkExtractVOI> crop;
  crop->SetInputConnection(test.Reader->GetOutputPort());
  crop->SetVOI(2, 4, 1, 3, 0, 3);
  for (const char* name : Names)
  {
    const std::string path = Beside(test, name);
    WriterOf writer(crop->GetOutputPort(), path);
    LACUNA_CHECK(writer.Writer->Write() == 1);
    LACUNA_CHECK(writer.Warnings.empty());
    for (const bool calibrated : { false, true })
    {
      vtkNew<vtkLacunaTrackedSliceReader> reader;
      reader->SetFileName(path.c_str());
      reader->SetCalibrationFileName(calibrated ? test.GetCalibrationName().c_str() : nullptr);
      reader->Update();
      vtkImageData* output = reader->GetOutput();
      LACUNA_CHECK(output->GetOrigin()[0] == 2 && output->GetOrigin()[1] == 1);
      LACUNA_CHECK(output->GetScalarComponentAsDouble(2, 1, 3, 0) == GetGrey(4, 2, 3));
      LACUNA_CHECK(!output->GetFieldData()->HasArray("FirstColumn"));
      const lacuna::TrackedSlices slices(output);
      for (int k = 0; k < 4; ++k)
      {
        const lacuna::Vec3 here = slices.GetImageToReference(k).Point({ 4, 2, 0 });
        const lacuna::Vec3 there = whole.GetImageToReference(k).Point({ 4, 2, 0 });
        LACUNA_CHECK(Norm(here - there) < 1e-12);
      }
      // and once more: what was read of the crop is written anew
      const std::string againPath = Beside(test, std::string("again-") + name);
      WriterOf again(reader->GetOutputPort(), againPath);
      LACUNA_CHECK(again.Writer->Write() == 1);
      vtkNew<vtkLacunaTrackedSliceReader> copy;
      copy->SetFileName(againPath.c_str());
      copy->Update();
      LACUNA_CHECK(copy->GetOutput()->GetOrigin()[0] == 2);
      const auto point = [](vtkImageData* stack)
      {
        return lacuna::FieldData::GetMatrix(lacuna::FieldData::Get(stack, "ImageToProbe", 16, 1), 0)
          .Point({ 4, 2, 0 });
      };
      LACUNA_CHECK(Norm(point(copy->GetOutput()) - point(test.Reader->GetOutput())) < 1e-12);
      const lacuna::TrackedSlices third(copy->GetOutput());
      LACUNA_CHECK(Norm(third.GetImageToReference(3).Point({ 4, 2, 0 }) -
                     whole.GetImageToReference(3).Point({ 4, 2, 0 })) < 1e-12);
    }
  }
}

// A crop keeps every pixel where it was in space.
void TestCrops()
{
  ReaderOf test(MakeSequence(8).GetContent());
  test.Reader->Update();
  const lacuna::TrackedSlices whole(test.Reader->GetOutput());
  vtkNew<vtkExtractVOI> crop;
  crop->SetInputConnection(test.Reader->GetOutputPort());
  crop->SetVOI(2, 4, 1, 3, 3, 7);
  crop->SetSampleRate(2, 1, 2);
  const std::string path = Beside(test, "copy.mha");
  WriterOf writer(crop->GetOutputPort(), path);
  LACUNA_CHECK(writer.Writer->Write() == 1);
  LACUNA_CHECK_CONTAINS(writer.Warnings, "cropped or resampled");
  ReaderOf copy(ReadAll(path), false);
  copy.Reader->Update();
  LACUNA_CHECK(copy.Errors.empty());
  vtkImageData* output = copy.Reader->GetOutput();
  LACUNA_CHECK(output->GetDimensions()[0] == 2 && output->GetDimensions()[1] == 3);
  LACUNA_CHECK(output->GetDimensions()[2] == 3); // 3, 5, 7
  const lacuna::TrackedSlices slices(output);
  LACUNA_CHECK(slices.GetNumberOfSlices() == 3);
  for (int k = 0; k < 3; ++k)
  {
    const int frame = 3 + 2 * k;
    LACUNA_CHECK(output->GetFieldData()->GetArray("FrameNumber")->GetTuple1(k) == frame);
    LACUNA_CHECK(output->GetScalarComponentAsDouble(1, 2, k, 0) == GetGrey(4, 3, frame));
    const lacuna::Vec3 here = slices.GetImageToReference(k).Point({ 1, 2, 0 });
    const lacuna::Vec3 there = whole.GetImageToReference(frame).Point({ 4, 3, 0 });
    for (int a = 0; a < 3; ++a)
    {
      LACUNA_CHECK_NEAR(here[a], there[a], 1e-12);
    }
  }
  const lacuna::Matrix4 probe =
    lacuna::FieldData::GetMatrix(lacuna::FieldData::Get(output, "ImageToProbe", 16, 1), 0);
  LACUNA_CHECK_NEAR(probe.Point({ 1, 2, 0 })[0], 0.4, 1e-12); // column 4 of 0.1 mm
  LACUNA_CHECK_NEAR(probe.Point({ 1, 2, 0 })[1], 0.6, 1e-12);
}

// Of several processes one writes.
void TestPieces()
{
  ReaderOf test(MakeSequence(3).GetContent());
  WriterOf alone(test.Reader->GetOutputPort(), Beside(test, "alone.mha"));
  LACUNA_CHECK(alone.Writer->Write() == 1);
  WriterOf first(test.Reader->GetOutputPort(), Beside(test, "first.mha"));
  first.Writer->SetNumberOfPieces(3);
  LACUNA_CHECK(first.Writer->Write() == 1);
  LACUNA_CHECK(ReadAll(Beside(test, "first.mha")) == ReadAll(Beside(test, "alone.mha")));
  for (const int piece : { 1, 2 })
  {
    WriterOf other(test.Reader->GetOutputPort(), Beside(test, "other.mha"));
    other.Writer->SetNumberOfPieces(3);
    other.Writer->SetPiece(piece);
    LACUNA_CHECK(other.Writer->Write() == 1);
    LACUNA_CHECK(other.Errors.empty() && other.Writer->GetFileSize() == 0);
    LACUNA_CHECK(!std::filesystem::exists(Beside(test, "other.mha")));
  }
}

void TestErrors()
{
  ReaderOf test(MakeSequence(2).GetContent());
  const auto expect = [&](vtkAlgorithmOutput* input, const std::string& path, unsigned long code,
                        const std::string& part)
  {
    WriterOf writer(input, path);
    LACUNA_CHECK(writer.Writer->Write() == 0);
    LACUNA_CHECK(writer.Writer->GetErrorCode() == code);
    LACUNA_CHECK(writer.Writer->GetFileSize() == 0);
    LACUNA_CHECK_CONTAINS(writer.Errors, part);
  };
  vtkAlgorithmOutput* input = test.Reader->GetOutputPort();
  expect(input, "", vtkErrorCode::NoFileNameError, "no FileName");
  expect(input, Beside(test, "a.vti"), vtkErrorCode::UnknownError, "must end in .mha, .mhd");
  expect(input, Beside(test, "no/a.mha"), vtkErrorCode::CannotOpenFileError, "No such file");
  WriterOf pressed(input, Beside(test, "a.mha"));
  pressed.Writer->SetCompressionLevel(10);
  LACUNA_CHECK(pressed.Writer->Write() == 0);
  LACUNA_CHECK_CONTAINS(pressed.Errors, "CompressionLevel is 10; it must be from 0 to 9");
  LACUNA_CHECK(!std::filesystem::exists(Beside(test, "a.mha")));
  if (std::filesystem::exists("/dev/full"))
  {
    std::filesystem::create_symlink("/dev/full", Beside(test, "full.mha"));
    expect(input, Beside(test, "full.mha"), vtkErrorCode::OutOfDiskSpaceError, "No space");
  }
  vtkNew<vtkImageData> plain;
  plain->SetDimensions(3, 3, 3);
  plain->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
  WriterOf writer(plain, Beside(test, "a.mha"));
  LACUNA_CHECK(writer.Writer->Write() == 0);
  LACUNA_CHECK_CONTAINS(writer.Errors, "not a stack of tracked slices");
  LACUNA_CHECK(!std::filesystem::exists(Beside(test, "a.mha")));
  test.Reader->SetFileName("/nonexistent.mha");
  expect(input, Beside(test, "a.mha"), vtkErrorCode::UnknownError, "nothing was written");
  LACUNA_CHECK(!std::filesystem::exists(Beside(test, "a.mha")));
}

// The file that is being read may be written over.
void TestInPlace()
{
  ReaderOf test(MakeSequence(5).GetContent());
  WriterOf writer(test.Reader->GetOutputPort(), test.File.GetPath());
  LACUNA_CHECK(writer.Writer->Write() == 1);
  ReaderOf copy(ReadAll(test.File.GetPath()));
  copy.Reader->Update();
  CheckSame(test.Reader->GetOutput(), copy.Reader->GetOutput(),
    { "ImageToProbeTransform", "ImageToProbeTransformStatus" }, "in place");
}
}

int TestTrackedSliceWriter(int, char*[])
{
  TestDefaults();
  TestEverythingComesBack();
  TestWarnings();
  TestPatientsFrame();
  TestPartsOfCropped();
  TestCorrectedPoses();
  TestWindows();
  TestCrops();
  TestPieces();
  TestErrors();
  TestInPlace();
  return lacunaCheck::Result();
}
