// SPDX-License-Identifier: BSD-3-Clause
/// @class vtkLacunaOccludedAngle
/// @brief how much of its surroundings each point is hidden from, and the shape that follows
///
/// Tells inside from outside of incomplete, noisy surface data without normals, adjacency or a
/// model: a point inside is hidden in most directions, one outside in few. The angle is thresholded
/// and the result taken as data again, once per threshold, so that gaps close step by step
/// (Carr 1996, chapter 5).
///
/// Input 0: vtkImageData, 2-D or 3-D, with a point array of one component (ScalarArray). Input 1 (optional): an
/// image of the same geometry whose scalars are not 0 inside the reconstruction space; rays end
/// where they leave it.
///
/// Output: vtkImageData with the point arrays
/// - `OccludedAngle` (float, the scalars): radians 0...2 pi (2-D) or steradians 0...4 pi (3-D), the
///   last iteration's, computed from the object of the iteration before;
/// - `Object` (unsigned char): 1 where that angle reaches the last threshold,
///
/// and the field data, one tuple per iteration done: `ThresholdOverPi`, `LocalRadius` (mm),
/// `ObjectVoxels`, `ObjectVolume` (ml; 2-D: area in mm^2), `MeanAngle`, `SuggestedThresholdOverPi`
/// (0: none; from the histogram of the angle over the voxels that were not object before).
///
/// The whole input is needed for any part of the output. The ranks of an MPI program share the
/// directions (lacuna::ControllerRanks), so all of them must execute; each keeps the whole result, 5 bytes
/// per voxel. It does not depend on the number of threads or ranks. See lacunaOccludedAngle.h for the
/// method.
///
/// Errors: no data, equal grey levels, NaN or negative attenuation, a radius smaller than a voxel,
/// a schedule of radii of another length than that of thresholds, a reconstruction space of another
/// geometry or without data.
#ifndef vtkLacunaOccludedAngle_h
#define vtkLacunaOccludedAngle_h

#include "vtkImageAlgorithm.h"
#include "vtkLacunaAlgorithm.h"
#include "vtkLacunaFiltersOcclusionModule.h" // for export macro
#include "vtkSmartPointer.h"                 // for ownership

#include <string> // for the array's name
#include <vector> // for the schedule

class vtkImageData;
class vtkImplicitFunction;
class vtkPiecewiseFunction;

namespace lacuna
{
struct GrowthOptions;
}

