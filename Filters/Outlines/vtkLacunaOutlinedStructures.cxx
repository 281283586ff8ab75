// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaOutlinedStructures.h"

#include "lacunaArrays.h"
#include "lacunaParameterText.h"
#include "lacunaPrintableText.h"
#include "lacunaVector.h"
#include "vtkAppendPolyData.h"
#include "vtkCallbackCommand.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkDataSetAttributes.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkInformation.h"
#include "vtkIntArray.h"
#include "vtkLacunaRBFSurface.h"
#include "vtkMath.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"
#include "vtkStdString.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkStringArray.h"
#include "vtkStripper.h"
#include "vtkTable.h"
#include "vtkUnsignedCharArray.h"
#include "vtkVariant.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>

vtkStandardNewMacro(vtkLacunaOutlinedStructures);

// As the input gives them.
struct vtkLacunaOutlinedStructures::Input
{
  std::string Name;
  std::array<unsigned char, 3> Color{ 230, 159, 0 };
  std::vector<std::vector<lacuna::Vec3>> Outlines; // without the first point at the end
  std::vector<int> Slices; // of the outlines; those without a number have one of their own below 0
};

namespace
{
using lacuna::Vec3;
// Of an outline that a surface is made of.
constexpr std::size_t FewestPoints = 16;
constexpr std::size_t MostPoints = 48;

using Lines = std::vector<std::vector<Vec3>>;
using Structure = vtkLacunaOutlinedStructures::Input;

// Of a structure's surface; lengths in mm.
struct Measures
{
  double Volume = vtkMath::Nan(); // mm^3
  double OutlineError = vtkMath::Nan();
  double RegistrationError = vtkMath::Nan(); // for 1 mm
  double Area = vtkMath::Nan();
  double Diameter = vtkMath::Nan();
  Vec3 Centroid{ vtkMath::Nan(), vtkMath::Nan(), vtkMath::Nan() };
};

// Newell's; its length is twice the area.
Vec3 GetNormal(const std::vector<Vec3>& line)
{
  Vec3 sum{};
  for (std::size_t i = 0; i < line.size(); ++i)
  {
    sum = sum + lacuna::Cross(line[i] - line[0], line[(i + 1) % line.size()] - line[0]);
  }
  return sum;
}

struct Plane
{
  Vec3 Normal, Point;
  double Size; // of the first outline in it, mm
};

bool IsSame(const Plane& a, const Plane& b)
{
  constexpr double parallel = 0.999;
  constexpr double apart = 0.01; // of the size
  return std::abs(lacuna::Dot(a.Normal, b.Normal)) > parallel &&
    std::abs(lacuna::Dot(a.Normal, b.Point - a.Point)) < apart * a.Size;
}

// Whether two lines in one plane cross, or are the same.
bool DoCross(const std::vector<Vec3>& one, const std::vector<Vec3>& other, const Vec3& normal)
{
  if (one == other)
  {
    return true;
  }
  const auto side = [&](const Vec3& a, const Vec3& b, const Vec3& x)
  { return lacuna::Dot(normal, lacuna::Cross(b - a, x - a)); };
  for (std::size_t i = 0; i < one.size(); ++i)
  {
    const Vec3& a = one[i];
    const Vec3& b = one[(i + 1) % one.size()];
    for (std::size_t j = 0; j < other.size(); ++j)
    {
      const Vec3& c = other[j];
      const Vec3& d = other[(j + 1) % other.size()];
      if (side(a, b, c) * side(a, b, d) < 0 && side(c, d, a) * side(c, d, b) < 0)
      {
        return true;
      }
    }
  }
  return false;
}

// Why the outlines make no surface; empty: they do.
std::string FindLack(const Structure& structure)
{
  constexpr std::size_t enough = 3;
  std::vector<Plane> planes;  // that are not the same
  std::vector<Plane> ofLines; // of each outline
  for (const auto& line : structure.Outlines)
  {
    const Vec3 sum = GetNormal(line);
    ofLines.push_back({ lacuna::Norm(sum) > 0 ? lacuna::Normalized(sum) : Vec3{ 0, 0, 1 }, line[0],
      std::sqrt(lacuna::Norm(sum)) });
    const Plane& plane = ofLines.back();
    if (plane.Size > 0 &&
      std::none_of(planes.begin(), planes.end(), [&](const Plane& p) { return IsSame(p, plane); }))
    {
      planes.push_back(plane);
    }
  }
  for (std::size_t i = 0; i < ofLines.size(); ++i)
  {
    for (std::size_t j = 0; j < i; ++j)
    {
      if (IsSame(ofLines[j], ofLines[i]) &&
        DoCross(structure.Outlines[j], structure.Outlines[i], ofLines[j].Normal))
      {
        const int slice = structure.Slices[i];
        return "two outlines" +
          (slice >= 0 ? " in slice " + std::to_string(slice) : std::string()) +
          " cross or are the same: delete one";
      }
    }
  }
  return planes.size() >= enough ? std::string()
                                 : std::to_string(planes.size()) + " of 3 slices outlined";
}

// Of a closed line, count points that are evenly spread over its length, or itself when it has fewer. More
// would cost time and add nothing: the surface is smoother than the line.
std::vector<Vec3> GetEven(const std::vector<Vec3>& line, std::size_t count)
{
  const std::size_t n = line.size();
  if (n <= count)
  {
    return line;
  }
  std::vector<double> along(n + 1, 0);
  for (std::size_t i = 0; i < n; ++i)
  {
    along[i + 1] = along[i] + lacuna::Norm(line[(i + 1) % n] - line[i]);
  }
  std::vector<Vec3> even;
  std::size_t i = 0;
  for (std::size_t k = 0; k < count; ++k)
  {
    const double at = along[n] * static_cast<double>(k) / static_cast<double>(count);
    while (along[i + 1] < at)
    {
      ++i;
    }
    const double length = along[i + 1] - along[i];
    const double part = length > 0 ? (at - along[i]) / length : 0;
    even.push_back(line[i] + part * (line[(i + 1) % n] - line[i]));
  }
  return even;
}

// The greatest distance between two points. Those far from the middle come first, until no pair can be longer.
double GetDiameter(const std::vector<Vec3>& points)
{
  Vec3 middle{};
  for (const Vec3& x : points)
  {
    middle = middle + (1.0 / static_cast<double>(points.size())) * x;
  }
  std::vector<std::pair<double, std::size_t>> away;
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    away.emplace_back(lacuna::Norm(points[i] - middle), i);
  }
  std::sort(away.rbegin(), away.rend());
  double best = 0;
  for (std::size_t i = 0; i < away.size() && 2 * away[i].first > best; ++i)
  {
    for (std::size_t j = i + 1; j < away.size() && away[i].first + away[j].first > best; ++j)
    {
      best = std::max(best, lacuna::Norm(points[away[i].second] - points[away[j].second]));
    }
  }
  return best;
}

