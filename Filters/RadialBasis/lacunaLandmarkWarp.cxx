// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaLandmarkWarp.h"

#include "lacunaAlgorithmExecution.h"
#include "vtkDataSet.h"
#include "vtkImageData.h"
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
lacuna::VoxelSpace::VoxelSpace(vtkImageData* image)
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
std::vector<std::array<double, 3>> lacuna::VoxelSpace::GetPoints(vtkDataSet* points) const
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
lacuna::LandmarkWarp<Dimension>::LandmarkWarp(lacuna::AlgorithmExecution& execution,
  const lacuna::VoxelSpace& space, const Points& landmarks, const Points& targets,
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
    this->Targets[2 * axis] = std::floor(low / space.Spacing[axis]);
    this->Targets[2 * axis + 1] = std::ceil(high / space.Spacing[axis]);
    const auto range = std::minmax_element(values[c].begin(), values[c].end());
    largest = targets.empty() ? 0 : std::max(largest, *range.second - *range.first);
  }
  // of each component, so that positions keep it
  const double wanted = accuracy * smallest / std::sqrt(Dimension);
  options.Accuracy = largest > 0 ? std::min(0.5, wanted / largest) : 0.5;
  execution.SetStage(0, 0.3);
  this->Fit = std::make_unique<const Function>(execution, nodes, values, options);
  this->Mirrored = TurnsOver(space.Axes, landmarks, targets);
}

//------------------------------------------------------------------------------
template <int Dimension>
std::vector<std::array<int, 6>> lacuna::LandmarkWarp<Dimension>::Divide(const Box& part)
{
  constexpr int largest = Dimension == 3 ? 96 : 1024; // 20 MB
  std::array<int, 3> number{};
  std::array<int, 3> size{};
  for (int c = 0; c < 3; ++c)
  {
    size[c] = part[2 * c + 1] - part[2 * c] + 1;
    number[c] = (size[c] + largest - 1) / largest;
  }
  std::vector<Box> blocks;
  for (int k = 0; k < number[2]; ++k)
  {
    for (int j = 0; j < number[1]; ++j)
    {
      for (int i = 0; i < number[0]; ++i)
      {
        const int at[3] = { i, j, k };
        Box block;
        for (int c = 0; c < 3; ++c)
        {
          const auto begin = [&](std::int64_t n)
          { return part[2 * c] + static_cast<int>(n * size[c] / number[c]); };
          block[2 * c] = begin(at[c]);
          block[2 * c + 1] = begin(at[c] + 1) - 1;
        }
        blocks.push_back(block);
      }
    }
  }
  return blocks;
}

template <int Dimension>
lacuna::GridPart<Dimension> lacuna::LandmarkWarp<Dimension>::GetReach(const Box& block) const
{
  lacuna::GridPart<Dimension> reach;
  for (int c = 0; c < Dimension; ++c)
  {
    const int axis = this->Space.Axes[c];
    const int size = this->Space.Size[axis];
    reach[c] = { std::min(block[2 * axis], size - 2), std::min(block[2 * axis + 1] + 2, size) };
  }
  return reach;
}

//------------------------------------------------------------------------------
template <int Dimension>
void lacuna::LandmarkWarp<Dimension>::SetPart(
  lacuna::AlgorithmExecution& execution, const Box& part)
{
  lacuna::RegularGrid<Dimension> grid;
  for (int c = 0; c < Dimension; ++c)
  {
    grid.Spacing[c] = this->Space.Spacing[this->Space.Axes[c]];
    grid.Size[c] = this->Space.Size[this->Space.Axes[c]];
  }
  const lacuna::Execution::NestedStages stages(execution);
  this->Components.clear();
  for (int c = 0; c < Dimension; ++c)
  {
    execution.SetStage(1.0 * c / Dimension, (c + 1.0) / Dimension);
    this->Components.emplace_back(execution, *this->Fit, grid, this->GetReach(part), c,
      Function::OnGrid::Memory / Dimension); // all are kept
  }
}

template <int Dimension>
void lacuna::LandmarkWarp<Dimension>::SetBlock(
  lacuna::AlgorithmExecution& execution, const Box& block)
{
  this->Reach = this->GetReach(block);
  std::int64_t count = 1;
  for (int c = 0; c < Dimension; ++c)
  {
    this->Stride[c] = count;
    count *= this->Reach[c][1] - this->Reach[c][0];
  }
  const lacuna::Execution::NestedStages stages(execution);
  for (int c = 0; c < Dimension; ++c)
  {
    execution.SetStage(1.0 * c / Dimension, (c + 1.0) / Dimension);
    this->Way[c].resize(count);
    this->Components[c].Evaluate(execution, this->Reach, this->Way[c].data());
  }
}

//------------------------------------------------------------------------------
template <int Dimension>
std::int64_t lacuna::LandmarkWarp<Dimension>::GetPlace(const int* voxel) const
{
  std::int64_t place = 0;
  for (int c = 0; c < Dimension; ++c)
  {
    place += (voxel[this->Space.Axes[c]] - this->Reach[c][0]) * this->Stride[c];
  }
  return place;
}

template <int Dimension>
void lacuna::LandmarkWarp<Dimension>::GetIndex(const int* voxel, double* index) const
{
  const std::int64_t place = this->GetPlace(voxel);
  for (int c = 0; c < 3; ++c)
  {
    index[c] = static_cast<double>(this->Space.Extent[2 * c] + voxel[c]);
  }
  for (int c = 0; c < Dimension; ++c)
  {
    const int axis = this->Space.Axes[c];
    index[axis] += this->Way[c][place] / this->Space.Spacing[axis];
  }
}

//------------------------------------------------------------------------------
template <int Dimension>
bool lacuna::LandmarkWarp<Dimension>::IsInBox(const int* voxel) const
{
  for (int axis = 0; axis < 3; ++axis)
  {
    if (voxel[axis] < this->Targets[2 * axis] || voxel[axis] > this->Targets[2 * axis + 1])
    {
      return false;
    }
  }
  return true;
}

//------------------------------------------------------------------------------
template <int Dimension>
bool lacuna::LandmarkWarp<Dimension>::IsFolded(const int* voxel) const
{
  // derivatives by forward differences, backward at the last voxel
  const std::int64_t place = this->GetPlace(voxel);
  double jacobian[3][3] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };
  for (int d = 0; d < Dimension; ++d)
  {
    const int axis = this->Space.Axes[d];
    const std::int64_t from =
      voxel[axis] + 1 < this->Space.Size[axis] ? place : place - this->Stride[d];
    for (int c = 0; c < Dimension; ++c)
    {
      jacobian[c][d] +=
        (this->Way[c][from + this->Stride[d]] - this->Way[c][from]) / this->Space.Spacing[axis];
    }
  }
  return vtkMatrix3x3::Determinant(&jacobian[0][0]) <= 0;
}

template class lacuna::LandmarkWarp<2>;
template class lacuna::LandmarkWarp<3>;
