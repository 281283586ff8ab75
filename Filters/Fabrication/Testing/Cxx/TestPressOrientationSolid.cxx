// SPDX-License-Identifier: BSD-3-Clause
// Moulds of solids: on the known surface, in the right place, and clear words where none can be.
#include "TestShells.h"
#include "lacunaCheck.h"
#include "lacunaCoordinates.h"
#include "lacunaFieldData.h"
#include "lacunaPlanarCurves.h"
#include "vtkDataArray.h"
#include "vtkLacunaPressOrientation.h"
#include "vtkLogger.h"
#include "vtkPointData.h"
#include "vtkStructuredGrid.h"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <string>

namespace
{
using lacuna::Matrix4;
using lacuna::Vec2;
using lacuna::Vec3;

double GetField(vtkDataObject* data, const char* name)
{
  vtkDataArray* array = lacuna::FieldData::Find(data, name, 1, 1);
  return array ? array->GetComponent(0, 0) : std::nan("");
}

Matrix4 GetPressToPatient(vtkDataObject* data)
{
  return lacuna::FieldData::GetMatrix(
    lacuna::FieldData::Get(data, lacuna::Coordinates::PressToPatientName, 16, 1), 0);
}

// mm from the ellipsoid, outwards; exact near it.
double GetHeight(const Vec3& p)
{
  double value = -1;
  Vec3 gradient{ 0, 0, 0 };
  for (int a = 0; a < 3; ++a)
  {
    const double square = TestShells::Axes[a] * TestShells::Axes[a];
    value += p[a] * p[a] / square;
    gradient[a] = 2 * p[a] / square;
  }
  return value / lacuna::Norm(gradient);
}

// The mould's true surface is the ellipsoid, or as far from it as the sheet is thick, and the defect is
// the outline, which no mirror image is.
void TestPlace()
{
  TestShells::Shell shell;
  shell.ToWorld =
    Matrix4::Translation({ 40, -110, 250 }) * Matrix4::Rotation({ 0.3, -0.5, 0.8 }, 2.1);
  const Matrix4 back = shell.ToWorld.Inverse();
  const auto solid = TestShells::Make(shell);
  lacuna::Coordinates::Mark(solid, lacuna::Coordinates::Patient);
  const lacuna::Loop outline = TestShells::Outlines(shell).front();
  for (const int mould : { vtkLacunaPressOrientation::Female, vtkLacunaPressOrientation::Male })
  {
    for (const int seating : { vtkLacunaPressOrientation::Onlay, vtkLacunaPressOrientation::Inlay })
    {
      vtkNew<vtkLacunaPressOrientation> press;
      const auto messages = lacunaCheck::Watch(press);
      press->SetInputData(solid);
      press->SetMould(mould);
      press->SetSeating(seating);
      press->SetFlangeWidth(20);
      press->Update();
      LACUNA_CHECK_THAT(messages->Errors.empty() && messages->Warnings.empty(),
        messages->Errors + messages->Warnings);
      vtkStructuredGrid* grid = press->GetOutput();
      LACUNA_CHECK_NEAR(GetField(grid, "SingleValued"), 1, 0);
      LACUNA_CHECK(GetField(grid, "FaceDeviation") < 0.005);
      LACUNA_CHECK(lacuna::Coordinates::GetBeforePress(grid) == lacuna::Coordinates::Patient);
      const Matrix4 toPatient = GetPressToPatient(grid);
      LACUNA_CHECK_NEAR(toPatient.Determinant3(), 1, 1e-12);
      const double wanted = (mould == vtkLacunaPressOrientation::Female ? 0.7 : 0) -
        (seating == vtkLacunaPressOrientation::Inlay ? 0.7 : 0);
      vtkDataArray* regions =
        grid->GetPointData()->GetArray(vtkLacunaPressOrientation::PressRegionName);
      vtkDataArray* defect =
        grid->GetPointData()->GetArray(vtkLacunaPressOrientation::DefectMaskName);
      double within = 0;
      double beside = 0;
      int wrong = 0;
      int count = 0;
      for (vtkIdType k = 0; k < grid->GetNumberOfPoints(); ++k)
      {
        Vec3 p;
        grid->GetPoint(k, p.data());
        LACUNA_CHECK(mould == vtkLacunaPressOrientation::Female ? p[2] <= 0 : p[2] >= 0);
        const Vec3 q = back.Point(toPatient.Point(p));
        const bool inDefect = defect->GetComponent(k, 0) != 0;
        if (regions->GetComponent(k, 0) == 2)
        {
          double& off = inDefect ? within : beside;
          off = std::max(off, std::abs(GetHeight(q) - wanted));
        }
        // the foot on the ellipsoid, and clear of the outline
        const Vec3 foot = q - GetHeight(q) * TestShells::OuterNormal({ q[0], q[1] });
        int inside = 0;
        for (const double angle : { 0.0, 1.5, 3.0, 4.5 })
        {
          inside += lacuna::IsInside(
            { outline }, Vec2{ foot[0] + 1.2 * std::cos(angle), foot[1] + 1.2 * std::sin(angle) });
        }
        if (regions->GetComponent(k, 0) == 2 && (inside == 0 || inside == 4))
        {
          wrong += inDefect != (inside == 4);
          count += inDefect;
        }
      }
      LACUNA_CHECK_THAT(within < 0.01, "on the face " + std::to_string(within) + " mm off");
      LACUNA_CHECK_THAT(beside < 0.1, "in the margin " + std::to_string(beside) + " mm off");
      LACUNA_CHECK_THAT(wrong == 0 && count > 1000, std::to_string(wrong) + " wrong");
      std::cout << "mould " << mould << ", seating " << seating << ": " << within
                << " mm off on the face, " << beside << " mm in a margin of 5 mm, walls up to "
                << GetField(grid, "DraftAngle") << " degrees\n";
    }
  }
}

// A cap of a ball, in degrees from its middle; an outer face alone.
vtkSmartPointer<vtkPolyData> MakeCap(double angle)
{
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkCellArray> cells;
  vtkNew<vtkUnsignedCharArray> faces;
  faces->SetName("ImplantFace");
  constexpr int rings = 30;
  constexpr int around = 80;
  points->InsertNextPoint(0, 0, 60);
  for (int j = 1; j <= rings; ++j)
  {
    for (int i = 0; i < around; ++i)
    {
      const double a = angle * TestShells::Pi / 180 * j / rings;
      const double b = 2 * TestShells::Pi * i / around;
      points->InsertNextPoint(
        60 * std::sin(a) * std::cos(b), 60 * std::sin(a) * std::sin(b), 60 * std::cos(a));
    }
  }
  const auto at = [](int j, int i) -> vtkIdType { return 1 + (j - 1) * around + i % around; };
  for (int i = 0; i < around; ++i)
  {
    cells->InsertNextCell({ 0, at(1, i), at(1, i + 1) });
    for (int j = 1; j < rings; ++j)
    {
      cells->InsertNextCell({ at(j, i), at(j + 1, i), at(j, i + 1) });
      cells->InsertNextCell({ at(j, i + 1), at(j + 1, i), at(j + 1, i + 1) });
    }
  }
  for (vtkIdType k = 0; k < cells->GetNumberOfCells(); ++k)
  {
    faces->InsertNextValue(0);
  }
  auto cap = vtkSmartPointer<vtkPolyData>::New();
  cap->SetPoints(points);
  cap->SetPolys(cells);
  cap->GetCellData()->SetScalars(faces);
  return cap;
}

void TestSteep()
{
  for (const double angle : { 40.0, 68.0, 100.0 })
  {
    vtkNew<vtkLacunaPressOrientation> press;
    const auto messages = lacunaCheck::Watch(press);
    press->SetInputData(MakeCap(angle));
    press->SetSeating(vtkLacunaPressOrientation::Inlay);
    press->SetPlateMargin(1);
    press->Update();
    LACUNA_CHECK_THAT(messages->HasWarning("a sheet can hardly follow the mould") == (angle == 68),
      messages->Warnings);
    LACUNA_CHECK_THAT(
      messages->HasError("no direction of pressing sees all of the face") == (angle == 100),
      messages->Errors);
    if (angle == 100)
    {
      LACUNA_CHECK_THAT(messages->HasError("98 degrees steep"), messages->Errors); // of triangles
      LACUNA_CHECK(press->GetOutput()->GetNumberOfPoints() == 0);
    }
    else
    {
      LACUNA_CHECK(GetField(press->GetOutput(), "DraftAngle") >= angle - 1.5);
    }
  }
}

void TestRefusals()
{
  const auto refuses = [](vtkPolyData* solid, const std::string& words)
  {
    vtkNew<vtkLacunaPressOrientation> press;
    const auto messages = lacunaCheck::Watch(press);
    press->SetInputData(solid);
    press->Update();
    LACUNA_CHECK_THAT(messages->HasError(words), words + ": " + messages->Errors);
    LACUNA_CHECK(press->GetOutput()->GetNumberOfPoints() == 0);
  };
  auto cap = MakeCap(30);
  lacuna::Coordinates::MarkMirrored(cap, { 0, 0, 0 }, { 1, 0, 0 });
  refuses(cap, "mirror image");
  cap = MakeCap(30);
  cap->GetCellData()->GetArray(0)->SetName("Other");
  refuses(cap, "ImplantFace");
  cap = MakeCap(30);
  cap->GetCellData()->GetArray(0)->FillComponent(0, 1);
  refuses(cap, "no triangle of the surface is of the outer face");
  cap = MakeCap(30);
  cap->GetPoints()->SetPoint(9, std::nan(""), 0, 0);
  refuses(cap, "point 9 of the surface is not finite");
}
}

int TestPressOrientationSolid(int, char*[])
{
  vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_WARNING);
  TestPlace();
  TestSteep();
  TestRefusals();
  return lacunaCheck::Result();
}
