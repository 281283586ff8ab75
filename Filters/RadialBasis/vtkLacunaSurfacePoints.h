// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Inputs of surfaces as oriented points.
#ifndef vtkLacunaSurfacePoints_h
#define vtkLacunaSurfacePoints_h

#include "lacunaSurfaceSpline.h"

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

/// Collects points of a surface from depth maps, triangle meshes, closed outlines and point sets.
class vtkLacunaSurfacePoints
{
public:
  /// Adds those of an input. number is that of the input, from 1, for messages. errorArray: point
  /// array of expected errors, mm; empty: none. Throws std::runtime_error that says what is wrong.
  void Add(
    lacuna::Execution& execution, vtkDataSet* data, int number, const std::string& errorArray);

  /// After all inputs: throws std::runtime_error when outlines are all there is, in one plane.
  void CheckOutlines() const;

  lacuna::OrientedPoints Data;
  bool HasOutlines = false;
  bool HasEstimatedNormals = false;
  std::vector<std::string> Warnings;

private:
  void AddPoint(
    const double* x, const lacuna::Vec3& normal, const lacuna::Vec3& free, double error);
  void AddMap(vtkImageData* image);
  void AddOutlines(vtkPolyData* lines, const std::string& name, vtkDataArray* errors);
  void AddPoints(
    lacuna::Execution& execution, vtkDataSet* data, const std::string& name, vtkDataArray* errors);
};
#endif
