// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaRBFInterpolator.h"

#include "lacunaArrayName.h"
#include "lacunaArrays.h"
#include "lacunaCenterReduction.h"
#include "lacunaFieldData.h"
#include "lacunaMemory.h"
#include "lacunaRadialBasis.h"
#include "lacunaVolumeDirection.h"
#include "vtkAlgorithmOutput.h"
#include "vtkDataArray.h"
#include "vtkDataSet.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <vector>

vtkStandardNewMacro(vtkLacunaRBFInterpolator);

namespace
{
// Of the longest edge: how flat points are that lie in a plane across an axis.
constexpr double Flatness = 1e-9;
constexpr int AutomaticSteps = 100;

struct OutputGrid
{
  lacuna::RegularGrid<3> Grid;
  std::vector<std::size_t> Axes; // along which the points differ

  // With what the data set and the properties say. Throws when there is no such grid.
  OutputGrid(vtkDataSet* points, const double* spacing, const double* bounds)
  {
    double own[6];
    points->GetBounds(own);
    double longestOwn = 0;
    for (std::size_t c = 0; c < 3; ++c)
    {
      longestOwn = std::max(longestOwn, own[2 * c + 1] - own[2 * c]);
    }
    double longest = 0;
    double ends[6];
    for (std::size_t c = 0; c < 3; ++c)
    {
      if (own[2 * c + 1] - own[2 * c] > Flatness * longestOwn)
      {
        this->Axes.push_back(c);
      }
      const double* from = bounds[2 * c] > bounds[2 * c + 1] ? own : bounds;
      std::copy_n(from + 2 * c, 2, ends + 2 * c);
      if (!std::isfinite(ends[2 * c]) || !std::isfinite(ends[2 * c + 1]))
      {
        throw std::runtime_error("a point has a coordinate that is not a finite number; remove it "
                                 "(Threshold, or Clean to Grid)");
      }
      longest = std::max(longest, ends[2 * c + 1] - ends[2 * c]);
    }
    double count = 1;
    for (std::size_t c = 0; c < 3; ++c)
    {
      const bool flat = std::find(this->Axes.begin(), this->Axes.end(), c) == this->Axes.end();
      double step = spacing[c] > 0 ? spacing[c] : longest / AutomaticSteps;
      step = step > 0 ? step : 1;
      // Across points that are flat there is nothing to interpolate.
      const double steps = flat ? 0 : std::floor((ends[2 * c + 1] - ends[2 * c]) / step + 1e-9);
      if (steps >= std::numeric_limits<int>::max())
      {
        throw std::runtime_error("OutputSpacing is too small for OutputBounds");
      }
      this->Grid.Origin[c] = flat ? own[2 * c] : ends[2 * c];
      this->Grid.Spacing[c] = step;
      this->Grid.Size[c] = static_cast<std::int64_t>(steps) + 1;
      count *= steps + 1;
    }
    // It need not fit into the memory as a whole, but its points must have numbers.
    const double bytes = sizeof(double) * count;
    if (bytes >= static_cast<double>(std::numeric_limits<std::int64_t>::max()))
    {
      throw std::runtime_error(
        "OutputSpacing is too small for OutputBounds: the interpolated image "
        "would need " +
        lacuna::DescribeBytes(bytes) + ", more than there can be");
    }
  }

