// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Pictures of depth maps: depth-only and Phong shading, depth cue, shadows. Carr 1996, 3.3.
#ifndef lacunaDepthShader_h
#define lacunaDepthShader_h

#include "lacunaDepthGrid.h"
#include "lacunaExecution.h"
#include "lacunaProperties.h"
#include "lacunaShadowCaster.h"

#include <array>
#include <vector>

namespace lacuna
{
struct ShaderLight
{
  Vec3 Place{ 0, 0, 0 };   ///< position, world mm; or the direction towards the light, any length
  bool IsPosition = false; ///< false: parallel light
  double Intensity = 1;    ///< >= 0
};

enum class ShadingModel
{
  Phong,    ///< depth cue x (ambient + diffuse N.L + specular cos^n), summed over the lights
  DepthOnly ///< DepthIntensity
};
inline constexpr std::array<const char*, 2> ShadingModelNames{ "Phong", "DepthOnly" };

enum class DepthLaw
{
  InverseSquare, ///< light of a point source
  Inverse        ///< between that and parallel light
};
inline constexpr std::array<const char*, 2> DepthLawNames{ "InverseSquare", "Inverse" };

/// From 1 at the near end of the sphere around the data (u = 0) to 0 at its far end (u = 1); u is
/// limited to 0..1. The source is one diameter before the sphere, that is at distances d = 1 + u, and
/// 1/d^2 or 1/d is scaled to the range 1..0.
double DepthIntensity(double u, DepthLaw law);

struct ShadingSettings
{
  ShadingModel Model = ShadingModel::Phong;
  double Ambient = 0.1;
  double Diffuse = 0.7;
  double Specular = 0.2;
  double SpecularPower = 20;       ///< n
  std::vector<ShaderLight> Lights; ///< none: one at the viewpoint, of intensity 1
  double DepthCue = 0;             ///< the far end of the sphere is 1 - DepthCue as bright
  DepthLaw Law = DepthLaw::InverseSquare;
  Sphere Data;                     ///< around the data; radius 0: nothing is near or far
  Vec3 SurfaceColor{ 1, 1, 1 };    ///< of ambient and diffuse light; highlights are white
  Vec3 BackgroundColor{ 0, 0, 0 }; ///< of pixels without a depth

  void Describe(Properties& properties) const; ///< with the ranges, lights as five numbers each
  /// Throws std::invalid_argument that names the setting that is out of range or not a number.
  void Check() const;
};

/// Colours the pixels of extent, which lies within the grid: 3 bytes each, row-major. normals: x 3 for
/// each, unit, world, towards the viewer; may be null for DepthOnly. A pixel's result does not depend
/// on the extent. Throws what settings.Check throws.
void ShadeDepths(const DepthGrid& grid, const float* normals, const ShadingSettings& settings,
  const ShadowCaster& shadows, const std::array<int, 4>& extent, unsigned char* colors,
  Execution& execution);
}
#endif
