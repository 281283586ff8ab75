// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaScanRegion.h"

#include "lacunaArrayScalarType.h"
#include "lacunaDepthRuler.h"
#include "lacunaFieldData.h"
#include "lacunaParameterText.h"
#include "lacunaScanOutline.h"
#include "lacunaScanRegion.h"
#include "lacunaStackPixels.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkStringArray.h"
#include "vtkTable.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

namespace
{
constexpr int MostFrames = 32;
constexpr double DoubtfulConfidence = 0.5;
constexpr int ArcSteps = 60;
constexpr double RadiansPerDegree = 3.14159265358979323846 / 180;

enum Parts
{
  Border,
  Box,
  DepthTicks,
  WidthTicks
};

// Some frames of the stack in grey, the top row first.
class Frames
{
public:
  explicit Frames(vtkImageData* image)
  {
    double spacing[3], origin[3];
    image->GetSpacing(spacing);
    image->GetOrigin(origin);
    if (spacing[0] != 1 || spacing[1] != 1)
    {
      throw std::runtime_error("the image's spacing is " + lacuna::FormatNumber(spacing[0]) + ", " +
        lacuna::FormatNumber(spacing[1]) +
        ", but the scan region counts pixels: give the screen as it was recorded, with spacing 1");
    }
    int extent[6];
    image->GetExtent(extent);
    this->Image = image;
    vtkDataArray* pixels = lacuna::StackPixels::Find(image);
    this->IsFlipped = lacuna::StackPixels::IsBottomRowFirst(pixels);
    this->Rows = { extent[2], extent[3] };
    const int slices = extent[5] - extent[4] + 1;
    const int count = std::min(MostFrames, slices);
    const std::array<int, 6> part{ extent[0], extent[1], extent[2], extent[3], 0, count - 1 };
    this->Grey = lacuna::StackPixels::Allocate(pixels, part);
    lacuna::SliceImage frame;
    frame.Type = lacuna::ArrayScalarType::Get(this->Grey);
    frame.RowStride = frame.Width = extent[1] - extent[0] + 1;
    frame.Height = extent[3] - extent[2] + 1;
    for (int n = 0; n < count; ++n)
    {
      const int slice =
        count > 1 ? static_cast<int>(std::int64_t(n) * (slices - 1) / (count - 1)) : 0;
      lacuna::StackPixels::Copy(
        image, extent[4] + slice, 1, this->IsFlipped, this->Rows, this->Grey, part, n);
      frame.Pixels =
        this->Grey->GetVoidPointer(vtkIdType(n) * vtkIdType(frame.Width) * frame.Height);
      this->Images.push_back(frame);
    }
    this->First = { origin[0] + extent[0], origin[1] + extent[2] };
    this->Slice = origin[2] + image->GetSpacing()[2] * extent[4];
  }

  std::vector<lacuna::SliceImage> Images;
  lacuna::Vec2 First{ 0, 0 }; ///< column and row of the first pixel

  int GetNumberOfSlices() const { return this->Image->GetDimensions()[2]; }

  // All slices of the stack, one after the other.
  template <class Function>
  void ForEachSlice(const Function& f)
  {
    int extent[6];
    this->Image->GetExtent(extent);
    const std::array<int, 6> part{ extent[0], extent[1], extent[2], extent[3], 0, 0 };
    const vtkSmartPointer<vtkDataArray> grey =
      lacuna::StackPixels::Allocate(lacuna::StackPixels::Find(this->Image), part);
    lacuna::SliceImage slice = this->Images.front();
    slice.Pixels = grey->GetVoidPointer(0);
    for (int n = 0; n < this->GetNumberOfSlices(); ++n)
    {
      lacuna::StackPixels::Copy(
        this->Image, extent[4] + n, 1, this->IsFlipped, this->Rows, grey, part, 0);
      f(slice, n);
    }
  }

  // Of a column and a row, counted in the images.
  lacuna::Vec3 GetPoint(double column, double row) const
  {
    const double height = this->Rows[1] - this->Rows[0];
    return { this->First[0] + column, this->First[1] + (this->IsFlipped ? height - row : row),
      this->Slice };
  }

private:
  vtkImageData* Image;
  vtkSmartPointer<vtkDataArray> Grey;
  bool IsFlipped = false;
  std::array<int, 2> Rows{ 0, 0 };
  double Slice = 0;
};

class Picture
{
public:
  explicit Picture(const Frames& frames)
    : Screen(frames)
  {
    this->Points->SetDataTypeToDouble();
    this->Part->SetName("Part");
  }

  void AddLine(const std::vector<lacuna::Vec2>& corners, int part)
  {
    this->Lines->InsertNextCell(static_cast<int>(corners.size()));
    for (const lacuna::Vec2& corner : corners)
    {
      this->Lines->InsertCellPoint(
        this->Points->InsertNextPoint(this->Screen.GetPoint(corner[0], corner[1]).data()));
    }
    this->Part->InsertNextValue(part);
  }

