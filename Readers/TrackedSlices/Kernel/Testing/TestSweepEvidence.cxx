// SPDX-License-Identifier: BSD-3-Clause
/// What a file says of its pixels is used, or its contradiction is told.
#include "SequenceFile.h"
#include "lacunaPixelSpacing.h"
#include "lacunaSweep.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

using namespace lacuna;

namespace
{
constexpr double NaN = std::numeric_limits<double>::quiet_NaN();
// What EditSequenceFile of PLUS leaves of a crop that begins at column 12 and row 6.
constexpr const char* Crop = "1 0 0 -12 0 1 0 -6 0 0 1 0 0 0 0 1";
using Flags = std::vector<unsigned char>;

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
  SequenceHeader header = ReadSequenceHeader(sequence.GetPath());
  Sweep sweep = BuildSweep(header, options);
  sweep.Warnings.insert(sweep.Warnings.begin(), header.Warnings.begin(), header.Warnings.end());
  return sweep;
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

void ExpectContains(const std::string& text, const std::vector<std::string>& parts)
{
  for (const std::string& part : parts)
  {
    EXPECT_NE(text.find(part), std::string::npos) << text << "\nlacks: " << part;
  }
}

void ExpectPoint(const Vec3& actual, const Vec3& expected)
{
  for (int i = 0; i < 3; ++i)
  {
    EXPECT_NEAR(actual[i], expected[i], 1e-12);
  }
}

SequenceFile MakeCropped(int frames = 3)
{
  SequenceFile file = MakeSequence(frames);
  for (int i = 0; i < frames; ++i)
  {
    file.SetFrame(i, "ImageToCroppedImageTransform", Crop);
    file.SetFrame(i, "ImageToCroppedImageTransformStatus", "OK");
  }
  return file;
}

// The same text in the frames from first to last.
void SetFrames(
  SequenceFile& file, int first, int last, const std::string& name, const std::string& text)
{
  for (int i = first; i <= last; ++i)
  {
    file.SetFrame(i, name, text);
  }
}
}

TEST(SweepEvidence, CroppedFramesLieWhereTheyWereCropped)
{
  const Sweep whole = Build(MakeSequence());
  const Sweep cropped = Build(MakeCropped());
  EXPECT_EQ(Warnings(cropped), "");
  EXPECT_EQ(cropped.ImageFrame, "CroppedImage");
  EXPECT_EQ(cropped.Chain, "CroppedImage > Image > Probe > Tracker > Reference");
  for (std::size_t i = 0; i < 3; ++i)
  {
    ExpectPoint(cropped.ImageToReference[i].Point({ 3, 4, 0 }),
      whole.ImageToReference[i].Point({ 15, 10, 0 }));
  }
  ExpectPoint(cropped.ImageToProbe.at(0).Point({ 0, 0, 0 }), { 1.2, 1.2, 5 });

  SweepOptions options;
  options.ImageFrame = "CroppedImage"; // the same, by its name
  const Sweep named = Build(MakeCropped(), MakeCalibration(), options);
  EXPECT_EQ(Warnings(named), "");
  ExpectPoint(
    named.ImageToReference[2].Point({ 0, 0, 0 }), cropped.ImageToReference[2].Point({ 0, 0, 0 }));
}

TEST(SweepEvidence, EachFrameHasItsOwnCrop)
{
  SequenceFile file = MakeCropped();
  file.SetFrame(1, "ImageToCroppedImageTransform", "1 0 0 -2 0 1 0 -3 0 0 1 0 0 0 0 1");
  file.SetFrame(2, "ImageToCroppedImageTransformStatus", "INVALID");
  const Sweep sweep = Build(file);
  const Sweep whole = Build(MakeSequence());
  ExpectPoint(
    sweep.ImageToReference[0].Point({ 0, 0, 0 }), whole.ImageToReference[0].Point({ 12, 6, 0 }));
  ExpectPoint(
    sweep.ImageToReference[1].Point({ 0, 0, 0 }), whole.ImageToReference[1].Point({ 2, 3, 0 }));
  EXPECT_EQ(sweep.Status, (Flags{ 0, 0, 1 }));
}

