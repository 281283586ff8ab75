// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaMirror.h"

#include "lacunaArrayScalarType.h"
#include "lacunaArrays.h"
#include "lacunaCoordinates.h"
#include "lacunaDepthMap.h"
#include "lacunaFieldData.h"
#include "lacunaMemory.h"
#include "lacunaMirroredMap.h"
#include "lacunaMirroredVolume.h"
#include "lacunaVolumeDirection.h"
#include "lacunaVolumeSymmetry.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkCharArray.h"
#include "vtkDataArray.h"
#include "vtkDataSetAttributes.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationStringKey.h"
#include "vtkMatrix4x4.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

vtkStandardNewMacro(vtkLacunaMirror);

namespace
{
constexpr const char* AsymmetryName = "Asymmetry";
constexpr std::array<const char*, 2> PlaneMethodNames{ "BestSymmetry", "Given" };

using SDDP = vtkStreamingDemandDrivenPipeline;

template <class Array, class T>
vtkSmartPointer<Array> MakeArray(
  const std::string& name, const std::vector<T>& values, int components = 1)
{
  auto array = vtkSmartPointer<Array>::New();
  array->SetName(name.c_str());
  array->SetNumberOfComponents(components);
  lacuna::Arrays::SetNumberOfTuples(array, static_cast<vtkIdType>(values.size()) / components);
  std::copy(values.begin(), values.end(), array->GetPointer(0));
  return array;
}

// One component per point in plain memory; copies what is not so into keep.
vtkDataArray* GetPlain(vtkDataArray* array, vtkSmartPointer<vtkDataArray>& keep)
{
  if (array->HasStandardMemoryLayout())
  {
    return array;
  }
  keep.TakeReference(vtkDataArray::CreateDataArray(array->GetDataType()));
  lacuna::Arrays::Copy(array, keep);
  return keep;
}

// The image's vtkValidPointMask, or null. Throws when it has several components.
vtkDataArray* FindMask(vtkImageData* image)
{
  vtkDataArray* mask = image->GetPointData()->GetArray(lacuna::DepthMap::MaskName);
  if (mask && mask->GetNumberOfComponents() != 1)
  {
    throw std::runtime_error(
      std::string("point array '") + lacuna::DepthMap::MaskName + "' must have one component");
  }
  return mask;
}

// The active scalars, where they lie in the world, and which count. The image must live longer, and keep,
// which gets the voxels where they must be copied. Throws when they have not one component, or the
// direction has got lost.
lacuna::MaskedVolume GetVolume(vtkImageData* image, vtkSmartPointer<vtkDataArray>& keep)
{
  lacuna::VolumeDirection::Check(image);
  vtkDataArray* scalars = image->GetPointData()->GetScalars();
  if (!scalars || scalars->GetNumberOfComponents() != 1)
  {
    throw std::runtime_error("the image has no active point scalars with one component; colours "
                             "and vectors cannot be mirrored");
  }
  lacuna::MaskedVolume given;
  given.Volume.Type = lacuna::ArrayScalarType::Get(scalars);
  given.Volume.Voxels = GetPlain(scalars, keep)->GetVoidPointer(0);
  image->GetDimensions(given.Volume.Size.data());
  const int* extent = image->GetExtent();
  given.Volume.IndexToWorld = lacuna::Matrix4(image->GetIndexToPhysicalMatrix()->GetData()) *
    lacuna::Matrix4::Translation({ static_cast<double>(extent[0]), static_cast<double>(extent[2]),
      static_cast<double>(extent[4]) });
  if (vtkDataArray* mask = FindMask(image))
  {
    lacuna::RequireMemory(
      "the mask of the volume", static_cast<double>(given.Volume.NumberOfVoxels()));
    given.Valid.resize(static_cast<std::size_t>(given.Volume.NumberOfVoxels()));
    for (std::size_t i = 0; i < given.Valid.size(); ++i)
    {
      given.Valid[i] = mask->GetComponent(static_cast<vtkIdType>(i), 0) != 0;
    }
  }
  return given;
}

template <class T>
void Free(std::vector<T>& values)
{
  std::vector<T>().swap(values);
}

bool IsDepthMap(vtkImageData* image)
{
  return image->GetPointData()->GetArray(lacuna::DepthMap::DepthName) &&
    image->GetFieldData()->GetArray(lacuna::DepthMap::ImageToWorldName);
}

// Of data that may not have come: by the name, which is all that a reader tells of them.
bool IsAnnouncedDepthMap(vtkInformation* info)
{
  vtkImageData* image = vtkImageData::GetData(info);
  if (image && image->GetNumberOfPoints() > 0)
  {
    return IsDepthMap(image);
  }
  vtkInformation* scalars = vtkDataObject::GetActiveFieldInformation(
    info, vtkDataObject::FIELD_ASSOCIATION_POINTS, vtkDataSetAttributes::SCALARS);
  const char* name = scalars ? scalars->Get(vtkDataObject::FIELD_NAME()) : nullptr;
  return name && lacuna::DepthMap::DepthName == std::string(name);
}

// What is asked for of an image; empty: nothing.
std::array<int, 6> FindPiece(const lacuna::Ports& ports, const int* extent)
{
  const bool isWanted = ports.IsAsked();
  vtkInformation* info = ports.GetOutputInformation();
  const int* asked = info->Has(SDDP::UPDATE_EXTENT()) ? info->Get(SDDP::UPDATE_EXTENT()) : extent;
  std::array<int, 6> piece;
  for (std::size_t c = 0; c < 3; ++c)
  {
    piece[2 * c] = isWanted ? std::max(asked[2 * c], extent[2 * c]) : extent[2 * c];
    piece[2 * c + 1] = isWanted ? std::min(asked[2 * c + 1], extent[2 * c + 1]) : extent[2 * c] - 1;
  }
  return piece;
}

std::string Rounded(double value)
{
  return lacuna::FormatNumber(std::round(1000 * value) / 1000);
}
}

