// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaCheck.h"
#include "lacunaInputCheck.h"
#include "vtkCellData.h"
#include "vtkDoubleArray.h"
#include "vtkImageData.h"
#include "vtkMatrix3x3.h"
#include "vtkMultiBlockDataSet.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkTable.h"

#include <limits>

namespace
{
vtkSmartPointer<vtkDoubleArray> MakeArray(const char* name, vtkIdType tuples)
{
  auto array = vtkSmartPointer<vtkDoubleArray>::New();
  array->SetName(name);
  array->SetNumberOfTuples(tuples);
  array->Fill(1);
  return array;
}

vtkSmartPointer<vtkImageData> MakeImage()
{
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->SetDimensions(3, 4, 5);
  image->GetPointData()->AddArray(MakeArray("Levels", 60));
  image->GetCellData()->AddArray(MakeArray("Cells", 24));
  return image;
}
}

int TestInputs(int, char*[])
{
  const auto image = MakeImage();
  lacuna::InputCheck::Check(image, "input 0");
  lacuna::InputCheck::Check(static_cast<vtkDataObject*>(nullptr), "input 0");

  // too short, too long, of cells
  image->GetPointData()->AddArray(MakeArray("Levels", 59));
  LACUNA_CHECK_THROWS(lacuna::InputCheck::Check(image, "input 0"),
    "input 0 is not sound: its point array Levels has 59 values for 60 points");
  image->GetPointData()->AddArray(MakeArray("Levels", 61));
  LACUNA_CHECK_THROWS(lacuna::InputCheck::Check(image, "input 0"), "61 values for 60 points");
  image->GetPointData()->RemoveArray("Levels");
  image->GetCellData()->AddArray(MakeArray("Cells", 60));
  LACUNA_CHECK_THROWS(
    lacuna::InputCheck::Check(image, "input 0"), "cell array Cells has 60 values");

  // nothing to read: sound, whatever arrays are left
  image->SetDimensions(0, 0, 0);
  lacuna::InputCheck::Check(image, "input 0");

  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (int what = 0; what < 3; ++what)
  {
    const auto other = MakeImage();
    vtkNew<vtkMatrix3x3> direction;
    direction->SetElement(1, 2, nan);
    if (what == 0)
    {
      other->SetSpacing(1, nan, 1);
    }
    else if (what == 1)
    {
      other->SetOrigin(1, -std::numeric_limits<double>::infinity(), 1);
    }
    else
    {
      other->SetDirectionMatrix(direction);
    }
    static const char* const words[] = { "spacing is 1 nan 1", "origin is 1 -inf 1",
      "direction matrix is 1 0 0 0 1 nan" };
    LACUNA_CHECK_THROWS(lacuna::InputCheck::Check(other, "input 2"), words[what]);
  }

  const auto far = MakeImage();
  far->SetExtent(0, 2, 0, 3, 2147483643, 2147483647);
  LACUNA_CHECK_THROWS(
    lacuna::InputCheck::Check(far, "input 0"), "its extent is 0 2 0 3 2147483643 2147483647");

  vtkNew<vtkTable> table;
  table->AddColumn(MakeArray("Time", 7));
  lacuna::InputCheck::Check(table, "input 1");
  table->GetRowData()->AddArray(MakeArray("Gate", 6));
  LACUNA_CHECK_THROWS(
    lacuna::InputCheck::Check(table, "input 1"), "column Gate has 6 values for 7");

  vtkNew<vtkMultiBlockDataSet> blocks;
  blocks->SetBlock(0, MakeImage());
  blocks->SetBlock(1, nullptr);
  const auto bad = MakeImage();
  bad->SetSpacing(nan, 1, 1);
  blocks->SetBlock(2, bad);
  LACUNA_CHECK_THROWS(
    lacuna::InputCheck::Check(blocks, "input 0"), "input 0, block 3, is not sound");
  return lacunaCheck::Result();
}
