// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkLacunaSplineLoop
 * @brief a loop through points, as region of what it encloses
 *
 * Its Loop is a cardinal spline through the points (parametrised by length, as ParaView's spline
 * widget draws it). With three points or more that differ it has 32 corners per point; with fewer it
 * is these points. vtkLacunaRBFHoleFiller takes it, like each vtkImplicitSelectionLoop with
 * AutomaticNormalGeneration, as its map sees it: what it encloses, at whatever depth. To other
 * filters it is the prism along its mean normal. World coordinates, mm.
 */
#ifndef vtkLacunaSplineLoop_h
#define vtkLacunaSplineLoop_h

#include "vtkImplicitSelectionLoop.h"
#include "vtkLacunaFiltersRadialBasisModule.h" // for export macro
#include "vtkNew.h"                            // for ivar

class vtkPoints;

class VTKLACUNAFILTERSRADIALBASIS_EXPORT vtkLacunaSplineLoop : public vtkImplicitSelectionLoop
{
public:
  static vtkLacunaSplineLoop* New();
  vtkTypeMacro(vtkLacunaSplineLoop, vtkImplicitSelectionLoop);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /** The points of the spline; new ones lie at the origin. Indices that do not exist are an error. */
  void SetNumberOfPoints(vtkIdType count);
  vtkIdType GetNumberOfPoints();
  void SetPoint(vtkIdType index, double x, double y, double z);
  void GetPoint(vtkIdType index, double point[3]);
  ///@}

  ///@{
  /** Off: the spline ends at the last point, and a straight line joins that to the first. Default on. */
  void SetClosed(vtkTypeBool closed);
  vtkGetMacro(Closed, vtkTypeBool);
  vtkBooleanMacro(Closed, vtkTypeBool);
  ///@}

protected:
  vtkLacunaSplineLoop();
  ~vtkLacunaSplineLoop() override;

private:
  vtkLacunaSplineLoop(const vtkLacunaSplineLoop&) = delete;
  void operator=(const vtkLacunaSplineLoop&) = delete;

  bool HasPoint(vtkIdType index);
  void UpdateLoop();

  vtkNew<vtkPoints> Points;
  vtkTypeBool Closed = 1;
};
#endif
