// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The depths of a map as kernels see them; for the filters of this module.
#ifndef vtkLacunaMapDepths_h
#define vtkLacunaMapDepths_h

#include "lacunaDepthGrid.h"
#include "vtkDoubleArray.h"
#include "vtkSmartPointer.h"

#include <string>

class vtkImageData;
class vtkLacunaDepthMap;

class vtkLacunaMapDepths
{
public:
  /// Throws std::runtime_error when map has no one-component point array depthArray. map must outlive
  /// this object.
  vtkLacunaMapDepths(
    vtkImageData* map, const vtkLacunaDepthMap& contract, const std::string& depthArray);

  const lacuna::DepthGrid& GetGrid() const { return this->Grid; }

private:
  vtkSmartPointer<vtkDoubleArray> Depths; ///< the map's array, or a copy in double
  lacuna::DepthGrid Grid;
};
#endif
