// SPDX-License-Identifier: BSD-3-Clause
// DICOM: the data set, what it says of its images, and pixels that are run-length encoded.
#include "lacunaCTGeometry.h"
#include "lacunaCTSeries.h"
#include "lacunaCompressedImage.h"
#include "lacunaDicomDataSet.h"
#include "lacunaDicomHeader.h"
#include "lacunaFuzzTarget.h"

using namespace lacuna;
using namespace lacuna_fuzz;

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
    FindDoubtsOfPatient(frames);
    for (const CTFrame& frame : frames)
    {
      const std::int64_t bytes = GetDicomSize(frame);
      if (bytes >= 0 && bytes < (1 << 22))
      {
        std::vector<unsigned char> pixels(static_cast<std::size_t>(bytes));
        ReadDicomBytes(frame, pixels.data());
      }
    }
  }
  catch (const std::runtime_error& error)
  {
    RequireSentence(error);
  }
  return 0;
}
