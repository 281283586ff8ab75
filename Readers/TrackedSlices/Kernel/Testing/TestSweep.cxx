// SPDX-License-Identifier: BSD-3-Clause
#include "SequenceFile.h"
#include "lacunaSweep.h"

#include <gtest/gtest.h>

#include <cmath>

using namespace lacuna;

namespace
{
Sweep Build(const SequenceFile& file, const std::string& calibration = MakeCalibration(),
  SweepOptions options = {})
{
  const TemporaryFile sequence("sweep.igs.mha", file.GetContent());
  sequence.WriteBeside("calibration.xml", calibration);
  if (!calibration.empty())
  {
    options.CalibrationFileName =
      (std::filesystem::path(sequence.GetPath()).parent_path() / "calibration.xml").string();
  }
  return BuildSweep(ReadSequenceHeader(sequence.GetPath()), options);
}

Sweep BuildUnchecked(const SequenceFile& file)
{
  SweepOptions options;
  options.DropInvalid = false;
  return Build(file, MakeCalibration(), options);
}

void ExpectContains(const std::string& text, const std::vector<std::string>& parts)
{
  for (const std::string& part : parts)
  {
    EXPECT_NE(text.find(part), std::string::npos) << text << "\nlacks: " << part;
  }
}

void ExpectError(const SequenceFile& file, const std::string& calibration,
  const SweepOptions& options, const std::vector<std::string>& parts)
{
  ExpectContains(GetError([&] { Build(file, calibration, options); }), parts);
}

std::string Warnings(const Sweep& sweep)
{
  std::string text;
  for (const std::string& warning : sweep.Warnings)
  {
    text += warning + "\n";
  }
  return text;
}

void ExpectPoint(const Vec3& actual, const Vec3& expected)
{
  for (int i = 0; i < 3; ++i)
  {
    EXPECT_NEAR(actual[i], expected[i], 1e-12);
  }
}

using Flags = std::vector<unsigned char>;
}

TEST(Sweep, ComposesTheChain)
{
  const Sweep sweep = Build(MakeSequence());
  EXPECT_EQ(sweep.Chain, "Image > Probe > Tracker > Reference");
  EXPECT_EQ(sweep.Status, (Flags{ 0, 0, 0 }));
  EXPECT_EQ(Warnings(sweep), "");
  ASSERT_EQ(sweep.ImageToReference.size(), 3u);
  // Pixel (10, 20): (1, 4, 5) in Probe, (3, 24, 35) in Tracker of frame 2. Reference to Tracker is
  // a turn by 90 degrees (x -> y, y -> -x) and 100 along y; so back: x = y' - 100, y = -x'.
  ExpectPoint(sweep.ImageToReference[2].Point({ 10, 20, 0 }), { -76, -3, 35 });
  ExpectPoint(sweep.ImageToReference[0].Point({ 0, 0, 0 }), { -80, 0, 35 });
  EXPECT_GT(sweep.ImageToReference[1].Determinant3(), 0);
  ASSERT_EQ(sweep.ImageToProbe.size(), 1u);
  ExpectPoint(sweep.ImageToProbe[0].Point({ 10, 20, 0 }), { 1, 4, 5 });
  EXPECT_EQ(sweep.Timestamps, (std::vector<double>{ 10.25, 11.25, 12.25 }));
  EXPECT_EQ(sweep.FrameNumbers, (std::vector<int>{ 0, 1, 2 }));
  ASSERT_EQ(sweep.Transforms.size(), 2u);
  EXPECT_EQ(sweep.Transforms.at("ProbeToTracker")[2](0, 3), 2);
}

TEST(Sweep, TheCalibrationMayBeGivenBackwards)
{
  // Probe to Image: the inverse of MakeCalibration's matrix
  std::string calibration = MakeCalibration("10 0 0 0 0 5 0 0 0 0 10 -50 0 0 0 1");
  calibration.replace(
    calibration.find("From=\"Image\" To=\"Probe\""), 23, "From=\"Probe\" To=\"Image\"");
  const Sweep sweep = Build(MakeSequence(), calibration);
  ExpectPoint(sweep.ImageToReference[2].Point({ 10, 20, 0 }), { -76, -3, 35 });
  ExpectPoint(sweep.ImageToProbe.at(0).Point({ 10, 20, 0 }), { 1, 4, 5 });
}

