// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaItemList.h"
#include "lacunaPoseTable.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

using namespace lacuna;

namespace
{
const double Pi = std::acos(-1.0);
constexpr double NaN = std::numeric_limits<double>::quiet_NaN();

Matrix4 RandomPose(std::mt19937& random)
{
  std::uniform_real_distribution<double> number(-1, 1);
  const Vec3 axis{ number(random), number(random), number(random) };
  return Matrix4::Translation(
           { 100 * number(random), 100 * number(random), 100 * number(random) }) *
    Matrix4::Rotation(axis, 3 * number(random));
}

std::vector<double> ToRow(const Matrix4& m)
{
  return { m.Data(), m.Data() + 16 };
}

void ExpectNear(const Matrix4& a, const Matrix4& b, double tolerance)
{
  for (int i = 0; i < 16; ++i)
  {
    EXPECT_NEAR(a.Data()[i], b.Data()[i], tolerance) << "element " << i;
  }
}

Matrix4 ReadOne(const std::vector<double>& row, const PoseTableOptions& options)
{
  const PoseTable table = ReadPoseTable(row, row.size(), {}, options);
  EXPECT_EQ(table.Usable, std::vector<char>{ 1 });
  EXPECT_TRUE(table.Warnings.empty());
  return table.ToReference.front();
}

template <class Function>
void ExpectError(const Function& function, const std::string& part)
{
  try
  {
    function();
    ADD_FAILURE() << "no error with '" << part << "'";
  }
  catch (const std::runtime_error& e)
  {
    EXPECT_NE(std::string(e.what()).find(part), std::string::npos) << e.what();
  }
}

PoseTableOptions Options(PoseFormat format)
{
  PoseTableOptions options;
  options.Format = format;
  return options;
}

const std::array<PoseTransform, 4> AllTransforms{ PoseTransform::ProbeToReference,
  PoseTransform::ReferenceToProbe, PoseTransform::ImageToReference,
  PoseTransform::ReferenceToImage };
}

TEST(PoseTable, EulerAnglesAreThoseOfTheFastrak)
{
  // Polhemus 3SPACE FASTRAK manual: the direction cosine matrix of azimuth, elevation and roll
  const double a = 0.3;
  const double e = -0.7;
  const double r = 1.1;
  const double degrees = 180 / Pi;
  const Matrix4 expected({ std::cos(a) * std::cos(e),
    std::cos(a) * std::sin(e) * std::sin(r) - std::sin(a) * std::cos(r),
    std::cos(a) * std::sin(e) * std::cos(r) + std::sin(a) * std::sin(r), 1,
    std::sin(a) * std::cos(e), std::cos(a) * std::cos(r) + std::sin(a) * std::sin(e) * std::sin(r),
    std::sin(a) * std::sin(e) * std::cos(r) - std::cos(a) * std::sin(r), 2, -std::sin(e),
    std::cos(e) * std::sin(r), std::cos(e) * std::cos(r), 3, 0, 0, 0, 1 });
  ExpectNear(
    ReadOne({ 1, 2, 3, a * degrees, e * degrees, r * degrees }, Options(PoseFormat::Euler)),
    expected, 1e-15);
}

TEST(PoseTable, TheFormatsAgree)
{
  std::mt19937 random(5);
  for (int n = 0; n < 50; ++n)
  {
    const Matrix4 pose = RandomPose(random);
    ExpectNear(ReadOne(ToRow(pose), Options(PoseFormat::Matrix)), pose, 0);
    std::vector<double> twelve = ToRow(pose);
    twelve.resize(12);
    ExpectNear(ReadOne(twelve, Options(PoseFormat::Matrix)), pose, 0);

    // quaternion of the rotation by its own formula; both signs are the same rotation
    const double trace = pose(0, 0) + pose(1, 1) + pose(2, 2);
    const double w = std::sqrt(std::max(0.0, 1 + trace)) / 2;
    if (w > 0.05)
    {
      std::vector<double> row{ pose(0, 3), pose(1, 3), pose(2, 3),
        (pose(2, 1) - pose(1, 2)) / (4 * w), (pose(0, 2) - pose(2, 0)) / (4 * w),
        (pose(1, 0) - pose(0, 1)) / (4 * w), w };
      ExpectNear(ReadOne(row, Options(PoseFormat::Quaternion)), pose, 1e-12);
      for (int i = 3; i < 7; ++i)
      {
        row[i] *= -1.0009; // rounded, the other sign
      }
      ExpectNear(ReadOne(row, Options(PoseFormat::Quaternion)), pose, 1e-12);
    }
    const double elevation = std::asin(-pose(2, 0));
    ExpectNear(
      ReadOne({ pose(0, 3), pose(1, 3), pose(2, 3), std::atan2(pose(1, 0), pose(0, 0)) * 180 / Pi,
                elevation * 180 / Pi, std::atan2(pose(2, 1), pose(2, 2)) * 180 / Pi },
        Options(PoseFormat::Euler)),
      pose, 1e-12);
  }
}

