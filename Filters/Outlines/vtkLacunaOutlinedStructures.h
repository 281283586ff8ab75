// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkLacunaOutlinedStructures
 * @brief   Surfaces and volumes of outlined structures
 *
 * Input: closed lines in mm, each in a plane, with the cell arrays of vtkLacunaSliceOutliner. Without
 * `Structure` all lines are of one structure. Each structure gets its own closed surface
 * (vtkLacunaRBFSurface); one whose outlines did not change is not made again.
 *
 * Output 0: vtkPolyData, the surfaces, with the point arrays of vtkLacunaRBFSurface and the cell arrays
 * Structure and StructureColor.
 *
 * Output 1: vtkTable, a row for each structure:
 * | column                | meaning                                                              |
 * |-----------------------|----------------------------------------------------------------------|
 * | Structure, Name       | number, and name                                                     |
 * | Outlines              | how many                                                             |
 * | Volume (ml)           | enclosed by the surface                                              |
 * | Standard error (ml)   | of the volume: of drawing (vtkLacunaRBFSurface), and of registration |
 * | Area (cm2)            | of the surface                                                       |
 * | Largest diameter (mm) | between any two points of the surface                                |
 * | Centroid X, Y, Z (mm) | of the solid                                                         |
 * | Status                | empty, or why there is no closed surface; numbers are then NaN       |
 * A structure needs outlines in three planes. One that cannot be made is told of by a warning, and the others are
 * made. Lines that lie within each other in one plane enclose what is between them; lines that cross make no surface.
 *
 * The error of registration: each slice (SliceNumber; without one, each outline) is displaced on its own by
 * RegistrationError. To first order the volume then changes by the displacement times the vector area of that
 * part of the surface that is nearest to its outlines. Errors that all slices share move the structure and do not change its volume.
 *
 * Both outputs are whole, on the first rank.
 */
#ifndef vtkLacunaOutlinedStructures_h
#define vtkLacunaOutlinedStructures_h

#include "vtkLacunaAlgorithm.h"
#include "vtkLacunaFiltersOutlinesModule.h" // for export macro
#include "vtkPolyDataAlgorithm.h"
#include "vtkSmartPointer.h" // for surfaces

#include <memory> // for what is kept
#include <vector> // for what is kept

namespace lacuna
{
class AlgorithmExecution;
}

class VTKLACUNAFILTERSOUTLINES_EXPORT vtkLacunaOutlinedStructures
  : public vtkLacunaAlgorithmOf(vtkPolyDataAlgorithm)
{
public:
  static vtkLacunaOutlinedStructures* New();
  vtkTypeMacro(vtkLacunaOutlinedStructures, vtkPolyDataAlgorithm);

  struct Input; ///< outlines of a structure

  ///@{
  /// Error of a slice's place, mm RMS of the three axes together, independent from slice to slice.
  /// A tracker's: Slice Planes' RegistrationError. Default: 0.
  vtkSetMacro(RegistrationError, double);
  vtkGetMacro(RegistrationError, double);
  ///@}

  ///@{
  /// Expected error of the drawn points, mm. Default 0: estimated from the outlines.
  vtkSetMacro(Smoothing, double);
  vtkGetMacro(Smoothing, double);
  ///@}

  ///@{
  /// Edges of the triangles, mm. Default 0: a fortieth of a structure's extent.
  vtkSetMacro(OutputSpacing, double);
  vtkGetMacro(OutputSpacing, double);
  ///@}

protected:
  vtkLacunaOutlinedStructures();
  ~vtkLacunaOutlinedStructures() override;

  int FillOutputPortInformation(int port, vtkInformation* info) override;
  void Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution) override;
  void Describe(lacuna::Properties& properties) const override;

private:
  vtkLacunaOutlinedStructures(const vtkLacunaOutlinedStructures&) = delete;
  void operator=(const vtkLacunaOutlinedStructures&) = delete;

  struct Kept;
  struct Listener;
  /// What an earlier execution made of the same outlines, or made now.
  std::shared_ptr<const Kept> Make(
    const Input& structure, lacuna::AlgorithmExecution& execution) const;
  /// Empty, or of no use, when the listener hears of an error.
  vtkSmartPointer<vtkPolyData> MakeSurface(vtkPolyData* lines, Listener& listener) const;

  std::vector<std::shared_ptr<const Kept>> Made; ///< of the last execution
  double RegistrationError = 0;
  double Smoothing = 0;
  double OutputSpacing = 0;
};
#endif
