// SPDX-License-Identifier: BSD-3-Clause
// Messages that OpenIGTLink's own library packed, and damaged ones.
#include "lacunaTestDevice.h"
#include "lacunaTestOpenIGTLink.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <limits>
#include <map>
#include <random>
#include <tuple>

using namespace lacuna;
using namespace lacunaTest;

namespace
{
constexpr double Single = 2e-5; // mm, of numbers of 24 bits below 512

OpenIGTLinkPose ReadPose(const std::string& bytes)
{
  const std::vector<OpenIGTLinkPose> poses = ReadOpenIGTLinkPoses(Read(bytes));
  EXPECT_EQ(poses.size(), 1u);
  return poses.empty() ? OpenIGTLinkPose() : poses[0];
}

std::string FaultOf(const Matrix4& pose)
{
  return ReadPose(TransformBytes(pose, "ProbeToTracker")).Fault;
}

std::string ImageFault(const std::string& bytes)
{
  try
  {
    ReadOpenIGTLinkImage(Read(bytes));
  }
  catch (const OpenIGTLinkError& e)
  {
    return e.what();
  }
  return {};
}

std::array<float, 4> ToQuaternion(const Matrix4& pose)
{
  igtl::Matrix4x4 matrix;
  ToIgtl(pose, matrix);
  std::array<float, 4> quaternion{};
  igtl::MatrixToQuaternion(matrix, quaternion.data());
  return quaternion;
}

// The library's own shorter forms write behind their memory.
std::string PositionBytes(const Matrix4& pose, bool negate = false)
{
  const auto message = igtl::PositionMessage::New();
  std::array<float, 4> q = ToQuaternion(pose);
  if (negate)
  {
    std::transform(q.begin(), q.end(), q.begin(), std::negate<>());
  }
  const Vec3 p = pose.Column(3);
  message->SetPosition(
    static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2]));
  message->SetQuaternion(q.data());
  return Pack(*message, "ProbeToTracker", 0);
}

template <class T>
std::vector<char> ToBytes(const std::vector<T>& levels, bool littleEndian)
{
  std::vector<char> bytes;
  for (const T level : levels)
  {
    std::string number = BigEndian(static_cast<std::uint64_t>(level), sizeof(T));
    if (littleEndian)
    {
      std::reverse(number.begin(), number.end());
    }
    bytes.insert(bytes.end(), number.begin(), number.end());
  }
  return bytes;
}
}

TEST(OpenIGTLinkMessage, HeaderOfATransform)
{
  const double stamp = 1763745123.40625;
  const OpenIGTLinkMessage message =
    Read(TransformBytes(AsymmetricPose(), "ProbeToTracker", stamp));
  EXPECT_EQ(message.Header.Version, 1);
  EXPECT_EQ(message.Header.Type, "TRANSFORM");
  EXPECT_EQ(message.Header.Device, "ProbeToTracker");
  EXPECT_EQ(message.Header.BodySize, 48u);
  EXPECT_EQ(message.Header.Stamp, stamp);
  EXPECT_FALSE(Read(TransformBytes(AsymmetricPose(), "ProbeToTracker")).Header.Stamp);
  // a name that fills its field has no null
  EXPECT_EQ(Read(TransformBytes(AsymmetricPose(), "12345678901234567890")).Header.Device,
    "12345678901234567890");
}

