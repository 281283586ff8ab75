// SPDX-License-Identifier: BSD-3-Clause
// The implant depends neither on how the head lay in the scanner nor on the scanner's grid, and that of a sphere is
// the sphere, whatever the direction of the hole.
#include "../../Kernel/Testing/lacunaSkullTest.h"
#include "lacunaCheck.h"
#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkLacunaSkullImplant.h"
#include "vtkMatrix3x3.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"
#include "vtkStaticCellLocator.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iostream>
#include <vector>

namespace
{
using lacuna::Matrix4;
using lacuna::Vec3;

// Where and how a head is scanned: its frame (origin amid the head) in the patient's coordinates, and the grid in the
// frame of the head.
struct Scan
{
  Matrix4 HeadToWorld;
  Matrix4 GridToHead; // a turn, and where the first voxel is
  Vec3 Spacing{ 0, 0, 0 };
  std::array<int, 3> Size{};
};

// values: of a point in the frame of the head
vtkSmartPointer<vtkImageData> Take(
  const Scan& scan, const std::function<double(const Vec3&)>& values)
{
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->SetDimensions(scan.Size.data());
  image->SetSpacing(scan.Spacing.data());
  const Matrix4 toWorld = scan.HeadToWorld * scan.GridToHead;
  image->SetOrigin(toWorld.Column(3).data());
  vtkNew<vtkMatrix3x3> directions;
  for (int row = 0; row < 3; ++row)
  {
    for (int column = 0; column < 3; ++column)
    {
      directions->SetElement(row, column, toWorld.Column(column)[row]);
    }
  }
  image->SetDirectionMatrix(directions);
  image->AllocateScalars(VTK_SHORT, 1);
  auto* voxel = static_cast<short*>(image->GetScalarPointer());
  for (int k = 0; k < scan.Size[2]; ++k)
  {
    for (int j = 0; j < scan.Size[1]; ++j)
    {
      for (int i = 0; i < scan.Size[0]; ++i, ++voxel)
      {
        *voxel = static_cast<short>(std::lround(values(scan.GridToHead.Point(
          { i * scan.Spacing[0], j * scan.Spacing[1], k * scan.Spacing[2] }))));
      }
    }
  }
  return image;
}

double AngleTo(const Vec3& axis, const Vec3& x)
{
  return std::acos(std::clamp(Dot(lacuna::Normalized(axis), lacuna::Normalized(x)), -1.0, 1.0));
}

const Vec3 HoleOfSkull{ 0.8, -0.3, 0.5 };

// The analytic skull, above 40 mm below its middle, with a hole 80 mm across.
double SkullValue(const Vec3& x)
{
  static const lacunaSkullTest::Skull skull;
  const double r = Norm(x);
  double depth = -3; // mm within bone
  if (r > 55 && r < 105 && x[2] > -45)
  {
    const Vec3 d = lacuna::Normalized(x);
    const double outer = skull.GetOuter(d);
    depth = std::min({ outer - r, r - outer + skull.GetThickness(d), x[2] + 40,
      r * (AngleTo(HoleOfSkull, x) - 0.5) });
  }
  return 300 + 200 * std::clamp(depth, -3.0, 3.0);
}

Scan SkullScan(double spacing, const Matrix4& turn = {})
{
  Scan scan;
  scan.Spacing = { spacing, spacing, spacing };
  const Vec3 half{ 100, 108, 98 };
  scan.GridToHead = turn * Matrix4::Translation(-1 * half);
  for (int a = 0; a < 3; ++a)
  {
    scan.Size[a] = static_cast<int>(2 * half[a] / spacing);
  }
  return scan;
}

// hole: a direction from the middle of the head
vtkSmartPointer<vtkPolyData> MakeImplant(
  vtkImageData* image, double level, const Vec3& hole, const Matrix4& headToWorld = {})
{
  vtkNew<vtkLacunaSkullImplant> filter;
  const auto messages = lacunaCheck::Watch(filter);
  filter->SetInputData(image);
  filter->SetLevel(level);
  filter->SetTriangleSize(2);
  filter->SetDefectChoice(vtkLacunaSkullImplant::NearestToPoint);
  filter->SetPoint(headToWorld.Point(80 * lacuna::Normalized(hole)).data());
  filter->Update();
  LACUNA_CHECK_THAT(messages->Errors.empty(), messages->Errors);
  return filter->GetOutput();
}

struct Distance
{
  double RMS = 0;
  double Largest = 0;
};

// Of the points of one surface from another.
Distance Compare(vtkPolyData* from, vtkPolyData* to, const Matrix4& move = {})
{
  vtkNew<vtkStaticCellLocator> tree;
  tree->SetDataSet(to);
  tree->BuildLocator();
  Distance distance;
  for (vtkIdType p = 0; p < from->GetNumberOfPoints(); ++p)
  {
    Vec3 x;
    from->GetPoint(p, x.data());
    x = move.Point(x);
    double nearest[3];
    vtkIdType cell = 0;
    int sub = 0;
    double square = 0;
    tree->FindClosestPoint(x.data(), nearest, cell, sub, square);
    distance.RMS += square / static_cast<double>(from->GetNumberOfPoints());
    distance.Largest = std::max(distance.Largest, std::sqrt(square));
  }
  distance.RMS = std::sqrt(distance.RMS);
  return distance;
}

void TestPlaces()
{
  const Scan scan = SkullScan(1.5);
  const auto first = MakeImplant(Take(scan, SkullValue), 300, HoleOfSkull);
  LACUNA_CHECK(first->GetNumberOfPoints() > 1000);

  // the same voxels with another direction matrix
  Scan turned = scan;
  turned.HeadToWorld =
    Matrix4::Translation({ 40, -350, 1200 }) * Matrix4::Rotation({ 1, -2, 0.7 }, 0.8);
  const Matrix4 back = turned.HeadToWorld.Inverse();
  const auto second = MakeImplant(Take(turned, SkullValue), 300, HoleOfSkull, turned.HeadToWorld);
  Distance distance = Compare(second, first, back);
  std::cout << "turned: RMS " << distance.RMS << " mm, largest " << distance.Largest << "\n";
  LACUNA_CHECK(distance.RMS < 0.02);
  LACUNA_CHECK(distance.Largest < 0.1);

  // the same head in a finer grid, across which it lies
  const auto third = MakeImplant(
    Take(SkullScan(1.35, Matrix4::Rotation({ -0.4, 1, 0.8 }, 0.35)), SkullValue), 300, HoleOfSkull);
  distance = Compare(third, first);
  const Distance inverse = Compare(first, third);
  std::cout << "resampled: RMS " << distance.RMS << " and " << inverse.RMS << " mm, largest "
            << distance.Largest << " and " << inverse.Largest << "\n";
  LACUNA_CHECK(distance.RMS < 0.15 && inverse.RMS < 0.15);
}

// A sphere of 75 mm, 6 mm thick, with a hole 86 mm across, blurred as voxels do. The scan ends below.
void TestSphere(const Vec3& hole, const Vec3& spacing)
{
  constexpr double radius = 75;
  const double blur = std::max({ spacing[0], spacing[1], spacing[2] });
  Scan scan;
  scan.Spacing = spacing;
  const Vec3 first{ -84.5, -84.5, -50 };
  scan.GridToHead = Matrix4::Translation(first);
  for (int a = 0; a < 3; ++a)
  {
    scan.Size[a] = static_cast<int>((84.5 - first[a]) / spacing[a]) + 1;
  }
  const auto value = [&](const Vec3& x)
  {
    const double r = Norm(x);
    const double depth = std::min({ radius - r, r - radius + 6, r * (AngleTo(hole, x) - 0.61) });
    return 500 + 500 * std::clamp(depth / blur, -1.0, 1.0);
  };
  const auto implant = MakeImplant(Take(scan, value), 500, hole);
  vtkDataArray* faces = implant->GetCellData()->GetArray("ImplantFace");
  double largest = 0;
  int corners = 0;
  for (vtkIdType c = 0; c < implant->GetNumberOfCells(); ++c)
  {
    if (faces->GetComponent(c, 0) == 0)
    {
      vtkIdType count = 0;
      const vtkIdType* ids = nullptr;
      implant->GetCellPoints(c, count, ids);
      for (vtkIdType corner = 0; corner < count; ++corner, ++corners)
      {
        Vec3 x;
        implant->GetPoint(ids[corner], x.data());
        largest = std::max(largest, std::abs(Norm(x) - radius));
      }
    }
  }
  std::cout << "sphere, hole at " << hole[0] << " " << hole[1] << " " << hole[2] << ": largest "
            << largest << " mm\n";
  LACUNA_CHECK(corners > 10000);
  LACUNA_CHECK(largest < 0.05);
}
}

int TestSkullImplantPlaces(int, char*[])
{
  TestPlaces();
  TestSphere({ std::sin(0.244), 0, std::cos(0.244) }, { 1, 1, 1 });
  TestSphere({ -0.7, 0.4, 0.5 }, { 0.8, 0.8, 1.3 });
  return lacunaCheck::Result();
}
