// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// An array that grows while others look at what it had.
#ifndef vtkLacunaGrowingArray_h
#define vtkLacunaGrowingArray_h

#include "vtkSmartPointer.h"
#include "vtkType.h"

#include <cstddef>
#include <memory>
#include <string>

class vtkDataArray;

/// What has been appended never moves or changes in memory that someone looks at: views share it
/// without a copy, and keep it for as long as they live. Memory that is reserved and not used costs
/// nothing on systems that give it when it is touched.
class vtkLacunaGrowingArray
{
public:
  /// type: VTK_DOUBLE ...
  vtkLacunaGrowingArray(const char* name, int type, int components);
  ~vtkLacunaGrowingArray();
  vtkLacunaGrowingArray(const vtkLacunaGrowingArray&) = delete;
  void operator=(const vtkLacunaGrowingArray&) = delete;

  /// Makes room for so many tuples in one piece; otherwise room is made as it is needed, half as
  /// much again each time. Throws std::bad_alloc.
  void Reserve(vtkIdType tuples);
  /// Makes room for so many tuples more, in that way: Append of them does not throw. Throws
  /// std::bad_alloc.
  void MakeRoom(vtkIdType tuples);
  /// Adds tuples, whose values lie one behind the other. Throws std::bad_alloc.
  void Append(const void* values, vtkIdType tuples = 1);
  vtkIdType GetNumberOfTuples() const { return this->Tuples; }
  const void* GetTuple(vtkIdType i) const;
  /// An array of all tuples that there are now.
  vtkSmartPointer<vtkDataArray> MakeView() const;

private:
  std::string Name;
  int Type;
  int Components;
  std::size_t TupleSize; ///< bytes
  vtkIdType Tuples = 0;
  vtkIdType Room = 0;
  std::shared_ptr<char> Memory;
};
#endif
