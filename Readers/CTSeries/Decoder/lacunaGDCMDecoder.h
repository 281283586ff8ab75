// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The thin layer over GDCM: it decodes a stream and never sees a file. GDCM may abort, loop or take all
/// memory, so this belongs into the process of lacunaDecode.cxx.
#ifndef lacunaGDCMDecoder_h
#define lacunaGDCMDecoder_h

#include "lacunaDecoderProtocol.h"

namespace lacuna
{
/// Decodes request.StreamBytes of stream into request.PixelBytes of pixels.
DecoderReply DecodeWithGDCM(
  const DecoderRequest& request, const unsigned char* stream, unsigned char* pixels);
}
#endif
