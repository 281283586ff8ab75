// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaDefectMarks.h"

#include "lacunaArrays.h"
#include "lacunaControllerRanks.h"
#include "lacunaDepthMap.h"
#include "lacunaExecution.h"
#include "lacunaImplicitRegion.h"
#include "vtkDataArray.h"
#include "vtkDataSet.h"
#include "vtkDoubleArray.h"
#include "vtkExtractSelection.h"
#include "vtkImageData.h"
#include "vtkImplicitFunction.h"
#include "vtkImplicitSelectionLoop.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkSelection.h"
#include "vtkSelectionNode.h"
#include "vtkSmartPointer.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iomanip>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <vector>

namespace
{
using lacuna::MapMask;

// Pairs of edge neighbours that are both in mask.
std::size_t CountNeighbours(const lacuna::MapGrid& grid, const MapMask& mask)
{
  const std::size_t width = grid.Width;
  std::size_t count = 0;
  for (std::size_t pixel = 0; pixel < mask.size(); ++pixel)
  {
    const bool right = (pixel + 1) % width != 0 && mask[pixel + 1];
    const bool below = pixel + width < mask.size() && mask[pixel + width];
    count += mask[pixel] ? (right ? 1 : 0) + (below ? 1 : 0) : 0;
  }
  return count;
}

// Pixels whose surface point is in region, or is hidden by it from the viewer.
class RegionMarker
{
public:
  RegionMarker(
    const lacuna::DepthMap& contract, const lacuna::MarkedMap& input, vtkImplicitFunction* region)
    : Contract(contract)
    , Input(input)
    , Region(region)
    , Marked(input.Grid.GetSize(), 0)
  {
  }

  MapMask Run(lacuna::Execution& execution)
  {
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for (std::size_t i = 0; i < this->Marked.size(); ++i)
    {
      if (this->Input.Valid[i])
      {
        low = std::min(low, this->Input.Depth[i]);
        high = std::max(high, this->Input.Depth[i]);
      }
    }
    this->Try([&](std::size_t i) { return this->Input.Valid[i] != 0; },
      [&](std::size_t i) { return this->Input.Depth[i]; });
    constexpr int samples = lacuna::DefectMarks::RegionSamples;
    for (int k = 0; k < samples; ++k)
    {
      const double depth = low + (high - low) * k / (samples - 1);
      this->Try([&](std::size_t i)
        { return !this->Input.Valid[i] || depth < this->Input.Depth[i]; },
        [&](std::size_t) { return depth; });
      execution.Report(static_cast<double>(k + 1) / samples);
    }
    return this->Marked;
  }

private:
  // Marks the pixels chosen whose points at the given depths are in the region.
  template <class Chosen, class Depth>
  void Try(const Chosen& chosen, const Depth& depth)
  {
    this->Pixels.clear();
    for (std::size_t i = 0; i < this->Marked.size(); ++i)
    {
      if (!this->Marked[i] && chosen(i))
      {
        this->Pixels.push_back(i);
      }
    }
    const auto count = static_cast<vtkIdType>(this->Pixels.size());
    const lacuna::MapGrid& grid = this->Input.Grid;
    this->Points->SetNumberOfComponents(3);
    lacuna::Arrays::SetNumberOfTuples(this->Points, count);
    lacuna::Arrays::SetNumberOfTuples(this->Values, count);
    for (vtkIdType k = 0; k < count; ++k)
    {
      const std::size_t i = this->Pixels[k];
      const lacuna::Vec3 point = this->Contract.GetPoint(
        static_cast<double>(grid.GetColumn(i)), static_cast<double>(grid.GetRow(i)), depth(i));
      this->Points->SetTypedTuple(k, point.data());
    }
    this->Region->FunctionValue(this->Points, this->Values);
    for (vtkIdType k = 0; k < count; ++k)
    {
      this->Marked[this->Pixels[k]] = this->Values->GetValue(k) <= 0;
    }
  }

