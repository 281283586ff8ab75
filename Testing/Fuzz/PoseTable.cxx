// SPDX-License-Identifier: BSD-3-Clause
// Rows of numbers that are poses, or not.
#include "lacunaFuzzTarget.h"
#include "lacunaPoseTable.h"

#include <cmath>

using namespace lacuna;
using namespace lacuna_fuzz;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
  Bytes bytes(data, size);
  const std::uint8_t choice = bytes.Take();
  PoseTableOptions options;
  options.Format = static_cast<PoseFormat>(choice % 3);
  options.Transform = static_cast<PoseTransform>(choice / 3 % 4);
  options.Unit = static_cast<LengthUnit>(choice / 12 % 4);
  options.SkipInvalid = bytes.Take() & 1;
  if (bytes.Take() & 1)
  {
    options.PixelSpacing = Vec2{ bytes.TakeDouble(), bytes.TakeDouble() };
  }
  const std::size_t counts[] = { bytes.Take() & 1 ? 12u : 16u, 7u, 6u };
  const std::size_t count = counts[choice % 3];
  std::vector<double> numbers;
  while (bytes.GetSize() >= count * sizeof(double))
  {
    for (std::size_t i = 0; i < count; ++i)
    {
      numbers.push_back(bytes.TakeDouble());
    }
  }
  const std::size_t rows = numbers.size() / count;
  try
  {
    const PoseTable table = ReadPoseTable(numbers, count, {}, options);
    Require(table.ToReference.size() == rows && table.Usable.size() == rows, "an entry each row");
    for (std::size_t i = 0; i < rows; ++i)
    {
      Require(
        table.ToReference[i].IsFinite() == (table.Usable[i] != 0), "usable poses are numbers");
      if (i > 0 && table.Usable[i] && table.Usable[i - 1])
      {
        InterpolatePose(table.ToReference[i - 1], table.ToReference[i], 0.25);
      }
    }
    MakePoseChain(options);
  }
  catch (const std::runtime_error& error)
  {
    RequireSentence(error);
  }
  return 0;
}
