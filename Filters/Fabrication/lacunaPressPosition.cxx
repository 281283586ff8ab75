// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaPressPosition.h"

#include "lacunaArrays.h"
#include "lacunaParameterText.h"
#include "vtkDoubleArray.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPointSet.h"
#include "vtkPolyData.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <vector>

namespace
{
constexpr double PlaceTolerance = 0.002; // mm; single precision may have come between

std::string Thousandths(double value)
{
  return lacuna::FormatNumber(std::round(1000 * value) / 1000);
}

// The fourth landmark of points in a plane: off it, on the side to which the others turn left.
lacuna::Vec3 LeavePlane(const std::array<lacuna::Vec3, 4>& p)
{
  const lacuna::Vec3 edge = p[1] - p[0];
  return p[0] + lacuna::Norm(edge) * lacuna::Normalized(lacuna::Cross(edge, p[2] - p[0]));
}
}

//------------------------------------------------------------------------------
void lacuna::PressPosition::Record(vtkPointSet* data)
{
  vtkNew<vtkDoubleArray> positions;
  positions->SetName(ArrayName);
  positions->SetNumberOfComponents(4);
  lacuna::Arrays::SetNumberOfTuples(positions, data->GetNumberOfPoints());
  for (vtkIdType k = 0; k < data->GetNumberOfPoints(); ++k)
  {
    double p[4] = { 0, 0, 0, 1 };
    data->GetPoint(k, p);
    positions->SetTypedTuple(k, p);
  }
  data->GetPointData()->AddArray(positions);
}

//------------------------------------------------------------------------------
std::optional<lacuna::LandmarkMove> lacuna::PressPosition::FindMove(vtkDataObject* object)
{
  auto* data = vtkPointSet::SafeDownCast(object);
  vtkDataArray* positions = data ? data->GetPointData()->GetArray(ArrayName) : nullptr;
  if (!positions || positions->GetNumberOfComponents() != 4)
  {
    return std::nullopt;
  }
  std::vector<lacuna::Vec3> made;
  std::vector<vtkIdType> ids;
  for (vtkIdType k = 0; k < positions->GetNumberOfTuples(); ++k)
  {
    double p[4];
    positions->GetTuple(k, p);
    if (std::abs(p[3] - 1) <= 1e-6)
    {
      made.push_back({ p[0], p[1], p[2] });
      ids.push_back(k);
    }
  }
  if (made.size() < 3)
  {
    return std::nullopt;
  }
  std::array<std::size_t, 4> indices{};
  const bool spans = lacuna::FindLandmarks(made, indices);
  std::array<lacuna::Vec3, 4> before{};
  std::array<lacuna::Vec3, 4> after{};
  for (std::size_t k = 0; k < 4; ++k)
  {
    before[k] = made[indices[k]];
    data->GetPoint(ids[indices[k]], after[k].data());
  }
  if (!spans)
  {
    const lacuna::Vec3 across = lacuna::Cross(before[1] - before[0], before[2] - before[0]);
    if (!(lacuna::Norm(across) > PlaceTolerance))
    {
      return std::nullopt; // on a line
    }
    before[3] = LeavePlane(before);
    after[3] = LeavePlane(after);
  }
  lacuna::LandmarkMove move = lacuna::CompareLandmarks(before, after);
  // the others may have been moved against them
  const lacuna::Matrix4 map = lacuna::MapLandmarks(before, after);
  for (std::size_t k = 0; k < made.size(); ++k)
  {
    lacuna::Vec3 p;
    data->GetPoint(ids[k], p.data());
    move.Stretch = std::max(move.Stretch, lacuna::Norm(p - map.Point(made[k])));
  }
  return move;
}

//------------------------------------------------------------------------------
std::string lacuna::PressPosition::Check(vtkDataObject* object)
{
  const std::optional<lacuna::LandmarkMove> found = FindMove(object);
  if (!found)
  {
    return {};
  }
  const lacuna::LandmarkMove& move = *found;
  const std::string what = vtkPolyData::SafeDownCast(object) ? "the path or curve" : "the surface";
  const std::string since = what +
    " has been changed since it was made for the press (by "
    "Transform?): ";
  const std::string advice = ". Use it as it was made, without Transform";
  if (move.Mirrored)
  {
    throw std::runtime_error(
      since + "it is mirrored, so nothing made from it fits this patient" + advice);
  }
  if (!(move.Stretch <= PlaceTolerance))
  {
    throw std::runtime_error(since + "distances in it are other ones by up to " +
      Thousandths(move.Stretch) + " mm, so nothing made from it fits; coordinates are in mm" +
      advice);
  }
  return move.Way <= PlaceTolerance
    ? std::string()
    : since + "it lies up to " + Thousandths(move.Way) + " mm elsewhere" +
      (move.Tilt > 0.001 ? ", tilted by " + Thousandths(move.Tilt) + " degrees" : "") +
      ", and PressToPatient does not lead from there to the patient" + advice;
}
