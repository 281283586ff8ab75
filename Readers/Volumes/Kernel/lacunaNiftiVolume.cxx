// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaNiftiVolume.h"

#include "lacunaByteOrder.h"
#include "lacunaByteStream.h"
#include "lacunaInputFile.h"
#include "lacunaParameterText.h"

#include <algorithm>
#include <climits>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>

namespace lacuna
{
namespace
{
// Of the header and the four bytes behind it that say whether extensions follow, by version.
constexpr std::int64_t FirstVoxel[] = { 352, 544 };
constexpr double SameMatrices = 0.05; // mm, at the corners

[[noreturn]] void Fail(const std::string& fileName, const std::string& text)
{
  throw std::runtime_error(fileName + ": " + text);
}

//------------------------------------------------------------------------------
// Numbers at places of a header, in the file's byte order.
class HeaderBytes
{
public:
  HeaderBytes(const std::vector<unsigned char>& bytes, bool bigEndian)
    : Bytes(bytes)
    , Swapped(bigEndian != IsBigEndianMachine())
  {
  }

  template <class T>
  T Get(std::size_t at) const
  {
    std::array<unsigned char, sizeof(T)> part;
    std::copy_n(this->Bytes.begin() + static_cast<std::ptrdiff_t>(at), sizeof(T), part.begin());
    if (this->Swapped)
    {
      std::reverse(part.begin(), part.end());
    }
    T value;
    std::memcpy(&value, part.data(), sizeof(T));
    return value;
  }

