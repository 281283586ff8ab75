// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSweep.h"

#include "lacunaSequenceText.h"
#include "lacunaSweepTransforms.h"
#include "lacunaTransformGraph.h"

#include <algorithm>
#include <climits>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <stdexcept>

namespace lacuna
{
namespace
{
// Arrays of tracked slices with a meaning of their own.
const std::set<std::string> ReservedNames = { "ImageToReference", "ImageToProbe" };

constexpr std::size_t LongestQuotation = 40;

std::string FrameList(const std::vector<std::size_t>& frames)
{
  std::vector<std::string> numbers;
  std::transform(frames.begin(), frames.end(), std::back_inserter(numbers),
    [](std::size_t frame) { return std::to_string(frame); });
  return (frames.size() > 1 ? "frames " : "frame ") + JoinSome(numbers);
}

class SweepBuilder
{
public:
  SweepBuilder(const SequenceHeader& header, const SweepOptions& options)
    : Header(header)
    , Options(options)
    , Count(static_cast<std::size_t>(header.Frames))
    , Transforms(header, options.CalibrationFileName)
  {
  }

  Sweep Build()
  {
    this->Result.Warnings = this->Transforms.GetWarnings();
    this->Result.Status.assign(this->Count, Sweep::Valid);
    this->KeepFields();
    this->ReadTimes();
    this->FlagImages();
    this->FindImageToProbe();
    this->BuildPoses();
    const int accepted = this->Header.PosesOnly ? Sweep::ImageInvalid : Sweep::Valid;
    const bool none = std::none_of(this->Result.Status.begin(), this->Result.Status.end(),
      [&](unsigned char status) { return status == accepted; });
    if (none)
    {
      this->Warn("not one of the " + std::to_string(this->Count) +
        " slices is valid; SliceStatus and the arrays ...Status say why");
    }
    return std::move(this->Result);
  }

private:
  using Chain = std::vector<TransformGraph::Link>;

  [[noreturn]] void Fail(const std::string& text) const
  {
    throw std::runtime_error(this->Header.FileName + ": " + text);
  }
  void Warn(const std::string& text) { this->Result.Warnings.push_back(text); }
  const TransformGraph& Graph() const { return this->Transforms.GetGraph(); }

  void KeepFields();
  static void RestateInPicture(const SweepTransform& transform, std::vector<std::string>& texts);
  void ReadTimes();
  void FlagImages();
  void AddFlags(std::size_t frame, const std::string& text);
  void FindImageToProbe();
  bool FindChain(Chain& chain);
  void BuildPoses();
  void DescribeChain(const Chain& chain);
  void ReportBadFrames(const SweepTransform& transform);
  void ReportMirrors(const SweepTransform& transform);

