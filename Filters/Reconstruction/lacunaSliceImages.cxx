// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSliceImages.h"

#include "lacunaArrayScalarType.h"
#include "lacunaArrays.h"
#include "lacunaExecution.h"
#include "lacunaFieldData.h"
#include "lacunaPoseJudge.h"
#include "lacunaTrackedSlices.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkLacunaSliceAlgorithm.h"
#include "vtkLacunaSliceStream.h"
#include "vtkMatrix3x3.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkStringArray.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <limits>
#include <numeric>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace
{
// Pixels of an axis that are used: indices relative to the stack's extent.
struct Range
{
  int First, Last;
};

// Cuts one axis of a stack to a part of the clip rectangle; size 0 reaches to the edge. extent: of
// that axis.
Range Clip(const int extent[2], double origin, double spacing, int axis, int start, int size)
{
  Range range{ extent[0], extent[1] };
  const double first = origin + spacing * range.First;
  const double last = origin + spacing * range.Last;
  // compared as numbers of columns or rows: far-off requests do not overflow
  const double wantedLast = size > 0 ? start + static_cast<double>(size) - 1 : last;
  range.First = start > last ? range.Last + 1
    : start > first          ? static_cast<int>(std::ceil((start - origin) / spacing - 1e-6))
                             : range.First;
  range.Last = wantedLast < first ? range.First - 1
    : wantedLast < last ? static_cast<int>(std::floor((wantedLast - origin) / spacing + 1e-6))
                        : range.Last;
  if (range.Last - range.First + 1 < 2)
  {
    std::ostringstream message;
    message << "ClipRectangle leaves " << std::max(0, range.Last - range.First + 1)
            << (axis == 0 ? " columns" : " rows") << " of " << first << " to " << last
            << "; at least 2 are needed";
    throw std::runtime_error(message.str());
  }
  return range;
}

void CheckStack(vtkImageData* stack)
{
  if (!stack->GetDirectionMatrix()->IsIdentity())
  {
    throw std::runtime_error(
      "the stack of slices has a direction matrix; the coordinates of tracked slices are (column, "
      "row, slice), where they lie in space is in the field data array 'ImageToReference'");
  }
  for (int a = 0; a < 3; ++a)
  {
    if (!(stack->GetSpacing()[a] > 0))
    {
      throw std::runtime_error("the stack of slices has a spacing that is not positive; the "
                               "coordinates of tracked slices are (column, row, slice)");
    }
  }
}
}

//------------------------------------------------------------------------------
lacuna::SliceSelection lacuna::SliceSelection::Make(
  vtkLacunaSliceAlgorithm* filter, vtkInformation* input)
{
  using SDDP = vtkStreamingDemandDrivenPipeline;
  lacuna::SliceSelection selection;
  std::copy_n(filter->GetClipRectangle(), 4, selection.Clip.begin());
  selection.BadPoses = filter->GetBadPoses();
  selection.AcceptedFlags =
    (filter->GetUseImageInvalid() ? lacuna::TrackedSlices::ImageInvalid : 0) |
    (filter->GetUseTooFast() ? lacuna::TrackedSlices::TooFast : 0) |
    (filter->GetUseGatedOut() ? lacuna::TrackedSlices::GatedOut : 0);
  const int steps = input->Has(SDDP::TIME_STEPS()) ? input->Length(SDDP::TIME_STEPS()) : 0;
  selection.IsReplay = steps > 1;
  if (selection.IsReplay)
  {
    // without a time, a source shows all it has
    vtkInformation* data = vtkDataObject::GetData(input)->GetInformation();
    const double last = input->Get(SDDP::TIME_STEPS())[steps - 1];
    const double time = data->Has(vtkDataObject::DATA_TIME_STEP())
      ? data->Get(vtkDataObject::DATA_TIME_STEP())
      : input->Has(SDDP::UPDATE_TIME_STEP()) ? input->Get(SDDP::UPDATE_TIME_STEP())
                                             : last;
    selection.IsAtEnd = time >= last;
  }
  return selection;
}

// A slice of the sweep whose status is good enough.
struct lacuna::SliceImages::Candidate
{
  vtkIdType Number;
  int Layer; // index along z
  bool HasImage;
  bool IsGatedOut; // not taken, but its pose says where the probe was
  lacuna::SliceImage Slice;
};

