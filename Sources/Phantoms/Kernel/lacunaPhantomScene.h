// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Analytic scenes: grey levels as closed-form functions of position.
#ifndef lacunaPhantomScene_h
#define lacunaPhantomScene_h

#include "lacunaProperties.h"
#include "lacunaVector.h"

#include <array>
#include <memory>

namespace lacuna
{
/// What an ideal scanner would see at each point of the reference frame (mm).
class PhantomScene
{
public:
  virtual ~PhantomScene() = default;

  /// Grey levels at the points start + i * step for first <= i < first + count, into
  /// values[0..count). A level depends on its point alone, not on the row that it is asked for in.
  virtual void SampleRow(
    const Vec3& start, const Vec3& step, int first, int count, double* values) const = 0;

  /// Grey level at a point.
  double Value(const Vec3& point) const
  {
    double value;
    this->SampleRow(point, { 0, 0, 0 }, 0, 1, &value);
    return value;
  }

  /// Level half way between the object of interest and what is around it: the surface of the object
  /// in closed form is exactly this iso-surface. NaN when the scene has no object.
  virtual double IsoValue() const;
  /// Volume in mm3 of the object of interest inside that surface; NaN where it has no closed form.
  virtual double TrueVolume() const;
};

/// The scenes of Phantom Sweep. None equals its mirror image along an axis.
enum class Anatomy
{
  /// A bright tilted ellipsoid (180) with a brighter and a darker inclusion in tissue (60), a dark
  /// cyst (20) and two lesions (100, 35) beside it: within 29, 22 and 22 mm of the origin along x,
  /// y and z. The iso-value 120 encloses the main ellipsoid and nothing else.
  Ellipsoids,
  /// A sweet potato in water (20): a bent, tapered ellipsoid of 190 mm along z, 80 mm along x and
  /// 90 mm along y, flesh 150 under a bright skin of 200 that is 4 mm thick (Carr 1996, ch. 5).
  Kumara,
  /// A fluid-filled tree of vessels (25) in bright tissue (150): a trunk of 4 mm radius and four
  /// forks; tubes around circular arcs that taper so that the radii at the forks obey Murray's law;
  /// all ends are closed. The union of the tubes leaves creases where branches part.
  Vessels,
  /// 130 + 1.25 x + 1.5 y - z: reproduced exactly by any linear interpolation.
  Linear
};
inline constexpr std::array<const char*, 4> AnatomyNames{ "Ellipsoids", "Kumara", "Vessels",
  "Linear" };

/// Wider edges would overlap, and the surfaces would no longer lie at the iso-value.
constexpr double MaximumEdgeWidth = 4;
constexpr ValueRange EdgeWidths = ValueRange::Above(0, "mm").UpTo(MaximumEdgeWidth);

/// Edges of a scene are SmoothStep of first-order signed distance (the implicit function over the
/// length of its gradient) and edgeWidth mm wide from 0 to 100 %. Throws std::invalid_argument
/// unless edgeWidth is one of EdgeWidths.
std::unique_ptr<PhantomScene> MakePhantomScene(Anatomy anatomy, double edgeWidth);
}
#endif
