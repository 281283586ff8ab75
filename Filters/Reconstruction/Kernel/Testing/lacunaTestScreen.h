// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The screen of a made-up scanner: what the probe sees, with texts, a logo, a grey bar and rulers.
#ifndef lacunaTestScreen_h
#define lacunaTestScreen_h

#include "lacunaFanDetection.h"

#include <array>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <random>
#include <vector>

namespace lacuna
{
struct TestRuler
{
  bool IsDrawn = true;
  double First = 52.3;  ///< row (of the depth) or column (of the width) of the first tick
  double Pitch = 23.41; ///< to the next
  int Count = 17;
  int LongEvery = 5; ///< 0: all alike
  int Place = 600;   ///< column or row of the axis
  int Length = 6;    ///< of a tick, from the axis on; long ones twice that
  bool HasAxis = true;
  bool IsSmooth = false; ///< ticks between pixels, as scaled video has them; else at whole pixels
  double Grey = 180;
};

struct TestScreen
{
  int Width = 720, Height = 540;
  unsigned Seed = 1;
  std::function<bool(double, double)> Sees; ///< column, row
  double Background = 0;                    ///< of the screen
  std::array<int, 4> Window{ 0, 0, 0, 0 };  ///< black, on the background; none when empty
  bool HasTexts = true;
  bool HasShadow = true;
  double Gain = 60; ///< of the speckle
  double Noise = 0; ///< standard deviation of the recorder's, everywhere
  double Blur = 0;  ///< of analogue video along rows, pixels
  TestRuler Depth;  ///< at the right
  TestRuler Across; ///< below
  TestScreen()
  {
    this->Across.IsDrawn = false;
    this->Across.Place = 515;
  }

