// SPDX-License-Identifier: BSD-3-Clause
#include "TestRefusals.h"
#include "TestSolids.h"
#include "lacunaCheck.h"
#include "lacunaProvenance.h"
#include "vtkCellData.h"
#include "vtkFieldData.h"
#include "vtkLacunaImplantPlate.h"
#include "vtkPolyData.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <string>

namespace
{
using lacuna::Vec3;
using namespace TestSolids;

double GetField(vtkPolyData* plate, const char* name, vtkIdType tuple = 0, int component = 0)
{
  vtkDataArray* array = plate->GetFieldData()->GetArray(name);
  return array && tuple < array->GetNumberOfTuples() ? array->GetComponent(tuple, component)
                                                     : TestSurfaces::NaN;
}

// The plate fills the letter and nothing else, wherever the viewer stands.
void TestPlace()
{
  int turn = 0;
  vtkNew<vtkPolyData> first;
  lacuna::DepthMap::Geometry firstGeometry{};
  for (const Vec3& view : Views)
  {
    const auto geometry = TestSurfaces::Geometry(view, 0.4 * turn++);
    vtkNew<vtkLacunaImplantPlate> filter;
    filter->SetInputData(FilledMap(geometry));
    filter->SetThickness(2);
    filter->SetEdgeClearance(0);
    filter->SetEdgeShape(vtkLacunaImplantPlate::Square);
    filter->Update();
    vtkPolyData* plate = filter->GetOutput();
    LACUNA_CHECK(IsClosed(plate));
    int wrong = 0;
    for (int j = 14; j <= 46; j += 2)
    {
      for (int i = 30; i <= 68; i += 3)
      {
        const double x = X(i);
        const double y = Y(j);
        const int corners = CornersInLetter(x, y, 1.2, 1.2);
        if (corners == 0 || corners == 4)
        {
          const double winding =
            GetWinding(plate, Place(geometry, i, j, TestSurfaces::Depth(x, y) + 1.0));
          wrong += std::abs(winding - (corners == 4)) > 1e-6;
          // nothing is in front of the fitted surface
          wrong += std::abs(GetWinding(
                     plate, Place(geometry, i, j, TestSurfaces::Depth(x, y) - 0.1))) > 1e-6;
        }
      }
    }
    LACUNA_CHECK_THAT(wrong == 0,
      std::to_string(wrong) +
        " points inside that should be outside, "
        "or the other way round");
    // the same plate from everywhere
    if (first->GetNumberOfPoints() == 0)
    {
      first->DeepCopy(plate);
      firstGeometry = geometry;
      continue;
    }
    LACUNA_CHECK(plate->GetNumberOfPoints() == first->GetNumberOfPoints());
    double most = 0;
    for (vtkIdType k = 0; k < plate->GetNumberOfPoints(); ++k)
    {
      Vec3 p;
      Vec3 q;
      plate->GetPoint(k, p.data());
      first->GetPoint(k, q.data());
      p = p - geometry.Origin;
      q = q - firstGeometry.Origin;
      const Vec3 difference{ lacuna::Dot(p, geometry.Right) - lacuna::Dot(q, firstGeometry.Right),
        lacuna::Dot(p, geometry.Down) - lacuna::Dot(q, firstGeometry.Down),
        lacuna::Dot(p, geometry.View) - lacuna::Dot(q, firstGeometry.View) };
      most = std::max(most, lacuna::Norm(difference));
    }
    LACUNA_CHECK_THAT(most < 1e-9, "points differ by " + std::to_string(most) + " mm");
  }
}

// Screws through an overlap, over bone that is known.
void TestHoles()
{
  const auto geometry = TestSurfaces::Geometry({ 1, -2, 0.5 }, 0.3);
  const auto disc = [](double x, double y) { return std::hypot(x, y) < 5; };
  const auto picked = [&](double x, double y)
  {
    return geometry.Origin + (x + 24.5) * geometry.Right + (y + 22.5) * geometry.Down +
      TestSurfaces::Depth(x, y) * geometry.View;
  };
  vtkNew<vtkLacunaImplantPlate> filter;
  vtkNew<lacunaCheck::Messages> messages;
  messages->Watch(filter);
  filter->SetInputData(FilledMap(geometry, disc));
  filter->SetThickness(0.7);
  filter->SetSide(vtkLacunaImplantPlate::Outward);
  filter->SetEdgeClearance(-5);
  filter->SetBevel(0.3);
  filter->SetHoleDiameter(1.6);
  const Vec3 left = picked(-7.4, 0);
  const Vec3 right = picked(7.4, 0);
  filter->AddHolePoint(left[0], left[1], left[2]);
  filter->AddHolePoint(right[0], right[1], right[2]);
  filter->SetMinimumBoneThickness(4.5);
  filter->Update();
  vtkPolyData* plate = filter->GetOutput();
  LACUNA_CHECK(IsClosed(plate));
  LACUNA_CHECK_NEAR(GetField(plate, "MinimumThickness"), 0.7, 0.007);
  // obliquely, bone is thinner than along the ray
  const double bone[2] = { GetField(plate, "HoleBoneThickness", 0),
    GetField(plate, "HoleBoneThickness", 1) };
  LACUNA_CHECK(bone[0] > 5.9 && bone[0] < 6.4);
  LACUNA_CHECK(bone[1] > 3.1 && bone[1] < 3.5);
  LACUNA_CHECK(messages->HasWarning("screw hole 2 lies over bone only"));
  LACUNA_CHECK(!messages->HasWarning("screw hole 1"));
  for (int k = 0; k < 2; ++k)
  {
    Vec3 center;
    Vec3 axis;
    for (int i = 0; i < 3; ++i)
    {
      center[i] = GetField(plate, "HoleCenters", k, i);
      axis[i] = GetField(plate, "HoleAxes", k, i);
    }
    LACUNA_CHECK(std::abs(lacuna::Norm(center - (k ? right : left)) - 0.7) < 1e-4);
    LACUNA_CHECK(lacuna::Dot(axis, geometry.View) < 0);
    LACUNA_CHECK(std::abs(GetWinding(plate, center - 0.35 * axis)) < 1e-6); // open
    const Vec3 beside = lacuna::Normalized(lacuna::Cross(axis, geometry.Down));
    LACUNA_CHECK(std::abs(GetWinding(plate, center - 0.35 * axis + 1.0 * beside) - 1) < 1e-6);
  }
  LACUNA_CHECK(std::abs(GetField(plate, "Mass") - 1.3e-3 * GetField(plate, "Volume")) < 1e-12);
  const auto steps = lacuna::Provenance::Get(plate);
  LACUNA_CHECK(!steps.empty() && steps.back().find("HoleDiameter=1.6") != std::string::npos);

  // bone that was not measured is not passed over
  LACUNA_CHECK(!messages->HasWarning("was not measured"));
  auto unmeasured = FilledMap(geometry, disc);
  unmeasured->GetPointData()->RemoveArray("Thickness");
  filter->SetInputData(unmeasured);
  filter->SetMinimumBoneThickness(0);
  filter->Update();
  LACUNA_CHECK(std::isnan(GetField(plate, "HoleBoneThickness", 1)));
  LACUNA_CHECK(!messages->HasWarning("was not measured"));
  filter->SetMinimumBoneThickness(3);
  filter->Update();
  LACUNA_CHECK(messages->HasWarning("screw hole 1, 2 was not measured"));
  LACUNA_CHECK(messages->HasWarning("ComputeThickness"));

  filter->SetSide(vtkLacunaImplantPlate::Inward);
  filter->Update();
  LACUNA_CHECK(messages->HasWarning("overlaps the bone"));
  filter->RemoveAllHolePoints();
  filter->Update();
  LACUNA_CHECK(plate->GetFieldData()->GetArray("HoleCenters")->GetNumberOfTuples() == 0);
}

// Points marked with the mouse are holes like those typed; patches of them are one hole each.
void TestMarks()
{
  const auto geometry = TestSurfaces::Geometry({ 1, -2, 0.5 }, 0.3);
  const auto disc = [](double x, double y) { return std::hypot(x, y) < 5; };
  const auto picked = [&](double x, double y)
  {
    return geometry.Origin + (x + 24.5) * geometry.Right + (y + 22.5) * geometry.Down +
      TestSurfaces::Depth(x, y) * geometry.View;
  };
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (const double x : { 7.2, 7.4, 7.6 })
  {
    for (const double y : { -0.3, 0.0, 0.3 })
    {
      points->InsertNextPoint(picked(x, y).data());
      points->InsertNextPoint(picked(-x, 0.5 * y).data());
    }
  }
  vtkNew<vtkPolyData> marks; // no cells: what Extract Selection gives has only vertices
  marks->SetPoints(points);
  vtkNew<vtkLacunaImplantPlate> filter;
  vtkNew<lacunaCheck::Messages> messages;
  messages->Watch(filter);
  messages->Watch(filter->GetExecutive());
  filter->SetInputData(FilledMap(geometry, disc));
  filter->SetInputData(1, marks);
  filter->SetThickness(0.7);
  filter->SetSide(vtkLacunaImplantPlate::Outward);
  filter->SetEdgeClearance(-5);
  filter->SetBevel(0.3);
  filter->SetHoleDiameter(1.6);
  const Vec3 typed = picked(0, 7.4);
  filter->AddHolePoint(typed[0], typed[1], typed[2]);
  filter->Update();
  vtkPolyData* plate = filter->GetOutput();
  LACUNA_CHECK(IsClosed(plate));
  vtkDataArray* centers = plate->GetFieldData()->GetArray("HoleCenters");
  LACUNA_CHECK(centers && centers->GetNumberOfTuples() == 3);
  const Vec3 expected[3] = { typed, picked(7.4, 0), picked(-7.4, 0) };
  for (int k = 0; centers && k < 3; ++k)
  {
    Vec3 center;
    centers->GetTuple(k, center.data());
    LACUNA_CHECK_NEAR(lacuna::Norm(center - expected[k]), 0.7, 0.05);
  }
  const auto steps = lacuna::Provenance::Get(plate);
  LACUNA_CHECK(!steps.empty());
  const std::string step = steps.empty() ? std::string() : steps.back();
  LACUNA_CHECK(step.find(" Side=Outward EdgeClearance=") != std::string::npos);
  const std::size_t drilled = step.find(" HolePoints="); // those of marks, too
  LACUNA_CHECK(drilled != std::string::npos);
  const std::string holes = step.substr(std::min(drilled, step.size()));
  LACUNA_CHECK(std::count(holes.begin(), holes.begin() + holes.find(" Min"), ',') == 8);

  points->InsertPoint(19, std::nan(""), 0, 0);
  marks->Modified();
  filter->Update();
  LACUNA_CHECK(messages->HasError("screw hole"));
  points->SetNumberOfPoints(20001);
  marks->Modified();
  filter->Update();
  LACUNA_CHECK(messages->HasError("HoleMarks has 20001 points"));
  points->SetNumberOfPoints(0);
  marks->Modified();
  filter->RemoveAllHolePoints();
  filter->Update();
  LACUNA_CHECK(IsClosed(filter->GetOutput()));
}

// Of a plate that is all edge nothing is measured, and no place is told.
void TestSmall()
{
  const auto geometry = TestSurfaces::Geometry({ 1, -2, 0.5 }, 0.3);
  vtkNew<vtkLacunaImplantPlate> filter;
  filter->SetInputData(
    FilledMap(geometry, [](double x, double y) { return std::hypot(x, y) < 3; }));
  filter->SetThickness(3.4);
  filter->SetSide(vtkLacunaImplantPlate::Outward);
  filter->SetEdgeShape(1);
  filter->SetEdgeClearance(1);
  filter->SetBevel(0);
  filter->SetCornerRadius(0.3);
  filter->SetTriangleSize(1.3);
  filter->Update();
  vtkPolyData* plate = filter->GetOutput();
  LACUNA_CHECK(IsClosed(plate));
  LACUNA_CHECK(GetField(plate, "Volume") > 0);
  LACUNA_CHECK(std::isnan(GetField(plate, "MinimumThickness")));
  LACUNA_CHECK(std::isnan(GetField(plate, "MinimumCurvatureRadius")));
  LACUNA_CHECK(std::isnan(GetField(plate, "TightestPoint")));
}

void TestErrors()
{
  const auto geometry = TestSurfaces::Geometry({ 0, 0, 1 }, 0);
  const auto refuses = CheckRefusal<vtkLacunaImplantPlate>;
  const auto nothing = [](vtkLacunaImplantPlate*) {};
  refuses(TestSurfaces::Map(geometry, false), "run RBF Hole Filler", nothing);
  refuses(TestSurfaces::Map(geometry, true), "FilledMask", nothing);
  const auto never = [](double, double) { return false; };
  refuses(FilledMap(geometry, never), "no defect", nothing);
  refuses(
    FilledMap(geometry, [](double x, double) { return x < 0; }), "Fitted is no number", nothing);
  auto holed = FilledMap(geometry);
  holed->GetPointData()->GetArray("Fitted")->SetComponent(90 * 15 + 20, 0, TestSurfaces::NaN);
  refuses(holed, "Fitted has a hole", nothing);
  auto perspective = FilledMap(geometry);
  lacuna::FieldData::Set(perspective, "EyePosition", { 0, 0, -500 }, 3);
  lacuna::FieldData::Set(perspective, "ViewAngle", { 20 }, 1);
  refuses(perspective, "perspective", nothing);
  const auto map = FilledMap(geometry);
  refuses(map, "Thickness is -1", [](vtkLacunaImplantPlate* f) { f->SetThickness(-1); });
  refuses(map, "Side is 7", [](vtkLacunaImplantPlate* f) { f->SetSide(7); });
  refuses(map, "EdgeShape is 3", [](vtkLacunaImplantPlate* f) { f->SetEdgeShape(3); });
  refuses(map, "Density is 0", [](vtkLacunaImplantPlate* f) { f->SetDensity(0); });
  refuses(map, "screw hole 1", [](vtkLacunaImplantPlate* f) { f->AddHolePoint(0, 0, 0); });
}
}

int TestImplantPlate(int, char*[])
{
  TestPlace();
  TestHoles();
  TestMarks();
  TestSmall();
  TestErrors();
  return lacunaCheck::Result();
}