  /// count numbers of type T, one after the other
  template <class T, class Out>
  void Get(std::size_t at, Out* values, std::size_t count) const
  {
    for (std::size_t i = 0; i < count; ++i)
    {
      values[i] = this->Get<T>(at + i * sizeof(T));
    }
  }

private:
  const std::vector<unsigned char>& Bytes;
  bool Swapped;
};

// Where the fields are, and of which types: NIfTI-1 has 16 bits and float where NIfTI-2 has 64 bits, 32
// for codes, and double.
struct Places
{
  std::size_t DataType, Dim, PixDim, VoxelOffset, Slope, Intercept, Units, QFormCode, SFormCode,
    Quaternion, QOffset, SRows;
};
constexpr Places Nifti1{ 70, 40, 76, 108, 112, 116, 123, 252, 254, 256, 268, 280 };
constexpr Places Nifti2{ 12, 16, 104, 168, 176, 184, 500, 344, 348, 352, 376, 400 };

template <class Size, class Code, class Units, class Offset, class Real>
NiftiHeader GetHeader(const HeaderBytes& bytes, const Places& at)
{
  NiftiHeader header;
  header.DataType = bytes.Get<std::int16_t>(at.DataType);
  bytes.Get<Size>(at.Dim, header.Dim.data(), 8);
  bytes.Get<Real>(at.PixDim, header.PixDim.data(), 8);
  const auto offset = static_cast<double>(bytes.Get<Offset>(at.VoxelOffset));
  header.VoxelOffset = offset >= 0 && offset < 1e15 ? static_cast<std::int64_t>(offset) : -1;
  header.Slope = bytes.Get<Real>(at.Slope);
  header.Intercept = bytes.Get<Real>(at.Intercept);
  header.Units = bytes.Get<Units>(at.Units);
  header.QFormCode = bytes.Get<Code>(at.QFormCode);
  header.SFormCode = bytes.Get<Code>(at.SFormCode);
  bytes.Get<Real>(at.Quaternion, header.Quaternion.data(), 3);
  bytes.Get<Real>(at.QOffset, header.QOffset.data(), 3);
  for (std::size_t row = 0; row < 3; ++row)
  {
    bytes.Get<Real>(at.SRows + 4 * row * sizeof(Real), header.SRows[row].data(), 4);
  }
  return header;
}

//------------------------------------------------------------------------------
std::string DescribeSizes(const NiftiHeader& header)
{
  std::string sizes;
  for (std::int64_t i = 1; i <= std::clamp<std::int64_t>(header.Dim[0], 0, 7); ++i)
  {
    sizes += (i == 1 ? "" : " x ") + std::to_string(header.Dim[static_cast<std::size_t>(i)]);
  }
  return sizes;
}

// Of the axes 1 to 7.
std::array<std::int64_t, 8> GetSizes(const std::string& name, const NiftiHeader& header)
{
  const std::int64_t axes = header.Dim[0];
  std::array<std::int64_t, 8> dim{};
  for (std::size_t i = 1; i < 8; ++i)
  {
    dim[i] = static_cast<std::int64_t>(i) <= axes ? header.Dim[i] : 1;
  }
  const std::string sizes = DescribeSizes(header);
  const auto tooMany = [](std::int64_t n) { return n < 1 || n > INT_MAX; };
  if (axes < 2 || axes > 7 || std::any_of(dim.begin() + 1, dim.end(), tooMany))
  {
    Fail(name,
      "the size is " + (sizes.empty() ? "missing" : sizes) +
        "; each of 2 to 7 axes must be from 1 to " + std::to_string(INT_MAX));
  }
  if (std::any_of(dim.begin() + 4, dim.end(), [](std::int64_t n) { return n > 1; }))
  {
    Fail(name,
      "the size is " + sizes +
        ": several volumes in one file. Save one of them in a file of its own, for example by "
        "'fslroi' or 3D Slicer");
  }
  return dim;
}

struct VoxelType
{
  int Code;
  ScalarType Value;
  int Channels;
};

VoxelType FindType(const std::string& name, const NiftiHeader& header)
{
  static const VoxelType types[] = { { 2, ScalarType::UInt8, 1 }, { 4, ScalarType::Int16, 1 },
    { 8, ScalarType::Int32, 1 }, { 16, ScalarType::Float32, 1 }, { 64, ScalarType::Float64, 1 },
    { 128, ScalarType::UInt8, 3 }, { 256, ScalarType::Int8, 1 }, { 512, ScalarType::UInt16, 1 },
    { 768, ScalarType::UInt32, 1 }, { 1024, ScalarType::Int64, 1 }, { 1280, ScalarType::UInt64, 1 },
    { 2304, ScalarType::UInt8, 4 } };
  const auto* type = std::find_if(std::begin(types), std::end(types),
    [&](const VoxelType& t) { return t.Code == header.DataType; });
  if (type == std::end(types))
  {
    Fail(name,
      "voxels have the type " + std::to_string(header.DataType) +
        "; known are integers of 8 to 64 bits, float, double, RGB and RGBA");
  }
  return *type;
}

void SetRescaling(VolumeFile& volume, const NiftiHeader& header)
{
  if (header.Slope == 0 || volume.Slices.Channels != 1) // 0: no rescaling, by definition
  {
    return;
  }
  if (std::isfinite(header.Slope) && std::isfinite(header.Intercept))
  {
    volume.Slope = header.Slope;
    volume.Intercept = header.Intercept;
  }
  else
  {
    volume.Warnings.emplace_back(
      "scl_slope or scl_inter is not a finite number; the stored values are taken");
  }
}

void SetVoxels(VolumeFile& volume, const NiftiHeader& header)
{
  SequenceHeader& slices = volume.Slices;
  const std::string& name = slices.FileName;
  const std::array<std::int64_t, 8> dim = GetSizes(name, header);
  const VoxelType type = FindType(name, header);
  const std::int64_t first = FirstVoxel[header.Version - 1];
  if (header.VoxelOffset < first)
  {
    Fail(name,
      "vox_offset is " + std::to_string(header.VoxelOffset) +
        ": the voxels would begin within the header. In a .nii file of NIfTI-" +
        std::to_string(header.Version) + " they begin at byte " + std::to_string(first) +
        " or later. Save the volume anew in the program that made it");
  }
  const double bytes =
    32.0 * static_cast<double>(dim[1]) * static_cast<double>(dim[2]) * static_cast<double>(dim[3]);
  if (bytes > 1e18)
  {
    Fail(name, "the size is " + DescribeSizes(header) + "; no file holds so much");
  }
  slices.IsVolume = true;
  slices.Columns = dim[1];
  slices.Rows = dim[2];
  slices.Frames = dim[3];
  slices.Channels = type.Channels;
  slices.Type = type.Value;
  slices.BigEndian = header.BigEndian;
  slices.Encoding = header.Compressed ? PixelEncoding::Zlib : PixelEncoding::Raw;
  slices.DataFileName = name;
  slices.SkippedBytes = header.VoxelOffset;
  SetRescaling(volume, header);
}

//------------------------------------------------------------------------------
// As the NIfTI library has it: a quaternion near half a turn is normalised, since its first
// component is the difference of nearly equal numbers.
Matrix4 GetQForm(const std::string& name, const NiftiHeader& header, double& uncertainty)
{
  double b = header.Quaternion[0];
  double c = header.Quaternion[1];
  double d = header.Quaternion[2];
  const double square = b * b + c * c + d * d;
  if (!(square < 1.001))
  {
    Fail(name, "the quaternion of qform, " + FormatValue(header.Quaternion) + ", is longer than 1");
  }
  double a = 0;
  if (1 - square < 1e-7)
  {
    const double length = std::sqrt(square);
    b /= length;
    c /= length;
    d /= length;
  }
  else
  {
    a = std::sqrt(1 - square);
  }
  uncertainty = 2e-7 / std::max(a, 4e-4); // in radians, since b, c and d have 24 bits
  const double slices = header.PixDim[0] < 0 ? -1 : 1;
  const double x = header.PixDim[1];
  const double y = header.PixDim[2];
  const double z = header.PixDim[3];
  for (int i = 1; i <= 3; ++i)
  {
    if (!(header.PixDim[static_cast<std::size_t>(i)] > 0))
    {
      Fail(name,
        "pixdim " + std::to_string(i) + " is " +
          FormatNumber(header.PixDim[static_cast<std::size_t>(i)]) +
          "; qform needs the distances of voxels");
    }
  }
  const Vec3 column0{ { a * a + b * b - c * c - d * d, 2 * (b * c + a * d), 2 * (b * d - a * c) } };
  const Vec3 column1{ { 2 * (b * c - a * d), a * a + c * c - b * b - d * d, 2 * (c * d + a * b) } };
  const Vec3 column2{ { 2 * (b * d + a * c), 2 * (c * d - a * b), a * a + d * d - c * c - b * b } };
  return Matrix4::FromColumns(x * column0, y * column1, slices * z * column2,
    { { header.QOffset[0], header.QOffset[1], header.QOffset[2] } });
}

Matrix4 GetSForm(const NiftiHeader& header)
{
  Matrix4 matrix;
  for (int row = 0; row < 3; ++row)
  {
    for (int column = 0; column < 4; ++column)
    {
      matrix(row, column) =
        header.SRows[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)];
    }
  }
  return matrix;
}

// The most that a corner of the image differs, mm; NaN for matrices that are not finite.
double GetDistance(const Matrix4& a, const Matrix4& b, const SequenceHeader& slices)
{
  double most = 0;
  for (int corner = 0; corner < 8; ++corner)
  {
    const Vec3 index{ { corner & 1 ? static_cast<double>(slices.Columns - 1) : 0,
      corner & 2 ? static_cast<double>(slices.Rows - 1) : 0,
      corner & 4 ? static_cast<double>(slices.Frames - 1) : 0 } };
    const double distance = Norm(a.Point(index) - b.Point(index));
    if (std::isnan(distance))
    {
      return distance;
    }
    most = std::max(most, distance);
  }
  return most;
}

//------------------------------------------------------------------------------
double GetUnit(VolumeFile& volume, int units)
{
  switch (units & 7)
  {
    case 0:
      volume.Warnings.emplace_back(
        "the file does not say its unit of length (xyzt_units); mm are taken");
      return 1;
    case 1:
      return 1000;
    case 2:
      return 1;
    case 3:
      return 1e-3;
    default:
      Fail(volume.Slices.FileName,
        "xyzt_units is " + std::to_string(units) + "; known units of length are m, mm and um");
  }
}
}

