// SPDX-License-Identifier: BSD-3-Clause
#include "TestRefusals.h"
#include "TestSolids.h"
#include "lacunaCheck.h"
#include "lacunaCoordinates.h"
#include "lacunaProvenance.h"
#include "vtkFieldData.h"
#include "vtkLacunaDefectModel.h"
#include "vtkStructuredGrid.h"

namespace
{
using lacuna::Vec3;
using namespace TestSolids;

// Bone below its surface, nothing in the letter down to the base, wherever the viewer stands; the
// grid for the mill is the same surface.
void TestPlace()
{
  int turn = 0;
  for (const Vec3& view : Views)
  {
    const auto geometry = TestSurfaces::Geometry(view, 0.4 * turn++);
    // a disc of Depth was lost, also beside the letter
    const auto lost = [](int i, int j) { return std::hypot(i - 50, j - 30) < 10; };
    vtkNew<vtkLacunaDefectModel> filter;
    filter->SetInputData(FilledMap(geometry));
    filter->SetMargin(3);
    filter->SetDefectDepth(4);
    filter->SetBaseThickness(2);
    filter->Update();
    vtkPolyData* solid = filter->GetOutput();
    auto* top = vtkStructuredGrid::SafeDownCast(filter->GetOutputDataObject(1));
    LACUNA_CHECK(IsClosed(solid));
    const auto matrix = lacuna::FieldData::GetMatrix(
      lacuna::FieldData::Get(top, lacuna::Coordinates::PressToPatientName, 16, 1), 0);
    LACUNA_CHECK_NEAR(matrix.Determinant3(), 1, 1e-12);
    const Vec3 towardsMill = matrix.Vector({ 0, 0, 1 });
    LACUNA_CHECK_NEAR(lacuna::Dot(towardsMill, geometry.View), -1, 1e-12);
    LACUNA_CHECK_NEAR(lacuna::Dot(matrix.Vector({ 1, 0, 0 }), geometry.Right), 1, 1e-12);
    const lacuna::Matrix4 fromWorld = matrix.Inverse();
    const double floor = lacuna::FieldData::Get(top, "FloorHeight", 1, 1)->GetComponent(0, 0);
    int dimensions[3];
    top->GetDimensions(dimensions);
    LACUNA_CHECK(top->GetNumberOfPoints() == vtkIdType{ dimensions[0] } * dimensions[1]);
    int wrong = 0;
    int seen[2] = { 0, 0 };
    for (int j = 14; j <= 46; j += 2)
    {
      for (int i = 30; i <= 68; i += 3)
      {
        const double x = X(i);
        const double y = Y(j);
        const int corners = CornersInLetter(x, y, 1.2, 1.2);
        const bool letter = corners == 4;
        if ((corners != 0 && !letter) || (!letter && lost(i, j)) || lost(i + 1, j) != lost(i, j))
        {
          continue;
        }
        ++seen[letter];
        const double z = TestSurfaces::Depth(x, y);
        wrong += std::abs(GetWinding(solid, Place(geometry, i, j, z + 0.5)) - !letter) > 1e-6;
        wrong += std::abs(GetWinding(solid, Place(geometry, i, j, z + 3.9)) - !letter) > 1e-6;
        wrong += std::abs(GetWinding(solid, Place(geometry, i, j, z - 0.1))) > 1e-6;
        // the base is everywhere
        Vec3 p = fromWorld.Point(Place(geometry, i, j, z));
        const Vec3 inBase = matrix.Point({ p[0], p[1], floor - 1 });
        wrong += std::abs(GetWinding(solid, inBase) - 1) > 1e-6;
        // the grid's point of this pixel
        const double expected = letter ? floor : p[2];
        double nearest = 1e9;
        for (vtkIdType k = 0; k < top->GetNumberOfPoints(); ++k)
        {
          Vec3 q;
          top->GetPoint(k, q.data());
          if (std::hypot(q[0] - p[0], q[1] - p[1]) < 1e-6)
          {
            nearest = std::abs(q[2] - expected);
          }
        }
        wrong += nearest > 1e-9;
      }
    }
    LACUNA_CHECK(seen[0] > 30 && seen[1] > 8);
    LACUNA_CHECK_THAT(wrong == 0, std::to_string(wrong) + " places wrong");
    double low[3];
    double high[3];
    top->GetPoint(0, low);
    top->GetPoint(top->GetNumberOfPoints() - 1, high);
    for (int i = 0; i < 2; ++i)
    {
      LACUNA_CHECK(low[i] < high[i]);
      LACUNA_CHECK_NEAR(low[i] + high[i], 0, 1e-9);
    }
  }
}

void TestRecord()
{
  const auto geometry = TestSurfaces::Geometry({ 1, -2, 0.5 }, 0.3);
  vtkNew<vtkLacunaDefectModel> filter;
  vtkNew<lacunaCheck::Messages> messages;
  messages->Watch(filter);
  auto map = FilledMap(geometry);
  lacuna::Coordinates::Mark(map, lacuna::Coordinates::Patient);
  filter->SetInputData(map);
  filter->SetFloorShape(vtkLacunaDefectModel::Parallel);
  filter->SetDefectDepth(3);
  filter->Update();
  LACUNA_CHECK(IsClosed(filter->GetOutput()));
  LACUNA_CHECK(messages->HasWarning("ends within Margin"));
  for (int port = 0; port < 2; ++port)
  {
    vtkDataObject* output = filter->GetOutputDataObject(port);
    const auto steps = lacuna::Provenance::Get(output);
    LACUNA_CHECK(!steps.empty() && steps.back().find("DefectDepth=3") != std::string::npos);
    LACUNA_CHECK(!output->GetFieldData()->GetArray("ImageToWorld"));
    LACUNA_CHECK(lacuna::FieldData::Get(output, "DefectCount", 1, 1)->GetComponent(0, 0) == 1);
    LACUNA_CHECK(lacuna::Coordinates::Get(output) == (port ? "Press" : "Patient"));
    LACUNA_CHECK(lacuna::Coordinates::GetBeforePress(output) == (port ? "Patient" : ""));
  }
  filter->SetMargin(2);
  filter->Update(); // another size of the grid
  LACUNA_CHECK(
    vtkStructuredGrid::SafeDownCast(filter->GetOutputDataObject(1))->GetNumberOfPoints() > 0);
}

void TestErrors()
{
  const auto geometry = TestSurfaces::Geometry({ 0, 0, 1 }, 0);
  const auto refuses = CheckRefusal<vtkLacunaDefectModel>;
  const auto nothing = [](vtkLacunaDefectModel*) {};
  refuses(TestSurfaces::Map(geometry, false), "run RBF Hole Filler", nothing);
  refuses(TestSurfaces::Map(geometry, true), "FilledMask", nothing);
  refuses(FilledMap(geometry, [](double, double) { return false; }), "no defect", nothing);
  refuses(
    FilledMap(geometry, [](double x, double) { return x < 0; }), "Fitted is no number", nothing);
  auto perspective = FilledMap(geometry);
  lacuna::FieldData::Set(perspective, "EyePosition", { 0, 0, -500 }, 3);
  lacuna::FieldData::Set(perspective, "ViewAngle", { 20 }, 1);
  refuses(perspective, "perspective", nothing);
  const auto map = FilledMap(geometry);
  refuses(map, "Margin is -1", [](vtkLacunaDefectModel* f) { f->SetMargin(-1); });
  refuses(map, "FloorShape is 2", [](vtkLacunaDefectModel* f) { f->SetFloorShape(2); });
  refuses(map, "DefectDepth is 0", [](vtkLacunaDefectModel* f) { f->SetDefectDepth(0); });
  refuses(map, "MaximumHeight is 1", [](vtkLacunaDefectModel* f) { f->SetMaximumHeight(1); });
}
}

int TestDefectModel(int, char*[])
{
  TestPlace();
  TestRecord();
  TestErrors();
  return lacunaCheck::Result();
}
