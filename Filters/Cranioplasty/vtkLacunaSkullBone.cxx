// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaSkullBone.h"

#include "lacunaArrayScalarType.h"
#include "lacunaArrays.h"
#include "lacunaFieldData.h"
#include "lacunaMemory.h"
#include "lacunaParameterText.h"
#include "lacunaProposedLevel.h"
#include "lacunaSkullBridge.h"
#include "lacunaTrackedSlices.h"
#include "lacunaVector.h"
#include "lacunaVolumeDirection.h"
#include "vtkCellArray.h"
#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkMatrix4x4.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkSelectEnclosedPoints.h"
#include "vtkTriangleFilter.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

vtkStandardNewMacro(vtkLacunaSkullBone);

namespace
{

enum Kind : std::uint8_t
{
  Below,
  Bone, ///< not looked at yet
  Kept,
  Current, ///< of the part that is being looked at
  Removed,
  Halo,    ///< below, to be lowered
  BoneEdge ///< below, near kept bone
};

// The voxels of a volume, each of one kind.
struct Kinds
{
  int Size[3];
  std::vector<std::uint8_t> Of;

  // f(index) for all voxels within so many of voxel p, itself included, while it returns true.
  template <class Function>
  bool Around(vtkIdType p, const int reach[3], const Function& f) const
  {
    const vtkIdType plane = static_cast<vtkIdType>(this->Size[0]) * this->Size[1];
    const int at[3] = { static_cast<int>(p % this->Size[0]),
      static_cast<int>(p / this->Size[0] % this->Size[1]), static_cast<int>(p / plane) };
    int low[3];
    int high[3];
    for (int a = 0; a < 3; ++a)
    {
      low[a] = std::max(at[a] - reach[a], 0);
      high[a] = std::min(at[a] + reach[a], this->Size[a] - 1);
    }
    for (int k = low[2]; k <= high[2]; ++k)
    {
      for (int j = low[1]; j <= high[1]; ++j)
      {
        for (int i = low[0]; i <= high[0]; ++i)
        {
          if (!f(k * plane + static_cast<vtkIdType>(j) * this->Size[0] + i, i - at[0], j - at[1],
                k - at[2]))
          {
            return false;
          }
        }
      }
    }
    return true;
  }

  // The part of voxel seed, all of one kind, which becomes another.
  void Fill(vtkIdType seed, std::uint8_t from, std::uint8_t to, std::vector<vtkIdType>& part)
  {
    constexpr int next[3] = { 1, 1, 1 };
    part.assign(1, seed);
    this->Of[seed] = to;
    for (std::size_t n = 0; n < part.size(); ++n)
    {
      this->Around(part[n], next,
        [&](vtkIdType q, int, int, int)
        {
          if (this->Of[q] == from)
          {
            this->Of[q] = to;
            part.push_back(q);
          }
          return true;
        });
    }
  }

