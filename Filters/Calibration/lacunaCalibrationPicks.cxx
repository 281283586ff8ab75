// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaCalibrationPicks.h"

#include "lacunaAlgorithmExecution.h"
#include "lacunaArrayScalarType.h"
#include "lacunaFieldData.h"
#include "lacunaParameterText.h"
#include "lacunaSpotTracking.h"
#include "lacunaStackPixels.h"
#include "lacunaTrackedSlices.h"
#include "lacunaWallDetection.h"
#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkPointSet.h"
#include "vtkTable.h"
#include "vtkVariant.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>

namespace
{
// Of the image's diagonal: a wire that moves farther from slice to slice is another one.
constexpr double ReachPart = 0.25;

// Nothing is seen of a stylus, so that its picture may be bad, and none is of another instant.
constexpr int TipIgnores = lacuna::TrackedSlices::ImageInvalid | lacuna::TrackedSlices::TooFast;

vtkAbstractArray* GetColumn(vtkTable* table, const char* name)
{
  vtkAbstractArray* column = table->GetColumnByName(name);
  if (!column || column->GetNumberOfComponents() != 1)
  {
    throw std::runtime_error(std::string("the table of picks has no column '") + name +
      "'; it needs Slice, Column, Row and for three wires Wire");
  }
  return column;
}

double GetNumber(vtkAbstractArray* column, vtkIdType row)
{
  bool isNumber = false;
  const double number = column->GetVariantValue(row).ToDouble(&isNumber);
  if (!isNumber || !std::isfinite(number))
  {
    throw std::runtime_error("row " + std::to_string(row) + " of the table of picks has '" +
      std::string(column->GetVariantValue(row).ToString()) + "' as " + column->GetName() +
      "; a number is needed");
  }
  return number;
}

lacuna::CalibrationTarget ReadWire(vtkAbstractArray* column, vtkIdType row)
{
  const std::string text = column->GetVariantValue(row).ToString();
  const std::string wires = "XYZxyz";
  const std::size_t place = text.size() == 1 ? wires.find(text) : std::string::npos;
  if (place == std::string::npos)
  {
    throw std::runtime_error("row " + std::to_string(row) + " of the table of picks has '" + text +
      "' as " + column->GetName() + "; it must be X, Y or Z");
  }
  return static_cast<lacuna::CalibrationTarget>(place % 3);
}

// In the sweep, of the slice k of the stack.
vtkIdType GetSliceNumber(vtkImageData* slices, const lacuna::ProbePoses& poses, std::int64_t k)
{
  return lacuna::TrackedSlices::GetSliceNumber(
    slices, slices->GetExtent()[4] + static_cast<int>(k), poses.GetCount());
}

// How many of these slices are flagged, and why; empty: none is.
std::string DescribeFlags(const std::vector<int>& status)
{
  lacuna::SliceFlagCounts counts;
  for (const int flags : status)
  {
    counts.Add(static_cast<unsigned char>(flags));
  }
  const std::string flags = counts.Describe();
  return counts.GetNumberOfSlices() == 0
    ? ""
    : std::to_string(counts.GetNumberOfSlices()) + " of " + std::to_string(status.size()) +
      " slices, by their SliceStatus" + (flags.empty() ? "" : ": " + flags);
}

// The picks as they are given.
class Rows
{
public:
  explicit Rows(vtkDataObject* data)
    : Points(vtkPointSet::SafeDownCast(data))
  {
    if (vtkTable* table = vtkTable::SafeDownCast(data))
    {
      this->Columns = { GetColumn(table, "Column"), GetColumn(table, "Row"),
        GetColumn(table, "Slice") };
      this->Wires = table->GetColumnByName("Wire");
      this->Wires = this->Wires ? this->Wires : table->GetColumnByName("Target");
      this->Count = table->GetNumberOfRows();
    }
    else if (this->Points)
    {
      this->Count = this->Points->GetNumberOfPoints();
    }
    else
    {
      throw std::runtime_error("the picks are neither a table nor points");
    }
  }
  vtkIdType GetCount() const { return this->Count; }
  std::string GetName(vtkIdType row) const
  {
    return this->Points ? "point " + std::to_string(row) + " of the picks"
                        : "row " + std::to_string(row) + " of the table of picks";
  }
  // Column, row, slice.
  lacuna::Vec3 Get(vtkIdType row) const
  {
    lacuna::Vec3 values{ 0, 0, 0 };
    if (this->Points)
    {
      this->Points->GetPoint(row, values.data());
      values[2] = std::round(values[2]);
      return values;
    }
    for (std::size_t c = 0; c < 3; ++c)
    {
      values[c] = GetNumber(this->Columns[c], row);
    }
    return values;
  }
  lacuna::CalibrationTarget GetWire(
    vtkIdType row, vtkIdType slice, const std::vector<lacuna::WireRange>& ranges) const
  {
    if (this->Wires)
    {
      return ReadWire(this->Wires, row);
    }
    if (const lacuna::CalibrationTarget* wire = lacuna::FindWire(ranges, slice))
    {
      return *wire;
    }
    throw std::runtime_error(this->GetName(row) +
      " is of no wire: give a table with the column 'Wire' (X, Y or Z), or name the wire of "
      "slice " +
      std::to_string(slice) + " in WireRanges");
  }

private:
  vtkPointSet* Points;
  std::array<vtkAbstractArray*, 3> Columns{};
  vtkAbstractArray* Wires = nullptr;
  vtkIdType Count = 0;
};

// Of the stack's slices, without gaps.
class Images
{
public:
  Images(vtkImageData* slices, const char* what)
  {
    vtkDataArray* levels = lacuna::StackPixels::Find(slices);
    if (levels->GetNumberOfComponents() != 1)
    {
      throw std::runtime_error(
        std::string("the slices have colours; grey levels are needed to look for ") + what);
    }
    slices->GetExtent(this->Extent);
    slices->GetSpacing(this->Spacing);
    slices->GetOrigin(this->Origin);
    this->First.Type = lacuna::ArrayScalarType::Get(levels);
    this->First.Width = this->Extent[1] - this->Extent[0] + 1;
    this->First.Height = this->Extent[3] - this->Extent[2] + 1;
    this->First.RowStride = this->First.Width;
    this->First.Pixels = levels->GetVoidPointer(0);
  }
  std::int64_t GetCount() const { return this->Extent[5] - this->Extent[4] + 1; }
  lacuna::GreyImage Get(std::int64_t k) const
  {
    lacuna::GreyImage image = this->First;
    image.Pixels = static_cast<const char*>(image.Pixels) +
      static_cast<std::size_t>(k * image.Width * image.Height) * lacuna::GetScalarSize(image.Type);
    return image;
  }
  // Of a pixel of an image, in the sweep's.
  lacuna::Vec2 GetPixel(lacuna::Vec2 pixel) const
  {
    for (std::size_t axis = 0; axis < 2; ++axis)
    {
      pixel[axis] =
        this->Origin[axis] + this->Spacing[axis] * (this->Extent[2 * axis] + pixel[axis]);
    }
    return pixel;
  }

private:
  int Extent[6];
  double Spacing[3], Origin[3];
  lacuna::GreyImage First;
};
}

