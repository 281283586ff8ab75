// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaCADContent.h"

#include "lacunaCoordinates.h"
#include "lacunaDepthMap.h"
#include "lacunaExecution.h"
#include "lacunaFieldData.h"
#include "lacunaPressPosition.h"
#include "vtkCellArray.h"
#include "vtkCellArrayIterator.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataArray.h"
#include "vtkDataSet.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkMultiBlockDataSet.h"
#include "vtkPartitionedDataSet.h"
#include "vtkPartitionedDataSetCollection.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"
#include "vtkStructuredGrid.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <locale>
#include <sstream>
#include <stdexcept>

namespace
{
constexpr double AxisLength = 10;       // mm of a screw's axis that are drawn
constexpr double HoleTolerance = 0.002; // mm; single precision may have come between

// Whether the surface has a round hole about an axis: the points next to the axis lie around it, all as
// far from it. Those of a plate that has been moved since its holes were recorded do not.
bool HasHole(vtkPolyData* data, const lacuna::Vec3& center, const lacuna::Vec3& axis)
{
  std::vector<lacuna::Vec3> beside; // from the axis to points near the hole
  double least = AxisLength;
  for (vtkIdType k = 0; k < data->GetNumberOfPoints(); ++k)
  {
    lacuna::Vec3 p;
    data->GetPoint(k, p.data());
    p = p - center;
    if (lacuna::Norm(p) <= AxisLength)
    {
      beside.push_back(p - lacuna::Dot(p, axis) * axis);
      least = std::min(least, lacuna::Norm(beside.back()));
    }
  }
  lacuna::Vec3 sum{ 0, 0, 0 };
  int count = 0;
  for (const lacuna::Vec3& p : beside)
  {
    if (lacuna::Norm(p) <= least + HoleTolerance)
    {
      sum = sum + p;
      ++count;
    }
  }
  return count >= 6 && lacuna::Norm(sum) <= 0.2 * count * least;
}

//------------------------------------------------------------------------------
using Path = std::vector<vtkIdType>;

// The poly lines, and lines of single segments (as contours have them) chained from end to end.
std::vector<Path> FindPaths(vtkPolyData* data)
{
  std::vector<Path> paths;
  std::vector<std::vector<std::size_t>> at(data->GetNumberOfPoints()); // segments that end there
  std::vector<Path> segments;
  auto cells = vtk::TakeSmartPointer(data->GetLines()->NewIterator());
  for (cells->GoToFirstCell(); !cells->IsDoneWithTraversal(); cells->GoToNextCell())
  {
    vtkIdType size;
    const vtkIdType* ids;
    cells->GetCurrentCell(size, ids);
    if (size == 2 && ids[0] != ids[1])
    {
      at[ids[0]].push_back(segments.size());
      at[ids[1]].push_back(segments.size());
      segments.emplace_back(ids, ids + 2);
    }
    else
    {
      paths.emplace_back(ids, ids + size);
    }
  }
  std::vector<bool> used(segments.size(), false);
  const auto follow = [&](std::size_t segment, vtkIdType from)
  {
    Path path{ from };
    for (;;)
    {
      used[segment] = true;
      const Path& ends = segments[segment];
      path.push_back(ends[0] == path.back() ? ends[1] : ends[0]);
      const std::vector<std::size_t>& here = at[path.back()];
      if (here.size() != 2 || used[here[0] == segment ? here[1] : here[0]])
      {
        return path;
      }
      segment = here[0] == segment ? here[1] : here[0];
    }
  };
  for (const bool ends : { true, false }) // first from ends and forks, then what is closed
  {
    for (std::size_t k = 0; k < segments.size(); ++k)
    {
      for (const vtkIdType id : segments[k])
      {
        if (!used[k] && (!ends || at[id].size() != 2))
        {
          paths.push_back(follow(k, id));
        }
      }
    }
  }
  return paths;
}
}