TEST(SweepEvidence, WithoutACalibrationCroppedPicturesRemain)
{
  SweepOptions options;
  for (const char* reference : { "Reference", "Tracker", "Table" })
  {
    options.ReferenceFrame = reference;
    const Sweep sweep = Build(MakeCropped(), "", options);
    EXPECT_TRUE(sweep.ImageToReference.empty());
    ExpectContains(Warnings(sweep),
      { "no chain of transforms leads from the image frame 'CroppedImage' to '" +
          std::string(reference),
        "CalibrationFileName that holds Image to Probe", "no file given" });
  }
  // also where the pictures are joined to a frame of their own: the calibration would lead on
  SequenceFile file = MakeSequence();
  SetFrames(file, 0, 2, "ImageToTransducerTransform", Crop);
  const Sweep sweep = Build(file, "");
  EXPECT_TRUE(sweep.ImageToReference.empty());
  ExpectContains(Warnings(sweep), { "no chain of transforms leads from the image frame 'Image'" });
}

TEST(SweepEvidence, OtherTransformsBetweenPicturesAreToldOf)
{
  SequenceFile file = MakeSequence();
  SetFrames(file, 0, 2, "ImageToFlippedImageTransform", "-1 0 0 4 0 1 0 0 0 0 1 0 0 0 0 1");
  ExpectContains(Warnings(Build(file)),
    { "transform ImageToFlippedImage joins two pictures. The pixels are taken to be in 'Image'; "
      "set "
      "ImageFrame to 'FlippedImage'" });
  // not when nothing is moved, and not when the chain goes by way of it
  SetFrames(file, 0, 2, "ImageToFlippedImageTransform", "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1");
  EXPECT_EQ(Warnings(Build(file)), "");
  SequenceFile scaled = MakeSequence();
  SetFrames(scaled, 0, 2, "ImageToImageMmTransform", "0.1 0 0 0 0 0.2 0 0 0 0 0.15 0 0 0 0 1");
  SetFrames(scaled, 0, 2, "ImageToImageMmTransformStatus", "OK");
  std::string calibration = MakeCalibration("1 0 0 0 0 1 0 0 0 0 1 5 0 0 0 1");
  calibration.replace(calibration.find("From=\"Image\""), 12, "From=\"ImageMm\"");
  const Sweep sweep = Build(scaled, calibration);
  EXPECT_EQ(Warnings(sweep), "");
  ExpectPoint(sweep.ImageToReference[2].Point({ 10, 20, 0 }), { -76, -3, 35 });
}

TEST(SweepEvidence, FramesOfAnotherDepthAreFlagged)
{
  SequenceFile file = MakeSequence(8);
  SetFrames(file, 0, 2, "ElementSpacing", "0.1 0.2 0.1");
  SetFrames(file, 3, 5, "ElementSpacing", "0.2 0.4 0.2");
  file.SetFrame(6, "ElementSpacing", "1 1 1"); // says nothing
  file.SetFrame(7, "ElementSpacing", "0.1015 0.2 0.1");
  const Sweep sweep = Build(file);
  EXPECT_EQ(sweep.Status, (Flags{ 0, 0, 0, 1, 1, 1, 0, 0 }));
  EXPECT_FALSE(sweep.ImageToReference[4].IsFinite());
  EXPECT_TRUE(sweep.ImageToReference[7].IsFinite());
  ExpectContains(Warnings(sweep),
    { "ElementSpacing says that pixels are 0.2 x 0.4 mm, the calibration that they are 0.1 x 0.2 "
      "mm, in frames 3 to 5.",
      "flagged as pose invalid (1)" });
  EXPECT_EQ(sweep.Warnings.size(), 1u);
  EXPECT_EQ(sweep.TextFields.at("ElementSpacing")[4], "0.2 0.4 0.2");

  SweepOptions options;
  options.DropInvalid = false;
  const Sweep unchecked = Build(file, MakeCalibration(), options);
  EXPECT_EQ(unchecked.Status, Flags(8, 0));
  EXPECT_TRUE(unchecked.ImageToReference[4].IsFinite());
  ExpectContains(Warnings(unchecked), { "in frames 3 to 5", "DropInvalidSlices is off" });

  // with the calibration of the other depth it is the others that are wrong
  const Sweep other = Build(file, MakeCalibration("0.2 0 0 0 0 0.4 0 0 0 0 0.1 5 0 0 0 1"));
  EXPECT_EQ(other.Status, (Flags{ 1, 1, 1, 0, 0, 0, 0, 1 }));
}

TEST(SweepEvidence, OneAxisIsEnough)
{
  SequenceFile file = MakeSequence();
  SetFrames(file, 0, 2, "ElementSpacing", "0.1 0.1 0.1");
  EXPECT_EQ(Build(file).Status, (Flags{ 1, 1, 1 }));
  SetFrames(file, 0, 2, "ElementSpacing", "0.2 0.2");
  EXPECT_EQ(Build(file).Status, (Flags{ 1, 1, 1 }));
}