TEST(Sweep, OtherFrames)
{
  SweepOptions options;
  options.ReferenceFrame = "Tracker";
  ExpectPoint(
    Build(MakeSequence(), MakeCalibration(), options).ImageToReference[2].Point({ 10, 20, 0 }),
    { 3, 24, 35 });
  options.ImageFrame = "Probe";
  const Sweep probe = Build(MakeSequence(), "", options);
  ExpectPoint(probe.ImageToReference[2].Point({ 10, 20, 0 }), { 12, 40, 30 });
  EXPECT_TRUE(probe.ImageToProbe.empty());
}

TEST(Sweep, WithoutCalibrationThePicturesRemain)
{
  SequenceFile file = MakeSequence();
  file.SetFrame(1, "ProbeToTrackerTransformStatus", "OUT_OF_VIEW");
  const Sweep sweep = Build(file, "");
  EXPECT_TRUE(sweep.ImageToReference.empty());
  EXPECT_TRUE(sweep.ImageToProbe.empty());
  EXPECT_EQ(sweep.Status, (Flags{ 0, 1, 0 })); // the pose of the probe
  ExpectContains(Warnings(sweep),
    { "image frame 'Image'", "CalibrationFileName", "ProbeToTracker, ReferenceToTracker",
      "no file given" });
}

TEST(Sweep, ErrorsNameTheMissingLink)
{
  SweepOptions options;
  SequenceFile onlyProbe = MakeSequence();
  for (int i = 0; i < 3; ++i)
  {
    onlyProbe.RemoveFrame(i, "ReferenceToTrackerTransform");
  }
  ExpectError(onlyProbe, MakeCalibration(), options,
    { "sweep.igs.mha", "no transform leads from or to the reference frame 'Reference'",
      "From 'Image' these frames can be reached: Image, Probe, Tracker",
      "sequence: ProbeToTracker; of the calibration file: ImageToProbe" });

  SequenceFile broken = MakeSequence();
  for (int i = 0; i < 3; ++i)
  {
    broken.RemoveFrame(i, "ProbeToTrackerTransform");
    broken.SetFrame(i, "StylusToTrackerTransform", "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1");
  }
  ExpectError(broken, MakeCalibration(), options,
    { "missing link", "(Image, Probe)", "(Reference, Stylus, Tracker)" });

  options.ImageFrame = "Picture";
  ExpectError(MakeSequence(), MakeCalibration(), options,
    { "image frame 'Picture'", "Set ImageFrame", "ImageToProbe" });
  options.ImageFrame = "Reference";
  ExpectError(MakeSequence(), MakeCalibration(), options, { "are both 'Reference'" });
  ExpectError(MakeSequence(), "<x/>", {}, { "calibration.xml", "no CoordinateDefinitions" });
}

TEST(Sweep, OnlyOkIsValid)
{
  for (const char* state :
    { "INVALID", "MISSING", "OUT_OF_VIEW", "ok", "Ok", "UNKNOWN", "BROKEN", "" })
  {
    SequenceFile file = MakeSequence();
    file.RemoveFrame(1, "ReferenceToTrackerTransformStatus");
    if (*state)
    {
      file.SetFrame(1, "ReferenceToTrackerTransformStatus", state);
    }
    const Sweep sweep = Build(file);
    EXPECT_EQ(sweep.Status, (Flags{ 0, 1, 0 })) << state;
    EXPECT_TRUE(std::isnan(sweep.ImageToReference[1](0, 0)));
    EXPECT_TRUE(std::isnan(sweep.ImageToReference[1](3, 3)));
    EXPECT_EQ(sweep.Transforms.at("ReferenceToTracker")[1](1, 3), 100); // as it is in the file
    EXPECT_EQ(sweep.TextFields.at("ReferenceToTrackerTransformStatus")[1], state);
    const Sweep unchecked = BuildUnchecked(file);
    EXPECT_EQ(unchecked.Status, (Flags{ 0, 0, 0 })) << state;
    ExpectPoint(unchecked.ImageToReference[1].Point({ 10, 20, 0 }), { -76, -2, 35 });
  }
  SequenceFile file = MakeSequence();
  file.SetFrame(1, "ReferenceToTrackerTransformStatus", "BROKEN");
  ExpectContains(Warnings(Build(file)), { "unknown status 'BROKEN' in frame 1" });
  file.SetFrame(1, "ReferenceToTrackerTransformStatus", "OUT_OF_VIEW");
  EXPECT_EQ(Warnings(Build(file)), ""); // nothing wrong with the file
  // a transform that is not in the chain does not matter
  SequenceFile stylus = MakeSequence();
  for (int i = 0; i < 3; ++i)
  {
    stylus.SetFrame(i, "StylusToTrackerTransform", "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1");
    stylus.SetFrame(i, "StylusToTrackerTransformStatus", "INVALID");
  }
  EXPECT_EQ(Build(stylus).Status, (Flags{ 0, 0, 0 }));
}

