// SPDX-License-Identifier: BSD-3-Clause
/// A region is proposed for made-up scanners whose probe is in a dark bath: wires move, faint streaks
/// come and go, and all else is black.
#include "lacunaScanOutline.h"

#include "lacunaTestScreen.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>

using namespace lacuna;

namespace
{
constexpr int DifferentScreens = 5; // they take long to draw

struct Bath
{
  const char* Name;
  std::optional<Fan> Sector;
  std::array<int, 4> Window; ///< first column and row, width and height, that cut the sector
  int Streaks = 120;         ///< in each frame
  bool HasFace = true;       ///< of the transducer, still
};

const std::vector<Bath>& GetSectors()
{
  static const std::vector<Bath> baths{
    { "curved", Fan{ { 345, -20 }, { -30, 33 }, { 70, 440 } }, { 100, 30, 490, 480 } },
    { "upside down", Fan{ { 335, 520 }, { 148, 215 }, { 50, 420 } }, { 100, 30, 490, 480 }, 120,
      false },
    { "cut by a window", Fan{ { 350, 20 }, { -58, 55 }, { 60, 430 } }, { 110, 30, 460, 480 } },
    { "upside down and cut", Fan{ { 340, 500 }, { 124, 236 }, { 55, 430 } },
      { 110, 30, 455, 480 } },
    { "without a face", Fan{ { 345, -20 }, { -36, 30 }, { 90, 440 } }, { 100, 30, 490, 480 }, 120,
      false },
  };
  return baths;
}

const std::vector<Bath>& GetRectangles()
{
  static const std::vector<Bath> baths{
    { "linear", {}, { 150, 60, 410, 400 } },
    { "narrow", {}, { 260, 45, 170, 450 } },
    { "few streaks", {}, { 120, 60, 440, 380 }, 12 },
  };
  return baths;
}

// Frames of a screen with a bath in it.
class BathFrames
{
public:
  BathFrames(const TestScreen& screen, const Bath& bath, int count = 24)
    : Width(screen.Width)
    , Height(screen.Height)
    , Drawn(screen, std::min(count, DifferentScreens))
    , IsText(std::size_t(screen.Width * screen.Height), false)
    , Changes(IsText)
  {
    if (bath.Sector)
    {
      this->Mask.emplace(*bath.Sector, this->Width, this->Height, Vec2{ 1, 1 });
    }
    this->Window = bath.Window;
    TestScreen texts = screen;
    texts.Noise = 0;
    const std::vector<std::uint8_t> first = texts.Draw(0), second = texts.Draw(1);
    for (std::size_t i = 0; i < this->IsText.size(); ++i)
    {
      this->IsText[i] = first[i] > 20 || second[i] > 20;
    }
    this->Drawn.Pixels.reserve(std::size_t(count));
    for (int n = DifferentScreens; n < count; ++n)
    {
      this->Drawn.Pixels.push_back(this->Drawn.Pixels[std::size_t(n % DifferentScreens)]);
      this->Drawn.Frames.push_back(this->Drawn.Frames.front());
      this->Drawn.Frames.back().Pixels = this->Drawn.Pixels.back().data();
    }
    for (int n = 0; n < count; ++n)
    {
      this->DrawBath(bath, n);
    }
    const auto size = std::size_t(this->Width * this->Height);
    for (std::size_t i = 0; i < size; ++i)
    {
      const int column = int(i) % this->Width, row = int(i) / this->Width;
      // that it is seen above the noise
      for (const std::vector<std::uint8_t>& frame : this->Drawn.Pixels)
      {
        this->Changes[i] = this->Changes[i] ||
          (this->Sees(column, row) &&
            std::abs(frame[i] - this->Drawn.Pixels.front()[i]) > 8 * screen.Noise);
      }
    }
  }

  bool Sees(int x, int y) const
  {
    const std::array<int, 4>& w = this->Window;
    return x >= w[0] && x < w[0] + w[2] && y >= w[1] && y < w[1] + w[3] &&
      (!this->Mask || this->Mask->Contains(x, y));
  }

  const std::vector<SliceImage>& Get() const { return this->Drawn.Frames; }

