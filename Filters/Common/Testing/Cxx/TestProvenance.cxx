// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaCheck.h"
#include "lacunaCoordinates.h"
#include "lacunaProvenance.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkImageShrink3D.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkStringArray.h"

int TestProvenance(int, char*[])
{
  vtkNew<vtkImageData> a;
  a->SetDimensions(3, 3, 3);
  a->AllocateScalars(VTK_UNSIGNED_CHAR, 1); // 27 bytes: whole words and a rest
  a->GetPointData()->GetScalars()->Fill(1);
  vtkNew<vtkImageData> b;
  vtkNew<vtkImageShrink3D> step;
  lacuna::Provenance::Record(b, step, { a }, "Factor=2");
  const std::vector<std::string> first = lacuna::Provenance::Get(b);
  LACUNA_CHECK(first.size() == 1);
  LACUNA_CHECK(first[0].find(lacuna::Provenance::GetVersion()) != std::string::npos);
  LACUNA_CHECK(first[0].find("vtkImageShrink3D") != std::string::npos);
  LACUNA_CHECK(first[0].find("Factor=2") != std::string::npos);

  // the last byte counts
  a->GetPointData()->GetScalars()->SetComponent(26, 0, 2);
  vtkNew<vtkImageData> other;
  lacuna::Provenance::Record(other, step, { a }, "Factor=2");
  LACUNA_CHECK(lacuna::Provenance::Get(other) != first);

  // the steps of all inputs, each once
  vtkNew<vtkImageData> c;
  lacuna::Provenance::Record(c, step, { b, b, other }, "");
  const std::vector<std::string> chain = lacuna::Provenance::Get(c);
  LACUNA_CHECK(chain.size() == 3);
  LACUNA_CHECK(chain[0] == first[0]);

  // a mesh without scalars is known by its points
  vtkNew<vtkPolyData> mesh;
  vtkNew<vtkPoints> points;
  points->InsertNextPoint(1, 2, 3);
  mesh->SetPoints(points);
  std::vector<std::string> steps[2];
  for (std::vector<std::string>& s : steps)
  {
    vtkNew<vtkPolyData> output;
    lacuna::Provenance::Record(output, step, { mesh }, "");
    s = lacuna::Provenance::Get(output);
    LACUNA_CHECK(s[0].find("input:-") == std::string::npos);
    points->SetPoint(0, 1, 2, 4);
  }
  LACUNA_CHECK(steps[0] != steps[1]);

  // the mark of coordinates is that of the first input, unless the output has its own
  const auto coordinates = [](vtkDataObject* data) -> std::string
  {
    auto* mark =
      vtkStringArray::SafeDownCast(data->GetFieldData()->GetAbstractArray("Coordinates"));
    const std::string text =
      mark && mark->GetNumberOfValues() == 1 ? mark->GetValue(0) : std::string("-");
    LACUNA_CHECK(lacuna::Coordinates::Get(data) == (text == "-" ? "" : text));
    return text;
  };
  lacuna::Coordinates::Mark(a, lacuna::Coordinates::Patient);
  lacuna::Coordinates::Mark(b, lacuna::Coordinates::Press);
  vtkNew<vtkImageData> d;
  lacuna::Provenance::Record(d, step, { mesh, a }, "");
  LACUNA_CHECK(coordinates(d) == "-");
  lacuna::Provenance::Record(d, step, { a, b }, "");
  LACUNA_CHECK(coordinates(d) == "Patient");
  lacuna::Provenance::Record(d, step, { b }, "");
  LACUNA_CHECK(coordinates(d) == "Patient");
  lacuna::Coordinates::Mark(d, lacuna::Coordinates::Press);
  LACUNA_CHECK(coordinates(d) == "Press" && coordinates(a) == "Patient");
  lacuna::Coordinates::Clear(d);
  LACUNA_CHECK(coordinates(d) == "-");

  // what lies in the press says where it comes from, when that is known
  using namespace lacuna::Coordinates;
  MarkPress(a, d);
  LACUNA_CHECK(coordinates(d) == "Press" && GetBeforePress(d) == "Patient");
  vtkNew<vtkImageData> path;
  lacuna::Provenance::Record(path, step, { d }, "");
  LACUNA_CHECK(coordinates(path) == "Press" && GetBeforePress(path) == "Patient");
  vtkNew<vtkImageData> unmarked;
  MarkPress(unmarked, d);
  LACUNA_CHECK(coordinates(d) == "Press" && GetBeforePress(d).empty());
  lacuna::Provenance::Record(path, step, { d }, ""); // keeps its own, both
  LACUNA_CHECK(GetBeforePress(path) == "Patient");
  Mark(path, Patient);
  LACUNA_CHECK(coordinates(path) == "Patient" && GetBeforePress(path).empty());
  lacuna::Coordinates::Clear(path);
  LACUNA_CHECK(coordinates(path) == "-");

  // a mirror image stays one, whatever coordinates the output says it has, also without any
  MarkMirrored(b, { 1, 2, 3 }, { 0, 1, 0 });
  LACUNA_CHECK(coordinates(b) == "Press" && !IsMirrored(path));
  Mark(path, Patient);
  lacuna::Provenance::Record(path, step, { b }, "");
  LACUNA_CHECK(coordinates(path) == "Patient" && IsMirrored(path));
  lacuna::Coordinates::Clear(path);
  LACUNA_CHECK(IsMirrored(path));
  for (const char* name : { MirrorOriginName, MirrorNormalName })
  {
    LACUNA_CHECK(path->GetFieldData()->GetArray(name) == b->GetFieldData()->GetArray(name));
  }
  lacuna::Provenance::Record(unmarked, step, { a, b }, "");
  LACUNA_CHECK(!IsMirrored(unmarked));
  return lacunaCheck::Result();
}
