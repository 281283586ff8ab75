// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaDepthMapShader.h"

#include "lacunaCheck.h"
#include "lacunaDepthMap.h"
#include "lacunaFieldData.h"
#include "lacunaHandMadeMap.h"
#include "lacunaProvenance.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkLacunaBSplineIsoRayCaster.h"
#include "vtkLacunaDepthMapSurface.h"
#include "vtkMath.h"
#include "vtkNew.h"
#include "vtkPlane.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"
#include "vtkSphere.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkStringArray.h"
#include "vtkTrivialProducer.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <vector>

namespace
{
using lacunaTest::MakeMap;
const double Nan = vtkMath::Nan();

/// A ball of radius 6 over a ground at z = 6, off the middle to the left and the back; solid above 0.
vtkSmartPointer<vtkImageData> MakeVolume()
{
  auto volume = vtkSmartPointer<vtkImageData>::New();
  volume->SetExtent(3, 52, 2, 41, 1, 30);
  volume->AllocateScalars(VTK_FLOAT, 1);
  for (vtkIdType i = 0; i < volume->GetNumberOfPoints(); ++i)
  {
    double p[3];
    volume->GetPoint(i, p);
    const double d[3] = { p[0] - 16, p[1] - 26, p[2] - 19 };
    volume->GetPointData()->GetScalars()->SetTuple1(i, std::max(6 - p[2], 6 - vtkMath::Norm(d)));
  }
  volume->GetPointData()->GetScalars()->SetName("Density");
  return volume;
}

struct Pipeline
{
  vtkNew<vtkLacunaBSplineIsoRayCaster> Caster;
  vtkNew<vtkLacunaDepthMapShader> Shader;

  Pipeline()
  {
    this->Caster->SetInputData(MakeVolume());
    this->Caster->SetIsoValue(0, 0);
    this->Shader->SetInputConnection(this->Caster->GetOutputPort());
  }

