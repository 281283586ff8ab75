// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Depth maps and structured grids as B-spline surfaces, and the outlines of defects on them.
#ifndef lacunaCADSurface_h
#define lacunaCADSurface_h

#include "lacunaBSplineCurve.h"
#include "lacunaMatrix4.h"
#include "lacunaSurfaceFit.h"

#include <string>
#include <vector>

class vtkImageData;
class vtkStructuredGrid;
namespace lacuna
{
class Execution;

/// A surface as it goes to a file.
struct CADSurface
{
  /// A closed curve on the surface: in its parameters (u, v, 0), and in space at the same t.
  struct Boundary
  {
    BSplineCurve Parameters;
    BSplineCurve Space;
  };

  SurfaceFit Fit;
  std::string Name;
  std::string Description; ///< a sentence or two for people
  /// The outlines of the pieces of the defect: the outer one, then those of islands in it.
  std::vector<std::vector<Boundary>> Pieces;

  /// The fitted surface of a depth map, or the map itself where it has none, mapped by toFile. All
  /// functions throw std::runtime_error or std::invalid_argument that says what is wrong.
  static CADSurface FromMap(vtkImageData* map, const Matrix4& toFile,
    const SurfaceFitOptions& options, Execution& execution);

  /// A grid with one dimension of 1, mapped by toFile.
  static CADSurface FromGrid(vtkStructuredGrid* grid, const Matrix4& toFile,
    const SurfaceFitOptions& options, Execution& execution);

  /// Finds Pieces from the map's FilledMask; there are none when it marks nothing. Throws when the
  /// map has no such array, or when the defect reaches the surface's border.
  void FindOutlines(vtkImageData* map, const SurfaceFitOptions& options);

private:
  std::int64_t Column = 0; // of the map where the surface begins, relative to its extent
  std::int64_t Row = 0;
};
}
#endif
