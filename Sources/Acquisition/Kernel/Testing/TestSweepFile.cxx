// SPDX-License-Identifier: BSD-3-Clause
#include "WrittenSequence.h"
#include "lacunaCalibrationFile.h"
#include "lacunaOutputFile.h"
#include "lacunaPatientIdentity.h"
#include "lacunaSequenceText.h"
#include "lacunaSweep.h"
#include "lacunaSweepFile.h"
#include "lacunaSweepTransforms.h"
#include "lacunaTestDisk.h"
#include "lacunaTestNoThreads.h"
#include "lacunaTestRoom.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <limits>
#include <memory>
#include <thread>
#include <utility>

#include <unistd.h>

using namespace lacuna;
using namespace lacunaTest;

namespace
{
constexpr double NaN = std::numeric_limits<double>::quiet_NaN();

AcquiredSlice MakeSlice(int number)
{
  AcquiredSlice slice;
  const std::string pixels = MakePixels(number);
  slice.Pixels = std::make_shared<std::vector<std::uint8_t>>(pixels.begin(), pixels.end());
  slice.FrameNumber = 3 * number;
  slice.Timestamp = 0.04 * number;
  slice.ProbeToTracker = lacunaTest::Sweep(slice.Timestamp, 1);
  slice.Residual = 0.001;
  slice.Speed = number == 0 ? NaN : 12.5;
  return slice;
}

SweepFrame MakeFrame(bool calibrated)
{
  SweepFrame frame;
  frame.Window = { 7, 9, 5, 4 };
  frame.Calibrated = calibrated;
  frame.ImageToProbe = Matrix4::Translation({ 1, 2, 3 }) * Matrix4::Scaling({ 0.1, 0.2, 1 });
  frame.TrackerToReference = Matrix4::Translation({ 0, 0, 50 });
  return frame;
}

// What the system takes to make files and folders safe.

lacuna::Sweep ReadSweep(const std::string& path)
{
  return BuildSweep(ReadSequenceHeader(path), {});
}

// A video that leaves out a frame before each.
struct GappyVideo : public FrameDevice
{
  explicit GappyVideo(std::unique_ptr<FrameDevice> video)
    : Whole(std::move(video))
  {
  }
  VideoEvent Read(VideoFrame& frame) override { return this->Whole->Read(frame); }
  double GetLatency() const override { return this->Whole->GetLatency(); }
  VideoSource::Counts GetCounts() const override
  {
    VideoSource::Counts counts = this->Whole->GetCounts();
    counts.Missing = counts.Frames;
    return counts;
  }
  std::unique_ptr<FrameDevice> Whole;
};

// An acquisition that has taken twenty frames and been stopped.
struct Recorded
{
  explicit Recorded(const std::string& name)
  {
    AcquisitionDevices devices;
    devices.Frames = [video = this->Place.MakeVideo()](const auto& stopped)
    { return std::make_unique<GappyVideo>(video(stopped)); };
    devices.Poses = this->Place.MakeTracker();
    AcquisitionRules rules;
    rules.Mode = CaptureMode::EveryFrame;
    rules.RecordFileName = this->Folder / name;
    this->Work = std::make_unique<SweepAcquisition>(devices, rules, this->Place);
    this->Work->Start();
    this->Place.RunTo(20);
    this->Work->Stop();
  }
  // Begun some time ago when this returns; the flag is set when it has ended.
  std::thread BeginSweepBeside(std::atomic<bool>& ended)
  {
    std::thread user(
      [this, &ended]
      {
        this->Work->BeginSweep();
        ended = true;
      });
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    return user;
  }

  const TemporaryFolder Folder;
  Room Place;
  std::unique_ptr<SweepAcquisition> Work;
};
}

