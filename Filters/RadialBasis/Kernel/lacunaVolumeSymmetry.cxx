// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaVolumeSymmetry.h"

#include "lacunaExecution.h"
#include "lacunaMirrorPlane.h"
#include "lacunaSymmetrySearch.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <memory>
#include <stdexcept>
#include <vector>

namespace lacuna
{
namespace
{
// A volume at one resolution, for the search of its plane of symmetry.

// Means of blocks of voxels. They are taken as the control points of a cubic B-spline: so the level
// is a little smoothed, and has derivatives. Coordinates are mm along the volume's axes, from its
// first voxel.
class VolumeLevel : public SymmetryLevel
{
public:
  // spacing: of the voxels; wantedCell: about how long blocks are, mm; samples: at most about so many
  // cells have residuals.
  VolumeLevel(const MaskedVolume& volume, const Vec3& spacing, double wantedCell,
    std::size_t samples, Execution& execution);

  // Largest less smallest value; 0 when there is none.
  double GetRange() const { return this->Range; }

  double Rate(const MirrorPlane& plane) const override;
  std::vector<double> GetResiduals(const MirrorPlane& plane, Execution& execution) const override;
  SymmetryEquations Linearize(const MirrorPlane& plane, const std::array<Vec3, 2>& turns,
    double limit, Execution& execution) const override;

private:
  std::int64_t IndexOf(int i, int j, int k) const
  {
    return i + this->Size[0] * (j + static_cast<std::int64_t>(this->Size[1]) * k);
  }
  Vec3 CellCenter(int i, int j, int k) const
  {
    return { this->First[0] + i * this->Cell[0], this->First[1] + j * this->Cell[1],
      this->First[2] + k * this->Cell[2] };
  }
  Vec3 CellCenter(std::int64_t cell) const
  {
    const std::int64_t row = cell / this->Size[0];
    return this->CellCenter(static_cast<int>(cell % this->Size[0]),
      static_cast<int>(row % this->Size[1]), static_cast<int>(row / this->Size[1]));
  }

  template <class T>
  void Average(const T* voxels, const MaskedVolume& volume, Execution& execution);
  // The spline at the cells' centres, and what is said of its values.
  void Smooth(Execution& execution);
  // Cells at strong edges, as they tell where the plane is: at most about so many, spread evenly.
  void ChooseSamples(std::size_t count, Execution& execution);
  // Value and derivatives (per mm) of the spline; NaN outside or next to an invalid cell.
  double Evaluate(const Vec3& x, Vec3& slope) const;
  // Trilinear in the smoothed cells, at an index; NaN as above.
  double Interpolate(double x, double y, double z) const;

  std::array<int, 3> Block{};
  std::array<int, 3> Size{};
  std::array<std::int64_t, 3> Next{}; // from a cell to the next along an axis; 0 if there is none
  std::array<int, 3> Rim{};           // cells at the border without a full neighbourhood
  Vec3 Cell{ 0, 0, 0 };
  Vec3 First{ 0, 0, 0 };
  std::vector<float> Points;
  std::vector<float> Smoothed;
  std::vector<std::int64_t> Samples;
  double Range = 0;
  double Mean = 0;
  double Variation = 0;
};

constexpr double LeastOverlap = 1.0 / 3;
constexpr float NotANumber = std::numeric_limits<float>::quiet_NaN();

/// The uniform cubic B-spline's weights of four control points at the fraction t, and derivatives.
struct SplineWeights
{
  double Value[4];
  double Slope[4];

