// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSliceFingerprint.h"

#include <algorithm>

namespace lacuna
{
namespace
{
SliceFingerprint GetFingerprint(const SliceImage& slice)
{
  SliceFingerprint fingerprint{};
  fingerprint.Type = slice.Type;
  fingerprint.Size = { slice.Width, slice.Height };
  std::copy_n(slice.PixelToReference.Data(), 16, fingerprint.Pose.begin());
  if (slice.Fan)
  {
    const Fan& fan = slice.Fan->GetFan();
    const Vec2& spacing = slice.Fan->GetPixelSpacing();
    fingerprint.Fan = { fan.Origin[0], fan.Origin[1], fan.Angles[0], fan.Angles[1], fan.Radii[0],
      fan.Radii[1], spacing[0], spacing[1] };
  }
  fingerprint.Pixels = HashPixels(slice);
  return fingerprint;
}
}

bool SliceFingerprint::operator==(const SliceFingerprint& other) const
{
  return this->Type == other.Type && this->Size == other.Size && this->Pose == other.Pose &&
    this->Fan == other.Fan && this->Pixels == other.Pixels;
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
