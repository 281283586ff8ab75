// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaMillingToolPath.h"

#include "lacunaArrays.h"
#include "lacunaCoordinates.h"
#include "lacunaFieldData.h"
#include "lacunaGridLayer.h"
#include "lacunaMaterialRemoval.h"
#include "lacunaParameterText.h"
#include "lacunaPressPosition.h"
#include "lacunaToolPath.h"
#include "vtkCellArray.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkInformation.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"
#include "vtkStringArray.h"
#include "vtkStructuredGrid.h"
#include "vtkTypeInt64Array.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

vtkStandardNewMacro(vtkLacunaMillingToolPath);

namespace
{
constexpr std::array<const char*, 2> PatternNames{ "ZigZag", "OneWay" };

//------------------------------------------------------------------------------
vtkSmartPointer<vtkPoints> MakePoints(const std::vector<lacuna::Vec3>& source)
{
  auto points = vtkSmartPointer<vtkPoints>::New();
  points->SetDataTypeToDouble();
  lacuna::Arrays::SetNumberOfPoints(points, static_cast<vtkIdType>(source.size()));
  double* to = vtkDoubleArray::SafeDownCast(points->GetData())->GetPointer(0);
  for (const lacuna::Vec3& p : source)
  {
    to = std::copy_n(p.data(), 3, to);
  }
  return points;
}

template <class Array>
Array* AddArray(vtkPolyData* output, const char* name)
{
  vtkNew<Array> array;
  array->SetName(name);
  lacuna::Arrays::SetNumberOfTuples(array, output->GetNumberOfPoints());
  output->GetPointData()->AddArray(array);
  return array;
}

//------------------------------------------------------------------------------
// Feed rates in mm/min by kind of motion.
using FeedRates = double[4];

struct Totals
{
  double Cutting = 0; // mm
  double All = 0;
  double Time = 0; // s
  double Positions = 0;
};

Totals SetPath(vtkPolyData* output, const lacuna::ToolPath& path, const FeedRates& feeds)
{
  output->SetPoints(MakePoints(path.Points));
  auto* motions = AddArray<vtkUnsignedCharArray>(output, vtkLacunaMillingToolPath::MotionName);
  auto* passes = AddArray<vtkIntArray>(output, vtkLacunaMillingToolPath::PassName);
  auto* rates = AddArray<vtkDoubleArray>(output, vtkLacunaMillingToolPath::FeedRateName);
  auto* times = AddArray<vtkDoubleArray>(output, vtkLacunaMillingToolPath::TimeName);
  vtkNew<vtkCellArray> lines;
  lacuna::Arrays::Reserve(lines, static_cast<vtkIdType>(path.Runs.size()),
    std::accumulate(path.Runs.begin(), path.Runs.end(), vtkIdType{ 0 },
      [](vtkIdType sum, const lacuna::ToolPath::Run& run) { return sum + run.Count; }));
  Totals totals;
  for (const lacuna::ToolPath::Run& run : path.Runs)
  {
    if (run.Count > 1)
    {
      lines->InsertNextCell(run.Count);
    }
    const double feed = feeds[static_cast<int>(run.Kind)];
    for (std::int64_t k = run.First; k < run.First + run.Count; ++k)
    {
      if (k > run.First)
      {
        const double length = lacuna::Norm(path.Points[k] - path.Points[k - 1]);
        totals.Time += 60 * length / feed;
        totals.All += length;
        if (run.Kind != lacuna::Motion::Rapid)
        {
          totals.Cutting += length;
          ++totals.Positions;
        }
      }
      if (run.Count > 1)
      {
        lines->InsertCellPoint(k);
      }
      motions->SetValue(k, static_cast<unsigned char>(run.Kind));
      passes->SetValue(k, run.Pass);
      rates->SetValue(k, feed);
      times->SetValue(k, totals.Time);
    }
  }
  output->SetLines(lines);
  output->GetPointData()->SetActiveScalars(vtkLacunaMillingToolPath::MotionName);
  return totals;
}

// Says in an output that its input had been moved by so many mm, so that there is no way from it to the
// patient.
void MarkMoved(vtkPolyData* output, double way)
{
  output->GetFieldData()->RemoveArray(lacuna::Coordinates::PressToPatientName);
  lacuna::Coordinates::Mark(output, lacuna::Coordinates::Press); // without that before the press
  lacuna::FieldData::Set(output, lacuna::PressPosition::MovedName, { way }, 1);
}

//------------------------------------------------------------------------------
void SetMap(vtkPolyData* output, const lacuna::LeftOverMap& map)
{
  output->SetPoints(MakePoints(map.Points));
  const auto copy = [&](const std::vector<double>& values, const char* name)
  {
    auto* array = AddArray<vtkDoubleArray>(output, name);
    std::copy(values.begin(), values.end(), array->GetPointer(0));
  };
  copy(map.LeftOver, "LeftOver");
  copy(map.Height, "MachinedHeight");
  copy(map.Unreachable, "Unreachable");
  output->GetPointData()->SetActiveScalars("LeftOver");
  const vtkIdType columns = map.Size.Columns;
  const vtkIdType cells = 2 * (columns - 1) * (map.Size.Rows - 1);
  vtkNew<vtkTypeInt64Array> corners;
  lacuna::Arrays::SetNumberOfTuples(corners, 3 * cells);
  vtkTypeInt64* to = corners->GetPointer(0);
  // seen from the mill's side they turn to the left
  const lacuna::Vec3 a = map.Points[1] - map.Points[0];
  const lacuna::Vec3 b = map.Points[columns] - map.Points[0];
  const bool left = lacuna::Cross(a, b)[2] > 0;
  for (vtkIdType j = 0; j + 1 < map.Size.Rows; ++j)
  {
    for (vtkIdType i = 0; i + 1 < columns; ++i)
    {
      const vtkIdType p = i + columns * j;
      const vtkIdType q = p + columns + 1;
      const vtkIdType sides[2] = { p + 1, p + columns };
      for (int k = 0; k < 2; ++k)
      {
        *to++ = p;
        *to++ = (k == 0) == left ? sides[k] : q;
        *to++ = (k == 0) == left ? q : sides[k];
      }
    }
  }
  lacuna::Arrays::SetTriangles(output, corners);
}

void SetNumbers(vtkPolyData* output, const char* name, const std::vector<double>& values)
{
  lacuna::FieldData::Set(output, name, values, static_cast<int>(values.size()));
}

void SetMeasures(vtkPolyData* output, const lacuna::ToolPath& path, const Totals& totals,
  const lacuna::LeftOverMap& map)
{
  SetNumbers(output, "StepOver", { path.SmallestStepOver, path.LargestStepOver });
  SetNumbers(output, "StockTop", { path.StockTop });
  SetNumbers(output, "SafeZ", { path.SafeZ });
  SetNumbers(output, "Levels", { static_cast<double>(path.Levels) });
  SetNumbers(output, "Positions", { totals.Positions });
  SetNumbers(output, "PathLength", { totals.Cutting, totals.All });
  SetNumbers(output, "MachiningTime", { totals.Time });
  SetNumbers(output, "LargestLeftOver", { map.LargestLeftOver });
  SetNumbers(output, "LargestGouge", { map.LargestGouge });
}

//------------------------------------------------------------------------------
// What to say of places where the tool does not fit; empty when it does.
std::string DescribeUnreachable(const lacuna::LeftOverMap& map, double radius, double limit)
{
  const auto worst = std::max_element(map.Unreachable.begin(), map.Unreachable.end());
  if (!(*worst > limit))
  {
    return {};
  }
  const auto count = std::count_if(
    map.Unreachable.begin(), map.Unreachable.end(), [limit](double left) { return left > limit; });
  const auto rounded = [](double x) { return lacuna::FormatNumber(std::round(100 * x) / 100); };
  const lacuna::Vec3& p = map.Points[worst - map.Unreachable.begin()];
  return "the tool (radius " + lacuna::FormatNumber(radius) + " mm) is too large for " +
    rounded(100 * static_cast<double>(count) / static_cast<double>(map.Unreachable.size())) +
    " % of the surface: it leaves up to " + rounded(*worst) + " mm there, most at x " +
    rounded(p[0]) + ", y " + rounded(p[1]) + ", z " + rounded(p[2]) +
    " (array Unreachable of the left-over map). A smaller tool reaches further";
}

//------------------------------------------------------------------------------
// What to say of a border that slopes down, whose lowest part a tool touches only from outside; empty
// when no more than limit is left there. beyond: whether the lines go on outside by its radius.
std::string DescribeBorder(const lacuna::LeftOverMap& map, double limit, bool beyond)
{
  const std::int64_t columns = map.Size.Columns;
  const std::int64_t rows = map.Size.Rows;
  double worst = 0;
  std::int64_t place = 0;
  for (std::int64_t k = 0; k < columns * rows; ++k)
  {
    const std::int64_t i = k % columns;
    const std::int64_t j = k / columns;
    const double left = map.LeftOver[k] - map.Unreachable[k];
    if ((i == 0 || j == 0 || i == columns - 1 || j == rows - 1) && left > worst)
    {
      worst = left;
      place = k;
    }
  }
  if (!(worst > limit))
  {
    return {};
  }
  const auto rounded = [](double x) { return lacuna::FormatNumber(std::round(100 * x) / 100); };
  return "up to " + rounded(worst) + " mm stay at the surface's border, most at x " +
    rounded(map.Points[place][0]) + ", y " + rounded(map.Points[place][1]) +
    ": it slopes down there, and the tool touches its edge only from outside. " +
    (beyond ? "Use a smaller tool, or make the surface larger"
            : "Set Overrun to the tool's radius");
}
}

