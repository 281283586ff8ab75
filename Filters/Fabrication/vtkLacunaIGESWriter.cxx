// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaIGESWriter.h"

#include "lacunaAtomicFile.h"
#include "lacunaIGESDocument.h"
#include "lacunaSurfaceFit.h"
#include "vtkDataArray.h"
#include "vtkErrorCode.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkLacunaDepthMap.h"
#include "vtkLacunaExecution.h"
#include "vtkLacunaProvenance.h"
#include "vtkLogger.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkStructuredGrid.h"

#include <vtksys/SystemTools.hxx>

#include <algorithm>
#include <cmath>
#include <locale>
#include <new>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

vtkStandardNewMacro(vtkLacunaIGESWriter);

namespace
{
//------------------------------------------------------------------------------
// What is written of an input, and how the file describes it.
struct Result
{
  lacuna::SurfaceFit Fit;
  std::string Name;
  std::vector<std::string> Description;
};

//------------------------------------------------------------------------------
// The pixels of a map to be written, relative to its extent, and their depths.
struct Rectangle
{
  std::int64_t Column = 0;
  std::int64_t Row = 0;
  lacuna::GridSize Size;
  std::vector<double> Depths;
};

Rectangle FindRectangle(vtkDataArray* array, std::int64_t columns, std::int64_t rows)
{
  const std::string name = array->GetName() ? array->GetName() : "";
  if (array->GetNumberOfComponents() != 1 || array->GetNumberOfTuples() != columns * rows)
  {
    throw std::runtime_error("point array '" + name + "' has " +
      std::to_string(array->GetNumberOfTuples()) + " tuples of " +
      std::to_string(array->GetNumberOfComponents()) +
      " components; expected one number for each "
      "of the " +
      std::to_string(columns * rows) + " pixels");
  }
  std::int64_t first[2] = { columns, rows };
  std::int64_t last[2] = { -1, -1 };
  std::int64_t present = 0;
  for (std::int64_t j = 0; j < rows; ++j)
  {
    for (std::int64_t i = 0; i < columns; ++i)
    {
      if (std::isfinite(array->GetComponent(i + columns * j, 0)))
      {
        ++present;
        first[0] = std::min(first[0], i);
        last[0] = std::max(last[0], i);
        first[1] = std::min(first[1], j);
        last[1] = std::max(last[1], j);
      }
    }
  }
  if (present == 0)
  {
    throw std::runtime_error("point array '" + name +
      "' is not a number (or infinite) at every pixel: there is no surface to write");
  }
  Rectangle rectangle;
  rectangle.Column = first[0];
  rectangle.Row = first[1];
  rectangle.Size = { last[0] - first[0] + 1, last[1] - first[1] + 1 };
  const std::int64_t wanted = rectangle.Size.Columns * rectangle.Size.Rows;
  if (present < wanted)
  {
    std::ostringstream message;
    message << "the surface has holes: " << wanted - present << " of the " << wanted
            << " pixels of columns " << first[0] << " to " << last[0] << ", rows " << first[1]
            << " to " << last[1] << " have no " << name
            << ". Run RBF Hole Filler on the depth map first and write its output";
    throw std::runtime_error(message.str());
  }
  rectangle.Depths.reserve(wanted);
  for (std::int64_t j = first[1]; j <= last[1]; ++j)
  {
    for (std::int64_t i = first[0]; i <= last[0]; ++i)
    {
      rectangle.Depths.push_back(array->GetComponent(i + columns * j, 0));
    }
  }
  return rectangle;
}

//------------------------------------------------------------------------------
Result FitMap(
  vtkImageData* image, const lacuna::SurfaceFitOptions& options, lacuna::Execution& execution)
{
  const vtkLacunaDepthMap map(image);
  vtkDataArray* fitted = image->GetPointData()->GetArray(vtkLacunaDepthMap::FittedName);
  const int* extent = image->GetExtent();
  const Rectangle rectangle = FindRectangle(fitted ? fitted : map.GetDepth(),
    std::int64_t{ extent[1] } - extent[0] + 1, std::int64_t{ extent[3] } - extent[2] + 1);
  const double column = static_cast<double>(extent[0] + rectangle.Column);
  const double row = static_cast<double>(extent[2] + rectangle.Row);

  Result result;
  if (!map.IsPerspective())
  {
    result.Fit = lacuna::FitHeights(execution, rectangle.Size, rectangle.Depths,
      map.GetImageToWorld() * lacuna::Matrix4::Translation({ column, row, 0 }), options);
  }
  else
  {
    std::vector<lacuna::Vec3> points;
    points.reserve(rectangle.Depths.size());
    for (std::int64_t j = 0; j < rectangle.Size.Rows; ++j)
    {
      for (std::int64_t i = 0; i < rectangle.Size.Columns; ++i)
      {
        points.push_back(map.GetPoint(column + static_cast<double>(i), row + static_cast<double>(j),
          rectangle.Depths[points.size()]));
      }
    }
    result.Fit = lacuna::FitPoints(execution, rectangle.Size, points, options);
  }
  result.Name = fitted ? "Fitted surface" : "Depth map surface";
  std::ostringstream where;
  where.imbue(std::locale::classic());
  where << "From a depth map, columns " << column << " to "
        << column + static_cast<double>(rectangle.Size.Columns - 1) << ", rows " << row << " to "
        << row + static_cast<double>(rectangle.Size.Rows - 1)
        << ". Patient coordinates (DICOM LPS). u runs along the columns, v along the rows; dS/du x "
           "dS/dv points away from the viewer.";
  result.Description.push_back(where.str());
  return result;
}

//------------------------------------------------------------------------------
Result FitGrid(
  vtkStructuredGrid* grid, const lacuna::SurfaceFitOptions& options, lacuna::Execution& execution)
{
  int dimensions[3];
  grid->GetDimensions(dimensions);
  std::vector<std::int64_t> size;
  for (const int d : dimensions)
  {
    if (d != 1)
    {
      size.push_back(d);
    }
  }
  if (size.size() != 2)
  {
    std::ostringstream message;
    message << "the structured grid has " << dimensions[0] << " x " << dimensions[1] << " x "
            << dimensions[2] << " points; a surface has exactly one dimension of 1";
    throw std::runtime_error(message.str());
  }
  if (grid->HasAnyBlankPoints() || grid->HasAnyBlankCells())
  {
    throw std::runtime_error(
      "the structured grid has blanked points or cells; a surface without holes is needed");
  }
  std::vector<lacuna::Vec3> points(grid->GetNumberOfPoints());
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    grid->GetPoint(static_cast<vtkIdType>(i), points[i].data());
  }
  Result result;
  const lacuna::GridSize gridSize{ size[0], size[1] };
  lacuna::CheckRegular(gridSize, points);
  result.Fit = lacuna::FitPoints(execution, gridSize, points, options);
  result.Name = "Structured surface";
  result.Description.emplace_back(
    "From a structured grid, in its coordinates. u runs along its first dimension, v along its "
    "second.");
  return result;
}
}

