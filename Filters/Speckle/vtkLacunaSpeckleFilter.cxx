// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaSpeckleFilter.h"

#include "lacunaArrayScalarType.h"
#include "lacunaArrays.h"
#include "lacunaMemory.h"
#include "lacunaSpeckleFilter.h"
#include "lacunaSpeckleInput.h"
#include "lacunaTrackedSlices.h"
#include "lacunaVolumeDirection.h"
#include "vtkDataObject.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkMatrix3x3.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <cmath>

vtkStandardNewMacro(vtkLacunaSpeckleFilter);

namespace
{
// All arrays of the input but the chosen one, at the points of the output, a part of it.
void CopyOthers(vtkImageData* input, vtkDataArray* chosen, vtkImageData* output)
{
  vtkPointData* from = input->GetPointData();
  const int* extent = output->GetExtent();
  const vtkIdType width = extent[1] - extent[0] + 1;
  for (int a = 0; a < from->GetNumberOfArrays(); ++a)
  {
    vtkAbstractArray* array = from->GetAbstractArray(a);
    if (array == chosen)
    {
      continue;
    }
    const auto part = vtkSmartPointer<vtkAbstractArray>::Take(array->NewInstance());
    part->SetName(array->GetName());
    part->SetNumberOfComponents(array->GetNumberOfComponents());
    part->CopyComponentNames(array);
    if (array->HasInformation())
    {
      part->CopyInformation(array->GetInformation(), 1);
    }
    if (auto* numbers = vtkDataArray::SafeDownCast(array))
    {
      vtkDataArray::SafeDownCast(part)->SetLookupTable(numbers->GetLookupTable());
    }
    lacuna::Arrays::SetNumberOfTuples(part, output->GetNumberOfPoints());
    vtkIdType to = 0;
    for (int k = extent[4]; k <= extent[5]; ++k)
    {
      for (int j = extent[2]; j <= extent[3]; ++j, to += width)
      {
        int ijk[3] = { extent[0], j, k };
        part->InsertTuples(to, width, input->ComputePointId(ijk), array);
      }
    }
    const int index = output->GetPointData()->AddArray(part);
    const int attribute = from->IsArrayAnAttribute(a);
    if (attribute >= 0)
    {
      output->GetPointData()->SetActiveAttribute(index, attribute);
    }
  }
}

using Pipeline = vtkStreamingDemandDrivenPipeline;

bool IsTrackedSlices(vtkDataObject* data)
{
  return data->GetFieldData()->HasArray(lacuna::TrackedSlices::ImageToReferenceName) ||
    data->GetFieldData()->HasArray(lacuna::TrackedSlices::SliceStatusName);
}

lacuna::Extent GetWhole(vtkInformation* info)
{
  int whole[6] = { 0, -1, 0, -1, 0, -1 };
  info->Get(Pipeline::WHOLE_EXTENT(), whole);
  return lacuna::SpeckleInput::GetExtent(whole);
}

/// from: the samples of a component after the other at each point of fromBox.
template <class T>
void FilterArray(const T* from, const lacuna::Extent& fromBox, vtkDataArray* to,
  const lacuna::Extent& toBox, const lacuna::SpeckleParameters& parameters,
  lacuna::Execution& execution)
{
  using Result = lacuna::LaplacianType<T>;
  const int components = to->GetNumberOfComponents();
  for (int c = 0; c < components; ++c)
  {
    execution.SetStage(double(c) / components, double(c + 1) / components);
    const lacuna::ImageView<const T> input(from + c, fromBox, components);
    if (parameters.Operation == lacuna::SpeckleOperation::LaplacianOfGaussian)
    {
      const lacuna::ImageView<Result> output(
        static_cast<Result*>(to->GetVoidPointer(0)) + c, toBox, components);
      lacuna::FilterSpeckleLaplacian(input, output, parameters, execution);
    }
    else
    {
      const lacuna::ImageView<T> output(
        static_cast<T*>(to->GetVoidPointer(0)) + c, toBox, components);
      lacuna::FilterSpeckle(input, output, parameters, execution);
    }
  }
}
}

//------------------------------------------------------------------------------
vtkLacunaSpeckleFilter::vtkLacunaSpeckleFilter()
{
  this->Sharing = lacuna::Share::Parts;
  this->TakesEmpty = true; // passes field data on
}

//------------------------------------------------------------------------------
void vtkLacunaSpeckleFilter::Announce(const lacuna::Ports& ports)
{
  vtkInformation* scalars = vtkDataObject::GetActiveFieldInformation(ports.GetInputInformation(),
    vtkDataObject::FIELD_ASSOCIATION_POINTS, vtkDataSetAttributes::SCALARS);
  const char* active = scalars ? scalars->Get(vtkDataObject::FIELD_NAME()) : nullptr;
  if (this->Operation == LaplacianOfGaussian &&
    (this->ScalarArray.empty() || (active && this->ScalarArray == active)))
  {
    const bool isDouble = scalars && scalars->Get(vtkDataObject::FIELD_ARRAY_TYPE()) == VTK_DOUBLE;
    vtkDataObject::SetPointDataActiveScalarInfo(
      ports.GetOutputInformation(), isDouble ? VTK_DOUBLE : VTK_FLOAT, -1);
  }
}

