// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaRequest.h"

#include "lacunaExecution.h"
#include "lacunaMemory.h"
#include "vtkAlgorithm.h"
#include "vtkAlgorithmOutput.h"
#include "vtkDataArray.h"
#include "vtkDataArraySelection.h"
#include "vtkDataObject.h"
#include "vtkExecutive.h"
#include "vtkExtentTranslator.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationExecutivePortKey.h"
#include "vtkInformationExecutivePortVectorKey.h"
#include "vtkInformationInformationVectorKey.h"
#include "vtkInformationIntegerKey.h"
#include "vtkInformationIntegerRequestKey.h"
#include "vtkInformationStringVectorKey.h"
#include "vtkInformationVector.h"
#include "vtkLacunaInputs.h"
#include "vtkLacunaRanks.h"
#include "vtkLacunaVersionCompat.h"
#include "vtkNew.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkXMLReader.h"

#include <algorithm>
#include <array>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>

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

vtkLacunaRequest::InnerReader GetInnerReader = nullptr;

vtkAlgorithm* GetProducer(vtkInformation* image)
{
  vtkExecutive* executive = vtkExecutive::PRODUCER()->GetExecutive(image);
  return executive ? executive->GetAlgorithm() : nullptr;
}

// An image's source behind any filters, with the algorithm around it; null when it is no reader of VTK's
// XML formats. These alone announce all arrays that a file has.
struct Source
{
  vtkAlgorithm* Outer;
  vtkXMLReader* Reader;

  explicit Source(vtkInformation* image)
    : Outer(GetProducer(image))
  {
    while (this->Outer && this->Outer->GetNumberOfInputPorts() > 0 &&
      this->Outer->GetNumberOfInputConnections(0) > 0)
    {
      this->Outer = this->Outer->GetInputAlgorithm(0, 0);
    }
    vtkAlgorithm* inner = this->Outer && GetInnerReader ? GetInnerReader(this->Outer) : nullptr;
    this->Reader = vtkXMLReader::SafeDownCast(inner ? inner : this->Outer);
  }
};

bool IsSwitchedOff(vtkDataArraySelection* arrays, const char* name)
{
  return arrays && name && arrays->ArrayExists(name) && !arrays->ArrayIsEnabled(name);
}

// Of a point in an array that is announced; what is not said of it is taken for little.
double GetBytes(vtkInformation* array)
{
  const int type = array->Has(vtkDataObject::FIELD_ARRAY_TYPE())
    ? array->Get(vtkDataObject::FIELD_ARRAY_TYPE())
    : VTK_UNSIGNED_CHAR;
  const int components = array->Has(vtkDataObject::FIELD_NUMBER_OF_COMPONENTS())
    ? array->Get(vtkDataObject::FIELD_NUMBER_OF_COMPONENTS())
    : 1;
  return std::max(1.0, static_cast<double>(vtkDataArray::GetDataTypeSize(type))) *
    std::max(1, components);
}

// Of a point in all arrays that are announced and not switched off; there are about as many cells.
double GetBytesPerPoint(vtkInformation* image, vtkXMLReader* reader)
{
  const std::array<std::pair<vtkInformationInformationVectorKey*, vtkDataArraySelection*>, 2> kinds{
    std::pair(
      vtkDataObject::POINT_DATA_VECTOR(), reader ? reader->GetPointDataArraySelection() : nullptr),
    std::pair(
      vtkDataObject::CELL_DATA_VECTOR(), reader ? reader->GetCellDataArraySelection() : nullptr)
  };
  double bytes = 0;
  for (const auto& [key, selection] : kinds)
  {
    vtkInformationVector* arrays = image->Get(key);
    for (int a = 0; arrays && a < arrays->GetNumberOfInformationObjects(); ++a)
    {
      vtkInformation* array = arrays->GetInformationObject(a);
      if (!IsSwitchedOff(selection, array->Get(vtkDataObject::FIELD_NAME())))
      {
        bytes += GetBytes(array);
      }
    }
  }
  return std::max(1.0, bytes);
}

// VTK's reader of MetaImage files (9.2) writes beyond its memory when it reads a part of some.
bool IsReadAsWhole(vtkInformation* image)
{
  vtkAlgorithm* producer = GetProducer(image);
  while (
    producer && producer->IsA("vtkPVPostFilter") && producer->GetNumberOfInputConnections(0) > 0)
  {
    producer = producer->GetInputAlgorithm(0, 0);
  }
  vtkAlgorithm* inner = producer && GetInnerReader ? GetInnerReader(producer) : nullptr;
  return producer && (inner ? inner : producer)->IsA("vtkMetaImageReader");
}

