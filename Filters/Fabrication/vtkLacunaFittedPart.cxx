// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaFittedPart.h"

#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkLacunaDepthMap.h"
#include "vtkPointData.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace
{
vtkDataArray* GetArray(vtkImageData* map, const char* name)
{
  vtkDataArray* array = map->GetPointData()->GetArray(name);
  if (!array || array->GetNumberOfComponents() != 1)
  {
    throw std::runtime_error(std::string("the depth map has no point array '") + name +
      "' with one component; run RBF Hole Filler on it first");
  }
  return array;
}
}

//------------------------------------------------------------------------------
vtkLacunaFittedPart::vtkLacunaFittedPart(vtkImageData* map)
{
  const vtkLacunaDepthMap contract(map);
  if (contract.IsPerspective())
  {
    throw std::runtime_error("this is a perspective depth map; a parallel one is needed, "
                             "filled by RBF Hole Filler");
  }
  vtkDataArray* fitted = GetArray(map, vtkLacunaDepthMap::FittedName);
  vtkDataArray* filled = GetArray(map, vtkLacunaDepthMap::FilledMaskName);
  int dimensions[3];
  map->GetDimensions(dimensions);
  const std::int64_t columns = dimensions[0];
  std::int64_t first[2] = { dimensions[0], dimensions[1] };
  std::int64_t last[2] = { -1, -1 };
  bool any = false;
  for (vtkIdType k = 0; k < fitted->GetNumberOfTuples(); ++k)
  {
    const bool number = std::isfinite(fitted->GetComponent(k, 0));
    if (filled->GetComponent(k, 0) != 0)
    {
      any = true;
      if (!number)
      {
        throw std::runtime_error("pixel " + std::to_string(k % columns) + ", " +
          std::to_string(k / columns) +
          " is marked in FilledMask, but Fitted is no number there; "
          "use both as RBF Hole Filler gives them");
      }
    }
    if (number)
    {
      const std::int64_t at[2] = { k % columns, k / columns };
      for (int i = 0; i < 2; ++i)
      {
        first[i] = std::min(first[i], at[i]);
        last[i] = std::max(last[i], at[i]);
      }
    }
  }
  if (!any)
  {
    throw std::runtime_error("no pixel of the depth map is filled (FilledMask is 0 everywhere), so "
                             "there is no defect to make anything for; mark it in RBF Hole Filler");
  }
  this->Column = first[0];
  this->Row = first[1];
  this->Size = { last[0] - first[0] + 1, last[1] - first[1] + 1 };
  for (std::int64_t j = first[1]; j <= last[1]; ++j)
  {
    for (std::int64_t i = first[0]; i <= last[0]; ++i)
    {
      const double depth = fitted->GetComponent(i + columns * j, 0);
      if (!std::isfinite(depth))
      {
        throw std::runtime_error("Fitted has a hole at pixel " + std::to_string(i) + ", " +
          std::to_string(j) + "; it must be a complete rectangle, as RBF Hole Filler gives it");
      }
      this->Depths.push_back(depth);
      this->Mask.push_back(filled->GetComponent(i + columns * j, 0) != 0);
    }
  }
  this->Spacing = contract.GetPixelSpacing();
  const int* extent = map->GetExtent();
  this->ToWorld = contract.GetImageToWorld() *
    lacuna::Matrix4::Translation({ static_cast<double>(extent[0] + this->Column),
      static_cast<double>(extent[2] + this->Row), 0 }) *
    lacuna::Matrix4::Scaling({ 1 / this->Spacing[0], 1 / this->Spacing[1], 1 });
  if (this->ToWorld.Determinant3() < 0)
  {
    throw std::runtime_error("ImageToWorld of the depth map mirrors; what is made of it would be "
                             "the patient's mirror image");
  }
}
