// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// LacunaLoopDomain, for the points of a Spline Loop: by default they stand around the middle of the depth
/// map that is the input, in its plane, where a user can see and drag them. ParaView's own domains know
/// bounds only, which do not say how a map lies in space.
#include "vtkClientServerInterpreter.h"
#include "vtkClientServerInterpreterInitializer.h"
#include "vtkObjectFactory.h"
#include "vtkPVArrayInformation.h"
#include "vtkPVDataInformation.h"
#include "vtkPVDataSetAttributesInformation.h"
#include "vtkSMDomain.h"
#include "vtkSMPropertyHelper.h"

#include <array>

namespace
{
class vtkSMLacunaLoopDomain : public vtkSMDomain
{
public:
  static vtkSMLacunaLoopDomain* New();
  vtkTypeMacro(vtkSMLacunaLoopDomain, vtkSMDomain);

  /// A rectangle of a third of the map's columns and rows.
  int SetDefaultValues(vtkSMProperty* property, bool unchecked) override
  {
    auto* data = this->GetInputDataInformation("Input");
    auto* matrix =
      data ? data->GetFieldDataInformation()->GetArrayInformation("ImageToWorld") : nullptr;
    if (!matrix || matrix->GetNumberOfComponents() != 16)
    {
      return 0;
    }
    constexpr double Places[4][2] = { { 1, 1 }, { 2, 1 }, { 2, 2 }, { 1, 2 } }; // thirds
    const int* extent = data->GetExtent();
    std::array<double, 12> points{};
    for (int corner = 0; corner < 4; ++corner)
    {
      const double column = extent[0] + (extent[1] - extent[0]) * Places[corner][0] / 3;
      const double row = extent[2] + (extent[3] - extent[2]) * Places[corner][1] / 3;
      for (int axis = 0; axis < 3; ++axis)
      {
        // of one matrix each range is one number
        const auto element = [=](int k) { return matrix->GetComponentRange(4 * axis + k)[0]; };
        points[3 * corner + axis] = element(0) * column + element(1) * row + element(3);
      }
    }
    vtkSMPropertyHelper helper(property);
    helper.SetUseUnchecked(unchecked);
    helper.Set(points.data(), static_cast<unsigned int>(points.size()));
    return 1;
  }

protected:
  vtkSMLacunaLoopDomain() = default;
  ~vtkSMLacunaLoopDomain() override = default;

private:
  vtkSMLacunaLoopDomain(const vtkSMLacunaLoopDomain&) = delete;
  void operator=(const vtkSMLacunaLoopDomain&) = delete;
};

vtkStandardNewMacro(vtkSMLacunaLoopDomain);

/// ParaView finds domains by their names in the XML.
void Register(vtkClientServerInterpreter* interpreter)
{
  interpreter->AddNewInstanceFunction(
    "vtkSMLacunaLoopDomain", [](void*) -> vtkObjectBase* { return vtkSMLacunaLoopDomain::New(); });
}

const bool Added =
  (vtkClientServerInterpreterInitializer::GetInitializer()->RegisterCallback(&Register), true);
}
