// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What SliceStatus says against a slice.
#ifndef lacunaSliceFlags_h
#define lacunaSliceFlags_h

namespace lacuna
{
/// To derive from, for those who keep slices with a status.
struct SliceFlags
{
  enum Flags : unsigned char
  {
    Valid = 0,
    PoseInvalid = 1,
    ImageInvalid = 2,
    TooFast = 4,
    GatedOut = 8
  };
};
}
#endif
