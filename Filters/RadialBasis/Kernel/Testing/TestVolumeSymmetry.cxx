// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaVolumeSymmetry.h"

#include "lacunaMirrorTest.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <limits>
#include <random>
#include <string>
#include <vector>

using lacuna::MirrorPlane;
using lacuna::Vec3;
using namespace lacunaMirrorTest;

namespace
{
std::string ErrorOf(const lacuna::MaskedVolume& volume)
{
  lacuna::ThreadExecution execution(2);
  try
  {
    FindSymmetryPlane(volume, execution);
  }
  catch (const std::exception& e)
  {
    return e.what();
  }
  return "none";
}
}

// Random poses and grids; noise of a tenth of the bone's contrast.
TEST(VolumeSymmetry, FindsThePlaneOfNoisySymmetricData)
{
  std::mt19937 random(3);
  for (int trial = 0; trial < 6; ++trial)
  {
    Pose pose(random);
    const Grid grid = trial % 2 ? Grid{ { 100, 120, 110 }, { 1.5, 1.3, 1.4 } }
                                : Grid{ { 150, 140, 70 }, { 1, 1.1, 2.3 } };
    const Scene scene(grid, pose, Defect::None, 60, trial);
    lacuna::ThreadExecution execution;
    const lacuna::SymmetryResult result = FindSymmetryPlane(scene.Masked(), execution);
    const PlaneError error = Compare(result.Plane, pose);
    EXPECT_LT(error.Degrees, 0.05) << "trial " << trial;
    EXPECT_LT(error.Distance, 0.05) << "trial " << trial;
    EXPECT_GT(result.Rating, 0.9);
    EXPECT_LT(result.Ambiguity, 0.5);
    std::cout << "trial " << trial << " " << error.Degrees << " deg, " << error.Distance
              << " mm, rating " << result.Rating << ", ambiguity " << result.Ambiguity << "\n";
  }
}

// A hole of 30 mm radius in the skull on one side moves it hardly.
TEST(VolumeSymmetry, ToleratesADefect)
{
  std::mt19937 random(5);
  for (int trial = 0; trial < 4; ++trial)
  {
    Pose pose(random);
    const Scene scene({ { 110, 120, 105 }, { 1.4, 1.3, 1.4 } }, pose, Defect::Hole, 40, trial);
    lacuna::ThreadExecution execution;
    const PlaneError error = Compare(FindSymmetryPlane(scene.Masked(), execution).Plane, pose);
    EXPECT_LT(error.Degrees, 0.1) << "trial " << trial;
    EXPECT_LT(error.Distance, 0.1) << "trial " << trial;
    std::cout << "defect " << trial << " " << error.Degrees << " deg, " << error.Distance
              << " mm\n";
  }
}

// A field of view that ends on one side a quarter into the head.
TEST(VolumeSymmetry, ToleratesAFieldOfViewThatIsCutOff)
{
  std::mt19937 random(9);
  for (int trial = 0; trial < 3; ++trial)
  {
    Pose pose(random);
    pose.Axes = Small(random, 0.2); // nearly along the grid, so that one side is lost
    const Scene scene({ { 96, 120, 105 }, { 1.4, 1.3, 1.4 } }, pose, Defect::CutOff, 40, trial);
    lacuna::ThreadExecution execution;
    const PlaneError error = Compare(FindSymmetryPlane(scene.Masked(), execution).Plane, pose);
    EXPECT_LT(error.Degrees, 0.1) << "trial " << trial;
    EXPECT_LT(error.Distance, 0.1) << "trial " << trial;
    std::cout << "cut " << trial << " " << error.Degrees << " deg, " << error.Distance << " mm\n";
  }
}

TEST(VolumeSymmetry, SameForAnyNumberOfThreads)
{
  std::mt19937 random(5);
  Pose pose(random);
  const Scene scene({ { 70, 60, 50 }, { 2.4, 2.6, 2.8 } }, pose, Defect::Hole, 40, 1);
  std::vector<lacuna::SymmetryResult> results;
  for (const int threads : { 1, 2, 5 })
  {
    lacuna::ThreadExecution execution(threads);
    results.push_back(FindSymmetryPlane(scene.Masked(), execution));
  }
  for (const auto& r : results)
  {
    EXPECT_EQ(r.Plane.Normal, results[0].Plane.Normal);
    EXPECT_EQ(r.Plane.Offset, results[0].Plane.Offset);
    EXPECT_EQ(r.Rating, results[0].Rating);
    EXPECT_EQ(r.Ambiguity, results[0].Ambiguity);
  }
}

TEST(VolumeSymmetry, SeesThatABallHasManyPlanes)
{
  const Grid grid{ { 50, 52, 54 }, { 1, 1, 1 } };
  lacuna::MaskedVolume volume;
  std::vector<float> voxels;
  for (int k = 0; k < 54; ++k)
  {
    for (int j = 0; j < 52; ++j)
    {
      for (int i = 0; i < 50; ++i)
      {
        const double r = std::hypot(i - 24.3, j - 26.1, k - 27.2);
        voxels.push_back(static_cast<float>(100 * Step((18 - r) / 1.5)));
      }
    }
  }
  volume.Volume = grid.Of(voxels.data(), lacuna::ScalarType::Float32);
  lacuna::ThreadExecution execution;
  const auto result = FindSymmetryPlane(volume, execution);
  EXPECT_GT(result.Ambiguity, 0.6);
  EXPECT_GT(result.Rating, 0.98);
  EXPECT_NEAR(result.Plane.Distance({ 24.3, 26.1, 27.2 }), 0, 0.05);
}

