// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkLacunaTrackedSliceWriter
 * @brief writes tracked slices as a sequence file
 *
 * Writes a stack of tracked slices (contract lacuna::TrackedSlices) as a sequence that PLUS, 3D
 * Slicer and vtkLacunaTrackedSliceReader read; the extension of FileName chooses the kind: .mha,
 * .mhd (with .raw or .zraw), .nrrd, .nhdr (with .raw or .raw.gz). What was read comes back:
 *
 * - the slices that the stack holds, in its scalar type, in the orientation MFA (FM for
 *   radio-frequency data), to which all transforms refer. They are numbered from 0;
 * - every transform of 16 components with its status, ImageToProbe as a transform of each frame, so
 *   that the file can be read without a calibration file. ImageToReference itself is written when
 *   the other transforms do not lead to the same poses (corrected poses, phantoms, resampled slices);
 * - Timestamp, FrameNumber, ImageStatus; the flags too fast and gated out as SliceStatus;
 * - string and number arrays with a tuple for each slice or a single one, as text;
 * - the Provenance, as fields LacunaProvenance0 ... of the header.
 *
 * Slices that are too many for the memory (vtkLacunaSliceStream.h) are all written, a few at a time.
 * Of a preview that a filter has changed the slices that there are are written, with a warning.
 *
 * In-plane crops and new pixel spacings go into the transforms from and to the image; a crop to
 * whole pixels is told by FirstColumn and FirstRow in the header. Arrays that may identify
 * the patient (lacuna::IdentifiesPatient) are left out unless KeepPatientIdentity is on. What cannot
 * be written is named in a warning.
 *
 * In parallel each process has a writer of its own, with its number as Piece. All of them bring the
 * whole stack up to date; piece 0 writes it, the others write nothing.
 *
 * Files get their names when they are complete. On failure Write() returns 0, GetErrorCode() says
 * why, and what was at FileName stays.
 *
 * @sa vtkLacunaTrackedSliceReader
 */
#ifndef vtkLacunaTrackedSliceWriter_h
#define vtkLacunaTrackedSliceWriter_h

#include "vtkLacunaReadersTrackedSlicesModule.h" // for export macro
#include "vtkLacunaWriter.h"

#include <string> // for std::string

class vtkImageData;
namespace lacuna
{
class SequenceKind;
}

class VTKLACUNAREADERSTRACKEDSLICES_EXPORT vtkLacunaTrackedSliceWriter : public vtkLacunaWriter
{
public:
  static vtkLacunaTrackedSliceWriter* New();
  vtkTypeMacro(vtkLacunaTrackedSliceWriter, vtkLacunaWriter);

  ///@{
  /// The file to write: .mha, .mhd, .nrrd or .nhdr.
  vtkSetFilePathMacro(FileName);
  vtkGetFilePathMacro(FileName);
  ///@}

  ///@{
  /// 0: raw pixels, of which single slices can be read; 1 (quick) to 9 (small): one zlib or gzip
  /// stream. Default: 1.
  vtkSetMacro(CompressionLevel, int);
  vtkGetMacro(CompressionLevel, int);
  ///@}

  ///@{
  /// Whether arrays that may identify the patient are written. Default: off.
  vtkSetMacro(KeepPatientIdentity, bool);
  vtkGetMacro(KeepPatientIdentity, bool);
  vtkBooleanMacro(KeepPatientIdentity, bool);
  ///@}

  ///@{
  /// Number of this process, and of processes; only piece 0 writes. ParaView sets them. Default: 0
  /// and 1.
  vtkSetClampMacro(Piece, int, 0, VTK_INT_MAX);
  vtkGetMacro(Piece, int);
  vtkSetClampMacro(NumberOfPieces, int, 1, VTK_INT_MAX);
  vtkGetMacro(NumberOfPieces, int);
  ///@}

  ///@{
  /// Bytes of the file or files that the last Write() made; 0 when it failed, and
  /// in pieces that do not write.
  vtkGetMacro(FileSize, vtkTypeInt64);
  ///@}

protected:
  vtkLacunaTrackedSliceWriter() = default;
  ~vtkLacunaTrackedSliceWriter() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  std::string Ask(vtkInformation* input) override;
  void WriteFile() override;
  void Describe(lacuna::Properties& properties) const override;

private:
  vtkLacunaTrackedSliceWriter(const vtkLacunaTrackedSliceWriter&) = delete;
  void operator=(const vtkLacunaTrackedSliceWriter&) = delete;

  void WriteStack(vtkImageData* stack);
  std::string DescribeNeighbour(const lacuna::SequenceKind& kind) const;

  int CompressionLevel = 1;
  bool KeepPatientIdentity = false;
};
#endif
