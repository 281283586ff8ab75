// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaPoseFields.h"

#include "lacunaSweep.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace lacuna
{
bool IsNear(const Matrix4& a, const Matrix4& b)
{
  return std::equal(a.Data(), a.Data() + 16, b.Data(),
    [](double x, double y) { return std::abs(x - y) <= 1e-9 * std::max(1.0, std::abs(x)); });
}

bool TellPoses(const std::vector<SequenceFields>& frames, const std::string& imageFrame,
  const std::string& referenceFrame, const std::vector<Matrix4>& poses)
{
  SequenceHeader header;
  header.Frames = static_cast<std::int64_t>(frames.size());
  for (std::size_t i = 0; i < frames.size(); ++i)
  {
    for (const auto& [name, text] : frames[i])
    {
      std::vector<std::string>& texts = header.FrameFields[name];
      texts.resize(frames.size());
      texts[i] = text;
    }
  }
  SweepOptions options;
  options.ImageFrame = imageFrame;
  options.ReferenceFrame = referenceFrame;
  Sweep heeding; // what the file says about validity
  Sweep trusting;
  try
  {
    heeding = BuildSweep(header, options);
    options.DropInvalid = false;
    trusting = BuildSweep(header, options);
  }
  catch (const std::runtime_error&)
  {
    return false; // no chain
  }
  for (std::size_t i = 0; i < frames.size(); ++i)
  {
    const bool same = !trusting.ImageToReference.empty() &&
      (poses[i].IsFinite() ? IsNear(poses[i], trusting.ImageToReference[i])
                           : !heeding.ImageToReference[i].IsFinite());
    if (!same)
    {
      return false;
    }
  }
  return true;
}
}