Measures Measure(vtkPolyData* surface, const Structure& structure)
{
  Measures found;
  const Lines& outlines = structure.Outlines;
  std::vector<Vec3> points(static_cast<std::size_t>(surface->GetNumberOfPoints()));
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    surface->GetPoint(static_cast<vtkIdType>(i), points[i].data());
  }
  // the outline nearest to each point of the surface
  std::vector<std::size_t> nearest(points.size(), 0);
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    double best = -1;
    for (std::size_t o = 0; o < outlines.size(); ++o)
    {
      for (const Vec3& x : outlines[o])
      {
        const Vec3 d = points[i] - x;
        const double away = lacuna::Dot(d, d);
        if (best < 0 || away < best)
        {
          best = away;
          nearest[i] = o;
        }
      }
    }
  }
  std::map<int, Vec3> areas; // of the slices: their outlines move together
  const Vec3 origin = points.empty() ? Vec3{} : points[0];
  double volume = 0;
  double area = 0;
  Vec3 moment{};
  vtkCellArray* cells = surface->GetPolys();
  for (vtkIdType c = 0; c < cells->GetNumberOfCells(); ++c)
  {
    vtkIdType count = 0;
    const vtkIdType* ids = nullptr;
    cells->GetCellAtId(c, count, ids);
    const Vec3 a = points[ids[0]] - origin;
    const Vec3 b = points[ids[1]] - origin;
    const Vec3 d = points[ids[2]] - origin;
    const Vec3 across = 0.5 * lacuna::Cross(b - a, d - a);
    const double part = lacuna::Dot(a, lacuna::Cross(b, d)) / 6;
    volume += part;
    area += lacuna::Norm(across);
    moment = moment + (part / 4) * (a + b + d);
    for (int k = 0; k < 3; ++k)
    {
      Vec3& sum = areas[structure.Slices[nearest[ids[k]]]];
      sum = sum + (1.0 / 3) * across;
    }
  }
  double squares = 0;
  for (const auto& [slice, x] : areas)
  {
    squares += lacuna::Dot(x, x) / 3; // one axis of three
  }
  found.Volume = volume;
  found.RegistrationError = std::sqrt(squares);
  found.Area = area;
  found.Diameter = GetDiameter(points);
  found.Centroid = origin + (1 / volume) * moment;
  return found;
}

