// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaVoxelVolume.h"

#include <algorithm>
#include <vector>

namespace lacuna
{
std::vector<Vec3> CornersOf(const Matrix4& indexToWorld, const std::array<int, 3>& size)
{
  std::vector<Vec3> corners;
  corners.reserve(8);
  for (int corner = 0; corner < 8; ++corner)
  {
    corners.push_back(indexToWorld.Point({ corner & 1 ? size[0] - 1.0 : 0.0,
      corner & 2 ? size[1] - 1.0 : 0.0, corner & 4 ? size[2] - 1.0 : 0.0 }));
  }
  return corners;
}

double SmallestEdgeOf(const Matrix4& indexToWorld)
{
  return std::min(
    { Norm(indexToWorld.Column(0)), Norm(indexToWorld.Column(1)), Norm(indexToWorld.Column(2)) });
}

ImagePlane MakeImagePlane(
  const Matrix4& indexToWorld, const std::array<int, 3>& size, const ViewSettings& view)
{
  CheckVolumeSize(size);
  return MakeImagePlane(CornersOf(indexToWorld, size), SmallestEdgeOf(indexToWorld), view);
}
}
