// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What a program says to the process that decodes compressed pixels for it (Decoder/lacunaDecode.cxx), and
/// hears from it. Both are of one build; the version is to find out when they are not.
#ifndef lacunaDecoderProtocol_h
#define lacunaDecoderProtocol_h

#include <cstddef>
#include <cstdint>

namespace lacuna
{
constexpr std::uint32_t DecoderVersion = 1;
/// Descriptors of the process: packets (SOCK_SEQPACKET), and memory that both have.
constexpr int DecoderSocket = 0;
constexpr int DecoderMemory = 3;

struct DecoderFormat
{
  std::int32_t BitsAllocated = 0;
  std::int32_t BitsStored = 0;
  std::int32_t HighBit = 0;
  std::int32_t Signed = 0;
};

/// An image to decode. The memory begins with the stream; pixels follow at PixelOffset.
struct DecoderRequest
{
  std::uint64_t MemoryBytes = 0; ///< of the memory that both have
  std::uint64_t StreamBytes = 0; ///< even
  std::uint64_t PixelOffset = 0;
  std::uint64_t PixelBytes = 0;
  std::uint32_t Columns = 0;
  std::uint32_t Rows = 0;
  DecoderFormat Format;
  char TransferSyntax[72] = {}; ///< with a zero at its end
};

enum class DecoderStatus : std::uint32_t
{
  Ready, ///< what it says first
  Decoded,
  Damaged,       ///< the codec says so
  UnknownSyntax, ///< no codec is known
  OutOfMemory
};

struct DecoderReply
{
  std::uint32_t Version = DecoderVersion;
  DecoderStatus Status = DecoderStatus::Ready;
  DecoderFormat Format; ///< of the pixels, which may be another than asked for
};

/// Seconds of processor time that an image may take. GDCM's codecs take a fifteenth of the second part.
constexpr double GetDecoderSeconds(const DecoderRequest& request)
{
  return 0.25 + 2e-6 * static_cast<double>(request.Columns) * static_cast<double>(request.Rows);
}

/// Bytes of memory that decoding an image may take. OpenJPEG, the greediest, takes 8 for each byte of an
/// image.
constexpr std::uint64_t GetDecoderBytes(const DecoderRequest& request)
{
  return (std::uint64_t{ 256 } << 20) + 16 * request.PixelBytes + 4 * request.StreamBytes;
}
}
#endif
