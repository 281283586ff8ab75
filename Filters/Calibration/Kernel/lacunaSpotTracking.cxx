// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSpotTracking.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

namespace lacuna
{
namespace
{
constexpr int SmallestSize = 16;
constexpr double Sigma = 1.5;
constexpr int PeakRadius = 3;
constexpr double LeastPeak = 0.2; // of the brightest, above the median
constexpr std::size_t MostPeaks = 400;
constexpr std::size_t MostSpots = 8;
constexpr double LeastScore = 0.1;
constexpr double WidestPart = 1.0 / 12;  // of the image's width, a half of the spot
constexpr double HighestPart = 1.0 / 20; // of its height
constexpr double CentrePart = 0.7;       // of the peak
constexpr double RingPercentile = 0.97;
constexpr double EchoLevel = 0.4; // of the echo's: what lies above it is then its origin
constexpr double EchoPenalty = 0.5;

// The smoothed image.
class Levels
{
public:
  explicit Levels(const GreyImage& image)
    : Width(image.Width)
    , Height(image.Height)
    , Values(GetLevels(image))
  {
    std::array<float, 2 * Radius + 1> weights{};
    float sum = 0;
    for (int d = -Radius; d <= Radius; ++d)
    {
      weights[std::size_t(d + Radius)] = static_cast<float>(std::exp(-0.5 * d * d / Sigma / Sigma));
      sum += weights[std::size_t(d + Radius)];
    }
    for (float& weight : weights)
    {
      weight /= sum;
    }
    std::vector<float> line(std::size_t(std::max(this->Width, this->Height)) + 2 * Radius);
    for (int row = 0; row < this->Height; ++row)
    {
      Smooth(&this->At(0, row), 1, this->Width, weights, line);
    }
    for (int column = 0; column < this->Width; ++column)
    {
      Smooth(&this->At(column, 0), this->Width, this->Height, weights, line);
    }
  }

  bool Has(int column, int row) const
  {
    return column >= 0 && row >= 0 && column < this->Width && row < this->Height;
  }
  float Get(int column, int row) const
  {
    return this->Values[std::size_t(row) * std::size_t(this->Width) + std::size_t(column)];
  }
  float GetMaximum() const { return *std::max_element(this->Values.begin(), this->Values.end()); }
  float GetMedian() const
  {
    std::vector<float> sorted = this->Values;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    return *middle;
  }

  int Width, Height;

private:
  static constexpr int Radius = 5;

  float& At(int column, int row)
  {
    return this->Values[std::size_t(row) * std::size_t(this->Width) + std::size_t(column)];
  }
  // The image goes on at its edges as its edge is.
  static void Smooth(float* first, int stride, int count,
    const std::array<float, 2 * Radius + 1>& weights, std::vector<float>& line)
  {
    for (int i = -Radius; i < count + Radius; ++i)
    {
      line[std::size_t(i + Radius)] = first[std::ptrdiff_t(std::clamp(i, 0, count - 1)) * stride];
    }
    for (int i = 0; i < count; ++i)
    {
      float sum = 0;
      for (std::size_t w = 0; w < weights.size(); ++w)
      {
        sum += weights[w] * line[std::size_t(i) + w];
      }
      first[std::ptrdiff_t(i) * stride] = sum;
    }
  }

