// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A box of samples in memory that belongs to someone else.
#ifndef lacunaImageView_h
#define lacunaImageView_h

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace lacuna
{
/// A box of whole-number coordinates, both ends included, as VTK's extents: x0 x1 y0 y1 z0 z1.
using Extent = std::array<int, 6>;

/// The least and the greatest coordinate along an axis.
inline int& First(Extent& extent, int axis)
{
  return extent[std::size_t(2) * axis];
}
inline int First(const Extent& extent, int axis)
{
  return extent[std::size_t(2) * axis];
}
inline int& Last(Extent& extent, int axis)
{
  return extent[std::size_t(2) * axis + 1];
}
inline int Last(const Extent& extent, int axis)
{
  return extent[std::size_t(2) * axis + 1];
}

inline int SizeOf(const Extent& extent, int axis)
{
  return Last(extent, axis) - First(extent, axis) + 1;
}

inline bool IsEmpty(const Extent& extent)
{
  return SizeOf(extent, 0) <= 0 || SizeOf(extent, 1) <= 0 || SizeOf(extent, 2) <= 0;
}

inline std::int64_t NumberOfSamples(const Extent& extent)
{
  return IsEmpty(extent) ? 0
                         : std::int64_t(SizeOf(extent, 0)) * SizeOf(extent, 1) * SizeOf(extent, 2);
}

/// True when inner lies in outer.
inline bool Contains(const Extent& outer, const Extent& inner)
{
  bool inside = true;
  for (int a = 0; a < 3; ++a)
  {
    inside = inside && First(outer, a) <= First(inner, a) && Last(inner, a) <= Last(outer, a);
  }
  return inside;
}

template <class T>
struct ImageView
{
  T* Data;                            ///< the sample at the lowest coordinates
  Extent Box;                         ///< its coordinates
  std::array<std::int64_t, 3> Stride; ///< elements from a sample to the next along x, y, z

  /// A view of contiguous samples, x fastest.
  ImageView(T* data, const Extent& box, int components = 1)
    : Data(data)
    , Box(box)
    , Stride{ components, std::int64_t(components) * SizeOf(box, 0),
      std::int64_t(components) * SizeOf(box, 0) * SizeOf(box, 1) }
  {
  }

  /// A view to read from, of a view to write to.
  template <class U, class = std::enable_if_t<std::is_same_v<T, const U>>>
  ImageView(const ImageView<U>& other)
    : Data(other.Data)
    , Box(other.Box)
    , Stride(other.Stride)
  {
  }

  T* At(int x, int y, int z) const
  {
    return this->Data + (x - this->Box[0]) * this->Stride[0] +
      (y - this->Box[2]) * this->Stride[1] + (z - this->Box[4]) * this->Stride[2];
  }
};

/// Copies the samples of box, which may reach outside of the view, to dense memory (x fastest)
/// through convert. Outside, the nearest sample of the view is repeated: the border rule of all
/// filters here.
template <class T, class Out, class Convert>
void CopyReplicated(const ImageView<const T>& view, const Extent& box, Out* to, Convert convert)
{
  const int n = SizeOf(box, 0);
  // Columns before, inside and behind the view.
  const int before = std::clamp(view.Box[0] - box[0], 0, n);
  const int end = std::clamp(view.Box[1] + 1 - box[0], before, n);
  for (int z = box[4]; z <= box[5]; ++z)
  {
    const int zIn = std::clamp(z, view.Box[4], view.Box[5]);
    for (int y = box[2]; y <= box[3]; ++y, to += n)
    {
      const T* row = view.At(view.Box[0], std::clamp(y, view.Box[2], view.Box[3]), zIn);
      const std::int64_t step = view.Stride[0];
      const T* from = row + (box[0] + before - view.Box[0]) * step;
      std::fill(to, to + before, convert(*row));
      if (step == 1)
      {
        std::transform(from, from + (end - before), to + before, convert);
      }
      else
      {
        for (int i = before; i < end; ++i)
        {
          to[i] = convert(from[(i - before) * step]);
        }
      }
      std::fill(to + end, to + n, convert(row[(view.Box[1] - view.Box[0]) * step]));
    }
  }
}

/// Copies dense samples (x fastest) of box, which lies in the view, into the view.
template <class In, class T, class Convert>
void CopyInto(const In* from, const Extent& box, const ImageView<T>& view, Convert convert)
{
  const int n = SizeOf(box, 0);
  for (int z = box[4]; z <= box[5]; ++z)
  {
    for (int y = box[2]; y <= box[3]; ++y, from += n)
    {
      T* row = view.At(box[0], y, z);
      for (int i = 0; i < n; ++i)
      {
        row[i * view.Stride[0]] = convert(from[i]);
      }
    }
  }
}
}
#endif
