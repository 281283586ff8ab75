// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What is told of failures, and when.
#ifndef vtkLacunaFailure_h
#define vtkLacunaFailure_h

#include <string>

class vtkAlgorithm;
class vtkDataObject;
class vtkInformationVector;

/// A failed algorithm fails each time VTK executes it, until something is changed. Its outputs are empty, and their field
/// data hold the error under FieldName, which filters pass on. RequestData returns 1 all the same: VTK would not
/// execute what follows, a view would keep the old picture, and ParaView would not update that view again.
/// ParaView asks several times for one command: within seconds the same error is shown once, and the same work
/// is not done again. What something else than a property or an input has mended (memory that was freed) may be
/// reported for some seconds more.
namespace vtkLacunaFailure
{
/// Says that the algorithm's outcome depends on files, which may be mended or changed without its knowledge, and
/// which one rank alone may lack.
void DependsOnFiles(vtkAlgorithm* algorithm);

/// Keeps the error of RequestInformation for who asks for data; empty: there is none. isOfMemory: of several
/// ranks one may have less.
void Announce(vtkAlgorithm* algorithm, const std::string& error, bool isOfMemory = false);

/// Whether the error that was announced may be that of one rank alone: all have the same properties, but not
/// the same memory and files.
bool MayBeOfOneRank(vtkAlgorithm* algorithm);

/// The error that was announced; empty: none.
std::string GetAnnounced(vtkAlgorithm* algorithm);

/// The error with which the same request for the same inputs has failed a moment ago; empty: none. Files are
/// looked at again.
std::string GetRecent(vtkAlgorithm* algorithm, vtkInformationVector* outputs);

/// Whether all ranks of an MPI program have agreed upon the outcome of the algorithm since it, or what lies
/// upstream, was changed last. error: that of one of them; empty: there was none, or another time was asked
/// for of data that change with it.
bool GetAgreed(vtkAlgorithm* algorithm, vtkInformationVector* outputs, std::string& error);

/// What is told of an error that is kept though its cause may be gone, as of memory.
std::string Again(const std::string& error);

/// Keeps what the ranks have agreed upon.
void SetAgreed(vtkAlgorithm* algorithm, vtkInformationVector* outputs, const std::string& error);

/// The array of an output's field data (vtkStringArray, one value) that holds the error.
constexpr char FieldName[] = "LacunaError";

/// Empties outputs, so that VTK asks for them again and remembers nothing of the request that failed.
void Empty(vtkInformationVector* outputs);

/// Leaves error in outputs that are empty, and marks them as not generated.
void Leave(vtkInformationVector* outputs, const std::string& error);

/// An error that is on the screen already: reaches only those who listen.
void Repeat(vtkAlgorithm* algorithm, const std::string& error);

/// The error that data or one of its blocks holds; empty: none.
std::string GetOf(vtkDataObject* data);

/// The error that an input of algorithm holds; empty: none.
std::string GetUpstream(vtkAlgorithm* algorithm);

/// Makes error one of algorithm. Its outputs, which are empty, hold it and are marked as not generated.
void Tell(vtkAlgorithm* algorithm, vtkInformationVector* outputs, const std::string& error);

/// The same for an error of an input. It was shown: only those hear of it who listen.
void PassOn(vtkAlgorithm* algorithm, vtkInformationVector* outputs, const std::string& error);
}
#endif
