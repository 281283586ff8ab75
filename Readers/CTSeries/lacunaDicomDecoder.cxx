// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaDicomDecoder.h"

#include "lacunaCompressedImage.h"
#include "lacunaDicomHeader.h"
#include "lacunaMemory.h"

#ifdef LACUNA_HAS_GDCM
#include "lacunaGDCMDecoder.h"
#endif

#include <cstdint>
#include <stdexcept>
#include <string>

namespace lacuna
{
namespace
{
constexpr const char* RunLengthSyntax = "1.2.840.10008.1.2.5";
constexpr std::int64_t LongestRun = 64; // bytes for each of a run-length stream

void MakeRoom(const CTFrame& frame, CTPixels& pixels)
{
  const auto size = static_cast<std::size_t>(frame.GetSize());
  if (size > pixels.Bytes.capacity())
  {
    RequireMemory(frame.GetName() + ": its image", static_cast<double>(size));
  }
  pixels.Bytes.resize(size);
}

// Returns what is wrong with the stream. The header's size is believed only when the stream bears it
// out: a few bytes may claim an image of gigabytes.
std::string Decode(const CTFrame& frame, CTPixels& pixels)
{
  const CTFileHeader& header = *frame.Header;
  if (header.TransferSyntax == RunLengthSyntax)
  {
    if (frame.GetSize() / LongestRun > static_cast<std::int64_t>(pixels.Stream.size()))
    {
      return "are too few for its Rows (0028,0010) and Columns (0028,0011)";
    }
    MakeRoom(frame, pixels);
    const bool decoded =
      DecodeRunLength(pixels.Stream, header.Format.BitsAllocated / 8, pixels.Bytes);
    return decoded ? "" : "cannot be decoded";
  }
#ifdef LACUNA_HAS_GDCM
  std::string wrong = WhyNotImage(
    pixels.Stream, header.TransferSyntax, header.Columns, header.Rows, header.Format.BitsAllocated);
  if (wrong.empty())
  {
    pixels.Bytes.clear(); // what a codec leaves out shall not be the image before
    MakeRoom(frame, pixels);
    wrong = DecodeWithGDCM(frame, pixels);
  }
  return wrong;
#else
  return "cannot be decoded, since this program was built without GDCM; gdcmconv --raw makes an "
         "uncompressed file";
#endif
}
}

//------------------------------------------------------------------------------
void ReadDicomPixels(const CTFrame& frame, CTPixels& pixels)
{
  const CTFileHeader& header = *frame.Header;
  pixels.Format = header.Format;
  if (!header.Compressed)
  {
    unsigned char* target = pixels.Room;
    if (!target)
    {
      MakeRoom(frame, pixels);
      target = pixels.Bytes.data();
    }
    ReadDicomBytes(frame, target);
    pixels.Data = target;
    return;
  }
  pixels.Stream.resize(static_cast<std::size_t>(GetDicomSize(frame)));
  ReadDicomBytes(frame, pixels.Stream.data());
  std::string wrong = Decode(frame, pixels);
  pixels.Data = pixels.Bytes.data();
  if (wrong.empty() && pixels.Format.BitsAllocated != header.Format.BitsAllocated)
  {
    wrong = "have " + std::to_string(pixels.Format.BitsAllocated) + " bits, not " +
      std::to_string(header.Format.BitsAllocated) + " as Bits Allocated (0028,0100) says";
  }
  if (!wrong.empty())
  {
    throw std::runtime_error(frame.GetName() + ": its compressed pixels " + wrong +
      " (transfer syntax " + header.TransferSyntax + ")");
  }
}
}
