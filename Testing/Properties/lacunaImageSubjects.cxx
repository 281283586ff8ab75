// SPDX-License-Identifier: BSD-3-Clause
// Filters that take volumes and depth maps: speckle, ray casting, occlusion, mirror, warp.
#include "lacunaRandomData.h"
#include "lacunaSubject.h"
#include "vtkDoubleArray.h"
#include "vtkImageData.h"
#include "vtkLacunaBSplineIsoRayCaster.h"
#include "vtkLacunaContrastToSpeckle.h"
#include "vtkLacunaDepthMapShader.h"
#include "vtkLacunaDepthMapSurface.h"
#include "vtkLacunaMirror.h"
#include "vtkLacunaOccludedAngle.h"
#include "vtkLacunaOcclusionSurface.h"
#include "vtkLacunaRBFImageWarp.h"
#include "vtkLacunaSkullBone.h"
#include "vtkLacunaSpeckleFilter.h"
#include "vtkPiecewiseFunction.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkSphere.h"

namespace lacunaProperties
{
namespace
{
// Marks about a third of the points.
void AddMask(vtkImageData* image, const char* name, Dice& dice)
{
  const std::string active = image->GetPointData()->GetScalars()->GetName();
  AddScalars(image, dice.Pick({ VTK_CHAR, VTK_UNSIGNED_CHAR, VTK_DOUBLE }), name,
    [&](const lacuna::Vec3&) { return dice.Chance(0.3) ? 1 : 0; });
  image->GetPointData()->SetActiveScalars(active.c_str());
}

vtkSmartPointer<vtkSphere> RandomSphere(Dice& dice, bool isHostile)
{
  auto sphere = vtkSmartPointer<vtkSphere>::New();
  sphere->SetCenter(dice.Real(-100, 100), dice.Real(-100, 100), dice.Real(-100, 100));
  sphere->SetRadius(isHostile ? HostileReal(dice) : dice.Real(1, 120));
  return sphere;
}

template <class T>
std::vector<Property> ViewProperties()
{
  return { Reals<3, T>("ViewDirection", &T::SetViewDirection, -1, 1),
    Reals<3, T>("ViewUp", &T::SetViewUp, -1, 1),
    Reals<3, T>("FocalPoint", &T::SetFocalPoint, -9, 9),
    Reals<3, T>("PlaneOrigin", &T::SetPlaneOrigin, -50, 50),
    Real<T>("PixelSpacing", &T::SetPixelSpacing, 0.5, 3),
    Wholes<2, T>("ImageSize", &T::SetImageSize, 0, 30) };
}

Subject MakeRayCaster()
{
  using T = vtkLacunaBSplineIsoRayCaster;
  Subject subject{ "BSplineIsoRayCaster", NewOf<T>,
    [](Dice& dice) -> Inputs
    {
      const auto volume = dice.Chance(0.5) ? RandomVolume(dice) : RandomLump(dice, 2, 9);
      vtkSmartPointer<vtkImageData> start;
      if (dice.Chance(0.2))
      {
        vtkNew<T> caster;
        caster->SetInputData(volume);
        caster->SetIsoValue(0, 30);
        caster->Update();
        start = caster->GetOutput();
      }
      return { volume, start };
    },
    ViewProperties<T>() };
  subject.Prepare = [](vtkAlgorithm* algorithm) { Cast<T>(algorithm)->SetIsoValue(0, 50); };
  for (const Property& property :
    std::vector<Property>{ Word("ScalarArray", &T::SetScalarArray, { "", "Data" }),
      Other<T>("IsoValues",
        [](T*filter, Dice&dice, bool isHostile)
        {
          const int count = isHostile ? dice.Pick({ 0, 1, 2, -1 }) : dice.Whole(1, 3);
          filter->SetNumberOfIsoValues(count);
          std::string text = std::to_string(count) + ":";
          for (int i = 0; i < count; ++i)
          {
            filter->SetIsoValue(i, isHostile ? HostileReal(dice) : dice.Real(0, 100));
            text += " " + std::to_string(filter->GetIsoValue(i));
          }
          return text;
        }),
      Whole("Interpolation", &T::SetInterpolation, 0, 2),
      Whole("SolidSide", &T::SetSolidSide, 0, 1), Whole("NormalMethod", &T::SetNormalMethod, 0, 1),
      Whole("Projection", &T::SetProjection, 0, 1),
      Reals<3>("EyePosition", &T::SetEyePosition, -100, 100),
      Real("ViewAngle", &T::SetViewAngle, 5, 90),
      Other<T>("CutAway",
        [](T*filter, Dice&dice, bool isHostile)
        {
          filter->SetCutAway(RandomSphere(dice, isHostile));
          return std::string("a sphere");
        }),
      Switch("CapCutAway", &T::SetCapCutAway), Switch("CapBoundary", &T::SetCapBoundary),
      Switch("ComputeThickness", &T::SetComputeThickness) })
  {
    subject.Properties.push_back(property);
  }
  subject.MayBeNaN = { "Depth", "Depth_1", "Depth_2", "Thickness" };
  subject.Cost = 3;
  return subject;
}

Subject MakeShader()
{
  using T = vtkLacunaDepthMapShader;
  Subject subject{ "DepthMapShader", NewOf<T>,
    [](Dice& dice) -> Inputs
    {
      return { RandomDepthMap(dice, dice.Chance(0.3), 3),
        dice.Chance(0.4) ? RandomLump(dice, 3, 6) : vtkSmartPointer<vtkImageData>() };
    },
    { Word("DepthArray", &T::SetDepthArray, { "Depth", "Fitted" }),
      Whole("NormalMethod", &T::SetNormalMethod, 0, 3),
      Real("MaximumAngle", &T::SetMaximumAngle, 0, 90),
      Real("MaximumAngleChange", &T::SetMaximumAngleChange, 0, 180),
      Whole("Shading", &T::SetShading, 0, 1), Real("Ambient", &T::SetAmbient, 0, 1),
      Real("Diffuse", &T::SetDiffuse, 0, 1), Real("Specular", &T::SetSpecular, 0, 1),
      Real("SpecularPower", &T::SetSpecularPower, 0.001, 100),
      Other<T>("Lights",
        [](T* filter, Dice& dice, bool isHostile)
        {
          double n[5];
          for (double& value : n)
          {
            value = isHostile ? HostileReal(dice) : dice.Real(-1, 1);
          }
          filter->AddLight(
            n[0], n[1], n[2], isHostile ? n[3] : dice.Whole(0, 1), isHostile ? n[4] : 1);
          return std::to_string(n[0]);
        }),
      Real("DepthCue", &T::SetDepthCue, 0, 1), Whole("DepthLaw", &T::SetDepthLaw, 0, 1),
      Reals<3>("SurfaceColor", &T::SetSurfaceColor, 0, 1),
      Reals<3>("BackgroundColor", &T::SetBackgroundColor, 0, 1),
      Switch("CastShadows", &T::SetCastShadows),
      Word("VolumeArray", &T::SetVolumeArray, { "", "Data" }),
      Whole("Interpolation", &T::SetInterpolation, 0, 2),
      Whole("SolidSide", &T::SetSolidSide, 0, 1), Real("ShadowBias", &T::SetShadowBias, 0, 1),
      Switch("CapCutAway", &T::SetCapCutAway), Switch("CapBoundary", &T::SetCapBoundary) } };
  subject.MayBeNaN = { "NormalDifference" };
  subject.KeepsGeometry = true;
  return subject;
}

Subject MakeOccludedAngle()
{
  using T = vtkLacunaOccludedAngle;
  const auto numbers = [](void (T::*count)(int), void (T::*set)(int, double), double highest)
  {
    return [=](T* filter, Dice& dice, bool isHostile)
    {
      const int n = isHostile ? dice.Pick({ 0, 1, 3, -1 }) : dice.Whole(1, 2);
      (filter->*count)(n);
      std::string text = std::to_string(n) + ":";
      for (int i = 0; i < n; ++i)
      {
        const double value = isHostile ? HostileReal(dice) : dice.Real(0, highest);
        (filter->*set)(i, value);
        text += " " + std::to_string(value);
      }
      return text;
    };
  };
  Subject subject{ "OccludedAngle", NewOf<T>,
    [](Dice& dice) -> Inputs
    {
      auto image = RandomVolume(dice);
      vtkSmartPointer<vtkImageData> space;
      if (dice.Chance(0.2))
      {
        space = vtkSmartPointer<vtkImageData>::New();
        space->CopyStructure(image);
        AddScalars(space, VTK_UNSIGNED_CHAR, "Space",
          [&](const lacuna::Vec3&) { return dice.Chance(0.8) ? 1 : 0; });
      }
      return { image, space };
    },
    { Word("ScalarArray", &T::SetScalarArray, { "", "Data" }), Whole("Mode", &T::SetMode, 0, 1),
      Whole("Attenuation", &T::SetAttenuation, 0, 2),
      Other<T>("OpacityFunction",
        [](T* filter, Dice& dice, bool isHostile)
        {
          vtkNew<vtkPiecewiseFunction> function;
          function->AddPoint(0, 0);
          function->AddPoint(dice.Real(10, 100), isHostile ? HostileReal(dice) : 1);
          filter->SetOpacityFunction(function);
          return std::string("of two points");
        }),
      Other<T>("NumberOfDirections", // ten millions would be right, and long
        [](T* filter, Dice& dice, bool isHostile)
        {
          filter->SetNumberOfDirections(
            isHostile ? dice.Pick({ INT_MIN, -1, 0, 1 }) : dice.Whole(2, 60));
          return std::to_string(filter->GetNumberOfDirections());
        }),
      Other<T>(
        "ThresholdsOverPi", numbers(&T::SetNumberOfThresholdsOverPi, &T::SetThresholdsOverPi, 3)),
      Other<T>("LocalRadii", numbers(&T::SetNumberOfLocalRadii, &T::SetLocalRadii, 20)),
      Real("ObjectOpacity", &T::SetObjectOpacity, 0.01, 1),
      Real("Dilation", &T::SetDilation, 0, 0.9), Switch("KeepData", &T::SetKeepData),
      Whole("MedianKernel", &T::SetMedianKernel, 1, 5),
      Other<T>("ReconstructionSpace",
        [](T* filter, Dice& dice, bool isHostile)
        {
          filter->SetReconstructionSpace(RandomSphere(dice, isHostile));
          return std::string("a sphere");
        }),
      Switch("KeepIterations", &T::SetKeepIterations) } };
  subject.Prepare = [](vtkAlgorithm* algorithm) { Cast<T>(algorithm)->SetNumberOfDirections(40); };
  subject.KeepsGeometry = true;
  subject.Cost = 2;
  return subject;
}

// A ball with the angle that the next filter wants.
Inputs MakeOccludedBall(Dice& dice)
{
  const auto data = RandomLump(dice, 9, 11);
  vtkNew<vtkLacunaOccludedAngle> angle;
  angle->SetInputData(data);
  angle->SetNumberOfDirections(40);
  angle->Update();
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->DeepCopy(angle->GetOutput());
  return { image, data };
}
}

//------------------------------------------------------------------------------
void AddImageSubjects(std::vector<Subject>& subjects)
{
  {
    using T = vtkLacunaSpeckleFilter;
    Subject subject{ "SpeckleFilter", NewOf<T>,
      [](Dice& dice) -> Inputs { return { RandomVolume(dice) }; },
      { Word("ScalarArray", &T::SetScalarArray, { "" }),
        Whole("Operation", &T::SetOperation, 0, T::LaplacianOfGaussian),
        Wholes<3>("KernelSize", &T::SetKernelSize, 1, 7),
        Whole("KernelShape", &T::SetKernelShape, 0, 1), Real("Rank", &T::SetRank, 0, 100),
        Real("AdaptiveStrength", &T::SetAdaptiveStrength, 0, 20),
        Real("StandardDeviation", &T::SetStandardDeviation, 0.3, 3) } };
    subject.KeepsGeometry = true;
    subjects.push_back(subject);
  }
  {
    using T = vtkLacunaContrastToSpeckle;
    subjects.push_back({ "ContrastToSpeckle", NewOf<T>,
      [](Dice& dice) -> Inputs
      {
        auto image = RandomVolume(dice);
        AddMask(image, "Inside", dice);
        AddMask(image, "Outside", dice);
        return { image };
      },
      { Word("ScalarArray", &T::SetScalarArray, { "", "Data" }),
        Word("InsideArray", &T::SetInsideArray, { "", "Inside" }),
        Word("OutsideArray", &T::SetOutsideArray, { "", "Outside" }),
        Reals<6>("InsideBounds", &T::SetInsideBounds, -120, 120),
        Reals<6>("OutsideBounds", &T::SetOutsideBounds, -120, 120),
        Real("IsoValue", &T::SetIsoValue, 0, 100) } });
    subjects.back().MayBeNaN = { "CSR", "InsideMean", "OutsideMean", "InsideVariance",
      "OutsideVariance", "InsideSNR", "OutsideSNR" };
    subjects.back().Prepare = [](vtkAlgorithm* algorithm)
    { Cast<T>(algorithm)->SetInsideArray("Inside"); };
  }
  subjects.push_back(MakeRayCaster());
  subjects.push_back(MakeShader());
  {
    using T = vtkLacunaDepthMapSurface;
    subjects.push_back({ "DepthMapSurface", NewOf<T>,
      [](Dice& dice) -> Inputs { return { RandomDepthMap(dice, dice.Chance(0.3), 2) }; },
      { Word("DepthArray", &T::SetDepthArray, { "Depth", "Fitted" }),
        Switch("BreakAtDiscontinuities", &T::SetBreakAtDiscontinuities),
        Real("MaximumAngle", &T::SetMaximumAngle, 0, 90),
        Real("MaximumAngleChange", &T::SetMaximumAngleChange, 0, 180),
        Switch("ComputeNormalDifference", &T::SetComputeNormalDifference) } });
    subjects.back().MayBeNaN = { "NormalDifference" };
  }
  subjects.push_back(MakeOccludedAngle());
  {
    using T = vtkLacunaOcclusionSurface;
    subjects.push_back({ "OcclusionSurface", NewOf<T>, MakeOccludedBall,
      { Word("ScalarArray", &T::SetScalarArray, { "", "Data" }),
        Real("Smoothing", &T::SetSmoothing, 0.1, 10),
        Real("Tolerance", &T::SetTolerance, 0.01, 0.5) },
      30 });
  }
  {
    using T = vtkLacunaMirror;
    Subject subject{ "Mirror", NewOf<T>,
      [](Dice& dice) -> Inputs
      {
        return { dice.Chance(0.3) ? RandomDepthMap(dice, false, 6)
            : dice.Chance(0.5)    ? RandomVolume(dice)
                                  : RandomLump(dice, 4, 8) };
      },
      { Whole("PlaneMethod", &T::SetPlaneMethod, 0, 1), Reals<3>("Origin", &T::SetOrigin, -50, 50),
        Reals<3>("Normal", &T::SetNormal, -1, 1),
        Whole("Interpolation", &T::SetInterpolation, 0, 2) } };
    subject.MayBeNaN = { "Asymmetry", "SymmetryScore" };
    subject.KeepsGeometry = true;
    subject.Cost = 10;
    subjects.push_back(subject);
  }
  {
    using T = vtkLacunaSkullBone;
    Subject subject{ "SkullBone", NewOf<T>,
      [](Dice& dice) -> Inputs
      { return { dice.Chance(0.7) ? RandomVolume(dice) : RandomLump(dice, 4, 8) }; },
      { Real("Level", &T::SetLevel, -50, 300) } };
    subject.Prepare = [](vtkAlgorithm* algorithm) { Cast<T>(algorithm)->SetLevel(30); };
    subject.KeepsGeometry = true;
    subject.Cost = 3;
    subjects.push_back(subject);
  }
  {
    using T = vtkLacunaRBFImageWarp;
    Subject subject{ "RBFImageWarp", NewOf<T>,
      [](Dice& dice) -> Inputs
      {
        const auto image = RandomVolume(dice);
        const auto landmarks = RandomPoints(dice, 3, 12);
        auto targets = vtkSmartPointer<vtkPolyData>::New();
        targets->DeepCopy(landmarks);
        for (vtkIdType i = 0; i < targets->GetNumberOfPoints(); ++i)
        {
          double p[3];
          targets->GetPoint(i, p);
          for (double& coordinate : p)
          {
            coordinate += dice.Real(-1, 1);
          }
          targets->GetPoints()->SetPoint(i, p);
        }
        return { image, landmarks, targets };
      },
      { Whole("Kernel", &T::SetKernel, 0, 3), Real("Smoothing", &T::SetSmoothing, 0, 10),
        Whole("Interpolation", &T::SetInterpolation, 0, 2),
        Real("OutsideValue", &T::SetOutsideValue, -10, 100),
        Real("Accuracy", &T::SetAccuracy, 0.001, 0.5) } };
    subject.KeepsGeometry = true;
    subject.Cost = 3;
    subjects.push_back(subject);
  }
}
}
