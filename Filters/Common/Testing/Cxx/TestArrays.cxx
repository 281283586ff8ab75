// SPDX-License-Identifier: BSD-3-Clause
// Arrays get their size, or an error that names the bytes; VTK's own functions end the program.
#include "lacunaArrays.h"
#include "lacunaCheck.h"
#include "lacunaSanitized.h"
#include "vtkCellArray.h"
#include "vtkDoubleArray.h"
#include "vtkFloatArray.h"
#include "vtkIdTypeArray.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkSOADataArrayTemplate.h"
#include "vtkStringArray.h"
#include "vtkUnsignedCharArray.h"

#include <stdexcept>
#include <string>

namespace
{
std::string ErrorOfSize(vtkAbstractArray* array, vtkIdType tuples)
{
  try
  {
    lacuna::Arrays::SetNumberOfTuples(array, tuples);
  }
  catch (const std::runtime_error& e)
  {
    return e.what();
  }
  return {};
}
}

int TestArrays(int, char*[])
{
  vtkNew<vtkDoubleArray> normals;
  normals->SetName("Normals");
  normals->SetNumberOfComponents(3);
  lacuna::Arrays::SetNumberOfTuples(normals, 1000);
  LACUNA_CHECK(normals->GetNumberOfTuples() == 1000 && normals->GetNumberOfValues() == 3000);
  for (vtkIdType i = 0; i < 3000; ++i)
  {
    normals->SetValue(i, static_cast<double>(i));
  }
  // it grows and shrinks as any other
  normals->InsertNextTuple3(7, 8, 9);
  LACUNA_CHECK(normals->GetNumberOfTuples() == 1001);
  LACUNA_CHECK(normals->GetValue(2999) == 2999 && normals->GetValue(3002) == 9);
  normals->Resize(10);
  LACUNA_CHECK(normals->GetNumberOfTuples() == 10 && normals->GetValue(29) == 29);
  lacuna::Arrays::SetNumberOfTuples(normals, 0);
  LACUNA_CHECK(normals->GetNumberOfTuples() == 0);

  if (!lacuna::Sanitized) // whose malloc ends the program
  {
    const vtkIdType many = vtkIdType{ 1 } << 56;
    const std::string error = ErrorOfSize(normals, many);
    LACUNA_CHECK(error.find("'Normals' would need 1.73e+18 bytes") != std::string::npos);
    vtkNew<vtkDoubleArray> wide;
    wide->SetNumberOfComponents(8);
    LACUNA_CHECK(!ErrorOfSize(wide, vtkIdType{ 1 } << 58).empty()); // 2^64 bytes
    vtkNew<vtkUnsignedCharArray> unnamed;
    LACUNA_CHECK(ErrorOfSize(unnamed, many).find("an array would need") != std::string::npos);
    LACUNA_CHECK(unnamed->GetNumberOfTuples() == 0);
  }

  // what was known of the values is of those that it had
  vtkNew<vtkDoubleArray> values;
  values->InsertNextValue(1);
  LACUNA_CHECK(values->GetRange()[1] == 1);
  lacuna::Arrays::SetNumberOfTuples(values, 2);
  values->SetValue(0, 5);
  values->SetValue(1, 7);
  LACUNA_CHECK(values->GetRange()[0] == 5 && values->GetRange()[1] == 7);

  vtkNew<vtkSOADataArrayTemplate<float>> blocks;
  blocks->SetNumberOfComponents(2);
  lacuna::Arrays::SetNumberOfTuples(blocks, 5);
  blocks->SetTypedComponent(4, 1, 3);
  LACUNA_CHECK(blocks->GetNumberOfTuples() == 5 && blocks->GetTypedComponent(4, 1) == 3);
  vtkNew<vtkStringArray> texts;
  lacuna::Arrays::SetNumberOfTuples(texts, 4);
  LACUNA_CHECK(texts->GetNumberOfTuples() == 4);

  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  lacuna::Arrays::SetNumberOfPoints(points, 2);
  points->SetPoint(1, 1, 2, 3);
  LACUNA_CHECK(points->GetNumberOfPoints() == 2 && points->GetPoint(1)[2] == 3);

  vtkNew<vtkFloatArray> copy;
  blocks->SetName("Blocks");
  blocks->SetComponentName(1, "second");
  lacuna::Arrays::Copy(blocks, copy);
  LACUNA_CHECK(copy->GetNumberOfTuples() == 5 && copy->GetTypedComponent(4, 1) == 3);
  LACUNA_CHECK(std::string(copy->GetName()) == "Blocks" && copy->HasAComponentName());

  vtkNew<vtkCellArray> cells;
  lacuna::Arrays::Reserve(cells, 2, 5);
  LACUNA_CHECK(cells->GetNumberOfCells() == 0);
  cells->InsertNextCell({ 4, 5, 6 });
  cells->InsertNextCell({ 7, 8 });
  cells->InsertNextCell({ 9 }); // more than reserved
  vtkIdType count = 0;
  const vtkIdType* ids = nullptr;
  cells->GetCellAtId(1, count, ids);
  LACUNA_CHECK(cells->GetNumberOfCells() == 3 && count == 2 && ids[0] == 7 && ids[1] == 8);
  lacuna::Arrays::Reserve(points, 3);
  LACUNA_CHECK(points->GetNumberOfPoints() == 0 && points->InsertNextPoint(1, 2, 3) == 0);
  LACUNA_CHECK(points->GetNumberOfPoints() == 1);

  vtkNew<vtkImageData> image;
  image->SetExtent(-1, 2, 3, 5, 7, 7);
  vtkDataArray* scalars = lacuna::Arrays::AddScalars(image, VTK_SHORT, "Grey");
  LACUNA_CHECK(
    image->GetPointData()->GetScalars() == scalars && scalars->GetDataType() == VTK_SHORT);
  LACUNA_CHECK(scalars->GetNumberOfTuples() == 12 && std::string(scalars->GetName()) == "Grey");
  image->SetScalarComponentFromDouble(2, 5, 7, 0, -5);
  LACUNA_CHECK(scalars->GetTuple1(11) == -5);
  return lacunaCheck::Result();
}