  const lacuna::DepthMap& Contract;
  const lacuna::MarkedMap& Input;
  vtkImplicitFunction* Region;
  MapMask Marked;
  std::vector<std::size_t> Pixels;
  vtkNew<vtkDoubleArray> Points;
  vtkNew<vtkDoubleArray> Values;
};

// A loop, in the axes of the map.
std::vector<lacuna::Vec2> GetPolygon(
  const lacuna::DepthMap& contract, const lacuna::MapGrid& grid, vtkPoints* loop)
{
  const lacuna::Matrix4 toPixels = contract.GetImageToWorld().Inverse();
  std::vector<lacuna::Vec2> polygon;
  for (vtkIdType i = 0; loop && i < loop->GetNumberOfPoints(); ++i)
  {
    lacuna::Vec3 p;
    loop->GetPoint(i, p.data());
    if (!lacuna::IsFinite(p))
    {
      throw std::runtime_error(
        "DefectRegion: a point of the loop has a coordinate that is not a finite number");
    }
    p = toPixels.Point(p);
    polygon.push_back({ p[0] * grid.Spacing[0], p[1] * grid.Spacing[1] });
  }
  if (polygon.size() < 3)
  {
    throw std::runtime_error("DefectRegion: the loop has " + std::to_string(polygon.size()) +
      " different points, and it takes at least 3 to enclose the defect");
  }
  return polygon;
}

// Numbers of points count in each rank's part of what was shown, and VTK leaves out those of others.
void CheckRanks(vtkSelection* selection)
{
  for (unsigned int i = 0; selection && i < selection->GetNumberOfNodes(); ++i)
  {
    if (lacuna::ControllerRanks().GetNumber() > 1 &&
      selection->GetNode(i)->GetContentType() == vtkSelectionNode::INDICES)
    {
      throw std::runtime_error("Selection has numbers of points, which count in each rank's own "
                               "part of what was shown, and those "
                               "of the other ranks are lost; mark the defect by DefectRegion or "
                               "DefectArray, select by values of "
                               "PixelId, or run one rank");
    }
  }
}

// What a selection selects, as a data set of the selected points.
vtkSmartPointer<vtkDataSet> Extract(vtkDataSet* data, vtkSelection* selection)
{
  vtkNew<vtkExtractSelection> extract;
  extract->SetInputData(0, data);
  extract->SetInputData(1, selection);
  extract->Update();
  return vtkDataSet::SafeDownCast(extract->GetOutputDataObject(0));
}
}