TEST(OpenIGTLinkMessage, PosesOfEveryType)
{
  const Matrix4 pose = AsymmetricPose();
  const OpenIGTLinkPose transform = ReadPose(TransformBytes(pose, "ProbeToTracker"));
  EXPECT_EQ(transform.Name, "ProbeToTracker");
  EXPECT_TRUE(transform.Usable);
  EXPECT_EQ(transform.Fault, "");
  EXPECT_FALSE(transform.Button);
  EXPECT_LT(LargestDifference(transform.Pose, pose), Single);

  const std::string whole = PositionBytes(pose);
  for (const std::string& bytes :
    { whole, PositionBytes(pose, true), WithBody(whole, whole.substr(58, 24)) })
  {
    const OpenIGTLinkPose position = ReadPose(bytes);
    EXPECT_EQ(position.Fault, "");
    EXPECT_LT(LargestDifference(position.Pose, pose), Single);
  }
  EXPECT_HAS(ReadPose(WithBody(whole, whole.substr(58, 12))).Fault, "has no orientation");
  std::string qtrans = PositionBytes(pose);
  qtrans.replace(2, 12, std::string("QTRANS") + std::string(6, '\0'));
  EXPECT_LT(LargestDifference(ReadPose(qtrans).Pose, pose), Single);
}

TEST(OpenIGTLinkMessage, TrackingDataHaveSeveralPoses)
{
  const std::map<std::string, Matrix4> sent{ { "Probe", AsymmetricPose(1) },
    { "Stylus", AsymmetricPose(2) } };
  const auto poses = ReadOpenIGTLinkPoses(Read(TrackingBytes(sent)));
  ASSERT_EQ(poses.size(), 2u);
  for (const OpenIGTLinkPose& pose : poses)
  {
    EXPECT_LT(LargestDifference(pose.Pose, sent.at(pose.Name)), Single);
    EXPECT_EQ(pose.Fault, "");
  }
  EXPECT_HAS(ReadPose(TrackingBytes({ { "Needle", AsymmetricPose() } }, 0, 3)).Fault,
    "not its whole orientation");

  const auto message = igtl::QuaternionTrackingDataMessage::New();
  for (const auto& [name, pose] : sent)
  {
    igtl::QuaternionTrackingDataElement::Pointer element =
      igtl::QuaternionTrackingDataElement::New();
    const Vec3 p = pose.Column(3);
    element->SetName(name.c_str());
    element->SetType(igtl::QuaternionTrackingDataElement::TYPE_6D);
    element->SetPosition(
      static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2]));
    element->SetQuaternion(ToQuaternion(pose).data());
    message->AddQuaternionTrackingDataElement(element);
  }
  const auto quaternions = ReadOpenIGTLinkPoses(Read(Pack(*message, "Tracker", 0)));
  ASSERT_EQ(quaternions.size(), 2u);
  for (const OpenIGTLinkPose& pose : quaternions)
  {
    EXPECT_LT(LargestDifference(pose.Pose, sent.at(pose.Name)), Single);
  }
}

TEST(OpenIGTLinkMessage, MetaDataOfProtocol3)
{
  const std::string longName = "StylusTipToReferenceFrame";
  const std::string bytes = TransformBytes(AsymmetricPose(), longName.substr(0, 20));
  for (const int version : { 2, 3 })
  {
    const OpenIGTLinkPose pose = ReadPose(WithMetaData(
      bytes, { { "IGTL_DEVICE_NAME", longName }, { "TransformStatus", "OK" } }, version));
    EXPECT_EQ(pose.Name, longName);
    EXPECT_TRUE(pose.Usable);
    EXPECT_EQ(pose.Button, false);
    EXPECT_LT(LargestDifference(pose.Pose, AsymmetricPose()), Single);
  }
  EXPECT_TRUE(ReadPose(WithMetaData(bytes, {})).Usable);
  const OpenIGTLinkPose lost =
    ReadPose(WithMetaData(bytes, { { "TransformStatus", "OUT_OF_VIEW" } }));
  EXPECT_FALSE(lost.Usable);
  EXPECT_EQ(lost.Status, "OUT_OF_VIEW");
  const OpenIGTLinkPose pressed =
    ReadPose(WithMetaData(bytes, { { "TransformStatus", "SWITCH1_IS_ON" } }));
  EXPECT_TRUE(pressed.Usable);
  EXPECT_EQ(pressed.Button, true);
  const auto elements =
    ReadOpenIGTLinkPoses(Read(WithMetaData(TrackingBytes({ { "Probe", AsymmetricPose(1) },
                                             { longName.substr(0, 20), AsymmetricPose(2) } }),
      { { "ProbeStatus", "OK" }, { "ProbeIndex", "0" }, { longName + "Status", "MISSING" },
        { longName + "Index", "1" } })));
  ASSERT_EQ(elements.size(), 2u);
  EXPECT_TRUE(elements[0].Usable);
  EXPECT_EQ(elements[1].Name, longName);
  EXPECT_FALSE(elements[1].Usable);
}

