// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaSliceOutliner.h"

#include "lacunaArrays.h"
#include "lacunaCoordinates.h"
#include "lacunaFieldData.h"
#include "lacunaMatrix4.h"
#include "lacunaMemory.h"
#include "lacunaParameterText.h"
#include "lacunaTrackedSlices.h"
#include "lacunaVector.h"
#include "lacunaVolumeDirection.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkIntArray.h"
#include "vtkLacunaOutlineTools.h"
#include "vtkMatrix4x4.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkStringArray.h"
#include "vtkStructuredGrid.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <set>
#include <sstream>
#include <stdexcept>
#include <utility>

vtkStandardNewMacro(vtkLacunaSliceOutliner);

namespace
{
using SDDP = vtkStreamingDemandDrivenPipeline;

// Told apart also by those who cannot tell red from green (Okabe and Ito 2008, without black).
constexpr std::array<std::array<unsigned char, 3>, 7> Palette{ { { 230, 159, 0 }, { 86, 180, 233 },
  { 0, 158, 115 }, { 240, 228, 66 }, { 213, 94, 0 }, { 204, 121, 167 }, { 0, 114, 178 } } };

void CheckNumbers(double structure, double outline, double slice)
{
  constexpr double most = 1 << 30;
  const auto isWhole = [](double value, double least)
  { return value >= least && value <= most && value == std::floor(value); };
  if (!isWhole(structure, 1) || !isWhole(outline, 0) || !isWhole(slice, -most))
  {
    throw std::runtime_error("OutlinePoints: a point has the structure " +
      lacuna::FormatNumber(structure) + ", the outline " + lacuna::FormatNumber(outline) +
      " and the slice " + lacuna::FormatNumber(slice) +
      "; they must be whole numbers, from 1 and from 0 on");
  }
}

// The outlines as closed lines with their arrays.
struct OutlineLines
{
  OutlineLines()
  {
    this->Points->SetDataTypeToDouble();
    this->Pixel->SetName("Pixel");
    this->Pixel->SetNumberOfComponents(3);
    this->IsHandle->SetName("Handle");
    this->Structures->SetName("Structure");
    this->Names->SetName("StructureName");
    this->Numbers->SetName("Outline");
    this->Slices->SetName("SliceNumber");
    this->Colors->SetName("StructureColor");
    this->Colors->SetNumberOfComponents(3);
  }

  // A curve in pixels of a slice; every so many steps a point of it is one that was given.
  void AddLine(vtkPoints* curve, int steps, int slice, const lacuna::Matrix4& pixelToSpace)
  {
    const vtkIdType begin = this->Points->GetNumberOfPoints();
    this->Lines->InsertNextCell(static_cast<int>(curve->GetNumberOfPoints() + 1));
    for (vtkIdType i = 0; i < curve->GetNumberOfPoints(); ++i)
    {
      double x[3];
      curve->GetPoint(i, x);
      const float at[3] = { static_cast<float>(x[0]), static_cast<float>(x[1]),
        static_cast<float>(slice) };
      this->Pixel->InsertNextTypedTuple(at);
      this->IsHandle->InsertNextValue(i % steps == 0 ? 1 : 0);
      this->Lines->InsertCellPoint(
        this->Points->InsertNextPoint(pixelToSpace.Point({ x[0], x[1], 0 }).data()));
    }
    this->Lines->InsertCellPoint(begin);
    this->Slices->InsertNextValue(slice);
  }

  void Set(vtkPolyData* output)
  {
    output->SetPoints(this->Points);
    output->SetLines(this->Lines);
    output->GetPointData()->AddArray(this->Pixel);
    output->GetPointData()->AddArray(this->IsHandle);
    output->GetCellData()->SetScalars(this->Structures);
    output->GetCellData()->AddArray(this->Names);
    output->GetCellData()->AddArray(this->Numbers);
    output->GetCellData()->AddArray(this->Slices);
    output->GetCellData()->AddArray(this->Colors);
  }

  vtkNew<vtkPoints> Points;
  vtkNew<vtkCellArray> Lines;
  vtkNew<vtkFloatArray> Pixel;
  vtkNew<vtkUnsignedCharArray> IsHandle;
  vtkNew<vtkIntArray> Structures;
  vtkNew<vtkStringArray> Names;
  vtkNew<vtkIntArray> Numbers;
  vtkNew<vtkIntArray> Slices;
  vtkNew<vtkUnsignedCharArray> Colors;
};
}

