// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaDepthMapShader.h"

#include "lacunaDepthNormals.h"
#include "lacunaDepthShader.h"

#include "lacunaArrays.h"
#include "lacunaCasterView.h"
#include "lacunaCutAway.h"
#include "lacunaDepthMap.h"
#include "lacunaFieldData.h"
#include "lacunaFunctionText.h"
#include "lacunaMapDepths.h"
#include "lacunaShadowCaster.h"
#include "lacunaVolumeCaster.h"
#include "vtkDataArray.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkImplicitFunction.h"
#include "vtkInformation.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <stdexcept>
#include <string>

namespace
{
using SDDP = vtkStreamingDemandDrivenPipeline;

constexpr std::array<const char*, 4> NormalMethodNames{ "Stored", "CentralDifference", "Gordon",
  "Predicate" };

/// The sphere around the box of a volume's voxel centres.
lacuna::Sphere CircumscribedSphere(vtkImageData* volume)
{
  const int* dimensions = volume->GetDimensions();
  const lacuna::Vec3 half{ 0.5 * (dimensions[0] - 1), 0.5 * (dimensions[1] - 1),
    0.5 * (dimensions[2] - 1) };
  const lacuna::Matrix4 toWorld = lacuna::CasterView::FrameOf(volume).IndexToWorld;
  lacuna::Sphere sphere;
  sphere.Centre = toWorld.Point(half);
  for (int corner = 0; corner < 4; ++corner)
  {
    sphere.Radius = std::max(sphere.Radius,
      lacuna::Norm(toWorld.Vector(
        { corner & 1 ? half[0] : -half[0], corner & 2 ? half[1] : -half[1], half[2] })));
  }
  return sphere;
}

constexpr double BiasPerVoxel = 0.1;

vtkDataArray* FindScalars(vtkImageData* volume, const std::string& name)
{
  vtkPointData* data = volume->GetPointData();
  vtkDataArray* scalars = name.empty() ? data->GetScalars() : data->GetArray(name.c_str());
  if (!scalars || scalars->GetNumberOfComponents() != 1 ||
    scalars->GetNumberOfTuples() != volume->GetNumberOfPoints())
  {
    throw std::runtime_error((name.empty() ? std::string("the volume has no active point scalars")
                                           : "the volume has no point array '" + name + "'") +
      " of one grey level per voxel, which shadows need");
  }
  return scalars;
}

/// The iso-value of the surface whose depths are in an array: number k of IsoValues for Depth_k, the
/// first for all others.
double IsoValueOf(vtkImageData* map, const std::string& depthArray)
{
  vtkDataArray* values = lacuna::FieldData::Find(map, lacuna::DepthMap::IsoValuesName, 1, -1);
  const std::string further = std::string(lacuna::DepthMap::DepthName) + "_";
  const long number =
    depthArray.rfind(further, 0) == 0 ? std::atol(depthArray.c_str() + further.size()) : 0;
  if (!values || number < 0 || number >= values->GetNumberOfTuples())
  {
    throw std::runtime_error(std::string("the depth map does not say in field data array '") +
      lacuna::DepthMap::IsoValuesName + "' at which grey level '" + depthArray +
      "' was found, which shadows need: disconnect the volume or turn CastShadows off");
  }
  return values->GetComponent(number, 0);
}
}

//------------------------------------------------------------------------------
class vtkLacunaDepthMapShader::Internals
{
public:
  vtkSmartPointer<vtkImplicitFunction> CutAway;

