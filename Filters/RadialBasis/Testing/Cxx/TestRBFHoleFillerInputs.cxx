// SPDX-License-Identifier: BSD-3-Clause
// Optional inputs: selections, prior surfaces; output on another grid.
#include "RBFTestMaps.h"
#include "lacunaCheck.h"
#include "lacunaParameterText.h"
#include "lacunaProvenance.h"
#include "vtkCylinder.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkIdTypeArray.h"
#include "vtkLacunaRBFHoleFiller.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSelection.h"
#include "vtkSelectionNode.h"
#include "vtkSphere.h"
#include "vtkTransform.h"

#include <cmath>
#include <cstring>
#include <functional>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

namespace
{
using Filler = vtkLacunaRBFHoleFiller;

// A surface with a point for each pixel that has a depth, in reverse order.
vtkSmartPointer<vtkPolyData> MakeSurface(const TestMap& map)
{
  auto surface = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkPoints> points;
  vtkNew<vtkIdTypeArray> ids;
  ids->SetName("PixelId");
  for (vtkIdType i = map.Image->GetNumberOfPoints() - 1; i >= 0; --i)
  {
    if (Get(map.Image, "vtkValidPointMask", i) != 0)
    {
      const lacuna::Vec2 p = map.GetPosition(i);
      points->InsertNextPoint(map.GetSurfacePoint(p[0], p[1]).data());
      ids->InsertNextValue(i);
    }
  }
  surface->SetPoints(points);
  surface->GetPointData()->SetPedigreeIds(ids);
  return surface;
}

vtkSmartPointer<vtkSelection> MakeSelection(int content, const std::vector<vtkIdType>& ids)
{
  vtkNew<vtkIdTypeArray> list;
  list->SetName("PixelId");
  for (const vtkIdType id : ids)
  {
    list->InsertNextValue(id);
  }
  vtkNew<vtkSelectionNode> node;
  node->SetFieldType(vtkSelectionNode::POINT);
  node->SetContentType(content);
  node->SetSelectionList(list);
  auto selection = vtkSmartPointer<vtkSelection>::New();
  selection->AddNode(node);
  return selection;
}

std::string GetStep(Filler* filler)
{
  const std::vector<std::string> steps = lacuna::Provenance::Get(filler->GetOutput());
  return steps.empty() ? "" : steps.back();
}

void CheckFilled(
  const TestMap& map, vtkImageData* output, const std::function<bool(vtkIdType)>& expected)
{
  int wrong = 0;
  for (vtkIdType i = 0; i < map.Image->GetNumberOfPoints(); ++i)
  {
    wrong += (Get(output, "FilledMask", i) != 0) != expected(i);
  }
  LACUNA_CHECK(output->GetNumberOfPoints() == map.Image->GetNumberOfPoints() && wrong == 0);
}

void TestSelections()
{
  TestMap map;
  std::vector<vtkIdType> patch;
  std::vector<vtkIdType> ring;
  for (vtkIdType i = 0; i < map.Image->GetNumberOfPoints(); ++i)
  {
    if (map.IsInDisc(i, 4))
    {
      map.Invalidate(i); // points of it cannot be selected on the surface
    }
    else if (map.IsInDisc(i, 7.5))
    {
      ring.push_back(i);
    }
    if (map.IsInDisc(i, 3))
    {
      patch.push_back(i);
    }
  }
  const auto disc = [&](vtkIdType i) { return map.IsInDisc(i, 7.5); };
  const auto surface = MakeSurface(map);

  // the ring around the hole, by pedigree ids: the hole is taken with it
  vtkNew<Filler> filler;
  filler->SetInputData(map.Image);
  filler->SetInputDataObject(Filler::SurfacePort, surface);
  filler->SetInputDataObject(
    Filler::SelectionPort, MakeSelection(vtkSelectionNode::PEDIGREEIDS, ring));
  filler->Update();
  CheckFilled(map, filler->GetOutput(), disc);

  // the same by point numbers of the surface, as the mouse makes them
  std::vector<vtkIdType> numbers;
  vtkDataArray* ids = surface->GetPointData()->GetArray("PixelId");
  for (vtkIdType k = 0; k < surface->GetNumberOfPoints(); ++k)
  {
    if (disc(static_cast<vtkIdType>(ids->GetTuple1(k))))
    {
      numbers.push_back(k);
    }
  }
  filler->SetInputDataObject(
    Filler::SelectionPort, MakeSelection(vtkSelectionNode::INDICES, numbers));
  const auto messages = lacunaCheck::Watch(filler);
  filler->Update();
  LACUNA_CHECK(messages->Warnings.empty());
  CheckFilled(map, filler->GetOutput(), disc);

  // extracted points, without a selection; together with an array
  vtkNew<vtkPolyData> extracted;
  vtkNew<vtkPoints> points;
  vtkNew<vtkIdTypeArray> extractedIds;
  extractedIds->SetName("PixelId");
  for (const vtkIdType id : ring)
  {
    points->InsertNextPoint(0, 0, 0);
    extractedIds->InsertNextValue(id);
  }
  extracted->SetPoints(points);
  extracted->GetPointData()->AddArray(extractedIds);
  vtkNew<vtkDoubleArray> corner;
  corner->SetName("corner");
  for (vtkIdType i = 0; i < map.Image->GetNumberOfPoints(); ++i)
  {
    corner->InsertNextValue(i == 30 * 80 + 70);
  }
  map.Image->GetPointData()->AddArray(corner);
  filler->SetInputDataObject(Filler::SelectionPort, nullptr);
  filler->SetInputDataObject(Filler::SurfacePort, extracted);
  filler->SetDefectArray("corner");
  filler->Update();
  LACUNA_CHECK_CONTAINS(GetStep(filler), "DefectArray=corner ");
  LACUNA_CHECK_CONTAINS(GetStep(filler), " SelectedPixels=");
  CheckFilled(map, filler->GetOutput(), [&](vtkIdType i) { return disc(i) || i == 30 * 80 + 70; });

  // a selection of the map's own points: a patch, nothing more
  filler->SetDefectArray("");
  filler->SetInputDataObject(Filler::SurfacePort, nullptr);
  filler->SetInputDataObject(
    Filler::SelectionPort, MakeSelection(vtkSelectionNode::INDICES, patch));
  filler->Update();
  CheckFilled(map, filler->GetOutput(), [&](vtkIdType i) { return map.IsInDisc(i, 3); });
  LACUNA_CHECK(messages->Warnings.empty());

  // loose pixels, which could be a surface's: the provenance names them
  filler->SetInputDataObject(
    Filler::SelectionPort, MakeSelection(vtkSelectionNode::INDICES, { 82, 80, 81, 1604, 1605 }));
  filler->Update();
  LACUNA_CHECK_CONTAINS(GetStep(filler), " SelectedPixels=\"80-82,1604-1605\" DefectPixels=5 ");
  LACUNA_CHECK_CONTAINS(GetStep(filler), " DefectExtent=10,15,21,40 ");
  messages->Warnings.clear();

  // numbers of the points in the order of Depth Map Surface, which is forgotten: they shear the ring
  for (vtkIdType& number : numbers)
  {
    number = surface->GetNumberOfPoints() - 1 - number;
  }
  filler->SetInputDataObject(
    Filler::SelectionPort, MakeSelection(vtkSelectionNode::INDICES, numbers));
  filler->Update();
  LACUNA_CHECK(messages->HasWarning("read as points of the depth map"));

  // nothing selected: nothing filled, and the automatic search does not step in
  filler->SetInputDataObject(Filler::SelectionPort, MakeSelection(vtkSelectionNode::INDICES, {}));
  filler->Update();
  LACUNA_CHECK(messages->HasWarning("the defect is empty"));
  LACUNA_CHECK_CONTAINS(GetStep(filler), "SelectedPixels=\"\" DefectPixels=0 DefectExtent= ");
}

// A region that misses says how far it is and which way it has to go: then it touches the surface.
void TestMissedRegion()
{
  const TestMap map;
  vtkNew<vtkLacunaRBFHoleFiller> filler;
  filler->SetInputData(map.Image);
  vtkNew<vtkSphere> sphere;
  const lacuna::Vec3 surface = lacuna::DepthMap(map.Image).GetPoint(50, 40, TestMap::Depth(50, 32));
  const lacuna::Vec3 normal = lacuna::Normalized(
    lacuna::Cross(map.Right + 0.3 * map.View, map.Down + -0.15 * map.View)); // away from the viewer
  const lacuna::Vec3 center = surface + 17.5 * normal;
  sphere->SetCenter(center.data());
  sphere->SetRadius(5);
  filler->SetDefectRegion(sphere);
  const auto messages = lacunaCheck::Watch(filler);
  filler->Update();
  LACUNA_CHECK_CONTAINS(
    messages->Warnings, "DefectRegion is 12.5 mm away from the surface: move it by at least (");
  const std::size_t at = messages->Warnings.find("at least (") + 10;
  lacuna::Vec3 way{};
  char comma = 0;
  std::istringstream(messages->Warnings.substr(at)) >> way[0] >> comma >> way[1] >> comma >> way[2];
  LACUNA_CHECK_NEAR(lacuna::Norm(way + 12.5 * normal), 0, 0.2);
}

// The provenance says which region: a sphere elsewhere is another step.
void TestRegionProvenance()
{
  TestMap map;
  vtkNew<Filler> filler;
  filler->SetInputData(map.Image);
  const lacuna::Vec3 center = map.GetSurfacePoint(45, 42);
  vtkNew<vtkSphere> ball;
  ball->SetCenter(center[0], center[1], center[2]);
  ball->SetRadius(6.25);
  filler->SetDefectRegion(ball);
  filler->Update();
  const std::string first = GetStep(filler);
  LACUNA_CHECK_CONTAINS(
    first, "DefectRegion=\"vtkSphere Center=" + lacuna::FormatValue(center.Elements));
  LACUNA_CHECK_CONTAINS(first, " Radius=6.25\"");
  vtkNew<vtkTransform> shift;
  shift->Translate(0.125, 0, 0);
  ball->SetTransform(shift);
  filler->Update();
  LACUNA_CHECK_CONTAINS(GetStep(filler), "Transform=1,0,0,0.125,0,1,0,0,0,0,1,0,0,0,0,1");
  filler->SetDefectRegion(nullptr);
  filler->Update();
  LACUNA_CHECK_CONTAINS(GetStep(filler), "DefectRegion=None");
}

// NaN, as a calculator makes it, marks neither a defect nor painted bone.
void TestMarksThatAreNoNumbers()
{
  TestMap map;
  vtkNew<vtkDoubleArray> defect;
  defect->SetName("defect");
  vtkNew<vtkDoubleArray> sound;
  sound->SetName("sound");
  for (vtkIdType i = 0; i < map.Image->GetNumberOfPoints(); ++i)
  {
    const bool bad = map.IsInDisc(i, 12);
    defect->InsertNextValue(map.IsInDisc(i, 8) ? 1 : bad ? std::nan("") : 0);
    sound->InsertNextValue(bad ? std::nan("") : map.IsInDisc(i, 20));
    if (bad)
    {
      map.Image->GetPointData()->GetArray("Depth")->SetTuple1(i, 20);
    }
  }
  map.Image->GetPointData()->AddArray(defect);
  map.Image->GetPointData()->AddArray(sound);
  vtkNew<Filler> filler;
  filler->SetInputData(map.Image);
  filler->SetDefectArray("defect");
  filler->SetSupportArray("sound");
  filler->Update();
  CheckFilled(map, filler->GetOutput(), [&](vtkIdType i) { return map.IsInDisc(i, 8); });
  int wrong = 0;
  for (vtkIdType i = 0; i < map.Image->GetNumberOfPoints(); ++i)
  {
    const bool expected = map.IsInDisc(i, 20) && !map.IsInDisc(i, 12);
    wrong += (Get(filler->GetOutput(), "SupportMask", i) != 0) != expected;
  }
  LACUNA_CHECK(wrong == 0);
  filler->SetDefectArray(""); // what the painted bone encloses
  filler->Update();
  CheckFilled(map, filler->GetOutput(), [&](vtkIdType i) { return map.IsInDisc(i, 12); });
}

void TestPriorOfAnotherView()
{
  // A dome in world coordinates, the prior a map of it that is turned, shifted, finer and perspective.
  const auto dome = [](TestMap& map, const std::function<double(vtkIdType)>& depth)
  {
    for (vtkIdType i = 0; i < map.Image->GetNumberOfPoints(); ++i)
    {
      map.Image->GetPointData()->GetArray("Depth")->SetTuple1(i, depth(i));
    }
  };
  TestMap map;
  const lacuna::Vec3 center = map.Origin + 40.0 * map.Right + 45.0 * map.Down + 100.0 * map.View;
  const double radius = 70;
  const auto hit = [&](const lacuna::Vec3& from, const lacuna::Vec3& ray)
  {
    const lacuna::Vec3 d = center - from;
    const double along = lacuna::Dot(d, ray);
    return along - std::sqrt(radius * radius - lacuna::Dot(d, d) + along * along);
  };
  const auto fill = [&](TestMap& m)
  {
    const lacuna::DepthMap contract(m.Image);
    dome(m,
      [&](vtkIdType i)
      {
        const auto column = static_cast<double>(TestMap::FirstColumn + i % TestMap::Width);
        const auto row = static_cast<double>(TestMap::FirstRow + i / TestMap::Width);
        return hit(contract.GetPoint(column, row, 0), contract.GetRay(column, row));
      });
  };
  fill(map);
  TestMap prior;
  prior.View = lacuna::Normalized(map.View + 0.15 * map.Right - 0.1 * map.Down);
  prior.Right = lacuna::Normalized(lacuna::Cross(map.Down, prior.View));
  prior.Down = lacuna::Cross(prior.View, prior.Right);
  const lacuna::Vec3 origin = center - 120.0 * prior.View - 42.0 * prior.Right - 36.0 * prior.Down;
  lacuna::DepthMap::SetGeometry(
    prior.Image, { origin, prior.Right, prior.Down, prior.View, { 0.8, 0.72 } });
  fill(prior);

  vtkNew<Filler> filler;
  filler->SetInputData(map.Image);
  filler->SetSupportMargin(6);
  filler->SetDefectRegion(map.MakeDisc(12));
  vtkNew<vtkCylinder> cylinder; // on this dome
  cylinder->SetCenter(center.data());
  cylinder->SetAxis(map.View[0], map.View[1], map.View[2]);
  cylinder->SetRadius(14);
  filler->SetDefectRegion(cylinder);
  const auto getWorst = [&]
  {
    filler->Update();
    double worst = 0;
    for (vtkIdType i = 0; i < map.Image->GetNumberOfPoints(); ++i)
    {
      if (Get(filler->GetOutput(), "FilledMask", i) != 0)
      {
        worst = std::max(worst, std::abs(Get(filler->GetOutput(), "Deviation", i)));
      }
    }
    return worst;
  };
  const double plain = getWorst();
  std::cout << "thin plate alone: " << plain << std::endl;
  filler->SetInputDataObject(Filler::PriorSurfacePort, prior.Image);
  const double with = getWorst();
  std::cout << "with the prior: " << with << std::endl;
  LACUNA_CHECK(with < 0.005 && with < plain / 5); // of flat triangles of 0.8 mm
  LACUNA_CHECK(with > 0);
  filler->SetTrend(Filler::Ellipsoid);
  filler->SetInputDataObject(Filler::PriorSurfacePort, nullptr);
  LACUNA_CHECK(getWorst() < 1e-3); // 1e-4 of the range
}

void TestOutputGrid()
{
  TestMap map;
  for (vtkIdType i = 0; i < map.Image->GetNumberOfPoints(); ++i)
  {
    if (map.IsInDisc(i, 7))
    {
      map.Invalidate(i);
    }
  }
  vtkNew<vtkDoubleArray> column;
  column->SetName("column");
  for (vtkIdType i = 0; i < map.Image->GetNumberOfPoints(); ++i)
  {
    column->InsertNextValue(static_cast<double>(TestMap::FirstColumn + i % TestMap::Width));
  }
  map.Image->GetPointData()->AddArray(column);
  vtkNew<Filler> filler;
  filler->SetInputData(map.Image);
  filler->SetOutputSpacing(0.5, 0.5, 0);
  filler->SetOutputMargin(8);
  filler->Update();
  vtkNew<vtkImageData> whole;
  whole->DeepCopy(filler->GetOutput());
  const lacuna::DepthMap contract(whole); // geometry and matrix agree
  const int* extent = whole->GetExtent();
  // 10..89 mm and 16..63.2 mm, and 8 mm around
  const int expected[6] = { 4, 194, 16, 142, 0, 0 };
  LACUNA_CHECK(!std::memcmp(extent, expected, sizeof(expected)));
  int fitted = 0;
  for (int j = extent[2]; j <= extent[3]; ++j)
  {
    for (int i = extent[0]; i <= extent[1]; ++i)
    {
      int at[3] = { i, j, 0 };
      const vtkIdType pixel = whole->ComputePointId(at);
      const double depth = TestMap::Depth(0.5 * i, 0.5 * j);
      const bool inside = i >= 20 && i <= 178 && j >= 32 && j <= 126;
      LACUNA_CHECK(std::isnan(Get(whole, "Depth", pixel)) == !inside);
      LACUNA_CHECK(!inside || std::abs(Get(whole, "Depth", pixel) - depth) < 1e-9);
      LACUNA_CHECK(!inside || std::abs(Get(whole, "column", pixel) - 0.5 * i) <= 0.5);
      if (!std::isnan(Get(whole, "Fitted", pixel)))
      {
        ++fitted;
        LACUNA_CHECK(std::abs(Get(whole, "Fitted", pixel) - depth) < 1e-8);
      }
    }
  }
  LACUNA_CHECK(fitted > 4 * 50 * 50);
  // the same surface in the same place
  const lacuna::Vec3 p = contract.GetPoint(90, 84, Get(whole, "Fitted", (84 - 16) * 191 + 90 - 4));
  LACUNA_CHECK(lacuna::Norm(p - map.GetSurfacePoint(45, 42)) < 1e-8);

  const int piece[6] = { 20, 120, 30, 77, 0, 0 };
  filler->Modified();
  filler->UpdateExtent(piece);
  LACUNA_CHECK(!std::memcmp(filler->GetOutput()->GetExtent(), piece, sizeof(piece)));
  int at[3] = { 90, 70, 0 };
  LACUNA_CHECK(Get(filler->GetOutput(), "Fitted", filler->GetOutput()->ComputePointId(at)) ==
    Get(whole, "Fitted", whole->ComputePointId(at)));
}

void TestFieldData()
{
  TestMap map;
  vtkNew<Filler> filler;
  filler->SetInputData(map.Image);
  filler->SetDefectRegion(map.MakeDisc(9));
  const auto get = [&](const char* name)
  {
    filler->Update();
    vtkDataArray* array = filler->GetOutput()->GetFieldData()->GetArray(name);
    return array ? array->GetTuple1(0) : -1;
  };
  LACUNA_CHECK(get("FitTime") > 0 && get("FitTime") < 100);
  LACUNA_CHECK(get("ConditionEstimate") > 1);
  LACUNA_CHECK(get("Iterations") == 0);
  const std::string step = lacuna::Provenance::Get(filler->GetOutput()).back();
  filler->Modified();
  filler->Update();
  LACUNA_CHECK(step == lacuna::Provenance::Get(filler->GetOutput()).back()); // no time in it
  filler->SetSolver(Filler::Fast);
  LACUNA_CHECK(get("ConditionEstimate") == 0);
}
}

int TestRBFHoleFillerInputs(int, char*[])
{
  TestSelections();
  TestMissedRegion();
  TestRegionProvenance();
  TestMarksThatAreNoNumbers();
  TestPriorOfAnotherView();
  TestOutputGrid();
  TestFieldData();
  return lacunaCheck::Result();
}
