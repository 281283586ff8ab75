// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaCTGeometry.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

namespace lacuna
{
namespace
{
constexpr double MostPlanes = 1e6;
constexpr int MostParts = 5; // a grid that is finer still would be mostly interpolated

std::vector<double> GetGaps(const std::vector<double>& positions)
{
  std::vector<double> gaps;
  for (std::size_t i = 1; i < positions.size(); ++i)
  {
    gaps.push_back(positions[i] - positions[i - 1]);
  }
  return gaps;
}

double GetUsualGap(std::vector<double> gaps, double tolerance)
{
  std::sort(gaps.begin(), gaps.end());
  const std::size_t enough = std::max<std::size_t>(3, gaps.size() / 10);
  for (std::size_t i = 0; i + enough <= gaps.size(); ++i)
  {
    // rounded positions make a gap wrong by twice their own error
    const double width = std::min(2 * tolerance, 0.1 * gaps[i]);
    if (gaps[i + enough - 1] - gaps[i] <= width)
    {
      const auto end = std::upper_bound(gaps.begin(), gaps.end(), gaps[i] + width);
      return gaps[(i + static_cast<std::size_t>(end - gaps.begin())) / 2];
    }
  }
  return gaps[gaps.size() / 2];
}

// The planes on which all slices lie; false when there are none.
bool FitPlanes(const std::vector<double>& positions, SliceSpacing& planes)
{
  const std::size_t count = positions.size();
  std::vector<double> index(count, 0.0);
  double sum = 0;
  double mean = positions[0];
  for (std::size_t i = 1; i < count; ++i)
  {
    const double steps = std::round((positions[i] - positions[i - 1]) / planes.Spacing);
    if (steps < 1)
    {
      return false;
    }
    index[i] = index[i - 1] + steps;
    sum += index[i];
    mean += positions[i];
  }
  mean /= static_cast<double>(count);
  const double center = sum / static_cast<double>(count);
  double numerator = 0;
  double denominator = 0;
  for (std::size_t i = 0; i < count; ++i)
  {
    numerator += (index[i] - center) * (positions[i] - mean);
    denominator += (index[i] - center) * (index[i] - center);
  }
  const double spacing = numerator / denominator;
  const double first = mean - spacing * center;
  double deviation = 0;
  for (std::size_t i = 0; i < count; ++i)
  {
    deviation = std::max(deviation, std::abs(positions[i] - (first + spacing * index[i])));
  }
  if (!(deviation <= planes.Tolerance))
  {
    return false;
  }
  // What rounding of the sums did is no property of the data.
  const bool exact = deviation < 1e-9;
  planes.First = exact ? positions[0] : first;
  planes.Spacing = exact ? (positions.back() - positions[0]) / index.back() : spacing;
  planes.Deviation = exact ? 0 : deviation;
  planes.Planes = static_cast<std::int64_t>(index.back()) + 1;
  for (std::size_t i = 1; i < count; ++i)
  {
    for (double k = index[i - 1] + 1; k < index[i]; ++k)
    {
      planes.Missing.push_back(static_cast<std::int64_t>(k));
    }
  }
  return true;
}
}

//------------------------------------------------------------------------------
SliceSpacing FindSliceSpacing(const std::vector<double>& positions, double tolerance)
{
  SliceSpacing planes;
  const std::vector<double> gaps = GetGaps(positions);
  planes.First = positions[0];
  planes.Spacing = planes.Usual = GetUsualGap(gaps, tolerance);
  planes.Tolerance = std::min(tolerance, 0.25 * planes.Spacing);
  const double length = (positions.back() - positions[0]) / planes.Spacing;
  if (!(length < MostPlanes))
  {
    std::ostringstream message;
    message << "at " << planes.Spacing << " mm from slice to slice that would be " << length
            << " slices";
    throw std::runtime_error(message.str());
  }
  if (FitPlanes(positions, planes))
  {
    return planes;
  }
  for (std::size_t i = 0; i < gaps.size(); ++i)
  {
    const double steps = std::max(1.0, std::round(gaps[i] / planes.Usual));
    if (std::abs(gaps[i] - steps * planes.Usual) > planes.Tolerance)
    {
      planes.UnequalGaps.push_back(i);
    }
  }
  for (int parts = 2; parts <= MostParts && parts * length < MostPlanes; ++parts)
  {
    SliceSpacing finer = planes;
    finer.Spacing = planes.Usual / parts;
    finer.Tolerance = std::min(tolerance, 0.25 * finer.Spacing);
    if (FitPlanes(positions, finer))
    {
      finer.Missing.clear(); // planes that no scanner meant to measure
      return finer;
    }
  }
  const double steps = std::max(1.0, std::round(length));
  planes.Planes = static_cast<std::int64_t>(steps) + 1;
  planes.Spacing = (positions.back() - positions[0]) / steps;
  planes.Tolerance = std::min(tolerance, 0.25 * planes.Spacing);
  return planes;
}

//------------------------------------------------------------------------------
namespace
{
constexpr double Pi = 3.14159265358979323846;
constexpr std::size_t MostNamed = 8; // positions in one message

// At a position: " at 12.5 mm (IM0007)".
std::string Place(const CTSlice& slice)
{
  std::ostringstream text;
  text << slice.Frame.GetName() << " at " << slice.Position << " mm";
  return text.str();
}

std::string Join(const std::vector<std::string>& parts)
{
  std::string text;
  for (std::size_t i = 0; i < std::min(parts.size(), MostNamed); ++i)
  {
    text += (i == 0 ? "" : ", ") + parts[i];
  }
  return parts.size() > MostNamed
    ? text + " and " + std::to_string(parts.size() - MostNamed) + " more"
    : text;
}

std::array<Vec3, 3> FindAxes(const CTFrame& frame)
{
  const std::array<double, 6>& a = *frame.Axes;
  const Vec3 row = { a[0], a[1], a[2] };
  const Vec3 column = { a[3], a[4], a[5] };
  const double skew = Dot(Normalized(row), Normalized(column));
  if (std::abs(Norm(row) - 1) > 0.01 || std::abs(Norm(column) - 1) > 0.01 || std::abs(skew) > 1e-3)
  {
    std::ostringstream message;
    message << frame.GetName() << ": Image Orientation (Patient) (0020,0037) is " << a[0];
    for (int i = 1; i < 6; ++i)
    {
      message << "\\" << a[i];
    }
    message << "; it must be two unit vectors at a right angle";
    throw std::runtime_error(message.str());
  }
  // The orthonormal pair nearest to both: rounded numbers are not made worse for either.
  const Vec3 sum = Normalized(Normalized(row) + Normalized(column));
  const Vec3 difference = Normalized(Normalized(row) - Normalized(column));
  const Vec3 x = skew == 0 ? Normalized(row) : std::sqrt(0.5) * (sum + difference);
  const Vec3 y = skew == 0 ? Normalized(column) : std::sqrt(0.5) * (sum - difference);
  return { x, y, Cross(x, y) };
}

// In-plane coordinates of the first pixel, mm.
double Along(const Vec3& axis, const CTSlice& slice)
{
  return Dot(axis, *slice.Frame.Position);
}

std::vector<CTSlice> SortSlices(const std::vector<CTFrame>& frames, const Vec3& normal)
{
  std::vector<CTSlice> slices;
  for (const CTFrame& frame : frames)
  {
    slices.push_back({ frame, Dot(normal, *frame.Position), 0, 0 });
  }
  std::sort(slices.begin(), slices.end(),
    [](const CTSlice& a, const CTSlice& b)
    {
      if (a.Position != b.Position)
      {
        return a.Position < b.Position;
      }
      return a.Frame.Header->File != b.Frame.Header->File
        ? a.Frame.Header->File < b.Frame.Header->File
        : a.Frame.Number < b.Frame.Number;
    });
  return slices;
}

std::string Acquisition(const CTSlice& slice)
{
  return slice.Frame.Acquisition ? std::to_string(*slice.Frame.Acquisition) : "none";
}

// How near slices are at one position: within the tolerance, but never at neighbouring ones. Most
// gaps may be those between copies, so that the usual distance is a large gap.
double GetCopyDistance(const std::vector<CTSlice>& slices, double tolerance)
{
  constexpr double Least = 1e-6; // what rounding does to equal positions is less
  std::vector<double> gaps;
  for (std::size_t i = 1; i < slices.size(); ++i)
  {
    gaps.push_back(slices[i].Position - slices[i - 1].Position);
  }
  std::sort(gaps.begin(), gaps.end());
  return gaps.empty() ? tolerance
                      : std::min(tolerance, std::max(Least, 0.25 * gaps[gaps.size() * 3 / 4]));
}

void DropDuplicates(CTGeometry& geometry, const CTGeometryOptions& options)
{
  const double near = GetCopyDistance(geometry.Slices, options.PositionTolerance);
  std::vector<CTSlice> kept;
  std::vector<std::string> dropped;
  std::vector<std::string> different;
  bool several = false;
  for (const CTSlice& slice : geometry.Slices)
  {
    if (kept.empty() || slice.Position - kept.back().Position > near)
    {
      kept.push_back(slice);
      continue;
    }
    const CTSlice& other = kept.back();
    const Vec3 between = *slice.Frame.Position - *other.Frame.Position;
    if (Norm(between) <= options.PositionTolerance && options.SameImage &&
      options.SameImage(other.Frame, slice.Frame))
    {
      dropped.push_back(Place(slice));
      continue;
    }
    const bool apart = Acquisition(slice) != Acquisition(other);
    several = several || apart;
    different.push_back(Place(slice) + " and " + other.Frame.GetName() +
      (apart ? " (acquisitions " + Acquisition(slice) + ", " + Acquisition(other) + ")"
             : std::string()));
  }
  if (!different.empty())
  {
    throw std::runtime_error(std::to_string(different.size()) +
      " slices are there twice with different images: " + Join(different) +
      (several ? "; set Acquisition to the number of the one that is wanted"
               : "; remove those that do not belong to the volume"));
  }
  if (!dropped.empty())
  {
    geometry.Warnings.push_back(std::to_string(dropped.size()) +
      " slices are there twice with the same image, the second is left out: " + Join(dropped));
  }
  geometry.Slices = std::move(kept);
}

std::string NamePositions(const SliceSpacing& spacing)
{
  std::vector<std::string> places;
  for (const std::int64_t plane : spacing.Missing)
  {
    std::ostringstream text;
    text << spacing.GetPosition(plane) << " mm";
    places.push_back(text.str());
  }
  return Join(places);
}

std::string DescribeGaps(const CTGeometry& geometry, const SliceSpacing& spacing)
{
  std::ostringstream text;
  if (!spacing.Missing.empty())
  {
    text << spacing.Missing.size()
         << (spacing.Missing.size() == 1 ? " slice is missing at " : " slices are missing at ")
         << NamePositions(spacing) << " along the slice normal";
    return text.str();
  }
  std::vector<std::string> places;
  for (const std::size_t gap : spacing.UnequalGaps)
  {
    std::ostringstream place;
    place << geometry.Slices[gap + 1].Position - geometry.Slices[gap].Position << " mm between "
          << Place(geometry.Slices[gap]) << " and " << Place(geometry.Slices[gap + 1]);
    places.push_back(place.str());
  }
  text << "the slices are not equally spaced: mostly " << spacing.Usual << " mm, but "
       << (places.empty() ? "with deviations that add up" : Join(places));
  return text.str();
}

// The planes, each made of the slice on it or of those beside it.
void MakePlanes(CTGeometry& geometry, const SliceSpacing& spacing)
{
  std::size_t next = 0; // the first slice not before the plane
  for (std::int64_t k = 0; k < spacing.Planes; ++k)
  {
    const double position = spacing.GetPosition(k);
    while (next + 1 < geometry.Slices.size() &&
      geometry.Slices[next].Position < position - spacing.Tolerance)
    {
      ++next;
    }
    const CTSlice& after = geometry.Slices[next];
    if (std::abs(after.Position - position) <= spacing.Tolerance || next == 0)
    {
      geometry.Planes.push_back({ next, next, 0 });
      continue;
    }
    const CTSlice& before = geometry.Slices[next - 1];
    geometry.Planes.push_back({ next - 1, next,
      std::min(1.0, (position - before.Position) / (after.Position - before.Position)) });
    geometry.Interpolated.push_back(static_cast<int>(k));
  }
}

// Tells what became of the slices where planes had to be interpolated.
void NoteInterpolation(CTGeometry& geometry, const SliceSpacing& spacing, const std::string& reason)
{
  std::vector<bool> kept(geometry.Slices.size(), false);
  for (const CTPlane& plane : geometry.Planes)
  {
    kept[plane.First] = kept[plane.First] || plane.Weight == 0;
  }
  const auto count = static_cast<std::size_t>(std::count(kept.begin(), kept.end(), true));
  std::ostringstream note;
  note << reason << "; " << geometry.Interpolated.size() << " of " << geometry.Planes.size()
       << " planes, every " << spacing.Spacing << " mm, are interpolated; " << count << " of "
       << kept.size() << " measured slices are planes of their own";
  geometry.Notes.push_back(note.str());
  if (count == kept.size())
  {
    return;
  }
  std::vector<std::string> blended;
  for (std::size_t i = 0; i < kept.size(); ++i)
  {
    if (!kept[i])
    {
      blended.push_back(Place(geometry.Slices[i]));
    }
  }
  geometry.Warnings.push_back(std::to_string(blended.size()) + " of " +
    std::to_string(kept.size()) +
    " measured slices are in the volume only as parts of interpolated planes: " + Join(blended));
}

void FindPlanes(CTGeometry& geometry, const CTGeometryOptions& options)
{
  if (geometry.Slices.size() == 1)
  {
    const double thickness = geometry.Slices[0].Frame.Thickness.value_or(0);
    geometry.Spacing[2] = thickness > 0 ? thickness : 1;
    geometry.Planes = { { 0, 0, 0 } };
    geometry.Warnings.emplace_back("there is a single slice; its thickness stands for the spacing");
    return;
  }
  std::vector<double> positions;
  for (const CTSlice& slice : geometry.Slices)
  {
    positions.push_back(slice.Position);
  }
  SliceSpacing spacing;
  try
  {
    spacing = FindSliceSpacing(positions, options.PositionTolerance);
  }
  catch (const std::runtime_error& e)
  {
    throw std::runtime_error("the slices reach from " + Place(geometry.Slices.front()) + " to " +
      Place(geometry.Slices.back()) + ", and " + e.what());
  }
  const bool fitted = spacing.UnequalGaps.empty() && spacing.Deviation <= spacing.Tolerance;
  MakePlanes(geometry, spacing);
  if (!geometry.Interpolated.empty() || !fitted)
  {
    const std::string what = DescribeGaps(geometry, spacing);
    if (!options.InterpolateMissing)
    {
      throw std::runtime_error(
        what + "; find the missing images, or set MissingSlices to Interpolate");
    }
    NoteInterpolation(geometry, spacing, what);
  }
  if (spacing.Deviation > 1e-3)
  {
    std::ostringstream note;
    note << "the positions of slices differ by up to " << spacing.Deviation
         << " mm from equal spacing";
    geometry.Notes.push_back(note.str());
  }
  geometry.Spacing[2] = spacing.Spacing;
  geometry.Origin = (spacing.First - geometry.Slices[0].Position) * geometry.Axes[2];
}

// Slope of the positions along an axis over those along the normal, and the largest deviation.
struct Line
{
  double Slope = 0;
  double Deviation = 0;
  double Span = 0; // how far the slices go to the side
};

Line FitLine(const CTGeometry& geometry, const Vec3& axis)
{
  const auto count = static_cast<double>(geometry.Slices.size());
  double meanT = 0;
  double meanX = 0;
  for (const CTSlice& slice : geometry.Slices)
  {
    meanT += slice.Position / count;
    meanX += Along(axis, slice) / count;
  }
  double numerator = 0;
  double denominator = 0;
  for (const CTSlice& slice : geometry.Slices)
  {
    numerator += (slice.Position - meanT) * (Along(axis, slice) - meanX);
    denominator += (slice.Position - meanT) * (slice.Position - meanT);
  }
  Line line;
  line.Slope = denominator > 0 ? numerator / denominator : 0;
  for (const CTSlice& slice : geometry.Slices)
  {
    line.Deviation = std::max(
      line.Deviation, std::abs(Along(axis, slice) - meanX - line.Slope * (slice.Position - meanT)));
  }
  line.Span =
    std::abs(line.Slope) * (geometry.Slices.back().Position - geometry.Slices[0].Position);
  return line;
}

void RefuseDisplaced(const CTGeometry& geometry, const CTGeometryOptions& options)
{
  for (std::size_t i = 1; i < geometry.Slices.size(); ++i)
  {
    const Vec3 step = *geometry.Slices[i].Frame.Position - *geometry.Slices[i - 1].Frame.Position;
    const Vec3 first = *geometry.Slices[1].Frame.Position - *geometry.Slices[0].Frame.Position;
    const double t = Dot(step, geometry.Axes[2]) / Dot(first, geometry.Axes[2]);
    if (Norm(step - t * first) > options.PositionTolerance || i + 1 == geometry.Slices.size())
    {
      throw std::runtime_error("the slices are displaced sideways, not along a straight line: " +
        Place(geometry.Slices[i]) + " lies beside " + Place(geometry.Slices[i - 1]) +
        "; images of different reconstructions do not make one volume");
    }
  }
}

// A shift of more is no tilt but a wrong number, and the grid would have no end.
void CheckShift(const CTGeometry& geometry, double shift)
{
  constexpr double Most = 32768; // columns or rows
  if (!(shift <= Most))
  {
    std::ostringstream message;
    message << "the slices are sheared by " << shift << " pixels from "
            << Place(geometry.Slices.front()) << " to " << Place(geometry.Slices.back())
            << ": Image Position (Patient) (0020,0032) or Pixel Spacing (0028,0030) is wrong";
    throw std::runtime_error(message.str());
  }
}

void FindTilt(CTGeometry& geometry, const CTGeometryOptions& options)
{
  const Line x = FitLine(geometry, geometry.Axes[0]);
  const Line y = FitLine(geometry, geometry.Axes[1]);
  if (std::max(x.Deviation, y.Deviation) > options.PositionTolerance)
  {
    RefuseDisplaced(geometry, options);
  }
  const std::optional<double>& stated = geometry.Slices[0].Frame.Header->GantryTilt;
  if (std::max(x.Span, y.Span) <= options.PositionTolerance)
  {
    if (stated && std::abs(*stated) > 0.1 && geometry.Slices.size() > 1)
    {
      std::ostringstream warning;
      warning << "Gantry/Detector Tilt (0018,1120) is " << *stated
              << " degrees, but the positions of the slices show no shear; they are taken as true";
      geometry.Warnings.push_back(warning.str());
    }
    return;
  }
  geometry.TiltDegrees = std::atan(std::hypot(x.Slope, y.Slope)) * 180 / Pi;
  std::ostringstream what;
  what << "the slices are sheared by " << geometry.TiltDegrees
       << " degrees, as with a tilted gantry";
  if (!options.CorrectTilt)
  {
    throw std::runtime_error(what.str() + "; set GantryTilt to Correct to resample them");
  }
  geometry.Notes.push_back(what.str() + "; they were resampled to a rectangular grid");
  const std::array<double, 2> span = { x.Span, y.Span };
  for (int axis = 0; axis < 2; ++axis)
  {
    if (span[axis] <= options.PositionTolerance)
    {
      continue;
    }
    double first = HUGE_VAL;
    for (const CTSlice& slice : geometry.Slices)
    {
      first = std::min(first, Along(geometry.Axes[axis], slice));
    }
    double most = 0;
    for (CTSlice& slice : geometry.Slices)
    {
      double& shift = axis == 0 ? slice.ColumnShift : slice.RowShift;
      shift = (Along(geometry.Axes[axis], slice) - first) / geometry.Spacing[axis];
      most = std::max(most, shift);
    }
    CheckShift(geometry, most);
    std::int64_t& size = axis == 0 ? geometry.Columns : geometry.Rows;
    size += static_cast<std::int64_t>(std::ceil(most - 1e-6));
    geometry.Origin = geometry.Origin +
      (first - Along(geometry.Axes[axis], geometry.Slices[0])) * geometry.Axes[axis];
  }
}

// Numbers play no part, but one who knows the scanner's order may want to know of another.
void NoteNumbers(CTGeometry& geometry)
{
  const std::vector<CTSlice>& slices = geometry.Slices;
  bool rises = true;
  bool falls = slices.size() > 1;
  for (std::size_t i = 1; i < slices.size(); ++i)
  {
    const std::optional<int>& before = slices[i - 1].Frame.Instance;
    const std::optional<int>& after = slices[i].Frame.Instance;
    rises = rises && (!before || !after || *before < *after);
    falls = falls && before && after && *before > *after;
  }
  if (!rises)
  {
    geometry.Notes.push_back("Instance Number (0020,0013) " +
      std::string(falls ? "falls" : "is in another order") + " along the slice normal, from " +
      Place(slices.front()) + " to " + Place(slices.back()) +
      "; the images are sorted by Image Position (Patient) (0020,0032)");
  }
}
}

//------------------------------------------------------------------------------
CTGeometry FindCTGeometry(const std::vector<CTFrame>& frames, const CTGeometryOptions& options)
{
  CTGeometryOptions::ToleranceRange.Check("PositionTolerance", options.PositionTolerance);
  const CTFrame& example = frames.front();
  CTGeometry geometry;
  geometry.FrameColumns = geometry.Columns = example.Header->Columns;
  geometry.FrameRows = geometry.Rows = example.Header->Rows;
  geometry.Axes = FindAxes(example);
  geometry.Spacing = { (*example.Spacing)[1], (*example.Spacing)[0], 1 };
  geometry.Slices = SortSlices(frames, geometry.Axes[2]);
  DropDuplicates(geometry, options);
  FindPlanes(geometry, options);
  FindTilt(geometry, options);
  geometry.Origin = geometry.Origin + *geometry.Slices[0].Frame.Position;
  NoteNumbers(geometry);
  return geometry;
}
}
