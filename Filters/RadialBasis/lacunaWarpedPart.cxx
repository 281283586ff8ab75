// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaWarpedPart.h"

#include "lacunaArrays.h"
#include "lacunaDepthMap.h"
#include "lacunaMemory.h"
#include "vtkCharArray.h"
#include "vtkDoubleArray.h"
#include "vtkImageData.h"
#include "vtkImageInterpolator.h"
#include "vtkLacunaRBFImageWarp.h"
#include "vtkPointData.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace
{
// Of a voxel: so near to one a place is on it, and its neighbours have no say.
constexpr double RoundOff = 1e-9;

// vtkImageInterpolator knows no integers of 64 bits, and leaves grey levels undefined then.
bool IsInterpolable(vtkDataArray* scalars)
{
  return scalars->GetDataTypeSize() < 8 || scalars->GetDataType() == VTK_DOUBLE;
}

// The largest number of the scalars' type that a double can be.
double GetLargest(vtkDataArray* scalars)
{
  const double largest = scalars->GetDataTypeMax(); // of 64 bits: one more, rounded
  return IsInterpolable(scalars) ? largest : std::nextafter(largest, 0);
}

vtkSmartPointer<vtkDataArray> GetInterpolable(vtkDataArray* scalars)
{
  if (IsInterpolable(scalars))
  {
    return scalars;
  }
  lacuna::RequireMemory("a copy of the grey levels, which have 64 bits",
    static_cast<double>(scalars->GetNumberOfValues()) * sizeof(double));
  auto doubles = vtkSmartPointer<vtkDoubleArray>::New();
  lacuna::Arrays::Copy(scalars, doubles);
  return doubles;
}
}

//------------------------------------------------------------------------------
// Which places of the image have grey levels that count, by its vtkValidPointMask.
class lacuna::WarpedPart::ValidPlaces
{
public:
  ValidPlaces(vtkImageData* image, int interpolation)
    : Interpolation(interpolation)
  {
    image->GetDimensions(this->Size);
    image->GetExtent(this->Extent);
    vtkDataArray* mask = image->GetPointData()->GetArray(lacuna::DepthMap::MaskName);
    const vtkIdType count = mask ? mask->GetNumberOfTuples() : 0;
    lacuna::RequireMemory("the mask of the image", static_cast<double>(count));
    this->Mask.resize(static_cast<std::size_t>(count));
    for (vtkIdType i = 0; i < count; ++i)
    {
      this->Mask[static_cast<std::size_t>(i)] = mask->GetComponent(i, 0) != 0 ? 1 : 0;
    }
  }

  // Whether all voxels that interpolation at a place needs are valid: those whose weight is not 0.
  bool Has(const double* index) const
  {
    if (this->Mask.empty())
    {
      return true;
    }
    int first[3];
    int last[3];
    for (int c = 0; c < 3; ++c)
    {
      const double place = index[c] - this->Extent[2 * c];
      const bool nearest = this->Interpolation == vtkLacunaRBFImageWarp::Nearest;
      const double below = std::floor(nearest ? place + 0.5 : place);
      const int wide = this->Interpolation == vtkLacunaRBFImageWarp::CubicInterpolation ? 1 : 0;
      const bool between = !nearest && place > below;
      first[c] = this->Clamp(static_cast<int>(below) - (between ? wide : 0), c);
      last[c] = this->Clamp(static_cast<int>(below) + (between ? 1 + wide : 0), c);
    }
    for (std::int64_t k = first[2]; k <= last[2]; ++k)
    {
      for (std::int64_t j = first[1]; j <= last[1]; ++j)
      {
        const std::int64_t row = (k * this->Size[1] + j) * this->Size[0];
        for (std::int64_t i = first[0]; i <= last[0]; ++i)
        {
          if (this->Mask[row + i] == 0)
          {
            return false;
          }
        }
      }
    }
    return true;
  }

