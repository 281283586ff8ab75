// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkLacunaSliceAlgorithm
 * @brief   Superclass of filters that make an image of freehand ultrasound slices
 *
 * Has the properties that say which tracked slices (see lacunaTrackedSlices.h) are taken, and
 * which part of them. Slices whose SliceStatus is not 0 are left out, but for flags taken by
 * choice.
 *
 * What is made of slices lies where their poses say, which are data: so the input is brought up to
 * date already when information about the output is asked for, and again when the time changes. It
 * is always asked for as a whole, since any part of the output may need any slice, on any rank. A
 * subclass that takes streams (vtkLacunaSliceStream.h) asks for one slice of a preview, for its field
 * data.
 *
 * Replays: while an input with time steps has not reached the last of them, those slices are still
 * to come which stand at its end and have an invalid image (SliceStatus 2). They are never taken,
 * and what would be an error of a whole sweep is none yet.
 *
 * Warnings are given once: not again at each update of an input that grows.
 *
 * @sa vtkLacunaSweptVolume, vtkLacunaSliceRayCaster
 */
#ifndef vtkLacunaSliceAlgorithm_h
#define vtkLacunaSliceAlgorithm_h

#include "vtkImageAlgorithm.h"
#include "vtkLacunaAlgorithm.h"
#include "vtkLacunaFiltersReconstructionModule.h" // for export macro

#include <map>
#include <set>
#include <string>
#include <vector>

namespace lacuna
{
struct SliceImages;
}