TEST(OpenIGTLinkMessage, NamesAreCutTo20Characters)
{
  EXPECT_TRUE(IsOpenIGTLinkName("ProbeToTracker", "ProbeToTracker"));
  EXPECT_FALSE(IsOpenIGTLinkName("ProbeToTracker", "ProbeToTrackerX"));
  EXPECT_TRUE(IsOpenIGTLinkName("StylusTipToReference", "StylusTipToReferenceFrame"));
  EXPECT_FALSE(IsOpenIGTLinkName("StylusTipToReferencF", "StylusTipToReferenceFrame"));
}

TEST(OpenIGTLinkMessage, OnlyRotationAndTranslationIsAPose)
{
  const Matrix4 pose = AsymmetricPose();
  EXPECT_EQ(FaultOf(pose), "");
  EXPECT_HAS(FaultOf(pose * Matrix4::Scaling({ 0.2, 0.2, 0.2 })),
    "it is not rigid: its columns have the lengths 0.2, 0.2");
  EXPECT_HAS(FaultOf(pose * Matrix4::Scaling({ 1, 1, 1.002 })),
    "it is not a rotation and a translation by 0.004");
  EXPECT_HAS(FaultOf(pose * Matrix4::Scaling({ -1, 1, 1 })), "mirrors");
  EXPECT_HAS(FaultOf(pose * Matrix4::Scaling({ -1, -1, -1 })), "mirrors");
  const double angle = 0.002;
  EXPECT_HAS(FaultOf(pose *
               Matrix4::FromColumns(
                 { 1, 0, 0 }, { std::sin(angle), std::cos(angle), 0 }, { 0, 0, 1 }, { 0, 0, 0 })),
    "it is not a rotation and a translation by 0.00199999");
  EXPECT_HAS(FaultOf(Matrix4::Scaling({ 0, 1, 1 })), "it is singular");
  EXPECT_EQ(FaultOf(Matrix4::Translation({ 0, -9e5, 0 }) * pose), "");
  EXPECT_HAS(FaultOf(Matrix4::Translation({ 0, -1.1e6, 0 }) * pose), "its unit, which is mm");
  EXPECT_HAS(FaultOf(Matrix4::Translation({ 1e20, 0, 0 }) * pose), "its unit, which is mm");
  Matrix4 nothing = pose;
  nothing(1, 2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(ReadPose(TransformBytes(nothing, "ProbeToTracker")).Usable);
  // what older PLUS servers send for a tool that is out of sight; not when the sender knows it
  const std::string identity = TransformBytes(Matrix4(), "ProbeToTracker");
  EXPECT_FALSE(ReadPose(identity).Usable);
  EXPECT_TRUE(ReadPose(WithMetaData(identity, { { "TransformStatus", "OK" } })).Usable);
  // what trackers send for a tool that they do not see
  for (const Matrix4& unseen : { Matrix4::Scaling({ 0, 0, 0 }),
         Matrix4::FromColumns({ 0, 0, 0 }, { 0, 0, 0 }, { 0, 0, 0 }, { 1, 2, 3 }),
         Matrix4::Translation({ -3.697314e28, 0, 0 }) * pose })
  {
    const OpenIGTLinkPose read = ReadPose(TransformBytes(unseen, "ProbeToTracker"));
    EXPECT_FALSE(read.Usable);
    EXPECT_EQ(read.Fault, "");
  }
  std::string turned = PositionBytes(pose);
  const OpenIGTLinkPose zero =
    ReadPose(WithBody(turned, turned.substr(58, 12) + std::string(16, '\0')));
  EXPECT_FALSE(zero.Usable);
  EXPECT_EQ(zero.Fault, "");
  turned = WithBody(turned, turned.substr(58, 24) + BigEndian(0x40000000, 4)); // w = 2
  EXPECT_HAS(ReadPose(turned).Fault, "a quaternion of length 2");
}

TEST(OpenIGTLinkMessage, ImageOfEveryIntegerTypeAndByteOrder)
{
  const int big = igtl::ImageMessage::ENDIAN_BIG;
  const int little = igtl::ImageMessage::ENDIAN_LITTLE;
  using Levels = std::vector<std::uint8_t>;
  // 3 columns, 2 rows: no flip leaves them as they are
  const auto image = [](const std::vector<char>& pixels, int type, int endian, int channels = 1)
  {
    return ReadOpenIGTLinkImage(Read(ImageBytes(3, 2, pixels, "Image", 0, type, channels, endian)));
  };
  const OpenIGTLinkImage grey =
    image({ 0, 1, 127, char(128), char(254), char(255) }, igtl::ImageMessage::TYPE_UINT8, little);
  EXPECT_EQ(grey.Columns, 3);
  EXPECT_EQ(grey.Rows, 2);
  EXPECT_EQ(grey.Grey, (Levels{ 0, 1, 127, 128, 254, 255 }));
  EXPECT_EQ(image({ 0, 1, 64, 127, -1, -128 }, igtl::ImageMessage::TYPE_INT8, little).Grey,
    (Levels{ 0, 2, 129, 255, 0, 0 })); // 64 / 127 of 255 is 128.5
  for (const int endian : { big, little })
  {
    const bool last = endian == little;
    EXPECT_EQ(image(ToBytes<std::uint16_t>({ 0, 257, 128, 129, 0x1234, 65535 }, last),
                igtl::ImageMessage::TYPE_UINT16, endian)
                .Grey,
      (Levels{ 0, 1, 0, 1, 18, 255 }));
    EXPECT_EQ(image(ToBytes<std::int16_t>({ 0, 16384, 32767, -1, -32768, 0x1234 }, last),
                igtl::ImageMessage::TYPE_INT16, endian)
                .Grey,
      (Levels{ 0, 128, 255, 0, 0, 36 }));
    std::vector<std::uint16_t> colours;
    for (int i = 0; i < 6; ++i)
    {
      // red, green, blue, opacity: only what is not opacity counts
      colours.insert(colours.end(),
        { static_cast<std::uint16_t>(i % 3 == 0 ? 65535 : 0),
          static_cast<std::uint16_t>(i % 3 == 1 ? 65535 : 0),
          static_cast<std::uint16_t>(i % 3 == 2 ? 65535 : 0),
          static_cast<std::uint16_t>(40000 * (i % 2)) });
    }
    EXPECT_EQ(image(ToBytes(colours, last), igtl::ImageMessage::TYPE_UINT16, endian, 4).Grey,
      (Levels{ 76, 150, 29, 76, 150, 29 }));
  }
  std::vector<char> colours(18, 0);
  colours[0] = char(255);
  colours[4] = char(255);
  colours[8] = char(255);
  EXPECT_EQ(image(colours, igtl::ImageMessage::TYPE_UINT8, little, 3).Grey,
    (Levels{ 76, 150, 29, 0, 0, 0 }));
}

TEST(OpenIGTLinkMessage, ImagePlaneIsAtTheFirstPixel)
{
  const std::vector<char> pixels(5 * 4, 0);
  const OpenIGTLinkImage image = ReadOpenIGTLinkImage(Read(ImageBytes(5, 4, pixels, "Image")));
  ASSERT_TRUE(image.PixelSpacing);
  EXPECT_NEAR((*image.PixelSpacing)[0], 0.2, 1e-6);
  EXPECT_NEAR((*image.PixelSpacing)[1], 0.3, 1e-6);
  EXPECT_LT(LargestDifference(image.Plane.Pose, AsymmetricPose()), 2 * Single);
  EXPECT_TRUE(image.Plane.Usable);
  EXPECT_EQ(image.Plane.Fault, "");
  const auto with = [&](const std::array<float, 2>& spacing, const Matrix4& plane)
  {
    return ReadOpenIGTLinkImage(Read(ImageBytes(5, 4, pixels, "Image", 0,
      igtl::ImageMessage::TYPE_UINT8, 1, igtl::ImageMessage::ENDIAN_BIG, spacing, plane)));
  };
  // an image that is not calibrated: PLUS gives pixels as mm
  EXPECT_FALSE(with({ 1, 1 }, Matrix4()).PixelSpacing);
  EXPECT_FALSE(with({ 1, 1 }, Matrix4()).Plane.Usable);
  EXPECT_TRUE(with({ 1, 2 }, Matrix4()).PixelSpacing);
  EXPECT_TRUE(
    with({ 0, 0.3F }, AsymmetricPose()).PixelSpacing); // as sent: who compares it complains
  EXPECT_HAS(
    with({ 0.2F, 0.3F }, AsymmetricPose() * Matrix4::Scaling({ 1, -1, 1 })).Plane.Fault, "mirrors");
}

TEST(OpenIGTLinkMessage, ImagesThatCannotBe)
{
  const std::vector<char> pixels(6, 1);
  const std::string right = ImageBytes(3, 2, pixels, "Image");
  EXPECT_EQ(ImageFault(right), "");
  const auto changed = [&](std::size_t at, const std::string& bytes)
  {
    std::string body = right.substr(58);
    body.replace(at, bytes.size(), bytes);
    return ImageFault(WithBody(right, body));
  };
  EXPECT_HAS(changed(2, "\x02"), "2 numbers a pixel");
  EXPECT_HAS(changed(3, "\x0a"), "integers of 8 or 16 bits");
  EXPECT_HAS(changed(4, std::string(1, '\0')), "order of its bytes");
  EXPECT_HAS(changed(6, BigEndian(4, 2)), "part of an image");
  EXPECT_HAS(changed(6, BigEndian(0, 2)), "one slice is needed");
  EXPECT_HAS(changed(10, BigEndian(2, 2)), "3 x 2 x 2 pixels");
  EXPECT_HAS(changed(60, BigEndian(1, 2)), "part of an image");
  std::string giant = right.substr(58);
  giant.replace(6, 4, BigEndian(0xFFFFFFFF, 4));
  giant.replace(66, 4, BigEndian(0xFFFFFFFF, 4));
  EXPECT_HAS(ImageFault(WithBody(right, giant)), "6 bytes of pixels instead of 4294836225");
  EXPECT_HAS(ImageFault(WithBody(right, right.substr(58, 77))), "instead of 6");
  EXPECT_HAS(ImageFault(WithBody(right, right.substr(58, 71))), "header is cut off");
}

TEST(OpenIGTLinkMessage, StatusIsTold)
{
  EXPECT_EQ(ReadOpenIGTLinkStatus(Read(StatusBytes(1, "OK", "fine"))), "");
  EXPECT_EQ(ReadOpenIGTLinkStatus(Read(StatusBytes(18, "Failure", "coil\nbroken"))),
    "The sender's device 'Tracker' reports status 18 (Failure: coil broken)");
  const std::string cut = StatusBytes(18, "Failure", "coil");
  EXPECT_THROW(ReadOpenIGTLinkStatus(Read(WithBody(cut, cut.substr(58, 29)))), OpenIGTLinkError);
}

// Latin 1, which is no UTF-8, and line feeds.
TEST(OpenIGTLinkMessage, TextsOfAnyBytesBecomePrintable)
{
  const std::string odd = "P\xE9\xFF\n";
  EXPECT_EQ(ReadPose(TransformBytes(AsymmetricPose(), odd)).Name, "P???");
  EXPECT_EQ(ReadPose(TrackingBytes({ { odd, AsymmetricPose() } })).Name, "P???");
  const OpenIGTLinkMessage message = Read(WithMetaData(TransformBytes(AsymmetricPose(), "Probe"),
    { { "IGTL_DEVICE_NAME", odd }, { odd, "1" }, { "TransformStatus", odd } }));
  EXPECT_EQ(message.GetDevice(), "P???");
  EXPECT_EQ(message.MetaData.count("P???"), 1u);
  EXPECT_EQ(ReadOpenIGTLinkPoses(message)[0].Status, "P???");
  EXPECT_EQ(ReadOpenIGTLinkStatus(Read(StatusBytes(18, odd, odd))),
    "The sender's device 'Tracker' reports status 18 (P?? : P?? )");
  // a device that is asked for in UTF-8, and one that is cut within a character
  const std::string sonde = "Ultraschallsonde-Gr\xC3\xBC\x6E";
  for (const std::string& name : { sonde.substr(0, 20), std::string("P\xC3\xA9") })
  {
    EXPECT_TRUE(IsOpenIGTLinkName(
      ReadPose(TransformBytes(AsymmetricPose(), name)).Name, name.size() == 20 ? sonde : name));
  }
}

TEST(OpenIGTLinkMessage, EveryDamagedBitOfTheBodyIsSeen)
{
  const std::string right =
    WithMetaData(TransformBytes(AsymmetricPose(), "Probe"), { { "TransformStatus", "OK" } });
  Read(right);
  for (std::size_t bit = 8 * 50; bit < 8 * right.size(); ++bit)
  {
    std::string damaged = right;
    damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ (1 << bit % 8));
    EXPECT_THROW(Read(damaged), OpenIGTLinkError) << bit;
  }
}

