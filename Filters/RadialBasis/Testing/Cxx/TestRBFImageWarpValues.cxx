// SPDX-License-Identifier: BSD-3-Clause
// Where image warps take their grey levels from: against VTK's thin plate spline, against equations
// solved here, and against maps and pictures that are known everywhere.
#include "RBFTestWarps.h"
#include "lacunaCheck.h"
#include "vtkFieldData.h"
#include "vtkLacunaRBFImageWarp.h"
#include "vtkMath.h"
#include "vtkThinPlateSplineTransform.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iostream>
#include <string>
#include <utility>
#include <vector>

namespace
{
using namespace RBFTestWarps;

void CompareWithVTK(int layers, int kernel)
{
  const vtkSmartPointer<vtkImageData> image = MakeImage(layers);
  vtkNew<vtkPolyData> landmarks;
  vtkNew<vtkPolyData> targets;
  MakeLandmarks(image, 25, landmarks, targets);
  vtkNew<vtkLacunaRBFImageWarp> warp;
  warp->SetInputData(0, image);
  warp->SetInputData(1, landmarks);
  warp->SetInputData(2, targets);
  warp->SetKernel(kernel);
  warp->SetOutsideValue(-1000);
  warp->Update();
  vtkImageData* output = warp->GetOutput();
  LACUNA_CHECK(output->GetNumberOfPoints() == image->GetNumberOfPoints());

  vtkNew<vtkThinPlateSplineTransform> back;
  back->SetSourceLandmarks(targets->GetPoints());
  back->SetTargetLandmarks(landmarks->GetPoints());
  if (kernel == vtkLacunaRBFImageWarp::Linear)
  {
    back->SetBasisToR();
  }
  else
  {
    back->SetBasisToR2LogR();
  }
  vtkDataArray* place = output->GetPointData()->GetArray("Place");
  vtkDataArray* valid = output->GetPointData()->GetArray("vtkValidPointMask");
  LACUNA_CHECK(place && valid);
  double worst = 0;
  vtkIdType inside = 0;
  for (vtkIdType i = 0; i < output->GetNumberOfPoints(); ++i)
  {
    double x[3];
    output->GetPoint(i, x);
    double expected[3];
    back->TransformPoint(x, expected);
    if (valid->GetComponent(i, 0) != 0)
    {
      ++inside;
      worst =
        std::max(worst, std::sqrt(vtkMath::Distance2BetweenPoints(expected, place->GetTuple3(i))));
    }
    else
    {
      LACUNA_CHECK(place->GetComponent(i, 1) == -1000);
    }
  }
  // 0.01 voxels
  if (!(worst < 0.015))
  {
    lacunaCheck::Fail(__FILE__, __LINE__, "differs from VTK by " + std::to_string(worst));
  }
  LACUNA_CHECK(inside > image->GetNumberOfPoints() / 2);
  LACUNA_CHECK(inside < image->GetNumberOfPoints());
  LACUNA_CHECK(output->GetFieldData()->GetArray("NodeCount")->GetComponent(0, 0) == 25);
  LACUNA_CHECK(output->GetFieldData()->GetArray("FoldedFraction")->GetComponent(0, 0) == 0);
}

// A shift by whole voxels moves labels, of their type, the way the landmarks say.
void CheckShift()
{
  vtkNew<vtkImageData> image;
  image->SetDimensions(20, 15, 1);
  image->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
  for (vtkIdType i = 0; i < image->GetNumberOfPoints(); ++i)
  {
    image->GetPointData()->GetScalars()->SetComponent(i, 0, static_cast<double>(i % 251));
  }
  vtkNew<vtkPolyData> landmarks;
  vtkNew<vtkPolyData> targets;
  vtkNew<vtkPoints> from;
  vtkNew<vtkPoints> to;
  const double places[4][2] = { { 2, 2 }, { 15, 3 }, { 4, 12 }, { 14, 11 } };
  for (const auto& p : places)
  {
    from->InsertNextPoint(p[0], p[1], 0);
    to->InsertNextPoint(p[0] + 3, p[1] - 1, 77); // z does not count
  }
  landmarks->SetPoints(from);
  targets->SetPoints(to);
  vtkNew<vtkLacunaRBFImageWarp> warp;
  warp->SetInputData(0, image);
  warp->SetInputData(1, landmarks);
  warp->SetInputData(2, targets);
  warp->SetInterpolation(vtkLacunaRBFImageWarp::Nearest);
  warp->SetOutsideValue(300); // more than the type has
  warp->Update();
  vtkImageData* output = warp->GetOutput();
  LACUNA_CHECK(output->GetScalarType() == VTK_UNSIGNED_CHAR);
  for (int j = 0; j < 15; ++j)
  {
    for (int i = 0; i < 20; ++i)
    {
      const bool inside = i >= 3 && j <= 13;
      LACUNA_CHECK(output->GetScalarComponentAsDouble(i, j, 0, 0) ==
        (inside ? image->GetScalarComponentAsDouble(i - 3, j + 1, 0, 0) : 255));
    }
  }
}

// of places by VTK's interpolators, voxels along each axis
constexpr double Rounding = 1.0 / 131072;

using Point = std::array<double, 3>;

std::vector<Point> GetPoints(vtkPolyData* data)
{
  std::vector<Point> points(static_cast<std::size_t>(data->GetNumberOfPoints()));
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    data->GetPoint(static_cast<vtkIdType>(i), points[i].data());
  }
  return points;
}

