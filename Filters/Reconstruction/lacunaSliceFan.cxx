// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSliceFan.h"

#include "lacunaFanDetection.h"
#include "vtkLacunaSliceAlgorithm.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <sstream>

namespace
{
// Masks serve slices whose pixels differ by less than a pixel across the whole image.
constexpr double SpacingTolerance = 1e-4;

lacuna::Vec2 GetPixelSpacing(const lacuna::SliceImage& slice)
{
  return { Norm(slice.PixelToReference.Column(0)), Norm(slice.PixelToReference.Column(1)) };
}

double Round(double value, double unit)
{
  return std::round(value / unit) * unit;
}
}

//------------------------------------------------------------------------------
lacuna::Matrix4 lacuna::SliceFan::Window::GetMatrix() const
{
  return lacuna::Matrix4::Translation({ this->Origin[0], this->Origin[1], 0 }) *
    lacuna::Matrix4::Scaling({ this->Step[0], this->Step[1], 1 });
}

//------------------------------------------------------------------------------
std::string lacuna::SliceFan::Describe() const
{
  std::ostringstream text;
  text.precision(10);
  if (this->HasSector())
  {
    text << "FanOrigin=" << this->Sector.Origin[0] << "," << this->Sector.Origin[1]
         << " FanAngles=" << this->Sector.Angles[0] << "," << this->Sector.Angles[1]
         << " FanRadii=" << this->Sector.Radii[0] << "," << this->Sector.Radii[1] << " ";
  }
  text << "ClipRectangle=" << this->Clip[0] << "," << this->Clip[1] << "," << this->Clip[2] << ","
       << this->Clip[3];
  return text.str();
}

//------------------------------------------------------------------------------
lacuna::SliceFan lacuna::SliceFan::Make(vtkLacunaSliceAlgorithm* filter)
{
  lacuna::SliceFan fan;
  std::copy_n(filter->GetFanOrigin(), 2, fan.Sector.Origin.begin());
  std::copy_n(filter->GetFanAngles(), 2, fan.Sector.Angles.begin());
  std::copy_n(filter->GetFanRadii(), 2, fan.Sector.Radii.begin());
  return fan;
}

//------------------------------------------------------------------------------
lacuna::SliceFan lacuna::SliceFan::Detect(
  const std::vector<lacuna::SliceImage>& slices, const Window& window)
{
  const lacuna::DetectedFan found = lacuna::DetectFan(
    slices, slices.empty() ? lacuna::Vec2{ 1, 1 } : GetPixelSpacing(slices.front()));
  lacuna::SliceFan fan;
  for (std::size_t a = 0; a < 2; ++a)
  {
    if (found.IsSector)
    {
      fan.Sector.Origin[a] =
        Round(window.Origin[a] + window.Step[a] * found.Sector.Origin[a], 0.01);
      fan.Sector.Angles[a] = Round(found.Sector.Angles[a], 0.01);
      fan.Sector.Radii[a] = Round(found.Sector.Radii[a], 0.001);
    }
    const double first = window.Origin[a] + window.Step[a] * found.Rectangle[a];
    const double last = first + window.Step[a] * (found.Rectangle[2 + a] - 1);
    fan.Clip[a] = static_cast<int>(std::ceil(first - 1e-6));
    fan.Clip[2 + a] = static_cast<int>(std::floor(last + 1e-6)) - fan.Clip[a] + 1;
  }
  return fan;
}

//------------------------------------------------------------------------------
lacuna::SliceFan::Window lacuna::SliceFan::Apply(
  const std::vector<lacuna::SliceImage*>& slices, const Window& window) const
{
  if (slices.empty())
  {
    return window;
  }
  const lacuna::SliceImage& first = *slices.front();
  // columns and rows of the window, as ClipRectangle means them
  int begin[2] = { 0, 0 };
  int end[2] = { first.Width, first.Height };
  for (std::size_t a = 0; a < 2; ++a)
  {
    const double low = (this->Clip[a] - window.Origin[a]) / window.Step[a];
    begin[a] = std::max(begin[a], static_cast<int>(std::ceil(low - 1e-6)));
    if (this->Clip[2 + a] > 0)
    {
      const double high = low + (this->Clip[2 + a] - 1) / window.Step[a];
      end[a] = std::min(end[a], static_cast<int>(std::floor(high + 1e-6)) + 1);
    }
  }
  lacuna::Fan sector = this->Sector;
  for (std::size_t a = 0; a < 2; ++a)
  {
    sector.Origin[a] = (sector.Origin[a] - window.Origin[a]) / window.Step[a];
  }
  if (this->HasSector())
  {
    const lacuna::FanMask mask(sector, first.Width, first.Height, GetPixelSpacing(first));
    int box[4] = { end[0], end[1], begin[0], begin[1] };
    for (int row = begin[1]; row < end[1]; ++row)
    {
      for (const lacuna::IndexInterval& run : mask.GetRuns(row))
      {
        const int left = std::max(begin[0], static_cast<int>(run.First));
        const int right = std::min(end[0], static_cast<int>(run.Last) + 1);
        if (left < right)
        {
          box[0] = std::min(box[0], left);
          box[1] = std::min(box[1], row);
          box[2] = std::max(box[2], right);
          box[3] = row + 1;
        }
      }
    }
    std::copy_n(box, 2, begin);
    std::copy_n(box + 2, 2, end);
  }
  const int width = end[0] - begin[0];
  const int height = end[1] - begin[1];
  if (width < 2 || height < 2)
  {
    throw std::runtime_error("the fan leaves " + std::to_string(std::max(0, width)) + " x " +
      std::to_string(std::max(0, height)) +
      " pixels of the slices (of their ClipRectangle); at least 2 x 2 are needed");
  }
  sector.Origin = { sector.Origin[0] - begin[0], sector.Origin[1] - begin[1] };
  std::shared_ptr<const lacuna::FanMask> mask;
  for (lacuna::SliceImage* slice : slices)
  {
    lacuna::CutSlice(*slice, begin[0], begin[1], width, height);
    if (this->HasSector())
    {
      const lacuna::Vec2 spacing = GetPixelSpacing(*slice);
      const auto differs = [&](std::size_t a)
      { return std::abs(mask->GetPixelSpacing()[a] - spacing[a]) > SpacingTolerance * spacing[a]; };
      if (!mask || differs(0) || differs(1))
      {
        mask = std::make_shared<const lacuna::FanMask>(sector, width, height, spacing);
      }
      slice->Fan = mask;
    }
  }
  Window cut = window;
  for (std::size_t a = 0; a < 2; ++a)
  {
    cut.Origin[a] += cut.Step[a] * begin[a];
  }
  return cut;
}
