// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Medians of small windows by compare-exchange of whole vectors.
#ifndef lacunaMedianNetwork_h
#define lacunaMedianNetwork_h

#include "lacunaVectorUnit.h"
#include "lacunaWindow.h"

namespace lacuna
{
/// True when FilterByNetwork does boxes of this size.
bool HasMedianNetwork(const Window& window);

/// Medians of the boxes that lie in a block of keys, size samples with x fastest; 64 further keys
/// behind the block are readable (and ignored). The results are (size - window + 1) samples, x
/// fastest, with room for 64 more behind. No key may mean NaN.
template <class Key>
void FilterByNetwork(
  const Key* keys, const int size[3], const Window& window, VectorUnit set, Key* medians);
}
#endif
