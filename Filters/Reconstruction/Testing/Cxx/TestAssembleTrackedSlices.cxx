// SPDX-License-Identifier: BSD-3-Clause
/// Ports, arrays, extents and time steps of vtkLacunaAssembleTrackedSlices.
#include "lacunaProvenance.h"
#include "lacunaTestPoses.h"
#include "lacunaTrackedSlices.h"
#include "vtkImageAlgorithm.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkStreamingDemandDrivenPipeline.h"

using lacuna::Matrix4;

namespace
{
void TestContract()
{
  const auto stack = MakeStack(3);
  const auto table = MakePoses(3);
  AddColumn(table, "Time [s]", { 1.5, 2.5, 3.5 });
  AddColumn(table, "Frame", { 7, 8, 9 });
  AddColumn(table, "Gate", { 0.1, 0.5, 0.9 });
  const auto filter = MakeFilter(stack, table, [](auto* f) { f->SetGateRange(0, 0.6); });
  filter->Update();
  vtkImageData* slices = filter->GetOutput();
  const lacuna::TrackedSlices tracked(slices); // throws unless the contract is kept
  LACUNA_CHECK(tracked.GetNumberOfSlices() == 3);
  LACUNA_CHECK(slices->GetOrigin()[0] == 0 && slices->GetOrigin()[2] == 0);
  LACUNA_CHECK(slices->GetSpacing()[0] == 1 && slices->GetSpacing()[1] == 1);
  vtkDataArray* grey = slices->GetPointData()->GetScalars();
  LACUNA_CHECK(
    grey && std::string(grey->GetName()) == "Intensity" && grey->GetDataType() == VTK_INT);
  LACUNA_CHECK_THAT(grey->GetVoidPointer(0) == stack->GetScalarPointer(), "pixels are shared");
  LACUNA_CHECK_THAT(std::string(stack->GetPointData()->GetScalars()->GetName()) == "Grey",
    "the input keeps its name");
  for (int i = 0; i < 3; ++i)
  {
    CheckPose(slices, i, GetPose(i) * Matrix4::Scaling({ 0.5, 0.5, 0.5 }));
    LACUNA_CHECK(tracked.GetTimestamp(i) == 1.5 + i);
    LACUNA_CHECK(slices->GetFieldData()->GetArray("FrameNumber")->GetTuple1(i) == 7 + i);
    LACUNA_CHECK(tracked.GetStatus(i) == (i == 2 ? 8 : 0));
  }
  LACUNA_CHECK(slices->GetFieldData()->GetArray("Gate")->GetTuple1(1) == 0.5);
  LACUNA_CHECK(slices->GetFieldData()->GetArray("ProbeToReference")->GetNumberOfTuples() == 3);
  LACUNA_CHECK(slices->GetFieldData()->GetArray("ImageToProbe")->GetNumberOfTuples() == 1);
  const std::vector<std::string> steps = lacuna::Provenance::Get(slices);
  LACUNA_CHECK(steps.size() == 1 && steps[0].find("PixelSpacing=0.5,0.5") != std::string::npos);
}

void TestCalibration()
{
  const double calibration[16] = { 0, -1, 0, 5, 1, 0, 0, 6, 0, 0, 1, 7, 0, 0, 0, 1 };
  const auto filter = MakeFilter(MakeStack(2), MakePoses(2),
    [&](auto* f)
    {
      f->SetImageToProbe(calibration);
      f->SetPixelSpacing(0.2, 0.3);
    });
  filter->Update();
  CheckPose(filter->GetOutput(), 1,
    GetPose(1) * Matrix4(calibration) * Matrix4::Scaling({ 0.2, 0.3, std::sqrt(0.06) }));

  // not calibrated: poses of the probe, and a warning that says what to do
  filter->SetImageToProbe(Matrix4().Data());
  filter->SetPixelSpacing(0);
  const auto messages = lacunaCheck::Watch(filter);
  filter->Update();
  vtkFieldData* fields = filter->GetOutput()->GetFieldData();
  LACUNA_CHECK(messages->HasWarning("Set PixelSpacing"));
  LACUNA_CHECK(!fields->GetArray("ImageToReference") && !fields->GetArray("ImageToProbe"));
  LACUNA_CHECK(fields->GetArray("ProbeToReference") && fields->GetArray("SliceStatus"));

  // poses of the image need no probe, but keep a calibration that is known
  filter->SetPixelSpacing(0.5);
  filter->SetImageToProbe(calibration);
  filter->SetPoseTransform(vtkLacunaAssembleTrackedSlices::ImageToReference);
  filter->Update();
  fields = filter->GetOutput()->GetFieldData();
  CheckPose(filter->GetOutput(), 1, GetPose(1) * Matrix4::Scaling({ 0.5, 0.5, 0.5 }));
  LACUNA_CHECK(!fields->GetArray("ProbeToReference") && fields->GetArray("ImageToProbe"));
}

void TestRowOrder()
{
  const auto poses = MakePoses(2);
  // pictures of VTK's readers of PNG and the like begin with their bottom row
  for (const char* name : { "PNGImage", "JPEGImage", "BMPImage", "DICOMImage" })
  {
    const auto filter = MakeFilter(MakeStack(2, VTK_INT, name), poses);
    filter->Update();
    LACUNA_CHECK(GetGrey(filter->GetOutput(), 1, 0, 1) == 1 + 30 + 100);
    LACUNA_CHECK(GetGrey(filter->GetOutput(), 4, 3, 0) == 4);
    filter->SetRowOrder(vtkLacunaAssembleTrackedSlices::TopRowFirst);
    filter->Update();
    LACUNA_CHECK(GetGrey(filter->GetOutput(), 1, 0, 1) == 101);
  }
  const auto filter = MakeFilter(MakeStack(2), poses,
    [](auto* f) { f->SetRowOrder(vtkLacunaAssembleTrackedSlices::BottomRowFirst); });
  filter->Update();
  LACUNA_CHECK(GetGrey(filter->GetOutput(), 1, 0, 1) == 131);

  // parts of pictures: the columns and rows of the whole ones
  const auto part = MakeStack(2, VTK_INT, "PNGImage");
  const auto cut = vtkSmartPointer<vtkImageData>::New();
  cut->DeepCopy(part);
  cut->SetExtent(10, 14, 20, 23, 5, 6);
  const auto cropped = MakeFilter(
    cut, poses, [](auto* f) { f->SetRowOrder(vtkLacunaAssembleTrackedSlices::TopRowFirst); });
  cropped->Update();
  vtkImageData* slices = cropped->GetOutput();
  LACUNA_CHECK(slices->GetExtent()[0] == 10 && slices->GetExtent()[2] == 20);
  LACUNA_CHECK(slices->GetBounds()[0] == 10 && slices->GetBounds()[2] == 20);
  LACUNA_CHECK(slices->GetBounds()[4] == 0 && slices->GetBounds()[5] == 1);
  cropped->SetRowOrder(vtkLacunaAssembleTrackedSlices::BottomRowFirst);
  cropped->Update();
  LACUNA_CHECK(slices->GetBounds()[2] == 0 && slices->GetBounds()[3] == 3);
  LACUNA_CHECK(GetGrey(slices, 10, 20, 5) == 30);
  LACUNA_CHECK_CONTAINS(GetError(cut, poses), "set RowOrder");
}

void TestPixels()
{
  const auto poses = MakePoses(2);
  auto filter = MakeFilter(MakeStack(2, VTK_DOUBLE, "RGB", 3), poses);
  filter->Update();
  LACUNA_CHECK_NEAR(
    GetGrey(filter->GetOutput(), 2, 1, 1), 112 * (0.299 + 2 * 0.587 + 3 * 0.114), 1e-9);
  filter = MakeFilter(MakeStack(2, VTK_UNSIGNED_CHAR, "LA", 2), poses);
  filter->Update();
  LACUNA_CHECK(GetGrey(filter->GetOutput(), 2, 1, 1) == 112);
  LACUNA_CHECK(filter->GetOutput()->GetPointData()->GetScalars()->GetNumberOfComponents() == 1);
  LACUNA_CHECK_CONTAINS(GetError(MakeStack(2, VTK_INT, "x", 5), poses), "5 numbers per pixel");
  const auto bare = MakeStack(2);
  bare->GetPointData()->Initialize();
  LACUNA_CHECK_CONTAINS(GetError(bare, poses), "no active point scalars");

  // a part of the output is that part of the whole one
  filter = MakeFilter(MakeStack(4, VTK_INT, "PNGImage"), MakePoses(4));
  filter->UpdateInformation();
  const int part[6] = { 1, 3, 0, 1, 2, 3 };
  filter->UpdateExtent(part);
  vtkImageData* slices = filter->GetOutput();
  for (int a = 0; a < 6; ++a)
  {
    LACUNA_CHECK(slices->GetExtent()[a] == part[a]);
  }
  LACUNA_CHECK(GetGrey(slices, 3, 1, 2) == 3 + 20 + 200);
  LACUNA_CHECK(slices->GetFieldData()->GetArray("ImageToReference")->GetNumberOfTuples() == 4);
}

// Two-dimensional pictures, one for each time step; fails at one of them.
class PictureSource : public vtkImageAlgorithm
{
public:
  static PictureSource* New();
  vtkTypeMacro(PictureSource, vtkImageAlgorithm);
  double FailAt = -1;
  int Executions = 0;

protected:
  PictureSource() { this->SetNumberOfInputPorts(0); }
  int RequestInformation(
    vtkInformation*, vtkInformationVector**, vtkInformationVector* outputs) override
  {
    vtkInformation* info = outputs->GetInformationObject(0);
    const int extent[6] = { 0, 4, 0, 3, 0, 0 };
    info->Set(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), extent, 6);
    const double steps[4] = { 0.5, 0.6, 0.7, 0.8 };
    info->Set(vtkStreamingDemandDrivenPipeline::TIME_STEPS(), steps, 4);
    info->Set(vtkStreamingDemandDrivenPipeline::TIME_RANGE(), steps, 2);
    return 1;
  }
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector* outputs) override
  {
    ++this->Executions;
    vtkInformation* info = outputs->GetInformationObject(0);
    const double time = info->Get(vtkStreamingDemandDrivenPipeline::UPDATE_TIME_STEP());
    if (std::abs(time - this->FailAt) < 1e-9)
    {
      return 0;
    }
    vtkImageData* output = vtkImageData::GetData(outputs);
    output->SetExtent(0, 4, 0, 3, 0, 0);
    output->AllocateScalars(VTK_INT, 1);
    for (int i = 0; i < 20; ++i)
    {
      output->GetPointData()->GetScalars()->SetTuple1(i, std::llround(1000 * time) + i);
    }
    output->GetInformation()->Set(vtkDataObject::DATA_TIME_STEP(), time);
    return 1;
  }
};
vtkStandardNewMacro(PictureSource);

