// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaOcclusionSurface.h"

#include "lacunaArrays.h"
#include "lacunaFieldData.h"
#include "lacunaMemory.h"
#include "lacunaOcclusionInput.h"
#include "lacunaOcclusionSurface.h"
#include "lacunaVolumeDirection.h"
#include "vtkAlgorithmOutput.h"
#include "vtkCellArray.h"
#include "vtkCleanPolyData.h"
#include "vtkFloatArray.h"
#include "vtkFlyingEdges3D.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkLacunaOccludedAngle.h"
#include "vtkMatrix3x3.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkPolyDataConnectivityFilter.h"
#include "vtkSmartPointer.h"
#include "vtkUnsignedCharArray.h"

#include <cmath>
#include <stdexcept>
#include <vector>

vtkStandardNewMacro(vtkLacunaOcclusionSurface);

namespace
{
using Point = lacuna::OcclusionSurface::Point;

template <class Array>
Array* FindArray(vtkImageData* angle, const char* name)
{
  auto* array = Array::SafeDownCast(angle->GetPointData()->GetArray(name));
  if (!array || array->GetNumberOfComponents() != 1 ||
    array->GetNumberOfTuples() != angle->GetNumberOfPoints())
  {
    throw std::runtime_error("the first input has no point array '" + std::string(name) +
      "' of Occluded Angle; connect the output of that filter");
  }
  return array;
}

// 1 where the data take half of a ray or more.
std::vector<unsigned char> FindData(vtkImageData* image, const lacuna::OcclusionInput::Grid& grid,
  const std::string& name, lacuna::Execution& execution)
{
  lacuna::AttenuationField field(grid.Dimensions, grid.Spacing);
  lacuna::OcclusionInput::Fill(field, image, lacuna::OcclusionInput::FindScalars(image, name),
    { vtkLacunaOccludedAngle::LinearInRange, nullptr, true }, execution);
  std::vector<unsigned char> data(grid.GetSize());
  const auto& n = grid.Dimensions;
  for (std::int64_t k = 0; k < n[2]; ++k)
  {
    for (std::int64_t j = 0; j < n[1]; ++j)
    {
      const float* row = field.Row(j, k);
      for (std::int64_t i = 0; i < n[0]; ++i)
      {
        data[(k * n[1] + j) * n[0] + i] = row[i] > 0;
      }
    }
  }
  return data;
}

// The largest surface where the function is 0, in mm from the centre of the first voxel.
vtkSmartPointer<vtkPolyData> FindContour(
  const std::vector<float>& values, const lacuna::OcclusionInput::Grid& grid)
{
  constexpr int margin = lacuna::OcclusionSurface::GridMargin;
  vtkNew<vtkFloatArray> array;
  array->SetArray(const_cast<float*>(values.data()), static_cast<vtkIdType>(values.size()), 1);
  vtkNew<vtkImageData> image;
  image->SetExtent(-margin, static_cast<int>(grid.Dimensions[0]) - 1 + margin, -margin,
    static_cast<int>(grid.Dimensions[1]) - 1 + margin, -margin,
    static_cast<int>(grid.Dimensions[2]) - 1 + margin);
  image->SetSpacing(grid.Spacing.data());
  image->GetPointData()->SetScalars(array);
  vtkNew<vtkFlyingEdges3D> contour;
  contour->SetInputData(image);
  contour->SetValue(0, 0);
  contour->ComputeNormalsOff();
  contour->ComputeScalarsOff();
  vtkNew<vtkPolyDataConnectivityFilter> region;
  region->SetInputConnection(contour->GetOutputPort());
  region->SetExtractionModeToLargestRegion();
  vtkNew<vtkCleanPolyData> clean; // drops the points of other regions
  clean->SetInputConnection(region->GetOutputPort());
  clean->PointMergingOff();
  clean->Update();
  vtkSmartPointer<vtkPolyData> surface = clean->GetOutput();
  if (surface->GetNumberOfPolys() == 0)
  {
    throw std::runtime_error("the function fitted to the data has no surface; lower Smoothing");
  }
  return surface;
}

// Volume (positive when triangles are seen from outside counter-clockwise) and area.
struct Measures
{
  explicit Measures(vtkPolyData* surface)
  {
    vtkNew<vtkIdList> cell;
    for (vtkIdType t = 0; t < surface->GetNumberOfCells(); ++t)
    {
      surface->GetCellPoints(t, cell);
      lacuna::Vec3 p[3];
      for (int c = 0; c < 3; ++c)
      {
        surface->GetPoint(cell->GetId(c), p[c].data());
      }
      const lacuna::Vec3 normal = lacuna::Cross(p[1] - p[0], p[2] - p[0]);
      this->Volume += lacuna::Dot(p[0], normal) / 6;
      this->Area += lacuna::Norm(normal) / 2;
    }
  }

