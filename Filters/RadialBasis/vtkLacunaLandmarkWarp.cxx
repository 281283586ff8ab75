// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaLandmarkWarp.h"

#include "vtkDataSet.h"
#include "vtkImageData.h"
#include "vtkLacunaExecution.h"
#include "vtkMatrix3x3.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace
{
// The determinant of the affine map that fits best has the sign of that of the covariance of targets and landmarks.
bool TurnsOver(const std::vector<int>& axes, const std::vector<std::array<double, 3>>& landmarks,
  const std::vector<std::array<double, 3>>& targets)
{
  const double weight = 1.0 / static_cast<double>(targets.size());
  std::array<double, 3> from{};
  std::array<double, 3> to{};
  for (std::size_t i = 0; i < targets.size(); ++i)
  {
    for (std::size_t c = 0; c < 3; ++c)
    {
      from[c] += weight * landmarks[i][c];
      to[c] += weight * targets[i][c];
    }
  }
  double covariance[3][3] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };
  for (std::size_t r = 0; r < axes.size(); ++r)
  {
    for (std::size_t c = 0; c < axes.size(); ++c)
    {
      covariance[r][c] = 0;
      for (std::size_t i = 0; i < targets.size(); ++i)
      {
        covariance[r][c] +=
          weight * (landmarks[i][axes[r]] - from[axes[r]]) * (targets[i][axes[c]] - to[axes[c]]);
      }
    }
  }
  return vtkMatrix3x3::Determinant(&covariance[0][0]) <= 0;
}
}

//------------------------------------------------------------------------------
vtkLacunaVoxelSpace::vtkLacunaVoxelSpace(vtkImageData* image)
  : Image(image)
{
  image->GetDimensions(this->Size);
  image->GetSpacing(this->Spacing);
  image->GetExtent(this->Extent);
  for (int c = 0; c < 3; ++c)
  {
    if (this->Size[c] > 1)
    {
      this->Axes.push_back(c);
    }
  }
}

//------------------------------------------------------------------------------
std::vector<std::array<double, 3>> vtkLacunaVoxelSpace::GetPoints(vtkDataSet* points) const
{
  std::vector<std::array<double, 3>> own(static_cast<std::size_t>(points->GetNumberOfPoints()));
  for (vtkIdType i = 0; i < points->GetNumberOfPoints(); ++i)
  {
    double world[3];
    double index[3];
    points->GetPoint(i, world);
    this->Image->TransformPhysicalPointToContinuousIndex(world, index);
    for (std::size_t c = 0; c < 3; ++c)
    {
      own[static_cast<std::size_t>(i)][c] = (index[c] - this->Extent[2 * c]) * this->Spacing[c];
    }
  }
  return own;
}

//------------------------------------------------------------------------------
template <int Dimension>
vtkLacunaLandmarkWarp<Dimension>::vtkLacunaLandmarkWarp(vtkLacunaExecution& execution,
  const vtkLacunaVoxelSpace& space, const Points& landmarks, const Points& targets,
  lacuna::RadialBasisOptions options, double accuracy)
  : Space(space)
{
  std::vector<std::array<double, Dimension>> nodes(targets.size());
  std::vector<std::vector<double>> values(Dimension, std::vector<double>(targets.size()));
  double smallest = space.Spacing[space.Axes[0]];
  double largest = 0;
  for (int c = 0; c < Dimension; ++c)
  {
    const int axis = space.Axes[c];
    smallest = std::min(smallest, space.Spacing[axis]);
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for (std::size_t i = 0; i < targets.size(); ++i)
    {
      nodes[i][c] = targets[i][axis];
      values[c][i] = landmarks[i][axis] - targets[i][axis];
      low = std::min(low, targets[i][axis]);
      high = std::max(high, targets[i][axis]);
    }
    this->Box[2 * axis] = std::floor(low / space.Spacing[axis]);
    this->Box[2 * axis + 1] = std::ceil(high / space.Spacing[axis]);
    const auto range = std::minmax_element(values[c].begin(), values[c].end());
    largest = targets.empty() ? 0 : std::max(largest, *range.second - *range.first);
  }
  // of each component, so that positions keep it
  const double wanted = accuracy * smallest / std::sqrt(Dimension);
  options.Accuracy = largest > 0 ? std::min(0.5, wanted / largest) : 0.5;
  execution.SetStage(0, 0.3);
  const lacuna::RadialBasis<Dimension> function(execution, nodes, values, options);
  this->Report = function.GetReport();
  this->Mirrored = TurnsOver(space.Axes, landmarks, targets);
  if (this->Mirrored)
  {
    return; // such a warp is not used
  }

  lacuna::RegularGrid<Dimension> grid;
  for (int c = 0; c < Dimension; ++c)
  {
    grid.Spacing[c] = space.Spacing[space.Axes[c]];
    grid.Size[c] = space.Size[space.Axes[c]];
  }
  for (int c = 0; c < Dimension; ++c)
  {
    execution.SetStage(0.3 + 0.3 * c / Dimension, 0.3 + 0.3 * (c + 1) / Dimension);
    this->Way[c].resize(grid.GetNumberOfPoints());
    function.EvaluateGrid(execution, grid, this->Way[c].data(), c);
  }
}

//------------------------------------------------------------------------------
template <int Dimension>
void vtkLacunaLandmarkWarp<Dimension>::GetIndex(std::int64_t voxel, double* index) const
{
  std::int64_t rest = voxel;
  for (std::size_t c = 0; c < 3; ++c)
  {
    index[c] = static_cast<double>(this->Space.Extent[2 * c] + rest % this->Space.Size[c]);
    rest /= this->Space.Size[c];
  }
  for (int c = 0; c < Dimension; ++c)
  {
    const int axis = this->Space.Axes[c];
    index[axis] += this->Way[c][voxel] / this->Space.Spacing[axis];
  }
}

//------------------------------------------------------------------------------
template <int Dimension>
bool vtkLacunaLandmarkWarp<Dimension>::IsInBox(std::int64_t voxel) const
{
  std::int64_t rest = voxel;
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    const auto i = static_cast<double>(rest % this->Space.Size[axis]);
    rest /= this->Space.Size[axis];
    if (i < this->Box[2 * axis] || i > this->Box[2 * axis + 1])
    {
      return false;
    }
  }
  return true;
}

//------------------------------------------------------------------------------
template <int Dimension>
bool vtkLacunaLandmarkWarp<Dimension>::IsFolded(std::int64_t voxel) const
{
  // derivatives by forward differences, backward at the last voxel
  double jacobian[3][3] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };
  std::int64_t stride = 1;
  std::int64_t rest = voxel;
  int d = 0;
  for (int axis = 0; axis < 3; ++axis)
  {
    const std::int64_t size = this->Space.Size[axis];
    const std::int64_t i = rest % size;
    rest /= size;
    if (size > 1)
    {
      const std::int64_t from = i + 1 < size ? voxel : voxel - stride;
      for (int c = 0; c < Dimension; ++c)
      {
        jacobian[c][d] +=
          (this->Way[c][from + stride] - this->Way[c][from]) / this->Space.Spacing[axis];
      }
      ++d;
    }
    stride *= size;
  }
  return vtkMatrix3x3::Determinant(&jacobian[0][0]) <= 0;
}

template class vtkLacunaLandmarkWarp<2>;
template class vtkLacunaLandmarkWarp<3>;