TEST(SweepEvidence, TheHeaderSpeaksForFramesThatAreSilent)
{
  SequenceFile file = MakeSequence();
  for (const char* nothing : { "1 1 1", "1 1" })
  {
    file.Set("ElementSpacing", nothing);
    const Sweep silent = Build(file);
    EXPECT_EQ(Warnings(silent), "");
    EXPECT_EQ(silent.TextFields.count("ElementSpacing"), 0u);
  }
  file.Set("ElementSpacing", "0.3 0.3 1");
  file.SetFrame(1, "PixelSpacingMm", "0.1 0.2"); // as Ultrasonix scanners say it
  const Sweep sweep = Build(file);
  EXPECT_EQ(sweep.Status, (Flags{ 1, 0, 1 }));
  ExpectContains(
    Warnings(sweep), { "the header says that pixels are 0.3 x 0.3 mm", "in frames 0, 2" });
  EXPECT_EQ(sweep.TextFields.at("ElementSpacing")[2], "0.3 0.3"); // what a writer keeps
  file.SetFrame(2, "ElementSpacing", "0.1 0.2 1");
  EXPECT_EQ(Build(file).Status, (Flags{ 1, 0, 0 }));

  SequenceFile size = MakeSequence();
  size.Set("ElementSize", "0.3 0.3 1");
  EXPECT_EQ(Build(size).Status, (Flags{ 1, 1, 1 }));
}

TEST(SweepEvidence, SizesThatCannotBeAreToldOf)
{
  for (const char* text : { "0 0.2 1", "abc", "-0.1 0.2", "nan nan", "0.1" })
  {
    SequenceFile file = MakeSequence();
    file.SetFrame(1, "ElementSpacing", text);
    const Sweep sweep = Build(file);
    EXPECT_EQ(sweep.Status, (Flags{ 0, 0, 0 }));
    ExpectContains(Warnings(sweep),
      { "ElementSpacing is '" + std::string(text) + "' in frame 1, which is no size of a pixel" });
  }
}

TEST(SweepEvidence, ChangesWithoutACalibration)
{
  SequenceFile file = MakeSequence(4);
  SetFrames(file, 0, 1, "ElementSpacing", "0.1 0.2 1");
  SetFrames(file, 2, 3, "ElementSpacing", "0.15 0.3 1");
  const Sweep sweep = Build(file, "");
  EXPECT_EQ(sweep.Status, Flags(4, 0));
  ExpectContains(Warnings(sweep),
    { "0.1 x 0.2 mm in frames 0, 1", "0.15 x 0.3 mm in frames 2, 3",
      "no calibration holds for all" });
}

TEST(SweepEvidence, SettingsThatChangeAreToldOf)
{
  for (const char* name : { "DepthMm", "Depth", "ZoomFactor", "SectorPercent",
         "TransducerOriginPix", "HorizontalBins", "VerticalBins" })
  {
    SequenceFile file = MakeSequence(5);
    SetFrames(file, 0, 4, name, "55");
    EXPECT_EQ(Warnings(Build(file)), "");
    SetFrames(file, 2, 4, name, "80");
    ExpectContains(Warnings(Build(file)),
      { std::string("field ") + name + " changes: '55' in frames 0, 1, '80' in frames 2 to 4" });
  }
}

TEST(SweepEvidence, TransformsOfTheHeaderHoldForAllFrames)
{
  SequenceFile file = MakeSequence();
  file.Set("ImageToProbeTransform", "0.1 0 0 0 0 0.2 0 0 0 0 0.15 5 0 0 0 1");
  const Sweep sweep = Build(file, "");
  EXPECT_EQ(Warnings(sweep), "");
  ASSERT_EQ(sweep.ImageToReference.size(), 3u);
  ExpectPoint(sweep.ImageToReference[2].Point({ 10, 20, 0 }), { -76, -3, 35 });
  EXPECT_EQ(sweep.HeaderTransforms, (std::set<std::string>{ "ImageToProbe" }));

  file.Set("ImageToProbeTransformStatus", "INVALID");
  ExpectContains(
    Warnings(Build(file, "")), { "its status is 'INVALID'", "without ImageToReference" });
  file.Remove("ImageToProbeTransformStatus");
  file.Set("ImageToProbeTransform", "0.1 0 0");
  ExpectContains(Warnings(Build(file, "")), { "ImageToProbe of the header has 3 numbers, not 16" });

  SequenceFile both = MakeSequence();
  both.Set("ProbeToTrackerTransform", "1 0 0 9 0 1 0 9 0 0 1 9 0 0 0 1");
  const Sweep frames = Build(both);
  ExpectPoint(frames.ImageToReference[2].Point({ 10, 20, 0 }), { -76, -3, 35 });
  ExpectContains(Warnings(frames), { "ProbeToTracker of the header is not used" });
}

