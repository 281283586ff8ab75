// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSkullShells.h"

#include "lacunaArrayScalarType.h"
#include "lacunaArrays.h"
#include "lacunaTrackedSlices.h"
#include "lacunaVolumeDirection.h"
#include "lacunaVoxelSampler.h"
#include "vtkDataArray.h"
#include "vtkExtractVOI.h"
#include "vtkFlyingEdges3D.h"
#include "vtkGenericCell.h"
#include "vtkIdList.h"
#include "vtkImageData.h"
#include "vtkMatrix4x4.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkStaticCellLocator.h"
#include "vtkTriangle.h"
#include "vtkTriangleFilter.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

namespace lacuna
{
namespace
{
constexpr double NotANumber = std::numeric_limits<double>::quiet_NaN();
constexpr double Beyond = 1e-3; // mm behind a crossing from where the next one is sought

class ImageShell : public SkullShell
{
public:
  ImageShell(vtkImageData* image, double level)
    : Shell(GetBoneVolume(image, this->Keep), level)
  {
  }
  RayRadii Trace(
    const Vec3& center, const std::vector<Vec3>& directions, Execution& execution) const override
  {
    return this->Shell.Trace(center, directions, execution);
  }
  Vec3 GetMiddle(Execution& execution) const override { return this->Shell.GetMiddle(execution); }

private:
  vtkSmartPointer<vtkDataArray> Keep;
  VolumeShell Shell;
};

class MeshShell : public SkullShell
{
public:
  explicit MeshShell(vtkPolyData* mesh)
  {
    vtkNew<vtkTriangleFilter> triangles;
    triangles->SetInputData(mesh);
    triangles->PassVertsOff();
    triangles->PassLinesOff();
    triangles->Update();
    this->Mesh = triangles->GetOutput();
    if (this->Mesh->GetNumberOfCells() == 0)
    {
      throw std::runtime_error("it has no triangles");
    }
    this->Locator->SetDataSet(this->Mesh);
    this->Locator->BuildLocator();
  }

  RayRadii Trace(
    const Vec3& center, const std::vector<Vec3>& directions, Execution& execution) const override
  {
    RayRadii radii;
    radii.Outer.assign(directions.size(), NotANumber);
    radii.Inner.assign(directions.size(), NotANumber);
    execution.For(static_cast<std::int64_t>(directions.size()), 64,
      [&](std::int64_t begin, std::int64_t end)
      {
        vtkNew<vtkGenericCell> cell;
        for (std::int64_t i = begin; i < end; ++i)
        {
          const double outer =
            this->Find(center, directions[i], MostSkullRadius, LeastSkullRadius, cell);
          radii.Outer[i] = outer;
          double before = outer;
          while (!std::isnan(before))
          {
            before =
              this->Find(center, directions[i], before - Beyond, outer - MostBoneThickness, cell);
            radii.Inner[i] = std::isnan(before) ? radii.Inner[i] : before;
          }
        }
      });
    return radii;
  }

  // Of the surface.
  Vec3 GetMiddle(Execution&) const override
  {
    Vec3 sum{ 0, 0, 0 };
    double area = 0;
    vtkNew<vtkIdList> ids;
    for (vtkIdType c = 0; c < this->Mesh->GetNumberOfCells(); ++c)
    {
      this->Mesh->GetCellPoints(c, ids);
      Vec3 corners[3];
      for (int k = 0; k < 3; ++k)
      {
        this->Mesh->GetPoint(ids->GetId(k), corners[k].data());
      }
      const double part =
        vtkTriangle::TriangleArea(corners[0].data(), corners[1].data(), corners[2].data());
      sum = sum + (part / 3) * (corners[0] + corners[1] + corners[2]);
      area += part;
    }
    if (!(area > 0) || !IsFinite(sum))
    {
      throw std::runtime_error("its triangles have no area, or points that are not finite");
    }
    return (1 / area) * sum;
  }

private:
  // The first crossing from one radius inwards to another; NaN for none.
  double Find(
    const Vec3& center, const Vec3& direction, double from, double to, vtkGenericCell* cell) const
  {
    if (!(from > to))
    {
      return NotANumber;
    }
    const Vec3 start = center + from * direction;
    const Vec3 end = center + to * direction;
    double t = 0;
    double x[3];
    double parameters[3];
    int part = 0;
    vtkIdType id = 0;
    return this->Locator->IntersectWithLine(
             start.data(), end.data(), 0, t, x, parameters, part, id, cell)
      ? from - t * (from - to)
      : NotANumber;
  }