TEST(Sweep, ATransformWithoutAnyStatus)
{
  SequenceFile file = MakeSequence();
  for (int i = 0; i < 3; ++i)
  {
    file.RemoveFrame(i, "ProbeToTrackerTransformStatus");
  }
  const Sweep sweep = Build(file);
  EXPECT_EQ(sweep.Status, (Flags{ 0, 0, 0 }));
  ExpectContains(Warnings(sweep), { "ProbeToTrackerTransformStatus is missing in all frames" });
}

TEST(Sweep, ImageStatus)
{
  SequenceFile file = MakeSequence();
  file.SetFrame(0, "ImageStatus", "INVALID");
  file.RemoveFrame(1, "ImageStatus"); // absent means valid
  file.SetFrame(2, "ProbeToTrackerTransformStatus", "INVALID");
  file.SetFrame(2, "ImageStatus", "WHATEVER");
  EXPECT_EQ(Build(file).Status, (Flags{ 2, 0, 3 }));
  EXPECT_EQ(BuildUnchecked(file).Status, (Flags{ 0, 0, 0 }));
  SweepOptions options;
  options.DropInvalid = false;
  options.FramesWithPixels = 1; // the rest is cut off: nothing to use there
  EXPECT_EQ(Build(file, MakeCalibration(), options).Status, (Flags{ 0, 2, 2 }));
}

TEST(Sweep, PosesWithoutPicturesAreComplete)
{
  SequenceFile file = MakeSequence();
  file.Set("DimSize", "0 0 0");
  file.SetFrame(1, "ProbeToTrackerTransformStatus", "OUT_OF_VIEW");
  const Sweep sweep = Build(file);
  EXPECT_EQ(sweep.Status, (Flags{ 2, 3, 2 }));
  EXPECT_EQ(BuildUnchecked(file).Status, (Flags{ 2, 2, 2 })); // there is no image, whoever asks
  ExpectPoint(sweep.ImageToReference[2].Point({ 10, 20, 0 }), { -76, -3, 35 });
  EXPECT_EQ(sweep.Timestamps[2], 12.25);
  EXPECT_EQ(Warnings(sweep), ""); // the header has said it
}

TEST(Sweep, FlagsOfSpeedAndGatingComeFromTheFile)
{
  SequenceFile file = MakeSequence(5);
  const char* const flags[] = { "4", "13", "3", "256", "fast" };
  for (int i = 0; i < 5; ++i)
  {
    file.SetFrame(i, "SliceStatus", flags[i]);
  }
  file.SetFrame(2, "ImageStatus", "INVALID");
  EXPECT_EQ(Build(file).Status, (Flags{ 4, 13, 3, 2, 2 })); // the image is judged anew
  EXPECT_EQ(BuildUnchecked(file).Status, (Flags{ 0, 0, 0, 0, 0 }));
}

