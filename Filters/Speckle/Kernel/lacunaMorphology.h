// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Least and greatest sample of a window: grey erosion and dilation.
///
/// Exact for all types. NaN samples are left out of the windows of their neighbours and stay NaN
/// themselves. Borders: the nearest sample is repeated. Boxes cost the same whatever their size
/// (each doubling of the window is one more minimum of whole vectors); ellipsoids one minimum of
/// whole rows for each row of the window.
#ifndef lacunaMorphology_h
#define lacunaMorphology_h

#include "lacunaExecution.h"
#include "lacunaImageView.h"
#include "lacunaVectorUnit.h"
#include "lacunaWindow.h"

namespace lacuna
{
enum class Extreme
{
  Least,
  Greatest
};

/// Filters the samples of output.Box from those of input, whose box contains it; input must reach
/// window.Grow(output.Box) except where the image ends. T: the fixed-width integers, float, double.
template <class T>
void FilterExtreme(const ImageView<const T>& input, const ImageView<T>& output,
  const Window& window, Extreme extreme, VectorUnit set, Execution& execution);
}
#endif
