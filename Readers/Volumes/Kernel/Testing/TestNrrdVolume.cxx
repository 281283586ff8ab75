// SPDX-License-Identifier: BSD-3-Clause
#include "VolumeTesting.h"

using namespace lacuna;
using namespace volume_testing;

namespace
{
// As 3D Slicer writes it.
NrrdFile MakeVolume()
{
  NrrdFile file;
  file.Set("type", "short");
  file.Set("dimension", "3");
  file.Set("space", "left-posterior-superior");
  file.Set("sizes", "4 3 2");
  file.Set("space directions", "(-0.5,0,0) (0,-1.5,0) (0,0,2)");
  file.Set("kinds", "domain domain domain");
  file.Set("endian", "little");
  file.Set("encoding", "raw");
  file.Set("space origin", "(10,-20,30)");
  file.Pixels = MakeVoxels();
  return file;
}

VolumeFile Read(const NrrdFile& file)
{
  return ReadFile("ct.nrrd", file.GetContent());
}

void ExpectError(
  const std::string& field, const std::string& value, const std::vector<std::string>& parts)
{
  NrrdFile file = MakeVolume();
  value.empty() ? file.Remove(field) : file.Set(field, value);
  ExpectParts(GetFileError("ct.nrrd", file.GetContent()), parts);
}
}

TEST(NrrdVolume, Spaces)
{
  struct Case
  {
    const char* Space;
    Vec3 Signs; ///< to LPS
  };
  for (const Case& c :
    { Case{ "left-posterior-superior", { { 1, 1, 1 } } }, Case{ "LPS", { { 1, 1, 1 } } },
      Case{ "right-anterior-superior", { { -1, -1, 1 } } }, Case{ "RAS", { { -1, -1, 1 } } },
      Case{ "left-anterior-superior", { { 1, -1, 1 } } }, Case{ "Las", { { 1, -1, 1 } } } })
  {
    NrrdFile file = MakeVolume();
    file.Set("space", c.Space);
    file.SetPair("space", "a key, no field");
    const TemporaryFile stored("ct.nrrd", file.GetContent());
    const VolumeFile volume = ReadVolumeFile(stored.GetPath());
    SCOPED_TRACE(c.Space);
    EXPECT_TRUE(volume.IsPatient);
    EXPECT_TRUE(volume.Warnings.empty());
    ExpectPlace(volume, { { 0, 0, 0 } }, { { 10 * c.Signs[0], -20 * c.Signs[1], 30 } });
    ExpectPlace(volume, { { 1, 1, 1 } }, { { 9.5 * c.Signs[0], -21.5 * c.Signs[1], 32 } });
    ExpectVoxelsInPlace(volume);
  }
  ExpectError("space", "scanner-xyz", { "space is 'scanner-xyz'", "known are" });
  ExpectError("space", "3D-left-handed", { "space is '3D-left-handed'" });
  ExpectError("space", "right-anterior-superior-time", { "right-anterior-superior-time" });
  NrrdFile file = MakeVolume();
  file.Set("space", "3D-right-handed");
  EXPECT_FALSE(Read(file).IsPatient);
  EXPECT_EQ(Read(file).Warnings.size(), 1U);
  file.Remove("space");
  file.Set("space dimension", "3");
  EXPECT_FALSE(Read(file).IsPatient);
  ExpectParts(Read(file).Warnings.at(0), { "names no space" });
}

