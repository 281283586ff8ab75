// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaMarkups.h"

#include "lacunaDicomText.h"
#include "lacunaMemory.h"
#include "lacunaOutlineFile.h"
#include "vtk_jsoncpp.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <utility>

namespace lacuna
{
namespace
{
constexpr int DeepestNesting = 64;  // Slicer's files have 6 levels
constexpr double BytesOfValue = 60; // of jsoncpp for each byte of text, at most: "[1,1,1"
constexpr std::size_t LongestShown = 40;
constexpr std::size_t MostNamed = 8; // types in a message

std::string Show(const std::string& text)
{
  return "'" + DicomTextToUtf8(text.substr(0, LongestShown), "ISO_IR 192") +
    (text.size() > LongestShown ? "...'" : "'");
}

// "Liver" of "folder/Liver.mrk.json"
std::string GetStem(const std::string& path)
{
  std::string name = std::filesystem::path(path).filename().string();
  for (const std::string_view ending : { ".json", ".mrk" })
  {
    if (name.size() > ending.size() &&
      name.compare(name.size() - ending.size(), ending.size(), ending) == 0)
    {
      name.erase(name.size() - ending.size());
    }
  }
  return name;
}

class MarkupsReader
{
public:
  explicit MarkupsReader(const std::string& path)
    : Path(path)
    , Text(ReadOutlineText(path))
  {
  }

  OutlineSet Read()
  {
    const Json::Value root = this->Parse();
    const Json::Value* markups = Find(root, "markups");
    if (!markups || !markups->isArray())
    {
      throw std::runtime_error(this->Path +
        ": is JSON, but has no list \"markups\" as 3D Slicer writes it; save closed curves as "
        ".mrk.json");
    }
    for (const Json::Value& markup : *markups)
    {
      const std::string type = this->GetText(markup, "type", "");
      if (type == "ClosedCurve")
      {
        this->ReadCurve(markup);
      }
      else
      {
        ++this->OtherTypes[type.empty() ? "(none)" : Show(type)];
      }
    }
    const std::string others = this->DescribeOthers();
    if (this->Outlines.GetOutlines().empty())
    {
      throw std::runtime_error(this->Path + ": has no closed curve" +
        (others.empty() ? ", its list of markups is empty" : ", only " + others) +
        "; in 3D Slicer draw outlines with Closed Curve");
    }
    if (!others.empty())
    {
      this->Outlines.Warnings.push_back(
        "markups that are not closed curves are left out: " + others);
    }
    if (this->NotPlaced > 0)
    {
      this->Outlines.Warnings.push_back(std::to_string(this->NotPlaced) +
        " control points are left out because 3D Slicer has no position for them");
    }
    this->Outlines.IsPatient = true;
    return std::move(this->Outlines);
  }

private:
  Json::Value Parse() const
  {
    RequireMemory(
      this->Path + ": its markups", BytesOfValue * static_cast<double>(this->Text.size()));
    Json::CharReaderBuilder builder;
    Json::CharReaderBuilder::strictMode(&builder.settings_);
    builder["stackLimit"] = DeepestNesting;
    const std::unique_ptr<Json::CharReader> reader(builder.newCharReader());
    Json::Value root;
    std::string errors;
    bool isSound = false;
    try
    {
      isSound =
        reader->parse(this->Text.data(), this->Text.data() + this->Text.size(), &root, &errors);
    }
    catch (const Json::Exception& e)
    {
      errors = e.what();
    }
    if (!isSound)
    {
      // "* Line 3, Column 5\n  Missing ..."; later ones follow from the first
      std::string first = errors.substr(0, errors.find("\n*", 1));
      first.erase(0, first.find_first_not_of("* "));
      throw std::runtime_error(this->Path +
        ": is no whole JSON file: " + DicomTextToUtf8(first, "ISO_IR 192") +
        "; it may be cut off or damaged: save the markups again");
    }
    return root;
  }

  // Where something is in the file: "file: line 7: ".
  std::string Locate(const Json::Value& value) const
  {
    const auto offset = std::clamp<std::ptrdiff_t>(
      value.getOffsetStart(), 0, static_cast<std::ptrdiff_t>(this->Text.size()));
    // lines are counted on from the place before: curves follow one another
    const bool isBehind = offset >= this->Counted;
    this->Line = (isBehind ? this->Line : 1) +
      std::count(
        this->Text.begin() + (isBehind ? this->Counted : 0), this->Text.begin() + offset, '\n');
    this->Counted = offset;
    return this->Path + ": line " + std::to_string(this->Line) + ": ";
  }

  static const Json::Value* Find(const Json::Value& object, const std::string& name)
  {
    return object.isObject() ? object.find(name.data(), name.data() + name.size()) : nullptr;
  }

  std::string GetText(
    const Json::Value& object, const std::string& name, const std::string& otherwise) const
  {
    const Json::Value* value = Find(object, name);
    if (value && !value->isString())
    {
      throw std::runtime_error(
        this->Locate(*value) + name + " is no text in quotes; save the markups again");
    }
    return value ? value->asString() : otherwise;
  }