//------------------------------------------------------------------------------
lacuna::ProbePoses::ProbePoses(vtkImageData* slices, const char* arrayName)
{
  vtkDataArray* status =
    lacuna::FieldData::Get(slices, lacuna::TrackedSlices::SliceStatusName, 1, -1);
  vtkDataArray* matrices =
    lacuna::FieldData::Find(slices, arrayName, 16, status->GetNumberOfTuples());
  if (!matrices)
  {
    throw std::runtime_error(std::string("the slices have no field data array '") + arrayName +
      "' (16 numbers for each slice): record the probe's transform under that name");
  }
  for (vtkIdType i = 0; i < status->GetNumberOfTuples(); ++i)
  {
    this->Status.push_back(static_cast<int>(status->GetTuple1(i)));
    this->Matrices.push_back(lacuna::FieldData::GetMatrix(matrices, i));
  }
}

//------------------------------------------------------------------------------
bool lacuna::ProbePoses::IsValid(vtkIdType slice) const
{
  return !(this->Status[slice] & lacuna::TrackedSlices::PoseInvalid);
}

//------------------------------------------------------------------------------
std::vector<lacuna::SlicePick> lacuna::CalibrationPicks::Read(vtkDataObject* data,
  const lacuna::ProbePoses& poses, std::optional<lacuna::CalibrationTarget> target,
  const std::vector<lacuna::WireRange>& ranges)
{
  const Rows rows(data);
  std::vector<lacuna::SlicePick> picks;
  for (vtkIdType row = 0; row < rows.GetCount(); ++row)
  {
    const lacuna::Vec3 point = rows.Get(row);
    const double number = point[2];
    if (number != std::floor(number) || number < 0 ||
      number >= static_cast<double>(poses.GetCount()))
    {
      throw std::runtime_error(rows.GetName(row) + " is of slice " + lacuna::FormatNumber(number) +
        "; the sweep has slices 0 to " + std::to_string(poses.GetCount() - 1));
    }
    const vtkIdType slice = static_cast<vtkIdType>(number);
    if (!poses.IsValid(slice))
    {
      throw std::runtime_error(rows.GetName(row) + " is of slice " + std::to_string(slice) +
        ", which has no pose (SliceStatus 1): remove the row");
    }
    picks.push_back({ slice,
      { poses.Get(slice), { point[0], point[1] },
        target ? *target : rows.GetWire(row, slice, ranges), slice } });
  }
  return picks;
}

