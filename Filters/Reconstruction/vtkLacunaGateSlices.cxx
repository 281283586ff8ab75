// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaGateSlices.h"

#include "lacunaFieldData.h"
#include "lacunaGateSignal.h"
#include "lacunaPoseJudge.h"
#include "lacunaPoseMatching.h"
#include "lacunaSliceMotion.h"
#include "lacunaTrackedSlices.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkLacunaSliceStream.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkStringArray.h"
#include "vtkTable.h"
#include "vtkUnsignedCharArray.h"
#include "vtkVariant.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <map>
#include <sstream>
#include <stdexcept>

namespace
{
constexpr std::array<const char*, 2> KeyNames{ "Timestamp", "FrameNumber" };
constexpr double NotANumber = std::numeric_limits<double>::quiet_NaN();

// One number for each tuple; NaN for texts that are none.
std::vector<double> GetNumbers(vtkAbstractArray* array)
{
  std::vector<double> numbers;
  for (vtkIdType i = 0; i < array->GetNumberOfTuples(); ++i)
  {
    bool isNumber = false;
    const double number = array->GetVariantValue(i).ToDouble(&isNumber);
    numbers.push_back(isNumber ? number : NotANumber);
  }
  return numbers;
}

std::vector<double> GetColumn(vtkTable* table, const std::string& name)
{
  vtkAbstractArray* column = table->GetColumnByName(name.c_str());
  if (!column || column->GetNumberOfComponents() != 1)
  {
    std::ostringstream message;
    message << "the gate table has no column '" << name << "'; its columns are";
    for (vtkIdType c = 0; c < table->GetNumberOfColumns(); ++c)
    {
      const char* other = table->GetColumnName(c);
      message << (c > 0 ? ", '" : " '") << (other ? other : "") << "'";
    }
    throw std::runtime_error(message.str());
  }
  return GetNumbers(column);
}

// The column that the user named, or the first of the usual ones that there is.
std::vector<double> GetKeyColumnOf(
  vtkTable* table, const std::string& name, std::initializer_list<const char*> usual)
{
  for (const char* candidate : usual)
  {
    if (name.empty() && table->GetColumnByName(candidate))
    {
      return GetColumn(table, candidate);
    }
  }
  return GetColumn(table, name.empty() ? *usual.begin() : name);
}

std::vector<double> GetField(vtkImageData* slices, const char* name, vtkIdType count)
{
  vtkDataArray* array = lacuna::FieldData::Get(slices, name, 1, count);
  std::vector<double> values;
  for (vtkIdType i = 0; i < count; ++i)
  {
    values.push_back(array->GetTuple1(i));
  }
  return values;
}

// Fields of sequence files come as texts.
std::vector<double> GetGateField(vtkImageData* slices, const std::string& name, vtkIdType count)
{
  auto* texts =
    vtkStringArray::SafeDownCast(slices->GetFieldData()->GetAbstractArray(name.c_str()));
  if (!texts)
  {
    return GetField(slices, name.c_str(), count);
  }
  const std::string which = "field data array '" + name + "' ";
  if (texts->GetNumberOfValues() != count)
  {
    throw std::runtime_error(which + "has " + std::to_string(texts->GetNumberOfValues()) +
      " texts; expected one for each of the " + std::to_string(count) + " slices");
  }
  std::vector<double> numbers = GetNumbers(texts);
  if (std::all_of(numbers.begin(), numbers.end(), [](double x) { return std::isnan(x); }))
  {
    throw std::runtime_error(
      which + "has no number; that of slice 0 is '" + std::string(texts->GetValue(0)) + "'");
  }
  return numbers;
}
}

vtkStandardNewMacro(vtkLacunaGateSlices);

//------------------------------------------------------------------------------
vtkLacunaGateSlices::vtkLacunaGateSlices()
{
  this->Sharing = lacuna::Share::Parts;
  this->TakesEmpty = true; // passes field data on
  this->SetNumberOfInputPorts(2);
}

//------------------------------------------------------------------------------
int vtkLacunaGateSlices::FillInputPortInformation(int port, vtkInformation* info)
{
  if (port == 1)
  {
    info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkTable");
    info->Set(vtkAlgorithm::INPUT_IS_OPTIONAL(), 1);
    return 1;
  }
  return this->Superclass::FillInputPortInformation(port, info);
}

