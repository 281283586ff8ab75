// SPDX-License-Identifier: BSD-3-Clause
/// @class vtkLacunaPhantomSweep
/// @brief a freehand ultrasound sweep over an analytic scene whose truth is known
///
/// Moves a simulated probe over a scene and images it. Output: tracked slices as in
/// lacunaTrackedSlices.h, ImageSize[0] x ImageSize[1] x NumberOfSlices, unsigned char or float,
/// with the field data ImageToReference, Timestamp (25 slices per second), SliceStatus (all valid),
/// FrameNumber, ProbeToReference (double, 16 components, one tuple per slice) and ImageToProbe (one
/// tuple); ImageToReference = ProbeToReference * ImageToProbe.
///
/// Scenes, motions and the models of speckle and pose noise are described in
/// lacunaPhantomScene.h, lacunaProbeMotion.h and lacunaPhantomSweep.h, and for users in
/// Documentation/UserGuide/phantom-sweep.md. All noise is a function of Seed, slice and pixel: the
/// output depends neither on the number of threads nor on the requested piece.
///
/// Optional input: a vtkImageData whose active point scalars (first component) are imaged instead
/// of the analytic scene: trilinear, 0 outside of the box of its points.
///
/// Bad property values are errors that say what would be right; the output is then empty.
#ifndef vtkLacunaPhantomSweep_h
#define vtkLacunaPhantomSweep_h

#include "vtkImageAlgorithm.h"
#include "vtkLacunaAlgorithm.h"
#include "vtkLacunaSourcesPhantomsModule.h" // for export macro

#include <memory> // for std::unique_ptr
#include <string> // for std::string

class vtkAlgorithmOutput;

namespace lacuna
{
class PhantomScene;
}

