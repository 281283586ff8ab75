// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaPoseTable.h"

#include "lacunaGeometryGate.h"
#include "lacunaItemList.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

namespace lacuna
{
namespace
{
using Quaternion = std::array<double, 4>; // x y z w

bool IsPoseOfImage(const PoseTableOptions& options)
{
  return options.Transform == PoseTransform::ImageToReference ||
    options.Transform == PoseTransform::ReferenceToImage;
}

bool HasPixelSpacing(const PoseTableOptions& options)
{
  return options.PixelSpacing[0] != 0 || options.PixelSpacing[1] != 0;
}

// True when the matrices hold the size of a pixel.
bool IsScaled(const PoseTableOptions& options)
{
  return IsPoseOfImage(options) && !HasPixelSpacing(options);
}

Vec3 GetLengths(const Matrix4& m)
{
  return { Norm(m.Column(0)), Norm(m.Column(1)), Norm(m.Column(2)) };
}

// The size of a pixel that is given twice may be rounded.
bool IsOne(double length)
{
  return std::abs(length - 1) <= 0.01;
}

std::string Join(const Vec3& v, int count = 3)
{
  std::ostringstream text;
  for (int i = 0; i < count; ++i)
  {
    text << (i ? (i + 1 < count ? ", " : " and ") : "") << v[i];
  }
  return text.str();
}

std::string Describe(const GeometryFinding& finding)
{
  return "it " + finding.Text + "; " + finding.Advice;
}

Matrix4 ToMatrix(const Quaternion& q, const Vec3& position)
{
  const double x = q[0];
  const double y = q[1];
  const double z = q[2];
  const double w = q[3];
  return Matrix4({ 1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), position[0],
    2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w), position[1],
    2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y), position[2], 0, 0, 0, 1 });
}

// Of a rotation; the largest of the four parts is found first, so that no digits are lost.
Quaternion ToQuaternion(const Matrix4& r)
{
  const double trace = r(0, 0) + r(1, 1) + r(2, 2);
  int largest = 3;
  double most = trace;
  for (int i = 0; i < 3; ++i)
  {
    if (r(i, i) > most)
    {
      largest = i;
      most = r(i, i);
    }
  }
  Quaternion q;
  if (largest == 3)
  {
    q = { r(2, 1) - r(1, 2), r(0, 2) - r(2, 0), r(1, 0) - r(0, 1), 1 + trace };
  }
  else
  {
    const int i = largest;
    const int j = (i + 1) % 3;
    const int k = (i + 2) % 3;
    q[i] = 1 + r(i, i) - r(j, j) - r(k, k);
    q[j] = r(i, j) + r(j, i);
    q[k] = r(i, k) + r(k, i);
    q[3] = r(k, j) - r(j, k);
  }
  const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  for (double& part : q)
  {
    part /= norm;
  }
  return q;
}

// One row as a transform in the table's unit. False when there is none. finding: of a quaternion.
bool ReadRow(
  const double* row, std::size_t count, PoseFormat format, Matrix4& pose, GeometryFinding& finding)
{
  if (!std::all_of(row, row + count, [](double v) { return std::isfinite(v); }))
  {
    return false;
  }
  if (format == PoseFormat::Matrix)
  {
    std::array<double, 16> elements{ 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1 };
    std::copy(row, row + count, elements.begin());
    pose = Matrix4(elements);
    const Vec3 lengths = GetLengths(pose);
    return lengths[0] != 0 || lengths[1] != 0 || lengths[2] != 0;
  }
  const Vec3 position{ row[0], row[1], row[2] };
  if (format == PoseFormat::Quaternion)
  {
    Quaternion q{ row[3], row[4], row[5], row[6] };
    const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    if (norm == 0)
    {
      return false;
    }
    finding = CheckQuaternion(norm);
    for (double& part : q)
    {
      part /= norm;
    }
    pose = ToMatrix(q, position);
    return true;
  }
  const double radians = std::acos(-1.0) / 180;
  pose = Matrix4::Translation(position) * Matrix4::Rotation({ 0, 0, 1 }, row[3] * radians) *
    Matrix4::Rotation({ 0, 1, 0 }, row[4] * radians) *
    Matrix4::Rotation({ 1, 0, 0 }, row[5] * radians);
  return true;
}

// The transform of a row as it is used, in mm, and what is wrong with it.
GeometryFinding Convert(Matrix4& pose, const PoseTableOptions& options)
{
  const bool scaled = IsScaled(options);
  const Matrix4 written = pose;
  if (options.Transform == PoseTransform::ReferenceToProbe ||
    options.Transform == PoseTransform::ReferenceToImage)
  {
    try
    {
      pose = pose.Inverse();
    }
    catch (const std::invalid_argument&)
    {
      return scaled ? CheckImage(written) : CheckPose(written);
    }
  }
  const double mm = GetMillimetres(options.Unit);
  for (int r = 0; r < 3; ++r)
  {
    for (int c = scaled ? 0 : 3; c < 4; ++c)
    {
      pose(r, c) *= mm;
    }
  }
  GeometryFinding finding = scaled ? CheckImage(pose) : CheckPose(pose);
  if (finding.Fault == GeometryFault::NotRigid)
  {
    finding.Advice += "; where the matrices map pixels, set PoseTransform to ImageToReference and "
                      "PixelSpacing to 0";
  }
  return finding;
}

