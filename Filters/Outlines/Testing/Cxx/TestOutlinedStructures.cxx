// SPDX-License-Identifier: BSD-3-Clause
// Surfaces and tables of ellipsoids that are known exactly.
#include "lacunaCheck.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkIntArray.h"
#include "vtkLacunaOutlinedStructures.h"
#include "vtkMath.h"
#include "vtkNew.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"
#include "vtkStringArray.h"
#include "vtkTable.h"

#include <array>
#include <cmath>
#include <string>
#include <vector>

namespace
{
struct Ellipsoid
{
  int Structure;
  std::array<double, 3> Axes;
  std::array<double, 3> Middle;
};

constexpr double Heights[7] = { -0.9, -0.7, -0.35, 0, 0.35, 0.7, 0.9 }; // of the half axis

double GetVolume(const Ellipsoid& e)
{
  return 4 * vtkMath::Pi() / 3 * e.Axes[0] * e.Axes[1] * e.Axes[2] / 1000;
}

// shift: of the outline of this number, in mm.
vtkSmartPointer<vtkPolyData> MakeOutlines(
  const std::vector<Ellipsoid>& bodies, int shifted = -1, std::array<double, 3> shift = { 0, 0, 0 })
{
  auto lines = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkCellArray> cells;
  vtkNew<vtkIntArray> structures;
  structures->SetName("Structure");
  vtkNew<vtkStringArray> names;
  names->SetName("StructureName");
  int number = 0;
  for (const Ellipsoid& e : bodies)
  {
    for (const double height : Heights)
    {
      const double radius = std::sqrt(1 - height * height);
      const bool isShifted = number++ == shifted;
      constexpr int n = 60;
      cells->InsertNextCell(n + 1);
      const vtkIdType first = points->GetNumberOfPoints();
      for (int i = 0; i < n; ++i)
      {
        const double angle = 2 * vtkMath::Pi() * i / n;
        double x[3] = { e.Middle[0] + e.Axes[0] * radius * std::cos(angle),
          e.Middle[1] + e.Axes[1] * radius * std::sin(angle), e.Middle[2] + e.Axes[2] * height };
        for (int c = 0; c < 3; ++c)
        {
          x[c] += isShifted ? shift[c] : 0;
        }
        cells->InsertCellPoint(points->InsertNextPoint(x));
      }
      cells->InsertCellPoint(first);
      structures->InsertNextValue(e.Structure);
      names->InsertNextValue(e.Structure == 3 ? "Cyst" : "Gland");
    }
  }
  lines->SetPoints(points);
  lines->SetLines(cells);
  lines->GetCellData()->AddArray(structures);
  lines->GetCellData()->AddArray(names);
  return lines;
}

double Get(vtkLacunaOutlinedStructures* filter, int row, const char* column)
{
  auto* table = vtkTable::SafeDownCast(filter->GetOutputDataObject(1));
  return table->GetValueByName(row, column).ToDouble();
}

void TestTwo()
{
  const Ellipsoid gland{ 1, { 20, 15, 25 }, { 3, -4, 100 } };
  const Ellipsoid cyst{ 3, { 8, 9, 7 }, { 60, 10, 90 } };
  vtkNew<vtkLacunaOutlinedStructures> filter;
  filter->SetInputData(MakeOutlines({ gland, cyst }));
  const auto messages = lacunaCheck::Watch(filter);
  filter->Update();
  LACUNA_CHECK_THAT(
    messages->Errors.empty() && messages->Warnings.empty(), messages->Errors + messages->Warnings);
  auto* table = vtkTable::SafeDownCast(filter->GetOutputDataObject(1));
  LACUNA_CHECK(table->GetNumberOfRows() == 2);
  LACUNA_CHECK(table->GetValueByName(0, "Name").ToString() == "Gland");
  LACUNA_CHECK(table->GetValueByName(1, "Name").ToString() == "Cyst");
  LACUNA_CHECK(table->GetValueByName(1, "Structure").ToInt() == 3);
  LACUNA_CHECK(table->GetValueByName(1, "Outlines").ToInt() == 7);
  LACUNA_CHECK(table->GetValueByName(1, "Status").ToString().empty());
  LACUNA_CHECK_NEAR(Get(filter, 0, "Volume (ml)") / GetVolume(gland), 1, 0.005);
  LACUNA_CHECK_NEAR(Get(filter, 1, "Volume (ml)") / GetVolume(cyst), 1, 0.005);
  LACUNA_CHECK_NEAR(Get(filter, 0, "Largest diameter (mm)"), 50, 0.3);
  LACUNA_CHECK_NEAR(Get(filter, 1, "Largest diameter (mm)"), 18, 0.2);
  LACUNA_CHECK_NEAR(Get(filter, 1, "Centroid X (mm)"), 60, 0.05);
  LACUNA_CHECK_NEAR(Get(filter, 1, "Centroid Z (mm)"), 90, 0.05);
  // Knud Thomsen's formula, within 1.1 %
  const double p = 1.6075;
  const double area = 4 * vtkMath::Pi() *
    std::pow(
      (std::pow(20.0 * 15, p) + std::pow(20.0 * 25, p) + std::pow(15.0 * 25, p)) / 3, 1 / p) /
    100;
  LACUNA_CHECK_NEAR(Get(filter, 0, "Area (cm2)") / area, 1, 0.015);
  vtkPolyData* surfaces = filter->GetOutput();
  vtkDataArray* of = surfaces->GetCellData()->GetArray("Structure");
  LACUNA_CHECK(
    of->GetComponent(0, 0) == 1 && of->GetComponent(of->GetNumberOfTuples() - 1, 0) == 3);

  // the other structure stays as it is, the changed one is that of a new filter
  const double before = Get(filter, 1, "Volume (ml)");
  const Ellipsoid larger{ 1, { 22, 15, 25 }, { 3, -4, 100 } };
  filter->SetInputData(MakeOutlines({ larger, cyst }));
  filter->Update();
  LACUNA_CHECK(Get(filter, 1, "Volume (ml)") == before);
  LACUNA_CHECK_NEAR(Get(filter, 0, "Volume (ml)") / GetVolume(larger), 1, 0.005);
  vtkNew<vtkLacunaOutlinedStructures> fresh;
  fresh->SetInputData(MakeOutlines({ larger, cyst }));
  fresh->Update();
  LACUNA_CHECK(Get(fresh, 0, "Volume (ml)") == Get(filter, 0, "Volume (ml)"));
  LACUNA_CHECK(Get(fresh, 1, "Volume (ml)") == Get(filter, 1, "Volume (ml)"));
}

// The volume's change when each slice is displaced on its own, by differences.
void TestRegistration()
{
  const Ellipsoid gland{ 1, { 20, 15, 25 }, { 3, -4, 100 } };
  const auto measure = [](vtkPolyData* outlines, double error, const char* column)
  {
    vtkNew<vtkLacunaOutlinedStructures> filter;
    filter->SetSmoothing(0.02);
    filter->SetRegistrationError(error);
    filter->SetInputData(outlines);
    filter->Update();
    return Get(filter, 0, column);
  };
  constexpr double step = 0.4; // mm
  double squares = 0;
  for (int slice = 0; slice < 7; ++slice)
  {
    // along the normal; displacements across it change nothing
    const double more = measure(MakeOutlines({ gland }, slice, { 0, 0, step }), 0, "Volume (ml)");
    const double less = measure(MakeOutlines({ gland }, slice, { 0, 0, -step }), 0, "Volume (ml)");
    const double change = (more - less) / (2 * step);
    squares += change * change / 3;
  }
  const auto outlines = MakeOutlines({ gland });
  const double drawn = measure(outlines, 0, "Standard error (ml)");
  const double both = measure(outlines, 2, "Standard error (ml)");
  const double found = std::sqrt(both * both - drawn * drawn) / 2;
  std::cout << "registration of 1 mm: " << found << " ml, by differences " << std::sqrt(squares)
            << " ml\n";
  LACUNA_CHECK_NEAR(found / std::sqrt(squares), 1, 0.25);
}

// Two bodies of one structure in the same slices move together.
void TestCommonSlices()
{
  const Ellipsoid one{ 1, { 20, 15, 25 }, { 3, -4, 100 } };
  const Ellipsoid other{ 1, { 20, 15, 25 }, { 63, -4, 100 } };
  const auto measure = [](vtkPolyData* outlines, bool hasSlices)
  {
    if (hasSlices)
    {
      vtkNew<vtkIntArray> slices;
      slices->SetName("SliceNumber");
      for (vtkIdType l = 0; l < outlines->GetNumberOfLines(); ++l)
      {
        slices->InsertNextValue(static_cast<int>(l % 7));
      }
      outlines->GetCellData()->AddArray(slices);
    }
    vtkNew<vtkLacunaOutlinedStructures> filter;
    filter->SetSmoothing(0.02);
    filter->SetRegistrationError(5); // so that drawing does not count
    filter->SetInputData(outlines);
    filter->Update();
    return Get(filter, 0, "Standard error (ml)");
  };
  const double alone = measure(MakeOutlines({ one }), true);
  LACUNA_CHECK_NEAR(measure(MakeOutlines({ one, other }), true) / alone, 2, 0.05);
  LACUNA_CHECK_NEAR(measure(MakeOutlines({ one, other }), false) / alone, std::sqrt(2), 0.05);
}

void TestBadInput()
{
  const Ellipsoid gland{ 1, { 20, 15, 25 }, { 3, -4, 100 } };
  const auto run = [](vtkPolyData* input, double registration)
  {
    vtkNew<vtkLacunaOutlinedStructures> filter;
    filter->SetInputData(input);
    filter->SetRegistrationError(registration);
    const auto messages = lacunaCheck::Watch(filter);
    filter->Update();
    return messages->Errors + "|" + messages->Warnings;
  };
  const auto lines = MakeOutlines({ gland });
  LACUNA_CHECK_CONTAINS(run(lines, -1), "RegistrationError is -1 mm; it must be 0 mm or more");
  vtkNew<vtkPolyData> points;
  points->SetPoints(lines->GetPoints());
  LACUNA_CHECK_CONTAINS(run(points, 0), "no lines");
  vtkNew<vtkPolyData> open;
  open->SetPoints(lines->GetPoints());
  vtkNew<vtkCellArray> cells;
  const vtkIdType ids[4] = { 0, 1, 2, 3 };
  cells->InsertNextCell(4, ids);
  open->SetLines(cells);
  LACUNA_CHECK_CONTAINS(run(open, 0), "line 0 is not closed");

  // the same outline twice, and one displaced so that both cross: told where the volume stands
  for (const double aside : { 0.0, 7.0 })
  {
    const auto more = MakeOutlines({ gland });
    const vtkIdType first = more->GetNumberOfPoints();
    constexpr int n = 60;
    for (int i = 0; i < n; ++i)
    {
      double x[3];
      more->GetPoint(3 * n + i, x); // of the fourth outline
      x[0] += aside;
      more->GetPoints()->InsertNextPoint(x);
    }
    more->GetLines()->InsertNextCell(n + 1);
    for (int i = 0; i <= n; ++i)
    {
      more->GetLines()->InsertCellPoint(first + i % n);
    }
    vtkIntArray::SafeDownCast(more->GetCellData()->GetArray("Structure"))->InsertNextValue(1);
    vtkStringArray::SafeDownCast(more->GetCellData()->GetAbstractArray("StructureName"))
      ->InsertNextValue("Gland");
    vtkNew<vtkLacunaOutlinedStructures> twice;
    twice->SetInputData(more);
    twice->Update();
    auto* row = vtkTable::SafeDownCast(twice->GetOutputDataObject(1));
    LACUNA_CHECK(row->GetValueByName(0, "Status").ToString() ==
      "two outlines cross or are the same: delete one");
    LACUNA_CHECK(std::isnan(row->GetValueByName(0, "Volume (ml)").ToDouble()));
  }

  // one number with two names, as of two files: two structures
  const Ellipsoid other{ 1, { 8, 9, 7 }, { 60, 10, 90 } };
  const auto both = MakeOutlines({ gland, other });
  auto* names =
    vtkStringArray::SafeDownCast(both->GetCellData()->GetAbstractArray("StructureName"));
  for (vtkIdType l = 7; l < 14; ++l)
  {
    names->SetValue(l, "Kidney");
  }
  vtkNew<vtkLacunaOutlinedStructures> apart;
  apart->SetInputData(both);
  apart->Update();
  auto* rows = vtkTable::SafeDownCast(apart->GetOutputDataObject(1));
  LACUNA_CHECK(rows->GetNumberOfRows() == 2);
  LACUNA_CHECK_NEAR(rows->GetValueByName(1, "Volume (ml)").ToDouble() / GetVolume(other), 1, 0.005);

  // two outlines of one structure: no surface yet, told in the table and no error
  vtkNew<vtkPolyData> two;
  two->SetPoints(lines->GetPoints());
  vtkNew<vtkCellArray> first;
  for (vtkIdType l = 2; l < 4; ++l)
  {
    vtkIdType count = 0;
    const vtkIdType* of = nullptr;
    lines->GetLines()->GetCellAtId(l, count, of);
    first->InsertNextCell(count, of);
  }
  two->SetLines(first);
  vtkNew<vtkLacunaOutlinedStructures> filter;
  filter->SetInputData(two);
  const auto messages = lacunaCheck::Watch(filter);
  filter->Update();
  LACUNA_CHECK_THAT(
    messages->Errors.empty() && messages->Warnings.empty(), messages->Errors + messages->Warnings);
  auto* table = vtkTable::SafeDownCast(filter->GetOutputDataObject(1));
  LACUNA_CHECK(table->GetValueByName(0, "Status").ToString() == "2 of 3 slices outlined");
  LACUNA_CHECK(std::isnan(table->GetValueByName(0, "Volume (ml)").ToDouble()));
  LACUNA_CHECK(filter->GetOutput()->GetNumberOfCells() == 0);
}
}

int TestOutlinedStructures(int, char*[])
{
  TestTwo();
  TestRegistration();
  TestCommonSlices();
  TestBadInput();
  return lacunaCheck::Result();
}