  std::vector<float> Values;
};

struct Peak
{
  int Column, Row;
  float Level;
};

// The brightest first; of equals the upper left one.
std::vector<Peak> FindPeaks(const Levels& levels, float least)
{
  std::vector<Peak> peaks;
  for (int row = 1; row < levels.Height - 1; ++row)
  {
    for (int column = 1; column < levels.Width - 1; ++column)
    {
      const float level = levels.Get(column, row);
      bool isPeak = level > least;
      for (int dy = -PeakRadius; isPeak && dy <= PeakRadius; ++dy)
      {
        for (int dx = -PeakRadius; isPeak && dx <= PeakRadius; ++dx)
        {
          if (levels.Has(column + dx, row + dy))
          {
            const float other = levels.Get(column + dx, row + dy);
            const bool isBefore = dy < 0 || (dy == 0 && dx < 0);
            isPeak = isBefore ? other < level : other <= level;
          }
        }
      }
      if (isPeak)
      {
        peaks.push_back({ column, row, level });
      }
    }
  }
  std::stable_sort(
    peaks.begin(), peaks.end(), [](const Peak& a, const Peak& b) { return a.Level > b.Level; });
  peaks.erase(peaks.begin() + std::min(peaks.size(), MostPeaks), peaks.end());
  return peaks;
}

// How far from a peak the levels are above a threshold, pixels; most + 1 when farther.
int GetReach(const Levels& levels, const Peak& peak, int dx, int dy, double threshold, int most)
{
  int n = 0;
  while (n <= most && levels.Has(peak.Column + (n + 1) * dx, peak.Row + (n + 1) * dy) &&
    levels.Get(peak.Column + (n + 1) * dx, peak.Row + (n + 1) * dy) > threshold)
  {
    ++n;
  }
  return n;
}

// What is in a ring around a peak, but for what lies below it; ascending.
std::vector<float> GetRing(const Levels& levels, const Peak& peak, int halfWidth, int halfHeight)
{
  const double innerX = 2.5 * halfWidth + 4, innerY = 2.5 * halfHeight + 4;
  const int outerX = static_cast<int>(2 * innerX), outerY = static_cast<int>(2 * innerY);
  std::vector<float> ring;
  for (int dy = -outerY; dy <= outerY; ++dy)
  {
    for (int dx = -outerX; dx <= outerX; ++dx)
    {
      const bool isTail = dy > 0 && std::abs(dx) <= 1.5 * halfWidth + 4;
      const double inner = dx * dx / (innerX * innerX) + dy * dy / (innerY * innerY);
      if (inner >= 1 && inner <= 4 && !isTail && levels.Has(peak.Column + dx, peak.Row + dy))
      {
        ring.push_back(levels.Get(peak.Column + dx, peak.Row + dy));
      }
    }
  }
  std::sort(ring.begin(), ring.end());
  return ring;
}

// The centre of the connected levels above a threshold around a peak.
Vec2 GetCentre(const Levels& levels, const Peak& peak, double threshold, int reachX, int reachY)
{
  const int width = 2 * reachX + 1;
  std::vector<char> seen(std::size_t(width) * std::size_t(2 * reachY + 1), 0);
  std::vector<std::pair<int, int>> pending{ { 0, 0 } };
  seen[std::size_t(reachY) * std::size_t(width) + std::size_t(reachX)] = 1;
  double sum = 0, column = 0, row = 0;
  while (!pending.empty())
  {
    const auto [dx, dy] = pending.back();
    pending.pop_back();
    const double weight = levels.Get(peak.Column + dx, peak.Row + dy) - threshold;
    sum += weight;
    column += weight * dx;
    row += weight * dy;
    const std::pair<int, int> neighbours[] = { { dx - 1, dy }, { dx + 1, dy }, { dx, dy - 1 },
      { dx, dy + 1 } };
    for (const auto& [x, y] : neighbours)
    {
      if (std::abs(x) > reachX || std::abs(y) > reachY ||
        !levels.Has(peak.Column + x, peak.Row + y))
      {
        continue;
      }
      char& isSeen = seen[std::size_t(y + reachY) * std::size_t(width) + std::size_t(x + reachX)];
      if (!isSeen && levels.Get(peak.Column + x, peak.Row + y) > threshold)
      {
        isSeen = 1;
        pending.emplace_back(x, y);
      }
    }
  }
  return { peak.Column + column / sum, peak.Row + row / sum };
}

struct Candidate
{
  lacuna::Spot Spot;
  int HalfWidth;
};

std::optional<Candidate> Judge(const Levels& levels, const Peak& peak, float background)
{
  const int widest = std::max(4, static_cast<int>(WidestPart * levels.Width));
  const int highest = std::max(4, static_cast<int>(HighestPart * levels.Height));
  const double half = 0.5 * (double(background) + double(peak.Level));
  const int left = GetReach(levels, peak, -1, 0, half, widest);
  const int right = GetReach(levels, peak, 1, 0, half, widest);
  const int up = GetReach(levels, peak, 0, -1, half, highest);
  if (left > widest || right > widest || up > highest)
  {
    return {};
  }
  const int halfWidth = std::max({ 1, left, right });
  const std::vector<float> ring = GetRing(levels, peak, halfWidth, std::max(1, up));
  if (ring.size() < 20)
  {
    return {};
  }
  const double around = ring[ring.size() / 2];
  const double clutter =
    ring[static_cast<std::size_t>(RingPercentile * static_cast<double>(ring.size() - 1))];
  Candidate candidate;
  candidate.Spot.Level = peak.Level - around;
  if (!(candidate.Spot.Level > 0))
  {
    return {};
  }
  candidate.Spot.Score = 1 - 2 * (clutter - around) / candidate.Spot.Level;
  candidate.HalfWidth = halfWidth;
  candidate.Spot.Pixel =
    GetCentre(levels, peak, around + CentrePart * candidate.Spot.Level, widest, highest);
  return candidate.Spot.Score > LeastScore ? std::optional<Candidate>(candidate) : std::nullopt;
}
}

std::vector<Spot> FindSpots(const GreyImage& image)
{
  std::vector<Spot> spots;
  if (image.Width < SmallestSize || image.Height < SmallestSize)
  {
    return spots;
  }
  const Levels levels(image);
  const float background = levels.GetMedian();
  std::vector<Candidate> candidates;
  const float least =
    background + static_cast<float>(LeastPeak * (double(levels.GetMaximum()) - double(background)));
  for (const Peak& peak : FindPeaks(levels, least))
  {
    if (const std::optional<Candidate> candidate = Judge(levels, peak, background))
    {
      candidates.push_back(*candidate);
    }
  }
  for (const Candidate& c : candidates)
  {
    const bool isEcho = std::any_of(candidates.begin(), candidates.end(),
      [&c](const Candidate& other)
      {
        return other.Spot.Pixel[1] < c.Spot.Pixel[1] - 2 &&
          std::abs(other.Spot.Pixel[0] - c.Spot.Pixel[0]) <= 2 * other.HalfWidth + 3 &&
          other.Spot.Level >= EchoLevel * c.Spot.Level;
      });
    spots.push_back(c.Spot);
    spots.back().Score *= isEcho ? EchoPenalty : 1;
  }
  std::stable_sort(spots.begin(), spots.end(),
    [](const Spot& a, const Spot& b) { return a.Score * a.Level > b.Score * b.Level; });
  spots.erase(spots.begin() + std::min(spots.size(), MostSpots), spots.end());
  return spots;
}

//------------------------------------------------------------------------------
namespace
{
constexpr double CostOfNone = 0.5;
constexpr double CostOfJump = 0.15;
constexpr double CostOfJumpInSweep = 2;
constexpr double LeastScoreOfSweep = 0.5;
constexpr double NearPart = 0.5;       // of the reach, a step in a sweep
constexpr std::size_t LongestGap = 10; // slices over which a step is still judged by its length
constexpr double UsualPart = 0.6;      // of the usual brightness: bright enough
constexpr double UsualPercentile = 0.75;
constexpr double Forbidden = 1e6;

struct Node
{
  Spot Choice;
  double Cost = 0;                   // of the best way up to here
  std::optional<std::size_t> Before; // of the nodes; none: the way begins here
  std::size_t Slice = 0;
};

// Brightness of the best spots of those slices that have any.
double GetUsualLevel(const std::vector<SpotSlice>& slices)
{
  std::vector<double> levels;
  for (const SpotSlice& slice : slices)
  {
    if (!slice.Spots.empty())
    {
      levels.push_back(slice.Spots.front().Level);
    }
  }
  if (levels.empty())
  {
    return 1;
  }
  const auto place = levels.begin() +
    static_cast<std::ptrdiff_t>(UsualPercentile * static_cast<double>(levels.size() - 1));
  std::nth_element(levels.begin(), place, levels.end());
  return *place;
}

double GetSteps(const Spot& from, const Spot& to, double reach)
{
  return std::hypot(to.Pixel[0] - from.Pixel[0], to.Pixel[1] - from.Pixel[1]) / reach;
}

// Whether most of the best spots of slices that follow one another do, too.
bool IsSweep(const std::vector<SpotSlice>& slices, double reach)
{
  std::size_t steps = 0, near = 0;
  const auto isClear = [](const SpotSlice& slice)
  { return !slice.Spots.empty() && slice.Spots.front().Score > LeastScoreOfSweep; };
  for (std::size_t k = 1; k < slices.size(); ++k)
  {
    if (isClear(slices[k - 1]) && isClear(slices[k]))
    {
      ++steps;
      near +=
        GetSteps(slices[k - 1].Spots.front(), slices[k].Spots.front(), reach) < NearPart ? 1 : 0;
    }
  }
  return 2 * near > steps;
}

// Ways through slices, one spot or none in each; the cheapest is the track.
class Ways
{
public:
  Ways(const std::vector<SpotSlice>& slices, double reach)
    : Slices(slices)
    , Reach(reach)
    , Usual(GetUsualLevel(slices))
    , Jump(IsSweep(slices, reach) ? CostOfJumpInSweep : CostOfJump)
    , Skipped(slices.size() + 1, 0)
  {
    for (std::size_t k = 0; k < slices.size(); ++k)
    {
      this->Skipped[k + 1] = this->Skipped[k] + (slices[k].Known ? Forbidden : CostOfNone);
    }
    for (std::size_t k = 0; k < slices.size(); ++k)
    {
      this->GoOn(k);
    }
    this->Ended.reset();
    this->End(0, this->Nodes.size());
  }

