// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaOutlineReader.h"

#include "lacunaArrays.h"
#include "lacunaCoordinates.h"
#include "lacunaMarkups.h"
#include "lacunaOutlineFile.h"
#include "lacunaOutlineTable.h"
#include "lacunaParameterText.h"
#include "lacunaPrintableText.h"
#include "lacunaReading.h"
#include "lacunaStructureSet.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkInformation.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkStringArray.h"
#include "vtkUnsignedCharArray.h"

#include <filesystem>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

namespace
{
lacuna::OutlineSet ReadOutlines(const std::string& path)
{
  switch (lacuna::GetOutlineFileKind(path))
  {
    case lacuna::OutlineFileKind::Dicom:
      return lacuna::ReadStructureSet(path);
    case lacuna::OutlineFileKind::Markups:
      return lacuna::ReadMarkups(path);
    default:
      return lacuna::ReadOutlineTable(path);
  }
}

void FillOutput(const lacuna::OutlineSet& set, vtkPolyData* output)
{
  const std::vector<lacuna::StructureOutline>& outlines = set.GetOutlines();
  const auto count = static_cast<vtkIdType>(outlines.size());
  vtkIdType pointCount = 0;
  for (const lacuna::StructureOutline& outline : outlines)
  {
    pointCount += static_cast<vtkIdType>(outline.Points.size());
  }
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  lacuna::Arrays::SetNumberOfPoints(points, pointCount);
  vtkNew<vtkCellArray> lines;
  lacuna::Arrays::Reserve(lines, count, pointCount + count);
  vtkNew<vtkIntArray> structures;
  vtkNew<vtkStringArray> names;
  vtkNew<vtkIntArray> numbers;
  vtkNew<vtkIntArray> slices;
  vtkNew<vtkUnsignedCharArray> colors;
  colors->SetNumberOfComponents(3);
  const std::pair<vtkAbstractArray*, const char*> arrays[] = { { structures, "Structure" },
    { names, "StructureName" }, { numbers, "Outline" }, { slices, "SliceNumber" },
    { colors, "StructureColor" } };
  for (const auto& [array, name] : arrays)
  {
    array->SetName(name);
    lacuna::Arrays::SetNumberOfTuples(array, count);
    output->GetCellData()->AddArray(array);
  }
  vtkIdType next = 0;
  for (vtkIdType cell = 0; cell < count; ++cell)
  {
    const lacuna::StructureOutline& outline = outlines[static_cast<std::size_t>(cell)];
    const lacuna::OutlinedStructure& structure = set.GetStructures()[outline.Structure];
    const vtkIdType first = next;
    lines->InsertNextCell(static_cast<int>(outline.Points.size() + 1));
    for (const lacuna::Vec3& point : outline.Points)
    {
      points->SetPoint(next, point.data());
      lines->InsertCellPoint(next++);
    }
    lines->InsertCellPoint(first);
    structures->SetValue(cell, static_cast<int>(outline.Structure) + 1);
    names->SetValue(cell, structure.Name);
    numbers->SetValue(cell, outline.Number);
    slices->SetValue(cell, outline.Slice);
    colors->SetTypedTuple(cell, structure.Color.data());
  }
  output->SetPoints(points);
  output->SetLines(lines);
  output->GetCellData()->SetActiveScalars("StructureColor");
}
}

vtkStandardNewMacro(vtkLacunaOutlineReader);

//------------------------------------------------------------------------------
vtkLacunaOutlineReader::vtkLacunaOutlineReader()
{
  this->Sharing = lacuna::Share::FirstRank;
  this->SetNumberOfInputPorts(0);
}

//------------------------------------------------------------------------------
vtkLacunaOutlineReader::~vtkLacunaOutlineReader()
{
  this->SetFileName(nullptr);
}

//------------------------------------------------------------------------------
int vtkLacunaOutlineReader::CanReadFile(const char* fileName)
{
  return fileName && lacuna::IsOutlineFile(fileName) ? 1 : 0;
}

//------------------------------------------------------------------------------
void vtkLacunaOutlineReader::Announce(const lacuna::Ports&)
{
  lacuna::Reading::Run(
    this->FileName, "outlines in a file (.mrk.json, .dcm, .csv)",
    [this](unsigned long code) { this->SetErrorCode(code); },
    [&]
    {
      std::error_code ignored;
      if (!std::filesystem::exists(this->FileName, ignored))
      {
        throw std::runtime_error(std::string(this->FileName) + ": there is no such file");
      }
    });
}

//------------------------------------------------------------------------------
void vtkLacunaOutlineReader::Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution&)
{
  lacuna::Reading::Run(
    this->FileName, "", [this](unsigned long code) { this->SetErrorCode(code); },
    [&]
    {
      const lacuna::OutlineSet outlines = ReadOutlines(this->FileName);
      auto* output = ports.GetOutput<vtkPolyData>();
      FillOutput(outlines, output);
      if (outlines.IsPatient)
      {
        lacuna::Coordinates::Mark(output, lacuna::Coordinates::Patient);
      }
      for (const std::string& warning : outlines.Warnings)
      {
        vtkWarningMacro(<< lacuna::ToPrintable(this->FileName + (": " + warning)));
      }
    });
}

//------------------------------------------------------------------------------
std::string vtkLacunaOutlineReader::Parameters(int) const
{
  std::error_code ignored;
  return lacuna::ParameterText()
    // tells which file it was to one who has it, and no name of a patient
    .Add("FileName",
      "fnv1a:" + lacuna::HashText(std::filesystem::path(this->FileName).filename().string()))
    .Add("FileSize", std::filesystem::file_size(this->FileName, ignored))
    .Get();
}

//------------------------------------------------------------------------------
void vtkLacunaOutlineReader::PrintSelf(ostream& os, vtkIndent indent)
{
  this->vtkLacunaAlgorithm::PrintSelf(os, indent);
  os << indent << "FileName: " << (this->FileName ? this->FileName : "") << "\n";
}
