// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaGridLayer.h"

#include "lacunaDepthMap.h"
#include "lacunaFieldData.h"
#include "lacunaLandmarks.h"
#include "lacunaMatrix4.h"
#include "vtkDataArray.h"
#include "vtkPointData.h"
#include "vtkStructuredGrid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>

namespace
{
constexpr double PlaneTolerance = 0.001; // mm; single precision may have come between

bool IsFlat(const std::vector<lacuna::Vec3>& points)
{
  std::array<std::size_t, 4> indices{};
  return !lacuna::FindLandmarks(points, indices);
}

// Whether the grid has a depth map's pixels as its points, in their plane, as ParaView's Transform
// makes it of the map. With the relief of its depths (Warp By Scalar) it is a surface.
bool IsPlaneOfDepthMap(vtkStructuredGrid* grid, const lacuna::GridLayer& layer)
{
  vtkPointData* data = grid->GetPointData();
  vtkDataArray* fitted = data->GetArray(lacuna::DepthMap::FittedName);
  vtkDataArray* depths = fitted ? fitted : data->GetArray(lacuna::DepthMap::DepthName);
  vtkDataArray* matrix = lacuna::FieldData::Find(grid, lacuna::DepthMap::ImageToWorldName, 16, -1);
  const auto& points = layer.Points;
  if (!depths || !matrix || matrix->GetNumberOfTuples() != 1 ||
    !std::all_of(points.begin(), points.end(), [](const auto& p) { return lacuna::IsFinite(p); }) ||
    !IsFlat(points))
  {
    return false;
  }
  std::vector<lacuna::Vec3> relief;
  for (std::int64_t k = 0; k < static_cast<std::int64_t>(points.size()); ++k)
  {
    if (const double depth = depths->GetComponent(k, 0); std::isfinite(depth))
    {
      relief.push_back({ static_cast<double>(k % layer.Size.Columns),
        static_cast<double>(k / layer.Size.Columns), depth });
    }
  }
  const lacuna::Matrix4 toImage = lacuna::FieldData::GetMatrix(matrix, 0).Inverse();
  return !IsFlat(relief) ||
    std::all_of(points.begin(), points.end(),
      [&toImage](const auto& p) { return std::abs(toImage.Point(p)[2]) <= PlaneTolerance; });
}
}

//------------------------------------------------------------------------------
lacuna::GridLayer::GridLayer(vtkStructuredGrid* grid)
{
  int dimensions[3];
  grid->GetDimensions(dimensions);
  std::vector<std::int64_t> size;
  for (const int d : dimensions)
  {
    if (d != 1)
    {
      size.push_back(d);
    }
  }
  if (size.size() != 2)
  {
    throw std::runtime_error("the structured grid has " + std::to_string(dimensions[0]) + " x " +
      std::to_string(dimensions[1]) + " x " + std::to_string(dimensions[2]) +
      " points; a surface has exactly one dimension of 1");
  }
  if (grid->HasAnyBlankPoints() || grid->HasAnyBlankCells())
  {
    throw std::runtime_error(
      "the structured grid has blanked points or cells; a surface without holes is needed");
  }
  this->Size = { size[0], size[1] };
  this->Points.resize(grid->GetNumberOfPoints());
  for (std::size_t k = 0; k < this->Points.size(); ++k)
  {
    grid->GetPoint(static_cast<vtkIdType>(k), this->Points[k].data());
  }
  if (IsPlaneOfDepthMap(grid, *this))
  {
    throw std::runtime_error(
      "the structured grid is the plane of a depth map's pixels, not its surface: Transform makes "
      "such a grid of an image and leaves its depths out. Take Transform out of the pipeline");
  }
}
