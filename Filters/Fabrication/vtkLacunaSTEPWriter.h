// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkLacunaSTEPWriter
 * @brief a closed surface as a solid in a STEP file, for CAD programs
 *
 * Writes STEP AP214, unit mm, in the coordinates of the data, never mirrored. The input is a closed surface of
 * triangles that face outwards, as 3MF takes it: open, branching or inside out ones are refused, with a place.
 * Several closed pieces become several solids. Cavities belong to the solid around them.
 *
 * The file has flat faces, no curved ones. As few are searched as keep all of the surface within Tolerance, the
 * volume within 0.05 %, and do not pass through each other; triangles in one plane become one face
 * (lacuna::MakeFacetedSolid). More than 100 000 are refused.
 *
 * OpenCASCADE makes the file in a process of its own (lacuna-step), after it found the solids valid and their
 * volume the same. Where Lacuna was built without OpenCASCADE, Write() fails with the error what to install.
 * The header has the deviation that was measured and the steps of the provenance.
 *
 * The file is written beside its final name and renamed when it is complete. On failure Write()
 * returns 0, GetErrorCode() says why (vtkErrorCode), and what was at FileName stays. In parallel
 * each process has a writer, with its number as Piece; all bring the whole input up to date, and
 * piece 0 writes.
 *
 * Source: ISO 10303-21, -214.
 */
#ifndef vtkLacunaSTEPWriter_h
#define vtkLacunaSTEPWriter_h

#include "vtkLacunaFiltersFabricationModule.h" // for export macro
#include "vtkLacunaWriter.h"

class vtkPolyData;

class VTKLACUNAFILTERSFABRICATION_EXPORT vtkLacunaSTEPWriter : public vtkLacunaWriter
{
public:
  static vtkLacunaSTEPWriter* New();
  vtkTypeMacro(vtkLacunaSTEPWriter, vtkLacunaWriter);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /** The file to write, usually *.step or *.stp. */
  vtkSetFilePathMacro(FileName);
  vtkGetFilePathMacro(FileName);
  ///@}

  ///@{
  /** Largest distance in mm between the surface and the flat faces, both ways; 0: a face for each
   * triangle, or for those in one plane. Default 0.02. */
  vtkSetMacro(Tolerance, double);
  vtkGetMacro(Tolerance, double);
  ///@}

  ///@{
  /** Also write data marked as a mirror image by the field data array Mirrored. Default off. */
  vtkSetMacro(AllowMirrored, bool);
  vtkGetMacro(AllowMirrored, bool);
  vtkBooleanMacro(AllowMirrored, bool);
  ///@}

  ///@{
  /** A line for the header, such as in which coordinates the data are. Default: none. */
  vtkSetStringMacro(Note);
  vtkGetStringMacro(Note);
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
  /** Of the last Write(): the largest distance in mm that was measured between the surface and the faces;
   * solids, faces, bytes. 0 when it failed. */
  vtkGetMacro(MaximumDeviation, double);
  vtkGetMacro(NumberOfSolids, int);
  vtkGetMacro(NumberOfFaces, int);
  vtkGetMacro(FileSize, vtkTypeInt64);
  ///@}

protected:
  vtkLacunaSTEPWriter() = default;
  ~vtkLacunaSTEPWriter() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  void WriteFile() override;
  void Describe(lacuna::Properties& properties) const override;
  void ClearResults() override;

private:
  vtkLacunaSTEPWriter(const vtkLacunaSTEPWriter&) = delete;
  void operator=(const vtkLacunaSTEPWriter&) = delete;

  void WriteSolid(vtkPolyData* surface);

  double Tolerance = 0.02;
  bool AllowMirrored = false;
  char* Note = nullptr;
  double MaximumDeviation = 0;
  int NumberOfSolids = 0;
  int NumberOfFaces = 0;
};
#endif
