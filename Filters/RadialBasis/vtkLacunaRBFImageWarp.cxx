// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaRBFImageWarp.h"

#include "lacunaDepthMap.h"
#include "lacunaFieldData.h"
#include "lacunaLandmarkWarp.h"
#include "lacunaMemory.h"
#include "lacunaVolumeDirection.h"
#include "lacunaWarpedPart.h"
#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkDataSet.h"
#include "vtkExtentTranslator.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <vector>

vtkStandardNewMacro(vtkLacunaRBFImageWarp);

namespace
{
constexpr std::array<const char*, 4> KernelNames{ "ThinPlate", "Linear", "Triharmonic", "Cubic" };
constexpr std::array<const char*, 3> InterpolationNames{ "Nearest", "Linear", "Cubic" };

// Share of folded voxels in the box around the targets from which on they are no accident: noise of
// landmarks folds a tenth of a per cent there, and a third of all pairs on the wrong side 3 %; a head
// of which most is mirrored within a frame of landmarks that stay where they are, a quarter. Beyond
// the box the smoother kernels swing, and any share may be folded.
constexpr double FoldedLimit = 0.05;

// what: "the image", or a part of it; hint: what else it may be
[[noreturn]] void ThrowMirrored(const std::string& what, const std::string& hint = {})
{
  throw std::runtime_error("the landmarks mirror " + what +
    ": left would be right in it. Look for pairs in the wrong order, on the wrong side or in a "
    "coordinate system of the other handedness; landmarks nearly in one plane need some off it" +
    hint);
}

using WarpedPart = lacuna::WarpedPart;
using Box = WarpedPart::Box;

constexpr Box NoVoxels{ 0, -1, 0, -1, 0, -1 };

bool IsEmpty(const Box& box)
{
  return box[0] > box[1] || box[2] > box[3] || box[4] > box[5];
}

// The smallest box around two, of which one may be empty.
Box Join(const Box& a, const Box& b)
{
  if (IsEmpty(a) || IsEmpty(b))
  {
    return IsEmpty(a) ? b : a;
  }
  Box both;
  for (std::size_t c = 0; c < 3; ++c)
  {
    both[2 * c] = std::min(a[2 * c], b[2 * c]);
    both[2 * c + 1] = std::max(a[2 * c + 1], b[2 * c + 1]);
  }
  return both;
}

// Of an image; not below the first voxel or beyond the last one.
Box GetBox(const int* extent, const lacuna::VoxelSpace& space)
{
  Box box;
  for (std::size_t c = 0; c < 3; ++c)
  {
    box[2 * c] = std::max(extent[2 * c] - space.Extent[2 * c], 0);
    box[2 * c + 1] = std::min(extent[2 * c + 1], space.Extent[2 * c + 1]) - space.Extent[2 * c];
  }
  return box;
}

Box GetAsked(const lacuna::Ports& ports, const lacuna::VoxelSpace& space)
{
  using SDDP = vtkStreamingDemandDrivenPipeline;
  vtkInformation* info = ports.GetOutputInformation();
  return GetBox(
    info->Has(SDDP::UPDATE_EXTENT()) ? info->Get(SDDP::UPDATE_EXTENT()) : space.Extent, space);
}

vtkDataArray* FindScalars(vtkImageData* image)
{
  vtkDataArray* scalars = image->GetPointData()->GetScalars();
  if (!scalars)
  {
    throw std::runtime_error("the image has no active point scalars");
  }
  if (scalars->GetName() && !std::strcmp(scalars->GetName(), lacuna::DepthMap::MaskName))
  {
    throw std::runtime_error("the image's active scalars are its vtkValidPointMask; choose the "
                             "array that shall be warped as the active one");
  }
  return scalars;
}

void RequireMemoryOfPart(const Box& made, vtkDataArray* scalars)
{
  double points = 1;
  for (std::size_t c = 0; c < 3; ++c)
  {
    points *= static_cast<double>(made[2 * c + 1]) - made[2 * c] + 1;
  }
  lacuna::RequireMemory("the warped image",
    points * (1.0 + scalars->GetDataTypeSize() * scalars->GetNumberOfComponents()));
}

// The voxels of the image of which a rank says whether they are folded: those that ParaView asks of
// it, so that they are computed once, but each of one rank only.
Box GetShare(const lacuna::VoxelSpace& space, const lacuna::Ranks& ranks)
{
  int whole[6];
  std::copy_n(space.Extent, 6, whole);
  int extent[6];
  vtkNew<vtkExtentTranslator> translator;
  if (!translator->PieceToExtentThreadSafe(
        ranks.GetRank(), ranks.GetNumber(), 0, whole, extent, vtkExtentTranslator::BLOCK_MODE, 0))
  {
    return NoVoxels;
  }
  Box share = GetBox(extent, space);
  for (std::size_t c = 0; c < 3; ++c)
  {
    share[2 * c] += share[2 * c] > 0 ? 1 : 0; // neighbours both have the voxels between them
  }
  return share;
}

// How many voxels are folded, and are in the box around the targets.
struct Counts
{
  std::uint64_t Folded = 0;
  std::uint64_t InBox = 0;
  std::uint64_t FoldedInBox = 0;
};

// Goes through the voxels of a box, of the part that the mapping has: sets those of part (may be
// null) and adds up those in counted (may be empty).
template <class Mapping>
void Pass(lacuna::AlgorithmExecution& execution, Mapping& mapping, const Box& box, WarpedPart* part,
  const Box& counted, Counts& sum)
{
  std::atomic<std::uint64_t> folded{ 0 };
  std::atomic<std::uint64_t> inBox{ 0 };
  std::atomic<std::uint64_t> foldedInBox{ 0 };
  const std::vector<Box> blocks = Mapping::Divide(box);
  const lacuna::Execution::NestedStages stages(execution);
  for (std::size_t b = 0; b < blocks.size(); ++b)
  {
    const Box& block = blocks[b];
    const double begin = static_cast<double>(b) / static_cast<double>(blocks.size());
    const double share = 1 / static_cast<double>(blocks.size());
    execution.SetStage(begin, begin + 0.3 * share);
    mapping.SetBlock(execution, block);
    execution.SetStage(begin + 0.3 * share, begin + share);
    const std::int64_t columns = block[1] - block[0] + 1;
    const std::int64_t height = block[3] - block[2] + 1;
    const std::int64_t rows = height * (block[5] - block[4] + 1);
    const std::int64_t grain =
      part && !part->IsParallel() ? rows : std::max<std::int64_t>(1, 4096 / columns);
    execution.For(rows, grain,
      [&](std::int64_t first, std::int64_t last)
      {
        std::vector<double> tuple(part ? part->GetNumberOfComponents() : 0);
        Counts own;
        for (std::int64_t row = first; row < last; ++row)
        {
          int voxel[3] = { 0, block[2] + static_cast<int>(row % height),
            block[4] + static_cast<int>(row / height) };
          const bool mayCount = voxel[1] >= counted[2] && voxel[1] <= counted[3] &&
            voxel[2] >= counted[4] && voxel[2] <= counted[5];
          for (voxel[0] = block[0]; voxel[0] <= block[1]; ++voxel[0])
          {
            if (part)
            {
              double index[3];
              mapping.GetIndex(voxel, index);
              part->Set(voxel, index, tuple);
            }
            if (mayCount && voxel[0] >= counted[0] && voxel[0] <= counted[1])
            {
              const int isFolded = mapping.IsFolded(voxel) ? 1 : 0;
              const int isInBox = mapping.IsInBox(voxel) ? 1 : 0;
              own.Folded += isFolded;
              own.InBox += isInBox;
              own.FoldedInBox += isFolded * isInBox;
            }
          }
        }
        folded += own.Folded;
        inBox += own.InBox;
        foldedInBox += own.FoldedInBox;
      });
  }
  sum.Folded += folded;
  sum.InBox += inBox;
  sum.FoldedInBox += foldedInBox;
}

// Makes part (may be null) of box made, and counts what is folded in box counted; both may be empty.
template <class Mapping>
Counts WarpAndCount(lacuna::AlgorithmExecution& execution, Mapping& mapping, const Box& made,
  WarpedPart* part, const Box& counted)
{
  const Box both = Join(made, counted);
  Counts sum;
  if (IsEmpty(both))
  {
    return sum;
  }
  const bool apart = !IsEmpty(counted) && made != both;
  execution.SetStage(0.3, 0.4);
  mapping.SetPart(execution, both);
  if (part)
  {
    execution.SetStage(0.4, apart ? 0.8 : 1);
    Pass(execution, mapping, made, part, apart ? NoVoxels : counted, sum);
  }
  if (apart)
  {
    execution.SetStage(part ? 0.8 : 0.4, 1);
    Pass(execution, mapping, counted, nullptr, counted, sum);
  }
  return sum;
}
}