//------------------------------------------------------------------------------
class vtkLacunaMirror::Internals
{
public:
  // What is found of the data, and the outcome.
  struct Result
  {
    lacuna::MirrorPlane Plane;
    bool IsFound = false; ///< and not given
    double Ambiguity = 0;
    double Score = 0;
    double Overlap = 0;
    double RMS = 0;
    double Median = std::numeric_limits<double>::quiet_NaN();
  };

  Result Found;

  template <class Data>
  static void ChoosePlane(
    vtkLacunaMirror* self, const Data& data, Result& result, lacuna::AlgorithmExecution& execution)
  {
    execution.SetStage(0, 0.5);
    if (self->PlaneMethod == BestSymmetry)
    {
      const lacuna::SymmetryResult found = FindSymmetryPlane(data, execution);
      result.Plane = found.Plane;
      result.Ambiguity = found.Ambiguity;
      result.IsFound = true;
    }
    else
    {
      const lacuna::Vec3 normal{ self->Normal[0], self->Normal[1], self->Normal[2] };
      const lacuna::Vec3 origin{ self->Origin[0], self->Origin[1], self->Origin[2] };
      if (!HasDirection(normal))
      {
        throw std::runtime_error("Normal must not be 0 0 0, nor too long");
      }
      result.Plane.Normal = Normalized(normal);
      result.Plane.Offset = Dot(result.Plane.Normal, origin);
    }
    // one of both ways to write the same plane
    const lacuna::Vec3& n = result.Plane.Normal;
    int largest = 0;
    for (int a = 1; a < 3; ++a)
    {
      largest = std::abs(n[a]) > std::abs(n[largest]) ? a : largest;
    }
    if (n[largest] < 0)
    {
      result.Plane = { -1 * n, -result.Plane.Offset };
    }
    execution.SetStage(0.5, 1);
  }

