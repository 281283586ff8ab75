// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaPoseJudge.h"

#include "lacunaFieldData.h"
#include "lacunaGeometryGate.h"
#include "lacunaPoseOutliers.h"
#include "lacunaTrackedSlices.h"
#include "vtkDataArray.h"
#include "vtkImageData.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

//------------------------------------------------------------------------------
std::vector<std::string> lacuna::PoseJudge::FindUnusable(const std::vector<Slice>& slices)
{
  std::vector<std::string> problems(slices.size());
  for (std::size_t i = 0; i < slices.size(); ++i)
  {
    const lacuna::SliceImage& slice = *slices[i].Image;
    for (const lacuna::Vec3& corner : lacuna::GetCorners(slice))
    {
      for (const double x : corner.Elements)
      {
        if (slice.PixelToReference.IsFinite() && !(std::abs(x) <= LargestCoordinate))
        {
          std::ostringstream text;
          text << slice.Label << ": its pose puts a corner at " << x << " mm, beyond all measure";
          problems[i] = text.str();
        }
      }
    }
    try
    {
      if (problems[i].empty())
      {
        lacuna::CheckSlice(slice);
      }
    }
    catch (const std::invalid_argument& error)
    {
      problems[i] = error.what();
      problems[i].resize(
        std::min(problems[i].size(), problems[i].find(';'))); // there follows advice
    }
    const lacuna::GeometryFinding finding = lacuna::CheckImage(*slices[i].ImageToReference);
    if (problems[i].empty() &&
      lacuna::GetAction(lacuna::GeometryOrigin::Slices, finding.Fault) ==
        lacuna::GeometryAction::Refuse)
    {
      problems[i] = slice.Label + ": its pose " + finding.Text;
    }
  }
  return problems;
}

//------------------------------------------------------------------------------
void lacuna::PoseJudge::AddOutliers(
  const std::vector<Slice>& slices, std::vector<std::string>& problems)
{
  std::vector<lacuna::SlicePlace> places;
  std::vector<std::size_t> usable;
  for (std::size_t i = 0; i < slices.size(); ++i)
  {
    if (problems[i].empty())
    {
      places.push_back({ slices[i].Number, lacuna::GetCorners(*slices[i].Image) });
      usable.push_back(i);
    }
  }
  const lacuna::PoseOutliers found = lacuna::FindPoseOutliers(places);
  for (const lacuna::PoseOutliers::Outlier& outlier : found.Outliers)
  {
    const std::size_t i = usable[outlier.Index];
    std::ostringstream text;
    text << slices[i].Image->Label << ": its pose is an outlier, it lies " << outlier.Distance
         << " mm from the slices beside it; the median step of the sweep is " << found.MedianStep
         << " mm, more than " << found.LongestStep << " mm is a jump";
    problems[i] = text.str();
  }
}

//------------------------------------------------------------------------------
lacuna::PoseJudge::Sweep lacuna::PoseJudge::JudgeSweep(
  vtkImageData* stack, const lacuna::TrackedSlices& tracked, const int whole[6], bool keepOutliers)
{
  const vtkIdType count = tracked.GetNumberOfSlices();
  vtkDataArray* frames =
    lacuna::FieldData::Find(stack, lacuna::TrackedSlices::FrameNumberName, 1, count);
  const double* origin = stack->GetOrigin();
  const double* spacing = stack->GetSpacing();
  const lacuna::Matrix4 pixelToImage =
    lacuna::Matrix4::Translation(
      { origin[0] + spacing[0] * whole[0], origin[1] + spacing[1] * whole[2], 0 }) *
    lacuna::Matrix4::Scaling({ spacing[0], spacing[1], 1 });
  std::vector<lacuna::SliceImage> images;
  std::vector<Slice> slices;
  images.reserve(static_cast<std::size_t>(count)); // slices refer to them
  for (vtkIdType i = 0; i < count; ++i)
  {
    if (!(tracked.GetStatus(i) & lacuna::TrackedSlices::PoseInvalid))
    {
      lacuna::SliceImage image;
      image.Width = std::max(2, whole[1] - whole[0] + 1); // poses may come without pictures
      image.Height = std::max(2, whole[3] - whole[2] + 1);
      image.PixelToReference = tracked.GetImageToReference(i) * pixelToImage;
      image.Label = MakeLabel(i, frames, "");
      images.push_back(image);
      slices.push_back({ i, &images.back(), &tracked.GetImageToReference(i) });
    }
  }
  std::vector<std::string> problems = FindUnusable(slices);
  if (!keepOutliers)
  {
    AddOutliers(slices, problems);
  }
  Sweep sweep;
  sweep.HasPose.assign(static_cast<std::size_t>(count), 0);
  sweep.Problems.resize(static_cast<std::size_t>(count));
  for (std::size_t s = 0; s < slices.size(); ++s)
  {
    sweep.HasPose[slices[s].Number] = problems[s].empty() ? 1 : 0;
    sweep.Problems[slices[s].Number] = problems[s];
  }
  return sweep;
}

//------------------------------------------------------------------------------
std::string lacuna::PoseJudge::MakeLabel(
  vtkIdType number, vtkDataArray* frames, const std::string& suffix)
{
  std::ostringstream label;
  label << "slice " << number;
  if (frames && frames->GetTuple1(number) != static_cast<double>(number))
  {
    label << " (frame " << frames->GetTuple1(number) << ")";
  }
  label << suffix;
  return label.str();
}
