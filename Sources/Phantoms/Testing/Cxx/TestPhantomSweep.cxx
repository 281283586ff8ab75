// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaCheck.h"
#include "lacunaFieldData.h"
#include "lacunaProvenance.h"
#include "lacunaTrackedSlices.h"
#include "vtkCallbackCommand.h"
#include "vtkDataArray.h"
#include "vtkExecutive.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkLacunaPhantomSweep.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"
#include "vtkTestErrorObserver.h"
#include "vtkTrivialProducer.h"

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <sstream>
#include <string>

namespace
{
void TestDefaults()
{
  vtkNew<vtkLacunaPhantomSweep> sweep;
  sweep->Update();
  vtkImageData* output = sweep->GetOutput();
  const int* dimensions = output->GetDimensions();
  LACUNA_CHECK_THAT(
    dimensions[0] == 320 && dimensions[1] == 240 && dimensions[2] == 60, "default size");
  LACUNA_CHECK_THAT(output->GetScalarType() == VTK_UNSIGNED_CHAR, "default type");
  double bounds[6];
  output->GetBounds(bounds);
  LACUNA_CHECK_THAT(
    bounds[0] == 0 && bounds[1] == 319 && bounds[5] == 59, "coordinates are indices");
  std::ostringstream text;
  sweep->Print(text);
  LACUNA_CHECK_THAT(
    text.str().find("NumberOfSlices: 60 (1 or more)") != std::string::npos, "PrintSelf");
}

// The arrays of the contract, and pixels that are the truth where the arrays say they are.
void TestContract()
{
  for (int motion = 0; motion < 4; ++motion)
  {
    for (int anatomy = 0; anatomy < 4; ++anatomy)
    {
      vtkNew<vtkLacunaPhantomSweep> sweep;
      sweep->SetNumberOfSlices(7);
      sweep->SetNumberOfSweeps(2);
      sweep->SetImageSize(33, 21);
      sweep->SetPixelSpacing(1.7);
      sweep->SetMotion(motion);
      sweep->SetAnatomy(anatomy);
      sweep->SetCenter(1, -2, 3);
      sweep->Update();
      vtkImageData* output = sweep->GetOutput();
      const lacuna::TrackedSlices slices(output);
      LACUNA_CHECK_THAT(slices.GetNumberOfSlices() == 7, "slices");
      vtkFieldData* field = output->GetFieldData();
      vtkDataArray* probe = field->GetArray("ProbeToReference");
      vtkDataArray* image = field->GetArray("ImageToProbe");
      vtkDataArray* frames = field->GetArray("FrameNumber");
      LACUNA_CHECK_THAT(probe && probe->GetNumberOfTuples() == 7 &&
          probe->GetNumberOfComponents() == 16 && probe->GetDataType() == VTK_DOUBLE,
        "ProbeToReference");
      LACUNA_CHECK_THAT(
        image && image->GetNumberOfTuples() == 1 && image->GetNumberOfComponents() == 16,
        "ImageToProbe");
      LACUNA_CHECK_THAT(frames && frames->GetNumberOfTuples() == 7 && frames->GetTuple1(6) == 6 &&
          frames->GetDataType() == VTK_INT,
        "FrameNumber");
      LACUNA_CHECK_THAT(lacuna::Provenance::Get(output).size() == 1, "Provenance");
      for (int k = 0; k < 7; ++k)
      {
        LACUNA_CHECK_THAT(slices.GetStatus(k) == lacuna::TrackedSlices::Valid, "status");
        LACUNA_CHECK_THAT(slices.GetTimestamp(k) == k / 25.0, "time");
        const lacuna::Matrix4& pose = slices.GetImageToReference(k);
        const lacuna::Matrix4 product =
          lacuna::FieldData::GetMatrix(probe, k) * lacuna::FieldData::GetMatrix(image, 0);
        LACUNA_CHECK_THAT(
          std::memcmp(pose.Data(), product.Data(), 16 * sizeof(double)) == 0, "chain");
        LACUNA_CHECK_THAT(pose.Determinant3() > 0, "no mirror");
        for (int j = 0; j < 21; ++j)
        {
          for (int i = 0; i < 33; ++i)
          {
            const lacuna::Vec3 p =
              pose.Point({ static_cast<double>(i), static_cast<double>(j), 0 });
            const double truth =
              std::min(255.0, std::max(0.0, sweep->EvaluateTruth(p[0], p[1], p[2])));
            const double grey = output->GetScalarComponentAsDouble(i, j, k, 0);
            LACUNA_CHECK_THAT(std::abs(grey - truth) <= 0.5 + 1e-9, "pixel is the truth");
          }
        }
      }
    }
  }
}

void TestPoseNoise()
{
  vtkNew<vtkLacunaPhantomSweep> sweep;
  sweep->SetNumberOfSlices(5);
  sweep->SetImageSize(20, 10);
  sweep->Update();
  vtkNew<vtkImageData> clean;
  clean->DeepCopy(sweep->GetOutput());
  sweep->SetPoseNoise(0.5, 1);
  sweep->Update();
  const lacuna::TrackedSlices before(clean);
  const lacuna::TrackedSlices after(sweep->GetOutput());
  LACUNA_CHECK_THAT(
    std::memcmp(clean->GetScalarPointer(), sweep->GetOutput()->GetScalarPointer(), 1000) == 0,
    "pixels are imaged at the true pose");
  for (int k = 0; k < 5; ++k)
  {
    const lacuna::Vec3 offset = after.GetImageToReference(k).Point({ 0, 0, 0 }) -
      before.GetImageToReference(k).Point({ 0, 0, 0 });
    LACUNA_CHECK_THAT(Norm(offset) > 1e-3 && Norm(offset) < 5, "poses are jittered");
  }
  sweep->SetSeed(1);
  sweep->Update();
  const lacuna::TrackedSlices other(sweep->GetOutput());
  LACUNA_CHECK_THAT(
    other.GetImageToReference(0)(0, 3) != after.GetImageToReference(0)(0, 3), "seed");
}

void TestPieces()
{
  vtkNew<vtkLacunaPhantomSweep> sweep;
  sweep->SetNumberOfSlices(10);
  sweep->SetImageSize(40, 30);
  sweep->SetMotion(vtkLacunaPhantomSweep::Arbitrary);
  sweep->SetSpeckleLevel(0.2);
  sweep->SetOutputScalarType(vtkLacunaPhantomSweep::Float);
  sweep->Update();
  vtkNew<vtkImageData> whole;
  whole->DeepCopy(sweep->GetOutput());
  LACUNA_CHECK_THAT(whole->GetScalarType() == VTK_FLOAT, "float");
  const int extent[6] = { 5, 20, 7, 29, 3, 8 };
  vtkNew<vtkLacunaPhantomSweep> same;
  same->SetNumberOfSlices(10);
  same->SetImageSize(40, 30);
  same->SetMotion(vtkLacunaPhantomSweep::Arbitrary);
  same->SetSpeckleLevel(0.2);
  same->SetOutputScalarType(vtkLacunaPhantomSweep::Float);
  same->UpdateExtent(extent);
  vtkImageData* part = same->GetOutput();
  LACUNA_CHECK_THAT(
    std::equal(extent, extent + 6, part->GetExtent()), "exactly the requested extent");
  LACUNA_CHECK_THAT(lacuna::TrackedSlices(part).GetNumberOfSlices() == 10, "all tuples");
  LACUNA_CHECK_THAT(lacuna::TrackedSlices(part).GetSliceNumber(3) == 3, "slice number");
  for (int k = extent[4]; k <= extent[5]; ++k)
  {
    for (int j = extent[2]; j <= extent[3]; ++j)
    {
      for (int i = extent[0]; i <= extent[1]; ++i)
      {
        LACUNA_CHECK_THAT(*static_cast<float*>(part->GetScalarPointer(i, j, k)) ==
            *static_cast<float*>(whole->GetScalarPointer(i, j, k)),
          "pieces equal the whole");
      }
    }
  }
}

// A linear field on a volume whose axes are turned and whose extent does not start at 0.
void TestVolumeInput()
{
  vtkNew<vtkImageData> volume;
  volume->SetExtent(-10, 30, 5, 35, 2, 32);
  volume->SetOrigin(100, 50, -20);
  volume->SetSpacing(2, 2.5, 3);
  volume->SetDirectionMatrix(0, -1, 0, 1, 0, 0, 0, 0, 1);
  volume->AllocateScalars(VTK_SHORT, 1);
  for (int k = 2; k <= 32; ++k)
  {
    for (int j = 5; j <= 35; ++j)
    {
      for (int i = -10; i <= 30; ++i)
      {
        *static_cast<short*>(volume->GetScalarPointer(i, j, k)) =
          static_cast<short>(7 * i - 4 * j + 9 * k - 300);
      }
    }
  }
  vtkNew<vtkTrivialProducer> producer;
  producer->SetOutput(volume);
  vtkNew<vtkLacunaPhantomSweep> sweep;
  sweep->SetVolumeConnection(1, producer->GetOutputPort());
  sweep->SetNumberOfSlices(9);
  sweep->SetImageSize(60, 40);
  sweep->SetPixelSpacing(1.3);
  sweep->SetTravel(120); // leaves the volume at both ends
  sweep->SetMotion(vtkLacunaPhantomSweep::Arbitrary);
  sweep->SetOutputScalarType(vtkLacunaPhantomSweep::Float);
  sweep->Update();
  vtkImageData* output = sweep->GetOutput();
  const lacuna::TrackedSlices slices(output);
  int inside = 0;
  int outside = 0;
  for (int k = 0; k < 9; ++k)
  {
    for (int j = 0; j < 40; ++j)
    {
      for (int i = 0; i < 60; ++i)
      {
        const lacuna::Vec3 p = slices.GetImageToReference(k).Point(
          { static_cast<double>(i), static_cast<double>(j), 0 });
        double index[3];
        volume->TransformPhysicalPointToContinuousIndex(p.data(), index);
        const bool in = index[0] >= -10 && index[0] <= 30 && index[1] >= 5 && index[1] <= 35 &&
          index[2] >= 2 && index[2] <= 32;
        const double expected = in ? 7 * index[0] - 4 * index[1] + 9 * index[2] - 300 : 0;
        LACUNA_CHECK_THAT(
          std::abs(output->GetScalarComponentAsDouble(i, j, k, 0) - expected) < 1e-3,
          "trilinear in a turned volume");
        ++(in ? inside : outside);
      }
    }
  }
  LACUNA_CHECK_THAT(inside > 5000 && outside > 1000, "both sides of the border are met");
  LACUNA_CHECK_THAT(std::isnan(sweep->EvaluateTruth(0, 0, 0)) &&
      std::isnan(sweep->GetTrueVolume()) && std::isnan(sweep->GetTrueIsoValue()),
    "an input volume has no closed form");
  sweep->SetVolumeConnection(1, nullptr);
  LACUNA_CHECK_THAT(sweep->EvaluateTruth(-3, 2, 1) == 180, "back to the scene");
}

void TestTruth()
{
  vtkNew<vtkLacunaPhantomSweep> sweep;
  vtkNew<vtkImageData> grid;
  grid->SetExtent(-5, 15, 2, 22, -3, 17);
  grid->SetSpacing(1.5, 2, 1);
  grid->SetOrigin(-9, -20, -10);
  grid->SetDirectionMatrix(0, 0, 1, 1, 0, 0, 0, 1, 0);
  LACUNA_CHECK_THAT(sweep->AddTruth(grid), "AddTruth");
  vtkDataArray* truth = grid->GetPointData()->GetArray("Truth");
  LACUNA_CHECK_THAT(truth && truth->GetDataType() == VTK_FLOAT, "Truth array");
  for (vtkIdType i = 0; truth && i < grid->GetNumberOfPoints(); ++i)
  {
    double p[3];
    grid->GetPoint(i, p);
    LACUNA_CHECK_THAT(std::abs(truth->GetTuple1(i) - sweep->EvaluateTruth(p[0], p[1], p[2])) < 1e-4,
      "Truth is EvaluateTruth");
  }
  LACUNA_CHECK_THAT(std::abs(sweep->GetTrueVolume() - 12817.698) < 1e-3, "TrueVolume");
  LACUNA_CHECK_THAT(sweep->GetTrueIsoValue() == 120, "TrueIsoValue");
  sweep->SetAnatomy(vtkLacunaPhantomSweep::Linear);
  LACUNA_CHECK_THAT(sweep->EvaluateTruth(4, -2, 8) == 124, "linear");
  LACUNA_CHECK_THAT(std::isnan(sweep->EvaluateTruth(std::nan(""), 0, 0)), "truth of nowhere");
}

void TestErrors()
{
  struct Case
  {
    const char* Text;
    std::function<void(vtkLacunaPhantomSweep*)> Spoil;
  };
  using S = vtkLacunaPhantomSweep*;
  const double nan = std::nan("");
  for (const Case& c : { Case{ "NumberOfSlices is 0", [](S s) { s->SetNumberOfSlices(0); } },
         Case{ "NumberOfSweeps is 61", [](S s) { s->SetNumberOfSweeps(61); } },
         Case{ "ImageSize is 0 pixels; it must be 1 pixels or more",
           [](S s) { s->SetImageSize(0, 240); } },
         Case{ "ImageSize is -1 pixels; it must be 1 pixels or more",
           [](S s) { s->SetImageSize(320, -1); } },
         Case{ "PixelSpacing is -0.2", [](S s) { s->SetPixelSpacing(-0.2); } },
         Case{ "PixelSpacing is nan", [=](S s) { s->SetPixelSpacing(nan); } },
         Case{ "Motion is 9", [](S s) { s->SetMotion(9); } },
         Case{ "Anatomy is -1", [](S s) { s->SetAnatomy(-1); } },
         Case{ "SpeckleLevel is nan", [=](S s) { s->SetSpeckleLevel(nan); } },
         Case{ "PoseNoise[1] is -1", [](S s) { s->SetPoseNoise(0, -1); } },
         Case{ "Travel is inf", [](S s) { s->SetTravel(HUGE_VAL); } },
         Case{ "EdgeWidth is 0", [](S s) { s->SetEdgeWidth(0); } },
         Case{ "OutputScalarType is 7", [](S s) { s->SetOutputScalarType(7); } },
         Case{ "2147483647 x 2147483647 pixels would need",
           [](S s) { s->SetImageSize(2147483647, 2147483647); } },
         Case{ "2147483647 slices", [](S s) { s->SetNumberOfSlices(2147483647); } } })
  {
    vtkNew<vtkLacunaPhantomSweep> sweep;
    c.Spoil(sweep);
    vtkNew<vtkTest::ErrorObserver> observer;
    vtkNew<vtkTest::ErrorObserver> executiveObserver;
    sweep->AddObserver(vtkCommand::ErrorEvent, observer);
    sweep->GetExecutive()->AddObserver(vtkCommand::ErrorEvent, executiveObserver);
    sweep->Update();
    LACUNA_CHECK_THAT(observer->GetErrorMessage().find(c.Text) != std::string::npos,
      std::string(c.Text) + " | " + observer->GetErrorMessage());
    LACUNA_CHECK_THAT(sweep->GetOutput()->GetNumberOfPoints() == 0, "no output after an error");
  }

  vtkNew<vtkTest::ErrorObserver> observer;
  vtkNew<vtkTest::ErrorObserver> executiveObserver;
  vtkNew<vtkLacunaPhantomSweep> sweep;
  sweep->AddObserver(vtkCommand::ErrorEvent, observer);
  sweep->GetExecutive()->AddObserver(vtkCommand::ErrorEvent, executiveObserver);
  vtkNew<vtkImageData> empty;
  LACUNA_CHECK_THAT(
    !sweep->AddTruth(empty) && !sweep->AddTruth(nullptr), "AddTruth without points");
  empty->SetDimensions(2, 2, 2); // points, but no scalars
  sweep->SetInputData(empty);
  observer->Clear();
  sweep->Update();
  LACUNA_CHECK_THAT(
    observer->GetErrorMessage().find("no active point scalars") != std::string::npos,
    observer->GetErrorMessage());
  observer->Clear();
  vtkNew<vtkImageData> grid;
  grid->SetDimensions(2, 2, 2);
  LACUNA_CHECK_THAT(
    !sweep->AddTruth(grid) && observer->GetErrorMessage().find("input volume") != std::string::npos,
    "AddTruth with an input volume");
}

void TestAbort()
{
  vtkNew<vtkLacunaPhantomSweep> sweep;
  sweep->SetNumberOfSlices(200);
  sweep->SetImageSize(640, 480);
  sweep->SetSpeckleLevel(0.5);
  vtkNew<vtkCallbackCommand> stop;
  stop->SetCallback([](vtkObject* caller, unsigned long, void*, void*)
    { static_cast<vtkAlgorithm*>(caller)->SetAbortExecute(1); });
  sweep->AddObserver(vtkCommand::ProgressEvent, stop);
  sweep->Update();
  LACUNA_CHECK_THAT(
    sweep->GetOutput()->GetNumberOfPoints() == 0, "nothing that looks whole after an abort");
}
}

int TestPhantomSweep(int, char*[])
{
  TestDefaults();
  TestContract();
  TestPoseNoise();
  TestPieces();
  TestVolumeInput();
  TestTruth();
  TestErrors();
  TestAbort();
  return lacunaCheck::Result();
}
