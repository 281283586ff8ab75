// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaUltrasoundEmulator.h"

#include "lacunaCounterNoise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <utility>

namespace lacuna
{
namespace
{
// Letters on an emulated screen.

// An 8-bit image, the top line first; does not own it.
struct GreyScreen
{
  int Columns = 0;
  int Rows = 0;
  std::uint8_t* Pixels = nullptr;

  // Nothing outside of the image.
  void Set(int column, int row, std::uint8_t level) const
  {
    if (column >= 0 && column < this->Columns && row >= 0 && row < this->Rows)
    {
      this->Pixels[static_cast<std::int64_t>(row) * this->Columns + column] = level;
    }
  }
  // A bar of columns x rows pixels.
  void Fill(int column, int row, int columns, int rows, std::uint8_t level) const;
};

// Of a letter with the gap after it, pixels.
constexpr int TextAdvance = 12;
constexpr int TextHeight = 14;

constexpr int Scale = 2;
constexpr int LetterColumns = 5;
constexpr int LetterRows = 7;

// Lines from the top, the leftmost pixel in bit 4.
struct Letter
{
  char Name;
  std::array<std::uint8_t, LetterRows> Lines;
};

constexpr std::array<Letter, 40> Letters{ {
  { '0', { 0x0e, 0x11, 0x13, 0x15, 0x19, 0x11, 0x0e } },
  { '1', { 0x04, 0x0c, 0x04, 0x04, 0x04, 0x04, 0x0e } },
  { '2', { 0x0e, 0x11, 0x01, 0x02, 0x04, 0x08, 0x1f } },
  { '3', { 0x1f, 0x02, 0x04, 0x02, 0x01, 0x11, 0x0e } },
  { '4', { 0x02, 0x06, 0x0a, 0x12, 0x1f, 0x02, 0x02 } },
  { '5', { 0x1f, 0x10, 0x1e, 0x01, 0x01, 0x11, 0x0e } },
  { '6', { 0x06, 0x08, 0x10, 0x1e, 0x11, 0x11, 0x0e } },
  { '7', { 0x1f, 0x01, 0x02, 0x04, 0x08, 0x08, 0x08 } },
  { '8', { 0x0e, 0x11, 0x11, 0x0e, 0x11, 0x11, 0x0e } },
  { '9', { 0x0e, 0x11, 0x11, 0x0f, 0x01, 0x02, 0x0c } },
  { 'A', { 0x0e, 0x11, 0x11, 0x1f, 0x11, 0x11, 0x11 } },
  { 'B', { 0x1e, 0x11, 0x11, 0x1e, 0x11, 0x11, 0x1e } },
  { 'C', { 0x0e, 0x11, 0x10, 0x10, 0x10, 0x11, 0x0e } },
  { 'D', { 0x1c, 0x12, 0x11, 0x11, 0x11, 0x12, 0x1c } },
  { 'E', { 0x1f, 0x10, 0x10, 0x1e, 0x10, 0x10, 0x1f } },
  { 'F', { 0x1f, 0x10, 0x10, 0x1e, 0x10, 0x10, 0x10 } },
  { 'G', { 0x0e, 0x11, 0x10, 0x17, 0x11, 0x11, 0x0f } },
  { 'H', { 0x11, 0x11, 0x11, 0x1f, 0x11, 0x11, 0x11 } },
  { 'I', { 0x0e, 0x04, 0x04, 0x04, 0x04, 0x04, 0x0e } },
  { 'J', { 0x07, 0x02, 0x02, 0x02, 0x02, 0x12, 0x0c } },
  { 'K', { 0x11, 0x12, 0x14, 0x18, 0x14, 0x12, 0x11 } },
  { 'L', { 0x10, 0x10, 0x10, 0x10, 0x10, 0x10, 0x1f } },
  { 'M', { 0x11, 0x1b, 0x15, 0x15, 0x11, 0x11, 0x11 } },
  { 'N', { 0x11, 0x11, 0x19, 0x15, 0x13, 0x11, 0x11 } },
  { 'O', { 0x0e, 0x11, 0x11, 0x11, 0x11, 0x11, 0x0e } },
  { 'P', { 0x1e, 0x11, 0x11, 0x1e, 0x10, 0x10, 0x10 } },
  { 'Q', { 0x0e, 0x11, 0x11, 0x11, 0x15, 0x12, 0x0d } },
  { 'R', { 0x1e, 0x11, 0x11, 0x1e, 0x14, 0x12, 0x11 } },
  { 'S', { 0x0f, 0x10, 0x10, 0x0e, 0x01, 0x01, 0x1e } },
  { 'T', { 0x1f, 0x04, 0x04, 0x04, 0x04, 0x04, 0x04 } },
  { 'U', { 0x11, 0x11, 0x11, 0x11, 0x11, 0x11, 0x0e } },
  { 'V', { 0x11, 0x11, 0x11, 0x11, 0x11, 0x0a, 0x04 } },
  { 'W', { 0x11, 0x11, 0x11, 0x15, 0x15, 0x15, 0x0a } },
  { 'X', { 0x11, 0x11, 0x0a, 0x04, 0x0a, 0x11, 0x11 } },
  { 'Y', { 0x11, 0x11, 0x11, 0x0a, 0x04, 0x04, 0x04 } },
  { 'Z', { 0x1f, 0x01, 0x02, 0x04, 0x08, 0x10, 0x1f } },
  { '.', { 0x00, 0x00, 0x00, 0x00, 0x00, 0x0c, 0x0c } },
  { ':', { 0x00, 0x0c, 0x0c, 0x00, 0x0c, 0x0c, 0x00 } },
  { '-', { 0x00, 0x00, 0x00, 0x1f, 0x00, 0x00, 0x00 } },
  { '/', { 0x00, 0x01, 0x02, 0x04, 0x08, 0x10, 0x00 } },
} };

void GreyScreen::Fill(int column, int row, int columns, int rows, std::uint8_t level) const
{
  for (int j = row; j < row + rows; ++j)
  {
    for (int i = column; i < column + columns; ++i)
    {
      this->Set(i, j, level);
    }
  }
}

// Writes capitals, digits and . : - / from (column, row), the top left corner; other characters
// are blanks. The ground stays.
void DrawText(
  const GreyScreen& screen, int column, int row, std::string_view text, std::uint8_t level)
{
  for (const char name : text)
  {
    const auto* letter = std::find_if(
      Letters.begin(), Letters.end(), [name](const Letter& each) { return each.Name == name; });
    for (int bit = 0; letter != Letters.end() && bit < LetterColumns * LetterRows; ++bit)
    {
      const int i = bit % LetterColumns;
      const int j = bit / LetterColumns;
      if ((letter->Lines[static_cast<std::size_t>(j)] >> (LetterColumns - 1 - i) & 1) != 0)
      {
        screen.Fill(column + Scale * i, row + Scale * j, Scale, Scale, level);
      }
    }
    column += TextAdvance;
  }
}

//------------------------------------------------------------------------------
constexpr double Pi = 3.14159265358979323846;

// Pixels around what the probe sees.
struct Margins
{
  int Left;
  int Right;
  int Top;
  int Bottom;
};
constexpr Margins WithFurniture{ 56, 72, 44, 36 };
constexpr Margins Bare{ 0, 0, 0, 0 };

constexpr int Edge = 12; // of texts
constexpr std::uint8_t Bright = 220;
constexpr std::uint8_t Dim = 140;

constexpr int MarkRadius = 6;
constexpr int LongTick = 14;
constexpr int ShortTick = 7;
constexpr int TickHeight = 2;
constexpr double TickDistance = 5; // mm
constexpr double TicksWithNumbersUpTo = 100;

// What the probe sees, mm from the middle of the face: x to either side, y from top to bottom.
struct Box
{
  double HalfWidth;
  double Top;
  double Bottom;
};

Box GetBox(const ScannerLayout& layout)
{
  if (layout.Shape == ScannerLayout::Probe::Linear)
  {
    return { 0.5 * layout.Width, 0, layout.Depth };
  }
  const double angle = layout.HalfAngle * Pi / 180;
  return { (layout.Radius + layout.Depth) * std::sin(angle), layout.Radius * (std::cos(angle) - 1),
    layout.Depth };
}

void Check(const char* what, double value, double least, double most, const char* unit)
{
  if (!(value >= least && value <= most))
  {
    std::ostringstream message;
    message << "the " << what << " is " << value << unit << "; it must be from " << least << " to "
            << most << unit;
    throw std::invalid_argument(message.str());
  }
}
}

ScannerScreen::ScannerScreen(const ScannerLayout& layout)
  : Layout(layout)
{
  Check("frame's width", layout.Columns, layout.Furniture ? 320 : 16, 4096, " pixels");
  Check("frame's height", layout.Rows, layout.Furniture ? 240 : 16, 4096, " pixels");
  Check("depth", layout.Depth, 5, 400, " mm");
  Check("transducer's radius", layout.Radius, 0, 100, " mm");
  Check("sector's half angle", layout.HalfAngle, 5, 60, " degrees");
  Check("transducer's width", layout.Width, 5, 400, " mm");
  this->Ground.assign(static_cast<std::size_t>(layout.Columns) * layout.Rows, 0);
  this->Place();
  if (layout.Furniture)
  {
    this->DrawFurniture();
  }
}

void ScannerScreen::Place()
{
  const ScannerLayout& layout = this->Layout;
  const Margins& margins = layout.Furniture ? WithFurniture : Bare;
  const Box box = GetBox(layout);
  const int columns = layout.Columns - margins.Left - margins.Right;
  const int rows = layout.Rows - margins.Top - margins.Bottom;
  const double least =
    std::max(2 * box.HalfWidth / (columns - 1), (box.Bottom - box.Top) / (rows - 1));
  const double perCentimetre = std::floor(10 / least);
  if (perCentimetre < 1)
  {
    throw std::invalid_argument(
      "the frame is too small for what the probe sees: a pixel would be more than 10 mm");
  }
  this->Spacing = 10 / perCentimetre;
  this->FaceColumn = margins.Left + columns / 2;
  this->FaceRow = margins.Top + static_cast<int>(std::ceil(-box.Top / this->Spacing));
  const auto lastRow = static_cast<int>(this->FaceRow + std::floor(box.Bottom / this->Spacing));
  if (layout.Shape == ScannerLayout::Probe::Linear)
  {
    const auto half = static_cast<int>(box.HalfWidth / this->Spacing);
    for (int row = this->FaceRow; row <= lastRow; ++row)
    {
      this->Runs.push_back({ row, std::max(this->FaceColumn - half, 0),
        std::min(this->FaceColumn + half, layout.Columns - 1) });
    }
  }
  else
  {
    this->PlaceSector();
  }
  int first = layout.Columns;
  int last = 0;
  for (const Run& run : this->Runs)
  {
    first = std::min(first, run.First);
    last = std::max(last, run.Last);
  }
  const int top = this->Runs.front().Row;
  this->Region.Rectangle = { first, top, last - first + 1, this->Runs.back().Row - top + 1 };
}

void ScannerScreen::PlaceSector()
{
  const ScannerLayout& layout = this->Layout;
  this->Region.IsSector = true;
  Fan& fan = this->Region.Sector;
  fan.Origin = { static_cast<double>(this->FaceColumn),
    this->FaceRow - layout.Radius / this->Spacing };
  fan.Angles = { -layout.HalfAngle, layout.HalfAngle };
  fan.Radii = { layout.Radius, layout.Radius + layout.Depth };
  const FanMask mask(fan, layout.Columns, layout.Rows, { this->Spacing, this->Spacing });
  for (int row = 0; row < layout.Rows; ++row)
  {
    for (const IndexInterval& run : mask.GetRuns(row))
    {
      this->Runs.push_back({ row, static_cast<int>(run.First), static_cast<int>(run.Last) });
    }
  }
}

Matrix4 ScannerScreen::GetImageToFace() const
{
  return Matrix4::Scaling({ this->Spacing, this->Spacing, this->Spacing }) *
    Matrix4::Translation(
      { -static_cast<double>(this->FaceColumn), -static_cast<double>(this->FaceRow), 0 });
}

void ScannerScreen::DrawFurniture()
{
  const ScannerLayout& layout = this->Layout;
  const GreyScreen screen{ layout.Columns, layout.Rows, this->Ground.data() };
  DrawText(screen, Edge, Edge, layout.Title, Bright);
  char text[32];
  std::snprintf(text, sizeof(text), "%.0f MM", layout.Depth);
  DrawText(screen, Edge, layout.Rows - Edge - TextHeight, text, Dim);

  // the grey scale
  const int scaleRow = WithFurniture.Top + 3 * TextHeight;
  const int scaleRows = std::min(256, layout.Rows / 2);
  for (int j = 0; j < scaleRows; ++j)
  {
    screen.Fill(
      Edge, scaleRow + j, 10, 1, static_cast<std::uint8_t>(255 - 255 * j / (scaleRows - 1)));
  }

  // the mark of the probe's side
  const double half = GetBox(layout).HalfWidth;
  const int mark = layout.Shape == ScannerLayout::Probe::Linear
    ? this->FaceColumn - static_cast<int>(half / this->Spacing)
    : this->FaceColumn -
      static_cast<int>(layout.Radius * std::sin(layout.HalfAngle * Pi / 180) / this->Spacing);
  const int centre = std::max(mark - 2 * MarkRadius, 3 * Edge);
  for (int j = -MarkRadius; j <= MarkRadius; ++j)
  {
    const auto reach = static_cast<int>(std::sqrt(MarkRadius * MarkRadius - j * j));
    screen.Fill(centre - reach, WithFurniture.Top + MarkRadius + j, 2 * reach + 1, 1, Bright);
  }

  // the ruler
  const int end = layout.Columns - WithFurniture.Right + Edge + LongTick;
  for (int tick = 0; tick * TickDistance <= layout.Depth; ++tick)
  {
    const double depth = tick * TickDistance;
    const int row = this->FaceRow + static_cast<int>(std::lround(depth / this->Spacing));
    const int length = tick % 2 == 0 ? LongTick : ShortTick;
    screen.Fill(end - length, row, length, TickHeight, Bright);
    if (tick % (layout.Depth > TicksWithNumbersUpTo ? 10 : 4) == 0 && tick > 0)
    {
      std::snprintf(text, sizeof(text), "%.0f", depth);
      DrawText(screen, end + 6, row - TextHeight / 2, text, Dim);
    }
  }
}

void ScannerScreen::DrawFrameNumber(double time, std::int64_t number, std::uint8_t* pixels) const
{
  if (!this->Layout.Furniture)
  {
    return;
  }
  const GreyScreen screen{ this->Layout.Columns, this->Layout.Rows, pixels };
  const auto hundredths = static_cast<std::int64_t>(std::floor(100 * std::max(time, 0.0) + 1e-6));
  char text[64];
  const int length = std::snprintf(text, sizeof(text), "%06lld  %02lld:%02lld.%02lld",
    static_cast<long long>(number % 1000000), static_cast<long long>(hundredths / 6000 % 100),
    static_cast<long long>(hundredths / 100 % 60), static_cast<long long>(hundredths % 100));
  DrawText(screen, this->Layout.Columns - Edge - TextAdvance * length,
    this->Layout.Rows - Edge - TextHeight, { text, static_cast<std::size_t>(length) }, Dim);
}

//------------------------------------------------------------------------------
namespace
{
constexpr int Bits = 7;
constexpr std::size_t Size = 1 << Bits; // grid points along an axis
constexpr std::size_t Mask = Size - 1;
constexpr double Cell = 0.3; // mm
constexpr int WeightBits = 16;
constexpr float WeightUnit = 1.0F / (1 << WeightBits);
constexpr double Steps = 22; // of Grain in a standard deviation of a Rayleigh distribution
constexpr int Samples = 1 << 16;

// Binomial weights along the axis whose neighbours are stride apart, round the grid.
void Smooth(std::vector<float>& field, int axis)
{
  const std::size_t stride = std::size_t{ 1 } << (axis * Bits);
  std::array<float, Size> line{};
  for (std::size_t first = 0; first < field.size(); ++first)
  {
    if ((first / stride & Mask) != 0)
    {
      continue;
    }
    for (std::size_t i = 0; i < Size; ++i)
    {
      line[i] = field[first + i * stride];
    }
    for (std::size_t i = 0; i < Size; ++i)
    {
      field[first + i * stride] = 6 * line[i] + 4 * (line[(i + 1) & Mask] + line[(i - 1) & Mask]) +
        line[(i + 2) & Mask] + line[(i - 2) & Mask];
    }
  }
}

std::vector<float> MakeField(std::uint64_t seed, std::uint64_t stream)
{
  const CounterNoise noise(seed, stream);
  std::vector<float> field(Size * Size * Size);
  for (std::size_t i = 0; i < field.size(); ++i)
  {
    field[i] = static_cast<float>(noise.Normal(i));
  }
  for (int axis = 0; axis < 3; ++axis)
  {
    Smooth(field, axis);
  }
  return field;
}

// A length as a fraction of the grid's period, in 2^-32.
std::uint32_t Phase(double millimetres)
{
  const double periods = millimetres / (Cell * Size);
  return static_cast<std::uint32_t>(
    static_cast<std::int64_t>(std::ldexp(periods - std::floor(periods), 32)));
}
}

TissueSpeckle::TissueSpeckle(std::uint64_t seed)
  : Grain(Size * Size * Size)
{
  const std::vector<float> real = MakeField(seed, 0);
  const std::vector<float> imaginary = MakeField(seed, 1);
  double sum = 0;
  for (std::size_t i = 0; i < real.size(); ++i)
  {
    sum += std::hypot(real[i], imaginary[i]);
  }
  const double mean = sum / static_cast<double>(real.size());
  const double toGrain = Steps / (0.5227 * mean); // standard deviation by mean of Rayleigh's
  for (std::size_t i = 0; i < real.size(); ++i)
  {
    const double grain = toGrain * (std::hypot(real[i], imaginary[i]) - mean);
    this->Grain[i] = static_cast<std::int8_t>(std::lround(std::clamp(grain, -127.0, 127.0)));
  }
  // between the points it is smoother
  const CounterNoise places(seed, 2);
  double first = 0;
  double second = 0;
  for (int i = 0; i < Samples; ++i)
  {
    std::array<std::uint32_t, 3> place{};
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      place[axis] = static_cast<std::uint32_t>(
        std::ldexp(places.Uniform(3 * static_cast<std::uint64_t>(i) + axis), 32));
    }
    const double grain = this->Find(place[0], place[1], place[2]);
    first += grain / Samples;
    second += grain * grain / Samples;
  }
  this->Mean = first;
  this->Unit = 1 / std::sqrt(second - first * first);
}