  void Set(double t)
  {
    const double s = 1 - t;
    this->Value[0] = s * s * s / 6;
    this->Value[1] = (4 - 3 * t * t * (2 - t)) / 6;
    this->Value[2] = (4 - 3 * s * s * (2 - s)) / 6;
    this->Value[3] = t * t * t / 6;
    this->Slope[0] = -s * s / 2;
    this->Slope[1] = t * (3 * t - 4) / 2;
    this->Slope[2] = -s * (3 * s - 4) / 2;
    this->Slope[3] = t * t / 2;
  }
};

//------------------------------------------------------------------------------
VolumeLevel::VolumeLevel(const MaskedVolume& volume, const Vec3& spacing, double wantedCell,
  std::size_t samples, Execution& execution)
{
  this->CellSize = std::numeric_limits<double>::infinity();
  for (int a = 0; a < 3; ++a)
  {
    const int voxels = volume.Volume.Size[a];
    const int block = static_cast<int>(
      std::clamp(wantedCell / spacing[a] + 0.5, 1.0, std::max(1.0, std::floor(voxels / 4.0))));
    this->Block[a] = block;
    this->Size[a] = voxels / block; // what remains at the end is left out
    this->Cell[a] = block * spacing[a];
    this->First[a] = (block - 1) / 2.0 * spacing[a];
    this->HalfSize[a] = (voxels - 1) * spacing[a] / 2;
    this->Center[a] = this->HalfSize[a];
    this->Rim[a] = this->Size[a] >= 6 ? 1 : 0;
    if (this->Size[a] > 1)
    {
      this->CellSize = std::min(this->CellSize, this->Cell[a]);
    }
  }
  const std::int64_t layer = static_cast<std::int64_t>(this->Size[0]) * this->Size[1];
  this->Next = { this->Size[0] > 1 ? 1 : 0, this->Size[1] > 1 ? this->Size[0] : 0,
    this->Size[2] > 1 ? layer : 0 };
  DispatchScalars(volume.Volume.Type, volume.Volume.Voxels,
    [&](const auto* voxels) { this->Average(voxels, volume, execution); });
  this->Smooth(execution);
  this->ChooseSamples(samples, execution);
}

double VolumeLevel::Rate(const MirrorPlane& plane) const
{
  // the image of cell (i, j, k) as an index: from row to row, and step by step along it
  const auto toIndex = [this](const Vec3& v) {
    return Vec3{ v[0] / this->Cell[0], v[1] / this->Cell[1], v[2] / this->Cell[2] };
  };
  const Vec3 step = toIndex(plane.ReflectDirection({ this->Cell[0], 0, 0 }));
  Concordance pairs(this->Mean);
  double seen = 0;
  for (int k = 0; k < this->Size[2]; ++k)
  {
    for (int j = 0; j < this->Size[1]; ++j)
    {
      const float* row = this->Smoothed.data() + this->IndexOf(0, j, k);
      const Vec3 start = toIndex(plane.Reflect(this->CellCenter(0, j, k)) - this->First);
      for (int i = 0; i < this->Size[0]; ++i)
      {
        const double here = row[i];
        const double there =
          this->Interpolate(start[0] + i * step[0], start[1] + i * step[1], start[2] + i * step[2]);
        if (!std::isnan(here) && !std::isnan(there))
        {
          pairs.Add(here, there);
          seen += (here - this->Mean) * (here - this->Mean);
        }
      }
    }
  }
  const double score = pairs.GetScore();
  return seen >= LeastOverlap * this->Variation && score > -1 ? score : -1;
}

std::vector<double> VolumeLevel::GetResiduals(const MirrorPlane& plane, Execution& execution) const
{
  std::vector<double> residuals(this->Samples.size());
  execution.For(static_cast<std::int64_t>(residuals.size()), 4096,
    [&](std::int64_t begin, std::int64_t end)
    {
      Vec3 slope{ 0, 0, 0 };
      for (std::int64_t s = begin; s < end; ++s)
      {
        const Vec3 x = this->CellCenter(this->Samples[s]);
        residuals[s] =
          std::abs(this->Smoothed[this->Samples[s]] - this->Evaluate(plane.Reflect(x), slope));
      }
    });
  residuals.erase(
    std::remove_if(residuals.begin(), residuals.end(), [](double r) { return std::isnan(r); }),
    residuals.end());
  return residuals;
}

SymmetryEquations VolumeLevel::Linearize(const MirrorPlane& plane, const std::array<Vec3, 2>& turns,
  double limit, Execution& execution) const
{
  return SumOverBlocks<SymmetryEquations>(execution,
    static_cast<std::int64_t>(this->Samples.size()), 4096,
    [&](std::int64_t begin, std::int64_t end)
    {
      SymmetryEquations equations;
      const Vec3& n = plane.Normal;
      for (std::int64_t s = begin; s < end; ++s)
      {
        const Vec3 x = this->CellCenter(this->Samples[s]);
        Vec3 slope{ 0, 0, 0 };
        const double there = this->Evaluate(plane.Reflect(x), slope);
        const double residual = this->Smoothed[this->Samples[s]] - there;
        if (std::isnan(residual))
        {
          continue;
        }
        // the image is x - 2 (n . x - d) n; the plane turns about the middle of the data
        const double along = Dot(slope, n);
        const double distance = plane.Distance(x);
        const Vec3 arm = x - this->Center;
        std::array<double, 3> slopes;
        for (std::size_t k = 0; k < 2; ++k)
        {
          slopes[k] = 2 * (Dot(turns[k], arm) * along + distance * Dot(slope, turns[k]));
        }
        slopes[2] = -2 * along;
        equations.Add(residual, slopes, limit);
      }
      return equations;
    });
}

template <class T>
void VolumeLevel::Average(const T* voxels, const MaskedVolume& volume, Execution& execution)
{
  this->Points.assign(
    static_cast<std::size_t>(this->Size[0]) * this->Size[1] * this->Size[2], NotANumber);
  const auto& size = volume.Volume.Size;
  const auto& block = this->Block;
  execution.For(static_cast<std::int64_t>(this->Size[1]) * this->Size[2], 4,
    [&](std::int64_t begin, std::int64_t end)
    {
      std::vector<double> sums(this->Size[0]);
      std::vector<int> counts(this->Size[0]);
      for (std::int64_t row = begin; row < end; ++row)
      {
        std::fill(sums.begin(), sums.end(), 0.0);
        std::fill(counts.begin(), counts.end(), 0);
        const int j0 = static_cast<int>(row % this->Size[1]) * block[1];
        const int k0 = static_cast<int>(row / this->Size[1]) * block[2];
        for (int k = k0; k < k0 + block[2]; ++k)
        {
          for (int j = j0; j < j0 + block[1]; ++j)
          {
            const std::int64_t first = size[0] * (j + static_cast<std::int64_t>(size[1]) * k);
            for (int c = 0; c < this->Size[0]; ++c)
            {
              for (int i = c * block[0]; i < (c + 1) * block[0]; ++i)
              {
                const auto v = static_cast<double>(voxels[first + i]);
                if (std::isfinite(v) && (volume.Valid.empty() || volume.Valid[first + i]))
                {
                  sums[c] += v;
                  ++counts[c];
                }
              }
            }
          }
        }
        for (int c = 0; c < this->Size[0]; ++c)
        {
          if (2 * counts[c] > block[0] * block[1] * block[2])
          {
            this->Points[row * this->Size[0] + c] = static_cast<float>(sums[c] / counts[c]);
          }
        }
      }
    });
}

void VolumeLevel::Smooth(Execution& execution)
{
  this->Smoothed.resize(this->Points.size());
  execution.For(static_cast<std::int64_t>(this->Points.size()), 8192,
    [&](std::int64_t begin, std::int64_t end)
    {
      Vec3 slope{ 0, 0, 0 };
      for (std::int64_t c = begin; c < end; ++c)
      {
        this->Smoothed[c] = static_cast<float>(this->Evaluate(this->CellCenter(c), slope));
      }
    });
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  double sum = 0;
  double count = 0;
  for (const float v : this->Smoothed)
  {
    if (!std::isnan(v))
    {
      low = std::min<double>(low, v);
      high = std::max<double>(high, v);
      sum += v;
      count += 1;
    }
  }
  this->Range = count > 0 ? high - low : 0;
  this->Mean = count > 0 ? sum / count : 0;
  for (const float v : this->Smoothed)
  {
    this->Variation += std::isnan(v) ? 0 : (v - this->Mean) * (v - this->Mean);
  }
}

void VolumeLevel::ChooseSamples(std::size_t count, Execution& execution)
{
  std::vector<float> strength(this->Points.size());
  execution.For(static_cast<std::int64_t>(strength.size()), 8192,
    [&](std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t c = begin; c < end; ++c)
      {
        Vec3 slope{ 0, 0, 0 };
        const double v = this->Evaluate(this->CellCenter(c), slope);
        const double edge = Norm(slope) * this->CellSize;
        strength[c] = std::isfinite(v) && edge > 1e-3 * this->Range ? static_cast<float>(edge) : 0;
      }
    });
  std::vector<float> edges;
  std::copy_if(
    strength.begin(), strength.end(), std::back_inserter(edges), [](float s) { return s > 0; });
  if (edges.empty())
  {
    return;
  }
  const auto strong = edges.begin() + static_cast<std::ptrdiff_t>(9 * edges.size() / 10);
  std::nth_element(edges.begin(), strong, edges.end());
  const float least = *strong / 2; // so that a little metal is not all there is
  const auto all = static_cast<std::size_t>(
    std::count_if(edges.begin(), edges.end(), [=](float s) { return s >= least; }));
  for (std::size_t c = 0; c < strength.size(); ++c)
  {
    // a fixed shuffle of the cells
    const std::uint64_t mixed = ((c + 1) * 0x9E3779B97F4A7C15U) >> 32U;
    if (strength[c] >= least && mixed * all < count << 32U)
    {
      this->Samples.push_back(static_cast<std::int64_t>(c));
    }
  }
  this->CellResidual = *strong;
}

double VolumeLevel::Evaluate(const Vec3& x, Vec3& slope) const
{
  SplineWeights weights[3];
  std::int64_t offsets[3][4];
  std::int64_t stride = 1;
  for (int a = 0; a < 3; ++a)
  {
    const int n = this->Size[a];
    const double u = (x[a] - this->First[a]) / this->Cell[a];
    if (!(u >= this->Rim[a] - 1e-6) || !(u <= n - 1 - this->Rim[a] + 1e-6))
    {
      return std::numeric_limits<double>::quiet_NaN();
    }
    const int base = std::clamp(static_cast<int>(u), 0, std::max(0, n - 2));
    weights[a].Set(u - base);
    for (int k = 0; k < 4; ++k)
    {
      offsets[a][k] = stride * std::clamp(base + k - 1, 0, n - 1);
    }
    stride *= n;
  }
  double value = 0;
  double d[3] = { 0, 0, 0 };
  for (int k = 0; k < 4; ++k)
  {
    for (int j = 0; j < 4; ++j)
    {
      const float* row = this->Points.data() + offsets[2][k] + offsets[1][j];
      double v = 0;
      double s = 0;
      for (int i = 0; i < 4; ++i)
      {
        const double p = row[offsets[0][i]];
        v += weights[0].Value[i] * p;
        s += weights[0].Slope[i] * p;
      }
      const double w = weights[1].Value[j] * weights[2].Value[k];
      value += w * v;
      d[0] += w * s;
      d[1] += weights[1].Slope[j] * weights[2].Value[k] * v;
      d[2] += weights[1].Value[j] * weights[2].Slope[k] * v;
    }
  }
  for (int a = 0; a < 3; ++a)
  {
    slope[a] = d[a] / this->Cell[a];
  }
  return value;
}

double VolumeLevel::Interpolate(double x, double y, double z) const
{
  const double u[3] = { x, y, z };
  int base[3];
  double t[3];
  for (int a = 0; a < 3; ++a)
  {
    const int n = this->Size[a];
    if (!(u[a] >= -1e-6) || !(u[a] <= n - 1 + 1e-6))
    {
      return std::numeric_limits<double>::quiet_NaN();
    }
    base[a] = std::clamp(static_cast<int>(u[a]), 0, std::max(0, n - 2));
    t[a] = u[a] - base[a];
  }
  const float* p = this->Smoothed.data() + this->IndexOf(base[0], base[1], base[2]);
  const auto line = [&](const float* q) { return q[0] + t[0] * (q[this->Next[0]] - q[0]); };
  const auto face = [&](const float* q)
  {
    const double first = line(q);
    return first + t[1] * (line(q + this->Next[1]) - first);
  };
  const double first = face(p);
  return first + t[2] * (face(p + this->Next[2]) - first);
}

//------------------------------------------------------------------------------
struct LevelSize
{
  int Cells; ///< at most so many along the longest edge
  std::size_t Samples;
};
constexpr LevelSize Levels[] = { { 20, 2000 }, { 44, 6000 }, { 96, 20000 }, { 192, 150000 } };
constexpr int NumberOfDirections = 320; // some 8 degrees apart
constexpr int NumberOfRingDirections = 36;

// The volume's own frame: mm along its axes, from its first voxel. Mirror planes are mirror planes in
// it because its axes are perpendicular.
struct OwnFrame
{
  explicit OwnFrame(const VoxelVolume& volume)
    : Origin(volume.IndexToWorld.Column(3))
  {
    for (int a = 0; a < 3; ++a)
    {
      const Vec3 step = volume.IndexToWorld.Column(a);
      this->Spacing[a] = Norm(step);
      this->Axes[a] = Normalized(step);
    }
    for (int a = 0; a < 3; ++a)
    {
      if (!(this->Spacing[a] > 0) || !IsFinite(this->Axes[a]) ||
        std::abs(Dot(this->Axes[a], this->Axes[(a + 1) % 3])) > 1e-6)
      {
        throw std::runtime_error("the axes of the volume are not perpendicular to one another (see "
                                 "its spacing and direction matrix)");
      }
    }
  }

