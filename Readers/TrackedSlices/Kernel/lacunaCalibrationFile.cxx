// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaCalibrationFile.h"

#include "lacunaInputFile.h"
#include "lacunaSequenceText.h"
#include "lacunaTransformGraph.h"

#include <pugixml.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <string_view>

namespace lacuna
{
namespace
{
constexpr std::size_t LargestFile = std::size_t{ 1 } << 24;
constexpr std::size_t MostTransforms =
  1000; // each is compared with the way that leads there already

bool NearlyEqual(const Matrix4& a, const Matrix4& b)
{
  for (int i = 0; i < 16; ++i)
  {
    const double x = a.Data()[i];
    if (!(std::abs(x - b.Data()[i]) <= 1e-3 * std::max(1.0, std::abs(x))))
    {
      return false;
    }
  }
  return true;
}

class CalibrationFileReader
{
public:
  explicit CalibrationFileReader(const std::string& fileName)
    : FileName(fileName)
  {
  }

  std::vector<NamedTransform> Read()
  {
    this->Load();
    bool defined = false;
    this->Visit(this->Document, defined);
    if (!defined)
    {
      this->Fail("has no CoordinateDefinitions element; a calibration file is a PLUS device set "
                 "configuration with <CoordinateDefinitions><Transform From=\"Image\" To=\"Probe\" "
                 "Matrix=\"16 numbers\"/></CoordinateDefinitions>");
    }
    if (this->Transforms.empty())
    {
      this->Fail("its CoordinateDefinitions has no Transform");
    }
    return std::move(this->Transforms);
  }

private:
  [[noreturn]] void Fail(const std::string& text) const
  {
    throw std::runtime_error(this->FileName + ": " + text);
  }

  void Load()
  {
    const std::string shown = "the calibration file '" + this->FileName + "'";
    std::ifstream stream = OpenForReading(this->FileName, shown);
    std::string text;
    std::array<char, 1 << 14> part;
    while (const std::size_t size = ReadBytes(stream, part.data(), part.size(), shown))
    {
      text.append(part.data(), size);
      if (text.size() > LargestFile)
      {
        throw std::runtime_error(shown + ": is larger than " + std::to_string(LargestFile) +
          " bytes, which no calibration file is; is it a recording?");
      }
    }
    if (text.empty())
    {
      throw std::runtime_error(shown + ": is empty");
    }
    const pugi::xml_parse_result result = this->Document.load_buffer(text.data(), text.size());
    if (!result)
    {
      const auto end = text.begin() +
        std::min<std::ptrdiff_t>(result.offset, static_cast<std::ptrdiff_t>(text.size()));
      this->Fail("is not well-formed XML: line " +
        std::to_string(1 + std::count(text.begin(), end, '\n')) + ": " + result.description());
    }
  }

  // Without recursion: the depth of a file is not ours to trust.
  void Visit(const pugi::xml_node& root, bool& defined)
  {
    struct Finder : pugi::xml_tree_walker
    {
      std::vector<pugi::xml_node> Found;
      bool for_each(pugi::xml_node& node) override
      {
        if (std::string_view(node.name()) == "CoordinateDefinitions")
        {
          this->Found.push_back(node);
        }
        return true;
      }
    } finder;
    pugi::xml_node start = root;
    start.traverse(finder);
    for (const pugi::xml_node& definitions : finder.Found)
    {
      defined = true;
      for (const pugi::xml_node& element : definitions.children("Transform"))
      {
        this->Add(element);
      }
    }
  }

  void Add(const pugi::xml_node& element)
  {
    NamedTransform transform;
    transform.From = Trim(element.attribute("From").value());
    transform.To = Trim(element.attribute("To").value());
    const std::string_view text = element.attribute("Matrix").value();
    const std::string name =
      "Transform From=\"" + transform.From + "\" To=\"" + transform.To + "\"";
    if (transform.From.empty() || transform.To.empty())
    {
      this->Fail(name + " lacks one of the attributes From and To");
    }
    if (transform.From == transform.To)
    {
      this->Fail(name + " leads from a frame to itself");
    }
    const std::string wrong = ParseMatrix(text, transform.Matrix);
    if (!wrong.empty())
    {
      this->Fail(name + ": the Matrix " + wrong);
    }
    try
    {
      transform.Matrix.Inverse();
    }
    catch (const std::invalid_argument& e)
    {
      this->Fail(name + ": the " + e.what());
    }
    if (this->Transforms.size() == MostTransforms)
    {
      this->Fail("has more than " + std::to_string(MostTransforms) + " transforms");
    }
    std::vector<TransformGraph::Link> chain;
    if (!this->Graph.HasFrame(transform.From) || !this->Graph.HasFrame(transform.To) ||
      !this->Graph.FindChain(transform.From, transform.To, chain))
    {
      this->Graph.Add(transform.From, transform.To, static_cast<int>(this->Transforms.size()));
      this->Transforms.push_back(transform);
      return;
    }
    Matrix4 known;
    for (const TransformGraph::Link& link : chain)
    {
      const Matrix4& step = this->Transforms[static_cast<std::size_t>(link.Transform)].Matrix;
      known = (link.Inverse ? step.Inverse() : step) * known;
    }
    if (!NearlyEqual(known, transform.Matrix))
    {
      this->Fail(name + " contradicts the transforms before it, which already lead from " +
        transform.From + " to " + transform.To + "; remove the wrong one");
    }
  }

  std::string FileName;
  pugi::xml_document Document;
  TransformGraph Graph;
  std::vector<NamedTransform> Transforms;
};
}

std::vector<NamedTransform> ReadCalibrationFile(const std::string& fileName)
{
  return CalibrationFileReader(fileName).Read();
}

std::string FormatCalibration(
  const std::vector<NamedTransform>& transforms, const std::string& comment)
{
  pugi::xml_document document;
  document.append_child(pugi::node_comment).set_value((" " + comment + " ").c_str());
  pugi::xml_node configuration = document.append_child("PlusConfiguration");
  configuration.append_attribute("version") = "2.9";
  pugi::xml_node definitions = configuration.append_child("CoordinateDefinitions");
  for (const NamedTransform& transform : transforms)
  {
    pugi::xml_node element = definitions.append_child("Transform");
    element.append_attribute("From") = transform.From.c_str();
    element.append_attribute("To") = transform.To.c_str();
    element.append_attribute("Matrix") = FormatMatrix(transform.Matrix).c_str();
  }
  std::ostringstream text;
  document.save(text, "  ", pugi::format_default | pugi::format_no_declaration);
  return text.str();
}
}
