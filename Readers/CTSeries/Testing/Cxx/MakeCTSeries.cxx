// SPDX-License-Identifier: BSD-3-Clause
// Writes the test scans into a folder, for scripts: MakeCTSeries FOLDER.
#include "CTTestCases.h"

#include <cstdio>
#include <exception>

int main(int argc, char* argv[])
{
  if (argc != 2)
  {
    std::fprintf(stderr, "usage: %s FOLDER\n", argv[0]);
    return 2;
  }
  const std::string folder = argv[1];
  try
  {
    for (const auto& cases : { MakeExactCases(), MakeTiltedCases(), MakeBodyCases() })
    {
      for (const auto& [name, series] : cases)
      {
        series.Write(folder + "/" + name);
      }
    }
    CTTestSeries missing;
    missing.Places = { 0, 1, 2, 4, 5, 6 };
    missing.Write(folder + "/missing");
    CTTestSeries().Write(folder + "/two");
    CTTestSeries second;
    second.SeriesUid = "1.2.3.77";
    second.Description = "Other";
    second.Slices = 4;
    second.Write(folder + "/two/second");
    CTTestSeries resonance;
    resonance.Edits = { { 0x0008, 0x0060, "CS", "MR", {} },
      { 0x0008, 0x0016, "UI", "1.2.840.10008.5.1.4.1.1.4", {} } };
    resonance.Write(folder + "/MR");
  }
  catch (const std::exception& e)
  {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
  return 0;
}