//------------------------------------------------------------------------------
std::vector<lacuna::SlicePick> lacuna::CalibrationPicks::FindSpots(
  lacuna::AlgorithmExecution& execution, vtkImageData* slices, const lacuna::ProbePoses& poses,
  const std::vector<lacuna::WireRange>& ranges, const std::vector<lacuna::SlicePick>& picks)
{
  const Images images(slices, "wires");
  std::vector<lacuna::SpotSlice> sweep(static_cast<std::size_t>(poses.GetCount()));
  std::vector<std::int64_t> wanted; // of the stack
  for (std::int64_t k = 0; k < images.GetCount(); ++k)
  {
    const vtkIdType slice = GetSliceNumber(slices, poses, k);
    if (!poses.GetStatus(slice) && lacuna::FindWire(ranges, slice))
    {
      wanted.push_back(k);
    }
  }
  execution.For(static_cast<std::int64_t>(wanted.size()), 1,
    [&](std::int64_t first, std::int64_t last)
    {
      for (std::int64_t n = first; n < last; ++n)
      {
        const std::int64_t k = wanted[static_cast<std::size_t>(n)];
        const vtkIdType slice = GetSliceNumber(slices, poses, k);
        lacuna::SpotSlice& found = sweep[static_cast<std::size_t>(slice)];
        found.Spots = lacuna::FindSpots(images.Get(k));
        for (lacuna::Spot& spot : found.Spots)
        {
          spot.Pixel = images.GetPixel(spot.Pixel);
        }
      }
    });
  for (const lacuna::SlicePick& pick : picks)
  {
    sweep[static_cast<std::size_t>(pick.Slice)].Known = pick.Pick.Pixel;
  }
  double bounds[6];
  slices->GetBounds(bounds);
  const double reach = ReachPart * std::hypot(bounds[1] - bounds[0], bounds[3] - bounds[2]);
  std::vector<lacuna::SlicePick> found;
  for (const lacuna::WireRange& range : ranges)
  {
    const std::vector<lacuna::SpotSlice> part(
      sweep.begin() + range.First, sweep.begin() + range.Last + 1);
    const std::vector<std::optional<lacuna::Spot>> track = lacuna::TrackSpots(part, reach);
    for (std::size_t n = 0; n < track.size(); ++n)
    {
      if (track[n] && !part[n].Known)
      {
        const vtkIdType slice = range.First + static_cast<vtkIdType>(n);
        found.push_back(
          { slice, { poses.Get(slice), track[n]->Pixel, range.Wire, slice }, track[n]->Score });
      }
    }
  }
  return found;
}

