// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaCalibrationFile.h"
#include "lacunaPoseScript.h"
#include "lacunaUltrasoundEmulator.h"
#include "lacunaVideoService.h"

#include <gtest/gtest.h>

#include <fstream>

using namespace lacuna;

namespace
{
constexpr double Depth = 60;
constexpr double Aim = 4;

void ExpectEqual(const Matrix4& a, const Matrix4& b)
{
  for (int i = 0; i < 16; ++i)
  {
    EXPECT_NEAR(a.Data()[i], b.Data()[i], 1e-9) << i;
  }
}
}

TEST(EmulatedProbe, LooksAtTheSceneAtOneInstant)
{
  const Matrix4 imageToFace = ScannerScreen({}).GetImageToFace();
  const EmulatedProbe probe(EverydaySweep, 1, imageToFace, Depth, Aim);
  ExpectEqual(probe.ImageToScene(Aim), Matrix4::Translation({ 0, -0.5 * Depth, 0 }) * imageToFace);
  // and elsewhere later: along the image's normal
  const Vec3 before = probe.ImageToScene(Aim - 1).Point(imageToFace.Inverse().Point({ 0, 30, 0 }));
  const Vec3 after = probe.ImageToScene(Aim + 1).Point(imageToFace.Inverse().Point({ 0, 30, 0 }));
  EXPECT_GT(std::abs(after[2] - before[2]), 40);
}

TEST(EmulatedProbe, IsWhatItsCalibrationSays)
{
  const Matrix4 imageToFace = ScannerScreen({}).GetImageToFace();
  const EmulatedProbe probe(EverydaySweep, 2, imageToFace, Depth, Aim);
  const std::string path = testing::TempDir() + "lacuna-emulated-probe.xml";
  std::ofstream(path) << probe.FormatCalibration();
  const std::vector<NamedTransform> transforms = ReadCalibrationFile(path);
  ASSERT_EQ(transforms.size(), 2u);
  EXPECT_EQ(transforms[0].From + transforms[0].To, "ImageProbe");
  EXPECT_EQ(transforms[1].From + transforms[1].To, "TrackerReference");
  for (const double time : { 0.0, 1.7, 12.3 })
  {
    ExpectEqual(probe.ImageToScene(time),
      transforms[1].Matrix * EverydaySweep(time, 2) * transforms[0].Matrix);
  }
  EXPECT_GT(probe.GetImageToReceiver().Determinant3(), 0); // it never mirrors
  // nothing is symmetric that could hide a mistake
  for (int i = 0; i < 12; ++i)
  {
    EXPECT_GT(std::abs(probe.GetImageToReceiver().Data()[i]), 1e-3) << i;
  }
}
