// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaFittedPart.h"

#include "lacunaCoordinates.h"
#include "lacunaDepthMap.h"
#include "lacunaFaceRelief.h"
#include "vtkCellArray.h"
#include "vtkCellArrayIterator.h"
#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkLacunaImplantPlate.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

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

std::string NamePixel(std::int64_t column, std::int64_t row)
{
  return std::to_string(column) + ", " + std::to_string(row);
}

void CheckAxes(const lacuna::Matrix4& toWorld, const std::string& purpose)
{
  if (!toWorld.IsFinite() || !toWorld.IsAffine())
  {
    throw std::runtime_error("ImageToWorld of the depth map is not an affine transform");
  }
  if (toWorld.Determinant3() < 0)
  {
    throw std::runtime_error(
      "ImageToWorld of the depth map mirrors; " + purpose + " would be the patient's mirror image");
  }
  for (int a = 0; a < 3; ++a)
  {
    for (int b = 0; b < 3; ++b)
    {
      const double dot = lacuna::Dot(toWorld.Column(a), toWorld.Column(b));
      if (!(std::abs(dot - (a == b ? 1 : 0)) < 1e-6))
      {
        throw std::runtime_error("the axes of the depth map are not perpendicular unit vectors; " +
          purpose + " would be distorted");
      }
    }
  }
}
}

//------------------------------------------------------------------------------
lacuna::FittedPart::FittedPart(vtkImageData* map, const std::string& purpose)
{
  const lacuna::DepthMap contract(map);
  if (contract.IsPerspective())
  {
    throw std::runtime_error("this is a perspective depth map; " + purpose +
      " needs a parallel one, filled by RBF Hole Filler");
  }
  if (lacuna::Coordinates::IsMirrored(map))
  {
    throw std::runtime_error("the depth map is a mirror image (field data Mirrored), so " +
      purpose +
      " made from it would not fit the patient; use Mirror's output as a pattern only, and fill "
      "the "
      "patient's own map");
  }
  vtkDataArray* fitted = GetArray(map, lacuna::DepthMap::FittedName);
  vtkDataArray* filled = GetArray(map, lacuna::DepthMap::FilledMaskName);
  const int* extent = map->GetExtent();
  const std::int64_t columns = std::int64_t{ extent[1] } - extent[0] + 1;
  const std::int64_t rows = std::int64_t{ extent[3] } - extent[2] + 1;
  std::int64_t first[2] = { columns, rows };
  std::int64_t last[2] = { -1, -1 };
  bool any = false;
  for (std::int64_t k = 0; k < columns * rows; ++k)
  {
    const std::int64_t at[2] = { k % columns, k / columns };
    const bool number = std::isfinite(fitted->GetComponent(k, 0));
    if (filled->GetComponent(k, 0) != 0)
    {
      any = true;
      if (!number)
      {
        throw std::runtime_error("pixel " + NamePixel(extent[0] + at[0], extent[2] + at[1]) +
          " is marked in FilledMask, but Fitted is no number there; use both as RBF Hole Filler "
          "gives them");
      }
    }
    for (int i = 0; number && i < 2; ++i)
    {
      first[i] = std::min(first[i], at[i]);
      last[i] = std::max(last[i], at[i]);
    }
  }
  if (!any)
  {
    throw std::runtime_error("no pixel of the depth map is filled (FilledMask is 0 everywhere), so "
                             "there is no defect to make " +
      purpose + " for; mark it in RBF Hole Filler");
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
        throw std::runtime_error("Fitted has a hole at pixel " +
          NamePixel(extent[0] + i, extent[2] + j) +
          "; it must be a complete rectangle, as RBF Hole Filler gives it");
      }
      this->Depths.push_back(depth);
      this->Mask.push_back(filled->GetComponent(i + columns * j, 0) != 0);
    }
  }
  this->Spacing = contract.GetPixelSpacing();
  this->ToWorld = contract.GetImageToWorld() *
    lacuna::Matrix4::Translation(
      { static_cast<double>(extent[0] + first[0]), static_cast<double>(extent[2] + first[1]), 0 }) *
    lacuna::Matrix4::Scaling({ 1 / this->Spacing[0], 1 / this->Spacing[1], 1 });
  CheckAxes(this->ToWorld, purpose);
}

//------------------------------------------------------------------------------
lacuna::FittedPart::FittedPart(lacuna::Execution& execution, vtkPolyData* solid, double spacing,
  double margin, const std::string& purpose)
{
  if (lacuna::Coordinates::IsMirrored(solid))
  {
    throw std::runtime_error("the solid is a mirror image (field data Mirrored), so " + purpose +
      " made from it would not fit the patient");
  }
  vtkDataArray* faces = nullptr;
  for (const char* name : { "ImplantFace", vtkLacunaImplantPlate::PlateFaceName })
  {
    faces = faces ? faces : solid->GetCellData()->GetArray(name);
  }
  vtkCellArray* polys = solid->GetPolys();
  if (!faces || faces->GetNumberOfComponents() != 1 || polys->IsHomogeneous() != 3 ||
    polys->GetNumberOfCells() != solid->GetNumberOfCells())
  {
    throw std::runtime_error("the surface is no solid of triangles with the cell array ImplantFace "
                             "or PlateFace, which says "
                             "where its outer face is; give the output of Skull Implant or Implant "
                             "Plate, or a filled depth map");
  }
  std::vector<lacuna::Vec3> points(static_cast<std::size_t>(solid->GetNumberOfPoints()));
  for (std::size_t k = 0; k < points.size(); ++k)
  {
    solid->GetPoint(static_cast<vtkIdType>(k), points[k].data());
    if (!lacuna::IsFinite(points[k]))
    {
      throw std::runtime_error("point " + std::to_string(k) + " of the surface is not finite");
    }
  }
  std::vector<lacuna::Triangle> outer;
  auto cells = vtk::TakeSmartPointer(polys->NewIterator());
  vtkIdType cell = 0;
  for (cells->GoToFirstCell(); !cells->IsDoneWithTraversal(); cells->GoToNextCell(), ++cell)
  {
    vtkIdType size;
    const vtkIdType* ids;
    cells->GetCurrentCell(size, ids);
    if (faces->GetComponent(cell, 0) == 0)
    {
      outer.push_back(
        { static_cast<int>(ids[0]), static_cast<int>(ids[1]), static_cast<int>(ids[2]) });
    }
  }
  if (outer.empty())
  {
    throw std::runtime_error(std::string("no triangle of the surface is of the outer face (0 in ") +
      faces->GetName() + ")");
  }
  const lacuna::FaceRelief relief =
    lacuna::MakeFaceRelief(execution, points, outer, spacing, margin);
  this->Size = relief.Size;
  this->Spacing = { spacing, spacing };
  this->Depths = relief.Depths;
  this->Mask = relief.Mask;
  this->ToWorld = relief.ToWorld;
  this->Deviation = relief.Deviation;
  this->SteepestAngle = relief.SteepestAngle;
}
