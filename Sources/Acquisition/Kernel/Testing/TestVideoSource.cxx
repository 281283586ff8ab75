// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaVideoSource.h"

#include "lacunaExecution.h"
#include "lacunaTestDevice.h"
#include "lacunaTestVideo.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <functional>
#include <iterator>
#include <random>
#include <thread>

#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

using namespace lacuna;
using namespace lacunaTest;

namespace
{
using Image = std::vector<std::uint8_t>;
const SteadyClock TheClock;

class ManualClock : public Clock
{
public:
  double Now() const override { return this->Time; }
  double Time = 0;
};

VideoSettings AtOnce(const std::string& url)
{
  VideoSettings settings;
  settings.URL = url;
  settings.InRealTime = false;
  return settings;
}

std::string Opening(VideoError::Kind kind, const VideoSettings& settings)
{
  return Complaint<VideoError>(kind, [&] { VideoSource source(settings, TheClock); });
}

std::vector<VideoFrame> ReadAll(VideoSource& source)
{
  std::vector<VideoFrame> frames;
  VideoFrame frame;
  while (source.Read(frame) != VideoEvent::End)
  {
    frames.push_back(frame);
  }
  return frames;
}

// Images that differ from frame to frame and on all sides.
std::vector<Image> MakeImages(int count, int columns, int rows)
{
  std::vector<Image> images(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i)
  {
    for (int pixel = 0; pixel < columns * rows; ++pixel)
    {
      const int column = pixel % columns;
      const int row = pixel / columns;
      images[static_cast<std::size_t>(i)].push_back(
        static_cast<std::uint8_t>(20 + 2 * column + row + 7 * i));
    }
  }
  return images;
}

std::vector<int> Times(int count)
{
  std::vector<int> times;
  for (int i = 0; i < count; ++i)
  {
    times.push_back(i);
  }
  return times;
}

// A server of this computer that sends bytes to the first who connects, and then closes the line or
// holds it in silence.
class Server
{
public:
  explicit Server(std::string bytes = {}, bool hold = true)
    : Bytes(std::move(bytes))
    , Hold(hold)
  {
    this->Socket = socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof(address);
    EXPECT_EQ(bind(this->Socket, reinterpret_cast<sockaddr*>(&address), size), 0);
    EXPECT_EQ(listen(this->Socket, 5), 0);
    EXPECT_EQ(getsockname(this->Socket, reinterpret_cast<sockaddr*>(&address), &size), 0);
    this->URL = "tcp://127.0.0.1:" + std::to_string(ntohs(address.sin_port));
    this->Thread = std::thread([this] { this->Serve(); });
  }
  ~Server()
  {
    shutdown(this->Socket, SHUT_RDWR); // ends accept
    this->Thread.join();
    close(this->Line);
    close(this->Socket);
  }
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;
  const std::string& GetURL() const { return this->URL; }

private:
  void Serve()
  {
    this->Line = accept(this->Socket, nullptr, nullptr);
    for (std::size_t sent = 0; sent < this->Bytes.size();)
    {
      const ssize_t count =
        send(this->Line, this->Bytes.data() + sent, this->Bytes.size() - sent, MSG_NOSIGNAL);
      if (count <= 0)
      {
        return;
      }
      sent += static_cast<std::size_t>(count);
    }
    if (!this->Hold)
    {
      shutdown(this->Line, SHUT_RDWR);
    }
  }

  std::string Bytes;
  bool Hold;
  int Socket = -1;
  int Line = -1;
  std::string URL;
  std::thread Thread;
};

std::string ReadFile(const std::string& path)
{
  std::ifstream file(path, std::ios::binary);
  return { std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>() };
}
}

