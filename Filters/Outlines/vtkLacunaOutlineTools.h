// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkLacunaOutlineTools
 * @brief   What helps to draw outlines in the picture of a slice
 *
 * Places are (column, row, z) of the picture; pixel (0, 0) has its middle at column 0, row 0. z of what is given
 * is passed on. The picture is a vtkImageData of one slice whose origin, spacing and active scalars (one
 * component) are used.
 */
#ifndef vtkLacunaOutlineTools_h
#define vtkLacunaOutlineTools_h

#include "vtkLacunaFiltersOutlinesModule.h" // for export macro
#include "vtkObject.h"

class vtkImageData;
class vtkPoints;

class VTKLACUNAFILTERSOUTLINES_EXPORT vtkLacunaOutlineTools : public vtkObject
{
public:
  static vtkLacunaOutlineTools* New();
  vtkTypeMacro(vtkLacunaOutlineTools, vtkObject);

  /// A closed curve through three points or more: a cubic spline over the length of the chords
  /// (vtkParametricSpline), at most 400 points or those that are given. Without smooth: the points. Points that
  /// repeat the one before are left out. Returns the number n of steps from each point to the next: every n-th
  /// point of the curve, from the first on, is one of points.
  static int MakeCurve(vtkPoints* points, bool smooth, vtkPoints* curve);

  /// The same line with so few points that it is at most tolerance (pixels) away, and at least eight
  /// (Douglas and Peucker 1973).
  static void Simplify(vtkPoints* line, double tolerance, vtkPoints* result);

  /// Otsu's level between the dark and the bright pixels of a rectangle (first and last column, first and last
  /// row; first above last: all).
  static double ProposeLevel(vtkImageData* picture, const int region[4]);

  /// The closed contour at a level of the picture, after a median over a square of so many pixels (odd; 1:
  /// none; a tool against speckle). With a column and row that are finite: the innermost contour around that
  /// place. Otherwise: that around the largest area of those that lie in the rectangle. What reaches the border
  /// of the picture or the rectangle is closed along it. Returns whether there is any.
  static bool Trace(vtkImageData* picture, double level, const double place[2], const int region[4],
    int medianSize, vtkPoints* outline);

  /// Moves each point across the line, at most reach pixels, to where the picture (smoothed over one pixel)
  /// changes most; points without a change stay. Returns how many moved.
  static int Snap(vtkImageData* picture, vtkPoints* points, double reach);

  /// Whether a closed line crosses itself; where is then set to the place.
  static bool FindCrossing(vtkPoints* line, double where[3]);

protected:
  vtkLacunaOutlineTools() = default;
  ~vtkLacunaOutlineTools() override = default;

private:
  vtkLacunaOutlineTools(const vtkLacunaOutlineTools&) = delete;
  void operator=(const vtkLacunaOutlineTools&) = delete;
};
#endif
