// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A closed mesh, a signed distance image or an implicit function as a function of space.
#ifndef lacunaSurfacePrior_h
#define lacunaSurfacePrior_h

#include "lacunaSurfaceFollower.h"
#include "vtkSmartPointer.h"

class vtkDataSet;
class vtkImageData;
class vtkImplicitFunction;

namespace lacuna
{
/// Signed distance in mm, negative inside. Gradients are differences over a short way.
class SurfacePrior : public ImplicitFunction
{
public:
  /// A mesh, or an image whose active scalars are the distance: trilinear; beyond it the distance from
  /// it is added. Throws std::runtime_error that says what is wrong.
  explicit SurfacePrior(vtkDataSet* data);
  /// Any implicit function, negative inside: divided by the length of its gradient, so about the distance
  /// near its zeros. size: that of the data, mm.
  SurfacePrior(vtkImplicitFunction* function, double size);
  ~SurfacePrior() override;

  void Evaluate(Execution& execution, const std::vector<Vec3>& points, std::vector<double>& values,
    std::vector<Vec3>* gradients) const override;

private:
  double GetValue(const Vec3& x) const;

  vtkSmartPointer<vtkImplicitFunction> Function;
  bool IsDistance = true; // Function
  vtkSmartPointer<vtkImageData> Image;
  double Step = 0; // mm
};
}
#endif