TEST(PoseTable, UnitsAndDirections)
{
  std::mt19937 random(6);
  const Matrix4 pose = RandomPose(random); // mm
  for (const auto& [unit, mm] :
    { std::pair(LengthUnit::Millimetre, 1.0), std::pair(LengthUnit::Centimetre, 10.0),
      std::pair(LengthUnit::Metre, 1000.0), std::pair(LengthUnit::Inch, 25.4) })
  {
    for (const PoseTransform transform : AllTransforms)
    {
      PoseTableOptions options;
      options.Unit = unit;
      options.Transform = transform;
      options.PixelSpacing = { 0.2, 0.3 }; // rigid also for the image
      const bool backwards = transform == PoseTransform::ReferenceToProbe ||
        transform == PoseTransform::ReferenceToImage;
      Matrix4 written = backwards ? pose.Inverse() : pose;
      for (int r = 0; r < 3; ++r)
      {
        written(r, 3) /= mm;
      }
      ExpectNear(ReadOne(ToRow(written), options), pose, 1e-11);
      if (transform == PoseTransform::ImageToReference ||
        transform == PoseTransform::ReferenceToImage)
      {
        // pixels to the unit
        options.PixelSpacing = { 0, 0 };
        const Matrix4 pixels = pose * Matrix4::Scaling({ 0.2, 0.3, 0.25 });
        Matrix4 inUnit = pixels;
        for (int r = 0; r < 3; ++r)
        {
          for (int c = 0; c < 4; ++c)
          {
            inUnit(r, c) /= mm;
          }
        }
        ExpectNear(ReadOne(ToRow(backwards ? inUnit.Inverse() : inUnit), options), pixels, 1e-11);
      }
    }
  }
}

TEST(PoseTable, RowsWithoutAPoseAreNamed)
{
  const std::vector<double> good = ToRow(Matrix4::Translation({ 1, 2, 3 }));
  std::vector<double> numbers;
  for (int row = 0; row < 12; ++row)
  {
    std::vector<double> values = good;
    if (row == 3)
    {
      values[5] = NaN;
    }
    if (row >= 6 && row <= 8)
    {
      values.assign(16, 0);
    }
    if (row == 10)
    {
      values[3] = std::numeric_limits<double>::infinity();
    }
    numbers.insert(numbers.end(), values.begin(), values.end());
  }
  std::vector<char> refused(12, 0);
  refused[0] = 1;
  const PoseTable table = ReadPoseTable(numbers, 16, refused, PoseTableOptions());
  EXPECT_EQ(table.Usable, (std::vector<char>{ 0, 1, 1, 0, 1, 1, 0, 0, 0, 1, 0, 1 }));
  ASSERT_EQ(table.Warnings.size(), 2u);
  EXPECT_NE(table.Warnings[0].find("row 0"), std::string::npos);
  EXPECT_NE(table.Warnings[1].find("rows 3, 6 to 8, 10"), std::string::npos) << table.Warnings[1];
  EXPECT_TRUE(std::isnan(table.ToReference[3](0, 0)));

  const PoseTable lost =
    ReadPoseTable({ 1, 2, 3, 0, 0, 0, 0 }, 7, {}, Options(PoseFormat::Quaternion));
  EXPECT_EQ(lost.Usable, std::vector<char>{ 0 });
  // six zeros are a pose, but perhaps none was meant
  const PoseTable zero =
    ReadPoseTable(std::vector<double>(12, 0.0), 6, {}, Options(PoseFormat::Euler));
  EXPECT_EQ(zero.Usable, (std::vector<char>{ 1, 1 }));
  ExpectNear(zero.ToReference[0], Matrix4(), 0);
  ASSERT_EQ(zero.Warnings.size(), 1u);
  EXPECT_NE(zero.Warnings[0].find("all numbers are 0 in row 1:"), std::string::npos);
}