//------------------------------------------------------------------------------
struct vtkLacunaRBFImageWarp::Task
{
  vtkImageData* Image = nullptr;
  vtkDataArray* Scalars = nullptr;
  std::optional<lacuna::VoxelSpace> Space;
  std::vector<std::array<double, 3>> From;
  std::vector<std::array<double, 3>> To;
  Box Made = NoVoxels;    // of this rank; may be empty
  Box Counted = NoVoxels; // where it counts what is folded; may be empty
};

struct vtkLacunaRBFImageWarp::Outcome
{
  std::unique_ptr<WarpedPart> Part; // null: none is asked for
  lacuna::RadialBasisReport Report;
  Counts Folds;
};

//------------------------------------------------------------------------------
vtkLacunaRBFImageWarp::vtkLacunaRBFImageWarp()
{
  this->Sharing = lacuna::Share::Together;
  this->KeepsPlace = false; // the targets may be anyone's
  this->SetNumberOfInputPorts(3);
}

vtkLacunaRBFImageWarp::~vtkLacunaRBFImageWarp() = default;

//------------------------------------------------------------------------------
int vtkLacunaRBFImageWarp::FillInputPortInformation(int port, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), port == 0 ? "vtkImageData" : "vtkDataSet");
  return 1;
}

//------------------------------------------------------------------------------
void vtkLacunaRBFImageWarp::Announce(const lacuna::Ports& ports)
{
  ports.GetOutputInformation()->Set(vtkAlgorithm::CAN_PRODUCE_SUB_EXTENT(), 1); // each its part
}

