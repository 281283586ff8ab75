// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaAlgorithm.h"

#include "lacunaCoordinates.h"
#include "lacunaErrors.h"
#include "lacunaInputCheck.h"
#include "lacunaMemory.h"
#include "lacunaPrintableText.h"
#include "lacunaProvenance.h"
#include "lacunaRequest.h"
#include "vtkAlgorithmOutput.h"
#include "vtkCommand.h"
#include "vtkCompositeDataSet.h"
#include "vtkDemandDrivenPipeline.h"
#include "vtkExtentTranslator.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationIntegerRequestKey.h"
#include "vtkInformationVector.h"
#include "vtkNew.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkTable.h"

#include <algorithm>
#include <cstdint>
#include <new>
#include <sstream>
#include <stdexcept>
#include <string_view>

using SDDP = vtkStreamingDemandDrivenPipeline;

namespace lacuna
{
namespace
{
constexpr std::array<int, 6> Nothing{ 0, -1, 0, -1, 0, -1 };
const char* const Stopped = "it was stopped";
const char* const OtherStopped = "another rank has stopped";

bool (*ExecutesOnAllRanks)(vtkAlgorithm*) = nullptr;

bool HasNoElements(vtkDataObject* data)
{
  auto* set = vtkDataSet::SafeDownCast(data);
  auto* table = vtkTable::SafeDownCast(data);
  return !data || (set && set->GetNumberOfPoints() == 0) ||
    (table && table->GetNumberOfRows() == 0);
}

/// Follows an error that all ranks agreed on, and keep.
constexpr std::string_view TryAgain = " (change a property to try again)";

std::string WithoutHint(const std::string& error)
{
  const std::size_t at = error.rfind(TryAgain);
  return at != std::string::npos && at + TryAgain.size() == error.size() ? error.substr(0, at)
                                                                         : error;
}

/// The text of what body throws; empty when it came to its end.
template <class Callable>
std::string GetError(const Callable& body)
{
  try
  {
    body();
    return {};
  }
  catch (const Aborted&)
  {
    return Stopped;
  }
  catch (const OtherRankStopped&)
  {
    return OtherStopped;
  }
  catch (const std::bad_alloc&)
  {
    return "out of memory";
  }
  catch (const std::exception& error)
  {
    return ToPrintable(error.what());
  }
}

bool TakesType(vtkAlgorithm* algorithm, int port, vtkDataObject* data)
{
  vtkInformation* taken = algorithm->GetInputPortInformation(port);
  for (int t = 0; t < taken->Length(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE()); ++t)
  {
    if (data->IsA(taken->Get(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), t)))
    {
      return true;
    }
  }
  return false;
}

/// Calls body for each input that is connected: its port, number and information.
template <class Callable>
void ForEachInput(vtkAlgorithm* algorithm, const Callable& body)
{
  for (int port = 0; port < algorithm->GetNumberOfInputPorts(); ++port)
  {
    for (int i = 0; i < algorithm->GetNumberOfInputConnections(port); ++i)
    {
      body(port, i, algorithm->GetInputInformation(port, i));
    }
  }
}
}

//------------------------------------------------------------------------------
vtkInformation* Ports::GetInputInformation(int port, int connection) const
{
  return this->Inputs[port]->GetInformationObject(connection);
}

//------------------------------------------------------------------------------
vtkInformation* Ports::GetOutputInformation(int port) const
{
  return this->Outputs->GetInformationObject(port);
}

//------------------------------------------------------------------------------
std::array<int, 6> Ports::GetExtent(int port) const
{
  std::array<int, 6> extent = Nothing;
  this->GetOutputInformation(port)->Get(SDDP::UPDATE_EXTENT(), extent.data());
  return extent;
}

//------------------------------------------------------------------------------
bool Ports::IsFirst() const
{
  for (int i = 0; i < this->Outputs->GetNumberOfInformationObjects(); ++i)
  {
    if (this->Outputs->GetInformationObject(i)->Get(SDDP::UPDATE_PIECE_NUMBER()) > 0)
    {
      return false;
    }
  }
  return true;
}