  int Width, Height;
  TestFrames Drawn;
  std::vector<bool> IsText; ///< of the screen: letters, ruler, logo, bar
  std::vector<bool> Changes;

private:
  void DrawBath(const Bath& bath, int n)
  {
    std::vector<std::uint8_t>& pixels = this->Drawn.Pixels[std::size_t(n)];
    std::mt19937 random(5u + 100u * unsigned(n));
    std::uniform_real_distribution<double> u(0, 1);
    const auto put = [&](int x, int y, double level)
    {
      if (x >= 0 && x < this->Width && y >= 0 && y < this->Height && this->Sees(x, y))
      {
        std::uint8_t& pixel = pixels[std::size_t(y * this->Width + x)];
        pixel = std::uint8_t(std::clamp(std::max(level, double(pixel)), 0.0, 255.0));
      }
    };
    const auto spot = [&](double x, double y, double width, double height, double level)
    {
      for (int dy = -int(3 * height); dy <= int(3 * height); ++dy)
      {
        for (int dx = -int(3 * width); dx <= int(3 * width); ++dx)
        {
          const double distance = dx * dx / width / width + dy * dy / height / height;
          const double grey = level * std::exp(-0.5 * distance);
          put(int(x) + dx, int(y) + dy, grey < 3 ? 0 : grey);
        }
      }
    };
    const std::array<int, 4>& w = bath.Window;
    for (int wire = 0; wire < 9; ++wire) // which wander, three in a row, not in the middle
    {
      spot(w[0] + w[2] * (0.16 + 0.3 * (wire % 3)) + 2.5 * n * (wire % 3 == 1 ? 1 : 0.4),
        w[1] + w[3] * (0.25 + 0.22 * (wire / 3.0)) + 8 * std::sin(0.4 * n), 7, 3, 300);
    }
    for (int streak = 0; streak < bath.Streaks; ++streak)
    {
      spot(w[0] + w[2] * u(random), w[1] + w[3] * u(random), 3, 1.2, 5 + 20 * u(random));
    }
    if (bath.Streaks < 100) // the bottom, in a part of the frames
    {
      for (int x = 0; x < w[2] && n % 4 == 1; ++x)
      {
        spot(w[0] + x, w[1] + 0.9 * w[3] + 0.05 * x, 1, 4, 90);
      }
    }
    if (bath.HasFace && this->Mask)
    {
      const Fan& fan = *bath.Sector;
      for (int y = 0; y < this->Height; ++y)
      {
        for (int x = 0; x < this->Width; ++x)
        {
          if (std::hypot(x - fan.Origin[0], y - fan.Origin[1]) < fan.Radii[0] + 9)
          {
            put(x, y, 190);
          }
        }
      }
    }
  }
  std::optional<FanMask> Mask;
  std::array<int, 4> Window{ 0, 0, 0, 0 };
};

ScanRegion Propose(const std::vector<SliceImage>& frames, const Vec2& spacing = { 1, 1 })
{
  ScanOutline outline;
  for (const SliceImage& frame : frames)
  {
    outline.Put(frame);
  }
  return outline.Propose(spacing);
}

struct Measured
{
  double Overlap = 0;   ///< with the truth: of both by of any
  double Contained = 0; ///< part of the changing pixels
  int Texts = 0;        ///< pixels
};

Measured Measure(const BathFrames& bath, const ScanRegion& region)
{
  std::optional<FanMask> mask;
  if (region.Fan.IsSector)
  {
    mask.emplace(region.Fan.Sector, bath.Width, bath.Height, Vec2{ 1, 1 });
  }
  const std::array<int, 4>& r = region.Fan.Rectangle;
  double both = 0, any = 0, changes = 0, contained = 0;
  Measured measured;
  for (int y = 0; y < bath.Height; ++y)
  {
    for (int x = 0; x < bath.Width; ++x)
    {
      const auto i = std::size_t(y * bath.Width + x);
      const bool found = x >= r[0] && x < r[0] + r[2] && y >= r[1] && y < r[1] + r[3] &&
        (!mask || mask->Contains(x, y));
      const bool is = bath.Sees(x, y);
      both += found && is ? 1 : 0;
      any += found || is ? 1 : 0;
      changes += bath.Changes[i] ? 1 : 0;
      contained += bath.Changes[i] && found ? 1 : 0;
      measured.Texts += bath.IsText[i] && found ? 1 : 0;
    }
  }
  measured.Overlap = both / any;
  measured.Contained = contained / changes;
  return measured;
}

TestScreen GetAnalogue()
{
  TestScreen screen;
  screen.Noise = 1;
  screen.Blur = 0.7;
  return screen;
}

void ExpectProposed(const Bath& bath, const TestScreen& screen, double overlap, const char* what)
{
  const BathFrames frames(screen, bath);
  const ScanRegion region = Propose(frames.Get());
  ASSERT_TRUE(region.IsFound) << bath.Name << ", " << what << ": " << region.Text;
  const Measured measured = Measure(frames, region);
  std::printf("%s, %s: %s, overlap %.3f, contained %.5f, texts %d, confidence %.2f\n", bath.Name,
    what, region.Fan.IsSector ? "sector" : "rectangle", measured.Overlap, measured.Contained,
    measured.Texts, region.Confidence);
  EXPECT_EQ(region.Fan.IsSector, bath.Sector.has_value()) << bath.Name << ", " << what;
  EXPECT_GE(measured.Overlap, overlap) << bath.Name << ", " << what;
  if (bath.Sector && bath.HasFace)
  {
    EXPECT_NEAR(region.Fan.Sector.Radii[0], bath.Sector->Radii[0], 4) << bath.Name << ", " << what;
  }
  EXPECT_GE(measured.Contained, 0.999) << bath.Name << ", " << what;
  EXPECT_EQ(measured.Texts, 0) << bath.Name << ", " << what;
  EXPECT_GT(region.Confidence, 0.1);
  EXPECT_LT(region.Confidence, 0.5);
  EXPECT_NE(region.Text.find("the true region may be larger"), std::string::npos) << region.Text;
}
}

