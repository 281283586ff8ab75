// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaOutlineSet.h"

#include "lacunaDicomText.h"

#include <stdexcept>
#include <utility>

namespace lacuna
{
namespace
{
// Of structures whose file gives no colour: neighbours in the list differ also to colour-blind eyes.
constexpr StructureColor Colors[] = { { 230, 159, 0 }, { 86, 180, 233 }, { 0, 158, 115 },
  { 240, 228, 66 }, { 0, 114, 178 }, { 213, 94, 0 }, { 204, 121, 167 }, { 153, 221, 255 },
  { 170, 170, 0 }, { 187, 204, 51 }, { 255, 170, 187 }, { 153, 153, 153 } };
}

//------------------------------------------------------------------------------
std::size_t OutlineSet::AddStructure(
  std::string_view name, const std::optional<StructureColor>& color)
{
  const std::string clean = DicomTextToUtf8(name, "ISO_IR 192");
  const auto [place, isNew] = this->Indices.emplace(clean, this->Structures.size());
  if (isNew)
  {
    const StructureColor& own = Colors[this->Structures.size() % std::size(Colors)];
    this->Structures.push_back({ clean, color.value_or(own) });
  }
  return place->second;
}

//------------------------------------------------------------------------------
void OutlineSet::AddOutline(StructureOutline outline, const std::string& where)
{
  std::vector<Vec3>& points = outline.Points;
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    if (!IsFinite(points[i]))
    {
      throw std::runtime_error(
        where + ": point " + std::to_string(i + 1) + " is not finite; correct or delete it");
    }
  }
  if (points.size() > 1 && points.front() == points.back())
  {
    points.pop_back();
  }
  if (points.size() < 3)
  {
    throw std::runtime_error(where + " has " + std::to_string(points.size()) +
      (points.size() == 1 ? " point" : " different points") +
      ", but an outline needs 3; add points or delete it in the program that wrote the file");
  }
  this->Outlines.push_back(std::move(outline));
}
}
