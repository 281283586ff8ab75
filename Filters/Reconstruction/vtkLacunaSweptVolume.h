// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkLacunaSweptVolume
 * @brief   Volume swept by freehand ultrasound slices that are not parallel
 *
 * Fills a voxel grid from tracked slices (see lacunaTrackedSlices.h for what these are). A voxel
 * between two consecutive slices is interpolated between the feet of its perpendiculars,
 * V = (a X2 + b X1) / (a + b), with a and b its distances from the first and the second slice and
 * X1, X2 the grey levels at the feet (Carr 1996, 4.2; lacunaSlicePair.h says what between means).
 * Several samples of one voxel, within a sweep or from several sweeps, are averaged or the largest
 * one is kept; they are collected in floating point and rounded once. The result does not depend on
 * threads, pieces or ranks, bit by bit.
 *
 * Input (repeatable): tracked slices, taken in the order of the stack. Where slices are left out,
 * their neighbours form the pair. Different inputs form no pairs, nor do the sweeps of which an
 * input is made (GapMethod).
 *
 * Output: an image along the axes of OutputFrame, mm in the reference frame, whose whole extent
 * starts at 0: voxel 0 lies at the minimum of the box of all slices' corner pixel centres (or of
 * OutputBounds), and there are round(length / spacing) + 1 voxels along each axis. Point data:
 * | array             | type                  | meaning                                          |
 * |-------------------|-----------------------|--------------------------------------------------|
 * | Intensity         | see OutputScalarType  | grey level, active scalars; 0 where there is none|
 * | Contributions     | unsigned int          | how many samples made the voxel                  |
 * | vtkValidPointMask | char                  | 1 where there are samples, else 0                |
 * Field data: Sweeps and SweepGap (vtkLacunaSliceAlgorithm.h), Provenance; with FanMask Automatic also FanOrigin, FanAngles, FanRadii (double, 2
 * components) and ClipRectangle (int, 4), one tuple for each input, as the properties would have
 * them; the radii are 0 where there is no sector, and all is 0 while a replay has not shown enough.
 *
 * Input that grows: when more slices have come at the end of the (last) input and all else is as it
 * was, only they are worked on; the result is bit by bit that of all slices at once. The grid must
 * not change for that: in a replay (an input with time steps) it is that of the whole sweep, with
 * FanMask Automatic that of the whole images; for a live source set OutputBounds and OutputSpacing.
 *
 * Input that is too large for the memory: of a preview (vtkLacunaSliceStream.h) all slices are taken,
 * a few at a time, in bounded memory; the volume is bit by bit that of all slices in memory. Each
 * requested piece reads all of them.
 *
 * Errors: an array of the input is missing; fewer than two slices of an input are left (one for
 * NearestVoxel); a pose cannot be true (see BadPoses); all slices lie in one plane; the fan cannot
 * be found; the volume would need more than MemoryLimit. What a replay has not shown yet is no
 * error.
 *
 * @sa lacunaSweptVolume.h, lacunaSlicePair.h, lacunaVolumeGrid.h
 */
#ifndef vtkLacunaSweptVolume_h
#define vtkLacunaSweptVolume_h

#include "vtkLacunaFiltersReconstructionModule.h" // for export macro
#include "vtkLacunaSliceAlgorithm.h"
#include "vtkSmartPointer.h" // for origins

#include <array>
#include <map>
#include <memory>
#include <string>

namespace lacuna
{
struct SweptVolumeFans;
}
namespace lacuna
{
class GrowingVolume;
class SweptVolumePlan;
}

class VTKLACUNAFILTERSRECONSTRUCTION_EXPORT vtkLacunaSweptVolume : public vtkLacunaSliceAlgorithm
{
public:
  static vtkLacunaSweptVolume* New();
  vtkTypeMacro(vtkLacunaSweptVolume, vtkLacunaSliceAlgorithm);

