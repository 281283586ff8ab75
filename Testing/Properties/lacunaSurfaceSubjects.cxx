// SPDX-License-Identifier: BSD-3-Clause
// Radial basis functions and fabrication.
#include "lacunaRandomData.h"
#include "lacunaSubject.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkIdTypeArray.h"
#include "vtkImageData.h"
#include "vtkIntArray.h"
#include "vtkLacunaDefectModel.h"
#include "vtkLacunaDepthMapSurface.h"
#include "vtkLacunaGCodeWriter.h"
#include "vtkLacunaIGESWriter.h"
#include "vtkLacunaImplantPlate.h"
#include "vtkLacunaMillingToolPath.h"
#include "vtkLacunaOutlinedStructures.h"
#include "vtkLacunaPressOrientation.h"
#include "vtkLacunaRBFHoleFiller.h"
#include "vtkLacunaRBFInterpolator.h"
#include "vtkLacunaRBFSurface.h"
#include "vtkLacunaSTEPWriter.h"
#include "vtkLacunaSkullImplant.h"
#include "vtkLacunaSkullResection.h"
#include "vtkLacunaSplineLoop.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSelection.h"
#include "vtkSelectionNode.h"
#include "vtkSphere.h"
#include "vtkSphereSource.h"
#include "vtkStructuredGrid.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <cmath>