TEST(PoseTable, WhatIsNoPoseIsRefused)
{
  const auto expect = [](const Matrix4& pose, const std::string& part)
  {
    std::vector<double> numbers = ToRow(Matrix4());
    const std::vector<double> row = ToRow(pose);
    numbers.insert(numbers.end(), row.begin(), row.end());
    ExpectError([&] { ReadPoseTable(numbers, 16, {}, PoseTableOptions()); }, part);
    ExpectError([&] { ReadPoseTable(numbers, 16, {}, PoseTableOptions()); }, "row 1");
    PoseTableOptions backwards;
    backwards.Transform = PoseTransform::ReferenceToProbe;
    ExpectError([&] { ReadPoseTable(numbers, 16, {}, backwards); }, part);
    PoseTableOptions options;
    options.SkipInvalid = true;
    const PoseTable table = ReadPoseTable(numbers, 16, {}, options);
    EXPECT_EQ(table.Usable, (std::vector<char>{ 1, 0 }));
    ASSERT_EQ(table.Warnings.size(), 1u);
    EXPECT_NE(table.Warnings[0].find(part), std::string::npos);
  };
  expect(Matrix4::Scaling({ 1, 1, -1 }), "mirrors");
  expect(Matrix4::Scaling({ -1, 1, 1 }), "mirrors");
  expect(Matrix4::Scaling({ 1.02, 1, 1 }), "not rigid");
  expect(Matrix4::FromColumns({ 1, 0, 0 }, { 0.02, 1, 0 }, { 0, 0, 1 }, {}), "perpendicular");
  expect(Matrix4::FromColumns({ 1, 0, 0 }, { 1, 0, 0 }, { 0, 0, 1 }, {}), "singular");
  expect(Matrix4({ 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1 }), "transposed");
  expect(Matrix4({ 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 2 }), "0 0 0 2, not 0 0 0 1");
  expect(Matrix4::Translation({ 0, 1.1e6, 0 }), "more than a kilometre away");
  expect(Matrix4::Translation({ 1e308, 1e308, 1e308 }), "more than a kilometre away");
  EXPECT_NO_THROW(ReadOne(ToRow(Matrix4::Translation({ 0, 9e5, 0 })), PoseTableOptions()));
  const PoseTable rounded =
    ReadPoseTable(ToRow(Matrix4::Scaling({ 1.005, 1, 1 })), 16, {}, PoseTableOptions());
  EXPECT_EQ(rounded.Usable, std::vector<char>{ 1 });
  ASSERT_EQ(rounded.Warnings.size(), 1u);
  EXPECT_NE(rounded.Warnings[0].find("the pose in row 0 may be wrong"), std::string::npos);

  for (const double length : { 0.98, 1.02, 2.0 })
  {
    ExpectError(
      [&] {
        ReadPoseTable({ 0, 0, 0, 0, length, 0, 0 }, 7, {}, Options(PoseFormat::Quaternion));
      },
      "it has a quaternion of length");
  }
}

// Finite numbers whose inverse is not.
TEST(PoseTable, AnInverseThatIsNotFiniteIsFlagged)
{
  PoseTableOptions options;
  options.Transform = PoseTransform::ReferenceToImage;
  std::vector<double> numbers = ToRow(Matrix4::Scaling({ 5, 5, 5 }));
  const std::vector<double> overflow =
    ToRow(Matrix4::Translation({ 1e10, 0, 0 }) * Matrix4::Scaling({ 1e-300, 1, 1 }));
  numbers.insert(numbers.end(), overflow.begin(), overflow.end());
  for (const bool skip : { false, true })
  {
    options.SkipInvalid = skip;
    const PoseTable table = ReadPoseTable(numbers, 16, {}, options);
    EXPECT_EQ(table.Usable, (std::vector<char>{ 1, 0 }));
    EXPECT_FALSE(table.ToReference[1].IsFinite());
    ASSERT_EQ(table.Warnings.size(), 1u);
    EXPECT_NE(table.Warnings[0].find("not finite"), std::string::npos) << table.Warnings[0];
  }
}