// The lines of each structure.
// By number and name: outlines of several files may use a number twice.
std::map<std::pair<int, std::string>, Structure> GetStructures(vtkPolyData* input)
{
  // lines are numbered behind the vertices
  const vtkIdType firstLine = input->GetNumberOfVerts();
  if (input->GetNumberOfLines() == 0)
  {
    throw std::runtime_error(
      "the input has no lines; give closed outlines, as Slice Outliner makes them");
  }
  const auto find = [&](const char* name, int components)
  {
    vtkDataArray* array = input->GetCellData()->GetArray(name);
    if (array && array->GetNumberOfComponents() != components)
    {
      throw std::runtime_error(std::string("cell array '") + name + "' has " +
        std::to_string(array->GetNumberOfComponents()) + " components; it must have " +
        std::to_string(components));
    }
    return array;
  };
  vtkDataArray* numbers = find("Structure", 1);
  vtkDataArray* colors = find("StructureColor", 3);
  vtkDataArray* slices = find("SliceNumber", 1);
  auto* names =
    vtkStringArray::SafeDownCast(input->GetCellData()->GetAbstractArray("StructureName"));
  std::map<std::pair<int, std::string>, Structure> structures;
  vtkCellArray* lines = input->GetLines();
  for (vtkIdType l = 0; l < lines->GetNumberOfCells(); ++l)
  {
    vtkIdType count = 0;
    const vtkIdType* ids = nullptr;
    lines->GetCellAtId(l, count, ids);
    std::vector<Vec3> points;
    for (vtkIdType i = 0; i < count; ++i)
    {
      Vec3 x;
      input->GetPoint(ids[i], x.data());
      if (!lacuna::IsFinite(x))
      {
        throw std::runtime_error(
          "line " + std::to_string(l) + " has a point that is not finite; remove it");
      }
      points.push_back(x);
    }
    if (points.size() < 4 || !(points.front() == points.back()))
    {
      throw std::runtime_error("line " + std::to_string(l) +
        " is not closed; the last point of an outline is its first, and it has three or more "
        "others");
    }
    points.pop_back();
    const double number = numbers ? numbers->GetComponent(firstLine + l, 0) : 1;
    constexpr double most = 1 << 30;
    if (!(std::abs(number) <= most) || number != std::floor(number))
    {
      throw std::runtime_error("cell array 'Structure' of line " + std::to_string(l) + " is " +
        lacuna::FormatNumber(number) + "; it must be a whole number");
    }
    const int whole = static_cast<int>(number);
    const std::string name =
      names ? names->GetValue(firstLine + l) : "Structure " + std::to_string(whole);
    const auto [at, isNew] = structures.try_emplace({ whole, name });
    if (isNew)
    {
      at->second.Name = name;
      for (int c = 0; colors && c < 3; ++c)
      {
        at->second.Color[c] = static_cast<unsigned char>(
          std::clamp(colors->GetComponent(firstLine + l, c), 0.0, 255.0));
      }
    }
    at->second.Outlines.push_back(std::move(points));
    const double slice = slices ? slices->GetComponent(firstLine + l, 0) : -1;
    const int own = -1 - static_cast<int>(at->second.Slices.size());
    at->second.Slices.push_back(slice >= 0 && slice <= most ? static_cast<int>(slice) : own);
  }
  return structures;
}

