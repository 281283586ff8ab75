// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaOutlineTools.h"

#include "lacunaArrays.h"
#include "vtkCellArray.h"
#include "vtkDataArray.h"
#include "vtkFlyingEdges2D.h"
#include "vtkImageConstantPad.h"
#include "vtkImageData.h"
#include "vtkImageGaussianSmooth.h"
#include "vtkImageMedian3D.h"
#include "vtkMath.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkParametricSpline.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"
#include "vtkStripper.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

vtkStandardNewMacro(vtkLacunaOutlineTools);

namespace
{
using Place = std::array<double, 2>; // column, row

std::vector<Place> GetPlaces(vtkPoints* points)
{
  std::vector<Place> places;
  for (vtkIdType i = 0; i < points->GetNumberOfPoints(); ++i)
  {
    double x[3];
    points->GetPoint(i, x);
    places.push_back({ x[0], x[1] });
  }
  return places;
}

void SetPlaces(vtkPoints* points, const std::vector<Place>& places, double z)
{
  points->SetDataTypeToDouble();
  points->Reset();
  for (const Place& p : places)
  {
    points->InsertNextPoint(p[0], p[1], z);
  }
  points->Modified();
}

double GetZ(vtkPoints* points)
{
  return points->GetNumberOfPoints() > 0 ? points->GetPoint(0)[2] : 0;
}

double Distance(const Place& a, const Place& b)
{
  return std::hypot(b[0] - a[0], b[1] - a[1]);
}

// Of a closed line, by its corners.
double GetArea(const std::vector<Place>& line)
{
  double sum = 0;
  for (std::size_t i = 0; i < line.size(); ++i)
  {
    const Place& a = line[i];
    const Place& b = line[(i + 1) % line.size()];
    sum += a[0] * b[1] - a[1] * b[0];
  }
  return std::abs(sum) / 2;
}

bool IsInside(const std::vector<Place>& line, const double x[2])
{
  bool inside = false;
  for (std::size_t i = 0; i < line.size(); ++i)
  {
    const Place& a = line[i];
    const Place& b = line[(i + 1) % line.size()];
    if ((a[1] > x[1]) != (b[1] > x[1]) &&
      x[0] < a[0] + (b[0] - a[0]) * (x[1] - a[1]) / (b[1] - a[1]))
    {
      inside = !inside;
    }
  }
  return inside;
}

double GetDistanceFromSegment(const Place& x, const Place& a, const Place& b)
{
  const double length = Distance(a, b);
  double t = 0;
  if (length > 0)
  {
    t = ((x[0] - a[0]) * (b[0] - a[0]) + (x[1] - a[1]) * (b[1] - a[1])) / (length * length);
    t = std::clamp(t, 0.0, 1.0);
  }
  return Distance(x, { a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]) });
}

// Keeps what is needed between first and last (Douglas and Peucker).
void Keep(const std::vector<Place>& line, std::size_t first, std::size_t last, double tolerance,
  std::vector<char>& kept)
{
  std::vector<std::pair<std::size_t, std::size_t>> parts{ { first, last } };
  while (!parts.empty())
  {
    const auto [begin, end] = parts.back();
    parts.pop_back();
    double farthest = tolerance;
    std::size_t at = begin;
    for (std::size_t i = begin + 1; i < end; ++i)
    {
      const double away = GetDistanceFromSegment(line[i], line[begin], line[end]);
      if (away > farthest)
      {
        farthest = away;
        at = i;
      }
    }
    if (at != begin)
    {
      kept[at] = 1;
      parts.emplace_back(begin, at);
      parts.emplace_back(at, end);
    }
  }
}