TEST(VideoSource, TestSignalInItsOwnPace)
{
  VideoSettings settings;
  settings.URL =
    "lavfi:color=c=0x4080c0:size=66x48:rate=25:duration=0.24,format=rgb24,setsar=16/15";
  VideoSource source(settings, TheClock);
  EXPECT_EQ(source.GetFrameRate(), 25);
  const double begin = TheClock.Now();
  const std::vector<VideoFrame> frames = ReadAll(source);
  ASSERT_EQ(frames.size(), 6u);
  for (std::size_t i = 0; i < frames.size(); ++i)
  {
    EXPECT_EQ(frames[i].Columns, 66);
    EXPECT_EQ(frames[i].Rows, 48);
    EXPECT_EQ(frames[i].Grey, Image(66 * 48, 116)); // 0.299 64 + 0.587 128 + 0.114 192
    EXPECT_NEAR(frames[i].PixelAspect, 16 / 15.0, 1e-12);
    EXPECT_NEAR(frames[i].StreamTime.value(), 0.04 * static_cast<double>(i), 1e-9);
    EXPECT_GE(frames[i].Arrival, begin + 0.04 * static_cast<double>(i) - 1e-9); // not sooner
    EXPECT_LE(frames[i].Arrival, TheClock.Now());
  }
  EXPECT_EQ(source.GetCounts().Frames, 6u);
  EXPECT_EQ(source.GetCounts().Missing, 0u);
  VideoFrame frame;
  EXPECT_EQ(source.Read(frame), VideoEvent::End); // for good
}

TEST(VideoSource, LosslessFilesComeBackBitForBit)
{
  const Folder folder;
  const std::vector<Image> images = MakeImages(12, 40, 30);
  EncodeVideo(folder / "a.mkv", {}, 40, 30, images, Times(12));
  VideoSource source(AtOnce(folder / "a.mkv"), TheClock);
  const std::vector<VideoFrame> frames = ReadAll(source);
  ASSERT_EQ(frames.size(), images.size());
  for (std::size_t i = 0; i < images.size(); ++i)
  {
    EXPECT_EQ(frames[i].Grey, images[i]) << i;
    EXPECT_FALSE(frames[i].Damaged);
    EXPECT_NEAR(frames[i].StreamTime.value(), 0.04 * static_cast<double>(i), 0.0011);
    EXPECT_EQ(frames[i].PixelAspect, 1);
  }
  // also with the scheme
  VideoSource again(AtOnce("file:" + folder / "a.mkv"), TheClock);
  EXPECT_EQ(ReadAll(again).size(), images.size());
}

TEST(VideoSource, LossyFilesInTheirOrder)
{
  const Folder folder;
  const std::vector<Image> images = MakeImages(20, 64, 48);
  const std::vector<EncoderSettings> all{ { "mp4", "mpeg4", AV_PIX_FMT_YUV420P, 2 },
    { "mpegts", "mpeg2video", AV_PIX_FMT_YUV420P, 2 }, { "avi", "mjpeg", AV_PIX_FMT_YUVJ420P, 0 } };
  for (const EncoderSettings& settings : all)
  {
    const std::string path = folder / (std::string(settings.Codec) + "." + settings.Container);
    EncodeVideo(path, settings, 64, 48, images, Times(20));
    VideoSource source(AtOnce(path), TheClock);
    EXPECT_EQ(source.GetFrameRate(), 25) << settings.Codec;
    const std::vector<VideoFrame> frames = ReadAll(source);
    ASSERT_EQ(frames.size(), images.size()) << settings.Codec;
    const bool limited = settings.Format == AV_PIX_FMT_YUV420P;
    for (std::size_t i = 0; i < images.size(); ++i)
    {
      double sum = 0;
      for (std::size_t pixel = 0; pixel < images[i].size(); ++pixel)
      {
        const double level = limited ? (images[i][pixel] - 16) * 255 / 219.0 : images[i][pixel];
        sum += std::abs(frames[i].Grey[pixel] - std::clamp(level, 0.0, 255.0));
      }
      // frames differ by 7 levels
      EXPECT_LT(sum / static_cast<double>(images[i].size()), 2.5) << settings.Codec << " " << i;
      if (i > 0)
      {
        EXPECT_GT(*frames[i].StreamTime, *frames[i - 1].StreamTime);
        EXPECT_GE(frames[i].Arrival + 1e-9, frames[0].Arrival);
      }
    }
    EXPECT_EQ(source.GetCounts().Missing, 0u);
  }
}

TEST(VideoSource, OneFieldOfInterlacedVideo)
{
  const Folder folder;
  Image image(32 * 16);
  for (std::size_t i = 0; i < image.size(); ++i)
  {
    image[i] = i / 32 % 2 == 0 ? 50 : 200;
  }
  EncodeVideo(folder / "a.mkv", {}, 32, 16, { image }, { 0 });
  VideoSettings settings = AtOnce(folder / "a.mkv");
  VideoFrame frame;
  settings.Field = VideoField::Top;
  EXPECT_EQ(VideoSource(settings, TheClock).Read(frame), VideoEvent::Frame);
  EXPECT_EQ(frame.Grey, Image(image.size(), 50));
  settings.Field = VideoField::Bottom;
  EXPECT_EQ(VideoSource(settings, TheClock).Read(frame), VideoEvent::Frame);
  EXPECT_EQ(frame.Grey, Image(image.size(), 200));
}