  // Of a part: a double for each component, and one more for that which is being computed.
  static void RequireMemory(const int piece[6], int components)
  {
    double count = 1;
    for (std::size_t c = 0; c < 3; ++c)
    {
      count *= static_cast<double>(piece[2 * c + 1]) - piece[2 * c] + 1;
    }
    lacuna::RequireMemory("the interpolated image", sizeof(double) * count * (components + 1.0));
  }
};

vtkDataArray* FindArray(vtkDataSet* points, const std::string& name, const char* property)
{
  vtkPointData* data = points->GetPointData();
  vtkDataArray* array = name.empty() ? data->GetScalars() : data->GetArray(name.c_str());
  if (!array)
  {
    std::ostringstream message;
    message << property << ": the input has no "
            << (name.empty() ? "active point scalars" : "numeric point array '" + name + "'")
            << "; its point arrays are";
    for (int i = 0; i < data->GetNumberOfArrays(); ++i)
    {
      message << (i ? ", '" : " '") << data->GetArrayName(i) << "'";
    }
    message << (data->GetNumberOfArrays() > 0 ? "" : " none");
    throw std::runtime_error(message.str());
  }
  return array;
}

// Through all nodes, or with a tolerance above 0 through few of them.
template <int Dimension>
lacuna::ReducedCenters<Dimension> Fit(lacuna::AlgorithmExecution& execution,
  const std::vector<std::array<double, Dimension>>& nodes,
  const std::vector<std::vector<double>>& values, const lacuna::RadialBasisOptions& options,
  double tolerance)
{
  if (tolerance > 0)
  {
    return lacuna::ReduceCenters<Dimension>(execution, nodes, values, options, tolerance);
  }
  lacuna::ReducedCenters<Dimension> all;
  all.Function =
    std::make_shared<const lacuna::RadialBasis<Dimension>>(execution, nodes, values, options);
  all.NodeCount = all.Function->GetReport().NodeCount;
  all.Residual = all.Function->GetReport().Residual;
  return all;
}

template <int Dimension>
void Interpolate(lacuna::AlgorithmExecution& execution, vtkDataSet* points, vtkDataArray* array,
  const OutputGrid& to, const int piece[6], const lacuna::RadialBasisOptions& options,
  double tolerance, vtkDoubleArray* image, vtkImageData* output)
{
  const vtkIdType n = points->GetNumberOfPoints();
  const int components = array->GetNumberOfComponents();
  std::vector<std::array<double, Dimension>> nodes(n);
  std::vector<std::vector<double>> values(components, std::vector<double>(n));
  for (vtkIdType i = 0; i < n; ++i)
  {
    double x[3];
    points->GetPoint(i, x);
    for (int c = 0; c < Dimension; ++c)
    {
      nodes[i][c] = x[to.Axes[c]];
    }
    for (int k = 0; k < components; ++k)
    {
      values[k][i] = array->GetComponent(i, k);
    }
  }
  execution.SetStage(0, 0.7);
  const lacuna::ReducedCenters<Dimension> fit =
    Fit<Dimension>(execution, nodes, values, options, tolerance);
  const lacuna::RadialBasis<Dimension>& function = *fit.Function;

  lacuna::RegularGrid<Dimension> grid;
  lacuna::GridPart<Dimension> part;
  for (int c = 0; c < Dimension; ++c)
  {
    grid.Origin[c] = to.Grid.Origin[to.Axes[c]];
    grid.Spacing[c] = to.Grid.Spacing[to.Axes[c]];
    grid.Size[c] = to.Grid.Size[to.Axes[c]];
    part[c] = { piece[2 * to.Axes[c]],
      std::min<std::int64_t>(piece[2 * to.Axes[c] + 1] + 1, grid.Size[c]) };
  }
  std::int64_t count = 1;
  for (const auto& range : part)
  {
    count *= range[1] - range[0];
  }
  image->SetNumberOfComponents(components);
  lacuna::Arrays::SetNumberOfTuples(image, count);
  std::vector<double> one(components > 1 ? count : 0);
  for (int k = 0; k < components; ++k)
  {
    execution.SetStage(0.7 + 0.3 * k / components, 0.7 + 0.3 * (k + 1) / components);
    double* to1 = components > 1 ? one.data() : image->GetPointer(0);
    function.EvaluateGrid(execution, grid, part, to1, k);
    for (std::int64_t i = 0; components > 1 && i < count; ++i)
    {
      image->SetTypedComponent(i, k, one[i]);
    }
  }
  const lacuna::RadialBasisReport& report = function.GetReport();
  lacuna::FieldData::Set(output, "NodeCount", { static_cast<double>(fit.NodeCount) }, 1);
  lacuna::FieldData::Set(output, "CenterCount", { static_cast<double>(report.NodeCount) }, 1);
  lacuna::FieldData::Set(output, "Residual", { fit.Residual }, 1);
  lacuna::FieldData::Set(output, "ConditionEstimate", { report.ConditionEstimate }, 1);
  lacuna::FieldData::Set(output, "Iterations", { static_cast<double>(report.Iterations) }, 1);
}
}

//------------------------------------------------------------------------------
void vtkLacunaRBFInterpolator::SetScalarArray(const char* name)
{
  lacuna::SetArrayName(this, this->ScalarArray, name);
}

//------------------------------------------------------------------------------
void vtkLacunaRBFInterpolator::SetErrorArray(const char* name)
{
  lacuna::SetArrayName(this, this->ErrorArray, name);
}

//------------------------------------------------------------------------------
int vtkLacunaRBFInterpolator::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkDataSet");
  return 1;
}

//------------------------------------------------------------------------------
void vtkLacunaRBFInterpolator::Announce(const lacuna::Ports& ports)
{
  this->UpdateInput(
    ports); // the grid follows from the points, and is asked for before any data are
  auto* points = ports.GetInput<vtkDataSet>();
  vtkInformation* info = ports.GetOutputInformation();
  int extent[6] = { 0, -1, 0, -1, 0, -1 };
  lacuna::VolumeDirection::AnnounceAlongAxes(info);
  if (points && points->GetNumberOfPoints() > 0)
  {
    this->CheckProperties();
    const OutputGrid to(points, this->OutputSpacing, this->OutputBounds);
    for (int c = 0; c < 3; ++c)
    {
      extent[2 * c + 1] = static_cast<int>(to.Grid.Size[c]) - 1;
    }
    info->Set(vtkDataObject::ORIGIN(), to.Grid.Origin.data(), 3);
    info->Set(vtkDataObject::SPACING(), to.Grid.Spacing.data(), 3);
    vtkDataObject::SetPointDataActiveScalarInfo(info, VTK_DOUBLE, -1);
  }
  info->Set(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), extent, 6);
}

