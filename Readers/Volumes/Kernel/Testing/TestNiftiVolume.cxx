// SPDX-License-Identifier: BSD-3-Clause
#include "VolumeTesting.h"
#include "lacunaNiftiVolume.h"

#include <cstring>
#include <limits>

using namespace lacuna;
using namespace volume_testing;

namespace
{
// As dcm2niix writes an axial CT, head first, supine: rows from the bottom, and both matrices.
NiftiHeader MakeHeader()
{
  NiftiHeader header;
  header.Dim = { 3, 4, 3, 2, 1, 1, 1, 1 };
  header.PixDim = { 1, 0.5, 1.5, 2, 0, 0, 0, 0 };
  header.DataType = 4;
  header.VoxelOffset = 352;
  header.Slope = 1;
  header.Units = 10;
  header.QFormCode = 1;
  header.SFormCode = 1;
  header.QOffset = { -10, 20, 30 };
  header.SRows = { { { 0.5, 0, 0, -10 }, { 0, 1.5, 0, 20 }, { 0, 0, 2, 30 } } };
  return header;
}

VolumeFile Make(const NiftiHeader& header, NiftiTransform by = NiftiTransform::Automatic)
{
  return MakeNiftiVolume("ct.nii", header, by);
}

void ExpectError(const NiftiHeader& header, const std::vector<std::string>& parts,
  NiftiTransform by = NiftiTransform::Automatic)
{
  const std::string error = GetError([&] { Make(header, by); });
  ExpectParts(error, parts);
  ExpectParts(error, { "ct.nii: " });
}

// Both matrices of a rotation by an angle (radians) about an axis, left-handed if slices is -1.
NiftiHeader MakeTurned(const Vec3& axis, double angle, double slices)
{
  NiftiHeader header = MakeHeader();
  const Vec3 unit = Normalized(axis);
  const Matrix4 turn = Matrix4::Rotation(axis, angle);
  header.PixDim[0] = slices;
  for (int i = 0; i < 3; ++i)
  {
    const auto at = static_cast<std::size_t>(i);
    header.Quaternion[at] = static_cast<float>(std::sin(angle / 2) * unit[i]);
    for (int k = 0; k < 3; ++k)
    {
      header.SRows[at][static_cast<std::size_t>(k)] =
        turn(i, k) * header.PixDim[static_cast<std::size_t>(k + 1)] * (k == 2 ? slices : 1);
    }
  }
  return header;
}
}

TEST(NiftiVolume, RasBecomesLps)
{
  const VolumeFile volume = Make(MakeHeader());
  EXPECT_TRUE(volume.IsPatient);
  EXPECT_TRUE(volume.Warnings.empty());
  EXPECT_EQ(volume.Slices.Type, ScalarType::Int16);
  EXPECT_EQ(volume.Slices.SkippedBytes, 352);
  ExpectPlace(volume, { { 0, 0, 0 } }, { { 10, -20, 30 } });
  ExpectPlace(volume, { { 1, 1, 1 } }, { { 9.5, -21.5, 32 } });
}

TEST(NiftiVolume, BothMatricesSayTheSame)
{
  for (const double slices : { 1.0, -1.0 })
  {
    for (const double angle : { 0.0, 0.3, 1.5, 3.0, 3.1412, 3.14159265358979 })
    {
      const NiftiHeader header = MakeTurned({ { 1, -2, 0.5 } }, angle, slices);
      SCOPED_TRACE(angle);
      Make(header); // they agree
      const VolumeFile s = Make(header, NiftiTransform::SForm);
      const VolumeFile q = Make(header, NiftiTransform::QForm);
      // near half a turn the 24 bits of the quaternion give no more
      const double rotation = 2e-7 / std::max(std::cos(angle / 2), 4e-4);
      for (const Vec3& corner : { Vec3{ { 0, 0, 0 } }, Vec3{ { 3, 0, 0 } }, Vec3{ { 0, 2, 1 } } })
      {
        EXPECT_LT(Norm(s.IndexToPatient.Point(corner) - q.IndexToPatient.Point(corner)),
          1e-6 + 4 * rotation);
      }
      EXPECT_EQ(s.IndexToPatient.Determinant3() < 0, slices < 0);
    }
  }
}

