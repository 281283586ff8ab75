// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaScannerScreen.h"

#include "lacunaScreenText.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <sstream>
#include <stdexcept>

namespace lacuna
{
namespace
{
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
}