TEST(PoseTable, PixelSizesOfImagePoses)
{
  PoseTableOptions options;
  options.Transform = PoseTransform::ImageToReference;
  const std::vector<double> rigid = ToRow(Matrix4());
  ExpectError([&] { ReadPoseTable(rigid, 16, {}, options); }, "set PixelSpacing");
  std::vector<double> numbers = ToRow(Matrix4::Scaling({ 0.2, 0.2, 0.2 }));
  const std::vector<double> other = ToRow(Matrix4::Scaling({ 0.2, 0.21, 0.2 }));
  numbers.insert(numbers.end(), other.begin(), other.end());
  ExpectError([&] { ReadPoseTable(numbers, 16, {}, options); }, "0.2 and 0.2 mm in row 0");
  ExpectError(
    [&] {
      ReadPoseTable(ToRow(Matrix4::Scaling({ 0.2, -0.2, 0.2 })), 16, {}, options);
    },
    "mirrors");
  // of length 1 the third column stands for nothing but a side
  EXPECT_NO_THROW(ReadPoseTable(ToRow(Matrix4::Scaling({ 0.2, 0.2, 1 })), 16, {}, options));
  for (const double size : { 1e-7, 1.1e3, 1e-182, 1e82 })
  {
    ExpectError(
      [&] {
        ReadPoseTable(ToRow(Matrix4::Scaling({ 0.2, size, 0.2 })), 16, {}, options);
      },
      size > 1e-100 ? "mm, which no ultrasound has" : "");
  }
  EXPECT_NO_THROW(ReadPoseTable(ToRow(Matrix4::Scaling({ 0.002, 0.1, 0.051 })), 16, {}, options));
  const PoseTable doubtful =
    ReadPoseTable(ToRow(Matrix4::Scaling({ 0.3, 0.2, 0.2 })), 16, {}, options);
  EXPECT_EQ(doubtful.Usable, (std::vector<char>{ 1 }));
  ASSERT_EQ(doubtful.Warnings.size(), 1u);
  EXPECT_NE(
    doubtful.Warnings[0].find("the pose in row 0 may be wrong (the first one: it has pixels "
                              "of 0.3 x 0.2 mm"),
    std::string::npos);
  options.PixelSpacing = { 0.2, 0.2 };
  ExpectError([&] { ReadPoseTable(numbers, 16, {}, options); }, "not rigid");
}

TEST(PoseTable, ChainOfTheImage)
{
  PoseTableOptions options;
  EXPECT_FALSE(MakePoseChain(options).Calibrated);
  EXPECT_FALSE(MakePoseChain(options).HasImageToProbe);

  options.PixelSpacing = { 0.2, 0.3 };
  const PoseChain spaced = MakePoseChain(options);
  EXPECT_TRUE(spaced.Calibrated);
  EXPECT_EQ(spaced.PixelToPose.Point({ 10, 10, 0 }), (Vec3{ 2, 3, 0 }));

  const Matrix4 rigid = Matrix4::Translation({ 5, 6, 7 }) * Matrix4::Rotation({ 0, 0, 1 }, Pi / 2);
  options.ImageToProbe = rigid;
  const Vec3 p = MakePoseChain(options).PixelToPose.Point({ 10, 10, 0 });
  EXPECT_NEAR(p[0], 5 - 3, 1e-12);
  EXPECT_NEAR(p[1], 6 + 2, 1e-12);
  EXPECT_NEAR(p[2], 7, 1e-12);

  // the same size once more in the matrix changes nothing; another one is an error
  options.ImageToProbe = rigid * Matrix4::Scaling({ 0.2, 0.3, 1 });
  ExpectNear(MakePoseChain(options).PixelToPose, options.ImageToProbe, 0);
  options.PixelSpacing = { 0, 0 };
  ExpectNear(MakePoseChain(options).PixelToPose, options.ImageToProbe, 0);
  options.PixelSpacing = { 0.2, 0.2 };
  ExpectError([&] { MakePoseChain(options); }, "twice and differently");
  options.PixelSpacing = { 0, 0 };
  options.ImageToProbe = rigid;
  ExpectError([&] { MakePoseChain(options); }, "set PixelSpacing");
  for (const Vec2 spacing : { Vec2{ -1, 1 }, Vec2{ 0, 1 }, Vec2{ NaN, 1 } })
  {
    options.PixelSpacing = spacing;
    ExpectError([&] { MakePoseChain(options); }, "PixelSpacing is");
  }
  options.PixelSpacing = { 0.2, 0.2 };
  options.ImageToProbe = Matrix4::Scaling({ 1, 1, -1 });
  ExpectError([&] { MakePoseChain(options); }, "ImageToProbe is no calibration: it mirrors");
  options.ImageToProbe = Matrix4::Scaling({ 1, 1, NaN });
  ExpectError([&] { MakePoseChain(options); }, "not finite");

  options.PixelSpacing = { 0.2, 20 };
  options.ImageToProbe = Matrix4();
  ExpectError([&] { MakePoseChain(options); }, "PixelSpacing has pixels of 0.2 x 20 mm");
  options.PixelSpacing = { 0, 0 };
  options.ImageToProbe =
    Matrix4::FromColumns({ 0.2, 0, 0 }, { 0.15, 0.2, 0 }, { 0, 0, 0.2 }, { 0, 0, 0 });
  ExpectError([&] { MakePoseChain(options); }, "it is skewed: rows and columns meet at 53.1301");
  options.ImageToProbe = Matrix4::Scaling({ 0.3, 0.2, 0.2 });
  EXPECT_NE(MakePoseChain(options).Warning.find("ImageToProbe may be wrong: it has pixels"),
    std::string::npos);

  // poses of the image: the calibration is only known
  options.PixelSpacing = { 0.2, 0.2 };
  options.Transform = PoseTransform::ImageToReference;
  options.ImageToProbe = rigid;
  const PoseChain image = MakePoseChain(options);
  EXPECT_TRUE(image.Calibrated && image.HasImageToProbe);
  EXPECT_EQ(image.PixelToPose.Point({ 10, 0, 0 }), (Vec3{ 2, 0, 0 }));
  options.ImageToProbe = Matrix4();
  EXPECT_FALSE(MakePoseChain(options).HasImageToProbe);
  options.PixelSpacing = { 0, 0 };
  options.Format = PoseFormat::Euler;
  ExpectError([&] { MakePoseChain(options); }, "set PixelSpacing");
}

