// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// How an emulated probe, its receiver and the scene lie to each other.
#ifndef lacunaEmulatedProbe_h
#define lacunaEmulatedProbe_h

#include "lacunaFastrakEmulator.h"
#include "lacunaMatrix4.h"

#include <string>

namespace lacuna
{
/// A probe with a receiver on it, some 75 mm above the transducer's face and turned against the
/// image about all three axes; moved as the receiver is.
///
/// The scene stays where it is: its origin lies in the middle of what the probe sees, and its x, y
/// and z along columns, rows and their cross product, at one instant of the motion.
class EmulatedProbe
{
public:
  /// imageToFace: see ScannerScreen. depth: mm that the probe sees. aim: that instant, s.
  EmulatedProbe(FastrakEmulator::PoseScript motion, int station, const Matrix4& imageToFace,
    double depth, double aim);

  /// (column, row, 0, 1) to mm of the receiver: what a calibration finds.
  const Matrix4& GetImageToReceiver() const { return this->ImageToReceiver; }
  /// (column, row, 0, 1) to mm of the scene at a time.
  Matrix4 ImageToScene(double time) const;
  /// A calibration file, as an acquisition, PLUS, 3D Slicer and Tracked Slice Reader take it: Image
  /// to Probe, and Tracker to Reference, which is the scene's frame.
  std::string FormatCalibration() const;

private:
  FastrakEmulator::PoseScript Motion;
  int Station;
  Matrix4 ImageToReceiver;
  Matrix4 TransmitterToScene;
};
}
#endif
