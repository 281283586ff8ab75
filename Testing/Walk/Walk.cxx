// SPDX-License-Identifier: BSD-3-Clause
// The two ways through Lacuna, for Testing/Tools/walk.sh, which counts the sources that they pass.
//   Walk files FOLDER     writes the files that the ways begin with
//   Walk slice FOLDER     a sweep's file becomes a volume
//   Walk CT FOLDER        a CT's file becomes IGES: depth map, filled hole, position for the press, file
#include <vtkDataArray.h>
#include <vtkImageData.h>
#include <vtkLacunaBSplineIsoRayCaster.h>
#include <vtkLacunaIGESWriter.h>
#include <vtkLacunaPhantomSweep.h>
#include <vtkLacunaPressOrientation.h>
#include <vtkLacunaRBFHoleFiller.h>
#include <vtkLacunaSkullPhantom.h>
#include <vtkLacunaSweptVolume.h>
#include <vtkLacunaTrackedSliceReader.h>
#include <vtkLacunaTrackedSliceWriter.h>
#include <vtkLacunaVolumeReader.h>
#include <vtkMetaImageWriter.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkSphere.h>

#include <cstdio>
#include <string>

namespace
{
bool WriteFiles(const std::string& folder)
{
  vtkNew<vtkLacunaPhantomSweep> sweep;
  sweep->SetNumberOfSlices(30);
  vtkNew<vtkLacunaTrackedSliceWriter> slices;
  slices->SetInputConnection(sweep->GetOutputPort());
  slices->SetFileName((folder + "/sweep.mha").c_str());
  vtkNew<vtkLacunaSkullPhantom> skull;
  skull->SetSpacing(2, 2, 2);
  vtkNew<vtkMetaImageWriter> volume;
  volume->SetInputConnection(skull->GetOutputPort());
  volume->SetFileName((folder + "/skull.mha").c_str());
  volume->Write();
  return slices->Write() && !volume->GetErrorCode();
}

bool WalkSlice(const std::string& folder)
{
  vtkNew<vtkLacunaTrackedSliceReader> slices;
  slices->SetFileName((folder + "/sweep.mha").c_str());
  vtkNew<vtkLacunaSweptVolume> volume;
  volume->SetInputConnection(slices->GetOutputPort());
  volume->Update();
  vtkDataArray* grey = volume->GetOutput()->GetPointData()->GetScalars();
  return grey && grey->GetRange()[1] > 0;
}

bool WalkCT(const std::string& folder)
{
  vtkNew<vtkLacunaVolumeReader> reader;
  reader->SetFileName((folder + "/skull.mha").c_str());
  vtkNew<vtkLacunaSkullPhantom> truth; // where its hole is; it makes no volume
  double direction[3];
  truth->GetDefectDirection(direction);
  vtkNew<vtkLacunaBSplineIsoRayCaster> map;
  map->SetInputConnection(reader->GetOutputPort());
  map->SetIsoValue(0, 500);
  map->SetViewDirection(-direction[0], -direction[1], -direction[2]);
  const double center[3] = { 0, 0, 0 };
  const double radius = truth->IntersectOuterSurface(center, direction);
  vtkNew<vtkSphere> ball;
  ball->SetCenter(radius * direction[0], radius * direction[1], radius * direction[2]);
  ball->SetRadius(1.3 * truth->GetDefectRadius());
  vtkNew<vtkLacunaRBFHoleFiller> filled;
  filled->SetInputConnection(map->GetOutputPort());
  filled->SetDefectRegion(ball);
  filled->SetOutputMargin(20); // for the flange of the press
  vtkNew<vtkLacunaPressOrientation> press;
  press->SetInputConnection(filled->GetOutputPort());
  vtkNew<vtkLacunaIGESWriter> writer;
  writer->SetInputConnection(press->GetOutputPort());
  writer->SetFileName((folder + "/skull.igs").c_str());
  return writer->Write() == 1;
}
}

int main(int argc, char* argv[])
{
  const std::string way = argc == 3 ? argv[1] : "";
  const bool done = way == "files" ? WriteFiles(argv[2])
    : way == "slice"               ? WalkSlice(argv[2])
                                   : way == "CT" && WalkCT(argv[2]);
  if (!done)
  {
    std::fprintf(
      stderr, "Walk: %s failed\n", way.empty() ? "call with a way and a folder:" : way.c_str());
  }
  return done ? 0 : 1;
}