//------------------------------------------------------------------------------
vtkLacunaIGESWriter::~vtkLacunaIGESWriter()
{
  this->SetFileName(nullptr);
}

//------------------------------------------------------------------------------
int vtkLacunaIGESWriter::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkImageData");
  info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkStructuredGrid");
  return 1;
}

//------------------------------------------------------------------------------
int vtkLacunaIGESWriter::Write()
{
  this->FileSize = 0;
  this->Superclass::Write();
  if (this->FileSize == 0 && this->GetErrorCode() == vtkErrorCode::NoError)
  {
    // VTK does not come to WriteData when a filter upstream fails or has nothing
    this->SetErrorCode(vtkErrorCode::UnknownError);
    vtkErrorMacro("nothing was written: there is no input, or a filter before this one failed");
  }
  return this->GetErrorCode() == vtkErrorCode::NoError ? 1 : 0;
}

//------------------------------------------------------------------------------
void vtkLacunaIGESWriter::WriteData()
{
  this->MaximumDeviation = 0;
  this->NumberOfControlPoints[0] = this->NumberOfControlPoints[1] = 0;
  this->FileSize = 0;
  unsigned long code = vtkErrorCode::UnknownError;
  std::string error;
  try
  {
    this->WriteSurface();
    return;
  }
  catch (const lacuna::FileError& e)
  {
    code = e.GetKind() == lacuna::FileError::Kind::NoSpace ? vtkErrorCode::OutOfDiskSpaceError
                                                           : vtkErrorCode::CannotOpenFileError;
    error = e.what();
  }
  catch (const lacuna::Aborted&)
  {
    this->SetErrorCode(vtkErrorCode::UserError); // no file, but no error message either
    return;
  }
  catch (const std::bad_alloc&)
  {
    error = "out of memory";
  }
  catch (const std::exception& e)
  {
    error = e.what();
  }
  if (!this->FileName || !*this->FileName)
  {
    code = vtkErrorCode::NoFileNameError;
  }
  this->SetErrorCode(code);
  vtkErrorMacro(<< error);
}

