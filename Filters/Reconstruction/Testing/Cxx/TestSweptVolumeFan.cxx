// SPDX-License-Identifier: BSD-3-Clause
/// The fan of vtkLacunaSweptVolume: given, found, copied from what was found, refused.
#include "lacunaFieldData.h"
#include "lacunaProvenance.h"
#include "lacunaTestReplay.h"
#include "vtkIntArray.h"

#include <cmath>
#include <random>

using lacuna::Matrix4;
using namespace lacunaTestStacks;

namespace
{
constexpr int Width = 160;
constexpr int Height = 120;
constexpr int Slices = 12;
constexpr double Pixel = 0.4;

bool IsInSector(double column, double row)
{
  const double x = Pixel * (column - 80);
  const double y = Pixel * (row + 30);
  const double radius = std::hypot(x, y);
  const double degrees = std::atan2(x, y) * 57.29577951308232;
  return radius >= 16 && radius <= 56 && degrees >= -30 && degrees <= 36;
}

bool IsInRectangle(double column, double row)
{
  return column >= 30 && column <= 130 && row >= 10 && row <= 99;
}

// Grey levels 1..100 where inside(column, row), bright letters and black elsewhere.
vtkSmartPointer<vtkImageData> Scan(bool (*inside)(double, double))
{
  auto stack = vtkSmartPointer<vtkImageData>::New();
  stack->SetDimensions(Width, Height, Slices);
  stack->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
  auto* pixel = static_cast<unsigned char*>(stack->GetScalarPointer());
  std::mt19937 random(5);
  std::uniform_int_distribution<int> grey(1, 100);
  std::vector<Matrix4> poses;
  std::vector<double> times;
  std::vector<int> frames;
  for (int k = 0; k < Slices; ++k)
  {
    poses.push_back(Matrix4::Rotation({ 1, 0.5, 0 }, 0.5) *
      Matrix4::Translation({ 0, 0, 0.5 * k }) * Matrix4::Scaling({ Pixel, Pixel, 1 }));
    times.push_back(k);
    frames.push_back(k);
    for (int j = 0; j < Height; ++j)
    {
      for (int i = 0; i < Width; ++i)
      {
        const bool letter = i < 20 && j > 100 && i % 4 < 2;
        *pixel++ = static_cast<unsigned char>(inside(i, j) ? grey(random) : letter ? 255 : 0);
      }
    }
  }
  lacuna::TrackedSlices::Write(stack, poses, times, std::vector<unsigned char>(Slices, 0), frames);
  return stack;
}

void SetGivenFan(vtkLacunaSweptVolume* filter)
{
  filter->SetFanOrigin(80, -30);
  filter->SetFanAngles(-30, 36);
  filter->SetFanRadii(16, 56);
}

vtkSmartPointer<vtkImageData> Reconstruct(
  vtkImageData* stack, const Configure& configure, int interpolation = 0)
{
  vtkNew<vtkLacunaSweptVolume> filter;
  filter->SetInputData(stack);
  filter->SetOutputSpacing(0.5, 0.5, 0.5);
  filter->SetInterpolation(interpolation);
  configure(filter);
  filter->Update();
  return filter->GetOutput();
}

bool AreEqual(vtkImageData* a, vtkImageData* b)
{
  bool equal = a->GetNumberOfPoints() == b->GetNumberOfPoints() && a->GetNumberOfPoints() > 0;
  for (int axis = 0; axis < 3; ++axis)
  {
    equal = equal && a->GetOrigin()[axis] == b->GetOrigin()[axis];
  }
  for (const char* name : { "Intensity", "Contributions", "vtkValidPointMask" })
  {
    vtkDataArray* x = a->GetPointData()->GetArray(name);
    vtkDataArray* y = b->GetPointData()->GetArray(name);
    for (vtkIdType i = 0; equal && i < a->GetNumberOfPoints(); ++i)
    {
      equal = x->GetTuple1(i) == y->GetTuple1(i);
    }
  }
  return equal;
}

// Lowest and highest grey level of voxels with data.
std::array<double, 2> GetRange(vtkImageData* volume)
{
  std::array<double, 2> range{ 1e9, -1e9 };
  vtkDataArray* grey = volume->GetPointData()->GetArray("Intensity");
  vtkDataArray* mask = volume->GetPointData()->GetArray("vtkValidPointMask");
  for (vtkIdType i = 0; i < volume->GetNumberOfPoints(); ++i)
  {
    if (mask->GetTuple1(i) == 1)
    {
      range[0] = std::min(range[0], grey->GetTuple1(i));
      range[1] = std::max(range[1], grey->GetTuple1(i));
    }
  }
  return range;
}

void TestGiven()
{
  const auto stack = Scan(IsInSector);
  for (const int interpolation : { 0, 1 })
  {
    const auto all = Reconstruct(
      stack, [](auto*) {}, interpolation);
    LACUNA_CHECK_THAT(GetRange(all)[0] == 0 && GetRange(all)[1] == 255, "black and letters");
    const auto fan = Reconstruct(stack, SetGivenFan, interpolation);
    LACUNA_CHECK_THAT(GetRange(fan)[0] > 0 && GetRange(fan)[1] <= 100, "neither in the fan");
    LACUNA_CHECK_THAT(
      fan->GetNumberOfPoints() < 0.9 * all->GetNumberOfPoints(), "the box of the fan is smaller");
    const auto none = Reconstruct(
      stack,
      [](auto* filter)
      {
        SetGivenFan(filter);
        filter->SetFanMaskToNoFan();
      },
      interpolation);
    LACUNA_CHECK_THAT(AreEqual(none, all), "NoFan");
    LACUNA_CHECK_THAT(!fan->GetFieldData()->HasArray("FanOrigin"), "a given fan is no result");
  }
  const auto fan = Reconstruct(stack, SetGivenFan);
  LACUNA_CHECK_CONTAINS(lacuna::Provenance::Get(fan).back(), "FanMask=Given FanOrigin=80,-30 ");

  // pixels are counted in the original slices, however the stack is cropped or strided
  vtkNew<vtkImageData> cropped;
  cropped->DeepCopy(stack);
  int extent[6] = { 7, Width - 1, 2, Height - 1, 0, Slices - 1 };
  cropped->Crop(extent);
  LACUNA_CHECK_THAT(AreEqual(Reconstruct(cropped, SetGivenFan), fan), "of a cropped stack");
  cropped->SetExtent(0, Width - 8, 0, Height - 3, 0, Slices - 1);
  cropped->SetOrigin(7, 2, 0);
  LACUNA_CHECK_THAT(AreEqual(Reconstruct(cropped, SetGivenFan), fan), "of a moved stack");
  const auto clipped = Reconstruct(stack,
    [](auto* filter)
    {
      SetGivenFan(filter);
      filter->SetClipRectangle(7, 2, 0, 0);
    });
  LACUNA_CHECK_THAT(AreEqual(clipped, fan), "of a clipped stack");
  vtkNew<vtkImageData> coarse; // of twice the pixels
  coarse->DeepCopy(stack);
  coarse->SetSpacing(2, 2, 1);
  const auto wide = Reconstruct(coarse,
    [](auto* filter)
    {
      filter->SetFanOrigin(160, -60);
      filter->SetFanAngles(-30, 36);
      filter->SetFanRadii(32, 112);
    });
  LACUNA_CHECK_THAT(GetRange(wide)[0] > 0 && GetRange(wide)[1] <= 100, "of a strided stack");
}

void TestAutomatic()
{
  const auto stack = Scan(IsInSector);
  vtkNew<vtkLacunaSweptVolume> filter;
  filter->SetInputData(stack);
  filter->SetOutputSpacing(0.5, 0.5, 0.5);
  filter->SetFanMaskToAutomatic();
  filter->Update();
  vtkImageData* found = filter->GetOutput();
  LACUNA_CHECK_THAT(GetRange(found)[1] <= 100, "no letters");
  vtkDataArray* origin = lacuna::FieldData::Get(found, "FanOrigin", 2, 1);
  vtkDataArray* angles = lacuna::FieldData::Get(found, "FanAngles", 2, 1);
  vtkDataArray* radii = lacuna::FieldData::Get(found, "FanRadii", 2, 1);
  vtkDataArray* clip = lacuna::FieldData::Get(found, "ClipRectangle", 4, 1);
  LACUNA_CHECK_NEAR(angles->GetComponent(0, 0), -30, 0.7);
  LACUNA_CHECK_NEAR(angles->GetComponent(0, 1), 36, 0.7);
  LACUNA_CHECK_NEAR(
    radii->GetComponent(0, 1) + Pixel * origin->GetComponent(0, 1), 56 - Pixel * 30, 0.4);
  const std::string description = filter->GetFanDescription();
  LACUNA_CHECK_CONTAINS(description, "FanOrigin=");
  LACUNA_CHECK_CONTAINS(description, " ClipRectangle=");

  // what was found can be copied
  const auto copied = Reconstruct(stack,
    [&](auto* given)
    {
      given->SetFanOrigin(origin->GetComponent(0, 0), origin->GetComponent(0, 1));
      given->SetFanAngles(angles->GetComponent(0, 0), angles->GetComponent(0, 1));
      given->SetFanRadii(radii->GetComponent(0, 0), radii->GetComponent(0, 1));
      int rectangle[4];
      for (int i = 0; i < 4; ++i)
      {
        rectangle[i] = static_cast<int>(clip->GetComponent(0, i));
      }
      given->SetClipRectangle(rectangle);
    });
  LACUNA_CHECK_THAT(AreEqual(copied, found), "copied");

  // forgotten again
  filter->SetFanMaskToNoFan();
  filter->Update();
  LACUNA_CHECK_THAT(!filter->GetOutput()->GetFieldData()->HasArray("FanOrigin"), "no fan");
  LACUNA_CHECK_THAT(std::string(filter->GetFanDescription()).empty(), "no description");

  // a new sweep is looked at anew
  filter->SetFanMaskToAutomatic();
  filter->SetInputData(Scan(IsInRectangle));
  filter->SetPixelSamplingToNearest();
  filter->Update();
  LACUNA_CHECK_THAT(
    std::string(filter->GetFanDescription()) == "ClipRectangle=30,10,101,90", "a linear probe");
  LACUNA_CHECK_THAT(GetRange(filter->GetOutput())[0] > 0, "nothing black");
  // and each input for itself
  filter->AddInputData(stack);
  filter->Update();
  radii = lacuna::FieldData::Get(filter->GetOutput(), "FanRadii", 2, 2);
  LACUNA_CHECK_THAT(radii->GetComponent(0, 1) == 0 && radii->GetComponent(1, 1) > 50, "two inputs");
}

void TestPiecesAndFrame()
{
  const auto configure = [](vtkLacunaSweptVolume* filter)
  {
    filter->SetFanMaskToAutomatic();
    filter->SetOutputFrameToPrincipal();
  };
  const auto stack = Scan(IsInSector);
  const auto whole = Reconstruct(stack, configure);
  for (int piece = 0; piece < 2; ++piece)
  {
    vtkNew<vtkLacunaSweptVolume> filter;
    filter->SetInputData(stack);
    filter->SetOutputSpacing(0.5, 0.5, 0.5);
    configure(filter);
    filter->UpdatePiece(piece, 2, 0);
    const int* e = filter->GetOutput()->GetExtent();
    bool same = filter->GetOutput()->GetNumberOfPoints() > 0;
    for (int k = e[4]; k <= e[5]; ++k)
    {
      for (int j = e[2]; j <= e[3]; ++j)
      {
        for (int i = e[0]; i <= e[1]; ++i)
        {
          same = same &&
            GetValue(filter->GetOutput(), "Intensity", i, j, k) ==
              GetValue(whole, "Intensity", i, j, k);
        }
      }
    }
    LACUNA_CHECK_THAT(same, "piece");
  }
}

// At the beginning of a replay there is no fan to be seen.
void TestReplay()
{
  const auto scan = [](bool (*inside)(double, double))
  {
    return [=](int shown)
    {
      const auto stack = Scan(inside);
      std::fill_n(
        static_cast<unsigned char*>(stack->GetScalarPointer(0, 0, 0)) + Width * Height * shown,
        Width * Height * (Slices - shown), static_cast<unsigned char>(0));
      vtkDataArray* status = stack->GetFieldData()->GetArray("SliceStatus");
      for (int k = shown; k < Slices; ++k)
      {
        status->SetTuple1(k, lacuna::TrackedSlices::ImageInvalid);
      }
      return stack;
    };
  };
  vtkNew<Replay> replay;
  replay->Show = scan(IsInSector);
  vtkNew<vtkLacunaSweptVolume> filter;
  filter->SetInputConnection(replay->GetOutputPort());
  filter->SetOutputSpacing(0.5, 0.5, 0.5);
  filter->SetFanMaskToAutomatic();
  const auto messages = lacunaCheck::Watch(filter);
  int seen = 0;
  for (int k = 0; k < Slices; ++k)
  {
    filter->UpdateTimeStep(k);
    vtkImageData* volume = filter->GetOutput();
    int whole[6];
    filter->GetOutputInformation(0)->Get(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), whole);
    LACUNA_CHECK_THAT(volume->GetNumberOfPoints() > 0 &&
        std::equal(whole, whole + 6, volume->GetExtent()) &&
        volume->GetPointData()->GetNumberOfArrays() == 3,
      "a volume as announced at time " + std::to_string(k));
    vtkDataArray* radii = volume->GetFieldData()->GetArray("FanRadii");
    LACUNA_CHECK(radii && radii->GetNumberOfTuples() == 1);
    double range[2];
    volume->GetPointData()->GetArray("Contributions")->GetRange(range);
    if (k == 0)
    {
      LACUNA_CHECK_THAT(range[1] == 0, "nothing is seen in one slice");
      LACUNA_CHECK(radii && radii->GetComponent(0, 1) == 0);
      LACUNA_CHECK(filter->GetFanDescription() == std::string("not seen yet"));
    }
    seen += range[1] > 0 ? 1 : 0;
  }
  LACUNA_CHECK_THAT(seen > 0, "the fan is seen at last");
  LACUNA_CHECK_THAT(messages->Errors.empty() && messages->Warnings.empty(), messages->Errors);
  double bounds[6];
  filter->GetOutput()->GetBounds(bounds);
  LACUNA_CHECK_THAT(AreEqual(filter->GetOutput(),
                      Reconstruct(Scan(IsInSector),
                        [&](auto* f)
                        {
                          f->SetFanMaskToAutomatic();
                          f->SetOutputBounds(bounds);
                        })),
    "the end of the replay");
  // a fan that never comes to be seen is an error of the whole sweep
  replay->Show = scan([](double x, double y) { return std::hypot(x - 70, y - 60) < 45; });
  replay->Modified();
  vtkNew<vtkLacunaSweptVolume> blind;
  blind->SetInputConnection(replay->GetOutputPort());
  blind->SetFanMaskToAutomatic();
  const auto refused = lacunaCheck::Watch(blind);
  blind->UpdateTimeStep(Slices - 1);
  LACUNA_CHECK_CONTAINS(refused->Errors, "the fan cannot be found for certain");
}

