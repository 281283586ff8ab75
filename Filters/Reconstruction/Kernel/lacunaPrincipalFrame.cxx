// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaPrincipalFrame.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace lacuna
{
namespace
{
struct MeanAxis
{
  Vec3 Direction;   ///< unit
  double Agreement; ///< 0..1
};

// Each repetition brings the mean nearer to all directions or changes nothing.
constexpr int MostRepetitions = 100;
constexpr double EqualAgreement = 1e-9;

MeanAxis GetMeanAxis(const std::vector<Vec3>& directions)
{
  MeanAxis axis{ directions.front(), 1 };
  for (int n = 0; n < MostRepetitions; ++n)
  {
    Vec3 sum{ 0, 0, 0 };
    for (const Vec3& d : directions)
    {
      sum = sum + (Dot(d, axis.Direction) < 0 ? -1 : 1) * d;
    }
    const Vec3 mean = Normalized(sum);
    axis.Agreement = Norm(sum) / static_cast<double>(directions.size());
    if (mean == axis.Direction)
    {
      break;
    }
    axis.Direction = mean;
  }
  if (Dot(axis.Direction, directions.front()) < 0)
  {
    axis.Direction = -1 * axis.Direction;
  }
  return axis;
}
}

Matrix4 GetPrincipalFrame(const std::vector<SliceImage>& slices)
{
  if (slices.empty())
  {
    throw std::invalid_argument("there are no slices to align a frame with");
  }
  std::array<std::vector<Vec3>, 3> directions; // columns, rows, normals
  for (const SliceImage& slice : slices)
  {
    const Vec3 x = Normalized(slice.PixelToReference.Column(0));
    const Vec3 y = Normalized(slice.PixelToReference.Column(1));
    directions[0].push_back(x);
    directions[1].push_back(y);
    directions[2].push_back(Normalized(Cross(x, y)));
  }
  std::array<MeanAxis, 3> means;
  for (std::size_t a = 0; a < 3; ++a)
  {
    means[a] = GetMeanAxis(directions[a]);
  }
  std::array<std::size_t, 3> order{ 2, 1, 0 };
  const auto isBetter = [&](std::size_t a, std::size_t b)
  { return means[a].Agreement > means[b].Agreement + EqualAgreement; };
  // three elements by hand: "equally good" is no order for std::sort
  for (const std::size_t n : { 0, 1, 0 })
  {
    if (isBetter(order[n + 1], order[n]))
    {
      std::swap(order[n], order[n + 1]);
    }
  }

  const std::size_t first = order[0];
  const std::size_t second = order[1];
  const std::size_t third = order[2];
  std::array<Vec3, 3> axes;
  axes[first] = means[first].Direction;
  const Vec3& m = means[second].Direction;
  const Vec3 across = m - Dot(m, axes[first]) * axes[first];
  // Means of axes at right angles in each slice may be parallel in wild sweeps: then any will do.
  const std::size_t spare =
    std::min_element(axes[first].Elements.begin(), axes[first].Elements.end(),
      [](double a, double b) { return std::abs(a) < std::abs(b); }) -
    axes[first].Elements.begin();
  Vec3 unit{ 0, 0, 0 };
  unit[static_cast<int>(spare)] = 1;
  axes[second] = Normalized(Norm(across) > 1e-6 ? across : Cross(axes[first], unit));
  axes[third] = Cross(axes[(third + 1) % 3], axes[(third + 2) % 3]);
  return Matrix4::FromColumns(axes[0], axes[1], axes[2], { 0, 0, 0 });
}
}
