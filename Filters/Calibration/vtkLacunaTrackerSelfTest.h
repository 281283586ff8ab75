// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkLacunaTrackerSelfTest
 * @brief   Shows how far a tracker warps space in the room where it stands
 *
 * Two receivers are fixed to each other, some 0.3 m apart, and moved slowly through the volume in
 * which will be scanned. Their distance and their orientation to each other should stay the same; by
 * how much they do not shows what an imaged point at the second receiver's place would be off by
 * (Carr 1996, ch. 2.2.2.2: up to 5 mm, repeatable). See lacunaTrackerSelfTest.h.
 *
 * Input, one of:
 * - tracked slices (lacunaTrackedSlices.h) with field data arrays of 16 components for both
 *   receivers, and SliceStatus; pictures are not looked at
 * - vtkTable with a column Station and the columns of a pose, records as the tracker sends them: a
 *   row of the first receiver is followed by one of the second
 * - vtkTable with the columns of both poses in each row
 * Timestamp is used when it is there (s).
 *
 * Output port 0: vtkPolyData in the tracker's coordinates (mm), one vertex between the two receivers
 * for each pair, with the point data
 * | array           | type     | meaning                                                      |
 * |-----------------|----------|--------------------------------------------------------------|
 * | PositionError   | double   | mm, length of Deviation                                      |
 * | SeparationError | double   | mm, measured distance of the receivers less the median one   |
 * | AngleError      | double   | degrees                                                      |
 * | Deviation       | double 3  | mm, second receiver from where the first and the median      |
 * |                 |          | transform put it                                             |
 * | Distance        | double   | mm, farther receiver to transmitter                          |
 * | Place           | vtkIdType | number of the place; places that were visited twice have one |
 * | Record          | vtkIdType | slice or row of the input, from 0                            |
 *
 * Port 1: vtkTable of the RMS by distance from the transmitter: From, To (mm), Pairs,
 * PositionRms, SeparationRms (mm), AngleRms (degrees). Port 2: vtkTable of how much places differ by
 * how far they are apart: From, To (mm), PairsOfPlaces, PositionChange (mm, RMS).
 *
 * All have the field data Separation (mm), PositionRms, SeparationRms, AngleRms, the same with
 * Maximum and Expected instead of Rms, SeparationRange, Noise, Repeatability, Warp (mm), Places,
 * RevisitedPlaces, TooFast, OtherHemisphere (numbers of pairs), SecondToFirst (16) and Advice
 * (text, one value for each sentence).
 *
 * @sa vtkLacunaProbeCalibration, vtkLacunaSlicePlanes
 */
#ifndef vtkLacunaTrackerSelfTest_h
#define vtkLacunaTrackerSelfTest_h

#include "vtkLacunaAlgorithm.h"
#include "vtkLacunaFiltersCalibrationModule.h" // for export macro
#include "vtkPolyDataAlgorithm.h"

#include <string>

namespace lacuna
{
struct TrackerSelfTestOptions;
}

class VTKLACUNAFILTERSCALIBRATION_EXPORT vtkLacunaTrackerSelfTest
  : public vtkLacunaAlgorithmOf(vtkPolyDataAlgorithm)
{
public:
  static vtkLacunaTrackerSelfTest* New();
  vtkTypeMacro(vtkLacunaTrackerSelfTest, vtkPolyDataAlgorithm);

  enum PoseFormats
  {
    Matrix = 0,
    Quaternion = 1,
    Euler = 2
  };
  enum LengthUnits
  {
    Millimetre = 0,
    Metre = 1,
    Centimetre = 2,
    Inch = 3
  };

  ///@{
  /// Of slices the name of the field data array, of a table with both poses in each row the text
  /// with which the names of the columns begin. Without SecondReceiver, slices have only one other
  /// array whose name ends with ToTracker. Not used for a table with a column Station. Default:
  /// ProbeToTracker and none.
  void SetFirstReceiver(const char* name);
  const char* GetFirstReceiver() const { return this->FirstReceiver.c_str(); }
  void SetSecondReceiver(const char* name);
  const char* GetSecondReceiver() const { return this->SecondReceiver.c_str(); }
  ///@}

  ///@{
  /// How rows of a table give poses, as in vtkLacunaAssembleTrackedSlices. Default: Euler, x y z
  /// azimuth elevation roll.
  vtkSetMacro(PoseFormat, int);
  vtkGetMacro(PoseFormat, int);
  ///@}

  ///@{
  /// Of a table's positions; a FASTRAK sends inches unless told otherwise. Default: Millimetre.
  vtkSetMacro(LengthUnit, int);
  vtkGetMacro(LengthUnit, int);
  ///@}

  ///@{
  /// The numbers of the two receivers in a table's column Station. Default: 1 2.
  vtkSetVector2Macro(Stations, int);
  vtkGetVector2Macro(Stations, int);
  ///@}

  ///@{
  /// Pairs in which a receiver moves faster, in mm/s, are left out: the two are measured one after
  /// the other, a FASTRAK's 8.3 ms apart. 0: none is. Default: 50, an error of 0.4 mm.
  vtkSetMacro(SpeedLimit, double);
  vtkGetMacro(SpeedLimit, double);
  ///@}

  ///@{
  /// Poses of the first receiver within this distance (mm) and turn (degrees) are the same place.
  /// Default: 20 and 15.
  vtkSetMacro(RevisitDistance, double);
  vtkGetMacro(RevisitDistance, double);
  vtkSetMacro(RevisitAngle, double);
  vtkGetMacro(RevisitAngle, double);
  ///@}

  ///@{
  /// The tracker's specified RMS errors of a receiver: mm and degrees, of the three axes together,
  /// and up to which distance from the transmitter they hold (mm). Default: 1.38, 0.26 and 760, a
  /// 3Space Fastrak's (Carr 1996, ch. 2.2.2.2).
  vtkSetMacro(TranslationAccuracy, double);
  vtkGetMacro(TranslationAccuracy, double);
  vtkSetMacro(AngularAccuracy, double);
  vtkGetMacro(AngularAccuracy, double);
  vtkSetMacro(RangeLimit, double);
  vtkGetMacro(RangeLimit, double);
  ///@}

protected:
  vtkLacunaTrackerSelfTest();
  ~vtkLacunaTrackerSelfTest() override = default;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int FillOutputPortInformation(int port, vtkInformation* info) override;
  void Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution) override;
  void Describe(lacuna::Properties& properties) const override;

private:
  vtkLacunaTrackerSelfTest(const vtkLacunaTrackerSelfTest&) = delete;
  void operator=(const vtkLacunaTrackerSelfTest&) = delete;

  lacuna::TrackerSelfTestOptions GetOptions() const;

  std::string FirstReceiver = "ProbeToTracker";
  std::string SecondReceiver;
  int PoseFormat = Euler;
  int LengthUnit = Millimetre;
  int Stations[2] = { 1, 2 };
  double SpeedLimit = 50;
  double RevisitDistance = 20;
  double RevisitAngle = 15;
  double TranslationAccuracy = 1.38;
  double AngularAccuracy = 0.26;
  double RangeLimit = 760;
};
#endif
