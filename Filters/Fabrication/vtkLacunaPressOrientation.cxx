// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaPressOrientation.h"

#include "lacunaArrays.h"
#include "lacunaCoordinates.h"
#include "lacunaFieldData.h"
#include "lacunaFittedPart.h"
#include "lacunaParameterText.h"
#include "lacunaPressPosition.h"
#include "lacunaPressSurface.h"
#include "vtkCharArray.h"
#include "vtkDataArray.h"
#include "vtkDataSet.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
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
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

vtkStandardNewMacro(vtkLacunaPressOrientation);

namespace
{
constexpr const char* PlaneNormalName = "PlaneNormal";
constexpr std::array<const char*, 2> PlaneMethodNames{ "Fit", "LeastSquares" };
constexpr double LargestInclination = 10; // degrees, of the fit's plane without a warning
// Degrees from the view to the one that faces the defect: below, there is no better one; above, what
// is measured along the rim tells too little.
constexpr double SquareView = 5;
constexpr double ObliqueView = 60;
constexpr double Degrees = 180 / 3.14159265358979323846;
constexpr double CoarsestSpacing = 1; // mm, when OutputSpacing is left to the filter
constexpr double SolidSpacing = 0.75; // mm between samples of a solid's face
constexpr double SteepestWall =
  60; // degrees: a sheet that is drawn over more has less than half of its thickness
constexpr double LargestDeviation = 0.05; // mm, of a solid's face, without a warning

std::vector<double> ToVector(const lacuna::Vec3& v)
{
  return { v[0], v[1], v[2] };
}
}

//------------------------------------------------------------------------------
// What is decided before the nodes are found.
class vtkLacunaPressOrientation::Plan
{
public:
  Plan(lacuna::Execution& execution, vtkLacunaPressOrientation* self, vtkDataObject* input)
    : Options(self->GetOptions())
    , Part(MakePart(execution, input, this->Options))
    , Surface(execution, this->Part.Size, this->Part.Depths, this->Part.Spacing)
  {
    if (this->Options.Spacing == 0)
    {
      this->Options.Spacing = std::min({ this->Part.Spacing[0], this->Part.Spacing[1],
        CoarsestSpacing, this->Options.FlangeWidth / lacuna::NodesPerFlange });
    }
    const lacuna::Vec3 flat = lacuna::FitPlaneNormal(
      this->Part.Size, this->Part.Depths, this->Part.Spacing, this->Part.Mask);
    lacuna::Vec3 normal = flat;
    vtkDataArray* given = lacuna::FieldData::Find(input, PlaneNormalName, 3, 1);
    this->IsSolid = vtkPolyData::SafeDownCast(input) != nullptr;
    this->HasPlane = given != nullptr || this->IsSolid;
    this->OwnPlane = self->PlaneMethod == Fit && this->HasPlane;
    if (this->OwnPlane && this->IsSolid)
    {
      normal = { 0, 0, -1 }; // it is seen from where its steepest place is least steep
    }
    else if (this->OwnPlane)
    {
      lacuna::Vec3 ofFit;
      given->GetTuple(0, ofFit.data());
      this->Inclination =
        Degrees * std::acos(std::min(1.0, std::abs(lacuna::Dot(lacuna::Normalized(ofFit), flat))));
      normal = ofFit;
    }
    this->Layout = this->Lay(execution, normal);
    if (!this->Layout.SingleValued)
    {
      this->FindWayOut(execution, flat);
    }
  }

  lacuna::PressSurface Make(lacuna::Execution& execution) const
  {
    return lacuna::MakePressSurface(execution, this->Surface, this->Part.Size, this->Part.Spacing,
      this->Part.Mask, this->Layout, this->Options, this->Part.ToWorld);
  }

  // Columns and rows of the output, 0 without a mould.
  int GetColumns() const { return static_cast<int>(this->Layout.Grid.Columns); }
  int GetRows() const { return static_cast<int>(this->Layout.Grid.Rows); }

