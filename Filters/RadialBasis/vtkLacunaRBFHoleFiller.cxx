// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaRBFHoleFiller.h"

#include "lacunaHoleFill.h"
#include "lacunaParameterText.h"
#include "vtkCharArray.h"
#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkImplicitFunction.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkLacunaDepthMap.h"
#include "vtkLacunaExecution.h"
#include "vtkLacunaFieldData.h"
#include "vtkLacunaProvenance.h"
#include "vtkLacunaRequest.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <vector>

vtkStandardNewMacro(vtkLacunaRBFHoleFiller);

namespace
{
using lacuna::MapMask;

lacuna::MapGrid GetGrid(vtkImageData* map, const vtkLacunaDepthMap& contract)
{
  const int* extent = map->GetExtent();
  lacuna::MapGrid grid;
  grid.Width = extent[1] - extent[0] + 1;
  grid.Height = extent[3] - extent[2] + 1;
  grid.FirstColumn = extent[0];
  grid.FirstRow = extent[2];
  grid.Spacing = contract.GetPixelSpacing();
  return grid;
}

// Where a point array is not 0.
MapMask GetMarked(vtkImageData* map, const std::string& name, const char* property)
{
  vtkPointData* points = map->GetPointData();
  vtkDataArray* array = points->GetArray(name.c_str());
  if (!array || array->GetNumberOfComponents() != 1)
  {
    std::ostringstream message;
    message << property << ": the map has no point array '" << name
            << "' with one component; it has";
    for (int i = 0; i < points->GetNumberOfArrays(); ++i)
    {
      message << (i ? ", '" : " '") << points->GetArrayName(i) << "'";
    }
    throw std::runtime_error(message.str());
  }
  MapMask mask(static_cast<std::size_t>(array->GetNumberOfTuples()));
  for (std::size_t i = 0; i < mask.size(); ++i)
  {
    mask[i] = array->GetComponent(static_cast<vtkIdType>(i), 0) != 0;
  }
  return mask;
}

void Merge(MapMask& mask, const MapMask& other)
{
  std::transform(mask.begin(), mask.end(), other.begin(), mask.begin(),
    [](unsigned char a, unsigned char b) { return a || b; });
}

// Depth and Valid of the input. Returns how many pixels are flagged valid without a finite depth.
vtkIdType ReadDepth(
  vtkImageData* map, const vtkLacunaDepthMap& contract, lacuna::HoleFillInput& input)
{
  const auto n = static_cast<vtkIdType>(input.Grid.GetSize());
  input.Depth.resize(input.Grid.GetSize());
  for (vtkIdType i = 0; i < n; ++i)
  {
    input.Depth[i] = contract.GetDepth()->GetComponent(i, 0);
  }
  input.Valid = map->GetPointData()->GetArray(vtkLacunaDepthMap::MaskName)
    ? GetMarked(map, vtkLacunaDepthMap::MaskName, "depth map")
    : MapMask(input.Grid.GetSize(), 1);
  const bool flagged = map->GetPointData()->GetArray(vtkLacunaDepthMap::MaskName);
  vtkIdType wrong = 0;
  for (vtkIdType i = 0; i < n; ++i)
  {
    if (input.Valid[i] && !std::isfinite(input.Depth[i]))
    {
      input.Valid[i] = 0;
      wrong += flagged;
    }
  }
  if (std::find(input.Valid.begin(), input.Valid.end(), 1) == input.Valid.end())
  {
    throw std::runtime_error("no pixel of the depth map has a depth; check the iso-value and the "
                             "view direction of the ray caster");
  }
  return wrong;
}

// Pixels whose surface point is in region, or is hidden by it from the viewer.
class RegionMarker
{
public:
  RegionMarker(const vtkLacunaDepthMap& contract, const lacuna::HoleFillInput& input,
    vtkImplicitFunction* region)
    : Contract(contract)
    , Input(input)
    , Region(region)
    , Marked(input.Grid.GetSize(), 0)
  {
  }

