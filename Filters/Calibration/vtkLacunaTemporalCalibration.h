// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkLacunaTemporalCalibration
 * @brief   Finds by how much the video lags behind the tracker
 *
 * The probe is moved to and fro before a flat floor. In each slice the floor's row is found
 * (lacunaWallDetection.h), and the lag is the one at which the receiver's position explains it best
 * (lacunaTemporalCalibration.h).
 *
 * Input: tracked slices (lacunaTrackedSlices.h) with the field data arrays ProbeToTracker and
 * Timestamp; the probe need not be calibrated. Slices that do not show the floor, or have no pose,
 * are left out.
 *
 * Output: vtkTable with the columns Lag (s) and Correlation (0 to 1). Field data: TimeOffset (s, to
 * add to the frames' times to get those of the poses that belong to them; negative when the video is
 * late), LagSpread (s, its standard deviation), Correlation (at the best lag), Frames (used).
 *
 * It is an error when fewer than 30 slices can be used, nothing moves, image and tracker do not move
 * together, or the best lag is at the end of the range.
 *
 * @sa vtkLacunaProbeCalibration
 */
#ifndef vtkLacunaTemporalCalibration_h
#define vtkLacunaTemporalCalibration_h

#include "vtkLacunaAlgorithm.h"
#include "vtkLacunaFiltersCalibrationModule.h" // for export macro
#include "vtkTableAlgorithm.h"

class VTKLACUNAFILTERSCALIBRATION_EXPORT vtkLacunaTemporalCalibration
  : public vtkLacunaAlgorithmOf(vtkTableAlgorithm)
{
public:
  static vtkLacunaTemporalCalibration* New();
  vtkTypeMacro(vtkLacunaTemporalCalibration, vtkTableAlgorithm);

  ///@{
  /// Lags up to this many s, either way, are tried, above 0 and at most 2. Default: 0.5.
  vtkSetMacro(MaximumLag, double);
  vtkGetMacro(MaximumLag, double);
  ///@}

protected:
  vtkLacunaTemporalCalibration();
  ~vtkLacunaTemporalCalibration() override = default;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  void Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution) override;
  void Describe(lacuna::Properties& properties) const override;

private:
  vtkLacunaTemporalCalibration(const vtkLacunaTemporalCalibration&) = delete;
  void operator=(const vtkLacunaTemporalCalibration&) = delete;

  double MaximumLag = 0.5;
};
#endif