  enum OutputFrames
  {
    Reference = 0,
    Principal = 1
  };
  enum PixelSamplings
  {
    Footprint = 0,
    Bilinear = 1,
    Nearest = 2
  };
  enum Interpolations
  {
    BetweenSlices = 0,
    NearestVoxel = 1
  };
  enum Compoundings
  {
    Mean = 0,
    Maximum = 1
  };
  enum FanMasks
  {
    Given = 0,
    Automatic = 1,
    NoFan = 2
  };
  enum OutputScalarTypes
  {
    Input = 0,
    Float = 1
  };

  ///@{
  /// Voxel spacing in mm. 0 on an axis takes it from the data: the largest pixel spacing, or, if
  /// the volume would have more than 2^23 voxels then, the spacing that gives this number, rounded
  /// up to two digits. Default: 0 0 0.
  vtkSetVector3Macro(OutputSpacing, double);
  vtkGetVector3Macro(OutputSpacing, double);
  ///@}

  ///@{
  /// Axes of the volume: those of the Reference frame, or Principal: the mean axes of the slices
  /// (columns, rows, normals; see lacunaPrincipalFrame.h), so that the volume is hardly larger than
  /// what was swept. The output then has a direction matrix, and still lies in the reference frame.
  /// Default: Reference.
  vtkSetMacro(OutputFrame, int);
  vtkGetMacro(OutputFrame, int);
  void SetOutputFrameToReference() { this->SetOutputFrame(Reference); }
  void SetOutputFrameToPrincipal() { this->SetOutputFrame(Principal); }
  ///@}

  ///@{
  /// Box of the volume along the axes of OutputFrame, mm from the reference frame's origin: x, y, z
  /// minimum and maximum. 1 -1 on an axis takes all that the slices cover. Default: 1 -1 1 -1 1 -1.
  vtkSetVector6Macro(OutputBounds, double);
  vtkGetVector6Macro(OutputBounds, double);
  ///@}

  ///@{
  /// The grey level at the foot of a perpendicular: Footprint (the mean over the voxel's footprint
  /// in the slice, so that slices finer than the voxels do not alias), Bilinear or Nearest. Only
  /// for BetweenSlices. Default: Footprint.
  vtkSetMacro(PixelSampling, int);
  vtkGetMacro(PixelSampling, int);
  void SetPixelSamplingToFootprint() { this->SetPixelSampling(Footprint); }
  void SetPixelSamplingToBilinear() { this->SetPixelSampling(Bilinear); }
  void SetPixelSamplingToNearest() { this->SetPixelSampling(Nearest); }
  ///@}

  ///@{
  /// Width of footprints in voxels, above 0. More than 1 averages noise away, and detail. Only for
  /// PixelSampling Footprint. Default: 1.
  vtkSetMacro(FootprintScale, double);
  vtkGetMacro(FootprintScale, double);
  ///@}

  ///@{
  /// Whether footprints have a height, too: voxels are then the mean over FootprintScale voxels
  /// along the slices' normals of what is interpolated between all slices there, not only the two
  /// nearest. Only for PixelSampling Footprint and Compounding Mean. Default: off.
  vtkSetMacro(FootprintAcrossSlices, bool);
  vtkGetMacro(FootprintAcrossSlices, bool);
  vtkBooleanMacro(FootprintAcrossSlices, bool);
  ///@}

  ///@{
  /// BetweenSlices, or NearestVoxel: each pixel of each slice goes to the voxel in which its centre
  /// lies, and nothing is interpolated. Default: BetweenSlices.
  vtkSetMacro(Interpolation, int);
  vtkGetMacro(Interpolation, int);
  void SetInterpolationToBetweenSlices() { this->SetInterpolation(BetweenSlices); }
  void SetInterpolationToNearestVoxel() { this->SetInterpolation(NearestVoxel); }
  ///@}

  ///@{
  /// What several samples of a voxel become: their Mean or their Maximum. Default: Mean.
  vtkSetMacro(Compounding, int);
  vtkGetMacro(Compounding, int);
  void SetCompoundingToMean() { this->SetCompounding(Mean); }
  void SetCompoundingToMaximum() { this->SetCompounding(Maximum); }
  ///@}

