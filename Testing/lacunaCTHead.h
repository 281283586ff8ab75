// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The CT head of the test data, for programs without VTK. Needs LACUNA_TEST_DATA, the folder of the
/// build (the environment can name another), and zlib.
#ifndef lacunaCTHead_h
#define lacunaCTHead_h

#include "lacunaVoxelVolume.h"

#include <zlib.h>

#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace lacuna
{
struct ShortVolume
{
  std::vector<std::int16_t> Voxels;
  VoxelVolume Volume;
};

/// The number or numbers of a MetaImage header's line.
inline std::vector<double> HeaderNumbers(const std::string& text, const std::string& key)
{
  std::vector<double> numbers;
  std::size_t at = text.find("\n" + key + " =");
  if (at == std::string::npos)
  {
    return numbers;
  }
  const char* p = text.c_str() + text.find('=', at) + 1;
  for (int i = 0; i < 3; ++i)
  {
    char* end = nullptr;
    numbers.push_back(std::strtod(p, &end));
    p = end;
  }
  return numbers;
}

/// The CT head: a local, compressed MetaImage of short. Empty when it is absent.
inline const ShortVolume& Head()
{
  static const ShortVolume head = []
  {
    ShortVolume result;
    const char* const folder = std::getenv("LACUNA_TEST_DATA");
    std::ifstream file(
      std::string(folder ? folder : LACUNA_TEST_DATA) + "/ct_head/head.mha", std::ios::binary);
    const std::string text(
      (std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    const std::string local = "ElementDataFile = LOCAL\n";
    const std::size_t start = text.find(local);
    const auto size = HeaderNumbers(text, "DimSize");
    const auto spacing = HeaderNumbers(text, "ElementSpacing");
    if (start == std::string::npos || size.size() != 3 || spacing.size() != 3)
    {
      return result;
    }
    for (int a = 0; a < 3; ++a)
    {
      result.Volume.Size[a] = static_cast<int>(size[a]);
    }
    result.Volume.IndexToWorld = Matrix4::Scaling({ spacing[0], spacing[1], spacing[2] });
    result.Voxels.resize(result.Volume.NumberOfVoxels());
    uLongf bytes = static_cast<uLongf>(result.Voxels.size() * sizeof(std::int16_t));
    const auto* packed = reinterpret_cast<const Bytef*>(text.data() + start + local.size());
    if (uncompress(reinterpret_cast<Bytef*>(result.Voxels.data()), &bytes, packed,
          static_cast<uLong>(text.size() - start - local.size())) != Z_OK)
    {
      result.Voxels.clear();
    }
    result.Volume.Voxels = result.Voxels.data();
    result.Volume.Type = ScalarType::Int16;
    return result;
  }();
  return head;
}
}
#endif
