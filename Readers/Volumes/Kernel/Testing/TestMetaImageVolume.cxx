// SPDX-License-Identifier: BSD-3-Clause
#include "Compress.h"
#include "VolumeTesting.h"

using namespace lacuna;
using namespace volume_testing;

namespace
{
// As ITK and 3D Slicer write it, of a patient who lies on the belly, feet first.
SequenceFile MakeVolume()
{
  SequenceFile file;
  file.Set("ObjectType", "Image");
  file.Set("NDims", "3");
  file.Set("BinaryData", "True");
  file.Set("BinaryDataByteOrderMSB", "False");
  file.Set("CompressedData", "False");
  file.Set("TransformMatrix", "0 1 0 0 0 -1 -1 0 0");
  file.Set("Offset", "10 -20 30");
  file.Set("CenterOfRotation", "0 0 0");
  file.Set("AnatomicalOrientation", "ASL");
  file.Set("ElementSpacing", "0.5 1.5 2");
  file.Set("DimSize", "4 3 2");
  file.Set("ElementType", "MET_SHORT");
  file.Pixels = MakeVoxels();
  return file;
}

VolumeFile Read(const SequenceFile& file)
{
  return ReadFile("ct.mha", file.GetContent());
}

void ExpectError(
  const std::string& field, const std::string& value, const std::vector<std::string>& parts)
{
  SequenceFile file = MakeVolume();
  value.empty() ? file.Remove(field) : file.Set(field, value);
  const std::string error = GetFileError("ct.mha", file.GetContent());
  ExpectParts(error, parts);
  ExpectParts(error, { "ct.mha: " });
}
}

TEST(MetaImageVolume, LiesWhereItsMatrixSays)
{
  const VolumeFile volume = Read(MakeVolume());
  EXPECT_TRUE(volume.Warnings.empty());
  EXPECT_FALSE(volume.IsPatient); // PLUS writes the same of coordinates that are no patient's
  EXPECT_EQ(volume.Slices.Type, ScalarType::Int16);
  ExpectPlace(volume, { { 0, 0, 0 } }, { { 10, -20, 30 } });
  ExpectPlace(volume, { { 1, 0, 0 } }, { { 10, -19.5, 30 } });
  ExpectPlace(volume, { { 0, 1, 0 } }, { { 10, -20, 28.5 } });
  ExpectPlace(volume, { { 0, 0, 1 } }, { { 8, -20, 30 } });
}

TEST(MetaImageVolume, VoxelsAreInTheirPlaces)
{
  // all ways of lying along the axes, right- and left-handed, and one across
  std::vector<std::string> matrices{ "0.6 0.8 0 -0.8 0.6 0 0 0 1", "0.6 0.8 0 -0.8 0.6 0 0 0 -1" };
  int order[3] = { 0, 1, 2 };
  do
  {
    for (int signs = 0; signs < 8; ++signs)
    {
      std::string text;
      for (int axis = 0; axis < 3; ++axis)
      {
        for (int k = 0; k < 3; ++k)
        {
          text += order[axis] != k ? "0 " : signs >> axis & 1 ? "-1 " : "1 ";
        }
      }
      matrices.push_back(text);
    }
  } while (std::next_permutation(order, order + 3));
  for (const std::string& matrix : matrices)
  {
    SequenceFile file = MakeVolume();
    file.Set("TransformMatrix", matrix);
    file.Remove("AnatomicalOrientation");
    for (const SequenceFile& stored : { file, Compressed(file) })
    {
      const TemporaryFile kept("ct.mha", stored.GetContent());
      SCOPED_TRACE(matrix);
      ExpectVoxelsInPlace(ReadVolumeFile(kept.GetPath()));
    }
  }
}

TEST(MetaImageVolume, Spellings)
{
  const Matrix4 truth = Read(MakeVolume()).IndexToPatient;
  for (const char* name : { "Rotation", "Orientation", "transformmatrix" })
  {
    SequenceFile file = MakeVolume();
    file.Remove("TransformMatrix");
    file.Set(name, "0 1 0 0 0 -1 -1 0 0");
    ExpectPlace(Read(file), { { 3, 2, 1 } }, truth.Point({ { 3, 2, 1 } }));
  }
  for (const char* name : { "Position", "Origin" })
  {
    SequenceFile file = MakeVolume();
    file.Remove("Offset");
    file.Set(name, "10 -20 30");
    ExpectPlace(Read(file), { { 3, 2, 1 } }, truth.Point({ { 3, 2, 1 } }));
  }
  SequenceFile file = MakeVolume();
  file.Remove("TransformMatrix");
  file.AddLine("TransformMatrix: 0 1 0 0 0 -1 -1 0 0"); // MetaImage's library reads it
  file.Remove("ElementSpacing");
  file.Set("ElementSize", "0.5 1.5 2");
  file.LineEnd = "\r\n";
  ExpectPlace(Read(file), { { 3, 2, 1 } }, truth.Point({ { 3, 2, 1 } }));
  // one volume of a file in time
  file = MakeVolume();
  file.Set("NDims", "4");
  file.Set("DimSize", "4 3 2 1");
  file.Set("TransformMatrix", "0 1 0 0 0 0 -1 0 -1 0 0 0 0 0 0 1");
  file.Set("Offset", "10 -20 30 0");
  file.Set("CenterOfRotation", "0 0 0 0");
  file.Set("ElementSpacing", "0.5 1.5 2 1");
  ExpectPlace(Read(file), { { 3, 2, 1 } }, truth.Point({ { 3, 2, 1 } }));
}

