// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Scans of calibration phantoms with a probe whose image lies in a known place, for tests of
/// filters that calibrate.
#ifndef lacunaTestScans_h
#define lacunaTestScans_h

#include "lacunaCheck.h"
#include "lacunaFieldData.h"
#include "lacunaMatrix4.h"
#include "lacunaTestTables.h"
#include "lacunaTrackedSlices.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"
#include "vtkTable.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace lacunaTestScans
{
using lacuna::Matrix4;
using lacuna::Vec3;

constexpr int Width = 120, Height = 90;
constexpr double ColumnSpacing = 0.5, RowSpacing = 0.6; // mm
const double Degree = std::acos(-1.0) / 180;

// The receiver is some way off the image and askew; nothing is symmetric.
inline Matrix4 ScanToProbe()
{
  return Matrix4::Translation({ 25, -60, 110 }) * Matrix4::Rotation({ 1, 2, -0.5 }, 70 * Degree);
}
inline Matrix4 ImageToProbe()
{
  return ScanToProbe() * Matrix4::Scaling({ ColumnSpacing, RowSpacing, 1 });
}
inline Matrix4 ProbeToTracker(const Matrix4& scanToPhantom)
{
  const Matrix4 phantomToTracker =
    Matrix4::Translation({ 200, -80, 150 }) * Matrix4::Rotation({ 0.3, -1, 0.4 }, 130 * Degree);
  return phantomToTracker * scanToPhantom * ScanToProbe().Inverse();
}

// Different in every number, from -1 to 1.
inline double Wave(int i, int k)
{
  return std::sin(1.7 * i + 2.3 * k + 0.13 * i * k + 0.5);
}

// Looking down on the floor z = 0 of the phantom, turned by up to so many degrees each way.
inline Matrix4 LookingDown(int i, double degrees)
{
  return Matrix4::Rotation({ 0, 0, 1 }, 180 * Degree * Wave(i, 1)) *
    Matrix4::Rotation({ 1, 0, 0 }, degrees * Degree * Wave(i, 2)) *
    Matrix4::Rotation({ 0, 1, 0 }, degrees * Degree * Wave(i, 3)) *
    Matrix4::Rotation({ 1, 0, 0 }, -90 * Degree);
}

// Slices with poses ProbeToTracker; 8-bit pixels, all 0.
inline vtkSmartPointer<vtkImageData> MakeScan(
  const std::vector<Matrix4>& poses, const std::vector<double>& times = {})
{
  auto stack = vtkSmartPointer<vtkImageData>::New();
  const auto count = static_cast<int>(poses.size());
  stack->SetDimensions(Width, Height, count);
  stack->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
  std::fill_n(static_cast<unsigned char*>(stack->GetScalarPointer()), stack->GetNumberOfPoints(),
    static_cast<unsigned char>(0));
  std::vector<int> frames;
  for (int i = 0; i < count; ++i)
  {
    frames.push_back(i);
  }
  lacuna::TrackedSlices::Write(
    stack, {}, times, std::vector<unsigned char>(poses.size(), 0), frames);
  lacuna::FieldData::SetMatrices(stack, "ProbeToTracker", poses);
  return stack;
}

// The floor as a bright band in slice k.
inline void DrawFloor(vtkImageData* stack, int k, const Matrix4& scanToPhantom)
{
  auto* pixels = static_cast<unsigned char*>(stack->GetScalarPointer(0, 0, k));
  for (int row = 0; row < Height; ++row)
  {
    for (int column = 0; column < Width; ++column)
    {
      const double height = scanToPhantom.Point({ ColumnSpacing * column, RowSpacing * row, 0 })[2];
      const double noise = 10 + 10 * std::sin(12.9898 * column + 78.233 * row + 37.7 * k);
      *pixels++ =
        static_cast<unsigned char>(std::min(255.0, noise + 225 * std::exp(-height * height)));
    }
  }
}

// A copy with something wrong.
template <class Data, class Spoil>
vtkSmartPointer<Data> Spoilt(Data* data, const Spoil& spoil)
{
  auto copy = vtkSmartPointer<Data>::New();
  copy->DeepCopy(data);
  spoil(copy.Get());
  return copy;
}

// Takes the last slices or tuples off.
inline void Shorten(vtkImageData* stack, const char* array)
{
  vtkAbstractArray* values = stack->GetFieldData()->GetAbstractArray(array);
  values->SetNumberOfTuples(values->GetNumberOfTuples() - 1);
}
}
#endif
