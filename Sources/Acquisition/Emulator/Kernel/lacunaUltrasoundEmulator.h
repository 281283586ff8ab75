// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The pictures of an ultrasound scanner without hardware.
#ifndef lacunaUltrasoundEmulator_h
#define lacunaUltrasoundEmulator_h

#include "lacunaFanDetection.h"
#include "lacunaMatrix4.h"
#include "lacunaPhantomScene.h"
#include "lacunaVector.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace lacuna
{
struct ScannerLayout
{
  enum class Probe
  {
    Curved, ///< sees a sector
    Linear  ///< sees a rectangle
  };

  int Columns = 768; ///< of the video frame, 16 ... 4096; at least 320 with Furniture
  int Rows = 576;    ///< the same; at least 240 with Furniture
  Probe Shape = Probe::Curved;
  double Depth = 60;     ///< mm that are seen, 5 ... 400
  double Radius = 40;    ///< mm, of a curved transducer's face, 0 ... 100
  double HalfAngle = 26; ///< degrees, of a curved one: half of what it sees, 5 ... 60
  double Width = 60;     ///< mm, of a linear transducer, 5 ... 400
  bool Furniture = true; ///< ruler, texts and grey scale around what the probe sees
  std::string Title;     ///< in capitals, above
};

/// The frame: where it shows what the probe sees, and what is around it. Pixels are square, and
/// 10 mm are a whole number of them. The face of the transducer is above, column 0 on the side of
/// the probe's mark.
///
/// The ruler to the right has a tick at each 5 mm below the face, longer ones at each 10 mm, whose
/// topmost line is the row of that depth in the middle of what the probe sees.
class ScannerScreen
{
public:
  /// Columns first ... last of a row.
  struct Run
  {
    int Row;
    int First;
    int Last;
  };

  /// Throws std::invalid_argument that says what would be right.
  explicit ScannerScreen(const ScannerLayout& layout);

  const ScannerLayout& GetLayout() const { return this->Layout; }
  double GetPixelSpacing() const { return this->Spacing; } ///< mm
  /// (column, row, 0, 1) to mm: the origin is the middle of the transducer's face, x along columns,
  /// y into the tissue, z = x cross y.
  Matrix4 GetImageToFace() const;
  /// What the probe sees, as Swept Volume and an acquisition are told it.
  const DetectedFan& GetRegion() const { return this->Region; }
  /// The same, row by row.
  const std::vector<Run>& GetRuns() const { return this->Runs; }
  /// The frame without what the probe sees, which is 0 there.
  const std::vector<std::uint8_t>& GetGround() const { return this->Ground; }
  /// Writes time (s, from 0) and number of a frame into it, where there is furniture.
  void DrawFrameNumber(double time, std::int64_t number, std::uint8_t* pixels) const;

private:
  void Place();
  void PlaceSector();
  void DrawFurniture();

  ScannerLayout Layout;
  double Spacing = 0;
  int FaceColumn = 0; ///< of the middle of the face
  int FaceRow = 0;
  DetectedFan Region;
  std::vector<Run> Runs;
  std::vector<std::uint8_t> Ground;
};

/// Speckle that belongs to the tissue: the same place has the same grain in every picture of it, so
/// a probe at rest has pictures at rest. It is the magnitude of complex Gaussian noise that is
/// correlated over a resolution cell of some 0.7 mm (fully developed speckle: Rayleigh distributed),
/// on a grid that repeats after 38.4 mm along each axis, and linear between its points.
class TissueSpeckle
{
public:
  explicit TissueSpeckle(std::uint64_t seed);

  /// Multiplies levels by 1 + strength g, never below 0, at start + i step (mm) for
  /// 0 <= i < count; g has mean 0 and standard deviation 1 over the whole tissue.
  void Apply(const Vec3& start, const Vec3& step, int count, double strength, double* levels) const;
  /// g at a point.
  double At(const Vec3& point) const;

private:
  float Find(std::uint32_t x, std::uint32_t y, std::uint32_t z) const;

  std::vector<std::int8_t> Grain;
  double Mean = 0; ///< of Grain between its points
  double Unit = 1; ///< of g in Grain
};

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