  double Volume = 0; // mm^3
  double Area = 0;   // mm^2
};

void ReverseTriangles(vtkPolyData* surface)
{
  vtkNew<vtkCellArray> reversed;
  lacuna::Arrays::Reserve(reversed, surface->GetNumberOfCells(), 3 * surface->GetNumberOfCells());
  vtkNew<vtkIdList> cell;
  for (vtkIdType t = 0; t < surface->GetNumberOfCells(); ++t)
  {
    surface->GetCellPoints(t, cell);
    const vtkIdType ids[3] = { cell->GetId(0), cell->GetId(2), cell->GetId(1) };
    reversed->InsertNextCell(3, ids);
  }
  surface->SetPolys(reversed);
}

// Points from mm along the image's axes to the world, with normals.
void SetPoints(vtkPolyData* surface, const std::vector<Point>& points,
  const std::vector<Point>& normals, vtkImageData* image)
{
  vtkNew<vtkPoints> moved;
  moved->SetDataTypeToFloat();
  lacuna::Arrays::SetNumberOfPoints(moved, static_cast<vtkIdType>(points.size()));
  vtkNew<vtkFloatArray> array;
  array->SetName("Normals");
  array->SetNumberOfComponents(3);
  lacuna::Arrays::SetNumberOfTuples(array, static_cast<vtkIdType>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    double index[3];
    for (int c = 0; c < 3; ++c)
    {
      index[c] = image->GetExtent()[2 * c] + points[i][c] / image->GetSpacing()[c];
    }
    double world[3];
    image->TransformContinuousIndexToPhysicalPoint(index, world);
    moved->SetPoint(static_cast<vtkIdType>(i), world);
    double normal[3];
    image->GetDirectionMatrix()->MultiplyPoint(normals[i].data(), normal);
    array->SetTuple(static_cast<vtkIdType>(i), normal);
  }
  surface->SetPoints(moved);
  surface->GetPointData()->Initialize();
  surface->GetPointData()->SetNormals(array);
}
}

//------------------------------------------------------------------------------
vtkLacunaOcclusionSurface::vtkLacunaOcclusionSurface()
{
  this->Sharing = lacuna::Share::FirstRank;
  this->TakesEmpty = true; // an error
  this->TakesBlocks = true;
  this->SetNumberOfInputPorts(2);
}

void vtkLacunaOcclusionSurface::SetDataConnection(vtkAlgorithmOutput* output)
{
  this->SetInputConnection(1, output);
}

//------------------------------------------------------------------------------
int vtkLacunaOcclusionSurface::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkImageData");
  return 1;
}

