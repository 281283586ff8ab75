// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What a vtkLacunaSweptVolume has to do: which slices go into which grid.
#ifndef lacunaSweptVolumePlan_h
#define lacunaSweptVolumePlan_h

#include "lacunaMatrix4.h"
#include "lacunaSliceFan.h"
#include "lacunaSliceImages.h"
#include "lacunaSweptVolume.h"
#include "lacunaVolumeGrid.h"

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace lacuna
{
class Ports;
}
class vtkLacunaSweptVolume;

namespace lacuna
{
/// Fans that were found in the inputs, so that they are searched for only when something changes.
struct SweptVolumeFans
{
  /// The properties that matter, and each input's data object and its modification time.
  std::vector<std::intptr_t> Key;
  /// Of each input that is not empty; none where a replay has not shown enough of it.
  std::vector<std::optional<SliceFan>> Found;
};

/// Made anew for each request, from the filter's properties and inputs, which must outlive it. Not
/// a part of the module's interface.
class SweptVolumePlan
{
public:
  /// ports: of filter. fans: kept from plan to plan. Throws std::exception with a text for the
  /// user.
  SweptVolumePlan(vtkLacunaSweptVolume* filter, const Ports& ports, SweptVolumeFans& fans);

  /// True when there is nothing in the inputs.
  bool IsEmpty() const { return this->Sweeps.empty(); }
  /// True when pixels of an input are not in memory.
  bool HasStreams() const;

  std::vector<SliceImages> Sweeps; ///< poses lead to the output's frame
  /// Voxel (0, 0, 0) in the reference frame, mm.
  Vec3 GetOrigin() const { return this->FrameToReference.Point(this->Grid.Origin); }
  /// As vtkImageData::SetDirectionMatrix takes it.
  std::array<double, 9> GetDirection() const;

  std::vector<std::string> LeftOut; ///< a sentence for each slice with a bad pose
  Matrix4 FrameToReference;         ///< a rotation: the axes of the output
  VolumeGrid Grid;                  ///< in the output's frame
  SweptVolume::Options Options;
  int ScalarType; ///< of Intensity, VTK_FLOAT, ...
  std::int64_t BytesPerVoxel = 0;
  /// An input has time steps: its slices come one after the other, and the grid is that of all of
  /// the sweep from the beginning.
  bool IsReplay = false;
  /// A replay has not shown all of its slices yet, or some are still being taken.
  bool IsMoreToCome = false;

private:
  void ReadSweeps(vtkLacunaSweptVolume* filter, const Ports& ports);
  void ApplyFans(vtkLacunaSweptVolume* filter, SweptVolumeFans& fans);
  void ChooseOptions(vtkLacunaSweptVolume* filter);
  void ChooseFrame(vtkLacunaSweptVolume* filter);
  std::vector<SliceImage> GetAllSlices() const;
  void ChooseGrid(vtkLacunaSweptVolume* filter);

  std::vector<SliceImage> PlacedSlices; ///< whose windows the grid holds
};
}
#endif