TEST(MetaImageVolume, Units)
{
  const Vec3 truth = Read(MakeVolume()).IndexToPatient.Point({ { 3, 2, 1 } });
  for (const auto& [unit, mm] : { std::pair{ "um", 0.001 }, std::pair{ "mm", 1.0 },
         std::pair{ "cm", 10.0 }, std::pair{ "?", 1.0 } })
  {
    SequenceFile file = MakeVolume();
    file.Set("DistanceUnits", unit);
    ExpectPlace(Read(file), { { 3, 2, 1 } }, mm * truth);
  }
  ExpectError("DistanceUnits", "furlong", { "DistanceUnits is 'furlong'" });
}

TEST(MetaImageVolume, ContradictionsAreTold)
{
  SequenceFile file = MakeVolume();
  file.Set("AnatomicalOrientation", "PSL");
  VolumeFile volume = Read(file);
  ASSERT_EQ(volume.Warnings.size(), 1U);
  ExpectParts(volume.Warnings[0], { "AnatomicalOrientation is 'PSL'", "the matrix is taken" });
  file.Set("AnatomicalOrientation", "???");
  EXPECT_TRUE(Read(file).Warnings.empty());
  file.Set("AnatomicalOrientation", "LPS"); // and no matrix: which of them is right?
  file.Set("TransformMatrix", "1 0 0 0 1 0 0 0 1");
  ExpectParts(GetFileError("ct.mha", file.GetContent()),
    { "AnatomicalOrientation is 'LPS'", "not known which" });
  file.Set("AnatomicalOrientation", "RAI");
  EXPECT_TRUE(Read(file).Warnings.empty());
  file.Set("Orientation", "1 0 0 0 -1 0 0 0 -1");
  ExpectParts(GetFileError("ct.mha", file.GetContent()),
    { "TransformMatrix is '1 0 0", "Orientation", "means the same" });
  file = MakeVolume();
  file.Set("Position", "1 2 3");
  ExpectParts(GetFileError("ct.mha", file.GetContent()), { "Offset is '10 -20 30'", "Position" });
  file = MakeVolume();
  file.Remove("Offset");
  file.Set("CenterOfRotation", "1 0 0");
  volume = Read(file);
  ASSERT_EQ(volume.Warnings.size(), 2U);
  ExpectParts(
    volume.Warnings[0] + volume.Warnings[1], { "first voxel", "CenterOfRotation is '1 0 0'" });
}

TEST(MetaImageVolume, WhatIsMissingOrWrong)
{
  ExpectError("ElementSpacing", "", { "ElementSpacing is missing" });
  ExpectError("ElementSpacing", "0.5 1.5 -2", { "must be positive" });
  ExpectError("ElementSpacing", "0.5 0 2", { "must be positive" });
  ExpectError("ElementSpacing", "0.5 1.5", { "2 numbers" });
  ExpectError("ElementSpacing", "0.5 x 2", { "'x' is no finite number" });
  ExpectError("Offset", "1 2 nan", { "Offset", "'nan'" });
  ExpectError("TransformMatrix", "1 0 0 0 1 0 0 0", { "8 numbers" });
  ExpectError("TransformMatrix", "nan 0 0 0 1 0 0 0 1", { "'nan' is no finite number" });
  ExpectError("TransformMatrix", "2 0 0 0 1 0 0 0 1", { "the length of axis 0 is 2" });
  ExpectError("TransformMatrix", "0 0 0 0 1 0 0 0 1", { "the length of axis 0 is 0" });
  ExpectError("DimSize", "4 3 0", { "DimSize is 4 3 0", "from 1 to" });
  ExpectError("DimSize", "2000000000 2000000000 2000000000", { "no file holds so much" });
  ExpectError("ElementType", "MET_OTHER", { "MET_OTHER" });
  SequenceFile file = MakeVolume();
  file.Set("NDims", "4");
  file.Set("DimSize", "4 3 1 2");
  ExpectParts(
    GetFileError("ct.mha", file.GetContent()), { "several volumes", "Tracked Slice Reader" });
  file.Set("NDims", "2");
  file.Set("DimSize", "4 6");
  ExpectParts(GetFileError("ct.mha", file.GetContent()), { "not a volume" });
  ExpectParts(GetFileError("ct.mhd", "ObjectType = Image\nNDims = 3\n"), { "cut off" });
}

TEST(MetaImageVolume, ValuesByAFunction)
{
  SequenceFile file = MakeVolume();
  file.Set("ElementToIntensityFunctionSlope", "2");
  file.Set("ElementToIntensityFunctionOffset", "-1024");
  const VolumeFile volume = Read(file);
  EXPECT_EQ(volume.Slope, 2);
  EXPECT_EQ(volume.Intercept, -1024);
  ASSERT_EQ(volume.Warnings.size(), 1U);
}

TEST(MetaImageVolume, KindsOfFiles)
{
  const auto kind = [](const SequenceFile& file)
  {
    const TemporaryFile stored("x.mha", file.GetContent());
    return GetImageFileKind(stored.GetPath());
  };
  EXPECT_EQ(kind(MakeVolume()), ImageFileKind::Volume);
  EXPECT_EQ(kind(MakeSequence()), ImageFileKind::Sequence);
  SequenceFile file = MakeSequence();
  file.Set("Kinds", "domain domain domain"); // a reconstruction of PLUS
  EXPECT_EQ(kind(file), ImageFileKind::Volume);
  file = MakeVolume();
  file.Set("DimSize", "4 3");
  EXPECT_EQ(kind(file), ImageFileKind::Other);
  EXPECT_EQ(GetImageFileKind("/nonexistent.mha"), ImageFileKind::Other);
}