  void Set(const std::vector<vtkIdType>& part, std::uint8_t kind)
  {
    for (const vtkIdType p : part)
    {
      this->Of[p] = kind;
    }
  }
};

// Which voxels are at or above the level. Throws std::runtime_error when none is.
void FindBone(vtkDataArray* scalars, double level, Kinds& kinds)
{
  kinds.Of.assign(static_cast<std::size_t>(scalars->GetNumberOfTuples()), Below);
  const bool isAny =
    lacuna::DispatchScalars(lacuna::ArrayScalarType::Get(scalars), scalars->GetVoidPointer(0),
      [&](const auto* values)
      {
        bool any = false;
        for (std::size_t p = 0; p < kinds.Of.size(); ++p)
        {
          if (static_cast<double>(values[p]) >= level)
          {
            kinds.Of[p] = Bone;
            any = true;
          }
        }
        return any;
      });
  if (!isAny)
  {
    double range[2];
    scalars->GetRange(range);
    throw std::runtime_error("no voxel is at or above Level, " + lacuna::FormatNumber(level) +
      "; the values are " + lacuna::FormatNumber(range[0]) + " to " +
      lacuna::FormatNumber(range[1]) + ". Lower Level");
  }
}

// What is bone and what is not; voxels that are Removed beforehand stay so.
void ChooseBone(Kinds& kinds, const double spacing[3], lacuna::AlgorithmExecution& execution)
{
  std::vector<vtkIdType> part;
  std::vector<vtkIdType> largest;
  std::vector<std::vector<vtkIdType>> small;
  const double voxel = std::abs(spacing[0] * spacing[1] * spacing[2]);
  const auto count = static_cast<vtkIdType>(kinds.Of.size());
  const auto isSmall = [&](const std::vector<vtkIdType>& voxels)
  { return static_cast<double>(voxels.size()) * voxel < 1000 * vtkLacunaSkullBone::SmallPart; };
  const auto put = [&](std::vector<vtkIdType>& voxels)
  {
    if (!voxels.empty() && isSmall(voxels))
    {
      small.emplace_back(voxels.begin(), voxels.end());
    }
  };
  for (vtkIdType p = 0; p < count; ++p)
  {
    if (p % (1 << 20) == 0)
    {
      execution.Report(static_cast<double>(p) / static_cast<double>(count));
    }
    if (kinds.Of[p] == Bone)
    {
      kinds.Fill(p, Bone, Removed, part);
      if (part.size() > largest.size())
      {
        part.swap(largest);
      }
      put(part);
    }
  }
  kinds.Set(largest, Kept);
  std::vector<vtkIdType>().swap(largest);
  // near in mm, of which the directions of a turned volume change nothing
  int reach[3];
  for (int a = 0; a < 3; ++a)
  {
    reach[a] = static_cast<int>(
      std::min(vtkLacunaSkullBone::Gap / std::abs(spacing[a]), 1.0 * kinds.Size[a]));
  }
  std::vector<const std::vector<vtkIdType>*> thin;
  for (const auto& voxels : small)
  {
    execution.Report(1);
    const auto isFar = [&](vtkIdType p)
    {
      return kinds.Around(p, reach,
        [&](vtkIdType q, int i, int j, int k)
        {
          return kinds.Of[q] != Kept ||
            std::hypot(i * spacing[0], j * spacing[1], k * spacing[2]) > vtkLacunaSkullBone::Gap;
        });
    };
    if (!std::all_of(voxels.begin(), voxels.end(), isFar))
    {
      thin.push_back(&voxels);
    }
  }
  for (const auto* voxels : thin) // all after the last look: the order has no say
  {
    kinds.Set(*voxels, Kept);
  }
}

// Marks what is below the level and within two voxels of what is removed, but not of kept bone.
void MarkHalo(Kinds& kinds)
{
  constexpr int reach[3] = { 2, 2, 2 };
  const auto count = static_cast<vtkIdType>(kinds.Of.size());
  for (vtkIdType p = 0; p < count; ++p)
  {
    if (kinds.Of[p] == Removed)
    {
      kinds.Around(p, reach,
        [&](vtkIdType q, int, int, int)
        {
          if (kinds.Of[q] == Below)
          {
            kinds.Of[q] = kinds.Around(q, reach,
                            [&](vtkIdType r, int, int, int) { return kinds.Of[r] != Kept; })
              ? Halo
              : BoneEdge;
          }
          return true;
        });
    }
  }
}

vtkSmartPointer<vtkPolyData> GetTriangles(vtkPolyData* surface)
{
  vtkNew<vtkTriangleFilter> filter;
  filter->SetInputData(surface);
  filter->PassLinesOff();
  filter->PassVertsOff();
  filter->Update();
  return filter->GetOutput();
}

// In voxels, a little aside: no row of voxels meets an edge or a corner exactly.
std::vector<lacuna::Vec3> GetPointsAside(vtkPolyData* triangles, vtkImageData* image)
{
  constexpr double aside[3] = { 0, 1.37e-6, 2.71e-6 };
  const int* extent = image->GetExtent();
  std::vector<lacuna::Vec3> points(static_cast<std::size_t>(triangles->GetNumberOfPoints()));
  for (std::size_t n = 0; n < points.size(); ++n)
  {
    double x[3];
    double index[3];
    triangles->GetPoint(static_cast<vtkIdType>(n), x);
    image->TransformPhysicalPointToContinuousIndex(x, index);
    for (int a = 0; a < 3; ++a)
    {
      points[n][a] = index[a] - extent[2 * a] + aside[a];
    }
  }
  return points;
}

// Where rows of voxels cross a triangle, by row. points: in voxels.
void AddCrossings(const std::vector<lacuna::Vec3>& points, const vtkIdType* t, const int size[3],
  std::vector<std::vector<double>>& crossings)
{
  // Of an edge seen along the rows: on which side of it a row is; of both its triangles the same number.
  const auto side = [&](vtkIdType a, vtkIdType b, double y, double z)
  {
    const lacuna::Vec3& p = points[static_cast<std::size_t>(std::min(a, b))];
    const lacuna::Vec3& q = points[static_cast<std::size_t>(std::max(a, b))];
    const double area = (q[1] - p[1]) * (z - p[2]) - (q[2] - p[2]) * (y - p[1]);
    return a < b ? area : -area;
  };
  int low[3];
  int high[3];
  for (int a = 1; a < 3; ++a)
  {
    const auto [least, most] = std::minmax({ points[t[0]][a], points[t[1]][a], points[t[2]][a] });
    low[a] = static_cast<int>(std::ceil(std::clamp(least, 0.0, 1.0 * size[a])));
    high[a] = static_cast<int>(std::floor(std::clamp(most, -1.0, size[a] - 1.0)));
  }
  for (int k = low[2]; k <= high[2]; ++k)
  {
    for (int j = low[1]; j <= high[1]; ++j)
    {
      const double w[3] = { side(t[1], t[2], j, k), side(t[2], t[0], j, k),
        side(t[0], t[1], j, k) };
      if ((w[0] > 0) == (w[1] > 0) && (w[1] > 0) == (w[2] > 0))
      {
        const double sum = w[0] + w[1] + w[2];
        if (sum != 0)
        {
          crossings[static_cast<std::size_t>(k) * size[1] + j].push_back(
            (w[0] * points[t[0]][0] + w[1] * points[t[1]][0] + w[2] * points[t[2]][0]) / sum);
        }
      }
    }
  }
}

// Takes away the bone within closed surfaces, in world coordinates.
void TakeAway(Kinds& kinds, vtkImageData* image, vtkPolyData* surface)
{
  if (vtkSelectEnclosedPoints::IsSurfaceClosed(surface) == 0)
  {
    throw std::runtime_error("Exclude is not a closed surface, so that it has no inside; close it, "
                             "as with Fill Holes or Clip Closed Surface");
  }
  const vtkSmartPointer<vtkPolyData> triangles = GetTriangles(surface);
  const std::vector<lacuna::Vec3> points = GetPointsAside(triangles, image);
  std::vector<std::vector<double>> crossings(
    static_cast<std::size_t>(kinds.Size[1]) * static_cast<std::size_t>(kinds.Size[2]));
  vtkCellArray* cells = triangles->GetPolys();
  for (vtkIdType c = 0; c < cells->GetNumberOfCells(); ++c)
  {
    vtkIdType size = 0;
    const vtkIdType* t = nullptr;
    cells->GetCellAtId(c, size, t);
    AddCrossings(points, t, kinds.Size, crossings);
  }
  // Between the first and second crossing of a row, the third and fourth, and so on, is the inside.
  for (std::size_t row = 0; row < crossings.size(); ++row)
  {
    std::vector<double>& at = crossings[row];
    std::sort(at.begin(), at.end());
    for (std::size_t n = 0; n + 1 < at.size(); n += 2)
    {
      const int first = static_cast<int>(std::ceil(std::clamp(at[n], 0.0, 1.0 * kinds.Size[0])));
      const int last =
        static_cast<int>(std::floor(std::clamp(at[n + 1], -1.0, kinds.Size[0] - 1.0)));
      for (int i = first; i <= last; ++i)
      {
        std::uint8_t& kind = kinds.Of[row * static_cast<std::size_t>(kinds.Size[0]) + i];
        if (kind == Bone)
        {
          kind = Removed;
        }
      }
    }
  }
}

// How far the kept bone is above the level on average.
template <class T>
double GetContrast(const T* values, const Kinds& kinds, double level)
{
  double sum = 0;
  vtkIdType kept = 0;
  for (std::size_t p = 0; p < kinds.Of.size(); ++p)
  {
    if (kinds.Of[p] == Kept && std::isfinite(static_cast<double>(values[p])))
    {
      sum += static_cast<double>(values[p]) - level;
      ++kept;
    }
  }
  return kept > 0 ? sum / static_cast<double>(kept) : 0;
}

// Lowers what was removed and its halo; returns the number of removed voxels.
template <class T>
vtkIdType Lower(T* values, const Kinds& kinds, double level, double contrast)
{
  vtkIdType removed = 0;
  const auto count = static_cast<vtkIdType>(kinds.Of.size());
  T lowest = std::numeric_limits<T>::max();
  for (vtkIdType p = 0; p < count; ++p)
  {
    lowest = std::min(lowest, values[p]); // a NaN is never less
    removed += kinds.Of[p] == Removed;
  }
  if (removed == 0)
  {
    return 0;
  }
  const double wanted = level - contrast;
  const auto least = static_cast<double>(std::numeric_limits<T>::lowest());
  T value = static_cast<T>(
    std::max(std::numeric_limits<T>::is_integer ? std::floor(wanted) : wanted, least));
  if (!(static_cast<double>(value) < level))
  {
    value = lowest; // bone is exactly at the level, as in a mask
  }
  if (!(static_cast<double>(value) < level))
  {
    throw std::runtime_error(
      "all voxels are at or above Level, so that nothing can be taken away; raise Level");
  }
  for (vtkIdType p = 0; p < count; ++p)
  {
    if (kinds.Of[p] == Removed || (kinds.Of[p] == Halo && values[p] > value))
    {
      values[p] = value;
    }
  }
  return removed;
}

// Voxels on an image's grid.
lacuna::VoxelVolume GetVolume(vtkImageData* image, const void* voxels, lacuna::ScalarType type)
{
  lacuna::VoxelVolume volume;
  volume.Voxels = voxels;
  volume.Type = type;
  image->GetDimensions(volume.Size.data());
  const int* extent = image->GetExtent();
  volume.IndexToWorld = lacuna::Matrix4(image->GetIndexToPhysicalMatrix()->GetData()) *
    lacuna::Matrix4::Translation({ 1.0 * extent[0], 1.0 * extent[2], 1.0 * extent[4] });
  return volume;
}

// Makes small holes bone; returns the number of voxels that became bone.
template <class T>
vtkIdType Bridge(T* values, const lacuna::VoxelVolume& volume, double level, double diameter,
  double contrast, lacuna::Execution& execution)
{
  // Linear over the depth, so that the surface at the level is where the depth is 0.
  double ramp = 0; // mm
  for (int a = 0; a < 3; ++a)
  {
    ramp = std::hypot(ramp, Norm(volume.IndexToWorld.Column(a)));
  }
  vtkIdType made = 0;
  for (const lacuna::BridgedVoxel& voxel : lacuna::BridgeHoles(volume, level, diameter, execution))
  {
    const double wanted = level + contrast * std::clamp(voxel.Depth / ramp, -1.0, 1.0);
    const double most = static_cast<double>(std::numeric_limits<T>::max());
    const T value = static_cast<T>(
      std::numeric_limits<T>::is_integer ? std::min(std::floor(wanted), most) : wanted);
    T& old = values[voxel.Index];
    // Without contrast, as in a mask of bone, nothing beside the bone gets the level.
    if (value > old && (voxel.Depth >= 0 || static_cast<double>(value) < level))
    {
      made += !(static_cast<double>(old) >= level) && static_cast<double>(value) >= level;
      old = value;
    }
  }
  return made;
}
}

