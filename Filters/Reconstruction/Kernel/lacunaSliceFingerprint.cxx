// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSliceFingerprint.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>

namespace lacuna
{
namespace
{
// Odd constants without pattern (fractional digits of the golden ratio, of pi and of roots).
constexpr std::uint64_t FirstFactor = 0x9e3779b97f4a7c15;
constexpr std::uint64_t SecondFactor = 0xc2b2ae3d27d4eb4f;
constexpr std::size_t BlockSize = 32;

std::uint64_t Rotate(std::uint64_t x, int bits)
{
  return (x << bits) | (x >> (64 - bits));
}

// Spreads each bit over all of the result; different arguments have different results.
std::uint64_t Mix(std::uint64_t x)
{
  x = (x ^ (x >> 33)) * 0xff51afd7ed558ccd;
  x = (x ^ (x >> 33)) * 0xc4ceb9fe1a85ec53;
  return x ^ (x >> 33);
}

// Four lanes that the processor works on side by side. A step of a lane loses nothing of its state
// and nothing of the word.
struct Lanes
{
  std::array<std::uint64_t, 4> State{ 0x243f6a8885a308d3, 0x13198a2e03707344, 0xa4093822299f31d0,
    0x082efa98ec4e6c89 };

  void Take(const std::byte* block)
  {
    for (std::size_t lane = 0; lane < 4; ++lane)
    {
      std::uint64_t word;
      std::memcpy(&word, block + 8 * lane, 8);
      this->State[lane] = Rotate(this->State[lane] + word * SecondFactor, 31) * FirstFactor;
    }
  }
};
}

PixelHash HashPixels(const SliceImage& slice)
{
  const std::size_t pixelSize = GetScalarSize(slice.Type);
  const std::size_t lineSize = pixelSize * static_cast<std::size_t>(slice.Width);
  Lanes lanes;
  for (int row = 0; row < slice.Height; ++row)
  {
    const std::byte* line = static_cast<const std::byte*>(slice.Pixels) +
      static_cast<std::ptrdiff_t>(pixelSize) * slice.RowStride * row;
    std::size_t left = lineSize;
    for (; left >= BlockSize; left -= BlockSize, line += BlockSize)
    {
      lanes.Take(line);
    }
    if (left > 0)
    {
      std::array<std::byte, BlockSize> block{};
      std::memcpy(block.data(), line, left);
      lanes.Take(block.data());
    }
  }
  const std::array<std::uint64_t, 4>& s = lanes.State;
  PixelHash hash;
  hash.First = Mix(Mix(Mix(Mix(s[0]) + s[1]) + s[2]) + s[3]);
  hash.Second = Mix(Mix(Mix(Mix(s[3] ^ FirstFactor) + s[2]) + s[1]) + s[0]);
  return hash;
}

//------------------------------------------------------------------------------
SliceFingerprint::SliceFingerprint(const SliceImage& slice, bool withPixels)
  : Type(slice.Type)
  , Size{ slice.Width, slice.Height }
  , BeginsSweep(slice.BeginsSweep)
  , HasFan(slice.Fan != nullptr)
{
  std::copy_n(slice.PixelToReference.Data(), 16, this->Pose.begin());
  if (slice.Fan)
  {
    const lacuna::Fan& fan = slice.Fan->GetFan();
    const Vec2& spacing = slice.Fan->GetPixelSpacing();
    this->Fan = { fan.Origin[0], fan.Origin[1], fan.Angles[0], fan.Angles[1], fan.Radii[0],
      fan.Radii[1], spacing[0], spacing[1] };
  }
  if (withPixels)
  {
    this->Pixels = HashPixels(slice);
  }
}

bool SliceFingerprint::HasGeometryOf(const SliceFingerprint& other) const
{
  return this->Type == other.Type && this->Size == other.Size && this->Pose == other.Pose &&
    this->BeginsSweep == other.BeginsSweep && this->HasFan == other.HasFan &&
    this->Fan == other.Fan;
}

std::vector<SliceFingerprint> GetFingerprints(
  const std::vector<SliceImage>& slices, Execution& execution)
{
  std::vector<SliceFingerprint> fingerprints(slices.size());
  execution.For(static_cast<std::int64_t>(slices.size()), 1,
    [&](std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t n = begin; n < end; ++n)
      {
        fingerprints[n] = SliceFingerprint(slices[n]);
      }
    });
  return fingerprints;
}

bool IsContinued(
  const std::vector<SliceFingerprint>& earlier, const std::vector<SliceFingerprint>& later)
{
  return earlier.size() <= later.size() &&
    std::equal(earlier.begin(), earlier.end(), later.begin());
}
}
