// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaRBFImageWarp.h"

#include "lacunaMemory.h"
#include "lacunaParameterText.h"
#include "vtkCellData.h"
#include "vtkCharArray.h"
#include "vtkDataArray.h"
#include "vtkDataSet.h"
#include "vtkDoubleArray.h"
#include "vtkImageData.h"
#include "vtkImageInterpolator.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkLacunaCoordinates.h"
#include "vtkLacunaDepthMap.h"
#include "vtkLacunaExecution.h"
#include "vtkLacunaFieldData.h"
#include "vtkLacunaLandmarkWarp.h"
#include "vtkLacunaProvenance.h"
#include "vtkLacunaRequest.h"
#include "vtkLacunaVolumeDirection.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <sstream>
#include <stdexcept>
#include <vector>

vtkStandardNewMacro(vtkLacunaRBFImageWarp);

namespace
{
// Of a voxel: so near to one a place is on it, and its neighbours have no say.
constexpr double RoundOff = 1e-9;

// Share of folded voxels in the box around the targets from which on they are no accident: noise of
// landmarks folds a tenth of a per cent there, and a third of all pairs on the wrong side 3 %; a head
// of which most is mirrored within a frame of landmarks that stay where they are, a quarter. Beyond
// the box the smoother kernels swing, and any share may be folded.
constexpr double FoldedLimit = 0.05;

// What of the voxels is folded.
struct Folds
{
  double Image = 0; // share of all voxels
  double Box = 0;   // share of those in the box around the targets
};

// what: "the image", or a part of it; hint: what else it may be
[[noreturn]] void ThrowMirrored(const std::string& what, const std::string& hint = {})
{
  throw std::runtime_error("the landmarks mirror " + what +
    ": left would be right in it. Look for pairs in the wrong order, on the wrong side or in a "
    "coordinate system of the other handedness; landmarks nearly in one plane need some off it" +
    hint);
}

// Which places of the image have grey levels that count, by its vtkValidPointMask.
class ValidPlaces
{
public:
  ValidPlaces(vtkImageData* image, int interpolation)
    : Interpolation(interpolation)
  {
    image->GetDimensions(this->Size);
    image->GetExtent(this->Extent);
    vtkDataArray* mask = image->GetPointData()->GetArray(vtkLacunaDepthMap::MaskName);
    for (vtkIdType i = 0; mask && i < mask->GetNumberOfTuples(); ++i)
    {
      this->Mask.push_back(mask->GetComponent(i, 0) != 0 ? 1 : 0);
    }
  }

  // Whether all voxels that interpolation at a place needs are valid: those whose weight is not 0.
  bool Has(const double* index) const
  {
    if (this->Mask.empty())
    {
      return true;
    }
    int first[3];
    int last[3];
    for (int c = 0; c < 3; ++c)
    {
      const double place = index[c] - this->Extent[2 * c];
      const bool nearest = this->Interpolation == vtkLacunaRBFImageWarp::Nearest;
      const double below = std::floor(nearest ? place + 0.5 : place);
      const int wide = this->Interpolation == vtkLacunaRBFImageWarp::CubicInterpolation ? 1 : 0;
      const bool between = !nearest && place > below;
      first[c] = this->Clamp(static_cast<int>(below) - (between ? wide : 0), c);
      last[c] = this->Clamp(static_cast<int>(below) + (between ? 1 + wide : 0), c);
    }
    for (std::int64_t k = first[2]; k <= last[2]; ++k)
    {
      for (std::int64_t j = first[1]; j <= last[1]; ++j)
      {
        const std::int64_t row = (k * this->Size[1] + j) * this->Size[0];
        for (std::int64_t i = first[0]; i <= last[0]; ++i)
        {
          if (this->Mask[row + i] == 0)
          {
            return false;
          }
        }
      }
    }
    return true;
  }

private:
  int Clamp(int i, int axis) const { return std::min(std::max(i, 0), this->Size[axis] - 1); }

