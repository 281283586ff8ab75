// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The thin layer over GDCM: it decodes a stream and never sees a file, since Debian's ends the whole
/// program when a file is damaged.
#ifndef lacunaGDCMDecoder_h
#define lacunaGDCMDecoder_h

#include "lacunaCTVolume.h"

#include <string>

namespace lacuna
{
/// Decodes pixels.Stream, which has the size that frame says (WhyNotImage), into pixels.Bytes, which
/// has that size already. Sets the format. Returns what is wrong, or nothing.
std::string DecodeWithGDCM(const CTFrame& frame, CTPixels& pixels);
}
#endif
