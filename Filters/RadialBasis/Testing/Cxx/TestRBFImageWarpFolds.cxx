// SPDX-License-Identifier: BSD-3-Clause
// Image warps that fold or mirror: what is warned of and what is refused.
#include "RBFTestWarps.h"
#include "lacunaCheck.h"
#include "vtkFieldData.h"
#include "vtkLacunaRBFImageWarp.h"
#include "vtkMath.h"
#include "vtkMinimalStandardRandomSequence.h"

#include <algorithm>
#include <array>
#include <string>

namespace
{
using namespace RBFTestWarps;

// A landmark that is off by some voxels folds the image beside it; two that change places fold so much
// of it that it is refused.
void CheckFolds()
{
  const vtkSmartPointer<vtkImageData> image = MakeImage(12);
  vtkNew<vtkPolyData> landmarks;
  vtkNew<vtkPolyData> targets;
  MakeLandmarks(image, 25, landmarks, targets);
  WatchedWarp run(image, landmarks, targets);
  run.Filter->SetKernel(vtkLacunaRBFImageWarp::Linear);
  double x[3];
  targets->GetPoint(4, x);
  targets->GetPoints()->SetPoint(4, x[0] + 20, x[1], x[2]);
  run.Filter->Update();
  LACUNA_CHECK(run.Messages->Warnings.find("folds") != std::string::npos);
  LACUNA_CHECK(run.Messages->Errors.empty());
  vtkDataArray* folded = run.Filter->GetOutput()->GetFieldData()->GetArray("FoldedFraction");
  LACUNA_CHECK(folded && folded->GetComponent(0, 0) > 0 && folded->GetComponent(0, 0) < 0.05);

  run.Filter->SetKernel(vtkLacunaRBFImageWarp::ThinPlate);
  targets->GetPoints()->SetPoint(4, landmarks->GetPoint(7));
  targets->GetPoints()->SetPoint(7, landmarks->GetPoint(4));
  targets->GetPoints()->Modified();
  targets->Modified();
  run.Filter->Update();
  LACUNA_CHECK(run.Messages->HasError(" % of the box around the targets: left would be right"));
  LACUNA_CHECK(run.Filter->GetOutput()->GetNumberOfPoints() == 0);
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
    WatchedWarp run(image, landmarks, targets);
    run.Filter->SetKernel(kernel);
    run.Filter->Update();
    LACUNA_CHECK(run.Messages->Errors.empty());
    vtkDataArray* folded = run.Filter->GetOutput()->GetFieldData()->GetArray("FoldedFraction");
    if (!folded)
    {
      lacunaCheck::Fail(__FILE__, __LINE__, "no image, kernel " + std::to_string(kernel));
    }
    else if (kernel == vtkLacunaRBFImageWarp::ThinPlate)
    {
      LACUNA_CHECK(run.Messages->Warnings.empty());
      LACUNA_CHECK(folded->GetComponent(0, 0) == 0);
    }
    else
    {
      LACUNA_CHECK(run.Messages->Warnings.find(" 0 % of those in the box") != std::string::npos);
      LACUNA_CHECK(run.Messages->Warnings.find("Triharmonic swings") != std::string::npos);
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
  WatchedWarp run(image, landmarks, targets);
  run.Filter->SetKernel(vtkLacunaRBFImageWarp::Linear);
  run.Filter->Update();
  LACUNA_CHECK(run.Messages->Warnings.empty());
  LACUNA_CHECK(
    (run.Filter->GetOutput()->GetNumberOfPoints() == 0) == !run.Messages->Errors.empty());
  return run.Messages->Errors;
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

// Grey levels are places, all of them inside: what is folded can be seen in them. Blocks into which the
// image is divided do not show.
double CountFolds(vtkImageData* output)
{
  vtkDataArray* places = output->GetPointData()->GetScalars();
  int size[3];
  output->GetDimensions(size);
  const vtkIdType stride[3] = { 1, size[0], static_cast<vtkIdType>(size[0]) * size[1] };
  vtkIdType folded = 0;
  for (vtkIdType i = 0; i < output->GetNumberOfPoints(); ++i)
  {
    double sides[3][3];
    for (int axis = 0; axis < 3; ++axis)
    {
      const bool last = i / stride[axis] % size[axis] + 1 == size[axis];
      const vtkIdType from = last ? i - stride[axis] : i;
      for (int c = 0; c < 3; ++c)
      {
        sides[axis][c] =
          places->GetComponent(from + stride[axis], c) - places->GetComponent(from, c);
      }
    }
    folded += vtkMath::Determinant3x3(sides[0], sides[1], sides[2]) <= 0 ? 1 : 0;
  }
  return static_cast<double>(folded);
}

// A part of the output is that part of the whole, and says of the whole what is folded, whether it
// was asked for first or later; of an image of several blocks.
void CheckParts()
{
  vtkNew<vtkImageData> image;
  image->SetExtent(-20, 204, 3, 32, 1, 110);
  image->SetSpacing(0.5, 1, 1);
  vtkNew<vtkDoubleArray> place;
  place->SetNumberOfComponents(3);
  for (vtkIdType i = 0; i < image->GetNumberOfPoints(); ++i)
  {
    place->InsertNextTuple(image->GetPoint(i));
  }
  image->GetPointData()->SetScalars(place);
  vtkNew<vtkPolyData> landmarks;
  vtkNew<vtkPolyData> targets;
  MakeLandmarks(image, 40, landmarks, targets);
  for (vtkIdType i = 0; i < 40; ++i) // all is seen enlarged, so that every voxel shows a place
  {
    double middle[3];
    double x[3];
    image->GetCenter(middle);
    landmarks->GetPoint(i, x);
    for (int c = 0; c < 3; ++c)
    {
      x[c] += x[c] - middle[c] + (i % 11 == 7 && c == 0 ? 60 : 0); // some are wrong
    }
    targets->GetPoints()->SetPoint(i, x);
  }
  WatchedWarp whole(image, landmarks, targets);
  whole.Filter->SetKernel(vtkLacunaRBFImageWarp::Linear);
  whole.Filter->Update();
  LACUNA_CHECK_THAT(whole.Messages->Errors.empty(), whole.Messages->Errors);
  vtkImageData* all = whole.Filter->GetOutput();
  vtkDataArray* valid = all->GetPointData()->GetArray("vtkValidPointMask");
  LACUNA_CHECK(valid && valid->GetRange(0)[0] == 1);
  const auto getFolds = [](vtkImageData* data)
  { return data->GetFieldData()->GetArray("FoldedFraction")->GetComponent(0, 0); };
  const double folded = getFolds(all) * static_cast<double>(all->GetNumberOfPoints());
  LACUNA_CHECK(folded > 100);
  LACUNA_CHECK_NEAR(folded, CountFolds(all), 0.5);

  WatchedWarp parts(image, landmarks, targets);
  parts.Filter->SetKernel(vtkLacunaRBFImageWarp::Linear);
  for (const std::array<int, 6>& part : { std::array<int, 6>{ 60, 95, 20, 32, 50, 60 },
         { -20, 204, 10, 10, 1, 110 }, { 204, 204, 32, 32, 110, 110 } })
  {
    parts.Filter->UpdateExtent(part.data());
    vtkImageData* output = parts.Filter->GetOutput();
    LACUNA_CHECK(std::equal(part.begin(), part.end(), output->GetExtent()));
    LACUNA_CHECK(getFolds(output) == getFolds(all));
    bool same = true;
    for (vtkIdType i = 0; i < output->GetNumberOfPoints(); ++i)
    {
      const vtkIdType k = all->FindPoint(output->GetPoint(i));
      for (int c = 0; c < 3; ++c)
      {
        same = same &&
          output->GetPointData()->GetScalars()->GetComponent(i, c) ==
            all->GetPointData()->GetScalars()->GetComponent(k, c);
      }
    }
    LACUNA_CHECK(same);
  }
}
}

int TestRBFImageWarpFolds(int, char*[])
{
  CheckParts();
  CheckFolds();
  CheckPatch();
  CheckHandedness();
  return lacunaCheck::Result();
}
