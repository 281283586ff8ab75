// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Small data of every kind that filters take, random but sound. lacunaSpoiledData.h breaks them.
#ifndef lacunaRandomData_h
#define lacunaRandomData_h

#include "lacunaDice.h"
#include "lacunaMatrix4.h"
#include "vtkSmartPointer.h"

#include <functional>
#include <string>
#include <vector>

class vtkDataArray;
class vtkImageData;
class vtkPolyData;
class vtkStructuredGrid;
class vtkTable;

namespace lacunaProperties
{
/// A proper rotation about a random axis, and a shift of up to `reach` mm along each axis.
lacuna::Matrix4 RandomPose(Dice& dice, double reach = 50);

/// Sets extent (beginning anywhere), spacing (anisotropic), origin and direction (any rotation,
/// one in five left-handed).
void PlaceImage(vtkImageData* image, const int dimensions[3], Dice& dice);

/// Adds point scalars of the type, value(index) of each point in index coordinates.
void AddScalars(vtkImageData* image, int type, const char* name,
  const std::function<double(const lacuna::Vec3&)>& value);

/// Any of VTK's numeric types.
int RandomType(Dice& dice);

/// 2 to 10 voxels along each axis; at times one voxel thin, a row, a voxel or nothing. Levels of any
/// type between 0 and 100: a lopsided lump, noise, or all the same.
vtkSmartPointer<vtkImageData> RandomVolume(Dice& dice);
/// At least `least` voxels along each axis, a lump that an iso-value of 50 cuts.
vtkSmartPointer<vtkImageData> RandomLump(Dice& dice, int least, int most);

/// A sweep of tracked slices with all arrays of the contract, cropped or strided at times.
/// Calibrated unless told otherwise.
vtkSmartPointer<vtkImageData> RandomSlices(Dice& dice, bool isCalibrated = true);
/// Pictures without poses.
vtkSmartPointer<vtkImageData> RandomStack(Dice& dice, int slices);
/// Poses for them, as one of the formats of vtkLacunaAssembleTrackedSlices (Matrix, Quaternion,
/// Euler).
vtkSmartPointer<vtkTable> RandomPoses(Dice& dice, int rows, int format);
/// Time, Gate: samples of a signal.
vtkSmartPointer<vtkTable> RandomSignal(Dice& dice);
/// Slice, Column, Row, Wire: picks in RandomSlices.
vtkSmartPointer<vtkTable> RandomPicks(Dice& dice, int slices);

/// A parallel map of a bent surface, seen from anywhere; with or without holes, or filled.
vtkSmartPointer<vtkImageData> RandomDepthMap(Dice& dice, bool isFilled, int least = 6);

/// Scattered points with the arrays Value and Error.
vtkSmartPointer<vtkPolyData> RandomPoints(Dice& dice, int least, int most);
/// A mould: a bent grid of one layer in press coordinates.
vtkSmartPointer<vtkStructuredGrid> RandomMould(Dice& dice);

/// A column of numbers.
void AddColumn(vtkTable* table, const char* name, const std::vector<double>& values);
}
#endif
