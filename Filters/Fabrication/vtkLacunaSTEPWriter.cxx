// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaSTEPWriter.h"

#include "lacunaAlgorithmExecution.h"
#include "lacunaAtomicFile.h"
#include "lacunaCoordinates.h"
#include "lacunaFacetedSolid.h"
#include "lacunaPrintableText.h"
#include "lacunaProgram.h"
#include "lacunaProvenance.h"
#include "lacunaStepProgram.h"
#include "vtkCellArray.h"
#include "vtkCellArrayIterator.h"
#include "vtkInformation.h"
#include "vtkLogger.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"

#include <vtksys/SystemTools.hxx>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <stdexcept>
#include <string>

vtkStandardNewMacro(vtkLacunaSTEPWriter);

namespace
{
std::string FindProgram()
{
  static const char anchor = 0;
  return lacuna::FindBeside(&anchor, LACUNA_STEP);
}

lacuna::ClosedMesh GetMesh(vtkPolyData* surface)
{
  if (surface->GetNumberOfPolys() == 0 ||
    surface->GetNumberOfCells() != surface->GetNumberOfPolys())
  {
    throw std::runtime_error("a solid is made of triangles only, and this has other cells; apply "
                             "Extract Surface and Triangulate first");
  }
  lacuna::ClosedMesh mesh;
  mesh.Points.resize(static_cast<std::size_t>(surface->GetNumberOfPoints()));
  for (std::size_t k = 0; k < mesh.Points.size(); ++k)
  {
    surface->GetPoint(static_cast<vtkIdType>(k), mesh.Points[k].data());
  }
  mesh.Triangles.reserve(static_cast<std::size_t>(surface->GetNumberOfPolys()));
  auto cells = vtk::TakeSmartPointer(surface->GetPolys()->NewIterator());
  for (cells->GoToFirstCell(); !cells->IsDoneWithTraversal(); cells->GoToNextCell())
  {
    vtkIdType count;
    const vtkIdType* ids;
    cells->GetCurrentCell(count, ids);
    if (count != 3)
    {
      throw std::runtime_error(
        "a solid is made of triangles only; apply Extract Surface and Triangulate first");
    }
    mesh.Triangles.push_back({ static_cast<std::int32_t>(ids[0]), static_cast<std::int32_t>(ids[1]),
      static_cast<std::int32_t>(ids[2]) });
  }
  return mesh;
}

std::string DescribeFaces(const lacuna::FacetedSolid& solid)
{
  char deviation[32];
  std::snprintf(deviation, sizeof deviation, "%.4f", std::ceil(1e4 * solid.Deviation) / 1e4);
  return std::to_string(solid.Bodies.size()) + " solid" + (solid.Bodies.size() > 1 ? "s" : "") +
    " with " + std::to_string(solid.GetNumberOfFaces()) + " flat faces, at most " + deviation +
    " mm from the surface";
}
}

//------------------------------------------------------------------------------
vtkLacunaSTEPWriter::~vtkLacunaSTEPWriter()
{
  this->SetFileName(nullptr);
  this->SetNote(nullptr);
}

//------------------------------------------------------------------------------
int vtkLacunaSTEPWriter::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkPolyData");
  return 1;
}

//------------------------------------------------------------------------------
void vtkLacunaSTEPWriter::ClearResults()
{
  this->Superclass::ClearResults();
  this->MaximumDeviation = 0;
  this->NumberOfSolids = this->NumberOfFaces = 0;
}

//------------------------------------------------------------------------------
void vtkLacunaSTEPWriter::WriteFile()
{
  auto* surface = vtkPolyData::SafeDownCast(this->GetInput());
  if (!surface || surface->GetNumberOfPoints() == 0)
  {
    throw std::runtime_error("the input has no surface");
  }
  this->WriteSolid(surface);
}

//------------------------------------------------------------------------------
void vtkLacunaSTEPWriter::WriteSolid(vtkPolyData* surface)
{
  const bool mirrored = lacuna::Coordinates::IsMirrored(surface);
  if (mirrored && !this->AllowMirrored)
  {
    throw std::runtime_error(
      "the surface is a mirror image of the patient (field data Mirrored): nothing made from it "
      "fits the side it was taken from. Turn on AllowMirrored if the mirrored side is what you "
      "want");
  }
  const std::string program = FindProgram();
  lacuna::CheckStepProgram(program);
  lacuna::AlgorithmExecution execution(this);
  execution.SetStage(0, 0.7);
  const lacuna::FacetedSolid solid =
    lacuna::MakeFacetedSolid(GetMesh(surface), this->Tolerance, execution);

  const std::string version = std::string("Lacuna ") + lacuna::Provenance::GetVersion();
  lacuna::StepHeader header;
  header.FileName = vtksys::SystemTools::GetFilenameName(this->FileName);
  header.Title = vtksys::SystemTools::GetFilenameWithoutLastExtension(this->FileName);
  header.System = version;
  header.Description = { version + " STEP Writer. Unit mm. No medical device.",
    DescribeFaces(solid) + "." };
  if (this->Note && *this->Note)
  {
    header.Description.emplace_back(this->Note);
  }
  if (mirrored)
  {
    header.Description.emplace_back("MIRROR IMAGE, left is right.");
  }
  lacuna::Properties properties;
  this->Describe(properties);
  vtkNew<vtkPolyData> record; // takes the steps of the input and this one
  lacuna::Provenance::Record(record, this, { surface }, properties.GetText());
  for (const std::string& step : lacuna::Provenance::Get(record))
  {
    header.Description.push_back("Made by: " + step);
  }
  execution.SetStage(0.7, 0.95);
  const std::string content = lacuna::MakeStep(program, solid, header, execution);
  execution.SetStage(0.95, 1);
  execution.Report(0);
  lacuna::WriteFileAtomically(this->FileName, content);
  this->UpdateProgress(1); // no longer to be stopped: the file is there

  this->MaximumDeviation = solid.Deviation;
  this->NumberOfSolids = static_cast<int>(solid.Bodies.size());
  this->NumberOfFaces = static_cast<int>(solid.GetNumberOfFaces());
  this->FileSize = static_cast<vtkTypeInt64>(content.size());
  if (mirrored)
  {
    vtkWarningMacro(<< lacuna::ToPrintable(this->FileName)
                    << ": this is a mirror image of the patient; the file says so, too");
  }
  if (solid.Crossing)
  {
    const lacuna::Vec3& at = *solid.Crossing;
    vtkWarningMacro(<< lacuna::ToPrintable(this->FileName)
                    << ": the surface passes through itself, as the input does, near " << at[0]
                    << " " << at[1] << " " << at[2]
                    << " mm; CAD programs may refuse to work with the solid");
  }
  vtkLog(INFO, << "STEP Writer: " << this->FileName << ", " << this->FileSize << " bytes, "
               << DescribeFaces(solid));
}

//------------------------------------------------------------------------------
void vtkLacunaSTEPWriter::Describe(lacuna::Properties& properties) const
{
  properties.Add("Tolerance", this->Tolerance, lacuna::FaceTolerances)
    .Add("AllowMirrored", this->AllowMirrored)
    .Add("Note", this->Note);
}

//------------------------------------------------------------------------------
void vtkLacunaSTEPWriter::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "MaximumDeviation: " << this->MaximumDeviation << "\n";
  os << indent << "NumberOfSolids: " << this->NumberOfSolids << "\n";
  os << indent << "NumberOfFaces: " << this->NumberOfFaces << "\n";
}
