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
struct Link
{
  std::string Name;
  Matrix4 Matrix;
};

std::optional<std::vector<Link>> FindLinks(
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
  std::vector<Link> links;
  for (const TransformGraph::Link& link : chain)
  {
    const NamedTransform& named = transforms[static_cast<std::size_t>(link.Transform)];
    links.push_back(
      { named.From + "To" + named.To, link.Inverse ? named.Matrix.Inverse() : named.Matrix });
  }
  return links;
}

Matrix4 Compose(const std::vector<Link>& links)
{
  Matrix4 product;
  for (const Link& link : links)
  {
    product = link.Matrix * product;
  }
  return product;
}

// What the product alone, which MakePoseChain judges, does not show.
std::string FindBadLink(const std::vector<Link>& links)
{
  std::vector<Matrix4> matrices;
  for (const Link& link : links)
  {
    matrices.push_back(link.Matrix);
  }
  std::size_t bad = 0;
  const GeometryFinding finding = CheckImageChain(matrices, bad);
  return bad < links.size() ? links[bad].Name + " " + finding.Text + "; " + finding.Advice
                            : std::string();
}
}

ProbeFrames ReadProbeFrames(const std::string& fileName, double pixelSpacing)
{
  const std::vector<NamedTransform> transforms = ReadCalibrationFile(fileName);
  const auto imageToProbe = FindLinks(transforms, "Image", "Probe");
  if (!imageToProbe)
  {
    throw std::runtime_error(fileName +
      ": no transform leads from Image to Probe; is it the file that Probe Calibration has "
      "written?");
  }
  ProbeFrames frames;
  frames.TrackerToReference =
    Compose(FindLinks(transforms, "Tracker", "Reference").value_or(std::vector<Link>()));
  const GeometryFinding finding = CheckPose(frames.TrackerToReference);
  const GeometryAction action = GetAction(GeometryOrigin::Settings, finding.Fault);
  const std::string text = "TrackerToReference " + finding.Text + "; " + finding.Advice;
  if (action == GeometryAction::Refuse)
  {
    throw std::runtime_error(fileName + ": " + text);
  }
  frames.Warning = action == GeometryAction::Warn ? text : std::string();
  PoseTableOptions options;
  options.ImageToProbe = Compose(*imageToProbe);
  options.PixelSpacing = { pixelSpacing, pixelSpacing };
  try
  {
    const PoseChain chain = MakePoseChain(options);
    if (!chain.HasImageToProbe)
    {
      throw std::runtime_error("ImageToProbe is the identity, which is no calibration");
    }
    frames.ImageToProbe = chain.ImageToProbe;
    for (const std::string& warning : { chain.Warning, FindBadLink(*imageToProbe) })
    {
      frames.Warning += (frames.Warning.empty() || warning.empty() ? "" : ". ") + warning;
    }
  }
  catch (const std::runtime_error& e)
  {
    throw std::runtime_error(fileName + ": " + e.what());
  }
  return frames;
}
}
