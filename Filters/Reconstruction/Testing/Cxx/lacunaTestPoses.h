// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Pictures and tables of poses for the tests of vtkLacunaAssembleTrackedSlices.
#ifndef lacunaTestPoses_h
#define lacunaTestPoses_h

#include "lacunaCheck.h"
#include "lacunaFieldData.h"
#include "lacunaTestTables.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkLacunaAssembleTrackedSlices.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"
#include "vtkTable.h"

#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

// No symmetry: grey = column + 10 row + 100 slice.
inline vtkSmartPointer<vtkImageData> MakeStack(
  int slices, int type = VTK_INT, const char* name = "Grey", int channels = 1)
{
  auto stack = vtkSmartPointer<vtkImageData>::New();
  stack->SetExtent(0, 4, 0, 3, 0, slices - 1);
  stack->SetSpacing(7, 8, 9); // not used
  stack->SetOrigin(-1, -2, -3);
  stack->AllocateScalars(type, channels);
  stack->GetPointData()->GetScalars()->SetName(name);
  for (int k = 0; k < slices; ++k)
  {
    for (int j = 0; j < 4; ++j)
    {
      for (int i = 0; i < 5; ++i)
      {
        for (int c = 0; c < channels; ++c)
        {
          stack->SetScalarComponentFromDouble(i, j, k, c, (c + 1) * (i + 10 * j + 100 * k));
        }
      }
    }
  }
  return stack;
}

// Row i: a position (i, 2 i, 3 i) and a turn of i degrees about z.
inline vtkSmartPointer<vtkTable> MakePoses(int rows)
{
  auto table = vtkSmartPointer<vtkTable>::New();
  for (const auto& [name, factor] : { std::pair("x", 1), std::pair("y", 2), std::pair("z", 3),
         std::pair("azimuth", 1), std::pair("elevation", 0), std::pair("roll", 0) })
  {
    std::vector<double> values;
    for (int i = 0; i < rows; ++i)
    {
      values.push_back(factor * i);
    }
    AddColumn(table, name, values);
  }
  return table;
}

inline lacuna::Matrix4 GetPose(double i)
{
  return lacuna::Matrix4::Translation({ i, 2 * i, 3 * i }) *
    lacuna::Matrix4::Rotation({ 0, 0, 1 }, i * std::acos(-1.0) / 180);
}

using Configure = std::function<void(vtkLacunaAssembleTrackedSlices*)>;

inline vtkSmartPointer<vtkLacunaAssembleTrackedSlices> MakeFilter(
  vtkImageData* stack, vtkTable* table, const Configure& configure = {})
{
  auto filter = vtkSmartPointer<vtkLacunaAssembleTrackedSlices>::New();
  filter->SetInputDataObject(0, stack);
  filter->SetInputDataObject(1, table);
  filter->SetPoseFormat(vtkLacunaAssembleTrackedSlices::Euler);
  filter->SetPixelSpacing(0.5);
  if (configure)
  {
    configure(filter);
  }
  return filter;
}

inline std::string GetError(vtkImageData* stack, vtkTable* table, const Configure& configure = {})
{
  const auto filter = MakeFilter(stack, table, configure);
  const auto messages = lacunaCheck::Watch(filter);
  filter->Update();
  LACUNA_CHECK_THAT(messages->Errors.empty() || filter->GetOutput()->GetNumberOfPoints() == 0,
    "no half result after: " + messages->Errors);
  return messages->Errors;
}

inline double GetGrey(vtkImageData* image, int i, int j, int k)
{
  return image->GetScalarComponentAsDouble(i, j, k, 0);
}

inline void CheckPose(vtkImageData* slices, vtkIdType slice, const lacuna::Matrix4& expected)
{
  const lacuna::Matrix4 pose =
    lacuna::FieldData::GetMatrix(slices->GetFieldData()->GetArray("ImageToReference"), slice);
  for (int i = 0; i < 16; ++i)
  {
    LACUNA_CHECK_NEAR(pose.Data()[i], expected.Data()[i], 1e-9);
  }
}

inline double GetStatus(vtkImageData* slices, vtkIdType slice)
{
  return slices->GetFieldData()->GetArray("SliceStatus")->GetTuple1(slice);
}
#endif
