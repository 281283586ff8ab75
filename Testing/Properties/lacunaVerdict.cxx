// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaVerdict.h"

#include "lacunaProvenance.h"
#include "vtkAbstractArray.h"
#include "vtkAlgorithm.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkDataObject.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkMatrix3x3.h"
#include "vtkPointData.h"
#include "vtkPointSet.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkStringArray.h"
#include "vtkStructuredGrid.h"
#include "vtkTable.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>
#include <sstream>
#include <utility>

namespace lacunaProperties
{
namespace
{
using SDDP = vtkStreamingDemandDrivenPipeline;

constexpr std::pair<int, const char*> Groups[] = { { vtkDataObject::POINT, "point array " },
  { vtkDataObject::CELL, "cell array " }, { vtkDataObject::ROW, "column " },
  { vtkDataObject::FIELD, "field array " } };

// FNV-1a
class Hash
{
public:
  void Add(const void* bytes, std::size_t count)
  {
    const auto* byte = static_cast<const unsigned char*>(bytes);
    for (std::size_t i = 0; i < count; ++i)
    {
      this->Value = (this->Value ^ byte[i]) * 1099511628211ULL;
    }
  }
  template <class T>
  void Add(const T& value)
  {
    this->Add(&value, sizeof(value));
  }
  std::uint64_t Value = 14695981039346656037ULL;
};

std::uint64_t HashOf(vtkAbstractArray* array)
{
  Hash hash;
  hash.Add(array->GetDataType());
  hash.Add(array->GetNumberOfComponents());
  hash.Add(array->GetNumberOfTuples());
  if (auto* numbers = vtkDataArray::SafeDownCast(array))
  {
    if (numbers->GetNumberOfValues() > 0)
    {
      hash.Add(numbers->GetVoidPointer(0),
        static_cast<std::size_t>(numbers->GetNumberOfValues()) * numbers->GetDataTypeSize());
    }
  }
  else
  {
    for (vtkIdType i = 0; i < array->GetNumberOfValues(); ++i)
    {
      const std::string text = array->GetVariantValue(i).ToString();
      hash.Add(text.data(), text.size() + 1);
    }
  }
  return hash.Value;
}

std::uint64_t HashOf(vtkImageData* image)
{
  Hash hash;
  hash.Add(image->GetExtent(), 6 * sizeof(int));
  const auto add = [&](const double* numbers, int count)
  {
    for (int i = 0; i < count; ++i)
    {
      hash.Add(numbers[i] + 0.0); // -0 is 0
    }
  };
  add(image->GetOrigin(), 3);
  add(image->GetSpacing(), 3);
  add(image->GetDirectionMatrix()->GetData(), 9);
  return hash.Value;
}

std::uint64_t HashOf(vtkPolyData* mesh)
{
  Hash hash;
  for (vtkIdType i = 0; i < mesh->GetNumberOfCells(); ++i)
  {
    hash.Add(mesh->GetCellType(i));
    vtkIdType count = 0;
    const vtkIdType* points = nullptr;
    mesh->GetCellPoints(i, count, points);
    hash.Add(points, static_cast<std::size_t>(count) * sizeof(vtkIdType));
  }
  return hash.Value;
}

std::string FindFaultInArrays(
  vtkDataObject* data, bool isInputFinite, const std::set<std::string>& mayBeNaN)
{
  // what a mask takes out has no value
  vtkFieldData* points = data->GetAttributesAsFieldData(vtkDataObject::POINT);
  vtkDataArray* mask = points ? points->GetArray("vtkValidPointMask") : nullptr;
  for (const auto& [type, what] : Groups)
  {
    vtkFieldData* group = data->GetAttributesAsFieldData(type);
    const vtkIdType wanted = type == vtkDataObject::FIELD ? -1 : data->GetNumberOfElements(type);
    for (int a = 0; group && a < group->GetNumberOfArrays(); ++a)
    {
      vtkAbstractArray* array = group->GetAbstractArray(a);
      const std::string name = array->GetName() ? array->GetName() : "";
      if (wanted >= 0 && array->GetNumberOfTuples() != wanted)
      {
        return what + name + " has " + std::to_string(array->GetNumberOfTuples()) + " tuples for " +
          std::to_string(wanted);
      }
      auto* numbers = vtkDataArray::SafeDownCast(array);
      if (!numbers || !isInputFinite || mayBeNaN.count(name) > 0)
      {
        continue;
      }
      for (vtkIdType i = 0; i < numbers->GetNumberOfTuples(); ++i)
      {
        const bool counts = type != vtkDataObject::POINT || !mask || mask->GetComponent(i, 0) != 0;
        for (int c = 0; counts && c < numbers->GetNumberOfComponents(); ++c)
        {
          if (!std::isfinite(numbers->GetComponent(i, c)))
          {
            return what + name + " is not finite at " + std::to_string(i);
          }
        }
      }
    }
  }
  return {};
}

std::string FindFaultInPoints(vtkPointSet* data)
{
  const vtkIdType count = data->GetNumberOfPoints();
  for (vtkIdType i = 0; i < count; ++i)
  {
    const double* p = data->GetPoint(i);
    if (!std::isfinite(p[0]) || !std::isfinite(p[1]) || !std::isfinite(p[2]))
    {
      return "point " + std::to_string(i) + " is not finite";
    }
  }
  auto* mesh = vtkPolyData::SafeDownCast(data);
  for (vtkIdType cell = 0; mesh && cell < mesh->GetNumberOfCells(); ++cell)
  {
    vtkIdType size = 0;
    const vtkIdType* points = nullptr;
    mesh->GetCellPoints(cell, size, points);
    if (std::any_of(points, points + size, [=](vtkIdType p) { return p < 0 || p >= count; }))
    {
      return "cell " + std::to_string(cell) + " has a point that does not exist";
    }
  }
  if (auto* grid = vtkStructuredGrid::SafeDownCast(data))
  {
    int n[3];
    grid->GetDimensions(n);
    const vtkIdType wanted = vtkIdType{ 1 } * n[0] * n[1] * n[2];
    if (wanted != count && count != 0)
    {
      return "the grid has " + std::to_string(count) + " points for " + std::to_string(wanted);
    }
  }
  return {};
}

std::string FindFaultInImage(vtkImageData* image, vtkInformation* info)
{
  const int* promised = info->Get(SDDP::WHOLE_EXTENT());
  if (!promised || !std::equal(promised, promised + 6, image->GetExtent()))
  {
    return "the extent is not the whole extent";
  }
  const auto differs = [info](vtkInformationDoubleVectorKey* key, const double* value, int count)
  { return info->Has(key) && !std::equal(value, value + count, info->Get(key)); };
  if (differs(vtkDataObject::SPACING(), image->GetSpacing(), 3))
  {
    return "the spacing is not what was promised";
  }
  if (differs(vtkDataObject::ORIGIN(), image->GetOrigin(), 3))
  {
    return "the origin is not what was promised";
  }
  if (differs(vtkDataObject::DIRECTION(), image->GetDirectionMatrix()->GetData(), 9))
  {
    return "the direction is not what was promised";
  }
  for (int axis = 0; axis < 3; ++axis)
  {
    if (!std::isfinite(image->GetSpacing()[axis]) || !std::isfinite(image->GetOrigin()[axis]))
    {
      return "spacing or origin are not finite";
    }
  }
  vtkInformation* scalars = vtkDataObject::GetActiveFieldInformation(
    info, vtkDataObject::FIELD_ASSOCIATION_POINTS, vtkDataSetAttributes::SCALARS);
  vtkDataArray* array = image->GetPointData()->GetScalars();
  if (scalars && array && scalars->Has(vtkDataObject::FIELD_ARRAY_TYPE()) &&
    scalars->Get(vtkDataObject::FIELD_ARRAY_TYPE()) != array->GetDataType())
  {
    return "the type of the scalars, " + std::to_string(array->GetDataType()) + ", is not the " +
      std::to_string(scalars->Get(vtkDataObject::FIELD_ARRAY_TYPE())) + " that was promised";
  }
  return {};
}
}

//------------------------------------------------------------------------------
Fingerprint TakeFingerprint(vtkDataObject* data)
{
  Fingerprint fingerprint;
  if (!data)
  {
    return fingerprint;
  }
  for (const auto& [type, what] : Groups)
  {
    vtkFieldData* group = data->GetAttributesAsFieldData(type);
    for (int a = 0; group && a < group->GetNumberOfArrays(); ++a)
    {
      vtkAbstractArray* array = group->GetAbstractArray(a);
      const std::string name = array->GetName() ? array->GetName() : "";
      if (name != "FitTime") // documented: not the same twice
      {
        fingerprint[what + name] = HashOf(array);
      }
    }
  }
  if (auto* image = vtkImageData::SafeDownCast(data))
  {
    fingerprint["geometry"] = HashOf(image);
  }
  auto* points = vtkPointSet::SafeDownCast(data);
  if (points && points->GetPoints())
  {
    fingerprint["points"] = HashOf(points->GetPoints()->GetData());
  }
  if (auto* mesh = vtkPolyData::SafeDownCast(data))
  {
    fingerprint["cells"] = HashOf(mesh);
  }
  return fingerprint;
}

//------------------------------------------------------------------------------
std::string Compare(const Fingerprint& first, const Fingerprint& second)
{
  std::set<std::string> names;
  for (const auto& [name, hash] : first)
  {
    const auto other = second.find(name);
    if (other == second.end() || other->second != hash)
    {
      names.insert(name);
    }
  }
  for (const auto& [name, hash] : second)
  {
    if (first.find(name) == first.end())
    {
      names.insert(name);
    }
  }
  std::string text;
  for (const std::string& name : names)
  {
    text += (text.empty() ? "" : ", ") + name;
  }
  return text;
}

//------------------------------------------------------------------------------
bool IsEmpty(vtkDataObject* data)
{
  return !data ||
    (data->GetNumberOfElements(vtkDataObject::POINT) == 0 &&
      data->GetNumberOfElements(vtkDataObject::CELL) == 0 &&
      data->GetNumberOfElements(vtkDataObject::ROW) == 0);
}

//------------------------------------------------------------------------------
std::string FindFault(
  vtkAlgorithm* algorithm, int port, bool isInputFinite, const std::set<std::string>& mayBeNaN)
{
  vtkDataObject* data = algorithm->GetOutputDataObject(port);
  if (IsEmpty(data))
  {
    return {};
  }
  std::string fault = FindFaultInArrays(data, isInputFinite, mayBeNaN);
  auto* points = vtkPointSet::SafeDownCast(data);
  if (fault.empty() && points)
  {
    fault = FindFaultInPoints(points);
  }
  auto* image = vtkImageData::SafeDownCast(data);
  if (fault.empty() && image)
  {
    fault = FindFaultInImage(image, algorithm->GetOutputInformation(port));
  }
  if (fault.empty() && lacuna::Provenance::Get(data).empty())
  {
    fault = "no provenance";
  }
  return fault;
}
}
