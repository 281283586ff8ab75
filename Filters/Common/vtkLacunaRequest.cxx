// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaRequest.h"

#include "vtkAlgorithm.h"
#include "vtkAlgorithmOutput.h"
#include "vtkInformation.h"
#include "vtkLacunaInputs.h"
#include "vtkStreamingDemandDrivenPipeline.h"

using SDDP = vtkStreamingDemandDrivenPipeline;

//------------------------------------------------------------------------------
void vtkLacunaRequest::OnePiece(vtkInformation* input)
{
  input->Set(SDDP::UPDATE_PIECE_NUMBER(), 0);
  input->Set(SDDP::UPDATE_NUMBER_OF_PIECES(), 1);
  input->Set(SDDP::UPDATE_NUMBER_OF_GHOST_LEVELS(), 0);
}

//------------------------------------------------------------------------------
void vtkLacunaRequest::Extent(vtkInformation* input, const int extent[6])
{
  input->Set(SDDP::UPDATE_EXTENT(), extent, 6);
  OnePiece(input);
}

//------------------------------------------------------------------------------
void vtkLacunaRequest::Whole(vtkInformation* input)
{
  if (input->Has(SDDP::WHOLE_EXTENT()))
  {
    input->Set(SDDP::UPDATE_EXTENT(), input->Get(SDDP::WHOLE_EXTENT()), 6);
  }
  OnePiece(input);
}

//------------------------------------------------------------------------------
void vtkLacunaRequest::UpdateNow(vtkAlgorithm* filter, int port)
{
  Whole(filter->GetInputInformation(port, 0));
  vtkAlgorithmOutput* connection = filter->GetInputConnection(port, 0);
  connection->GetProducer()->Update(connection->GetIndex());
  vtkLacunaInputs::Check(filter, port);
}
