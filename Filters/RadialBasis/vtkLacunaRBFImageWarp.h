// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkLacunaRBFImageWarp
 * @brief warps an image so that landmarks move to where they shall be
 *
 * Inputs: an image (port 0), the landmarks in it (port 1) and where they shall come to lie (port
 * 2): data sets whose points with equal index are a pair. World coordinates. Of an image of one
 * layer, the landmarks' position across it is not looked at and the warp is two-dimensional.
 *
 * A radial basis function with a linear polynomial (quadratic for the triharmonic) is fitted to
 * the way back from each target to its landmark, and says for each voxel of the output which place
 * of the input it shows (inverse mapping): so the output has no gaps. Its geometry, scalar type and
 * components are those of the input. A translation, rotation or other affine map of all landmarks
 * is reproduced exactly; with Smoothing above 0 landmarks are met approximately only.
 *
 * Output: the warped active scalars under their name; vtkValidPointMask (char, 1 where the voxel
 * shows a valid place of the input: all voxels that its grey level is interpolated from are 1 in the
 * input's own vtkValidPointMask, if it has one, and none is NaN). Other arrays of the input are left
 * out, since they are not warped. Field data:
 * | array          | components | meaning                                                        |
 * |----------------|------------|----------------------------------------------------------------|
 * | NodeCount      | 1          | landmark pairs at different places                             |
 * | Residual       | 1          | mm, largest in a component at a landmark, less what smoothing  |
 * |                |            | allows                                                         |
 * | FoldedFraction | 1          | share of the voxels where the mapping turns space inside out   |
 * A folded image shows some places more than once, one of them mirrored: there is a warning, since
 * landmarks cross or contradict one another then, or the kernel swings far from them. When the
 * affine map that fits the landmarks best is a reflection, or more than 5 % of the voxels in the
 * box around the targets are folded, that is an error, so that no patient is mirrored.
 *
 * A part of the output is made in the memory of the part and some 20 MB; the input is needed as a
 * whole. What is folded is a property of the whole image: it is counted once for a set of landmarks, by
 * all ranks together.
 *
 * Source: Carr 1996, section 6.1; Bookstein 1989.
 */
#ifndef vtkLacunaRBFImageWarp_h
#define vtkLacunaRBFImageWarp_h

#include "vtkImageAlgorithm.h"
#include "vtkLacunaAlgorithm.h"
#include "vtkLacunaFiltersRadialBasisModule.h" // for export macro

#include <memory>
#include <vector>

class vtkAlgorithmOutput;
class vtkImageData;
namespace lacuna
{
class AlgorithmExecution;
}

class VTKLACUNAFILTERSRADIALBASIS_EXPORT vtkLacunaRBFImageWarp
  : public vtkLacunaAlgorithmOf(vtkImageAlgorithm)
{
public:
  static vtkLacunaRBFImageWarp* New();
  vtkTypeMacro(vtkLacunaRBFImageWarp, vtkImageAlgorithm);

  enum KernelType
  {
    ThinPlate = 0,   ///< r^2 log r: bends least in two dimensions
    Linear = 1,      ///< r: bends least in three dimensions
    Triharmonic = 2, ///< r^4 log r
    Cubic = 3        ///< r^3
  };
  enum InterpolationType
  {
    Nearest = 0, ///< for labels
    LinearInterpolation = 1,
    CubicInterpolation = 2
  };

  ///@{
  /** The landmarks in the image (port 1), and where they shall come to lie (port 2). */
  void SetLandmarkConnection(vtkAlgorithmOutput* output) { this->SetInputConnection(1, output); }
  void SetTargetConnection(vtkAlgorithmOutput* output) { this->SetInputConnection(2, output); }
  ///@}

  ///@{
  /** Radial function. Default ThinPlate. */
  vtkSetMacro(Kernel, int);
  vtkGetMacro(Kernel, int);
  ///@}

  ///@{
  /**
   * mu >= 0. Above 0 the mapping minimises the sum of squares of its distances (mm) from the
   * landmarks plus mu times its energy; see lacuna::RadialBasisOptions. Default 0.
   */
  vtkSetMacro(Smoothing, double);
  vtkGetMacro(Smoothing, double);
  ///@}

  ///@{
  /** How grey levels between voxels are found. Default LinearInterpolation. */
  vtkSetMacro(Interpolation, int);
  vtkGetMacro(Interpolation, int);
  ///@}

  ///@{
  /** Grey level of voxels that show no (valid) place of the input. Default 0. */
  vtkSetMacro(OutsideValue, double);
  vtkGetMacro(OutsideValue, double);
  ///@}

  ///@{
  /** How wrong a position may be, in voxels, > 0 and < 1. Default 0.01. */
  vtkSetMacro(Accuracy, double);
  vtkGetMacro(Accuracy, double);
  ///@}

protected:
  vtkLacunaRBFImageWarp();
  ~vtkLacunaRBFImageWarp() override;
  int FillInputPortInformation(int port, vtkInformation* info) override;
  void Announce(const lacuna::Ports& ports) override;
  void Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution) override;
  void Describe(lacuna::Properties& properties) const override;

private:
  vtkLacunaRBFImageWarp(const vtkLacunaRBFImageWarp&) = delete;
  void operator=(const vtkLacunaRBFImageWarp&) = delete;

  struct Task;    ///< what is warped, by which pairs
  struct Outcome; ///< and what becomes of it

  void Prepare(const lacuna::Ports& ports, Task& task) const; ///< throws for what cannot be warped
  std::vector<double> GetKey(const Task& task) const;         ///< what the mapping depends on
  void Warp(lacuna::AlgorithmExecution& execution, const Task& task, Outcome& outcome) const;
  void CheckFolds(bool warns); ///< throws for many, warns of some
  void SetOutput(vtkImageData* output, const Task& task, const Outcome& outcome) const;

  int Kernel = ThinPlate;
  double Smoothing = 0;
  int Interpolation = LinearInterpolation;
  double OutsideValue = 0;
  double Accuracy = 0.01;

  // Of the whole image, whatever part of it is made, and what that was found for
  double FoldedFraction = 0;
  double FoldedInBox = 0;
  std::vector<double> FoldsOf;
};
#endif
