// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaFilledMap.h"

#include "lacunaArrays.h"
#include "lacunaDepthMap.h"
#include "lacunaFieldData.h"
#include "vtkAbstractArray.h"
#include "vtkCharArray.h"
#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkMatrix3x3.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

namespace
{
void AddArray(vtkImageData* map, const char* name, const std::vector<double>& values)
{
  vtkNew<vtkDoubleArray> array;
  array->SetName(name);
  lacuna::Arrays::SetNumberOfTuples(array, static_cast<vtkIdType>(values.size()));
  std::copy(values.begin(), values.end(), array->GetPointer(0));
  map->GetPointData()->AddArray(array);
}

void AddMask(vtkImageData* map, const char* name, const lacuna::MapMask& mask)
{
  vtkNew<vtkCharArray> array;
  array->SetName(name);
  lacuna::Arrays::SetNumberOfTuples(array, static_cast<vtkIdType>(mask.size()));
  std::copy(mask.begin(), mask.end(), array->GetPointer(0));
  map->GetPointData()->AddArray(array);
}

// The array at the nearest pixels; NaN, or 0 for integers, beside the map.
vtkSmartPointer<vtkAbstractArray> Pick(
  vtkAbstractArray* array, const std::vector<std::int64_t>& nearest)
{
  auto picked = vtkSmartPointer<vtkAbstractArray>::Take(array->NewInstance());
  picked->SetName(array->GetName());
  picked->SetNumberOfComponents(array->GetNumberOfComponents());
  lacuna::Arrays::SetNumberOfTuples(picked, static_cast<vtkIdType>(nearest.size()));
  auto* numbers = vtkDataArray::SafeDownCast(picked);
  const bool real =
    numbers && (numbers->GetDataType() == VTK_FLOAT || numbers->GetDataType() == VTK_DOUBLE);
  for (std::size_t i = 0; i < nearest.size(); ++i)
  {
    if (nearest[i] >= 0)
    {
      picked->SetTuple(static_cast<vtkIdType>(i), nearest[i], array);
    }
    else if (numbers)
    {
      for (int c = 0; c < numbers->GetNumberOfComponents(); ++c)
      {
        numbers->SetComponent(
          static_cast<vtkIdType>(i), c, real ? std::numeric_limits<double>::quiet_NaN() : 0);
      }
    }
  }
  return picked;
}

// The measured normals, with those of the fit in the defect.
void AddNormals(
  vtkImageData* map, const lacuna::DepthMap& contract, const lacuna::HoleFillResult& result)
{
  vtkDataArray* measured = map->GetPointData()->GetArray(lacuna::DepthMap::NormalsName);
  if (!measured)
  {
    return;
  }
  if (measured->GetNumberOfComponents() != 3)
  {
    throw std::runtime_error(std::string("point array '") + lacuna::DepthMap::NormalsName +
      "' of the depth map must have three components");
  }
  vtkNew<vtkFloatArray> normals;
  lacuna::Arrays::Copy(measured, normals);
  const lacuna::Matrix4& toWorld = contract.GetImageToWorld();
  const lacuna::Vec3 right = lacuna::Normalized(toWorld.Column(0));
  const lacuna::Vec3 down = lacuna::Normalized(toWorld.Column(1));
  const lacuna::Vec3 view = lacuna::Normalized(toWorld.Column(2));
  for (std::size_t k = 0; k < result.Gradients.size(); ++k)
  {
    const auto& g = result.Gradients[k];
    const lacuna::Vec3 n = lacuna::Normalized(g[0] * right + g[1] * down - view);
    normals->SetTuple(static_cast<vtkIdType>(result.Filled[k]), n.data());
  }
  map->GetPointData()->AddArray(normals);
}

void AddFieldData(
  vtkImageData* map, lacuna::RadialKernel kernel, const lacuna::HoleFillResult& result)
{
  const auto& c = result.Plane;
  const lacuna::Vec3 normal = lacuna::Normalized({ c[1], c[2], -1 });
  const auto& fit = result.Fit;
  lacuna::FieldData::Set(map, "RBFPlane", { c[0], c[1], c[2] }, 3);
  lacuna::FieldData::Set(map, "PlaneNormal", { normal[0], normal[1], normal[2] }, 3);
  lacuna::FieldData::Set(map, "NodeCount", { static_cast<double>(fit.NodeCount) }, 1);
  lacuna::FieldData::Set(map, "Residual", { fit.Residual }, 1);
  lacuna::FieldData::Set(map, "ConditionEstimate", { fit.ConditionEstimate }, 1);
  lacuna::FieldData::Set(map, "Iterations", { static_cast<double>(fit.Iterations) }, 1);
  if (kernel == lacuna::RadialKernel::ThinPlate)
  {
    lacuna::FieldData::Set(map, "BendingEnergy", { fit.Energy }, 1);
  }
  lacuna::FieldData::Set(map, "DefectArea", { result.DefectArea }, 1);
  lacuna::FieldData::Set(map, "FitTime", { result.FitSeconds }, 1);
}

void AddPointData(
  vtkImageData* filled, const lacuna::DepthMap& contract, const lacuna::HoleFillResult& result)
{
  lacuna::MapMask valid(result.Depth.size());
  lacuna::MapMask inside(result.Depth.size(), 0);
  lacuna::MapMask use(result.Depth.size());
  for (std::size_t i = 0; i < valid.size(); ++i)
  {
    valid[i] = std::isfinite(result.Depth[i]);
    use[i] = static_cast<unsigned char>(result.Use[i]);
  }
  for (std::size_t k = 0; k < result.Gradients.size(); ++k)
  {
    inside[result.Filled[k]] = 1;
  }
  AddArray(filled, lacuna::DepthMap::DepthName, result.Depth);
  AddMask(filled, lacuna::DepthMap::MaskName, valid);
  AddNormals(filled, contract, result);
  AddArray(filled, lacuna::DepthMap::FittedName, result.Fitted);
  AddMask(filled, lacuna::DepthMap::FilledMaskName, inside);
  AddArray(filled, lacuna::DepthMap::DeviationName, result.Deviation);
  AddMask(filled, lacuna::DepthMap::SupportMaskName, use);
  filled->GetPointData()->SetActiveScalars(lacuna::DepthMap::DepthName);
}
}

