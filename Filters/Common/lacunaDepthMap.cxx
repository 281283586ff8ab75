// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaDepthMap.h"

#include "lacunaFieldData.h"
#include "lacunaVolumeDirection.h"
#include "vtkAbstractArray.h"
#include "vtkAlgorithm.h"
#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkMatrix3x3.h"
#include "vtkMatrix4x4.h"
#include "vtkPointData.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>

//------------------------------------------------------------------------------
lacuna::DepthMap::DepthMap(vtkImageData* map)
{
  const int* extent = map->GetExtent();
  if (extent[4] != extent[5])
  {
    std::ostringstream message;
    message << "a depth map is one pixel deep (W x H x 1), this image has "
            << extent[5] - extent[4] + 1
            << " layers. B-Spline Iso Ray Caster makes a depth map of a volume: put it before this "
               "filter";
    throw std::runtime_error(message.str());
  }
  this->Depth = map->GetPointData()->GetArray(DepthName);
  if (!this->Depth || this->Depth->GetNumberOfComponents() != 1)
  {
    throw std::runtime_error(std::string("a depth map has a one-component point array '") +
      DepthName + "', which is missing here");
  }
  vtkPointData* arrays = map->GetPointData();
  for (int i = 0; i < arrays->GetNumberOfArrays(); ++i)
  {
    vtkAbstractArray* array = arrays->GetAbstractArray(i);
    if (array->GetNumberOfTuples() != map->GetNumberOfPoints())
    {
      std::ostringstream message;
      message << "point array '" << (array->GetName() ? array->GetName() : "") << "' has "
              << array->GetNumberOfTuples() << " tuples; the depth map has "
              << map->GetNumberOfPoints() << " pixels";
      throw std::runtime_error(message.str());
    }
  }
  this->ImageToWorld =
    lacuna::FieldData::GetMatrix(lacuna::FieldData::Get(map, ImageToWorldName, 16, 1), 0);
  const vtkMatrix4x4* own = map->GetIndexToPhysicalMatrix();
  const double tolerance = 1e-6 * (map->GetSpacing()[0] + map->GetSpacing()[1]);
  for (int r = 0; r < 3; ++r)
  {
    for (const int c : { 0, 1, 2, 3 })
    {
      if (!(std::abs(own->GetElement(r, c) - this->ImageToWorld(r, c)) <= tolerance))
      {
        throw std::runtime_error(std::string("field data array '") + ImageToWorldName +
          "' disagrees with the origin, spacing and direction of the image: a filter in between "
          "has changed one of them (Median and Resample To Image reset the direction)");
      }
    }
  }
  if (vtkDataArray* eye = lacuna::FieldData::Find(map, EyePositionName, 3, 1))
  {
    this->Perspective = true;
    eye->GetTuple(0, this->Eye.data());
  }
}

//------------------------------------------------------------------------------
lacuna::Vec3 lacuna::DepthMap::GetRay(double column, double row) const
{
  if (!this->Perspective)
  {
    return this->ImageToWorld.Column(2);
  }
  return lacuna::Normalized(this->ImageToWorld.Point({ column, row, 0 }) - this->Eye);
}

//------------------------------------------------------------------------------
lacuna::Vec3 lacuna::DepthMap::GetPoint(double column, double row, double depth) const
{
  return this->ImageToWorld.Point({ column, row, 0 }) + depth * this->GetRay(column, row);
}

//------------------------------------------------------------------------------
lacuna::Vec2 lacuna::DepthMap::GetPixelSpacing() const
{
  return { lacuna::Norm(this->ImageToWorld.Column(0)), lacuna::Norm(this->ImageToWorld.Column(1)) };
}

//------------------------------------------------------------------------------
std::string lacuna::DepthMap::GetNormalsName(const std::string& depthArray)
{
  const std::string depth = DepthName;
  if (depthArray == depth || depthArray.rfind(depth + "_", 0) == 0)
  {
    return NormalsName + depthArray.substr(depth.size());
  }
  return depthArray + NormalsName;
}

//------------------------------------------------------------------------------
void lacuna::DepthMap::SetGeometry(vtkImageData* map, const Geometry& g)
{
  map->SetOrigin(g.Origin.data());
  map->SetSpacing(g.PixelSpacing[0], g.PixelSpacing[1], 1);
  map->SetDirectionMatrix(g.Right[0], g.Down[0], g.View[0], g.Right[1], g.Down[1], g.View[1],
    g.Right[2], g.Down[2], g.View[2]);
  lacuna::FieldData::SetMatrices(map, ImageToWorldName,
    { lacuna::Matrix4::FromColumns(
      g.PixelSpacing[0] * g.Right, g.PixelSpacing[1] * g.Down, g.View, g.Origin) });
  lacuna::VolumeDirection::Remove(map);
}

//------------------------------------------------------------------------------
void lacuna::DepthMap::SetGeometry(vtkImageData* map, const lacuna::ImagePlane& plane)
{
  SetGeometry(map,
    Geometry{ plane.Origin, plane.Right, plane.Down, plane.View,
      { plane.PixelSpacing, plane.PixelSpacing } });
}

//------------------------------------------------------------------------------
void lacuna::DepthMap::SetInformation(vtkInformation* info, const lacuna::ImagePlane& plane)
{
  const int whole[6] = { 0, plane.Size[0] - 1, 0, plane.Size[1] - 1, 0, 0 };
  const double spacing[3] = { plane.PixelSpacing, plane.PixelSpacing, 1 };
  const double direction[9] = { plane.Right[0], plane.Down[0], plane.View[0], plane.Right[1],
    plane.Down[1], plane.View[1], plane.Right[2], plane.Down[2], plane.View[2] };
  info->Set(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), whole, 6);
  info->Set(vtkDataObject::ORIGIN(), plane.Origin.data(), 3);
  info->Set(vtkDataObject::SPACING(), spacing, 3);
  info->Set(vtkDataObject::DIRECTION(), direction, 9);
  info->Set(vtkAlgorithm::CAN_PRODUCE_SUB_EXTENT(), 1);
  vtkDataObject::SetPointDataActiveScalarInfo(info, VTK_DOUBLE, 1);
}

//------------------------------------------------------------------------------
bool lacuna::DepthMap::IsGiven(const double point[3])
{
  const auto open = std::count_if(point, point + 3, [](double x) { return x >= VTK_DOUBLE_MAX; });
  if (open != 0 && open != 3)
  {
    std::ostringstream message;
    message << "of the point " << point[0] << " " << point[1] << " " << point[2] << " only "
            << 3 - open << " coordinates are given: give all three, or leave all at 1e299";
    throw std::runtime_error(message.str());
  }
  return open == 0;
}
