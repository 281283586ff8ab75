// SPDX-License-Identifier: BSD-3-Clause
#include "TestSolids.h"
#include "lacunaCheck.h"
#include "lacunaCoordinates.h"
#include "lacunaProvenance.h"
#include "vtkFieldData.h"
#include "vtkInformation.h"
#include "vtkLacunaPressOrientation.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkStringArray.h"
#include "vtkUnsignedCharArray.h"

#include <functional>

namespace
{
using lacuna::Matrix4;
using lacuna::Vec3;
using TestSolids::CornersInLetter;
using TestSolids::IsLetter;
using TestSolids::Views;

// With the plane of the fit.
vtkSmartPointer<vtkImageData> FilledMap(const lacuna::DepthMap::Geometry& geometry,
  const std::function<bool(double, double)>& inside = IsLetter)
{
  auto map = TestSolids::FilledMap(geometry, inside);
  const Vec3 normal = lacuna::Normalized({ 0.1, -0.2, -1 });
  lacuna::FieldData::Set(map, "PlaneNormal", { normal[0], normal[1], normal[2] }, 3);
  return map;
}

double GetField(vtkDataObject* data, const char* name, int component = 0)
{
  vtkDataArray* array = data->GetFieldData()->GetArray(name);
  return array && array->GetNumberOfTuples() == 1 ? array->GetComponent(0, component)
                                                  : TestSurfaces::NaN;
}

Matrix4 GetPressToPatient(vtkDataObject* data)
{
  return lacuna::FieldData::GetMatrix(
    lacuna::FieldData::Get(data, lacuna::Coordinates::PressToPatientName, 16, 1), 0);
}

vtkSmartPointer<vtkLacunaPressOrientation> MakeFilter(vtkImageData* map)
{
  auto filter = vtkSmartPointer<vtkLacunaPressOrientation>::New();
  filter->SetInputData(map);
  filter->SetPlateMargin(0.5);
  filter->SetFlangeWidth(8);
  return filter;
}

// The mould goes back to where the surface is in the patient, and the letter with it, wherever the
// viewer stands.
void TestPlace()
{
  int turn = 0;
  for (const Vec3& view : Views)
  {
    const auto geometry = TestSurfaces::Geometry(view, 0.4 * turn++);
    const auto filter = MakeFilter(FilledMap(geometry));
    filter->SetOutputSpacing(0.5);
    for (const int mould : { 0, 1 })
    {
      // the fitted surface itself is the plate's outer (female) and inner face (male)
      filter->SetMould(mould);
      filter->SetSeating(mould == 0 ? 1 : 0);
      filter->Update();
      vtkStructuredGrid* grid = filter->GetOutput();
      const Matrix4 back = GetPressToPatient(grid);
      LACUNA_CHECK_NEAR(back.Determinant3(), 1, 1e-14);
      LACUNA_CHECK_NEAR(GetField(grid, "SingleValued"), 1, 0);
      LACUNA_CHECK_NEAR(GetField(grid, "SurfaceOffset"), 0, 0);
      LACUNA_CHECK_NEAR(GetField(grid, "Outward"), 1, 0);
      // the plane that the map reports lies flat, and the mill is on the plate's side of the mould
      const Vec3 normal =
        lacuna::Normalized(0.1 * geometry.Right + -0.2 * geometry.Down + -1.0 * geometry.View);
      LACUNA_CHECK_NEAR(lacuna::Dot(back.Column(2), normal), mould == 0 ? -1 : 1, 1e-14);
      auto* regions = vtkUnsignedCharArray::SafeDownCast(
        grid->GetPointData()->GetArray(vtkLacunaPressOrientation::PressRegionName));
      auto* defect = grid->GetPointData()->GetArray(vtkLacunaPressOrientation::DefectMaskName);
      LACUNA_CHECK(regions && defect);
      double off = 0;
      int wrong = 0;
      int count = 0;
      for (vtkIdType k = 0; k < grid->GetNumberOfPoints(); ++k)
      {
        Vec3 p;
        grid->GetPoint(k, p.data());
        LACUNA_CHECK(mould == 0 ? p[2] <= 0 : p[2] >= 0);
        const Vec3 q = back.Point(p) - geometry.Origin;
        const double x = lacuna::Dot(q, geometry.Right) - 24.5;
        const double y = lacuna::Dot(q, geometry.Down) - 22.5;
        if (regions->GetValue(k) == 2)
        {
          off = std::max(off, std::abs(lacuna::Dot(q, geometry.View) - TestSurfaces::Depth(x, y)));
        }
        const int corners = CornersInLetter(x, y, 0.3, 0.45);
        if (corners == 0 || corners == 4)
        {
          wrong += (defect->GetComponent(k, 0) != 0) != (corners == 4);
          count += corners == 4;
        }
      }
      LACUNA_CHECK_THAT(off < 2e-4, "off by " + std::to_string(1000 * off) + " um");
      LACUNA_CHECK(wrong == 0 && count > 500);
    }
  }
}

// The map with a linear surface in the place of the fitted one.
vtkSmartPointer<vtkImageData> PlaneMap(const lacuna::DepthMap::Geometry& geometry)
{
  auto map = FilledMap(geometry);
  vtkDataArray* fitted = map->GetPointData()->GetArray("Fitted");
  for (vtkIdType k = 0; k < fitted->GetNumberOfTuples(); ++k)
  {
    if (std::isfinite(fitted->GetComponent(k, 0)))
    {
      fitted->SetComponent(k, 0, 30 + 0.1 * 0.5 * (5 + k % 90) - 0.2 * 0.75 * (k / 90 - 3));
    }
  }
  return map;
}

// How far, in mm, the mould's true surface is at most from where it should be: offset towards the
// viewer from the plane of PlaneMap.
double OffPlane(vtkStructuredGrid* grid, const lacuna::DepthMap::Geometry& geometry, double offset)
{
  const double rise = std::sqrt(1 + 0.01 + 0.04);
  const Matrix4 back = GetPressToPatient(grid);
  vtkDataArray* regions = grid->GetPointData()->GetArray("PressRegion");
  double off = 0;
  int count = 0;
  for (vtkIdType k = 0; k < grid->GetNumberOfPoints(); ++k)
  {
    if (regions->GetComponent(k, 0) != 2)
    {
      continue;
    }
    Vec3 p;
    grid->GetPoint(k, p.data());
    const Vec3 q = back.Point(p) - geometry.Origin;
    const double height = 30 + 0.1 * lacuna::Dot(q, geometry.Right) -
      0.2 * lacuna::Dot(q, geometry.Down) - lacuna::Dot(q, geometry.View);
    off = std::max(off, std::abs(height / rise - offset));
    ++count;
  }
  return count > 0 ? off : TestSurfaces::NaN;
}

// Where the surface is linear the mould is exact: on the plate's other face, parallel to it.
void TestExactPlane()
{
  const auto geometry = TestSurfaces::Geometry({ 1, -2, 0.5 }, 0.3);
  const auto filter = MakeFilter(PlaneMap(geometry));
  filter->Update(); // Female, Onlay
  vtkStructuredGrid* grid = filter->GetOutput();
  LACUNA_CHECK_NEAR(GetField(grid, "SurfaceOffset"), 0.7, 0);
  LACUNA_CHECK_NEAR(GetField(grid, "Depth"), 1, 1e-12); // of the fillet, an eighth of the flange
  const double degrees = 180 / 3.14159265358979323846;
  LACUNA_CHECK_NEAR(GetField(grid, "Angles", 0), degrees * std::atan(0.2 / std::sqrt(1.01)), 1e-12);
  LACUNA_CHECK_NEAR(GetField(grid, "Angles", 1), degrees * std::atan(0.1), 1e-12);
  LACUNA_CHECK_NEAR(OffPlane(grid, geometry, 0.7), 0, 1e-12);
  int dimensions[3];
  grid->GetDimensions(dimensions);
  LACUNA_CHECK_NEAR(GetField(grid, "BlockSize", 0), 0.5 * (dimensions[0] - 1), 1e-12);
  LACUNA_CHECK_NEAR(GetField(grid, "BlockSize", 2), 11, 1e-9);
}

// Of a plate that is hollow to the viewer the convex face is the inner one, and the female mould is
// for that.
void TestConvexSide()
{
  using Filter = vtkLacunaPressOrientation;
  const auto geometry = TestSurfaces::Geometry({ 1, -2, 0.5 }, 0.3);
  const Vec3 towardsViewer =
    lacuna::Normalized(0.1 * geometry.Right + -0.2 * geometry.Down + -1.0 * geometry.View);
  const auto filter = MakeFilter(PlaneMap(geometry));
  const struct
  {
    int Mould;
    int Seating;
    int Convex;
    double Offset;
  } cases[] = { { Filter::Female, Filter::Onlay, Filter::Outward, 0.7 },
    { Filter::Female, Filter::Inlay, Filter::Outward, 0 },
    { Filter::Male, Filter::Onlay, Filter::Outward, 0 },
    { Filter::Male, Filter::Inlay, Filter::Outward, -0.7 },
    { Filter::Female, Filter::Onlay, Filter::Inward, 0 },
    { Filter::Female, Filter::Inlay, Filter::Inward, -0.7 },
    { Filter::Male, Filter::Onlay, Filter::Inward, 0.7 },
    { Filter::Male, Filter::Inlay, Filter::Inward, 0 } };
  for (const auto& each : cases)
  {
    filter->SetMould(each.Mould);
    filter->SetSeating(each.Seating);
    filter->SetConvexSide(each.Convex);
    filter->Update();
    vtkStructuredGrid* grid = filter->GetOutput();
    LACUNA_CHECK_NEAR(GetField(grid, "Outward"), each.Convex == Filter::Outward, 0);
    LACUNA_CHECK_NEAR(GetField(grid, "SurfaceOffset"), each.Offset, 1e-15);
    LACUNA_CHECK_NEAR(OffPlane(grid, geometry, each.Offset), 0, 1e-12);
    // the mill is where the plate's other face is, or on this one's own side
    const bool behind = (each.Mould == Filter::Female) == (each.Convex == Filter::Outward);
    const Matrix4 back = GetPressToPatient(grid);
    LACUNA_CHECK_NEAR(lacuna::Dot(back.Column(2), towardsViewer), behind ? -1 : 1, 1e-14);
    LACUNA_CHECK_NEAR(back.Determinant3(), 1, 1e-14);
    const double* bounds = grid->GetBounds();
    LACUNA_CHECK(each.Mould == Filter::Female ? bounds[5] <= 0 : bounds[4] >= 0);
  }

  // Automatic finds it
  auto bowl = FilledMap(geometry);
  vtkDataArray* fitted = bowl->GetPointData()->GetArray("Fitted");
  for (vtkIdType k = 0; k < fitted->GetNumberOfTuples(); ++k)
  {
    fitted->SetComponent(k, 0, 80 - fitted->GetComponent(k, 0));
  }
  filter->SetInputData(bowl);
  filter->SetMould(Filter::Female);
  filter->SetSeating(Filter::Inlay);
  filter->SetConvexSide(Filter::Automatic);
  filter->Update();
  LACUNA_CHECK_NEAR(GetField(filter->GetOutput(), "Outward"), 0, 0);
  LACUNA_CHECK_NEAR(GetField(filter->GetOutput(), "SurfaceOffset"), -0.7, 1e-15);
  vtkNew<vtkPoints> automatic;
  automatic->SetDataTypeToDouble();
  automatic->DeepCopy(filter->GetOutput()->GetPoints());
  filter->SetConvexSide(Filter::Inward);
  filter->Update();
  vtkPoints* given = filter->GetOutput()->GetPoints();
  LACUNA_CHECK(given->GetNumberOfPoints() == automatic->GetNumberOfPoints());
  for (vtkIdType k = 0; k < std::min(given->GetNumberOfPoints(), automatic->GetNumberOfPoints());
       ++k)
  {
    Vec3 a;
    Vec3 b;
    automatic->GetPoint(k, a.data());
    given->GetPoint(k, b.data());
    LACUNA_CHECK(a == b);
  }
}

// What the pipeline is told, and what goes on with the grid.
void TestPipeline()
{
  const auto geometry = TestSurfaces::Geometry({ 0, 0, 1 }, 0);
  auto map = FilledMap(geometry);
  const auto filter = MakeFilter(map);
  filter->Update();
  int extent[6];
  filter->GetOutputInformation(0)->Get(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), extent);
  int own[6];
  filter->GetOutput()->GetExtent(own);
  LACUNA_CHECK(std::equal(extent, extent + 6, own) && own[1] > 0 && own[4] == 0 && own[5] == 0);
  const auto steps = lacuna::Provenance::Get(filter->GetOutput());
  LACUNA_CHECK(!steps.empty() && steps.back().find("PlateMargin=0.5") != std::string::npos);
  LACUNA_CHECK(!filter->GetOutput()->GetFieldData()->GetArray("ImageToWorld"));
  // whose coordinates PressToPatient leads to: nobody's before the map says so
  LACUNA_CHECK(lacuna::Coordinates::Get(filter->GetOutput()) == "Press");
  LACUNA_CHECK(lacuna::Coordinates::GetBeforePress(filter->GetOutput()).empty());
  lacuna::Coordinates::Mark(map, lacuna::Coordinates::Patient);
  map->Modified();
  filter->Update();
  LACUNA_CHECK(lacuna::Coordinates::Get(filter->GetOutput()) == "Press");
  LACUNA_CHECK(lacuna::Coordinates::GetBeforePress(filter->GetOutput()) == "Patient");
  // x runs fastest and both spacings are the same everywhere
  for (vtkIdType k = 1; k < filter->GetOutput()->GetNumberOfPoints(); ++k)
  {
    double a[3];
    double b[3];
    filter->GetOutput()->GetPoint(k - 1, a);
    filter->GetOutput()->GetPoint(k, b);
    if (k % (own[1] + 1) != 0)
    {
      LACUNA_CHECK_NEAR(b[0] - a[0], 0.5, 1e-12);
      LACUNA_CHECK_NEAR(b[1] - a[1], 0, 0);
    }
  }
  // a narrow flange takes closer points
  filter->SetFlangeWidth(2);
  filter->Update();
  LACUNA_CHECK_NEAR(
    filter->GetOutput()->GetPoint(1)[0] - filter->GetOutput()->GetPoint(0)[0], 0.25, 1e-12);
  filter->SetFlangeWidth(8);
  // the size follows the properties
  filter->SetBlockSize(60, 50, 30);
  filter->SetOutputSpacing(1);
  filter->Update();
  LACUNA_CHECK(filter->GetOutput()->GetNumberOfPoints() == 61 * 51);
  // a plane of the fit that does not lie as the plate does
  const auto messages = lacunaCheck::Watch(filter);
  const auto wall = [&]()
  {
    filter->Update();
    return lacuna::FieldData::Find(filter->GetOutput(), "DraftAngle", 1, 1)->GetTuple1(0);
  };
  filter->SetBlockSize(0, 0, 0);
  lacuna::FieldData::Set(map, "PlaneNormal", { std::sin(0.3), 0, -std::cos(0.3) }, 3);
  map->Modified();
  const double askew = wall();
  LACUNA_CHECK(messages->HasWarning("is inclined by"));
  messages->Warnings.clear();
  filter->SetPlaneMethod(vtkLacunaPressOrientation::LeastSquares);
  LACUNA_CHECK(wall() < askew - 5 && messages->Warnings.empty());
  filter->SetPlaneMethod(vtkLacunaPressOrientation::Fit);
  // without the hole filler's plane
  map->GetFieldData()->RemoveArray("PlaneNormal");
  map->Modified();
  filter->Update();
  LACUNA_CHECK(messages->HasWarning("least squares plane"));
  auto* source = vtkStringArray::SafeDownCast(
    filter->GetOutput()->GetFieldData()->GetAbstractArray("PlaneSource"));
  LACUNA_CHECK(source && source->GetValue(0).find("least squares") != std::string::npos);
  filter->SetInputData(vtkSmartPointer<vtkImageData>::New());
  filter->Update();
  LACUNA_CHECK(filter->GetOutput()->GetNumberOfPoints() == 0 && messages->Errors.empty());
}