  /// What of a volume throws shadows on a map. Throws when the volume has no grey levels or the map does
  /// not say at which of them it was made. The result refers to this object, and holds while volume does.
  lacuna::ShadowCaster PrepareShadows(vtkLacunaDepthMapShader* self, vtkImageData* map,
    vtkImageData* volume, lacuna::AlgorithmExecution& execution)
  {
    vtkDataArray* scalars = FindScalars(volume, self->VolumeArray);
    const lacuna::IsoRayCaster& caster =
      this->ShadowVolume.Prepare(volume, scalars, self->Interpolation, self->SolidSide, execution);
    lacuna::ShadowCaster shadows;
    shadows.Caster = &caster;
    shadows.IsoValue = IsoValueOf(map, self->DepthArray);
    if (caster.GetMinimum() > caster.GetMaximum())
    {
      vtkWarningWithObjectMacro(
        self, "no voxel of the volume is a finite number: it throws no shadows");
    }
    else if (!(shadows.IsoValue >= caster.GetMinimum() && shadows.IsoValue <= caster.GetMaximum()))
    {
      const bool mayOvershoot =
        self->Interpolation == static_cast<int>(lacuna::FieldInterpolation::InterpolatingBSpline);
      vtkWarningWithObjectMacro(self,
        "the map's iso-value " << shadows.IsoValue
                               << " lies outside the volume's values, which range "
                               << "from " << caster.GetMinimum() << " to " << caster.GetMaximum()
                               << (mayOvershoot ? ": only the spline's overshoot throws shadows"
                                                : ": it throws no shadows"));
    }
    const lacuna::VoxelVolume& voxels = caster.GetVolume();
    const double edge = lacuna::SmallestEdgeOf(voxels.IndexToWorld);
    shadows.Bias = self->ShadowBias > 0 ? self->ShadowBias : BiasPerVoxel * edge;
    this->ShadowCutAway.reset();
    if (this->CutAway)
    {
      this->ShadowCutAway = lacuna::CutAway::MakeRegion(
        this->CutAway, 0.5 * edge, lacuna::CornersOf(voxels.IndexToWorld, voxels.Size));
    }
    shadows.CutAway = this->ShadowCutAway.get();
    shadows.CapCutAway = self->CapCutAway;
    shadows.CapBoundary = self->CapBoundary;
    return shadows;
  }

  static void CheckLights(vtkLacunaDepthMapShader* self)
  {
    for (std::size_t i = 0; i < self->Lights.size(); ++i)
    {
      const double kind = self->Lights[i][3];
      if (kind != 0 && kind != 1)
      {
        throw std::runtime_error("light " + std::to_string(i) + " has the fourth number " +
          std::to_string(kind) + "; it must be 0 for a direction or 1 for a position");
      }
    }
  }

  /// The map's normals of the pixels of output; null when it has none.
  static vtkSmartPointer<vtkFloatArray> StoredNormals(
    vtkLacunaDepthMapShader* self, vtkImageData* output)
  {
    const std::string name = lacuna::DepthMap::GetNormalsName(self->DepthArray);
    vtkDataArray* stored = output->GetPointData()->GetArray(name.c_str());
    if (!stored || stored->GetNumberOfComponents() != 3)
    {
      return nullptr;
    }
    auto normals = vtkSmartPointer<vtkFloatArray>::New();
    lacuna::Arrays::Copy(stored, normals);
    return normals;
  }

  /// The normals to shade with, and how they differ from the map's. May be null for DepthOnly.
  static vtkSmartPointer<vtkFloatArray> MakeNormals(vtkLacunaDepthMapShader* self,
    const lacuna::DepthGrid& grid, vtkImageData* output, lacuna::AlgorithmExecution& execution)
  {
    const int* e = output->GetExtent();
    const std::array<int, 4> extent = { e[0], e[1], e[2], e[3] };
    const std::string name = lacuna::DepthMap::GetNormalsName(self->DepthArray);
    vtkSmartPointer<vtkFloatArray> stored = StoredNormals(self, output);
    if (self->NormalMethod == Stored)
    {
      if (!stored)
      {
        if (self->Shading == DepthOnly)
        {
          return nullptr;
        }
        throw std::runtime_error("the depth map has no normals '" + name +
          "' of three components: choose another NormalMethod than Stored");
      }
      const std::int64_t missing =
        lacuna::MendNormals(grid, extent, stored->GetPointer(0), execution);
      if (missing > 0)
      {
        vtkWarningWithObjectMacro(self,
          "" << missing << " pixels have a depth and no normal in '" << name
             << "'; they are shaded as if they faced the viewer");
      }
      return stored;
    }
    auto normals = vtkSmartPointer<vtkFloatArray>::New();
    normals->SetName(name.c_str());
    normals->SetNumberOfComponents(3);
    lacuna::Arrays::SetNumberOfTuples(normals, output->GetNumberOfPoints());
    const lacuna::DepthNormalMethod methods[] = { lacuna::DepthNormalMethod::CentralDifference,
      lacuna::DepthNormalMethod::Gordon, lacuna::DepthNormalMethod::Predicate };
    lacuna::EstimateNormals(grid, methods[self->NormalMethod - CentralDifference],
      { self->MaximumAngle, self->MaximumAngleChange }, extent, normals->GetPointer(0), execution);
    if (stored)
    {
      vtkNew<vtkFloatArray> difference;
      difference->SetName(lacuna::DepthMap::NormalDifferenceName);
      lacuna::Arrays::SetNumberOfTuples(difference, output->GetNumberOfPoints());
      lacuna::AnglesBetween(stored->GetPointer(0), normals->GetPointer(0),
        output->GetNumberOfPoints(), difference->GetPointer(0), execution);
      output->GetPointData()->AddArray(difference);
    }
    return normals;
  }

private:
  lacuna::VolumeCaster ShadowVolume;
  std::unique_ptr<lacuna::CutRegion> ShadowCutAway;
};