//------------------------------------------------------------------------------
void vtkLacunaOcclusionSurface::Make(
  const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution)
{
  vtkImageData* angle = ports.GetInput<vtkImageData>();
  vtkImageData* image = ports.GetInput<vtkImageData>(1);
  const lacuna::OcclusionInput::Grid grid(angle);
  if (grid.Axes != 3)
  {
    throw std::runtime_error("the angle image is flat; the surface of a 3-D image is made");
  }
  if (!lacuna::OcclusionInput::SamePlace(angle, image))
  {
    throw std::runtime_error("the data (second input) have other voxels than the angle image; "
                             "connect the image that Occluded Angle was given");
  }
  const auto* theta = FindArray<vtkFloatArray>(angle, "OccludedAngle");
  const auto* object = FindArray<vtkUnsignedCharArray>(angle, "Object");
  lacuna::RequireMemory("the surface of " + std::to_string(grid.GetSize()) + " voxels",
    24.0 * static_cast<double>(grid.GetSize()));
  const std::vector<unsigned char> data = FindData(image, grid, this->ScalarArray, execution);
  const lacuna::OcclusionImages images{ grid.Dimensions, grid.Spacing,
    const_cast<vtkFloatArray*>(theta)->GetPointer(0),
    const_cast<vtkUnsignedCharArray*>(object)->GetPointer(0), data.data() };
  execution.SetStage(0, 0.85);
  const lacuna::OcclusionSurface fit(execution, images, this->GetOptions());
  execution.SetStage(0.85, 0.95);
  const std::vector<float> values = fit.EvaluateGrid(execution);
  vtkSmartPointer<vtkPolyData> surface = FindContour(values, grid);
  std::vector<Point> points(surface->GetNumberOfPoints());
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    surface->GetPoint(static_cast<vtkIdType>(i), points[i].data());
  }
  std::vector<Point> normals;
  execution.SetStage(0.95, 1);
  fit.Project(execution, points, normals);

  auto* output = ports.GetOutput<vtkPolyData>();
  output->SetPolys(surface->GetPolys());
  SetPoints(output, points, normals, angle);
  Measures measures(output);
  if (measures.Volume < 0)
  {
    ReverseTriangles(output);
    measures.Volume = -measures.Volume;
  }
  lacuna::VolumeDirection::Remove(output);
  const lacuna::OcclusionSurfaceReport& report = fit.GetReport();
  const double edge = std::cbrt(grid.Spacing[0] * grid.Spacing[1] * grid.Spacing[2]);
  this->WarnOfFit(report, edge);
  this->WarnOfCavity(report, angle);
  const auto set = [output](const char* name, double value)
  { lacuna::FieldData::Set(output, name, { value }, 1); };
  set("SurfaceVolume", measures.Volume / 1000);
  set("SurfaceArea", measures.Area);
  set("DataVoxels", static_cast<double>(report.DataVoxels));
  set("Outliers", static_cast<double>(report.Outliers));
  set("Residual", report.Residual);
}

//------------------------------------------------------------------------------
void vtkLacunaOcclusionSurface::WarnOfFit(const lacuna::OcclusionSurfaceReport& report, double edge)
{
  if (report.Residual > 0.45 * edge || report.Outliers > report.DataVoxels)
  {
    vtkWarningMacro(<< "the surface may be wrong: " << report.Outliers << " of "
                    << report.Outliers + report.DataVoxels
                    << " data voxels are outliers, the others are " << report.Residual / edge
                    << " voxel edges from it (root mean square; 0.3 is usual). Data must be "
                       "voxels of the surface, not of the body's inside: use "
                       "lacuna.occlusion.closed_surface for these");
  }
}

//------------------------------------------------------------------------------
void vtkLacunaOcclusionSurface::WarnOfCavity(
  const lacuna::OcclusionSurfaceReport& report, vtkImageData* angle)
{
  if (report.Together > 0)
  {
    double place[3];
    const int* extent = angle->GetExtent();
    const std::int64_t all = report.Outliers + report.DataVoxels;
    angle->TransformIndexToPhysicalPoint(static_cast<int>(extent[0] + report.TogetherAt[0]),
      static_cast<int>(extent[2] + report.TogetherAt[1]),
      static_cast<int>(extent[4] + report.TogetherAt[2]), place);
    vtkWarningMacro(<< report.Together << " of " << all << " data voxels ("
                    << std::lround(
                         100.0 * static_cast<double>(report.Together) / static_cast<double>(all))
                    << " %) are not used though they lie together, as the wall of a cavity or "
                    << "bore does, the most around (" << place[0] << ", " << place[1] << ", "
                    << place[2] << "): the surface closes it, and its volume is too large. If "
                    << "it is one, use lacuna.occlusion.closed_surface");
  }
}

//------------------------------------------------------------------------------
lacuna::OcclusionSurfaceOptions vtkLacunaOcclusionSurface::GetOptions() const
{
  lacuna::OcclusionSurfaceOptions options;
  options.Smoothing = this->Smoothing;
  options.Tolerance = this->Tolerance;
  return options;
}

//------------------------------------------------------------------------------
void vtkLacunaOcclusionSurface::Describe(lacuna::Properties& properties) const
{
  properties.Add("ScalarArray", this->ScalarArray);
  this->GetOptions().Describe(properties);
}