//------------------------------------------------------------------------------
lacuna::SliceImages::SliceImages(
  vtkImageData* stack, const lacuna::SliceSelection& selection, vtkLacunaSliceStream* stream)
  : Stack(stack)
  , Stream(stream)
{
  std::copy_n(stream ? stream->GetExtent() : stack->GetExtent(), 6, this->Extent);
  std::copy_n(stream ? stream->GetOrigin() : stack->GetOrigin(), 3, this->Origin.begin());
  std::copy_n(stream ? stream->GetSpacing() : stack->GetSpacing(), 3, this->Spacing.begin());
  const lacuna::TrackedSlices tracked(stack);
  CheckStack(stack);
  this->GreyLevels = tracked.GetGreyLevels();
  if (!this->GreyLevels->HasStandardMemoryLayout())
  {
    this->GreyLevels.TakeReference(
      vtkDataArray::CreateDataArray(tracked.GetGreyLevels()->GetDataType()));
    lacuna::Arrays::Copy(tracked.GetGreyLevels(), this->GreyLevels);
  }
  std::vector<Candidate> candidates = this->FindCandidates(tracked, selection);
  const auto gated = std::stable_partition(candidates.begin(), candidates.end(),
    [](const Candidate& candidate) { return !candidate.IsGatedOut; });
  const std::vector<Candidate> gatedOut(gated, candidates.end());
  candidates.erase(gated, candidates.end());
  this->DropBadPoses(tracked, candidates, selection);
  this->FindSweeps(tracked, selection, gatedOut, candidates);
  for (const bool hasImage : { true, false })
  {
    for (const Candidate& candidate : candidates)
    {
      if (candidate.HasImage == hasImage)
      {
        (hasImage ? this->Slices : this->Others).push_back(candidate.Slice);
        if (hasImage)
        {
          this->Layers.push_back(candidate.Layer);
        }
        this->Poses.push_back(tracked.GetImageToReference(candidate.Number));
      }
    }
  }
}

//------------------------------------------------------------------------------
// By number in the sweep: the slices without an image at the end of the stack.
std::vector<bool> lacuna::SliceImages::FindSlicesToCome(const lacuna::TrackedSlices& tracked) const
{
  std::vector<bool> isToCome(tracked.GetNumberOfSlices(), false);
  const int* extent = this->Stack->GetExtent();
  for (int k = extent[5]; k >= extent[4]; --k)
  {
    const vtkIdType number = tracked.GetSliceNumber(k);
    if ((tracked.GetStatus(number) & lacuna::TrackedSlices::ImageInvalid) == 0)
    {
      break;
    }
    isToCome[number] = true;
  }
  return isToCome;
}

//------------------------------------------------------------------------------
// By number in the sweep: the layer of the stack, from 0 on; -1: it has none.
std::vector<std::int64_t> lacuna::SliceImages::FindLayers(vtkIdType slices) const
{
  std::vector<std::int64_t> layers(slices, -1);
  for (int k = this->Extent[4]; k <= this->Extent[5]; ++k)
  {
    const vtkIdType number =
      lacuna::TrackedSlices::GetSliceNumber(this->Origin[2] + this->Spacing[2] * k, slices);
    std::int64_t& layer = layers[number];
    if (layer >= 0)
    {
      throw std::runtime_error("the stack holds slice " + std::to_string(number) +
        " twice; its z spacing must be 1 or more");
    }
    layer = k - this->Extent[4];
  }
  return layers;
}

//------------------------------------------------------------------------------
// Cuts the window out of the first layer, which as yet has no place and no name.
lacuna::SliceImage lacuna::SliceImages::CutFirstLayer(const std::array<int, 4>& clip)
{
  const int* extent = this->Extent;
  const Range columns = Clip(extent, this->Origin[0], this->Spacing[0], 0, clip[0], clip[2]);
  const Range rows = Clip(extent + 2, this->Origin[1], this->Spacing[1], 1, clip[1], clip[3]);
  this->Window.Origin = { this->Origin[0] + this->Spacing[0] * columns.First,
    this->Origin[1] + this->Spacing[1] * rows.First };
  this->Window.Step = { this->Spacing[0], this->Spacing[1] };
  lacuna::SliceImage slice;
  slice.Type = lacuna::ArrayScalarType::Get(this->GreyLevels);
  slice.RowStride = extent[1] - extent[0] + 1;
  slice.Width = columns.Last - columns.First + 1;
  slice.Height = rows.Last - rows.First + 1;
  if (!this->Stream)
  {
    slice.Pixels = static_cast<const unsigned char*>(this->GreyLevels->GetVoidPointer(0)) +
      ((rows.First - extent[2]) * slice.RowStride + columns.First - extent[0]) *
        static_cast<std::int64_t>(lacuna::GetScalarSize(slice.Type));
  }
  return slice;
}

