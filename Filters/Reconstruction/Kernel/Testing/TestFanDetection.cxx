// SPDX-License-Identifier: BSD-3-Clause
/// The fan is found on the screens of made-up scanners, and not invented where there is none.
#include "lacunaFanDetection.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

using namespace lacuna;

namespace
{
constexpr int Width = 320;
constexpr int Height = 240;

// What the screen of a scanner shows besides the fan.
struct Screen
{
  Vec2 PixelSpacing{ 0.3, 0.3 };
  int Slices = 24;
  std::function<bool(int, int)> Sees; ///< what the probe sees
  bool Texts = true;                  ///< letters and a ruler, and a clock that changes
  bool Shadow = true;                 ///< a dark part of the fan, and a dark deep end
  double ShotNoise = 0;               ///< part of the pixels that are white for no reason
  int Noise = 0;                      ///< of the recorder, everywhere: -Noise..Noise
};

class Recording
{
public:
  explicit Recording(const Screen& screen)
    : Random(7)
    , Pixels(static_cast<std::size_t>(screen.Slices),
        std::vector<std::uint8_t>(static_cast<std::size_t>(Width) * Height))
  {
    std::uniform_real_distribution<double> u(0, 1);
    for (int n = 0; n < screen.Slices; ++n)
    {
      for (int y = 0; y < Height; ++y)
      {
        for (int x = 0; x < Width; ++x)
        {
          double grey = 0;
          if (screen.Sees(x, y))
          {
            const bool dark = screen.Shadow &&
              (std::abs(x - 190) < 18 || std::hypot(x - 120, y - 130) < 20 || y > 190);
            // Rayleigh speckle; three levels of it in the dark
            grey = (dark ? 2 : 50) * std::sqrt(-2 * std::log(1 - u(this->Random)));
          }
          if (screen.Texts)
          {
            grey = std::max(grey, GetText(x, y, n));
          }
          if (screen.Noise > 0)
          {
            grey += std::floor((2 * screen.Noise + 1) * u(this->Random)) - screen.Noise;
          }
          if (u(this->Random) < screen.ShotNoise)
          {
            grey = 255;
          }
          this->At(n, x, y) = static_cast<std::uint8_t>(std::min(255.0, std::max(0.0, grey)));
        }
      }
      SliceImage slice;
      slice.Pixels = this->Pixels[static_cast<std::size_t>(n)].data();
      slice.RowStride = Width;
      slice.Width = Width;
      slice.Height = Height;
      this->Slices.push_back(slice);
    }
  }

  std::uint8_t& At(int n, int x, int y)
  {
    return this->Pixels[static_cast<std::size_t>(n)][static_cast<std::size_t>(y * Width + x)];
  }

  std::vector<SliceImage> Slices;

private:
  // Strokes 2 pixels wide of letters 8 x 10 pixels, 0 elsewhere.
  static double GetStroke(int x, int y, unsigned int letter)
  {
    if (x < 0 || y < 0 || x >= 8 || y >= 10)
    {
      return 0;
    }
    const bool strokes[5] = { x < 2, x >= 4 && x < 6, y < 2, y >= 4 && y < 6, y >= 8 };
    for (unsigned int s = 0; s < 5; ++s)
    {
      if (((letter >> s) & 1) && strokes[s])
      {
        return 200;
      }
    }
    return 0;
  }

  static double GetText(int x, int y, int n)
  {
    double grey = 0;
    for (int letter = 0; letter < 9; ++letter)
    {
      grey = std::max(grey, GetStroke(x - 4 - 10 * letter, y - 3, 5u + 3u * letter));
      // a clock, whose last figures change all the time
      grey = std::max(grey,
        GetStroke(x - 225 - 10 * letter, y - 3, letter < 5 ? 11u : 1u + (7u * n + letter) % 30));
    }
    // a ruler with ticks at the right
    if ((x == 312 && y > 20) || (x > 305 && x <= 312 && y % 20 == 0 && y > 20))
    {
      grey = 180;
    }
    return grey;
  }

