// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// How filters of depth maps refuse what they cannot use.
#ifndef TestRefusals_h
#define TestRefusals_h

#include "lacunaCheck.h"
#include "vtkImageData.h"
#include "vtkNew.h"

#include <functional>
#include <string>

/// With a property changed the filter gives an error with these words, and nothing else.
template <class Filter>
void CheckRefusal(
  vtkImageData* map, const std::string& words, const std::function<void(Filter*)>& change)
{
  vtkNew<Filter> filter;
  vtkNew<lacunaCheck::Messages> messages;
  messages->Watch(filter);
  messages->Watch(filter->GetExecutive());
  filter->SetInputData(map);
  change(filter);
  filter->Update();
  LACUNA_CHECK_THAT(messages->HasError(words), "an error with '" + words + "'");
  LACUNA_CHECK(filter->GetOutput()->GetNumberOfPoints() == 0);
}
#endif
