// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkLacunaOutlineReader
 * @brief reads outlines of structures that 3D Slicer, planning systems or Lacuna wrote
 *
 * FileName is a file of one of three formats, told by its content:
 *
 * - markups of 3D Slicer (.mrk.json): the control points of closed curves. Slicer's curve through
 *   them is not in the file. LPS and RAS are read.
 * - a DICOM RT structure set: contours of type CLOSED_PLANAR.
 * - a table with commas and a header: structure, outline, x, y, z (mm), one row a point; slice where
 *   it is known. Other columns are ignored.
 *
 * The output is a vtkPolyData in mm. Each outline is a closed polyline, whose first point id is
 * repeated at its end. Cell data:
 *
 * - `Structure` (int): number of the structure, from 1. Outlines with the same name are one structure.
 * - `StructureName` (string)
 * - `Outline` (int): number in the table, else from 1 over the file
 * - `SliceNumber` (int): -1 where it is not known
 * - `StructureColor` (unsigned char, 3 components), the active scalars
 *
 * Field data: `Coordinates` = Patient (lacuna::Coordinates) for markups and DICOM, which are in
 * patient coordinates (LPS); `Provenance`, with a hash of the file's name. Nothing of the patient is
 * copied. What is left out is a warning. Errors set vtkErrorCode::FileNotFoundError or
 * FileFormatError.
 */
#ifndef vtkLacunaOutlineReader_h
#define vtkLacunaOutlineReader_h

#include "vtkLacunaAlgorithm.h"
#include "vtkLacunaReadersOutlinesModule.h" // for export macro
#include "vtkPolyDataAlgorithm.h"

class VTKLACUNAREADERSOUTLINES_EXPORT vtkLacunaOutlineReader
  : public vtkLacunaAlgorithmOf(vtkPolyDataAlgorithm)
{
public:
  static vtkLacunaOutlineReader* New();
  vtkTypeMacro(vtkLacunaOutlineReader, vtkPolyDataAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /// The file.
  vtkSetFilePathMacro(FileName);
  vtkGetFilePathMacro(FileName);
  ///@}

  /// Whether a file has outlines: an RT structure set, markups of 3D Slicer, or a table with the
  /// columns above. Looks at its beginning, of DICOM into the headers.
  int CanReadFile(VTK_FILEPATH const char* fileName);

protected:
  vtkLacunaOutlineReader();
  ~vtkLacunaOutlineReader() override;

  void Announce(const lacuna::Ports& ports) override;
  void Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution) override;
  std::string Parameters(int port) const override;

private:
  vtkLacunaOutlineReader(const vtkLacunaOutlineReader&) = delete;
  void operator=(const vtkLacunaOutlineReader&) = delete;

  char* FileName = nullptr;
};
#endif