// The part of a picture within a rectangle, with its median over a square.
vtkSmartPointer<vtkImageData> GetFiltered(vtkImageData* picture, const int region[4], int size)
{
  int extent[6];
  picture->GetExtent(extent);
  const double* origin = picture->GetOrigin();
  const double* spacing = picture->GetSpacing();
  for (int c = 0; c < 2; ++c)
  {
    if (region[0] <= region[1] && region[2] <= region[3])
    {
      const auto first = static_cast<int>(std::ceil((region[2 * c] - origin[c]) / spacing[c]));
      const auto last = static_cast<int>(std::floor((region[2 * c + 1] - origin[c]) / spacing[c]));
      extent[2 * c] = std::max(extent[2 * c], first);
      extent[2 * c + 1] = std::min(extent[2 * c + 1], last);
    }
  }
  vtkNew<vtkImageData> image;
  if (extent[0] > extent[1] || extent[2] > extent[3] || !picture->GetPointData()->GetScalars())
  {
    return image;
  }
  if (size > 1)
  {
    vtkNew<vtkImageMedian3D> median;
    median->SetInputData(picture);
    median->SetKernelSize(size, size, 1);
    median->Update();
    image->ShallowCopy(median->GetOutput());
  }
  else
  {
    image->ShallowCopy(picture);
  }
  image->Crop(extent);
  return image;
}

// Of the pixel nearest to a place, if there is one.
std::optional<double> GetNearestLevel(vtkImageData* image, const double place[2])
{
  const double* origin = image->GetOrigin();
  const double* spacing = image->GetSpacing();
  const int* extent = image->GetExtent();
  const int i = static_cast<int>(std::lround((place[0] - origin[0]) / spacing[0]));
  const int j = static_cast<int>(std::lround((place[1] - origin[1]) / spacing[1]));
  if (i < extent[0] || i > extent[1] || j < extent[2] || j > extent[3])
  {
    return {};
  }
  return image->GetScalarComponentAsDouble(i, j, extent[4], 0);
}

// The contours at a level, closed outside of the image; isBright: so that what is above the level is inside.
vtkSmartPointer<vtkPolyData> FindContours(vtkImageData* image, double level, bool isBright)
{
  vtkDataArray* scalars = image->GetPointData()->GetScalars();
  vtkNew<vtkImageData> real;
  real->CopyStructure(image);
  lacuna::Arrays::AddScalars(real, VTK_DOUBLE, "Intensity");
  double range[2];
  scalars->GetFiniteRange(range);
  // so far that the border is crossed at half a pixel where the picture is just at the level
  const double beyond =
    isBright ? std::min(range[0], 2 * level - range[1]) : std::max(range[1], 2 * level - range[0]);
  for (vtkIdType n = 0; n < scalars->GetNumberOfTuples(); ++n)
  {
    const double value = scalars->GetComponent(n, 0);
    real->GetPointData()->GetScalars()->SetComponent(n, 0, std::isfinite(value) ? value : beyond);
  }
  const int* extent = image->GetExtent();
  vtkNew<vtkImageConstantPad> pad;
  pad->SetInputData(real);
  pad->SetOutputWholeExtent(
    extent[0] - 1, extent[1] + 1, extent[2] - 1, extent[3] + 1, extent[4], extent[5]);
  pad->SetConstant(beyond);
  vtkNew<vtkFlyingEdges2D> edges;
  edges->SetInputConnection(pad->GetOutputPort());
  edges->SetValue(0, level);
  vtkNew<vtkStripper> lines;
  lines->SetInputConnection(edges->GetOutputPort());
  lines->SetMaximumLength(1000000);
  lines->JoinContiguousSegmentsOn();
  lines->Update();
  return lines->GetOutput();
}

// Of the closed lines: the innermost around a place, or without one (null) that with the largest area.
std::vector<Place> ChooseContour(vtkPolyData* contours, const double* place)
{
  vtkCellArray* cells = contours->GetLines();
  std::vector<Place> best;
  double bestArea = 0;
  for (vtkIdType c = 0; c < cells->GetNumberOfCells(); ++c)
  {
    vtkIdType count = 0;
    const vtkIdType* ids = nullptr;
    cells->GetCellAtId(c, count, ids);
    if (count < 4 || ids[0] != ids[count - 1])
    {
      continue;
    }
    std::vector<Place> line;
    for (vtkIdType i = 0; i + 1 < count; ++i)
    {
      double x[3];
      contours->GetPoint(ids[i], x);
      line.push_back({ x[0], x[1] });
    }
    const double area = GetArea(line);
    const bool isBetter =
      place ? IsInside(line, place) && (best.empty() || area < bestArea) : area > bestArea;
    if (isBetter)
    {
      best = std::move(line);
      bestArea = area;
    }
  }
  return best;
}