TEST(VideoSource, MissingFramesAreCounted)
{
  const Folder folder;
  std::vector<int> times = Times(12);
  times.erase(times.begin() + 8);
  times.erase(times.begin() + 3, times.begin() + 5);
  EncodeVideo(folder / "a.mkv", {}, 16, 16, MakeImages(9, 16, 16), times);
  VideoSource source(AtOnce(folder / "a.mkv"), TheClock);
  EXPECT_EQ(ReadAll(source).size(), 9u);
  EXPECT_EQ(source.GetCounts().Missing, source.GetFrameRate() == 25 ? 3u : 0u);
  EXPECT_EQ(source.GetFrameRate(), 25);
}

TEST(VideoSource, ChangeOfSizeIsSaid)
{
  const Folder folder;
  const EncoderSettings jpeg{ "mjpeg", "mjpeg", AV_PIX_FMT_YUVJ420P, 0 };
  EncodeVideo(folder / "a.mjpeg", jpeg, 64, 48, MakeImages(5, 64, 48), Times(5));
  EncodeVideo(folder / "b.mjpeg", jpeg, 80, 32, MakeImages(5, 80, 32), Times(5));
  std::ofstream joined(folder / "c.mjpeg", std::ios::binary);
  for (const char* part : { "a.mjpeg", "b.mjpeg" })
  {
    joined << std::ifstream(folder / part, std::ios::binary).rdbuf();
  }
  joined.close();
  VideoSource source(AtOnce(folder / "c.mjpeg"), TheClock);
  VideoFrame frame;
  int frames = 0;
  int changes = 0;
  for (VideoEvent event = source.Read(frame); event != VideoEvent::End; event = source.Read(frame))
  {
    ++frames;
    if (event == VideoEvent::NewSize)
    {
      ++changes;
      EXPECT_EQ(frames, 6);
    }
    EXPECT_EQ(frame.Columns, frames < 6 ? 64 : 80);
    EXPECT_EQ(frame.Grey.size(), frames < 6 ? 64u * 48 : 80u * 32);
  }
  EXPECT_EQ(frames, 10);
  EXPECT_EQ(changes, 1);
}

TEST(VideoSource, StopsWhileItWaits)
{
  VideoSettings settings;
  settings.URL = "lavfi:testsrc=size=32x32:rate=1/1000"; // the second frame after a quarter hour
  settings.FrameTime = 5000;
  std::optional<double> end;
  const auto stopped = [&] { return end && TheClock.Now() > *end; };
  VideoSource source(settings, TheClock, stopped);
  VideoFrame frame;
  EXPECT_EQ(source.Read(frame), VideoEvent::Frame);
  end = TheClock.Now() + 0.1;
  EXPECT_THROW(source.Read(frame), Aborted);
  EXPECT_LT(TheClock.Now(), *end + 10);

  const Server server;
  end = TheClock.Now() + 0.1;
  settings = AtOnce(server.GetURL());
  settings.OpenTime = 1000;
  EXPECT_THROW(VideoSource(settings, TheClock, stopped), Aborted);
  EXPECT_LT(TheClock.Now(), *end + 10);
}

// A computer that stands still for 90 ms at the 60th of 80 frames of a file: seconds by which the
// frames' arrivals are later than they would have been.
std::vector<double> ReadWhileTheComputerStandsStill(const std::string& path)
{
  ManualClock clock;
  VideoSource source(AtOnce(path), clock);
  std::vector<double> late;
  VideoFrame frame;
  for (int i = 0; i < 80; ++i)
  {
    const double punctual = 10 + 0.04 * i;
    clock.Time = std::max(punctual, i < 60 ? 0 : 10 + 0.04 * 60 + 0.09);
    EXPECT_EQ(source.Read(frame), VideoEvent::Frame);
    late.push_back(frame.Arrival - punctual);
  }
  return late;
}

