// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaRBFSurface.h"

#include "lacunaArrayName.h"
#include "lacunaArrays.h"
#include "lacunaBlendedSpline.h"
#include "lacunaFieldData.h"
#include "lacunaFunctionText.h"
#include "lacunaMemory.h"
#include "lacunaOutlines.h"
#include "lacunaPointNormals.h"
#include "lacunaSurfaceFollower.h"
#include "lacunaSurfacePoints.h"
#include "lacunaSurfacePrior.h"
#include "lacunaSurfaceSpline.h"
#include "lacunaVolumeDirection.h"
#include "vtkDataSet.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkImplicitFunction.h"
#include "vtkInformation.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <vector>

vtkStandardNewMacro(vtkLacunaRBFSurface);

namespace
{
using lacuna::Vec3;

constexpr std::array<const char*, 2> KernelNames{ "Biharmonic", "Triharmonic" };

// Normals from neighbours share their errors with these, so that held-out ones are predicted too well:
// they are to say the side mostly.
constexpr double EstimatedNormalError = 0.5;
// Of the longest extent of the points.
constexpr double BoundsMargin = 0.25;
constexpr double FinestEdge = 1.0 / 200;
constexpr double FinestOfOutlines = 1.0 / 100;
constexpr double CoarsestEdge = 1.0 / 40;
constexpr double TooCoarse = 0.1;
constexpr double LargestTolerance = 0.05; // of the edge
constexpr double ManyMissed = 0.02;       // RMS residual, of the extent
// Of all points, with an opposite normal beside them: above, these are not merely thin walls.
constexpr double MostOpposed = 0.02;

double GetExtent(const std::array<double, 6>& bounds)
{
  return std::max({ bounds[1] - bounds[0], bounds[3] - bounds[2], bounds[5] - bounds[4] });
}

vtkFloatArray* AddArray(vtkPolyData* output, const char* name, vtkIdType tuples)
{
  vtkNew<vtkFloatArray> array;
  array->SetName(name);
  lacuna::Arrays::SetNumberOfTuples(array, tuples);
  output->GetPointData()->AddArray(array);
  return array;
}

void SetSurface(vtkPolyData* output, const lacuna::FollowedSurface& followed)
{
  const auto n = static_cast<vtkIdType>(followed.Surface.Points.size());
  vtkNew<vtkPoints> points;
  points->SetDataTypeToFloat();
  lacuna::Arrays::SetNumberOfPoints(points, n);
  vtkNew<vtkFloatArray> normals;
  normals->SetName("Normals");
  normals->SetNumberOfComponents(3);
  lacuna::Arrays::SetNumberOfTuples(normals, n);
  for (vtkIdType i = 0; i < n; ++i)
  {
    points->SetPoint(i, followed.Surface.Points[i].data());
    normals->SetTuple(i, followed.Normals[i].data());
  }
  output->SetPoints(points);
  lacuna::Arrays::SetTriangles(output, followed.Surface.Triangles);
  output->GetPointData()->SetNormals(normals);
}

// Distances of points from the surface, positive outside, to first order.
std::vector<double> GetResiduals(lacuna::Execution& execution,
  const lacuna::ImplicitFunction& function, const std::vector<Vec3>& points)
{
  std::vector<double> values(points.size());
  std::vector<Vec3> gradients(points.size());
  function.Evaluate(execution, points, values, &gradients);
  for (std::size_t i = 0; i < values.size(); ++i)
  {
    const double slope = lacuna::Norm(gradients[i]);
    values[i] = slope > 0 ? values[i] / slope : values[i];
  }
  return values;
}

struct Misses
{
  explicit Misses(const std::vector<double>& residuals)
  {
    double sum = 0;
    for (const double r : residuals)
    {
      sum += r * r / static_cast<double>(residuals.size());
      this->Largest = std::max(this->Largest, std::abs(r));
    }
    this->RootMeanSquare = std::sqrt(sum);
  }

