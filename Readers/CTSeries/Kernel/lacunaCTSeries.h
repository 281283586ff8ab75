// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Which images make a CT series, and which series is meant.
#ifndef lacunaCTSeries_h
#define lacunaCTSeries_h

#include "lacunaCTFrame.h"

#include <string>
#include <vector>

namespace lacuna
{
/// The images of one series that belong to a volume.
struct CTSeries
{
  std::string Uid;
  std::vector<CTFrame> Frames;
  bool IsOneOfKernels = false; ///< of several with this UID, which have images at the same places

  /// The UID, followed by " kernel " and (0018,1210) for one of several kernels.
  std::string GetName() const;
  /// One line that begins with the name and two blanks: number, description, amount and size of images. Without
  /// anything about the patient.
  std::string Describe() const;
  /// The different acquisition numbers, ascending.
  std::vector<int> GetAcquisitions() const;
};

/// What a folder holds.
struct CTSeriesList
{
  std::vector<CTSeries> Series;   ///< by series number, then UID
  std::vector<std::string> Notes; ///< what was left out, and why

  /// Each series on a line of its own.
  std::string Describe() const;
};

/// Why an image cannot be part of a CT volume ("is a localizer"); empty when it can.
std::string WhyNotInVolume(const CTFrame& frame);

/// Sorts frames into series; one that has images of several convolution kernels at one place becomes
/// one for each kernel. Images of other modalities, localizers, secondary captures and colour
/// images are left out with a note.
CTSeriesList ListSeries(const std::vector<CTFrame>& frames);

/// The series asked for. requested: a name, or a text that begins with a UID and a blank (as Describe
/// gives it); empty: that of the file which the user opened (file, with openedUid), else the only
/// one. Throws std::runtime_error with the list of series when that does not tell which.
const CTSeries& SelectSeries(const CTSeriesList& list, const std::string& requested,
  const std::string& file, const std::string& openedUid);

/// The images with an acquisition number; all for -1. Throws std::runtime_error with the numbers
/// there are when there is none.
std::vector<CTFrame> SelectAcquisition(const CTSeries& series, int acquisition);

/// Takes away scouts that do not say so: images that lie across (more than 60 degrees) at least three
/// parallel ones, no more than two of one direction, and together at most half as many as those.
/// Returns a note on each.
std::vector<std::string> TakeOutScouts(std::vector<CTFrame>& frames);

/// Throws std::runtime_error naming file and tag unless all images have pixels, one size, pixel
/// spacing, position, orientation, patient and frame of reference, as one volume has, and Patient
/// Orientation, where it is there, agrees with Image Orientation (Patient).
void CheckSameVolume(const std::vector<CTFrame>& frames);

/// Sentences that name files and tags where images of a volume have different birth dates, sexes or
/// positions of the patient, or convolution kernels; the values are not in them. Images that do not say
/// are passed over.
std::vector<std::string> FindDoubtsOfSeries(const std::vector<CTFrame>& frames);
}
#endif
