// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The depths of a map as kernels see them; for the filters of this module.
#ifndef lacunaMapDepths_h
#define lacunaMapDepths_h

#include "lacunaDepthGrid.h"
#include "vtkDoubleArray.h"
#include "vtkSmartPointer.h"

#include <string>

class vtkImageData;
namespace lacuna
{
class DepthMap;
}

namespace lacuna
{
class MapDepths
{
public:
  /// Throws std::runtime_error when map has no one-component point array depthArray. map must outlive
  /// this object.
  MapDepths(vtkImageData* map, const DepthMap& contract, const std::string& depthArray);

  const DepthGrid& GetGrid() const { return this->Grid; }

private:
  vtkSmartPointer<vtkDoubleArray> Depths; ///< the map's array, or a copy in double
  DepthGrid Grid;
};
}
#endif
