// SPDX-License-Identifier: BSD-3-Clause
// Inputs and properties that make no surface are errors which say what is wrong.
#include "lacunaCheck.h"
#include "lacunaEllipsoid.h"
#include "vtkLacunaRBFSurface.h"
#include "vtkRegularPolygonSource.h"
#include "vtkSphereSource.h"

#include <cmath>
#include <functional>
#include <limits>
#include <string>

namespace
{
using namespace lacunaEllipsoid;

void CheckError(const std::function<void(vtkLacunaRBFSurface*)>& spoil, const std::string& text)
{
  vtkNew<vtkLacunaRBFSurface> filter;
  filter->SetInputData(MakePoints(300, true));
  spoil(filter);
  vtkNew<lacunaCheck::Messages> messages;
  messages->Watch(filter);
  messages->Watch(filter->GetExecutive());
  filter->Update();
  if (!messages->HasError(text))
  {
    lacunaCheck::Fail(__FILE__, __LINE__, "no error with '" + text + "' but: " + messages->Errors);
  }
  LACUNA_CHECK(filter->GetOutput()->GetNumberOfPoints() == 0);
}

void CheckErrors()
{
  using Filter = vtkLacunaRBFSurface;
  CheckError([](Filter* f) { f->SetKernel(2); },
    "Kernel is 2; it must be 0 (Biharmonic) or 1 (Triharmonic)");
  CheckError([](Filter* f) { f->SetSmoothing(-1); },
    "Smoothing is -1 mm; it must be 0 (estimated) or above 0 mm");
  CheckError([](Filter* f) { f->SetTolerance(0); }, "Tolerance is 0 mm; it must be above 0 mm");
  CheckError([](Filter* f) { f->SetErrorArray("Nothing"); }, "no point array 'Nothing'");
  CheckError([](Filter* f) { f->SetSideArray("Nothing"); }, "has a point array 'Nothing'");
  CheckError([](Filter* f) { f->SetDistanceSpacing(1); }, "needs OutputBounds on all axes");
  CheckError(
    [](Filter* f)
    {
      f->SetDistanceSpacing(1);
      f->CapBoundaryOff();
    },
    "needs CapBoundary");
  CheckError([](Filter* f) { f->SetOutputBounds(0, std::nan(""), 0, 1, 0, 1); },
    "OutputBounds is nan mm; it must be a finite number");
  CheckError([](Filter* f) { f->SetOutputBounds(500, 600, 0, 1, 0, 1); }, "outside of the bounds");
  CheckError(
    [](Filter* f)
    {
      vtkSmartPointer<vtkPolyData> data = MakePoints(300, true);
      vtkNew<vtkDoubleArray> errors;
      errors->SetName("Error");
      errors->SetNumberOfValues(300);
      errors->Fill(1);
      errors->SetValue(5, 0);
      data->GetPointData()->AddArray(errors);
      f->SetInputData(data);
      f->SetErrorArray("Error");
    },
    "ErrorArray: 'Error' is 0");
  CheckError(
    [](Filter* f)
    {
      vtkSmartPointer<vtkPolyData> data = MakeOutlines(true);
      vtkNew<vtkDoubleArray> sides;
      sides->SetName("Side");
      sides->SetNumberOfValues(data->GetNumberOfPoints());
      sides->Fill(-1);
      data->GetPointData()->AddArray(sides);
      f->SetInputData(data);
      f->SetSideArray("Side");
    },
    "which lies on the surface");
  CheckError(
    [](Filter* f)
    {
      vtkNew<vtkSphereSource> mesh;
      mesh->Update();
      vtkNew<vtkDoubleArray> sides;
      sides->SetName("Side");
      sides->SetNumberOfValues(mesh->GetOutput()->GetNumberOfPoints());
      sides->Fill(0);
      sides->SetValue(3, 1);
      mesh->GetOutput()->GetPointData()->AddArray(sides);
      f->SetInputData(mesh->GetOutput());
      f->SetSideArray("Side");
    },
    "which lies on the surface");
  CheckError([](Filter* f) { f->SetInputData(vtkNew<vtkPolyData>()); }, "no points of a surface");
  CheckError([](Filter* f) { f->SetInputData(MakePoints(5, true)); }, "needs 10 or more");
  CheckError([](Filter* f) { f->SetInputData(MakeOutlines(false)); }, "is not closed");
  CheckError(
    [](Filter* f)
    {
      vtkSmartPointer<vtkPolyData> data = MakePoints(300, true);
      vtkDataArray* normals = data->GetPointData()->GetArray("Normals");
      for (vtkIdType i = 0; i < 900; ++i)
      {
        normals->SetComponent(
          i / 3, static_cast<int>(i % 3), -normals->GetComponent(i / 3, static_cast<int>(i % 3)));
      }
      f->SetInputData(data);
    },
    "point into the solid");
  CheckError(
    [](Filter* f)
    {
      vtkSmartPointer<vtkPolyData> data = MakePoints(300, true);
      data->GetPoints()->SetPoint(7, 1, std::numeric_limits<double>::quiet_NaN(), 2);
      f->SetInputData(data);
    },
    "point 7");
  CheckError(
    [](Filter* f)
    {
      // each point twice, with opposite normals
      vtkSmartPointer<vtkPolyData> data = MakePoints(300, true);
      vtkDataArray* normals = data->GetPointData()->GetArray("Normals");
      for (vtkIdType i = 0; i < 300; ++i)
      {
        data->GetPoints()->InsertNextPoint(data->GetPoint(i));
        double n[3];
        normals->GetTuple(i, n);
        normals->InsertNextTuple3(-n[0], -n[1], -n[2]);
      }
      f->SetInputData(data);
    },
    "normals contradict each other");
  CheckError(
    [](Filter* f)
    {
      vtkNew<vtkPoints> points;
      for (int i = 0; i < 50; ++i)
      {
        points->InsertNextPoint(i, 2 * i, 3);
      }
      vtkNew<vtkPolyData> data;
      data->SetPoints(points);
      f->SetInputData(data);
    },
    "lie on lines");
  CheckError(
    [](Filter* f)
    {
      vtkNew<vtkPoints> points;
      for (int i = 0; i < 400; ++i)
      {
        points->InsertNextPoint(i % 20, i / 20, 5);
      }
      vtkNew<vtkPolyData> data;
      data->SetPoints(points);
      f->SetInputData(data);
    },
    "lie in one plane");
  CheckError(
    [](Filter* f)
    {
      vtkNew<vtkPoints> points;
      for (int i = 0; i < 50; ++i)
      {
        points->InsertNextPoint(1, 2, 3);
      }
      vtkNew<vtkPolyData> data;
      data->SetPoints(points);
      f->SetInputData(data);
    },
    "lie in one place, at (1, 2, 3) mm");
  CheckError(
    [](Filter* f)
    {
      vtkNew<vtkRegularPolygonSource> outline;
      outline->GeneratePolygonOff();
      outline->SetNumberOfSides(30);
      outline->SetRadius(20);
      outline->Update();
      f->SetInputData(outline->GetOutput());
    },
    "outlines lie in one plane");
  CheckError(
    [](Filter* f)
    {
      vtkNew<vtkSphereSource> open;
      open->SetStartPhi(30);
      open->Update();
      f->SetInputData(1, open->GetOutput());
    },
    "not closed");
}
}

int TestRBFSurfaceErrors(int, char*[])
{
  CheckErrors();
  return lacunaCheck::Result();
}
