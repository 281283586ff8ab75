// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkLacunaProbeCalibration
 * @brief   Finds where the image of a tracked ultrasound probe lies on the probe
 *
 * A tracker measures where its receiver on the probe is; calibration finds ImageToProbe, from
 * (column, row) of the image to mm in the receiver's coordinate system. A phantom is scanned from
 * many sides, and what is seen of it is picked:
 *
 * - ThreeWires: three thin wires at right angles that cross in one point (Carr 1996, appendix A)
 * - SingleWall: a flat floor or wall, such as that of a water bath (Prager et al. 1998)
 * - PointTarget: a point that does not move, such as a small ball or the tip of a needle
 *
 * StylusPivot finds the tip of a stylus that carries the receiver instead, from poses alone, while it
 * is tilted to all sides with the tip in a hole.
 *
 * The equations are solved from many starts without a first guess, picks that do not agree with the
 * others are left out, and the result says how exact it is and which motion of the probe would make
 * it more so (lacunaProbeCalibration.h).
 *
 * Input port 0: tracked slices (lacunaTrackedSlices.h) with the field data array
 * ProbeToTracker (StylusPivot: StylusToTracker, or else this); the probe need not be calibrated.
 * Slices with any flag of SliceStatus are left out of what is found by itself (StylusPivot: those
 * without a pose and those gated out), and it is said how many. Port 1: the picks, a vtkTable with the columns
 * Slice (number in the sweep, 0-based), Column, Row (pixels, not whole numbers only) and for
 * ThreeWires Wire (text X, Y or Z; else Target, as in output port 1, else WireRanges), or a
 * vtkPointSet whose points are (column, row, slice), as a selection of the slices' points has them.
 * Optional: for SingleWall the floor's line is looked for in each slice (lacunaWallDetection.h), for
 * ThreeWires the bright spot in each slice of WireRanges, for PointTarget that in all slices
 * (lacunaSpotTracking.h).
 *
 * Output port 0: the slices, calibrated: field data ImageToProbe and ImageToReference, whose reference
 * frame is the tracker. Port 1: vtkTable of the picks with their places in the phantom (PhantomX,
 * PhantomY, PhantomZ, mm), Error (mm, from the wire, wall or point), Score (1 of picks that were given, else how
 * clear the spot is, 0 to 1) and Used (0: an outlier); it can be corrected and given as picks. Port 2:
 * vtkPolyData in phantom coordinates (mm): the picks as vertices with Error and Used, and as lines the
 * wires, or the border of the wall. Port 3: vtkImageData of 61 x 61 points all over the image, with
 * its coordinates (column, row) and ExpectedError (mm, RMS) at each. Port 4: vtkPolyData, the picks at
 * (column, row, slice), to be shown on the slices, with Error, Score, Used and Target.
 *
 * StylusPivot gives port 0 the field data StylusTip (3, mm, in the receiver's coordinates) instead.
 *
 * All have the field data PixelSpacing (2, mm a column and a row), CalibrationRms (mm, eq. A.14),
 * CalibrationSpread (mm, standard deviation of an equation), ExpectedError (mm, RMS, largest of the
 * image's four corners; of the tip), Views (different ones: a probe at rest counts once), Condition, RunnerUpRms (mm, of another solution; infinite without one),
 * ImageAngles (3, degrees: azimuth, elevation, roll) and Advice (text, one value for each sentence).
 *
 * @sa vtkLacunaTemporalCalibration
 */
#ifndef vtkLacunaProbeCalibration_h
#define vtkLacunaProbeCalibration_h

#include "vtkImageAlgorithm.h"
#include "vtkLacunaAlgorithm.h"
#include "vtkLacunaFiltersCalibrationModule.h" // for export macro

#include <string>
#include <vector>

namespace lacuna
{
class AlgorithmExecution;
class CalibrationReport;
struct ProbeCalibrationOptions;
class ProbePoses;
struct SlicePick;
}

class VTKLACUNAFILTERSCALIBRATION_EXPORT vtkLacunaProbeCalibration
  : public vtkLacunaAlgorithmOf(vtkImageAlgorithm)
{
public:
  static vtkLacunaProbeCalibration* New();
  vtkTypeMacro(vtkLacunaProbeCalibration, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  enum Methods
  {
    ThreeWires = 0,
    SingleWall = 1,
    PointTarget = 2,
    StylusPivot = 3
  };

  ///@{
  /// What was scanned. Default: ThreeWires.
  vtkSetMacro(Method, int);
  vtkGetMacro(Method, int);
  void SetMethodToThreeWires() { this->SetMethod(ThreeWires); }
  void SetMethodToSingleWall() { this->SetMethod(SingleWall); }
  void SetMethodToPointTarget() { this->SetMethod(PointTarget); }
  void SetMethodToStylusPivot() { this->SetMethod(StylusPivot); }
  ///@}

  ///@{
  /// mm from column to column. 0: an error unless EstimateScale, since no one may guess it.
  /// Default: 0.
  vtkSetMacro(PixelSpacing, double);
  vtkGetMacro(PixelSpacing, double);
  ///@}

  ///@{
  /// mm from row to row; 0: as PixelSpacing. Default: 0.
  vtkSetMacro(RowSpacing, double);
  vtkGetMacro(RowSpacing, double);
  ///@}

  ///@{
  /// Find both spacings along with the rest. The result is a little less exact then. Those given only
  /// say which ratio is to be expected, both 1 if one is 0. Default: off.
  vtkSetMacro(EstimateScale, bool);
  vtkGetMacro(EstimateScale, bool);
  vtkBooleanMacro(EstimateScale, bool);
  ///@}

  ///@{
  /// Picks that are off by more than so many standard deviations are left out; at least 2. 0: none
  /// is. Default: 4.
  vtkSetMacro(OutlierLimit, double);
  vtkGetMacro(OutlierLimit, double);
  ///@}

  ///@{
  /// ThreeWires: which slices show which wire, numbers of the sweep: "X 0-49, Y 50-99, Z 100-149"
  /// (lacunaWireRanges.h). Default: empty.
  void SetWireRanges(const char* ranges);
  const char* GetWireRanges() const { return this->WireRanges.c_str(); }
  ///@}

  ///@{
  /// Look for the bright spot in slices of WireRanges that have no pick (PointTarget: in all slices
  /// when there are no picks). Default: on.
  vtkSetMacro(FindSpots, bool);
  vtkGetMacro(FindSpots, bool);
  vtkBooleanMacro(FindSpots, bool);
  ///@}

  ///@{
  /// A file to write ImageToProbe to (StylusPivot: StylusTip to Stylus or Probe): the XML that
  /// vtkLacunaTrackedSliceReader takes as calibration, as do PLUS and 3D Slicer. It appears whole or
  /// not at all. Nothing is written, a file that is there is kept, and it is an error (the outputs
  /// are there to be looked at) when the calibration is of no use: ExpectedError above 5 mm, RMS
  /// above 3 mm, another position that fits nearly as well, or an image of less than 10 or more than
  /// 500 mm; so it is when the file cannot be written. Empty: none is written. Default: empty.
  void SetOutputFileName(const char* name);
  const char* GetOutputFileName() const { return this->OutputFileName.c_str(); }
  ///@}

  /// Takes the picks of input port 1 away.
  void RemovePicks() { this->SetInputConnection(1, nullptr); }

protected:
  vtkLacunaProbeCalibration();
  ~vtkLacunaProbeCalibration() override = default;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int FillOutputPortInformation(int port, vtkInformation* info) override;
  void Announce(const lacuna::Ports& ports) override;
  void Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution) override;
  void Describe(lacuna::Properties& properties) const override;

private:
  // Given or found; what there is to say of them is added to advice. Throws.
  std::vector<lacuna::SlicePick> FindPicks(lacuna::AlgorithmExecution& execution,
    vtkImageData* slices, vtkDataObject* given, const lacuna::ProbePoses& poses,
    std::vector<std::string>& advice);
  lacuna::ProbeCalibrationOptions GetOptions() const; // throws
  // Or an error that says why not. The frame is the array of the poses that were calibrated.
  void WriteFile(const lacuna::CalibrationReport& report, const std::string& frame,
    const std::vector<std::string>& advice);

  vtkLacunaProbeCalibration(const vtkLacunaProbeCalibration&) = delete;
  void operator=(const vtkLacunaProbeCalibration&) = delete;

  int Method = ThreeWires;
  double PixelSpacing = 0;
  double RowSpacing = 0;
  bool EstimateScale = false;
  double OutlierLimit = 4;
  std::string WireRanges;
  bool FindSpots = true;
  std::string OutputFileName;
};
#endif
