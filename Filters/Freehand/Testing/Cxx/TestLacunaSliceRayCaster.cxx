// SPDX-License-Identifier: BSD-3-Clause
/// Ports, arrays, extents, pieces, growing inputs, time, errors of vtkLacunaSliceRayCaster.
#include "lacunaCheck.h"
#include "lacunaTestStacks.h"
#include "vtkCallbackCommand.h"
#include "vtkCharArray.h"
#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkFloatArray.h"
#include "vtkImageAlgorithm.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkLacunaDepthMap.h"
#include "vtkLacunaProvenance.h"
#include "vtkLacunaSliceRayCaster.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

using lacuna::Matrix4;
using lacunaTestStacks::Contains;
using lacunaTestStacks::GetValue;
using lacunaTestStacks::MakePoses;
using lacunaTestStacks::MakeStack;

namespace
{
using Caster = vtkLacunaSliceRayCaster;
const double NotANumber = std::numeric_limits<double>::quiet_NaN();

// Looks along the way of the probe; in the stacks, grey = column + 2 row + 10 slice, and rays meet
// slice n at depth n.
void LookAlong(Caster* caster)
{
  caster->SetViewDirection(0, 0, 1);
  caster->SetViewUp(0, -1, 0);
  caster->SetIsoValue(30);
}

// A view that does not depend on the slices.
void FixView(Caster* caster)
{
  LookAlong(caster);
  caster->SetFocalPoint(13, 22, 0);
  caster->SetPlaneOrigin(0, 0, 0);
  caster->SetPixelSpacing(0.4);
  caster->SetImageSize(16, 12);
}

bool IsSame(vtkImageData* a, vtkImageData* b)
{
  if (a->GetNumberOfPoints() == 0 || a->GetNumberOfPoints() != b->GetNumberOfPoints())
  {
    return false;
  }
  for (const char* name : { "Depth", "vtkValidPointMask", "Normals" })
  {
    vtkDataArray* x = a->GetPointData()->GetArray(name);
    vtkDataArray* y = b->GetPointData()->GetArray(name);
    if (std::memcmp(x->GetVoidPointer(0), y->GetVoidPointer(0),
          static_cast<std::size_t>(x->GetNumberOfValues()) * x->GetDataTypeSize()) != 0)
    {
      return false;
    }
  }
  return true;
}

// What the filter makes of stack without having seen anything before.
vtkSmartPointer<vtkImageData> CastAfresh(
  vtkImageData* stack, const std::function<void(Caster*)>& configure = FixView)
{
  vtkNew<Caster> caster;
  configure(caster);
  caster->SetInputData(stack);
  caster->Update();
  return caster->GetOutput();
}

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
  const vtkLacunaDepthMap contract(map);
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
  LACUNA_CHECK(fields->GetNumberOfArrays() == 3);
  LACUNA_CHECK(fields->GetArray("IsoValues")->GetTuple1(0) == 30);
  LACUNA_CHECK(fields->GetArray("ImageToWorld")->GetNumberOfComponents() == 16);
  const std::vector<std::string> steps = vtkLacunaProvenance::Get(map);
  LACUNA_CHECK(steps.size() == 1 && Contains(steps[0], "vtkLacunaSliceRayCaster") &&
    Contains(steps[0], "IsoValue=30 SolidSide=Above") && Contains(steps[0], "ViewUp=0,-1,0"));
  std::ostringstream text;
  caster->Print(text);
  LACUNA_CHECK(Contains(text.str(), "ViewDirection=0,0,1"));
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
    "no slice is left to look at: 3 of 3 are flagged in SliceStatus: 2 pose invalid, 1 gated out");
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
    errors([](Caster* c) { c->SetIsoValue(NotANumber); }), "IsoValue is not a number");
  LACUNA_CHECK_CONTAINS(
    errors([](Caster* c) { c->SetMaximumGap(-1); }), "MaximumGap must be positive");
  LACUNA_CHECK_CONTAINS(
    errors([](Caster* c) { c->SetMaximumGap(NotANumber); }), "MaximumGap must be positive");
  LACUNA_CHECK_CONTAINS(
    errors([](Caster* c) { c->SetViewDirection(0, 0, 0); }), "the view direction (0, 0, 0)");
  LACUNA_CHECK_CONTAINS(errors([](Caster* c) { c->SetViewUp(0, 0, 2); }), "parallel");
  LACUNA_CHECK_CONTAINS(
    errors([](Caster* c) { c->SetFocalPoint(0, NotANumber, 0); }), "focal point");
  LACUNA_CHECK_CONTAINS(
    errors([](Caster* c) { c->SetPlaneOrigin(0, NotANumber, 0); }), "plane origin");
  LACUNA_CHECK_CONTAINS(errors([](Caster* c) { c->SetFocalPoint(VTK_DOUBLE_MAX, 0, 0); }),
    "only 2 coordinates are given");
  LACUNA_CHECK_CONTAINS(errors([](Caster* c) { c->SetPixelSpacing(-0.5); }), "pixel spacing");
  LACUNA_CHECK_CONTAINS(errors([](Caster* c) { c->SetPixelSpacing(1e-9); }), "too large");
  LACUNA_CHECK_CONTAINS(errors([](Caster* c) { c->SetImageSize(-1, 4); }), "-1 x 4");
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

