// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaProposedLevel.h"

#include "vtkAlgorithm.h"
#include "vtkDataArray.h"
#include "vtkDataSet.h"
#include "vtkPointData.h"

namespace
{
constexpr double Air = -200;
constexpr double Bone = 500;

double Propose(vtkDataArray* grey, double otherwise)
{
  double range[2];
  grey->GetFiniteRange(range, 0);
  if (!(range[0] < range[1]))
  {
    return otherwise;
  }
  const std::string name = grey->GetName() ? grey->GetName() : "";
  const bool isHounsfield = name == "HounsfieldUnits" || range[0] <= Air;
  return isHounsfield && range[0] < Bone && Bone < range[1] ? Bone : (range[0] + range[1]) / 2;
}
}

std::array<double, 2> lacuna::ProposedLevel::Get(
  vtkAlgorithm* filter, const std::string& array, double otherwise)
{
  auto* data = filter->GetNumberOfInputConnections(0) > 0
    ? vtkDataSet::SafeDownCast(filter->GetInputDataObject(0, 0))
    : nullptr;
  vtkPointData* points = data ? data->GetPointData() : nullptr;
  vtkDataArray* grey = !points ? nullptr
    : array.empty()            ? points->GetScalars()
                               : points->GetArray(array.c_str());
  const bool usable = grey && grey->GetNumberOfComponents() == 1 && grey->GetNumberOfTuples() > 0;
  const double level = usable ? Propose(grey, otherwise) : otherwise;
  return { level, level };
}