TEST(Sweep, FlagsThatCannotBeReadAreNamed)
{
  SequenceFile file = MakeSequence(8);
  const char* const flags[] = { "300", "-1", "abc", "abc", "4 8", "1.5", " 0 ", "64" };
  for (int i = 0; i < 8; ++i)
  {
    file.SetFrame(i, "SliceStatus", flags[i]);
  }
  const Sweep sweep = Build(file);
  EXPECT_EQ(sweep.Status, (Flags{ 2, 2, 2, 2, 2, 2, 0, 64 })); // a flag of the future stays
  ExpectContains(Warnings(sweep),
    { "field SliceStatus must be a whole number from 0 to 255", "'300' in frame 0",
      "'-1' in frame 1", "'abc' in frames 2, 3", "'4 8' in frame 4", "'1.5' in frame 5",
      "count as image invalid (2)" });
  for (const Matrix4& pose : sweep.ImageToReference)
  {
    EXPECT_TRUE(pose.IsFinite());
  }
  const Sweep unchecked = BuildUnchecked(file);
  EXPECT_EQ(unchecked.Status, Flags(8, 0));
  ExpectContains(Warnings(unchecked), { "'abc' in frames 2, 3" });
  EXPECT_EQ(Warnings(unchecked).find("count as"), std::string::npos);
  file.SetFrame(0, "SliceStatus", std::string(5000, 'x'));
  EXPECT_LT(Warnings(Build(file)).size(), 500u);
  for (int i = 0; i < 6; ++i)
  {
    file.RemoveFrame(i, "SliceStatus"); // absent is nothing
  }
  EXPECT_EQ(Build(file).Status, (Flags{ 0, 0, 0, 0, 0, 0, 0, 64 }));
  EXPECT_EQ(Warnings(Build(file)), "");
}

TEST(Sweep, DamagedMatricesSpoilTheirFrame)
{
  const std::pair<const char*, const char*> cases[] = {
    { "1 0 0 1 0 1 0 20 0 0 1 30 0 0 0", "has 15 numbers, not 16 in frame 1" },
    { "1 0 0 1 0 1 0 20 0 0 1 30 0 0 0 1 0", "has 17 numbers, not 16 in frame 1" },
    { "1 0 0 x 0 1 0 20 0 0 1 30 0 0 0 1", "has 'x', which is not a number in frame 1" },
    { "1 0 0 nan 0 1 0 20 0 0 1 30 0 0 0 1", "has 'nan', which is not finite in frame 1" },
    { "1 0 0 1.#QNAN 0 1 0 20 0 0 1 30 0 0 0 1", "not finite in frame 1" },
    { "1 0 0 1 0 1 0 20 0 0 0 30 0 0 0 1", "singular) in frame 1" },
    { "1 0 0 1 0 1 0 20 0 0 1 30 0 0 1 1", "not affine: its last row is not 0 0 0 1) in frame 1" }
  };
  for (const auto& [text, warning] : cases)
  {
    SequenceFile file = MakeSequence();
    file.SetFrame(1, "ProbeToTrackerTransform", text);
    for (const bool drop : { true, false })
    {
      const Sweep sweep = drop ? Build(file) : BuildUnchecked(file);
      EXPECT_EQ(sweep.Status, (Flags{ 0, 1, 0 })) << text;
      EXPECT_TRUE(std::isnan(sweep.ImageToReference[1](0, 0))) << text;
      ExpectContains(Warnings(sweep), { "transform ProbeToTracker ", warning });
    }
  }
  SequenceFile file = MakeSequence();
  file.RemoveFrame(0, "ProbeToTrackerTransform");
  file.RemoveFrame(2, "ProbeToTrackerTransform");
  const Sweep sweep = Build(file);
  EXPECT_EQ(sweep.Status, (Flags{ 1, 0, 1 }));
  ExpectContains(Warnings(sweep), { "transform ProbeToTracker is missing in frames 0, 2" });
}