void TestErrors()
{
  const auto stack = Scan(IsInSector);
  const auto with = [&](const Configure& configure) { return GetError(stack, configure); };
  LACUNA_CHECK_CONTAINS(with(
                          [](auto* f)
                          {
                            SetGivenFan(f);
                            f->SetFanAngles(30, -30);
                          }),
    "the fan's angles are 30 and -30 degrees");
  LACUNA_CHECK_CONTAINS(with([](auto* f) { f->SetFanRadii(50, 20); }), "the fan's radii");
  LACUNA_CHECK_CONTAINS(with(
                          [](auto* f)
                          {
                            SetGivenFan(f);
                            f->SetFanOrigin(5000, 0);
                          }),
    "no pixel of the 160 x 120 image lies in the fan");
  LACUNA_CHECK_CONTAINS(with(
                          [](auto* f)
                          {
                            SetGivenFan(f);
                            f->SetClipRectangle(0, 110, 10, 0);
                          }),
    "lies in the fan");
  const auto blob = Scan([](double x, double y) { return std::hypot(x - 70, y - 60) < 45; });
  const std::string unsure = GetError(blob, [](auto* f) { f->SetFanMaskToAutomatic(); });
  LACUNA_CHECK_CONTAINS(unsure, "the fan cannot be found for certain");
  LACUNA_CHECK_CONTAINS(unsure, "FanOrigin");
}
}

int TestSweptVolumeFan(int, char*[])
{
  TestGiven();
  TestAutomatic();
  TestPiecesAndFrame();
  TestReplay();
  TestErrors();
  return lacunaCheck::Result();
}
