// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaMirroredVolume.h"

#include "lacunaMemory.h"
#include "lacunaSplineFilter.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <type_traits>

namespace lacuna
{
namespace
{
// Indices this close to the border (by rounding) are on it.
constexpr double Slack = 1e-6;

// Rows of voxels that are judged one after the other.
constexpr std::int64_t BlockRows = 16;

std::int64_t GetNumberOfBlocks(const std::array<int, 3>& size)
{
  return (static_cast<std::int64_t>(size[1]) * size[2] + BlockRows - 1) / BlockRows;
}

// Where a voxel's image lies between voxels: lower corner and fractions. An image on the last voxel of
// an axis has fraction 1 there; an axis of one voxel has fraction 0, and nothing behind it.
struct Cell
{
  int Base[3];
  double Fraction[3];
};

bool FindCell(const Vec3& index, const std::array<int, 3>& size, Cell& cell)
{
  for (int a = 0; a < 3; ++a)
  {
    const double u = index[a];
    if (!(u >= -Slack) || !(u <= size[a] - 1 + Slack))
    {
      return false;
    }
    cell.Base[a] = std::clamp(static_cast<int>(std::floor(u)), 0, std::max(0, size[a] - 2));
    cell.Fraction[a] = size[a] > 1 ? std::clamp(u - cell.Base[a], 0.0, 1.0) : 0;
  }
  return true;
}

// Whether all voxels with a part in the trilinear value are valid.
class Validity
{
public:
  /// mask: empty when all are valid
  Validity(const std::vector<unsigned char>& mask, const std::array<int, 3>& size)
    : Mask(mask.empty() ? nullptr : mask.data())
    , Size(size)
  {
  }
  bool Of(const Cell& cell) const
  {
    if (!this->Mask)
    {
      return true;
    }
    for (int corner = 0; corner < 8; ++corner)
    {
      std::int64_t index = 0;
      bool used = true;
      for (int a = 2; a >= 0; --a)
      {
        const int up = corner >> a & 1;
        const double weight = up ? cell.Fraction[a] : 1 - cell.Fraction[a];
        used = used && weight > Slack;
        index = index * this->Size[a] + cell.Base[a] + up;
      }
      if (used && !this->Mask[index])
      {
        return false;
      }
    }
    return true;
  }

private:
  const unsigned char* Mask;
  std::array<int, 3> Size;
};

class SplineSampler
{
public:
  SplineSampler(const VoxelVolume& volume, const SplineCoefficients& coefficients)
    : Points(coefficients.Values.data())
    , Size(volume.Size)
  {
  }
  double operator()(const Cell& cell) const
  {
    double w[3][4];
    std::int64_t offsets[3][4];
    std::int64_t stride = 1;
    for (int a = 0; a < 3; ++a)
    {
      const double t = cell.Fraction[a];
      const double s = 1 - t;
      w[a][0] = s * s * s / 6;
      w[a][1] = (4 - 3 * t * t * (2 - t)) / 6;
      w[a][2] = (4 - 3 * s * s * (2 - s)) / 6;
      w[a][3] = t * t * t / 6;
      const int last = this->Size[a] - 1;
      const int base = cell.Base[a];
      if (last == 0)
      {
        w[a][1] = 1;
        w[a][0] = w[a][2] = w[a][3] = 0;
      }
      else
      {
        // control points beyond the ends continue linearly: c[-1] = 2 c[0] - c[1]
        if (base == 0)
        {
          w[a][1] += 2 * w[a][0];
          w[a][2] -= w[a][0];
          w[a][0] = 0;
        }
        if (base + 1 == last)
        {
          w[a][2] += 2 * w[a][3];
          w[a][1] -= w[a][3];
          w[a][3] = 0;
        }
      }
      for (int k = 0; k < 4; ++k)
      {
        offsets[a][k] = stride * std::clamp(base + k - 1, 0, last);
      }
      stride *= this->Size[a];
    }
    double value = 0;
    for (int k = 0; k < 4; ++k)
    {
      double layer = 0;
      for (int j = 0; j < 4; ++j)
      {
        const float* row = this->Points + offsets[2][k] + offsets[1][j];
        layer += w[1][j] *
          (w[0][0] * row[offsets[0][0]] + w[0][1] * row[offsets[0][1]] +
            w[0][2] * row[offsets[0][2]] + w[0][3] * row[offsets[0][3]]);
      }
      value += w[2][k] * layer;
    }
    return value;
  }

private:
  const float* Points;
  std::array<int, 3> Size;
};

template <class T>
class LinearSampler
{
public:
  LinearSampler(const VoxelVolume& volume, const T* voxels)
    : Voxels(voxels)
    , Size(volume.Size)
  {
  }
  double operator()(const Cell& cell) const
  {
    double value = 0;
    for (int corner = 0; corner < 8; ++corner)
    {
      double weight = 1;
      std::int64_t index = 0;
      for (int a = 2; a >= 0; --a)
      {
        const int up = corner >> a & 1;
        weight *= up ? cell.Fraction[a] : 1 - cell.Fraction[a];
        index = index * this->Size[a] + cell.Base[a] + up;
      }
      if (weight > 0) // beyond an axis of one voxel there is none
      {
        value += weight * static_cast<double>(this->Voxels[index]);
      }
    }
    return value;
  }

private:
  const T* Voxels;
  std::array<int, 3> Size;
};

// Its values are copied, not computed: labels of 64 bits stay what they are.
template <class T>
class NearestSampler
{
public:
  NearestSampler(const VoxelVolume& volume, const T* voxels)
    : Voxels(voxels)
    , Size(volume.Size)
  {
  }
  T operator()(const Cell& cell) const
  {
    std::int64_t index = 0;
    for (int a = 2; a >= 0; --a)
    {
      index = index * this->Size[a] + cell.Base[a] + (cell.Fraction[a] >= 0.5 ? 1 : 0);
    }
    return this->Voxels[index];
  }

private:
  const T* Voxels;
  std::array<int, 3> Size;
};

template <class T>
T Convert(double value)
{
  if constexpr (std::is_floating_point_v<T>)
  {
    return static_cast<T>(value);
  }
  else
  {
    const double rounded = std::floor(value + 0.5);
    if (rounded <= static_cast<double>(std::numeric_limits<T>::lowest()))
    {
      return std::numeric_limits<T>::lowest();
    }
    return rounded >= static_cast<double>(std::numeric_limits<T>::max())
      ? std::numeric_limits<T>::max()
      : static_cast<T>(rounded);
  }
}

// What there is of the valid voxels.
struct Extremes
{
  double Low = std::numeric_limits<double>::infinity();
  double High = -std::numeric_limits<double>::infinity();
  double Count = 0;

