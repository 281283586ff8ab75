// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Polydata of tracked slices: which of them, their lattices, outlines and arrays.
#ifndef lacunaSlicePlaneBuilder_h
#define lacunaSlicePlaneBuilder_h

#include "lacunaPoseJudge.h"
#include "lacunaSliceLattice.h"
#include "lacunaSliceMotion.h"
#include "lacunaTrackedSlices.h"
#include "vtkSmartPointer.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

class vtkDataArray;
class vtkImageData;
namespace lacuna
{
class AlgorithmExecution;
}
class vtkPolyData;

namespace lacuna
{
/// Not a part of the module's interface; the options are the filter's properties.
class SlicePlaneBuilder
{
public:
  enum InvalidSliceChoices
  {
    LeaveOut = 0,
    Outline = 1,
    Show = 2
  };

  struct Options
  {
    int Stride = 1;
    TrackerAccuracy Accuracy;
    double SpeedLimit = 0; ///< mm/s, 0 = none
    bool OutlineOnly = false;
    int InvalidSlices = LeaveOut;
    bool KeepOutliers = false;
    int MaximumNumberOfPoints = 0;
  };

  /// stack has all columns and rows of the whole extent, and the slices first to last (last <
  /// first: none) that are shown at all. It must outlive the builder. Throws std::runtime_error
  /// with a text for the user when it is not what lacunaTrackedSlices.h wants, and when no slice
  /// of the whole extent is to be shown.
  SlicePlaneBuilder(
    vtkImageData* stack, const int whole[6], int first, int last, const Options& options);

  bool HasTimes() const { return !this->Speeds.empty(); }
  bool HasCalibration() const { return this->Calibrated; }
  int GetPixelStep() const { return this->Lattice.GetStep(); }

  /// Numbers in the sweep of the slices that are shown.
  std::vector<vtkIdType> GetShown() const;
  /// mm/s, NaN where it is not known; only with times.
  double GetSpeed(vtkIdType slice) const { return this->Speeds[slice]; }
  bool IsTooFast(vtkIdType slice) const;
  /// A sentence for each slice from first to last that is not shown because of its pose.
  const std::vector<std::string>& GetLeftOut() const { return this->LeftOut; }
  /// Whether ImageToProbe is there, but gives no errors that are numbers.
  bool HasBadCalibration() const { return this->BadCalibration; }

  /// Fills points, cells and arrays; output is empty before.
  void Build(vtkPolyData* output, AlgorithmExecution& execution);

private:
  struct ShownSlice
  {
    int K;                // index in the stack
    vtkIdType Number;     // in the sweep
    bool IsOutline;       // else a lattice
    bool IsBlank;         // an outline without values
    vtkIdType FirstPoint; // in the output
    vtkIdType FirstCell;
  };

  void ReadSweep();
  bool MayShow(vtkIdType slice) const;
  void ChooseSlices(int first, int last);
  vtkIdType GetCellsPerLattice() const;
  Vec3 GetPixel(int i, int j) const;
  std::array<Vec3, 4> GetCorners() const;
  void FillSlice(const ShownSlice& slice, float* points, float* levels, float* errors) const;
  template <class Array>
  void MakePolygons(vtkPolyData* output, AlgorithmExecution& execution) const;
  void MakeCells(vtkPolyData* output, AlgorithmExecution& execution) const;
  void AddCellData(vtkPolyData* output) const;

  Options Settings;
  vtkImageData* Stack;
  TrackedSlices Tracked;
  vtkSmartPointer<vtkDataArray> GreyLevels; // in one piece of memory
  std::array<int, 6> Whole;
  PoseJudge::Sweep Sweep;
  std::vector<std::string> LeftOut;
  std::vector<double> Speeds;
  bool Calibrated = false;
  bool BadCalibration = false;
  Matrix4 ImageToProbe;
  SliceLattice Lattice;
  std::vector<ShownSlice> Shown;
  vtkIdType NumberOfPoints = 0;
  vtkIdType NumberOfCells = 0;
};
}
#endif
