// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaCTVolume.h"

#include "lacunaHounsfield.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <type_traits>
#include <utility>
#include <vector>

namespace lacuna
{
namespace
{
// What a number in a shifted row is made of.
struct Tap
{
  std::int64_t Index;
  float Weight;
};

// Cubic convolution at x among size numbers, which go on linearly beyond both ends; none where x is
// outside of them.
std::vector<Tap> FindTaps(double x, std::int64_t size)
{
  constexpr double Rounding = 1e-6;
  std::vector<Tap> taps;
  const auto last = static_cast<double>(size - 1);
  if (x < -Rounding || x > last + Rounding)
  {
    return taps;
  }
  double base = std::floor(x + Rounding);
  const double f = x - base;
  if (std::abs(f) <= Rounding)
  {
    taps.push_back({ static_cast<std::int64_t>(base), 1.0F });
    return taps;
  }
  const std::array<double, 4> weights = { ((-0.5 * f + 1) * f - 0.5) * f,
    (1.5 * f - 2.5) * f * f + 1, ((-1.5 * f + 2) * f + 0.5) * f, (0.5 * f - 0.5) * f * f };
  const auto add = [&](std::int64_t index, double weight)
  {
    for (Tap& tap : taps)
    {
      if (tap.Index == index)
      {
        tap.Weight += static_cast<float>(weight);
        return;
      }
    }
    taps.push_back({ index, static_cast<float>(weight) });
  };
  for (int k = 0; k < 4; ++k)
  {
    const std::int64_t index = static_cast<std::int64_t>(base) - 1 + k;
    const std::int64_t end = std::clamp<std::int64_t>(index, 0, size - 1);
    const std::int64_t inner = std::clamp<std::int64_t>(end == 0 ? 1 : size - 2, 0, size - 1);
    const auto beyond = static_cast<double>(std::abs(index - end)); // 0 inside
    add(end, weights[k] * (1 + beyond));
    if (beyond > 0)
    {
      add(inner, -weights[k] * beyond);
    }
  }
  return taps;
}

template <class T>
T Round(float value)
{
  if constexpr (std::is_integral_v<T>)
  {
    const double rounded = std::nearbyint(static_cast<double>(value));
    return static_cast<T>(std::clamp(rounded, static_cast<double>(std::numeric_limits<T>::lowest()),
      static_cast<double>(std::numeric_limits<T>::max())));
  }
  else
  {
    return value;
  }
}

template <class T>
class VolumeReader
{
public:
  VolumeReader(const CTGeometry& geometry, const std::array<int, 6>& extent, double air,
    const CTPixelReader& read, T* scalars)
    : Geometry(geometry)
    , Extent(extent)
    , Columns(static_cast<std::int64_t>(extent[1]) - extent[0] + 1)
    , Rows(static_cast<std::int64_t>(extent[3]) - extent[2] + 1)
    , Air(air)
    , Read(read)
    , Scalars(scalars)
  {
  }

  void ReadPlane(std::int64_t k) const
  {
    const Borrowed pixels(*this);
    const CTPlane& plane = this->Geometry.Planes[static_cast<std::size_t>(k)];
    T* voxels = this->Scalars + (k - this->Extent[4]) * this->Columns * this->Rows;
    const CTSlice& slice = this->Geometry.Slices[plane.First];
    if (plane.Weight == 0 && this->IsInPlace(slice))
    {
      this->Copy(slice, *pixels, voxels);
      return;
    }
    std::vector<float> values = this->Shift(slice, *pixels);
    if (plane.Weight != 0)
    {
      const auto weight = static_cast<float>(plane.Weight);
      const std::vector<float> second = this->Shift(this->Geometry.Slices[plane.Second], *pixels);
      for (std::size_t i = 0; i < values.size(); ++i)
      {
        values[i] = (1 - weight) * values[i] + weight * second[i];
      }
    }
    std::transform(values.begin(), values.end(), voxels, Round<T>);
  }

private:
  // Memory for pixels, no more of it than threads work at a time.
  class Borrowed
  {
  public:
    explicit Borrowed(const VolumeReader& owner)
      : Owner(owner)
    {
      const std::lock_guard<std::mutex> lock(owner.FreeLock);
      if (!owner.Free.empty())
      {
        this->Pixels = std::move(owner.Free.back());
        owner.Free.pop_back();
      }
    }
    ~Borrowed()
    {
      const std::lock_guard<std::mutex> lock(this->Owner.FreeLock);
      this->Owner.Free.push_back(std::move(this->Pixels));
    }
    Borrowed(const Borrowed&) = delete;
    Borrowed& operator=(const Borrowed&) = delete;
    CTPixels& operator*() const { return this->Pixels; }

  private:
    const VolumeReader& Owner;
    mutable CTPixels Pixels;
  };

