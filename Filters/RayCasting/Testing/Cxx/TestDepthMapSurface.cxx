// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaDepthMapSurface.h"

#include "lacunaCheck.h"
#include "lacunaDepthMap.h"
#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkExecutive.h"
#include "vtkFieldData.h"
#include "vtkFloatArray.h"
#include "vtkIdTypeArray.h"
#include "vtkImageData.h"
#include "vtkLacunaBSplineIsoRayCaster.h"
#include "vtkLacunaDepthMapShader.h"
#include "vtkMath.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"
#include "vtkTestErrorObserver.h"
#include "vtkTriangle.h"

#include <cmath>
#include <cstdlib>
#include <set>
#include <sstream>
#include <string>

namespace
{
/// Distance to two balls, one before the other as seen from the top.
vtkSmartPointer<vtkImageData> MakeVolume()
{
  auto volume = vtkSmartPointer<vtkImageData>::New();
  volume->SetDimensions(40, 40, 50);
  volume->AllocateScalars(VTK_FLOAT, 1);
  for (vtkIdType i = 0; i < volume->GetNumberOfPoints(); ++i)
  {
    double p[3];
    volume->GetPoint(i, p);
    const double upper[3] = { p[0] - 14, p[1] - 22, p[2] - 40 };
    const double lower[3] = { p[0] - 20, p[1] - 18, p[2] - 15 };
    volume->GetPointData()->GetScalars()->SetTuple1(
      i, std::max(7 - vtkMath::Norm(upper), 14 - vtkMath::Norm(lower)));
  }
  return volume;
}

void TestSurface()
{
  vtkNew<vtkLacunaBSplineIsoRayCaster> caster;
  caster->SetInputData(MakeVolume());
  caster->SetIsoValue(0, 0);
  caster->SetPixelSpacing(0.5);
  caster->SetViewDirection(0.1, 0.05, -1);
  caster->Update();
  vtkImageData* map = caster->GetOutput();
  const lacuna::DepthMap checked(map);
  vtkNew<vtkLacunaDepthMapSurface> filter;
  filter->SetInputConnection(caster->GetOutputPort());
  filter->Update();
  vtkPolyData* surface = filter->GetOutput();
  vtkPointData* data = surface->GetPointData();
  vtkDataArray* depth = map->GetPointData()->GetArray("Depth");
  vtkIdType defined = 0;
  for (vtkIdType i = 0; i < depth->GetNumberOfTuples(); ++i)
  {
    defined += !std::isnan(depth->GetTuple1(i));
  }
  LACUNA_CHECK_THAT(
    defined > 1500 && surface->GetNumberOfPoints() == defined, "a point for each depth");
  auto* ids = vtkIdTypeArray::SafeDownCast(data->GetPedigreeIds());
  LACUNA_CHECK_THAT(ids && std::string(ids->GetName()) == "PixelId", "PixelId");
  LACUNA_CHECK_THAT(
    data->GetScalars() && std::string(data->GetScalars()->GetName()) == "Depth", "Depth");
  vtkDataArray* normals = data->GetNormals();
  LACUNA_CHECK_THAT(normals && std::string(normals->GetName()) == "Normals", "Normals");
  LACUNA_CHECK_THAT(data->GetArray("vtkValidPointMask") != nullptr, "arrays are carried");
  LACUNA_CHECK_THAT(
    surface->GetFieldData()->GetAbstractArray("Provenance") != nullptr, "Provenance");
  if (lacunaCheck::Failures())
  {
    return;
  }
  const int width = map->GetDimensions()[0];
  for (vtkIdType i = 0; i < surface->GetNumberOfPoints(); ++i)
  {
    const vtkIdType pixel = ids->GetValue(i);
    const lacuna::Vec3 p = checked.GetPoint(static_cast<double>(pixel % width),
      static_cast<double>(pixel / width), depth->GetTuple1(pixel));
    double q[3];
    surface->GetPoint(i, q);
    LACUNA_CHECK_THAT(vtkMath::Distance2BetweenPoints(p.data(), q) < 1e-20, "points are the map's");
    LACUNA_CHECK_THAT(
      data->GetScalars()->GetTuple1(i) == depth->GetTuple1(pixel), "values are the pixels'");
  }
  // every triangle faces the viewer, is small, and agrees with its normals
  double longest = 0;
  for (vtkIdType t = 0; t < surface->GetNumberOfCells(); ++t)
  {
    vtkIdType n;
    const vtkIdType* corners;
    surface->GetCellPoints(t, n, corners);
    double p[3][3];
    double mean[3] = { 0, 0, 0 };
    for (int c = 0; c < 3; ++c)
    {
      surface->GetPoint(corners[c], p[c]);
      double normal[3];
      normals->GetTuple(corners[c], normal);
      vtkMath::Add(mean, normal, mean);
    }
    for (int c = 0; c < 3; ++c)
    {
      longest = std::max(longest, std::sqrt(vtkMath::Distance2BetweenPoints(p[c], p[(c + 1) % 3])));
    }
    double normal[3];
    vtkTriangle::ComputeNormal(p[0], p[1], p[2], normal);
    const double view[3] = { checked.GetRay(0, 0)[0], checked.GetRay(0, 0)[1],
      checked.GetRay(0, 0)[2] };
    LACUNA_CHECK_THAT(vtkMath::Dot(normal, view) < 0, "front face towards the viewer");
    LACUNA_CHECK_THAT(vtkMath::Dot(normal, mean) > 0, "winding as normals");
  }
  LACUNA_CHECK_THAT(longest < 6, "no skin between the balls");
  filter->BreakAtDiscontinuitiesOff();
  filter->Update();
  double bridged = 0;
  for (vtkIdType t = 0; t < filter->GetOutput()->GetNumberOfCells(); ++t)
  {
    bridged = std::max(bridged, filter->GetOutput()->GetCell(t)->GetLength2());
  }
  LACUNA_CHECK_THAT(std::sqrt(bridged) > 12, "a skin, when asked for");
}

void TestPieces()
{
  vtkNew<vtkLacunaBSplineIsoRayCaster> caster;
  caster->SetInputData(MakeVolume());
  caster->SetIsoValue(0, 0);
  vtkNew<vtkLacunaDepthMapSurface> filter;
  filter->SetInputConnection(caster->GetOutputPort());
  filter->Update();
  const vtkIdType triangles = filter->GetOutput()->GetNumberOfCells();
  std::set<vtkIdType> whole;
  auto* ids = vtkIdTypeArray::SafeDownCast(filter->GetOutput()->GetPointData()->GetPedigreeIds());
  whole.insert(ids->Begin(), ids->End());
  for (const int pieces : { 2, 3, 100 })
  {
    vtkIdType sum = 0;
    std::set<vtkIdType> all;
    for (int piece = 0; piece < pieces; ++piece)
    {
      filter->UpdatePiece(piece, pieces, 0);
      sum += filter->GetOutput()->GetNumberOfCells();
      auto* part =
        vtkIdTypeArray::SafeDownCast(filter->GetOutput()->GetPointData()->GetPedigreeIds());
      if (part)
      {
        all.insert(part->Begin(), part->End());
      }
    }
    LACUNA_CHECK_THAT(sum == triangles, "pieces add up to the whole: " + std::to_string(pieces));
    LACUNA_CHECK_THAT(all == whole, "with the same pixels");
  }
}

/// The angle between the map's normals and those of the nine cases, as the shader has it.
void TestNormalDifference()
{
  vtkNew<vtkLacunaBSplineIsoRayCaster> caster;
  caster->SetInputData(MakeVolume());
  caster->SetIsoValue(0, 0);
  vtkNew<vtkLacunaDepthMapShader> shader;
  shader->SetInputConnection(caster->GetOutputPort());
  shader->SetNormalMethod(vtkLacunaDepthMapShader::Predicate);
  shader->SetMaximumAngle(50);
  shader->Update();
  vtkDataArray* expected = shader->GetOutput()->GetPointData()->GetArray("NormalDifference");
  vtkNew<vtkLacunaDepthMapSurface> filter;
  filter->SetInputConnection(caster->GetOutputPort());
  filter->SetMaximumAngle(50);
  filter->Update();
  LACUNA_CHECK(!filter->GetOutput()->GetPointData()->HasArray("NormalDifference"));
  filter->ComputeNormalDifferenceOn();
  vtkIdType compared = 0;
  for (int piece = 0; piece < 3; ++piece)
  {
    filter->UpdatePiece(piece, 3, 0);
    vtkPointData* data = filter->GetOutput()->GetPointData();
    for (vtkIdType i = 0; i < filter->GetOutput()->GetNumberOfPoints(); ++i, ++compared)
    {
      const auto pixel = static_cast<vtkIdType>(data->GetArray("PixelId")->GetTuple1(i));
      LACUNA_CHECK(data->GetArray("NormalDifference")->GetTuple1(i) == expected->GetTuple1(pixel));
    }
  }
  LACUNA_CHECK(compared > 300);
}

/// A made-up filled map whose extent does not start at zero.
void TestOtherArrays()
{
  vtkNew<vtkImageData> map;
  map->SetExtent(10, 13, 20, 22, 0, 0);
  lacuna::DepthMap::SetGeometry(
    map, { { 1, 2, 3 }, { 1, 0, 0 }, { 0, -1, 0 }, { 0, 0, -1 }, { 0.5, 0.5 } });
  for (const char* name : { "Depth", "Fitted" })
  {
    vtkNew<vtkFloatArray> array;
    array->SetName(name);
    array->SetNumberOfTuples(12);
    array->Fill(std::string(name) == "Depth" ? 7 : 8);
    map->GetPointData()->AddArray(array);
  }
  map->GetPointData()->GetArray("Depth")->SetTuple1(0, vtkMath::Nan());
  vtkNew<vtkFloatArray> normals;
  normals->SetName("Normals");
  normals->SetNumberOfComponents(3);
  normals->SetNumberOfTuples(12);
  normals->Fill(0);
  map->GetPointData()->SetNormals(normals);
  vtkNew<vtkLacunaDepthMapSurface> filter;
  filter->SetInputData(map);
  filter->Update();
  LACUNA_CHECK_THAT(filter->GetOutput()->GetNumberOfPoints() == 11, "Depth has a hole");
  LACUNA_CHECK_THAT(
    vtkIdTypeArray::SafeDownCast(filter->GetOutput()->GetPointData()->GetPedigreeIds())
        ->GetValue(0) == 1,
    "PixelId counts from the corner of the whole extent");
  LACUNA_CHECK_THAT(
    std::abs(filter->GetOutput()->GetPoint(0)[0] - (1 + 11 * 0.5)) < 1e-6, "at its place");
  filter->SetDepthArray("Fitted");
  filter->Update();
  vtkPolyData* surface = filter->GetOutput();
  LACUNA_CHECK_THAT(
    surface->GetNumberOfPoints() == 12 && surface->GetNumberOfCells() == 12, "Fitted has none");
  LACUNA_CHECK_THAT(std::abs(surface->GetPoint(0)[2] - (3 - 8)) < 1e-6, "depths of Fitted");
  LACUNA_CHECK_THAT(
    std::string(surface->GetPointData()->GetScalars()->GetName()) == "Fitted", "scalars");
  LACUNA_CHECK_THAT(surface->GetPointData()->GetNormals() == nullptr, "Normals belong to Depth");
}

void TestBadInput()
{
  const auto errorOf = [](vtkImageData* map, const char* array, double angle)
  {
    vtkNew<vtkLacunaDepthMapSurface> filter;
    vtkNew<vtkTest::ErrorObserver> observer;
    filter->AddObserver(vtkCommand::ErrorEvent, observer);
    filter->GetExecutive()->AddObserver(vtkCommand::ErrorEvent, observer);
    filter->SetInputData(map);
    filter->SetDepthArray(array);
    filter->SetMaximumAngle(angle);
    filter->Update();
    LACUNA_CHECK_THAT(filter->GetOutput()->GetNumberOfPoints() == 0, "no output after an error");
    return observer->GetErrorMessage();
  };
  vtkNew<vtkImageData> map;
  map->SetDimensions(4, 4, 1);
  LACUNA_CHECK_THAT(
    errorOf(map, "Depth", 65).find("'Depth'") != std::string::npos, "not a depth map");
  vtkNew<vtkDoubleArray> depth;
  depth->SetName("Depth");
  depth->SetNumberOfTuples(16);
  depth->Fill(1);
  map->GetPointData()->AddArray(depth);
  LACUNA_CHECK_THAT(
    errorOf(map, "Depth", 65).find("ImageToWorld") != std::string::npos, "no geometry");
  lacuna::DepthMap::SetGeometry(
    map, { { 0, 0, 0 }, { 1, 0, 0 }, { 0, -1, 0 }, { 0, 0, -1 }, { 1, 1 } });
  LACUNA_CHECK_THAT(
    errorOf(map, "Fitted", 65).find("'Fitted'") != std::string::npos, "no such array");
  LACUNA_CHECK_THAT(
    errorOf(map, "Depth", 95).find("MaximumAngle is 95") != std::string::npos, "angle");
  {
    vtkNew<vtkLacunaDepthMapSurface> filter;
    const auto messages = lacunaCheck::Watch(filter);
    filter->SetInputData(map);
    filter->ComputeNormalDifferenceOn();
    filter->Update();
    LACUNA_CHECK_CONTAINS(messages->Errors, "no normals 'Normals'");
  }
  map->SetDirectionMatrix(1, 0, 0, 0, 1, 0, 0, 0, 1);
  LACUNA_CHECK_THAT(
    errorOf(map, "Depth", 65).find("disagrees") != std::string::npos, "reset direction");

  vtkNew<vtkLacunaDepthMapSurface> filter;
  vtkNew<vtkImageData> empty;
  filter->SetInputData(empty);
  filter->Update();
  LACUNA_CHECK_THAT(filter->GetOutput()->GetNumberOfPoints() == 0, "empty in, empty out");
  LACUNA_CHECK_THAT(filter->GetDepthArray() == "Depth" && filter->GetBreakAtDiscontinuities() &&
      filter->GetMaximumAngle() == 65 && filter->GetMaximumAngleChange() == 20 &&
      !filter->GetComputeNormalDifference(),
    "defaults");
  std::ostringstream text;
  filter->Print(text);
  LACUNA_CHECK_THAT(text.str().find("MaximumAngleChange: 20") != std::string::npos, "PrintSelf");
}
}

int TestDepthMapSurface(int, char*[])
{
  TestSurface();
  TestPieces();
  TestNormalDifference();
  TestOtherArrays();
  TestBadInput();
  return lacunaCheck::Result();
}
