// SPDX-License-Identifier: BSD-3-Clause
/// @class vtkLacunaSkullPhantom
/// @brief a CT-like skull with a piece missing, whose intact surface is known in closed form
///
/// Output: vtkImageData, point scalars short (Hounsfield units), the head with its scalp and at
/// least 3 mm of air around it. Coordinates are patient millimetres, LPS: x = left, y = posterior,
/// z = superior; the head is about 180 mm long and 145 mm wide, the calvarium points up (+z) and
/// the origin of coordinates (Center) lies inside. The shape is not symmetric: the left side is
/// slightly larger and the left forehead carries a bony bump of 2.5 mm, so that a mirrored picture
/// shows.
///
/// The surface, tissues, blur and defect are described in lacunaSkull.h, and for users in
/// Documentation/UserGuide/skull-phantom.md. 500 HU lies exactly on the outer bone surface
/// (IntersectOuterSurface) for voxel edges up to 2.6 mm. The noise is a function of Seed and voxel:
/// the output depends neither on the number of threads nor on the requested piece.
///
/// Bad property values are errors that say what would be right; the output is then empty.
#ifndef vtkLacunaSkullPhantom_h
#define vtkLacunaSkullPhantom_h

#include "vtkImageAlgorithm.h"
#include "vtkLacunaAlgorithm.h"
#include "vtkLacunaSourcesPhantomsModule.h" // for export macro

#include <string> // for std::string

namespace lacuna
{
class Skull;
}

class VTKLACUNASOURCESPHANTOMS_EXPORT vtkLacunaSkullPhantom
  : public vtkLacunaAlgorithmOf(vtkImageAlgorithm)
{
public:
  static vtkLacunaSkullPhantom* New();
  vtkTypeMacro(vtkLacunaSkullPhantom, vtkImageAlgorithm);

  ///@{
  /// Voxel edges, mm, above 0 and at most 5. They also set the partial-volume blur. Default 1
  /// 1 2.3.
  vtkSetVector3Macro(Spacing, double);
  vtkGetVector3Macro(Spacing, double);
  ///@}

  ///@{
  /// Mean radius of the defect, mm, 0 (intact) to 40. Default 30.
  vtkSetMacro(DefectRadius, double);
  vtkGetMacro(DefectRadius, double);
  ///@}

  ///@{
  /// Where the defect lies, seen from Center; any length but zero. Default 0.4 -0.2 0.9 (top, a
  /// little to the left and to the front).
  vtkSetVector3Macro(DefectDirection, double);
  vtkGetVector3Macro(DefectDirection, double);
  ///@}

  ///@{
  /// Standard deviation of the noise, HU. Default 0.
  vtkSetMacro(NoiseLevel, double);
  vtkGetMacro(NoiseLevel, double);
  ///@}

  ///@{
  /// Chooses the noise. Default 0.
  vtkSetMacro(Seed, int);
  vtkGetMacro(Seed, int);
  ///@}

  ///@{
  /// Whether the bone has sutures, as a real skull; there the outer surface is not that of the truth.
  /// Default off.
  vtkSetMacro(Sutures, bool);
  vtkGetMacro(Sutures, bool);
  vtkBooleanMacro(Sutures, bool);
  ///@}

  ///@{
  /// The point about which the head is built, mm, LPS. Default 0 0 0.
  vtkSetVector3Macro(Center, double);
  vtkGetVector3Macro(Center, double);
  ///@}

  /// HU at a point (mm, LPS) of the intact skull, with the partial-volume blur of Spacing, without
  /// noise and rounding. NaN when a coordinate is not finite or a property is out of range.
  double EvaluateTruth(double x, double y, double z);

  /// Distance in mm from origin along the unit vector of direction to the first point of the outer
  /// bone surface of the intact skull, within 1e-9 mm: the truth for a depth map, also across the
  /// defect. NaN when the ray misses.
  double IntersectOuterSurface(const double origin[3], const double direction[3]);

  /// True within the cylinder around DefectDirection in which bone was removed, at any depth:
  /// whether a surface point of the intact skull is missing from the volume.
  bool IsInDefect(double x, double y, double z);

protected:
  vtkLacunaSkullPhantom();
  ~vtkLacunaSkullPhantom() override;
  void Announce(const lacuna::Ports& ports) override;
  void Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution) override;
  void Describe(lacuna::Properties& properties) const override;

  double Spacing[3] = { 1, 1, 2.3 };
  double DefectRadius = 30;
  double DefectDirection[3] = { 0.4, -0.2, 0.9 };
  double NoiseLevel = 0;
  int Seed = 0;
  bool Sutures = false;
  double Center[3] = { 0, 0, 0 };

private:
  vtkLacunaSkullPhantom(const vtkLacunaSkullPhantom&) = delete;
  void operator=(const vtkLacunaSkullPhantom&) = delete;

  struct Options;
  // Throws std::invalid_argument when a property is out of range.
  lacuna::Skull MakeSkull() const;
};
#endif