//------------------------------------------------------------------------------
// Where the slices of an image lie.
class vtkLacunaSliceOutliner::Slices
{
public:
  explicit Slices(vtkImageData* image)
    : Image(image)
  {
    const auto has = [image](const char* name)
    { return image->GetFieldData()->GetAbstractArray(name) != nullptr; };
    if (has(lacuna::TrackedSlices::ImageToReferenceName))
    {
      this->Tracked.emplace(image);
    }
    else if (has(lacuna::TrackedSlices::SliceStatusName) ||
      has(lacuna::TrackedSlices::FrameNumberName))
    {
      throw std::runtime_error(
        "the slices have no field data array 'ImageToReference': the probe is not "
        "calibrated, so that outlines have no place in mm. Give the reader a "
        "CalibrationFileName");
    }
    else
    {
      lacuna::VolumeDirection::Check(image);
    }
    const int* extent = image->GetExtent();
    for (int k = extent[4]; k <= extent[5]; ++k)
    {
      this->Numbers.push_back(
        this->Tracked ? static_cast<int>(this->Tracked->GetSliceNumber(k)) : k);
    }
  }

  // The slice of this number where it lies in space.
  void SetPicture(lacuna::AlgorithmExecution& execution, vtkDataArray* scalars, int number,
    vtkStructuredGrid* picture) const;

  int GetFirst() const { return this->Numbers.front(); }
  int GetLast() const { return this->Numbers.back(); }

  std::string DescribeRange() const
  {
    return "the slices are " + std::to_string(this->GetFirst()) + " to " +
      std::to_string(this->GetLast());
  }

  // Extent index of the slice that has this number.
  std::optional<int> FindIndex(int number) const
  {
    const auto found = std::find(this->Numbers.begin(), this->Numbers.end(), number);
    if (found == this->Numbers.end())
    {
      return {};
    }
    return this->Image->GetExtent()[4] + static_cast<int>(found - this->Numbers.begin());
  }

  // The number that is nearest to this one; of two the lower.
  int FindNearest(int number) const
  {
    return *std::min_element(this->Numbers.begin(), this->Numbers.end(),
      [number](int a, int b) { return std::abs(a - number) < std::abs(b - number); });
  }

  bool IsVolume() const { return !this->Tracked; }

  bool HasPlace(int number) const
  {
    return !this->Tracked ||
      this->Tracked->IsUsable(
        number, static_cast<unsigned char>(~lacuna::TrackedSlices::PoseInvalid));
  }

  // (column, row, 0, 1) of a slice to mm.
  lacuna::Matrix4 GetPixelToSpace(int number) const
  {
    if (this->Tracked)
    {
      return this->Tracked->GetImageToReference(number);
    }
    return lacuna::Matrix4(this->Image->GetIndexToPhysicalMatrix()->GetData()) *
      lacuna::Matrix4::Translation({ 0, 0, static_cast<double>(number) });
  }

  // Column and row of index 0, and their steps.
  std::array<double, 4> GetPixelGrid() const
  {
    const auto first = this->GetPixel(0, 0);
    const auto next = this->GetPixel(1, 1);
    return { first[0], first[1], next[0] - first[0], next[1] - first[1] };
  }

  // Column and row of an extent index.
  std::array<double, 2> GetPixel(int i, int j) const
  {
    if (!this->Tracked)
    {
      return { static_cast<double>(i), static_cast<double>(j) };
    }
    const double* origin = this->Image->GetOrigin();
    const double* spacing = this->Image->GetSpacing();
    return { origin[0] + i * spacing[0], origin[1] + j * spacing[1] };
  }

private:
  vtkImageData* Image;
  std::optional<lacuna::TrackedSlices> Tracked;
  std::vector<int> Numbers; // of the slices, from the extent's first on
};

