// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaDicomDecoder.h"

#include "lacunaCompressedImage.h"
#include "lacunaDicomHeader.h"
#include "lacunaMemory.h"

#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <utility>

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

DecoderRequest MakeRequest(const CTFrame& frame, const CTPixels& pixels)
{
  const CTFileHeader& header = *frame.Header;
  DecoderRequest request;
  request.StreamBytes = pixels.Stream.size();
  request.PixelBytes = pixels.Bytes.size();
  request.Columns = static_cast<std::uint32_t>(header.Columns);
  request.Rows = static_cast<std::uint32_t>(header.Rows);
  request.Format = { header.Format.BitsAllocated, header.Format.BitsStored, header.Format.HighBit,
    header.Format.Signed ? 1 : 0 };
  header.TransferSyntax.copy(request.TransferSyntax, sizeof request.TransferSyntax - 1);
  return request;
}
}

//------------------------------------------------------------------------------
DicomDecoder::DicomDecoder(std::string program)
  : Program(std::move(program))
{
}

//------------------------------------------------------------------------------
std::string DicomDecoder::DecodeByProcess(const CTFrame& frame, CTPixels& pixels)
{
  constexpr std::size_t LongestFragment = 0xFFFFFFFE;
  pixels.Stream.resize(pixels.Stream.size() + pixels.Stream.size() % 2); // fragments are even
  if (pixels.Stream.size() > LongestFragment)
  {
    return "are too long";
  }
  std::unique_ptr<DecoderProcess> process;
  {
    const std::lock_guard<std::mutex> lock(this->Lock);
    if (!this->Idle.empty())
    {
      process = std::move(this->Idle.back());
      this->Idle.pop_back();
    }
  }
  if (!process)
  {
    process = std::make_unique<DecoderProcess>(this->Program);
  }
  DecoderFormat found;
  std::string wrong =
    process->Decode(MakeRequest(frame, pixels), pixels.Stream.data(), pixels.Bytes.data(), found);
  if (wrong.empty())
  {
    pixels.Format = { found.BitsAllocated, found.BitsStored, found.HighBit, found.Signed == 1 };
  }
  if (process->IsAlive())
  {
    const std::lock_guard<std::mutex> lock(this->Lock);
    this->Idle.push_back(std::move(process));
  }
  return wrong;
}

//------------------------------------------------------------------------------
// Returns what is wrong with the stream. The header's size is believed only when the stream bears it
// out: a few bytes may claim an image of gigabytes.
std::string DicomDecoder::Decode(const CTFrame& frame, CTPixels& pixels)
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
  std::string wrong = WhyNotImage(
    pixels.Stream, header.TransferSyntax, header.Columns, header.Rows, header.Format.BitsAllocated);
  if (wrong.empty())
  {
    MakeRoom(frame, pixels);
    wrong = this->DecodeByProcess(frame, pixels);
  }
  return wrong;
}

//------------------------------------------------------------------------------
void DicomDecoder::Read(const CTFrame& frame, CTPixels& pixels)
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
  std::string wrong;
  try
  {
    wrong = this->Decode(frame, pixels);
  }
  catch (const MemoryExceeded&)
  {
    throw;
  }
  catch (const std::runtime_error& error) // of a process that does not start
  {
    wrong = error.what();
  }
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
