// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Holes of skulls, implants and text as VTK data.
#ifndef lacunaImplantData_h
#define lacunaImplantData_h

#include "lacunaPlanarCurves.h"
#include "lacunaPlanarTriangulation.h"
#include "lacunaSkullEllipsoid.h"
#include "lacunaSkullImplant.h"
#include "lacunaSkullRays.h"
#include "lacunaVector.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

class vtkPoints;
class vtkPolyData;

namespace lacuna
{
std::string NameOf(const Vec3& point); ///< with the unit
std::string Rounded(double value, double steps = 10);

/// Holes on the ellipsoid that fits the skull.
class SkullHoles
{
public:
  /// defects: of FindDefects. Keeps a reference to rays.
  SkullHoles(const SkullRays& rays, std::vector<std::vector<int>> defects);

  double GetArea(std::size_t defect) const { return this->Areas[defect]; } ///< mm^2
  double GetDistance(std::size_t defect, const Vec3& point) const;         ///< mm
  std::string GetText(std::size_t defect) const;
  std::string GetText() const; ///< of all
  /// Triangles and field data of vtkLacunaSkullImplant's second output. first: number of the first defect.
  void SetOutput(vtkPolyData* output, int first) const;

private:
  double GetRadius(const Vec3& direction) const;
  Vec3 GetPoint(int ray) const;
  // Delaunay's, seen from the opposite side of the sphere.
  void AddTriangles(std::size_t k, vtkPoints* points, std::vector<std::int64_t>& corners) const;

  const SkullRays& Rays;
  std::vector<std::vector<int>> Defects;
  SkullEllipsoid Ellipsoid;
  std::vector<Vec3> Centers;
  std::vector<double> Areas;
};

/// The polyline, else the points in their order. Throws std::runtime_error for several lines, and for a point that is not
/// finite.
std::vector<Vec3> GetCurve(vtkPolyData* data);

/// Outlines of text whose capitals are so high (mm), x to the right. Throws std::runtime_error for other than printable ASCII.
std::vector<Loop> GetTextOutlines(const std::string& text, double height);

/// A closed polyline.
void SetCurve(vtkPolyData* output, const std::vector<Vec3>& curve);

/// Points and triangles, oriented so that the volume is positive. Returns the volume, mm^3.
double SetTriangles(
  vtkPolyData* output, const std::vector<Vec3>& points, std::vector<Triangle> triangles);

/// The mesh with its arrays.
void SetImplant(vtkPolyData* output, const SkullImplant& implant);

/// A line from the screw in the implant to that in the bone for each plate, with BoneThickness (mm) and IsThickEnough.
void SetPlates(vtkPolyData* output, const SkullImplant& implant, double screwLength);
}
#endif