TEST(OpenIGTLinkMessage, WhatIsNoHeaderIsRefused)
{
  const auto refused = [](std::string bytes)
  {
    bytes.resize(58, '\0');
    EXPECT_THROW(ReadOpenIGTLinkHeader(bytes.data()), OpenIGTLinkError) << bytes;
  };
  refused("");
  refused("HTTP/1.1 400 Bad Request\r\nContent-Type: text/plain\r\n\r\n........");
  refused("SSH-2.0-OpenSSH_9.2p1 Debian-2+deb12u3");
  const std::string right = TransformBytes(AsymmetricPose(), "Probe").substr(0, 58);
  ReadOpenIGTLinkHeader(right.data());
  refused(BigEndian(4, 2) + right.substr(2));
  refused(BigEndian(0, 2) + right.substr(2));
  refused(right.substr(0, 2) + std::string(12, '\0') + right.substr(14));
  refused(right.substr(0, 42) + BigEndian((std::uint64_t{ 1 } << 32) + 1, 8) + right.substr(50));
}

// Sizes within bodies that the checksum confirms, yet that cannot be: nothing outside is read (run
// with the address sanitizer), nothing giant is allocated.
TEST(OpenIGTLinkMessage, RandomBodiesAreReadOrRefused)
{
  std::mt19937 random(7);
  const auto number = [&](std::size_t most)
  { return std::uniform_int_distribution<std::size_t>(0, most)(random); };
  const std::vector<std::string> seeds{ TransformBytes(AsymmetricPose(), "Probe"),
    PositionBytes(AsymmetricPose()),
    TrackingBytes({ { "Probe", AsymmetricPose() }, { "Stylus", AsymmetricPose() } }),
    ImageBytes(3, 2, std::vector<char>(6, 1), "Image"), StatusBytes(5, "Error", "what it is") };
  int read = 0;
  int refused = 0;
  for (int i = 0; i < 40000; ++i)
  {
    std::string bytes = seeds[number(seeds.size() - 1)];
    if (i % 2 == 0)
    {
      bytes = WithMetaData(bytes, { { "TransformStatus", "OK" }, { "ProbeStatus", "OK" } });
    }
    std::string body = bytes.substr(58);
    for (std::size_t change = number(3); change > 0; --change)
    {
      body[number(body.size() - 1)] = static_cast<char>(number(255));
    }
    body.resize(number(9) == 0 ? number(body.size()) : body.size());
    try
    {
      const OpenIGTLinkMessage message = Read(WithBody(bytes, body));
      if (message.Header.Type == "STATUS")
      {
        ReadOpenIGTLinkStatus(message);
      }
      else if (message.Header.Type == "IMAGE")
      {
        ReadOpenIGTLinkImage(message);
      }
      ReadOpenIGTLinkPoses(message);
      ++read;
    }
    catch (const OpenIGTLinkError&)
    {
      ++refused;
    }
  }
  EXPECT_GT(read, 10000);
  EXPECT_GT(refused, 5000);
}

