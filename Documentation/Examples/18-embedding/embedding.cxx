// SPDX-License-Identifier: BSD-3-Clause
// Lacuna in a C++ program: the hole in a skull is filled, written as IGES and drawn, with no window
// and no ParaView.
//   Embedding [folder to write to]     writes embedding.png and embedding.igs
#include <vtkDataArray.h>
#include <vtkImageData.h>
#include <vtkImageFlip.h>
#include <vtkLacunaBSplineIsoRayCaster.h>
#include <vtkLacunaDepthMapShader.h>
#include <vtkLacunaIGESWriter.h>
#include <vtkLacunaRBFHoleFiller.h>
#include <vtkLacunaSkullPhantom.h>
#include <vtkMath.h>
#include <vtkNew.h>
#include <vtkPNGWriter.h>
#include <vtkPointData.h>
#include <vtkSphere.h>

#include <cstdio>
#include <string>

int main(int argc, char* argv[])
{
  const std::string folder = argc > 1 ? argv[1] : ".";

  // a CT; of your own: vtkLacunaCTSeriesReader
  vtkNew<vtkLacunaSkullPhantom> skull;
  double direction[3];
  skull->GetDefectDirection(direction);
  vtkMath::Normalize(direction);

  // its surface, seen so that the hole is face on
  vtkNew<vtkLacunaBSplineIsoRayCaster> caster;
  caster->SetInputConnection(skull->GetOutputPort());
  caster->SetIsoValue(0, 500);
  caster->SetViewDirection(-direction[0], -direction[1], -direction[2]);
  caster->SetPixelSpacing(0.4);

  // what is in a ball over the hole, a little larger than its outline, is replaced
  const double center[3] = { 0, 0, 0 };
  const double radius = skull->IntersectOuterSurface(center, direction);
  vtkNew<vtkSphere> ball;
  ball->SetCenter(radius * direction[0], radius * direction[1], radius * direction[2]);
  ball->SetRadius(1.3 * skull->GetDefectRadius());
  vtkNew<vtkLacunaRBFHoleFiller> filler;
  filler->SetInputConnection(caster->GetOutputPort());
  filler->SetDefectRegion(ball);
  filler->Update();

  // errors were printed; outputs are empty then
  vtkDataArray* filled = filler->GetOutput()->GetPointData()->GetArray("FilledMask");
  if (!filled || filled->GetRange()[1] != 1)
  {
    return 1;
  }

  vtkNew<vtkLacunaIGESWriter> iges;
  iges->SetInputConnection(filler->GetOutputPort());
  iges->SetFileName((folder + "/embedding.igs").c_str());
  if (!iges->Write())
  {
    return 1;
  }

  // Row 0 of a depth map is on top, VTK writes the last row first.
  vtkNew<vtkLacunaDepthMapShader> shader;
  shader->SetInputConnection(filler->GetOutputPort());
  shader->SetBackgroundColor(1, 1, 1);
  shader->Update();
  vtkNew<vtkImageData> pixels;
  pixels->ShallowCopy(shader->GetOutput());
  pixels->SetDirectionMatrix(1, 0, 0, 0, 1, 0, 0, 0, 1); // VTK 9.6 turns them by that of the map
  vtkNew<vtkImageFlip> upright;
  upright->SetInputData(pixels);
  upright->SetFilteredAxis(1);
  vtkNew<vtkPNGWriter> picture;
  picture->SetInputConnection(upright->GetOutputPort());
  picture->SetFileName((folder + "/embedding.png").c_str());
  picture->Write();
  if (picture->GetErrorCode())
  {
    return 1;
  }

  std::printf(
    "hole filled, %.2g mm from the fit to its IGES surface at most\n", iges->GetMaximumDeviation());
  return 0;
}