// The radial basis function through values at nodes, by Gaussian elimination of its equations as
// they stand in the books, in world coordinates.
class DenseFunction
{
public:
  DenseFunction(std::vector<Point> nodes, const std::vector<Point>& values, int kernel, bool flat)
    : Nodes(std::move(nodes))
    , Kernel(kernel)
    , Flat(flat)
  {
    const std::size_t n = this->Nodes.size();
    const std::size_t size = n + this->GetTerms(this->Nodes[0]).size();
    std::vector<std::vector<double>> rows(size, std::vector<double>(size + 3));
    for (std::size_t i = 0; i < n; ++i)
    {
      for (std::size_t k = 0; k < n; ++k)
      {
        rows[i][k] = this->GetPhi(this->Nodes[i], this->Nodes[k]);
      }
      const std::vector<double> terms = this->GetTerms(this->Nodes[i]);
      for (std::size_t k = 0; k < terms.size(); ++k)
      {
        rows[i][n + k] = rows[n + k][i] = terms[k];
      }
      std::copy(values[i].begin(), values[i].end(), rows[i].begin() + static_cast<long>(size));
    }
    for (std::size_t column = 0; column < size; ++column)
    {
      std::size_t pivot = column;
      for (std::size_t i = column; i < size; ++i)
      {
        pivot = std::abs(rows[i][column]) > std::abs(rows[pivot][column]) ? i : pivot;
      }
      std::swap(rows[column], rows[pivot]);
      for (std::size_t i = 0; i < size; ++i)
      {
        const double factor = i == column ? 0 : rows[i][column] / rows[column][column];
        for (std::size_t k = column; factor != 0 && k < size + 3; ++k)
        {
          rows[i][k] -= factor * rows[column][k];
        }
      }
    }
    for (std::size_t i = 0; i < size; ++i)
    {
      this->Weights.push_back({ rows[i][size] / rows[i][i], rows[i][size + 1] / rows[i][i],
        rows[i][size + 2] / rows[i][i] });
    }
  }

  Point operator()(const Point& x) const
  {
    std::vector<double> factors;
    for (const Point& node : this->Nodes)
    {
      factors.push_back(this->GetPhi(x, node));
    }
    const std::vector<double> terms = this->GetTerms(x);
    factors.insert(factors.end(), terms.begin(), terms.end());
    Point sum{};
    for (std::size_t i = 0; i < factors.size(); ++i)
    {
      for (std::size_t c = 0; c < 3; ++c)
      {
        sum[c] += factors[i] * this->Weights[i][c];
      }
    }
    return sum;
  }

private:
  double GetPhi(const Point& a, const Point& b) const
  {
    const double r = std::hypot(a[0] - b[0], a[1] - b[1], this->Flat ? 0 : a[2] - b[2]);
    switch (this->Kernel)
    {
      case vtkLacunaRBFImageWarp::ThinPlate:
        return r > 0 ? r * r * std::log(r) : 0;
      case vtkLacunaRBFImageWarp::Linear:
        return r;
      case vtkLacunaRBFImageWarp::Triharmonic:
        return r > 0 ? r * r * r * r * std::log(r) : 0;
      default:
        return r * r * r;
    }
  }
  // about the middle of the image, in tens of mm
  std::vector<double> GetTerms(const Point& p) const
  {
    const double x = (p[0] - 30) / 10;
    const double y = (p[1] - 25) / 10;
    const double z = this->Flat ? 0 : (p[2] - 40) / 10;
    std::vector<double> terms{ 1, x, y };
    if (!this->Flat)
    {
      terms.push_back(z);
    }
    if (this->Kernel == vtkLacunaRBFImageWarp::Triharmonic)
    {
      terms.insert(terms.end(), { x * x, x * y, y * y });
      if (!this->Flat)
      {
        terms.insert(terms.end(), { x * z, y * z, z * z });
      }
    }
    return terms;
  }

