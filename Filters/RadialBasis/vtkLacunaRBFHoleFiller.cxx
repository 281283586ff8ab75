// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaRBFHoleFiller.h"

#include "lacunaDefectMarks.h"
#include "lacunaDepthMap.h"
#include "lacunaFilledMap.h"
#include "lacunaFunctionText.h"
#include "lacunaHoleFill.h"
#include "lacunaParameterText.h"
#include "vtkDataArray.h"
#include "vtkDataSet.h"
#include "vtkImageData.h"
#include "vtkImplicitFunction.h"
#include "vtkInformation.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkSelection.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <vector>

vtkStandardNewMacro(vtkLacunaRBFHoleFiller);

using SDDP = vtkStreamingDemandDrivenPipeline;

namespace
{
using lacuna::MapMask;

lacuna::MapGrid GetGrid(const int* extent, const double* spacing)
{
  lacuna::MapGrid grid;
  grid.Width = extent[1] - extent[0] + 1;
  grid.Height = extent[3] - extent[2] + 1;
  grid.FirstColumn = extent[0];
  grid.FirstRow = extent[2];
  grid.Spacing = { spacing[0], spacing[1] };
  return grid;
}

// Depth and Valid of the input. Returns how many pixels are flagged valid without a finite depth.
vtkIdType ReadDepth(
  vtkImageData* map, const lacuna::DepthMap& contract, lacuna::MarkedMap& input, const char* what)
{
  const auto n = static_cast<vtkIdType>(input.Grid.GetSize());
  input.Depth.resize(input.Grid.GetSize());
  for (vtkIdType i = 0; i < n; ++i)
  {
    input.Depth[i] = contract.GetDepth()->GetComponent(i, 0);
  }
  input.Valid = map->GetPointData()->GetArray(lacuna::DepthMap::MaskName)
    ? lacuna::DefectMarks::FromArray(map, lacuna::DepthMap::MaskName, what)
    : MapMask(input.Grid.GetSize(), 1);
  const bool flagged = map->GetPointData()->GetArray(lacuna::DepthMap::MaskName);
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
    throw std::runtime_error(std::string("no pixel of ") + what +
      " has a depth; check the iso-value and the view direction of the ray caster");
  }
  return wrong;
}

// The defect when none is marked.
MapMask FindDefect(lacuna::Execution& execution, const lacuna::MarkedMap& input)
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

// World to the map's x, y and depth, mm.
lacuna::Matrix4 GetWorldToMap(const lacuna::DepthMap& contract, const lacuna::MapGrid& grid)
{
  const lacuna::Matrix4& m = contract.GetImageToWorld();
  return lacuna::Matrix4::FromColumns((1 / grid.Spacing[0]) * m.Column(0),
    (1 / grid.Spacing[1]) * m.Column(1), m.Column(2), m.Column(3))
    .Inverse();
}

std::vector<lacuna::Vec3> GetControlPoints(
  vtkDataSet* points, const std::string& depthArray, const lacuna::Matrix4& toMap)
{
  std::vector<lacuna::Vec3> control;
  vtkDataArray* depths = nullptr;
  if (points && !depthArray.empty())
  {
    depths = points->GetPointData()->GetArray(depthArray.c_str());
    if (!depths || depths->GetNumberOfComponents() != 1)
    {
      throw std::runtime_error("ControlDepthArray: the control points have no point array '" +
        depthArray + "' with one component");
    }
  }
  for (vtkIdType i = 0; points && i < points->GetNumberOfPoints(); ++i)
  {
    lacuna::Vec3 p;
    points->GetPoint(i, p.data());
    p = toMap.Point(p);
    p[2] = depths ? depths->GetComponent(i, 0) : p[2];
    control.push_back(p);
  }
  return control;
}

// The surface of another depth map, parallel or perspective, in the axes of this one.
lacuna::SurfaceSheet GetSheet(vtkImageData* prior, const lacuna::Matrix4& toMap)
{
  lacuna::SurfaceSheet sheet;
  if (!prior || prior->GetNumberOfPoints() == 0)
  {
    return sheet;
  }
  const lacuna::DepthMap contract(prior);
  lacuna::MarkedMap read;
  read.Grid = GetGrid(prior->GetExtent(), prior->GetSpacing());
  ReadDepth(prior, contract, read, "the prior surface");
  sheet.Width = read.Grid.Width;
  sheet.Height = read.Grid.Height;
  for (std::size_t i = 0; i < read.Depth.size(); ++i)
  {
    const double nothing = std::numeric_limits<double>::quiet_NaN();
    sheet.Points.push_back(read.Valid[i]
        ? toMap.Point(contract.GetPoint(static_cast<double>(read.Grid.GetColumn(i)),
            static_cast<double>(read.Grid.GetRow(i)), read.Depth[i]))
        : lacuna::Vec3{ nothing, nothing, nothing });
  }
  return sheet;
}
}

