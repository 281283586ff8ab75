// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Inputs of surfaces as oriented points.
#ifndef lacunaSurfacePoints_h
#define lacunaSurfacePoints_h

#include "lacunaSurfaceSpline.h"
#include "vtkType.h"

#include <array>
#include <string>
#include <vector>

class vtkDataArray;
class vtkDataSet;
class vtkImageData;
class vtkPolyData;

namespace lacuna
{
class Execution;
}

namespace lacuna
{
/// Collects points of a surface from depth maps, triangle meshes, closed outlines and point sets.
class SurfacePoints
{
public:
  /// Names of point arrays with one component; empty: none.
  std::string ErrorArray; ///< expected errors, above 0
  std::string SideArray;  ///< below 0: inside; 0: on the surface; above 0: outside

  /// Adds those of an input. number is that of the input, from 1, for messages. Throws
  /// std::runtime_error that says what is wrong.
  void Add(Execution& execution, vtkDataSet* data, int number);

  /// After all inputs: throws std::runtime_error when outlines are all there is, in one plane, and when no
  /// input has SideArray.
  void Check() const;

  /// Of the points and of Inside; there must be a point.
  std::array<double, 6> GetBounds() const;

  /// mm between neighbouring points; those that repeat others do not count.
  double FindSpacing(Execution& execution) const;

  OrientedPoints Data;
  std::vector<Vec3> Inside; ///< places that SideArray says lie there
  std::vector<Vec3> Outside;
  bool HasOutlines = false;
  bool HasEstimatedNormals = false;
  std::vector<std::string> Warnings;

private:
  bool HasSides = false; // an input has SideArray

  void RefuseSides(vtkDataSet* data, const std::string& name) const;
  void AddSide(const Vec3& place, double side, const std::string& name);
  void AddPoint(const double* x, const Vec3& normal, const Vec3& free, double error);
  void AddMap(vtkImageData* image, vtkDataArray* errors);
  void AddOutlines(vtkPolyData* lines, const std::string& name, vtkDataArray* errors);
  // someWithout: points whose normal is zero are left out
  void AddPoints(Execution& execution, vtkDataSet* data, const std::string& name,
    vtkDataArray* errors, bool someWithout);
  // Those on the surface; others become places inside or outside.
  void FindPlaces(vtkDataSet* data, const std::string& name, std::vector<vtkIdType>& ids,
    std::vector<Vec3>& points);
  std::vector<Vec3> EstimateNormals(
    Execution& execution, const std::vector<Vec3>& points, const std::string& name);
};
}
#endif
