// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaInputCheck.h"

#include "vtkAbstractArray.h"
#include "vtkCellData.h"
#include "vtkCompositeDataIterator.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataArray.h"
#include "vtkDataObject.h"
#include "vtkDataSet.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkMatrix3x3.h"
#include "vtkPointData.h"
#include "vtkPointSet.h"
#include "vtkSmartPointer.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <sstream>
#include <stdexcept>
#include <string_view>

using SDDP = vtkStreamingDemandDrivenPipeline;

namespace
{
void CheckLengths(
  vtkDataObject* data, const std::string& name, int type, const char* array, const char* of)
{
  vtkFieldData* group = data->GetAttributesAsFieldData(type);
  const vtkIdType wanted = data->GetNumberOfElements(type);
  for (int a = 0; group && wanted > 0 && a < group->GetNumberOfArrays(); ++a)
  {
    vtkAbstractArray* values = group->GetAbstractArray(a);
    if (values->GetNumberOfTuples() != wanted)
    {
      std::ostringstream message;
      message << name << " is not sound: its " << array << " "
              << (values->GetName() ? values->GetName() : "without a name") << " has "
              << values->GetNumberOfTuples() << " values for " << wanted << " " << of
              << "; mend or leave it out where it is made";
      throw std::runtime_error(message.str());
    }
  }
}

void CheckNumbers(const std::string& name, const char* what, const double* numbers, int count)
{
  if (std::all_of(numbers, numbers + count, [](double n) { return std::isfinite(n); }))
  {
    return;
  }
  std::ostringstream message;
  message << name << " is not sound: its " << what << " is";
  for (int i = 0; i < count; ++i)
  {
    message << " " << numbers[i];
  }
  message << "; these must be finite numbers";
  throw std::runtime_error(message.str());
}

std::string Text(const int extent[6])
{
  std::string text = std::to_string(extent[0]);
  for (int i = 1; i < 6; ++i)
  {
    text += " " + std::to_string(extent[i]);
  }
  return text;
}

// A part would be taken for all there is, and each rank would take another one.
void CheckPart(const std::string& name, const int arrived[6], const int asked[6])
{
  for (int c = 0; c < 6; c += 2)
  {
    if (asked[c] <= asked[c + 1] && (arrived[c] > asked[c] || arrived[c + 1] < asked[c + 1]))
    {
      throw std::runtime_error("only the part " + Text(arrived) + " of the image in " + name +
        " arrived, " + Text(asked) +
        " is needed; the filter before this one does not give what it is asked for");
    }
  }
}

// Room for windows and margins around it, which are counted in the same type.
void CheckExtent(const std::string& name, const int extent[6])
{
  constexpr int limit = 1 << 30;
  if (std::any_of(extent, extent + 6, [](int index) { return index < -limit || index > limit; }))
  {
    throw std::runtime_error(name + " is not sound: its extent is " + Text(extent) +
      "; indices must be from -2^30 to 2^30");
  }
}
}

//------------------------------------------------------------------------------
void lacuna::InputCheck::Check(vtkDataObject* data, const std::string& name)
{
  if (auto* blocks = vtkCompositeDataSet::SafeDownCast(data))
  {
    const auto block = vtkSmartPointer<vtkCompositeDataIterator>::Take(blocks->NewIterator());
    for (block->InitTraversal(); !block->IsDoneWithTraversal(); block->GoToNextItem())
    {
      Check(block->GetCurrentDataObject(),
        name + ", block " + std::to_string(block->GetCurrentFlatIndex()) + ",");
    }
    return;
  }
  if (!data)
  {
    return;
  }
  CheckLengths(data, name, vtkDataObject::POINT, "point array", "points");
  CheckLengths(data, name, vtkDataObject::CELL, "cell array", "cells");
  CheckLengths(data, name, vtkDataObject::ROW, "column", "rows");
  auto* image = vtkImageData::SafeDownCast(data);
  if (image && image->GetNumberOfPoints() > 0)
  {
    CheckExtent(name, image->GetExtent());
    CheckNumbers(name, "spacing", image->GetSpacing(), 3);
    CheckNumbers(name, "origin", image->GetOrigin(), 3);
    CheckNumbers(name, "direction matrix", image->GetDirectionMatrix()->GetData(), 9);
  }
}

//------------------------------------------------------------------------------
void lacuna::InputCheck::CheckPart(
  vtkDataObject* data, vtkInformation* info, const std::string& name)
{
  auto* image = vtkImageData::SafeDownCast(data);
  // of several pieces this one is a part of what the extent says
  if (image && image->GetNumberOfPoints() > 0 && info->Has(SDDP::UPDATE_EXTENT()) &&
    info->Get(SDDP::UPDATE_NUMBER_OF_PIECES()) <= 1)
  {
    ::CheckPart(name, image->GetExtent(), info->Get(SDDP::UPDATE_EXTENT()));
  }
}

//------------------------------------------------------------------------------
lacuna::InputCheck::Fingerprint lacuna::InputCheck::GetFingerprint(vtkDataObject* data)
{
  Fingerprint numbers{};
  const auto hash = [&numbers](const void* values, std::size_t bytes)
  {
    const std::string_view text(static_cast<const char*>(values), bytes);
    numbers[3] = 31 * numbers[3] + std::hash<std::string_view>{}(text);
  };
  if (auto* image = vtkImageData::SafeDownCast(data))
  {
    int dimensions[3];
    image->GetDimensions(dimensions);
    std::copy_n(dimensions, 3, numbers.begin());
    hash(image->GetOrigin(), 3 * sizeof(double));
    hash(image->GetSpacing(), 3 * sizeof(double));
    hash(image->GetDirectionMatrix()->GetData(), 9 * sizeof(double));
  }
  else if (data)
  {
    numbers[0] = data->GetNumberOfElements(vtkDataObject::POINT);
    numbers[1] = data->GetNumberOfElements(vtkDataObject::CELL);
    numbers[2] = data->GetNumberOfElements(vtkDataObject::ROW);
    auto* set = vtkPointSet::SafeDownCast(data);
    vtkDataArray* points = set && set->GetPoints() ? set->GetPoints()->GetData() : nullptr;
    if (points && points->GetNumberOfValues() > 0)
    {
      hash(points->GetVoidPointer(0),
        static_cast<std::size_t>(points->GetNumberOfValues()) * points->GetDataTypeSize());
    }
  }
  return numbers;
}

//------------------------------------------------------------------------------
const char* lacuna::InputCheck::GetExtractedName(vtkDataObject* data)
{
  auto* set = vtkDataSet::SafeDownCast(data);
  for (const char* name : { "vtkOriginalPointIds", "vtkInsidedness" })
  {
    if (set && (set->GetPointData()->HasArray(name) || set->GetCellData()->HasArray(name)))
    {
      return name;
    }
  }
  return nullptr;
}
