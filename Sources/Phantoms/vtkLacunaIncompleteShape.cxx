// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaIncompleteShape.h"

#include "lacunaArrays.h"
#include "lacunaFieldData.h"
#include "lacunaIncompleteShape.h"
#include "lacunaMemory.h"
#include "lacunaParameterText.h"
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

//------------------------------------------------------------------------------
vtkLacunaIncompleteShape::vtkLacunaIncompleteShape()
{
  this->SetNumberOfInputPorts(0);
}

vtkLacunaIncompleteShape::~vtkLacunaIncompleteShape() = default;

//------------------------------------------------------------------------------
lacuna::IncompleteShape vtkLacunaIncompleteShape::MakeShape()
{
  lacuna::IncompleteShape::Parameters p;
  p.Shape = static_cast<lacuna::IncompleteShape::Kind>(this->Shape);
  std::copy_n(this->Dimensions, 3, p.Dimensions.begin());
  p.PresentFraction = this->PresentFraction;
  p.Patches = this->Patches;
  p.PatchRadii = { this->PatchRadii[0], this->PatchRadii[1] };
  p.GapAngle = this->GapAngle;
  p.TissueFraction = this->TissueFraction;
  p.OutlierFraction = this->OutlierFraction;
  p.Seed = static_cast<std::uint64_t>(this->Seed);
  return lacuna::IncompleteShape(p);
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
std::string vtkLacunaIncompleteShape::Parameters(int) const
{
  return lacuna::ParameterText()
    .Add("Shape", this->Shape)
    .Add("Dimensions", this->Dimensions)
    .Add("PresentFraction", this->PresentFraction)
    .Add("Patches", this->Patches)
    .Add("PatchRadii", this->PatchRadii)
    .Add("GapAngle", this->GapAngle)
    .Add("TissueFraction", this->TissueFraction)
    .Add("OutlierFraction", this->OutlierFraction)
    .Add("Seed", this->Seed)
    .Get();
}

//------------------------------------------------------------------------------
void vtkLacunaIncompleteShape::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Shape: " << this->Shape << "\n";
  os << indent << "Dimensions: " << this->Dimensions[0] << " " << this->Dimensions[1] << " "
     << this->Dimensions[2] << "\n";
  os << indent << "PresentFraction: " << this->PresentFraction << "\n";
  os << indent << "Patches: " << this->Patches << "\n";
  os << indent << "PatchRadii: " << this->PatchRadii[0] << " " << this->PatchRadii[1] << "\n";
  os << indent << "GapAngle: " << this->GapAngle << "\n";
  os << indent << "TissueFraction: " << this->TissueFraction << "\n";
  os << indent << "OutlierFraction: " << this->OutlierFraction << "\n";
  os << indent << "Seed: " << this->Seed << "\n";
}
