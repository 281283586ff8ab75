// SPDX-License-Identifier: BSD-3-Clause
#include "WrittenSequence.h"
#include "lacunaProbeFrames.h"
#include "lacunaTestDevice.h"
#include "lacunaTestFastrak.h"

#include <gtest/gtest.h>

#include <fstream>

using namespace lacuna;
using namespace lacunaTest;

namespace
{
std::string Write(const TemporaryFolder& folder, const std::string& transforms)
{
  const std::string path = folder / "calibration.xml";
  std::ofstream(path) << "<PlusConfiguration><CoordinateDefinitions>" << transforms
                      << "</CoordinateDefinitions></PlusConfiguration>";
  return path;
}

std::string ErrorOf(const std::string& path, double spacing)
{
  try
  {
    ReadProbeFrames(path, spacing);
  }
  catch (const std::runtime_error& e)
  {
    return e.what();
  }
  ADD_FAILURE() << "no error";
  return {};
}
}

TEST(ProbeFrames, ChainsLeadToTheProbeAndTheReference)
{
  const TemporaryFolder folder;
  const std::string path = Write(folder, R"(
    <Transform From="Image" To="Probe" Matrix="0.1 0 0 5  0 0.2 0 6  0 0 0.15 7  0 0 0 1"/>)");
  const ProbeFrames frames = ReadProbeFrames(path, 0);
  EXPECT_LT(Norm(frames.ImageToProbe.Point({ 10, 10, 0 }) - Vec3{ 6, 8, 7 }), 1e-12);
  EXPECT_LT(Distance(frames.TrackerToReference, Matrix4()), 1e-15);
  Write(folder, R"(
    <Transform From="Probe" To="Transducer" Matrix="1 0 0 -5  0 1 0 0  0 0 1 0  0 0 0 1"/>
    <Transform From="Image" To="Transducer" Matrix="0.1 0 0 0  0 0.1 0 0  0 0 0.1 0  0 0 0 1"/>
    <Transform From="Reference" To="Tracker" Matrix="1 0 0 0  0 1 0 0  0 0 1 9  0 0 0 1"/>)");
  const ProbeFrames chained = ReadProbeFrames(path, 0.1); // says the same of the pixels
  EXPECT_LT(Norm(chained.ImageToProbe.Point({ 10, 0, 0 }) - Vec3{ 6, 0, 0 }), 1e-12);
  EXPECT_LT(Norm(chained.TrackerToReference.Point({ 0, 0, 0 }) - Vec3{ 0, 0, -9 }), 1e-12);
}

// The product of these would be the pixels of another scanner.
TEST(ProbeFrames, ALinkBehindTheSizeOfAPixelIsRigid)
{
  const TemporaryFolder folder;
  const ProbeFrames frames = ReadProbeFrames(Write(folder, R"(
    <Transform From="Image" To="Mount" Matrix="0.1 0 0 0  0 0.1 0 0  0 0 0.1 0  0 0 0 1"/>
    <Transform From="Mount" To="Probe" Matrix="1.2 0 0 5  0 1.2 0 0  0 0 1.2 0  0 0 0 1"/>)"),
    0);
  EXPECT_NEAR(frames.ImageToProbe(0, 0), 0.12, 1e-12); // used, since it may be as it was made
  EXPECT_HAS(frames.Warning,
    "MountToProbe is not rigid: its columns have the lengths 1.2, 1.2 and 1.2, not 1, though the "
    "transforms before it have turned pixels into mm; check its digits");
}

TEST(ProbeFrames, TheSizeOfAPixelIsAskedForAndNeverAssumed)
{
  const TemporaryFolder folder;
  const std::string rigid = Write(
    folder, R"(<Transform From="Image" To="Probe" Matrix="1 0 0 5  0 1 0 6  0 0 1 7  0 0 0 1"/>)");
  EXPECT_HAS(ErrorOf(rigid, 0), "set PixelSpacing");
  EXPECT_HAS(ErrorOf(rigid, 0), rigid);
  EXPECT_NEAR(ReadProbeFrames(rigid, 0.25).ImageToProbe(0, 0), 0.25, 1e-12);
  const std::string sized = Write(folder,
    R"(<Transform From="Image" To="Probe" Matrix="0.1 0 0 5  0 0.1 0 6  0 0 0.1 7  0 0 0 1"/>)");
  EXPECT_HAS(ErrorOf(sized, 0.2), "twice and differently");
}

TEST(ProbeFrames, RefusesWhatIsNoCalibration)
{
  const TemporaryFolder folder;
  EXPECT_HAS(
    ErrorOf(
      Write(folder,
        R"(<Transform From="Image" To="Probe" Matrix="1 0 0 0  0 1 0 0  0 0 1 0  0 0 0 1"/>)"),
      0),
    "identity");
  EXPECT_HAS(ErrorOf(folder / "none.xml", 0), "none.xml");
  EXPECT_HAS(
    ErrorOf(Write(folder,
              R"(<Transform From="Wall" To="Probe" Matrix="1 0 0 5  0 1 0 6  0 0 1 7  0 0 0 1"/>)"),
      0),
    "from Image to Probe");
  EXPECT_HAS(
    ErrorOf(
      Write(folder,
        R"(<Transform From="Image" To="Probe" Matrix="-.1 0 0 5  0 .1 0 6  0 0 .1 7  0 0 0 1"/>)"),
      0),
    "mirror");
  EXPECT_HAS(
    ErrorOf(
      Write(folder,
        R"(<Transform From="Image" To="Probe" Matrix=".2 .15 0 5  0 .2 0 6  0 0 .2 7  0 0 0 1"/>)"),
      0),
    "ImageToProbe is no calibration: it is skewed: rows and columns meet at 53.1301 degrees");
  const std::string image =
    R"(<Transform From="Image" To="Probe" Matrix=".3 0 0 5  0 .2 0 6  0 0 .2 7  0 0 0 1"/>)";
  EXPECT_HAS(ReadProbeFrames(Write(folder, image), 0).Warning,
    "ImageToProbe may be wrong: it has pixels of 0.3 x 0.2 mm");
  EXPECT_HAS(
    ErrorOf(
      Write(folder,
        image +
          R"(<Transform From="Tracker" To="Reference" Matrix="1.2 0 0 0  0 1 0 0  0 0 1 0  0 0 0 1"/>)"),
      0),
    "TrackerToReference is not rigid: its columns have the lengths 1.2, 1 and 1");
}