  double RootMeanSquare;
  double Largest = 0;
};

struct InputPoints
{
  const std::vector<Vec3>& Places;
  std::vector<double> Residuals;
  double Spacing;
};

// What the surface's points have from the nearest ones of the input.
void AddPointData(lacuna::Execution& execution, vtkPolyData* output,
  const std::vector<Vec3>& places, const InputPoints& input)
{
  const auto n = static_cast<vtkIdType>(places.size());
  vtkFloatArray* distance = AddArray(output, "Distance", n);
  vtkFloatArray* residual = AddArray(output, "Residual", n);
  vtkFloatArray* support = AddArray(output, "Support", n);
  const lacuna::PointNeighbors neighbors(input.Places);
  execution.For(n, 1024,
    [&](std::int64_t begin, std::int64_t end)
    {
      std::vector<std::size_t> nearest;
      std::vector<double> away;
      for (std::int64_t i = begin; i < end; ++i)
      {
        neighbors.Find(places[i], 1, nearest, &away);
        distance->SetValue(i, static_cast<float>(away[0]));
        residual->SetValue(i, static_cast<float>(input.Residuals[nearest[0]]));
        support->SetValue(i, static_cast<float>(input.Spacing > 0 ? away[0] / input.Spacing : 0));
      }
    });
}

void SetNumber(vtkPolyData* output, const char* name, double value)
{
  lacuna::FieldData::Set(output, name, { value }, 1);
}

void AddReport(vtkPolyData* output, const lacuna::BlendedSplineReport& report, bool hasPrior)
{
  if (hasPrior)
  {
    SetNumber(output, "PriorUsed", report.UsesPrior ? 1 : 0);
  }
  SetNumber(output, "PointError", report.PointError);
  SetNumber(output, "NormalError", std::atan(report.Spline.NormalError) * 180 / std::acos(-1.0));
  SetNumber(output, "CenterCount", static_cast<double>(report.Centers));
}

void RequireMemoryOfSurface(std::size_t points, double spacing, double edge)
{
  // each point stands for a square of the spacing
  const double squares = static_cast<double>(points) * spacing * spacing / (edge * edge);
  constexpr double bytesPerSquare = 1500; // cells, nodes and triangles
  lacuna::RequireMemory(
    "a surface of such small triangles (choose a larger OutputSpacing)", bytesPerSquare * squares);
}
}

vtkLacunaRBFSurface::vtkLacunaRBFSurface()
{
  this->Sharing = lacuna::Share::FirstRank;
  this->TakesEmpty = true; // an error
  this->SetNumberOfInputPorts(2);
  this->SetNumberOfOutputPorts(2);
}

vtkLacunaRBFSurface::~vtkLacunaRBFSurface() = default;

//------------------------------------------------------------------------------
void vtkLacunaRBFSurface::RemovePriorSurface()
{
  this->SetInputConnection(1, nullptr);
}

//------------------------------------------------------------------------------
void vtkLacunaRBFSurface::SetErrorArray(const char* name)
{
  lacuna::SetArrayName(this, this->ErrorArray, name);
}

void vtkLacunaRBFSurface::SetSideArray(const char* name)
{
  lacuna::SetArrayName(this, this->SideArray, name);
}

//------------------------------------------------------------------------------
void vtkLacunaRBFSurface::SetPriorFunction(vtkImplicitFunction* function)
{
  if (this->PriorFunction != function)
  {
    this->PriorFunction = function;
    this->Modified();
  }
}

vtkImplicitFunction* vtkLacunaRBFSurface::GetPriorFunction() const
{
  return this->PriorFunction;
}

vtkMTimeType vtkLacunaRBFSurface::GetMTime()
{
  const vtkMTimeType own = this->Superclass::GetMTime();
  return this->PriorFunction ? std::max(own, this->PriorFunction->GetMTime()) : own;
}

//------------------------------------------------------------------------------
int vtkLacunaRBFSurface::FillInputPortInformation(int port, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkDataSet");
  info->Set(vtkAlgorithm::INPUT_IS_REPEATABLE(), port == 0 ? 1 : 0);
  info->Set(vtkAlgorithm::INPUT_IS_OPTIONAL(), port == 0 ? 0 : 1);
  return 1;
}

//------------------------------------------------------------------------------
int vtkLacunaRBFSurface::FillOutputPortInformation(int port, vtkInformation* info)
{
  info->Set(vtkDataObject::DATA_TYPE_NAME(), port == 0 ? "vtkPolyData" : "vtkImageData");
  return 1;
}

