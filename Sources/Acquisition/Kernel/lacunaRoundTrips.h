// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Which answers come too late to know the instant that they hold for.
#ifndef lacunaRoundTrips_h
#define lacunaRoundTrips_h

#include <algorithm>
#include <limits>

namespace lacuna
{
/// A measurement holds for the arrival of its request at the unit. What an answer took longer than
/// the quickest of late, its request may have waited for on the way: in a busy computer, an adapter.
class RoundTrips
{
public:
  /// tolerance: s more than the quickest. USB adapters collect bytes for up to 16 ms.
  explicit RoundTrips(double tolerance = 0.02)
    : Tolerance(tolerance)
  {
  }

  /// Of the next answer, seconds after its request. A line that has become slower for good is known
  /// after 50 to 100 answers.
  bool IsLate(double seconds)
  {
    constexpr int many = 50;
    if (this->Count == many)
    {
      this->Before = this->Quickest;
      this->Quickest = std::numeric_limits<double>::infinity();
      this->Count = 0;
    }
    ++this->Count;
    this->Quickest = std::min(this->Quickest, seconds);
    return seconds > std::min(this->Before, this->Quickest) + this->Tolerance;
  }

private:
  double Tolerance;
  double Quickest = std::numeric_limits<double>::infinity(); ///< of the newest answers
  double Before = std::numeric_limits<double>::infinity();   ///< of the 50 before them
  int Count = 0;
};
}
#endif