//------------------------------------------------------------------------------
vtkLacunaSkullBone::vtkLacunaSkullBone()
{
  this->SetNumberOfInputPorts(2);
}

//------------------------------------------------------------------------------
double* vtkLacunaSkullBone::GetProposedLevelRange()
{
  this->ProposedLevelRange = lacuna::ProposedLevel::Get(this, {}, 300);
  // Thin bone in a voxel with tissue is below what a surface through thick bone needs.
  if (this->ProposedLevelRange[0] == 500)
  {
    this->ProposedLevelRange = { 300, 300 };
  }
  return this->ProposedLevelRange.data();
}

//------------------------------------------------------------------------------
void vtkLacunaSkullBone::SetExcludeConnection(vtkAlgorithmOutput* output)
{
  this->SetInputConnection(1, output);
}

void vtkLacunaSkullBone::RemoveExclude()
{
  this->SetInputConnection(1, nullptr);
}

//------------------------------------------------------------------------------
int vtkLacunaSkullBone::FillInputPortInformation(int port, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), port == 0 ? "vtkImageData" : "vtkPolyData");
  if (port == 1)
  {
    info->Set(vtkAlgorithm::INPUT_IS_OPTIONAL(), 1);
  }
  return 1;
}

//------------------------------------------------------------------------------
vtkDataArray* vtkLacunaSkullBone::GetCheckedScalars(vtkImageData* input) const
{
  lacuna::TrackedSlices::Refuse(input);
  lacuna::VolumeDirection::Check(input);
  vtkDataArray* scalars = input->GetPointData()->GetScalars();
  if (!scalars || scalars->GetNumberOfComponents() != 1)
  {
    throw std::runtime_error("the image has no active point scalars with one component; "
                             "choose an array with one value per voxel");
  }
  return scalars;
}

