// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaChainJudge.h"

#include "lacunaGeometryGate.h"
#include "lacunaItemList.h"

#include <algorithm>
#include <cstddef>
#include <map>

namespace lacuna
{
namespace
{
using Chain = std::vector<TransformGraph::Link>;

class ChainJudge
{
public:
  ChainJudge(const SweepTransforms& transforms, std::size_t frames, bool dropInvalid)
    : Transforms(transforms)
    , Count(frames)
    , DropInvalid(dropInvalid)
  {
    this->Result.Impossible.assign(frames, 0);
  }

  // Refuses, flags or warns.
  void Judge(const Chain& links, bool ofImage)
  {
    // from one picture to another is no link of its own: pixels may become larger
    std::vector<Chain> parts;
    for (const TransformGraph::Link& link : links)
    {
      if (parts.empty() || !IsPictureFrame(parts.back().back().To))
      {
        parts.emplace_back();
      }
      parts.back().push_back(link);
    }
    const bool constant = std::all_of(links.begin(), links.end(),
      [&](const TransformGraph::Link& link) { return this->Transforms.Get(link).FromCalibration; });
    const GeometryOrigin origin =
      constant ? GeometryOrigin::CalibrationFile : GeometryOrigin::Sequence;
    struct Found
    {
      std::string Text;
      std::string Advice;
      std::vector<std::size_t> Frames;
    };
    std::map<GeometryFault, Found> found;
    std::vector<Matrix4> matrices(parts.size());
    for (std::size_t i = 0; i < (constant ? std::min<std::size_t>(1, this->Count) : this->Count);
         ++i)
    {
      const bool refused = this->DropInvalid &&
        std::any_of(links.begin(), links.end(),
          [&](const TransformGraph::Link& link) { return !this->Transforms.Get(link).IsValid(i); });
      bool usable = !refused;
      for (std::size_t part = 0; usable && part < parts.size(); ++part)
      {
        usable = this->Transforms.Compose(parts[part], i, matrices[part]);
      }
      if (!usable)
      {
        continue;
      }
      std::size_t part = 0;
      if (const GeometryFinding finding =
            ofImage ? CheckImageChain(matrices, part) : CheckPose(matrices[0]))
      {
        Found& of = found[finding.Fault];
        if (of.Frames.empty())
        {
          of.Text = this->NameTransforms(part < parts.size() ? parts[part] : links) +
            (constant ? " of the calibration file " : " ") + finding.Text;
          of.Advice = finding.Advice;
        }
        of.Frames.push_back(i);
        this->Result.Impossible[i] |=
          GetAction(origin, finding.Fault) == GeometryAction::Flag ? 1 : 0;
      }
    }
    for (const auto& [fault, of] : found)
    {
      const std::string place = constant ? std::string()
                                         : " (frame " + std::to_string(of.Frames.front()) +
          ") in " + DescribeItems("frame", of.Frames);
      switch (GetAction(origin, fault))
      {
        case GeometryAction::Refuse:
          this->Result.Refusal =
            of.Text + "; " + of.Advice + ", or give another CalibrationFileName";
          return;
        case GeometryAction::Flag:
          this->Result.Warnings.push_back(
            of.Text + place + "; flagged in SliceStatus (1, pose invalid); " + of.Advice);
          break;
        default:
          this->Result.Warnings.push_back(of.Text + place + "; used nevertheless; " + of.Advice);
      }
    }
  }

  ChainJudgement Result;

private:
  std::string NameTransforms(const Chain& links) const
  {
    std::string names;
    for (const TransformGraph::Link& link : links)
    {
      names += (names.empty() ? "" : " and ") + this->Transforms.Get(link).Name;
    }
    return (links.size() > 1 ? "the product of transforms " : "transform ") + names;
  }

  const SweepTransforms& Transforms;
  std::size_t Count;
  bool DropInvalid;
};

// Links that belong to the calibration: from pixels to the probe, or to the first frame that moves.
std::size_t CountImageLinks(const SweepTransforms& transforms, const Chain& chain)
{
  std::size_t count = std::min<std::size_t>(1, chain.size());
  while (count < chain.size())
  {
    const SweepTransform& next = transforms.Get(chain[count]);
    const std::string& at = chain[count - 1].To;
    // a probe that is held still is one all the same
    if (!next.FromCalibration && !IsPictureFrame(at) && (at == "Probe" || !next.IsFixed()))
    {
      break;
    }
    ++count;
  }
  return count;
}
}

bool IsPictureFrame(const std::string& frame)
{
  return frame.find("Image") != std::string::npos;
}

//------------------------------------------------------------------------------
ChainJudgement JudgeChain(const SweepTransforms& transforms, const Chain& chain, std::size_t frames,
  bool fromPixels, bool dropInvalid)
{
  ChainJudge judge(transforms, frames, dropInvalid);
  const auto ofImage =
    static_cast<std::ptrdiff_t>(fromPixels ? CountImageLinks(transforms, chain) : 0);
  if (fromPixels)
  {
    judge.Judge(Chain(chain.begin(), chain.begin() + ofImage), true);
  }
  for (auto link = chain.begin() + ofImage; link != chain.end() && judge.Result.Refusal.empty();
       ++link)
  {
    judge.Judge({ *link }, false);
  }
  return std::move(judge.Result);
}
}
