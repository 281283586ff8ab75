// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaSlicesRepresentation.h"

#include "vtkInformation.h"
#include "vtkLacunaSlicePlanes.h"
#include "vtkObjectFactory.h"
#include "vtkProperty.h"

namespace
{
constexpr int MostPoints = 500000; // a computer without a graphics card turns them, too
}

vtkStandardNewMacro(vtkLacunaSlicesRepresentation);

//------------------------------------------------------------------------------
vtkLacunaSlicesRepresentation::vtkLacunaSlicesRepresentation()
{
  this->Property->LightingOff();
  this->Planes->SetMaximumNumberOfPoints(MostPoints);
}

//------------------------------------------------------------------------------
vtkLacunaSlicesRepresentation::~vtkLacunaSlicesRepresentation() = default;

//------------------------------------------------------------------------------
vtkAlgorithmOutput* vtkLacunaSlicesRepresentation::GetInternalOutputPort(int port, int connection)
{
  this->Planes->SetInputConnection(this->Superclass::GetInternalOutputPort(port, connection));
  return this->Planes->GetOutputPort();
}

//------------------------------------------------------------------------------
int vtkLacunaSlicesRepresentation::FillInputPortInformation(int port, vtkInformation* information)
{
  this->Superclass::FillInputPortInformation(port, information);
  information->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkImageData");
  return 1;
}
