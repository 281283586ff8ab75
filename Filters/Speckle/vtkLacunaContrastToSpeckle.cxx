// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaContrastToSpeckle.h"

#include "lacunaArrayScalarType.h"
#include "lacunaContrast.h"
#include "lacunaMemory.h"
#include "lacunaSpeckleInput.h"
#include "lacunaVolumeDirection.h"
#include "vtkDoubleArray.h"
#include "vtkIdTypeArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkMatrix4x4.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkTable.h"

#include <algorithm>
#include <stdexcept>
#include <vector>

vtkStandardNewMacro(vtkLacunaContrastToSpeckle);

namespace
{
const char* const RegionNames[2] = { "Inside", "Outside" };

bool HasBounds(const double bounds[6])
{
  lacuna::RegionRule rule;
  std::copy_n(bounds, 6, rule.Bounds.begin());
  return rule.HasBounds();
}

vtkDataArray* FindNumbers(vtkImageData* image, const std::string& name)
{
  vtkDataArray* array = lacuna::SpeckleInput::FindArray(image, name);
  if (array->GetNumberOfComponents() != 1)
  {
    throw std::runtime_error(lacuna::SpeckleInput::Name(array) + " has " +
      std::to_string(array->GetNumberOfComponents()) +
      " components; choose one with a single component, for example a Calculator's result");
  }
  return array;
}

/// Sets to region the points that an array and bounds say, of those that no region has yet.
void Mark(vtkImageData* image, const std::string& array, const double bounds[6],
  lacuna::Region region, std::vector<std::uint8_t>& regions, lacuna::Execution& execution)
{
  constexpr const char* ValidMask = "vtkValidPointMask";
  std::vector<vtkSmartPointer<vtkDataArray>> values;
  lacuna::RegionRule rule;
  std::copy_n(bounds, 6, rule.Bounds.begin());
  for (const std::string& name : { array, std::string(ValidMask) })
  {
    if (name.empty() || (name == ValidMask && !image->GetPointData()->HasArray(ValidMask)))
    {
      continue;
    }
    vtkDataArray* mask = FindNumbers(image, name);
    values.push_back(lacuna::SpeckleInput::MakeContiguous(mask));
    rule.Masks.push_back({ lacuna::ArrayScalarType::Get(mask), values.back()->GetVoidPointer(0) });
  }
  lacuna::VolumeDirection::Check(image);
  const lacuna::Matrix4 indexToWorld(image->GetIndexToPhysicalMatrix()->GetData());
  lacuna::MarkRegion(lacuna::SpeckleInput::GetExtent(image->GetExtent()), indexToWorld, rule,
    region, regions.data(), execution);
}

/// A table of one row that grows column by column; of none when there shall be no row.
class Row
{
public:
  Row(vtkTable* table, bool there)
    : Table(table)
    , There(there)
  {
  }

  void Add(const std::string& name, double value) { this->AddTo<vtkDoubleArray>(name, value); }
  void AddCount(const std::string& name, std::int64_t value)
  {
    this->AddTo<vtkIdTypeArray>(name, static_cast<vtkIdType>(value));
  }

private:
  template <class Array, class Value>
  void AddTo(const std::string& name, Value value)
  {
    vtkNew<Array> column;
    column->SetName(name.c_str());
    if (this->There)
    {
      column->InsertNextValue(value);
    }
    this->Table->AddColumn(column);
  }

  vtkTable* Table;
  bool There;
};

struct Measures
{
  std::array<lacuna::RegionStatistics, 2> Statistics;
  std::int64_t Regions = 0;
};

void Write(const Measures& measures, double isoValue, Row row)
{
  row.Add("CSR", lacuna::ContrastToSpeckle(measures.Statistics[0], measures.Statistics[1]));
  for (int r = 0; r < 2; ++r)
  {
    const std::string name = RegionNames[r];
    const lacuna::RegionStatistics& statistics = measures.Statistics[r];
    row.Add(name + "Mean", statistics.Mean);
    row.Add(name + "Variance", statistics.Variance);
    row.Add(name + "SNR", statistics.SignalToNoise());
    row.AddCount(name + "Count", statistics.Count);
  }
  row.Add("IsoValue", isoValue);
  row.AddCount("Regions", measures.Regions);
}
}

//------------------------------------------------------------------------------
int vtkLacunaContrastToSpeckle::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkImageData");
  return 1;
}

//------------------------------------------------------------------------------
vtkLacunaContrastToSpeckle::vtkLacunaContrastToSpeckle()
{
  this->Sharing = lacuna::Share::FirstRank;
  this->TakesEmpty = true; // an error
  this->TakesBlocks = true;
}

//------------------------------------------------------------------------------
void vtkLacunaContrastToSpeckle::MakeNothing(const lacuna::Ports& ports)
{
  // the same columns, without a row
  Write(Measures(), this->IsoValue, Row(ports.GetOutput<vtkTable>(), false));
}

//------------------------------------------------------------------------------
void vtkLacunaContrastToSpeckle::Make(
  const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution)
{
  auto* image = ports.GetInput<vtkImageData>();
  vtkDataArray* array = FindNumbers(image, this->ScalarArray);
  const lacuna::ScalarType type = lacuna::ArrayScalarType::Get(array);
  const auto samples = lacuna::SpeckleInput::MakeContiguous(array);
  if (this->InsideArray.empty() && !HasBounds(this->InsideBounds))
  {
    throw std::runtime_error("no inside region: give InsideArray or InsideBounds");
  }

  lacuna::RequireMemory(
    "the regions of the image", static_cast<double>(image->GetNumberOfPoints()));
  std::vector<std::uint8_t> regions(image->GetNumberOfPoints(), lacuna::NoRegion);
  execution.SetStage(0, 0.2);
  Mark(image, this->InsideArray, this->InsideBounds, lacuna::InsideRegion, regions, execution);
  execution.SetStage(0.2, 0.4);
  Mark(image, this->OutsideArray, this->OutsideBounds, lacuna::OutsideRegion, regions, execution);
  Measures measures;
  const lacuna::Extent box = lacuna::SpeckleInput::GetExtent(image->GetExtent());
  lacuna::DispatchScalars(type, samples->GetVoidPointer(0),
    [&](const auto* values)
    {
      const lacuna::ImageView view(values, box);
      execution.SetStage(0.4, 0.7);
      measures.Statistics = lacuna::MeasureRegions(view, regions.data(), execution);
      execution.SetStage(0.7, 1);
      measures.Regions = lacuna::CountThresholdedRegions(view, this->IsoValue, execution);
    });
  for (int r = 0; r < 2; ++r)
  {
    if (measures.Statistics[r].Count == 0)
    {
      throw std::runtime_error(std::string("no sample is ") + (r == 0 ? "inside" : "outside") +
        ": check " + RegionNames[r] + "Array and " + RegionNames[r] + "Bounds against the image");
    }
  }
  Write(measures, this->IsoValue, Row(ports.GetOutput<vtkTable>(), true));
}

//------------------------------------------------------------------------------
void vtkLacunaContrastToSpeckle::Describe(lacuna::Properties& properties) const
{
  properties.Add("ScalarArray", this->ScalarArray)
    .Add("InsideArray", this->InsideArray)
    .Add("InsideBounds", this->InsideBounds)
    .Add("OutsideArray", this->OutsideArray)
    .Add("OutsideBounds", this->OutsideBounds)
    .Add("IsoValue", this->IsoValue, lacuna::ValueRange::Any("grey level"));
}