TEST(NrrdVolume, Encodings)
{
  for (const std::string encoding : { "raw", "gzip", "hex", "text", "detached" })
  {
    NrrdFile file = MakeVolume();
    file.Set("encoding", encoding == "detached" ? "raw" : encoding);
    file.Set("space directions", "(0.3,0.4,0) (-1.2,0.9,0) (0,0,-2)"); // left-handed, across
    if (encoding == "detached")
    {
      file.Detached = true;
      file.Set("data file", "ct.raw");
      file.Set("endian", "big");
    }
    std::string bytes = MakeVoxels();
    std::string numbers;
    for (std::size_t i = 0; i < bytes.size(); i += 2)
    {
      numbers += std::to_string(static_cast<unsigned char>(bytes[i]) +
                   256 * static_cast<unsigned char>(bytes[i + 1])) +
        " ";
      if (encoding == "detached")
      {
        std::swap(bytes[i], bytes[i + 1]);
      }
    }
    file.Pixels = encoding == "gzip" ? Gzip(bytes)
      : encoding == "hex"            ? ToHex(bytes)
      : encoding == "text"           ? numbers
                                     : bytes;
    const TemporaryFile stored("ct.nhdr", file.GetContent());
    stored.WriteBeside("ct.raw", bytes);
    SCOPED_TRACE(encoding);
    ExpectVoxelsInPlace(ReadVolumeFile(stored.GetPath()));
  }
  NrrdFile file = MakeVolume();
  file.Detached = true;
  file.Set("data file", "none.raw");
  const TemporaryFile stored("ct.nhdr", file.GetContent());
  const VolumeFile volume = ReadVolumeFile(stored.GetPath());
  ExpectParts(GetError([&] { PixelSource::Open(volume.Slices); }), { "none.raw", "no such file" });
}

TEST(NrrdVolume, Units)
{
  const Vec3 truth = Read(MakeVolume()).IndexToPatient.Point({ { 3, 2, 1 } });
  NrrdFile file = MakeVolume();
  file.Set("space units", "\"mm\" \"mm\" \"mm\"");
  ExpectPlace(Read(file), { { 3, 2, 1 } }, truth);
  file.Set("space units", "\"um\" \"\xC2\xB5m\" \"m\"");
  ExpectPlace(
    Read(file), { { 3, 2, 1 } }, { { 0.001 * truth[0], 0.001 * truth[1], 1000 * truth[2] } });
  ExpectError("space units", "\"mm\" \"mm\" \"inch\"", { "space units", "known are" });
  ExpectError("space units", "mm mm mm", { "3 units in double quotes" });
  ExpectError("units", "\"cm\" \"cm\" \"cm\"", { "units is", "space units" });
}

TEST(NrrdVolume, WithoutDirections)
{
  NrrdFile file = MakeVolume();
  file.Remove("space directions");
  file.Remove("space origin");
  file.Remove("space");
  file.Set("spacings", "0.5 1.5 2");
  file.Set("units", "\"mm\" \"mm\" \"cm\"");
  const VolumeFile volume = Read(file);
  ExpectPlace(volume, { { 1, 1, 1 } }, { { 0.5, 1.5, 20 } });
  EXPECT_FALSE(volume.IsPatient);
  ExpectParts(volume.Warnings.at(0), { "does not say where" });
  for (const auto& [name, value] : { std::pair{ "space", "RAS" },
         std::pair{ "space origin", "(1,2,3)" }, std::pair{ "axis mins", "1 2 3" } })
  {
    NrrdFile other = file;
    other.Set(name, value);
    ExpectParts(
      GetFileError("ct.nrrd", other.GetContent()), { name, value, "no space directions" });
  }
  file.Set("axis mins", "nan nan nan");
  EXPECT_EQ(Read(file).Warnings.size(), 1U);
  file.Set("spacings", "0.5 -1.5 2");
  ExpectParts(GetFileError("ct.nrrd", file.GetContent()), { "must be positive" });
  file.Remove("spacings");
  ExpectParts(GetFileError("ct.nrrd", file.GetContent()), { "size of a voxel is unknown" });
}

TEST(NrrdVolume, Components)
{
  for (const char* kinds : { "RGB-color domain domain domain", "vector domain domain domain",
         "??? domain domain domain", "" })
  {
    NrrdFile file = MakeVolume();
    file.Set("dimension", "4");
    file.Set("sizes", "3 4 3 2");
    file.Set("space directions", "none (0.5,0,0) (0,1.5,0) (0,0,2)");
    file.Set("kinds", kinds);
    if (!*kinds)
    {
      file.Remove("kinds");
    }
    const VolumeFile volume = Read(file);
    EXPECT_EQ(volume.Slices.Channels, 3) << kinds;
    EXPECT_EQ(volume.Slices.Frames, 2) << kinds;
    ExpectPlace(volume, { { 1, 1, 1 } }, { { 10.5, -18.5, 32 } });
  }
}

