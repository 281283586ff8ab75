// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What the model of a defect shall be like.
#ifndef lacunaDefectModelOptions_h
#define lacunaDefectModelOptions_h

namespace lacuna
{
/// The floor of the defect.
enum class DefectFloor
{
  Flat,    ///< one plane, everywhere at least DefectDepth below the fit
  Parallel ///< the true normal offset of the fit by DefectDepth
};

struct DefectModelOptions
{
  double Margin = 15; ///< mm of bone around the defect as seen along z, >= 0
  DefectFloor Floor = DefectFloor::Flat;
  double DefectDepth = 10;  ///< mm, > 0
  double BaseThickness = 5; ///< mm below the floor, > 0
  double MaximumHeight = 0; ///< mm from the highest point to the base; 0: as the bone needs
};

/// mm, of DefectDepth and of BaseThickness; the other two are limited by the map and by the bone.
constexpr double LargestBlock = 1000;

/// Throws std::invalid_argument that names the option, its value and what would be right.
void CheckDefectModelOptions(const DefectModelOptions& options);
}
#endif
