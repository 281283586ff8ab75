// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSpoiledData.h"

#include "lacunaRandomData.h"
#include "vtkAbstractArray.h"
#include "vtkCellArray.h"
#include "vtkDataArray.h"
#include "vtkDataObject.h"
#include "vtkDataSetAttributes.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkMatrix3x3.h"
#include "vtkNew.h"
#include "vtkPointSet.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkStringArray.h"
#include "vtkTable.h"

#include <algorithm>
#include <climits>
#include <cmath>
#include <limits>
#include <vector>

namespace lacunaProperties
{
namespace
{
constexpr double Infinity = std::numeric_limits<double>::infinity();

std::vector<vtkFieldData*> GetGroups(vtkDataObject* data)
{
  std::vector<vtkFieldData*> groups;
  for (const int type :
    { vtkDataObject::POINT, vtkDataObject::CELL, vtkDataObject::ROW, vtkDataObject::FIELD })
  {
    vtkFieldData* group = data->GetAttributesAsFieldData(type);
    if (group && group->GetNumberOfArrays() > 0)
    {
      groups.push_back(group);
    }
  }
  return groups;
}

double BadNumber(Dice& dice)
{
  return dice.Pick({ std::numeric_limits<double>::quiet_NaN(), Infinity, -Infinity, 1e300, -1e30 });
}

// A copy with other components, tuples or type; what there is of the values.
vtkSmartPointer<vtkAbstractArray> Remake(
  vtkAbstractArray* old, int type, int components, vtkIdType tuples)
{
  auto array = vtkSmartPointer<vtkAbstractArray>::Take(vtkAbstractArray::CreateArray(type));
  array->SetName(old->GetName());
  array->SetNumberOfComponents(components);
  array->SetNumberOfTuples(tuples);
  if (auto* numbers = vtkDataArray::SafeDownCast(array))
  {
    numbers->Fill(0); // texts that are no numbers are not set below
  }
  const vtkIdType count = components * tuples;
  for (vtkIdType i = 0; i < count; ++i)
  {
    const vtkIdType from = old->GetNumberOfValues() > 0 ? i % old->GetNumberOfValues() : 0;
    array->SetVariantValue(
      i, old->GetNumberOfValues() > 0 ? old->GetVariantValue(from) : vtkVariant(0));
  }
  return array;
}

void Replace(vtkFieldData* group, vtkAbstractArray* old, vtkAbstractArray* array)
{
  const std::string name = old->GetName() ? old->GetName() : "";
  auto* attributes = vtkDataSetAttributes::SafeDownCast(group);
  const bool isActive = attributes && attributes->GetScalars() == old;
  group->RemoveArray(name.c_str());
  group->AddArray(array);
  if (isActive)
  {
    attributes->SetActiveScalars(name.c_str());
  }
}

std::string SpoilArray(vtkDataObject* data, Dice& dice)
{
  const std::vector<vtkFieldData*> groups = GetGroups(data);
  if (groups.empty())
  {
    return "nothing (no arrays)";
  }
  vtkFieldData* group = dice.Pick(groups);
  vtkSmartPointer<vtkAbstractArray> array =
    group->GetAbstractArray(dice.Whole(0, group->GetNumberOfArrays() - 1));
  const std::string name = array->GetName() ? array->GetName() : "";
  const vtkIdType tuples = array->GetNumberOfTuples();
  const int components = array->GetNumberOfComponents();
  switch (dice.Whole(0, 7))
  {
    case 0:
      group->RemoveArray(name.c_str());
      return "array " + name + " taken away";
    case 1:
      if (group->GetNumberOfArrays() > 1)
      {
        std::string other = "Other"; // no two of one name
        while (group->HasArray(other.c_str()))
        {
          other += "s";
        }
        array->SetName(other.c_str());
        return "array " + name + " renamed";
      }
      array->SetName(dice.Pick({ "", "Other", "Depth", "Intensity" }));
      return "array " + name + " renamed " + array->GetName();
    case 2:
    {
      const int other = components + dice.Pick({ 1, 1, 2, -1 });
      if (other < 1)
      {
        return "nothing (no fewer components)";
      }
      Replace(group, array, Remake(array, array->GetDataType(), other, tuples));
      return "array " + name + " of " + std::to_string(other) + " components";
    }
    case 3:
    {
      const vtkIdType other = dice.Pick<vtkIdType>({ 0, tuples / 2, tuples - 1, tuples + 3 });
      if (other < 0)
      {
        return "nothing (no shorter array)";
      }
      Replace(group, array, Remake(array, array->GetDataType(), components, other));
      return "array " + name + " of " + std::to_string(other) + " tuples";
    }
    case 4:
      Replace(group, array, Remake(array, VTK_STRING, components, tuples));
      return "array " + name + " made text";
    case 5:
    {
      const int type = RandomType(dice);
      Replace(group, array, Remake(array, type, components, tuples));
      return "array " + name + " of type " + std::to_string(type);
    }
    default:
    {
      auto* numbers = vtkDataArray::SafeDownCast(array);
      if (!numbers || tuples == 0)
      {
        return "nothing (no numbers)";
      }
      const bool isReal =
        numbers->GetDataType() == VTK_FLOAT || numbers->GetDataType() == VTK_DOUBLE;
      const int count = dice.Pick({ 1, 3, static_cast<int>(tuples) });
      const double bad = BadNumber(dice);
      for (int i = 0; i < count; ++i)
      {
        const double whole = dice.Chance(0.5) ? numbers->GetDataTypeMax() / 2 : 0;
        numbers->SetComponent(dice.Whole(0, static_cast<int>(tuples) - 1),
          dice.Whole(0, components - 1), isReal ? bad : whole);
      }
      numbers->Modified();
      return std::to_string(count) + " bad numbers in array " + name;
    }
  }
}

// All arrays of a group, which agree with each other then.
std::string SpoilLengths(vtkDataObject* data, Dice& dice)
{
  const std::vector<vtkFieldData*> groups = GetGroups(data);
  if (groups.empty())
  {
    return "nothing (no arrays)";
  }
  vtkFieldData* group = dice.Pick(groups);
  const vtkIdType other = dice.Pick<vtkIdType>({ 0, 1, 3, 30 });
  std::vector<vtkSmartPointer<vtkAbstractArray>> arrays;
  for (int i = 0; i < group->GetNumberOfArrays(); ++i)
  {
    arrays.emplace_back(group->GetAbstractArray(i));
  }
  for (vtkAbstractArray* array : arrays)
  {
    if (array->GetName()) // by which it is replaced
    {
      Replace(
        group, array, Remake(array, array->GetDataType(), array->GetNumberOfComponents(), other));
    }
  }
  return "all arrays of a " + std::string(group->GetClassName()) + " of " + std::to_string(other) +
    " tuples";
}

std::string SpoilImage(vtkImageData* image, Dice& dice)
{
  switch (dice.Whole(0, 5))
  {
    case 0:
    {
      double spacing[3];
      image->GetSpacing(spacing);
      const int axis = dice.Whole(0, 2);
      spacing[axis] = dice.Pick({ 0.0, -spacing[axis], 1e-300, 1e300, 1e-9, BadNumber(dice), 1e9 });
      image->SetSpacing(spacing);
      return "spacing " + std::to_string(spacing[axis]) + " along " + std::to_string(axis);
    }
    case 1:
    {
      double origin[3];
      image->GetOrigin(origin);
      const int axis = dice.Whole(0, 2);
      origin[axis] = dice.Chance(0.5) ? BadNumber(dice) : 1e12;
      image->SetOrigin(origin);
      return "origin " + std::to_string(origin[axis]) + " along " + std::to_string(axis);
    }
    case 2:
    {
      vtkNew<vtkMatrix3x3> direction;
      direction->DeepCopy(image->GetDirectionMatrix());
      const double factor = dice.Pick({ -1.0, 0.0, 2.0, 1e300, BadNumber(dice) });
      const int column = dice.Whole(0, 2);
      for (int row = 0; row < 3; ++row)
      {
        direction->SetElement(row, column, factor * direction->GetElement(row, column));
      }
      image->SetDirectionMatrix(direction);
      return "axis " + std::to_string(column) + " times " + std::to_string(factor);
    }
    case 3:
    {
      vtkNew<vtkMatrix3x3> identity;
      image->SetDirectionMatrix(identity);
      return "direction reset";
    }
    case 4:
    {
      int extent[6];
      image->GetExtent(extent);
      const int axis = dice.Whole(0, 2);
      const int size = extent[2 * axis + 1] - extent[2 * axis];
      extent[2 * axis] =
        dice.Pick({ -3, 5, 100000, INT_MAX - std::max(size, 0), INT_MIN - std::min(size, 0) });
      extent[2 * axis + 1] = extent[2 * axis] + size;
      image->SetExtent(extent);
      return "extent from " + std::to_string(extent[2 * axis]) + " along " + std::to_string(axis);
    }
    default:
      image->SetExtent(0, -1, 0, -1, 0, -1);
      return "empty extent";
  }
}

std::string SpoilPoints(vtkPointSet* data, Dice& dice)
{
  vtkPoints* points = data->GetPoints();
  if (!points || points->GetNumberOfPoints() == 0)
  {
    return "nothing (no points)";
  }
  const vtkIdType count = points->GetNumberOfPoints();
  const vtkIdType point = dice.Whole(0, static_cast<int>(count) - 1);
  double p[3];
  points->GetPoint(point, p);
  const int kind = dice.Whole(0, 3);
  if (kind == 0)
  {
    p[dice.Whole(0, 2)] = BadNumber(dice);
    points->SetPoint(point, p);
    return "a bad point";
  }
  if (kind == 1)
  {
    for (vtkIdType i = 0; i < count; ++i)
    {
      points->SetPoint(i, p);
    }
    return "all points at one place";
  }
  if (kind == 2)
  {
    points->SetPoint(dice.Whole(0, static_cast<int>(count) - 1), p);
    return "two points at one place";
  }
  for (vtkIdType i = 0; i < count; ++i)
  {
    points->GetPoint(i, p);
    points->SetPoint(i, -p[0], p[1], p[2]);
  }
  return "points mirrored";
}
}

//------------------------------------------------------------------------------
std::string Spoil(vtkDataObject* data, Dice& dice)
{
  if (dice.Chance(0.05))
  {
    data->Initialize();
    return "nothing left";
  }
  if (dice.Chance(0.05))
  {
    return SpoilLengths(data, dice);
  }
  if (dice.Chance(0.3))
  {
    if (auto* image = vtkImageData::SafeDownCast(data))
    {
      return SpoilImage(image, dice);
    }
    if (auto* points = vtkPointSet::SafeDownCast(data))
    {
      return SpoilPoints(points, dice);
    }
  }
  return SpoilArray(data, dice);
}

//------------------------------------------------------------------------------
bool IsFinite(vtkDataObject* data)
{
  for (vtkFieldData* group : GetGroups(data))
  {
    for (int a = 0; a < group->GetNumberOfArrays(); ++a)
    {
      vtkDataArray* array = group->GetArray(a);
      const vtkIdType values = array ? array->GetNumberOfTuples() : 0;
      for (vtkIdType i = 0; i < values; ++i)
      {
        for (int c = 0; c < array->GetNumberOfComponents(); ++c)
        {
          if (!(std::abs(array->GetComponent(i, c)) < 1e20))
          {
            return false;
          }
        }
      }
    }
  }
  return true;
}
}