// Moves what is outside of the pixels' middles to their border.
void Confine(std::vector<Place>& line, vtkImageData* image)
{
  const double* origin = image->GetOrigin();
  const double* spacing = image->GetSpacing();
  const int* extent = image->GetExtent();
  const double low[2] = { origin[0] + extent[0] * spacing[0], origin[1] + extent[2] * spacing[1] };
  const double high[2] = { origin[0] + extent[1] * spacing[0], origin[1] + extent[3] * spacing[1] };
  for (Place& p : line)
  {
    for (int c = 0; c < 2; ++c)
    {
      p[c] = std::clamp(p[c], std::min(low[c], high[c]), std::max(low[c], high[c]));
    }
  }
  line.erase(std::unique(line.begin(), line.end()), line.end());
}

// A picture, smoothed over one pixel.
class SmoothPicture
{
public:
  explicit SmoothPicture(vtkImageData* picture)
  {
    vtkNew<vtkImageData> real;
    real->CopyStructure(picture);
    lacuna::Arrays::AddScalars(real, VTK_FLOAT, "Intensity");
    for (vtkIdType n = 0; n < picture->GetNumberOfPoints(); ++n)
    {
      real->GetPointData()->GetScalars()->SetComponent(
        n, 0, picture->GetPointData()->GetScalars()->GetComponent(n, 0));
    }
    vtkNew<vtkImageGaussianSmooth> smooth;
    smooth->SetDimensionality(2);
    smooth->SetStandardDeviations(1, 1);
    smooth->SetInputData(real);
    smooth->Update();
    this->Image = smooth->GetOutput();
    this->Image->GetExtent(this->Extent);
    this->Image->GetOrigin(this->Origin);
    this->Image->GetSpacing(this->Spacing);
    this->Values = static_cast<const float*>(this->Image->GetScalarPointer());
  }

  // Linear between pixels; not a number outside.
  double At(const Place& x) const
  {
    const int columns = this->Extent[1] - this->Extent[0] + 1;
    const int rows = this->Extent[3] - this->Extent[2] + 1;
    const double u = (x[0] - this->Origin[0]) / this->Spacing[0] - this->Extent[0];
    const double v = (x[1] - this->Origin[1]) / this->Spacing[1] - this->Extent[2];
    if (!(u >= 0 && v >= 0 && u <= columns - 1 && v <= rows - 1))
    {
      return vtkMath::Nan();
    }
    const int i = std::min(static_cast<int>(u), columns - 2);
    const int j = std::min(static_cast<int>(v), rows - 2);
    if (i < 0 || j < 0)
    {
      return vtkMath::Nan();
    }
    const float* p = this->Values + static_cast<std::ptrdiff_t>(j) * columns + i;
    const double a = u - i;
    const double b = v - j;
    return (1 - b) * ((1 - a) * p[0] + a * p[1]) + b * ((1 - a) * p[columns] + a * p[columns + 1]);
  }

private:
  vtkSmartPointer<vtkImageData> Image;
  int Extent[6];
  double Origin[3];
  double Spacing[3];
  const float* Values;
};

Place Along(const Place& x, const Place& direction, double length)
{
  return { x[0] + length * direction[0], x[1] + length * direction[1] };
}

// How far along a direction, on either side, the picture changes most; 0: there is no change.
double FindEdge(const SmoothPicture& picture, const Place& x, const Place& direction, double reach)
{
  constexpr double step = 0.25; // pixels
  const int steps = static_cast<int>(std::floor(reach / step));
  double best = 1e-3; // less is no change
  int bestStep = 0;
  for (int s = 0; s <= steps; ++s) // of equal ones the nearest
  {
    for (const int side : { s, -s })
    {
      const double slope = std::abs(picture.At(Along(x, direction, side * step + 1)) -
        picture.At(Along(x, direction, side * step - 1)));
      if (slope > best * (1 + 1e-9))
      {
        best = slope;
        bestStep = side;
      }
    }
  }
  return bestStep * step;
}
}

