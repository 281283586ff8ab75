// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What filters ask of their inputs, whatever piece is asked of them.
#ifndef vtkLacunaRequest_h
#define vtkLacunaRequest_h

#include "vtkLacunaFiltersCommonModule.h" // for export macro
#include "vtkType.h"                      // for vtkMTimeType

#include <array>
#include <string>
#include <vector> // for times

class vtkAlgorithm;
class vtkInformation;
class vtkInformationVector;

/// For RequestUpdateExtent. An extent alone does not do: a producer of sub-extents divides it once
/// more by the piece that was asked for, so that ranks would get parts of it.
namespace vtkLacunaRequest
{
/// Whether the first piece is asked for, of any output.
VTKLACUNAFILTERSCOMMON_EXPORT bool IsFirst(vtkInformationVector* outputs);

/// Whether anything is asked of a filter whose first output is an image, of which the part may be
/// empty, or else is made as a whole in the first piece.
VTKLACUNAFILTERSCOMMON_EXPORT bool IsWanted(vtkInformationVector* outputs);

/// All of an input of filter, on every rank: images by their whole extent, other data as one piece.
/// When outputs are not wanted (null: they are), nothing of an image, unless there is a filter upstream
/// that is not Lacuna's, or a source of which it is not known that it executes on each rank for itself:
/// such a one may need all ranks, and execute on some of them only. Then all of it, or one point when it
/// does not fit into the memory: readers that use MPI end the program when they are asked for nothing.
///
/// An image that is wanted, is not in memory yet and does not fit into it is refused: returns false, as
/// little as possible is asked for, and vtkLacunaInputs::Check of the filter throws an error that names
/// the bytes. RequestUpdateExtent shall return 1 all the same: VTK goes on to execute, and only so passes
/// on to all that lie upstream that nothing is wanted, so that nobody tries to load it.
VTKLACUNAFILTERSCOMMON_EXPORT bool Whole(
  vtkAlgorithm* filter, vtkInformation* input, vtkInformationVector* outputs);

/// A function that gives the reader inside an algorithm, null where there is none: ParaView's readers of
/// series are around another one, which knows what arrays are switched off, so that these do not count
/// for what fits. VTK's own readers need none.
using InnerReader = vtkAlgorithm* (*)(vtkAlgorithm*);
VTKLACUNAFILTERSCOMMON_EXPORT void SetInnerReader(InnerReader function);

/// This extent of an image, refused like the whole; and all of it where a part of it cannot be read.
VTKLACUNAFILTERSCOMMON_EXPORT bool Extent(
  vtkAlgorithm* filter, vtkInformation* input, const int extent[6]);

/// The text of what was refused of a port; empty when it was asked for, and from then on.
VTKLACUNAFILTERSCOMMON_EXPORT std::string TakeRefusal(vtkAlgorithm* filter, int port);

/// All of it on the first rank and nothing on the others, for filters that answer all requests by what
/// the first rank has made.
VTKLACUNAFILTERSCOMMON_EXPORT void WholeOnFirst(
  vtkAlgorithm* filter, vtkInformation* input, vtkInformationVector* outputs);

/// Whether a filter has asked by WholeOnFirst, so that the other ranks have nothing of what it makes.
VTKLACUNAFILTERSCOMMON_EXPORT bool IsOnFirst(vtkAlgorithm* filter);

/// For outputs whose whole extent may be empty for the time being, as after a stop while it was sought:
/// VTK would go on to ask for nothing, whatever is announced then.
VTKLACUNAFILTERSCOMMON_EXPORT void ForgetEmpty(vtkInformationVector* outputs);

/// What Whole asks for when nothing is wanted.
VTKLACUNAFILTERSCOMMON_EXPORT void Nothing(vtkAlgorithm* filter, vtkInformation* input);

/// For the end of a RequestData without an error: where nothing was asked of images of which nobody else makes
/// anything, all is asked of them again. VTK keeps what was asked of them last, and who updates them next asks
/// for a piece of that. Others would come to them in the same update, and they would make all.
VTKLACUNAFILTERSCOMMON_EXPORT void ForgetNothing(vtkAlgorithm* filter);

/// For RequestUpdateExtent of filters that make parts (CAN_PRODUCE_SUB_EXTENT): the extent that is asked of
/// an output. VTK divides the extent into pieces only when it executes the algorithm, too late to ask the
/// input for what they need: so here in the same way.
VTKLACUNAFILTERSCOMMON_EXPORT std::array<int, 6> GetPart(vtkInformation* output);

/// Data of any kind as one piece.
VTKLACUNAFILTERSCOMMON_EXPORT void OnePiece(vtkInformation* input);

/// When an algorithm or one upstream was changed last, other than the time of data.
VTKLACUNAFILTERSCOMMON_EXPORT vtkMTimeType GetNewestTime(vtkAlgorithm* algorithm);

/// For filters that keep a result: changes when what a filter is, or is given by input, changes; the
/// newest time of it and all upstream, and the time steps asked for and given. On all ranks alike, other
/// than the time of data, which are made anew on one rank alone when that rank is asked for another
/// part.
VTKLACUNAFILTERSCOMMON_EXPORT std::vector<double> GetTimes(
  vtkAlgorithm* filter, vtkInformation* input);

/// For RequestInformation of filters whose output's size depends on their data: executes now, as a
/// whole, what is connected to an input port. When it is up to date, as it usually is, this does
/// nothing. Throws std::runtime_error when it does not fit into the memory, and lacuna::Aborted when it
/// was stopped.
VTKLACUNAFILTERSCOMMON_EXPORT void UpdateNow(vtkAlgorithm* filter, int port = 0);

/// The same for filters that make all of their output on the first rank: returns true there; the
/// others ask for nothing, so that what is upstream executes on all ranks, and have no output.
VTKLACUNAFILTERSCOMMON_EXPORT bool UpdateNowOnFirst(vtkAlgorithm* filter, int port = 0);
}
#endif
