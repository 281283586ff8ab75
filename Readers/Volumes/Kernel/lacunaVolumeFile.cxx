// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaVolumeFile.h"

#include "lacunaParameterText.h"
#include "lacunaSequenceText.h"

#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

namespace lacuna
{
namespace
{
using Vectors = std::vector<std::vector<double>>; // empty: an axis without a direction

// mm of a unit; 0 for an unknown one
double GetMillimetres(const std::string& unit)
{
  static const std::map<std::string, double> units = { { "mm", 1 }, { "millimeter", 1 },
    { "millimeters", 1 }, { "millimetre", 1 }, { "millimetres", 1 }, { "um", 1e-3 },
    { "\xC2\xB5m", 1e-3 }, { "\xCE\xBCm", 1e-3 }, { "\xB5m", 1e-3 }, { "micrometer", 1e-3 },
    { "micrometers", 1e-3 }, { "micron", 1e-3 }, { "microns", 1e-3 }, { "cm", 10 },
    { "centimeter", 10 }, { "centimeters", 10 }, { "m", 1000 }, { "meter", 1000 },
    { "meters", 1000 } };
  const auto found = units.find(ToLower(unit));
  return found == units.end() ? 0 : found->second;
}

constexpr const char* UnknownPlace =
  "the file does not say where its first voxel lies; 0 0 0 is taken";

//------------------------------------------------------------------------------
class GeometryReader
{
public:
  explicit GeometryReader(const std::string& fileName)
    : FileName(fileName)
    , Header(ReadVolumeHeader(fileName))
  {
  }

  VolumeFile Read()
  {
    this->Header.IsNrrd ? this->ReadNrrd() : this->ReadMetaImage();
    this->Volume.Slices = std::move(this->Header.Slices);
    return std::move(this->Volume);
  }

private:
  [[noreturn]] void Fail(const std::string& text) const
  {
    throw std::runtime_error(this->FileName + ": " + text);
  }
  const std::string* Find(const std::string& name) const
  {
    const auto found = this->Header.Fields.find(name);
    return found == this->Header.Fields.end() || Trim(found->second).empty() ? nullptr
                                                                             : &found->second;
  }
  void SetAxes(const std::array<Vec3, 3>& axes, const Vec3& origin)
  {
    this->Volume.IndexToPatient = Matrix4::FromColumns(axes[0], axes[1], axes[2], origin);
  }
  std::vector<double> ParseNumbers(
    const std::string& name, const std::string& text, std::size_t count, bool finite = true) const;
  const std::string* FindOne(const std::vector<std::string>& names) const;

  void ReadMetaImage();
  double ReadDistanceUnits() const;
  std::array<Vec3, 3> ReadTransformMatrix();
  void CompareAnatomicalOrientation(const std::array<Vec3, 3>& axes);

  void ReadNrrd();
  Vec3 ReadSpace();
  Vectors ParseVectors(const std::string& name, const std::string& text) const;
  std::vector<std::string> ParseUnits(const std::string& name, std::size_t count) const;
  void ReadOldRange();
  void PlaceBySpacings();
  void PlaceByDirections(const Vec3& toPatient);