// "Warning: In file, line n\nvtkClass (0x...): words\n\n" without what only helps programmers.
std::string GetWords(const std::string& text)
{
  const std::size_t at = text.find("): ");
  std::string words = at == std::string::npos ? text : text.substr(at + 3);
  while (!words.empty() && (words.back() == '\n' || words.back() == ' '))
  {
    words.pop_back();
  }
  return words;
}

// The outlines as closed lines of few points.
vtkSmartPointer<vtkPolyData> MakeLines(const Lines& outlines)
{
  constexpr std::size_t all = 160; // points of a structure, which the time of a fit depends on
  const std::size_t each = std::clamp<std::size_t>(all / outlines.size(), FewestPoints, MostPoints);
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkCellArray> cells;
  for (const auto& outline : outlines)
  {
    const std::vector<Vec3> line = GetEven(outline, each);
    cells->InsertNextCell(static_cast<int>(line.size() + 1));
    const vtkIdType first = points->GetNumberOfPoints();
    for (const Vec3& x : line)
    {
      cells->InsertCellPoint(points->InsertNextPoint(x.data()));
    }
    cells->InsertCellPoint(first);
  }
  auto lines = vtkSmartPointer<vtkPolyData>::New();
  lines->SetPoints(points);
  lines->SetLines(cells);
  return lines;
}

// The surface of a structure as it is shown: with its number and colour.
vtkSmartPointer<vtkPolyData> MakePart(
  vtkPolyData* surface, int number, const std::array<unsigned char, 3>& rgb)
{
  auto part = vtkSmartPointer<vtkPolyData>::New();
  part->ShallowCopy(surface);
  vtkNew<vtkIntArray> of;
  of->SetName("Structure");
  lacuna::Arrays::SetNumberOfTuples(of, part->GetNumberOfCells());
  of->FillValue(number);
  vtkNew<vtkUnsignedCharArray> color;
  color->SetName("StructureColor");
  color->SetNumberOfComponents(3);
  lacuna::Arrays::SetNumberOfTuples(color, part->GetNumberOfCells());
  for (int c = 0; c < 3; ++c)
  {
    color->FillComponent(c, rgb[c]);
  }
  part->GetCellData()->SetScalars(of);
  part->GetCellData()->AddArray(color);
  return part;
}

template <class Array>
void AddColumn(vtkTable* table, const char* name)
{
  vtkNew<Array> column;
  column->SetName(name);
  table->AddColumn(column);
}

// Of output 1.
void AddColumns(vtkTable* table)
{
  AddColumn<vtkIntArray>(table, "Structure");
  AddColumn<vtkStringArray>(table, "Name");
  AddColumn<vtkIntArray>(table, "Outlines");
  for (const char* title : { "Volume (ml)", "Standard error (ml)", "Area (cm2)",
         "Largest diameter (mm)", "Centroid X (mm)", "Centroid Y (mm)", "Centroid Z (mm)" })
  {
    AddColumn<vtkDoubleArray>(table, title);
  }
  AddColumn<vtkStringArray>(table, "Status");
}
}

// What is told by an algorithm within, and where its progress and stops go.
struct vtkLacunaOutlinedStructures::Listener
{
  std::string Error;
  std::vector<std::string> Warnings;
  lacuna::AlgorithmExecution* Execution = nullptr;
  bool IsStopped = false;

