// SPDX-License-Identifier: BSD-3-Clause
// A skull with a hole becomes a depth map, and the hole is filled: Lacuna in a C++ program.
#include <vtkDataArray.h>
#include <vtkImageData.h>
#include <vtkLacunaBSplineIsoRayCaster.h>
#include <vtkLacunaRBFHoleFiller.h>
#include <vtkLacunaSkullPhantom.h>
#include <vtkMath.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkSphere.h>

#include <cstdio>

int main()
{
  vtkNew<vtkLacunaSkullPhantom> skull;
  double direction[3];
  skull->GetDefectDirection(direction);
  vtkMath::Normalize(direction);

  // look at the hole
  vtkNew<vtkLacunaBSplineIsoRayCaster> caster;
  caster->SetInputConnection(skull->GetOutputPort());
  caster->SetIsoValue(0, 500);
  caster->SetViewDirection(-direction[0], -direction[1], -direction[2]);

  // a ball over it, a little larger than its irregular outline
  const double center[3] = { 0, 0, 0 };
  const double radius = skull->IntersectOuterSurface(center, direction);
  vtkNew<vtkSphere> ball;
  ball->SetCenter(radius * direction[0], radius * direction[1], radius * direction[2]);
  ball->SetRadius(1.3 * skull->GetDefectRadius());

  vtkNew<vtkLacunaRBFHoleFiller> filler;
  filler->SetInputConnection(caster->GetOutputPort());
  filler->SetDefectRegion(ball);
  filler->Update();

  vtkImageData* map = filler->GetOutput();
  vtkDataArray* filled = map->GetPointData()->GetArray("FilledMask");
  if (!filled || filled->GetRange()[1] != 1)
  {
    return 1;
  }
  std::printf(
    "depth map of %lld pixels, hole filled\n", static_cast<long long>(map->GetNumberOfPoints()));
  return 0;
}
