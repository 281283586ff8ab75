// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaCasterView.h"

#include "lacunaDepthMap.h"
#include "lacunaParameterText.h"
#include "lacunaTrackedSlices.h"
#include "lacunaVolumeDirection.h"
#include "lacunaVoxelVolume.h"
#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkMatrix3x3.h"
#include "vtkMatrix4x4.h"
#include "vtkNew.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

namespace
{
lacuna::Matrix4 IndexToWorld(
  const double* origin, const double* spacing, const double* direction, const int* extent)
{
  for (int a = 0; a < 3; ++a)
  {
    if (!(std::abs(spacing[a]) > 0) || !std::isfinite(spacing[a]))
    {
      throw std::runtime_error("the voxels of the volume are " +
        lacuna::FormatValue(std::array<double, 3>{ spacing[0], spacing[1], spacing[2] }) +
        " mm: every edge must be longer than 0; mend the spacing of the input");
    }
  }
  const double volume = vtkMatrix3x3::Determinant(direction);
  if (!(std::abs(volume) > 1e-9) || !std::isfinite(volume))
  {
    std::array<double, 9> elements;
    std::copy_n(direction, 9, elements.begin());
    throw std::runtime_error("the direction matrix of the volume is " +
      lacuna::FormatValue(elements) +
      ": its columns, the axes of the voxels, must be numbers and must not lie in one plane; mend "
      "the directions of the input");
  }
  vtkNew<vtkMatrix4x4> m;
  vtkImageData::ComputeIndexToPhysicalMatrix(origin, spacing, direction, m->GetData());
  return lacuna::Matrix4(m->GetData()) *
    lacuna::Matrix4::Translation({ static_cast<double>(extent[0]), static_cast<double>(extent[2]),
      static_cast<double>(extent[4]) });
}
}

//------------------------------------------------------------------------------
std::array<int, 3> lacuna::CasterView::SizeOf(const int extent[6])
{
  return { extent[1] - extent[0] + 1, extent[3] - extent[2] + 1, extent[5] - extent[4] + 1 };
}

//------------------------------------------------------------------------------
bool lacuna::CasterView::IsEmpty(const int extent[6])
{
  const auto size = SizeOf(extent);
  return size[0] <= 0 || size[1] <= 0 || size[2] <= 0;
}

//------------------------------------------------------------------------------
lacuna::CasterView::Frame lacuna::CasterView::FrameOf(vtkImageData* volume)
{
  lacuna::TrackedSlices::Refuse(volume);
  lacuna::VolumeDirection::Check(volume);
  return { SizeOf(volume->GetExtent()),
    IndexToWorld(volume->GetOrigin(), volume->GetSpacing(), volume->GetDirectionMatrix()->GetData(),
      volume->GetExtent()) };
}

//------------------------------------------------------------------------------
std::vector<double> lacuna::CasterView::StartDepths(
  vtkImageData* map, const lacuna::ImagePlane& plane, const lacuna::Vec3* eye, const int extent[6])
{
  const lacuna::DepthMap start(map);
  const lacuna::Matrix4 wanted = lacuna::Matrix4::FromColumns(
    plane.PixelSpacing * plane.Right, plane.PixelSpacing * plane.Down, plane.View, plane.Origin);
  bool same = start.IsPerspective() == (eye != nullptr);
  for (int i = 0; i < 12; ++i)
  {
    const double difference = wanted(i / 4, i % 4) - start.GetImageToWorld()(i / 4, i % 4);
    same = same && std::abs(difference) <= 1e-6 * plane.PixelSpacing;
  }
  if (same && eye)
  {
    const lacuna::Vec3 seen = start.GetPoint(0, 0, 0) - *eye;
    same = lacuna::Norm(lacuna::Normalized(seen) - start.GetRay(0, 0)) < 1e-9;
  }
  const int* has = map->GetExtent();
  for (int a = 0; a < 2; ++a)
  {
    same = same && has[2 * a] <= extent[2 * a] && has[2 * a + 1] >= extent[2 * a + 1];
  }
  if (!same)
  {
    throw std::runtime_error("the start depth map shows another view: give both filters the same "
                             "view, PixelSpacing, ImageSize and PlaneOrigin");
  }
  std::vector<double> depths;
  for (int y = extent[2]; y <= extent[3]; ++y)
  {
    for (int x = extent[0]; x <= extent[1]; ++x)
    {
      int pixel[3] = { x, y, has[4] };
      depths.push_back(start.GetDepth()->GetTuple1(map->ComputePointId(pixel)));
    }
  }
  return depths;
}