TEST(VideoSource, FramesThatTheComputerHeldUpAreGivenTheirTimesByStreamsThatHaveTimes)
{
  const Folder folder;
  const std::vector<Image> images = MakeImages(80, 40, 30);
  EncodeVideo(folder / "a.mkv", {}, 40, 30, images, Times(80));
  for (const double late : ReadWhileTheComputerStandsStill(folder / "a.mkv"))
  {
    EXPECT_NEAR(late, 0, 1e-9);
  }
  const EncoderSettings jpeg{ "mjpeg", "mjpeg", AV_PIX_FMT_YUVJ420P, 0 }; // has no times
  EncodeVideo(folder / "a.mjpeg", jpeg, 40, 30, images, Times(80));
  const std::vector<double> late = ReadWhileTheComputerStandsStill(folder / "a.mjpeg");
  EXPECT_NEAR(late[60], 0.09, 1e-9);
  EXPECT_NEAR(late[61], 0.05, 1e-9);
  EXPECT_NEAR(late[63], 0, 1e-9);
}

// Packets that come every 40 ms; a frame that others are made from comes before those.
TEST(VideoSource, FramesOfWhichOthersAreMadeAreNotTakenForEarlierOnes)
{
  const Folder folder;
  for (const int between : { 0, 1, 2, 3 })
  {
    for (const char* container : { "matroska", "mpegts" })
    {
      const EncoderSettings settings{ container, "mpeg2video", AV_PIX_FMT_YUV420P, between };
      EncodeVideo(folder / "b", settings, 64, 48, MakeImages(80, 64, 48), Times(80));
      ManualClock clock;
      VideoSource source(AtOnce(folder / "b"), clock);
      VideoFrame frame;
      double late = 0;
      for (int i = 0; i < 75; ++i)
      {
        clock.Time = 10 + 0.04 * i;
        ASSERT_EQ(source.Read(frame), VideoEvent::Frame);
        late = i == 4 ? frame.Arrival - clock.Time : late;
        if (i > 4)
        {
          EXPECT_NEAR(frame.Arrival - clock.Time, late, 1e-9) << between << container << i;
        }
      }
    }
  }
}

// Its frames had the arrivals of those that bore their times before.
TEST(VideoSource, FramesOfASenderThatBeginsAnewHaveTheirOwnArrivals)
{
  const SteadyClock clock;
  VideoSource video(
    AtOnce("lavfi:testsrc2=size=64x48:rate=25:duration=4,setpts=mod(N\\,20)"), clock);
  VideoFrame frame;
  double before = 0;
  int frames = 0;
  while (video.Read(frame) != VideoEvent::End)
  {
    EXPECT_GE(frame.Arrival, before) << frames;
    before = frame.Arrival;
    ++frames;
  }
  EXPECT_EQ(frames, 100);
}

TEST(VideoSource, StreamsThatSendNothingTimeOut)
{
  const Server server;
  VideoSettings settings = AtOnce(server.GetURL());
  settings.OpenTime = 0.2;
  EXPECT_HAS(Opening(VideoError::Kind::Silent, settings), "sends nothing: is the scanner");
}

TEST(VideoSource, NetworkStreams)
{
  const Folder folder;
  const std::vector<Image> images = MakeImages(30, 40, 30);
  EncodeVideo(folder / "a.mkv", {}, 40, 30, images, Times(30));
  const std::string bytes = ReadFile(folder / "a.mkv");
  VideoSettings settings;
  settings.FrameTime = 2;
  for (const bool hold : { false, true })
  {
    const Server server(bytes, hold);
    settings.URL = server.GetURL();
    VideoSource source(settings, TheClock);
    VideoFrame frame;
    double last = 0;
    // the file's index is its end; while the line is held, the last frame may be waited with
    for (std::size_t i = 0; i + 1 < images.size(); ++i)
    {
      ASSERT_EQ(source.Read(frame), VideoEvent::Frame) << i;
      EXPECT_EQ(frame.Grey, images[i]) << i;
      EXPECT_GE(frame.Arrival, last);
      last = frame.Arrival;
    }
    if (hold)
    {
      EXPECT_HAS(Complaint<VideoError>(VideoError::Kind::Silent,
                   [&]
                   {
                     source.Read(frame);
                     source.Read(frame);
                   }),
        "sends nothing any more");
    }
    else
    {
      EXPECT_EQ(source.Read(frame), VideoEvent::Frame);
      EXPECT_EQ(source.Read(frame), VideoEvent::End);
    }
  }
}