  // Read from the text: jsoncpp reads numbers as the program's locale says, in which 1.5 may be 1.
  std::optional<double> GetNumber(const Json::Value& value) const
  {
    if (!value.isNumeric())
    {
      return std::nullopt;
    }
    const char* begin = this->Text.data() + value.getOffsetStart();
    const char* end = this->Text.data() + value.getOffsetLimit();
    double number = 0;
    const auto [rest, error] = std::from_chars(begin, end, number);
    return error == std::errc() && rest == end && std::isfinite(number) ? std::optional(number)
                                                                        : std::nullopt;
  }

  std::optional<Vec3> GetVector(const Json::Value* value) const
  {
    if (!value || !value->isArray() || value->size() != 3)
    {
      return std::nullopt;
    }
    Vec3 vector{};
    for (int i = 0; i < 3; ++i)
    {
      const std::optional<double> number = this->GetNumber((*value)[i]);
      if (!number)
      {
        return std::nullopt;
      }
      vector[i] = *number;
    }
    return vector;
  }

  // 1 for LPS, -1 for RAS
  double GetSign(const Json::Value& curve, const std::string& name) const
  {
    const std::string system = this->GetText(curve, "coordinateSystem", "LPS"); // by the schema
    if (system != "LPS" && system != "RAS")
    {
      throw std::runtime_error(this->Locate(curve) + "the closed curve " + Show(name) +
        " has the coordinateSystem " + Show(system) +
        ", but only LPS and RAS are read; save it in one of them");
    }
    return system == "LPS" ? 1 : -1;
  }

  void CheckUnits(const Json::Value& curve, const std::string& name) const
  {
    const Json::Value* units = Find(curve, "coordinateUnits");
    const bool isCode = units && units->isArray() && units->size() == 3; // code, scheme, meaning
    const Json::Value* code = isCode ? &(*units)[0] : units;
    // without them mm, by the schema
    if (code && (!code->isString() || code->asString() != "mm"))
    {
      throw std::runtime_error(this->Locate(*units) + "the closed curve " + Show(name) +
        " has the coordinateUnits " +
        (code->isString() ? Show(code->asString()) : std::string("that are no text")) +
        ", but only mm is read; save it with the length unit mm");
    }
  }

  std::optional<StructureColor> GetColor(const Json::Value& curve) const
  {
    const Json::Value* display = Find(curve, "display");
    const Json::Value* points = Find(curve, "controlPoints");
    const bool isSelected = std::all_of(points->begin(), points->end(),
      [](const Json::Value& point)
      {
        const Json::Value* selected = Find(point, "selected");
        return !selected || !selected->isBool() || selected->asBool();
      });
    const auto color = display
      ? this->GetVector(Find(*display, isSelected ? "selectedColor" : "color"))
      : std::nullopt;
    if (!color)
    {
      return std::nullopt;
    }
    StructureColor bytes{};
    for (int i = 0; i < 3; ++i)
    {
      bytes[static_cast<std::size_t>(i)] =
        static_cast<unsigned char>(std::lround(255 * std::clamp((*color)[i], 0.0, 1.0)));
    }
    return bytes;
  }

  void ReadCurve(const Json::Value& curve)
  {
    std::string name = this->GetText(curve, "name", "");
    name = name.empty() ? GetStem(this->Path) : name;
    this->CheckUnits(curve, name);
    const double sign = this->GetSign(curve, name);
    const Json::Value* points = Find(curve, "controlPoints");
    if (!points || !points->isArray())
    {
      throw std::runtime_error(this->Locate(curve) + "the closed curve " + Show(name) +
        " has no list controlPoints; save the markups again");
    }
    StructureOutline outline;
    for (Json::ArrayIndex i = 0; i < points->size(); ++i)
    {
      const Json::Value& point = (*points)[i];
      if (this->GetText(point, "positionStatus", "defined") != "defined")
      {
        ++this->NotPlaced;
        continue;
      }
      const std::optional<Vec3> position = this->GetVector(Find(point, "position"));
      if (!position)
      {
        throw std::runtime_error(this->Locate(point) + "control point " + std::to_string(i + 1) +
          " of the closed curve " + Show(name) +
          " has no position of three finite numbers (mm); correct or delete it");
      }
      outline.Points.push_back({ sign * (*position)[0], sign * (*position)[1], (*position)[2] });
    }
    outline.Structure = this->Outlines.AddStructure(name, this->GetColor(curve));
    outline.Number = static_cast<int>(this->Outlines.GetOutlines().size()) + 1;
    this->Outlines.AddOutline(
      std::move(outline), this->Locate(curve) + "the closed curve " + Show(name));
  }

  std::string DescribeOthers() const
  {
    std::string text;
    std::size_t named = 0;
    for (const auto& [type, count] : this->OtherTypes)
    {
      if (++named > MostNamed)
      {
        return text + " and others";
      }
      text += (text.empty() ? "" : ", ") + std::to_string(count) + " of type " + type;
    }
    return text;
  }

  std::string Path;
  std::string Text;
  OutlineSet Outlines;
  std::map<std::string, std::size_t> OtherTypes;
  std::size_t NotPlaced = 0;
  mutable std::ptrdiff_t Counted = 0; // a place in the text
  mutable std::ptrdiff_t Line = 1;    // of it
};
}

//------------------------------------------------------------------------------
OutlineSet ReadMarkups(const std::string& path)
{
  return MarkupsReader(path).Read();
}
}