class VTKLACUNAFILTERSOCCLUSION_EXPORT vtkLacunaOccludedAngle
  : public vtkLacunaAlgorithmOf(vtkImageAlgorithm)
{
public:
  static vtkLacunaOccludedAngle* New();
  vtkTypeMacro(vtkLacunaOccludedAngle, vtkImageAlgorithm);

  enum Modes
  {
    Continuous = 0,
    Binary = 1
  };
  enum Attenuations
  {
    LinearInRange = 0,
    ByOpacityFunction = 1,
    ByArray = 2
  };

  ///@{
  /// The point array with the data. Default empty: the active scalars.
  vtkSetMacro(ScalarArray, std::string);
  vtkGetMacro(ScalarArray, std::string);
  ///@}

  ///@{
  /// Continuous: a ray is hidden by 1 - exp(-attenuation along it). Binary: by the first voxel it
  /// meets that takes half of a ray or more (opacity from ln 2 / ln 20 = 0.23); such voxels are
  /// hidden themselves. Default Continuous.
  vtkSetMacro(Mode, int);
  vtkGetMacro(Mode, int);
  ///@}

  ///@{
  /// How grey levels become attenuation. LinearInRange: opacity 0 at the lowest to 1 at the
  /// highest level of the input. ByOpacityFunction: by OpacityFunction. ByArray: the scalars are
  /// attenuation coefficients per mm. A voxel of opacity o attenuates by o ln 20 over its shortest
  /// edge: one of opacity 1 takes 95 % of a ray (Carr 1996, section 5.6). Default LinearInRange.
  vtkSetMacro(Attenuation, int);
  vtkGetMacro(Attenuation, int);
  ///@}

  ///@{
  /// Opacity (0...1) as a function of grey level, for Attenuation ByOpacityFunction. Default none.
  void SetOpacityFunction(vtkPiecewiseFunction* function);
  vtkPiecewiseFunction* GetOpacityFunction() const;
  ///@}

  ///@{
  /// Over the whole circle or sphere; an odd number is raised by one, since a line serves two.
  /// 2...10000000; default 1000. The thesis uses 100 in 2-D and 1000 in 3-D.
  vtkSetMacro(NumberOfDirections, int);
  vtkGetMacro(NumberOfDirections, int);
  ///@}

  ///@{
  /// One threshold per iteration, in units of pi; 0 stands for half the full angle (pi in 2-D, 2 pi
  /// in 3-D). Default one, 0.
  void SetNumberOfThresholdsOverPi(int count);
  int GetNumberOfThresholdsOverPi() const;
  void SetThresholdsOverPi(int i, double value);
  double GetThresholdsOverPi(int i) const;
  ///@}

  ///@{
  /// How far rays go, mm: one value for all iterations, or one per iteration; 0: to the end of the
  /// reconstruction space. Default one, 0.
  void SetNumberOfLocalRadii(int count);
  int GetNumberOfLocalRadii() const;
  void SetLocalRadii(int i, double value);
  double GetLocalRadii(int i) const;
  ///@}

  ///@{
  /// The fraction of a ray that an object voxel of the second and later iterations takes over its
  /// shortest edge, above 0 and at most 1 (opaque). Default 0.95.
  vtkSetMacro(ObjectOpacity, double);
  vtkGetMacro(ObjectOpacity, double);
  ///@}

  ///@{
  /// In Mode Binary voxels hide as if they were larger by this, 0...0.9 voxels, so that gaps of that
  /// width between them are closed. Default 0: cubes of one voxel.
  vtkSetMacro(Dilation, double);
  vtkGetMacro(Dilation, double);
  ///@}

  ///@{
  /// Keep data voxels that take half of a ray or more (opacity from 0.23) as object in every
  /// iteration. Default off.
  vtkSetMacro(KeepData, bool);
  vtkGetMacro(KeepData, bool);
  vtkBooleanMacro(KeepData, bool);
  ///@}

  ///@{
  /// Edge length in voxels, odd, at most 255, of a median filter on the angle before it is
  /// thresholded; 1: none.
  /// Default 1.
  vtkSetMacro(MedianKernel, int);
  vtkGetMacro(MedianKernel, int);
  ///@}

  ///@{
  /// The part of space that is seen through, besides input 1: where the function is negative.
  /// Default none: the whole image.
  void SetReconstructionSpace(vtkImplicitFunction* function);
  vtkImplicitFunction* GetReconstructionSpace() const;
  ///@}

  ///@{
  /// Keep the result of each iteration: the output then has time steps 1...n, all of the first
  /// time step of the input; off: the time steps of the input. Costs 5 bytes per voxel and
  /// iteration. Default off.
  vtkSetMacro(KeepIterations, bool);
  vtkGetMacro(KeepIterations, bool);
  vtkBooleanMacro(KeepIterations, bool);
  ///@}

  ///@{
  /// Input 1.
  void SetReconstructionSpaceConnection(vtkAlgorithmOutput* output);
  void RemoveReconstructionSpaceConnection() { this->SetReconstructionSpaceConnection(nullptr); }
  ///@}

  vtkMTimeType GetMTime() override;

protected:
  vtkLacunaOccludedAngle();
  ~vtkLacunaOccludedAngle() override;
  int FillInputPortInformation(int port, vtkInformation* info) override;
  void Announce(const lacuna::Ports& ports) override;
  void Ask(const lacuna::Ports& ports) override;
  void Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution) override;
  void Describe(lacuna::Properties& properties) const override;

  std::string ScalarArray;
  int Mode = Continuous;
  int Attenuation = LinearInRange;
  vtkSmartPointer<vtkPiecewiseFunction> OpacityFunction;
  int NumberOfDirections = 1000;
  std::vector<double> ThresholdsOverPi = { 0 };
  std::vector<double> LocalRadii = { 0 };
  double ObjectOpacity = 0.95;
  double Dilation = 0;
  bool KeepData = false;
  int MedianKernel = 1;
  vtkSmartPointer<vtkImplicitFunction> ReconstructionSpace;
  bool KeepIterations = false;

private:
  vtkLacunaOccludedAngle(const vtkLacunaOccludedAngle&) = delete;
  void operator=(const vtkLacunaOccludedAngle&) = delete;

  class Run;
  lacuna::GrowthOptions GetOptions() const; // without the steps

  /// The iterations kept (the last one for ranks), and when they were made.
  std::vector<vtkSmartPointer<vtkImageData>> Iterations;
  std::vector<double> Made;
};
#endif
