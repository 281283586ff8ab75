// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSweep.h"

#include "lacunaChainJudge.h"
#include "lacunaGeometryGate.h"
#include "lacunaItemList.h"
#include "lacunaPatientIdentity.h"
#include "lacunaPixelSpacing.h"
#include "lacunaPoseFields.h"
#include "lacunaSequenceFormat.h"
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

// What a person sets on a scanner that changes where its pixels lie, as PLUS names it in frames.
const char* const Settings[] = { "Depth", "DepthMm", "HorizontalBins", "SectorPercent",
  "TransducerOriginPix", "VerticalBins", "ZoomFactor" };

// "one in frame 3, another in frames 0, 2"
std::string ListFrames(
  const std::map<std::string, std::vector<std::size_t>>& framesOf, const std::string& in)
{
  std::vector<std::string> parts;
  for (const auto& [text, frames] : framesOf)
  {
    parts.push_back(text + in + DescribeItems("frame", frames));
  }
  return JoinSome(parts);
}

class SweepBuilder
{
public:
  SweepBuilder(const SequenceHeader& header, const SweepOptions& options)
    : Header(header)
    , Options(options)
    , Count(static_cast<std::size_t>(header.Frames))
    , Transforms(header, options.CalibrationFileName)
    , ImageFrame(options.ImageFrame)
  {
  }

