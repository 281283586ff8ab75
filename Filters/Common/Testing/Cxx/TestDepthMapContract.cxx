// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaCheck.h"
#include "lacunaDepthMap.h"
#include "lacunaFieldData.h"
#include "vtkDoubleArray.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPointData.h"

namespace
{
// Seen from the front left: no axis of the map is an axis of the world.
void Make(vtkImageData* map)
{
  map->SetExtent(2, 5, 3, 7, 0, 0); // a cropped map keeps its geometry
  vtkNew<vtkDoubleArray> depth;
  depth->SetName(lacuna::DepthMap::DepthName);
  depth->SetNumberOfTuples(map->GetNumberOfPoints());
  depth->Fill(10);
  map->GetPointData()->SetScalars(depth);
  lacuna::DepthMap::Geometry g;
  g.Origin = { 100, -20, 3 };
  g.Right = { 0.6, 0.8, 0 };
  g.Down = { 0, 0, -1 };
  g.View = { -0.8, 0.6, 0 };
  g.PixelSpacing = { 0.5, 0.25 };
  lacuna::DepthMap::SetGeometry(map, g);
}
}

int TestDepthMapContract(int, char*[])
{
  {
    vtkNew<vtkImageData> map;
    Make(map);
    const lacuna::DepthMap contract(map);
    LACUNA_CHECK(!contract.IsPerspective());
    // by hand: origin + 2 columns of 0.5 mm right + 4 rows of 0.25 mm down + 10 mm along the view
    const lacuna::Vec3 p = contract.GetPoint(2, 4, 10);
    LACUNA_CHECK_NEAR(p[0], 100 + 0.6 - 8, 1e-12);
    LACUNA_CHECK_NEAR(p[1], -20 + 0.8 + 6, 1e-12);
    LACUNA_CHECK_NEAR(p[2], 3 - 1, 1e-12);
    LACUNA_CHECK_NEAR(contract.GetPixelSpacing()[0], 0.5, 1e-12);
    LACUNA_CHECK_NEAR(contract.GetPixelSpacing()[1], 0.25, 1e-12);
    // VTK agrees about where a pixel lies
    double q[3];
    map->TransformIndexToPhysicalPoint(2, 4, 0, q);
    const lacuna::Vec3 pixel = contract.GetPoint(2, 4, 0);
    for (int i = 0; i < 3; ++i)
    {
      LACUNA_CHECK_NEAR(q[i], pixel[i], 1e-12);
    }
  }
  {
    // perspective: rays run from the eye through the pixels
    vtkNew<vtkImageData> map;
    Make(map);
    lacuna::FieldData::Set(map, lacuna::DepthMap::EyePositionName, { 100, -20, 103 }, 3);
    const lacuna::DepthMap contract(map);
    LACUNA_CHECK(contract.IsPerspective());
    LACUNA_CHECK_NEAR(contract.GetEye()[2], 103, 0);
    const lacuna::Vec3 ray = contract.GetRay(0, 0);
    LACUNA_CHECK_NEAR(ray[2], -1, 1e-12);
    LACUNA_CHECK_NEAR(contract.GetPoint(0, 0, 7)[2], -4, 1e-12);
  }
  {
    vtkNew<vtkImageData> map;
    Make(map);
    map->SetDirectionMatrix(1, 0, 0, 0, 1, 0, 0, 0, 1); // what vtkImageMedian3D does
    LACUNA_CHECK_THROWS(lacuna::DepthMap contract(map), "disagrees");
  }
  {
    vtkNew<vtkImageData> map;
    Make(map);
    map->GetPointData()->RemoveArray(lacuna::DepthMap::DepthName);
    LACUNA_CHECK_THROWS(lacuna::DepthMap contract(map), "'Depth'");
  }
  {
    vtkNew<vtkImageData> map;
    Make(map);
    lacuna::FieldData::Set(map, lacuna::DepthMap::ImageToWorldName, { 1, 2, 3 }, 3);
    LACUNA_CHECK_THROWS(lacuna::DepthMap contract(map), "expected 1 tuples of 16");
  }
  {
    vtkNew<vtkImageData> volume;
    volume->SetDimensions(3, 3, 2);
    LACUNA_CHECK_THROWS(lacuna::DepthMap contract(volume), "2 layers");
  }
  LACUNA_CHECK(lacuna::DepthMap::GetNormalsName("Depth") == "Normals");
  LACUNA_CHECK(lacuna::DepthMap::GetNormalsName("Depth_2") == "Normals_2");
  LACUNA_CHECK(lacuna::DepthMap::GetNormalsName("Fitted") == "FittedNormals");
  return lacunaCheck::Result();
}