  // The point of the image next to a place, as vtkImageInterpolator takes it.
  vtkIdType GetNearest(const double* index) const
  {
    vtkIdType point = 0;
    for (int c = 2; c >= 0; --c)
    {
      const double place = index[c] - this->Extent[2 * c];
      point = point * this->Size[c] + this->Clamp(static_cast<int>(std::floor(place + 0.5)), c);
    }
    return point;
  }

private:
  int Clamp(int i, int axis) const { return std::min(std::max(i, 0), this->Size[axis] - 1); }

  int Interpolation;
  int Size[3];
  int Extent[6];
  std::vector<char> Mask; // empty: all are valid
};

//------------------------------------------------------------------------------
lacuna::WarpedPart::WarpedPart(vtkImageData* image, vtkDataArray* scalars, int interpolation,
  double outsideValue, const Box& part)
  : OutsideValue(outsideValue)
  , Part(part)
  , Components(scalars->GetNumberOfComponents())
  , Low(scalars->GetDataTypeMin())
  , High(GetLargest(scalars))
  , Integral(scalars->GetDataType() != VTK_FLOAT && scalars->GetDataType() != VTK_DOUBLE)
  , Warped(vtkSmartPointer<vtkDataArray>::Take(scalars->NewInstance()))
  , Places(std::make_unique<const ValidPlaces>(image, interpolation))
{
  vtkIdType count = 1;
  for (std::size_t c = 0; c < 3; ++c)
  {
    this->Stride[c] = count;
    count *= part[2 * c + 1] - part[2 * c] + 1;
  }
  this->Warped->SetName(scalars->GetName());
  this->Warped->SetNumberOfComponents(this->Components);
  lacuna::Arrays::SetNumberOfTuples(this->Warped, count);
  this->Valid->SetName(lacuna::DepthMap::MaskName);
  lacuna::Arrays::SetNumberOfTuples(this->Valid, count);
  vtkNew<vtkImageData> input; // with the scalars that shall be warped as the active ones
  input->ShallowCopy(image);
  input->GetPointData()->SetScalars(GetInterpolable(scalars));
  if (interpolation == vtkLacunaRBFImageWarp::Nearest && !IsInterpolable(scalars))
  {
    this->Copied = scalars;
  }
  this->Interpolator->SetInterpolationMode(interpolation);
  this->Interpolator->SetOutValue(outsideValue);
  this->Interpolator->Initialize(input);
  this->Interpolator->Update();
}

lacuna::WarpedPart::~WarpedPart() = default;

//------------------------------------------------------------------------------
void lacuna::WarpedPart::Set(const int* voxel, double* index, std::vector<double>& tuple)
{
  vtkIdType i = 0;
  for (std::size_t c = 0; c < 3; ++c)
  {
    const double nearest = std::floor(index[c] + 0.5);
    index[c] = std::abs(index[c] - nearest) <= RoundOff ? nearest : index[c];
    i += (voxel[c] - this->Part[2 * c]) * this->Stride[c];
  }
  bool known = this->Interpolator->CheckBoundsIJK(index) && this->Places->Has(index);
  if (known)
  {
    this->Interpolator->InterpolateIJK(index, tuple.data());
    known = std::none_of(tuple.begin(), tuple.end(), [](double v) { return std::isnan(v); });
  }
  else
  {
    std::fill(tuple.begin(), tuple.end(), this->OutsideValue);
  }
  if (known && this->Copied) // a double does not hold all labels of 64 bits
  {
    this->Warped->SetTuple(i, this->Places->GetNearest(index), this->Copied);
  }
  for (int k = 0; k < this->Components && !(known && this->Copied); ++k)
  {
    const double value = this->Integral
      ? std::floor(std::min(std::max(tuple[k], this->Low), this->High) + 0.5)
      : tuple[k];
    this->Warped->SetComponent(i, k, value);
  }
  this->Valid->SetValue(i, known ? 1 : 0);
}

//------------------------------------------------------------------------------
vtkDataArray* lacuna::WarpedPart::GetValid() const
{
  return this->Valid;
}
