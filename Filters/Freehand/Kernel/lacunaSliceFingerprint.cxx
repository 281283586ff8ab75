// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSliceFingerprint.h"

#include <algorithm>

namespace lacuna
{
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
