// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaBSplineIsoRayCaster.h"

#include "lacunaCheck.h"
#include "lacunaDepthMap.h"
#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkExecutive.h"
#include "vtkFieldData.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkMath.h"
#include "vtkMatrix3x3.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkSOADataArrayTemplate.h"
#include "vtkSmartPointer.h"
#include "vtkSphere.h"
#include "vtkStringArray.h"
#include "vtkTestErrorObserver.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <sstream>
#include <string>

#ifdef __linux__
#include <sys/resource.h>
#endif

namespace
{
using Caster = vtkLacunaBSplineIsoRayCaster;

/// A volume with values of a world position, in an awkward frame and with an awkward extent.
vtkSmartPointer<vtkImageData> MakeVolume(
  int type, bool mirrored, const std::function<double(const double*)>& valueAt)
{
  auto volume = vtkSmartPointer<vtkImageData>::New();
  volume->SetExtent(5, 24, -3, 14, 100, 116);
  volume->SetOrigin(3, -70, 12);
  volume->SetSpacing(1, 1.25, 0.8);
  // a quarter turn about z; mirrored: its first axis reversed
  const double s = mirrored ? 1 : -1;
  volume->SetDirectionMatrix(0, -1, 0, -s, 0, 0, 0, 0, 1);
  volume->AllocateScalars(type, 1);
  vtkDataArray* scalars = volume->GetPointData()->GetScalars();
  scalars->SetName("Values");
  for (vtkIdType i = 0; i < volume->GetNumberOfPoints(); ++i)
  {
    scalars->SetTuple1(i, valueAt(volume->GetPoint(i)));
  }
  return volume;
}

void CentreOf(vtkImageData* volume, double centre[3])
{
  const int* e = volume->GetExtent();
  volume->TransformContinuousIndexToPhysicalPoint(
    0.5 * (e[0] + e[1]), 0.5 * (e[2] + e[3]), 0.5 * (e[4] + e[5]), centre);
}

/// Half a plane and a step: an asymmetric roof, seen from three sides.
void TestContract()
{
  const auto roof = [](const double* p) { return 0.5 * p[0] - p[2] + 0.25 * p[1]; };
  for (const bool mirrored : { false, true })
  {
    const auto volume = MakeVolume(VTK_FLOAT, mirrored, roof);
    double centre[3];
    CentreOf(volume, centre);
    const double isoValue = roof(centre);
    for (const int interpolation :
      { Caster::BSpline, Caster::InterpolatingBSpline, Caster::Trilinear })
    {
      vtkNew<Caster> caster;
      caster->SetInputData(volume);
      caster->SetInterpolation(interpolation);
      caster->SetIsoValue(0, isoValue);
      caster->SetIsoValue(1, isoValue + 1);
      caster->SetViewDirection(1, 2, -8);
      caster->SetViewUp(0, 1, 0);
      caster->SetPixelSpacing(0.75);
      caster->Update();
      vtkImageData* map = caster->GetOutput();
      vtkPointData* data = map->GetPointData();
      vtkDataArray* depth = data->GetArray("Depth");
      vtkDataArray* next = data->GetArray("Depth_1");
      vtkDataArray* mask = data->GetArray("vtkValidPointMask");
      vtkDataArray* normals = data->GetArray("Normals");
      if (!depth || !next || !mask || !normals)
      {
        LACUNA_CHECK_THAT(false, "arrays of the contract");
        return;
      }
      LACUNA_CHECK_THAT(
        depth->GetDataType() == VTK_DOUBLE && next->GetDataType() == VTK_DOUBLE, "double");
      LACUNA_CHECK_THAT(mask->GetDataType() == VTK_CHAR, "char mask");
      LACUNA_CHECK_THAT(
        normals->GetDataType() == VTK_FLOAT && normals->GetNumberOfComponents() == 3, "normals");
      LACUNA_CHECK_THAT(data->GetScalars() == depth, "Depth is active");
      LACUNA_CHECK_THAT(data->GetNormals() == normals, "Normals are active");
      vtkDataArray* isoValues = map->GetFieldData()->GetArray("IsoValues");
      LACUNA_CHECK_THAT(
        isoValues && isoValues->GetNumberOfTuples() == 2 && isoValues->GetTuple1(1) == isoValue + 1,
        "IsoValues");
      LACUNA_CHECK_THAT(
        map->GetFieldData()->GetAbstractArray("Provenance") != nullptr, "Provenance");
      const int* dimensions = map->GetDimensions();
      LACUNA_CHECK_THAT(
        dimensions[2] == 1 && map->GetExtent()[0] == 0 && map->GetExtent()[2] == 0, "W x H x 1");

      const lacuna::DepthMap checked(map);
      // the direction matrix is (right, down, view), right-handed
      vtkMatrix3x3* d = map->GetDirectionMatrix();
      LACUNA_CHECK_THAT(std::abs(d->Determinant() - 1) < 1e-12, "right-handed");
      LACUNA_CHECK_THAT(
        std::abs(d->GetElement(0, 2) - 1 / std::sqrt(69.0)) < 1e-12 && d->GetElement(2, 2) < 0,
        "z = ViewDirection");
      LACUNA_CHECK_THAT(d->GetElement(1, 1) < -0.9, "y is down: against ViewUp");
      LACUNA_CHECK_THAT(d->GetElement(0, 0) > 0.9, "x is the viewer's right");
      vtkIdType hits = 0;
      for (int r = 0; r < dimensions[1]; ++r)
      {
        for (int c = 0; c < dimensions[0]; ++c)
        {
          const vtkIdType i = c + static_cast<vtkIdType>(r) * dimensions[0];
          const double z = depth->GetTuple1(i);
          LACUNA_CHECK_THAT((mask->GetTuple1(i) == 1) == !std::isnan(z), "mask tells NaN");
          if (std::isnan(z))
          {
            continue;
          }
          ++hits;
          // The map's own point, not the kernel's, lies on the true plane.
          const lacuna::Vec3 p = checked.GetPoint(c, r, z);
          LACUNA_CHECK_THAT(std::abs(roof(p.data()) - isoValue) < 3e-5, "on the surface");
          double n[3];
          normals->GetTuple(i, n);
          const double length = std::sqrt(0.25 + 1 + 0.0625);
          LACUNA_CHECK_THAT(std::abs(n[0] + 0.5 / length) + std::abs(n[1] + 0.25 / length) +
                std::abs(n[2] - 1 / length) <
              2e-5,
            "normal out of the solid");
          const double z1 = next->GetTuple1(i);
          if (!std::isnan(z1))
          {
            const lacuna::Vec3 q = checked.GetPoint(c, r, z1);
            LACUNA_CHECK_THAT(std::abs(roof(q.data()) - isoValue - 1) < 3e-5 && z1 > z, "Depth_1");
          }
        }
      }
      LACUNA_CHECK_THAT(hits > 300, "the plane is seen");
    }
  }
}

void TestTypes()
{
  const auto ball = [](const double* p)
  {
    const double d[3] = { p[0] + 4, p[1] + 56, p[2] - 98 };
    return 100 - 8 * vtkMath::Norm(d);
  };
  vtkSmartPointer<vtkImageData> reference;
  for (const int type : { VTK_DOUBLE, VTK_FLOAT, VTK_CHAR, VTK_SIGNED_CHAR, VTK_UNSIGNED_CHAR,
         VTK_SHORT, VTK_UNSIGNED_SHORT, VTK_INT, VTK_UNSIGNED_INT, VTK_LONG, VTK_UNSIGNED_LONG,
         VTK_LONG_LONG, VTK_UNSIGNED_LONG_LONG, VTK_ID_TYPE })
  {
    const auto volume =
      MakeVolume(type, false, [&](const double* p) { return std::max(0.0, std::floor(ball(p))); });
    vtkNew<Caster> caster;
    caster->SetInputData(volume);
    caster->SetIsoValue(0, 40.5);
    caster->Update();
    if (!reference)
    {
      reference = vtkSmartPointer<vtkImageData>::New();
      reference->DeepCopy(caster->GetOutput());
    }
    vtkDataArray* a = reference->GetPointData()->GetArray("Depth");
    vtkDataArray* b = caster->GetOutput()->GetPointData()->GetArray("Depth");
    bool same = a && b && a->GetNumberOfTuples() == b->GetNumberOfTuples();
    int hits = 0;
    for (vtkIdType i = 0; same && i < a->GetNumberOfTuples(); ++i)
    {
      const double u = a->GetTuple1(i);
      const double v = b->GetTuple1(i);
      hits += !std::isnan(u);
      same = u == v || (std::isnan(u) && std::isnan(v));
    }
    LACUNA_CHECK_THAT(same && hits > 50, std::string("type ") + vtkImageScalarTypeNameMacro(type));
  }
  // another memory layout
  const auto volume = MakeVolume(VTK_DOUBLE, false, ball);
  vtkDataArray* values = volume->GetPointData()->GetScalars();
  vtkNew<vtkSOADataArrayTemplate<double>> structure;
  structure->SetName("Structure");
  structure->SetNumberOfComponents(1);
  structure->SetNumberOfTuples(values->GetNumberOfTuples());
  for (vtkIdType i = 0; i < values->GetNumberOfTuples(); ++i)
  {
    structure->SetTuple1(i, values->GetTuple1(i));
  }
  volume->GetPointData()->AddArray(structure);
  vtkNew<Caster> caster;
  caster->SetInputData(volume);
  caster->SetIsoValue(0, 40);
  caster->Update();
  vtkNew<vtkImageData> first;
  first->DeepCopy(caster->GetOutput());
  caster->SetScalarArray("Structure");
  caster->Update();
  vtkDataArray* a = first->GetPointData()->GetArray("Depth");
  vtkDataArray* b = caster->GetOutput()->GetPointData()->GetArray("Depth");
  for (vtkIdType i = 0; i < a->GetNumberOfTuples(); ++i)
  {
    LACUNA_CHECK_THAT(a->GetTuple1(i) == b->GetTuple1(i) ||
        (std::isnan(a->GetTuple1(i)) && std::isnan(b->GetTuple1(i))),
      "structure of arrays");
  }
}

void TestRequestedExtent()
{
  const auto volume =
    MakeVolume(VTK_FLOAT, true, [](const double* p) { return std::sin(p[0]) - p[2]; });
  double centre[3];
  CentreOf(volume, centre);
  vtkNew<Caster> caster;
  caster->SetInputData(volume);
  caster->SetIsoValue(0, -centre[2]);
  caster->Update();
  vtkNew<vtkImageData> whole;
  whole->DeepCopy(caster->GetOutput());
  const int part[6] = { 3, 9, 2, 12, 0, 0 };
  vtkNew<Caster> other;
  other->SetInputData(volume);
  other->SetIsoValue(0, -centre[2]);
  other->UpdateExtent(part);
  vtkImageData* piece = other->GetOutput();
  LACUNA_CHECK_THAT(piece->GetNumberOfPoints() == 7 * 11, "exactly the requested extent");
  lacuna::DepthMap checked(piece);
  vtkIdType hits = 0;
  for (int r = part[2]; r <= part[3]; ++r)
  {
    for (int c = part[0]; c <= part[1]; ++c)
    {
      int ijk[3] = { c, r, 0 };
      const vtkIdType i = whole->ComputePointId(ijk);
      const vtkIdType j = piece->ComputePointId(ijk);
      const double a = whole->GetPointData()->GetArray("Depth")->GetTuple1(i);
      const double b = piece->GetPointData()->GetArray("Depth")->GetTuple1(j);
      hits += !std::isnan(a);
      LACUNA_CHECK_THAT(
        a == b || (std::isnan(a) && std::isnan(b)), "a piece is a part of the whole");
      double p[3];
      double q[3];
      whole->GetPoint(i, p);
      piece->GetPoint(j, q);
      LACUNA_CHECK_THAT(std::sqrt(vtkMath::Distance2BetweenPoints(p, q)) < 1e-12, "at its place");
    }
  }
  LACUNA_CHECK_THAT(hits > 40, "hits in the piece");
}

/// The error or warning that a setting gives.
std::string MessageOf(vtkImageData* volume, bool warning, const std::function<void(Caster*)>& set)
{
  vtkNew<Caster> caster;
  vtkNew<vtkTest::ErrorObserver> observer;
  caster->AddObserver(vtkCommand::ErrorEvent, observer);
  caster->AddObserver(vtkCommand::WarningEvent, observer);
  caster->GetExecutive()->AddObserver(vtkCommand::ErrorEvent, observer);
  caster->SetInputData(volume);
  caster->Update(); // so that there is an old result to get rid of
  observer->Clear();
  set(caster);
  caster->Update();
  if (!warning)
  {
    LACUNA_CHECK_THAT(caster->GetOutput()->GetNumberOfPoints() == 0, "no stale output");
  }
  return warning ? observer->GetWarningMessage() : observer->GetErrorMessage();
}

void TestBadInput()
{
  const auto volume = MakeVolume(VTK_SHORT, false, [](const double* p) { return 500 + p[2]; });
  const auto fails =
    [](vtkImageData* v, const std::string& text, const std::function<void(Caster*)>& set)
  {
    const std::string message = MessageOf(v, false, set);
    LACUNA_CHECK_THAT(message.find(text) != std::string::npos, text + ", but: " + message);
  };
  const auto warns =
    [](vtkImageData* v, const std::string& text, const std::function<void(Caster*)>& set)
  {
    const std::string message = MessageOf(v, true, set);
    LACUNA_CHECK_THAT(message.find(text) != std::string::npos, text + ", but: " + message);
  };
  fails(volume, "view direction (0, 0, 0)", [](Caster* c) { c->SetViewDirection(0, 0, 0); });
  fails(volume, "view direction (1e+200", [](Caster* c) { c->SetViewDirection(1e200, 0, 0); });
  fails(volume, "ViewUp is nan; it must be a finite number",
    [](Caster* c) { c->SetViewUp(0, vtkMath::Nan(), 0); });
  fails(volume, "view-up vector", [](Caster* c) { c->SetViewUp(0, 1e200, 0); });
  fails(volume, "parallel", [](Caster* c) { c->SetViewUp(0, 0, 3); });
  fails(volume, "PixelSpacing is -1 mm; it must be 0 (smallest voxel edge) or above 0 mm",
    [](Caster* c) { c->SetPixelSpacing(-1); });
  fails(volume, "PixelSpacing is nan mm; it must be 0 (smallest voxel edge) or above 0 mm",
    [](Caster* c) { c->SetPixelSpacing(vtkMath::Nan()); });
  fails(volume, "too large", [](Caster* c) { c->SetPixelSpacing(1e-7); });
  fails(volume, "too large", [](Caster* c) { c->SetImageSize(2000000000, 2000000000); });
  fails(volume, "ImageSize is -5 pixels; it must be 0 (whole volume) or 1 pixels or more",
    [](Caster* c) { c->SetImageSize(-5, 10); });
  fails(volume,
    "Interpolation is 3; it must be 0 (BSpline), 1 (InterpolatingBSpline) or 2 (Trilinear)",
    [](Caster* c) { c->SetInterpolation(3); });
  fails(volume, "SolidSide is -1; it must be 0 (Above) or 1 (Below)",
    [](Caster* c) { c->SetSolidSide(-1); });
  fails(volume, "NormalMethod is 2; it must be 0 (Analytic) or 1 (GreyLevel)",
    [](Caster* c) { c->SetNormalMethod(2); });
  fails(volume, "Projection is 2; it must be 0 (Parallel) or 1 (Perspective)",
    [](Caster* c) { c->SetProjection(2); });
  fails(volume, "no iso-value", [](Caster* c) { c->SetNumberOfIsoValues(0); });
  fails(volume, "IsoValues is nan grey level; it must be a finite number",
    [](Caster* c) { c->SetIsoValue(1, std::nan("")); });
  fails(volume, "IsoValues is -inf grey level; it must be a finite number",
    [](Caster* c) { c->SetIsoValue(0, -HUGE_VAL); });
  fails(volume, "CutAway: of the sphere Radius is -7",
    [](Caster* c)
    {
      vtkNew<vtkSphere> ball;
      ball->SetRadius(-7);
      c->SetCutAway(ball);
    });
  fails(volume, "no point array 'Missing'", [](Caster* c) { c->SetScalarArray("Missing"); });
  fails(volume, "3 components",
    [](Caster* c)
    {
      vtkNew<vtkImageData> colours;
      colours->SetDimensions(4, 4, 4);
      colours->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
      c->SetInputData(colours);
    });
  fails(volume, "no active point scalars",
    [](Caster* c)
    {
      vtkNew<vtkImageData> bare;
      bare->SetDimensions(4, 4, 4);
      c->SetInputData(bare);
    });
  for (const int axis : { 0, 1, 2 })
  {
    fails(volume, "at least two voxels",
      [axis](Caster* c)
      {
        int size[3] = { 6, 6, 6 };
        size[axis] = 1;
        vtkNew<vtkImageData> flat;
        flat->SetDimensions(size);
        flat->AllocateScalars(VTK_FLOAT, 1);
        c->SetInputData(flat);
      });
  }
  warns(volume, "range from 592 to 604", [](Caster* c) { c->SetIsoValue(0, 4000); });
  const auto holed = MakeVolume(VTK_FLOAT, false,
    [](const double* p) { return p[2] < 95 && p[0] < -4 ? vtkMath::Nan() : 420 + p[2]; });
  std::string message = MessageOf(holed, true, [](Caster* c) { c->SetIsoValue(0, 520); });
  int missing = 0;
  vtkDataArray* values = holed->GetPointData()->GetScalars();
  for (vtkIdType i = 0; i < values->GetNumberOfTuples(); ++i)
  {
    missing += std::isnan(values->GetTuple1(i));
  }
  LACUNA_CHECK_THAT(missing > 0 &&
      message.find(std::to_string(missing) + " voxels of array 'Values' are not finite") !=
        std::string::npos,
    message);

  vtkNew<Caster> beyond;
  beyond->SetInputData(volume);
  beyond->SetIsoValue(0, 4000);
  vtkNew<vtkTest::ErrorObserver> observer;
  beyond->AddObserver(vtkCommand::WarningEvent, observer);
  beyond->Update();
  vtkImageData* nothing = beyond->GetOutput();
  LACUNA_CHECK_THAT(nothing->GetNumberOfPoints() > 0, "a map, with nothing in it");
  for (vtkIdType i = 0; i < nothing->GetNumberOfPoints(); ++i)
  {
    LACUNA_CHECK_THAT(std::isnan(nothing->GetPointData()->GetArray("Depth")->GetTuple1(i)) &&
        nothing->GetPointData()->GetArray("vtkValidPointMask")->GetTuple1(i) == 0 &&
        nothing->GetPointData()->GetNormals()->GetTuple3(i)[2] == 0,
      "nothing is hit");
  }

  // an empty input gives an empty output and no error
  vtkNew<Caster> caster;
  vtkNew<vtkImageData> empty;
  caster->SetInputData(empty);
  caster->Update();
  LACUNA_CHECK_THAT(caster->GetOutput()->GetNumberOfPoints() == 0, "empty in, empty out");
}

/// A map for which there is no memory: an error, and the filter works again.
void TestMemory()
{
#if defined(__linux__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  const auto volume = MakeVolume(VTK_SHORT, false, [](const double* p) { return 500 + p[2]; });
  rlimit before;
  getrlimit(RLIMIT_AS, &before);
  const rlimit little{ std::min<rlim_t>(rlim_t(3) << 30, before.rlim_max), before.rlim_max };
  setrlimit(RLIMIT_AS, &little);
  std::string message = MessageOf(volume, false, [](Caster* c) { c->SetImageSize(16384, 16384); });
  setrlimit(RLIMIT_AS, &before);
  LACUNA_CHECK_THAT(
    message.find("268435456 pixels, would need 5637144576 bytes") != std::string::npos, message);
#endif
}

void TestDefaultsAndCache()
{
  vtkNew<Caster> caster;
  LACUNA_CHECK_THAT(
    caster->GetNumberOfIsoValues() == 1 && caster->GetIsoValue(0) == 500, "IsoValues");
  LACUNA_CHECK_THAT(caster->GetScalarArray().empty(), "ScalarArray");
  LACUNA_CHECK_THAT(caster->GetInterpolation() == Caster::BSpline, "Interpolation");
  LACUNA_CHECK_THAT(caster->GetSolidSide() == Caster::Above, "SolidSide");
  LACUNA_CHECK_THAT(caster->GetViewDirection()[2] == -1 && caster->GetViewUp()[1] == 1, "view");
  LACUNA_CHECK_THAT(caster->GetFocalPoint()[0] == VTK_DOUBLE_MAX, "FocalPoint");
  LACUNA_CHECK_THAT(caster->GetPlaneOrigin()[0] == VTK_DOUBLE_MAX, "PlaneOrigin");
  LACUNA_CHECK_THAT(caster->GetPixelSpacing() == 0 && caster->GetImageSize()[0] == 0, "sizes");
  std::ostringstream text;
  caster->Print(text);
  LACUNA_CHECK_THAT(text.str().find("IsoValues: 500") != std::string::npos, "PrintSelf");

  // values changed in place and another side: no stale preparation
  const auto volume = MakeVolume(VTK_FLOAT, false, [](const double* p) { return -p[2]; });
  caster->SetInputData(volume);
  caster->SetIsoValue(0, -95);
  caster->SetPlaneOrigin(0, 0, 95.5);
  caster->Update();
  LACUNA_CHECK_THAT(
    std::abs(caster->GetOutput()->GetPointData()->GetScalars()->GetTuple1(20) - 0.5) < 1e-5,
    "depth from the plane's origin");
  double middle[3];
  caster->SetFocalPoint(101, 202, 303);
  caster->SetImageSize(5, 3);
  caster->Update();
  caster->GetOutput()->TransformIndexToPhysicalPoint(2, 1, 0, middle);
  LACUNA_CHECK_THAT(std::abs(middle[0] - 101) < 1e-9 && std::abs(middle[1] - 202) < 1e-9 &&
      std::abs(middle[2] - 95.5) < 1e-9,
    "the focal point is in the middle of the map");
  caster->SetFocalPoint(VTK_DOUBLE_MAX, VTK_DOUBLE_MAX, VTK_DOUBLE_MAX);
  caster->SetImageSize(0, 0);
  caster->Update();
  vtkDataArray* values = volume->GetPointData()->GetScalars();
  for (vtkIdType i = 0; i < values->GetNumberOfTuples(); ++i)
  {
    values->SetTuple1(i, values->GetTuple1(i) + 2);
  }
  values->Modified();
  volume->Modified();
  caster->Update();
  LACUNA_CHECK_THAT(
    std::abs(caster->GetOutput()->GetPointData()->GetScalars()->GetTuple1(20) + 1.5) < 1e-5,
    "new values; before the plane depth is negative");
  caster->SetSolidSide(Caster::Below);
  caster->Update();
  LACUNA_CHECK_THAT(std::isnan(caster->GetOutput()->GetPointData()->GetScalars()->GetTuple1(20)),
    "inside the solid from the start");
  caster->SetViewDirection(0, 0, 1);
  caster->Update();
  LACUNA_CHECK_THAT(
    std::abs(caster->GetOutput()->GetPointData()->GetScalars()->GetTuple1(20) - 1.5) < 1e-5,
    "from below");
}
}

int TestBSplineIsoRayCaster(int, char*[])
{
  TestContract();
  TestTypes();
  TestRequestedExtent();
  TestBadInput();
  TestMemory();
  TestDefaultsAndCache();
  return lacunaCheck::Result();
}