  lacuna::PressOptions Options;
  lacuna::FittedPart Part;
  lacuna::ReliefSurface Surface;
  bool IsSolid = false;
  bool HasPlane = true;   // from the hole filler, or the best view of a solid
  bool OwnPlane = false;  // and it is what lies flat
  double Inclination = 0; // degrees, of the hole filler's plane to the least squares plane
  lacuna::PressLayout Layout;
  // When the mill does not see all: what gives a mould, in words, and the view, if it is another.
  std::string WayOut;
  bool HasView = false;
  lacuna::Vec3 View{}; // unit, world

private:
  static lacuna::FittedPart MakePart(
    lacuna::Execution& execution, vtkDataObject* input, const lacuna::PressOptions& options)
  {
    auto* solid = vtkPolyData::SafeDownCast(input);
    if (!solid)
    {
      return { vtkImageData::SafeDownCast(input), "a mould" };
    }
    // What the offset and a turn of the plane take is added. PlanPress refuses numbers below 0.
    const double margin = 1.3 * std::max(0.0, options.PlateMargin) +
      3 * std::max(0.0, options.PlateThickness) + 8 * SolidSpacing;
    return { execution, solid, SolidSpacing, margin, "a mould" };
  }

  lacuna::PressLayout Lay(lacuna::Execution& execution, const lacuna::Vec3& normal) const
  {
    return lacuna::PlanPress(execution, this->Surface, this->Part.Size, this->Part.Spacing,
      this->Part.Mask, normal, this->Options, this->Part.ToWorld);
  }

  bool IsSeen(lacuna::Execution& execution, const lacuna::Vec3& normal) const
  {
    try
    {
      return this->Lay(execution, normal).SingleValued;
    }
    catch (const lacuna::Aborted&)
    {
      throw;
    }
    catch (const std::runtime_error&)
    {
      return false; // the offset folds, or the flange leaves the map
    }
  }

  void FindWayOut(lacuna::Execution& execution, const lacuna::Vec3& flat)
  {
    if (this->OwnPlane && this->IsSeen(execution, flat))
    {
      this->WayOut = "Set PlaneMethod to LeastSquares, which gives a mould from this view (the "
                     "plane of the fit is inclined by " +
        lacuna::FormatNumber(std::round(this->Inclination)) +
        " degrees to the surface over the defect)";
      return;
    }
    if (this->IsSolid)
    {
      this->WayOut =
        "One mould cannot make it: take a smaller PlateMargin, a wider FlangeWidth, or "
        "make the implant in parts";
      return;
    }
    const std::string smaller =
      "take a smaller PlateMargin, another Kernel or more Smoothing of RBF Hole Filler, or make "
      "the plate in parts";
    const lacuna::Vec3 view = lacuna::FindFacingView(this->Surface, this->Part.Size,
      this->Part.Spacing, this->Part.Mask, this->Options.PlateMargin);
    const double turn = Degrees * std::acos(std::min(1.0, view[2])); // the map looks along z
    if (turn < SquareView)
    {
      this->WayOut = "Another view would not help, this one faces the defect squarely: " + smaller;
      return;
    }
    if (turn > ObliqueView)
    {
      this->WayOut = "This view looks along the bone so much that it does not tell which would be "
                     "right: make the depth map again from where the defect is faced squarely";
      return;
    }
    this->HasView = true;
    this->View = lacuna::Normalized(this->Part.ToWorld.Vector(view));
    this->WayOut = "Make the depth map again with ViewDirection";
    for (const double x : this->View.Elements)
    {
      this->WayOut += " " + lacuna::FormatNumber(x);
    }
    // without a margin Fitted may reach too little there
    this->WayOut +=
      " (field data SuggestedViewDirection), which faces the defect, and OutputMargin of "
      "RBF Hole Filler of at least " +
      lacuna::FormatNumber(std::ceil(this->Options.PlateMargin)) +
      (this->OwnPlane ? "; set PlaneMethod to LeastSquares" : "") + "; if that does not do, " +
      smaller;
  }
};

