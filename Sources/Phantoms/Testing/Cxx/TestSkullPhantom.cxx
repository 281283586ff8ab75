// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaCheck.h"
#include "lacunaProvenance.h"
#include "vtkExecutive.h"
#include "vtkImageData.h"
#include "vtkLacunaSkullPhantom.h"
#include "vtkNew.h"
#include "vtkTestErrorObserver.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <sstream>
#include <string>

namespace
{
// Voxels are the truth outside of the defect, soft tissue instead of bone inside.
void TestTruth()
{
  vtkNew<vtkLacunaSkullPhantom> skull;
  skull->SetCenter(12, -30, 55);
  skull->Update();
  vtkImageData* output = skull->GetOutput();
  const int* dimensions = output->GetDimensions();
  LACUNA_CHECK_THAT(dimensions[0] == 169 && dimensions[1] == 204 && dimensions[2] == 67, "size");
  LACUNA_CHECK_THAT(output->GetScalarType() == VTK_SHORT && output->GetSpacing()[2] == 2.3, "type");
  LACUNA_CHECK_THAT(lacuna::Provenance::Get(output).size() == 1, "Provenance");
  int bone = 0;
  int missing = 0;
  for (int k = 0; k < dimensions[2]; ++k)
  {
    for (int j = 0; j < dimensions[1]; j += 3)
    {
      for (int i = 0; i < dimensions[0]; i += 3)
      {
        double p[3];
        const int ijk[3] = { i, j, k };
        output->TransformIndexToPhysicalPoint(ijk, p);
        const double truth = skull->EvaluateTruth(p[0], p[1], p[2]);
        const double value = output->GetScalarComponentAsDouble(i, j, k, 0);
        const bool same = std::abs(value - truth) <= 0.5 + 1e-9;
        if (!same)
        {
          LACUNA_CHECK_THAT(truth > value, "the defect only takes away");
          missing += truth > 500 && skull->IsInDefect(p[0], p[1], p[2]);
        }
        bone += value > 500;
      }
    }
  }
  LACUNA_CHECK_THAT(bone > 10000, "bone");
  LACUNA_CHECK_THAT(missing > 500, "missing bone");

  // From the top: the ray meets 500 HU of the truth, also over the defect.
  const double down[3] = { 0, 0, -3 };
  int holes = 0;
  for (int x = -60; x <= 60; x += 5)
  {
    for (int y = -70; y <= 70; y += 5)
    {
      const double eye[3] = { 12.0 + x, -30.0 + y, 200 };
      const double depth = skull->IntersectOuterSurface(eye, down);
      if (!std::isnan(depth))
      {
        const double z = 200 - depth;
        LACUNA_CHECK_THAT(std::abs(skull->EvaluateTruth(eye[0], eye[1], z) - 500) < 1e-5, "500 HU");
        holes += skull->IsInDefect(eye[0], eye[1], z);
      }
    }
  }
  LACUNA_CHECK_THAT(holes > 80 && holes < 160, "about pi 30^2 / 25 rays meet the defect");
  const double up[3] = { 0, 0, 1 };
  const double above[3] = { 0, 0, 300 };
  LACUNA_CHECK_THAT(std::isnan(skull->IntersectOuterSurface(above, up)), "a miss");
}

void TestPieces()
{
  vtkNew<vtkLacunaSkullPhantom> skull;
  skull->SetSpacing(2, 2, 2.3);
  skull->SetNoiseLevel(15);
  skull->Update();
  vtkNew<vtkImageData> whole;
  whole->DeepCopy(skull->GetOutput());
  const int extent[6] = { 20, 60, 3, 50, 30, 60 };
  vtkNew<vtkLacunaSkullPhantom> same;
  same->SetSpacing(2, 2, 2.3);
  same->SetNoiseLevel(15);
  same->UpdateExtent(extent);
  vtkImageData* part = same->GetOutput();
  LACUNA_CHECK_THAT(
    std::equal(extent, extent + 6, part->GetExtent()), "exactly the requested extent");
  for (int k = extent[4]; k <= extent[5]; ++k)
  {
    for (int j = extent[2]; j <= extent[3]; ++j)
    {
      for (int i = extent[0]; i <= extent[1]; ++i)
      {
        LACUNA_CHECK_THAT(*static_cast<short*>(part->GetScalarPointer(i, j, k)) ==
            *static_cast<short*>(whole->GetScalarPointer(i, j, k)),
          "pieces equal the whole");
      }
    }
  }
}

// The patient's left carries the bump: more bone there than at the mirrored place.
void TestLaterality()
{
  vtkNew<vtkLacunaSkullPhantom> skull;
  const double centre[3] = { 0, 0, 0 };
  const double left[3] = { 0.42, -0.80, 0.43 };
  const double right[3] = { -0.42, -0.80, 0.43 };
  LACUNA_CHECK_THAT(
    skull->IntersectOuterSurface(centre, left) > skull->IntersectOuterSurface(centre, right) + 2,
    "the bump is on the left forehead");
  LACUNA_CHECK_THAT(skull->IsInDefect(30, -15, 60) && !skull->IsInDefect(-30, -15, 60),
    "the defect is on the left");
}

void TestErrors()
{
  struct Case
  {
    const char* Text;
    std::function<void(vtkLacunaSkullPhantom*)> Spoil;
  };
  using S = vtkLacunaSkullPhantom*;
  const double nan = std::nan("");
  for (const Case& c : { Case{ "Spacing is -1 mm; it must be above 0 and at most 5 mm",
                           [](S s) { s->SetSpacing(-1, 1, 2.3); } },
         Case{ "Spacing is nan", [=](S s) { s->SetSpacing(nan, 1, 1); } },
         Case{ "DefectRadius is 400", [](S s) { s->SetDefectRadius(400); } },
         Case{ "DefectDirection is 0,0,0; its length must be above 0",
           [](S s) { s->SetDefectDirection(0, 0, 0); } },
         Case{ "NoiseLevel is -1", [](S s) { s->SetNoiseLevel(-1); } },
         Case{ "Center is nan", [=](S s) { s->SetCenter(nan, 0, 0); } },
         Case{ "would need", [](S s) { s->SetSpacing(1e-3, 1e-3, 1e-3); } },
         Case{ "would need", [](S s) { s->SetSpacing(1e-200, 1e-200, 1e-200); } } })
  {
    vtkNew<vtkLacunaSkullPhantom> skull;
    c.Spoil(skull);
    vtkNew<vtkTest::ErrorObserver> observer;
    vtkNew<vtkTest::ErrorObserver> executiveObserver;
    skull->AddObserver(vtkCommand::ErrorEvent, observer);
    skull->GetExecutive()->AddObserver(vtkCommand::ErrorEvent, executiveObserver);
    skull->Update();
    LACUNA_CHECK_THAT(observer->GetErrorMessage().find(c.Text) != std::string::npos,
      std::string(c.Text) + " | " + observer->GetErrorMessage());
    LACUNA_CHECK_THAT(skull->GetOutput()->GetNumberOfPoints() == 0, "no output after an error");
  }
  vtkNew<vtkLacunaSkullPhantom> skull;
  const double zero[3] = { 0, 0, 0 };
  LACUNA_CHECK_THAT(std::isnan(skull->EvaluateTruth(0, nan, 0)), "truth of nowhere");
  skull->SetSpacing(0, 1, 1);
  LACUNA_CHECK_THAT(std::isnan(skull->EvaluateTruth(0, 0, 0)) &&
      std::isnan(skull->IntersectOuterSurface(zero, zero)) && !skull->IsInDefect(0, 0, 0),
    "no truth with a bad property");
  std::ostringstream text;
  skull->Print(text);
  LACUNA_CHECK_THAT(
    text.str().find("DefectRadius: 30 (0 (intact skull) or above 0 and at most 40 mm)") !=
      std::string::npos,
    "PrintSelf");
}
}

int TestSkullPhantom(int, char*[])
{
  TestTruth();
  TestPieces();
  TestLaterality();
  TestErrors();
  return lacunaCheck::Result();
}
