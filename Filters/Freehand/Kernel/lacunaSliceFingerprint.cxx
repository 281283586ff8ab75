// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSliceFingerprint.h"

#include <algorithm>
#include <cstring>

namespace lacuna
{
namespace
{
constexpr std::size_t Lanes = 4; // whose products do not wait for each other
constexpr std::uint64_t Prime = 1099511628211U;

class Hash
{
public:
  void Add(const unsigned char* bytes, std::size_t size)
  {
    constexpr std::size_t block = 8 * Lanes;
    for (; size >= block; size -= block, bytes += block)
    {
      this->AddBlock(bytes);
    }
    // What is left is filled up with its length, so that rows of different lengths differ.
    std::array<unsigned char, block> rest;
    rest.fill(static_cast<unsigned char>(size));
    std::copy_n(bytes, size, rest.begin());
    this->AddBlock(rest.data());
  }

  std::uint64_t Get() const
  {
    std::uint64_t whole = 0;
    for (const std::uint64_t state : this->States)
    {
      whole = Mix(whole, state);
    }
    return whole;
  }

private:
  static std::uint64_t Mix(std::uint64_t state, std::uint64_t word)
  {
    state = (state ^ word) * Prime;
    return state ^ (state >> 29); // a product alone never carries high bits down
  }

  void AddBlock(const unsigned char* bytes)
  {
    std::array<std::uint64_t, Lanes> words;
    std::memcpy(words.data(), bytes, sizeof(words));
    for (std::size_t lane = 0; lane < Lanes; ++lane)
    {
      this->States[lane] = Mix(this->States[lane], words[lane]);
    }
  }

  std::array<std::uint64_t, Lanes> States{ 14695981039346656037U, 1, 2, 3 };
};

SliceFingerprint GetFingerprint(const SliceImage& slice)
{
  SliceFingerprint fingerprint{};
  fingerprint.Type = slice.Type;
  fingerprint.Size = { slice.Width, slice.Height };
  std::copy_n(slice.PixelToReference.Data(), 16, fingerprint.Pose.begin());
  if (slice.Fan)
  {
    const Fan& fan = slice.Fan->GetFan();
    fingerprint.Fan = { fan.Origin[0], fan.Origin[1], fan.Angles[0], fan.Angles[1], fan.Radii[0],
      fan.Radii[1] };
  }
  const std::size_t pixel = GetScalarSize(slice.Type);
  Hash hash;
  for (int row = 0; row < slice.Height; ++row)
  {
    hash.Add(static_cast<const unsigned char*>(slice.Pixels) +
        static_cast<std::ptrdiff_t>(pixel) * slice.RowStride * row,
      pixel * static_cast<std::size_t>(slice.Width));
  }
  fingerprint.Hash = hash.Get();
  return fingerprint;
}
}

bool SliceFingerprint::operator==(const SliceFingerprint& other) const
{
  return this->Type == other.Type && this->Size == other.Size && this->Pose == other.Pose &&
    this->Fan == other.Fan && this->Hash == other.Hash;
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
        fingerprints[n] = GetFingerprint(slices[n]);
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