namespace
{
//------------------------------------------------------------------------------
void SetNodes(vtkStructuredGrid* output, const lacuna::PressSurface& surface, int columns, int rows)
{
  const auto count = static_cast<vtkIdType>(surface.Points.size());
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  lacuna::Arrays::SetNumberOfPoints(points, count);
  vtkNew<vtkUnsignedCharArray> regions;
  regions->SetName(vtkLacunaPressOrientation::PressRegionName);
  lacuna::Arrays::SetNumberOfTuples(regions, count);
  vtkNew<vtkCharArray> defect;
  defect->SetName(vtkLacunaPressOrientation::DefectMaskName);
  lacuna::Arrays::SetNumberOfTuples(defect, count);
  vtkNew<vtkDoubleArray> angles;
  angles->SetName(vtkLacunaPressOrientation::WallAngleName);
  lacuna::Arrays::SetNumberOfTuples(angles, count);
  for (vtkIdType k = 0; k < count; ++k)
  {
    points->SetPoint(k, surface.Points[k].data());
    regions->SetValue(k, static_cast<unsigned char>(surface.Regions[k]));
    defect->SetValue(k, static_cast<char>(surface.Defect[k]));
    angles->SetValue(k, surface.WallAngles[k]);
  }
  output->SetDimensions(columns, rows, 1);
  output->SetPoints(points);
  output->GetPointData()->SetScalars(regions);
  output->GetPointData()->AddArray(defect);
  output->GetPointData()->AddArray(angles);
  lacuna::PressPosition::Record(output);
}

void SetText(vtkDataObject* output, const char* name, const char* text)
{
  vtkNew<vtkStringArray> array;
  array->SetName(name);
  array->InsertNextValue(text);
  output->GetFieldData()->AddArray(array);
}
}

//------------------------------------------------------------------------------
int vtkLacunaPressOrientation::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkImageData");
  info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkPolyData");
  return 1;
}

//------------------------------------------------------------------------------
void vtkLacunaPressOrientation::Announce(const lacuna::Ports& ports)
{
  this->UpdateInput(ports); // the size of the grid depends on the defect
  int extent[6] = { 0, -1, 0, -1, 0, -1 };
  auto* map = ports.GetInput<vtkDataSet>();
  if (map && map->GetNumberOfPoints() > 0)
  {
    lacuna::AlgorithmExecution execution(this);
    const Plan plan(execution, this, map);
    if (plan.Layout.SingleValued)
    {
      extent[1] = plan.GetColumns() - 1;
      extent[3] = plan.GetRows() - 1;
      extent[5] = 0;
    }
  }
  ports.GetOutputInformation()->Set(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), extent, 6);
}

//------------------------------------------------------------------------------
void vtkLacunaPressOrientation::Make(
  const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution)
{
  auto* map = ports.GetInput<vtkDataSet>(); // or a solid
  auto* output = ports.GetOutput<vtkStructuredGrid>();
  output->GetFieldData()
    ->Initialize(); // VTK passes the map's, whose ImageToWorld is not of the grid
  execution.SetStage(0, 0.3);
  const Plan plan(execution, this, map);
  const lacuna::PressLayout& layout = plan.Layout;
  int whole[6];
  ports.GetOutputInformation()->Get(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), whole);
  if (layout.SingleValued && (whole[1] + 1 != plan.GetColumns() || whole[3] + 1 != plan.GetRows()))
  {
    throw std::runtime_error("the depth map has changed since the grid was announced (a source "
                             "that changes with time?); change a property and update again");
  }
  const lacuna::Matrix4& toWorld = plan.Part.ToWorld;
  if (this->PlaneMethod == Fit && !plan.HasPlane)
  {
    vtkWarningMacro(<< "the depth map has no field data array '" << PlaneNormalName
                    << "' (RBF Hole Filler reports it), so the least squares plane through "
                       "Fitted is laid flat instead");
  }
  if (layout.SingleValued && plan.Inclination > LargestInclination)
  {
    vtkWarningMacro(<< "the plane of the fit is inclined by "
                    << lacuna::FormatNumber(std::round(plan.Inclination))
                    << " degrees to the surface over the defect, so the mould is deeper on one "
                       "side; PlaneMethod LeastSquares lays it flatter");
  }
  if (layout.SingleValued)
  {
    execution.SetStage(0.3, 1);
    const lacuna::PressSurface surface = plan.Make(execution);
    SetNodes(output, surface, plan.GetColumns(), plan.GetRows());
    lacuna::FieldData::SetMatrices(
      output, lacuna::Coordinates::PressToPatientName, { toWorld * surface.PressToRelief });
    lacuna::FieldData::Set(output, "DraftAngle", { surface.DraftAngle }, 1);
    lacuna::FieldData::Set(output, "Depth", { surface.Depth }, 1);
    lacuna::FieldData::Set(output, "BlockSize", ToVector(surface.BlockSize), 3);
    this->WarnOfWalls(surface, toWorld);
    if (plan.IsSolid)
    {
      lacuna::FieldData::Set(output, "FaceDeviation", { plan.Part.Deviation }, 1);
      if (plan.Part.Deviation > LargestDeviation)
      {
        vtkWarningMacro(<< "the mould's surface is smooth, and up to "
                        << lacuna::FormatNumber(std::round(100 * plan.Part.Deviation) / 100)
                        << " mm from the outer face of the solid");
      }
    }
  }
  else
  {
    if (plan.HasView)
    {
      lacuna::FieldData::Set(output, SuggestedViewDirectionName, ToVector(plan.View), 3);
    }
    vtkWarningMacro(<< "the mill does not see all of the surface when its plane lies flat: at "
                    << lacuna::FormatPlace(toWorld, layout.SteepestPoint) << " it is "
                    << lacuna::FormatNumber(std::round(layout.SteepestAngle))
                    << " degrees from the press plane. There is no mould. " << plan.WayOut);
  }
  lacuna::FieldData::Set(
    output, "Angles", { Degrees * layout.Frame.Theta, Degrees * layout.Frame.Psi }, 2);
  lacuna::FieldData::Set(output, SingleValuedName, { layout.SingleValued ? 1.0 : 0.0 }, 1);
  lacuna::FieldData::Set(output, "SurfaceOffset", { layout.Offset }, 1);
  lacuna::FieldData::Set(output, "Outward", { layout.ConvexOutward ? 1.0 : 0.0 }, 1);
  SetText(output, "PlaneSource",
    plan.OwnPlane && plan.IsSolid ? "best direction of pressing"
      : plan.OwnPlane             ? "PlaneNormal of the hole filler"
                                  : "least squares plane through Fitted over the defect");

  lacuna::Coordinates::MarkPress(map, output);
}