  Sweep Build()
  {
    this->Result.Warnings = this->Transforms.GetWarnings();
    this->Result.Status.assign(this->Count, Sweep::Valid);
    this->FindPixels();
    this->KeepFields();
    this->ReadTimes();
    this->FlagImages();
    this->FindImageToProbe();
    this->BuildPoses();
    this->CheckSpacings();
    this->CheckSettings();
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

  void FindPixels();
  void KeepFields();
  static void RestateInPicture(const SweepTransform& transform, std::vector<std::string>& texts);
  void ReadTimes();
  void FlagImages();
  void AddFlags(std::size_t frame, const std::string& text);
  void FindImageToProbe();
  bool FindChain(Chain& chain);
  void BuildPoses();
  bool IsUncalibrated() const;
  const std::vector<std::string>* FindField(const std::string& name) const;
  void CheckSpacings();
  void CheckSettings();
  void ReportPictures(const Chain& chain);
  void DescribeChain(const Chain& chain);
  void ReportBadFrames(const SweepTransform& transform);

  const SequenceHeader& Header;
  const SweepOptions& Options;
  std::size_t Count;
  SweepTransforms Transforms;
  std::string ImageFrame;                                   ///< of the pixels
  std::map<std::string, std::vector<std::size_t>> BadFlags; ///< frames by the text of SliceStatus
  Sweep Result;
};

//------------------------------------------------------------------------------
void SweepBuilder::FindPixels()
{
  const std::vector<SweepTransform>& all = this->Transforms.GetAll();
  const bool cropped = std::any_of(all.begin(), all.end(),
    [](const SweepTransform& transform)
    {
      return !transform.FromCalibration &&
        (transform.Name == std::string(WholeImageFrame) + "To" + CroppedImageFrame ||
          transform.Name == std::string(CroppedImageFrame) + "To" + WholeImageFrame);
    });
  if (cropped && this->ImageFrame == WholeImageFrame)
  {
    this->ImageFrame = CroppedImageFrame;
  }
  this->Result.ImageFrame = this->ImageFrame;
}

//------------------------------------------------------------------------------
const std::vector<std::string>* SweepBuilder::FindField(const std::string& name) const
{
  const auto field = this->Header.FrameFields.find(name);
  return field == this->Header.FrameFields.end() ? nullptr : &field->second;
}

//------------------------------------------------------------------------------
void SweepBuilder::KeepFields()
{
  for (const SweepTransform& transform : this->Transforms.GetAll())
  {
    if (!transform.FromCalibration && ReservedNames.count(transform.Name) == 0)
    {
      this->Result.Transforms[transform.Name] = transform.Matrices;
    }
    if (transform.FromHeader)
    {
      this->Result.HeaderTransforms.insert(transform.Name);
    }
  }
  const Vec2 spacing = ReadPixelSpacing(this->Header.PixelSpacing);
  if (!this->Header.PosesOnly && IsPixelSpacing(spacing) && SaysPixelSpacing(spacing))
  {
    // for every frame, which is how a writer keeps it
    this->Result.TextFields[PixelSpacingField].assign(this->Count, this->Header.PixelSpacing);
  }
  const bool cropped = !(GetPictureOrigin(this->Header) == Vec3{ 0, 0, 0 });
  for (const auto& [field, texts] : this->Header.FrameFields)
  {
    const std::string name = SweepTransforms::GetTransformName(field);
    if (name.empty() || ReservedNames.count(name) > 0)
    {
      std::vector<std::string>& kept = this->Result.TextFields[field];
      kept.resize(this->Count);
      std::transform(texts.begin(), texts.end(), kept.begin(), kept.begin(),
        [](const std::string& own, const std::string& before)
        { return own.empty() ? before : own; });
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
    this->Warn(
      "field Timestamp is missing or not a finite number in " + DescribeItems("frame", missing));
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
    this->Warn("field SliceStatus must be a whole number from 0 to 255, but is " +
      ListFrames(this->BadFlags, " in ") +
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
    this->BadFlags["'" + text.substr(0, LongestQuotation) + "'"].push_back(frame);
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
  if (!this->Graph().FindChain(this->ImageFrame, "Probe", chain) || chain.empty())
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
// Whether a calibration is missing, where there is no chain. One that is given has to lead on; one in
// the sequence only has to be asked for a frame that there is.
bool SweepBuilder::IsUncalibrated() const
{
  const std::vector<std::string> reached = this->Graph().GetReachable(this->ImageFrame);
  const bool toProbe = std::find(reached.begin(), reached.end(), "Probe") != reached.end();
  return this->Options.CalibrationFileName.empty() &&
    (!toProbe || this->Graph().HasFrame(this->Options.ReferenceFrame));
}

//------------------------------------------------------------------------------
// Returns false when the probe is not calibrated.
bool SweepBuilder::FindChain(Chain& chain)
{
  const std::string& image = this->ImageFrame;
  const std::string& reference = this->Options.ReferenceFrame;
  if (image == reference)
  {
    this->Fail("ImageFrame and ReferenceFrame are both '" + image +
      "'; the reference frame must be one that does not move with the image");
  }
  constexpr std::size_t LongestChain = 64; // each link is computed for each frame
  if (this->Graph().FindChain(image, reference, chain))
  {
    if (chain.size() > LongestChain)
    {
      this->Fail("a chain of " + std::to_string(chain.size()) + " transforms leads from '" + image +
        "' to '" + reference + "'; up to " + std::to_string(LongestChain) +
        " are read. Remove those that are not needed");
    }
    return true;
  }
  const std::string none = this->Graph().HasFrame(image)
    ? "no chain of transforms leads from the image frame '" + image + "' to '" + reference + "'. "
    : "no transform leads from or to the image frame '" + image + "'. ";
  if (this->IsUncalibrated())
  {
    this->Warn(none +
      "The slices are read without ImageToReference: filters that need positions will refuse them. "
      "Give the CalibrationFileName that holds " +
      this->Options.ImageFrame + " to Probe. " + this->Transforms.Describe());
    return false;
  }
  if (!this->Graph().HasFrame(image))
  {
    this->Fail(none +
      "Set ImageFrame to the frame that the calibration is for, or give another "
      "CalibrationFileName. " +
      this->Transforms.Describe());
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
  this->ReportPictures(chain);
  if (calibrated)
  {
    this->DescribeChain(chain);
    this->Result.ImageToReference.resize(this->Count);
    if (this->Header.Flips.Lines && !this->Header.PosesOnly)
    {
      this->Warn(
        "the slices are scan lines, which are not converted to pictures. ImageToReference "
        "takes sample and line for column and row, which is right only for a calibration of "
        "these lines");
    }
  }
  else if (!this->Graph().FindChain("Probe", this->Options.ReferenceFrame, chain))
  {
    return; // no pose to judge
  }
  const ChainJudgement judgement =
    JudgeChain(this->Transforms, chain, this->Count, calibrated, this->Options.DropInvalid);
  if (!judgement.Refusal.empty())
  {
    this->Fail(judgement.Refusal);
  }
  this->Result.Warnings.insert(
    this->Result.Warnings.end(), judgement.Warnings.begin(), judgement.Warnings.end());
  for (std::size_t i = 0; i < this->Count; ++i)
  {
    const bool refused = this->Options.DropInvalid &&
      std::any_of(chain.begin(), chain.end(),
        [&](const TransformGraph::Link& link) { return !this->Transforms.Get(link).IsValid(i); });
    Matrix4 pose;
    if (!this->Transforms.Compose(chain, i, pose) || refused || judgement.Impossible[i])
    {
      this->Result.Status[i] |= Sweep::PoseInvalid;
      pose = NoPose();
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
  }
}

//------------------------------------------------------------------------------
// A transform between two pictures may mean that the pixels are those of the other one.
void SweepBuilder::ReportPictures(const Chain& chain)
{
  for (const SweepTransform& transform : this->Transforms.GetAll())
  {
    const std::string& other = transform.From == this->ImageFrame ? transform.To : transform.From;
    const bool leads = transform.From == this->ImageFrame || transform.To == this->ImageFrame;
    const bool known = other == WholeImageFrame || other == CroppedImageFrame ||
      std::any_of(chain.begin(), chain.end(),
        [&](const TransformGraph::Link& link) { return link.To == other; });
    const bool moves = !transform.IsConstant() || !IsNear(transform.Matrices.front(), Matrix4());
    if (!transform.FromCalibration && leads && !known && IsPictureFrame(other) && moves)
    {
      this->Warn("transform " + transform.Name +
        " joins two pictures. The pixels are taken to be in '" + this->ImageFrame +
        "'; set ImageFrame to '" + other + "' if they are in that one");
    }
  }
}

//------------------------------------------------------------------------------
// Compares what frames say of the size of their pixels with the chain.
void SweepBuilder::CheckSpacings()
{
  if (this->Header.PosesOnly)
  {
    return;
  }
  const auto* sizes = this->FindField(PixelSpacingField);
  const auto* sonixSizes = this->FindField("PixelSpacingMm"); // of Ultrasonix scanners
  std::map<std::string, std::vector<std::size_t>> unreadable;
  std::map<std::string, std::vector<std::size_t>> others; // by what they say and what is known
  std::map<std::string, std::vector<std::size_t>> said;
  for (std::size_t i = 0; i < this->Count; ++i)
  {
    const bool own = sizes && !(*sizes)[i].empty();
    const bool sonix = !own && sonixSizes && !(*sonixSizes)[i].empty();
    const std::string& text = own ? (*sizes)[i]
      : sonix                     ? (*sonixSizes)[i]
                                  : this->Header.PixelSpacing;
    const std::string source = own ? PixelSpacingField : sonix ? "PixelSpacingMm" : "the header";
    const Vec2 spacing = ReadPixelSpacing(text);
    if (text.empty() || !SaysPixelSpacing(spacing))
    {
      continue;
    }
    if (!IsPixelSpacing(spacing))
    {
      unreadable[source + " is '" + text.substr(0, LongestQuotation) + "'"].push_back(i);
      continue;
    }
    const std::string size = source + " says that pixels are " + FormatPixelSpacing(spacing);
    said[size].push_back(i);
    const bool posed =
      !this->Result.ImageToReference.empty() && this->Result.ImageToReference[i].IsFinite();
    if (!posed && this->Result.ImageToProbe.empty())
    {
      continue;
    }
    const Vec2 known =
      GetPixelSpacing(posed ? this->Result.ImageToReference[i] : this->Result.ImageToProbe[0]);
    if (IsSameSpacing(spacing, known))
    {
      continue;
    }
    others[size + ", the calibration that they are " + FormatPixelSpacing(known)].push_back(i);
    if (this->Options.DropInvalid)
    {
      this->Result.Status[i] |= Sweep::PoseInvalid;
      if (posed)
      {
        this->Result.ImageToReference[i] = NoPose();
      }
    }
  }
  if (!unreadable.empty())
  {
    this->Warn(ListFrames(unreadable, " in ") +
      ", which is no size of a pixel: nothing tells whether the scanner's depth was that of the "
      "calibration");
  }
  if (!others.empty())
  {
    this->Warn(ListFrames(others, ", in ") +
      ". The scanner had another depth than the calibration. " +
      (this->Options.DropInvalid
          ? "These slices are flagged as pose invalid (1); give the calibration of their depth"
          : "These slices are placed by it all the same, since DropInvalidSlices is off"));
  }
  if (said.size() > 1 && others.empty() && this->Result.ImageToReference.empty())
  {
    this->Warn(
      ListFrames(said, " in ") + ". The scanner's depth was changed: no calibration holds for all");
  }
}

//------------------------------------------------------------------------------
// A calibration holds for one setting of the scanner.
void SweepBuilder::CheckSettings()
{
  for (const char* name : Settings)
  {
    const auto* texts = this->FindField(name);
    std::map<std::string, std::vector<std::size_t>> values;
    for (std::size_t i = 0; texts && i < texts->size(); ++i)
    {
      if (!(*texts)[i].empty())
      {
        values["'" + (*texts)[i].substr(0, LongestQuotation) + "'"].push_back(i);
      }
    }
    if (values.size() > 1)
    {
      this->Warn(std::string("field ") + name + " changes: " + ListFrames(values, " in ") +
        ". A calibration holds for one setting of the scanner only");
    }
  }
}

//------------------------------------------------------------------------------
void SweepBuilder::DescribeChain(const Chain& chain)
{
  this->Result.Chain = this->ImageFrame;
  bool calibrationUsed = this->Options.CalibrationFileName.empty();
  for (const TransformGraph::Link& link : chain)
  {
    this->Result.Chain += " > " + link.To;
    calibrationUsed = calibrationUsed || this->Transforms.Get(link).FromCalibration;
  }
  if (!calibrationUsed)
  {
    this->Warn("the calibration file is not used: the sequence itself leads from '" +
      this->ImageFrame + "' to '" + this->Options.ReferenceFrame + "' (" + this->Result.Chain +
      ")");
  }
}

//------------------------------------------------------------------------------
// What the file itself calls invalid is no surprise and not reported.
void SweepBuilder::ReportBadFrames(const SweepTransform& transform)
{
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
    else if (!IsPoseStatus((*transform.Status)[i]))
    {
      const std::string& state = (*transform.Status)[i];
      problem = state.empty()               ? "has no status"
        : IdentifiesPatient(transform.Name) ? "has an unknown status"
                                            : "has the unknown status '" + state + "'";
    }
    if (!problem.empty())
    {
      problems[problem].push_back(i);
    }
  }
  if (!problems.empty())
  {
    this->Warn("transform " + transform.Name + " " + ListFrames(problems, " in "));
  }
  if (!transform.Status && !transform.FromHeader)
  {
    this->Warn("field " + transform.Name +
      "TransformStatus is missing in all frames; the transform is taken as valid");
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
