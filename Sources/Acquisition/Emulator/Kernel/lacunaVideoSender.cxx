// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaVideoSender.h"

#include "lacunaExecution.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <new>
#include <string_view>
#include <utility>
#include <vector>

extern "C"
{
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/dict.h>
}

namespace lacuna
{
namespace
{
constexpr std::string_view Tcp = "tcp://";
constexpr std::string_view Udp = "udp://";
constexpr std::string_view Listen = "?listen";
constexpr int BestQuality = 2; // of MPEG-2, of 1 ... 31, 1 being refused for large frames
constexpr int NoColour = 128;
constexpr std::array<std::uint8_t, 4> SequenceEnd{ 0, 0, 1, 0xB7 }; // of MPEG-2
constexpr std::size_t LargestPiece = 60000;                         // bytes, of 16 bits

bool BeginsWith(const std::string& text, std::string_view begin)
{
  return text.compare(0, begin.size(), begin) == 0;
}

std::string ErrorText(int error)
{
  std::array<char, AV_ERROR_MAX_STRING_SIZE> text{};
  av_strerror(error, text.data(), text.size());
  return text.data();
}

bool IsGone(int error)
{
  return error == AVERROR(EPIPE) || error == AVERROR(ECONNRESET) || error == AVERROR(ENOTCONN) ||
    error == AVERROR(ETIMEDOUT);
}
}

struct VideoSender::Stream
{
  Stream(const VideoSenderSettings& settings, std::function<bool()> stopped)
    : Settings(settings)
    , Stopped(std::move(stopped))
    , Callback{ Interrupt, this }
  {
  }
  ~Stream()
  {
    this->End();
    avio_closep(&this->Server);
  }

  static int Interrupt(void* stream)
  {
    const auto& self = *static_cast<Stream*>(stream);
    return self.Stopped && self.Stopped() && !self.MustFinish ? 1 : 0;
  }
  // Throws for what FFmpeg answered, unless it is no error.
  void Check(int result, const char* what) const
  {
    if (result >= 0)
    {
      return;
    }
    if (this->Stopped && this->Stopped())
    {
      throw Aborted();
    }
    const bool taken = result == AVERROR(EADDRINUSE) || result == AVERROR(EACCES);
    throw VideoError(taken ? VideoError::Kind::Busy : VideoError::Kind::Broken,
      "The video '" + this->Settings.URL + "' " + what + " (" + ErrorText(result) + ")" +
        (taken ? ": end the other program that has this port, or take another one" : ""));
  }

  void Begin();
  void OpenEncoder(const AVOutputFormat& container);
  void Encode(const std::uint8_t* pixels, std::int64_t number);
  int WritePacket();
  int WritePieces();
  int WritePackets();
  int End();