//------------------------------------------------------------------------------
bool vtkLacunaRBFSurface::HasOutputBounds() const
{
  const double* b = this->OutputBounds;
  return b[0] <= b[1] && b[2] <= b[3] && b[4] <= b[5];
}

//------------------------------------------------------------------------------
void vtkLacunaRBFSurface::Announce(const lacuna::Ports& ports)
{
  int extent[6] = { 0, -1, 0, -1, 0, -1 };
  const double h = this->DistanceSpacing;
  vtkInformation* info = ports.GetOutputInformation(1);
  lacuna::VolumeDirection::AnnounceAlongAxes(info);
  if (h > 0 && std::isfinite(h) && this->HasOutputBounds())
  {
    lacuna::Vec3 origin;
    for (int c = 0; c < 3; ++c)
    {
      origin[c] = this->OutputBounds[2 * c];
      constexpr double most = 1 << 16; // more is refused when it is made
      extent[2 * c + 1] =
        static_cast<int>(std::min(most, (this->OutputBounds[2 * c + 1] - origin[c]) / h + 1e-6));
    }
    const lacuna::Vec3 spacing{ h, h, h };
    info->Set(vtkDataObject::ORIGIN(), origin.data(), 3);
    info->Set(vtkDataObject::SPACING(), spacing.data(), 3);
    vtkDataObject::SetPointDataActiveScalarInfo(info, VTK_FLOAT, 1);
  }
  info->Set(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), extent, 6);
}

