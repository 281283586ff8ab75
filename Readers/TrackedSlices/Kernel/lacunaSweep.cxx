// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSweep.h"

#include "lacunaCalibrationFile.h"
#include "lacunaSequenceText.h"
#include "lacunaTransformGraph.h"

#include <algorithm>
#include <climits>
#include <cstring>
#include <limits>
#include <set>
#include <stdexcept>

namespace lacuna
{
namespace
{
constexpr std::string_view TransformSuffix = "Transform";
constexpr std::string_view StatusSuffix = "TransformStatus";
// Arrays of tracked slices with a meaning of their own.
const std::set<std::string> ReservedNames = { "ImageToReference", "ImageToProbe" };

Matrix4 NoMatrix()
{
  std::array<double, 16> elements;
  elements.fill(std::numeric_limits<double>::quiet_NaN());
  return Matrix4(elements);
}

std::string FrameList(const std::vector<std::size_t>& frames)
{
  std::vector<std::string> numbers;
  std::transform(frames.begin(), frames.end(), std::back_inserter(numbers),
    [](std::size_t frame) { return std::to_string(frame); });
  return (frames.size() > 1 ? "frames " : "frame ") + JoinSome(numbers);
}

// One transform that may be a link: constant, or one matrix for each frame.
struct Transform
{
  std::string Name;
  std::string From;
  std::string To;
  bool FromCalibration = false;
  Matrix4 Constant;
  std::vector<Matrix4> Matrices;
  std::vector<std::string> Errors; ///< what is wrong with each frame's text; empty: nothing
  const std::vector<std::string>* Status = nullptr;

  bool IsConstant() const
  {
    return this->FromCalibration ||
      std::all_of(this->Matrices.begin(), this->Matrices.end(),
        [&](const Matrix4& m)
        { return std::memcmp(m.Data(), this->Matrices[0].Data(), 16 * sizeof(double)) == 0; });
  }
  const Matrix4& Get(std::size_t frame) const
  {
    return this->FromCalibration ? this->Constant : this->Matrices[frame];
  }
};

class SweepBuilder
{
public:
  SweepBuilder(const SequenceHeader& header, const SweepOptions& options)
    : Header(header)
    , Options(options)
    , Count(static_cast<std::size_t>(header.Frames))
  {
  }

