// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaIGESWriter.h"

#include "lacunaAlgorithmExecution.h"
#include "lacunaAtomicFile.h"
#include "lacunaCADContent.h"
#include "lacunaIGESDocument.h"
#include "lacunaPrintableText.h"
#include "lacunaProvenance.h"
#include "vtkInformation.h"
#include "vtkLogger.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"

#include <vtksys/SystemTools.hxx>

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

vtkStandardNewMacro(vtkLacunaIGESWriter);

namespace
{
// What a program that shows levels one by one finds on them, and in which colour.
enum Level
{
  SurfaceLevel = 1,
  CurveLevel = 2,
  PointLevel = 3
};
constexpr const char* Levels = "Levels: 1 surfaces, 2 outlines and curves, 3 points and axes.";

std::int64_t AddColour(lacuna::IGESDocument& document, Level level)
{
  switch (level)
  {
    case SurfaceLevel:
      return document.AddColour(0.9, 0.85, 0.7, "Bone");
    case CurveLevel:
      return document.AddColour(0.8, 0.1, 0.1, "Red");
    default:
      return document.AddColour(0.1, 0.2, 0.8, "Blue");
  }
}

//------------------------------------------------------------------------------
// Puts things into a document, with level, colour and name.
class Composer
{
public:
  explicit Composer(lacuna::IGESDocument& document)
    : Document(document)
  {
  }
  void Add(const lacuna::CADSurface& surface)
  {
    lacuna::IGESDocument::Attributes attributes = this->Attributes(SurfaceLevel, "SURFACE");
    const std::vector<std::int64_t> name{ this->Document.AddName(surface.Name) };
    if (surface.Pieces.empty())
    {
      this->Document.AddSurface(surface.Fit.Surface, attributes, name);
      return;
    }
    for (const auto& piece : surface.Pieces)
    {
      lacuna::IGESDocument::Attributes part = attributes;
      part.Subordinate = 1;
      const std::int64_t whole = this->Document.AddSurface(surface.Fit.Surface, part);
      std::vector<lacuna::IGESDocument::Boundary> boundaries;
      boundaries.reserve(piece.size());
      for (const lacuna::CADSurface::Boundary& boundary : piece)
      {
        boundaries.push_back({ &boundary.Parameters, &boundary.Space });
      }
      attributes.Label = "TRIMMED";
      this->Document.AddTrimmedSurface(whole, boundaries, attributes, name);
    }
  }
  void Add(const lacuna::CADContent::Curve& curve)
  {
    const lacuna::IGESDocument::Attributes attributes = this->Attributes(CurveLevel, "CURVE");
    this->Document.AddCurve(curve.Shape, attributes, { this->Document.AddName(curve.Name) });
  }
  void Add(const lacuna::CADContent::Polygon& polygon)
  {
    const lacuna::IGESDocument::Attributes attributes = this->Attributes(CurveLevel, "POLYGON");
    this->Document.AddPolygon(
      polygon.Corners, attributes, { this->Document.AddName(polygon.Name) });
  }
  void Add(const lacuna::CADContent::Line& line)
  {
    const bool axis = line.IsAxis;
    const lacuna::IGESDocument::Attributes attributes =
      this->Attributes(axis ? PointLevel : CurveLevel, axis ? "AXIS" : "LINE");
    this->Document.AddLine(line.From, line.To, attributes, { this->Document.AddName(line.Name) });
  }
  void Add(const lacuna::CADContent::Point& point)
  {
    const lacuna::IGESDocument::Attributes attributes = this->Attributes(PointLevel, "POINT");
    this->Document.AddPoint(point.Position, attributes, { this->Document.AddName(point.Name) });
  }

private:
  lacuna::IGESDocument::Attributes Attributes(Level level, const char* label)
  {
    if (this->Colours[level] == 0)
    {
      this->Colours[level] = AddColour(this->Document, level);
    }
    lacuna::IGESDocument::Attributes attributes;
    attributes.Level = level;
    attributes.Colour = -static_cast<int>(this->Colours[level]);
    attributes.Label = label;
    return attributes;
  }

  lacuna::IGESDocument& Document;
  std::int64_t Colours[4] = { 0, 0, 0, 0 };
};

lacuna::IGESDocument MakeDocument(const lacuna::CADContent& content)
{
  lacuna::IGESDocument document;
  Composer composer(document);
  const auto addAll = [&](const auto& things)
  {
    for (const auto& thing : things)
    {
      composer.Add(thing);
    }
  };
  addAll(content.Surfaces);
  addAll(content.Curves);
  addAll(content.Polygons);
  addAll(content.Lines);
  addAll(content.Points);
  return document;
}

//------------------------------------------------------------------------------
// Lines for people: what there is, where it comes from, and how it was made.
void AddDescription(const lacuna::CADContent& content, std::vector<std::string>& text)
{
  text.insert(text.end(), content.Description.begin(), content.Description.end());
  text.emplace_back(Levels);
  for (const lacuna::CADSurface& surface : content.Surfaces)
  {
    const lacuna::BSplineSurface& s = surface.Fit.Surface;
    text.push_back("Surface '" + surface.Name + "': bicubic B-spline, " +
      std::to_string(s.U.GetSize()) + " x " + std::to_string(s.V.GetSize()) +
      " control points, largest deviation from the samples " +
      lacuna::FormatNumber(surface.Fit.MaximumDeviation) + " mm. " + surface.Description);
    for (const auto& piece : surface.Pieces)
    {
      text.push_back("Trimmed to the outline of the defect" +
        (piece.size() > 1 ? ", less " + std::to_string(piece.size() - 1) + " islands."
                          : std::string(".")));
    }
  }
}
}