  const SequenceHeader& Header;
  const SweepOptions& Options;
  std::size_t Count;
  SweepTransforms Transforms;
  std::map<std::string, std::vector<std::size_t>> BadFlags; ///< frames by the text of SliceStatus
  Sweep Result;
};

//------------------------------------------------------------------------------
void SweepBuilder::KeepFields()
{
  for (const SweepTransform& transform : this->Transforms.GetAll())
  {
    if (!transform.FromCalibration && ReservedNames.count(transform.Name) == 0)
    {
      this->Result.Transforms[transform.Name] = transform.Matrices;
    }
  }
  const bool cropped = !(GetPictureOrigin(this->Header) == Vec3{ 0, 0, 0 });
  for (const auto& [field, texts] : this->Header.FrameFields)
  {
    const std::string name = SweepTransforms::GetTransformName(field);
    if (name.empty() || ReservedNames.count(name) > 0)
    {
      this->Result.TextFields[field] = texts;
    }
    for (const SweepTransform& transform : this->Transforms.GetAll())
    {
      // these, too, shall count from the picture's first pixel, as everything else does then
      if (cropped && ReservedNames.count(name) > 0 && transform.Name == name &&
        !transform.FromCalibration)
      {
        this->RestateInPicture(transform, this->Result.TextFields[field]);
      }
    }
  }
}

//------------------------------------------------------------------------------
void SweepBuilder::RestateInPicture(
  const SweepTransform& transform, std::vector<std::string>& texts)
{
  for (std::size_t i = 0; i < texts.size(); ++i)
  {
    if (transform.Matrices[i].IsFinite())
    {
      texts[i] = FormatMatrix(transform.Matrices[i]);
    }
  }
}

//------------------------------------------------------------------------------
void SweepBuilder::ReadTimes()
{
  this->Result.Timestamps = ReadTimestamps(this->Header);
  std::vector<std::size_t> missing;
  for (std::size_t i = 0; i < this->Result.Timestamps.size(); ++i)
  {
    if (std::isnan(this->Result.Timestamps[i]))
    {
      missing.push_back(i);
    }
  }
  if (!missing.empty())
  {
    this->Warn("field Timestamp is missing or not a finite number in " + FrameList(missing));
  }
  this->Result.TextFields.erase("Timestamp");
  const auto numbers = this->Header.FrameFields.find("FrameNumber");
  for (std::size_t i = 0; i < this->Count; ++i)
  {
    std::int64_t number = 0;
    const bool known = numbers != this->Header.FrameFields.end() &&
      ParseInteger(numbers->second[i], number) && number >= INT_MIN && number <= INT_MAX;
    this->Result.FrameNumbers.push_back(
      static_cast<int>(known ? number : static_cast<std::int64_t>(i)));
  }
  this->Result.TextFields.erase("FrameNumber");
}

//------------------------------------------------------------------------------
void SweepBuilder::FlagImages()
{
  const auto flags = this->Header.FrameFields.find("SliceStatus");
  const auto states = this->Header.FrameFields.find("ImageStatus");
  for (std::size_t i = 0; i < this->Count; ++i)
  {
    const bool stated = states != this->Header.FrameFields.end() && !states->second[i].empty();
    const bool refused = stated && states->second[i] != "OK" && this->Options.DropInvalid;
    const bool absent = this->Header.PosesOnly ||
      (this->Options.FramesWithPixels >= 0 &&
        static_cast<std::int64_t>(i) >= this->Options.FramesWithPixels);
    if (refused || absent)
    {
      this->Result.Status[i] |= Sweep::ImageInvalid;
    }
    if (flags != this->Header.FrameFields.end())
    {
      this->AddFlags(i, flags->second[i]);
    }
  }
  if (!this->BadFlags.empty())
  {
    std::vector<std::string> texts;
    for (const auto& [text, frames] : this->BadFlags)
    {
      texts.push_back("'" + text + "' in " + FrameList(frames));
    }
    this->Warn("field SliceStatus must be a whole number from 0 to 255, but is " + JoinSome(texts) +
      (this->Options.DropInvalid ? "; what it says against these slices is not known, so they "
                                   "count as image invalid (2)"
                                 : ""));
  }
}

//------------------------------------------------------------------------------
void SweepBuilder::AddFlags(std::size_t frame, const std::string& text)
{
  std::int64_t given = 0;
  if (text.empty())
  {
    return;
  }
  if (!ParseInteger(text, given) || given < 0 || given > 255)
  {
    this->BadFlags[text.substr(0, LongestQuotation)].push_back(frame);
    given = Sweep::ImageInvalid;
  }
  else
  {
    given &= ~Sweep::ImageInvalid; // ImageStatus tells
  }
  if (this->Options.DropInvalid)
  {
    this->Result.Status[frame] |= static_cast<unsigned char>(given);
  }
}

//------------------------------------------------------------------------------
void SweepBuilder::FindImageToProbe()
{
  Chain chain;
  Matrix4 imageToProbe;
  if (!this->Graph().FindChain(this->Options.ImageFrame, "Probe", chain) || chain.empty())
  {
    return;
  }
  if (std::all_of(chain.begin(), chain.end(),
        [&](const TransformGraph::Link& link) { return this->Transforms.Get(link).IsConstant(); }))
  {
    if (this->Transforms.Compose(chain, 0, imageToProbe))
    {
      this->Result.ImageToProbe.push_back(imageToProbe);
    }
    return;
  }
  if (chain.size() > 1) // by way of what moves
  {
    return;
  }
  // Shown while it was recorded, all slices were placed by the last one.
  const SweepTransform& calibration = this->Transforms.Get(chain.front());
  const std::vector<Matrix4>& matrices = calibration.Matrices;
  const auto isGiven = [](const Matrix4& matrix) { return matrix.IsFinite(); };
  const auto first = std::find_if(matrices.begin(), matrices.end(), isGiven);
  const auto other = std::find_if(first, matrices.end(),
    [&](const Matrix4& matrix)
    { return isGiven(matrix) && !std::equal(matrix.Data(), matrix.Data() + 16, first->Data()); });
  if (other != matrices.end())
  {
    this->Warn("the probe's calibration " + calibration.Name + " of frame " +
      std::to_string(other - matrices.begin()) + " is not that of frame " +
      std::to_string(first - matrices.begin()) +
      " (calibrated anew while it was recorded?); each slice is placed by its own. Give "
      "CalibrationFileName to place all by one");
  }
}

//------------------------------------------------------------------------------
// Returns false when the probe is not calibrated.
bool SweepBuilder::FindChain(Chain& chain)
{
  const std::string& image = this->Options.ImageFrame;
  const std::string& reference = this->Options.ReferenceFrame;
  if (image == reference)
  {
    this->Fail("ImageFrame and ReferenceFrame are both '" + image +
      "'; the reference frame must be one that does not move with the image");
  }
  if (this->Graph().FindChain(image, reference, chain))
  {
    return true;
  }
  if (!this->Graph().HasFrame(image))
  {
    const std::string none = "no transform leads from or to the image frame '" + image + "'. ";
    if (!this->Options.CalibrationFileName.empty())
    {
      this->Fail(none +
        "Set ImageFrame to the frame that the calibration is for, or give another "
        "CalibrationFileName. " +
        this->Transforms.Describe());
    }
    this->Warn(none +
      "The slices are read without ImageToReference: filters that need positions will refuse them. "
      "Give the CalibrationFileName that holds " +
      image + " to Probe. " + this->Transforms.Describe());
    return false;
  }
  const std::string reached = JoinSome(this->Graph().GetReachable(image), 20);
  if (!this->Graph().HasFrame(reference))
  {
    this->Fail("no transform leads from or to the reference frame '" + reference + "'. From '" +
      image + "' these frames can be reached: " + reached +
      ". Set ReferenceFrame to one that does not move with the probe. " +
      this->Transforms.Describe());
  }
  this->Fail("the chain of transforms from '" + image + "' to '" + reference +
    "' has a missing link: one is needed between a frame of the first group (" + reached +
    ") and one of the second (" + JoinSome(this->Graph().GetReachable(reference), 20) + "). " +
    this->Transforms.Describe());
}

//------------------------------------------------------------------------------
void SweepBuilder::BuildPoses()
{
  Chain chain;
  const bool calibrated = this->FindChain(chain);
  if (calibrated)
  {
    this->DescribeChain(chain);
    this->Result.ImageToReference.resize(this->Count);
  }
  else if (!this->Graph().FindChain("Probe", this->Options.ReferenceFrame, chain))
  {
    return; // no pose to judge
  }
  for (std::size_t i = 0; i < this->Count; ++i)
  {
    const bool refused = this->Options.DropInvalid &&
      std::any_of(chain.begin(), chain.end(),
        [&](const TransformGraph::Link& link) { return !this->Transforms.Get(link).IsValid(i); });
    Matrix4 pose;
    if (!this->Transforms.Compose(chain, i, pose) || refused)
    {
      this->Result.Status[i] |= Sweep::PoseInvalid;
      std::array<double, 16> none;
      none.fill(std::numeric_limits<double>::quiet_NaN());
      pose = Matrix4(none);
    }
    if (calibrated)
    {
      this->Result.ImageToReference[i] = pose;
    }
  }
  for (const TransformGraph::Link& link : chain)
  {
    const SweepTransform& transform = this->Transforms.Get(link);
    if (!transform.FromCalibration)
    {
      this->ReportBadFrames(transform);
    }
    const std::string& image = this->Options.ImageFrame;
    // the third axis of a picture means nothing
    if (transform.From != image && transform.To != image)
    {
      this->ReportMirrors(transform);
    }
  }
}

//------------------------------------------------------------------------------
void SweepBuilder::DescribeChain(const Chain& chain)
{
  this->Result.Chain = this->Options.ImageFrame;
  bool calibrationUsed = this->Options.CalibrationFileName.empty();
  for (const TransformGraph::Link& link : chain)
  {
    this->Result.Chain += " > " + link.To;
    calibrationUsed = calibrationUsed || this->Transforms.Get(link).FromCalibration;
  }
  if (!calibrationUsed)
  {
    this->Warn("the calibration file is not used: the sequence itself leads from '" +
      this->Options.ImageFrame + "' to '" + this->Options.ReferenceFrame + "' (" +
      this->Result.Chain + ")");
  }
}

//------------------------------------------------------------------------------
// What the file itself calls invalid is no surprise and not reported.
void SweepBuilder::ReportBadFrames(const SweepTransform& transform)
{
  static const std::set<std::string> states = { "OK", "MISSING", "OUT_OF_VIEW", "OUT_OF_VOLUME",
    "SWITCH1_IS_ON", "SWITCH2_IS_ON", "SWITCH3_IS_ON", "REQ_TIMEOUT", "INVALID", "PATH_NOT_FOUND",
    "UNKNOWN" };
  std::map<std::string, std::vector<std::size_t>> problems;
  for (std::size_t i = 0; i < this->Count; ++i)
  {
    std::string problem;
    if (transform.IsValid(i))
    {
      problem = transform.Errors[i];
      try
      {
        if (problem.empty())
        {
          transform.Matrices[i].Inverse();
        }
      }
      catch (const std::invalid_argument& e)
      {
        problem = std::string("cannot be used (") + e.what() + ")";
      }
    }
    else if (states.count((*transform.Status)[i]) == 0)
    {
      const std::string& state = (*transform.Status)[i];
      problem = state.empty() ? "has no status" : "has the unknown status '" + state + "'";
    }
    if (!problem.empty())
    {
      problems[problem].push_back(i);
    }
  }
  std::vector<std::string> texts;
  texts.reserve(problems.size());
  for (const auto& [problem, frames] : problems)
  {
    texts.push_back(problem + " in " + FrameList(frames));
  }
  if (!texts.empty())
  {
    this->Warn("transform " + transform.Name + " " + JoinSome(texts));
  }
  if (!transform.Status)
  {
    this->Warn("field " + transform.Name +
      "TransformStatus is missing in all frames; the transform is taken as valid");
  }
}

//------------------------------------------------------------------------------
void SweepBuilder::ReportMirrors(const SweepTransform& transform)
{
  std::vector<std::size_t> frames;
  for (std::size_t i = 0; i < this->Count; ++i)
  {
    if (transform.Get(i).IsFinite() && transform.Get(i).Determinant3() < 0)
    {
      frames.push_back(i);
    }
  }
  if (!frames.empty())
  {
    this->Warn("transform " + transform.Name + " mirrors (its axes are left-handed) in " +
      FrameList(frames) +
      ", which no tracker can move by: what is made of these slices may be a mirror image. Convert "
      "the poses to right-handed axes; where only the pictures are mirrored, flip those instead");
  }
}
}

std::vector<double> ReadTimestamps(const SequenceHeader& header)
{
  std::vector<double> times;
  const auto texts = header.FrameFields.find("Timestamp");
  if (texts != header.FrameFields.end())
  {
    for (const std::string& text : texts->second)
    {
      double time = 0;
      const bool known = ParseNumber(text, time) && std::isfinite(time);
      times.push_back(known ? time : std::numeric_limits<double>::quiet_NaN());
    }
  }
  return times;
}

Sweep BuildSweep(const SequenceHeader& header, const SweepOptions& options)
{
  return SweepBuilder(header, options).Build();
}
}