//------------------------------------------------------------------------------
int vtkLacunaOutlineTools::MakeCurve(vtkPoints* points, bool smooth, vtkPoints* curve)
{
  std::vector<Place> places = GetPlaces(points);
  places.erase(std::unique(places.begin(), places.end()), places.end());
  while (places.size() > 1 && places.front() == places.back())
  {
    places.pop_back();
  }
  const double z = GetZ(points);
  constexpr std::size_t most = 400;
  constexpr std::size_t mostSteps = 8;
  const std::size_t n = places.size();
  const std::size_t steps = smooth && n >= 3 ? std::clamp<std::size_t>(most / n, 1, mostSteps) : 1;
  if (steps == 1)
  {
    SetPlaces(curve, places, z);
    return 1;
  }
  vtkNew<vtkPoints> handles;
  SetPlaces(handles, places, 0);
  vtkNew<vtkParametricSpline> spline;
  spline->SetPoints(handles);
  spline->ClosedOn();
  spline->ParameterizeByLengthOn();
  // where the points are on it: by the length of the chords
  std::vector<double> at(n + 1, 0);
  for (std::size_t i = 0; i < n; ++i)
  {
    at[i + 1] = at[i] + Distance(places[i], places[(i + 1) % n]);
  }
  std::vector<Place> line;
  for (std::size_t i = 0; i < n; ++i)
  {
    line.push_back(places[i]);
    for (std::size_t k = 1; k < steps; ++k)
    {
      const double part = static_cast<double>(k) / static_cast<double>(steps);
      double u[3] = { (at[i] + part * (at[i + 1] - at[i])) / at[n], 0, 0 };
      double x[3];
      double derivatives[9];
      spline->Evaluate(u, x, derivatives);
      line.push_back({ x[0], x[1] });
    }
  }
  SetPlaces(curve, line, z);
  return static_cast<int>(steps);
}

//------------------------------------------------------------------------------
void vtkLacunaOutlineTools::Simplify(vtkPoints* line, double tolerance, vtkPoints* result)
{
  const std::vector<Place> places = GetPlaces(line);
  constexpr std::size_t least = 8;
  const std::size_t n = places.size();
  const double z = GetZ(line);
  if (n <= least)
  {
    SetPlaces(result, places, z);
    return;
  }
  std::vector<char> kept(n, 0);
  for (std::size_t i = 0; i < least; ++i) // also where it is straight
  {
    kept[i * n / least] = 1;
  }
  std::vector<Place> closed = places;
  closed.push_back(places.front());
  kept.push_back(1);
  for (std::size_t i = 0; i < least; ++i)
  {
    Keep(closed, i * n / least, (i + 1) * n / least, tolerance, kept);
  }
  std::vector<Place> few;
  for (std::size_t i = 0; i < n; ++i)
  {
    if (kept[i])
    {
      few.push_back(places[i]);
    }
  }
  SetPlaces(result, few, z);
}

//------------------------------------------------------------------------------
double vtkLacunaOutlineTools::ProposeLevel(vtkImageData* picture, const int region[4])
{
  const vtkSmartPointer<vtkImageData> image = GetFiltered(picture, region, 1);
  vtkDataArray* scalars = image->GetPointData()->GetScalars();
  if (!scalars || scalars->GetNumberOfTuples() == 0)
  {
    return 0;
  }
  double range[2];
  scalars->GetFiniteRange(range);
  constexpr int bins = 256;
  const double width = (range[1] - range[0]) / bins;
  if (!(width > 0))
  {
    return range[0];
  }
  std::array<double, bins> counts{};
  double all = 0;
  double sum = 0;
  for (vtkIdType i = 0; i < scalars->GetNumberOfTuples(); ++i)
  {
    const double value = scalars->GetComponent(i, 0);
    if (std::isfinite(value))
    {
      const int bin = std::min(static_cast<int>((value - range[0]) / width), bins - 1);
      counts[bin] += 1;
      all += 1;
      sum += bin;
    }
  }
  // The level with the largest variance between both sides; where several are equal, their middle.
  double dark = 0;
  double darkSum = 0;
  double best = -1;
  int first = 0;
  int last = 0;
  for (int b = 0; b + 1 < bins; ++b)
  {
    dark += counts[b];
    darkSum += counts[b] * b;
    if (dark == 0 || dark == all)
    {
      continue;
    }
    const double difference = darkSum / dark - (sum - darkSum) / (all - dark);
    const double between = dark * (all - dark) * difference * difference;
    if (between > best)
    {
      best = between;
      first = b;
    }
    if (between == best)
    {
      last = b;
    }
  }
  return range[0] + (0.5 * (first + last) + 1) * width;
}

