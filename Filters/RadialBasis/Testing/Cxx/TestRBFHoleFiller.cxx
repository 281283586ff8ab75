// SPDX-License-Identifier: BSD-3-Clause
// Defects marked in each way, arrays, field data, normals, pieces, threads.
#include "RBFTestMaps.h"
#include "lacunaCheck.h"
#include "lacunaProvenance.h"
#include "vtkCylinder.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkLacunaRBFHoleFiller.h"
#include "vtkPlane.h"
#include "vtkSMPTools.h"
#include "vtkSphere.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <sstream>
#include <string>
#include <vector>

namespace
{
double GetField(vtkImageData* image, const char* name, int component = 0)
{
  return image->GetFieldData()->GetArray(name)->GetComponent(0, component);
}

// Pixels whose FilledMask differs from the disc of that radius.
int CountWrong(const TestMap& map, vtkImageData* output, double radius)
{
  int wrong = 0;
  for (vtkIdType i = 0; i < output->GetNumberOfPoints(); ++i)
  {
    wrong += (Get(output, "FilledMask", i) != 0) != map.IsInDisc(i, radius);
  }
  return wrong;
}

// Pixels whose centres are at most distance mm from one of the given ones.
std::vector<bool> Within(const TestMap& map, const std::vector<bool>& pixels, double distance)
{
  std::vector<bool> near(pixels.size());
  for (std::size_t i = 0; i < pixels.size(); ++i)
  {
    const lacuna::Vec2 p = map.GetPosition(static_cast<vtkIdType>(i));
    for (std::size_t k = 0; k < pixels.size() && !near[i]; ++k)
    {
      const lacuna::Vec2 q = map.GetPosition(static_cast<vtkIdType>(k));
      near[i] = pixels[k] && std::hypot(p[0] - q[0], p[1] - q[1]) <= distance + 1e-9;
    }
  }
  return near;
}

void TestAutomaticHole()
{
  // A hole that shows nothing in its left half and a floor 40 mm below in its right half, and
  // background at the left border.
  TestMap map;
  const auto size = static_cast<std::size_t>(map.Image->GetNumberOfPoints());
  std::vector<bool> hole(size);
  for (vtkIdType i = 0; i < map.Image->GetNumberOfPoints(); ++i)
  {
    hole[i] = map.IsInDisc(i, 7);
    if ((hole[i] && map.GetPosition(i)[0] < 45) || i % TestMap::Width < 4)
    {
      map.Invalidate(i);
    }
    else if (hole[i])
    {
      vtkDataArray* depth = map.Image->GetPointData()->GetArray("Depth");
      depth->SetTuple1(i, depth->GetTuple1(i) + 40);
    }
  }
  vtkNew<vtkLacunaRBFHoleFiller> filler;
  filler->SetInputData(map.Image);
  filler->SetSupportMargin(6);
  filler->SetSupportStepMargin(0); // the steps of this map are sharp
  filler->Update();
  vtkImageData* output = filler->GetOutput();

  const std::vector<bool> filled = Within(map, hole, 2); // the rim of a hole is replaced, too
  const std::vector<bool> fitted = Within(map, filled, 6);
  int rectangle[4] = { TestMap::Width, -1, TestMap::Height, -1 };
  for (int i = 0; i < static_cast<int>(size); ++i)
  {
    if (fitted[i])
    {
      rectangle[0] = std::min(rectangle[0], i % TestMap::Width);
      rectangle[1] = std::max(rectangle[1], i % TestMap::Width);
      rectangle[2] = std::min(rectangle[2], i / TestMap::Width);
      rectangle[3] = std::max(rectangle[3], i / TestMap::Width);
    }
  }
  // The plane is restored, where it was, with its normal towards the viewer.
  const lacuna::Vec3 normal = lacuna::Normalized(0.3 * map.Right + (-0.15) * map.Down - map.View);
  LACUNA_CHECK(lacuna::Dot(normal, map.View) < 0);
  for (int i = 0; i < static_cast<int>(size); ++i)
  {
    const lacuna::Vec2 p = map.GetPosition(i);
    const int column = i % TestMap::Width;
    const int row = i / TestMap::Width;
    const bool background = column < 4;
    LACUNA_CHECK((Get(output, "FilledMask", i) != 0) == filled[i]);
    LACUNA_CHECK((Get(output, "vtkValidPointMask", i) == 0) == background);
    LACUNA_CHECK(std::isnan(Get(output, "Depth", i)) == background);
    if (!background)
    {
      LACUNA_CHECK(std::abs(Get(output, "Depth", i) - TestMap::Depth(p[0], p[1])) < 1e-9);
    }
    for (int c = 0; c < 3; ++c)
    {
      const double expected = filled[i] ? normal[c] : 0;
      LACUNA_CHECK(std::abs(Get(output, "Normals", i, c) - expected) < 1e-6);
    }
    const bool inside = column >= rectangle[0] && column <= rectangle[1] && row >= rectangle[2] &&
      row <= rectangle[3];
    LACUNA_CHECK(std::isfinite(Get(output, "Fitted", i)) == inside);
    // fitted less measured: 40 mm too near for the floor, undefined where nothing was measured
    const double deviation = Get(output, "Deviation", i);
    const bool unmeasured = hole[i] && p[0] < 45;
    LACUNA_CHECK(std::isnan(deviation) == (!fitted[i] || unmeasured));
    LACUNA_CHECK(std::isnan(deviation) || std::abs(deviation + (hole[i] ? 40 : 0)) < 1e-9);
  }
  LACUNA_CHECK(std::abs(GetField(output, "RBFPlane", 0) - 25) < 1e-8);
  LACUNA_CHECK(std::abs(GetField(output, "RBFPlane", 1) - 0.3) < 1e-10);
  LACUNA_CHECK(std::abs(GetField(output, "RBFPlane", 2) + 0.15) < 1e-10);
  const double length = std::sqrt(1 + 0.09 + 0.0225);
  LACUNA_CHECK(std::abs(GetField(output, "PlaneNormal", 0) - 0.3 / length) < 1e-9);
  LACUNA_CHECK(std::abs(GetField(output, "PlaneNormal", 1) + 0.15 / length) < 1e-9);
  LACUNA_CHECK(std::abs(GetField(output, "PlaneNormal", 2) + 1 / length) < 1e-9);
  LACUNA_CHECK(GetField(output, "NodeCount") > 300);
  LACUNA_CHECK(GetField(output, "Residual") < 1e-10);
  LACUNA_CHECK(GetField(output, "ConditionEstimate") > 1e4);
  LACUNA_CHECK(GetField(output, "BendingEnergy") < 1e-9);
  const auto count = static_cast<double>(std::count(filled.begin(), filled.end(), true));
  LACUNA_CHECK(std::abs(GetField(output, "DefectArea") - 0.8 * count * length) < 1e-6);
  LACUNA_CHECK(output->GetFieldData()->GetArray("ImageToWorld"));
  const std::vector<std::string> steps = lacuna::Provenance::Get(output);
  LACUNA_CHECK(steps.size() == 1 && steps[0].find("SupportMargin=6") != std::string::npos);
  LACUNA_CHECK(!std::strcmp(output->GetPointData()->GetScalars()->GetName(), "Depth"));
}

void TestRegions()
{
  TestMap map;
  const lacuna::Vec3 center = map.GetSurfacePoint(45, 42);

  // a cylinder along the view direction cuts a disc
  vtkNew<vtkCylinder> cylinder;
  cylinder->SetCenter(center.data());
  cylinder->SetAxis(map.View[0], map.View[1], map.View[2]);
  cylinder->SetRadius(9);
  vtkNew<vtkLacunaRBFHoleFiller> filler;
  filler->SetInputData(map.Image);
  filler->SetDefectRegion(cylinder);
  filler->Update();
  LACUNA_CHECK(CountWrong(map, filler->GetOutput(), 9) == 0);
  for (vtkIdType i = 0; i < map.Image->GetNumberOfPoints(); ++i)
  {
    if (map.IsInDisc(i, 9)) // removed data are compared with the fit
    {
      LACUNA_CHECK(std::abs(Get(filler->GetOutput(), "Deviation", i)) < 1e-9);
    }
  }

  // changing the region changes the output
  cylinder->SetRadius(6);
  filler->Update();
  LACUNA_CHECK(CountWrong(map, filler->GetOutput(), 6) == 0);

  // A sphere over a real hole, through which a floor 40 mm below is seen, or nothing at all, takes
  // both: its silhouette is the disc.
  for (vtkIdType i = 0; i < map.Image->GetNumberOfPoints(); ++i)
  {
    if (map.IsInDisc(i, 4))
    {
      map.Invalidate(i);
    }
    else if (map.IsInDisc(i, 7))
    {
      vtkDataArray* depth = map.Image->GetPointData()->GetArray("Depth");
      depth->SetTuple1(i, depth->GetTuple1(i) + 40);
    }
  }
  map.Image->Modified();
  vtkNew<vtkSphere> sphere;
  sphere->SetCenter(center.data());
  sphere->SetRadius(9);
  filler->SetDefectRegion(sphere);
  filler->Update();
  for (vtkIdType i = 0; i < map.Image->GetNumberOfPoints(); ++i)
  {
    const bool filled = Get(filler->GetOutput(), "FilledMask", i) != 0;
    LACUNA_CHECK(filled || !map.IsInDisc(i, 7.5));
    LACUNA_CHECK(!filled || map.IsInDisc(i, 9));
    const lacuna::Vec2 p = map.GetPosition(i);
    LACUNA_CHECK(
      std::abs(Get(filler->GetOutput(), "Depth", i) - TestMap::Depth(p[0], p[1])) < 1e-8);
  }

  // inside is where the function is negative: a half space
  map = TestMap();
  vtkNew<vtkPlane> plane;
  plane->SetOrigin(map.GetSurfacePoint(20, 40).data());
  plane->SetNormal(map.Right[0], map.Right[1], map.Right[2]);
  filler->SetInputData(map.Image);
  filler->SetDefectRegion(plane);
  vtkNew<lacunaCheck::Messages> messages;
  messages->Watch(filler);
  filler->Update();
  LACUNA_CHECK(messages->HasWarning("touches the border"));
  for (vtkIdType i = 0; i < map.Image->GetNumberOfPoints(); ++i)
  {
    const double x = map.GetPosition(i)[0];
    const bool filled = Get(filler->GetOutput(), "FilledMask", i) != 0;
    LACUNA_CHECK(x == 20 || filled == (x < 20)); // the pixels on the plane may round to either side
  }
}

void TestArrays()
{
  TestMap map;
  vtkNew<vtkDoubleArray> marked;
  marked->SetName("marked");
  vtkNew<vtkFloatArray> painted;
  painted->SetName("painted");
  for (vtkIdType i = 0; i < map.Image->GetNumberOfPoints(); ++i)
  {
    marked->InsertNextValue(map.IsInDisc(i, 7) ? -2 : 0);
    painted->InsertNextValue(map.IsInDisc(i, 16) && !map.IsInDisc(i, 8) ? 1 : 0);
  }
  map.Image->GetPointData()->AddArray(marked);
  map.Image->GetPointData()->AddArray(painted);
  vtkNew<vtkLacunaRBFHoleFiller> filler;
  filler->SetInputData(map.Image);
  filler->SetDefectArray("marked");
  filler->Update();
  LACUNA_CHECK(CountWrong(map, filler->GetOutput(), 7) == 0);
  LACUNA_CHECK(filler->GetOutput()->GetPointData()->GetArray("painted")); // passed on

  // union with a region
  vtkNew<vtkSphere> everything;
  everything->SetCenter(map.GetSurfacePoint(45, 42).data());
  everything->SetRadius(10);
  filler->SetDefectRegion(everything);
  filler->SetNodeSpacing(2);
  filler->Update();
  LACUNA_CHECK(CountWrong(map, filler->GetOutput(), 7) > 0);
  filler->SetDefectRegion(nullptr);

  // painted bone around the defect: what it encloses is filled, and nothing else carries the fit
  filler->SetDefectArray("");
  filler->SetSupportArray("painted");
  filler->SetSupportMargin(1);
  filler->Update();
  LACUNA_CHECK(CountWrong(map, filler->GetOutput(), 8) == 0);
  for (vtkIdType i = 0; i < map.Image->GetNumberOfPoints(); ++i)
  {
    LACUNA_CHECK(std::isfinite(Get(filler->GetOutput(), "Deviation", i)) == map.IsInDisc(i, 16));
  }
}

void TestPiecesAndThreads()
{
  TestMap map;
  for (vtkIdType i = 0; i < map.Image->GetNumberOfPoints(); ++i)
  {
    vtkDataArray* depth = map.Image->GetPointData()->GetArray("Depth");
    depth->SetTuple1(i, depth->GetTuple1(i) + std::sin(0.2 * static_cast<double>(i % 79)));
    if (map.IsInDisc(i, 9))
    {
      map.Invalidate(i);
    }
  }
  vtkNew<vtkLacunaRBFHoleFiller> filler;
  filler->SetInputData(map.Image);
  filler->SetOutputMargin(5);
  filler->Update();
  vtkNew<vtkImageData> whole;
  whole->DeepCopy(filler->GetOutput());

  const int piece[6] = { 30, 52, 40, 77, 0, 0 };
  filler->Modified();
  filler->UpdateExtent(piece);
  vtkImageData* part = filler->GetOutput();
  LACUNA_CHECK(!std::memcmp(part->GetExtent(), piece, sizeof(piece)));
  LACUNA_CHECK(part->GetFieldData()->GetArray("RBFPlane"));
  LACUNA_CHECK(lacuna::DepthMap(part).GetPixelSpacing()[1] == 0.8); // still a depth map
  for (const char* name : { "Depth", "Fitted", "FilledMask", "Deviation", "vtkValidPointMask" })
  {
    for (int j = piece[2]; j <= piece[3]; ++j)
    {
      for (int i = piece[0]; i <= piece[1]; ++i)
      {
        int at[3] = { i, j, 0 };
        const double a = Get(part, name, part->ComputePointId(at));
        const double b = Get(whole, name, whole->ComputePointId(at));
        LACUNA_CHECK(a == b || (std::isnan(a) && std::isnan(b)));
      }
    }
  }

  for (const int threads : { 1, 2, 5 })
  {
    vtkSMPTools::LocalScope(vtkSMPTools::Config{ threads, std::string("STDThread"), false },
      [&]
      {
        filler->Modified();
        filler->UpdateExtent(whole->GetExtent());
      });
    for (const char* name : { "Depth", "Fitted", "Deviation", "Normals" })
    {
      vtkDataArray* a = filler->GetOutput()->GetPointData()->GetArray(name);
      vtkDataArray* b = whole->GetPointData()->GetArray(name);
      LACUNA_CHECK(!std::memcmp(
        a->GetVoidPointer(0), b->GetVoidPointer(0), a->GetNumberOfValues() * a->GetDataTypeSize()));
    }
  }
}

void TestKernels()
{
  // The same hole in a curved surface, by each kernel: all fit the nodes, and differ inside.
  TestMap map;
  for (vtkIdType i = 0; i < map.Image->GetNumberOfPoints(); ++i)
  {
    const lacuna::Vec2 p = map.GetPosition(i);
    vtkDataArray* depth = map.Image->GetPointData()->GetArray("Depth");
    depth->SetTuple1(
      i, 100 - std::sqrt(8100 - (p[0] - 40) * (p[0] - 40) - (p[1] - 45) * (p[1] - 45)));
  }
  vtkNew<vtkSphere> sphere;
  const lacuna::Vec3 on = map.Origin + 45.0 * map.Right + 42.0 * map.Down + 10.2 * map.View;
  sphere->SetCenter(on.data());
  sphere->SetRadius(12);
  vtkNew<vtkLacunaRBFHoleFiller> filler;
  filler->SetInputData(map.Image);
  filler->SetDefectRegion(sphere);
  double worst[4] = { 0, 0, 0, 0 };
  for (const int kernel : { 0, 1, 3 })
  {
    filler->SetKernel(kernel);
    filler->Update();
    LACUNA_CHECK((filler->GetOutput()->GetFieldData()->GetArray("BendingEnergy") != nullptr) ==
      (kernel == static_cast<int>(lacuna::RadialKernel::ThinPlate)));
    for (vtkIdType i = 0; i < map.Image->GetNumberOfPoints(); ++i)
    {
      const double deviation = Get(filler->GetOutput(), "Deviation", i);
      if (Get(filler->GetOutput(), "FilledMask", i) != 0)
      {
        worst[kernel] = std::max(worst[kernel], std::abs(deviation));
      }
    }
  }
  LACUNA_CHECK(worst[0] < 0.1);
  LACUNA_CHECK(worst[1] > 2 * worst[0]); // the linear one is too flat (Carr 1996, section 6.3)
  LACUNA_CHECK(worst[3] < 0.1);
}
}

int TestRBFHoleFiller(int, char*[])
{
  TestAutomaticHole();
  TestRegions();
  TestArrays();
  TestPiecesAndThreads();
  TestKernels();
  vtkNew<vtkLacunaRBFHoleFiller> filler;
  std::ostringstream text;
  filler->Print(text);
  for (const char* name : { "Kernel", "DefectRegion", "DefectArray", "SupportArray",
         "SupportMargin: 12", "NodeSpacing: 1", "Smoothing: 0", "OutputMargin: 0", "Trend: None",
         "KernelLength: 0", "OutputSpacing: 0,0", "Accuracy: 1e-04", "Solver: Auto" })
  {
    LACUNA_CHECK(text.str().find(name) != std::string::npos);
  }
  return lacunaCheck::Result();
}
