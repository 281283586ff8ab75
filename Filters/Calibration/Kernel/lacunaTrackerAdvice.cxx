// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaTrackerSelfTest.h"

#include <cmath>
#include <cstdio>
#include <optional>

namespace lacuna
{
namespace
{
constexpr double Warped = 1.5;  // times the expected RMS
constexpr double Wild = 3;      // times the expected RMS: of a million pairs, four err by chance so
constexpr double ComesBack = 2; // warp over repeatability
constexpr double SmallExtent = 300;     // mm
constexpr double SmallSeparation = 100; // mm
constexpr double LargeSeparation = 1000;
constexpr std::size_t FewInRow = 5;

template <class... Numbers>
std::string Format(const char* format, Numbers... numbers)
{
  char text[400];
  std::snprintf(text, sizeof text, format, numbers...);
  return text;
}

// mm from the transmitter from which on all is larger than expected, when nearer it is not.
std::optional<double> FindGoodRange(const TrackerSelfTest& test)
{
  std::optional<double> range;
  bool anyGood = false;
  for (const TrackerSelfTest::DistanceRow& row : test.ByDistance)
  {
    if (row.Samples < FewInRow)
    {
      continue;
    }
    if (row.Rms.Position <= Warped * test.Expected.Position)
    {
      anyGood = true;
      range.reset();
    }
    else if (!range)
    {
      range = row.From;
    }
  }
  // Metal in a far corner is not the distance: that would show in most directions.
  std::size_t beyond = 0, bad = 0;
  for (const TrackerSelfTest::Sample& sample : test.Samples)
  {
    if (range && sample.Distance >= *range)
    {
      ++beyond;
      bad += Norm(sample.Deviation) > test.Expected.Position;
    }
  }
  return anyGood && 2 * bad > beyond ? range : std::nullopt;
}

// What to do about errors that are larger than specified (off), or to see whether they come back.
void AdviseOnErrors(const TrackerSelfTest& test, bool off, std::vector<std::string>& advice)
{
  const std::optional<double> range = FindGoodRange(test);
  if (range)
  {
    advice.push_back(Format("errors are as specified up to %.0f mm from the transmitter and larger "
                            "beyond: bring the transmitter nearer to where you scan",
      *range));
  }
  else if (off)
  {
    advice.push_back(
      "look for metal near that place and near the transmitter (bed, trolley, table legs, scanner, "
      "reinforced floor) and for power cables and screens; move it or the transmitter away and "
      "test again");
  }
  if (std::isnan(test.Repeatability))
  {
    advice.push_back("no place was visited twice: go back to some of them, so that a warp can be "
                     "told from noise");
  }
  else if (off && test.Warp > ComesBack * test.Repeatability)
  {
    advice.push_back(
      Format("the deviations come back to %.1f mm where the receivers do: a warp and "
             "no noise, so short sweeps in one place suffer less than what is put "
             "together of many",
        test.Repeatability));
  }
  else if (off)
  {
    advice.push_back(Format(
      "the deviations differ by %.1f mm where the receivers come back: hold them still while "
      "measuring, and check that they cannot move on their support",
      test.Repeatability));
  }
}
}

std::vector<std::string> TrackerSelfTest::GetAdvice() const
{
  std::vector<std::string> advice;
  // first: with another unit nothing below holds
  if (this->Separation < SmallSeparation || this->Separation > LargeSeparation)
  {
    advice.push_back(Format(
      "the receivers are %.0f mm apart: fix them as far from each other as the image is from "
      "the receiver, 300 mm, say, and check the unit of length",
      this->Separation));
  }
  const Vec3& worst = this->Samples[this->Worst].Middle;
  const bool warped = this->Rms.Position > Warped * this->Expected.Position;
  const bool wild = this->Largest.Position > Wild * this->Expected.Position;
  const bool off = warped || wild;
  const std::string figures =
    Format("points %.0f mm from a receiver are off by %.1f mm RMS (the specification lets expect "
           "%.1f) and by up to %.1f mm, near (%.0f, %.0f, %.0f) mm of the transmitter",
      this->Separation, this->Rms.Position, this->Expected.Position, this->Largest.Position,
      worst[0], worst[1], worst[2]);
  advice.push_back((warped    ? "the tracker warps space here: "
                       : wild ? "the tracker is as specified but in some places: "
                              : "the tracker is as specified: ") +
    figures);
  AdviseOnErrors(*this, off, advice);
  this->AdviseOnMeasuring(advice);
  return advice;
}

// What the measurement itself lacks.
void TrackerSelfTest::AdviseOnMeasuring(std::vector<std::string>& advice) const
{
  std::size_t far = 0;
  for (const Sample& sample : this->Samples)
  {
    far += sample.Distance > this->Options.RangeLimit;
  }
  if (far > 0)
  {
    advice.push_back(Format("%zu of %zu pairs lie further than %.0f mm from the transmitter, for "
                            "which the tracker's accuracy is not specified",
      far, this->Samples.size(), this->Options.RangeLimit));
  }
  if (this->OtherHemisphere > 0)
  {
    advice.push_back(
      Format("%zu pairs were left out, in which a receiver's position has the wrong sign: set the "
             "tracker's hemisphere towards the working volume, and keep all of it on one side of "
             "the transmitter",
        this->OtherHemisphere));
  }
  if (this->TooFast > this->Samples.size())
  {
    advice.push_back(Format("%zu pairs were left out since a receiver moved faster than %.0f mm/s: "
                            "move more slowly",
      this->TooFast, this->Options.SpeedLimit));
  }
  if (this->Extent < SmallExtent)
  {
    advice.push_back(Format("the receivers were moved within %.0f mm only: go through all of the "
                            "volume in which you scan, and turn them",
      this->Extent));
  }
}
}
