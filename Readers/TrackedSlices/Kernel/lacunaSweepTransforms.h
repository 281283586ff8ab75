// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The transforms from which a sweep's poses are composed: those that a sequence has for each frame
/// and the constant ones of a calibration file.
#ifndef lacunaSweepTransforms_h
#define lacunaSweepTransforms_h

#include "lacunaMatrix4.h"
#include "lacunaSequenceHeader.h"
#include "lacunaTransformGraph.h"

#include <string>
#include <vector>

namespace lacuna
{
struct SweepTransform
{
  std::string Name; ///< as in the file: "ProbeToTracker"
  std::string From; ///< empty when the name does not tell the frames
  std::string To;
  bool FromCalibration = false;
  bool FromHeader = false;         ///< one text for the whole sequence, given to every frame
  std::vector<Matrix4> Matrices;   ///< one, or one for each frame: NaN where Errors has a text
  std::vector<std::string> Errors; ///< what is wrong with a frame's text; empty when nothing is
  const std::vector<std::string>* Status = nullptr; ///< null when no frame has one

  const Matrix4& Get(std::size_t frame) const
  {
    return this->Matrices[this->FromCalibration ? 0 : frame];
  }
  /// Whether the calibration or the sequence's status says that it is valid in this frame.
  bool IsValid(std::size_t frame) const { return !this->Status || (*this->Status)[frame] == "OK"; }
  /// Whether it is the same in all frames.
  bool IsConstant() const;
  /// Whether it does not move: it is the same in three of four frames that have it, since others may be
  /// damaged.
  bool IsFixed() const;
};

/// Column and row of the scanner's picture at which the slices begin: 0 0 unless the header has the
/// fields FirstColumn and FirstRow. Coordinates in the frame Image are those of the whole picture,
/// also in a calibration file; only in the sequence's own transforms they are those of its pixels, so
/// that other programs understand them. Throws std::runtime_error for a field that is no whole
/// number.
Vec3 GetPictureOrigin(const SequenceHeader& header);

class SweepTransforms
{
public:
  /// Reads the transforms of header's frames and of header itself, and those of the calibration file,
  /// if its name is not empty. A transform of the calibration replaces those of the sequence between its two frames.
  /// header must outlive this object. Throws std::runtime_error when the calibration cannot be
  /// used.
  SweepTransforms(const SequenceHeader& header, const std::string& calibrationFileName);

  const TransformGraph& GetGraph() const { return this->Graph; }
  const SweepTransform& Get(const TransformGraph::Link& link) const
  {
    return this->Transforms[static_cast<std::size_t>(link.Transform)];
  }
  const std::vector<SweepTransform>& GetAll() const { return this->Transforms; }

  /// Composes chain for a frame. Returns false when a matrix in it is missing, not finite, not
  /// affine or singular.
  bool Compose(
    const std::vector<TransformGraph::Link>& chain, std::size_t frame, Matrix4& product) const;

  /// The names of all transforms, for messages.
  std::string Describe() const;
  const std::vector<std::string>& GetWarnings() const { return this->Warnings; }

  /// The transform that a frame field holds: "ProbeToTracker" for "ProbeToTrackerTransform", empty
  /// when the field is not a transform.
  static std::string GetTransformName(const std::string& field);

private:
  void ReadCalibration(const std::string& fileName);
  void ReadFrames(const SequenceHeader& header);
  void ReadHeader(const SequenceHeader& header);
  void ReportUnnamed(const SequenceHeader& header);
  void NameFrames();
  static bool IsSame(
    const SweepTransform& transform, const SweepTransform& constant, bool forwards);
  bool Enter(std::size_t transform, const std::string& from, const std::string& to);
  void RelateToPicture(SweepTransform& transform, const std::string& from, const std::string& to);

  bool HasCalibrationFile;
  Vec3 PictureOrigin;
  std::vector<SweepTransform> Transforms; ///< the calibration's first: they win among equal chains
  TransformGraph Graph;
  std::vector<std::string> Warnings;
};
}
#endif
