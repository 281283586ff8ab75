// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaBSplineSurface.h"

namespace lacuna
{
//------------------------------------------------------------------------------
Vec3 BSplineSurface::Evaluate(double u, double v, int orderU, int orderV) const
{
  const CubicSplineSpace::Values bu = this->U.Evaluate(u, orderU);
  const CubicSplineSpace::Values bv = this->V.Evaluate(v, orderV);
  Vec3 sum{};
  for (int j = 0; j < 4; ++j)
  {
    const Vec3* row = this->ControlPoints.data() + (bv.First + j) * this->U.GetSize() + bu.First;
    Vec3 inner{};
    for (int i = 0; i < 4; ++i)
    {
      inner = inner + bu.Weights[i] * row[i];
    }
    sum = sum + bv.Weights[j] * inner;
  }
  return sum;
}

//------------------------------------------------------------------------------
Vec3 BSplineSurface::Normal(double u, double v) const
{
  return Normalized(Cross(this->Evaluate(u, v, 1, 0), this->Evaluate(u, v, 0, 1)));
}

//------------------------------------------------------------------------------
bool BSplineSurface::IsClosedU() const
{
  const std::int64_t columns = this->U.GetSize();
  for (std::int64_t j = 0; j < this->V.GetSize(); ++j)
  {
    const Vec3* row = this->ControlPoints.data() + j * columns;
    if (!(row[0] == row[columns - 1]))
    {
      return false;
    }
  }
  return true;
}

//------------------------------------------------------------------------------
bool BSplineSurface::IsClosedV() const
{
  const std::int64_t columns = this->U.GetSize();
  const Vec3* last = this->ControlPoints.data() + (this->V.GetSize() - 1) * columns;
  for (std::int64_t i = 0; i < columns; ++i)
  {
    if (!(this->ControlPoints[i] == last[i]))
    {
      return false;
    }
  }
  return true;
}
}
