// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaControllerRanks.h"

#include "vtkCommunicator.h"
#include "vtkMultiProcessController.h"
#include "vtkTypeTraits.h"

#include <algorithm>
#include <vector>

namespace
{
constexpr std::int64_t Chunk = 1 << 22; // MPI counts in int, and the copy shall be small

template <class Value>
void SumIn(const lacuna::ControllerRanks& ranks, vtkMultiProcessController* controller,
  Value* values, std::int64_t count)
{
  if (ranks.GetNumber() == 1)
  {
    return;
  }
  std::vector<Value> own;
  ranks.Together([&] { own.resize(std::min(count, Chunk)); });
  for (std::int64_t first = 0; first < count; first += Chunk)
  {
    const std::int64_t size = std::min(Chunk, count - first);
    std::copy_n(values + first, size, own.begin());
    controller->GetCommunicator()->AllReduceVoidArray(
      own.data(), values + first, size, vtkTypeTraits<Value>::VTK_TYPE_ID, vtkCommunicator::SUM_OP);
  }
}
}

//------------------------------------------------------------------------------
lacuna::ControllerRanks::ControllerRanks()
  : Controller(vtkMultiProcessController::GetGlobalController())
{
}

//------------------------------------------------------------------------------
int lacuna::ControllerRanks::GetRank() const
{
  return this->Controller ? this->Controller->GetLocalProcessId() : 0;
}

//------------------------------------------------------------------------------
int lacuna::ControllerRanks::GetNumber() const
{
  return this->Controller ? this->Controller->GetNumberOfProcesses() : 1;
}

//------------------------------------------------------------------------------
void lacuna::ControllerRanks::Sum(std::uint32_t* values, std::int64_t count) const
{
  SumIn(*this, this->Controller, values, count);
}

//------------------------------------------------------------------------------
void lacuna::ControllerRanks::Sum(std::uint64_t* values, std::int64_t count) const
{
  SumIn(*this, this->Controller, values, count);
}

//------------------------------------------------------------------------------
bool lacuna::ControllerRanks::AllFine(bool fine) const
{
  if (this->GetNumber() == 1)
  {
    return fine;
  }
  const int own = fine ? 1 : 0;
  int all = own;
  this->Controller->AllReduce(&own, &all, 1, vtkCommunicator::MIN_OP);
  return all == 1;
}

//------------------------------------------------------------------------------
std::string lacuna::ControllerRanks::GetFirstText(const std::string& own) const
{
  const int number = this->GetNumber();
  if (number == 1)
  {
    return own;
  }
  const int candidate = own.empty() ? number : this->GetRank();
  int first = number;
  this->Controller->AllReduce(&candidate, &first, 1, vtkCommunicator::MIN_OP);
  if (first == number)
  {
    return {};
  }
  std::string text = own;
  int size = static_cast<int>(text.size());
  this->Controller->Broadcast(&size, 1, first);
  text.resize(size);
  this->Controller->Broadcast(text.data(), size, first);
  return text;
}
