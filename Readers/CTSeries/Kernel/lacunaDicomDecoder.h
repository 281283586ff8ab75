// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Pixels as they are, or decoded.
#ifndef lacunaDicomDecoder_h
#define lacunaDicomDecoder_h

#include "lacunaCTVolume.h"
#include "lacunaDecoderProcess.h"

#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace lacuna
{
// What must be known of a compressed image before a codec may have it: codecs trust the stream and
// write as much as it says.

/// Why a stream is not of the kind of its transfer syntax, JPEG, JPEG-LS or JPEG 2000, with one component
/// of columns x rows pixels, which take allocated bits each when they are decoded (a multiple of 8: codecs
/// write as many as the stream has) ("are of 512 x 400 pixels ..."), or cannot be
/// an image: JPEG-LS without an end, or more than 1000 times the bytes of the stream and 32 MiB. Empty when it
/// is one.
std::string WhyNotImage(const std::vector<unsigned char>& stream, const std::string& transferSyntax,
  std::int64_t columns, std::int64_t rows, int allocated);

/// Decodes RLE (PS3.5, annex G): pixels of so many bytes, little endian. False when the stream is
/// damaged or gives another amount.
bool DecodeRunLength(
  const std::vector<unsigned char>& stream, int bytesPerPixel, std::vector<unsigned char>& pixels);

/// Reads the pixels of frames and decodes those that are compressed: RLE here, and JPEG, JPEG-LS and JPEG
/// 2000 by GDCM in processes of their own. The first such frame starts one, and there are as many as threads
/// read at a time. They end with this.
class DicomDecoder
{
public:
  /// program: lacuna-decode.
  explicit DicomDecoder(std::string program = FindDecoderProgram());

  /// Throws std::runtime_error naming the file and its transfer syntax. May be called by several threads
  /// at a time.
  void Read(const CTFrame& frame, CTPixels& pixels);

private:
  std::string Decode(const CTFrame& frame, CTPixels& pixels);
  std::string DecodeByProcess(const CTFrame& frame, CTPixels& pixels);

  std::string Program;
  std::mutex Lock;
  std::vector<std::unique_ptr<DecoderProcess>> Idle;
};
}
#endif
