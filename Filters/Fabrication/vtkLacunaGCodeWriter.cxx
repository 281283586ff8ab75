// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaGCodeWriter.h"

#include "lacunaAlgorithmExecution.h"
#include "lacunaAtomicFile.h"
#include "lacunaCoordinates.h"
#include "lacunaFieldData.h"
#include "lacunaGCode.h"
#include "lacunaParameterText.h"
#include "lacunaPressPosition.h"
#include "lacunaPrintableText.h"
#include "lacunaProvenance.h"
#include "lacunaToolPath.h"
#include "vtkCellArray.h"
#include "vtkCellArrayIterator.h"
#include "vtkDataArray.h"
#include "vtkInformation.h"
#include "vtkLacunaMillingToolPath.h"
#include "vtkLogger.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"
#include "vtkStringArray.h"

#include <vtksys/SystemTools.hxx>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

vtkStandardNewMacro(vtkLacunaGCodeWriter);

namespace
{
constexpr double PlaceTolerance = 0.002; // mm
constexpr double TiltTolerance = 0.001;  // degrees
constexpr double NoEnvelope[6] = { 1, -1, 1, -1, 1, -1 };
constexpr double Unlimited = 1e299;

//------------------------------------------------------------------------------
vtkDataArray* GetArray(vtkPolyData* path, const char* name)
{
  vtkDataArray* array = path->GetPointData()->GetArray(name);
  if (!array || array->GetNumberOfComponents() != 1 ||
    array->GetNumberOfTuples() != path->GetNumberOfPoints())
  {
    throw std::runtime_error(std::string("the path has no point array '") + name +
      "' with one number for each point; write the output of Milling Tool Path");
  }
  return array;
}

//------------------------------------------------------------------------------
// The motions of all poly lines, one after the other; each starts where the one before ended.
std::vector<lacuna::GCodeMove> GetMoves(vtkPolyData* path, lacuna::Vec3& start)
{
  vtkDataArray* motions = GetArray(path, vtkLacunaMillingToolPath::MotionName);
  vtkDataArray* feeds = GetArray(path, vtkLacunaMillingToolPath::FeedRateName);
  std::vector<lacuna::GCodeMove> moves;
  moves.reserve(path->GetNumberOfPoints());
  lacuna::Vec3 end{ 0, 0, 0 };
  vtkIdType line = 0;
  auto cells = vtk::TakeSmartPointer(path->GetLines()->NewIterator());
  for (cells->GoToFirstCell(); !cells->IsDoneWithTraversal(); cells->GoToNextCell(), ++line)
  {
    vtkIdType count;
    const vtkIdType* ids;
    cells->GetCurrentCell(count, ids);
    for (vtkIdType k = 0; k < count; ++k)
    {
      lacuna::Vec3 p{ 0, 0, 0 };
      path->GetPoint(ids[k], p.data());
      if (k > 0)
      {
        const double kind = motions->GetComponent(ids[k], 0);
        moves.push_back({ kind == static_cast<double>(lacuna::Motion::Rapid), p,
          feeds->GetComponent(ids[k], 0) });
      }
      else if (line == 0)
      {
        start = p;
      }
      else if (!(lacuna::Norm(p - end) <= 1e-4)) // single precision may have come between
      {
        throw std::runtime_error("poly line " + std::to_string(line) +
          " of the path does not start where the one before ends; the tool's way between them is "
          "not known");
      }
      end = p;
    }
  }
  return moves;
}

//------------------------------------------------------------------------------
// Whether the path is where Milling Tool Path made it. Throws when it has another shape now or lies
// aslant; returns a warning when it lies elsewhere.
std::string CheckPlace(vtkPolyData* path)
{
  const std::optional<lacuna::LandmarkMove> found = lacuna::PressPosition::FindMove(path);
  if (!found)
  {
    return {};
  }
  const lacuna::LandmarkMove& move = *found;
  const auto thousandths = [](double value)
  { return lacuna::FormatNumber(std::round(1000 * value) / 1000); };
  const std::string since = "the path has been changed since Milling Tool Path made it (by "
                            "Transform?): ";
  if (move.Mirrored)
  {
    throw std::runtime_error(since +
      "it is mirrored, so what it mills is no part of this patient. Write the path as it was made");
  }
  if (!(move.Stretch <= PlaceTolerance))
  {
    throw std::runtime_error(since + "distances in it are other ones by up to " +
      thousandths(move.Stretch) + " mm. The program is in mm; write the path as it was made");
  }
  if (!(move.Tilt <= TiltTolerance))
  {
    throw std::runtime_error(since + "it is tilted by " + thousandths(move.Tilt) +
      " degrees, and the mill goes along z only. Turn the part with Press Orientation instead");
  }
  if (move.Rise < -PlaceTolerance)
  {
    throw std::runtime_error(since + "it lies " + thousandths(-move.Rise) +
      " mm lower, so the tool would go that much deeper into the stock. Write the path as it was "
      "made; set the zero's height on the machine (WorkOffset)");
  }
  if (move.Way <= PlaceTolerance)
  {
    return {};
  }
  return since + "it lies up to " + thousandths(move.Way) + " mm elsewhere. " +
    (move.Rise > PlaceTolerance ? "All of it is " + thousandths(move.Rise) +
          " mm higher, so that much more stays on the part. "
                                : "") +
    "The program's zero is no longer that of the press, and PressToPatient does not lead from it "
    "to "
    "the patient; better set the zero on the machine (WorkOffset)";
}

//------------------------------------------------------------------------------
// Of the field data, 0 when there is none. It goes into the file.
double GetNumber(vtkPolyData* path, const char* name)
{
  vtkDataArray* array = lacuna::FieldData::Find(path, name, 1, 1);
  const double value = array ? array->GetComponent(0, 0) : 0;
  if (!(std::abs(value) <= 1e9))
  {
    throw std::runtime_error(std::string("field data ") + name + " of the path is " +
      lacuna::FormatNumber(value) + "; write the output of Milling Tool Path");
  }
  return value;
}

// Where the program's coordinates are. changed: the path lies elsewhere than it was made.
std::string DescribePlace(vtkPolyData* path, bool changed)
{
  const bool before = lacuna::FieldData::Find(path, lacuna::PressPosition::MovedName, 1, 1);
  if (!changed && !before)
  {
    return "mm, press coordinates, tool tip";
  }
  return std::string("mm, tool tip. ") + (changed ? "The path" : "The mould") +
    " was MOVED since it was made: no press coordinates, the way to the patient is not known";
}

// What Milling Tool Path warned of.
std::vector<std::string> GetWarnings(vtkPolyData* path)
{
  std::vector<std::string> warnings;
  auto* told = vtkStringArray::SafeDownCast(
    path->GetFieldData()->GetAbstractArray(vtkLacunaMillingToolPath::WarningsName));
  for (vtkIdType i = 0; told && i < told->GetNumberOfValues(); ++i)
  {
    warnings.push_back(told->GetValue(i));
  }
  return warnings;
}

// The question before a program with warnings is written.
std::string DescribeRefusal(const std::vector<std::string>& warnings)
{
  std::string text = "nothing is written, since there is a warning";
  for (const std::string& warning : warnings)
  {
    text += (&warning == &warnings.front() ? ": " : "; ") + warning;
  }
  return text + ". Turn on AcceptWarnings to write it all the same";
}

std::string DescribeTool(vtkPolyData* path, int number)
{
  const double radius = GetNumber(path, "ToolRadius");
  return "T" + std::to_string(number) +
    (radius > 0 ? std::string(GetNumber(path, "ToolShape") == 0 ? " ball" : " flat") +
          " end, diameter " + lacuna::FormatNumber(2 * radius) + " mm"
                : std::string());
}

// What the head of the program says.
std::vector<std::string> GetComments(
  vtkPolyData* path, const lacuna::GCodeOptions& options, bool isMoved)
{
  const std::string version = std::string("Lacuna ") + lacuna::Provenance::GetVersion();
  std::vector<std::string> comments = { version + " G-Code Writer",
    vtksys::SystemTools::GetCurrentDateTime("%Y-%m-%d %H:%M"), DescribePlace(path, isMoved),
    DescribeTool(path, options.ToolNumber) };
  if (options.ArcTolerance > 0)
  {
    comments.push_back("Motions joined to arcs, at most " +
      lacuna::FormatNumber(options.ArcTolerance) + " mm above the path");
  }
  if (lacuna::Coordinates::IsMirrored(path))
  {
    comments.emplace_back("MIRROR IMAGE, left is right");
  }
  if (const double time = GetNumber(path, "MachiningTime"); time > 0)
  {
    comments.push_back("Time about " + std::to_string(std::llround(std::ceil(time / 60))) + " min");
  }
  for (const std::string& step : lacuna::Provenance::Get(path))
  {
    comments.push_back("Made by: " + step);
  }
  return comments;
}
}