//------------------------------------------------------------------------------
void vtkLacunaGateSlices::SetGateColumn(const char* name)
{
  if (this->GateColumn != (name ? name : ""))
  {
    this->GateColumn = name ? name : "";
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkLacunaGateSlices::SetKeyColumn(const char* name)
{
  if (this->KeyColumn != (name ? name : ""))
  {
    this->KeyColumn = name ? name : "";
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkLacunaGateSlices::Announce(const lacuna::Ports& ports)
{
  vtkLacunaSliceStream::Pass(this, ports.GetOutputInformation());
}

//------------------------------------------------------------------------------
void vtkLacunaGateSlices::Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution&)
{
  auto* slices = ports.GetInput<vtkImageData>();
  auto* table = ports.GetInput<vtkTable>(1);
  auto* output = ports.GetOutput<vtkImageData>();
  const int* whole =
    ports.GetInputInformation()->Get(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT());
  output->ShallowCopy(slices);
  if (slices->GetNumberOfPoints() == 0)
  {
    return;
  }
  vtkDataArray* status =
    lacuna::FieldData::Get(slices, lacuna::TrackedSlices::SliceStatusName, 1, -1);
  const vtkIdType count = status->GetNumberOfTuples();
  for (const int k : { slices->GetExtent()[4], slices->GetExtent()[5] })
  {
    lacuna::TrackedSlices::GetSliceNumber(slices, k, count); // throws when there is none
  }
  const bool hasGate = table || slices->GetFieldData()->HasArray(this->GateColumn.c_str());
  if (!hasGate && !(this->SpeedLimit > 0))
  {
    throw std::runtime_error("there is nothing to gate by: connect a table, or slices with a "
                             "field data array '" +
      this->GateColumn + "' (GateColumn), or give a SpeedLimit");
  }
  vtkNew<vtkUnsignedCharArray> flags;
  flags->SetName(lacuna::TrackedSlices::SliceStatusName);
  for (vtkIdType i = 0; i < count; ++i)
  {
    flags->InsertNextValue(static_cast<unsigned char>(status->GetTuple1(i)));
  }
  if (hasGate)
  {
    const std::vector<double> gates = this->GetGates(slices, table, count);
    const lacuna::GateRange range(
      this->GateRange[0], this->GateRange[1], this->GateType == Value ? 0 : this->Period);
    vtkIdType unknown = 0;
    for (vtkIdType i = 0; i < count; ++i)
    {
      unknown += std::isnan(gates[i]) ? 1 : 0;
      if (!range.Accepts(gates[i]))
      {
        flags->SetValue(i, flags->GetValue(i) | lacuna::TrackedSlices::GatedOut);
      }
    }
    if (unknown > 0)
    {
      vtkWarningMacro(<< unknown << " of " << count
                      << " slices have no gate value and are gated out: the gate signal does "
                         "not cover them");
    }
    lacuna::FieldData::Set(output, "Gate", gates, 1);
  }
  if (this->SpeedLimit > 0)
  {
    const std::vector<double> speeds = this->GetSpeeds(slices, whole, count);
    for (vtkIdType i = 0; i < count; ++i)
    {
      if (speeds[i] > this->SpeedLimit)
      {
        flags->SetValue(i, flags->GetValue(i) | lacuna::TrackedSlices::TooFast);
      }
    }
  }
  output->GetFieldData()->AddArray(flags);
}

//------------------------------------------------------------------------------
std::vector<double> vtkLacunaGateSlices::GetGates(
  vtkImageData* slices, vtkTable* table, vtkIdType count)
{
  if (!table)
  {
    if (this->GateType == Trigger)
    {
      throw std::runtime_error("triggers are rows of a table: connect one");
    }
    return GetGateField(slices, this->GateColumn, count);
  }
  return this->MatchBy == Timestamp ? this->GetGatesByTime(slices, table, count)
                                    : this->GetGatesByFrame(slices, table, count);
}

//------------------------------------------------------------------------------
void vtkLacunaGateSlices::WarnOfEmptyKeys(const std::vector<double>& keys)
{
  const std::string warning = lacuna::DescribeEmptyKeys("the gate table's key", keys);
  if (!warning.empty())
  {
    vtkWarningMacro(<< warning);
  }
}

//------------------------------------------------------------------------------
std::vector<double> vtkLacunaGateSlices::GetGatesByTime(
  vtkImageData* slices, vtkTable* table, vtkIdType count)
{
  const std::vector<double> times = GetField(slices, lacuna::TrackedSlices::TimestampName, count);
  std::vector<double> rows = GetKeyColumnOf(table, this->KeyColumn, { "Timestamp", "Time" });
  this->WarnOfEmptyKeys(rows);
  for (double& row : rows)
  {
    row += this->TimeOffset;
  }
  const lacuna::GateSignal signal(static_cast<lacuna::GateKind>(this->GateType), rows,
    this->GateType == Trigger ? rows : GetColumn(table, this->GateColumn), this->Period,
    this->MaximumTimeGap);
  std::vector<double> gates;
  bool isCovered = false;
  for (const double time : times)
  {
    gates.push_back(signal.At(time));
    isCovered |= !std::isnan(gates.back());
  }
  if (!isCovered)
  {
    std::ostringstream message;
    message.precision(12);
    message << "no slice has a gate value: the slices' Timestamp is " << times.front() << " to "
            << times.back() << " s, the gate table is from " << signal.GetFirstTime() << " to "
            << signal.GetLastTime() << " s; TimeOffset shifts the table";
    throw std::runtime_error(message.str());
  }
  return gates;
}

//------------------------------------------------------------------------------
std::vector<double> vtkLacunaGateSlices::GetGatesByFrame(
  vtkImageData* slices, vtkTable* table, vtkIdType count)
{
  if (this->GateType == Trigger)
  {
    throw std::runtime_error("triggers are instants: set MatchBy to Timestamp");
  }
  const std::vector<double> frames =
    GetField(slices, lacuna::TrackedSlices::FrameNumberName, count);
  const std::vector<double> rows =
    GetKeyColumnOf(table, this->KeyColumn, { "FrameNumber", "Frame" });
  this->WarnOfEmptyKeys(rows);
  const std::vector<double> values = GetColumn(table, this->GateColumn);
  std::map<double, double> gateOfFrame;
  for (std::size_t row = 0; row < rows.size(); ++row)
  {
    if (std::isfinite(rows[row]) && !gateOfFrame.emplace(rows[row], values[row]).second)
    {
      std::ostringstream message;
      message << "the gate table has several rows for frame " << rows[row];
      throw std::runtime_error(message.str());
    }
  }
  std::vector<double> gates;
  bool isCovered = false;
  for (const double frame : frames)
  {
    const auto found = gateOfFrame.find(frame);
    isCovered |= found != gateOfFrame.end();
    const double gate = found != gateOfFrame.end() ? found->second : NotANumber;
    gates.push_back(std::isfinite(gate) ? gate : NotANumber);
  }
  if (!isCovered)
  {
    std::ostringstream message;
    message << "no slice has a gate value: the slices' FrameNumber is " << frames.front() << " to "
            << frames.back() << ", and the gate table has none of them";
    throw std::runtime_error(message.str());
  }
  return gates;
}

//------------------------------------------------------------------------------
// As Slice Planes has them: a bad pose has none, and the slice after it has its speed since the
// slice before it.
std::vector<double> vtkLacunaGateSlices::GetSpeeds(
  vtkImageData* slices, const int whole[6], vtkIdType count)
{
  const lacuna::TrackedSlices tracked(slices);
  const std::vector<double> times = GetField(slices, lacuna::TrackedSlices::TimestampName, count);
  const lacuna::PoseJudge::Sweep sweep =
    lacuna::PoseJudge::JudgeSweep(slices, tracked, whole, false);
  std::vector<lacuna::Matrix4> poses;
  std::vector<std::string> problems;
  for (vtkIdType i = 0; i < count; ++i)
  {
    poses.push_back(tracked.GetImageToReference(i));
    if (!sweep.Problems[i].empty())
    {
      problems.push_back(sweep.Problems[i]);
    }
  }
  if (!problems.empty())
  {
    constexpr std::size_t most = 10;
    std::ostringstream text;
    text << "the speed is not known of slices with bad poses, of which there "
         << (problems.size() == 1 ? "is 1" : "are " + std::to_string(problems.size()))
         << "; they are not marked";
    for (std::size_t i = 0; i < problems.size() && i < most; ++i)
    {
      text << "\n" << problems[i];
    }
    text << (problems.size() > most ? "\n..." : "");
    vtkWarningMacro(<< text.str());
  }
  const double* origin = slices->GetOrigin();
  const double* spacing = slices->GetSpacing();
  const double first[2] = { origin[0] + spacing[0] * whole[0], origin[1] + spacing[1] * whole[2] };
  const double last[2] = { origin[0] + spacing[0] * whole[1], origin[1] + spacing[1] * whole[3] };
  return lacuna::GetSliceSpeeds(poses, sweep.HasPose, times,
    { lacuna::Vec3{ first[0], first[1], 0 }, lacuna::Vec3{ last[0], first[1], 0 },
      lacuna::Vec3{ first[0], last[1], 0 }, lacuna::Vec3{ last[0], last[1], 0 } });
}

//------------------------------------------------------------------------------
void vtkLacunaGateSlices::Describe(lacuna::Properties& properties) const
{
  using lacuna::ValueRange;
  properties.Add("GateType", this->GateType, lacuna::GateKindNames)
    .Add("GateRange", this->GateRange, ValueRange::Any())
    .Add("Period", this->Period, ValueRange::Above(0))
    .Add("GateColumn", this->GateColumn)
    .Add("MatchBy", this->MatchBy, KeyNames)
    .Add("KeyColumn", this->KeyColumn)
    .Add("TimeOffset", this->TimeOffset, ValueRange::Any("s"))
    .Add("MaximumTimeGap", this->MaximumTimeGap, ValueRange::AtLeast(0, "s"))
    .Add("SpeedLimit", this->SpeedLimit, ValueRange::AtLeast(0, "mm/s"));
}
