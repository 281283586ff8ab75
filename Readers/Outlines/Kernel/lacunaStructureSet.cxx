// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaStructureSet.h"

#include "lacunaDicomDataSet.h"
#include "lacunaDicomText.h"

#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>
#include <utility>
#include <vector>

namespace lacuna
{
namespace
{
constexpr const char* StructureSetClass = "1.2.840.10008.5.1.4.1.1.481.3";
constexpr DicomTag CharacterSetTag = 0x00080005;
constexpr DicomTag SopClassTag = 0x00080016;
constexpr DicomTag ModalityTag = 0x00080060;
constexpr DicomTag StructureSequence = 0x30060020;
constexpr DicomTag StructureNumberTag = 0x30060022;
constexpr DicomTag FrameOfReferenceTag = 0x30060024;
constexpr DicomTag StructureNameTag = 0x30060026;
constexpr DicomTag ColorTag = 0x3006002A;
constexpr DicomTag StructureContourSequence = 0x30060039;
constexpr DicomTag ContourSequence = 0x30060040;
constexpr DicomTag ContourTypeTag = 0x30060042;
constexpr DicomTag PointCountTag = 0x30060046;
constexpr DicomTag PointsTag = 0x30060050;
constexpr DicomTag ReferencedNumberTag = 0x30060084;
constexpr std::size_t MostNamed = 5;
constexpr std::size_t LongestName = 1024; // bytes

std::string Join(const std::vector<std::string>& names)
{
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), MostNamed); ++i)
  {
    text += (i == 0 ? "" : ", ") + names[i];
  }
  return names.size() > MostNamed
    ? text + " and " + std::to_string(names.size() - MostNamed) + " more"
    : text;
}

std::string Describe(const DicomDataSet& data)
{
  const std::string modality = data.GetText(ModalityTag);
  const std::string sopClass = data.GetText(SopClassTag);
  return "modality " + (modality.empty() ? "(none)" : modality) + " (0008,0060), SOP class " +
    (sopClass.empty() ? "(none)" : sopClass) + " (0008,0016)";
}

std::optional<StructureColor> ReadColor(const DicomDataSet& item)
{
  const auto numbers = item.GetNumbers(ColorTag, 3);
  if (!numbers ||
    !std::all_of(numbers->begin(), numbers->end(), [](double c) { return c >= 0 && c <= 255; }))
  {
    return std::nullopt;
  }
  StructureColor color{};
  for (std::size_t i = 0; i < color.size(); ++i)
  {
    color[i] = static_cast<unsigned char>((*numbers)[i] + 0.5);
  }
  return color;
}

class StructureSetReader
{
public:
  explicit StructureSetReader(const std::string& path)
    : Path(path)
  {
    DicomSelection selection;
    selection.Sequences = { StructureSequence, StructureContourSequence, ContourSequence };
    selection.LongestValue = std::numeric_limits<std::int64_t>::max();
    this->File = ReadDicomFile(path, selection);
  }

  OutlineSet Read()
  {
    const DicomDataSet& data = this->File.Data;
    if (data.GetText(SopClassTag) != StructureSetClass)
    {
      this->Fail("is a DICOM file, but no RT structure set: " + Describe(data) +
        (data.GetText(ModalityTag) == "CT" ? "; open it with CT Series Reader"
                                           : "; choose the file of modality RTSTRUCT"));
    }
    this->ReadNames();
    for (const DicomDataSet& item : data.GetItems(StructureContourSequence))
    {
      this->ReadStructure(item);
    }
    this->Warn();
    if (this->Outlines.GetOutlines().empty())
    {
      this->Fail("has no contour of type CLOSED_PLANAR (3006,0042)" +
        std::string(this->OtherTypes.empty() ? "; the file may be cut off" : "") +
        this->DescribeOthers("; it has ", ""));
    }
    this->Outlines.IsPatient = true;
    return std::move(this->Outlines);
  }

private:
  [[noreturn]] void Fail(const std::string& what) const
  {
    throw std::runtime_error(this->Path + ": " + what);
  }

  void ReadNames()
  {
    const std::string characters = this->File.Data.GetText(CharacterSetTag);
    for (const DicomDataSet& item : this->File.Data.GetItems(StructureSequence))
    {
      const std::optional<int> number = item.GetInteger(StructureNumberTag);
      if (!number)
      {
        this->Fail("a structure has no valid ROI Number (3006,0022); save the structures again");
      }
      std::string name = DicomTextToUtf8(item.GetBytes(StructureNameTag), characters);
      if (name.size() > LongestName) // each outline tells it
      {
        this->Fail("a structure has a name (3006,0026) of " + std::to_string(name.size()) +
          " bytes, where 64 characters are allowed; the file may be damaged: export it again");
      }
      name = name.empty() ? "Structure " + std::to_string(*number) : name;
      if (!this->Names.emplace(*number, name).second)
      {
        this->Fail("two structures have the ROI Number (3006,0022) " + std::to_string(*number) +
          "; save the structures again");
      }
      this->Frames[*number] = item.GetText(FrameOfReferenceTag);
    }
  }

