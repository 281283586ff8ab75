// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaReliefRepresentation.h"

#include "vtkInformation.h"
#include "vtkLacunaDepthMapSurface.h"
#include "vtkLacunaSelectionIds.h"
#include "vtkObjectFactory.h"

vtkStandardNewMacro(vtkLacunaReliefRepresentation);

//------------------------------------------------------------------------------
vtkLacunaReliefRepresentation::vtkLacunaReliefRepresentation()
{
  this->Surface->SetMaximumAngle(80); // degrees: sides of a skull belong to the picture
  this->Ids->SetInputConnection(this->Surface->GetOutputPort());
  vtkLacunaSelectionIds::Use(this->GeometryFilter);
}

//------------------------------------------------------------------------------
vtkLacunaReliefRepresentation::~vtkLacunaReliefRepresentation() = default;

//------------------------------------------------------------------------------
vtkAlgorithmOutput* vtkLacunaReliefRepresentation::GetInternalOutputPort(int port, int connection)
{
  vtkAlgorithmOutput* map = this->Superclass::GetInternalOutputPort(port, connection);
  this->Surface->SetInputConnection(map);
  this->Ids->SetInputConnection(1, map);
  return this->Ids->GetOutputPort();
}

//------------------------------------------------------------------------------
int vtkLacunaReliefRepresentation::FillInputPortInformation(int port, vtkInformation* information)
{
  this->Superclass::FillInputPortInformation(port, information);
  information->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkImageData");
  return 1;
}
