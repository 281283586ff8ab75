// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// From the text fields of a sequence to poses, times and flags: one value for every frame.
#ifndef lacunaSweep_h
#define lacunaSweep_h

#include "lacunaMatrix4.h"
#include "lacunaSequenceHeader.h"
#include "lacunaSliceFlags.h"

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace lacuna
{
struct SweepOptions
{
  /// Device set configuration with constant transforms; empty for none. A transform in it replaces
  /// those of the sequence between the same two frames.
  std::string CalibrationFileName;
  /// Frame of the pixels. When it is Image and the sequence has a transform between Image and
  /// CroppedImage, as PLUS leaves it in cropped frames, the pixels are taken to be in CroppedImage.
  std::string ImageFrame = "Image";
  std::string ReferenceFrame = "Reference";
  /// Whether to flag frames of which the tracker or the video source said that they are not valid.
  /// Otherwise they are used as long as they have numbers.
  bool DropInvalid = true;
  /// Frames whose pixels exist; those from here on are always flagged. -1: all.
  std::int64_t FramesWithPixels = -1;
};

struct Sweep : SliceFlags
{
  /// Maps (column, row, 0, 1) to mm in the reference frame. All NaN for a flagged pose: there is no
  /// pose that could be used by mistake. Empty when no transform has to do with the image frame,
  /// that is, when the probe is not calibrated.
  std::vector<Matrix4> ImageToReference;
  std::vector<unsigned char> Status;
  std::vector<double> Timestamps; ///< s; empty when no frame has one, NaN where one lacks it
  std::vector<int> FrameNumbers;  ///< the frame's index where the file has no number

  /// Every transform of the file by its name ("ProbeToTracker"), as it is there, NaN where it is
  /// missing or unreadable. Not those that would take the place of ImageToReference or
  /// ImageToProbe: they stay in TextFields.
  std::map<std::string, std::vector<Matrix4>> Transforms;
  /// Those among Transforms, and ImageToProbe, that the header gives for all frames.
  std::set<std::string> HeaderTransforms;
  /// From the image to the frame "Probe", when it is known and constant; else empty.
  std::vector<Matrix4> ImageToProbe;
  /// The other fields of the frames as text: states of transforms and images, custom fields.
  std::map<std::string, std::vector<std::string>> TextFields;

  std::string ImageFrame; ///< of the pixels: that of the options, or CroppedImage
  std::string Chain;      ///< "Image > Probe > Tracker > Reference"; empty when not calibrated
  std::vector<std::string> Warnings;
};

/// Finds the chain of transforms from the image to the reference frame, the same one for the whole
/// sweep: the shortest through the calibration's and the sequence's transforms, taken forwards or
/// backwards. A frame's pose is valid when each of the sequence's transforms in the chain is there
/// for the frame, is 16 finite numbers, passes lacunaGeometryGate.h and has the status OK (any other word,
/// known or not, is not valid; a transform that has no status in the whole file is taken as valid,
/// with a warning). Its image is valid when ImageStatus is OK or absent. With DropInvalid a field
/// SliceStatus adds its flags but ImageInvalid, which is found anew; one that is no whole number
/// from 0 to 255 makes the image invalid, with a warning.
///
/// Evidence of the pixels' size is compared with the chain: ElementSpacing of a frame, else
/// PixelSpacingMm (both mm of a column and a row), else the header's spacing; 1 1 says nothing. A
/// frame whose chain gives another size (by more than 2 %) has an invalid pose, with a warning that
/// names the frames; without DropInvalid only the warning. Fields of the scanner's settings (depth,
/// zoom, sector) that change within the sweep are warned of.
///
/// Without a chain the sweep is not calibrated when no calibration file is given. Otherwise throws
/// std::runtime_error that names the missing link and the transforms there are; also when no
/// transform mentions the reference frame though one leads to Probe, or when the calibration file
/// cannot be used, also by lacunaGeometryGate.h.
Sweep BuildSweep(const SequenceHeader& header, const SweepOptions& options);

/// The Timestamp of each frame in s; empty when no frame has one, NaN where one lacks it or has
/// something else than a finite number.
std::vector<double> ReadTimestamps(const SequenceHeader& header);
}
#endif
