// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaProbeFrames.h"

#include "lacunaCalibrationFile.h"
#include "lacunaGeometryGate.h"
#include "lacunaPoseTable.h"
#include "lacunaTransformGraph.h"

#include <optional>
#include <stdexcept>
#include <vector>

namespace lacuna
{
namespace
{
std::optional<Matrix4> Compose(
  const std::vector<NamedTransform>& transforms, const std::string& from, const std::string& to)
{
  TransformGraph graph;
  for (std::size_t i = 0; i < transforms.size(); ++i)
  {
    graph.Add(transforms[i].From, transforms[i].To, static_cast<int>(i));
  }
  std::vector<TransformGraph::Link> chain;
  if (!graph.FindChain(from, to, chain))
  {
    return std::nullopt;
  }
  Matrix4 product;
  for (const TransformGraph::Link& link : chain)
  {
    const Matrix4& matrix = transforms[static_cast<std::size_t>(link.Transform)].Matrix;
    product = (link.Inverse ? matrix.Inverse() : matrix) * product;
  }
  return product;
}
}

ProbeFrames ReadProbeFrames(const std::string& fileName, double pixelSpacing)
{
  const std::vector<NamedTransform> transforms = ReadCalibrationFile(fileName);
  const auto imageToProbe = Compose(transforms, "Image", "Probe");
  if (!imageToProbe)
  {
    throw std::runtime_error(fileName +
      ": no transform leads from Image to Probe; is it the file that Probe Calibration has "
      "written?");
  }
  ProbeFrames frames;
  frames.TrackerToReference = Compose(transforms, "Tracker", "Reference").value_or(Matrix4());
  const GeometryFinding finding = CheckPose(frames.TrackerToReference);
  const GeometryAction action = GetAction(GeometryOrigin::Settings, finding.Fault);
  const std::string text = "TrackerToReference " + finding.Text + "; " + finding.Advice;
  if (action == GeometryAction::Refuse)
  {
    throw std::runtime_error(fileName + ": " + text);
  }
  frames.Warning = action == GeometryAction::Warn ? text : std::string();
  PoseTableOptions options;
  options.ImageToProbe = *imageToProbe;
  options.PixelSpacing = { pixelSpacing, pixelSpacing };
  try
  {
    const PoseChain chain = MakePoseChain(options);
    if (!chain.HasImageToProbe)
    {
      throw std::runtime_error("ImageToProbe is the identity, which is no calibration");
    }
    frames.ImageToProbe = chain.ImageToProbe;
    frames.Warning += (frames.Warning.empty() || chain.Warning.empty() ? "" : ". ") + chain.Warning;
  }
  catch (const std::runtime_error& e)
  {
    throw std::runtime_error(fileName + ": " + e.what());
  }
  return frames;
}
}