  VideoSenderSettings Settings;
  std::function<bool()> Stopped;
  AVIOInterruptCB Callback;
  bool IsTcp = false;
  bool IsUdp = false;
  bool MustFinish = false; ///< a file shall be whole, stopped or not
  AVIOContext* Server = nullptr;
  AVFormatContext* Format = nullptr;
  AVCodecContext* Encoder = nullptr;
  AVFrame* Picture = nullptr;
  AVPacket* Packet = nullptr;
};

void VideoSender::Stream::OpenEncoder(const AVOutputFormat& container)
{
  const bool raw = this->IsTcp;
  const bool lossless =
    !raw && avformat_query_codec(&container, AV_CODEC_ID_FFV1, FF_COMPLIANCE_NORMAL) == 1;
  const AVCodec* codec = avcodec_find_encoder(raw ? AV_CODEC_ID_RAWVIDEO
      : lossless                                  ? AV_CODEC_ID_FFV1
                                                  : AV_CODEC_ID_MPEG2VIDEO);
  this->Encoder = codec ? avcodec_alloc_context3(codec) : nullptr;
  if (!this->Encoder)
  {
    throw VideoError(VideoError::Kind::Unsupported,
      "The FFmpeg of this computer has no encoder for '" + this->Settings.URL + "'");
  }
  AVCodecContext& encoder = *this->Encoder;
  encoder.width = this->Settings.Columns;
  encoder.height = this->Settings.Rows;
  encoder.time_base = { 1, this->Settings.Rate };
  encoder.framerate = { this->Settings.Rate, 1 };
  encoder.sample_aspect_ratio = { 1, 1 };
  encoder.thread_count = 1;
  encoder.pix_fmt = raw || lossless ? AV_PIX_FMT_GRAY8 : AV_PIX_FMT_YUV420P;
  if (!raw && !lossless)
  {
    encoder.gop_size = 0; // each picture for itself
    encoder.flags |= AV_CODEC_FLAG_QSCALE | AV_CODEC_FLAG_LOW_DELAY;
    encoder.global_quality = BestQuality * FF_QP2LAMBDA;
  }
  if (container.flags & AVFMT_GLOBALHEADER)
  {
    encoder.flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
  }
  this->Check(avcodec_open2(this->Encoder, codec, nullptr), "cannot be encoded at this rate");
  this->Picture = av_frame_alloc();
  this->Packet = av_packet_alloc();
  if (!this->Picture || !this->Packet)
  {
    throw std::bad_alloc();
  }
  this->Picture->format = encoder.pix_fmt;
  this->Picture->width = encoder.width;
  this->Picture->height = encoder.height;
  this->Check(av_frame_get_buffer(this->Picture, 0), "needs more memory than there is");
}

void VideoSender::Stream::Begin()
{
  const std::string& url = this->Settings.URL;
  const char* name = this->IsTcp ? "matroska" : this->IsUdp ? "mpegts" : nullptr;
  if (avformat_alloc_output_context2(&this->Format, nullptr, name, url.c_str()) < 0)
  {
    throw VideoError(VideoError::Kind::Unsupported,
      "The video '" + url +
        "' has no name to tell its kind: give tcp://127.0.0.1:5004, udp://127.0.0.1:5004 or a file "
        ".mkv, .avi or .ts");
  }
  this->Format->interrupt_callback = this->Callback;
  this->Format->flags |= AVFMT_FLAG_FLUSH_PACKETS;
  this->OpenEncoder(*this->Format->oformat);
  AVStream* stream = avformat_new_stream(this->Format, nullptr);
  if (!stream)
  {
    throw std::bad_alloc();
  }
  stream->time_base = this->Encoder->time_base;
  stream->avg_frame_rate = this->Encoder->framerate;
  stream->sample_aspect_ratio = this->Encoder->sample_aspect_ratio;
  this->Check(
    avcodec_parameters_from_context(stream->codecpar, this->Encoder), "cannot be described");
  if (this->IsTcp)
  {
    this->Check(avio_accept(this->Server, &this->Format->pb), "cannot take a client");
    this->Check(avio_handshake(this->Format->pb), "cannot take a client");
  }
  else
  {
    // packets of a transport stream fit into one of the network
    const std::string target =
      this->IsUdp && url.find('?') == std::string::npos ? url + "?pkt_size=1316" : url;
    this->Check(
      avio_open2(&this->Format->pb, target.c_str(), AVIO_FLAG_WRITE, &this->Callback, nullptr),
      "cannot be opened for writing");
  }
  AVDictionary* options = nullptr;
  if (this->IsTcp)
  {
    av_dict_set(&options, "live", "1", 0);
  }
  if (this->IsUdp)
  {
    av_dict_set(&options, "omit_video_pes_length", "0", 0);
  }
  const int result = avformat_write_header(this->Format, &options);
  av_dict_free(&options);
  if (!(this->IsTcp && IsGone(result))) // seen when the first frame is sent
  {
    this->Check(result, "cannot be begun");
  }
}

// Grey levels as the encoder takes them.
void VideoSender::Stream::Encode(const std::uint8_t* pixels, std::int64_t number)
{
  constexpr int black = 16;
  constexpr int range = 219;
  AVFrame& picture = *this->Picture;
  this->Check(av_frame_make_writable(&picture), "needs more memory than there is");
  const bool limited = picture.format == AV_PIX_FMT_YUV420P;
  for (int row = 0; row < picture.height; ++row)
  {
    const std::uint8_t* from = pixels + static_cast<std::int64_t>(row) * picture.width;
    std::uint8_t* to = picture.data[0] + static_cast<std::int64_t>(row) * picture.linesize[0];
    if (limited)
    {
      std::transform(from, from + picture.width, to,
        [](int level) { return static_cast<std::uint8_t>(black + (range * level + 127) / 255); });
    }
    else
    {
      std::memcpy(to, from, static_cast<std::size_t>(picture.width));
    }
  }
  for (int plane = 1; limited && plane < 3; ++plane)
  {
    std::memset(picture.data[plane], NoColour,
      static_cast<std::size_t>(picture.linesize[plane]) *
        static_cast<std::size_t>((picture.height + 1) / 2));
  }
  picture.pts = number;
  picture.quality = this->Encoder->global_quality;
  this->Check(avcodec_send_frame(this->Encoder, &picture), "cannot be encoded");
}

// The packet as it is, and empties it.
int VideoSender::Stream::WritePacket()
{
  int result = av_write_frame(this->Format, this->Packet);
  av_packet_unref(this->Packet);
  if (result >= 0 && this->IsTcp)
  {
    result = av_write_frame(this->Format, nullptr); // else Matroska waits for the next one
  }
  // errors of earlier writes are the stream's
  return result >= 0 && this->Format->pb->error < 0 ? this->Format->pb->error : result;
}

// The picture so that a client of a transport stream has it at once. The end of a packet it knows by
// the packet's size, of which few bytes tell, else only by the next one; and that of a picture by the
// end of the sequence, which each one is here, else only by the next one.
int VideoSender::Stream::WritePieces()
{
  std::vector<std::uint8_t> picture(this->Packet->data, this->Packet->data + this->Packet->size);
  picture.insert(picture.end(), SequenceEnd.begin(), SequenceEnd.end());
  const std::int64_t time = this->Packet->pts;
  av_packet_unref(this->Packet);
  int result = 0;
  for (std::size_t begin = 0; result >= 0 && begin < picture.size(); begin += LargestPiece)
  {
    const std::size_t size = std::min(LargestPiece, picture.size() - begin);
    result = av_new_packet(this->Packet, static_cast<int>(size));
    if (result >= 0)
    {
      std::memcpy(this->Packet->data, picture.data() + begin, size);
      this->Packet->pts = this->Packet->dts =
        time + static_cast<std::int64_t>(begin / LargestPiece); // must ascend
      result = this->WritePacket();
    }
  }
  return result;
}

int VideoSender::Stream::WritePackets()
{
  AVStream& stream = *this->Format->streams[0];
  while (avcodec_receive_packet(this->Encoder, this->Packet) == 0)
  {
    av_packet_rescale_ts(this->Packet, this->Encoder->time_base, stream.time_base);
    this->Packet->duration = av_rescale_q(1, this->Encoder->time_base, stream.time_base);
    const int result = this->IsUdp ? this->WritePieces() : this->WritePacket();
    if (result < 0)
    {
      return result;
    }
  }
  return 0;
}

// Gives the first error of ending.
int VideoSender::Stream::End()
{
  int result = 0;
  this->MustFinish = !this->IsTcp;
  if (this->Format && this->Format->pb)
  {
    if (this->Packet && this->Format->nb_streams > 0 && avcodec_is_open(this->Encoder))
    {
      avcodec_send_frame(this->Encoder, nullptr);
      result = this->WritePackets();
      const int trailer = av_write_trailer(this->Format);
      result = result < 0 ? result : trailer;
    }
    const int closing = avio_closep(&this->Format->pb);
    result = result < 0 ? result : closing;
  }
  av_packet_free(&this->Packet);
  av_frame_free(&this->Picture);
  avcodec_free_context(&this->Encoder);
  avformat_free_context(this->Format);
  this->Format = nullptr;
  this->MustFinish = false;
  return result;
}

VideoSender::VideoSender(const VideoSenderSettings& settings, std::function<bool()> stopped)
  : Output(std::make_unique<Stream>(settings, std::move(stopped)))
{
  Stream& output = *this->Output;
  avformat_network_init();
  output.IsTcp = BeginsWith(settings.URL, Tcp);
  output.IsUdp = BeginsWith(settings.URL, Udp);
  if (output.IsTcp)
  {
    std::string url = settings.URL;
    if (url.size() > Listen.size() && url.rfind(Listen) == url.size() - Listen.size())
    {
      url.resize(url.size() - Listen.size());
    }
    AVDictionary* options = nullptr;
    av_dict_set(&options, "listen", "2", 0); // for one client after the other
    // Else the end of a frame waits until the client has acknowledged its beginning: up to 40 ms.
    av_dict_set(&options, "tcp_nodelay", "1", 0);
    const int result =
      avio_open2(&output.Server, url.c_str(), AVIO_FLAG_WRITE, &output.Callback, &options);
    av_dict_free(&options);
    output.Check(result, "cannot be served");
  }
}

VideoSender::~VideoSender() = default;

bool VideoSender::IsServer() const
{
  return this->Output->IsTcp;
}

void VideoSender::Open()
{
  this->Output->End();
  this->Output->Begin();
}

bool VideoSender::Send(const std::uint8_t* pixels, std::int64_t number)
{
  Stream& output = *this->Output;
  output.Encode(pixels, number);
  const int result = output.WritePackets();
  if (output.IsTcp && IsGone(result))
  {
    return false;
  }
  output.Check(result, "cannot be sent");
  return true;
}

void VideoSender::Close()
{
  Stream& output = *this->Output;
  const int result = output.End();
  if (!output.IsTcp)
  {
    output.Check(result, "cannot be ended");
  }
}
}
