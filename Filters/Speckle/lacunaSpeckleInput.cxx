// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSpeckleInput.h"

#include "lacunaArrays.h"
#include "vtkImageData.h"
#include "vtkPointData.h"

#include <stdexcept>

namespace lacuna::SpeckleInput
{
vtkDataArray* FindArray(vtkImageData* image, const std::string& name)
{
  vtkPointData* data = image->GetPointData();
  vtkDataArray* array = name.empty() ? data->GetScalars() : data->GetArray(name.c_str());
  if (!array)
  {
    throw std::runtime_error(name.empty()
        ? "the image has no active point scalars; choose a point array of numbers"
        : "the image has no point array '" + name + "' of numbers; choose one that it has");
  }
  if (array->GetNumberOfTuples() != image->GetNumberOfPoints())
  {
    throw std::runtime_error(Name(array) + " has " + std::to_string(array->GetNumberOfTuples()) +
      " values, the image " + std::to_string(image->GetNumberOfPoints()) +
      " points; a point array has one for each");
  }
  return array;
}

vtkSmartPointer<vtkDataArray> MakeContiguous(vtkDataArray* array)
{
  if (array->HasStandardMemoryLayout())
  {
    return array;
  }
  auto copy = vtk::TakeSmartPointer(vtkDataArray::CreateDataArray(array->GetDataType()));
  lacuna::Arrays::Copy(array, copy);
  return copy;
}

std::string Name(vtkDataArray* array)
{
  const char* name = array->GetName();
  return "array '" + std::string(name ? name : "") + "'";
}

lacuna::Extent GetExtent(const int extent[6])
{
  return { extent[0], extent[1], extent[2], extent[3], extent[4], extent[5] };
}
}