//------------------------------------------------------------------------------
std::vector<lacuna::SliceImages::Candidate> lacuna::SliceImages::FindCandidates(
  const lacuna::TrackedSlices& tracked, const lacuna::SliceSelection& selection)
{
  vtkImageData* const stack = this->Stack;
  const lacuna::SliceImage first = this->CutFirstLayer(selection.Clip);
  const std::int64_t layerBytes = first.RowStride * (this->Extent[3] - this->Extent[2] + 1) *
    static_cast<std::int64_t>(lacuna::GetScalarSize(first.Type));
  const lacuna::Matrix4 windowToImage = this->Window.GetMatrix();
  vtkDataArray* const frames = lacuna::FieldData::Find(
    stack, lacuna::TrackedSlices::FrameNumberName, 1, tracked.GetNumberOfSlices());
  const std::vector<std::int64_t> layers = this->FindLayers(tracked.GetNumberOfSlices());
  const auto orExpected = static_cast<unsigned char>(
    selection.AcceptedFlags | (selection.IsReplay ? lacuna::TrackedSlices::ImageInvalid : 0));
  std::vector<bool> isToCome(layers.size(), false);
  if (selection.IsReplay && !selection.IsAtEnd)
  {
    isToCome = this->FindSlicesToCome(tracked);
    this->IsMoreToCome = std::find(isToCome.begin(), isToCome.end(), true) != isToCome.end();
  }
  this->IsMoreToCome |= lacuna::TrackedSlices::IsGrowing(stack);
  std::vector<Candidate> candidates;
  for (vtkIdType number = 0; number < tracked.GetNumberOfSlices(); ++number)
  {
    const std::int64_t layer = layers[number];
    if (layer < 0)
    {
      continue; // not in the stack
    }
    const bool isUsable = tracked.IsUsable(number, selection.AcceptedFlags) && !isToCome[number];
    if (!isUsable)
    {
      this->Flags.Add(tracked.GetStatus(number));
    }
    const bool isCandidate = tracked.IsUsable(number, orExpected);
    const bool isGatedOut = !isCandidate &&
      tracked.IsUsable(number, selection.AcceptedFlags | lacuna::TrackedSlices::GatedOut);
    if (isCandidate || isGatedOut)
    {
      Candidate candidate;
      candidate.Number = number;
      candidate.Layer = static_cast<int>(layer) + this->Extent[4];
      candidate.HasImage = isUsable;
      candidate.IsGatedOut = isGatedOut;
      candidate.Slice = first;
      candidate.Slice.Pixels = isUsable && first.Pixels
        ? static_cast<const unsigned char*>(first.Pixels) + layer * layerBytes
        : nullptr;
      candidate.Slice.PixelToReference = tracked.GetImageToReference(number) * windowToImage;
      candidate.Slice.Label = lacuna::PoseJudge::MakeLabel(number, frames, selection.Suffix);
      candidates.push_back(candidate);
    }
  }
  return candidates;
}

