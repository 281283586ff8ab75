// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The mapping of an image's voxels that landmarks say. Not a part of the module's interface.
#ifndef lacunaLandmarkWarp_h
#define lacunaLandmarkWarp_h

#include "lacunaRadialBasis.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

class vtkDataSet;
class vtkImageData;
namespace lacuna
{
class AlgorithmExecution;
}

namespace lacuna
{
/// Positions in mm along the image's own axes, from its first voxel: there its grid is regular
/// whatever its direction matrix.
struct VoxelSpace
{
  explicit VoxelSpace(vtkImageData* image);
  std::vector<std::array<double, 3>> GetPoints(vtkDataSet* points) const;

  vtkImageData* Image;
  int Size[3];
  double Spacing[3];
  int Extent[6];
  std::vector<int> Axes; ///< with more than one voxel
};

/// Where the voxels of the warped image come from, by a radial basis function through the landmarks.
/// Voxels are counted from the image's first one.
template <int Dimension>
class LandmarkWarp
{
public:
  using Points = std::vector<std::array<double, 3>>;
  /// First and last voxel along each axis.
  using Box = std::array<int, 6>;

  /// accuracy: in voxels. The space must live longer. Throws for what the function throws for.
  LandmarkWarp(AlgorithmExecution& execution, const VoxelSpace& space, const Points& landmarks,
    const Points& targets, RadialBasisOptions options, double accuracy);

  const RadialBasisReport& GetReport() const { return this->Fit->GetReport(); }
  /// Whether the affine map that fits best turns the landmarks' space over, or flattens it.
  bool IsMirrored() const { return this->Mirrored; }

  /// The blocks into which a part is divided: of the whole image the working set would be several
  /// times the image.
  static std::vector<Box> Divide(const Box& part);
  /// What all blocks of a part have in common.
  void SetPart(AlgorithmExecution& execution, const Box& part);
  /// The block whose voxels are asked for below; of the part. The bits do not depend on it.
  void SetBlock(AlgorithmExecution& execution, const Box& block);

  /// The voxel's place in the input, as an index of the image.
  void GetIndex(const int* voxel, double* index) const;
  /// Whether a voxel is in the box that encloses the targets.
  bool IsInBox(const int* voxel) const;
  /// Whether the mapping turns the cell at a voxel inside out.
  bool IsFolded(const int* voxel) const;

private:
  using Function = RadialBasis<Dimension>;

  /// What the cells at the voxels of a block need: a voxel more along each axis.
  GridPart<Dimension> GetReach(const Box& block) const;
  std::int64_t GetPlace(const int* voxel) const;

  const VoxelSpace& Space;
  std::unique_ptr<const Function> Fit;
  bool Mirrored = false;
  std::array<double, 6> Targets{}; // first and last voxel of each axis, also outside of the image
  std::vector<typename Function::OnGrid> Components;
  GridPart<Dimension> Reach{};                  // of the block
  std::array<std::int64_t, Dimension> Stride{}; // of Way
  std::array<std::vector<double>, Dimension> Way;
};
}
#endif