  MirrorPlane ToWorld(const MirrorPlane& own) const
  {
    const Vec3& n = own.Normal;
    const Vec3 normal = n[0] * this->Axes[0] + n[1] * this->Axes[1] + n[2] * this->Axes[2];
    return { normal, own.Offset + Dot(normal, this->Origin) };
  }

  Vec3 Origin;
  std::array<Vec3, 3> Axes;
  Vec3 Spacing{ 0, 0, 0 };
};
}

//------------------------------------------------------------------------------
SymmetryResult FindSymmetryPlane(const MaskedVolume& volume, Execution& execution)
{
  const OwnFrame frame(volume.Volume);
  int flat = -1;
  int numberOfFlat = 0;
  double longest = 0;
  double finest = std::numeric_limits<double>::infinity();
  for (int a = 0; a < 3; ++a)
  {
    if (volume.Volume.Size[a] < 2)
    {
      flat = a;
      ++numberOfFlat;
      continue;
    }
    longest = std::max(longest, volume.Volume.Size[a] * frame.Spacing[a]);
    finest = std::min(finest, frame.Spacing[a]);
  }
  if (numberOfFlat > 1)
  {
    throw std::runtime_error("the volume has one row of voxels only; a plane of symmetry can be "
                             "found in a volume or in a slice");
  }
  const Execution::NestedStages nested(execution);
  execution.SetStage(0, 0.2);
  std::vector<std::unique_ptr<SymmetryLevel>> levels;
  for (const LevelSize& size : Levels)
  {
    const double cell = longest / size.Cells;
    auto level =
      std::make_unique<VolumeLevel>(volume, frame.Spacing, cell, size.Samples, execution);
    if (!(level->GetRange() > 0))
    {
      throw std::runtime_error(
        "all valid voxels have the same value, or there is none: there is no "
        "plane of best symmetry; give a plane instead");
    }
    levels.push_back(std::move(level));
    if (cell < finest * 1.5)
    {
      break; // the next one would be the same
    }
  }
  execution.SetStage(0.2, 1);
  // thin stacks of slices have nothing but planes that are nearly perpendicular to the slices
  std::vector<Vec3> directions;
  for (int a = 0; a < 3; ++a)
  {
    const std::vector<Vec3> ring = RingDirections(a, NumberOfRingDirections);
    if (flat < 0 || flat == a)
    {
      directions.insert(directions.end(), ring.begin(), ring.end());
    }
  }
  if (flat < 0)
  {
    const std::vector<Vec3> sphere = HemisphereDirections(NumberOfDirections);
    directions.insert(directions.end(), sphere.begin(), sphere.end());
  }
  SymmetryResult result = FindSymmetryPlane(levels, directions, execution);
  result.Plane = frame.ToWorld(result.Plane);
  return result;
}
}