  std::mt19937 Random;
  std::vector<std::vector<std::uint8_t>> Pixels;
};

// Part of the pixels of either that are pixels of both.
double GetOverlap(const FanMask& a, const FanMask& b)
{
  double both = 0;
  double any = 0;
  for (int y = 0; y < Height; ++y)
  {
    for (int x = 0; x < Width; ++x)
    {
      both += a.Contains(x, y) && b.Contains(x, y) ? 1 : 0;
      any += a.Contains(x, y) || b.Contains(x, y) ? 1 : 0;
    }
  }
  return both / any;
}

struct Case
{
  const char* Name;
  Fan Truth;
  Vec2 PixelSpacing;
};

// Curved, phased, wide, steered, cut off by the image, of pixels that are not square.
const std::vector<Case>& GetCases()
{
  static const std::vector<Case> cases{
    { "curved", { { 160, -40 }, { -32, 32 }, { 18, 78 } }, { 0.3, 0.3 } },
    { "phased", { { 158, 16 }, { -44, 44 }, { 0, 62 } }, { 0.3, 0.3 } },
    { "wide", { { 160, 10 }, { -62, 62 }, { 4, 50 } }, { 0.3, 0.3 } },
    { "steered", { { 120, -10 }, { -20, 38 }, { 10, 70 } }, { 0.3, 0.3 } },
    { "cut off", { { 160, -60 }, { -48, 48 }, { 24, 100 } }, { 0.3, 0.3 } },
    { "oblong pixels", { { 160, -30 }, { -35, 35 }, { 14, 95 } }, { 0.3, 0.4 } },
  };
  return cases;
}

void ExpectFound(const Case& c, Screen screen, const char* what, double overlap = 0.98)
{
  const FanMask truth(c.Truth, Width, Height, c.PixelSpacing);
  screen.PixelSpacing = c.PixelSpacing;
  screen.Sees = [&](int x, int y) { return truth.Contains(x, y); };
  Recording recording(screen);
  DetectedFan found;
  ASSERT_NO_THROW(found = DetectFan(recording.Slices, c.PixelSpacing)) << c.Name << ", " << what;
  ASSERT_TRUE(found.IsSector) << c.Name << ", " << what;
  const FanMask mask(found.Sector, Width, Height, c.PixelSpacing);
  EXPECT_GT(GetOverlap(mask, truth), overlap)
    << c.Name << ", " << what << ": origin " << found.Sector.Origin[0] << ", "
    << found.Sector.Origin[1] << ", angles " << found.Sector.Angles[0] << ", "
    << found.Sector.Angles[1] << ", radii " << found.Sector.Radii[0] << ", "
    << found.Sector.Radii[1];
  for (std::size_t i = 0; i < 2; ++i)
  {
    EXPECT_NEAR(found.Sector.Angles[i], c.Truth.Angles[i], 0.6) << c.Name << ", " << what;
  }
  // the box holds all of it, and no more
  int box[4] = { Width, Height, -1, -1 };
  for (int y = 0; y < Height; ++y)
  {
    for (int x = 0; x < Width; ++x)
    {
      if (mask.Contains(x, y))
      {
        box[0] = std::min(box[0], x);
        box[1] = std::min(box[1], y);
        box[2] = std::max(box[2], x);
        box[3] = std::max(box[3], y);
      }
    }
  }
  EXPECT_EQ(found.Rectangle,
    (std::array<int, 4>{ box[0], box[1], box[2] - box[0] + 1, box[3] - box[1] + 1 }));
}

std::string GetRefusal(const std::vector<SliceImage>& slices)
{
  try
  {
    const DetectedFan found = DetectFan(slices, { 0.3, 0.3 });
    return std::string("found a ") + (found.IsSector ? "sector" : "rectangle");
  }
  catch (const std::runtime_error& error)
  {
    return error.what();
  }
}
}

TEST(FanDetection, SectorsOnAnEmptyScreen)
{
  Screen screen;
  screen.Texts = false;
  screen.Shadow = false;
  for (const Case& c : GetCases())
  {
    ExpectFound(c, screen, "empty", 0.99);
  }
}

TEST(FanDetection, SectorsAmongTextsWithDarkParts)
{
  for (const Case& c : GetCases())
  {
    ExpectFound(c, Screen(), "texts");
  }
}

TEST(FanDetection, ShotNoise)
{
  for (const Case& c : GetCases())
  {
    Screen screen;
    screen.ShotNoise = 0.01;
    ExpectFound(c, screen, "shot noise");
  }
}

TEST(FanDetection, NoisyRecorder)
{
  for (const Case& c : GetCases())
  {
    Screen screen;
    screen.Noise = 3;
    screen.Shadow = false;
    ExpectFound(c, screen, "noise", 0.97);
  }
}

TEST(FanDetection, FewSlices)
{
  for (const int slices : { 3, 4, 6 })
  {
    for (const Case& c : GetCases())
    {
      Screen screen;
      screen.Slices = slices;
      ExpectFound(c, screen, "few slices", 0.97);
    }
  }
}

