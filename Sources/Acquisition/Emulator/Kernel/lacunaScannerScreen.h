// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What the screen of an emulated ultrasound scanner looks like.
#ifndef lacunaScannerScreen_h
#define lacunaScannerScreen_h

#include "lacunaFanDetection.h"
#include "lacunaMatrix4.h"

#include <cstdint>
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
}
#endif
