// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaSplineLoop.h"

#include "lacunaParameterText.h"
#include "vtkObjectFactory.h"
#include "vtkParametricSpline.h"
#include "vtkPoints.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

vtkStandardNewMacro(vtkLacunaSplineLoop);

namespace
{
// Of the loop per point: the edges between the 192 of a circle through six points lie within 0.02 %
// of its radius of the curve.
constexpr vtkIdType Corners = 32;

bool IsFinite(const std::array<double, 3>& p)
{
  return std::all_of(p.begin(), p.end(), [](double c) { return std::isfinite(c); });
}
}

//------------------------------------------------------------------------------
vtkLacunaSplineLoop::vtkLacunaSplineLoop()
{
  this->Points->SetDataTypeToDouble();
  this->UpdateLoop();
}

vtkLacunaSplineLoop::~vtkLacunaSplineLoop() = default;

//------------------------------------------------------------------------------
void vtkLacunaSplineLoop::SetNumberOfPoints(vtkIdType count)
{
  const vtkIdType before = this->Points->GetNumberOfPoints();
  if (count < 0 || count == before)
  {
    return;
  }
  this->Points->Resize(count); // keeps those that stay
  this->Points->SetNumberOfPoints(count);
  for (vtkIdType i = before; i < count; ++i)
  {
    this->Points->SetPoint(i, 0, 0, 0);
  }
  this->UpdateLoop();
}

//------------------------------------------------------------------------------
vtkIdType vtkLacunaSplineLoop::GetNumberOfPoints()
{
  return this->Points->GetNumberOfPoints();
}

//------------------------------------------------------------------------------
bool vtkLacunaSplineLoop::HasPoint(vtkIdType index)
{
  if (index < 0 || index >= this->Points->GetNumberOfPoints())
  {
    vtkErrorMacro(<< "there is no point " << index << ": the loop has "
                  << this->Points->GetNumberOfPoints());
    return false;
  }
  return true;
}

//------------------------------------------------------------------------------
void vtkLacunaSplineLoop::SetPoint(vtkIdType index, double x, double y, double z)
{
  if (!this->HasPoint(index))
  {
    return;
  }
  std::array<double, 3> old;
  this->Points->GetPoint(index, old.data());
  if (old != std::array<double, 3>{ x, y, z })
  {
    this->Points->SetPoint(index, x, y, z);
    this->UpdateLoop();
  }
}

//------------------------------------------------------------------------------
void vtkLacunaSplineLoop::GetPoint(vtkIdType index, double point[3])
{
  if (this->HasPoint(index))
  {
    this->Points->GetPoint(index, point);
  }
}

//------------------------------------------------------------------------------
void vtkLacunaSplineLoop::SetClosed(vtkTypeBool closed)
{
  if (this->Closed != closed)
  {
    this->Closed = closed;
    this->UpdateLoop();
  }
}

//------------------------------------------------------------------------------
void vtkLacunaSplineLoop::UpdateLoop()
{
  // A spline parametrised by length cannot stay at a place.
  vtkNew<vtkPoints> distinct;
  distinct->SetDataTypeToDouble();
  std::array<double, 3> p;
  std::array<double, 3> last{};
  bool finite = true;
  for (vtkIdType i = 0; i < this->Points->GetNumberOfPoints(); ++i)
  {
    this->Points->GetPoint(i, p.data());
    if (i == 0 || p != last)
    {
      distinct->InsertNextPoint(p.data());
      last = p;
    }
    finite = finite && IsFinite(p);
  }
  vtkIdType count = distinct->GetNumberOfPoints();
  if (this->Closed && count > 1)
  {
    distinct->GetPoint(0, p.data());
    if (p == last)
    {
      distinct->SetNumberOfPoints(--count);
    }
  }
  vtkNew<vtkPoints> loop;
  loop->SetDataTypeToDouble();
  if (count < 3 || !finite)
  {
    loop->DeepCopy(distinct);
  }
  else
  {
    vtkNew<vtkParametricSpline> spline;
    spline->SetPoints(distinct);
    spline->SetClosed(this->Closed);
    const vtkIdType pieces = Corners * (this->Closed ? count : count - 1);
    for (vtkIdType i = 0; i < pieces + (this->Closed ? 0 : 1); ++i)
    {
      double u[3] = { static_cast<double>(i) / static_cast<double>(pieces), 0, 0 };
      double derivatives[9];
      spline->Evaluate(u, p.data(), derivatives);
      loop->InsertNextPoint(p.data());
    }
  }
  this->SetLoop(loop);
}

//------------------------------------------------------------------------------
void vtkLacunaSplineLoop::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  std::vector<double> points;
  for (vtkIdType i = 0; i < this->Points->GetNumberOfPoints(); ++i)
  {
    const double* p = this->Points->GetPoint(i);
    points.insert(points.end(), p, p + 3);
  }
  os << indent << "Points: " << lacuna::FormatValue(points) << "\n"; // no digit is lost
  os << indent << "Closed: " << this->Closed << "\n";
}
