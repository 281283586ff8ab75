// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Depth maps of given depths.
#ifndef lacunaHandMadeMap_h
#define lacunaHandMadeMap_h

#include "lacunaDepthMap.h"
#include "vtkDoubleArray.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"

#include <algorithm>
#include <vector>

namespace lacunaTest
{
/// Seen from the top; the depths row by row, 1 mm apart, down = -y.
inline vtkSmartPointer<vtkImageData> MakeMap(
  int columns, int rows, const std::vector<double>& depths)
{
  auto map = vtkSmartPointer<vtkImageData>::New();
  map->SetDimensions(columns, rows, 1);
  lacuna::DepthMap::SetGeometry(
    map, { { 0, 0, 40 }, { 1, 0, 0 }, { 0, -1, 0 }, { 0, 0, -1 }, { 1, 1 } });
  vtkNew<vtkDoubleArray> depth;
  depth->SetName("Depth");
  depth->SetNumberOfTuples(columns * rows);
  std::copy(depths.begin(), depths.end(), depth->Begin());
  map->GetPointData()->SetScalars(depth);
  return map;
}
}
#endif