// Pixel sizes that some matrix has, against those that another one has.
void CheckPixelSizes(const Vec3& first, std::size_t firstRow, const Vec3& lengths, std::size_t row)
{
  for (int i = 0; i < 2; ++i)
  {
    if (!(IsOne(lengths[i] / first[i])))
    {
      throw std::runtime_error("the poses have pixels of " + Join(first, 2) + " mm in row " +
        std::to_string(firstRow) + " but of " + Join(lengths, 2) + " mm in row " +
        std::to_string(row) + "; the size of a pixel must be the same in all");
    }
  }
}

// A row's pose as it is used; false where there is none. finding: what is wrong with it.
bool ReadPose(const double* row, std::size_t count, const PoseTableOptions& options, Matrix4& pose,
  GeometryFinding& finding)
{
  if (!ReadRow(row, count, options.Format, pose, finding))
  {
    return false;
  }
  const GeometryFinding converted = Convert(pose, options);
  finding = GetAction(GeometryOrigin::Table, finding.Fault) < GeometryAction::Flag && converted
    ? converted
    : finding;
  return true;
}

// Rows of a table that are not as they should be.
struct OddRows
{
  std::vector<std::size_t> Stated;
  std::vector<std::size_t> Missing;
  std::vector<std::size_t> Zero;
  std::vector<std::size_t> Faulty;
  std::string FirstFault;
  std::vector<std::size_t> Doubtful;
  std::string FirstDoubt;

  std::vector<std::string> Describe() const
  {
    std::vector<std::string> warnings;
    if (!this->Stated.empty())
    {
      warnings.push_back("the pose in " + DescribeItems("row", this->Stated) +
        " is not valid by its state; flagged in SliceStatus");
    }
    if (!this->Missing.empty())
    {
      warnings.push_back("there is no pose in " + DescribeItems("row", this->Missing) +
        " (numbers are missing or not finite, or all zero); flagged in SliceStatus");
    }
    if (!this->Zero.empty())
    {
      warnings.push_back("all numbers are 0 in " + DescribeItems("row", this->Zero) +
        ": taken as a pose. If these rows are empty, write nan: ParaView reads empty cells as 0");
    }
    if (!this->Faulty.empty())
    {
      warnings.push_back("what is in " + DescribeItems("row", this->Faulty) +
        " is no pose (the first one: " + this->FirstFault + "); flagged in SliceStatus");
    }
    if (!this->Doubtful.empty())
    {
      warnings.push_back("the pose in " + DescribeItems("row", this->Doubtful) +
        " may be wrong (the first one: " + this->FirstDoubt + "); it is used");
    }
    return warnings;
  }
};
}

//------------------------------------------------------------------------------
PoseTable ReadPoseTable(const std::vector<double>& numbers, std::size_t count,
  const std::vector<char>& refused, const PoseTableOptions& options)
{
  const std::size_t rows = count > 0 ? numbers.size() / count : 0;
  PoseTable table;
  table.ToReference.assign(rows, NoPose());
  table.Usable.assign(rows, 0);
  OddRows odd;
  Vec3 sizes{};
  std::size_t first = rows;
  for (std::size_t i = 0; i < rows; ++i)
  {
    if (!refused.empty() && refused[i])
    {
      odd.Stated.push_back(i);
      continue;
    }
    const double* row = numbers.data() + i * count;
    Matrix4 pose;
    GeometryFinding finding;
    if (!ReadPose(row, count, options, pose, finding))
    {
      odd.Missing.push_back(i);
      continue;
    }
    const GeometryAction action = GetAction(GeometryOrigin::Table, finding.Fault);
    if (action >= GeometryAction::Flag)
    {
      if (action == GeometryAction::Refuse && !options.SkipInvalid)
      {
        throw std::runtime_error(
          "the pose in row " + std::to_string(i) + " is none: " + Describe(finding));
      }
      odd.FirstFault = odd.Faulty.empty() ? Describe(finding) : odd.FirstFault;
      odd.Faulty.push_back(i);
      continue;
    }
    if (action == GeometryAction::Warn)
    {
      odd.FirstDoubt = odd.Doubtful.empty() ? Describe(finding) : odd.FirstDoubt;
      odd.Doubtful.push_back(i);
    }
    if (IsScaled(options))
    {
      const Vec3 lengths = GetLengths(pose);
      sizes = first == rows ? lengths : sizes;
      CheckPixelSizes(sizes, first == rows ? i : first, lengths, i);
    }
    // poses are often counted from the first one, but hardly come back to it to the last digit
    if (options.Format == PoseFormat::Euler && i > 0 &&
      std::all_of(row, row + count, [](double v) { return v == 0; }))
    {
      odd.Zero.push_back(i);
    }
    first = std::min(first, i);
    table.ToReference[i] = pose;
    table.Usable[i] = 1;
  }
  const double mm = GetMillimetres(options.Unit);
  if (IsScaled(options) && first < rows && IsOne(sizes[0] / mm) && IsOne(sizes[1] / mm))
  {
    throw std::runtime_error(
      "the size of a pixel is not known: the matrices are rigid; set PixelSpacing");
  }
  table.Warnings = odd.Describe();
  return table;
}