  std::vector<Point> Nodes;
  int Kernel;
  bool Flat;
  std::vector<Point> Weights;
};

// Each kernel's positions, where the image shows its own places.
void CompareWithDenseSolution(int layers, int kernel)
{
  const vtkSmartPointer<vtkImageData> image = MakeImage(layers);
  vtkNew<vtkPolyData> landmarks;
  vtkNew<vtkPolyData> targets;
  MakeLandmarks(image, 40, landmarks, targets, 0.3);
  vtkNew<vtkLacunaRBFImageWarp> warp;
  warp->SetInputData(0, image);
  warp->SetInputData(1, landmarks);
  warp->SetInputData(2, targets);
  warp->SetKernel(kernel);
  const double accuracy = layers == 1 ? 1e-6 : 1e-4;
  warp->SetAccuracy(accuracy);
  warp->Update();
  const DenseFunction back(GetPoints(targets), GetPoints(landmarks), kernel, layers == 1);
  vtkImageData* output = warp->GetOutput();
  vtkDataArray* place = output->GetPointData()->GetArray("Place");
  vtkDataArray* valid = output->GetPointData()->GetArray("vtkValidPointMask");
  vtkIdType inside = 0;
  double worst = 0;
  for (vtkIdType i = 0; i < output->GetNumberOfPoints(); ++i)
  {
    if (valid->GetComponent(i, 0) != 0)
    {
      Point x{};
      output->GetPoint(i, x.data());
      const Point expected = back(x);
      ++inside;
      worst = std::max(
        worst, std::sqrt(vtkMath::Distance2BetweenPoints(expected.data(), place->GetTuple3(i))));
    }
  }
  std::cout << "kernel " << kernel << ", " << layers << " layers: differs by " << worst << " mm\n";
  LACUNA_CHECK(worst < accuracy * 1.5 + Rounding * std::hypot(1.5, 2, 2.5));
  LACUNA_CHECK(inside > output->GetNumberOfPoints() / 3);
}

// A picture of a formula, 60 x 50 pixels of 0.8 x 0.6 mm.
vtkSmartPointer<vtkImageData> MakePicture(const std::function<double(double, double)>& formula)
{
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->SetExtent(3, 62, -5, 44, 7, 7);
  image->SetSpacing(0.8, 0.6, 1);
  image->SetOrigin(-4, 12, 2);
  vtkNew<vtkDoubleArray> grey;
  grey->SetName("Grey");
  for (vtkIdType i = 0; i < image->GetNumberOfPoints(); ++i)
  {
    const double* p = image->GetPoint(i);
    grey->InsertNextValue(formula(p[0], p[1]));
  }
  image->GetPointData()->SetScalars(grey);
  return image;
}

struct Deformation
{
  std::function<std::array<double, 2>(double, double)> Back; // from target to landmark
  int Count;                                                 // of landmarks along each edge
};

struct Difference
{
  double Largest = 0;
  vtkIdType Inside = 0;
};

// How far the warped picture is from the formula at the places that the deformation says.
Difference WarpPicture(const std::function<double(double, double)>& formula,
  const Deformation& deformation, int interpolation, int kernel)
{
  const vtkSmartPointer<vtkImageData> image = MakePicture(formula);
  double bounds[6];
  image->GetBounds(bounds);
  vtkNew<vtkPolyData> landmarks;
  vtkNew<vtkPolyData> targets;
  for (vtkPolyData* points : { landmarks.Get(), targets.Get() })
  {
    points->SetPoints(vtkNew<vtkPoints>());
    points->GetPoints()->SetDataTypeToDouble();
  }
  for (int j = 0; j < deformation.Count; ++j)
  {
    for (int i = 0; i < deformation.Count; ++i)
    {
      const double x = bounds[0] + (bounds[1] - bounds[0]) * i / (deformation.Count - 1);
      const double y = bounds[2] + (bounds[3] - bounds[2]) * j / (deformation.Count - 1);
      const std::array<double, 2> from = deformation.Back(x, y);
      landmarks->GetPoints()->InsertNextPoint(from[0], from[1], -50);
      targets->GetPoints()->InsertNextPoint(x, y, 90);
    }
  }
  vtkNew<vtkLacunaRBFImageWarp> warp;
  const auto messages = lacunaCheck::Watch(warp);
  warp->SetInputData(0, image);
  warp->SetInputData(1, landmarks);
  warp->SetInputData(2, targets);
  warp->SetInterpolation(interpolation);
  warp->SetKernel(kernel);
  warp->SetAccuracy(1e-5);
  warp->Update();
  LACUNA_CHECK_THAT(messages->Errors.empty(), messages->Errors);
  LACUNA_CHECK_THAT(messages->Warnings.empty(), messages->Warnings);
  vtkImageData* output = warp->GetOutput();
  vtkDataArray* grey = output->GetPointData()->GetScalars();
  vtkDataArray* valid = output->GetPointData()->GetArray("vtkValidPointMask");
  Difference difference;
  for (vtkIdType i = 0; i < output->GetNumberOfPoints(); ++i)
  {
    const double* p = output->GetPoint(i);
    const std::array<double, 2> from = deformation.Back(p[0], p[1]);
    // a margin: one pixel for cubic interpolation, which has fewer neighbours at the border
    const bool within = from[0] > bounds[0] + 0.8 && from[0] < bounds[1] - 0.8 &&
      from[1] > bounds[2] + 0.6 && from[1] < bounds[3] - 0.6;
    if (within)
    {
      LACUNA_CHECK(valid->GetComponent(i, 0) != 0);
      ++difference.Inside;
      difference.Largest = std::max(
        difference.Largest, std::abs(grey->GetComponent(i, 0) - formula(from[0], from[1])));
    }
  }
  return difference;
}

