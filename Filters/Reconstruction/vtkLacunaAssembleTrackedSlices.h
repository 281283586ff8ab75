// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkLacunaAssembleTrackedSlices
 * @brief   Tracked slices from an image stack and a table of poses
 *
 * Joins pictures and poses that were recorded on their own: the result is tracked slices (see
 * lacunaTrackedSlices.h), as the other freehand filters take them.
 *
 * Input 0: an image stack, column x row x slice. Its origin, spacing and direction are not used:
 * pixels are counted, and PixelSpacing says how large they are. A two-dimensional image with time
 * steps gives one slice for each of them. Colours become luminance (lacunaLuminance.h), an alpha
 * channel is left out. Input 1: a vtkTable with one row for each pose; columns with several
 * components count as several columns named "name:0", ...
 *
 * Output: the stack with the extent of the input, coordinates (column, row, slice from 0). Point
 * data: Intensity (the input's type). Field data, one tuple per slice: ImageToReference (unless the
 * probe is not calibrated), ProbeToReference (when the poses are the probe's), SliceStatus,
 * FrameNumber, Timestamp (where known) and Gate (when there is such a column); one tuple:
 * ImageToProbe (when known); Provenance. Other field data of the input are not copied.
 *
 * Rows without a pose, named in a warning, and slices without a row get SliceStatus 1. It is an
 * error when columns are missing or may be chosen in more than one way, when rows and slices do not
 * match, when a pose mirrors, is not rigid or has a quaternion that is not of length 1, and when
 * the size of a pixel is given twice or not at all.
 *
 * The pieces and extents asked for are honoured; the table is asked for as a whole.
 *
 * @sa lacunaPoseColumns.h, lacunaPoseTable.h, lacunaPoseMatching.h
 */
#ifndef vtkLacunaAssembleTrackedSlices_h
#define vtkLacunaAssembleTrackedSlices_h

#include "vtkImageAlgorithm.h"
#include "vtkLacunaAlgorithm.h"
#include "vtkLacunaFiltersReconstructionModule.h" // for export macro
#include "vtkSmartPointer.h"                      // for ownership

#include <string> // for std::string
#include <vector> // for std::vector

namespace lacuna
{
class AlgorithmExecution;
}
class vtkTable;

class VTKLACUNAFILTERSRECONSTRUCTION_EXPORT vtkLacunaAssembleTrackedSlices
  : public vtkLacunaAlgorithmOf(vtkImageAlgorithm)
{
public:
  static vtkLacunaAssembleTrackedSlices* New();
  vtkTypeMacro(vtkLacunaAssembleTrackedSlices, vtkImageAlgorithm);

  enum PoseFormats
  {
    Matrix = 0,
    Quaternion = 1,
    Euler = 2
  };
  enum PoseTransforms
  {
    ProbeToReference = 0,
    ReferenceToProbe = 1,
    ImageToReference = 2,
    ReferenceToImage = 3
  };
  enum LengthUnits
  {
    Millimetre = 0,
    Metre = 1,
    Centimetre = 2,
    Inch = 3
  };
  enum RowOrders
  {
    Automatic = 0,
    TopRowFirst = 1,
    BottomRowFirst = 2
  };
  enum Matchings
  {
    Order = 0,
    FrameNumber = 1,
    Time = 2
  };

  /// The table of poses, input 1.
  void SetPosesConnection(vtkAlgorithmOutput* output) { this->SetInputConnection(1, output); }

  ///@{
  /// How a row gives a pose: Matrix (12 or 16 columns), Quaternion (position and unit quaternion)
  /// or Euler (position, then degrees: azimuth about z, elevation about the new y, roll about the
  /// new x). PoseTransform is what it maps, AToB turns coordinates in A into coordinates in B;
  /// LengthUnit is that of the table. Default: Matrix, ProbeToReference, Millimetre.
  vtkSetMacro(PoseFormat, int);
  vtkGetMacro(PoseFormat, int);
  vtkSetMacro(PoseTransform, int);
  vtkGetMacro(PoseTransform, int);
  vtkSetMacro(LengthUnit, int);
  vtkGetMacro(LengthUnit, int);
  ///@}

  ///@{
  /// mm between columns and between rows. 0: the size of a pixel is in the matrices, in
  /// ImageToProbe or in the poses of the image. Default: 0 0.
  void SetPixelSpacing(double columns, double rows);
  void SetPixelSpacing(double both) { this->SetPixelSpacing(both, both); }
  vtkGetVector2Macro(PixelSpacing, double);
  /// For ParaView, where the property has one number or two.
  void SetNumberOfPixelSpacings(int count);
  void SetPixelSpacingAt(int i, double spacing);
  ///@}

  ///@{
  /// Calibration, 16 numbers row by row: (column, row, 0, 1) to mm in the probe frame; with a
  /// PixelSpacing, (mm along the columns, mm along the rows, 0, 1) to mm. Default: identity.
  void SetImageToProbe(const double elements[16]);
  const double* GetImageToProbe() const { return this->ImageToProbe; }
  ///@}

  ///@{
  /// Which row of the picture comes first in the stack. Slices count rows from the top. Automatic:
  /// the bottom one where the array's name is that of VTK's readers of PNG, JPEG, BMP and
  /// DICOM, which read so, else the top one. Default: Automatic.
  vtkSetMacro(RowOrder, int);
  vtkGetMacro(RowOrder, int);
  ///@}

  ///@{
  /// How rows find their slices: by Order (as many rows as slices), FrameNumber (a column) or Time
  /// (poses are interpolated). Default: Order.
  vtkSetMacro(MatchBy, int);
  vtkGetMacro(MatchBy, int);
  ///@}

  ///@{
  /// Names of the pose's columns in order (m00 m01 ... or x y z qx qy qz qw or x y z azimuth
  /// elevation roll), or one text with which they begin, or none: the usual names are looked for
  /// (see lacunaPoseColumns.h). Default: none.
  void SetNumberOfPoseColumns(int count);
  int GetNumberOfPoseColumns() const { return static_cast<int>(this->PoseColumns.size()); }
  void SetPoseColumn(int i, const char* name);
  const char* GetPoseColumn(int i) const;
  ///@}

  ///@{
  /// Columns of frame numbers, times in s, states and gate. Empty: the usual names (FrameNumber,
  /// Frame; Timestamp, Time; SliceStatus, Status, Valid; Gate), if there are such. A state is
  /// SliceStatus flags (0 = valid) or the text OK; in a column whose name has "valid", 1 or true.
  /// Default: empty.
  vtkSetStdStringFromCharMacro(FrameColumn);
  vtkGetCharFromStdStringMacro(FrameColumn);
  vtkSetStdStringFromCharMacro(TimestampColumn);
  vtkGetCharFromStdStringMacro(TimestampColumn);
  vtkSetStdStringFromCharMacro(StatusColumn);
  vtkGetCharFromStdStringMacro(StatusColumn);
  vtkSetStdStringFromCharMacro(GateColumn);
  vtkGetCharFromStdStringMacro(GateColumn);
  ///@}

  ///@{
  /// Slices whose Gate is outside get SliceStatus 8; first > last: none do. Default: 1 -1.
  vtkSetVector2Macro(GateRange, double);
  vtkGetVector2Macro(GateRange, double);
  ///@}

  ///@{
  /// What MatchBy needs. FrameNumber: FirstFrameNumber is that of the first slice. Time: FrameRate
  /// is the slices per second from time 0, or 0 where times are in the input's field data array
  /// Timestamp or are its time steps; TimeOffset is added to the slices' times to have the poses'
  /// times, s; between poses further apart than MaximumTimeGap, s, nothing is interpolated, 0 = no
  /// limit. Default: 0, 0, 0 and 0.1.
  vtkSetMacro(FirstFrameNumber, int);
  vtkGetMacro(FirstFrameNumber, int);
  vtkSetMacro(FrameRate, double);
  vtkGetMacro(FrameRate, double);
  vtkSetMacro(TimeOffset, double);
  vtkGetMacro(TimeOffset, double);
  vtkSetMacro(MaximumTimeGap, double);
  vtkGetMacro(MaximumTimeGap, double);
  ///@}

  ///@{
  /// Whether a pose that is none (mirroring, not rigid, ...) only flags its slices. Default: off.
  vtkSetMacro(SkipInvalidPoses, bool);
  vtkGetMacro(SkipInvalidPoses, bool);
  vtkBooleanMacro(SkipInvalidPoses, bool);
  ///@}

protected:
  vtkLacunaAssembleTrackedSlices();
  ~vtkLacunaAssembleTrackedSlices() override = default;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  void Announce(const lacuna::Ports& ports) override;
  void Ask(const lacuna::Ports& ports) override;
  void Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution) override;
  void Describe(lacuna::Properties& properties) const override;
  std::vector<vtkDataObject*> GetOrigins(const lacuna::Ports& ports) const override;

private:
  vtkLacunaAssembleTrackedSlices(const vtkLacunaAssembleTrackedSlices&) = delete;
  void operator=(const vtkLacunaAssembleTrackedSlices&) = delete;

  /// Extent, coordinates and pixels of the output.
  void CollectPixels(vtkImageData* stack, vtkInformation* info, vtkImageData* output,
    lacuna::AlgorithmExecution& execution);
  /// Brings the input to one of its time steps.
  vtkImageData* UpdatePicture(int step);
  /// Poses and all else of the output.
  void Assemble(vtkImageData* stack, vtkTable* table, vtkInformation* info, vtkImageData* output);
  /// s; empty when they are not known.
  std::vector<double> GetSliceTimes(vtkImageData* stack, std::size_t slices) const;

  int PoseFormat = Matrix;
  int PoseTransform = ProbeToReference;
  int LengthUnit = Millimetre;
  double PixelSpacing[2] = { 0, 0 };
  double ImageToProbe[16] = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 };
  int RowOrder = Automatic;
  int MatchBy = Order;
  std::vector<std::string> PoseColumns;
  std::string FrameColumn;
  std::string TimestampColumn;
  std::string StatusColumn;
  std::string GateColumn;
  double GateRange[2] = { 1, -1 };
  int FirstFrameNumber = 0;
  double FrameRate = 0;
  double TimeOffset = 0;
  double MaximumTimeGap = 0.1;
  bool SkipInvalidPoses = false;

  /// Time steps that become slices; empty for an ordinary stack.
  std::vector<double> TimeSteps;
  vtkSmartPointer<vtkImageData> Source; ///< all slices that were used, for the provenance
};
#endif