TEST(NiftiVolume, MatricesThatDiffer)
{
  NiftiHeader header = MakeHeader();
  header.SRows[0][3] = -11;
  header.SFormCode = 2;
  ExpectError(header, { "sform (code 2)", "qform (code 1)", "differ by 1 mm", "NIfTITransform" });
  ExpectPlace(Make(header, NiftiTransform::SForm), { { 0, 0, 0 } }, { { 11, -20, 30 } });
  ExpectPlace(Make(header, NiftiTransform::QForm), { { 0, 0, 0 } }, { { 10, -20, 30 } });
  header.SRows[0][0] = -0.5; // one of them mirrored
  header.SRows[0][3] = -10;
  ExpectError(header, { "differ by 3 mm" });
  header.SRows[0][0] = std::numeric_limits<double>::quiet_NaN();
  ExpectError(header, { "differ by nan mm" });
  header = MakeHeader();
  header.SRows[0][3] = -10.04; // rounded differently
  ExpectPlace(Make(header), { { 0, 0, 0 } }, { { 10.04, -20, 30 } });
}

TEST(NiftiVolume, OneMatrixOrNone)
{
  NiftiHeader header = MakeHeader();
  header.SRows[0][3] = -11;
  header.QFormCode = 0;
  ExpectPlace(Make(header), { { 0, 0, 0 } }, { { 11, -20, 30 } });
  ExpectError(header, { "qform_code is 0" }, NiftiTransform::QForm);
  header.SFormCode = 0;
  ExpectError(header, { "does not say how the patient lies", "sform_code and qform_code are 0" });
  header.QFormCode = 1;
  ExpectPlace(Make(header), { { 0, 0, 0 } }, { { 10, -20, 30 } });
  ExpectError(header, { "sform_code is 0" }, NiftiTransform::SForm);
  header.PixDim[2] = 0;
  ExpectError(header, { "pixdim 2 is 0" });
  header = MakeHeader();
  header.SFormCode = 0;
  header.Quaternion = { 1, 1, 0 };
  ExpectError(header, { "quaternion of qform, 1,1,0" });
  header = MakeHeader();
  header.SFormCode = header.QFormCode = 4;
  EXPECT_FALSE(Make(header).IsPatient);
  ExpectParts(Make(header).Warnings.at(0), { "sform_code is 4", "standard brain" });
  header.SFormCode = header.QFormCode = 2;
  EXPECT_TRUE(Make(header).IsPatient);
}

TEST(NiftiVolume, Units)
{
  const Vec3 truth = Make(MakeHeader()).IndexToPatient.Point({ { 3, 2, 1 } });
  for (const auto& [units, mm] : { std::pair{ 1, 1000.0 }, std::pair{ 2, 1.0 },
         std::pair{ 3, 0.001 }, std::pair{ 8 + 3, 0.001 } })
  {
    NiftiHeader header = MakeHeader();
    header.Units = units;
    ExpectPlace(Make(header), { { 3, 2, 1 } }, mm * truth);
  }
  NiftiHeader header = MakeHeader();
  header.Units = 0;
  ExpectPlace(Make(header), { { 3, 2, 1 } }, truth);
  ExpectParts(Make(header).Warnings.at(0), { "unit of length" });
  header.Units = 5;
  ExpectError(header, { "xyzt_units is 5" });
}

TEST(NiftiVolume, Values)
{
  NiftiHeader header = MakeHeader();
  header.Slope = 2;
  header.Intercept = -1024;
  EXPECT_EQ(Make(header).Slope, 2);
  EXPECT_EQ(Make(header).Intercept, -1024);
  header.Slope = 0;
  EXPECT_EQ(Make(header).Slope, 1);
  EXPECT_EQ(Make(header).Intercept, 0);
  header.Slope = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(Make(header).Slope, 1);
  ExpectParts(Make(header).Warnings.at(0), { "scl_slope" });
  header = MakeHeader();
  header.DataType = 128;
  EXPECT_EQ(Make(header).Slices.Channels, 3);
}

