// SPDX-License-Identifier: BSD-3-Clause
// Image warps that fold or mirror: what is warned of and what is refused.
#include "RBFTestWarps.h"
#include "lacunaCheck.h"
#include "vtkFieldData.h"
#include "vtkLacunaRBFImageWarp.h"
#include "vtkMath.h"
#include "vtkMinimalStandardRandomSequence.h"

#include <algorithm>
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
}

int TestRBFImageWarpFolds(int, char*[])
{
  CheckFolds();
  CheckPatch();
  CheckHandedness();
  return lacunaCheck::Result();
}