namespace lacuna::FilledMap
{
//------------------------------------------------------------------------------
void Make(vtkImageData* map, const lacuna::DepthMap& contract, const lacuna::HoleFillResult& result,
  lacuna::RadialKernel kernel, bool hasFit, vtkImageData* filled)
{
  const lacuna::MapGrid& grid = result.Grid;
  filled->ShallowCopy(map);
  std::vector<std::int64_t> same(static_cast<std::size_t>(map->GetNumberOfPoints()));
  std::iota(same.begin(), same.end(), std::int64_t(0));
  if (same != result.Nearest || grid.Spacing[0] != map->GetSpacing()[0] ||
    grid.Spacing[1] != map->GetSpacing()[1])
  {
    filled->GetPointData()->Initialize();
    filled->SetExtent(grid.FirstColumn, grid.FirstColumn + grid.Width - 1, grid.FirstRow,
      grid.FirstRow + grid.Height - 1, map->GetExtent()[4], map->GetExtent()[4]);
    // those of the map to the last bit, as they were announced, not the columns of ImageToWorld normalized
    const auto axis = [&](int c)
    {
      vtkMatrix3x3* m = map->GetDirectionMatrix();
      return lacuna::Vec3{ m->GetElement(0, c), m->GetElement(1, c), m->GetElement(2, c) };
    };
    lacuna::DepthMap::SetGeometry(filled,
      { contract.GetImageToWorld().Column(3), axis(0), axis(1), axis(2),
        { grid.Spacing[0], grid.Spacing[1] } });
    for (int i = 0; i < map->GetPointData()->GetNumberOfArrays(); ++i)
    {
      filled->GetPointData()->AddArray(
        Pick(map->GetPointData()->GetAbstractArray(i), result.Nearest));
    }
  }
  if (hasFit)
  {
    AddFieldData(filled, kernel, result);
  }
  AddPointData(filled, contract, result);
}
}
