// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaSkullResection.h"

#include "lacunaArrays.h"
#include "lacunaFieldData.h"
#include "lacunaImplantData.h"
#include "lacunaMemory.h"
#include "lacunaSkullRays.h"
#include "lacunaSkullResection.h"
#include "lacunaSkullShells.h"
#include "lacunaVolumeDirection.h"
#include "vtkDataArray.h"
#include "vtkDataObject.h"
#include "vtkDataSet.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkPolyDataPointSampler.h"
#include "vtkSmartPointer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

vtkStandardNewMacro(vtkLacunaSkullResection);

namespace
{
using lacuna::Vec3;

constexpr double InMask = 0.5;
constexpr double SampleDistance = 1; // mm

// Adds points all over a voxel, at most SampleDistance apart.
void AddVoxel(vtkImageData* image, const std::array<int, 3>& voxel, std::vector<Vec3>& points)
{
  int steps[3];
  for (int a = 0; a < 3; ++a)
  {
    steps[a] = static_cast<int>(std::ceil(image->GetSpacing()[a] / SampleDistance));
  }
  for (int k = 0; k <= steps[2]; ++k)
  {
    for (int j = 0; j <= steps[1]; ++j)
    {
      for (int i = 0; i <= steps[0]; ++i)
      {
        points.emplace_back();
        image->TransformContinuousIndexToPhysicalPoint(
          voxel[0] - 0.5 + static_cast<double>(i) / steps[0],
          voxel[1] - 0.5 + static_cast<double>(j) / steps[1],
          voxel[2] - 0.5 + static_cast<double>(k) / steps[2], points.back().data());
      }
    }
  }
}

// Points all over the voxels of a mask that have a neighbour outside of it, so that no part of a thick slice is nearer.
std::vector<Vec3> GetMask(vtkImageData* image)
{
  vtkDataArray* mask = image->GetPointData()->GetScalars();
  if (!mask || mask->GetNumberOfComponents() != 1)
  {
    throw std::runtime_error("the tumour's image has no active point scalars with one component: "
                             "give a mask, in which the tumour is above 0.5");
  }
  lacuna::VolumeDirection::Check(image);
  const int* extent = image->GetExtent();
  const auto isTumour = [&](std::array<int, 3> voxel)
  {
    for (int a = 0; a < 3; ++a)
    {
      if (voxel[a] < extent[2 * a] || voxel[a] > extent[2 * a + 1])
      {
        return false;
      }
    }
    return mask->GetComponent(image->ComputePointId(voxel.data()), 0) > InMask;
  };
  std::vector<Vec3> points;
  for (int k = extent[4]; k <= extent[5]; ++k)
  {
    for (int j = extent[2]; j <= extent[3]; ++j)
    {
      for (int i = extent[0]; i <= extent[1]; ++i)
      {
        if (isTumour({ i, j, k }) &&
          !(isTumour({ i - 1, j, k }) && isTumour({ i + 1, j, k }) && isTumour({ i, j - 1, k }) &&
            isTumour({ i, j + 1, k }) && isTumour({ i, j, k - 1 }) && isTumour({ i, j, k + 1 })))
        {
          AddVoxel(image, { i, j, k }, points);
        }
      }
    }
  }
  if (points.empty())
  {
    throw std::runtime_error("the tumour is empty: no voxel of the mask is above 0.5");
  }
  return points;
}

// Points all over a mask or a surface.
std::vector<Vec3> GetTumour(vtkDataSet* data)
{
  if (auto* image = vtkImageData::SafeDownCast(data))
  {
    return GetMask(image);
  }
  vtkNew<vtkPolyDataPointSampler> sampler;
  sampler->SetInputData(vtkPolyData::SafeDownCast(data));
  sampler->SetDistance(SampleDistance);
  sampler->Update();
  std::vector<Vec3> points(static_cast<std::size_t>(sampler->GetOutput()->GetNumberOfPoints()));
  for (std::size_t k = 0; k < points.size(); ++k)
  {
    sampler->GetOutput()->GetPoint(static_cast<vtkIdType>(k), points[k].data());
  }
  return points;
}
}

//------------------------------------------------------------------------------
vtkLacunaSkullResection::vtkLacunaSkullResection()
{
  this->SetNumberOfInputPorts(3);
  this->SetNumberOfOutputPorts(4);
}

//------------------------------------------------------------------------------
int vtkLacunaSkullResection::FillInputPortInformation(int port, vtkInformation* info)
{
  if (port != 1)
  {
    info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkImageData");
  }
  if (port != 0)
  {
    info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkPolyData");
    info->Set(vtkAlgorithm::INPUT_IS_OPTIONAL(), 1);
  }
  return 1;
}

//------------------------------------------------------------------------------
int vtkLacunaSkullResection::FillOutputPortInformation(int port, vtkInformation* info)
{
  info->Set(vtkDataObject::DATA_TYPE_NAME(), port == 0 ? "vtkImageData" : "vtkPolyData");
  return 1;
}

