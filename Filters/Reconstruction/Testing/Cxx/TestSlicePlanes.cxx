// SPDX-License-Identifier: BSD-3-Clause
/// Geometry, arrays, choices, pieces, threads, errors of vtkLacunaSlicePlanes.
#include "lacunaCheck.h"
#include "lacunaFieldData.h"
#include "lacunaProvenance.h"
#include "lacunaTrackedSlices.h"
#include "vtkCell.h"
#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkLacunaSlicePlanes.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkSMPTools.h"
#include "vtkSmartPointer.h"

#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

using lacuna::Matrix4;
using lacuna::Vec3;

namespace
{
constexpr int Width = 12;
constexpr int Height = 9;

Matrix4 GetPose(int n)
{
  return Matrix4::Translation({ 10.0, 20.0, 1.5 * n }) * Matrix4::Rotation({ 0, 1, 0 }, 0.05 * n) *
    Matrix4::Scaling({ 0.5, 0.4, 1 });
}

// Slices 0.1 s apart; grey level = 3 column + 5 row + 7 slice.
vtkSmartPointer<vtkImageData> MakeStack(int count, const std::vector<unsigned char>& status = {})
{
  auto stack = vtkSmartPointer<vtkImageData>::New();
  stack->SetDimensions(Width, Height, count);
  stack->AllocateScalars(VTK_UNSIGNED_SHORT, 1);
  std::vector<Matrix4> poses;
  std::vector<double> times;
  std::vector<int> frames;
  for (int k = 0; k < count; ++k)
  {
    for (int j = 0; j < Height; ++j)
    {
      for (int i = 0; i < Width; ++i)
      {
        stack->SetScalarComponentFromDouble(i, j, k, 0, 3 * i + 5 * j + 7 * k);
      }
    }
    poses.push_back(GetPose(k));
    times.push_back(0.1 * k);
    frames.push_back(k);
  }
  lacuna::TrackedSlices::Write(
    stack, poses, times, status.empty() ? std::vector<unsigned char>(count, 0) : status, frames);
  lacuna::FieldData::SetMatrices(stack, "ImageToProbe",
    { Matrix4::Translation({ 0, 300, 0 }) * Matrix4::Scaling({ 0.5, 0.4, 1 }) });
  return stack;
}

using Configure = std::function<void(vtkLacunaSlicePlanes*)>;

vtkSmartPointer<vtkPolyData> Run(vtkImageData* stack, const Configure& configure = {})
{
  vtkNew<vtkLacunaSlicePlanes> filter;
  filter->SetInputData(stack);
  if (configure)
  {
    configure(filter);
  }
  const auto messages = lacunaCheck::Watch(filter);
  filter->Update();
  LACUNA_CHECK_THAT(messages->Errors.empty(), messages->Errors);
  return filter->GetOutput();
}

std::string GetError(vtkImageData* stack, const Configure& configure = {})
{
  vtkNew<vtkLacunaSlicePlanes> filter;
  filter->SetInputData(stack);
  if (configure)
  {
    configure(filter);
  }
  const auto messages = lacunaCheck::Watch(filter);
  filter->Update();
  LACUNA_CHECK(filter->GetOutput()->GetNumberOfPoints() == 0);
  return messages->Errors;
}

double GetPointValue(vtkPolyData* data, const char* name, vtkIdType i)
{
  return data->GetPointData()->GetArray(name)->GetTuple1(i);
}

double GetCellValue(vtkPolyData* data, const char* name, vtkIdType i)
{
  return data->GetCellData()->GetArray(name)->GetTuple1(i);
}

void TestPlanes()
{
  const auto planes = Run(MakeStack(3));
  LACUNA_CHECK(planes->GetNumberOfPoints() == 3 * Width * Height);
  LACUNA_CHECK(planes->GetNumberOfPolys() == 3 * (Width - 1) * (Height - 1));
  LACUNA_CHECK(planes->GetNumberOfLines() == 0);
  LACUNA_CHECK(planes->GetPointData()->GetScalars() &&
    std::string(planes->GetPointData()->GetScalars()->GetName()) == "Intensity");
  vtkIdType point = 0;
  for (int k = 0; k < 3; ++k)
  {
    for (int j = 0; j < Height; ++j)
    {
      for (int i = 0; i < Width; ++i, ++point)
      {
        const Vec3 expected =
          GetPose(k).Point({ static_cast<double>(i), static_cast<double>(j), 0 });
        for (int a = 0; a < 3; ++a)
        {
          LACUNA_CHECK_NEAR(planes->GetPoint(point)[a], expected[a], 1e-5);
        }
        LACUNA_CHECK(GetPointValue(planes, "Intensity", point) == 3 * i + 5 * j + 7 * k);
        const double radius = std::hypot(0.5 * i, 300 + 0.4 * j);
        const double turn = 2 * radius * std::sin(0.13 * std::acos(-1.0) / 180);
        LACUNA_CHECK_NEAR(
          GetPointValue(planes, "RegistrationError", point), std::hypot(1.38, turn), 1e-6);
      }
    }
  }
  LACUNA_CHECK_NEAR(GetPointValue(planes, "RegistrationError", 0), 1.938476, 1e-5);
  // each cell is a pixel's square, all turned alike
  for (vtkIdType c = 0; c < planes->GetNumberOfCells(); ++c)
  {
    const int slice = static_cast<int>(c / ((Width - 1) * (Height - 1)));
    LACUNA_CHECK(GetCellValue(planes, "SliceNumber", c) == slice);
    LACUNA_CHECK_NEAR(GetCellValue(planes, "Timestamp", c), 0.1 * slice, 1e-12);
    vtkPoints* corners = planes->GetCell(c)->GetPoints();
    double p[4][3];
    for (int i = 0; i < 4; ++i)
    {
      corners->GetPoint(i, p[i]);
    }
    const Vec3 x{ p[1][0] - p[0][0], p[1][1] - p[0][1], p[1][2] - p[0][2] };
    const Vec3 y{ p[2][0] - p[1][0], p[2][1] - p[1][1], p[2][2] - p[1][2] };
    for (int i = 0; i < 3; ++i)
    {
      LACUNA_CHECK_NEAR(p[2][i] - p[3][i], p[1][i] - p[0][i], 1e-5);
    }
    const Vec3 normal = GetPose(slice).Vector({ 0, 0, 1 });
    LACUNA_CHECK_NEAR(lacuna::Dot(lacuna::Cross(x, y), normal), 0.5 * 0.4, 1e-4);
  }
  // the last corner of the last row is the fastest one: by hand
  double fastest = 0;
  for (const double column : { 0.0, Width - 1.0 })
  {
    for (const double row : { 0.0, Height - 1.0 })
    {
      fastest = std::max(fastest,
        lacuna::Norm(GetPose(2).Point({ column, row, 0 }) - GetPose(1).Point({ column, row, 0 })));
    }
  }
  const vtkIdType lastCell = planes->GetNumberOfCells() - 1;
  LACUNA_CHECK_NEAR(GetCellValue(planes, "Speed", lastCell), fastest / 0.1, 1e-4);
  LACUNA_CHECK(GetCellValue(planes, "TooFast", lastCell) == 0);
  LACUNA_CHECK(
    GetCellValue(Run(MakeStack(3), [](auto* f) { f->SetSpeedLimit(10); }), "TooFast", 0) == 1);
  LACUNA_CHECK(
    GetCellValue(Run(MakeStack(3), [](auto* f) { f->SetSpeedLimit(0); }), "TooFast", 0) == 0);
  LACUNA_CHECK(lacuna::Provenance::Get(planes).size() == 1);
  LACUNA_CHECK_CONTAINS(
    lacuna::Provenance::Get(Run(MakeStack(3), [](auto* f) { f->SetSpeedLimit(23.00000001); }))[0],
    " SpeedLimit=23.00000001 OutlineOnly=off ");
  LACUNA_CHECK(planes->GetFieldData()->GetArray("PixelStep")->GetTuple1(0) == 1);
  LACUNA_CHECK_THAT(!planes->GetFieldData()->GetArray("ImageToReference"),
    "the arrays of the slices do not describe polydata");
}

void TestChoices()
{
  const auto stack = MakeStack(7);
  // every third slice, of a stack that is itself a part
  const auto strided = Run(stack, [](auto* f) { f->SetStride(3); });
  LACUNA_CHECK(strided->GetNumberOfPoints() == 3 * Width * Height);
  LACUNA_CHECK(GetCellValue(strided, "SliceNumber", (Width - 1) * (Height - 1)) == 3);
  vtkNew<vtkImageData> part;
  part->DeepCopy(stack);
  part->SetOrigin(4, 0, 0);
  part->SetSpacing(2, 1, 1);
  const auto cropped = Run(part);
  const Vec3 expected = GetPose(0).Point({ 4 + 2.0 * (Width - 1), 0, 0 });
  LACUNA_CHECK_NEAR(cropped->GetPoint(Width - 1)[0], expected[0], 1e-5);

  const auto outlines = Run(stack, [](auto* f) { f->OutlineOnlyOn(); });
  LACUNA_CHECK(outlines->GetNumberOfPoints() == 28 && outlines->GetNumberOfLines() == 7 &&
    outlines->GetNumberOfPolys() == 0);
  LACUNA_CHECK(!outlines->GetPointData()->GetArray("Intensity"));
  LACUNA_CHECK(outlines->GetCell(0)->GetNumberOfPoints() == 5);

  // coarser, but from corner to corner
  const auto coarse = Run(stack, [](auto* f) { f->SetMaximumNumberOfPoints(7 * 20); });
  const double step = coarse->GetFieldData()->GetArray("PixelStep")->GetTuple1(0);
  LACUNA_CHECK(step == 3 && coarse->GetNumberOfPoints() == 7 * 5 * 4);
  for (int a = 0; a < 6; ++a)
  {
    LACUNA_CHECK_NEAR(coarse->GetBounds()[a], Run(stack)->GetBounds()[a], 1e-5);
  }
  LACUNA_CHECK_NEAR(GetPointValue(coarse, "Intensity", 5 + 1), 3 * 3 + 5 * 3, 1e-4);

  const auto speed = Run(stack, [](auto* f) { f->SetColorBy(vtkLacunaSlicePlanes::Speed); });
  LACUNA_CHECK(!speed->GetPointData()->GetScalars() && speed->GetCellData()->GetScalars() &&
    std::string(speed->GetCellData()->GetScalars()->GetName()) == "Speed");
  const auto error =
    Run(stack, [](auto* f) { f->SetColorBy(vtkLacunaSlicePlanes::RegistrationError); });
  LACUNA_CHECK(std::string(error->GetPointData()->GetScalars()->GetName()) == "RegistrationError");
}

void TestInvalidSlices()
{
  const auto stack = MakeStack(5, { 0, 1, 4, 0, 8 });
  const int cells = (Width - 1) * (Height - 1);
  const auto left = Run(stack);
  LACUNA_CHECK(left->GetNumberOfCells() == 2 * cells);
  LACUNA_CHECK(GetCellValue(left, "SliceNumber", cells) == 3);

  // outlines come first, without values
  const auto outlined =
    Run(stack, [](auto* f) { f->SetInvalidSlices(vtkLacunaSlicePlanes::Outline); });
  LACUNA_CHECK(outlined->GetNumberOfLines() == 2 && outlined->GetNumberOfPolys() == 2 * cells);
  LACUNA_CHECK(GetCellValue(outlined, "SliceStatus", 0) == 4 &&
    GetCellValue(outlined, "SliceNumber", 1) == 4 && GetCellValue(outlined, "SliceNumber", 2) == 0);
  LACUNA_CHECK(std::isnan(GetCellValue(outlined, "Speed", 0)));
  vtkNew<vtkIdList> ids;
  outlined->GetCellPoints(0, ids);
  LACUNA_CHECK(std::isnan(GetPointValue(outlined, "Intensity", ids->GetId(0))) &&
    std::isnan(GetPointValue(outlined, "RegistrationError", ids->GetId(0))));
  outlined->GetCellPoints(2, ids);
  LACUNA_CHECK(GetPointValue(outlined, "Intensity", ids->GetId(0)) == 0);
  const auto shown = Run(stack, [](auto* f) { f->SetInvalidSlices(vtkLacunaSlicePlanes::Show); });
  LACUNA_CHECK(shown->GetNumberOfCells() == 4 * cells);
  LACUNA_CHECK_CONTAINS(GetError(MakeStack(3, { 1, 4, 8 })), "no slice to show");
  LACUNA_CHECK_CONTAINS(GetError(MakeStack(2, { 1, 1 }),
                          [](auto* f) { f->SetInvalidSlices(vtkLacunaSlicePlanes::Show); }),
    "no slice to show");
}

bool IsFinite(vtkPolyData* data)
{
  bool finite = true;
  for (vtkIdType i = 0; i < data->GetNumberOfPoints(); ++i)
  {
    const double* p = data->GetPoint(i);
    finite &= std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]) &&
      std::isfinite(GetPointValue(data, "RegistrationError", i));
  }
  for (vtkIdType c = 0; c < data->GetNumberOfCells(); ++c)
  {
    finite &= std::isfinite(GetCellValue(data, "Speed", c));
  }
  for (int i = 0; i < 6; ++i)
  {
    finite &= std::isfinite(data->GetBounds()[i]);
  }
  return finite;
}

