// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Where the images of a sweep change from slice to slice: in what the probe sees, not around it.
/// Of a few images, or still ones: where they differ from what is around.
#ifndef lacunaActivityMap_h
#define lacunaActivityMap_h

#include "lacunaPixelSet.h"
#include "lacunaSliceImage.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace lacuna
{
/// How much each pixel changes over a sweep.
class ActivityMap
{
public:
  /// Takes at most 32 of the slices, evenly spread. All have windows of one size; at least 3.
  /// A pixel's change is its range of grey levels; from 4 slices on the highest and the lowest one do
  /// not count, so that single errors (shot noise) do not.
  explicit ActivityMap(const std::vector<SliceImage>& slices);

  /// The same of how much pixels differ from the background, which is the most frequent grey level;
  /// 1 image will do. Of several a pixel's largest difference counts (from 4 on the second largest).
  static ActivityMap OfContrast(const std::vector<SliceImage>& slices);

  /// Indices of the slices that are taken, of so many, ascending: of these alone all are taken.
  static std::vector<std::size_t> ChooseSlices(std::size_t count);

  int GetWidth() const { return this->Width; }
  int GetHeight() const { return this->Height; }
  double GetLargestChange() const { return this->Largest; }

  /// The largest connected part that is dense with pixels that change by more than threshold: more
  /// than half of a neighbourhood of 9 x 9 do. Letters, rulers and noise are too thin or too sparse
  /// for that. rank: 1 for the second largest one and so on. It may be empty.
  PixelSet GetLargestPart(double threshold, std::size_t rank = 0) const;

private:
  ActivityMap(int width, int height)
    : Width(width)
    , Height(height)
  {
  }
  int Width, Height;
  std::vector<float> Changes;
  double Largest = 0;
};
}
#endif
