// SPDX-License-Identifier: BSD-3-Clause
// A tracker and a scanner behind a server of OpenIGTLink's own library, in this process: pose and
// picture arrive as they were sent, in one slice, and nothing is mirrored on the way.
#include "lacunaCheck.h"
#include "lacunaClock.h"
#include "lacunaFieldData.h"
#include "lacunaTestOpenIGTLink.h"
#include "lacunaTrackedSlices.h"
#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkLacunaPolhemusVideoSource.h"

#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <thread>

#include <unistd.h>

using namespace lacunaTest;

namespace
{
constexpr int Columns = 24;
constexpr int Rows = 16;
constexpr double SenderAhead = 1.7e9; // s of the server's clock before ours

// The first pixel of a picture says when it was taken, hundredths of a second; the others differ.
std::vector<char> MakePicture(int hundredths)
{
  std::vector<char> pixels(Columns * Rows);
  for (int i = 0; i < Columns * Rows; ++i)
  {
    pixels[static_cast<std::size_t>(i)] = static_cast<char>(7 * (i % Columns) + 5 * (i / Columns));
  }
  pixels[0] = static_cast<char>(hundredths);
  return pixels;
}

// Sends what a probe measures that moves as AsymmetricPose, later than it was taken, and hangs up
// and comes back once.
class Room
{
public:
  Room()
    : Sender([this] { this->Run(); })
  {
  }
  ~Room()
  {
    this->Ended = true;
    this->Sender.join();
  }
  std::string GetAddress() { return this->Place.GetAddress(); }
  void HangUp() { this->Hang = true; }
  int GetConnections() const { return this->Connections; }

private:
  void Run()
  {
    const lacuna::SteadyClock clock;
    const double begin = clock.Now();
    while (!this->Ended)
    {
      if (!this->Place.Accept(50))
      {
        continue;
      }
      ++this->Connections;
      while (!this->Ended && !this->Hang)
      {
        const int hundredths = 2 * static_cast<int>(50 * (clock.Now() - begin));
        const double time = 0.01 * hundredths;
        const double stamp = begin + time + SenderAhead;
        this->Place.Send(TransformBytes(AsymmetricPose(time), "ProbeToTracker", stamp));
        this->Place.Send(TransformBytes(AsymmetricPose(-time), "StylusToTracker", stamp));
        // once it was away, the scanner is at another depth than that of the calibration
        const std::array<float, 2> spacing = this->Connections == 1
          ? std::array<float, 2>{ 0.25F, 0.5F }
          : std::array<float, 2>{ 0.2F, 0.3F };
        this->Place.Send(ImageBytes(Columns, Rows, MakePicture(hundredths % 256), "Image", stamp,
          igtl::ImageMessage::TYPE_UINT8, 1, igtl::ImageMessage::ENDIAN_LITTLE, spacing));
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
      }
      this->Place.Hangup();
      this->Hang = false;
    }
  }