TEST(SweepFile, IsReadAsItWasTaken)
{
  const TemporaryFolder folder;
  for (const bool calibrated : { true, false })
  {
    const std::string path = folder / (calibrated ? "a.igs.mhd" : "b.nhdr");
    SweepFile file(path, 0);
    AcquiredSlice lost = MakeSlice(1);
    lost.Status = lacuna::Sweep::PoseInvalid;
    lost.ProbeToTracker(0, 0) = NaN;
    AcquiredSlice fast = MakeSlice(2);
    fast.Status = lacuna::Sweep::TooFast | lacuna::Sweep::ImageInvalid;
    const SweepFrame frame = MakeFrame(calibrated);
    file.Add(MakeSlice(0), frame);
    file.Add(lost, frame);
    file.Add(fast, frame);
    file.Finish();
    EXPECT_EQ(file.GetState().FileName, path);
    EXPECT_EQ(file.GetState().Synced, 3);
    const ReadBack pixels(path);
    const lacuna::Sweep sweep = ReadSweep(path);
    ASSERT_EQ(sweep.Status.size(), 3u);
    EXPECT_EQ(sweep.Status[0], 0);
    // only with a calibration a missing pose makes a slice useless
    EXPECT_EQ(sweep.Status[1], lacuna::Sweep::PoseInvalid);
    EXPECT_EQ(sweep.Status[2], lacuna::Sweep::TooFast | lacuna::Sweep::ImageInvalid);
    EXPECT_EQ(sweep.FrameNumbers, (std::vector<int>{ 0, 3, 6 }));
    EXPECT_NEAR(sweep.Timestamps[2], 0.08, 1e-12);
    EXPECT_EQ(sweep.TextFields.at("Residual")[0], "0.001");
    for (int i = 0; i < 3; ++i)
    {
      EXPECT_EQ(pixels.Frames[i], MakePixels(i));
    }
    EXPECT_LT(
      Distance(sweep.Transforms.at("ProbeToTracker")[2], lacunaTest::Sweep(0.08, 1)), 1e-12);
    ASSERT_EQ(sweep.ImageToReference.size(), calibrated ? 3u : 0u);
    if (calibrated)
    {
      // coordinates are those of the whole picture
      EXPECT_LT(Distance(sweep.ImageToProbe.at(0), frame.ImageToProbe), 1e-12);
      const Vec3 place = sweep.ImageToReference[0].Point({ 7, 9, 0 });
      const Vec3 expected = (frame.TrackerToReference * MakeSlice(0).ProbeToTracker)
                              .Point(frame.ImageToProbe.Point({ 7, 9, 0 }));
      EXPECT_LT(Norm(place - expected), 1e-9);
      EXPECT_TRUE(std::isnan(sweep.ImageToReference[1](0, 0)));
    }
  }
}

// Calibrated when it was taken, later, or again: the file's pixels are a part of the picture.
TEST(SweepFile, ACalibrationOfTheWholePictureHoldsForAPartOfIt)
{
  const TemporaryFolder folder;
  const SweepFrame frame = MakeFrame(true);
  const std::string calibration = folder / "calibration.xml";
  for (const bool backwards : { false, true })
  {
    const Matrix4 matrix = backwards ? frame.ImageToProbe.Inverse() : frame.ImageToProbe;
    std::ofstream(calibration) << "<PlusConfiguration><CoordinateDefinitions><Transform From=\""
                               << (backwards ? "Probe\" To=\"Image" : "Image\" To=\"Probe")
                               << "\" Matrix=\"" << FormatMatrix(matrix)
                               << "\"/></CoordinateDefinitions></PlusConfiguration>";
    for (const bool calibrated : { true, false })
    {
      const std::string path = FindFreeSweepName(folder / "sweep.mhd", 0);
      SweepFile file(path, 0);
      file.Add(MakeSlice(1), MakeFrame(calibrated));
      file.Finish();
      SweepOptions options;
      options.CalibrationFileName = calibration;
      const lacuna::Sweep sweep = BuildSweep(ReadSequenceHeader(path), options);
      EXPECT_LT(Norm(GetPictureOrigin(ReadSequenceHeader(path)) - Vec3{ 7, 9, 0 }), 1e-12);
      const Vec3 expected = (frame.TrackerToReference * MakeSlice(1).ProbeToTracker)
                              .Point(frame.ImageToProbe.Point({ 7 + 2, 9 + 3, 0 }));
      EXPECT_LT(Norm(sweep.ImageToReference.at(0).Point({ 7 + 2, 9 + 3, 0 }) - expected), 1e-9);
    }
  }
}

TEST(SweepFile, OthersReadItsTransformsOfItsPixels)
{
  const SweepFrame frame = MakeFrame(true);
  for (const auto& [name, text] : MakeSliceFields(MakeSlice(0), frame))
  {
    if (name == "ImageToProbeTransform")
    {
      Matrix4 matrix;
      ASSERT_EQ(ParseMatrix(text, matrix), "");
      const Vec3 expected = frame.ImageToProbe.Point({ 7 + 2, 9 + 3, 0 });
      EXPECT_LT(Norm(matrix.Point({ 2, 3, 0 }) - expected), 1e-9);
      return;
    }
  }
  ADD_FAILURE() << "no ImageToProbe";
}

