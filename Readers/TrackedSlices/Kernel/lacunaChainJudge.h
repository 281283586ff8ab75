// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What the geometry gate says of a sweep's transforms, frame by frame.
#ifndef lacunaChainJudge_h
#define lacunaChainJudge_h

#include "lacunaSweepTransforms.h"
#include "lacunaTransformGraph.h"

#include <string>
#include <vector>

namespace lacuna
{
/// Whether a frame of this name is one of pictures, whose unit is the pixel.
bool IsPictureFrame(const std::string& frame);

struct ChainJudgement
{
  std::vector<char> Impossible; ///< 1 for each frame whose pose the gate flags
  std::vector<std::string> Warnings;
  std::string Refusal; ///< why the calibration file cannot be used; empty: it can
};

/// Passes the transforms of a chain through the gate. With fromPixels the first links, which lead from
/// pixels to the probe, count together as a calibration; each other one is a pose. With dropInvalid, frames that the file calls invalid are
/// left out. What cannot be composed at all is not told.
ChainJudgement JudgeChain(const SweepTransforms& transforms,
  const std::vector<TransformGraph::Link>& chain, std::size_t frames, bool fromPixels,
  bool dropInvalid);
}
#endif
