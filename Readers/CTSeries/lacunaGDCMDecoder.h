// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The thin layer over GDCM: it decodes a stream and never sees a file, since Debian's ends the whole
/// program when a file is damaged. GDCM is in a library of its own (Decoder), which is loaded when the
/// first compressed image is read: GDCM and its dictionaries would take a third of loading Lacuna.
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

/// The same, of the library; wrong is what is returned.
extern "C" void LacunaDecodeWithGDCM(
  const lacuna::CTFrame* frame, lacuna::CTPixels* pixels, std::string* wrong);
#endif