TEST(SweepEvidence, HostileHeadersCostLittle)
{
  SequenceFile file = MakeSequence(2000, 1, 2);
  for (int i = 0; i < 3000; ++i)
  {
    file.AddLine("A" + std::to_string(i) + "ToBTransform = 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1");
  }
  for (int i = 0; i < 2000; ++i)
  {
    file.Append(i, "ElementSpacing", std::to_string(i + 2) + " 1");
    file.Append(i, "DepthMm", std::to_string(i));
  }
  const Sweep sweep = Build(file);
  EXPECT_EQ(sweep.HeaderTransforms.size(), 16u);
  EXPECT_EQ(sweep.Status, Flags(2000, 1));
  EXPECT_LE(sweep.Warnings.size(), 5u);
  ExpectContains(
    Warnings(sweep), { "more than 16 transforms", "field DepthMm changes", "and 1992 more" });
}

TEST(SweepEvidence, SixteenNumbersUnderAnotherNameAreToldOf)
{
  SequenceFile file = MakeSequence();
  SetFrames(file, 1, 2, "DefaultTransformToTracker", Crop);
  file.Set("ProbeCalibration", Crop);
  const std::string warnings = Warnings(Build(file));
  ExpectContains(warnings,
    { "a name that does not end in Transform", "ProbeCalibration, DefaultTransformToTracker" });
}

TEST(SweepEvidence, ThePlaceOfTheImageIsNotThatOfItsSlices)
{
  SequenceFile file = MakeSequence();
  file.Set("Offset", "0 0 0");
  file.Set("CenterOfRotation", "0 0 0");
  file.Set("TransformMatrix", "1 0 0 0 1 0 0 0 1");
  file.Set("AnatomicalOrientation", "RAI");
  EXPECT_EQ(Warnings(Build(file)), "");
  file.Set("Offset", "0 -3.5 0");
  file.Set("TransformMatrix", "1 0 0 0 -1 0 0 0 1");
  ExpectContains(Warnings(Build(file)),
    { "header field Offset is '0 -3.5 0', which places the image in space. It is not used",
      "header field TransformMatrix is '1 0 0 0 -1 0 0 0 1'" });
}

TEST(SweepEvidence, ScanLinesHaveNoPixelsOfAPicture)
{
  SequenceFile file = MakeSequence();
  file.Set("UltrasoundImageOrientation", "FM");
  const Sweep sweep = Build(file);
  ExpectContains(Warnings(sweep), { "the slices are scan lines", "a calibration of these lines" });
  EXPECT_EQ(Warnings(Build(file, "")).find("scan lines"), std::string::npos);
}

TEST(PixelSpacing, ReadsComparesAndFormats)
{
  EXPECT_EQ(ReadPixelSpacing(" 0.2\t0.25 1 "), (Vec2{ 0.2, 0.25 }));
  EXPECT_TRUE(std::isnan(ReadPixelSpacing("0.2")[1]));
  EXPECT_TRUE(std::isnan(ReadPixelSpacing("x 0.2")[0]));
  EXPECT_FALSE(SaysPixelSpacing({ 1, 1 }));
  EXPECT_TRUE(SaysPixelSpacing({ 1, 0.5 }));
  EXPECT_TRUE(IsPixelSpacing({ 0.1, 2 }));
  for (const Vec2& wrong : { Vec2{ 0, 1 }, Vec2{ 1, -1 }, Vec2{ NaN, 1 },
         Vec2{ 1, std::numeric_limits<double>::infinity() } })
  {
    EXPECT_FALSE(IsPixelSpacing(wrong));
  }
  EXPECT_TRUE(IsSameSpacing({ 0.2, 0.2039 }, { 0.2, 0.2 }));
  EXPECT_FALSE(IsSameSpacing({ 0.2, 0.2041 }, { 0.2, 0.2 }));
  EXPECT_FALSE(IsSameSpacing({ 0.1959, 0.2 }, { 0.2, 0.2 }));
  EXPECT_EQ(FormatPixelSpacing({ 0.2, 0.123456 }), "0.2 x 0.1235 mm");
}