  /// Frame n; what the probe sees is another in each.
  std::vector<std::uint8_t> Draw(int n) const
  {
    std::mt19937 random(this->Seed * 1000u + static_cast<unsigned>(n));
    std::uniform_real_distribution<double> u(1e-9, 1);
    std::normal_distribution<double> g(0, 1);
    std::vector<double> grey(std::size_t(this->Width * this->Height), this->Background);
    const auto at = [&](int x, int y) -> double& { return grey[std::size_t(y * this->Width + x)]; };
    const auto put = [&](int x, int y, double level)
    {
      if (x >= 0 && x < this->Width && y >= 0 && y < this->Height)
      {
        at(x, y) = std::max(at(x, y), level);
      }
    };
    for (int y = 0; y < this->Window[3]; ++y)
    {
      for (int x = 0; x < this->Window[2]; ++x)
      {
        at(this->Window[0] + x, this->Window[1] + y) = 0;
      }
    }
    // speckle three columns wide
    std::vector<double> speckle(grey.size());
    for (std::size_t part = 0; part < 2; ++part)
    {
      std::vector<double> wave(grey.size());
      for (double& value : wave)
      {
        value = g(random);
      }
      for (std::size_t i = 2; i < wave.size(); ++i)
      {
        speckle[i] += std::pow((wave[i] + wave[i - 1] + wave[i - 2]) / std::sqrt(3.0), 2);
      }
    }
    for (int y = 0; y < this->Height; ++y)
    {
      for (int x = 0; x < this->Width; ++x)
      {
        if (this->Sees && this->Sees(x, y))
        {
          const double tissue =
            1 + 0.5 * std::sin(0.03 * x + 0.2 * n) * std::cos(0.025 * y - 0.1 * n);
          const bool dark = this->HasShadow &&
            (std::abs(x - 430 - 3 * n) < 16 || std::hypot(x - 300 - 4 * n, y - 300) < 40);
          at(x, y) = 4 +
            (dark ? 0.04 : 1) * this->Gain * tissue *
              std::sqrt(speckle[std::size_t(y * this->Width + x)]);
        }
      }
    }
    if (this->HasTexts)
    {
      for (int line = 0; line < 24; ++line) // a panel of equally spaced lines at the left
      {
        this->Write(put, 8, 60 + 18 * line, 5 + line % 5, unsigned(line) * 7u + 3u);
      }
      this->Write(put, 20, 8, 30, 77);               // the hospital
      this->Write(put, 560, 8, 8, 91 + unsigned(n)); // the clock
      this->Write(put, 150, 526, 14, 17);
      for (int y = 0; y < 34; ++y) // a filled logo
      {
        for (int x = 0; x < 40; ++x)
        {
          put(660 + x, 20 + y, std::hypot(x - 20, y - 17) < 16 ? 230 : 90);
        }
      }
      for (int y = 0; y < 200; ++y) // the grey bar
      {
        for (int x = 0; x < 12; ++x)
        {
          put(690 + x, 120 + y, 255 - y * 255 / 200);
        }
      }
    }
    for (const bool isDepth : { true, false })
    {
      const TestRuler& ruler = isDepth ? this->Depth : this->Across;
      const auto draw = [&](int along, int across, double level)
      { isDepth ? put(across, along, level) : put(along, across, level); };
      for (int k = 0; ruler.IsDrawn && k < ruler.Count; ++k)
      {
        const double middle = ruler.First + k * ruler.Pitch;
        const bool isLong = ruler.LongEvery > 0 && k % ruler.LongEvery == 0;
        const int row = static_cast<int>(std::floor(middle));
        for (int i = 0; i < (isLong ? 2 : 1) * ruler.Length; ++i)
        {
          if (ruler.IsSmooth)
          {
            draw(row, ruler.Place + i, ruler.Grey * (1 - middle + row));
            draw(row + 1, ruler.Place + i, ruler.Grey * (middle - row));
          }
          else
          {
            draw(static_cast<int>(std::lround(middle)), ruler.Place + i, ruler.Grey);
          }
        }
        if (isLong && isDepth && this->HasTexts)
        {
          this->Write(put, ruler.Place + 2 * ruler.Length + 5, row - 5, 2, unsigned(k) * 5u + 2u);
        }
      }
      for (int i = 0; ruler.IsDrawn && ruler.HasAxis && i <= (ruler.Count - 1) * ruler.Pitch; ++i)
      {
        draw(static_cast<int>(std::lround(ruler.First)) + i, ruler.Place, ruler.Grey);
      }
    }
    std::vector<std::uint8_t> pixels;
    pixels.reserve(grey.size());
    for (int y = 0; y < this->Height; ++y)
    {
      for (int x = 0; x < this->Width; ++x)
      {
        double sum = 0, weights = 0;
        const int reach = static_cast<int>(3 * this->Blur);
        for (int d = -reach; d <= reach; ++d)
        {
          const double weight = d == 0 ? 1 : std::exp(-0.5 * d * d / (this->Blur * this->Blur));
          sum += weight * std::min(255.0, at(std::clamp(x + d, 0, this->Width - 1), y));
          weights += weight;
        }
        const double level = sum / weights + (this->Noise > 0 ? this->Noise * g(random) : 0);
        pixels.push_back(static_cast<std::uint8_t>(std::clamp(std::round(level), 0.0, 255.0)));
      }
    }
    return pixels;
  }

private:
  // Letters of 5 x 7 dots, each 2 rows high and 1 column wide.
  template <class Put>
  static void Write(const Put& put, int x, int y, int letters, unsigned text)
  {
    std::minstd_rand random(text + 1);
    for (int letter = 0; letter < letters; ++letter)
    {
      const bool isBlank = random() % 6 == 0;
      for (int dot = 0; dot < 35; ++dot)
      {
        if (random() % 2 == 0 && !isBlank)
        {
          put(x + 8 * letter + dot % 5, y + 2 * (dot / 5), 200);
          put(x + 8 * letter + dot % 5, y + 2 * (dot / 5) + 1, 200);
        }
      }
    }
  }
};

/// Frames of a screen, kept.
class TestFrames
{
public:
  TestFrames(const TestScreen& screen, int count)
  {
    for (int n = 0; n < count; ++n)
    {
      this->Pixels.push_back(screen.Draw(n));
    }
    for (const std::vector<std::uint8_t>& pixels : this->Pixels)
    {
      SliceImage slice;
      slice.Pixels = pixels.data();
      slice.RowStride = slice.Width = screen.Width;
      slice.Height = screen.Height;
      this->Frames.push_back(slice);
    }
  }
  std::vector<SliceImage> Frames;
  std::vector<std::vector<std::uint8_t>> Pixels;
};
}
#endif
