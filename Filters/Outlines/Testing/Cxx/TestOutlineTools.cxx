// SPDX-License-Identifier: BSD-3-Clause
// Curves, contours and edges of known shapes.
#include "lacunaCheck.h"
#include "vtkImageData.h"
#include "vtkLacunaOutlineTools.h"
#include "vtkMath.h"
#include "vtkNew.h"
#include "vtkPoints.h"
#include "vtkSmartPointer.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace
{
constexpr int All[4] = { 0, -1, 0, -1 };
const double Nowhere[2] = { vtkMath::Nan(), vtkMath::Nan() };

// 80 x 60 pixels from column 5, row 3: an ellipse (half axes 20 and 12 around (50, 30)) of 200 in 40, with a hole of
// 40 (radius 4 around (56, 33)), and a disc of 200 (radius 5 around (15, 12)).
vtkSmartPointer<vtkImageData> MakePicture()
{
  auto picture = vtkSmartPointer<vtkImageData>::New();
  picture->SetExtent(5, 84, 3, 62, 7, 7);
  picture->AllocateScalars(VTK_FLOAT, 1);
  // a ramp over two pixels, so that the level between is crossed where the edge is
  const auto soft = [](double outside) { return std::clamp(0.5 - 0.5 * outside, 0.0, 1.0); };
  for (int j = 3; j <= 62; ++j)
  {
    for (int i = 5; i <= 84; ++i)
    {
      const double x = i - 50;
      const double y = j - 30;
      const double q = std::hypot(x / 20, y / 12);
      const double slope = q > 0 ? std::hypot(x / 400, y / 144) / q : 1;
      const double ellipse = soft((q - 1) / std::max(slope, 0.03));
      const double hole = soft(std::hypot(i - 56, j - 33) - 4);
      const double disc = soft(std::hypot(i - 15, j - 12) - 5);
      picture->SetScalarComponentFromDouble(
        i, j, 7, 0, 40 + 160 * std::max(ellipse * (1 - hole), disc));
    }
  }
  return picture;
}

double GetArea(vtkPoints* line)
{
  double sum = 0;
  const vtkIdType n = line->GetNumberOfPoints();
  for (vtkIdType i = 0; i < n; ++i)
  {
    double a[3];
    double b[3];
    line->GetPoint(i, a);
    line->GetPoint((i + 1) % n, b);
    sum += a[0] * b[1] - a[1] * b[0];
  }
  return std::abs(sum) / 2;
}

void TestCurve()
{
  vtkNew<vtkPoints> handles;
  vtkNew<vtkPoints> curve;
  constexpr int n = 12;
  for (int i = 0; i < n; ++i)
  {
    const double angle = 2 * vtkMath::Pi() * i / n;
    handles->InsertNextPoint(30 + 10 * std::cos(angle), 20 + 10 * std::sin(angle), 3);
    if (i == 4)
    {
      handles->InsertNextPoint(handles->GetPoint(4)); // again
    }
  }
  const int steps = vtkLacunaOutlineTools::MakeCurve(handles, true, curve);
  LACUNA_CHECK(steps == 8 && curve->GetNumberOfPoints() == n * steps);
  for (vtkIdType i = 0; i < curve->GetNumberOfPoints(); ++i)
  {
    double x[3];
    curve->GetPoint(i, x);
    LACUNA_CHECK_NEAR(std::hypot(x[0] - 30, x[1] - 20), 10, 0.01);
    LACUNA_CHECK(x[2] == 3);
  }
  for (int i = 0; i < n; ++i)
  {
    const double angle = 2 * vtkMath::Pi() * i / n;
    LACUNA_CHECK_NEAR(
      curve->GetPoint(static_cast<vtkIdType>(i) * steps)[0], 30 + 10 * std::cos(angle), 1e-5);
  }
  LACUNA_CHECK(vtkLacunaOutlineTools::MakeCurve(handles, false, curve) == 1);
  LACUNA_CHECK(curve->GetNumberOfPoints() == n);
  double where[3];
  LACUNA_CHECK(!vtkLacunaOutlineTools::FindCrossing(curve, where));

  vtkNew<vtkPoints> eight;
  for (const auto& p : { std::pair<double, double>{ 0, 0 }, { 4, 4 }, { 4, 0 }, { 0, 2 } })
  {
    eight->InsertNextPoint(p.first, p.second, 0);
  }
  LACUNA_CHECK(vtkLacunaOutlineTools::FindCrossing(eight, where));
  LACUNA_CHECK_NEAR(where[0], 4.0 / 3, 1e-12);
  LACUNA_CHECK_NEAR(where[1], 4.0 / 3, 1e-12);
}

void TestTrace()
{
  const auto picture = MakePicture();
  vtkNew<vtkPoints> line;
  const double level = vtkLacunaOutlineTools::ProposeLevel(picture, All);
  LACUNA_CHECK_NEAR(level, 120, 25);
  // the largest of all
  LACUNA_CHECK(vtkLacunaOutlineTools::Trace(picture, 120, Nowhere, All, 1, line));
  LACUNA_CHECK_NEAR(GetArea(line), vtkMath::Pi() * 20 * 12, 3);
  LACUNA_CHECK(line->GetPoint(0)[2] == 7);
  double low = 1e9;
  double high = -1e9;
  for (vtkIdType i = 0; i < line->GetNumberOfPoints(); ++i)
  {
    low = std::min(low, line->GetPoint(i)[0]);
    high = std::max(high, line->GetPoint(i)[0]);
  }
  LACUNA_CHECK_NEAR(low, 30, 0.1); // columns of the slice, not of the extent
  LACUNA_CHECK_NEAR(high, 70, 0.1);
  // around a place: the outer border from inside, the hole from the hole, the disc from the disc
  const double inside[2] = { 40, 28 };
  LACUNA_CHECK(vtkLacunaOutlineTools::Trace(picture, 120, inside, All, 1, line));
  LACUNA_CHECK_NEAR(GetArea(line), vtkMath::Pi() * 20 * 12, 3);
  const double hole[2] = { 57, 33 };
  LACUNA_CHECK(vtkLacunaOutlineTools::Trace(picture, 120, hole, All, 1, line));
  LACUNA_CHECK_NEAR(GetArea(line), vtkMath::Pi() * 16, 1);
  // in a rectangle: the disc; of what it cuts, the part within
  const int corner[4] = { 5, 25, 3, 25 };
  LACUNA_CHECK(vtkLacunaOutlineTools::Trace(picture, 120, Nowhere, corner, 1, line));
  LACUNA_CHECK_NEAR(GetArea(line), vtkMath::Pi() * 25, 1);
  const int half[4] = { 50, 84, 3, 62 };
  LACUNA_CHECK(vtkLacunaOutlineTools::Trace(picture, 120, Nowhere, half, 1, line));
  LACUNA_CHECK_NEAR(GetArea(line), vtkMath::Pi() * 20 * 12 / 2, 20);
  // none
  LACUNA_CHECK(!vtkLacunaOutlineTools::Trace(picture, 300, Nowhere, All, 1, line));
  const double outside[2] = { -10, 5 };
  LACUNA_CHECK(!vtkLacunaOutlineTools::Trace(picture, 120, outside, All, 1, line));

  // a median takes specks away
  for (int n = 0; n < 60; ++n)
  {
    picture->SetScalarComponentFromDouble(
      32 + (n * 7) % 37, 20 + (n * 5) % 21, 7, 0, n % 2 ? 40 : 255);
  }
  LACUNA_CHECK(vtkLacunaOutlineTools::Trace(picture, 120, inside, All, 5, line));
  LACUNA_CHECK_NEAR(GetArea(line), vtkMath::Pi() * 20 * 12, 25);

  vtkNew<vtkPoints> few;
  vtkLacunaOutlineTools::Simplify(line, 0.7, few);
  LACUNA_CHECK(
    few->GetNumberOfPoints() >= 8 && few->GetNumberOfPoints() < line->GetNumberOfPoints() / 2);
  LACUNA_CHECK_NEAR(GetArea(few), GetArea(line), 0.03 * GetArea(line));
}

void TestSnap()
{
  const auto picture = MakePicture();
  vtkNew<vtkPoints> points;
  constexpr int n = 16;
  for (int i = 0; i < n; ++i) // 2.5 pixels too far out
  {
    const double angle = 2 * vtkMath::Pi() * i / n;
    points->InsertNextPoint(15 + 7.5 * std::cos(angle), 12 + 7.5 * std::sin(angle), 0);
  }
  LACUNA_CHECK(vtkLacunaOutlineTools::Snap(picture, points, 5) == n);
  for (int i = 0; i < n; ++i)
  {
    double x[3];
    points->GetPoint(i, x);
    LACUNA_CHECK_NEAR(std::hypot(x[0] - 15, x[1] - 12), 5, 0.5);
  }
  // without an edge within reach they stay
  vtkNew<vtkPoints> far;
  for (const auto& p : { std::pair<double, double>{ 20, 50 }, { 24, 50 }, { 22, 54 } })
  {
    far->InsertNextPoint(p.first, p.second, 0);
  }
  LACUNA_CHECK(vtkLacunaOutlineTools::Snap(picture, far, 3) == 0);
  LACUNA_CHECK(far->GetPoint(1)[0] == 24);
}
}

int TestOutlineTools(int, char*[])
{
  TestCurve();
  TestTrace();
  TestSnap();
  return lacunaCheck::Result();
}
