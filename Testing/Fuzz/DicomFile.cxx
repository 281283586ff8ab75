// SPDX-License-Identifier: BSD-3-Clause
// DICOM: the data set, what it says of its images, the grid they give, and their voxels, of pixels as they
// are or run-length encoded. Streams for GDCM are judged, not decoded: it is not ours to fuzz.
#include "lacunaCTGeometry.h"
#include "lacunaCTSeries.h"
#include "lacunaCTVolume.h"
#include "lacunaDicomDataSet.h"
#include "lacunaDicomDecoder.h"
#include "lacunaDicomHeader.h"
#include "lacunaFuzzTarget.h"
#include "lacunaHounsfield.h"

using namespace lacuna;
using namespace lacuna_fuzz;

namespace
{
constexpr std::int64_t Most = 1 << 22; // bytes, so that many inputs are tried

void ReadPixels(const CTFrame& frame, CTPixels& pixels)
{
  const CTFileHeader& header = *frame.Header;
  const std::int64_t stored = GetDicomSize(frame);
  const std::int64_t size = frame.GetSize();
  if (stored < 0 || stored > Most || size > Most)
  {
    throw std::runtime_error(frame.GetName() + ": its image is large");
  }
  pixels.Format = header.Format;
  pixels.Stream.resize(static_cast<std::size_t>(stored));
  ReadDicomBytes(frame, pixels.Stream.data());
  if (!header.Compressed)
  {
    Require(stored == size, "as many bytes as pixels");
    pixels.Bytes = pixels.Stream;
  }
  else
  {
    const int bits = header.Format.BitsAllocated;
    WhyNotImage(pixels.Stream, header.TransferSyntax, header.Columns, header.Rows, bits);
    pixels.Bytes.assign(static_cast<std::size_t>(size), 0);
    DecodeRunLength(pixels.Stream, bits / 8, pixels.Bytes);
  }
  pixels.Data = pixels.Bytes.data();
}

void ReadVolume(const std::vector<CTFrame>& frames)
{
  constexpr double air = -1024;
  const ScalarType type = GetHounsfieldType(frames, air);
  CTGeometryOptions options;
  options.InterpolateMissing = true;
  const CTGeometry grid = FindCTGeometry(frames, options);
  const auto planes = static_cast<std::int64_t>(grid.Planes.size());
  if (grid.Columns > Most || grid.Rows > Most || grid.Columns * grid.Rows > Most / planes)
  {
    return;
  }
  const std::array<int, 6> extent{ 0, static_cast<int>(grid.Columns - 1), 0,
    static_cast<int>(grid.Rows - 1), 0, static_cast<int>(planes - 1) };
  std::vector<double> scalars(static_cast<std::size_t>(grid.Columns * grid.Rows * planes));
  ThreadExecution execution(1);
  ReadCTVolume(grid, extent, type, air, ReadPixels, scalars.data(), execution);
}
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
  const MemoryFile file(data, size);
  try
  {
    const DicomFile dicom = ReadDicomFile(file.GetPath());
    Require(dicom.PixelOffset >= 0 && dicom.PixelOffset <= dicom.FileSize, "pixels in the file");
    const std::vector<CTFrame> frames = ReadDicomFrames(file.GetPath());
    Require(
      !ListSeries(frames).Describe().empty() || frames.empty() || !ListSeries(frames).Notes.empty(),
      "every image is listed or noted");
    CheckSameVolume(frames);
    FindDoubtsOfSeries(frames);
    for (const CTFrame& frame : frames)
    {
      CTPixels pixels;
      ReadPixels(frame, pixels);
    }
    ReadVolume(frames);
  }
  catch (const std::runtime_error& error)
  {
    RequireSentence(error);
  }
  return 0;
}