//------------------------------------------------------------------------------
void lacuna::SliceImages::DropBadPoses(const lacuna::TrackedSlices& tracked,
  std::vector<Candidate>& candidates, const lacuna::SliceSelection& selection)
{
  std::vector<lacuna::PoseJudge::Slice> slices;
  slices.reserve(candidates.size());
  for (const Candidate& candidate : candidates)
  {
    slices.push_back(
      { candidate.Number, &candidate.Slice, &tracked.GetImageToReference(candidate.Number) });
  }
  const std::string place =
    std::string(" (field data array '") + lacuna::TrackedSlices::ImageToReferenceName + "'";
  const auto isBad = [](const std::string& problem) { return !problem.empty(); };
  std::vector<std::string> problems = lacuna::PoseJudge::FindUnusable(slices);
  const auto unusable = std::find_if(problems.begin(), problems.end(), isBad);
  if (unusable != problems.end() && selection.BadPoses != vtkLacunaSliceAlgorithm::LeaveOut)
  {
    throw std::runtime_error(*unusable +
      "; mark the slice invalid (SliceStatus 1) to leave it out, or mend its transform" + place +
      "), or set BadPoses to LeaveOut");
  }
  if (selection.BadPoses != vtkLacunaSliceAlgorithm::KeepOutliers)
  {
    lacuna::PoseJudge::AddOutliers(slices, problems);
  }
  const auto outlier = std::find_if(problems.begin(), problems.end(), isBad);
  if (outlier != problems.end() && selection.BadPoses == vtkLacunaSliceAlgorithm::Refuse)
  {
    const auto count = std::count_if(problems.begin(), problems.end(), isBad);
    throw std::runtime_error(*outlier + place +
      (count > 1 ? ", " + std::to_string(count) + " slices in all" : std::string()) +
      "). Set BadPoses to LeaveOut or KeepOutliers, or mark the slice invalid (SliceStatus 1)");
  }
  std::vector<Candidate> kept;
  for (std::size_t i = 0; i < problems.size(); ++i)
  {
    if (problems[i].empty())
    {
      kept.push_back(candidates[i]);
    }
    else
    {
      this->LeftOut.push_back(problems[i]);
    }
  }
  candidates = kept;
}

//------------------------------------------------------------------------------
void lacuna::SliceImages::FindSweeps(const lacuna::TrackedSlices& tracked,
  const lacuna::SliceSelection& selection, const std::vector<Candidate>& gatedOut,
  std::vector<Candidate>& candidates)
{
  this->PartSweeps(tracked, FindKnown(tracked, gatedOut, candidates));
  if (!selection.HasSweepEnds && this->Sweeps.size() > 1)
  {
    this->JoinSweeps();
  }
  std::size_t sweep = 1;
  for (Candidate& candidate : candidates)
  {
    if (sweep < this->Sweeps.size() && candidate.Number == this->Sweeps[sweep].First)
    {
      candidate.Slice.BeginsSweep = true;
      ++sweep;
    }
  }
}

//------------------------------------------------------------------------------
// All slices of which it is known where the probe was, by number.
std::vector<const lacuna::SliceImages::Candidate*> lacuna::SliceImages::FindKnown(
  const lacuna::TrackedSlices& tracked, const std::vector<Candidate>& gatedOut,
  const std::vector<Candidate>& candidates)
{
  std::vector<lacuna::PoseJudge::Slice> others;
  for (const Candidate& candidate : gatedOut)
  {
    others.push_back(
      { candidate.Number, &candidate.Slice, &tracked.GetImageToReference(candidate.Number) });
  }
  const std::vector<std::string> problems = lacuna::PoseJudge::FindUnusable(others);
  std::vector<const Candidate*> known;
  for (std::size_t i = 0; i < gatedOut.size(); ++i)
  {
    if (problems[i].empty())
    {
      known.push_back(&gatedOut[i]);
    }
  }
  for (const Candidate& candidate : candidates)
  {
    if (candidate.HasImage)
    {
      known.push_back(&candidate);
    }
  }
  std::sort(known.begin(), known.end(),
    [](const Candidate* a, const Candidate* b) { return a->Number < b->Number; });
  return known;
}

