// SPDX-License-Identifier: BSD-3-Clause
// Warps by landmarks against VTK's thin plate spline, and errors.
#include "lacunaCheck.h"
#include "vtkCellData.h"
#include "vtkCharArray.h"
#include "vtkDoubleArray.h"
#include "vtkExecutive.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkLacunaRBFImageWarp.h"
#include "vtkMath.h"
#include "vtkMinimalStandardRandomSequence.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkThinPlateSplineTransform.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

namespace
{
constexpr double Origin[3] = { 10, -5, 30 };
constexpr double Spacing[3] = { 1.5, 2, 2.5 };
// turned about z and x: an image of a tilted scanner
const double Direction[9] = { 0.8, -0.6, 0, 0.36, 0.48, -0.8, 0.48, 0.64, 0.6 };

// Grey levels that say which place they belong to: the world coordinates, three components.
vtkSmartPointer<vtkImageData> MakeImage(int layers)
{
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->SetExtent(2, 41, 0, 29, 5, 4 + layers);
  image->SetOrigin(Origin);
  image->SetSpacing(Spacing);
  if (layers > 1)
  {
    image->SetDirectionMatrix(Direction);
  }
  vtkNew<vtkDoubleArray> place;
  place->SetName("Place");
  place->SetNumberOfComponents(3);
  for (vtkIdType i = 0; i < image->GetNumberOfPoints(); ++i)
  {
    place->InsertNextTuple(image->GetPoint(i));
  }
  image->GetPointData()->SetScalars(place);
  return image;
}

double Fraction(double x)
{
  return x - std::floor(x);
}

// Landmarks scattered in the image, and targets some mm away.
void MakeLandmarks(vtkImageData* image, int count, vtkPolyData* landmarks, vtkPolyData* targets)
{
  vtkNew<vtkPoints> from;
  vtkNew<vtkPoints> to;
  from->SetDataTypeToDouble();
  to->SetDataTypeToDouble();
  const int* extent = image->GetExtent();
  for (int i = 1; i <= count; ++i)
  {
    const double index[3] = { extent[0] + (extent[1] - extent[0]) * Fraction(i * 0.7548776662),
      extent[2] + (extent[3] - extent[2]) * Fraction(i * 0.5698402910),
      extent[4] + (extent[5] - extent[4]) * Fraction(i * 0.8191725134) };
    double x[3];
    image->TransformContinuousIndexToPhysicalPoint(index, x);
    from->InsertNextPoint(x);
    x[0] += 2 * std::sin(i);
    x[1] += 3 * std::cos(2.0 * i);
    x[2] += image->GetDimensions()[2] > 1 ? 2 * std::sin(3.0 * i) : 0;
    to->InsertNextPoint(x);
  }
  landmarks->SetPoints(from);
  targets->SetPoints(to);
}

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

// A mask with an invalid block and single voxels, seen from every kind of place between voxels.
vtkSmartPointer<vtkCharArray> MakeMask(vtkImageData* image)
{
  auto mask = vtkSmartPointer<vtkCharArray>::New();
  mask->SetName("vtkValidPointMask");
  for (vtkIdType i = 0; i < image->GetNumberOfPoints(); ++i)
  {
    const vtkIdType column = i % 40;
    const vtkIdType row = i / 40 % 30;
    mask->InsertNextValue((column > 24 && row < 9) || i % 131 == 0 ? 0 : 1);
  }
  return mask;
}

// What is interpolated from an invalid voxel is invalid: just there where NaN in place of the
// invalid grey levels would have spread to.
void CheckMask(int layers, int interpolation, bool still)
{
  const vtkSmartPointer<vtkImageData> image = MakeImage(layers);
  vtkNew<vtkPolyData> landmarks;
  vtkNew<vtkPolyData> targets;
  MakeLandmarks(image, 25, landmarks, targets);
  const auto warp = [&](vtkImageData* input)
  {
    vtkNew<vtkLacunaRBFImageWarp> filter;
    filter->SetInputData(0, input);
    filter->SetInputData(1, landmarks);
    filter->SetInputData(2, still ? landmarks : targets);
    filter->SetInterpolation(interpolation);
    filter->SetOutsideValue(-1000);
    filter->Update();
    auto output = vtkSmartPointer<vtkImageData>::New();
    output->ShallowCopy(filter->GetOutput());
    return output;
  };
  const vtkSmartPointer<vtkCharArray> mask = MakeMask(image);
  const vtkSmartPointer<vtkImageData> unmasked = warp(image);
  vtkNew<vtkImageData> withNaN;
  withNaN->DeepCopy(image);
  vtkDataArray* spoilt = withNaN->GetPointData()->GetScalars();
  for (vtkIdType i = 0; i < mask->GetNumberOfTuples(); ++i)
  {
    if (mask->GetValue(i) == 0)
    {
      spoilt->SetComponent(i, 1, std::nan(""));
    }
  }
  const vtkSmartPointer<vtkImageData> spread = warp(withNaN);
  image->GetPointData()->AddArray(mask);
  vtkNew<vtkDoubleArray> other;
  other->SetName("Other");
  other->SetNumberOfTuples(image->GetNumberOfPoints());
  image->GetPointData()->AddArray(other);
  vtkNew<vtkDoubleArray> cells;
  cells->SetName("Cells");
  cells->SetNumberOfTuples(image->GetNumberOfCells());
  image->GetCellData()->AddArray(cells);
  const vtkSmartPointer<vtkImageData> masked = warp(image);

  LACUNA_CHECK(masked->GetPointData()->GetNumberOfArrays() == 2);
  LACUNA_CHECK(masked->GetCellData()->GetNumberOfArrays() == 0);
  vtkDataArray* valid = masked->GetPointData()->GetArray("vtkValidPointMask");
  vtkDataArray* place = masked->GetPointData()->GetArray("Place");
  vtkIdType lost = 0;
  for (vtkIdType i = 0; i < masked->GetNumberOfPoints(); ++i)
  {
    // VTK's cubic interpolation multiplies NaN by 0 on a voxel: there the mask itself is expected.
    const bool within =
      unmasked->GetPointData()->GetArray("vtkValidPointMask")->GetComponent(i, 0) != 0;
    const bool known = still
      ? mask->GetValue(i) != 0
      : within && !std::isnan(spread->GetPointData()->GetArray("Place")->GetComponent(i, 1));
    lost += within && !known ? 1 : 0;
    LACUNA_CHECK((valid->GetComponent(i, 0) != 0) == known);
    LACUNA_CHECK(place->GetComponent(i, 0) ==
      (known ? unmasked->GetPointData()->GetArray("Place")->GetComponent(i, 0) : -1000));
    LACUNA_CHECK(still ||
      known == (spread->GetPointData()->GetArray("vtkValidPointMask")->GetComponent(i, 0) != 0));
  }
  LACUNA_CHECK(lost > masked->GetNumberOfPoints() / 20);
  LACUNA_CHECK(lost < masked->GetNumberOfPoints() * 3 / 4);
}

struct Case
{
  const char* Name;
  std::function<void(vtkPolyData*, vtkPolyData*, vtkLacunaRBFImageWarp*)> Spoil;
  const char* Expected;
};

const Case Errors[] = {
  { "number",
    [](vtkPolyData*, vtkPolyData* to, vtkLacunaRBFImageWarp*)
    { to->GetPoints()->InsertNextPoint(1, 2, 3); },
    "25 landmarks but 26 targets" },
  { "few",
    [](vtkPolyData* from, vtkPolyData* to, vtkLacunaRBFImageWarp*)
    {
      from->GetPoints()->SetNumberOfPoints(3);
      to->GetPoints()->SetNumberOfPoints(3);
    },
    "at least 4 are needed" },
  { "none",
    [](vtkPolyData* from, vtkPolyData* to, vtkLacunaRBFImageWarp*)
    {
      from->GetPoints()->SetNumberOfPoints(0);
      to->GetPoints()->SetNumberOfPoints(0);
    },
    "at least 4 are needed" },
  { "contradiction",
    [](vtkPolyData*, vtkPolyData* to, vtkLacunaRBFImageWarp*)
    { to->GetPoints()->SetPoint(4, to->GetPoint(7)); },
    "nodes 4 and 7 lie at the same place" },
  { "NaN",
    [](vtkPolyData* from, vtkPolyData*, vtkLacunaRBFImageWarp*)
    { from->GetPoints()->SetPoint(6, std::nan(""), 0, 0); },
    "node 6" },
  { "kernel", [](vtkPolyData*, vtkPolyData*, vtkLacunaRBFImageWarp* w) { w->SetKernel(4); },
    "Kernel is 4" },
  { "interpolation",
    [](vtkPolyData*, vtkPolyData*, vtkLacunaRBFImageWarp* w) { w->SetInterpolation(3); },
    "Interpolation is 3" },
  { "accuracy", [](vtkPolyData*, vtkPolyData*, vtkLacunaRBFImageWarp* w) { w->SetAccuracy(0); },
    "Accuracy" },
  { "smoothing", [](vtkPolyData*, vtkPolyData*, vtkLacunaRBFImageWarp* w) { w->SetSmoothing(-1); },
    "smoothing" },
};

void CheckErrors()
{
  for (const Case& c : Errors)
  {
    const vtkSmartPointer<vtkImageData> image = MakeImage(12);
    vtkNew<vtkPolyData> landmarks;
    vtkNew<vtkPolyData> targets;
    MakeLandmarks(image, 25, landmarks, targets);
    vtkNew<vtkLacunaRBFImageWarp> warp;
    vtkNew<lacunaCheck::Messages> messages;
    messages->Watch(warp);
    messages->Watch(warp->GetExecutive());
    c.Spoil(landmarks, targets, warp);
    warp->SetInputData(0, image);
    warp->SetInputData(1, landmarks);
    warp->SetInputData(2, targets);
    warp->Update();
    if (!messages->HasError(c.Expected))
    {
      lacunaCheck::Fail(__FILE__, __LINE__, std::string(c.Name) + ": " + messages->Errors);
    }
    LACUNA_CHECK(warp->GetOutput()->GetNumberOfPoints() == 0);
  }
}

// The mask is no picture.
void CheckMaskAlone()
{
  const vtkSmartPointer<vtkImageData> image = MakeImage(12);
  vtkNew<vtkPolyData> landmarks;
  vtkNew<vtkPolyData> targets;
  MakeLandmarks(image, 25, landmarks, targets);
  image->GetPointData()->SetScalars(MakeMask(image));
  vtkNew<vtkLacunaRBFImageWarp> warp;
  vtkNew<lacunaCheck::Messages> messages;
  messages->Watch(warp);
  messages->Watch(warp->GetExecutive());
  warp->SetInputData(0, image);
  warp->SetInputData(1, landmarks);
  warp->SetInputData(2, targets);
  warp->Update();
  LACUNA_CHECK(messages->HasError("active scalars are its vtkValidPointMask"));
}

// A landmark that is off by some voxels folds the image beside it; two that change places fold so much
// of it that it is refused.
void CheckFolds()
{
  const vtkSmartPointer<vtkImageData> image = MakeImage(12);
  vtkNew<vtkPolyData> landmarks;
  vtkNew<vtkPolyData> targets;
  MakeLandmarks(image, 25, landmarks, targets);
  vtkNew<vtkLacunaRBFImageWarp> warp;
  vtkNew<lacunaCheck::Messages> messages;
  messages->Watch(warp);
  messages->Watch(warp->GetExecutive());
  warp->SetKernel(vtkLacunaRBFImageWarp::Linear);
  warp->SetInputData(0, image);
  warp->SetInputData(1, landmarks);
  warp->SetInputData(2, targets);
  double x[3];
  targets->GetPoint(4, x);
  targets->GetPoints()->SetPoint(4, x[0] + 20, x[1], x[2]);
  warp->Update();
  LACUNA_CHECK(messages->Warnings.find("folds") != std::string::npos);
  LACUNA_CHECK(messages->Errors.empty());
  vtkDataArray* folded = warp->GetOutput()->GetFieldData()->GetArray("FoldedFraction");
  LACUNA_CHECK(folded && folded->GetComponent(0, 0) > 0 && folded->GetComponent(0, 0) < 0.05);

  warp->SetKernel(vtkLacunaRBFImageWarp::ThinPlate);
  targets->GetPoints()->SetPoint(4, landmarks->GetPoint(7));
  targets->GetPoints()->SetPoint(7, landmarks->GetPoint(4));
  targets->GetPoints()->Modified();
  targets->Modified();
  warp->Update();
  LACUNA_CHECK(messages->HasError(" % of the box around the targets: left would be right"));
  LACUNA_CHECK(warp->GetOutput()->GetNumberOfPoints() == 0);
}

// Landmarks in the middle of a picture, set by hand to a pixel: far from them the smoother kernels
// swing and fold, which is said but no error, since nothing between the landmarks is mirrored.
void CheckPatch()
{
  vtkNew<vtkImageData> image;
  image->SetDimensions(200, 200, 1);
  image->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
  std::fill_n(static_cast<unsigned char*>(image->GetScalarPointer()), 40000, 1);
  vtkNew<vtkMinimalStandardRandomSequence> random;
  random->SetSeed(7);
  vtkNew<vtkPolyData> landmarks;
  vtkNew<vtkPolyData> targets;
  for (vtkPolyData* points : { landmarks.Get(), targets.Get() })
  {
    points->SetPoints(vtkNew<vtkPoints>());
    points->GetPoints()->SetDataTypeToDouble();
  }
  for (int i = 0; i < 14; ++i)
  {
    double x[3] = { 0, 0, 0 };
    double y[3] = { 0, 0, 0 };
    for (int c = 0; c < 2; ++c)
    {
      x[c] = random->GetNextRangeValue(70, 130);
      y[c] = x[c] + random->GetNextRangeValue(-1.7, 1.7);
    }
    landmarks->GetPoints()->InsertNextPoint(x);
    targets->GetPoints()->InsertNextPoint(y);
  }
  for (const int kernel : { vtkLacunaRBFImageWarp::ThinPlate, vtkLacunaRBFImageWarp::Triharmonic })
  {
    vtkNew<vtkLacunaRBFImageWarp> warp;
    vtkNew<lacunaCheck::Messages> messages;
    messages->Watch(warp);
    messages->Watch(warp->GetExecutive());
    warp->SetKernel(kernel);
    warp->SetInputData(0, image);
    warp->SetInputData(1, landmarks);
    warp->SetInputData(2, targets);
    warp->Update();
    LACUNA_CHECK(messages->Errors.empty());
    vtkDataArray* folded = warp->GetOutput()->GetFieldData()->GetArray("FoldedFraction");
    if (!folded)
    {
      lacunaCheck::Fail(__FILE__, __LINE__, "no image, kernel " + std::to_string(kernel));
    }
    else if (kernel == vtkLacunaRBFImageWarp::ThinPlate)
    {
      LACUNA_CHECK(messages->Warnings.empty());
      LACUNA_CHECK(folded->GetComponent(0, 0) == 0);
    }
    else
    {
      LACUNA_CHECK(messages->Warnings.find(" 0 % of those in the box") != std::string::npos);
      LACUNA_CHECK(messages->Warnings.find("Triharmonic swings") != std::string::npos);
      LACUNA_CHECK(folded->GetComponent(0, 0) > 0.1);
    }
  }
}

// Landmarks, and targets where linear (3 x 3, row by row) takes their places about the middle of
// the image, and the corners of a box frame times as large as the image, which stay where they are.
// margin: voxels that the image gets all round afterwards. Returns the errors; warnings are none.
std::string Turn(int layers, const double* linear, int count = 25, double frame = 0, int margin = 0)
{
  const vtkSmartPointer<vtkImageData> image = MakeImage(layers);
  vtkNew<vtkPolyData> landmarks;
  vtkNew<vtkPolyData> targets;
  MakeLandmarks(image, count, landmarks, targets);
  double middle[3];
  image->GetCenter(middle);
  for (vtkIdType i = 0; i < count; ++i)
  {
    double x[3];
    landmarks->GetPoint(i, x);
    vtkMath::Subtract(x, middle, x);
    double y[3];
    for (int c = 0; c < 3; ++c)
    {
      y[c] = middle[c] + vtkMath::Dot(linear + 3 * c, x);
    }
    targets->GetPoints()->SetPoint(i, y);
  }
  for (int corner = 0; frame > 0 && corner < 8; ++corner)
  {
    double index[3];
    for (int c = 0; c < 3; ++c)
    {
      const double first = image->GetExtent()[2 * c];
      const double last = image->GetExtent()[2 * c + 1];
      index[c] = (first + last) / 2 + (corner >> c & 1 ? 0.5 : -0.5) * frame * (last - first);
    }
    double x[3];
    image->TransformContinuousIndexToPhysicalPoint(index, x);
    landmarks->GetPoints()->InsertNextPoint(x);
    targets->GetPoints()->InsertNextPoint(x);
  }
  if (margin > 0)
  {
    int extent[6];
    image->GetExtent(extent);
    for (int c = 0; c < 3; ++c)
    {
      extent[2 * c] -= margin;
      extent[2 * c + 1] += margin;
    }
    image->GetPointData()->Initialize();
    image->SetExtent(extent);
    image->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
    std::fill_n(
      static_cast<unsigned char*>(image->GetScalarPointer()), image->GetNumberOfPoints(), 1);
  }
  vtkNew<vtkLacunaRBFImageWarp> warp;
  vtkNew<lacunaCheck::Messages> messages;
  messages->Watch(warp);
  messages->Watch(warp->GetExecutive());
  warp->SetKernel(vtkLacunaRBFImageWarp::Linear);
  warp->SetInputData(0, image);
  warp->SetInputData(1, landmarks);
  warp->SetInputData(2, targets);
  warp->Update();
  LACUNA_CHECK(messages->Warnings.empty());
  LACUNA_CHECK((warp->GetOutput()->GetNumberOfPoints() == 0) == !messages->Errors.empty());
  return messages->Errors;
}

// An image may be turned in any way but never be mirrored: a patient's left stays left.
void CheckHandedness()
{
  const double turnX[9] = { 1, 0, 0, 0, -1, 0, 0, 0, -1 };
  const double turnZ[9] = { -1, 0, 0, 0, -1, 0, 0, 0, 1 };
  const double exchange[9] = { 0, 1, 0, 0, 0, 1, 1, 0, 0 };
  const double flipX[9] = { -1, 0, 0, 0, 1, 0, 0, 0, 1 };
  const double flipZ[9] = { 1, 0, 0, 0, 1, 0, 0, 0, -1 };
  const double point[9] = { -1, 0, 0, 0, -1, 0, 0, 0, -1 };
  for (const double* linear : { turnX, turnZ, exchange })
  {
    LACUNA_CHECK(Turn(12, linear).empty());
  }
  LACUNA_CHECK(Turn(1, turnZ).empty());
  for (const double* linear : { flipX, flipZ, point })
  {
    LACUNA_CHECK(Turn(12, linear).find("mirror the image") != std::string::npos);
  }
  LACUNA_CHECK(Turn(1, flipX).find("mirror the image") != std::string::npos);
  // other landmarks stay where they are, so that the affine map that fits best is no reflection:
  // most of the image is mirrored, or, within its own corners, the middle of it
  LACUNA_CHECK(Turn(12, flipX, 25, 30).find("mirror 90 % of the box") != std::string::npos);
  for (const int count : { 6, 10 })
  {
    // also where the image has wide margins, of which but a small share is mirrored
    for (const int margin : { 0, 30 })
    {
      LACUNA_CHECK(
        Turn(12, flipX, count, 1, margin).find(" % of the box around the targets: left") !=
        std::string::npos);
    }
  }
}
}

int TestRBFImageWarp(int, char*[])
{
  CompareWithVTK(12, vtkLacunaRBFImageWarp::Linear);
  CompareWithVTK(12, vtkLacunaRBFImageWarp::ThinPlate);
  CheckShift();
  for (int interpolation = 0; interpolation < 3; ++interpolation)
  {
    CheckMask(12, interpolation, false);
    CheckMask(1, interpolation, false);
    CheckMask(12, interpolation, true);
  }
  CheckMaskAlone();
  CheckFolds();
  CheckPatch();
  CheckHandedness();
  CheckErrors();
  return lacunaCheck::Result();
}
