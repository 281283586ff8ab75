// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaCADSurface.h"

#include "lacunaDefectContours.h"
#include "lacunaDepthMap.h"
#include "lacunaExecution.h"
#include "lacunaGridChecks.h"
#include "lacunaGridLayer.h"
#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkPointData.h"

#include <algorithm>
#include <cmath>
#include <locale>
#include <sstream>
#include <stdexcept>

namespace
{
// mm to which an outline follows the pixels, which tell no more than about a tenth of themselves
constexpr double OutlinePrecision = 0.01;
// mm between the outline and the surface when that one is exact
constexpr double FinestTolerance = 1e-4;

//------------------------------------------------------------------------------
// The pixels of a map to be written, relative to its extent, and their depths.
struct Rectangle
{
  std::int64_t Column = 0;
  std::int64_t Row = 0;
  lacuna::GridSize Size;
  std::vector<double> Depths;
};

Rectangle FindRectangle(vtkDataArray* array, std::int64_t columns, std::int64_t rows)
{
  const std::string name = array->GetName() ? array->GetName() : "";
  if (array->GetNumberOfComponents() != 1 || array->GetNumberOfTuples() != columns * rows)
  {
    throw std::runtime_error("point array '" + name + "' has " +
      std::to_string(array->GetNumberOfTuples()) + " tuples of " +
      std::to_string(array->GetNumberOfComponents()) +
      " components; expected one number for each "
      "of the " +
      std::to_string(columns * rows) + " pixels");
  }
  std::int64_t first[2] = { columns, rows };
  std::int64_t last[2] = { -1, -1 };
  std::int64_t present = 0;
  for (std::int64_t j = 0; j < rows; ++j)
  {
    for (std::int64_t i = 0; i < columns; ++i)
    {
      if (std::isfinite(array->GetComponent(i + columns * j, 0)))
      {
        ++present;
        first[0] = std::min(first[0], i);
        last[0] = std::max(last[0], i);
        first[1] = std::min(first[1], j);
        last[1] = std::max(last[1], j);
      }
    }
  }
  if (present == 0)
  {
    throw std::runtime_error("point array '" + name +
      "' is not a number (or infinite) at every pixel: there is no surface to write");
  }
  Rectangle rectangle;
  rectangle.Column = first[0];
  rectangle.Row = first[1];
  rectangle.Size = { last[0] - first[0] + 1, last[1] - first[1] + 1 };
  const std::int64_t wanted = rectangle.Size.Columns * rectangle.Size.Rows;
  if (present < wanted)
  {
    std::ostringstream message;
    message << "the surface has holes: " << wanted - present << " of the " << wanted
            << " pixels of columns " << first[0] << " to " << last[0] << ", rows " << first[1]
            << " to " << last[1] << " have no " << name
            << ". Run RBF Hole Filler on the depth map first and write its output";
    throw std::runtime_error(message.str());
  }
  rectangle.Depths.reserve(wanted);
  for (std::int64_t j = first[1]; j <= last[1]; ++j)
  {
    for (std::int64_t i = first[0]; i <= last[0]; ++i)
    {
      rectangle.Depths.push_back(array->GetComponent(i + columns * j, 0));
    }
  }
  return rectangle;
}

//------------------------------------------------------------------------------
// The parameter at pixel x, linear between those of the pixels.
double AtPixel(const std::vector<double>& parameters, double x)
{
  const double last = static_cast<double>(parameters.size() - 1);
  x = std::clamp(x, 0.0, last);
  const double k = std::min(std::floor(x), last - 1);
  const auto i = static_cast<std::size_t>(k);
  return parameters[i] + (x - k) * (parameters[i + 1] - parameters[i]);
}

//------------------------------------------------------------------------------
// A loop around pixels, in mm, as curves on the surface.
lacuna::CADSurface::Boundary MakeBoundary(const lacuna::SurfaceFit& fit, const lacuna::Loop& loop,
  const lacuna::Vec2& spacing, double tolerance)
{
  std::vector<lacuna::Vec3> points;
  for (const lacuna::Vec2& p : loop)
  {
    points.push_back({ AtPixel(fit.U, p[0] / spacing[0]), AtPixel(fit.V, p[1] / spacing[1]), 0 });
  }
  lacuna::CADSurface::Boundary boundary;
  const lacuna::BSplineCurve outline = lacuna::InterpolateClosed(points, 1);
  const double pixel = std::max(spacing[0], spacing[1]);
  boundary.Parameters = lacuna::FitClosedCurve([&](double t) { return outline.Evaluate(t); },
    outline.GetLast(), std::max(OutlinePrecision, tolerance) / pixel, 8,
    [](std::int64_t count) { return count + count / 8 + 1; }, true);
  boundary.Parameters.Round(6);
  const auto onSurface = [&](double t)
  {
    const lacuna::Vec3 uv = boundary.Parameters.Evaluate(t);
    return fit.Surface.Evaluate(uv[0], uv[1]);
  };
  const double wanted = tolerance > 0 ? tolerance : FinestTolerance;
  const double last = boundary.Parameters.GetLast();
  boundary.Space = lacuna::FitClosedCurve(
    onSurface, last, 0.8 * wanted, static_cast<std::int64_t>(last),
    [](std::int64_t count) { return 2 * count; }, false);
  boundary.Space.Round(std::min(fit.Decimals, 7));
  return boundary;
}

bool Contains(const lacuna::Loop& loop, const lacuna::Vec2& p)
{
  const std::vector<double> crossings = lacuna::FindCrossings({ loop }, p[1]);
  const auto before =
    std::count_if(crossings.begin(), crossings.end(), [&](double x) { return x <= p[0]; });
  return before % 2 == 1;
}
}