TEST(Sweep, PosesThatCannotBeAreFlagged)
{
  const std::pair<const char*, const char*> cases[] = {
    { "-1 0 0 4 0 1 0 0 0 0 1 30 0 0 0 1",
      "transform ProbeToTracker mirrors: its axes are left-handed (frame 1) in frames 1 to 3; "
      "flagged in SliceStatus (1, pose invalid); convert the poses to right-handed axes" },
    { "1.2 0 0 4 0 1.2 0 0 0 0 1.2 30 0 0 0 1",
      "transform ProbeToTracker is not rigid: its columns have the lengths 1.2, 1.2 and 1.2, not 1 "
      "(frame 1) in frames 1 to 3; flagged in SliceStatus (1, pose invalid); check its digits" },
    { "1 0 0 4 0.9 1 0 0 0 0 1 30 0 0 0 1", "is not rigid" },
    { "1 0 0 4 0 1 0 0 0 0 1 2e6 0 0 0 1", "is more than a kilometre away, at 4, 0 and 2e+06 mm" }
  };
  for (const auto& [text, warning] : cases)
  {
    SequenceFile file = MakeSequence(5);
    for (int frame = 1; frame < 4; ++frame)
    {
      file.SetFrame(frame, "ProbeToTrackerTransform", text);
    }
    for (const bool drop : { true, false })
    {
      const Sweep sweep = drop ? Build(file) : BuildUnchecked(file);
      EXPECT_EQ(sweep.Status, (Flags{ 0, 1, 1, 1, 0 })) << text;
      EXPECT_TRUE(std::isnan(sweep.ImageToReference[1](0, 0))) << text;
      EXPECT_FALSE(std::isnan(sweep.ImageToReference[4](0, 0))) << text;
      ExpectContains(Warnings(sweep), { warning });
      EXPECT_EQ(sweep.Warnings.size(), 1u) << Warnings(sweep);
    }
    // what the file calls invalid is no surprise
    for (int frame = 1; frame < 4; ++frame)
    {
      file.SetFrame(frame, "ProbeToTrackerTransformStatus", "INVALID");
    }
    EXPECT_EQ(Warnings(Build(file)), "");
  }
  SequenceFile rounded = MakeSequence();
  rounded.SetFrame(1, "ProbeToTrackerTransform", "0.7 -0.71 0 4 0.71 0.7 0 0 0 0 1 30 0 0 0 1");
  EXPECT_EQ(Build(rounded).Status, (Flags{ 0, 0, 0 }));
  ExpectContains(Warnings(Build(rounded)),
    { "transform ProbeToTracker is not a rotation and a translation by 0.00", "in frame 1",
      "used nevertheless", "record 5 decimals" });
}

TEST(Sweep, CalibrationsThatCannotBeAreRefused)
{
  const auto error = [](const std::string& matrix)
  { return GetError([&] { Build(MakeSequence(), MakeCalibration(matrix)); }); };
  ExpectContains(error("0.2 0.15 0 0 0 0.2 0 0 0 0 0.2 0 0 0 0 1"),
    { "transform ImageToProbe of the calibration file is skewed: rows and columns meet at 53.1301 "
      "degrees, not 90; check its digits, or give another CalibrationFileName" });
  ExpectContains(error("0.2 0 0 0 0 20 0 0 0 0 0.2 0 0 0 0 1"), { "has pixels of 0.2 x 20 mm" });
  ExpectContains(error("2e-4 0 0 0 0 2e-4 0 0 0 0 2e-4 0 0 0 0 1"), { "check", "unit" });
  const auto warnings = [](const std::string& matrix)
  { return Warnings(Build(MakeSequence(), MakeCalibration(matrix))); };
  EXPECT_EQ(warnings("0.2 0 0 0 0 0.1 0 0 0 0 0.15 0 0 0 0 1"), "");
  ExpectContains(warnings("0.3 0 0 0 0 0.2 0 0 0 0 0.2 0 0 0 0 1"),
    { "transform ImageToProbe of the calibration file has pixels of 0.3 x 0.2 mm, which its third "
      "column does not confirm",
      "used nevertheless" });
  ExpectContains(warnings("-0.2 0 0 0 0 0.2 0 0 0 0 0.2 0 0 0 0 1"),
    { "ImageToProbe of the calibration file mirrors", "change the sign of the third column" });
  EXPECT_EQ(warnings("-0.2 0 0 0 0 0.2 0 0 0 0 -0.2 0 0 0 0 1"), "");
}

// The poses of pictures, without a calibration, have the size of a pixel.
TEST(Sweep, PosesOfPicturesAreJudgedAsCalibrations)
{
  SequenceFile file = MakeSequence(5);
  for (int frame = 0; frame < 5; ++frame)
  {
    file.SetFrame(frame, "ImageToReferenceTransform",
      frame == 2 ? "0.2 0.15 0 0 0 0.2 0 0 0 0 0.2 0 0 0 0 1"
                 : "0.2 0 0 0 0 0.2 0 0 0 0 0.2 0 0 0 0 1");
    file.SetFrame(frame, "ImageToReferenceTransformStatus", "OK");
  }
  const Sweep sweep = Build(file, "");
  EXPECT_EQ(sweep.Status, (Flags{ 0, 0, 1, 0, 0 }));
  ExpectContains(Warnings(sweep),
    { "transform ImageToReference is skewed", "in frame 2; flagged in SliceStatus" });
}