  Extremes& operator+=(const Extremes& other)
  {
    this->Low = std::min(this->Low, other.Low);
    this->High = std::max(this->High, other.High);
    this->Count += other.Count;
    return *this;
  }
};

template <class T>
class Mirror
{
public:
  Mirror(const MaskedVolume& given, const T* voxels, const MirrorPlane& plane, Execution& execution)
    : Given(given)
    , Voxels(voxels)
    , Execute(execution)
  {
    const Matrix4& toWorld = given.Volume.IndexToWorld;
    const Matrix4 toIndex = toWorld.Inverse();
    this->First = toIndex.Point(plane.Reflect(toWorld.Column(3)));
    for (int a = 0; a < 3; ++a)
    {
      this->Steps[a] = toIndex.Vector(plane.ReflectDirection(toWorld.Column(a)));
    }
    this->FindExtremes();
    const std::int64_t count = given.Volume.NumberOfVoxels();
    if (this->Range.Count < static_cast<double>(count))
    {
      this->Mask.resize(static_cast<std::size_t>(count));
      execution.For(count, 1 << 17,
        [&](std::int64_t begin, std::int64_t end)
        {
          for (std::int64_t i = begin; i < end; ++i)
          {
            this->Mask[i] = this->IsFinite(i);
          }
        });
    }
  }