TEST(OpenIGTLinkMessage, AsksForTrackingData)
{
  EXPECT_EQ(Read(MakeOpenIGTLinkTrackingRequest("QTDATA")).Header.Type, "STT_QTDATA");
  const OpenIGTLinkMessage request = Read(MakeOpenIGTLinkTrackingRequest("TDATA"));
  EXPECT_EQ(request.Header.Type, "STT_TDATA");
  EXPECT_EQ(request.Header.Version, 1); // version 2 has other bytes, which old servers misread
  const std::string bytes = MakeOpenIGTLinkTrackingRequest("TDATA");
  const auto header = igtl::MessageHeader::New();
  header->InitPack();
  std::memcpy(header->GetPackPointer(), bytes.data(), 58);
  header->Unpack();
  const auto message = igtl::StartTrackingDataMessage::New();
  message->SetMessageHeader(header);
  message->AllocatePack();
  ASSERT_EQ(static_cast<std::size_t>(message->GetPackBodySize()), bytes.size() - 58);
  std::memcpy(message->GetPackBodyPointer(), bytes.data() + 58, bytes.size() - 58);
  EXPECT_TRUE(message->Unpack(1) & igtl::MessageHeader::UNPACK_BODY);
  EXPECT_EQ(message->GetResolution(), 0);
}

