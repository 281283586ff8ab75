// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Pixels as they are, or decoded.
#ifndef lacunaDicomDecoder_h
#define lacunaDicomDecoder_h

#include "lacunaCTVolume.h"
#include "lacunaDecoderProcess.h"

#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace lacuna
{
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
