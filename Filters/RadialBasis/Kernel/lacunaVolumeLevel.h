// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A volume at one resolution, for the search of its plane of symmetry.
#ifndef lacunaVolumeLevel_h
#define lacunaVolumeLevel_h

#include "lacunaExecution.h"
#include "lacunaMirrorPlane.h"
#include "lacunaSymmetrySearch.h"
#include "lacunaVolumeSymmetry.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace lacuna
{
/// Means of blocks of voxels. They are taken as the control points of a cubic B-spline: so the level
/// is a little smoothed, and has derivatives. Coordinates are mm along the volume's axes, from its
/// first voxel.
class VolumeLevel : public SymmetryLevel
{
public:
  /// spacing: of the voxels; wantedCell: about how long blocks are, mm; samples: at most about so many
  /// cells have residuals.
  VolumeLevel(const MaskedVolume& volume, const Vec3& spacing, double wantedCell,
    std::size_t samples, Execution& execution);

  /// Largest less smallest value; 0 when there is none.
  double GetRange() const { return this->Range; }

  double Rate(const MirrorPlane& plane) const override;
  std::vector<double> GetResiduals(const MirrorPlane& plane, Execution& execution) const override;
  SymmetryEquations Linearize(const MirrorPlane& plane, const std::array<Vec3, 2>& turns,
    double limit, Execution& execution) const override;

private:
  std::int64_t IndexOf(int i, int j, int k) const
  {
    return i + this->Size[0] * (j + static_cast<std::int64_t>(this->Size[1]) * k);
  }
  Vec3 CellCenter(int i, int j, int k) const
  {
    return { this->First[0] + i * this->Cell[0], this->First[1] + j * this->Cell[1],
      this->First[2] + k * this->Cell[2] };
  }
  Vec3 CellCenter(std::int64_t cell) const
  {
    const std::int64_t row = cell / this->Size[0];
    return this->CellCenter(static_cast<int>(cell % this->Size[0]),
      static_cast<int>(row % this->Size[1]), static_cast<int>(row / this->Size[1]));
  }

  template <class T>
  void Average(const T* voxels, const MaskedVolume& volume, Execution& execution);
  /// The spline at the cells' centres, and what is said of its values.
  void Smooth(Execution& execution);
  /// Cells at strong edges, as they tell where the plane is: at most about so many, spread evenly.
  void ChooseSamples(std::size_t count, Execution& execution);
  /// Value and derivatives (per mm) of the spline; NaN outside or next to an invalid cell.
  double Evaluate(const Vec3& x, Vec3& slope) const;
  /// Trilinear in the smoothed cells, at an index; NaN as above.
  double Interpolate(double x, double y, double z) const;

  std::array<int, 3> Block{};
  std::array<int, 3> Size{};
  std::array<std::int64_t, 3> Next{}; ///< from a cell to the next along an axis; 0 if there is none
  std::array<int, 3> Rim{};           ///< cells at the border without a full neighbourhood
  Vec3 Cell{ 0, 0, 0 };
  Vec3 First{ 0, 0, 0 };
  std::vector<float> Points;
  std::vector<float> Smoothed;
  std::vector<std::int64_t> Samples;
  double Range = 0;
  double Mean = 0;
  double Variation = 0;
};
}
#endif
