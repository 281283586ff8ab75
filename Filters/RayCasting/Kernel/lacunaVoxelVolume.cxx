// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaVoxelVolume.h"

#include <algorithm>
#include <vector>

namespace lacuna
{
ImagePlane MakeImagePlane(
  const Matrix4& indexToWorld, const std::array<int, 3>& size, const ViewSettings& view)
{
  CheckVolumeSize(size);
  std::vector<Vec3> corners;
  for (int corner = 0; corner < 8; ++corner)
  {
    corners.push_back(indexToWorld.Point({ corner & 1 ? size[0] - 1.0 : 0.0,
      corner & 2 ? size[1] - 1.0 : 0.0, corner & 4 ? size[2] - 1.0 : 0.0 }));
  }
  const double smallestEdge = std::min(
    { Norm(indexToWorld.Column(0)), Norm(indexToWorld.Column(1)), Norm(indexToWorld.Column(2)) });
  return MakeImagePlane(corners, smallestEdge, view);
}
}
