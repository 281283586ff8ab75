// SPDX-License-Identifier: BSD-3-Clause
// Volumes in MetaImage, NRRD and NIfTI files: header, place, voxels.
#include "lacunaExecution.h"
#include "lacunaFuzzTarget.h"
#include "lacunaNiftiVolume.h"
#include "lacunaPixelSource.h"
#include "lacunaVolumeBox.h"

#include <cmath>
#include <vector>

using namespace lacuna;
using namespace lacuna_fuzz;

namespace
{
void ReadVoxels(const VolumeFile& file)
{
  const SequenceHeader& slices = file.Slices;
  Require(slices.Columns > 0 && slices.Rows > 0 && slices.Frames > 0 && slices.Channels > 0,
    "sizes are positive");
  const VolumeBox grid =
    FindVolumeBox(file.IndexToPatient, { slices.Columns, slices.Rows, slices.Frames });
  Require(std::abs(Dot(Cross(grid.Axes[0], grid.Axes[1]), grid.Axes[2]) - 1) < 1e-9,
    "axes are right-handed");
  const auto pixels = PixelSource::Open(slices);
  const ScalarType type = GetVolumeType(pixels->GetScalarType(), file.Slope, file.Intercept);
  const double size = static_cast<double>(slices.Columns) * static_cast<double>(slices.Rows) *
    static_cast<double>(slices.Frames) * static_cast<double>(slices.Channels) *
    static_cast<double>(GetScalarSize(type));
  if (size <= (1 << 24) && pixels->GetNumberOfWholeFrames() == slices.Frames)
  {
    std::vector<unsigned char> voxels(static_cast<std::size_t>(size));
    ThreadExecution execution(1);
    ReadVolume(file, grid, *pixels,
      { 0, static_cast<int>(slices.Columns) - 1, 0, static_cast<int>(slices.Rows) - 1, 0,
        static_cast<int>(slices.Frames) - 1 },
      voxels.data(), execution);
  }
}
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
  const MemoryFile file(data, size);
  GetImageFileKind(file.GetPath());
  for (const bool nifti : { false, true })
  {
    try
    {
      ReadVoxels(nifti ? MakeNiftiVolume(file.GetPath(), ReadNiftiHeader(file.GetPath()),
                           NiftiTransform::Automatic)
                       : ReadVolumeFile(file.GetPath()));
    }
    catch (const std::exception& error) // std::invalid_argument of a grid
    {
      RequireSentence(error);
    }
  }
  return 0;
}