// As PLUS has them: the size of a pixel is in the middle of transforms that do not move.
// A probe that is held still has poses all the same: what is wrong with them is no calibration's
// fault, and they place no slice.
TEST(Sweep, PosesOfAProbeThatIsHeldStillAreJudgedAsPoses)
{
  for (const int frames : { 1, 5 })
  {
    for (const std::string pose : { "1 0 0 3 0 1 0 40 0 0 -1 -7 0 0 0 1", // mirrored
           "1.2 0 0 3 0 1.2 0 40 0 0 1.2 -7 0 0 0 1" })
    {
      SequenceFile file = MakeSequence(frames);
      for (int frame = 0; frame < frames; ++frame)
      {
        file.SetFrame(frame, "ProbeToTrackerTransform", pose);
      }
      const Sweep sweep = Build(file, MakeCalibration("0.2 0 0 0 0 0.2 0 0 0 0 0.2 0 0 0 0 1"));
      EXPECT_EQ(sweep.Status, (Flags(frames, 1))) << pose;
      ExpectContains(Warnings(sweep), { "transform ProbeToTracker ", "flagged in SliceStatus" });
    }
  }
}

TEST(Sweep, FixedTransformsOfASequenceAreOneCalibration)
{
  const std::string turned = "0 -1 0 3 1 0 0 40 0 0 1 -7 0 0 0 1";
  const auto make = [&](const std::string& size, const std::string& mount)
  {
    SequenceFile file = MakeSequence(5);
    const std::pair<const char*, std::string> links[] = { { "ImageToTransducerOriginPixelTransform",
                                                            "1 0 0 -3 0 1 0 -2 0 0 1 0 0 0 0 1" },
      { "TransducerOriginPixelToTransducerOriginTransform", size },
      { "TransducerOriginToProbeTransform", mount } };
    for (int frame = 0; frame < 5; ++frame)
    {
      for (const auto& [name, text] : links)
      {
        file.SetFrame(frame, name, text);
        file.SetFrame(frame, name + std::string("Status"), "OK");
      }
    }
    return file;
  };
  const std::string size = "0.2 0 0 0 0 0.1 0 0 0 0 0.15 0 0 0 0 1";
  SequenceFile file = make(size, turned);
  const Sweep sweep = Build(file, "");
  EXPECT_EQ(Warnings(sweep), "");
  EXPECT_EQ(sweep.Status, (Flags(5, 0)));
  // pixel (8, 12) lies 5 columns and 10 rows from the origin: (1, 1) mm, on the probe (2, 41, -7)
  ExpectPoint(sweep.ImageToProbe.at(0).Point({ 8, 12, 0 }), { 2, 41, -7 });
  const Sweep whole =
    Build(MakeSequence(5), MakeCalibration("0 -0.1 0 3.2 0.2 0 0 39.4 0 0 0.15 -7 0 0 0 1"));
  ExpectPoint(
    sweep.ImageToReference[3].Point({ 8, 12, 0 }), whole.ImageToReference[3].Point({ 8, 12, 0 }));
  // a frame that is damaged spoils no other one
  file.SetFrame(3, "TransducerOriginPixelToTransducerOriginTransform",
    "0.2 0 0 0 0.5 0.1 0 0 0 0 0.15 0 0 0 0 1");
  EXPECT_EQ(Build(file, "").Status, (Flags{ 0, 0, 0, 1, 0 }));
  ExpectContains(Warnings(Build(file, "")),
    { "the product of transforms ImageToTransducerOriginPixel and "
      "TransducerOriginPixelToTransducerOrigin and TransducerOriginToProbe is skewed",
      "in frame 3; flagged in SliceStatus" });
  // the product of these would be pixels of another scanner
  const Sweep larger = Build(make(size, "1.2 0 0 3 0 1.2 0 40 0 0 1.2 -7 0 0 0 1"), "");
  EXPECT_EQ(larger.Status, (Flags(5, 0)));
  ExpectContains(Warnings(larger),
    { "transform TransducerOriginToProbe is not rigid: its columns have the lengths 1.2, 1.2 and "
      "1.2, not 1, though the transforms before it have turned pixels into mm (frame 0) in frames "
      "0 to 4; used nevertheless; check its digits" });
  ExpectContains(Warnings(Build(make("0.2 0 0 0 0 0.1 0 0 0 0 1 0 0 0 0 1", turned), "")),
    { "has pixels of 0.2 x 0.1 mm, which its third column does not confirm: it is 1 long" });
}

