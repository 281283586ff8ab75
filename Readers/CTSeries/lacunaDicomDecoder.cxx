// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaDicomDecoder.h"

#include "lacunaCompressedImage.h"
#include "lacunaDicomHeader.h"

#ifdef LACUNA_HAS_GDCM
#include "lacunaGDCMDecoder.h"
#endif

#include <stdexcept>
#include <string>

namespace lacuna
{
namespace
{
constexpr const char* RunLengthSyntax = "1.2.840.10008.1.2.5";

// Returns what is wrong with the stream.
std::string Decode(const CTFrame& frame, CTPixels& pixels)
{
  const CTFileHeader& header = *frame.Header;
  if (header.TransferSyntax == RunLengthSyntax)
  {
    const bool decoded =
      DecodeRunLength(pixels.Stream, header.Format.BitsAllocated / 8, pixels.Bytes);
    return decoded ? "" : "cannot be decoded";
  }
#ifdef LACUNA_HAS_GDCM
  const std::string wrong =
    WhyNotImage(pixels.Stream, header.Columns, header.Rows, header.Format.BitsAllocated);
  return wrong.empty() ? DecodeWithGDCM(frame, pixels) : wrong;
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
      pixels.Bytes.resize(static_cast<std::size_t>(frame.GetSize()));
      target = pixels.Bytes.data();
    }
    ReadDicomBytes(frame, target);
    pixels.Data = target;
    return;
  }
  pixels.Stream.resize(static_cast<std::size_t>(GetDicomSize(frame)));
  ReadDicomBytes(frame, pixels.Stream.data());
  pixels.Bytes.resize(static_cast<std::size_t>(frame.GetSize()));
  pixels.Data = pixels.Bytes.data();
  std::string wrong = Decode(frame, pixels);
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