void TestGrowingInput()
{
  const std::vector<Matrix4> poses = MakePoses(6);
  const auto first = [&](int count)
  { return std::vector<Matrix4>(poses.begin(), poses.begin() + count); };
  vtkNew<Caster> caster;
  FixView(caster);
  const auto update = [&](vtkImageData* stack)
  {
    caster->SetInputData(stack);
    caster->Update();
    LACUNA_CHECK(IsSame(caster->GetOutput(), CastAfresh(stack)));
    return caster->GetNumberOfCastSlices();
  };
  LACUNA_CHECK(update(MakeStack(first(2))) == 2);
  LACUNA_CHECK(update(MakeStack(first(3))) == 1);
  LACUNA_CHECK(update(MakeStack(first(3))) == 0);
  LACUNA_CHECK(update(MakeStack(first(6))) == 3);
  // the same memory with new slices in it, as a live source may have it
  const auto stack = MakeStack(first(6));
  update(stack);
  stack->GetPointData()->GetScalars()->SetTuple1(5 * 13 * 9 + 13 * 4 + 6, 0);
  stack->GetPointData()->GetScalars()->Modified();
  stack->Modified();
  LACUNA_CHECK_THAT(update(stack) == 6, "an old slice has changed");
  LACUNA_CHECK(update(MakeStack(first(4))) == 4);
  std::vector<Matrix4> moved = first(6);
  moved[1](2, 3) += 1e-6;
  LACUNA_CHECK(update(MakeStack(moved)) == 6);
  LACUNA_CHECK_THAT(update(MakeStack(moved, VTK_SHORT)) == 6, "another type");
  // a slice that was left out counts: the rest is not what it was
  LACUNA_CHECK(update(MakeStack(moved, VTK_SHORT, { 0, 8, 0, 0, 0, 0 })) == 5);

  // a new slice in front of what was solid, and with it an old one comes to count again, whose
  // pixels are no longer where they were
  std::vector<Matrix4> tangled;
  for (const double height : { 0.0, 2.0, 4.0, 1.0 })
  {
    tangled.push_back(Matrix4::Translation({ 0, 0, height }) * poses[0]);
  }
  const auto paint = [](vtkImageData* slices, int slice, double grey)
  {
    for (vtkIdType i = 0; i < 13 * 9; ++i)
    {
      slices->GetPointData()->GetScalars()->SetTuple1(slice * 13 * 9 + i, grey);
    }
  };
  const auto old = MakeStack({ tangled.begin(), tangled.end() - 1 });
  paint(old, 0, 10);
  paint(old, 1, 20);
  paint(old, 2, 100);
  LACUNA_CHECK(update(old) == 3);
  const auto grown = MakeStack(tangled);
  paint(grown, 0, 10);
  paint(grown, 1, 20);
  paint(grown, 2, 100);
  paint(grown, 3, 50);
  for (const int slice : { 0, 1, 2 })
  {
    paint(old, slice, 255);
  }
  LACUNA_CHECK(update(grown) == 1);
  LACUNA_CHECK_NEAR(GetValue(caster->GetOutput(), "Depth", 8, 6, 0), 0.5, 1e-12);

  // what does not change the casting
  update(MakeStack(MakePoses(5)));
  caster->SetMaximumGap(0.5);
  caster->Update();
  LACUNA_CHECK(caster->GetNumberOfCastSlices() == 0);
  caster->SetIsoValue(31);
  caster->Update();
  LACUNA_CHECK(caster->GetNumberOfCastSlices() == 5);
  caster->SetSolidSide(Caster::Below);
  caster->Update();
  LACUNA_CHECK(caster->GetNumberOfCastSlices() == 5);
  caster->SetViewUp(0, 1, 0);
  caster->Update();
  LACUNA_CHECK(caster->GetNumberOfCastSlices() == 5);
  caster->SetClipRectangle(1, 0, 0, 0);
  caster->Update();
  LACUNA_CHECK(caster->GetNumberOfCastSlices() == 5);

  // a map that follows the slices is laid out anew
  caster->SetFocalPoint(VTK_DOUBLE_MAX, VTK_DOUBLE_MAX, VTK_DOUBLE_MAX);
  caster->SetInputData(MakeStack(MakePoses(2)));
  caster->Update();
  std::vector<Matrix4> wider = MakePoses(3);
  wider[2](0, 3) += 5;
  caster->SetInputData(MakeStack(wider));
  caster->Update();
  LACUNA_CHECK(caster->GetNumberOfCastSlices() == 3);
}

