// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaFunctionText.h"

#include "lacunaParameterText.h"
#include "vtkBox.h"
#include "vtkCylinder.h"
#include "vtkDataArray.h"
#include "vtkHomogeneousTransform.h"
#include "vtkImplicitBoolean.h"
#include "vtkImplicitFunctionCollection.h"
#include "vtkImplicitSelectionLoop.h"
#include "vtkMatrix4x4.h"
#include "vtkPlane.h"
#include "vtkPlanes.h"
#include "vtkPoints.h"
#include "vtkSphere.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <iterator>
#include <sstream>
#include <vector>

namespace
{
std::array<double, 3> ToArray(const double* p)
{
  return { p[0], p[1], p[2] };
}

/// What an object prints of itself, on one line: nothing that differs from run to run, and no line
/// that begins with dropped.
std::string PrintedLine(vtkObject* object, const char* dropped = "Time:")
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
    // observers follow; the transform is told as its matrix
    if (line.rfind("Registered ", 0) == 0 || line.rfind("Transform:", 0) == 0)
    {
      skippedIndent = first;
    }
    else if (line.rfind("Debug:", 0) != 0 && line.rfind("Reference Count:", 0) != 0 &&
      line.rfind(dropped, 0) != 0 && line.find("Time:") == std::string::npos &&
      line.find("0x") == std::string::npos)
    {
      text += (text.empty() ? "" : "; ") + line;
    }
  }
  return text;
}

/// Adds the shape of the classes that are known here, and of what is derived from them.
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

void AddLoop(vtkImplicitSelectionLoop* loop, lacuna::ParameterText& text)
{
  if (!std::strcmp(loop->GetClassName(), "vtkImplicitSelectionLoop"))
  {
    // derived classes make the corners of something shorter, which they print
    std::vector<double> corners;
    for (vtkIdType i = 0; loop->GetLoop() && i < loop->GetLoop()->GetNumberOfPoints(); ++i)
    {
      const double* p = loop->GetLoop()->GetPoint(i);
      corners.insert(corners.end(), p, p + 3);
    }
    text.Add("Loop", corners);
  }
  if (!loop->GetAutomaticNormalGeneration())
  {
    text.Add("Normal", ToArray(loop->GetNormal()));
  }
}

/// ParaView's cylinder is one along y that its transform turns about its centre. Adds the cylinder as
/// users set it, in the world. False when function is none, or something else than turned.
bool AddTurnedCylinder(vtkImplicitFunction* function, lacuna::ParameterText& text)
{
  auto* cylinder = vtkCylinder::SafeDownCast(function);
  auto* transform = vtkHomogeneousTransform::SafeDownCast(function->GetTransform());
  if (!cylinder || !transform || std::strcmp(function->GetClassName(), "vtkPVCylinder") != 0)
  {
    return false;
  }
  transform->Update();
  const vtkMatrix4x4* matrix = transform->GetMatrix();
  const double* center = cylinder->GetCenter();
  std::array<double, 3> axis{};
  double off = 0;
  for (int a = 0; a < 3; ++a)
  {
    double moved = matrix->GetElement(a, 3);
    for (int b = 0; b < 3; ++b)
    {
      double product = 0; // of two columns
      for (int i = 0; i < 3; ++i)
      {
        product += matrix->GetElement(i, a) * matrix->GetElement(i, b);
      }
      off = std::max(off, std::abs(product - (a == b ? 1 : 0)));
      moved += matrix->GetElement(a, b) * center[b];
      axis[a] += matrix->GetElement(b, a) * cylinder->GetAxis()[b]; // the inverse
    }
    off = std::max({ off, std::abs(moved - center[a]) / (1 + std::abs(center[a])),
      std::abs(matrix->GetElement(3, a)) });
  }
  if (!(off <= 1e-9))
  {
    return false;
  }
  for (double& x : axis)
  {
    x = std::round(x * 1e15) / 1e15 + 0.0; // no 1e-17 and no -0
  }
  text.Add("Center", ToArray(center)).Add("Axis", axis).Add("Radius", cylinder->GetRadius());
  return true;
}

/// Whether what AddShape adds, and the transform, are all there is to functions of this class.
bool IsExactClass(const std::string& name)
{
  const char* const names[] = { "vtkPlane", "vtkBox", "vtkSphere", "vtkCylinder", "vtkPlanes",
    "vtkImplicitSelectionLoop", "vtkPVBox", "vtkPVCylinder" };
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
std::string lacuna::FunctionText::Describe(vtkImplicitFunction* function)
{
  if (!function)
  {
    return "None";
  }
  const std::string name = function->GetClassName();
  lacuna::ParameterText text;
  if (AddTurnedCylinder(function, text))
  {
    return name + " " + text.Get();
  }
  const bool isKnown = AddShape(function, text);
  auto* loop = vtkImplicitSelectionLoop::SafeDownCast(function);
  if (loop)
  {
    AddLoop(loop, text);
  }
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
  else if (!IsExactClass(name))
  {
    // an automatic normal is whatever the last evaluation has left
    text.Add("Printed", PrintedLine(function, loop ? "Normal:" : "Time:"));
  }
  if (vtkAbstractTransform* transform = function->GetTransform())
  {
    AddTransform(transform, text);
  }
  return name + (text.Get().empty() ? "" : " ") + text.Get();
}