  static void Hear(vtkObject* caller, unsigned long event, void* self, void* data)
  {
    auto* listener = static_cast<Listener*>(self);
    if (event == vtkCommand::ErrorEvent)
    {
      listener->Error = static_cast<const char*>(data);
    }
    else if (event == vtkCommand::WarningEvent)
    {
      listener->Warnings.emplace_back(static_cast<const char*>(data));
    }
    else
    {
      try
      {
        listener->Execution->Report(*static_cast<const double*>(data));
      }
      catch (const lacuna::Aborted&)
      {
        listener->IsStopped = true;
        vtkAlgorithm::SafeDownCast(caller)->SetAbortExecute(1);
      }
    }
  }
};

struct vtkLacunaOutlinedStructures::Kept
{
  Lines Outlines;
  std::vector<int> Slices;
  double Smoothing, Spacing;
  vtkSmartPointer<vtkPolyData> Surface; ///< null: none
  std::string Lack;                     ///< why
  std::vector<std::string> Warnings;
  Measures Size;
};

//------------------------------------------------------------------------------
vtkLacunaOutlinedStructures::vtkLacunaOutlinedStructures()
{
  this->Sharing = lacuna::Share::FirstRank;
  this->TakesBlocks = true;
  this->SetNumberOfOutputPorts(2);
}

vtkLacunaOutlinedStructures::~vtkLacunaOutlinedStructures() = default;

//------------------------------------------------------------------------------
int vtkLacunaOutlinedStructures::FillOutputPortInformation(int port, vtkInformation* info)
{
  info->Set(vtkDataObject::DATA_TYPE_NAME(), port == 0 ? "vtkPolyData" : "vtkTable");
  return 1;
}