TEST(NrrdVolume, SeveralVolumes)
{
  NrrdFile file = MakeVolume();
  file.Set("dimension", "4");
  file.Set("space directions", "(0.5,0,0) (0,1.5,0) (0,0,2) none");
  file.Set("sizes", "4 3 1 2");
  for (const char* kinds : { "domain domain domain list", "domain domain domain time", "" })
  {
    file.Set("kinds", kinds);
    if (!*kinds)
    {
      file.Remove("kinds");
    }
    ExpectParts(GetFileError("ct.nrrd", file.GetContent()), { "several volumes" });
  }
  file.Set("kinds", "list domain domain domain");
  ExpectParts(GetFileError("ct.nrrd", file.GetContent()), { "several volumes" });
  file.Set("kinds", "domain domain domain list"); // of one volume
  file.Set("sizes", "4 3 2 1");
  ExpectPlace(Read(file), { { 1, 1, 1 } }, { { 10.5, -18.5, 32 } });
}

TEST(NrrdVolume, WhatIsWrong)
{
  ExpectError("space directions", "(1,0,0) (0,1,0)", { "a vector for each of the 3 axes" });
  ExpectError("space directions", "(1,0,0) none (0,1,0)", { "a vector for each of the 3 axes" });
  ExpectError("space directions", "(1,0) (0,1) (0,0)", { "2 numbers" });
  ExpectError("space directions", "(nan,0,0) (0,1,0) (0,0,1)", { "'nan'" });
  ExpectError("space directions", "1 0 0 0 1 0 0 0 1", { "vectors of three numbers" });
  ExpectError("space origin", "(1,2)", { "2 numbers" });
  ExpectError("space origin", "none", { "must be one vector" });
  ExpectError("spacings", "1 1 1", { "spacings is '1 1 1' beside space directions" });
  ExpectError("kinds", "domain domain 3D-matrix", { "3d-matrix" });
  ExpectError("encoding", "bzip2", { "bzip2" });
  ExpectError("sizes", "4 3 9999999999", { "sizes is 4 3 9999999999" });
  NrrdFile file = MakeVolume();
  file.Remove("space origin");
  ExpectParts(Read(file).Warnings.at(0), { "first voxel" });
  for (const char* field : { "dimension", "sizes", "kinds" })
  {
    file.Remove(field);
  }
  file.Set("space directions", "none (1,0,0) (0,1,0) (0,0,1)");
  ExpectParts(GetFileError("ct.nrrd", file.GetContent()), { "sizes is missing" });
}

TEST(NrrdVolume, ValuesBeforeTheyWereStored)
{
  NrrdFile file = MakeVolume();
  file.Set("kinds", "space space space");
  file.Set("oldmin", "-33792"); // Hounsfield units by dcm2niix
  file.Set("oldmax", "31743");
  const VolumeFile volume = Read(file);
  EXPECT_EQ(volume.Slope, 1);
  EXPECT_EQ(volume.Intercept, -1024);
  ExpectParts(volume.Warnings.at(0), { "1 x stored + -1024", "3D Slicer shows the stored" });
  for (const auto& [low, high] : { std::pair{ "NaN", "NaN" }, std::pair{ "-32768", "32767" } })
  {
    file.Set("oldmin", low);
    file.Set("oldmax", high);
    EXPECT_EQ(Read(file).Intercept, 0);
    EXPECT_TRUE(Read(file).Warnings.empty());
  }
  file.Set("oldmin", "x");
  ExpectParts(GetFileError("ct.nrrd", file.GetContent()), { "old min is 'x'" });
}

TEST(NrrdVolume, KindsOfFiles)
{
  const auto kind = [](const NrrdFile& file)
  {
    const TemporaryFile stored("x.nrrd", file.GetContent());
    return GetImageFileKind(stored.GetPath());
  };
  EXPECT_EQ(kind(MakeVolume()), ImageFileKind::Volume);
  EXPECT_EQ(kind(MakeNrrd()), ImageFileKind::Sequence);
}
