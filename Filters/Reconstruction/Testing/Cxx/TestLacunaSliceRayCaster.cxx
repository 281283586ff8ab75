// SPDX-License-Identifier: BSD-3-Clause
/// Ports, arrays, extents, pieces, properties, errors of vtkLacunaSliceRayCaster.
#include "lacunaDepthMap.h"
#include "lacunaProvenance.h"
#include "lacunaTestCasters.h"
#include "vtkCharArray.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkFloatArray.h"
#include "vtkInformation.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <cmath>
#include <limits>
#include <sstream>

using lacuna::Matrix4;
using namespace lacunaTestStacks;

namespace
{
const double NotANumber = std::numeric_limits<double>::quiet_NaN();

struct Said
{
  std::string Errors, Warnings;
};

Said GetMessages(
  vtkImageData* stack, const std::function<void(Caster*)>& configure = [](Caster*) {})
{
  vtkNew<Caster> caster;
  LookAlong(caster);
  configure(caster);
  caster->SetInputData(stack);
  const auto messages = lacunaCheck::Watch(caster);
  caster->Update();
  LACUNA_CHECK_THAT(messages->Errors.empty() || caster->GetOutput()->GetNumberOfPoints() == 0,
    "no half result after: " + messages->Errors);
  return { messages->Errors, messages->Warnings };
}

void TestContract()
{
  vtkNew<Caster> caster;
  LACUNA_CHECK(caster->GetIsoValue() == 128 && caster->GetSolidSide() == Caster::Above);
  LACUNA_CHECK(caster->GetMaximumGap() == 0 && caster->GetPixelSpacing() == 0);
  LACUNA_CHECK(caster->GetFocalPoint()[0] == VTK_DOUBLE_MAX);
  LACUNA_CHECK(caster->GetPlaneOrigin()[2] == VTK_DOUBLE_MAX);
  LookAlong(caster);
  caster->SetInputData(MakeStack(MakePoses(5)));
  caster->Update();
  vtkImageData* map = caster->GetOutput();
  // as wide and as high as the slices, with their spacing
  const int* extent = map->GetExtent();
  LACUNA_CHECK(extent[0] == 0 && extent[1] == 12 && extent[2] == 0 && extent[3] == 8 &&
    extent[4] == 0 && extent[5] == 0);
  LACUNA_CHECK(map->GetSpacing()[0] == 0.5 && map->GetSpacing()[1] == 0.5);
  double corner[3];
  map->TransformIndexToPhysicalPoint(12, 8, 0, corner);
  LACUNA_CHECK_NEAR(corner[0], 16, 1e-12);
  LACUNA_CHECK_NEAR(corner[1], 24, 1e-12);
  LACUNA_CHECK_NEAR(corner[2], 0, 1e-12);
  const lacuna::DepthMap contract(map);
  LACUNA_CHECK(!contract.IsPerspective());
  vtkPointData* points = map->GetPointData();
  LACUNA_CHECK(points->GetNumberOfArrays() == 3);
  LACUNA_CHECK(vtkDoubleArray::SafeDownCast(points->GetArray("Depth")) != nullptr);
  LACUNA_CHECK(vtkCharArray::SafeDownCast(points->GetArray("vtkValidPointMask")) != nullptr);
  LACUNA_CHECK(vtkFloatArray::SafeDownCast(points->GetArray("Normals")) != nullptr);
  LACUNA_CHECK(points->GetScalars() == points->GetArray("Depth"));
  LACUNA_CHECK(points->GetNormals() == points->GetArray("Normals"));
  // column 6, row 4: 6 + 8 + 10 z = 30
  LACUNA_CHECK_NEAR(GetValue(map, "Depth", 6, 4, 0), 1.6, 1e-12);
  const lacuna::Vec3 hit = contract.GetPoint(6, 4, 1.6);
  LACUNA_CHECK_NEAR(hit[0], 13, 1e-12);
  LACUNA_CHECK_NEAR(hit[1], 22, 1e-12);
  LACUNA_CHECK_NEAR(hit[2], 1.6, 1e-12);
  // the level surface of column + 2 row + 10 z: 2 and 4 per mm across, 10 along; towards the viewer
  int ijk[3] = { 6, 4, 0 };
  const double* normal = points->GetNormals()->GetTuple3(map->ComputePointId(ijk));
  const double length = std::sqrt(4.0 + 16 + 100);
  LACUNA_CHECK_NEAR(normal[0], -2 / length, 1e-6);
  LACUNA_CHECK_NEAR(normal[1], -4 / length, 1e-6);
  LACUNA_CHECK_NEAR(normal[2], -10 / length, 1e-6);

  vtkFieldData* fields = map->GetFieldData();
  LACUNA_CHECK(fields->GetNumberOfArrays() == 6); // with Sweeps, SweepGap and RayGap
  LACUNA_CHECK(fields->GetArray("IsoValues")->GetTuple1(0) == 30);
  LACUNA_CHECK(fields->GetArray("ImageToWorld")->GetNumberOfComponents() == 16);
  const std::vector<std::string> steps = lacuna::Provenance::Get(map);
  LACUNA_CHECK(steps.size() == 1 && Contains(steps[0], "vtkLacunaSliceRayCaster") &&
    Contains(steps[0], "IsoValue=30 SolidSide=Above") && Contains(steps[0], "ViewUp=0,-1,0"));
  std::ostringstream text;
  caster->Print(text);
  LACUNA_CHECK(Contains(text.str(), "ViewDirection: 0,0,1 (a finite number)"));
  LACUNA_CHECK(Contains(text.str(), "NumberOfCastSlices: 5"));

  // nothing in, nothing out
  vtkNew<vtkImageData> empty;
  const Said said = GetMessages(empty);
  LACUNA_CHECK(said.Errors.empty() && said.Warnings.empty());
}

void TestTypes()
{
  for (const int type : { VTK_CHAR, VTK_SIGNED_CHAR, VTK_UNSIGNED_CHAR, VTK_SHORT,
         VTK_UNSIGNED_SHORT, VTK_INT, VTK_UNSIGNED_INT, VTK_LONG, VTK_UNSIGNED_LONG, VTK_LONG_LONG,
         VTK_UNSIGNED_LONG_LONG, VTK_FLOAT, VTK_DOUBLE })
  {
    const auto map = CastAfresh(MakeStack(MakePoses(5), type), LookAlong);
    LACUNA_CHECK_NEAR(GetValue(map, "Depth", 6, 4, 0), 1.6, 1e-12);
  }
}

void TestProperties()
{
  const auto stack = MakeStack(MakePoses(5));
  const auto depth = [&](const std::function<void(Caster*)>& configure, int i = 6, int j = 4)
  {
    const auto map = CastAfresh(stack,
      [&](Caster* caster)
      {
        LookAlong(caster);
        configure(caster);
      });
    return GetValue(map, "Depth", i, j, 0);
  };
  LACUNA_CHECK_NEAR(depth([](Caster* c) { c->SetMaximumGap(1); }), 1.6, 1e-12);
  LACUNA_CHECK_NEAR(depth([](Caster* c) { c->SetMaximumGap(0.9); }), 2, 1e-12);
  LACUNA_CHECK_NEAR(depth([](Caster* c) { c->SetIsoValue(10); }), 0, 1e-12);
  LACUNA_CHECK(std::isnan(depth([](Caster* c) { c->SetIsoValue(54.5); })));
  LACUNA_CHECK_NEAR(depth([](Caster* c) { c->SetSolidSide(Caster::Below); }), 0, 1e-12);
  const auto fromBehind = [](Caster* c)
  {
    c->SetViewDirection(0, 0, -1);
    c->SetSolidSide(Caster::Below);
  };
  LACUNA_CHECK_NEAR(depth(fromBehind), 4 - 1.6, 1e-12);
  // seen from behind with the same way up, left and right change places
  LACUNA_CHECK_NEAR(depth(fromBehind, 0, 4), 4 - 1, 1e-12);
  LACUNA_CHECK_NEAR(depth(
                      [](Caster* c)
                      {
                        c->SetPlaneOrigin(99, 99, -7);
                        c->SetPixelSpacing(0.25);
                      },
                      12, 8),
    8.6, 1e-12);
  const auto focused = [](Caster* c)
  {
    c->SetFocalPoint(11, 21, 55);
    c->SetImageSize(3, 3);
  };
  LACUNA_CHECK_NEAR(depth(focused, 1, 1), (30 - 2 - 4) / 10.0, 1e-12);
  // only what the probe sees exists: here a quarter of a ring about the corner of column 0, row 0
  const auto fan = [](Caster* c)
  {
    c->SetFanRadii(1, 3.01);
    c->SetFanAngles(0, 90);
  };
  LACUNA_CHECK_NEAR(depth(fan, 2, 4), 2, 1e-12);
  LACUNA_CHECK(std::isnan(depth(fan, 1, 1)) && std::isnan(depth(fan, 5, 5)));
  // a part of the slices; the map fits this part
  const auto clipped = [](Caster* c) { c->SetClipRectangle(3, 2, 7, 5); };
  LACUNA_CHECK_NEAR(depth(clipped, 3, 2), 1.6, 1e-12);
  vtkNew<Caster> caster;
  LookAlong(caster);
  clipped(caster);
  caster->SetInputData(stack);
  caster->Update();
  LACUNA_CHECK(
    caster->GetOutput()->GetDimensions()[0] == 7 && caster->GetOutput()->GetDimensions()[1] == 5);
}

void TestSlicesLeftOut()
{
  // The middle slice is garbage and marked; its pose is not even a number.
  std::vector<Matrix4> poses = MakePoses(5);
  poses[2](0, 3) = NotANumber;
  auto map = CastAfresh(MakeStack(poses, VTK_UNSIGNED_CHAR, { 0, 0, 1, 0, 0 }), LookAlong);
  LACUNA_CHECK_NEAR(GetValue(map, "Depth", 6, 4, 0), 1.6, 1e-12);
  map = CastAfresh(MakeStack(MakePoses(5), VTK_UNSIGNED_CHAR, { 0, 2, 4, 8, 0 }),
    [](Caster* caster)
    {
      LookAlong(caster);
      caster->SetMaximumGap(1);
    });
  LACUNA_CHECK_NEAR(GetValue(map, "Depth", 6, 4, 0), 4, 1e-12);
  map = CastAfresh(MakeStack(MakePoses(5), VTK_UNSIGNED_CHAR, { 0, 2, 4, 8, 0 }),
    [](Caster* caster)
    {
      LookAlong(caster);
      caster->SetMaximumGap(1);
      caster->UseImageInvalidOn();
      caster->UseTooFastOn();
    });
  LACUNA_CHECK_NEAR(GetValue(map, "Depth", 6, 4, 0), 1.6, 1e-12);

  const auto marked = MakeStack(MakePoses(3), VTK_UNSIGNED_CHAR, { 1, 1, 8 });
  LACUNA_CHECK_CONTAINS(GetMessages(marked).Errors,
    "no slice is left to look at: 3 of 3 are flagged in SliceStatus: 2 pose invalid (1), 1 gated "
    "out (8)");
  LACUNA_CHECK(GetMessages(marked, [](Caster* c) { c->UseGatedOutOn(); }).Errors.empty());
  const auto broken = MakeStack(poses);
  LACUNA_CHECK_CONTAINS(
    GetMessages(broken).Errors, "slice 2: its pose has elements that are not finite");
  LACUNA_CHECK_CONTAINS(
    GetMessages(broken, [](Caster* c) { c->SetBadPoses(Caster::LeaveOut); }).Warnings,
    "1 slice was left out because of bad poses");
  // one slice is enough
  LACUNA_CHECK_NEAR(GetValue(CastAfresh(MakeStack(MakePoses(1)),
                               [](Caster* caster)
                               {
                                 LookAlong(caster);
                                 caster->SetIsoValue(5);
                               }),
                      "Depth", 6, 4, 0),
    0, 1e-12);
}

void TestErrors()
{
  const auto good = MakeStack(MakePoses(5));
  LACUNA_CHECK(GetMessages(good).Errors.empty() && GetMessages(good).Warnings.empty());
  auto stack = MakeStack(MakePoses(5));
  stack->GetFieldData()->RemoveArray("ImageToReference");
  LACUNA_CHECK_CONTAINS(GetMessages(stack).Errors, "the probe is not calibrated");
  stack = MakeStack(MakePoses(5));
  stack->GetFieldData()->RemoveArray("SliceStatus");
  LACUNA_CHECK_CONTAINS(GetMessages(stack).Errors, "'SliceStatus' is missing");
  stack = MakeStack(MakePoses(5));
  stack->GetPointData()->Initialize();
  LACUNA_CHECK_CONTAINS(GetMessages(stack).Errors, "no active point scalars");
  stack = MakeStack(MakePoses(5));
  stack->SetOrigin(0, 0, 3);
  LACUNA_CHECK_CONTAINS(GetMessages(stack).Errors, "z = 5");

  const auto errors = [&](const std::function<void(Caster*)>& configure)
  { return GetMessages(good, configure).Errors; };
  LACUNA_CHECK_CONTAINS(
    errors([](Caster* c) { c->SetIsoValue(NotANumber); }), "it must be a finite number");
  LACUNA_CHECK_CONTAINS(errors([](Caster* c) { c->SetMaximumGap(-1); }),
    "MaximumGap is -1 mm; it must be 0 mm or more");
  LACUNA_CHECK_CONTAINS(
    errors([](Caster* c) { c->SetMaximumGap(NotANumber); }), "MaximumGap is nan mm");
  LACUNA_CHECK_CONTAINS(
    errors([](Caster* c) { c->SetViewDirection(0, 0, 0); }), "the view direction (0, 0, 0)");
  LACUNA_CHECK_CONTAINS(errors([](Caster* c) { c->SetViewUp(0, 0, 2); }), "parallel");
  LACUNA_CHECK_CONTAINS(
    errors([](Caster* c) { c->SetFocalPoint(0, NotANumber, 0); }), "FocalPoint is nan mm");
  LACUNA_CHECK_CONTAINS(
    errors([](Caster* c) { c->SetPlaneOrigin(0, NotANumber, 0); }), "PlaneOrigin is nan mm");
  LACUNA_CHECK_CONTAINS(errors([](Caster* c) { c->SetFocalPoint(VTK_DOUBLE_MAX, 0, 0); }),
    "only 2 coordinates are given");
  LACUNA_CHECK_CONTAINS(
    errors([](Caster* c) { c->SetPixelSpacing(-0.5); }), "PixelSpacing is -0.5 mm");
  LACUNA_CHECK_CONTAINS(errors([](Caster* c) { c->SetPixelSpacing(1e-9); }), "too large");
  LACUNA_CHECK_CONTAINS(
    errors([](Caster* c) { c->SetImageSize(-1, 4); }), "ImageSize is -1 pixels");
  LACUNA_CHECK_CONTAINS(
    errors([](Caster* c) { c->SetClipRectangle(12, 0, 0, 0); }), "1 columns of 0 to 12");

  const auto warnings = [&](const std::function<void(Caster*)>& configure)
  { return GetMessages(good, configure).Warnings; };
  LACUNA_CHECK_CONTAINS(warnings([](Caster* c) { c->SetIsoValue(1000); }),
    "IsoValue 1000 lies outside the grey levels of the slices, which range from 0 to 68");
  // within them, but not in front of any viewer: no reason to warn
  LACUNA_CHECK(warnings(
    [](Caster* c)
    {
      c->SetFocalPoint(500, 0, 0);
      c->SetImageSize(3, 3);
    }).empty());
  LACUNA_CHECK_CONTAINS(warnings([](Caster* c) { c->SetViewDirection(1, 0, 0); }),
    "5 of 5 slices are seen edge-on, at less than 1 degree from the view direction, and left out; "
    "the slices are seen best along the ViewDirection 0 0 1 or its opposite");

  // once mended, it works again
  vtkNew<Caster> mended;
  LookAlong(mended);
  mended->SetInputData(good);
  mended->SetPixelSpacing(-1);
  const auto once = lacunaCheck::Watch(mended);
  mended->Update();
  LACUNA_CHECK(!once->Errors.empty());
  mended->SetPixelSpacing(1);
  mended->Update();
  LACUNA_CHECK(mended->GetOutput()->GetNumberOfPoints() == 7 * 5);
}

void TestPieces()
{
  const auto configure = [](Caster* caster)
  {
    LookAlong(caster);
    caster->SetPixelSpacing(0.11);
    caster->SetViewDirection(0.3, -0.2, 1);
  };
  const auto whole = CastAfresh(MakeStack(MakePoses(5)), configure);
  vtkIdType points = 0;
  vtkNew<Caster> caster;
  configure(caster);
  caster->SetInputData(MakeStack(MakePoses(5)));
  for (int piece = 0; piece < 3; ++piece)
  {
    caster->UpdatePiece(piece, 3, 0);
    vtkImageData* part = caster->GetOutput();
    points += part->GetNumberOfPoints();
    LACUNA_CHECK(
      part->GetNumberOfPoints() > 0 && part->GetNumberOfPoints() < whole->GetNumberOfPoints());
    vtkNew<vtkImageData> expected;
    expected->DeepCopy(whole);
    int extent[6];
    part->GetExtent(extent);
    expected->Crop(extent);
    LACUNA_CHECK_THAT(IsSame(part, expected), "piece " + std::to_string(piece));
  }
  LACUNA_CHECK(points >= whole->GetNumberOfPoints());
}

}

int TestLacunaSliceRayCaster(int, char*[])
{
  TestContract();
  TestTypes();
  TestProperties();
  TestSlicesLeftOut();
  TestErrors();
  TestPieces();
  return lacunaCheck::Result();
}
