// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaSliceStream.h"

#include "vtkAlgorithm.h"
#include "vtkAlgorithmOutput.h"
#include "vtkInformation.h"
#include "vtkInformationObjectBaseKey.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <algorithm>

namespace
{
bool (*PassesOn)(vtkAlgorithm*) = nullptr;
}

vtkInformationKeyMacro(vtkLacunaSliceStream, STREAM, ObjectBase);

//------------------------------------------------------------------------------
vtkLacunaSliceStream* vtkLacunaSliceStream::Find(vtkAlgorithm* consumer, int port, int connection)
{
  if (connection >= consumer->GetNumberOfInputConnections(port))
  {
    return nullptr;
  }
  vtkAlgorithmOutput* output = consumer->GetInputConnection(port, connection);
  while (PassesOn && PassesOn(output->GetProducer()) &&
    output->GetProducer()->GetNumberOfInputConnections(0) > 0)
  {
    output = output->GetProducer()->GetInputConnection(0, 0);
  }
  vtkInformation* info = output->GetProducer()->GetOutputInformation(output->GetIndex());
  return info ? vtkLacunaSliceStream::SafeDownCast(info->Get(STREAM())) : nullptr;
}

//------------------------------------------------------------------------------
void vtkLacunaSliceStream::SetPassesOn(bool (*function)(vtkAlgorithm*))
{
  PassesOn = function;
}

//------------------------------------------------------------------------------
std::array<int, 6> vtkLacunaSliceStream::GetFirstSlice(vtkInformation* input)
{
  std::array<int, 6> slice{};
  input->Get(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), slice.data());
  slice[5] = slice[4];
  return slice;
}

//------------------------------------------------------------------------------
void vtkLacunaSliceStream::Pass(vtkAlgorithm* filter, vtkInformation* output)
{
  output->Set(STREAM(), Find(filter)); // null removes it
}

//------------------------------------------------------------------------------
int vtkLacunaSliceStream::GetSlicesAtATime() const
{
  constexpr std::int64_t bytes = 32 << 20;
  return static_cast<int>(std::max<std::int64_t>(1, bytes / this->GetSliceSize()));
}