  void AddRegion(const lacuna::DetectedFan& fan, double aspect)
  {
    const std::array<int, 4>& r = fan.Rectangle;
    // along the outer edges of the pixels
    const double left = r[0] - 0.5, right = left + r[2], top = r[1] - 0.5, bottom = top + r[3];
    const std::vector<lacuna::Vec2> box{ { left, top }, { right, top }, { right, bottom },
      { left, bottom }, { left, top } };
    this->AddLine(box, Box);
    if (!fan.IsSector)
    {
      this->AddLine(box, Border);
      return;
    }
    std::vector<lacuna::Vec2> border;
    for (int side = 0; side < 2; ++side)
    {
      for (int n = 0; n <= ArcSteps; ++n)
      {
        const double part = double(side == 0 ? n : ArcSteps - n) / ArcSteps;
        const lacuna::Fan& sector = fan.Sector;
        const double angle =
          RadiansPerDegree * (sector.Angles[0] + part * (sector.Angles[1] - sector.Angles[0]));
        const double radius = sector.Radii[side == 0 ? 1 : 0];
        border.push_back({ sector.Origin[0] + radius * std::sin(angle),
          sector.Origin[1] + radius * std::cos(angle) / aspect });
      }
    }
    border.push_back(border.front());
    this->AddLine(border, Border);
  }

  void AddTicks(const lacuna::TickRow& row, bool isDepth)
  {
    const double first = row.Across[0] - 0.5, last = row.Across[1] + 0.5;
    for (const double tick : row.Ticks)
    {
      this->AddLine(isDepth ? std::vector<lacuna::Vec2>{ { first, tick }, { last, tick } }
                            : std::vector<lacuna::Vec2>{ { tick, first }, { tick, last } },
        isDepth ? DepthTicks : WidthTicks);
    }
  }

  void Put(vtkPolyData* output)
  {
    output->SetPoints(this->Points);
    output->SetLines(this->Lines);
    output->GetCellData()->SetScalars(this->Part);
  }

private:
  const Frames& Screen;
  vtkNew<vtkPoints> Points;
  vtkNew<vtkCellArray> Lines;
  vtkNew<vtkIntArray> Part;
};

// Text columns, and numbers as field data of all outputs.
class Report
{
public:
  Report()
  {
    static const char* const names[3] = { "Quantity", "Value", "Remark" };
    for (int c = 0; c < 3; ++c)
    {
      this->Columns[c]->SetName(names[c]);
    }
  }

  void AddText(const char* quantity, const std::string& value, const std::string& remark)
  {
    this->Columns[0]->InsertNextValue(quantity);
    this->Columns[1]->InsertNextValue(value);
    this->Columns[2]->InsertNextValue(remark);
  }

  // Rounded, so that they can be copied.
  void Add(const char* name, const std::vector<double>& values, double unit, const char* remark)
  {
    std::string text;
    std::vector<double> rounded;
    for (const double value : values)
    {
      rounded.push_back(std::round(value / unit) / std::round(1 / unit));
      text += (text.empty() ? "" : " ") + lacuna::FormatNumber(rounded.back());
    }
    this->Numbers.emplace_back(name, rounded);
    this->AddText(name, text, remark);
  }

  void Put(vtkTable* table) const
  {
    for (const auto& column : this->Columns)
    {
      table->AddColumn(column);
    }
  }
  void PutFields(vtkDataObject* output) const
  {
    for (const auto& [name, values] : this->Numbers)
    {
      lacuna::FieldData::Set(output, name, values, static_cast<int>(values.size()));
    }
  }

private:
  vtkNew<vtkStringArray> Columns[3];
  std::vector<std::pair<const char*, std::vector<double>>> Numbers;
};

// Where hardly anything changes: the outline of all that does, over all slices.
lacuna::ScanRegion Propose(
  Frames& frames, const lacuna::Vec2& pixel, const std::string& doubt, lacuna::Execution& execution)
{
  lacuna::ScanOutline outline;
  frames.ForEachSlice(
    [&](const lacuna::SliceImage& slice, int n)
    {
      execution.Report(double(n) / frames.GetNumberOfSlices());
      outline.Put(slice);
    });
  lacuna::ScanRegion region = outline.Propose(pixel);
  if (!region.IsFound)
  {
    throw std::runtime_error(doubt + " (no outline can be proposed either: " + region.Text + ")");
  }
  return region;
}

void AddRegion(Report& report, const lacuna::ScanRegion& region, const Frames& frames)
{
  const lacuna::DetectedFan& fan = region.Fan;
  const lacuna::Vec2& first = frames.First;
  report.Add("Confidence", { region.Confidence }, 0.01, region.Text.c_str());
  report.Add("ClipRectangle",
    { first[0] + fan.Rectangle[0], first[1] + fan.Rectangle[1], double(fan.Rectangle[2]),
      double(fan.Rectangle[3]) },
    1, "first column and row, width and height");
  if (fan.IsSector)
  {
    const lacuna::Fan& sector = fan.Sector;
    report.Add("FanOrigin", { first[0] + sector.Origin[0], first[1] + sector.Origin[1] }, 0.01,
      "column and row");
    report.Add("FanAngles", { sector.Angles[0], sector.Angles[1] }, 0.01, "degrees");
    report.Add("FanRadiiInPixels", { sector.Radii[0], sector.Radii[1] }, 0.01,
      "widths of a pixel; Swept Volume takes mm (FanRadii)");
  }
}

void AddRulers(Report& report, Picture& picture, const lacuna::DepthRuler& ruler)
{
  const lacuna::TickRow* rows[2] = { &ruler.Depth, &ruler.Width };
  static const char* const names[2] = { "DepthTick", "WidthTick" };
  for (int r = 0; r < 2; ++r)
  {
    if (rows[r]->IsFound)
    {
      report.Add(names[r], { rows[r]->Pitch, rows[r]->PitchError }, 1e-4, rows[r]->Text.c_str());
      picture.AddTicks(*rows[r], r == 0);
    }
    else
    {
      report.AddText(names[r], "not found", rows[r]->Text);
    }
  }
  if (ruler.Depth.IsFound && ruler.Width.IsFound)
  {
    report.Add("PixelAspect", { ruler.Width.Pitch / ruler.Depth.Pitch }, 1e-4,
      "height by width of a pixel, if a tick is as many mm in both rulers");
  }
}
}