  void ReadStructure(const DicomDataSet& item)
  {
    const std::optional<int> number = item.GetInteger(ReferencedNumberTag);
    const auto found = number ? this->Names.find(*number) : this->Names.end();
    if (found == this->Names.end())
    {
      this->Fail("contours belong to the ROI Number (3006,0084) '" +
        item.GetText(ReferencedNumberTag) +
        "', which the Structure Set ROI Sequence (3006,0020) does not have; save the structures "
        "again");
    }
    const std::string& name = found->second;
    const std::optional<StructureColor> color = ReadColor(item);
    const std::size_t before = this->Outlines.GetOutlines().size();
    std::size_t count = 0;
    for (const DicomDataSet& contour : item.GetItems(ContourSequence))
    {
      ++count;
      const std::string type = contour.GetText(ContourTypeTag);
      if (type != "CLOSED_PLANAR")
      {
        ++this->OtherTypes[type.empty() ? "(none)" : DicomTextToUtf8(type, {})];
        continue;
      }
      const std::string where =
        this->Path + ": contour " + std::to_string(count) + " of '" + name + "'";
      StructureOutline outline;
      outline.Points = this->ReadPoints(contour, where);
      constexpr std::size_t fewest = 3;
      if (outline.Points.size() < fewest) // as drawing by threshold leaves them
      {
        ++this->OtherTypes[type + " with fewer than 3 points"];
        continue;
      }
      outline.Structure = this->Outlines.AddStructure(name, color);
      outline.Number = static_cast<int>(this->Outlines.GetOutlines().size()) + 1;
      this->Outlines.AddOutline(std::move(outline), where);
    }
    if (this->Outlines.GetOutlines().size() > before)
    {
      this->Drawn.insert(*number);
    }
  }

  static std::vector<Vec3> ReadPoints(const DicomDataSet& contour, const std::string& where)
  {
    const std::vector<std::string> values = SplitDicomValues(contour.GetBytes(PointsTag));
    const std::string said = contour.GetText(PointCountTag);
    const std::optional<int> count = contour.GetInteger(PointCountTag);
    if (!count || *count < 0 || values.size() != 3 * static_cast<std::size_t>(*count))
    {
      throw std::runtime_error(where + ": Number of Contour Points (3006,0046) is '" + said +
        "', but Contour Data (3006,0050) has " + std::to_string(values.size()) +
        " coordinates, three for each point; the file may be damaged: export it again");
    }
    std::vector<Vec3> points(values.size() / 3);
    for (std::size_t i = 0; i < values.size(); ++i)
    {
      const auto number = ParseDicomNumbers(values[i], 1);
      if (!number)
      {
        throw std::runtime_error(where + ": point " + std::to_string(i / 3 + 1) +
          " has the coordinate '" + DicomTextToUtf8(values[i].substr(0, 20), {}) +
          "', which is no finite number (mm); export the file again");
      }
      points[i / 3][static_cast<int>(i % 3)] = number->front();
    }
    return points;
  }

  std::string DescribeOthers(const char* before, const char* after) const
  {
    std::vector<std::string> types;
    types.reserve(this->OtherTypes.size());
    for (const auto& [type, count] : this->OtherTypes)
    {
      types.push_back(std::to_string(count) + " of type " + type);
    }
    return types.empty() ? std::string() : before + Join(types) + after;
  }

  void Warn()
  {
    std::vector<std::string>& warnings = this->Outlines.Warnings;
    const std::string others =
      this->DescribeOthers("contours (3006,0042) are left out because they enclose nothing: ", "");
    if (!others.empty())
    {
      warnings.push_back(others);
    }
    std::vector<std::string> without;
    std::set<std::string> frames;
    for (const auto& [number, name] : this->Names)
    {
      if (this->Drawn.count(number) == 0)
      {
        without.push_back(name);
      }
      else
      {
        frames.insert(this->Frames[number]);
      }
    }
    if (!without.empty())
    {
      warnings.push_back("structures without closed contours are left out: " + Join(without));
    }
    if (frames.size() > 1)
    {
      warnings.push_back("the structures refer to " + std::to_string(frames.size()) +
        " frames of reference (3006,0024): their positions cannot be compared with one another");
    }
  }

  std::string Path;
  DicomFile File;
  OutlineSet Outlines;
  std::map<int, std::string> Names;
  std::map<int, std::string> Frames; // of reference
  std::set<int> Drawn;               // structures with outlines
  std::map<std::string, std::size_t> OtherTypes;
};
}

//------------------------------------------------------------------------------
bool IsStructureSet(const std::string& path)
{
  return ReadDicomFile(path).Data.GetText(SopClassTag) == StructureSetClass;
}

//------------------------------------------------------------------------------
OutlineSet ReadStructureSet(const std::string& path)
{
  return StructureSetReader(path).Read();
}
}
