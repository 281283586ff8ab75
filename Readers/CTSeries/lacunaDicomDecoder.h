// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The thin layer over GDCM: it decodes pixels and never sees a file.
#ifndef lacunaDicomDecoder_h
#define lacunaDicomDecoder_h

#include "lacunaCTVolume.h"

namespace lacuna
{
/// The pixels of a frame, read from its file and decoded where they are compressed (JPEG, JPEG-LS,
/// JPEG 2000, RLE). Throws std::runtime_error naming the file and its transfer syntax. May be called
/// by several threads at a time.
CTPixels ReadDicomPixels(const CTFrame& frame);
}
#endif