//------------------------------------------------------------------------------
void lacuna::CADContent::Options::Describe(lacuna::Properties& properties) const
{
  this->Fit.Describe(properties);
  properties.Add("DefectOutline", this->Outline, OutlineNames)
    .Add("Coordinates", this->Frame, FrameNames)
    .Add("AllowMirrored", this->AllowMirrored)
    .Add("SkipUnsupported", this->SkipUnsupported);
}

//------------------------------------------------------------------------------
lacuna::CADContent::CADContent(
  vtkDataObject* input, const Options& options, lacuna::Execution& execution)
  : Settings(options)
{
  Properties properties;
  options.Describe(properties);
  properties.Check();
  this->Collect(input, "", false);
  this->PlaceItems();
  const lacuna::Execution::NestedStages nested(execution);
  const double count = static_cast<double>(this->Items.size());
  for (std::size_t k = 0; k < this->Items.size(); ++k)
  {
    const Item& item = this->Items[k];
    execution.SetStage(static_cast<double>(k) / count, static_cast<double>(k + 1) / count);
    execution.Report(0);
    try
    {
      this->AddItem(item, execution);
      this->Inputs.push_back(item.Data);
    }
    catch (const lacuna::Aborted&)
    {
      throw;
    }
    catch (const std::bad_alloc&)
    {
      throw;
    }
    catch (const std::exception& e)
    {
      throw std::runtime_error(
        (item.Name.empty() ? std::string() : "block '" + item.Name + "': ") + e.what());
    }
  }
  if (this->Surfaces.empty() && this->CountThings() == 0)
  {
    throw std::runtime_error("there is nothing to write: the input has no surface, line or vertex");
  }
}

//------------------------------------------------------------------------------
// Other than surfaces.
std::size_t lacuna::CADContent::CountThings() const
{
  return this->Curves.size() + this->Polygons.size() + this->Lines.size() + this->Points.size();
}

//------------------------------------------------------------------------------
void lacuna::CADContent::Unsupported(const std::string& what)
{
  if (!this->Settings.SkipUnsupported)
  {
    throw std::runtime_error(what);
  }
  this->Warnings.push_back("left out: " + what);
}

//------------------------------------------------------------------------------
void lacuna::CADContent::AddItem(const Item& item, lacuna::Execution& execution)
{
  if (vtkImageData::SafeDownCast(item.Data))
  {
    this->AddMap(item, execution);
  }
  else if (auto* grid = vtkStructuredGrid::SafeDownCast(item.Data))
  {
    this->Surfaces.push_back(
      lacuna::CADSurface::FromGrid(grid, item.ToFile, this->Settings.Fit, execution));
    if (!item.Name.empty())
    {
      this->Surfaces.back().Name = item.Name;
    }
  }
  else if (vtkPolyData::SafeDownCast(item.Data))
  {
    this->AddPolyData(item);
  }
  else
  {
    this->Unsupported((item.Name.empty() ? "the input" : "'" + item.Name + "'") + " is a " +
      item.Data->GetClassName() +
      "; an IGES file can have depth maps, structured grids of one layer, poly lines and vertices");
  }
}

//------------------------------------------------------------------------------
void lacuna::CADContent::AddMap(const Item& item, lacuna::Execution& execution)
{
  auto* map = vtkImageData::SafeDownCast(item.Data);
  lacuna::CADSurface surface =
    lacuna::CADSurface::FromMap(map, item.ToFile, this->Settings.Fit, execution);
  surface.Name = item.Name.empty() ? surface.Name : item.Name;
  const bool trim = this->Settings.Outline == TrimToOutline;
  const bool known = map->GetPointData()->GetArray(lacuna::DepthMap::FilledMaskName) != nullptr;
  if (trim || (known && this->Settings.Outline == OutlineCurve))
  {
    try
    {
      surface.FindOutlines(map, this->Settings.Fit);
    }
    catch (const std::runtime_error& e)
    {
      if (trim)
      {
        throw;
      }
      this->Warnings.push_back(std::string("no outline of the defect is written: ") + e.what());
    }
    if (trim && surface.Pieces.empty())
    {
      throw std::runtime_error("DefectOutline is Trim, but FilledMask marks no defect");
    }
  }
  if (!trim)
  {
    for (const auto& piece : surface.Pieces)
    {
      for (const lacuna::CADSurface::Boundary& boundary : piece)
      {
        this->Curves.push_back({ boundary.Space,
          item.Name.empty() ? "Defect outline" : "Defect outline of " + item.Name });
      }
    }
    surface.Pieces.clear();
  }
  this->Surfaces.push_back(std::move(surface));
}

