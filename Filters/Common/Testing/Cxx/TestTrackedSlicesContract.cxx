// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaCheck.h"
#include "lacunaTrackedSlices.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkNew.h"

namespace
{
void Make(vtkImageData* stack)
{
  stack->SetDimensions(4, 3, 2);
  stack->SetOrigin(0, 0, 1); // slices 1 and 2 of a sweep of four
  stack->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
  std::vector<lacuna::Matrix4> poses;
  for (int i = 0; i < 4; ++i)
  {
    poses.push_back(lacuna::Matrix4::Translation({ 0, 0, 0.5 * i }));
  }
  lacuna::TrackedSlices::Write(stack, poses, { 0, 0.04, 0.08, 0.12 },
    { lacuna::TrackedSlices::Valid, lacuna::TrackedSlices::TooFast, 0, 0 }, { 10, 11, 12, 13 });
}
}

int TestTrackedSlicesContract(int, char*[])
{
  {
    vtkNew<vtkImageData> stack;
    Make(stack);
    const lacuna::TrackedSlices slices(stack);
    LACUNA_CHECK(slices.GetNumberOfSlices() == 4);
    LACUNA_CHECK(slices.GetSliceNumber(0) == 1);
    LACUNA_CHECK(slices.GetSliceNumber(1) == 2);
    LACUNA_CHECK_THROWS(slices.GetSliceNumber(3), "z = 4");
    LACUNA_CHECK(slices.GetStatus(1) == lacuna::TrackedSlices::TooFast);
    LACUNA_CHECK(slices.IsUsable(0) && !slices.IsUsable(1));
    LACUNA_CHECK(slices.IsUsable(1, lacuna::TrackedSlices::TooFast));
    LACUNA_CHECK(!slices.IsUsable(1, lacuna::TrackedSlices::GatedOut));
    LACUNA_CHECK_NEAR(slices.GetTimestamp(2), 0.08, 0);
    LACUNA_CHECK_NEAR(slices.GetImageToReference(3)(2, 3), 1.5, 0);
  }
  {
    vtkNew<vtkImageData> stack;
    Make(stack);
    vtkDataArray* status = stack->GetFieldData()->GetArray(lacuna::TrackedSlices::SliceStatusName);
    status->SetTuple1(1, lacuna::TrackedSlices::TooFast | lacuna::TrackedSlices::GatedOut);
    status->SetTuple1(2, lacuna::TrackedSlices::PoseInvalid | lacuna::TrackedSlices::TooFast);
    const lacuna::TrackedSlices slices(stack);
    LACUNA_CHECK(!slices.IsUsable(1, lacuna::TrackedSlices::TooFast));
    LACUNA_CHECK(
      slices.IsUsable(1, lacuna::TrackedSlices::TooFast | lacuna::TrackedSlices::GatedOut));
    LACUNA_CHECK(!slices.IsUsable(2, 0xff)); // without a pose there is no place
  }
  {
    vtkNew<vtkImageData> stack;
    Make(stack);
    stack->GetFieldData()->RemoveArray(lacuna::TrackedSlices::ImageToReferenceName);
    LACUNA_CHECK_THROWS(lacuna::TrackedSlices slices(stack), "not calibrated");
  }
  {
    vtkNew<vtkImageData> stack;
    Make(stack);
    stack->GetFieldData()->RemoveArray(lacuna::TrackedSlices::SliceStatusName);
    LACUNA_CHECK_THROWS(lacuna::TrackedSlices slices(stack), "'SliceStatus' is missing");
  }
  {
    vtkNew<vtkImageData> stack;
    Make(stack);
    stack->GetFieldData()->GetArray(lacuna::TrackedSlices::TimestampName)->Resize(3);
    LACUNA_CHECK_THROWS(lacuna::TrackedSlices slices(stack), "3 tuples");
  }
  {
    vtkNew<vtkImageData> stack;
    Make(stack);
    stack->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
    LACUNA_CHECK_THROWS(lacuna::TrackedSlices slices(stack), "3 components");
  }
  return lacunaCheck::Result();
}