vtkStandardNewMacro(vtkLacunaDepthMapShader);

//------------------------------------------------------------------------------
vtkLacunaDepthMapShader::vtkLacunaDepthMapShader()
  : Internal(std::make_unique<Internals>())
{
  this->Sharing = lacuna::Share::Parts;
  this->SetNumberOfInputPorts(2);
}

//------------------------------------------------------------------------------
vtkLacunaDepthMapShader::~vtkLacunaDepthMapShader() = default;

//------------------------------------------------------------------------------
void vtkLacunaDepthMapShader::AddLight(double x, double y, double z, double w, double intensity)
{
  this->Lights.push_back({ x, y, z, w, intensity });
  this->Modified();
}

//------------------------------------------------------------------------------
void vtkLacunaDepthMapShader::RemoveAllLights()
{
  if (!this->Lights.empty())
  {
    this->Lights.clear();
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkLacunaDepthMapShader::SetCutAway(vtkImplicitFunction* function)
{
  if (this->Internal->CutAway != function)
  {
    this->Internal->CutAway = function;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
vtkImplicitFunction* vtkLacunaDepthMapShader::GetCutAway() const
{
  return this->Internal->CutAway;
}

//------------------------------------------------------------------------------
vtkMTimeType vtkLacunaDepthMapShader::GetMTime()
{
  const vtkMTimeType time = this->Superclass::GetMTime();
  vtkImplicitFunction* function = this->GetCutAway();
  return function ? std::max(time, function->GetMTime()) : time;
}

//------------------------------------------------------------------------------
int vtkLacunaDepthMapShader::FillInputPortInformation(int port, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkImageData");
  if (port == 1)
  {
    info->Set(vtkAlgorithm::INPUT_IS_OPTIONAL(), 1);
  }
  return 1;
}

//------------------------------------------------------------------------------
void vtkLacunaDepthMapShader::Announce(const lacuna::Ports& ports)
{
  vtkDataObject::SetPointDataActiveScalarInfo(ports.GetOutputInformation(), VTK_UNSIGNED_CHAR, 3);
}

//------------------------------------------------------------------------------
/// The sphere around the data is that of the map's points where there is no volume.
bool vtkLacunaDepthMapShader::NeedsWholeMap()
{
  return this->GetNumberOfInputConnections(1) == 0 &&
    (this->Shading == DepthOnly || this->DepthCue > 0);
}

//------------------------------------------------------------------------------
void vtkLacunaDepthMapShader::Ask(const lacuna::Ports& ports)
{
  this->Algorithm::Ask(ports); // the volume as a whole
  vtkInformation* input = ports.GetInputInformation();
  std::array<int, 6> whole{ 0, -1, 0, -1, 0, -1 };
  input->Get(SDDP::WHOLE_EXTENT(), whole.data());
  std::array<int, 6> extent = this->NeedsWholeMap() ? whole : GetPart(ports.GetOutputInformation());
  if (extent[0] <= extent[1] && extent[2] <= extent[3])
  {
    // neighbours, for the normals; an extent may begin or end with the integers
    for (const int first : { 0, 2 })
    {
      extent[first] -= extent[first] > whole[first] ? 1 : 0;
      extent[first + 1] += extent[first + 1] < whole[first + 1] ? 1 : 0;
    }
  }
  this->AskFor(input, extent);
}

//------------------------------------------------------------------------------
void vtkLacunaDepthMapShader::Make(
  const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution)
{
  auto* input = ports.GetInput<vtkImageData>();
  auto* volume = ports.GetInput<vtkImageData>(1);
  auto* output = ports.GetOutput<vtkImageData>();
  Internals::CheckLights(this);
  lacuna::ShadingSettings settings = this->GetOptions();
  settings.Check();
  const lacuna::DepthMap contract(input);
  const lacuna::MapDepths depths(input, contract, this->DepthArray);
  const lacuna::DepthGrid& grid = depths.GetGrid();
  std::array<int, 6> extent = ports.GetExtent();
  if (extent[0] < grid.Extent[0] || extent[1] > grid.Extent[1] || extent[2] < grid.Extent[2] ||
    extent[3] > grid.Extent[3])
  {
    throw std::runtime_error("pixels outside of the depth map were asked for");
  }
  output->ShallowCopy(input);
  output->Crop(extent.data());

  execution.SetStage(0, 0.2);
  lacuna::ShadowCaster shadows;
  const bool hasVolume = volume && volume->GetNumberOfPoints() > 0;
  if (hasVolume && this->CastShadows && this->Shading == Phong && !this->Lights.empty())
  {
    shadows = this->Internal->PrepareShadows(this, input, volume, execution);
  }
  if (hasVolume)
  {
    settings.Data = CircumscribedSphere(volume);
  }
  else if (this->NeedsWholeMap())
  {
    settings.Data = lacuna::CircumscribedSphere(grid, execution);
  }

  execution.SetStage(0.2, 0.4);
  const auto normals = Internals::MakeNormals(this, grid, output, execution);
  if (normals)
  {
    output->GetPointData()->AddArray(normals);
    output->GetPointData()->SetActiveNormals(normals->GetName());
  }

  execution.SetStage(0.4, 1);
  vtkNew<vtkUnsignedCharArray> colors;
  colors->SetName(lacuna::DepthMap::ColorName);
  colors->SetNumberOfComponents(3);
  lacuna::Arrays::SetNumberOfTuples(colors, output->GetNumberOfPoints());
  lacuna::ShadeDepths(grid, normals ? normals->GetPointer(0) : nullptr, settings, shadows,
    { extent[0], extent[1], extent[2], extent[3] }, colors->GetPointer(0), execution);
  output->GetPointData()->AddArray(colors);
  output->GetPointData()->SetActiveScalars(lacuna::DepthMap::ColorName);
}

//------------------------------------------------------------------------------
lacuna::ShadingSettings vtkLacunaDepthMapShader::GetOptions() const
{
  lacuna::ShadingSettings settings;
  settings.Model = static_cast<lacuna::ShadingModel>(this->Shading);
  settings.Ambient = this->Ambient;
  settings.Diffuse = this->Diffuse;
  settings.Specular = this->Specular;
  settings.SpecularPower = this->SpecularPower;
  settings.DepthCue = this->DepthCue;
  settings.Law = static_cast<lacuna::DepthLaw>(this->DepthLaw);
  std::copy_n(this->SurfaceColor, 3, settings.SurfaceColor.data());
  std::copy_n(this->BackgroundColor, 3, settings.BackgroundColor.data());
  for (const auto& light : this->Lights)
  {
    settings.Lights.push_back({ { light[0], light[1], light[2] }, light[3] == 1, light[4] });
  }
  return settings;
}

//------------------------------------------------------------------------------
void vtkLacunaDepthMapShader::Describe(lacuna::Properties& properties) const
{
  properties.Add("DepthArray", this->DepthArray)
    .Add("NormalMethod", this->NormalMethod, NormalMethodNames);
  lacuna::DiscontinuityLimits{ this->MaximumAngle, this->MaximumAngleChange }.Describe(properties);
  this->GetOptions().Describe(properties);
  properties.Add("CastShadows", this->CastShadows)
    .Add("VolumeArray", this->VolumeArray)
    .Add("Interpolation", this->Interpolation, lacuna::FieldInterpolationNames)
    .Add("SolidSide", this->SolidSide, lacuna::SolidSideNames)
    .Add("ShadowBias", this->ShadowBias,
      lacuna::ValueRange::Above(0, "mm").OrZero("a tenth of a voxel"))
    .Add("CutAway", lacuna::FunctionText::Describe(this->GetCutAway()))
    .Add("CapCutAway", this->CapCutAway)
    .Add("CapBoundary", this->CapBoundary);
}
