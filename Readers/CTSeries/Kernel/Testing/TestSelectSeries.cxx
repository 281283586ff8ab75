// SPDX-License-Identifier: BSD-3-Clause
#include "CTTestFrames.h"
#include "lacunaCTSeries.h"

#include <gtest/gtest.h>

#include <functional>
#include <stdexcept>

using namespace lacuna;

namespace
{
// An image of a series, with whatever else the test says of it.
CTFrame MakeFrame(int number, const std::function<void(CTFileHeader&)>& change)
{
  CTFrame frame = MakeFrames({ { 0, 0, static_cast<double>(number) } })[0];
  auto header = std::make_shared<CTFileHeader>(*frame.Header);
  header->File = "/scan/IM" + std::to_string(number);
  header->Modality = "CT";
  header->SeriesUid = "1.2.1";
  change(*header);
  frame.Header = header;
  return frame;
}

// Series 1.2.1 of two images and 1.2.2 of one, the second one first in its number.
std::vector<CTFrame> MakeTwoSeries()
{
  const auto first = [](CTFileHeader& header) { header.SeriesNumber = "7"; };
  const auto second = [](CTFileHeader& header)
  {
    header.SeriesUid = "1.2.2";
    header.SeriesNumber = "3";
    header.SeriesDescription = "bone";
  };
  return { MakeFrame(0, first), MakeFrame(1, second), MakeFrame(2, first) };
}

std::string ErrorOf(const std::function<void()>& what)
{
  try
  {
    what();
  }
  catch (const std::runtime_error& e)
  {
    return e.what();
  }
  return {};
}

bool Has(const std::string& text, const std::string& part)
{
  return text.find(part) != std::string::npos;
}
}

TEST(SelectSeries, TheOnlyOneNeedsNoName)
{
  const CTSeriesList list = ListSeries({ MakeFrame(0, [](CTFileHeader&) {}) });
  EXPECT_EQ(SelectSeries(list, "", "/scan", "").Uid, "1.2.1");
}

TEST(SelectSeries, ByNameOrByTheFileThatWasOpened)
{
  const CTSeriesList list = ListSeries(MakeTwoSeries());
  ASSERT_EQ(list.Series.size(), 2u);
  EXPECT_EQ(list.Series[0].Uid, "1.2.2"); // by number
  EXPECT_EQ(SelectSeries(list, "1.2.1", "/scan", "").Frames.size(), 2u);
  EXPECT_EQ(SelectSeries(list, list.Series[0].Describe(), "/scan", "1.2.1").Uid, "1.2.2");
  EXPECT_EQ(SelectSeries(list, "", "/scan/IM0", "1.2.1").Uid, "1.2.1");
}

TEST(SelectSeries, SaysWhichThereAre)
{
  const CTSeriesList list = ListSeries(MakeTwoSeries());
  const std::string several = ErrorOf([&] { SelectSeries(list, "", "/scan", ""); });
  EXPECT_TRUE(Has(several, "/scan: there are 2 CT series")) << several;
  EXPECT_TRUE(Has(several, "SeriesUID")) << several;
  EXPECT_TRUE(Has(several, "\n  1.2.2  series 3, \"bone\", 1 image of 7 x 5, first file IM1"))
    << several;
  EXPECT_TRUE(Has(several, "\n  1.2.1  series 7, 2 images of 7 x 5, first file IM0")) << several;
  const std::string unknown = ErrorOf([&] { SelectSeries(list, "1.2", "/scan", ""); });
  EXPECT_TRUE(Has(unknown, "there is no CT series 1.2; there are:")) << unknown;
  const std::string opened = ErrorOf([&] { SelectSeries(list, "", "/scan/IM9", "1.2.9"); });
  EXPECT_TRUE(Has(opened, "/scan/IM9: the series of this file has no image for a CT volume"))
    << opened;
  const CTSeriesList none =
    ListSeries({ MakeFrame(4, [](CTFileHeader& h) { h.Modality = "MR"; }) });
  const std::string empty = ErrorOf([&] { SelectSeries(none, "", "/scan", ""); });
  EXPECT_TRUE(Has(empty, "/scan: there is no CT image\n  IM4: left out, it is of modality MR"))
    << empty;
  const CTSeriesList contours =
    ListSeries({ MakeFrame(5, [](CTFileHeader& h) { h.Modality = "RTSTRUCT"; }) });
  const std::string hint = ErrorOf([&] { SelectSeries(contours, "", "/scan", ""); });
  EXPECT_TRUE(
    Has(hint, "it is an RT structure set, not CT (0008,0060); open it with Outline Reader"))
    << hint;
}

