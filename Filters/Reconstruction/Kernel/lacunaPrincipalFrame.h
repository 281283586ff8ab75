// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A frame that lies along a sweep, for a volume that is hardly larger than what was swept.
///
/// Its axes are the mean axes of the slices: x along the columns (from column to column), y along
/// the rows, z = x cross y along the normals. So a layer of the volume looks like a slice, not
/// mirrored. In full:
/// - Of the columns' directions, the rows' directions and the normals (columns cross rows), each is
///   averaged: all are unit vectors, turned by 180 degrees where that brings them nearer to the
///   mean, which is found by repetition and starts with the first slice. The length of the mean,
///   0..1, says how well the slices agree.
/// - The axis on which they agree best is kept: in a fan that is the axis of rotation, between
///   parallel slices all three. The second best is made orthogonal to it; the third one is the
///   cross product. Equally good ones (within 1e-9) count in the order normals, rows, columns.
/// - x, y and z point as in the first slice: the two averaged axes form an angle of at most 90
///   degrees with its own.
///
/// These axes were chosen rather than those of inertia, which are undefined when the swept box is
/// nearly as long as it is wide, and lie askew to slices whose corners do not fill a box.
#ifndef lacunaPrincipalFrame_h
#define lacunaPrincipalFrame_h

#include "lacunaMatrix4.h"
#include "lacunaSliceImage.h"

#include <vector>

namespace lacuna
{
/// FrameToReference: a rotation (determinant 1, no translation) whose columns are the frame's axes.
/// slices: at least one; all have passed CheckSlice.
Matrix4 GetPrincipalFrame(const std::vector<SliceImage>& slices);
}
#endif