//------------------------------------------------------------------------------
void vtkLacunaIGESWriter::WriteSurface()
{
  if (!this->FileName || !*this->FileName)
  {
    throw std::runtime_error("no FileName is given");
  }
  vtkLacunaExecution execution(this);
  execution.SetStage(0, 0.9);
  lacuna::SurfaceFitOptions options;
  options.Tolerance = this->Tolerance;
  vtkDataObject* input = this->GetInput();
  auto* image = vtkImageData::SafeDownCast(input);
  auto* grid = vtkStructuredGrid::SafeDownCast(input);
  if (!image && !grid)
  {
    throw std::runtime_error("the input is neither a depth map nor a structured grid");
  }
  const Result result =
    image ? FitMap(image, options, execution) : FitGrid(grid, options, execution);
  const lacuna::BSplineSurface& surface = result.Fit.Surface;

  lacuna::IGESHeader header;
  const std::string version = std::string("Lacuna ") + vtkLacunaProvenance::GetVersion();
  header.FileName = vtksys::SystemTools::GetFilenameName(this->FileName);
  header.System = version;
  header.Preprocessor = version + " IGES Writer";
  header.Date = vtksys::SystemTools::GetCurrentDateTime("%Y%m%d.%H%M%S");
  header.MinimumResolution = std::clamp(this->Tolerance, 1e-6, 1e-3);
  header.Start.push_back(version + " IGES Writer. One bicubic B-spline surface, unit mm.");
  header.Start.insert(header.Start.end(), result.Description.begin(), result.Description.end());
  std::ostringstream achieved;
  achieved.imbue(std::locale::classic());
  achieved << "Largest deviation from the samples " << result.Fit.MaximumDeviation << " mm, "
           << surface.U.GetSize() << " x " << surface.V.GetSize() << " control points.";
  header.Start.push_back(achieved.str());
  for (const std::string& step : vtkLacunaProvenance::Get(input))
  {
    header.Start.push_back("Made by: " + step);
  }

  lacuna::IGESDocument document;
  lacuna::IGESDocument::Attributes attributes;
  attributes.Label = "SURFACE";
  attributes.Colour = -static_cast<int>(document.AddColour(0.9, 0.85, 0.7, "Bone"));
  document.AddSurface(surface, attributes, { document.AddName(result.Name) });
  const std::string text = document.GetText(header);
  execution.SetStage(0.9, 1);
  execution.Report(0);
  lacuna::WriteFileAtomically(this->FileName, text);
  execution.Report(1);

  this->MaximumDeviation = result.Fit.MaximumDeviation;
  this->NumberOfControlPoints[0] = static_cast<int>(surface.U.GetSize());
  this->NumberOfControlPoints[1] = static_cast<int>(surface.V.GetSize());
  this->FileSize = static_cast<vtkTypeInt64>(text.size());
  vtkLog(INFO, << "IGES Writer: " << this->FileName << ", " << this->FileSize << " bytes, "
               << this->NumberOfControlPoints[0] << " x " << this->NumberOfControlPoints[1]
               << " control points, largest deviation " << this->MaximumDeviation << " mm");
}

//------------------------------------------------------------------------------
void vtkLacunaIGESWriter::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "FileName: " << (this->FileName ? this->FileName : "(none)") << "\n";
  os << indent << "Tolerance: " << this->Tolerance << "\n";
  os << indent << "MaximumDeviation: " << this->MaximumDeviation << "\n";
  os << indent << "NumberOfControlPoints: " << this->NumberOfControlPoints[0] << " "
     << this->NumberOfControlPoints[1] << "\n";
  os << indent << "FileSize: " << this->FileSize << "\n";
}
