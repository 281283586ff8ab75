// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaCheck.h"
#include "lacunaGrowingStack.h"
#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkNew.h"

#include <memory>
#include <vector>

namespace
{
bool HasNumbers(vtkDataArray* view, vtkIdType count)
{
  bool right = view->GetNumberOfTuples() == count && view->GetNumberOfComponents() == 2;
  for (vtkIdType i = 0; right && i < count; ++i)
  {
    right = view->GetComponent(i, 0) == i && view->GetComponent(i, 1) == -i;
  }
  return right;
}

void Append(lacuna::GrowingArray& array, vtkIdType i)
{
  const double tuple[2] = { static_cast<double>(i), static_cast<double>(-i) };
  array.Append(tuple);
}
}

int TestGrowingArray(int, char*[])
{
  std::vector<vtkSmartPointer<vtkDataArray>> views;
  vtkNew<vtkDoubleArray> shallow;
  vtkNew<vtkDoubleArray> deep;
  {
    lacuna::GrowingArray array("Numbers", VTK_DOUBLE, 2);
    LACUNA_CHECK(array.MakeView()->GetNumberOfTuples() == 0);
    for (vtkIdType i = 0; i < 1000; ++i)
    {
      Append(array, i);
      views.push_back(array.MakeView());
    }
    LACUNA_CHECK(static_cast<const double*>(array.GetTuple(7))[1] == -7);
    shallow->ShallowCopy(views[500]);
    deep->DeepCopy(views[501]);
    // without reserve its memory has moved; with it, it does not
    LACUNA_CHECK(views[0]->GetVoidPointer(0) != views[999]->GetVoidPointer(0));
    lacuna::GrowingArray reserved("Numbers", VTK_DOUBLE, 2);
    reserved.Reserve(vtkIdType{ 1 } << 22); // 64 MiB, which are not touched
    Append(reserved, 0);
    const auto first = reserved.MakeView();
    Append(reserved, 1);
    LACUNA_CHECK(first->GetVoidPointer(0) == reserved.MakeView()->GetVoidPointer(0));
    LACUNA_CHECK(first->GetNumberOfTuples() == 1);
    LACUNA_CHECK(std::string(first->GetName()) == "Numbers");
  }
  // the views keep what they show
  for (std::size_t i = 0; i < views.size(); ++i)
  {
    LACUNA_CHECK(HasNumbers(views[i], static_cast<vtkIdType>(i) + 1));
  }
  // who changes a view's size gets memory of its own
  views[999]->InsertNextTuple2(1000, -1000);
  LACUNA_CHECK(HasNumbers(views[999], 1001));
  LACUNA_CHECK(HasNumbers(views[998], 999));
  views.clear();
  LACUNA_CHECK(HasNumbers(shallow, 501));
  LACUNA_CHECK(HasNumbers(deep, 502));
  return lacunaCheck::Result();
}