double Wave(double x, double y)
{
  return std::sin(x / 2) * std::cos(y / 3);
}

// Linear interpolation misses h^2 / 8 times the second derivatives of Wave, Keys' cubic one
// sqrt(3) / 108 h^3 times the third ones and a little of the fourth, 1.25 times as much in the second
// axis.
constexpr double LinearBound = (0.8 * 0.8 / 4 + 0.6 * 0.6 / 9) / 8;
constexpr double CubicBound = 1.25 *
  (0.0161 * (0.4 * 0.4 * 0.4 + 0.2 * 0.2 * 0.2) +
    0.028 * (0.4 * 0.4 * 0.4 * 0.4 + 0.2 * 0.2 * 0.2 * 0.2));

// Shifts by fractions of a pixel, each axis another one: interpolation is exact for bilinear
// (Linear) and biquadratic pictures (Cubic), and of known error for others.
void CheckFractionalShifts()
{
  // rising by less than 5 a pixel
  const auto bilinear = [](double x, double y) { return 3 + x - 2 * y + 0.05 * x * y; };
  const auto quadratic = [](double x, double y)
  { return 3 + x - 2 * y + 0.05 * x * y - 0.03 * x * x + 0.001 * x * y * y; };
  using Warp = vtkLacunaRBFImageWarp;
  for (const std::array<double, 2>& shift :
    { std::array<double, 2>{ 0.3, -0.23 }, { 2.6, 1.1 }, { -3.21, 4.444 } })
  {
    const Deformation moved{ [&](double x, double y) {
                              return std::array<double, 2>{ x - shift[0], y - shift[1] };
                            },
      3 };
    for (const int kernel : { Warp::ThinPlate, Warp::Linear, Warp::Triharmonic, Warp::Cubic })
    {
      const Difference exact = WarpPicture(bilinear, moved, Warp::LinearInterpolation, kernel);
      LACUNA_CHECK(exact.Largest < 2 * 5 * Rounding && exact.Inside > 2000);
      const Difference smooth = WarpPicture(quadratic, moved, Warp::CubicInterpolation, kernel);
      LACUNA_CHECK(smooth.Largest < 2 * 5 * Rounding);
    }
    const Difference linear = WarpPicture(Wave, moved, Warp::LinearInterpolation, Warp::ThinPlate);
    const Difference cubic = WarpPicture(Wave, moved, Warp::CubicInterpolation, Warp::ThinPlate);
    std::cout << "shift: linear " << linear.Largest << " of " << LinearBound << ", cubic "
              << cubic.Largest << " of " << CubicBound << "\n";
    LACUNA_CHECK(linear.Largest < LinearBound);
    LACUNA_CHECK(cubic.Largest < CubicBound);
  }
}

// A turn with a shear, which no kernel may change.
void CheckAffineMap()
{
  const Deformation affine{ [](double x, double y)
    {
      return std::array<double, 2>{ 22 + 0.9 * (x - 22) - 0.35 * (y - 24) + 1.27,
        24 + 0.3 * (x - 22) + 0.8 * (y - 24) - 0.61 };
    },
    3 };
  using Warp = vtkLacunaRBFImageWarp;
  for (const int kernel : { Warp::ThinPlate, Warp::Linear, Warp::Triharmonic, Warp::Cubic })
  {
    const Difference linear = WarpPicture(Wave, affine, Warp::LinearInterpolation, kernel);
    LACUNA_CHECK(linear.Largest < LinearBound && linear.Inside > 1500);
    LACUNA_CHECK(WarpPicture(Wave, affine, Warp::CubicInterpolation, kernel).Largest < CubicBound);
  }
}

