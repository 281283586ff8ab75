// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Small stacks of tracked slices of known grey levels, for tests of filters that take them.
#ifndef lacunaTestStacks_h
#define lacunaTestStacks_h

#include "lacunaCheck.h"
#include "lacunaTrackedSlices.h"
#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkLacunaSweptVolume.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"

#include <functional>
#include <string>
#include <vector>

namespace lacunaTestStacks
{
inline bool Contains(const std::string& text, const std::string& part)
{
  return text.find(part) != std::string::npos;
}

// Poses of slices of 0.5 mm pixels, 1 mm apart along z.
inline std::vector<lacuna::Matrix4> MakePoses(int count, double start = 0)
{
  std::vector<lacuna::Matrix4> poses;
  for (int n = 0; n < count; ++n)
  {
    poses.push_back(lacuna::Matrix4::Translation({ 10, 20, start + n }) *
      lacuna::Matrix4::Scaling({ 0.5, 0.5, 1 }));
  }
  return poses;
}

// Columns 0..12, rows 0..8; grey level = column + 2 row + 10 slice.
inline vtkSmartPointer<vtkImageData> MakeStack(const std::vector<lacuna::Matrix4>& poses,
  int type = VTK_UNSIGNED_CHAR, const std::vector<unsigned char>& status = {})
{
  const auto count = static_cast<int>(poses.size());
  auto stack = vtkSmartPointer<vtkImageData>::New();
  stack->SetDimensions(13, 9, count);
  stack->AllocateScalars(type, 1);
  for (int k = 0; k < count; ++k)
  {
    for (int j = 0; j < 9; ++j)
    {
      for (int i = 0; i < 13; ++i)
      {
        stack->SetScalarComponentFromDouble(i, j, k, 0, i + 2 * j + 10 * k);
      }
    }
  }
  std::vector<double> times;
  std::vector<int> frames;
  for (int k = 0; k < count; ++k)
  {
    times.push_back(0.1 * k);
    frames.push_back(k);
  }
  lacuna::TrackedSlices::Write(stack, poses, times,
    status.empty() ? std::vector<unsigned char>(poses.size(), 0) : status, frames);
  return stack;
}

inline double GetValue(vtkImageData* volume, const char* array, int i, int j, int k)
{
  int ijk[3] = { i, j, k };
  return volume->GetPointData()->GetArray(array)->GetTuple1(volume->ComputePointId(ijk));
}

using Configure = std::function<void(vtkLacunaSweptVolume*)>;

// The error of a filter on stack.
inline std::string GetError(vtkImageData* stack, const Configure& configure = {})
{
  vtkNew<vtkLacunaSweptVolume> filter;
  filter->SetInputDataObject(stack);
  filter->SetOutputSpacing(0.5, 0.5, 0.5);
  if (configure)
  {
    configure(filter);
  }
  const auto messages = lacunaCheck::Watch(filter);
  filter->Update();
  LACUNA_CHECK_THAT(messages->Errors.empty() || filter->GetOutput()->GetNumberOfPoints() == 0,
    "no half result after: " + messages->Errors);
  return messages->Errors;
}
}
#endif
