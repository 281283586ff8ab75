// SPDX-License-Identifier: BSD-3-Clause
// Perspective, start depth maps, cut-away functions, thickness and their errors.
#include "vtkLacunaBSplineIsoRayCaster.h"

#include "lacunaCheck.h"
#include "lacunaDepthMap.h"
#include "lacunaVersionCompat.h"
#include "vtkAbstractArray.h"
#include "vtkBox.h"
#include "vtkCallbackCommand.h"
#include "vtkCylinder.h"
#include "vtkDataArray.h"
#include "vtkDataObject.h"
#include "vtkDoubleArray.h"
#include "vtkExecutive.h"
#include "vtkFieldData.h"
#include "vtkImageAlgorithm.h"
#include "vtkImageData.h"
#include "vtkImplicitBoolean.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkNew.h"
#include "vtkPlane.h"
#include "vtkPlanes.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkQuadric.h"
#include "vtkSmartPointer.h"
#include "vtkSphere.h"
#include "vtkTransform.h"
#include "vtkVariant.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

namespace
{
using Caster = vtkLacunaBSplineIsoRayCaster;

vtkSmartPointer<vtkImageData> MakeVolume(const std::function<double(const double*)>& valueAt)
{
  auto volume = vtkSmartPointer<vtkImageData>::New();
  volume->SetExtent(2, 31, -4, 25, 7, 36);
  volume->SetOrigin(-16.5, -10.5, -21.5); // centred at 0
  volume->AllocateScalars(VTK_DOUBLE, 1);
  volume->GetPointData()->GetScalars()->SetName("Values");
  for (vtkIdType i = 0; i < volume->GetNumberOfPoints(); ++i)
  {
    volume->GetPointData()->GetScalars()->SetTuple1(i, valueAt(volume->GetPoint(i)));
  }
  return volume;
}

/// Solid within 10 mm of the origin, exactly.
vtkSmartPointer<vtkImageData> MakeBall()
{
  return MakeVolume(
    [](const double* p) { return 101 - (p[0] * p[0] + p[1] * p[1] + p[2] * p[2] + 1); });
}

vtkSmartPointer<Caster> MakeCaster(vtkImageData* volume)
{
  auto caster = vtkSmartPointer<Caster>::New();
  caster->SetInputData(volume);
  caster->SetIsoValue(0, 0);
  caster->SetImageSize(41, 31);
  caster->SetPixelSpacing(0.5);
  caster->SetViewDirection(0, 0, -1);
  caster->SetPlaneOrigin(0, 0, 20);
  return caster;
}

double DepthAt(Caster* caster, int column, int row, const char* name = "Depth")
{
  caster->Update();
  int pixel[3] = { column, row, 0 };
  vtkImageData* map = caster->GetOutput();
  vtkDataArray* array = map->GetPointData()->GetArray(name);
  return array ? array->GetTuple1(map->ComputePointId(pixel)) : std::nan("");
}

bool IsNear(double a, double b, double tolerance = 1e-9)
{
  return std::abs(a - b) <= tolerance;
}

void TestCutAways()
{
  const auto ball = MakeBall();
  const auto caster = MakeCaster(ball);
  // the middle pixel (20, 15) looks along x = y = 0: the ball's top is at z = sqrt(99)
  const double top = 20 - std::sqrt(99.0);
  LACUNA_CHECK_THAT(IsNear(DepthAt(caster, 20, 15), top), "nothing cut");

  vtkNew<vtkPlane> plane;
  plane->SetOrigin(0, 0, 4);
  plane->SetNormal(0, 0, -1); // what is above is cut away
  caster->SetCutAway(plane);
  LACUNA_CHECK_THAT(IsNear(DepthAt(caster, 20, 15), 16), "plane");
  LACUNA_CHECK_THAT(
    caster->GetOutput()->GetPointData()->GetNormals()->GetTuple3(15 * 41 + 20)[2] == 1,
    "the cap's normal");
  plane->SetOrigin(0, 0, 5);
  LACUNA_CHECK_THAT(IsNear(DepthAt(caster, 20, 15), 15), "a function changed in place");
  caster->CapCutAwayOff();
  LACUNA_CHECK_THAT(std::isnan(DepthAt(caster, 20, 15)), "not capped");
  caster->CapCutAwayOn();

  vtkNew<vtkBox> box;
  box->SetBounds(-3, 3, -4, 4, -2, 30);
  caster->SetCutAway(box);
  LACUNA_CHECK_THAT(IsNear(DepthAt(caster, 20, 15), 22), "box");
  LACUNA_CHECK_THAT(IsNear(DepthAt(caster, 20 + 7, 15), 20 - std::sqrt(99 - 3.5 * 3.5)), "beside");
  vtkNew<vtkTransform> transform; // world to box: twice as large and moved
  transform->Scale(2, 2, 2);
  transform->Translate(1, 0, 3);
  box->SetTransform(transform);
  // -2 < 2 (z + 3) < 30 and -3 < 2 (x + 1) < 3
  LACUNA_CHECK_THAT(IsNear(DepthAt(caster, 20, 15), 24), "a box with a transform");
  LACUNA_CHECK_THAT(IsNear(DepthAt(caster, 20 + 2, 15), 20 - std::sqrt(99 - 1.0)), "beside it");

  vtkNew<vtkSphere> sphere;
  sphere->SetCenter(0, 0, 10);
  sphere->SetRadius(6);
  caster->SetCutAway(sphere);
  LACUNA_CHECK_THAT(IsNear(DepthAt(caster, 20, 15), 16), "sphere");

  vtkNew<vtkCylinder> cylinder; // along y
  cylinder->SetCenter(0, 0, 10);
  cylinder->SetRadius(5);
  caster->SetCutAway(cylinder);
  LACUNA_CHECK_THAT(
    IsNear(DepthAt(caster, 20 + 2, 15 + 6), 20 - (10 - std::sqrt(24.0))), "cylinder");

  vtkNew<vtkPlanes> planes;
  vtkNew<vtkPoints> points;
  vtkNew<vtkDoubleArray> normals;
  normals->SetNumberOfComponents(3);
  points->InsertNextPoint(0, 0, 3);
  normals->InsertNextTuple3(0, 0, -1);
  points->InsertNextPoint(2.25, 0, 0);
  normals->InsertNextTuple3(1, 0, 0);
  planes->SetPoints(points);
  planes->SetNormals(normals);
  caster->SetCutAway(planes);
  LACUNA_CHECK_THAT(IsNear(DepthAt(caster, 20, 15), 17), "planes");
  LACUNA_CHECK_THAT(IsNear(DepthAt(caster, 26, 15), 20 - std::sqrt(99 - 9.0)), "beside planes");

  vtkNew<vtkImplicitBoolean> both; // sampled
  both->SetOperationTypeToUnion();
  both->AddFunction(sphere);
  both->AddFunction(plane);
  caster->SetCutAway(both);
  LACUNA_CHECK_THAT(IsNear(DepthAt(caster, 20, 15), 16), "any function: the deeper of two");
  caster->SetCutAway(nullptr);
  LACUNA_CHECK_THAT(IsNear(DepthAt(caster, 20, 15), top), "whole again");
}

std::string ProvenanceOf(Caster* caster)
{
  caster->Update();
  vtkAbstractArray* text = caster->GetOutput()->GetFieldData()->GetAbstractArray("Provenance");
  return text ? text->GetVariantValue(text->GetNumberOfValues() - 1).ToString() : "";
}

/// The provenance tells what was cut away.
void TestCutAwayProvenance()
{
  const auto caster = MakeCaster(MakeBall());
  const auto tells = [&caster](vtkImplicitFunction* function, const std::string& part)
  {
    caster->SetCutAway(function);
    const std::string text = ProvenanceOf(caster);
    LACUNA_CHECK_CONTAINS(text, part);
    LACUNA_CHECK_THAT(text.find("0x") == std::string::npos, text);
    LACUNA_CHECK_THAT(text.find("Time") == std::string::npos, text);
  };
  tells(nullptr, "CutAway=None");
  LACUNA_CHECK_CONTAINS(ProvenanceOf(caster), "ComputeThickness=off");
  caster->ComputeThicknessOn();
  LACUNA_CHECK_CONTAINS(ProvenanceOf(caster), "ComputeThickness=on");
  vtkNew<vtkPlane> plane;
  plane->SetOrigin(0, 0.5, 4);
  plane->SetNormal(0, 0, -1);
  tells(plane, "CutAway=\"vtkPlane Origin=0,0.5,4 Normal=0,0,-1\"");
  vtkNew<vtkTransform> transform;
  transform->Translate(1, 2, 3);
  transform->Scale(2, 2, 4);
  plane->SetTransform(transform);
  tells(plane, "Normal=0,0,-1 Transform=2,0,0,1,0,2,0,2,0,0,4,3,0,0,0,1");
  vtkNew<vtkBox> box;
  box->SetBounds(-3, 3, -4, 4.25, -2, 30);
  tells(box, "\"vtkBox Bounds=-3,3,-4,4.25,-2,30\"");
  vtkNew<vtkSphere> sphere;
  sphere->SetCenter(1, 2, 3);
  sphere->SetRadius(4.5);
  tells(sphere, "\"vtkSphere Center=1,2,3 Radius=4.5\"");
  vtkNew<vtkCylinder> cylinder;
  cylinder->SetAxis(0, 0, 2);
  cylinder->SetCenter(1, 2, 3);
  tells(cylinder, "\"vtkCylinder Center=1,2,3 Axis=0,0,1 Radius=0.5\"");
  vtkNew<vtkPlanes> planes;
  planes->SetBounds(-1, 1, -2, 2, -3, 3.5);
  tells(planes, "\"vtkPlanes Origins=-1,");
  LACUNA_CHECK_CONTAINS(ProvenanceOf(caster), "Normals=-1,0,0,1,0,0,0,-1,0,");
  vtkNew<vtkImplicitBoolean> both;
  both->SetOperationTypeToDifference();
  both->AddFunction(sphere);
  both->AddFunction(box);
  tells(both, "vtkImplicitBoolean Operation=Difference Part=");
  LACUNA_CHECK_CONTAINS(ProvenanceOf(caster), "vtkSphere Center=1,2,3 Radius=4.5");
  LACUNA_CHECK_CONTAINS(ProvenanceOf(caster), "vtkBox Bounds=-3,3,-4,4.25,-2,30");
  vtkNew<vtkQuadric> quadric; // prints itself
  quadric->SetCoefficients(1, 1, 0, 0, 0, 0, 0, 0, 0, -4.75);
  tells(quadric, "vtkQuadric Printed=");
  LACUNA_CHECK_CONTAINS(ProvenanceOf(caster), "-4.75");
  const std::string before = ProvenanceOf(caster);
  vtkNew<vtkCallbackCommand> observer;
  quadric->AddObserver(vtkCommand::ModifiedEvent, observer);
  quadric->Modified();
  LACUNA_CHECK(ProvenanceOf(caster) == before);
}

void TestPerspective()
{
  const auto ball = MakeBall();
  vtkNew<Caster> caster;
  caster->SetInputData(ball);
  caster->SetIsoValue(0, 0);
  caster->SetProjection(Caster::Perspective);
  caster->SetEyePosition(30, -20, 40);
  caster->SetViewDirection(-30, 20, -40);
  caster->SetViewAngle(25);
  caster->SetImageSize(40, 30);
  caster->ComputeThicknessOn();
  caster->Update();
  vtkImageData* output = caster->GetOutput();
  const lacuna::DepthMap map(output);
  LACUNA_CHECK_THAT(map.IsPerspective(), "EyePosition is recorded");
  LACUNA_CHECK_THAT(
    IsNear(output->GetFieldData()->GetArray("ViewAngle")->GetTuple1(0), 25), "ViewAngle");
  int hits = 0;
  for (vtkIdType i = 0; i < output->GetNumberOfPoints(); ++i)
  {
    const double depth = map.GetDepth()->GetTuple1(i);
    if (!std::isnan(depth))
    {
      ++hits;
      const lacuna::Vec3 p =
        map.GetPoint(static_cast<double>(i % 40), static_cast<double>(i / 40), depth);
      LACUNA_CHECK_THAT(IsNear(lacuna::Norm(p), std::sqrt(99.0)), "on the sphere");
      const double thickness = output->GetPointData()->GetArray("Thickness")->GetTuple1(i);
      const lacuna::Vec3 far =
        p + thickness * map.GetRay(static_cast<double>(i % 40), static_cast<double>(i / 40));
      LACUNA_CHECK_THAT(IsNear(lacuna::Norm(far), std::sqrt(99.0), 1e-8), "its far side");
    }
  }
  LACUNA_CHECK_THAT(hits > 100, "the sphere is seen");
}

void TestStartDepthMap()
{
  // a hollow ball
  const auto shell = MakeVolume(
    [](const double* p)
    {
      const double r = std::sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
      return 3 - std::abs(r - 10);
    });
  const auto first = MakeCaster(shell);
  first->ComputeThicknessOn();
  const double hit = DepthAt(first, 20, 15);
  const double thickness = DepthAt(first, 20, 15, "Thickness");
  const auto next = MakeCaster(shell);
  next->SetStartDepthMapConnection(first->GetOutputPort());
  const double second = DepthAt(next, 20, 15);
  LACUNA_CHECK_THAT(IsNear(hit, 7, 0.1) && IsNear(thickness, 6, 0.2), "the near wall");
  LACUNA_CHECK_THAT(IsNear(second, 27, 0.1), "the far wall");
  const auto inner = MakeCaster(shell);
  inner->SetSolidSide(Caster::Below);
  inner->SetStartDepthMapConnection(first->GetOutputPort());
  LACUNA_CHECK_THAT(IsNear(DepthAt(inner, 20, 15), hit + thickness), "the near wall's other side");
  const auto higher = MakeCaster(shell);
  higher->SetIsoValue(0, 1);
  higher->SetStartDepthMapConnection(first->GetOutputPort());
  LACUNA_CHECK_THAT(IsNear(DepthAt(higher, 20, 15), 8, 0.1), "a higher iso-value");

  vtkNew<lacunaCheck::Messages> messages;
  messages->Watch(next);
  messages->Watch(next->GetExecutive());
  next->SetPixelSpacing(0.4);
  next->Update();
  LACUNA_CHECK_THAT(messages->HasError("shows another view"), "another pixel spacing");
  next->SetPixelSpacing(0.5);
  LACUNA_CHECK_THAT(IsNear(DepthAt(next, 20, 15), second), "recovered");
}

void CheckError(Caster* caster, const std::string& text)
{
  vtkNew<lacunaCheck::Messages> messages;
  messages->Watch(caster);
  messages->Watch(caster->GetExecutive());
  caster->Update();
  LACUNA_CHECK_THAT(messages->HasError(text), text);
}

// Moves an image and does not announce it, as vtkResampleToImage does in ParaView.
class SilentMover : public vtkImageAlgorithm
{
public:
  static SilentMover* New() { VTK_STANDARD_NEW_BODY(SilentMover); }
  vtkTypeMacro(SilentMover, vtkImageAlgorithm);
  bool AnnouncesDirection = true; ///< another than it gives

protected:
  int RequestInformation(
    vtkInformation*, vtkInformationVector**, vtkInformationVector* outputs) override
  {
    vtkInformation* information = outputs->GetInformationObject(0);
    information->Remove(vtkDataObject::DIRECTION());
    if (this->AnnouncesDirection)
    {
      const double direction[9] = { 1, 0, 0, 0, -1, 0, 0, 0, -1 };
      information->Set(vtkDataObject::DIRECTION(), direction, 9);
    }
    return 1;
  }
  int RequestData(
    vtkInformation*, vtkInformationVector** inputs, vtkInformationVector* outputs) override
  {
    vtkImageData* output = vtkImageData::GetData(outputs);
    output->ShallowCopy(vtkImageData::GetData(inputs[0]));
    output->SetOrigin(50, 0, 0);
    return 1;
  }
};

void TestSilentMover()
{
  const auto ball = MakeBall();
  vtkNew<SilentMover> mover;
  mover->SetInputData(ball);
  auto caster = MakeCaster(ball);
  caster->SetPlaneOrigin(VTK_DOUBLE_MAX, VTK_DOUBLE_MAX, VTK_DOUBLE_MAX);
  caster->SetImageSize(0, 0);
  caster->SetInputConnection(mover->GetOutputPort());
  for (const bool announces : { true, false })
  {
    mover->AnnouncesDirection = announces;
    mover->Modified();
    caster->Update();
    const double* bounds = caster->GetOutput()->GetBounds();
    LACUNA_CHECK_THAT(IsNear(bounds[0], mover->GetOutput()->GetBounds()[0], 1) &&
        IsNear(bounds[2], mover->GetOutput()->GetBounds()[2], 1),
      "where the voxels are");
  }
}

/// Stopped, and what VTK copies of what it announces has no direction.
class StoppedMover : public SilentMover
{
public:
  static StoppedMover* New() { VTK_STANDARD_NEW_BODY(StoppedMover); }
  vtkTypeMacro(StoppedMover, SilentMover);

protected:
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override
  {
    this->AbortExecuteOn();
    lacuna::CheckAbort(this);
    return 1;
  }
};

// The eye sees the data where their direction puts them; without it they would lie behind it.
void TestStoppedInput()
{
  const auto ball = MakeBall();
  ball->SetDirectionMatrix(1, 0, 0, 0, -1, 0, 0, 0, -1);
  vtkNew<StoppedMover> mover;
  mover->AnnouncesDirection = false;
  mover->SetInputData(ball);
  auto caster = MakeCaster(ball);
  caster->SetPlaneOrigin(VTK_DOUBLE_MAX, VTK_DOUBLE_MAX, VTK_DOUBLE_MAX);
  caster->SetImageSize(0, 0);
  caster->SetProjection(Caster::Perspective);
  caster->SetEyePosition(0, 0, ball->GetOrigin()[2] - 0.5);
  caster->SetInputConnection(mover->GetOutputPort());
  vtkNew<lacunaCheck::Messages> messages;
  messages->Watch(caster);
  vtkNew<lacunaCheck::Messages> executiveMessages; // of VTK 9.1, which repeats the error
  executiveMessages->Watch(caster->GetExecutive());
  caster->Update();
  // where algorithms are not told of stops upstream, they miss their data
  LACUNA_CHECK_THAT(!lacuna::TellsOfAbort || !messages->HasError("eye"), "no message");
  LACUNA_CHECK_THAT(caster->GetOutput()->GetNumberOfPoints() == 0, "no output");
}

void TestErrors()
{
  const auto ball = MakeBall();
  auto caster = MakeCaster(ball);
  caster->SetProjection(Caster::Perspective);
  CheckError(caster, "needs EyePosition");
  caster->SetEyePosition(0, 0, -200);
  CheckError(caster, "behind the eye");
  caster->SetEyePosition(0, 0, 200);
  caster->SetViewAngle(0);
  CheckError(caster, "ViewAngle is 0 degrees; it must be above 0 and at most 180 degrees");
  caster->SetViewAngle(180);
  CheckError(caster, "view angle of 180");
  caster->SetViewAngle(30);
  caster->SetProjection(Caster::Parallel);
  caster->SetPlaneOrigin(0, VTK_DOUBLE_MAX, 3);
  CheckError(caster, "give all three");
  caster->SetPlaneOrigin(0, 0, 20);
  vtkNew<vtkPlane> plane;
  plane->SetOrigin(0, 0, std::nan(""));
  caster->SetCutAway(plane);
  CheckError(caster, "CutAway: of the plane Origin is 0,0,nan");
  caster->SetCutAway(nullptr);
  ball->SetSpacing(1, 0, 1);
  CheckError(caster, "every edge must be longer than 0");
  ball->SetSpacing(1, 1, std::nan(""));
  CheckError(caster, "its spacing is 1 1 nan; these must be finite numbers");
  ball->SetSpacing(1, 1, 1);
  ball->SetDirectionMatrix(1, 0, 1, 0, 1, 0, 0, 0, 0);
  CheckError(caster, "the direction matrix of the volume is 1,0,1,0,1,0,0,0,0:");
  ball->SetDirectionMatrix(1, 0, 0, 0, std::nan(""), 0, 0, 0, 1);
  CheckError(caster, "1 0 0 0 nan 0 0 0 1; these must be finite numbers");
  ball->SetDirectionMatrix(1, 0, 0, 0, 1, 0, 0, 0, 1);
  LACUNA_CHECK_THAT(IsNear(DepthAt(caster, 20, 15), 20 - std::sqrt(99.0)), "recovered");

  ball->GetPointData()->GetScalars()->SetTuple1(0, -1e20);
  ball->GetPointData()->GetScalars()->Modified();
  ball->Modified();
  vtkNew<lacunaCheck::Messages> messages;
  messages->Watch(caster);
  caster->Update();
  LACUNA_CHECK_THAT(!messages->HasWarning("swings"), "BSpline stays within its control points");
  caster->SetInterpolation(Caster::InterpolatingBSpline);
  caster->Update();
  LACUNA_CHECK_THAT(
    messages->HasWarning("-1e+20") && messages->HasWarning("Threshold"), "padding values ring");
}

/// What is warned of at an iso-value.
std::string WarningsOf(
  vtkImageData* volume, double isoValue, int interpolation,
  const std::function<void(Caster*)>& set = [](Caster*) {})
{
  const auto caster = MakeCaster(volume);
  caster->SetIsoValue(0, isoValue);
  caster->SetInterpolation(interpolation);
  set(caster);
  const auto messages = lacunaCheck::Watch(caster);
  caster->Update();
  LACUNA_CHECK_THAT(messages->Errors.empty(), messages->Errors);
  return messages->Warnings;
}

int CountHits(vtkImageData* volume, double isoValue, int interpolation)
{
  const auto caster = MakeCaster(volume);
  caster->SetIsoValue(0, isoValue);
  caster->SetInterpolation(interpolation);
  caster->Update();
  vtkDataArray* depth = caster->GetOutput()->GetPointData()->GetArray("Depth");
  int hits = 0;
  for (vtkIdType i = 0; i < depth->GetNumberOfTuples(); ++i)
  {
    hits += !std::isnan(depth->GetTuple1(i));
  }
  return hits;
}

/// Iso-values that no voxel reaches.
void TestBeyondTheVoxels()
{
  const auto box = MakeVolume(
    [](const double* p) {
      return std::max({ std::abs(p[0]), std::abs(p[1]), std::abs(p[2]) }) < 7 ? 100.0 : 0.0;
    });
  LACUNA_CHECK(CountHits(box, 104, Caster::InterpolatingBSpline) > 100);
  const std::string overshoot = WarningsOf(box, 104, Caster::InterpolatingBSpline);
  LACUNA_CHECK_CONTAINS(overshoot, "range from 0 to 100: what is seen is the overshoot");
  LACUNA_CHECK_THAT(overshoot.find("empty") == std::string::npos, overshoot);
  LACUNA_CHECK_CONTAINS(
    WarningsOf(box, 1000, Caster::InterpolatingBSpline), "from 0 to 100: Depth is empty");
  for (const int interpolation : { Caster::BSpline, Caster::Trilinear })
  {
    LACUNA_CHECK(CountHits(box, 104, interpolation) == 0);
    LACUNA_CHECK_CONTAINS(WarningsOf(box, 104, interpolation), "from 0 to 100: Depth is empty");
  }
  LACUNA_CHECK_CONTAINS(WarningsOf(box, -1, Caster::BSpline, [](Caster* c) { c->CapBoundaryOn(); }),
    "from 0 to 100: what is seen is where the solid is cut or ends");
  LACUNA_CHECK(WarningsOf(box, 100, Caster::BSpline).empty());

  const auto nothing = MakeVolume([](const double*) { return std::nan(""); });
  for (const int interpolation : { Caster::BSpline, Caster::InterpolatingBSpline })
  {
    const std::string warnings = WarningsOf(nothing, 5, interpolation);
    LACUNA_CHECK_CONTAINS(warnings, "no voxel of array 'Values' is a finite number");
    LACUNA_CHECK_THAT(warnings.find("inf") == std::string::npos, warnings);
    LACUNA_CHECK(CountHits(nothing, 5, interpolation) == 0);
  }
}

/// Padding is found, and nothing is taken for it in data of 16 bits.
void TestPadding()
{
  const auto swings = [](vtkImageData* volume, double isoValue)
  {
    return WarningsOf(volume, isoValue, Caster::InterpolatingBSpline).find("swings") !=
      std::string::npos;
  };
  const auto bytes = MakeVolume([](const double* p) { return std::abs(p[0]) < 7 ? 255.0 : 0.0; });
  const auto shorts =
    MakeVolume([](const double* p) { return std::abs(p[0]) < 7 ? 32767.0 : -32768.0; });
  const auto words = MakeVolume([](const double* p) { return std::abs(p[0]) < 7 ? 65535.0 : 0.0; });
  for (const double isoValue : { 255.0, 254.9995, 0.0005, 0.0, 128.0, 1e-12 })
  {
    LACUNA_CHECK_THAT(!swings(bytes, isoValue), std::to_string(isoValue));
    LACUNA_CHECK_THAT(!swings(shorts, isoValue), std::to_string(isoValue));
    LACUNA_CHECK_THAT(!swings(words, isoValue), std::to_string(isoValue));
  }
  LACUNA_CHECK(!swings(shorts, 32767) && !swings(shorts, -32768) && !swings(words, 65535));
  for (const double padding : { 1e9, -1e9, -1e12, 1e20, -1e20, -3.4e38 })
  {
    for (const double isoValue : { 500.0, 0.0005, 0.0, -1000.0, 30000.0 })
    {
      const auto padded = MakeVolume(
        [padding](const double* p) { return p[0] > 12 ? padding : 1000 - 100 * std::abs(p[0]); });
      LACUNA_CHECK_THAT(swings(padded, isoValue), std::to_string(padding));
    }
  }
}
}

int TestIsoRayCasterRequests(int, char*[])
{
  TestCutAways();
  TestCutAwayProvenance();
  TestPerspective();
  TestStartDepthMap();
  TestSilentMover();
  TestStoppedInput();
  TestErrors();
  TestBeyondTheVoxels();
  TestPadding();
  return lacunaCheck::Result();
}