// The line of symmetry of a picture: its plane is perpendicular to the slice.
TEST(VolumeSymmetry, OfASlice)
{
  const double angle = 0.4;
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  for (int axis = 0; axis < 3; ++axis)
  {
    std::vector<std::int16_t> voxels;
    for (int j = 0; j < 120; ++j)
    {
      for (int i = 0; i < 110; ++i)
      {
        const double x = c * (i - 52.4) + s * (j - 61.7);
        const double y = -s * (i - 52.4) + c * (j - 61.7);
        const double r = std::hypot(x / 30, (y + 0.004 * x * x) / 45);
        voxels.push_back(static_cast<std::int16_t>(
          1000 * Step((1 - r) * 20) + 500 * Step(8 - std::hypot(std::abs(x) - 12, y - 20))));
      }
    }
    lacuna::MaskedVolume volume;
    volume.Volume.Voxels = voxels.data();
    volume.Volume.Type = lacuna::ScalarType::Int16;
    const int right = axis == 0 ? 1 : 0;
    const int down = axis == 2 ? 1 : 2;
    volume.Volume.Size = { 1, 1, 1 };
    volume.Volume.Size[right] = 110;
    volume.Volume.Size[down] = 120;
    lacuna::ThreadExecution execution;
    const MirrorPlane plane = FindSymmetryPlane(volume, execution).Plane;
    EXPECT_NEAR(std::abs(plane.Normal[right] * c + plane.Normal[down] * s), 1, 1e-6);
    EXPECT_NEAR(plane.Normal[axis], 0, 1e-12);
    Vec3 middle{ 0, 0, 0 };
    middle[right] = 52.4;
    middle[down] = 61.7;
    EXPECT_NEAR(plane.Distance(middle), 0, 0.05);
  }
}

TEST(VolumeSymmetry, IgnoresWhatIsInvalid)
{
  std::mt19937 random(11);
  Pose pose(random);
  Scene scene({ { 90, 90, 90 }, { 2, 2, 2 } }, pose, Defect::None, 0, 1);
  lacuna::MaskedVolume volume = scene.Masked();
  volume.Valid.assign(scene.Voxels.size(), 1);
  // a wedge of wrong numbers that the mask, or NaN, takes out
  std::vector<float> voxels(scene.Voxels.begin(), scene.Voxels.end());
  for (std::size_t v = 0; v < voxels.size(); ++v)
  {
    if (v % 90 < 25)
    {
      voxels[v] = v % 2 ? std::numeric_limits<float>::quiet_NaN() : 1e6F;
      volume.Valid[v] = voxels[v] != 1e6F;
    }
  }
  volume.Volume.Voxels = voxels.data();
  volume.Volume.Type = lacuna::ScalarType::Float32;
  lacuna::ThreadExecution execution;
  const PlaneError error = Compare(FindSymmetryPlane(volume, execution).Plane, pose);
  EXPECT_LT(error.Degrees, 0.1);
  EXPECT_LT(error.Distance, 0.1);
}

TEST(VolumeSymmetry, NamesWhatIsWrong)
{
  std::vector<float> voxels(8000, 3);
  lacuna::MaskedVolume volume;
  volume.Volume.Voxels = voxels.data();
  volume.Volume.Type = lacuna::ScalarType::Float32;
  volume.Volume.Size = { 20, 20, 20 };
  EXPECT_NE(ErrorOf(volume).find("the same value"), std::string::npos) << ErrorOf(volume);
  std::fill(voxels.begin(), voxels.end(), std::numeric_limits<float>::quiet_NaN());
  EXPECT_NE(ErrorOf(volume).find("there is none"), std::string::npos) << ErrorOf(volume);
  volume.Volume.Size = { 8000, 1, 1 };
  EXPECT_NE(ErrorOf(volume).find("one row"), std::string::npos) << ErrorOf(volume);
  volume.Volume.Size = { 20, 20, 20 };
  volume.Volume.IndexToWorld =
    lacuna::Matrix4::FromColumns({ 1, 0, 0 }, { 0.5, 1, 0 }, { 0, 0, 1 }, { 0, 0, 0 });
  EXPECT_NE(ErrorOf(volume).find("perpendicular"), std::string::npos) << ErrorOf(volume);
  // noise: some plane, no crash, no good rating
  std::mt19937 random(1);
  for (float& v : voxels)
  {
    v = std::normal_distribution<float>()(random);
  }
  volume.Volume.IndexToWorld = lacuna::Matrix4();
  lacuna::ThreadExecution execution;
  EXPECT_LT(FindSymmetryPlane(volume, execution).Rating, 0.5);
  volume.Volume.IndexToWorld = lacuna::Matrix4::Scaling({ 1, 1e9, 1 });
  EXPECT_NE(ErrorOf(volume).find("mend the spacing"), std::string::npos) << ErrorOf(volume);
  volume.Volume.IndexToWorld = lacuna::Matrix4();
  for (const std::array<int, 3>& size : { std::array<int, 3>{ 2, 2, 2 }, { 3, 4, 5 }, { 2, 1, 2 } })
  {
    volume.Volume.Size = size;
    ErrorOf(volume); // whatever it is, it comes back
  }
}

TEST(VolumeSymmetry, StopsWhenAsked)
{
  std::mt19937 random(5);
  Pose pose(random);
  const Scene scene({ { 70, 60, 50 }, { 2.4, 2.6, 2.8 } }, pose, Defect::Hole, 40, 1);
  lacuna::ThreadExecution execution(2, [](double fraction) { return fraction < 0.4; });
  EXPECT_THROW(FindSymmetryPlane(scene.Masked(), execution), lacuna::Aborted);
}