namespace lacuna::DefectMarks
{
//------------------------------------------------------------------------------
MapMask FromArray(vtkImageData* map, const std::string& name, const char* property)
{
  vtkPointData* points = map->GetPointData();
  vtkDataArray* array = points->GetArray(name.c_str());
  if (!array || array->GetNumberOfComponents() != 1)
  {
    std::ostringstream message;
    message << property << ": the map has no point array '" << name
            << "' with one component; it has";
    for (int i = 0; i < points->GetNumberOfArrays(); ++i)
    {
      message << (i ? ", '" : " '") << points->GetArrayName(i) << "'";
    }
    throw std::runtime_error(message.str());
  }
  MapMask mask(static_cast<std::size_t>(array->GetNumberOfTuples()));
  for (std::size_t i = 0; i < mask.size(); ++i)
  {
    const double value = array->GetComponent(static_cast<vtkIdType>(i), 0);
    mask[i] = value != 0 && !std::isnan(value);
  }
  return mask;
}

//------------------------------------------------------------------------------
MapMask FromRegion(lacuna::Execution& execution, const lacuna::DepthMap& contract,
  const lacuna::MarkedMap& map, vtkImplicitFunction* region)
{
  lacuna::ImplicitRegion::Check(region, "DefectRegion");
  auto* loop = vtkImplicitSelectionLoop::SafeDownCast(region);
  if (loop && loop->GetAutomaticNormalGeneration())
  {
    return lacuna::FindEnclosed(map.Grid, GetPolygon(contract, map.Grid, loop->GetLoop()));
  }
  return RegionMarker(contract, map, region).Run(execution);
}

//------------------------------------------------------------------------------
std::string DescribeMiss(
  const lacuna::DepthMap& contract, const lacuna::MarkedMap& map, vtkImplicitFunction* region)
{
  if (vtkImplicitSelectionLoop::SafeDownCast(region))
  {
    return {};
  }
  double least = std::numeric_limits<double>::infinity();
  lacuna::Vec3 surface{};
  for (std::size_t i = 0; i < map.Valid.size(); ++i)
  {
    if (map.Valid[i])
    {
      lacuna::Vec3 point = contract.GetPoint(static_cast<double>(map.Grid.GetColumn(i)),
        static_cast<double>(map.Grid.GetRow(i)), map.Depth[i]);
      const double value = region->FunctionValue(point.data());
      if (value < least)
      {
        least = value;
        surface = point;
      }
    }
  }
  // Newton's way along the gradient to where the function is 0
  lacuna::Vec3 edge = surface;
  for (int step = 0; step < 50 && std::isfinite(least); ++step)
  {
    lacuna::Vec3 gradient{};
    region->FunctionGradient(edge.data(), gradient.data());
    const double steepness = lacuna::Dot(gradient, gradient);
    const double value = region->FunctionValue(edge.data());
    if (!(steepness > 0) || !std::isfinite(value))
    {
      return {};
    }
    const lacuna::Vec3 towards = (value / steepness) * gradient;
    edge = edge - towards;
    if (lacuna::Norm(towards) < 1e-3)
    {
      const lacuna::Vec3 way = surface - edge;
      std::ostringstream text;
      text << std::fixed << std::setprecision(1) << "DefectRegion is " << lacuna::Norm(way)
           << " mm away from the surface: move it by at least (" << way[0] << ", " << way[1] << ", "
           << way[2] << ") mm";
      return text.str();
    }
  }
  return {};
}

//------------------------------------------------------------------------------
MapMask FromSelection(
  vtkImageData* map, const lacuna::MapGrid& grid, vtkDataSet* surface, vtkSelection* selection)
{
  CheckRanks(selection);
  vtkSmartPointer<vtkDataSet> selected = surface;
  if (selection)
  {
    selected = Extract(surface ? surface : map, selection);
  }
  MapMask mask(grid.GetSize(), 0);
  if (!selected || selected->GetNumberOfPoints() == 0)
  {
    return mask;
  }
  vtkPointData* points = selected->GetPointData();
  vtkDataArray* ids = nullptr;
  if (surface)
  {
    ids = vtkDataArray::SafeDownCast(points->GetPedigreeIds());
    ids = ids ? ids : points->GetArray(lacuna::DepthMap::PixelIdName);
  }
  else
  {
    ids = points->GetArray("vtkOriginalPointIds");
  }
  if (!ids)
  {
    throw std::runtime_error(std::string("Surface has no point array '") +
      lacuna::DepthMap::PixelIdName +
      "' that says which pixels its points are; give the Depth Map Surface on which the selection "
      "was made, or points extracted from it");
  }
  for (vtkIdType i = 0; i < ids->GetNumberOfTuples(); ++i)
  {
    const double id = ids->GetTuple1(i);
    if (!(id >= 0 && id < static_cast<double>(mask.size())))
    {
      std::ostringstream message;
      message << "the selection has pixel " << id << ", and the depth map has only " << mask.size()
              << ": Surface was made of another map";
      throw std::runtime_error(message.str());
    }
    mask[static_cast<std::size_t>(id)] = 1;
  }
  Merge(mask, lacuna::FindInteriorHoles(grid, mask));
  return mask;
}

//------------------------------------------------------------------------------
std::string DescribeRuns(const MapMask& mask)
{
  std::string text;
  const auto end = mask.end();
  for (auto first = std::find(mask.begin(), end, 1); first != end;)
  {
    const auto stop = std::find(first, end, 0);
    text += (text.empty() ? "" : ",") + std::to_string(first - mask.begin());
    text += stop - first > 1 ? "-" + std::to_string(stop - 1 - mask.begin()) : "";
    first = std::find(stop, end, 1);
  }
  return text;
}

//------------------------------------------------------------------------------
std::vector<int> GetExtent(const lacuna::MapGrid& grid, const MapMask& mask)
{
  std::vector<int> extent;
  for (std::size_t i = 0; i < mask.size(); ++i)
  {
    if (mask[i])
    {
      const auto width = static_cast<std::size_t>(grid.Width);
      const int column = grid.FirstColumn + static_cast<int>(i % width);
      const int row = grid.FirstRow + static_cast<int>(i / width);
      extent = extent.empty() ? std::vector<int>{ column, column, row, row }
                              : std::vector<int>{ std::min(extent[0], column),
                                  std::max(extent[1], column), extent[2], row };
    }
  }
  return extent;
}

//------------------------------------------------------------------------------
bool MayBeOfSurface(const lacuna::MapGrid& grid, const MapMask& valid, const MapMask& selected)
{
  MapMask other(selected.size(), 0);
  std::size_t point = 0;
  for (std::size_t pixel = 0; pixel < valid.size(); ++pixel)
  {
    if (valid[pixel])
    {
      other[pixel] = selected[point++];
    }
  }
  const auto beyond = selected.begin() + static_cast<std::ptrdiff_t>(point);
  return std::find(beyond, selected.end(), 1) == selected.end() && other != selected &&
    CountNeighbours(grid, other) >= CountNeighbours(grid, selected);
}

//------------------------------------------------------------------------------
void Merge(MapMask& mask, const MapMask& other)
{
  std::transform(mask.begin(), mask.end(), other.begin(), mask.begin(),
    [](unsigned char a, unsigned char b) { return a || b; });
}
}