  std::string FileName;
  VolumeHeader Header;
  VolumeFile Volume;
};

//------------------------------------------------------------------------------
std::vector<double> GeometryReader::ParseNumbers(
  const std::string& name, const std::string& text, std::size_t count, bool finite) const
{
  std::vector<double> numbers;
  for (const std::string_view word : SplitWords(text))
  {
    numbers.push_back(0);
    if (!ParseNumber(word, numbers.back()) || (finite && !std::isfinite(numbers.back())))
    {
      this->Fail(name + " is '" + text + "'; '" + std::string(word) + "' is no finite number");
    }
  }
  if (numbers.size() != count)
  {
    this->Fail(name + " is '" + text + "': " + std::to_string(numbers.size()) +
      " numbers, where the axes of the image call for " + std::to_string(count));
  }
  return numbers;
}

//------------------------------------------------------------------------------
// Names that mean the same: the one that is there, or the first of those that agree.
const std::string* GeometryReader::FindOne(const std::vector<std::string>& names) const
{
  const std::string* found = nullptr;
  std::string foundName;
  for (const std::string& name : names)
  {
    const std::string* value = this->Find(name);
    if (found && value && SplitWords(*found) != SplitWords(*value))
    {
      this->Fail(foundName + " is '" + *found + "', but " + name + ", which means the same, is '" +
        *value + "'; remove the wrong one");
    }
    if (value && !found)
    {
      found = value;
      foundName = name;
    }
  }
  return found;
}

//------------------------------------------------------------------------------
// ITK and 3D Slicer take what MetaImage gives for patient coordinates (LPS).
void GeometryReader::ReadMetaImage()
{
  const std::size_t count = this->Header.Axes;
  const bool spaced = this->Find("ElementSpacing") != nullptr;
  const char* spacingName = spaced ? "ElementSpacing" : "ElementSize";
  const std::string* spacingText = this->Find(spacingName);
  if (!spacingText)
  {
    this->Fail("ElementSpacing is missing, so the size of a voxel is unknown. Add a line "
               "'ElementSpacing = x y z' with the distances of voxels in mm");
  }
  const std::vector<double> spacing = this->ParseNumbers(spacingName, *spacingText, count);
  const double unit = this->ReadDistanceUnits();
  std::array<Vec3, 3> axes = this->ReadTransformMatrix();
  this->CompareAnatomicalOrientation(axes);
  for (int i = 0; i < 3; ++i)
  {
    const double step = spacing[static_cast<std::size_t>(i)];
    if (!(step > 0))
    {
      this->Fail(std::string(spacingName) + " is '" + *spacingText +
        "'; distances must be positive. The direction of an axis belongs into TransformMatrix");
    }
    axes[static_cast<std::size_t>(i)] = step * unit * axes[static_cast<std::size_t>(i)];
  }
  Vec3 origin{ { 0, 0, 0 } };
  const std::string* offset = this->FindOne({ "Offset", "Position", "Origin" });
  if (offset)
  {
    const std::vector<double> numbers = this->ParseNumbers("Offset", *offset, count);
    origin = unit * Vec3{ { numbers[0], numbers[1], numbers[2] } };
  }
  else
  {
    this->Volume.Warnings.emplace_back(UnknownPlace);
  }
  const std::string* centre = this->Find("CenterOfRotation");
  if (centre)
  {
    for (const double x : this->ParseNumbers("CenterOfRotation", *centre, count))
    {
      if (x != 0)
      {
        this->Volume.Warnings.push_back("CenterOfRotation is '" + *centre +
          "'; it does not count for where an image lies, as in ITK and 3D Slicer");
        break;
      }
    }
  }
  const std::string* slope = this->Find("ElementToIntensityFunctionSlope");
  const std::string* shift = this->Find("ElementToIntensityFunctionOffset");
  this->Volume.Slope =
    slope ? this->ParseNumbers("ElementToIntensityFunctionSlope", *slope, 1)[0] : 1;
  this->Volume.Intercept =
    shift ? this->ParseNumbers("ElementToIntensityFunctionOffset", *shift, 1)[0] : 0;
  if (this->Volume.Slope != 1 || this->Volume.Intercept != 0)
  {
    this->Volume.Warnings.push_back("the values are " + FormatNumber(this->Volume.Slope) +
      " x stored + " + FormatNumber(this->Volume.Intercept) +
      " (ElementToIntensityFunction); 3D Slicer shows the stored ones");
  }
  this->SetAxes(axes, origin);
}

//------------------------------------------------------------------------------
double GeometryReader::ReadDistanceUnits() const
{
  const std::string* units = this->Find("DistanceUnits");
  if (!units || *units == "?")
  {
    return 1;
  }
  const double mm = GetMillimetres(*units);
  if (mm == 0)
  {
    this->Fail("DistanceUnits is '" + *units + "'; known are um, mm, cm and m");
  }
  return mm;
}

//------------------------------------------------------------------------------
// The directions of the axes, one after the other.
std::array<Vec3, 3> GeometryReader::ReadTransformMatrix()
{
  std::array<Vec3, 3> axes{ { { { 1, 0, 0 } }, { { 0, 1, 0 } }, { { 0, 0, 1 } } } };
  const std::string* text = this->FindOne({ "TransformMatrix", "Rotation", "Orientation" });
  if (!text)
  {
    return axes;
  }
  const std::size_t n = this->Header.Axes;
  const std::vector<double> numbers = this->ParseNumbers("TransformMatrix", *text, n * n);
  const std::int64_t sizes[3] = { this->Header.Slices.Columns, this->Header.Slices.Rows,
    this->Header.Slices.Frames };
  for (std::size_t i = 0; i < n; ++i)
  {
    for (std::size_t k = 3; k < n; ++k) // axes of one step must be of no effect
    {
      if (i < 3 && (numbers[n * i + k] != 0 || numbers[n * k + i] != 0))
      {
        this->Fail("TransformMatrix '" + *text + "' turns into more than three axes");
      }
    }
    if (i < 3)
    {
      axes[i] = { { numbers[n * i], numbers[n * i + 1], numbers[n * i + 2] } };
      const double length = std::hypot(axes[i][0], axes[i][1], axes[i][2]);
      // rounded numbers may be off by some millionths, over all voxels by little
      if (!(std::abs(length - 1) * static_cast<double>(sizes[i]) < 0.05))
      {
        this->Fail("TransformMatrix is '" + *text + "'; the length of axis " + std::to_string(i) +
          " is " + FormatNumber(length) +
          ", not 1. Distances of voxels belong into ElementSpacing");
      }
      axes[i] = (1 / length) * axes[i];
    }
  }
  return axes;
}

//------------------------------------------------------------------------------
// Letters of where the axes come from: RAI from right, anterior and inferior, which are x, y and z of LPS.
void GeometryReader::CompareAnatomicalOrientation(const std::array<Vec3, 3>& axes)
{
  const std::string* letters = this->Find("AnatomicalOrientation");
  if (!letters || letters->find_first_not_of('?') == std::string::npos)
  {
    return;
  }
  const std::map<char, Vec3> ways = { { 'R', { { 1, 0, 0 } } }, { 'L', { { -1, 0, 0 } } },
    { 'A', { { 0, 1, 0 } } }, { 'P', { { 0, -1, 0 } } }, { 'I', { { 0, 0, 1 } } },
    { 'S', { { 0, 0, -1 } } } };
  bool same = letters->size() == 3;
  bool straight = true;
  for (int i = 0; i < 3; ++i)
  {
    const Vec3& axis = axes[static_cast<std::size_t>(i)];
    straight = straight && axis[i] == 1;
    const auto way = same ? ways.find((*letters)[static_cast<std::size_t>(i)]) : ways.end();
    same = same && way != ways.end() && Dot(axis, way->second) > 0;
  }
  if (same)
  {
    return;
  }
  if (straight)
  {
    this->Fail("AnatomicalOrientation is '" + *letters +
      "', but TransformMatrix is missing or 1 0 0 0 1 0 0 0 1, which is RAI. It is not known which "
      "is right: write the directions of the axes into TransformMatrix (LPS, one axis after the "
      "other), or AnatomicalOrientation = ??? if the matrix is right");
  }
  this->Volume.Warnings.push_back("AnatomicalOrientation is '" + *letters +
    "' but TransformMatrix says otherwise; the matrix is taken, as in ITK and 3D Slicer. Check "
    "left "
    "and right");
}

//------------------------------------------------------------------------------
void GeometryReader::ReadNrrd()
{
  if (this->Find("space directions"))
  {
    this->PlaceByDirections(this->ReadSpace());
  }
  else
  {
    this->PlaceBySpacings();
  }
  this->ReadOldRange();
}

//------------------------------------------------------------------------------
// What the least and the greatest number of the type were before values became integers. dcm2niix tells
// Hounsfield units by it. (Teem's own quantization means the middle of a step, half a step more.)
void GeometryReader::ReadOldRange()
{
  const std::string* low = this->FindOne({ "old min", "oldmin" });
  const std::string* high = this->FindOne({ "old max", "oldmax" });
  if (!low || !high)
  {
    return;
  }
  const double from = this->ParseNumbers("old min", *low, 1, false)[0];
  const double to = this->ParseNumbers("old max", *high, 1, false)[0];
  const auto [least, greatest] = DispatchScalarType(this->Header.Slices.Type,
    [](auto zero)
    {
      using Limits = std::numeric_limits<decltype(zero)>;
      return Limits::is_integer
        ? std::pair(static_cast<double>(Limits::lowest()), static_cast<double>(Limits::max()))
        : std::pair(0.0, 0.0);
    });
  if (!std::isfinite(from) || !std::isfinite(to) || least == greatest)
  {
    return; // nothing was quantized
  }
  const double slope = (to - from) / (greatest - least);
  const double intercept = from - slope * least;
  if (slope == 1 && intercept == 0)
  {
    return;
  }
  this->Volume.Slope = slope;
  this->Volume.Intercept = intercept;
  this->Volume.Warnings.push_back("the values are " + FormatNumber(slope) + " x stored + " +
    FormatNumber(intercept) + " by old min and old max; 3D Slicer shows the stored ones");
}

//------------------------------------------------------------------------------
// 1 or -1 for each axis of the space.
Vec3 GeometryReader::ReadSpace()
{
  const std::string* space = this->Find("space");
  const std::string* dimension = this->Find("space dimension");
  if (!space)
  {
    if (dimension && *dimension != "3")
    {
      this->Fail("space dimension is " + *dimension + "; volumes are read in 3 dimensions");
    }
    this->Volume.Warnings.emplace_back(
      "the file names no space: whether its axes are the patient's is unknown. Its coordinates are "
      "taken as they are");
    return { { 1, 1, 1 } };
  }
  const std::string name = ToLower(*space);
  this->Volume.IsPatient = true;
  if (name == "left-posterior-superior" || name == "lps")
  {
    return { { 1, 1, 1 } };
  }
  if (name == "right-anterior-superior" || name == "ras")
  {
    return { { -1, -1, 1 } };
  }
  if (name == "left-anterior-superior" || name == "las")
  {
    return { { 1, -1, 1 } };
  }
  if (name == "3d-right-handed")
  {
    this->Volume.IsPatient = false;
    this->Volume.Warnings.emplace_back(
      "the space is 3D-right-handed: whether its axes are the "
      "patient's is unknown. Its coordinates are taken as they are");
    return { { 1, 1, 1 } };
  }
  this->Fail("space is '" + *space +
    "', which does not say where the voxels lie in the patient; known are left-posterior-superior, "
    "right-anterior-superior, left-anterior-superior and 3D-right-handed");
}

//------------------------------------------------------------------------------
// "(1,0,0) none (0,1,0)"
Vectors GeometryReader::ParseVectors(const std::string& name, const std::string& text) const
{
  Vectors vectors;
  std::size_t at = text.find_first_not_of(" \t");
  while (at != std::string::npos)
  {
    const std::size_t close = text.find(')', at);
    if (EqualsIgnoringCase(text.substr(at, 4), "none"))
    {
      vectors.emplace_back();
      at += 4;
    }
    else if (text[at] == '(' && close != std::string::npos)
    {
      std::string inside = text.substr(at + 1, close - at - 1);
      for (char& c : inside)
      {
        c = c == ',' ? ' ' : c;
      }
      vectors.push_back(this->ParseNumbers(name, inside, 3));
      at = close + 1;
    }
    else
    {
      this->Fail(name + " is '" + text + "'; it must be vectors of three numbers, as (0,0,1)");
    }
    at = text.find_first_not_of(" \t", at);
  }
  return vectors;
}

//------------------------------------------------------------------------------
// What is in quotes; empty for a field that is not there. "mm" "mm" "mm"
std::vector<std::string> GeometryReader::ParseUnits(
  const std::string& name, std::size_t count) const
{
  std::vector<std::string> units;
  const std::string* text = this->Find(name);
  if (!text)
  {
    return units;
  }
  for (std::size_t open = text->find('"'); open != std::string::npos;)
  {
    const std::size_t close = text->find('"', open + 1);
    if (close == std::string::npos)
    {
      break;
    }
    units.push_back(text->substr(open + 1, close - open - 1));
    open = text->find('"', close + 1);
  }
  if (units.size() != count)
  {
    this->Fail(name + " is '" + *text + "'; it must be " + std::to_string(count) +
      " units in double quotes, as \"mm\"");
  }
  return units;
}

//------------------------------------------------------------------------------
void GeometryReader::PlaceByDirections(const Vec3& toPatient)
{
  const std::string& text = *this->Find("space directions");
  const Vectors directions = this->ParseVectors("space directions", text);
  const std::size_t first = this->Header.FirstAxis;
  bool right = directions.size() == this->Header.Axes;
  for (std::size_t i = 0; right && i < directions.size(); ++i)
  {
    // beyond the volume's axes there are none with steps
    right = i >= first + 3 || directions[i].empty() == (i < first);
  }
  if (!right)
  {
    this->Fail("space directions is '" + text + "'; it must have a vector for each of the " +
      std::to_string(this->Header.Axes) + " axes, or none for one of components");
  }
  if (const std::string* spacings = this->Find("spacings"))
  {
    for (const double x : this->ParseNumbers("spacings", *spacings, this->Header.Axes, false))
    {
      if (std::isfinite(x))
      {
        this->Fail("spacings is '" + *spacings + "' beside space directions '" + text +
          "', which have the distances of voxels, too; remove the wrong one");
      }
    }
  }
  Vec3 scale = toPatient;
  const std::vector<std::string> units = this->ParseUnits("space units", 3);
  for (std::size_t i = 0; i < units.size(); ++i)
  {
    const double mm = units[i].empty() ? 1 : GetMillimetres(units[i]);
    if (mm == 0)
    {
      this->Fail("space units is '" + *this->Find("space units") + "'; known are um, mm, cm and m");
    }
    scale[static_cast<int>(i)] *= mm;
  }
  for (const std::string& unit : this->ParseUnits("units", this->Header.Axes))
  {
    if (!unit.empty() && GetMillimetres(unit) != 1)
    {
      this->Fail("units is '" + *this->Find("units") +
        "' beside space directions, whose unit is in space units; remove the wrong one");
    }
  }
  const auto scaled = [&](const std::vector<double>& v) {
    return Vec3{ { scale[0] * v[0], scale[1] * v[1], scale[2] * v[2] } };
  };
  Vec3 origin{ { 0, 0, 0 } };
  if (const std::string* place = this->Find("space origin"))
  {
    const Vectors vectors = this->ParseVectors("space origin", *place);
    if (vectors.size() != 1 || vectors[0].empty())
    {
      this->Fail("space origin is '" + *place + "'; it must be one vector, as (0,0,0)");
    }
    origin = scaled(vectors[0]);
  }
  else
  {
    this->Volume.Warnings.emplace_back(UnknownPlace);
  }
  this->SetAxes(
    { scaled(directions[first]), scaled(directions[first + 1]), scaled(directions[first + 2]) },
    origin);
}

//------------------------------------------------------------------------------
// A file that says nothing of a space.
void GeometryReader::PlaceBySpacings()
{
  const std::size_t first = this->Header.FirstAxis;
  const std::string* spacings = this->Find("spacings");
  if (!spacings)
  {
    this->Fail("space directions and spacings are missing, so the size of a voxel is unknown. Add "
               "a line 'space directions: (x,0,0) (0,y,0) (0,0,z)' with distances of voxels in mm");
  }
  for (const char* name :
    { "space", "space origin", "axis mins", "axismins", "axis maxs", "axismaxs" })
  {
    const std::string* value = this->Find(name);
    if (value && ToLower(*value).find_first_not_of(" nan") != std::string::npos)
    {
      this->Fail(std::string(name) + " is '" + *value +
        "', but there are no space directions: where the voxels lie is not certain. Write space, "
        "space directions and space origin");
    }
  }
  const std::vector<double> steps =
    this->ParseNumbers("spacings", *spacings, this->Header.Axes, false);
  const std::vector<std::string> units = this->ParseUnits("units", this->Header.Axes);
  std::array<Vec3, 3> axes{};
  for (std::size_t i = 0; i < 3; ++i)
  {
    const std::string unit = units.empty() ? std::string() : units[first + i];
    const double mm = unit.empty() ? 1 : GetMillimetres(unit);
    if (mm == 0)
    {
      this->Fail("units is '" + *this->Find("units") + "'; known are um, mm, cm and m");
    }
    const double step = mm * steps[first + i];
    if (!(step > 0 && std::isfinite(step)))
    {
      this->Fail("spacings is '" + *spacings +
        "'; distances must be positive. The direction of an axis belongs into space directions");
    }
    axes[i][static_cast<int>(i)] = step;
  }
  this->Volume.Warnings.emplace_back("the file does not say where the volume lies: its axes are "
                                     "taken as x, y and z, its first voxel "
                                     "as 0 0 0");
  this->SetAxes(axes, { { 0, 0, 0 } });
}
}

//------------------------------------------------------------------------------
VolumeFile ReadVolumeFile(const std::string& fileName)
{
  return GeometryReader(fileName).Read();
}
}
