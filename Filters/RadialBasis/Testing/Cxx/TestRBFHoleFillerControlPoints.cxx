// SPDX-License-Identifier: BSD-3-Clause
// Control points press the surface in and pull it out, where they are and as far as they say.
#include "RBFTestMaps.h"
#include "lacunaCheck.h"
#include "lacunaProvenance.h"
#include "vtkDoubleArray.h"
#include "vtkLacunaRBFHoleFiller.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"

#include <cmath>
#include <cstring>
#include <vector>

namespace
{
using Filler = vtkLacunaRBFHoleFiller;

void TestControlPoints()
{
  TestMap map;
  vtkNew<Filler> filler;
  filler->SetInputData(map.Image);
  filler->SetAccuracy(0);
  filler->SetDefectRegion(map.MakeDisc(9));
  vtkNew<vtkPolyData> control;
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  control->SetPoints(points);
  // on pixel (column 45, row 52), 41.6 mm down, pressed in by 3 mm along the view
  points->InsertNextPoint(0, 0, 0);
  points->InsertNextPoint(map.GetSurfacePoint(50, 42).data());
  const vtkIdType pixel = 32 * 80 + 35;
  filler->SetInputDataObject(Filler::ControlPointsPort, control);
  for (const double push : { 1.0, 2.0, 3.0 })
  {
    const lacuna::Vec3 p = map.GetSurfacePoint(45, 41.6) + push * map.View;
    points->SetPoint(0, p.data());
    points->Modified();
    control->Modified();
    filler->Update();
    LACUNA_CHECK(std::abs(Get(filler->GetOutput(), "Depth", pixel) -
                   (TestMap::Depth(45, 41.6) + push)) < 1e-8);
  }
  vtkNew<vtkImageData> dragged;
  dragged->DeepCopy(filler->GetOutput());
  LACUNA_CHECK(std::abs(Get(dragged, "Depth", 32 * 80 + 40) - TestMap::Depth(50, 41.6)) < 0.2);
  LACUNA_CHECK(
    lacuna::Provenance::Get(dragged)[0].find("ControlPointsInMap=") != std::string::npos);

  // a new filter gives the same bits, and one with depths instead of positions the same surface
  vtkNew<Filler> fresh;
  fresh->SetInputData(map.Image);
  fresh->SetAccuracy(0);
  fresh->SetDefectRegion(filler->GetDefectRegion());
  fresh->SetInputDataObject(Filler::ControlPointsPort, control);
  fresh->Update();
  vtkDataArray* a = dragged->GetPointData()->GetArray("Fitted");
  LACUNA_CHECK(!std::memcmp(a->GetVoidPointer(0),
    fresh->GetOutput()->GetPointData()->GetArray("Fitted")->GetVoidPointer(0),
    a->GetNumberOfValues() * sizeof(double)));
  vtkNew<vtkDoubleArray> depths;
  depths->SetName("depths");
  depths->InsertNextValue(TestMap::Depth(45, 41.6) + 3);
  depths->InsertNextValue(TestMap::Depth(50, 42));
  control->GetPointData()->AddArray(depths);
  points->SetPoint(0, map.GetSurfacePoint(45, 41.6).data());
  fresh->SetControlDepthArray("depths");
  fresh->Update();
  for (vtkIdType i = 0; i < a->GetNumberOfTuples(); ++i)
  {
    LACUNA_CHECK(std::isnan(a->GetTuple1(i)) ||
      std::abs(Get(fresh->GetOutput(), "Fitted", i) - a->GetTuple1(i)) < 1e-8);
  }
}

lacuna::Vec3 GetNormal(vtkImageData* image, vtkIdType i)
{
  lacuna::Vec3 normal{ 0, 0, 0 };
  image->GetPointData()->GetArray("Normals")->GetTuple(i, normal.data());
  return normal;
}

// One point beside the middle of the defect, pulled 3 mm towards the viewer: in world coordinates
// the surface comes out there, not at a mirrored place, and does the opposite of being pressed in.
void TestPulledOut()
{
  TestMap map;
  vtkNew<vtkPolyData> control;
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  points->SetNumberOfPoints(1);
  control->SetPoints(points);
  vtkNew<Filler> filler;
  filler->SetInputData(map.Image);
  filler->SetAccuracy(0);
  filler->SetDefectRegion(map.MakeDisc(12));
  filler->SetInputDataObject(Filler::ControlPointsPort, control);
  constexpr int column = 41; // x = 51 mm, 6 mm to the right of the middle of the defect
  constexpr int row = 30;    // y = 40 mm, 2 mm above it
  constexpr vtkIdType pixel = row * TestMap::Width + column;
  const auto fill = [&](double push)
  {
    const lacuna::Vec3 p = map.GetSurfacePoint(51, 40) + push * map.View;
    points->SetPoint(0, p.data());
    points->Modified();
    control->Modified();
    filler->Update();
    std::vector<double> moved;
    for (vtkIdType i = 0; i < map.Image->GetNumberOfPoints(); ++i)
    {
      moved.push_back(Get(filler->GetOutput(), "Depth", i) - Get(map.Image, "Depth", i));
    }
    return moved;
  };
  const std::vector<double> in = fill(3);
  const std::vector<double> out = fill(-3);
  LACUNA_CHECK_NEAR(in[pixel], 3, 1e-8);
  LACUNA_CHECK_NEAR(out[pixel], -3, 1e-8);
  int wrong = 0;
  for (vtkIdType i = 0; i < map.Image->GetNumberOfPoints(); ++i)
  {
    wrong += !(std::abs(in[i] + out[i]) < 1e-8); // the fit is linear in what it shall meet
    const lacuna::Vec2 p = map.GetPosition(i);   // the top lies a little nearer to the middle
    wrong += std::hypot(p[0] - 51, p[1] - 40) > 3 && out[i] <= out[pixel];
    wrong += out[i] > 0.05; // nothing swings back inwards
    wrong += !map.IsInDisc(i, 12.001) && out[i] != 0;
  }
  LACUNA_CHECK(wrong == 0);
  // where the point would be with left and right confused
  LACUNA_CHECK(out[row * TestMap::Width + 29] > -1);

  // in the world: the surface's own point there, and its normals lean away from it
  vtkImageData* output = filler->GetOutput();
  const lacuna::DepthMap contract(output);
  const lacuna::Vec3 tip = contract.GetPoint(
    TestMap::FirstColumn + column, TestMap::FirstRow + row, Get(output, "Depth", pixel));
  LACUNA_CHECK_NEAR(Norm(tip - (map.GetSurfacePoint(51, 40) - 3.0 * map.View)), 0, 1e-8);
  const lacuna::Vec3 flat = lacuna::Normalized(0.3 * map.Right - 0.15 * map.Down - map.View);
  const lacuna::Vec3 right = GetNormal(output, pixel + 3) - flat;
  const lacuna::Vec3 left = GetNormal(output, pixel - 3) - flat;
  const lacuna::Vec3 below = GetNormal(output, pixel + 3 * TestMap::Width) - flat;
  const lacuna::Vec3 above = GetNormal(output, pixel - 3 * TestMap::Width) - flat;
  LACUNA_CHECK(Dot(right, map.Right) > 0.1 && Dot(left, map.Right) < -0.1);
  LACUNA_CHECK(Dot(below, map.Down) > 0.1 && Dot(above, map.Down) < -0.1);
  for (const lacuna::Vec3& change : { right, left, below, above })
  {
    LACUNA_CHECK(Dot(change + flat, map.View) < -0.5); // all face the viewer
  }
}
}

int TestRBFHoleFillerControlPoints(int, char*[])
{
  TestControlPoints();
  TestPulledOut();
  return lacunaCheck::Result();
}