//------------------------------------------------------------------------------
void lacuna::CADContent::AddPolyData(const Item& item)
{
  auto* data = vtkPolyData::SafeDownCast(item.Data);
  std::vector<lacuna::Vec3> points(data->GetNumberOfPoints());
  // as fine as the points of a surface are written
  const double tolerance = this->Settings.Fit.Tolerance;
  const double steps =
    tolerance > 0 ? std::pow(10, std::ceil(1 - std::log10(tolerance) - 1e-9)) : 0;
  const bool round = steps >= 1 && steps <= 1e12;
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    data->GetPoint(static_cast<vtkIdType>(i), points[i].data());
    points[i] = item.ToFile.Point(points[i]);
    if (!lacuna::IsFinite(points[i]))
    {
      throw std::runtime_error("point " + std::to_string(i) + " is not finite");
    }
    for (double& x : points[i].Elements)
    {
      x = round ? std::round(x * steps) / steps + 0.0 : x;
    }
  }
  const std::size_t before = this->CountThings();
  for (const Path& path : FindPaths(data))
  {
    std::vector<lacuna::Vec3> corners;
    for (const vtkIdType id : path)
    {
      if (corners.empty() || !(points[id] == corners.back()))
      {
        corners.push_back(points[id]);
      }
    }
    if (corners.size() == 2)
    {
      this->Lines.push_back({ corners[0], corners[1], item.Name.empty() ? "Line" : item.Name });
    }
    else if (corners.size() > 2)
    {
      this->Polygons.push_back({ std::move(corners), item.Name.empty() ? "Poly line" : item.Name });
    }
  }
  auto cells = vtk::TakeSmartPointer(data->GetVerts()->NewIterator());
  for (cells->GoToFirstCell(); !cells->IsDoneWithTraversal(); cells->GoToNextCell())
  {
    vtkIdType size;
    const vtkIdType* ids;
    cells->GetCurrentCell(size, ids);
    for (vtkIdType k = 0; k < size; ++k)
    {
      this->Points.push_back({ points[ids[k]], item.Name.empty() ? "Point" : item.Name });
    }
  }
  this->AddScrews(item);
  const vtkIdType facets = data->GetNumberOfPolys() + data->GetNumberOfStrips();
  if (facets > 0)
  {
    this->Unsupported((item.Name.empty() ? "the input" : "'" + item.Name + "'") + " has " +
      std::to_string(facets) +
      " polygons or strips, and an IGES file has smooth surfaces: write them as STL, PLY or OBJ, "
      "or write the depth map they come from. SkipUnsupported writes what else there is");
  }
  else if (before == this->CountThings())
  {
    this->Unsupported((item.Name.empty() ? "the input" : "'" + item.Name + "'") +
      " has no line of any length and no vertex; bare points are written when they have "
      "vertices (Mask Points with Generate Vertices)");
  }
}