// Two kernels at the same places are two volumes; at places of their own they are one.
TEST(SelectSeries, ByKernel)
{
  const auto kernel = [](const char* text)
  { return [text](CTFileHeader& header) { header.ConvolutionKernel = text; }; };
  std::vector<CTFrame> frames = { MakeFrame(0, kernel("BONE PLUS")), MakeFrame(1, kernel("")),
    MakeFrame(2, kernel("BONE PLUS")), MakeFrame(3, kernel("")) };
  EXPECT_EQ(ListSeries(frames).Series.size(), 1u);
  EXPECT_EQ(SelectSeries(ListSeries(frames), "1.2.1", "/scan", "").Frames.size(), 4u);
  frames[1].Position = frames[0].Position;
  frames[3].Position = frames[2].Position;
  const CTSeriesList list = ListSeries(frames);
  ASSERT_EQ(list.Series.size(), 2u);
  EXPECT_EQ(list.Series[0].GetName(), "1.2.1 kernel none");
  EXPECT_EQ(list.Series[1].Describe(), "1.2.1 kernel BONE PLUS  2 images of 7 x 5");
  const auto first =
    [&](const std::string& requested, const std::string& file, const std::string& opened)
  { return SelectSeries(list, requested, file, opened).Frames[0].GetName(); };
  EXPECT_EQ(first("1.2.1 kernel BONE PLUS", "/scan", ""), "IM0");
  EXPECT_EQ(first(list.Series[0].Describe(), "/scan", ""), "IM1");
  EXPECT_EQ(first("", "/scan/IM2", "1.2.1"), "IM0"); // by the file that was opened
  EXPECT_EQ(first("", "/scan/IM3", "1.2.1"), "IM1");
  const std::string several = ErrorOf([&] { SelectSeries(list, "1.2.1", "/scan", ""); });
  EXPECT_TRUE(Has(several, "series 1.2.1 has 2 convolution kernels (0018,1210)")) << several;
  EXPECT_TRUE(Has(several, "\n  1.2.1 kernel BONE PLUS  2 images")) << several;
  const std::string open = ErrorOf([&] { SelectSeries(list, "", "/scan", ""); });
  EXPECT_TRUE(Has(open, "there are 2 CT series; set SeriesUID")) << open;
  for (const char* wrong : { "1.2.1 kernel BONE", "1.2.1 kernel B30" })
  {
    const std::string unknown = ErrorOf([&] { SelectSeries(list, wrong, "/scan", ""); });
    EXPECT_TRUE(Has(unknown, std::string("there is no CT series ") + wrong)) << unknown;
  }
}

TEST(SelectAcquisition, ByNumber)
{
  CTSeries series{ "1.2.1", MakeFrames({ { 0, 0, 0 }, { 0, 0, 1 }, { 0, 0, 2 } }) };
  EXPECT_EQ(SelectAcquisition(series, -1).size(), 3u);
  EXPECT_TRUE(Has(ErrorOf([&] { SelectAcquisition(series, 1); }), "there are: none"));
  series.Frames[0].Acquisition = 4;
  series.Frames[1].Acquisition = 2;
  series.Frames[2].Acquisition = 4;
  const std::vector<CTFrame> four = SelectAcquisition(series, 4);
  ASSERT_EQ(four.size(), 2u);
  EXPECT_EQ(four[1].Header->File, "/scan/IM2");
  const std::string error = ErrorOf([&] { SelectAcquisition(series, 3); });
  EXPECT_TRUE(Has(error, "series 1.2.1 has no image of acquisition 3 (0020,0012); there are: 2 4"))
    << error;
}

