// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaArrays.h"

#include "lacunaMemory.h"
#include "vtkCellArray.h"
#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"
#include "vtkTypeInt64Array.h"

#include <cstdlib>
#include <stdexcept>
#include <string>

namespace vtkLacunaArrays
{
//------------------------------------------------------------------------------
void SetNumberOfTuples(vtkAbstractArray* array, vtkIdType tuples)
{
  auto* numbers = vtkDataArray::SafeDownCast(array);
  // texts, bits and arrays of several blocks make theirs by themselves
  if (!numbers || !numbers->HasStandardMemoryLayout() || numbers->GetDataType() == VTK_BIT ||
    tuples <= 0)
  {
    array->SetNumberOfTuples(tuples);
    return;
  }
  const vtkIdType values = tuples * numbers->GetNumberOfComponents();
  const std::size_t bytes =
    static_cast<std::size_t>(values) * static_cast<std::size_t>(numbers->GetDataTypeSize());
  void* memory = std::malloc(bytes); // as VTK does, which frees it
  if (!memory)
  {
    throw std::runtime_error(
      (numbers->GetName() ? "'" + std::string(numbers->GetName()) + "'" : std::string("an array")) +
      " would need " + lacuna::DescribeBytes(static_cast<double>(bytes)) +
      ", for which there is no memory");
  }
  numbers->SetVoidArray(memory, values, 0, vtkAbstractArray::VTK_DATA_ARRAY_FREE);
}

//------------------------------------------------------------------------------
void SetNumberOfPoints(vtkPoints* points, vtkIdType count)
{
  points->GetData()->SetNumberOfComponents(3);
  SetNumberOfTuples(points->GetData(), count);
  points->Modified();
}

//------------------------------------------------------------------------------
void SetTriangles(vtkPolyData* output, vtkTypeInt64Array* corners)
{
  vtkNew<vtkTypeInt64Array> offsets;
  SetNumberOfTuples(offsets, corners->GetNumberOfValues() / 3 + 1);
  for (vtkIdType i = 0; i < offsets->GetNumberOfValues(); ++i)
  {
    offsets->SetValue(i, 3 * i);
  }
  vtkNew<vtkCellArray> triangles;
  triangles->SetData(offsets, corners);
  output->SetPolys(triangles);
}

//------------------------------------------------------------------------------
vtkDataArray* AddScalars(vtkImageData* image, int type, const char* name)
{
  const auto scalars = vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(type));
  scalars->SetName(name);
  SetNumberOfTuples(scalars, image->GetNumberOfPoints());
  image->GetPointData()->SetScalars(scalars);
  return scalars;
}
}
