// SPDX-License-Identifier: BSD-3-Clause
// A loop around the defect: what it encloses as the map sees it, wherever its points lie along the view.
#include "RBFTestMaps.h"
#include "lacunaCheck.h"
#include "lacunaParameterText.h"
#include "lacunaProvenance.h"
#include "vtkLacunaRBFHoleFiller.h"
#include "vtkLacunaSplineLoop.h"
#include "vtkPoints.h"

#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace
{
// World position over x, y of the map, off mm behind its surface.
lacuna::Vec3 Lift(const TestMap& map, double x, double y, double off)
{
  return map.GetSurfacePoint(x, y) + off * map.View;
}

// Pixels filled; fails when not all of them are in the result.
std::vector<bool> Fill(vtkLacunaRBFHoleFiller* filler)
{
  filler->Update();
  std::vector<bool> filled;
  auto* mask = filler->GetOutput()->GetPointData()->GetArray("FilledMask");
  for (vtkIdType i = 0; mask && i < mask->GetNumberOfTuples(); ++i)
  {
    filled.push_back(mask->GetComponent(i, 0) != 0);
  }
  return filled;
}

void SetCircle(
  const TestMap& map, vtkLacunaSplineLoop* loop, int count, double radius, double relief)
{
  loop->SetNumberOfPoints(count);
  for (int k = 0; k < count; ++k)
  {
    const double angle = -6.283185307179586 * k / count;
    const lacuna::Vec3 p = Lift(map, 45 + radius * std::cos(angle), 42 + radius * std::sin(angle),
      relief * std::sin(2.3 * k));
    loop->SetPoint(k, p[0], p[1], p[2]);
  }
}

void TestCircle()
{
  TestMap map;
  for (vtkIdType i = 0; i < map.Image->GetNumberOfPoints(); ++i)
  {
    if (map.IsInDisc(i, 6))
    {
      map.Invalidate(i); // without depth, and inside
    }
  }
  vtkNew<vtkLacunaSplineLoop> loop;
  vtkNew<vtkLacunaRBFHoleFiller> filler;
  filler->SetInputData(map.Image);
  filler->SetDefectRegion(loop);
  const auto check = [&](double radius, double relief, double tolerance)
  {
    SetCircle(map, loop, 9, radius, relief);
    const std::vector<bool> filled = Fill(filler);
    LACUNA_CHECK(filled.size() == static_cast<std::size_t>(map.Image->GetNumberOfPoints()));
    int wrong = 0;
    for (std::size_t i = 0; i < filled.size(); ++i)
    {
      const auto pixel = static_cast<vtkIdType>(i);
      wrong += filled[i] ? !map.IsInDisc(pixel, radius + tolerance)
                         : map.IsInDisc(pixel, radius - tolerance);
    }
    LACUNA_CHECK(wrong == 0);
  };
  check(14, 0, 0.05);
  check(14, 4, 0.4); // points before and behind the surface bend the spline a little
  const vtkMTimeType before = loop->GetMTime();
  SetCircle(map, loop, 9, 14, 4);
  LACUNA_CHECK(loop->GetMTime() == before);
  check(9, 0, 0.05); // a change is noticed
}

// A boomerang (no symmetry, not convex) as VTK's loop, with its points far from the surface.
void TestPolygon()
{
  const TestMap map;
  const std::vector<lacuna::Vec2> corners = { { 25.3, 30.1 }, { 60.2, 33.3 }, { 41.7, 39.9 },
    { 38.1, 55.4 } };
  const auto isInside = [&](const lacuna::Vec2& p)
  {
    bool inside = false;
    for (std::size_t k = 0; k < corners.size(); ++k)
    {
      const lacuna::Vec2& a = corners[k];
      const lacuna::Vec2& b = corners[(k + 1) % corners.size()];
      if ((a[1] > p[1]) != (b[1] > p[1]) &&
        p[0] < a[0] + (p[1] - a[1]) * (b[0] - a[0]) / (b[1] - a[1]))
      {
        inside = !inside;
      }
    }
    return inside;
  };
  for (const bool given : { false, true })
  {
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    for (std::size_t k = 0; k < corners.size(); ++k)
    {
      points->InsertNextPoint(Lift(map, corners[k][0], corners[k][1], k % 2 ? -60 : 35).data());
    }
    vtkNew<vtkImplicitSelectionLoop> loop;
    loop->SetLoop(points);
    loop->SetAutomaticNormalGeneration(!given);
    lacuna::Vec3 normal = map.View;
    loop->SetNormal(normal.data());
    vtkNew<vtkLacunaRBFHoleFiller> filler;
    filler->SetInputData(map.Image);
    filler->SetDefectRegion(loop);
    const std::vector<bool> filled = Fill(filler);
    int wrong = 0;
    for (std::size_t i = 0; i < filled.size(); ++i)
    {
      wrong += filled[i] != isInside(map.GetPosition(static_cast<vtkIdType>(i)));
    }
    LACUNA_CHECK(!filled.empty() && wrong == 0);
  }
}

void TestOpenSpline()
{
  // three quarters of a circle; open: the chord is straight, closed: it bulges
  vtkNew<vtkLacunaSplineLoop> loop;
  LACUNA_CHECK(loop->GetClosed() && loop->GetNumberOfPoints() == 0);
  loop->SetNumberOfPoints(7);
  for (int k = 0; k < 7; ++k)
  {
    const double angle = 0.75 * 6.283185307179586 * k / 6;
    loop->SetPoint(k, 10 * std::cos(angle), 10 * std::sin(angle), 3);
  }
  const auto contains = [&](double x, double y) { return loop->EvaluateFunction(x, y, 0) < 0; };
  // between (10, 0) and (0, -10)
  LACUNA_CHECK(contains(0, 0) && contains(4.9, -4.9) && contains(5.3, -5.3) && !contains(8, -8));
  loop->ClosedOff();
  LACUNA_CHECK(contains(0, 0) && contains(4.9, -4.9) && !contains(5.1, -5.1));
  // fewer points keep their places, and points at one place count once
  double p[3];
  loop->SetNumberOfPoints(4);
  loop->GetPoint(2, p);
  LACUNA_CHECK(std::abs(p[1] - 10) < 1e-12 && std::abs(p[0]) < 1e-12);
  loop->SetPoint(1, 10, 0, 3);
  loop->SetPoint(3, p[0], p[1], p[2]);
  LACUNA_CHECK(loop->GetLoop()->GetNumberOfPoints() == 2);
}

// From the provenance the loop can be made again, to the last digit.
void TestProvenance()
{
  const TestMap map;
  vtkNew<vtkLacunaSplineLoop> loop;
  SetCircle(map, loop, 4, 14, 2);
  vtkNew<vtkLacunaRBFHoleFiller> filler;
  filler->SetInputData(map.Image);
  filler->SetDefectRegion(loop);
  const auto step = [&]()
  {
    filler->Modified();
    filler->Update();
    const std::vector<std::string> steps = lacuna::Provenance::Get(filler->GetOutput());
    return steps.empty() ? std::string() : steps.back();
  };
  const std::string first = step();
  std::vector<double> points(12);
  for (int k = 0; k < 4; ++k)
  {
    loop->GetPoint(k, &points[3 * k]);
  }
  LACUNA_CHECK_CONTAINS(first, "DefectRegion=\"vtkLacunaSplineLoop Printed=");
  LACUNA_CHECK_CONTAINS(first, "Points: " + lacuna::FormatValue(points) + "; Closed: 1");
  double p[3] = { 1, 2, 3 };
  loop->FunctionValue(p);
  LACUNA_CHECK_THAT(step() == first, step());
  loop->SetPoint(2, points[6], points[7], points[8] + 1e-9);
  LACUNA_CHECK(step() != first);

  vtkNew<vtkImplicitSelectionLoop> plain; // its corners
  plain->SetLoop(loop->GetLoop());
  filler->SetDefectRegion(plain);
  std::vector<double> corners;
  for (vtkIdType i = 0; i < loop->GetLoop()->GetNumberOfPoints(); ++i)
  {
    loop->GetLoop()->GetPoint(i, p);
    corners.insert(corners.end(), p, p + 3);
  }
  LACUNA_CHECK(corners.size() == 4 * 32 * 3);
  LACUNA_CHECK_CONTAINS(
    step(), "DefectRegion=\"vtkImplicitSelectionLoop Loop=" + lacuna::FormatValue(corners) + '"');
}

void TestErrors()
{
  const TestMap map;
  const auto expect = [&](vtkLacunaSplineLoop* loop, const char* text)
  {
    vtkNew<vtkLacunaRBFHoleFiller> filler;
    const auto messages = lacunaCheck::Watch(filler);
    filler->SetInputData(map.Image);
    filler->SetDefectRegion(loop);
    filler->Update();
    LACUNA_CHECK(messages->HasError(text));
    LACUNA_CHECK(filler->GetOutput()->GetNumberOfPoints() == 0);
  };
  vtkNew<vtkLacunaSplineLoop> loop;
  expect(loop, "the loop has 0 different points");
  SetCircle(map, loop, 2, 14, 0);
  expect(loop, "the loop has 2 different points");
  SetCircle(map, loop, 5, 14, 0);
  loop->SetPoint(3, 0, std::numeric_limits<double>::quiet_NaN(), 0);
  expect(loop, "not a finite number");
  vtkNew<lacunaCheck::Messages> messages;
  messages->Watch(loop);
  loop->SetPoint(5, 1, 2, 3);
  LACUNA_CHECK(messages->HasError("no point 5: the loop has 5"));
}
}

int TestSplineLoop(int, char*[])
{
  TestProvenance();
  TestCircle();
  TestPolygon();
  TestOpenSpline();
  TestErrors();
  return lacunaCheck::Result();
}