class VTKLACUNAFILTERSRECONSTRUCTION_EXPORT vtkLacunaSliceAlgorithm
  : public vtkLacunaAlgorithmOf(vtkImageAlgorithm)
{
public:
  vtkAbstractTypeMacro(vtkLacunaSliceAlgorithm, vtkImageAlgorithm);

  enum BadPoseRules
  {
    Refuse = 0,
    LeaveOut = 1,
    KeepOutliers = 2
  };

  ///@{
  /// The part of the slices to use, in pixels: first column, first row, width, height. A width or
  /// height of 0 reaches to the edge of the image, and what lies beyond its right or lower edge is
  /// cut off. Negative numbers are an error, and so is less than 2 x 2 pixels. Default: 0 0 0 0,
  /// all.
  vtkSetVector4Macro(ClipRectangle, int);
  vtkGetVector4Macro(ClipRectangle, int);
  ///@}

  ///@{
  /// The point where all beams of a curved or phased probe meet: column and row in pixels of the
  /// original slices; it may lie outside of them. Default: 0 0.
  vtkSetVector2Macro(FanOrigin, double);
  vtkGetVector2Macro(FanOrigin, double);
  ///@}

  ///@{
  /// Directions of the first and the last beam, degrees: 0 is straight down (growing rows),
  /// positive ones lean to the right (growing columns). Default: -45 45.
  vtkSetVector2Macro(FanAngles, double);
  vtkGetVector2Macro(FanAngles, double);
  ///@}

  ///@{
  /// Where beams begin and end, mm from FanOrigin. Default: 0 0, no fan.
  vtkSetVector2Macro(FanRadii, double);
  vtkGetVector2Macro(FanRadii, double);
  ///@}

  ///@{
  /// Whether slices are taken although their SliceStatus says that the image is invalid, that the
  /// probe moved too fast, or that they are gated out. Those whose pose is invalid never are.
  /// Default: off.
  vtkSetMacro(UseImageInvalid, bool);
  vtkGetMacro(UseImageInvalid, bool);
  vtkBooleanMacro(UseImageInvalid, bool);
  vtkSetMacro(UseTooFast, bool);
  vtkGetMacro(UseTooFast, bool);
  vtkBooleanMacro(UseTooFast, bool);
  vtkSetMacro(UseGatedOut, bool);
  vtkGetMacro(UseGatedOut, bool);
  vtkBooleanMacro(UseGatedOut, bool);
  ///@}

  ///@{
  /// What to do with slices that are to be taken, but whose pose cannot be true: it is not finite,
  /// not affine or singular, or an outlier, far away from the slices beside it
  /// (lacunaPoseOutliers.h says which). Refuse: an error names the slice. LeaveOut: a warning names
  /// the slices, the rest is used. KeepOutliers: outliers are taken, unusable poses are refused.
  /// Default: Refuse.
  vtkSetMacro(BadPoses, int);
  vtkGetMacro(BadPoses, int);
  void SetBadPosesToRefuse() { this->SetBadPoses(Refuse); }
  void SetBadPosesToLeaveOut() { this->SetBadPoses(LeaveOut); }
  void SetBadPosesToKeepOutliers() { this->SetBadPoses(KeepOutliers); }
  ///@}

  enum GapMethods // other names than those of a subclass's FanMask
  {
    AutomaticGap = 0,
    GivenGap = 1,
    UnlimitedGap = 2
  };

  ///@{
  /// Where nothing is interpolated between two slices, because they lie too far apart. Automatic:
  /// where a sweep ends and another one begins, which the poses and times of the slices tell
  /// (lacunaSweepEnds.h); a largest gap that is given counts, too. Given: the largest gap that is
  /// given, alone; 0 is no limit. Unlimited: nowhere. Default: Automatic.
  vtkSetMacro(GapMethod, int);
  vtkGetMacro(GapMethod, int);
  void SetGapMethodToAutomatic() { this->SetGapMethod(AutomaticGap); }
  void SetGapMethodToGiven() { this->SetGapMethod(GivenGap); }
  void SetGapMethodToUnlimited() { this->SetGapMethod(UnlimitedGap); }
  ///@}

  /// The sweeps of the last update, one line for each input: "2 sweeps: slices 0 to 20, at most 1
  /// mm apart; slices 21 to 41, at most 1 mm apart; not joined: 28.3 mm and 5 s from slice 20 to 21
  /// (the limit is 3 mm)". Empty before it.
  const char* GetSweepDescription() const { return this->SweepDescription.c_str(); }

  int ProcessRequest(
    vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;

protected:
  vtkLacunaSliceAlgorithm() { this->TakesEmpty = true; } // of several inputs
  ~vtkLacunaSliceAlgorithm() override = default;

  void Ask(const lacuna::Ports& ports) override;

  /// List properties of this class.
  void DescribeGapMethod(lacuna::Properties& properties) const;
  void DescribeClip(lacuna::Properties& properties) const;
  void DescribeSlices(lacuna::Properties& properties) const; ///< their fan, and which are taken

  /// Whether slices that are too many for the memory are taken from their stream; else what is made
  /// of a preview is a preview, and a warning says so. Default: no.
  virtual bool TakesStreams() const { return false; }

  /// Keeps what GetSweepDescription says, and writes it to output as field data: Sweeps (int, 3
  /// components: number of the input, first and last slice) and SweepGap (double, mm; the largest
  /// distance between consecutive slices), one tuple for each sweep. Adds a warning where sweeps
  /// are joined because no gap is given, which states from before GapMethod have not chosen.
  /// maximumGap: mm; 0 = none.
  void RecordSweeps(const std::vector<const lacuna::SliceImages*>& inputs, double maximumGap,
    vtkImageData* output, std::map<std::string, std::string>& warnings);

  /// Gives those warnings of an update that the one before did not give. warnings: the text for
  /// each fact, by a name that stays the same while it is the same fact. leftOut: the sentences
  /// about slices with bad poses.
  void WarnOfNews(
    const std::map<std::string, std::string>& warnings, const std::vector<std::string>& leftOut);

  int ClipRectangle[4] = { 0, 0, 0, 0 };
  double FanOrigin[2] = { 0, 0 };
  double FanAngles[2] = { -45, 45 };
  double FanRadii[2] = { 0, 0 };
  bool UseImageInvalid = false;
  bool UseTooFast = false;
  bool UseGatedOut = false;
  int BadPoses = Refuse;
  int GapMethod = AutomaticGap;

private:
  vtkLacunaSliceAlgorithm(const vtkLacunaSliceAlgorithm&) = delete;
  void operator=(const vtkLacunaSliceAlgorithm&) = delete;

  std::set<std::string> KnownFacts;
  std::string SweepDescription;
};
#endif
