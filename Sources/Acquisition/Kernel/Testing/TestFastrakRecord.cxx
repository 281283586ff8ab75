// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaFastrakRecord.h"
#include "lacunaFastrakReply.h"
#include "lacunaTestFastrak.h"

#include <gtest/gtest.h>

#include <clocale>
#include <limits>

using namespace lacuna;
using namespace lacunaTest;

namespace
{
const FastrakFormat AsciiInches{ false, LengthUnit::Inch };
const FastrakFormat BinaryCentimetres{ true, LengthUnit::Centimetre };

FastrakLayout Layout(const std::vector<int>& numbers)
{
  return FastrakLayout::FromNumbers(numbers);
}
}

TEST(FastrakRecord, LengthsAreThoseOfTheManual)
{
  EXPECT_EQ(FastrakLayout().GetLength(false), 47u);
  EXPECT_EQ(FastrakLayout().GetLength(true), 29u);
  EXPECT_EQ(Layout({ 2, 4 }).GetLength(true), 27u);
  EXPECT_EQ(Layout({ 2, 11, 0 }).GetLength(true), 32u); // VRPN's
  EXPECT_EQ(Layout({ 52, 54, 61 }).GetLength(false), 3u + 130u);
  EXPECT_EQ(Layout({ 16, 0, 1, 5, 6, 7 }).GetLength(false), 3u + 2 + 1 + 2 + 63);
  EXPECT_TRUE(Layout({ 2, 11 }).HasPose());
  EXPECT_TRUE(Layout({ 52, 5, 6, 7 }).HasPose());
  EXPECT_FALSE(Layout({ 2, 5, 6 }).HasPose());
  EXPECT_FALSE(Layout({ 4 }).HasPose());
  EXPECT_THROW(Layout({ 8 }), std::invalid_argument);
  EXPECT_THROW(Layout({ 4, 54 }), std::invalid_argument);
  EXPECT_THROW(Layout({ 18 }), std::invalid_argument);
  EXPECT_THROW(Layout(std::vector<int>(33, 0)), std::invalid_argument);
  EXPECT_THROW(Layout(std::vector<int>(20, 54)), std::invalid_argument);
}

TEST(FastrakRecord, ReadsTheDefaultRecordByColumns)
{
  const std::string bytes = "01    7.38  -0.25   3.19  12.40  -5.01   0.33\r\n";
  const auto record = DecodeFastrakRecord(bytes, FastrakLayout(), AsciiInches);
  ASSERT_TRUE(record);
  EXPECT_EQ(record->Station, 1);
  EXPECT_EQ(record->Error, ' ');
  EXPECT_NEAR((*record->Position)[0], 7.38 * 25.4, 1e-9);
  EXPECT_NEAR((*record->Position)[1], -0.25 * 25.4, 1e-9);
  EXPECT_EQ((*record->Angles)[1], -5.01);

  // fields that touch, a sign in the first column, a plus, an error code, another station
  const auto touching = DecodeFastrakRecord(
    "03k-112.34-100.00-  3.19+180.00- 89.99-170.25\r\n", FastrakLayout(), AsciiInches);
  ASSERT_TRUE(touching);
  EXPECT_EQ(touching->Station, 3);
  EXPECT_EQ(touching->Error, 'k');
  EXPECT_NEAR((*touching->Position)[1], -2540, 1e-9);
  EXPECT_NEAR((*touching->Position)[2], -3.19 * 25.4, 1e-9);
  EXPECT_EQ((*touching->Angles)[0], 180);
  EXPECT_EQ((*touching->Angles)[1], -89.99);

  // in centimetres the same digits are other lengths
  const auto centimetres =
    DecodeFastrakRecord(bytes, FastrakLayout(), { false, LengthUnit::Centimetre });
  EXPECT_NEAR((*centimetres->Position)[0], 73.8, 1e-9);
}

