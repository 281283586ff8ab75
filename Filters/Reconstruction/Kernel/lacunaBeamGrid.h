// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Slices along the beams that made them.
#ifndef lacunaBeamGrid_h
#define lacunaBeamGrid_h

#include "lacunaSliceImage.h"

#include <cstddef>
#include <vector>

namespace lacuna
{
/// Samples on beams. Of a slice with a fan, beams run from the fan's inner to its outer radius, otherwise down
/// its columns. Values of samples are in the order of beams, each from the probe on.
class BeamGrid
{
public:
  /// For all slices with windows, fans and pixel spacings like this one. Steps are those of pixels.
  explicit BeamGrid(const SliceImage& slice);

  int GetNumberOfBeams() const { return this->Beams; }
  int GetNumberOfSamples() const { return this->Samples; } ///< of one beam
  std::size_t GetSize() const
  {
    return static_cast<std::size_t>(this->Beams) * static_cast<std::size_t>(this->Samples);
  }
  double GetSampleStep() const { return this->SampleStep; } ///< mm
  int GetWidth() const { return this->Width; }              ///< of the window, pixels
  int GetHeight() const { return this->Height; }
  const Vec2& GetPixelSpacing() const { return this->Spacing; } ///< mm

  /// mm from beam to beam there.
  double GetBeamStep(double sample) const;
  /// The same in the middle of the beams.
  double GetBeamStep() const { return this->GetBeamStep(0.5 * (this->Samples - 1)); }

  /// First and one after the last sample of a beam that the window has.
  int GetBegin(int beam) const { return this->Begins[beam]; }
  int GetEnd(int beam) const { return this->Ends[beam]; }

  /// Column and row in the window.
  Vec2 GetPixel(int beam, double sample) const;
  /// Beam and sample of a pixel of the window; they need not be whole, or be in the grid.
  Vec2 Find(double column, double row) const;

  /// Grey levels, bilinear between pixels; 0 where the window has none.
  std::vector<float> Sample(const SliceImage& slice) const;

  /// Smooths values by a Gaussian along the beams and across them, in which only samples of the window count.
  /// sigmas: mm along and across; 0: not.
  void Smooth(std::vector<float>& values, double along, double across) const;

private:
  void Convolve(std::vector<float>& values, double along, double across) const;

  int Beams;
  int Samples;
  double SampleStep;
  double AngleStep = 0; ///< radians; 0: beams are columns
  Vec2 Spacing;         ///< of pixels, mm
  Fan Sector;
  int Width, Height; ///< of the window
  std::vector<int> Begins, Ends;
  bool IsWhole = true; ///< the window has all samples
};
}
#endif