//------------------------------------------------------------------------------
// The screw holes of an implant plate.
void lacuna::CADContent::AddScrews(const Item& item)
{
  vtkDataArray* centers = lacuna::FieldData::Find(item.Data, "HoleCenters", 3, -1);
  if (!centers || centers->GetNumberOfTuples() == 0)
  {
    return;
  }
  const vtkIdType count = centers->GetNumberOfTuples();
  vtkDataArray* axes = lacuna::FieldData::Get(item.Data, "HoleAxes", 3, count);
  for (vtkIdType k = 0; k < count; ++k)
  {
    lacuna::Vec3 center;
    lacuna::Vec3 axis;
    centers->GetTuple(k, center.data());
    axes->GetTuple(k, axis.data());
    if (!lacuna::IsFinite(center) || !(std::abs(lacuna::Norm(axis) - 1) < 1e-6))
    {
      throw std::runtime_error("screw hole " + std::to_string(k + 1) +
        " has no finite centre (HoleCenters) or no unit axis (HoleAxes)");
    }
    const std::string number = std::to_string(k + 1);
    if (auto* plate = vtkPolyData::SafeDownCast(item.Data);
        plate->GetNumberOfPolys() > 0 && !HasHole(plate, center, axis))
    {
      throw std::runtime_error("screw hole " + number +
        " is not where HoleCenters and HoleAxes say: the plate has been changed since it was made "
        "(by Transform?). Use it as it was made");
    }
    center = item.ToFile.Point(center);
    this->Points.push_back({ center, "Screw hole " + number });
    this->Lines.push_back(
      { center, center + AxisLength * item.ToFile.Vector(axis), "Screw axis " + number, true });
  }
}

//------------------------------------------------------------------------------
// Which data of the input there are, and in whose coordinates they and the file are.
namespace
{
std::string NameOf(vtkInformation* meta, const std::string& otherwise)
{
  const char* name =
    meta && meta->Has(vtkCompositeDataSet::NAME()) ? meta->Get(vtkCompositeDataSet::NAME()) : "";
  return name && *name ? name : otherwise;
}

// The matrix of data from the press; throws when it is no rotation and translation. The block of
// Defect Model has one, for its top, and lies in the patient.
std::optional<lacuna::Matrix4> FindPressToPatient(vtkDataObject* data)
{
  vtkDataArray* array =
    lacuna::FieldData::Find(data, lacuna::Coordinates::PressToPatientName, 16, 1);
  if (!array || lacuna::Coordinates::Get(data) == lacuna::Coordinates::Patient)
  {
    return std::nullopt;
  }
  const lacuna::Matrix4 matrix = lacuna::FieldData::GetMatrix(array, 0);
  double error = matrix.IsFinite() && matrix.IsAffine() ? 0 : 1;
  for (int i = 0; i < 3; ++i)
  {
    for (int j = 0; j < 3; ++j)
    {
      error = std::max(
        error, std::abs(lacuna::Dot(matrix.Column(i), matrix.Column(j)) - (i == j ? 1 : 0)));
    }
  }
  if (!(error <= 1e-6 && matrix.Determinant3() > 0))
  {
    throw std::runtime_error("field data array 'PressToPatient' is not a rotation and translation "
                             "(it scales, shears or mirrors), as Press Orientation gives it");
  }
  return matrix;
}

bool IsSame(const lacuna::Matrix4& a, const lacuna::Matrix4& b)
{
  return std::equal(a.Data(), a.Data() + 16, b.Data());
}
}

