// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaAttenuationField.h"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace lacuna
{
namespace
{
constexpr std::int64_t Block = 16; // values of a cache line

template <class Value>
void SwapPlane(Value* values, std::int64_t nx, std::int64_t ny, std::vector<Value>& copy)
{
  copy.assign(values, values + nx * ny);
  for (std::int64_t y0 = 0; y0 < ny; y0 += Block)
  {
    for (std::int64_t x0 = 0; x0 < nx; x0 += Block)
    {
      for (std::int64_t x = x0; x < std::min(nx, x0 + Block); ++x)
      {
        for (std::int64_t y = y0; y < std::min(ny, y0 + Block); ++y)
        {
          values[x * ny + y] = copy[y * nx + x];
        }
      }
    }
  }
}
}

AttenuationField::AttenuationField(
  const std::array<std::int64_t, 3>& dimensions, const Vec3& spacing)
  : Dimensions(dimensions)
  , Strides{}
  , Spacing(spacing)
  , Flat(dimensions[2] == 1)
{
  if (dimensions[0] < 2 || dimensions[1] < 2 || dimensions[2] < 1)
  {
    throw std::invalid_argument("an occluded angle needs an image of at least 2 x 2 voxels, not " +
      std::to_string(dimensions[0]) + " x " + std::to_string(dimensions[1]) + " x " +
      std::to_string(dimensions[2]));
  }
  if (!IsFinite(spacing) || !(spacing[0] > 0 && spacing[1] > 0 && spacing[2] > 0))
  {
    throw std::invalid_argument("the spacing of the image must be positive in every direction");
  }
  const std::int64_t border = this->Flat ? 0 : 2;
  this->Strides = { 1, dimensions[0] + 2, (dimensions[0] + 2) * (dimensions[1] + 2) };
  this->Values.assign(this->Strides[2] * (dimensions[2] + border), 0.0F);
}

double AttenuationField::GetShortestEdge() const
{
  const double inPlane = std::min(this->Spacing[0], this->Spacing[1]);
  return this->Flat ? inPlane : std::min(inPlane, this->Spacing[2]);
}

std::int64_t AttenuationField::GetNumberOfVoxels() const
{
  return this->Dimensions[0] * this->Dimensions[1] * this->Dimensions[2];
}

float* AttenuationField::Row(std::int64_t j, std::int64_t k)
{
  return this->Values.data() + (k + (this->Flat ? 0 : 1)) * this->Strides[2] +
    (j + 1) * this->Strides[1] + 1;
}

const float* AttenuationField::Row(std::int64_t j, std::int64_t k) const
{
  return const_cast<AttenuationField*>(this)->Row(j, k);
}

void AttenuationField::SwapXY(Execution& execution)
{
  const std::int64_t planes = this->Dimensions[2] + (this->Flat ? 0 : 2);
  lacuna::SwapXY(
    this->Values.data(), this->Dimensions[0] + 2, this->Dimensions[1] + 2, planes, execution);
  std::swap(this->Dimensions[0], this->Dimensions[1]);
  std::swap(this->Spacing[0], this->Spacing[1]);
  this->Strides[1] = this->Dimensions[0] + 2;
}

template <class Value>
void SwapXY(
  Value* values, std::int64_t nx, std::int64_t ny, std::int64_t planes, Execution& execution)
{
  execution.For(planes, 4,
    [&](std::int64_t begin, std::int64_t end)
    {
      std::vector<Value> copy;
      for (std::int64_t k = begin; k < end; ++k)
      {
        SwapPlane(values + k * nx * ny, nx, ny, copy);
      }
    });
}

template void SwapXY(float*, std::int64_t, std::int64_t, std::int64_t, Execution&);
template void SwapXY(std::uint32_t*, std::int64_t, std::int64_t, std::int64_t, Execution&);
template void SwapXY(std::uint64_t*, std::int64_t, std::int64_t, std::int64_t, Execution&);
}