//------------------------------------------------------------------------------
bool Ports::IsAsked() const
{
  for (int i = 0; i < this->Outputs->GetNumberOfInformationObjects(); ++i)
  {
    vtkInformation* info = this->GetOutputInformation(i);
    const int* whole = GetWhole(info);
    const bool isUnknown = i == 0 && whole && IsEmpty(whole); // there may be something to report
    if (IsGrid(info) && (isUnknown || !IsEmpty(this->GetExtent(i).data())))
    {
      return true;
    }
  }
  return false;
}

//------------------------------------------------------------------------------
Algorithm::Algorithm(vtkAlgorithm* self)
  : Self(self)
{
}

Algorithm::~Algorithm() = default;

void Algorithm::SetExecutesOnAllRanks(bool (*function)(vtkAlgorithm*))
{
  ExecutesOnAllRanks = function;
}

void Algorithm::Announce(const Ports&) {}

//------------------------------------------------------------------------------
void Algorithm::MakeNothing(const Ports& ports)
{
  for (int i = 0; i < this->Self->GetNumberOfOutputPorts(); ++i)
  {
    ports.GetOutput<vtkDataObject>(i)->GetFieldData()->Initialize(); // VTK passes the input's
  }
}

//------------------------------------------------------------------------------
void Algorithm::Ask(const Ports& ports)
{
  ForEachInput(this->Self,
    [&](int port, int, vtkInformation* input)
    {
      if (port == 0 && this->Sharing == Share::Parts && GetWhole(input))
      {
        this->AskFor(input, GetPart(ports.GetOutputInformation()));
      }
      else
      {
        this->AskForWhole(input);
      }
    });
}

//------------------------------------------------------------------------------
std::vector<vtkDataObject*> Algorithm::GetOrigins(const Ports& ports) const
{
  std::vector<vtkDataObject*> found;
  ForEachInput(this->Self,
    [&](int port, int i, vtkInformation*)
    {
      auto* data = ports.GetInput<vtkDataObject>(port, i);
      if (!HasNoElements(data))
      {
        found.push_back(data);
      }
    });
  return found;
}

//------------------------------------------------------------------------------
void Algorithm::AskFor(vtkInformation* input, const std::array<int, 6>& extent)
{
  const std::string refused = AskForExtent(input, extent);
  this->Refused = refused.empty() ? this->Refused : refused;
}

//------------------------------------------------------------------------------
void Algorithm::AskForWhole(vtkInformation* input)
{
  const std::string refused = AskForAll(input);
  this->Refused = refused.empty() ? this->Refused : refused;
}