// A source of slices whose poses move with time, or that come with time.
class SliceSource : public vtkImageAlgorithm
{
public:
  static SliceSource* New();
  vtkTypeMacro(SliceSource, vtkImageAlgorithm);
  int Executions = 0;
  bool HasTime = false;
  bool IsReplay = false;

protected:
  SliceSource() { this->SetNumberOfInputPorts(0); }
  int RequestInformation(
    vtkInformation*, vtkInformationVector**, vtkInformationVector* outputs) override
  {
    vtkInformation* info = outputs->GetInformationObject(0);
    const int extent[6] = { 0, 12, 0, 8, 0, 4 };
    info->Set(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), extent, 6);
    if (this->HasTime)
    {
      const double steps[2] = { 0, 100 };
      info->Set(vtkStreamingDemandDrivenPipeline::TIME_STEPS(), steps, 2);
      info->Set(vtkStreamingDemandDrivenPipeline::TIME_RANGE(), steps, 2);
    }
    return 1;
  }
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector* outputs) override
  {
    ++this->Executions;
    vtkInformation* info = outputs->GetInformationObject(0);
    const double time = info->Has(vtkStreamingDemandDrivenPipeline::UPDATE_TIME_STEP())
      ? info->Get(vtkStreamingDemandDrivenPipeline::UPDATE_TIME_STEP())
      : 0;
    vtkImageData* output = vtkImageData::GetData(outputs);
    std::vector<unsigned char> status(5, 0);
    for (int slice = 0; this->IsReplay && slice < 5; ++slice)
    {
      status[slice] = slice < time ? 0 : 2; // the image is still to come
    }
    const auto stack = MakeStack(MakePoses(5, this->IsReplay ? 0 : time), VTK_SHORT, status);
    for (vtkIdType i = 0; i < stack->GetNumberOfPoints(); ++i)
    {
      if (status[i / (13 * 9)] != 0)
      {
        stack->GetPointData()->GetScalars()->SetTuple1(i, 0);
      }
    }
    output->ShallowCopy(stack);
    if (this->HasTime)
    {
      output->GetInformation()->Set(vtkDataObject::DATA_TIME_STEP(), time);
    }
    return 1;
  }
};
vtkStandardNewMacro(SliceSource);

