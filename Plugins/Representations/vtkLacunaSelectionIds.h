// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkLacunaSelectionIds
 * @brief   numbers of the image's points and cells on what is shown of it in space
 *
 * For representations: input 0 is the surface that is shown, input 1 the image that it was made of, a depth
 * map (the surface has PixelId) or tracked slices (it has SliceNumber). Gives
 * points and cells the ids that they have in the image. ParaView selects by these ids.
 */
#ifndef vtkLacunaSelectionIds_h
#define vtkLacunaSelectionIds_h

#include "vtkPolyDataAlgorithm.h"

class vtkLacunaSelectionIds : public vtkPolyDataAlgorithm
{
public:
  static vtkLacunaSelectionIds* New();
  vtkTypeMacro(vtkLacunaSelectionIds, vtkPolyDataAlgorithm);

  /// Makes a representation's geometry filter keep these ids.
  static void Use(vtkAlgorithm* geometry);

protected:
  vtkLacunaSelectionIds();
  ~vtkLacunaSelectionIds() override = default;

  int FillInputPortInformation(int port, vtkInformation* information) override;
  int RequestData(
    vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;

private:
  vtkLacunaSelectionIds(const vtkLacunaSelectionIds&) = delete;
  void operator=(const vtkLacunaSelectionIds&) = delete;
};
#endif
