// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkLacunaSlicePlanes
 * @brief   Tracked slices as pictures in space
 *
 * Shows slices where they lie (see lacunaTrackedSlices.h for what these are): each becomes a
 * lattice of quadrilaterals with its grey levels, or its outline. Coloured by speed and by expected
 * error it shows where the probe was moved too fast, and where the tracker is poor (Carr 1996,
 * ch. 2).
 *
 * A lattice has every n-th pixel of the slice along both axes, and the last ones; grey levels are
 * means over n x n pixels. n is 1, or as much more as MaximumNumberOfPoints wants.
 *
 * Output: polydata in the reference frame, mm.
 * | array             | where | type          | meaning                                  |
 * |-------------------|-------|---------------|------------------------------------------|
 * | Intensity         | point | float         | grey level; not with OutlineOnly         |
 * | RegistrationError | point | float, mm     | expected RMS error of the place          |
 * | Speed             | cell  | float, mm/s   | of the fastest corner, since the slice   |
 * |                   |       |               | before that has a good pose and a time   |
 * | TooFast           | cell  | unsigned char | 1 where Speed is above SpeedLimit        |
 * | SliceNumber       | cell  | int           | number in the sweep                      |
 * | SliceStatus       | cell  | unsigned char | flags, 0 = valid                         |
 * | Timestamp         | cell  | double, s     |                                          |
 * ColorBy chooses the active scalars, which ParaView colours by. Field data: PixelStep (the n
 * above), SpeedLimit, Provenance. All points are finite.
 *
 * RegistrationError = sqrt(TranslationAccuracy^2 + (2 r sin(AngularAccuracy / 2))^2), r the
 * distance of the pixel from the origin of the probe frame, the tracker's sensor; it needs
 * ImageToProbe. Speed and Timestamp need Timestamp. Without these arrays the others are made,
 * unless ColorBy asks for one: then it is an error.
 *
 * In parallel, pieces are runs of slices; they do not depend on each other, and the result is the
 * same bit by bit for any number of threads.
 *
 * @sa lacunaSliceLattice.h, lacunaSliceMotion.h, lacunaPoseJudge.h
 */
#ifndef vtkLacunaSlicePlanes_h
#define vtkLacunaSlicePlanes_h

#include "vtkLacunaAlgorithm.h"
#include "vtkLacunaFiltersReconstructionModule.h" // for export macro
#include "vtkLacunaSliceAlgorithm.h"              // for BadPoseRules
#include "vtkPolyDataAlgorithm.h"

#include <string> // for std::string

namespace lacuna
{
class SlicePlaneBuilder;
}

class VTKLACUNAFILTERSRECONSTRUCTION_EXPORT vtkLacunaSlicePlanes
  : public vtkLacunaAlgorithmOf(vtkPolyDataAlgorithm)
{
public:
  static vtkLacunaSlicePlanes* New();
  vtkTypeMacro(vtkLacunaSlicePlanes, vtkPolyDataAlgorithm);

  enum Colorings
  {
    Intensity = 0,
    Speed = 1,
    RegistrationError = 2
  };
  enum InvalidSliceChoices
  {
    LeaveOut = 0,
    Outline = 1,
    Show = 2
  };

  ///@{
  /// Every n-th slice of the stack is shown, from the first on; n >= 1. Default: 1.
  vtkSetMacro(Stride, int);
  vtkGetMacro(Stride, int);
  ///@}

  ///@{
  /// What the slices are coloured by: Intensity, Speed (mm/s) or RegistrationError (mm).
  /// Default: Intensity.
  vtkSetMacro(ColorBy, int);
  vtkGetMacro(ColorBy, int);
  ///@}

  ///@{
  /// Root mean square error of the tracker's position in mm (three axes together), and of its
  /// orientation in degrees. Default: 1.38 and 0.26, a Polhemus FASTRAK.
  vtkSetMacro(TranslationAccuracy, double);
  vtkGetMacro(TranslationAccuracy, double);
  vtkSetMacro(AngularAccuracy, double);
  vtkGetMacro(AngularAccuracy, double);
  ///@}

  ///@{
  /// mm/s; faster slices are TooFast, and with ColorBy Speed a warning names them. 0 = no limit.
  /// Default: 23, which makes 1 mm in the 44 ms that a video frame is late.
  vtkSetMacro(SpeedLimit, double);
  vtkGetMacro(SpeedLimit, double);
  ///@}

  ///@{
  /// Only the outlines of the slices. Default: off.
  vtkSetMacro(OutlineOnly, bool);
  vtkGetMacro(OutlineOnly, bool);
  vtkBooleanMacro(OutlineOnly, bool);
  ///@}

  ///@{
  /// What becomes of slices whose SliceStatus is not 0: LeaveOut, Outline (with values that are not
  /// a number, so that they take the NaN colour) or Show (as the others). Slices without a pose are
  /// always left out. Default: LeaveOut.
  vtkSetMacro(InvalidSlices, int);
  vtkGetMacro(InvalidSlices, int);
  ///@}

  ///@{
  /// What to do with slices whose pose cannot be true though SliceStatus has nothing against it.
  /// Of vtkLacunaSliceAlgorithm::BadPoseRules, LeaveOut: a warning names them, they are not shown, and the speed of the next one is taken
  /// from the slice before them. KeepOutliers: only poses that cannot be drawn (not finite,
  /// singular, a corner beyond 1e38 mm) are left out. Default: LeaveOut.
  vtkSetMacro(BadPoses, int);
  vtkGetMacro(BadPoses, int);
  ///@}

  ///@{
  /// Points that all slices together may have, 4 or more. Default: 2 000 000.
  vtkSetMacro(MaximumNumberOfPoints, int);
  vtkGetMacro(MaximumNumberOfPoints, int);
  ///@}

protected:
  vtkLacunaSlicePlanes();
  ~vtkLacunaSlicePlanes() override = default;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  void Ask(const lacuna::Ports& ports) override;
  void Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution) override;
  void Describe(lacuna::Properties& properties) const override;

private:
  vtkLacunaSlicePlanes(const vtkLacunaSlicePlanes&) = delete;
  void operator=(const vtkLacunaSlicePlanes&) = delete;

  void WarnOfSpeed(const lacuna::SlicePlaneBuilder& builder);
  void CheckRequest(const lacuna::SlicePlaneBuilder& builder);

  int Stride = 1;
  int ColorBy = Intensity;
  double TranslationAccuracy = 1.38;
  double AngularAccuracy = 0.26;
  double SpeedLimit = 23;
  bool OutlineOnly = false;
  int InvalidSlices = LeaveOut;
  int BadPoses = vtkLacunaSliceAlgorithm::LeaveOut;
  int MaximumNumberOfPoints = 2000000;
};
#endif
