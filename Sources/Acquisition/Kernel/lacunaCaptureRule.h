// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Which frames of a moving probe become slices, and whether it moves too fast (Carr 1996, ch. 2).
#ifndef lacunaCaptureRule_h
#define lacunaCaptureRule_h

#include "lacunaMatrix4.h"

#include <array>
#include <optional>
#include <vector>

namespace lacuna
{
/// What is taken.
enum class CaptureMode
{
  Movement,  ///< a frame is taken when an extreme point has moved since the last one that was taken
  EveryFrame ///< every frame is
};

/// The corners of the field of view, mm in the receiver's coordinates: the outer corners of the
/// pixels of a window that begins at (column, row) and has a size.
std::vector<Vec3> GetViewCorners(const Matrix4& imageToProbe, const std::array<int, 4>& window);

/// What stands for them while the probe is not calibrated: the ends of axes of 100 mm through the
/// receiver's origin, both ways. They move as far as the receiver, and when it turns as an image
/// does that is so far from it.
std::vector<Vec3> GetReceiverPoints();

class CaptureRule
{
public:
  struct Verdict
  {
    bool Take = false;
    bool TooFast = false;
    std::optional<double>
      Speed; ///< mm/s of the fastest point since the frame before; may be unknown
  };

  /// threshold: mm; speedLimit: mm/s, 0: none. points are fixed to the receiver.
  CaptureRule(CaptureMode mode, double threshold, double speedLimit, std::vector<Vec3> points);

  /// Judges the next frame, by the receiver's pose at its instant. The speed is not known after a gap
  /// of half a second.
  Verdict Judge(const Matrix4& receiverToTransmitter, double instant);
  /// The frame that was judged last is taken.
  void Take() { this->LastTaken = this->Before; }
  /// The next frame is the first of a sweep.
  void BeginSweep() { this->LastTaken.reset(); }
  /// Goes on with the sweep of another rule.
  void Continue(const CaptureRule& other);

private:
  std::vector<Vec3> Place(const Matrix4& pose) const;

  CaptureMode Mode;
  double Threshold;
  double SpeedLimit;
  std::vector<Vec3> Points;
  std::optional<Matrix4> LastTaken; ///< poses of the receiver
  std::optional<Matrix4> Before;
  double BeforeInstant = 0;
};
}
#endif
