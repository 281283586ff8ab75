// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaCheck.h"
#include "lacunaProvenance.h"
#include "vtkDataArray.h"
#include "vtkExecutive.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkLacunaIncompleteShape.h"
#include "vtkNew.h"
#include "vtkPointData.h"

#include <cmath>
#include <sstream>
#include <string>

int TestIncompleteShape(int, char*[])
{
  vtkNew<vtkLacunaIncompleteShape> source;
  source->SetShape(vtkLacunaIncompleteShape::Sphere);
  source->SetDimensions(61, 64, 67);
  source->SetPresentFraction(0.5);
  source->Update();
  vtkNew<vtkImageData> whole;
  whole->DeepCopy(source->GetOutput());
  LACUNA_CHECK(whole->GetDimensions()[2] == 67 && whole->GetOrigin()[0] == -30);
  LACUNA_CHECK_NEAR(whole->GetFieldData()->GetArray("CompleteVolume")->GetComponent(0, 0),
    4 * M_PI / 3 * 18 * 18 * 18 / 1000, 1e-9);
  LACUNA_CHECK(lacuna::Provenance::Get(whole).size() == 1 &&
    lacuna::Provenance::Get(whole)[0].find(" Shape=Sphere Dimensions=61,64,67 ") !=
      std::string::npos);
  vtkDataArray* data = whole->GetPointData()->GetArray("Data");
  int present = 0;
  for (vtkIdType i = 0; i < whole->GetNumberOfPoints(); ++i)
  {
    if (data->GetComponent(i, 0) != 0)
    {
      double x[3];
      whole->GetPoint(i, x);
      LACUNA_CHECK(std::abs(source->EvaluateDistance(x[0], x[1], x[2])) <= 0.5);
      ++present;
    }
  }
  LACUNA_CHECK_NEAR(present, 0.5 * 4 * M_PI * 18 * 18, 60);

  // a piece is a part of the whole
  const int extent[6] = { 3, 30, 10, 50, 33, 60 };
  source->Modified();
  source->UpdateExtent(extent);
  vtkImageData* part = source->GetOutput();
  LACUNA_CHECK(part->GetExtent()[0] == 3 && part->GetExtent()[5] == 60);
  for (int k = 33; k <= 60; ++k)
  {
    for (int j = 10; j <= 50; ++j)
    {
      LACUNA_CHECK(part->GetScalarComponentAsDouble(13, j, k, 0) ==
        whole->GetScalarComponentAsDouble(13, j, k, 0));
    }
  }

  // curves are flat
  vtkNew<vtkLacunaIncompleteShape> curve;
  curve->SetGapAngle(40);
  curve->Update();
  LACUNA_CHECK(curve->GetOutput()->GetDimensions()[2] == 1);

  vtkNew<lacunaCheck::Messages> messages;
  messages->Watch(curve);
  messages->Watch(curve->GetExecutive());
  curve->SetPresentFraction(0);
  curve->Update();
  LACUNA_CHECK(messages->HasError("PresentFraction is 0"));
  LACUNA_CHECK(std::isnan(curve->EvaluateDistance(0, 0, 0)));
  curve->SetPresentFraction(1);
  curve->SetShape(6);
  curve->Update();
  LACUNA_CHECK(messages->HasError("Shape is 6; it must be 0 (Circle), 1 (Cavity)"));
  std::ostringstream text;
  curve->Print(text);
  LACUNA_CHECK(text.str().find("GapAngle: 40 (from 0 to 360 degrees)") != std::string::npos);
  return lacunaCheck::Result();
}
