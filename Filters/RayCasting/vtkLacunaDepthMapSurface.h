// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkLacunaDepthMapSurface
 * @brief triangulated surface of a depth map, in world coordinates
 *
 * One point per pixel that has a depth, one or two triangles per square of pixels. Front faces and
 * normals are towards the viewer. Neighbours are not joined across a discontinuity of depth, so
 * that no skin hangs between what is near and what is far.
 *
 * The rule is that of the nine cases by which vtkLacunaDepthMapShader's normals (Predicate) see
 * discontinuities. The angle of an edge is that between it and the plane perpendicular to the ray. An
 * edge steeper than MaximumAngle is kept only if the surface goes on alike beyond both of its ends:
 * the next edge on the same line differs by less than MaximumAngleChange or is steeper than
 * MaximumAngle the same way, and its step of depth is at least a third of this one's; or there is no
 * next edge. A steep side of a skull, which bends smoothly, stays whole.
 *
 * Input: a depth map, see lacunaDepthMap.h. Output: vtkPolyData with points in double precision;
 * all point arrays of the map are carried along, the normals that belong to DepthArray being the
 * active normals, and Color, which a shaded map has, the active scalars (without it, DepthArray);
 * PixelId (vtkIdType, pedigree ids): column + row * W, counted from the corner of the map's whole
 * extent, so that a selection made with the mouse means pixels; if asked for, NormalDifference (float,
 * degrees): the angle between the map's normals and those that the depths give by the nine cases, NaN
 * where the map has none.
 * Pieces split the map into bands of rows.
 *
 * Errors: the input is not a depth map, it has no such DepthArray, it has no normals to
 * compare, an angle is out of range.
 *
 * Source: Carr 1996, 3.3.2.
 *
 * @sa vtkLacunaBSplineIsoRayCaster vtkLacunaDepthMapShader
 */
#ifndef vtkLacunaDepthMapSurface_h
#define vtkLacunaDepthMapSurface_h

#include "vtkLacunaAlgorithm.h"
#include "vtkLacunaFiltersRayCastingModule.h" // for export macro
#include "vtkPolyDataAlgorithm.h"

#include <string> // for std::string

class VTKLACUNAFILTERSRAYCASTING_EXPORT vtkLacunaDepthMapSurface
  : public vtkLacunaAlgorithmOf(vtkPolyDataAlgorithm)
{
public:
  static vtkLacunaDepthMapSurface* New();
  vtkTypeMacro(vtkLacunaDepthMapSurface, vtkPolyDataAlgorithm);

  ///@{
  /** The point array with the depths in mm. Default Depth; Fitted shows the fit of a filled map. */
  vtkSetMacro(DepthArray, std::string);
  vtkGetMacro(DepthArray, std::string);
  ///@}

  ///@{
  /** Whether neighbours are left apart at discontinuities. Default on. */
  vtkSetMacro(BreakAtDiscontinuities, bool);
  vtkGetMacro(BreakAtDiscontinuities, bool);
  vtkBooleanMacro(BreakAtDiscontinuities, bool);
  ///@}

  ///@{
  /** Edges up to this angle are always kept. Degrees, 0..90, default 65. */
  vtkSetMacro(MaximumAngle, double);
  vtkGetMacro(MaximumAngle, double);
  ///@}

  ///@{
  /** How far a steep edge may differ from the next. Degrees, 0..180, default 20. */
  vtkSetMacro(MaximumAngleChange, double);
  vtkGetMacro(MaximumAngleChange, double);
  ///@}

  ///@{
  /** Whether NormalDifference is made. Default off. */
  vtkSetMacro(ComputeNormalDifference, bool);
  vtkGetMacro(ComputeNormalDifference, bool);
  vtkBooleanMacro(ComputeNormalDifference, bool);
  ///@}

protected:
  vtkLacunaDepthMapSurface() { this->Sharing = lacuna::Share::Parts; }
  ~vtkLacunaDepthMapSurface() override = default;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  void Announce(const lacuna::Ports& ports) override;
  void Ask(const lacuna::Ports& ports) override;
  void Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution) override;
  void Describe(lacuna::Properties& properties) const override;

  std::string DepthArray = "Depth";
  bool BreakAtDiscontinuities = true;
  double MaximumAngle = 65;
  double MaximumAngleChange = 20;
  bool ComputeNormalDifference = false;

private:
  vtkLacunaDepthMapSurface(const vtkLacunaDepthMapSurface&) = delete;
  void operator=(const vtkLacunaDepthMapSurface&) = delete;
};
#endif
