// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The data contract of tracked slices (B-scans with poses), in one place for writers and readers.
///
/// One vtkImageData of W x H x N points; its physical coordinates (origin + spacing * index) are
/// (column, row, slice), so that a cropped or strided stack still says which slice is which.
/// Active point scalars: grey levels, one component. Field data, always one tuple for each slice of
/// the original sweep, however cropped the stack is:
///
/// - ImageToReference (double, 16 components): (column, row, 0, 1) to mm in the reference frame;
///   absent until the probe is calibrated. All NaN where there is no usable pose: test SliceStatus
///   first.
/// - SliceStatus (unsigned char): flags, see lacunaSliceFlags.h; 0 = valid
/// - Timestamp (double): seconds; optional
/// - FrameNumber (int): number in the file or of the frame grabber
/// - ProbeToTracker, ... (double, 16 components): every transform of the file under its own name
///
/// and with one tuple: ImageToProbe, when known; Preview (string), when the stack holds only every
/// n-th slice because all would not fit into the memory (vtkLacunaSliceStream.h); Growing (int), while
/// the stack is being taken.
#ifndef lacunaTrackedSlices_h
#define lacunaTrackedSlices_h

#include "lacunaMatrix4.h"
#include "lacunaSliceFlags.h"
#include "vtkLacunaFiltersCommonModule.h" // for export macro
#include "vtkType.h"

#include <vector>

class vtkDataArray;
class vtkImageData;

namespace lacuna
{
/// Slices that keep the contract, which is that of the file lacunaTrackedSlices.h, and the contract's names.
class VTKLACUNAFILTERSCOMMON_EXPORT TrackedSlices : public SliceFlags
{
public:
  static constexpr const char* ImageToReferenceName = "ImageToReference";
  static constexpr const char* ImageToProbeName = "ImageToProbe";
  static constexpr const char* TimestampName = "Timestamp";
  static constexpr const char* SliceStatusName = "SliceStatus";
  static constexpr const char* FrameNumberName = "FrameNumber";
  static constexpr const char* PreviewName = "Preview";
  static constexpr const char* GrowingName = "Growing";

  ///@{
  /// Whether slices are to come, so that too few to make anything of are no error yet.
  static void MarkAsGrowing(vtkImageData* stack);
  static bool IsGrowing(vtkImageData* stack);
  ///@}

  /// Checks stack against the contract. Throws std::runtime_error that names the array and what is
  /// wrong with it. Keeps no reference: stack must outlive this object.
  explicit TrackedSlices(vtkImageData* stack);

  /// Throws std::runtime_error when an image is a stack of slices, for filters of volumes: its pixels
  /// are no millimetres.
  static void Refuse(vtkImageData* image);

  /// Slices of the original sweep: the length of the field data arrays.
  vtkIdType GetNumberOfSlices() const { return static_cast<vtkIdType>(this->Poses.size()); }

  /// Number in the sweep, 0-based, of the slice at extent index k. Throws when it is outside of it.
  vtkIdType GetSliceNumber(int k) const;

  /// The same for a stack whose probe is not calibrated, of a sweep of so many slices.
  static vtkIdType GetSliceNumber(vtkImageData* stack, int k, vtkIdType slices);
  /// The same for a z coordinate.
  static vtkIdType GetSliceNumber(double z, vtkIdType slices);

  /// (column, row, 0, 1) to mm in the reference frame.
  const Matrix4& GetImageToReference(vtkIdType slice) const { return this->Poses[slice]; }
  unsigned char GetStatus(vtkIdType slice) const { return this->StatusFlags[slice]; }
  /// True for a valid slice, and for one that only has flags of acceptedFlags. A pose that is
  /// invalid is never usable.
  bool IsUsable(vtkIdType slice, unsigned char acceptedFlags = Valid) const
  {
    const int refused = PoseInvalid | (0xff & ~acceptedFlags);
    return (this->StatusFlags[slice] & refused) == 0;
  }
  /// Seconds; the slice number when the stack has no Timestamp.
  double GetTimestamp(vtkIdType slice) const { return this->Times[slice]; }
  /// Grey levels, one component, the points of the stack's extent.
  vtkDataArray* GetGreyLevels() const { return this->GreyLevels; }

  /// Writes the arrays of the contract. poses may be empty: then ImageToReference is left out (the
  /// probe is not calibrated). So may timestamps, when they are not known. The others have one
  /// element per slice.
  static void Write(vtkImageData* stack, const std::vector<Matrix4>& poses,
    const std::vector<double>& timestamps, const std::vector<unsigned char>& status,
    const std::vector<int>& frameNumbers);

private:
  vtkImageData* Stack;
  vtkDataArray* GreyLevels;
  std::vector<Matrix4> Poses;
  std::vector<unsigned char> StatusFlags;
  std::vector<double> Times;
};
}
#endif