TEST(FastrakRecord, RefusesWhatIsNoRecord)
{
  const std::string good = "01    7.38  -0.25   3.19  12.40  -5.01   0.33\r\n";
  const auto refused = [&](std::size_t at, char c)
  {
    std::string bytes = good;
    bytes[at] = c;
    return !DecodeFastrakRecord(bytes, FastrakLayout(), AsciiInches);
  };
  EXPECT_TRUE(refused(0, '1'));
  EXPECT_TRUE(refused(1, '5'));
  EXPECT_TRUE(refused(1, '0'));
  EXPECT_TRUE(refused(2, '\x81'));
  EXPECT_TRUE(refused(5, 'x'));  // not a digit or sign
  EXPECT_TRUE(refused(6, ' '));  // no digit before the point
  EXPECT_TRUE(refused(7, '5'));  // no point
  EXPECT_TRUE(refused(9, ' '));  // too few decimals
  EXPECT_TRUE(refused(25, '9')); // azimuth 912.40
  EXPECT_TRUE(refused(45, '\n'));
  EXPECT_FALSE(refused(9, '9'));
  EXPECT_FALSE(DecodeFastrakRecord(good.substr(1), FastrakLayout(), AsciiInches));
  EXPECT_FALSE(DecodeFastrakRecord(good + " ", FastrakLayout(), AsciiInches));
  EXPECT_FALSE(DecodeFastrakRecord("", FastrakLayout(), AsciiInches));
}

TEST(FastrakRecord, RefusesBinaryNumbersThatNoUnitSends)
{
  const FastrakLayout layout = Layout({ 2, 4, 11 });
  const FastrakRecord good = MakeRecord({ 100, -200, 300 }, { 30, 40, 50 });
  const auto accepted = [&](const FastrakRecord& record)
  {
    return DecodeFastrakRecord(
      EncodeFastrakRecord(record, layout, BinaryCentimetres), layout, BinaryCentimetres)
      .has_value();
  };
  EXPECT_TRUE(accepted(good));
  for (const double bad : { std::numeric_limits<double>::quiet_NaN(),
         std::numeric_limits<double>::infinity(), 1e30, 4100.0, -4100.0 })
  {
    FastrakRecord record = good;
    (*record.Position)[2] = bad;
    EXPECT_FALSE(accepted(record)) << bad;
  }
  FastrakRecord steep = good;
  (*steep.Angles)[1] = 91;
  EXPECT_FALSE(accepted(steep));
  FastrakRecord shortened = good;
  (*shortened.Quaternion)[0] *= 0.8;
  EXPECT_FALSE(accepted(shortened));
}

TEST(FastrakRecord, AnItemListedTwiceMustAgree)
{
  const FastrakLayout layout = Layout({ 2, 4, 2, 4 });
  std::string bytes =
    EncodeFastrakRecord(MakeRecord({ 100, -200, 300 }, { 30, 40, 50 }), layout, BinaryCentimetres);
  ASSERT_EQ(bytes.size(), 51u);
  EXPECT_TRUE(DecodeFastrakRecord(bytes, layout, BinaryCentimetres));
  for (std::size_t at = 3; at < bytes.size(); ++at)
  {
    std::string damaged = bytes;
    damaged[at] = static_cast<char>(damaged[at] ^ 1);
    EXPECT_FALSE(DecodeFastrakRecord(damaged, layout, BinaryCentimetres)) << at;
  }
}

TEST(FastrakRecord, EveryItemInEveryFormatGivesThePoseBack)
{
  std::mt19937 random(5);
  std::uniform_real_distribution<double> length(-700, 700), turn(-180, 180), tilt(-89, 89);
  for (int round = 0; round < 200; ++round)
  {
    const Vec3 position{ length(random), length(random), length(random) };
    const Vec3 angles{ turn(random), tilt(random), turn(random) };
    const FastrakRecord record = MakeRecord(position, angles, 1 + round % 4);
    const Matrix4 truth = Matrix4::Translation(position) * FastrakRotation(angles);
    for (const auto& numbers : { std::vector<int>{ 2, 4, 1 }, { 2, 11, 0 }, { 16, 5, 6, 7, 2 },
           { 52, 54, 51 }, { 52, 61 }, { 55, 56, 57, 52, 66, 50 }, { 3, 2, 4 } })
    {
      const FastrakLayout layout = Layout(numbers);
      for (const FastrakFormat& format : { AsciiInches, BinaryCentimetres,
             FastrakFormat{ true, LengthUnit::Inch }, { false, LengthUnit::Centimetre } })
      {
        const std::string bytes = EncodeFastrakRecord(record, layout, format);
        ASSERT_EQ(bytes.size(), layout.GetLength(format.Binary));
        const auto read = DecodeFastrakRecord(bytes, layout, format);
        ASSERT_TRUE(read);
        ASSERT_TRUE(read->GetPose());
        EXPECT_EQ(read->Station, record.Station);
        const bool fine = format.Binary || numbers.back() >= 50 || numbers.front() >= 50;
        // half of the last digit: 0.01 inch; 0.01 degrees or 0.0001 in a matrix
        EXPECT_LT(Norm(read->GetPose()->Column(3) - position), fine ? 0.01 : 0.23);
        for (int column = 0; column < 3; ++column)
        {
          EXPECT_LT(
            Norm(read->GetPose()->Column(column) - truth.Column(column)), fine ? 2e-5 : 3e-4);
        }
        EXPECT_NEAR(read->GetPose()->Determinant3(), 1, 1e-12);
        EXPECT_EQ(read->Button.has_value(), numbers[0] == 16 || numbers[0] == 55);
        if (read->RelativePosition)
        {
          EXPECT_NEAR((*read->RelativePosition)[1], -2.54, 0.13); // half of the last digit
        }
      }
    }
  }
}