// Whoever reads it compares it with the calibration at hand: what is recorded is what was said.
TEST(SweepFile, KeepsTheSizeOfPixelsThatTheVideoTold)
{
  const TemporaryFolder folder;
  const std::string path = folder / "depth.mhd";
  SweepFrame frame = MakeFrame(true); // for pixels of 0.1 x 0.2 mm
  {
    SweepFile file(path, 0);
    for (int i = 0; i < 6; ++i)
    {
      AcquiredSlice slice = MakeSlice(i);
      if (i > 0)
      {
        slice.PixelSpacing = i < 3 ? Vec2{ 0.1, 0.2 } : Vec2{ 0.2, 0.4 };
      }
      file.Add(slice, frame);
    }
    file.Finish();
  }
  SweepOptions options;
  const SequenceHeader header = ReadSequenceHeader(path);
  const lacuna::Sweep sweep = BuildSweep(header, options);
  EXPECT_EQ(sweep.TextFields.at("ElementSpacing"),
    (std::vector<std::string>{ "", "0.1 0.2", "0.1 0.2", "0.2 0.4", "0.2 0.4", "0.2 0.4" }));
  EXPECT_EQ(sweep.Status, (std::vector<unsigned char>{ 0, 0, 0, 1, 1, 1 }));
  // with the calibration of the other depth it is the first ones that are wrong
  const std::string calibration = folder / "calibration.xml";
  std::ofstream(calibration) << FormatCalibration(
    { { "Image", "Probe", Matrix4::Scaling({ 0.2, 0.4, 1 }) } }, "another depth");
  options.CalibrationFileName = calibration;
  EXPECT_EQ(BuildSweep(header, options).Status, (std::vector<unsigned char>{ 0, 1, 1, 0, 0, 0 }));
}

TEST(SweepFile, NoFieldIdentifiesThePatient)
{
  AcquiredSlice slice = MakeSlice(0);
  slice.PixelSpacing = Vec2{ 0.1, 0.2 };
  for (const auto& [name, text] : MakeSliceFields(slice, MakeFrame(true)))
  {
    EXPECT_FALSE(IdentifiesPatient(name)) << name;
  }
}

TEST(SweepFile, APartThatBeginsNowhereIsRefused)
{
  SequenceHeader header;
  header.CustomFields = { { "FirstRow", "ten" } };
  EXPECT_THROW(GetPictureOrigin(header), std::runtime_error);
}

TEST(SweepFile, NeverWritesOverAnother)
{
  const TemporaryFolder folder;
  EXPECT_EQ(FindFreeSweepName(folder / "sweep.igs.mhd", 0), folder / "sweep.igs.mhd");
  std::ofstream(folder / "sweep.igs.raw") << "pixels of something";
  EXPECT_EQ(FindFreeSweepName(folder / "sweep.igs.mhd", 0), folder / "sweep-2.igs.mhd");
  EXPECT_EQ(FindFreeSweepName(folder / "sweep.igs.mhd", 6), folder / "sweep.igs.mhd");
  std::ofstream(folder / "sweep-2.igs.mhd") << "header of something";
  EXPECT_EQ(FindFreeSweepName(folder / "sweep.igs.mhd", 0), folder / "sweep-3.igs.mhd");
  for (int i = 0; i < 2; ++i)
  {
    SweepFile file(folder / "again.mhd", 0);
    file.Add(MakeSlice(i), MakeFrame(false));
    file.Finish();
    const std::string name = folder / (i == 0 ? "again.mhd" : "again-2.mhd");
    EXPECT_EQ(file.GetState().FileName, name);
    EXPECT_EQ(ReadBack(name).Frames.at(0), MakePixels(i));
  }
}

TEST(SweepFile, RefusesNamesOfFilesThatCannotGrow)
{
  EXPECT_THROW(SweepFile("sweep.mha", 0), std::invalid_argument);
  EXPECT_THROW(SweepFile("sweep.nrrd", 0), std::invalid_argument);
  EXPECT_THROW(SweepFile("sweep", 0), std::invalid_argument);
}

