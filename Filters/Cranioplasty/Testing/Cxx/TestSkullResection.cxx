// SPDX-License-Identifier: BSD-3-Clause
// A cut around tumours in turned masks with thick slices keeps its margin; what cannot be a tumour or an outline is refused.
#include "lacunaCheck.h"
#include "lacunaVector.h"
#include "vtkCellArray.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkLacunaSkullResection.h"
#include "vtkMatrix4x4.h"
#include "vtkNew.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"
#include "vtkTransform.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

namespace
{
using lacuna::Vec3;

constexpr double Radius = 60; // mm, of a whole shell around the origin
const Vec3 Tumour{ 20, -15, 25 };

vtkSmartPointer<vtkImageData> MakeHead()
{
  auto head = vtkSmartPointer<vtkImageData>::New();
  head->SetExtent(-33, 33, -33, 33, -33, 33);
  head->SetSpacing(2, 2, 2);
  head->AllocateScalars(VTK_SHORT, 1);
  auto* voxel = static_cast<short*>(head->GetScalarPointer());
  for (vtkIdType k = 0; k < head->GetNumberOfPoints(); ++k)
  {
    Vec3 x{};
    head->GetPoint(k, x.data());
    const double inside = std::min(Radius - Norm(x), Norm(x) - Radius + 6);
    voxel[k] = static_cast<short>(std::lround(std::clamp(300 + 150 * inside, -200.0, 900.0)));
  }
  return head;
}

// An ellipsoid of 12, 8 and 6 mm around Tumour, or two balls, in slices of 5 mm that are turned.
vtkSmartPointer<vtkImageData> MakeMask(const std::function<bool(const Vec3&)>& isTumour)
{
  auto mask = vtkSmartPointer<vtkImageData>::New();
  mask->SetExtent(3, 83, -4, 76, 1, 13);
  mask->SetSpacing(0.6, 0.6, 5);
  vtkNew<vtkTransform> turn;
  turn->RotateWXYZ(50, 1, 2, -1);
  double direction[9];
  for (int k = 0; k < 9; ++k)
  {
    direction[k] = turn->GetMatrix()->GetElement(k / 3, k % 3);
  }
  mask->SetDirectionMatrix(direction);
  double middle[3];
  mask->TransformContinuousIndexToPhysicalPoint(43, 36, 7, middle);
  mask->SetOrigin(Tumour[0] - middle[0], Tumour[1] - middle[1], Tumour[2] - middle[2]);
  mask->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
  auto* voxel = static_cast<unsigned char*>(mask->GetScalarPointer());
  for (vtkIdType k = 0; k < mask->GetNumberOfPoints(); ++k)
  {
    Vec3 x{};
    mask->GetPoint(k, x.data());
    voxel[k] = isTumour(x - Tumour) ? 1 : 0;
  }
  return mask;
}

bool IsInEllipsoid(const Vec3& x)
{
  return std::hypot(x[0] / 12, x[1] / 8, x[2] / 6) < 1;
}

void TestMargin(double margin)
{
  const vtkSmartPointer<vtkImageData> mask = MakeMask(IsInEllipsoid);
  vtkNew<vtkLacunaSkullResection> cut;
  cut->SetInputData(MakeHead());
  cut->SetInputData(2, mask);
  cut->SetMargin(margin);
  cut->SetGuideWidth(0);
  cut->Update();
  auto* outline = vtkPolyData::SafeDownCast(cut->GetOutputDataObject(1));
  auto* piece = vtkPolyData::SafeDownCast(cut->GetOutputDataObject(2));
  LACUNA_CHECK(outline->GetNumberOfPoints() > 20);
  Vec3 way{};
  piece->GetFieldData()->GetArray("CutDirection")->GetTuple(0, way.data());
  // corners of voxels, and places between them
  std::vector<Vec3> tumour;
  auto* voxel = static_cast<unsigned char*>(mask->GetScalarPointer());
  int extent[6];
  mask->GetExtent(extent);
  for (int k = extent[4]; k <= extent[5]; ++k)
  {
    for (int j = extent[2]; j <= extent[3]; ++j)
    {
      for (int i = extent[0]; i <= extent[1]; ++i, ++voxel)
      {
        for (int corner = 0; *voxel && corner < 44; ++corner)
        {
          Vec3 x{};
          mask->TransformContinuousIndexToPhysicalPoint(i + (corner % 2 ? 0.5 : -0.5),
            j + (corner / 2 % 2 ? 0.5 : -0.5), k - 0.5 + corner / 4 / 10.0, x.data());
          tumour.push_back(x);
        }
      }
    }
  }
  double nearest = 1e3;
  double farthest = 0;
  for (vtkIdType p = 0; p < outline->GetNumberOfPoints(); ++p)
  {
    Vec3 x{};
    outline->GetPoint(p, x.data());
    double least = 1e3;
    for (const Vec3& y : tumour)
    {
      least = std::min(least, Norm(x - y - Dot(x - y, way) * way));
    }
    nearest = std::min(nearest, least);
    farthest = std::max(farthest, least);
  }
  LACUNA_CHECK_NEAR(nearest, margin, 0.2);
  LACUNA_CHECK_NEAR(farthest, margin, 0.2);
}

using Change = std::function<void(vtkLacunaSkullResection*)>;

void CheckError(const Change& change, const std::string& text)
{
  vtkNew<vtkLacunaSkullResection> cut;
  cut->SetInputData(MakeHead());
  const auto messages = lacunaCheck::Watch(cut);
  change(cut);
  cut->Update();
  if (!messages->HasError(text))
  {
    lacunaCheck::Fail(__FILE__, __LINE__, "'" + text + "' is not in '" + messages->Errors + "'");
  }
}

vtkSmartPointer<vtkPolyData> MakeRing(int rings, double height = 50)
{
  auto data = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkCellArray> lines;
  for (int ring = 0; ring < rings; ++ring)
  {
    lines->InsertNextCell(40);
    for (int k = 0; k < 40; ++k)
    {
      const double angle = 2 * 3.14159265358979 * k / 40;
      lines->InsertCellPoint(
        points->InsertNextPoint(30 * ring + 12 * std::cos(angle), 12 * std::sin(angle), height));
    }
  }
  data->SetPoints(points);
  data->SetLines(lines);
  return data;
}

void TestErrors()
{
  const auto mask = [](const std::function<bool(const Vec3&)>& isTumour, double margin = 10)
  {
    return [=](vtkLacunaSkullResection* cut)
    {
      cut->SetInputData(2, MakeMask(isTumour));
      cut->SetMargin(margin);
    };
  };
  CheckError(mask([](const Vec3&) { return false; }), "the tumour is empty");
  CheckError(mask(IsInEllipsoid, 0), "Margin is 0 mm; it must be from 1 to 50 mm");
  CheckError(mask([](const Vec3& x) { return std::hypot(std::abs(x[0]) - 15, x[1], x[2]) < 5; }, 2),
    "the tumour is in 2 parts");
  CheckError([](auto* cut) { cut->SetInputData(1, MakeRing(2)); }, "the outline has 2 lines");
  CheckError(
    [](auto* cut)
    {
      const vtkSmartPointer<vtkPolyData> ring = MakeRing(1);
      ring->GetPoints()->SetPoint(7, std::nan(""), 0, 50);
      cut->SetInputData(1, ring);
    },
    "a point of the outline is not finite");
  CheckError([](auto* cut) { cut->SetInputData(1, MakeRing(1, 1e9)); }, "not at the head");
}
}

int TestSkullResection(int, char*[])
{
  TestMargin(10);
  TestMargin(2);
  TestErrors();
  return lacunaCheck::Result();
}
