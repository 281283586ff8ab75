// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A tracker and a video in simulated time, which an acquisition's own threads drive.
#ifndef lacunaTestRoom_h
#define lacunaTestRoom_h

#include "lacunaDeviceChoice.h"
#include "lacunaEmulatedChannel.h"
#include "lacunaExecution.h"
#include "lacunaSweepAcquisition.h"
#include "lacunaTestPairing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace lacunaTest
{
/// Time goes on while the tracker is polled, and stands still until the video's thread has done what
/// there is to do: half an hour passes in a second, and always in the same way.
class Room : public lacuna::Clock
{
public:
  using Stopped = std::function<bool()>;
  /// Makes the frame of a number; what it throws the video throws.
  using FrameScript = std::function<lacuna::VideoEvent(int number, lacuna::VideoFrame& frame)>;
  /// Adds what the tracker measures at a time; what it throws the tracker throws.
  using PoseScript = std::function<void(double time, std::vector<lacuna::TrackedPose>& poses)>;

  double Now() const override
  {
    const std::lock_guard<std::mutex> lock(this->Mutex);
    return this->Time;
  }

  /// The video: one frame each 0.04 s from 1 s on, 4 x 3 pixels that tell its number.
  static lacuna::VideoEvent NumberedFrame(int number, lacuna::VideoFrame& frame)
  {
    frame.Columns = 4;
    frame.Rows = 3;
    frame.Grey.clear();
    for (int i = 0; i < 12; ++i)
    {
      frame.Grey.push_back(static_cast<std::uint8_t>(i < 3 ? number >> (8 * i) : 10 * i));
    }
    return lacuna::VideoEvent::Frame;
  }
  static int ReadNumber(const std::vector<std::uint8_t>& pixels)
  {
    return pixels[0] + 256 * pixels[1] + 65536 * pixels[2];
  }
  static double FrameTime(int number) { return 1 + 0.04 * number; }

  lacuna::FrameDeviceFactory MakeVideo(FrameScript script = NumberedFrame)
  {
    return [this, script](const Stopped& stopped)
    { return std::make_unique<Video>(*this, script, stopped); };
  }
  /// A tracker that measures 50 times a second, and what it warns of.
  lacuna::PoseDeviceFactory MakeTracker(
    PoseScript script = FollowSweep, const std::string& warning = {})
  {
    return [this, script, warning](const Stopped& stopped)
    { return std::make_unique<Tracker>(*this, script, warning, stopped); };
  }
  /// One that cannot be opened.
  lacuna::PoseDeviceFactory MakeBrokenTracker(const std::string& reason)
  {
    return [this, reason](const Stopped& stopped) -> std::unique_ptr<lacuna::PoseDevice>
    {
      this->AdvanceTo(this->Now() + 0.1, stopped);
      throw std::runtime_error(reason);
    };
  }
  static void FollowSweep(double time, std::vector<lacuna::TrackedPose>& poses)
  {
    poses.push_back(MakePose(time));
  }
  static lacuna::TrackedPose MakePose(double time)
  {
    lacuna::TrackedPose pose;
    pose.Time = time;
    pose.ReceiverToTransmitter = Sweep(time, 1);
    return pose;
  }
  /// The emulated FASTRAK, whose line takes its time.
  lacuna::PoseDeviceFactory MakeFastrak(
    lacuna::FastrakEmulator& emulator, const lacuna::FastrakSettings& settings)
  {
    return [this, &emulator, settings](const Stopped& stopped)
    {
      auto channel = std::make_unique<Line>(*this, emulator, stopped);
      const lacuna::Clock& time = channel->Channel;
      return std::make_unique<lacuna::FastrakDevice>(std::move(channel), time, settings, stopped);
    };
  }

  /// Lets so many frames come since the beginning, no more, and waits until what they cause is done
  /// and the tracker has measured what it can before the next one.
  void RunTo(int frames)
  {
    std::unique_lock<std::mutex> lock(this->Mutex);
    this->LastFrame = frames;
    this->Held = false;
    this->Changed.notify_all();
    // a test that hangs fails
    EXPECT_TRUE(this->Changed.wait_for(lock, std::chrono::minutes(5),
      [&] { return this->NextFrame >= frames && this->Asking && this->Held; }));
  }
  /// Lets time go on without an end.
  void Run()
  {
    const std::lock_guard<std::mutex> lock(this->Mutex);
    this->LastFrame = std::numeric_limits<int>::max();
    this->Changed.notify_all();
  }

private:
  struct Video : public lacuna::FrameDevice
  {
    Video(Room& room, FrameScript script, Stopped stopped)
      : Place(room)
      , Script(std::move(script))
      , IsStopped(std::move(stopped))
    {
    }
    lacuna::VideoEvent Read(lacuna::VideoFrame& frame) override
    {
      const int number = this->Place.WaitForFrame(this->IsStopped);
      frame.Arrival = FrameTime(number);
      ++this->Count.Frames;
      return this->Script(number, frame);
    }
    double GetLatency() const override { return 0; }
    lacuna::VideoSource::Counts GetCounts() const override { return this->Count; }
    Room& Place;
    FrameScript Script;
    Stopped IsStopped;
    lacuna::VideoSource::Counts Count;
  };
  struct Tracker : public lacuna::PoseDevice
  {
    Tracker(Room& room, PoseScript script, std::string warning, Stopped stopped)
      : Place(room)
      , Script(std::move(script))
      , Warning(std::move(warning))
      , IsStopped(std::move(stopped))
    {
    }
    void SetUp() override {}
    bool Poll(std::vector<lacuna::TrackedPose>& poses) override
    {
      this->Place.AdvanceTo(this->Place.Now() + 0.02, this->IsStopped);
      this->Script(this->Place.Now(), poses);
      this->Count.Poses += poses.size();
      return !poses.empty();
    }
    lacuna::PoseCounts GetCounts() const override { return this->Count; }
    std::string GetWarning() const override { return this->Warning; }
    Room& Place;
    PoseScript Script;
    std::string Warning;
    Stopped IsStopped;
    lacuna::PoseCounts Count;
  };
  struct Line : public lacuna::ByteChannel
  {
    Line(Room& room, lacuna::FastrakEmulator& emulator, Stopped stopped)
      : Channel(emulator, emulator.GetBaud(), room.Now())
      , Place(room)
      , IsStopped(std::move(stopped))
    {
    }
    std::size_t Read(char* bytes, std::size_t size, double seconds) override
    {
      const std::size_t count = this->Channel.Read(bytes, size, seconds);
      this->Place.AdvanceTo(this->Channel.Now(), this->IsStopped);
      return count;
    }
    void Write(std::string_view bytes) override { this->Channel.Write(bytes); }
    std::string GetName() const override { return this->Channel.GetName(); }
    int GetBaud() const override { return this->Channel.GetBaud(); }
    lacuna::EmulatedChannel Channel;
    Room& Place;
    Stopped IsStopped;
  };

  void AdvanceTo(double time, const Stopped& stopped)
  {
    std::unique_lock<std::mutex> lock(this->Mutex);
    while (this->WaitForVideo(lock, stopped) && FrameTime(this->NextFrame) <= time)
    {
      if (this->NextFrame >= this->LastFrame)
      {
        if (stopped())
        {
          return;
        }
        if (!std::exchange(this->Held, true))
        {
          this->Changed.notify_all();
        }
        this->Changed.wait_for(lock, std::chrono::milliseconds(20));
        continue;
      }
      this->Time = FrameTime(this->NextFrame);
      this->Asking = false;
      this->Changed.notify_all();
    }
    this->Time = std::max(this->Time, time);
  }
  bool WaitForVideo(std::unique_lock<std::mutex>& lock, const Stopped& stopped)
  {
    while (!this->Asking && !stopped())
    {
      this->Changed.wait_for(lock, std::chrono::milliseconds(20));
    }
    return this->Asking;
  }
  int WaitForFrame(const Stopped& stopped)
  {
    std::unique_lock<std::mutex> lock(this->Mutex);
    this->Asking = true;
    this->Changed.notify_all();
    while (this->Time < FrameTime(this->NextFrame))
    {
      if (stopped())
      {
        throw lacuna::Aborted();
      }
      this->Changed.wait_for(lock, std::chrono::milliseconds(20));
    }
    this->Asking = false;
    return this->NextFrame++;
  }

  mutable std::mutex Mutex;
  std::condition_variable Changed;
  double Time = 0;
  int NextFrame = 0;
  int LastFrame = 0;   ///< the frame from which on time stands still
  bool Asking = false; ///< the video waits for its next frame
  bool Held = false;   ///< the tracker waits until more frames may come
};
}
#endif
