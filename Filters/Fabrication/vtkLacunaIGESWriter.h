// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkLacunaIGESWriter
 * @brief surfaces, outlines and points in an IGES file, for CAD and milling programs
 *
 * Writes IGES 5.3, unit mm, in the coordinates of the data (patient or press), never mirrored:
 *
 * | input                                       | in the file                                   |
 * |---------------------------------------------|-----------------------------------------------|
 * | depth map (vtkImageData, lacuna::DepthMap)  | a bicubic B-spline surface (128), of Fitted   |
 * |                                             | where there is one; the defect's outline as   |
 * |                                             | curve (126), or trimmed to it (144, 142, 126) |
 * | vtkStructuredGrid with one dimension of 1   | a bicubic B-spline surface (128)              |
 * | lines of a vtkPolyData                      | lines (110), joined by 102 to poly lines      |
 * | vertices of a vtkPolyData                   | points (116)                                  |
 * | its field data HoleCenters, HoleAxes        | points (116) and lines of 10 mm (110)         |
 * | multi-block, partitioned (collection)       | all blocks, each under its name               |
 *
 * Other data are refused, or left out with a warning (SkipUnsupported). Every thing has a name (406
 * form 15), a colour (314) and a level: 1 surfaces, 2 curves, 3 points and axes.
 *
 * Surfaces are C2 and polynomial with clamped knots. Of a depth map the rectangle of pixels where
 * Fitted (or Depth) is a number is written, which must be complete. u runs along the columns, v
 * along the rows, both in pixels from the rectangle's first one; in a parallel map the surface is
 * exactly linear in u and v but for the depth. dS/du x dS/dv points away from the viewer (into the
 * body). Of a structured grid u is the first and v the second of the two dimensions.
 *
 * With Tolerance > 0 a surface has as few control points as found by a search for knots, and no
 * sample deviates by more than Tolerance from the surface at its parameters; coordinates are
 * rounded to a tenth of Tolerance or finer to keep the file small. With 0 it interpolates all
 * samples (not-a-knot ends) and is written with as many digits as a double has.
 *
 * Outlines come from FilledMask: its half-way contour, freed of the staircase of pixels, as closed
 * C2 cubics that lie on the surface within Tolerance.
 *
 * What has been mirrored, scaled or bent since it was made for the press (PressPosition) is refused, and
 * so are screw holes of a plate that lies elsewhere than they, and the plane of a depth map's pixels
 * (a map behind Transform). What only lies elsewhere, and what is made of such (MovedSincePress), is
 * written AsGiven only, with a warning, and the start section says that its way to the patient is not
 * known.
 *
 * The file is written beside its final name and renamed when it is complete. On failure Write()
 * returns 0, GetErrorCode() says why (vtkErrorCode), and what was at FileName stays. In parallel
 * each process has a writer, with its number as Piece; all bring the whole input up to date, and
 * piece 0 writes.
 *
 * Source: Carr 1996, ch. 6 (fabrication); IGES 5.3.
 */
#ifndef vtkLacunaIGESWriter_h
#define vtkLacunaIGESWriter_h

#include "vtkLacunaFiltersFabricationModule.h" // for export macro
#include "vtkLacunaWriter.h"

namespace lacuna
{
class CADContent;
struct IGESHeader;
}

class VTKLACUNAFILTERSFABRICATION_EXPORT vtkLacunaIGESWriter : public vtkLacunaWriter
{
public:
  static vtkLacunaIGESWriter* New();
  vtkTypeMacro(vtkLacunaIGESWriter, vtkLacunaWriter);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /** The file to write, usually *.igs or *.iges. */
  vtkSetFilePathMacro(FileName);
  vtkGetFilePathMacro(FileName);
  ///@}

  ///@{
  /** Largest deviation of a sample in mm, default 0.001; 0 interpolates. */
  vtkSetMacro(Tolerance, double);
  vtkGetMacro(Tolerance, double);
  ///@}

  /** What becomes of the outline of the defect in depth maps with FilledMask. */
  enum DefectOutlineType
  {
    None,  ///< it is not written
    Curve, ///< a curve beside the whole surface; the default
    Trim   ///< the surface ends at it
  };
  ///@{
  /** A DefectOutlineType. */
  vtkSetMacro(DefectOutline, int);
  vtkGetMacro(DefectOutline, int);
  ///@}

  /** The frame of the file. */
  enum CoordinatesType
  {
    AsGiven, ///< that of the input, which must be one; the default
    Patient, ///< data with PressToPatient are brought to the patient
    Press    ///< data without PressToPatient are brought to the press
  };
  ///@{
  /** A CoordinatesType. */
  vtkSetMacro(Coordinates, int);
  vtkGetMacro(Coordinates, int);
  ///@}

  ///@{
  /** Also write data marked as a mirror image by the field data array Mirrored. Default off. */
  vtkSetMacro(AllowMirrored, bool);
  vtkGetMacro(AllowMirrored, bool);
  vtkBooleanMacro(AllowMirrored, bool);
  ///@}

  ///@{
  /** Leave out, with a warning, what IGES cannot represent here, as triangles. Default off: an
   * error. */
  vtkSetMacro(SkipUnsupported, bool);
  vtkGetMacro(SkipUnsupported, bool);
  vtkBooleanMacro(SkipUnsupported, bool);
  ///@}

  ///@{
  /** Number of this process, and of processes; only piece 0 writes. ParaView sets them. Default: 0
   * and 1. */
  vtkSetClampMacro(Piece, int, 0, VTK_INT_MAX);
  vtkGetMacro(Piece, int);
  vtkSetClampMacro(NumberOfPieces, int, 1, VTK_INT_MAX);
  vtkGetMacro(NumberOfPieces, int);
  ///@}

  ///@{
  /** What the last Write() achieved: the largest distance in mm between a sample and its surface as
   * written, at the sample's parameters; control points along u and v of the first surface; how
   * many surfaces, curves (lines among them) and points there are; bytes. 0 when it failed. */
  vtkGetMacro(MaximumDeviation, double);
  vtkGetVector2Macro(NumberOfControlPoints, int);
  vtkGetMacro(NumberOfSurfaces, int);
  vtkGetMacro(NumberOfCurves, int);
  vtkGetMacro(NumberOfPoints, int);
  vtkGetMacro(FileSize, vtkTypeInt64);
  ///@}

protected:
  vtkLacunaIGESWriter() = default;
  ~vtkLacunaIGESWriter() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  void WriteFile() override;
  void Describe(lacuna::Properties& properties) const override;
  void ClearResults() override;

private:
  vtkLacunaIGESWriter(const vtkLacunaIGESWriter&) = delete;
  void operator=(const vtkLacunaIGESWriter&) = delete;

  struct Options;
  lacuna::IGESHeader MakeHeader(const lacuna::CADContent& content);
  void SetResults(const lacuna::CADContent& content);

  double Tolerance = 0.001;
  int DefectOutline = Curve;
  int Coordinates = AsGiven;
  bool AllowMirrored = false;
  bool SkipUnsupported = false;
  double MaximumDeviation = 0;
  int NumberOfControlPoints[2] = { 0, 0 };
  int NumberOfSurfaces = 0;
  int NumberOfCurves = 0;
  int NumberOfPoints = 0;
};
#endif