TEST(ScanOutline, SectorsInADarkBath)
{
  for (const Bath& bath : GetSectors())
  {
    ExpectProposed(bath, TestScreen(), 0.985, "plain");
  }
}

TEST(ScanOutline, SectorsInAnalogueVideo)
{
  for (const Bath& bath : { GetSectors()[0], GetSectors()[3] })
  {
    ExpectProposed(bath, GetAnalogue(), 0.985, "analogue video");
  }
}

TEST(ScanOutline, RectanglesInADarkBath)
{
  for (const Bath& bath : GetRectangles())
  {
    ExpectProposed(bath, TestScreen(), 0.99, "plain");
  }
  ExpectProposed(GetRectangles()[2], GetAnalogue(), 0.99, "analogue video");
}

// A recording that was cut to the image: lines one pixel wide belong to it, single pixels do not.
TEST(ScanOutline, ScreenWithoutTexts)
{
  TestScreen screen;
  screen.HasTexts = screen.Depth.IsDrawn = false;
  ExpectProposed(GetSectors()[0], screen, 0.985, "no texts");
  BathFrames frames(screen, GetRectangles()[0]);
  const std::array<int, 4> w = GetRectangles()[0].Window;
  std::vector<std::uint8_t>& pixels = frames.Drawn.Pixels[3];
  pixels[std::size_t(20 * frames.Width + 30)] = 255;
  for (int x = 300; x < 320; ++x)
  {
    pixels[std::size_t((w[1] - 12) * frames.Width + x)] = 5;
  }
  const ScanRegion region = Propose(frames.Get());
  EXPECT_EQ(region.Fan.Rectangle, (std::array<int, 4>{ w[0], w[1] - 12, w[2], w[3] + 12 }));
}

// What the two other ways can say of it: nothing that could be trusted.
TEST(ScanOutline, IsNeededInADarkBath)
{
  for (const Bath& bath : { GetSectors()[0], GetRectangles()[2] })
  {
    const ScanRegion region = FindScanRegion(BathFrames(TestScreen(), bath).Get(), { 1, 1 });
    EXPECT_FALSE(region.IsFound) << bath.Name << ": " << region.Text;
  }
}

