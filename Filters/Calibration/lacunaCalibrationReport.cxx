// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaCalibrationReport.h"

#include "lacunaAtomicFile.h"
#include "lacunaParameterText.h"
#include "lacunaProvenance.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace
{
constexpr double LargeRms = 1.5;      // mm; that of Carr's phantom stayed below 0.5
constexpr double RivalRatio = 1.5;    // of the RMS of another solution
constexpr double ManyOutliers = 0.15; // of the picks
constexpr double LargeRatio = 0.02;   // of the spacings, beside the one expected
constexpr double SureRatio = 2;       // standard deviations of it
constexpr double SpeedOfSound = 1540; // m/s, with which scanners count
// mm of the longer side, from probes in blood vessels to beyond all depths
constexpr double SmallestImage = 10, LargestImage = 500;
// mm; beyond, a calibration is of no use
constexpr double HopelessError = 5, HopelessRms = 3;
// With fewer, a position far off may fit as well and be expected to be right.
constexpr std::size_t FewestViews = 10;
constexpr std::uintmax_t LargestFile = 1024 * 1024; // bytes, of those written here
// Of all but this line: what others have changed is not written over.
constexpr const char* HashLine = "\n  Hash: fnv1a:";

std::string Format(const char* format, double a, double b = 0)
{
  char text[160];
  std::snprintf(text, sizeof text, format, a, b);
  return text;
}

const char* GetOutlierAdvice(lacuna::CalibrationTarget target)
{
  switch (target)
  {
    case lacuna::CalibrationTarget::Wall:
      return "look at those with a large Error over the slices (fifth output): is their line the "
             "floor, and not its echo behind it or something before it?";
    case lacuna::CalibrationTarget::Point:
      return "look at those with a large Error over the slices (fifth output): is their spot the "
             "point?";
    case lacuna::CalibrationTarget::Tip:
      return "has the tip slipped in its hole, or is metal near?";
    default:
      return "check which wire is which, and the poses";
  }
}

// Two hyphens would end a comment.
std::string ToComment(std::string text)
{
  for (std::size_t at = text.find("--"); at != std::string::npos; at = text.find("--"))
  {
    text.replace(at, 2, "- -");
  }
  return text;
}
}

//------------------------------------------------------------------------------
lacuna::Vec2 lacuna::CalibrationReport::GetSize() const
{
  return { this->Picture.Size[0] * this->Found.PixelSpacing[0],
    this->Picture.Size[1] * this->Found.PixelSpacing[1] };
}

//------------------------------------------------------------------------------
bool lacuna::CalibrationReport::IsSizePlausible() const
{
  const lacuna::Vec2 size = this->GetSize();
  const double longer = std::max(size[0], size[1]);
  return this->Picture.Size[0] == 0 || (longer >= SmallestImage && longer <= LargestImage);
}

//------------------------------------------------------------------------------
bool lacuna::CalibrationReport::HasRival() const
{
  return this->Found.RunnerUpRms < RivalRatio * this->Found.Rms;
}

//------------------------------------------------------------------------------
std::vector<std::string> lacuna::CalibrationReport::GetAdvice() const
{
  std::vector<std::string> advice;
  if (const std::string refusal = this->GetRefusal(); !refusal.empty())
  {
    advice.push_back("this result is not to be used: " + refusal);
  }
  if (this->HasRival())
  {
    advice.push_back(Format("another position of the image fits nearly as well (RMS %.2f mm): ",
                       this->Found.RunnerUpRms) +
      "the picks do not tell which is right; scan from more sides");
  }
  if (!this->IsSizePlausible())
  {
    const lacuna::Vec2 size = this->GetSize();
    advice.push_back(
      Format("the image would be %.3g mm wide and %.3g mm high: ", size[0], size[1]) +
      "are the tracker's positions in mm" +
      (this->Picture.EstimateScale ? "?" : ", and PixelSpacing, too?"));
  }
  const auto outliers =
    static_cast<double>(std::count(this->Found.Used.begin(), this->Found.Used.end(), false));
  if (outliers > ManyOutliers * static_cast<double>(this->Picks.size()))
  {
    advice.push_back(Format("%.0f", outliers) + " of " + std::to_string(this->Picks.size()) +
      " picks do not agree with the others: " + GetOutlierAdvice(this->Picks.front().Pick.Target));
  }
  if (this->Found.Rms > LargeRms)
  {
    const bool tip = this->Picks.front().Pick.Target == lacuna::CalibrationTarget::Tip;
    advice.push_back(Format("the RMS error of %.2f mm is large; ", this->Found.Rms) +
      "below 1 mm is usual. " +
      (tip
          ? "Did the tip stay in its hole, are positions in mm, and is no metal near the receiver?"
          : "Is the pixel spacing right, are positions in mm, was the probe held "
            "still, is the speed of sound 1540 m/s in this bath, and no metal near the receiver?"));
  }
  if (this->Picture.EstimateScale && this->Picture.Size[0] > 0)
  {
    const double found = this->Found.PixelSpacing[1] / this->Found.PixelSpacing[0];
    const double off = found / this->Picture.ExpectedRatio - 1;
    if (std::abs(off) > LargeRatio && std::abs(off) > SureRatio * this->Found.GetRatioError())
    {
      advice.push_back(
        Format("a row is found to be %.4g times as high as a column is wide, ", found) +
        Format("%.4g is to be expected: ", this->Picture.ExpectedRatio) +
        Format("of a linear probe this would be sound at %.0f m/s instead of 1540. ",
          SpeedOfSound * (1 + off)) +
        "Warm the bath or give PixelSpacing by the scanner's scale, else the wrong scale is "
        "carried "
        "into every sweep; if pixels are not square, give both PixelSpacing and RowSpacing");
    }
  }
  for (const lacuna::CalibrationWeakness& weakness : this->Found.Weaknesses)
  {
    advice.push_back(Format("known to %.1f mm only is ", weakness.Error) + weakness.Motion);
  }
  return advice;
}

