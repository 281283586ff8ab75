// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkLacunaReliefRepresentation
 * @brief   "Relief in Space": a depth map as the surface that it is of, where it lies
 *
 * For a depth map this shows what Depth Map Surface makes of it, without a filter in the pipeline. The map
 * is seen in patient coordinates then: what is picked on it, and regions beside it, have the same millimetres.
 *
 * @sa vtkLacunaDepthMapSurface
 */
#ifndef vtkLacunaReliefRepresentation_h
#define vtkLacunaReliefRepresentation_h

#include "vtkGeometryRepresentationWithFaces.h"
#include "vtkLacunaRepresentationsModule.h" // for export macro
#include "vtkNew.h"                         // for the filter

class vtkLacunaDepthMapSurface;
class vtkLacunaSelectionIds;

class VTKLACUNAREPRESENTATIONS_EXPORT vtkLacunaReliefRepresentation
  : public vtkGeometryRepresentationWithFaces
{
public:
  static vtkLacunaReliefRepresentation* New();
  vtkTypeMacro(vtkLacunaReliefRepresentation, vtkGeometryRepresentationWithFaces);

  using Superclass::GetInternalOutputPort;
  /// What the superclass shows: the surface in space instead of the map.
  vtkAlgorithmOutput* GetInternalOutputPort(int port, int connection) override;

protected:
  vtkLacunaReliefRepresentation();
  ~vtkLacunaReliefRepresentation() override;

  int FillInputPortInformation(int port, vtkInformation* information) override;

private:
  vtkLacunaReliefRepresentation(const vtkLacunaReliefRepresentation&) = delete;
  void operator=(const vtkLacunaReliefRepresentation&) = delete;

  vtkNew<vtkLacunaDepthMapSurface> Surface;
  vtkNew<vtkLacunaSelectionIds> Ids;
};
#endif
