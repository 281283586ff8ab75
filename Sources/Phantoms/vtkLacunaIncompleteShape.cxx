// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaIncompleteShape.h"

#include "lacunaArrays.h"
#include "lacunaFieldData.h"
#include "lacunaIncompleteShape.h"
#include "lacunaMemory.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <limits>
#include <sstream>
#include <stdexcept>

vtkStandardNewMacro(vtkLacunaIncompleteShape);

// As the kernel takes them.
struct vtkLacunaIncompleteShape::Options : lacuna::IncompleteShape::Parameters
{
  explicit Options(const vtkLacunaIncompleteShape* self)
  {
    this->Shape = static_cast<lacuna::IncompleteShape::Kind>(self->Shape);
    std::copy_n(self->Dimensions, 3, this->Dimensions.begin());
    this->PresentFraction = self->PresentFraction;
    this->Patches = self->Patches;
    this->PatchRadii = { self->PatchRadii[0], self->PatchRadii[1] };
    this->GapAngle = self->GapAngle;
    this->TissueFraction = self->TissueFraction;
    this->OutlierFraction = self->OutlierFraction;
    this->Seed = static_cast<std::uint64_t>(self->Seed);
  }
};

//------------------------------------------------------------------------------
vtkLacunaIncompleteShape::vtkLacunaIncompleteShape()
{
  this->SetNumberOfInputPorts(0);
}

vtkLacunaIncompleteShape::~vtkLacunaIncompleteShape() = default;

//------------------------------------------------------------------------------
lacuna::IncompleteShape vtkLacunaIncompleteShape::MakeShape() const
{
  return lacuna::IncompleteShape(Options(this));
}

//------------------------------------------------------------------------------
double vtkLacunaIncompleteShape::EvaluateDistance(double x, double y, double z)
{
  try
  {
    return this->MakeShape().GetDistance(x, y, z);
  }
  catch (const std::invalid_argument&)
  {
    return std::numeric_limits<double>::quiet_NaN();
  }
}

//------------------------------------------------------------------------------
void vtkLacunaIncompleteShape::Announce(const lacuna::Ports& ports)
{
  const std::array<int, 3> n = this->MakeShape().GetDimensions();
  const int extent[6] = { 0, n[0] - 1, 0, n[1] - 1, 0, n[2] - 1 };
  const double origin[3] = { -0.5 * (n[0] - 1), -0.5 * (n[1] - 1), -0.5 * (n[2] - 1) };
  const double spacing[3] = { 1, 1, 1 };
  vtkInformation* info = ports.GetOutputInformation();
  info->Set(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), extent, 6);
  info->Set(vtkDataObject::ORIGIN(), origin, 3);
  info->Set(vtkDataObject::SPACING(), spacing, 3);
  vtkDataObject::SetPointDataActiveScalarInfo(info, VTK_UNSIGNED_CHAR, 1);
}

//------------------------------------------------------------------------------
void vtkLacunaIncompleteShape::Make(
  const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution)
{
  const lacuna::IncompleteShape shape = this->MakeShape();
  const std::array<int, 3> n = shape.GetDimensions();
  std::ostringstream what;
  what << "an image of " << n[0] << " x " << n[1] << " x " << n[2] << " voxels";
  lacuna::RequireMemory(what.str(), 2.0 * n[0] * n[1] * n[2]);
  const std::vector<unsigned char> voxels = shape.Sample(execution);

  auto* output = ports.GetOutput<vtkImageData>();
  output->SetOrigin(-0.5 * (n[0] - 1), -0.5 * (n[1] - 1), -0.5 * (n[2] - 1));
  output->SetSpacing(1, 1, 1);
  output->SetDimensions(n.data());
  vtkNew<vtkUnsignedCharArray> data;
  data->SetName("Data");
  lacuna::Arrays::SetNumberOfTuples(data, static_cast<vtkIdType>(voxels.size()));
  std::copy(voxels.begin(), voxels.end(), data->GetPointer(0));
  output->GetPointData()->SetScalars(data); // the whole, since what is missing is chosen from it
  const double unit = shape.IsFlat() ? 1 : 0.001;
  lacuna::FieldData::Set(output, "CompleteVolume", { unit * shape.GetContent() }, 1);
}

//------------------------------------------------------------------------------
void vtkLacunaIncompleteShape::Describe(lacuna::Properties& properties) const
{
  Options(this).Describe(properties);
}
