// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkLacunaTrackedSliceReader
 * @brief reads ultrasound slices with their poses from a tracked sequence file
 *
 * Reads MetaImage and NRRD sequences (.igs.mha, .mha, .mhd with .raw or .zraw, .nrrd, .nhdr with
 * its data file) as PLUS, 3D Slicer and their kin write them: a stack of slices, raw, compressed
 * (zlib, gzip) or as text, of any element type, with named fields for each frame. The content tells
 * the format, not the name. The output is tracked slices, see lacuna::TrackedSlices for the
 * contract:
 *
 * - vtkImageData of columns x rows x slices; point scalars `Intensity` (grey levels in the file's
 *   type; colours become luminance 0.299 R + 0.587 G + 0.114 B). Slices are turned to the
 *   orientation MF (x towards the marked side, y away from the probe; radio-frequency data to FM),
 *   to which the file's transforms refer.
 * - field data, one tuple for each frame of the file: `ImageToReference` (16 components, pixel
 *   (column, row, 0, 1) to mm; NaN where the pose is invalid), `Timestamp` (s), `SliceStatus`,
 *   `FrameNumber`, each transform of the file under its name (`ProbeToTracker`, 16), the file's
 *   other fields as strings under their names; one tuple: `ImageToProbe` when known and constant,
 *   `UltrasoundImageType` and `UltrasoundImageOrientation` (of the slices as they are now); two
 *   strings `ImageToReferenceFrames`: what Image and Reference are called. Fields that
 *   may identify the patient (lacuna::IdentifiesPatient) are left out unless KeepPatientIdentity is on.
 *
 * **Chains.** ImageToReference is composed from the file's transforms of each frame and the
 * constant ones of the calibration file (CoordinateDefinitions), forwards or backwards, along the
 * shortest way from ImageFrame to ReferenceFrame. When there is no way and no calibration file is
 * given, the probe is not calibrated: the slices are read, with a warning, without ImageToReference.
 * Any other gap is an error that names the two unconnected groups of frames.
 *
 * **Contradictions.** Slices whose pixels have another size by the file (ElementSpacing and the like)
 * than by the chain are flagged (1), with a warning; see lacuna::BuildSweep.
 *
 * **Parts of pictures.** Frames that PLUS has cropped have a transform ImageToCroppedImage: their pixels
 * are those of CroppedImage, from which the chain then leads. Slices that are a part of the scanner's picture (header fields FirstColumn and
 * FirstRow) have the origin there, so that their coordinates, ImageToReference and ImageToProbe are
 * those of the whole picture, for which a calibration file holds.
 *
 * **Invalid slices** stay in the stack, since z is the slice number and slices are equally spaced.
 * With DropInvalidSlices (the default) a slice whose pose or image is not `OK` in the file has bit
 * 1 (pose) or 2 (image) set in SliceStatus, and all Lacuna filters leave it out. Without it the
 * file's word is not heeded and a slice is flagged only when its pose has no usable numbers
 * (missing, malformed, not finite, singular) or its pixels are missing because the file is cut off.
 * Frames whose fields are damaged are named in a warning.
 *
 * **Poses without pictures** (DimSize 0 0 0, or 1 x 1 dummy pixels without ImageStatus) give a
 * stack of 1 x 1 blank pixels, with a warning; all slices have bit 2 set, poses and fields are
 * complete.
 *
 * **Replay.** With ReplayInTime the reader has time steps. At time t the slices up to the last one
 * taken by then are there; the later ones are blank and have bit 2 (no valid image) set, so that
 * filters leave them out. The stack has the same extent at any time, since VTK's pipeline cannot
 * follow one that grows; z stays the slice number, poses and fields are those of the whole sweep.
 * See lacuna::SweepReplay for clocks that jump or fail. Without a requested time all slices are
 * there. What was read for one time is kept for the next.
 *
 * **Previews.** When the slices take more than MemoryLimit, the output is every n-th of them, with the
 * smallest n that fits, the z spacing that belongs to it, the field data of all, and a field data
 * string `Preview` that says so. Beside it, all slices are offered to be read in parts
 * (vtkLacunaSliceStream; not in a replay): so consumers that need each slice once work on any file in
 * bounded memory.
 *
 * Requested extents are honoured: of uncompressed files only the slices asked for are read, of
 * compressed ones all up to the last slice asked for. Errors set vtkErrorCode::FileFormatError or
 * FileNotFoundError.
 *
 * @sa lacuna::TrackedSlices
 */
#ifndef vtkLacunaTrackedSliceReader_h
#define vtkLacunaTrackedSliceReader_h

#include "vtkImageAlgorithm.h"
#include "vtkLacunaAlgorithm.h"
#include "vtkLacunaReadersTrackedSlicesModule.h" // for export macro

#include <memory> // for std::unique_ptr
#include <string> // for std::string

namespace lacuna
{
class AlgorithmExecution;
struct Sweep;
}

