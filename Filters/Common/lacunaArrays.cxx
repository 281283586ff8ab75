// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaArrays.h"

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

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <limits>
#include <stdexcept>
#include <string>

namespace lacuna::Arrays
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
  const double bytes = static_cast<double>(tuples) * numbers->GetNumberOfComponents() *
    static_cast<double>(numbers->GetDataTypeSize());
  constexpr double most = static_cast<double>(std::numeric_limits<std::ptrdiff_t>::max());
  const vtkIdType values = bytes < most ? tuples * numbers->GetNumberOfComponents() : 0;
  void* memory = nullptr;
  if (values > 0)
  {
    // as VTK does, which frees it
    memory = std::malloc(
      static_cast<std::size_t>(values) * static_cast<std::size_t>(numbers->GetDataTypeSize()));
  }
  if (!memory)
  {
    throw std::runtime_error(
      (numbers->GetName() ? "'" + std::string(numbers->GetName()) + "'" : std::string("an array")) +
      " would need " + lacuna::DescribeBytes(bytes) + ", for which there is no memory");
  }
  numbers->SetVoidArray(memory, values, 0, vtkAbstractArray::VTK_DATA_ARRAY_FREE);
  numbers->DataChanged(); // ranges and lookups are of what it had
  numbers->Modified();
}

//------------------------------------------------------------------------------
void SetNumberOfPoints(vtkPoints* points, vtkIdType count)
{
  points->GetData()->SetNumberOfComponents(3);
  SetNumberOfTuples(points->GetData(), count);
  points->Modified();
}

//------------------------------------------------------------------------------
void Reserve(vtkAbstractArray* array, vtkIdType tuples)
{
  SetNumberOfTuples(array, tuples);
  array->Reset();
}

//------------------------------------------------------------------------------
void Reserve(vtkPoints* points, vtkIdType count)
{
  SetNumberOfPoints(points, count);
  points->GetData()->Reset();
}

//------------------------------------------------------------------------------
void Reserve(vtkCellArray* cells, vtkIdType count, vtkIdType points)
{
  vtkNew<vtkTypeInt64Array> offsets;
  Reserve(offsets, count + 1);
  offsets->InsertNextValue(0);
  vtkNew<vtkTypeInt64Array> corners;
  Reserve(corners, points);
  cells->SetData(offsets, corners);
}

//------------------------------------------------------------------------------
void Copy(vtkAbstractArray* from, vtkAbstractArray* to)
{
  to->SetNumberOfComponents(from->GetNumberOfComponents());
  SetNumberOfTuples(to, from->GetNumberOfTuples());
  to->DeepCopy(from); // into the memory that there is now
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

void SetTriangles(vtkPolyData* output, const std::vector<std::array<std::int32_t, 3>>& triangles)
{
  vtkNew<vtkTypeInt64Array> corners;
  SetNumberOfTuples(corners, 3 * static_cast<vtkIdType>(triangles.size()));
  vtkTypeInt64* to = corners->GetPointer(0);
  for (const std::array<std::int32_t, 3>& triangle : triangles)
  {
    to = std::copy(triangle.begin(), triangle.end(), to);
  }
  SetTriangles(output, corners);
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
