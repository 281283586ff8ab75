// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaGrowingArray.h"

#include "vtkAbstractArray.h"
#include "vtkDataArray.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <map>
#include <mutex>
#include <new>
#include <vector>

namespace
{
// VTK's arrays tell no more than an address when they are done with memory that is not theirs.
class Lenders
{
public:
  static Lenders& Get()
  {
    static auto* lenders = new Lenders; // arrays may be destroyed after statics are
    return *lenders;
  }
  void Lend(const std::shared_ptr<char>& memory)
  {
    const std::lock_guard<std::mutex> lock(this->Mutex);
    this->Lent[memory.get()].push_back(memory);
  }
  void Return(void* address)
  {
    std::shared_ptr<char> last; // freed without the lock
    const std::lock_guard<std::mutex> lock(this->Mutex);
    const auto found = this->Lent.find(address);
    last = std::move(found->second.back());
    found->second.pop_back();
    if (found->second.empty())
    {
      this->Lent.erase(found);
    }
  }

private:
  std::mutex Mutex;
  std::map<void*, std::vector<std::shared_ptr<char>>> Lent;
};

void Return(void* address)
{
  Lenders::Get().Return(address);
}
}

//------------------------------------------------------------------------------
vtkLacunaGrowingArray::vtkLacunaGrowingArray(const char* name, int type, int components)
  : Name(name)
  , Type(type)
  , Components(components)
  , TupleSize(
      static_cast<std::size_t>(vtkAbstractArray::GetDataTypeSize(type)) * std::size_t(components))
{
}

//------------------------------------------------------------------------------
vtkLacunaGrowingArray::~vtkLacunaGrowingArray() = default;

//------------------------------------------------------------------------------
void vtkLacunaGrowingArray::Reserve(vtkIdType tuples)
{
  if (tuples <= this->Room)
  {
    return;
  }
  auto* memory =
    static_cast<char*>(std::malloc(static_cast<std::size_t>(tuples) * this->TupleSize));
  if (!memory)
  {
    throw std::bad_alloc();
  }
  std::shared_ptr<char> larger(memory, std::free);
  if (this->Tuples > 0)
  {
    std::memcpy(
      memory, this->Memory.get(), static_cast<std::size_t>(this->Tuples) * this->TupleSize);
  }
  this->Memory = std::move(larger);
  this->Room = tuples;
}

//------------------------------------------------------------------------------
void vtkLacunaGrowingArray::MakeRoom(vtkIdType tuples)
{
  if (this->Tuples + tuples > this->Room)
  {
    this->Reserve(std::max(this->Tuples + tuples, this->Room + this->Room / 2));
  }
}

//------------------------------------------------------------------------------
void vtkLacunaGrowingArray::Append(const void* values, vtkIdType tuples)
{
  this->MakeRoom(tuples);
  std::memcpy(this->Memory.get() + static_cast<std::size_t>(this->Tuples) * this->TupleSize, values,
    static_cast<std::size_t>(tuples) * this->TupleSize);
  this->Tuples += tuples;
}

//------------------------------------------------------------------------------
const void* vtkLacunaGrowingArray::GetTuple(vtkIdType i) const
{
  return this->Memory.get() + static_cast<std::size_t>(i) * this->TupleSize;
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkDataArray> vtkLacunaGrowingArray::MakeView() const
{
  auto view = vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(this->Type));
  view->SetName(this->Name.c_str());
  view->SetNumberOfComponents(this->Components);
  if (this->Tuples > 0)
  {
    Lenders::Get().Lend(this->Memory);
    view->SetVoidArray(this->Memory.get(), this->Tuples * this->Components, 0,
      vtkAbstractArray::VTK_DATA_ARRAY_USER_DEFINED);
    view->SetArrayFreeFunction(Return);
  }
  return view;
}