//------------------------------------------------------------------------------
vtkLacunaRBFHoleFiller::vtkLacunaRBFHoleFiller()
  : Filler(std::make_unique<lacuna::HoleFiller>())
{
  this->SetNumberOfInputPorts(5);
}

vtkLacunaRBFHoleFiller::~vtkLacunaRBFHoleFiller() = default;

//------------------------------------------------------------------------------
int vtkLacunaRBFHoleFiller::FillInputPortInformation(int port, vtkInformation* info)
{
  static const char* const types[] = { "vtkImageData", "vtkDataSet", "vtkSelection", "vtkDataSet",
    "vtkImageData" };
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), types[port]);
  info->Set(vtkAlgorithm::INPUT_IS_OPTIONAL(), port > 0 ? 1 : 0);
  return 1;
}

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
void vtkLacunaRBFHoleFiller::SetControlDepthArray(const char* name)
{
  this->SetArrayName(this->ControlDepthArray, name);
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
void vtkLacunaRBFHoleFiller::Announce(const lacuna::Ports& ports)
{
  vtkInformation* in = ports.GetInputInformation();
  vtkInformation* out = ports.GetOutputInformation();
  int whole[6];
  double spacing[3] = { 1, 1, 1 };
  in->Get(SDDP::WHOLE_EXTENT(), whole);
  if (in->Has(vtkDataObject::SPACING()))
  {
    in->Get(vtkDataObject::SPACING(), spacing);
  }
  if (whole[1] >= whole[0] && whole[3] >= whole[2])
  {
    this->CheckProperties();
    const lacuna::MapGrid grid = lacuna::GetOutputGrid(GetGrid(whole, spacing), this->GetOptions());
    whole[0] = grid.FirstColumn;
    whole[1] = grid.FirstColumn + grid.Width - 1;
    whole[2] = grid.FirstRow;
    whole[3] = grid.FirstRow + grid.Height - 1;
    std::copy(grid.Spacing.begin(), grid.Spacing.end(), spacing);
  }
  out->Set(SDDP::WHOLE_EXTENT(), whole, 6);
  out->Set(vtkDataObject::SPACING(), spacing, 3);
  vtkDataObject::SetPointDataActiveScalarInfo(out, VTK_DOUBLE, 1);
}

//------------------------------------------------------------------------------
lacuna::HoleFillOptions vtkLacunaRBFHoleFiller::GetOptions() const
{
  lacuna::HoleFillOptions options;
  options.Kernel = static_cast<lacuna::RadialKernel>(this->Kernel);
  options.KernelLength = this->KernelLength;
  options.Trend = static_cast<lacuna::HoleTrend>(this->Trend);
  options.SupportMargin = this->SupportMargin;
  options.SupportStepMargin = this->SupportStepMargin;
  options.NodeSpacing = this->NodeSpacing;
  options.Smoothing = this->Smoothing;
  options.CutoffWavelength = this->CutoffWavelength;
  options.OutputMargin = this->OutputMargin;
  options.OutputSpacing = { this->OutputSpacing[0], this->OutputSpacing[1] };
  options.Accuracy = this->Accuracy;
  options.Solver = static_cast<lacuna::RadialSolver>(this->Solver);
  return options;
}

//------------------------------------------------------------------------------
void vtkLacunaRBFHoleFiller::MarkDefect(lacuna::AlgorithmExecution& execution, vtkImageData* map,
  const lacuna::Ports& ports, lacuna::MarkedMap& marked, lacuna::ParameterText& where)
{
  auto* surface = ports.GetInput<vtkDataSet>(SurfacePort);
  auto* selection = ports.GetInput<vtkSelection>(SelectionPort);
  marked.Defect.assign(marked.Grid.GetSize(), 0);
  if (!this->SupportArray.empty())
  {
    marked.Painted = lacuna::DefectMarks::FromArray(map, this->SupportArray, "SupportArray");
  }
  if (this->DefectRegion)
  {
    lacuna::DefectMarks::Merge(marked.Defect,
      lacuna::DefectMarks::FromRegion(
        execution, lacuna::DepthMap(map), marked, this->DefectRegion));
  }
  if (!this->DefectArray.empty())
  {
    lacuna::DefectMarks::Merge(
      marked.Defect, lacuna::DefectMarks::FromArray(map, this->DefectArray, "DefectArray"));
  }
  if (surface || selection)
  {
    const MapMask selected =
      lacuna::DefectMarks::FromSelection(map, marked.Grid, surface, selection);
    where.Add("SelectedPixels", lacuna::DefectMarks::DescribeRuns(selected));
    if (!surface && lacuna::DefectMarks::MayBeOfSurface(marked.Grid, marked.Valid, selected))
    {
      vtkWarningMacro("Selection is read as points of the depth map; if it was made on a Depth Map "
                      "Surface, whose points have other numbers, set Surface to that");
    }
    lacuna::DefectMarks::Merge(marked.Defect, selected);
  }
  else if (!this->DefectRegion && this->DefectArray.empty())
  {
    marked.Defect = FindDefect(execution, marked);
  }
  where.Add("DefectPixels", std::count(marked.Defect.begin(), marked.Defect.end(), 1))
    .Add("DefectExtent", lacuna::DefectMarks::GetExtent(marked.Grid, marked.Defect));
}

//------------------------------------------------------------------------------
// The fit depends on the whole surroundings of the defect, whatever part is asked for.
void vtkLacunaRBFHoleFiller::Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution)
{
  auto* map = ports.GetInput<vtkImageData>();
  const lacuna::DepthMap contract(map);
  int whole[6];
  ports.GetInputInformation()->Get(SDDP::WHOLE_EXTENT(), whole);
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
  const lacuna::HoleFillOptions options = this->GetOptions();
  lacuna::HoleFillInput input;
  input.Grid = GetGrid(map->GetExtent(), map->GetSpacing());
  const vtkIdType wrong = ReadDepth(map, contract, input, "the depth map");
  if (wrong > 0)
  {
    vtkWarningMacro(<< wrong << " pixels of the depth map are flagged valid but have no finite "
                    << "depth; they are taken as pixels without depth");
  }
  execution.SetStage(0, 0.1);
  lacuna::ParameterText parameters;
  this->MarkDefect(execution, map, ports, input, parameters);
  auto* control = ports.GetInput<vtkDataSet>(ControlPointsPort);
  auto* prior = ports.GetInput<vtkImageData>(PriorSurfacePort);
  const lacuna::Matrix4 toMap = GetWorldToMap(contract, input.Grid);
  input.ControlPoints = GetControlPoints(control, this->ControlDepthArray, toMap);
  input.Prior = GetSheet(prior, toMap);

  const auto marked = std::count(input.Defect.begin(), input.Defect.end(), 1);
  if (marked == 0)
  {
    const std::string miss = this->DefectRegion
      ? lacuna::DefectMarks::DescribeMiss(contract, input, this->DefectRegion)
      : std::string();
    vtkWarningMacro(<< "the defect is empty, so the map is passed on as it is: "
                    << (miss.empty()
                           ? "no pixel is marked by DefectRegion, DefectArray or the selection, "
                             "or (without them) the main surface of the map encloses no hole"
                           : miss));
  }
  const lacuna::HoleFillResult result = this->Filler->Fill(execution, input, options);
  for (const std::string& warning : result.Warnings)
  {
    vtkWarningMacro(<< warning);
  }
  vtkNew<vtkImageData> filled;
  lacuna::FilledMap::Make(map, contract, result, options.Kernel, marked > 0, filled);

  std::vector<double> coordinates;
  for (const lacuna::Vec3& p : input.ControlPoints)
  {
    coordinates.insert(coordinates.end(), { p[0], p[1], p[2] });
  }
  if (!coordinates.empty())
  {
    parameters.Add("ControlPointsInMap", coordinates);
  }
  this->Made = parameters.Get();
  ports.GetOutput<vtkImageData>()->ShallowCopy(filled);
}

//------------------------------------------------------------------------------
std::vector<vtkDataObject*> vtkLacunaRBFHoleFiller::GetOrigins(const lacuna::Ports& ports) const
{
  std::vector<vtkDataObject*> origins{ ports.GetInput<vtkDataObject>() };
  if (auto* prior = ports.GetInput<vtkImageData>(PriorSurfacePort))
  {
    origins.push_back(prior);
  }
  return origins;
}

//------------------------------------------------------------------------------
void vtkLacunaRBFHoleFiller::Describe(lacuna::Properties& properties) const
{
  properties.Add("DefectRegion", lacuna::FunctionText::Describe(this->DefectRegion))
    .Add("DefectArray", this->DefectArray)
    .Add("SupportArray", this->SupportArray)
    .Add("ControlDepthArray", this->ControlDepthArray);
  this->GetOptions().Describe(properties);
}

//------------------------------------------------------------------------------
std::string vtkLacunaRBFHoleFiller::Parameters(int port) const
{
  return this->Made + " " + this->Algorithm::Parameters(port);
}
