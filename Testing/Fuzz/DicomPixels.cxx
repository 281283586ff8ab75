// SPDX-License-Identifier: BSD-3-Clause
// Compressed pixels of DICOM files, decoded for real: run-length streams here, all others by GDCM in a process
// of its own. Whatever that does, there is an image of the size that was asked for, or an error.
//
// The input: which transfer syntax, columns, rows, bits allocated, bits stored, high bit and sign, a byte each;
// then the stream, in whose header columns and rows are set where it has one, so that more of them are decoded.
#include "lacunaDicomDecoder.h"
#include "lacunaFuzzTarget.h"

#include <array>
#include <chrono>

using namespace lacuna;
using namespace lacuna_fuzz;

namespace
{
constexpr std::array<const char*, 9> Syntaxes = { "1.2.840.10008.1.2.5", "1.2.840.10008.1.2.4.50",
  "1.2.840.10008.1.2.4.51", "1.2.840.10008.1.2.4.57", "1.2.840.10008.1.2.4.70",
  "1.2.840.10008.1.2.4.80", "1.2.840.10008.1.2.4.81", "1.2.840.10008.1.2.4.90",
  "1.2.840.10008.1.2.4.91" };

void SetBig(std::string& stream, std::size_t offset, int bytes, std::int64_t number)
{
  for (int i = 0; i < bytes && offset + i < stream.size(); ++i)
  {
    stream[offset + i] = static_cast<char>(number >> 8 * (bytes - 1 - i) & 0xFF);
  }
}

void SetSize(std::string& stream, const CTFileHeader& header)
{
  if (stream.compare(0, 4, "\xFF\x4F\xFF\x51") == 0)
  {
    SetBig(stream, 8, 4, header.Columns);
    SetBig(stream, 12, 4, header.Rows);
  }
  else if (stream.size() > 3 && stream.compare(0, 3, "\xFF\xD8\xFF") == 0)
  {
    SetBig(stream, 7, 2, header.Rows); // of a frame that begins at once
    SetBig(stream, 9, 2, header.Columns);
  }
}
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
  static DicomDecoder decoder(LACUNA_DECODER_PROGRAM);
  static CTPixels pixels; // what is of the image before must not matter
  Bytes bytes(data, size);
  const auto header = std::make_shared<CTFileHeader>();
  header->TransferSyntax = Syntaxes[bytes.Take() % Syntaxes.size()];
  header->Columns = 1 + bytes.Take();
  header->Rows = 1 + bytes.Take();
  header->Format.BitsAllocated = 8 << bytes.Take() % 3;
  header->Format.BitsStored = 1 + bytes.Take() % header->Format.BitsAllocated;
  header->Format.HighBit = bytes.Take() % header->Format.BitsAllocated;
  header->Format.Signed = bytes.Take() % 2 == 1;
  header->Compressed = true;
  std::string stream;
  while (bytes.GetSize() > 0)
  {
    stream += static_cast<char>(bytes.Take());
  }
  SetSize(stream, *header);
  const MemoryFile file(stream.data(), stream.size());
  header->File = file.GetPath();
  header->Pixels = { { { 0, static_cast<std::int64_t>(stream.size()) } } };
  header->State = FileBytes(file.GetPath()).GetState();
  CTFrame frame;
  frame.Header = header;
  const auto start = std::chrono::steady_clock::now();
  try
  {
    decoder.Read(frame, pixels);
    Require(
      static_cast<std::int64_t>(pixels.Bytes.size()) == frame.GetSize(), "a pixel for each place");
    Require(pixels.Data == pixels.Bytes.data(), "the pixels are where they are said to be");
  }
  catch (const std::runtime_error& error)
  {
    RequireSentence(error);
    Require(
      std::string(error.what()).find("compressed pixels") != std::string::npos, "what is wrong");
  }
  const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
  Require(time.count() < 40, "an end within the limits");
  return 0;
}
