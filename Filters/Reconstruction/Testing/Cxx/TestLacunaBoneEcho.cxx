// SPDX-License-Identifier: BSD-3-Clause
/// vtkLacunaBoneEcho puts what it finds at the place of the pixels, whatever part of the slices is given or looked at.
#include "lacunaCheck.h"
#include "lacunaTrackedSlices.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkLacunaBoneEcho.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"

#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <vector>

namespace
{
constexpr int Width = 120, Height = 200, Slices = 5;
constexpr double Pixel = 0.2;      // mm
constexpr int Left = 30, Top = 10; // of what the probe sees

// Rows of the bone; none outside of columns 60 to 99.
double GetBone(int column)
{
  return column >= 60 && column < 100 ? 70 + 0.25 * (column - 60) : 1e9;
}

// Black around what the probe sees. From the slice and the column on, extents begin elsewhere than at 0.
vtkSmartPointer<vtkImageData> Scan(
  int firstSlice, int firstColumn, const std::vector<unsigned char>& status)
{
  auto stack = vtkSmartPointer<vtkImageData>::New();
  stack->SetExtent(firstColumn, Width - 1, 0, Height - 1, firstSlice, Slices - 1);
  stack->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
  stack->GetPointData()->GetScalars()->SetName("Intensity");
  std::mt19937 random(11);
  std::uniform_real_distribution<double> speckle(0.5, 1.5);
  std::vector<lacuna::Matrix4> poses;
  std::vector<double> times;
  std::vector<int> frames;
  for (int k = 0; k < Slices; ++k)
  {
    poses.push_back(lacuna::Matrix4::Translation({ 3, 4, 2.0 * k }) *
      lacuna::Matrix4::Scaling({ Pixel, Pixel, 1 }));
    times.push_back(k);
    frames.push_back(k);
    for (int j = 0; j < Height; ++j)
    {
      for (int i = 0; i < Width; ++i)
      {
        const double bone = GetBone(i);
        const double noise = speckle(random);
        double level = j > bone ? 4 * noise : 120 * noise * std::exp(-0.008 * j);
        level += 160 * std::exp(-std::pow((j - bone) / 2.5, 2));
        level = i < Left || j < Top ? 0 : level;
        if (k >= firstSlice && i >= firstColumn)
        {
          stack->SetScalarComponentFromDouble(i, j, k, 0, std::min(255.0, level));
        }
      }
    }
  }
  lacuna::TrackedSlices::Write(stack, poses, times, status, frames);
  return stack;
}

double GetBoneEcho(vtkImageData* output, int i, int j, int k)
{
  int ijk[3] = { i, j, k };
  return output->GetPointData()->GetArray("BoneEcho")->GetTuple1(output->ComputePointId(ijk));
}

void CheckPlace(vtkImageData* output, int slice, const std::string& what)
{
  for (const int column : { 66, 80, 94 })
  {
    const int row = static_cast<int>(std::lround(GetBone(column)));
    LACUNA_CHECK_THAT(
      GetBoneEcho(output, column, row - 5, slice) < 0.4, what + ": in front of the bone");
    LACUNA_CHECK_THAT(
      std::abs(GetBoneEcho(output, column, row, slice) - 0.5) < 0.15, what + ": at the bone");
    LACUNA_CHECK_THAT(
      GetBoneEcho(output, column, row + 8, slice) > 0.7, what + ": behind its surface");
    LACUNA_CHECK_THAT(GetBoneEcho(output, column, row + 45, slice) == 0, what + ": far behind it");
  }
  LACUNA_CHECK_THAT(GetBoneEcho(output, 40, 80, slice) == 0, what + ": beside it");
}

struct Outcome
{
  vtkSmartPointer<vtkImageData> Output;
  std::string Errors, Warnings;
};

Outcome Run(vtkImageData* stack, const std::function<void(vtkLacunaBoneEcho*)>& configure = {})
{
  vtkNew<vtkLacunaBoneEcho> filter;
  filter->SetInputData(stack);
  filter->SetMinimumArea(20);
  if (configure)
  {
    configure(filter);
  }
  const auto messages = lacunaCheck::Watch(filter);
  filter->Update();
  Outcome outcome;
  outcome.Output = vtkSmartPointer<vtkImageData>::New();
  outcome.Output->ShallowCopy(filter->GetOutput());
  outcome.Errors = messages->Errors;
  outcome.Warnings = messages->Warnings;
  return outcome;
}
}