namespace lacunaProperties
{
namespace
{
Inputs MakeFilledMap(Dice& dice)
{
  return { RandomDepthMap(dice, true, dice.Chance(0.2) ? 3 : 18) };
}

// An egg of rings of points: outer face, inner face, and a wall between them.
vtkSmartPointer<vtkPolyData> RandomSolid(Dice& dice)
{
  const int rings = dice.Whole(3, 12);
  const int around = dice.Whole(3, 24);
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (int j = 0; j <= rings; ++j)
  {
    const double angle = std::acos(-1.0) * j / rings;
    for (int i = 0; i < (j == 0 || j == rings ? 1 : around); ++i)
    {
      const double turn = 2 * std::acos(-1.0) * i / around;
      points->InsertNextPoint(20 * std::sin(angle) * std::cos(turn),
        14 * std::sin(angle) * std::sin(turn), 9 * std::cos(angle));
    }
  }
  vtkNew<vtkCellArray> cells;
  vtkNew<vtkUnsignedCharArray> faces;
  faces->SetName(dice.Chance(0.8) ? "ImplantFace" : "PlateFace");
  const auto add = [&](int ring, vtkIdType a, vtkIdType b, vtkIdType c)
  {
    cells->InsertNextCell({ a, b, c });
    faces->InsertNextValue(3 * ring < rings ? 0 : (3 * ring < 2 * rings ? 2 : 1));
  };
  const auto at = [&](int ring, int i) -> vtkIdType
  { return ring == 0 ? 0 : 1 + (ring - 1) * around + (ring == rings ? 0 : i % around); };
  for (int j = 0; j < rings; ++j)
  {
    for (int i = 0; i < around; ++i)
    {
      if (j > 0)
      {
        add(j, at(j, i), at(j + 1, i), at(j, i + 1));
      }
      if (j + 1 < rings)
      {
        add(j, at(j, i + 1), at(j + 1, i), at(j + 1, i + 1));
      }
    }
  }
  auto data = vtkSmartPointer<vtkPolyData>::New();
  data->SetPoints(points);
  data->SetPolys(cells);
  data->GetCellData()->SetScalars(faces);
  return data;
}

// Points on a map's plane, near its middle.
vtkSmartPointer<vtkPolyData> PointsOn(vtkImageData* map, Dice& dice)
{
  auto data = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkPoints> points;
  const int* extent = map->GetExtent();
  for (int i = dice.Whole(1, 3); i > 0; --i)
  {
    const double index[3] = { dice.Real(extent[0], extent[1]), dice.Real(extent[2], extent[3]),
      20 };
    double p[3];
    map->TransformContinuousIndexToPhysicalPoint(index, p);
    points->InsertNextPoint(p);
  }
  data->SetPoints(points);
  return data;
}

// Of some points of data.
vtkSmartPointer<vtkSelection> SelectOf(vtkDataSet* data, Dice& dice)
{
  vtkNew<vtkIdTypeArray> points;
  for (int i = dice.Whole(1, 40); i > 0 && data->GetNumberOfPoints() > 0; --i)
  {
    points->InsertNextValue(dice.Whole(0, static_cast<int>(data->GetNumberOfPoints()) - 1));
  }
  vtkNew<vtkSelectionNode> node;
  node->SetFieldType(vtkSelectionNode::POINT);
  node->SetContentType(vtkSelectionNode::INDICES);
  node->SetSelectionList(points);
  auto selection = vtkSmartPointer<vtkSelection>::New();
  selection->AddNode(node);
  return selection;
}

// What a map is marked by: a ball, or what a loop encloses.
std::string SetDefectRegion(vtkLacunaRBFHoleFiller* filter, Dice& dice, bool isHostile)
{
  const auto place = [&] { return isHostile ? HostileReal(dice) : dice.Real(-100, 100); };
  if (dice.Chance(0.5))
  {
    vtkNew<vtkSphere> sphere;
    sphere->SetCenter(dice.Real(-100, 100), dice.Real(-100, 100), dice.Real(-100, 100));
    sphere->SetRadius(isHostile ? HostileReal(dice) : dice.Real(1, 120));
    filter->SetDefectRegion(sphere);
    return "a sphere";
  }
  vtkNew<vtkLacunaSplineLoop> loop;
  const int points = isHostile ? dice.Whole(0, 4) : dice.Whole(3, 8);
  loop->SetNumberOfPoints(points);
  for (int i = 0; i < points; ++i)
  {
    const double x = place();
    const double y = place();
    loop->SetPoint(i, x, y, place());
  }
  loop->SetClosed(dice.Chance(0.7));
  filter->SetDefectRegion(loop);
  return "a loop of " + std::to_string(points) + " points";
}

Subject MakeHoleFiller()
{
  using T = vtkLacunaRBFHoleFiller;
  Subject subject{ "RBFHoleFiller", NewOf<T>,
    [](Dice& dice) -> Inputs
    {
      const auto map = RandomDepthMap(dice, false, 8);
      vtkSmartPointer<vtkPolyData> surface;
      if (dice.Chance(0.2))
      {
        vtkNew<vtkLacunaDepthMapSurface> mesher;
        mesher->SetInputData(map);
        mesher->Update();
        surface = mesher->GetOutput();
      }
      const auto points = dice.Chance(0.2) ? PointsOn(map, dice) : vtkSmartPointer<vtkPolyData>();
      vtkSmartPointer<vtkImageData> prior;
      if (dice.Chance(0.2))
      {
        prior = vtkSmartPointer<vtkImageData>::New();
        prior->DeepCopy(map);
      }
      const auto selection = dice.Chance(0.2)
        ? SelectOf(surface ? surface.Get() : static_cast<vtkDataSet*>(map), dice)
        : vtkSmartPointer<vtkSelection>();
      return { map, surface, selection, points, prior };
    },
    { Whole("Kernel", &T::SetKernel, 0, 5), Real("KernelLength", &T::SetKernelLength, 0, 10),
      Whole("Trend", &T::SetTrend, 0, 1), Other<T>("DefectRegion", SetDefectRegion),
      Word("DefectArray", &T::SetDefectArray, { "", "Defect", "None", "Depth" }),
      Word("SupportArray", &T::SetSupportArray, { "", "Defect", "vtkValidPointMask" }),
      Real("SupportMargin", &T::SetSupportMargin, 1, 20),
      Real("SupportStepMargin", &T::SetSupportStepMargin, 0, 3),
      Real("NodeSpacing", &T::SetNodeSpacing, 0.5, 4), Real("Smoothing", &T::SetSmoothing, 0, 10),
      Real("CutoffWavelength", &T::SetCutoffWavelength, 0, 10),
      Word("ControlDepthArray", &T::SetControlDepthArray, { "", "Value" }),
      Real("OutputMargin", &T::SetOutputMargin, 0, 5),
      Reals<3>("OutputSpacing", &T::SetOutputSpacing, 0.4, 2),
      Real("Accuracy", &T::SetAccuracy, 0, 0.01), Whole("Solver", &T::SetSolver, 0, 2) } };
  subject.MayBeNaN = { "Fitted", "Deviation", "HoleBoneThickness" };
  subject.Cost = 8;
  return subject;
}

Subject MakeInterpolator()
{
  using T = vtkLacunaRBFInterpolator;
  Subject subject{ "RBFInterpolator", NewOf<T>,
    [](Dice& dice) -> Inputs { return { RandomPoints(dice, dice.Chance(0.1) ? 0 : 4, 40) }; },
    { Word("ScalarArray", &T::SetScalarArray, { "", "Value", "None" }),
      Whole("Kernel", &T::SetKernel, 0, 5), Real("KernelLength", &T::SetKernelLength, 0, 10),
      Real("Smoothing", &T::SetSmoothing, 0, 10),
      Word("ErrorArray", &T::SetErrorArray, { "", "Error", "None" }),
      Real("Accuracy", &T::SetAccuracy, 0, 0.01), Whole("Solver", &T::SetSolver, 0, 2),
      Reals<3>("OutputSpacing", &T::SetOutputSpacing, 2, 10),
      Reals<6>("OutputBounds", &T::SetOutputBounds, -20, 20),
      Real("CenterTolerance", &T::SetCenterTolerance, 0, 10) } };
  subject.Prepare = [](vtkAlgorithm* algorithm) { Cast<T>(algorithm)->SetOutputSpacing(4, 4, 4); };
  subject.Cost = 4;
  return subject;
}

Subject MakeClosedSurface()
{
  using T = vtkLacunaRBFSurface;
  Subject subject{ "RBFSurface", NewOf<T>,
    [](Dice& dice) -> Inputs { return { RandomPoints(dice, dice.Chance(0.1) ? 0 : 4, 40) }; },
    { Whole("Kernel", &T::SetKernel, 0, 1), Real("Smoothing", &T::SetSmoothing, 0, 2),
      Real("Accuracy", &T::SetAccuracy, 0.001, 1), Real("Tolerance", &T::SetTolerance, 1e-4, 0.1),
      Word("ErrorArray", &T::SetErrorArray, { "", "Error", "None" }),
      Real("OutputSpacing", &T::SetOutputSpacing, 2, 10),
      Reals<6>("OutputBounds", &T::SetOutputBounds, -20, 20),
      Switch("CapBoundary", &T::SetCapBoundary) } };
  subject.Cost = 20;
  return subject;
}

// Ellipses in planes that turn a little, of one or two structures.
vtkSmartPointer<vtkPolyData> RandomOutlines(Dice& dice)
{
  auto lines = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkPoints> points;
  vtkNew<vtkCellArray> cells;
  vtkNew<vtkIntArray> structures;
  structures->SetName("Structure");
  const int count = dice.Whole(1, 5);
  for (int slice = 0; slice < count; ++slice)
  {
    const double tilt = dice.Real(-0.2, 0.2);
    const int corners = dice.Whole(6, 14);
    const double radius = dice.Real(5, 9);
    cells->InsertNextCell(corners + 1);
    const vtkIdType first = points->GetNumberOfPoints();
    for (int i = 0; i < corners; ++i)
    {
      const double angle = 2 * 3.14159265 * i / corners;
      const double x = radius * std::cos(angle);
      cells->InsertCellPoint(points->InsertNextPoint(
        x * std::cos(tilt), 0.8 * radius * std::sin(angle), 4 * slice + x * std::sin(tilt)));
    }
    cells->InsertCellPoint(first);
    structures->InsertNextValue(dice.Chance(0.8) ? 1 : 2);
  }
  lines->SetPoints(points);
  lines->SetLines(cells);
  lines->GetCellData()->AddArray(structures);
  return lines;
}

Subject MakeOutlinedStructures()
{
  using T = vtkLacunaOutlinedStructures;
  Subject subject{
    "OutlinedStructures", NewOf<T>, [](Dice& dice) -> Inputs { return { RandomOutlines(dice) }; },
    { Real("RegistrationError", &T::SetRegistrationError, 0, 3),
      Real("Smoothing", &T::SetSmoothing, 0, 2), Real("OutputSpacing", &T::SetOutputSpacing, 1, 5) }
  };
  subject.MayBeNaN = { "Volume (ml)", "Standard error (ml)", "Area (cm2)", "Largest diameter (mm)",
    "Centroid X (mm)", "Centroid Y (mm)", "Centroid Z (mm)" };
  subject.Cost = 20;
  return subject;
}

// A shell with a hole: few voxels, so that its shape is found in a second.
vtkSmartPointer<vtkImageData> RandomHead(Dice& dice)
{
  const double spacing = dice.Real(3, 4);
  const double radius = dice.Real(28, 34);
  const double hole = dice.Real(0.4, 0.6);
  auto image = vtkSmartPointer<vtkImageData>::New();
  const int half = static_cast<int>(radius / spacing) + 3;
  image->SetExtent(-half, half, -half, half, -half, half);
  image->SetSpacing(spacing, spacing, spacing);
  image->SetOrigin(dice.Real(-20, 20), 5, dice.Real(-20, 20));
  image->AllocateScalars(VTK_FLOAT, 1);
  auto* voxel = static_cast<float*>(image->GetScalarPointer());
  for (int k = -half; k <= half; ++k)
  {
    for (int j = -half; j <= half; ++j)
    {
      for (int i = -half; i <= half; ++i, ++voxel)
      {
        const double r = spacing * std::sqrt(i * i + 1.1 * j * j + k * k);
        const double angle = std::acos(0.9 * k * spacing / std::max(r, 1.0));
        const double depth =
          std::min({ radius - r, r - radius + 9, radius * (angle - hole), radius * (2.2 - angle) });
        *voxel = static_cast<float>(300 + 100 * std::max(-4.0, std::min(depth, 4.0)));
      }
    }
  }
  return image;
}

Subject MakeSkullImplant()
{
  using T = vtkLacunaSkullImplant;
  Subject subject{ "SkullImplant", NewOf<T>,
    [](Dice& dice) -> Inputs {
      return { RandomHead(dice), nullptr, RandomHead(dice) };
    },
    { Real("Level", &T::SetLevel, 200, 400), Whole("DefectChoice", &T::SetDefectChoice, 0, 1),
      Reals<3>("Point", &T::SetPoint, -30, 60), Real("EdgeClearance", &T::SetEdgeClearance, 0, 2),
      Real("Thickness", &T::SetThickness, 0, 6),
      Real("MinimumThickness", &T::SetMinimumThickness, 0, 4),
      Reals<3>("InsertionDirection", &T::SetInsertionDirection, -1, 1),
      Real("OuterOffset", &T::SetOuterOffset, -3, 3),
      Real("InnerOffset", &T::SetInnerOffset, -3, 3), Real("OffsetFade", &T::SetOffsetFade, 0, 20),
      Whole("Parts", &T::SetParts, 1, 3), Real("DrainageSpacing", &T::SetDrainageSpacing, 4, 12),
      Real("DrainageDiameter", &T::SetDrainageDiameter, 1, 3),
      Real("SutureSpacing", &T::SetSutureSpacing, 4, 12),
      Real("SutureDiameter", &T::SetSutureDiameter, 0.5, 2), Whole("Plates", &T::SetPlates, 0, 4),
      Real("ScrewDiameter", &T::SetScrewDiameter, 0.5, 2),
      Real("ScrewLength", &T::SetScrewLength, 1, 6), Real("RimDistance", &T::SetRimDistance, 2, 6),
      Real("TextHeight", &T::SetTextHeight, 2, 6), Real("TriangleSize", &T::SetTriangleSize, 2, 5),
      Real("Density", &T::SetDensity, 1, 5),
      Real("TemplateLevel", &T::SetTemplateLevel, 0, 400) } };
  subject.Prepare = [](vtkAlgorithm* algorithm) { Cast<T>(algorithm)->SetTriangleSize(4); };
  subject.Cost = 200;
  return subject;
}

vtkSmartPointer<vtkDataObject> RandomTumour(Dice& dice)
{
  vtkNew<vtkSphereSource> ball;
  ball->SetCenter(0, 25, 5);
  ball->SetRadius(dice.Real(4, 8));
  ball->Update();
  return ball->GetOutput();
}

Subject MakeSkullResection()
{
  using T = vtkLacunaSkullResection;
  Subject subject{ "SkullResection", NewOf<T>,
    [](Dice& dice) -> Inputs {
      return { RandomHead(dice), nullptr, RandomTumour(dice) };
    },
    { Real("Level", &T::SetLevel, 200, 400), Real("Margin", &T::SetMargin, 0, 8),
      Real("Bevel", &T::SetBevel, 0, 30), Real("GuideWidth", &T::SetGuideWidth, 3, 8),
      Real("GuideHeight", &T::SetGuideHeight, 2, 8),
      Real("GuideClearance", &T::SetGuideClearance, 0, 1),
      Real("GuideHole", &T::SetGuideHole, 0.5, 2) } };
  subject.Cost = 20;
  return subject;
}

Subject MakePlate()
{
  using T = vtkLacunaImplantPlate;
  Subject subject{ "ImplantPlate", NewOf<T>,
    [](Dice& dice) -> Inputs
    {
      const Inputs map = MakeFilledMap(dice);
      return { map[0],
        dice.Chance(0.2) ? PointsOn(vtkImageData::SafeDownCast(map[0]), dice)
                         : vtkSmartPointer<vtkPolyData>() };
    },
    { Real("Thickness", &T::SetThickness, 0.5, 5), Whole("Side", &T::SetSide, 0, 1),
      Real("EdgeClearance", &T::SetEdgeClearance, -1, 1),
      Whole("EdgeShape", &T::SetEdgeShape, 0, 2), Real("Bevel", &T::SetBevel, 0, 1),
      Switch("BevelBothFaces", &T::SetBevelBothFaces),
      Real("CornerRadius", &T::SetCornerRadius, 0, 2),
      Real("TriangleSize", &T::SetTriangleSize, 0.4, 2),
      Real("HoleDiameter", &T::SetHoleDiameter, 0.5, 3),
      Real("CountersinkDiameter", &T::SetCountersinkDiameter, 0, 4),
      Real("CountersinkAngle", &T::SetCountersinkAngle, 30, 150),
      Real("MinimumBoneThickness", &T::SetMinimumBoneThickness, 0, 5),
      Real("DrainageSpacing", &T::SetDrainageSpacing, 0, 8),
      Real("DrainageDiameter", &T::SetDrainageDiameter, 0.5, 2),
      Real("Density", &T::SetDensity, 1, 5) } };
  subject.Prepare = [](vtkAlgorithm* algorithm) { Cast<T>(algorithm)->SetTriangleSize(1); };
  subject.MayBeNaN = { "MinimumThickness", "MinimumCurvatureRadius", "TightestPoint" };
  subject.Cost = 40;
  return subject;
}

Subject MakeToolPath()
{
  using T = vtkLacunaMillingToolPath;
  Subject subject{ "MillingToolPath", NewOf<T>,
    [](Dice& dice) -> Inputs { return { RandomMould(dice) }; },
    { Whole("ToolShape", &T::SetToolShape, 0, 1), Real("ToolRadius", &T::SetToolRadius, 0.5, 8),
      Real("StepOver", &T::SetStepOver, 0.3, 3),
      Real("ScallopHeight", &T::SetScallopHeight, 0.005, 0.2),
      Real("Overrun", &T::SetOverrun, 0, 5), Real("Direction", &T::SetDirection, -180, 180),
      Whole("Pattern", &T::SetPattern, 0, 1), Switch("Finishing", &T::SetFinishing),
      Real("RoughingStep", &T::SetRoughingStep, 0.5, 5),
      Real("RoughingStepOver", &T::SetRoughingStepOver, 0.5, 5),
      Real("StockAllowance", &T::SetStockAllowance, 0, 1), Real("StockTop", &T::SetStockTop, -5, 5),
      Real("SafeHeight", &T::SetSafeHeight, 1, 10), Real("LeadRadius", &T::SetLeadRadius, 0, 3),
      Real("PathStep", &T::SetPathStep, 0.2, 2), Real("Tolerance", &T::SetTolerance, 0.002, 0.1),
      Real("FeedRate", &T::SetFeedRate, 10, 2000),
      Real("PlungeFeedRate", &T::SetPlungeFeedRate, 10, 900),
      Real("RapidFeedRate", &T::SetRapidFeedRate, 100, 9000),
      Real("SpindleSpeed", &T::SetSpindleSpeed, 100, 9000),
      Real("MapSpacing", &T::SetMapSpacing, 0.3, 2),
      Real("LeftOverLimit", &T::SetLeftOverLimit, 0, 1) } };
  subject.Cost = 8;
  return subject;
}

Inputs MakePath(Dice& dice)
{
  vtkNew<vtkLacunaMillingToolPath> path;
  path->SetInputData(vtkStructuredGrid::SafeDownCast(RandomMould(dice)));
  path->SetToolRadius(2);
  path->Update();
  auto output = vtkSmartPointer<vtkPolyData>::New();
  output->DeepCopy(path->GetOutput());
  return { output };
}
}

//------------------------------------------------------------------------------
void AddSurfaceSubjects(std::vector<Subject>& subjects)
{
  subjects.push_back(MakeHoleFiller());
  subjects.push_back(MakeInterpolator());
  subjects.push_back(MakeClosedSurface());
  subjects.push_back(MakeOutlinedStructures());
  subjects.push_back(MakePlate());
  subjects.push_back(MakeSkullImplant());
  subjects.push_back(MakeSkullResection());
  {
    using T = vtkLacunaDefectModel;
    subjects.push_back({ "DefectModel", NewOf<T>, MakeFilledMap,
      { Real("Margin", &T::SetMargin, 0, 10), Whole("FloorShape", &T::SetFloorShape, 0, 1),
        Real("DefectDepth", &T::SetDefectDepth, 1, 15),
        Real("BaseThickness", &T::SetBaseThickness, 1, 10),
        Real("MaximumHeight", &T::SetMaximumHeight, 0, 30) },
      20 });
  }
  {
    using T = vtkLacunaPressOrientation;
    subjects.push_back({ "PressOrientation", NewOf<T>,
      [](Dice& dice) -> Inputs
      {
        if (dice.Chance(0.2))
        {
          return { RandomSolid(dice) };
        }
        // flanges need a wide border: large as they are
        Dice own(dice.Seed());
        return { RandomDepthMap(own, true, dice.Chance(0.2) ? 18 : 90) };
      },
      { Whole("PlaneMethod", &T::SetPlaneMethod, 0, 1), Whole("Mould", &T::SetMould, 0, 1),
        Whole("Seating", &T::SetSeating, 0, 1),
        Real("PlateThickness", &T::SetPlateThickness, 0.3, 2),
        Real("PlateMargin", &T::SetPlateMargin, 0, 5),
        Real("FlangeWidth", &T::SetFlangeWidth, 5, 20),
        Reals<3>("BlockSize", &T::SetBlockSize, 0, 80),
        Real("OutputSpacing", &T::SetOutputSpacing, 0.5, 2),
        Whole("ConvexSide", &T::SetConvexSide, 0, 2) },
      20 });
  }
  subjects.push_back(MakeToolPath());
  {
    using T = vtkLacunaIGESWriter;
    Subject subject{ "IGESWriter", NewOf<T>,
      [](Dice& dice) -> Inputs
      {
        return { dice.Chance(0.4) ? vtkSmartPointer<vtkDataObject>(RandomMould(dice))
            : dice.Chance(0.7)    ? MakeFilledMap(dice)[0]
                                  : vtkSmartPointer<vtkDataObject>(RandomPoints(dice, 1, 20)) };
      },
      { Real("Tolerance", &T::SetTolerance, 0.001, 0.5),
        Whole("DefectOutline", &T::SetDefectOutline, 0, 2),
        Whole("Coordinates", &T::SetCoordinates, 0, 2),
        Switch("AllowMirrored", &T::SetAllowMirrored),
        Switch("SkipUnsupported", &T::SetSkipUnsupported) } };
    subject.SetFile = FileOf<T>("igs");
    subject.Cost = 20;
    subjects.push_back(subject);
  }
  {
    using T = vtkLacunaSTEPWriter;
    Subject subject{ "STEPWriter", NewOf<T>,
      [](Dice& dice) -> Inputs { return { RandomSolid(dice) }; },
      { Real("Tolerance", &T::SetTolerance, 0.001, 0.5),
        Switch("AllowMirrored", &T::SetAllowMirrored),
        Word("Note", &T::SetNote, { "", "for the mill" }) } };
    subject.SetFile = FileOf<T>("step");
    subject.Cost = 20;
    subjects.push_back(subject);
  }
  {
    using T = vtkLacunaGCodeWriter;
    Subject subject{ "GCodeWriter", NewOf<T>, MakePath,
      { Whole("ProgramNumber", &T::SetProgramNumber, 1, 9999),
        Whole("ToolNumber", &T::SetToolNumber, 1, 99),
        Whole("WorkOffset", &T::SetWorkOffset, 54, 59),
        Real("SpindleSpeed", &T::SetSpindleSpeed, 0, 9000),
        Switch("LineNumbers", &T::SetLineNumbers),
        Real("ArcTolerance", &T::SetArcTolerance, 0.001, 1),
        Reals<6>("Envelope", &T::SetEnvelope, -100, 100),
        Switch("AcceptWarnings", &T::SetAcceptWarnings),
        Switch("AllowMirrored", &T::SetAllowMirrored),
        Word("Header", &T::SetHeader, { "", "%\nO1\nG21 G90\n" }),
        Word("Footer", &T::SetFooter, { "", "M30\n%\n" }) } };
    subject.SetFile = FileOf<T>("nc");
    subject.Cost = 8;
    subjects.push_back(subject);
  }
}
}