//------------------------------------------------------------------------------
void vtkLacunaRBFSurface::Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution)
{
  auto* distances = ports.GetOutput<vtkImageData>(1);
  distances->GetFieldData()->Initialize(); // VTK passes that of the input, which may be turned
  const auto start = std::chrono::steady_clock::now();
  execution.SetStage(0, 0.05);
  lacuna::SurfacePoints collected = this->CollectPoints(ports, execution);
  lacuna::OrientedPoints& points = collected.Data;
  const std::array<double, 6> own = collected.GetBounds();
  this->CheckDistanceGrid(own);
  const std::unique_ptr<const lacuna::SurfacePrior> prior =
    this->FindPrior(ports, GetExtent(own), collected.Warnings);
  const double spacing = collected.FindSpacing(execution);
  this->CheckNormals(execution, points, 0.5 * spacing);

  // the error of a volume takes as many fits again
  const double fitEnd = collected.HasOutlines ? 0.35 : 0.65;
  const double followEnd = fitEnd + 0.25;
  execution.SetStage(0.05, fitEnd);
  const lacuna::BlendedSplineOptions options = this->GetFitOptions(collected);
  if (collected.HasOutlines)
  {
    lacuna::FindOutlineNormals(execution, points, options);
  }
  else
  {
    points.Free.clear();
  }
  const lacuna::BlendedSpline fit(execution, points, options, prior.get());
  this->CheckSides(fit.GetReport());

  execution.SetStage(fitEnd, followEnd);
  const lacuna::SurfaceFollowerOptions follow = this->GetFollowerOptions(collected, own, spacing);
  RequireMemoryOfSurface(points.Points.size(), spacing, follow.EdgeLength);
  const lacuna::FollowedSurface followed =
    lacuna::FollowSurface(execution, fit, points.Points, follow);
  const bool isClosed = this->CheckSurface(followed, collected.Warnings);

  execution.SetStage(followEnd, followEnd + 0.05);
  const InputPoints input{ points.Points, GetResiduals(execution, fit, points.Points), spacing };
  auto* output = ports.GetOutput<vtkPolyData>();
  SetSurface(output, followed);
  AddPointData(execution, output, followed.Surface.Points, input);
  if (isClosed)
  {
    SetNumber(output, "SurfaceVolume", followed.Surface.GetVolume() / 1000);
  }
  const Misses misses(input.Residuals);
  this->CheckMisses(misses.RootMeanSquare, GetExtent(own));
  if (collected.HasOutlines && isClosed)
  {
    execution.SetStage(followEnd + 0.05, 0.95);
    const double error = lacuna::EstimateVolumeError(
      execution, points, options, fit.GetReport().Spline, followed.Surface);
    SetNumber(output, "SurfaceVolumeError", error / 1000);
  }
  SetNumber(output, "SurfaceArea", followed.Surface.GetArea());
  SetNumber(output, "ResidualRMS", misses.RootMeanSquare);
  SetNumber(output, "ResidualMaximum", misses.Largest);
  AddReport(output, fit.GetReport(), prior != nullptr);
  SetNumber(output, "FitTime",
    std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  if (this->DistanceSpacing > 0)
  {
    execution.SetStage(0.95, 1);
    this->SetDistances(execution, followed.Surface, distances);
  }
}

//------------------------------------------------------------------------------
lacuna::SurfacePoints vtkLacunaRBFSurface::CollectPoints(
  const lacuna::Ports& ports, lacuna::Execution& execution)
{
  lacuna::SurfacePoints collected;
  collected.ErrorArray = this->ErrorArray;
  collected.SideArray = this->SideArray;
  for (int i = 0; i < this->GetNumberOfInputConnections(0); ++i)
  {
    auto* data = ports.GetInput<vtkDataSet>(0, i);
    if (auto* image = vtkImageData::SafeDownCast(data))
    {
      lacuna::VolumeDirection::Check(image);
    }
    collected.Add(execution, data, i + 1);
  }
  if (collected.Data.Points.empty())
  {
    throw std::runtime_error("the input has no points of a surface");
  }
  collected.Check();
  return collected;
}

//------------------------------------------------------------------------------
std::unique_ptr<const lacuna::SurfacePrior> vtkLacunaRBFSurface::FindPrior(
  const lacuna::Ports& ports, double extent, std::vector<std::string>& warnings)
{
  if (this->PriorFunction)
  {
    return std::make_unique<lacuna::SurfacePrior>(this->PriorFunction, extent);
  }
  if (this->GetNumberOfInputConnections(1) > 0)
  {
    auto* data = ports.GetInput<vtkDataSet>(1);
    if (data && data->GetNumberOfPoints() > 0)
    {
      return std::make_unique<lacuna::SurfacePrior>(data);
    }
    warnings.push_back("PriorSurface has no points and does not count");
  }
  return nullptr;
}

//------------------------------------------------------------------------------
lacuna::BlendedSplineOptions vtkLacunaRBFSurface::GetFitOptions(
  const lacuna::SurfacePoints& collected) const
{
  lacuna::BlendedSplineOptions options;
  options.Kernel =
    this->Kernel == Triharmonic ? lacuna::RadialKernel::Cubic : lacuna::RadialKernel::Linear;
  options.PointError = this->Smoothing;
  options.Accuracy = this->Accuracy;
  options.LeastNormalError = collected.HasEstimatedNormals ? EstimatedNormalError : 0;
  if (collected.HasOutlines)
  {
    options.LeastNormalError = std::max(options.LeastNormalError, lacuna::OutlineNormalError);
  }
  options.Inside = collected.Inside;
  options.Outside = collected.Outside;
  return options;
}

//------------------------------------------------------------------------------
lacuna::SurfaceFollowerOptions vtkLacunaRBFSurface::GetFollowerOptions(
  lacuna::SurfacePoints& collected, const std::array<double, 6>& own, double spacing) const
{
  lacuna::SurfaceFollowerOptions follow;
  const double extent = GetExtent(own);
  // points along outlines are denser than these
  const double finest = collected.HasOutlines ? FinestOfOutlines : FinestEdge;
  follow.EdgeLength = this->OutputSpacing > 0
    ? this->OutputSpacing
    : std::clamp(spacing, finest * extent, CoarsestEdge * extent);
  follow.Tolerance = std::min(this->Tolerance, LargestTolerance * follow.EdgeLength);
  if (follow.EdgeLength > TooCoarse * extent)
  {
    collected.Warnings.push_back("OutputSpacing is more than a tenth of the points' extent: the "
                                 "triangles cut off curves, and the volume is theirs");
  }
  follow.Cap = this->CapBoundary;
  for (int c = 0; c < 3; ++c)
  {
    const bool given = this->OutputBounds[2 * c] <= this->OutputBounds[2 * c + 1];
    follow.Bounds[2 * c] = given ? this->OutputBounds[2 * c] : own[2 * c] - BoundsMargin * extent;
    follow.Bounds[2 * c + 1] =
      given ? this->OutputBounds[2 * c + 1] : own[2 * c + 1] + BoundsMargin * extent;
  }
  return follow;
}

//------------------------------------------------------------------------------
std::vector<vtkDataObject*> vtkLacunaRBFSurface::GetOrigins(const lacuna::Ports& ports) const
{
  std::vector<vtkDataObject*> origins = this->lacuna::Algorithm::GetOrigins(ports);
  if (this->PriorFunction) // takes the place of the surface
  {
    auto* surface = ports.GetInput<vtkDataObject>(1);
    origins.erase(std::remove(origins.begin(), origins.end(), surface), origins.end());
  }
  return origins;
}

//------------------------------------------------------------------------------
void vtkLacunaRBFSurface::Describe(lacuna::Properties& properties) const
{
  constexpr lacuna::ValueRange size = lacuna::ValueRange::Above(0, "mm");
  properties.Add("Kernel", this->Kernel, KernelNames)
    .Add("Smoothing", this->Smoothing, size.OrZero("estimated"))
    .Add("Accuracy", this->Accuracy, size)
    .Add("Tolerance", this->Tolerance, size)
    .Add("ErrorArray", this->ErrorArray)
    .Add("OutputSpacing", this->OutputSpacing, size.OrZero("automatic"))
    .Add("OutputBounds", this->OutputBounds, lacuna::ValueRange::Any("mm"))
    .Add("CapBoundary", this->CapBoundary)
    .Add("SideArray", this->SideArray)
    .Add("PriorFunction", lacuna::FunctionText::Describe(this->PriorFunction))
    .Add("DistanceSpacing", this->DistanceSpacing, size.OrZero("no image"));
}

//------------------------------------------------------------------------------
void vtkLacunaRBFSurface::CheckDistanceGrid(const std::array<double, 6>& own)
{
  if (!(this->DistanceSpacing > 0))
  {
    return;
  }
  if (!this->CapBoundary)
  {
    throw std::runtime_error("DistanceSpacing needs CapBoundary: an open surface has no inside");
  }
  if (!this->HasOutputBounds())
  {
    std::ostringstream message;
    message << "DistanceSpacing needs OutputBounds on all axes; the points and a margin have";
    const double margin = BoundsMargin * GetExtent(own);
    for (int c = 0; c < 3; ++c)
    {
      message << " " << std::floor(own[2 * c] - margin) << " "
              << std::ceil(own[2 * c + 1] + margin);
    }
    throw std::runtime_error(message.str());
  }
  double voxels = 1;
  for (int c = 0; c < 3; ++c)
  {
    voxels *=
      (this->OutputBounds[2 * c + 1] - this->OutputBounds[2 * c]) / this->DistanceSpacing + 1;
  }
  lacuna::RequireMemory(
    "the signed distance (choose a larger DistanceSpacing)", sizeof(float) * voxels);
}

//------------------------------------------------------------------------------
void vtkLacunaRBFSurface::CheckSides(const lacuna::BlendedSplineReport& report)
{
  if (report.WrongSides > 0)
  {
    const Vec3& x = report.WrongSideAt;
    vtkWarningMacro(<< "the surface has " << report.WrongSides << " of the points with a "
                    << this->SideArray << " on the wrong side, one at (" << x[0] << ", " << x[1]
                    << ", " << x[2]
                    << ") mm: points of the surface contradict it. Correct one of them, or give a "
                       "larger Smoothing");
  }
}

//------------------------------------------------------------------------------
void vtkLacunaRBFSurface::CheckMisses(double rootMeanSquare, double extent)
{
  if (rootMeanSquare > ManyMissed * extent)
  {
    vtkWarningMacro(<< "the surface misses the points by " << rootMeanSquare
                    << " mm (RMS): there are too few, or their normals or the outlines "
                       "contradict each other. Colour by Residual to see where");
  }
}

//------------------------------------------------------------------------------
void vtkLacunaRBFSurface::SetDistances(
  lacuna::Execution& execution, const lacuna::TriangleSurface& surface, vtkImageData* distances)
{
  int size[3];
  for (int c = 0; c < 3; ++c)
  {
    size[c] = 1 +
      static_cast<int>(
        (this->OutputBounds[2 * c + 1] - this->OutputBounds[2 * c]) / this->DistanceSpacing + 1e-6);
  }
  distances->SetDimensions(size);
  distances->SetOrigin(this->OutputBounds[0], this->OutputBounds[2], this->OutputBounds[4]);
  distances->SetSpacing(this->DistanceSpacing, this->DistanceSpacing, this->DistanceSpacing);
  vtkNew<vtkFloatArray> values;
  values->SetName("SignedDistance");
  lacuna::Arrays::SetNumberOfTuples(values, distances->GetNumberOfPoints());
  distances->GetPointData()->SetScalars(values);
  const lacuna::SurfaceDistance distance(surface);
  execution.For(values->GetNumberOfValues(), 4096,
    [&](std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t i = begin; i < end; ++i)
      {
        Vec3 x;
        distances->GetPoint(i, x.data());
        values->SetValue(i, static_cast<float>(distance.Get(x)));
      }
    });
}