  // Sets what result has of part, and judges the blocks from firstJudged on; result is one for each block.
  template <class Sampler>
  std::vector<Concordance> Run(const Sampler& sample, const VolumePart& part,
    std::int64_t firstJudged, std::int64_t endJudged, MirroredVolume& result)
  {
    const auto& size = this->Given.Volume.Size;
    const Validity validity(this->Mask, size);
    const T outside = this->Range.Count > 0 ? static_cast<T>(this->Range.Low) : T(0);
    auto* mirrored = reinterpret_cast<T*>(result.Voxels.data());
    const double origin = 0.5 * (this->Range.Low + this->Range.High);
    std::vector<Concordance> judged(GetNumberOfBlocks(size));
    const auto makeRow = [&](std::int64_t row, bool judges, Concordance& pairs)
    {
      const auto y = static_cast<int>(row % size[1]);
      const auto z = static_cast<int>(row / size[1]);
      const bool isMade = y >= part[2] && y <= part[3] && z >= part[4] && z <= part[5];
      if (!isMade && !judges)
      {
        return;
      }
      // of the part's first column
      const std::int64_t place = (part[1] - part[0] + 1) *
        (y - part[2] + static_cast<std::int64_t>(z - part[4]) * (part[3] - part[2] + 1));
      const Vec3 start = this->First + static_cast<double>(y) * this->Steps[1] +
        static_cast<double>(z) * this->Steps[2];
      Cell cell{};
      for (int i = judges ? 0 : part[0]; i <= (judges ? size[0] - 1 : part[1]); ++i)
      {
        const std::int64_t voxel = row * size[0] + i;
        const bool valid = FindCell(start + static_cast<double>(i) * this->Steps[0], size, cell) &&
          validity.Of(cell);
        const T value = valid ? ToVoxel(sample(cell)) : outside;
        const bool both = valid && (this->Mask.empty() || this->Mask[voxel]);
        const auto here = static_cast<double>(this->Voxels[voxel]);
        const auto there = static_cast<double>(value);
        if (both && judges)
        {
          pairs.Add(here, there);
        }
        if (isMade && i >= part[0] && i <= part[1])
        {
          const std::int64_t to = place + i - part[0];
          result.Valid[to] = valid;
          mirrored[to] = value;
          result.Asymmetry[to] =
            both ? static_cast<float>(here - there) : std::numeric_limits<float>::quiet_NaN();
        }
      }
    };
    const std::int64_t rows = static_cast<std::int64_t>(size[1]) * size[2];
    this->Execute.For(static_cast<std::int64_t>(judged.size()), 1,
      [&](std::int64_t begin, std::int64_t end)
      {
        for (std::int64_t block = begin; block < end; ++block)
        {
          Concordance pairs(origin);
          for (std::int64_t row = block * BlockRows; row < std::min(rows, (block + 1) * BlockRows);
               ++row)
          {
            makeRow(row, block >= firstJudged && block < endJudged, pairs);
          }
          judged[block] = pairs;
        }
      });
    return judged;
  }

  double GetNumberOfGiven() const { return this->Range.Count; }

private:
  template <class Value>
  static T ToVoxel(Value value)
  {
    if constexpr (std::is_same_v<Value, T>)
    {
      return value;
    }
    else
    {
      return Convert<T>(value);
    }
  }

  bool IsFinite(std::int64_t voxel) const
  {
    return (this->Given.Valid.empty() || this->Given.Valid[voxel]) &&
      std::isfinite(static_cast<double>(this->Voxels[voxel]));
  }

  void FindExtremes()
  {
    this->Range =
      SumOverBlocks<Extremes>(this->Execute, this->Given.Volume.NumberOfVoxels(), 1 << 17,
        [&](std::int64_t begin, std::int64_t end)
        {
          Extremes range;
          for (std::int64_t i = begin; i < end; ++i)
          {
            if (this->IsFinite(i))
            {
              const auto v = static_cast<double>(this->Voxels[i]);
              range += { v, v, 1 };
            }
          }
          return range;
        });
  }