// As the content takes them.
struct vtkLacunaIGESWriter::Options : lacuna::CADContent::Options
{
  explicit Options(const vtkLacunaIGESWriter* self)
  {
    this->Fit.Tolerance = self->Tolerance;
    this->Outline = self->DefectOutline;
    this->Frame = self->Coordinates;
    this->AllowMirrored = self->AllowMirrored;
    this->SkipUnsupported = self->SkipUnsupported;
  }
};

//------------------------------------------------------------------------------
vtkLacunaIGESWriter::~vtkLacunaIGESWriter()
{
  this->SetFileName(nullptr);
}

//------------------------------------------------------------------------------
int vtkLacunaIGESWriter::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkImageData");
  for (const char* type : { "vtkStructuredGrid", "vtkPolyData", "vtkMultiBlockDataSet",
         "vtkPartitionedDataSet", "vtkPartitionedDataSetCollection" })
  {
    info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), type);
  }
  return 1;
}

//------------------------------------------------------------------------------
void vtkLacunaIGESWriter::ClearResults()
{
  this->Superclass::ClearResults();
  this->MaximumDeviation = 0;
  this->NumberOfControlPoints[0] = this->NumberOfControlPoints[1] = 0;
  this->NumberOfSurfaces = this->NumberOfCurves = this->NumberOfPoints = 0;
}

//------------------------------------------------------------------------------
void vtkLacunaIGESWriter::WriteFile()
{
  vtkDataObject* input = this->GetInput();
  if (!input)
  {
    throw std::runtime_error("there is no input");
  }
  lacuna::AlgorithmExecution execution(this);
  execution.SetStage(0, 0.9);
  const lacuna::CADContent content(input, Options(this), execution);
  const lacuna::IGESHeader header = this->MakeHeader(content);
  const std::string text = MakeDocument(content).GetText(header);
  execution.SetStage(0.9, 1);
  execution.Report(0);
  lacuna::WriteFileAtomically(this->FileName, text);
  this->UpdateProgress(1); // no longer to be stopped: the file is there

  this->SetResults(content);
  this->FileSize = static_cast<vtkTypeInt64>(text.size());
  for (const std::string& warning : content.Warnings)
  {
    vtkWarningMacro(<< lacuna::ToPrintable(this->FileName + (": " + warning)));
  }
  vtkLog(INFO, << "IGES Writer: " << this->FileName << ", " << this->FileSize << " bytes, "
               << this->NumberOfSurfaces << " surfaces, " << this->NumberOfCurves << " curves, "
               << this->NumberOfPoints << " points, largest deviation " << this->MaximumDeviation
               << " mm");
}

//------------------------------------------------------------------------------
lacuna::IGESHeader vtkLacunaIGESWriter::MakeHeader(const lacuna::CADContent& content)
{
  lacuna::IGESHeader header;
  const std::string version = std::string("Lacuna ") + lacuna::Provenance::GetVersion();
  header.FileName = vtksys::SystemTools::GetFilenameName(this->FileName);
  header.System = version;
  header.Preprocessor = version + " IGES Writer";
  header.Date = vtksys::SystemTools::GetCurrentDateTime("%Y%m%d.%H%M%S");
  header.MinimumResolution = std::clamp(this->Tolerance, 1e-6, 1e-3);
  header.Start.push_back(version + " IGES Writer. Unit mm. No medical device.");
  AddDescription(content, header.Start);
  lacuna::Properties properties;
  this->Describe(properties);
  vtkNew<vtkPolyData> record; // takes the steps of all inputs and this one
  lacuna::Provenance::Record(record, this, content.Inputs, properties.GetText());
  for (const std::string& step : lacuna::Provenance::Get(record))
  {
    header.Start.push_back("Made by: " + step);
  }
  return header;
}

//------------------------------------------------------------------------------
void vtkLacunaIGESWriter::SetResults(const lacuna::CADContent& content)
{
  for (const lacuna::CADSurface& surface : content.Surfaces)
  {
    this->MaximumDeviation = std::max(this->MaximumDeviation, surface.Fit.MaximumDeviation);
  }
  if (!content.Surfaces.empty())
  {
    const lacuna::BSplineSurface& first = content.Surfaces.front().Fit.Surface;
    this->NumberOfControlPoints[0] = static_cast<int>(first.U.GetSize());
    this->NumberOfControlPoints[1] = static_cast<int>(first.V.GetSize());
  }
  this->NumberOfSurfaces = static_cast<int>(content.Surfaces.size());
  this->NumberOfCurves =
    static_cast<int>(content.Curves.size() + content.Polygons.size() + content.Lines.size());
  this->NumberOfPoints = static_cast<int>(content.Points.size());
}

//------------------------------------------------------------------------------
void vtkLacunaIGESWriter::Describe(lacuna::Properties& properties) const
{
  Options(this).Describe(properties);
}

//------------------------------------------------------------------------------
void vtkLacunaIGESWriter::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "MaximumDeviation: " << this->MaximumDeviation << "\n";
  os << indent << "NumberOfControlPoints: " << this->NumberOfControlPoints[0] << " "
     << this->NumberOfControlPoints[1] << "\n";
  os << indent << "NumberOfSurfaces: " << this->NumberOfSurfaces << "\n";
  os << indent << "NumberOfCurves: " << this->NumberOfCurves << "\n";
  os << indent << "NumberOfPoints: " << this->NumberOfPoints << "\n";
}