//------------------------------------------------------------------------------
NiftiHeader ReadNiftiHeader(const std::string& fileName)
{
  constexpr std::size_t size1 = 348;
  constexpr std::size_t size2 = 540;
  std::ifstream stream = OpenForReading(fileName, fileName);
  std::vector<unsigned char> bytes(size2);
  std::size_t filled = ReadBytes(stream, bytes.data(), size2, fileName);
  const bool compressed = filled > 2 && bytes[0] == 0x1f && bytes[1] == 0x8b;
  if (compressed)
  {
    filled = static_cast<std::size_t>(
      MakeInflateStream(fileName, 0)->Read(bytes.data(), static_cast<std::int64_t>(size2)));
  }
  for (const bool bigEndian : { false, true })
  {
    const HeaderBytes header(bytes, bigEndian);
    const auto size = filled < 8 ? 0 : header.Get<std::int32_t>(0);
    const auto magic = [&](std::size_t at, const char* text)
    { return std::memcmp(bytes.data() + at, text, 4) == 0; };
    NiftiHeader found;
    if (size == size1 && filled >= size1 && magic(344, "n+1"))
    {
      found = GetHeader<std::int16_t, std::int16_t, unsigned char, float, float>(header, Nifti1);
    }
    else if (size == size2 && filled == size2 && magic(4, "n+2"))
    {
      found =
        GetHeader<std::int64_t, std::int32_t, std::int32_t, std::int64_t, double>(header, Nifti2);
      found.Version = 2;
    }
    else
    {
      continue;
    }
    found.BigEndian = bigEndian;
    found.Compressed = compressed;
    return found;
  }
  Fail(fileName,
    "not a NIfTI file with header and voxels in one (.nii, .nii.gz), or cut off within its header. "
    "Of a pair .hdr and .img, or Analyze 7.5, make a .nii file first");
}