//------------------------------------------------------------------------------
std::string lacuna::CalibrationReport::GetRefusal() const
{
  if (this->HasRival())
  {
    return "another position of the image fits nearly as well";
  }
  if (!this->IsSizePlausible())
  {
    return "the image would be smaller or larger than any probe's";
  }
  if (this->Found.Rms > HopelessRms)
  {
    return Format("the RMS error is %.1f mm, above %.0f", this->Found.Rms, HopelessRms);
  }
  if (!(this->Picture.ExpectedError <= HopelessError))
  {
    return Format(
      "the expected error is %.1f mm, above %.0f", this->Picture.ExpectedError, HopelessError);
  }
  if (this->Picture.Size[0] > 0 && this->Found.Views < FewestViews)
  {
    return Format(
             "%.0f views are too few, there must be ", static_cast<double>(this->Found.Views)) +
      std::to_string(FewestViews);
  }
  return {};
}

//------------------------------------------------------------------------------
bool lacuna::CalibrationReport::MayReplace(
  const std::string& fileName, const std::string& from, const std::string& to)
{
  std::error_code none;
  if (!std::filesystem::exists(fileName, none))
  {
    return true;
  }
  if (!std::filesystem::is_regular_file(fileName, none) ||
    std::filesystem::file_size(fileName, none) > LargestFile)
  {
    return false;
  }
  std::ifstream file(fileName, std::ios::binary);
  std::string text(std::istreambuf_iterator<char>(file), {});
  const std::size_t line = text.find(HashLine);
  if (!file || text.empty() || line == std::string::npos)
  {
    return file && text.empty();
  }
  const std::string hash = text.substr(line + std::strlen(HashLine), 16);
  text.erase(line, std::strlen(HashLine) + hash.size());
  return hash == lacuna::HashText(text) &&
    text.find("From=\"" + from + "\" To=\"" + to + "\"") != std::string::npos;
}

//------------------------------------------------------------------------------
void lacuna::CalibrationReport::Write(const std::string& fileName, const char* from,
  const std::string& to, const std::vector<std::string>& advice) const
{
  std::string text = "<!-- Lacuna " + std::string(lacuna::Provenance::GetVersion()) +
    ", Probe Calibration: ExpectedError " +
    Format("%.3f mm, RMS %.3f mm of ", this->Picture.ExpectedError, this->Found.Rms) +
    std::to_string(this->Found.Equations) + " equations, " + std::to_string(this->Found.Views) +
    " views. " + (this->Picture.Size[0] > 0 ? "Image: column, row, 0; mm." : "mm.") + "\n  Advice:";
  for (const std::string& sentence : advice)
  {
    text += "\n  - " + ToComment(sentence);
  }
  text += advice.empty() ? " none" : "";
  const std::size_t line = text.size();
  text += std::string(" -->\n<PlusConfiguration version=\"2.9\">\n  <CoordinateDefinitions>\n    "
                      "<Transform From=\"") +
    from + "\" To=\"" + to + "\" Error=\"" + Format("%.4f", this->Picture.ExpectedError) +
    "\"\n      Matrix=\"";
  for (int row = 0; row < 4; ++row)
  {
    for (int column = 0; column < 4; ++column)
    {
      text += (column   ? " "
                  : row ? "\n        "
                        : "") +
        lacuna::FormatNumber(this->Found.ImageToProbe(row, column));
    }
  }
  text += "\"/>\n  </CoordinateDefinitions>\n</PlusConfiguration>\n";
  text.insert(line, HashLine + lacuna::HashText(text));
  lacuna::WriteFileAtomically(fileName, text);
}