//------------------------------------------------------------------------------
// Sets Sweeps; slices that are gated out only say where the probe was.
void lacuna::SliceImages::PartSweeps(
  const lacuna::TrackedSlices& tracked, const std::vector<const Candidate*>& known)
{
  const bool hasTimes = lacuna::FieldData::Find(this->Stack, lacuna::TrackedSlices::TimestampName,
                          1, tracked.GetNumberOfSlices()) != nullptr;
  std::vector<lacuna::SlicePlace> places;
  std::vector<double> times;
  for (const Candidate* candidate : known)
  {
    places.push_back({ candidate->Number, lacuna::GetCorners(candidate->Slice) });
    times.push_back(hasTimes ? tracked.GetTimestamp(candidate->Number)
                             : std::numeric_limits<double>::quiet_NaN());
  }
  const std::vector<lacuna::SweepEnd> ends = lacuna::FindSweepEnds(places, times);

  std::size_t next = 0;   // of ends
  std::size_t before = 0; // of places: the slice before that is taken
  bool isEnded = false;   // since that slice
  for (std::size_t i = 0; i < known.size(); ++i)
  {
    if (next < ends.size() && ends[next].Next == i)
    {
      isEnded = !this->Sweeps.empty();
      if (isEnded)
      {
        this->Sweeps.back().End = ends[next];
      }
      ++next;
    }
    if (known[i]->IsGatedOut)
    {
      continue;
    }
    const int number = static_cast<int>(known[i]->Number);
    if (this->Sweeps.empty() || isEnded)
    {
      this->Sweeps.push_back({ number, number, 0, {} });
    }
    else
    {
      Sweep& sweep = this->Sweeps.back();
      sweep.Last = number;
      sweep.WidestStep = std::max(sweep.WidestStep, lacuna::GetStep(places[before], places[i]));
    }
    before = i;
    isEnded = false;
  }
}

//------------------------------------------------------------------------------
void lacuna::SliceImages::JoinSweeps()
{
  this->JoinedEnds = this->DescribeEnds();
  Sweep all = this->Sweeps.front();
  all.Last = this->Sweeps.back().Last;
  for (const Sweep& sweep : this->Sweeps)
  {
    all.WidestStep = std::max({ all.WidestStep, sweep.WidestStep, sweep.End.Distance });
  }
  this->Sweeps = { all };
}

//------------------------------------------------------------------------------
std::string lacuna::SliceImages::DescribeEnds() const
{
  std::ostringstream text;
  text << std::setprecision(3);
  for (std::size_t s = 1; s < this->Sweeps.size(); ++s)
  {
    const lacuna::SweepEnd& end = this->Sweeps[s - 1].End;
    text << (s > 1 ? ", " : "") << end.Distance << " mm";
    if (std::isfinite(end.Time))
    {
      text << " and " << end.Time << " s";
    }
    text << " from slice " << this->Sweeps[s - 1].Last << " to " << this->Sweeps[s].First
         << " (the limit is " << end.Limit << " mm)";
  }
  return text.str();
}

//------------------------------------------------------------------------------
std::string lacuna::SliceImages::DescribeSweeps() const
{
  std::ostringstream text;
  text << std::setprecision(3) << this->Sweeps.size()
       << (this->Sweeps.size() == 1 ? " sweep" : " sweeps");
  const char* separator = ": ";
  for (const Sweep& sweep : this->Sweeps)
  {
    text << separator << "slices " << sweep.First << " to " << sweep.Last << ", at most "
         << sweep.WidestStep << " mm apart";
    separator = "; ";
  }
  const std::string ends = this->DescribeEnds();
  return text.str() + (ends.empty() ? "" : "; not joined: " + ends);
}

//------------------------------------------------------------------------------
void lacuna::SliceImages::ApplyFan(const lacuna::SliceFan& fan)
{
  std::vector<lacuna::SliceImage*> all;
  for (std::vector<lacuna::SliceImage>* slices : { &this->Slices, &this->Others })
  {
    for (lacuna::SliceImage& slice : *slices)
    {
      all.push_back(&slice);
    }
  }
  this->Window = fan.Apply(all, this->Window);
  // not from the poses of the windows before, so that the same window always gives the same poses
  for (std::size_t i = 0; i < all.size(); ++i)
  {
    all[i]->PixelToReference = this->Poses[i] * this->Window.GetMatrix();
  }
}

//------------------------------------------------------------------------------
std::string lacuna::SliceImages::DescribePreview() const
{
  auto* preview = vtkStringArray::SafeDownCast(
    this->Stack->GetFieldData()->GetAbstractArray(lacuna::TrackedSlices::PreviewName));
  return !this->Stream && preview && preview->GetNumberOfValues() > 0
    ? "the input is made of " + preview->GetValue(0)
    : std::string();
}

