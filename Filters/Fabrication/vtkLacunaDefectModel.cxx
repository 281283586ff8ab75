// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaDefectModel.h"

#include "lacunaArrays.h"
#include "lacunaCoordinates.h"
#include "lacunaDefectModel.h"
#include "lacunaDepthMap.h"
#include "lacunaFieldData.h"
#include "lacunaFittedPart.h"
#include "lacunaPressPosition.h"
#include "lacunaReliefSurface.h"
#include "lacunaSolidMesh.h"
#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkStructuredGrid.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

vtkStandardNewMacro(vtkLacunaDefectModel);

namespace
{
//------------------------------------------------------------------------------
// What the kernel needs of a map, and the way from there to the world.
struct Input
{
  lacuna::DefectScene Scene;
  lacuna::DefectModelOptions Options;
  lacuna::Matrix4 ToWorld;

  Input(vtkImageData* map, const lacuna::DefectModelOptions& options)
    : Options(options)
  {
    lacuna::FittedPart part(map, "a model");
    int dimensions[3];
    map->GetDimensions(dimensions);
    this->Scene.MapSize = { dimensions[0], dimensions[1] };
    vtkDataArray* depths = lacuna::DepthMap(map).GetDepth();
    for (vtkIdType k = 0; k < depths->GetNumberOfTuples(); ++k)
    {
      this->Scene.MapDepths.push_back(depths->GetComponent(k, 0));
    }
    this->Scene.Column = part.Column;
    this->Scene.Row = part.Row;
    this->Scene.Size = part.Size;
    this->Scene.Spacing = part.Spacing;
    this->Scene.Fitted = std::move(part.Depths);
    this->Scene.Mask = std::move(part.Mask);
    this->ToWorld = part.ToWorld;
  }
};

//------------------------------------------------------------------------------
// The pixels of the upper side; rows run towards +y, which is up for the viewer.
void SetTop(vtkStructuredGrid* output, const lacuna::DefectModel& model,
  const lacuna::DefectScene& scene, const lacuna::Matrix4& toPress)
{
  const lacuna::GridSize& size = model.TopSize;
  output->SetDimensions(static_cast<int>(size.Columns), static_cast<int>(size.Rows), 1);
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  lacuna::Arrays::SetNumberOfPoints(points, size.Columns * size.Rows);
  vtkNew<vtkUnsignedCharArray> faces;
  faces->SetName(vtkLacunaDefectModel::ModelFaceName);
  lacuna::Arrays::SetNumberOfTuples(faces, size.Columns * size.Rows);
  vtkIdType point = 0;
  for (std::int64_t j = size.Rows - 1; j >= 0; --j)
  {
    for (std::int64_t i = 0; i < size.Columns; ++i)
    {
      const std::int64_t k = i + size.Columns * j;
      const lacuna::Vec3 p{ scene.Spacing[0] * static_cast<double>(model.Column + i - scene.Column),
        scene.Spacing[1] * static_cast<double>(model.Row + j - scene.Row), model.Top[k] };
      points->SetPoint(point, toPress.Point(p).data());
      faces->SetValue(point++, static_cast<unsigned char>(model.TopFaces[k]));
    }
  }
  output->SetPoints(points);
  output->GetPointData()->SetScalars(faces);
  lacuna::PressPosition::Record(output);
}
}

//------------------------------------------------------------------------------
vtkLacunaDefectModel::vtkLacunaDefectModel()
{
  this->Sharing = lacuna::Share::FirstRank;
  this->SetNumberOfOutputPorts(2);
}

//------------------------------------------------------------------------------
int vtkLacunaDefectModel::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkImageData");
  return 1;
}

//------------------------------------------------------------------------------
int vtkLacunaDefectModel::FillOutputPortInformation(int port, vtkInformation* info)
{
  info->Set(vtkDataObject::DATA_TYPE_NAME(), port == 0 ? "vtkPolyData" : "vtkStructuredGrid");
  return 1;
}