// Poses that cannot be true though SliceStatus has nothing against them.
void TestBadPoses()
{
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  constexpr double inf = std::numeric_limits<double>::infinity();
  const Matrix4 good = GetPose(7);
  const std::vector<std::pair<Matrix4, std::string>> bad = { { Matrix4::Scaling({ nan, 1, 1 }),
                                                               "not finite" },
    { Matrix4::Translation({ inf, 0, 0 }), "not finite" },
    { good * Matrix4::Scaling({ 0, 1, 1 }), "singular" },
    { Matrix4::Translation({ 1e9, 0, 0 }) * good, "an outlier" },
    { Matrix4::Translation({ 0, -1e308, 0 }) * good, "beyond all measure" },
    { Matrix4::Scaling({ 1e308, 1e308, 1 }), "beyond all measure" } };
  for (const auto& [pose, problem] : bad)
  {
    const auto stack = MakeStack(12);
    vtkDataArray* frames = stack->GetFieldData()->GetArray("FrameNumber");
    for (int i = 0; i < 12; ++i)
    {
      frames->SetTuple1(i, 100 + i);
    }
    vtkDataArray* poses = stack->GetFieldData()->GetArray("ImageToReference");
    poses->SetTuple(7, pose.Data());
    for (const bool outlines : { false, true })
    {
      vtkNew<vtkLacunaSlicePlanes> filter;
      filter->SetInputData(stack);
      filter->SetOutlineOnly(outlines);
      const auto messages = lacunaCheck::Watch(filter);
      filter->Update();
      vtkPolyData* planes = filter->GetOutput();
      LACUNA_CHECK_THAT(messages->Errors.empty(), messages->Errors);
      LACUNA_CHECK_CONTAINS(messages->Warnings, "1 slice was left out because of bad poses");
      LACUNA_CHECK_CONTAINS(messages->Warnings, "slice 7 (frame 107): its pose");
      LACUNA_CHECK_CONTAINS(messages->Warnings, problem);
      const vtkIdType cells = outlines ? 1 : (Width - 1) * (Height - 1);
      LACUNA_CHECK(planes->GetNumberOfCells() == 11 * cells);
      LACUNA_CHECK_THAT(IsFinite(planes), problem);
      // slice 8 goes on from slice 6, 0.2 s before
      double way = 0;
      for (const double column : { 0.0, Width - 1.0 })
      {
        for (const double row : { 0.0, Height - 1.0 })
        {
          const Vec3 corner{ column, row, 0 };
          way = std::max(way, lacuna::Norm(GetPose(8).Point(corner) - GetPose(6).Point(corner)));
        }
      }
      LACUNA_CHECK(GetCellValue(planes, "SliceNumber", 7 * cells) == 8);
      LACUNA_CHECK_NEAR(GetCellValue(planes, "Speed", 7 * cells), way / 0.2, 1e-4);
      LACUNA_CHECK_NEAR(planes->GetBounds()[5], Run(MakeStack(12))->GetBounds()[5], 1e-4);

      filter->SetBadPoses(vtkLacunaSliceAlgorithm::KeepOutliers);
      filter->Update();
      LACUNA_CHECK(planes->GetNumberOfCells() == (problem == "an outlier" ? 12 : 11) * cells);
      LACUNA_CHECK_THAT(IsFinite(planes), problem);
    }
    // pieces judge the whole sweep, and each warns of its own slices only
    vtkNew<vtkLacunaSlicePlanes> filter;
    filter->SetInputData(stack);
    vtkIdType points = 0;
    for (int piece = 0; piece < 4; ++piece)
    {
      const auto messages = lacunaCheck::Watch(filter);
      filter->UpdatePiece(piece, 4, 0);
      points += filter->GetOutput()->GetNumberOfPoints();
      LACUNA_CHECK(messages->HasWarning("slice 7") == (piece == 2));
    }
    LACUNA_CHECK(points == 11 * Width * Height);
    // as other filters judge: a slice that is marked is not talked about
    stack->GetFieldData()->GetArray("SliceStatus")->SetTuple1(7, 1);
    vtkNew<vtkLacunaSlicePlanes> marked;
    marked->SetInputData(stack);
    const auto messages = lacunaCheck::Watch(marked);
    marked->Update();
    LACUNA_CHECK_THAT(messages->Warnings.empty(), messages->Warnings);
    LACUNA_CHECK(marked->GetOutput()->GetNumberOfPoints() == 11 * Width * Height);
  }
  const auto stack = MakeStack(3);
  for (int i = 0; i < 3; ++i)
  {
    stack->GetFieldData()->GetArray("ImageToReference")->SetComponent(i, 3, nan);
  }
  LACUNA_CHECK_CONTAINS(GetError(stack), "slice 0: its pose has elements that are not finite");

  // two slices: neither is the outlier, but numbers stay numbers
  const auto two = MakeStack(2);
  two->GetFieldData()->GetArray("ImageToReference")->SetComponent(1, 3, 9e37);
  two->GetFieldData()->GetArray("Timestamp")->SetTuple1(1, 1e-9);
  LACUNA_CHECK_THAT(IsFinite(Run(two)), "bounds of a far-off slice");

  // a calibration that tells nothing
  for (const double wrong : { nan, 1e308 })
  {
    const auto sweep = MakeStack(3);
    sweep->GetFieldData()->GetArray("ImageToProbe")->SetComponent(0, 0, wrong);
    vtkNew<vtkLacunaSlicePlanes> filter;
    filter->SetInputData(sweep);
    const auto messages = lacunaCheck::Watch(filter);
    filter->Update();
    LACUNA_CHECK_CONTAINS(messages->Warnings, "RegistrationError is not known");
    LACUNA_CHECK(!filter->GetOutput()->GetPointData()->GetArray("RegistrationError"));
    LACUNA_CHECK_CONTAINS(
      GetError(sweep, [](auto* f) { f->SetColorBy(vtkLacunaSlicePlanes::RegistrationError); }),
      "mend the calibration");
  }
}

