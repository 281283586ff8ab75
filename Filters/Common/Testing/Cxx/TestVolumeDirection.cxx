// SPDX-License-Identifier: BSD-3-Clause
// A volume says twice how it is turned, and a difference is an error.
#include "lacunaCheck.h"
#include "lacunaDepthMap.h"
#include "lacunaFieldData.h"
#include "lacunaTrackedSlices.h"
#include "lacunaVolumeDirection.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPolyData.h"

#include <cmath>

int TestVolumeDirection(int, char*[])
{
  vtkNew<vtkImageData> volume;
  volume->SetDimensions(2, 2, 2);
  volume->SetDirectionMatrix(0.6, -0.8, 0, 0.8, 0.6, 0, 0, 0, 1);
  lacuna::VolumeDirection::Check(volume); // nothing recorded, nothing to compare
  lacuna::VolumeDirection::Record(volume);
  lacuna::VolumeDirection::Check(volume);
  vtkDataArray* record = volume->GetFieldData()->GetArray("DirectionMatrix");
  LACUNA_CHECK(record && record->GetNumberOfComponents() == 9);
  LACUNA_CHECK_NEAR(record->GetComponent(0, 1), -0.8, 0); // row by row
  volume->SetDirectionMatrix(0.600002, -0.799999, 0, 0.8, 0.6, 0, 0, 0, 1);
  lacuna::VolumeDirection::Check(volume); // digits lost in a file

  volume->SetDirectionMatrix(1, 0, 0, 0, 1, 0, 0, 0, 1); // what vtkImageMedian3D does
  LACUNA_CHECK_THROWS(lacuna::VolumeDirection::Check(volume), "its source recorded");
  volume->SetDirectionMatrix(0.6, 0.8, 0, -0.8, 0.6, 0, 0, 0, 1); // the transpose
  LACUNA_CHECK_THROWS(lacuna::VolumeDirection::Check(volume), "its source recorded");
  LACUNA_CHECK_THROWS(lacuna::VolumeDirection::Check(volume),
    "is 0.6,0.8,0,-0.8,0.6,0,0,0,1, but its source recorded 0.6,-0.8,0,0.8,0.6,0,0,0,1");
  vtkNew<vtkImageData> nothing; // of a rank that got no part
  nothing->GetFieldData()->PassData(volume->GetFieldData());
  lacuna::VolumeDirection::Check(nothing);
  vtkNew<vtkPolyData> surface; // of it, made by any filter
  surface->GetFieldData()->PassData(volume->GetFieldData());
  lacuna::VolumeDirection::Check(surface);
  lacuna::FieldData::Set(
    volume, lacuna::VolumeDirection::ArrayName, { 0.6, std::nan(""), 0, -0.8, 0.6, 0, 0, 0, 1 }, 9);
  LACUNA_CHECK_THROWS(lacuna::VolumeDirection::Check(volume), "but its source recorded 0.6,nan");
  lacuna::FieldData::Set(volume, lacuna::VolumeDirection::ArrayName, { 1, 2, 3 }, 3);
  LACUNA_CHECK_THROWS(lacuna::VolumeDirection::Check(volume), "expected 1 tuples of 9");
  lacuna::VolumeDirection::Remove(volume);
  lacuna::VolumeDirection::Check(volume);

  // VTK keeps the sign of a zero that was there before; a record has none
  volume->SetDirectionMatrix(-1, -0.0, 0, 0, 1, 0, 0, -0.0, -1);
  lacuna::VolumeDirection::Record(volume);
  record = volume->GetFieldData()->GetArray("DirectionMatrix");
  for (int i = 0; i < 9; ++i)
  {
    LACUNA_CHECK(std::signbit(record->GetComponent(0, i)) == (i == 0 || i == 8));
  }

  // what is made of a volume and lies elsewhere does not keep it
  lacuna::VolumeDirection::Record(volume);
  vtkNew<vtkImageData> map;
  map->DeepCopy(volume);
  lacuna::DepthMap::SetGeometry(
    map, lacuna::DepthMap::Geometry{ {}, { 1, 0, 0 }, { 0, 0, -1 }, { 0, 1, 0 }, { 1, 1 } });
  LACUNA_CHECK(!map->GetFieldData()->HasArray("DirectionMatrix"));
  vtkNew<vtkImageData> slices;
  slices->DeepCopy(volume);
  lacuna::TrackedSlices::Write(slices, {}, {}, {}, {});
  LACUNA_CHECK(!slices->GetFieldData()->HasArray("DirectionMatrix"));
  return lacunaCheck::Result();
}