  // Leaves of output, the input, the mirror image of a piece; result: is found, unless it is known.
  static void MirrorVolume(vtkLacunaMirror* self, vtkImageData* output, const int* piece,
    bool isKnown, const lacuna::Ranks& ranks, Result& result, lacuna::AlgorithmExecution& execution)
  {
    lacuna::MaskedVolume given;
    vtkSmartPointer<vtkDataArray> keep;
    const auto prepare = [&]
    {
      given = GetVolume(output, keep);
      if (!isKnown)
      {
        ChoosePlane(self, given, result, execution);
      }
    };
    ranks.Together(prepare);
    const int* extent = output->GetExtent();
    lacuna::VolumePart part;
    for (std::size_t c = 0; c < 6; ++c)
    {
      part[c] = piece[c] - extent[c / 2 * 2];
    }
    lacuna::MirroredVolume mirrored = lacuna::MirrorVolume(given, result.Plane,
      static_cast<lacuna::MirrorInterpolation>(self->Interpolation), part, !isKnown, ranks,
      execution);
    if (!isKnown)
    {
      result.Score = mirrored.Score;
      result.Overlap = mirrored.Overlap;
      result.RMS = mirrored.RMS;
    }
    if (result.Overlap == 0)
    {
      throw std::runtime_error("no valid voxel has its mirror image within the volume: the plane "
                               "does not pass through the data");
    }

    vtkDataArray* scalars = output->GetPointData()->GetScalars();
    vtkSmartPointer<vtkDataArray> image;
    image.TakeReference(vtkDataArray::CreateDataArray(scalars->GetDataType()));
    image->SetName(
      (std::string("Mirrored") + (scalars->GetName() ? scalars->GetName() : "")).c_str());
    lacuna::Arrays::SetNumberOfTuples(image, static_cast<vtkIdType>(mirrored.Valid.size()));
    std::memcpy(image->GetVoidPointer(0), mirrored.Voxels.data(), mirrored.Voxels.size());
    Free(mirrored.Voxels); // one array at a time is there twice
    vtkPointData* points = output->GetPointData();
    points->Initialize();
    output->SetExtent(piece[0], piece[1], piece[2], piece[3], piece[4], piece[5]);
    points->SetScalars(image);
    points->AddArray(MakeArray<vtkCharArray>(lacuna::DepthMap::MaskName, mirrored.Valid));
    Free(mirrored.Valid);
    points->AddArray(MakeArray<vtkFloatArray>(AsymmetryName, mirrored.Asymmetry));
  }

  static void MirrorMap(vtkLacunaMirror* self, vtkImageData* output, Result& result,
    lacuna::AlgorithmExecution& execution)
  {
    const lacuna::DepthMap contract(output);
    if (contract.IsPerspective())
    {
      throw std::runtime_error("this is a perspective depth map; only parallel ones are mirrored");
    }
    std::vector<double> depth(static_cast<std::size_t>(output->GetNumberOfPoints()));
    vtkDataArray* mask = FindMask(output);
    for (std::size_t i = 0; i < depth.size(); ++i)
    {
      const auto p = static_cast<vtkIdType>(i);
      depth[i] = !mask || mask->GetComponent(p, 0) != 0 ? contract.GetDepth()->GetComponent(p, 0)
                                                        : std::numeric_limits<double>::quiet_NaN();
    }
    std::vector<float> normals;
    if (vtkDataArray* array = output->GetPointData()->GetArray(lacuna::DepthMap::NormalsName))
    {
      if (array->GetNumberOfComponents() != 3)
      {
        throw std::runtime_error(std::string("point array '") + lacuna::DepthMap::NormalsName +
          "' of the depth map must have three components");
      }
      for (vtkIdType i = 0; i < 3 * output->GetNumberOfPoints(); ++i)
      {
        normals.push_back(static_cast<float>(array->GetComponent(i / 3, static_cast<int>(i % 3))));
      }
    }
    lacuna::DepthGrid grid;
    grid.Depth = depth.data();
    std::copy_n(output->GetExtent(), 4, grid.Extent.begin());
    grid.ImageToWorld = contract.GetImageToWorld();
    ChoosePlane(self, grid, result, execution);
    const lacuna::MirroredMap mirrored = lacuna::MirrorMap(
      grid, normals.empty() ? nullptr : normals.data(), result.Plane, {}, execution);
    if (mirrored.Overlap == 0)
    {
      throw std::runtime_error("nowhere is the mirrored surface seen beside the given one: this "
                               "view does not show both sides of the plane. Cast the map along "
                               "the plane, or mirror the volume and cast that");
    }
    result.Score = mirrored.Score;
    result.Overlap = mirrored.Overlap;
    result.RMS = mirrored.RMS;
    result.Median = mirrored.Median;

    std::vector<char> valid(depth.size());
    std::transform(mirrored.Depth.begin(), mirrored.Depth.end(), valid.begin(),
      [](double d) { return static_cast<char>(!std::isnan(d)); });
    vtkPointData* points = output->GetPointData();
    points->Initialize();
    points->SetScalars(MakeArray<vtkDoubleArray>(lacuna::DepthMap::DepthName, mirrored.Depth));
    points->AddArray(MakeArray<vtkCharArray>(lacuna::DepthMap::MaskName, valid));
    if (!mirrored.Normals.empty())
    {
      points->SetNormals(
        MakeArray<vtkFloatArray>(lacuna::DepthMap::NormalsName, mirrored.Normals, 3));
    }
    points->AddArray(MakeArray<vtkDoubleArray>(AsymmetryName, mirrored.Asymmetry));
  }