//------------------------------------------------------------------------------
void lacuna::CADContent::Collect(vtkDataObject* data, const std::string& name, bool nested)
{
  const auto inner = [&](unsigned int i)
  { return (name.empty() ? "" : name + "/") + "Block " + std::to_string(i); };
  if (auto* blocks = vtkMultiBlockDataSet::SafeDownCast(data))
  {
    for (unsigned int i = 0; i < blocks->GetNumberOfBlocks(); ++i)
    {
      vtkInformation* meta = blocks->HasMetaData(i) ? blocks->GetMetaData(i) : nullptr;
      this->Collect(blocks->GetBlock(i), NameOf(meta, inner(i)), true);
    }
  }
  else if (auto* sets = vtkPartitionedDataSetCollection::SafeDownCast(data))
  {
    for (unsigned int i = 0; i < sets->GetNumberOfPartitionedDataSets(); ++i)
    {
      vtkInformation* meta = sets->HasMetaData(i) ? sets->GetMetaData(i) : nullptr;
      this->Collect(sets->GetPartitionedDataSet(i), NameOf(meta, inner(i)), true);
    }
  }
  else if (auto* parts = vtkPartitionedDataSet::SafeDownCast(data))
  {
    bool empty = parts->GetNumberOfPartitions() > 0;
    for (unsigned int i = 0; i < parts->GetNumberOfPartitions(); ++i)
    {
      vtkDataSet* part = parts->GetPartition(i);
      if (!part || part->GetNumberOfPoints() > 0) // some pieces of a whole may be empty
      {
        this->Collect(part, name.empty() ? inner(i) : name, true);
        empty = false;
      }
    }
    if (empty)
    {
      this->Warnings.push_back("left out: block '" + name + "' is empty");
    }
  }
  else if (data && nested && data->GetNumberOfElements(vtkDataObject::POINT) == 0)
  {
    this->Warnings.push_back("left out: block '" + name + "' is empty");
  }
  else if (data)
  {
    Item item{ data, name, FindPressToPatient(data), {} };
    item.Lost = this->FindLost(
      data, name.empty() ? "" : "block '" + name + "': ", item.PressToPatient.has_value());
    this->Items.push_back(std::move(item));
    if (lacuna::Coordinates::IsMirrored(data))
    {
      const std::string what = (name.empty() ? "the input" : "block '" + name + "'") +
        " is a mirror image of the patient (field data Mirrored)";
      if (!this->Settings.AllowMirrored)
      {
        throw std::runtime_error(what +
          ": nothing made from it fits the side it was taken from. "
          "Turn on AllowMirrored if the mirrored side is what you want");
      }
      this->Warnings.push_back(what + "; the file says so, too");
      this->Description.push_back("MIRROR IMAGE, left is right: " + what + ".");
    }
  }
}

//------------------------------------------------------------------------------
// Why nothing leads from data in a press to the patient; empty when it is known or data lie in none.
std::string lacuna::CADContent::FindLost(
  vtkDataObject* data, const std::string& prefix, bool hasMatrix)
{
  std::string moved;
  try
  {
    moved = lacuna::PressPosition::Check(data);
  }
  catch (const std::runtime_error& e)
  {
    throw std::runtime_error(prefix + e.what());
  }
  const bool asGiven = this->Settings.Frame == AsGiven;
  if (!moved.empty())
  {
    if (!asGiven) // PressToPatient would be used
    {
      throw std::runtime_error(prefix + moved + ", or write it where it is (Coordinates AsGiven)");
    }
    this->Warnings.push_back(prefix + moved);
    return "it was MOVED since it was made for the press";
  }
  if (hasMatrix || lacuna::Coordinates::Get(data) != lacuna::Coordinates::Press)
  {
    return {};
  }
  const bool before = lacuna::FieldData::Find(data, lacuna::PressPosition::MovedName, 1, 1);
  std::string why = before ? "what it is made of was MOVED since it was made for the press"
                           : "it has no PressToPatient";
  if (!asGiven)
  {
    throw std::runtime_error(prefix +
      "these are the coordinates of a press (field data "
      "Coordinates), and nothing says where the patient is: " +
      why + ". Write it where it is (Coordinates AsGiven)");
  }
  return why;
}

