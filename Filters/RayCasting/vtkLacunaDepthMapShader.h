// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkLacunaDepthMapShader
 * @brief picture of a depth map: Phong or depth-only shading, depth cue, lights, shadows
 *
 * Normals. Stored: those of the map (analytic or grey-level, as its maker wrote them). The other
 * methods look at the depths alone: CentralDifference between both neighbours, which darkens
 * occluding edges; Gordon: mean of both slopes, steep ones weighted down; Predicate: the first of the
 * thesis's nine cases, which tell a discontinuity by MaximumAngle and MaximumAngleChange. Points are
 * taken in space, so a plane has its exact normal in perspective maps too.
 *
 * Shading. Phong: SurfaceColor x (Ambient + Diffuse sum I N.L) + white x Specular sum I cos^n, n =
 * SpecularPower. DepthOnly: the nearer, the brighter. DepthCue mixes that brightness into Phong. It
 * counts over the sphere around the volume, or around the map's points.
 *
 * Shadows: a point that the volume's surface, at the iso-value of the map's depths, hides from a
 * light gets none of it. What lies nearer to the point than ShadowBias along the ray is its own surface and
 * throws no shadow, nor does what CutAway takes away or what lies behind a lamp. The light at the
 * viewpoint throws none that could be seen.
 *
 * Formulas, the nine cases and pictures: Documentation/UserGuide/depth-map-shader.md.
 *
 * Input 0: a depth map, see lacunaDepthMap.h. Input 1 (optional): vtkImageData with point scalars of
 * one component, at least two voxels along each axis.
 *
 * Output: the same map with its arrays and geometry, and Color (unsigned char x 3, active scalars;
 * pixels without a depth have BackgroundColor, and 0 in vtkValidPointMask), the normals used (float x
 * 3, in Normals, for other depth arrays see lacuna::DepthMap::GetNormalsName) and, if the map had
 * normals and others were used, NormalDifference: degrees between both (float, NaN without a depth or
 * a normal).
 * Requested extents are honoured.
 *
 * Errors: input 0 is no depth map or has no such DepthArray, no normals are stored, a setting is out
 * of range, a light has no direction, the volume has no scalars or the map no IsoValues.
 *
 * Source: Carr 1996, 3.3; Gordon & Reynolds 1985.
 *
 * @sa vtkLacunaBSplineIsoRayCaster vtkLacunaDepthMapSurface
 */
#ifndef vtkLacunaDepthMapShader_h
#define vtkLacunaDepthMapShader_h

#include "vtkImageAlgorithm.h"
#include "vtkLacunaAlgorithm.h"
#include "vtkLacunaFiltersRayCastingModule.h" // for export macro

#include <array>  // for std::array
#include <memory> // for std::unique_ptr
#include <string> // for std::string
#include <vector> // for std::vector

class vtkImplicitFunction;

namespace lacuna
{
struct ShadingSettings;
}

