// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkLacunaIGESWriter
 * @brief one bicubic B-spline surface in an IGES file, for CAD and milling programs
 *
 * Writes a depth map (vtkImageData, contract vtkLacunaDepthMap) or a structured surface
 * (vtkStructuredGrid with one dimension of 1) as one C2 bicubic polynomial B-spline surface (IGES
 * 5.3, entity 128, clamped knots), unit mm, in world (patient) coordinates, never mirrored.
 *
 * Of a depth map with the array Fitted the rectangle of pixels where Fitted is a number is written,
 * without it the rectangle where Depth is. The rectangle must be complete. u runs along the
 * columns, v along the rows, both in pixels from the rectangle's first one; in a parallel map the
 * surface is exactly linear in u and v but for the depth. dS/du x dS/dv points away from the viewer
 * (into the body). Of a structured grid u is the first and v the second of the two dimensions.
 *
 * With Tolerance > 0 the surface has as few control points as found by a search for knots, and no
 * sample deviates by more than Tolerance from the surface at its parameters; the control points are
 * rounded to a tenth of Tolerance or finer to keep the file small. With 0 it interpolates all
 * samples (not-a-knot ends) and is written with as many digits as a double has.
 *
 * The file is written beside its final name and renamed when it is complete. On failure Write()
 * returns 0, GetErrorCode() says why (vtkErrorCode), and what was at FileName stays.
 *
 * Source: Carr 1996, ch. 6 (fabrication); IGES 5.3.
 */
#ifndef vtkLacunaIGESWriter_h
#define vtkLacunaIGESWriter_h

#include "vtkLacunaFiltersFabricationModule.h" // for export macro
#include "vtkWriter.h"

class VTKLACUNAFILTERSFABRICATION_EXPORT vtkLacunaIGESWriter : public vtkWriter
{
public:
  static vtkLacunaIGESWriter* New();
  vtkTypeMacro(vtkLacunaIGESWriter, vtkWriter);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /** Updates the input and writes. Returns 1, or 0 when there is no new file, also because a filter
   * before this one failed. */
  int Write() override;

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

  ///@{
  /** What the last Write() achieved: the largest distance in mm between a sample and the surface as
   * written, at the sample's parameters; control points along u and v; bytes. 0 when it failed. */
  vtkGetMacro(MaximumDeviation, double);
  vtkGetVector2Macro(NumberOfControlPoints, int);
  vtkGetMacro(FileSize, vtkTypeInt64);
  ///@}

protected:
  vtkLacunaIGESWriter() = default;
  ~vtkLacunaIGESWriter() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  void WriteData() override;

private:
  vtkLacunaIGESWriter(const vtkLacunaIGESWriter&) = delete;
  void operator=(const vtkLacunaIGESWriter&) = delete;

  void WriteSurface();

  char* FileName = nullptr;
  double Tolerance = 0.001;
  double MaximumDeviation = 0;
  int NumberOfControlPoints[2] = { 0, 0 };
  vtkTypeInt64 FileSize = 0;
};
#endif
