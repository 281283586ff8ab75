// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Compresses test sequences.
#ifndef Compress_h
#define Compress_h

#include "SequenceFile.h"

#include <zlib.h>

/// The same sequence with one zlib stream over all frames.
inline SequenceFile Compressed(SequenceFile file, bool sizeKnown = true, int level = 6)
{
  uLongf size = compressBound(static_cast<uLong>(file.Pixels.size()));
  std::string packed(size, '\0');
  compress2(reinterpret_cast<Bytef*>(packed.data()), &size,
    reinterpret_cast<const Bytef*>(file.Pixels.data()), static_cast<uLong>(file.Pixels.size()),
    level);
  packed.resize(size);
  file.Pixels = packed;
  file.Set("CompressedData", "True");
  if (sizeKnown)
  {
    file.Set("CompressedDataSize", std::to_string(size) + "          ");
  }
  return file;
}
#endif
