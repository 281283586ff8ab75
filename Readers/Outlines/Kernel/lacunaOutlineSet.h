// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Outlines of structures (organs, lesions), as files of other programs have them.
#ifndef lacunaOutlineSet_h
#define lacunaOutlineSet_h

#include "lacunaVector.h"

#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lacuna
{
/// Red, green, blue, 0 to 255.
using StructureColor = std::array<unsigned char, 3>;

struct OutlinedStructure
{
  std::string Name; ///< UTF-8
  StructureColor Color{};
};

/// One closed line.
struct StructureOutline
{
  std::size_t Structure = 0; ///< index, from 0
  int Number = 0;            ///< as the file counts outlines, else from 1
  int Slice = -1;            ///< number of the slice that it was drawn in; -1: not known
  std::vector<Vec3> Points;  ///< mm, at least three; the last is joined to the first
};

class OutlineSet
{
public:
  /// Index of the structure of that name, which is added when it is new. Its colour is the first that
  /// was given for it, else one of a list of twelve. Control characters in name become blanks.
  std::size_t AddStructure(
    std::string_view name, const std::optional<StructureColor>& color = std::nullopt);

  /// A last point that repeats the first is dropped. Throws std::runtime_error that begins with where
  /// when fewer than three points remain or one is not finite.
  void AddOutline(StructureOutline outline, const std::string& where);

  const std::vector<OutlinedStructure>& GetStructures() const { return this->Structures; }
  const std::vector<StructureOutline>& GetOutlines() const { return this->Outlines; }

  std::vector<std::string> Warnings; ///< sentences for the user
  bool IsPatient = false;            ///< points are in patient coordinates (DICOM LPS)

private:
  std::vector<OutlinedStructure> Structures;
  std::vector<StructureOutline> Outlines;
  std::map<std::string, std::size_t, std::less<>> Indices;
};
}
#endif