//------------------------------------------------------------------------------
void vtkLacunaSkullResection::MakeMeshes(const lacuna::VoxelVolume& volume, vtkDataArray* alone,
  const lacuna::SkullResection& cut, const lacuna::Ports& ports, lacuna::Execution& execution)
{
  vtkPolyData* others[3];
  for (int k = 0; k < 3; ++k)
  {
    others[k] = ports.GetOutput<vtkPolyData>(k + 1);
  }
  lacuna::SetCurve(others[0], cut.GetOutline());
  std::array<Vec3, 2> all{ volume.IndexToWorld.Point({ 0, 0, 0 }),
    volume.IndexToWorld.Point({ 0, 0, 0 }) };
  for (const Vec3& corner : CornersOf(volume.IndexToWorld, volume.Size))
  {
    for (int a = 0; a < 3; ++a)
    {
      all[0][a] = std::min(all[0][a], corner[a]);
      all[1][a] = std::max(all[1][a], corner[a]);
    }
  }
  const lacuna::TriangleSurface piece = lacuna::MakeBoneSurface(volume, alone, this->Level, all);
  if (piece.Triangles.empty())
  {
    throw std::runtime_error("nothing is cut out: no bone is within the outline at this Level");
  }
  const double pieceVolume = lacuna::SetTriangles(others[1], piece.Points, piece.Triangles);
  lacuna::FieldData::Set(others[1], "Volume", { pieceVolume }, 1);
  const Vec3& way = cut.GetDirection();
  lacuna::FieldData::Set(others[1], "CutDirection", { way[0], way[1], way[2] }, 3);
  execution.SetStage(0.7, 1);
  if (this->GuideWidth > 0)
  {
    const lacuna::SkullImplant guide = cut.MakeGuide(execution);
    lacuna::SetImplant(others[2], guide);
    lacuna::FieldData::Set(others[2], "Volume", { guide.Volume }, 1);
    for (const std::string& warning : guide.Warnings)
    {
      vtkWarningMacro(<< warning);
    }
  }
}

//------------------------------------------------------------------------------
void vtkLacunaSkullResection::Make(
  const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution)
{
  auto* image = ports.GetInput<vtkImageData>();
  auto* outline = ports.GetInput<vtkPolyData>(1);
  auto* tumour = ports.GetInput<vtkDataSet>(2);
  lacuna::ResectionOptions options = this->GetOptions();
  if (this->GuideWidth == 0)
  {
    options.GuideWidth = lacuna::ResectionOptions().GuideWidth;
  }
  CheckResectionOptions(options);
  const bool isDrawn = outline && outline->GetNumberOfPoints() > 0;
  const bool hasTumour = tumour && tumour->GetNumberOfPoints() > 0;
  if (!isDrawn && !hasTumour)
  {
    throw std::runtime_error("there is neither an outline nor a tumour: give a closed curve on the "
                             "skull as Outline, or a mask or surface as Tumour");
  }
  vtkSmartPointer<vtkDataArray> keep;
  const lacuna::VoxelVolume volume = lacuna::GetBoneVolume(image, keep);
  lacuna::RequireMemory("the bone after the cut and what is cut out",
    2.0 * static_cast<double>(volume.NumberOfVoxels()) * keep->GetDataTypeSize());
  execution.SetStage(0, 0.2);
  const Vec3 middle = FindMeanOfBone(volume, this->Level, execution);
  execution.SetStage(0.2, 0.3);
  const lacuna::SkullResection cut(volume,
    isDrawn ? lacuna::GetCurve(outline)
            : lacuna::FindOutlineAround(GetTumour(tumour), this->Margin, middle),
    middle, options, execution);
  for (const std::string& warning : cut.GetWarnings())
  {
    vtkWarningMacro(<< warning);
  }
  const auto make = [&]
  {
    auto values =
      vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(keep->GetDataType()));
    lacuna::Arrays::SetNumberOfTuples(values, image->GetNumberOfPoints());
    values->SetName(keep->GetName());
    return values;
  };
  const vtkSmartPointer<vtkDataArray> kept = make();
  const vtkSmartPointer<vtkDataArray> alone = make();
  execution.SetStage(0.3, 0.7);
  cut.Cut(kept->GetVoidPointer(0), alone->GetVoidPointer(0), execution);

  auto* bone = ports.GetOutput<vtkImageData>();
  bone->ShallowCopy(image);
  bone->GetPointData()->SetScalars(kept);
  if (ports.IsFirst()) // meshes are there alone
  {
    this->MakeMeshes(volume, alone, cut, ports, execution);
  }
}

//------------------------------------------------------------------------------
std::vector<vtkDataObject*> vtkLacunaSkullResection::GetOrigins(const lacuna::Ports& ports) const
{
  auto* outline = ports.GetInput<vtkPolyData>(1);
  const bool isDrawn = outline && outline->GetNumberOfPoints() > 0;
  return { ports.GetInput<vtkDataObject>(), ports.GetInput<vtkDataObject>(isDrawn ? 1 : 2) };
}

//------------------------------------------------------------------------------
lacuna::ResectionOptions vtkLacunaSkullResection::GetOptions() const
{
  lacuna::ResectionOptions options;
  options.Level = this->Level;
  options.Bevel = this->Bevel;
  options.GuideWidth = this->GuideWidth;
  options.GuideHeight = this->GuideHeight;
  options.GuideClearance = this->GuideClearance;
  options.GuideHole = this->GuideHole;
  return options;
}

//------------------------------------------------------------------------------
void vtkLacunaSkullResection::Describe(lacuna::Properties& properties) const
{
  properties.Add("Level", this->Level, lacuna::ValueRange::Above(0, "HU"))
    .Add("Margin", this->Margin, lacuna::ResectionMargins);
  this->GetOptions().Describe(properties);
}
