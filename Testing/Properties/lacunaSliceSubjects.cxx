// SPDX-License-Identifier: BSD-3-Clause
// Filters that take tracked slices, pictures and tables of poses.
#include "lacunaFieldData.h"
#include "lacunaRandomData.h"
#include "lacunaSubject.h"
#include "lacunaTrackedSlices.h"
#include "lacunaTrial.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkLacunaAssembleTrackedSlices.h"
#include "vtkLacunaBoneEcho.h"
#include "vtkLacunaGateSlices.h"
#include "vtkLacunaProbeCalibration.h"
#include "vtkLacunaScanRegion.h"
#include "vtkLacunaSliceOutliner.h"
#include "vtkLacunaSlicePlanes.h"
#include "vtkLacunaSliceRayCaster.h"
#include "vtkLacunaSweptVolume.h"
#include "vtkLacunaTemporalCalibration.h"
#include "vtkLacunaTrackedSliceWriter.h"
#include "vtkLacunaTrackerSelfTest.h"
#include "vtkStringArray.h"
#include "vtkTable.h"

#include <algorithm>
#include <cmath>

#include <unistd.h>

namespace lacunaProperties
{
namespace
{
Inputs MakeSlices(Dice& dice)
{
  return { RandomSlices(dice, !dice.Chance(0.1)) };
}

int CountSlices(vtkImageData* stack)
{
  return static_cast<int>(
    stack->GetFieldData()->GetArray(lacuna::TrackedSlices::SliceStatusName)->GetNumberOfTuples());
}

template <class T>
std::vector<Property> SliceProperties()
{
  using Base = vtkLacunaSliceAlgorithm;
  return { Wholes<4>("ClipRectangle", &Base::SetClipRectangle, 0, 5),
    Reals<2>("FanOrigin", &Base::SetFanOrigin, -10, 10),
    Reals<2>("FanAngles", &Base::SetFanAngles, -80, 80),
    Reals<2>("FanRadii", &Base::SetFanRadii, 0, 20),
    Switch("UseImageInvalid", &Base::SetUseImageInvalid),
    Switch("UseTooFast", &Base::SetUseTooFast), Switch("UseGatedOut", &Base::SetUseGatedOut),
    Whole("BadPoses", &Base::SetBadPoses, 0, 2), Whole("GapMethod", &Base::SetGapMethod, 0, 2) };
}

void Append(std::vector<Property>& properties, const std::vector<Property>& more)
{
  properties.insert(properties.end(), more.begin(), more.end());
}

Subject MakeSweptVolume()
{
  using T = vtkLacunaSweptVolume;
  Subject subject{ "SweptVolume", NewOf<T>, MakeSlices, SliceProperties<T>() };
  Append(subject.Properties,
    { Reals<3>("OutputSpacing", &T::SetOutputSpacing, 0.3, 2),
      Reals<6>("OutputBounds", &T::SetOutputBounds, -220, 220),
      Whole("OutputFrame", &T::SetOutputFrame, 0, 1),
      Whole("PixelSampling", &T::SetPixelSampling, 0, 2),
      Real("FootprintScale", &T::SetFootprintScale, 0.5, 4),
      Switch("FootprintAcrossSlices", &T::SetFootprintAcrossSlices),
      Whole("Interpolation", &T::SetInterpolation, 0, 1),
      Whole("Compounding", &T::SetCompounding, 0, 1),
      Real("MaximumSliceGap", &T::SetMaximumSliceGap, 0, 3), Whole("FanMask", &T::SetFanMask, 0, 2),
      Whole("OutputScalarType", &T::SetOutputScalarType, 0, 1),
      Whole("MemoryLimit", &T::SetMemoryLimit, 1, 64) });
  // spacings of a few micrometres would be right, and long
  subject.Prepare = [](vtkAlgorithm* algorithm) { Cast<T>(algorithm)->SetMemoryLimit(64); };
  subject.Cost = 4;
  return subject;
}

Subject MakeBoneEcho()
{
  using T = vtkLacunaBoneEcho;
  Subject subject{ "BoneEcho", NewOf<T>, MakeSlices, SliceProperties<T>() };
  Append(subject.Properties,
    { Real("MinimumConfidence", &T::SetMinimumConfidence, 0.01, 1),
      Real("ShadowLength", &T::SetShadowLength, 0.5, 20),
      Real("MaximumGap", &T::SetMaximumGap, 0, 10), Real("MinimumArea", &T::SetMinimumArea, 0, 20),
      Real("Thickness", &T::SetThickness, 0.1, 10), Whole("FanMask", &T::SetFanMask, 0, 2) });
  return subject;
}

Subject MakeSliceRayCaster()
{
  using T = vtkLacunaSliceRayCaster;
  Subject subject{ "SliceRayCaster", NewOf<T>, MakeSlices, SliceProperties<T>() };
  Append(subject.Properties,
    { Real("IsoValue", &T::SetIsoValue, 0, 100), Whole("SolidSide", &T::SetSolidSide, 0, 1),
      Real("MaximumGap", &T::SetMaximumGap, 0, 10),
      Reals<3>("ViewDirection", &T::SetViewDirection, -1, 1),
      Reals<3>("ViewUp", &T::SetViewUp, -1, 1),
      Reals<3>("FocalPoint", &T::SetFocalPoint, -200, 200),
      Reals<3>("PlaneOrigin", &T::SetPlaneOrigin, -200, 200),
      Real("PixelSpacing", &T::SetPixelSpacing, 0.2, 3),
      Wholes<2>("ImageSize", &T::SetImageSize, 0, 40) });
  subject.Prepare = [](vtkAlgorithm* algorithm) { Cast<T>(algorithm)->SetIsoValue(50); };
  return subject;
}

Subject MakeSliceOutliner()
{
  using T = vtkLacunaSliceOutliner;
  Subject subject{ "SliceOutliner", NewOf<T>, MakeSlices,
    { Whole("Slice", &T::SetSlice, 0, 3), Switch("Smooth", &T::SetSmooth),
      Other<T>("OutlinePoints",
        [](T* filter, Dice& dice, bool isHostile)
        {
          filter->RemoveAllOutlinePoints();
          const int count = isHostile ? dice.Whole(1, 4) : dice.Whole(3, 9);
          for (int i = 0; i < count; ++i)
          {
            const bool isBad = isHostile && dice.Chance(0.3);
            filter->AddOutlinePoint(1, isBad ? HostileReal(dice) : 0, isBad ? HostileReal(dice) : 1,
              dice.Real(0, 9), isBad ? HostileReal(dice) : dice.Real(0, 9));
          }
          return std::to_string(count);
        }) } };
  return subject;
}

Subject MakeAssembler()
{
  using T = vtkLacunaAssembleTrackedSlices;
  Subject subject{ "AssembleTrackedSlices", NewOf<T>,
    [](Dice& dice) -> Inputs
    {
      const int slices = dice.Length(1, 6);
      const int format = dice.Chance(0.6) ? T::Matrix : dice.Whole(0, 2);
      return { RandomStack(dice, slices),
        RandomPoses(dice, dice.Chance(0.9) ? slices : dice.Whole(1, 6), format) };
    },
    { Whole("PoseFormat", &T::SetPoseFormat, 0, 2),
      Whole("PoseTransform", &T::SetPoseTransform, 0, 3),
      Whole("LengthUnit", &T::SetLengthUnit, 0, 3),
      Other<T>("PixelSpacing",
        [](T* filter, Dice& dice, bool isHostile)
        {
          const double spacing = isHostile ? HostileReal(dice) : dice.Real(0.1, 1);
          filter->SetPixelSpacing(spacing, dice.Real(0.1, 1));
          return std::to_string(spacing);
        }),
      Other<T>("ImageToProbe",
        [](T* filter, Dice& dice, bool isHostile)
        {
          lacuna::Matrix4 matrix =
            RandomPose(dice, 20) * lacuna::Matrix4::Scaling({ 0.3, 0.4, 0.3 });
          if (isHostile)
          {
            matrix(dice.Whole(0, 3), dice.Whole(0, 3)) = HostileReal(dice);
          }
          filter->SetImageToProbe(matrix.Data());
          return std::string("a pose");
        }),
      Whole("RowOrder", &T::SetRowOrder, 0, 2), Whole("MatchBy", &T::SetMatchBy, 0, 2),
      Other<T>("PoseColumns",
        [](T* filter, Dice& dice, bool isHostile)
        {
          filter->SetNumberOfPoseColumns(isHostile ? dice.Pick({ -1, 3 }) : 1);
          filter->SetPoseColumn(0, dice.Pick({ "m", "", "q", "x" }));
          return std::to_string(filter->GetNumberOfPoseColumns());
        }),
      Word("FrameColumn", &T::SetFrameColumn, { "", "x" }),
      Word("TimestampColumn", &T::SetTimestampColumn, { "", "Timestamp" }),
      Word("StatusColumn", &T::SetStatusColumn, { "", "x" }),
      Word("GateColumn", &T::SetGateColumn, { "", "x" }),
      Reals<2>("GateRange", &T::SetGateRange, -5, 5),
      Whole("FirstFrameNumber", &T::SetFirstFrameNumber, -3, 3),
      Real("FrameRate", &T::SetFrameRate, 0, 50), Real("TimeOffset", &T::SetTimeOffset, -0.1, 0.1),
      Real("MaximumTimeGap", &T::SetMaximumTimeGap, 0, 1),
      Switch("SkipInvalidPoses", &T::SetSkipInvalidPoses) } };
  subject.MayBeNaN = { "Gate", "ImageToReference", "ProbeToReference" };
  subject.Prepare = [](vtkAlgorithm* algorithm) { Cast<T>(algorithm)->SetPixelSpacing(0.3); };
  return subject;
}

// A sweep over three wires at right angles, of which a slice shows one each, and the picks.
Inputs MakeWireScan(Dice& dice)
{
  constexpr int slices = 45;
  constexpr double pixel = 0.4;
  auto stack = vtkSmartPointer<vtkImageData>::New();
  stack->SetExtent(0, 9, 0, 11, 0, slices - 1);
  AddScalars(
    stack, VTK_UNSIGNED_CHAR, "Intensity", [&](const lacuna::Vec3&) { return dice.Real(0, 120); });
  const lacuna::Matrix4 imageToProbe =
    RandomPose(dice, 20) * lacuna::Matrix4::Scaling({ pixel, pixel, pixel });
  const lacuna::Matrix4 phantom = RandomPose(dice, 100);
  std::vector<lacuna::Matrix4> probe;
  std::vector<double> times;
  std::vector<double> columns[3];
  vtkNew<vtkStringArray> wires;
  wires->SetName("Wire");
  for (int i = 0; i < slices; ++i)
  {
    const lacuna::Vec3 seen{ dice.Real(0, 9), dice.Real(0, 11), 0 };
    lacuna::Vec3 place{};
    place[i % 3] = dice.Real(-15, 15);
    const lacuna::Matrix4 turned = RandomPose(dice, 0) * imageToProbe;
    const lacuna::Matrix4 imageToPhantom =
      lacuna::Matrix4::Translation(place - turned.Point(seen)) * turned;
    probe.push_back(phantom * imageToPhantom * imageToProbe.Inverse());
    times.push_back(0.04 * i);
    columns[0].push_back(i);
    columns[1].push_back(seen[0] + dice.Real(-0.3, 0.3));
    columns[2].push_back(seen[1] + dice.Real(-0.3, 0.3));
    wires->InsertNextValue(std::string(1, "XYZ"[i % 3]));
  }
  lacuna::TrackedSlices::Write(stack, {}, times,
    std::vector<unsigned char>(slices, lacuna::TrackedSlices::Valid), std::vector<int>(slices, 1));
  lacuna::FieldData::SetMatrices(stack, "ProbeToTracker", probe);
  auto picks = vtkSmartPointer<vtkTable>::New();
  AddColumn(picks, "Slice", columns[0]);
  AddColumn(picks, "Column", columns[1]);
  AddColumn(picks, "Row", columns[2]);
  picks->AddColumn(wires);
  return { stack, picks };
}

Subject MakeProbeCalibration()
{
  using T = vtkLacunaProbeCalibration;
  Subject subject{ "ProbeCalibration", NewOf<T>,
    [](Dice& dice) -> Inputs
    {
      if (dice.Chance(0.7))
      {
        return MakeWireScan(dice);
      }
      const auto slices = RandomSlices(dice, dice.Chance(0.5));
      return { slices,
        dice.Chance(0.8) ? RandomPicks(dice, CountSlices(slices)) : vtkSmartPointer<vtkTable>() };
    },
    { Whole("Method", &T::SetMethod, 0, 3), Real("PixelSpacing", &T::SetPixelSpacing, 0.1, 1),
      Real("RowSpacing", &T::SetRowSpacing, 0.1, 1), Switch("EstimateScale", &T::SetEstimateScale),
      Real("OutlierLimit", &T::SetOutlierLimit, 2, 6),
      Word("WireRanges", &T::SetWireRanges, { "", "X 0-1, Y 2-3, Z 4-5", "X 1", "Y 3-0" }),
      Switch("FindSpots", &T::SetFindSpots),
      Other<T>("OutputFileName",
        [](T* filter, Dice& dice, bool isHostile)
        {
          const std::string name = GetOutputFolder() +
            (isHostile ? dice.Pick({ "", "/no such folder/calibration.xml", "/calibration" })
                       : "/calibration" + std::to_string(getpid()) + ".xml");
          filter->SetOutputFileName(name.c_str());
          return name;
        }) } };
  subject.MayBeNaN = { "RunnerUpRms" };
  subject.KeepsOutput = true;
  subject.Prepare = [](vtkAlgorithm* algorithm) { Cast<T>(algorithm)->SetPixelSpacing(0.4); };
  subject.KeepsGeometry = true;
  subject.Cost = 20;
  return subject;
}

// A probe that goes up and down over a floor, of enough slices to find the lag.
Inputs MakeFloor(Dice& dice)
{
  const int slices = dice.Chance(0.8) ? dice.Whole(40, 60) : dice.Whole(1, 40);
  auto stack = vtkSmartPointer<vtkImageData>::New();
  stack->SetExtent(0, 19, 0, 39, 0, slices - 1);
  const double lag = dice.Real(-0.1, 0.1);
  const auto height = [](double t) { return 5 * std::sin(4 * t); };
  AddScalars(stack, VTK_UNSIGNED_CHAR, "Intensity",
    [&](const lacuna::Vec3& p)
    {
      const double row = 20 + 2 * height(0.04 * p[2] + lag);
      return dice.Real(0, 20) + 200 * std::exp(-0.5 * (p[1] - row) * (p[1] - row));
    });
  std::vector<lacuna::Matrix4> probe;
  std::vector<double> times;
  for (int i = 0; i < slices; ++i)
  {
    times.push_back(0.04 * i);
    probe.push_back(lacuna::Matrix4::Translation({ 3, 4, height(0.04 * i) }));
  }
  lacuna::TrackedSlices::Write(
    stack, {}, times, std::vector<unsigned char>(slices, 0), std::vector<int>(slices, 1));
  lacuna::FieldData::SetMatrices(stack, "ProbeToTracker", probe);
  return { stack };
}

// A screen with a bright rectangle.
Inputs MakeScreen(Dice& dice)
{
  const int dimensions[3] = { dice.Length(8, 60), dice.Length(8, 60), dice.Whole(1, 3) };
  auto screen = vtkSmartPointer<vtkImageData>::New();
  screen->SetDimensions(dimensions);
  AddScalars(screen, RandomType(dice), "Screen",
    [&](const lacuna::Vec3& p)
    {
      const bool isIn = p[0] > 0.2 * dimensions[0] && p[0] < 0.8 * dimensions[0] &&
        p[1] > 0.1 * dimensions[1] && p[1] < 0.9 * dimensions[1];
      return isIn ? dice.Real(40, 120) : 0;
    });
  return { screen };
}

// Two receivers on a bar that is carried slowly along two sides of a field, with metal in its end.
Inputs MakeReceivers(Dice& dice)
{
  const int slices = dice.Chance(0.9) ? dice.Length(60, 90) : dice.Whole(1, 12);
  auto stack = vtkSmartPointer<vtkImageData>::New();
  stack->SetExtent(0, 2, 0, 1, 0, slices - 1);
  AddScalars(
    stack, VTK_UNSIGNED_CHAR, "Intensity", [&](const lacuna::Vec3&) { return dice.Real(0, 120); });
  const lacuna::Matrix4 bar = RandomPose(dice, 0) * lacuna::Matrix4::Translation({ 90, 10, 0 });
  const lacuna::Matrix4 turned = RandomPose(dice, 0);
  std::vector<lacuna::Matrix4> first;
  std::vector<lacuna::Matrix4> second;
  std::vector<double> times;
  for (int i = 0; i < slices; ++i)
  {
    const lacuna::Vec3 place{ 150 + 4.0 * std::min(i, 40), -200 + 5.0 * std::max(0, i - 40),
      40 + dice.Real(-0.5, 0.5) };
    first.push_back(lacuna::Matrix4::Translation(place) * turned *
      lacuna::Matrix4::Rotation({ 1, 2, 0.5 }, 0.02 * i));
    const double metal = i > 50 ? 0.2 * (i - 50) : 0;
    second.push_back(
      lacuna::Matrix4::Translation({ metal, dice.Real(-0.5, 0.5), 0 }) * first.back() * bar);
    times.push_back(0.2 * i);
  }
  lacuna::TrackedSlices::Write(stack, {}, times,
    std::vector<unsigned char>(slices, lacuna::TrackedSlices::Valid), std::vector<int>(slices, 1));
  lacuna::FieldData::SetMatrices(stack, "ProbeToTracker", first);
  lacuna::FieldData::SetMatrices(stack, "PointerToTracker", second);
  return { stack };
}
}

//------------------------------------------------------------------------------
void AddSliceSubjects(std::vector<Subject>& subjects)
{
  subjects.push_back(MakeAssembler());
  {
    using T = vtkLacunaGateSlices;
    Subject subject{ "GateSlices", NewOf<T>,
      [](Dice& dice) -> Inputs {
        return { RandomSlices(dice), RandomSignal(dice) };
      },
      { Whole("GateType", &T::SetGateType, 0, 2), Reals<2>("GateRange", &T::SetGateRange, 0, 1),
        Real("Period", &T::SetPeriod, 0.5, 2),
        Word("GateColumn", &T::SetGateColumn, { "Gate", "" }),
        Whole("MatchBy", &T::SetMatchBy, 0, 1), Word("KeyColumn", &T::SetKeyColumn, { "", "Time" }),
        Real("TimeOffset", &T::SetTimeOffset, -1, 1),
        Real("MaximumTimeGap", &T::SetMaximumTimeGap, 0, 1),
        Real("SpeedLimit", &T::SetSpeedLimit, 0, 50) } };
    subject.MayBeNaN = { "Gate" };
    subject.IsFrugal = true;
    subject.KeepsGeometry = true;
    subjects.push_back(subject);
  }
  {
    using T = vtkLacunaSlicePlanes;
    subjects.push_back({ "SlicePlanes", NewOf<T>, MakeSlices,
      { Whole("Stride", &T::SetStride, 1, 3), Whole("ColorBy", &T::SetColorBy, 0, 2),
        Real("TranslationAccuracy", &T::SetTranslationAccuracy, 0, 3),
        Real("AngularAccuracy", &T::SetAngularAccuracy, 0, 2),
        Real("SpeedLimit", &T::SetSpeedLimit, 0, 50), Switch("OutlineOnly", &T::SetOutlineOnly),
        Whole("InvalidSlices", &T::SetInvalidSlices, 0, 2),
        Whole("BadPoses", &T::SetBadPoses, 1, 2),
        Whole("MaximumNumberOfPoints", &T::SetMaximumNumberOfPoints, 4, 1000) } });
    subjects.back().MayBeNaN = { "Speed", "Intensity", "RegistrationError" };
  }
  subjects.push_back(MakeSliceOutliner());
  subjects.push_back(MakeBoneEcho());
  subjects.push_back(MakeSweptVolume());
  subjects.push_back(MakeSliceRayCaster());
  subjects.push_back(MakeProbeCalibration());
  {
    using T = vtkLacunaTemporalCalibration;
    Subject subject{ "TemporalCalibration", NewOf<T>, MakeFloor,
      { Real("MaximumLag", &T::SetMaximumLag, 0.1, 2) } };
    subject.Prepare = [](vtkAlgorithm* algorithm) { Cast<T>(algorithm)->SetMaximumLag(0.3); };
    subject.Cost = 10;
    subjects.push_back(subject);
  }
  {
    using T = vtkLacunaTrackerSelfTest;
    subjects.push_back({ "TrackerSelfTest", NewOf<T>, MakeReceivers,
      { Word("FirstReceiver", &T::SetFirstReceiver, { "ProbeToTracker", "" }),
        Word("SecondReceiver", &T::SetSecondReceiver, { "", "PointerToTracker" }),
        Whole("PoseFormat", &T::SetPoseFormat, 0, 2), Whole("LengthUnit", &T::SetLengthUnit, 0, 3),
        Wholes<2>("Stations", &T::SetStations, 1, 4), Real("SpeedLimit", &T::SetSpeedLimit, 0, 100),
        Real("RevisitDistance", &T::SetRevisitDistance, 1, 50),
        Real("RevisitAngle", &T::SetRevisitAngle, 1, 50),
        Real("TranslationAccuracy", &T::SetTranslationAccuracy, 0, 3),
        Real("AngularAccuracy", &T::SetAngularAccuracy, 0, 2),
        Real("RangeLimit", &T::SetRangeLimit, 100, 1000) } });
    subjects.back().MayBeNaN = { "Repeatability" };
  }
  {
    using T = vtkLacunaScanRegion;
    subjects.push_back({ "ScanRegion", NewOf<T>, MakeScreen,
      { Real("TickLength", &T::SetTickLength, 0, 10),
        Real("PixelAspect", &T::SetPixelAspect, 0.5, 2) },
      5 });
  }
  {
    using T = vtkLacunaTrackedSliceWriter;
    Subject subject{ "TrackedSliceWriter", NewOf<T>, MakeSlices,
      { Whole("CompressionLevel", &T::SetCompressionLevel, 0, 9) } };
    subject.SetFile = FileOf<T>("mha");
    subjects.push_back(subject);
  }
}
}
