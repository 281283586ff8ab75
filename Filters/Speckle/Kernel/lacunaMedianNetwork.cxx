// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaMedianNetwork.h"

#include <cstdint>
#include <vector>

namespace lacuna
{
namespace
{
template <class V>
LACUNA_INLINE void Exchange(V& a, V& b)
{
  const V low = a < b ? a : b;
  b = a < b ? b : a;
  a = low;
}

/// Moves the least of n vectors' lanes to the first and the greatest to the last.
template <int N, class V>
LACUNA_INLINE void MoveExtremes(V* v)
{
#pragma GCC unroll 64
  for (int i = 0; i < N / 2; ++i)
  {
    Exchange(v[i], v[N - 1 - i]);
  }
  // The least is among the first half, the greatest among the second (the middle of an odd number
  // belongs to both).
#pragma GCC unroll 64
  for (int i = 1; i < (N + 1) / 2; ++i)
  {
    Exchange(v[0], v[i]);
  }
#pragma GCC unroll 64
  for (int i = N / 2; i < N - 1; ++i)
  {
    Exchange(v[i], v[N - 1]);
  }
}

/// Forgetful selection: of N/2 + 2 samples the least and the greatest cannot be the median of all
/// N; drop them, take in another one, and so on until three are left.
template <int Kept, class V, class Key>
LACUNA_INLINE void Forget(V* v, const Key* at, const std::ptrdiff_t* offsets, V& median)
{
  MoveExtremes<Kept>(v);
  if constexpr (Kept == 3)
  {
    median = v[1];
  }
  else
  {
    LoadVector(v[0], at + offsets[0]);
    Forget<Kept - 1>(v, at, offsets + 1, median); // v[Kept - 1], the greatest, is forgotten
  }
}

template <int Samples, class Key>
struct Network
{
  const Key* Keys;
  const int* Size;
  const Window& Box;
  Key* Medians;

  template <int Bytes>
  static LACUNA_INLINE void Run(Network& n)
  {
    using V = typename Vector<Key, Bytes>::Type;
    constexpr int Lanes = Vector<Key, Bytes>::Lanes;
    const std::ptrdiff_t pitch = n.Size[0];
    const std::ptrdiff_t slice = pitch * n.Size[1];
    std::ptrdiff_t offsets[Samples];
    std::ptrdiff_t* next = offsets;
    for (int z = 0; z < n.Box.GetSize(2); ++z)
    {
      for (int y = 0; y < n.Box.GetSize(1); ++y)
      {
        for (int x = 0; x < n.Box.GetSize(0); ++x)
        {
          *next++ = z * slice + y * pitch + x;
        }
      }
    }
    const int outX = n.Size[0] - n.Box.GetSize(0) + 1;
    const int outY = n.Size[1] - n.Box.GetSize(1) + 1;
    const int outZ = n.Size[2] - n.Box.GetSize(2) + 1;
    Key* out = n.Medians;
    for (int z = 0; z < outZ; ++z)
    {
      for (int y = 0; y < outY; ++y, out += outX)
      {
        const Key* row = n.Keys + z * slice + y * pitch;
        for (int x = 0; x < outX; x += Lanes)
        {
          constexpr int Kept = Samples / 2 + 2;
          V v[Kept];
#pragma GCC unroll 64
          for (int i = 0; i < Kept; ++i)
          {
            LoadVector(v[i], row + x + offsets[i]);
          }
          V median;
          Forget<Kept>(v, row + x, offsets + Kept, median);
          StoreVector(out + x, median); // beyond the row's end: the next row writes over it
        }
      }
    }
  }
};

template <int Samples, class Key>
void RunNetwork(
  const Key* keys, const int size[3], const Window& window, VectorUnit set, Key* medians)
{
  Network<Samples, Key> network{ keys, size, window, medians };
  RunWith<Network<Samples, Key>>(set, network);
}
}

bool HasMedianNetwork(const Window& window)
{
  const std::int64_t n = window.GetNumberOfSamples();
  return window.IsBox() && (n == 3 || n == 5 || n == 9 || n == 25 || n == 27);
}

template <class Key>
void FilterByNetwork(
  const Key* keys, const int size[3], const Window& window, VectorUnit set, Key* medians)
{
  switch (window.GetNumberOfSamples())
  {
    case 3:
      return RunNetwork<3>(keys, size, window, set, medians);
    case 5:
      return RunNetwork<5>(keys, size, window, set, medians);
    case 9:
      return RunNetwork<9>(keys, size, window, set, medians);
    case 25:
      return RunNetwork<25>(keys, size, window, set, medians);
    default:
      return RunNetwork<27>(keys, size, window, set, medians);
  }
}

template void FilterByNetwork(
  const std::uint8_t*, const int[3], const Window&, VectorUnit, std::uint8_t*);
template void FilterByNetwork(
  const std::uint16_t*, const int[3], const Window&, VectorUnit, std::uint16_t*);
template void FilterByNetwork(
  const std::uint32_t*, const int[3], const Window&, VectorUnit, std::uint32_t*);
template void FilterByNetwork(
  const std::uint64_t*, const int[3], const Window&, VectorUnit, std::uint64_t*);
}
