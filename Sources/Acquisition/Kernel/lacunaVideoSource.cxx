// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaVideoSource.h"

#include "lacunaExecution.h"
#include "lacunaFrameClock.h"
#include "lacunaVideoGrey.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <deque>
#include <string_view>
#include <thread>
#include <utility>

#include <dlfcn.h>
#include <sys/stat.h>

extern "C"
{
#include <libavcodec/avcodec.h>
#include <libavdevice/version.h>
#include <libavformat/avformat.h>
#include <libavutil/dict.h>
}

namespace lacuna
{
namespace
{
constexpr double LongestSleep = 0.05;      // s
constexpr double DeviceInterval = 0.001;   // s between looks at a device
constexpr std::size_t DeepestDecoder = 64; // packets between one and its frame

bool BeginsWith(const std::string& text, std::string_view begin)
{
  return text.compare(0, begin.size(), begin) == 0;
}

// Makes FFmpeg know devices and test signals. Their library brings some eighty others, of sound and
// windows, which would be a third of what loading Lacuna takes. Returns why not; empty: it does.
const std::string& RegisterDevices()
{
  static const std::string trouble = []() -> std::string
  {
    const std::string name = "libavdevice.so." + std::to_string(LIBAVDEVICE_VERSION_MAJOR);
    void* library = dlopen(name.c_str(), RTLD_LAZY); // for good: FFmpeg keeps what it registers
    void* enter = library ? dlsym(library, "avdevice_register_all") : nullptr;
    if (!enter)
    {
      return "; " + std::string(dlerror());
    }
    reinterpret_cast<void (*)()>(enter)();
    return "";
  }();
  return trouble;
}

// What an address means to FFmpeg.
struct Address
{
  std::string Name;
  const char* Demuxer = nullptr; // null: FFmpeg finds out
  bool Device = false;
  bool Local = false; // a file, or made up here: it comes as fast as it is read
};

Address FindAddress(const std::string& url)
{
  const std::string lavfi = "lavfi:";
  if (BeginsWith(url, lavfi))
  {
    return { url.substr(lavfi.size()), "lavfi", false, true };
  }
  if (BeginsWith(url, "/dev/"))
  {
    return { url, "video4linux2", true, false };
  }
  const std::string path = BeginsWith(url, "file:") ? url.substr(5) : url;
  struct stat information = {};
  const bool exists = stat(path.c_str(), &information) == 0;
  if (url.empty() || url == "-" || BeginsWith(url, "pipe:") ||
    (exists && !S_ISREG(information.st_mode) && !S_ISDIR(information.st_mode)))
  {
    throw VideoError(VideoError::Kind::Unsupported,
      "'" + url +
        "' is no video: give a file, the address of a stream (rtsp://...), a device "
        "(/dev/video0) or a test signal (lavfi:testsrc2)");
  }
  return { url, nullptr, false, exists || url.find("://") == std::string::npos };
}

std::string ErrorText(int error)
{
  std::array<char, AV_ERROR_MAX_STRING_SIZE> text{};
  av_strerror(error, text.data(), text.size());
  return text.data();
}

[[noreturn]] void ThrowOpening(const std::string& url, const Address& address, int error)
{
  const std::string what = "The video '" + url + "' ";
  if (error == AVERROR(EACCES) || error == AVERROR(EPERM))
  {
    throw VideoError(VideoError::Kind::Permission,
      what + "may not be opened by you" +
        (address.Device
            ? ": on Debian, as root run 'adduser USER video' with your name for USER, and log in "
              "again"
            : ": change its permissions"));
  }
  if (error == AVERROR(EBUSY))
  {
    throw VideoError(
      VideoError::Kind::Busy, what + "is in use: end the other program that has it open");
  }
  if (error == AVERROR(ENOENT) || error == AVERROR(ENODEV) || error == AVERROR(ENXIO))
  {
    throw VideoError(VideoError::Kind::NotFound,
      what + "is not there" +
        (address.Device ? ": is the frame grabber plugged in? Its devices are /dev/video0, "
                          "/dev/video1, ..."
                        : ""));
  }
  if (error == AVERROR(ECONNREFUSED) || error == AVERROR(EHOSTUNREACH) ||
    error == AVERROR(ENETUNREACH) || error == AVERROR_HTTP_NOT_FOUND)
  {
    throw VideoError(VideoError::Kind::NotFound,
      what + "does not answer (" + ErrorText(error) +
        "): is the address right, and does the sender run?");
  }
  throw VideoError(VideoError::Kind::Unsupported,
    what + "cannot be opened by FFmpeg (" + ErrorText(error) + ")" +
      (address.Device ? ": is it a video device (Video4Linux2) with these options?" : ""));
}
}

struct VideoSource::Stream
{
  Stream(const VideoSettings& settings, const Clock& clock, std::function<bool()> stopped)
    : Settings(settings)
    , Time(clock)
    , Stopped(std::move(stopped))
  {
  }
  ~Stream()
  {
    av_packet_free(&this->Packet);
    av_frame_free(&this->Picture);
    avcodec_free_context(&this->Decoder);
    avformat_close_input(&this->Format);
  }

