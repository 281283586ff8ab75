// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Grey levels of a part of a warped image. Not a part of the module's interface.
#ifndef lacunaWarpedPart_h
#define lacunaWarpedPart_h

#include "vtkDataArray.h"
#include "vtkNew.h"
#include "vtkSmartPointer.h"

#include <array>
#include <memory>
#include <vector>

class vtkCharArray;
class vtkImageData;
class vtkImageInterpolator;

namespace lacuna
{
class WarpedPart
{
public:
  /// First and last voxel along each axis, counted from the image's first one.
  using Box = std::array<int, 6>;

  /// scalars: those of the image that shall be warped; interpolation: of vtkLacunaRBFImageWarp.
  WarpedPart(vtkImageData* image, vtkDataArray* scalars, int interpolation, double outsideValue,
    const Box& part);
  ~WarpedPart();

  /// Sets a voxel to the grey level at a place of the input, an index; tuple is room for one.
  void Set(const int* voxel, double* index, std::vector<double>& tuple);

  int GetNumberOfComponents() const { return this->Components; }
  /// Whether voxels may be set by several threads.
  bool IsParallel() const { return this->Warped->GetDataType() != VTK_BIT; }
  vtkDataArray* GetWarped() const { return this->Warped; }
  vtkDataArray* GetValid() const;

private:
  class ValidPlaces;

  double OutsideValue;
  Box Part;
  std::array<vtkIdType, 3> Stride{};
  int Components;
  double Low;
  double High;
  bool Integral;
  vtkSmartPointer<vtkDataArray> Warped;
  vtkNew<vtkCharArray> Valid;
  vtkNew<vtkImageInterpolator> Interpolator;
  std::unique_ptr<const ValidPlaces> Places;
  vtkSmartPointer<vtkDataArray>
    Copied; ///< from which tuples are copied instead; null: they are not
};
}
#endif
