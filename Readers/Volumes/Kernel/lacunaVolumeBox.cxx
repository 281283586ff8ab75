// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaVolumeBox.h"

#include "lacunaExecution.h"
#include "lacunaParameterText.h"
#include "lacunaPixelSource.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

namespace lacuna
{
namespace
{
// Newton's iteration for the rotation nearest to a matrix with unit columns that is not far from one.
Matrix4 FindNearestRotation(Matrix4 m)
{
  for (int step = 0; step < 30; ++step)
  {
    const Matrix4 inverse = m.Inverse();
    double change = 0;
    Matrix4 next;
    for (int row = 0; row < 3; ++row)
    {
      for (int column = 0; column < 3; ++column)
      {
        next(row, column) = 0.5 * (m(row, column) + inverse(column, row));
        change = std::max(change, std::abs(next(row, column) - m(row, column)));
      }
    }
    m = next;
    if (change < 1e-15)
    {
      break;
    }
  }
  return m;
}

double Length(const Vec3& v)
{
  return std::hypot(v[0], v[1], v[2]); // exact along an axis
}

template <class In, class Out>
void Convert(const In* in, Out* out, std::size_t count, double slope, double intercept)
{
  for (std::size_t i = 0; i < count; ++i)
  {
    out[i] = static_cast<Out>(slope * static_cast<double>(in[i]) + intercept);
  }
}
}

//------------------------------------------------------------------------------
VolumeBox FindVolumeBox(
  const Matrix4& indexToPatient, const std::array<std::int64_t, 3>& dimensions)
{
  if (!indexToPatient.IsFinite())
  {
    throw std::invalid_argument("the directions, distances or the place of the voxels are not "
                                "finite numbers");
  }
  VolumeBox grid;
  grid.Dimensions = dimensions;
  grid.Origin = indexToPatient.Column(3);
  std::array<Vec3, 3> steps{};
  for (int i = 0; i < 3; ++i)
  {
    const auto at = static_cast<std::size_t>(i);
    steps[at] = indexToPatient.Column(i);
    grid.Spacing[at] = Length(steps[at]);
    if (!(grid.Spacing[at] > 0 && std::isfinite(grid.Spacing[at])))
    {
      throw std::invalid_argument(
        "axis " + std::to_string(i) + " of the voxels (counted from 0) has no length");
    }
  }
  if (indexToPatient.Determinant3() < 0)
  {
    grid.ReversedSlices = true;
    grid.Origin = grid.Origin + static_cast<double>(dimensions[2] - 1) * steps[2];
    steps[2] = -1 * steps[2];
  }
  Matrix4 units;
  for (int i = 0; i < 3; ++i)
  {
    for (int row = 0; row < 3; ++row)
    {
      units(row, i) =
        steps[static_cast<std::size_t>(i)][row] / grid.Spacing[static_cast<std::size_t>(i)];
    }
  }
  double shift = std::numeric_limits<double>::infinity();
  if (units.Determinant3() > 0.5) // else far from right angles
  {
    const Matrix4 rotation = FindNearestRotation(units);
    shift = 0;
    for (int corner = 1; corner < 8; ++corner)
    {
      Vec3 error{ { 0, 0, 0 } };
      for (int i = 0; i < 3; ++i)
      {
        const auto at = static_cast<std::size_t>(i);
        grid.Axes[at] = rotation.Column(i);
        if (corner >> i & 1)
        {
          error = error +
            static_cast<double>(dimensions[at] - 1) * grid.Spacing[at] *
              (units.Column(i) - rotation.Column(i));
        }
      }
      shift = std::max(shift, Length(error));
    }
  }
  if (!(shift <= VolumeTolerance))
  {
    throw std::invalid_argument("the axes of the voxels are not at right angles: " +
      (std::isfinite(shift) ? "in a box with right angles a corner would be off by " +
            FormatNumber(std::ceil(shift * 1000) / 1000) + " mm"
                            : std::string("they are far from it")) +
      ". Resample the volume to a straight grid, for example in 3D Slicer by the module Resample "
      "Image (BRAINS); a CT with a tilted gantry is corrected from DICOM by CT Series Reader");
  }
  return grid;
}

//------------------------------------------------------------------------------
ScalarType GetVolumeType(ScalarType stored, double slope, double intercept)
{
  if (slope == 1 && intercept == 0)
  {
    return stored;
  }
  return DispatchScalarType(stored,
    [&](auto zero)
    {
      using T = decltype(zero);
      if (std::is_floating_point_v<T>)
      {
        return sizeof(T) == 4 ? ScalarType::Float32 : ScalarType::Float64;
      }
      if (slope == std::floor(slope) && intercept == std::floor(intercept))
      {
        const double a = slope * static_cast<double>(std::numeric_limits<T>::lowest()) + intercept;
        const double b = slope * static_cast<double>(std::numeric_limits<T>::max()) + intercept;
        const auto fits = [&](auto type)
        {
          using Out = decltype(type);
          return std::min(a, b) >= std::numeric_limits<Out>::lowest() &&
            std::max(a, b) <= std::numeric_limits<Out>::max();
        };
        if (fits(std::int16_t()) || fits(std::int32_t()))
        {
          return fits(std::int16_t()) ? ScalarType::Int16 : ScalarType::Int32;
        }
      }
      return sizeof(T) <= 2 ? ScalarType::Float32 : ScalarType::Float64;
    });
}

//------------------------------------------------------------------------------
void ReadVolume(const VolumeFile& file, const VolumeBox& grid, PixelSource& pixels,
  const std::array<int, 6>& extent, void* voxels, Execution& execution)
{
  const ScalarType stored = pixels.GetScalarType();
  const ScalarType type = GetVolumeType(stored, file.Slope, file.Intercept);
  const auto channels = static_cast<std::size_t>(file.Slices.Channels);
  const std::size_t elements =
    static_cast<std::size_t>(extent[1] - extent[0] + 1) * channels; // of a row
  const std::size_t rows = static_cast<std::size_t>(extent[3] - extent[2] + 1);
  const std::size_t outRow = elements * GetScalarSize(type);
  const std::size_t inVoxel = channels * GetScalarSize(stored);
  const std::size_t inRow = static_cast<std::size_t>(file.Slices.Columns) * inVoxel;
  const std::int64_t last = grid.Dimensions[2] - 1;
  const int slices = extent[5] - extent[4] + 1;
  std::vector<unsigned char> slice(static_cast<std::size_t>(pixels.GetFrameSize()));
  for (int n = 0; n < slices; ++n)
  {
    // in the order of the file, of which compressed ones are read from the beginning
    const int k = grid.ReversedSlices ? extent[5] - n : extent[4] + n;
    pixels.ReadFrame(grid.ReversedSlices ? last - k : k, slice.data());
    unsigned char* out =
      static_cast<unsigned char*>(voxels) + static_cast<std::size_t>(k - extent[4]) * rows * outRow;
    for (std::size_t row = 0; row < rows; ++row, out += outRow)
    {
      const unsigned char* in = slice.data() + (static_cast<std::size_t>(extent[2]) + row) * inRow +
        static_cast<std::size_t>(extent[0]) * inVoxel;
      if (file.Slope == 1 && file.Intercept == 0)
      {
        std::memcpy(out, in, outRow);
        continue;
      }
      DispatchScalars(stored, in,
        [&](const auto* from)
        {
          DispatchScalarType(type,
            [&](auto zero) {
              Convert(
                from, reinterpret_cast<decltype(zero)*>(out), elements, file.Slope, file.Intercept);
            });
        });
    }
    execution.Report(static_cast<double>(n + 1) / slices);
  }
}
}