//------------------------------------------------------------------------------
vtkLacunaMillingToolPath::vtkLacunaMillingToolPath()
{
  this->Sharing = lacuna::Share::FirstRank;
  this->TakesBlocks = true;
  this->SetNumberOfOutputPorts(2);
}

//------------------------------------------------------------------------------
int vtkLacunaMillingToolPath::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkStructuredGrid");
  return 1;
}

//------------------------------------------------------------------------------
void vtkLacunaMillingToolPath::Describe(lacuna::Properties& properties) const
{
  using lacuna::ValueRange;
  constexpr ValueRange Feeds = ValueRange::Above(0, "mm/min").UpTo(1e5);
  this->GetOptions().Describe(properties);
  properties.Add("Pattern", this->Pattern, PatternNames)
    .Add("FeedRate", this->FeedRate, Feeds)
    .Add("PlungeFeedRate", this->PlungeFeedRate, Feeds)
    .Add("RapidFeedRate", this->RapidFeedRate, ValueRange::Above(0, "mm/min").UpTo(1e6))
    .Add("SpindleSpeed", this->SpindleSpeed, ValueRange::Above(0, "1/min").UpTo(1e6))
    .Add("MapSpacing", this->MapSpacing,
      ValueRange::Above(0, "mm").UpTo(1000).OrZero("a quarter of the step-over"))
    .Add("LeftOverLimit", this->LeftOverLimit, ValueRange::Above(0, "mm").UpTo(1000));
}

