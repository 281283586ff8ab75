// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaTemporalCalibration.h"

#include <Eigen/QR>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <stdexcept>
#include <string>

namespace lacuna
{
namespace
{
constexpr std::size_t FewestFrames = 30;
constexpr double SmallestCorrelation = 0.9;
constexpr double StandingStill = 0.5; // mm, standard deviation of the receiver's position
constexpr double CoarseStep = 0.005;  // s, a tenth of the period of the fastest motion of a hand
constexpr int Refinements = 40;
constexpr double OnePeak = 0.05; // s, lags nearer to each other are of one peak
// The squared residuals of any other peak are larger by this. Chance does not do that with dozens of
// frames, what both peaks have in common (the row's rounding, poses between measurements) neither.
constexpr double SureRatio = 2;

using Sample = TemporalCalibration::Sample;

// The receiver's position at any time between its measurements.
class Track
{
public:
  Track(const std::vector<Sample>& samples, double maximumGap)
    : MaximumGap(maximumGap)
  {
    for (const Sample& sample : samples)
    {
      if (sample.HasPose)
      {
        this->Times.push_back(sample.Time);
        this->Positions.push_back(sample.ProbeToTracker.Column(3));
      }
    }
  }
  std::optional<Vec3> At(double time) const
  {
    const auto after = std::lower_bound(this->Times.begin(), this->Times.end(), time);
    if (after == this->Times.end() || (after == this->Times.begin() && *after > time))
    {
      return {};
    }
    const std::size_t i = static_cast<std::size_t>(after - this->Times.begin());
    if (*after == time)
    {
      return this->Positions[i];
    }
    const double gap = this->Times[i] - this->Times[i - 1];
    if (gap > this->MaximumGap)
    {
      return {};
    }
    const double part = (time - this->Times[i - 1]) / gap;
    return (1 - part) * this->Positions[i - 1] + part * this->Positions[i];
  }
  double GetSpread() const
  {
    Vec3 mean{ 0, 0, 0 };
    for (const Vec3& position : this->Positions)
    {
      mean = mean + (1.0 / static_cast<double>(this->Positions.size())) * position;
    }
    double square = 0;
    for (const Vec3& position : this->Positions)
    {
      square += Dot(position - mean, position - mean) / static_cast<double>(this->Positions.size());
    }
    return std::sqrt(square);
  }

private:
  double MaximumGap;
  std::vector<double> Times;
  std::vector<Vec3> Positions;
};

struct Fit
{
  double Correlation = 0;
  double ResidualSquare = 0;
  double SignalSquare = 0;
};

// The frames that have a pose at every lag, so that all lags are judged by the same frames.
std::vector<Sample> GetUsableFrames(
  const std::vector<Sample>& samples, const Track& track, double maximumLag)
{
  std::vector<Sample> usable;
  for (const Sample& sample : samples)
  {
    if (std::isfinite(sample.Value) && track.At(sample.Time - maximumLag) &&
      track.At(sample.Time + maximumLag))
    {
      usable.push_back(sample);
    }
  }
  return usable;
}

// value = a + b . position(time - lag), least squares
Fit FitAt(const std::vector<Sample>& frames, const Track& track, double lag)
{
  std::vector<Vec3> positions;
  std::vector<double> values;
  for (const Sample& frame : frames)
  {
    if (const std::optional<Vec3> position = track.At(frame.Time - lag))
    {
      positions.push_back(*position);
      values.push_back(frame.Value);
    }
  }
  const Eigen::Index count = static_cast<Eigen::Index>(values.size());
  Eigen::MatrixX4d design(count, 4);
  Eigen::VectorXd right(count);
  for (Eigen::Index i = 0; i < count; ++i)
  {
    const Vec3& p = positions[static_cast<std::size_t>(i)];
    design.row(i) << 1, p[0], p[1], p[2];
    right[i] = values[static_cast<std::size_t>(i)];
  }
  // A motion to and fro has no part across it; that must not be made up.
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixX4d> decomposition;
  design.rightCols<3>().rowwise() -= design.rightCols<3>().colwise().mean().eval();
  decomposition.setThreshold(1e-6);
  decomposition.compute(design);
  const Eigen::VectorXd residual = right - design * decomposition.solve(right);
  Fit fit;
  fit.ResidualSquare = residual.squaredNorm();
  fit.SignalSquare = (right.array() - right.mean()).matrix().squaredNorm();
  fit.Correlation =
    fit.SignalSquare > 0 ? std::sqrt(std::max(0.0, 1 - fit.ResidualSquare / fit.SignalSquare)) : 0;
  return fit;
}

std::string Format(const char* format, double value)
{
  char text[200];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

struct Peak
{
  double Lag = 0;
  Fit Best;
};

// The lag between low and high at which the residuals are least.
Peak Refine(const std::vector<Sample>& frames, const Track& track, double low, double high)
{
  for (int i = 0; i < Refinements; ++i)
  {
    const double third = (high - low) / 3;
    if (FitAt(frames, track, low + third).ResidualSquare <
      FitAt(frames, track, high - third).ResidualSquare)
    {
      high -= third;
    }
    else
    {
      low += third;
    }
  }
  Peak peak;
  peak.Lag = 0.5 * (low + high);
  peak.Best = FitAt(frames, track, peak.Lag);
  return peak;
}

// The best peak of the correlations. The weights may have either sign, so a regular motion fits
// itself again after half a cycle, whatever the noise makes the best of these. Throws where another
// peak has residuals hardly larger.
Peak FindOnlyPeak(
  const std::vector<Sample>& frames, const Track& track, const TemporalCalibration& curve)
{
  std::vector<Peak> peaks;
  const std::vector<double>& correlations = curve.Correlations;
  for (std::size_t i = 1; i + 1 < correlations.size(); ++i)
  {
    if (correlations[i] >= SmallestCorrelation && correlations[i] > correlations[i - 1] &&
      correlations[i] >= correlations[i + 1])
    {
      peaks.push_back(Refine(frames, track, curve.Lags[i - 1], curve.Lags[i + 1]));
    }
  }
  const auto better = [](const Peak& a, const Peak& b)
  { return a.Best.ResidualSquare < b.Best.ResidualSquare; };
  const Peak best = *std::min_element(peaks.begin(), peaks.end(), better);
  for (const Peak& other : peaks)
  {
    const double apart = std::abs(other.Lag - best.Lag);
    if (apart > OnePeak && other.Best.ResidualSquare <= SureRatio * best.Best.ResidualSquare)
    {
      const double nearer = std::min(std::abs(best.Lag), std::abs(other.Lag));
      const double farther = std::max(std::abs(best.Lag), std::abs(other.Lag));
      std::string advice = "move less regularly, in speed and width";
      if (farther - nearer > OnePeak)
      {
        advice += Format(", or, if the lag is known to be less than %.2f s, set MaximumLag to that",
          0.5 * (nearer + farther));
      }
      throw std::invalid_argument(Format("the motion is so regular that two lags fit alike, %.3f s",
                                    std::min(best.Lag, other.Lag)) +
        Format(
          " and %.3f s, as after half a cycle or a whole one: ", std::max(best.Lag, other.Lag)) +
        advice + " (TimeOffset has the other sign than the lag)");
    }
  }
  return best;
}
}

TemporalCalibration TemporalCalibration::Solve(
  const std::vector<Sample>& samples, double maximumLag, double maximumGap)
{
  MaximumLagRange.Check("MaximumLag", maximumLag);
  for (std::size_t i = 0; i < samples.size(); ++i)
  {
    if (!std::isfinite(samples[i].Time) || (i > 0 && samples[i].Time <= samples[i - 1].Time))
    {
      throw std::invalid_argument("the time of slice " + std::to_string(i) +
        (std::isfinite(samples[i].Time) ? " is not after that of the slice before"
                                        : " is not finite"));
    }
  }
  const Track track(samples, maximumGap);
  const std::vector<Sample> frames = GetUsableFrames(samples, track, maximumLag);
  if (frames.size() < FewestFrames)
  {
    throw std::invalid_argument("only " + std::to_string(frames.size()) +
      " slices show the floor and have poses on both sides as far as MaximumLag; at least " +
      std::to_string(FewestFrames) + " are needed: record some ten seconds of motion");
  }
  if (track.GetSpread() < StandingStill)
  {
    throw std::invalid_argument(
      Format("the probe stands still: its position varies by %.2g mm; move it to and fro by some "
             "20 mm, about once in a second",
        track.GetSpread()));
  }

  TemporalCalibration result;
  result.Frames = frames.size();
  const int steps = static_cast<int>(std::ceil(maximumLag / CoarseStep));
  std::size_t best = 0;
  for (int step = -steps; step <= steps; ++step)
  {
    result.Lags.push_back(maximumLag * step / steps);
    result.Correlations.push_back(FitAt(frames, track, result.Lags.back()).Correlation);
    if (result.Correlations.back() > result.Correlations[best])
    {
      best = result.Correlations.size() - 1;
    }
  }
  if (result.Correlations[best] < SmallestCorrelation)
  {
    throw std::invalid_argument(Format("image and tracker do not move together: their correlation "
                                       "is %.2f at best",
                                  result.Correlations[best]) +
      Format(" (at %.3f s); is the floor seen in all slices, and is the motion one to and fro?",
        result.Lags[best]));
  }
  if (best == 0 || best + 1 == result.Lags.size())
  {
    throw std::invalid_argument(
      Format("the correlation still grows at the end of the range, %.3f s: raise MaximumLag, or "
             "move less regularly, so that one cycle cannot be taken for the next",
        result.Lags[best]));
  }
  const Peak peak = FindOnlyPeak(frames, track, result);
  result.Lag = peak.Lag;
  result.Correlation = peak.Best.Correlation;
  const double count = static_cast<double>(frames.size());
  result.Amplitude = std::sqrt(peak.Best.SignalSquare / count);
  // The residuals' square grows by the variance of one residual within a standard deviation.
  const double away = CoarseStep;
  const double growth = 0.5 *
      (FitAt(frames, track, result.Lag - away).ResidualSquare +
        FitAt(frames, track, result.Lag + away).ResidualSquare) -
    peak.Best.ResidualSquare;
  result.Spread =
    growth > 0 ? away * std::sqrt(peak.Best.ResidualSquare / (count - 5) / growth) : 0;
  return result;
}
}