//------------------------------------------------------------------------------
// Decides on the frame of the file and how each item gets there.
void lacuna::CADContent::PlaceItems()
{
  const Item* press = nullptr;
  const Item* patient = nullptr;
  const Item* lost = nullptr;
  for (const Item& item : this->Items)
  {
    if (!item.Lost.empty())
    {
      lost = &item;
      continue;
    }
    if (!item.PressToPatient)
    {
      patient = &item;
      continue;
    }
    if (press && this->Settings.Frame != Patient &&
      !IsSame(*press->PressToPatient, *item.PressToPatient))
    {
      throw std::runtime_error("blocks '" + press->Name + "' and '" + item.Name +
        "' lie in different presses (PressToPatient differs); set Coordinates to Patient, or write "
        "two files");
    }
    press = press ? press : &item;
  }
  if (press && patient && this->Settings.Frame == AsGiven)
  {
    throw std::runtime_error("block '" + press->Name +
      "' is in the coordinates of the press (PressToPatient), block '" + patient->Name +
      "' is not; set Coordinates to Patient or Press to bring them together");
  }
  if (lost && patient) // AsGiven, see FindLost
  {
    throw std::runtime_error("block '" + lost->Name + "' lies in a press and block '" +
      patient->Name + "' does not, and nothing brings them together: of the first one " +
      lost->Lost + "; write two files");
  }
  if (!press && this->Settings.Frame == Press)
  {
    throw std::runtime_error("Coordinates is Press, but no input says where the press is (field "
                             "data PressToPatient, as Press Orientation gives it)");
  }
  const bool inPress = press && this->Settings.Frame != Patient;
  for (Item& item : this->Items)
  {
    if (!item.Lost.empty())
    {
      continue; // it stays where it is
    }
    if (inPress && !item.PressToPatient)
    {
      item.ToFile = press->PressToPatient->Inverse();
    }
    else if (!inPress && item.PressToPatient)
    {
      item.ToFile = *item.PressToPatient;
    }
  }
  this->DescribeFrame(inPress ? press : nullptr);
}

//------------------------------------------------------------------------------
bool lacuna::CADContent::Item::IsPatient() const
{
  return this->Lost.empty() &&
    (this->PressToPatient ? lacuna::Coordinates::GetBeforePress(this->Data)
                          : lacuna::Coordinates::Get(this->Data)) == lacuna::Coordinates::Patient;
}

//------------------------------------------------------------------------------
// For people, in the file: nobody may take for the patient's what is not known to be. press: whose
// coordinates the file has, or nullptr.
void lacuna::CADContent::DescribeFrame(const Item* press)
{
  std::string unknown;
  bool any = false;
  bool allLost = true;
  for (const Item& item : this->Items)
  {
    any = any || item.IsPatient();
    allLost = allLost && !item.Lost.empty();
    if (!item.Lost.empty())
    {
      this->Description.push_back("The way to the patient is NOT KNOWN" +
        (item.Name.empty() ? "" : " for '" + item.Name + "'") + ": " + item.Lost + '.');
    }
    else if (!item.IsPatient() && !item.Name.empty())
    {
      unknown += (unknown.empty() ? "'" : ", '") + item.Name + "'";
    }
  }
  if (any && !unknown.empty())
  {
    this->Description.push_back("NOT KNOWN to be placed by the patient's coordinates: " + unknown +
      " (no mark says whose theirs are).");
  }
  if (allLost)
  {
    this->Description.emplace_back("Coordinates of the input, in mm.");
    return;
  }
  if (!press)
  {
    this->Description.emplace_back(any
        ? "Coordinates of the patient (DICOM LPS: left, back, up), in mm, by the input's mark."
        : "Coordinates of the input, in mm; not known whose they are (it has no mark).");
    return;
  }
  this->Description.emplace_back("Coordinates of the press, in mm: z is up, towards the mill.");
  this->Description.emplace_back(press->IsPatient()
      ? "To patient coordinates (DICOM LPS) by a matrix of the rows"
      : "To the input's coordinates (not known whose) by a matrix of the rows");
  for (int row = 0; row < 3; ++row)
  {
    // a row in a line of 72 characters
    std::ostringstream text;
    text.imbue(std::locale::classic());
    text << std::fixed << std::setprecision(12);
    for (int column = 0; column < 4; ++column)
    {
      text << ' ' << std::setw(column < 3 ? 16 : 18) << (*press->PressToPatient)(row, column);
    }
    this->Description.push_back(text.str());
  }
}
