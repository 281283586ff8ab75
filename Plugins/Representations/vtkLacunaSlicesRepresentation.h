// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkLacunaSlicesRepresentation
 * @brief   "Slices in Space": tracked slices as pictures, where they lie
 *
 * For an image stack with poses, as Tracked Slice Reader makes it, this shows what Slice Planes makes
 * of it, without a filter in the pipeline: filters and selections still see the stack. The pictures are
 * not lit: their grey levels are those of the image from any side. What is dark is left out, so that
 * slices do not hide each other; transparency would need a pass of drawing for each slice.
 *
 * @sa vtkLacunaSlicePlanes
 */
#ifndef vtkLacunaSlicesRepresentation_h
#define vtkLacunaSlicesRepresentation_h

#include "vtkGeometryRepresentationWithFaces.h"
#include "vtkLacunaRepresentationsModule.h" // for export macro
#include "vtkNew.h"                         // for the filter

class vtkLacunaSelectionIds;
class vtkLacunaSlicePlanes;
class vtkThreshold;

class VTKLACUNAREPRESENTATIONS_EXPORT vtkLacunaSlicesRepresentation
  : public vtkGeometryRepresentationWithFaces
{
public:
  static vtkLacunaSlicesRepresentation* New();
  vtkTypeMacro(vtkLacunaSlicesRepresentation, vtkGeometryRepresentationWithFaces);

  ///@{
  /// Every n-th slice is shown; n >= 1. Default: 1.
  void SetStride(int stride);
  /// What is at or below this grey level is not shown. Default: 0.
  void SetDark(double level);
  ///@}

  /// Not lit: from 5.13 on the superclass turns the light on again at each request.
  int ProcessViewRequest(
    vtkInformationRequestKey* request, vtkInformation* input, vtkInformation* output) override;

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
  vtkNew<vtkLacunaSelectionIds> Ids;
  vtkNew<vtkThreshold> Bright;
};
#endif