class VTKLACUNAFILTERSRAYCASTING_EXPORT vtkLacunaDepthMapShader
  : public vtkLacunaAlgorithmOf(vtkImageAlgorithm)
{
public:
  static vtkLacunaDepthMapShader* New();
  vtkTypeMacro(vtkLacunaDepthMapShader, vtkImageAlgorithm);

  enum NormalMethodType
  {
    Stored = 0,
    CentralDifference,
    Gordon,
    Predicate
  };

  enum ShadingType
  {
    Phong = 0,
    DepthOnly
  };

  enum DepthLawType
  {
    InverseSquare = 0, ///< a point source
    Inverse            ///< between a point source and parallel light
  };

  /// As in vtkLacunaBSplineIsoRayCaster.
  enum InterpolationType
  {
    BSpline = 0,
    InterpolatingBSpline,
    Trilinear
  };
  enum SolidSideType
  {
    Above = 0,
    Below
  };

  ///@{
  /** The volume that throws shadows (input port 1, optional). */
  void SetVolumeConnection(vtkAlgorithmOutput* volume) { this->SetInputConnection(1, volume); }
  void RemoveVolume() { this->SetVolumeConnection(nullptr); }
  ///@}

  ///@{
  /** The point array with the depths in mm. Default Depth; Fitted shows the fit of a filled map. */
  vtkSetMacro(DepthArray, std::string);
  vtkGetMacro(DepthArray, std::string);
  ///@}

  ///@{
  /**
   * Where the normals come from, default Stored. Of Predicate: what is steeper may be a discontinuity
   * (degrees, 0..90, default 65), and angles that differ less are one surface (0..180, default 20).
   */
  vtkSetMacro(NormalMethod, int);
  vtkGetMacro(NormalMethod, int);
  vtkSetMacro(MaximumAngle, double);
  vtkGetMacro(MaximumAngle, double);
  vtkSetMacro(MaximumAngleChange, double);
  vtkGetMacro(MaximumAngleChange, double);
  ///@}

  ///@{
  /**
   * Phong (default) or DepthOnly. Parts of the light, >= 0, defaults 0.1, 0.7, 0.2: a surface towards
   * the viewer is white. Phong's exponent: greater makes highlights smaller; at least 0.001, default 20.
   */
  vtkSetMacro(Shading, int);
  vtkGetMacro(Shading, int);
  vtkSetMacro(Ambient, double);
  vtkGetMacro(Ambient, double);
  vtkSetMacro(Diffuse, double);
  vtkGetMacro(Diffuse, double);
  vtkSetMacro(Specular, double);
  vtkGetMacro(Specular, double);
  vtkSetMacro(SpecularPower, double);
  vtkGetMacro(SpecularPower, double);
  ///@}

  ///@{
  /**
   * Lights, world coordinates: w = 0: parallel light, x y z the direction towards it, any length;
   * w = 1: a lamp at x y z (mm). Intensity >= 0. Default none: one of intensity 1 at the viewpoint.
   */
  void AddLight(double x, double y, double z, double w, double intensity);
  void RemoveAllLights();
  int GetNumberOfLights() const { return static_cast<int>(this->Lights.size()); }
  ///@}

  ///@{
  /**
   * How much darker the far end of the data is (0..1, default 0); how brightness falls with depth
   * (default InverseSquare); colors of the surface and of pixels without a depth, red green blue, 0..1
   * (default white; black).
   */
  vtkSetMacro(DepthCue, double);
  vtkGetMacro(DepthCue, double);
  vtkSetMacro(DepthLaw, int);
  vtkGetMacro(DepthLaw, int);
  vtkSetVector3Macro(SurfaceColor, double);
  vtkGetVector3Macro(SurfaceColor, double);
  vtkSetVector3Macro(BackgroundColor, double);
  vtkGetVector3Macro(BackgroundColor, double);
  ///@}

  ///@{
  /**
   * Whether the volume, if there is one, throws shadows (default on); its point array with the grey
   * levels (default empty: the active scalars); the field between the voxels and its solid side, as the
   * map was made (default BSpline, Above). ShadowBias, see above: mm, >= 0; default 0: a tenth of the
   * smallest voxel edge.
   */
  vtkSetMacro(CastShadows, bool);
  vtkGetMacro(CastShadows, bool);
  vtkBooleanMacro(CastShadows, bool);
  vtkSetMacro(VolumeArray, std::string);
  vtkGetMacro(VolumeArray, std::string);
  vtkSetMacro(Interpolation, int);
  vtkGetMacro(Interpolation, int);
  vtkSetMacro(SolidSide, int);
  vtkGetMacro(SolidSide, int);
  vtkSetMacro(ShadowBias, double);
  vtkGetMacro(ShadowBias, double);
  ///@}

  ///@{
  /**
   * What throws no shadow: the volume where this function is negative; and whether the solid is opaque
   * where it is cut and where the volume ends. As the map was made, see vtkLacunaBSplineIsoRayCaster.
   * Default none, on, off.
   */
  void SetCutAway(vtkImplicitFunction* function);
  vtkImplicitFunction* GetCutAway() const;
  vtkSetMacro(CapCutAway, bool);
  vtkGetMacro(CapCutAway, bool);
  vtkBooleanMacro(CapCutAway, bool);
  vtkSetMacro(CapBoundary, bool);
  vtkGetMacro(CapBoundary, bool);
  vtkBooleanMacro(CapBoundary, bool);
  ///@}

  vtkMTimeType GetMTime() override;

protected:
  vtkLacunaDepthMapShader();
  ~vtkLacunaDepthMapShader() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  void Announce(const lacuna::Ports& ports) override;
  void Ask(const lacuna::Ports& ports) override;
  void Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution) override;
  void Describe(lacuna::Properties& properties) const override;

  std::string DepthArray = "Depth";
  int NormalMethod = Stored;
  double MaximumAngle = 65;
  double MaximumAngleChange = 20;
  int Shading = Phong;
  double Ambient = 0.1;
  double Diffuse = 0.7;
  double Specular = 0.2;
  double SpecularPower = 20;
  double DepthCue = 0;
  int DepthLaw = InverseSquare;
  double SurfaceColor[3] = { 1, 1, 1 };
  double BackgroundColor[3] = { 0, 0, 0 };
  bool CastShadows = true;
  std::string VolumeArray;
  int Interpolation = BSpline;
  int SolidSide = Above;
  double ShadowBias = 0;
  bool CapCutAway = true;
  bool CapBoundary = false;
  std::vector<std::array<double, 5>> Lights;

private:
  vtkLacunaDepthMapShader(const vtkLacunaDepthMapShader&) = delete;
  void operator=(const vtkLacunaDepthMapShader&) = delete;

  bool NeedsWholeMap();
  lacuna::ShadingSettings GetOptions() const;

  class Internals;
  std::unique_ptr<Internals> Internal;
};
#endif
