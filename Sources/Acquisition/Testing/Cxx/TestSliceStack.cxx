// SPDX-License-Identifier: BSD-3-Clause
// Slices of which the video says another size of pixels than the calibration are flagged.
#include "lacunaCheck.h"
#include "lacunaGrowingStack.h"
#include "lacunaTrackedSlices.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkNew.h"

#include <memory>
#include <optional>
#include <vector>

namespace
{
lacuna::AcquiredSlice MakeSlice(int number, const std::optional<lacuna::Vec2>& spacing)
{
  lacuna::AcquiredSlice slice;
  slice.Pixels = std::make_shared<std::vector<std::uint8_t>>(6, static_cast<std::uint8_t>(number));
  slice.FrameNumber = number;
  slice.Timestamp = 0.1 * number;
  slice.ProbeToTracker = lacuna::Matrix4::Translation({ 0, 0, 2. * number });
  slice.PixelSpacing = spacing;
  return slice;
}

lacuna::SweepFrame MakeFrame(double column, double row)
{
  lacuna::SweepFrame frame;
  frame.Window = { 4, 5, 3, 2 };
  frame.Calibrated = true;
  frame.ImageToProbe = lacuna::Matrix4::Scaling({ column, row, 1 });
  return frame;
}

// One flag for each slice; a flagged one has no pose, any other has its own.
void Check(const lacuna::GrowingStack& stack, const std::vector<int>& flags, double column)
{
  vtkNew<vtkImageData> output;
  stack.Fill(output);
  const lacuna::TrackedSlices slices(output);
  LACUNA_CHECK(slices.GetNumberOfSlices() == static_cast<vtkIdType>(flags.size()));
  for (vtkIdType i = 0; i < slices.GetNumberOfSlices(); ++i)
  {
    const int flag = flags[static_cast<std::size_t>(i)];
    LACUNA_CHECK(slices.GetStatus(i) == flag);
    const lacuna::Matrix4 pose = slices.GetImageToReference(i);
    LACUNA_CHECK(pose.IsFinite() == ((flag & lacuna::TrackedSlices::PoseInvalid) == 0));
    if (pose.IsFinite())
    {
      LACUNA_CHECK(pose.Point({ 10, 0, 0 })[0] == 10 * column);
      LACUNA_CHECK(pose.Point({ 0, 0, 0 })[2] == 2. * static_cast<double>(i));
    }
  }
}
}

int TestSliceStack(int, char*[])
{
  lacuna::GrowingStack stack(MakeFrame(0.25, 0.5), 0);
  stack.Append(MakeSlice(0, std::nullopt));
  vtkNew<vtkImageData> silent;
  stack.Fill(silent);
  LACUNA_CHECK(!silent->GetFieldData()->HasArray("ElementSpacing"));
  stack.Append(MakeSlice(1, lacuna::Vec2{ 0.25, 0.5 }));
  stack.Append(MakeSlice(2, lacuna::Vec2{ 0.5, 1 }));
  lacuna::AcquiredSlice fast = MakeSlice(3, lacuna::Vec2{ 0.25, 1 });
  fast.Status = lacuna::TrackedSlices::TooFast;
  stack.Append(fast);
  stack.Append(MakeSlice(4, lacuna::Vec2{ 0, 0.5 })); // which cannot be, and says nothing
  Check(stack, { 0, 0, 1, 5, 0 }, 0.25);
  vtkNew<vtkImageData> before;
  stack.Fill(before);

  // calibrated anew, for the other depth: now the others are wrong
  stack.Calibrate(MakeFrame(0.5, 1));
  Check(stack, { 0, 1, 0, 5, 0 }, 0.5);
  stack.Append(MakeSlice(5, lacuna::Vec2{ 0.5, 1 }));
  Check(stack, { 0, 1, 0, 5, 0, 0 }, 0.5);
  // an output that was made keeps what it showed
  LACUNA_CHECK(lacuna::TrackedSlices(before).GetStatus(2) == lacuna::TrackedSlices::PoseInvalid);

  vtkNew<vtkImageData> output;
  stack.Fill(output);
  vtkDataArray* said = output->GetFieldData()->GetArray("ElementSpacing");
  LACUNA_CHECK(said && said->GetNumberOfTuples() == 6 && said->GetNumberOfComponents() == 2);
  LACUNA_CHECK(said && said->GetComponent(3, 1) == 1);

  lacuna::SweepFrame uncalibrated;
  uncalibrated.Window = { 4, 5, 3, 2 };
  stack.Calibrate(uncalibrated);
  stack.Fill(output);
  for (int i = 0; i < 6; ++i)
  {
    LACUNA_CHECK(output->GetFieldData()->GetArray("SliceStatus")->GetTuple1(i) == (i == 3 ? 4 : 0));
  }
  return lacunaCheck::Result();
}