//------------------------------------------------------------------------------
void vtkLacunaDefectModel::Announce(const lacuna::Ports& ports)
{
  this->CheckProperties();
  this->UpdateInput(ports); // the size of the grid depends on the defect
  int extent[6] = { 0, -1, 0, -1, 0, -1 };
  auto* map = ports.GetInput<vtkImageData>();
  if (map && map->GetNumberOfPoints() > 0)
  {
    const Input input(map, this->GetOptions());
    const auto plan = lacuna::PlanDefectModel(input.Scene, input.Options);
    extent[1] = static_cast<int>(plan.Size.Columns) - 1;
    extent[3] = static_cast<int>(plan.Size.Rows) - 1;
    extent[5] = 0;
  }
  ports.GetOutputInformation(1)->Set(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), extent, 6);
}

//------------------------------------------------------------------------------
void vtkLacunaDefectModel::Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution)
{
  auto* map = ports.GetInput<vtkImageData>();
  auto* solid = ports.GetOutput<vtkPolyData>();
  auto* top = ports.GetOutput<vtkStructuredGrid>(1);
  // VTK passes the map's, whose ImageToWorld is not of these
  solid->GetFieldData()->Initialize();
  top->GetFieldData()->Initialize();
  const Input input(map, this->GetOptions());
  execution.SetStage(0, 0.1);
  const lacuna::ReliefSurface surface(
    execution, input.Scene.Size, input.Scene.Fitted, input.Scene.Spacing);
  execution.SetStage(0.1, 1);
  lacuna::DefectModel model;
  {
    const lacuna::Execution::NestedStages nested(execution);
    model = lacuna::MakeDefectModel(execution, input.Scene, surface, input.Options, input.ToWorld);
  }
  for (const std::string& warning : model.Warnings)
  {
    vtkWarningMacro(<< warning);
  }
  const lacuna::Vec2& spacing = input.Scene.Spacing;
  const auto middle = [](std::int64_t first, std::int64_t from, std::int64_t count, double step)
  { return step * (static_cast<double>(first - from) + 0.5 * static_cast<double>(count - 1)); };
  // x as the map's, y up, z towards the viewer: half a turn about x
  const lacuna::Matrix4 fromPress =
    lacuna::Matrix4::FromColumns({ 1, 0, 0 }, { 0, -1, 0 }, { 0, 0, -1 },
      { middle(model.Column, input.Scene.Column, model.TopSize.Columns, spacing[0]),
        middle(model.Row, input.Scene.Row, model.TopSize.Rows, spacing[1]), model.Highest });
  int whole[6];
  ports.GetOutputInformation(1)->Get(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), whole);
  if (whole[1] + 1 != model.TopSize.Columns || whole[3] + 1 != model.TopSize.Rows)
  {
    throw std::runtime_error("the depth map has changed since the grid was announced (a source "
                             "that changes with time?); change a property and update again");
  }
  lacuna::SolidMesh::Set(solid, model, input.ToWorld, ModelFaceName);
  SetTop(top, model, input.Scene, fromPress.Inverse());

  lacuna::Coordinates::MarkPress(map, top);
  const lacuna::Matrix4 toPatient = input.ToWorld * fromPress;
  for (vtkDataObject* output :
    { static_cast<vtkDataObject*>(solid), static_cast<vtkDataObject*>(top) })
  {
    lacuna::FieldData::SetMatrices(output, lacuna::Coordinates::PressToPatientName, { toPatient });
    lacuna::FieldData::Set(output, "BlockSize",
      { spacing[0] * static_cast<double>(model.TopSize.Columns - 1),
        spacing[1] * static_cast<double>(model.TopSize.Rows - 1), model.Bottom - model.Highest },
      3);
    lacuna::FieldData::Set(output, "FloorHeight", { model.Highest - model.Base }, 1);
    lacuna::FieldData::Set(output, "Volume", { model.Volume }, 1);
    lacuna::FieldData::Set(output, "DefectCount", { static_cast<double>(model.Defects) }, 1);
  }
}

//------------------------------------------------------------------------------
lacuna::DefectModelOptions vtkLacunaDefectModel::GetOptions() const
{
  lacuna::DefectModelOptions options;
  options.Margin = this->Margin;
  options.Floor = static_cast<lacuna::DefectFloor>(this->FloorShape);
  options.DefectDepth = this->DefectDepth;
  options.BaseThickness = this->BaseThickness;
  options.MaximumHeight = this->MaximumHeight;
  return options;
}

//------------------------------------------------------------------------------
void vtkLacunaDefectModel::Describe(lacuna::Properties& properties) const
{
  this->GetOptions().Describe(properties);
}