class VTKLACUNAREADERSTRACKEDSLICES_EXPORT vtkLacunaTrackedSliceReader
  : public vtkLacunaAlgorithmOf(vtkImageAlgorithm)
{
public:
  static vtkLacunaTrackedSliceReader* New();
  vtkTypeMacro(vtkLacunaTrackedSliceReader, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /// The sequence file.
  vtkSetFilePathMacro(FileName);
  vtkGetFilePathMacro(FileName);
  ///@}

  ///@{
  /// Device set configuration (XML) whose CoordinateDefinitions hold the constant transforms, such
  /// as Image to Probe. Default: none.
  vtkSetFilePathMacro(CalibrationFileName);
  vtkGetFilePathMacro(CalibrationFileName);
  ///@}

  ///@{
  /// Name of the frame of pixel coordinates. Default: Image; of frames that PLUS has cropped
  /// CroppedImage is meant by it.
  vtkSetStringMacro(ImageFrame);
  vtkGetStringMacro(ImageFrame);
  ///@}

  ///@{
  /// Name of the frame in which the slices shall lie. Default: Reference.
  vtkSetStringMacro(ReferenceFrame);
  vtkGetStringMacro(ReferenceFrame);
  ///@}

  ///@{
  /// First and last slice to read, counted from 0; a last one of -1 means the end. Default: 0 -1.
  vtkSetVector2Macro(FrameRange, int);
  vtkGetVector2Macro(FrameRange, int);
  ///@}

  ///@{
  /// Read every n-th slice of FrameRange, n >= 1. Default: 1. The z spacing of the stack becomes n.
  vtkSetMacro(FrameStride, int);
  vtkGetMacro(FrameStride, int);
  ///@}

  ///@{
  /// Whether slices that the file calls invalid are flagged for being left out. Default: on.
  vtkSetMacro(DropInvalidSlices, bool);
  vtkGetMacro(DropInvalidSlices, bool);
  vtkBooleanMacro(DropInvalidSlices, bool);
  ///@}

  ///@{
  /// Whether fields that may identify the patient go into the field data. Default: off.
  vtkSetMacro(KeepPatientIdentity, bool);
  vtkGetMacro(KeepPatientIdentity, bool);
  vtkBooleanMacro(KeepPatientIdentity, bool);
  ///@}

  ///@{
  /// Whether slices appear in the course of time as they were taken. Default: off.
  vtkSetMacro(ReplayInTime, bool);
  vtkGetMacro(ReplayInTime, bool);
  vtkBooleanMacro(ReplayInTime, bool);
  ///@}

  ///@{
  /// Most memory that the pixels may take, in MiB; of more slices, the output is a preview. Default:
  /// 0, a quarter of the machine's memory, or of what its container or ulimit -v allows; 4096 with several
  /// ranks, which show the same slices.
  vtkSetMacro(MemoryLimit, int);
  vtkGetMacro(MemoryLimit, int);
  ///@}

  /// When the output is a preview: of which slices, why, and how to get all of them. Else empty.
  /// Known after UpdateInformation().
  const char* GetPreview() const { return this->Preview.c_str(); }

  /// Whether a file is a tracked sequence that this class reads: its header has Seq_Frame fields
  /// and its frames are slices. Reads no more than the beginning of the header.
  int CanReadFile(VTK_FILEPATH const char* fileName);

protected:
  vtkLacunaTrackedSliceReader();
  ~vtkLacunaTrackedSliceReader() override;

  void Announce(const lacuna::Ports& ports) override;
  void Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution) override;
  void Describe(lacuna::Properties& properties) const override;
  std::string Parameters(int port) const override;

private:
  vtkLacunaTrackedSliceReader(const vtkLacunaTrackedSliceReader&) = delete;
  void operator=(const vtkLacunaTrackedSliceReader&) = delete;

  struct Sequence;
  void OpenSequence(Sequence& sequence);
  double GetMostBytes() const;
  void ReadPixels(vtkImageData* output, int shown, lacuna::AlgorithmExecution& execution);
  void HideSlices(vtkImageData* output, int shown) const;
  void MakeFieldData();
  std::vector<std::string> AddTexts(const lacuna::Sweep& sweep, vtkImageData* output) const;
  void AddContract(const lacuna::Sweep& sweep, vtkImageData* output) const;
  void WarnOf(const lacuna::Sweep& sweep);

  char* FileName = nullptr;
  char* CalibrationFileName = nullptr;
  char* ImageFrame = nullptr;
  char* ReferenceFrame = nullptr;
  int FrameRange[2] = { 0, -1 };
  int FrameStride = 1;
  bool DropInvalidSlices = true;
  bool KeepPatientIdentity = false;
  bool ReplayInTime = false;
  int MemoryLimit = 0;
  std::string Preview;
  /// The file as Announce found it; kept open from one requested extent to the next.
  std::unique_ptr<Sequence> Opened;
};
#endif
