// SPDX-License-Identifier: BSD-3-Clause
// Bad input: an error or warning that says what is wrong, and no half result.
#include "RBFTestMaps.h"
#include "lacunaCheck.h"
#include "lacunaFieldData.h"
#include "vtkCallbackCommand.h"
#include "vtkFieldData.h"
#include "vtkIdTypeArray.h"
#include "vtkLacunaRBFHoleFiller.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSphere.h"

#include <functional>
#include <iostream>
#include <vector>

namespace
{
struct Case
{
  const char* Name;
  std::function<void(TestMap&, vtkLacunaRBFHoleFiller*)> Spoil;
  const char* Expected;
};

void InvalidateAll(TestMap& map, const std::function<bool(vtkIdType)>& keep)
{
  for (vtkIdType i = 0; i < map.Image->GetNumberOfPoints(); ++i)
  {
    if (!keep(i))
    {
      map.Invalidate(i);
    }
  }
}

vtkSmartPointer<vtkPoints> MakePoints(const std::vector<lacuna::Vec3>& list)
{
  auto points = vtkSmartPointer<vtkPoints>::New();
  points->SetDataTypeToDouble();
  for (const lacuna::Vec3& p : list)
  {
    points->InsertNextPoint(p.data());
  }
  return points;
}

const Case Errors[] = {
  { "not a depth map",
    [](TestMap& map, vtkLacunaRBFHoleFiller*) { map.Image->GetPointData()->RemoveArray("Depth"); },
    "'Depth'" },
  { "direction reset by another filter",
    [](TestMap& map, vtkLacunaRBFHoleFiller*)
    { map.Image->SetDirectionMatrix(1, 0, 0, 0, 1, 0, 0, 0, 1); },
    "disagrees" },
  { "perspective map",
    [](TestMap& map, vtkLacunaRBFHoleFiller*) {
      lacuna::FieldData::Set(map.Image, "EyePosition", { 0, 0, -500 }, 3);
    },
    "perspective" },
  { "no depth at all",
    [](TestMap& map, vtkLacunaRBFHoleFiller*)
    { InvalidateAll(map, [](vtkIdType) { return false; }); },
    "no pixel of the depth map has a depth" },
  { "missing array",
    [](TestMap&, vtkLacunaRBFHoleFiller* filler) { filler->SetDefectArray("nowhere"); },
    "'nowhere' with one component; it has 'Depth', 'vtkValidPointMask'" },
  { "array of vectors",
    [](TestMap&, vtkLacunaRBFHoleFiller* filler) { filler->SetSupportArray("Normals"); },
    "SupportArray" },
  { "kernel", [](TestMap&, vtkLacunaRBFHoleFiller* filler) { filler->SetKernel(7); },
    "Kernel is 7; it must be 0 (ThinPlate), 1 (Linear), 2 (Triharmonic), 3 (Cubic), 4 (Gaussian), "
    "5 (Multiquadric) or 6 (Wendland)" },
  { "solver", [](TestMap&, vtkLacunaRBFHoleFiller* filler) { filler->SetSolver(-1); },
    "Solver is -1; it must be 0 (Auto), 1 (Direct) or 2 (Fast)" },
  { "trend", [](TestMap&, vtkLacunaRBFHoleFiller* filler) { filler->SetTrend(2); },
    "Trend is 2; it must be 0 (None) or 1 (Ellipsoid)" },
  { "trend of a plane",
    [](TestMap&, vtkLacunaRBFHoleFiller* filler)
    { filler->SetTrend(vtkLacunaRBFHoleFiller::Ellipsoid); },
    "does not determine an ellipsoid" },
  { "fast without accuracy",
    [](TestMap&, vtkLacunaRBFHoleFiller* filler)
    {
      filler->SetSolver(vtkLacunaRBFHoleFiller::Fast);
      filler->SetAccuracy(0);
    },
    "Accuracy above 0" },
  { "output spacing",
    [](TestMap&, vtkLacunaRBFHoleFiller* filler) { filler->SetOutputSpacing(1, -1, 0); },
    "OutputSpacing is -1 mm; it must be 0 (of the map) or above 0 mm" },
  { "output too fine",
    [](TestMap&, vtkLacunaRBFHoleFiller* filler) { filler->SetOutputSpacing(1e-5, 1e-5, 0); },
    "OutputSpacing" },
  { "cut-off of a kernel that has none",
    [](TestMap&, vtkLacunaRBFHoleFiller* filler)
    {
      filler->SetKernel(lacuna::RadialKernel::Gaussian);
      filler->SetCutoffWavelength(10);
    },
    "power of distance" },
  { "surface without pixel numbers",
    [](TestMap&, vtkLacunaRBFHoleFiller* filler)
    {
      vtkNew<vtkPolyData> surface;
      surface->SetPoints(MakePoints({ { 0, 0, 0 } }));
      filler->SetInputDataObject(vtkLacunaRBFHoleFiller::SurfacePort, surface);
    },
    "'PixelId'" },
  { "surface of another map",
    [](TestMap&, vtkLacunaRBFHoleFiller* filler)
    {
      vtkNew<vtkPolyData> surface;
      surface->SetPoints(MakePoints({ { 0, 0, 0 } }));
      vtkNew<vtkIdTypeArray> ids;
      ids->SetName("PixelId");
      ids->InsertNextValue(80 * 60);
      surface->GetPointData()->AddArray(ids);
      filler->SetInputDataObject(vtkLacunaRBFHoleFiller::SurfacePort, surface);
    },
    "another map" },
  { "control point beside the map",
    [](TestMap& map, vtkLacunaRBFHoleFiller* filler)
    {
      vtkNew<vtkPolyData> control;
      control->SetPoints(MakePoints({ map.GetSurfacePoint(45, 42), map.GetSurfacePoint(450, 42) }));
      filler->SetInputDataObject(vtkLacunaRBFHoleFiller::ControlPointsPort, control);
    },
    "control point 1 lies beside the map" },
  { "control points that contradict each other",
    [](TestMap& map, vtkLacunaRBFHoleFiller* filler)
    {
      vtkNew<vtkPolyData> control;
      const lacuna::Vec3 point = map.GetSurfacePoint(45, 42);
      control->SetPoints(MakePoints({ point, point }));
      filler->SetInputDataObject(vtkLacunaRBFHoleFiller::ControlPointsPort, control);
      vtkNew<vtkDoubleArray> depths;
      depths->SetName("depths");
      depths->InsertNextValue(10);
      depths->InsertNextValue(11);
      control->GetPointData()->AddArray(depths);
      filler->SetControlDepthArray("depths");
    },
    "lie at the same place" },
  { "no depths of control points",
    [](TestMap& map, vtkLacunaRBFHoleFiller* filler)
    {
      vtkNew<vtkPolyData> control;
      control->SetPoints(MakePoints({ map.GetSurfacePoint(45, 42) }));
      filler->SetInputDataObject(vtkLacunaRBFHoleFiller::ControlPointsPort, control);
      filler->SetControlDepthArray("depths");
    },
    "no point array 'depths'" },
  { "prior that is no depth map",
    [](TestMap&, vtkLacunaRBFHoleFiller* filler)
    {
      vtkNew<vtkImageData> image;
      image->SetDimensions(3, 3, 1);
      filler->SetInputDataObject(vtkLacunaRBFHoleFiller::PriorSurfacePort, image);
    },
    "'Depth'" },
  { "prior without a depth",
    [](TestMap&, vtkLacunaRBFHoleFiller* filler)
    {
      TestMap prior;
      InvalidateAll(prior, [](vtkIdType) { return false; });
      filler->SetInputDataObject(vtkLacunaRBFHoleFiller::PriorSurfacePort, prior.Image);
    },
    "no pixel of the prior surface has a depth" },
  { "prior elsewhere",
    [](TestMap&, vtkLacunaRBFHoleFiller* filler)
    {
      TestMap prior;
      const lacuna::Vec3 away = prior.Origin + 500.0 * prior.Right;
      lacuna::DepthMap::SetGeometry(
        prior.Image, { away, prior.Right, prior.Down, prior.View, { 1, 0.8 } });
      filler->SetInputDataObject(vtkLacunaRBFHoleFiller::PriorSurfacePort, prior.Image);
    },
    "nowhere around the defect" },
  { "margin", [](TestMap&, vtkLacunaRBFHoleFiller* filler) { filler->SetSupportMargin(-12); },
    "SupportMargin is -12 mm; it must be above 0 mm" },
  { "spacing", [](TestMap&, vtkLacunaRBFHoleFiller* filler) { filler->SetNodeSpacing(0); },
    "NodeSpacing is 0 mm; it must be above 0 mm" },
  { "output margin", [](TestMap&, vtkLacunaRBFHoleFiller* filler) { filler->SetOutputMargin(-1); },
    "OutputMargin is -1 mm; it must be 0 mm or more" },
  { "smoothing", [](TestMap&, vtkLacunaRBFHoleFiller* filler) { filler->SetSmoothing(-1); },
    "Smoothing is -1 mm^2; it must be 0 (through the nodes) or above 0 mm^2" },
  { "no support",
    [](TestMap& map, vtkLacunaRBFHoleFiller*)
    { InvalidateAll(map, [&](vtkIdType i) { return map.IsInDisc(i, 5); }); },
    "raise SupportMargin" },
  { "two nodes",
    [](TestMap& map, vtkLacunaRBFHoleFiller* f)
    {
      f->SetSupportStepMargin(0);
      InvalidateAll(map, [](vtkIdType i) { return i == 0 || i == 30 * 80 + 20; });
    },
    "at least 3" },
  { "collinear nodes",
    [](TestMap& map, vtkLacunaRBFHoleFiller* f)
    {
      f->SetSupportStepMargin(0);
      InvalidateAll(map, [](vtkIdType i) { return i / 80 == 12; });
    },
    "one line" },
};
}

