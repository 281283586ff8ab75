// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaVolumeDirection.h"

#include "lacunaFieldData.h"
#include "lacunaParameterText.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkMatrix3x3.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

namespace lacuna::VolumeDirection
{
namespace
{
constexpr double Tolerance = 1e-5; // files with six digits pass, 0.003 mm at 300 mm
}

//------------------------------------------------------------------------------
void Record(vtkImageData* volume)
{
  const double* matrix = volume->GetDirectionMatrix()->GetData();
  std::vector<double> elements(matrix, matrix + 9);
  for (double& element : elements)
  {
    element += 0.0; // no -0: VTK keeps the sign of a zero that was there before
  }
  lacuna::FieldData::Set(volume, ArrayName, elements, 9);
}

//------------------------------------------------------------------------------
void Check(vtkDataObject* data)
{
  vtkImageData* volume = vtkImageData::SafeDownCast(data);
  vtkDataArray* record = volume && volume->GetNumberOfPoints() > 0
    ? lacuna::FieldData::Find(volume, ArrayName, 9, 1)
    : nullptr;
  if (!record)
  {
    return;
  }
  bool same = true;
  std::array<double, 9> own;
  std::array<double, 9> recorded;
  std::copy_n(volume->GetDirectionMatrix()->GetData(), 9, own.begin());
  record->GetTuple(0, recorded.data());
  for (int i = 0; i < 9; ++i)
  {
    same = same && std::abs(own[i] - recorded[i]) <= Tolerance; // not of NaN
  }
  if (!same)
  {
    throw std::runtime_error("the direction matrix of the volume is " + lacuna::FormatValue(own) +
      ", but its source recorded " + lacuna::FormatValue(recorded) + " in the field data array '" +
      ArrayName +
      "': a filter in between has reset it (Median, Gradient Magnitude, Image Shrink and Resample "
      "To Image do), or a file that does not keep it (.pvti, legacy .vtk), and left and right may "
      "have changed places. Leave that filter out (Speckle Filter smooths and keeps directions), "
      "and save as .vti. Only if it has resampled the voxels along the new "
      "directions, as Resample To Image does, remove the array behind it: Pass Arrays with all "
      "field data arrays but this one");
  }
}

//------------------------------------------------------------------------------
void Update(vtkDataObject* output)
{
  vtkImageData* image = vtkImageData::SafeDownCast(output);
  if (!image)
  {
    Remove(output);
  }
  else if (!image->GetDirectionMatrix()->IsIdentity() || image->GetFieldData()->HasArray(ArrayName))
  {
    Record(image);
  }
}

//------------------------------------------------------------------------------
void AnnounceAlongAxes(vtkInformation* output)
{
  const double axes[9] = { 1, 0, 0, 0, 1, 0, 0, 0, 1 };
  output->Set(vtkDataObject::DIRECTION(), axes, 9);
}

//------------------------------------------------------------------------------
void Remove(vtkDataObject* data)
{
  data->GetFieldData()->RemoveArray(ArrayName);
}
}
