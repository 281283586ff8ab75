// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Where the image lies on the probe and the tracker in the reference frame, from a calibration file.
#ifndef lacunaProbeFrames_h
#define lacunaProbeFrames_h

#include "lacunaMatrix4.h"

#include <string>

namespace lacuna
{
struct ProbeFrames
{
  Matrix4 ImageToProbe;       ///< (column, row, 0, 1) to mm
  Matrix4 TrackerToReference; ///< mm; the identity when the file says nothing about it
  std::string Warning;        ///< for the user: what may be wrong with them, or empty
};

/// Reads the transforms of a file (see ReadCalibrationFile), along chains where there are some.
/// pixelSpacing: mm, for a calibration whose image is in mm; 0: it has the size of a pixel. Throws
/// std::runtime_error that names the file when it does not lead from Image to Probe, when
/// lacunaGeometryGate.h refuses a matrix, or when the size of a pixel is given twice and differently, or not at all: it is
/// never assumed.
ProbeFrames ReadProbeFrames(const std::string& fileName, double pixelSpacing);
}
#endif
