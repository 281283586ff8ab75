// SPDX-License-Identifier: BSD-3-Clause
// What reading takes grows as the bytes of the files: of many elements, items, fragments, frames and series.
#include "CTTestFrames.h"
#include "DicomTestFile.h"
#include "lacunaCTGeometry.h"
#include "lacunaCTSeries.h"
#include "lacunaDoubling.h"
#include "lacunaHounsfield.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

using namespace lacuna;

namespace
{
void ReadAll(std::vector<CTFrame> frames)
{
  try
  {
    const CTSeriesList list = ListSeries(frames);
    list.Describe();
    if (!list.Series.empty())
    {
      frames = SelectAcquisition(list.Series[0], -1);
    }
    TakeOutScouts(frames);
    CheckSameVolume(frames);
    FindDoubtsOfSeries(frames);
    CheckRescaleType(frames);
    GetHounsfieldType(frames, -1024);
    CTGeometryOptions options;
    options.InterpolateMissing = true;
    options.SameImage = [](const CTFrame&, const CTFrame&) { return true; };
    FindCTGeometry(frames, options);
  }
  catch (const std::runtime_error&)
  {
  }
}

void ExpectLinear(int size, const std::function<std::string(int)>& make)
{
  const double growth = GetGrowthOfThreeDoublings(size,
    [&](int n) -> std::function<void()>
    {
      const auto folder = std::make_shared<Temporary>();
      const std::string file = folder->Write(make(n));
      return [folder, file]
      {
        try
        {
          ReadAll(ReadDicomFrames(file));
        }
        catch (const std::runtime_error&)
        {
        }
      };
    });
  EXPECT_LT(growth, MostGrowth);
}

void ExpectLinearFrames(int size, const std::function<void(CTFrame&, int)>& change)
{
  const double growth = GetGrowthOfThreeDoublings(size,
    [&](int n) -> std::function<void()>
    {
      std::vector<Vec3> positions;
      for (int i = 0; i < n; ++i)
      {
        positions.push_back({ 0, 0, 0.5 * i });
      }
      std::vector<CTFrame> frames = MakeFrames(positions);
      for (int i = 0; i < n; ++i)
      {
        auto header = std::make_shared<CTFileHeader>(*frames[i].Header);
        header->Modality = "CT";
        header->SeriesUid = "1.2";
        header->Pixels = { { { 0, 70 } } };
        frames[i].Header = header;
        change(frames[i], i);
      }
      return [frames] { ReadAll(frames); };
    });
  EXPECT_LT(growth, MostGrowth);
}

std::string Repeat(int count, const std::function<std::string(int)>& part)
{
  std::string all;
  for (int i = 0; i < count; ++i)
  {
    all += part(i);
  }
  return all;
}

// of one pixel of a byte each
std::string Image(
  int frames, const std::string& before, const std::string& syntax = "1.2.840.10008.1.2.1")
{
  return Head(syntax) + before + Short(0x00280008, "IS", std::to_string(frames)) +
    Short(0x00280010, "US", Number(1, 2)) + Short(0x00280011, "US", Number(1, 2)) + Format(8);
}
const std::string Modality = Short(0x00080060, "CS", "CT") + Short(0x0020000E, "UI", "1.2");
}

TEST(DicomGrowth, Elements)
{
  const auto tag = [](int i, unsigned int group)
  { return (group + 2 * static_cast<unsigned int>(i / 60000)) << 16 | (0x1000U + i % 60000U); };
  ExpectLinear(6000,
    [&](int n)
    {
      return Image(
        1, Modality + Repeat(n, [&](int i) { return Short(tag(i, 0x0012), "LO", "text"); }));
    });
  // two files' worth of the same one, private ones, sequences
  ExpectLinear(6000,
    [&](int n) {
      return Image(1, Modality + Repeat(n, [&](int) { return Short(0x00120010, "LO", "text"); }));
    });
  ExpectLinear(6000,
    [&](int n)
    {
      return Image(
        1, Modality + Repeat(n, [&](int i) { return Short(tag(i, 0x0013), "LO", "text"); }));
    });
  ExpectLinear(6000,
    [&](int n)
    {
      return Image(1,
        Modality +
          Long(0x00081140, "SQ",
            Repeat(n, [](int) { return Implicit(0xFFFEE000, Short(0x00080100, "SH", "CODE")); })));
    });
  ExpectLinear(6000,
    [&](int n)
    {
      return Image(1,
        Modality + Repeat(n, [&](int i) { return Long(tag(i, 0x0012), "SQ", SequenceEnd, true); }));
    });
}