float TissueSpeckle::Find(std::uint32_t x, std::uint32_t y, std::uint32_t z) const
{
  const auto index = [](std::uint32_t phase)
  { return static_cast<std::size_t>(phase >> (32 - Bits)); };
  const auto weight = [](std::uint32_t phase)
  {
    return WeightUnit *
      static_cast<float>(
        static_cast<std::int32_t>(phase >> (32 - Bits - WeightBits) & ((1U << WeightBits) - 1)));
  };
  const std::size_t i = index(x);
  const std::size_t nextI = (i + 1) & Mask;
  const std::size_t j[2] = { index(y) << Bits, ((index(y) + 1) & Mask) << Bits };
  const std::size_t k[2] = { index(z) << 2 * Bits, ((index(z) + 1) & Mask) << 2 * Bits };
  const float weightX = weight(x);
  const auto along = [&](std::size_t row)
  {
    const float grain = this->Grain[row | i];
    return grain + weightX * (static_cast<float>(this->Grain[row | nextI]) - grain);
  };
  const float weightY = weight(y);
  const auto across = [&](std::size_t layer)
  {
    const float grain = along(layer | j[0]);
    return grain + weightY * (along(layer | j[1]) - grain);
  };
  const float grain = across(k[0]);
  return grain + weight(z) * (across(k[1]) - grain);
}

