// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaInputs.h"

#include "vtkAbstractArray.h"
#include "vtkAlgorithm.h"
#include "vtkCompositeDataIterator.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataObject.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationDoubleKey.h"
#include "vtkLacunaFailure.h"
#include "vtkLacunaRanks.h"
#include "vtkLacunaRequest.h"
#include "vtkMatrix3x3.h"
#include "vtkSelection.h"
#include "vtkSelectionNode.h"
#include "vtkSmartPointer.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>
#include <stdexcept>

using SDDP = vtkStreamingDemandDrivenPipeline;

namespace
{
constexpr char HasBlocks[] =
  " has blocks, and this takes one data set: choose one by Extract Block, "
  "or use a filter for each";

void CheckLengths(
  vtkDataObject* data, const std::string& name, int type, const char* array, const char* of)
{
  vtkFieldData* group = data->GetAttributesAsFieldData(type);
  const vtkIdType wanted = data->GetNumberOfElements(type);
  for (int a = 0; group && wanted > 0 && a < group->GetNumberOfArrays(); ++a)
  {
    vtkAbstractArray* values = group->GetAbstractArray(a);
    if (values->GetNumberOfTuples() != wanted)
    {
      std::ostringstream message;
      message << name << " is not sound: its " << array << " "
              << (values->GetName() ? values->GetName() : "without a name") << " has "
              << values->GetNumberOfTuples() << " values for " << wanted << " " << of
              << "; mend or leave it out where it is made";
      throw std::runtime_error(message.str());
    }
  }
}

void CheckNumbers(const std::string& name, const char* what, const double* numbers, int count)
{
  if (std::all_of(numbers, numbers + count, [](double n) { return std::isfinite(n); }))
  {
    return;
  }
  std::ostringstream message;
  message << name << " is not sound: its " << what << " is";
  for (int i = 0; i < count; ++i)
  {
    message << " " << numbers[i];
  }
  message << "; these must be finite numbers";
  throw std::runtime_error(message.str());
}

std::string Text(const int extent[6])
{
  std::string text = std::to_string(extent[0]);
  for (int i = 1; i < 6; ++i)
  {
    text += " " + std::to_string(extent[i]);
  }
  return text;
}

// A part would be taken for all there is, and each rank would take another one.
void CheckPart(const std::string& name, const int arrived[6], const int asked[6])
{
  for (int c = 0; c < 6; c += 2)
  {
    if (asked[c] <= asked[c + 1] && (arrived[c] > asked[c] || arrived[c + 1] < asked[c + 1]))
    {
      throw std::runtime_error("only the part " + Text(arrived) + " of the image in " + name +
        " arrived, " + Text(asked) +
        " is needed; the filter before this one does not give what it is asked for");
    }
  }
}

// Algorithms behind which ranks do not have the same, though each has asked for the whole.
enum class Share
{
  Whole,
  Parts,  // or copies of them
  OnFirst // the first rank has all, the others nothing
};

// Whether a selection's numbers of points choose what an algorithm gives: they count in each rank's part
// of what was shown, and each rank has its own only.
bool ExtractsByNumber(vtkAlgorithm* algorithm)
{
  for (int port = 1;
       algorithm->IsA("vtkExtractSelection") && port < algorithm->GetNumberOfInputPorts(); ++port)
  {
    auto* selection = algorithm->GetNumberOfInputConnections(port) > 0
      ? vtkSelection::SafeDownCast(algorithm->GetInputDataObject(port, 0))
      : nullptr;
    for (unsigned int i = 0; selection && i < selection->GetNumberOfNodes(); ++i)
    {
      if (selection->GetNode(i)->GetContentType() == vtkSelectionNode::INDICES)
      {
        return true;
      }
    }
  }
  return false;
}

Share GetShare(vtkAlgorithm* algorithm)
{
  static const std::set<std::string> parts{ "vtkDistributedPointCloudFilter",
    "vtkPDistributedDataFilter", "vtkPResampleToImage", "vtkRedistributeDataSetFilter",
    "vtkPStreamTracer", "vtkReductionFilter" };
  static const std::set<std::string> onFirst{ "vtkDIYAggregateDataSetFilter",
    "vtkIntegrateAttributes", "vtkPOutlineFilter", "vtkPProbeFilter", "vtkPVProbeLineFilter" };
  const std::string name = algorithm->GetClassName();
  if (parts.count(name) > 0 || ExtractsByNumber(algorithm))
  {
    return Share::Parts;
  }
  // Lacuna's other serial filters make all of it on each rank that asks for it
  return onFirst.count(name) > 0 || vtkLacunaRequest::IsOnFirst(algorithm) ? Share::OnFirst
                                                                           : Share::Whole;
}

// The first such algorithm upstream, before one of Lacuna's others, which give the whole; null: none.
vtkAlgorithm* FindSharing(vtkAlgorithm* algorithm)
{
  const std::string name = algorithm->GetClassName();
  if (GetShare(algorithm) != Share::Whole)
  {
    return algorithm;
  }
  vtkAlgorithm* found = nullptr;
  for (int port = 0; port < algorithm->GetNumberOfInputPorts() && name.rfind("vtkLacuna", 0) != 0;
       ++port)
  {
    for (int i = 0; i < algorithm->GetNumberOfInputConnections(port) && !found; ++i)
    {
      vtkAlgorithm* upstream = algorithm->GetInputAlgorithm(port, i);
      found = upstream ? FindSharing(upstream) : nullptr;
    }
  }
  return found;
}

// Of several ranks, each of which takes the data for all there are.
void CheckShare(const std::string& name, vtkAlgorithm* upstream, bool isImage)
{
  vtkAlgorithm* found = upstream ? FindSharing(upstream) : nullptr;
  const Share share = found ? GetShare(found) : Share::Whole;
  const bool isSeen = isImage && found == upstream; // parts of images are (CheckPart)
  if ((share == Share::Parts && !isSeen) ||
    (share == Share::OnFirst && vtkLacunaRanks().GetRank() > 0))
  {
    throw std::runtime_error(name + " is not the same on all ranks: " + found->GetClassName() +
      " before this filter gives " +
      (share == Share::Parts ? "them parts or copies" : "all to the first one") +
      ", and each needs the whole; save the data and read them again, or run one rank");
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

// When algorithm or something upstream changed last.
double GetTime(vtkAlgorithm* algorithm, int port, int connection)
{
  return vtkLacunaRequest::GetTimes(algorithm, algorithm->GetInputInformation(port, connection))[0];
}

// Room for windows and margins around it, which are counted in the same type.
void CheckExtent(const std::string& name, const int extent[6])
{
  constexpr int limit = 1 << 30;
  if (std::any_of(extent, extent + 6, [](int index) { return index < -limit || index > limit; }))
  {
    throw std::runtime_error(name + " is not sound: its extent is " + Text(extent) +
      "; indices must be from -2^30 to 2^30");
  }
}
}

//------------------------------------------------------------------------------
void vtkLacunaInputs::Check(vtkDataObject* data, const std::string& name)
{
  if (auto* blocks = vtkCompositeDataSet::SafeDownCast(data))
  {
    const auto block = vtkSmartPointer<vtkCompositeDataIterator>::Take(blocks->NewIterator());
    for (block->InitTraversal(); !block->IsDoneWithTraversal(); block->GoToNextItem())
    {
      Check(block->GetCurrentDataObject(),
        name + ", block " + std::to_string(block->GetCurrentFlatIndex()) + ",");
    }
    return;
  }
  if (!data)
  {
    return;
  }
  CheckLengths(data, name, vtkDataObject::POINT, "point array", "points");
  CheckLengths(data, name, vtkDataObject::CELL, "cell array", "cells");
  CheckLengths(data, name, vtkDataObject::ROW, "column", "rows");
  auto* image = vtkImageData::SafeDownCast(data);
  if (image && image->GetNumberOfPoints() > 0)
  {
    CheckExtent(name, image->GetExtent());
    CheckNumbers(name, "spacing", image->GetSpacing(), 3);
    CheckNumbers(name, "origin", image->GetOrigin(), 3);
    CheckNumbers(name, "direction matrix", image->GetDirectionMatrix()->GetData(), 9);
  }
}

//------------------------------------------------------------------------------
void vtkLacunaInputs::CheckPart(vtkDataObject* data, vtkInformation* info, const std::string& name)
{
  auto* image = vtkImageData::SafeDownCast(data);
  // of several pieces this one is a part of what the extent says
  if (image && image->GetNumberOfPoints() > 0 && info->Has(SDDP::UPDATE_EXTENT()) &&
    info->Get(SDDP::UPDATE_NUMBER_OF_PIECES()) <= 1)
  {
    ::CheckPart(name, image->GetExtent(), info->Get(SDDP::UPDATE_EXTENT()));
  }
}

//------------------------------------------------------------------------------
void vtkLacunaInputs::Check(vtkAlgorithm* algorithm)
{
  const std::string failed = vtkLacunaFailure::GetUpstream(algorithm);
  if (!failed.empty())
  {
    throw std::runtime_error(failed);
  }
  for (int port = 0; port < algorithm->GetNumberOfInputPorts(); ++port)
  {
    Check(algorithm, port);
  }
}

//------------------------------------------------------------------------------
void vtkLacunaInputs::Check(vtkAlgorithm* algorithm, int port)
{
  const std::string refusal = vtkLacunaRequest::TakeRefusal(algorithm, port);
  if (!refusal.empty())
  {
    throw std::runtime_error(refusal);
  }
  for (int i = 0; i < algorithm->GetNumberOfInputConnections(port); ++i)
  {
    const std::string name = "input " + std::to_string(port);
    Check(algorithm->GetInputDataObject(port, i), name);
    auto* image = vtkImageData::SafeDownCast(algorithm->GetInputDataObject(port, i));
    vtkInformation* info = algorithm->GetInputInformation(port, i);
    if (vtkLacunaRanks().GetNumber() > 1)
    {
      CheckShare(name, algorithm->GetInputAlgorithm(port, i), image != nullptr);
    }
    CheckPart(image, info, name);
  }
}

//------------------------------------------------------------------------------
void vtkLacunaInputs::CheckSingle(vtkAlgorithm* algorithm)
{
  // VTK executes block by block and shows one only then. The time tells that it is of the same input.
  static vtkInformationDoubleKey* const refused =
    vtkInformationDoubleKey::MakeKey("TIME_OF_BLOCKS", "vtkLacunaInputs");
  vtkInformation* own = algorithm->GetInformation();
  for (int port = 0; port < algorithm->GetNumberOfInputPorts(); ++port)
  {
    for (int i = 0; i < algorithm->GetNumberOfInputConnections(port); ++i)
    {
      vtkDataObject* data = algorithm->GetInputDataObject(port, i);
      if (!data)
      {
        continue;
      }
      const double time = GetTime(algorithm, port, i);
      const bool hasBlocks =
        vtkCompositeDataSet::SafeDownCast(data) && !TakesType(algorithm, port, data);
      if (hasBlocks || (own->Has(refused) && own->Get(refused) == time))
      {
        own->Set(refused, time);
        throw std::runtime_error("input " + std::to_string(port) + HasBlocks);
      }
    }
  }
  if (own->Has(refused))
  {
    own->Remove(refused);
  }
}