//------------------------------------------------------------------------------
void vtkLacunaSliceOutliner::Slices::SetPicture(lacuna::AlgorithmExecution& execution,
  vtkDataArray* scalars, int number, vtkStructuredGrid* picture) const
{
  lacuna::FieldData::Set(picture, "SliceNumber", { static_cast<double>(number) }, 1);
  if (!this->HasPlace(number))
  {
    return;
  }
  const int k = this->FindIndex(number).value();
  const int* extent = this->Image->GetExtent();
  const int columns = extent[1] - extent[0] + 1;
  const int rows = extent[3] - extent[2] + 1;
  const lacuna::Matrix4 toSpace = this->GetPixelToSpace(number);
  picture->SetExtent(extent[0], extent[1], extent[2], extent[3], 0, 0);
  vtkNew<vtkPoints> places;
  places->SetDataTypeToDouble();
  const vtkIdType pixels = static_cast<vtkIdType>(columns) * rows;
  lacuna::Arrays::SetNumberOfPoints(places, pixels);
  const auto levels =
    vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(scalars->GetDataType()));
  levels->SetName(scalars->GetName() ? scalars->GetName() : "Intensity");
  lacuna::Arrays::SetNumberOfTuples(levels, pixels);
  levels->InsertTuples(0, pixels, pixels * (k - extent[4]), scalars);
  execution.For(rows, 16,
    [&](std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t j = begin; j < end; ++j)
      {
        for (int i = 0; i < columns; ++i)
        {
          const auto [column, row] = this->GetPixel(extent[0] + i, extent[2] + static_cast<int>(j));
          const lacuna::Vec3 x = toSpace.Point({ column, row, 0 });
          places->SetPoint(j * columns + i, x.data());
        }
      }
    });
  picture->SetPoints(places);
  picture->GetPointData()->SetScalars(levels);
  const std::array<double, 4> grid = this->GetPixelGrid();
  lacuna::FieldData::Set(picture, "PixelOrigin", { grid[0], grid[1] }, 2);
  lacuna::FieldData::Set(picture, "PixelStep", { grid[2], grid[3] }, 2);
  lacuna::FieldData::Set(picture, "PixelSize",
    { grid[2] * lacuna::Norm(toSpace.Column(0)), grid[3] * lacuna::Norm(toSpace.Column(1)) }, 2);
}

//------------------------------------------------------------------------------
vtkLacunaSliceOutliner::vtkLacunaSliceOutliner()
{
  this->Sharing = lacuna::Share::FirstRank;
  this->SetNumberOfOutputPorts(2);
}

//------------------------------------------------------------------------------
void vtkLacunaSliceOutliner::AddOutlinePoint(
  double structure, double outline, double slice, double column, double row)
{
  this->Points.push_back({ structure, outline, slice, column, row });
  this->Modified();
}

