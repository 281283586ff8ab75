// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkLacunaSlicesRepresentation
 * @brief   "Slices in Space": tracked slices as pictures, where they lie
 *
 * For an image stack with poses, as Tracked Slice Reader makes it, this shows what Slice Planes makes
 * of it, without a filter in the pipeline: filters and selections still see the stack. The pictures are
 * not lit: their grey levels are those of the image from any side.
 *
 * @sa vtkLacunaSlicePlanes
 */
#ifndef vtkLacunaSlicesRepresentation_h
#define vtkLacunaSlicesRepresentation_h

#include "vtkGeometryRepresentationWithFaces.h"
#include "vtkLacunaRepresentationsModule.h" // for export macro
#include "vtkNew.h"                         // for the filter

class vtkLacunaSlicePlanes;

class VTKLACUNAREPRESENTATIONS_EXPORT vtkLacunaSlicesRepresentation
  : public vtkGeometryRepresentationWithFaces
{
public:
  static vtkLacunaSlicesRepresentation* New();
  vtkTypeMacro(vtkLacunaSlicesRepresentation, vtkGeometryRepresentationWithFaces);

  using Superclass::GetInternalOutputPort;
  /// What the superclass shows: the slices in space instead of the stack.
  vtkAlgorithmOutput* GetInternalOutputPort(int port, int connection) override;

protected:
  vtkLacunaSlicesRepresentation();
  ~vtkLacunaSlicesRepresentation() override;

  int FillInputPortInformation(int port, vtkInformation* information) override;

private:
  vtkLacunaSlicesRepresentation(const vtkLacunaSlicesRepresentation&) = delete;
  void operator=(const vtkLacunaSlicesRepresentation&) = delete;

  vtkNew<vtkLacunaSlicePlanes> Planes;
};
#endif