//------------------------------------------------------------------------------
lacuna::CADSurface lacuna::CADSurface::FromMap(vtkImageData* image, const lacuna::Matrix4& toFile,
  const lacuna::SurfaceFitOptions& options, lacuna::Execution& execution)
{
  const lacuna::DepthMap map(image);
  vtkDataArray* fitted = image->GetPointData()->GetArray(lacuna::DepthMap::FittedName);
  const int* extent = image->GetExtent();
  const Rectangle rectangle = FindRectangle(fitted ? fitted : map.GetDepth(),
    std::int64_t{ extent[1] } - extent[0] + 1, std::int64_t{ extent[3] } - extent[2] + 1);
  const double column = static_cast<double>(extent[0] + rectangle.Column);
  const double row = static_cast<double>(extent[2] + rectangle.Row);

  lacuna::CADSurface result;
  result.Column = rectangle.Column;
  result.Row = rectangle.Row;
  if (!map.IsPerspective())
  {
    result.Fit = lacuna::FitHeights(execution, rectangle.Size, rectangle.Depths,
      toFile * map.GetImageToWorld() * lacuna::Matrix4::Translation({ column, row, 0 }), options);
  }
  else
  {
    std::vector<lacuna::Vec3> points;
    points.reserve(rectangle.Depths.size());
    for (std::int64_t j = 0; j < rectangle.Size.Rows; ++j)
    {
      for (std::int64_t i = 0; i < rectangle.Size.Columns; ++i)
      {
        points.push_back(toFile.Point(map.GetPoint(column + static_cast<double>(i),
          row + static_cast<double>(j), rectangle.Depths[points.size()])));
      }
    }
    result.Fit = lacuna::FitPoints(execution, rectangle.Size, points, options);
  }
  result.Name = fitted ? "Fitted surface" : "Depth map surface";
  std::ostringstream where;
  where.imbue(std::locale::classic());
  where << "From a depth map, columns " << column << " to "
        << column + static_cast<double>(rectangle.Size.Columns - 1) << ", rows " << row << " to "
        << row + static_cast<double>(rectangle.Size.Rows - 1)
        << ". u runs along the columns, v along the rows; dS/du x dS/dv points away from the "
           "viewer.";
  result.Description = where.str();
  return result;
}

//------------------------------------------------------------------------------
lacuna::CADSurface lacuna::CADSurface::FromGrid(vtkStructuredGrid* grid,
  const lacuna::Matrix4& toFile, const lacuna::SurfaceFitOptions& options,
  lacuna::Execution& execution)
{
  lacuna::GridLayer layer(grid);
  for (lacuna::Vec3& p : layer.Points)
  {
    p = toFile.Point(p);
  }
  lacuna::CADSurface result;
  lacuna::CheckRegular(layer.Size, layer.Points);
  result.Fit = lacuna::FitPoints(execution, layer.Size, layer.Points, options);
  result.Name = "Structured surface";
  result.Description =
    "From a structured grid. u runs along its first dimension, v along its second.";
  return result;
}

//------------------------------------------------------------------------------
void lacuna::CADSurface::FindOutlines(vtkImageData* image, const lacuna::SurfaceFitOptions& options)
{
  vtkDataArray* filled = image->GetPointData()->GetArray(lacuna::DepthMap::FilledMaskName);
  if (!filled || filled->GetNumberOfComponents() != 1)
  {
    throw std::runtime_error(std::string("the map has no point array '") +
      lacuna::DepthMap::FilledMaskName +
      "' with one component, which tells where the defect is; write the output of RBF Hole Filler");
  }
  const lacuna::GridSize size{ static_cast<std::int64_t>(this->Fit.U.size()),
    static_cast<std::int64_t>(this->Fit.V.size()) };
  const lacuna::Vec2 spacing = lacuna::DepthMap(image).GetPixelSpacing();
  const std::int64_t columns = image->GetDimensions()[0];
  std::vector<unsigned char> mask;
  for (std::int64_t j = 0; j < size.Rows; ++j)
  {
    for (std::int64_t i = 0; i < size.Columns; ++i)
    {
      mask.push_back(
        filled->GetComponent(this->Column + i + columns * (this->Row + j), 0) != 0 ? 1 : 0);
    }
  }
  constexpr std::size_t speck = 8; // corners of a contour around a pixel or two
  const double pixel = std::sqrt(spacing[0] * spacing[1]);
  std::vector<lacuna::Loop> outer;
  std::vector<lacuna::Loop> islands;
  for (const lacuna::Loop& contour : lacuna::FindDefectContours(size, spacing, mask))
  {
    if (contour.size() >= speck)
    {
      (lacuna::SignedArea(contour) > 0 ? outer : islands)
        .push_back(lacuna::SmoothStaircase(contour, pixel));
    }
  }
  for (const lacuna::Loop& loop : outer)
  {
    this->Pieces.push_back({ MakeBoundary(this->Fit, loop, spacing, options.Tolerance) });
  }
  for (const lacuna::Loop& island : islands)
  {
    // it lies in the smallest piece around it; a piece may lie in an island of another
    std::size_t home = outer.size();
    for (std::size_t k = 0; k < outer.size(); ++k)
    {
      if (Contains(outer[k], island.front()) &&
        (home == outer.size() || lacuna::SignedArea(outer[k]) < lacuna::SignedArea(outer[home])))
      {
        home = k;
      }
    }
    if (home < outer.size())
    {
      this->Pieces[home].push_back(MakeBoundary(this->Fit, island, spacing, options.Tolerance));
    }
  }
}