//------------------------------------------------------------------------------
// Any voxel may show any place, and each depends on all landmarks. All ranks say together what is folded.
void vtkLacunaRBFImageWarp::Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution)
{
  const lacuna::Ranks& ranks = ports.Ranks;
  const bool wanted = ports.IsAsked();
  Task task;
  // what is wrong on one rank only may not keep the others waiting
  ranks.Together([&] { this->Prepare(ports, task); });

  // What is folded is known while what the mapping depends on stays the same, on all ranks.
  const std::vector<double> key = this->GetKey(task);
  const bool known = ports.HaveMet || ranks.AllFine(key == this->FoldsOf);
  if (known && !wanted)
  {
    return;
  }
  task.Made = wanted ? GetAsked(ports, *task.Space) : NoVoxels;
  task.Counted = known ? NoVoxels : GetShare(*task.Space, ranks);
  Outcome outcome;
  const auto warp = [&] { this->Warp(execution, task, outcome); };
  if (known)
  {
    warp();
  }
  else
  {
    ranks.Together(warp);
    std::uint64_t sums[3] = { outcome.Folds.Folded, outcome.Folds.InBox,
      outcome.Folds.FoldedInBox };
    ranks.Sum(sums, 3);
    this->FoldedFraction =
      static_cast<double>(sums[0]) / static_cast<double>(task.Image->GetNumberOfPoints());
    this->FoldedInBox =
      static_cast<double>(sums[2]) / static_cast<double>(std::max<std::uint64_t>(1, sums[1]));
    this->FoldsOf = key;
  }
  this->CheckFolds(outcome.Part != nullptr);
  if (outcome.Part)
  {
    this->SetOutput(ports.GetOutput<vtkImageData>(), task, outcome);
  }
}

//------------------------------------------------------------------------------
void vtkLacunaRBFImageWarp::Prepare(const lacuna::Ports& ports, Task& task) const
{
  task.Image = ports.GetInput<vtkImageData>();
  auto* landmarks = ports.GetInput<vtkDataSet>(1);
  auto* targets = ports.GetInput<vtkDataSet>(2);
  lacuna::VolumeDirection::Check(task.Image);
  task.Scalars = FindScalars(task.Image);
  if (landmarks->GetNumberOfPoints() != targets->GetNumberOfPoints())
  {
    std::ostringstream message;
    message << "there are " << landmarks->GetNumberOfPoints() << " landmarks but "
            << targets->GetNumberOfPoints() << " targets; they must be as many, in pairs of "
            << "equal index";
    throw std::runtime_error(message.str());
  }
  if (this->Accuracy == 1)
  {
    throw std::runtime_error("Accuracy is 1 voxel; it must be less");
  }
  task.Space.emplace(task.Image);
  task.From = task.Space->GetPoints(landmarks);
  task.To = task.Space->GetPoints(targets);
}

//------------------------------------------------------------------------------
std::vector<double> vtkLacunaRBFImageWarp::GetKey(const Task& task) const
{
  const lacuna::VoxelSpace& space = *task.Space;
  std::vector<double> key(space.Extent, space.Extent + 6);
  key.insert(key.end(), space.Spacing, space.Spacing + 3);
  key.insert(key.end(), { static_cast<double>(this->Kernel), this->Smoothing, this->Accuracy });
  for (const auto* points : { &task.From, &task.To })
  {
    for (const std::array<double, 3>& x : *points)
    {
      key.insert(key.end(), x.begin(), x.end());
    }
  }
  return key;
}