// Filters announce their active scalars only, without a name, and yet their reader loads the other arrays,
// too. ParaView has a filter that passes images on behind every source.
double GetBytesPerPoint(vtkInformation* image)
{
  vtkAlgorithm* producer = GetProducer(image);
  if (producer && producer->IsA("vtkPVPostFilter") && producer->GetNumberOfInputConnections(0) > 0)
  {
    return GetBytesPerPoint(producer->GetExecutive()->GetInputInformation(0, 0));
  }
  const Source source(image);
  const double bytes = GetBytesPerPoint(image, source.Reader);
  return source.Reader
    ? std::max(bytes, GetBytesPerPoint(source.Outer->GetOutputInformation(0), source.Reader))
    : bytes;
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
void vtkLacunaRequest::SetInnerReader(InnerReader function)
{
  GetInnerReader = function;
}

//------------------------------------------------------------------------------
bool vtkLacunaRequest::Extent(vtkAlgorithm* filter, vtkInformation* input, const int extent[6])
{
  const int* whole = input->Get(SDDP::WHOLE_EXTENT());
  return whole && !IsEmpty(extent) && IsReadAsWhole(input)
    ? AskOrRefuse(filter, input, whole, WholeInput)
    : AskOrRefuse(filter, input, extent, "a part of its input");
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
std::array<int, 6> vtkLacunaRequest::GetPart(vtkInformation* output)
{
  std::array<int, 6> asked{ 0, -1, 0, -1, 0, -1 };
  output->Get(SDDP::UPDATE_EXTENT(), asked.data());
  const int pieces = output->Get(SDDP::UPDATE_NUMBER_OF_PIECES());
  if (pieces <= 1)
  {
    return asked;
  }
  const int mode = output->Has(vtkExtentTranslator::UPDATE_SPLIT_MODE())
    ? output->Get(vtkExtentTranslator::UPDATE_SPLIT_MODE())
    : vtkExtentTranslator::BLOCK_MODE;
  std::array<int, 6> part{};
  vtkNew<vtkExtentTranslator> translator;
  translator->PieceToExtentThreadSafe(output->Get(SDDP::UPDATE_PIECE_NUMBER()), pieces,
    output->Get(SDDP::UPDATE_NUMBER_OF_GHOST_LEVELS()), asked.data(), part.data(), mode, 0);
  return part;
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
  // meshes made of an image have its extent in their information, too
  vtkDataObject* data = vtkDataObject::GetData(input);
  const bool hasExtent = !data || data->GetExtentType() == VTK_3D_EXTENT;
  const int* whole = hasExtent ? input->Get(SDDP::WHOLE_EXTENT()) : nullptr;
  if (!whole)
  {
    if (wanted)
    {
      OnePiece(input);
      return;
    }
    // Any piece but the first, in which filters make what they make as a whole.
    const vtkLacunaRanks ranks;
    input->Set(SDDP::UPDATE_PIECE_NUMBER(), std::max(ranks.GetRank(), 1));
    input->Set(SDDP::UPDATE_NUMBER_OF_PIECES(), std::max(ranks.GetNumber(), 2));
    input->Set(SDDP::UPDATE_NUMBER_OF_GHOST_LEVELS(), 0);
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
void vtkLacunaRequest::ForgetNothing(vtkAlgorithm* filter)
{
  for (int port = 0; port < filter->GetNumberOfInputPorts(); ++port)
  {
    for (int i = 0; i < filter->GetNumberOfInputConnections(port); ++i)
    {
      vtkInformation* input = filter->GetInputInformation(port, i);
      if (vtkExecutive::CONSUMERS()->Length(input) != 1)
      {
        continue;
      }
      const int* asked = input->Get(SDDP::UPDATE_EXTENT());
      const int* whole = input->Get(SDDP::WHOLE_EXTENT());
      if (asked && whole && IsEmpty(asked))
      {
        input->Set(SDDP::UPDATE_EXTENT(), whole, 6);
      }
      vtkAlgorithm* upstream = filter->GetInputAlgorithm(port, i);
      if (upstream && upstream->IsA("vtkPVPostFilter"))
      {
        ForgetNothing(upstream);
      }
    }
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
vtkMTimeType vtkLacunaRequest::GetNewestTime(vtkAlgorithm* algorithm)
{
  std::set<vtkAlgorithm*> seen;
  return ::GetNewestTime(algorithm, seen);
}

//------------------------------------------------------------------------------
std::vector<double> vtkLacunaRequest::GetTimes(vtkAlgorithm* filter, vtkInformation* input)
{
  vtkInformation* data = vtkDataObject::GetData(input)->GetInformation();
  return { static_cast<double>(GetNewestTime(filter)),
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
  if (vtkLacunaWasStopped(filter->GetInputInformation(port, 0)))
  {
    throw lacuna::Aborted(); // what is upstream was stopped: its data say nothing
  }
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
