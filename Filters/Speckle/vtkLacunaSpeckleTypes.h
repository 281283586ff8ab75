// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// From VTK's arrays to the fixed-width types that the speckle kernel is compiled for.
#ifndef vtkLacunaSpeckleTypes_h
#define vtkLacunaSpeckleTypes_h

#include "lacunaImageView.h"
#include "vtkDataArray.h"
#include "vtkDataObject.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"

#include <cstdint>
#include <stdexcept>
#include <string>
#include <type_traits>

namespace vtkLacunaSpeckleTypes
{
template <std::size_t Size, bool Signed>
struct Integer;
template <>
struct Integer<1, true>
{
  using Type = std::int8_t;
};
template <>
struct Integer<1, false>
{
  using Type = std::uint8_t;
};
template <>
struct Integer<2, true>
{
  using Type = std::int16_t;
};
template <>
struct Integer<2, false>
{
  using Type = std::uint16_t;
};
template <>
struct Integer<4, true>
{
  using Type = std::int32_t;
};
template <>
struct Integer<4, false>
{
  using Type = std::uint32_t;
};
template <>
struct Integer<8, true>
{
  using Type = std::int64_t;
};
template <>
struct Integer<8, false>
{
  using Type = std::uint64_t;
};

/// float and double are themselves; integers become the fixed-width one of their size and sign.
template <class T, bool = std::is_floating_point_v<T>>
struct Fixed
{
  using Type = T;
};
template <class T>
struct Fixed<T, false>
{
  using Type = typename Integer<sizeof(T), std::is_signed_v<T>>::Type;
};

/// Which array to filter or measure: chosen, if there is one, else the active scalars when no name
/// was given (ParaView sets an empty one when a script makes a filter before its input has run).
/// Throws std::runtime_error when there is none. choice: the algorithm's input array information.
inline vtkDataArray* Choose(vtkDataArray* chosen, vtkInformation* choice, vtkImageData* image)
{
  const char* name = choice->Get(vtkDataObject::FIELD_NAME());
  if (!chosen && name && *name)
  {
    throw std::runtime_error("the image has no point array '" + std::string(name) +
      "' of numbers; choose one that it has");
  }
  vtkDataArray* array = chosen ? chosen : image->GetPointData()->GetScalars();
  if (!array)
  {
    throw std::runtime_error("the image has no point scalars; choose a point array of numbers");
  }
  return array;
}

/// The values of a point array of image as contiguous numbers. Throws std::runtime_error when they
/// do not fit the image.
inline vtkSmartPointer<vtkDataArray> GetSamples(vtkDataArray* array, vtkImageData* image)
{
  const std::string name = array->GetName() ? array->GetName() : "(unnamed)";
  if (array->GetNumberOfTuples() != image->GetNumberOfPoints())
  {
    throw std::runtime_error("array " + name + " has " +
      std::to_string(array->GetNumberOfTuples()) + " values for " +
      std::to_string(image->GetNumberOfPoints()) + " points; choose a point array");
  }
  if (array->GetDataType() == VTK_BIT)
  {
    throw std::runtime_error(
      "array " + name + " is of bits; convert it to unsigned char, for example by a Calculator");
  }
  if (array->HasStandardMemoryLayout())
  {
    return array;
  }
  auto copy = vtk::TakeSmartPointer(vtkDataArray::CreateDataArray(array->GetDataType()));
  copy->DeepCopy(array);
  return copy;
}

inline lacuna::Extent GetExtent(const int extent[6])
{
  return { extent[0], extent[1], extent[2], extent[3], extent[4], extent[5] };
}
}
#endif
