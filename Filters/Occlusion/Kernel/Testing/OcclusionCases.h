// SPDX-License-Identifier: BSD-3-Clause
#ifndef OcclusionCases_h
#define OcclusionCases_h

#include "lacunaOccludedAngle.h"

#include <cmath>
#include <cstdint>
#include <vector>

namespace lacuna
{
constexpr double Pi = 3.14159265358979323846;

/// Calls set(i, j, k) -> value for each voxel.
template <class Set>
void FillField(AttenuationField& field, Set&& set)
{
  const auto& n = field.GetDimensions();
  for (std::int64_t k = 0; k < n[2]; ++k)
  {
    for (std::int64_t j = 0; j < n[1]; ++j)
    {
      for (std::int64_t i = 0; i < n[0]; ++i)
      {
        field.Row(j, k)[i] = static_cast<float>(set(i, j, k));
      }
    }
  }
}

inline std::vector<float> GetAngle(
  AttenuationField& field, const OccludedAngleOptions& options, int threads = 1)
{
  std::vector<float> angle(field.GetNumberOfVoxels());
  ThreadExecution execution(threads);
  ComputeOccludedAngle(field, options, angle.data(), execution);
  return angle;
}

/// Repeatable numbers 0 <= x < 1.
class Numbers
{
public:
  explicit Numbers(std::uint64_t seed)
    : State(seed)
  {
  }
  double operator()()
  {
    this->State = this->State * 6364136223846793005ULL + 1442695040888963407ULL;
    return static_cast<double>(this->State >> 11) * 0x1p-53;
  }

private:
  std::uint64_t State;
};
}
#endif