TEST(SweepFile, WhileTheFolderIsMissingSlicesWaitInMemory)
{
  const TemporaryFolder folder;
  const std::string path = folder / "missing/sweep.mhd";
  SweepFile file(path, 0);
  for (int i = 0; i < 4; ++i)
  {
    file.Add(MakeSlice(i), MakeFrame(true));
  }
  EXPECT_EQ(file.GetState().WaitingBytes, 4 * 20);
  // The thread that opens the file may come late on a busy machine; a capture asks again at each frame.
  for (int frame = 0; frame < 3000 && file.GetState().Trouble.empty(); ++frame)
  {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    file.Retry();
  }
  EXPECT_NE(file.GetState().Trouble.find("missing"), std::string::npos);
  EXPECT_EQ(file.GetState().Added, 4);
  EXPECT_EQ(file.GetState().Synced, 0);
  EXPECT_LT(file.GetState().FreeBytes, 0); // of a disk that is not known yet
  EXPECT_THROW(file.Finish(), FileError);
  EXPECT_EQ(file.GetState().WaitingBytes, 4 * 20);
  std::filesystem::create_directory(folder / "missing");
  file.Retry(); // not before a second has passed
  file.Finish();
  EXPECT_EQ(file.GetState().WaitingBytes, 0);
  EXPECT_EQ(file.GetState().Trouble, "");
  EXPECT_EQ(file.GetState().Synced, 4);
  EXPECT_GT(file.GetState().FreeBytes, 0);
  const ReadBack read(path);
  ASSERT_EQ(read.Frames.size(), 4u);
  EXPECT_EQ(read.Frames[3], MakePixels(3));
}

TEST(SweepFile, WhileNoThreadCanBeStartedSlicesWaitAndNoFileIsLeft)
{
  const TemporaryFolder folder;
  SweepFile file(folder / "sweep.mhd", 0);
  {
    const NoThreads none;
    file.Add(MakeSlice(0), MakeFrame(true));
    EXPECT_THROW(file.Finish(), FileError);
    file.Add(MakeSlice(1), MakeFrame(true));
    const SweepFile::State state = file.GetState();
    EXPECT_NE(state.Trouble.find("No thread"), std::string::npos) << state.Trouble;
    EXPECT_NE(state.Trouble.find("wait in memory"), std::string::npos) << state.Trouble;
    EXPECT_EQ(state.WaitingBytes, 2 * 20);
    EXPECT_FALSE(std::filesystem::exists(folder / "sweep.mhd"));
    EXPECT_FALSE(std::filesystem::exists(folder / "sweep.raw"));
  }
  file.Finish();
  EXPECT_EQ(file.GetState().Trouble, "");
  EXPECT_EQ(ReadBack(folder / "sweep.mhd").Frames.size(), 2u);
}

// Frames that wait for a disk would be given the time at which it is ready.
TEST(SweepFile, NothingWaitsForADiskThatIsSlow)
{
  const TemporaryFolder folder;
  const SteadyClock clock;
  for (const bool finish : { true, false })
  {
    const std::string path = folder / (finish ? "finished.mhd" : "left.mhd");
    {
      lacunaTest::DiskDelay = 400;
      SweepFile file(path, 0);
      const double begin = clock.Now();
      for (int i = 0; i < 5; ++i)
      {
        file.Add(MakeSlice(i), MakeFrame(true));
      }
      const double taken = clock.Now() - begin;
      std::cout << "five slices were taken in " << taken << " s\n";
      EXPECT_LT(taken, 0.3);
      EXPECT_EQ(file.GetState().WaitingBytes, 5 * 20);
      EXPECT_EQ(file.GetState().Trouble, "");
      lacunaTest::DiskDelay = 0; // but for the opening, which goes on
      if (finish)
      {
        file.Finish();
        EXPECT_EQ(file.GetState().FileName, path);
        EXPECT_EQ(file.GetState().Synced, 5);
      }
    }
    EXPECT_EQ(ReadBack(path).Frames.size(), 5u);
  }
}

TEST(SweepAcquisition, WhatWaitsForTheDiskIsWrittenAlsoWhenNoFramesCome)
{
  Recorded recorded("missing/sweep.mhd");
  SweepAcquisition& acquisition = *recorded.Work;
  EXPECT_EQ(acquisition.GetState().File.Synced, 0);
  std::filesystem::create_directory(recorded.Folder / "missing");
  AcquisitionState state;
  for (int i = 0; i < 1000 && state.File.Synced < 20; ++i) // it is tried again after a second
  {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    state = acquisition.GetState();
  }
  EXPECT_EQ(state.File.Synced, 20);
  EXPECT_EQ(state.File.Trouble, "");
}