// A plane that makes the surface overhang: no mould, but what gives one.
void TestUndercut()
{
  const auto geometry = TestSurfaces::Geometry({ 1, -2, 0.5 }, 0.3);
  auto map = FilledMap(geometry);
  const auto setPlane = [&map](const Vec3& n)
  {
    const Vec3 normal = lacuna::Normalized(n);
    lacuna::FieldData::Set(map, "PlaneNormal", { normal[0], normal[1], normal[2] }, 3);
    map->Modified();
  };
  const auto filter = MakeFilter(map);
  const auto messages = lacunaCheck::Watch(filter);
  const auto expectNone = [&](const char* words, bool view)
  {
    messages->Warnings.clear();
    filter->Update();
    LACUNA_CHECK(messages->Errors.empty());
    LACUNA_CHECK(messages->HasWarning(words));
    LACUNA_CHECK(messages->HasWarning("SuggestedViewDirection") == view);
    LACUNA_CHECK(filter->GetOutput()->GetNumberOfPoints() == 0);
    LACUNA_CHECK_NEAR(GetField(filter->GetOutput(), "SingleValued"), 0, 0);
    LACUNA_CHECK(std::isnan(GetField(filter->GetOutput(), "SuggestedViewDirection")) != view);
  };
  const auto expectMould = [&]()
  {
    filter->Update();
    LACUNA_CHECK(filter->GetOutput()->GetNumberOfPoints() > 0);
    LACUNA_CHECK_NEAR(GetField(filter->GetOutput(), "SingleValued"), 1, 0);
  };
  // the plane of the fit is askew: the surface's own gives the mould
  setPlane({ 4, 0, -1 });
  expectNone("Set PlaneMethod to LeastSquares, which gives a mould from this view", false);
  filter->SetPlaneMethod(vtkLacunaPressOrientation::LeastSquares);
  expectMould();
  setPlane({ 0, 0, -1 });
  filter->SetPlaneMethod(vtkLacunaPressOrientation::Fit);
  expectMould();

  // a fit that swings over the defect, on ground that is inclined by a turn about the map's y
  map = FilledMap(geometry, [](double x, double y) { return std::hypot(x, y) < 8; });
  setPlane({ 4, 0, -1 });
  filter->SetInputData(map);
  vtkDataArray* fitted = map->GetPointData()->GetArray("Fitted");
  const auto swing = [&](double slope)
  {
    for (int k = 0; k < 90 * 70; ++k)
    {
      const double x = 0.5 * (5 + k % 90 - 49);
      const double y = 0.75 * (k / 90 - 33);
      const double r = std::hypot(x, y) / 8;
      const double z = 30 + slope * x + (r < 1 ? 5 * x * std::pow(1 - r * r, 3) : 0);
      fitted->SetComponent(k, 0, z);
    }
    map->Modified();
  };
  filter->SetPlateThickness(0.001); // so thin that no offset folds
  for (const double slope : { 0.5, -1.4 })
  {
    swing(slope);
    expectNone("of at least 1; set PlaneMethod to LeastSquares; if", true);
    const Vec3 expected = lacuna::Normalized(-slope * geometry.Right + 1.0 * geometry.View);
    for (int i = 0; i < 3; ++i)
    {
      LACUNA_CHECK_NEAR(
        GetField(filter->GetOutput(), "SuggestedViewDirection", i), expected[i], 0.02);
    }
  }
  filter->SetPlaneMethod(vtkLacunaPressOrientation::LeastSquares);
  expectNone("faces the defect, and OutputMargin of RBF Hole Filler of at least 1; if", true);
  swing(0);
  expectNone("Another view would not help", false);
  swing(2.2);
  expectNone("This view looks along the bone", false);
}

