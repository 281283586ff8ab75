// SPDX-License-Identifier: BSD-3-Clause
// A skull with a hole becomes a depth map, and the hole is filled: Lacuna in a C++ program.
#include <vtkImageData.h>
#include <vtkLacunaBSplineIsoRayCaster.h>
#include <vtkLacunaRBFHoleFiller.h>
#include <vtkLacunaSkullPhantom.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkSphere.h>

#include <cstdio>

int main()
{
  vtkNew<vtkLacunaSkullPhantom> skull;

  vtkNew<vtkLacunaBSplineIsoRayCaster> caster;
  caster->SetInputConnection(skull->GetOutputPort());
  caster->SetIsoValue(0, 500);
  double toHole[3];
  skull->GetDefectDirection(toHole);
  caster->SetViewDirection(-toHole[0], -toHole[1], -toHole[2]);

  vtkNew<vtkLacunaRBFHoleFiller> filler;
  filler->SetInputConnection(caster->GetOutputPort());
  filler->Update();

  vtkImageData* map = filler->GetOutput();
  if (!map->GetPointData()->GetArray("Fitted"))
  {
    return 1;
  }
  std::printf(
    "depth map of %lld pixels, hole filled\n", static_cast<long long>(map->GetNumberOfPoints()));
  return 0;
}