//------------------------------------------------------------------------------
lacuna::PressOptions vtkLacunaPressOrientation::GetOptions() const
{
  lacuna::PressOptions options;
  options.Mould = static_cast<lacuna::PressMould>(this->Mould);
  options.Seating = static_cast<lacuna::PlateSeating>(this->Seating);
  options.Convex = static_cast<lacuna::ConvexSide>(this->ConvexSide);
  options.PlateThickness = this->PlateThickness;
  options.PlateMargin = this->PlateMargin;
  options.FlangeWidth = this->FlangeWidth;
  options.BlockSize = { this->BlockSize[0], this->BlockSize[1], this->BlockSize[2] };
  options.Spacing = this->OutputSpacing;
  return options;
}

//------------------------------------------------------------------------------
void vtkLacunaPressOrientation::Describe(lacuna::Properties& properties) const
{
  properties.Add("PlaneMethod", this->PlaneMethod, PlaneMethodNames);
  this->GetOptions().Describe(properties);
}

//------------------------------------------------------------------------------
void vtkLacunaPressOrientation::WarnOfWalls(
  const lacuna::PressSurface& surface, const lacuna::Matrix4& toWorld)
{
  const auto steepest = std::max_element(surface.WallAngles.begin(), surface.WallAngles.end()) -
    surface.WallAngles.begin();
  const double angle = surface.WallAngles[steepest];
  if (angle > SteepestWall)
  {
    const double left = this->PlateThickness * std::cos(angle / Degrees);
    vtkWarningMacro(<< "a sheet can hardly follow the mould: at "
                    << lacuna::FormatPlace(
                         toWorld * surface.PressToRelief, surface.Points[steepest])
                    << " mm, in the "
                    << (surface.Regions[steepest] == lacuna::PressRegion::Plate ? "plate"
                                                                                : "flange")
                    << ", the wall is " << lacuna::FormatNumber(std::round(angle))
                    << " degrees steep, where " << lacuna::FormatNumber(this->PlateThickness)
                    << " mm thin to about " << lacuna::FormatNumber(std::round(100 * left) / 100)
                    << " mm. Take a wider FlangeWidth, press in steps, or make the plate in parts");
  }
}