TEST(FanDetection, ProbeAtTheBottom)
{
  const Case c{ "upside down", { { 160, 279 }, { 150, 214 }, { 18, 78 } }, { 0.3, 0.3 } };
  ExpectFound(c, Screen(), "upside down");
}

TEST(FanDetection, LinearProbe)
{
  for (const double shots : { 0.0, 0.01 })
  {
    for (const int noise : { 0, 3 })
    {
      Screen screen;
      screen.ShotNoise = shots;
      screen.Noise = noise;
      screen.Shadow = noise == 0; // darker than the noise of the recorder is as good as outside
      screen.Sees = [](int x, int y) { return x >= 62 && x < 240 && y >= 20 && y < 221; };
      Recording recording(screen);
      const DetectedFan found = DetectFan(recording.Slices, { 0.3, 0.3 });
      EXPECT_FALSE(found.IsSector);
      EXPECT_EQ(found.Rectangle, (std::array<int, 4>{ 62, 20, 178, 201 }))
        << "shots " << shots << ", noise " << noise;
    }
  }
}

TEST(FanDetection, CroppedRecordingIsAllFan)
{
  Screen screen;
  screen.Texts = false;
  screen.Sees = [](int, int) { return true; };
  Recording recording(screen);
  const DetectedFan found = DetectFan(recording.Slices, { 0.3, 0.3 });
  EXPECT_FALSE(found.IsSector);
  EXPECT_EQ(found.Rectangle, (std::array<int, 4>{ 0, 0, Width, Height }));
}

TEST(FanDetection, OtherTypesOfGreyLevels)
{
  const Case& c = GetCases().front();
  const FanMask truth(c.Truth, Width, Height, c.PixelSpacing);
  Screen screen;
  screen.Sees = [&](int x, int y) { return truth.Contains(x, y); };
  Recording recording(screen);
  std::vector<std::vector<float>> floats;
  std::vector<SliceImage> slices = recording.Slices;
  for (SliceImage& slice : slices)
  {
    const auto* bytes = static_cast<const std::uint8_t*>(slice.Pixels);
    floats.emplace_back(bytes, bytes + Width * Height);
    for (float& value : floats.back())
    {
      value = 0.001F * value - 3; // decibels, say
    }
    floats.back()[5] = std::numeric_limits<float>::quiet_NaN();
  }
  for (std::size_t n = 0; n < slices.size(); ++n)
  {
    slices[n].Pixels = floats[n].data();
    slices[n].Type = ScalarType::Float32;
  }
  const DetectedFan ofBytes = DetectFan(recording.Slices, c.PixelSpacing);
  const DetectedFan ofFloats = DetectFan(slices, c.PixelSpacing);
  EXPECT_TRUE(ofFloats.IsSector);
  EXPECT_NEAR(ofFloats.Sector.Radii[1], ofBytes.Sector.Radii[1], 0.3);
}

TEST(FanDetection, RefusesWhenUnsure)
{
  Screen screen;
  // a circle, a triangle that stands on its base beside a bar, nothing but noise, a blot
  screen.Sees = [](int x, int y) { return std::hypot(x - 150, y - 120) < 80; };
  EXPECT_NE(
    GetRefusal(Recording(screen).Slices).find("cannot be found for certain"), std::string::npos)
    << GetRefusal(Recording(screen).Slices);
  screen.Sees = [](int x, int y)
  { return (x > 40 && x < 280 && y > 60 && y < 100) || (x > 140 && x < 180 && y > 60 && y < 220); };
  EXPECT_NE(
    GetRefusal(Recording(screen).Slices).find("cannot be found for certain"), std::string::npos)
    << GetRefusal(Recording(screen).Slices);
  screen.Sees = [](int, int) { return false; };
  const std::string nothing = GetRefusal(Recording(screen).Slices);
  EXPECT_NE(nothing.find("cannot be found"), std::string::npos) << nothing;
  screen.Texts = false;
  EXPECT_NE(GetRefusal(Recording(screen).Slices).find("nothing changes"), std::string::npos);
  screen.ShotNoise = 0.02;
  const std::string noise = GetRefusal(Recording(screen).Slices);
  EXPECT_NE(noise.find("cannot be found"), std::string::npos) << noise;
  screen.Slices = 2;
  EXPECT_NE(GetRefusal(Recording(screen).Slices).find("at least 3"), std::string::npos);
}
