// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaCheck.h"
#include "lacunaProvenance.h"
#include "vtkCommand.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkLacunaOccludedAngle.h"
#include "vtkNew.h"
#include "vtkPiecewiseFunction.h"
#include "vtkPointData.h"
#include "vtkRTAnalyticSource.h"
#include "vtkSphere.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <cmath>
#include <limits>
#include <sstream>

namespace
{
constexpr double Pi = 3.14159265358979323846;

// An image across the given axis with a circle of pixels of radius 20 mm about (5, 5, 5) mm.
void MakeCircle(vtkImageData* image, int across)
{
  int extent[6] = { -30, 30, -30, 30, -30, 30 };
  extent[2 * across] = extent[2 * across + 1] = 7;
  image->SetExtent(extent);
  image->SetOrigin(5, 5, 5);
  image->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
  image->GetPointData()->GetScalars()->Fill(10);
  for (int s = 0; s < 1000; ++s)
  {
    int at[3];
    at[across] = 7;
    at[(across + 1) % 3] = static_cast<int>(std::lround(20 * std::cos(2 * Pi * s / 1000)));
    at[(across + 2) % 3] = static_cast<int>(std::lround(20 * std::sin(2 * Pi * s / 1000)));
    image->SetScalarComponentFromDouble(at[0], at[1], at[2], 0, 200);
  }
}

double Field(vtkImageData* image, const char* name, int i)
{
  vtkDataArray* array = image->GetFieldData()->GetArray(name);
  LACUNA_CHECK(array && array->GetNumberOfTuples() > i);
  return array ? array->GetComponent(i, 0) : 0;
}

// Flat images across any axis; arrays, types, field data.
void TestFlat()
{
  for (int across : { 0, 1, 2 })
  {
    vtkNew<vtkImageData> circle;
    MakeCircle(circle, across);
    vtkNew<vtkLacunaOccludedAngle> filter;
    filter->SetInputData(circle);
    filter->SetNumberOfDirections(99);
    filter->SetThresholdsOverPi(0, 1.6);
    filter->SetThresholdsOverPi(1, 1);
    filter->Update();
    vtkImageData* output = filter->GetOutput();
    vtkDataArray* angle = output->GetPointData()->GetArray("OccludedAngle");
    vtkDataArray* object = output->GetPointData()->GetArray("Object");
    LACUNA_CHECK(angle && angle == output->GetPointData()->GetScalars());
    LACUNA_CHECK(object && object->GetDataType() == VTK_UNSIGNED_CHAR);
    LACUNA_CHECK(output->GetOrigin()[0] == 5 && angle->GetDataType() == VTK_FLOAT);
    int middle[3] = { 0, 0, 0 };
    middle[across] = 7;
    const vtkIdType inside = output->ComputePointId(middle);
    LACUNA_CHECK_NEAR(angle->GetComponent(inside, 0), 2 * Pi, 0.01);
    LACUNA_CHECK(object->GetComponent(inside, 0) == 1 && object->GetComponent(0, 0) == 0);
    LACUNA_CHECK_NEAR(Field(output, "ThresholdOverPi", 0), 1.6, 1e-12);
    // a threshold of pi takes in the pixels of the circle, and up to one beyond
    LACUNA_CHECK(Field(output, "ObjectVolume", 1) > Pi * 20 * 20);
    LACUNA_CHECK(Field(output, "ObjectVolume", 1) < Pi * 21.5 * 21.5);
    LACUNA_CHECK(Field(output, "ObjectVoxels", 1) == Field(output, "ObjectVolume", 1));
    LACUNA_CHECK(Field(output, "SuggestedThresholdOverPi", 0) > 1);
    LACUNA_CHECK(Field(output, "SuggestedThresholdOverPi", 0) < 2);
    LACUNA_CHECK(lacuna::Provenance::Get(output).size() == 1);
  }
}

// The array named, else the active scalars.
void TestScalarArray()
{
  vtkNew<vtkImageData> circle;
  MakeCircle(circle, 2);
  vtkNew<vtkFloatArray> dot;
  dot->SetName("Dot");
  dot->SetNumberOfTuples(circle->GetNumberOfPoints());
  dot->Fill(0);
  int at[3] = { 10, 15, 7 };
  dot->SetValue(circle->ComputePointId(at), 1);
  circle->GetPointData()->AddArray(dot);
  vtkNew<vtkLacunaOccludedAngle> filter;
  filter->SetInputData(circle);
  filter->SetNumberOfDirections(60);
  filter->Update();
  LACUNA_CHECK(Field(filter->GetOutput(), "ObjectVoxels", 0) > 1000);
  filter->SetScalarArray("Dot");
  filter->Update();
  LACUNA_CHECK(Field(filter->GetOutput(), "ObjectVoxels", 0) == 1);
  LACUNA_CHECK(filter->GetOutput()->GetScalarComponentAsDouble(10, 15, 7, 0) > Pi);
}

// Kept iterations are time steps; each equals a run that ends there.
void TestTimeSteps()
{
  vtkNew<vtkImageData> circle;
  MakeCircle(circle, 2);
  vtkNew<vtkLacunaOccludedAngle> filter;
  filter->SetInputData(circle);
  filter->SetNumberOfDirections(60);
  filter->KeepIterationsOn();
  filter->SetThresholdsOverPi(0, 1.7);
  filter->SetThresholdsOverPi(1, 1.2);
  filter->SetThresholdsOverPi(2, 1);
  filter->UpdateInformation();
  vtkInformation* info = filter->GetOutputInformation(0);
  LACUNA_CHECK(info->Length(vtkStreamingDemandDrivenPipeline::TIME_STEPS()) == 3);
  vtkNew<vtkLacunaOccludedAngle> once;
  once->SetInputData(circle);
  once->SetNumberOfDirections(60);
  for (int step : { 2, 1, 3 })
  {
    filter->UpdateTimeStep(step);
    once->SetNumberOfThresholdsOverPi(step);
    for (int i = 0; i < step; ++i)
    {
      once->SetThresholdsOverPi(i, filter->GetThresholdsOverPi(i));
    }
    once->Update();
    vtkImageData* output = filter->GetOutput();
    LACUNA_CHECK(output->GetInformation()->Get(vtkDataObject::DATA_TIME_STEP()) == step);
    LACUNA_CHECK(output->GetFieldData()->GetArray("ObjectVoxels")->GetNumberOfTuples() == step);
    vtkDataArray* a = output->GetPointData()->GetScalars();
    vtkDataArray* b = once->GetOutput()->GetPointData()->GetScalars();
    bool same = true;
    for (vtkIdType i = 0; i < a->GetNumberOfTuples(); ++i)
    {
      same = same && a->GetComponent(i, 0) == b->GetComponent(i, 0);
    }
    LACUNA_CHECK(same);
  }
  // times that are none
  for (const double step : { std::numeric_limits<double>::quiet_NaN(), -1e300, 1e300 })
  {
    filter->UpdateTimeStep(step);
    LACUNA_CHECK(filter->GetOutput()->GetInformation()->Get(vtkDataObject::DATA_TIME_STEP()) ==
      (step > 0 ? 3 : 1));
  }
  // a change of the input must not be answered from what is kept
  circle->GetPointData()->GetScalars()->Fill(10);
  circle->SetScalarComponentFromDouble(0, 0, 7, 0, 200);
  circle->Modified();
  filter->UpdateTimeStep(1);
  LACUNA_CHECK(Field(filter->GetOutput(), "ObjectVoxels", 0) < 5);
}

// The opacity function and the array of attenuations say the same as the range when made to.
void TestAttenuations()
{
  vtkNew<vtkImageData> circle;
  MakeCircle(circle, 2);
  vtkNew<vtkLacunaOccludedAngle> range;
  range->SetInputData(circle);
  range->SetNumberOfDirections(40);
  range->Update();
  vtkNew<vtkPiecewiseFunction> ramp;
  ramp->AddPoint(10, 0);
  ramp->AddPoint(200, 1);
  vtkNew<vtkLacunaOccludedAngle> function;
  function->SetInputData(circle);
  function->SetNumberOfDirections(40);
  function->SetAttenuation(vtkLacunaOccludedAngle::ByOpacityFunction);
  function->SetOpacityFunction(ramp);
  function->Update();
  vtkNew<vtkImageData> coefficients;
  coefficients->CopyStructure(circle);
  coefficients->AllocateScalars(VTK_DOUBLE, 1);
  for (vtkIdType i = 0; i < circle->GetNumberOfPoints(); ++i)
  {
    const double grey = circle->GetPointData()->GetScalars()->GetComponent(i, 0);
    coefficients->GetPointData()->GetScalars()->SetComponent(
      i, 0, (grey - 10) / 190 * std::log(20.0));
  }
  vtkNew<vtkLacunaOccludedAngle> array;
  array->SetInputData(coefficients);
  array->SetNumberOfDirections(40);
  array->SetAttenuation(vtkLacunaOccludedAngle::ByArray);
  array->Update();
  for (vtkIdType i = 0; i < circle->GetNumberOfPoints(); i += 7)
  {
    const double truth = range->GetOutput()->GetPointData()->GetScalars()->GetComponent(i, 0);
    LACUNA_CHECK_NEAR(
      function->GetOutput()->GetPointData()->GetScalars()->GetComponent(i, 0), truth, 1e-5);
    LACUNA_CHECK_NEAR(
      array->GetOutput()->GetPointData()->GetScalars()->GetComponent(i, 0), truth, 1e-5);
  }
  LACUNA_CHECK(lacuna::Provenance::Get(function->GetOutput())
                 .back()
                 .find("OpacityFunction=10,0,0.5,0,200,1,0.5,0") != std::string::npos);
  // a changed function is a changed filter
  ramp->RemoveAllPoints();
  ramp->AddPoint(10, 0);
  ramp->AddPoint(200, 0.01);
  function->Update();
  const int centre[3] = { 0, 0, 7 };
  const vtkIdType id = circle->ComputePointId(const_cast<int*>(centre));
  LACUNA_CHECK(function->GetOutput()->GetPointData()->GetScalars()->GetComponent(id, 0) < 1);
}

// A mask and a function that say the same; voxels outside get 0, also where the mask is NaN.
void TestSpace()
{
  vtkNew<vtkImageData> circle;
  MakeCircle(circle, 2);
  vtkNew<vtkSphere> sphere;
  sphere->SetCenter(5, 5, 12);
  sphere->SetRadius(25.3);
  vtkNew<vtkImageData> mask;
  mask->CopyStructure(circle);
  mask->AllocateScalars(VTK_FLOAT, 1);
  for (vtkIdType i = 0; i < circle->GetNumberOfPoints(); ++i)
  {
    double x[3];
    circle->GetPoint(i, x);
    const double outside = i % 2 == 0 ? 0 : std::numeric_limits<double>::quiet_NaN();
    mask->GetPointData()->GetScalars()->SetComponent(
      i, 0, sphere->FunctionValue(x) < 0 ? 1 : outside);
  }
  vtkNew<vtkLacunaOccludedAngle> a;
  a->SetInputData(circle);
  a->SetNumberOfDirections(40);
  a->SetReconstructionSpace(sphere);
  a->Update();
  vtkNew<vtkLacunaOccludedAngle> b;
  b->SetInputData(circle);
  b->SetInputData(1, mask);
  b->SetNumberOfDirections(40);
  b->Update();
  vtkDataArray* first = a->GetOutput()->GetPointData()->GetScalars();
  vtkDataArray* second = b->GetOutput()->GetPointData()->GetScalars();
  LACUNA_CHECK(first->GetComponent(0, 0) == 0);
  for (vtkIdType i = 0; i < circle->GetNumberOfPoints(); ++i)
  {
    LACUNA_CHECK(first->GetComponent(i, 0) == second->GetComponent(i, 0));
  }
  LACUNA_CHECK(lacuna::Provenance::Get(b->GetOutput()).size() == 1);
  LACUNA_CHECK(
    lacuna::Provenance::Get(a->GetOutput())
      .back()
      .find("ReconstructionSpace=\"vtkSphere Center=5,5,12 Radius=25.3\"") != std::string::npos);
}

// An iteration that leaves nothing is said, once, the first of them; others are not.
void TestEmptyIteration()
{
  vtkNew<vtkImageData> circle;
  MakeCircle(circle, 2);
  vtkNew<vtkLacunaOccludedAngle> filter;
  filter->SetInputData(circle);
  filter->SetNumberOfDirections(40);
  filter->SetThresholdsOverPi(0, 2);
  filter->SetThresholdsOverPi(1, 1);
  vtkNew<lacunaCheck::Messages> messages;
  messages->Watch(filter);
  filter->Update();
  LACUNA_CHECK(messages->HasWarning("iteration 1 has no object"));
  LACUNA_CHECK(!messages->HasWarning("iteration 2") && messages->Errors.empty());
  messages->Warnings.clear();
  filter->SetThresholdsOverPi(0, 1.3);
  filter->Update();
  LACUNA_CHECK(messages->Warnings.empty());
}

void TestPieces()
{
  vtkNew<vtkImageData> circle;
  MakeCircle(circle, 2);
  vtkNew<vtkLacunaOccludedAngle> filter;
  filter->SetInputData(circle);
  filter->SetNumberOfDirections(40);
  filter->Update();
  vtkNew<vtkImageData> whole;
  whole->DeepCopy(filter->GetOutput());
  const int extent[6] = { -10, 4, 3, 25, 7, 7 };
  filter->Modified();
  filter->UpdateExtent(extent);
  vtkImageData* part = filter->GetOutput();
  LACUNA_CHECK(part->GetExtent()[0] == -10 && part->GetExtent()[3] == 25);
  for (int j = 3; j <= 25; ++j)
  {
    LACUNA_CHECK(part->GetScalarComponentAsDouble(2, j, 7, 0) ==
      whole->GetScalarComponentAsDouble(2, j, 7, 0));
  }
}

// A source that can make parts is asked for all of its image, whatever piece is wanted.
void TestPieceOfSource()
{
  vtkNew<vtkRTAnalyticSource> source;
  source->SetWholeExtent(-8, 8, -8, 8, -8, 8);
  vtkNew<vtkLacunaOccludedAngle> filter;
  filter->SetInputConnection(source->GetOutputPort());
  filter->SetNumberOfDirections(20);
  filter->Update();
  vtkNew<vtkImageData> whole;
  whole->DeepCopy(filter->GetOutput());
  vtkNew<vtkRTAnalyticSource> fresh;
  fresh->SetWholeExtent(-8, 8, -8, 8, -8, 8);
  filter->SetInputConnection(fresh->GetOutputPort());
  for (int piece : { 0, 1, 2 })
  {
    filter->Modified();
    filter->UpdatePiece(piece, 3, 0);
    vtkImageData* part = filter->GetOutput();
    const int* e = part->GetExtent();
    LACUNA_CHECK(part->GetNumberOfPoints() > 0);
    for (vtkIdType i = 0; i < part->GetNumberOfPoints(); ++i)
    {
      const int nx = e[1] - e[0] + 1;
      const int ny = e[3] - e[2] + 1;
      const int at[3] = { e[0] + static_cast<int>(i % nx), e[2] + static_cast<int>(i / nx % ny),
        e[4] + static_cast<int>(i / nx / ny) };
      LACUNA_CHECK(part->GetScalarComponentAsDouble(at[0], at[1], at[2], 0) ==
        whole->GetScalarComponentAsDouble(at[0], at[1], at[2], 0));
    }
  }
}

void TestAbort()
{
  vtkNew<vtkImageData> image;
  image->SetDimensions(90, 90, 90);
  image->AllocateScalars(VTK_FLOAT, 1);
  image->GetPointData()->GetScalars()->Fill(0);
  image->SetScalarComponentFromDouble(40, 40, 40, 0, 1);
  vtkNew<vtkLacunaOccludedAngle> filter;
  filter->SetInputData(image);
  filter->SetNumberOfDirections(100000);
  class Stop : public vtkCommand
  {
  public:
    static Stop* New() { return new Stop; }
    void Execute(vtkObject* caller, unsigned long, void*) override
    {
      vtkAlgorithm::SafeDownCast(caller)->SetAbortExecute(1);
    }
  };
  vtkNew<Stop> stop;
  filter->AddObserver(vtkCommand::ProgressEvent, stop);
  filter->Update();
  LACUNA_CHECK(filter->GetOutput()->GetNumberOfPoints() == 0);
}
}

int TestOccludedAngle(int, char*[])
{
  TestFlat();
  TestScalarArray();
  TestTimeSteps();
  TestAttenuations();
  TestSpace();
  TestEmptyIteration();
  TestPieces();
  TestPieceOfSource();
  TestAbort();
  vtkNew<vtkLacunaOccludedAngle> filter;
  std::ostringstream text;
  filter->Print(text);
  for (const char* name : { "ScalarArray", "Mode", "Attenuation", "NumberOfDirections",
         "ThresholdsOverPi", "LocalRadii", "ObjectOpacity", "Dilation", "KeepData", "MedianKernel",
         "ReconstructionSpace", "KeepIterations" })
  {
    LACUNA_CHECK(text.str().find(name) != std::string::npos);
  }
  return lacunaCheck::Result();
}
