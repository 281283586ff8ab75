// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The ways to mark pixels of a depth map, for vtkLacunaRBFHoleFiller. Errors are std::runtime_error
/// with a sentence that says what would be right.
#ifndef lacunaDefectMarks_h
#define lacunaDefectMarks_h

#include "lacunaSupportSelection.h"

#include <string>
#include <vector>

class vtkDataSet;
class vtkImageData;
class vtkImplicitFunction;
namespace lacuna
{
class DepthMap;
}
class vtkSelection;

namespace lacuna
{
class Execution;
}

namespace lacuna::DefectMarks
{
/// Points of a ray that are tried against a region.
constexpr int RegionSamples = 64;

/// Where a point array of one component is neither 0 nor NaN. property names it in messages.
MapMask FromArray(vtkImageData* map, const std::string& name, const char* property);

/// Pixels whose surface point is in region (where it is <= 0), or is hidden by it from the viewer. Of
/// a vtkImplicitSelectionLoop with automatic normal: what the loop encloses as the map sees it.
MapMask FromRegion(Execution& execution, const DepthMap& contract, const MarkedMap& map,
  vtkImplicitFunction* region);

/// How far a region that marks nothing is from the surface, and how to move it there, a sentence in
/// world coordinates; empty where that is not known, as of a loop.
std::string DescribeMiss(
  const DepthMap& contract, const MarkedMap& map, vtkImplicitFunction* region);

/// Selected pixels, and those that they enclose. surface is a Depth Map Surface of the map, or part
/// of one, whose pedigree ids (or array PixelId) say which pixels its points are; with nullptr the
/// selection is one of the map's own points. Without selection all points of surface are selected.
MapMask FromSelection(
  vtkImageData* map, const MapGrid& grid, vtkDataSet* surface, vtkSelection* selection);

/// Numbers of the pixels that are marked, "3-17,20,25-29", for provenance.
std::string DescribeRuns(const MapMask& mask);

/// First and last column, first and last row of what is marked; empty when nothing is.
std::vector<int> GetExtent(const MapGrid& grid, const MapMask& mask);

/// Whether a selection that was read as the map's own points, selected, may have been made on its Depth
/// Map Surface, whose points are the valid pixels one after the other: whether read so it marks other
/// pixels and these hang together at least as well.
bool MayBeOfSurface(const MapGrid& grid, const MapMask& valid, const MapMask& selected);

void Merge(MapMask& mask, const MapMask& other);
}
#endif