  MapMask Run(lacuna::Execution& execution)
  {
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for (std::size_t i = 0; i < this->Marked.size(); ++i)
    {
      if (this->Input.Valid[i])
      {
        low = std::min(low, this->Input.Depth[i]);
        high = std::max(high, this->Input.Depth[i]);
      }
    }
    this->Try([&](std::size_t i) { return this->Input.Valid[i] != 0; },
      [&](std::size_t i) { return this->Input.Depth[i]; });
    constexpr int samples = vtkLacunaRBFHoleFiller::RegionSamples;
    for (int k = 0; k < samples; ++k)
    {
      const double depth = low + (high - low) * k / (samples - 1);
      this->Try([&](std::size_t i)
        { return !this->Input.Valid[i] || depth < this->Input.Depth[i]; },
        [&](std::size_t) { return depth; });
      execution.Report(static_cast<double>(k + 1) / samples);
    }
    return this->Marked;
  }

private:
  // Marks the pixels chosen whose points at the given depths are in the region.
  template <class Chosen, class Depth>
  void Try(const Chosen& chosen, const Depth& depth)
  {
    this->Pixels.clear();
    for (std::size_t i = 0; i < this->Marked.size(); ++i)
    {
      if (!this->Marked[i] && chosen(i))
      {
        this->Pixels.push_back(i);
      }
    }
    const auto count = static_cast<vtkIdType>(this->Pixels.size());
    const lacuna::MapGrid& grid = this->Input.Grid;
    this->Points->SetNumberOfComponents(3);
    this->Points->SetNumberOfTuples(count);
    this->Values->SetNumberOfTuples(count);
    for (vtkIdType k = 0; k < count; ++k)
    {
      const std::size_t i = this->Pixels[k];
      const lacuna::Vec3 point = this->Contract.GetPoint(
        static_cast<double>(grid.GetColumn(i)), static_cast<double>(grid.GetRow(i)), depth(i));
      this->Points->SetTypedTuple(k, point.data());
    }
    this->Region->FunctionValue(this->Points, this->Values);
    for (vtkIdType k = 0; k < count; ++k)
    {
      this->Marked[this->Pixels[k]] = this->Values->GetValue(k) <= 0;
    }
  }

  const vtkLacunaDepthMap& Contract;
  const lacuna::HoleFillInput& Input;
  vtkImplicitFunction* Region;
  MapMask Marked;
  std::vector<std::size_t> Pixels;
  vtkNew<vtkDoubleArray> Points;
  vtkNew<vtkDoubleArray> Values;
};

// The defect when none is marked.
MapMask FindDefect(lacuna::Execution& execution, const lacuna::HoleFillInput& input)
{
  if (input.Painted.empty())
  {
    return lacuna::FindHoles(execution, input.Grid, input.Depth, lacuna::MaximumSupportSlope,
      lacuna::HoleRim, input.Valid);
  }
  MapMask sound = input.Valid;
  for (std::size_t i = 0; i < sound.size(); ++i)
  {
    sound[i] = sound[i] && input.Painted[i];
  }
  return lacuna::FindInteriorHoles(input.Grid, sound);
}

void AddArray(vtkImageData* map, const char* name, const std::vector<double>& values)
{
  vtkNew<vtkDoubleArray> array;
  array->SetName(name);
  array->SetNumberOfTuples(static_cast<vtkIdType>(values.size()));
  std::copy(values.begin(), values.end(), array->GetPointer(0));
  map->GetPointData()->AddArray(array);
}

void AddMask(vtkImageData* map, const char* name, const MapMask& mask)
{
  vtkNew<vtkCharArray> array;
  array->SetName(name);
  array->SetNumberOfTuples(static_cast<vtkIdType>(mask.size()));
  std::copy(mask.begin(), mask.end(), array->GetPointer(0));
  map->GetPointData()->AddArray(array);
}

// The measured normals, with those of the fit in the defect.
void AddNormals(
  vtkImageData* map, const vtkLacunaDepthMap& contract, const lacuna::HoleFillResult& result)
{
  vtkDataArray* measured = map->GetPointData()->GetArray(vtkLacunaDepthMap::NormalsName);
  if (!measured)
  {
    return;
  }
  if (measured->GetNumberOfComponents() != 3)
  {
    throw std::runtime_error(std::string("point array '") + vtkLacunaDepthMap::NormalsName +
      "' of the depth map must have three components");
  }
  vtkNew<vtkFloatArray> normals;
  normals->DeepCopy(measured);
  const lacuna::Matrix4& toWorld = contract.GetImageToWorld();
  const lacuna::Vec3 right = lacuna::Normalized(toWorld.Column(0));
  const lacuna::Vec3 down = lacuna::Normalized(toWorld.Column(1));
  const lacuna::Vec3 view = lacuna::Normalized(toWorld.Column(2));
  for (std::size_t k = 0; k < result.Filled.size(); ++k)
  {
    const auto& g = result.Gradients[k];
    const lacuna::Vec3 n = lacuna::Normalized(g[0] * right + g[1] * down - view);
    normals->SetTuple(static_cast<vtkIdType>(result.Filled[k]), n.data());
  }
  map->GetPointData()->AddArray(normals);
}

void AddFieldData(vtkImageData* map, int kernel, const lacuna::HoleFillResult& result)
{
  const auto& c = result.Plane;
  const lacuna::Vec3 normal = lacuna::Normalized({ c[1], c[2], -1 });
  const auto& fit = result.Fit;
  vtkLacunaFieldData::Set(map, "RBFPlane", { c[0], c[1], c[2] }, 3);
  vtkLacunaFieldData::Set(map, "PlaneNormal", { normal[0], normal[1], normal[2] }, 3);
  vtkLacunaFieldData::Set(map, "NodeCount", { static_cast<double>(fit.NodeCount) }, 1);
  vtkLacunaFieldData::Set(map, "Residual", { fit.Residual }, 1);
  vtkLacunaFieldData::Set(map, "ConditionEstimate", { fit.ConditionEstimate }, 1);
  if (kernel == vtkLacunaRBFHoleFiller::ThinPlate)
  {
    vtkLacunaFieldData::Set(map, "BendingEnergy", { fit.Energy }, 1);
  }
  vtkLacunaFieldData::Set(map, "DefectArea", { result.DefectArea }, 1);
}

void AddPointData(vtkImageData* map, const vtkLacunaDepthMap& contract,
  const lacuna::HoleFillInput& input, const lacuna::HoleFillResult& result)
{
  std::vector<double> depth = input.Depth;
  MapMask valid = input.Valid;
  MapMask filled(valid.size(), 0);
  for (std::size_t i = 0; i < depth.size(); ++i)
  {
    if (!valid[i])
    {
      depth[i] = std::numeric_limits<double>::quiet_NaN();
    }
  }
  for (const std::size_t i : result.Filled)
  {
    depth[i] = result.Fitted[i];
    valid[i] = 1;
    filled[i] = 1;
  }
  AddArray(map, vtkLacunaDepthMap::DepthName, depth);
  AddMask(map, vtkLacunaDepthMap::MaskName, valid);
  AddNormals(map, contract, result);
  AddArray(map, vtkLacunaDepthMap::FittedName, result.Fitted);
  AddMask(map, vtkLacunaDepthMap::FilledMaskName, filled);
  AddArray(map, vtkLacunaDepthMap::DeviationName, result.Deviation);
  map->GetPointData()->SetActiveScalars(vtkLacunaDepthMap::DepthName);
}
}

