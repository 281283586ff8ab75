// SPDX-License-Identifier: BSD-3-Clause
/// @class vtkLacunaIncompleteShape
/// @brief the outline or surface of a known shape in voxels, of which parts are missing
///
/// Output: vtkImageData, spacing 1 mm, centred at the origin, point scalars `Data` (unsigned char):
/// 1 where the shape was seen, 0 elsewhere. Field data: `CompleteVolume` (one tuple: ml; mm^2 for
/// curves), the truth. Test data for vtkLacunaOccludedAngle (Carr 1996, chapter 5). See
/// lacunaIncompleteShape.h for the shapes.
///
/// The output depends neither on the number of threads nor on the requested piece. Bad property
/// values are errors that say what would be right.
#ifndef vtkLacunaIncompleteShape_h
#define vtkLacunaIncompleteShape_h

#include "vtkImageAlgorithm.h"
#include "vtkLacunaAlgorithm.h"
#include "vtkLacunaSourcesPhantomsModule.h" // for export macro

namespace lacuna
{
class IncompleteShape;
}

class VTKLACUNASOURCESPHANTOMS_EXPORT vtkLacunaIncompleteShape
  : public vtkLacunaAlgorithmOf(vtkImageAlgorithm)
{
public:
  static vtkLacunaIncompleteShape* New();
  vtkTypeMacro(vtkLacunaIncompleteShape, vtkImageAlgorithm);

  enum Shapes
  {
    Circle = 0,
    Cavity = 1,
    Blob = 2,
    Cube = 3,
    Sphere = 4,
    Kumara = 5
  };

  ///@{
  /// Circle, Cavity and Blob are curves in a 2-D image. Default Circle.
  vtkSetMacro(Shape, int);
  vtkGetMacro(Shape, int);
  ///@}

  ///@{
  /// Voxels of the image; the shape fills it but for 12 voxels on every side. Curves use the first
  /// two. At least 28. Default 200 200 200.
  vtkSetVector3Macro(Dimensions, int);
  vtkGetVector3Macro(Dimensions, int);
  ///@}

  ///@{
  /// Fraction of the shape's voxels that are seen, above 0 and at most 1. Default 1.
  vtkSetMacro(PresentFraction, double);
  vtkGetMacro(PresentFraction, double);
  ///@}

  ///@{
  /// Missing in patches, not voxel by voxel. Default off.
  vtkSetMacro(Patches, bool);
  vtkGetMacro(Patches, bool);
  vtkBooleanMacro(Patches, bool);
  ///@}

  ///@{
  /// Least and largest radius of patches, mm. Default 3 8.
  vtkSetVector2Macro(PatchRadii, double);
  vtkGetVector2Macro(PatchRadii, double);
  ///@}

  ///@{
  /// Nothing is seen within this angle (degrees, full width) about the +x axis. Default 0.
  vtkSetMacro(GapAngle, double);
  vtkGetMacro(GapAngle, double);
  ///@}

  ///@{
  /// Echoes from inside of the shape: fraction of the voxels there, 0 to 1. Default 0.
  vtkSetMacro(TissueFraction, double);
  vtkGetMacro(TissueFraction, double);
  ///@}

  ///@{
  /// Wrong voxels anywhere in the image, as a fraction of the right ones, 0 to 10. Default 0.
  vtkSetMacro(OutlierFraction, double);
  vtkGetMacro(OutlierFraction, double);
  ///@}

  ///@{
  /// Chooses what is missing and where outliers are. Default 0.
  vtkSetMacro(Seed, int);
  vtkGetMacro(Seed, int);
  ///@}

  /// Signed distance in mm of a point to the complete shape, negative inside: the truth. Exact for
  /// Circle, Cube and Sphere, else to first order near the shape. NaN for bad property values.
  double EvaluateDistance(double x, double y, double z);

protected:
  vtkLacunaIncompleteShape();
  ~vtkLacunaIncompleteShape() override;
  void Announce(const lacuna::Ports& ports) override;
  void Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution) override;
  void Describe(lacuna::Properties& properties) const override;

  int Shape = Circle;
  int Dimensions[3] = { 200, 200, 200 };
  double PresentFraction = 1;
  bool Patches = false;
  double PatchRadii[2] = { 3, 8 };
  double GapAngle = 0;
  double TissueFraction = 0;
  double OutlierFraction = 0;
  int Seed = 0;

private:
  vtkLacunaIncompleteShape(const vtkLacunaIncompleteShape&) = delete;
  void operator=(const vtkLacunaIncompleteShape&) = delete;

  struct Options;
  // Throws std::invalid_argument when a property is out of range.
  lacuna::IncompleteShape MakeShape() const;
};
#endif