//------------------------------------------------------------------------------
void vtkLacunaSkullBone::Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution)
{
  auto* input = ports.GetInput<vtkImageData>();
  vtkDataArray* scalars = this->GetCheckedScalars(input);
  lacuna::RequireMemory("the bone",
    static_cast<double>(input->GetNumberOfPoints()) *
      (scalars->GetDataTypeSize() + 1 + sizeof(vtkIdType) / 4));
  const auto bone =
    vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(scalars->GetDataType()));
  lacuna::Arrays::Copy(scalars, bone);
  const lacuna::ScalarType type = lacuna::ArrayScalarType::Get(bone);
  Kinds kinds;
  input->GetDimensions(kinds.Size);
  FindBone(bone, this->Level, kinds);
  auto* exclude = ports.GetInput<vtkPolyData>(1);
  if (exclude && exclude->GetNumberOfCells() > 0)
  {
    TakeAway(kinds, input, exclude);
    if (std::find(kinds.Of.begin(), kinds.Of.end(), Bone) == kinds.Of.end())
    {
      throw std::runtime_error("no bone is left outside of Exclude; make its surfaces smaller");
    }
  }
  const double end = this->BridgeDiameter > 0 ? 0.5 : 1; // of all without bridges
  execution.SetStage(0, 0.8 * end);
  ChooseBone(kinds, input->GetSpacing(), execution);
  execution.SetStage(0.8 * end, end);
  MarkHalo(kinds);
  execution.Report(0.5);
  vtkIdType removed = 0;
  vtkIdType made = 0;
  lacuna::DispatchScalarType(type,
    [&](auto zero)
    {
      auto* values = static_cast<decltype(zero)*>(bone->GetVoidPointer(0));
      const double contrast = GetContrast(values, kinds, this->Level);
      removed = Lower(values, kinds, this->Level, contrast);
      if (this->BridgeDiameter > 0)
      {
        execution.SetStage(end, 1);
        made = Bridge(values, GetVolume(input, values, type), this->Level, this->BridgeDiameter,
          contrast, execution);
      }
    });

  auto* output = ports.GetOutput<vtkImageData>();
  output->ShallowCopy(input);
  output->GetPointData()->SetScalars(bone);
  const double* spacing = input->GetSpacing();
  lacuna::FieldData::Set(output, "BoneLevel", { this->Level }, 1);
  lacuna::FieldData::Set(output, "RemovedVolume",
    { static_cast<double>(removed) * std::abs(spacing[0] * spacing[1] * spacing[2]) / 1000 }, 1);
  lacuna::FieldData::Set(output, "BridgedVolume",
    { static_cast<double>(made) * std::abs(spacing[0] * spacing[1] * spacing[2]) / 1000 }, 1);
}

//------------------------------------------------------------------------------
void vtkLacunaSkullBone::Describe(lacuna::Properties& properties) const
{
  using lacuna::ValueRange;
  properties.Add("Level", this->Level, ValueRange::Any("HU"))
    .Add("BridgeDiameter", this->BridgeDiameter,
      ValueRange::Above(0, "mm").UpTo(MostBridge).OrZero("none"));
}