//------------------------------------------------------------------------------
std::vector<std::optional<std::array<lacuna::Vec2, 2>>> lacuna::CalibrationPicks::FindWalls(
  lacuna::AlgorithmExecution& execution, vtkImageData* slices, const lacuna::ProbePoses* poses)
{
  const Images images(slices, "a wall");
  std::vector<std::optional<std::array<lacuna::Vec2, 2>>> walls(
    static_cast<std::size_t>(images.GetCount()));
  execution.For(images.GetCount(), 1,
    [&](std::int64_t first, std::int64_t last)
    {
      for (std::int64_t k = first; k < last; ++k)
      {
        if (poses && poses->GetStatus(GetSliceNumber(slices, *poses, k)))
        {
          continue;
        }
        if (const std::optional<lacuna::WallLine> wall = lacuna::FindWall(images.Get(k)))
        {
          walls[static_cast<std::size_t>(k)] = { images.GetPixel(wall->Points[0]),
            images.GetPixel(wall->Points[1]) };
        }
      }
    });
  return walls;
}

//------------------------------------------------------------------------------
std::vector<lacuna::SlicePick> lacuna::CalibrationPicks::FindWallPicks(
  lacuna::AlgorithmExecution& execution, vtkImageData* slices, const lacuna::ProbePoses& poses)
{
  const auto walls = FindWalls(execution, slices, &poses);
  std::vector<lacuna::SlicePick> picks;
  for (std::size_t k = 0; k < walls.size(); ++k)
  {
    if (walls[k])
    {
      const vtkIdType slice = GetSliceNumber(slices, poses, static_cast<std::int64_t>(k));
      for (const lacuna::Vec2& point : *walls[k])
      {
        picks.push_back(
          { slice, { poses.Get(slice), point, lacuna::CalibrationTarget::Wall, slice } });
      }
    }
  }
  return picks;
}

//------------------------------------------------------------------------------
std::vector<lacuna::SlicePick> lacuna::CalibrationPicks::GetTips(
  vtkImageData* slices, const lacuna::ProbePoses& poses)
{
  std::vector<lacuna::SlicePick> picks;
  for (int k = 0; k < slices->GetDimensions()[2]; ++k)
  {
    const vtkIdType slice = GetSliceNumber(slices, poses, k);
    if (!(poses.GetStatus(slice) & ~TipIgnores))
    {
      picks.push_back(
        { slice, { poses.Get(slice), { 0, 0 }, lacuna::CalibrationTarget::Tip, slice } });
    }
  }
  return picks;
}

//------------------------------------------------------------------------------
std::string lacuna::CalibrationPicks::DescribeLeftOut(vtkImageData* slices,
  const lacuna::ProbePoses& poses, const std::vector<lacuna::WireRange>& ranges, bool tip)
{
  std::vector<int> status;
  for (int k = 0; k < slices->GetDimensions()[2]; ++k)
  {
    const vtkIdType slice = GetSliceNumber(slices, poses, k);
    if (ranges.empty() || lacuna::FindWire(ranges, slice))
    {
      status.push_back(poses.GetStatus(slice) & ~(tip ? TipIgnores : 0));
    }
  }
  const std::string flags = DescribeFlags(status);
  return flags.empty() ? flags : "left out are " + flags;
}

//------------------------------------------------------------------------------
std::string lacuna::CalibrationPicks::DescribeFlagged(
  const std::vector<lacuna::SlicePick>& picks, const lacuna::ProbePoses& poses)
{
  std::vector<int> status;
  std::set<vtkIdType> seen;
  for (const lacuna::SlicePick& pick : picks)
  {
    if (seen.insert(pick.Slice).second)
    {
      status.push_back(poses.GetStatus(pick.Slice));
    }
  }
  const std::string flags = DescribeFlags(status);
  return flags.empty() ? flags
                       : "picks were given, and count, in " + flags +
      ": the picture may be of another place than the pose";
}
