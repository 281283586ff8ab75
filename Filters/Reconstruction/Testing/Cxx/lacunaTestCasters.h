// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Views of the stacks of lacunaTestStacks.h, for tests of vtkLacunaSliceRayCaster.
#ifndef lacunaTestCasters_h
#define lacunaTestCasters_h

#include "lacunaTestStacks.h"
#include "vtkLacunaSliceRayCaster.h"

#include <cstring>

namespace lacunaTestStacks
{
using Caster = vtkLacunaSliceRayCaster;

// Looks along the way of the probe; in the stacks, grey = column + 2 row + 10 slice, and rays meet
// slice n at depth n.
inline void LookAlong(Caster* caster)
{
  caster->SetViewDirection(0, 0, 1);
  caster->SetViewUp(0, -1, 0);
  caster->SetIsoValue(30);
}

// A view that does not depend on the slices.
inline void FixView(Caster* caster)
{
  LookAlong(caster);
  caster->SetFocalPoint(13, 22, 0);
  caster->SetPlaneOrigin(0, 0, 0);
  caster->SetPixelSpacing(0.4);
  caster->SetImageSize(16, 12);
}

inline bool IsSame(vtkImageData* a, vtkImageData* b)
{
  if (a->GetNumberOfPoints() == 0 || a->GetNumberOfPoints() != b->GetNumberOfPoints())
  {
    return false;
  }
  for (const char* name : { "Depth", "vtkValidPointMask", "Normals" })
  {
    vtkDataArray* x = a->GetPointData()->GetArray(name);
    vtkDataArray* y = b->GetPointData()->GetArray(name);
    if (std::memcmp(x->GetVoidPointer(0), y->GetVoidPointer(0),
          static_cast<std::size_t>(x->GetNumberOfValues()) * x->GetDataTypeSize()) != 0)
    {
      return false;
    }
  }
  return true;
}

// What the filter makes of stack without having seen anything before.
inline vtkSmartPointer<vtkImageData> CastAfresh(
  vtkImageData* stack, const std::function<void(Caster*)>& configure = FixView)
{
  vtkNew<Caster> caster;
  configure(caster);
  caster->SetInputData(stack);
  caster->Update();
  return caster->GetOutput();
}
}
#endif
