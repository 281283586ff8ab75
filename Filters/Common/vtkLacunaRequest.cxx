// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaRequest.h"

#include "lacunaMemory.h"
#include "vtkAlgorithm.h"
#include "vtkAlgorithmOutput.h"
#include "vtkDataArray.h"
#include "vtkDataObject.h"
#include "vtkDataSetAttributes.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationIntegerKey.h"
#include "vtkInformationStringVectorKey.h"
#include "vtkInformationVector.h"
#include "vtkLacunaInputs.h"
#include "vtkLacunaRanks.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <algorithm>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>

using SDDP = vtkStreamingDemandDrivenPipeline;

namespace
{
bool IsEmpty(const int extent[6])
{
  return extent[0] > extent[1] || extent[2] > extent[3] || extent[4] > extent[5];
}

// Of the algorithm and all that lies upstream. Not the executive's, which is from before the request:
// the first execution after a stop changes the time of its algorithm while it goes on, so that the
// executive's would change with the next request, on that rank alone.
vtkMTimeType GetNewestTime(vtkAlgorithm* algorithm, std::set<vtkAlgorithm*>& seen)
{
  vtkMTimeType newest = algorithm->GetMTime();
  for (int port = 0; port < algorithm->GetNumberOfInputPorts(); ++port)
  {
    for (int i = 0; i < algorithm->GetNumberOfInputConnections(port); ++i)
    {
      vtkAlgorithm* upstream = algorithm->GetInputAlgorithm(port, i);
      if (upstream && seen.insert(upstream).second)
      {
        newest = std::max(newest, GetNewestTime(upstream, seen));
      }
    }
  }
  return newest;
}

bool Contains(const int whole[6], const int part[6])
{
  return whole[0] <= part[0] && part[1] <= whole[1] && whole[2] <= part[2] && part[3] <= whole[3] &&
    whole[4] <= part[4] && part[5] <= whole[5];
}

// Of a point in the scalars that are announced; what is not said of them is taken for little. Not of other
// arrays: readers announce also those that are switched off.
double GetBytesPerPoint(vtkInformation* input)
{
  vtkInformation* scalars = vtkDataObject::GetActiveFieldInformation(
    input, vtkDataObject::FIELD_ASSOCIATION_POINTS, vtkDataSetAttributes::SCALARS);
  double bytes = 1;
  if (scalars && scalars->Has(vtkDataObject::FIELD_ARRAY_TYPE()))
  {
    bytes =
      std::max(1, vtkDataArray::GetDataTypeSize(scalars->Get(vtkDataObject::FIELD_ARRAY_TYPE())));
  }
  if (scalars && scalars->Has(vtkDataObject::FIELD_NUMBER_OF_COMPONENTS()))
  {
    bytes *= std::max(1, scalars->Get(vtkDataObject::FIELD_NUMBER_OF_COMPONENTS()));
  }
  return bytes;
}

const char* const WholeInput = "its input as a whole";

// Throws when a part of an announced image does not fit into the memory.
void RequireMemoryFor(vtkInformation* input, const int extent[6], const char* part)
{
  vtkInformation* data = vtkDataObject::GetData(input)->GetInformation();
  if (data->Has(vtkDataObject::DATA_EXTENT()) &&
    Contains(data->Get(vtkDataObject::DATA_EXTENT()), extent))
  {
    return; // it is here
  }
  std::ostringstream what;
  what << "this filter takes " << part << ", which with";
  double size = GetBytesPerPoint(input);
  for (int a = 0; a < 3; ++a)
  {
    const double points = std::max(0.0, static_cast<double>(extent[2 * a + 1]) - extent[2 * a] + 1);
    size *= points;
    what << (a > 0 ? " x " : " ") << points;
  }
  what << " points";
  lacuna::RequireMemory(what.str(), size);
}

void Ask(vtkInformation* input, const int extent[6])
{
  input->Set(SDDP::UPDATE_EXTENT(), extent, 6);
  vtkLacunaRequest::OnePiece(input);
}

// What was refused of the inputs of a port, by their numbers; empty: nothing. In what the filter knows of
// its port: an input's own information is that of all filters behind the same output.
vtkInformationStringVectorKey* Refusals()
{
  static vtkInformationStringVectorKey* const key =
    vtkInformationStringVectorKey::MakeKey("REFUSALS", "vtkLacunaRequest");
  return key;
}

void Remember(vtkAlgorithm* filter, vtkInformation* input, const std::string& refusal)
{
  for (int port = 0; port < filter->GetNumberOfInputPorts(); ++port)
  {
    for (int i = 0; i < filter->GetNumberOfInputConnections(port); ++i)
    {
      if (filter->GetInputInformation(port, i) == input)
      {
        filter->GetInputPortInformation(port)->Set(Refusals(), refusal.c_str(), i);
      }
    }
  }
}

// Asks for a part, or for nothing and remembers why when it does not fit into the memory.
bool AskOrRefuse(vtkAlgorithm* filter, vtkInformation* input, const int extent[6], const char* part)
{
  std::string refusal;
  try
  {
    RequireMemoryFor(input, extent, part);
  }
  catch (const std::runtime_error& error)
  {
    refusal = error.what();
  }
  Remember(filter, input, refusal);
  if (refusal.empty())
  {
    Ask(input, extent);
  }
  else
  {
    vtkLacunaRequest::Nothing(filter, input);
  }
  return refusal.empty();
}

// Of filters that have asked for anything on the first rank only.
vtkInformationIntegerKey* OnFirst()
{
  static vtkInformationIntegerKey* const key =
    vtkInformationIntegerKey::MakeKey("ON_FIRST", "vtkLacunaRequest");
  return key;
}

// Whether an algorithm executes on each rank for itself: Lacuna's, ParaView's between two proxies, and
// sources of which that is known. Raw images and NRRD are read by MPI on all ranks or none, for instance.
bool IsFamiliar(vtkAlgorithm* algorithm)
{
  static const std::set<std::string> names{ "vtkFileSeriesReader", "vtkImageFileSeriesReader",
    "vtkPVPostFilter", "vtkPVTrivialProducer", "vtkRTAnalyticSource", "vtkTrivialProducer" };
  const std::string name = algorithm->GetClassName();
  return name.rfind("vtkLacuna", 0) == 0 || names.count(name) > 0 || algorithm->IsA("vtkXMLReader");
}

bool HasStrangersUpstream(vtkAlgorithm* filter)
{
  for (int port = 0; port < filter->GetNumberOfInputPorts(); ++port)
  {
    for (int i = 0; i < filter->GetNumberOfInputConnections(port); ++i)
    {
      vtkAlgorithm* other = filter->GetInputAlgorithm(port, i);
      // of sources of anything else a part is asked for always
      const bool isAsked = other &&
        (other->GetTotalNumberOfInputConnections() > 0 ||
          filter->GetInputInformation(port, i)->Has(SDDP::WHOLE_EXTENT()));
      if (isAsked && (!IsFamiliar(other) || HasStrangersUpstream(other)))
      {
        return true;
      }
    }
  }
  return false;
}
}

