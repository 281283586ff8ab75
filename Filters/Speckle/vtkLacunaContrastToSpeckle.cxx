// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaContrastToSpeckle.h"

#include "lacunaContrast.h"
#include "vtkDoubleArray.h"
#include "vtkIdTypeArray.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkLacunaExecution.h"
#include "vtkLacunaProvenance.h"
#include "vtkLacunaSpeckleTypes.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkTable.h"

#include <sstream>
#include <vector>

vtkStandardNewMacro(vtkLacunaContrastToSpeckle);

namespace
{
bool IsGiven(const double bounds[6])
{
  return bounds[0] <= bounds[1] && bounds[2] <= bounds[3] && bounds[4] <= bounds[5];
}

bool IsGiven(const std::string& array, const double bounds[6])
{
  return !array.empty() || IsGiven(bounds);
}

/// The named point array; null for an empty name. Throws when it is not there.
vtkDataArray* GetMask(vtkImageData* image, const std::string& name)
{
  if (name.empty())
  {
    return nullptr;
  }
  vtkDataArray* array = image->GetPointData()->GetArray(name.c_str());
  if (!array || array->GetNumberOfTuples() != image->GetNumberOfPoints())
  {
    throw std::runtime_error("the image has no point array '" + name +
      "' of numbers; choose one that is not 0 in the region");
  }
  return array;
}

/// Marks the points of a region that no region has yet.
void Mark(vtkImageData* image, const std::string& name, const double bounds[6],
  lacuna::Region region, std::vector<std::uint8_t>& regions, lacuna::Execution& execution)
{
  vtkDataArray* mask = GetMask(image, name);
  vtkDataArray* valid = image->GetPointData()->GetArray("vtkValidPointMask");
  const bool bounded = IsGiven(bounds);
  const lacuna::Extent box = vtkLacunaSpeckleTypes::GetExtent(image->GetExtent());
  vtkIdType id = 0;
  for (int k = box[4]; k <= box[5]; ++k)
  {
    execution.Report(double(k - box[4]) / lacuna::SizeOf(box, 2));
    for (int j = box[2]; j <= box[3]; ++j)
    {
      for (int i = box[0]; i <= box[1]; ++i, ++id)
      {
        bool in = regions[id] == lacuna::NoRegion && (!mask || mask->GetComponent(id, 0) != 0) &&
          (!valid || valid->GetComponent(id, 0) != 0);
        if (in && bounded)
        {
          double p[3];
          image->TransformIndexToPhysicalPoint(i, j, k, p);
          const double* range = bounds;
          for (int a = 0; a < 3; ++a, range += 2)
          {
            in = in && range[0] <= p[a] && p[a] <= range[1];
          }
        }
        if (in)
        {
          regions[id] = region;
        }
      }
    }
  }
}

template <class T>
void Measure(vtkDataArray* array, const lacuna::Extent& box,
  const std::vector<std::uint8_t>& regions, double isoValue,
  std::array<lacuna::RegionStatistics, 2>& statistics, std::int64_t& count,
  lacuna::Execution& execution)
{
  const lacuna::ImageView<const T> view(static_cast<const T*>(array->GetVoidPointer(0)), box);
  statistics = lacuna::MeasureRegions(view, regions.data(), execution);
  count = lacuna::CountThresholdedRegions(view, isoValue, execution);
}

void AddNumber(vtkTable* table, const std::string& name, double value)
{
  vtkNew<vtkDoubleArray> column;
  column->SetName(name.c_str());
  column->InsertNextValue(value);
  table->AddColumn(column);
}

void AddCount(vtkTable* table, const std::string& name, std::int64_t value)
{
  vtkNew<vtkIdTypeArray> column;
  column->SetName(name.c_str());
  column->InsertNextValue(static_cast<vtkIdType>(value));
  table->AddColumn(column);
}
}

//------------------------------------------------------------------------------
vtkLacunaContrastToSpeckle::vtkLacunaContrastToSpeckle()
{
  this->SetInputArrayToProcess(
    0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, vtkDataSetAttributes::SCALARS);
}

//------------------------------------------------------------------------------
int vtkLacunaContrastToSpeckle::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkImageData");
  return 1;
}