  vtkSmartPointer<vtkPolyData> Mesh;
  vtkNew<vtkStaticCellLocator> Locator;
};
}

//------------------------------------------------------------------------------
VoxelVolume GetBoneVolume(vtkImageData* image, vtkSmartPointer<vtkDataArray>& keep)
{
  lacuna::TrackedSlices::Refuse(image);
  lacuna::VolumeDirection::Check(image);
  vtkDataArray* scalars = image->GetPointData()->GetScalars();
  if (!scalars || scalars->GetNumberOfComponents() != 1)
  {
    throw std::runtime_error(
      "the image has no active point scalars with one component: give it a CT");
  }
  keep = scalars;
  if (!scalars->HasStandardMemoryLayout())
  {
    keep.TakeReference(vtkDataArray::CreateDataArray(scalars->GetDataType()));
    lacuna::Arrays::Copy(scalars, keep);
  }
  VoxelVolume volume;
  volume.Type = lacuna::ArrayScalarType::Get(scalars);
  volume.Voxels = keep->GetVoidPointer(0);
  image->GetDimensions(volume.Size.data());
  const int* extent = image->GetExtent();
  volume.IndexToWorld = Matrix4(image->GetIndexToPhysicalMatrix()->GetData()) *
    Matrix4::Translation({ static_cast<double>(extent[0]), static_cast<double>(extent[2]),
      static_cast<double>(extent[4]) });
  return volume;
}

//------------------------------------------------------------------------------
TriangleSurface MakeBoneSurface(
  const VoxelVolume& volume, vtkDataArray* voxels, double level, const std::array<Vec3, 2>& box)
{
  const Matrix4 worldToIndex = volume.IndexToWorld.Inverse();
  int voi[6];
  for (int a = 0; a < 3; ++a)
  {
    voi[2 * a] = volume.Size[a] - 1;
    voi[2 * a + 1] = 0;
    for (int corner = 0; corner < 8; ++corner)
    {
      const Vec3 x{ box[corner & 1][0], box[corner >> 1 & 1][1], box[corner >> 2][2] };
      const double index = std::clamp(worldToIndex.Point(x)[a], 0.0, volume.Size[a] - 1.0);
      voi[2 * a] = std::min(voi[2 * a], static_cast<int>(std::floor(index)));
      voi[2 * a + 1] = std::max(voi[2 * a + 1], static_cast<int>(std::ceil(index)));
    }
  }
  vtkNew<vtkImageData> image; // in indices: turned and mirrored volumes are like others
  image->SetDimensions(volume.Size.data());
  image->GetPointData()->SetScalars(voxels);
  vtkNew<vtkExtractVOI> part;
  part->SetInputData(image);
  part->SetVOI(voi);
  vtkNew<vtkFlyingEdges3D> contour;
  contour->SetInputConnection(part->GetOutputPort());
  contour->SetValue(0, level);
  contour->ComputeNormalsOff();
  contour->ComputeScalarsOff();
  contour->Update();
  vtkPolyData* found = contour->GetOutput();
  TriangleSurface surface;
  surface.Points.resize(found->GetNumberOfPoints());
  for (vtkIdType p = 0; p < found->GetNumberOfPoints(); ++p)
  {
    Vec3 index;
    found->GetPoint(p, index.data());
    surface.Points[p] = volume.IndexToWorld.Point(index);
  }
  vtkNew<vtkIdList> corners;
  for (vtkIdType c = 0; c < found->GetNumberOfCells(); ++c)
  {
    found->GetCellPoints(c, corners);
    surface.Triangles.push_back({ static_cast<std::int32_t>(corners->GetId(0)),
      static_cast<std::int32_t>(corners->GetId(1)), static_cast<std::int32_t>(corners->GetId(2)) });
  }
  return surface;
}

//------------------------------------------------------------------------------
std::unique_ptr<BoneDistance> MakeBoneDistance(
  const VoxelVolume& volume, vtkDataArray* voxels, double level, const std::array<Vec3, 2>& box)
{
  std::function<bool(const Vec3&)> isBone;
  DispatchScalars(volume.Type, volume.Voxels,
    [&](const auto* values)
    {
      isBone = [sample = VoxelSampler(volume, values), level](const Vec3& x)
      { return sample(x) >= level; };
    });
  return std::make_unique<TriangleBone>(
    MakeBoneSurface(volume, voxels, level, box), std::move(isBone));
}

//------------------------------------------------------------------------------
std::unique_ptr<SkullShell> MakeSkullShell(vtkDataObject* data, double level)
{
  if (auto* image = vtkImageData::SafeDownCast(data))
  {
    return std::make_unique<ImageShell>(image, level);
  }
  auto* mesh = vtkPolyData::SafeDownCast(data);
  if (!mesh)
  {
    throw std::runtime_error("it is neither a volume nor a mesh");
  }
  return std::make_unique<MeshShell>(mesh);
}
}