  std::vector<std::optional<Spot>> GetCheapest() const
  {
    std::vector<std::optional<Spot>> track(this->Slices.size());
    // none at all costs 0 more than leaving out all slices
    for (std::optional<std::size_t> n = this->EndedCost < 0 ? this->Ended : std::nullopt; n;
         n = this->Nodes[*n].Before)
    {
      track[this->Nodes[*n].Slice] = this->Nodes[*n].Choice;
    }
    return track;
  }

private:
  // Into slice k.
  void GoOn(std::size_t k)
  {
    this->Begins.push_back(this->Nodes.size());
    if (k > LongestGap)
    {
      this->End(this->Begins[k - LongestGap - 1], this->Begins[k - LongestGap]);
    }
    if (this->Slices[k].Known)
    {
      this->Add({ *this->Slices[k].Known, 0, 1 }, k);
      return;
    }
    for (Spot spot : this->Slices[k].Spots)
    {
      spot.Score *= std::min(1.0, spot.Level / (UsualPart * this->Usual));
      this->Add(spot, k);
    }
  }

  // The best way to a spot of slice k.
  void Add(const Spot& spot, std::size_t k)
  {
    Node node{ spot, 0, {}, k };
    double best = this->Skipped[k]; // the first of all
    if (this->Ended && this->EndedCost + this->Skipped[k] + CostOfJump < best)
    {
      best = this->EndedCost + this->Skipped[k] + CostOfJump;
      node.Before = this->Ended;
    }
    const std::size_t first = this->Begins[k > LongestGap ? k - LongestGap : 0];
    for (std::size_t n = first; n < this->Begins[k]; ++n)
    {
      const Node& before = this->Nodes[n];
      const double step = std::min(
        1.0, GetSteps(before.Choice, spot, this->Reach * static_cast<double>(k - before.Slice)));
      const double cost =
        before.Cost + this->Skipped[k] - this->Skipped[before.Slice + 1] + this->Jump * step * step;
      if (cost < best)
      {
        best = cost;
        node.Before = n;
      }
    }
    node.Cost = best + 1 - spot.Score;
    this->Nodes.push_back(node);
  }

  // Remembers the best of these nodes, and of those before, to end at.
  void End(std::size_t first, std::size_t last)
  {
    for (std::size_t n = first; n < last; ++n)
    {
      const double cost = this->Nodes[n].Cost - this->Skipped[this->Nodes[n].Slice + 1];
      if (!this->Ended || cost < this->EndedCost)
      {
        this->Ended = n;
        this->EndedCost = cost;
      }
    }
  }

  const std::vector<SpotSlice>& Slices;
  double Reach;
  double Usual;
  double Jump;
  std::vector<double> Skipped; // what it costs to leave out all slices before one
  std::vector<Node> Nodes;
  std::vector<std::size_t> Begins;  // of each slice in Nodes
  std::optional<std::size_t> Ended; // the best way that ended long before
  double EndedCost = 0;             // of it, less what it costs to leave out all slices
};
}

std::vector<std::optional<Spot>> TrackSpots(const std::vector<SpotSlice>& slices, double reach)
{
  if (!(reach > 0))
  {
    throw std::invalid_argument("the reach of a step must be above 0 pixels");
  }
  return Ways(slices, reach).GetCheapest();
}
}
