// SPDX-License-Identifier: BSD-3-Clause
// Phantoms.
#include "lacunaRandomData.h"
#include "lacunaSubject.h"
#include "vtkImageData.h"
#include "vtkLacunaIncompleteShape.h"
#include "vtkLacunaPhantomSweep.h"
#include "vtkLacunaSkullPhantom.h"

namespace lacunaProperties
{
//------------------------------------------------------------------------------
void AddSourceSubjects(std::vector<Subject>& subjects)
{
  {
    using T = vtkLacunaPhantomSweep;
    Subject subject{ "PhantomSweep", NewOf<T>,
      [](Dice& dice) -> Inputs
      { return { dice.Chance(0.3) ? RandomVolume(dice) : vtkSmartPointer<vtkImageData>() }; },
      { Whole("NumberOfSlices", &T::SetNumberOfSlices, 1, 6),
        Wholes<2>("ImageSize", &T::SetImageSize, 1, 20),
        Real("PixelSpacing", &T::SetPixelSpacing, 0.1, 2), Whole("Motion", &T::SetMotion, 0, 3),
        Whole("NumberOfSweeps", &T::SetNumberOfSweeps, 1, 3),
        Real("SpeckleLevel", &T::SetSpeckleLevel, 0, 10),
        Reals<2>("PoseNoise", &T::SetPoseNoise, 0, 2), Whole("Anatomy", &T::SetAnatomy, 0, 3),
        Whole("Seed", &T::SetSeed, -5, 5), Real("Travel", &T::SetTravel, 1, 100),
        Real("SweepAngle", &T::SetSweepAngle, 1, 120), Real("TwistAngle", &T::SetTwistAngle, 0, 20),
        Real("FanAngle", &T::SetFanAngle, 0, 20), Real("Wander", &T::SetWander, 0, 5),
        Real("EdgeWidth", &T::SetEdgeWidth, 0.1, 4), Reals<3>("Center", &T::SetCenter, -50, 50),
        Whole("OutputScalarType", &T::SetOutputScalarType, 0, 1) } };
    subject.Prepare = [](vtkAlgorithm* algorithm)
    {
      Cast<T>(algorithm)->SetNumberOfSlices(6);
      Cast<T>(algorithm)->SetImageSize(50, 40);
    };
    subjects.push_back(subject);
  }
  {
    using T = vtkLacunaSkullPhantom;
    Subject subject{ "SkullPhantom", NewOf<T>, [](Dice&) -> Inputs { return {}; },
      { Reals<3>("Spacing", &T::SetSpacing, 4, 5), Real("DefectRadius", &T::SetDefectRadius, 0, 40),
        Reals<3>("DefectDirection", &T::SetDefectDirection, -1, 1),
        Real("NoiseLevel", &T::SetNoiseLevel, 0, 50), Whole("Seed", &T::SetSeed, -5, 5),
        Switch("Sutures", &T::SetSutures), Reals<3>("Center", &T::SetCenter, -50, 50) } };
    subject.Prepare = [](vtkAlgorithm* algorithm) { Cast<T>(algorithm)->SetSpacing(5, 5, 5); };
    subject.Cost = 20;
    subjects.push_back(subject);
  }
  {
    using T = vtkLacunaIncompleteShape;
    Subject subject{ "IncompleteShape", NewOf<T>, [](Dice&) -> Inputs { return {}; },
      { Whole("Shape", &T::SetShape, 0, 5), Wholes<3>("Dimensions", &T::SetDimensions, 28, 34),
        Real("PresentFraction", &T::SetPresentFraction, 0.05, 1), Switch("Patches", &T::SetPatches),
        Reals<2>("PatchRadii", &T::SetPatchRadii, 1, 8), Real("GapAngle", &T::SetGapAngle, 0, 360),
        Real("TissueFraction", &T::SetTissueFraction, 0, 1),
        Real("OutlierFraction", &T::SetOutlierFraction, 0, 10),
        Whole("Seed", &T::SetSeed, -5, 5) } };
    subject.Prepare = [](vtkAlgorithm* algorithm)
    {
      Cast<T>(algorithm)->SetShape(T::Sphere);
      Cast<T>(algorithm)->SetDimensions(30, 30, 30);
    };
    subject.Cost = 4;
    subjects.push_back(subject);
  }
}
}
