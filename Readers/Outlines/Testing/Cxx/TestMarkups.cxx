// SPDX-License-Identifier: BSD-3-Clause
// Markups as 3D Slicer writes them: LPS and RAS, units, points that are not placed, damage.
#include "OutlineReaderTesting.h"
#include "lacunaDoubling.h"
#include "vtkStringArray.h"

#include <algorithm>
#include <functional>
#include <locale>
#include <memory>
#include <vector>

namespace
{
struct Point
{
  std::string Position;
  std::string Status = "defined";
};

struct Curve
{
  std::string Type = "ClosedCurve";
  std::string Basics = R"("coordinateSystem": "LPS", "coordinateUnits": "mm",)";
  // no mirror image or half turn maps these onto themselves
  std::vector<Point> Points = { { "[1.5, 2.0, 3.25]" }, { "[11.0, 2.0, 3.25]" },
    { R"("")", "undefined" }, { "[11.0, 7.0, 3.25]" }, { "[4.0, 7.0, 3.25]" },
    { "[9.0, 9.0, 9.0]", "preview" }, { "[4.0, 3e1, 3.25]" } };
  std::string Selected = "true";
};

// The layout of vtkMRMLMarkupsJsonStorageNode.
std::string MakeMarkups(const std::vector<Curve>& curves)
{
  std::string text = "{\n    \"@schema\": "
                     "\"https://raw.githubusercontent.com/slicer/slicer/master/Modules/Loadable/"
                     "Markups/Resources/Schema/markups-schema-v1.0.3.json#\",\n    \"markups\": [";
  for (std::size_t i = 0; i < curves.size(); ++i)
  {
    const Curve& curve = curves[i];
    text += std::string(i == 0 ? "" : ",") + "\n        {\n            \"type\": \"" + curve.Type +
      "\",\n            " + curve.Basics +
      "\n            \"locked\": false,\n            \"labelFormat\": \"%N-%d\",\n            "
      "\"controlPoints\": [";
    for (std::size_t k = 0; k < curve.Points.size(); ++k)
    {
      text += std::string(k == 0 ? "" : ",") +
        "\n                {\n                    \"id\": \"" + std::to_string(k + 1) +
        "\",\n                    \"label\": \"CC-1\",\n                    \"position\": " +
        curve.Points[k].Position +
        ",\n                    \"orientation\": [-1.0, -0.0, -0.0, -0.0, -1.0, -0.0, 0.0, 0.0, "
        "1.0],\n                    \"selected\": " +
        curve.Selected + ",\n                    \"positionStatus\": \"" + curve.Points[k].Status +
        "\"\n                }";
    }
    text += "\n            ],\n            \"measurements\": [],\n            \"display\": {\n"
            "                \"color\": [0.4, 1.0, 1.0],\n                \"selectedColor\": [1.0, "
            "0.5, 0.0]\n            }\n        }";
  }
  return text + "\n    ]\n}\n";
}

void CheckFlag(vtkPolyData* outlines, double sign)
{
  LACUNA_CHECK(outlines->GetNumberOfPoints() == 5);
  LACUNA_CHECK(outlines->GetNumberOfCells() == 1);
  CheckPoint(outlines, 0, sign * 1.5, sign * 2, 3.25);
  CheckPoint(outlines, 1, sign * 11, sign * 2, 3.25);
  CheckPoint(outlines, 2, sign * 11, sign * 7, 3.25);
  CheckPoint(outlines, 3, sign * 4, sign * 7, 3.25);
  CheckPoint(outlines, 4, sign * 4, sign * 30, 3.25);
}

void TestCoordinates()
{
  Curve curve;
  ReaderOf test(MakeMarkups({ curve }));
  LACUNA_CHECK(test.Reader->CanReadFile(test.File.GetPath().c_str()) == 1);
  CheckFlag(test.Update(), 1);
  LACUNA_CHECK(test.Errors.empty());
  LACUNA_CHECK_CONTAINS(test.Warnings, "2 control points are left out");
  curve.Basics = R"("coordinateSystem": "RAS", "coordinateUnits": ["mm", "UCUM", "millimeter"],)";
  CheckFlag(test.Update(MakeMarkups({ curve })), -1);
  LACUNA_CHECK(test.Errors.empty());
  curve.Basics = ""; // of the schema: LPS and mm
  CheckFlag(test.Update(MakeMarkups({ curve })), 1);
  LACUNA_CHECK(test.Errors.empty());
}

void TestStructures()
{
  Curve other;
  other.Type = "Fiducial";
  Curve named;
  named.Basics = R"("name": "Kidney \u00e9", "coordinateSystem": "RAS",)";
  named.Selected = "false";
  ReaderOf test(MakeMarkups({ other, named, Curve(), named, other }));
  vtkPolyData* outlines = test.Update();
  LACUNA_CHECK(outlines->GetNumberOfCells() == 3);
  auto* names =
    vtkStringArray::SafeDownCast(outlines->GetCellData()->GetAbstractArray("StructureName"));
  LACUNA_CHECK(names && names->GetValue(0) == "Kidney \xC3\xA9");
  LACUNA_CHECK(names && names->GetValue(1) == "Liver"); // of the file
  vtkDataArray* structures = outlines->GetCellData()->GetArray("Structure");
  LACUNA_CHECK(structures->GetTuple1(0) == 1 && structures->GetTuple1(1) == 2 &&
    structures->GetTuple1(2) == 1);
  vtkDataArray* colors = outlines->GetCellData()->GetScalars();
  LACUNA_CHECK(colors->GetTuple3(0)[0] == 102 && colors->GetTuple3(0)[1] == 255);
  LACUNA_CHECK(colors->GetTuple3(1)[0] == 255 && colors->GetTuple3(1)[1] == 128);
  LACUNA_CHECK_CONTAINS(test.Warnings, "are left out: 2 of type 'Fiducial'");
}

void TestErrors()
{
  ReaderOf test("");
  const auto expect = [&](const std::string& content, const std::string& part)
  {
    vtkPolyData* outlines = test.Update(content);
    LACUNA_CHECK_CONTAINS(test.Errors, part);
    LACUNA_CHECK_CONTAINS(test.Errors, test.File.GetPath());
    LACUNA_CHECK(outlines->GetNumberOfPoints() == 0);
  };
  const auto spoil = [&](const std::string& basics, const std::string& part)
  {
    Curve curve;
    curve.Basics = basics;
    expect(MakeMarkups({ curve }), part);
  };
  spoil(
    R"("coordinateUnits": "um",)", "line 6: the closed curve 'Liver' has the coordinateUnits 'um'");
  spoil(R"("coordinateUnits": ["um", "UCUM", "micrometer"],)", "has the coordinateUnits 'um'");
  spoil(R"("coordinateUnits": 1,)", "has the coordinateUnits that are no text");
  spoil(R"("coordinateSystem": "IJK",)",
    "line 4: the closed curve 'Liver' has the coordinateSystem 'IJK'");
  spoil(R"("coordinateSystem": 0,)", "coordinateSystem is no text");
  for (const char* position :
    { "[1.0, 2.0]", "[1.0, 2.0, \"3\"]", "\"\"", "[1.0, 2.0, 3.0, 4.0]", "{}", "null" })
  {
    Curve curve;
    curve.Points[1].Position = position;
    expect(MakeMarkups({ curve }),
      "control point 2 of the closed curve 'Liver' has no position of three finite numbers (mm)");
  }
  Curve infinite;
  infinite.Points[1].Position = "[1e999, 2.0, 3.0]";
  test.Update(MakeMarkups({ infinite })); // some versions of the parser refuse it already
  LACUNA_CHECK(!test.Errors.empty());
  Curve small;
  small.Points.resize(3);
  expect(MakeMarkups({ small }),
    "the closed curve 'Liver' has 2 different points, but an outline needs 3");
  Curve line;
  line.Type = "Line";
  expect(MakeMarkups({ line }), "has no closed curve, only 1 of type 'Line'");
  expect(MakeMarkups({}), "has no closed curve, its list of markups is empty");
  expect("{\"version\": 1}", "is JSON, but has no list \"markups\"");
  expect("[1, 2]", "is JSON, but has no list \"markups\"");
  expect("{\"markups\": [1, [], null, \"ClosedCurve\"]}", "only 4 of type (none)");
  expect("{\"markups\": [{\"type\": \"ClosedCurve\"}]}", "has no list controlPoints");
  expect("{\"markups\": [],}", "is no whole JSON file: Line 1, Column");
  expect("{\"markups\": [NaN]}", "is no whole JSON file");
  expect("{\"markups\": []}}", "is no whole JSON file");
  expect("{\"markups\": [], \"markups\": []}", "is no whole JSON file");
  expect("{\"markups\": " + std::string(100000, '['), "is no whole JSON file");
  std::string deep = "{\"markups\":";
  for (int i = 0; i < 100000; ++i)
  {
    deep += "{\"a\":";
  }
  expect(deep, "is no whole JSON file");
}

void TestDamage()
{
  const std::string whole = MakeMarkups({ Curve() });
  ReaderOf test(whole);
  for (std::size_t at = 0; at < whole.size() - 1; at += 10)
  {
    test.Update(whole.substr(0, at));
    LACUNA_CHECK(!test.Errors.empty());
    for (const char damage : { '9', '"', '[', '\0', '\xff' })
    {
      std::string bytes = whole;
      bytes[at] = damage;
      vtkPolyData* outlines = test.Update(bytes);
      LACUNA_CHECK(test.Errors.empty() == (outlines->GetNumberOfCells() > 0));
    }
  }
}

class DecimalCommas : public std::numpunct<char>
{
protected:
  char do_decimal_point() const override { return ','; }
};

void TestLocale()
{
  const std::locale before = std::locale::global(std::locale(std::locale(), new DecimalCommas));
  ReaderOf test(MakeMarkups({ Curve() }));
  CheckFlag(test.Update(), 1);
  LACUNA_CHECK(test.Errors.empty());
  std::locale::global(before);
}

// Many curves, points, other markups and types of them.
void TestGrowth()
{
  const auto expectLinear = [](int size, const std::function<std::string(int)>& make)
  {
    const double growth = lacuna::GetGrowthOfThreeDoublings(size,
      [&](int n) -> std::function<void()>
      {
        const auto test = std::make_shared<ReaderOf>(make(n));
        return [test]
        {
          test->Reader->Modified();
          test->Update();
        };
      });
    LACUNA_CHECK_THAT(growth < lacuna::MostGrowth, std::to_string(growth));
  };
  Curve triangle;
  triangle.Points.resize(2);
  triangle.Points.push_back({ "[4.0, 3e1, 3.25]" });
  const auto repeat = [](int n, const Curve& curve)
  { return MakeMarkups(std::vector<Curve>(static_cast<std::size_t>(n), curve)); };
  expectLinear(1000, [&](int n) { return repeat(n, triangle); });
  expectLinear(400,
    [&](int n)
    {
      Curve curve;
      curve.Points.assign(static_cast<std::size_t>(n), { "[1.5, 2.0, 3.25]" });
      return MakeMarkups({ triangle, curve });
    });
  const auto others = [&](int n)
  {
    std::vector<Curve> curves(static_cast<std::size_t>(n), triangle);
    for (int i = 1; i < n; ++i)
    {
      curves[static_cast<std::size_t>(i)].Type = "Type" + std::to_string(i);
    }
    return MakeMarkups(curves);
  };
  expectLinear(400, others);
  ReaderOf many(others(1000));
  many.Update();
  LACUNA_CHECK_CONTAINS(
    many.Warnings, "markups that are not closed curves are left out: 1 of type");
  LACUNA_CHECK_CONTAINS(many.Warnings, " and others");
  LACUNA_CHECK_THAT(many.Warnings.size() < 600, many.Warnings);

  // lines are counted on, also from a place before
  Curve bad = triangle;
  bad.Points[1].Position = "[1.0, true, 2.0]";
  ReaderOf lines(MakeMarkups({ triangle, triangle, bad }));
  lines.Update();
  const std::string text = MakeMarkups({ triangle, triangle, bad });
  const std::string before = text.substr(0, text.rfind("\"id\": \"2\""));
  const auto line = std::count(before.begin(), before.end(), '\n'); // that of the brace before
  LACUNA_CHECK_CONTAINS(lines.Errors, "line " + std::to_string(line) + ": control point 2");
}
}

int TestMarkups(int, char*[])
{
  TestCoordinates();
  TestStructures();
  TestErrors();
  TestDamage();
  TestLocale();
  TestGrowth();
  return lacunaCheck::Result();
}
