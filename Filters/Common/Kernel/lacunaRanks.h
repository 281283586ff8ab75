// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// How kernels share work among processes.
#ifndef lacunaRanks_h
#define lacunaRanks_h

#include <cstdint>
#include <functional>
#include <stdexcept>

namespace lacuna
{
/// Thrown on the ranks that have gone on when another one threw.
class OtherRankStopped : public std::runtime_error
{
public:
  OtherRankStopped();
};

/// Processes that run a kernel on the same data. A kernel takes a Ranks& and does its own part of
/// the work, by its rank; its result must not depend on how many ranks there are. This class is one
/// rank alone.
///
/// Together, Sum and AllFine wait for all ranks: each of them must call the same in the same order.
class Ranks
{
public:
  virtual ~Ranks() = default;

  /// 0 <= rank < number.
  virtual int GetRank() const { return 0; }
  virtual int GetNumber() const { return 1; }

  /// Calls body. If it throws on any rank, all throw: the others OtherRankStopped, so that nobody
  /// waits for a rank that has given up.
  void Together(const std::function<void()>& body) const;

  /// Replaces each of values by its sum over the ranks, which must fit its type.
  virtual void Sum(std::uint32_t* values, std::int64_t count) const;
  virtual void Sum(std::uint64_t* values, std::int64_t count) const;

  /// Whether fine is true on all ranks.
  virtual bool AllFine(bool fine) const { return fine; }
};
}
#endif
