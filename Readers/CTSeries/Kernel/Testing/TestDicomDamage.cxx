// SPDX-License-Identifier: BSD-3-Clause
// One file of a series is damaged at random: whatever comes out is the volume that was there, or it
// is told.
#include "DicomTestFile.h"
#include "lacunaCTGeometry.h"
#include "lacunaCTSeries.h"
#include "lacunaDicomFolder.h"
#include "lacunaHounsfield.h"

#include <gtest/gtest.h>

#include <random>
#include <sstream>

using namespace lacuna;

namespace
{
constexpr int Slices = 5;

std::string MakeSlice(int k)
{
  const std::string z = std::to_string(3 * k - 4);
  return Head("1.2.840.10008.1.2.1") + Short(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.2") +
    Short(0x00080060, "CS", "CT") + Short(0x00100020, "LO", "ID") +
    Short(0x0020000E, "UI", "1.2.3.4") + Short(0x00200013, "IS", std::to_string(k + 1)) +
    Short(0x00200032, "DS", "-11\\7\\" + z) + Short(0x00200037, "DS", "1\\0\\0\\0\\1\\0") +
    Short(0x00200052, "UI", "1.2.3.5") + Short(0x00280010, "US", Number(4, 2)) +
    Short(0x00280011, "US", Number(3, 2)) + Short(0x00280030, "DS", "0.5\\0.75") + Format(8) +
    Short(0x00281052, "DS", "-1000") + Short(0x00281053, "DS", "1") +
    Long(0x7FE00010, "OB", std::string("abcdefghijkl"));
}

struct Outcome
{
  std::string Geometry;
  std::string Told;
};

Outcome Read(const std::string& folder)
{
  Outcome outcome;
  try
  {
    ThreadExecution execution(1);
    DicomFolder files;
    files.Scan(folder, execution);
    const CTSeriesList list = ListSeries(files.GetFrames());
    for (const auto* all : { &files.GetNotes(), &files.GetWarnings(), &list.Notes })
    {
      for (const std::string& text : *all)
      {
        outcome.Told += text + "\n";
      }
    }
    const std::vector<CTFrame>& frames = SelectSeries(list, "", folder, "").Frames;
    CheckSameVolume(frames);
    GetHounsfieldType(frames, -1024);
    const CTGeometry found = FindCTGeometry(frames, {});
    std::ostringstream text;
    text << found.Columns << " " << found.Rows << " " << found.Planes.size();
    for (int i = 0; i < 3; ++i)
    {
      text << " " << found.Origin[i] << " " << found.Spacing[i];
      for (int j = 0; j < 3; ++j)
      {
        text << " " << found.Axes[i][j] + 0.0;
      }
    }
    for (const CTSlice& slice : found.Slices)
    {
      // what each image says of itself, too
      const CTFrame& frame = slice.Frame;
      text << " " << frame.GetName() << " " << (*frame.Position)[0] << " " << (*frame.Position)[1]
           << " " << (*frame.Position)[2] << " " << (*frame.Spacing)[0] << " "
           << (*frame.Spacing)[1] << " " << frame.Header->Format.Signed;
      for (const double x : *frame.Axes)
      {
        text << " " << x + 0.0;
      }
    }
    outcome.Geometry = text.str();
    for (const auto* all : { &found.Notes, &found.Warnings })
    {
      for (const std::string& note : *all)
      {
        outcome.Told += note + "\n";
      }
    }
  }
  catch (const std::runtime_error& e)
  {
    outcome.Told += e.what();
  }
  return outcome;
}

std::string Damage(std::string file, std::mt19937& random)
{
  const auto place = [&] { return 132 + random() % (file.size() - 132); };
  switch (random() % 5)
  {
    case 0: // bytes
      for (int i = 0; i < 2; ++i)
      {
        file[place()] = static_cast<char>(random());
      }
      return file;
    case 1: // a bit
    {
      const std::size_t at = place();
      file[at] = static_cast<char>(file[at] ^ 1 << random() % 8);
      return file;
    }
    case 2: // a character of a number
    {
      const std::size_t at = file.find_first_of("0123456789.-\\", place());
      file[std::min(at, file.size() - 1)] = "0123456789.-\\ "[random() % 14];
      return file;
    }
    case 3: // a piece is lost or there twice
    {
      const std::size_t at = place();
      const std::string piece = file.substr(place(), 1 + random() % 40);
      return random() % 2 == 0 ? file.erase(at, piece.size()) : file.insert(at, piece);
    }
    default: // one element becomes another
    {
      const DicomTag tags[] = { 0x00200032, 0x00200037, 0x00280030, 0x00280010, 0x00280011,
        0x00280008, 0x00080060, 0x0020000E, 0xFFFEE000, 0xFFFEE00D };
      const std::size_t at = file.find(random() % 2 == 0 ? "DS" : "US", place());
      return at == std::string::npos ? file : file.replace(at - 4, 4, Tag(tags[random() % 10]));
    }
  }
}
}

TEST(DicomDamage, ToldOrHarmless)
{
  const Temporary folder;
  for (int k = 0; k < Slices; ++k)
  {
    folder.Write(MakeSlice(k), "IM" + std::to_string(k));
  }
  const Outcome whole = Read(folder.Path.string());
  ASSERT_EQ(whole.Told, "");
  ASSERT_EQ(whole.Geometry.find("3 4 5 -11 0.75 1 0 0 7 0.5 0 1 0 -4 3 0 0 1 IM0"), 0U);
  std::mt19937 random(7);
  int same = 0;
  int told = 0;
  for (int trial = 0; trial < 4000; ++trial)
  {
    const int k = static_cast<int>(random() % Slices);
    const std::string name = "IM" + std::to_string(k);
    const std::string damaged = Damage(MakeSlice(k), random);
    folder.Write(damaged, name);
    const Outcome outcome = Read(folder.Path.string());
    folder.Write(MakeSlice(k), name);
    same += outcome.Geometry == whole.Geometry ? 1 : 0;
    told += outcome.Told.empty() ? 0 : 1;
    EXPECT_TRUE(outcome.Geometry == whole.Geometry || !outcome.Told.empty())
      << "trial " << trial << ", " << name << ": " << outcome.Geometry;
  }
  EXPECT_GT(same, 500); // both happen
  EXPECT_GT(told, 500);
}

// A tag that is there twice leaves open which is meant.
TEST(DicomDamage, Contradictions)
{
  const Temporary folder;
  const auto error = [&](const std::string& bytes)
  {
    try
    {
      return ReadDicomFrames(folder.Write(bytes)).at(0).Header->PixelError;
    }
    catch (const std::runtime_error& e)
    {
      return std::string(e.what());
    }
  };
  const std::string whole = MakeSlice(1);
  const std::size_t place = whole.find(Tag(0x00200052));
  const auto with = [&](const std::string& extra)
  { return whole.substr(0, place) + extra + whole.substr(place); };
  EXPECT_EQ(error(whole), "");
  EXPECT_EQ(error(with(Short(0x00200032, "DS", "-11\\7\\-1"))), "");
  EXPECT_NE(error(with(Short(0x00200032, "DS", "-11\\7\\1")))
              .find("has element (0020,0032) twice with different values"),
    std::string::npos);
  EXPECT_NE(error(with(Implicit(0xFFFEE000, "item"))).find("has (FFFE,E000) outside of a sequence"),
    std::string::npos);
  const std::string group =
    Long(0x52009229, "SQ", Implicit(0xFFFEE000, Short(0x00200032, "DS", "1\\2\\3")));
  EXPECT_NE(error(with(group + group)).find("has sequence (5200,9229) twice"), std::string::npos);
}
