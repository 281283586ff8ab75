// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Small volume files for tests: 4 x 3 x 2 voxels (columns, rows, slices) of 16 bits with the values
/// 100 column + 10 row + slice, wherever a file has them.
#ifndef VolumeTesting_h
#define VolumeTesting_h

#include "NrrdFile.h"
#include "lacunaExecution.h"
#include "lacunaPixelSource.h"
#include "lacunaVolumeBox.h"

#include <gtest/gtest.h>

#include <functional>

namespace volume_testing
{
constexpr int Columns = 4;
constexpr int Rows = 3;
constexpr int Slices = 2;

inline std::int16_t GetValue(int column, int row, int slice)
{
  return static_cast<std::int16_t>(100 * column + 10 * row + slice);
}

inline std::string MakeVoxels()
{
  std::string bytes;
  for (int k = 0; k < Slices; ++k)
  {
    for (int j = 0; j < Rows; ++j)
    {
      for (int i = 0; i < Columns; ++i)
      {
        const std::int16_t value = GetValue(i, j, k);
        bytes += static_cast<char>(value & 255);
        bytes += static_cast<char>(value >> 8);
      }
    }
  }
  return bytes;
}

/// A file with this content under this name.
inline lacuna::VolumeFile ReadFile(const std::string& name, const std::string& content)
{
  const TemporaryFile file(name, content);
  return lacuna::ReadVolumeFile(file.GetPath());
}

inline std::string GetFileError(const std::string& name, const std::string& content)
{
  return GetError([&] { ReadFile(name, content); });
}

/// Where the voxel (i, j, k) lies by the file.
inline void ExpectPlace(
  const lacuna::VolumeFile& file, const lacuna::Vec3& index, const lacuna::Vec3& place)
{
  const lacuna::Vec3 found = file.IndexToPatient.Point(index);
  for (int i = 0; i < 3; ++i)
  {
    EXPECT_NEAR(found[i], place[i], 1e-12) << "of axis " << i;
  }
}

/// The value of the file's voxel (column, row, slice) is in the grid where the file has it.
inline void ExpectVoxelsInPlace(const lacuna::VolumeFile& file)
{
  const lacuna::VolumeBox grid =
    lacuna::FindVolumeBox(file.IndexToPatient, { Columns, Rows, Slices });
  EXPECT_NEAR(lacuna::Dot(lacuna::Cross(grid.Axes[0], grid.Axes[1]), grid.Axes[2]), 1, 1e-12);
  const auto pixels = lacuna::PixelSource::Open(file.Slices);
  std::vector<std::int16_t> voxels(Columns * Rows * Slices);
  lacuna::ThreadExecution execution(1);
  lacuna::ReadVolume(
    file, grid, *pixels, { 0, Columns - 1, 0, Rows - 1, 0, Slices - 1 }, voxels.data(), execution);
  for (int k = 0; k < Slices; ++k)
  {
    for (int j = 0; j < Rows; ++j)
    {
      for (int i = 0; i < Columns; ++i)
      {
        const lacuna::Vec3 place = file.IndexToPatient.Point(
          { { static_cast<double>(i), static_cast<double>(j), static_cast<double>(k) } });
        const lacuna::Vec3 from = place - grid.Origin;
        std::size_t at = 0;
        for (std::size_t a = 3; a-- > 0;)
        {
          const double step = lacuna::Dot(grid.Axes[a], from) / grid.Spacing[a];
          EXPECT_NEAR(step, std::round(step), 1e-9);
          at = at * static_cast<std::size_t>(grid.Dimensions[a]) +
            static_cast<std::size_t>(std::lround(step));
        }
        ASSERT_LT(at, voxels.size());
        EXPECT_EQ(voxels[at], GetValue(i, j, k));
      }
    }
  }
}

inline void ExpectParts(const std::string& text, const std::vector<std::string>& parts)
{
  for (const std::string& part : parts)
  {
    EXPECT_NE(text.find(part), std::string::npos) << text << "\nlacks: " << part;
  }
}
}
#endif
