// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaOcclusionInput.h"

#include "lacunaImplicitRegion.h"
#include "lacunaParameterText.h"
#include "lacunaShapeGrowth.h"
#include "lacunaVolumeDirection.h"
#include "vtkArrayDispatch.h"
#include "vtkDataArray.h"
#include "vtkDataArrayRange.h"
#include "vtkImageData.h"
#include "vtkImplicitFunction.h"
#include "vtkLacunaOccludedAngle.h"
#include "vtkMatrix3x3.h"
#include "vtkPiecewiseFunction.h"
#include "vtkPointData.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <stdexcept>

namespace lacuna::OcclusionInput
{
namespace
{
constexpr double DataOpacity = 0.95; // of a voxel of opacity 1

float* At(lacuna::AttenuationField& field, std::int64_t i)
{
  const auto& n = field.GetDimensions();
  const std::int64_t row = i / n[0];
  return field.Row(row % n[1], row / n[1]) + i % n[0];
}

[[noreturn]] void Refuse(const char* what, vtkImageData* image, vtkIdType i)
{
  int dimensions[3];
  image->GetDimensions(dimensions);
  const int* extent = image->GetExtent();
  std::ostringstream text;
  text << what << " at voxel (" << extent[0] + i % dimensions[0] << ", "
       << extent[2] + (i / dimensions[0]) % dimensions[1] << ", "
       << extent[4] + i / (static_cast<vtkIdType>(dimensions[0]) * dimensions[1]) << ")";
  throw std::runtime_error(text.str());
}

/// Copies scalars into the field, converted by a function object of (value, index).
template <class Convert>
struct Copy
{
  lacuna::AttenuationField& Field;
  lacuna::Execution& Execution;
  Convert& Converter;