class VTKLACUNASOURCESPHANTOMS_EXPORT vtkLacunaPhantomSweep
  : public vtkLacunaAlgorithmOf(vtkImageAlgorithm)
{
public:
  static vtkLacunaPhantomSweep* New();
  vtkTypeMacro(vtkLacunaPhantomSweep, vtkImageAlgorithm);

  enum MotionType
  {
    Sweep,
    Fan,
    Twist,
    Arbitrary
  };
  enum AnatomyType
  {
    Ellipsoids,
    Kumara,
    Vessels,
    Linear
  };
  enum ScalarType
  {
    UnsignedChar,
    Float
  };

  ///@{
  /// Slices of all sweeps together, at least 1. Default 60.
  vtkSetMacro(NumberOfSlices, int);
  vtkGetMacro(NumberOfSlices, int);
  ///@}

  ///@{
  /// Columns and rows of a slice, at least 1. Default 320 240.
  vtkSetVector2Macro(ImageSize, int);
  vtkGetVector2Macro(ImageSize, int);
  ///@}

  ///@{
  /// Edge of the square pixels, mm, above 0. Default 0.2.
  vtkSetMacro(PixelSpacing, double);
  vtkGetMacro(PixelSpacing, double);
  ///@}

  ///@{
  /// How the probe moves (MotionType). Default Sweep.
  vtkSetMacro(Motion, int);
  vtkGetMacro(Motion, int);
  ///@}

  ///@{
  /// Sweeps that cross each other, turned by 180/NumberOfSweeps degrees about the depth axis. From
  /// 1 to NumberOfSlices. Default 1.
  vtkSetMacro(NumberOfSweeps, int);
  vtkGetMacro(NumberOfSweeps, int);
  ///@}

  ///@{
  /// Standard deviation of the multiplicative noise relative to the grey level, 0 to 10. Default 0.
  vtkSetMacro(SpeckleLevel, double);
  vtkGetMacro(SpeckleLevel, double);
  ///@}

  ///@{
  /// Standard deviations of the recorded pose: position along each axis (mm) and angle about each
  /// axis of the probe (degrees). The pixels are imaged at the true pose. Default 0 0.
  vtkSetVector2Macro(PoseNoise, double);
  vtkGetVector2Macro(PoseNoise, double);
  ///@}

  ///@{
  /// What is imaged (AnatomyType). Default Ellipsoids.
  vtkSetMacro(Anatomy, int);
  vtkGetMacro(Anatomy, int);
  ///@}

  ///@{
  /// Chooses the noise. Default 0.
  vtkSetMacro(Seed, int);
  vtkGetMacro(Seed, int);
  ///@}

  ///@{
  /// Way of the probe in motions Sweep and Arbitrary, mm. Default 50.
  vtkSetMacro(Travel, double);
  vtkGetMacro(Travel, double);
  ///@}

  ///@{
  /// Whole angle swept in motions Fan and Twist, degrees. Default 60.
  vtkSetMacro(SweepAngle, double);
  vtkGetMacro(SweepAngle, double);
  ///@}

  ///@{
  /// Amplitudes in motion Arbitrary: turning about the depth axis (degrees), tilting about the
  /// lateral axis (degrees), swaying sideways (mm). Defaults 12, 8, 2.
  vtkSetMacro(TwistAngle, double);
  vtkGetMacro(TwistAngle, double);
  vtkSetMacro(FanAngle, double);
  vtkGetMacro(FanAngle, double);
  vtkSetMacro(Wander, double);
  vtkGetMacro(Wander, double);
  ///@}

  ///@{
  /// Width of the edges of the scene from 0 to 100 %, mm, above 0 and at most 4. Default 1.5.
  vtkSetMacro(EdgeWidth, double);
  vtkGetMacro(EdgeWidth, double);
  ///@}

  ///@{
  /// Where the middle of the image is at the middle of a sweep: mm in the reference frame, with an
  /// input volume relative to the middle of its bounds. Default 0 0 0.
  vtkSetVector3Macro(Center, double);
  vtkGetVector3Macro(Center, double);
  ///@}

  ///@{
  /// Type of the grey levels (ScalarType): rounded once and limited to 0..255, or as they are.
  /// Default UnsignedChar.
  vtkSetMacro(OutputScalarType, int);
  vtkGetMacro(OutputScalarType, int);
  ///@}

  /// Grey level of the analytic scene, without noise or rounding, at a point of the reference frame
  /// (mm). NaN when an input volume takes its place, a coordinate is not finite, or EdgeWidth or
  /// Anatomy is out of range.
  double EvaluateTruth(double x, double y, double z);

  /// Adds the point array Truth (float), EvaluateTruth at each of its points, to grid; in parallel.
  /// The error of a reconstruction is its difference to that. Returns false after an error.
  bool AddTruth(vtkImageData* grid);

  ///@{
  /// The level of the iso-surface that is exactly the surface of the object of interest (the main
  /// ellipsoid, the kumara, the vessels), and the volume in mm3 inside of it. NaN where there is no
  /// object (Linear), no closed form (volume of Vessels) or an input volume.
  double GetTrueIsoValue();
  double GetTrueVolume();
  ///@}

  /// The same as SetInputConnection(volume). ParaView uses it: on port 0 paraview.simple would
  /// connect the active source unasked.
  void SetVolumeConnection(int port, vtkAlgorithmOutput* volume);

protected:
  vtkLacunaPhantomSweep();
  ~vtkLacunaPhantomSweep() override;
  int FillInputPortInformation(int port, vtkInformation* info) override;
  void Announce(const lacuna::Ports& ports) override;
  void Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution) override;
  void Describe(lacuna::Properties& properties) const override;

  int NumberOfSlices = 60;
  int ImageSize[2] = { 320, 240 };
  double PixelSpacing = 0.2;
  int Motion = Sweep;
  int NumberOfSweeps = 1;
  double SpeckleLevel = 0;
  double PoseNoise[2] = { 0, 0 };
  int Anatomy = Ellipsoids;
  int Seed = 0;
  double Travel = 50;
  double SweepAngle = 60;
  double TwistAngle = 12;
  double FanAngle = 8;
  double Wander = 2;
  double EdgeWidth = 1.5;
  double Center[3] = { 0, 0, 0 };
  int OutputScalarType = UnsignedChar;

private:
  vtkLacunaPhantomSweep(const vtkLacunaPhantomSweep&) = delete;
  void operator=(const vtkLacunaPhantomSweep&) = delete;

  struct Options; // of the motion
  // Throws std::invalid_argument when a property is out of range.
  const lacuna::PhantomScene& GetScene();
  // The scene, or nullptr when there is none or it cannot be made.
  const lacuna::PhantomScene* FindScene();

  std::unique_ptr<lacuna::PhantomScene> Scene;
  int SceneAnatomy = -1;
  double SceneEdgeWidth = 0;
};
#endif
