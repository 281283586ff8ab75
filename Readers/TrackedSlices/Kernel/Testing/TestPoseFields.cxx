// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaGeometryGate.h"
#include "lacunaParameterText.h"
#include "lacunaPoseFields.h"
#include "lacunaSequenceText.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

using namespace lacuna;

namespace
{
/// The probe moves along x; a pixel is 0.1 mm.
std::vector<SequenceFields> MakeFrames(const char* statusOfSecond = "OK")
{
  std::vector<SequenceFields> frames(3);
  for (std::size_t i = 0; i < 3; ++i)
  {
    frames[i] = { { "ImageToProbeTransform", "0.1 0 0 0 0 0.1 0 0 0 0 0.1 0 0 0 0 1" },
      { "ImageToProbeTransformStatus", "OK" },
      { "ReferenceToProbeTransform", "1 0 0 " + std::to_string(i) + " 0 1 0 0 0 0 1 0 0 0 0 1" },
      { "ReferenceToProbeTransformStatus", i == 1 ? statusOfSecond : "OK" } };
  }
  return frames;
}

std::vector<Matrix4> MakePoses()
{
  std::vector<Matrix4> poses;
  for (int i = 0; i < 3; ++i)
  {
    poses.push_back(Matrix4::Translation({ -1.0 * i, 0, 0 }) * Matrix4::Scaling({ 0.1, 0.1, 0.1 }));
  }
  return poses;
}
}

TEST(PoseFields, ToldByAChainOfTransforms)
{
  std::vector<Matrix4> poses = MakePoses();
  EXPECT_TRUE(TellPoses(MakeFrames(), "Image", "Reference", poses));
  EXPECT_FALSE(TellPoses(MakeFrames(), "Image", "Tracker", poses)); // no chain
  EXPECT_FALSE(TellPoses(MakeFrames(), "Picture", "Reference", poses));
  EXPECT_FALSE(TellPoses({ {}, {}, {} }, "Image", "Reference", poses));
  poses[2](0, 3) += 1e-10;
  EXPECT_TRUE(TellPoses(MakeFrames(), "Image", "Reference", poses));
  poses[2](0, 3) += 1e-6; // a corrected pose
  EXPECT_FALSE(TellPoses(MakeFrames(), "Image", "Reference", poses));
}

TEST(PoseFields, InvalidPoses)
{
  std::vector<Matrix4> poses = MakePoses();
  // used although the file does not call it valid: the file can tell it
  EXPECT_TRUE(TellPoses(MakeFrames("INVALID"), "Image", "Reference", poses));
  poses[1] = NoPose();
  EXPECT_TRUE(TellPoses(MakeFrames("INVALID"), "Image", "Reference", poses));
  EXPECT_FALSE(TellPoses(MakeFrames(), "Image", "Reference", poses)); // found invalid later
}

TEST(PoseFields, NumbersReadAsTheSameNumber)
{
  for (const double x : { 0.1, 1.0 / 3, -1.5e-300, 6.02214076e23, 5e-324, 1e22, 123456789.125, -0.0,
         std::numeric_limits<double>::max() })
  {
    double back = 1;
    ASSERT_TRUE(ParseNumber(FormatNumber(x), back)) << x;
    EXPECT_EQ(back, x);
    EXPECT_EQ(std::signbit(back), std::signbit(x));
  }
  EXPECT_EQ(FormatNumber(0.1), "0.1");
  EXPECT_EQ(FormatMatrix(Matrix4::Scaling({ 0.5, 2, 1 })), "0.5 0 0 0 0 2 0 0 0 0 1 0 0 0 0 1");
}