  static int Interrupt(void* stream) { return static_cast<Stream*>(stream)->MustLeave() ? 1 : 0; }
  bool MustLeave() const { return this->IsStopped() || this->Time.Now() > this->Deadline; }
  bool IsStopped() const { return this->Stopped && this->Stopped(); }
  // Throws when a call was cut short.
  void CheckLeft() const
  {
    if (this->IsStopped())
    {
      throw Aborted();
    }
    if (this->Time.Now() > this->Deadline)
    {
      throw VideoError(VideoError::Kind::Silent,
        "The video '" + this->Settings.URL + "' sends nothing" +
          (this->Decoder ? " any more" : "") +
          ": is the scanner switched on and its cable plugged in?");
    }
  }
  void Sleep(double seconds) const
  {
    std::this_thread::sleep_for(
      std::chrono::duration<double>(std::clamp(seconds, 0.0, LongestSleep)));
  }

  void Open();
  void OpenInput(const Address& address);
  void OpenDecoder();
  bool ReadPacket(Counts& count);
  void Fill(VideoFrame& frame, Counts& count);
  void HeedOrder();
  double FindArrival() const;
  void WaitForTurn(double streamTime);

  VideoSettings Settings;
  const Clock& Time;
  std::function<bool()> Stopped;
  double Deadline = 0;
  AVFormatContext* Format = nullptr;
  AVCodecContext* Decoder = nullptr;
  AVPacket* Packet = nullptr;
  AVFrame* Picture = nullptr;
  int Index = -1;
  double Rate = 0;
  bool Paced = false;
  bool Local = false; ///< it goes by our own clock, or none
  bool Ended = false;
  VideoGrey Grey;
  std::deque<std::pair<std::int64_t, double>> Arrivals; ///< packets' times and when they came
  bool Reordered = false;                               ///< packets, which are not as frames are
  std::optional<double> FirstTurn;                      ///< clock's time of stream time 0
  std::optional<double> LastTime;
  FrameClock FrameTimes;
  int Columns = 0;
  int Rows = 0;
};

void VideoSource::Stream::Open()
{
  const Address address = FindAddress(this->Settings.URL);
  this->Deadline = this->Time.Now() + this->Settings.OpenTime;
  this->Packet = av_packet_alloc();
  this->Picture = av_frame_alloc();
  this->Format = avformat_alloc_context();
  if (!this->Packet || !this->Picture || !this->Format)
  {
    throw std::bad_alloc();
  }
  this->Format->interrupt_callback = { Interrupt, this };
  this->Format->flags |= AVFMT_FLAG_NONBLOCK; // of devices, which no interrupt reaches
  this->Local = address.Local;
  this->Paced = address.Local && this->Settings.InRealTime;
  this->OpenInput(address);
  if (!address.Device) // a device says all itself
  {
    const int result = avformat_find_stream_info(this->Format, nullptr);
    this->CheckLeft();
    if (result < 0)
    {
      ThrowOpening(this->Settings.URL, address, result);
    }
  }
  this->OpenDecoder();
}

void VideoSource::Stream::OpenInput(const Address& address)
{
  const AVInputFormat* demuxer = nullptr;
  if (address.Demuxer)
  {
    const std::string& trouble = RegisterDevices();
    demuxer = av_find_input_format(address.Demuxer);
    if (!demuxer)
    {
      throw VideoError(VideoError::Kind::Unsupported,
        std::string("The FFmpeg of this computer has no input ") + address.Demuxer + trouble);
    }
  }
  AVDictionary* options = nullptr;
  int result = av_dict_parse_string(&options, this->Settings.Options.c_str(), "=", ":", 0);
  if (result < 0)
  {
    av_dict_free(&options);
    throw VideoError(VideoError::Kind::Options,
      "The video options '" + this->Settings.Options +
        "' are not of the form name=value:name=value");
  }
  result = avformat_open_input(&this->Format, address.Name.c_str(), demuxer, &options);
  std::string unknown;
  for (const AVDictionaryEntry* entry = nullptr;
       (entry = av_dict_get(options, "", entry, AV_DICT_IGNORE_SUFFIX));)
  {
    unknown += (unknown.empty() ? "" : ", ") + std::string(entry->key);
  }
  av_dict_free(&options);
  if (result < 0)
  {
    this->CheckLeft();
    ThrowOpening(this->Settings.URL, address, result);
  }
  if (!unknown.empty())
  {
    throw VideoError(VideoError::Kind::Options,
      "The video '" + this->Settings.URL + "' does not know the options " + unknown);
  }
}

void VideoSource::Stream::OpenDecoder()
{
  const std::string what = "The video '" + this->Settings.URL + "' ";
  const AVCodec* codec = nullptr;
  this->Index = av_find_best_stream(this->Format, AVMEDIA_TYPE_VIDEO, -1, -1, &codec, 0);
  if (this->Index < 0)
  {
    throw VideoError(VideoError::Kind::Unsupported,
      what +
        (this->Index == AVERROR_DECODER_NOT_FOUND ? "is in a format that this FFmpeg cannot decode"
                                                  : "has no pictures"));
  }
  const AVStream& stream = *this->Format->streams[this->Index];
  for (unsigned int i = 0; i < this->Format->nb_streams; ++i)
  {
    this->Format->streams[i]->discard =
      static_cast<int>(i) == this->Index ? AVDISCARD_DEFAULT : AVDISCARD_ALL;
  }
  AVCodecContext* decoder = avcodec_alloc_context3(codec);
  if (!decoder)
  {
    throw std::bad_alloc();
  }
  decoder->pkt_timebase = stream.time_base;
  decoder->thread_count = 1; // threads would hold frames back
  if (avcodec_parameters_to_context(decoder, stream.codecpar) < 0 ||
    avcodec_open2(decoder, codec, nullptr) < 0)
  {
    avcodec_free_context(&decoder);
    throw VideoError(
      VideoError::Kind::Unsupported, what + "cannot be decoded by FFmpeg's " + codec->name);
  }
  this->Decoder = decoder;
  const AVRational rate =
    stream.avg_frame_rate.num > 0 ? stream.avg_frame_rate : stream.r_frame_rate;
  this->Rate = rate.num > 0 && rate.den > 0 ? av_q2d(rate) : 0;
}

bool VideoSource::Stream::ReadPacket(Counts& count)
{
  const int result = av_read_frame(this->Format, this->Packet);
  if (result == AVERROR(EAGAIN))
  {
    this->CheckLeft();
    this->Sleep(DeviceInterval);
    return false;
  }
  if (result == AVERROR_EOF)
  {
    this->Ended = true;
    avcodec_send_packet(this->Decoder, nullptr);
    return true;
  }
  if (result < 0)
  {
    this->CheckLeft();
    throw VideoError(VideoError::Kind::Broken,
      "The video '" + this->Settings.URL + "' broke off (" + ErrorText(result) +
        "): check its cable or sender and start again");
  }
  if (this->Packet->stream_index == this->Index)
  {
    this->HeedOrder();
    this->Arrivals.emplace_back(this->Packet->pts, this->Time.Now());
    if (this->Arrivals.size() > DeepestDecoder)
    {
      this->Arrivals.pop_front();
    }
    // full it never is: all frames were taken before
    count.Undecodable += avcodec_send_packet(this->Decoder, this->Packet) < 0 ? 1 : 0;
  }
  av_packet_unref(this->Packet);
  return true;
}

// Whether packets come in another order than their frames (B frames): one is earlier than the packet
// before it, but not than the frames that were given.
void VideoSource::Stream::HeedOrder()
{
  const std::int64_t time = this->Packet->pts;
  if (this->Arrivals.empty() || !this->LastTime || time == AV_NOPTS_VALUE)
  {
    return;
  }
  const std::int64_t before = this->Arrivals.back().first;
  const double seconds =
    static_cast<double>(time) * av_q2d(this->Format->streams[this->Index]->time_base);
  const bool earlier = before != AV_NOPTS_VALUE && time < before;
  this->Reordered = this->Reordered || (earlier && seconds > *this->LastTime);
}

double VideoSource::Stream::FindArrival() const
{
  if (this->Reordered)
  {
    // a frame that others are made from was sent before those that are shown before it: the decoder
    // gives one for each packet, all as long after what they show
    return this->Arrivals.back().second;
  }
  // the newest: a sender that began anew has the times of before
  const auto found = std::find_if(this->Arrivals.rbegin(), this->Arrivals.rend(),
    [this](const auto& arrival)
    { return arrival.first != AV_NOPTS_VALUE && arrival.first == this->Picture->pts; });
  if (found != this->Arrivals.rend())
  {
    return found->second;
  }
  return this->Arrivals.empty() ? this->Time.Now() : this->Arrivals.back().second;
}

void VideoSource::Stream::WaitForTurn(double streamTime)
{
  const double now = this->Time.Now();
  const double gap = this->LastTime ? streamTime - *this->LastTime : 0;
  if (!this->FirstTurn || gap < 0 || gap > this->Settings.FrameTime) // the stream's clock jumped
  {
    this->FirstTurn = now - streamTime;
  }
  for (double left = *this->FirstTurn + streamTime - now; left > 0;
       left = *this->FirstTurn + streamTime - this->Time.Now())
  {
    if (this->IsStopped())
    {
      throw Aborted();
    }
    this->Sleep(left);
  }
}

void VideoSource::Stream::Fill(VideoFrame& frame, Counts& count)
{
  const AVFrame& picture = *this->Picture;
  frame.Columns = picture.width;
  frame.Rows = picture.height;
  frame.Damaged = picture.decode_error_flags != 0 || (picture.flags & AV_FRAME_FLAG_CORRUPT) != 0;
  const AVRational aspect =
    av_guess_sample_aspect_ratio(this->Format, this->Format->streams[this->Index], this->Picture);
  frame.PixelAspect = aspect.num > 0 && aspect.den > 0 ? av_q2d(aspect) : 1;
  frame.Arrival = this->FindArrival();
  frame.Timed = true;
  frame.StreamTime.reset();
  if (picture.best_effort_timestamp != AV_NOPTS_VALUE)
  {
    const double time = static_cast<double>(picture.best_effort_timestamp) *
      av_q2d(this->Format->streams[this->Index]->time_base);
    const double periods = this->LastTime ? (time - *this->LastTime) * this->Rate : 0;
    count.Missing +=
      periods > 1.5 ? static_cast<std::uint64_t>(std::lround(std::fmin(periods, 1e9))) - 1 : 0;
    if (this->Paced)
    {
      this->WaitForTurn(time);
      frame.Arrival = this->Time.Now();
    }
    // some formats have no times, FFmpeg counts frames; one that was lost would seem to be late
    if (this->Paced || (this->Format->iformat->flags & AVFMT_NOTIMESTAMPS) == 0)
    {
      const FrameClock::Answer answer = this->FrameTimes.FindArrival(frame.Arrival, time);
      frame.Arrival = answer.Arrival;
      frame.Timed = answer.Known || this->Local;
    }
    frame.StreamTime = time;
    this->LastTime = time;
  }
  try
  {
    this->Grey.Convert(picture, frame.Grey);
  }
  catch (const std::runtime_error& e)
  {
    throw VideoError(VideoError::Kind::Unsupported, e.what());
  }
  KeepField(this->Settings.Field, frame.Columns, frame.Rows, frame.Grey.data());
  ++count.Frames;
  count.Damaged += frame.Damaged ? 1 : 0;
}

VideoSource::VideoSource(
  const VideoSettings& settings, const Clock& clock, std::function<bool()> stopped)
  : Input(std::make_unique<Stream>(settings, clock, std::move(stopped)))
{
  this->Input->Open();
}

VideoSource::~VideoSource() = default;

VideoEvent VideoSource::Read(VideoFrame& frame)
{
  Stream& input = *this->Input;
  input.Deadline = input.Time.Now() + input.Settings.FrameTime;
  while (true)
  {
    const int result = avcodec_receive_frame(input.Decoder, input.Picture);
    if (result == 0)
    {
      input.Fill(frame, this->Count);
      av_frame_unref(input.Picture);
      const bool same =
        input.Columns == 0 || (frame.Columns == input.Columns && frame.Rows == input.Rows);
      input.Columns = frame.Columns;
      input.Rows = frame.Rows;
      return same ? VideoEvent::Frame : VideoEvent::NewSize;
    }
    if (result == AVERROR_EOF || input.Ended)
    {
      return VideoEvent::End;
    }
    if (result != AVERROR(EAGAIN))
    {
      ++this->Count.Undecodable;
    }
    input.CheckLeft();
    input.ReadPacket(this->Count);
  }
}

std::vector<std::optional<double>> VideoSource::TakeArrivals()
{
  std::vector<std::optional<double>> arrivals = this->Input->FrameTimes.TakeArrivals();
  return this->Input->Local ? std::vector<std::optional<double>>() : arrivals;
}

double VideoSource::GetFrameRate() const
{
  return this->Input->Rate;
}
}