void TestTimeSteps()
{
  vtkNew<PictureSource> source;
  const auto filter = MakeFilter(nullptr, MakePoses(4));
  filter->SetInputConnection(0, source->GetOutputPort());
  filter->Update();
  vtkImageData* slices = filter->GetOutput();
  LACUNA_CHECK(slices->GetDimensions()[2] == 4);
  LACUNA_CHECK_THAT(source->Executions == 4, "each picture is read once");
  for (int k = 0; k < 4; ++k)
  {
    LACUNA_CHECK(GetGrey(slices, 2, 1, k) == 500 + 100 * k + 7);
    CheckPose(slices, k, GetPose(k) * Matrix4::Scaling({ 0.5, 0.5, 0.5 }));
  }
  LACUNA_CHECK_THAT(
    !filter->GetOutputInformation(0)->Has(vtkStreamingDemandDrivenPipeline::TIME_STEPS()),
    "the stack has no time steps");
  LACUNA_CHECK_THAT(!slices->GetFieldData()->GetArray("Timestamp"),
    "numbers of pictures are not taken for seconds");

  // some slices only
  const int part[6] = { 0, 4, 0, 3, 1, 2 };
  source->Modified();
  source->Executions = 0;
  filter->UpdateExtent(part);
  LACUNA_CHECK(source->Executions == 2 && GetGrey(filter->GetOutput(), 0, 0, 2) == 700);

  // the time steps are the slices' times on demand; the table's clock is 10 s ahead
  auto table = MakePoses(11);
  AddColumn(table, "Timestamp", { 10, 10.1, 10.2, 10.3, 10.4, 10.5, 10.6, 10.7, 10.8, 10.9, 11 });
  filter->SetInputDataObject(1, table);
  filter->SetMatchBy(vtkLacunaAssembleTrackedSlices::Time);
  filter->SetTimeOffset(10.05);
  filter->SetMaximumTimeGap(0.15);
  filter->Update();
  CheckPose(filter->GetOutput(), 2, GetPose(7.5) * Matrix4::Scaling({ 0.5, 0.5, 0.5 }));
  LACUNA_CHECK_NEAR(
    filter->GetOutput()->GetFieldData()->GetArray("Timestamp")->GetTuple1(2), 0.7, 1e-12);

  // a picture that cannot be read leaves nothing, and the next update starts afresh
  source->FailAt = 0.7;
  source->Modified();
  {
    const auto messages = lacunaCheck::Watch(filter);
    vtkNew<lacunaCheck::Messages> others;
    others->Watch(source->GetExecutive());
    filter->Update();
    LACUNA_CHECK(!others->Errors.empty());
  }
  source->FailAt = -1;
  source->Modified();
  filter->Update();
  LACUNA_CHECK(GetGrey(filter->GetOutput(), 0, 0, 3) == 800);
  LACUNA_CHECK(filter->GetOutput()->GetDimensions()[2] == 4);
}
}

int TestAssembleTrackedSlices(int, char*[])
{
  TestContract();
  TestCalibration();
  TestRowOrder();
  TestPixels();
  TestTimeSteps();
  return lacunaCheck::Result();
}