  int Interpolation;
  int Size[3];
  int Extent[6];
  std::vector<char> Mask; // empty: all are valid
};

// vtkImageInterpolator knows no integers of 64 bits, and leaves grey levels undefined then.
vtkSmartPointer<vtkDataArray> GetInterpolable(vtkDataArray* scalars)
{
  if (scalars->GetDataTypeSize() < 8 || scalars->GetDataType() == VTK_DOUBLE)
  {
    return scalars;
  }
  auto doubles = vtkSmartPointer<vtkDoubleArray>::New();
  doubles->DeepCopy(scalars);
  return doubles;
}

struct Sampling
{
  int Interpolation;
  double OutsideValue;
};

template <class Mapping>
Folds Sample(vtkLacunaExecution& execution, vtkImageData* image, vtkDataArray* scalars,
  const Mapping& mapping, const Sampling& sampling, vtkImageData* output)
{
  const vtkIdType count = image->GetNumberOfPoints();
  const int components = scalars->GetNumberOfComponents();
  const auto warped = vtkSmartPointer<vtkDataArray>::Take(scalars->NewInstance());
  warped->SetName(scalars->GetName());
  warped->SetNumberOfComponents(components);
  warped->SetNumberOfTuples(count);
  vtkNew<vtkCharArray> valid;
  valid->SetName(vtkLacunaDepthMap::MaskName);
  valid->SetNumberOfTuples(count);

  vtkNew<vtkImageData> input; // with the scalars that shall be warped as the active ones
  input->ShallowCopy(image);
  input->GetPointData()->SetScalars(GetInterpolable(scalars));
  vtkNew<vtkImageInterpolator> interpolator;
  interpolator->SetInterpolationMode(sampling.Interpolation);
  interpolator->SetOutValue(sampling.OutsideValue);
  interpolator->Initialize(input);
  interpolator->Update();
  const ValidPlaces places(image, sampling.Interpolation);
  const bool integral = scalars->GetDataType() != VTK_FLOAT && scalars->GetDataType() != VTK_DOUBLE;
  const double low = scalars->GetDataTypeMin();
  const double high = scalars->GetDataTypeMax();
  constexpr std::int64_t grain = 4096;
  struct Count
  {
    std::int64_t Folded = 0;
    std::int64_t InBox = 0;
    std::int64_t FoldedInBox = 0;
  };
  std::vector<Count> counts((count + grain - 1) / grain);
  execution.SetStage(0.6, 1);
  execution.For(static_cast<std::int64_t>(counts.size()), 1,
    [&](std::int64_t begin, std::int64_t end)
    {
      std::vector<double> tuple(components);
      for (std::int64_t block = begin; block < end; ++block)
      {
        for (std::int64_t i = block * grain; i < std::min<std::int64_t>((block + 1) * grain, count);
             ++i)
        {
          double index[3];
          mapping.GetIndex(i, index);
          for (double& place : index)
          {
            const double voxel = std::floor(place + 0.5);
            place = std::abs(place - voxel) <= RoundOff ? voxel : place;
          }
          bool known = interpolator->CheckBoundsIJK(index) && places.Has(index);
          if (known)
          {
            interpolator->InterpolateIJK(index, tuple.data());
            known =
              std::none_of(tuple.begin(), tuple.end(), [](double v) { return std::isnan(v); });
          }
          else
          {
            std::fill(tuple.begin(), tuple.end(), sampling.OutsideValue);
          }
          for (int k = 0; k < components; ++k)
          {
            const double value =
              integral ? std::floor(std::min(std::max(tuple[k], low), high) + 0.5) : tuple[k];
            warped->SetComponent(i, k, value);
          }
          valid->SetValue(i, known ? 1 : 0);
          const int folded = mapping.IsFolded(i) ? 1 : 0;
          const int inBox = mapping.IsInBox(i) ? 1 : 0;
          counts[block].Folded += folded;
          counts[block].InBox += inBox;
          counts[block].FoldedInBox += folded * inBox;
        }
      }
    });
  output->GetPointData()->Initialize(); // other arrays are not warped
  output->GetCellData()->Initialize();
  output->GetPointData()->SetScalars(warped);
  output->GetPointData()->AddArray(valid);
  Count sum;
  for (const Count& block : counts)
  {
    sum.Folded += block.Folded;
    sum.InBox += block.InBox;
    sum.FoldedInBox += block.FoldedInBox;
  }
  return { static_cast<double>(sum.Folded) / static_cast<double>(count),
    static_cast<double>(sum.FoldedInBox) /
      static_cast<double>(std::max<std::int64_t>(1, sum.InBox)) };
}
}

