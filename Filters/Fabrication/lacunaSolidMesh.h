// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Solids of the kernels as triangles of VTK.
#ifndef lacunaSolidMesh_h
#define lacunaSolidMesh_h

#include "lacunaArrays.h"
#include "lacunaMatrix4.h"
#include "vtkCellData.h"
#include "vtkNew.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkUnsignedCharArray.h"

namespace lacuna
{
namespace SolidMesh
{
/// solid: Points, Triangles and for each of these one of its Faces, which becomes the cell array of
/// that name. toOutput: from its coordinates to those of output.
template <class Solid>
void Set(vtkPolyData* output, const Solid& solid, const Matrix4& toOutput, const char* facesName)
{
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  Arrays::SetNumberOfPoints(points, static_cast<vtkIdType>(solid.Points.size()));
  for (std::size_t k = 0; k < solid.Points.size(); ++k)
  {
    points->SetPoint(static_cast<vtkIdType>(k), toOutput.Point(solid.Points[k]).data());
  }
  const auto count = static_cast<vtkIdType>(solid.Triangles.size());
  vtkNew<vtkUnsignedCharArray> faces;
  faces->SetName(facesName);
  Arrays::SetNumberOfTuples(faces, count);
  for (vtkIdType k = 0; k < count; ++k)
  {
    faces->SetValue(k, static_cast<unsigned char>(solid.Faces[k]));
  }
  output->SetPoints(points);
  Arrays::SetTriangles(output, solid.Triangles);
  output->GetCellData()->SetScalars(faces);
}
}
}
#endif