TEST(NiftiVolume, WhatIsNotRead)
{
  NiftiHeader header = MakeHeader();
  header.Dim[0] = 4;
  header.Dim[4] = 20;
  ExpectError(header, { "4 x 3 x 2 x 20", "several volumes" });
  header.Dim[4] = 1;
  Make(header);
  header.Dim[0] = 5;
  header.Dim[5] = 3;
  ExpectError(header, { "several volumes" });
  header = MakeHeader();
  header.Dim[0] = 9;
  ExpectError(header, { "2 to 7 axes" });
  header = MakeHeader();
  header.Dim[2] = -3;
  ExpectError(header, { "4 x -3 x 2" });
  header = MakeHeader();
  header.Dim[1] = header.Dim[2] = header.Dim[3] = 2000000000;
  ExpectError(header, { "no file holds so much" });
  header = MakeHeader();
  header.DataType = 32; // complex
  ExpectError(header, { "type 32" });
  header = MakeHeader();
  // a pair of files has 0; VTK would take the header for voxels, as it would up to 351 and 543
  for (const auto& [version, first] : { std::pair<int, int>{ 1, 352 }, { 2, 544 } })
  {
    header.Version = version;
    for (const int wrong : { 0, first - 4, first - 1 })
    {
      header.VoxelOffset = wrong;
      ExpectError(header,
        { "vox_offset is " + std::to_string(wrong) + ":", "NIfTI-" + std::to_string(version),
          "begin at byte " + std::to_string(first) + " or later" });
    }
    header.VoxelOffset = first;
    EXPECT_EQ(Make(header).Slices.SkippedBytes, first);
  }
}

// A header of NIfTI-2, whose numbers have twice the digits.
TEST(NiftiVolume, ReadsHeadersOfVersion2)
{
  for (const bool bigEndian : { false, true })
  {
    std::string bytes(544, '\0');
    const auto put = [&](std::size_t at, auto value)
    {
      std::string part(sizeof(value), '\0');
      std::memcpy(part.data(), &value, sizeof(value));
      if (bigEndian)
      {
        std::reverse(part.begin(), part.end());
      }
      bytes.replace(at, sizeof(value), part);
    };
    put(0, std::int32_t{ 540 });
    bytes.replace(4, 8, std::string("n+2\0\r\n\032\n", 8));
    put(12, std::int16_t{ 4 });
    const std::int64_t dim[] = { 3, 4, 3, 2 };
    for (std::size_t i = 0; i < 4; ++i)
    {
      put(16 + 8 * i, dim[i]);
      put(104 + 8 * i, i == 0 ? -1.0 : 0.5 * static_cast<double>(i));
    }
    put(168, std::int64_t{ 544 });
    put(176, 1.0);
    put(184, -1024.0);
    put(344, std::int32_t{ 1 });
    put(352, 0.1);
    put(360, 0.2);
    put(368, 0.3);
    put(376, 7.0);
    put(500, std::int32_t{ 2 });
    const TemporaryFile file("ct.nii", bytes);
    const NiftiHeader header = ReadNiftiHeader(file.GetPath());
    EXPECT_EQ(header.Dim[3], 2);
    EXPECT_EQ(header.PixDim[2], 1.0);
    EXPECT_EQ(header.VoxelOffset, 544);
    EXPECT_EQ(header.Version, 2);
    EXPECT_EQ(header.Intercept, -1024);
    EXPECT_EQ(header.QFormCode, 1);
    EXPECT_EQ(header.SFormCode, 0);
    EXPECT_EQ(header.Quaternion[1], 0.2);
    EXPECT_EQ(header.QOffset[0], 7);
    EXPECT_EQ(header.Units, 2);
    EXPECT_EQ(header.BigEndian, bigEndian);
    const VolumeFile volume = Make(header);
    EXPECT_LT(volume.IndexToPatient.Determinant3(), 0); // of qfac
  }
}

TEST(NiftiVolume, WhatIsNoNifti)
{
  for (const std::string& content :
    { std::string(), std::string("x"), std::string(400, 'x'), std::string(600, '\0'),
      std::string("\x1f\x8b"), std::string("\x1f\x8b\x08nonsense"), Gzip("short") })
  {
    const TemporaryFile file("ct.nii.gz", content);
    ExpectParts(GetError([&] { ReadNiftiHeader(file.GetPath()); }), { "ct.nii.gz: " });
  }
}
