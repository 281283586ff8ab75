// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaGridLayer.h"

#include "vtkStructuredGrid.h"

#include <cstdint>
#include <stdexcept>
#include <string>

//------------------------------------------------------------------------------
vtkLacunaGridLayer::vtkLacunaGridLayer(vtkStructuredGrid* grid)
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
}