//------------------------------------------------------------------------------
vtkLacunaRBFImageWarp::vtkLacunaRBFImageWarp()
{
  this->SetNumberOfInputPorts(3);
}

//------------------------------------------------------------------------------
int vtkLacunaRBFImageWarp::FillInputPortInformation(int port, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), port == 0 ? "vtkImageData" : "vtkDataSet");
  return 1;
}

//------------------------------------------------------------------------------
int vtkLacunaRBFImageWarp::RequestUpdateExtent(
  vtkInformation*, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  // Any voxel may show any place, and each depends on all landmarks.
  int fits = 1;
  for (int port = 0; port < 3; ++port)
  {
    fits &= vtkLacunaRequest::WholeIfItFits(this, inputs[port]->GetInformationObject(0), outputs);
  }
  return fits;
}

//------------------------------------------------------------------------------
int vtkLacunaRBFImageWarp::RequestData(
  vtkInformation*, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  vtkImageData* image = vtkImageData::GetData(inputs[0]);
  vtkImageData* output = vtkImageData::GetData(outputs);
  if (!image || image->GetNumberOfPoints() == 0 || !vtkLacunaRequest::IsWanted(outputs))
  {
    return 1; // empty in, empty out
  }
  return vtkLacunaExecution::Run(this, outputs,
    [&](vtkLacunaExecution& execution)
    {
      vtkLacunaVolumeDirection::Check(image);
      vtkDataSet* landmarks = vtkDataSet::GetData(inputs[1]);
      vtkDataSet* targets = vtkDataSet::GetData(inputs[2]);
      vtkDataArray* scalars = image->GetPointData()->GetScalars();
      if (!scalars)
      {
        throw std::runtime_error("the image has no active point scalars");
      }
      if (scalars->GetName() && !std::strcmp(scalars->GetName(), vtkLacunaDepthMap::MaskName))
      {
        throw std::runtime_error("the image's active scalars are its vtkValidPointMask; choose the "
                                 "array that shall be warped as the active one");
      }
      if (landmarks->GetNumberOfPoints() != targets->GetNumberOfPoints())
      {
        std::ostringstream message;
        message << "there are " << landmarks->GetNumberOfPoints() << " landmarks but "
                << targets->GetNumberOfPoints() << " targets; they must be as many, in pairs of "
                << "equal index";
        throw std::runtime_error(message.str());
      }
      if (this->Kernel < ThinPlate || this->Kernel > Cubic)
      {
        throw std::runtime_error("Kernel is " + std::to_string(this->Kernel) +
          "; it must be 0 (ThinPlate), 1 (Linear), 2 (Triharmonic) or 3 (Cubic)");
      }
      if (this->Interpolation < Nearest || this->Interpolation > CubicInterpolation)
      {
        throw std::runtime_error("Interpolation is " + std::to_string(this->Interpolation) +
          "; it must be 0 (Nearest), 1 (Linear) or 2 (Cubic)");
      }
      if (!(this->Accuracy > 0) || !(this->Accuracy < 1))
      {
        throw std::runtime_error("Accuracy must be a number of voxels above 0 and below 1");
      }
      const vtkLacunaVoxelSpace space(image);
      lacuna::RequireMemory(
        "the warped image", static_cast<double>(image->GetNumberOfPoints()) * 8 * 5);
      const std::vector<std::array<double, 3>> from = space.GetPoints(landmarks);
      const std::vector<std::array<double, 3>> to = space.GetPoints(targets);
      lacuna::RadialBasisOptions options;
      options.Kernel = static_cast<lacuna::RadialKernel>(this->Kernel);
      options.Smoothing = this->Smoothing;

      vtkNew<vtkImageData> whole;
      whole->ShallowCopy(image);
      const Sampling sampling{ this->Interpolation, this->OutsideValue };
      Folds folded;
      lacuna::RadialBasisReport report;
      const auto run = [&](const auto& mapping)
      {
        if (mapping.IsMirrored())
        {
          ThrowMirrored("the image");
        }
        report = mapping.GetReport();
        folded = Sample(execution, image, scalars, mapping, sampling, whole);
      };
      switch (space.Axes.size())
      {
        case 3:
          run(vtkLacunaLandmarkWarp<3>(execution, space, from, to, options, this->Accuracy));
          break;
        case 2:
          run(vtkLacunaLandmarkWarp<2>(execution, space, from, to, options, this->Accuracy));
          break;
        default:
          throw std::runtime_error("the image is but a row of voxels; warps are two- or "
                                   "three-dimensional");
      }
      const bool swings = this->Kernel == Triharmonic || this->Kernel == Cubic;
      const std::string name = this->Kernel == Cubic ? "Cubic" : "Triharmonic";
      if (folded.Box > FoldedLimit)
      {
        ThrowMirrored(
          std::to_string(std::lround(100 * folded.Box)) + " % of the box around the targets",
          swings ? "; or " + name + " swings there: take ThinPlate or Linear, or add Smoothing"
                 : "");
      }
      if (folded.Image > 0)
      {
        std::string reasons;
        if (folded.Box > 0)
        {
          reasons +=
            "landmarks cross or contradict one another; check the pairs, or add Smoothing. ";
        }
        if (folded.Image > folded.Box && swings)
        {
          reasons += "Far from landmarks " + name +
            " swings: take ThinPlate or Linear, add Smoothing, or crop the image. ";
        }
        vtkWarningMacro(<< "the mapping folds in " << 100 * folded.Image << " % of the voxels, "
                        << 100 * folded.Box << " % of those in the box around the targets, and "
                        << "the image is mirrored there. " << reasons);
      }
      vtkLacunaFieldData::Set(whole, "NodeCount", { static_cast<double>(report.NodeCount) }, 1);
      vtkLacunaFieldData::Set(whole, "Residual", { report.Residual }, 1);
      vtkLacunaFieldData::Set(whole, "FoldedFraction", { folded.Image }, 1);
      lacuna::ParameterText parameters;
      parameters.Add("Kernel", this->Kernel)
        .Add("Smoothing", this->Smoothing)
        .Add("Interpolation", this->Interpolation)
        .Add("OutsideValue", this->OutsideValue)
        .Add("Accuracy", this->Accuracy);
      vtkLacunaProvenance::Record(whole, this, { image, landmarks, targets }, parameters.Get());
      vtkLacunaCoordinates::Clear(whole); // the targets may be anyone's
      output->ShallowCopy(whole);
      int piece[6];
      outputs->GetInformationObject(0)->Get(
        vtkStreamingDemandDrivenPipeline::UPDATE_EXTENT(), piece);
      output->Crop(piece);
    });
}

//------------------------------------------------------------------------------
void vtkLacunaRBFImageWarp::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Kernel: " << this->Kernel << "\n";
  os << indent << "Smoothing: " << this->Smoothing << "\n";
  os << indent << "Interpolation: " << this->Interpolation << "\n";
  os << indent << "OutsideValue: " << this->OutsideValue << "\n";
  os << indent << "Accuracy: " << this->Accuracy << "\n";
}