double TissueSpeckle::At(const Vec3& point) const
{
  return this->Unit * (this->Find(Phase(point[0]), Phase(point[1]), Phase(point[2])) - this->Mean);
}

void TissueSpeckle::Apply(
  const Vec3& start, const Vec3& step, int count, double strength, double* levels) const
{
  std::uint32_t x = Phase(start[0]);
  std::uint32_t y = Phase(start[1]);
  std::uint32_t z = Phase(start[2]);
  const std::uint32_t stepX = Phase(step[0]);
  const std::uint32_t stepY = Phase(step[1]);
  const std::uint32_t stepZ = Phase(step[2]);
  const double scale = strength * this->Unit;
  const double offset = 1 - scale * this->Mean;
  for (int i = 0; i < count; ++i)
  {
    levels[i] *= std::max(0.0, offset + scale * this->Find(x, y, z));
    x += stepX;
    y += stepY;
    z += stepZ;
  }
}

//------------------------------------------------------------------------------
UltrasoundEmulator::UltrasoundEmulator(
  std::unique_ptr<PhantomScene> scene, const UltrasoundSettings& settings)
  : Scene(std::move(scene))
  , Screen(settings.Layout)
  , Speckle(settings.Seed)
  , SpeckleLevel(settings.SpeckleLevel)
{
  if (!(settings.SpeckleLevel >= 0 && settings.SpeckleLevel <= 1))
  {
    std::ostringstream message;
    message << "the speckle's level is " << settings.SpeckleLevel << "; it must be from 0 to 1";
    throw std::invalid_argument(message.str());
  }
}