//------------------------------------------------------------------------------
void vtkLacunaRBFInterpolator::Make(
  const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution)
{
  auto* points = ports.GetInput<vtkDataSet>(); // each value of the image depends on all of them
  auto* output = ports.GetOutput<vtkImageData>();
  output->GetFieldData()->Initialize(); // VTK passes the points' own
  lacuna::VolumeDirection::Check(points);
  if (this->CenterTolerance > 0 && !this->ErrorArray.empty())
  {
    throw std::runtime_error("ErrorArray cannot be used together with CenterTolerance, which "
                             "holds for all values alike: empty one, or set the other to 0");
  }
  const OutputGrid to(points, this->OutputSpacing, this->OutputBounds);
  vtkDataArray* array = FindArray(points, this->ScalarArray, "ScalarArray");
  lacuna::RadialBasisOptions options = this->GetOptions();
  options.Errors = this->GetErrors(points);
  int whole[6];
  int piece[6]; // of ranks, which share the evaluation: each fits for itself
  vtkInformation* info = ports.GetOutputInformation();
  info->Get(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), whole);
  info->Get(vtkStreamingDemandDrivenPipeline::UPDATE_EXTENT(), piece);
  for (std::size_t c = 0; c < 3; ++c)
  {
    if (whole[2 * c + 1] + 1 != static_cast<int>(to.Grid.Size[c]))
    {
      throw std::runtime_error("the points have changed since the grid was announced (points "
                               "that change with time?); set OutputBounds and OutputSpacing, "
                               "so that it does not depend on them");
    }
    piece[2 * c] = std::max(piece[2 * c], 0);
    piece[2 * c + 1] = std::min(piece[2 * c + 1], static_cast<int>(to.Grid.Size[c]) - 1);
  }
  to.RequireMemory(piece, array->GetNumberOfComponents());
  output->SetExtent(piece);
  output->SetOrigin(to.Grid.Origin.data());
  output->SetSpacing(to.Grid.Spacing.data());
  vtkNew<vtkDoubleArray> image;
  image->SetName(array->GetName() ? array->GetName() : "Values");
  switch (to.Axes.size())
  {
    case 3:
      Interpolate<3>(
        execution, points, array, to, piece, options, this->CenterTolerance, image, output);
      break;
    case 2:
      Interpolate<2>(
        execution, points, array, to, piece, options, this->CenterTolerance, image, output);
      break;
    default:
      throw std::runtime_error("all points lie at one place or on one line along an axis: that "
                               "does not determine a function in two or three dimensions");
  }
  output->GetPointData()->SetScalars(image);
}

//------------------------------------------------------------------------------
lacuna::RadialBasisOptions vtkLacunaRBFInterpolator::GetOptions() const
{
  lacuna::RadialBasisOptions options;
  options.Kernel = static_cast<lacuna::RadialKernel>(this->Kernel);
  options.Shape = this->KernelLength;
  options.Smoothing = this->Smoothing;
  options.Accuracy = this->Accuracy;
  options.Solver = static_cast<lacuna::RadialSolver>(this->Solver);
  return options;
}

//------------------------------------------------------------------------------
std::vector<double> vtkLacunaRBFInterpolator::GetErrors(vtkDataSet* points) const
{
  std::vector<double> list;
  if (!this->ErrorArray.empty())
  {
    vtkDataArray* errors = FindArray(points, this->ErrorArray, "ErrorArray");
    for (vtkIdType i = 0; i < errors->GetNumberOfTuples(); ++i)
    {
      list.push_back(errors->GetComponent(i, 0));
    }
  }
  return list;
}

//------------------------------------------------------------------------------
void vtkLacunaRBFInterpolator::Describe(lacuna::Properties& properties) const
{
  properties.Add("ScalarArray", this->ScalarArray).Add("ErrorArray", this->ErrorArray);
  this->GetOptions().Describe(properties);
  properties.Add("CenterTolerance", this->CenterTolerance, lacuna::ValueRange::AtLeast(0))
    .Add("OutputSpacing", this->OutputSpacing, lacuna::ValueRange::AtLeast(0))
    .Add("OutputBounds", this->OutputBounds, lacuna::ValueRange::Any());
}