//------------------------------------------------------------------------------
void vtkLacunaRBFSurface::CheckNormals(
  lacuna::Execution& execution, const lacuna::OrientedPoints& points, double spacing)
{
  Vec3 at{};
  const std::int64_t opposed =
    lacuna::FindOpposedNormals(execution, points.Points, points.Normals, spacing, at);
  if (opposed == 0)
  {
    return;
  }
  std::ostringstream message;
  message
    << opposed << " of " << points.Points.size()
    << " points have a neighbour within half of the points' spacing whose normal is opposite, "
       "one at ("
    << at[0] << ", " << at[1] << ", " << at[2] << ") mm";
  if (static_cast<double>(opposed) > MostOpposed * static_cast<double>(points.Points.size()))
  {
    throw std::runtime_error(message.str() +
      ": normals contradict each other. Check which side they point to, remove duplicate points, "
      "or "
      "remove the array of normals so that they are estimated");
  }
  vtkWarningMacro(
    << message.str()
    << ": sheets closer than the points cannot be told apart; the surface may be wrong "
       "there. Add points, or correct the normals");
}

//------------------------------------------------------------------------------
bool vtkLacunaRBFSurface::CheckSurface(
  const lacuna::FollowedSurface& followed, const std::vector<std::string>& warnings)
{
  const lacuna::SurfaceTopology topology = lacuna::FindTopology(followed.Surface);
  if (!topology.IsManifold() || (this->CapBoundary && !topology.IsClosed()))
  {
    throw std::runtime_error("the surface could not be closed; choose a smaller OutputSpacing");
  }
  const std::vector<lacuna::SurfacePart> parts =
    topology.IsClosed() ? lacuna::FindParts(followed.Surface) : std::vector<lacuna::SurfacePart>();
  if (!parts.empty() && !followed.ReachesBounds && parts[0].IsInsideOut())
  {
    throw std::runtime_error(
      "the normals of the input point into the solid, so that the surface would be "
      "inside out; reverse them (Surface Normals with Flip Normals, or Reverse "
      "Sense with Reverse Normals on)");
  }
  for (const lacuna::SurfacePart& part : parts)
  {
    if (part.IsInsideOut() && !followed.ReachesBounds)
    {
      vtkWarningMacro(<< "the part of the surface at (" << part.At[0] << ", " << part.At[1] << ", "
                      << part.At[2] << ") mm, of " << std::abs(part.Volume) / 1000 << " ml, "
                      << (part.Volume > 0
                             ? "lies inside of a solid, but its normals leave it as if it "
                               "were solid, too: the volume counts it twice"
                             : "has normals that point inwards, but lies in no solid: the "
                               "volume is too small")
                      << ". Reverse its normals, or leave its points out");
    }
  }
  for (const std::string& warning : warnings)
  {
    vtkWarningMacro(<< warning);
  }
  if (followed.ReachesBounds)
  {
    vtkWarningMacro(
      << "the surface reaches OutputBounds, where it "
      << (this->CapBoundary ? "is closed by planes" : "is open")
      << ": the data do not close it, or the bounds cut it off. Add points on the open "
         "side, or change OutputBounds");
  }
  if (followed.LargestDistance > this->Tolerance)
  {
    vtkWarningMacro(<< "points of the surface are up to " << followed.LargestDistance
                    << " mm from it, more than Tolerance; choose a smaller OutputSpacing");
  }
  return topology.IsClosed();
}
