// SPDX-License-Identifier: BSD-3-Clause
// When a filter may keep what it has made.
#include "lacunaCheck.h"
#include "vtkImageData.h"
#include "vtkImageThreshold.h"
#include "vtkInformation.h"
#include "vtkLacunaRequest.h"
#include "vtkNew.h"
#include "vtkTrivialProducer.h"

int TestRequest(int, char*[])
{
  vtkNew<vtkImageData> image;
  image->SetDimensions(8, 6, 4);
  image->AllocateScalars(VTK_FLOAT, 1);
  vtkNew<vtkTrivialProducer> source;
  source->SetOutput(image);
  vtkNew<vtkImageThreshold> upstream; // makes the part it is asked for
  upstream->SetInputConnection(source->GetOutputPort());
  vtkNew<vtkImageThreshold> filter;
  filter->SetInputConnection(upstream->GetOutputPort());
  filter->Update();
  const auto getTimes = [&]
  { return vtkLacunaRequest::GetTimes(filter, filter->GetInputInformation()); };
  const std::vector<double> times = getTimes();

  const vtkMTimeType made = upstream->GetOutput()->GetMTime();
  upstream->GetOutput()->ReleaseData();
  const int part[6] = { 2, 4, 1, 3, 0, 0 };
  upstream->UpdateExtent(part);
  LACUNA_CHECK(upstream->GetOutput()->GetMTime() > made);
  LACUNA_CHECK(getTimes() == times);

  filter->SetOutValue(2);
  filter->Update();
  LACUNA_CHECK(getTimes() != times);
  const std::vector<double> again = getTimes();
  upstream->SetOutValue(3);
  filter->Update();
  LACUNA_CHECK(getTimes() != again);

  const std::vector<double> changed = getTimes();
  image->Modified();
  filter->Update();
  LACUNA_CHECK(getTimes() != changed);
  const std::vector<double> later = getTimes();
  image->GetInformation()->Set(vtkDataObject::DATA_TIME_STEP(), 2.5);
  upstream->GetOutput()->GetInformation()->Set(vtkDataObject::DATA_TIME_STEP(), 2.5);
  LACUNA_CHECK(getTimes() != later);
  return lacunaCheck::Result();
}
