// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The mapping of an image's voxels that landmarks say. Not a part of the module's interface.
#ifndef vtkLacunaLandmarkWarp_h
#define vtkLacunaLandmarkWarp_h

#include "lacunaRadialBasis.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

class vtkDataSet;
class vtkImageData;
class vtkLacunaExecution;

/// Positions in mm along the image's own axes, from its first voxel: there its grid is regular
/// whatever its direction matrix.
struct vtkLacunaVoxelSpace
{
  explicit vtkLacunaVoxelSpace(vtkImageData* image);
  std::vector<std::array<double, 3>> GetPoints(vtkDataSet* points) const;

  vtkImageData* Image;
  int Size[3];
  double Spacing[3];
  int Extent[6];
  std::vector<int> Axes; ///< with more than one voxel
};

/// Where the voxels of the warped image come from, by a radial basis function through the landmarks.
template <int Dimension>
class vtkLacunaLandmarkWarp
{
public:
  using Points = std::vector<std::array<double, 3>>;
  /// accuracy: in voxels. The space must live longer. Throws for what the function throws for.
  vtkLacunaLandmarkWarp(vtkLacunaExecution& execution, const vtkLacunaVoxelSpace& space,
    const Points& landmarks, const Points& targets, lacuna::RadialBasisOptions options,
    double accuracy);

  const lacuna::RadialBasisReport& GetReport() const { return this->Report; }
  /// Whether the affine map that fits best turns the landmarks' space over, or flattens it.
  bool IsMirrored() const { return this->Mirrored; }
  /// The voxel's place in the input, as an index of the image.
  void GetIndex(std::int64_t voxel, double* index) const;
  /// Whether a voxel is in the box that encloses the targets.
  bool IsInBox(std::int64_t voxel) const;
  /// Whether the mapping turns the cell at a voxel inside out.
  bool IsFolded(std::int64_t voxel) const;

private:
  const vtkLacunaVoxelSpace& Space;
  lacuna::RadialBasisReport Report;
  bool Mirrored = false;
  std::array<std::vector<double>, Dimension> Way;
  std::array<double, 6> Box{}; // first and last voxel of each axis, also outside of the image
};
#endif