TEST(CheckSameVolume, SaysWhatAnImageLacks)
{
  const auto check = [](const std::function<void(CTFrame&, CTFileHeader&)>& change)
  {
    std::vector<CTFrame> frames = MakeFrames({ { 0, 0, 0 }, { 0, 0, 2 } });
    auto header = std::make_shared<CTFileHeader>(*frames[1].Header);
    change(frames[1], *header);
    frames[1].Header = header;
    return ErrorOf([&] { CheckSameVolume(frames); });
  };
  EXPECT_EQ(check([](CTFrame&, CTFileHeader&) {}), "");
  const std::pair<const char*, std::function<void(CTFrame&, CTFileHeader&)>> cases[] = {
    { "is cut off", [](CTFrame&, CTFileHeader& header) { header.PixelError = "is cut off"; } },
    { "(0028,0010)", [](CTFrame&, CTFileHeader& header) { header.Rows = 0; } },
    { "(0020,0032)", [](CTFrame& frame, CTFileHeader&) { frame.Position.reset(); } },
    { "(0020,0037)", [](CTFrame& frame, CTFileHeader&) { frame.Axes.reset(); } },
    { "(0028,0030)",
      [](CTFrame& frame, CTFileHeader&) {
        frame.Spacing = { 0.5, -0.8 };
      } },
    { "has 6 x 5 pixels", [](CTFrame&, CTFileHeader& header) { header.Columns = 6; } },
  };
  for (const auto& [expected, change] : cases)
  {
    const std::string error = check(change);
    EXPECT_TRUE(Has(error, expected) && Has(error, "IM1")) << error;
  }
}

// Frames of one file need positions of their own.
TEST(CheckSameVolume, FramesAtOnePosition)
{
  std::vector<CTFrame> frames = MakeFrames({ { 0, 0, 5 }, { 0, 0, 5 }, { 0, 0, 5 } });
  auto header = std::make_shared<CTFileHeader>(*frames[0].Header);
  header->Frames = 3;
  for (int k = 0; k < 3; ++k)
  {
    frames[k].Header = header;
    frames[k].Number = k;
  }
  const std::string error = ErrorOf([&] { CheckSameVolume(frames); });
  EXPECT_TRUE(Has(error,
    "IM0: has 3 frames (0028,0008), but one Image Position (Patient) (0020,0032) for all of them"))
    << error;
  (*frames[2].Position)[2] = 6; // two at one position may be two acquisitions
  EXPECT_EQ(ErrorOf([&] { CheckSameVolume(frames); }), "");
  frames.erase(frames.begin() + 1);
  EXPECT_EQ(ErrorOf([&] { CheckSameVolume(frames); }), "");
}

// Who the patient is does not get into the sentences.
TEST(FindDoubtsOfSeries, NamesFilesAndTagsOnly)
{
  const auto sex = [](const char* text)
  { return [text](CTFileHeader& header) { header.Patient.Sex = text; }; };
  EXPECT_TRUE(FindDoubtsOfSeries({ MakeFrame(0, sex("")), MakeFrame(1, sex("F")),
                                   MakeFrame(2, sex("")), MakeFrame(3, sex("F")) })
                .empty());
  std::vector<std::string> doubts =
    FindDoubtsOfSeries({ MakeFrame(0, sex("")), MakeFrame(1, sex("F")), MakeFrame(2, sex("M")) });
  ASSERT_EQ(doubts.size(), 1u);
  EXPECT_EQ(doubts[0].rfind("IM2 has another Patient's Sex (0010,0040) than IM1: ", 0), 0u)
    << doubts[0];
  doubts = FindDoubtsOfSeries(
    { MakeFrame(0, [](CTFileHeader& header) { header.Patient.BirthDate = "19500101"; }),
      MakeFrame(1, [](CTFileHeader& header) { header.Patient.BirthDate = "19500102"; }),
      MakeFrame(2, [](CTFileHeader& header) { header.Patient.BirthDate = "19600101"; }),
      MakeFrame(3, [](CTFileHeader& header) { header.PatientPosition = "HFS"; }),
      MakeFrame(4, [](CTFileHeader& header) { header.PatientPosition = "FFS"; }) });
  ASSERT_EQ(doubts.size(), 2u);
  EXPECT_EQ(doubts[0].rfind("IM1 and 1 more have another Patient's Birth Date", 0), 0u)
    << doubts[0];
  EXPECT_FALSE(Has(doubts[0], "19500")) << doubts[0];
  EXPECT_TRUE(Has(doubts[1], "Patient Position (0018,5100) than IM3")) << doubts[1];
  const auto kernel = [](const char* text)
  { return [text](CTFileHeader& header) { header.ConvolutionKernel = text; }; };
  doubts = FindDoubtsOfSeries({ MakeFrame(0, kernel("H30s")), MakeFrame(1, kernel("H60s")),
    MakeFrame(2, kernel("H30s")), MakeFrame(3, kernel("H60s")) });
  ASSERT_EQ(doubts.size(), 1u);
  EXPECT_TRUE(Has(doubts[0],
    "IM1 and 1 more have another Convolution Kernel (0018,1210) than IM0: two scans, or two "
    "reconstructions of one, may"))
    << doubts[0];
}
