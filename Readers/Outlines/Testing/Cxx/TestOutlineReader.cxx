// SPDX-License-Identifier: BSD-3-Clause
// The reader in VTK: what is in the output, pieces, errors and recovery.
#include "OutlineReaderTesting.h"
#include "lacunaCoordinates.h"
#include "lacunaProvenance.h"
#include "vtkCellArray.h"
#include "vtkErrorCode.h"
#include "vtkFieldData.h"
#include "vtkIdList.h"
#include "vtkIntArray.h"
#include "vtkStringArray.h"
#include "vtkUnsignedCharArray.h"

#include <filesystem>

namespace
{
const std::string Table = "structure,outline,slice,x,y,z\n"
                          "Liver,4,12,1,2,3.25\nLiver,4,12,11,2,3.25\nLiver,4,12,11,7,3.25\n"
                          "Cyst,5,13,0,0,1\nCyst,5,13,1,0,1\nCyst,5,13,1,1,1\nCyst,5,13,0,1,1\n"
                          "Liver,6,,0,0,9\nLiver,6,,1,0,9\nLiver,6,,0,1,9\nLiver,6,,0,0,9\n";

void TestOutput()
{
  ReaderOf test(Table, "Jane Doe.txt"); // the name says nothing
  vtkPolyData* outlines = test.Update();
  LACUNA_CHECK(test.Errors.empty() && test.Warnings.empty());
  LACUNA_CHECK(outlines->GetNumberOfPoints() == 10);
  LACUNA_CHECK(outlines->GetNumberOfLines() == 3 && outlines->GetNumberOfCells() == 3);
  CheckPoint(outlines, 1, 11, 2, 3.25);
  const vtkIdType expected[3][5] = { { 0, 1, 2, 0, -1 }, { 3, 4, 5, 6, 3 }, { 7, 8, 9, 7, -1 } };
  for (vtkIdType cell = 0; cell < outlines->GetNumberOfCells(); ++cell)
  {
    LACUNA_CHECK(outlines->GetCellType(cell) == VTK_POLY_LINE);
    vtkNew<vtkIdList> ids;
    outlines->GetCellPoints(cell, ids);
    LACUNA_CHECK(ids->GetNumberOfIds() == (cell == 1 ? 5 : 4));
    for (vtkIdType i = 0; i < ids->GetNumberOfIds(); ++i)
    {
      LACUNA_CHECK(ids->GetId(i) == expected[cell][i]);
    }
  }
  vtkCellData* data = outlines->GetCellData();
  auto* structures = vtkIntArray::SafeDownCast(data->GetArray("Structure"));
  auto* numbers = vtkIntArray::SafeDownCast(data->GetArray("Outline"));
  auto* slices = vtkIntArray::SafeDownCast(data->GetArray("SliceNumber"));
  auto* names = vtkStringArray::SafeDownCast(data->GetAbstractArray("StructureName"));
  auto* colors = vtkUnsignedCharArray::SafeDownCast(data->GetArray("StructureColor"));
  LACUNA_CHECK(structures && numbers && slices && names && colors);
  if (structures && numbers && slices && names && colors)
  {
    LACUNA_CHECK(structures->GetValue(0) == 1 && structures->GetValue(1) == 2);
    LACUNA_CHECK(structures->GetValue(2) == 1);
    LACUNA_CHECK(numbers->GetValue(0) == 4 && numbers->GetValue(2) == 6);
    LACUNA_CHECK(slices->GetValue(1) == 13 && slices->GetValue(2) == -1);
    LACUNA_CHECK(names->GetValue(1) == "Cyst" && names->GetNumberOfValues() == 3);
    LACUNA_CHECK(colors->GetNumberOfComponents() == 3 && data->GetScalars() == colors);
  }
  LACUNA_CHECK(lacuna::Coordinates::Get(outlines).empty()); // a table does not say
  const std::vector<std::string> steps = lacuna::Provenance::Get(outlines);
  LACUNA_CHECK(steps.size() == 1 && steps[0].find("Jane") == std::string::npos);
}

void TestPieces()
{
  ReaderOf test(Table);
  test.Reader->UpdatePiece(1, 2, 0);
  LACUNA_CHECK(test.Reader->GetOutput()->GetNumberOfCells() == 0);
  test.Reader->UpdatePiece(0, 2, 0);
  LACUNA_CHECK(test.Reader->GetOutput()->GetNumberOfCells() == 3);
  LACUNA_CHECK(test.Errors.empty());
}

void TestErrors()
{
  ReaderOf test("");
  vtkPolyData* outlines = test.Update();
  LACUNA_CHECK_CONTAINS(test.Errors, "is empty");
  LACUNA_CHECK(test.Reader->GetErrorCode() == vtkErrorCode::FileFormatError);
  test.Reader->SetFileName("/nonexistent/a.csv");
  test.Update();
  LACUNA_CHECK_CONTAINS(test.Errors, "/nonexistent/a.csv: there is no such file");
  LACUNA_CHECK(test.Reader->GetErrorCode() == vtkErrorCode::FileNotFoundError);
  test.Reader->SetFileName(nullptr);
  test.Update();
  LACUNA_CHECK_CONTAINS(test.Errors, "FileName is not set; it must be outlines in a file");
  const std::string folder = std::filesystem::path(test.File.GetPath()).parent_path().string();
  for (const std::string& path : { folder, std::string("/dev/zero") })
  {
    test.Reader->SetFileName(path.c_str());
    test.Update();
    LACUNA_CHECK_CONTAINS(test.Errors, path + ": cannot be read");
  }
  test.Reader->SetFileName(test.File.GetPath().c_str());
  test.Update("P5 2 2 255 abcd");
  LACUNA_CHECK_CONTAINS(test.Errors, "has no outlines that are read: neither markups");
  LACUNA_CHECK(outlines->GetNumberOfPoints() == 0);
  test.Update(Table); // recovers
  LACUNA_CHECK(test.Errors.empty() && outlines->GetNumberOfCells() == 3);
  test.Update(Table.substr(0, Table.size() - 1));
  LACUNA_CHECK_CONTAINS(test.Warnings, "does not end with a line break");
}

void TestCanReadFile()
{
  vtkNew<vtkLacunaOutlineReader> reader;
  LACUNA_CHECK(!reader->CanReadFile(nullptr));
  LACUNA_CHECK(!reader->CanReadFile(""));
  LACUNA_CHECK(!reader->CanReadFile("/nonexistent.csv"));
  const TemporaryFile table("a.csv", Table);
  LACUNA_CHECK(reader->CanReadFile(table.GetPath().c_str()));
  const TemporaryFile other("b.csv", "x,y,z\n1,2,3\n");
  LACUNA_CHECK(!reader->CanReadFile(other.GetPath().c_str()));
}
}

int TestOutlineReader(int, char*[])
{
  TestOutput();
  TestPieces();
  TestErrors();
  TestCanReadFile();
  return lacunaCheck::Result();
}
