// SPDX-License-Identifier: BSD-3-Clause
// Regions whose numbers make none are refused, and the number at fault is named.
#include "lacunaCheck.h"
#include "lacunaImplicitRegion.h"
#include "vtkBox.h"
#include "vtkCylinder.h"
#include "vtkImplicitBoolean.h"
#include "vtkNew.h"
#include "vtkPlane.h"
#include "vtkSphere.h"
#include "vtkTransform.h"

#include <cmath>

int TestRegion(int, char*[])
{
  using lacuna::ImplicitRegion::Check;
  const double nan = std::nan("");
  Check(nullptr, "Region");

  vtkNew<vtkSphere> sphere;
  sphere->SetCenter(1, -2, 3);
  Check(sphere, "Region");
  sphere->SetRadius(-39); // the same to VTK as 39
  LACUNA_CHECK_THROWS(
    Check(sphere, "Region"), "Region: of the sphere Radius is -39; give more than 0 mm");
  for (const double radius : { 0.0, nan, HUGE_VAL })
  {
    sphere->SetRadius(radius);
    LACUNA_CHECK_THROWS(Check(sphere, "Region"), "of the sphere Radius is ");
  }
  sphere->SetRadius(1e-3);
  Check(sphere, "Region");

  vtkNew<vtkImplicitBoolean> both;
  both->AddFunction(sphere);
  Check(both, "Region");
  sphere->SetCenter(1, nan, 3);
  LACUNA_CHECK_THROWS(Check(both, "Region"), "of the sphere Center is 1,nan,3");

  vtkNew<vtkCylinder> cylinder;
  Check(cylinder, "Region");
  cylinder->SetRadius(-0.5);
  LACUNA_CHECK_THROWS(Check(cylinder, "Region"), "of the cylinder Radius is -0.5");
  cylinder->SetRadius(0.5);
  cylinder->SetCenter(0, 0, HUGE_VAL);
  LACUNA_CHECK_THROWS(Check(cylinder, "Region"), "of the cylinder Center is 0,0,inf");

  vtkNew<vtkPlane> plane;
  Check(plane, "Region");
  plane->SetNormal(0, 0, 0);
  LACUNA_CHECK_THROWS(Check(plane, "Region"), "of the plane Normal is 0,0,0; give a direction");
  plane->SetNormal(0, 0, -2);
  Check(plane, "Region");
  plane->SetOrigin(nan, 0, 0);
  LACUNA_CHECK_THROWS(Check(plane, "Region"), "of the plane Origin is nan,0,0");

  vtkNew<vtkBox> box;
  box->SetBounds(-1, 1, -2, 2, -3, 3);
  Check(box, "Region");
  box->SetBounds(-1, 1, -2, 2, -3, HUGE_VAL);
  LACUNA_CHECK_THROWS(Check(box, "Region"), "of the box Bounds is -1,1,-2,2,-3,inf");

  // ParaView's box and cylinder are placed by a transform
  box->SetBounds(-1, 1, -2, 2, -3, 3);
  vtkNew<vtkTransform> transform;
  box->SetTransform(transform);
  transform->Scale(2, -1, 1);
  Check(box, "Region");
  transform->Scale(1, 0, 1);
  LACUNA_CHECK_THROWS(Check(box, "Region"), "of the region Transform is 2,0,0,0,0,");
  transform->Identity();
  transform->Translate(nan, 0, 0);
  LACUNA_CHECK_THROWS(Check(box, "Region"), "of the region Transform is 1,0,0,nan");
  return 0;
}