  Sweep Build()
  {
    this->Result.Status.assign(this->Count, Sweep::Valid);
    this->ReadCalibration();
    this->ReadTransforms();
    this->ReadTimes();
    this->FlagImages();
    this->FindImageToProbe();
    this->BuildPoses();
    const bool none = std::none_of(this->Result.Status.begin(), this->Result.Status.end(),
      [](unsigned char status) { return status == Sweep::Valid; });
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
  const Transform& Get(const TransformGraph::Link& link) const
  {
    return this->Transforms[static_cast<std::size_t>(link.Transform)];
  }

  void ReadCalibration();
  void ReadTransforms();
  void ParseTransform(const std::string& name, const std::vector<std::string>& texts);
  void NameFrames();
  void ReadTimes();
  void FlagImages();
  void FindImageToProbe();
  bool FindChain(Chain& chain);
  std::string DescribeTransforms() const;
  void BuildPoses();
  bool Compose(const Chain& chain, std::size_t frame, Matrix4& pose);
  void ReportBadFrames(const Chain& chain);

  const SequenceHeader& Header;
  const SweepOptions& Options;
  std::size_t Count;
  Sweep Result;
  std::vector<Transform> Transforms; ///< the calibration's first: they win among equal chains
  TransformGraph Graph;
};

//------------------------------------------------------------------------------
void SweepBuilder::ReadCalibration()
{
  if (this->Options.CalibrationFileName.empty())
  {
    return;
  }
  for (const NamedTransform& named : ReadCalibrationFile(this->Options.CalibrationFileName))
  {
    Transform transform;
    transform.Name = named.From + "To" + named.To;
    transform.From = named.From;
    transform.To = named.To;
    transform.FromCalibration = true;
    transform.Constant = named.Matrix;
    this->Graph.Add(named.From, named.To, static_cast<int>(this->Transforms.size()));
    this->Transforms.push_back(std::move(transform));
  }
}

//------------------------------------------------------------------------------
void SweepBuilder::ReadTransforms()
{
  for (const auto& [name, texts] : this->Header.FrameFields)
  {
    const bool isTransform =
      name.size() > TransformSuffix.size() && EndsWithIgnoringCase(name, TransformSuffix);
    if (isTransform)
    {
      this->ParseTransform(name.substr(0, name.size() - TransformSuffix.size()), texts);
    }
    const bool reserved =
      isTransform && ReservedNames.count(name.substr(0, name.size() - TransformSuffix.size())) > 0;
    if (!isTransform || reserved)
    {
      this->Result.TextFields[name] = texts;
    }
  }
  for (const auto& [name, texts] : this->Header.FrameFields)
  {
    for (Transform& transform : this->Transforms)
    {
      if (name.size() == transform.Name.size() + StatusSuffix.size() &&
        name.compare(0, transform.Name.size(), transform.Name) == 0 &&
        EndsWithIgnoringCase(name, StatusSuffix))
      {
        transform.Status = &texts;
      }
    }
  }
  this->NameFrames();
}

//------------------------------------------------------------------------------
void SweepBuilder::ParseTransform(const std::string& name, const std::vector<std::string>& texts)
{
  Transform transform;
  transform.Name = name;
  transform.Matrices.assign(this->Count, NoMatrix());
  transform.Errors.resize(this->Count);
  for (std::size_t i = 0; i < this->Count; ++i)
  {
    Matrix4 matrix;
    transform.Errors[i] = texts[i].empty() ? "is missing" : ParseMatrix(texts[i], matrix);
    if (transform.Errors[i].empty())
    {
      transform.Matrices[i] = matrix;
    }
  }
  if (ReservedNames.count(name) == 0)
  {
    this->Result.Transforms[name] = transform.Matrices;
  }
  this->Transforms.push_back(std::move(transform));
}

//------------------------------------------------------------------------------
// Enters the file's transforms in the graph. A name like AToBToC can be read in two ways: the
// frames that other transforms mention decide.
void SweepBuilder::NameFrames()
{
  const auto add = [&](std::size_t i, const std::pair<std::string, std::string>& reading)
  {
    Transform& transform = this->Transforms[i];
    transform.From = reading.first;
    transform.To = reading.second;
    const bool replaced = std::any_of(this->Transforms.begin(), this->Transforms.end(),
      [&](const Transform& other)
      {
        return other.FromCalibration &&
          ((other.From == transform.From && other.To == transform.To) ||
            (other.From == transform.To && other.To == transform.From));
      });
    if (replaced)
    {
      this->Warn("the calibration file replaces transform " + transform.Name + " of the sequence");
    }
    else if (transform.From != transform.To)
    {
      this->Graph.Add(transform.From, transform.To, static_cast<int>(i));
    }
  };
  std::vector<std::size_t> ambiguous;
  std::vector<std::string> unused;
  for (std::size_t i = 0; i < this->Transforms.size(); ++i)
  {
    if (this->Transforms[i].FromCalibration)
    {
      continue;
    }
    const auto readings = ReadTransformName(this->Transforms[i].Name);
    if (readings.size() == 1)
    {
      add(i, readings[0]);
    }
    else if (readings.empty())
    {
      unused.push_back(this->Transforms[i].Name);
    }
    else
    {
      ambiguous.push_back(i);
    }
  }
  const TransformGraph certain = this->Graph;
  for (const std::size_t i : ambiguous)
  {
    auto readings = ReadTransformName(this->Transforms[i].Name);
    readings.erase(std::remove_if(readings.begin(), readings.end(),
                     [&](const auto& reading) {
                       return !certain.HasFrame(reading.first) || !certain.HasFrame(reading.second);
                     }),
      readings.end());
    if (readings.size() == 1)
    {
      add(i, readings[0]);
    }
    else
    {
      unused.push_back(this->Transforms[i].Name);
    }
  }
  if (!unused.empty())
  {
    this->Warn("transforms whose names do not read as one pair of frames, <From>To<To>, are kept "
               "but not used in chains: " +
      JoinSome(unused));
  }
}

//------------------------------------------------------------------------------
void SweepBuilder::ReadTimes()
{
  const auto times = this->Header.FrameFields.find("Timestamp");
  if (times != this->Header.FrameFields.end())
  {
    std::vector<std::size_t> missing;
    this->Result.Timestamps.resize(this->Count);
    for (std::size_t i = 0; i < this->Count; ++i)
    {
      double& time = this->Result.Timestamps[i];
      if (!ParseNumber(times->second[i], time) || !std::isfinite(time))
      {
        time = std::numeric_limits<double>::quiet_NaN();
        missing.push_back(i);
      }
    }
    if (!missing.empty())
    {
      this->Warn("field Timestamp is missing or not a finite number in " + FrameList(missing));
    }
    this->Result.TextFields.erase("Timestamp");
  }
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
  const auto states = this->Header.FrameFields.find("ImageStatus");
  for (std::size_t i = 0; i < this->Count; ++i)
  {
    const bool stated = states != this->Header.FrameFields.end() && !states->second[i].empty();
    const bool refused = stated && states->second[i] != "OK" && this->Options.DropInvalid;
    const bool absent = this->Options.FramesWithPixels >= 0 &&
      static_cast<std::int64_t>(i) >= this->Options.FramesWithPixels;
    if (refused || absent)
    {
      this->Result.Status[i] |= Sweep::ImageInvalid;
    }
  }
}

//------------------------------------------------------------------------------
void SweepBuilder::FindImageToProbe()
{
  Chain chain;
  Matrix4 product;
  if (!this->Graph.FindChain(this->Options.ImageFrame, "Probe", chain) || chain.empty())
  {
    return;
  }
  for (const TransformGraph::Link& link : chain)
  {
    const Transform& transform = this->Get(link);
    if (!transform.IsConstant())
    {
      return;
    }
  }
  if (this->Compose(chain, 0, product))
  {
    this->Result.ImageToProbe.push_back(product);
  }
}

//------------------------------------------------------------------------------
std::string SweepBuilder::DescribeTransforms() const
{
  std::vector<std::string> ofFile;
  std::vector<std::string> ofCalibration;
  for (const Transform& transform : this->Transforms)
  {
    (transform.FromCalibration ? ofCalibration : ofFile).push_back(transform.Name);
  }
  std::string text =
    "Transforms of the sequence: " + (ofFile.empty() ? "none" : JoinSome(ofFile, 20)) +
    "; of the calibration file: ";
  return text +
    (this->Options.CalibrationFileName.empty() ? "no file given" : JoinSome(ofCalibration, 20)) +
    ".";
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
  if (this->Graph.FindChain(image, reference, chain))
  {
    return true;
  }
  if (!this->Graph.HasFrame(image))
  {
    const std::string none = "no transform leads from or to the image frame '" + image + "'. ";
    if (!this->Options.CalibrationFileName.empty())
    {
      this->Fail(none +
        "Set ImageFrame to the frame that the calibration is for, or give another "
        "CalibrationFileName. " +
        this->DescribeTransforms());
    }
    this->Warn(none +
      "The slices are read without ImageToReference: filters that need positions will refuse them. "
      "Give the CalibrationFileName that holds " +
      image + " to Probe. " + this->DescribeTransforms());
    return false;
  }
  const std::string reached = JoinSome(this->Graph.GetReachable(image), 20);
  if (!this->Graph.HasFrame(reference))
  {
    this->Fail("no transform leads from or to the reference frame '" + reference + "'. From '" +
      image + "' these frames can be reached: " + reached +
      ". Set ReferenceFrame to one that does not move with the probe. " +
      this->DescribeTransforms());
  }
  this->Fail("the chain of transforms from '" + image + "' to '" + reference +
    "' has a missing link: one is needed between a frame of the first group (" + reached +
    ") and one of the second (" + JoinSome(this->Graph.GetReachable(reference), 20) + "). " +
    this->DescribeTransforms());
}

//------------------------------------------------------------------------------
bool SweepBuilder::Compose(const Chain& chain, std::size_t frame, Matrix4& pose)
{
  Matrix4 product;
  try
  {
    for (const TransformGraph::Link& link : chain)
    {
      const Matrix4& matrix = this->Get(link).Get(frame);
      const Matrix4 inverse = matrix.Inverse(); // also tells whether it is affine and regular
      product = (link.Inverse ? inverse : matrix) * product;
    }
  }
  catch (const std::invalid_argument&)
  {
    return false;
  }
  pose = product;
  return product.IsFinite();
}

//------------------------------------------------------------------------------
void SweepBuilder::BuildPoses()
{
  Chain chain;
  const bool calibrated = this->FindChain(chain);
  if (calibrated)
  {
    this->Result.Chain = this->Options.ImageFrame;
    for (const TransformGraph::Link& link : chain)
    {
      this->Result.Chain += " > " + (link.Inverse ? this->Get(link).From : this->Get(link).To);
    }
    if (!this->Options.CalibrationFileName.empty() &&
      std::none_of(chain.begin(), chain.end(),
        [&](const TransformGraph::Link& link) { return this->Get(link).FromCalibration; }))
    {
      this->Warn("the calibration file is not used: the sequence itself leads from '" +
        this->Options.ImageFrame + "' to '" + this->Options.ReferenceFrame + "' (" +
        this->Result.Chain + ")");
    }
    this->Result.ImageToReference.assign(this->Count, NoMatrix());
  }
  else if (!this->Graph.FindChain("Probe", this->Options.ReferenceFrame, chain))
  {
    return; // no pose to judge
  }
  for (std::size_t i = 0; i < this->Count; ++i)
  {
    const bool refused = this->Options.DropInvalid &&
      std::any_of(chain.begin(), chain.end(),
        [&](const TransformGraph::Link& link)
        {
          const Transform& transform = this->Get(link);
          return transform.Status && (*transform.Status)[i] != "OK";
        });
    Matrix4 pose;
    if (refused || !this->Compose(chain, i, pose))
    {
      this->Result.Status[i] |= Sweep::PoseInvalid;
    }
    else if (calibrated)
    {
      this->Result.ImageToReference[i] = pose;
    }
  }
  this->ReportBadFrames(chain);
}

//------------------------------------------------------------------------------
void SweepBuilder::ReportBadFrames(const Chain& chain)
{
  const std::set<std::string> states = { "OK", "MISSING", "OUT_OF_VIEW", "OUT_OF_VOLUME",
    "SWITCH1_IS_ON", "SWITCH2_IS_ON", "SWITCH3_IS_ON", "REQ_TIMEOUT", "INVALID", "PATH_NOT_FOUND",
    "UNKNOWN" };
  for (const TransformGraph::Link& link : chain)
  {
    const Transform& transform = this->Get(link);
    if (transform.FromCalibration)
    {
      continue;
    }
    std::map<std::string, std::vector<std::size_t>> frames;
    for (std::size_t i = 0; i < this->Count; ++i)
    {
      const std::string state = transform.Status ? (*transform.Status)[i] : "OK";
      const bool asExpected = states.count(state) > 0;
      if (!asExpected)
      {
        frames["TransformStatus is '" + state + "', which is not a known state,"].push_back(i);
      }
      if (state != "OK" && asExpected)
      {
        continue; // the file itself says that there is nothing to expect
      }
      std::string wrong = transform.Errors[i];
      try
      {
        if (wrong.empty())
        {
          transform.Matrices[i].Inverse();
        }
      }
      catch (const std::invalid_argument& e)
      {
        wrong = std::string("cannot be used (") + e.what() + ")";
      }
      if (!wrong.empty())
      {
        frames["Transform " + wrong].push_back(i);
      }
    }
    for (const auto& [problem, list] : frames)
    {
      this->Warn("field " + transform.Name + problem + " in " + FrameList(list));
    }
    if (!transform.Status)
    {
      this->Warn("field " + transform.Name +
        "TransformStatus is missing in all frames; the transform is taken as valid");
    }
  }
}
}

Sweep BuildSweep(const SequenceHeader& header, const SweepOptions& options)
{
  return SweepBuilder(header, options).Build();
}
}