TEST(OpenIGTLinkMessage, AsksForStatusInVersion2)
{
  const OpenIGTLinkMessage request = Read(MakeOpenIGTLinkStatusRequest());
  EXPECT_EQ(request.Header.Type, "GET_STATUS");
  EXPECT_EQ(request.Header.Version, 2);
  EXPECT_EQ(request.ContentSize, 0u);
  EXPECT_EQ(request.MetaData.size(), 1u);
}

// As the example servers of its library read, which does not know version 2.
TEST(OpenIGTLinkMessage, AServerOfVersion1ReadsOnAfterTheRequestOfVersion2)
{
  const std::string bytes =
    MakeOpenIGTLinkStatusRequest() + MakeOpenIGTLinkTrackingRequest("TDATA");
  std::size_t position = 0;
  const auto header = igtl::MessageHeader::New();
  std::vector<std::string> types;
  while (position + OpenIGTLinkHeader::Size <= bytes.size())
  {
    header->InitPack();
    std::memcpy(header->GetPackPointer(), bytes.data() + position, OpenIGTLinkHeader::Size);
    header->Unpack();
    types.emplace_back(header->GetDeviceType());
    position += OpenIGTLinkHeader::Size + static_cast<std::size_t>(header->GetBodySizeToRead());
  }
  EXPECT_EQ(position, bytes.size());
  EXPECT_EQ(types.back(), "STT_TDATA");
}

