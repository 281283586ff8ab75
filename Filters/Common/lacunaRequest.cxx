// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaRequest.h"

#include "lacunaMemory.h"
#include "vtkDataArray.h"
#include "vtkDataObject.h"
#include "vtkDataSetAttributes.h"
#include "vtkInformation.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <algorithm>
#include <sstream>
#include <stdexcept>

using SDDP = vtkStreamingDemandDrivenPipeline;

namespace lacuna
{
bool IsEmpty(const int* extent)
{
  return extent[0] > extent[1] || extent[2] > extent[3] || extent[4] > extent[5];
}

bool IsGrid(vtkInformation* info)
{
  vtkDataObject* data = vtkDataObject::GetData(info);
  return data && data->GetExtentType() == VTK_3D_EXTENT;
}

const int* GetWhole(vtkInformation* info)
{
  return IsGrid(info) ? info->Get(SDDP::WHOLE_EXTENT()) : nullptr;
}

namespace
{
/// Bytes of a point of an image in its active array, which is all that VTK announces behind a filter.
double GetBytesPerPoint(vtkInformation* image)
{
  vtkInformation* array = vtkDataObject::GetActiveFieldInformation(
    image, vtkDataObject::FIELD_ASSOCIATION_POINTS, vtkDataSetAttributes::SCALARS);
  if (!array || !array->Has(vtkDataObject::FIELD_ARRAY_TYPE()))
  {
    return 1;
  }
  const int components = array->Has(vtkDataObject::FIELD_NUMBER_OF_COMPONENTS())
    ? array->Get(vtkDataObject::FIELD_NUMBER_OF_COMPONENTS())
    : 1;
  return std::max(1, vtkDataArray::GetDataTypeSize(array->Get(vtkDataObject::FIELD_ARRAY_TYPE()))) *
    static_cast<double>(std::max(1, components));
}

/// Throws when a part of an image that is not here yet does not fit into the memory.
void RequireMemoryFor(vtkInformation* image, const std::array<int, 6>& part)
{
  vtkInformation* data = vtkDataObject::GetData(image)->GetInformation();
  const int* here = data->Get(vtkDataObject::DATA_EXTENT());
  bool isHere = here != nullptr;
  for (int a = 0; isHere && a < 6; a += 2)
  {
    isHere = here[a] <= part[a] && part[a + 1] <= here[a + 1];
  }
  if (isHere || IsEmpty(part.data()))
  {
    return;
  }
  const int* whole = image->Get(SDDP::WHOLE_EXTENT());
  std::ostringstream what;
  what << "this filter takes "
       << (std::equal(part.begin(), part.end(), whole) ? "its input as a whole"
                                                       : "a part of its input")
       << ", which with";
  double size = GetBytesPerPoint(image);
  for (int a = 0; a < 3; ++a)
  {
    const double points = static_cast<double>(part[2 * a + 1]) - part[2 * a] + 1;
    size *= points;
    what << (a > 0 ? " x " : " ") << points;
  }
  what << " points";
  RequireMemory(what.str(), size);
}

/// One piece also of an image: whoever makes it would divide the extent once more.
void AskForPiece(vtkInformation* input)
{
  input->Set(SDDP::UPDATE_PIECE_NUMBER(), 0);
  input->Set(SDDP::UPDATE_NUMBER_OF_PIECES(), 1);
  input->Set(SDDP::UPDATE_NUMBER_OF_GHOST_LEVELS(), 0);
}
}

//------------------------------------------------------------------------------
std::string AskForExtent(vtkInformation* input, const std::array<int, 6>& extent)
{
  if (!GetWhole(input)) // blocks, which are refused
  {
    AskForPiece(input);
    return {};
  }
  std::array<int, 6> asked = extent;
  std::string refused;
  try
  {
    RequireMemoryFor(input, extent);
  }
  catch (const std::runtime_error& e)
  {
    refused = e.what();
    // Readers that use MPI end the program when they are asked for nothing.
    const int* whole = input->Get(SDDP::WHOLE_EXTENT());
    asked = { whole[0], whole[0], whole[2], whole[2], whole[4], whole[4] };
  }
  input->Set(SDDP::UPDATE_EXTENT(), asked.data(), 6);
  AskForPiece(input);
  return refused;
}

//------------------------------------------------------------------------------
std::string AskForAll(vtkInformation* input)
{
  const int* whole = GetWhole(input);
  if (!whole)
  {
    AskForPiece(input);
    return {};
  }
  std::array<int, 6> extent{};
  std::copy_n(whole, 6, extent.begin());
  return AskForExtent(input, extent);
}
}
