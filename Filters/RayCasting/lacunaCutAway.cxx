// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaCutAway.h"

#include "lacunaImplicitRegion.h"
#include "vtkBox.h"
#include "vtkCylinder.h"
#include "vtkDataArray.h"
#include "vtkHomogeneousTransform.h"
#include "vtkMatrix4x4.h"
#include "vtkPlane.h"
#include "vtkPlanes.h"
#include "vtkPoints.h"
#include "vtkSphere.h"

#include <cmath>
#include <mutex>

namespace
{
using lacuna::Vec3;

Vec3 ToVec3(const double* p)
{
  return { p[0], p[1], p[2] };
}

std::unique_ptr<lacuna::CutRegion> MakeExact(
  vtkImplicitFunction* function, const lacuna::Matrix4& worldToLocal)
{
  if (auto* plane = vtkPlane::SafeDownCast(function))
  {
    return std::make_unique<lacuna::ConvexRegion>(worldToLocal,
      std::vector<lacuna::ConvexRegion::Plane>{
        { ToVec3(plane->GetOrigin()), ToVec3(plane->GetNormal()) } });
  }
  if (auto* box = vtkBox::SafeDownCast(function))
  {
    double low[3];
    double high[3];
    box->GetXMin(low);
    box->GetXMax(high);
    std::vector<lacuna::ConvexRegion::Plane> planes;
    for (int a = 0; a < 3; ++a)
    {
      Vec3 normal{ 0, 0, 0 };
      normal[a] = 1;
      planes.push_back({ ToVec3(high), normal });
      normal[a] = -1;
      planes.push_back({ ToVec3(low), normal });
    }
    return std::make_unique<lacuna::ConvexRegion>(worldToLocal, planes);
  }
  if (auto* sphere = vtkSphere::SafeDownCast(function))
  {
    return std::make_unique<lacuna::RoundRegion>(
      worldToLocal, ToVec3(sphere->GetCenter()), Vec3{ 0, 0, 0 }, sphere->GetRadius());
  }
  if (auto* cylinder = vtkCylinder::SafeDownCast(function))
  {
    return std::make_unique<lacuna::RoundRegion>(worldToLocal, ToVec3(cylinder->GetCenter()),
      ToVec3(cylinder->GetAxis()), cylinder->GetRadius());
  }
  auto* planes = vtkPlanes::SafeDownCast(function);
  if (planes && planes->GetPoints() && planes->GetNormals() && planes->GetNumberOfPlanes() > 0)
  {
    std::vector<lacuna::ConvexRegion::Plane> all;
    for (int i = 0; i < planes->GetNumberOfPlanes(); ++i)
    {
      all.push_back(
        { ToVec3(planes->GetPoints()->GetPoint(i)), ToVec3(planes->GetNormals()->GetTuple3(i)) });
    }
    return std::make_unique<lacuna::ConvexRegion>(worldToLocal, all);
  }
  return nullptr;
}
}

//------------------------------------------------------------------------------
std::unique_ptr<lacuna::CutRegion> lacuna::CutAway::MakeRegion(
  vtkImplicitFunction* function, double step, const std::vector<lacuna::Vec3>& points)
{
  lacuna::ImplicitRegion::Check(function, "CutAway");
  lacuna::Matrix4 worldToLocal;
  bool isAffine = true;
  if (vtkAbstractTransform* transform = function->GetTransform())
  {
    transform->Update();
    auto* homogeneous = vtkHomogeneousTransform::SafeDownCast(transform);
    isAffine = homogeneous != nullptr;
    for (int i = 0; isAffine && i < 16; ++i)
    {
      const double element = homogeneous->GetMatrix()->GetElement(i / 4, i % 4);
      worldToLocal(i / 4, i % 4) = element;
      isAffine = i < 12 || element == (i == 15 ? 1 : 0);
    }
  }
  std::unique_ptr<lacuna::CutRegion> exact = isAffine ? MakeExact(function, worldToLocal) : nullptr;
  bool agrees = exact != nullptr;
  for (const Vec3& point : points)
  {
    const double value = function->FunctionValue(point.data());
    agrees = agrees && (std::abs(value) < 1e-6 || exact->Contains(point) == (value < 0));
  }
  if (agrees)
  {
    return exact;
  }
  // functions of VTK need not be safe to call from several threads
  const auto mutex = std::make_shared<std::mutex>();
  return std::make_unique<lacuna::FunctionRegion>(
    [function, mutex](const Vec3& point)
    {
      const std::lock_guard<std::mutex> lock(*mutex);
      return function->FunctionValue(point.data());
    },
    step);
}
