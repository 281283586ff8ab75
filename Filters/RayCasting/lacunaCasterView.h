// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Where a volume and a depth map are, and arrays for a map; for the ray caster of this module.
#ifndef lacunaCasterView_h
#define lacunaCasterView_h

#include "lacunaImagePlane.h"
#include "lacunaMatrix4.h"
#include "vtkSmartPointer.h"
#include "vtkType.h"

#include <array>
#include <cstdlib>
#include <new>
#include <string>
#include <vector>

class vtkImageData;

namespace lacuna
{
class CasterView
{
public:
  static std::array<int, 3> SizeOf(const int extent[6]);
  static bool IsEmpty(const int extent[6]);

  /// The frame of a volume; the kernel's indices start at the first voxel of its extent. Throws
  /// std::runtime_error for voxels without size, and directions that were lost.
  struct Frame
  {
    std::array<int, 3> Size;
    Matrix4 IndexToWorld;
  };
  static Frame FrameOf(vtkImageData* volume);

  /// The depths of the start map in extent. Throws std::runtime_error unless it shows the same view
  /// as plane; eye: null for a parallel projection.
  static std::vector<double> StartDepths(
    vtkImageData* map, const ImagePlane& plane, const Vec3* eye, const int extent[6]);

  /// An array with room for tuples. VTK's own allocation ends the program when there is no memory;
  /// this throws std::bad_alloc.
  template <class Array>
  static vtkSmartPointer<Array> MakeArray(
    const std::string& name, vtkIdType tuples, int components = 1)
  {
    using Value = typename Array::ValueType;
    const vtkIdType values = tuples * components;
    auto* memory = static_cast<Value*>(std::malloc(sizeof(Value) * (values > 0 ? values : 1)));
    if (!memory)
    {
      throw std::bad_alloc();
    }
    auto array = vtkSmartPointer<Array>::New();
    array->SetName(name.c_str());
    array->SetNumberOfComponents(components);
    array->SetArray(memory, values, 0, Array::VTK_DATA_ARRAY_FREE);
    return array;
  }
};
}
#endif
