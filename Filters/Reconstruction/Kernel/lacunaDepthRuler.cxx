// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaDepthRuler.h"

#include "lacunaParameterText.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace lacuna
{
namespace
{
constexpr std::size_t MostFrames = 32;
constexpr std::size_t FewestTicks = 5;
constexpr double LeastPitch = 4;      // pixels
constexpr double Thickest = 0.02;     // a tick, of the region's side
constexpr double NoTick = -1;         // a row
constexpr double LeastSpan = 1.0 / 3; // of the region's side
constexpr double Overhang = 0.06;     // of the region's side
constexpr double MostMissing = 0.2;   // of the ticks
constexpr double MostOthers = 0.25;   // things between ticks, of the ticks
// Pixels: two ticks at whole pixels and the pitch from two others are off by 1.5 together.
constexpr double Tolerance = 1.6;
constexpr double MostSpread = 0.6;        // pixels, of the ticks about their places
constexpr double SameRow = 0.9;           // pixels, of a tick from column to column
constexpr double RoundingSpread = 0.2887; // of what is drawn at whole pixels: 1 / sqrt(12)
constexpr int Margin = 2;                 // pixels around the region that are not looked at
constexpr int FarthestEnd = 60;           // pixels to which a tick is followed
// Of the range of grey levels: what is brighter than its surroundings by that is a stroke.
constexpr std::array<double, 3> Contrasts{ 0.4, 0.2, 0.1 };

// The mean of the frames, the region left out; transposed for ticks along the width, so that ticks
// always lie one above the other.
class Screen
{
public:
  Screen(const std::vector<SliceImage>& frames, const DetectedFan& region, const Vec2& pixelSpacing,
    bool transposed)
    : Width(transposed ? frames.front().Height : frames.front().Width)
    , Height(transposed ? frames.front().Width : frames.front().Height)
    , Levels(static_cast<std::size_t>(this->Width) * static_cast<std::size_t>(this->Height), 0)
    , Outside(this->Levels.size(), 1)
  {
    const int width = frames.front().Width, height = frames.front().Height;
    const std::size_t count = std::min(MostFrames, frames.size());
    for (std::size_t n = 0; n < count; ++n)
    {
      const SliceImage& frame = frames[count > 1 ? n * (frames.size() - 1) / (count - 1) : 0];
      DispatchScalars(frame.Type, frame.Pixels,
        [&](const auto* pixels)
        {
          for (int row = 0; row < height; ++row)
          {
            for (int column = 0; column < width; ++column)
            {
              const auto level = static_cast<double>(pixels[frame.RowStride * row + column]);
              this->Levels[this->Index(column, row, transposed)] +=
                std::isfinite(level) ? static_cast<float>(level / static_cast<double>(count)) : 0;
            }
          }
        });
    }
    std::optional<FanMask> mask;
    if (region.IsSector)
    {
      mask.emplace(region.Sector, width, height, pixelSpacing);
    }
    const std::array<int, 4>& box = region.Rectangle;
    for (int row = std::max(0, box[1] - Margin); row < std::min(height, box[1] + box[3] + Margin);
         ++row)
    {
      for (int column = std::max(0, box[0] - Margin);
           column < std::min(width, box[0] + box[2] + Margin); ++column)
      {
        const auto isIn = [&](int dx, int dy) { return mask->Contains(column + dx, row + dy); };
        if (!mask || isIn(0, 0) || isIn(-Margin, 0) || isIn(Margin, 0) || isIn(0, -Margin) ||
          isIn(0, Margin))
        {
          this->Outside[this->Index(column, row, transposed)] = 0;
        }
      }
    }
    const auto [low, high] = std::minmax_element(this->Levels.begin(), this->Levels.end());
    this->Range = *high - *low;
  }

  float Get(int column, int row) const { return this->Levels[this->Index(column, row, false)]; }
  bool IsOutside(int column, int row) const
  {
    return this->Outside[this->Index(column, row, false)] != 0;
  }
  double GetRange() const { return this->Range; }

  int Width, Height;

private:
  std::size_t Index(int column, int row, bool transposed) const
  {
    return transposed
      ? static_cast<std::size_t>(column) * static_cast<std::size_t>(this->Width) + row
      : static_cast<std::size_t>(row) * static_cast<std::size_t>(this->Width) + column;
  }
  std::vector<float> Levels;
  std::vector<char> Outside;
  double Range = 0;
};

// A line of ticks, of one column or of several beside each other.
struct Comb
{
  int First = 0, Last = 0; // columns
  double Pitch = 0;
  std::vector<int> Numbers; // of the ticks, ascending from 0
  std::vector<double> Rows;
  std::size_t Others = 0; // things between them
  double Contrast = 0;    // at which it was seen
  float Background = 0;   // of the first column
  std::size_t GetMissing() const { return std::size_t(this->Numbers.back()) + 1 - Rows.size(); }
};

// The short bright strokes of a column: their middles.
std::vector<double> FindStrokes(
  const Screen& screen, int column, int low, int high, double contrast, float& background)
{
  std::vector<float> outside;
  for (int row = low; row <= high; ++row)
  {
    if (screen.IsOutside(column, row))
    {
      outside.push_back(screen.Get(column, row));
    }
  }
  std::vector<double> strokes;
  if (outside.empty() || static_cast<double>(outside.size()) < LeastSpan * (high - low))
  {
    return strokes;
  }
  const auto middle = outside.begin() + static_cast<std::ptrdiff_t>(outside.size() / 2);
  std::nth_element(outside.begin(), middle, outside.end());
  background = *middle;
  const auto over = [&](int row)
  {
    return row >= low && row <= high && screen.IsOutside(column, row)
      ? std::max(0.0, double(screen.Get(column, row)) - double(background))
      : 0.0;
  };
  for (int row = low; row <= high; ++row)
  {
    if (over(row) <= contrast)
    {
      continue;
    }
    const int first = row;
    while (over(row) > contrast)
    {
      ++row;
    }
    double sum = 0, moment = 0;
    for (int r = first - 1; r <= row; ++r)
    {
      sum += over(r);
      moment += over(r) * r;
    }
    strokes.push_back(row - first > Thickest * (high - low) ? NoTick : moment / sum);
  }
  return strokes;
}

struct Line
{
  double Offset = 0, Pitch = 0, Spread = 0, Moment = 0;
};

Line Fit(const std::vector<int>& numbers, const std::vector<double>& rows)
{
  const auto n = static_cast<double>(rows.size());
  double meanNumber = 0, meanRow = 0;
  for (std::size_t i = 0; i < rows.size(); ++i)
  {
    meanNumber += numbers[i] / n;
    meanRow += rows[i] / n;
  }
  Line line;
  double product = 0;
  for (std::size_t i = 0; i < rows.size(); ++i)
  {
    line.Moment += (numbers[i] - meanNumber) * (numbers[i] - meanNumber);
    product += (numbers[i] - meanNumber) * (rows[i] - meanRow);
  }
  line.Pitch = product / line.Moment;
  line.Offset = meanRow - line.Pitch * meanNumber;
  double square = 0;
  for (std::size_t i = 0; i < rows.size(); ++i)
  {
    const double residual = rows[i] - line.Offset - line.Pitch * numbers[i];
    square += residual * residual;
  }
  line.Spread = std::sqrt(square / std::max(1.0, n - 2));
  return line;
}

// The ticks that follow two strokes at their distance.
Comb Follow(const std::vector<double>& strokes, std::size_t first, std::size_t second)
{
  Comb comb;
  comb.Numbers = { 0, 1 };
  comb.Rows = { strokes[first], strokes[second] };
  comb.Pitch = strokes[second] - strokes[first];
  const double tolerance = std::min(Tolerance, 0.25 * comb.Pitch);
  std::size_t next = second + 1;
  for (int number = 2; next < strokes.size() && number - comb.Numbers.back() <= 3; ++number)
  {
    const double row = comb.Rows.back() + comb.Pitch * (number - comb.Numbers.back());
    while (next < strokes.size() && strokes[next] < row - tolerance)
    {
      ++next;
    }
    if (next < strokes.size() && strokes[next] <= row + tolerance)
    {
      comb.Numbers.push_back(number);
      comb.Rows.push_back(strokes[next]);
      comb.Pitch = (comb.Rows.back() - comb.Rows.front()) / number;
    }
  }
  return comb;
}

bool IsRuler(const Comb& comb, int low, int high)
{
  const auto ticks = static_cast<double>(comb.Rows.size());
  return comb.Rows.size() >= FewestTicks && double(comb.GetMissing()) <= MostMissing * ticks &&
    double(comb.Others) <= MostOthers * ticks && comb.Pitch >= LeastPitch &&
    comb.Rows.back() - comb.Rows.front() >= LeastSpan * (high - low) &&
    Fit(comb.Numbers, comb.Rows).Spread <= MostSpread;
}

// The best of a column.
std::optional<Comb> FindComb(const Screen& screen, int column, int low, int high, double contrast)
{
  float background = 0;
  std::vector<double> strokes = FindStrokes(screen, column, low, high, contrast, background);
  const std::size_t all = strokes.size();
  strokes.erase(std::remove(strokes.begin(), strokes.end(), NoTick), strokes.end());
  std::optional<Comb> best;
  for (std::size_t i = 0; i + 1 < strokes.size(); ++i)
  {
    for (std::size_t j = i + 1; j < std::min(i + 4, strokes.size()); ++j)
    {
      if (strokes[j] - strokes[i] < LeastPitch)
      {
        continue;
      }
      Comb comb = Follow(strokes, i, j);
      comb.Others = all - comb.Rows.size();
      if ((!best || comb.Rows.size() > best->Rows.size()) && IsRuler(comb, low, high))
      {
        comb.First = comb.Last = column;
        comb.Contrast = contrast;
        comb.Background = background;
        best = std::move(comb);
      }
    }
  }
  return best;
}

// Whether two combs have the same ticks.
bool IsSame(const Comb& a, const Comb& b)
{
  const double shift = (b.Rows.front() - a.Rows.front()) / a.Pitch;
  return std::abs(shift - std::round(shift)) * a.Pitch <= SameRow &&
    std::abs(a.Pitch - b.Pitch) * static_cast<double>(a.Numbers.back()) <= 2 * SameRow;
}

// Ticks of the columns of a comb together: the mean rows.
Comb Merge(const std::vector<Comb>& columns)
{
  const Comb& longest = *std::max_element(columns.begin(), columns.end(),
    [](const Comb& a, const Comb& b) { return a.Rows.size() < b.Rows.size(); });
  Comb merged = longest;
  merged.First = columns.front().First;
  merged.Last = columns.back().Last;
  for (std::size_t t = 0; t < merged.Rows.size(); ++t)
  {
    double sum = 0, count = 0;
    for (const Comb& column : columns)
    {
      for (const double row : column.Rows)
      {
        if (std::abs(row - longest.Rows[t]) <= SameRow)
        {
          sum += row;
          count += 1;
        }
      }
    }
    merged.Rows[t] = sum / count;
  }
  return merged;
}

// How far each tick reaches, columns.
std::vector<int> GetLengths(const Screen& screen, const Comb& comb)
{
  std::vector<int> lengths;
  for (const double row : comb.Rows)
  {
    const int r = static_cast<int>(std::lround(row));
    int ends[2] = { comb.First, comb.Last };
    for (int side = 0; side < 2; ++side)
    {
      const int step = side == 0 ? -1 : 1;
      for (int n = 0; n < FarthestEnd; ++n)
      {
        const int column = ends[side] + step;
        if (column < 0 || column >= screen.Width || !screen.IsOutside(column, r) ||
          screen.Get(column, r) - comb.Background <= comb.Contrast)
        {
          break;
        }
        ends[side] = column;
      }
    }
    lengths.push_back(ends[1] - ends[0] + 1);
  }
  return lengths;
}

// Every how manyth tick is longer than all others.
void FindLongTicks(const Screen& screen, const Comb& comb, TickRow& row)
{
  const std::vector<int> lengths = GetLengths(screen, comb);
  for (int every = 2; every <= 10; ++every)
  {
    for (int first = 0; first < every; ++first)
    {
      int shortest = FarthestEnd * 3, longestOther = 0, count = 0;
      for (std::size_t t = 0; t < lengths.size(); ++t)
      {
        if (comb.Numbers[t] % every == first)
        {
          shortest = std::min(shortest, lengths[t]);
          ++count;
        }
        else
        {
          longestOther = std::max(longestOther, lengths[t]);
        }
      }
      if (count >= 2 && shortest > longestOther + 1)
      {
        row.LongEvery = every;
        const auto place = std::find_if(comb.Numbers.begin(), comb.Numbers.end(),
          [&](int number) { return number % every == first; });
        row.FirstLong = static_cast<int>(place - comb.Numbers.begin());
        return;
      }
    }
  }
}

TickRow FindTicks(const Screen& screen, int first, int last, const char* const (&names)[2])
{
  TickRow row;
  const int overhang = static_cast<int>(std::lround(Overhang * (last - first)));
  const int low = std::max(0, first - overhang);
  const int high = std::min(screen.Height - 1, last + overhang);
  std::optional<Comb> best;
  double bestScore = 0;
  for (const double part : Contrasts)
  {
    std::vector<Comb> beside;
    const auto close = [&]()
    {
      if (beside.size() >= 2)
      {
        const Comb merged = Merge(beside);
        // the most ticks; of equals the plainest
        const double score = static_cast<double>(merged.Rows.size()) -
          0.5 * static_cast<double>(merged.Others + merged.GetMissing()) +
          0.01 * static_cast<double>(std::min<std::size_t>(beside.size(), 8));
        if (score > bestScore)
        {
          best = merged;
          bestScore = score;
        }
      }
      beside.clear();
    };
    for (int column = 0; column < screen.Width; ++column)
    {
      std::optional<Comb> comb = FindComb(screen, column, low, high, part * screen.GetRange());
      if (!beside.empty() && (!comb || !IsSame(beside.back(), *comb)))
      {
        close();
      }
      if (comb)
      {
        beside.push_back(std::move(*comb));
      }
    }
    close();
  }
  if (!best)
  {
    row.Text = std::string("no ruler ") + names[0] +
      ": no 5 or more equally spaced ticks along a third of the scan region's side";
    return row;
  }
  const Line line = Fit(best->Numbers, best->Rows);
  row.IsFound = true;
  row.Pitch = line.Pitch;
  row.PitchError = std::max(line.Spread, RoundingSpread) / std::sqrt(line.Moment);
  row.Ticks = best->Rows;
  row.Across = { best->First, best->Last };
  FindLongTicks(screen, *best, row);
  const auto format = [](double value, double unit)
  { return FormatNumber(std::round(value / unit) * unit); };
  const double unit = std::pow(10, std::floor(std::log10(row.PitchError)));
  row.Text = "ticks every " + format(row.Pitch, unit) + " +- " + format(row.PitchError, unit) +
    " pixels (" + std::to_string(row.Ticks.size()) + " ticks" +
    (row.LongEvery > 0 ? ", one in " + std::to_string(row.LongEvery) + " is longer" : "") +
    "); if a tick is 10 mm, " + format(row.GetSpacing(10), 1e-4) + " mm " + names[1] +
    (row.LongEvery > 0
        ? "; if a long one is, " + format(row.GetSpacing(10.0 / row.LongEvery), 1e-4) + " mm"
        : "");
  return row;
}
}

DepthRuler FindDepthRuler(
  const std::vector<SliceImage>& frames, const DetectedFan& region, const Vec2& pixelSpacing)
{
  const std::array<int, 4>& box = region.Rectangle;
  DepthRuler ruler;
  ruler.Depth = FindTicks(Screen(frames, region, pixelSpacing, false), box[1], box[1] + box[3] - 1,
    { "at the left or the right", "a row" });
  ruler.Width = FindTicks(Screen(frames, region, pixelSpacing, true), box[0], box[0] + box[2] - 1,
    { "above or below", "a column" });
  return ruler;
}
}