int TestLacunaBoneEcho(int, char*[])
{
  const std::vector<unsigned char> valid(Slices, 0);
  const Outcome whole = Run(Scan(0, 0, valid));
  CheckPlace(whole.Output, 2, "whole " + whole.Errors);
  LACUNA_CHECK_THAT(whole.Errors.empty() && whole.Warnings.empty(), whole.Errors + whole.Warnings);
  LACUNA_CHECK_THAT(whole.Output->GetPointData()->GetScalars() ==
      whole.Output->GetPointData()->GetArray("BoneEcho"),
    "the active scalars");
  LACUNA_CHECK_THAT(
    whole.Output->GetPointData()->GetArray("Intensity") != nullptr, "grey levels stay");
  LACUNA_CHECK_THAT(
    whole.Output->GetFieldData()->GetArray("ImageToReference") != nullptr, "and poses");
  // 40 columns of 0.2 mm, less 0.8 mm at both ends, over four steps of 2 mm
  const double area = whole.Output->GetFieldData()->GetArray("BoneArea")->GetTuple1(0);
  LACUNA_CHECK_THAT(area > 6.4 * 8 && area < 9 * 8, "area " + std::to_string(area));

  const Outcome part = Run(Scan(1, 25, valid));
  CheckPlace(part.Output, 2, "part");
  LACUNA_CHECK_THAT(
    part.Output->GetExtent()[0] == 25 && part.Output->GetExtent()[4] == 1, "its extent");

  const Outcome clipped = Run(Scan(0, 0, valid),
    [](vtkLacunaBoneEcho* filter) { filter->SetClipRectangle(Left, Top, 0, 0); });
  CheckPlace(clipped.Output, 3, "clipped");
  const Outcome found = Run(
    Scan(0, 0, valid), [](vtkLacunaBoneEcho* filter) { filter->SetClipRectangle(70, Top, 20, 0); });
  LACUNA_CHECK_THAT(GetBoneEcho(found.Output, 66, 80, 2) == 0, "outside of the clip");
  LACUNA_CHECK_THAT(GetBoneEcho(found.Output, 80, 83, 2) > 0.5, "inside of it");

  // a slice that is left out has none
  std::vector<unsigned char> status = valid;
  status[2] = lacuna::TrackedSlices::TooFast;
  const Outcome flagged = Run(Scan(0, 0, status));
  CheckPlace(flagged.Output, 1, "flagged");
  CheckPlace(flagged.Output, 3, "flagged");
  LACUNA_CHECK_THAT(
    GetBoneEcho(flagged.Output, 80, 83, 2) == 0, "nothing in a slice that is left out");
  CheckPlace(
    Run(Scan(0, 0, status), [](vtkLacunaBoneEcho* filter) { filter->SetUseTooFast(true); }).Output,
    2, "taken by choice");

  // what is wrong is said
  const auto error = [&](const std::function<void(vtkLacunaBoneEcho*)>& configure)
  { return Run(Scan(0, 0, valid), configure).Errors; };
  const auto contains = [](const std::string& text, const char* part)
  { return text.find(part) != std::string::npos; };
  LACUNA_CHECK_THAT(
    contains(error([](auto* filter) { filter->SetThickness(0); }), "Thickness is 0"), "thickness");
  LACUNA_CHECK_THAT(contains(error([](auto* filter) { filter->SetMinimumConfidence(2); }),
                      "MinimumConfidence is 2"),
    "confidence");
  LACUNA_CHECK_THAT(
    contains(
      Run(Scan(0, 0, std::vector<unsigned char>(Slices, lacuna::TrackedSlices::ImageInvalid)))
        .Errors,
      "no slice is left to look at"),
    "no slice");
  const std::string none =
    Run(Scan(0, 0, valid), [](auto* filter) { filter->SetMinimumArea(1e4); }).Warnings;
  LACUNA_CHECK_THAT(contains(none, "no bone was found"), none);
  return lacunaCheck::Result();
}