// A name or an address under the name of a transform is in no message.
TEST(Sweep, TextsInPlaceOfTransformsOfAPatientAreNotQuoted)
{
  SequenceFile file = MakeSequence();
  file.Set("PatientToTownTransform", "Doe^Jane");
  file.Set("PatientToRoomTransform", "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1");
  file.Set("PatientToRoomTransformStatus", "Doe^Jane");
  const std::string warnings = Warnings(Build(file));
  ExpectContains(warnings,
    { "PatientToTown of the header does not have 16 finite numbers",
      "PatientToRoom of the header is not used: its status is not OK" });
  EXPECT_EQ(warnings.find("Doe"), std::string::npos) << warnings;
}

TEST(Sweep, NotOneValidSlice)
{
  SequenceFile file = MakeSequence(12);
  for (int i = 0; i < 12; ++i)
  {
    file.SetFrame(i, "ProbeToTrackerTransformStatus", "INVALID");
  }
  ExpectContains(Warnings(Build(file)), { "not one of the 12 slices is valid" });
  for (int i = 0; i < 12; ++i)
  {
    file.SetFrame(i, "ProbeToTrackerTransformStatus", "BAD" + std::to_string(i));
  }
  const Sweep sweep = Build(file); // a damaged file of many frames makes no flood of words
  EXPECT_EQ(sweep.Warnings.size(), 2u);
  ExpectContains(Warnings(sweep), { "and 4 more" });
}

TEST(Sweep, ExponentsOfOldMicrosoftLibraries)
{
  SequenceFile file = MakeSequence();
  file.SetFrame(1, "ProbeToTrackerTransform",
    "1 -1.5e-005 0 +1 1.5e-005 1.0e+000 0 2.0e+001  0 0 1 30 0 0 0 1  ");
  const Sweep sweep = Build(file);
  EXPECT_EQ(sweep.Status[1], 0);
  EXPECT_EQ(sweep.Transforms.at("ProbeToTracker")[1](0, 1), -1.5e-5);
  EXPECT_EQ(sweep.Transforms.at("ProbeToTracker")[1](1, 3), 20);
}

TEST(Sweep, TheCalibrationReplacesTransformsOfTheSequence)
{
  SequenceFile file = MakeSequence();
  for (int i = 0; i < 3; ++i)
  {
    file.SetFrame(i, "ImageToProbeTransform", "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1");
    file.SetFrame(i, "ImageToProbeTransformStatus", "OK");
  }
  const Sweep own = Build(file, "");
  ExpectPoint(own.ImageToReference[0].Point({ 1, 2, 0 }), { -78, -1, 30 });
  ExpectPoint(own.ImageToProbe.at(0).Point({ 1, 2, 0 }), { 1, 2, 0 }); // constant, so known
  EXPECT_EQ(own.Transforms.count("ImageToProbe"), 0u);
  EXPECT_EQ(own.TextFields.at("ImageToProbeTransform")[1], "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1");
  const Sweep given = Build(file);
  ExpectPoint(given.ImageToReference[2].Point({ 10, 20, 0 }), { -76, -3, 35 });
  ExpectContains(Warnings(given), { "ImageToProbe of the sequence is replaced" });

  file.SetFrame(1, "ImageToProbeTransform", "2 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1");
  const Sweep changed = Build(file, "");
  EXPECT_TRUE(changed.ImageToProbe.empty()); // not constant
  ExpectContains(Warnings(changed),
    { "the probe's calibration ImageToProbe of frame 1 is not that of frame 0" });
}

