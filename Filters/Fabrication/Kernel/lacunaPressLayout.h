// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Where the mould for pressing a plate lies, from a fitted relief.
#ifndef lacunaPressLayout_h
#define lacunaPressLayout_h

#include "lacunaMatrix4.h"
#include "lacunaPlanarCurves.h"
#include "lacunaProperties.h"
#include "lacunaReliefSurface.h"
#include "lacunaSurfaceFit.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace lacuna
{
class Execution;

/// The C2 surface f(s(x), t(y)) + c1 (x - s(x)) + c2 (y - t(y)) over the whole plane. On a core, s and t
/// are the identity and the surface is the relief; beyond it they come to rest at the relief's border,
/// and the surface gets the slopes c1, c2.
class LevelledRelief
{
public:
  /// low and high are the corners of the core, within the relief; it must outlive this object.
  LevelledRelief(
    const ReliefSurface& relief, const Vec2& slopes, const Vec2& low, const Vec2& high);

  ReliefSurface::Frame GetFrame(const Vec2& p) const;

private:
  struct Argument
  {
    double Value;
    double First; ///< derivatives
    double Second;
  };
  Argument GetArgument(int axis, double x) const;

  const ReliefSurface& Relief;
  Vec2 Slopes;
  Vec2 Low;
  Vec2 High;
};

/// Which way the mill's side of the press (+z) points.
enum class PressSide
{
  IntoBody, ///< away from the viewer of the relief: its outer face lies on the mould
  TowardsViewer
};

/// A rotation from a relief's axes (x, y, and z away from the viewer) to those of the press.
struct PressFrame
{
  /// Radians about the relief's x and y axes (Carr 1996, eq. 6.14): first Psi about y, then Theta
  /// about x make the plane horizontal.
  double Theta = 0;
  double Psi = 0;
  /// Rx(Theta) Ry(Psi); for TowardsViewer followed by half a turn about x. Determinant +1.
  Matrix4 Rotation;
  /// The plane's unit normal away from the viewer, in the relief's axes.
  Vec3 Inwards{};
};

/// The frame for a plane with the given normal, of any length and either sign. Throws
/// std::invalid_argument when it is not finite or perpendicular to the viewer's axis.
PressFrame MakePressFrame(const Vec3& normal, PressSide side);

/// The normal (c1, c2, -1)/length, towards the viewer, of the plane c0 + c1 x + c2 y that is nearest
/// to the depths where mask is not 0 (everywhere if mask is empty), in the sense of least squares.
/// The depths are finite there. Throws std::invalid_argument when those pixels lie on a line.
Vec3 FitPlaneNormal(GridSize size, const std::vector<double>& depths, const Vec2& spacing,
  const std::vector<unsigned char>& mask = {});

/// The tool that a plate is pressed with.
enum class PressMould
{
  Female, ///< a cavity: the plate's convex face lies in it
  Male    ///< a boss: the plate's concave face lies on it
};
inline constexpr std::array<const char*, 2> PressMouldNames{ "Female", "Male" };

/// How the plate lies in the patient.
enum class PlateSeating
{
  Onlay, ///< on the surface: that is its inner face
  Inlay  ///< level with the surface: that is its outer face
};
inline constexpr std::array<const char*, 2> PlateSeatingNames{ "Onlay", "Inlay" };

/// Where the surface bulges to.
enum class ConvexSide
{
  Automatic, ///< measured: the sign of the mean curvature over the defect
  Outward,   ///< towards the viewer of the relief
  Inward
};
inline constexpr std::array<const char*, 3> ConvexSideNames{ "Automatic", "Outward", "Inward" };

struct PressOptions
{
  PressMould Mould = PressMould::Female;
  PlateSeating Seating = PlateSeating::Onlay;
  ConvexSide Convex = ConvexSide::Automatic;
  double PlateThickness = 0.7; ///< mm
  double PlateMargin = 5;      ///< mm around the defect where the surface is kept
  double FlangeWidth = 15;     ///< mm over which the surface goes over into the press plane
  /// mm, of the block along x, y and z; 0: as small as it takes.
  Vec3 BlockSize{};
  double Spacing = 0.5; ///< mm between nodes, at most FlangeWidth / NodesPerFlange

  void Describe(Properties& properties) const; ///< with the ranges
};

/// Fewer would not show the flange's slopes.
constexpr double NodesPerFlange = 8;

/// What is left under a cavity or a boss when the block's height is left open, mm.
constexpr double BlockFloor = 10;

/// Where the mould lies and how large it is.
struct PressLayout
{
  PressFrame Frame;
  PressSide Side = PressSide::IntoBody;
  bool ConvexOutward = true;
  /// mm from the relief's surface towards its viewer, of the plate's face on the mould.
  double Offset = 0;
  /// Whether the mill sees every point of the plate and the flange. Without that there is no mould.
  bool SingleValued = true;
  /// Where the surface turns away from the mill most, in the relief's coordinates, and its angle
  /// from the press plane there, degrees (above 90: an undercut).
  Vec3 SteepestPoint{};
  double SteepestAngle = 0;
  /// Corners of the part of the relief that is kept; beyond, it is levelled.
  Vec2 CoreLow{};
  Vec2 CoreHigh{};
  Vec2 Slopes{}; ///< of the plane
  /// Points of the levelled relief, and where their offsets come to lie in the press plane.
  PlanarGrid Samples;
  std::vector<Vec2> Images;
  std::vector<Loop> Outlines; ///< of the defects in the press plane (bone islands filled)
  /// Nodes Origin + Spacing * (i, j), in the axes of the frame about the relief's origin.
  PlanarGrid Grid;
  Vec3 BlockSize{}; ///< z only when given
  /// mm along the axis of the frame, of the point of plate and margin that is nearest to the press
  /// plane (a cavity's highest, a boss's lowest). It does not depend on the grid.
  double Top = 0;
};

/// Throws std::invalid_argument when an option is out of range, and std::runtime_error that names the
/// place when the surface bends so much that its offset would fold, the flange leaves the relief, or
/// the block is too small. mask: one per sample of the relief, not 0 in the defect. toWorld serves to
/// name places.
PressLayout PlanPress(Execution& execution, const ReliefSurface& surface, GridSize size,
  const Vec2& spacing, const std::vector<unsigned char>& mask, const Vec3& normal,
  const PressOptions& options, const Matrix4& toWorld = {});

/// The unit direction, away from the relief's viewer, in which defect and margin are faced most
/// squarely: that of their area as a vector. By Stokes' theorem it depends on the rim of that part
/// alone, so a fit that swings over the defect does not change it.
Vec3 FindFacingView(const ReliefSurface& surface, GridSize size, const Vec2& spacing,
  const std::vector<unsigned char>& mask, double margin);

/// A place in words, after a transform: "(1.5, -20.0, 33.1)".
std::string FormatPlace(const Matrix4& toWorld, const Vec3& p);

/// Throws the error of an offset that folds at a point of the relief.
[[noreturn]] void ThrowFold(const Vec3& point, const PressOptions& options, const Matrix4& toWorld);

/// The offset of a levelled relief seen from the mill.
class PressView
{
public:
  PressView(const ReliefSurface& surface, const PressLayout& layout)
    : Surface(surface, layout.Slopes, layout.CoreLow, layout.CoreHigh)
    , Rotation(layout.Frame.Rotation)
    , Offset(layout.Offset)
    , Sign(layout.Side == PressSide::IntoBody ? -1 : 1)
  {
  }

  struct Sample
  {
    Vec3 Point;  ///< in the axes of the frame about the relief's origin
    Vec3 AlongX; ///< its derivatives by the relief's x and y
    Vec3 AlongY;
    Vec3 Normal; ///< unit, out of the mould
    /// The least ratio of lengths on the offset and on the relief; 0 or less where it folds.
    double Stretch;
  };
  Sample Get(const Vec2& foot) const;
  /// The point of the levelled relief.
  Vec3 GetPoint(const Vec2& foot) const { return this->Surface.GetFrame(foot).Point; }

private:
  LevelledRelief Surface;
  Matrix4 Rotation;
  double Offset;
  double Sign;
};

/// Offsets that shrink lengths to less than this are taken to fold.
constexpr double LeastStretch = 0.02;
}
#endif
