// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaIGESDocument.h"

#include "lacunaBSplineCurve.h"
#include "lacunaBSplineSurface.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <stdexcept>

namespace lacuna
{
namespace
{
constexpr std::int64_t MostLines = 9999999; // seven columns

std::string Printable(const std::string& text)
{
  std::string clean = text;
  for (char& c : clean)
  {
    c = c < ' ' || c > '~' ? '_' : c;
  }
  return clean;
}

// A number right-justified in a field; fill is ' ' or '0'.
std::string Field(std::int64_t value, std::size_t width, char fill = ' ')
{
  std::string digits = std::to_string(value);
  return digits.size() < width ? std::string(width - digits.size(), fill) + digits : digits;
}

std::string RealToken(double value)
{
  if (!std::isfinite(value))
  {
    throw std::invalid_argument("a number to be written to an IGES file is not finite");
  }
  value = value == 0 ? 0.0 : value; // no -0
  const double size = std::abs(value);
  const bool plain = size == 0 || (size >= 1e-4 && size < 1e16);
  char text[40];
  const std::to_chars_result end = std::to_chars(text, text + sizeof(text), value,
    plain ? std::chars_format::fixed : std::chars_format::scientific);
  std::string token(text, end.ptr);
  const std::size_t exponent = std::min(token.find('e'), token.size());
  if (token.find('.') == std::string::npos)
  {
    token.insert(exponent, ".");
  }
  std::replace(token.begin(), token.end(), 'e', 'E');
  return token;
}

// Start section: wrapped at blanks where possible.
std::vector<std::string> Wrapped(const std::vector<std::string>& text)
{
  std::vector<std::string> lines;
  for (const std::string& raw : text)
  {
    std::string rest = Printable(raw);
    while (rest.size() > 72)
    {
      std::size_t cut = rest.rfind(' ', 72);
      cut = cut == std::string::npos || cut == 0 ? 72 : cut;
      lines.push_back(rest.substr(0, cut));
      rest.erase(0, rest[cut] == ' ' ? cut + 1 : cut);
    }
    lines.push_back(rest);
  }
  if (lines.empty())
  {
    lines.emplace_back(); // the section has at least one line
  }
  return lines;
}

void AppendLine(std::string& text, const std::string& data, char section, std::int64_t number)
{
  text += data;
  text.append(72 - data.size(), ' ');
  text += section;
  text += Field(number, 7, '0');
  text += '\n';
}
}

//------------------------------------------------------------------------------
void IGESRecord::Add(const std::string& token, bool splittable)
{
  std::string* line = &this->Lines.back();
  if (line->size() + token.size() > this->Columns)
  {
    if (splittable && token.size() > this->Columns)
    {
      std::size_t begin = 0;
      while (begin < token.size())
      {
        if (this->Lines.back().size() == this->Columns)
        {
          this->Lines.emplace_back();
        }
        const std::size_t part = this->Columns - this->Lines.back().size();
        this->Lines.back() += token.substr(begin, part);
        begin += part;
      }
      return;
    }
    line = &this->Lines.emplace_back();
    line->reserve(this->Columns);
  }
  *line += token;
}

//------------------------------------------------------------------------------
void IGESRecord::AddInteger(std::int64_t value)
{
  this->Add(std::to_string(value) + ',', false);
}

//------------------------------------------------------------------------------
void IGESRecord::AddReal(double value)
{
  this->Add(RealToken(value) + ',', false);
}

//------------------------------------------------------------------------------
void IGESRecord::AddString(const std::string& value)
{
  const std::string token = std::to_string(value.size()) + 'H' + Printable(value) + ',';
  // The count and H must not be torn apart: a string to be split starts a line of its own.
  if (token.size() > this->Columns && !this->Lines.back().empty())
  {
    this->Lines.emplace_back();
  }
  this->Add(token, true);
}

//------------------------------------------------------------------------------
void IGESRecord::Close()
{
  this->Lines.back().back() = ';';
}

//------------------------------------------------------------------------------
IGESRecord IGESDocument::StartEntity(int type)
{
  IGESRecord record;
  record.AddInteger(type);
  return record;
}

//------------------------------------------------------------------------------
std::int64_t IGESDocument::AddEntity(int type, IGESRecord parameters, const Attributes& attributes,
  const std::vector<std::int64_t>& properties)
{
  if (!properties.empty())
  {
    parameters.AddInteger(0); // associativities
    parameters.AddInteger(static_cast<std::int64_t>(properties.size()));
    for (const std::int64_t property : properties)
    {
      parameters.AddInteger(property);
    }
  }
  parameters.Close();
  this->Entities.push_back({ type, attributes, parameters.GetLines() });
  return 2 * static_cast<std::int64_t>(this->Entities.size()) - 1;
}

//------------------------------------------------------------------------------
std::int64_t IGESDocument::AddName(const std::string& name)
{
  IGESRecord record = StartEntity(406);
  record.AddInteger(1);
  record.AddString(name);
  Attributes attributes;
  attributes.Form = 15;
  return this->AddEntity(406, std::move(record), attributes);
}

//------------------------------------------------------------------------------
std::int64_t IGESDocument::AddColour(double red, double green, double blue, const std::string& name)
{
  IGESRecord record = StartEntity(314);
  for (const double part : { red, green, blue })
  {
    record.AddReal(100 * part);
  }
  record.AddString(name);
  Attributes attributes;
  attributes.UseFlag = 2; // definition
  return this->AddEntity(314, std::move(record), attributes);
}

//------------------------------------------------------------------------------
std::int64_t IGESDocument::AddSurface(const BSplineSurface& surface, const Attributes& attributes,
  const std::vector<std::int64_t>& properties)
{
  const std::size_t size = surface.ControlPoints.size();
  IGESRecord record = StartEntity(128);
  for (const std::int64_t value :
    { surface.U.GetSize() - 1, surface.V.GetSize() - 1, std::int64_t{ 3 }, std::int64_t{ 3 },
      std::int64_t{ surface.IsClosedU() }, std::int64_t{ surface.IsClosedV() }, std::int64_t{ 1 },
      std::int64_t{ 0 }, std::int64_t{ 0 } })
  {
    record.AddInteger(value);
  }
  for (const CubicSplineSpace* space : { &surface.U, &surface.V })
  {
    for (const double knot : space->GetKnots())
    {
      record.AddReal(knot);
    }
  }
  for (std::size_t i = 0; i < size; ++i)
  {
    record.AddReal(1); // weights of a polynomial surface
  }
  for (const Vec3& p : surface.ControlPoints)
  {
    this->AddCoordinates(record, p);
  }
  for (const double limit :
    { surface.U.GetFirst(), surface.U.GetLast(), surface.V.GetFirst(), surface.V.GetLast() })
  {
    record.AddReal(limit);
  }
  return this->AddEntity(128, std::move(record), attributes, properties);
}

//------------------------------------------------------------------------------
void IGESDocument::AddCoordinates(IGESRecord& record, const Vec3& point)
{
  for (const double x : point.Elements)
  {
    record.AddReal(x);
    this->MaximumCoordinate = std::max(this->MaximumCoordinate, std::abs(x));
  }
}

//------------------------------------------------------------------------------
std::int64_t IGESDocument::AddCurve(const BSplineCurve& curve, bool inParameters,
  const Attributes& attributes, const std::vector<std::int64_t>& properties)
{
  const std::size_t size = curve.ControlPoints.size();
  IGESRecord record = StartEntity(126);
  record.AddInteger(static_cast<std::int64_t>(size) - 1);
  record.AddInteger(3);
  for (const bool property : { inParameters, curve.IsClosed(), true, false })
  {
    record.AddInteger(property); // planar, closed, polynomial, periodic
  }
  for (const double knot : curve.Knots)
  {
    record.AddReal(knot);
  }
  for (std::size_t i = 0; i < size; ++i)
  {
    record.AddReal(1); // weights of a polynomial curve
  }
  for (const Vec3& p : curve.ControlPoints)
  {
    if (inParameters)
    {
      record.AddReal(p[0]);
      record.AddReal(p[1]);
      record.AddReal(0);
    }
    else
    {
      this->AddCoordinates(record, p);
    }
  }
  record.AddReal(curve.Knots.front());
  record.AddReal(curve.Knots.back());
  for (const int normal : { 0, 0, inParameters ? 1 : 0 })
  {
    record.AddReal(normal); // of the plane, where there is one
  }
  return this->AddEntity(126, std::move(record), attributes, properties);
}

//------------------------------------------------------------------------------
std::int64_t IGESDocument::AddCurve(const BSplineCurve& curve, const Attributes& attributes,
  const std::vector<std::int64_t>& properties)
{
  return this->AddCurve(curve, false, attributes, properties);
}

//------------------------------------------------------------------------------
std::int64_t IGESDocument::AddPoint(
  const Vec3& point, const Attributes& attributes, const std::vector<std::int64_t>& properties)
{
  IGESRecord record = StartEntity(116);
  this->AddCoordinates(record, point);
  record.AddInteger(0); // no symbol to show it by
  return this->AddEntity(116, std::move(record), attributes, properties);
}

//------------------------------------------------------------------------------
std::int64_t IGESDocument::AddPolygon(const std::vector<Vec3>& points, const Attributes& attributes,
  const std::vector<std::int64_t>& properties)
{
  Attributes side = attributes;
  side.Subordinate = 1;
  side.Label = "SIDE";
  IGESRecord record = StartEntity(102);
  record.AddInteger(static_cast<std::int64_t>(points.size()) - 1);
  for (std::size_t k = 1; k < points.size(); ++k)
  {
    record.AddInteger(this->AddLine(points[k - 1], points[k], side));
  }
  return this->AddEntity(102, std::move(record), attributes, properties);
}

//------------------------------------------------------------------------------
std::int64_t IGESDocument::AddLine(const Vec3& from, const Vec3& to, const Attributes& attributes,
  const std::vector<std::int64_t>& properties)
{
  IGESRecord record = StartEntity(110);
  this->AddCoordinates(record, from);
  this->AddCoordinates(record, to);
  return this->AddEntity(110, std::move(record), attributes, properties);
}

//------------------------------------------------------------------------------
std::int64_t IGESDocument::AddTrimmedSurface(std::int64_t surface,
  const std::vector<Boundary>& boundaries, const Attributes& attributes,
  const std::vector<std::int64_t>& properties)
{
  Attributes part = attributes;
  part.Subordinate = 1;
  std::vector<std::int64_t> curves;
  for (const Boundary& boundary : boundaries)
  {
    part.Label = "BOUNDARY";
    Attributes flat = part;
    flat.UseFlag = 5; // a curve in the parameters of a surface
    IGESRecord record = StartEntity(142);
    record.AddInteger(0); // how the curve was made: not said
    record.AddInteger(surface);
    record.AddInteger(this->AddCurve(*boundary.Parameters, true, flat, {}));
    record.AddInteger(this->AddCurve(*boundary.Space, false, part, {}));
    record.AddInteger(1); // the one in the parameters is exactly on the surface
    curves.push_back(this->AddEntity(142, std::move(record), part));
  }
  IGESRecord record = StartEntity(144);
  record.AddInteger(surface);
  record.AddInteger(1); // the outer boundary is not that of the surface
  record.AddInteger(static_cast<std::int64_t>(curves.size()) - 1);
  for (const std::int64_t curve : curves)
  {
    record.AddInteger(curve);
  }
  return this->AddEntity(144, std::move(record), attributes, properties);
}

//------------------------------------------------------------------------------
IGESRecord IGESDocument::GetGlobal(const IGESHeader& header) const
{
  IGESRecord record(72);
  record.AddString(",");
  record.AddString(";");
  record.AddString(header.Product);
  record.AddString(header.FileName);
  record.AddString(header.System);
  record.AddString(header.Preprocessor);
  for (const int value : { 32, 38, 6, 308, 15 }) // integer bits, ranges and digits of reals
  {
    record.AddInteger(value);
  }
  record.AddString(header.Product); // as the receiver shall name it
  record.AddReal(1);                // scale
  record.AddInteger(2);             // unit: mm
  record.AddString("MM");
  record.AddInteger(1); // line weights
  record.AddReal(0.1);  // their largest width, mm
  record.AddString(header.Date);
  record.AddReal(header.MinimumResolution);
  record.AddReal(std::ceil(std::max(this->MaximumCoordinate, 1.0)));
  record.AddString("Lacuna"); // author: never a person's name
  record.AddString("Lacuna"); // organisation
  record.AddInteger(11);      // IGES 5.3
  record.AddInteger(0);       // drafting standard: none
  record.AddString(header.Date);
  record.AddString("none"); // application protocol
  record.Close();
  return record;
}

//------------------------------------------------------------------------------
std::string IGESDocument::GetText(const IGESHeader& header) const
{
  const std::vector<std::string> start = Wrapped(header.Start);
  const IGESRecord global = this->GetGlobal(header);
  std::int64_t parameterLines = 0;
  for (const Entity& entity : this->Entities)
  {
    parameterLines += static_cast<std::int64_t>(entity.Lines.size());
  }
  if (parameterLines > MostLines)
  {
    throw std::runtime_error("the IGES file would have " + std::to_string(parameterLines) +
      " parameter lines; it can have 9999999. Use fewer samples or a larger tolerance");
  }

  std::string text;
  text.reserve(81 *
    (start.size() + global.GetLines().size() + 2 * this->Entities.size() +
      static_cast<std::size_t>(parameterLines) + 1));
  std::int64_t number = 0;
  for (const std::string& line : start)
  {
    AppendLine(text, line, 'S', ++number);
  }
  const std::int64_t startLines = number;
  number = 0;
  for (const std::string& line : global.GetLines())
  {
    AppendLine(text, line, 'G', ++number);
  }
  const std::int64_t globalLines = number;

  number = 0;
  std::int64_t parameter = 1;
  for (const Entity& entity : this->Entities)
  {
    const auto lines = static_cast<std::int64_t>(entity.Lines.size());
    const Attributes& a = entity.Fields;
    std::string label = Printable(a.Label).substr(0, 8);
    label.insert(0, 8 - label.size(), ' ');
    // Type, parameters, structure, line font, level, view, matrix, label display, status (visible,
    // subordinate, use, hierarchy).
    AppendLine(text,
      Field(entity.Type, 8) + Field(parameter, 8) + Field(0, 8) + Field(0, 8) + Field(a.Level, 8) +
        Field(0, 8) + Field(0, 8) + Field(0, 8) + "00" + Field(a.Subordinate, 2, '0') +
        Field(a.UseFlag, 2, '0') + "00",
      'D', ++number);
    // Type, line weight, colour, parameter lines, form, reserved, reserved, label, subscript.
    AppendLine(text,
      Field(entity.Type, 8) + Field(0, 8) + Field(a.Colour, 8) + Field(lines, 8) +
        Field(a.Form, 8) + std::string(16, ' ') + label + Field(0, 8),
      'D', ++number);
    parameter += lines;
  }
  const std::int64_t directoryLines = number;

  number = 0;
  std::int64_t entry = 1;
  for (const Entity& entity : this->Entities)
  {
    for (const std::string& line : entity.Lines)
    {
      AppendLine(
        text, line + std::string(65 - line.size(), ' ') + Field(entry, 7, '0'), 'P', ++number);
    }
    entry += 2;
  }
  AppendLine(text,
    'S' + Field(startLines, 7, '0') + 'G' + Field(globalLines, 7, '0') + 'D' +
      Field(directoryLines, 7, '0') + 'P' + Field(parameterLines, 7, '0'),
    'T', 1);
  return text;
}
}
