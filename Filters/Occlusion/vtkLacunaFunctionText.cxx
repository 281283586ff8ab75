// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaFunctionText.h"

#include "lacunaParameterText.h"
#include "vtkBox.h"
#include "vtkCylinder.h"
#include "vtkHomogeneousTransform.h"
#include "vtkMatrix4x4.h"
#include "vtkPiecewiseFunction.h"
#include "vtkSphere.h"

#include <cstddef>
#include <vector>

void vtkLacunaFunctionText::Add(
  lacuna::ParameterText& text, const char* name, vtkPiecewiseFunction* function)
{
  std::vector<double> nodes(4 * static_cast<std::size_t>(function->GetSize()));
  for (int i = 0; i < function->GetSize(); ++i)
  {
    function->GetNodeValue(i, nodes.data() + 4 * static_cast<std::size_t>(i));
  }
  text.Add(name, nodes);
}

void vtkLacunaFunctionText::Add(
  lacuna::ParameterText& text, const char* name, vtkImplicitFunction* function)
{
  text.Add(name, function->GetClassName());
  const auto add = [&text](const char* key, const double* values, int count)
  { text.Add(key, std::vector<double>(values, values + count)); };
  if (auto* sphere = vtkSphere::SafeDownCast(function))
  {
    add("Center", sphere->GetCenter(), 3);
    text.Add("Radius", sphere->GetRadius());
  }
  else if (auto* cylinder = vtkCylinder::SafeDownCast(function))
  {
    add("Center", cylinder->GetCenter(), 3);
    add("Axis", cylinder->GetAxis(), 3);
    text.Add("Radius", cylinder->GetRadius());
  }
  else if (auto* box = vtkBox::SafeDownCast(function))
  {
    double bounds[6];
    box->GetBounds(bounds);
    add("Bounds", bounds, 6);
  }
  if (auto* transform = vtkHomogeneousTransform::SafeDownCast(function->GetTransform()))
  {
    add("Transform", transform->GetMatrix()->GetData(), 16);
  }
}