TEST(OpenIGTLinkMessage, StatusesOfEveryKindOfMessage)
{
  const std::string pose = TransformBytes(AsymmetricPose(), "Probe");
  using Data = std::map<std::string, std::string>;
  for (const auto& [data, status, usable] : { std::tuple<Data, std::string, bool>{ {}, "", true },
         { { { "TransformStatus", "OUT_OF_VOLUME" } }, "OUT_OF_VOLUME", false },
         { { { "TransformStatus", "OK" }, { "TransformValid", "0" } }, "OK", true },
         { { { "Status", "MISSING" } }, "MISSING", false },   // as PLUS reads positions
         { { { "TransformValid", "0" } }, "INVALID", false }, // PLUS of 2018
         { { { "TransformValid", "1" } }, "OK", true } })
  {
    for (const std::string& bytes : { pose, PositionBytes(AsymmetricPose()) })
    {
      const OpenIGTLinkPose read = ReadPose(WithMetaData(bytes, data));
      EXPECT_EQ(read.Status, status);
      EXPECT_EQ(read.Usable, usable) << status;
    }
  }
  // two elements whose names are cut to the same 20 characters
  const std::string name = "StylusTipToReference";
  igtl::Matrix4x4 matrix;
  ToIgtl(AsymmetricPose(), matrix);
  const auto tracking = igtl::TrackingDataMessage::New();
  for (int i = 0; i < 2; ++i)
  {
    igtl::TrackingDataElement::Pointer element = igtl::TrackingDataElement::New();
    element->SetName(name.c_str());
    element->SetType(2);
    element->SetMatrix(matrix);
    tracking->AddTrackingDataElement(element);
  }
  const auto elements = ReadOpenIGTLinkPoses(Read(WithMetaData(Pack(*tracking, "TDATA", 1),
    { { name + "AStatus", "OK" }, { name + "AIndex", "1" }, { name + "BStatus", "MISSING" },
      { name + "BIndex", "0" } })));
  ASSERT_EQ(elements.size(), 2u);
  EXPECT_EQ(elements[0].Name, name + "B");
  EXPECT_FALSE(elements[0].Usable);
  EXPECT_EQ(elements[1].Name, name + "A");
  EXPECT_TRUE(elements[1].Usable);
}

