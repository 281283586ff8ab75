// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The other way from a volume to a depth map: VTK's FlyingEdges3D makes triangles, and a z-buffer
/// rasteriser draws them.
#ifndef lacunaSurfacePass_h
#define lacunaSurfacePass_h

#include "lacunaExecution.h"
#include "lacunaImagePlane.h"
#include "lacunaVTKThreads.h"
#include "lacunaVoxelVolume.h"

#include "vtkCellArray.h"
#include "vtkCellArrayIterator.h"
#include "vtkDataArray.h"
#include "vtkFloatArray.h"
#include "vtkFlyingEdges3D.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkShortArray.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace lacuna
{
/// Depth at the pixels' centres, parallel projection; NaN where there is no triangle. The threads
/// draw a share of the triangles each, into a buffer of their own.
class SurfacePass
{
public:
  /// volume: of Int16, not mirrored, with an IndexToWorld of spacings alone.
  SurfacePass(const VoxelVolume& volume, bool normals, int threads)
    : Threads(threads)
    , Normals(normals)
  {
    lacunaBenchmark::SetVTKThreads(threads);
    const Matrix4& m = volume.IndexToWorld;
    this->Image->SetDimensions(volume.Size.data());
    this->Image->SetSpacing(m(0, 0), m(1, 1), m(2, 2));
    vtkNew<vtkShortArray> scalars;
    scalars->SetArray(
      const_cast<short*>(static_cast<const short*>(volume.Voxels)), volume.NumberOfVoxels(), 1);
    this->Image->GetPointData()->SetScalars(scalars);
  }

  void Cast(const ImagePlane& plane, double isoValue, double* depth, float* normals)
  {
    vtkNew<vtkFlyingEdges3D> edges;
    edges->SetInputData(this->Image);
    edges->SetValue(0, isoValue);
    edges->SetComputeNormals(this->Normals);
    edges->ComputeScalarsOff();
    edges->Update();
    vtkPolyData* surface = edges->GetOutput();
    this->NumberOfTriangles = surface->GetNumberOfPolys();

    // columns, rows, depths
    const vtkIdType count = surface->GetNumberOfPoints();
    std::vector<std::array<float, 3>> points(count);
    const float* xyz = vtkFloatArray::SafeDownCast(surface->GetPoints()->GetData())->GetPointer(0);
    const float* pointNormals = this->Normals
      ? vtkFloatArray::SafeDownCast(surface->GetPointData()->GetNormals())->GetPointer(0)
      : nullptr;
    ThreadExecution execution(this->Threads);
    execution.For(count, 1 << 14,
      [&](std::int64_t begin, std::int64_t end)
      {
        for (std::int64_t i = begin; i < end; ++i)
        {
          const Vec3 p = Vec3{ xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2] } - plane.Origin;
          points[i] = { static_cast<float>(Dot(p, plane.Right) / plane.PixelSpacing),
            static_cast<float>(Dot(p, plane.Down) / plane.PixelSpacing),
            static_cast<float>(Dot(p, plane.View)) };
        }
      });

    const std::size_t pixels = static_cast<std::size_t>(plane.Size[0]) * plane.Size[1];
    this->Buffers.resize(this->Threads);
    execution.For(this->Threads, 1,
      [&](std::int64_t begin, std::int64_t)
      {
        std::vector<Fragment>& buffer = this->Buffers[begin];
        buffer.assign(pixels, Fragment{});
        const vtkIdType polys = surface->GetNumberOfPolys();
        const auto triangles = vtk::TakeSmartPointer(surface->GetPolys()->NewIterator());
        const vtkIdType last = polys * (begin + 1) / this->Threads;
        for (triangles->GoToCell(polys * begin / this->Threads);
             triangles->GetCurrentCellId() < last; triangles->GoToNextCell())
        {
          vtkIdType n;
          const vtkIdType* ids;
          triangles->GetCurrentCell(n, ids);
          Draw(points, ids, plane.Size, buffer);
        }
      });
    execution.For(static_cast<std::int64_t>(pixels), 1 << 14,
      [&](std::int64_t begin, std::int64_t end)
      {
        for (std::int64_t i = begin; i < end; ++i)
        {
          Fragment nearest = this->Buffers[0][i];
          for (int t = 1; t < this->Threads; ++t)
          {
            nearest = this->Buffers[t][i].Depth < nearest.Depth ? this->Buffers[t][i] : nearest;
          }
          const bool hit = nearest.Depth < std::numeric_limits<float>::infinity();
          depth[i] = hit ? nearest.Depth : std::numeric_limits<double>::quiet_NaN();
          for (int a = 0; pointNormals && a < 3; ++a)
          {
            normals[3 * i + a] = 0;
            for (int corner = 0; hit && corner < 3; ++corner)
            {
              normals[3 * i + a] +=
                nearest.Weights[corner] * pointNormals[3 * nearest.Points[corner] + a];
            }
          }
        }
      });
  }

  vtkIdType NumberOfTriangles = 0;

private:
  struct Fragment
  {
    float Depth = std::numeric_limits<float>::infinity();
    std::array<float, 3> Weights{};
    std::array<vtkIdType, 3> Points{};
  };

  static void Draw(const std::vector<std::array<float, 3>>& points, const vtkIdType* ids,
    const std::array<int, 2>& size, std::vector<Fragment>& buffer)
  {
    const auto& p = points[ids[0]];
    const auto& q = points[ids[1]];
    const auto& r = points[ids[2]];
    const int left = std::max(0, static_cast<int>(std::ceil(std::min({ p[0], q[0], r[0] }))));
    const int right = std::min(size[0] - 1, static_cast<int>(std::max({ p[0], q[0], r[0] })));
    const int top = std::max(0, static_cast<int>(std::ceil(std::min({ p[1], q[1], r[1] }))));
    const int bottom = std::min(size[1] - 1, static_cast<int>(std::max({ p[1], q[1], r[1] })));
    const float area = (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
    if (left > right || top > bottom || area == 0)
    {
      return;
    }
    for (int y = top; y <= bottom; ++y)
    {
      for (int x = left; x <= right; ++x)
      {
        const float u = static_cast<float>(x);
        const float v = static_cast<float>(y);
        const float a = ((q[0] - u) * (r[1] - v) - (q[1] - v) * (r[0] - u)) / area;
        const float b = ((r[0] - u) * (p[1] - v) - (r[1] - v) * (p[0] - u)) / area;
        const float c = 1 - a - b;
        if (a >= 0 && b >= 0 && c >= 0)
        {
          Fragment& fragment = buffer[x + static_cast<std::size_t>(size[0]) * y];
          const float depth = a * p[2] + b * q[2] + c * r[2];
          if (depth < fragment.Depth)
          {
            fragment = { depth, { a, b, c }, { ids[0], ids[1], ids[2] } };
          }
        }
      }
    }
  }

  vtkNew<vtkImageData> Image;
  int Threads;
  bool Normals;
  std::vector<std::vector<Fragment>> Buffers;
};
}
#endif
