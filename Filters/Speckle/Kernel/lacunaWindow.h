// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The neighbourhood of a sample that a filter looks at.
#ifndef lacunaWindow_h
#define lacunaWindow_h

#include "lacunaImageView.h"

#include <array>
#include <cstdint>
#include <vector>

namespace lacuna
{
enum class WindowShape
{
  Box,
  Ellipsoid
};
inline constexpr std::array<const char*, 2> WindowShapeNames{ "Box", "Ellipsoid" };

/// A window of Size samples per axis, 1 to MaximumSize each. It covers the offsets -Lower(a) ...
/// Upper(a) along axis a with Lower = Size/2 rounded down, so an odd window is centred and an even
/// one reaches one sample further towards lower coordinates (as scipy.ndimage has it).
///
/// An ellipsoid has the diameters Size: place i = 0 ... Size-1 of each axis lies in it when
/// sum(((i - (Size-1)/2) / (Size/2))^2) <= 1.
class Window
{
public:
  static constexpr int MaximumSize = 255;

  /// A row of the window along x: samples Begin <= x < End at (y, z), as places in the window.
  struct Run
  {
    int Y;
    int Z;
    int Begin;
    int End;
  };

  /// Throws std::invalid_argument when a size is not in 1 ... MaximumSize.
  Window(const std::array<int, 3>& size, WindowShape shape);

  int GetSize(int axis) const { return this->Size[axis]; }
  const std::array<int, 3>& GetSize() const { return this->Size; }
  int Lower(int axis) const { return this->Reflected ? this->Above(axis) : this->Below(axis); }
  int Upper(int axis) const { return this->Reflected ? this->Below(axis) : this->Above(axis); }
  bool IsBox() const { return this->Box; }
  /// Rows in the order z, y; each row of a box is whole, an ellipsoid may leave out rows.
  const std::vector<Run>& GetRuns() const { return this->Runs; }
  std::int64_t GetNumberOfSamples() const { return this->Samples; }

  /// The window turned about its centre: differs in Lower and Upper of even sizes only. A dilation
  /// with it after an erosion with this one is an opening that shifts nothing.
  Window Reflect() const;

  /// The box of all samples that results in box depend on; it ends where the integers do, so that a
  /// request of any extent can be made. What is filtered lies within 2^30 of 0 (lacuna::InputCheck).
  Extent Grow(const Extent& box) const;

private:
  int Below(int axis) const { return this->Size[axis] / 2; }
  int Above(int axis) const { return (this->Size[axis] - 1) / 2; }

  std::array<int, 3> Size;
  bool Box;
  bool Reflected = false;
  std::vector<Run> Runs;
  std::int64_t Samples = 0;
};

/// Moves the ends of a box along an axis away from each other, but not beyond the integers.
void Grow(Extent& box, int axis, int below, int above);

/// The part of a box that lies in bounds.
Extent Intersect(const Extent& box, const Extent& bounds);

/// Divides box into boxes of at most about the given size each, of nearly equal sizes.
std::vector<Extent> Divide(const Extent& box, const std::array<int, 3>& size);
}
#endif
