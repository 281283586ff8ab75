// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaSlicesRepresentation.h"

#include "vtkInformation.h"
#include "vtkLacunaSelectionIds.h"
#include "vtkLacunaSlicePlanes.h"
#include "vtkObjectFactory.h"
#include "vtkProperty.h"
#include "vtkThreshold.h"

#include <cmath>
#include <limits>

namespace
{
constexpr int MostPoints = 500000; // a computer without a graphics card turns them, too
}

vtkStandardNewMacro(vtkLacunaSlicesRepresentation);

//------------------------------------------------------------------------------
vtkLacunaSlicesRepresentation::vtkLacunaSlicesRepresentation()
{
  this->Planes->SetMaximumNumberOfPoints(MostPoints);
  this->Ids->SetInputConnection(this->Planes->GetOutputPort());
  vtkLacunaSelectionIds::Use(this->GeometryFilter);
  this->Bright->SetInputConnection(this->Ids->GetOutputPort());
  this->Bright->SetInputArrayToProcess(
    0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "Intensity");
  this->Bright->SetThresholdFunction(vtkThreshold::THRESHOLD_UPPER);
  this->Bright->SetAllScalars(false);
  this->SetDark(0);
}

//------------------------------------------------------------------------------
vtkLacunaSlicesRepresentation::~vtkLacunaSlicesRepresentation() = default;

//------------------------------------------------------------------------------
void vtkLacunaSlicesRepresentation::SetStride(int stride)
{
  this->Planes->SetStride(stride);
  this->MarkModified();
}

//------------------------------------------------------------------------------
void vtkLacunaSlicesRepresentation::SetDark(double level)
{
  this->Bright->SetUpperThreshold(
    std::nextafter(static_cast<float>(level), std::numeric_limits<float>::infinity()));
  this->MarkModified();
}

//------------------------------------------------------------------------------
int vtkLacunaSlicesRepresentation::ProcessViewRequest(
  vtkInformationRequestKey* request, vtkInformation* input, vtkInformation* output)
{
  const int done = this->Superclass::ProcessViewRequest(request, input, output);
  this->Property->LightingOff();
  return done;
}

//------------------------------------------------------------------------------
vtkAlgorithmOutput* vtkLacunaSlicesRepresentation::GetInternalOutputPort(int port, int connection)
{
  vtkAlgorithmOutput* stack = this->Superclass::GetInternalOutputPort(port, connection);
  this->Planes->SetInputConnection(stack);
  this->Ids->SetInputConnection(1, stack);
  return this->Bright->GetOutputPort();
}

//------------------------------------------------------------------------------
int vtkLacunaSlicesRepresentation::FillInputPortInformation(int port, vtkInformation* information)
{
  this->Superclass::FillInputPortInformation(port, information);
  information->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkImageData");
  return 1;
}