  // Says where the symmetry is not what one would want.
  static void Warn(vtkLacunaMirror* self, const Result& result)
  {
    if (std::isnan(result.Score))
    {
      vtkWarningWithObjectMacro(self,
        << "there is no SymmetryScore: all values on both sides of the plane are equal, or there "
           "are none");
    }
    else if (result.Score < PoorScore)
    {
      vtkWarningWithObjectMacro(self,
        << "the symmetry is poor: the score is " << Rounded(result.Score)
        << " (1 is perfect). Look at Asymmetry before the mirrored data are used for anything");
    }
    if (result.IsFound && result.Ambiguity > HighAmbiguity)
    {
      vtkWarningWithObjectMacro(
        self, << "the plane of symmetry is ambiguous: another one is nearly as "
              << "good (SymmetryAmbiguity is " << Rounded(result.Ambiguity)
              << "; 1 is equal). Look at the plane, and give it if this is not the one");
    }
  }

  // The point of the plane nearest to the middle of the data.
  static lacuna::Vec3 OriginOf(vtkImageData* image, const lacuna::MirrorPlane& plane)
  {
    lacuna::Vec3 center{ 0, 0, 0 };
    image->GetCenter(center.data());
    return center - plane.Distance(center) * plane.Normal;
  }

  static void MakeSquare(vtkImageData* image, const lacuna::MirrorPlane& plane, vtkPolyData* square)
  {
    const lacuna::Vec3 origin = OriginOf(image, plane);
    const lacuna::Vec3& n = plane.Normal;
    lacuna::Vec3 axis{ 0, 0, 0 };
    axis[std::abs(n[2]) < 0.9 ? 2 : 1] = 1;
    const lacuna::Vec3 u = Normalized(Cross(axis, n));
    const lacuna::Vec3 v = Cross(n, u);
    const double half = image->GetLength() / 2;
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    for (const auto& corner : { lacuna::Vec2{ -1, -1 }, { 1, -1 }, { 1, 1 }, { -1, 1 } })
    {
      const lacuna::Vec3 p = origin + (half * corner[0]) * u + (half * corner[1]) * v;
      points->InsertNextPoint(p.data());
    }
    vtkNew<vtkCellArray> cells;
    cells->InsertNextCell({ 0, 1, 2, 3 });
    square->SetPoints(points);
    square->SetPolys(cells);
  }

  static void AddFieldData(vtkDataObject* data, const Result& result)
  {
    lacuna::FieldData::Set(data, "SymmetryScore", { result.Score }, 1);
    lacuna::FieldData::Set(data, "SymmetryOverlap", { result.Overlap }, 1);
    if (result.IsFound)
    {
      lacuna::FieldData::Set(data, "SymmetryAmbiguity", { result.Ambiguity }, 1);
    }
    lacuna::FieldData::Set(data, "AsymmetryRMS", { result.RMS }, 1);
    if (!std::isnan(result.Median))
    {
      lacuna::FieldData::Set(data, "AsymmetryMedian", { result.Median }, 1);
    }
  }
};

//------------------------------------------------------------------------------
vtkLacunaMirror::vtkLacunaMirror()
{
  this->Sharing = lacuna::Share::Together;
  this->SetNumberOfOutputPorts(2);
}

vtkLacunaMirror::~vtkLacunaMirror() = default;

