// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaCalibrationClusters.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <numeric>

namespace lacuna
{
namespace
{
constexpr double SmallestPart = 0.01; // of a direction that is held by more than one cluster

// The receiver and the image's corners, where they are in the tracker's coordinate system.
using Places = std::array<Vec3, 5>;

Places GetPlaces(const CalibrationPick& pick, const CalibrationState& state, const Vec2& farPixel)
{
  Places places;
  places[0] = pick.ProbeToTracker.Column(3);
  for (std::size_t corner = 0; corner < 4; ++corner)
  {
    const Eigen::Vector3d place = state.ImageOrigin +
      state.ImageRotation *
        Eigen::Vector3d((corner & 1) ? state.Spacing[0] * farPixel[0] : 0.0,
          (corner & 2) ? state.Spacing[1] * farPixel[1] : 0.0, 0);
    places[corner + 1] = pick.ProbeToTracker.Point({ place[0], place[1], place[2] });
  }
  return places;
}

double GetLargestDistance(const Places& a, const Places& b)
{
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
  {
    largest = std::max(largest, Norm(a[i] - b[i]));
  }
  return largest;
}
}

std::vector<std::size_t> FindCalibrationClusters(const std::vector<CalibrationPick>& picks,
  const CalibrationState& state, const Vec2& farPixel, double rest)
{
  std::vector<std::size_t> order(picks.size());
  std::iota(order.begin(), order.end(), std::size_t{ 0 });
  std::stable_sort(order.begin(), order.end(),
    [&picks](std::size_t a, std::size_t b) { return picks[a].Slice < picks[b].Slice; });
  std::vector<std::size_t> clusters(picks.size());
  std::size_t count = 0;
  std::int64_t slice = -1;
  Places first{};
  for (const std::size_t pick : order)
  {
    const std::int64_t own = picks[pick].Slice;
    if (own < 0 || own != slice)
    {
      const Places places = GetPlaces(picks[pick], state, farPixel);
      if (own < 0 || slice < 0 || GetLargestDistance(places, first) > rest)
      {
        first = places;
        ++count;
      }
      slice = own;
    }
    clusters[pick] = count - 1;
  }
  return clusters;
}

ClusteredCovariance GetClusteredCovariance(const CalibrationModel& model,
  const CalibrationState& state, const std::vector<double>& weights,
  const std::vector<std::size_t>& clusters, const Eigen::MatrixXd& root, double spread)
{
  // In coordinates of the unknowns in which the normal matrix is the unit matrix.
  struct Sums
  {
    Eigen::MatrixXd Normal;
    Eigen::VectorXd Gradient;
    double Equations = 0;
  };
  const Eigen::Index unknowns = root.cols();
  std::vector<Sums> sums(*std::max_element(clusters.begin(), clusters.end()) + 1,
    Sums{ Eigen::MatrixXd::Zero(unknowns, unknowns), Eigen::VectorXd::Zero(unknowns) });
  Eigen::MatrixXd derivatives;
  for (std::size_t pick = 0; pick < clusters.size(); ++pick)
  {
    if (weights[pick] > 0)
    {
      double errors[3];
      model.GetErrors(state, pick, errors);
      model.GetDerivatives(state, pick, derivatives);
      const Eigen::MatrixXd scaled = root.transpose() * derivatives;
      Sums& own = sums[clusters[pick]];
      own.Normal.noalias() += scaled * scaled.transpose();
      own.Gradient.noalias() += scaled * Eigen::Map<Eigen::VectorXd>(errors, scaled.cols());
      own.Equations += static_cast<double>(scaled.cols());
    }
  }
  ClusteredCovariance result;
  Eigen::MatrixXd middle = Eigen::MatrixXd::Zero(unknowns, unknowns);
  for (const Sums& own : sums)
  {
    if (own.Equations == 0)
    {
      continue;
    }
    ++result.Clusters;
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(own.Normal);
    Eigen::VectorXd part = eigen.eigenvectors().transpose() * own.Gradient;
    for (Eigen::Index u = 0; u < unknowns; ++u)
    {
      const double others = 1 - eigen.eigenvalues()[u]; // their part in what holds this direction
      if (others > SmallestPart)
      {
        part[u] /= others;
      }
      else
      {
        part[u] = 0;
        const Eigen::VectorXd direction = eigen.eigenvectors().col(u);
        middle.noalias() += spread * spread * own.Equations * direction * direction.transpose();
      }
    }
    const Eigen::VectorXd step = eigen.eigenvectors() * part;
    middle.noalias() += step * step.transpose();
  }
  const auto count = static_cast<double>(result.Clusters);
  result.Covariance = std::max(1.0, count - 1) / count * root * middle * root.transpose();
  return result;
}
}