int TestRBFHoleFillerErrors(int, char*[])
{
  for (const Case& c : Errors)
  {
    std::cout << c.Name << std::endl;
    TestMap map;
    vtkNew<vtkSphere> sphere;
    sphere->SetCenter(map.GetSurfacePoint(45, 42).data());
    sphere->SetRadius(6);
    vtkNew<vtkLacunaRBFHoleFiller> filler;
    filler->SetInputData(map.Image);
    filler->SetDefectRegion(sphere);
    filler->SetSupportMargin(30);
    c.Spoil(map, filler);
    const auto messages = lacunaCheck::Watch(filler);
    filler->Update();
    LACUNA_CHECK(messages->HasError(c.Expected));
    LACUNA_CHECK(filler->GetOutput()->GetNumberOfPoints() == 0);
  }

  {
    // so many nodes that their matrix would exceed the limit: said before anything is allocated
    vtkNew<vtkImageData> large;
    large->SetDimensions(220, 180, 1);
    lacuna::DepthMap::SetGeometry(
      large, { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 }, { 1, 1 } });
    vtkNew<vtkDoubleArray> depth;
    depth->SetName("Depth");
    depth->SetNumberOfTuples(large->GetNumberOfPoints());
    depth->Fill(10);
    depth->SetValue(90 * 220 + 110, std::nan(""));
    large->GetPointData()->AddArray(depth); // no mask: NaN alone marks what has no depth
    vtkNew<vtkLacunaRBFHoleFiller> filler;
    filler->SetInputData(large);
    filler->SetSupportMargin(1000);
    filler->SetSolver(vtkLacunaRBFHoleFiller::Direct);
    const auto messages = lacunaCheck::Watch(filler);
    filler->Update();
    LACUNA_CHECK(messages->HasError("39587 nodes need a matrix of 12538944800 bytes") &&
      messages->HasError("raise NodeSpacing"));
    filler->SetSolver(vtkLacunaRBFHoleFiller::Auto); // fast
    filler->Update();
    LACUNA_CHECK(filler->GetOutput()->GetFieldData()->GetArray("NodeCount")->GetTuple1(0) == 39587);
    LACUNA_CHECK(
      filler->GetOutput()->GetPointData()->GetArray("Depth")->GetTuple1(90 * 220 + 110) > 9.999);
  }
  {
    // flagged valid without a depth
    TestMap map;
    map.Image->GetPointData()->GetArray("Depth")->SetTuple1(30 * 80 + 30, HUGE_VAL);
    map.Image->GetPointData()->GetArray("Depth")->SetTuple1(31 * 80 + 30, std::nan(""));
    vtkNew<vtkLacunaRBFHoleFiller> filler;
    filler->SetInputData(map.Image);
    const auto messages = lacunaCheck::Watch(filler);
    filler->Update();
    LACUNA_CHECK(messages->HasWarning("2 pixels of the depth map are flagged valid"));
    LACUNA_CHECK(
      filler->GetOutput()->GetPointData()->GetArray("FilledMask")->GetTuple1(30 * 80 + 30) == 1);
  }
  for (const double radius : { -6.0, 0.0, std::nan("") })
  {
    TestMap map;
    vtkNew<vtkSphere> sphere;
    sphere->SetCenter(map.GetSurfacePoint(45, 42).data());
    sphere->SetRadius(radius);
    vtkNew<vtkLacunaRBFHoleFiller> filler;
    filler->SetInputData(map.Image);
    filler->SetDefectRegion(sphere);
    const auto messages = lacunaCheck::Watch(filler);
    filler->Update();
    LACUNA_CHECK_CONTAINS(messages->Errors, "DefectRegion: of the sphere Radius is ");
    LACUNA_CHECK(filler->GetOutput()->GetNumberOfPoints() == 0);
  }
  {
    // nothing to fill
    TestMap map;
    vtkNew<vtkLacunaRBFHoleFiller> filler;
    filler->SetInputData(map.Image);
    const auto messages = lacunaCheck::Watch(filler);
    filler->Update();
    LACUNA_CHECK(messages->HasWarning("the defect is empty"));
    vtkPointData* points = filler->GetOutput()->GetPointData();
    for (vtkIdType i = 0; i < map.Image->GetNumberOfPoints(); ++i)
    {
      LACUNA_CHECK(points->GetArray("Depth")->GetTuple1(i) ==
        map.Image->GetPointData()->GetArray("Depth")->GetTuple1(i));
      LACUNA_CHECK(points->GetArray("FilledMask")->GetTuple1(i) == 0);
      LACUNA_CHECK(std::isnan(points->GetArray("Fitted")->GetTuple1(i)));
      LACUNA_CHECK(std::isnan(points->GetArray("Deviation")->GetTuple1(i)));
    }
  }
  {
    // an empty image is no error
    vtkNew<vtkImageData> empty;
    vtkNew<vtkLacunaRBFHoleFiller> filler;
    filler->SetInputData(empty);
    const auto messages = lacunaCheck::Watch(filler);
    filler->Update();
    LACUNA_CHECK(messages->Errors.empty() && messages->Warnings.empty());
  }
  {
    // stopped by the user: no half result
    TestMap map;
    vtkNew<vtkSphere> sphere;
    sphere->SetCenter(map.GetSurfacePoint(45, 42).data());
    sphere->SetRadius(6);
    vtkNew<vtkLacunaRBFHoleFiller> filler;
    filler->SetInputData(map.Image);
    filler->SetDefectRegion(sphere);
    vtkNew<vtkCallbackCommand> stop;
    stop->SetCallback([](vtkObject* caller, unsigned long, void*, void*)
      { static_cast<vtkAlgorithm*>(caller)->SetAbortExecute(1); });
    filler->AddObserver(vtkCommand::ProgressEvent, stop);
    filler->Update();
    LACUNA_CHECK(filler->GetOutput()->GetNumberOfPoints() == 0);
  }
  return lacunaCheck::Result();
}