//------------------------------------------------------------------------------
VolumeFile MakeNiftiVolume(
  const std::string& fileName, const NiftiHeader& header, NiftiTransform transform)
{
  VolumeFile volume;
  volume.Slices.FileName = fileName;
  SetVoxels(volume, header);
  const double unit = GetUnit(volume, header.Units);
  const bool hasS = header.SFormCode > 0;
  const bool hasQ = header.QFormCode > 0;
  if (transform == NiftiTransform::SForm   ? !hasS
      : transform == NiftiTransform::QForm ? !hasQ
                                           : !hasS && !hasQ)
  {
    Fail(fileName,
      std::string("the file does not say how the patient lies: ") +
        (transform == NiftiTransform::SForm      ? "sform_code is"
            : transform == NiftiTransform::QForm ? "qform_code is"
                                                 : "sform_code and qform_code are") +
        " 0. Convert the DICOM series again, or set the matrix in the program that made the file");
  }
  bool byS = transform == NiftiTransform::Automatic ? hasS : transform == NiftiTransform::SForm;
  if (transform == NiftiTransform::Automatic && hasS && hasQ)
  {
    double uncertainty = 0;
    const Matrix4 s = GetSForm(header);
    const Matrix4 q = GetQForm(fileName, header, uncertainty);
    const Vec3 last{ { static_cast<double>(volume.Slices.Columns - 1),
      static_cast<double>(volume.Slices.Rows - 1),
      static_cast<double>(volume.Slices.Frames - 1) } };
    const double distance = unit * GetDistance(s, q, volume.Slices);
    if (!(distance <= SameMatrices + unit * uncertainty * Norm(q.Vector(last))))
    {
      Fail(fileName,
        "sform (code " + std::to_string(header.SFormCode) + ") and qform (code " +
          std::to_string(header.QFormCode) + ") differ by " +
          FormatNumber(std::round(distance * 100) / 100) +
          " mm at a corner of the volume. Code 1 is where the patient lay in the scanner, 2 to 4 "
          "after a registration. Choose one of them by NIfTITransform (SForm or QForm)");
    }
  }
  double ignored = 0;
  const Matrix4 toRas = byS ? GetSForm(header) : GetQForm(fileName, header, ignored);
  volume.IndexToPatient = Matrix4::Scaling({ { -unit, -unit, unit } }) * toRas;
  const int code = byS ? header.SFormCode : header.QFormCode;
  volume.IsPatient = code == 1 || code == 2;
  if (!volume.IsPatient)
  {
    volume.Warnings.push_back(std::string(byS ? "sform" : "qform") + "_code is " +
      std::to_string(code) +
      ": the volume lies in a standard brain's space, not where the patient lay");
  }
  return volume;
}
}