//------------------------------------------------------------------------------
int vtkLacunaMirror::FillOutputPortInformation(int port, vtkInformation* info)
{
  info->Set(vtkDataObject::DATA_TYPE_NAME(), port == 0 ? "vtkImageData" : "vtkPolyData");
  return 1;
}

//------------------------------------------------------------------------------
void vtkLacunaMirror::Announce(const lacuna::Ports& ports)
{
  vtkInformation* info = ports.GetOutputInformation();
  info->Set(vtkAlgorithm::CAN_PRODUCE_SUB_EXTENT(), 1); // each rank makes its part
  // a volume keeps its type; depths may come in any, and become double
  if (IsAnnouncedDepthMap(ports.GetInputInformation()))
  {
    vtkDataObject::SetPointDataActiveScalarInfo(info, VTK_DOUBLE, 1);
  }
}

//------------------------------------------------------------------------------
// Any voxel may be the image of any other, and the plane depends on all. All ranks judge together.
void vtkLacunaMirror::Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution)
{
  auto* input = ports.GetInput<vtkImageData>();
  const bool isWanted = ports.IsAsked();
  const bool ranksMeet = !ports.HaveMet;
  const lacuna::Ranks& ranks = ports.Ranks;
  bool isMap = false;
  const auto check = [&]
  {
    if (lacuna::Coordinates::IsMirrored(input))
    {
      throw std::runtime_error("the input is a mirror image already (field data Mirrored); mirror "
                               "the original");
    }
    isMap = IsDepthMap(input);
  };
  // What is wrong on one rank only may not keep the others waiting.
  ranks.Together(check);
  isMap = !ranks.AllFine(!isMap);
  const std::array<int, 6> piece = FindPiece(ports, input->GetExtent());
  vtkNew<vtkImageData> mirrored;
  mirrored->ShallowCopy(input);
  mirrored->GetCellData()->Initialize();
  Internals::Result result;
  if (isMap && isWanted)
  {
    Internals::MirrorMap(this, mirrored, result, execution);
    mirrored->Crop(piece.data());
  }
  else if (!isMap)
  {
    if (!ranksMeet)
    {
      result = this->Kept->Found;
    }
    if (ranksMeet || isWanted)
    {
      Internals::MirrorVolume(this, mirrored, piece.data(), !ranksMeet, ranks, result, execution);
    }
    if (ranksMeet)
    {
      this->Kept = std::make_shared<const Internals>(Internals{ result });
    }
  }
  if (!isWanted)
  {
    return; // the others have their parts
  }
  Internals::Warn(this, result);

  const lacuna::Vec3 origin = Internals::OriginOf(input, result.Plane);
  lacuna::Properties parameters;
  parameters.Add("PlaneMethod", this->PlaneMethod, PlaneMethodNames)
    .Add("Origin", origin.Elements)
    .Add("Normal", result.Plane.Normal.Elements);
  if (!isMap)
  {
    parameters.Add("Interpolation", this->Interpolation, lacuna::MirrorInterpolationNames);
  }
  this->Made = parameters.GetText();
  auto* plane = ports.GetOutput<vtkPolyData>(1);
  if (ports.IsFirst())
  {
    Internals::MakeSquare(input, result.Plane, plane); // one is enough
  }
  lacuna::VolumeDirection::Remove(plane);
  for (vtkDataObject* data :
    { static_cast<vtkDataObject*>(mirrored), static_cast<vtkDataObject*>(plane) })
  {
    Internals::AddFieldData(data, result);
  }
  lacuna::Coordinates::MarkMirrored(mirrored, origin, result.Plane.Normal);
  ports.GetOutput<vtkImageData>()->ShallowCopy(mirrored);
}

//------------------------------------------------------------------------------
void vtkLacunaMirror::Describe(lacuna::Properties& properties) const
{
  properties.Add("PlaneMethod", this->PlaneMethod, PlaneMethodNames)
    .Add("Origin", this->Origin, lacuna::ValueRange::Any("mm"))
    .Add("Normal", this->Normal, lacuna::ValueRange::Any())
    .Add("Interpolation", this->Interpolation, lacuna::MirrorInterpolationNames);
}

//------------------------------------------------------------------------------
std::string vtkLacunaMirror::Parameters(int) const
{
  return this->Made;
}
