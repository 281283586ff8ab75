// SPDX-License-Identifier: BSD-3-Clause
// Many noisy points become an image. Some of them lie on its grid, so that the image itself shows
// that they are met; elsewhere it stays near the function that the noise was added to. Run with a
// number, the test takes so many points in space without noise (a million is its soak).
#include "lacunaCheck.h"
#include "lacunaProcessMemory.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkLacunaRBFInterpolator.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <random>
#include <sstream>
#include <utility>
#include <vector>

namespace
{
constexpr double Edge = 64; // mm, of the square or cube, and of the grid

double Wave(const double* x)
{
  return std::sin(x[0] / 9) + std::cos(x[1] / 12 + x[2] / 15) * std::cos(x[2] / 20);
}

struct Scatter
{
  vtkNew<vtkPolyData> Data;
  vtkNew<vtkDoubleArray> Values;
  std::vector<vtkIdType> OnGrid; // points of the grid of 1 mm that the first points lie on

  Scatter(vtkIdType count, bool flat, double limit)
  {
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> place(0, Edge);
    std::uniform_real_distribution<double> noise(-1, 1);
    const auto size = static_cast<vtkIdType>(Edge) + 1;
    const vtkIdType layers = flat ? 1 : size;
    // every 7th point of the grid, its corners among them, so that it has the points' bounds
    for (vtkIdType i = 0; i < size * size * layers; ++i)
    {
      const vtkIdType last = size * size * layers - 1;
      if (i % 7 == 0 || i == size - 1 || i == size * (size - 1) || i == last)
      {
        this->OnGrid.push_back(i);
      }
    }
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    this->Values->SetName("Wave");
    for (vtkIdType k = 0; k < count; ++k)
    {
      double x[3] = { place(random), place(random), flat ? 20 : place(random) };
      if (k < static_cast<vtkIdType>(this->OnGrid.size()))
      {
        const vtkIdType i = this->OnGrid[k];
        x[0] = static_cast<double>(i % size);
        x[1] = static_cast<double>(i / size % size);
        x[2] = flat ? 20 : static_cast<double>(i / (size * size));
      }
      points->InsertNextPoint(x);
      this->Values->InsertNextValue(Wave(x) + limit * noise(random));
    }
    this->Data->SetPoints(points);
    this->Data->GetPointData()->SetScalars(this->Values);
  }
};

double GetField(vtkImageData* image, const char* name)
{
  vtkDataArray* array = image->GetFieldData()->GetArray(name);
  return array ? array->GetComponent(0, 0) : std::nan("");
}

void Check(vtkIdType count, bool flat, double accuracy, double noise)
{
  const Scatter scatter(count, flat, noise);
  vtkNew<vtkLacunaRBFInterpolator> filter;
  const auto messages = lacunaCheck::Watch(filter);
  filter->SetInputData(scatter.Data);
  filter->SetKernel(flat ? lacuna::RadialKernel::ThinPlate : lacuna::RadialKernel::Linear);
  filter->SetAccuracy(accuracy);
  filter->SetOutputSpacing(1, 1, 1);
  filter->Update();
  LACUNA_CHECK_THAT(messages->Errors.empty(), messages->Errors);
  LACUNA_CHECK_THAT(messages->Warnings.empty(), messages->Warnings);
  vtkImageData* image = filter->GetOutput();
  const auto size = static_cast<vtkIdType>(Edge) + 1;
  LACUNA_CHECK(image->GetNumberOfPoints() == size * size * (flat ? 1 : size));
  vtkDataArray* values = image->GetPointData()->GetArray("Wave");
  if (!values || image->GetNumberOfPoints() < size * size)
  {
    lacunaCheck::Fail(__FILE__, __LINE__, "no image");
    return;
  }
  LACUNA_CHECK(GetField(image, "NodeCount") == static_cast<double>(count));
  LACUNA_CHECK(GetField(image, "CenterCount") == static_cast<double>(count));
  LACUNA_CHECK(GetField(image, "Iterations") > 0);
  double ends[2];
  scatter.Values->GetRange(ends);
  const double allowed = accuracy * (ends[1] - ends[0]);
  LACUNA_CHECK(GetField(image, "Residual") <= allowed);
  double missed = 0;
  for (std::size_t k = 0; k < scatter.OnGrid.size(); ++k)
  {
    missed = std::max(missed,
      std::abs(values->GetComponent(scatter.OnGrid[k], 0) -
        scatter.Values->GetValue(static_cast<vtkIdType>(k))));
  }
  // the fit may miss a value by so much, and the image the fit
  LACUNA_CHECK(missed <= 2 * allowed);
  double sum = 0;
  double worst = 0;
  for (vtkIdType i = 0; i < image->GetNumberOfPoints(); ++i)
  {
    double x[3];
    image->GetPoint(i, x);
    const double away = values->GetComponent(i, 0) - Wave(x);
    sum += away * away;
    worst = std::max(worst, std::abs(away));
  }
  const double rms = std::sqrt(sum / static_cast<double>(image->GetNumberOfPoints()));
  std::cout << count << (flat ? " points in a plane: " : " points in space: ")
            << GetField(image, "Iterations") << " iterations, values missed by " << missed << " of "
            << 2 * allowed << ", from the function without noise RMS " << rms << ", largest "
            << worst << "; memory of the process up to " << lacuna::GetProcessMemory("VmHWM") / 1e6
            << " MB" << std::endl;
  // Between points it is a mean of their noise (RMS 0.58 of its limit), but two points that nearly
  // touch and differ make it steep there.
  LACUNA_CHECK(rms < 0.7 * noise + allowed);
  LACUNA_CHECK(worst < 10 * std::max(noise, 0.01));
}
}

int TestRBFInterpolatorLarge(int argc, char* argv[])
{
  if (argc > 1)
  {
    Check(std::atoll(argv[1]), false, 1e-3, 0);
    LACUNA_CHECK(lacuna::GetProcessMemory("VmHWM") < 8e9);
    return lacunaCheck::Result();
  }
  Check(30000, true, 1e-4, 0.05);
  Check(50000, false, 1e-3, 0.05); // more than are on the grid
  return lacunaCheck::Result();
}