TEST(PoseTable, PosesBetween)
{
  const Matrix4 first = Matrix4::Translation({ 1, 0, 0 }) * Matrix4::Rotation({ 1, 2, 3 }, 0.4);
  const Matrix4 second = Matrix4::Translation({ 3, 4, 0 }) * Matrix4::Rotation({ 1, 2, 3 }, 0.4) *
    Matrix4::Rotation({ -1, 0, 2 }, 1.2);
  ExpectNear(InterpolatePose(first, second, 0), first, 1e-12);
  ExpectNear(InterpolatePose(first, second, 1), second, 1e-12);
  ExpectNear(InterpolatePose(first, second, 0.25),
    Matrix4::Translation({ 1.5, 1, 0 }) * Matrix4::Rotation({ 1, 2, 3 }, 0.4) *
      Matrix4::Rotation({ -1, 0, 2 }, 0.3),
    1e-12);
  // half a turn about each axis, where one part of the quaternion is 0
  for (const Vec3 axis : { Vec3{ 1, 0, 0 }, Vec3{ 0, 1, 0 }, Vec3{ 0, 0, 1 } })
  {
    ExpectNear(InterpolatePose(Matrix4(), Matrix4::Rotation(axis, Pi - 1e-9), 0.5),
      Matrix4::Rotation(axis, Pi / 2), 1e-8);
  }
  ExpectNear(InterpolatePose(first, first, 0.7), first, 1e-12);
  const Matrix4 scale = Matrix4::Scaling({ 0.2, 0.3, 0.25 });
  ExpectNear(InterpolatePose(first * scale, second * scale, 0.25),
    InterpolatePose(first, second, 0.25) * scale, 1e-12);
}

TEST(PoseTable, ItemsInMessages)
{
  EXPECT_EQ(DescribeItems("row", { 4 }), "row 4");
  EXPECT_EQ(DescribeItems("row", { 4, 5 }), "rows 4, 5");
  EXPECT_EQ(DescribeItems("row", { 1, 4, 5, 6, 9 }), "rows 1, 4 to 6, 9");
  std::vector<std::size_t> many;
  for (std::size_t i = 0; i < 30; i += 2)
  {
    many.push_back(i);
  }
  EXPECT_EQ(DescribeItems("slice", many), "slices 0, 2, 4, 6, 8, 10, 12, 14 and 7 more");
}