//------------------------------------------------------------------------------
void vtkLacunaRequest::OnePiece(vtkInformation* input)
{
  input->Set(SDDP::UPDATE_PIECE_NUMBER(), 0);
  input->Set(SDDP::UPDATE_NUMBER_OF_PIECES(), 1);
  input->Set(SDDP::UPDATE_NUMBER_OF_GHOST_LEVELS(), 0);
}

//------------------------------------------------------------------------------
bool vtkLacunaRequest::Extent(vtkAlgorithm* filter, vtkInformation* input, const int extent[6])
{
  return AskOrRefuse(filter, input, extent, "a part of its input");
}

//------------------------------------------------------------------------------
bool vtkLacunaRequest::IsFirst(vtkInformationVector* outputs)
{
  for (int i = 0; i < outputs->GetNumberOfInformationObjects(); ++i)
  {
    if (outputs->GetInformationObject(i)->Get(SDDP::UPDATE_PIECE_NUMBER()) > 0)
    {
      return false;
    }
  }
  return true;
}

//------------------------------------------------------------------------------
void vtkLacunaRequest::ForgetEmpty(vtkInformationVector* outputs)
{
  for (int i = 0; i < outputs->GetNumberOfInformationObjects(); ++i)
  {
    vtkInformation* info = outputs->GetInformationObject(i);
    const int* whole = info->Get(SDDP::WHOLE_EXTENT());
    if (whole && IsEmpty(whole))
    {
      info->Set(SDDP::UPDATE_EXTENT_INITIALIZED(), 0);
    }
  }
}

