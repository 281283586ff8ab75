// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaStackPixels.h"

#include "lacunaArrayScalarType.h"
#include "lacunaArrays.h"
#include "lacunaLuminance.h"
#include "lacunaMemory.h"
#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkPointData.h"

#include <stdexcept>
#include <string>
#include <type_traits>

namespace
{
// One row of pixels; the first number of one or two channels is the grey level.
template <class T>
void CopyRow(const T* pixels, std::int64_t count, std::int64_t channels, T* grey)
{
  if (channels >= 3)
  {
    lacuna::MakeLuminance(pixels, count, channels, grey);
    return;
  }
  for (std::int64_t i = 0; i < count; ++i)
  {
    grey[i] = pixels[i * channels];
  }
}
}

namespace lacuna::StackPixels
{
//------------------------------------------------------------------------------
vtkDataArray* Find(vtkImageData* image)
{
  vtkPointData* points = image->GetPointData();
  vtkDataArray* pixels = points->GetScalars();
  if (!pixels && points->GetNumberOfArrays() == 1)
  {
    pixels = points->GetArray(0);
  }
  if (!pixels)
  {
    throw std::runtime_error("the image stack has no active point scalars (grey levels)");
  }
  if (pixels->GetNumberOfComponents() > 4)
  {
    throw std::runtime_error("the image stack has " +
      std::to_string(pixels->GetNumberOfComponents()) +
      " numbers per pixel; 1 (grey), 2 (grey, alpha), 3 (RGB) or 4 (RGBA) are understood");
  }
  if (pixels->GetNumberOfTuples() != image->GetNumberOfPoints())
  {
    throw std::runtime_error("the image stack has " + std::to_string(pixels->GetNumberOfTuples()) +
      " pixels for " + std::to_string(image->GetNumberOfPoints()) + " points");
  }
  return pixels;
}

//------------------------------------------------------------------------------
bool IsBottomRowFirst(vtkDataArray* pixels)
{
  const std::string name = pixels->GetName() ? pixels->GetName() : "";
  return name == "PNGImage" || name == "JPEGImage" || name == "BMPImage" || name == "DICOMImage";
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkDataArray> Allocate(vtkDataArray* pixels, const std::array<int, 6>& extent)
{
  double size = 1;
  for (std::size_t a = 0; a < 3; ++a)
  {
    size *= static_cast<double>(extent[2 * a + 1]) - extent[2 * a] + 1;
  }
  lacuna::RequireMemory("the stack of slices", size * pixels->GetDataTypeSize());
  vtkSmartPointer<vtkDataArray> grey;
  grey.TakeReference(vtkDataArray::CreateDataArray(pixels->GetDataType()));
  lacuna::Arrays::SetNumberOfTuples(grey, static_cast<vtkIdType>(size));
  return grey;
}

//------------------------------------------------------------------------------
void Copy(vtkImageData* image, int fromSlice, int count, bool flip, const std::array<int, 2>& rows,
  vtkDataArray* grey, const std::array<int, 6>& extent, int toSlice)
{
  vtkSmartPointer<vtkDataArray> pixels = Find(image);
  if (!pixels->HasStandardMemoryLayout())
  {
    vtkSmartPointer<vtkDataArray> plain;
    plain.TakeReference(vtkDataArray::CreateDataArray(pixels->GetDataType()));
    lacuna::Arrays::Copy(pixels, plain);
    pixels = plain;
  }
  const int* from = image->GetExtent();
  const int firstRow = flip ? rows[0] + rows[1] - extent[3] : extent[2];
  const int lastRow = flip ? rows[0] + rows[1] - extent[2] : extent[3];
  if (from[0] > extent[0] || from[1] < extent[1] || from[2] > firstRow || from[3] < lastRow ||
    from[4] > fromSlice || from[5] < fromSlice + count - 1 ||
    pixels->GetDataType() != grey->GetDataType())
  {
    throw std::runtime_error("the pictures have different sizes or types of pixels");
  }
  const std::int64_t channels = pixels->GetNumberOfComponents();
  const std::int64_t fromWidth = from[1] - from[0] + 1;
  const std::int64_t fromHeight = from[3] - from[2] + 1;
  const std::int64_t width = extent[1] - extent[0] + 1;
  const std::int64_t height = extent[3] - extent[2] + 1;
  lacuna::DispatchScalars(lacuna::ArrayScalarType::Get(pixels), pixels->GetVoidPointer(0),
    [&](const auto* source)
    {
      using Value = std::remove_cv_t<std::remove_reference_t<decltype(*source)>>;
      auto* target = static_cast<Value*>(grey->GetVoidPointer(0));
      for (int k = 0; k < count; ++k)
      {
        for (int y = extent[2]; y <= extent[3]; ++y)
        {
          const int row = flip ? rows[0] + rows[1] - y : y;
          CopyRow(source +
              (((fromSlice - from[4] + k) * fromHeight + row - from[2]) * fromWidth + extent[0] -
                from[0]) *
                channels,
            width, channels, target + ((toSlice + k - extent[4]) * height + y - extent[2]) * width);
        }
      }
    });
}
}