void TestPipeline()
{
  vtkNew<SliceSource> source;
  vtkNew<Caster> caster;
  LookAlong(caster);
  caster->SetInputConnection(source->GetOutputPort());
  caster->UpdateInformation();
  int whole[6];
  caster->GetOutputInformation(0)->Get(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), whole);
  LACUNA_CHECK_THAT(
    whole[1] == 12 && whole[3] == 8 && whole[5] == 0, "whole extent before the data");
  caster->Update();
  caster->SetMaximumGap(3);
  caster->Update();
  LACUNA_CHECK(source->Executions == 1);
  source->Modified();
  caster->Update();
  LACUNA_CHECK(source->Executions == 2);

  // a source that moves with time; the map goes with it
  vtkNew<SliceSource> moving;
  moving->HasTime = true;
  caster->SetInputConnection(moving->GetOutputPort());
  for (const double time : { 0.0, 100.0, 0.0 })
  {
    caster->UpdateTimeStep(time);
    LACUNA_CHECK_NEAR(caster->GetOutput()->GetOrigin()[2], time, 1e-9);
    LACUNA_CHECK_NEAR(GetValue(caster->GetOutput(), "Depth", 6, 4, 0), 1.6, 1e-9);
  }

  // slices that come with time: the map is that of the whole sweep from the beginning
  vtkNew<SliceSource> replay;
  replay->HasTime = replay->IsReplay = true;
  vtkNew<Caster> watching;
  LookAlong(watching);
  watching->SetInputConnection(replay->GetOutputPort());
  const auto messages = lacunaCheck::Watch(watching);
  for (const int time : { 0, 1, 2, 3, 5 })
  {
    watching->UpdateTimeStep(time);
    vtkImageData* map = watching->GetOutput();
    LACUNA_CHECK(map->GetNumberOfPoints() == 13 * 9);
    LACUNA_CHECK(watching->GetNumberOfCastSlices() == (time == 5 ? 2 : time == 0 ? 0 : 1));
    // grey = 14 + 10 z at column 6 of row 4
    LACUNA_CHECK(std::isnan(GetValue(map, "Depth", 6, 4, 0)) == (time < 3));
  }
  LACUNA_CHECK_NEAR(GetValue(watching->GetOutput(), "Depth", 6, 4, 0), 1.6, 1e-12);
  watching->UpdateTimeStep(2);
  LACUNA_CHECK_THAT(watching->GetNumberOfCastSlices() == 2, "back in time all is cast anew");
  LACUNA_CHECK_THAT(messages->Errors.empty() && messages->Warnings.empty(),
    "nothing to say of slices that are still to come: " + messages->Errors + messages->Warnings);

  // stopped by the user, and then not
  vtkNew<Caster> stopped;
  LookAlong(stopped);
  stopped->SetInputData(MakeStack(MakePoses(5)));
  stopped->SetPixelSpacing(0.01);
  vtkNew<vtkCallbackCommand> stop;
  stop->SetCallback([](vtkObject* object, unsigned long, void*, void*)
    { vtkAlgorithm::SafeDownCast(object)->SetAbortExecute(1); });
  const unsigned long tag = stopped->AddObserver(vtkCommand::ProgressEvent, stop);
  stopped->Update();
  LACUNA_CHECK_THAT(stopped->GetOutput()->GetNumberOfPoints() == 0, "nothing is left when stopped");
  stopped->RemoveObserver(tag);
  stopped->SetAbortExecute(0);
  stopped->Modified();
  stopped->Update();
  LACUNA_CHECK_NEAR(GetValue(stopped->GetOutput(), "Depth", 300, 200, 0), 1.6, 1e-9);
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
  TestGrowingInput();
  TestPipeline();
  return lacunaCheck::Result();
}
