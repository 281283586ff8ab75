// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The pictures of an ultrasound scanner without hardware.
#ifndef lacunaUltrasoundEmulator_h
#define lacunaUltrasoundEmulator_h

#include "lacunaPhantomScene.h"
#include "lacunaScannerScreen.h"
#include "lacunaTissueSpeckle.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace lacuna
{
struct UltrasoundSettings
{
  ScannerLayout Layout;
  /// Standard deviation of the speckle, relative to the level that it changes: 0 ... 1. 0: what the
  /// probe sees is exactly the scene.
  double SpeckleLevel = 0.25;
  std::uint64_t Seed = 1;
};

/// Renders B-scans of a scene into the frames of a scanner's video. A frame depends on its pose,
/// time and number alone.
class UltrasoundEmulator
{
public:
  /// Throws std::invalid_argument for settings that cannot be.
  UltrasoundEmulator(std::unique_ptr<PhantomScene> scene, const UltrasoundSettings& settings);

  const ScannerScreen& GetScreen() const { return this->Screen; }
  const PhantomScene& GetScene() const { return *this->Scene; }
  /// imageToScene: (column, row, 0, 1) to mm of the scene. time (s) and number are only written
  /// below. pixels: Columns x Rows levels, the top line first.
  void Render(
    const Matrix4& imageToScene, double time, std::int64_t number, std::uint8_t* pixels) const;

private:
  std::unique_ptr<PhantomScene> Scene;
  ScannerScreen Screen;
  TissueSpeckle Speckle;
  double SpeckleLevel;
};
}
#endif
