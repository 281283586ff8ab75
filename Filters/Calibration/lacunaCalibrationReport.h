// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What is said of a probe's calibration, and its file. Not a part of the module's interface.
#ifndef lacunaCalibrationReport_h
#define lacunaCalibrationReport_h

#include "lacunaCalibrationPicks.h"

#include <string>
#include <vector>

namespace lacuna
{
class CalibrationReport
{
public:
  struct Image
  {
    Vec2 Size{ 0, 0 };          ///< columns, rows; 0: there is no picture
    bool EstimateScale = false; ///< whether the spacings were found along with the rest
    double ExpectedRatio = 1;   ///< of the row spacing to the column spacing
    double ExpectedError = 0;   ///< mm at the worst corner
  };

  /// Keeps references.
  CalibrationReport(
    const ProbeCalibration& found, const std::vector<SlicePick>& picks, const Image& image)
    : Found(found)
    , Picks(picks)
    , Picture(image)
  {
  }

  /// What the user should know, the most important first.
  std::vector<std::string> GetAdvice() const;

  /// Why nobody should use this calibration, so that no file is written; empty: it may be used.
  std::string GetRefusal() const;

  /// Whether a file may be written over: it is not there, empty, or what Write wrote for these frames
  /// and nobody has changed.
  static bool MayReplace(
    const std::string& fileName, const std::string& from, const std::string& to);

  /// The XML that vtkLacunaTrackedSliceReader, PLUS and 3D Slicer take: a transform between frames of
  /// these names, Error is the expected error. It appears whole or not at all.
  void Write(const std::string& fileName, const char* from, const std::string& to,
    const std::vector<std::string>& advice) const;

private:
  Vec2 GetSize() const; // mm
  bool IsSizePlausible() const;
  bool HasRival() const;

  const ProbeCalibration& Found;
  const std::vector<SlicePick>& Picks;
  const Image& Picture;
};
}
#endif
