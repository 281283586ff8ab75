// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Depth maps and structured grids as B-spline surfaces, and the outlines of defects on them.
#ifndef vtkLacunaIGESSurface_h
#define vtkLacunaIGESSurface_h

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
}

/// A surface as it goes to a file.
struct vtkLacunaIGESSurface
{
  /// A closed curve on the surface: in its parameters (u, v, 0), and in space at the same t.
  struct Boundary
  {
    lacuna::BSplineCurve Parameters;
    lacuna::BSplineCurve Space;
  };

  lacuna::SurfaceFit Fit;
  std::string Name;
  std::string Description; ///< a sentence or two for people
  /// The outlines of the pieces of the defect: the outer one, then those of islands in it.
  std::vector<std::vector<Boundary>> Pieces;

  /// The fitted surface of a depth map, or the map itself where it has none, mapped by toFile. All
  /// functions throw std::runtime_error or std::invalid_argument that says what is wrong.
  static vtkLacunaIGESSurface FromMap(vtkImageData* map, const lacuna::Matrix4& toFile,
    const lacuna::SurfaceFitOptions& options, lacuna::Execution& execution);

  /// A grid with one dimension of 1, mapped by toFile.
  static vtkLacunaIGESSurface FromGrid(vtkStructuredGrid* grid, const lacuna::Matrix4& toFile,
    const lacuna::SurfaceFitOptions& options, lacuna::Execution& execution);

  /// Finds Pieces from the map's FilledMask; there are none when it marks nothing. Throws when the
  /// map has no such array, or when the defect reaches the surface's border.
  void FindOutlines(vtkImageData* map, const lacuna::SurfaceFitOptions& options);

private:
  std::int64_t Column = 0; // of the map where the surface begins, relative to its extent
  std::int64_t Row = 0;
};
#endif