//------------------------------------------------------------------------------
std::vector<lacuna::SliceImage> lacuna::SliceImages::Load(const std::vector<std::size_t>& indices,
  std::vector<unsigned char>& storage, lacuna::Execution& execution) const
{
  std::vector<lacuna::SliceImage> loaded;
  for (const std::size_t i : indices)
  {
    loaded.push_back(this->Slices[i]);
  }
  if (!this->Stream)
  {
    return loaded;
  }
  const auto sliceSize = static_cast<std::size_t>(this->Stream->GetSliceSize());
  storage.resize(indices.size() * sliceSize);
  for (std::size_t begin = 0, end = 0; begin < indices.size(); begin = end)
  {
    const int first = this->Layers[indices[begin]];
    while (
      end < indices.size() && this->Layers[indices[end]] == first + static_cast<int>(end - begin))
    {
      ++end;
    }
    this->Stream->Read(first, first + static_cast<int>(end - begin) - 1,
      storage.data() + begin * sliceSize, execution);
  }
  // where the window begins in a slice of the stack
  const auto column =
    std::llround((this->Window.Origin[0] - this->Origin[0]) / this->Spacing[0]) - this->Extent[0];
  const auto row =
    std::llround((this->Window.Origin[1] - this->Origin[1]) / this->Spacing[1]) - this->Extent[2];
  for (std::size_t n = 0; n < loaded.size(); ++n)
  {
    lacuna::SliceImage& slice = loaded[n];
    slice.Pixels = storage.data() + n * sliceSize +
      (slice.RowStride * row + column) *
        static_cast<std::int64_t>(lacuna::GetScalarSize(slice.Type));
  }
  return loaded;
}

//------------------------------------------------------------------------------
void lacuna::SliceImages::ForEachPart(
  lacuna::Execution& execution, double begin, double end, const Part& f) const
{
  const std::size_t count = this->Slices.size();
  if (!this->Stream)
  {
    f(this->Slices, 0, 1);
    return;
  }
  const auto atATime = static_cast<std::size_t>(this->Stream->GetSlicesAtATime());
  std::vector<unsigned char> storage;
  std::vector<std::size_t> indices;
  for (std::size_t next = 0; next < count; next += indices.size())
  {
    indices.resize(std::min(atATime, count - next));
    std::iota(indices.begin(), indices.end(), next);
    const double first = static_cast<double>(next) / static_cast<double>(count);
    const double last = static_cast<double>(next + indices.size()) / static_cast<double>(count);
    const double progress = begin + (end - begin) * first;
    execution.SetStage(progress, progress);
    f(this->Load(indices, storage, execution), first, last);
  }
}

//------------------------------------------------------------------------------
void lacuna::SliceImages::HideSlices()
{
  this->Others.insert(this->Others.begin(), this->Slices.begin(), this->Slices.end());
  this->Slices.clear();
}

//------------------------------------------------------------------------------
std::string lacuna::SliceImages::DescribeFlags() const
{
  const std::string flags = this->Flags.Describe();
  return std::to_string(this->Flags.GetNumberOfSlices()) + " of " +
    std::to_string(this->GetNumberOfLayers()) + " are flagged in SliceStatus" +
    (flags.empty() ? "" : ": " + flags);
}

//------------------------------------------------------------------------------
std::string lacuna::SliceImages::DescribeRemedy() const
{
  std::string list;
  for (const auto& [flag, property] : { std::pair{ TrackedSlices::ImageInvalid, "UseImageInvalid" },
         std::pair{ TrackedSlices::TooFast, "UseTooFast" },
         std::pair{ TrackedSlices::GatedOut, "UseGatedOut" } })
  {
    if (this->Flags.Has(flag))
    {
      list += (list.empty() ? "" : ", ") + std::string(property);
    }
  }
  return list.empty() ? "mend the SliceStatus of those whose pose is right"
                      : "set " + list + " to take the flagged ones";
}

//------------------------------------------------------------------------------
std::string lacuna::SliceImages::DescribeLeftOut(const std::vector<std::string>& leftOut)
{
  std::ostringstream text;
  text << leftOut.size() << (leftOut.size() == 1 ? " slice was" : " slices were")
       << " left out because of bad poses.";
  constexpr std::size_t most = 10;
  for (std::size_t i = 0; i < leftOut.size() && i < most; ++i)
  {
    text << "\n" << leftOut[i];
  }
  text << (leftOut.size() > most ? "\n..." : "");
  return text.str();
}
