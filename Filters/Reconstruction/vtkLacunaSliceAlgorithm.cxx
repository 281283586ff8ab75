// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaSliceAlgorithm.h"

#include "lacunaFieldData.h"
#include "lacunaPoseJudge.h"
#include "lacunaSliceImages.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkIntArray.h"
#include "vtkLacunaSliceStream.h"
#include "vtkNew.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <array>
#include <utility>

using SDDP = vtkStreamingDemandDrivenPipeline;

namespace
{
constexpr std::array<const char*, 3> GapMethodNames{ "Automatic", "Given", "Unlimited" };
}

//------------------------------------------------------------------------------
int vtkLacunaSliceAlgorithm::ProcessRequest(
  vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  // Slices that change with time change the output's place: it is found again when the time is known.
  // Its extent stays as it was: VTK does not tell those downstream of another one, who would cut it
  // off. Make compares the two.
  if (request->Has(SDDP::REQUEST_TIME_DEPENDENT_INFORMATION()))
  {
    vtkInformation* output = outputs->GetInformationObject(0);
    int known[6] = { 0, -1, 0, -1, 0, -1 }, asked[6] = { 0, -1, 0, -1, 0, -1 };
    output->Get(SDDP::WHOLE_EXTENT(), known);
    output->Get(SDDP::UPDATE_EXTENT(), asked);
    const int isAsked = output->Get(SDDP::UPDATE_EXTENT_INITIALIZED());
    const int result = this->RequestInformation(request, inputs, outputs);
    if (known[0] <= known[1])
    {
      output->Set(SDDP::WHOLE_EXTENT(), known, 6);
      // also after an error, which is told with the data
      output->Set(SDDP::UPDATE_EXTENT(), asked, 6);
      output->Set(SDDP::UPDATE_EXTENT_INITIALIZED(), isAsked);
    }
    return result;
  }
  return this->Superclass::ProcessRequest(request, inputs, outputs);
}

//------------------------------------------------------------------------------
void vtkLacunaSliceAlgorithm::Ask(const lacuna::Ports& ports)
{
  for (int i = 0; i < this->GetNumberOfInputConnections(0); ++i)
  {
    vtkInformation* info = ports.GetInputInformation(0, i);
    if (this->TakesStreams() && vtkLacunaSliceStream::Find(this, 0, i))
    {
      this->AskFor(info, vtkLacunaSliceStream::GetFirstSlice(info)); // for the field data
    }
    else
    {
      this->AskForWhole(info);
    }
  }
}

//------------------------------------------------------------------------------
void vtkLacunaSliceAlgorithm::DescribeGapMethod(lacuna::Properties& properties) const
{
  properties.Add("GapMethod", this->GapMethod, GapMethodNames);
}

//------------------------------------------------------------------------------
void vtkLacunaSliceAlgorithm::DescribeClip(lacuna::Properties& properties) const
{
  properties.Add(
    "ClipRectangle", this->ClipRectangle, lacuna::ValueRange::AtLeast(1, "pixels").OrZero("all"));
}

//------------------------------------------------------------------------------
void vtkLacunaSliceAlgorithm::DescribeSlices(lacuna::Properties& properties) const
{
  using lacuna::ValueRange;
  properties.Add("FanOrigin", this->FanOrigin, ValueRange::Any("pixels"))
    .Add("FanAngles", this->FanAngles, ValueRange::Any("degrees"))
    .Add("FanRadii", this->FanRadii, ValueRange::Above(0, "mm").OrZero("no fan"))
    .Add("UseImageInvalid", this->UseImageInvalid)
    .Add("UseTooFast", this->UseTooFast)
    .Add("UseGatedOut", this->UseGatedOut)
    .Add("BadPoses", this->BadPoses, lacuna::PoseJudge::BadPoseRuleNames);
}

//------------------------------------------------------------------------------
void vtkLacunaSliceAlgorithm::RecordSweeps(const std::vector<const lacuna::SliceImages*>& inputs,
  double maximumGap, vtkImageData* output, std::map<std::string, std::string>& warnings)
{
  this->SweepDescription.clear();
  std::vector<double> gaps;
  vtkNew<vtkIntArray> sweeps;
  sweeps->SetName("Sweeps");
  sweeps->SetNumberOfComponents(3);
  for (std::size_t i = 0; i < inputs.size(); ++i)
  {
    const lacuna::SliceImages& input = *inputs[i];
    this->SweepDescription += (this->SweepDescription.empty() ? "" : "\n") + input.DescribeSweeps();
    for (const lacuna::SliceImages::Sweep& sweep : input.Sweeps)
    {
      const std::array<int, 3> tuple{ static_cast<int>(i), sweep.First, sweep.Last };
      sweeps->InsertNextTypedTuple(tuple.data());
      gaps.push_back(sweep.WidestStep);
    }
    if (!input.JoinedEnds.empty() && this->GapMethod == GivenGap && maximumGap == 0)
    {
      warnings["joined " + input.JoinedEnds] =
        "slices of different sweeps seem to be joined through the air: " + input.JoinedEnds +
        ". Set GapMethod to Automatic to leave that empty, or to Unlimited if it is meant";
    }
  }
  output->GetFieldData()->AddArray(sweeps);
  lacuna::FieldData::Set(output, "SweepGap", gaps, 1);
}

//------------------------------------------------------------------------------
void vtkLacunaSliceAlgorithm::WarnOfNews(
  const std::map<std::string, std::string>& warnings, const std::vector<std::string>& leftOut)
{
  std::set<std::string> facts(leftOut.begin(), leftOut.end());
  std::vector<std::string> news;
  for (const std::string& sentence : leftOut)
  {
    if (this->KnownFacts.count(sentence) == 0)
    {
      news.push_back(sentence);
    }
  }
  if (!news.empty())
  {
    vtkWarningMacro(<< lacuna::SliceImages::DescribeLeftOut(news));
  }
  for (const auto& [fact, text] : warnings)
  {
    facts.insert(fact);
    if (this->KnownFacts.count(fact) == 0)
    {
      vtkWarningMacro(<< text);
    }
  }
  this->KnownFacts = std::move(facts);
}
