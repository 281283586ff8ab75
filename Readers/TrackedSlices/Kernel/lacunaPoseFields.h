// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Whether a sequence that is about to be written says where its slices lie.
#ifndef lacunaPoseFields_h
#define lacunaPoseFields_h

#include "lacunaMatrix4.h"
#include "lacunaSequenceFormat.h"

#include <string>
#include <vector>

namespace lacuna
{
/// Whether a reader finds poses, one for each frame from the pixels to the frame of reference, in
/// the transforms among the fields: within 1e-9 where a pose is finite, and nothing valid where it
/// is not.
bool TellPoses(const std::vector<SequenceFields>& frames, const std::string& imageFrame,
  const std::string& referenceFrame, const std::vector<Matrix4>& poses);

/// Whether the elements of two matrices differ by no more than 1e-9, relative where they are large.
bool IsNear(const Matrix4& a, const Matrix4& b);
}
#endif