//------------------------------------------------------------------------------
vtkLacunaGCodeWriter::~vtkLacunaGCodeWriter()
{
  this->SetFileName(nullptr);
  this->SetHeader(nullptr);
  this->SetFooter(nullptr);
}

//------------------------------------------------------------------------------
int vtkLacunaGCodeWriter::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkPolyData");
  return 1;
}

//------------------------------------------------------------------------------
void vtkLacunaGCodeWriter::ClearResults()
{
  this->Superclass::ClearResults();
  this->NumberOfBlocks = 0;
}

//------------------------------------------------------------------------------
void vtkLacunaGCodeWriter::WriteFile()
{
  auto* path = vtkPolyData::SafeDownCast(this->GetInput());
  if (!path || path->GetNumberOfLines() == 0)
  {
    throw std::runtime_error("the input has no poly lines");
  }
  this->WriteProgram(path);
}

//------------------------------------------------------------------------------
lacuna::GCodeOptions vtkLacunaGCodeWriter::GetOptions() const
{
  lacuna::GCodeOptions options;
  options.ProgramNumber = this->ProgramNumber;
  options.ToolNumber = this->ToolNumber;
  options.WorkOffset = this->WorkOffset;
  options.SpindleSpeed = this->SpindleSpeed;
  options.LineNumbers = this->LineNumbers;
  options.ArcTolerance = this->ArcTolerance;
  return options;
}