TEST(VideoSource, SaysWhyItCannotBeOpened)
{
  const Folder folder;
  EXPECT_HAS(Opening(VideoError::Kind::NotFound, AtOnce("/dev/video97")), "frame grabber");
  EXPECT_HAS(Opening(VideoError::Kind::NotFound, AtOnce(folder / "none.avi")), "is not there");
  EXPECT_HAS(Opening(VideoError::Kind::NotFound, AtOnce("tcp://127.0.0.1:1")), "does not answer");
  EXPECT_HAS(Opening(VideoError::Kind::Unsupported, AtOnce("/dev/null")), "Video4Linux2");
  EXPECT_HAS(Opening(VideoError::Kind::Unsupported, AtOnce("lavfi:nosuchfilter")), "FFmpeg");
  EXPECT_HAS(
    Opening(VideoError::Kind::Unsupported, AtOnce("lavfi:sine=duration=1")), "has no pictures");
  EXPECT_HAS(Opening(VideoError::Kind::Unsupported, AtOnce("nosuch://a/b")), "nosuch://a/b");
  std::ofstream(folder / "text.avi") << "no video at all";
  Opening(VideoError::Kind::Unsupported, AtOnce(folder / "text.avi"));
  std::ofstream(folder / "empty.avi").close();
  Opening(VideoError::Kind::Unsupported, AtOnce(folder / "empty.avi"));
  Opening(VideoError::Kind::Unsupported, AtOnce(folder.GetPath()));
  ASSERT_EQ(mkfifo((folder / "fifo").c_str(), 0600), 0); // opening it would wait for ever
  for (const std::string& url : { folder / "fifo", std::string(), std::string("-"),
         std::string("pipe:0"), "file:" + folder / "fifo" })
  {
    EXPECT_HAS(Opening(VideoError::Kind::Unsupported, AtOnce(url)), "lavfi:testsrc2");
  }
}

TEST(VideoSource, SaysWhoMayOpenIt)
{
  const Folder folder;
  EncodeVideo(folder / "a.mkv", {}, 16, 16, MakeImages(1, 16, 16), { 0 });
  ASSERT_EQ(chmod((folder / "a.mkv").c_str(), 0), 0);
  const AsUser user;
  EXPECT_HAS(Opening(VideoError::Kind::Permission, AtOnce(folder / "a.mkv")), "permissions");
}

TEST(VideoSource, OptionsGoToFFmpegAndAreChecked)
{
  VideoSettings settings = AtOnce("lavfi:testsrc=size=32x32:duration=0.08");
  settings.Options = "colour=red";
  EXPECT_HAS(Opening(VideoError::Kind::Options, settings), "options colour");
  settings.Options = "colour";
  EXPECT_HAS(Opening(VideoError::Kind::Options, settings), "name=value");
  settings = AtOnce("lavfi:");
  settings.Options = "graph=testsrc=size=32x32\\:duration=0.08";
  VideoSource source(settings, TheClock);
  EXPECT_EQ(ReadAll(source).size(), 2u);
}

TEST(VideoSource, DamagedFilesEndSoonerOrAreSaidToBeDamaged)
{
  const Folder folder;
  const std::vector<std::pair<std::string, EncoderSettings>> files{ { "a.mkv", {} },
    { "b.ts", { "mpegts", "mpeg2video", AV_PIX_FMT_YUV420P, 2 } },
    { "c.avi", { "avi", "mjpeg", AV_PIX_FMT_YUVJ420P, 0 } } };
  std::mt19937 random(7);
  for (const auto& [name, settings] : files)
  {
    EncodeVideo(folder / name, settings, 64, 48, MakeImages(10, 64, 48), Times(10));
    const std::string whole = ReadFile(folder / name);
    int read = 0;
    for (int i = 0; i < 60; ++i)
    {
      std::string bytes = whole;
      if (i % 2 == 0)
      {
        bytes.resize(random() % whole.size());
      }
      else
      {
        for (int change = 0; change < 1 + i; ++change)
        {
          bytes[random() % bytes.size()] = static_cast<char>(random());
        }
      }
      std::ofstream(folder / "damaged", std::ios::binary) << bytes;
      try
      {
        VideoSource source(AtOnce(folder / "damaged"), TheClock);
        for (const VideoFrame& frame : ReadAll(source))
        {
          ++read;
          EXPECT_EQ(frame.Grey.size(), static_cast<std::size_t>(frame.Columns) * frame.Rows);
        }
      }
      catch (const VideoError& e)
      {
        EXPECT_NE(std::string(e.what()), "");
      }
    }
    EXPECT_GT(read, 100) << name;
  }
}