TEST(SweepAcquisition, DevicesGoOnWhileASlowDiskEndsTheRecording)
{
  Recorded recorded("sweep.mhd");
  SweepAcquisition& acquisition = *recorded.Work;
  lacunaTest::DiskDelay = 1000;
  std::atomic<bool> begun{ false };
  std::thread user = recorded.BeginSweepBeside(begun);
  recorded.Place.RunTo(40);
  acquisition.GetState();
  EXPECT_FALSE(begun);
  lacunaTest::DiskDelay = 0;
  user.join();
  acquisition.Start();
  recorded.Place.RunTo(60);
  acquisition.Stop();
  EXPECT_EQ(acquisition.GetState().Counts.Frames, 20);
  EXPECT_EQ(acquisition.GetState().Missing, 20);
  EXPECT_EQ(acquisition.TakeSlices().size(), 20u);
  EXPECT_EQ(ReadBack(recorded.Folder / "sweep.mhd").Frames.size(), 20u);
}

// The button starts again before the disk is ready: longer than the track of poses reaches back.
TEST(SweepAcquisition, WhatIsCapturedWhileASlowDiskEndsTheRecordingHasItsPoses)
{
  Recorded recorded("sweep.mhd");
  SweepAcquisition& acquisition = *recorded.Work;
  lacunaTest::DiskDelay = 2000;
  std::atomic<bool> begun{ false };
  std::thread user = recorded.BeginSweepBeside(begun);
  acquisition.Start();
  recorded.Place.RunTo(520);
  EXPECT_FALSE(begun);
  lacunaTest::DiskDelay = 0;
  user.join();
  acquisition.Stop();
  EXPECT_EQ(acquisition.GetState().Missing, 500);
  const std::vector<AcquiredSlice> slices = acquisition.TakeSlices();
  EXPECT_EQ(slices.size(), 500u);
  for (const AcquiredSlice& slice : slices)
  {
    ASSERT_TRUE(slice.ProbeToTracker.IsFinite()) << slice.FrameNumber;
  }
}

TEST(SweepAcquisition, RecordsWhatItTakesAndBeginsNewFiles)
{
  const TemporaryFolder folder;
  Room room;
  AcquisitionDevices devices;
  devices.Frames = room.MakeVideo();
  devices.Poses = room.MakeTracker();
  AcquisitionRules rules;
  rules.Mode = CaptureMode::EveryFrame;
  rules.SpeedLimit = 0;
  rules.RecordFileName = folder / "none/sweep.mhd";
  SweepAcquisition acquisition(devices, rules, room);
  acquisition.Start();
  room.RunTo(20);
  EXPECT_THROW(acquisition.BeginSweep(), FileError); // it would be lost
  EXPECT_EQ(acquisition.TakeSlices().size(), 20u);
  const std::vector<std::string> messages = acquisition.GetState().Messages;
  ASSERT_EQ(messages.size(), 1u);
  EXPECT_NE(messages[0].find("none/sweep"), std::string::npos) << messages[0];
  acquisition.BeginSweep(true);
  rules.RecordFileName = folder / "sweep.mhd";
  acquisition.SetRules(rules);
  for (int sweep = 1; sweep <= 2; ++sweep)
  {
    acquisition.Start();
    room.RunTo(20 + 30 * sweep);
    acquisition.Stop();
    const std::vector<AcquiredSlice> slices = acquisition.TakeSlices();
    EXPECT_EQ(slices.size(), 30u);
    std::string name;
    for (int i = 0; i < 1000 && name.empty(); ++i) // opened beside all else
    {
      name = acquisition.GetState().File.FileName;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    EXPECT_EQ(name, folder / (sweep == 1 ? "sweep.mhd" : "sweep-2.mhd"));
    acquisition.BeginSweep();
    const ReadBack read(name);
    const lacuna::Sweep poses = ReadSweep(name);
    ASSERT_EQ(read.Frames.size(), 30u);
    for (std::size_t i = 0; i < 30; ++i)
    {
      EXPECT_EQ(read.Frames[i], std::string(slices[i].Pixels->begin(), slices[i].Pixels->end()));
      EXPECT_LT(
        Distance(poses.Transforms.at("ProbeToTracker")[i], slices[i].ProbeToTracker), 1e-12);
    }
  }
}