  template <class Array>
  void operator()(Array* array) const
  {
    const auto values = vtk::DataArrayValueRange<1>(array);
    const auto& n = this->Field.GetDimensions();
    this->Execution.For(n[1] * n[2], std::max<std::int64_t>(1, (1 << 16) / n[0]),
      [&](std::int64_t begin, std::int64_t end)
      {
        for (std::int64_t r = begin; r < end; ++r)
        {
          float* row = this->Field.Row(r % n[1], r / n[1]);
          for (std::int64_t i = 0; i < n[0]; ++i)
          {
            row[i] = this->Converter(static_cast<double>(values[r * n[0] + i]), r * n[0] + i);
          }
        }
      });
  }
};

template <class Convert>
void FillWith(lacuna::AttenuationField& field, vtkDataArray* scalars, lacuna::Execution& execution,
  Convert convert)
{
  const Copy<Convert> copy{ field, execution, convert };
  if (!vtkArrayDispatch::Dispatch::Execute(scalars, copy))
  {
    copy(scalars);
  }
}
}

//------------------------------------------------------------------------------
Grid::Grid(vtkImageData* image)
{
  lacuna::VolumeDirection::Check(image);
  int dimensions[3];
  image->GetDimensions(dimensions);
  for (int axis : { 0, 1, 2 })
  {
    if (dimensions[axis] > 1)
    {
      this->Dimensions[this->Axes] = dimensions[axis];
      this->Spacing[this->Axes++] = image->GetSpacing()[axis];
    }
  }
  if (this->Axes < 2 || image->GetNumberOfPoints() == 0)
  {
    throw std::runtime_error("an occluded angle needs an image that is at least two voxels wide "
                             "along two axes");
  }
  if (!std::isfinite(this->GetVoxelContent() * static_cast<double>(this->GetSize())))
  {
    throw std::runtime_error("the voxels of the image are " +
      lacuna::FormatValue(std::array<double, 3>{
        image->GetSpacing()[0], image->GetSpacing()[1], image->GetSpacing()[2] }) +
      " mm, of which nothing can be measured; mend the spacing of the input");
  }
}

std::int64_t Grid::GetSize() const
{
  return this->Dimensions[0] * this->Dimensions[1] * this->Dimensions[2];
}

double Grid::GetVoxelContent() const
{
  const double area = this->Spacing[0] * this->Spacing[1];
  return this->Axes == 2 ? area : area * this->Spacing[2] / 1000;
}

//------------------------------------------------------------------------------
vtkDataArray* FindScalars(vtkImageData* image, const std::string& name)
{
  vtkPointData* data = image->GetPointData();
  vtkDataArray* scalars = name.empty() ? data->GetScalars() : data->GetArray(name.c_str());
  if (!scalars)
  {
    throw std::runtime_error(name.empty()
        ? "the image has no active point scalars; choose a point array of numbers"
        : "the image has no point array '" + name + "' of numbers; choose one that it has");
  }
  const std::string found = scalars->GetName() ? scalars->GetName() : "";
  if (scalars->GetNumberOfComponents() != 1)
  {
    throw std::runtime_error("the array '" + found + "' has more than one component; extract one");
  }
  return scalars;
}

//------------------------------------------------------------------------------
void Fill(lacuna::AttenuationField& field, vtkImageData* image, vtkDataArray* scalars,
  const Conversion& conversion, lacuna::Execution& execution)
{
  const double largest = lacuna::GetLargestAttenuation(field);
  const double opaque = lacuna::GetAttenuation(field, DataOpacity);
  const double least = lacuna::GetAttenuation(field, 0.5);
  const bool binary = conversion.Binary;
  const auto finish = [=](double attenuation)
  {
    return static_cast<float>(
      binary ? (attenuation >= least ? 1.0 : 0.0) : std::min(attenuation, largest));
  };
  if (conversion.Attenuation == vtkLacunaOccludedAngle::ByArray)
  {
    FillWith(field, scalars, execution,
      [=](double value, vtkIdType i)
      {
        if (!(value >= 0))
        {
          Refuse("the attenuation is negative or not a number", image, i);
        }
        return finish(value);
      });
  }
  else if (conversion.Attenuation == vtkLacunaOccludedAngle::ByOpacityFunction)
  {
    vtkPiecewiseFunction* function = conversion.Function;
    if (!function || function->GetSize() == 0)
    {
      throw std::runtime_error("there is no OpacityFunction; give one, or choose another way to "
                               "make attenuation of grey levels");
    }
    FillWith(field, scalars, execution,
      [=](double value, vtkIdType i)
      {
        const double opacity = function->GetValue(value);
        if (!(opacity >= 0) || std::isnan(value))
        {
          Refuse("the opacity is negative or not a number", image, i);
        }
        return finish(opacity * opaque);
      });
  }
  else
  {
    double range[2];
    scalars->GetRange(range);
    if (!(range[1] > range[0]))
    {
      throw std::runtime_error("all grey levels are " + std::to_string(range[0]) +
        ": there is no data to reconstruct from");
    }
    const double scale = opaque / (range[1] - range[0]);
    FillWith(field, scalars, execution,
      [=](double value, vtkIdType i)
      {
        if (!std::isfinite(value))
        {
          Refuse("the grey level is not a finite number", image, i);
        }
        return finish((value - range[0]) * scale);
      });
  }
}

//------------------------------------------------------------------------------
bool SamePlace(vtkImageData* a, vtkImageData* b)
{
  bool same = std::equal(a->GetExtent(), a->GetExtent() + 6, b->GetExtent());
  for (int i = 0; i < 3; ++i)
  {
    const double tolerance = 1e-6 * a->GetSpacing()[i];
    same = same && std::abs(a->GetOrigin()[i] - b->GetOrigin()[i]) <= tolerance &&
      std::abs(a->GetSpacing()[i] - b->GetSpacing()[i]) <= tolerance;
    for (int j = 0; j < 3; ++j)
    {
      same = same &&
        std::abs(a->GetDirectionMatrix()->GetElement(i, j) -
          b->GetDirectionMatrix()->GetElement(i, j)) <= 1e-9;
    }
  }
  return same;
}

//------------------------------------------------------------------------------
void CutSpace(lacuna::AttenuationField& field, vtkImageData* image, vtkImageData* mask,
  vtkImplicitFunction* function)
{
  if (!mask && !function)
  {
    return;
  }
  lacuna::ImplicitRegion::Check(function, "ReconstructionSpace");
  vtkDataArray* inside = mask ? mask->GetPointData()->GetScalars() : nullptr;
  if (mask &&
    (!SamePlace(image, mask) || !inside ||
      inside->GetNumberOfTuples() != field.GetNumberOfVoxels()))
  {
    throw std::runtime_error("the reconstruction space (second input) must be an image with "
                             "point scalars and with the extent, origin, spacing and direction "
                             "of the first");
  }
  bool any = false;
  for (vtkIdType i = 0; i < field.GetNumberOfVoxels(); ++i)
  {
    bool kept = !inside || std::abs(inside->GetComponent(i, 0)) > 0; // not where it is NaN
    if (kept && function)
    {
      double point[3];
      image->GetPoint(i, point);
      kept = function->FunctionValue(point) < 0;
    }
    float* value = At(field, i);
    *value = kept ? *value : lacuna::AttenuationField::OutsideSpace();
    any = any || *value > 0;
  }
  if (!any)
  {
    throw std::runtime_error("the reconstruction space contains none of the data; nothing can be "
                             "reconstructed in it");
  }
}
}
