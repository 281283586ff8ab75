// SPDX-License-Identifier: BSD-3-Clause
/// The real sweep of a spine phantom, read by a small parser of its own.
#include "lacunaSyntheticSweep.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <sstream>

using namespace lacuna;

namespace
{
constexpr int Width = 820;
constexpr int Height = 616;
constexpr int NumberOfSlices = 21;

std::string ReadFile(const std::string& name)
{
  std::ifstream file(std::string(LACUNA_TEST_DATA) + "/ultrasound_spine/" + name, std::ios::binary);
  return { std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>() };
}

// The 16 numbers after key.
Matrix4 ReadMatrix(const std::string& text, const std::string& key)
{
  const std::size_t at = text.find(key);
  EXPECT_NE(at, std::string::npos) << key;
  std::istringstream numbers(text.substr(at + key.size()));
  std::array<double, 16> elements{};
  for (double& e : elements)
  {
    numbers >> e;
  }
  EXPECT_TRUE(numbers) << key;
  return Matrix4(elements);
}

class SpineSweep : public testing::Test
{
protected:
  void SetUp() override
  {
    const std::string file = ReadFile("SpinePhantomFreehand.igs.mha");
    const std::string calibration =
      ReadFile("PlusDeviceSet_SpinePhantomFreehandReconstructionOnly.xml");
    if (file.empty() || calibration.empty())
    {
      GTEST_SKIP() << "no spine sweep in " << LACUNA_TEST_DATA;
    }
    const std::string marker = "ElementDataFile = LOCAL\n";
    const std::size_t begin = file.find(marker) + marker.size();
    const std::string header = file.substr(0, begin);
    const Matrix4 imageToProbe =
      ReadMatrix(calibration.substr(calibration.find("To=\"Probe\"")), "Matrix=\"");

    this->Pixels.resize(static_cast<std::size_t>(Width) * Height * NumberOfSlices);
    uLongf size = this->Pixels.size();
    ASSERT_EQ(uncompress(this->Pixels.data(), &size,
                reinterpret_cast<const Bytef*>(file.data() + begin), file.size() - begin),
      Z_OK);
    ASSERT_EQ(size, this->Pixels.size());
    for (int n = 0; n < NumberOfSlices; ++n)
    {
      const std::string frame =
        "Seq_Frame00" + std::string(n < 10 ? "0" : "") + std::to_string(n) + "_";
      SliceImage slice;
      slice.Pixels = this->Pixels.data() + static_cast<std::size_t>(n) * Width * Height;
      slice.Width = Width;
      slice.Height = Height;
      slice.RowStride = Width;
      slice.PixelToReference =
        ReadMatrix(header, frame + "ReferenceToTrackerTransform =").Inverse() *
        ReadMatrix(header, frame + "ProbeToTrackerTransform =") * imageToProbe;
      slice.Label = "slice " + std::to_string(n);
      this->Slices.push_back(slice);
    }
  }

  std::vector<unsigned char> Pixels;
  std::vector<SliceImage> Slices;
};
}

TEST_F(SpineSweep, HasTheGridThatUsersExpect)
{
  const VolumeGrid grid = MakeGrid(this->Slices, { 0.5, 0.5, 0.5 });
  EXPECT_EQ(grid.Dimensions, (std::array<int, 3>{ 147, 106, 105 }));
  EXPECT_NEAR(grid.Origin[0], -74.5217, 5e-5);
  EXPECT_NEAR(grid.Origin[1], 165.573, 5e-4);
  EXPECT_NEAR(grid.Origin[2], 29.072, 5e-4);
}

TEST_F(SpineSweep, ASliceBetweenIsPredictedByItsNeighbours)
{
  // Leave one slice out, look at the rest at its pixels that lie between the neighbours. The error
  // is that of the speckle; a wrong pose convention more than doubles it.
  double errors = 0;
  for (int left = 1; left + 1 < NumberOfSlices; ++left)
  {
    const SliceImage& truth = this->Slices[left];
    VolumeGridRequest request;
    request.Spacing = { 0.5, 0.5, 0.5 };
    std::vector<SliceImage> rest{ this->Slices[left - 1], this->Slices[left + 1] };
    const VolumeGrid grid = MakeVolumeGrid(rest, request);
    const auto volume = Reconstruct<float>(rest, grid, GetExtent(grid), {}, 2);
    double sum = 0;
    int count = 0;
    int inside = 0;
    for (int y = 30; y < Height - 30; y += 6)
    {
      for (int x = 30; x < Width - 30; x += 6)
      {
        const Vec3 p =
          truth.PixelToReference.Point({ static_cast<double>(x), static_cast<double>(y), 0 });
        std::array<int, 3> v;
        for (int a = 0; a < 3; ++a)
        {
          v[a] = std::clamp(static_cast<int>(std::lround((p[a] - grid.Origin[a]) / 0.5)), 0,
            grid.Dimensions[a] - 1);
        }
        const std::size_t n =
          (static_cast<std::size_t>(v[2]) * grid.Dimensions[1] + v[1]) * grid.Dimensions[0] + v[0];
        ++inside;
        if (volume.Mask[n])
        {
          const double e = volume.Intensity[n] -
            this->Pixels[(static_cast<std::size_t>(left) * Height + y) * Width + x];
          sum += e * e;
          ++count;
        }
      }
    }
    EXPECT_GT(count, 0.9 * inside) << left;
    errors += std::sqrt(sum / count) / (NumberOfSlices - 2);
  }
  RecordProperty("RMS", std::to_string(errors));
  EXPECT_LT(errors, 21);
}

TEST_F(SpineSweep, FillsWhatTheProbePassed)
{
  const VolumeGrid grid = MakeGrid(this->Slices, { 0.5, 0.5, 0.5 });
  const auto volume = Reconstruct<std::uint8_t>(this->Slices, grid, GetExtent(grid), {}, 2);
  // The swept volume: image area times the way of the image's centre along its normal.
  double swept = 0;
  for (int n = 0; n + 1 < NumberOfSlices; ++n)
  {
    const auto& pose = this->Slices[n].PixelToReference;
    const auto& next = this->Slices[n + 1].PixelToReference;
    const Vec3 area = Cross((Width - 1.0) * pose.Column(0), (Height - 1.0) * pose.Column(1));
    const Vec3 centre{ 0.5 * (Width - 1), 0.5 * (Height - 1), 0 };
    swept += std::abs(Dot(area, next.Point(centre) - pose.Point(centre)));
  }
  const auto filled = std::count(volume.Mask.begin(), volume.Mask.end(), 1);
  EXPECT_NEAR(static_cast<double>(filled) * 0.125, swept, 0.02 * swept);
  // no pepper: a voxel whose six neighbours are filled is filled
  std::int64_t holes = 0;
  const std::array<std::int64_t, 3> strides{ 1, grid.Dimensions[0],
    std::int64_t(1) * grid.Dimensions[0] * grid.Dimensions[1] };
  for (int k = 1; k + 1 < grid.Dimensions[2]; ++k)
  {
    for (int j = 1; j + 1 < grid.Dimensions[1]; ++j)
    {
      for (int i = 1; i + 1 < grid.Dimensions[0]; ++i)
      {
        const std::int64_t n = i * strides[0] + j * strides[1] + k * strides[2];
        bool surrounded = true;
        for (const std::int64_t stride : strides)
        {
          surrounded &= volume.Mask[n - stride] && volume.Mask[n + stride];
        }
        holes += surrounded && !volume.Mask[n] ? 1 : 0;
      }
    }
  }
  EXPECT_EQ(holes, 0);
}
