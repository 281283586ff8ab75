// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What the shader says to maps, volumes and settings that are wrong, empty or hardly anything.
#include "vtkLacunaDepthMapShader.h"

#include "lacunaCheck.h"
#include "lacunaDepthMap.h"
#include "lacunaFieldData.h"
#include "lacunaHandMadeMap.h"
#include "vtkExecutive.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkMath.h"
#include "vtkNew.h"
#include "vtkPointData.h"

#include <cmath>
#include <limits>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace
{
using lacunaTest::MakeMap;
const double Nan = vtkMath::Nan();

void TestBadInput()
{
  vtkNew<vtkLacunaDepthMapShader> shader;
  const auto errorOf = [&](vtkImageData* map)
  {
    const auto messages = lacunaCheck::Watch(shader);
    shader->SetInputData(map);
    shader->Update();
    LACUNA_CHECK(messages->Errors.empty() || shader->GetOutput()->GetNumberOfPoints() == 0);
    const std::string text = messages->Errors;
    shader->RemoveAllObservers();
    shader->GetExecutive()->RemoveAllObservers();
    return text;
  };
  vtkNew<vtkImageData> empty;
  LACUNA_CHECK(errorOf(empty).empty());
  vtkNew<vtkImageData> other;
  other->SetDimensions(3, 3, 1);
  LACUNA_CHECK_CONTAINS(errorOf(other), "'Depth'");
  const auto map = MakeMap(3, 2, { 1, 2, 3, Nan, 5, 6 });
  LACUNA_CHECK_CONTAINS(errorOf(map), "no normals 'Normals'");
  vtkNew<vtkFloatArray> normals;
  normals->SetName("Normals");
  normals->SetNumberOfComponents(2);
  normals->SetNumberOfTuples(6);
  normals->Fill(0);
  map->GetPointData()->AddArray(normals);
  LACUNA_CHECK_CONTAINS(errorOf(map), "of three components");
  normals->SetNumberOfComponents(3);
  normals->SetNumberOfTuples(5);
  LACUNA_CHECK_CONTAINS(errorOf(map), "Normals has 5 values for 6");
  normals->SetNumberOfTuples(6);
  normals->Fill(0);
  normals->SetTuple3(1, 0, 0, 1);
  {
    const auto messages = lacunaCheck::Watch(shader);
    shader->SetInputData(map);
    shader->Modified();
    normals->Modified();
    shader->Update();
    LACUNA_CHECK_CONTAINS(messages->Warnings, "4 pixels have a depth and no normal");
    LACUNA_CHECK(shader->GetOutput()->GetPointData()->GetScalars()->GetComponent(0, 0) == 255);
    shader->RemoveAllObservers();
    shader->GetExecutive()->RemoveAllObservers();
  }
  shader->SetDepthArray("Fitted");
  LACUNA_CHECK_CONTAINS(errorOf(map), "'Fitted'");
  shader->SetDepthArray("Depth");
  shader->SetNormalMethod(4);
  LACUNA_CHECK_CONTAINS(errorOf(map), "NormalMethod is 4; it must be 0 (Stored)");
  shader->SetNormalMethod(vtkLacunaDepthMapShader::Predicate);
  LACUNA_CHECK(errorOf(map).empty());
  for (const double bad : { -1.0, 90.5, Nan, std::numeric_limits<double>::infinity() })
  {
    shader->SetMaximumAngle(bad);
    LACUNA_CHECK_CONTAINS(errorOf(map), "MaximumAngle is");
  }
  shader->SetMaximumAngle(65);
  shader->SetDepthCue(Nan);
  LACUNA_CHECK_CONTAINS(errorOf(map), "DepthCue is");
  shader->SetDepthCue(0);
  shader->SetShadowBias(-1);
  LACUNA_CHECK_CONTAINS(errorOf(map), "ShadowBias is -1 mm; it must be 0 (a tenth of a voxel)");
  shader->SetShadowBias(0);
  shader->AddLight(0, 0, 1, 0.5, 1);
  LACUNA_CHECK_CONTAINS(
    errorOf(map), "number 0.500000; it must be 0 for a direction or 1 for a position");
  shader->RemoveAllLights();
  shader->AddLight(0, 0, 0, 0, 1);
  LACUNA_CHECK_CONTAINS(errorOf(map), "light 0 has no direction");
  shader->RemoveAllLights();
  shader->AddLight(1, 0, 0, 0, 1);
  vtkNew<vtkImageData> volume;
  volume->SetDimensions(5, 5, 5);
  shader->SetInputData(1, volume);
  LACUNA_CHECK_CONTAINS(errorOf(map), "no active point scalars");
  volume->AllocateScalars(VTK_FLOAT, 1);
  volume->GetPointData()->GetScalars()->Fill(0);
  volume->Modified();
  LACUNA_CHECK_CONTAINS(errorOf(map), "'IsoValues'");
  lacuna::FieldData::Set(map, lacuna::DepthMap::IsoValuesName, { 1 }, 1);
  map->Modified();
  {
    const auto messages = lacunaCheck::Watch(shader);
    shader->Update();
    LACUNA_CHECK(messages->Errors.empty());
    LACUNA_CHECK_CONTAINS(messages->Warnings, "iso-value 1 lies outside the volume's values");
    shader->RemoveAllObservers();
    shader->GetExecutive()->RemoveAllObservers();
  }
  volume->SetDimensions(25, 5, 1);
  volume->Modified();
  LACUNA_CHECK_CONTAINS(errorOf(map), "at least two voxels");
  shader->CastShadowsOff();
  LACUNA_CHECK(errorOf(map).empty());
  shader->RemoveAllInputConnections(1);

  // nothing to see, and hardly anything
  for (const auto& size : { std::make_pair(1, 1), { 1, 5 }, { 5, 1 } })
  {
    for (const double depth : { 3.0, Nan })
    {
      LACUNA_CHECK(errorOf(
        MakeMap(size.first, size.second, std::vector<double>(size.first * size.second, depth)))
                     .empty());
      LACUNA_CHECK((shader->GetOutput()->GetPointData()->GetScalars()->GetComponent(0, 0) > 0) ==
        !std::isnan(depth));
    }
  }
  std::ostringstream text;
  shader->Print(text);
  LACUNA_CHECK_CONTAINS(text.str(), "MaximumAngleChange: 20 (from 0 to 180 degrees)");
}
}

int TestDepthMapShaderInputs(int, char*[])
{
  TestBadInput();
  return lacunaCheck::Result();
}
