// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSweepTransforms.h"

#include "lacunaCalibrationFile.h"
#include "lacunaGeometryGate.h"
#include "lacunaPatientIdentity.h"
#include "lacunaSequenceFormat.h"
#include "lacunaSequenceText.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

namespace lacuna
{
namespace
{
constexpr std::string_view TransformSuffix = "Transform";
constexpr std::string_view StatusSuffix = "TransformStatus";
constexpr std::size_t MostHeaderTransforms = 16; // each takes room for every frame

bool IsSame(const Matrix4& a, const Matrix4& b)
{
  return std::equal(a.Data(), a.Data() + 16, b.Data());
}

// As ParseMatrix, but a name that stands in place of numbers gets into no message.
std::string ReadTransform(const std::string& field, const std::string& text, Matrix4& matrix)
{
  const std::string wrong = ParseMatrix(text, matrix);
  return wrong.empty() || !IdentifiesPatient(field) ? wrong : "does not have 16 finite numbers";
}
}

//------------------------------------------------------------------------------
Vec3 GetPictureOrigin(const SequenceHeader& header)
{
  Vec3 origin{ 0, 0, 0 };
  for (const auto& [name, text] : header.CustomFields)
  {
    if (name == FirstColumnField || name == FirstRowField)
    {
      std::int64_t value = 0;
      if (!ParseInteger(text, value))
      {
        throw std::runtime_error(header.FileName + ": " + name + " is '" + text +
          "', not the whole number of pixels at which the slices begin in the scanner's picture");
      }
      origin[name == FirstRowField ? 1 : 0] = static_cast<double>(value);
    }
  }
  return origin;
}

//------------------------------------------------------------------------------
bool SweepTransform::IsConstant() const
{
  return std::all_of(this->Matrices.begin(), this->Matrices.end(),
    [&](const Matrix4& matrix) { return IsSame(matrix, this->Matrices[0]); });
}

//------------------------------------------------------------------------------
bool SweepTransform::IsFixed() const
{
  // the vote of Boyer and Moore: what more than half agree on is left over
  const Matrix4* most = nullptr;
  std::size_t votes = 0;
  std::size_t given = 0;
  for (const Matrix4& matrix : this->Matrices)
  {
    if (matrix.IsFinite())
    {
      ++given;
      most = votes == 0 ? &matrix : most;
      votes = IsSame(matrix, *most) ? votes + 1 : votes - 1;
    }
  }
  const auto same = std::count_if(this->Matrices.begin(), this->Matrices.end(),
    [&](const Matrix4& matrix) { return most && IsSame(matrix, *most); });
  return most && 4 * static_cast<std::size_t>(same) >= 3 * given;
}

//------------------------------------------------------------------------------
std::string SweepTransforms::GetTransformName(const std::string& field)
{
  const bool is =
    field.size() > TransformSuffix.size() && EndsWithIgnoringCase(field, TransformSuffix);
  return is ? field.substr(0, field.size() - TransformSuffix.size()) : std::string();
}

//------------------------------------------------------------------------------
SweepTransforms::SweepTransforms(
  const SequenceHeader& header, const std::string& calibrationFileName)
  : HasCalibrationFile(!calibrationFileName.empty())
  , PictureOrigin(GetPictureOrigin(header))
{
  if (this->HasCalibrationFile)
  {
    this->ReadCalibration(calibrationFileName);
  }
  this->ReadFrames(header);
  this->ReadHeader(header);
  this->NameFrames();
  this->ReportUnnamed(header);
}

//------------------------------------------------------------------------------
void SweepTransforms::ReadCalibration(const std::string& fileName)
{
  for (const NamedTransform& named : ReadCalibrationFile(fileName))
  {
    SweepTransform transform;
    transform.Name = named.From + "To" + named.To;
    transform.From = named.From;
    transform.To = named.To;
    transform.FromCalibration = true;
    transform.Matrices.push_back(named.Matrix);
    this->Graph.Add(named.From, named.To, static_cast<int>(this->Transforms.size()));
    this->Transforms.push_back(std::move(transform));
  }
}

//------------------------------------------------------------------------------
void SweepTransforms::ReadFrames(const SequenceHeader& header)
{
  for (const auto& [field, texts] : header.FrameFields)
  {
    SweepTransform transform;
    transform.Name = GetTransformName(field);
    if (transform.Name.empty())
    {
      continue;
    }
    for (const std::string& text : texts)
    {
      Matrix4 matrix;
      transform.Errors.push_back(text.empty() ? "is missing" : ReadTransform(field, text, matrix));
      transform.Matrices.push_back(transform.Errors.back().empty() ? matrix : NoPose());
    }
    const std::string status = transform.Name + std::string(StatusSuffix);
    // fields stand by their names
    for (auto other = header.FrameFields.lower_bound(transform.Name);
         other != header.FrameFields.end() &&
         other->first.compare(0, transform.Name.size(), transform.Name) == 0;
         ++other)
    {
      if (EqualsIgnoringCase(other->first, status))
      {
        transform.Status = &other->second;
      }
    }
    this->Transforms.push_back(std::move(transform));
  }
}

//------------------------------------------------------------------------------
// A transform of the header holds for every frame, unless frames have their own.
void SweepTransforms::ReadHeader(const SequenceHeader& header)
{
  std::size_t count = 0;
  for (const auto& [field, text] : header.CustomFields)
  {
    SweepTransform transform;
    transform.Name = GetTransformName(field);
    Matrix4 matrix;
    if (transform.Name.empty())
    {
      continue;
    }
    if (++count > MostHeaderTransforms)
    {
      this->Warnings.push_back("the header has more than " + std::to_string(MostHeaderTransforms) +
        " transforms; the others are kept but not used in chains");
      return;
    }
    const std::string wrong = ReadTransform(field, text, matrix);
    const auto known = std::find_if(this->Transforms.begin(), this->Transforms.end(),
      [&](const SweepTransform& other)
      { return !other.FromCalibration && other.Name == transform.Name; });
    const auto status = std::find_if(header.CustomFields.begin(), header.CustomFields.end(),
      [&](const auto& other)
      { return EqualsIgnoringCase(other.first, transform.Name + std::string(StatusSuffix)); });
    if (known != this->Transforms.end())
    {
      this->Warnings.push_back(
        "transform " + transform.Name + " of the header is not used: the frames have their own");
    }
    else if (!wrong.empty())
    {
      this->Warnings.push_back("transform " + transform.Name + " of the header " + wrong);
    }
    else if (status != header.CustomFields.end() && status->second != "OK")
    {
      this->Warnings.push_back("transform " + transform.Name +
        " of the header is not used: its status is " +
        (IsPoseStatus(status->second) ? "'" + status->second + "', " : "") + "not OK");
    }
    else
    {
      transform.FromHeader = true;
      transform.Matrices.assign(static_cast<std::size_t>(header.Frames), matrix);
      transform.Errors.resize(transform.Matrices.size());
      this->Transforms.push_back(std::move(transform));
    }
  }
}

//------------------------------------------------------------------------------
// Sixteen numbers under another name might be the transform that is missed.
void SweepTransforms::ReportUnnamed(const SequenceHeader& header)
{
  std::vector<std::string> names;
  const auto add = [&](const std::string& name, const std::string& text)
  {
    Matrix4 matrix;
    if (GetTransformName(name).empty() && ParseMatrix(text, matrix).empty())
    {
      names.push_back(name);
    }
  };
  for (const auto& [name, text] : header.CustomFields)
  {
    add(name, text);
  }
  for (const auto& [name, texts] : header.FrameFields)
  {
    const auto text =
      std::find_if(texts.begin(), texts.end(), [](const std::string& one) { return !one.empty(); });
    add(name, text == texts.end() ? std::string() : *text);
  }
  if (!names.empty())
  {
    this->Warnings.push_back("fields that have 16 numbers as a transform has, but a name that does "
                             "not end in Transform, are kept but not used in chains: " +
      JoinSome(names));
  }
}

//------------------------------------------------------------------------------
// Enters the sequence's transforms in the graph. A name like AToBToC can be read in two ways: the
// frames that other transforms mention decide.
void SweepTransforms::NameFrames()
{
  std::vector<std::size_t> ambiguous;
  std::vector<std::string> unused;
  for (std::size_t i = 0; i < this->Transforms.size(); ++i)
  {
    if (this->Transforms[i].FromCalibration)
    {
      continue;
    }
    const auto readings = ReadTransformName(this->Transforms[i].Name);
    if (readings.size() > 1)
    {
      ambiguous.push_back(i);
    }
    else if (readings.empty() || !this->Enter(i, readings[0].first, readings[0].second))
    {
      unused.push_back(this->Transforms[i].Name);
    }
  }
  const TransformGraph certain = this->Graph;
  for (const std::size_t i : ambiguous)
  {
    auto readings = ReadTransformName(this->Transforms[i].Name);
    const auto end = std::remove_if(readings.begin(), readings.end(),
      [&](const auto& reading)
      { return !certain.HasFrame(reading.first) || !certain.HasFrame(reading.second); });
    readings.erase(end, readings.end());
    if (readings.size() != 1 || !this->Enter(i, readings[0].first, readings[0].second))
    {
      unused.push_back(this->Transforms[i].Name);
    }
  }
  if (!unused.empty())
  {
    this->Warnings.push_back("transforms whose names do not read as one pair of frames, "
                             "<From>To<To>, are kept but not used in chains: " +
      JoinSome(unused));
  }
}

//------------------------------------------------------------------------------
// Whether all matrices of one are the one of the other, but for the rounding of decimal numbers.
bool SweepTransforms::IsSame(
  const SweepTransform& transform, const SweepTransform& constant, bool forwards)
{
  const Matrix4 wanted = forwards ? constant.Matrices[0] : constant.Matrices[0].Inverse();
  return std::all_of(transform.Matrices.begin(), transform.Matrices.end(),
    [&](const Matrix4& matrix)
    {
      return std::equal(matrix.Data(), matrix.Data() + 16, wanted.Data(),
        [](double a, double b) { return std::abs(a - b) <= 1e-9 * std::max(1.0, std::abs(b)); });
    });
}

//------------------------------------------------------------------------------
// From the file's pixels to those of the whole picture.
void SweepTransforms::RelateToPicture(
  SweepTransform& transform, const std::string& from, const std::string& to)
{
  const std::string image = "Image";
  if (this->PictureOrigin == Vec3{ 0, 0, 0 } || (from != image && to != image))
  {
    return;
  }
  const Matrix4 pixelToImage = Matrix4::Translation(this->PictureOrigin);
  const Matrix4 imageToPixel = pixelToImage.Inverse();
  for (Matrix4& matrix : transform.Matrices)
  {
    matrix = from == image ? matrix * imageToPixel : pixelToImage * matrix;
  }
}

//------------------------------------------------------------------------------
bool SweepTransforms::Enter(std::size_t transform, const std::string& from, const std::string& to)
{
  if (from == to)
  {
    return false;
  }
  this->RelateToPicture(this->Transforms[transform], from, to);
  for (const SweepTransform& other : this->Transforms)
  {
    if (!other.FromCalibration) // those of the calibration stand first
    {
      break;
    }
    if ((other.From == from && other.To == to) || (other.From == to && other.To == from))
    {
      if (!this->IsSame(this->Transforms[transform], other, from == other.From))
      {
        this->Warnings.push_back("transform " + this->Transforms[transform].Name +
          " of the sequence is replaced by " + other.Name + " of the calibration file");
      }
      return true;
    }
  }
  this->Transforms[transform].From = from;
  this->Transforms[transform].To = to;
  this->Graph.Add(from, to, static_cast<int>(transform));
  return true;
}

//------------------------------------------------------------------------------
bool SweepTransforms::Compose(
  const std::vector<TransformGraph::Link>& chain, std::size_t frame, Matrix4& product) const
{
  product = Matrix4();
  try
  {
    for (const TransformGraph::Link& link : chain)
    {
      const Matrix4& matrix = this->Get(link).Get(frame);
      const Matrix4 inverse = matrix.Inverse(); // also tells whether it is usable at all
      product = (link.Inverse ? inverse : matrix) * product;
    }
  }
  catch (const std::invalid_argument&)
  {
    product = NoPose();
  }
  return product.IsFinite();
}

//------------------------------------------------------------------------------
std::string SweepTransforms::Describe() const
{
  std::vector<std::string> ofSequence;
  std::vector<std::string> ofCalibration;
  for (const SweepTransform& transform : this->Transforms)
  {
    (transform.FromCalibration ? ofCalibration : ofSequence).push_back(transform.Name);
  }
  return "Transforms of the sequence: " +
    (ofSequence.empty() ? std::string("none") : JoinSome(ofSequence, 20)) +
    "; of the calibration file: " +
    (this->HasCalibrationFile ? JoinSome(ofCalibration, 20) : std::string("no file given")) + ".";
}
}
