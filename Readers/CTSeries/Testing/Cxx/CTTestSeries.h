// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// CT series for tests, written by GDCM: a letter F and a slope in known patient coordinates, seen
/// by scans of any orientation.
#ifndef CTTestSeries_h
#define CTTestSeries_h

#include "lacunaVector.h"

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

/// Hounsfield units at a point of the patient (LPS, mm): 3 x - 5 y + 7 z + 100, and 1500 more in a
/// letter F of bars, which no rotation takes to its mirror image.
double CTTruth(const lacuna::Vec3& point);
/// Whether a point lies in the letter, whose bars are grown by margin mm.
bool IsInLetter(const lacuna::Vec3& point, double margin = 0);

/// Distance of a point from the surface of the letter, mm; negative inside.
double DistanceToLetter(const lacuna::Vec3& point);

/// A scan. What is not set is that of an ordinary axial one, head first and supine.
struct CTTestSeries
{
  lacuna::Vec3 Row = { 1, 0, 0 };    ///< direction of growing column
  lacuna::Vec3 Column = { 0, 1, 0 }; ///< direction of growing row
  lacuna::Vec3 First = { -20, -24, -16 };
  lacuna::Vec3 Step = { 0, 0, 2 }; ///< from slice to slice; not along the normal: a tilted gantry
  double RowSpacing = 1.3;         ///< mm from row to row
  double ColumnSpacing = 0.9;      ///< mm from column to column
  int Columns = 44;
  int Rows = 36;
  int Slices = 17;
  std::vector<double> Places; ///< of the slices, in steps from the first; empty: 0, 1, 2, ...

  int BitsAllocated = 16;
  int BitsStored = 16;
  bool Signed = true;
  double Slope = 1;
  double Intercept = 0;
  std::string Photometric = "MONOCHROME2";
  std::string SeriesUid = "1.2.826.0.1.3680043.2.1125.1";
  std::string Description = "Letter F";
  std::string PatientPosition = "HFS";
  std::string TransferSyntax = "1.2.840.10008.1.2.1"; ///< any that GDCM writes
  bool MultiFrame = false;                            ///< one file of enhanced CT

  /// Elements to change or, with an empty text, to remove: "0028,1053" and the text. Applies to
  /// slice number k when Only is empty or holds k.
  struct Edit
  {
    std::uint16_t Group;
    std::uint16_t Element;
    std::string Vr; ///< two letters; US takes a decimal number
    std::string Value;
    std::vector<int> Only;
  };
  std::vector<Edit> Edits;
  /// Stored values instead of those of the truth: column, row, slice.
  std::function<std::int64_t(int, int, int)> Stored;
  /// Hounsfield units at a point of the patient.
  std::function<double(const lacuna::Vec3&)> Truth = CTTruth;

  /// Position of the first pixel of a slice.
  lacuna::Vec3 GetPosition(int slice) const;
  /// Writes the files into a folder that is made; names and instance numbers are in another order
  /// than the slices. Returns their names, slice by slice. Throws std::runtime_error.
  std::vector<std::string> Write(const std::string& folder) const;
};
#endif