//------------------------------------------------------------------------------
lacuna::GCodeOptions vtkLacunaGCodeWriter::GetOptions(vtkPolyData* path, bool isMoved) const
{
  lacuna::GCodeOptions options = this->GetOptions();
  if (options.SpindleSpeed == 0)
  {
    options.SpindleSpeed = GetNumber(path, "SpindleSpeed");
  }
  if (options.SpindleSpeed == 0)
  {
    throw std::runtime_error("the path has no SpindleSpeed; set SpindleSpeed");
  }
  options.HasEnvelope = !std::equal(NoEnvelope, NoEnvelope + 6, this->Envelope);
  for (int axis = 0; axis < 3; ++axis)
  {
    const double* range = this->Envelope + 2 * axis;
    const bool isFree = range[0] == NoEnvelope[2 * axis] && range[1] == NoEnvelope[2 * axis + 1];
    options.Envelope[2 * axis] = isFree ? -Unlimited : range[0];
    options.Envelope[2 * axis + 1] = isFree ? Unlimited : range[1];
  }
  if (this->Header && *this->Header)
  {
    options.Header = this->Header;
  }
  if (this->Footer && *this->Footer)
  {
    options.Footer = this->Footer;
  }
  options.Comments = GetComments(path, options, isMoved);
  return options;
}

//------------------------------------------------------------------------------
void vtkLacunaGCodeWriter::WriteProgram(vtkPolyData* path)
{
  lacuna::Vec3 start{ 0, 0, 0 };
  const std::vector<lacuna::GCodeMove> moves = GetMoves(path, start);
  const bool mirrored = lacuna::Coordinates::IsMirrored(path);
  if (mirrored && !this->AllowMirrored)
  {
    throw std::runtime_error(
      "the path is over a mirror image of the patient (field data Mirrored): nothing made from it "
      "fits the side it was taken from. Turn on AllowMirrored if the mirrored side is what you "
      "want");
  }
  const std::string moved = CheckPlace(path);
  const lacuna::GCodeOptions options = this->GetOptions(path, !moved.empty());
  lacuna::AlgorithmExecution execution(this);
  execution.SetStage(0, 0.9);
  const lacuna::GCodeProgram program = lacuna::MakeGCode(start, moves, options, &execution);
  std::vector<std::string> warnings = program.Warnings;
  if (!moved.empty())
  {
    warnings.push_back(moved);
  }
  std::vector<std::string> all = GetWarnings(path); // told before
  all.insert(all.end(), warnings.begin(), warnings.end());
  if (!all.empty() && !this->AcceptWarnings)
  {
    throw std::runtime_error(DescribeRefusal(all));
  }
  execution.SetStage(0.9, 1);
  execution.Report(0);
  lacuna::WriteFileAtomically(this->FileName, program.Text);
  this->UpdateProgress(1); // no longer to be stopped: the file is there
  this->FileSize = static_cast<vtkTypeInt64>(program.Text.size());
  this->NumberOfBlocks = program.Blocks;
  if (mirrored)
  {
    vtkWarningMacro(<< lacuna::ToPrintable(this->FileName)
                    << ": the path is over a mirror image of the patient; the file says so, too");
  }
  for (const std::string& warning : warnings)
  {
    vtkWarningMacro(<< lacuna::ToPrintable(this->FileName + (": " + warning)));
  }
  vtkLog(INFO, << "G-Code Writer: " << this->FileName << ", " << this->FileSize << " bytes, "
               << this->NumberOfBlocks << " blocks");
}

//------------------------------------------------------------------------------
void vtkLacunaGCodeWriter::Describe(lacuna::Properties& properties) const
{
  this->GetOptions().Describe(properties);
  properties.Add("Envelope", this->Envelope)
    .Add("AcceptWarnings", this->AcceptWarnings)
    .Add("AllowMirrored", this->AllowMirrored)
    .Add("Header", this->Header)
    .Add("Footer", this->Footer);
}

//------------------------------------------------------------------------------
void vtkLacunaGCodeWriter::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "NumberOfBlocks: " << this->NumberOfBlocks << "\n";
}
