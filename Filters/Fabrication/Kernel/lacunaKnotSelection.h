// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// As few knots as a tolerance allows.
#ifndef lacunaKnotSelection_h
#define lacunaKnotSelection_h

#include <cstdint>
#include <vector>

namespace lacuna
{
class Execution;

/// Searches for the fewest knots with which the least squares cubic splines through many functions
/// sampled at the same sites deviate by no more than a tolerance. Knots are placed where the fourth
/// derivative asks for them (its fourth root is the density of knots at which all intervals deviate
/// alike: de Boor 1978, ch. XII), then moved until they do.
class KnotSelection
{
public:
  /// samples: one row of width values per site; points consist of the given number of consecutive
  /// values. Both are referred to, not copied.
  KnotSelection(const std::vector<double>& sites, const std::vector<double>& samples,
    std::int64_t width, int components);

  /// Interior knots of the space found, and its deviation.
  struct Result
  {
    std::vector<double> Interior;
    double Deviation;
  };

  /// The fewest knots found for a tolerance > 0; at most those of interpolation.
  Result Select(Execution& execution, double tolerance);

  /// The best place found for a given number of knots, 0 <= count <= sites - 4.
  Result SelectCount(Execution& execution, std::int64_t count);

private:
  struct Trial;
  std::vector<double> Place(std::int64_t count) const;
  Trial Try(Execution& execution, std::int64_t count) const;
  void Equalise(const Trial& trial);

  const std::vector<double>& Sites;
  const std::vector<double>& Samples;
  std::int64_t Width;
  int Components;
  std::vector<double> Density; // of knots, per interval between sites
  double LastCount = 0;        // of knots tried, and their deviation: where the next search starts
  double LastDeviation = 0;
};
}
#endif
