// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A closed mesh or a signed distance image as a function of space.
#ifndef vtkLacunaSurfacePrior_h
#define vtkLacunaSurfacePrior_h

#include "lacunaSurfaceFollower.h"
#include "vtkSmartPointer.h"

class vtkDataSet;
class vtkImageData;
class vtkImplicitPolyDataDistance;

/// Signed distance in mm, negative inside. Gradients are differences over a short way.
class vtkLacunaSurfacePrior : public lacuna::ImplicitFunction
{
public:
  /// A mesh, or an image whose active scalars are the distance: trilinear; beyond it the distance from
  /// it is added. Throws std::runtime_error that says what is wrong.
  explicit vtkLacunaSurfacePrior(vtkDataSet* data);
  ~vtkLacunaSurfacePrior() override;

  void Evaluate(lacuna::Execution& execution, const std::vector<lacuna::Vec3>& points,
    std::vector<double>& values, std::vector<lacuna::Vec3>* gradients) const override;

private:
  double GetValue(const lacuna::Vec3& x) const;

  vtkSmartPointer<vtkImplicitPolyDataDistance> Mesh;
  vtkSmartPointer<vtkImageData> Image;
  double Step = 0; // mm
};
#endif
