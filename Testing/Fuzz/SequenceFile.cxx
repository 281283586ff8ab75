// SPDX-License-Identifier: BSD-3-Clause
// Tracked sequences, MetaImage and NRRD: header, pixels, poses. What is behind the first zero byte is also
// read as pixels.raw, and as the pixels of a header sweep.mhd that lacks its end, beside it.
#include "lacunaFuzzTarget.h"
#include "lacunaPixelSource.h"
#include "lacunaSliceStack.h"
#include "lacunaSweep.h"

#include <algorithm>
#include <vector>

using namespace lacuna;
using namespace lacuna_fuzz;

namespace
{
void ReadEverything(const std::string& path)
{
  const SequenceHeader header = ReadSequenceHeader(path);
  const auto pixels = PixelSource::Open(header);
  const std::int64_t whole = pixels->GetNumberOfWholeFrames();
  Require(whole >= 1 && whole <= header.Frames, "as many frames as the header says, or fewer");
  SweepOptions options;
  options.FramesWithPixels = whole;
  const Sweep sweep = BuildSweep(header, options);
  const auto frames = static_cast<std::size_t>(header.Frames);
  Require(sweep.Status.size() == frames && sweep.FrameNumbers.size() == frames &&
      sweep.ImageToReference.size() == (sweep.Chain.empty() ? 0 : frames),
    "an entry for each frame");
  for (std::size_t i = 0; i < sweep.ImageToReference.size(); ++i)
  {
    Require(sweep.ImageToReference[i].IsFinite() == ((sweep.Status[i] & Sweep::PoseInvalid) == 0),
      "poses that are not flagged are numbers");
  }
  SliceRegion region;
  region.Columns = header.Columns;
  region.Rows = header.Rows;
  region.Frames = header.PosesOnly ? 1 : std::min<std::int64_t>(header.Frames, 4);
  const std::int64_t size = region.Columns * region.Rows * region.Frames *
    static_cast<std::int64_t>(GetScalarSize(pixels->GetScalarType()));
  if (size <= (1 << 24))
  {
    std::vector<unsigned char> stack(static_cast<std::size_t>(size));
    ThreadExecution execution(1);
    ReadSliceStack(header, *pixels, region, stack.data(), execution);
  }
}

void Read(const std::string& path)
{
  IsTrackedSequence(path);
  try
  {
    ReadEverything(path);
  }
  catch (const std::runtime_error& error)
  {
    RequireSentence(error);
  }
}
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
  Read(MemoryFile(data, size).GetPath());

  const std::uint8_t *end = data + size, *zero = std::find(data, end, 0);
  if (zero != end)
  {
    static const MemoryFolder folder;
    const MemoryFile header(data, static_cast<std::size_t>(zero - data));
    const MemoryFile pixels(zero + 1, static_cast<std::size_t>(end - zero - 1));
    folder.Name("sweep.mhd", header);
    folder.Name("sweep.raw", pixels);
    folder.Name("pixels.raw", pixels);
    Read(folder.GetPath("sweep.mhd"));
  }
  return 0;
}
