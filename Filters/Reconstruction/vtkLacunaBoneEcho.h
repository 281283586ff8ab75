// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkLacunaBoneEcho
 * @brief   Finds the surface of bone in tracked ultrasound slices
 *
 * Bone is a strong echo with an acoustic shadow behind it (lacunaBoneEcho.h). Tissue that is as bright, but with
 * echoes behind it, is no bone. What it finds is the side of the bone that faces the probe.
 *
 * Input: tracked slices (lacunaTrackedSlices.h) of a calibrated probe.
 *
 * Output: the same slices, with the point array BoneEcho (float), which becomes the active scalars: 0.5 at the
 * surface, 1 at half of Thickness behind it, 0.5 at Thickness, and 0 where no bone is near, outside of what is
 * looked at and in slices that are left out. vtkLacunaSweptVolume makes a volume of it, whose surface is at 0.5. Field
 * data array BoneArea (double): mm^2 between slices that have bone.
 *
 * There is a warning when no bone is found. It is an error when no slice is left to look at, and when the probe's fan
 * is not found (FanMask Automatic).
 *
 * @sa vtkLacunaSweptVolume, vtkLacunaScanRegion
 */
#ifndef vtkLacunaBoneEcho_h
#define vtkLacunaBoneEcho_h

#include "vtkLacunaFiltersReconstructionModule.h" // for export macro
#include "vtkLacunaSliceAlgorithm.h"

namespace lacuna
{
struct BoneEchoOptions;
}

class VTKLACUNAFILTERSRECONSTRUCTION_EXPORT vtkLacunaBoneEcho : public vtkLacunaSliceAlgorithm
{
public:
  static vtkLacunaBoneEcho* New();
  vtkTypeMacro(vtkLacunaBoneEcho, vtkLacunaSliceAlgorithm);

  enum FanMasks
  {
    Given = 0,
    Automatic = 1,
    NoFan = 2
  };

  ///@{
  /// Which echoes are bone, above 0 and at most 1. Lower values find more, also what is no bone. Default: 0.25.
  vtkSetMacro(MinimumConfidence, double);
  vtkGetMacro(MinimumConfidence, double);
  ///@}

  ///@{
  /// mm behind an echo that must be dark, above 0. Default: 10.
  vtkSetMacro(ShadowLength, double);
  vtkGetMacro(ShadowLength, double);
  ///@}

  ///@{
  /// mm between beams with bone, up to which a gap is closed; 0: gaps stay. Default: 3.
  vtkSetMacro(MaximumGap, double);
  vtkGetMacro(MaximumGap, double);
  ///@}

  ///@{
  /// mm^2 of a piece of bone; smaller ones are left out. 0: all stay. Slices alone have no area and stay. Default: 50.
  vtkSetMacro(MinimumArea, double);
  vtkGetMacro(MinimumArea, double);
  ///@}

  ///@{
  /// mm that bone is made thick, above 0: what is behind its surface is not seen. Default: 4.
  vtkSetMacro(Thickness, double);
  vtkGetMacro(Thickness, double);
  ///@}

  ///@{
  /// What the probe sees of the slices, as in vtkLacunaSweptVolume. Beams of a fan run from its FanOrigin, others down
  /// the columns. Default: Given.
  vtkSetMacro(FanMask, int);
  vtkGetMacro(FanMask, int);
  void SetFanMaskToGiven() { this->SetFanMask(Given); }
  void SetFanMaskToAutomatic() { this->SetFanMask(Automatic); }
  void SetFanMaskToNoFan() { this->SetFanMask(NoFan); }
  ///@}

protected:
  vtkLacunaBoneEcho() = default;
  ~vtkLacunaBoneEcho() override = default;

  void Announce(const lacuna::Ports& ports) override;
  void Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution) override;
  void Describe(lacuna::Properties& properties) const override;

private:
  vtkLacunaBoneEcho(const vtkLacunaBoneEcho&) = delete;
  void operator=(const vtkLacunaBoneEcho&) = delete;

  lacuna::BoneEchoOptions GetOptions() const;

  double MinimumConfidence = 0.25;
  double ShadowLength = 10;
  double MaximumGap = 3;
  double MinimumArea = 50;
  double Thickness = 4;
  int FanMask = Given;
};
#endif