vtkStandardNewMacro(vtkLacunaScanRegion);

//------------------------------------------------------------------------------
vtkLacunaScanRegion::vtkLacunaScanRegion()
{
  this->Sharing = lacuna::Share::FirstRank;
  this->TakesEmpty = true; // an error
  this->TakesBlocks = true;
  this->SetNumberOfOutputPorts(2);
}

//------------------------------------------------------------------------------
int vtkLacunaScanRegion::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkImageData");
  return 1;
}

//------------------------------------------------------------------------------
int vtkLacunaScanRegion::FillOutputPortInformation(int port, vtkInformation* info)
{
  info->Set(vtkDataObject::DATA_TYPE_NAME(), port == 0 ? "vtkTable" : "vtkPolyData");
  return 1;
}

//------------------------------------------------------------------------------
void vtkLacunaScanRegion::Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution)
{
  auto* image = ports.GetInput<vtkImageData>();
  if (image->GetNumberOfPoints() == 0)
  {
    throw std::runtime_error("the image is empty");
  }
  Frames frames(image);
  const lacuna::Vec2 pixel{ 1, this->PixelAspect };
  lacuna::ScanRegion region = lacuna::FindScanRegion(frames.Images, pixel);
  if (!region.IsFound)
  {
    if (frames.GetNumberOfSlices() < 3)
    {
      throw std::runtime_error(region.Text);
    }
    region = Propose(frames, pixel, region.Text, execution);
  }
  if (region.Confidence < DoubtfulConfidence)
  {
    vtkWarningMacro(<< "the scan region is doubtful (confidence "
                    << std::lround(100 * region.Confidence) << " %; " << region.Text
                    << "): look at the second output over the image");
  }
  const lacuna::DepthRuler ruler = lacuna::FindDepthRuler(frames.Images, region.Fan, pixel);

  Report report;
  AddRegion(report, region, frames);
  Picture picture(frames);
  picture.AddRegion(region.Fan, this->PixelAspect);
  AddRulers(report, picture, ruler);
  if (this->TickLength > 0 && !ruler.Depth.IsFound)
  {
    vtkWarningMacro(<< "TickLength is of no use: " << ruler.Depth.Text);
  }
  else if (this->TickLength > 0)
  {
    const double height = ruler.Depth.GetSpacing(this->TickLength);
    const double width = height / this->PixelAspect;
    report.Add("PixelSpacing", { width, height }, 1e-5,
      "mm a column and a row, by TickLength and PixelAspect");
    if (region.Fan.IsSector)
    {
      const lacuna::Vec2& radii = region.Fan.Sector.Radii;
      report.Add("FanRadii", { width * radii[0], width * radii[1] }, 1e-3, "mm");
    }
  }
  auto* table = ports.GetOutput<vtkTable>();
  auto* overlay = ports.GetOutput<vtkPolyData>(1);
  report.Put(table);
  picture.Put(overlay);
  report.PutFields(table);
  report.PutFields(overlay);
}

//------------------------------------------------------------------------------
void vtkLacunaScanRegion::Describe(lacuna::Properties& properties) const
{
  using lacuna::ValueRange;
  properties.Add("TickLength", this->TickLength, ValueRange::Above(0, "mm").OrZero("not known"))
    .Add("PixelAspect", this->PixelAspect, ValueRange::Above(0));
}
