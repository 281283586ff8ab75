// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Pixels as they are, or decoded.
#ifndef lacunaDicomDecoder_h
#define lacunaDicomDecoder_h

#include "lacunaCTVolume.h"

namespace lacuna
{
/// The pixels of a frame, read from its file and decoded where they are compressed: RLE, and with
/// GDCM JPEG, JPEG-LS and JPEG 2000. Throws std::runtime_error naming the file and its transfer
/// syntax. May be called by several threads at a time.
void ReadDicomPixels(const CTFrame& frame, CTPixels& pixels);
}
#endif
