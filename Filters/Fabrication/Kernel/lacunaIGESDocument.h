// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// IGES 5.3 files, fixed ASCII form. Source: U.S. Product Data Association, Initial Graphics
/// Exchange Specification IGES 5.3, 1996.
#ifndef lacunaIGESDocument_h
#define lacunaIGESDocument_h

#include "lacunaVector.h"

#include <cstdint>
#include <string>
#include <vector>

namespace lacuna
{
class BSplineSurface;
struct BSplineCurve;

/// Free-format data packed into lines: numbers are never split, strings only where a line cannot
/// hold them. Does not depend on the locale.
class IGESRecord
{
public:
  /// Columns that data may fill: 64 of a parameter line, 72 of a global line.
  explicit IGESRecord(std::size_t columns = 64)
    : Columns(columns)
  {
  }
  void AddInteger(std::int64_t value);
  /// The shortest decimal that reads back as the same double, always with a point. Throws
  /// std::invalid_argument when it is not finite.
  void AddReal(double value);
  /// A Hollerith string; characters outside of printable ASCII become '_'.
  void AddString(const std::string& value);
  /// Ends the record: with ';' instead of ','.
  void Close();
  const std::vector<std::string>& GetLines() const { return this->Lines; }

private:
  void Add(const std::string& token, bool splittable);

  std::size_t Columns;
  std::vector<std::string> Lines{ std::string() };
};

/// What the global section says besides what follows from the contents. Nothing about a patient
/// belongs here.
struct IGESHeader
{
  std::vector<std::string> Start;      ///< text for people; long lines are wrapped
  std::string Product = "Lacuna";      ///< product identification of the sender
  std::string FileName = "lacuna.igs"; ///< without folder
  std::string System = "Lacuna";       ///< native system
  std::string Preprocessor = "Lacuna"; ///< writer and version
  std::string Date;                    ///< YYYYMMDD.HHNNSS
  double MinimumResolution = 1e-6;     ///< mm, > 0
};

/// Collects entities and makes the text of a file in mm.
class IGESDocument
{
public:
  /// Fields of the directory entry that are not always zero.
  struct Attributes
  {
    int Form = 0;
    int Level = 0;
    int Colour = 0;      ///< 0, a number 1..8, or minus the pointer of a 314
    int Subordinate = 0; ///< 1: a part of another entity, which is not shown for itself
    int UseFlag = 0;
    std::string Label; ///< up to 8 characters
  };

  /// Adds an entity whose parameters (after the type number) are not closed yet; returns its
  /// pointer, the odd number of its directory entry. properties: pointers of 406 entities.
  std::int64_t AddEntity(int type, IGESRecord parameters, const Attributes& attributes,
    const std::vector<std::int64_t>& properties = {});
  /// A record that starts with the type number, as AddEntity wants it.
  static IGESRecord StartEntity(int type);

  /// A name (406 form 15) for use as property.
  std::int64_t AddName(const std::string& name);
  /// A colour (314), parts 0 to 1, for use as Attributes::Colour = -pointer.
  std::int64_t AddColour(double red, double green, double blue, const std::string& name);
  /// A bicubic polynomial B-spline surface (128). Throws std::invalid_argument when a coordinate is
  /// not finite.
  std::int64_t AddSurface(const BSplineSurface& surface, const Attributes& attributes,
    const std::vector<std::int64_t>& properties = {});

  /// A cubic polynomial B-spline curve in space (126). Throws std::invalid_argument when a coordinate is
  /// not finite.
  std::int64_t AddCurve(const BSplineCurve& curve, const Attributes& attributes,
    const std::vector<std::int64_t>& properties = {});
  /// A point (116).
  std::int64_t AddPoint(const Vec3& point, const Attributes& attributes,
    const std::vector<std::int64_t>& properties = {});
  /// A polygon through at least two points (102, its sides as 110). Not 106 or 126 of degree 1, of
  /// whose corners readers complain.
  std::int64_t AddPolygon(const std::vector<Vec3>& points, const Attributes& attributes,
    const std::vector<std::int64_t>& properties = {});
  /// A straight line (110).
  std::int64_t AddLine(const Vec3& from, const Vec3& to, const Attributes& attributes,
    const std::vector<std::int64_t>& properties = {});

  /// A closed curve on a surface: in its parameters (u, v, 0) and in space, over the same interval.
  struct Boundary
  {
    const BSplineCurve* Parameters;
    const BSplineCurve* Space;
  };
  /// A part of a surface (144, its boundaries as 142): surface is the pointer of a 128 that was
  /// added as subordinate, the first boundary the outer one, the others are holes.
  std::int64_t AddTrimmedSurface(std::int64_t surface, const std::vector<Boundary>& boundaries,
    const Attributes& attributes, const std::vector<std::int64_t>& properties = {});

  /// The whole file, lines of 80 columns ended by LF. Throws std::runtime_error when it would have
  /// more lines than the seven columns of a sequence number can count.
  std::string GetText(const IGESHeader& header) const;

private:
  struct Entity
  {
    int Type;
    Attributes Fields;
    std::vector<std::string> Lines; // of the parameter section
  };
  IGESRecord GetGlobal(const IGESHeader& header) const;
  void AddCoordinates(IGESRecord& record, const Vec3& point);
  std::int64_t AddCurve(const BSplineCurve& curve, bool inParameters, const Attributes& attributes,
    const std::vector<std::int64_t>& properties);

  std::vector<Entity> Entities;
  double MaximumCoordinate = 0;
};
}
#endif
