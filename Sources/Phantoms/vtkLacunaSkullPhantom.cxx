// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaSkullPhantom.h"

#include "lacunaArrays.h"
#include "lacunaCoordinates.h"
#include "lacunaMemory.h"
#include "lacunaSkull.h"
#include "lacunaVolumeDirection.h"
#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <limits>
#include <sstream>
#include <stdexcept>

vtkStandardNewMacro(vtkLacunaSkullPhantom);

namespace
{
constexpr double NoNumber = std::numeric_limits<double>::quiet_NaN();
}

// As the kernel takes them.
struct vtkLacunaSkullPhantom::Options : lacuna::Skull::Parameters
{
  explicit Options(const vtkLacunaSkullPhantom* self)
  {
    this->Center = { self->Center[0], self->Center[1], self->Center[2] };
    this->Spacing = { self->Spacing[0], self->Spacing[1], self->Spacing[2] };
    this->DefectRadius = self->DefectRadius;
    this->DefectDirection = { self->DefectDirection[0], self->DefectDirection[1],
      self->DefectDirection[2] };
    this->NoiseLevel = self->NoiseLevel;
    this->Seed = static_cast<std::uint64_t>(self->Seed);
    this->Sutures = self->Sutures;
  }
};

//------------------------------------------------------------------------------
vtkLacunaSkullPhantom::vtkLacunaSkullPhantom()
{
  this->SetNumberOfInputPorts(0);
}

//------------------------------------------------------------------------------
vtkLacunaSkullPhantom::~vtkLacunaSkullPhantom() = default;

//------------------------------------------------------------------------------
lacuna::Skull vtkLacunaSkullPhantom::MakeSkull() const
{
  return lacuna::Skull(Options(this));
}

//------------------------------------------------------------------------------
void vtkLacunaSkullPhantom::Announce(const lacuna::Ports& ports)
{
  const lacuna::Skull skull = this->MakeSkull();
  const std::array<int, 3> dimensions = skull.GetDimensions();
  const int extent[6] = { 0, dimensions[0] - 1, 0, dimensions[1] - 1, 0, dimensions[2] - 1 };
  vtkInformation* info = ports.GetOutputInformation();
  info->Set(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), extent, 6);
  info->Set(vtkDataObject::ORIGIN(), skull.GetOrigin().data(), 3);
  info->Set(vtkDataObject::SPACING(), this->Spacing, 3);
  vtkDataObject::SetPointDataActiveScalarInfo(info, VTK_SHORT, 1);
}

//------------------------------------------------------------------------------
void vtkLacunaSkullPhantom::Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution)
{
  const lacuna::Skull skull = this->MakeSkull();
  lacuna::Extent extent = ports.GetExtent();
  const std::array<int, 3> whole = skull.GetDimensions();
  std::ostringstream what;
  what << "a skull of " << whole[0] << " x " << whole[1] << " x " << whole[2] << " voxels (Spacing "
       << this->Spacing[0] << " " << this->Spacing[1] << " " << this->Spacing[2] << " mm)";
  lacuna::RequireMemory(what.str(), sizeof(short) * lacuna::CountPoints(extent));

  auto* output = ports.GetOutput<vtkImageData>();
  output->SetOrigin(skull.GetOrigin().data());
  output->SetSpacing(this->Spacing);
  output->SetExtent(extent.data());
  vtkDataArray* scalars = lacuna::Arrays::AddScalars(output, VTK_SHORT, "HounsfieldUnits");
  skull.Sample(execution, extent, static_cast<short*>(scalars->GetVoidPointer(0)));
  lacuna::Coordinates::Mark(output, lacuna::Coordinates::Patient);
  lacuna::VolumeDirection::Record(output);
}

//------------------------------------------------------------------------------
double vtkLacunaSkullPhantom::EvaluateTruth(double x, double y, double z)
{
  const lacuna::Vec3 point{ x, y, z };
  try
  {
    return lacuna::IsFinite(point) ? this->MakeSkull().IntactValue(point) : NoNumber;
  }
  catch (const std::invalid_argument&)
  {
    return NoNumber;
  }
}

//------------------------------------------------------------------------------
double vtkLacunaSkullPhantom::IntersectOuterSurface(
  const double origin[3], const double direction[3])
{
  try
  {
    return this->MakeSkull().IntersectOuterSurface(
      { origin[0], origin[1], origin[2] }, { direction[0], direction[1], direction[2] });
  }
  catch (const std::invalid_argument&)
  {
    return NoNumber;
  }
}

//------------------------------------------------------------------------------
bool vtkLacunaSkullPhantom::IsInDefect(double x, double y, double z)
{
  try
  {
    return this->MakeSkull().IsInDefect({ x, y, z });
  }
  catch (const std::invalid_argument&)
  {
    return false;
  }
}

//------------------------------------------------------------------------------
void vtkLacunaSkullPhantom::Describe(lacuna::Properties& properties) const
{
  Options(this).Describe(properties);
}
