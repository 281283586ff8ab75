// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What filters ask of their inputs, whatever piece is asked of them.
#ifndef vtkLacunaRequest_h
#define vtkLacunaRequest_h

#include "vtkLacunaFiltersCommonModule.h" // for export macro

class vtkAlgorithm;
class vtkInformation;

/// For RequestUpdateExtent. An extent alone does not do: a producer of sub-extents divides it once
/// more by the piece that was asked for, so that ranks would get parts of it.
namespace vtkLacunaRequest
{
/// All of an input, on every rank: images by their whole extent, other data as one piece.
VTKLACUNAFILTERSCOMMON_EXPORT void Whole(vtkInformation* input);

/// The same for filters that cannot do with less: returns 1, or 0 after an error of filter that names
/// the bytes, when the input is an image that is not in memory yet and does not fit into it. Then
/// nothing is asked for, so nobody tries to load it. What RequestUpdateExtent returns.
VTKLACUNAFILTERSCOMMON_EXPORT int WholeIfItFits(vtkAlgorithm* filter, vtkInformation* input);

/// This very extent of an image.
VTKLACUNAFILTERSCOMMON_EXPORT void Extent(vtkInformation* input, const int extent[6]);

/// Data of any kind as one piece.
VTKLACUNAFILTERSCOMMON_EXPORT void OnePiece(vtkInformation* input);

/// For RequestInformation of filters whose output's size depends on their data: executes now, as a
/// whole, what is connected to an input port. When it is up to date, as it usually is, this does
/// nothing. Throws std::runtime_error when it does not fit into the memory.
VTKLACUNAFILTERSCOMMON_EXPORT void UpdateNow(vtkAlgorithm* filter, int port = 0);
}
#endif