  const MaskedVolume& Given;
  const T* Voxels;
  Execution& Execute;
  Extremes Range;
  std::vector<unsigned char> Mask; // empty when all are valid
  Vec3 First{ 0, 0, 0 };
  std::array<Vec3, 3> Steps{};
};

// Each block has been judged by the rank before whose end it lies: adds them up in their order, so that
// the sum does not depend on the number of ranks.
Concordance SumOverRanks(
  std::vector<Concordance>& judged, std::int64_t first, std::int64_t end, const Ranks& ranks)
{
  static_assert(
    std::is_trivially_copyable_v<Concordance> && sizeof(Concordance) % sizeof(std::uint64_t) == 0);
  if (ranks.GetNumber() > 1)
  {
    // of the other ranks' blocks there are zeros, so that the sum has the bits of one
    constexpr std::size_t words = sizeof(Concordance) / sizeof(std::uint64_t);
    std::vector<std::uint64_t> bits;
    ranks.Together([&] { bits.assign(judged.size() * words, 0); });
    std::memcpy(bits.data() + first * words, judged.data() + first,
      static_cast<std::size_t>(end - first) * sizeof(Concordance));
    ranks.Sum(bits.data(), static_cast<std::int64_t>(bits.size()));
    std::memcpy(static_cast<void*>(judged.data()), bits.data(), bits.size() * sizeof(bits[0]));
  }
  Concordance sum;
  for (const Concordance& block : judged)
  {
    sum += block;
  }
  return sum;
}
}

//------------------------------------------------------------------------------
MirroredVolume MirrorVolume(const MaskedVolume& volume, const MirrorPlane& plane,
  MirrorInterpolation interpolation, Execution& execution)
{
  const auto& size = volume.Volume.Size;
  return MirrorVolume(volume, plane, interpolation,
    { 0, size[0] - 1, 0, size[1] - 1, 0, size[2] - 1 }, true, Ranks(), execution);
}

//------------------------------------------------------------------------------
MirroredVolume MirrorVolume(const MaskedVolume& volume, const MirrorPlane& plane,
  MirrorInterpolation interpolation, const VolumePart& part, bool judges, const Ranks& ranks,
  Execution& execution)
{
  const Execution::NestedStages nested(execution);
  std::size_t count = 1;
  for (std::size_t a = 0; a < 3; ++a)
  {
    count *= static_cast<std::size_t>(std::max(0, part[2 * a + 1] - part[2 * a] + 1));
  }
  const std::int64_t blocks = GetNumberOfBlocks(volume.Volume.Size);
  const std::int64_t first = judges ? blocks * ranks.GetRank() / ranks.GetNumber() : 0;
  const std::int64_t end = judges ? blocks * (ranks.GetRank() + 1) / ranks.GetNumber() : 0;
  std::vector<Concordance> judged;
  double given = 0;
  MirroredVolume result;
  const auto mirror = [&]
  {
    const std::size_t bytes = GetScalarSize(volume.Volume.Type);
    const bool spline = interpolation == MirrorInterpolation::BSpline;
    // with a copy of one array at a time for who wants them, and the mask of what is given
    RequireMemory("the mirrored volume",
      static_cast<double>(count) * static_cast<double>(std::max(2 * bytes + 5, bytes + 9)) +
        (spline ? 5.0 : 1.0) * static_cast<double>(volume.Volume.NumberOfVoxels()));
    result.Voxels.resize(count * bytes);
    result.Valid.resize(count);
    result.Asymmetry.resize(count);
    DispatchScalars(volume.Volume.Type, volume.Volume.Voxels,
      [&](const auto* voxels)
      {
        using T = std::remove_cv_t<std::remove_pointer_t<decltype(voxels)>>;
        execution.SetStage(0, 0.1);
        Mirror<T> mirror(volume, voxels, plane, execution);
        given = mirror.GetNumberOfGiven();
        if (spline)
        {
          execution.SetStage(0.1, 0.3);
          const SplineCoefficients coefficients =
            FilterToCoefficients(volume.Volume, true, execution);
          execution.SetStage(0.3, 1);
          judged = mirror.Run(SplineSampler(volume.Volume, coefficients), part, first, end, result);
        }
        else if (interpolation == MirrorInterpolation::Linear)
        {
          execution.SetStage(0.1, 1);
          judged = mirror.Run(LinearSampler<T>(volume.Volume, voxels), part, first, end, result);
        }
        else
        {
          execution.SetStage(0.1, 1);
          judged = mirror.Run(NearestSampler<T>(volume.Volume, voxels), part, first, end, result);
        }
      });
  };
  if (!judges)
  {
    mirror();
    return result;
  }
  ranks.Together(mirror);
  const Concordance sum = SumOverRanks(judged, first, end, ranks);
  result.Score = sum.GetScore();
  result.RMS = sum.GetRMS();
  result.Overlap = given > 0 ? sum.GetCount() / given : 0;
  return result;
}
}
