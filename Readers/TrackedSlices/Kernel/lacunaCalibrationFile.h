// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The constant transforms of a device set configuration file as PLUS writes it.
#ifndef lacunaCalibrationFile_h
#define lacunaCalibrationFile_h

#include "lacunaMatrix4.h"

#include <string>
#include <vector>

namespace lacuna
{
/// A constant transform; Matrix maps coordinates in From to coordinates in To.
struct NamedTransform
{
  std::string From;
  std::string To;
  Matrix4 Matrix;
};

/// Reads the Transform elements (attributes From, To and Matrix, 16 numbers row by row) of
/// CoordinateDefinitions, in the order of the file and each once. Throws std::runtime_error that
/// names the file, the element and what is wrong: XML that is not well formed (with the line), no
/// CoordinateDefinitions or none with transforms, an attribute missing, a matrix that is not 16
/// finite numbers or cannot be inverted, or a transform that contradicts the ones before it: one
/// between the same two frames or along a chain of others that differs by more than a thousandth
/// (of the element, or of 1 when it is smaller).
std::vector<NamedTransform> ReadCalibrationFile(const std::string& fileName);

/// The text of such a file. comment: its first line.
std::string FormatCalibration(
  const std::vector<NamedTransform>& transforms, const std::string& comment);
}
#endif