TEST(Sweep, ASequenceThatNeedsNoCalibrationSaysSo)
{
  SequenceFile file = MakeSequence();
  for (int i = 0; i < 3; ++i)
  {
    file.SetFrame(i, "ImageToReferenceTransform",
      "0.5 0 0 0 0 0.5 0 0 0 0 0.5 " + std::to_string(i) + " 0 0 0 1");
    file.SetFrame(i, "ImageToReferenceTransformStatus", "OK");
  }
  const Sweep sweep = Build(file);
  EXPECT_EQ(sweep.Chain, "Image > Reference");
  ExpectPoint(sweep.ImageToReference[2].Point({ 2, 4, 0 }), { 1, 2, 2 });
  ExpectContains(Warnings(sweep), { "calibration file is not used", "Image > Reference" });
  EXPECT_EQ(sweep.Transforms.count("ImageToReference"), 0u);
  EXPECT_EQ(sweep.TextFields.count("ImageToReferenceTransform"), 1u);
}

TEST(Sweep, NamesWithOddCharactersAndSeveralReadings)
{
  SequenceFile file = MakeSequence();
  const std::string unit = "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1";
  for (int i = 0; i < 3; ++i)
  {
    file.SetFrame(i, "ReferenceToM\xc3\xbcll & S\xc3\xb6hne #2Transform", unit);
    file.SetFrame(i, "ReferenceToM\xc3\xbcll & S\xc3\xb6hne #2TransformStatus", "OK");
    file.SetFrame(i, "TrackerToRoomToWorldTransform", unit);
    file.SetFrame(i, "TrackerToRoomToWorldTransformStatus", "OK");
    file.SetFrame(i, "StrangeTransform", unit);
    file.SetFrame(i, "Transform", "no transform at all");
  }
  SweepOptions options;
  options.ReferenceFrame = "M\xc3\xbcll & S\xc3\xb6hne #2";
  const Sweep sweep = Build(file, MakeCalibration(), options);
  ExpectPoint(sweep.ImageToReference[2].Point({ 10, 20, 0 }), { -76, -3, 35 });
  ExpectContains(Warnings(sweep), { "kept but not used in chains: Strange, TrackerToRoomToWorld" });
  EXPECT_EQ(sweep.Transforms.count("Strange"), 1u);
  EXPECT_EQ(sweep.TextFields.at("Transform")[0], "no transform at all");
  // another transform tells which reading is meant
  for (int i = 0; i < 3; ++i)
  {
    file.SetFrame(i, "ReferenceToRoomToWorldTransform", unit); // as ambiguous as before
    file.SetFrame(i, "StylusToWorldTransform", unit);
    file.SetFrame(i, "StylusToTrackerToRoomTransform", unit);
  }
  file.RemoveFrame(0, "StrangeTransform");
  options.ReferenceFrame = "RoomToWorld";
  ExpectError(file, MakeCalibration(), options, { "reference frame 'RoomToWorld'" });
  std::string calibration = MakeCalibration();
  calibration.insert(calibration.find("    <Transform"),
    "<Transform From=\"RoomToWorld\" To=\"Building\" Matrix=\"" + unit + "\"/>\n");
  options.ReferenceFrame = "Building";
  EXPECT_EQ(
    Build(file, calibration, options).Chain, "Image > Probe > Tracker > RoomToWorld > Building");
}

TEST(Sweep, TimesAndNumbers)
{
  SequenceFile file = MakeSequence();
  file.SetFrame(0, "FrameNumber", "1200");
  file.SetFrame(1, "FrameNumber", "12.5");
  file.SetFrame(2, "FrameNumber", "99999999999");
  file.SetFrame(1, "Timestamp", "noon");
  file.SetFrame(1, "UnfilteredTimestamp", "11.3");
  const Sweep sweep = Build(file);
  EXPECT_EQ(sweep.FrameNumbers, (std::vector<int>{ 1200, 1, 2 }));
  EXPECT_EQ(sweep.Timestamps[2], 12.25);
  EXPECT_TRUE(std::isnan(sweep.Timestamps[1]));
  ExpectContains(Warnings(sweep), { "Timestamp is missing or not a finite number in frame 1" });
  EXPECT_EQ(
    sweep.TextFields.at("UnfilteredTimestamp"), (std::vector<std::string>{ "", "11.3", "" }));
  for (int i = 0; i < 3; ++i)
  {
    file.RemoveFrame(i, "Timestamp");
  }
  EXPECT_TRUE(Build(file).Timestamps.empty());
}