//------------------------------------------------------------------------------
lacuna::ToolPathOptions vtkLacunaMillingToolPath::GetOptions() const
{
  lacuna::ToolPathOptions options;
  options.Tool = { static_cast<lacuna::ToolShape>(this->ToolShape), this->ToolRadius };
  options.StepOver = this->StepOver;
  options.ScallopHeight = this->ScallopHeight;
  options.Overrun = this->Overrun;
  options.Direction = this->Direction;
  options.OneWay = this->Pattern == OneWay;
  options.PathStep = this->PathStep;
  options.Tolerance = this->Tolerance;
  options.Finishing = this->Finishing;
  options.RoughingStep = this->RoughingStep;
  options.RoughingStepOver = this->RoughingStepOver;
  options.StockAllowance = this->StockAllowance;
  options.StockTop = this->StockTop;
  options.SafeHeight = this->SafeHeight;
  options.LeadRadius = this->LeadRadius;
  return options;
}

//------------------------------------------------------------------------------
double vtkLacunaMillingToolPath::GetBorderLimit(double stepOver) const
{
  const double r = this->ToolRadius;
  // what a dense path leaves on steep slopes, and so at borders, too
  const double half2 = std::max(0.0, r * r - 0.25 * stepOver * stepOver); // it may be 2 r and a bit
  const double steep = this->ToolShape == Ball ? 4 * (r - std::sqrt(half2)) : stepOver;
  return this->LeftOverLimit + steep;
}

