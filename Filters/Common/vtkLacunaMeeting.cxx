// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaMeeting.h"

#include "lacunaExecution.h"
#include "lacunaRanks.h"
#include "vtkAlgorithm.h"
#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkInformationVector.h"
#include "vtkLacunaFailure.h"
#include "vtkLacunaInputs.h"
#include "vtkLacunaRequest.h"
#include "vtkLacunaVersionCompat.h"
#include "vtkMatrix3x3.h"
#include "vtkPointSet.h"
#include "vtkRectilinearGrid.h"

#include <cstdint>
#include <functional>
#include <new>
#include <stdexcept>
#include <string_view>

namespace
{
// Of coordinates; not the same on machines of another byte order.
void Hash(vtkDataArray* values, std::uint64_t& hash)
{
  if (values && values->GetNumberOfValues() > 0)
  {
    const std::string_view bytes(static_cast<const char*>(values->GetVoidPointer(0)),
      static_cast<std::size_t>(values->GetNumberOfValues()) * values->GetDataTypeSize());
    hash = 31 * hash + std::hash<std::string_view>{}(bytes);
  }
}

void Hash(const double* numbers, std::size_t count, std::uint64_t& hash)
{
  const std::string_view bytes(reinterpret_cast<const char*>(numbers), count * sizeof(double));
  hash = 31 * hash + std::hash<std::string_view>{}(bytes);
}

// Four numbers for each input: points along the axes of images, or their number, and where they are. Parts
// may be of equal size.
std::vector<std::uint64_t> GetFingerprint(vtkAlgorithm* filter)
{
  std::vector<std::uint64_t> numbers;
  for (int port = 0; port < filter->GetNumberOfInputPorts(); ++port)
  {
    for (int i = 0; i < filter->GetNumberOfInputConnections(port); ++i)
    {
      vtkDataObject* data = filter->GetInputDataObject(port, i);
      int dimensions[3] = { 0, 0, 0 };
      std::uint64_t hash = 0;
      if (auto* image = vtkImageData::SafeDownCast(data))
      {
        image->GetDimensions(dimensions);
        Hash(image->GetOrigin(), 3, hash);
        Hash(image->GetSpacing(), 3, hash);
        Hash(image->GetDirectionMatrix()->GetData(), 9, hash);
      }
      else if (auto* grid = vtkRectilinearGrid::SafeDownCast(data))
      {
        grid->GetDimensions(dimensions);
        Hash(grid->GetXCoordinates(), hash);
        Hash(grid->GetYCoordinates(), hash);
        Hash(grid->GetZCoordinates(), hash);
      }
      else if (auto* points = vtkPointSet::SafeDownCast(data); points && points->GetPoints())
      {
        dimensions[0] = static_cast<int>(points->GetNumberOfPoints());
        Hash(points->GetPoints()->GetData(), hash);
      }
      numbers.insert(numbers.end(), dimensions, dimensions + 3);
      numbers.push_back(hash >> 16); // there is room for the sum of 65 536 ranks
    }
  }
  return numbers;
}

// Throws on all ranks when their inputs, of which each has the whole, are not equal. sum: the same as own.
void RequireEqualInputs(const std::vector<std::uint64_t>& own, std::vector<std::uint64_t>& sum,
  const lacuna::Ranks& ranks)
{
  if (own.empty())
  {
    return; // without inputs, on all ranks
  }
  ranks.Sum(sum.data(), static_cast<std::int64_t>(sum.size()));
  ranks.Together(
    [&]
    {
      for (std::size_t i = 0; i < own.size(); ++i)
      {
        if (sum[i] != own[i] * static_cast<std::uint64_t>(ranks.GetNumber()))
        {
          throw std::runtime_error("the ranks' inputs are not the same; do all nodes have the same "
                                   "files?");
        }
      }
    });
}
}

//------------------------------------------------------------------------------
void vtkLacunaMeeting::AskForWhole(
  vtkAlgorithm* filter, vtkInformationVector** inputs, vtkInformationVector* wanted)
{
  for (int port = 0; port < filter->GetNumberOfInputPorts(); ++port)
  {
    for (int i = 0; i < inputs[port]->GetNumberOfInformationObjects(); ++i)
    {
      vtkLacunaRequest::Whole(filter, inputs[port]->GetInformationObject(i), wanted);
    }
  }
}

//------------------------------------------------------------------------------
bool vtkLacunaMeeting::Hold(vtkAlgorithm* filter, const std::vector<double>& times, bool hasData,
  const lacuna::Ranks& ranks, const std::function<void()>& body)
{
  const auto requireInput = [&]
  {
    if (vtkLacunaCheckAbort(filter))
    {
      throw lacuna::Aborted();
    }
    vtkLacunaInputs::Check(filter);
  };
  if (!this->Times.empty() && this->Times == times)
  {
    if (!this->Error.empty())
    {
      throw std::runtime_error(vtkLacunaFailure::Again(this->Error));
    }
    requireInput();
    return false;
  }
  this->Times = times;
  this->Error.clear();
  const auto fail = [&](const std::string& error)
  {
    this->Error = error;
    if (ranks.GetNumber() == 1)
    {
      this->Forget();
    }
  };
  try
  {
    std::vector<std::uint64_t> own;
    std::vector<std::uint64_t> sum; // made here, where others do not wait if there is no memory
    ranks.Together(
      [&]
      {
        requireInput();
        sum = own = GetFingerprint(filter);
      });
    std::uint64_t number = hasData ? 1 : 0;
    ranks.Sum(&number, 1);
    if (number > 0 && number < static_cast<std::uint64_t>(ranks.GetNumber()))
    {
      throw std::runtime_error(hasData ? "another rank has no input; its own messages say why"
                                       : "this rank has no input, though others have");
    }
    RequireEqualInputs(own, sum, ranks);
    body();
  }
  catch (const lacuna::Aborted&)
  {
    fail("it was stopped");
    throw;
  }
  catch (const std::bad_alloc&)
  {
    fail("out of memory");
    throw;
  }
  catch (const std::exception& error)
  {
    fail(error.what());
    throw;
  }
  return true;
}