  Server Place;
  std::atomic<bool> Ended{ false };
  std::atomic<bool> Hang{ false };
  std::atomic<int> Connections{ 0 };
  std::thread Sender;
};

bool PollUntil(vtkLacunaPolhemusVideoSource* source, const std::function<bool()>& condition)
{
  for (int i = 0; i < 6000 && !condition(); ++i)
  {
    source->Poll();
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return condition();
}
}

int TestPolhemusVideoSourceOpenIGTLink(int, char*[])
{
  const lacuna::Matrix4 imageToProbe = lacuna::Matrix4::Translation({ 3, 5, 7 }) *
    lacuna::Matrix4::Rotation({ 0.1, 0.7, -0.2 }, 0.5) *
    lacuna::Matrix4::Scaling({ 0.25, 0.5, 0.35 });
  const std::string calibration = (std::filesystem::temp_directory_path() /
    ("lacuna-openigtlink-" + std::to_string(getpid()) + ".xml"))
                                    .string();
  {
    std::ofstream file(calibration);
    file.precision(17);
    file << "<PlusConfiguration><CoordinateDefinitions><Transform From=\"Image\" To=\"Probe\" "
            "Matrix=\"";
    for (int i = 0; i < 16; ++i)
    {
      file << imageToProbe.Data()[i] << " ";
    }
    file << "\"/></CoordinateDefinitions></PlusConfiguration>";
  }
  Room room;
  vtkNew<vtkLacunaPolhemusVideoSource> source;
  const auto messages = lacunaCheck::Watch(source);
  source->SetTrackerConnection((room.GetAddress() + "?transform=ProbeToTracker").c_str());
  source->SetVideoURL(room.GetAddress().c_str());
  source->SetStation(2); // means nothing here
  source->SetCalibrationFileName(calibration.c_str());
  source->SetCaptureMode(vtkLacunaPolhemusVideoSource::EveryFrame);
  source->SetSpeedLimit(0);
  source->Start();
  // the first ones come before the clock has settled, and have no pose
  LACUNA_CHECK(PollUntil(source, [&] { return source->GetSliceCount() >= 60; }));
  LACUNA_CHECK(room.GetConnections() == 1);
  room.HangUp();
  LACUNA_CHECK(PollUntil(source, [&] { return room.GetConnections() == 2; }));
  const vtkIdType before = source->GetSliceCount();
  LACUNA_CHECK(PollUntil(source, [&] { return source->GetSliceCount() >= before + 20; }));
  source->Stop();
  source->Update();
  std::remove(calibration.c_str());

  vtkImageData* output = source->GetOutput(0);
  const int count = output->GetDimensions()[2];
  LACUNA_CHECK(output->GetDimensions()[0] == Columns && output->GetDimensions()[1] == Rows);
  const lacuna::TrackedSlices slices(output);
  vtkDataArray* probe = lacuna::FieldData::Get(output, "ProbeToTracker", 16, count);
  vtkDataArray* said = lacuna::FieldData::Get(output, "ElementSpacing", 2, count);
  int right = 0;
  int usable = 0;
  int flagged = 0;
  for (int i = 0; i < count; ++i)
  {
    const bool contradicts = std::abs(said->GetComponent(i, 0) - 0.25) > 1e-6;
    LACUNA_CHECK(std::abs(said->GetComponent(i, 1) - (contradicts ? 0.3 : 0.5)) < 1e-6);
    flagged += contradicts ? 1 : 0;
    if (contradicts)
    {
      LACUNA_CHECK((slices.GetStatus(i) & lacuna::TrackedSlices::PoseInvalid) != 0);
      LACUNA_CHECK(!slices.GetImageToReference(i).IsFinite());
      continue;
    }
    // x = 120 + 30 time, of AsymmetricPose, tells the time
    const lacuna::Matrix4 pose = lacuna::FieldData::GetMatrix(probe, i);
    const auto* pixels = static_cast<const unsigned char*>(output->GetScalarPointer(0, 0, i));
    if (!slices.IsUsable(i))
    {
      continue;
    }
    ++usable;
    const double time = (pose.Column(3)[0] - 120) / 30;
    LACUNA_CHECK(LargestDifference(pose, AsymmetricPose(time)) < 5e-3);
    // the picture is of that time: of the same stamp, to which the estimate of the clock adds less
    // than the hundredth once it is at rest
    const double late = std::remainder(100 * time - pixels[0], 256);
    right += std::abs(late) < 1 ? 1 : 0;
    LACUNA_CHECK(pixels[1] == 7 && pixels[Columns] == 5 && pixels[Columns + 2] == 19);
    LACUNA_CHECK(LargestDifference(slices.GetImageToReference(i), pose * imageToProbe) < 1e-9);
  }
  std::cout << right << " of " << usable << " slices, " << flagged << " flagged\n";
  LACUNA_CHECK(usable >= 20 && right > 0.7 * usable);
  LACUNA_CHECK(flagged >= 10); // of some 20, less what was under way from the first connection
  LACUNA_CHECK(messages->HasWarning("its pixels are 0.2 x 0.3 mm, the calibration that they are "
                                    "0.25 x 0.5 mm: such slices are flagged"));
  LACUNA_CHECK(messages->Errors.empty());
  return lacunaCheck::Result();
}
