// SPDX-License-Identifier: BSD-3-Clause
// At most 12 bytes per voxel besides the input.
#include "lacunaCheck.h"
#include "lacunaProcessMemory.h"
#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkLacunaOccludedAngle.h"
#include "vtkNew.h"
#include "vtkPointData.h"

#include <iostream>

int TestOccludedAngleMemory(int, char*[])
{
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  std::cout << "sanitizers need memory of their own: nothing to measure\n";
#else
  vtkNew<vtkImageData> image;
  image->SetDimensions(240, 240, 240);
  image->AllocateScalars(VTK_FLOAT, 1);
  image->GetPointData()->GetScalars()->Fill(0);
  image->SetScalarComponentFromDouble(100, 120, 130, 0, 1);
  vtkNew<vtkLacunaOccludedAngle> filter;
  filter->SetNumberOfDirections(6);
  filter->SetThresholdsOverPi(1, 2);
  filter->SetInputData(image);
  const double before = lacuna::GetProcessMemory("VmRSS");
  filter->Update();
  const double used = lacuna::GetProcessMemory("VmHWM") - before;
  const double voxels = 240.0 * 240 * 240;
  std::cout << used / voxels << " bytes per voxel\n";
  LACUNA_CHECK(before == 0 || used < 12 * voxels);
  LACUNA_CHECK(filter->GetOutput()->GetNumberOfPoints() == 240 * 240 * 240);
#endif
  return lacunaCheck::Result();
}