// Wires alone tell no sector: what holds them is proposed.
TEST(ScanOutline, WiresAloneGiveARectangle)
{
  Bath bath = GetSectors().front();
  bath.Streaks = 0;
  bath.HasFace = false;
  const BathFrames frames(TestScreen(), bath);
  const ScanRegion region = Propose(frames.Get());
  ASSERT_TRUE(region.IsFound) << region.Text;
  EXPECT_FALSE(region.Fan.IsSector);
  const Measured measured = Measure(frames, region);
  EXPECT_GE(measured.Contained, 0.999);
  EXPECT_EQ(measured.Texts, 0);
}

// An oblique bottom: what changes has oblique sides, but no arc.
TEST(ScanOutline, ObliqueBottomIsNoSector)
{
  const TestScreen screen;
  TestFrames screens(screen, 4);
  for (const double slope : { 0.3, 0.5, 0.7 })
  {
    for (std::size_t n = 0; n < 4; ++n)
    {
      std::mt19937 random(n + 1);
      for (int y = 60; y < 460; ++y)
      {
        for (int x = 150; x < 560; ++x)
        {
          screens.Pixels[n][std::size_t(y * screen.Width + x)] =
            y < 90 + slope * (560 - x) || random() % 4 > 0 ? 0 : std::uint8_t(random() % 60);
        }
      }
    }
    const ScanRegion region = Propose(screens.Frames);
    ASSERT_TRUE(region.IsFound) << region.Text;
    EXPECT_FALSE(region.Fan.IsSector)
      << slope << ": " << region.Fan.Sector.Origin[0] << " " << region.Fan.Sector.Origin[1];
  }
}

TEST(ScanOutline, NothingIsProposedWhereNothingMoves)
{
  const auto expectNone = [](const std::vector<SliceImage>& frames, const char* what)
  {
    const ScanRegion region = Propose(frames);
    EXPECT_FALSE(region.IsFound) << what << ": " << region.Text;
    EXPECT_EQ(region.Text.find("besides texts"), 0U) << what << ": " << region.Text;
  };
  TestScreen screen;
  for (const double noise : { 0.0, 1.5 })
  {
    screen.Noise = noise;
    screen.Sees = {};
    expectNone(TestFrames(screen, 12).Frames, "a clock"); // which runs in each frame
    screen.Sees = [](double x, double y) { return x >= 150 && x < 560 && y >= 60 && y < 460; };
    const TestFrames frozen(screen, 1);
    expectNone(std::vector<SliceImage>(8, frozen.Frames.front()), "frozen");
  }
  const BathFrames few(TestScreen(), GetRectangles().front(), 2);
  EXPECT_FALSE(Propose(few.Get()).IsFound);
  EXPECT_NE(Propose(few.Get()).Text.find("3 frames"), std::string::npos);
}

TEST(ScanOutline, OtherTypesGiveTheSame)
{
  const BathFrames frames(TestScreen(), GetSectors().front());
  const ScanRegion bytes = Propose(frames.Get());
  std::vector<std::vector<float>> pixels;
  std::vector<SliceImage> slices;
  for (const std::vector<std::uint8_t>& frame : frames.Drawn.Pixels)
  {
    pixels.emplace_back();
    for (const std::uint8_t level : frame)
    {
      pixels.back().push_back(4.F * float(level) - 100);
    }
  }
  for (std::size_t n = 0; n < pixels.size(); ++n)
  {
    slices.push_back(frames.Get()[n]);
    slices.back().Type = ScalarType::Float32;
    slices.back().Pixels = pixels[n].data();
  }
  const ScanRegion floats = Propose(slices);
  ASSERT_TRUE(bytes.IsFound && floats.IsFound);
  EXPECT_EQ(bytes.Fan.Rectangle, floats.Fan.Rectangle);
  EXPECT_EQ(bytes.Fan.Sector.Radii, floats.Fan.Sector.Radii);
  EXPECT_EQ(bytes.Fan.Sector.Angles, floats.Fan.Sector.Angles);
}