void vtkLacunaSliceOutliner::RemoveAllOutlinePoints()
{
  if (!this->Points.empty())
  {
    this->Points.clear();
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkLacunaSliceOutliner::AddStructureName(const char* name)
{
  this->Names.emplace_back(name ? name : "");
  this->Modified();
}

void vtkLacunaSliceOutliner::RemoveAllStructureNames()
{
  if (!this->Names.empty())
  {
    this->Names.clear();
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkLacunaSliceOutliner::AddStructureColor(double red, double green, double blue)
{
  this->Colors.push_back({ red, green, blue });
  this->Modified();
}

void vtkLacunaSliceOutliner::RemoveAllStructureColors()
{
  if (!this->Colors.empty())
  {
    this->Colors.clear();
    this->Modified();
  }
}

//------------------------------------------------------------------------------
std::string vtkLacunaSliceOutliner::GetName(int structure) const
{
  const auto n = static_cast<std::size_t>(structure) - 1;
  return n < this->Names.size() && !this->Names[n].empty()
    ? this->Names[n]
    : "Structure " + std::to_string(structure);
}

std::array<unsigned char, 3> vtkLacunaSliceOutliner::GetColor(int structure) const
{
  const auto n = static_cast<std::size_t>(structure) - 1;
  if (n >= this->Colors.size())
  {
    return Palette[n % Palette.size()];
  }
  std::array<unsigned char, 3> color;
  for (int c = 0; c < 3; ++c)
  {
    color[c] =
      static_cast<unsigned char>(std::lround(255 * std::clamp(this->Colors[n][c], 0.0, 1.0)));
  }
  return color;
}

//------------------------------------------------------------------------------
double* vtkLacunaSliceOutliner::GetInputGrid()
{
  auto* image = vtkImageData::SafeDownCast(this->GetInputDataObject(0, 0));
  std::fill(std::begin(this->InputGrid), std::end(this->InputGrid), 0);
  if (image &&
    !image->GetFieldData()->GetAbstractArray(lacuna::TrackedSlices::ImageToReferenceName))
  {
    std::copy_n(image->GetSpacing(), 3, this->InputGrid);
    std::copy_n(image->GetOrigin(), 3, this->InputGrid + 3);
  }
  return this->InputGrid;
}

//------------------------------------------------------------------------------
void vtkLacunaSliceOutliner::CheckGrid(vtkImageData* volume) const
{
  const double* known = this->VolumeGrid;
  if (known[0] == 0 || this->Points.empty())
  {
    return;
  }
  const double* spacing = volume->GetSpacing();
  const double* origin = volume->GetOrigin();
  for (int c = 0; c < 3; ++c)
  {
    constexpr double same = 1e-4; // voxels
    if (!(std::abs(spacing[c] - known[c]) <= same * std::abs(known[c]) &&
          std::abs(origin[c] - known[3 + c]) <= same * std::abs(known[c])))
    {
      std::ostringstream text;
      text
        << "the outlines were drawn in a volume with voxels of " << known[0] << " x " << known[1]
        << " x " << known[2] << " mm and the origin " << known[3] << ", " << known[4] << ", "
        << known[5] << "; this one has " << spacing[0] << " x " << spacing[1] << " x " << spacing[2]
        << " mm and " << origin[0] << ", " << origin[1] << ", " << origin[2]
        << ". Their columns, rows and slices would lie elsewhere in it. Give back that volume, or "
           "draw anew";
      throw std::runtime_error(text.str());
    }
  }
}

//------------------------------------------------------------------------------
int* vtkLacunaSliceOutliner::GetSliceRange()
{
  auto* image = vtkImageData::SafeDownCast(this->GetInputDataObject(0, 0));
  this->SliceRange[0] = this->SliceRange[1] = 0;
  if (image && image->GetNumberOfPoints() > 0)
  {
    try
    {
      const Slices slices(image);
      this->SliceRange[0] = slices.GetFirst();
      this->SliceRange[1] = slices.GetLast();
    }
    catch (const std::exception&) // which is told when data are asked for
    {
    }
  }
  return this->SliceRange;
}

//------------------------------------------------------------------------------
int vtkLacunaSliceOutliner::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkImageData");
  return 1;
}

int vtkLacunaSliceOutliner::FillOutputPortInformation(int port, vtkInformation* info)
{
  info->Set(vtkDataObject::DATA_TYPE_NAME(), port == 0 ? "vtkPolyData" : "vtkStructuredGrid");
  return 1;
}

//------------------------------------------------------------------------------
void vtkLacunaSliceOutliner::Announce(const lacuna::Ports& ports)
{
  int extent[6] = { 0, -1, 0, -1, 0, -1 };
  ports.GetInputInformation()->Get(SDDP::WHOLE_EXTENT(), extent);
  extent[4] = extent[5] = 0;
  ports.GetOutputInformation(1)->Set(SDDP::WHOLE_EXTENT(), extent, 6);
}

//------------------------------------------------------------------------------
void vtkLacunaSliceOutliner::Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution)
{
  auto* input = ports.GetInput<vtkImageData>();
  auto* output = ports.GetOutput<vtkPolyData>();
  auto* picture = ports.GetOutput<vtkStructuredGrid>(1);
  output->GetFieldData()->Initialize(); // VTK passes the slices' own
  picture->GetFieldData()->Initialize();
  vtkDataArray* scalars = input->GetPointData()->GetScalars();
  if (!scalars || scalars->GetNumberOfComponents() != 1)
  {
    throw std::runtime_error("the slices have no active point scalars with one component; "
                             "choose an array with one value per pixel");
  }
  const Slices slices(input);
  if (slices.IsVolume())
  {
    this->CheckGrid(input);
  }
  if (this->Slice < slices.GetFirst() || this->Slice > slices.GetLast())
  {
    throw std::runtime_error(
      "Slice " + std::to_string(this->Slice) + " is not there; " + slices.DescribeRange());
  }
  const int shown = slices.FindNearest(this->Slice);
  this->ShownSlice = shown;
  slices.SetPicture(execution, scalars, shown, picture);
  if (!slices.HasPlace(shown))
  {
    vtkWarningMacro(<< "slice " << shown
                    << " has no usable pose, so it has no place in mm and no picture");
  }
  this->MakeOutlines(slices, output);
}

//------------------------------------------------------------------------------
void vtkLacunaSliceOutliner::MakeOutlines(const Slices& slices, vtkPolyData* output)
{
  for (const Point& p : this->Points)
  {
    CheckNumbers(p.Structure, p.Outline, p.Slice);
  }
  OutlineLines lines;
  std::set<std::pair<int, int>> done;
  std::string leftOut;
  for (std::size_t next = 0; next < this->Points.size();)
  {
    const int structure = static_cast<int>(this->Points[next].Structure);
    const int outline = static_cast<int>(this->Points[next].Outline);
    const int slice = static_cast<int>(this->Points[next].Slice);
    const std::string what = "outline " + std::to_string(outline) + " of " +
      this->GetName(structure) + " in slice " + std::to_string(slice);
    if (!done.insert({ structure, outline }).second)
    {
      throw std::runtime_error(
        what + " has points in two places of OutlinePoints; put them together");
    }
    const vtkSmartPointer<vtkPoints> handles = this->TakeHandles(next, what);
    if (!slices.FindIndex(slice))
    {
      throw std::runtime_error(
        what + " is in a slice that is not there; " + slices.DescribeRange());
    }
    if (!slices.HasPlace(slice))
    {
      leftOut += (leftOut.empty() ? "" : "; ") + what;
      continue;
    }
    vtkNew<vtkPoints> curve;
    const int steps = vtkLacunaOutlineTools::MakeCurve(handles, this->Smooth, curve);
    double crossing[3];
    if (vtkLacunaOutlineTools::FindCrossing(curve, crossing))
    {
      vtkWarningMacro(<< what << " crosses itself at column " << crossing[0] << ", row "
                      << crossing[1] << ": the surface will be wrong there. Move its points");
    }
    lines.AddLine(curve, steps, slice, slices.GetPixelToSpace(slice));
    lines.Structures->InsertNextValue(structure);
    lines.Names->InsertNextValue(this->GetName(structure));
    lines.Numbers->InsertNextValue(outline);
    lines.Colors->InsertNextTypedTuple(this->GetColor(structure).data());
  }
  if (!leftOut.empty())
  {
    vtkWarningMacro(<< "left out, since their slices have no usable pose: " << leftOut);
  }
  lines.Set(output);
  this->NumberOfOutlines = static_cast<int>(done.size());
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkPoints> vtkLacunaSliceOutliner::TakeHandles(
  std::size_t& next, const std::string& what) const
{
  const Point first = this->Points[next];
  auto handles = vtkSmartPointer<vtkPoints>::New();
  handles->SetDataTypeToDouble();
  for (; next < this->Points.size() && this->Points[next].Structure == first.Structure &&
       this->Points[next].Outline == first.Outline;
       ++next)
  {
    const Point& p = this->Points[next];
    if (p.Slice != first.Slice)
    {
      throw std::runtime_error(what + " has a point in slice " + lacuna::FormatNumber(p.Slice) +
        "; an outline lies in one slice");
    }
    if (!std::isfinite(p.Column) || !std::isfinite(p.Row))
    {
      throw std::runtime_error(what + " has a point that is not finite; remove it");
    }
    handles->InsertNextPoint(p.Column, p.Row, 0);
  }
  const vtkIdType count = handles->GetNumberOfPoints();
  if (count < 3)
  {
    throw std::runtime_error(what + " has " + std::to_string(count) +
      (count == 1 ? " point" : " points") + "; it needs at least 3");
  }
  return handles;
}

//------------------------------------------------------------------------------
std::string vtkLacunaSliceOutliner::Parameters(int port) const
{
  lacuna::ParameterText text;
  return port == 1 ? text.Add("Slice", this->ShownSlice).Get()
                   : text.Add("Outlines", this->NumberOfOutlines)
                       .Add("OutlinePoints", static_cast<int>(this->Points.size()))
                       .Add("Smooth", this->Smooth)
                       .Get();
}

//------------------------------------------------------------------------------
void vtkLacunaSliceOutliner::Describe(lacuna::Properties& properties) const
{
  // of lists, how long they are
  properties.Add("OutlinePoints", this->Points.size())
    .Add("StructureNames", this->Names.size())
    .Add("StructureColors", this->Colors.size())
    .Add("Smooth", this->Smooth)
    .Add("Slice", this->Slice)
    .Add("VolumeGrid", this->VolumeGrid, lacuna::ValueRange::Any("mm"));
}
