// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaImplicitRegion.h"

#include "lacunaParameterText.h"
#include "vtkBox.h"
#include "vtkCylinder.h"
#include "vtkHomogeneousTransform.h"
#include "vtkImplicitBoolean.h"
#include "vtkImplicitFunctionCollection.h"
#include "vtkMatrix4x4.h"
#include "vtkPlane.h"
#include "vtkSphere.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

namespace
{
bool IsFinite(double x)
{
  return std::isfinite(x);
}

/// Says of one shape what is wrong with it.
class Checker
{
public:
  Checker(const std::string& property, const std::string& shape)
    : Subject(property + ": of the " + shape + " ")
  {
  }

  void Point(const char* name, const double* point) const
  {
    this->Numbers(name, { point, point + 3 }, "give three finite numbers, mm");
  }

  void Direction(const char* name, const double* direction) const
  {
    const std::vector<double> numbers(direction, direction + 3);
    const char* const wanted = "give a direction that is not zero";
    this->Numbers(name, numbers, wanted);
    this->Require(std::any_of(numbers.begin(), numbers.end(), [](double x) { return x != 0; }),
      name, numbers, wanted);
  }

  void Radius(double radius) const
  {
    this->Require(radius > 0 && std::isfinite(radius), "Radius", { radius }, "give more than 0 mm");
  }

  void Bounds(const double* bounds) const
  {
    const std::vector<double> numbers(bounds, bounds + 6);
    const char* const wanted = "give xmin, xmax, ymin, ymax, zmin, zmax, mm";
    this->Numbers("Bounds", numbers, wanted);
    this->Require(numbers[0] <= numbers[1] && numbers[2] <= numbers[3] && numbers[4] <= numbers[5],
      "Bounds", numbers, wanted);
  }

  void Transform(vtkAbstractTransform* transform) const
  {
    transform->Update();
    auto* homogeneous = vtkHomogeneousTransform::SafeDownCast(transform);
    if (homogeneous)
    {
      vtkMatrix4x4* matrix = homogeneous->GetMatrix();
      const std::vector<double> elements(matrix->GetData(), matrix->GetData() + 16);
      const char* const wanted = "give a position and rotation of finite numbers and a scale "
                                 "(ParaView: Length) that is not 0";
      this->Numbers("Transform", elements, wanted);
      this->Require(matrix->Determinant() != 0, "Transform", elements, wanted);
    }
  }

private:
  void Numbers(const char* name, const std::vector<double>& numbers, const char* wanted) const
  {
    this->Require(std::all_of(numbers.begin(), numbers.end(), IsFinite), name, numbers, wanted);
  }

  void Require(
    bool holds, const char* name, const std::vector<double>& numbers, const char* wanted) const
  {
    if (!holds)
    {
      throw std::runtime_error(
        this->Subject + name + " is " + lacuna::FormatValue(numbers) + "; " + wanted);
    }
  }

  std::string Subject;
};
}

//------------------------------------------------------------------------------
void lacuna::ImplicitRegion::Check(vtkImplicitFunction* region, const std::string& property)
{
  if (auto* plane = vtkPlane::SafeDownCast(region))
  {
    const Checker checker(property, "plane");
    checker.Point("Origin", plane->GetOrigin());
    checker.Direction("Normal", plane->GetNormal());
  }
  else if (auto* box = vtkBox::SafeDownCast(region))
  {
    double bounds[6];
    box->GetBounds(bounds);
    Checker(property, "box").Bounds(bounds);
  }
  else if (auto* sphere = vtkSphere::SafeDownCast(region))
  {
    const Checker checker(property, "sphere");
    checker.Point("Center", sphere->GetCenter());
    checker.Radius(sphere->GetRadius());
  }
  else if (auto* cylinder = vtkCylinder::SafeDownCast(region))
  {
    const Checker checker(property, "cylinder");
    checker.Point("Center", cylinder->GetCenter());
    checker.Direction("Axis", cylinder->GetAxis());
    checker.Radius(cylinder->GetRadius());
  }
  else if (auto* boolean = vtkImplicitBoolean::SafeDownCast(region))
  {
    vtkCollectionSimpleIterator iterator;
    boolean->GetFunction()->InitTraversal(iterator);
    while (vtkImplicitFunction* part = boolean->GetFunction()->GetNextImplicitFunction(iterator))
    {
      Check(part, property);
    }
  }
  if (region && region->GetTransform())
  {
    Checker(property, "region").Transform(region->GetTransform());
  }
}
