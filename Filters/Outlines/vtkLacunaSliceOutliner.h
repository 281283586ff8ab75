// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkLacunaSliceOutliner
 * @brief   Outlines of structures, drawn in slices, in space
 *
 * Input: tracked slices (lacunaTrackedSlices.h), or a volume, whose slices are its x-y planes. Outlines
 * are kept in pixels of the slice: columns, rows and slices of tracked slices are those of the contract;
 * those of a volume are voxel indices. They stay in their slices when these are placed anew.
 *
 * Output 0: vtkPolyData, mm, a closed line for each outline (its first point again at its end). Cell data:
 * | array          | type              | meaning                                    |
 * |----------------|-------------------|--------------------------------------------|
 * | Structure      | int               | number, 1 or more; the active scalars      |
 * | StructureName  | string            |                                            |
 * | Outline        | int               | number, as given                           |
 * | SliceNumber    | int               |                                            |
 * | StructureColor | unsigned char x 3 | red, green, blue                           |
 * Point data: Pixel (float x 3: column, row, slice), and Handle (unsigned char: 1 where a point was given,
 * 0 where the curve goes between them).
 *
 * Output 1: vtkStructuredGrid, mm, the slice of number Slice, or the nearest one where a stack has only some,
 * one point a pixel, with its grey levels. Field data: PixelSize (double x 2, mm from point to point along both
 * axes), PixelOrigin and PixelStep (double x 2: column and row are origin + step times index), SliceNumber. Empty
 * where the slice has no usable pose.
 *
 * A slice without a usable pose has no place: its outlines are left out with a warning. Errors: slices that are
 * not calibrated, an outline of fewer than three points, in two slices, or in a slice that is not there, points
 * that are not finite, numbers that are not whole, a Slice before the first or behind the last one, a volume
 * with another grid than VolumeGrid.
 *
 * Both outputs are whole, on the first rank.
 */
#ifndef vtkLacunaSliceOutliner_h
#define vtkLacunaSliceOutliner_h

#include "vtkLacunaAlgorithm.h"
#include "vtkLacunaFiltersOutlinesModule.h" // for export macro
#include "vtkPolyDataAlgorithm.h"
#include "vtkSmartPointer.h" // for points

#include <array>  // for colours
#include <string> // for names
#include <vector> // for points

class vtkImageData;
class vtkPoints;
class vtkStructuredGrid;

class VTKLACUNAFILTERSOUTLINES_EXPORT vtkLacunaSliceOutliner
  : public vtkLacunaAlgorithmOf(vtkPolyDataAlgorithm)
{
public:
  static vtkLacunaSliceOutliner* New();
  vtkTypeMacro(vtkLacunaSliceOutliner, vtkPolyDataAlgorithm);

  ///@{
  /// Points of outlines, those of one outline in order and together. Each has the number of its structure
  /// (1 or more) and of its outline (one for each outline of the structure), the slice's number, column and
  /// row. Pixel (0, 0) has its middle at column 0, row 0. Default: none.
  void AddOutlinePoint(double structure, double outline, double slice, double column, double row);
  void RemoveAllOutlinePoints();
  ///@}

  ///@{
  /// Names of the structures 1, 2, ...; without one, "Structure" and the number.
  void AddStructureName(const char* name);
  void RemoveAllStructureNames();
  ///@}

  ///@{
  /// Colours of the structures 1, 2, ..., red, green, blue from 0 to 1; without one, one of seven of their own.
  void AddStructureColor(double red, double green, double blue);
  void RemoveAllStructureColors();
  ///@}

  ///@{
  /// Whether a smooth closed curve joins the points (vtkLacunaOutlineTools::MakeCurve), or straight lines.
  /// Default: on.
  vtkSetMacro(Smooth, bool);
  vtkGetMacro(Smooth, bool);
  vtkBooleanMacro(Smooth, bool);
  ///@}

  ///@{
  /// The volume in whose voxels the outlines were drawn: its spacing and origin, mm. In another one the same
  /// indices would mean other places, so it is refused. Default: 0 0 0 0 0 0, not known. Tracked slices have their
  /// own places and need none.
  vtkSetVector6Macro(VolumeGrid, double);
  vtkGetVector6Macro(VolumeGrid, double);
  ///@}

  ///@{
  /// Number of the slice of output 1: that of a sweep, or a voxel index. Default: 0.
  vtkSetMacro(Slice, int);
  vtkGetMacro(Slice, int);
  ///@}

  /// Spacing and origin of the input where it is a volume, as it is now; zeros otherwise.
  double* GetInputGrid() VTK_SIZEHINT(6);

  /// Numbers of the first and the last slice of the input, as it is now; 0 and 0 without one.
  int* GetSliceRange() VTK_SIZEHINT(2);

protected:
  vtkLacunaSliceOutliner();
  ~vtkLacunaSliceOutliner() override = default;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int FillOutputPortInformation(int port, vtkInformation* info) override;
  void Announce(const lacuna::Ports& ports) override;
  void Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution) override;
  void Describe(lacuna::Properties& properties) const override;
  std::string Parameters(int port) const override;

private:
  vtkLacunaSliceOutliner(const vtkLacunaSliceOutliner&) = delete;
  void operator=(const vtkLacunaSliceOutliner&) = delete;

  std::string GetName(int structure) const;
  std::array<unsigned char, 3> GetColor(int structure) const;

  struct Point
  {
    double Structure, Outline, Slice, Column, Row;
  };
  class Slices; // of the input
  void CheckGrid(vtkImageData* volume) const;
  void MakeOutlines(const Slices& slices, vtkPolyData* output);
  // The points of the outline that begins at next, which is then behind them; what names it in errors.
  vtkSmartPointer<vtkPoints> TakeHandles(std::size_t& next, const std::string& what) const;
  std::vector<Point> Points;
  std::vector<std::string> Names;
  std::vector<std::array<double, 3>> Colors;
  bool Smooth = true;
  int Slice = 0;
  int SliceRange[2] = { 0, 0 };
  double VolumeGrid[6] = { 0, 0, 0, 0, 0, 0 };
  double InputGrid[6] = { 0, 0, 0, 0, 0, 0 };

  // of what was made last
  int ShownSlice = 0;
  int NumberOfOutlines = 0;
};
#endif
