// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Coordinate frames joined by transforms, and the chain of transforms that leads from one frame to
/// another.
#ifndef lacunaTransformGraph_h
#define lacunaTransformGraph_h

#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace lacuna
{
/// The ways in which name can be read as one frame to another, as in ProbeToReference: both
/// sides have letters, and the To is followed by anything but a lower-case letter (so 'ToolToTracker' has one reading).
std::vector<std::pair<std::string, std::string>> ReadTransformName(std::string_view name);

class TransformGraph
{
public:
  /// One link of a chain: a transform, taken backwards when Inverse is set, and where it leads.
  struct Link
  {
    int Transform;
    bool Inverse;
    std::string To;
  };

  /// Adds a transform from one frame to another; transform is the caller's number for it.
  void Add(const std::string& from, const std::string& to, int transform);

  bool HasFrame(const std::string& frame) const { return this->Frames.count(frame) > 0; }

  /// Finds the shortest chain, in the order in which it is applied; among equally short ones, the
  /// one whose transforms were added first. Empty when from and to are the same. Returns false when
  /// there is no chain.
  bool FindChain(const std::string& from, const std::string& to, std::vector<Link>& chain) const;

  /// Frames that a chain joins to this one, itself included, in alphabetical order.
  std::vector<std::string> GetReachable(const std::string& frame) const;

private:
  struct Arrival
  {
    std::string From;
    Link Step;
  };
  /// For each frame that can be reached from start, the last step of the way to it.
  std::map<std::string, Arrival> Search(const std::string& start) const;

  std::map<std::string, std::vector<Link>> Frames;
};
}
#endif
