// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A sweep that grows, as tracked slices (see lacunaTrackedSlices.h).
#ifndef lacunaGrowingStack_h
#define lacunaGrowingStack_h

#include "lacunaAcquiredSlice.h"
#include "vtkSmartPointer.h"
#include "vtkType.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

class vtkDataArray;
class vtkImageData;

namespace lacuna
{
/// What has been appended never moves or changes in memory that someone looks at: views share it
/// without a copy, and keep it for as long as they live. Memory that is reserved and not used costs
/// nothing on systems that give it when it is touched.
class GrowingArray
{
public:
  /// type: VTK_DOUBLE ...
  GrowingArray(const char* name, int type, int components);
  ~GrowingArray();
  GrowingArray(const GrowingArray&) = delete;
  void operator=(const GrowingArray&) = delete;

  /// Makes room for so many tuples in one piece; otherwise room is made as it is needed, half as
  /// much again each time. Throws std::bad_alloc.
  void Reserve(vtkIdType tuples);
  /// Makes room for so many tuples more, in that way: Append of them does not throw. Throws
  /// std::bad_alloc.
  void MakeRoom(vtkIdType tuples);
  /// Adds tuples, whose values lie one behind the other. Throws std::bad_alloc.
  void Append(const void* values, vtkIdType tuples = 1);
  vtkIdType GetNumberOfTuples() const { return this->Tuples; }
  const void* GetTuple(vtkIdType i) const;
  /// An array of all tuples that there are now.
  vtkSmartPointer<vtkDataArray> MakeView() const;

private:
  std::string Name;
  int Type;
  int Components;
  std::size_t TupleSize; ///< bytes
  vtkIdType Tuples = 0;
  vtkIdType Room = 0;
  std::shared_ptr<char> Memory;
};

/// Making an output costs the same however many slices there are: it shares their memory, and knows
/// the range of their pixels, for which all would have to be looked at for each new slice.
class GrowingStack
{
public:
  GrowingStack();

  /// Slices of this frame follow, in at most so many bytes of pixels, for which room is reserved.
  /// Throws std::bad_alloc.
  GrowingStack(const SweepFrame& frame, std::int64_t bytes);

  /// What is shown before the first frame, of 768 x 576 pixels and flagged: black over a grey wedge,
  /// so that colours are chosen for all levels.
  static std::unique_ptr<GrowingStack> MakeBlank();

  /// Takes the slice as a whole or, throwing std::bad_alloc, nothing of it.
  void Append(const AcquiredSlice& slice);
  /// Takes the calibration of a frame for all slices, those that are there too; or, throwing
  /// std::bad_alloc, for none. Slices whose pixels have another size by the video are flagged.
  void Calibrate(const SweepFrame& frame);

  vtkIdType GetNumberOfSlices() const { return this->Timestamps.GetNumberOfTuples(); }
  const SweepFrame& GetFrame() const { return this->Frame; }
  /// Columns and rows, and where they begin in the whole frame: the stack's origin.
  const std::array<int, 4>& GetWindow() const { return this->Frame.Window; }
  /// Sets the output's geometry, scalars and field data.
  void Fill(vtkImageData* output) const;

private:
  void AppendPose();

  SweepFrame Frame;
  std::unique_ptr<GrowingArray> Pixels;
  std::uint8_t Darkest = 255;
  std::uint8_t Brightest = 0;
  std::unique_ptr<GrowingArray> ImageToReference; ///< null while not calibrated
  std::unique_ptr<GrowingArray> TrackerToReference;
  GrowingArray ProbeToTracker;
  GrowingArray Timestamps;
  GrowingArray GivenStatus; ///< of the slices, before their pixels are compared
  GrowingArray PixelSpacings;
  bool HasPixelSpacings = false;
  std::unique_ptr<GrowingArray> Status;
  GrowingArray FrameNumbers;
  GrowingArray Residuals;
  GrowingArray Speeds;
};
}
#endif