  ///@{
  /// Voxels at which two consecutive slices are further apart than this many mm stay empty. Only
  /// for BetweenSlices, and not for GapMethod Unlimited. 0 = no limit. Default: 0.
  vtkSetMacro(MaximumSliceGap, double);
  vtkGetMacro(MaximumSliceGap, double);
  ///@}

  ///@{
  /// What the probe sees of the slices; the rest does not exist for the volume. Given: the fan of
  /// FanOrigin, FanAngles and FanRadii, if its radii are not 0. Automatic: found in the pixels, for
  /// each input (lacunaFanDetection.h); an error says when that is not certain. NoFan: all of it.
  /// ClipRectangle applies in any case. Default: Given.
  vtkSetMacro(FanMask, int);
  vtkGetMacro(FanMask, int);
  void SetFanMaskToGiven() { this->SetFanMask(Given); }
  void SetFanMaskToAutomatic() { this->SetFanMask(Automatic); }
  void SetFanMaskToNoFan() { this->SetFanMask(NoFan); }
  ///@}

  /// The fans found with FanMask Automatic, one line for each input: "FanOrigin=160,-40
  /// FanAngles=-32,32 FanRadii=18,78 ClipRectangle=17,20,287,200"; of a linear probe only the
  /// ClipRectangle. Empty before the first update and with other masks.
  const char* GetFanDescription();

  ///@{
  /// Type of Intensity: that of the input, or Float. Default: Input.
  vtkSetMacro(OutputScalarType, int);
  vtkGetMacro(OutputScalarType, int);
  void SetOutputScalarTypeToInput() { this->SetOutputScalarType(Input); }
  void SetOutputScalarTypeToFloat() { this->SetOutputScalarType(Float); }
  ///@}

  ///@{
  /// Memory that the whole volume may take, in MiB (2^20 bytes), its work space included. 0 = no
  /// limit but the machine's memory. Default: 4096.
  vtkSetMacro(MemoryLimit, int);
  vtkGetMacro(MemoryLimit, int);
  ///@}

  /// Slices that the last update worked on: only the new ones when the slices of the update before
  /// have not changed and more have come, in a grid that has not changed (see the guide), else all.
  vtkIdType GetNumberOfSlicesAdded() const;

protected:
  vtkLacunaSweptVolume();
  ~vtkLacunaSweptVolume() override;

  bool TakesStreams() const override { return true; }
  int FillInputPortInformation(int port, vtkInformation* info) override;
  void Announce(const lacuna::Ports& ports) override;
  void Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution) override;
  void Describe(lacuna::Properties& properties) const override;
  std::vector<vtkDataObject*> GetOrigins(const lacuna::Ports& ports) const override;

private:
  vtkLacunaSweptVolume(const vtkLacunaSweptVolume&) = delete;
  void operator=(const vtkLacunaSweptVolume&) = delete;

  struct Voxels;
  /// Fills a part of the volume; returns warnings by their kind.
  std::map<std::string, std::string> Fill(const lacuna::SweptVolumePlan& plan,
    const std::array<int, 6>& extent, lacuna::AlgorithmExecution& execution, Voxels& voxels);

  double OutputSpacing[3] = { 0, 0, 0 };
  double OutputBounds[6] = { 1, -1, 1, -1, 1, -1 };
  int OutputFrame = Reference;
  int PixelSampling = Footprint;
  double FootprintScale = 1;
  bool FootprintAcrossSlices = false;
  int Interpolation = BetweenSlices;
  int Compounding = Mean;
  double MaximumSliceGap = 0;
  int FanMask = Given;
  int OutputScalarType = Input;
  int MemoryLimit = 4096;
  std::unique_ptr<lacuna::SweptVolumeFans> Fans;
  std::string FanDescription;
  std::unique_ptr<lacuna::GrowingVolume> Growing;
  std::vector<vtkSmartPointer<vtkDataObject>> Origins; ///< of the last volume
};
#endif
