// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkLacunaVolumeReader
 * @brief reads a volume from a MetaImage, NRRD or NIfTI file into patient coordinates
 *
 * FileName is a file as 3D Slicer, ITK and dcm2niix write it: .mha, .mhd, .nrrd, .nhdr, .nii or
 * .nii.gz, raw or compressed, with its data in the same file or another. The output is a
 * vtkImageData with the point scalars `Intensity`, of the file's type and components. Origin,
 * spacing and direction matrix place it in patient coordinates (DICOM's LPS), mm.
 *
 * - MetaImage: TransformMatrix (or Rotation, Orientation), Offset (or Position, Origin),
 *   ElementSpacing, DistanceUnits; AnatomicalOrientation is compared.
 * - NRRD: space (LPS, RAS, LAS), space directions, space origin, space units; or spacings and units.
 * - NIfTI-1 and -2: sform and qform (RAS), xyzt_units, scl_slope and scl_inter. NIfTITransform
 *   chooses where the two matrices differ.
 *
 * The output's axes are right-handed: where the file's are not, slices come in reverse order, and
 * every voxel stays where it is. Axes that are not at right angles (a corner off by more than
 * 0.05 mm), several volumes in a file, missing distances and contradictions are errors. Values are
 * scl_slope * stored + scl_inter (vtk type: lacuna::GetVolumeType).
 *
 * Field data: `DirectionMatrix` (lacuna::VolumeDirection), `Coordinates` = Patient where the file
 * says so (lacuna::Coordinates: NRRD with one of the spaces above, NIfTI with the code 1 or 2),
 * `Provenance`, with a hash of the file's name, which may be the patient's.
 *
 * Requested extents are honoured. What hinders a volume is an error that comes with the data; until
 * then the extent is empty. Errors set vtkErrorCode::FileNotFoundError or FileFormatError.
 */
#ifndef vtkLacunaVolumeReader_h
#define vtkLacunaVolumeReader_h

#include "vtkImageAlgorithm.h"
#include "vtkLacunaAlgorithm.h"
#include "vtkLacunaReadersVolumesModule.h" // for export macro

#include <memory> // for std::unique_ptr

class VTKLACUNAREADERSVOLUMES_EXPORT vtkLacunaVolumeReader
  : public vtkLacunaAlgorithmOf(vtkImageAlgorithm)
{
public:
  static vtkLacunaVolumeReader* New();
  vtkTypeMacro(vtkLacunaVolumeReader, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /// Which matrix of a NIfTI file says where the volume lies.
  enum NIfTITransformType
  {
    Automatic = 0, ///< that which the file has; an error where it has two that differ
    SForm = 1,
    QForm = 2
  };

  ///@{
  /// The file.
  vtkSetFilePathMacro(FileName);
  vtkGetFilePathMacro(FileName);
  ///@}

  ///@{
  /// Default: Automatic. Other formats have one matrix.
  vtkSetMacro(NIfTITransform, int);
  vtkGetMacro(NIfTITransform, int);
  ///@}

  /// Whether a file is a MetaImage or NRRD file with three axes or more that is no tracked sequence,
  /// or a NIfTI file. Also of those that the reader then refuses: another reader would drop how they
  /// lie.
  int CanReadFile(VTK_FILEPATH const char* fileName);

protected:
  vtkLacunaVolumeReader();
  ~vtkLacunaVolumeReader() override;

  void Announce(const lacuna::Ports& ports) override;
  void Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution) override;
  void Describe(lacuna::Properties& properties) const override;
  std::string Parameters(int port) const override;

private:
  vtkLacunaVolumeReader(const vtkLacunaVolumeReader&) = delete;
  void operator=(const vtkLacunaVolumeReader&) = delete;

  struct Content;
  void OpenVolume(Content& content);
  void AnnounceGrid(vtkInformation* info) const;
  void AddFieldData(vtkImageData* output);

  char* FileName = nullptr;
  int NIfTITransform = Automatic;
  std::unique_ptr<Content> Opened;
};
#endif