TEST(FastrakRecord, AnglesTurnInTheOrderOfTheThesis)
{
  // Azimuth turns x to y, elevation takes x down to -z, roll turns y to z.
  EXPECT_LT(Norm(FastrakRotation(Vec3{ 90, 0, 0 }).Column(0) - Vec3{ 0, 1, 0 }), 1e-12);
  EXPECT_LT(Norm(FastrakRotation(Vec3{ 0, 90, 0 }).Column(0) - Vec3{ 0, 0, -1 }), 1e-12);
  EXPECT_LT(Norm(FastrakRotation(Vec3{ 0, 0, 90 }).Column(1) - Vec3{ 0, 0, 1 }), 1e-12);
  // written out for all three
  const double a = 0.5, e = -0.7, r = 1.9;
  const double degree = Pi / 180;
  const Matrix4 m = FastrakRotation(Vec3{ a / degree, e / degree, r / degree });
  using std::cos;
  using std::sin;
  EXPECT_NEAR(m(0, 0), cos(a) * cos(e), 1e-12);
  EXPECT_NEAR(m(1, 0), sin(a) * cos(e), 1e-12);
  EXPECT_NEAR(m(2, 0), -sin(e), 1e-12);
  EXPECT_NEAR(m(0, 1), cos(a) * sin(e) * sin(r) - sin(a) * cos(r), 1e-12);
  EXPECT_NEAR(m(1, 2), sin(a) * sin(e) * cos(r) - cos(a) * sin(r), 1e-12);
  EXPECT_NEAR(m(2, 2), cos(e) * cos(r), 1e-12);
  for (const Vec3& angles : { Vec3{ 30, 90, 0 }, Vec3{ -120, -90, 0 }, Vec3{ 12, 34, -156 } })
  {
    EXPECT_LT(Norm(FastrakAngles(FastrakRotation(angles)) - angles), 1e-6);
  }
  for (const Vec3& angles :
    { Vec3{ 0, 0, 0 }, Vec3{ 180, 0, 0 }, Vec3{ 0, 0, 180 }, Vec3{ 180, 0, 180 } })
  {
    const Matrix4 rotation = FastrakRotation(angles);
    EXPECT_LT(Distance(FastrakRotation(FastrakQuaternion(rotation)), rotation), 1e-12);
  }
}

TEST(FastrakRecord, MirroredAxesAreNoPose)
{
  FastrakRecord record = MakeRecord({ 1, 2, 3 }, { 10, 20, 30 });
  record.Angles.reset();
  record.Quaternion.reset();
  ASSERT_TRUE(record.GetPose());
  record.Axes[2] = -1.0 * *record.Axes[2];
  EXPECT_FALSE(record.GetPose());
}

TEST(FastrakRecord, DamagedAxesAndQuaternionsAreNoPose)
{
  FastrakRecord record = MakeRecord({ 1, 2, 3 }, { 10, 20, 30 });
  record.Angles.reset();
  record.Quaternion.reset();
  record.Axes[0] = *record.Axes[0] + Vec3{ 0, 0.002, 0 };
  EXPECT_FALSE(record.GetPose());

  const FastrakLayout layout({ FastrakItem::Position, FastrakItem::Quaternion });
  const std::string good = EncodeFastrakRecord(MakeRecord({ 1, 2, 3 }, { 0, 0, 90 }), layout, {});
  ASSERT_TRUE(DecodeFastrakRecord(good, layout, {}));
  const std::size_t digit = good.find("0.7071") + 3;
  std::string bad = good;
  bad[digit] = '1'; // 0.7171
  EXPECT_FALSE(DecodeFastrakRecord(bad, layout, {}));
}

TEST(FastrakRecord, NumbersTooLongForTheirColumnsAreRefused)
{
  EXPECT_THROW(EncodeFastrakRecord(MakeRecord({ 0, 0, -30000 }, { 0, 0, 0 }), FastrakLayout(),
                 { false, LengthUnit::Centimetre }),
    std::invalid_argument);
}