//------------------------------------------------------------------------------
std::array<int, 6> Algorithm::GetPart(vtkInformation* output)
{
  // VTK divides the extent only when it executes the algorithm, too late to ask the input for it.
  std::array<int, 6> asked = Nothing;
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
void Algorithm::UpdateInput(const Ports& ports, int port)
{
  this->Refused.clear();
  this->Ask(ports);
  for (int i = 0; i < this->Self->GetNumberOfInputConnections(port); ++i)
  {
    vtkAlgorithmOutput* connection = this->Self->GetInputConnection(port, i);
    connection->GetProducer()->Update(connection->GetIndex()); // also when refused: ranks may meet
    if (lacuna::WasStopped(ports.GetInputInformation(port, i)))
    {
      throw Aborted();
    }
  }
  this->CheckInputs(ports, port);
}

//------------------------------------------------------------------------------
int Algorithm::AnnounceOutputs(vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  const lacuna::ControllerRanks ranks;
  const Ports ports(inputs, outputs, ranks);
  const int count = outputs->GetNumberOfInformationObjects();
  lacuna::ForgetAbort(this->Self);
  this->Announced.clear();
  this->Announced = GetError(
    [&]
    {
      for (int i = 0; i < count; ++i)
      {
        vtkInformation* info = outputs->GetInformationObject(i);
        const bool isDivided = this->Sharing == Share::Parts || this->Sharing == Share::EachRank;
        info->Remove(vtkAlgorithm::CAN_PRODUCE_SUB_EXTENT());
        if (isDivided && vtkImageData::GetData(info))
        {
          info->Set(vtkAlgorithm::CAN_PRODUCE_SUB_EXTENT(), 1);
        }
        if (this->Self->GetNumberOfInputPorts() == 0)
        {
          info->Set(vtkAlgorithm::CAN_HANDLE_PIECE_REQUEST(), 1); // so that all ranks execute it
        }
      }
      this->RefuseBlocks();
      this->Announce(ports);
    });
  const bool isOther = this->Sharing == Share::FirstRank && ranks.GetRank() > 0;
  this->IsElsewhere = false;
  for (int i = 0; i < count && (isOther || !this->Announced.empty()); ++i)
  {
    vtkInformation* info = outputs->GetInformationObject(i);
    const int* whole = GetWhole(info);
    this->IsElsewhere = this->IsElsewhere || (whole && !IsEmpty(whole));
    // Otherwise VTK keeps the input's whole extent as this algorithm's, and asks for it.
    info->Set(SDDP::WHOLE_EXTENT(), Nothing.data(), 6);
  }
  if (!this->Announced.empty())
  {
    lacuna::Errors::Empty(outputs);
    for (int i = 0; i < count; ++i)
    {
      vtkInformation* info = outputs->GetInformationObject(i);
      info->Set(SDDP::UPDATE_EXTENT(), Nothing.data(), 6);
      info->Set(SDDP::UPDATE_EXTENT_INITIALIZED(), 0);      // what is asked for then is all again
      info->Set(vtkAlgorithm::CAN_PRODUCE_SUB_EXTENT(), 1); // all ranks execute it
    }
  }
  return 1; // also after an error, which is reported with the data: VTK would not execute what follows
}

//------------------------------------------------------------------------------
int Algorithm::AskForInputs(vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  for (int i = 0; i < outputs->GetNumberOfInformationObjects(); ++i)
  {
    // VTK would go on to ask for nothing, whatever is announced next.
    const int* whole = GetWhole(outputs->GetInformationObject(i));
    if (whole && IsEmpty(whole))
    {
      outputs->GetInformationObject(i)->Set(SDDP::UPDATE_EXTENT_INITIALIZED(), 0);
    }
  }
  this->Refused.clear();
  this->Ask(Ports(inputs, outputs, lacuna::ControllerRanks()));
  return 1;
}

//------------------------------------------------------------------------------
int Algorithm::MakeOutputs(vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  const lacuna::ControllerRanks ranks;
  const Ranks alone;
  const bool isTogether = this->Sharing == Share::Together; // also for another time step
  const bool canMeet =
    ranks.GetNumber() > 1 && (isTogether || (ExecutesOnAllRanks && ExecutesOnAllRanks(this->Self)));
  // VTK executes all ranks after a change, and later those that are asked for something else.
  const std::vector<double> times = this->GetTimes();
  const bool isSame = canMeet && this->Agreed.Times == times;
  const bool haveMet = isSame ||
    (canMeet && !isTogether && !this->Agreed.Times.empty() && this->Agreed.Times[0] == times[0]);
  const bool meet = canMeet && !haveMet;
  // The first error of those that meet; nobody knows more than that he was stopped by another one.
  const auto agree = [&](const std::string& own)
  {
    const std::string first = meet ? ranks.GetFirstText(own == OtherStopped ? "" : own) : own;
    return first.empty() ? own : first;
  };
  std::string error;
  if (isSame && !this->Agreed.Error.empty())
  {
    error = WithoutHint(this->Agreed.Error).append(TryAgain);
  }
  else
  {
    const Ports ports(inputs, outputs, meet ? ranks : alone, haveMet);
    Fingerprints own; // here, where nobody waits for a rank that has no memory for it
    error = agree(GetError(
      [&]
      {
        this->CheckRequest(ports);
        own = meet ? this->GetFingerprints() : own;
      }));
    if (error.empty() && meet)
    {
      error = agree(this->CompareInputs(ranks, own));
    }
    if (error.empty())
    {
      error = agree(GetError(
        [&]
        {
          if (this->HasWork(ports))
          {
            lacuna::AlgorithmExecution execution(this->Self);
            this->Make(ports, execution);
            this->Finish(ports);
          }
          else
          {
            this->MakeNothing(ports);
          }
        }));
    }
  }
  if (meet)
  {
    this->Agreed = { times, error };
  }
  if (!error.empty())
  {
    this->Fail(outputs, error);
  }
  return 1; // also after an error, so that views become empty and recover
}

//------------------------------------------------------------------------------
Algorithm::Fingerprints Algorithm::GetFingerprints() const
{
  Fingerprints result;
  ForEachInput(this->Self,
    [&](int port, int i, vtkInformation*)
    { result.push_back(InputCheck::GetFingerprint(this->Self->GetInputDataObject(port, i))); });
  return result;
}

//------------------------------------------------------------------------------
std::string Algorithm::CompareInputs(
  const lacuna::ControllerRanks& ranks, const Fingerprints& own) const
{
  if (this->Sharing == Share::Parts)
  {
    return {};
  }
  auto next = own.begin();
  std::string differs;
  std::string extracted;
  ForEachInput(this->Self,
    [&](int port, int i, vtkInformation*)
    {
      vtkDataObject* data = this->Self->GetInputDataObject(port, i);
      // what only the first rank makes is nowhere else
      const bool isElsewhere = this->Sharing == Share::FirstRank && HasNoElements(data);
      auto first = ranks.GetRank() > 0 ? InputCheck::Fingerprint{} : *next;
      ranks.Sum(first.data(), static_cast<std::int64_t>(first.size()));
      if (first != *next++ && !isElsewhere)
      {
        differs = "the inputs are not the same on all ranks: a filter before this one gives each "
                  "rank a part, or all to the first, or the nodes have other files; save the data "
                  "and read them again, or run one rank";
      }
      if (const char* name = InputCheck::GetExtractedName(data))
      {
        extracted = "input " + std::to_string(port) + " was extracted by a selection (array " +
          name +
          "): numbers of points that are picked count in each rank's own part of what was shown, "
          "and others would be taken; run one rank, or select by values and remove the array by "
          "Pass Arrays";
      }
    });
  differs = ranks.GetFirstText(differs);
  return differs.empty() ? extracted : differs;
}

//------------------------------------------------------------------------------
bool Algorithm::HasWork(const Ports& ports) const
{
  const bool hasInput = this->Self->GetNumberOfInputPorts() == 0 || this->TakesEmpty ||
    !HasNoElements(ports.GetInput<vtkDataObject>());
  const bool isMesh = !vtkImageData::GetData(ports.GetOutputInformation());
  switch (this->Sharing)
  {
    case Share::Together: // all of them work
      return hasInput && (lacuna::ControllerRanks().GetNumber() > 1 || ports.IsAsked());
    case Share::FirstRank:
      return hasInput && ports.IsFirst() && !this->IsElsewhere;
    case Share::EachRank:
      return hasInput && (isMesh ? ports.IsFirst() : ports.IsAsked());
    default:
      return hasInput && (isMesh || ports.IsAsked());
  }
}

//------------------------------------------------------------------------------
void Algorithm::Finish(const Ports& ports) const
{
  const std::vector<vtkDataObject*> origins = this->GetOrigins(ports);
  for (int i = 0; i < this->Self->GetNumberOfOutputPorts(); ++i)
  {
    auto* output = ports.GetOutput<vtkDataObject>(i);
    auto* image = vtkImageData::SafeDownCast(output);
    if (image && image->GetNumberOfPoints() > 0 && this->Sharing != Share::FirstRank)
    {
      image->Crop(ports.GetExtent(i).data());
    }
    const std::string parameters = this->Parameters(i);
    const bool isThere = !HasNoElements(output) || output->GetFieldData()->GetNumberOfArrays() > 0;
    if (isThere && !(origins.empty() && parameters.empty()))
    {
      lacuna::Provenance::Record(output, this->Self, origins, parameters);
      if (!this->KeepsPlace)
      {
        lacuna::Coordinates::Clear(output);
      }
    }
  }
}

//------------------------------------------------------------------------------
void Algorithm::RefuseBlocks()
{
  // VTK executes block by block and announces each, too: known by the time, which is that of all of them.
  const double now = this->GetTimes()[0];
  ForEachInput(this->Self,
    [&](int port, int i, vtkInformation*)
    {
      auto* blocks = vtkCompositeDataSet::SafeDownCast(this->Self->GetInputDataObject(port, i));
      const bool isRefused = blocks && !TakesType(this->Self, port, blocks);
      if (!this->TakesBlocks && (isRefused || this->BlocksAt == now))
      {
        this->BlocksAt = now;
        throw std::runtime_error("input " + std::to_string(port) +
          " has blocks, and this takes one data set: choose one by Extract Block, or use a filter "
          "for each");
      }
    });
}

//------------------------------------------------------------------------------
void Algorithm::CheckRequest(const Ports& ports) const
{
  if (lacuna::CheckAbort(this->Self))
  {
    throw Aborted();
  }
  this->CheckInputs(ports);
  this->CheckProperties();
}

//------------------------------------------------------------------------------
std::string Algorithm::Parameters(int) const
{
  lacuna::Properties properties;
  this->Describe(properties);
  return properties.GetText();
}

//------------------------------------------------------------------------------
void Algorithm::CheckInputs(const Ports& ports, int only) const
{
  const auto require = [](const std::string& error)
  {
    if (error == Stopped)
    {
      throw Aborted();
    }
    if (!error.empty())
    {
      throw std::runtime_error(error);
    }
  };
  const auto forEach = [&](const auto& body)
  {
    ForEachInput(this->Self,
      [&](int port, int i, vtkInformation* info)
      {
        if (only < 0 || port == only)
        {
          body(port, ports.GetInput<vtkDataObject>(port, i), info);
        }
      });
  };
  forEach([&](int, vtkDataObject* data, vtkInformation*) { require(Errors::GetOf(data)); });
  require(this->Announced);
  require(this->Refused);
  forEach(
    [&](int port, vtkDataObject* data, vtkInformation* info)
    {
      const std::string name = "input " + std::to_string(port);
      InputCheck::Check(data, name);
      InputCheck::CheckPart(data, info, name);
    });
}

//------------------------------------------------------------------------------
std::vector<double> Algorithm::GetTimes() const
{
  auto* executive = vtkDemandDrivenPipeline::SafeDownCast(this->Self->GetExecutive());
  std::vector<double> times{ executive ? static_cast<double>(executive->GetPipelineMTime()) : 0 };
  const auto add = [&times](vtkInformation* info)
  {
    vtkDataObject* data = vtkDataObject::GetData(info);
    const bool hasTimes = info->Has(SDDP::TIME_STEPS()) || info->Has(SDDP::TIME_RANGE());
    times.push_back(
      hasTimes && info->Has(SDDP::UPDATE_TIME_STEP()) ? info->Get(SDDP::UPDATE_TIME_STEP()) : 0);
    times.push_back(data && data->GetInformation()->Has(vtkDataObject::DATA_TIME_STEP())
        ? data->GetInformation()->Get(vtkDataObject::DATA_TIME_STEP())
        : 0);
  };
  ForEachInput(this->Self, [&](int, int, vtkInformation* info) { add(info); });
  return times;
}

//------------------------------------------------------------------------------
void Algorithm::Fail(vtkInformationVector* outputs, const std::string& error)
{
  lacuna::Errors::Empty(outputs);
  if (error == Stopped)
  {
    return; // not an error: the user asked for it
  }
  lacuna::Errors::Leave(outputs, error);
  if (!vtkObject::GetGlobalWarningDisplay())
  {
    return;
  }
  const std::vector<double> times = this->GetTimes();
  const std::string bare = WithoutHint(error);
  const bool isShown = (this->Shown.Times == times && this->Shown.Error == bare) ||
    WithoutHint(lacuna::Errors::GetUpstream(this->Self)) == bare;
  if (isShown)
  {
    lacuna::Errors::Repeat(this->Self, error);
    return;
  }
  if (!this->Self->HasObserver(vtkCommand::ErrorEvent)) // who may keep it to himself
  {
    this->Shown = { times, bare };
  }
  vtkErrorWithObjectMacro(this->Self, << error);
}
}
