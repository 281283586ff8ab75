// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The phase of the heart, or of breathing, at the instant of a slice.
#ifndef lacunaGateSignal_h
#define lacunaGateSignal_h

#include <array>
#include <vector>

namespace lacuna
{
/// What the values of a gate signal are.
enum class GateKind
{
  Value,  ///< a number that goes up and down, such as the volume of breath
  Phase,  ///< a number that grows by a period in each cycle and falls back to its beginning
  Trigger ///< there is no number, but an instant at which each cycle begins, such as the R wave
};
inline constexpr std::array<const char*, 3> GateKindNames{ "Value", "Phase", "Trigger" };

/// A signal that was sampled at some instants. Between two of them:
/// - Value: it changes evenly.
/// - Phase: it changes evenly along the shorter way around: from 0.9 to 0.2 of a period of 1 by
///   +0.3 over 1.0, and from 0.2 to 0.1 by -0.1. At half a period it goes forwards. So it must be
///   sampled more than twice in each cycle.
/// - Trigger: it grows evenly from 0 to the period from one instant to the next.
class GateSignal
{
public:
  /// times in s, in any order; values one for each, not used for triggers. Samples whose value is
  /// not finite are not used; of samples at the same time the first is. period: of Phase and
  /// Trigger, above 0. maximumGap: samples further apart than this many s have nothing between
  /// them; 0 = no limit. Throws std::invalid_argument when a time is not finite, when there is
  /// nothing to use (of triggers fewer than two), when there are not as many values as times, and
  /// for a period that is not above 0.
  GateSignal(GateKind kind, const std::vector<double>& times, const std::vector<double>& values,
    double period = 1, double maximumGap = 0);

  /// The signal at time; phases are >= 0 and < period. NaN before the first sample and after the
  /// last one (but for a microsecond, since files round times), and in gaps.
  double At(double time) const;

  double GetFirstTime() const { return this->Samples.front().Time; }
  double GetLastTime() const { return this->Samples.back().Time; }

private:
  struct Sample
  {
    double Time, Value;
  };
  GateKind Kind;
  double Period;
  double MaximumGap;
  std::vector<Sample> Samples; ///< times grow
};

/// Values that are let through: first..last, both included (but for rounding). With a period the
/// range wraps around: 0.9..0.2 of a period of 1 are the values from 0.9 on and those up to 0.2,
/// and so are -0.1..0.2.
class GateRange
{
public:
  /// period 0: values do not wrap around. Throws std::invalid_argument when a number is not finite,
  /// and when first > last for values that do not.
  GateRange(double first, double last, double period = 0);

  /// False for NaN.
  bool Accepts(double value) const;

private:
  double First, Last, Period;
};
}
#endif