  vtkImageData* Update()
  {
    this->Shader->Update();
    return this->Shader->GetOutput();
  }
  /// Red at a point of the world seen from the top.
  int At(double x, double y)
  {
    vtkImageData* image = this->Update();
    double p[3] = { x, y, image->GetOrigin()[2] };
    int index[3];
    double local[3];
    image->ComputeStructuredCoordinates(p, index, local);
    return static_cast<int>(
      image->GetPointData()->GetScalars()->GetComponent(image->ComputePointId(index), 0));
  }
};

void TestPicture()
{
  Pipeline p;
  vtkImageData* image = p.Update();
  vtkImageData* map = p.Caster->GetOutput();
  vtkPointData* data = image->GetPointData();
  auto* colors = vtkUnsignedCharArray::SafeDownCast(data->GetScalars());
  LACUNA_CHECK(
    colors && std::string(colors->GetName()) == "Color" && colors->GetNumberOfComponents() == 3);
  LACUNA_CHECK(image->GetDimensions()[0] == map->GetDimensions()[0] &&
    image->GetDimensions()[1] == map->GetDimensions()[1]);
  LACUNA_CHECK(data->GetArray("Depth") == map->GetPointData()->GetArray("Depth"));
  LACUNA_CHECK(data->GetArray("vtkValidPointMask") != nullptr);
  LACUNA_CHECK(data->GetNormals() && std::string(data->GetNormals()->GetName()) == "Normals");
  LACUNA_CHECK_THAT(data->GetArray("NormalDifference") == nullptr, "the stored normals were used");
  const lacuna::DepthMap contract(image); // the output is a depth map still
  const std::vector<std::string> steps = lacuna::Provenance::Get(image);
  LACUNA_CHECK(steps.size() == 2 && steps[1].find("vtkLacunaDepthMapShader") != std::string::npos);
  if (lacunaCheck::Failures())
  {
    return;
  }
  // 0.1 + 0.7 N.L + 0.2 (2 (N.L)^2 - 1)^20, the light being at the viewer
  for (vtkIdType i = 0; i < image->GetNumberOfPoints(); ++i)
  {
    const double cosine = map->GetPointData()->GetNormals()->GetComponent(i, 2);
    const double mirrored = std::max(0.0, 2 * cosine * cosine - 1);
    LACUNA_CHECK_NEAR(
      colors->GetComponent(i, 1), 255 * (0.1 + 0.7 * cosine + 0.2 * std::pow(mirrored, 20)), 0.501);
  }
  LACUNA_CHECK(p.At(40, 10) == 255);

  p.Shader->SetNormalMethod(vtkLacunaDepthMapShader::Predicate);
  image = p.Update();
  vtkDataArray* difference = image->GetPointData()->GetArray("NormalDifference");
  vtkDataArray* normals = image->GetPointData()->GetArray("Normals");
  LACUNA_CHECK(difference && normals != map->GetPointData()->GetArray("Normals"));
  for (vtkIdType i = 0; difference && i < image->GetNumberOfPoints(); ++i)
  {
    double a[3];
    double b[3];
    map->GetPointData()->GetNormals()->GetTuple(i, a);
    normals->GetTuple(i, b);
    LACUNA_CHECK_NEAR(difference->GetTuple1(i),
      vtkMath::DegreesFromRadians(vtkMath::AngleBetweenVectors(a, b)), 1e-4);
  }

  // depths of another name have normals of another name
  p.Caster->SetIsoValue(1, 2);
  p.Shader->SetDepthArray("Depth_1");
  image = p.Update();
  LACUNA_CHECK(image->GetPointData()->HasArray("Normals_1") &&
    image->GetPointData()->HasArray("NormalDifference"));
}

void TestMethodsAreTheKernels()
{
  // a step of 10 mm between two flats: darkened by central differences only
  const auto map = MakeMap(6, 1, { 10, 10, 10, 20, 20, 20 });
  vtkNew<vtkLacunaDepthMapShader> shader;
  shader->SetInputData(map);
  shader->SetSpecular(0);
  const auto third = [&](int method)
  {
    shader->SetNormalMethod(method);
    shader->Update();
    return static_cast<int>(shader->GetOutput()->GetPointData()->GetScalars()->GetComponent(2, 0));
  };
  const double cosine = 1 / std::sqrt(26.0);
  LACUNA_CHECK(third(vtkLacunaDepthMapShader::CentralDifference) ==
    static_cast<int>(255 * (0.1 + 0.7 * cosine) + 0.5));
  LACUNA_CHECK(third(vtkLacunaDepthMapShader::Gordon) == 204);
  LACUNA_CHECK(third(vtkLacunaDepthMapShader::Predicate) == 204);
  // with a limit beyond the step's 84.3 degrees it is no discontinuity
  shader->SetMaximumAngle(85);
  LACUNA_CHECK(third(vtkLacunaDepthMapShader::Predicate) < 100);
  shader->SetMaximumAngle(65);
  shader->SetMaximumAngleChange(85);
  LACUNA_CHECK(third(vtkLacunaDepthMapShader::Predicate) < 100);

  shader->SetShading(vtkLacunaDepthMapShader::DepthOnly);
  shader->SetNormalMethod(vtkLacunaDepthMapShader::Stored);
  shader->Update();
  LACUNA_CHECK_THAT(
    shader->GetOutput()->GetPointData()->GetScalars(), "depth-only needs no normals");
}

void TestDepthCue()
{
  // with a volume: the sphere around its box, here 20 +- 15 along z
  const auto map = MakeMap(4, 1, { 5, 20, 35, Nan });
  vtkNew<vtkImageData> volume;
  volume->SetOrigin(-10, -4, 15);
  volume->SetDimensions(21, 21, 11);
  volume->AllocateScalars(VTK_SHORT, 1);
  volume->GetPointData()->GetScalars()->Fill(0);
  vtkNew<vtkLacunaDepthMapShader> shader;
  shader->SetInputData(0, map);
  shader->SetInputData(1, volume);
  shader->SetShading(vtkLacunaDepthMapShader::DepthOnly);
  shader->SetBackgroundColor(0, 0, 1);
  const auto red = [&](int pixel)
  {
    shader->Update();
    return shader->GetOutput()->GetPointData()->GetScalars()->GetComponent(pixel, 0);
  };
  LACUNA_CHECK_NEAR(red(0), 255, 0);
  LACUNA_CHECK_NEAR(red(1), 255 * (4 / 2.25 - 1) / 3, 0.5);
  LACUNA_CHECK_NEAR(red(2), 0, 0);
  LACUNA_CHECK_NEAR(red(3), 0, 0);
  LACUNA_CHECK_NEAR(shader->GetOutput()->GetPointData()->GetScalars()->GetComponent(3, 2), 255, 0);
  shader->SetDepthLaw(vtkLacunaDepthMapShader::Inverse);
  LACUNA_CHECK_NEAR(red(1), 85, 0);
  // without one: around the map's own points, 0 0 35 to 2 0 5
  shader->RemoveAllInputConnections(1);
  const double radius = 0.5 * std::sqrt(4.0 + 900);
  LACUNA_CHECK_NEAR(red(1), 85, 0);
  LACUNA_CHECK_NEAR(red(0), 255 * (2 / (1 + 0.5 - 15 / (2 * radius)) - 1), 0.5);
  shader->SetShading(vtkLacunaDepthMapShader::Phong);
  shader->SetNormalMethod(vtkLacunaDepthMapShader::Predicate);
  shader->SetSpecular(0);
  shader->SetDiffuse(0);
  shader->SetAmbient(0.8);
  shader->SetDepthCue(1);
  LACUNA_CHECK_NEAR(red(1), 0.8 * 85, 0.5);
  shader->SetDepthCue(0);
  LACUNA_CHECK_NEAR(red(1), 204, 0);
}

void TestShadows()
{
  Pipeline p;
  // from the left at 45 degrees: the shadow's middle is 13 mm to the right of the ball's
  p.Shader->AddLight(-1, 0, 1, 0, 1);
  LACUNA_CHECK(p.Shader->GetNumberOfLights() == 1);
  const int lit = p.At(29, 26);
  LACUNA_CHECK(lit > 140 && p.At(45, 10) == lit);
  p.Shader->SetInputConnection(1, p.Caster->GetInputConnection(0, 0));
  LACUNA_CHECK_THAT(p.At(29, 26) == 26, "ambient light only");
  LACUNA_CHECK(p.At(45, 10) == lit);
  LACUNA_CHECK_THAT(p.At(29, 16) == lit && p.At(29, 36) == lit, "the ball is not so wide");
  LACUNA_CHECK_THAT(p.At(4, 26) == lit, "not on the side of the light");
  LACUNA_CHECK_THAT(p.At(13, 26) > 150, "no shadow of the ball on its own lit side");
  // the same from a second side: half the light each
  p.Shader->RemoveAllLights();
  p.Shader->AddLight(-1, 0, 1, 0, 0.5);
  p.Shader->AddLight(1, 0, 1, 0, 0.5);
  p.Shader->SetSpecular(0);
  LACUNA_CHECK_NEAR(p.At(45, 10), 255 * (0.1 + 0.7 * std::sqrt(0.5)), 1);
  LACUNA_CHECK_NEAR(p.At(29, 26), 255 * (0.1 + 0.35 * std::sqrt(0.5)), 1);
  p.Shader->CastShadowsOff();
  LACUNA_CHECK_NEAR(p.At(29, 26), 255 * (0.1 + 0.7 * std::sqrt(0.5)), 1);
  p.Shader->CastShadowsOn();
  // a lamp to the right of the ball shades what is to its left
  p.Shader->RemoveAllLights();
  p.Shader->AddLight(40, 26, 60, 1, 1);
  LACUNA_CHECK(p.At(6, 26) == 26 && p.At(30, 26) > 60);
  // one within the volume throws the ball's shadow away from itself only
  p.Shader->RemoveAllLights();
  p.Shader->AddLight(30, 26, 25, 1, 1);
  p.Shader->SetSpecular(0);
  LACUNA_CHECK_THAT(p.At(6, 26) == 26, "behind the ball");
  for (const double x : { 25.0, 30.0, 40.0 })
  {
    const double cosine = 19 / std::hypot(19, x - 30);
    LACUNA_CHECK_NEAR(p.At(x, 26), 255 * (0.1 + 0.7 * cosine), 4);
  }
}

void TestCutAway()
{
  Pipeline p;
  p.Shader->SetInputConnection(1, p.Caster->GetInputConnection(0, 0));
  p.Shader->AddLight(-1, 0, 1, 0, 1);
  vtkNew<vtkSphere> ball;
  ball->SetCenter(16, 26, 19);
  ball->SetRadius(8);
  p.Caster->SetCutAway(ball);
  const int lit = p.At(45, 10);
  LACUNA_CHECK_THAT(p.At(29, 26) == 26, "the map has no ball, but its shadow");
  p.Shader->SetCutAway(ball);
  LACUNA_CHECK(p.Shader->GetCutAway() == ball);
  LACUNA_CHECK_THAT(p.At(29, 26) == lit && p.At(16, 26) == lit, "what is not there has no shadow");
  ball->SetRadius(0.5); // the functions are watched
  LACUNA_CHECK(p.At(29, 26) == 26);
  // half a ball: its cut face stops the light unless it is open
  vtkNew<vtkPlane> plane;
  plane->SetOrigin(16, 26, 19);
  plane->SetNormal(0, 0, -1);
  p.Caster->SetCutAway(plane);
  p.Shader->SetCutAway(plane);
  LACUNA_CHECK(p.At(29, 26) == 26);
  p.Shader->CapCutAwayOff();
  LACUNA_CHECK(p.At(29, 26) == lit);
  std::ostringstream text;
  p.Shader->Print(text);
  LACUNA_CHECK_CONTAINS(text.str(), "Normal=0,0,-1\"\n  CapCutAway: off");
  p.Shader->SetCutAway(nullptr);
  LACUNA_CHECK(p.At(29, 26) == 26);
}

void TestPieces()
{
  Pipeline p;
  p.Shader->SetInputConnection(1, p.Caster->GetInputConnection(0, 0));
  p.Shader->AddLight(-1, 0.2, 0.6, 0, 1);
  p.Shader->SetNormalMethod(vtkLacunaDepthMapShader::Predicate);
  p.Shader->SetDepthCue(0.5);
  for (const bool withVolume : { true, false })
  {
    if (!withVolume)
    {
      p.Shader->RemoveAllInputConnections(1); // now the sphere is that of the whole map
    }
    vtkNew<vtkImageData> whole;
    whole->DeepCopy(p.Update());
    for (const int pieces : { 2, 3, 7 })
    {
      vtkIdType pixels = 0;
      for (int piece = 0; piece < pieces; ++piece)
      {
        p.Shader->UpdatePiece(piece, pieces, 0);
        vtkImageData* part = p.Shader->GetOutput();
        int* extent = part->GetExtent();
        pixels += part->GetNumberOfPoints();
        for (vtkIdType i = 0; i < part->GetNumberOfPoints(); ++i)
        {
          const int columns = extent[1] - extent[0] + 1;
          int index[3] = { static_cast<int>(extent[0] + i % columns),
            static_cast<int>(extent[2] + i / columns), 0 };
          const vtkIdType j = whole->ComputePointId(index);
          for (const char* name : { "Color", "Normals", "NormalDifference", "Depth" })
          {
            vtkDataArray* a = part->GetPointData()->GetArray(name);
            vtkDataArray* b = whole->GetPointData()->GetArray(name);
            for (int c = 0; c < a->GetNumberOfComponents(); ++c)
            {
              const double x = a->GetComponent(i, c);
              const double y = b->GetComponent(j, c);
              LACUNA_CHECK_THAT(x == y || (std::isnan(x) && std::isnan(y)), name);
            }
          }
        }
      }
      LACUNA_CHECK(pixels >= whole->GetNumberOfPoints());
    }
  }
}

void TestPerspective()
{
  // a plane oblique to the view of an eye 10 mm before the image: exact normals at every pixel
  const int columns = 15;
  const int rows = 11;
  const auto map = MakeMap(columns, rows, std::vector<double>(columns * rows, 0));
  lacuna::FieldData::Set(map, lacuna::DepthMap::EyePositionName, { 7, -5, 50 }, 3);
  lacuna::FieldData::Set(map, lacuna::DepthMap::ViewAngleName, { 70 }, 1);
  const lacuna::Vec3 normal = lacuna::Normalized({ 0.3, -0.2, 0.9 });
  const lacuna::DepthMap contract(map);
  for (int i = 0; i < columns * rows; ++i)
  {
    const lacuna::Vec3 pixel = contract.GetPoint(i % columns, i / columns, 0);
    const lacuna::Vec3 ray = contract.GetRay(i % columns, i / columns);
    map->GetPointData()->GetScalars()->SetTuple1(
      i, lacuna::Dot(lacuna::Vec3{ 7, -5, 10 } - pixel, normal) / lacuna::Dot(ray, normal));
  }
  vtkNew<vtkLacunaDepthMapShader> shader;
  shader->SetInputData(map);
  shader->SetNormalMethod(vtkLacunaDepthMapShader::Predicate);
  shader->SetSpecular(0);
  shader->Update();
  vtkPointData* data = shader->GetOutput()->GetPointData();
  for (int i = 0; i < columns * rows; ++i)
  {
    for (int a = 0; a < 3; ++a)
    {
      LACUNA_CHECK_NEAR(data->GetArray("Normals")->GetComponent(i, a), normal[a], 2e-7);
    }
    // the light is in the eye
    const lacuna::Vec3 ray = contract.GetRay(i % columns, i / columns);
    LACUNA_CHECK_NEAR(
      data->GetScalars()->GetComponent(i, 0), 255 * (0.1 - 0.7 * lacuna::Dot(ray, normal)), 0.51);
  }
}

void TestSurfaceCarriesColors()
{
  Pipeline p;
  p.Shader->SetNormalMethod(vtkLacunaDepthMapShader::Gordon);
  vtkNew<vtkLacunaDepthMapSurface> surface;
  surface->SetInputConnection(p.Shader->GetOutputPort());
  surface->ComputeNormalDifferenceOn();
  surface->Update();
  vtkPointData* data = surface->GetOutput()->GetPointData();
  LACUNA_CHECK(data->GetScalars() && std::string(data->GetScalars()->GetName()) == "Color" &&
    data->GetScalars()->GetDataType() == VTK_UNSIGNED_CHAR);
  LACUNA_CHECK(data->GetNormals() && std::string(data->GetNormals()->GetName()) == "Normals");
  vtkPointData* pixels = p.Shader->GetOutput()->GetPointData();
  vtkDataArray* ids = data->GetArray("PixelId");
  for (vtkIdType i = 0; i < surface->GetOutput()->GetNumberOfPoints(); ++i)
  {
    const auto pixel = static_cast<vtkIdType>(ids->GetTuple1(i));
    LACUNA_CHECK(
      data->GetScalars()->GetComponent(i, 2) == pixels->GetScalars()->GetComponent(pixel, 2));
    LACUNA_CHECK(
      data->GetNormals()->GetComponent(i, 0) == pixels->GetNormals()->GetComponent(pixel, 0));
  }
}
}

int TestDepthMapShader(int, char*[])
{
  TestPicture();
  TestMethodsAreTheKernels();
  TestDepthCue();
  TestShadows();
  TestCutAway();
  TestPieces();
  TestPerspective();
  TestSurfaceCarriesColors();
  return lacunaCheck::Result();
}