//------------------------------------------------------------------------------
void vtkLacunaSpeckleFilter::Ask(const lacuna::Ports& ports)
{
  vtkInformation* input = ports.GetInputInformation();
  double spacing[3] = { 1, 1, 1 };
  if (input->Has(vtkDataObject::SPACING()))
  {
    input->Get(vtkDataObject::SPACING(), spacing);
  }
  lacuna::Extent needed = GetPart(ports.GetOutputInformation());
  try
  {
    if (!lacuna::IsEmpty(needed))
    {
      needed = lacuna::Intersect(
        lacuna::GetSpeckleInput(this->GetOptions(spacing), needed), GetWhole(input));
    }
  }
  catch (const std::invalid_argument&)
  {
    // Make reports it.
  }
  this->AskFor(input, needed);
}

//------------------------------------------------------------------------------
void vtkLacunaSpeckleFilter::Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution)
{
  auto* input = ports.GetInput<vtkImageData>();
  auto* output = ports.GetOutput<vtkImageData>();
  lacuna::Extent box = ports.GetExtent();
  const lacuna::Extent inBox = lacuna::SpeckleInput::GetExtent(input->GetExtent());
  output->SetOrigin(input->GetOrigin());
  output->SetSpacing(input->GetSpacing());
  output->SetDirectionMatrix(input->GetDirectionMatrix()->GetData());
  output->GetFieldData()->PassData(input->GetFieldData());
  if (lacuna::IsEmpty(box))
  {
    return;
  }
  lacuna::VolumeDirection::Check(input);
  const lacuna::SpeckleParameters parameters = this->GetOptions(input->GetSpacing());
  vtkDataArray* chosen = lacuna::SpeckleInput::FindArray(input, this->ScalarArray);
  const lacuna::ScalarType scalarType = lacuna::ArrayScalarType::Get(chosen);
  const auto from = lacuna::SpeckleInput::MakeContiguous(chosen);
  if (this->KernelSize[2] > 1 && IsTrackedSlices(input))
  {
    vtkWarningMacro("KernelSize z is " << this->KernelSize[2]
                                       << " on tracked slices, which are not parallel: the "
                                          "filter mixes slices; 1 filters each by itself");
  }

  int type = from->GetDataType();
  if (this->Operation == LaplacianOfGaussian)
  {
    type = type == VTK_DOUBLE ? VTK_DOUBLE : VTK_FLOAT;
  }
  lacuna::RequireMemory("the filtered " + lacuna::SpeckleInput::Name(chosen),
    static_cast<double>(lacuna::NumberOfSamples(box)) * from->GetNumberOfComponents() *
      vtkDataArray::GetDataTypeSize(type));
  auto to = vtk::TakeSmartPointer(vtkDataArray::CreateDataArray(type));
  to->SetName(from->GetName());
  to->SetNumberOfComponents(from->GetNumberOfComponents());
  lacuna::Arrays::SetNumberOfTuples(to, lacuna::NumberOfSamples(box));
  lacuna::DispatchScalars(scalarType, from->GetVoidPointer(0),
    [&](const auto* samples) { FilterArray(samples, inBox, to, box, parameters, execution); });

  output->SetExtent(box.data());
  vtkPointData* inData = input->GetPointData();
  vtkPointData* outData = output->GetPointData();
  if (box == inBox)
  {
    outData->PassData(inData);
  }
  else
  {
    CopyOthers(input, chosen, output); // the chosen one would be half of the time
  }
  const bool active = inData->GetScalars() == chosen;
  if (chosen->GetName())
  {
    outData->AddArray(to); // in place of the one of that name
  }
  if (active)
  {
    outData->SetScalars(to);
  }
}

//------------------------------------------------------------------------------
lacuna::SpeckleParameters vtkLacunaSpeckleFilter::GetOptions(const double spacing[3]) const
{
  lacuna::SpeckleParameters parameters;
  parameters.Operation = static_cast<lacuna::SpeckleOperation>(this->Operation);
  parameters.Shape = static_cast<lacuna::WindowShape>(this->KernelShape);
  parameters.Percentile = this->Rank;
  parameters.AdaptiveStrength = this->AdaptiveStrength;
  parameters.StandardDeviation = this->StandardDeviation;
  for (int a = 0; a < 3; ++a)
  {
    parameters.KernelSize[a] = this->KernelSize[a];
    parameters.Spacing[a] = std::abs(spacing[a]);
  }
  return parameters;
}

//------------------------------------------------------------------------------
void vtkLacunaSpeckleFilter::Describe(lacuna::Properties& properties) const
{
  const double anySpacing[3] = { 1, 1, 1 };
  properties.Add("ScalarArray", this->ScalarArray);
  this->GetOptions(anySpacing).Describe(properties);
}
