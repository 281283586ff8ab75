// SPDX-License-Identifier: BSD-3-Clause
// Readers, of files that are sound, damaged at random places or nothing of the kind. Headers have fuzz
// targets of their own (Testing/Fuzz).
#include "lacunaSubject.h"
#include "lacunaTrial.h"
#include "vtkLacunaOutlineReader.h"
#include "vtkLacunaPhantomSweep.h"
#include "vtkLacunaTrackedSliceReader.h"
#include "vtkLacunaTrackedSliceWriter.h"
#include "vtkLacunaVolumeReader.h"
#ifdef LACUNA_WITH_CT_SERIES
#include "CTTestSeries.h"
#include "vtkLacunaCTSeriesReader.h"
#endif

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include <unistd.h>

namespace lacunaProperties
{
namespace
{
std::string InFolder(const std::string& name)
{
  return GetOutputFolder() + "/" + std::to_string(getpid()) + "-" + name;
}

std::string Load(const std::string& path)
{
  std::ifstream file(path, std::ios::binary);
  return { std::istreambuf_iterator<char>(file), {} };
}

void Store(const std::string& path, const std::string& content)
{
  std::ofstream(path, std::ios::binary) << content;
}

/// Cuts the content off, or writes over some of it.
std::string Damage(std::string content, Dice& dice)
{
  const auto anywhere = [&] { return dice.Whole(0, static_cast<int>(content.size()) - 1); };
  if (dice.Chance(0.3))
  {
    content.resize(anywhere());
    return content;
  }
  for (int n = dice.Whole(1, 20); n > 0; --n)
  {
    content[anywhere()] = dice.Pick({ '0', '9', '-', ' ', '\n', '=', '\0', '\x7f', '\xff' });
  }
  return content;
}

/// Damages one of the files, which stays as it is; gives the other's name.
std::string MakeDamaged(const std::string& path, Dice& dice)
{
  const std::filesystem::path original(path);
  const std::string damaged = InFolder("damaged" + original.extension().string());
  Store(damaged, Damage(Load(path), dice));
  return damaged;
}

/// What is there, but no file of the kind, or not there.
std::string GetStrangeFile(Dice& dice)
{
  const std::string empty = InFolder("empty.mha");
  Store(empty, "");
  return dice.Pick<std::string>(
    { InFolder("missing.mha"), empty, "/dev/null", GetOutputFolder(), "/", "", "\t\n" });
}

const std::vector<std::string>& GetSequences()
{
  static const std::vector<std::string> files = []
  {
    const std::vector<std::string> made = { InFolder("raw.igs.mha"), InFolder("compressed.mha"),
      InFolder("detached.nhdr"), InFolder("detached.mhd") };
    vtkNew<vtkLacunaPhantomSweep> sweep;
    sweep->SetNumberOfSlices(6);
    sweep->SetImageSize(12, 10);
    for (const std::string& name : made)
    {
      vtkNew<vtkLacunaTrackedSliceWriter> writer;
      writer->SetInputConnection(sweep->GetOutputPort());
      writer->SetFileName(name.c_str());
      writer->SetCompressionLevel(name == made[0] ? 0 : 4);
      writer->Write();
    }
    return made;
  }();
  return files;
}

const std::string& GetCalibration()
{
  static const std::string file = []
  {
    const std::string name = InFolder("calibration.xml");
    Store(name,
      "<PlusConfiguration><CoordinateDefinitions><Transform From=\"Image\" To=\"Probe\" "
      "Matrix=\"0.1 0 0 0 0 0.2 0 0 0 0 0.15 5 0 0 0 1\"/></CoordinateDefinitions>"
      "</PlusConfiguration>");
    return name;
  }();
  return file;
}

using MakeDamage = std::string (*)(const std::string& sound, Dice& dice);

/// A property of readers: one of the sound files, or what is none.
template <class T>
Property FileName(const std::vector<std::string>& (*getFiles)(), MakeDamage makeDamage)
{
  return Other<T>("FileName",
    [=](T* reader, Dice& dice, bool isHostile)
    {
      const std::string& sound = dice.Pick(getFiles());
      const std::string name = !isHostile ? sound
        : dice.Chance(0.7)                ? makeDamage(sound, dice)
                                          : GetStrangeFile(dice);
      reader->SetFileName(name.c_str());
      return name;
    });
}

/// A volume of 7 x 6 x 5 voxels in three formats, left-handed.
const std::vector<std::string>& GetVolumes()
{
  static const std::vector<std::string> files = []
  {
    const std::vector<std::string> made = { InFolder("volume.nrrd"), InFolder("volume.mha"),
      InFolder("volume.nii") };
    std::string voxels;
    for (int i = 0; i < 210; ++i)
    {
      voxels += static_cast<char>(i);
    }
    Store(made[0],
      "NRRD0004\ntype: uint8\ndimension: 3\nspace: RAS\nsizes: 7 6 5\nspace directions: "
      "(0.6,0.8,0) (-0.8,0.6,0) (0,0,-2)\nspace origin: (1,2,3)\nencoding: raw\n\n" +
        voxels);
    Store(made[1],
      "ObjectType = Image\nNDims = 3\nTransformMatrix = 0.6 0.8 0 -0.8 0.6 0 0 0 -1\nOffset = 1 2 "
      "3\nElementSpacing = 1 1 2\nDimSize = 7 6 5\nElementType = MET_UCHAR\nElementDataFile = "
      "LOCAL\n" +
        voxels);
    std::string header(352, '\0');
    const auto put = [&](std::size_t at, auto value)
    { header.replace(at, sizeof(value), reinterpret_cast<const char*>(&value), sizeof(value)); };
    put(0, std::int32_t{ 348 });
    const std::int16_t sizes[4] = { 3, 7, 6, 5 };
    const float steps[4] = { 1, 1, 1, 2 };
    for (std::size_t i = 0; i < 4; ++i)
    {
      put(40 + 2 * i, sizes[i]);
      put(76 + 4 * i, steps[i]);
    }
    put(70, std::int16_t{ 2 });
    put(108, 352.F);
    put(123, char{ 2 });
    put(252, std::int16_t{ 1 });
    put(254, std::int16_t{ 1 });
    put(280, 1.F); // both matrices say the same
    put(300, 1.F);
    put(320, 2.F);
    header.replace(344, 3, "n+1");
    Store(made[2], header + voxels);
    return made;
  }();
  return files;
}

Subject MakeVolumeReader()
{
  using T = vtkLacunaVolumeReader;
  Subject subject{ "VolumeReader", NewOf<T>, [](Dice&) -> Inputs { return {}; },
    { FileName<T>(GetVolumes, MakeDamaged),
      Whole("NIfTITransform", &T::SetNIfTITransform, 0, 2) } };
  subject.Prepare = [](vtkAlgorithm* algorithm)
  { Cast<T>(algorithm)->SetFileName(GetVolumes()[0].c_str()); };
  return subject;
}

/// Two outlines of 300 points in each of two formats.
const std::vector<std::string>& GetOutlines()
{
  static const std::vector<std::string> files = []
  {
    const std::vector<std::string> made = { InFolder("outlines.csv"), InFolder("Liver.mrk.json") };
    std::string table = "structure,outline,slice,x,y,z\n";
    std::string curves;
    for (const char* const name : { "Liver", "Cyst" })
    {
      curves += std::string(curves.empty() ? "" : ", ") +
        "{\"type\": \"ClosedCurve\", \"coordinateSystem\": \"RAS\", \"name\": \"" + name +
        "\", \"controlPoints\": [";
      for (int i = 0; i < 300; ++i)
      {
        const std::string x = std::to_string(50 * std::cos(i * 0.02));
        const std::string y = std::to_string(40 * std::sin(i * 0.02));
        table.append(name).append(",1,4,").append(x).append(",").append(y).append(",5\n");
        curves.append(i == 0 ? "{" : ", {").append("\"position\": [");
        curves.append(x).append(", ").append(y).append(", 5]}");
      }
      curves += "]}";
    }
    Store(made[0], table);
    Store(made[1], "{\"markups\": [" + curves + "]}\n");
    return made;
  }();
  return files;
}

Subject MakeOutlineReader()
{
  using T = vtkLacunaOutlineReader;
  Subject subject{ "OutlineReader", NewOf<T>, [](Dice&) -> Inputs { return {}; },
    { FileName<T>(GetOutlines, MakeDamaged) } };
  subject.Prepare = [](vtkAlgorithm* algorithm)
  { Cast<T>(algorithm)->SetFileName(GetOutlines()[0].c_str()); };
  return subject;
}

#ifdef LACUNA_WITH_CT_SERIES
const std::vector<std::string>& GetSeries()
{
  static const std::vector<std::string> files = []
  {
    CTTestSeries series;
    series.Columns = 12;
    series.Rows = 10;
    series.Slices = 5;
    series.Write(InFolder("series"));
    series.Step = { 0, 0.4, 2 };
    series.Write(InFolder("tilted"));
    series.Step = { 0, 0, 2 };
    series.Places = { 0, 1, 3, 4, 5 };
    series.Write(InFolder("gap"));
    series.MultiFrame = true;
    series.Places = {};
    const std::string file = series.Write(InFolder("frames")).at(0);
    return std::vector<std::string>{ InFolder("series"), InFolder("tilted"), InFolder("gap"),
      file };
  }();
  return files;
}

/// A series of which one file is damaged.
std::string MakeDamagedSeries(const std::string& sound, Dice& dice)
{
  if (!std::filesystem::is_directory(sound))
  {
    return MakeDamaged(sound, dice);
  }
  const std::string folder = InFolder("damaged-series");
  std::filesystem::remove_all(folder);
  std::filesystem::copy(sound, folder);
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
  {
    files.push_back(entry.path().string());
  }
  std::sort(files.begin(), files.end());
  const std::string& file = dice.Pick(files);
  Store(file, Damage(Load(file), dice));
  return folder;
}

Subject MakeCTSeriesReader()
{
  using T = vtkLacunaCTSeriesReader;
  Subject subject{ "CTSeriesReader", NewOf<T>, [](Dice&) -> Inputs { return {}; },
    { FileName<T>(GetSeries, MakeDamagedSeries),
      Word("SeriesUID", &T::SetSeriesUID, { "", CTTestSeries().SeriesUid }),
      Whole("MissingSlices", &T::SetMissingSlices, 0, 1),
      Whole("GantryTilt", &T::SetGantryTilt, 0, 1), Whole("Acquisition", &T::SetAcquisition, -1, 2),
      Real("PositionTolerance", &T::SetPositionTolerance, 1e-6, 10),
      Real("PaddingValue", &T::SetPaddingValue, -2000, 2000),
      Switch("KeepPatientIdentity", &T::SetKeepPatientIdentity) } };
  subject.Prepare = [](vtkAlgorithm* algorithm)
  { Cast<T>(algorithm)->SetFileName(GetSeries()[0].c_str()); };
  subject.Cost = 4;
  return subject;
}
#endif
}

//------------------------------------------------------------------------------
void AddReaderSubjects(std::vector<Subject>& subjects)
{
  using T = vtkLacunaTrackedSliceReader;
  Subject subject{ "TrackedSliceReader", NewOf<T>, [](Dice&) -> Inputs { return {}; },
    { FileName<T>(GetSequences, MakeDamaged),
      Word("ImageFrame", &T::SetImageFrame, { "Image", "Probe" }),
      Word("ReferenceFrame", &T::SetReferenceFrame, { "Reference", "Tracker", "Probe" }),
      Other<T>("CalibrationFileName",
        [](T* reader, Dice& dice, bool isHostile)
        {
          const std::string& sound = GetCalibration();
          const std::string name = !isHostile ? sound
            : dice.Chance(0.7)                ? MakeDamaged(sound, dice)
                                              : GetStrangeFile(dice);
          reader->SetCalibrationFileName(name.c_str());
          return name;
        }),
      Wholes<2>("FrameRange", &T::SetFrameRange, -1, 7),
      Whole("FrameStride", &T::SetFrameStride, 1, 4),
      Switch("DropInvalidSlices", &T::SetDropInvalidSlices),
      Switch("KeepPatientIdentity", &T::SetKeepPatientIdentity),
      Switch("ReplayInTime", &T::SetReplayInTime),
      Whole("MemoryLimit", &T::SetMemoryLimit, 0, 2) } };
  subject.Prepare = [](vtkAlgorithm* algorithm)
  { Cast<T>(algorithm)->SetFileName(GetSequences()[0].c_str()); };
  subjects.push_back(subject);
  subjects.push_back(MakeVolumeReader());
  subjects.push_back(MakeOutlineReader());
#ifdef LACUNA_WITH_CT_SERIES
  subjects.push_back(MakeCTSeriesReader());
#endif
}
}
