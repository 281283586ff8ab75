// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaBoneEcho.h"

#include "lacunaBonePath.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

namespace lacuna
{
namespace
{
constexpr double AlongSigma = 0.3;  // mm, of echoes
constexpr double AcrossSigma = 0.6; // mm, of echoes and shadows
constexpr double EchoLength = 2.5;  // mm from an echo's middle to its shadow
constexpr double DarkPercentile = 0.02;
constexpr double BrightPercentile = 0.99;
constexpr double TissuePercentile = 0.8;
constexpr double LeastTissue = 0.06; // of the bright: tissue at a depth where all is dark
constexpr double Noise = 0.02;       // of the bright
constexpr double EchoPower = 0.7;
constexpr double RelativeShadow[2] = { 0.1, 0.4 }; // shadow by tissue: surely one, and none
constexpr double AbsoluteShadow[2] = { 0.68,
  0.88 };                              // contrast of echo and shadow: none, and surely one
constexpr double StepCost = 0.007;     // for each mm of depth, in mm of beams with full confidence
constexpr double JumpCost = 0.085;     // mm of beams with full confidence
constexpr double LinkDepth = 1.5;      // mm between beams of one piece
constexpr double LinkAcross = 3;       // mm of depth between slices of one piece
constexpr std::size_t MostSlices = 32; // that levels are learned from
constexpr float Unknown = -1;

double SmoothStep(double value, const double (&range)[2])
{
  const double t = std::clamp((value - range[0]) / (range[1] - range[0]), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

float GetPercentile(std::vector<float>& values, double percentile)
{
  const auto at = values.begin() +
    static_cast<std::ptrdiff_t>(percentile * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

// mm between the middles of two slices.
double GetDistance(const SliceImage& a, const SliceImage& b)
{
  const Vec3 middle{ 0.5 * (a.Width - 1), 0.5 * (a.Height - 1), 0 };
  return Norm(a.PixelToReference.Point(middle) - b.PixelToReference.Point(middle));
}

// Pieces of what is connected.
class Pieces
{
public:
  explicit Pieces(std::size_t size)
    : Parents(size)
  {
    std::iota(this->Parents.begin(), this->Parents.end(), std::size_t(0));
  }
  std::size_t Find(std::size_t i)
  {
    while (this->Parents[i] != i)
    {
      this->Parents[i] = this->Parents[this->Parents[i]];
      i = this->Parents[i];
    }
    return i;
  }
  void Join(std::size_t a, std::size_t b)
  {
    a = this->Find(a);
    b = this->Find(b);
    this->Parents[std::max(a, b)] = std::min(a, b);
  }

private:
  std::vector<std::size_t> Parents;
};
}

void BoneEchoOptions::Describe(Properties& properties) const
{
  properties.Add("ShadowLength", this->ShadowLength, ValueRange::Above(0, "mm"))
    .Add("MinimumConfidence", this->MinimumConfidence, ValueRange::Above(0).UpTo(1))
    .Add("MaximumGap", this->MaximumGap, ValueRange::Above(0, "mm").OrZero("none"))
    .Add("MinimumArea", this->MinimumArea, ValueRange::Above(0, "mm^2").OrZero("all"))
    .Add("Thickness", this->Thickness, ValueRange::Above(0, "mm"));
}

// What levels mean in these slices.
struct BoneEcho::Criteria
{
  float Dark = 0;
  float Bright = 0;          ///< above Dark; 0: all is of one grey
  std::vector<float> Tissue; ///< of each sample: the mean of as much as a shadow, above Dark
};

BoneEcho::BoneEcho(
  const std::vector<SliceImage>& slices, const BoneEchoOptions& options, Execution& execution)
  : Grid(slices.empty() ? throw std::invalid_argument("there are no slices to find bone in")
                        : (CheckSlice(slices.front()), slices.front()))
  , Options(options)
{
  Properties properties;
  options.Describe(properties);
  properties.Check();
  for (const SliceImage& slice : slices)
  {
    CheckSlice(slice);
  }
  const Execution::NestedStages stages(execution);
  execution.SetStage(0, 0.2);
  const Criteria criteria = this->Learn(slices, execution);
  execution.SetStage(0.2, 1);
  this->Surfaces.assign(slices.size(), std::vector<float>(this->Grid.GetNumberOfBeams(), Unknown));
  if (criteria.Bright > 0)
  {
    execution.For(static_cast<std::int64_t>(slices.size()), 1,
      [&](std::int64_t begin, std::int64_t end)
      {
        for (std::int64_t i = begin; i < end; ++i)
        {
          this->Surfaces[i] = this->FindLine(slices[i], criteria);
        }
      });
  }
  this->DropSmallPieces(slices);
  for (std::vector<float>& surface : this->Surfaces)
  {
    this->CloseGaps(surface);
  }
}

// From at most MostSlices of the slices, evenly spread.
BoneEcho::Criteria BoneEcho::Learn(
  const std::vector<SliceImage>& slices, Execution& execution) const
{
  const std::size_t count = std::min(slices.size(), MostSlices);
  const std::size_t samples = this->Grid.GetNumberOfSamples();
  const std::size_t beams = this->Grid.GetNumberOfBeams();
  std::vector<std::vector<float>> shadows(count);
  std::vector<float> levels; // every 7th, which meets all depths
  std::vector<std::vector<float>> parts(count);
  execution.For(static_cast<std::int64_t>(count), 1,
    [&](std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t i = begin; i < end; ++i)
      {
        const std::size_t which = static_cast<std::size_t>(i) * slices.size() / count;
        std::vector<float> values = this->Grid.Sample(slices[which]);
        for (std::size_t k = 0; k < values.size(); k += 7)
        {
          const int beam = static_cast<int>(k / samples);
          const int sample = static_cast<int>(k % samples);
          if (sample >= this->Grid.GetBegin(beam) && sample < this->Grid.GetEnd(beam))
          {
            parts[i].push_back(values[k]);
          }
        }
        this->Grid.Smooth(values, 0, AcrossSigma);
        shadows[i] = this->FindShadows(values);
      }
    });
  for (const std::vector<float>& part : parts)
  {
    levels.insert(levels.end(), part.begin(), part.end());
  }
  Criteria criteria;
  if (levels.empty())
  {
    return criteria;
  }
  criteria.Dark = GetPercentile(levels, DarkPercentile);
  criteria.Bright = GetPercentile(levels, BrightPercentile) - criteria.Dark;
  for (std::size_t sample = 0; sample < samples; ++sample)
  {
    std::vector<float> here;
    for (const std::vector<float>& slice : shadows)
    {
      for (std::size_t beam = 0; beam < beams; ++beam)
      {
        const float shadow = slice[beam * samples + sample];
        if (!std::isnan(shadow))
        {
          here.push_back(shadow - criteria.Dark);
        }
      }
    }
    const float least = static_cast<float>(LeastTissue) * criteria.Bright;
    criteria.Tissue.push_back(
      here.empty() ? least : std::max(least, GetPercentile(here, TissuePercentile)));
  }
  return criteria;
}

// Of each sample: the mean level behind an echo that is there. NaN where less than half of it is seen.
std::vector<float> BoneEcho::FindShadows(const std::vector<float>& levels) const
{
  const int samples = this->Grid.GetNumberOfSamples();
  const double step = this->Grid.GetSampleStep();
  const double most = samples;
  const int gap = static_cast<int>(std::min(most, std::round(EchoLength / step)));
  const int length =
    static_cast<int>(std::clamp(std::round(this->Options.ShadowLength / step), 1.0, most));
  std::vector<float> shadows(levels.size(), std::numeric_limits<float>::quiet_NaN());
  std::vector<double> sums(static_cast<std::size_t>(samples) + 1, 0);
  for (int beam = 0; beam < this->Grid.GetNumberOfBeams(); ++beam)
  {
    const std::size_t first = static_cast<std::size_t>(beam) * static_cast<std::size_t>(samples);
    for (int i = 0; i < samples; ++i)
    {
      sums[i + 1] = sums[i] + levels[first + static_cast<std::size_t>(i)];
    }
    const int end = this->Grid.GetEnd(beam);
    for (int i = this->Grid.GetBegin(beam); i < end; ++i)
    {
      const int last = std::min(end, i + gap + length);
      const int seen = last - (i + gap);
      if (seen > 0 && 2 * seen >= length)
      {
        shadows[first + static_cast<std::size_t>(i)] =
          static_cast<float>((sums[last] - sums[i + gap]) / seen);
      }
    }
  }
  return shadows;
}

std::vector<float> BoneEcho::FindLine(const SliceImage& slice, const Criteria& criteria) const
{
  const std::size_t samples = this->Grid.GetNumberOfSamples();
  std::vector<float> levels = this->Grid.Sample(slice);
  this->Grid.Smooth(levels, 0, AcrossSigma);
  const std::vector<float> shadows = this->FindShadows(levels);
  this->Grid.Smooth(levels, AlongSigma, 0);
  std::vector<float> gains(levels.size());
  for (std::size_t i = 0; i < levels.size(); ++i)
  {
    double confidence = 0;
    const double echo = levels[i] - criteria.Dark;
    if (echo > 0 && !std::isnan(shadows[i]))
    {
      const double shadow = std::max(0.0, static_cast<double>(shadows[i] - criteria.Dark));
      const double contrast = (echo - shadow) / (echo + shadow + Noise * criteria.Bright);
      if (contrast > 0)
      {
        const double relative =
          1 - SmoothStep(shadow / criteria.Tissue[i % samples], RelativeShadow);
        confidence = contrast * std::max(relative, SmoothStep(contrast, AbsoluteShadow)) *
          std::pow(echo / criteria.Bright, EchoPower);
      }
    }
    gains[i] = static_cast<float>(confidence - this->Options.MinimumConfidence);
  }
  const double beamStep = this->Grid.GetBeamStep();
  const std::vector<int> path = FindBestPath(gains, static_cast<int>(samples),
    { StepCost * this->Grid.GetSampleStep() / beamStep, JumpCost / beamStep,
      0.5 * JumpCost / beamStep });
  return { path.begin(), path.end() };
}

void BoneEcho::DropSmallPieces(const std::vector<SliceImage>& slices)
{
  const std::size_t beams = this->Grid.GetNumberOfBeams();
  const double step = this->Grid.GetSampleStep();
  Pieces pieces(slices.size() * beams);
  std::vector<double> widths(slices.size(), 0); // half of the ways to both neighbours
  const auto join = [&](std::size_t s, std::size_t b, std::size_t t, std::size_t c, double limit)
  {
    const float here = this->Surfaces[s][b];
    const float there = this->Surfaces[t][c];
    if (here >= 0 && there >= 0 && step * std::abs(here - there) <= limit)
    {
      pieces.Join(s * beams + b, t * beams + c);
    }
  };
  for (std::size_t s = 0; s < slices.size(); ++s)
  {
    const bool follows = s > 0 && !slices[s].BeginsSweep;
    if (follows)
    {
      const double way = GetDistance(slices[s - 1], slices[s]);
      widths[s - 1] += 0.5 * way;
      widths[s] += 0.5 * way;
    }
    for (std::size_t b = 0; b < beams; ++b)
    {
      if (b > 0)
      {
        join(s, b - 1, s, b, LinkDepth);
      }
      if (follows)
      {
        join(s - 1, b, s, b, LinkAcross);
      }
    }
  }
  std::vector<double> areas(slices.size() * beams, 0);
  for (std::size_t s = 0; s < slices.size(); ++s)
  {
    for (std::size_t b = 0; b < beams; ++b)
    {
      if (this->Surfaces[s][b] >= 0)
      {
        areas[pieces.Find(s * beams + b)] +=
          widths[s] * this->Grid.GetBeamStep(this->Surfaces[s][b]);
      }
    }
  }
  for (std::size_t s = 0; s < slices.size(); ++s)
  {
    for (std::size_t b = 0; b < beams; ++b)
    {
      float& sample = this->Surfaces[s][b];
      if (sample < 0)
      {
        continue;
      }
      const bool isAlone = widths[s] == 0; // no area is known
      if (!isAlone && areas[pieces.Find(s * beams + b)] < this->Options.MinimumArea)
      {
        sample = Unknown;
        continue;
      }
      this->Area += widths[s] * this->Grid.GetBeamStep(sample);
    }
  }
}

void BoneEcho::CloseGaps(std::vector<float>& surface) const
{
  const int beams = this->Grid.GetNumberOfBeams();
  int before = -1;
  for (int b = 0; b < beams; ++b)
  {
    if (surface[b] < 0)
    {
      continue;
    }
    const float first = before >= 0 ? surface[before] : 0;
    const double width = this->Grid.GetBeamStep(0.5 * (first + surface[b])) * (b - before);
    if (before >= 0 && b - before > 1 && width <= this->Options.MaximumGap)
    {
      for (int i = before + 1; i < b; ++i)
      {
        surface[i] = first +
          (surface[b] - first) * static_cast<float>(i - before) / static_cast<float>(b - before);
      }
    }
    before = b;
  }
}

std::size_t BoneEcho::GetNumberOfBeams() const
{
  std::size_t count = 0;
  for (const std::vector<float>& surface : this->Surfaces)
  {
    count += static_cast<std::size_t>(
      std::count_if(surface.begin(), surface.end(), [](float sample) { return sample >= 0; }));
  }
  return count;
}

// The surface of a slice as a line of points, mm in the window.
class BoneEcho::Outline
{
public:
  Outline(const BeamGrid& grid, const std::vector<float>& surface)
    : Grid(grid)
    , Surface(surface)
    , Points(surface.size())
  {
    for (std::size_t b = 0; b < surface.size(); ++b)
    {
      if (surface[b] >= 0)
      {
        this->First = std::min<double>(this->First, surface[b]);
        this->Last = std::max<double>(this->Last, surface[b]);
        const Vec2 pixel = grid.GetPixel(static_cast<int>(b), surface[b]);
        this->Points[b] = { grid.GetPixelSpacing()[0] * pixel[0],
          grid.GetPixelSpacing()[1] * pixel[1] };
      }
    }
  }

  // mm from a pixel to the surface, positive behind it; front or back when it is further away.
  double GetDepth(int column, int row, double front, double back) const
  {
    const Vec2 place = this->Grid.Find(column, row);
    const double nearest = std::floor(place[0] + 0.5);
    if (nearest < 0 || nearest >= static_cast<double>(this->Surface.size()) || place[1] < -0.5 ||
      place[1] > this->Grid.GetNumberOfSamples() - 0.5)
    {
      return front;
    }
    const auto middle = static_cast<std::ptrdiff_t>(nearest);
    const bool isBehind = this->Surface[middle] >= 0 && place[1] >= this->Surface[middle];
    const double limit = isBehind ? back : -front;
    const double step = this->Grid.GetSampleStep();
    if (step * (this->First - place[1]) > limit || step * (place[1] - this->Last) > limit)
    {
      return isBehind ? back : front;
    }
    const Vec2& spacing = this->Grid.GetPixelSpacing();
    const Vec2 point{ spacing[0] * column, spacing[1] * row };
    double square = limit * limit;
    const double width = NearestChord * this->Grid.GetBeamStep(std::max(0.0, place[1]));
    const auto beams = static_cast<std::ptrdiff_t>(this->Surface.size());
    // outwards, as long as beams may be nearer: those of a sector are not closer than on their chord
    for (std::ptrdiff_t k = 0; k < beams; ++k)
    {
      const double way = static_cast<double>(k - 1) * width;
      if (k > 0 && way * way > square)
      {
        break;
      }
      for (const std::ptrdiff_t b : { middle - k, middle + k })
      {
        if (b >= 0 && b < beams && this->Surface[b] >= 0)
        {
          square = std::min(square, this->GetSquare(point, b));
        }
      }
    }
    return isBehind ? std::sqrt(square) : -std::sqrt(square);
  }

private:
  static constexpr double NearestChord = 0.63; // of an arc up to 90 degrees

  // Of the distance to the part of the line from a beam to the next one.
  double GetSquare(const Vec2& point, std::ptrdiff_t beam) const
  {
    const Vec2 from = this->Points[beam];
    const bool isEnd =
      beam + 1 == static_cast<std::ptrdiff_t>(this->Surface.size()) || this->Surface[beam + 1] < 0;
    const Vec2 to = isEnd ? from : this->Points[beam + 1];
    const double x = to[0] - from[0], y = to[1] - from[1];
    const double square = x * x + y * y;
    const double dx = point[0] - from[0], dy = point[1] - from[1];
    const double t = square > 0 ? std::clamp((dx * x + dy * y) / square, 0.0, 1.0) : 0;
    return (dx - t * x) * (dx - t * x) + (dy - t * y) * (dy - t * y);
  }

  const BeamGrid& Grid;
  const std::vector<float>& Surface;
  std::vector<Vec2> Points;
  double First = std::numeric_limits<double>::infinity(); // samples
  double Last = -First;
};

void BoneEcho::Write(std::size_t slice, float* pixels, std::int64_t rowStride) const
{
  const Outline outline(this->Grid, this->Surfaces[slice]);
  const double thickness = this->Options.Thickness;
  for (int row = 0; row < this->Grid.GetHeight(); ++row)
  {
    for (int column = 0; column < this->Grid.GetWidth(); ++column)
    {
      const double depth =
        outline.GetDepth(column, row, -0.5 * thickness, 1.5 * thickness) / thickness;
      pixels[row * rowStride + column] =
        static_cast<float>(std::clamp(std::min(0.5 + depth, 1.5 - depth), 0.0, 1.0));
    }
  }
}
}