//------------------------------------------------------------------------------
bool vtkLacunaRequest::IsWanted(vtkInformationVector* outputs)
{
  if (!vtkImageData::GetData(outputs, 0))
  {
    return IsFirst(outputs);
  }
  for (int i = 0; i < outputs->GetNumberOfInformationObjects(); ++i)
  {
    vtkInformation* info = outputs->GetInformationObject(i);
    const int* whole = info->Get(SDDP::WHOLE_EXTENT());
    const int* extent = info->Get(SDDP::UPDATE_EXTENT());
    const bool asked = extent && !IsEmpty(extent);
    // of a first image that is empty as a whole there may be something to say
    const bool unknown = i == 0 && (!whole || !extent || IsEmpty(whole));
    if (vtkImageData::GetData(info) && (asked || unknown))
    {
      return true;
    }
  }
  return false;
}

//------------------------------------------------------------------------------
void vtkLacunaRequest::Nothing(vtkAlgorithm* filter, vtkInformation* input)
{
  const bool wanted = HasStrangersUpstream(filter);
  const int* whole = input->Get(SDDP::WHOLE_EXTENT());
  if (!whole)
  {
    if (wanted)
    {
      OnePiece(input);
    }
    return;
  }
  if (!wanted)
  {
    const int nothing[6] = { 0, -1, 0, -1, 0, -1 };
    Ask(input, nothing);
    return;
  }
  try
  {
    RequireMemoryFor(input, whole, WholeInput);
    Ask(input, whole);
  }
  catch (const std::runtime_error&)
  {
    const int point[6] = { whole[0], whole[0], whole[2], whole[2], whole[4], whole[4] };
    Ask(input, point);
  }
}

//------------------------------------------------------------------------------
void vtkLacunaRequest::WholeOnFirst(
  vtkAlgorithm* filter, vtkInformation* input, vtkInformationVector* outputs)
{
  filter->GetInformation()->Set(OnFirst(), 1);
  if (vtkLacunaRanks().GetRank() == 0)
  {
    Whole(filter, input, outputs);
  }
  else
  {
    Nothing(filter, input);
  }
}

//------------------------------------------------------------------------------
bool vtkLacunaRequest::IsOnFirst(vtkAlgorithm* filter)
{
  return filter->GetInformation()->Has(OnFirst()) != 0;
}

//------------------------------------------------------------------------------
bool vtkLacunaRequest::Whole(
  vtkAlgorithm* filter, vtkInformation* input, vtkInformationVector* outputs)
{
  if (outputs && !IsWanted(outputs))
  {
    Remember(filter, input, {});
    Nothing(filter, input);
    return true;
  }
  if (const int* whole = input->Get(SDDP::WHOLE_EXTENT()))
  {
    return AskOrRefuse(filter, input, whole, WholeInput);
  }
  Remember(filter, input, {});
  OnePiece(input);
  return true;
}

//------------------------------------------------------------------------------
std::string vtkLacunaRequest::TakeRefusal(vtkAlgorithm* filter, int port)
{
  vtkInformation* info = filter->GetInputPortInformation(port);
  std::string refusal;
  for (int i = 0; i < info->Length(Refusals()) && refusal.empty(); ++i)
  {
    refusal = info->Get(Refusals(), i);
  }
  info->Remove(Refusals());
  return refusal;
}

//------------------------------------------------------------------------------
std::vector<double> vtkLacunaRequest::GetTimes(vtkAlgorithm* filter, vtkInformation* input)
{
  vtkInformation* data = vtkDataObject::GetData(input)->GetInformation();
  std::set<vtkAlgorithm*> seen;
  return { static_cast<double>(GetNewestTime(filter, seen)),
    data->Has(vtkDataObject::DATA_TIME_STEP()) ? data->Get(vtkDataObject::DATA_TIME_STEP()) : 0,
    input->Has(SDDP::UPDATE_TIME_STEP()) ? input->Get(SDDP::UPDATE_TIME_STEP()) : 0 };
}

//------------------------------------------------------------------------------
void vtkLacunaRequest::UpdateNow(vtkAlgorithm* filter, int port)
{
  Whole(filter, filter->GetInputInformation(port, 0), nullptr);
  vtkAlgorithmOutput* connection = filter->GetInputConnection(port, 0);
  connection->GetProducer()->Update(
    connection->GetIndex()); // also after a refusal: ranks may meet there
  vtkLacunaInputs::Check(filter, port);
}

//------------------------------------------------------------------------------
bool vtkLacunaRequest::UpdateNowOnFirst(vtkAlgorithm* filter, int port)
{
  if (vtkLacunaRanks().GetRank() == 0)
  {
    UpdateNow(filter, port);
    return true;
  }
  Nothing(filter, filter->GetInputInformation(port, 0));
  vtkAlgorithmOutput* connection = filter->GetInputConnection(port, 0);
  connection->GetProducer()->Update(connection->GetIndex());
  return false;
}