//------------------------------------------------------------------------------
vtkLacunaRBFHoleFiller::vtkLacunaRBFHoleFiller() = default;
vtkLacunaRBFHoleFiller::~vtkLacunaRBFHoleFiller() = default;

//------------------------------------------------------------------------------
void vtkLacunaRBFHoleFiller::SetDefectRegion(vtkImplicitFunction* region)
{
  if (this->DefectRegion != region)
  {
    this->DefectRegion = region;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
vtkImplicitFunction* vtkLacunaRBFHoleFiller::GetDefectRegion()
{
  return this->DefectRegion;
}

//------------------------------------------------------------------------------
void vtkLacunaRBFHoleFiller::SetDefectArray(const char* name)
{
  this->SetArrayName(this->DefectArray, name);
}

//------------------------------------------------------------------------------
void vtkLacunaRBFHoleFiller::SetSupportArray(const char* name)
{
  this->SetArrayName(this->SupportArray, name);
}

//------------------------------------------------------------------------------
void vtkLacunaRBFHoleFiller::SetArrayName(std::string& member, const char* name)
{
  const std::string value = !name || !std::strcmp(name, "None") ? "" : name;
  if (member != value)
  {
    member = value;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
vtkMTimeType vtkLacunaRBFHoleFiller::GetMTime()
{
  const vtkMTimeType own = this->Superclass::GetMTime();
  return this->DefectRegion ? std::max(own, this->DefectRegion->GetMTime()) : own;
}

//------------------------------------------------------------------------------
int vtkLacunaRBFHoleFiller::RequestUpdateExtent(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector*)
{
  // The fit depends on the whole surroundings of the defect, whatever piece is asked for.
  vtkLacunaRequest::Whole(inputVector[0]->GetInformationObject(0));
  return 1;
}

//------------------------------------------------------------------------------
int vtkLacunaRBFHoleFiller::RequestData(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  vtkImageData* map = vtkImageData::GetData(inputVector[0]);
  vtkImageData* output = vtkImageData::GetData(outputVector);
  if (!map || map->GetNumberOfPoints() == 0)
  {
    return 1; // empty in, empty out
  }
  const auto body = [&](vtkLacunaExecution& execution)
  {
    const vtkLacunaDepthMap contract(map);
    int whole[6];
    inputVector[0]->GetInformationObject(0)->Get(
      vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), whole);
    if (!std::equal(whole, whole + 6, map->GetExtent()))
    {
      throw std::runtime_error("only a part of the depth map has arrived, and the fit needs the "
                               "whole; the filter before this one has divided it");
    }
    if (contract.IsPerspective())
    {
      throw std::runtime_error("this is a perspective depth map; holes are filled in parallel maps "
                               "only, such as those of B-Spline Iso Ray Caster");
    }
    if (this->Kernel != ThinPlate && this->Kernel != Linear && this->Kernel != Cubic)
    {
      throw std::runtime_error("Kernel is " + std::to_string(this->Kernel) +
        "; it must be 0 (ThinPlate), 1 (Linear) or 3 (Cubic)");
    }
    lacuna::HoleFillInput input;
    input.Grid = GetGrid(map, contract);
    const vtkIdType wrong = ReadDepth(map, contract, input);
    if (wrong > 0)
    {
      vtkWarningMacro(<< wrong << " pixels of the depth map are flagged valid but have no finite "
                      << "depth; they are taken as pixels without depth");
    }

    execution.SetStage(0, 0.1);
    input.Defect.assign(input.Grid.GetSize(), 0);
    if (!this->SupportArray.empty())
    {
      input.Painted = GetMarked(map, this->SupportArray, "SupportArray");
    }
    if (this->DefectRegion)
    {
      Merge(input.Defect, RegionMarker(contract, input, this->DefectRegion).Run(execution));
    }
    if (!this->DefectArray.empty())
    {
      Merge(input.Defect, GetMarked(map, this->DefectArray, "DefectArray"));
    }
    if (!this->DefectRegion && this->DefectArray.empty())
    {
      input.Defect = FindDefect(execution, input);
    }

    lacuna::HoleFillOptions options;
    options.Kernel = static_cast<lacuna::RadialKernel>(this->Kernel);
    options.SupportMargin = this->SupportMargin;
    options.NodeSpacing = this->NodeSpacing;
    options.Smoothing = this->Smoothing;
    options.CutoffWavelength = this->CutoffWavelength;
    options.OutputMargin = this->OutputMargin;

    lacuna::HoleFillResult result;
    vtkNew<vtkImageData> filled;
    filled->ShallowCopy(map);
    if (std::find(input.Defect.begin(), input.Defect.end(), 1) == input.Defect.end())
    {
      vtkWarningMacro(
        "the defect is empty, so the map is passed on as it is: no pixel is marked by DefectRegion "
        "or DefectArray, or (without them) the main surface of the map encloses no hole");
      result.Fitted.assign(input.Grid.GetSize(), std::numeric_limits<double>::quiet_NaN());
      result.Deviation = result.Fitted;
    }
    else
    {
      result = lacuna::FillHole(execution, input, options);
      AddFieldData(filled, this->Kernel, result);
    }
    for (const std::string& warning : result.Warnings)
    {
      vtkWarningMacro(<< warning);
    }
    AddPointData(filled, contract, input, result);

    lacuna::ParameterText parameters;
    parameters.Add("Kernel", this->Kernel)
      .Add("DefectRegion", this->DefectRegion ? this->DefectRegion->GetClassName() : "None")
      .Add("DefectArray", this->DefectArray)
      .Add("SupportArray", this->SupportArray)
      .Add("SupportMargin", this->SupportMargin)
      .Add("NodeSpacing", this->NodeSpacing)
      .Add("Smoothing", this->Smoothing)
      .Add("CutoffWavelength", this->CutoffWavelength)
      .Add("OutputMargin", this->OutputMargin);
    vtkLacunaProvenance::Record(filled, this, { map }, parameters.Get());
    output->ShallowCopy(filled);
    int piece[6];
    outputVector->GetInformationObject(0)->Get(
      vtkStreamingDemandDrivenPipeline::UPDATE_EXTENT(), piece);
    output->Crop(piece);
  };
  return vtkLacunaExecution::Run(this, outputVector, body);
}

//------------------------------------------------------------------------------
void vtkLacunaRBFHoleFiller::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Kernel: " << this->Kernel << "\n";
  os << indent << "DefectRegion: " << this->DefectRegion.Get() << "\n";
  os << indent << "DefectArray: " << this->DefectArray << "\n";
  os << indent << "SupportArray: " << this->SupportArray << "\n";
  os << indent << "SupportMargin: " << this->SupportMargin << "\n";
  os << indent << "NodeSpacing: " << this->NodeSpacing << "\n";
  os << indent << "Smoothing: " << this->Smoothing << "\n";
  os << indent << "CutoffWavelength: " << this->CutoffWavelength << "\n";
  os << indent << "OutputMargin: " << this->OutputMargin << "\n";
}