//------------------------------------------------------------------------------
bool vtkLacunaOutlineTools::Trace(vtkImageData* picture, double level, const double place[2],
  const int region[4], int medianSize, vtkPoints* outline)
{
  outline->Reset();
  const vtkSmartPointer<vtkImageData> image = GetFiltered(picture, region, medianSize);
  vtkDataArray* scalars = image->GetPointData()->GetScalars();
  if (!scalars || scalars->GetNumberOfTuples() == 0)
  {
    return false;
  }
  // A border on the other side of the level closes what reaches it: below for what is bright around the
  // place, above for what is dark. Of a rectangle: what is bright.
  const bool hasPlace = std::isfinite(place[0]) && std::isfinite(place[1]);
  bool isBright = true;
  if (hasPlace)
  {
    const std::optional<double> value = GetNearestLevel(image, place);
    if (!value)
    {
      return false;
    }
    isBright = *value >= level;
  }
  const vtkSmartPointer<vtkPolyData> contours = FindContours(image, level, isBright);
  std::vector<Place> line = ChooseContour(contours, hasPlace ? place : nullptr);
  if (line.empty())
  {
    return false;
  }
  Confine(line, image);
  const int* extent = image->GetExtent();
  SetPlaces(outline, line, image->GetOrigin()[2] + extent[4] * image->GetSpacing()[2]);
  return outline->GetNumberOfPoints() >= 3;
}

//------------------------------------------------------------------------------
int vtkLacunaOutlineTools::Snap(vtkImageData* picture, vtkPoints* points, double reach)
{
  std::vector<Place> places = GetPlaces(points);
  if (places.size() < 3 || !(reach > 0) || !picture->GetPointData()->GetScalars())
  {
    return 0;
  }
  const SmoothPicture smooth(picture);
  const std::size_t n = places.size();
  std::vector<Place> moved = places;
  int count = 0;
  for (std::size_t i = 0; i < n; ++i)
  {
    const Place& before = places[(i + n - 1) % n];
    const Place& after = places[(i + 1) % n];
    const double length = Distance(before, after);
    if (!(length > 0))
    {
      continue;
    }
    const Place across{ (after[1] - before[1]) / length, (before[0] - after[0]) / length };
    const double away = FindEdge(smooth, places[i], across, reach);
    if (away != 0)
    {
      moved[i] = Along(places[i], across, away);
      ++count;
    }
  }
  SetPlaces(points, moved, GetZ(points));
  return count;
}

//------------------------------------------------------------------------------
bool vtkLacunaOutlineTools::FindCrossing(vtkPoints* line, double where[3])
{
  const std::vector<Place> places = GetPlaces(line);
  const std::size_t n = places.size();
  const auto side = [](const Place& a, const Place& b, const Place& x)
  { return (b[0] - a[0]) * (x[1] - a[1]) - (b[1] - a[1]) * (x[0] - a[0]); };
  for (std::size_t i = 0; i + 2 < n; ++i)
  {
    const Place& a = places[i];
    const Place& b = places[i + 1];
    for (std::size_t j = i + 2; j < n; ++j)
    {
      if (i == 0 && j == n - 1)
      {
        continue; // neighbours
      }
      const Place& c = places[j];
      const Place& d = places[(j + 1) % n];
      const double ca = side(a, b, c);
      const double da = side(a, b, d);
      if (ca * da < 0 && side(c, d, a) * side(c, d, b) < 0)
      {
        const double t = ca / (ca - da);
        where[0] = c[0] + t * (d[0] - c[0]);
        where[1] = c[1] + t * (d[1] - c[1]);
        where[2] = GetZ(line);
        return true;
      }
    }
  }
  return false;
}