// Rows that are farther apart than columns: the same picture, said in other units.
TEST(ScanOutline, OblongPixels)
{
  const BathFrames frames(TestScreen(), GetSectors().front());
  const ScanRegion square = Propose(frames.Get()), half = Propose(frames.Get(), { 0.5, 0.5 });
  for (std::size_t i = 0; i < 2; ++i)
  {
    EXPECT_NEAR(half.Fan.Sector.Radii[i], 0.5 * square.Fan.Sector.Radii[i], 1e-9);
  }
  // every second row
  std::vector<SliceImage> rows = frames.Get();
  for (SliceImage& slice : rows)
  {
    slice.RowStride *= 2;
    slice.Height /= 2;
  }
  const ScanRegion oblong = Propose(rows, { 1, 2 });
  ASSERT_TRUE(oblong.Fan.IsSector) << oblong.Text;
  EXPECT_NEAR(oblong.Fan.Sector.Radii[1], square.Fan.Sector.Radii[1], 12);
  EXPECT_NEAR(oblong.Fan.Sector.Origin[0], square.Fan.Sector.Origin[0], 12);
}

TEST(ScanOutline, WrongFrames)
{
  const BathFrames frames(TestScreen(), GetRectangles().front(), 3);
  ScanOutline outline;
  outline.Put(frames.Get()[0]);
  SliceImage smaller = frames.Get()[1];
  smaller.Height -= 1;
  EXPECT_THROW(outline.Put(smaller), std::invalid_argument);
  EXPECT_THROW(outline.Propose({ 1, 0 }), std::invalid_argument);
  EXPECT_THROW(
    outline.Propose({ std::numeric_limits<double>::quiet_NaN(), 1 }), std::invalid_argument);
  smaller.Height = 8;
  EXPECT_THROW(ScanOutline().Put(smaller), std::invalid_argument);
}

// Blocks of noise, of one grey and of what is no number, in all sizes: an answer, whichever.
TEST(ScanOutline, AnyFramesHaveAnAnswer)
{
  std::mt19937 random(12);
  int found = 0;
  for (int n = 0; n < 60; ++n)
  {
    const int width = 16 + int(random() % 60), height = 16 + int(random() % 60);
    ScanOutline outline;
    for (std::size_t frame = 0; frame < 3 + random() % 4; ++frame)
    {
      std::vector<float> pixels(std::size_t(width * height), float(n % 3));
      for (int block = int(random() % 4); block >= 0; --block)
      {
        const int left = int(random() % unsigned(width)), top = int(random() % unsigned(height));
        const int kind = int(random() % 5);
        for (int y = top; y < std::min(height, top + int(random() % 60)); ++y)
        {
          for (int x = left; x < std::min(width, left + 40); ++x)
          {
            pixels[std::size_t(y * width + x)] = kind == 0 ? std::numeric_limits<float>::quiet_NaN()
              : kind == 1                                  ? std::numeric_limits<float>::infinity()
              : kind == 2                                  ? 3e38F * (random() % 2 ? 1 : -1)
                                                           : float(random() % 200);
          }
        }
      }
      SliceImage slice;
      slice.Type = ScalarType::Float32;
      slice.Pixels = pixels.data();
      slice.RowStride = slice.Width = width;
      slice.Height = height;
      outline.Put(slice);
    }
    const ScanRegion region = outline.Propose({ 1, 1 });
    EXPECT_FALSE(region.Text.empty());
    if (region.IsFound)
    {
      ++found;
      EXPECT_TRUE(region.Confidence >= 0 && region.Confidence < 0.5);
      EXPECT_GE(region.Fan.Rectangle[0], 0);
      EXPECT_LE(region.Fan.Rectangle[0] + region.Fan.Rectangle[2], width);
      EXPECT_LE(region.Fan.Rectangle[1] + region.Fan.Rectangle[3], height);
      if (region.Fan.IsSector)
      {
        EXPECT_NO_THROW(FanMask(region.Fan.Sector, width, height, { 1, 1 }));
      }
    }
  }
  EXPECT_GT(found, 10);
}
