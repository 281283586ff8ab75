// SPDX-License-Identifier: BSD-3-Clause
// Calibration XML; what was read is written and read again.
#include "lacunaCalibrationFile.h"
#include "lacunaFuzzTarget.h"

using namespace lacuna;
using namespace lacuna_fuzz;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
  const MemoryFile file(data, size);
  std::vector<NamedTransform> transforms;
  try
  {
    transforms = ReadCalibrationFile(file.GetPath());
  }
  catch (const std::runtime_error& error)
  {
    RequireSentence(error);
    return 0;
  }
  for (const NamedTransform& transform : transforms)
  {
    Require(transform.Matrix.IsFinite(), "transforms are numbers");
  }
  const std::string text = FormatCalibration(transforms, "again");
  const MemoryFile second(text.data(), text.size());
  const std::vector<NamedTransform> again = ReadCalibrationFile(second.GetPath());
  Require(again.size() == transforms.size(), "as many transforms as were written");
  for (std::size_t i = 0; i < again.size(); ++i)
  {
    Require(again[i].From == transforms[i].From && again[i].To == transforms[i].To,
      "the names that were written");
    for (int row = 0; row < 4; ++row)
    {
      for (int column = 0; column < 4; ++column)
      {
        Require(again[i].Matrix(row, column) == transforms[i].Matrix(row, column),
          "the numbers that were written");
      }
    }
  }
  return 0;
}