void TestErrors()
{
  const auto geometry = TestSurfaces::Geometry({ 0, 0, 1 }, 0);
  const auto refuses = [](vtkImageData* map, const char* words,
                         const std::function<void(vtkLacunaPressOrientation*)>& change)
  {
    const auto filter = MakeFilter(map);
    const auto messages = lacunaCheck::Watch(filter);
    change(filter);
    filter->Update();
    LACUNA_CHECK_CONTAINS(messages->Errors, words);
    LACUNA_CHECK(filter->GetOutput()->GetNumberOfPoints() == 0);
  };
  const auto nothing = [](vtkLacunaPressOrientation*) {};
  refuses(TestSurfaces::Map(geometry, false), "run RBF Hole Filler", nothing);
  refuses(TestSurfaces::Map(geometry, true), "FilledMask", nothing);
  refuses(FilledMap(geometry, [](double, double) { return false; }), "no defect", nothing);
  refuses(
    FilledMap(geometry, [](double x, double) { return x < 0; }), "Fitted is no number", nothing);
  auto holed = FilledMap(geometry);
  holed->GetPointData()->GetArray("Fitted")->SetComponent(90 * 15 + 20, 0, TestSurfaces::NaN);
  refuses(holed, "Fitted has a hole at pixel 25, 12", nothing);
  auto endless = FilledMap(geometry);
  endless->GetPointData()->GetArray("Fitted")->SetComponent(
    90 * 15 + 20, 0, std::numeric_limits<double>::infinity());
  refuses(endless, "Fitted has a hole", nothing);
  auto perspective = FilledMap(geometry);
  lacuna::FieldData::Set(perspective, "EyePosition", { 0, 0, -500 }, 3);
  lacuna::FieldData::Set(perspective, "ViewAngle", { 20 }, 1);
  refuses(perspective, "perspective", nothing);
  auto edge = FilledMap(geometry);
  lacuna::FieldData::Set(edge, "PlaneNormal", { 1, 0, 0 }, 3);
  refuses(edge, "stands on edge", nothing);
  lacuna::FieldData::Set(edge, "PlaneNormal", { TestSurfaces::NaN, 0, -1 }, 3);
  refuses(edge, "not a number", nothing);
  lacuna::FieldData::Set(edge, "PlaneNormal", { 0, -1 }, 2);
  refuses(edge, "PlaneNormal", nothing);
  auto mirrored = FilledMap(
    { geometry.Origin, -1.0 * geometry.Right, geometry.Down, geometry.View, { 0.5, 0.75 } });
  refuses(mirrored, "mirror", nothing);
  auto marked = FilledMap(geometry);
  lacuna::Coordinates::MarkMirrored(marked, { 1, 2, 3 }, { 1, 0, 0 });
  refuses(marked, "mirror image (field data Mirrored)", nothing);
  const auto map = FilledMap(geometry);
  using Filter = vtkLacunaPressOrientation;
  refuses(map, "Mould is 2", [](Filter* f) { f->SetMould(2); });
  refuses(map, "Seating is -1", [](Filter* f) { f->SetSeating(-1); });
  refuses(map, "ConvexSide is 3", [](Filter* f) { f->SetConvexSide(3); });
  refuses(map, "PlateThickness is 0", [](Filter* f) { f->SetPlateThickness(0); });
  refuses(map, "OutputSpacing is -1", [](Filter* f) { f->SetOutputSpacing(-1); });
  refuses(map, "at most an eighth of that, 1 mm", [](Filter* f) { f->SetOutputSpacing(1.1); });
  refuses(map, "raise OutputMargin", [](Filter* f) { f->SetPlateMargin(5); });
  refuses(map, "BlockSize is 10", [](Filter* f) { f->SetBlockSize(10, 0, 0); });
  refuses(map, "BlockSize is nan", [](Filter* f) { f->SetBlockSize(0, TestSurfaces::NaN, 0); });
  refuses(map, "BlockSize is 0.5", [](Filter* f) { f->SetBlockSize(0, 0, 0.5); });
  refuses(map, "FlangeWidth is inf",
    [](Filter* f) { f->SetFlangeWidth(std::numeric_limits<double>::infinity()); });
  // said once, though ParaView asks for the information first; and on again
  const auto filter = MakeFilter(map);
  filter->SetPlateThickness(-1);
  const auto messages = lacunaCheck::Watch(filter);
  filter->UpdateInformation();
  LACUNA_CHECK(messages->Errors.empty());
  filter->Update();
  const std::size_t first = messages->Errors.find("PlateThickness is -1");
  LACUNA_CHECK(first != std::string::npos);
  LACUNA_CHECK(messages->Errors.find("PlateThickness is -1", first + 1) == std::string::npos);
  filter->SetPlateThickness(0.7);
  filter->Update();
  LACUNA_CHECK(filter->GetOutput()->GetNumberOfPoints() > 0);
  // the bump is rounder than that
  refuses(FilledMap(geometry, [](double x, double y) { return std::hypot(x, y) < 4; }),
    "radius below PlateThickness",
    [](Filter* f)
    {
      f->SetMould(Filter::Male);
      f->SetSeating(Filter::Inlay);
      f->SetPlateThickness(20);
    });
}
}

int TestPressOrientation(int, char*[])
{
  TestPlace();
  TestExactPlane();
  TestConvexSide();
  TestPipeline();
  TestUndercut();
  TestErrors();
  return lacunaCheck::Result();
}