  // Whether the pixels of an image are voxels, and there are no others in its plane.
  bool IsInPlace(const CTSlice& slice) const
  {
    return slice.ColumnShift == 0 && slice.RowShift == 0 &&
      this->Geometry.Columns == this->Geometry.FrameColumns &&
      this->Geometry.Rows == this->Geometry.FrameRows;
  }

  // The part of an image that lies in the extent, as it is.
  template <class U>
  void Copy(const CTSlice& slice, CTPixels& pixels, U* values) const
  {
    const std::int64_t width = this->Geometry.FrameColumns;
    const bool whole = this->Columns == width && this->Rows == this->Geometry.FrameRows;
    pixels.Room = whole && slice.Frame.Header->Format.BitsAllocated == 8 * sizeof(U)
      ? reinterpret_cast<unsigned char*>(values)
      : nullptr;
    this->Read(slice.Frame, pixels);
    const HounsfieldScale scale(slice.Frame, pixels.Format, this->Air);
    const std::int64_t bytes = scale.GetBytesPerPixel();
    if (this->Columns == width)
    {
      scale.Convert(
        pixels.Data + this->Extent[2] * width * bytes, this->Columns * this->Rows, values);
      return;
    }
    for (std::int64_t row = 0; row < this->Rows; ++row)
    {
      const std::int64_t first = (this->Extent[2] + row) * width + this->Extent[0];
      scale.Convert(pixels.Data + first * bytes, this->Columns, values + row * this->Columns);
    }
  }

  // An image moved to where it lies in the grid.
  std::vector<float> Shift(const CTSlice& slice, CTPixels& pixels) const
  {
    std::vector<float> values(static_cast<std::size_t>(this->Columns * this->Rows));
    if (this->IsInPlace(slice))
    {
      this->Copy(slice, pixels, values.data());
      return values;
    }
    pixels.Room = nullptr;
    this->Read(slice.Frame, pixels);
    const std::int64_t width = this->Geometry.FrameColumns;
    const std::int64_t height = this->Geometry.FrameRows;
    std::vector<float> image(static_cast<std::size_t>(width * height));
    HounsfieldScale(slice.Frame, pixels.Format, this->Air)
      .Convert(pixels.Data, width * height, image.data());

    std::vector<std::vector<Tap>> columns(static_cast<std::size_t>(this->Columns));
    for (std::int64_t i = 0; i < this->Columns; ++i)
    {
      columns[i] = FindTaps(static_cast<double>(this->Extent[0] + i) - slice.ColumnShift, width);
    }
    std::vector<float> line(static_cast<std::size_t>(width));
    for (std::int64_t j = 0; j < this->Rows; ++j)
    {
      float* target = values.data() + j * this->Columns;
      const std::vector<Tap> rows =
        FindTaps(static_cast<double>(this->Extent[2] + j) - slice.RowShift, height);
      std::fill(line.begin(), line.end(), 0.0F);
      for (const Tap& tap : rows)
      {
        const float* source = image.data() + tap.Index * width;
        for (std::int64_t i = 0; i < width; ++i)
        {
          line[i] += tap.Weight * source[i];
        }
      }
      for (std::int64_t i = 0; i < this->Columns; ++i)
      {
        float sum = 0;
        for (const Tap& tap : columns[i])
        {
          sum += tap.Weight * line[tap.Index];
        }
        target[i] = rows.empty() || columns[i].empty() ? static_cast<float>(this->Air) : sum;
      }
    }
    return values;
  }

  const CTGeometry& Geometry;
  std::array<int, 6> Extent;
  std::int64_t Columns;
  std::int64_t Rows;
  double Air;
  const CTPixelReader& Read;
  T* Scalars;
  mutable std::mutex FreeLock;
  mutable std::vector<CTPixels> Free;
};

template <class T>
void ReadAs(const CTGeometry& geometry, const std::array<int, 6>& extent, double air,
  const CTPixelReader& read, void* scalars, Execution& execution)
{
  const VolumeReader<T> reader(geometry, extent, air, read, static_cast<T*>(scalars));
  execution.For(static_cast<std::int64_t>(extent[5]) - extent[4] + 1, 1,
    [&](std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t k = begin; k < end; ++k)
      {
        reader.ReadPlane(extent[4] + k);
      }
    });
}
}

//------------------------------------------------------------------------------
void ReadCTVolume(const CTGeometry& geometry, const std::array<int, 6>& extent, ScalarType type,
  double air, const CTPixelReader& read, void* scalars, Execution& execution)
{
  switch (type)
  {
    case ScalarType::Int16:
      return ReadAs<std::int16_t>(geometry, extent, air, read, scalars, execution);
    case ScalarType::Int32:
      return ReadAs<std::int32_t>(geometry, extent, air, read, scalars, execution);
    default:
      return ReadAs<float>(geometry, extent, air, read, scalars, execution);
  }
}
}