//------------------------------------------------------------------------------
void vtkLacunaRBFImageWarp::Warp(
  lacuna::AlgorithmExecution& execution, const Task& task, Outcome& outcome) const
{
  if (!IsEmpty(task.Made))
  {
    RequireMemoryOfPart(task.Made, task.Scalars);
    outcome.Part = std::make_unique<WarpedPart>(
      task.Image, task.Scalars, this->Interpolation, this->OutsideValue, task.Made);
  }
  lacuna::RadialBasisOptions options;
  options.Kernel = static_cast<lacuna::RadialKernel>(this->Kernel);
  options.Smoothing = this->Smoothing;
  const auto run = [&](auto mapping)
  {
    if (mapping.IsMirrored())
    {
      ThrowMirrored("the image");
    }
    outcome.Report = mapping.GetReport();
    outcome.Folds = WarpAndCount(execution, mapping, task.Made, outcome.Part.get(), task.Counted);
  };
  switch (task.Space->Axes.size())
  {
    case 3:
      run(lacuna::LandmarkWarp<3>(
        execution, *task.Space, task.From, task.To, options, this->Accuracy));
      break;
    case 2:
      run(lacuna::LandmarkWarp<2>(
        execution, *task.Space, task.From, task.To, options, this->Accuracy));
      break;
    default:
      throw std::runtime_error("the image is but a row of voxels; warps are two- or "
                               "three-dimensional");
  }
}

//------------------------------------------------------------------------------
void vtkLacunaRBFImageWarp::CheckFolds(bool warns)
{
  const bool swings = this->Kernel == Triharmonic || this->Kernel == Cubic;
  const std::string name = this->Kernel == Cubic ? "Cubic" : "Triharmonic";
  if (this->FoldedInBox > FoldedLimit)
  {
    ThrowMirrored(
      std::to_string(std::lround(100 * this->FoldedInBox)) + " % of the box around the targets",
      swings ? "; or " + name + " swings there: take ThinPlate or Linear, or add Smoothing" : "");
  }
  if (warns && this->FoldedFraction > 0)
  {
    std::string reasons;
    if (this->FoldedInBox > 0)
    {
      reasons += "landmarks cross or contradict one another; check the pairs, or add Smoothing. ";
    }
    if (this->FoldedFraction > this->FoldedInBox && swings)
    {
      reasons += "Far from landmarks " + name +
        " swings: take ThinPlate or Linear, add Smoothing, or crop the image. ";
    }
    vtkWarningMacro(<< "the mapping folds in " << 100 * this->FoldedFraction << " % of the voxels, "
                    << 100 * this->FoldedInBox << " % of those in the box around the targets, and "
                    << "the image is mirrored there. " << reasons);
  }
}

//------------------------------------------------------------------------------
void vtkLacunaRBFImageWarp::SetOutput(
  vtkImageData* output, const Task& task, const Outcome& outcome) const
{
  output->ShallowCopy(task.Image);
  output->GetPointData()->Initialize(); // other arrays are not warped
  output->GetCellData()->Initialize();
  int extent[6];
  for (std::size_t c = 0; c < 6; ++c)
  {
    extent[c] = task.Space->Extent[c / 2 * 2] + task.Made[c];
  }
  output->SetExtent(extent);
  output->GetPointData()->SetScalars(outcome.Part->GetWarped());
  output->GetPointData()->AddArray(outcome.Part->GetValid());
  const lacuna::RadialBasisReport& report = outcome.Report;
  lacuna::FieldData::Set(output, "NodeCount", { static_cast<double>(report.NodeCount) }, 1);
  lacuna::FieldData::Set(output, "Residual", { report.Residual }, 1);
  lacuna::FieldData::Set(output, "FoldedFraction", { this->FoldedFraction }, 1);
}

//------------------------------------------------------------------------------
void vtkLacunaRBFImageWarp::Describe(lacuna::Properties& properties) const
{
  properties.Add("Kernel", this->Kernel, KernelNames)
    .Add("Smoothing", this->Smoothing, lacuna::ValueRange::AtLeast(0))
    .Add("Interpolation", this->Interpolation, InterpolationNames)
    .Add("OutsideValue", this->OutsideValue)
    .Add("Accuracy", this->Accuracy, lacuna::ValueRange::Above(0, "voxels").UpTo(1));
}