//------------------------------------------------------------------------------
PoseChain MakePoseChain(const PoseTableOptions& options)
{
  const Vec2& spacing = options.PixelSpacing;
  if (HasPixelSpacing(options) &&
    !(spacing[0] > 0 && spacing[1] > 0 && std::isfinite(spacing[0]) && std::isfinite(spacing[1])))
  {
    std::ostringstream message;
    message << "PixelSpacing is " << spacing[0] << " " << spacing[1]
            << "; it must be mm above 0, or 0 where the matrices hold the size of a pixel";
    throw std::runtime_error(message.str());
  }
  if (HasPixelSpacing(options))
  {
    const GeometryFinding finding =
      CheckImage(Matrix4::Scaling({ spacing[0], spacing[1], std::sqrt(spacing[0] * spacing[1]) }));
    if (GetAction(GeometryOrigin::Settings, finding.Fault) == GeometryAction::Refuse)
    {
      throw std::runtime_error("PixelSpacing " + finding.Text + "; " + finding.Advice);
    }
  }
  PoseChain chain;
  const Matrix4 identity;
  const bool known =
    !std::equal(identity.Data(), identity.Data() + 16, options.ImageToProbe.Data());
  const bool spaced = HasPixelSpacing(options);
  const Matrix4 toMillimetres = spaced
    ? Matrix4::Scaling({ spacing[0], spacing[1], std::sqrt(spacing[0] * spacing[1]) })
    : identity;
  if (known)
  {
    const GeometryFinding finding = CheckImage(options.ImageToProbe);
    const GeometryAction action = GetAction(GeometryOrigin::Settings, finding.Fault);
    if (action == GeometryAction::Refuse)
    {
      throw std::runtime_error("ImageToProbe is no calibration: " + Describe(finding));
    }
    if (action == GeometryAction::Warn)
    {
      chain.Warning = "ImageToProbe may be wrong: " + Describe(finding) + "; it is used";
    }
    const Vec3 lengths = GetLengths(options.ImageToProbe);
    const bool rigid = IsOne(lengths[0]) && IsOne(lengths[1]);
    const bool repeated =
      spaced && IsOne(lengths[0] / spacing[0]) && IsOne(lengths[1] / spacing[1]);
    if (spaced && !rigid && !repeated)
    {
      throw std::runtime_error(
        "the size of a pixel is given twice and differently: PixelSpacing, " +
        Join({ spacing[0], spacing[1], 0 }, 2) + " mm, and the lengths of the columns of " +
        "ImageToProbe, " + Join(lengths, 2) +
        "; set PixelSpacing to 0, or make ImageToProbe rigid");
    }
    if (!spaced && rigid)
    {
      throw std::runtime_error("the size of a pixel is not known: ImageToProbe is rigid (its "
                               "columns have length 1); set PixelSpacing");
    }
    chain.HasImageToProbe = true;
    chain.ImageToProbe = rigid ? options.ImageToProbe * toMillimetres : options.ImageToProbe;
  }
  if (IsPoseOfImage(options))
  {
    if (!spaced && options.Format != PoseFormat::Matrix)
    {
      throw std::runtime_error("the size of a pixel is not known: poses of the image without "
                               "matrices have none; set PixelSpacing");
    }
    chain.Calibrated = true;
    chain.PixelToPose = toMillimetres;
  }
  else if (known || spaced)
  {
    chain.Calibrated = true;
    chain.ImageToProbe = known ? chain.ImageToProbe : toMillimetres;
    chain.HasImageToProbe = true;
    chain.PixelToPose = chain.ImageToProbe;
  }
  return chain;
}

//------------------------------------------------------------------------------
Matrix4 InterpolatePose(const Matrix4& first, const Matrix4& second, double t)
{
  const auto rotation = [](const Matrix4& m)
  {
    const Vec3 x = Normalized(m.Column(0));
    const Vec3 z = Normalized(Cross(x, m.Column(1)));
    return Matrix4::FromColumns(x, Cross(z, x), z, { 0, 0, 0 });
  };
  const Matrix4 start = rotation(first);
  const Quaternion turn = ToQuaternion(start.Inverse() * rotation(second));
  const Vec3 axis{ turn[0], turn[1], turn[2] };
  // the short way round
  const double sign = turn[3] < 0 ? -1 : 1;
  const double angle = 2 * std::atan2(Norm(axis), sign * turn[3]);
  const Matrix4 turned = Norm(axis) > 0 ? start * Matrix4::Rotation(sign * axis, t * angle) : start;
  const Vec3 scale = (1 - t) * GetLengths(first) + t * GetLengths(second);
  const Vec3 position = (1 - t) * first.Column(3) + t * second.Column(3);
  return Matrix4::FromColumns(scale[0] * turned.Column(0), scale[1] * turned.Column(1),
    scale[2] * turned.Column(2), position);
}
}