// A smooth swirl that is known everywhere: twice as many landmarks each way come much nearer to it.
void CheckSwirl()
{
  Deformation swirl{ [](double x, double y)
    {
      const double angle = 0.3 * std::exp(-(std::pow(x - 24, 2) + std::pow(y - 22, 2)) / 150);
      return std::array<double, 2>{ 24 + std::cos(angle) * (x - 24) - std::sin(angle) * (y - 22),
        22 + std::sin(angle) * (x - 24) + std::cos(angle) * (y - 22) };
    },
    0 };
  using Warp = vtkLacunaRBFImageWarp;
  for (const int kernel : { Warp::ThinPlate, Warp::Linear, Warp::Triharmonic, Warp::Cubic })
  {
    double away[2] = { 0, 0 };
    for (int level = 0; level < 2; ++level)
    {
      swirl.Count = level == 0 ? 9 : 17;
      const auto x = [](double px, double) { return px; };
      const auto y = [](double, double py) { return py; };
      away[level] = std::hypot(WarpPicture(x, swirl, Warp::LinearInterpolation, kernel).Largest,
        WarpPicture(y, swirl, Warp::LinearInterpolation, kernel).Largest);
    }
    const Difference wave = WarpPicture(Wave, swirl, Warp::CubicInterpolation, kernel);
    std::cout << "swirl, kernel " << kernel << ": " << away[0] << " mm with 9 x 9, " << away[1]
              << " mm with 17 x 17 landmarks, grey levels " << wave.Largest << "\n";
    LACUNA_CHECK(away[0] < 0.4);
    LACUNA_CHECK(away[1] < away[0] / (kernel == Warp::Linear ? 1.8 : 3.5));
    LACUNA_CHECK(wave.Largest < CubicBound + away[1] / 2);
  }
}

// Whole numbers are the same in every type that holds them.
void WarpAllTypes()
{
  std::vector<double> expected;
  for (const int type : { VTK_DOUBLE, VTK_FLOAT, VTK_UNSIGNED_CHAR, VTK_SHORT, VTK_INT, VTK_LONG,
         VTK_UNSIGNED_LONG, VTK_LONG_LONG, VTK_UNSIGNED_LONG_LONG, VTK_ID_TYPE })
  {
    const vtkSmartPointer<vtkImageData> image = MakeImage(4);
    vtkNew<vtkPolyData> landmarks;
    vtkNew<vtkPolyData> targets;
    MakeLandmarks(image, 25, landmarks, targets);
    const auto levels = vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(type));
    levels->SetName("Levels");
    levels->SetNumberOfTuples(image->GetNumberOfPoints());
    for (vtkIdType i = 0; i < image->GetNumberOfPoints(); ++i)
    {
      levels->SetTuple1(i, static_cast<double>((7 * i) % 200));
    }
    image->GetPointData()->SetScalars(levels);
    WatchedWarp warp(image, landmarks, targets);
    warp.Filter->SetInterpolation(vtkLacunaRBFImageWarp::Nearest);
    warp.Filter->Update();
    vtkDataArray* warped = warp.Filter->GetOutput()->GetPointData()->GetArray("Levels");
    LACUNA_CHECK_THAT(warped && warped->GetDataType() == type, "the type stays");
    std::vector<double> values;
    for (vtkIdType i = 0; warped && i < warped->GetNumberOfTuples(); ++i)
    {
      values.push_back(warped->GetTuple1(i));
    }
    expected = expected.empty() ? values : expected;
    LACUNA_CHECK_THAT(values == expected, "levels of type " + std::to_string(type));
  }
}
}

int TestRBFImageWarpValues(int, char*[])
{
  WarpAllTypes();
  CompareWithVTK(12, vtkLacunaRBFImageWarp::Linear);
  CompareWithVTK(12, vtkLacunaRBFImageWarp::ThinPlate);
  CompareWithVTK(1, vtkLacunaRBFImageWarp::ThinPlate);
  for (const int layers : { 1, 12 })
  {
    for (int kernel = 0; kernel < 4; ++kernel)
    {
      CompareWithDenseSolution(layers, kernel);
    }
  }
  CheckShift();
  CheckFractionalShifts();
  CheckAffineMap();
  CheckSwirl();
  return lacunaCheck::Result();
}