//------------------------------------------------------------------------------
void vtkLacunaMillingToolPath::Make(
  const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution)
{
  auto* grid = ports.GetInput<vtkStructuredGrid>();
  lacuna::FieldData::Find(grid, lacuna::Coordinates::PressToPatientName, 16, 1);
  auto told = vtkSmartPointer<vtkStringArray>::New();
  told->SetName(WarningsName);
  const auto warn = [this, &told](const std::string& warning)
  {
    if (!warning.empty())
    {
      vtkWarningMacro(<< warning);
      told->InsertNextValue(warning);
    }
  };
  const std::string elsewhere = lacuna::PressPosition::Check(grid);
  warn(elsewhere);
  if (lacuna::Coordinates::IsMirrored(grid))
  {
    vtkWarningMacro("the surface is a mirror image of the patient (field data Mirrored), and so is "
                    "what is milled with this path");
  }
  lacuna::GridLayer layer(grid);
  const lacuna::MillSurface surface(layer.Size, std::move(layer.Points));
  const lacuna::ToolPathOptions options = this->GetOptions();
  execution.SetStage(0, 0.5);
  const lacuna::ToolPath path = lacuna::MakeToolPath(execution, surface, options);
  std::for_each(path.Warnings.begin(), path.Warnings.end(), warn);
  execution.SetStage(0.5, 0.95);
  const double step = path.SmallestStepOver > 0 ? path.SmallestStepOver : this->ToolRadius;
  const lacuna::LeftOverMap map = lacuna::MapLeftOver(
    execution, surface, options.Tool, path, this->MapSpacing > 0 ? this->MapSpacing : step / 4);
  if (this->MapSpacing > 0 && map.Spacing > this->MapSpacing * (1 + 1e-9))
  {
    vtkWarningMacro(<< "MapSpacing " << this->MapSpacing
                    << " mm would take more points than the map "
                    << "may have; they are up to " << map.Spacing << " mm apart");
  }
  warn(DescribeUnreachable(map, this->ToolRadius, this->LeftOverLimit));
  if (this->Finishing)
  {
    const bool isBeyond = this->Overrun >= this->ToolRadius;
    warn(DescribeBorder(map, this->GetBorderLimit(path.LargestStepOver), isBeyond));
  }

  auto* lines = ports.GetOutput<vtkPolyData>();
  auto* left = ports.GetOutput<vtkPolyData>(1);
  const Totals totals = SetPath(
    lines, path, { this->RapidFeedRate, this->PlungeFeedRate, this->FeedRate, this->FeedRate });
  SetMap(left, map);
  for (vtkPolyData* output : { lines, left })
  {
    output->GetFieldData()->ShallowCopy(grid->GetFieldData());
    output->GetFieldData()->RemoveArray(WarningsName); // those of Press Orientation
    output->GetFieldData()->AddArray(told);
    SetNumbers(output, "ToolShape", { static_cast<double>(this->ToolShape) });
    SetNumbers(output, "ToolRadius", { this->ToolRadius });
    SetNumbers(output, "SpindleSpeed", { this->SpindleSpeed });
    SetMeasures(output, path, totals, map);
    lacuna::PressPosition::Record(output);
    if (!elsewhere.empty())
    {
      MarkMoved(output, lacuna::PressPosition::FindMove(grid)->Way);
    }
  }
}
