// SPDX-License-Identifier: BSD-3-Clause
// Scattered points become images: what comes out, on which grid, and errors.
#include "lacunaCheck.h"
#include "lacunaProvenance.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkLacunaRBFInterpolator.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace
{
double Fraction(double x)
{
  return x - std::floor(x);
}

double Plane(const double* x, int k)
{
  return k == 0 ? 5 + 0.3 * x[0] - 0.2 * x[1] + 0.7 * x[2] : -x[0] + 2 * x[2];
}

double Wave(const double* x)
{
  return std::sin(x[0] / 15) + std::cos(x[1] / 20 + x[2] / 30);
}

// Scattered in 100 x 60 x 40 mm from (-20, 10, 5); flat: at z = 5.
vtkSmartPointer<vtkPolyData> MakePoints(int count, bool flat)
{
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkDoubleArray> planes;
  planes->SetName("Planes");
  planes->SetNumberOfComponents(2);
  vtkNew<vtkDoubleArray> wave;
  wave->SetName("Wave");
  vtkNew<vtkDoubleArray> errors;
  errors->SetName("Errors");
  for (int i = 0; i < count; ++i)
  {
    const double x[3] = { -20 + 100 * Fraction(i * 0.7548776662466927),
      10 + 60 * Fraction(i * 0.5698402909980532),
      flat ? 5 : 5 + 40 * Fraction(i * 0.8191725133961645) };
    points->InsertNextPoint(x);
    planes->InsertNextTuple2(Plane(x, 0), Plane(x, 1));
    wave->InsertNextValue(Wave(x));
    errors->InsertNextValue(i % 2 ? 1 : 0.01);
  }
  auto data = vtkSmartPointer<vtkPolyData>::New();
  data->SetPoints(points);
  data->GetPointData()->AddArray(planes);
  data->GetPointData()->SetScalars(wave);
  data->GetPointData()->AddArray(errors);
  return data;
}

void CheckPlanes(bool flat, int count)
{
  vtkNew<vtkLacunaRBFInterpolator> filter;
  filter->SetInputData(MakePoints(count, flat));
  filter->SetScalarArray("Planes");
  filter->SetOutputSpacing(4, 5, 6);
  filter->SetOutputBounds(-30, 90, 1, -1, 0, 50);
  filter->Update();
  vtkImageData* image = filter->GetOutput();
  int size[3];
  image->GetDimensions(size);
  LACUNA_CHECK(size[0] == 31);
  LACUNA_CHECK(size[1] == 12); // the points' own 60 mm, less what the sequence leaves out
  LACUNA_CHECK(size[2] == (flat ? 1 : 9));
  vtkDataArray* values = image->GetPointData()->GetArray("Planes");
  LACUNA_CHECK(values && values->GetNumberOfComponents() == 2);
  double worst = 0;
  for (vtkIdType i = 0; values && i < image->GetNumberOfPoints(); ++i)
  {
    double x[3];
    image->GetPoint(i, x);
    for (int k = 0; k < 2; ++k)
    {
      worst = std::max(worst, std::abs(values->GetComponent(i, k) - Plane(x, k)));
    }
  }
  LACUNA_CHECK(worst < 1e-4 * 100);
  LACUNA_CHECK(image->GetFieldData()->GetArray("NodeCount")->GetComponent(0, 0) == count);
  const std::vector<std::string> steps = lacuna::Provenance::Get(image);
  LACUNA_CHECK(steps.size() == 1 &&
    steps[0].find("OutputSpacing=4,5,6 OutputBounds=-30,90,1,-1,0,50") != std::string::npos);
}

void CheckDefaultsAndPieces()
{
  vtkNew<vtkLacunaRBFInterpolator> filter;
  filter->SetInputData(MakePoints(400, false));
  filter->Update();
  vtkImageData* image = filter->GetOutput();
  int size[3];
  image->GetDimensions(size);
  LACUNA_CHECK(size[0] == 101);
  vtkDataArray* wave = image->GetPointData()->GetScalars();
  LACUNA_CHECK(wave && std::string(wave->GetName()) == "Wave");
  double worst = 0;
  for (vtkIdType i = 0; i < image->GetNumberOfPoints(); ++i)
  {
    double x[3];
    image->GetPoint(i, x);
    worst = std::max(worst, std::abs(wave->GetComponent(i, 0) - Wave(x)));
  }
  LACUNA_CHECK(worst < 0.5);
  LACUNA_CHECK(image->GetFieldData()->GetArray("Iterations")->GetComponent(0, 0) == 0);
  filter->SetSolver(vtkLacunaRBFInterpolator::Fast);
  filter->Update();
  LACUNA_CHECK(filter->GetOutput()->GetFieldData()->GetArray("Iterations")->GetComponent(0, 0) > 0);
  filter->SetSolver(vtkLacunaRBFInterpolator::Auto);
  filter->Update();
  image = filter->GetOutput();

  vtkNew<vtkLacunaRBFInterpolator> part;
  part->SetInputData(MakePoints(400, false));
  part->UpdateInformation();
  const int piece[6] = { 20, 40, 10, 11, 3, 9 };
  part->UpdateExtent(piece);
  LACUNA_CHECK(part->GetOutput()->GetNumberOfPoints() == 21 * 2 * 7);
  for (int k = piece[4]; k <= piece[5]; ++k)
  {
    LACUNA_CHECK(part->GetOutput()->GetScalarComponentAsDouble(33, 11, k, 0) ==
      image->GetScalarComponentAsDouble(33, 11, k, 0));
  }
}

void CheckErrorsOfValues()
{
  const vtkSmartPointer<vtkPolyData> points = MakePoints(100, true);
  vtkDataArray* wave = points->GetPointData()->GetScalars();
  for (vtkIdType i = 0; i < 100; ++i)
  {
    wave->SetComponent(i, 0, wave->GetComponent(i, 0) + (i % 2 ? 0.5 : -0.5));
  }
  vtkNew<vtkLacunaRBFInterpolator> filter;
  filter->SetInputData(points);
  filter->SetSmoothing(1000);
  filter->SetErrorArray("Errors");
  filter->SetOutputSpacing(0.5, 0.5, 1);
  filter->Update();
  // near the even points, which are ten times as heavy
  double sum = 0;
  for (vtkIdType i = 0; i < 100; i += 2)
  {
    const vtkIdType at = filter->GetOutput()->FindPoint(points->GetPoint(i));
    sum += at < 0
      ? 0
      : std::abs(filter->GetOutput()->GetPointData()->GetScalars()->GetComponent(at, 0) -
          wave->GetComponent(i, 0));
  }
  LACUNA_CHECK(sum / 50 < 0.1);
}

double Field(vtkImageData* image, const char* name)
{
  return image->GetFieldData()->GetArray(name)->GetComponent(0, 0);
}

// Few centres meet all values up to the tolerance, and the report is true.
void CheckCenters(bool flat)
{
  vtkSmartPointer<vtkPolyData> points = MakePoints(6000, flat);
  vtkNew<vtkLacunaRBFInterpolator> filter;
  filter->SetInputData(points);
  filter->SetKernel(flat ? lacuna::RadialKernel::ThinPlate : lacuna::RadialKernel::Linear);
  filter->SetOutputSpacing(4, 4, 4);
  filter->Update();
  LACUNA_CHECK(Field(filter->GetOutput(), "NodeCount") == 6000);
  LACUNA_CHECK(Field(filter->GetOutput(), "CenterCount") == 6000);
  vtkNew<vtkImageData> all;
  all->ShallowCopy(filter->GetOutput());
  double before = 3000;
  for (const double tolerance : { 0.02, 0.2 })
  {
    filter->SetCenterTolerance(tolerance);
    filter->Update();
    vtkImageData* image = filter->GetOutput();
    LACUNA_CHECK(Field(image, "NodeCount") == 6000);
    LACUNA_CHECK(Field(image, "CenterCount") < before);
    LACUNA_CHECK(Field(image, "Residual") <= tolerance);
    LACUNA_CHECK(Field(image, "Residual") > 0.2 * tolerance);
    before = Field(image, "CenterCount");
    double worst = 0;
    for (vtkIdType i = 0; i < image->GetNumberOfPoints(); ++i)
    {
      worst = std::max(worst,
        std::abs(image->GetPointData()->GetScalars()->GetComponent(i, 0) -
          all->GetPointData()->GetScalars()->GetComponent(i, 0)));
    }
    // between the points, too, which lie close together; a corner of the grid is beyond them
    LACUNA_CHECK(worst < 3 * tolerance);
    LACUNA_CHECK(worst > 0.1 * tolerance);
  }
  // A grid whose points are those given shows what the residual says.
  vtkNew<vtkImageData> grid;
  grid->SetDimensions(40, 30, flat ? 1 : 5);
  grid->SetSpacing(2, 2, 8);
  vtkNew<vtkDoubleArray> wave;
  wave->SetName("Wave");
  for (vtkIdType i = 0; i < grid->GetNumberOfPoints(); ++i)
  {
    wave->InsertNextValue(Wave(grid->GetPoint(i)));
  }
  grid->GetPointData()->SetScalars(wave);
  filter->SetInputData(grid);
  filter->SetOutputSpacing(2, 2, 8);
  filter->SetCenterTolerance(0.05);
  filter->Update();
  double worst = 0;
  for (vtkIdType i = 0; i < grid->GetNumberOfPoints(); ++i)
  {
    worst = std::max(worst,
      std::abs(
        filter->GetOutput()->GetPointData()->GetScalars()->GetComponent(i, 0) - wave->GetValue(i)));
  }
  LACUNA_CHECK(worst <= 0.05 + 1e-4 * 4);
  LACUNA_CHECK(std::abs(worst - Field(filter->GetOutput(), "Residual")) < 1e-4 * 4);
}

struct Case
{
  const char* Name;
  std::function<void(vtkPolyData*, vtkLacunaRBFInterpolator*)> Spoil;
  const char* Expected;
};

const Case Errors[] = {
  { "array", [](vtkPolyData*, vtkLacunaRBFInterpolator* f) { f->SetScalarArray("nowhere"); },
    "'nowhere'; its point arrays are 'Planes', 'Wave', 'Errors'" },
  { "scalars",
    [](vtkPolyData* p, vtkLacunaRBFInterpolator*) { p->GetPointData()->SetActiveScalars(nullptr); },
    "no active point scalars" },
  { "value",
    [](vtkPolyData* p, vtkLacunaRBFInterpolator*)
    { p->GetPointData()->GetScalars()->SetComponent(17, 0, std::nan("")); },
    "node 17" },
  { "duplicate",
    [](vtkPolyData* p, vtkLacunaRBFInterpolator*) { p->GetPoints()->SetPoint(5, p->GetPoint(9)); },
    "nodes 5 and 9" },
  { "line",
    [](vtkPolyData* p, vtkLacunaRBFInterpolator*)
    {
      for (vtkIdType i = 0; i < p->GetNumberOfPoints(); ++i)
      {
        p->GetPoints()->SetPoint(i, static_cast<double>(i), 2.0 * static_cast<double>(i), 0);
      }
    },
    "lie on one line" },
  { "axis",
    [](vtkPolyData* p, vtkLacunaRBFInterpolator*)
    {
      for (vtkIdType i = 0; i < p->GetNumberOfPoints(); ++i)
      {
        p->GetPoints()->SetPoint(i, static_cast<double>(i), 2, 0);
      }
    },
    "one line along an axis" },
  { "kernel", [](vtkPolyData*, vtkLacunaRBFInterpolator* f) { f->SetKernel(7); },
    "Kernel is 7; it must be 0 (ThinPlate), 1 (Linear), 2 (Triharmonic), 3 (Cubic), 4 (Gaussian), "
    "5 (Multiquadric) or 6 (Wendland)" },
  { "solver", [](vtkPolyData*, vtkLacunaRBFInterpolator* f) { f->SetSolver(-1); },
    "Solver is -1; it must be 0 (Auto), 1 (Direct) or 2 (Fast)" },
  { "accuracy", [](vtkPolyData*, vtkLacunaRBFInterpolator* f) { f->SetAccuracy(1.5); },
    "Accuracy is 1.5; it must be from 0 to 1" },
  { "length",
    [](vtkPolyData*, vtkLacunaRBFInterpolator* f)
    {
      f->SetKernel(lacuna::RadialKernel::Gaussian);
      f->SetKernelLength(-3);
    },
    "KernelLength is -3; it must be 0 or more" },
  { "negative tolerance",
    [](vtkPolyData*, vtkLacunaRBFInterpolator* f) { f->SetCenterTolerance(-1); },
    "CenterTolerance is -1; it must be 0 or more" },
  { "tolerance",
    [](vtkPolyData*, vtkLacunaRBFInterpolator* f) { f->SetCenterTolerance(std::nan("")); },
    "CenterTolerance is nan; it must be 0 or more" },
  { "tolerance and errors",
    [](vtkPolyData*, vtkLacunaRBFInterpolator* f)
    {
      f->SetCenterTolerance(0.1);
      f->SetErrorArray("Errors");
    },
    "ErrorArray cannot be used together" },
  { "tolerance and smoothing",
    [](vtkPolyData*, vtkLacunaRBFInterpolator* f)
    {
      f->SetCenterTolerance(1e-6);
      f->SetSmoothing(1e6);
    },
    "lower the smoothing" },
  { "smoothing", [](vtkPolyData*, vtkLacunaRBFInterpolator* f) { f->SetSmoothing(-3); },
    "Smoothing is -3; it must be 0 or more" },
  { "errors",
    [](vtkPolyData* p, vtkLacunaRBFInterpolator* f)
    {
      p->GetPointData()->GetArray("Errors")->SetComponent(3, 0, 0);
      f->SetErrorArray("Errors");
    },
    "node 3" },
  { "spacing", [](vtkPolyData*, vtkLacunaRBFInterpolator* f) { f->SetOutputSpacing(-1, 1, 1); },
    "OutputSpacing is -1; it must be 0 or more" },
  { "memory",
    [](vtkPolyData*, vtkLacunaRBFInterpolator* f) { f->SetOutputSpacing(1e-4, 1e-4, 1e-4); },
    "the interpolated image" },
  { "components", // one of which would fit
    [](vtkPolyData* p, vtkLacunaRBFInterpolator* f)
    {
      vtkNew<vtkDoubleArray> many;
      many->SetName("Many");
      many->SetNumberOfComponents(100000);
      many->SetNumberOfTuples(p->GetNumberOfPoints());
      many->Fill(0);
      p->GetPointData()->AddArray(many);
      f->SetScalarArray("Many");
      f->SetOutputSpacing(0.3, 0.3, 0.3);
    },
    "the interpolated image" },
  { "bounds",
    [](vtkPolyData*, vtkLacunaRBFInterpolator* f)
    { f->SetOutputBounds(0, std::numeric_limits<double>::infinity(), 0, 1, 0, 1); },
    "OutputBounds is inf; it must be a finite number" },
  { "bounds that would be those of the points",
    [](vtkPolyData*, vtkLacunaRBFInterpolator* f)
    { f->SetOutputBounds(0, 1, 1, -std::numeric_limits<double>::infinity(), 0, 1); },
    "OutputBounds is -inf; it must be a finite number" },
};

void CheckErrors()
{
  for (const Case& c : Errors)
  {
    const vtkSmartPointer<vtkPolyData> points = MakePoints(60, false);
    vtkNew<vtkLacunaRBFInterpolator> filter;
    vtkNew<lacunaCheck::Messages> messages;
    messages->Watch(filter);
    messages->Watch(filter->GetExecutive());
    filter->SetOutputSpacing(10, 10, 10);
    c.Spoil(points, filter);
    filter->SetInputData(points);
    filter->Update();
    if (!messages->HasError(c.Expected))
    {
      lacunaCheck::Fail(__FILE__, __LINE__, std::string(c.Name) + ": " + messages->Errors);
    }
    LACUNA_CHECK(filter->GetOutput()->GetNumberOfPoints() == 0);
  }
  vtkNew<vtkLacunaRBFInterpolator> empty;
  vtkNew<vtkPolyData> nothing;
  empty->SetInputData(nothing);
  empty->Update();
  LACUNA_CHECK(empty->GetOutput()->GetNumberOfPoints() == 0);
}
}

int TestRBFInterpolator(int, char*[])
{
  CheckPlanes(false, 300);
  CheckPlanes(true, 300);
  CheckPlanes(true, 2500);
  CheckDefaultsAndPieces();
  CheckCenters(true);
  CheckCenters(false);
  CheckErrorsOfValues();
  CheckErrors();
  return lacunaCheck::Result();
}
