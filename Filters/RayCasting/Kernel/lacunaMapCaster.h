// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Casts the rays of one depth map as requested.
#ifndef lacunaMapCaster_h
#define lacunaMapCaster_h

#include "lacunaIsoField.h"
#include "lacunaIsoRayCaster.h"

#include <array>
#include <limits>
#include <vector>

namespace lacuna
{
/// Splits every ray at what is cut away. The tile caster finds the entry in a ray's first part; the
/// few rays that go on behind a cut are followed alone.
class MapCaster
{
public:
  /// Everything must outlive this object.
  MapCaster(const IsoRayCaster& caster, const ImagePlane& plane, const DepthPixels& pixels,
    const RayRequest& request);

  void Cast(double isoValue, Execution& execution) const;

private:
  enum class Cap
  {
    None,
    CutAway,
    Boundary
  };
  /// A part of a ray that is not cut away, and what shows if it starts in the solid.
  struct Part
  {
    RaySpan Span;
    Cap Start;
  };
  /// What is known of a pixel's ray. World distances are (t - Zero) * Length.
  struct PixelRay
  {
    Ray Index;
    Vec3 Origin; ///< world
    Vec3 Direction;
    double Zero;
    double Length;
  };
  struct Hit
  {
    double T;
    Vec3 Normal;
    RaySpan Part;
  };

  struct PixelResult
  {
    bool Valid = false;
    double Depth = std::numeric_limits<double>::quiet_NaN();
    Vec3 Normal{ 0, 0, 0 };
    double Thickness = std::numeric_limits<double>::quiet_NaN();
  };

  PixelRay GetRay(int column, int row) const;
  std::vector<Part> FindParts(const PixelRay& ray, std::int64_t pixel) const;
  bool IsCapped(const PixelRay& ray, const Part& part, RayFollower& follower) const;
  Vec3 CapNormal(const PixelRay& ray, const Part& part) const;
  Vec3 EntryNormal(const PixelRay& ray, const RayEntry& entry) const;
  bool HasParts() const;
  bool IsAnyFinite() const;
  bool FindHit(const PixelRay& ray, std::int64_t pixel, bool firstFound, const RayEntry& first,
    RayFollower& follower, Hit& hit) const;
  double FindThickness(const PixelRay& ray, const Hit& hit, RayFollower& follower) const;
  void Prepare(const std::array<int, 4>& tile, RayFollower& follower, RaySpan* spans) const;
  void Take(
    const std::array<int, 4>& tile, RayFollower& follower, const TileEntries& entries) const;
  PixelResult FindResult(int column, int row, std::int64_t pixel, bool found, const RayEntry& entry,
    RayFollower& follower) const;
  std::int64_t IndexOf(int column, int row) const;

  const IsoRayCaster& Caster;
  const ImagePlane& Plane;
  const DepthPixels& Pixels;
  const RayRequest& Request;
  RayGrid Rays;
  Matrix4 IndexToPixel;
};
}
#endif