TEST(OpenIGTLinkMessage, StatusesBesideAnImage)
{
  const std::string bytes = ImageBytes(3, 2, std::vector<char>(6, 1), "Image_Reference", 1);
  const auto read = [&](const std::map<std::string, std::string>& data)
  { return ReadOpenIGTLinkImage(Read(WithMetaData(bytes, data))); };
  EXPECT_TRUE(read({}).Valid);
  EXPECT_EQ(read({}).Plane.Status, "");
  EXPECT_FALSE(read({ { "ImageStatus", "INVALID" } }).Valid);
  EXPECT_TRUE(read({ { "ImageStatus", "OK" } }).Valid);
  const std::map<std::string, std::string> good{ { "ProbeToTrackerTransform", "1 0 0 0" },
    { "ProbeToTrackerTransformStatus", "OK" }, { "ReferenceToTrackerTransformStatus", "OK" } };
  EXPECT_TRUE(read(good).Plane.Usable);
  EXPECT_EQ(read(good).Plane.Status, "OK");
  auto bad = good;
  bad["ReferenceToTrackerTransformStatus"] = "OUT_OF_VIEW";
  EXPECT_FALSE(read(bad).Plane.Usable);
  EXPECT_EQ(read(bad).Plane.Status, "ReferenceToTracker is OUT_OF_VIEW");
  bad["ImageToReferenceTransformStatus"] = "OK"; // the image's own
  EXPECT_TRUE(read(bad).Plane.Usable);
}
