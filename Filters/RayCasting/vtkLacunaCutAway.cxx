// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaCutAway.h"

#include "lacunaParameterText.h"

#include "vtkBox.h"
#include "vtkCylinder.h"
#include "vtkDataArray.h"
#include "vtkHomogeneousTransform.h"
#include "vtkImplicitBoolean.h"
#include "vtkImplicitFunctionCollection.h"
#include "vtkMatrix4x4.h"
#include "vtkPlane.h"
#include "vtkPlanes.h"
#include "vtkPoints.h"
#include "vtkSphere.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <mutex>
#include <sstream>
#include <stdexcept>

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

std::array<double, 3> ToArray(const double* p)
{
  return { p[0], p[1], p[2] };
}

/// What an object prints of itself, on one line: nothing that differs from run to run.
std::string PrintedLine(vtkObject* object)
{
  std::ostringstream stream;
  object->PrintSelf(stream, vtkIndent());
  std::istringstream lines(stream.str());
  std::string text;
  std::string line;
  std::size_t skippedIndent = std::string::npos;
  while (std::getline(lines, line))
  {
    const std::size_t first = line.find_first_not_of(' ');
    if (first == std::string::npos || first > skippedIndent)
    {
      continue;
    }
    skippedIndent = std::string::npos;
    line.erase(0, first);
    if (line.rfind("Registered ", 0) == 0) // observers follow
    {
      skippedIndent = first;
    }
    else if (line.rfind("Debug:", 0) != 0 && line.rfind("Reference Count:", 0) != 0 &&
      line.find("Time:") == std::string::npos && line.find("0x") == std::string::npos)
    {
      text += (text.empty() ? "" : "; ") + line;
    }
  }
  return text;
}

/// Adds the shape of what MakeExact knows; false for all others.
bool AddShape(vtkImplicitFunction* function, lacuna::ParameterText& text)
{
  if (auto* plane = vtkPlane::SafeDownCast(function))
  {
    text.Add("Origin", ToArray(plane->GetOrigin())).Add("Normal", ToArray(plane->GetNormal()));
    return true;
  }
  if (auto* box = vtkBox::SafeDownCast(function))
  {
    std::array<double, 6> bounds;
    box->GetBounds(bounds.data());
    text.Add("Bounds", bounds);
    return true;
  }
  if (auto* sphere = vtkSphere::SafeDownCast(function))
  {
    text.Add("Center", ToArray(sphere->GetCenter())).Add("Radius", sphere->GetRadius());
    return true;
  }
  if (auto* cylinder = vtkCylinder::SafeDownCast(function))
  {
    text.Add("Center", ToArray(cylinder->GetCenter()))
      .Add("Axis", ToArray(cylinder->GetAxis()))
      .Add("Radius", cylinder->GetRadius());
    return true;
  }
  auto* planes = vtkPlanes::SafeDownCast(function);
  if (planes && planes->GetPoints() && planes->GetNormals())
  {
    std::vector<double> origins;
    std::vector<double> normals;
    for (int i = 0; i < planes->GetNumberOfPlanes(); ++i)
    {
      for (int a = 0; a < 3; ++a)
      {
        origins.push_back(planes->GetPoints()->GetPoint(i)[a]);
        normals.push_back(planes->GetNormals()->GetComponent(i, a));
      }
    }
    text.Add("Origins", origins).Add("Normals", normals);
    return true;
  }
  return false;
}

bool IsExactClass(const std::string& name)
{
  const char* const names[] = { "vtkPlane", "vtkBox", "vtkSphere", "vtkCylinder", "vtkPlanes" };
  return std::find(std::begin(names), std::end(names), name) != std::end(names);
}

void AddTransform(vtkAbstractTransform* transform, lacuna::ParameterText& text)
{
  transform->Update();
  auto* homogeneous = vtkHomogeneousTransform::SafeDownCast(transform);
  if (!homogeneous)
  {
    text.Add("Transform", std::string(transform->GetClassName()) + "; " + PrintedLine(transform));
    return;
  }
  std::array<double, 16> elements;
  for (int i = 0; i < 16; ++i)
  {
    elements[i] = homogeneous->GetMatrix()->GetElement(i / 4, i % 4);
  }
  text.Add("Transform", elements);
}
}

//------------------------------------------------------------------------------
std::string vtkLacunaCutAway::Describe(vtkImplicitFunction* function)
{
  if (!function)
  {
    return "None";
  }
  const std::string name = function->GetClassName();
  lacuna::ParameterText text;
  const bool isKnown = AddShape(function, text);
  auto* boolean = isKnown ? nullptr : vtkImplicitBoolean::SafeDownCast(function);
  if (boolean)
  {
    text.Add("Operation", boolean->GetOperationTypeAsString());
    vtkCollectionSimpleIterator iterator;
    boolean->GetFunction()->InitTraversal(iterator);
    while (vtkImplicitFunction* part = boolean->GetFunction()->GetNextImplicitFunction(iterator))
    {
      text.Add("Part", Describe(part));
    }
  }
  // subclasses may have more that makes their shape
  else if (!isKnown || !IsExactClass(name))
  {
    text.Add("Printed", PrintedLine(function));
  }
  if (vtkAbstractTransform* transform = function->GetTransform())
  {
    AddTransform(transform, text);
  }
  return name + (text.Get().empty() ? "" : " ") + text.Get();
}

//------------------------------------------------------------------------------
std::unique_ptr<lacuna::CutRegion> vtkLacunaCutAway::MakeRegion(
  vtkImplicitFunction* function, double step, const std::vector<lacuna::Vec3>& points)
{
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
