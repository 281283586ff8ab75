// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkLacunaCTSeriesReader
 * @brief reads a CT series from DICOM files into a volume in patient coordinates
 *
 * FileName is any file of the series, whose folder is searched, or a folder, which is searched with
 * all folders in it. The output is a vtkImageData with the point scalars `HounsfieldUnits` (short,
 * int where bits stored and rescale need it, float where the rescale has fractions). Origin, spacing
 * and direction matrix place it in DICOM's patient coordinates (LPS: x to the patient's left, y to
 * posterior, z to superior), mm. Its axes are the rows' direction, the columns' direction and their
 * cross product, so the determinant is +1 and nothing is mirrored, whatever the order, number or
 * name of the files: images are sorted by Image Position (Patient) along the normal.
 *
 * - Localizers, secondary captures, colour images and other modalities are left out (GetNotes).
 * - **Missing slices** and unequal spacing are an error that names positions in mm along the normal
 *   (for axial images z), or interpolated linearly. A position that is there twice is an error
 *   unless both images are equal.
 * - **Gantry tilt**, a shear of the slices, is found from their positions and corrected by moving
 *   pixels within their images (cubic convolution), or refused. The grid grows so that nothing is
 *   lost; what lies outside of the images is PaddingValue.
 * - Values are slope * stored + intercept of each image; pixels with the file's padding value
 *   become PaddingValue. MONOCHROME1 does not change values.
 * - Enhanced (multi-frame) CT, deflated files, files without preamble and compressed pixels (RLE;
 *   JPEG, JPEG-LS, JPEG 2000 when built with GDCM) are read.
 *
 * Field data: `DirectionMatrix` (lacuna::VolumeDirection), `PatientPosition` (HFS, ...), `ConvolutionKernel`, `GantryTilt` (degrees, where one
 * was corrected), `InterpolatedSlices` (indices along the third axis, where there are any),
 * `Provenance`. The patient's identity is copied only with KeepPatientIdentity; provenance has a
 * hash of the series' UID instead (64-bit FNV-1a of its text).
 *
 * Requested extents are honoured: only the images of the slices asked for are read. What hinders a
 * volume is an error that comes with the data, with the files that were left out; until then the extent is
 * empty. Errors set vtkErrorCode::FileNotFoundError or FileFormatError. Source: DICOM PS3.3 C.7.6.2, C.7.6.16, C.8.2;
 * Carr 1996, 6.7.1 (slices missing or displaced).
 */
#ifndef vtkLacunaCTSeriesReader_h
#define vtkLacunaCTSeriesReader_h

#include "vtkImageAlgorithm.h"
#include "vtkLacunaAlgorithm.h"
#include "vtkLacunaReadersCTSeriesModule.h" // for export macro

#include <memory> // for std::unique_ptr
#include <string> // for std::string

class vtkStringArray;

namespace lacuna
{
struct CTSeriesList;
}

class VTKLACUNAREADERSCTSERIES_EXPORT vtkLacunaCTSeriesReader
  : public vtkLacunaAlgorithmOf(vtkImageAlgorithm)
{
public:
  static vtkLacunaCTSeriesReader* New();
  vtkTypeMacro(vtkLacunaCTSeriesReader, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /// What is done about slices that are missing or not equally spaced.
  enum MissingSlicesType
  {
    Error = 0,
    Interpolate = 1
  };
  /// What is done about a tilted gantry.
  enum GantryTiltType
  {
    Correct = 0,
    Refuse = 1
  };

  ///@{
  /// A file of the series, a folder or a DICOMDIR.
  vtkSetFilePathMacro(FileName);
  vtkGetFilePathMacro(FileName);
  ///@}

  ///@{
  /// Series Instance UID; what follows a blank is not looked at, so that a line of GetSeriesList
  /// serves. Empty (the default): the series of the file, or the only one of the folder.
  vtkSetStringMacro(SeriesUID);
  vtkGetStringMacro(SeriesUID);
  ///@}

  ///@{
  /// Default: Error.
  vtkSetMacro(MissingSlices, int);
  vtkGetMacro(MissingSlices, int);
  ///@}

  ///@{
  /// Default: Correct.
  vtkSetMacro(GantryTilt, int);
  vtkGetMacro(GantryTilt, int);
  ///@}

  ///@{
  /// Acquisition Number of the images to take where a series has several over one another; -1 (the
  /// default): all.
  vtkSetMacro(Acquisition, int);
  vtkGetMacro(Acquisition, int);
  ///@}

  ///@{
  /// How far slices may lie from equal spacing and from a straight row, in mm, 1e-6 to 10; also the
  /// distance within which two images are at one position. For spacing and for one position at most
  /// a quarter of the usual distance of slices counts. Default: 0.05.
  vtkSetMacro(PositionTolerance, double);
  vtkGetMacro(PositionTolerance, double);
  ///@}

  ///@{
  /// Hounsfield units of pixels that the file calls padding, and of what lies outside of tilted
  /// images; a number that a float can hold. Default: -1024.
  vtkSetMacro(PaddingValue, double);
  vtkGetMacro(PaddingValue, double);
  ///@}

  ///@{
  /// Whether name, ID, birth date and sex of the patient, study date and the UIDs of study and
  /// series go into the field data. Never into Provenance. Default: off.
  vtkSetMacro(KeepPatientIdentity, bool);
  vtkGetMacro(KeepPatientIdentity, bool);
  vtkBooleanMacro(KeepPatientIdentity, bool);
  ///@}

  /// The CT series found, one a line that begins with the UID. Filled by UpdateInformation, also
  /// when no volume can be made; the error then comes with the request for data.
  vtkStringArray* GetSeriesList();
  /// What was left out, corrected or interpolated.
  vtkStringArray* GetNotes();

  /// Whether a file is a CT image in DICOM (or a DICOMDIR, or a folder with one among its first
  /// files). Looks into headers.
  int CanReadFile(VTK_FILEPATH const char* fileName);

protected:
  vtkLacunaCTSeriesReader();
  ~vtkLacunaCTSeriesReader() override;

  void Announce(const lacuna::Ports& ports) override;
  void Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution) override;
  void Describe(lacuna::Properties& properties) const override;
  std::string Parameters(int port) const override;

private:
  vtkLacunaCTSeriesReader(const vtkLacunaCTSeriesReader&) = delete;
  void operator=(const vtkLacunaCTSeriesReader&) = delete;

  struct Content;
  void OpenSeries();
  void AnnounceGrid(vtkInformation* info) const;
  void FindVolume(const lacuna::CTSeriesList& list);
  void AddFieldData(vtkImageData* output) const;

  char* FileName = nullptr;
  char* SeriesUID = nullptr;
  int MissingSlices = Error;
  int GantryTilt = Correct;
  int Acquisition = -1;
  double PositionTolerance = 0.05;
  double PaddingValue = -1024;
  bool KeepPatientIdentity = false;
  std::unique_ptr<Content> Found;
};
#endif