void TestPiecesAndThreads()
{
  const auto stack = MakeStack(7, { 0, 0, 4, 0, 0, 0, 0 });
  const auto whole = Run(stack);
  for (const int pieces : { 2, 3, 11 })
  {
    vtkNew<vtkLacunaSlicePlanes> filter;
    filter->SetInputData(stack);
    vtkIdType points = 0;
    bool equal = true;
    for (int piece = 0; piece < pieces; ++piece)
    {
      filter->UpdatePiece(piece, pieces, 0);
      vtkPolyData* part = filter->GetOutput();
      for (vtkIdType i = 0; i < part->GetNumberOfPoints(); ++i, ++points)
      {
        equal &= part->GetPoint(i)[2] == whole->GetPoint(points)[2] &&
          GetPointValue(part, "Intensity", i) == GetPointValue(whole, "Intensity", points);
      }
    }
    LACUNA_CHECK_THAT(equal && points == whole->GetNumberOfPoints(), "pieces make the whole");
  }
  for (const int threads : { 1, 2, 5 })
  {
    vtkSmartPointer<vtkPolyData> other;
    vtkSMPTools::LocalScope(
      vtkSMPTools::Config{ threads, std::string("STDThread"), false }, [&] { other = Run(stack); });
    LACUNA_CHECK(
      std::memcmp(other->GetPoints()->GetVoidPointer(0), whole->GetPoints()->GetVoidPointer(0),
        12 * static_cast<std::size_t>(whole->GetNumberOfPoints())) == 0);
    LACUNA_CHECK(std::memcmp(other->GetPointData()->GetArray("Intensity")->GetVoidPointer(0),
                   whole->GetPointData()->GetArray("Intensity")->GetVoidPointer(0),
                   4 * static_cast<std::size_t>(whole->GetNumberOfPoints())) == 0);
  }
}

