// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaCheck.h"
#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkImageShrink3D.h"
#include "vtkLacunaProvenance.h"
#include "vtkNew.h"
#include "vtkPointData.h"

int TestProvenance(int, char*[])
{
  vtkNew<vtkImageData> a;
  a->SetDimensions(3, 3, 3);
  a->AllocateScalars(VTK_UNSIGNED_CHAR, 1); // 27 bytes: whole words and a rest
  a->GetPointData()->GetScalars()->Fill(1);
  vtkNew<vtkImageData> b;
  vtkNew<vtkImageShrink3D> step;
  vtkLacunaProvenance::Record(b, step, { a }, "Factor=2");
  const std::vector<std::string> first = vtkLacunaProvenance::Get(b);
  LACUNA_CHECK(first.size() == 1);
  LACUNA_CHECK(first[0].find(vtkLacunaProvenance::GetVersion()) != std::string::npos);
  LACUNA_CHECK(first[0].find("vtkImageShrink3D") != std::string::npos);
  LACUNA_CHECK(first[0].find("Factor=2") != std::string::npos);

  // the last byte counts
  a->GetPointData()->GetScalars()->SetComponent(26, 0, 2);
  vtkNew<vtkImageData> other;
  vtkLacunaProvenance::Record(other, step, { a }, "Factor=2");
  LACUNA_CHECK(vtkLacunaProvenance::Get(other) != first);

  // the steps of all inputs, each once
  vtkNew<vtkImageData> c;
  vtkLacunaProvenance::Record(c, step, { b, b, other }, "");
  const std::vector<std::string> chain = vtkLacunaProvenance::Get(c);
  LACUNA_CHECK(chain.size() == 3);
  LACUNA_CHECK(chain[0] == first[0]);
  return lacunaCheck::Result();
}