//------------------------------------------------------------------------------
std::shared_ptr<const vtkLacunaOutlinedStructures::Kept> vtkLacunaOutlinedStructures::Make(
  const Structure& structure, lacuna::AlgorithmExecution& execution) const
{
  const Lines& outlines = structure.Outlines;
  for (const auto& kept : this->Made)
  {
    if (kept->Outlines == outlines && kept->Slices == structure.Slices &&
      kept->Smoothing == this->Smoothing && kept->Spacing == this->OutputSpacing)
    {
      return kept;
    }
  }
  auto result = std::make_shared<Kept>();
  result->Outlines = outlines;
  result->Slices = structure.Slices;
  result->Smoothing = this->Smoothing;
  result->Spacing = this->OutputSpacing;
  result->Lack = FindLack(structure);
  if (!result->Lack.empty())
  {
    return result;
  }
  Listener listener;
  listener.Execution = &execution;
  const vtkSmartPointer<vtkPolyData> surface = this->MakeSurface(MakeLines(outlines), listener);
  if (listener.IsStopped)
  {
    throw lacuna::Aborted();
  }
  if (listener.Error.find("memory") != std::string::npos) // no fault of this structure
  {
    throw std::runtime_error(structure.Name + ": " + GetWords(listener.Error));
  }
  for (const std::string& warning : listener.Warnings)
  {
    // too few outlines as yet: told where the volume stands
    if (warning.find("reaches OutputBounds") != std::string::npos)
    {
      result->Lack = "open at an end: outline slices nearer to the ends";
    }
    else
    {
      result->Warnings.push_back(GetWords(warning));
    }
  }
  vtkDataArray* volume = surface->GetFieldData()->GetArray("SurfaceVolume");
  if (!listener.Error.empty() || surface->GetNumberOfCells() == 0 || !volume)
  {
    result->Lack = listener.Error.empty() ? "the surface is not closed" : GetWords(listener.Error);
    result->Warnings.push_back("no surface: " + result->Lack);
    return result;
  }
  result->Surface = surface;
  result->Size = Measure(surface, structure);
  if (vtkDataArray* error = surface->GetFieldData()->GetArray("SurfaceVolumeError"))
  {
    result->Size.OutlineError = 1000 * error->GetComponent(0, 0);
  }
  if (!result->Lack.empty())
  {
    result->Size = Measures(); // of a surface that planes cut off
  }
  return result;
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkPolyData> vtkLacunaOutlinedStructures::MakeSurface(
  vtkPolyData* lines, Listener& listener) const
{
  constexpr double edge = 1.0 / 40; // of the extent
  double bounds[6];
  lines->GetPoints()->GetBounds(bounds);
  const double extent =
    std::max({ bounds[1] - bounds[0], bounds[3] - bounds[2], bounds[5] - bounds[4] });
  vtkNew<vtkLacunaRBFSurface> filter;
  // without ParaView's executive it is alone on this rank
  filter->SetExecutive(vtkNew<vtkStreamingDemandDrivenPipeline>());
  filter->SetInputDataObject(lines);
  filter->SetSmoothing(this->Smoothing);
  filter->SetOutputSpacing(this->OutputSpacing > 0 ? this->OutputSpacing : edge * extent);
  vtkNew<vtkCallbackCommand> callback;
  callback->SetCallback(&Listener::Hear);
  callback->SetClientData(&listener);
  for (const auto event :
    { vtkCommand::ErrorEvent, vtkCommand::WarningEvent, vtkCommand::ProgressEvent })
  {
    filter->AddObserver(event, callback);
  }
  filter->Update();
  return filter->GetOutput();
}

//------------------------------------------------------------------------------
void vtkLacunaOutlinedStructures::Make(
  const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution)
{
  auto* input = ports.GetInput<vtkPolyData>();
  vtkNew<vtkStripper> joined; // pieces of lines, as cutters leave them
  if (!input->GetCellData()->HasArray("Structure"))
  {
    joined->SetInputData(input);
    joined->SetMaximumLength(1000000);
    joined->JoinContiguousSegmentsOn();
    joined->Update();
    input = joined->GetOutput();
  }
  const std::map<std::pair<int, std::string>, Structure> structures = GetStructures(input);

  std::vector<std::shared_ptr<const Kept>> made;
  vtkNew<vtkAppendPolyData> append;
  vtkNew<vtkTable> rows;
  AddColumns(rows);
  for (const auto& [key, structure] : structures)
  {
    const int number = key.first;
    const std::size_t n = made.size();
    execution.SetStage(static_cast<double>(n) / static_cast<double>(structures.size()),
      static_cast<double>(n + 1) / static_cast<double>(structures.size()));
    std::shared_ptr<const Kept> result = this->Make(structure, execution);
    made.push_back(result);
    for (const std::string& warning : result->Warnings)
    {
      vtkWarningMacro(<< lacuna::ToPrintable(structure.Name + ": " + warning));
    }
    const Measures& size = result->Size;
    const double error =
      std::hypot(size.OutlineError, this->RegistrationError * size.RegistrationError);
    const std::array<vtkVariant, 11> row{ number, vtkStdString(structure.Name),
      static_cast<int>(structure.Outlines.size()), size.Volume / 1000, error / 1000,
      size.Area / 100, size.Diameter, size.Centroid[0], size.Centroid[1], size.Centroid[2],
      vtkStdString(result->Lack) };
    const vtkIdType at = rows->InsertNextBlankRow();
    for (std::size_t column = 0; column < row.size(); ++column)
    {
      rows->SetValue(at, static_cast<vtkIdType>(column), row[column]);
    }
    if (result->Surface)
    {
      append->AddInputData(MakePart(result->Surface, number, structure.Color));
    }
  }
  this->Made = std::move(made);
  auto* output = ports.GetOutput<vtkPolyData>();
  if (append->GetNumberOfInputConnections(0) > 0)
  {
    append->Update();
    output->ShallowCopy(append->GetOutput());
    output->GetFieldData()->Initialize();
  }
  auto* table = ports.GetOutput<vtkTable>(1);
  table->GetFieldData()->Initialize();
  table->SetRowData(rows->GetRowData());
}

//------------------------------------------------------------------------------
void vtkLacunaOutlinedStructures::Describe(lacuna::Properties& properties) const
{
  using lacuna::ValueRange;
  properties.Add("RegistrationError", this->RegistrationError, ValueRange::AtLeast(0, "mm"))
    .Add("Smoothing", this->Smoothing, ValueRange::Above(0, "mm").OrZero("estimated"))
    .Add("OutputSpacing", this->OutputSpacing, ValueRange::Above(0, "mm").OrZero("automatic"));
}