void TestErrors()
{
  auto stack = MakeStack(3);
  LACUNA_CHECK_CONTAINS(
    GetError(stack, [](auto* f) { f->SetStride(0); }), "Stride is 0; it must be 1 or more");
  LACUNA_CHECK_CONTAINS(GetError(stack, [](auto* f) { f->SetMaximumNumberOfPoints(-1); }),
    "MaximumNumberOfPoints is -1; it must be 4 or more");
  stack->GetFieldData()->RemoveArray("ImageToReference");
  LACUNA_CHECK_CONTAINS(GetError(stack), "not calibrated");

  stack = MakeStack(3);
  stack->GetFieldData()->RemoveArray("ImageToProbe");
  LACUNA_CHECK(!Run(stack)->GetPointData()->GetArray("RegistrationError"));
  LACUNA_CHECK_CONTAINS(
    GetError(stack, [](auto* f) { f->SetColorBy(vtkLacunaSlicePlanes::RegistrationError); }),
    "'ImageToProbe' is missing");

  stack = MakeStack(3);
  stack->GetFieldData()->RemoveArray("Timestamp");
  LACUNA_CHECK(!Run(stack)->GetCellData()->GetArray("Speed"));
  LACUNA_CHECK_CONTAINS(
    GetError(stack, [](auto* f) { f->SetColorBy(vtkLacunaSlicePlanes::Speed); }),
    "'Timestamp' is missing");
  LACUNA_CHECK_CONTAINS(GetError(MakeStack(3), [](auto* f) { f->SetTranslationAccuracy(-1); }),
    "TranslationAccuracy is -1 mm; it must be 0 mm or more");
  LACUNA_CHECK_CONTAINS(
    GetError(MakeStack(3), [](auto* f) { f->SetBadPoses(vtkLacunaSliceAlgorithm::Refuse); }),
    "BadPoses is 0; it must be 1 (LeaveOut) or 2 (KeepOutliers)");
  LACUNA_CHECK_CONTAINS(
    GetError(MakeStack(3),
      [](auto* f) { f->SetAngularAccuracy(std::numeric_limits<double>::quiet_NaN()); }),
    "AngularAccuracy is nan degrees; it must be 0 degrees or more");
  for (const double limit : { -1.0, std::numeric_limits<double>::quiet_NaN() })
  {
    LACUNA_CHECK_CONTAINS(
      GetError(MakeStack(3), [&](auto* f) { f->SetSpeedLimit(limit); }), "SpeedLimit");
  }

  // too fast, and standing still in time
  stack = MakeStack(3);
  stack->GetFieldData()->GetArray("Timestamp")->SetTuple1(2, 0.1);
  vtkNew<vtkLacunaSlicePlanes> filter;
  filter->SetInputData(stack);
  filter->SetColorBy(vtkLacunaSlicePlanes::Speed);
  filter->SetSpeedLimit(10);
  const auto messages = lacunaCheck::Watch(filter);
  filter->Update();
  LACUNA_CHECK(messages->HasWarning("2 of 3 slices are faster than 10 mm/s: slices 0, 1"));
  LACUNA_CHECK(messages->HasWarning("not known in slice 2"));
}
}

int TestSlicePlanes(int, char*[])
{
  TestPlanes();
  TestChoices();
  TestInvalidSlices();
  TestBadPoses();
  TestPiecesAndThreads();
  TestErrors();
  return lacunaCheck::Result();
}