TEST(DicomGrowth, Frames)
{
  // what all frames share is as long as they are many
  ExpectLinear(800,
    [](int n)
    {
      const std::string type = Repeat(n, [](int) { return "A\\"; });
      return Image(n, Short(0x00080008, "CS", type) + Modality + Short(0x00200032, "DS", type)) +
        Long(0x7FE00010, "OW", std::string(static_cast<std::size_t>(n), 'p'));
    });
  ExpectLinear(1000,
    [](int n)
    {
      const std::string groups = Repeat(n,
        [](int i)
        {
          return Implicit(0xFFFEE000,
            Long(0x00209113, "SQ",
              Implicit(0xFFFEE000, Short(0x00200032, "DS", "0\\0\\" + std::to_string(i)))) +
              Long(0x00209116, "SQ",
                Implicit(0xFFFEE000, Short(0x00200037, "DS", "1\\0\\0\\0\\1\\0"))));
        });
      return Image(n,
               Modality + Short(0x00280030, "DS", "1\\1") + Short(0x00281052, "DS", "0") +
                 Short(0x00281053, "DS", "1")) +
        Long(0x52009230, "SQ", groups) +
        Long(0x7FE00010, "OW", std::string(static_cast<std::size_t>(n), 'p'));
    });
  ExpectLinear(3000,
    [](int n)
    {
      const std::string table =
        Repeat(n / 2, [](int i) { return Number(16 * static_cast<unsigned int>(i), 4); });
      return Image(n / 2, Modality, "1.2.840.10008.1.2.5") +
        Long(0x7FE00010, "OB",
          Implicit(0xFFFEE000, table) + Repeat(n, [](int) { return Implicit(0xFFFEE000, ""); }) +
            SequenceEnd,
          true);
    });
}

TEST(DicomGrowth, Series)
{
  const auto number = [](int i) { return std::to_string(i); };
  const auto set = [](CTFrame& frame, std::string CTFileHeader::*text, const std::string& value)
  {
    auto header = std::make_shared<CTFileHeader>(*frame.Header);
    (*header).*text = value;
    frame.Header = header;
  };
  ExpectLinearFrames(3000, [](CTFrame&, int) {});
  ExpectLinearFrames(
    2000, [&](CTFrame& frame, int i) { set(frame, &CTFileHeader::SeriesUid, "1." + number(i)); });
  ExpectLinearFrames(
    2000, [&](CTFrame& frame, int i) { set(frame, &CTFileHeader::Modality, "M" + number(i)); });
  ExpectLinearFrames(3000,
    [&](CTFrame& frame, int i) { set(frame, &CTFileHeader::ConvolutionKernel, "K" + number(i)); });
  ExpectLinearFrames(
    2000, [&](CTFrame& frame, int i) { set(frame, &CTFileHeader::StudyUid, "1." + number(i)); });
  ExpectLinearFrames(3000,
    [&](CTFrame& frame, int i) { set(frame, &CTFileHeader::PatientPosition, "P" + number(i)); });
  ExpectLinearFrames(3000, [&](CTFrame& frame, int i) { frame.Acquisition = i; });
  ExpectLinearFrames(3000, [&](CTFrame& frame, int) { frame.Position = Vec3{ 0, 0, 0 }; });
  ExpectLinearFrames(3000,
    [&](CTFrame& frame, int i) {
      frame.Position = Vec3{ 0, 0, 0.5 * (i / 2) };
    });
  ExpectLinearFrames(3000,
    [&](CTFrame& frame, int i) {
      frame.Position = Vec3{ 0, 0, 1e-3 * i * i };
    });
  ExpectLinearFrames(3000,
    [&](CTFrame& frame, int i) {
      frame.Axes = { std::cos(1e-4 * i), std::sin(1e-4 * i), 0, 0, 0, 1 };
    });
  ExpectLinearFrames(3000, [&](CTFrame& frame, int i) { frame.Spacing = { 0.5, 0.8 + 1e-4 * i }; });
}