void UltrasoundEmulator::Render(
  const Matrix4& imageToScene, double time, std::int64_t number, std::uint8_t* pixels) const
{
  const std::vector<std::uint8_t>& ground = this->Screen.GetGround();
  std::copy(ground.begin(), ground.end(), pixels);
  const int columns = this->Screen.GetLayout().Columns;
  const Vec3 step = imageToScene.Column(0);
  std::vector<double> levels(static_cast<std::size_t>(columns));
  for (const ScannerScreen::Run& run : this->Screen.GetRuns())
  {
    const Vec3 start = imageToScene.Point({ 0, static_cast<double>(run.Row), 0 });
    const int count = run.Last - run.First + 1;
    this->Scene->SampleRow(start, step, run.First, count, levels.data());
    if (this->SpeckleLevel > 0)
    {
      this->Speckle.Apply(start + static_cast<double>(run.First) * step, step, count,
        this->SpeckleLevel, levels.data());
    }
    std::uint8_t* row = pixels + static_cast<std::int64_t>(run.Row) * columns + run.First;
    for (int i = 0; i < count; ++i)
    {
      // truncation rounds half up
      row[i] = static_cast<std::uint8_t>(
        std::clamp(levels[static_cast<std::size_t>(i)], 0.0, 255.0) + 0.5);
    }
  }
  this->Screen.DrawFrameNumber(time, number, pixels);
}
}