//------------------------------------------------------------------------------
int vtkLacunaContrastToSpeckle::RequestUpdateExtent(
  vtkInformation*, vtkInformationVector** inputs, vtkInformationVector*)
{
  // Regions may reach anywhere: every rank needs the whole image.
  using Pipeline = vtkStreamingDemandDrivenPipeline;
  vtkInformation* input = inputs[0]->GetInformationObject(0);
  int whole[6];
  input->Get(Pipeline::WHOLE_EXTENT(), whole);
  input->Set(Pipeline::UPDATE_EXTENT(), whole, 6);
  return 1;
}

//------------------------------------------------------------------------------
int vtkLacunaContrastToSpeckle::RequestData(
  vtkInformation*, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  return vtkLacunaExecution::Run(this, outputs,
    [&](vtkLacunaExecution& execution)
    {
      vtkImageData* image = vtkImageData::GetData(inputs[0]);
      vtkTable* table = vtkTable::GetData(outputs);
      const vtkSmartPointer<vtkDataArray> samples = vtkLacunaSpeckleTypes::GetSamples(
        vtkLacunaSpeckleTypes::Choose(
          this->GetInputArrayToProcess(0, inputs), this->GetInputArrayInformation(0), image),
        image);
      if (samples->GetNumberOfComponents() != 1)
      {
        throw std::runtime_error("the array has " +
          std::to_string(samples->GetNumberOfComponents()) +
          " components; choose one with a single component");
      }
      if (!IsGiven(this->InsideArray, this->InsideBounds))
      {
        throw std::runtime_error("no inside region: give InsideArray or InsideBounds");
      }

      std::vector<std::uint8_t> regions(image->GetNumberOfPoints(), lacuna::NoRegion);
      execution.SetStage(0, 0.3);
      Mark(image, this->InsideArray, this->InsideBounds, lacuna::InsideRegion, regions, execution);
      execution.SetStage(0.3, 0.6);
      Mark(
        image, this->OutsideArray, this->OutsideBounds, lacuna::OutsideRegion, regions, execution);
      std::array<lacuna::RegionStatistics, 2> statistics;
      std::int64_t count = 0;
      execution.SetStage(0.6, 1);
      switch (samples->GetDataType())
      {
        vtkTemplateMacro((Measure<typename vtkLacunaSpeckleTypes::Fixed<VTK_TT>::Type>(samples,
          vtkLacunaSpeckleTypes::GetExtent(image->GetExtent()), regions, this->IsoValue, statistics,
          count, execution)));
        default:
          throw std::runtime_error("arrays of type " + std::string(samples->GetDataTypeAsString()) +
            " cannot be measured; convert it to a numeric type");
      }
      const char* const names[2] = { "Inside", "Outside" };
      for (int r = 0; r < 2; ++r)
      {
        if (statistics[r].Count == 0)
        {
          throw std::runtime_error(std::string("no sample is ") + (r == 0 ? "inside" : "outside") +
            ": check " + names[r] + "Array and " + names[r] + "Bounds against the image");
        }
      }

      AddNumber(table, "CSR", lacuna::ContrastToSpeckle(statistics[0], statistics[1]));
      for (int r = 0; r < 2; ++r)
      {
        const std::string name = names[r];
        AddNumber(table, name + "Mean", statistics[r].Mean);
        AddNumber(table, name + "Variance", statistics[r].Variance);
        AddNumber(table, name + "SNR", statistics[r].SignalToNoise());
        AddCount(table, name + "Count", statistics[r].Count);
      }
      AddNumber(table, "IsoValue", this->IsoValue);
      AddCount(table, "Regions", count);
      std::ostringstream parameters;
      parameters.precision(17);
      parameters << "InsideArray=" << this->InsideArray << " OutsideArray=" << this->OutsideArray
                 << " IsoValue=" << this->IsoValue;
      vtkLacunaProvenance::Record(table, this, { image }, parameters.str());
    });
}

//------------------------------------------------------------------------------
void vtkLacunaContrastToSpeckle::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  const auto print = [&](const char* name, const double bounds[6])
  {
    os << indent << name << ":";
    for (int i = 0; i < 6; ++i)
    {
      os << " " << bounds[i];
    }
    os << "\n";
  };
  os << indent << "InsideArray: " << this->InsideArray << "\n";
  os << indent << "OutsideArray: " << this->OutsideArray << "\n";
  print("InsideBounds", this->InsideBounds);
  print("OutsideBounds", this->OutsideBounds);
  os << indent << "IsoValue: " << this->IsoValue << "\n";
}
